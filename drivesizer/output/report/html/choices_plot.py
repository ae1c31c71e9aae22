"""All drives to choose from in one figure: price over mass, energy as colour, and those that no other beats."""

from __future__ import annotations

from math import isfinite

from drivesizer.output.report.html.curves import Plot, above, figure, line, plain
from drivesizer.output.text import margin
from drivesizer.results.weights import Choice, Choices
from drivesizer.units import show

__all__ = ["choices_plot", "unbeaten"]

_AXES = ("mass", "price", "energy")  # less of each is better
_SCALE = [[0.0, "#2c7fb8"], [0.5, "#a1dab4"], [1.0, "#fdae61"]]  # of the energy: seen in light and in dark


def choices_plot(chosen: Choices | None) -> Plot | None:
    """The drives by mass and price, coloured by the energy of a cycle."""
    every = chosen.drives if chosen else ()
    drives = [one for one in every if isfinite(one.figures["mass"]) and isfinite(one.figures["price"])]
    if len(drives) < 2:
        return None
    best = unbeaten(drives)
    return figure([_points(drives, best)], _layout(any(isfinite(one.figures["energy"]) for one in drives)))


def unbeaten(drives: list[Choice]) -> list[bool]:
    """Whether a drive is on the front: no other is as good in mass, price and energy and better in one of them."""
    figures = [tuple(one.figures.get(name, float("nan")) for name in _AXES) for one in drives]
    known = [tuple(value for value in each if isfinite(value)) for each in figures]

    def beats(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
        pairs = list(zip(one, other, strict=False))
        return len(one) >= len(other) and all(a <= b for a, b in pairs) and any(a < b for a, b in pairs)

    return [not any(beats(one, other) for one in known) for other in known]


def _points(drives: list[Choice], best: list[bool]) -> Plot:
    mass = [1e3 * one.figures["mass"] for one in drives]
    price = [one.figures["price"] for one in drives]
    energy = [one.figures["energy"] for one in drives]
    points = line(mass, price, "drives", "blue")
    return points | {
        "mode": "markers",
        "marker": {
            "size": [12 if front else 8 for front in best],
            "symbol": ["diamond" if front else "circle" for front in best],
            "color": [value if isfinite(value) else None for value in energy],
            "colorscale": _SCALE,
            "colorbar": {
                "title": {"text": "energy per cycle (J)", "side": "right"},
                "thickness": 10,
                "outlinewidth": 0,
            },
        },
        "customdata": [_hover_text(one, front) for one, front in zip(drives, best, strict=True)],
        "hovertemplate": "<b>%{customdata[0]}</b><br>%{customdata[1]}<br>%{customdata[2]}<extra></extra>",
    }


def _hover_text(one: Choice, front: bool) -> list[str]:
    energy = one.figures["energy"]
    drawn = show(energy, "J", "energy") if isfinite(energy) else "energy unknown"
    tight = one.figures.get("margin", float("nan"))
    figures = f"{show(one.figures['mass'], 'g', 'mass')}, {one.figures['price']:.2f} EUR, {drawn}"
    words = [f"smallest margin {margin(tight)}"] if isfinite(tight) else []
    return [plain(one.parts.label), plain(figures), "; ".join([*words, *(["none beats it"] if front else [])])]


def _layout(coloured: bool) -> Plot:
    return {
        "height": 380,
        "hovermode": "closest",
        "xaxis": {"title": {"text": "mass (g)"}},
        "yaxis": {},
        "annotations": [above("price (EUR)")],
        **({"margin": {"r": 80}} if coloured else {}),
    }
