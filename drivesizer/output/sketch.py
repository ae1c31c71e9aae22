"""Sketches of the kinds of load with their symbols, as SVG: the machine in a few lines, in one style."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from html import escape
from math import cos, hypot, pi, sin

_WIDTH, _HEIGHT = 460, 204
_LONGEST = 40  # letters beside a symbol
_INK, _SOFT, _FORCE, _MOTION = "#000000", "#555555", "#D55E00", "#0072B2"
_FONT = "font-family: 'DejaVu Sans', sans-serif"

Point = tuple[float, float]


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

    def has(self, *fields: str) -> bool:
        """Whether a field is drawn: all of a sketch without figures, else those that were entered."""
        return self.entered is None or any(self.entered.get(name) is not None for name in fields)

    def line(
        self, *points: Point, ink: str = _INK, wide: float = 1.2, dashed: bool = False, fill: str = "none"
    ) -> None:
        """A line through points."""
        dashes = "; stroke-dasharray: 5 3" if dashed else ""
        shown = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        look = f"fill: {fill}; stroke: {ink}; stroke-width: {wide:g}{dashes}"
        self.parts.append(f'<polyline points="{shown}" style="{look}"/>')

    def circle(self, x: float, y: float, radius: float, ink: str = _INK, *, fill: str = "none") -> None:
        """A circle."""
        look = f"fill: {fill}; stroke: {ink}; stroke-width: 1.2"
        self.parts.append(f'<circle cx="{x:g}" cy="{y:g}" r="{radius:g}" style="{look}"/>')

    def box(self, x: float, y: float, width: float, height: float, *, fill: str = "#e8eaed") -> None:
        """A body."""
        self.line((x, y), (x + width, y), (x + width, y + height), (x, y + height), (x, y), fill=fill)

    def arrow(self, start: Point, end: Point, ink: str = _FORCE) -> None:
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
        self.line(*points[:-1], ink=_MOTION, wide=1.6)
        (a, b), (c, d) = points[-2:]
        self.arrow((a, b), (c + 0.7 * (c - a), d + 0.7 * (d - b)), _MOTION)

    def size(self, start: Point, end: Point, symbol: str, *fields: str, off: Point = (0.0, -5.0)) -> None:
        """A dimension line with its symbol."""
        self.line(start, end, ink=_SOFT, wide=0.8)
        (x, y), (to_x, to_y) = start, end
        length = hypot(to_x - x, to_y - y)
        u, v = -3.0 * (to_y - y) / length, 3.0 * (to_x - x) / length
        for a, b in (start, end):
            self.line((a - u, b - v), (a + u, b + v), ink=_SOFT, wide=0.8)
        self.label((x + to_x) / 2 + off[0], (y + to_y) / 2 + off[1], symbol, *fields, at="middle")

    def label(self, x: float, y: float, symbols: str, *fields: str, at: str = "start", ink: str = _INK) -> None:
        """Symbols, each with a lowered index behind its underscore; none of fields that are not given.

        One symbol stands for the first of its fields that is given, several for a field each.
        """
        names = symbols.split(", ")
        of = fields if len(names) == len(fields) else [next(filter(self.has, fields), "")] if fields else [""]
        given = [(name, field) for name, field in zip(names, of, strict=True) if not fields or self.has(field)]
        if not given:
            return
        self.legend += [pair for pair in given if pair[1]]
        look = f"{_FONT}; font-size: 11px; font-style: italic; fill: {ink}; text-anchor: {at}"
        text = ", ".join(_lowered(name) for name, _ in given)
        self.parts.append(f'<text x="{x:.1f}" y="{y:.1f}" style="{look}">{text}</text>')

    def names(self) -> int:
        """The symbols in words below the drawing, in two columns; how many lines they take."""
        for n, (symbol, field) in enumerate(self.legend):
            value = (self.entered or {}).get(field)
            said = ", ".join(map(str, value.values())) if isinstance(value, Mapping) else "" if value is None else value
            x, y = 20 + _WIDTH // 2 * (n % 2), _HEIGHT + 14 * (n // 2)
            look = f"{_FONT}; font-size: 9px; fill: {_INK}"
            self.parts.append(f'<text x="{x}" y="{y}" style="{look}; font-style: italic">{_lowered(symbol)}</text>')
            words = f"{field.replace('_', ' ')} {said}".rstrip()
            words = words if len(words) <= _LONGEST else f"{words[: _LONGEST - 1]}…"
            self.parts.append(f'<text x="{x + 26}" y="{y}" style="{look}">{escape(words)}</text>')
        return -(-len(self.legend) // 2)

    def floor(self, x: float, to_x: float, y: float) -> None:
        """Solid ground, hatched below."""
        self.line((x, y), (to_x, y))
        for n in range(int((to_x - x) // 10)):
            self.line((x + 10 * n + 6, y), (x + 10 * n, y + 6), ink=_SOFT, wide=0.6)

    def wheel(self, x: float, y: float, radius: float, hub: float = 2) -> None:
        """A wheel, pulley or drum with its axis."""
        self.circle(x, y, radius, fill="#ffffff")
        self.circle(x, y, hub, fill=_INK)

    def motor(self, x: float, y: float, *shaft: Point) -> None:
        """The motor and its gearhead, whose shaft goes to the right, by some points."""
        self.box(x, y - 14, 34, 28, fill="#cfe3f1")
        self.box(x + 34, y - 11, 16, 22, fill="#cfe3f1")
        self.label(x + 17, y + 4, "M", at="middle")
        if shaft:
            self.line((x + 50, y), *shaft, wide=2.5)

    def force(self, start: Point, end: Point, symbol: str, *fields: str, off: Point = (4.0, -4.0)) -> None:
        """A force where its field is given."""
        if self.has(*fields):
            self.arrow(start, end)
            self.label(end[0] + off[0], end[1] + off[1], symbol, *fields, ink=_FORCE)

    def moves(self, start: Point, end: Point, symbol: str = "v") -> None:
        """The forward motion."""
        self.arrow(start, end, _MOTION)
        self.label(end[0] + 4, end[1] + 4, symbol, ink=_MOTION)

    def inclined(self, x: float, y: float, symbol: str, field: str) -> None:
        """The angle of the way against the level."""
        if self.has(field):
            self.line((x, y), (x + 66, y), ink=_SOFT, wide=0.8, dashed=True)
            self.line((x, y), (x + 60, y - 20), ink=_SOFT, wide=0.8)
            self.label(x + 70, y - 4, symbol, field)

    def guided(self, x: float, y: float) -> None:
        """A slide on its guide, with the forces along it."""
        self.box(x, y - 34, 90, 34)
        self.label(x + 45, y - 13, "m", "mass", at="middle")
        self.moves((x + 94, y - 26), (x + 130, y - 26))
        self.force((x - 2, y - 26), (x - 38, y - 26), "F_0", "force", off=(-12.0, -6.0))
        friction = ("friction_coefficient", "friction_force")
        self.force((x - 2, y - 6), (x - 26, y - 6), "μ, F_f", *friction, off=(-36.0, 4.0))


def _screw(p: Pen) -> None:
    p.motor(14, 128, (84, 128))
    p.box(84, 122, 330, 12, fill="#ffffff")
    for n in range(27):
        p.line((88 + 12 * n, 134), (94 + 12 * n, 122), ink=_SOFT, wide=0.8)
    p.box(414, 114, 10, 28)
    p.box(214, 116, 42, 24)
    p.line((235, 116), (235, 104))
    p.guided(190, 104)
    p.line((84, 104), (414, 104), ink=_SOFT)
    p.size((136, 150), (160, 150), "L", "lead", "screw", off=(0.0, 14.0))
    p.turning(74, 128, 20)
    p.label(52, 98, "J", "inertia")
    p.label(264, 156, "η", "efficiency", "thread_friction")
    p.inclined(340, 184, "β", "incline")


def _drums(p: Pen) -> None:
    """A belt over two pulleys or drums, one of them driven."""
    for x in (96, 384):
        p.wheel(x, 128, 24)
    p.line((96, 104), (384, 104), wide=2)
    p.line((96, 152), (384, 152), wide=2)
    p.motor(14, 128)


def _drum_figures(p: Pen, diameter: str) -> None:
    p.size((96, 152), (96, 104), "d", diameter, off=(34.0, 4.0))
    p.turning(96, 128, 32)
    p.label(60, 84, "J", "inertia")
    p.label(240, 168, "m_b", "belt_mass", at="middle")


def _belt_axis(p: Pen) -> None:
    _drums(p)
    p.guided(200, 104)
    _drum_figures(p, "pulley_diameter")
    p.label(268, 136, "η", "efficiency", at="middle")
    p.inclined(350, 186, "β", "incline")


def _conveyor(p: Pen) -> None:
    _drums(p)
    for x in (150, 210, 270, 330):
        p.circle(x, 109, 5)
    p.box(180, 70, 34, 32)
    p.box(262, 70, 34, 32)
    p.label(238, 62, "m", "mass", at="middle")
    p.moves((304, 86), (340, 86))
    p.force((176, 86), (140, 86), "F_0", "force", off=(-12.0, -6.0))
    p.label(196, 136, "μ, F_f", "friction_coefficient", "friction_force", ink=_FORCE)
    _drum_figures(p, "drum_diameter")
    p.inclined(350, 186, "β", "incline")


def _rack_pinion(p: Pen) -> None:
    p.line((90, 110), (420, 110))
    for n in range(27):
        x = 92 + 12 * n
        p.line((x, 110), (x + 3, 116), (x + 6, 116), (x + 9, 110), wide=0.9)
    p.wheel(180, 142, 26)
    p.motor(98, 142, (180, 142))
    p.guided(230, 110)
    p.size((180, 168), (180, 116), "d", "pinion_diameter", off=(42.0, 12.0))
    p.turning(180, 142, 34, start=0.6, end=2.2)
    p.label(130, 176, "J", "inertia")
    p.label(60, 104, "η", "efficiency")
    p.inclined(350, 180, "β", "incline")


def _hoist(p: Pen) -> None:
    p.wheel(200, 52, 26)
    p.motor(124, 52, (200, 52))
    p.line((226, 52), (226, 108), wide=1.6)
    p.box(200, 108, 52, 40)
    p.label(226, 132, "m", "mass", at="middle")
    p.moves((268, 144), (268, 108))
    p.arrow((226, 150), (226, 178))
    p.label(232, 178, "m g", ink=_FORCE)
    p.size((200, 78), (200, 26), "d", "drum_diameter", off=(-34.0, 44.0))
    p.turning(200, 52, 34)
    p.label(160, 18, "J", "inertia")
    p.label(236, 90, "n", "falls")
    p.label(290, 70, "η", "rope_efficiency")
    if p.has("counterweight"):
        p.line((174, 52), (174, 120), wide=1.6)
        p.box(156, 120, 36, 28)
        p.label(150, 138, "m_c", "counterweight", at="end")
    p.force((286, 160), (286, 182), "F_f", "friction_force", off=(6.0, 0.0))


def _arm(p: Pen) -> None:
    x, y, angle = 150.0, 140.0, pi / 6
    end, centre = ((x + r * cos(angle), y - r * sin(angle)) for r in (190.0, 140.0))
    p.motor(74, y, (x, y))
    p.line((x, y), (x + 200, y), ink=_SOFT, wide=0.8, dashed=True)
    p.line((x, y), end, wide=7, ink=_SOFT)
    p.circle(x, y, 9, fill="#ffffff")
    p.circle(*centre, 11, fill="#cfe3f1")
    p.label(centre[0] - 4, centre[1] - 18, "m", "mass", at="end")
    p.arrow((centre[0], centre[1] + 12), (centre[0], centre[1] + 46))
    p.label(centre[0] + 5, centre[1] + 42, "m g", ink=_FORCE)
    off = (-12 * sin(angle) * 3, -12 * cos(angle) * 3)
    p.size((x + off[0], y + off[1]), (centre[0] + off[0], centre[1] + off[1]), "l", "length", off=(-16.0, -6.0))
    p.label(x + 60, y - 10, "φ_0", "start_angle")
    p.turning(x, y, 46, start=-0.05, end=-0.45)
    p.label(x - 6, y + 28, "J", "inertia")
    p.label(x + 60, y + 28, "T_f", "friction_torque", ink=_FORCE)
    p.label(x + 160, y + 28, "τ", "tilt")


def _turned(p: Pen) -> None:
    p.motor(70, 96, (206, 96))
    p.turning(150, 96, 24)
    p.label(142, 64, "ω", ink=_MOTION)


def _flywheel(p: Pen) -> None:
    _turned(p)
    p.box(206, 40, 26, 112)
    p.label(219, 34, "J", "inertia", at="middle")
    p.label(250, 100, "T_f", "friction_torque", ink=_FORCE)


def _fan(p: Pen) -> None:
    _turned(p)
    for way in (-1, 1):
        p.line((206, 96), (220, 96 + way * 14), (226, 96 + way * 58), (200, 96 + way * 52), (206, 96), fill="#e8eaed")
    p.label(213, 30, "J", "inertia", at="middle")
    p.line((286, 150), (286, 46))
    p.line((286, 150), (424, 150))
    p.line(*((286 + 6 * n, 150 - 0.19 * n * n) for n in range(22)), ink=_FORCE, wide=1.6)
    p.label(280, 50, "T", at="end")
    p.label(420, 166, "ω", at="end")
    p.label(300, 60, "T_r", "rated_torque", ink=_FORCE)
    p.label(330, 166, "ω_r", "rated_speed")
    p.label(300, 78, "n", "exponent")
    p.label(300, 96, "T_f", "friction_torque", ink=_FORCE)


def _rotary_table(p: Pen) -> None:
    p.motor(98, 150, (210, 150), (210, 106))
    p.box(120, 90, 180, 16)
    p.label(112, 84, "J", "inertia")
    if p.has("mass"):
        p.box(240, 60, 34, 30)
        p.label(257, 52, "m", "mass", at="middle")
    p.line((210, 44), (210, 124), ink=_SOFT, wide=0.8, dashed=True)
    p.turning(210, 62, 22)
    if p.has("eccentricity"):
        p.size((210, 118), (257, 118), "ε", "eccentricity", off=(14.0, 16.0))
    p.force((310, 98), (344, 98), "T_0", "torque")
    p.label(314, 128, "T_f", "friction_torque", ink=_FORCE)
    p.label(314, 150, "τ", "tilt")
    p.label(314, 172, "φ_0", "start_angle")


def _winder(p: Pen) -> None:
    p.motor(60, 110, (200, 110))
    p.circle(200, 110, 60, fill="#e8eaed")
    p.circle(200, 110, 20, fill="#ffffff")
    p.line((200, 50), (400, 50), wide=2)
    p.moves((330, 66), (290, 66))
    p.force((404, 50), (440, 50), "F", "tension", off=(-6.0, -8.0))
    p.turning(200, 110, 72, start=4.4, end=3.4)
    p.size((180, 176), (220, 176), "d_c", "core_diameter", off=(0.0, 14.0))
    p.size((140, 188), (260, 188), "d_0", "start_diameter", off=(80.0, 4.0))
    p.label(340, 44, "h, b, ρ", "thickness", "width", "density")
    p.label(204, 114, "J", "inertia", at="middle")
    p.label(290, 120, "T_f", "friction_torque", ink=_FORCE)
    p.label(340, 96, "t", "taper")


def _recorded(p: Pen) -> None:
    p.motor(30, 96, (132, 96))
    p.circle(142, 96, 10, fill="#e8eaed")
    p.turning(106, 96, 22)
    for top, symbol, ink, course in (
        (22, "ω", _MOTION, (0, 30, 44, 44, 44, 30, 0, 0)), (104, "T", _FORCE, (26, 50, 30, 28, 30, 8, 20, 20)),
    ):  # fmt: skip
        p.line((200, top), (200, top + 60), (440, top + 60))
        p.line(*((204 + 32 * n, top + 58 - y) for n, y in enumerate(course)), ink=ink, wide=1.6)
        p.label(194, top + 10, symbol, at="end", ink=ink)
    p.label(438, 182, "t", at="end")
    p.label(30, 150, "file", "file")
    p.label(120, 130, "J", "inertia")


def _wheeled_vehicle(p: Pen) -> None:
    p.floor(60, 420, 158)
    for x in (150, 310):
        p.wheel(x, 132, 26, hub=3)
    p.box(112, 66, 236, 44)
    p.label(230, 92, "m", "mass", at="middle")
    p.moves((354, 88), (396, 88))
    p.size((310, 158), (310, 106), "d", "wheel_diameter", off=(44.0, 20.0))
    p.force((128, 152), (100, 152), "C_rr", "rolling_resistance", "sinkage", off=(-46.0, -6.0))
    p.turning(150, 132, 34, start=3.5, end=4.5)
    p.label(178, 150, "J_w", "inertia")
    p.force((110, 80), (72, 80), "F_w", "drag_area", "headwind", off=(-10.0, -6.0))
    p.label(230, 52, "N", "driven_wheels", at="middle")
    p.label(196, 182, "μ", "friction_coefficient")
    p.inclined(320, 184, "θ", "slope")


SKETCHES: dict[str, Callable[[Pen], None]] = {
    "arm": _arm, "ball_screw": _screw, "lead_screw": _screw, "belt_axis": _belt_axis, "conveyor": _conveyor,
    "fan": _fan, "flywheel": _flywheel, "hoist": _hoist, "rack_pinion": _rack_pinion, "recorded": _recorded,
    "rotary_table": _rotary_table, "wheeled_vehicle": _wheeled_vehicle, "winder": _winder,
}  # fmt: skip
"""How each kind of load is drawn."""


def symbols(kind: str) -> dict[str, str]:
    """Symbols of a sketch by the fields of its load.

    >>> symbols("flywheel")
    {'inertia': 'J', 'friction_torque': 'T_f'}
    """
    pen = Pen(None)
    SKETCHES[kind](pen)
    return {field: symbol for symbol, field in pen.legend if symbol != field}


def sketch(kind: str, entered: Mapping[str, object] | None = None) -> bytes:
    """A kind of load with its symbols as SVG.

    Parameters
    ----------
    kind
        Of ``SKETCHES``.
    entered
        The load's fields as they were entered, printed beside their symbols; without it all symbols alone.

    Returns
    -------
    bytes
        The drawing.

    Examples
    --------
    >>> sketch("hoist")[:4], b"drum diameter 9 cm" in sketch("hoist", {"drum_diameter": "9 cm"})
    (b'<svg', True)
    """
    pen = Pen(entered)
    SKETCHES[kind](pen)
    size = _WIDTH, _HEIGHT + 14 * pen.names()
    head = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{0}" height="{1}">'.format(*size)
    return f"{head}{''.join(pen.parts)}</svg>\n".encode()
