"""Confidence in the verdict: checks by status, estimated figures, tolerances and the closed loop."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from drivesizer.output.probability import likely
from drivesizer.output.report.lines.machine import driven_over
from drivesizer.output.report.lines.reliability import error_and_weakest, reported
from drivesizer.output.report.sections.blocks import Column, Row, Table
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.texts import Status, Text
from drivesizer.output.text import margin
from drivesizer.results.check import GRAVEST
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.figures_behind_checks import marked_figures
from drivesizer.results.sizing import worst

__all__ = ["confidence_table"]


def confidence_table(content: Content) -> Table:
    """Grounds of the verdict."""
    best = content.drive
    assert best is not None
    rows = [Row(("checks", _status_counts(best))), *_estimated(best), *_marked(content, best)]
    rows += [*_tolerances(content), *_loop(content)]
    return Table(
        "Confidence in the verdict", (Column("", "name"), Column("", width=1.0)), rows, "confidence", "figures"
    )


def _status_counts(best: DriveSet) -> Text:
    """Checks by status; those that are not passed by their titles."""
    number = Counter(check.status for check in best.deciding)
    said = [f"{number['pass']} of {len(best.deciding)} pass"]
    for status in GRAVEST[:-1]:
        titles = [check.title for check in best.deciding if check.status == status]
        said += [f"{status}: {', '.join(titles)}"] if titles else []
    return "; ".join(said)


def _estimated(best: DriveSet) -> Iterator[Row]:
    if best.estimated:
        hanging = any(check.status == "open" for check in best.deciding)
        figures = ", ".join(one.title for one in best.estimated)
        held = "they decide the open checks" if hanging else "every check ends the same at both ends of their bands"
        yield Row(("estimated figures", f"{figures}; {held}"))


def _marked(content: Content, best: DriveSet) -> Iterator[Row]:
    """Figures behind the checks that are not quoted from the maker, counted by their mark."""
    number = Counter(mark for _, _, mark, _ in marked_figures(best, content.result.catalog) if mark != "estimated")
    if number:
        said = ", ".join(f"{count} {mark}" for mark, count in number.items())
        yield Row(("not from data sheets", f"figures behind the checks: {said}; to be confirmed before ordering"))


def _tolerances(content: Content) -> Iterator[Row]:
    one = reported(content.result)
    if content.result.uncertainty and one and one.reliability:
        claim = "no check fails" if one.reliability.unknown else "all checks pass"
        said = f"{claim} with a probability of {likely(one.reliability.probability)}"
        yield Row(("tolerances", f"{said} {error_and_weakest(one.reliability)}"))


def _loop(content: Content) -> Iterator[Row]:
    v = content.validation
    if v is None:
        return
    tight, unknown = worst(v.checks), ", ".join(c.title for c in v.checks if c.status == "unknown" and not c.advice)
    smallest = f" smallest margin {margin(tight.margin)}, {tight.title}" if tight else ""
    said = f"{smallest}{f'; unknown: {unknown}' if unknown else ''}; over {driven_over(v)}"
    yield Row((v.loop, (Status(v.status), said)))
