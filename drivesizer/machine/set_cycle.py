"""One drive over one load cycle: current, voltage and heat over time, from cold, piece by piece.

The kernel that judges candidates, called with one. The winding is as warm as it is at each moment of the cycle in
periodic steady state, one of unknown time constants as in the long run; where that is unknown, so is the voltage.
Symbols: I current [A], V voltage [V], w speed [rad/s], P_h loss at the housing [W].
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from math import nan
from typing import Any, NamedTuple

import numpy as np

from drivesizer.catalog.parts import OneRow, one_row
from drivesizer.kernel.cycle import HEAT, POWER
from drivesizer.kernel.evaluate import drives_of, evaluate, pieces
from drivesizer.kernel.heat import mean_square
from drivesizer.kernel.records import Drive, Figures, Piece
from drivesizer.kernel.warming import State, after
from drivesizer.load_cases import load_cycle
from drivesizer.physics.cycle_at_gearhead import AtGearhead, CycleAtBelt
from drivesizer.physics.extremes import first_largest
from drivesizer.physics.figures import Array, Whole
from drivesizer.physics.load_cycle import LoadCycle, middle, places, rms
from drivesizer.physics.motor_demand import Demands, demands
from drivesizer.physics.power_stage import Feed
from drivesizer.physics.thermal import two_bodies
from drivesizer.physics.winding import Heat
from drivesizer.results.drive_set import DriveParts, MotorPiece
from drivesizer.spec.mounting import heat_of
from drivesizer.spec.robot import RobotSpec


class SetCycle(NamedTuple):
    """A drive's parts as columns of one row, and their demands and heat over a load cycle."""

    spec: RobotSpec
    feed: Feed  # its power stage and supply
    motor: OneRow
    gearhead: OneRow
    cycle: AtGearhead
    demands: Demands
    heat: Heat
    drive: Drive  # as the kernel takes it
    figures: Figures  # columns of one
    pieces: Piece  # the cycle in pieces of which a winding follows the mean
    released: float = 0.0  # W, that keeps its brake released

    @property
    def known(self) -> bool:
        """Whether the motor's current is known, and not only a least one."""
        return bool(self.demands.complete.all() and np.isfinite(self.demands.rms_current).all())

    @property
    def winding(self) -> float:
        """Mean temperature of the winding [K]; NaN unknown."""
        return float(self.spec.environment.ambient + self.figures.winding_mean[0])


def set_cycle(spec: RobotSpec, drive_set: DriveParts, base: CycleAtBelt | None = None) -> SetCycle:
    """A drive over the load cycle of a spec."""
    drive, cycle, demand, heating = driven(spec, drive_set, base)
    return SetCycle(
        spec,
        spec.feed_of(drive_set.controller, drive_set.brake),
        one_row(drive_set.motor),
        one_row(drive_set.gearhead),
        cycle,
        demand,
        heating,
        drive,
        *pieces(drive, cycle.load_cycle),
        drive_set.released_power * spec.brake_released,
    )


def driven(
    spec: RobotSpec, drive_set: DriveParts, base: CycleAtBelt | None = None
) -> tuple[Drive, AtGearhead, Demands, Heat]:
    """A drive as the kernel takes it, torque and speed over the load cycle of a spec, and its losses."""
    motor, gearhead = one_row(drive_set.motor), one_row(drive_set.gearhead)
    cycle, demand = turned(spec, drive_set, base)
    ambient, feed = spec.environment.ambient, spec.feed_of(drive_set.controller, drive_set.brake)
    heating = heat_of(spec, cycle, demand, motor, gearhead)
    rise = np.where(np.isfinite(heating.winding), heating.winding, nan) - ambient
    drive = drives_of(ambient, cycle, demand, heating, motor, feed, cold=spec.once)._replace(rise=rise, mean_rise=rise)
    return drive, cycle, demand, heating


