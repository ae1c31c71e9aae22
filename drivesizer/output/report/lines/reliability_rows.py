"""The probabilities of the drives, as rows of plain data under the names in ``rows.COLUMNS`` and ``QUANTILES``.

CSV and workbook print the same floats. A probability stands in per cent and, in SI, as a share of 1; a margin is a
share of 1, as in every other row. Drives that were not sampled have no such rows.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from math import nan
from typing import Any

from drivesizer.output.probability import confidence
from drivesizer.output.report.lines.rows import Row, figure_row, plain_row, row
from drivesizer.results.check import Figure
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.reliability import Driver, FigureSpread, Reliability, Spread
from drivesizer.results.sizing import SizingResult

__all__ = [
    "QUANTILES", "below_confidence_row", "chance_columns", "chances", "every_list", "method_of", "reliability_rows",
    "sampling_rows",
]  # fmt: skip

QUANTILES = ("margin_5", "margin_50", "margin_95")  # margins that 95 %, 50 % and 5 % of samples exceed


def sampling_rows(result: SizingResult) -> Iterator[Row]:
    """The sampling, and each uncertain figure with the source of its tolerance."""
    sampled = result.uncertainty
    if sampled is None:
        return
    counts = {
        "samples": ("Samples of each drive", sampled.samples),
        "seed": ("Seed of the samples", sampled.seed),
        "sets_sampled": ("Drives that were sampled", sampled.examined),
    }
    if sampled.confidence is not None:
        yield _share("sampling", "confidence", "Required confidence", sampled.confidence)
        counts["sets_that_reach_it"] = ("Drives that reach the required confidence", sampled.reached)
    for name, (title, count) in counts.items():
        yield row("sampling", name, title, value=count)
    for one in sampled.assumptions:
        yield row("uncertain", one.name, one.title, value=one.text, note=one.source)


def every_list(result: SizingResult, *, front: bool = True) -> list[tuple[str, DriveSet]]:
    """Every drive of the report with the list that it is on; those of the front have ranks of their own."""
    lists = {"set": result.sets, "unsure": result.unsure, "miss": result.misses}
    return [(name, one) for name, some in (lists | {"front": result.front if front else ()}).items() for one in some]


def below_confidence_row(result: SizingResult) -> Row:
    """The row that marks a drive below the required confidence."""
    wanted = result.uncertainty.confidence if result.uncertainty else None
    title = "Meets all limits, but below the required confidence"
    return row("set", "unsure", title, note=f"below the confidence of {confidence(wanted)}")


def reliability_rows(one: DriveSet) -> Iterator[Row]:
    """A drive over its samples: the probability that all checks pass, each check alone, and the drivers."""
    found = one.reliability
    if found is None:
        return
    margins = (found.low, found.middle, found.high)
    yield _share("reliability", "all_checks", "All checks pass", found.passing) | _quantiles(*margins)
    yield _share("reliability", "none_fails", "No check fails", found.probability)
    yield _share("reliability", "error_95", "Error of that, 95 % to both sides", found.error)
    yield row("reliability", "weakest_check", "Weakest check", value=_weakest(found), note=found.weakest)
    if found.loop:
        said = {"note": f"weakest: {found.loop.weakest}"}
        yield _share("reliability", "closed_loop", "All checks pass in closed loop", found.loop.passing) | said
        yield _share("reliability", "closed_loop_none_fails", "No check fails in closed loop", found.loop.probability)
        yield _share("reliability", "closed_loop_error_95", "Error of that, 95 % to both sides", found.loop.error)
        yield row("reliability", "closed_loop_samples", "Samples in closed loop", value=found.loop.samples)
    if found.no_loop:
        title = "All checks pass in closed loop"
        yield row("reliability", "closed_loop", title, status="unknown", note=found.no_loop)
    yield from (_check(spread, one) for spread in found.checks)
    yield from (line for spread in found.figures for line in _percentiles(spread))
    yield from (line for driver in found.drivers for line in _driver(driver))


def _share(section: str, name: str, title: str, value: float) -> Row:
    return row(section, name, title, value=100.0 * value, unit="%", si_value=value, si_unit="1")


def _quantiles(*margins: float) -> Row:
    return dict(zip(QUANTILES, margins, strict=True))


def _check(spread: Spread, one: DriveSet) -> Row:
    """A check's share of samples that pass; what is left neither passes nor fails."""
    unknown = 1.0 - spread.passes - spread.fails
    said = {"status": "unknown", "note": f"unknown in {100.0 * unknown:.4g} % of samples"} if unknown > 0.0 else {}
    found = _share("reliability", spread.name, f"Passes: {spread.title}", spread.passes) | said
    return found | {"method": method_of(spread, one)} | _quantiles(spread.low, spread.middle, spread.high)


