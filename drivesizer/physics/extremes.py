"""The few ends of segments at which anything that is linear in the six functions can be largest or smallest.

All coefficients of torque, current and voltage are 0 or more. So only points that no other point exceeds in every
function can have a maximum, and only those that lie below can have a minimum: exact, without any tolerance. What
is left of a long recording is thinned once more to its convex hull.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.figures import Array, Mask, Whole

_FRONT = 300  # points that may be left of a group before its convex hull is computed
_BLOCK = 64  # points that the others are held against at a time, at most
_NOT_BEFORE = np.triu(np.ones((_BLOCK, _BLOCK), bool))  # in a row's place those that do not come before it
_ALIKE = 1e-9  # share within which values differ by rounding, which goes by processor
_FREE = (0, 1, 2, 3, 5)  # the functions that vary within a group: the three torques, acceleration, speed


class Extremes(NamedTuple):
    """Points of the functions, shape (points, 6), and when each is met [s]."""

    high: Array  # where something may be largest
    high_time: Array
    low: Array  # where it may be smallest
    low_time: Array


def distinct(values: NDArray[Any]) -> NDArray[Any]:
    """The different ones of some values, rising: ``np.unique`` without the masked arrays that it loads for nothing.

    Parameters
    ----------
    values
        None of them NaN.

    Returns
    -------
    array
        Of one dimension.

    Examples
    --------
    >>> distinct(np.array([[2.0, 1.0], [2.0, 3.0]])).tolist(), distinct(np.array([])).tolist()
    ([1.0, 2.0, 3.0], [])
    """
    rising = np.sort(values, axis=None)
    first = np.ones(len(rising), bool)
    first[1:] = rising[1:] != rising[:-1]
    return rising[first]


def extremes(functions: Array, time: Array) -> Extremes:
    """The extreme points of the six functions.

    Parameters
    ----------
    functions
        At ends of segments, shape (..., 6).
    time
        Of these ends [s], shape (...).

    Returns
    -------
    Extremes
        Points that no other exceeds in every function, and those that exceed no other.
    """
    points, when = functions.reshape(-1, functions.shape[-1]), time.reshape(-1)
    kind = np.argmax(np.abs(points[:, :3]), axis=1) * 3 + np.sign(points[:, 4]).astype(int)  # direction of power, way
    groups = [np.flatnonzero(kind == k) for k in distinct(kind)]
    top = _largest(points, np.concatenate([g[_front(points[g])] for g in groups]))
    bottom = _largest(-points, np.concatenate([g[_front(-points[g])] for g in groups]))
    return Extremes(points[top], when[top], points[bottom], when[bottom])


def first_largest(values: Array) -> tuple[Array, Whole]:
    """The largest value of each row, and where: of places that differ by rounding alone the first.

    Parameters
    ----------
    values
        Shape (rows, places), or (places,) for one row.

    Returns
    -------
    tuple
        Values and places, each of shape (rows,); the place of NaN is 0.

    Examples
    --------
    >>> first_largest(np.array([[0.3, 0.1 + 0.2, 0.0], [1.0, 2.0, 3.0]]))[1].tolist()
    [0, 2]
    """
    top = values.max(axis=-1)
    near = np.minimum(top * (1.0 - _ALIKE), top * (1.0 + _ALIKE))  # of infinite ones the same
    return top, np.argmin(values < near[..., None], axis=-1)


def _largest(points: Array, rows: Whole) -> Whole:
    """Rows of a few points without those that another one of the same direction exceeds or equals, in order of time."""
    if len(rows) > _FRONT:
        return np.sort(rows)
    direction = np.sign(points[rows, 4])  # a figure of one direction alone must find its points
    groups = [rows[direction == d] for d in distinct(direction)]
    return np.sort(np.concatenate([g[undominated(points[g])] for g in groups]))


def _front(points: Array) -> Whole:
    """Rows of a group that may have a maximum: its front, and of a long front the hull."""
    varying = points[:, _FREE]
    rows = undominated(varying, _FRONT)
    return rows[_hull(varying[rows])] if len(rows) > _FRONT else rows


def undominated(points: Array, most: int | None = None) -> Whole:
    """Rows that no other row exceeds or equals in every column; of equal rows the first.

    Parameters
    ----------
    points
        Of any number of columns, where more is better.
    most
        When so many are found, the rest is kept without examination.

    Returns
    -------
    array
        Numbers of the rows.
    """
    left = np.ascontiguousarray(points.T)
    spread = np.ptp(left, axis=1) if len(points) else np.ones(len(left))
    far = (left / np.where(spread > 0.0, spread, 1.0)[:, None]).sum(
        axis=0
    )  # no column outweighs the others: few rounds
    rows = np.arange(len(points))
    if len(rows) > _BLOCK:  # those that one exceeds or equals need not be put in order
        best = int(np.nan_to_num(far, nan=-np.inf).argmax())
        rows = np.flatnonzero(_exceeding(left, left[:, [best]])[:, 0] | (rows == best))
    # an earlier point cannot be exceeded by a later one; columns break ties that the digits of the sum leave
    rows = rows[np.lexsort((*-left[::-1, rows], -far[rows]))]
    left, undominated_rows, size = left[:, rows], list[Whole](), 1
    count, enough = 0, len(rows) if most is None else most + 1
    while len(rows) and count < enough:
        block = left[:, :size]
        first = np.flatnonzero((_exceeding(block, block) | _NOT_BEFORE[: block.shape[1], : block.shape[1]]).all(axis=1))
        first = first[: enough - count]
        undominated_rows.append(rows[first])
        count, size = count + len(first), min(2 * size, _BLOCK)
        after = _exceeding(left, left[:, first]).all(axis=1)
        rows, left = rows[after], left[:, after]
    return np.concatenate([*undominated_rows, rows]).astype(np.int64)


def _exceeding(points: Array, others: Array) -> Mask:
    """Whether each point exceeds each of others in any figure: shape (points, others), of (figures, points)."""
    higher: Mask = points[0][:, None] > others[0]
    for mine, its in zip(points[1:], others[1:], strict=True):
        higher |= mine[:, None] > its
    return higher


def _hull(points: Array) -> Whole:
    """Rows at the corners of the convex hull, in the dimensions that the points span."""
    from scipy.spatial import ConvexHull  # only a long recording needs it

    spread = np.ptp(points, axis=0)
    scaled = (points[:, spread > 0.0] - points[:, spread > 0.0].mean(axis=0)) / spread[spread > 0.0]
    _, size, axes = np.linalg.svd(scaled, full_matrices=False)
    flat = scaled @ axes[size > 1e-9 * size[0]].T
    if flat.shape[1] == 1:
        return np.array([flat[:, 0].argmin(), flat[:, 0].argmax()])
    return np.sort(ConvexHull(flat).vertices).astype(np.int64)
