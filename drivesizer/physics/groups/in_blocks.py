"""A long load cycle in blocks: what its six functions reach in each, and how far their products deviate from a mean.

The figures are those of ``extremes.highest_and_lowest`` and ``heat_bounds``, looked at segment by segment.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

import drivesizer.physics.groups.block_layout as at
from drivesizer.physics.groups.block_layout import Array

__all__: list[str] = []  # compiled into ``kernel``

Whole = NDArray[np.int64]


def put_functions(s: Array, e: float, k: int, speed: Array, acceleration: Array, torque: Array, strides: Whole) -> int:
    """The six functions at both ends of a segment, behind a belt of an efficiency; which of the torques acts."""
    m, n = k * strides[at.OF_SPEED], strides[at.OF_SPEED + 1]
    w_0, w_1 = speed[m], speed[m + n]
    m, n = k * strides[at.OF_TORQUE], strides[at.OF_TORQUE + 1]
    load_0, load_1 = torque[m], torque[m + n]
    m, n = k * strides[at.OF_ACCELERATION], strides[at.OF_ACCELERATION + 1]
    both = w_0 + w_1
    kind, factor = 1, e
    if w_0 == 0.0 and w_1 == 0.0:
        kind, factor = 2, 1.0
    elif (load_0 + load_1) * both > 0.0:
        kind, factor = 0, 1.0 / e
    for place in range(3):
        own = factor if place == kind else 0.0
        s[at.LEFT + place], s[at.RIGHT + place] = own * load_0, own * load_1
    way = 1.0 if both > 0.0 else (-1.0 if both < 0.0 else 0.0)
    s[at.LEFT + 3], s[at.LEFT + 4], s[at.LEFT + 5] = acceleration[m], way, w_0
    s[at.RIGHT + 3], s[at.RIGHT + 4], s[at.RIGHT + 5] = acceleration[m + n], way, w_1
    return kind


def keep_extremes(s: Array) -> None:
    """Keep what the functions reach."""
    for k in range(at.FUNCTIONS):
        left, right = s[at.LEFT + k], s[at.RIGHT + k]
        s[at.MOST + k] = max(s[at.MOST + k], max(left, right))
        s[at.LEAST + k] = min(s[at.LEAST + k], min(left, right))


def product(a: float, b: float, c: float, d: float) -> float:
    """Mean of the product of two lines, of their values at the left and at the right end."""
    return (a * b + c * d + (a + c) * (b + d)) / 6.0


def entry(a: int, b: int) -> int:
    """Place of the product of two functions, the second no later than the first."""
    return a * (a + 1) // 2 + b


def add_means(s: Array, kind: int, t: float) -> None:
    """Add the integrals of products over a segment, and keep how far, times 4, they deviate from a line within it."""
    for m in range(4):
        a = kind if m == 0 else m + 2
        c, e = s[at.LEFT + a], s[at.RIGHT + a]
        for n in range(m + 1):
            b = kind if n == 0 else n + 2
            d, f, place = s[at.LEFT + b], s[at.RIGHT + b], entry(a, b)
            whole = t * product(c, d, e, f)
            s[at.MEANS + place] += whole
            s[at.SIZE + place] += abs(whole)
            inner = t * (abs(e * f - c * d) / 2.0 + abs((e - c) * (f - d)) / 6.0)
            s[at.INNER + place] = max(s[at.INNER + place], inner)


def keep_walk(s: Array, kind: int, t: float) -> None:
    """Keep how far the integrals of what remains of products, less their means, go."""
    for n in range(at.PLACES):
        s[at.WALK + n] -= t * s[at.MEANS + n]
    for m in range(4):
        a = kind if m == 0 else m + 2
        for n in range(m + 1):
            b = kind if n == 0 else n + 2
            s[at.WALK + entry(a, b)] += t * product(s[at.LEFT + a], s[at.LEFT + b], s[at.RIGHT + a], s[at.RIGHT + b])
    for n in range(at.PLACES):
        s[at.HIGH + n] = max(s[at.HIGH + n], s[at.WALK + n])
        s[at.LOW + n] = min(s[at.LOW + n], s[at.WALK + n])


def add_squares(s: Array, found: Array, t: float) -> None:
    """Add squares and product of torque and acceleration, and the square of speed, of a segment."""
    load = s[at.LEFT] + s[at.LEFT + 1] + s[at.LEFT + 2], s[at.RIGHT] + s[at.RIGHT + 1] + s[at.RIGHT + 2]
    own, w = (s[at.LEFT + 3], s[at.RIGHT + 3]), (s[at.LEFT + 5], s[at.RIGHT + 5])
    squares = (
        product(load[0], load[0], load[1], load[1]), product(own[0], own[0], own[1], own[1]),
        product(load[0], own[0], load[1], own[1]), product(w[0], w[0], w[1], w[1]),
    )  # fmt: skip
    for n in range(at.SQUARES):
        found[0, n] += t * squares[n]
        found[1, n] += squares[n]


def one_block(
    wanted: float, s: Array, e: float, first: int, last: int, duration: Array, speed: Array, acceleration: Array,
    torque: Array, strides: Whole, found: Array,
) -> None:  # fmt: skip
    """A block, but for what needs its means."""
    total = 0.0
    for k in range(first, last):
        kind = put_functions(s, e, k, speed, acceleration, torque, strides)
        total += duration[k]
        if wanted == at.SIGNALS:
            add_squares(s, found, duration[k])
        else:
            keep_extremes(s)
        if wanted == at.DEVIATIONS:
            add_means(s, kind, duration[k])
    for n in range(at.ENTRIES):
        s[at.MEANS + n] /= total


def deviate(
    s: Array, e: float, first: int, last: int, duration: Array, speed: Array, acceleration: Array, torque: Array,
    strides: Whole,
) -> None:  # fmt: skip
    """Find by how much the integrals of products less their means go above zero in a block, and below."""
    for k in range(first, last):
        kind = put_functions(s, e, k, speed, acceleration, torque, strides)
        keep_walk(s, kind, duration[k])
    for n in range(at.ENTRIES):
        more = s[at.INNER + n] / 4.0 + at.ROUNDING * s[at.SIZE + n]
        s[at.HIGH + n] += more
        s[at.LOW + n] -= more


def clear(s: Array) -> None:
    """A block of which nothing is known yet."""
    for n in range(at.CELLS):
        s[n] = 0.0
    for k in range(at.FUNCTIONS):
        s[at.MOST + k], s[at.LEAST + k] = -math.inf, math.inf


def put_found(s: Array, found: Array) -> None:
    """Put what is known of a block among what is found."""
    for n in range(at.ENTRIES):
        found[at.MEAN, n], found[at.ABOVE, n], found[at.BELOW, n] = s[at.MEANS + n], s[at.HIGH + n], -s[at.LOW + n]
    for k in range(at.FUNCTIONS):
        found[at.HIGHEST, k], found[at.LOWEST, k] = s[at.MOST + k], s[at.LEAST + k]


def look_at_blocks(
    wanted: float, efficiency: float, starts: Whole, duration: Array, speed: Array, acceleration: Array, torque: Array,
    strides: Whole, s: Array, found: Array,
) -> int:  # fmt: skip
    """Consecutive blocks, by their first segments."""
    for block in range(len(starts)):
        first = starts[block]
        last = starts[block + 1] if block + 1 < len(starts) else len(duration)
        clear(s)
        one_block(wanted, s, efficiency, first, last, duration, speed, acceleration, torque, strides, found[block])
        if wanted == at.DEVIATIONS:
            deviate(s, efficiency, first, last, duration, speed, acceleration, torque, strides)
        if wanted != at.SIGNALS:
            put_found(s, found[block])
    return 0
