"""A catalogue file of the motor that was identified: the data sheet's row with what was measured in its place."""

from __future__ import annotations

from typing import Any

from drivesizer.catalog.catalog_file import parse
from drivesizer.catalog.exporting import digits, file_text
from drivesizer.catalog.parts import NAMES, Column, printed
from drivesizer.catalog.query import Hit, is_known, partners
from drivesizer.errors import InputError, quoted
from drivesizer.files.yaml_source import YamlSource
from drivesizer.identification import declared
from drivesizer.identification.heat import BOUND
from drivesizer.results.identification import Identification
from drivesizer.units import from_si

_DROPPED = {  # of the data sheet: names, and what would contradict
    *NAMES, "speed_constant", "no_load_speed", "no_load_current", "stall_torque", "stall_current",
    "speed_torque_gradient", "mechanical_time_constant", "max_efficiency",
}  # fmt: skip
_NEEDED = ("R", "k_t", "rotor_inertia")


def part_file(found: Identification, hit: Hit | None, name: str) -> bytes:
    """The text of a catalogue with the identified motor."""
    if hit is not None and hit.section != "motors":
        raise InputError(
            f"{quoted(hit.part)} is an actuator: its figures are printed at the output; expected a motor to write a row"
        )
    figures = {one.name: one.value for one in found.figures if one.basis != BOUND}
    if "rotor_inertia" not in figures and "load_inertia" not in figures and "J" in figures:
        figures["rotor_inertia"] = figures["J"]
    lacks = [n for n in _NEEDED if not figures.get(n, 0.0) > 0.0]
    if lacks and hit is None:
        raise InputError(
            f"{found.log}: {', '.join(lacks)} cannot be had from this log alone; expected --motor for the rest of a row"
        )
    measured = {column: figures[name] for name, column in declared("columns") if name in figures}
    columns = printed("motors")
    stem = name.rsplit(".", 1)[0]
    row: dict[str, str] = {"part": f"{hit.part} measured" if hit else stem, "kind": "brushed"}
    if hit is not None:
        for column in columns.values():
            value = hit[column.name]
            if is_known(value) and column.name not in _DROPPED:
                row[column.name] = str(value) if column.kind == "text" else digits(value, column)
    for column_name, value in measured.items():
        row[column_name] = _rounded(value, columns[column_name])
    return _text(found, hit, row, sorted(measured), name).encode()


def _rounded(value: float, column: Column) -> str:
    return f"{float(f'{float(from_si(value, column.unit, column.kind)):.5g}'):g}"


def _text(found: Identification, hit: Hit | None, row: dict[str, str], measured: list[str], name: str) -> str:
    columns, source = printed("motors"), quoted(f"identified from {found.log}")
    family = quoted(f"{hit['family'] or hit.part} measured" if hit else row["part"])
    sources = {"log": {"document": source, "confidence": "measured"}}
    table: dict[str, Any] = {
        "family": family, "source": "log", "columns": [columns[n].head for n in row],
        "rows": [[quoted(x) if columns[n].kind == "text" else x for n, x in row.items()]],
    }  # fmt: skip
    pairs = [{"name": "direct drive", "source": "log", "motors": f"[{family}]", "gearheads": "[direct]"}]
    if hit is not None:
        sheet = hit.catalog.sources[hit.table.source[hit.row]]
        sources["sheet"] = {"document": quoted(sheet.document, 200), "confidence": sheet.confidence}
        fields = f"[{', '.join(measured)}]"
        table |= {"source": "sheet",
                  "notes": [{"fields": fields, "text": source, "source": "log", "confidence": "measured"}]}  # fmt: skip
        if listed := [f"{{{quoted(hit.catalogue)}: {quoted(one)}}}" for one in partners(hit).get("gearheads", {})]:
            across = f"[{', '.join(listed)}]"
            pairs.append(pairs[0] | {"name": "as the data sheet's", "source": "sheet", "gearheads": across})
    maker = quoted(hit["manufacturer"] or "measured") if hit else "measured"
    text = file_text("motors", maker, sources, [table], {"motor_gearhead": pairs})
    parse(YamlSource(text, name), name, "")
    return text
