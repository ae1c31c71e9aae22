"""Steppers with their drivers against the load cycle: torque at each speed, starting, steps, and what they draw.

The torque of a motor is linear in the functions of the load cycle, and its pull-out torque falls with the speed. So
only points of the cycle count that no other exceeds in torque and in speed: the ends of segments, and between them
where the speed passes one of ``LEVELS`` levels. The current is the rated one at any speed: the driver sets it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import PullOuts
from drivesizer.catalog.view.mounted import STEPPER
from drivesizer.machine.part_curves import available_torque
from drivesizer.physics.cycle_at_gearhead import ACCELERATION, SPEED, AtGearhead
from drivesizer.physics.extremes import undominated
from drivesizer.physics.figures import Figures
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
from drivesizer.search.columns.controllers import Required, controllers
from drivesizer.search.columns.limits_over_time import bus_limit
from drivesizer.search.columns.offers import Offers, unknown_where_doubtful, worst_of_all
from drivesizer.spec.mounting import controller_needed
from drivesizer.spec.robot import RobotSpec

__all__ = [
    "LEVELS", "Frictionless", "driver_limits", "inertia_at_motor", "resolution_limits", "start_limits", "stepped",
    "supply_limits",
]  # fmt: skip

Array = NDArray[np.float64]
LEVELS = 64
_FRONT = 300  # points that may be left of a cycle before the rest is kept unexamined
_CELLS = 400_000  # candidates times points or segments at a time
_APART = np.sqrt(2.0)  # of step rate and natural frequency, either way
_RATIO = 10.0  # load's inertia over the motor's, that makers advise not to exceed
_RESONANT = "steady step rate and natural frequency, at least this ratio apart: near it rotors swing: informational"
_HEAVY = "makers advise 10 at most with a ramp: informational"
_KEPT = "unknown: where it goes: give supply.capacitance, or supply.accepts: all of a battery or a brake resistor"


class Frictionless:
    """Figures of steppers for the demand of torque: pull-out torque is what their own friction leaves of it."""

    def __init__(self, motor: Figures) -> None:
        self.motor = motor

    def __getitem__(self, name: str) -> Any:
        if name in ("friction_torque", "viscous_friction"):
            return np.zeros(len(self.motor["rotor_inertia"]))
        return self.motor[name]


class _Draw(NamedTuple):
    """Energy and power of one load case: columns."""

    drawn: Array  # J per cycle
    returned: Array
    power: Array  # W, largest


class Stepped(NamedTuple):
    """Candidates with their drivers."""

    controller: NDArray[np.int64]  # row of each
    checks: list[CheckColumn]
    figures: dict[str, Array]


def stepped(
    problem: Problem,
    offered: Offers,
    cycles: Sequence[AtGearhead],
    demand: Sequence[Demands],
    parts: Parts,
    *,
    staged: bool,
) -> Stepped:
    """Drivers, and every check of steppers that hangs on the load cycle."""
    catalog, motor = problem.catalog, parts.motor
    current = motor["nominal_current"]
    thin = max(controller_needed(case.spec, 0.0) for case in problem.cases)
    required = Required(current, amplitude(current), lasting=thin)
    chosen = controllers(problem.spec, catalog, motor.rows, required, offered.controllers)
    given = None if parts.controller is None else parts.controller.rows
    row = chosen.row if given is None else np.where(given == FREE, chosen.row, given)
    parts = parts._replace(controller=Rows(catalog.controllers, row))
    of_driver = [
        offered.controllers.available(motor.rows, row),
        *driver_limits(current, parts.controller, thin, offered.controllers.ambient),
    ]
    if problem.spec.control.phase_current is not None:
        of_driver.append(at_most("motor_nominal_current", current, catalog.steppers["phase_current"][motor[STEPPER]]))

    def moving(k: int) -> list[CheckColumn]:
        spec = problem.cases[k].spec
        found = [
            _torque_limit(spec, cycles[k], demand[k], parts, catalog.pull_outs),
            *_idle(spec, cycles[k], demand[k], parts, catalog.pull_outs),
            *_starting(spec, cycles[k], demand[k], parts, catalog.pull_outs),
            *resolution_limits(spec, cycles[k], demand[k], parts),
            *([] if staged else _advice(spec, cycles[k], demand[k], parts)),
        ]
        return unknown_where_doubtful(found, demand[k].complete)

    first = worst_of_all(problem, moving)
    dead: NDArray[np.bool_] = np.logical_or.reduce([c.failed for c in (*first, *of_driver) if not c.advice])
    draws = [_draw(problem.cases[k].spec, cycles[k], demand[k], parts, ~(dead & staged)) for k in range(len(cycles))]
    printed = catalog.steppers["supply_max"][motor[STEPPER]]
    last = worst_of_all(
        problem, lambda k: supply_limits(problem.cases[k].spec, draws[k].returned, draws[k].power, parts, printed)
    )
    return Stepped(row, [*first, *of_driver, *last], _figures(problem, draws, motor))


def driver_limits(current: Array, controller: Figures, needed: float, ambient: Any) -> list[CheckColumn]:
    """Rated current of a phase, as RMS and amplitude of sinusoidal currents, against the driver's."""
    return [
        at_most("controller_continuous_current", current, controller_current(controller, ambient), needed=needed),
        at_most("controller_peak_current", amplitude(current), controller["peak_current"]),
    ]


