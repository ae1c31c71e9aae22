"""One part of a catalogue for every output: its figures with their confidence, tables, curves, remarks; and several."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isnan
from typing import Any

import numpy as np

from drivesizer.catalog import Catalog, columns_of, singular
from drivesizer.catalog.estimates import SAME_FAMILY, estimates_of, family_limits, law_text
from drivesizer.catalog.parts import CONSTANT_DRAWS, Column
from drivesizer.catalog.query import PartRow, Row, origins, partners, tolerances
from drivesizer.catalog.tables import ESTIMATED
from drivesizer.catalog.view import CLAMPING_HUB
from drivesizer.machine.part_curves import HEAT, overload_times, permitted_current
from drivesizer.output.document import records as doc
from drivesizer.output.words import figure, number_of
from drivesizer.physics.thermal import DATA_TEMPERATURE
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
    source, confidence, schema = (
        catalog.sources[table.source[row]],
        catalog.confidence(section, row),
        columns_of(section),
    )
    rows = []
    compared = {"price"} if catalog.unpriced else set[str]()  # in another currency maybe: the parts list has its own
    for name in schema:
        if name in confidence and name not in _NAMES | compared:
            digits = 3 if confidence[name] == ESTIMATED else 6  # its band is wide
            mark = "" if confidence[name] == "quoted" else confidence[name]
            text = figure(getattr(part, name), schema[name], digits=digits)
            rows.append({"name": name.replace("_", " "), "text": text, "mark": mark})
    notes = [
        {"where": ", ".join(name.replace("_", " ") for name in note.fields), "text": note.text,
         "confidence": note.confidence, "source": note.source}
        for note in catalog.notes_on(section, part.part)
    ]  # fmt: skip
    return {
        "role": singular(section), "part": part.part, "family": part.family, "maker": part.manufacturer, "rows": rows,
        "source": ", ".join(text for text in (source.document, source.date) if text), "url": source.url,
        "confidence": source.confidence, "notes": notes,
    }  # fmt: skip


def head(hit: PartRow) -> str:
    """Maker and family of a part, with its reduction where it has one."""
    reduction = f" {hit['reduction']}" if hit.section in ("gearheads", "actuators") else ""
    return f"{hit['manufacturer']} {hit['family']}{reduction}".strip()


def figures_of(hit: PartRow, *, sources: bool = False) -> doc.Table:
    """Every known figure with its confidence; on request that of all, and the number of the document."""
    origin, named = {name.replace("_", " "): source for name, source in origins(hit).items()}, documents_of(hit)
    rows = []
    for row in datasheet(hit.section, hit.table.record(hit.row), hit.catalog)["rows"]:
        source = origin[row["name"]]
        cells: dict[str, doc.Cell] = {"title": row["name"], "value": row["text"]}
        cells |= {"mark": (doc.Mark(source.confidence if sources else row["mark"]),)}
        cells |= {"source": f"[{named.index(source.document) + 1}]"} if sources else {}
        rows.append(doc.Row(cells))
    heads = {"title": "figure", "mark": "confidence"} if sources else {}
    return doc.table("part_figures", "", rows, heads=heads, without=() if sources else ["source"])


def cell(value: Any, column: Column, *, unit: bool = True) -> doc.Cell:
    """A figure as a data sheet prints it; without its unit where the head has that, and then a dash where unknown."""
    if isinstance(value, str) or isnan(value):
        text = figure(value, column)
        return "–" if text == "unknown" and not unit else text
    kind = "money" if column.kind.startswith("price") else column.kind
    return doc.Quantity(value, column.unit, kind, 5, own=figure(value, column, unit=unit))


def documents_of(hit: PartRow) -> list[str]:
    """The documents behind a part's figures, each once."""
    return list(dict.fromkeys(source.document for source in origins(hit).values()))


# -- What a part does: torque and speed, heat, discharges, pull-out torque, estimates, limits of its family.


_POINTS = (
    ("no load", "no_load_speed", "", "no_load_current"),
    ("nominal", "nominal_speed", "nominal_torque", "nominal_current"), ("stall", "", "stall_torque", "stall_current"),
)  # fmt: skip


