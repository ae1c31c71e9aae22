"""Steppers with their drivers against the load cycle: torque at each speed, starting, steps, and what they draw.

The torque of a motor is linear in the functions of the load cycle, and its pull-out torque falls with the speed. So
only points of the cycle count that no other exceeds in torque and in speed: the ends of segments, and between them
where the speed passes one of ``LEVELS`` levels. The current is the rated one at any speed: the driver sets it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from drivesizer.catalog.parts import PullOuts
from drivesizer.catalog.view import STEPPER
from drivesizer.machine.part_curves import available_torque
from drivesizer.machine.supply_power import Draw
from drivesizer.physics.cycle_at_gearhead import ACCELERATION, SPEED, AtGearhead
from drivesizer.physics.extremes import undominated
from drivesizer.physics.figures import Alike, Array, Columns, Figures, Mask, Whole
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.power_stage import bus_voltage
from drivesizer.physics.stepper import (
    amplitude,
    copper_loss,
    electrical_energy,
    idle_loss,
    natural_frequency,
    start_speed_with,
)
from drivesizer.physics.winding import Parts
from drivesizer.results.check_columns import CheckColumn, at_least, at_most
from drivesizer.results.problem import Problem
from drivesizer.results.ratings import controller_current
from drivesizer.search.columns.candidates import FREE, Rows
from drivesizer.search.columns.controllers import UNDECIDED, Powered, Required, Usable, controllers
from drivesizer.search.columns.limits import unknown_where_doubtful, worst_of_all
from drivesizer.search.columns.limits_over_time import bus_limit, cycle_figures
from drivesizer.spec.mounting import controller_needed
from drivesizer.spec.robot import RobotSpec

LEVELS = 64
_LEVEL = 1e-9  # of the largest acceleration of a cycle, up to which its speed is constant: fits are not exact
_CURVE = ("pull_out_share", "holding_torque", "nominal_current", "resistance", "inductance", "pole_pairs", STEPPER)
_FRONT = 300  # points that may be left of a cycle before the rest is kept unexamined
_CELLS = 400_000  # candidates times points or segments at a time
_APART = np.sqrt(2.0)  # of step rate and natural frequency, either way
_RATIO = 10.0  # load's inertia over the motor's, that makers advise not to exceed
_RESONANT = "steady step rate and natural frequency, at least this ratio apart: near it rotors swing: informational"
_HEAVY = "makers advise 10 at most with a ramp: informational"
_NO_SINK = "unknown: where it goes: give supply.capacitance, or supply.accepts: all of a battery or a brake resistor"


class Frictionless:
    """Figures of steppers for the demand of torque: pull-out torque is what their own friction leaves of it."""

    def __init__(self, motor: Columns) -> None:
        self.motor, self.rows = motor, motor.rows

    def on(self, rows: Whole | Mask | slice) -> Frictionless:
        """Some of them."""
        return Frictionless(self.motor.on(rows))

    def __getitem__(self, name: str) -> Alike:
        if name in ("friction_torque", "viscous_friction"):
            return np.zeros(len(self.motor["rotor_inertia"]))
        return self.motor[name]


class PullOut(NamedTuple):
    """Pull-out torque of motors: by printed curves, or by the model, times a factor of its tolerance."""

    motor: Figures
    curves: PullOuts
    factor: Alike = 1.0

    def torque(self, speed: Array, volts: Alike, rows: Whole | Mask | slice = slice(None)) -> Array:
        """At speeds, shape (rows, points) [N*m]."""
        count = max(len(self.motor["nominal_current"]), len(self.motor[STEPPER]))
        motor = {name: np.broadcast_to(self.motor[name], count)[rows] for name in _CURVE}
        volts = volts if np.ndim(volts) == 0 else np.broadcast_to(volts, count)[rows]
        torque: Array = available_torque(motor, self.curves, speed, volts)
        torque *= np.broadcast_to(self.factor, count)[rows][:, None]
        return torque


def stepped(
    problem: Problem,
    usable: Usable,
    cycles: Sequence[AtGearhead],
    demand: Sequence[Demands],
    parts: Parts,
    *,
    staged: bool,
) -> Powered:
    """Drivers, and every check of steppers that hangs on the load cycle."""
    catalog, motor, preset = problem.catalog, parts.motor, parts.controller
    current = motor["nominal_current"]
    thin = max(controller_needed(case.spec, 0.0) for case in problem.cases)
    row, _ = controllers(problem.spec, catalog, motor.rows, Required(current, amplitude(current), lasting=thin), usable)
    row = row if preset is None else np.where(preset.rows == FREE, row, preset.rows)
    parts = parts._replace(controller=Rows(catalog.controllers, row))
    of_driver = [usable.available(motor.rows, row), *driver_limits(current, parts.controller, thin, usable.ambient)]
    if problem.spec.control.phase_current is not None:
        of_driver.append(at_most("motor_nominal_current", current, catalog.steppers["phase_current"][motor[STEPPER]]))
    pull_out = PullOut(motor, catalog.pull_outs)
    in_cases = [*zip([case.spec for case in problem.cases], cycles, demand, strict=True)]
    first = worst_of_all(torque_limits(*case, parts, pull_out, advice=not staged) for case in in_cases)
    dead: Mask = np.logical_or.reduce([c.failed for c in (*first, *of_driver) if not c.advice])
    draws = [draw_of(*case, parts, ~(dead & staged)) for case in in_cases]
    printed = catalog.steppers["supply_max"][motor[STEPPER]]
    specs = (spec for spec, *_ in in_cases)
    last = worst_of_all(supply_limits(spec, draw, parts, printed) for spec, draw in zip(specs, draws, strict=True))
    idle = problem.spec.control.idle_current
    heat = max(float(idle_loss(at.cycle.speed, idle) @ at.cycle.duration) / at.cycle.total for at in problem.cases)
    figures = cycle_figures(
        problem, draws, joule_heat=heat * copper_loss(current, motor["resistance"]), peak_current=amplitude(current),
        winding_temperature=np.full(len(current), np.nan),
    )  # fmt: skip
    return Powered(row, [*first, *of_driver, *last], figures | {UNDECIDED: np.zeros(len(current))})


def driver_limits(current: Array, controller: Figures, needed: float, ambient: Alike) -> list[CheckColumn]:
    """Rated current of a phase, as RMS and amplitude of sinusoidal currents, against the driver's."""
    return [
        at_most("controller_continuous_current", current, controller_current(controller, ambient), needed=needed),
        at_most("controller_peak_current", amplitude(current), controller["peak_current"]),
    ]