def turned(spec: RobotSpec, drive_set: DriveParts, base: CycleAtBelt | None = None) -> tuple[AtGearhead, Demands]:
    """Torque and speed of a drive over the load cycle of a spec; a stepper's own friction is in its pull-out torque."""
    turning = drive_set.motor
    if drive_set.steps:
        turning = replace(turning, friction_torque=0.0, viscous_friction=0.0)
    if base is None:  # cut as the search cut it
        base = CycleAtBelt(load_cycle(spec), drive_set.belt_efficiency, drive_set.quickest)
    cycle = base.behind(drive_set.belt_ratio)
    motor, gearhead, encoder = (one_row(part) for part in (turning, drive_set.gearhead, drive_set.encoder))
    return cycle, demands(cycle, motor, gearhead, encoder, drive_set.brake_inertia)


def torque_above(cycle: AtGearhead, limit: float) -> tuple[float, float]:
    """Longest time [s] without a break for which the torque at the gearhead's output, behind one belt, is above a limit
    [N*m], and the share of all such time [1]; NaN where the limit is unknown.
    """
    e, belt = cycle.base.efficiency, float(cycle.belt)
    torque = Drive(*np.zeros(len(Drive._fields)))._replace(
        driving=1.0 / e / belt, braking=e / belt, resting=1.0 / belt, finest=np.inf, limit=limit
    )  # torque in the place of the current
    figures = evaluate(Drive(*(np.array([x]) for x in torque)), cycle.load_cycle, POWER)
    return float(figures.above[0]), float(figures.above_in_all[0]) / cycle.load_cycle.total


# -- Warm-up of a motor from cold to the periodic steady state: for figures.
#
# A cycle maps the rises at its start to those at its end, so that any later cycle is reached by powers of that map and
# none has to be gone through.


_NEAR = 0.01  # of the rise from cold: no visible change any more
_REPORTED_CYCLES = 60  # cycles of which temperatures are reported
_MOST_CYCLES = 1e7  # cycles: longer nobody waits
_STEP = 0.25  # of the winding's time constant, the first point of a piece
_POINTS = 24  # of a piece, each farther from the next than from the one before


class WarmUp(NamedTuple):
    """Temperatures from cold to the periodic steady state [K]."""

    time: Array  # s, at the end of each of these cycles; 0 first
    lowest: Array  # K, of the winding in each of these cycles
    highest: Array
    housing: Array  # K, at these times
    in_cycle: Array  # s, times in the cycle that repeats
    winding_in_cycle: Array  # K, then
    housing_in_cycle: Array
    peak: float  # K, of the winding in that cycle
    peak_time: float  # s


def warm_up(set_cycle: SetCycle) -> WarmUp | None:
    """Temperatures from cold to the periodic steady state; None where a figure is unknown or the motor runs away."""
    cycle, ambient, figures = set_cycle.cycle.load_cycle, set_cycle.spec.environment.ambient, set_cycle.figures
    if not np.isfinite(figures.winding[0]):
        return None

    def from_rises(starts: Any) -> Figures:
        w, h = np.transpose(starts)
        return evaluate(set_cycle.drive._replace(winding_start=w, housing_start=h), cycle, HEAT)

    settled = np.array([figures.winding_start[0], figures.housing_start[0]])
    units = from_rises([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])
    ends = np.array([units.winding_end, units.housing_end])
    one_more = ends[:, 1:] - ends[:, :1]
    left = float(np.abs(np.linalg.eigvals(one_more)).max())  # of a difference after one cycle
    last = math.log(_NEAR) / math.log(left) if left > 0.0 else 0.0
    count = int(min(max(math.ceil(last), 3), _MOST_CYCLES))
    numbers = sorted({round(n) for n in np.linspace(0, count - 1, min(count, _REPORTED_CYCLES))})
    way = from_rises([settled - np.linalg.matrix_power(one_more, n) @ settled for n in numbers])
    time, winding, housing = _course(set_cycle)
    return WarmUp(
        time=np.append(0.0, (np.array(numbers) + 1) * float(cycle.total)),
        lowest=ambient + np.minimum(way.winding_least, way.winding_start),
        highest=ambient + np.maximum(way.winding, way.winding_start),
        housing=ambient + np.append(0.0, way.housing_end),
        in_cycle=time,
        winding_in_cycle=winding,
        housing_in_cycle=housing,
        peak=float(ambient + figures.winding[0]),
        peak_time=float(figures.winding_time[0]),
    )


