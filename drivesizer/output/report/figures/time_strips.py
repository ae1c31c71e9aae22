"""Stretches of a long record that a figure shows, beside each other on one axis, with gaps for what is left out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.output.thinning import extremes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Strip", "Window", "across", "strip", "thinned", "windows", "within"]

_MOST = 700  # samples that a trace keeps: finer than print
_SEEN = 1.0 / 300.0  # of a window: a longer step in time is more than a line's width

_GAP = 0.035  # of all that is drawn, between two stretches
_TICKS = 5  # of a stretch, at most
_BREAK = [(-1.0, -1.8), (1.0, 1.8)]  # the mark where an axis is broken


class Window(NamedTuple):
    """A stretch of time with its title."""

    title: str
    start: float
    end: float


def windows(series: Mapping[str, NDArray[np.float64]]) -> list[Window]:
    """The first and the last stretch in which the reference changes; all of it where it changes most of the time."""
    time, reference = series["time"], series["speed_reference"]
    whole = Window("whole cycle", float(time[0]), float(time[-1]))
    changing = np.flatnonzero(np.abs(np.diff(reference)) > 1e-6 * np.abs(reference).max(initial=0.0))
    if not len(changing):
        return [whole]
    still = time[changing[1:]] - time[changing[:-1] + 1]  # s, from the end of one change to the start of the next
    gap = int(np.argmax(still)) if len(still) else 0
    if not len(still) or still[gap] < 0.5 * (whole.end - whole.start):
        return [whole]
    first = whole.start, float(time[changing[gap] + 1])
    last = float(time[changing[gap + 1]]), float(time[changing[-1] + 1])
    room = 0.35 * max(first[1] - first[0], last[1] - last[0])
    return [
        Window("acceleration", first[0], first[1] + room),
        Window("deceleration", last[0] - room, min(last[1] + room, whole.end)),
    ]


def thinned(time: NDArray[np.float64], values: NDArray[np.float64], window: Window) -> NDArray[np.int64]:
    """Rows of a window to draw: all when they are few, else the extremes of equal bins, so that no peak is lost.

    The neighbours outside the window are among them, and both ends of every step in time that can be seen: where
    nothing changes a record may have few samples.
    """
    first, last = np.searchsorted(time, [window.start, window.end])
    start, end = max(first - 1, 0), min(last + 1, len(time))
    steps = np.flatnonzero(np.diff(time[start:end]) > _SEEN * (window.end - window.start))
    kept = [extremes(values[start:end], _MOST), steps, steps + 1]
    found: NDArray[np.int64] = start + np.unique(np.concatenate(kept))
    return found


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
    """A record in a stretch, thinned, from its very start to its very end."""
    rows = thinned(time, values, window)
    t, v = time[rows], values[rows]
    inside = (t >= window.start) & (t <= window.end)
    edges = np.array([window.start, window.end])
    ends = np.interp(edges, t, v)
    missing = [not inside.any() or bool(edge != t[inside][n]) for n, edge in ((0, edges[0]), (-1, edges[1]))]
    pieces = [(edges[:1], ends[:1])] * missing[0] + [(t[inside], v[inside])] + [(edges[1:], ends[1:])] * missing[1]
    return np.concatenate([x for x, _ in pieces]), np.concatenate([y for _, y in pieces])


def across(axes: Axes, shown: Strip, *, titled: bool = False) -> None:
    """Ticks of each stretch by its own times, a gap with marks between them, and their titles."""
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
