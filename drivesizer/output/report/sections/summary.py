"""The summary: the outcome, the drive with its parts, and where it is tight."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from drivesizer.output.counted import meeting, number_of
from drivesizer.output.no_drive import not_enough
from drivesizer.output.part_line import PartLine
from drivesizer.output.part_totals import LEAST, Total, totals
from drivesizer.output.parts import machine_parts
from drivesizer.output.probability import confidence
from drivesizer.output.report.lines import rows as table
from drivesizer.output.report.lines.drive import case_of, check_row, tight_of, tightest_checks
from drivesizer.output.report.lines.machine import driven_over, machine_words
from drivesizer.output.report.lines.reliability import error_and_weakest, none_reaches
from drivesizer.output.report.sections.blocks import Block, Checks, Table, Tiles, Verdict, Words
from drivesizer.output.report.sections.changes import changes_table
from drivesizer.output.report.sections.confidence import confidence_table
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.cycle import field_picture
from drivesizer.output.report.sections.part_lines import parts_table, total_of
from drivesizer.output.report.sections.section import Section
from drivesizer.output.report.sections.sheet import Cell, Sheet, SheetColumn
from drivesizer.output.report.sections.texts import Status, Strong, TableLink, Text, text_of
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import Check, worst
from drivesizer.units import KINDS

__all__ = [
    "OUTCOMES",
    "SUMMARY",
    "change_blocks",
    "check_line",
    "outcome_texts",
    "priced",
    "summed_tile",
    "texts",
    "tiles",
]

OUTCOMES = {
    "found": "the selected drive",
    "unsure": "the most probable drive: below the required confidence",
    "missed": "the closest rejected drive: it fails",
}


def _blocks(content: Content) -> Iterator[Block]:
    result, best = content.result, content.drive
    yield Verdict(bool(result.sets), [*outcome_texts(content)])
    if best:
        lines = machine_parts(best, result.problem)
        yield parts_table(lines, content.motors, OUTCOMES[content.outcome])
        yield Tiles(tiles(content, lines))
        yield Checks(
            ("The smallest margins; all checks are in ", TableLink("checks")),
            [*map(check_row, tightest_checks(best))],
            "tightest",
        )
        yield from change_blocks(content)
        yield confidence_table(content)
        yield field_picture(content)
    else:
        yield from change_blocks(content)


def change_blocks(content: Content) -> Iterator[Block]:
    """Changes of the spec after which a drive passes, where none does."""
    result = content.result
    if content.outcome == "missed" and result.relaxations:
        yield changes_table("Changes after which a drive passes, one figure at a time", result.relaxations)
    elif content.outcome == "missed" and result.counts.considered:
        yield Words(not_enough(result))


def outcome_texts(content: Content) -> Iterator[Text]:
    """Result of the search, and whether the closed loop passes."""
    yield from _found(content) if content.outcome != "missed" else _missed(content)
    v = content.validation
    if v:
        yield f"{v.loop.capitalize()} over {driven_over(v)}: ", Status(v.status), f" {v.failed}" if v.failed else ""


def _found(content: Content) -> Iterator[Text]:
    result, best, sampled = content.result, content.drive, content.result.uncertainty
    assert best is not None
    counts = result.counts
    numbers = f"Of {number_of(counts.considered, 'candidate')} {meeting(counts, best.status)}"
    required = confidence(sampled.confidence) if sampled and sampled.confidence is not None else ""
    if content.outcome == "unsure":
        yield (Strong(f"No drive reaches the confidence of {required}."),
               f" {numbers}, at nominal figures; {best.label} is the most probable.")  # fmt: skip
        return
    v = content.validation
    but = (
        f", which fails in {v.loop}" if v and v.failed else ", with figures unknown" if best.status == "unknown" else ""
    )
    head = Strong(f"A drive was found{but}.")
    if sampled and required:
        reach = "reaches" if sampled.reached == 1 else "reach"
        numbers += ", at nominal figures; "
        numbers += f"{sampled.reached} of {sampled.examined} sampled {reach} the confidence of {required}"
    ranked = result.objective.replace("_", " ")
    yield Status(content.status), " ", head, f" {numbers}; {best.label} is the best of them by {ranked}."


def _missed(content: Content) -> Iterator[Text]:
    best, counts = content.drive, content.result.counts
    said = "The selection in the spec leaves no combination of motor and gearhead."
    if best:
        failed = ", ".join(c.title for c in best.deciding if c.status == "fail")
        said = f"The closest rejected drive is {best.label}; it fails on: {failed}."
    yield Strong("No drive."), f" None of {counts.considered:,} candidates meets all limits. {said}"


def tiles(content: Content, lines: Sequence[PartLine]) -> list[tuple[str, str, str]]:
    """The figures that a reader wants first."""
    behaviour, best = content.behaviour, content.drive
    assert behaviour is not None and best is not None
    several = ", as specified" if len(content.result.problem.cases) > 1 else ""
    drives = "the one drive" if content.motors == 1 else f"all {content.motors} drives"
    tight = tight_of(best)
    return [
        ("Smallest margin", tight["margin"], tight["title"]),
        summed_tile(totals(lines), "mass", drives),
        summed_tile(totals(lines), "price", drives),
        ("Energy per cycle", behaviour.cost,
         f"drawn from the supply, {drives}" + (", each at its wheel" if content.wheel else several)),
        ("Total ratio", f"{best.total_ratio:.4g}", f"motor turns per turn of the {content.shaft}"),
    ]  # fmt: skip


def summed_tile(every: Sequence[Total], name: str, drives: str) -> tuple[str, str, str]:
    """A total of the parts list: its name, its value, and the parts that it leaves out or estimates."""
    found = [total for total in every if total.name == name]
    lacks = [role for role in found[0].lacks if all(role in t.lacks for t in found)] if found else []
    least = ", at least" if lacks else ""
    notes = [f"without {', '.join(lacks)}"] if least else []
    notes += [f"estimated: {', '.join(total.estimated)}" for total in found if total.estimated]
    value = " + ".join(total_of(total).removeprefix(LEAST) for total in found) or "unknown"
    return f"{name.capitalize()} of {drives}{least}", value, "; ".join(notes)


# -- the sheet


_COLUMNS = (
    SheetColumn("Drive sizing", "title"), SheetColumn("value", "value"), SheetColumn("unit", "unit", "unit"),
    SheetColumn("status", "status", "status"), SheetColumn("note", "note", "", 90),
)  # fmt: skip


def _sheet(content: Content) -> list[Sheet]:
    result, best = content.result, content.drive
    rows = [*_verdict(content)]
    if best:
        rows += [_part(OUTCOMES[content.outcome].capitalize()), *_drive(best, content)]
        rows += [_part("Its smallest margins"), *map(check_line, tightest_checks(best))]
        grounds = confidence_table(content)
        rows += [_part(text_of(grounds.caption)), *_grounds(grounds)]
    if content.bought:
        rows += [_part(f"All parts of the machine, {content.motors} of each")]
        rows += map(priced, table.total_rows(totals(content.bought)))
    rows += _closed_loop(content)
    counts = table.count_rows(result)
    rows += [_part("Candidates"), *(row | {"value": Cell(row["value"], "count")} for row in counts)]
    if result.relaxations:
        rows += [_part("Changes after which a drive passes, one figure at a time")]
        rows += [table.change_row(r) | {"title": r.field} for r in result.relaxations]
    if result.uncertainty:
        rows += texts("Basis of the probabilities", result.uncertainty.notes)
    rows += [*texts("Assumptions", result.assumptions), *texts("Warnings", result.warnings)]
    return [Sheet(name="Summary", columns=_COLUMNS, rows=rows, filtered=False)]


def _grounds(of: Table) -> Iterator[table.Row]:
    yield from ({"title": text_of(name), "note": text_of(said)} for name, said in (row.cells for row in of.rows))


def _part(title: str) -> table.Row:
    return {"part": title}


def texts(title: str, lines: Sequence[str]) -> Iterator[table.Row]:
    """Rows of a sheet with a text each, below a title."""
    if lines:
        yield _part(title)
        yield from ({"across": line} for line in lines)


def _verdict(content: Content) -> Iterator[table.Row]:
    result, best = content.result, content.drive
    status = content.status if result.sets else "fail"
    yield {"title": "Machine", "note": result.spec.name}
    yield from ({"title": name, "note": value} for name, value in content.title_block)
    yield {"title": "Kind", "note": machine_words(result.spec)}
    none = none_reaches(result)
    said = f"{none}, the most probable" if none else "a drive was found" if result.sets else "no drive meets all limits"
    yield {"title": "Verdict", "status": status, "note": f"{said}: {best.label}" if best else said}
    yield {"title": "Drives of the machine", "value": Cell(content.motors, "count")}
    yield {"title": "Ranked by", "note": f"{result.objective.replace('_', ' ')}, method of {result.method}"}


def _drive(best: DriveSet, content: Content) -> Iterator[table.Row]:
    """Its parts in words, then ratio, mass and price."""
    for line in machine_parts(best, content.result.problem):
        named = line.part if line.part.startswith(line.family) else f"{line.family} {line.part}"
        note = ": ".join(filter(None, (f"{line.maker} {named}".strip(), line.said)))
        yield {"title": line.role.capitalize(), "status": "" if note else "unknown", "note": note}
    shown = ("total_ratio", "mass", "price", "verdict")
    yield from (priced(row) for row in table.set_rows(best, "") if row["name"] in shown)
    if best.reliability:
        yield {"title": "All checks pass, with tolerances", "value": Cell(best.reliability.passing, "share"),
               "unit": "of samples", "note": error_and_weakest(best.reliability)}  # fmt: skip


def priced(row: table.Row) -> table.Row:
    """A price with two decimals."""
    return row | {"value": Cell(row["value"], "money")} if row.get("unit") in _CURRENCIES else row


_CURRENCIES = {KINDS[kind].si for kind in KINDS if kind.startswith("price")}


def check_line(c: Check) -> table.Row:
    """A check in a row of the summary: its margin as value, demand and limit in the note."""
    row = check_row(c)
    against = f"{row['demand']} against {row['limit']}" if row["demand"] else ""
    note = "; ".join(filter(None, (against, case_of(c), c.note)))
    return {"title": c.title, "value": Cell(c.margin, "percent"), "unit": "margin", "status": c.status, "note": note}


def _closed_loop(content: Content) -> Iterator[table.Row]:
    v = content.validation
    if v is None:
        return
    yield _part(v.loop.capitalize())
    yield {"title": f"Over {driven_over(v)}", "status": v.status, "note": v.drive_set.label}
    tight = worst(v.checks)
    if tight:
        yield check_line(tight)
    yield from (table.figure_row("validation", f) for f in v.figures[:3])
    yield from texts("Assumptions of the simulation", v.assumptions)
    yield from texts("Warnings of the simulation", v.warnings)


SUMMARY = Section(name="summary", title="Summary", blocks=_blocks, sheets=_sheet, tabled=False)
