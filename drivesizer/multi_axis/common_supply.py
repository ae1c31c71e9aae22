"""Several axes on one supply: what they draw, what becomes of regenerated energy, and the limits of the supply."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import fsum, isnan, nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.files.yaml_source import Path_
from drivesizer.machine.braking import bus_budget, with_parts_of_supply
from drivesizer.machine.energy_budget import budget_of_consumers, consumers_of
from drivesizer.machine.supply_power import DrivePower, side_by_side
from drivesizer.multi_axis.common_bus import AxisPower, CommonBus, common_bus, unknown_at_rest
from drivesizer.physics.power_stage import bus_voltage, least_capacitance
from drivesizer.results.check import Check, Figure, worst_of_cases
from drivesizer.results.check_columns import CheckColumn, at_most
from drivesizer.results.drive_set import BrakingBudget, Consumption, DriveParts, EnergyBudget, loss_assumptions
from drivesizer.results.machine import MachinePower
from drivesizer.spec.machine import MachineSpec
from drivesizer.spec.robot import AS_SPECIFIED, RobotSpec
from drivesizer.spec.tolerances import Toleranced, split_tolerances
from drivesizer.units import show

__all__ = ["OF_THE_SUPPLY", "AxisPower", "common_supply", "place_of", "shared_sections", "toleranced", "without_effect"]


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
    given = [section for section in of_axes if section is not None]
    if own is None and not given:
        return None
    whole = given[0] if own is None else own
    names = {name for section in given for name in section.model_fields_set}
    lacking = names - (own.model_fields_set if own is not None else set())
    found = {name: [getattr(one, name) for one in given if name in one.model_fields_set] for name in sorted(lacking)}
    return whole.model_copy(update={name: max(values) for name, values in found.items()})


def _sections_in_case(shared: RobotSpec, name: str, axes: Sequence[RobotSpec]) -> RobotSpec:
    """The shared sections in a load case, with what that changes of those of any axis."""
    pairs = [(axis, case) for axis in axes for own, case in axis.load_cases[1:] if own == name]
    sections = {}
    for section, strictest in _CHANGED.items():
        both = [(getattr(axis, section), getattr(case, section)) for axis, case in pairs]
        moved = {field: [getattr(b, field) for a, b in both if getattr(a, field) != getattr(b, field)]
                 for field in strictest}  # fmt: skip
        update = {field: strictest[field](values) for field, values in moved.items() if values}
        sections[section] = getattr(shared, section).model_copy(update=update)
    return shared.alone(**sections)


# -- Figures of a machine's file that have a tolerance: which axis takes which, and which nothing takes.


OF_THE_SUPPLY = ("supply", "battery", "equipment", "brake_resistor", "environment")  # sections that its checks take


def toleranced(machine: MachineSpec) -> dict[Path_, Toleranced]:
    """Figures with a tolerance by their places in the file."""
    return {one.path: one for one in split_tolerances(machine.source)[1]}


def place_of(figures: Mapping[Path_, Toleranced], axis: str, path: Path_) -> Path_:
    """Place of an axis' figure in the file."""
    own = ("axes", axis, *path)
    return own if own in figures else path


def without_effect(machine: MachineSpec) -> tuple[str, ...]:
    """Figures with a tolerance that neither an axis nor the supply takes."""
    figures = toleranced(machine)
    used = {place_of(figures, axis.name, one.path) for axis in machine.axes for one in axis.spec.toleranced}
    used |= {("axes", axis.name, "start") for axis in machine.axes}
    lost = (path for path in figures if path not in used and path[0] not in OF_THE_SUPPLY)
    return tuple("".join(f"[{n + 1}]" if isinstance(n, int) else f".{n}" for n in path).lstrip(".") for path in lost)


# -- Several axes on one supply: what they draw, what becomes of regenerated energy, and the limits of the supply.
#
# At random phases limits are held against what no phase exceeds. Brake resistor, power supply and battery are judged
# as those of one drive are, by the sum.


