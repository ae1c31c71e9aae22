"""The sheets of a workbook that tell: the summary, the chosen set's data sheets, the spec, and what the file is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isnan
from typing import Any

from drivesizer.catalog import Catalog, columns_of, one_of
from drivesizer.catalog.lookup import origins
from drivesizer.catalog.query import Hit
from drivesizer.control.validation import Validation
from drivesizer.output.parts import PartLine, parts_list, totals
from drivesizer.output.report.lines.machine import driven_over, machine_words
from drivesizer.output.report.lines.reliability import error_and_weakest, none_as_sure, standing
from drivesizer.output.report.lines.sets import case_of
from drivesizer.output.report.table.rows import Row, change_row, count_rows, figure_row, set_rows, total_rows
from drivesizer.output.report.workbook.sheet import Column, Sheet, Told
from drivesizer.results.drive_set import DriveSet, Relaxation, section_of
from drivesizer.results.sizing import Check, SizingResult, worst
from drivesizer.units import KINDS, from_si
from drivesizer.version import __version__

__all__ = ["about", "chosen_set", "spec", "summary"]

_TOLD = (
    Column("Drive sizing", "title"), Column("value", "value"), Column("unit", "unit", "unit"),
    Column("status", "status", "status"), Column("note", "note", "", 90),
)  # fmt: skip


def summary(result: SizingResult, validation: Validation | None, bought: Sequence[PartLine]) -> Sheet:
    """The machine, the drive that was found for it, what it comes to, where it is tight, and what to mind."""
    best = result.shown
    rows = [*_verdict(result, best)]
    if best:
        rows += [_part(_WHICH[standing(result)].capitalize()), *_set(best, result)]
        rows += [_part("Its tightest margins"), *map(_tight, _tightest(best))]
    if bought:
        rows += [_part(f"All parts of the machine, {result.spec.load.motors} of each")]
        rows += map(_priced, total_rows(totals(bought)))
    if validation:
        rows += _driven(validation)
    rows += [_part("Candidates"), *(row | {"value": Told(row["value"], "count")} for row in count_rows(result))]
    if result.relaxations:
        rows += [_part("What would let a set stand, one figure at a time"), *map(_moved, result.relaxations)]
    if result.uncertainty:
        rows += _texts("What the probabilities rest on", result.uncertainty.notes)
    rows += [*_texts("Taken for granted", result.assumptions), *_texts("The reader should know", result.warnings)]
    return Sheet(name="Summary", columns=_TOLD, rows=rows, filtered=False)


_WHICH = {
    "found": "the best set",
    "unsure": "the surest set: it is less sure than was asked for",
    "missed": "the nearest miss: it does not stand",
}


def _part(title: str) -> Row:
    return {"part": title}


def _texts(title: str, texts: Sequence[str]) -> Iterator[Row]:
    if texts:
        yield _part(title)
        yield from ({"told": text} for text in texts)


def _verdict(result: SizingResult, best: DriveSet | None) -> Iterator[Row]:
    status = result.sets[0].status if result.sets else "fail"
    yield {"title": "Machine", "note": result.spec.name}
    yield {"title": "What it is", "note": machine_words(result.spec)}
    none = none_as_sure(result)
    said = f"{none}, the surest" if none else "a set was found" if result.sets else "no set stands"
    yield {"title": "Verdict", "status": status, "note": f"{said}: {best.label}" if best else said}
    yield {"title": "Motor sets of the machine", "value": Told(result.spec.load.motors, "count")}
    yield {"title": "Ranked by", "note": f"{result.objective.replace('_', ' ')}, method of {result.method}"}


def _set(best: DriveSet, result: SizingResult) -> Iterator[Row]:
    """Its parts in words, then reduction, mass and price."""
    for line in parts_list(best, result.catalog, result.spec.load.motors):
        named = line.part if line.part.startswith(line.family) else f"{line.family} {line.part}"
        note = ": ".join(filter(None, (f"{line.maker} {named}".strip(), line.said)))
        yield {"title": line.role.capitalize(), "status": "" if note else "unknown", "note": note}
    shown = ("total_ratio", "mass", "price", "verdict")
    yield from (_priced(row) for row in set_rows(best, "") if row["name"] in shown)
    if best.reliability:
        yield {"title": "All checks pass, with tolerances", "value": Told(best.reliability.passing, "share"),
               "unit": "of samples", "note": error_and_weakest(best.reliability)}  # fmt: skip


def _priced(row: Row) -> Row:
    """A price as money is shown."""
    return row | {"value": Told(row["value"], "money")} if row.get("unit") in _CURRENCIES else row


_CURRENCIES = {KINDS[kind].si for kind in KINDS if kind.startswith("price")}


def _tightest(best: DriveSet) -> list[Check]:
    """What fails without a figure, then the smallest margins; what was kept small by choice says nothing."""
    bare = [c for c in best.deciding if c.status == "fail" and isnan(c.margin)]
    return [*bare, *sorted((c for c in best.deciding if c.is_comparable), key=lambda c: c.margin)][:5]


def _tight(c: Check) -> Row:
    against = "" if isnan(c.demand) and isnan(c.limit) else f"{c.shown(c.demand)} against {c.shown(c.limit)}"
    case = case_of(c)
    note = "; ".join(filter(None, (against, case, c.note)))
    return {"title": c.title, "value": Told(c.margin, "percent"), "unit": "margin", "status": c.status, "note": note}


def _moved(relaxation: Relaxation) -> Row:
    return change_row(relaxation) | {"title": relaxation.field}


def _driven(v: Validation) -> Iterator[Row]:
    yield _part("Closed loop")
    yield {"title": f"Over {driven_over(v)}", "status": v.status, "note": v.drive_set.label}
    tight = worst(v.checks)
    if tight:
        yield _tight(tight)
    yield from (figure_row("validation", f) for f in v.figures[:3])
    yield from _texts("The simulation assumes", v.assumptions)
    yield from _texts("The simulation warns", v.warnings)


_FIGURES = (
    Column("part", "role"), Column("maker", "maker"), Column("family", "family"), Column("number", "number"),
    Column("figure", "title"), Column("value", "value"), Column("unit", "unit", "unit"), Column("SI value", "si_value"),
    Column("SI unit", "si_unit", "unit"), Column("confidence", "confidence", "sure"), Column("note", "note", "", 70),
    Column("source date", "date"), Column("source", "document", "line"),
)  # fmt: skip


def chosen_set(result: SizingResult) -> Sheet:
    """Every known figure of the best set's parts with its source and how sure it is, and what the set does."""
    best = result.shown
    if best is None:
        return Sheet(name="Chosen set", columns=_FIGURES, rows=[], note="no set was looked at")
    does = [figure_row("figure", f) | {"role": "whole set", "confidence": "computed"} for f in best.figures]
    once = {(section_of(part), part.part): part for part in best.parts.values() if part is not None}
    rows = [row for (section, _), part in once.items() for row in _sheet(section, part, result.catalog)]
    note = "" if result.sets else _WHICH[standing(result)]
    return Sheet(name="Chosen set", columns=_FIGURES, rows=[*rows, *does], note=note, still=5)


