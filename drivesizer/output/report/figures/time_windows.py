"""Stretch of a long record that a figure shows, and the samples that it takes of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.output.thinning import extremes

__all__ = ["Window", "thinned", "windows"]

_MOST = 700  # samples that a trace keeps: finer than print
_SEEN = 1.0 / 300.0  # of a window: a longer step in time is more than a line's width


class Window(NamedTuple):
    """A stretch of time with its title."""

    title: str
    start: float
    end: float


def windows(series: Mapping[str, NDArray[np.float64]]) -> list[Window]:
    """The first and the last stretch in which the reference changes; all of it where it changes most of the time.

    Parameters
    ----------
    series
        Columns of a record, ``time`` and ``speed_reference`` among them.
    """
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

    Parameters
    ----------
    time, values
        The record, shape (samples,), time in [s].
    window
        The stretch.

    Returns
    -------
    NDArray
        Indices of samples, ascending.
    """
    first, last = np.searchsorted(time, [window.start, window.end])
    start, end = max(first - 1, 0), min(last + 1, len(time))
    steps = np.flatnonzero(np.diff(time[start:end]) > _SEEN * (window.end - window.start))
    kept = [extremes(values[start:end], _MOST), steps, steps + 1]
    found: NDArray[np.int64] = start + np.unique(np.concatenate(kept))
    return found