def _course(set_cycle: SetCycle) -> tuple[Array, Array, Array]:
    """Times of the cycle that repeats so close that a curve shows how the winding follows, and temperatures then."""
    d, p, ambient, bodies = (
        set_cycle.drive,
        set_cycle.pieces,
        set_cycle.spec.environment.ambient,
        two_bodies(set_cycle.motor.part),
    )
    loss = d.friction * (np.abs(p.w_0) + np.abs(p.w_1)) / 2.0 + d.iron * mean_square(p.w_0, p.w_1)
    first = np.minimum(_STEP * bodies.tau_w / p.duration, 1.0)
    count = np.where(first < 1.0 / _POINTS, _POINTS, np.ceil(1.0 / first)).astype(np.int64)
    of, place = places(count)
    power = np.maximum(1.0, np.log(first) / -np.log(np.maximum(count, 2)))
    t = p.duration[of] * ((place + 1) / count[of]) ** power[of]
    start = State(ambient + p.winding[of], ambient + p.housing[of])
    then = after(bodies, ambient, start, np.asarray(mean_square(p.I_0, p.I_1))[of], loss[of], t)
    begin = State(start.winding[:1], start.housing[:1])
    time = np.append(0.0, (np.cumsum(p.duration) - p.duration)[of] + t)
    return time, np.append(begin.winding, then.winding), np.append(begin.housing, then.housing)


# -- The motor's own torque piece by piece: accelerate, run, brake, rest, and the whole cycle.
#
# Torque of the motor is :math:`c f(t)`, its coefficients times the six functions of the load cycle (``physics``),
# rotor and friction included; its current that over :math:`k_t`. Segments of one kind that follow one another are
# one piece: speed and its change decide the kind; where noise makes many of them, that of straight lines through the
# speed. The RMS over the whole is that of all pieces, :math:`\tau_{rms} = \sqrt{\sum \tau_k^2 t_k / \sum t_k}`.
#
# Worked example: a load of 0.474 kg·cm² and 0.035 N·m at a motor of 0.00629 kg·cm² takes 0.186 N·m to reach 3000 rpm
# in 0.1 s (Yaskawa, E-S series product manual, 2.4.1, verification of the servomotor).


_MOST_PIECES = 24  # pieces; where there are more, those of one kind are put together
_LEVEL = 1e-9  # of the largest acceleration: less is what rounding leaves of a steady speed
_MOTIONS = ("rest", "brake", "run", "accelerate", "brake back", "run back", "accelerate back")


