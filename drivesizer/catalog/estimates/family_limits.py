"""Permitted limits of parts whose maker prints one and the same limit for all others of the family.

A limit is a decision of the maker, so that no law over other makers' parts gives it; where the family speaks with one
voice, the part that lacks it has it too. Two members at least must print it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from drivesizer.catalog.estimates.laws import families_of
from drivesizer.catalog.tables import Table

__all__ = ["LIMITS", "SAME_FAMILY", "FamilyLimit", "family_limits", "limit_records"]

SAME_FAMILY = "same family"  # the law's name, wherever such a limit is shown
LIMITS = {
    "motors": ("max_speed", "max_winding_temperature", "peak_torque"),
    "gearheads": ("continuous_input_speed", "intermittent_input_speed", "continuous_torque", "intermittent_torque"),
    "actuators": ("max_speed", "max_winding_temperature", "peak_torque"),
    "encoders": ("max_speed", "max_mechanical_speed"),
}
_LEAST = 2  # members that print it
_ROUNDING = 1e-9  # relative, of units


class FamilyLimit(NamedTuple):
    """A limit of one part, as its family has it; its band has no width."""

    figure: str
    value: float  # SI
    members: int  # that print it


def family_limits(table: Table[Any], row: int) -> list[FamilyLimit]:
    """Limits that a part lacks and all others of its family that print them have alike."""
    families = families_of(table)
    family = families == families[row] if table["family"][row] else np.zeros(len(table), np.bool_)
    found = []
    for figure in LIMITS.get(table.section, ()):
        printed = table[figure][family & ~np.isnan(table[figure])]
        if not np.isnan(table[figure][row]) or len(printed) < _LEAST:
            continue
        if np.ptp(printed) <= _ROUNDING * np.abs(printed).max():
            found.append(FamilyLimit(figure, float(printed[0]), len(printed)))
    return found


def limit_records(table: Table[Any], row: int) -> list[dict[str, Any]]:
    """The same for JSON, with the keys of the other estimates; ``low`` and ``high`` are the value."""
    return [
        {"figure": one.figure, "value": one.value, "low": one.value, "high": one.value, "terms": [],
         "peers": SAME_FAMILY, "parts": one.members, "families": 1}
        for one in family_limits(table, row)
    ]  # fmt: skip
