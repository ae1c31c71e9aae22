"""Tables and line charts for the terminal: they fit 80 columns and use what there is."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from math import ceil, floor, isfinite, isnan, log10
from typing import TYPE_CHECKING, Any, NamedTuple

from rich import box
from rich.console import Console, RenderableType
from rich.measure import Measurement
from rich.rule import Rule
from rich.table import Table
from rich.text import Text

from drivesizer.catalog import Catalog, columns_of
from drivesizer.output.tables import required_rows
from drivesizer.output.words import LESS, about, confidences, not_quoted
from drivesizer.results.check_kinds import missing_figures
from drivesizer.results.drive_set import DriveSet, Requirement, made_by, section_of
from drivesizer.results.sizing import Check, Figure, unknown_parts
from drivesizer.spec.drive import OBJECTIVES
from drivesizer.spec.robot import AS_SPECIFIED
from drivesizer.units import label, show

if TYPE_CHECKING:
    from drivesizer.control.validation import Validation

__all__ = [
    "MARK", "STYLE", "Axis", "Series", "bare", "chart", "checks", "console", "dots", "gains", "heading", "loose",
    "missing", "objective", "parts", "percent", "plain", "required", "requirements", "ticks", "tried",
    "width_of",
]  # fmt: skip


# -- Tables for the terminal: they fit 80 columns and use what there is.


_WIDTH = 80  # characters where a terminal does not say
_ALIKE = 0.01  # of a margin, within which it is that of two figures
_CLOSE = 0.2  # least margin at the ends of the band of estimates, below which the band is shown
STYLE = {"pass": "green", "fail": "bold red", "open": "yellow", "unknown": "yellow"}
MARK = {"pass": "pass", "fail": "FAIL", "open": "open", "unknown": "unknown"}


def console() -> Console:
    """The terminal that results go to."""
    shown = Console(highlight=False, soft_wrap=False, emoji=False)
    if shown.width < 1:  # COLUMNS=0, which rich takes as it is: the width is unknown
        shown.width = _WIDTH
    return shown


def tried(proof: Validation, of: str = "") -> Table:
    """Changes that were simulated on a drive that fails in its loop."""
    from drivesizer.output.loop_table import remedies  # with what a sizing need not load

    title, rows = remedies(proof)
    heads = ("change", "left"), ("entered as", "left"), ("tightest", "left"), ("", "left")
    table = bare(*heads, title=f"{of}{title}")
    for *cells, status in rows:
        table.add_row(*map(Text, cells), Text(MARK[status], style=STYLE[status]))
    return table


def bare(*columns: tuple[str, str], title: str = "", headed: bool = True, edged: bool = True) -> Table:
    """A plain table."""
    table = Table(box=box.SIMPLE_HEAD, title=title or None, title_justify="left", title_style="bold", pad_edge=False,
                  padding=(0, 2, 0, 0), show_header=headed, show_edge=edged)  # fmt: skip
    for header, justify in columns:
        table.add_column(header, justify=justify, overflow="fold")  # type: ignore[arg-type]
    return table


def width_of(table: RenderableType) -> int:
    """Width of a table that breaks no word [characters]."""
    wide = Console(width=1000, emoji=False)
    return Measurement.get(wide, wide.options, table).maximum


def percent(margin: float) -> str:
    """A margin as a share, or as a multiple where it is large.

    >>> percent(0.213), percent(11.0)
    ('+21 %', '×12')
    """
    if isnan(margin):
        return "–"
    return f"{100 * margin:+.0f} %" if abs(margin) < 10 else f"×{margin + 1:.0f}"


def heading(console: Console, name: str, right: str, style: str = "") -> None:
    """Print a heading and a rule."""
    grid = Table.grid(expand=True)
    grid.add_column(overflow="fold")
    grid.add_column(justify="right", no_wrap=True)
    grid.add_row(Text(name, style="bold"), Text(right, style=style))
    console.print(grid)
    console.print(Rule(style="dim"))


def requirements(requirements: Iterable[Requirement], title: str) -> Table:
    """Requirements with their equation numbers."""
    table = bare(("eq.", "right"), ("", "left"), ("", "left"), ("", "right"), title=title, headed=False)
    for r in requirements:
        number = f"({r.equation})" if r.equation else ""
        table.add_row(number, r.symbol, Text(r.title + (", given" if r.note.startswith("given") else "")), r.text)
    return table


def checks(checks: Iterable[Check], title: str, *, edged: bool = True) -> Table:
    """Checks: demand, limit, margin, verdict, and the worst instant where one is known."""
    checks = list(checks)
    timed = any(check.at_time is not None for check in checks)
    worst_in = {check.case for check in checks} - {AS_SPECIFIED}
    if len(worst_in) == 1 and len(checks) > 1 and "" not in worst_in:
        title += f", worst in {worst_in.pop()}"
    columns = [("check", "left"), ("demand", "right"), ("limit", "right"), ("margin", "right"), ("", "left")]
    table = bare(*columns, *([("at", "right")] if timed else []), title=title, edged=edged)
    for check in checks:
        status = Text(MARK[check.status], style="dim" if check.advice else STYLE[check.status])
        figures = [plain(check, check.demand), plain(check, check.limit)]
        when = [_seconds(check.at_time)] if timed else []
        where = f" ({check.case})" if check.case in worst_in and check.case else ""
        needed = f"\nneeds {percent(check.needed)}" if check.needed and not isnan(check.margin) else ""
        reason = f"\n{check.note}" if check.note and isnan(check.demand) and isnan(check.limit) else ""
        table.add_row(Text(check.title + where + reason), *figures, percent(check.margin) + needed, status, *when)
        if check.band and check.status in ("open", "pass") and check.band.least_margin < _CLOSE:
            worst = _worst_end(check)
            table.add_row(Text("  at worst, by estimates", style="dim"), *worst, percent(check.band.least_margin), "")
    return table


def required(found: DriveSet) -> Table | None:
    """Requirements on the machine with what is reached, its margin and the verdict; None where the spec has none."""
    rows = required_rows(found)
    if not rows:
        return None
    heads = [("requirement", "left"), ("required", "right"), ("reached", "right"), ("margin", "right"), ("", "left")]
    table = bare(*heads, title="Requirements", edged=False)
    for row in rows:
        check = row.check
        where = f" ({check.case})" if check.case not in ("", AS_SPECIFIED) else ""
        bound = "≤" if row.bound == "at most" else "≥"
        figures = f"{bound} {check.shown(row.required)}", check.shown(row.reached), percent(check.margin)
        note = f"\n{check.note}" if check.note else ""
        table.add_row(Text(check.title + where + note), *figures, Text(MARK[check.status], style=STYLE[check.status]))
    return table


def _worst_end(check: Check) -> tuple[str, str]:
    """Demand and limit at the unfavourable end; nothing where the limit is estimated too, and moves with the demand."""
    high, limit, least = check.band.high, check.limit, check.band.least_margin  # type: ignore[union-attr]
    alike = high > 0.0 and abs(limit / high - 1.0 - least) < _ALIKE
    return (plain(check, high), plain(check, limit)) if alike else ("", "")


def _seconds(time: float | None) -> str:
    """A moment to three digits, in whole seconds where there are more.

    >>> _seconds(3600.0), _seconds(0.12345)
    ('3600 s', '0.123 s')
    """
    return "" if time is None else f"{time:.0f} s" if time >= 1000.0 else f"{time:.3g} s"


def hanging(found: DriveSet) -> list[str]:
    """Estimated figures of a drive's open checks: a line for each check, with the probability that it passes."""
    return [
        f"open: {check.title} {check.note}" + (f" ({about(check.probability)})" if about(check.probability) else "")
        for check in found.deciding
        if check.status == "open"
    ]