def behaviour(hit: PartRow) -> Iterator[doc.Block]:
    """Tables of a part, and its curves in their place."""
    if hit.section in ("motors", "actuators"):
        schema = columns_of(hit.section)
        rows = [(name, *(cell(hit[c], schema[c]) if c else "0" for c in columns)) for name, *columns in _POINTS]
        yield doc.table("at_torque", "Torque and speed", rows)
        yield doc.Picture(f"part-{CURVES[hit.section][0]}", "", "speed over torque")
        yield from _heat(hit)
    for name in CURVES.get(hit.section, ()) if hit.section not in ("motors", "actuators") else ():
        yield doc.Picture(f"part-{name}", "", name.replace("-", " "))
    if hit.section == "batteries":
        yield from _discharges(hit)
    if hit.section == "steppers":
        yield from _pull_outs(hit)
    yield from _estimates(hit)
    yield from _prices(hit)


def _prices(hit: PartRow) -> Iterator[doc.Block]:
    """The prices that lists have of a part, the newest first."""
    prices = [price for price in hit.catalog.prices if (price.section, price.part) == (hit.section, hit.part)]
    rows = [(f"{price.amount:.2f} {price.currency}", str(price.pieces), price.date, price.seller,
             price.order_number, "; ".join(filter(None, (price.delivery, price.note))))
            for price in sorted(prices, key=lambda price: price.date, reverse=True)]  # fmt: skip
    if rows:
        yield doc.table("list_prices", "Prices of lists", rows)


CURVES = {  # names of a part's curves, of which some have several
    "motors": ("speed-torque",), "actuators": ("speed-torque",), "gearheads": ("efficiency", "torque-ratio"),
    "steppers": ("pull-out",), "batteries": ("discharge-current", "discharge-power", "discharge"),
}  # fmt: skip


def _discharges(hit: PartRow) -> Iterator[doc.Block]:
    """The printed discharges of a battery, constant currents and constant powers apart; times down, voltages across."""
    discharges = hit.catalog.discharges.on(hit.catalog.discharges.battery == hit.row)
    for constant, unit in CONSTANT_DRAWS.items():
        own = discharges.on(~np.isnan(getattr(discharges, constant)))
        ends, draw, rows = np.unique(own.cutoff_voltage), getattr(own, constant), []
        for time in np.unique(own.time):
            cells = [draw[(own.time == time) & (own.cutoff_voltage == end)] for end in ends]
            lasts = show(float(time), "min" if float(time) < 3600.0 else "h", "time")
            rows.append((lasts, *(f"{c[0]:g}" if len(c) else "–" for c in cells)))
        columns = [doc.Column("lasts", "lasts", "number")]
        columns += [doc.Column(f"{end:g}", show(float(end), "V", "voltage"), "number") for end in ends]
        yield doc.table("across", f"Constant {constant} ({unit}), down to", rows, without=["title"], more=columns)


def _pull_outs(hit: PartRow) -> Iterator[doc.Block]:
    """The printed pull-out curves of a stepper, one after the other."""
    from drivesizer.output.report.figures.parts import pull_out_conditions

    own = hit.catalog.pull_outs.on(hit.catalog.pull_outs.stepper == hit.row)
    for curve in np.unique(own.curve).tolist():
        points = own.on(own.curve == curve)
        rows = [
            (show(speed, "rpm", "rotary_speed", 4), show(torque, "N*m", "torque", 3))
            for speed, torque in zip(points.speed.tolist(), points.torque.tolist(), strict=True)
        ]
        yield doc.table("pull_outs", f"Pull-out torque: {pull_out_conditions(points)}", rows)


