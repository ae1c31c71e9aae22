"""The search over all candidates, by physics or by the paper's rule: drives that meet all limits in order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog, Table
from drivesizer.results.check import Check
from drivesizer.results.drive_set import Comparison, DriveParts
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Counts
from drivesizer.search import ranking
from drivesizer.search.columns.candidates import candidates, pairs
from drivesizer.search.columns.evaluation import by_physics, evaluate, smallest_margin
from drivesizer.search.columns.offers import chosen
from drivesizer.search.columns.paper import FEW
from drivesizer.search.in_order import (
    Judge,
    Passing,
    SearchResult,
    best_of_other_families,
    but_for,
    drives_by_margin,
    failing_before,
    margin_candidates,
    ordered_in_machine,
    without_rejected,
)
from drivesizer.search.ranking import (
    UNKNOWN,
    Progress,
    Rank,
    any_passes,
    better_but_unknown,
    equals_of_the_last,
    ranked,
    sifted,
    waveforms,
)
from drivesizer.spec.drive import Choice, MotorChoice

Rows = NDArray[np.int64]
_QUICK = "mass"  # objective that needs no waveform


def search_by_paper(
    problem: Problem, top: int, misses: int | None, pareto: tuple[str, ...], judge: Judge | None, others: int
) -> SearchResult:
    """Search by the paper's rule: it compares the reductions of a family, so that all candidates are at hand."""
    catalog, belts = problem.catalog, tuple(problem.belt_ratios)
    if len(pairs(problem).motor) * len(belts) > FEW:
        sets = candidates(problem)
    else:  # of few the same record again, which variants of a spec have in common
        key, of = ("candidates", problem.spec.is_direct, belts), (problem.spec.select,)
        sets = catalog.once(key, lambda: candidates(problem), of)
    considered = len(sets.motor)
    found = evaluate(problem, sets, rejected=misses is not None)  # of the rejected perhaps not all
    sets, margin, failed, unknown = found.candidates, smallest_margin(found.checks), found.failed, found.unknown
    each = np.array([check.failed for check in found.checks])
    figures = {"margin": margin, **chosen(found.encoder, found.controller, found.brake, needs_encoder=True)}
    value, missing = ranking.values(catalog, sets, figures, problem.spec.select.objective)
    nearest = [np.where(failed, -margin, 0.0), np.where(failed, each.sum(axis=0), 0)]  # of those that fail
    before = [np.where(failed, 2, unknown.astype(int)), *nearest]
    order = ranking.order(catalog, sets, value, missing, margin=margin, before=before)
    passes = ~failed if problem.spec.select.unknown == "allow" else ~failed & ~unknown
    passing, rejected, rank = order[passes[order]], order[~passes[order]], Rank(unknown.astype(int), missing, value)
    tally = {check.name: count for check, count in zip(found.checks, each.sum(axis=1).tolist(), strict=True) if count}
    counts = Counts(
        considered=considered, feasible=len(passing), passing=int((~failed & ~unknown).sum()),
        left_out=int(np.count_nonzero(~failed & ~passes)), failed_by=tally,
    )  # fmt: skip
    of_parts = found._replace(checks=[])  # budgets of the machine look at no other checks
    kept = ordered_in_machine(judge, sets, of_parts.on, passing, len(sets.motor) if pareto else top)
    best, short, on_front, unlike = kept.best[:top], kept.rejected[:top], kept.best[:0], kept.best[:0]
    closest = top if not len(passing) else min(misses or 0, max(top - len(best), 0))
    near = rejected[: 0 if misses is None else closest]
    if pareto:
        of_best = {name: column[kept.best] for name, column in figures.items()}
        on_front = kept.best[ranking.front(catalog, sets.on(kept.best), of_best, pareto)]
    if others:
        unlike = best_of_other_families(judge, catalog, sets, found.on, passing, best[:1], others, rank.columns)
    few = np.concatenate([best, near, but_for(on_front, best), short, but_for(unlike, best)])
    places = {int(row): n for n, row in enumerate(few)}
    front, below, beside = (tuple(places[int(row)] for row in rows) for rows in (on_front, short, unlike))
    of_passing = {name: column[passing] for name, column in figures.items()}
    every = Passing(
        sets.on(passing), rank.precedence[passing] * UNKNOWN, of_passing,
        np.flatnonzero(np.isin(passing, best)), lambda rows: found.on(passing[rows]),
    )  # fmt: skip
    return SearchResult(
        found.on(few), len(best), without_rejected(counts, kept, ~unknown), front, below,
        failing_before(kept, passing), others=beside, every=every,
    )  # fmt: skip