def missing(found: DriveSet) -> list[Text]:
    """A line with what the unknown checks of a drive lack; none without."""
    names = missing_figures(found)
    return [Text(f"missing: {', '.join(names)}", style=STYLE["unknown"])] if names else []


def plain(check: Check, figure: float) -> str:
    """Demand or limit as text; empty for a condition without figures."""
    if isnan(check.demand) and isnan(check.limit) and check.status != "unknown":
        return ""
    return check.shown(figure)


_PULLEY = {"teeth": "teeth", "mass": "", "price": ""}
_PARTS: dict[str, dict[str, str]] = {  # columns of the catalogue, and the words behind each
    "motor": {"assigned_power": "", "nominal_voltage": "", "holding_torque": "holding", "mass": "", "price": ""},
    "gearhead": {"efficiency": "efficient", "mass": "", "price": ""},
    "brake": {"static_torque": "static", "supply": "", "mass": "", "price": ""},
    "encoder": {},
    "controller": {"continuous_current": "continuous", "peak_current": "peak"},
    "driving pulley": _PULLEY,
    "belt": {"teeth": "teeth", "width": "wide", "mass": "", "price": ""},
    "driven pulley": _PULLEY,
    "screw": {"dynamic_load": "dynamic", "static_load": "static", "efficiency": "efficient", "mass": "", "price": ""},
    "actuator": {"nominal_voltage": "", "nominal_torque": "continuous", "peak_torque": "peak", "mass": "", "price": ""},
}


