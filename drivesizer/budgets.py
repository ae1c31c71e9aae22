"""The machine with a set in it, against what no choice of motor alone decides: mass, room, footing, grip, battery.

These checks count whatever method ranked: a set that the battery cannot feed for long enough does not stand. With load
cases the worst of them counts.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from math import isnan

from drivesizer.battery_pack import pack_of
from drivesizer.budget_checks import (
    Standing,
    envelope_checks,
    grip_checks,
    machine_mass,
    mass_checks,
    stability_checks,
)
from drivesizer.catalog import Catalog
from drivesizer.checked import Check
from drivesizer.energy_budget import energy_budget
from drivesizer.energy_records import EnergyBudget
from drivesizer.errors import InputError
from drivesizer.machines import WheeledVehicle
from drivesizer.mass_budget import drive_rows
from drivesizer.platform_cases import dynamics_of, trajectory_of
from drivesizer.results import DriveSet, verdict
from drivesizer.spec import RobotSpec
from drivesizer.wheel_load import WheelLoad

__all__ = ["check_battery", "drive_mass", "machine_checks", "mass_without_drive", "with_budget"]

_GRAVE = ("fail", "unknown", "pass")


def check_battery(spec: RobotSpec, catalog: Catalog) -> None:
    """Refuse a battery that no catalogue lists, before the search.

    Raises
    ------
    InputError
        One line that says where.
    """
    if spec.battery is None:
        return
    try:
        pack_of(spec.battery, catalog)
    except InputError as error:
        raise InputError(f"{spec.where(('battery', 'part'))}: {str(error).removeprefix('battery.part: ')}") from None


def machine_checks(spec: RobotSpec) -> tuple[Check, ...]:
    """Room, footing and grip of the platform, which are the same whatever drives it.

    Parameters
    ----------
    spec
        The machine as it was specified, its trajectory not yet taken apart into wheels.
    """
    if spec.platform is None:
        return ()
    by_case = []
    for name, case in spec.load_cases:
        assert case.platform is not None and isinstance(case.load, WheeledVehicle)
        way, needed = trajectory_of(case), spec.margins.torque
        stand = Standing(case.platform, case.load, dynamics_of(case), case.environment.gravity, needed, way)
        found = (*envelope_checks(case.platform, way), *stability_checks(stand), *grip_checks(stand))
        by_case.append((name, found))
    return _worst(by_case)


def with_budget(spec: RobotSpec, catalog: Catalog, one: DriveSet, machine: tuple[Check, ...] = ()) -> DriveSet:
    """The same set with the checks of the machine that it is in; as it is where the spec has no such budget.

    Parameters
    ----------
    spec, catalog
        What is asked for, and what there is.
    one
        The set as the search found it.
    machine
        Checks that are the same for every set, of ``machine_checks``.
    """
    checks, energy = list(machine), None
    if spec.budget:
        checks += _mass(spec, catalog, one)
    if spec.battery:
        found = [
            (name, energy_budget(parts[0], one, spec.battery, spec.equipment, catalog, parts))
            for name, parts in _machine_cases(spec).items()
        ]
        checks += _worst([(name, budget.checks) for name, budget in found])
        energy = min((budget for _, budget in found), key=_lasting)
    if not checks:
        return one
    return replace(one, budget=tuple(checks), energy=energy, status=verdict((*one.checks, *checks)))


def drive_mass(one: DriveSet, sets: int) -> float:
    """What is known of the mass of all motor sets together [kg]."""
    return math.fsum(row.total for row in drive_rows(one, sets) if not isnan(row.total))


def mass_without_drive(spec: RobotSpec, catalog: Catalog) -> float:
    """What is known of the machine's mass beside its drive: structure, equipment, payloads, battery [kg]."""
    budget, platform = spec.budget, spec.platform
    assert budget is not None
    found = [budget.structure or 0.0, *(item.mass * item.number for item in budget.others)]
    found += [payload.mass for payload in (platform.payloads if platform else ())]
    if spec.battery:
        found.append(pack_of(spec.battery, catalog).mass)
    return math.fsum(mass for mass in found if not isnan(mass))


def _machine_cases(spec: RobotSpec) -> dict[str, list[RobotSpec]]:
    """The load cases of the whole machine, each with those of its wheels."""
    found: dict[str, list[RobotSpec]] = {}
    for name, case in spec.load_cases:
        found.setdefault(case.load.of if isinstance(case.load, WheelLoad) else name, []).append(case)
    return found


def _mass(spec: RobotSpec, catalog: Catalog, one: DriveSet) -> tuple[Check, ...]:
    assert spec.budget is not None
    battery = pack_of(spec.battery, catalog).mass if spec.battery else None
    found = machine_mass(spec.budget, one, spec.load.motors, platform=spec.platform, battery=battery)
    load = spec.whole.load
    return mass_checks(found, load.mass if isinstance(load, WheeledVehicle) else None)


def _worst(by_case: Sequence[tuple[str, Sequence[Check]]]) -> tuple[Check, ...]:
    """Of checks in several load cases each where it is worst; those of a passage, which is their case, each alone."""
    alike: dict[tuple[str, str], list[Check]] = {}
    for name, checks in by_case:
        for check in checks:
            one = check if check.case else replace(check, case=name)
            alike.setdefault((check.name, check.case), []).append(one)
    return tuple(min(several, key=_how_bad) for several in alike.values())


def _how_bad(check: Check) -> tuple[int, float]:
    return _GRAVE.index(check.status), 1e99 if isnan(check.margin) else check.margin


def _lasting(budget: EnergyBudget) -> tuple[bool, float]:
    """The unknown first."""
    return not isnan(budget.autonomy), budget.autonomy
