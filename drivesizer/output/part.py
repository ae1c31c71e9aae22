"""One part of a catalogue as every output prints it: its data sheet, tables, curves and remarks, without a format."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isnan, nan
from typing import Any, NamedTuple

import numpy as np

from drivesizer.catalog import Catalog, Note, columns_of, singular
from drivesizer.catalog.estimates import estimates_of
from drivesizer.catalog.estimates.estimate import SAME_FAMILY, family_limits, law_text
from drivesizer.catalog.parts import HELD, Discharges, PullOuts
from drivesizer.catalog.query import Hit, Row, origins, partners, tolerances
from drivesizer.catalog.tables import ESTIMATED
from drivesizer.catalog.view.search_view import CLAMPING_HUB
from drivesizer.machine.part_curves import HEAT, Line, continuous_curve, line, overload_times, permitted_current
from drivesizer.output.words import figure, number_of
from drivesizer.physics.thermal import DATA_TEMPERATURE, Value, data_temperature, rated_ambient
from drivesizer.results.drive_set import DriveSet, section_of
from drivesizer.units import show

# -- Parts as data sheets: every known figure, its confidence and its source.


_NAMES = {"part", "family", "manufacturer"}  # in the heading already


def datasheets(drive_set: DriveSet, catalog: Catalog) -> list[dict[str, Any]]:
    """The known figures of each part of a drive, marked where not quoted from the maker."""
    parts = {(section_of(part), part.part): part for part in drive_set.parts.values() if part is not None}  # each once
    return [datasheet(section, part, catalog) for (section, _), part in parts.items()]


def datasheet(section: str, part: Any, catalog: Catalog) -> dict[str, Any]:
    """The known figures of one part."""
    table = catalog.table(section)
    row = table.rows[part.part]
    source = catalog.sources[table.source[row]]
    confidence = catalog.confidence(section, row)
    names = [name for name in columns_of(section) if name in confidence and name not in _NAMES]
    return {
        "role": singular(section),
        "part": part.part,
        "family": part.family,
        "maker": part.manufacturer,
        "rows": [_row(part, name, section, confidence) for name in names],
        "source": ", ".join(text for text in (source.document, source.date) if text),
        "confidence": source.confidence,
        "url": source.url,
        "notes": [_note(note) for note in catalog.notes_on(section, part.part)],
    }


def _row(part: Any, name: str, section: str, confidence: dict[str, str]) -> dict[str, str]:
    digits = 3 if confidence[name] == ESTIMATED else 6  # its band is wide
    text = figure(getattr(part, name), columns_of(section)[name], digits=digits)
    mark = "" if confidence[name] == "quoted" else confidence[name]
    return {"name": name.replace("_", " "), "text": text, "mark": mark}


def _note(note: Note) -> dict[str, str]:
    where = ", ".join(name.replace("_", " ") for name in note.fields)
    return {"where": where, "text": note.text, "confidence": note.confidence, "source": note.source}


# -- Tables of one part as texts: torque and speed, discharges, pull-out torque, estimates, limits of its family.


_POINTS = (
    ("no load", "no_load_speed", "", "no_load_current"),
    ("nominal", "nominal_speed", "nominal_torque", "nominal_current"),
    ("stall", "", "stall_torque", "stall_current"),
)


class PartTable(NamedTuple):
    """A table without a format."""

    heads: tuple[tuple[str, str], ...]  # text and side of each column: left or right
    rows: Sequence[tuple[str, ...]]
    title: str = ""
    closing: str = ""  # a line below


def torque_and_speed(hit: Hit) -> PartTable:
    """Three points of the line at nominal voltage, as the maker gives them; of a motor or an actuator."""
    schema = columns_of(hit.section)
    rows = [(name, *(figure(hit[c], schema[c]) if c else "0" for c in columns)) for name, *columns in _POINTS]
    heads = (("", "left"), ("speed", "right"), ("torque", "right"), ("current", "right"))
    return PartTable(heads, rows, "torque and speed")


def discharges(hit: Hit) -> Iterator[PartTable]:
    """The printed discharges of a battery, constant currents and constant powers apart; times down, voltages across."""
    own = hit.catalog.discharges.on(hit.catalog.discharges.battery == hit.row)
    for held, unit in HELD.items():
        some = own.on(~np.isnan(getattr(own, held)))
        if len(some.time):
            yield _discharges(some, held, unit)


def _discharges(own: Discharges, held: str, unit: str) -> PartTable:
    ends = np.unique(own.cutoff_voltage)
    draw, rows = getattr(own, held), []
    for time in np.unique(own.time):
        cells = [draw[(own.time == time) & (own.cutoff_voltage == end)] for end in ends]
        lasts = show(float(time), "min" if float(time) < 3600.0 else "h", "time")
        rows.append((lasts, *(f"{c[0]:g}" if len(c) else "–" for c in cells)))
    heads = (("lasts", "right"), *((show(float(end), "V", "voltage"), "right") for end in ends))
    return PartTable(heads, rows, f"Constant {held} ({unit}), down to")


def pull_outs(hit: Hit) -> Iterator[PartTable]:
    """The printed pull-out curves of a stepper, one after the other."""
    own = hit.catalog.pull_outs.on(hit.catalog.pull_outs.stepper == hit.row)
    for curve in np.unique(own.curve).tolist():
        one = own.on(own.curve == curve)
        rows = [
            (show(speed, "rpm", "rotary_speed", 4), show(torque, "N*m", "torque", 3))
            for speed, torque in zip(one.speed.tolist(), one.torque.tolist(), strict=True)
        ]
        heads = (("speed", "right"), ("pull-out torque", "right"))
        yield PartTable(heads, rows, f"Pull-out torque: {pull_out_conditions(one)}")


def pull_out_conditions(curve: PullOuts) -> str:
    """Supply voltage, current and driver with which a curve was measured."""
    amps = float(curve.current[0])
    with_ = [show(float(curve.voltage[0]), "V", "voltage")]
    with_ += [] if np.isnan(amps) else [f"{show(amps, 'A', 'current')} amplitude"]
    with_ += [str(curve.driver[0])] if curve.driver[0] else []
    return ", ".join(with_)


def estimates(hit: Hit) -> PartTable | None:
    """Figures that a part's data sheet leaves out, as its peers have them; None where there are none."""
    rows = []
    for one in estimates_of(hit.table, hit.row):
        value, low, high = (_shown(hit, one.figure, figure, 2) for figure in (one.value, one.low, one.high))
        rows.append((one.figure.replace("_", " "), value, f"{low} to {high}", law_text(one.fit)))
    heads = (("estimated from peers", "left"), ("", "right"), ("5 to 95 %", "right"), ("from", "left"))
    closing = "Sizing takes these unless the spec has select: {estimates: off}."
    return PartTable(heads, rows, closing=closing) if rows else None


