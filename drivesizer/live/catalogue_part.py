"""One part on the page with its curves, several side by side, and the choice of a part as an edit of the spec."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from drivesizer.errors import InputError
from drivesizer.live.catalogue import ALL, hit_of, listed_names
from drivesizer.live.held import EngineMemory, Piece

if TYPE_CHECKING:
    from drivesizer.catalog.query import Hit
    from drivesizer.output.part import PartTable

__all__: list[str] = []


# -- One part on the page as ``drivesizer catalog show`` prints it, with its curves, and several side by side.


def part(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``part``: figures with confidence and document of each, tables, remarks and curves."""
    from drivesizer.catalog import singular
    from drivesizer.output.part import head
    from drivesizer.output.report.html.curves import part_plots

    hit = hit_of(held, request["catalogue"], request["section"], request["part"])
    yield {
        "kind": "part", "catalogue": hit.catalogue, "section": hit.section, "part": hit.part, "family": hit["family"],
        "head": head(hit), "role": singular(hit.section), "tables": [_plain(table) for table in _tables(hit)],
        "figures": part_plots(hit), **_sheet(hit),
    }  # fmt: skip


def _sheet(hit: Hit) -> Piece:
    """Figures, the documents behind them, and what else is said of a part."""
    from drivesizer.catalog.query import origins
    from drivesizer.output import part as remarks
    from drivesizer.output.part import datasheet

    sheet = datasheet(hit.section, hit.table.record(hit.row), hit.catalog)
    origin = {name.replace("_", " "): source for name, source in origins(hit).items()}
    documents = list({source.document: source for source in origin.values()}.values())
    named = [source.document for source in documents]
    rows = [[row["name"], row["text"], origin[row["name"]].confidence, named.index(origin[row["name"]].document) + 1]
            for row in sheet["rows"]]  # fmt: skip
    partners = [words + ", ".join(f"{name or 'no family'} ({n})" for name, n in families.items())
                for words, families in remarks.partner_lines(hit)]  # fmt: skip
    excluded = [remarks.EXCLUDED] if hit.table.excluded[hit.row] else []
    return {
        "rows": rows,
        "documents": [[source.document, source.date, source.url] for source in documents],
        "remarks": [*excluded, *partners, *(f"tolerances: {line}" for line in remarks.tolerance_lines(hit)),
                    *(f"note: {remarks.note_line(note)}" for note in sheet["notes"])],
    }  # fmt: skip


def _tables(hit: Hit) -> Iterator[PartTable]:
    """Tables in the order of ``catalog show``."""
    from drivesizer.output import part as tables
    from drivesizer.output.part import heat

    if hit.section in ("motors", "actuators"):
        warmth = heat(hit)
        yield tables.torque_and_speed(hit)
        yield from warmth.tables
        said = "; ".join((*warmth.notes, *([warmth.missing] if warmth.missing else [])))
        if said:
            yield tables.PartTable((), (), closing=said)
    if hit.section == "batteries":
        yield from tables.discharges(hit)
    if hit.section == "steppers":
        yield from tables.pull_outs(hit)
    yield from (table for table in (tables.estimates(hit), tables.limits_of_family(hit)) if table)


def _plain(table: PartTable) -> Piece:
    return {"title": table.title, "heads": [list(head) for head in table.heads], "closing": table.closing,
            "rows": [list(row) for row in table.rows]}  # fmt: skip


