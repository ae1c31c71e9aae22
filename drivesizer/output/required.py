"""Requirements on the machine, as rows that terminal and reports print."""

from __future__ import annotations

from typing import NamedTuple

from drivesizer.results.check import Check
from drivesizer.results.check_kinds import OWN_REQUIREMENTS, REQUIREMENTS
from drivesizer.results.drive_set import DriveSet

__all__ = ["RequiredRow", "required_rows"]


class RequiredRow(NamedTuple):
    """A requirement: its check, and the figures of it that are required and reached [SI]."""

    check: Check
    required: float
    reached: float

    @property
    def bound(self) -> str:
        """Sense of the requirement: the reached figure is at most, or at least, the required one."""
        return "at most" if REQUIREMENTS[self.check.name] == "limit" else "at least"


def required_rows(found: DriveSet) -> list[RequiredRow]:
    """Every requirement on the machine in the order of reading; none where the spec has no section of them."""
    if not any(check.name in OWN_REQUIREMENTS for check in found.budget):
        return []
    order = list(REQUIREMENTS)
    rows = [
        RequiredRow(c, *((c.limit, c.demand) if REQUIREMENTS[c.name] == "limit" else (c.demand, c.limit)))
        for c in found.budget
        if c.name in REQUIREMENTS
    ]
    return sorted(rows, key=lambda row: order.index(row.check.name))
