"""The first pages: the outcome, the drive with its parts, checks, confidence, assumptions, changes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from drivesizer.output.derivation import margin
from drivesizer.output.parts import (
    LEAST,
    PartLine,
    SharedLine,
    Total,
    machine_parts,
    mass_text,
    money_text,
    ordered_as,
    total_text,
    totals,
)
from drivesizer.output.report.lines import rows as table
from drivesizer.output.report.lines.rows import (
    case_of,
    change_row,
    check_texts,
    driven_over,
    error_and_weakest,
    machine_words,
    none_reaches,
    reported,
    tight_of,
    tightest_checks,
)
from drivesizer.output.report.sections.cycle import field_picture
from drivesizer.output.report.sections.section import (
    LIMITS,
    RANK,
    Block,
    Bullets,
    Cell,
    Checks,
    Column,
    Content,
    CsvRows,
    Mark,
    Row,
    Section,
    Sheet,
    SheetColumn,
    Small,
    Status,
    Strong,
    Table,
    TableLink,
    Text,
    Tiles,
    Verdict,
    Words,
    quantity,
    ranked,
    text_of,
)
from drivesizer.output.tables import not_enough
from drivesizer.output.words import about, confidence, likely, meeting, number_of
from drivesizer.results.check import GRAVEST
from drivesizer.results.check_kinds import marked_figures, part_of, sorted_by_part, unknown_figures
from drivesizer.results.drive_set import Comparison, DriveSet, Relaxation
from drivesizer.results.sizing import Check, worst
from drivesizer.units import KINDS

__all__ = [
    "ASSUMPTIONS", "CHANGES", "CHECKS", "DRIVE", "ESTIMATES", "OUTCOMES", "PHYSICS", "SUMMARY", "change_blocks",
    "check_line", "confidence_table", "outcome_texts", "parts_table", "priced", "shared_parts_table", "summed_tile",
    "texts", "tiles", "total_of", "unknown_blocks",
]  # fmt: skip


# -- The parts list of the machine as a table: quantity, part, order number, mass and price, and their totals.


def parts_table(lines: Sequence[PartLine], motors: int, outcome: str) -> Table:
    """Parts to order for the whole machine, with the totals of mass and price."""
    drives = "the one drive" if motors == 1 else f"all {motors} drives"
    return _table(f"Parts of {drives}: {outcome}", [(line, "") for line in lines], totals(lines))


def shared_parts_table(lines: Sequence[SharedLine], every: Sequence[Total], whole: str) -> Table:
    """Parts to order for a machine of several axes, each with the axes that need it."""
    return _table(f"Parts of {whole}", [(one.line, ", ".join(one.axes)) for one in lines], every)


def _table(caption: str, lines: Sequence[tuple[PartLine, str]], every: Sequence[Total]) -> Table:
    """Lines with a note on each, and their totals."""
    axes = any(note for _, note in lines)
    columns = (Column("", "number"), Column("part", "name"), Column("maker and family", width=1.35 if axes else 1.0),
               Column(f"order number{', axes' if axes else ''}", "strong", 1.1), Column("mass of all", "number"),
               Column("price each", "number"), Column("together", "number"))  # fmt: skip
    sums = {name: " + ".join(total_of(t) for t in every if t.name == name) for name in ("mass", "price")}
    total = Row(("", "total", "", "", sums["mass"] or "unknown", "", sums["price"] or "unknown"), total=True)
    dates = ", ".join(dict.fromkeys(line.price_date for line, _ in lines if line.price_date))
    dated = f"; prices of {dates}" if dates else ""
    caption += f"{dated}; without cables, connectors and couplings"
    caption += "; ≈ estimated" if any(total.estimated for total in every) else ""
    rows = [_row(line, note) for line, note in lines]
    return Table(caption, columns, [*rows, total], name="parts", look="parts")


def total_of(total: Total) -> str:
    """A total as reports print it: an estimated mass with a digit less."""
    return total_text(total, 3 if total.estimated else 4)


def _row(line: PartLine, note: str) -> Row:
    maker = line.family if line.maker in line.family else f"{line.maker} {line.family}"
    named = ", ".join(filter(None, (maker.strip(), line.said)))
    if not line.part and not named:
        named = "none is listed for this motor"
    order = ordered_as(line.part, line.order_number)
    return Row((f"{line.quantity} ×", line.role, named, (order, Small(note)) if note else order,
                mass_text(line), money_text(line.price, line.currency),
                money_text(line.quantity * line.price, line.currency)))  # fmt: skip


# -- Changes of the spec that would let a rejected drive pass.


def changes_table(caption: str, changes: Sequence[Relaxation]) -> Table:
    """Fields of the spec as they are and as they would have to be."""
    if any(one.status != "pass" for one in changes):
        caption = caption.replace(" passes,", " passes or fails no check,", 1)
    columns = (
        Column("field"),
        Column("now", "number"),
        Column("needed", "number"),
        Column("drive", width=1.0),
    )
    rows = [Row((r.field.replace("_", " ").replace(".", " › "), r.now, r.needed, r.set_label)) for r in changes]
    return Table(caption, columns, rows)


def _changes_blocks(content: Content) -> Iterator[Block]:
    if content.drive and content.drive.changes and not content.result.sets:
        yield changes_table("Changes after which this drive passes, one figure at a time", content.drive.changes)


CHANGES = Section(
    name="changes", title="What would let it pass", level=2, blocks=_changes_blocks, tabled=False,
    csv=CsvRows(of_drive=lambda content, _, drive: map(change_row, drive.changes)),
)  # fmt: skip


# -- Assumptions and warnings, and the figures that are estimated, unknown or not from a document.


def _assumptions_blocks(content: Content) -> Iterator[Block]:
    result = content.result
    if result.assumptions:
        yield Bullets("Assumptions of the sizing:", list(result.assumptions))
    if result.warnings:
        yield Bullets((Strong("Warnings:"),), list(result.warnings), "alarm")
    yield from unknown_blocks(content)


def unknown_blocks(content: Content) -> Iterator[Block]:
    """Checks that are unknown, and figures behind checks that are from no document."""
    result, best = content.result, content.drive
    if best is None:
        return
    unknown = [Row((title, lacks)) for title, lacks in unknown_figures(best)]
    yield Table(f"Unknown checks{', and the figures that they lack' if unknown else ': none'}",
                (Column("check", "name"), Column("not known", width=1.0)), unknown, "unknown")  # fmt: skip
    marked = [
        Row((name, value, (Mark(mark),), checks)) for name, value, mark, checks in marked_figures(best, result.catalog)
    ]
    if not marked:
        yield Words("No check rests on a figure that is derived, recalled or estimated.")
        return
    columns = (Column("figure", "name"), Column("value", "number"), Column("is", "mark"),
               Column("checks that rest on it", "small", 1.0, merged=True))  # fmt: skip
    yield Table("Figures that a check rests on and that are not from a document: to be confirmed before anything is "
                "built", columns, marked, "marked")  # fmt: skip


ASSUMPTIONS = Section(name="assumptions", title="Assumptions and unknowns", blocks=_assumptions_blocks, tabled=False)


def _estimates(content: Content) -> Iterator[Block]:
    drive = content.drive
    if drive is None or not drive.estimated:
        return
    yield Words(
        "No data sheet gives these figures; they are estimated from parts of the same kind that have them. One part "
        "in twenty lies below the band, one above. A check passes where it passes at both ends."
    )
    columns = (Column("figure", "name"), Column("estimate", "number"), Column("from", "number"), Column("to", "number"),
               Column("terms; peers", "small", 1.0))  # fmt: skip
    rows = [
        Row(
            (
                one.title,
                *(quantity(value, one.unit, one.kind) for value in (one.value, one.low, one.high)),
                one.law.removeprefix("; "),
            )
        )
        for one in drive.estimated
    ]
    yield Table("Estimated figures", columns, rows)
    hanging = [check for check in drive.own_checks if check.status == "open"]
    if hanging:
        heads = Column("check", "name"), Column("it passes with"), Column("estimated figures behind it", "small", 1.0)
        yield Table("Open checks", heads, [Row((c.title, about(c.probability), c.note)) for c in hanging])


ESTIMATES = Section(name="estimates", title="Estimated figures", level=2, blocks=_estimates)


# -- Confidence in the verdict: checks by status, estimated figures, tolerances and the closed loop.


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


# -- The checks of the reported drive by part, and by physics where the method of the paper ranked.


_TITLES = {"found": "The selected drive", "unsure": "The most probable drive", "missed": "The closest rejected drive"}


def _intro(content: Content) -> Iterator[Block]:
    if content.drive:
        yield Words((f"{content.drive.label}: ", Status(content.drive.status)))


DRIVE = Section(name="drive", title=lambda content: _TITLES[content.outcome], blocks=_intro, tabled=False)


def _checks_blocks(content: Content) -> Iterator[Block]:
    best = content.drive
    if best is None:
        return
    worst = "; each in its worst load case, the one as specified where none is named" if content.cases else ""
    worst = "; each at its worst wheel" if content.wheel else worst
    yield Checks(
        f"All checks of {best.label}{worst}. The bar is the used share of the limit, the long tick 100 %, a "
        "short one where the margin begins that the spec requires",
        [*map(check_texts, sorted_by_part(best.checks))],
        "checks",
        grouped=True,
    )


def _physics(content: Content) -> Iterator[Block]:
    """The drive by physics, where the method of the paper ranked; the other way round it is left out."""
    best = content.drive
    if best is None or content.result.method != "paper" or not best.beside:
        return
    yield Words("The drive was ranked by the method of the paper, and its verdict is that method's. Here the same "
                "drive by physics: the whole load cycle, no factors of the paper.")  # fmt: skip
    yield Checks("Checks by physics", [*map(check_texts, sorted_by_part(best.beside))], "beside", grouped=True)
    columns = (Column("demand", "name"), Column("paper", "number"), Column("", "status"),
               Column("physics", "number"), Column("", "status"),
               Column("why they differ", "small", 1.0))  # fmt: skip
    yield Table("Both methods where they check the same limit", columns, [_compared(one) for one in best.comparison])


PHYSICS = Section(name="physics", title="The same drive by physics", blocks=_physics, appendix=True, tabled=False)


def _compared(pair: Comparison) -> Row:
    """A limit by both methods."""
    cells = [(c.shown(c.demand), (Status(c.status),)) for c in (pair.paper, pair.physics)]
    return Row((pair.paper.title, *cells[0], *cells[1], pair.why))


def _checks_sheet(content: Content) -> list[Sheet]:
    """Every check of every drive, by both methods."""
    columns = (RANK, SheetColumn("part", "part"), SheetColumn("check", "title"), SheetColumn("method", "method"),
               SheetColumn("load case", "case"), *LIMITS)  # fmt: skip
    rows = ranked(content, _rows)
    return [Sheet(name="Checks", columns=columns, rows=list(rows), still=3)]


def _rows(drive: DriveSet) -> Iterator[table.Row]:
    yield from (table.check_row("check", c) | {"part": part_of(c.name)} for c in drive.every_check)


def _drive_rows(_: Content, __: str, drive: DriveSet) -> Iterator[table.Row]:
    yield from map(table.requirement_row, drive.requirements)
    yield from (table.figure_row("figure", f) for f in drive.figures)
    yield from (table.check_row("check", c) for c in drive.every_check)


CHECKS = Section(
    name="checks",
    title="Checks",
    level=2,
    blocks=_checks_blocks,
    sheets=_checks_sheet,
    csv=CsvRows(of_drive=_drive_rows),
)


# -- The summary: the outcome, the drive with its parts, and where it is tight.


OUTCOMES = {
    "found": "the selected drive",
    "unsure": "the most probable drive: below the required confidence",
    "missed": "the closest rejected drive: it fails",
}


def _summary_blocks(content: Content) -> Iterator[Block]:
    result, best = content.result, content.drive
    yield Verdict(bool(result.sets), [*outcome_texts(content)])
    if best:
        lines = machine_parts(best, result.problem)
        yield parts_table(lines, content.motors, OUTCOMES[content.outcome])
        yield Tiles(tiles(content, lines))
        yield Checks(
            ("The smallest margins; all checks are in ", TableLink("checks")),
            [*map(check_texts, tightest_checks(best))],
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


def _summary_sheet(content: Content) -> list[Sheet]:
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
    row = check_texts(c)
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


SUMMARY = Section(name="summary", title="Summary", blocks=_summary_blocks, sheets=_summary_sheet, tabled=False)
