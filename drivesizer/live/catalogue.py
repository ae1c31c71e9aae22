"""The catalogues on the page: parts that meet conditions, one with its curves, several side by side; a choice."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from drivesizer.catalog import DIRECT, PARTS, Catalog, catalog_of_text, load, shipped, singular
from drivesizer.catalog.importing import Plan, import_table
from drivesizer.catalog.laws import check as findings
from drivesizer.catalog.parts import printed
from drivesizer.catalog.query import OPTIONS, Condition, PartRow, option, origins, select, side_by_side, where
from drivesizer.errors import DrivesizerError, InputError, quoted
from drivesizer.files.sheets import tables_of
from drivesizer.files.yaml_source import YamlSource
from drivesizer.live.engine import EngineMemory, Piece
from drivesizer.output.document import part as sheets
from drivesizer.output.document.catalogue import import_words, listed, still_needed
from drivesizer.output.document.paper import as_data
from drivesizer.output.document.records import Words
from drivesizer.output.words import first_columns
from drivesizer.spec.drive import Select
from drivesizer.spec.machine import named_catalogs
from drivesizer.units import label

PAGE = 200  # rows that are sent at once
_LINES = 500  # findings that are sent
ALL = "all"  # of the shipped catalogues, as a spec names them
_DEFAULT: list[str] = Select.model_fields["catalogs"].default


# -- the catalogues


def catalogues(memory: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``catalogues``: all that ship, the spec's and the user's, with their parts; and the sections' columns."""
    spec_names = listed_names(named_by(memory, str(request["text"])))
    names = dict.fromkeys([*memory.own, *(name for name in spec_names if name not in shipped()), *shipped()])
    pieces = []
    for name in names:
        piece: Piece = {"name": name, "chosen": name in spec_names, "own": name in memory.own}
        try:
            catalog = shelf(memory, [name])[name]
        except DrivesizerError as error:
            pieces.append(piece | {"wrong": str(error), "parts": {}, "makers": ""})
            continue
        makers = dict.fromkeys(m for s in PARTS for m in catalog.table(s)["manufacturer"].tolist() if m)
        pieces.append(piece | {"parts": counts(catalog), "makers": ", ".join(makers)})
    sections = [
        {"name": section, "options": [name for name, columns in OPTIONS.items() if section in columns],
         "columns": [[name, label(column.unit), "" if column.unit == "1" else column.unit, column.kind == "text"]
                     for name, column in printed(section).items()]}
        for section in PARTS
    ]  # fmt: skip
    yield {"kind": "catalogues", "catalogues": pieces, "sections": sections}


def counts(catalog: Catalog) -> dict[str, int]:
    """Number of parts of each section that a catalogue has."""
    numbers = {section: int((catalog.table(section)["part"] != DIRECT).sum()) for section in PARTS}
    return {section: number for section, number in numbers.items() if number}


def named_by(memory: EngineMemory, text: str) -> list[str]:
    """Catalogues that a spec names, those of all axes together; those of a spec without any where it is no YAML."""
    try:
        data = YamlSource(text, memory.name).data
    except InputError:
        data = {}
    return named_catalogs(data)


def listed_names(names: Sequence[str]) -> list[str]:
    """Names of catalogues with ``all`` as those that ship."""
    return list(dict.fromkeys(catalogue for name in names for catalogue in (shipped() if name == ALL else [name])))


def shelf(memory: EngineMemory, names: Sequence[str]) -> dict[str, Catalog]:
    """Catalogues by name, each by itself; a file is read as it is now."""
    if not memory.shelf and set(names) & set(shipped()):  # all at once: a list mostly names many
        memory.shelf = {name: load([name]) for name in shipped()}
    others = {name: load([name], beside=Path(memory.name).parent) for name in names if name not in memory.shelf}
    return {name: memory.shelf.get(name) or others[name] for name in names}


def part_row(memory: EngineMemory, name: str, section: str, part: str) -> PartRow:
    """A part by its catalogue, section and number."""
    catalog = shelf(memory, [name])[name]
    rows = catalog.table(section).rows if section in PARTS else {}
    if part not in rows or part == DIRECT:
        raise InputError(f"{quoted(part)} is no longer in {quoted(name)}; list the parts again")
    return PartRow(name, catalog, section, rows[part])


# -- lists of parts


