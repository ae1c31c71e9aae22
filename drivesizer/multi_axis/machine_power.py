"""A sized machine on its supply: power of all axes, the budgets of the machine, choppers that raise its bus."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import nan

from drivesizer.catalog import Catalog
from drivesizer.errors import FieldError, InputError
from drivesizer.machine.battery import pack_of
from drivesizer.machine.braking import with_parts_of_supply
from drivesizer.machine.budgets import rows_of_drive, stall_check, stall_current
from drivesizer.machine.mass_budget import machine_mass, of_drives, of_supply, price_check
from drivesizer.multi_axis.common_bus import AxisPower, moving_alone
from drivesizer.multi_axis.common_supply import common_supply, shared_sections
from drivesizer.results.check import Check, worst_of_cases
from drivesizer.results.check_columns import at_most
from drivesizer.results.machine import AxisSizing, MachinePower
from drivesizer.search.uncertainty.options import Sampling
from drivesizer.spec.machine import with_common_bus
from drivesizer.spec.machine_record import MachineSpec
from drivesizer.spec.robot import RobotSpec


def machine_power(machine: MachineSpec, axes: Sequence[AxisSizing]) -> MachinePower | None:
    """Power of the best drives of all axes on the machine's supply."""
    found = _supplied_axes(machine, axes)
    if found is None:
        return None
    shared = found[0]
    try:
        power = common_supply(*found, synchronised=machine.synchronised, cycle_time=machine.cycle_time)
    except FieldError as error:
        raise InputError(f"{machine.where(error.field)}: {error}") from None
    ohm, lowest, each = shared.supply.resistance or 0.0, shared.supply.lowest, list[tuple[str, tuple[Check, ...]]]()
    # voltage of the motors while the supply's resistance carries the current of all axes: an axis' own counts twice, in
    # the demand of its own check and in the sum, so that what passes is certain, and what does not is unknown
    for one in axes if ohm and len(found[2]) > 1 else ():
        own = next((check for check in one.best.checks if check.name == "supply_voltage"), None) if one.best else None
        if own is None or machine.axis(one.name).own_supply:
            continue
        limit = own.limit - ohm * power.peak / lowest
        certain = own.demand * (1.0 + own.needed) <= limit
        said = f"of {one.name}" if certain else f"of {one.name}: unknown while all axes draw: give supply.min"
        column = at_most("supply_voltage", own.demand, limit if certain else nan, needed=own.needed, note=said)
        each.append(("", (column.at((), "budget"),)))
    return replace(power, checks=(*power.checks, *worst_of_cases(each)))


def over_tolerances(
    machine: MachineSpec, axes: Sequence[AxisSizing], power: MachinePower, how: Sampling
) -> MachinePower:
    """The same with the probability that no limit of the supply is exceeded, over all uncertain figures."""
    found = _supplied_axes(machine, axes)
    if found is None or power.unknown:
        said = "limits of the supply are judged at nominal figures: power over tolerances is unknown"
        return replace(power, assumptions=(*power.assumptions, said))
    from drivesizer.multi_axis.sampled_supply import with_samples  # where nothing is sampled it need not load

    return with_samples(machine, *found, power, how)


def _supplied_axes(
    machine: MachineSpec, axes: Sequence[AxisSizing]
) -> tuple[RobotSpec, Catalog, list[AxisPower]] | None:
    """Sections that axes on the machine's supply share, where its parts are listed, and these axes with their drives.

    None where one of them has no drive, or each axis has its own supply.
    """
    on_it = [one for one in axes if not machine.axis(one.name).own_supply]
    if not on_it:
        return None
    found = []
    for one in on_it:
        if one.best is None:
            return None
        axis = machine.axis(one.name)
        found.append(AxisPower(one.name, moving_alone(one.result.problem), one.best, axis.start, axis.repeats))
    shared = shared_sections(machine, [one.spec for one in on_it])
    return shared, _listing(machine, [one.result.problem.catalog for one in on_it]), found


def budget_checks(machine: MachineSpec, axes: Sequence[AxisSizing], power: MachinePower | None) -> tuple[Check, ...]:
    """Mass and price of all axes against the machine's budget, and their stall against its supply."""
    budget, drives = machine.budget, [(one.result.problem, one.best) for one in axes if one.best]
    if len(drives) < len(axes):
        return ()
    found = list[Check]()
    if machine.supply.stalled:
        on_it = [(problem.spec, one) for problem, one in drives if problem.spec.on_common_bus]
        found.append(stall_check(machine.supply, [spec.load.motors * stall_current(spec, one) for spec, one in on_it]))
    if budget is None:
        return tuple(found)
    catalog = _listing(machine, [problem.catalog for problem, _ in drives])
    if budget.weighs:
        battery = pack_of(machine.battery, catalog).mass if machine.battery else None
        rows = [row for problem, one in drives for row in rows_of_drive(problem, one)]
        found += machine_mass(budget, rows, battery=battery).checks()
    if budget.price is not None:
        resistor = power.braking.resistor if power and power.braking else None
        items = [item for problem, one in drives for item in of_drives(problem, one)]
        found.append(price_check([*items, *of_supply(machine.supply.part, resistor, catalog)], budget.price, catalog))
    return tuple(found)


def with_choppers(machine: MachineSpec, catalog_of: Callable[[RobotSpec], Catalog]) -> MachineSpec:
    """The machine on a bus that rises to the lowest voltage of the choppers among which its spec leaves the choice."""
    section, on_it = machine.brake_resistor, [one.spec for one in machine.axes if not one.own_supply]
    if section is None or section.chopper_voltage is not None or not on_it:
        return machine
    catalog = _listing(machine, [catalog_of(spec) for spec in on_it])
    resistor = with_parts_of_supply(shared_sections(machine, on_it), catalog).brake_resistor
    return replace(machine, axes=tuple(with_common_bus(one, resistor) for one in machine.axes))


def _listing(machine: MachineSpec, catalogs: Sequence[Catalog]) -> Catalog:
    """The catalogues of the axis that lists power supply and battery, or brake resistors; else those of the first."""
    battery = machine.battery.part if machine.battery else None

    def listed(catalog: Catalog) -> int:
        named = machine.supply.part in catalog.power_supplies.rows, battery in catalog.batteries.rows
        return 2 * sum(named) + (len(catalog.brake_resistors) > 0)

    return max(catalogs, key=listed)
