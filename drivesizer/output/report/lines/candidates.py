"""The candidates as the report lists them: the best, why the rest fell, the Pareto front."""

from __future__ import annotations

from math import isnan
from typing import Any

from drivesizer.output.report.lines.sets import moves, set_row
from drivesizer.output.sums import price_of
from drivesizer.output.text import margin
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.objectives import objective_figure
from drivesizer.results.sizing import SizingResult, worst
from drivesizer.units import show

__all__ = ["candidates", "front"]


def candidates(result: SizingResult) -> dict[str, Any]:
    """How many there were, the best of them, and why the rest fell."""
    counts, other = result.counts, result.unrestricted
    declared = CHECKS[result.method]
    fell = [
        (declared[name].title, n) for name, n in sorted(counts.failed_by.items(), key=lambda item: (-item[1], item[0]))
    ]
    fell += [(CHECKS["budget"][name].title, n) for name, n in sorted(counts.failed_by_budget.items())]
    return {
        "considered": counts.considered,
        "feasible": counts.feasible,
        "sets": [_row(s) for s in (*result.sets, *result.misses)],
        "fallen": len(result.misses),
        "fell": [{"title": title, "count": n, "share": n / counts.considered} for title, n in fell],
        "relaxations": moves(result.relaxations),
        "unrestricted": set_row(other, result.catalog) if other else None,
    }


def _row(s: DriveSet) -> dict[str, Any]:
    tight = worst(s.deciding)
    failed = [c.title for c in s.deciding if c.status == "fail"]
    price, _ = price_of(s)
    return {
        "rank": str(s.rank),
        "motor": s.motor_name,
        "gearhead": _gearhead(s, belt=False),
        "ratio": f"{s.total_ratio:.4g}",
        "mass": show(s.mass, "g", "mass"),
        "price": "unknown" if isnan(price) else f"{price:.2f} EUR",
        "margin": margin(tight.margin) if tight else "",
        "check": _some(failed) if failed else tight.title if tight else "",
        "status": s.status,
    }


def _some(titles: list[str], most: int = 1) -> str:
    """The first of several titles, and how many more there are."""
    more = len(titles) - most
    return ", ".join(titles[:most]) + (f" and {more} more" if more > 0 else "")


_LONGEST_FRONT = 40  # sets of it that are printed


def front(result: SizingResult) -> dict[str, Any]:
    """Sets that no other beats in all of several objectives."""
    found = [[objective_figure(s, name) for name in result.pareto] for s in result.front[:_LONGEST_FRONT]]
    return {
        "heads": [f.title for f in found[0]],
        "rows": [
            [str(s.rank), s.motor_name, _gearhead(s), *(f.text for f in row), s.status]
            for s, row in zip(result.front, found, strict=False)
        ],
        "more": max(len(result.front) - _LONGEST_FRONT, 0),
    }


def _gearhead(s: DriveSet, *, belt: bool = True) -> str:
    driven = f" + belt {s.belt_name}" if belt and s.belt_name else ""
    part = s.gearhead.part if "gearhead" in s.parts else ""
    return " ".join(f"{s.gearhead_name} {part}{driven}".split())