# --- torque at each speed, and starting


def torque_limits(
    spec: RobotSpec, cycle: AtGearhead, demand: Demands, parts: Parts, pull_out: PullOut, *, advice: bool = False
) -> list[CheckColumn]:
    """Torque of motors against what they can give at their speed, at rest and at the start, and their steps."""
    checks = [
        _at_each_speed(spec, cycle, demand, pull_out),
        *_at_rest(spec, cycle, demand, parts, pull_out),
        *_resolution(spec, cycle, demand, parts),
        *(_advice(spec, cycle, demand, parts) if advice else ()),
    ]
    return unknown_where_doubtful(checks, demand.complete)


def _at_rest(
    spec: RobotSpec, cycle: AtGearhead, demand: Demands, parts: Parts, pull_out: PullOut
) -> Iterator[CheckColumn]:
    """Torque at a lower current at rest, and the speed at which motors start."""
    if spec.control.idle_current is None and spec.needs.start_speed is None:
        return
    needed, volts = spec.margins.pull_out - 1.0, spec.supply.lowest
    torque, speed = map(np.abs, ends_of(cycle, demand))
    at_rest = pull_out.torque(np.zeros((len(torque), 1)), volts)[:, 0]
    still: Mask = np.asarray(~speed.any(axis=2))
    if spec.control.idle_current is not None and still.any():
        holding_torque = np.where(still[:, :, None], torque, 0.0).max(axis=(1, 2))
        yield at_most("idle_torque", holding_torque, spec.control.idle_current * at_rest, needed=needed)
    if spec.needs.start_speed is not None:  # against the largest torque at constant speed
        changes = np.abs(cycle.base.functions[..., ACCELERATION] if cycle.base.functions.ndim == 3 else
                         np.moveaxis(cycle.base.functions[ACCELERATION], -1, 0))  # fmt: skip
        steady = np.broadcast_to(changes <= _LEVEL * changes.max(axis=(-2, -1), keepdims=True), torque.shape)
        load = np.where(steady, torque, -1.0).max(axis=(1, 2))
        load = np.where(load < 0.0, torque.max(axis=(1, 2)), load)
        motor, (_, inertia) = parts.motor, inertia_at_motor(cycle, demand)
        limit = start_speed_with(motor["start_speed"], motor["rotor_inertia"], inertia, load, at_rest)
        yield at_most("start_speed", spec.needs.start_speed, limit, needed=spec.margins.speed)


