"""The machine with a set in it, against what no choice of motor alone decides: the battery that feeds it.

These checks count whatever method ranked: a set that the battery cannot feed for long enough does not stand. With load
cases the worst of them counts.
"""

from __future__ import annotations

from dataclasses import replace
from math import isnan

from drivesizer.battery_pack import pack_of
from drivesizer.catalog import Catalog
from drivesizer.energy_budget import energy_budget
from drivesizer.energy_records import EnergyBudget
from drivesizer.errors import InputError
from drivesizer.results import Check, DriveSet, verdict
from drivesizer.spec import RobotSpec

__all__ = ["check_battery", "with_budget"]

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


def with_budget(spec: RobotSpec, catalog: Catalog, one: DriveSet) -> DriveSet:
    """The same set with the checks of the machine that it is in; as it is where the spec has no battery.

    Parameters
    ----------
    spec, catalog
        What is asked for, and what there is.
    one
        The set as the search found it.
    """
    if spec.battery is None:
        return one
    found = [(name, energy_budget(case, one, spec.battery, spec.equipment, catalog)) for name, case in spec.load_cases]
    by_case = [[replace(check, case=name) for check in budget.checks] for name, budget in found]
    checks = tuple(min(several, key=_how_bad) for several in zip(*by_case, strict=True))
    shortest = min((budget for _, budget in found), key=_lasting)
    return replace(one, budget=checks, energy=shortest, status=verdict((*one.checks, *checks)))


def _how_bad(check: Check) -> tuple[int, float]:
    return _GRAVE.index(check.status), 1e99 if isnan(check.margin) else check.margin


def _lasting(budget: EnergyBudget) -> tuple[bool, float]:
    """The unknown first."""
    return not isnan(budget.autonomy), budget.autonomy
