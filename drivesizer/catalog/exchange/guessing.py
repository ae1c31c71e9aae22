"""Columns of another program's table, guessed by their headers and units, and the map that says so.

A guess is by words that data sheets use, and only where the unit fits the kind of the column: it is shown and written
as a map, for a person to look at.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping, Sequence

from drivesizer.catalog.columns import Column
from drivesizer.catalog.exchange.currencies import currency_of
from drivesizer.catalog.parts import columns_of
from drivesizer.errors import InputError
from drivesizer.units import scale

__all__ = ["guessed", "map_text"]

_NEAR = 0.82  # likeness of a header to a name, from which on it counts
_WORDS = {  # names of columns, and the words of data sheets and shops for them
    "part": "order number; order no; part number; part no; article number; article no; item; model; sku; type",
    "family": "series; product family; product line; range",
    "manufacturer": "maker; brand; vendor; supplier",
    "mass": "weight",
    "price": "unit price; net price; cost; price 1",
    "length": "motor length; overall length; total length; l1",
    "diameter": "outer diameter; motor diameter; size",
    "assigned_power": "rated power; nominal power; assigned power rating; output power; power",
    "nominal_voltage": "rated voltage; supply voltage; voltage",
    "nominal_speed": "rated speed",
    "nominal_torque": "rated torque; continuous torque; max continuous torque; nominal torque max continuous torque",
    "nominal_current": "rated current; continuous current; max continuous current; "
                       "nominal current max continuous current",
    "peak_torque": "max torque; maximum torque; peak torque",
    "no_load_speed": "idle speed; free speed; speed no load",
    "no_load_current": "idle current; free current; current no load",
    "stall_torque": "starting torque; locked rotor torque",
    "stall_current": "starting current; locked rotor current",
    "max_efficiency": "max efficiency; efficiency max; peak efficiency",
    "resistance": "terminal resistance; resistance phase to phase; winding resistance; line to line resistance",
    "inductance": "terminal inductance; inductance phase to phase; winding inductance; line to line inductance",
    "torque_constant": "kt; km; torque constant kt",
    "speed_constant": "kv; kn; speed constant kv",
    "back_emf_constant": "ke; voltage constant; back emf constant ke",
    "rotor_inertia": "inertia; moment of inertia; rotor moment of inertia; rotor inertia j",
    "thermal_resistance_winding": "thermal resistance winding housing; rth1",
    "thermal_resistance_housing": "thermal resistance housing ambient; rth2",
    "max_speed": "max permissible speed; maximum speed; limit speed; max speed",
    "max_winding_temperature": "max permissible winding temperature; winding temperature max",
    "pole_pairs": "number of pole pairs",
    "reduction": "gear ratio; ratio; absolute reduction; transmission ratio",
    "efficiency": "max efficiency; efficiency",
    "continuous_torque": "max continuous torque; rated torque; nominal torque",
    "intermittent_torque": "max intermittent torque; acceleration torque; peak torque; emergency torque",
    "max_continuous_speed": "max continuous input speed; nominal input speed; rated input speed",
    "max_intermittent_speed": "max intermittent input speed; maximum input speed",
    "backlash": "backlash no load; average backlash no load; lost motion",
    "stages": "number of stages",
    "inertia": "mass inertia; moment of inertia",
    "lines": "counts per turn; pulses per revolution; cpt; ppr; resolution",
    "continuous_current": "output current; rated current; nominal current",
    "peak_current": "max output current; maximum current",
}  # fmt: skip


def guessed(header: Sequence[str], units: Sequence[str], section: str) -> dict[str, str]:
    """The column that each header of a table means, by its words and its unit."""
    columns = columns_of(section)
    own = {name for name in header if name in columns}
    found: list[tuple[float, int, str, str]] = []
    for place, theirs in enumerate(header):
        unit = units[place] if place < len(units) else ""
        for name, column in columns.items() if theirs not in own else ():
            near = _likeness(theirs, name)
            if near >= _NEAR and name not in own and _fits(unit, column):
                found.append((-near, place, theirs, name))
    chosen: dict[str, str] = {}
    for _, _, theirs, name in sorted(found):
        if theirs not in chosen and name not in chosen.values():
            chosen[theirs] = name
    return {theirs: chosen[theirs] for theirs in header if theirs in chosen}


def _likeness(theirs: str, name: str) -> float:
    """Likeness of a header to a column's name or to one of its words, 0 to 1."""
    given = _plain(theirs)
    words = [name.replace("_", " "), *_WORDS.get(name, "").split("; ")]
    return max((difflib.SequenceMatcher(None, given, word).ratio() for word in words if word), default=0.0)


def _plain(text: str) -> str:
    """A header in small letters, without marks and without what is in brackets.

    >>> _plain("Max. continuous torque [mNm]"), _plain("Order no.")
    ('max continuous torque', 'order no')
    """
    bare = re.sub(r"[\[(][^\])]*[\])]", "", text.lower())
    return " ".join(re.sub(r"[^a-z0-9]+", " ", bare).split())


def _fits(unit: str, column: Column) -> bool:
    """Whether a unit is one of a column's kind; a text has none."""
    if column.name == "price" and currency_of(unit):
        return True
    if column.kind in ("text", "ratio"):
        return unit in ("", "1")
    try:
        scale(unit or "1", column.kind)
    except InputError:
        return False
    return True


def map_text(columns: Mapping[str, str], header: Sequence[str], stated: Mapping[str, str | None]) -> str:
    """The map of a guess as YAML: what is left out stands there too, to be completed."""
    import json

    def quoted(text: str) -> str:
        return json.dumps(text, ensure_ascii=False)

    lines = [f"{key}: {quoted(stated[key] or '')}" for key in ("manufacturer", "family") if stated.get(key)]
    source = {key: stated[key] for key in ("name", "document", "confidence", "date", "url") if stated.get(key)}
    if source:
        lines.append(f"source: {{{', '.join(f'{key}: {quoted(str(value))}' for key, value in source.items())}}}")
    lines.append("columns:  # guessed by name and unit: look at each; ~ is not imported")
    lines += [f"  {quoted(theirs)}: {columns.get(theirs, '~')}" for theirs in header if theirs]
    return "\n".join(lines) + "\n"