def _all_print(count: int) -> str:
    return "the one other part prints it" if count == 1 else f"{count} parts print it, all alike"


def limits_of_family(hit: Hit) -> PartTable | None:
    """Permitted limits that all others of a part's family have; None where there are none."""
    rows = [
        (one.figure.replace("_", " "), _shown(hit, one.figure, one.value, 3),
         f"{SAME_FAMILY}; {_all_print(one.members)}")
        for one in family_limits(hit.table, hit.row)
    ]  # fmt: skip
    heads = (("limits of the family", "left"), ("", "right"), ("from", "left"))
    return PartTable(heads, rows, closing="Sizing does not use them.") if rows else None


def _shown(hit: Hit, figure: str, value: float, digits: int) -> str:
    column = columns_of(hit.section)[figure]
    return show(value, column.unit, column.kind, digits)


# -- Heat of a motor or actuator as tables: continuous current by ambient temperature, and overload times.


_AMBIENTS = (DATA_TEMPERATURE, 313.15, 333.15, 353.15, 373.15)  # K
_OVERLOADS = (1.5, 2.0, 3.0, 5.0)  # times the continuous current
_SLOW = ("winding_time_constant", "motor_time_constant")


class Heat(NamedTuple):
    """Tables of a part's heat, and what is missing for more."""

    tables: list[PartTable]
    notes: list[str]  # on the overload times
    missing: str  # what is unknown, and for want of which figures; empty where all is known


def heat(hit: Hit) -> Heat:
    """Continuous current over ambient temperature and overload times at 25 degC, or what is missing for them."""
    ambients, overloads = _ambients(hit), _overloads(hit)
    found = [table for table in (ambients, overloads) if table]
    needed = [*(() if found else HEAT[:1]), *(() if overloads else (*HEAT[1:], *_SLOW))]
    missing = ", ".join(name.replace("_", " ") for name in needed if isnan(hit[name]))
    what = f"{'overload' if found else 'heat'}: unknown without {missing}" if missing else ""
    return Heat(found, _bounds(hit) if overloads else [], what)


