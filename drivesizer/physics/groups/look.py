"""A load cycle looked through once, by kinds of segments: sums of products, largest figures, points that none exceeds.

A group has one direction of power and one kind of motion; in it the six functions are torque, acceleration and speed
beside a constant direction. Arrays as ``census`` makes them.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

import drivesizer.physics.groups.layout as at
from drivesizer.physics.groups.layout import Array

__all__: list[str] = []  # compiled into ``kernel``

Whole = NDArray[np.int64]


def kind_of_torque(w_0: float, w_1: float, load_0: float, load_1: float) -> int:
    """Whether the load is driven, brakes or is at rest."""
    if w_0 == 0.0 and w_1 == 0.0:
        return at.AT_REST
    return at.DRIVING if (load_0 + load_1) * (w_0 + w_1) > 0.0 else at.BRAKING


def kind_of_motion(w_0: float, w_1: float, a_0: float, a_1: float, level: float) -> int:
    """0 at rest; forward 1 braking, 2 at a steady speed, 3 gaining speed; the same backward 4 to 6."""
    both, slope = w_0 + w_1, (a_0 + a_1) / 2.0
    if both == 0.0:
        return 0
    gaining = 0 if abs(slope) <= level else (1 if slope * both > 0.0 else -1)
    return 2 + gaining + (3 if both < 0.0 else 0)


def product(t: float, a_0: float, a_1: float, b_0: float, b_1: float) -> float:
    """Integral of the product of two lines."""
    return t * (2.0 * a_0 * b_0 + a_0 * b_1 + a_1 * b_0 + 2.0 * a_1 * b_1) / 6.0


def against(t: float, a_0: float, a_1: float, w_0: float, w_1: float) -> float:
    """Integral of the product as far as it is below 0, the second of one sign."""
    if a_0 * a_1 < 0.0:
        cut = a_0 / (a_0 - a_1)
        w = w_0 + cut * (w_1 - w_0)
        return max(-product(cut * t, a_0, 0.0, w_0, w), 0.0) + max(-product((1.0 - cut) * t, 0.0, a_1, w, w_1), 0.0)
    return max(-product(t, a_0, a_1, w_0, w_1), 0.0)


def add_products(s: Array, t: float, w: tuple[float, float], a: tuple[float, float], load: tuple[float, float]) -> None:
    """Add a segment to the sums of its group."""
    both = w[0] + w[1]
    way = 1.0 if both > 0.0 else (-1.0 if both < 0.0 else 0.0)
    s[at.LASTS] += t
    s[at.PRODUCTS] += product(t, load[0], load[1], load[0], load[1])
    s[at.PRODUCTS + 1] += product(t, load[0], load[1], a[0], a[1])
    s[at.PRODUCTS + 2] += way * t * (load[0] + load[1]) / 2.0
    s[at.PRODUCTS + 3] += product(t, load[0], load[1], w[0], w[1])
    s[at.PRODUCTS + 4] += product(t, a[0], a[1], a[0], a[1])
    s[at.PRODUCTS + 5] += way * t * (a[0] + a[1]) / 2.0
    s[at.PRODUCTS + 6] += product(t, a[0], a[1], w[0], w[1])
    s[at.PRODUCTS + 7] += way * way * t
    s[at.PRODUCTS + 8] += way * t * both / 2.0
    s[at.PRODUCTS + 9] += product(t, w[0], w[1], w[0], w[1])
    s[at.BRAKED_A] += against(t, a[0], a[1], w[0], w[1])


def keep_extremes(s: Array, w: tuple[float, float], a: tuple[float, float], load: tuple[float, float]) -> None:
    """Keep the largest amounts of a group."""
    s[at.MOST_W] = max(s[at.MOST_W], abs(w[0]), abs(w[1]))
    s[at.MOST_A] = max(s[at.MOST_A], abs(a[0]), abs(a[1]))
    s[at.MOST_LOAD] = max(s[at.MOST_LOAD], abs(load[0]), abs(load[1]))
    s[at.MOST_POWER] = max(s[at.MOST_POWER], abs(load[0] * w[0]), abs(load[1] * w[1]))


def bin_of(ranges: Array, column: int, value: float) -> int:
    """Bin of an acceleration (0) or a speed (1): what is in a higher bin is higher."""
    return int(min(max((value - ranges[2 * column]) * ranges[2 * column + 1], 0.0), at.BINS - 1.0))


def mark(highest: Array, i: int, j: int, x: float) -> None:
    """Mark a torque in all bins of lower acceleration and lower speed."""
    for m in range(i - 1, -1, -1):
        for n in range(j - 1, -1, -1):
            if highest[m, n] >= x:
                if n == j - 1:
                    return
                break
            highest[m, n] = x


def swap(window: Array, row: int, k: int, m: int) -> None:
    """Let two points change places."""
    for n in range(4):
        window[row, n, k], window[row, n, m] = window[row, n, m], window[row, n, k]


def exceeded(window: Array, row: int, count: int, x: float, y: float, z: float) -> bool:
    """Whether a point exceeds or equals another in everything; some at a time, by few instructions."""
    of_x, of_y, of_z = window[row, 0], window[row, 1], window[row, 2]
    for k in range(0, count, at.WIDE):
        found, end = 0, min(k + at.WIDE, count)
        for n in range(k, end):
            found += 1 if (of_x[n] >= x) & (of_y[n] >= y) & (of_z[n] >= z) else 0
        if found > 0:
            for n in range(k, end if k > 0 else 0):
                if of_x[n] >= x and of_y[n] >= y and of_z[n] >= z:
                    swap(window, row, n, n // 2)  # what exceeds one will exceed others: it moves ahead
                    break
            return True
    return False


def without_lower(window: Array, row: int, count: int, x: float, y: float, z: float) -> int:
    """Leave out what a point exceeds or equals in everything: the number of those that stay."""
    k = 0
    while k < count:
        if x >= window[row, 0, k] and y >= window[row, 1, k] and z >= window[row, 2, k]:
            count -= 1
            swap(window, row, k, count)
        else:
            k += 1
    return count


def put(
    window: Array, counts: Whole, highest: Array, ranges: Array, row: int, x: float, y: float, z: float, place: float
) -> bool:
    """Put a point to those that none exceeds or equals, unless one does; False where there is no room for it."""
    i, j = bin_of(ranges, 0, y), bin_of(ranges, 1, z)
    if x <= highest[row, i, j] or exceeded(window, row, counts[row], x, y, z):  # so it is with nearly all
        return True
    count = without_lower(window, row, counts[row], x, y, z)
    counts[row] = count
    if count == window.shape[2]:
        return False
    window[row, 0, count], window[row, 1, count], window[row, 2, count], window[row, 3, count] = x, y, z, place
    counts[row] = count + 1
    mark(highest[row], i, j, x)
    return True


def put_points(
    window: Array, counts: Whole, highest: Array, ranges: Array, group: int, place: float, w: tuple[float, float],
    a: tuple[float, float], load: tuple[float, float],
) -> bool:  # fmt: skip
    """Put both ends of a segment to the highest and the lowest of its group, and bounds of it to those of segments."""
    row, fits, up, down = 4 * group, True, ranges[:4], ranges[4:]
    for n in range(2):
        fits = fits and put(window, counts, highest, up, row, load[n], a[n], w[n], place + n)
        fits = fits and put(window, counts, highest, down, row + 1, -load[n], -a[n], -w[n], place + n)
    x, y, z = max(load[0], load[1]), max(a[0], a[1]), max(w[0], w[1])
    fits = fits and put(window, counts, highest, up, row + 2, x, y, z, place)
    x, y, z = -min(load[0], load[1]), -min(a[0], a[1]), -min(w[0], w[1])
    return fits and put(window, counts, highest, down, row + 3, x, y, z, place)


def look_at_all(
    level: float, duration: Array, speed: Array, acceleration: Array, torque: Array, strides: Whole, sums: Array,
    window: Array, counts: Whole, highest: Array, ranges: Array,
) -> int:  # fmt: skip
    """All segments, each to its group; 1 where there is no room for so many points."""
    before, time = -1, 0.0
    for k in range(len(duration)):
        m, n = k * strides[at.OF_SPEED], strides[at.OF_SPEED + 1]
        w = speed[m], speed[m + n]
        m, n = k * strides[at.OF_ACCELERATION], strides[at.OF_ACCELERATION + 1]
        a = acceleration[m], acceleration[m + n]
        m, n = k * strides[at.OF_TORQUE], strides[at.OF_TORQUE + 1]
        load = torque[m], torque[m + n]
        motion = kind_of_motion(w[0], w[1], a[0], a[1], level)
        group = kind_of_torque(w[0], w[1], load[0], load[1]) * at.MOTIONS + motion
        if sums[group, at.LASTS] == 0.0:
            sums[group, at.STARTS] = time
        add_products(sums[group], duration[k], w, a, load)
        keep_extremes(sums[group], w, a, load)
        if motion != before:
            sums[at.GROUPS, 0] += 1.0
            before = motion
        if not put_points(window, counts, highest, ranges, group, 2.0 * k, w, a, load):
            return 1
        time += duration[k]
    return 0


def below(limit: float, i_0: float, i_1: float) -> tuple[float, float]:
    """Shares of a piece from when until when the current is not above a limit; from beyond it where it always is."""
    if i_0 == i_1:
        return (2.0, 2.0) if abs(i_0) > limit else (0.0, 1.0)
    up, down = (limit - i_0) / (i_1 - i_0), (-limit - i_0) / (i_1 - i_0)
    enter, leave = min(up, down), max(up, down)
    if enter >= 1.0 or leave <= 0.0:
        return 2.0, 2.0
    return max(enter, 0.0), min(leave, 1.0)


def put_blocks(duration: Array, speed: Array, strides: Whole, blocks: Array) -> None:
    """Least and largest amount of the speed in blocks of segments, and their durations."""
    for block in range(len(blocks)):
        low, high, total = math.inf, 0.0, 0.0
        for k in range(block * at.BLOCK, min((block + 1) * at.BLOCK, len(duration))):
            m, n = k * strides[at.OF_SPEED], strides[at.OF_SPEED + 1]
            a, b = abs(speed[m]), abs(speed[m + n])
            low, high, total = min(low, min(a, b)), max(high, max(a, b)), total + duration[k]
        blocks[block, 0], blocks[block, 1], blocks[block, 2] = low, high, total


def add_above(found: Array, enter: float, leave: float, t: float) -> None:
    """Add a stretch of time that is above a level but from one share of it to another."""
    if enter > 1.0:
        found[at.IN_ALL] += t
    else:
        found[at.IN_ALL] += t * (1.0 - (leave - enter))
        if found[at.BEGAN] < 0.0:
            found[at.FIRST] = found[at.NOW] + enter * t
        else:
            found[at.LONGEST] = max(found[at.LONGEST], found[at.NOW] + enter * t - found[at.BEGAN])
        found[at.BEGAN] = found[at.NOW] + leave * t
    found[at.NOW] += t


def times_above(level: float, duration: Array, speed: Array, strides: Whole, blocks: Array, found: Array) -> None:
    """Longest time without a break for which the speed is above a level, in a cycle that repeats, and all such time."""
    found[at.BEGAN] = -1.0
    for block in range(len(blocks)):
        if blocks[block, 0] > level:
            add_above(found, 2.0, 2.0, blocks[block, 2])
        elif blocks[block, 1] <= level:
            add_above(found, 0.0, 1.0, blocks[block, 2])
        else:
            for k in range(block * at.BLOCK, min((block + 1) * at.BLOCK, len(duration))):
                m, n = k * strides[at.OF_SPEED], strides[at.OF_SPEED + 1]
                a, b = abs(speed[m]), abs(speed[m + n])
                enter, leave = below(level, a, b) if max(a, b) > level else (0.0, 1.0)
                add_above(found, enter, leave, duration[k])
    begin, end = found[at.BEGAN], found[at.NOW]
    found[at.LONGEST] = max(found[at.LONGEST], found[at.FIRST] + end - begin) if begin >= 0.0 else end


def look_through(
    wanted: float, level: float, duration: Array, speed: Array, acceleration: Array, torque: Array, strides: Whole,
    sums: Array, window: Array, counts: Whole, highest: Array, ranges: Array,
) -> int:  # fmt: skip
    """Look at all segments, or how long the speed is above a level: (2) in blocks, which (1) puts in the window."""
    if wanted == 1.0:
        put_blocks(duration, speed, strides, window[0])
        return 0
    if wanted == 2.0:
        times_above(level, duration, speed, strides, window[0], sums[0])
        return 0
    return look_at_all(level, duration, speed, acceleration, torque, strides, sums, window, counts, highest, ranges)