def parts(found: DriveSet, catalog: Catalog) -> Table:
    """The drive, part by part, with the figures that are not quoted from the maker."""
    table = bare(("", "left"), ("", "left"), ("", "left"), headed=False)
    for role, part in found.parts.items():
        if part is None:
            why = found.without_controller if role == "controller" else ""
            table.add_row(role, Text("unknown", style="yellow"), why or "none is listed for this motor")
        else:
            table.add_row(role, *_part(role, part, catalog, found))
        if role == "motor" and "gearhead" not in found.parts:
            table.add_row("gearhead", Text("none", style="bold"), "the motor drives the load itself")
        if role in ("gearhead", "actuator") or ("gearhead" not in found.parts and role == "motor"):
            _belt(table, found)
    return table


def _part(role: str, part: Any, catalog: Catalog, found: DriveSet) -> tuple[Text, Text]:
    """Name and number of a part; its main figures and their confidence."""
    reduction = f" {part.reduction}" if role in ("gearhead", "actuator") else ""
    columns = columns_of(section_of(part))
    values = [(getattr(part, name), columns[name], words) for name, words in _PARTS[role].items()]
    shown = [f"{show(value, c.unit, c.kind)} {words}".strip() for value, c, words in values if not isnan(value)]
    if role == "encoder":
        shown = [part.resolution]
    if role == "motor" and part.controller:
        shown.append(f"{part.controller} inside")
    if role == "belt":
        shown += found.belt_running
    if role == "screw" and found.chosen_screw:
        shown = [found.chosen_screw.running, *shown]
    if section_of(part) == "pulleys" and part.bore:
        shown.append(f"bore {part.bore}")
    doubt = _doubt(part, role, found, catalog)
    text = Text(" · ".join(shown)) + (Text(f"\n{doubt}", style="yellow") if doubt else Text(""))
    name = made_by(part) if len(catalog.digests) > 1 else part.family  # the maker is obvious with one catalogue
    return Text(f"{name}{reduction}", style="bold") + Text(f"\n{part.part}"), text


def _belt(table: Table, found: DriveSet) -> None:
    """Add the belt where only its ratio is known."""
    if found.belt_ratio != 1.0 and not found.belt_drive:
        efficient = show(found.belt_efficiency, "%", "dimensionless") + " efficient"
        table.add_row("belt", f"{found.belt_ratio:g}", efficient)


def _doubt(part: Any, role: str, found: DriveSet, catalog: Catalog) -> str:
    """Number of figures that are not from the maker's own document; the least certain ones by name."""
    figures = not_quoted(part, role, found, catalog)
    doubts = []
    for level in LESS:
        names = [name.replace("_", " ") for name, value in figures.items() if value == level]
        if names and level == "secondary":
            doubts.append(f"{len(names)} of {len(confidences(part, role, found, catalog))} figures secondary")
        elif names:
            more = f" and {len(names) - 4} more" if len(names) > 5 else ""
            doubts.append(f"{level}: {', '.join(names[: 4 if more else 5])}{more}")
    return "; ".join(doubts)


