"""Sketches of the kinds of load with their symbols, as SVG: the machine in a few lines, in one style."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from math import cos, hypot, sin
from typing import Any

from drivesizer.files.yaml_source import shipped_data
from drivesizer.units import label

_WIDTH, _HEIGHT = 460, 204
_LONGEST = 34  # letters beside a symbol, as wide as their column
_INKS = {"black": "#000000", "soft": "#555555", "force": "#D55E00", "motion": "#0072B2"}
_FONT = "font-family: 'DejaVu Sans', sans-serif"

Point = tuple[float, float]

_SPRINGS = {"constant": "F", "linear": "c", "torsion": "c", "gas": "F", "counterweight": "m"}  # symbol of each kind
_USUAL_PLACE = 452.0, 4.0  # of springs, at the upper right
_SPIRAL = [n / 6 for n in range(6, 64)]
_FRAME: list[list[Point]] = [[(44, 3), (44, 23)], *([(44.0, y), (49.0, y - 5.0)] for y in (8.0, 13.0, 18.0, 23.0))]
_MARKS: dict[str, list[list[Point]]] = {  # of what is beside the drive: lines, the load's end at the left
    "constant": [*_FRAME, [(0, 19), (34, 19)], [(34 + 6 * cos(a / 4), 13 + 6 * sin(a / 4)) for a in range(26)]],
    "linear": [*_FRAME, [(0, 13), (6, 13), *((9 + 5 * n, 8 + 10 * (n % 2)) for n in range(6)), (37, 13), (44, 13)]],
    "torsion": [*_FRAME, [(30, 13), (44, 13)], [(20 + a * cos(1.5 * a), 13 + a * sin(1.5 * a)) for a in _SPIRAL]],
    "gas": [*_FRAME, [(0, 13), (26, 13)], [(26, 9), (26, 17)], [(14, 8), (40, 8), (40, 18), (14, 18), (14, 8)],
            [(40, 13), (44, 13)]],
    "counterweight": [[(2, 24), (2, 6), (26, 6), (26, 12)], [(17, 12), (35, 12), (35, 24), (17, 24), (17, 12)]],
}  # fmt: skip


def _lowered(symbol: str) -> str:
    base, _, index = symbol.partition("_")
    low = f'<tspan dy="3" style="font-size: 8px">{escape(index)}</tspan><tspan dy="-3">\u200a</tspan>'
    return escape(base) + (low if index else "")


class Pen:
    """Lines, arrows and labels of a sketch; below it the symbols in words, with what was entered for them."""

    def __init__(self, entered: Mapping[str, object] | None) -> None:
        self.entered = entered
        self.parts: list[str] = []
        self.legend: list[tuple[str, str]] = []  # symbols and their fields
        self.of_springs: dict[str, str] = {}  # words of their symbols

    def has(self, *fields: str) -> bool:
        """Whether a field is drawn: all of a sketch without figures, else those that were entered."""
        return self.entered is None or any(self.entered.get(name) is not None for name in fields)

    def line(
        self, *points: Point, ink: str = "black", wide: float = 1.2, dashed: bool = False, fill: str = "none",
        field: str = "",
    ) -> None:  # fmt: skip
        """A line through points; one that belongs to a field only where that was entered."""
        if field and not self.has(field):
            return
        dashes = "; stroke-dasharray: 5 3" if dashed else ""
        coordinates = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        look = f"fill: {_INKS.get(fill, fill)}; stroke: {_INKS[ink]}; stroke-width: {wide:g}{dashes}"
        self.parts.append(f'<polyline points="{coordinates}" style="{look}"/>')

    def row(self, count: int, step: float, *points: Point, **look: Any) -> None:
        """A line several times, each so far to the right of the one before."""
        for n in range(count):
            self.line(*((x + step * n, y) for x, y in points), **look)

    def circle(self, x: float, y: float, radius: float, fill: str = "none") -> None:
        """A circle."""
        look = f"fill: {fill}; stroke: {_INKS['black']}; stroke-width: 1.2"
        self.parts.append(f'<circle cx="{x:g}" cy="{y:g}" r="{radius:g}" style="{look}"/>')

    def box(self, x: float, y: float, width: float, height: float, fill: str = "#e8eaed", field: str = "") -> None:
        """A body."""
        corners = (x, y), (x + width, y), (x + width, y + height), (x, y + height), (x, y)
        self.line(*corners, fill=fill, field=field)

    def arrow(self, start: Point, end: Point, ink: str = "force") -> None:
        """A straight arrow."""
        (x, y), (to_x, to_y) = start, end
        length = hypot(to_x - x, to_y - y)
        u, v = (to_x - x) / length, (to_y - y) / length
        self.line(start, (to_x - 6 * u, to_y - 6 * v), ink=ink, wide=1.6)
        left, right = ((to_x - 8 * u - side * 3.5 * v, to_y - 8 * v + side * 3.5 * u) for side in (-1, 1))
        self.line(end, left, right, end, ink=ink, wide=0.8, fill=ink)

    def turning(self, x: float, y: float, radius: float, *, start: float = 3.7, end: float = 5.7) -> None:
        """The forward motion around an axis, between two angles."""
        angles = [start + (end - start) * n / 16 for n in range(17)]
        points = [(x + radius * cos(a), y + radius * sin(a)) for a in angles]
        self.line(*points[:-1], ink="motion", wide=1.6)
        (a, b), (c, d) = points[-2:]
        self.arrow((a, b), (c + 0.7 * (c - a), d + 0.7 * (d - b)), "motion")

    def size(
        self, start: Point, end: Point, symbol: str, *fields: str, shift: Point = (0.0, -5.0), field: str = ""
    ) -> None:
        """A dimension line with its symbol."""
        if field and not self.has(field):
            return
        self.line(start, end, ink="soft", wide=0.8)
        (x, y), (to_x, to_y) = start, end
        length = hypot(to_x - x, to_y - y)
        u, v = -3.0 * (to_y - y) / length, 3.0 * (to_x - x) / length
        for a, b in (start, end):
            self.line((a - u, b - v), (a + u, b + v), ink="soft", wide=0.8)
        self.label((x + to_x) / 2 + shift[0], (y + to_y) / 2 + shift[1], symbol, *fields, at="middle")

    def label(self, x: float, y: float, symbols: str, *fields: str, at: str = "start", ink: str = "black") -> None:
        """Symbols, each with a lowered index behind its underscore; none of fields that are not given.

        One symbol stands for the first of its fields that is given, several for a field each.
        """
        names = symbols.split(", ")
        of = fields if len(names) == len(fields) else [next(filter(self.has, fields), "")] if fields else [""]
        pairs = [(name, field) for name, field in zip(names, of, strict=True) if not fields or self.has(field)]
        if not pairs:
            return
        self.legend += [pair for pair in pairs if pair[1]]
        look = f"{_FONT}; font-size: 11px; font-style: italic; fill: {_INKS[ink]}; text-anchor: {at}"
        text = ", ".join(_lowered(name) for name, _ in pairs)
        self.parts.append(f'<text x="{x:.1f}" y="{y:.1f}" style="{look}">{text}</text>')

    def names(self) -> int:
        """The symbols in words below the drawing, in two columns; how many lines they take."""
        for n, (symbol, field) in enumerate(self.legend):
            value = self.of_springs.get(symbol, (self.entered or {}).get(field))
            text = ", ".join(map(str, value.values())) if isinstance(value, Mapping) else "" if value is None else value
            x, y = 20 + _WIDTH // 2 * (n % 2), _HEIGHT + 14 * (n // 2)
            look = f"{_FONT}; font-size: 9px; fill: {_INKS['black']}"
            self.parts.append(f'<text x="{x}" y="{y}" style="{look}; font-style: italic">{_lowered(symbol)}</text>')
            words = f"{field.replace('_', ' ')} {label(str(text))}".rstrip()
            words = words if len(words) <= _LONGEST else f"{words[: _LONGEST - 1]}…"
            self.parts.append(f'<text x="{x + 26}" y="{y}" style="{look}">{escape(words)}</text>')
        return -(-len(self.legend) // 2)

    def floor(self, x: float, to_x: float, y: float) -> None:
        """Solid ground, hatched below."""
        self.line((x, y), (to_x, y))
        self.row(int((to_x - x) // 10), 10, (x + 6, y), (x, y + 6), ink="soft", wide=0.6)

    def wheel(self, x: float, y: float, radius: float, hub: float = 2) -> None:
        """A wheel, pulley or drum with its axis."""
        self.circle(x, y, radius, fill="#ffffff")
        self.circle(x, y, hub, fill=_INKS["black"])

    def motor(self, x: float, y: float, *shaft: Point) -> None:
        """The motor and its gearhead, whose shaft goes to the right, by some points."""
        self.box(x, y - 14, 34, 28, fill="#cfe3f1")
        self.box(x + 34, y - 11, 16, 22, fill="#cfe3f1")
        self.label(x + 17, y + 4, "M", at="middle")
        if shaft:
            self.line((x + 50, y), *shaft, wide=2.5)

    def force(self, start: Point, end: Point, symbol: str, *fields: str, shift: Point = (4.0, -4.0)) -> None:
        """A force where its field is given."""
        if self.has(*fields):
            self.arrow(start, end)
            self.label(end[0] + shift[0], end[1] + shift[1], symbol, *fields, ink="force")

    def moves(self, start: Point, end: Point, symbol: str = "v") -> None:
        """The forward motion."""
        self.arrow(start, end, "motion")
        self.label(end[0] + 4, end[1] + 4, symbol, ink="motion")

    def inclined(self, x: float, y: float, symbol: str, field: str) -> None:
        """The angle of the way against the level."""
        if self.has(field):
            self.line((x, y), (x + 66, y), ink="soft", wide=0.8, dashed=True)
            self.line((x, y), (x + 60, y - 20), ink="soft", wide=0.8)
            self.label(x + 70, y - 4, symbol, field)

    def guided(self, x: float, y: float) -> None:
        """A slide on its guide, with the forces along it."""
        self.box(x, y - 34, 90, 34)
        self.label(x + 45, y - 13, "m", "mass", at="middle")
        self.moves((x + 94, y - 26), (x + 130, y - 26))
        self.force((x - 2, y - 26), (x - 38, y - 26), "F_0", "force", shift=(-12.0, -6.0))
        friction = ("friction_coefficient", "friction_force")
        self.force((x - 2, y - 6), (x - 26, y - 6), "μ, F_f", *friction, shift=(-36.0, 4.0))

    def springs(self, x: float, y: float) -> None:
        """Springs and counterweights between load and frame: a mark each, from a place to the left."""
        entries = (self.entered or {}).get("springs")
        springs = [entry for entry in entries if isinstance(entry, Mapping)] if isinstance(entries, list) else []
        for number, spring in enumerate(springs, 1):
            kind = str(spring.get("kind"))
            if kind not in _MARKS:
                continue
            symbol, left = f"{_SPRINGS[kind]}_{number if len(springs) > 1 else 's'}", x - 62 * number
            first = next(
                (f", {value}" for key, value in spring.items() if key != "kind" and isinstance(value, str)), ""
            )
            self.of_springs[symbol] = f"{kind}{first}"
            self.legend.append((symbol, "springs"))
            if left < 0:  # the words below name it
                continue
            for points in _MARKS[kind]:
                self.line(*((left + dx, y + dy) for dx, dy in points), ink="force")
            self.label(left + 22, y + 36, symbol, at="middle", ink="force")


SKETCHES: dict[str, list[dict[str, list[Any]]]] = shipped_data("drivesizer.output", "sketches.yaml")
"""Drawing of each kind of load: strokes of the pen by their names."""


def _pen_of(kind: str, entered: Mapping[str, object] | None) -> Pen:
    pen = Pen(entered)
    for stroke in SKETCHES[kind]:
        for name, arguments in stroke.items():
            look = arguments[-1] if isinstance(arguments[-1], dict) else {}
            getattr(pen, name)(*(arguments[:-1] if look else arguments), **look)
    if not any("springs" in stroke for stroke in SKETCHES[kind]):
        pen.springs(*_USUAL_PLACE)
    return pen


def symbols(kind: str) -> dict[str, str]:
    """Symbols of a sketch by the fields of its load.

    >>> symbols("flywheel")
    {'inertia': 'J', 'friction_torque': 'T_f'}
    """
    return {field: symbol for symbol, field in _pen_of(kind, None).legend if symbol != field}


def sketch(kind: str, entered: Mapping[str, object] | None = None) -> bytes:
    """A kind of load with its symbols as SVG.

    >>> sketch("hoist")[:4], b"drum diameter 9 cm" in sketch("hoist", {"drum_diameter": "9 cm"})
    (b'<svg', True)
    """
    pen = _pen_of(kind, entered)
    size = _WIDTH, _HEIGHT + 14 * pen.names()
    head = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{0}" height="{1}">'.format(*size)
    return f"{head}{''.join(pen.parts)}</svg>\n".encode()
