"""Motions that a task has written out repeatedly: ranges of its pieces that repeat.

Pieces are the same when they have equal duration, and equal speed and load at both ends. Equal pieces get the same
number; where numbers repeat at a distance, so does the motion. The last row of ``benchmarks/closed_loop.py`` measures
it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.layout import Array

Numbers = NDArray[np.int64]

__all__ = ["blocks"]

_SAME = 1e-9  # of the largest speed or load: smaller differences are neglected
_SAME_TIME = 1e-3  # of a period, the same
_LEAST = 8  # least laps
_AHEAD = 3  # next places of a number whose distances are tried
_TRIED = 48  # distances, the most frequent first


def blocks(pieces: Array, p: Array, lap: int, worth: int) -> list[tuple[int, int, int]]:
    """Ranges of pieces that repeat."""
    if len(pieces) < 2 * _LEAST or pieces[-1, 1] < worth:
        return []
    numbers = _numbers(pieces, p)
    found = [run for distance in _distances(numbers) for run in _runs(numbers, distance)]
    taken: list[tuple[int, int, int]] = []
    for first, end, rows in sorted(found, key=lambda run: (run[0] - run[1], run[2], run[0])):  # the longest first
        periods = (pieces[end - 1, 1] - pieces[first, 0]) * rows / (end - first)
        rows *= int(np.ceil(lap / max(periods, 1.0)))
        end -= (end - first) % rows
        clear = all(end <= a or first >= b for a, b, _ in taken)
        if clear and end - first >= _LEAST * rows and pieces[end - 1, 1] - pieces[first, 0] >= worth:
            taken.append((first, end, rows))
    return sorted(taken)


def _numbers(pieces: Array, p: Array) -> Numbers:
    """Numbers of the pieces: the same number, the same motion."""
    start, end = pieces[:, 2], np.append(pieces[1:, 2], pieces[-1, 1] * p[at.H])
    lasts = end - start
    speed, load = pieces[:, 3], pieces[:, 6]
    columns = [(lasts, _SAME_TIME * p[at.H])]
    for first, slope in ((speed, pieces[:, 4]), (load, pieces[:, 7])):
        columns += [(x, _SAME * float(np.abs(first).max())) for x in (first, first + slope * lasts)]
    found = np.zeros(len(pieces), np.int64)
    for values, apart in columns:
        kind = _kinds(values, apart)
        _, found = np.unique(found * (kind.max() + 1) + kind, return_inverse=True)
    return np.asarray(found, np.int64)


def _kinds(values: Array, apart: float) -> Numbers:
    """Numbers of values; neighbours no farther apart than a bound share one."""
    order = np.argsort(values, kind="stable")
    kind = np.zeros(len(values), np.int64)
    kind[order[1:]] = np.cumsum(np.diff(values[order]) > apart)
    return kind


def _distances(numbers: Numbers) -> list[int]:
    """Distances at which numbers recur, the most frequent first."""
    order = np.argsort(numbers, kind="stable")
    same = numbers[order]
    found = [
        (order[n:] - order[:-n])[same[n:] == same[:-n]] for n in range(1, _AHEAD + 1) if n < len(numbers)
    ]  # fmt: skip
    distance, count = np.unique(np.concatenate(found), return_counts=True)
    return [int(x) for x in distance[np.lexsort((distance, -count * distance))][:_TRIED]]


def _runs(numbers: Numbers, distance: int) -> list[tuple[int, int, int]]:
    """Ranges in which numbers repeat at a distance."""
    if _LEAST * distance > len(numbers):
        return []
    same = np.concatenate(([False], numbers[distance:] == numbers[:-distance], [False]))
    edges = np.flatnonzero(np.diff(same.astype(np.int8)))
    starts, ends = edges[::2], edges[1::2] + distance
    long = ends - starts >= _LEAST * distance
    return [(int(a), int(b), distance) for a, b in zip(starts[long], ends[long], strict=True)]
