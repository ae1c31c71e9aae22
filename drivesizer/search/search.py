"""The search over all candidates, by physics or by the paper's rule: drives that meet all limits in order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog, Table
from drivesizer.results.drive_set import Comparison, DriveParts
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Check, Counts
from drivesizer.search import ranking
from drivesizer.search.columns.candidates import Candidates, candidates, pairs
from drivesizer.search.columns.evaluation import Evaluation, by_physics, evaluate, smallest_margin
from drivesizer.search.columns.offers import chosen
from drivesizer.search.columns.paper import FEW
from drivesizer.search.in_order import (
    BudgetFilter,
    FullDrives,
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
    Sifted,
    any_passes,
    better_but_unknown,
    equals_of_the_last,
    ranked,
    sifted,
    waveforms,
)
from drivesizer.spec.drive import Choice, MotorChoice

__all__ = ["any_drive", "compared", "other_checks", "search"]


# -- The search by the paper's rule: it compares the reductions of a family, so that all candidates are at hand.


Rows = NDArray[np.int64]


def search_by_paper(
    problem: Problem, top: int, misses: int | None, pareto: tuple[str, ...], judge: Judge | None, others: int
) -> SearchResult:
    """Search all candidates by the paper's rule."""
    every = _paper_order(problem, rejected=misses is not None)
    found, sets = every.evaluation, every.evaluation.candidates
    of_parts = found._replace(checks=[])  # budgets of the machine look at no other checks
    kept = ordered_in_machine(judge, sets, of_parts.on, every.passing, len(sets.motor) if pareto else top)
    best, short = kept.best[:top], kept.rejected[:top]
    near = every.rejected[: _closest(misses, top, len(best), every.counts.feasible)]
    on_front = best[:0]
    if pareto:
        figures = {name: column[kept.best] for name, column in every.figures.items()}
        of_all = ranking.front(problem.catalog, sets.on(kept.best), figures, pareto)
        on_front = kept.best[of_all]
    unlike = best[:0]
    if others:
        unlike = best_of_other_families(
            judge, problem.catalog, sets, found.on, every.passing, best[:1], others, every.rank.columns
        )
    few = np.concatenate([best, near, but_for(on_front, best), short, but_for(unlike, best)])
    places = {int(row): n for n, row in enumerate(few)}
    front, below, beside = (tuple(places[int(row)] for row in rows) for rows in (on_front, short, unlike))
    return SearchResult(
        found.on(few), len(best), without_rejected(every.counts, kept, ~found.unknown), front, below,
        failing_before(kept, every.passing), others=beside, every=every.all_passing(best),
    )  # fmt: skip


class _PaperOrder(NamedTuple):
    """All candidates by the rule, in order."""

    evaluation: Evaluation
    margin: NDArray[np.float64]  # the smallest of each
    figures: dict[str, NDArray[np.float64]]  # it and the parts that go with each
    rank: Rank
    passing: Rows  # those that pass, the best first
    rejected: Rows  # the others, the nearest first
    counts: Counts

    def all_passing(self, best: Rows) -> Passing:
        """All that pass, and which of them are given."""
        some, found = self.passing, self.evaluation
        figures = {name: column[some] for name, column in self.figures.items()}
        return Passing(
            found.candidates.on(some), self.rank.precedence[some] * UNKNOWN, figures,
            _places(some, best, len(self.margin)), lambda rows: found.on(some[rows]),
        )  # fmt: skip


def _paper_order(problem: Problem, rejected: bool) -> _PaperOrder:
    """Evaluate all candidates; of the rejected perhaps not all."""
    every = _all_candidates(problem)
    found = evaluate(problem, every, rejected=rejected)
    margin, failed, unknown = smallest_margin(found.checks), found.failed, found.unknown
    each = np.array([check.failed for check in found.checks])
    figures = {"margin": margin, **chosen(found.encoder, found.controller, found.brake, needs_encoder=True)}
    value, missing = ranking.values(problem.catalog, found.candidates, figures, problem.spec.select.objective)
    before = [
        np.where(failed, 2, unknown.astype(int)),
        np.where(failed, -margin, 0.0),  # of those that fail first the nearest
        np.where(failed, each.sum(axis=0), 0),
    ]
    order = ranking.order(problem.catalog, found.candidates, value, missing, margin=margin, before=before)
    passes = ~failed if problem.spec.select.unknown == "allow" else ~failed & ~unknown
    tally = {check.name: count for check, count in zip(found.checks, each.sum(axis=1).tolist(), strict=True) if count}
    left_out = int(np.count_nonzero(~failed & ~passes))
    counts = Counts(
        considered=len(every.motor), feasible=int(passes.sum()), passing=int((~failed & ~unknown).sum()),
        left_out=left_out, failed_by=tally,
    )  # fmt: skip
    rank = Rank(unknown.astype(np.int64), missing, value)
    return _PaperOrder(found, margin, figures, rank, order[passes[order]], order[~passes[order]], counts)


def _closest(misses: int | None, top: int, given: int, feasible: int) -> int:
    """Number of the closest rejected that are given."""
    if misses is None:
        return 0
    return min(misses, max(top - given, 0)) if feasible else top


