"""One drive over one load cycle: current, voltage and heat over time, from cold, piece by piece."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from math import nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import OneRow, one_row
from drivesizer.kernel.drives import drives_of
from drivesizer.kernel.evaluate import pieces
from drivesizer.kernel.records import Drive, Figures, Piece
from drivesizer.kernel.supply import mean_square
from drivesizer.load_cases import load_cycle
from drivesizer.physics.cycle_at_gearhead import AtGearhead, at_gearhead
from drivesizer.physics.extremes import first_largest
from drivesizer.physics.groups import layout as at
from drivesizer.physics.groups.census import LEVEL, Census, Group
from drivesizer.physics.heat_cycle import HeatCycle, periodic, periodic_heat
from drivesizer.physics.heat_step import Course
from drivesizer.physics.load_cycle import rms
from drivesizer.physics.motor_demand import Demands, demands
from drivesizer.physics.power_stage import Feed
from drivesizer.physics.thermal import TwoBodies, resistance_25, resistance_at
from drivesizer.physics.waveform import Wave
from drivesizer.physics.winding import Heat, Stress, heat, stress, volts_of
from drivesizer.results.drive_set import DriveParts, MotorPiece
from drivesizer.spec.mounting import loss_at_flange
from drivesizer.spec.robot import RobotSpec

__all__ = [
    "SetCycle", "WarmUp", "Warming", "driven", "finer", "motor_pieces", "set_cycle", "turned", "warm_up", "warming",
    "waveform",
]  # fmt: skip


# -- One drive over one load cycle: current, voltage and heat over time, for figures and the energy balance.
#
# The kernel that judges candidates, called with one. The winding is as warm as it is at each moment of the cycle in
# periodic steady state, one of unknown time constants as in the long run; where that is unknown, so is the voltage.
# Symbols: I current [A], V voltage [V], w speed [rad/s], P_h loss at the housing [W].


Array = NDArray[np.float64]


class SetCycle(NamedTuple):
    """A drive's parts as columns of one row, and their demands, heat and stress over a load cycle."""

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
    def stress(self) -> Stress:
        """Largest torque and current, and largest voltage while the winding is cold."""
        return stress(self.spec.environment.ambient, self.cycle, self.demands, self.motor, self.feed.leads)

    @property
    def winding(self) -> Array:
        """Mean temperature of the winding [K]; NaN unknown."""
        return np.asarray(self.spec.environment.ambient + self.figures.winding_mean)

    @property
    def hot(self) -> Array:
        """Resistance of the winding at its mean temperature [ohm]; cold, where that is unknown."""
        T = np.where(np.isfinite(self.winding), self.winding, self.spec.environment.ambient)
        return np.asarray(resistance_at(resistance_25(self.motor), T))

    @property
    def volts(self) -> Array:
        """Coefficients of the voltage from the six functions, winding hot."""
        return volts_of(self.demands, self.motor["torque_constant"], self.hot)


class Warming(NamedTuple):
    """Heat sources of a motor: pieces of the cycle in order."""

    duration: Array  # s
    square: Array  # A^2, mean square current
    loss: Array  # W, at the housing


def set_cycle(spec: RobotSpec, drive_set: DriveParts, base: Any = None) -> SetCycle:
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


def driven(spec: RobotSpec, drive_set: DriveParts, base: Any = None) -> tuple[Drive, AtGearhead, Demands, Heat]:
    """A drive as the kernel takes it, torque and speed over the load cycle of a spec, and its losses."""
    motor, gearhead = one_row(drive_set.motor), one_row(drive_set.gearhead)
    cycle, demand = turned(spec, drive_set, base)
    at_flange = loss_at_flange(spec, cycle, gearhead)
    ambient, feed = spec.environment.ambient, spec.feed_of(drive_set.controller, drive_set.brake)
    heating = heat(ambient, cycle, demand, motor, from_gearhead=at_flange)
    rise = np.where(np.isfinite(heating.winding), heating.winding, np.nan) - ambient
    drive = drives_of(ambient, cycle, demand, heating, motor, feed)._replace(held=rise, held_mean=rise)
    return drive, cycle, demand, heating


def turned(spec: RobotSpec, drive_set: DriveParts, base: Any = None) -> tuple[AtGearhead, Demands]:
    """Torque and speed of a drive over the load cycle of a spec; a stepper's own friction is in its pull-out torque."""
    turning = drive_set.motor
    if drive_set.steps:
        turning = replace(turning, friction_torque=0.0, viscous_friction=0.0)
    if base is None:  # cut as the search cut it
        base = at_gearhead(load_cycle(spec), drive_set.belt_efficiency, drive_set.quickest)
    cycle = base.behind(drive_set.belt_ratio)
    motor, gearhead, encoder = (one_row(part) for part in (turning, drive_set.gearhead, drive_set.encoder))
    return cycle, demands(cycle, motor, gearhead, encoder, drive_set.brake_inertia)


