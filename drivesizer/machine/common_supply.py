"""Several axes on one supply: what they draw and regenerate, its limits, the machine's budgets and choppers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import fsum, inf, isnan, nan
from typing import Any

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.errors import FieldError, InputError
from drivesizer.files.yaml_source import Path_
from drivesizer.machine.braking import with_parts_of_supply
from drivesizer.machine.budgets import MachineBudget, feeds_of, mass_budget, price_check, stall_check
from drivesizer.machine.common_bus import AxisPower, CommonBus, common_bus, moving_alone, unknown_at_rest
from drivesizer.machine.supply_power import DrivePower, side_by_side
from drivesizer.physics.power_stage import bus_voltage, least_capacitance
from drivesizer.results.check import Check, Figure, figure, worst_of_cases
from drivesizer.results.check_columns import at_most
from drivesizer.results.drive_set import BrakingBudget
from drivesizer.results.machine import AxisSizing, MachinePower
from drivesizer.spec.machine import MachineSpec, with_common_bus
from drivesizer.spec.robot import AS_SPECIFIED, RobotSpec
from drivesizer.spec.tolerances import Toleranced, split_tolerances
from drivesizer.units import show

# -- Sections of a machine that its own checks take: supply, battery and the like, margins, surroundings and mission.
#
# Of margins, surroundings and mission a field at the top of the file counts; one that only axes have is that of the
# axis where it is strictest. What load cases change of surroundings and supply counts in these.


_STATED = ("margins", "environment", "mission")  # of each field the largest is the strictest: hot, high, long
_CHANGED: dict[str, dict[str, Callable[..., float]]] = {  # by load cases: which of several values is the strictest
    "environment": {"ambient": max, "altitude": max},
    "supply": {
        "nominal": min, "min": min, "max": max, "resistance": max, "current": min, "power": min, "peak_current": min,
        "peak_time": min, "regeneration": min, "capacitance": min,
    },
}  # fmt: skip


def shared_sections(machine: MachineSpec, axes: Sequence[RobotSpec]) -> RobotSpec:
    """Sections that all axes share, as a spec with the load cases of the axes."""
    shared = axes[0].alone(
        supply=machine.supply,
        battery=machine.battery,
        equipment=list(machine.equipment),
        brake_resistor=machine.brake_resistor,
        budget=None,
        **{name: _stated(getattr(machine, name), [getattr(axis, name) for axis in axes]) for name in _STATED},
    )
    names = dict.fromkeys(name for axis in axes for name, _ in axis.load_cases[1:])
    return shared.with_cases((name, _sections_in_case(shared, name, axes)) for name in names)


def _stated(own: Any, of_axes: Sequence[Any]) -> Any:
    """A section with the fields of the machine, and of those that it does not have the strictest of the axes."""
    sections = [section for section in of_axes if section is not None]
    if own is None and not sections:
        return None
    whole = sections[0] if own is None else own
    names = {name for section in sections for name in section.model_fields_set}
    lacking = names - (own.model_fields_set if own is not None else set())
    figures = {
        name: [getattr(section, name) for section in sections if name in section.model_fields_set]
        for name in sorted(lacking)
    }
    return whole.model_copy(update={name: max(values) for name, values in figures.items()})


def _sections_in_case(shared: RobotSpec, name: str, axes: Sequence[RobotSpec]) -> RobotSpec:
    """The shared sections in a load case, with what that changes of those of any axis."""
    pairs = [(axis, case) for axis in axes for own, case in axis.load_cases[1:] if own == name]
    sections = {}
    for section, strictest in _CHANGED.items():
        section_pairs = [(getattr(axis, section), getattr(case, section)) for axis, case in pairs]
        changes = {field: [getattr(b, field) for a, b in section_pairs if getattr(a, field) != getattr(b, field)]
                 for field in strictest}  # fmt: skip
        update = {field: strictest[field](values) for field, values in changes.items() if values}
        sections[section] = getattr(shared, section).model_copy(update=update)
    return shared.alone(**sections)


# -- Figures of a machine's file that have a tolerance: which axis takes which, and which nothing takes.


OF_THE_SUPPLY = ("supply", "battery", "equipment", "brake_resistor", "environment")  # sections that its checks take


def toleranced(machine: MachineSpec) -> dict[Path_, Toleranced]:
    """Figures with a tolerance by their places in the file."""
    return {tolerance.path: tolerance for tolerance in split_tolerances(machine.source)[1]}


def place_of(figures: Mapping[Path_, Toleranced], axis: str, path: Path_) -> Path_:
    """Place of an axis' figure in the file."""
    own = ("axes", axis, *path)
    return own if own in figures else path


