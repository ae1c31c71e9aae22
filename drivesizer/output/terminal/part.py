"""One part at the terminal as a data sheet: figures, torque and speed, heat, matching parts, tolerances, sources."""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan, nan
from typing import Any

from rich.console import Console, RenderableType
from rich.table import Table
from rich.text import Text

from drivesizer.catalog import columns_of, one_of
from drivesizer.catalog.lookup import origins, partners, tolerances
from drivesizer.catalog.query import Hit
from drivesizer.catalog.view.search_view import CLAMPING_HUB
from drivesizer.machine.part_curves import HEAT, Line, continuous_curve, line, overload_times, permitted_current
from drivesizer.output.datasheet import datasheet
from drivesizer.output.terminal.battery import discharge_tables
from drivesizer.output.terminal.catalog import counted, figure, of_families
from drivesizer.output.terminal.chart import Axis, Series, chart
from drivesizer.output.terminal.estimates import print_estimates, print_family_limits
from drivesizer.output.terminal.stepper import pull_out_tables
from drivesizer.output.terminal.tables import bare, console, heading, width_of
from drivesizer.physics.thermal import DATA_TEMPERATURE, Value, data_temperature, rated_ambient
from drivesizer.units import from_si, label, show

__all__ = ["page"]

_POINTS = (
    ("no load", "no_load_speed", "", "no_load_current"),
    ("nominal", "nominal_speed", "nominal_torque", "nominal_current"),
    ("stall", "", "stall_torque", "stall_current"),
)
_DOUBT = {"quoted": "", "secondary": "cyan", "derived": "yellow", "recalled": "red"}
_AMBIENTS = (DATA_TEMPERATURE, 313.15, 333.15, 353.15, 373.15)  # K
_OVERLOADS = (1.5, 2.0, 3.0, 5.0)  # times the continuous current
_READ = 3.0  # times the nominal torque, the end of the chart; a large motor's stall is at 40 times
_HEIGHT = 8  # columns of the terminal to a line of the chart's field
_SLOW = ("winding_time_constant", "motor_time_constant")


def page(hit: Hit, *, sources: bool = False) -> None:
    """Print one part as a data sheet.

    Parameters
    ----------
    hit
        The part.
    sources
        Print the source of each figure.
    """
    out, sheet = console(), datasheet(hit.section, hit.table.record(hit.row), hit.catalog)
    reduction = f" {hit['reduction']}" if hit.section in ("gearheads", "actuators") else ""
    head = f"{sheet['maker']} {sheet['family']}{reduction}".strip()
    heading(out, head, f"{hit.part} · {one_of(hit.section)} in {hit.catalogue}")
    _figures(out, hit, sheet, sources)
    if hit.section in ("motors", "actuators"):
        out.print(_torque_speed(hit))
        out.print(*_chart(hit, out.width), sep="\n")
        _heat(out, hit)
        out.print()
    if hit.section == "batteries":
        out.print(*discharge_tables(hit), sep="\n")
    if hit.section == "steppers":
        out.print(*pull_out_tables(hit), sep="\n")
    print_estimates(out, hit)
    print_family_limits(out, hit)
    _partners(out, hit)
    _tolerances(out, hit)
    _remarks(out, hit, sheet, sources)
    out.print()


# --- figures, partners, sources --------------------------------------------------------------------------------------


def _figures(out: Console, hit: Hit, sheet: dict[str, Any], sources: bool) -> None:
    origin = {name.replace("_", " "): source for name, source in origins(hit).items()}
    documents = _documents(hit)
    rows = []
    for row in sheet["rows"]:
        source = origin[row["name"]]
        confidence = source.confidence if sources else row["mark"]
        number = [f"[{documents.index(source.document) + 1}]"] if sources else []
        cells = (row["name"], row["text"], Text(confidence, style=_DOUBT[source.confidence]), *map(Text, number))
        rows.append([Text(c) if isinstance(c, str) else c for c in cells])
    half = (len(rows) + 1) // 2
    halves = [_block(part, sources) for part in (rows[:half], rows[half:])]
    if not _beside(out, halves):
        out.print(_block(rows, sources))


def _block(rows: Sequence[Sequence[Text]], sources: bool) -> Table:
    table = bare(("", "left"), ("", "right"), ("", "left"), *([("source", "right")] if sources else []), headed=sources)
    for row in rows:
        table.add_row(*row)
    return table


def _beside(out: Console, tables: Sequence[RenderableType]) -> bool:
    """Print tables side by side; False, without printing, where they do not fit."""
    if sum(width_of(table) + 2 for table in tables) > out.width:
        return False
    grid = Table.grid(padding=(0, 2, 0, 0))
    grid.add_row(*tables)
    out.print(grid)
    return True


