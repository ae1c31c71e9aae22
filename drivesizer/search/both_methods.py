"""The paper's method and the physics side by side, for drives that were found by one of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from drivesizer.catalog import Catalog, Table
from drivesizer.results.drive_set import Comparison, DriveParts
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Check
from drivesizer.search.columns.candidates import candidates
from drivesizer.search.columns.evaluation import evaluate
from drivesizer.spec.select import Choice, MotorChoice

__all__ = ["compared", "other_checks"]

# what the paper checks, what physics checks in its place, and why the two figures differ
_PAIRS = (
    ("gearhead_continuous_torque", "gearhead_continuous_torque",
     "no bearing, efficiency and oversize factors; RMS while running"),
    ("gearhead_intermittent_torque", "gearhead_intermittent_torque",
     "no oversize and efficiency factors; the rotor is not behind the gearhead"),
    ("gearhead_input_speed", "gearhead_continuous_speed",
     "the wheel turns at speed over radius, no reserve of (1)"),
    ("controller_continuous_current", "controller_continuous_current",
     "rotor inertia through the ratio squared, braking by its direction of power, no factors"),
    ("controller_peak_current", "controller_peak_current",
     "rotor inertia through the ratio squared, no oversize factor"),
)  # fmt: skip


def compared(checks: Sequence[Check]) -> tuple[Comparison, ...]:
    """The limits that both methods look at, among the checks of both."""
    paper, physics = ({c.name: c for c in checks if c.method == method} for method in ("paper", "physics"))
    both = [(a, b, why) for a, b, why in _PAIRS if a in paper and b in physics]
    return tuple(Comparison(paper=paper[a], physics=physics[b], why=why) for a, b, why in both)


def other_checks(problem: Problem, one: DriveParts) -> tuple[Check, ...]:
    """The checks of a drive by the other method; none where the paper does not treat the load.

    The gearhead's whole family comes along, as the paper's rule looks at the other reductions too.
    """
    if not problem.spec.paper_applies:
        return ()
    fixed = {
        "motor": MotorChoice(part=[one.motor.part]),
        "gearhead": Choice(family=[one.gearhead.family]),
    }
    method = "physics" if problem.spec.method == "paper" else "paper"
    catalog = _with_only(problem.catalog, {"encoders": one.encoder, "controllers": one.controller})
    narrowed = replace(problem, catalog=catalog).with_sections(
        select=problem.spec.select.model_copy(update=fixed), method=method
    )
    rows = catalog.motors.rows[one.motor.part], catalog.gearheads.rows[one.gearhead.part]
    offered = candidates(narrowed, also=rows)
    evaluation = evaluate(narrowed, offered)
    found = (offered.motor == rows[0]) & (offered.gearhead == rows[1]) & (offered.belt == one.belt_ratio)
    return evaluation.checks_of(int(np.flatnonzero(found)[0]))


def _with_only(catalog: Catalog, kept: dict[str, Any]) -> Catalog:
    """The catalogue in which of some sections one part alone may be chosen; where none is named, any."""
    tables: dict[str, Table[Any]] = {}
    for section, part in kept.items():
        if part is not None:
            table = catalog.table(section)
            tables[section] = Table(section, table.columns, table.source, table["part"] != part.part)
    return catalog.with_tables(tables, {})