Array = NDArray[np.float64]
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
    buses = {name: common_bus(name, cases.get(name, shared), axes, synchronised, cycle_time) for name in _cases(axes)}
    controllers = [(one.one, one.problem.spec.load.motors) for one in axes]
    withstood = _least([one.controller.supply_max if one.controller else nan for one, _ in controllers])
    by_case = [(name, _supplied(bus)) for name, bus in buses.items()]
    checks = worst_of_cases([(name, tuple(c.at((), "budget") for c in found)) for name, found in by_case])
    braking, energy = None, dict[str, EnergyBudget]()
    if shared.battery is None and shared.supply.kind != "battery":
        found = [bus.on_bus for bus in buses.values()]
        braking = bus_budget(shared, catalog, found, withstood, worst_of_cases)
    voltage = [(name, (_voltage(bus, braking, axes),)) for name, bus in buses.items()]
    checks = (*checks, *worst_of_cases(voltage), *(braking.checks if braking else ()))
    if shared.battery is not None:
        energy = {name: _energy(name, bus, axes, catalog) for name, bus in buses.items()}
        checks = (*checks, *worst_of_cases([(name, one.checks) for name, one in energy.items()]))
    name = max(buses, key=lambda case: _most(float(buses[case].total.peak.max())))
    return _record(name, buses[name], axes, checks, braking, energy)


def _most(value: float) -> float:
    return float("inf") if isnan(value) else value


def _least(values: Sequence[float]) -> float:
    return min((value for value in values if not isnan(value)), default=nan)


def _cases(axes: Sequence[AxisPower]) -> list[str]:
    """Load cases of the machine: that as specified, and all that any axis has besides."""
    more = [name for axis in axes for name, _ in axis.problem.machine.load_cases[1:]]
    return list(dict.fromkeys([AS_SPECIFIED, *more])) if more else [""]


# --- limits -----------------------------------------------------------------------------------------------------------


def _supplied(bus: CommonBus) -> list[CheckColumn]:
    """Largest current and power out of the supply against what it delivers."""
    supply, needed, total = bus.spec.supply, bus.spec.margins.torque, bus.total
    peak, time = float(total.peak.max()), _peak_time(total)
    found = []
    for name, limit, scale in (
        ("supply_current", supply.most_current, supply.lowest),
        ("supply_power", supply.power, 1.0),
    ):
        if limit is not None:
            note = _share_text(bus, name)
            found.append(at_most(name, peak / scale, limit, needed=needed, time=np.asarray(time), note=note))
    return found


def _peak_time(total: DrivePower) -> float:
    """Moment at which the peak's piece begins [s]; NaN where it is unknown."""
    if isnan(float(total.peak.max())):
        return nan
    return float(total.duration[: int(total.peak.argmax())].sum())


def _share_text(bus: CommonBus, name: str) -> str:
    """Of axes at random phases: for how much of the time a limit is exceeded."""
    one = next((one for one in bus.exceeded if one.check == name), None)
    if one is None or isnan(one.most):
        return ""
    return f"at the worst phase; exceeded for {show(one.most, '%', 'dimensionless')} of the time at most"


def _voltage(bus: CommonBus, braking: BrakingBudget | None, axes: Sequence[AxisPower]) -> Check:
    """Highest voltage of the bus against the controllers' limits; the smallest of those that are known may fail it."""
    drives = [(axis.one, axis.problem.spec.load.motors) for axis in axes]
    limits = {axis.name: axis.one.controller.supply_max if axis.one.controller else nan for axis in axes}
    known, highest = _least([*limits.values()]), _highest(bus, braking, drives)
    limit = known if highest > known or not any(map(isnan, limits.values())) else nan
    note = _whose(limits, highest, known) if len(axes) > 1 and not isnan(highest + limit) else ""
    return at_most("bus_voltage", highest, limit, undecided=_STAYS, note=note).at((), "budget")