def without_effect(machine: MachineSpec) -> tuple[str, ...]:
    """Figures with a tolerance that neither an axis nor the supply takes."""
    figures = toleranced(machine)
    paths = {
        place_of(figures, axis.name, tolerance.path) for axis in machine.axes for tolerance in axis.spec.toleranced
    }
    paths |= {("axes", axis.name, "start") for axis in machine.axes}
    lost = (path for path in figures if path not in paths and path[0] not in OF_THE_SUPPLY)
    return tuple("".join(f"[{n + 1}]" if isinstance(n, int) else f".{n}" for n in path).lstrip(".") for path in lost)


# Several axes on one supply: what they draw, what becomes of regenerated energy, and the limits of the supply.
#
# At random phases limits are held against what no phase exceeds. Brake resistor, power supply and battery are judged
# as those of one drive are, by the sum.


_ROUNDING = 1e-9  # of a cycle
_STAYS = "unknown: how far regenerated energy raises the voltage: give brake_resistor or supply.capacitance"


def common_supply(
    shared: RobotSpec,
    catalog: Catalog,
    axes: Sequence[AxisPower],
    *,
    synchronised: bool = True,
    cycle_time: float | None = None,
) -> MachinePower:
    """Power of a machine's axes on their supply, and the limits of supply, brake resistor and battery."""
    shared = with_parts_of_supply(shared, catalog)
    cases = dict(shared.load_cases)
    more = [name for axis in axes for name, _ in axis.problem.machine.load_cases[1:]]
    names = dict.fromkeys([AS_SPECIFIED, *more]) if more else [""]
    buses = {name: common_bus(name, cases.get(name, shared), axes, synchronised, cycle_time) for name in names}
    checks = worst_of_cases([(name, _supplied(bus)) for name, bus in buses.items()])
    feeds = feeds_of(shared, catalog, [*buses.values()])
    voltage = worst_of_cases([(name, (_voltage(bus, feeds.braking, axes),)) for name, bus in buses.items()])

    def largest(case: str) -> float:
        peak = float(buses[case].total.peak.max())
        return inf if isnan(peak) else peak

    name = max(buses, key=largest)
    return _record(name, buses[name], axes, feeds._replace(checks=(*checks, *voltage, *feeds.checks)))


def _withstood(axes: Sequence[AxisPower]) -> dict[str, float]:
    """Voltage that the controllers of each axis withstand [V]."""
    return {axis.name: axis.drive.controller.supply_max if axis.drive.controller else nan for axis in axes}


def _peak_time(total: DrivePower) -> float:
    """Moment at which the peak's piece begins [s]; NaN where it is unknown."""
    return float(total.duration[: int(total.peak.argmax())].sum()) if total.peak.max() == total.peak.max() else nan


def _supplied(bus: CommonBus) -> tuple[Check, ...]:
    """Largest current and power out of the supply against what it delivers."""
    supply, needed, peak = bus.spec.supply, bus.spec.margins.torque, float(bus.total.peak.max())
    time, checks = np.asarray(_peak_time(bus.total)), []
    for name, limit, scale in (
        ("supply_current", supply.most_current, supply.lowest),
        ("supply_power", supply.power, 1.0),
    ):
        if limit is None:
            continue
        note, excess = "", next((excess for excess in bus.exceeded if excess.check == name), None)
        if excess is not None and not isnan(excess.most):  # axes at random phases
            share = show(excess.most, "%", "dimensionless")
            note = f"at the worst phase; exceeded for {share} of the time at most"
        checks.append(at_most(name, peak / scale, limit, needed=needed, time=time, note=note).at((), "budget"))
    return tuple(checks)


def _voltage(bus: CommonBus, braking: BrakingBudget | None, axes: Sequence[AxisPower]) -> Check:
    """Highest voltage of the bus against the controllers' limits; the smallest of those that are known may fail it."""
    limits = _withstood(axes)
    known = min((limit for limit in limits.values() if not isnan(limit)), default=nan)
    highest, note = _highest(bus, braking, axes), ""
    limit = known if highest > known or not any(map(isnan, limits.values())) else nan
    if len(axes) > 1 and not isnan(highest + limit):
        over = [name for name, own in limits.items() if own < highest]
        least = [name for name, own in limits.items() if own == known]
        note = (
            f"more than the controllers of {', '.join(over)} withstand" if over else f"least limit: {', '.join(least)}"
        )
    return at_most("bus_voltage", highest, limit, undecided=_STAYS, note=note).at((), "budget")


