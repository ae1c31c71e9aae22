"""The sheets of a workbook that tell how sure the sets are: sets, their checks, and what is uncertain."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from typing import Any

from drivesizer.output.probability import confidence
from drivesizer.output.report.lines.reliability import none_as_sure
from drivesizer.output.report.table.reliability_rows import every_list, method_of
from drivesizer.output.report.table.rows import Row
from drivesizer.output.report.workbook.sheet import Column, Sheet
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.reliability import Uncertain, Uncertainty
from drivesizer.results.sizing import SizingResult

__all__ = ["of_tolerances"]

_RANK = Column("set", "rank", "count")
_MARGINS = (
    Column("margin that 95 % exceed (%)", "low", "percent"), Column("median margin (%)", "middle", "percent"),
    Column("margin that 5 % exceed (%)", "high", "percent"),
)  # fmt: skip
_SETS = (
    Column("list", "list"), _RANK, Column("drive", "label", "", 60), Column("all pass (%)", "probability", "share"),
    Column("error, 95 % (%)", "error", "error"), Column("weakest check", "weakest"), *_MARGINS,
    Column("unknown checks", "unknown"),
)  # fmt: skip
_LOOP = (
    Column("all pass in closed loop (%)", "loop_passing", "share"),
    Column("none fails in closed loop (%)", "loop_probability", "share"),
    Column("its error, 95 % (%)", "loop_error", "error"), Column("weakest in closed loop", "loop_weakest"),
    Column("unknown in closed loop", "loop_unknown"),
    Column("samples in closed loop", "loop_samples", "count"),
)  # fmt: skip
_CHECKS = (
    _RANK, Column("check", "title"), Column("method", "method"), Column("passes (%)", "passes", "share"),
    Column("fails (%)", "fails", "share"), Column("tightest of all (%)", "weakest", "share"), *_MARGINS,
)  # fmt: skip
_UNCERTAIN = (
    _RANK, Column("figure", "title"), Column("tolerance", "text"), Column("share of variance (%)", "share", "needed"),
    Column("rank correlation", "correlation", "correlation"), Column("low", "low"),
    Column("smallest margin at low (%)", "low_margin", "percent"), Column("high", "high"),
    Column("smallest margin at high (%)", "high_margin", "percent"), Column("from", "source", "", 70),
)  # fmt: skip


def of_tolerances(result: SizingResult) -> list[Sheet]:
    """Three sheets; none where nothing was sampled."""
    told = result.uncertainty
    if told is None:
        return []
    sampled = [(where, one) for where, one in every_list(result, front=False) if one.reliability]
    sets = [one for _, one in sampled]
    rows = [{"list": where} | _set(one) for where, one in sampled]
    columns = (*_SETS, *(_LOOP if any("loop_samples" in row for row in rows) else ()))
    return [
        Sheet(name="Tolerances", columns=columns, rows=rows, note=_sampled(result, told), still=3),
        Sheet(name="Tolerance checks", columns=_CHECKS, rows=[row for one in sets for row in _checks(one)], still=2,
              note="share of samples; what neither passes nor fails is unknown"),
        Sheet(name="Uncertain figures", columns=_UNCERTAIN, rows=[*_uncertain(sets, told.assumptions)], still=2,
              note="low and high: the 5 % and 95 % quantile of this alone; share: of the smallest margin's variance"),
    ]  # fmt: skip


def _sampled(result: SizingResult, told: Uncertainty) -> str:
    """How the sets were sampled, and whether any is as sure as was asked for."""
    sets = f"{told.examined} sets" if told.examined != 1 else "1 set"
    said = f"{sets} sampled, {told.samples} times each, seed {told.seed}"
    if told.confidence is None:
        return said
    return f"{said}; {none_as_sure(result) or f'{told.reached} of them as sure as {confidence(told.confidence)}'}"


def _set(one: DriveSet) -> Row:
    found = one.reliability
    assert found is not None
    row: Row = {
        "rank": one.rank, "label": one.label, "probability": found.passing, "error": found.error,
        "weakest": found.weakest, "low": found.low, "middle": found.middle, "high": found.high,
        "unknown": "; ".join(found.unknown),
    }  # fmt: skip
    loop: dict[str, Any] = {}
    if found.loop:
        loop = asdict(found.loop) | {"passing": found.loop.passing, "unknown": "; ".join(found.loop.unknown)}
    return row | {f"loop_{name}": value for name, value in loop.items()}


def _checks(one: DriveSet) -> Iterable[Row]:
    """The checks of a set, those that fail most first."""
    assert one.reliability is not None
    for check in sorted(one.reliability.checks, key=lambda check: -check.fails):
        yield {
            "rank": one.rank, "title": check.title, "method": method_of(check, one), "passes": check.passes,
            "fails": check.fails, "weakest": check.weakest, "low": check.low, "middle": check.middle,
            "high": check.high,
        }  # fmt: skip


def _uncertain(sets: list[DriveSet], assumptions: Iterable[Uncertain]) -> Iterable[Row]:
    """What is uncertain, with what it does to each set; without a set alone."""
    said = {one.name: {"title": one.title, "text": one.text, "source": one.source} for one in assumptions}
    drivers = [(one.rank, driver) for one in sets if one.reliability for driver in one.reliability.drivers]
    for rank, one in drivers:
        yield said[one.name] | {
            "rank": rank, "share": one.share, "correlation": one.rank_correlation, "low": one.low, "high": one.high,
            "low_margin": one.low_margin, "high_margin": one.high_margin,
        }  # fmt: skip
    if not drivers:
        yield from said.values()