def motor_pieces(
    cycle: AtGearhead, demand: Demands, torque_constant: float, case: str = "", *, noisy: bool = False
) -> tuple[MotorPiece, ...]:
    """The pieces of a drive's cycle in the order of time, and last the whole of it; ``noisy``: of a recording."""
    load = cycle.load_cycle
    torque = cycle.line(demand.coefficients[0]) if demand.complete[0] else np.full_like(load.torque, nan)
    speed = np.abs(load.speed).max(axis=1) * cycle.belt * float(demand.total_ratio[0])
    start = np.cumsum(load.duration) - load.duration

    def piece(name: str, rows: Any) -> MotorPiece:
        mean, most, duration = rms(load.duration[rows], torque[rows]), _largest(torque[rows]), load.duration[rows]
        return MotorPiece(
            case=case, name=name, start=float(start[rows][0]), duration=float(duration.sum()),
            speed=float(speed[rows].max()), load_torque=_largest(load.torque[rows]), motor_torque=most,
            rms_torque=mean, current=abs(most) / torque_constant, rms_current=mean / torque_constant,
        )  # fmt: skip

    motions = _motions(load)
    edges = [0, *(np.flatnonzero(np.diff(motions)) + 1).tolist(), len(motions)]
    if noisy and len(edges) - 1 > _MOST_PIECES:
        motions = _seen_motions(load)
        edges = [0, *(np.flatnonzero(np.diff(motions)) + 1).tolist(), len(motions)]
    if len(edges) - 1 <= _MOST_PIECES:
        pieces = [piece(_MOTIONS[motions[a]], slice(a, b)) for a, b in pairwise(edges)]
    else:
        pieces = [piece(_MOTIONS[k], motions == k) for k in dict.fromkeys(motions[edges[:-1]].tolist())]
    return *pieces, piece("cycle", slice(None))


def _motions(load: LoadCycle) -> Whole:
    """The kind of each segment, as a number in ``_MOTIONS``."""
    way, slope = np.sign(middle(load.speed)), middle(load.acceleration)
    gaining = np.where(np.abs(slope) <= _LEVEL * np.abs(load.acceleration).max(), 0.0, np.sign(slope * way))
    return np.where(way == 0.0, 0.0, 2.0 + gaining + 3.0 * (way < 0.0)).astype(np.int64)


def _seen_motions(load: LoadCycle) -> Whole:
    """The kind of each segment of a noisy course: by straight lines through its speed, as an eye sees them.

    A line ends where the speed leaves it by more than five times the noise, within 5 to 15 % of the largest speed.
    """
    time = np.append(0.0, np.cumsum(load.duration))
    speed = np.append(load.speed[:, 0], load.speed[-1, 1])
    noise = 1.4826 / math.sqrt(1.5) * float(np.median(np.abs(np.diff(speed, 2) / 2.0)))  # of one sample
    largest = float(np.abs(speed).max())
    room = min(max(_OF_NOISE * noise, _SEEN[0] * largest), _SEEN[1] * largest)
    lines, ends = [(0, len(speed) - 1)], set[int]()
    while lines:
        i, k = lines.pop()
        ends.add(k)
        straight = speed[i] + (speed[k] - speed[i]) * (time[i : k + 1] - time[i]) / (time[k] - time[i])
        off = np.abs(speed[i : k + 1] - straight)
        corner = i + int(np.argmax(off))
        if off[corner - i] > room:
            lines += [(i, corner), (corner, k)]
    motions = np.zeros(len(load.duration), dtype=np.int64)
    for i, k in pairwise((0, *sorted(ends))):
        along = (time[i : k + 1] - time[i]) / (time[k] - time[i])
        slope, start = np.polyfit(along, speed[i : k + 1], 1) if k > i + 1 else (speed[k] - speed[i], speed[i])
        if start * (start + slope) < 0.0 and min(abs(start), abs(start + slope)) > room:  # it turns round
            turn = i + int(np.searchsorted(along, -start / slope))
            sides = [(i, turn, start, 0.0), (turn, k, 0.0, start + slope)]
        else:
            sides = [(i, k, start, start + slope)]
        for first, last, begin, end in sides:
            if max(abs(begin), abs(end)) > room:
                gained = abs(end) - abs(begin)
                motions[first:last] = 2 + int(np.sign(gained)) * (abs(gained) > room) + 3 * (begin + end < 0.0)
    return motions


_SEEN = 0.05, 0.15  # of the largest speed, least and most
_OF_NOISE = 5.0  # standard deviations


def _largest(values: Array) -> float:
    """The value of the largest amount, with its sign."""
    flat = values.ravel()
    return float(flat[first_largest(np.abs(flat))[1]])
