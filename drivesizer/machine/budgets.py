"""The machine with a drive in it, against what no choice of motor alone decides: mass, room, footing, grip, battery.

These checks count whatever method ranked: a drive that the battery cannot feed for long enough is rejected. With load
cases the worst of them counts.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from math import isnan, nan
from typing import TYPE_CHECKING, NamedTuple

from drivesizer.catalog import Catalog
from drivesizer.errors import InputError
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.machine.battery import pack_of
from drivesizer.machine.braking import braking_budget
from drivesizer.machine.energy_budget import checks_of_battery, energy_budget
from drivesizer.machine.mass_budget import drive_rows, of_drives, of_supply, price_check
from drivesizer.machine.supply_power import DrivePower, drive_power, together
from drivesizer.results.check import Check, Figure, worst_of_cases
from drivesizer.results.drive_set import BrakingBudget, DriveParts, EnergyBudget, MassRow
from drivesizer.results.problem import Problem
from drivesizer.spec.robot import RobotSpec

if TYPE_CHECKING:
    from drivesizer.machine.platform_budget import MechanicalBudget
    from drivesizer.spec.battery import Battery
    from drivesizer.spec.platform import Budget

__all__ = [
    "MachineBudget",
    "check_battery",
    "drive_mass",
    "machine_budget",
    "machine_requirements",
    "mass_without_drive",
    "regeneration",
    "riding_mass",
    "riding_rows",
    "rows_of_drive",
]


class MachineBudget(NamedTuple):
    """A machine with a drive in it against its budgets; empty where the spec has none."""

    checks: tuple[Check, ...] = ()
    figures: tuple[Figure, ...] = ()
    masses: tuple[MassRow, ...] = ()
    energy: EnergyBudget | None = None  # of the load case in which the battery lasts least
    braking: BrakingBudget | None = None  # where the spec limits what is regenerated or what the supply delivers


def check_battery(spec: RobotSpec, catalog: Catalog) -> None:
    """Refuse a battery that no catalogue lists, before the search."""
    if spec.battery is None:
        return
    try:
        pack_of(spec.battery, catalog)
    except InputError as error:
        raise InputError(f"{spec.where(('battery', 'part'))}: {str(error).removeprefix('battery.part: ')}") from None


def machine_requirements(spec: RobotSpec) -> MechanicalBudget | None:
    """Requirements, and room, footing and grip of a platform, which are the same whatever drives it; None without."""
    if spec.platform is None and spec.requirements is None:
        return None
    from drivesizer.machine.platform_budget import worst_case_budget

    return worst_case_budget(spec)


def machine_budget(
    problem: Problem, one: DriveParts, machine: MechanicalBudget | None = None, *, brief: bool = False
) -> MachineBudget:
    """The machine with a drive in it, against its budgets."""
    spec, parts = problem.spec, [machine] if machine else []
    if spec.budget and spec.budget.weighs:
        parts.insert(0, _mass(problem, spec.budget, one))
    checks, energy = [check for part in parts for check in part.checks], None
    if spec.battery and brief:
        checks += worst_of_cases(_checks_of_the_battery(problem, spec.battery, one))
    elif spec.battery:
        found = _battery_budget(problem, spec.battery, one)
        checks += worst_of_cases([(name, budget.checks) for name, budget in found])
        energy = min((budget for _, budget in found), key=_lasting)
    braking = regeneration(problem, one) if problem.machine.limits_the_bus else None
    if braking:
        checks += braking.checks
    if spec.budget and spec.budget.price is not None:
        resistor = braking.resistor if braking else None
        items = [*of_drives(problem, one), *of_supply(spec.supply.part, resistor, problem.catalog)]
        checks.append(price_check(items, spec.budget.price))
    figures = tuple(figure for part in parts for figure in part.figures)
    masses = next((part.mass.rows for part in parts if part.mass), ())
    return MachineBudget(tuple(checks), figures, masses, energy, braking)


def regeneration(problem: Problem, one: DriveParts) -> BrakingBudget | None:
    """Regenerated energy of the machine with a drive, and its ways from the bus."""
    return braking_budget(problem, one, worst_of_cases)


def _battery_budget(problem: Problem, battery: Battery, one: DriveParts) -> list[tuple[str, EnergyBudget]]:
    """The battery's budget in each load case of the machine, by name."""
    equipment, catalog = problem.spec.equipment, problem.catalog
    return [
        (name, energy_budget(spec, one, battery, equipment, catalog, power))
        for name, spec, power in _powers(problem, one)
    ]