def _whose(limits: Mapping[str, float], highest: float, least: float) -> str:
    """The axes whose controllers do not withstand the bus; else those of the least limit.

    >>> _whose({"x": 50.0, "y": 70.0}, 60.0, 50.0), _whose({"x": 70.0, "y": 70.0, "z": 75.0}, 60.0, 70.0)
    ('more than the controllers of x withstand', 'least limit: x, y')
    """
    over = [name for name, limit in limits.items() if limit < highest]
    if over:
        return f"more than the controllers of {', '.join(over)} withstand"
    return f"least limit: {', '.join(name for name, limit in limits.items() if limit == least)}"


def _highest(bus: CommonBus, braking: BrakingBudget | None, drives: Sequence[tuple[DriveParts, int]]) -> float:
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
    own = fsum(
        float(least_capacitance(one.controller.continuous_current, supply.highest)) * number if one.controller else nan
        for one, number in drives
    )
    bound = float(bus_voltage(supply.highest, stored, own))
    limits = [one.controller.supply_max for one, _ in drives if one.controller]
    return bound if bound <= min(limits, default=nan) else nan


# --- the battery ------------------------------------------------------------------------------------------------------


def _energy(name: str, bus: CommonBus, axes: Sequence[AxisPower], catalog: Catalog) -> EnergyBudget:
    """The battery with all axes on it, each a few lines of its table."""
    spec, lines = bus.spec, list[Consumption]()
    assert spec.battery is not None
    for axis, power in zip(axes, bus.axes, strict=True):
        own = consumers_of(axis.case(name)[0].spec, axis.one, power)
        lines += [one._replace(name=f"{axis.name}: {one.name}") for one in own if one.name != _CABLES]
    kept = fsum(power.mean(power.returned) for power in bus.axes) - bus.total.mean(bus.total.returned)
    if kept > 0.0:
        share = 1.0 - spec.supply.regeneration
        lines.append(Consumption("exchanged between axes", len(axes), -share * kept, 0.0, nan, False))
    if spec.supply.resistance is not None:
        lines.append(Consumption(_CABLES, 1, bus.total.mean(bus.total.resisted), 0.0, nan, False))
    return budget_of_consumers(
        spec, lines, spec.battery, spec.equipment, catalog, bus.total, tuple(dict.fromkeys(_losses(axes)))
    )


_CABLES = "resistance of the supply"


def _losses(axes: Sequence[AxisPower]) -> Iterator[str]:
    for axis in axes:
        yield from (f"{axis.name}: {text}" for text in loss_assumptions(axis.problem.spec, axis.one.controller))


# --- the record -------------------------------------------------------------------------------------------------------


def _record(
    name: str,
    bus: CommonBus,
    axes: Sequence[AxisPower],
    checks: tuple[Check, ...],
    braking: BrakingBudget | None,
    energy: dict[str, EnergyBudget],
) -> MachinePower:
    total, cut = bus.total, side_by_side(bus.axes)
    single = len(bus.together) == 1
    exchanged_energy = fsum(float(one.returned @ one.duration) for one in cut) - float(total.returned @ total.duration)
    peak, time = float(total.peak.max()), _peak_time(total)
    return MachinePower(
        axes=tuple(axis.name for axis in axes),
        case=name,
        synchronised=single,
        time=np.concatenate([[0.0], np.cumsum(cut[0].duration)]),
        drawn=np.array([one.bus_drawn for one in cut]),
        returned=np.array([one.returned for one in cut]),
        total=total.drawn,
        left=total.returned,
        peak=peak,
        peak_time=time,
        peak_axis="" if isnan(peak) else axes[_largest(cut, time)].name,
        mean=bus.on_bus.mean_drawn,
        energy_left=bus.on_bus.energy,
        exchanged=max(exchanged_energy, 0.0) if single else 0.0,
        phases=bus.phases,
        exceeded=bus.exceeded,
        unknown=tuple(_unknown(axes, bus, name)),
        braking=braking,
        energy=min(energy.values(), key=lambda one: (not isnan(one.autonomy), one.autonomy), default=None),
        checks=checks,
        figures=tuple(_figures(bus, time)),
        assumptions=tuple(_assumptions(axes, bus, name)),
    )


