"""Parts typed where they are used, a shop's five figures by name: read as rows of a catalogue file, joined to others.

>>> fields = {"name": "775", "voltage": "12 V", "stall_current": "70 A"}
>>> text = typed_part(written({"motor": fields}), ("motor",), "motors")
>>> catalog_of_text(Path("typed.yaml"), text.encode()).motors.record(0).resistance  # follows from the two
0.1714285714285714
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drivesizer.catalog import catalog_of_text
from drivesizer.catalog.parts import DIRECT, PARTS, RELATIONS, singular
from drivesizer.catalog.tables import Catalog, joined, with_pairs
from drivesizer.errors import CatalogError, quoted
from drivesizer.files.yaml_source import Edit, Path_, YamlSource, edited, value_at, written

Named = Mapping[str, Mapping[str, Sequence[str]]]  # by section: names or patterns by column

NAME = "name"  # the key by which a part is typed, and not chosen
SHARED = ("confidence", "date", "document", "url")  # of its source
_NO_MAKER = "typed"  # in place of a maker that is not said
_GEARED = {"motors": "gearheads", "gearheads": "motors"}
_UNTRIED = "secondary"  # confidence of figures that nobody says more of


class Typed(NamedTuple):
    """Parts that a spec types: catalogue file of each, and where it stands."""

    section: str
    part: str
    text: str
    place: str  # such as select.motor


def typed_part(source: YamlSource, at: Path_, section: str) -> str:
    """A part of some fields of a file, as the text of a catalogue file."""
    from drivesizer.catalog.catalog_file import parse
    from drivesizer.catalog.importing import meant_by

    fields: Any = value_at(source.data, at)
    name = fields[NAME]
    if isinstance(name, bool) or not isinstance(name, str | int) or not str(name).strip():
        raise CatalogError(f'{source.where((*at, NAME))}: {quoted(name)} is no name of a part; expected e.g. "775"')
    figures, keys = dict[str, Any](), dict[str, str]()
    for key, value in fields.items():
        column = meant_by(section, key)
        if key in (NAME, "maker", "family", *SHARED):
            continue
        if column in figures:
            raise CatalogError(f"{source.where((*at, key))}: {column} is given twice, as {keys[column]} too")
        bare = column == "ratio" and isinstance(value, str) and value.replace(".", "", 1).isdecimal()
        figures[column], keys[column] = float(value) if bare else value, key
    from drivesizer.catalog.schema import SCHEMA  # where no part is typed it need not load

    origin = {key: fields[key] for key in SHARED if key in fields}
    data: dict[str, Any] = {
        "catalog": SCHEMA,
        "manufacturer": fields.get("maker", _NO_MAKER),
        "overrides": True,
        "sources": {"typed": {"document": f"{source.name}, {'.'.join(map(str, at))}", "confidence": _UNTRIED} | origin},
        section: [{"family": fields.get("family", str(name)), "source": "typed", "common": figures,
                   "columns": ["part"], "rows": [[str(name)]]}],
    }  # fmt: skip
    if section == "motors":
        alone = {"source": "typed", "motors": [str(name)], "gearheads": [DIRECT]}
        data["compatibility"] = {"motor_gearhead": [alone]}
    parse(_Fields(source, at, data, keys), "typed", "")
    return written(data).text


def with_part(text: str, name: str, part: str) -> str:
    """The text of a catalogue file with the part of :func:`typed_part` as its last, all else as it was written."""
    from drivesizer.catalog.catalog_file import parse

    data, more, edits = YamlSource(text, name).data, YamlSource(part, name).data, list[Edit]()
    data = data if isinstance(data, dict) else {}
    section = next(kind for kind in PARTS if kind in more)
    key = f"page of {more[section][0]['rows'][0][0]}"
    while key in (data.get("sources") or ()):
        key += ", again"
    edits.append(Edit(("sources", key), more["sources"]["typed"]))
    maker, own_maker = more["manufacturer"], data.get("manufacturer")
    if maker not in (_NO_MAKER, own_maker):
        raise CatalogError(f"{name}: is of {quoted(own_maker)}; parts of {quoted(maker)} need a file of their own (-o)")
    lists: dict[Path_, list[Any]] = {(section,): more[section]}
    pairs = more.get("compatibility", {}).get("motor_gearhead", [])
    if section in _GEARED and isinstance(known := data.get(_GEARED[section]), list):
        families = list(dict.fromkeys(group.get("family") for group in known if isinstance(group, dict)))
        first = more[section][0]["rows"][0]
        pairs = [*pairs, {"name": "assumed: one maker", section: first, _GEARED[section]: families}]
    lists |= {("compatibility", "motor_gearhead"): pairs} if pairs else {}
    for path, entries in lists.items():
        there: Any = data
        for step in path:
            there = there.get(step) if isinstance(there, dict) else None
        own = [entry | {"source": key} for entry in entries]
        edits += [Edit((*path, len(there) + at), entry) for at, entry in enumerate(own)] if there else [Edit(path, own)]
    document = edited(text, edits, name)
    parse(YamlSource(document, name), Path(name).stem, "")
    return document


class _Fields(YamlSource):
    """A catalogue file that was made of some fields: its messages have their lines and names."""

    def __init__(self, whole: YamlSource, at: Path_, data: dict[str, Any], keys: Mapping[str, str]) -> None:
        self.whole, self.at, self.keys = whole, at, keys
        self.text, self.name, self.numbered, self.data = whole.text, whole.name, whole.numbered, data

    def where(self, path: Path_) -> str:
        """Place of the field that a figure, or the source, was made of."""
        key = path[3] if path[2:3] == ("common",) and len(path) > 3 else path[-1]
        from drivesizer.catalog.schema import SOURCE

        own = {"family": "family", "manufacturer": "maker", **dict.fromkeys(SOURCE["properties"], key)}
        field = self.keys.get(str(key)) or own.get(str(key))
        return self.whole.where((*self.at, field) if field else self.at)


def with_typed(catalog: Catalog, typed: Sequence[Typed], named: Named) -> Catalog:
    """A catalogue with typed parts, which count before others of the same number, and what is assumed of them."""
    own, messages = dict[str, list[str]](), list[str]()
    for record in typed:
        part = catalog_of_text(Path(f"{record.place}.yaml"), record.text.encode())
        catalog = joined([catalog, part])
        own.setdefault(record.section, []).append(record.part)
        messages += _words(part, record)
    for relation, right in RELATIONS.items():
        others = {"part": own[right]} if right in own else named.get(right, {})
        if not others or not ({"motors", right} & own.keys()):
            continue
        motors = {"part": own["motors"]} if "motors" in own else named.get("motors", {})
        left = np.flatnonzero(catalog.motors.named(motors))
        fitting = np.flatnonzero(catalog.table(right).named(others))
        known, source = getattr(catalog, relation), np.full(len(left) * len(fitting), len(catalog.sources) - 1)
        pairs = with_pairs(known, np.repeat(left, len(fitting)), np.tile(fitting, len(left)), source)
        if len(pairs.left) > len(known.left):
            catalog = catalog.with_tables({}, {relation: pairs})
            which = [
                ", ".join(n for names in selection.values() for n in names) or "any" for selection in (others, motors)
            ]
            messages.append(f"{singular(right)} {which[0]} on motor {which[1]}: assumed to fit")
    return replace(catalog, replaced=(*catalog.replaced, *messages))


def _words(catalog: Catalog, record: Typed) -> Iterator[str]:
    """Confidence of a typed part's figures, what follows from them, and what in them is not consistent."""
    from drivesizer.catalog.laws import check

    table, row = catalog.table(record.section), catalog.table(record.section).rows[record.part]
    follows = [name.replace("_", " ") for note in catalog.notes for name in note.fields if note.derived]
    base = catalog.sources[table.source[row]].confidence
    derived = f"; {', '.join(follows)} {'follow' if len(follows) > 1 else 'follows'} from them" if follows else ""
    yield f"{singular(record.section)} {record.part} is typed in {record.place}: its figures are {base}{derived}"
    yield from (finding.text().partition(": ")[2] for finding in check(catalog) if finding.unexplained)
