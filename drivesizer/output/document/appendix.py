"""The appendix: the specification as it was entered, what made the document out of what, and the data sheets."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from drivesizer.catalog import Catalog, columns_of, singular
from drivesizer.catalog.query import PartRow, origins
from drivesizer.output.document import records as doc
from drivesizer.output.document.content import Content, Reported
from drivesizer.output.document.part import datasheets
from drivesizer.results.drive_set import section_of
from drivesizer.version import __version__

# -- The specification as it was entered, by section, with the figures of the motion.


def specification(content: Content) -> Iterator[doc.Block]:
    """The specification as it was entered."""
    entered = content.result.spec.entered
    top = [[key, _scalar(value)] for key, value in entered.items() if not isinstance(value, dict | list)]
    groups = [{"title": "general", "rows": top}]
    groups += [{"title": key.replace("_", " "), "rows": _flat(value)} for key, value in entered.items()
               if isinstance(value, dict | list)]  # fmt: skip
    groups = [group for group in groups if group["rows"]]
    if groups:
        yield doc.Words(
            ("The figures as they were entered", *((" in ", doc.Code(content.file)) if content.file else ()), ".")
        )
    yield doc.Fragment("spec", groups)
    yield doc.picture("way")
    several = ", as specified" if content.cases else ""
    motion = (
        "The motion of the platform on its path, in its own axes."
        if content.wheel
        else f"The motion of one cycle{several}."
    )
    if content.result.method != "paper":  # whose derivation has it
        yield doc.picture("profile", motion=motion)


def _flat(value: Any, path: tuple[str, ...] = ()) -> list[list[str]]:
    if isinstance(value, dict):
        return [row for key, entry in value.items() for row in _flat(entry, (*path, str(key)))]
    if isinstance(value, list) and any(isinstance(entry, dict) for entry in value):
        rows = []
        for number, entry in enumerate(value, 1):
            plain = isinstance(entry, dict) and not any(isinstance(v, dict | list) for v in entry.values())
            if plain and "name" in entry:  # in one row under its name where it holds no more than figures
                figures = [f"{key.replace('_', ' ')} {_scalar(v)}" for key, v in entry.items() if key != "name"]
                rows.append([" › ".join((*path, _scalar(entry["name"]))), ", ".join(figures)])
            else:
                rows += _flat(entry, (*path, str(number)))
        return rows
    text = ", ".join(_scalar(entry) for entry in value) if isinstance(value, list) else _scalar(value)
    return [[" › ".join(path), text]]


def _scalar(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return "" if value is None else str(value)


# -- What made the document out of what.


_FEW = 4  # catalogues in the table; more are listed in a file of their own


def repeat(content: Reported) -> Iterator[doc.Block]:
    """Versions, digests and the file that a result came from; without one the fields as they were entered."""
    import yaml

    results, file = [axis.result for axis in content.contents.values()], content.file
    text, entered = content.given.text, content.given.entered
    if len(results) > 1:
        yield doc.Words(("A report of one axis, with its candidates and its heat: ",
                         doc.Code(f"drivesizer report {file} --axis NAME -o axis.pdf"), "."))  # fmt: skip
    catalogs = {name: digest for result in results for name, digest in result.catalog.digests.items()}
    method, objective = (", ".join(dict.fromkeys(getattr(result, name) for result in results))
                         for name in ("method", "objective"))  # fmt: skip
    few = catalogs.items() if len(catalogs) <= _FEW else ()
    facts = {"drivesizer": __version__, "method": method, "objective": objective.replace("_", " ")}
    rows: dict[str, doc.Cell] = {**facts}
    rows |= {f"catalogue {name}, digest": (doc.Code(digest),) for name, digest in few}
    yield doc.table("notes", "", rows.items())
    if not few:
        yield doc.Fragment("digests", [list(pair) for pair in catalogs.items()])
        digests = {f"catalogue {name}, digest": digest for name, digest in catalogs.items()}
        yield doc.table("words", "Catalogues", digests.items(), media="book")
    yield doc.table("words", "Words", doc.texts("words"), media="book")
    lines = text.splitlines()
    if lines:
        yield doc.Fragment("file", [file or "spec.yaml", *lines])
    written = lines or yaml.safe_dump(dict(entered), allow_unicode=True, sort_keys=False).splitlines()
    numbered = [(doc.Quantity(number), line) for number, line in enumerate(written, 1)]
    yield doc.table("file", f"The spec file: {file or 'spec'}", numbered, heads={"text": file or "spec"})


# -- data sheets


def data_sheets(content: Reported) -> Iterator[doc.Block]:
    """Data sheets of the parts of all drives, each once, below the meaning of their marks."""
    drives = [(axis.drive, axis.result.catalog) for axis in content.contents.values() if axis.drive]
    if not drives:
        return
    sheets = [sheet for drive, catalog in drives for sheet in datasheets(drive, catalog)]
    yield doc.Words((
        "Figures without a mark are quoted from the maker's own document. Marked ones are not: ", doc.Mark("secondary"),
        " copied by others, ", doc.Mark("derived"), " computed or inferred, ", doc.Mark("recalled"),
        " from memory, to be checked before anything is built. Figures that the catalogue does not know are not "
        "listed.",
    ))  # fmt: skip
    yield doc.Fragment("datasheets", [sheet for n, sheet in enumerate(sheets) if sheet not in sheets[:n]])


def figures_of_parts(content: Content) -> Iterator[doc.Block]:
    """Every known figure of the drive's parts with its source and confidence."""
    if content.drive is None:
        return
    once = {(section_of(part), part.part): part for part in content.drive.parts.values() if part is not None}
    rows = [row for (section, _), part in once.items() for row in _part_rows(section, part, content.result.catalog)]
    yield doc.table("sources", "Figures of the parts with their sources", rows)


def _part_rows(section: str, part: Any, catalog: Catalog) -> Iterator[doc.Row]:
    """The known figures of a part, and the notes on them."""
    known = origins(PartRow("", catalog, section, catalog.table(section).rows[part.part]))
    notes = catalog.notes_on(section, part.part)
    named = {"role": singular(section), "maker": part.manufacturer, "family": part.family, "number": part.part}
    for name, column in columns_of(section).items():
        if name == "price" and catalog.unpriced:  # in the currency of comparison: the parts list has its own
            continue
        if name in known and name not in ("family", "manufacturer"):
            value, source = getattr(part, name), known[name]
            money = column.kind.startswith("price")
            cell = (
                str(value)
                if column.kind == "text"
                else doc.Quantity(value, column.unit, "money" if money else column.kind, 6)
            )
            on = [note.text for note in notes if (name in note.fields if name != "part" else not note.fields)]
            yield doc.Row({**named, "title": name.replace("_", " "), "value": cell,
                           "confidence": (doc.Mark(source.confidence),), "note": "; ".join(on), "date": source.date,
                           "source": source.document}, name=name)  # fmt: skip
