"""A set, its checks and its figures as the report prints them."""

from __future__ import annotations

import re
from math import isnan
from typing import Any

from drivesizer.catalog import Catalog
from drivesizer.output.parts import parts
from drivesizer.output.sums import not_in_mass, price_of, unknown_of
from drivesizer.output.text import margin, use
from drivesizer.results.drive_set import Comparison, DriveSet, Relaxation
from drivesizer.results.sizing import Check, Figure
from drivesizer.spec.robot import AS_SPECIFIED
from drivesizer.units import show

__all__ = ["case_of", "check_row", "compared", "figure_row", "moves", "set_row"]


def set_row(best: DriveSet, catalog: Catalog) -> dict[str, Any]:
    """What the summary says of a set of parts of a catalogue."""
    price, price_over = price_of(best)
    failed = [c for c in best.deciding if c.status == "fail" and isnan(c.margin)]
    return {
        "label": best.label,
        "parts": parts(best, catalog),
        "total_ratio": f"{best.total_ratio:.4g}",
        "mass": show(best.mass, "g", "mass"),
        "mass_of": " + ".join(best.mass_of),
        "mass_lacks": ", ".join(not_in_mass(best)),
        "price": "unknown" if isnan(price) else f"{price:.2f} EUR",
        "price_of": " + ".join(price_over),
        "price_lacks": ", ".join(f"{name} not known" for name in unknown_of(best, price_over)),
        "tight": _tight(best, failed),
        "tightest": [check_row(c) for c in [*failed, *_tightest(best)][:5]],
        "failed": [c.title for c in best.deciding if c.status == "fail"],
        "unknown": [c.title for c in best.deciding if c.status == "unknown"],
    }


def _tight(s: DriveSet, failed: list[Check]) -> dict[str, str]:
    """The one margin of the summary; of a condition that fails there is none."""
    if failed:
        return {"margin": "none", "title": f"{failed[0].title}: not met"}
    check = next(iter(_tightest(s)), None)
    return {"margin": margin(check.margin), "title": check.title} if check else {"margin": "unknown", "title": ""}


def _tightest(s: DriveSet) -> list[Check]:
    """Checks with a margin, the smallest first; what was kept small by choice says nothing and is left out."""
    return sorted((c for c in s.deciding if c.is_comparable), key=lambda c: c.margin)


def check_row(c: Check) -> dict[str, Any]:
    """A check with its bar."""
    bare = isnan(c.demand) and isnan(c.limit)  # a condition without figures
    return {
        "title": c.title,
        "case": "" if bare or c.case == AS_SPECIFIED else case_of(c),
        "demand": "" if bare else c.shown(c.demand),
        "limit": "" if bare else c.shown(c.limit),
        "margin": margin(c.margin),
        "needed": margin(c.needed) if c.needed and not isnan(c.margin) else "",
        "use": use(c.margin),
        "allowed": use(c.needed),
        "status": c.status,
        "at": "" if c.at_time is None else f"{c.at_time:.4g} s",
        "note": c.note or ("so by choice: says nothing of the load" if c.by_choice and c.status == "pass" else ""),
    }


def case_of(c: Check) -> str:
    """Where a check is worst: a wheel and a passage say themselves what they are."""
    alone = not c.case or c.name.startswith("passage_") or re.match(r"wheels? \d", c.case)
    return c.case if alone else f"case {c.case}"


def figure_row(f: Figure) -> dict[str, str]:
    """A figure that has no limit."""
    return {"title": f.title, "text": f.text, "at": "" if f.at_time is None else f"{f.at_time:.4g} s"}


def moves(changes: tuple[Relaxation, ...]) -> list[list[str]]:
    """What would have to change, and until when."""
    return [[r.field, r.now, r.needed, r.set_label] for r in changes]


def compared(pair: Comparison) -> dict[str, Any]:
    """A limit as both methods see it."""
    return {
        "title": pair.paper.title,
        "paper": pair.paper.shown(pair.paper.demand),
        "physics": pair.physics.shown(pair.physics.demand),
        "paper_status": pair.paper.status,
        "physics_status": pair.physics.status,
        "why": pair.why,
    }
