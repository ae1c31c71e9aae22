"""The paper's method and the physics side by side, for drives that were found by one of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from drivesizer.catalog import Catalog, Table
from drivesizer.results.drive_set import Comparison, DriveSet
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Check
from drivesizer.search.columns.candidates import candidates
from drivesizer.search.columns.evaluation import evaluate
from drivesizer.spec.select import Choice

__all__ = ["with_both_methods"]

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


def with_both_methods(problem: Problem, sets: Sequence[DriveSet]) -> tuple[DriveSet, ...]:
    """The same drives with the checks of the other method, and both compared.

    Parameters
    ----------
    problem
        The machine with its load cycles, and the catalogues.
    sets
        Drives as the search found them.

    Returns
    -------
    tuple
        The drives in their order; as they are where the paper does not treat the load.
    """
    if not problem.spec.paper_applies:
        return tuple(sets)
    return tuple(_with(one, _other(problem, one)) for one in sets)


def _with(one: DriveSet, beside: tuple[Check, ...]) -> DriveSet:
    by_method = {checks[0].method: {c.name: c for c in checks} for checks in (one.checks, beside) if checks}
    paper, physics = (by_method.get(method, {}) for method in ("paper", "physics"))
    both = [(a, b, why) for a, b, why in _PAIRS if a in paper and b in physics]
    compared = tuple(Comparison(paper=paper[a], physics=physics[b], why=why) for a, b, why in both)
    return replace(one, beside=beside, comparison=compared)


def _other(problem: Problem, one: DriveSet) -> tuple[Check, ...]:
    """The other method's checks of a drive.

    The gearhead's whole family comes along, as the paper's rule looks at the other reductions too.
    """
    fixed = {
        "motor": Choice(part=[one.motor.part]),
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