def _at_each_speed(spec: RobotSpec, cycle: AtGearhead, demand: Demands, pull_out: PullOut) -> CheckColumn:
    """The torque against the pull-out torque at its speed, at the worst moment: an unknown one where none fails."""
    worst = []
    for rows, torque, speed, time in _moments(cycle, demand):
        limit = pull_out.torque(speed, spec.supply.lowest, rows)
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(torque == 0.0, 0.0, torque / limit)
        unknown = np.isnan(share)
        known = np.where(unknown, -1.0, share).argmax(axis=1)
        index = np.arange(len(torque))
        fails = share[index, known] * spec.margins.pull_out > 1.0
        place = np.where(unknown.any(axis=1) & ~fails, unknown.argmax(axis=1), known)
        worst.append([np.broadcast_to(x, torque.shape)[index, place] for x in (torque, limit, time)])
    torque, limit, time = (np.concatenate(column) for column in zip(*worst, strict=True))
    return at_most("pull_out_torque", torque, limit, needed=spec.margins.pull_out - 1.0, time=time)


def ends_of(cycle: AtGearhead, demand: Demands, rows: Whole | Mask | slice = slice(None)) -> tuple[Array, Array]:
    """Torque and speed of motors at both ends of each segment, with their signs: shape (rows, segments, 2)."""
    functions, ratio = cycle.base.functions, demand.total_ratio * cycle.belt
    if cycle.base.functions.ndim == 3:
        c = (demand.coefficients * cycle.scale)[rows]
        return np.einsum("nk,sek->nse", c, functions), functions[None, :, :, SPEED] * ratio[rows, None, None]
    torque = np.moveaxis(np.asarray(cycle.line(demand.coefficients)), -1, 0)
    speed = np.moveaxis(functions[SPEED], -1, 0) * np.broadcast_to(ratio, len(torque))[:, None, None]
    return torque[rows], speed[rows]


