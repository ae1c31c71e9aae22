"""Tables and line charts for the terminal: they fit 80 columns and use what there is."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import ceil, floor, isfinite, log10
from typing import NamedTuple

from rich.console import Console, RenderableType
from rich.measure import Measurement
from rich.rule import Rule
from rich.table import Table
from rich.text import Text

# -- Tables for the terminal: they fit 80 columns and use what there is.


_WIDTH = 80  # characters where a terminal does not say
STYLE = {"pass": "green", "fail": "bold red", "open": "yellow", "unknown": "yellow"}
MARK = {"pass": "pass", "fail": "FAIL", "open": "open", "unknown": "unknown"}


def console() -> Console:
    """The terminal that results go to."""
    terminal = Console(highlight=False, soft_wrap=False, emoji=False)
    if terminal.width < 1:  # COLUMNS=0, which rich takes as it is: the width is unknown
        terminal.width = _WIDTH
    return terminal


def width_of(table: RenderableType) -> int:
    """Width of a table that breaks no word [characters]."""
    wide = Console(width=1000, emoji=False)
    return Measurement.get(wide, wide.options, table).maximum


def heading(console: Console, name: str, right: str, style: str = "") -> None:
    """Print a heading and a rule; what is long stands below the name."""
    if len(right) > console.width // 2:
        console.print(Text(name, style="bold"), Text(right, style=style), Rule(style="dim"), sep="\n")
        return
    grid = Table.grid(expand=True)
    grid.add_column(overflow="fold")
    grid.add_column(justify="right", no_wrap=True)
    grid.add_row(Text(name, style="bold"), Text(right, style=style))
    console.print(grid)
    console.print(Rule(style="dim"))


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
    return lines + [line for curve in series for line in _legend(curve, width)]


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


def dots(curve: Series, reach: Point, size: tuple[int, int]) -> list[tuple[int, int]]:
    """The dots of a line, in order and each once."""
    most = float(size[0] - 1), float(size[1] - 1)
    at = [(a / reach[0] * most[0], b / reach[1] * most[1]) for a, b in zip(curve.x, curve.y, strict=True)]
    steps = (dot for a, b in pairwise(at) for dot in _segment(a, b, most))
    return list(dict.fromkeys(steps))[:: curve.gap]


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
    characters: dict[tuple[int, int], tuple[str, str]] = {}  # character and style of a cell
    for curve in series:
        for x, y in [] if curve.mark else dots(curve, reach, (2 * columns, 4 * rows)):
            before = characters.get((x // 2, y // 4), (chr(_BLANK), ""))[0]
            bits = ord(before) if ord(before) >= _BLANK else _BLANK  # a dot takes the place of a mark
            characters[x // 2, y // 4] = chr(bits | _BITS[x % 2][y % 4]), curve.style
        for a, b in zip(curve.x, curve.y, strict=True) if curve.mark else ():
            if 0.0 <= a <= reach[0] and 0.0 <= b <= reach[1]:
                characters[_cell(a, reach[0], columns, 2), _cell(b, reach[1], rows, 4)] = curve.mark, curve.style
    lines = [Text() for _ in range(rows)]
    for row, text in enumerate(lines):
        for column in range(columns):
            text.append(*characters.get((column, row), (" ", "")))
    return lines


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


def _legend(curve: Series, width: int) -> Iterator[Text]:
    """A piece of the line, or its mark, and its name."""
    places = {n for n in range(4) if n % curve.gap == 0}
    cells = [sum(_BITS[n % 2][2] for n in places if n // 2 == cell) for cell in range(2)]
    piece = curve.mark or "".join(chr(_BLANK + bits) if bits else " " for bits in cells)
    for n, text in enumerate(textwrap.wrap(curve.name, max(width - 3, _NARROW))):
        yield Text(f"{piece if n == 0 else '':<3}", style=curve.style).append(text, style="default")


def _digits(tick: float) -> str:
    return f"{tick:.10g}"