def objective(found: DriveSet, name: str) -> str:
    """The figure that ranked a drive, and of which parts it is alone where those of others are unknown."""
    if name == "margin":
        return percent(found.objective)
    if name not in OBJECTIVES:
        return f"{found.objective:.4g}"
    declared = OBJECTIVES[name]
    text = show(found.objective, declared.unit, declared.kind)
    lacks = declared.over and unknown_parts(found, name, found.objective_of)
    return f"{text}\n({' and '.join(found.objective_of)} only)" if lacks and found.objective_of else text


def loose(figures: Iterable[Figure], title: str) -> Table:
    """Figures without a limit."""
    table = bare(("", "left"), ("", "right"), ("", "right"), title=title, headed=False)
    for figure in figures:
        when = f"at {figure.at_time:.4g} s" if figure.at_time is not None else ""
        table.add_row(figure.title, figure.text, when)
    return table


def gains(proof: Validation) -> Table:
    """The controller's gains in SI, and in its own units where they are known."""
    from drivesizer.output.loop_table import gain_rows  # with what a sizing need not load

    table = bare(("", "left"), ("", "right"), title=f"{proof.set_up}: {proof.gains.rule}", headed=False)
    for row in gain_rows(proof.gains):
        table.add_row(row.title, f"{row.value:.4g} {label(row.unit)}")
    for gain in proof.controller_gains:
        table.add_row(f"{gain.place} {gain.name}", f"{gain.value} {gain.unit}")
    return table


# -- A line chart for the terminal, of braille characters: 2 x 4 dots to a cell.
#
# Both axes run from 0 to a given end, with ticks at round figures. Lines differ by the gap between their dots, or
# have a mark, so that they differ without colour. Dots are counted from the lower left of the field.


_BITS = ((0x40, 0x04, 0x02, 0x01), (0x80, 0x20, 0x10, 0x08))  # of a cell's dots: column, from the lowest up
_BLANK = 0x2800
_NARROW = 8  # cells that the field keeps, however little room there is
_PER_TICK = 2, 12  # rows and columns of cells to a tick, about

Point = tuple[float, float]


class Axis(NamedTuple):
    """Quantity along an axis, from 0 to an end above it."""

    name: str
    unit: str
    end: float


class Series(NamedTuple):
    """Points joined by a line of dots, or a mark at each; a figure that is not finite leaves a gap."""

    name: str
    x: Sequence[float]
    y: Sequence[float]
    gap: int = 1  # of the line's dots one in so many is drawn
    mark: str = ""  # a character
    style: str = ""