def _percentiles(spread: FigureSpread) -> Iterator[Row]:
    """A figure at its 5th, 50th and 95th percentile."""
    for percent, value in ((5, spread.low), (50, spread.middle), (95, spread.high)):
        title = f"{spread.title}, {percent} % of samples are below"
        yield figure_row(
            "percentile",
            Figure(name=f"{spread.name}_{percent}", title=title, value=value, kind=spread.kind, unit=spread.unit),
        )


def method_of(spread: Spread, one: DriveSet) -> str:
    """The method of a check: ``physics``, or ``budget`` of the machine."""
    budget = {check.name for check in one.budget}
    return "budget" if spread.name in budget else "physics"


def _driver(driver: Driver) -> Iterator[Row]:
    """The effect of one assumption on the smallest margin."""
    of = {"case": driver.name}
    yield _share("driver", "share_of_variance", "Share of the variance of the smallest margin", driver.share) | of
    title = "Rank correlation with the smallest margin"
    yield plain_row("driver", "rank_correlation", title, driver.rank_correlation, "1") | of
    ends = {"5": (driver.low, driver.low_margin), "95": (driver.high, driver.high_margin)}
    for quantile, (said, margin) in ends.items():
        title = f"Smallest margin with this at its {quantile} % quantile"
        yield row("driver", f"smallest_margin_at_{quantile}", title, margin=margin, note=f"at {said}") | of


def _weakest(found: Reliability) -> str:
    """The name of the weakest check, by which the other columns know it."""
    return next((check.name for check in found.checks if check.title == found.weakest), found.weakest)


_WHOLE = ("probability", "none_fails", "probability_error_95", "weakest_check", "unknown_checks", "smallest_margin_5",
          "smallest_margin_50", "smallest_margin_95")  # fmt: skip
_LOOP = ("closed_loop_probability", "closed_loop_none_fails", "closed_loop_error_95", "closed_loop_weakest_check",
         "closed_loop_unknown_checks", "closed_loop_samples")  # fmt: skip


def chance_columns(sets: Iterable[DriveSet]) -> tuple[str, ...]:
    """Heads of the columns of :func:`chances`; none where no drive was sampled."""
    found = [one.reliability for one in sets if one.reliability]
    if not found:
        return ()
    loop = _LOOP if any(one.loop for one in found) else ()
    checks = dict.fromkeys(check.name for one in found for check in one.checks)
    each = (f"{head}_{name}" for name in checks for head in ("passes", "fails", *QUANTILES))
    return (*_WHOLE, *loop, *each)


def chances(one: DriveSet, heads: Sequence[str]) -> list[Any]:
    """The probabilities of a drive, a cell for each head."""
    cells = _cells(one.reliability) if one.reliability else {}
    return [cells.get(head, "") for head in heads]


def _cells(found: Reliability) -> dict[str, Any]:
    margins = (found.low, found.middle, found.high)
    whole = (found.passing, found.probability, found.error, _weakest(found), "; ".join(found.unknown), *margins)
    loop = found.loop
    driven: tuple[Any, ...] = ("", "", nan, "", "", "")
    if loop:
        open_ = "; ".join(loop.unknown)
        driven = (loop.passing, loop.probability, loop.error, loop.weakest, open_, loop.samples)
    cells = dict(zip((*_WHOLE, *_LOOP), (*whole, *driven), strict=True))
    for check in found.checks:
        figures = {"passes": check.passes, "fails": check.fails}
        figures |= _quantiles(check.low, check.middle, check.high)
        cells |= {f"{head}_{check.name}": value for head, value in figures.items()}
    return cells