def _estimates(hit: PartRow) -> Iterator[doc.Block]:
    """Figures that its data sheet leaves out, as its peers have them; limits that all others of its family have."""
    schema = columns_of(hit.section)

    def text_of(name: str, value: float, digits: int) -> str:
        return show(value, schema[name].unit, schema[name].kind, digits)

    rows = []
    for estimate in estimates_of(hit.table, hit.row):
        value, low, high = (
            text_of(estimate.figure, figure, 2) for figure in (estimate.value, estimate.low, estimate.high)
        )
        rows.append((estimate.figure.replace("_", " "), value, f"{low} to {high}", law_text(estimate.fit)))
    if rows:
        yield doc.table("part_estimates", "", rows)
        yield doc.Words("Sizing takes these unless the spec has select: {estimates: off}.", "note")
    limits = []
    for limit in family_limits(hit.table, hit.row):
        alike = "the one other part prints it" if limit.members == 1 else f"{limit.members} parts print it, all alike"
        limits.append(
            (limit.figure.replace("_", " "), text_of(limit.figure, limit.value, 3), f"{SAME_FAMILY}; {alike}")
        )
    if limits:
        yield doc.table("family_limits", "", limits)
        yield doc.Words("Sizing does not use them.", "note")


# -- Heat of a motor or actuator as tables: continuous current by ambient temperature, and overload times.


_AMBIENTS = (DATA_TEMPERATURE, 313.15, 333.15, 353.15, 373.15)  # K
_OVERLOADS = (1.5, 2.0, 3.0, 5.0)  # times the continuous current
_SLOW = ("winding_time_constant", "motor_time_constant")


def _heat(hit: PartRow) -> Iterator[doc.Block]:
    """Continuous current over ambient temperature and overload times at 25 degC, or what is missing for them."""
    ambients, overloads = _ambients(hit), _overloads(hit)
    tables = [table for table in (ambients, overloads) if table]
    if tables:
        yield doc.Pair(tables[:1], tables[1:])
    notes = _bounds(hit) if overloads else []
    needed = [*(() if tables else HEAT[:1]), *(() if overloads else (*HEAT[1:], *_SLOW))]
    if missing := ", ".join(name.replace("_", " ") for name in needed if isnan(hit[name])):
        notes.append(f"{'overload' if tables else 'heat'}: unknown without {missing}")
    yield from (doc.Words(note) for note in notes)


def _ambients(hit: PartRow) -> doc.Table | None:
    """Continuous current; None where it is known at 25 degC only, which is among the figures."""
    currents = [permitted_current(hit, ambient) for ambient in _AMBIENTS]
    if all(map(isnan, currents[1:])):
        return None
    columns = [doc.Column(f"{x:g}", show(x, "degC", "temperature"), "number") for x in _AMBIENTS]
    all_permitted = _AMBIENTS[-1] <= hit["ambient_max"] or isnan(hit["ambient_max"])
    title = f"Continuous current by ambient{'' if all_permitted else ' (– not permitted)'}"
    name = "at standstill" if isnan(hit["nominal_current"]) else "nominal"
    return doc.table("across", title, [(name, *map(_amperes, currents))], more=columns)


def _overloads(hit: PartRow) -> doc.Table | None:
    """Overload times at a few currents; None where unknown."""
    currents = [permitted_current(hit, DATA_TEMPERATURE) * times for times in _OVERLOADS]
    times = [overload_times(hit, current) for current in currents]
    if isnan(currents[0] + times[0][0]):
        return None
    rows = [("current", *map(_amperes, currents))]
    for name, row in zip(("from cold", "from warm"), zip(*times, strict=True), strict=True):
        if not isnan(row[0]):
            durations = ((x, "h" if x > 7200.0 else "min" if x > 120.0 else "s") for x in row)
            rows.append((name, *(show(x, unit, "time", 3) for x, unit in durations)))
    limit = show(hit["max_winding_temperature"], "degC", "temperature")
    columns = [doc.Column(f"{times:g}", f"{times:g} ×", "number") for times in _OVERLOADS]
    return doc.table("across", f"Overload at standstill, 25 °C, to {limit}", rows, more=columns)


