"""Stretches of time beside each other on one axis, with a gap where the rest is left out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.output.report.figures.time_windows import Window, thinned

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Strip", "across", "strip", "within"]

_GAP = 0.035  # of all that is drawn, between two stretches
_TICKS = 5  # of a stretch, at most
_BREAK = [(-1.0, -1.8), (1.0, 1.8)]  # the mark where an axis is broken


class Strip(NamedTuple):
    """Stretches and where they are on the axis [s]."""

    windows: tuple[Window, ...]
    starts: tuple[float, ...]
    end: float

    def place(self, number: int, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Places of the times of a stretch."""
        return time - self.windows[number].start + self.starts[number]


def strip(windows: Sequence[Window]) -> Strip:
    """Stretches in a row.

    >>> strip([Window("", 0.0, 6.0), Window("", 100.0, 104.0)]).starts
    (0.0, 6.35)
    """
    lengths = [window.end - window.start for window in windows]
    gap, starts = _GAP * sum(lengths), [0.0]
    for length in lengths[:-1]:
        starts.append(round(starts[-1] + length + gap, 12))
    return Strip(tuple(windows), tuple(starts), starts[-1] + lengths[-1])


def within(
    time: NDArray[np.float64], values: NDArray[np.float64], window: Window
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A record in a stretch, thinned, from its very start to its very end.

    Parameters
    ----------
    time, values
        The record, shape (samples,), time in [s].
    window
        The stretch.

    Returns
    -------
    tuple of NDArray
        Time [s] and values.
    """
    rows = thinned(time, values, window)
    t, v = time[rows], values[rows]
    inside = (t >= window.start) & (t <= window.end)
    edges = np.array([window.start, window.end])
    ends = np.interp(edges, t, v)
    missing = [not inside.any() or bool(edge != t[inside][n]) for n, edge in ((0, edges[0]), (-1, edges[1]))]
    pieces = [(edges[:1], ends[:1])] * missing[0] + [(t[inside], v[inside])] + [(edges[1:], ends[1:])] * missing[1]
    return np.concatenate([x for x, _ in pieces]), np.concatenate([y for _, y in pieces])


def across(axes: Axes, shown: Strip, *, titled: bool = False) -> None:
    """Ticks of each stretch by its own times, a gap with marks between them, and their titles.

    Parameters
    ----------
    axes
        Where to.
    shown
        The stretches beside each other.
    titled
        Whether their titles are above.
    """
    places: list[float] = []
    names: list[str] = []
    for number, window in enumerate(shown.windows):
        ticks = _ticks(window)
        places += shown.place(number, ticks).tolist()
        names += [f"{tick:.6g}" for tick in ticks]
        if titled:
            axes.annotate(window.title, (shown.starts[number], 1.0), (0, 4), xycoords=("data", "axes fraction"),
                          textcoords="offset points")  # fmt: skip
        if number:
            ends = shown.starts[number - 1] + shown.windows[number - 1].end - shown.windows[number - 1].start
            _break(axes, ends, shown.starts[number])
    axes.set_xticks(places, names)
    axes.set_xlim(0.0, shown.end)


def _ticks(window: Window) -> NDArray[np.float64]:
    from matplotlib.ticker import MaxNLocator

    ticks = np.asarray(MaxNLocator(_TICKS, steps=[1, 2, 5, 10]).tick_values(window.start, window.end))
    room = 1e-9 * (window.end - window.start)
    return ticks[(ticks >= window.start - room) & (ticks <= window.end + room)]


def _break(axes: Axes, left: float, right: float) -> None:
    axes.axvspan(left, right, facecolor="white", linewidth=0, zorder=3.5)
    axes.plot([left, right], [0.0, 0.0], transform=axes.get_xaxis_transform(), linestyle="none", marker=_BREAK,
              markersize=5, color="black", clip_on=False, zorder=6)  # fmt: skip