def _documents(hit: Hit) -> list[str]:
    """The documents behind a part's figures, each once."""
    return list(dict.fromkeys(source.document for source in origins(hit).values()))


def _partners(out: Console, hit: Hit) -> None:
    for section, counts in partners(hit).items():
        if counts:
            out.print(counted(counts, out.width, f"{section}: {sum(counts.values())} in {of_families(len(counts))}: "))
        else:
            out.print(Text(f"{section}: none is listed; one may still exist"))
    if hit.section == "gearheads" and hit["mounting"] == CLAMPING_HUB:
        out.print(Text("motors: of any maker, with a shaft that fits the clamping hub"))
    if hit.table.excluded[hit.row]:
        out.print(Text("excluded from sizing by a note", style="red"))


def _tolerances(out: Console, hit: Hit) -> None:
    """Print the maker's tolerances, a line for each document."""
    stated: dict[tuple[int, str], list[str]] = {}
    for one in tolerances(hit):
        figure_ = f"losses of the {one.part}" if one.figure == "efficiency" else one.figure.replace("_", " ")
        stated.setdefault((one.source, one.text), []).append(f"{figure_} {one.tolerance}")
    for (number, text), figures in stated.items():
        source = hit.catalog.sources[number]
        line = f"{', '.join(figures)}{f'; {text}' if text else ''} ({source.document}; {source.confidence})"
        out.print(Text("tolerances: ", style="bold") + Text(line))


def _remarks(out: Console, hit: Hit, sheet: dict[str, Any], sources: bool) -> None:
    for note in sheet["notes"]:
        words = "; ".join(text for text in (note["text"], note["confidence"]) if text)
        out.print(Text("note: ", style="bold") + Text(f"{note['where']}: {words}" if note["where"] else words))
    if not sources:
        out.print(Text("source: ", style="bold") + Text(f"{sheet['source']} ({sheet['confidence']})"))
        return
    known = {source.document: source for source in origins(hit).values()}
    for place, document in enumerate(_documents(hit), 1):
        parts = (document, known[document].date, known[document].url)
        out.print(Text(f"[{place}] " + ", ".join(part for part in parts if part)))


# --- torque and speed ------------------------------------------------------------------------------------------------


def _torque_speed(hit: Hit) -> Table:
    """Three points of the line at nominal voltage, as the maker gives them."""
    schema = columns_of(hit.section)
    table = bare(("", "left"), ("speed", "right"), ("torque", "right"), ("current", "right"), title="torque and speed")
    for name, *columns in _POINTS:
        cells = [figure(hit[c], schema[c]) if c else "0" for c in columns]
        table.add_row(name, *cells)
    return table