def _checks_of_the_battery(problem: Problem, battery: Battery, one: DriveParts) -> list[tuple[str, tuple[Check, ...]]]:
    """The same, the checks alone."""
    equipment, catalog = problem.spec.equipment, problem.catalog
    return [
        (name, checks_of_battery(spec, battery, equipment, catalog, power))
        for name, spec, power in _powers(problem, one)
    ]


def _powers(problem: Problem, one: DriveParts) -> Iterator[tuple[str, RobotSpec, DrivePower]]:
    """Each load case of the machine: its name, its spec, and the power that all drives draw in it."""
    for numbers in problem.machine_cases:
        some = [problem.cases[number] for number in numbers]
        power = together([drive_power(case.spec, one, case.at_belt) for case in some])
        platform = some[0].spec.platform
        yield problem.name_of(numbers), some[0].spec, power.slipping(platform.slip) if platform else power


def drive_mass(problem: Problem, one: DriveParts) -> float:
    """Mass of all drives together that the machine must carry: what is estimated at the upper end of its band."""
    return math.fsum(row.ends[1] for row in rows_of_drive(problem, one) if not isnan(row.each))


def rows_of_drive(problem: Problem, one: DriveParts) -> tuple[MassRow, ...]:
    """Masses of all drives of a machine, by part."""
    spec = problem.spec
    belt = spec.belt.mass if spec.belt else None
    rows = drive_rows(one, spec.load.motors, problem.catalog, belt, spec.wants_encoder)
    if spec.gear is None:
        return rows
    each = nan if spec.gear.mass is None else spec.gear.mass
    return *rows, MassRow(name=spec.gear.kind, each=each, number=spec.load.motors)


def riding_mass(problem: Problem, one: DriveParts) -> float:
    """Mass of an axis' drives that ride on another, without their controllers [kg].

    What is estimated counts at the upper end of its band, as for a vehicle that carries its own drive.
    """
    return math.fsum(row.ends[1] for row in riding_rows(problem, one) if not isnan(row.each))


def riding_rows(problem: Problem, one: DriveParts) -> tuple[MassRow, ...]:
    """Masses of an axis' drives that ride on another, part by part: all but the controllers."""
    return tuple(row for row in rows_of_drive(problem, one) if row.name != "controller")


def mass_without_drive(spec: RobotSpec, catalog: Catalog) -> float:
    """Known mass of the machine beside its drive: structure, equipment, payloads, battery."""
    budget, platform = spec.budget, spec.platform
    assert budget is not None
    found = [budget.structure or 0.0, *(item.mass * item.number for item in budget.others)]
    found += [payload.mass for payload in (platform.payloads if platform else ())]
    if spec.battery:
        found.append(pack_of(spec.battery, catalog).mass)
    return math.fsum(mass for mass in found if not isnan(mass))


def _mass(problem: Problem, budget: Budget, one: DriveParts) -> MechanicalBudget:
    from drivesizer.machine.platform_budget import machine_mass, mass_part

    spec, load = problem.spec, problem.machine.load
    battery = pack_of(spec.battery, problem.catalog).mass if spec.battery else None
    found = machine_mass(budget, rows_of_drive(problem, one), platform=spec.platform, battery=battery)
    return mass_part(found, load.mass if isinstance(load, WheeledVehicle) else None)


def _lasting(budget: EnergyBudget) -> tuple[bool, float]:
    """The unknown first."""
    return not isnan(budget.autonomy), budget.autonomy