def _ambients(hit: Hit) -> PartTable | None:
    """Continuous current; None where it is known at 25 degC only, which is among the figures."""
    currents = [permitted_current(hit, ambient) for ambient in _AMBIENTS]
    if all(map(isnan, currents[1:])):
        return None
    heads = (("", "left"), *((show(ambient, "degC", "temperature"), "right") for ambient in _AMBIENTS))
    all_permitted = _AMBIENTS[-1] <= hit["ambient_max"] or isnan(hit["ambient_max"])
    title = f"continuous current by ambient{'' if all_permitted else ' (– not permitted)'}"
    name = "at standstill" if isnan(hit["nominal_current"]) else "nominal"
    return PartTable(heads, [(name, *map(_amperes, currents))], title)


def _overloads(hit: Hit) -> PartTable | None:
    """Overload times at a few currents; None where unknown."""
    currents = [permitted_current(hit, DATA_TEMPERATURE) * times for times in _OVERLOADS]
    times = [overload_times(hit, current) for current in currents]
    if isnan(currents[0] + times[0][0]):
        return None
    heads = (("", "left"), *((f"{times:g} ×", "right") for times in _OVERLOADS))
    rows = [("current", *map(_amperes, currents))]
    for name, row in zip(("from cold", "from warm"), zip(*times, strict=True), strict=True):
        if not isnan(row[0]):
            rows.append((name, *map(_duration, row)))
    limit = show(hit["max_winding_temperature"], "degC", "temperature")
    return PartTable(heads, rows, f"overload at standstill, 25 °C, to {limit}")


def _bounds(hit: Hit) -> list[str]:
    """Notes on overload times: the warm start, and limits other than heat."""
    most, current = (
        _OVERLOADS[-1] * permitted_current(hit, DATA_TEMPERATURE),
        hit["nominal_voltage"] / hit["resistance"],
    )
    peak = hit["peak_torque"] / hit["torque_constant"]
    notes = ["warm: winding and housing at the housing's temperature at the nominal point"]
    if current < most:
        notes.append(f"more than {_amperes(current)} does not flow at nominal voltage")
    if peak < most:
        notes.append(f"more than {_amperes(peak)} exceeds the permitted peak torque")
    return notes


def _amperes(current: float) -> str:
    return "–" if isnan(current) else show(current, "A", "current", 3)


def _duration(time: float) -> str:
    """A time in its customary unit."""
    unit = "h" if time > 7200.0 else "min" if time > 120.0 else "s"
    return show(time, unit, "time", 3)


# -- Speed over torque of a motor or an actuator's output, as curves with names: line, continuous region, points.


_READ = 3.0  # times the nominal torque, the end of the axis; a large motor's stall is at 40 times


class Curve(NamedTuple):
    """Points over torque [N*m] of speed [rad/s]."""

    kind: str  # line, continuous, peak, or nominal, a single point
    name: str
    torque: Sequence[float]
    speed: Sequence[float]


def reach_of(hit: Hit) -> float:
    """End of the torque axis [N*m]: stall, or less where stall is far beyond the nominal torque; NaN unknown."""
    ends, continuous = line(hit), continuous_curve(hit)[0]
    nominal = hit["nominal_torque"]
    if isnan(nominal):
        own = 0.0 if isnan(hit["no_load_current"]) else hit["no_load_current"]
        nominal = hit["torque_constant"] * (hit["nominal_current"] - own)
    cut = ends.torque * (1.0 - min(hit["max_speed"] / ends.speed, 1.0))  # where the line starts, at the top speed
    wanted = [x for x in (_READ * nominal, _READ * max(continuous, default=nan), 2.0 * cut) if x > 0.0]
    return min([*([max(wanted)] if wanted else []), *([] if isnan(ends.torque) else [ends.torque])], default=nan)


def speed_torque(hit: Hit) -> list[Curve]:
    """The line, the continuous region, peak and nominal torque, as far as known; nothing without a line or region."""
    ends, reach = line(hit), reach_of(hit)
    found = [] if isnan(ends.torque) else [_line(hit, ends, reach)]
    torque, speed = continuous_curve(hit)
    if torque:
        around = _celsius(rated_ambient(hit))
        found.append(Curve("continuous", f"continuous, at {around} around the motor", torque, speed))
    if not found:
        return []
    peak = hit["peak_torque"]
    if peak <= reach:
        tallest = max(max(one.speed) for one in found)
        found.append(Curve("peak", "peak torque, for a short time", [peak, peak], [0.0, tallest]))
    return [*found, *_nominal(hit, ends)]