def _chart(hit: Hit, width: int) -> list[Text]:
    """Speed over torque; nothing where neither a line nor a continuous region is known."""
    torque, speed = (columns_of(hit.section)[name] for name in ("nominal_torque", "no_load_speed"))
    ends, curve = line(hit), continuous_curve(hit)
    reach = _reach(hit, ends, curve[0])
    drawn = _drawn(hit, ends, curve, reach)
    if all(one.mark for one in drawn):
        return []
    series = [
        one._replace(
            x=[from_si(M, torque.unit, torque.kind) for M in one.x],
            y=[from_si(w, speed.unit, speed.kind) for w in one.y],
        )
        for one in drawn
    ]
    level = Axis("torque", label(torque.unit), from_si(reach, torque.unit, torque.kind))
    upright = Axis("speed", label(speed.unit), max(y for one in series for y in one.y))
    return chart(series, level, upright, width, width // _HEIGHT)


def _reach(hit: Hit, ends: Line, continuous: Sequence[float]) -> float:
    """End of the torque axis [N*m]: stall, or less where stall is far beyond the nominal torque."""
    nominal = hit["nominal_torque"]
    if isnan(nominal):
        own = 0.0 if isnan(hit["no_load_current"]) else hit["no_load_current"]
        nominal = hit["torque_constant"] * (hit["nominal_current"] - own)
    cut = ends.torque * (1.0 - min(hit["max_speed"] / ends.speed, 1.0))  # where the line starts, at the top speed
    wanted = [x for x in (_READ * nominal, _READ * max(continuous, default=nan), 2.0 * cut) if x > 0.0]
    return min([*([max(wanted)] if wanted else []), *([] if isnan(ends.torque) else [ends.torque])], default=nan)


def _drawn(hit: Hit, ends: Line, curve: tuple[list[float], list[float]], reach: float) -> list[Series]:
    """Series of the chart in SI: the line, the continuous region, peak and nominal torque, as far as known."""
    schema, top, found = columns_of(hit.section), hit["max_speed"], []

    def shown(name: str) -> str:
        return figure(hit[name], schema[name])

    if not isnan(ends.torque):
        start = min(ends.speed, top) if top > 0.0 else ends.speed
        at = "nominal voltage" if isnan(hit["nominal_voltage"]) else shown("nominal_voltage")
        name = f"at {at}, winding at {_celsius(data_temperature(hit))}"
        name += ", computed from R, k_t and the no-load speed" if ends.computed else ""
        name += f"; cut at the permitted {shown('max_speed')}" if start < ends.speed else ""
        stall = figure(ends.torque, schema["stall_torque"])
        name += f"; stall, {stall}, is beyond the chart" if ends.torque > reach else ""
        found.append(Series(name, [0.0, ends.torque * (1.0 - start / ends.speed), ends.torque], [start, start, 0.0]))
    if curve[0]:
        found.append(
            Series(f"continuous, at {_celsius(rated_ambient(hit))} around the motor", *curve, gap=2, style="green")
        )
    peak = hit["peak_torque"]
    if peak <= reach and found:
        tallest = max(max(one.y) for one in found)
        found.append(Series("peak torque, for a short time", [peak, peak], [0.0, tallest], gap=4, style="yellow"))
    return [*found, *_nominal(hit, ends)]


def _celsius(temperature: Value) -> str:
    return show(float(temperature), "degC", "temperature")


def _nominal(hit: Hit, ends: Line) -> list[Series]:
    """The nominal point; on the line where its speed is unknown."""
    torque, speed = hit["nominal_torque"], hit["nominal_speed"]
    name = "nominal torque, on the line" if isnan(speed) else "nominal point"
    speed = ends.speed * (1.0 - torque / ends.torque) if isnan(speed) else speed
    return [] if isnan(torque + speed) else [Series(name, [torque], [speed], mark="●", style="green")]


# --- heat ------------------------------------------------------------------------------------------------------------


def _heat(out: Console, hit: Hit) -> None:
    """Print continuous current over ambient temperature and overload times at 25 degC, or what is missing for them."""
    ambients, overloads = _ambients(hit), _overloads(hit)
    found = [table for table in (ambients, overloads) if table]
    if found:
        out.print()
    if not found or not _beside(out, found):
        for table in found:
            out.print(table)
    if overloads:
        for note in _bounds(hit):
            out.print(Text(note))
    needed = [*(() if found else HEAT[:1]), *(() if overloads else (*HEAT[1:], *_SLOW))]
    missing = ", ".join(name.replace("_", " ") for name in needed if isnan(hit[name]))
    if missing:
        out.print(Text(f"{'overload' if found else 'heat'}: unknown without {missing}"))


def _ambients(hit: Hit) -> Table | None:
    """Continuous current; None where it is known at 25 degC only, which is among the figures."""
    currents = [permitted_current(hit, ambient) for ambient in _AMBIENTS]
    if all(map(isnan, currents[1:])):
        return None
    heads = [(show(ambient, "degC", "temperature"), "right") for ambient in _AMBIENTS]
    table = bare(("", "left"), *heads, title="continuous current by ambient (– not permitted)")
    if _AMBIENTS[-1] <= hit["ambient_max"] or isnan(hit["ambient_max"]):
        table.title = "continuous current by ambient"
    table.add_row("at standstill" if isnan(hit["nominal_current"]) else "nominal", *map(_amperes, currents))
    return table


def _overloads(hit: Hit) -> Table | None:
    """Overload times at a few currents; None where unknown."""
    currents = [permitted_current(hit, DATA_TEMPERATURE) * times for times in _OVERLOADS]
    times = [overload_times(hit, current) for current in currents]
    if isnan(currents[0] + times[0][0]):
        return None
    heads = [(f"{times:g} ×", "right") for times in _OVERLOADS]
    table = bare(("", "left"), *heads, title=f"overload at standstill, 25 °C, to {_limit(hit)}")
    table.add_row("current", *map(_amperes, currents))
    for name, row in zip(("from cold", "from warm"), zip(*times, strict=True), strict=True):
        if not isnan(row[0]):
            table.add_row(name, *map(_duration, row))
    return table


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


def _limit(hit: Hit) -> str:
    return show(hit["max_winding_temperature"], "degC", "temperature")


def _amperes(current: float) -> str:
    return "–" if isnan(current) else show(current, "A", "current", 3)


def _duration(time: float) -> str:
    """A time in its customary unit."""
    unit = "h" if time > 7200.0 else "min" if time > 120.0 else "s"
    return show(time, unit, "time", 3)