def _all_candidates(problem: Problem) -> Candidates:
    """All of them: of few the same record again, which variants of a spec have in common."""
    belts = tuple(problem.belt_ratios)
    if len(pairs(problem).motor) * len(belts) > FEW:
        return candidates(problem)
    key, of = ("candidates", problem.spec.is_direct, belts), (problem.spec.select,)
    found: Candidates = problem.catalog.once(key, lambda: candidates(problem), of)
    return found


def _places(rows: NDArray[np.int64], some: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Places of some of the rows among them all, in the order of all."""
    wanted = np.zeros(count, bool)
    wanted[some] = True
    return np.flatnonzero(wanted[rows])


# -- The search over all candidates: drives that meet all limits in order, and the closest rejected.
#
# By physics the candidates go through in chunks, behind some belts at a time: those that pass are kept as rows of a
# few numbers, the rejected only while they are among the closest. So memory grows with the drives that pass, not
# with the candidates. The drives that are shown are then computed in full.


_QUICK = "mass"  # objective that needs no waveform


class _SearchOptions(NamedTuple):
    """Results that a search is to give, as ``search`` takes them."""

    top: int
    misses: int | None
    pareto: tuple[str, ...]
    others: int

    def closest(self, passing: Rows) -> int:
        """Number of the closest rejected."""
        return 0 if self.misses is None else self.misses if len(passing) else self.top


class _Searched(NamedTuple):
    """A search so far."""

    problem: Problem
    kept: Sifted
    rank: Rank
    order: Rows  # of those kept, the best first
    looked_at: FullDrives


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
    """Search all candidates in the order of the objective that the problem's spec has."""
    if problem.spec.method == "paper":
        return search_by_paper(problem, top, misses, pareto, judge, others)
    wanted, several = _SearchOptions(top, misses, pareto, others), 4 * top if judge else top
    kept, rejected, counts = sifted(
        problem, pareto=pareto, progress=progress, margins=margins, wanted=0 if pareto else several
    )
    rank = ranked(problem, kept, top)
    order = rank.order(problem.catalog, kept.sets)
    tied, rest = np.split(order, [equals_of_the_last(problem, rank, order, top)])
    alone = not (judge or pareto or others)  # then no more than the first are looked at
    looked_at, tied = drives_by_margin(
        problem, kept, rank, tied, _drives_beside(problem, kept, rank, order, len(tied), others), rejected,
        wanted.closest(tied), top if alone else len(tied),
    )  # fmt: skip
    found = _Searched(problem, kept, rank, np.concatenate([tied, rest]), looked_at)
    in_machine = ordered_in_machine(judge, kept.sets, looked_at.at, found.order, len(order) if pareto else top)
    return _shown(found, wanted, judge, in_machine, counts)


def _drives_beside(problem: Problem, kept: Sifted, rank: Rank, order: Rows, first: int, others: int) -> Rows:
    """Drives that may be shown and are not among the first; none where waveforms take long.

    Those of other motor families, and one that is held back.
    """
    found = better_but_unknown(problem, kept, rank, order[:1])
    if others:
        alike = margin_candidates(problem.catalog, kept.sets, order, first, others, rank.columns)
        found = np.concatenate([but_for(found, alike), alike])
    found = but_for(found, order[:first])
    return found if first + len(found) <= waveforms(problem) else order[:0]


def _shown(
    found: _Searched, wanted: _SearchOptions, judge: Judge | None, in_machine: BudgetFilter, counts: Counts
) -> SearchResult:
    """The best, the closest rejected and the others in full."""
    problem, kept, rank, order, looked_at = found
    best, short = in_machine.best[: wanted.top], in_machine.rejected[: wanted.top]
    misses = min(wanted.closest(best), len(looked_at.nearest.motor))  # a budget of the machine may reject all
    on_front = _front(found, wanted, in_machine.best)
    held = better_but_unknown(problem, kept, rank, best)
    unlike = best_of_other_families(
        judge, problem.catalog, kept.sets, looked_at.at, order, best[:1], wanted.others, rank.columns,
        None if waveforms(problem) else looked_at.by_bounds,
    )  # fmt: skip
    extra = np.concatenate([but_for(on_front, best), short, but_for(held, best), but_for(unlike, best)])
    places = {int(row): n for n, row in enumerate(best)}
    places |= {int(row): len(best) + misses + n for n, row in enumerate(extra)}
    front, below, beside = (tuple(places[int(row)] for row in rows) for rows in (on_front, short, unlike))
    counts = without_rejected(counts, in_machine, kept.passes)
    return SearchResult(
        looked_at.shown(best, misses, extra), len(best), counts, front, below,
        failing_before(in_machine, order), next((places[int(row)] for row in held), None), beside,
        Passing(kept.sets, kept.certainty, kept.figures, best, looked_at.anew),
    )  # fmt: skip


def _front(found: _Searched, wanted: _SearchOptions, passing: Rows) -> Rows:
    """Of the drives that pass those on the Pareto front, where one is wanted."""
    if not wanted.pareto:
        return passing[:0]
    figures = {name: column[passing] for name, column in found.kept.figures.items()}
    return passing[ranking.front(found.problem.catalog, found.kept.sets.on(passing), figures, wanted.pareto)]


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
