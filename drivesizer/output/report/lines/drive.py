"""A drive, its checks and its figures as rows of text."""

from __future__ import annotations

import re
from math import isnan
from typing import Any

from drivesizer.output.json.loops import number
from drivesizer.output.text import margin, use
from drivesizer.results.check import tightest
from drivesizer.results.check_parts import part_of
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import Check, Figure
from drivesizer.spec.robot import AS_SPECIFIED
from drivesizer.units import from_si

__all__ = ["case_of", "check_row", "figure_row", "tight_of", "tightest_checks"]


def tight_of(drive: DriveSet) -> dict[str, str]:
    """The smallest margin of a drive with its check; a condition that fails has none."""
    check = next(iter(tightest_checks(drive)), None)
    if check is None:
        return {"margin": "unknown", "title": ""}
    if isnan(check.margin):
        return {"margin": "none", "title": f"{check.title}: not met"}
    return {"margin": margin(check.margin), "title": check.title}


_TIGHTEST = 3


def tightest_checks(drive: DriveSet) -> list[Check]:
    """Three checks: conditions that fail, then the smallest margins; those kept small by selection are left out."""
    return tightest(drive.deciding, _TIGHTEST)


def check_row(c: Check) -> dict[str, Any]:
    """A check: texts of its demand, limit and margin, the share of the limit that it uses, and the exact numbers."""
    bare = isnan(c.demand) and isnan(c.limit)  # a condition without figures
    return {
        "title": c.title,
        "part": part_of(c.name),
        "case": "" if bare or c.case == AS_SPECIFIED else case_of(c),
        "demand": "" if bare else c.shown(c.demand),
        "limit": "" if bare else c.shown(c.limit),
        "margin": margin(c.margin),
        "needed": margin(c.needed) if c.needed and not isnan(c.margin) else "",
        "use": use(c.margin),
        "allowed": use(c.needed),
        "status": c.status,
        "at": "" if c.at_time is None else f"{c.at_time:.4g} s",
        "note": c.note
        or ("selected to be so: not a measure of the load" if c.by_choice and c.status == "pass" else ""),
        "exact": {"name": c.name, "unit": c.unit, "margin": number(c.margin)}
        | {name: number(from_si(x, c.unit, c.kind)) for name, x in (("demand", c.demand), ("limit", c.limit))},
    }


def case_of(c: Check) -> str:
    """The load case in which a check is worst; a wheel and a passage are named without "case"."""
    alone = not c.case or c.name.startswith("passage_") or re.match(r"wheels? \d", c.case)
    return c.case if alone else f"case {c.case}"


def figure_row(f: Figure) -> dict[str, str]:
    """A figure that has no limit."""
    return {"title": f.title, "text": f.text, "at": "" if f.at_time is None else f"{f.at_time:.4g} s"}