def _highest(bus: CommonBus, braking: BrakingBudget | None, axes: Sequence[AxisPower]) -> float:
    """Highest voltage of the bus [V]; of an unknown capacitance what the controllers' own keep below their limit."""
    supply, resistor = bus.spec.supply, braking.resistor if braking else None
    chopper = resistor.chopper_voltage_max if resistor else bus.spec.chopper_voltage
    stored = bus.on_bus.stored
    if bus.spec.brake_resistor is None and bus.spec.accepts_all:
        return supply.highest
    if supply.capacitance is not None or stored == 0.0:
        more = 0.0 if resistor is None or isnan(resistor.capacitance) else resistor.capacitance
        free = bus.on_bus.highest_voltage(more)
        return free if chopper is None else min(free, max(chopper, supply.highest))
    if chopper is not None:
        return nan if isnan(stored) else max(chopper, supply.highest)
    own = 0.0
    for axis in axes:
        current = axis.drive.controller.continuous_current if axis.drive.controller else nan
        own += float(least_capacitance(current, supply.highest)) * axis.problem.spec.load.motors
    bound = float(bus_voltage(supply.highest, stored, own))
    return bound if all(bound <= limit for limit in _withstood(axes).values()) else nan


def _record(
    name: str,
    bus: CommonBus,
    axes: Sequence[AxisPower],
    feeds: MachineBudget,
) -> MachinePower:
    total, cut, single = bus.total, side_by_side(bus.powers), len(bus.together) == 1
    peak, time, peak_axis = float(total.peak.max()), _peak_time(total), ""
    if not isnan(peak):  # the axis that draws most in the piece that begins at the moment
        starts = np.cumsum(cut[0].duration) - cut[0].duration
        piece = int(np.abs(starts - time).argmin())
        peak_axis = axes[int(np.argmax([power.most[piece] for power in cut]))].name
    unknown = []
    for axis, power in zip(axes, bus.powers, strict=True):
        if isnan(float(power.most.sum() + power.returned.sum() + power.bus_drawn.sum())):
            why = unknown_at_rest(axis.case(name)) if not bus.phases and axis.waits(axis.case(name)) else ""
            unknown.append(f"{axis.name}: {why or 'its drive has figures that no data sheet gives'}")
    return MachinePower(
        axes=tuple(axis.name for axis in axes),
        case=name,
        synchronised=single,
        time=np.concatenate([[0.0], np.cumsum(cut[0].duration)]),
        drawn=np.array([power.bus_drawn for power in cut]),
        returned=np.array([power.returned for power in cut]),
        total=total.drawn,
        left=total.returned,
        peak=peak,
        peak_time=time,
        peak_axis=peak_axis,
        mean=bus.on_bus.mean_drawn,
        energy_left=bus.on_bus.energy,
        exchanged=bus.exchanged if single else 0.0,
        phases=bus.phases,
        exceeded=bus.exceeded,
        unknown=tuple(unknown),
        braking=feeds.braking,
        energy=feeds.energy,
        checks=feeds.checks,
        figures=tuple(_figures(bus, time)),
        assumptions=tuple(_assumptions(axes, bus, name)),
    )


def _figures(bus: CommonBus, time: float) -> Iterator[Figure]:
    total, powers, peak = bus.total, bus.powers, float(bus.total.peak.max())
    at = None if bus.phases or isnan(time) else time
    yield figure("machine_cycle", total.total if not bus.phases else max(power.total for power in bus.together))
    yield figure("supply_peak", peak, at)
    yield figure("supply_peak_summed", fsum(float(power.peak.max()) for power in powers))
    yield figure("supply_mean", bus.on_bus.mean_drawn)
    yield figure("energy_left", bus.on_bus.energy)
    if bus.feed.resistance:
        yield figure("bus_voltage_least", bus.feed.voltage - bus.feed.resistance * peak / bus.feed.voltage, at)
    if not bus.phases:
        yield figure("exchanged", bus.exchanged)
    for excess in bus.exceeded:
        yield figure(f"{excess.check}_exceeded", excess.most, limit=show(excess.limit, "W", "power"))


def _assumptions(axes: Sequence[AxisPower], bus: CommonBus, name: str) -> Iterator[str]:
    cases = {axis.name: axis.case(name) for axis in axes} if len(axes) > 1 else {}
    done = [axis.name for axis in axes if axis.waits(axis.case(name))]
    if bus.phases:
        yield "axes at any phase: largest power is the sum of the largest, and no axis draws what another regenerates"
    elif cases:
        yield "what one axis regenerates another draws at the same moment"
    if bus.synchronised and cases:
        waits = [axis for axis in done if cases[axis][0].cycle.total < bus.cycle * (1.0 - _ROUNDING)]
        if waits:
            cycle = show(bus.cycle, "s", "time")
            yield f"{', '.join(waits)}: at rest after the motion until the machine's cycle of {cycle} is over"
        for axis, own in cases.items():
            if axis not in done:
                yield f"{axis}: repeats its cycle of {show(own[0].cycle.total, 's', 'time')}"
        if bus.phases:
            yield "periods have no common multiple that is short enough: those that repeat run at any phase"
    if bus.feed.resistance:
        yield "heat of the supply's resistance is that of the current of all axes"


