"""A set that moves its machine: at full voltage from where its motion starts, and swinging with the terminals open.

The load has the torque of its spec at each place of the path, by direction and at rest; the path of a lever goes on
beyond its ends. The engine of the closed loop has its load by the time of a reference that the machine follows, and
closed terminals; here the place is what is sought. Steps of time are drift, kick and drift: between the two halves of
a step's travel the speed follows its exponential under the torque half-way. Samples are columns.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drivesizer.load_cases import profile_of
from drivesizer.load_cases.platform import at_shaft
from drivesizer.loads.course import course
from drivesizer.physics.drive_train import through_gears
from drivesizer.physics.figures import Array
from drivesizer.prediction.set_at_voltage import SetAtVoltage
from drivesizer.spec.robot import RobotSpec

_PLACES = 73  # along the path: each 5 deg of a whole turn
_STEPS = 3000
_LONG = 4.0  # times what the way takes at free speed, with the time constants of the start
_SWINGS = 3.0  # periods of small swings within which the first one ends
_MOMENTS = 121  # moments of a course
_MOST_ARRIVE = 0.95  # of the samples, at its end


class Machine(NamedTuple):
    """A machine's load at its driven shaft, one drive's share, and the belt before it [SI]."""

    axis: str  # linear or rotary: of its load
    radius: float  # m, travel of the load per angle of the shaft; 1 where it turns with it
    belt: float  # ratio
    efficiency: float  # of the belt
    inertia: float
    angle: Array  # of the shaft from where the motion starts, rising
    torque: Array  # against forward motion: rows backward, at rest, forward
    end: float  # of the path, farthest from its start
    steepest: float  # of the path, where weight turns most; NaN of a load without a lever

    def against(self, angle: Array) -> list[Array]:
        """Torque against forward motion at angles: of backward motion, at rest, of forward motion."""
        return [np.asarray(np.interp(angle, self.angle, row)) for row in self.torque]


def machine_of(spec: RobotSpec) -> Machine | None:
    """The machine of a spec; None of one whose load is a recording, or of no fixed radius."""
    if spec.load.of_shaft or spec.load.kind == "recorded":
        return None
    first, path, turns = at_shaft(spec), course(profile_of(spec)).position, spec.load.lever is not None
    low, high = (float(x) for x in (path.min(), path.max()))
    if not high > low:
        return None
    places = np.linspace(-2.0 * np.pi, 2.0 * np.pi, 2 * _PLACES - 1) if turns else np.linspace(low, high, 2)
    at = [at_shaft(spec, float(place)) for place in places]
    torque = np.array([[piece.backward_torque, piece.rest_torque, piece.forward_torque] for piece in at]).T
    on_path = (places >= low) & (places <= high)
    steepest = float(places[on_path][np.abs(torque[1, on_path]).argmax()]) if turns and on_path.any() else np.nan
    end = high if high >= -low else low
    return Machine(spec.load.axis, first.radius, spec.belt_ratios[0], spec.belt_efficiency, first.inertia,
                   places / first.radius, torque, end / first.radius, steepest / first.radius)  # fmt: skip


class Run(NamedTuple):
    """A movement over time: columns over samples [SI]."""

    time: Array
    angle: Array  # of the driven shaft, from where the motion starts
    speed: Array  # of the motor
    current: Array

    def course(self, of: Machine, ratio: Array, until: float) -> Run:
        """Some moments up to a time, with position and speed of the load."""
        last = int(np.searchsorted(self.time, min(until, self.time[-1])))
        rows = np.unique(np.linspace(0, last, _MOMENTS).astype(np.intp))
        position, speed = of.radius * self.angle[rows], of.radius * self.speed[rows] / (ratio * of.belt)
        return Run(self.time[rows], position, speed, self.current[rows])


def _run(drive_set: SetAtVoltage, of: Machine, ambient: float, voltage: Array, start: float, until: float) -> Run:
    """From rest at an angle on; a voltage of NaN: the terminals are open."""
    winding, drive = drive_set.winding(ambient), drive_set.drive
    K, dt = drive.ratio * of.belt, until / _STEPS
    driving, braking = np.array(through_gears(K, drive.efficiency * of.efficiency))
    most = np.minimum(
        drive_set.most_current * winding.k_t,
        drive_set.most_torque / (drive.ratio * drive.efficiency) + drive_set.coulomb,
    )
    angle, speed = np.full(len(K), start), np.zeros(len(K))
    states = [(angle, speed)]

    def unlimited(speed: Array) -> tuple[Array, Array]:
        """Resistance with what commutation takes, and torque at full voltage."""
        R = winding.R + winding.X * np.abs(speed)
        return R, np.nan_to_num(winding.k_t * (voltage - winding.k_e * speed) / R)

    for _ in range(_STEPS):
        angle = angle + speed * dt / (2.0 * K)
        R, push = unlimited(speed)
        limited = np.isnan(voltage) | (np.abs(push) > most)
        push = np.where(limited, np.clip(push, -most, most), winding.k_t * voltage / R)
        damping = drive.viscous + np.where(limited, 0.0, winding.k_t * winding.k_e / R)
        back, rest, forth = of.against(angle)
        # what starts it from rest: the push against weight and what hinders, at once
        up = push > forth * np.where(forth > 0.0, driving, braking) + drive_set.coulomb
        down = push < back * np.where(back < 0.0, driving, braking) - drive_set.coulomb
        way = np.where(speed != 0.0, np.sign(speed), up * 1.0 - down * 1.0)
        load = np.where(way > 0.0, forth, np.where(way < 0.0, back, rest))
        left = push - damping * speed - drive_set.coulomb * way
        pays = (load * K * drive.inertia + of.inertia * left) * way > 0.0  # as ``control.engine`` has the power's way
        share = np.where(pays, driving, braking)
        J = drive.inertia + of.inertia * share / K
        rate, faded = (left - load * share) / J, damping * dt / J
        after = speed + rate * dt * np.where(faded > 0.0, -np.expm1(-faded) / np.where(faded > 0.0, faded, 1.0), 1.0)
        after = np.where((way == 0.0) | (speed * after < 0.0), 0.0, after)
        angle, speed = angle + after * dt / (2.0 * K), after
        states.append((angle, speed))
    angles, speeds = (np.array(column) for column in zip(*states, strict=True))
    currents = np.clip(unlimited(speeds)[1], -most, most) / winding.k_t
    return Run(np.linspace(0.0, until, _STEPS + 1), angles, speeds, currents)


def _first(time: Array, reached: Array) -> Array:
    """The time at which each sample has first reached something; infinite where it has not."""
    return np.where(reached.any(axis=0), time[reached.argmax(axis=0)], np.inf)


Movement = tuple[dict[str, Array], Run | None]  # figures of a movement by name, and its course


def started(drive_set: SetAtVoltage, of: Machine, ambient: float) -> Movement:
    """Full voltage from rest where the motion starts: times to its end and to 63 % of the largest speed, that speed."""
    way, K = np.sign(of.end), drive_set.drive.ratio * of.belt
    free, winding = drive_set.running(0.0, ambient)[0], drive_set.winding(ambient)
    J = drive_set.drive.inertia + of.inertia / (K**2 * drive_set.drive.efficiency * of.efficiency)
    constants = J * winding.R / (winding.k_t * winding.k_e)
    until = _LONG * float(np.median(np.abs(of.end) * K / free + constants))
    if not until > 0.0:
        return {}, None
    run = _run(drive_set, of, ambient, way * drive_set.voltage, 0.0, until)
    there = way * (run.angle - of.end) >= 0.0
    arrives = _first(run.time, there)
    ends = np.minimum(arrives, _first(run.time, way * run.speed < 0.0))  # or it falls back
    fast = np.where(run.time[:, None] <= ends, way * run.speed, 0.0)
    top = fast.max(axis=0)
    figures = {
        "start_time": arrives,
        "start_time_63": np.where(top > 0.0, _first(run.time, fast >= (1.0 - np.exp(-1.0)) * top), np.inf),
        "start_speed": top / drive_set.drive.ratio,
    }
    return figures, run.course(of, drive_set.drive.ratio, float(np.quantile(arrives, _MOST_ARRIVE, method="higher")))


def swung(drive_set: SetAtVoltage, of: Machine, ambient: float) -> Movement:
    """Let go where weight turns it most, the terminals open: time of the first swing there and back, and its angle."""
    if np.isnan(of.steepest):
        return {}, None
    K = drive_set.drive.ratio * of.belt
    J = of.inertia + drive_set.drive.inertia * K**2
    pull = float(np.abs(of.torque[1]).max())
    until = (
        _SWINGS
        * 2.0
        * np.pi
        * float(np.sqrt(np.median(J + 0.0 * (drive_set.coulomb + drive_set.drive.viscous)) / pull))
    )
    if not 0.0 < until < np.inf:
        return {}, None
    run = _run(drive_set, of, ambient, np.full(len(K), np.nan), of.steepest, until)
    side = np.sign(run.speed)
    first = np.sign(side[np.minimum((side != 0.0).argmax(axis=0), len(side) - 1), np.arange(len(K))])
    turned = (side * first < 0.0) & (first != 0.0)  # it has turned back
    back = _first(run.time, turned)
    period = _first(run.time, (run.time[:, None] > back) & (side * first >= 0.0) & (first != 0.0))
    here = np.searchsorted(run.time, np.where(np.isfinite(back), back, run.time[-1]))
    figures = {
        "swing_half": back,
        "swing_period": period,
        "swing_reach": np.abs(run.angle[np.minimum(here, _STEPS), np.arange(len(K))] - of.steepest),
    }
    return figures, run.course(of, drive_set.drive.ratio, until)
