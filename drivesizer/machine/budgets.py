"""The machine with a drive in it, against what no choice of motor alone decides: mass, room, footing, grip, battery.

These checks count whatever method ranked: a drive that the battery cannot feed for long enough is rejected. With load
cases the worst of them counts.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from math import isnan, nan
from typing import NamedTuple

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.errors import InputError
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.machine.battery import consumers_of, energy_budget, pack_of
from drivesizer.machine.braking import braking_budget
from drivesizer.machine.mass_budget import drive_rows, machine_mass, of_drives, of_supply, price_check
from drivesizer.machine.supply_power import power_of_cases
from drivesizer.physics.thermal import resistance_25, resistance_at
from drivesizer.results.check import Check, Figure, worst_of_cases
from drivesizer.results.check_columns import at_most
from drivesizer.results.drive_set import BrakingBudget, DriveParts, EnergyBudget, MassRow, loss_assumptions
from drivesizer.results.problem import Problem
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.sections import Supply


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


def machine_requirements(spec: RobotSpec, *, brief: bool = False) -> MachineBudget | None:
    """Requirements, and room, footing and grip of a platform, which are the same whatever drives it; None without.

    In brief without figures that have no limit.
    """
    if spec.platform is None and spec.requirements is None:
        return None
    from drivesizer.machine.platform_budget import worst_case_budget

    return MachineBudget(*worst_case_budget(spec, brief=brief))


def machine_budget(problem: Problem, one: DriveParts, machine: MachineBudget | None = None) -> MachineBudget:
    """The machine with a drive in it, against its budgets: with what is required of it whatever drives it."""
    spec, catalog, battery = problem.spec, problem.catalog, problem.spec.battery
    checks, figures, masses = list[Check](), list[Figure](), tuple[MassRow, ...]()
    if spec.budget and spec.budget.weighs:
        load, own = problem.machine.load, pack_of(battery, catalog).mass if battery else None
        mass = machine_mass(spec.budget, rows_of_drive(problem, one), platform=spec.platform, battery=own)
        checks += mass.checks(load.mass if isinstance(load, WheeledVehicle) else None)
        figures += mass.figures()
        masses = mass.rows
    if machine:
        checks += machine.checks
        figures += machine.figures
    energies, by_case = list[EnergyBudget](), list[tuple[str, tuple[Check, ...]]]()
    for numbers in problem.machine_cases if battery else ():
        some = [problem.cases[number] for number in numbers]
        case, power = some[0].spec, power_of_cases(some, one)
        power = power.slipping(case.platform.slip) if case.platform else power
        losses = tuple(loss_assumptions(case, one.controller))
        energies.append(energy_budget(case, catalog, power, consumers_of(case, one, power), losses))
        by_case.append((problem.name_of(numbers), energies[-1].checks))
    checks += worst_of_cases(by_case)
    braking = braking_budget(problem, one) if problem.machine.limits_the_bus else None
    checks += braking.checks if braking else ()
    if spec.supply.stalled and not spec.on_common_bus:
        checks.append(stall_check(spec.supply, [stall_current(spec, one)] * spec.load.motors))
    if spec.budget and spec.budget.price is not None:
        resistor = braking.resistor if braking else None
        items = [*of_drives(problem, one), *of_supply(spec.supply.part, resistor, catalog)]
        checks.append(price_check(items, spec.budget.price, catalog))
    least = min(energies, key=lambda one: (not isnan(one.autonomy), one.autonomy), default=None)  # the unknown first
    return MachineBudget(tuple(checks), tuple(figures), masses, least, braking)


def stall_current(spec: RobotSpec, one: DriveParts) -> float:
    """Current out of the supply for one drive that stalls with a cold winding, at the nominal voltage [A].

    The winding takes what the stage applies over its resistance, or what the controller lets through, or the printed
    stall current where that is less, as of motors with electronics inside; of it the supply gives R I² and what the
    stage loses.
    """
    motor, controller, volts = one.motor, one.controller, spec.supply.nominal
    feed = spec.feed_of(controller)._replace(voltage=volts)
    cold = float(resistance_at(resistance_25(motor), spec.environment.ambient))
    applied = volts if isnan(feed.usable) else float(feed.usable)
    permitted = controller.peak_current if controller else nan
    limits = [applied / cold, motor.stall_current * volts / motor.nominal_voltage, permitted]
    current = float(np.fmin.reduce(limits))
    lost = float(np.nan_to_num(feed.lost(current)) + np.nan_to_num(feed.stage.standby))
    return (current**2 * cold + lost) / volts


def stall_check(supply: Supply, drawn: Sequence[float]) -> Check:
    """The current of all drives stalled at once [A] against what the supply delivers."""
    limit = nan if supply.most_current is None else supply.most_current
    return at_most("supply_stall", math.fsum(drawn), limit).at((), "budget")


def rows_of_drive(problem: Problem, one: DriveParts) -> tuple[MassRow, ...]:
    """Masses of all drives of a machine, by part."""
    spec = problem.spec
    belt = spec.belt.mass if spec.belt else None
    rows = drive_rows(one, spec.load.motors, problem.catalog, belt, spec.wants_encoder)
    if spec.gear is None:
        return rows
    each = nan if spec.gear.mass is None else spec.gear.mass
    return *rows, MassRow(name=spec.gear.kind, each=each, number=spec.load.motors)


def riding_rows(problem: Problem, one: DriveParts) -> tuple[MassRow, ...]:
    """Masses of an axis' drives that ride on another, part by part: all but the controllers."""
    return tuple(row for row in rows_of_drive(problem, one) if row.name != "controller")


def riding_mass(problem: Problem, one: DriveParts) -> float:
    """Mass of an axis' drives that ride on another [kg]: what is estimated at the upper end of its band."""
    return math.fsum(row.ends[1] for row in riding_rows(problem, one) if not isnan(row.each))


def drive_mass(problem: Problem, one: DriveParts) -> float:
    """Mass of all drives together that the machine must carry [kg]: what is estimated at the upper end of its band."""
    return math.fsum(row.ends[1] for row in rows_of_drive(problem, one) if not isnan(row.each))


def mass_without_drive(spec: RobotSpec, catalog: Catalog) -> float:
    """Known mass of the machine beside its drive: structure, equipment, payloads, battery."""
    assert spec.budget is not None
    battery = pack_of(spec.battery, catalog).mass if spec.battery else None
    return machine_mass(spec.budget, (), platform=spec.platform, battery=battery).known