def _bounds(hit: PartRow) -> list[str]:
    """Notes on overload times: the warm start, and limits other than heat."""
    most, current = (_OVERLOADS[-1] * permitted_current(hit, DATA_TEMPERATURE),
                     hit["nominal_voltage"] / hit["resistance"])  # fmt: skip
    peak = hit["peak_torque"] / hit["torque_constant"]
    notes = ["warm: winding and housing at the housing's temperature at the nominal point"]
    if current < most:
        notes.append(f"more than {_amperes(current)} does not flow at nominal voltage")
    if peak < most:
        notes.append(f"more than {_amperes(peak)} exceeds the permitted peak torque")
    return notes


def _amperes(current: float) -> str:
    return "–" if isnan(current) else show(current, "A", "current", 3)


# -- Remarks on one part: parts that it goes with, tolerances, notes, sources; and parts side by side.


EXCLUDED = "excluded from sizing by a note"


def partner_lines(hit: PartRow) -> list[tuple[str, dict[str, int]]]:
    """Parts that go with a part: a line for each kind, and of each of its families how many."""
    lines: list[tuple[str, dict[str, int]]] = []
    for section, counts in partners(hit).items():
        if counts:
            lines.append(
                (f"{section}: {sum(counts.values())} in {number_of(len(counts), 'family', 'families')}: ", counts)
            )
        else:
            lines.append((f"{section}: none is listed; one may still exist", {}))
    if hit.section == "gearheads" and hit["mounting"] == CLAMPING_HUB:
        lines.append(("motors: of any maker, with a shaft that fits the clamping hub", {}))
    return lines


def own_remarks(hit: PartRow) -> Iterator[doc.Words]:
    """Exclusion, tolerances by the maker, notes."""
    if hit.table.excluded[hit.row]:
        yield doc.Words(EXCLUDED, "alarm")
    sheet, stated = datasheet(hit.section, hit.table.record(hit.row), hit.catalog), dict[tuple[int, str], list[str]]()
    for tolerance in tolerances(hit):
        name = (
            f"losses of the {tolerance.part}"
            if tolerance.figure == "efficiency"
            else tolerance.figure.replace("_", " ")
        )
        stated.setdefault((tolerance.source, tolerance.text), []).append(f"{name} {tolerance.tolerance}")
    for (number, text), figures in stated.items():
        source = hit.catalog.sources[number]
        remark = "; ".join(filter(None, (", ".join(figures), text)))
        yield doc.Words((doc.Strong("tolerances: "), f"{remark} ({source.document}; {source.confidence})"))
    for note in sheet["notes"]:
        words = "; ".join(text for text in (note["text"], note["confidence"]) if text)
        yield doc.Words((doc.Strong("note: "), f"{note['where']}: {words}" if note["where"] else words))


def remarks(hit: PartRow, *, sources: bool = False) -> Iterator[doc.Words]:
    """Those, and the document, or all documents with their numbers."""
    yield from own_remarks(hit)
    if not sources:
        sheet = datasheet(hit.section, hit.table.record(hit.row), hit.catalog)
        yield doc.Words((doc.Strong("source: "), f"{sheet['source']} ({sheet['confidence']})"))
        return
    known = {source.document: source for source in origins(hit).values()}
    for place, name in enumerate(documents_of(hit), 1):
        yield doc.Words(f"[{place}] " + ", ".join(filter(None, (name, known[name].date, known[name].url))))


def comparison(hits: Sequence[PartRow], rows: Sequence[Row], most: int) -> Iterator[doc.Block]:
    """Parts side by side, so many in a table; a row in which they differ is marked, ? where some are unknown."""
    for start in range(0, len(hits), most):
        places = range(start, min(start + most, len(hits)))
        columns = [doc.Column(str(n), f"{hits[n].part}\n{hits[n].catalogue}", "number") for n in places]
        lines = []
        for row in rows:
            name, cells = row.column.name.replace("_", " "), {str(n): cell(row.values[n], row.column) for n in places}
            mark = {True: "≠", False: "", None: "?"}[row.differs]
            lines.append(doc.Row({"mark": mark, "title": (doc.Strong(name),) if row.differs else name, **cells}))
        yield doc.table("beside", "", lines, more=columns)
    differing = sum(row.differs is True for row in rows)
    yield doc.Words(f"≠ differs ({differing} of {len(rows)} rows), ? undecided: a figure is unknown")