def beside(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``beside``: parts of one kind side by side as of ``drivesizer catalog compare``."""
    from drivesizer.catalog.query import side_by_side
    from drivesizer.output.part import DIFFERS, closing
    from drivesizer.output.words import figure

    hits = [hit_of(held, name, request["section"], number) for name, number in request["parts"]]
    rows = side_by_side(hits)
    cells: list[Any] = [
        [row.column.name.replace("_", " "), DIFFERS[row.differs], [figure(value, row.column) for value in row.values]]
        for row in rows
    ]
    yield {"kind": "beside", "heads": [[hit.part, hit.catalogue] for hit in hits], "rows": cells,
           "closing": closing(rows)}  # fmt: skip


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


def choose(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``edits``, by which a spec chooses what the page names."""
    from drivesizer.files.yaml_source import YamlSource

    data = YamlSource(str(request["text"]), held.name).data
    above = ("axes", request["axis"]) if request["axis"] else ()
    if request["part"] is None:
        names = [*(_catalogs(data, above)[1] if request["add"] else ()), *request["catalogues"]]
        edits = _catalog_edits(data, above, _short(names))
    else:
        hit = hit_of(held, *request["part"])
        edits = _part_edits(data, above, hit, "family" if request["family"] else "part")
    yield {"kind": "edits", "edits": edits}


def _part_edits(data: Any, above: tuple[str, ...], hit: Any, by: str) -> list[_Edit]:
    """Edits that name a part or its family, and nothing else of its kind; and its catalogue."""
    place, families = PLACES.get(hit.section, ((), False))
    if not place or (by == "family" and not families):
        raise InputError(f"a spec names no {by} of {hit.section.replace('_', ' ')}")
    if place[0] == "load" and not str((_value_at(data, (*above, "load")) or {}).get("kind", "")).endswith("_screw"):
        raise InputError("the load of the spec is no screw; expected load: {kind: ball_screw}")
    path = place if place[0] in _WHOLE else (*above, *place)
    known = _value_at(data, path)
    if not isinstance(known, dict):
        edits: list[_Edit] = [[path, {by: hit[by]}, True]]
        known = {}
    else:
        edits = [[[*path, by], hit[by], True]]
    other = "part" if by == "family" else "family"
    edits += [[[*path, other], None, False]] if other in known else []
    if place == ("select", "motor"):
        edits += _kind(path, known, hit)
    if place[0] == "load":  # its own lead, where it comes with the screw
        edits += (
            [[[*above, "load", "lead"], None, False]] if _value_at(data, (*above, "load", "lead")) is not None else []
        )
    names = _catalogs(data, above)[1]
    if hit.catalogue in listed_names(names):
        return edits
    return [*edits, *_catalog_edits(data, above, [*names, hit.catalogue])]


def _kind(path: tuple[str, ...], known: dict[str, Any], hit: Any) -> list[_Edit]:
    """Steppers are searched where they are named as the kind, and only then."""
    kind = "stepper" if hit.section == "steppers" else hit["kind"]
    if kind == "stepper":
        return [[[*path, "kind"], kind, True]]
    return [[[*path, "kind"], None, False]] if known.get("kind") not in (None, kind) else []


def _catalog_edits(data: Any, above: tuple[str, ...], names: list[str]) -> list[_Edit]:
    return [[[*_catalogs(data, above)[0], "select", "catalogs"], names, True]]


def _catalogs(data: Any, above: tuple[str, ...]) -> tuple[tuple[str, ...], list[str]]:
    """The place whose catalogues count, of an axis or of the whole, and their names."""
    from drivesizer.spec.drive import Select

    for place in dict.fromkeys((above, ())):
        given = _value_at(data, (*place, "select", "catalogs"))
        if given is not None:
            return place, [str(name) for name in (given if isinstance(given, list) else [given])]
    return (), list(Select.model_fields["catalogs"].default)


def _short(names: list[str]) -> list[str]:
    """Names of catalogues, ``all`` in place of all that ship."""
    from drivesizer.catalog import shipped

    every = set(listed_names(names)) >= set(shipped())
    others = [name for name in dict.fromkeys(names) if name != ALL and name not in shipped()]
    return [ALL, *others] if every else list(dict.fromkeys(names))


def _value_at(data: Any, path: tuple[str, ...]) -> Any:
    for step in path:
        data = data.get(step) if isinstance(data, dict) else None
    return data