def parts(memory: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``parts`` with at most ``PAGE`` rows, or ``unmet`` with the conditions that cannot be read."""
    section = str(request["section"])
    conditions: list[Condition] = []
    faults = []
    options = [(name, name, text) for name, text in request["options"].items() if text.strip()]
    for field, name, text in [
        *options,
        *((f"where.{n}", "where", condition) for n, condition in enumerate(request["where"])),
    ]:
        try:
            conditions += [where(section, text)] if name == "where" else option(section, name, text) or []
        except InputError as error:
            faults.append({"field": field, "text": str(error).removeprefix(f"--{name}: ")})
    if faults:
        yield {"kind": "unmet", "faults": faults}
        return
    piece = request["piece"], ("part", "family", "manufacturer", OPTIONS["kind"][section])
    selection = select(shelf(memory, listed_names(request["catalogues"])), section, conditions, sort=request["sort"],
                   excluded=request["excluded"], piece=piece)  # fmt: skip
    start = request["start"] if request["start"] < len(selection.hits) else 0
    hits, (note, _) = selection.hits[start : start + PAGE], first_columns(section)
    table = listed(section, hits, [condition.column.name for condition in conditions], makers=True)
    rows = [{"catalogue": hit.catalogue, "part": hit.part, "excluded": bool(hit.table.excluded[hit.row])}
            for hit in hits]  # fmt: skip
    yield {"kind": "parts", "section": section, "found": len(selection.hits), "start": start,
           "undecided": selection.undecided, "excluded": selection.excluded, "sort": request["sort"], "rows": rows,
           "columns": [column.key for column in table.columns], "note": note,
           "html": html([replace(table, name=section, look="listed")])}  # fmt: skip


# -- A file of the user: a catalogue, a table that becomes one, or a log.


_LOGS = {".csv", ".tsv", ".txt", ".xlsx", ".json", ".log", ".wpilog"}


def check(memory: EngineMemory, request: Piece) -> Iterator[Piece]:
    """The findings of ``drivesizer catalog check`` on one catalogue; a table becomes one as by ``catalog import``.

    A log has a piece ``fit`` in place of that: the figures of its drive.
    """
    name, content, table_piece, no_log = Path(request["name"]), request["content"], dict[str, Any](), tuple[str, ...]()
    if name.suffix in _LOGS:
        try:
            yield fit(name, content)
            return
        except InputError as error:
            no_log = error.lines
    if name.suffix not in (".yaml", ".yml"):
        known = [catalogue for catalogue in listed_names(named_by(memory, request["text"])) if catalogue in shipped()]
        table, name, details = name, name.with_suffix(".yaml"), dict(request.get("given") or {})
        common = {"kind": details["kind"]} if details.get("kind") else {}
        plan = Plan(manufacturer=details.get("manufacturer", ""), family=details.get("family", ""), common=common)
        try:
            read = import_table(tables_of(content, table), table, plan, name, shelf(memory, known))
        except InputError as error:
            raise InputError(str(error), [*error.lines, *(f"as a log: {line}" for line in no_log)]) from None
        content = read.text.encode()
        columns = [f"{head.theirs}: {head.column}, first {first}" for head, first in
                   zip(read.heads, read.examples, strict=True) if head.column not in ("", head.theirs)]  # fmt: skip
        read_as = [f"read as {singular(read.section)}: {'; '.join(columns)}"] if columns else []
        lacks = still_needed(read.catalog, read.section)
        of = read.catalog.table(read.section)
        origin = {"manufacturer": str(of["manufacturer"][-1]), "family": str(of["family"][-1])}
        table_piece = {"text": read.text, "read": [*read_as, *import_words(read), *lacks],
                "given": origin | ({"kind": details.get("kind", "")} if read.section == "motors" else {})}  # fmt: skip
    catalog = catalog_of_text(name, content)
    memory.go_on()
    catalog_findings = findings(catalog)
    lines = [finding.text() for finding in catalog_findings if finding.unexplained]
    yield {"kind": "contradictory" if lines else "right", "name": str(name), "parts": counts(catalog),
           "lines": lines[:_LINES], "more": max(len(lines) - _LINES, 0), **table_piece}  # fmt: skip


def fit(path: Path, content: bytes) -> Piece:
    """The figures of a drive by its log as ``drivesizer identify`` prints them, and its model beside the log."""
    from drivesizer.identification.identify import identify
    from drivesizer.output.document.bench import bench_document
    from drivesizer.output.report.html.plots import movable

    document = bench_document(identify(path, content=content))
    figures = {name: movable(picture.page[0]) for name, picture in document.pictures.items()}
    return {"kind": "fit", "name": path.name, "html": html(document.sections[0].blocks, figures), "figures": figures}


# -- One part on the page as ``drivesizer catalog show`` prints it, with its curves, and several side by side.


def part(memory: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``part``: its sheet and what it does as HTML, curves, and the documents behind its figures."""
    from drivesizer.output.report.figures.parts import part_plots
    from drivesizer.output.report.html.plots import movable

    hit = part_row(memory, request["catalogue"], request["section"], request["part"])
    place, families = PLACES.get(hit.section, ((), False))  # where a spec names it, its family too, an axis its own
    figures = {f"part-{name}": movable(plot) for name, plot in part_plots(hit).items()}
    known = {source.document: source for source in origins(hit).values()}
    partners = [words + ", ".join(f"{name or 'no family'} ({n})" for name, n in families.items())
                for words, families in sheets.partner_lines(hit)]  # fmt: skip
    remarks = [*(Words(line, "note") for line in partners), *sheets.own_remarks(hit)]
    yield {
        "kind": "part", "catalogue": hit.catalogue, "section": hit.section, "part": hit.part, "family": hit["family"],
        "head": sheets.head(hit), "role": singular(hit.section), "figures": figures,
        "use": {"family": families and hit["family"], "axes": place[0] not in _WHOLE} if place else None,
        "sheet": html([replace(sheets.figures_of(hit, sources=True), halves=False), *remarks]),
        "does": html(sheets.behaviour(hit), figures),
        "documents": [[source.document, source.date, source.url] for source in known.values()],
    }  # fmt: skip


def html(blocks: Iterable[Any], figures: Piece | None = None) -> str:
    """Blocks of a document as a part of the page."""
    from drivesizer.output.report.html.templates import section_html

    return "".join(section_html([{"blocks": [as_data(block) for block in blocks]}], figures or {}, {}))


def beside(memory: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``beside``: parts of one kind side by side as of ``drivesizer catalog compare``, as HTML."""
    hits = [part_row(memory, name, request["section"], number) for name, number in request["parts"]]
    yield {"kind": "beside", "html": html(sheets.comparison(hits, side_by_side(hits), len(hits)))}


# -- Choices in the catalogues as edits of the spec: a part, a family, the catalogues themselves.


_Edit = list[Any]  # path, value, whether it is a text

# Section of the catalogue: where a spec names a part of it, and whether it may name a family there. What is of the
# whole machine has the same place where there are several axes.
PLACES: dict[str, tuple[tuple[str, ...], bool]] = {
    "motors": (("select", "motor"), True), "actuators": (("select", "motor"), True),
    "steppers": (("select", "motor"), True), "gearheads": (("select", "gearhead"), True),
    "encoders": (("select", "encoder"), True), "controllers": (("select", "controller"), True),
    "brakes": (("select", "brake"), True), "screws": (("load", "screw"), True), "batteries": (("battery",), False),
    "power_supplies": (("supply",), False), "brake_resistors": (("brake_resistor",), True),
}  # fmt: skip
_WHOLE = ("battery", "supply", "brake_resistor")


def choose(memory: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``edits``, by which a spec chooses what the page names."""
    data = YamlSource(str(request["text"]), memory.name).data
    above = ("axes", request["axis"]) if request["axis"] else ()
    place, names = next(  # whose catalogues count, of an axis or of the whole
        ((place, catalogs) for place in dict.fromkeys((above, ()))
         if (catalogs := _value_at(data, (*place, "select", "catalogs"))) is not None), ((), _DEFAULT),
    )  # fmt: skip
    names = [str(name) for name in (names if isinstance(names, list) else [names])]
    edits: list[_Edit] = []
    if request["part"] is None:
        selection = list(dict.fromkeys([*(names if request["add"] else ()), *request["catalogues"]]))
        if set(listed_names(selection)) >= set(shipped()):
            selection = [ALL, *(name for name in selection if name != ALL and name not in shipped())]
        edits.append([[*place, "select", "catalogs"], selection, True])
    else:
        hit = part_row(memory, *request["part"])
        edits += _part_edits(data, above, hit, "family" if request["family"] else "part")
        if hit.catalogue not in listed_names(names):
            edits.append([[*place, "select", "catalogs"], [*names, hit.catalogue], True])
    yield {"kind": "edits", "edits": edits}


def _part_edits(data: Any, above: tuple[str, ...], hit: PartRow, by: str) -> Iterator[_Edit]:
    """Edits that name a part or its family, and nothing else of its kind."""
    place, families = PLACES.get(hit.section, ((), False))
    if not place or (by == "family" and not families):
        raise InputError(f"a spec names no {by} of {hit.section.replace('_', ' ')}")
    if place[0] == "load" and not str((_value_at(data, (*above, "load")) or {}).get("kind", "")).endswith("_screw"):
        raise InputError("the load of the spec is no screw; expected load: {kind: ball_screw}")
    path = place if place[0] in _WHOLE else (*above, *place)
    known = _value_at(data, path)
    yield [[*path, by], hit[by], True] if isinstance(known, dict) else [path, {by: hit[by]}, True]
    known = known if isinstance(known, dict) else {}
    other = "part" if by == "family" else "family"
    if other in known:
        yield [[*path, other], None, False]
    if place == ("select", "motor"):  # steppers are searched where they are named as the kind, and only then
        kind = "stepper" if hit.section == "steppers" else hit["kind"]
        if kind == "stepper" or known.get("kind") not in (None, kind):
            yield [[*path, "kind"], kind if kind == "stepper" else None, kind == "stepper"]
    if place[0] == "load" and _value_at(data, (*above, "load", "lead")) is not None:  # it comes with the screw
        yield [[*above, "load", "lead"], None, False]


def _value_at(data: Any, path: tuple[str, ...]) -> Any:
    for step in path:
        data = data.get(step) if isinstance(data, dict) else None
    return data