def machine_power(machine: MachineSpec, axes: Sequence[AxisSizing]) -> MachinePower | None:
    """Power of the best drives of all axes on the machine's supply."""
    on_supply = supplied_axes(machine, axes)
    if on_supply is None:
        return None
    shared = on_supply[0]
    try:
        power = common_supply(*on_supply, synchronised=machine.synchronised, cycle_time=machine.cycle_time)
    except FieldError as error:
        raise InputError(f"{machine.where(error.field)}: {error}") from None
    ohm, lowest, by_axis = shared.supply.resistance or 0.0, shared.supply.lowest, list[tuple[str, tuple[Check, ...]]]()
    # voltage of the motors while the supply's resistance carries the current of all axes: an axis' own counts twice, in
    # the demand of its own check and in the sum, so that what passes is certain, and what does not is unknown
    for axis in axes if ohm and len(on_supply[2]) > 1 else ():
        own = next((check for check in axis.best.checks if check.name == "supply_voltage"), None) if axis.best else None
        if own is None or machine.axis(axis.name).own_supply:
            continue
        limit = own.limit - ohm * power.peak / lowest
        certain = own.demand * (1.0 + own.needed) <= limit
        note = f"of {axis.name}" if certain else f"of {axis.name}: unknown while all axes draw: give supply.min"
        column = at_most("supply_voltage", own.demand, limit if certain else nan, needed=own.needed, note=note)
        by_axis.append(("", (column.at((), "budget"),)))
    return replace(power, checks=(*power.checks, *worst_of_cases(by_axis)))


def supplied_axes(
    machine: MachineSpec, axes: Sequence[AxisSizing]
) -> tuple[RobotSpec, Catalog, list[AxisPower]] | None:
    """Sections that axes on the machine's supply share, where its parts are listed, and these axes with their drives.

    None where one of them has no drive, or each axis has its own supply.
    """
    on_it = [sizing for sizing in axes if not machine.axis(sizing.name).own_supply]
    if not on_it:
        return None
    powers = []
    for sizing in on_it:
        if sizing.best is None:
            return None
        axis = machine.axis(sizing.name)
        powers.append(
            AxisPower(sizing.name, moving_alone(sizing.result.problem), sizing.best, axis.start, axis.repeats)
        )
    shared = shared_sections(machine, [sizing.spec for sizing in on_it])
    return shared, _listing(machine, [sizing.result.problem.catalog for sizing in on_it]), powers


def budget_checks(machine: MachineSpec, axes: Sequence[AxisSizing], power: MachinePower | None) -> tuple[Check, ...]:
    """Mass and price of all axes against the machine's budget, and their stall against its supply."""
    budget, drives = machine.budget, [(axis.result.problem, axis.best) for axis in axes if axis.best]
    if len(drives) < len(axes):
        return ()
    checks = list[Check]()
    if machine.supply.stalled:
        on_it = [(problem.spec, drive) for problem, drive in drives if problem.spec.on_common_bus]
        checks.append(stall_check(machine.supply, on_it))
    if budget is None:
        return tuple(checks)
    catalog = _listing(machine, [problem.catalog for problem, _ in drives])
    if budget.weighs:
        checks += mass_budget(budget, drives, machine.battery, catalog).checks()
    if budget.price is not None:
        braking = power.braking if power else None
        checks.append(price_check(budget.price, drives, machine.supply, braking, catalog))
    return tuple(checks)


def with_choppers(machine: MachineSpec, catalog_of: Callable[[RobotSpec], Catalog]) -> MachineSpec:
    """The machine on a bus that rises to the lowest voltage of the choppers among which its spec leaves the choice."""
    section, on_it = machine.brake_resistor, [axis.spec for axis in machine.axes if not axis.own_supply]
    if section is None or section.chopper_voltage is not None or not on_it:
        return machine
    catalog = _listing(machine, [catalog_of(spec) for spec in on_it])
    resistor = with_parts_of_supply(shared_sections(machine, on_it), catalog).brake_resistor
    return replace(machine, axes=tuple(with_common_bus(axis, resistor) for axis in machine.axes))


def _listing(machine: MachineSpec, catalogs: Sequence[Catalog]) -> Catalog:
    """The catalogues of the axis that lists power supply and battery, or brake resistors; else those of the first."""
    battery = machine.battery.part if machine.battery else None

    def listed(catalog: Catalog) -> int:
        named = machine.supply.part in catalog.power_supplies.rows, battery in catalog.batteries.rows
        return 2 * sum(named) + (len(catalog.brake_resistors) > 0)

    return max(catalogs, key=listed)