def _line(hit: Hit, ends: Line, reach: float) -> Curve:
    schema, top = columns_of(hit.section), hit["max_speed"]

    def shown(name: str) -> str:
        return figure(hit[name], schema[name])

    start = min(ends.speed, top) if top > 0.0 else ends.speed
    at = "nominal voltage" if isnan(hit["nominal_voltage"]) else shown("nominal_voltage")
    name = f"at {at}, winding at {_celsius(data_temperature(hit))}"
    name += ", computed from R, k_t and the no-load speed" if ends.computed else ""
    name += f"; cut at the permitted {shown('max_speed')}" if start < ends.speed else ""
    stall = figure(ends.torque, schema["stall_torque"])
    name += f"; stall, {stall}, is beyond the chart" if ends.torque > reach else ""
    return Curve("line", name, [0.0, ends.torque * (1.0 - start / ends.speed), ends.torque], [start, start, 0.0])


def _celsius(temperature: Value) -> str:
    return show(float(temperature), "degC", "temperature")


def _nominal(hit: Hit, ends: Line) -> list[Curve]:
    """The nominal point; on the line where its speed is unknown."""
    torque, speed = hit["nominal_torque"], hit["nominal_speed"]
    name = "nominal torque, on the line" if isnan(speed) else "nominal point"
    speed = ends.speed * (1.0 - torque / ends.torque) if isnan(speed) else speed
    return [] if isnan(torque + speed) else [Curve("nominal", name, [torque], [speed])]


# -- Remarks on one part as lines: parts that it goes with, tolerances, notes, sources, and marks of a comparison.


DIFFERS = {True: "≠", False: "", None: "?"}  # mark of a row of parts side by side
EXCLUDED = "excluded from sizing by a note"


def head(hit: Hit) -> str:
    """Maker and family of a part, with its reduction where it has one."""
    reduction = f" {hit['reduction']}" if hit.section in ("gearheads", "actuators") else ""
    return f"{hit['manufacturer']} {hit['family']}{reduction}".strip()


def family_count(count: int) -> str:
    """A number of families.

    >>> family_count(1), family_count(2)
    ('1 family', '2 families')
    """
    return number_of(count, "family", "families")


def partner_lines(hit: Hit) -> list[tuple[str, dict[str, int]]]:
    """Parts that go with a part: a line for each kind, and of each of its families how many."""
    found: list[tuple[str, dict[str, int]]] = []
    for section, counts in partners(hit).items():
        if counts:
            found.append((f"{section}: {sum(counts.values())} in {family_count(len(counts))}: ", counts))
        else:
            found.append((f"{section}: none is listed; one may still exist", {}))
    if hit.section == "gearheads" and hit["mounting"] == CLAMPING_HUB:
        found.append(("motors: of any maker, with a shaft that fits the clamping hub", {}))
    return found


def tolerance_lines(hit: Hit) -> list[str]:
    """The maker's tolerances, a line for each document."""
    stated: dict[tuple[int, str], list[str]] = {}
    for one in tolerances(hit):
        figure = f"losses of the {one.part}" if one.figure == "efficiency" else one.figure.replace("_", " ")
        stated.setdefault((one.source, one.text), []).append(f"{figure} {one.tolerance}")
    lines = []
    for (number, text), figures in stated.items():
        source = hit.catalog.sources[number]
        said = f"{', '.join(figures)}{f'; {text}' if text else ''}"
        lines.append(f"{said} ({source.document}; {source.confidence})")
    return lines


def note_line(note: dict[str, Any]) -> str:
    """A note of a data sheet, with the figures that it is on."""
    words = "; ".join(text for text in (note["text"], note["confidence"]) if text)
    return f"{note['where']}: {words}" if note["where"] else words


def source_line(sheet: dict[str, Any]) -> str:
    """Source of a data sheet, with its confidence."""
    return f"{sheet['source']} ({sheet['confidence']})"


def documents(hit: Hit) -> list[str]:
    """The documents behind a part's figures, each once."""
    return list(dict.fromkeys(source.document for source in origins(hit).values()))


def sources_of(hit: Hit) -> list[str]:
    """The documents behind a part's figures with date and address, in the order of :func:`documents`."""
    known = {source.document: source for source in origins(hit).values()}
    each = ((document, known[document].date, known[document].url) for document in documents(hit))
    return [", ".join(part for part in parts if part) for parts in each]


def closing(rows: Sequence[Row]) -> str:
    """Meaning of the marks of parts side by side, with the number of rows that differ."""
    differing = sum(row.differs is True for row in rows)
    return f"≠ differs ({differing} of {len(rows)} rows), ? undecided: a figure is unknown"