def waveform(found: SetCycle) -> Wave:
    """Current and voltage over the pieces of the cycle, of one candidate."""
    d, p = found.drive, found.pieces
    current, speed, rises = (np.stack(x, axis=-1) for x in ((p.I_0, p.I_1), (p.w_0, p.w_1), (p.rise_0, p.rise_1)))
    return Wave(p.duration, current[None], (d.emf * speed + (d.R + d.R_rise * rises) * current)[None])


def warming(found: SetCycle) -> Warming:
    """Mean square current and loss at the housing over the pieces of which a winding feels the mean."""
    d, p = found.drive, found.pieces
    loss = d.friction * (np.abs(p.w_0) + np.abs(p.w_1)) / 2.0 + d.iron * mean_square(p.w_0, p.w_1)
    square: Array = np.asarray(mean_square(p.I_0, p.I_1))
    return Warming(p.duration, square, loss)


# -- Warm-up of a motor from cold to the periodic steady state: for figures.
#
# Within pieces of constant losses both bodies move in closed form (see ``heat_step``); a cycle maps the rises at its
# start to those at its end, so that any later cycle is reached by powers of that map and none has to be gone
# through. Symbols: w winding and h housing: rises over ambient [K].


_NEAR = 0.01  # of the rise from cold: no visible change any more
_SHOWN = 60  # cycles of which temperatures are reported
_MOST_CYCLES = 1e7  # cycles: longer nobody waits
_STEP = 0.25  # of the winding's time constant, the first piece of a span
_PIECES = 24  # of a span, each longer than the one before


class WarmUp(NamedTuple):
    """Temperatures from cold to the periodic steady state [K]."""

    time: Array  # s, at the end of each of these cycles; 0 first
    lowest: Array  # K, of the winding in each of these cycles
    highest: Array
    housing: Array  # K, at these times
    periodic: HeatCycle


def finer(found: Warming, constant: float) -> Warming:
    """The same pieces, cut so that a curve through their ends shows how the winding follows."""
    first = np.minimum(_STEP * constant / found.duration, 1.0)
    count = np.where(first < 1.0 / _PIECES, _PIECES, np.ceil(1.0 / first)).astype(np.int64)
    owner = np.repeat(np.arange(len(count)), count)
    place = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
    even, power = place / count[owner], np.maximum(1.0, np.log(first) / -np.log(np.maximum(count, 2)))[owner]
    start, end = even**power, ((place + 1) / count[owner]) ** power
    return Warming(found.duration[owner] * (end - start), found.square[owner], found.loss[owner])


def warm_up(motor: TwoBodies, ambient: float, found: Warming) -> WarmUp | None:
    """Temperatures from cold to the periodic steady state; None where a figure is unknown or the motor runs away."""
    if not motor.known:
        return None
    some = finer(found, float(motor.tau_w))
    cycle = periodic_heat(motor, ambient, some.duration, some.square, some.loss)
    if not math.isfinite(cycle.winding_peak):
        return None
    course, settled = _approach(motor, ambient, some), np.array([cycle.winding[0], cycle.housing[0]]) - ambient
    one_more = np.stack([course.rises(*unit)[:, -1, 0] for unit in np.eye(2)], axis=1)
    numbers = _numbers(cycle.spectral_radius)
    starts = [-(np.linalg.matrix_power(one_more, n) @ settled) for n in numbers]  # K, from the cycle that repeats
    away = [np.column_stack([start, course.rises(*start)[:, :, 0]]) for start in starts]
    winding = [cycle.winding + x[0] for x in away]
    return WarmUp(
        time=np.append(0.0, (np.array(numbers) + 1) * float(found.duration.sum())),
        lowest=np.array([x.min() for x in winding]),
        highest=np.array([x.max() for x in winding]),
        housing=np.append(ambient, [cycle.housing[-1] + x[1, -1] for x in away]),
        periodic=cycle,
    )


def _approach(motor: TwoBodies, ambient: float, found: Warming) -> Course:
    """Decay of the difference to the periodic steady state, piece by piece: the same equations without a source."""
    some = periodic(motor, ambient, *(x[:, None] for x in found))
    maps = np.zeros((2, 3, len(found.duration), 1))
    for column, unit in enumerate(np.eye(2)):
        slopes = some.span.slopes(*unit)
        for row, (slope, pull) in enumerate(zip(slopes, some.span.pulls(*slopes), strict=True)):
            maps[row, column] = some.weight.slope * slope + some.weight.pull * pull
    return Course(maps)


def _numbers(radius: float) -> list[int]:
    """Cycles of which temperatures are reported: all, or some, until a share of the rise is left."""
    last = math.log(_NEAR) / math.log(radius) if radius > 0.0 else 0.0
    count = int(min(max(math.ceil(last), 3), _MOST_CYCLES))
    return sorted({round(n) for n in np.linspace(0, count - 1, min(count, _SHOWN))})


# -- The motor's own torque piece by piece: accelerate, run, brake, rest, and the whole cycle.
#
# Torque of the motor is :math:`c f(t)`, its coefficients times the six functions of the load cycle (``physics``),
# rotor and friction included; its current that over :math:`k_t`. Segments of one kind that follow one another are
# one piece: speed and its change decide the kind. The RMS over the whole is that of all pieces, :math:`\tau_{rms} =
# \sqrt{\sum \tau_k^2 t_k / \sum t_k}`.
#
# Worked example: a load of 0.474 kg·cm² and 0.035 N·m at a motor of 0.00629 kg·cm² takes 0.186 N·m to reach 3000 rpm
# in 0.1 s (Yaskawa, E-S series product manual, 2.4.1, verification of the servomotor).


