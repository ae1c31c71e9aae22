"""The probability that each drive passes, its checks over the samples, and the assumptions that matter most."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict

from drivesizer.output.counted import number_of
from drivesizer.output.probability import confidence, moved
from drivesizer.output.report.lines.reliability import check_cells, drive_cells, driver_cells, none_reaches, reported
from drivesizer.output.report.lines.reliability_rows import every_list, method_of, reliability_rows, sampling_rows
from drivesizer.output.report.lines.rows import Row as SheetRow
from drivesizer.output.report.sections.blocks import Block, Bullets, Column, Picture, Row, Table
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.section import CsvRows, Section
from drivesizer.output.report.sections.sheet import Sheet, SheetColumn
from drivesizer.output.report.sections.texts import Strong, Text
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.reliability import Uncertain, Uncertainty

__all__ = ["RELIABILITY"]

_MOST_DRIVES = 10
_MOST_CHECKS = 12
_MOST_DRIVERS = 3


def _blocks(content: Content) -> Iterator[Block]:
    result, best = content.result, reported(content.result)
    sampled = result.uncertainty
    if sampled is None or best is None or best.reliability is None:
        return
    yield Bullets((f"Each drive was sampled {sampled.samples:,} times (seed {sampled.seed}) over the tolerances of "
                   "spec and catalogue.", *_reached(content, sampled), " Basis of the probabilities:"),
                  list(sampled.notes))  # fmt: skip
    yield from _probabilities(content, sampled)
    share = "share that passes, and quantiles of the margin"
    columns = [Column("check", "name", 1.0), Column("passes", "number"), Column("margin 5 %", "number"),
               Column("50 %", "number"), Column("95 %", "number")]  # fmt: skip
    rows = [Row(check_cells(one)) for one in moved(best.reliability)[:_MOST_CHECKS]]
    yield Table(
        f"The checks of {best.label} that samples change: {share}", columns, rows, "probability-checks", "probability"
    )
    columns = [Column("figure", "name", 1.0), *(Column(f"{q} %", "number") for q in (5, 50, 95))]
    rows = [Row([one.title, *one.texts]) for one in best.reliability.figures]
    yield Table(f"Figures of {best.label} over the samples: percentiles", columns, rows, "probability-figures",
                "probability")  # fmt: skip
    columns = [Column("assumption", "name", 1.0), Column("share", "number"), Column("margin at 5 %", "number"),
               Column("margin at 95 %", "number")]  # fmt: skip
    rows = [Row(driver_cells(one)) for one in best.reliability.drivers[:_MOST_DRIVERS]]
    yield Table("What its smallest margin depends on most: share of its variance, and the margin with this alone at "
                "its 5 % and 95 % quantile", columns, rows, "probability-drivers", "probability")  # fmt: skip
    yield Picture(
        "tornado", f"The smallest margin of all checks of {best.label} with one assumption at its 5 % and at its 95 % "
        "quantile, all others nominal; at the right the share of the variance that each makes alone. Left of the line "
        "the drive does not pass.", "bars of the effect of each assumption on the smallest margin",
        about="draws the effect of each assumption.")  # fmt: skip
    columns = [Column("figure", "name"), Column("tolerance"), Column("from", width=1.0)]
    rows = [Row((one.title, one.text, one.source)) for one in sampled.assumptions]
    yield Table("Uncertain figures", columns, rows, "uncertain", "probability")


def _reached(content: Content, sampled: Uncertainty) -> Iterator[str | Strong]:
    none = none_reaches(content.result)
    if none:
        yield from (
            f" Of {number_of(sampled.examined, 'drive')} that {'was' if sampled.examined == 1 else 'were'} sampled ",
            Strong(none),
            "; the most probable come first.",
        )
    elif sampled.confidence is not None:
        reach = "reaches" if sampled.reached == 1 else "reach"
        yield (f" Of {number_of(sampled.examined, 'drive')} {sampled.reached} {reach} the required confidence of "
               f"{confidence(sampled.confidence)}.")  # fmt: skip


def _probabilities(content: Content, sampled: Uncertainty) -> Iterator[Table]:
    """Two tables: drives that reach the required confidence, and drives that do not."""
    caption = "Probability that every check passes, and quantiles of the smallest margin"
    required = confidence(sampled.confidence)
    below = f"drives that meet all limits at nominal figures, but below the confidence of {required}"
    reach = [one for one in content.result.sets[:_MOST_DRIVES] if one.reliability]
    less = [one for one in content.result.unsure[:_MOST_DRIVES] if one.reliability]
    if reach:
        yield _table(caption, reach, "probabilities")
    if less:
        yield _table(below.capitalize() if reach else f"{caption}: {below}", less, "unsure")


def _table(caption: str, drives: Sequence[DriveSet], name: str) -> Table:
    cells = [drive_cells(one) for one in drives]
    looped = any(one["loop"] for one in cells)
    columns = (
        Column("", "number"), Column("drive", "name", 1.0), Column("all pass", "number"), Column("error", "number"),
        Column("weakest check", width=0.9), Column("margin 5 %", "number"), Column("50 %", "number"),
        *((Column("in closed loop", "number"),) if looped else ()),
    )  # fmt: skip
    rows = []
    for one in cells:
        weakest: Text = f"{one['weakest']} ({one['more']})" if one["more"] else one["weakest"]
        first = (one["rank"], one["label"], one["chance"], one["error"], weakest, one["low"], one["middle"])
        rows.append(Row((*first, one["loop"]) if looped else first, {"rank": one["rank"]}))
    return Table(caption, columns, rows, name, "probability", dense=True)


# -- the sheets


_RANK = SheetColumn("drive", "rank", "count")
_MARGINS = (
    SheetColumn("margin that 95 % exceed (%)", "low", "percent"), SheetColumn("median margin (%)", "middle", "percent"),
    SheetColumn("margin that 5 % exceed (%)", "high", "percent"),
)  # fmt: skip
_DRIVES = (
    SheetColumn("list", "list"), _RANK, SheetColumn("motor and gearhead", "label", "", 60),
    SheetColumn("all pass (%)", "probability", "share"), SheetColumn("error, 95 % (%)", "error", "error"),
    SheetColumn("weakest check", "weakest"), *_MARGINS, SheetColumn("unknown checks", "unknown"),
)  # fmt: skip
_LOOP = (
    SheetColumn("all pass in closed loop (%)", "loop_passing", "share"),
    SheetColumn("none fails in closed loop (%)", "loop_probability", "share"),
    SheetColumn("its error, 95 % (%)", "loop_error", "error"), SheetColumn("weakest in closed loop", "loop_weakest"),
    SheetColumn("unknown in closed loop", "loop_unknown"),
    SheetColumn("samples in closed loop", "loop_samples", "count"),
)  # fmt: skip
_CHECKS = (
    _RANK, SheetColumn("check", "title"), SheetColumn("method", "method"), SheetColumn("passes (%)", "passes", "share"),
    SheetColumn("fails (%)", "fails", "share"), SheetColumn("tightest of all (%)", "weakest", "share"), *_MARGINS,
)  # fmt: skip
_UNCERTAIN = (
    _RANK, SheetColumn("figure", "title"), SheetColumn("tolerance", "text"),
    SheetColumn("share of variance (%)", "share", "needed"),
    SheetColumn("rank correlation", "correlation", "correlation"), SheetColumn("low", "low"),
    SheetColumn("smallest margin at low (%)", "low_margin", "percent"), SheetColumn("high", "high"),
    SheetColumn("smallest margin at high (%)", "high_margin", "percent"), SheetColumn("from", "source", "", 70),
)  # fmt: skip


def _sheets(content: Content) -> list[Sheet]:
    """Drives, their checks, and the uncertain figures; none where nothing was sampled."""
    sampled = content.result.uncertainty
    if sampled is None:
        return []
    listed = [(where, one) for where, one in every_list(content.result, front=False) if one.reliability]
    drives = [one for _, one in listed]
    rows = [{"list": where} | _drive_row(one) for where, one in listed]
    columns = (*_DRIVES, *(_LOOP if any("loop_samples" in row for row in rows) else ()))
    return [
        Sheet(name="Tolerances", columns=columns, rows=rows, note=_note(content, sampled), still=3),
        Sheet(name="Tolerance checks", columns=_CHECKS, rows=[row for one in drives for row in _check_rows(one)],
              still=2, note="share of samples; what neither passes nor fails is unknown"),
        Sheet(name="Uncertain figures", columns=_UNCERTAIN, rows=[*_uncertain(drives, sampled.assumptions)], still=2,
              note="low and high: the 5 % and 95 % quantile of this alone; share: of the smallest margin's variance"),
    ]  # fmt: skip


def _note(content: Content, sampled: Uncertainty) -> str:
    drives = f"{sampled.examined} drives" if sampled.examined != 1 else "1 drive"
    said = f"{drives} sampled, {sampled.samples} times each, seed {sampled.seed}"
    if sampled.confidence is None:
        return said
    reached = f"{sampled.reached} of them reach the confidence of {confidence(sampled.confidence)}"
    return f"{said}; {none_reaches(content.result) or reached}"


def _drive_row(one: DriveSet) -> SheetRow:
    found = one.reliability
    assert found is not None
    row: SheetRow = {
        "rank": one.rank, "label": one.label, "probability": found.passing, "error": found.error,
        "weakest": found.weakest, "low": found.low, "middle": found.middle, "high": found.high,
        "unknown": "; ".join(found.unknown),
    }  # fmt: skip
    loop: SheetRow = {}
    if found.loop:
        loop = asdict(found.loop) | {"passing": found.loop.passing, "unknown": "; ".join(found.loop.unknown)}
    return row | {f"loop_{name}": value for name, value in loop.items()}


def _check_rows(one: DriveSet) -> Iterable[SheetRow]:
    """The checks of a drive, those that fail most first."""
    assert one.reliability is not None
    for check in sorted(one.reliability.checks, key=lambda check: -check.fails):
        yield {
            "rank": one.rank, "title": check.title, "method": method_of(check, one), "passes": check.passes,
            "fails": check.fails, "weakest": check.weakest, "low": check.low, "middle": check.middle,
            "high": check.high,
        }  # fmt: skip


def _uncertain(drives: Sequence[DriveSet], assumptions: Iterable[Uncertain]) -> Iterable[SheetRow]:
    """The uncertain figures with their effect on each drive; without a drive alone."""
    figures = {one.name: {"title": one.title, "text": one.text, "source": one.source} for one in assumptions}
    drivers = [(one.rank, driver) for one in drives if one.reliability for driver in one.reliability.drivers]
    for rank, one in drivers:
        yield figures[one.name] | {
            "rank": rank, "share": one.share, "correlation": one.rank_correlation, "low": one.low, "high": one.high,
            "low_margin": one.low_margin, "high_margin": one.high_margin,
        }  # fmt: skip
    if not drivers:
        yield from figures.values()


RELIABILITY = Section(
    name="reliability", title="Probability that the drives pass", level=2, blocks=_blocks, sheets=_sheets,
    csv=CsvRows(before=lambda content: sampling_rows(content.result),
                of_drive=lambda content, _, drive: reliability_rows(drive)),
)  # fmt: skip