def search(
    problem: Problem,
    *,
    top: int,
    misses: int | None = 3,
    pareto: tuple[str, ...] = (),
    progress: Progress | None = None,
    judge: Judge | None = None,
    others: int = 0,
    margins: bool = False,
) -> SearchResult:
    """Search all candidates in the order of the objective that the problem's spec has.

    By physics they go through in chunks, behind some belts at a time: those that pass are kept as rows of a few
    numbers, the rejected only while they are among the closest. So memory grows with the drives that pass, not with
    the candidates. The drives that are shown are then computed in full.
    """
    if problem.spec.method == "paper":
        return search_by_paper(problem, top, misses, pareto, judge, others)
    catalog, several = problem.catalog, 4 * top if judge else top
    kept, rejected, counts = sifted(
        problem, pareto=pareto, progress=progress, margins=margins, wanted=0 if pareto else several
    )
    rank = ranked(problem, kept, top)
    order = rank.order(catalog, kept.sets)
    tied, rest = np.split(order, [equals_of_the_last(problem, rank, order, top)])
    # what may be shown and is not among the first: one that is held back, and drives of other motor families
    beside = better_but_unknown(problem, kept, rank, order[:1])
    if others:
        alike = margin_candidates(catalog, kept.sets, order, len(tied), others, rank.columns)
        beside = np.concatenate([but_for(beside, alike), alike])
    beside = but_for(beside, tied)
    if len(tied) + len(beside) > waveforms(problem):
        beside = order[:0]
    closest = 0 if misses is None else misses if len(tied) else top
    alone = not (judge or pareto or others)  # then no more than the first are looked at
    looked_at, tied = drives_by_margin(
        problem, kept, rank, tied, beside, rejected, closest, top if alone else len(tied)
    )
    order = np.concatenate([tied, rest])
    in_machine = ordered_in_machine(judge, kept.sets, looked_at.at, order, len(order) if pareto else top)
    best, short, on_front = in_machine.best[:top], in_machine.rejected[:top], in_machine.best[:0]
    closest = 0 if misses is None else misses if len(best) else top  # a budget of the machine may reject all
    closest = min(closest, len(looked_at.nearest.motor))
    if pareto:
        of_best = {name: column[in_machine.best] for name, column in kept.figures.items()}
        on_front = in_machine.best[ranking.front(catalog, kept.sets.on(in_machine.best), of_best, pareto)]
    held = better_but_unknown(problem, kept, rank, best)
    unlike = best_of_other_families(
        judge, catalog, kept.sets, looked_at.at, order, best[:1], others, rank.columns,
        None if waveforms(problem) else looked_at.by_bounds,
    )  # fmt: skip
    extra = np.concatenate([but_for(on_front, best), short, but_for(held, best), but_for(unlike, best)])
    places = {int(row): n for n, row in enumerate(best)}
    places |= {int(row): len(best) + closest + n for n, row in enumerate(extra)}
    front, below, alternatives = (tuple(places[int(row)] for row in rows) for rows in (on_front, short, unlike))
    return SearchResult(
        looked_at.shown(best, closest, extra), len(best), without_rejected(counts, in_machine, kept.passes), front,
        below, failing_before(in_machine, order), next((places[int(row)] for row in held), None), alternatives,
        Passing(kept.sets, kept.certainty, kept.figures, best, looked_at.anew),
    )  # fmt: skip


def any_drive(problem: Problem, judge: Judge | None) -> bool:
    """Whether a search finds a drive, whatever ranks it: without waveforms of all, and no more examined than needed."""
    problem = problem.ranked_by(_QUICK)
    if problem.spec.method == "paper":
        return search_by_paper(problem, 1, None, (), judge, 0).passing > 0
    if judge is None:
        return any_passes(problem)
    kept, _, _ = sifted(problem)
    value = ranking.values(problem.catalog, kept.sets, kept.figures, _QUICK)
    order = ranking.order(problem.catalog, kept.sets, *value, before=[kept.certainty])
    found = ordered_in_machine(judge, kept.sets, lambda rows: by_physics(problem, kept.sets.on(rows), True), order, 1)
    return len(found.best) > 0


# -- The paper's method and the physics side by side, for drives that were found by one of them.


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