def chart(series: Sequence[Series], x: Axis, y: Axis, width: int = 80, height: int = 12) -> list[Text]:
    """A chart as lines of text: name of the upright axis, field, ticks, name of the level axis, legend."""
    reach = x.end, y.end
    upright = ticks(y.end, height // _PER_TICK[0])
    margin = max(len(_digits(tick)) for tick in upright) + 1
    columns = max(width - margin - 1, _NARROW)
    level = ticks(x.end, columns // _PER_TICK[1])
    field = _field(series, reach, (columns, height))
    labels = {_cell(tick, y.end, height, 4): _digits(tick) for tick in upright}
    lines = [Text(f"{y.name} [{y.unit}]", style="dim")]
    for row in reversed(range(height)):
        edge = f"{labels.get(row, ''):>{margin - 1}} {'┤' if row in labels else '│'}"
        lines.append(Text(edge, style="dim").append_text(field[row]))
    lines += [Text(" " * margin + line, style="dim") for line in _foot(level, x.end, columns)]
    lines.append(Text(f"{x.name} [{x.unit}]".rjust(margin + 1 + columns), style="dim"))
    return lines + [line for one in series for line in _legend(one, width)]


def ticks(end: float, count: int) -> list[float]:
    """Round figures from 0 up to an end: steps of 1, 2 or 5 times a power of ten.

    Examples
    --------

    >>> ticks(243.0, 5)
    [0.0, 50.0, 100.0, 150.0, 200.0]
    """
    least = end / max(count, 3)
    power = 10.0 ** floor(log10(least))
    step = power * next(n for n in (1, 2, 5, 10) if n * power >= least * (1.0 - 1e-9))
    return [n * step for n in range(floor(end / step + 1e-9) + 1)]


def dots(one: Series, reach: Point, size: tuple[int, int]) -> list[tuple[int, int]]:
    """The dots of a line, in order and each once."""
    most = float(size[0] - 1), float(size[1] - 1)
    at = [(a / reach[0] * most[0], b / reach[1] * most[1]) for a, b in zip(one.x, one.y, strict=True)]
    steps = (dot for a, b in pairwise(at) for dot in _segment(a, b, most))
    return list(dict.fromkeys(steps))[:: one.gap]


def _segment(a: Point, b: Point, most: Point) -> Iterator[tuple[int, int]]:
    """The dots between two points, as far as they lie within the field."""
    ends = _clipped(a, b, most)
    if ends is None:
        return
    (x, y), (to_x, to_y) = ends
    steps = max(ceil(abs(to_x - x)), ceil(abs(to_y - y)), 1)
    for n in range(steps + 1):
        yield floor(x + (to_x - x) * n / steps + 0.5), floor(y + (to_y - y) * n / steps + 0.5)


def _clipped(a: Point, b: Point, most: Point) -> tuple[Point, Point] | None:
    """The part of a straight line between 0 and the most in both directions; None where there is none."""
    low, high = 0.0, 1.0
    for start, end, limit in zip(a, b, most, strict=True):
        if not (isfinite(start) and isfinite(end)) or (start == end and not 0.0 <= start <= limit):
            return None
        if start != end:
            first, last = sorted((-start / (end - start), (limit - start) / (end - start)))
            low, high = max(low, first), min(high, last)
    if low > high:
        return None
    part = [(a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t) for t in (low, high)]
    return part[0], part[1]


def _field(series: Sequence[Series], reach: Point, cells: tuple[int, int]) -> list[Text]:
    """The rows of the field, from the lowest up."""
    columns, rows = cells
    shown: dict[tuple[int, int], tuple[str, str]] = {}  # character and style of a cell
    for one in series:
        for x, y in [] if one.mark else dots(one, reach, (2 * columns, 4 * rows)):
            before = shown.get((x // 2, y // 4), (chr(_BLANK), ""))[0]
            bits = ord(before) if ord(before) >= _BLANK else _BLANK  # a dot takes the place of a mark
            shown[x // 2, y // 4] = chr(bits | _BITS[x % 2][y % 4]), one.style
        for a, b in zip(one.x, one.y, strict=True) if one.mark else ():
            if 0.0 <= a <= reach[0] and 0.0 <= b <= reach[1]:
                shown[_cell(a, reach[0], columns, 2), _cell(b, reach[1], rows, 4)] = one.mark, one.style
    found = [Text() for _ in range(rows)]
    for row, text in enumerate(found):
        for column in range(columns):
            text.append(*shown.get((column, row), (" ", "")))
    return found


def _cell(value: float, reach: float, cells: int, per_cell: int) -> int:
    """The cell in which a figure lies along an axis."""
    return floor(value / reach * (cells * per_cell - 1) + 0.5) // per_cell


def _foot(level: Sequence[float], end: float, columns: int) -> list[str]:
    """The level axis with its ticks, and the figures below them, as far as they have room."""
    places = {_cell(tick, end, columns, 2): _digits(tick) for tick in level}
    figures = ""
    for place, text in places.items():
        start = min(max(place + 1 - len(text) // 2, 0), columns + 1 - len(text))
        if start > len(figures) or not figures:
            figures = figures.ljust(start) + text
    return ["└" + "".join("┬" if n in places else "─" for n in range(columns)), figures]


def _legend(one: Series, width: int) -> Iterator[Text]:
    """A piece of the line, or its mark, and its name."""
    drawn = {n for n in range(4) if n % one.gap == 0}
    cells = [sum(_BITS[n % 2][2] for n in drawn if n // 2 == cell) for cell in range(2)]
    piece = one.mark or "".join(chr(_BLANK + bits) if bits else " " for bits in cells)
    for n, text in enumerate(textwrap.wrap(one.name, max(width - 3, _NARROW))):
        yield Text(f"{piece if n == 0 else '':<3}", style=one.style).append(text, style="default")


def _digits(tick: float) -> str:
    return f"{tick:.10g}"
