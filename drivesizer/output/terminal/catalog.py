"""Catalogues at the terminal: overview, lists of parts, comparison, search."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Mapping, Sequence
from math import isnan
from typing import Any

from rich.markup import escape
from rich.table import Table
from rich.text import Text

from drivesizer.catalog import Catalog, columns_of
from drivesizer.catalog.columns import Column
from drivesizer.catalog.compare import Row
from drivesizer.catalog.lookup import families
from drivesizer.catalog.query import OPTIONS, Hit, Selection
from drivesizer.output.terminal.tables import bare, console, heading, width_of
from drivesizer.units import label, show

__all__ = ["comparison", "counted", "figure", "listing", "of_families", "overview", "searched"]

_SHOWN: dict[str, tuple[tuple[str, str], ...]] = {  # head, column
    "motors": (
        ("power", "assigned_power"), ("voltage", "nominal_voltage"), ("torque", "nominal_torque"),
        ("speed", "no_load_speed"), ("mass", "mass"), ("price", "price"),
    ),
    "gearheads": (
        ("ratio", "reduction"), ("torque", "continuous_torque"), ("input", "continuous_input_speed"),
        ("eff.", "efficiency"), ("mass", "mass"), ("price", "price"),
    ),
    "encoders": (
        ("counts", "counts_per_turn"), ("ch.", "channels"), ("frequency", "max_frequency"), ("speed", "max_speed"),
        ("mass", "mass"), ("price", "price"),
    ),
    "controllers": (
        ("drives", "drives"), ("from", "supply_min"), ("to", "supply_max"), ("cont.", "continuous_current"),
        ("peak", "peak_current"), ("price", "price"),
    ),
    "actuators": (
        ("ratio", "reduction"), ("voltage", "nominal_voltage"), ("torque", "nominal_torque"), ("peak", "peak_torque"),
        ("speed", "no_load_speed"), ("mass", "mass"), ("price", "price"),
    ),
    "brakes": (
        ("torque", "static_torque"), ("supply", "supply"), ("power", "power"), ("inertia", "inertia"),
        ("stop", "energy_per_stop"), ("mass", "mass"),
    ),
    "steppers": (
        ("wiring", "wiring"), ("steps", "full_steps"), ("current", "phase_current"), ("torque", "holding_torque"),
        ("resistance", "resistance"), ("inductance", "inductance"), ("mass", "mass"),
    ),
    "belts": (("profile", "profile"), ("pitch", "pitch"), ("teeth", "teeth"), ("width", "width")),
    "pulleys": (("profile", "profile"), ("pitch", "pitch"), ("teeth", "teeth"), ("width", "width"), ("bore", "bore")),
    "screws": (
        ("diameter", "diameter"), ("lead", "lead"), ("core", "root_diameter"), ("C", "dynamic_load"),
        ("C0", "static_load"), ("eff.", "efficiency"), ("dn", "dn_max"),
    ),
    "batteries": (
        ("chemistry", "chemistry"), ("voltage", "nominal_voltage"), ("capacity", "capacity"),
        ("cont.", "continuous_current"), ("resistance", "resistance"), ("mass", "mass"),
    ),
    "power_supplies": (
        ("kind", "kind"), ("voltage", "nominal_voltage"), ("cont.", "continuous_current"), ("peak", "peak_current"),
        ("for", "peak_time"), ("trips", "overvoltage_min"),
    ),
    "brake_resistors": (
        ("kind", "kind"), ("resistance", "resistance"), ("power", "power"), ("peak", "peak_power"),
        ("on from", "chopper_voltage_min"), ("current", "chopper_current"),
    ),
}  # fmt: skip
_NOTES = {
    "motors": "torque nominal, speed without load",
    "gearheads": "torque and input speed continuous",
    "encoders": "",
    "controllers": "supply from and to; current continuous and peak",
    "actuators": "at the output: torque continuous and peak, speed without load",
    "brakes": "torque static; energy of one stop",
    "steppers": "current, resistance and inductance of a phase; torque at standstill",
    "belts": "",
    "pulleys": "width of the widest belt",
    "screws": "ratings dynamic and static; dn in mm rpm",
    "batteries": "",
    "power_supplies": "current continuous and peak; over-voltage protection from",
    "brake_resistors": "power continuous and peak; current of the chopper",
}
_BESIDE = 4  # parts side by side on 80 columns


def figure(value: Any, column: Column, *, unit: bool = True) -> str:
    """A figure as a data sheet prints it; "unknown" where it is.

    Parameters
    ----------
    value
        Text, or a number in SI.
    column
        Its column: kind and unit.
    unit
        Whether the unit is printed.

    Returns
    -------
    str
        The text of a cell.
    """
    if isinstance(value, str):
        return value or "unknown"
    if column.kind.startswith("price") and not isnan(value):
        text = f"{value:.2f} {column.unit}"  # to the cent, as money is
    else:
        text = show(value, column.unit, column.kind, 5)
    return text if unit else text.removesuffix(label(column.unit)).strip()


_FEW = 5  # catalogues of which the families are named, else their makers


def overview(shelf: Mapping[str, Catalog]) -> None:
    """Print the families of each section; of many catalogues the makers."""
    out = console()
    for section, names in families(shelf).items():
        hits = [hit for some in names.values() for hit in some]
        if not hits:
            continue
        heading(out, section, f"{len(hits)} parts in {of_families(len(names))}")
        if len(shelf) > _FEW:
            counts: Mapping[str, int] = dict(Counter(hit["manufacturer"] for hit in hits).most_common())
        else:
            counts = {name: len(some) for name, some in sorted(names.items())}
        out.print(counted(counts, out.width))
        out.print()
    if len(shelf) > _FEW:
        out.print(Text("drivesizer catalog list --catalog maxon shows the families of one catalogue."))
    out.print(Text("drivesizer catalog list motors --family 'RE 25' lists a family, '--power >=20W' more than one."))


def of_families(count: int) -> str:
    """A number of families.

    >>> of_families(1), of_families(2)
    ('1 family', '2 families')
    """
    return f"{count} family" if count == 1 else f"{count} families"


def counted(counts: Mapping[str, int], width: int, head: str = "") -> Text:
    """Names with their counts as wrapped text; no line breaks inside a name.

    Parameters
    ----------
    counts
        Count by name.
    width
        Longest line [characters].
    head
        Text before the first name.

    Returns
    -------
    Text
        Lines of at most the width.
    """
    glue = "\u00a0"  # no line ends here
    items = [
        f"{name or 'no family'} ({count})".replace(" ", glue).replace("-", "\u2011") for name, count in counts.items()
    ]
    text = textwrap.fill(f"{head}{', '.join(items)}", width, break_long_words=False)
    return Text(text.replace(glue, " ").replace("\u2011", "-"))


def listing(section: str, found: Selection, limit: int, extra: Sequence[str]) -> None:
    """Print the parts of a selection, a line each.

    Parameters
    ----------
    section
        Kind of part, as "motors".
    found
        The parts.
    limit
        Largest number of lines.
    extra
        Further columns; the usual ones make room for them.
    """
    out, schema = console(), columns_of(section)
    usual = [(head, schema[name]) for head, name in _SHOWN[section]]
    there = {column.name for _, column in usual} | {"part", "family", "manufacturer"}
    requested = [(name.replace("_", "\n"), schema[name]) for name in dict.fromkeys(extra) if name not in there]
    hits = found.hits[:limit]
    while len(usual) > 1 and width_of(_table(hits, usual + requested)) > out.width:
        usual.pop()  # requested columns go before the last of the usual ones
    if hits:
        out.print(_table(hits, usual + requested))
    for line in _footer(section, found, limit):
        out.print(Text(line))


def _table(hits: Sequence[Hit], shown: Sequence[tuple[str, Column]]) -> Table:
    heads = [(f"{head}\n{label(c.unit)}".rstrip(), "left" if c.kind == "text" else "right") for head, c in shown]
    table = bare(("part", "left"), ("family", "left"), *heads)
    table.padding = (0, 1, 0, 0)
    for hit in hits:
        mark = Text(" ×" if hit.table.excluded[hit.row] else "", style="red")
        table.add_row(Text(hit.part) + mark, Text(hit["family"]), *(_short(hit[c.name], c) for _, c in shown))
    return table


def _short(value: Any, column: Column) -> Text:
    text = figure(value, column, unit=False)
    return Text("–", style="dim") if text == "unknown" else Text(text)


def _footer(section: str, found: Selection, limit: int) -> list[str]:
    count = len(found.hits)
    more = f"the first {limit} of {count} {section}; --limit shows more" if count > limit else f"{count} {section}"
    said = [f"{more}{f'; {_NOTES[section]}' if count and _NOTES[section] else ''}"]
    if found.undecided:
        said.append(f"{found.undecided} more may fit: a required figure is unknown")
    if found.excluded:
        said.append(f"{found.excluded} more are excluded from sizing by a note; --excluded lists them (×)")
    return said


def comparison(hits: Sequence[Hit], rows: Sequence[Row]) -> None:
    """Print parts side by side; a row in which they differ is marked, ? where some are unknown.

    Parameters
    ----------
    hits
        The parts.
    rows
        Their figures, compared.
    """
    out = console()
    for start in range(0, len(hits), _BESIDE):
        some = slice(start, start + _BESIDE)
        table = bare(("", "left"), ("", "left"), *((escape(f"{h.part}\n{h.catalogue}"), "right") for h in hits[some]))
        for row in rows:
            mark = "?" if row.differs is None else "≠" if row.differs else ""
            cells = (figure(value, row.column) for value in row.values[some])
            style = "bold" if row.differs else ""
            table.add_row(mark, Text(row.column.name.replace("_", " "), style=style), *map(Text, cells))
        out.print(table)
    differing = sum(row.differs is True for row in rows)
    out.print(Text(f"≠ differs ({differing} of {len(rows)} rows), ? undecided: a figure is unknown"))


def searched(groups: Mapping[str, Mapping[str, Sequence[Hit]]], parts: Sequence[Hit], limit: int) -> None:
    """Print the families and parts in which a text was found.

    Parameters
    ----------
    groups
        Parts by section and family.
    parts
        Single parts.
    limit
        Largest number of single parts.
    """
    out = console()
    if any(groups.values()):
        table = bare(("", "left"), ("family", "left"), ("parts", "right"), ("kind", "left"), ("catalogue", "left"))
        for section, names in groups.items():
            for name, hits in sorted(names.items()):
                table.add_row(section, *map(Text, (name, str(len(hits)), _kinds(hits), _catalogues(hits))))
        out.print(table)
    if parts:
        table = bare(("", "left"), ("part", "left"), ("family", "left"), ("catalogue", "left"))
        for hit in parts[:limit]:
            table.add_row(hit.section, *map(Text, (hit.part, hit["family"], hit.catalogue)))
        out.print(table)
    if len(parts) > limit:
        out.print(Text(f"the first {limit} of {len(parts)} parts; --limit shows more"))


def _kinds(hits: Sequence[Hit]) -> str:
    column = OPTIONS["kind"][hits[0].section]
    return ", ".join(kind for kind in Counter(hit[column] for hit in hits) if kind)


def _catalogues(hits: Sequence[Hit]) -> str:
    return ", ".join(dict.fromkeys(hit.catalogue for hit in hits))