def _moments(cycle: AtGearhead, demand: Demands) -> Iterator[tuple[slice, Array, Array, Array]]:
    """Torque and speed of some motors at a time where one of them may be the worst, shape (rows, moments), and when.

    Of one load cycle at points that none exceeds in torque and speed. Of a cycle of each sample at all ends and, where
    the slower end has the larger torque, where the speed passes a level.
    """
    count = len(demand.total_ratio)
    if cycle.base.functions.ndim == 3:
        points, when = _points(cycle)
        c, ratio = demand.coefficients * cycle.scale, demand.total_ratio * cycle.belt
        for rows in _slices(count, max(_CELLS // len(points), 1)):
            yield rows, np.abs(c[rows] @ points.T), np.abs(points[:, SPEED]) * ratio[rows, None], when
        return
    torque, speed = ends_of(cycle, demand)
    speed, time = np.abs(speed), np.moveaxis(np.broadcast_to(cycle.base.time, cycle.base.functions.shape[1:]), -1, 0)
    time, falls = np.broadcast_to(time, torque.shape), np.diff(np.abs(torque), axis=2) * np.diff(speed, axis=2) < 0.0
    slow = np.flatnonzero(falls.any(axis=(0, 2)))
    for rows in _slices(count, max(_CELLS // (2 * torque.shape[1] + LEVELS * len(slow)), 1)):
        columns = [x[rows] for x in (torque, speed, time)]
        level = columns[1].max(axis=(1, 2))[:, None, None] * (np.arange(1, LEVELS) / LEVELS)
        w0, w1 = (columns[1][:, slow, end, None] for end in (0, 1))
        inside = (w0 - level) * (w1 - level) < 0.0
        along = np.where(inside, (level - w0) / np.where(inside, w1 - w0, 1.0), 0.0)
        moments = []
        for x in columns:
            x0, x1 = (x[:, slow, end, None] for end in (0, 1))
            flat = (whole.reshape(len(x), -1) for whole in (x, x0 + along * (x1 - x0)))
            moments.append(np.concatenate([*flat], axis=1))
        yield rows, np.abs(moments[0]), moments[1], moments[2]


def _points(cycle: AtGearhead) -> tuple[Array, Array]:
    """Points that none exceeds in torque and speed, behind a belt of ratio 1, and when they are met [s]."""
    store, functions, time = cycle.base.coarse, cycle.base.functions, cycle.base.time
    name = ("pull-out", LEVELS)
    if name not in store:
        points = np.concatenate([functions.reshape(-1, 6), *_between(functions, functions)])
        when = np.concatenate([time.reshape(-1), *(x[:, 0] for x in _between(functions, time[:, :, None]))])
        speed = np.abs(points[:, SPEED : SPEED + 1])
        sides = (undominated(np.hstack([sign * points[:, :SPEED], speed]), _FRONT) for sign in (1.0, -1.0))
        rows = np.unique(np.concatenate(list(sides)))
        store[name] = points[rows], when[rows]
    return store[name]


def _between(functions: Array, lines: Array) -> Iterator[Array]:
    """Of straight lines what they are where the speed passes a level, level by level."""
    left, right = np.abs(functions[:, 0, SPEED]), np.abs(functions[:, 1, SPEED])
    for level in np.linspace(0.0, max(left.max(), right.max()), LEVELS + 1)[1:-1]:
        rows = np.flatnonzero((left - level) * (right - level) < 0.0)
        share = ((level - left[rows]) / (right[rows] - left[rows]))[:, None]
        yield lines[rows, 0] + share * (lines[rows, 1] - lines[rows, 0])


def inertia_at_motor(cycle: AtGearhead, demand: Demands) -> tuple[Array, Array]:
    """Inertia of the load and of all that turns with it."""
    load = cycle.load_cycle.inertia / (demand.total_ratio * cycle.belt) ** 2
    return load, load + demand.coefficients[:, ACCELERATION] / demand.total_ratio


def _resolution(spec: RobotSpec, cycle: AtGearhead, demand: Demands, parts: Parts) -> list[CheckColumn]:
    """Angle of a microstep at the load; of a full step, where the driver's are unknown and that is fine enough.

    Microsteps are those of the spec, as far as the driver has them; else its finest.
    """
    need = spec.needs.resolution_at_load
    if need is None:
        return []
    geared = cycle.belt if spec.gear is None else cycle.belt * spec.gear.ratio
    full = 2.0 * np.pi / (4.0 * parts.motor["pole_pairs"] * demand.total_ratio * geared)
    microsteps = np.nan if spec.control.microsteps is None else spec.control.microsteps
    micro = full / np.fmin(parts.controller["microsteps"], microsteps)
    return [at_most("step_resolution", np.where(np.isnan(micro) & (full <= need), full, micro), need)]


def _advice(spec: RobotSpec, cycle: AtGearhead, demand: Demands, parts: Parts) -> list[CheckColumn]:
    """Advice on inertia and resonance."""
    motor, checks = parts.motor, list[CheckColumn]()
    steps = 4.0 * motor["pole_pairs"]
    load, inertia = inertia_at_motor(cycle, demand)
    if spec.needs.inertia_ratio is None:
        with np.errstate(divide="ignore"):
            ratio = np.where(demand.left_out[:, ACCELERATION], np.nan, load / (inertia - load))  # of an unknown rotor
        checks.append(at_most("inertia_ratio", ratio, _RATIO, advice=True, note=_HEAVY))
    ends = np.abs(cycle.base.functions[:, :, SPEED])
    steady = np.unique(ends[(ends[:, 0] == ends[:, 1]) & (ends[:, 0] > 0.0), 0])
    if len(steady):
        swings = natural_frequency(motor["pole_pairs"], motor["holding_torque"], inertia)
        rate = steady * (demand.total_ratio * cycle.belt * steps / (2.0 * np.pi))[:, None]
        apart = np.exp(np.abs(np.log(rate / swings[:, None]))).min(axis=1)
        checks.append(at_least("step_resonance", _APART, apart, advice=True, note=_RESONANT))
    return checks


# --- supply


def draw_of(spec: RobotSpec, cycle: AtGearhead, demand: Demands, parts: Parts, mask: Mask | None = None) -> Draw:
    """Energy and power out of the supply of the drives of a mask, with the standby power of their drivers."""
    count, functions = len(demand.total_ratio), cycle.base.functions
    rows = np.arange(count) if mask is None else np.flatnonzero(mask)
    speed = functions[:, :, SPEED] if cycle.base.functions.ndim == 3 else functions[SPEED] * cycle.belt
    share = idle_loss(speed, spec.control.idle_current).T
    duration, columns = np.asarray(cycle.load_cycle.duration).T, np.full((3, count), np.nan)
    loss = np.broadcast_to(copper_loss(parts.motor["nominal_current"], parts.motor["resistance"]), count)
    standby = np.broadcast_to(spec.feed(parts.controller).stage.standby, count)
    for few in _slices(len(rows), max(_CELLS // len(cycle.load_cycle.duration), 1)):
        batch = rows[few]
        lost = loss[batch, None] * (
            share if share.ndim == 1 else np.broadcast_to(share, (count, share.shape[1]))[batch]
        )
        torque, turning = ends_of(cycle, demand, batch)
        own = duration if duration.ndim == 1 or len(duration) == 1 else duration[batch]
        energies = electrical_energy(own, torque, turning, lost + standby[batch, None])
        columns[:, batch] = *energies[:2], np.maximum(energies[2], 0.0)
    return Draw(*np.where(demand.complete, columns, np.nan))


def supply_limits(spec: RobotSpec, draw: Draw, parts: Parts, printed: Array) -> list[CheckColumn]:
    """The supply's voltage against the motor's, its current and power, and the bus where energy is regenerated."""
    supply, torque, power = spec.supply, spec.margins.torque, draw.peak * spec.load.motors
    none, stays = draw.returned == 0.0, (1.0 - supply.regeneration) * draw.returned * spec.load.motors
    raised = np.nan if supply.capacitance is None else bus_voltage(supply.highest, stays, supply.capacitance)
    bus = np.where(none | spec.accepts_all, supply.highest, raised)  # as if all of a cycle came at once
    checks = [
        at_most("supply_voltage", supply.highest, np.where(np.isnan(printed), np.inf, printed)),
        bus_limit(spec, bus, np.where(none, np.inf, parts.controller["supply_max"]), undecided=_NO_SINK),
    ]
    if supply.current is not None:
        checks.append(at_most("supply_current", power / supply.lowest, supply.current, needed=torque))
    if supply.power is not None:
        checks.append(at_most("supply_power", power, supply.power, needed=torque))
    return checks


def _slices(count: int, size: int) -> Iterator[slice]:
    return (slice(start, start + size) for start in range(0, max(count, 1), size))