# --- torque ----------------------------------------------------------------------------------------------------------


def _torque_limit(spec: RobotSpec, cycle: AtGearhead, demand: Demands, parts: Parts, curves: PullOuts) -> CheckColumn:
    """The torque against the pull-out torque at its speed, at the worst moment, some candidates at a time."""
    points, when = _points(cycle)
    c, ratio = _at_belt(cycle, demand)
    size = max(_CELLS // len(points), 1)
    found = [_worst(spec, points, c[k], ratio[k], parts.motor.on(k), curves) for k in _slices(len(ratio), size)]
    torque, limit, place = (np.concatenate(column) for column in zip(*found, strict=True))
    return at_most("pull_out_torque", torque, limit, needed=spec.margins.pull_out - 1.0, time=when[place])


def _idle(spec: RobotSpec, cycle: AtGearhead, demand: Demands, parts: Parts, curves: PullOuts) -> list[CheckColumn]:
    """The torque at rest against what the idle current leaves of the torque at low speed."""
    idle, functions = spec.control.idle_current, cycle.base.functions
    rests = functions[~functions[:, :, SPEED].any(axis=1)].reshape(-1, 6)
    if idle is None or not len(rests):
        return []
    torque = np.abs(_at_belt(cycle, demand)[0] @ rests.T).max(axis=1)
    limit = available_torque(parts.motor, curves, np.zeros((len(torque), 1)), spec.supply.lowest)[:, 0]
    return [at_most("idle_torque", torque, idle * limit, needed=spec.margins.pull_out - 1.0)]


def _at_belt(cycle: AtGearhead, demand: Demands) -> tuple[Array, Array]:
    """Coefficients and total ratios with the belt's scale in them: of the functions behind a belt of ratio 1.

    So candidates behind any belt are computed in one go.
    """
    return demand.coefficients * cycle.scale, demand.total_ratio * cycle.belt


def _worst(
    spec: RobotSpec, points: Array, c: Array, ratio: Array, motor: Figures, curves: PullOuts
) -> tuple[Array, Array, NDArray[np.int64]]:
    """Torque, pull-out torque and number of the point of the largest share; of an unknown one where none fails."""
    torque, speed = np.abs(c @ points.T), np.abs(points[:, SPEED]) * ratio[:, None]
    limit = available_torque(motor, curves, speed, spec.supply.lowest)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(torque == 0.0, 0.0, torque / limit)
    unknown = np.isnan(share)
    known = np.where(unknown, -1.0, share).argmax(axis=1)
    every = np.arange(len(torque))
    fails = share[every, known] * spec.margins.pull_out > 1.0
    place = np.where(unknown.any(axis=1) & ~fails, unknown.argmax(axis=1), known)
    return torque[every, place], limit[every, place], place


def _points(cycle: AtGearhead) -> tuple[Array, Array]:
    """Points that none exceeds in torque and speed, behind a belt of ratio 1, and when they are met [s]."""
    store = cycle.base.coarse
    name = ("pull-out", LEVELS)
    if name not in store:
        store[name] = _front(cycle.base.functions, cycle.base.time)
    found: tuple[Array, Array] = store[name]
    return found


def _front(functions: Array, time: Array) -> tuple[Array, Array]:
    every = np.concatenate([functions.reshape(-1, 6), *_between(functions, functions)])
    when = np.concatenate([time.reshape(-1), *(x[:, 0] for x in _between(functions, time[:, :, None]))])
    speed = np.abs(every[:, SPEED : SPEED + 1])
    sides = (undominated(np.hstack([sign * every[:, :SPEED], speed]), _FRONT) for sign in (1.0, -1.0))
    rows = np.unique(np.concatenate(list(sides)))
    return every[rows], when[rows]


def _between(functions: Array, lines: Array) -> Iterator[Array]:
    """Of straight lines what they are where the speed passes a level, level by level."""
    left, right = np.abs(functions[:, 0, SPEED]), np.abs(functions[:, 1, SPEED])
    for level in np.linspace(0.0, max(left.max(), right.max()), LEVELS + 1)[1:-1]:
        rows = np.flatnonzero((left - level) * (right - level) < 0.0)
        share = ((level - left[rows]) / (right[rows] - left[rows]))[:, None]
        yield lines[rows, 0] + share * (lines[rows, 1] - lines[rows, 0])


# --- starting and steps ----------------------------------------------------------------------------------------------


def inertia_at_motor(cycle: AtGearhead, demand: Demands) -> tuple[Array, Array]:
    """Inertia of the load and of all that turns with it."""
    load = cycle.load_cycle.inertia / (demand.total_ratio * cycle.belt) ** 2
    return load, load + demand.coefficients[:, ACCELERATION] / demand.total_ratio


def _starting(spec: RobotSpec, cycle: AtGearhead, demand: Demands, parts: Parts, curves: PullOuts) -> list[CheckColumn]:
    """The start without a ramp against the largest torque at constant speed."""
    if spec.needs.start_speed is None:
        return []
    functions = cycle.base.functions.reshape(-1, 6)
    steady = functions[functions[:, ACCELERATION] == 0.0]
    load = np.abs(_at_belt(cycle, demand)[0] @ (steady if len(steady) else functions).T).max(axis=1)
    return start_limits(spec, cycle, demand, parts, (load, available_torque(
        parts.motor, curves, np.zeros((len(load), 1)), spec.supply.lowest
    )[:, 0]))  # fmt: skip


def start_limits(
    spec: RobotSpec, cycle: AtGearhead, demand: Demands, parts: Parts, torques: tuple[Array, Array]
) -> list[CheckColumn]:
    """Speed to which the motor jumps without a ramp, against that at which it starts."""
    motor, (_, inertia) = parts.motor, inertia_at_motor(cycle, demand)
    limit = start_speed_with(motor["start_speed"], motor["rotor_inertia"], inertia, *torques)
    return [at_most("start_speed", spec.needs.start_speed, limit, needed=spec.margins.speed)]


def resolution_limits(spec: RobotSpec, cycle: AtGearhead, demand: Demands, parts: Parts) -> list[CheckColumn]:
    """Angle of a microstep at the load; of a full step, where the driver's are unknown and that is fine enough.

    Microsteps are those of the spec, as far as the driver has them; else its finest.
    """
    need = spec.needs.resolution_at_load
    if need is None:
        return []
    full = 2.0 * np.pi / (4.0 * parts.motor["pole_pairs"] * demand.total_ratio * cycle.belt)
    given = np.nan if spec.control.microsteps is None else spec.control.microsteps
    micro = full / np.fmin(parts.controller["microsteps"], given)
    return [at_most("step_resolution", np.where(np.isnan(micro) & (full <= need), full, micro), need)]


def _advice(spec: RobotSpec, cycle: AtGearhead, demand: Demands, parts: Parts) -> list[CheckColumn]:
    """Advice on inertia and resonance."""
    motor, found = parts.motor, list[CheckColumn]()
    steps = 4.0 * motor["pole_pairs"]
    load, inertia = inertia_at_motor(cycle, demand)
    if spec.needs.inertia_ratio is None:
        with np.errstate(divide="ignore"):
            ratio = np.where(demand.left_out[:, ACCELERATION], np.nan, load / (inertia - load))  # of an unknown rotor
        found.append(at_most("inertia_ratio", ratio, _RATIO, advice=True, note=_HEAVY))
    ends = np.abs(cycle.base.functions[:, :, SPEED])
    steady = np.unique(ends[(ends[:, 0] == ends[:, 1]) & (ends[:, 0] > 0.0), 0])
    if len(steady):
        swings = natural_frequency(motor["pole_pairs"], motor["holding_torque"], inertia)
        rate = steady * (_at_belt(cycle, demand)[1] * steps / (2.0 * np.pi))[:, None]
        apart = np.exp(np.abs(np.log(rate / swings[:, None]))).min(axis=1)
        found.append(at_least("step_resonance", _APART, apart, advice=True, note=_RESONANT))
    return found


# --- supply ----------------------------------------------------------------------------------------------------------


def _draw(spec: RobotSpec, cycle: AtGearhead, demand: Demands, parts: Parts, wanted: NDArray[np.bool_]) -> _Draw:
    """Energy and power out of the supply of the drives that are wanted, with the standby power of their drivers."""
    columns = np.full((3, len(wanted)), np.nan)
    rows, functions = np.flatnonzero(wanted), cycle.base.functions
    c, ratio = _at_belt(cycle, demand)
    loss = copper_loss(parts.motor["nominal_current"], parts.motor["resistance"])
    stage = spec.feed(parts.controller).stage
    standby = np.broadcast_to(stage.standby, len(wanted))
    share = idle_loss(functions[:, :, SPEED], spec.control.idle_current)
    for some in (rows[k] for k in _slices(len(rows), max(_CELLS // len(functions), 1))):
        torque = np.einsum("nk,sek->nse", c[some], functions)
        speed = functions[None, :, :, SPEED] * ratio[some, None, None]
        lost = loss[some, None] * share + standby[some, None]
        drawn, returned, most, _ = electrical_energy(cycle.load_cycle.duration, torque, speed, lost)
        columns[:, some] = drawn, returned, np.maximum(most, 0.0)
    return _Draw(*np.where(demand.complete, columns, np.nan))


def supply_limits(spec: RobotSpec, returned: Array, most: Array, parts: Parts, printed: Array) -> list[CheckColumn]:
    """The supply's voltage against the motor's, its current and power, and the bus where energy is regenerated."""
    supply, torque, power = spec.supply, spec.margins.torque, most * spec.load.motors
    none, stays = returned == 0.0, (1.0 - supply.regeneration) * returned * spec.load.motors
    raised = np.nan if supply.capacitance is None else bus_voltage(supply.highest, stays, supply.capacitance)
    bus = np.where(none | spec.accepts_all, supply.highest, raised)  # as if all of a cycle came at once
    found = [
        at_most("supply_voltage", supply.highest, np.where(np.isnan(printed), np.inf, printed)),
        bus_limit(spec, bus, np.where(none, np.inf, parts.controller["supply_max"]), undecided=_KEPT),
    ]
    if supply.current is not None:
        found.append(at_most("supply_current", power / supply.lowest, supply.current, needed=torque))
    if supply.power is not None:
        found.append(at_most("supply_power", power, supply.power, needed=torque))
    return found


def _figures(problem: Problem, draws: Sequence[_Draw], motor: Figures) -> dict[str, Array]:
    """Figures for objectives and records, as ``powered`` has them of other motors."""
    loads, share = [case.spec.load for case in problem.cases], problem.spec.supply.regeneration
    machines, cycles = problem.machine_cases, [case.cycle for case in problem.cases]
    idle = problem.spec.control.idle_current
    heat = max(float(idle_loss(cycle.speed, idle) @ cycle.duration) / cycle.total for cycle in cycles)
    power = [np.sum([loads[i].alike * draws[i].power for i in wheels], 0) for wheels in machines]
    drawn, returned = (
        np.sum([loads[i].alike * getattr(draws[i], name) for i in machines[0]], 0) for name in ("drawn", "returned")
    )
    return {
        "energy": drawn - share * returned,
        "returned": returned,
        "power": np.maximum.reduce(power),
        "joule_heat": heat * copper_loss(motor["nominal_current"], motor["resistance"]),
        "peak_current": amplitude(motor["nominal_current"]),
        "winding_temperature": np.full(len(motor["nominal_current"]), np.nan),
    }


def _slices(count: int, size: int) -> Iterator[slice]:
    return (slice(start, start + size) for start in range(0, max(count, 1), size))