_MOST_PIECES = 24  # pieces; where there are more, those of one kind are put together
_KINDS = {(0, 0): "rest", (1, 0): "run", (1, 1): "accelerate", (1, -1): "brake"}
_MOTIONS = ("rest", "brake", "run", "accelerate", "brake back", "run back", "accelerate back")  # as in ``groups``


def motor_pieces(cycle: AtGearhead, demand: Demands, torque_constant: float, case: str = "") -> tuple[MotorPiece, ...]:
    """The pieces of a drive's cycle in the order of time, and last the whole of it."""
    load, looked = cycle.load_cycle, cycle.base.census
    if looked is not None and looked.runs > _MOST_PIECES:
        return _of_kinds(cycle, looked, demand, torque_constant, case)
    torque = cycle.functions @ demand.coefficients[0] if demand.complete[0] else np.full_like(load.torque, nan)
    speed = np.abs(load.speed) * cycle.belt * float(demand.total_ratio[0])
    start = np.cumsum(load.duration) - load.duration

    def piece(name: str, rows: NDArray[np.int64]) -> MotorPiece:
        mean = rms(load.duration[rows], torque[rows])
        most = _largest(torque[rows])
        return MotorPiece(
            case=case, name=name, start=float(start[rows[0]]), duration=float(load.duration[rows].sum()),
            speed=float(speed[rows].max()), load_torque=_largest(load.torque[rows]), motor_torque=most,
            rms_torque=mean, current=abs(most) / torque_constant, rms_current=mean / torque_constant,
        )  # fmt: skip

    whole = np.arange(len(load.duration))
    return *(piece(name, rows) for name, rows in _grouped(_names(load.speed, load.acceleration))), piece("cycle", whole)


def _names(speed: Array, acceleration: Array) -> list[str]:
    """The kind of each segment."""
    mean, slope = speed.mean(axis=1), acceleration.mean(axis=1)
    level = np.abs(slope) <= LEVEL * np.abs(acceleration).max()
    going = np.sign(mean).astype(int)
    gaining = np.where(level, 0, np.sign(slope * going)).astype(int)
    return [
        _KINDS[abs(g), s if g else 0] + (" back" if g < 0 else "")
        for g, s in zip(going.tolist(), gaining.tolist(), strict=True)
    ]


def _grouped(names: list[str]) -> Iterator[tuple[str, NDArray[np.int64]]]:
    """Rows of each piece: segments of one kind that follow one another, or all of a kind where pieces are many."""
    edges = [0, *(n for n in range(1, len(names)) if names[n] != names[n - 1]), len(names)]
    if len(edges) - 1 <= _MOST_PIECES:
        yield from ((names[a], np.arange(a, b)) for a, b in pairwise(edges))
        return
    for name in dict.fromkeys(names):
        yield name, np.flatnonzero([one == name for one in names])


def _of_kinds(
    cycle: AtGearhead, looked: Census, demand: Demands, torque_constant: float, case: str
) -> tuple[MotorPiece, ...]:
    """The same of a long cycle, all segments of a kind together, from what it is made of."""
    c, total_ratio = demand.coefficients[0] * cycle.scale, float(demand.total_ratio[0])
    c = c if demand.complete[0] else np.full(6, nan)
    factors = cycle.base.factors

    def piece(name: str, groups: list[Group]) -> MotorPiece:
        duration = sum(float(one.sums[at.LASTS]) for one in groups)
        square = sum(float(c @ one.moments(factors[one.torque]) @ c) for one in groups)
        mean = float(np.sqrt(max(square, 0.0) / duration)) if demand.complete[0] else nan
        most = _farthest([one.functions(k, factors[one.torque]) @ c for k in range(2) for one in groups])
        load = _farthest([one.functions(k, 1.0)[:, one.torque] for k in range(2) for one in groups])
        return MotorPiece(
            case=case, name=name, start=min(float(one.sums[at.STARTS]) for one in groups), duration=duration,
            speed=max(float(one.sums[at.MOST_W]) for one in groups) * cycle.belt * total_ratio, load_torque=load,
            motor_torque=most, rms_torque=mean, current=abs(most) / torque_constant,
            rms_current=mean / torque_constant,
        )  # fmt: skip

    kinds = sorted({one.motion for one in looked.groups}, key=lambda k: min(looked.starts(k)))
    of = {k: [one for one in looked.groups if one.motion == k] for k in kinds}
    return *(piece(_MOTIONS[k], of[k]) for k in kinds), piece("cycle", looked.groups)


def _farthest(values: list[Array]) -> float:
    """The value of the largest amount, with its sign."""
    return _largest(np.concatenate(values))


def _largest(values: Array) -> float:
    """The value of the largest amount, with its sign."""
    flat = values.ravel()
    return float(flat[first_largest(np.abs(flat))[1]])