def _largest(cut: Sequence[DrivePower], time: float) -> int:
    """The axis that draws most in the piece that begins at a moment."""
    starts = np.cumsum(cut[0].duration) - cut[0].duration
    piece = int(np.abs(starts - time).argmin())
    return int(np.argmax([one.most[piece] for one in cut]))


def _unknown(axes: Sequence[AxisPower], bus: CommonBus, name: str) -> Iterator[str]:
    for axis, power in zip(axes, bus.axes, strict=True):
        if isnan(float(power.most.sum() + power.returned.sum() + power.bus_drawn.sum())):
            why = unknown_at_rest(axis.case(name)) if not bus.phases and axis.waits(axis.case(name)) else ""
            yield f"{axis.name}: {why or 'its drive has figures that no data sheet gives'}"


def _figures(bus: CommonBus, time: float) -> Iterator[Figure]:
    total, powers = bus.total, bus.axes
    at = None if bus.phases or isnan(time) else time
    single = fsum(float(one.peak.max()) for one in powers)
    shared = fsum(float(one.returned @ one.duration) for one in powers) - float(total.returned @ total.duration)
    cycle = total.total if not bus.phases else max(one.total for one in bus.together)
    rows = [
        ("machine_cycle", "Cycle of all axes", cycle, "time", "s", None),
        ("supply_peak", "Power out of the supply, largest", float(total.peak.max()), "power", "W", at),
        ("supply_peak_summed", "Sum of the axes' own largest", single, "power", "W", None),
        ("supply_mean", "Power out of the supply, mean", bus.on_bus.mean_drawn, "power", "W", None),
        ("energy_left", "Regenerated energy per cycle that no axis draws", bus.on_bus.energy, "energy", "J", None),
    ]
    if bus.feed.resistance:
        least = bus.feed.voltage - bus.feed.resistance * float(total.peak.max()) / bus.feed.voltage
        rows.append(
            ("bus_voltage_least", "Voltage at the peak, behind the supply's resistance", least, "voltage", "V", at)
        )
    if not bus.phases:
        rows.append(("exchanged", "Energy per cycle from axis to axis", max(shared, 0.0), "energy", "J", None))
    yield from (Figure(name=n, title=t, value=v, kind=k, unit=u, at_time=a) for n, t, v, k, u, a in rows)
    for one in bus.exceeded:
        title = f"Share of the time above {show(one.limit, 'W', 'power')}, at most"
        yield Figure(name=f"{one.check}_exceeded", title=title, value=one.most, kind="dimensionless", unit="%")


def _assumptions(axes: Sequence[AxisPower], bus: CommonBus, name: str) -> Iterator[str]:
    if len(axes) > 1:
        yield from _timing(axes, bus, name)
    if bus.feed.resistance:
        yield "heat of the supply's resistance is that of the current of all axes"


def _timing(axes: Sequence[AxisPower], bus: CommonBus, name: str) -> Iterator[str]:
    cases = {axis.name: axis.case(name) for axis in axes}
    done = [axis.name for axis in axes if axis.waits(cases[axis.name])]
    waits = [one for one in done if cases[one][0].cycle.total < bus.cycle * (1.0 - _ROUNDING)]
    if not bus.phases:
        yield "what one axis regenerates another draws at the same moment"
    else:
        yield "axes at any phase: largest power is the sum of the largest, and no axis draws what another regenerates"
    if not bus.synchronised:
        return
    cycle = show(bus.cycle, "s", "time")
    if waits:
        yield f"{', '.join(waits)}: at rest after the motion until the machine's cycle of {cycle} is over"
    for one, own in cases.items():
        if one not in done:
            yield f"{one}: repeats its cycle of {show(own[0].cycle.total, 's', 'time')}"
    if bus.phases:
        yield "periods have no common multiple that is short enough: those that repeat run at any phase"
