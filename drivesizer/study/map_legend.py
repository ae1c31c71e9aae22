"""Look of drives on a map, number, colour and pattern or marker, and their list below it.

Colours are Paul Tol's light scheme, made for cells with black letters and distinguishable by the colour-blind (P. Tol,
Colour Schemes, SRON/EPS/TN/09-002, figure of the light scheme). After the last colour they repeat with another pattern,
points with another marker. No numbered drive is grey.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from drivesizer.output.text import clean, short

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["LINE", "OTHERS", "Look", "listed", "look_of", "numbered", "rows_of_list"]

LINE = 0.145  # in, of a line of text


class Look(NamedTuple):
    """Look of a drive's cells and points."""

    face: str
    hatch: str
    marker: str


_FACES = ("#77AADD", "#EE8866", "#EEDD88", "#FFAABB", "#99DDFF", "#44BB99", "#BBCC33", "#AAAA00")
_PATTERNS = (("", "o"), ("....", "s"), ("xxxx", "^"), ("||||", "D"), ("----", "v"), ("oooo", "P"), ("++++", "p"))
OTHERS = Look("#DDDDDD", "**", "h")  # drives without a number
_MOST = len(_FACES) * len(_PATTERNS)  # drives with a number of their own
_SHORT = 10  # lines of one column; more take two
_LETTERS = {1: 96, 2: 50}  # of a name, by columns
_INSET, _APART = 0.75, 2.9  # in, from the left edge to the names, and from column to column


def look_of(number: int) -> Look:
    """Look of the drive with a number; different for every number."""
    n, family = (number - 1) % len(_FACES), (number - 1) // len(_FACES)
    return Look(_FACES[n], *_PATTERNS[family])


def numbered(rows: Sequence[dict[str, Any]]) -> dict[str, int]:
    """The drives that are best most often, numbered from 1."""
    often = Counter(row["set"] for row in rows if row["set"])
    first = sorted(often, key=lambda name: (-often[name], name))[:_MOST]
    return {name: number for number, name in enumerate(first, 1)}


def _entries(numbers: dict[str, int], others: int) -> list[tuple[str, Look]]:
    columns = 1 if len(numbers) + (others > 0) <= _SHORT else 2
    found = [(f"{n}  {short(clean(name), _LETTERS[columns])}", look_of(n)) for name, n in numbers.items()]
    return found + ([(f"…  {others} other drives", OTHERS)] if others else [])


def rows_of_list(numbers: dict[str, int], others: int) -> int:
    """Height of the list in lines."""
    count = len(_entries(numbers, others))
    return count if count <= _SHORT else -(-count // 2)


def listed(figure: Figure, numbers: dict[str, int], others: int, low: float, *, cells: bool) -> None:
    """Draw the list into a figure."""
    sample = _cell if cells else _point
    width, height = figure.get_size_inches()
    entries, lines = _entries(numbers, others), rows_of_list(numbers, others)
    for n, (text, look) in enumerate(entries):
        left, base = _INSET + _APART * (n // lines), low + LINE * (lines - 1 - n % lines)
        figure.text(left / width, base / height, text, va="bottom", fontsize=6.5)
        box = (left - 0.2) / width, base / height, 0.13 / width, 0.09 / height
        figure.add_artist(sample(look, *box, transform=figure.transFigure))


def _cell(look: Look, x: float, y: float, wide: float, tall: float, **placed: Any) -> Any:
    from matplotlib.patches import Rectangle

    line: dict[str, Any] = {"edgecolor": "#555555", "linewidth": 0.3}
    return Rectangle((x, y), wide, tall, facecolor=look.face, hatch=2 * look.hatch, **line, **placed)


def _point(look: Look, x: float, y: float, wide: float, tall: float, **placed: Any) -> Any:
    from matplotlib.lines import Line2D

    line: dict[str, Any] = {"markeredgecolor": "#555555", "markeredgewidth": 0.3, "markersize": 4.0}
    return Line2D(
        [x + wide / 2],
        [y + tall / 2],
        linestyle="none",
        marker=look.marker,
        markerfacecolor=look.face,
        **line,
        **placed,
    )