_IN_HEAD = {"part", "family", "manufacturer"}


def _sheet(section: str, part: Any, catalog: Catalog) -> Iterator[Row]:
    """The known figures of a part, and the notes on them."""
    known = origins(Hit("", catalog, section, catalog.table(section).rows[part.part]))
    notes = catalog.notes_on(section, part.part)
    named = {"role": one_of(section), "maker": part.manufacturer, "family": part.family, "number": part.part}
    whole = "; ".join(note.text for note in notes if not note.fields)
    yield named | _sourced(known["part"]) | {"title": "part", "value": part.part, "note": whole}
    for name, column in columns_of(section).items():
        if name in known and name not in _IN_HEAD:
            said = "; ".join(note.text for note in notes if name in note.fields)
            yield named | _measured(getattr(part, name), column) | _sourced(known[name]) | {
                "title": name.replace("_", " "), "note": said}  # fmt: skip


def _measured(value: Any, column: Any) -> Row:
    if column.kind == "text":
        return {"value": value}
    form = "money" if column.kind.startswith("price") else "datum"
    return {"value": Told(from_si(value, column.unit, column.kind), form), "unit": column.unit,
            "si_value": value, "si_unit": KINDS[column.kind].si}  # fmt: skip


def _sourced(source: Any) -> Row:
    return {"confidence": source.confidence, "document": source.document, "date": source.date}


def spec(result: SizingResult) -> Sheet:
    """The spec file line by line, comments included; what was entered where there is no file."""
    import yaml

    text = result.spec.text or yaml.safe_dump(result.spec.entered, allow_unicode=True, sort_keys=False)
    file = result.spec.file.replace("\\", "/").rsplit("/", 1)[-1]
    rows = [{"line": number, "text": line} for number, line in enumerate(text.splitlines(), 1)]
    columns = (Column("line", "line", "count"), Column(file or "spec", "text", "code", 110))
    return Sheet(name="Spec", columns=columns, rows=rows, filtered=False)


_MEANING = (
    ("pass, fail, unknown", "a check with an unknown figure is unknown: it neither passes nor fails"),
    ("empty cell", "the figure is unknown; never zero"),
    ("numbers", "with all their digits, shown with four; the unit stands beside or in the head"),
    ("SI value", "the same figure in the unit of the SI"),
    ("margin", "limit over demand less 1; of a required minimum what there is over what is required less 1"),
    ("quoted", "from the maker's own document"),
    ("secondary", "copied by others"),
    ("derived", "worked out or inferred"),
    ("recalled", "from memory: to be checked before anything is built"),
)


def about(result: SizingResult, notes: Sequence[str]) -> Sheet:
    """What made the file out of what, and what its words mean.

    Parameters
    ----------
    result
        What the sizing found.
    notes
        What is to be known of the other sheets.
    """
    rows: list[Row] = [{"title": "drivesizer", "note": __version__}]
    rows += [{"title": f"catalogue {name}, digest", "note": digest} for name, digest in result.catalog.digests.items()]
    rows += [{"title": "method", "note": result.method}, {"title": "objective", "note": result.objective}]
    rows += [_part("Words"), *({"title": word, "note": said} for word, said in _MEANING)]
    rows += _texts("Of the sheets", notes)
    columns = (Column("About this file", "title"), Column("what it is", "note", "", 110))
    return Sheet(name="About", columns=columns, rows=rows, filtered=False)
