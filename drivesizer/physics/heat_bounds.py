r"""Bounds of a winding's peak over a long recorded cycle, from blocks of it that all candidates share.

The current is I = c f(t), with functions f that all candidates have in common and coefficients c >= 0 of each. A block
keeps of its segments the mean M of f f' and how far the integral of f f' - M from the block's start goes above zero
and below it, entry by entry: for any c the square of the current then has the mean c M c, and its integral
deviates from that of the mean by no more than c E c. Blocks are made once per load cycle.
Without these bounds the search over a recording (``benchmarks/search_sets.py``) takes many times as long.

**Derivation.** Let q = R_25 I^2, a = ``COPPER``, and u and v the temperatures of winding and housing above that at
which copper would have no resistance (v_a the ambient's), so that u and v are positive and

.. math:: C_w \dot u = a q u - (u - v) / R_{th1}, \quad C_h \dot v = P + (u - v) / R_{th1} - (v - v_a) / R_{th2}

In each block q is its mean plus something whose integral F from the block's start is zero again at its end and lies
between -D_below and D_above. With phi = a F / C_w and u = U exp(phi) the deviation leaves the growth and remains, as a
small share, in the exchange of heat only:

.. math:: C_w \dot U = a \bar q U - (U - e^{-\phi} v) / R_{th1}, \quad
          C_h \dot v = P + (e^\phi U - v) / R_{th1} - (v - v_a) / R_{th2}

Let U_0, v_0 solve this with phi = 0 and mean losses (``heat_cycle`` does), E = U - U_0, G = v - v_0, and let k_xy(t, s)
be the answer of body x at t to a unit pulse of heat at body y at s in that system. All k are positive and k_ww > k_wh:
backward from t, k_ww - k_wh decreases only as far as it is positive. To first order E is the integral of -phi j over
s < t, where by the equations of k and of U_0

.. math:: j = (k_{ww} v_0 - k_{wh} U_0) / R_{th1} = \partial_s (C_w k_{ww} U_0), \quad \int j \, ds = U_0(t)

Nearly all of j is positive: its negative part is at most k_wh (U_0 - v_0) / R_th1, with an integral J. So E is at most
max(-phi) (U_0 + J) + max(phi) J, and likewise downward. That is ``2 D / C_w`` of the heat at the resistance then, as
for a decreasing kernel, and something for the housing that stores the heat.

*Masses.* Constant temperatures are periodic solutions too, whose losses are known; from them, with
m = int k_wh ds: int k_ww ds = m (1 + R_th1 / R_th2) and a int k_ww q ds = m / R_th2 - 1. U_0 itself is what v_a / R_th2
and P at the housing make, so m <= R_th2 U_0 / v_a. Of the housing's answers the same holds with v_0.
*J*: (h, h), where h is the housing's rise, is the answer to (U_0 - v_0) / R_th1 + P at the housing and C_w h' - a q h
at the winding; so J <= max h (m + C_w / C_h int k_ww) / R_th2, were the housing never the warmer body. What it returns
is at most max P C_w / (C_w + C_h), as the slope of U_0 - v_0 shows where that is lowest.
*G*: its first order is the integral of -phi j_h with int j_h ds = 0 and a negative part of at most
(k_hh - k_hw)^+ U_0 / R_th1 plus that of J; the first bracket decreases at least as exp(-(1 / C_w + 1 / C_h) t / R_th1).
*Housing loss*: its own deviating integral W moves U by -int W d/ds k_wh, and k_wh goes up and down by m / (R_th2 C_h).
*The rest* is of second order, phi times E and G and phi^2 / 2 times u and v: with the masses these are two linear
inequalities for max |E| and max |G|. Where they have a solution the peak is finite: shrink phi continuously to zero,
the periodic state could only cease to exist by growing beyond what they allow.

Between two ends of blocks u is at most (U_0 + E) exp(max phi) of that block, and at least (U_0 - |E|) exp(min phi); at
the ends u = U, and the lower bound of the peak is the highest of these, or that of ``winding_bounds`` if it is higher.
Symbols: R_th thermal resistance [K/W], C heat capacity [J/K], I current [A], P loss at the housing [W].
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import ACCELERATION, AT_REST, BRAKING, DIRECTION, DRIVING, SPEED
from drivesizer.physics.extremes import highest_and_lowest, looked_at, together
from drivesizer.physics.groups import block_layout as at
from drivesizer.physics.heat_cycle import Periodic, highest, periodic
from drivesizer.physics.heat_cycle_columns import each_figure, some_of
from drivesizer.physics.heat_step import Array
from drivesizer.physics.thermal import COPPER, DATA_TEMPERATURE, TwoBodies, Value, steady_winding_temperature

__all__ = ["Blocks", "Bracket", "blocks", "bracket", "merged"]

_CELLS = 1 << 16  # motors times blocks at a time
_MULTIPLIED = 1 << 18  # figures at a time in a product of matrices: above, its threads wait on a busy machine
_FINER = 16  # steps per block at least, among which the blocks' ends are chosen
_FINE = 1 << 13  # and steps in all
_SPEED_SHARE = 0.05  # of the speed's square, by which a housing is heated, in that choice
_ROUNDING = 1e-10  # share of the temperature by which bounds are apart at least
_SUM_ROUNDING = 1e-12  # share of a sum over the cycle that rounding may take
_ROW, _COLUMN = np.tril_indices(6)  # of a symmetric matrix
_TIMES = np.where(_ROW == _COLUMN, 1.0, 2.0)  # that each entry stands there


class Bracket(NamedTuple):
    """Between what the peaks of n windings lie, and between what each is in each of B blocks."""

    lower: Array  # K, below the peak: (n,)
    upper: Array  # K, above it
    coolest: Array  # K, below the winding at each moment of a block: (n, B)
    warmest: Array  # K, above it


class Blocks(NamedTuple):
    """A load cycle in blocks: bounds for any current that is linear in its functions."""

    duration: Array  # s, of each of B blocks
    mean: Array  # (B, 6, 6): means of products of the functions
    above: Array  # (B, 6, 6): highest integral of products less their means, from the block's start [s times those]
    below: Array  # (B, 6, 6): and how far it goes below zero
    most: Array  # (B, 6): what the functions reach
    least: Array  # (B, 6)
    first: NDArray[np.intp]  # (B,): first segment of each


def blocks(duration: Array, functions: Any, count: int) -> Blocks:
    """Consecutive segments in blocks whose currents deviate little from their mean, however long the cycle.

    Parameters
    ----------
    duration
        Of each of S segments [s].
    functions
        The six functions at both ends of each segment, straight in between: shape (S, 2, 6), or what gives those of
        some segments (``six``).
    count
        Of blocks at most [1]; with no more segments than that each is a block.

    Returns
    -------
    Blocks
        The cycle in so many blocks at most.

    Notes
    -----
    What a current does within a segment is counted among what deviates: the bounds hold for it and for its mean square.
    """
    starts = np.arange(len(duration)) if len(duration) <= count else _starts(duration, functions, count)
    pieces, total = np.diff(np.append(starts, len(duration))), np.add.reduceat(duration, starts)
    if (looked := looked_at(functions, starts, at.DEVIATIONS)) is not None:
        highest_in, lowest_in = (looked[:, row, : at.FUNCTIONS] for row in (at.HIGHEST, at.LOWEST))
        mean, above, below = _symmetric(looked)
        return Blocks(total, mean, above, below, highest_in, lowest_in, starts)
    mean, above, below = np.empty((3, len(starts), 6, 6))
    found = Blocks(total, mean, above, below, *highest_and_lowest(len(duration), functions, starts), starts)
    for some, segments in together(starts, len(duration)):
        left, right = _lines(functions[segments])
        of = starts[some] - segments.start, pieces[some], total[some]
        for a, b in zip(_ROW, _COLUMN, strict=True):
            entry = _deviating(duration[segments], left[[a, b]], right[[a, b]], *of)
            for values, column in zip(found[1:4], entry, strict=True):
                values[some, a, b] = values[some, b, a] = column
    return found


def _symmetric(looked: Array) -> Array:
    """Means of products and their deviations, (3, B, 6, 6), from those of one triangle."""
    found = np.empty((3, len(looked), 6, 6))
    for values, row in zip(found, (at.MEAN, at.ABOVE, at.BELOW), strict=True):
        values[:, _ROW, _COLUMN] = values[:, _COLUMN, _ROW] = looked[:, row]
    return found


def merged(fine: Blocks, count: int) -> Blocks:
    """Consecutive blocks put together: their bounds are a little wider than those of such blocks of the cycle itself.

    Parameters
    ----------
    fine
        The cycle in blocks.
    count
        Into how many they are put, no more than there are.

    Returns
    -------
    Blocks
        The cycle in so many blocks, of alike many of those.
    """
    starts = np.arange(count) * len(fine.duration) // count
    pieces, t = np.diff(np.append(starts, len(fine.duration))), fine.duration[:, None, None]
    total, sums = np.add.reduceat(fine.duration, starts), t * fine.mean
    mean = np.add.reduceat(sums, starts) / total[:, None, None]
    steps = sums - t * np.repeat(mean, pieces, axis=0)  # of the integral of a product less its mean
    after = np.cumsum(steps, axis=0)
    after -= np.repeat((after - steps)[starts], pieces, axis=0)
    before = after - steps
    above = np.maximum.reduceat(np.maximum(before, after) + fine.above, starts)
    below = np.maximum.reduceat(fine.below - np.minimum(before, after), starts)
    reached = np.maximum.reduceat(fine.most, starts), np.minimum.reduceat(fine.least, starts)
    return Blocks(total, mean, above, below, *reached, fine.first[starts])


def _lines(functions: Array) -> tuple[Array, Array]:
    """Values at the left and at the right ends, function by function: shape (6, S) each."""
    left, right = (np.ascontiguousarray(functions[:, end].T) for end in (0, 1))
    return left, right


def _product(left: Array, right: Array) -> Array:
    """Mean of the product of two lines over each segment."""
    (a, b), (c, d) = left, right
    found: Array = (a * b + c * d + (a + c) * (b + d)) / 6.0
    return found


def _deviating(
    duration: Array, left: Array, right: Array, starts: NDArray[np.intp], pieces: NDArray[np.intp], total: Array
) -> tuple[Array, Array, Array]:
    """Mean of a product over each block, and how far the integral of what remains goes above zero and below."""
    product = _product(left, right)
    # within a segment: duration times -s (1 - s) (turn / 2 + (s - 1 / 2) bend / 3), s the share of it that is over
    turn, bend = right[0] * right[1] - left[0] * left[1], (right[0] - left[0]) * (right[1] - left[1])
    inner = np.maximum.reduceat(duration * (np.abs(turn) / 2.0 + np.abs(bend) / 6.0), starts) / 4.0
    mean = np.add.reduceat(duration * product, starts) / total
    steps = duration * (product - np.repeat(mean, pieces))
    walk = np.cumsum(steps)
    walk -= np.repeat(walk[starts] - steps[starts], pieces)
    inner += _SUM_ROUNDING * float((duration * np.abs(product)).sum())
    above = np.maximum(np.maximum.reduceat(walk, starts), 0.0) + inner
    below = inner - np.minimum(np.minimum.reduceat(walk, starts), 0.0)
    return mean, above, below


def _starts(duration: Array, functions: Any, count: int) -> NDArray[np.intp]:
    """First segments of the blocks: again and again the worst are split where they deviate most."""
    step = max(1, len(duration) // max(_FINER * count, _FINE))
    ends = np.append(np.arange(0, len(duration), step), len(duration))
    time = np.append(0.0, np.cumsum(duration)[ends[1:] - 1])
    sums = np.append(np.zeros((4, 1)), np.cumsum(_signals(duration, functions, ends[:-1]), axis=1), axis=1)
    cuts = np.array([0, len(ends) - 1])
    while len(cuts) <= count:
        at, worst = _farthest(time, sums, cuts)
        chosen = np.flatnonzero(worst > max(0.5 * worst.max(), _SUM_ROUNDING * time[-1]))
        if not len(chosen):
            break
        chosen = chosen[np.argsort(-worst[chosen])][: count + 1 - len(cuts)]
        cuts = np.sort(np.append(cuts, at[chosen]))
    first: NDArray[np.intp] = ends[cuts[:-1]]
    return first


def _signals(duration: Array, functions: Any, starts: NDArray[np.intp]) -> Array:
    """Integrals over steps of squares and product of torque and acceleration, and of speed squared, by their means."""
    if (looked := looked_at(functions, starts, at.SIGNALS)) is not None:
        found, mean = looked[:, 0, : at.SQUARES].T.copy(), looked[:, 1, : at.SQUARES].sum(axis=0) / len(duration)
    else:
        found, mean = np.empty((4, len(starts))), np.zeros(4)
        for some, segments in together(starts, len(duration)):
            squares = _squares(*_lines(functions[segments]))
            mean += squares.sum(axis=1) / len(duration)
            found[:, some] = np.add.reduceat(squares * duration[segments], starts[some] - segments.start, axis=1)
    mean[2] = np.sqrt(mean[0] * mean[1])
    mean[3] /= _SPEED_SHARE
    found /= np.where(mean > 0.0, mean, np.inf)[:, None]
    return found


def _squares(left: Array, right: Array) -> Array:
    """Means of those squares and of that product over each segment."""
    torque = [x[DRIVING] + x[BRAKING] + x[AT_REST] for x in (left, right)]
    load, own = ([x, y] for x, y in (torque, (left[ACCELERATION], right[ACCELERATION])))
    pairs = [(load, load), (own, own), (load, own), ((left[SPEED], right[SPEED]),) * 2]
    return np.array([_product(np.array([a[0], b[0]]), np.array([a[1], b[1]])) for a, b in pairs])


def _farthest(time: Array, sums: Array, cuts: NDArray[np.intp]) -> tuple[NDArray[np.intp], Array]:
    """Places where each block's sums are farthest from a straight line, and their distance."""
    pieces = np.diff(cuts)
    first, last = cuts[:-1], cuts[1:]
    slope = (sums[:, last] - sums[:, first]) / (time[last] - time[first])
    off = sums[:, :-1] - np.repeat(sums[:, first] - slope * time[first], pieces, axis=1)
    off -= np.repeat(slope, pieces, axis=1) * time[:-1]
    far = np.abs(off).max(axis=0)
    worst = np.maximum.reduceat(far, first)
    place = np.flatnonzero(far == np.repeat(worst, pieces))
    return place[np.searchsorted(place, first)], np.where(pieces > 1, worst, 0.0)


def bracket(
    motor: TwoBodies, ambient: float, cycle: Blocks, coefficients: Array, friction: Array, iron: Array
) -> Bracket:
    """Bounds of the winding's temperature over a cycle that repeats, for many motors.

    Parameters
    ----------
    motor
        Windings and housings: columns over n motors, or a figure that all have.
    ambient
        Temperature around the motors, above 42 K [K].
    cycle
        The load cycle in blocks.
    coefficients
        Current from the six functions, 0 or more: (n, 6) [A per unit of each].
    friction, iron
        Loss at the housing per speed [W s/rad] and per square of it [W s^2/rad^2], 0 or more.

    Returns
    -------
    Bracket
        Columns over motors: the upper one infinite where a motor may run away, the lower one where it certainly does;
        NaN where a figure is unknown.
    """
    n, size = len(coefficients), max(_CELLS // len(cycle.duration), 1)
    known = motor.known & ~np.isnan(coefficients.sum(axis=1) + friction + iron + ambient)
    if not known.all():
        motor = each_figure(motor, lambda x: np.where(known, x, 1.0))  # any figures, without effect
        coefficients, friction, iron = (np.where(known, x.T, 0.0).T for x in (coefficients, friction, iron))
    found = Bracket(*np.empty((2, n)), *np.empty((2, n, len(cycle.duration))))
    for rows in (slice(k, k + size) for k in range(0, n, size)):
        losses = _losses(cycle, coefficients[rows], friction[rows], iron[rows])
        part = _bounds(some_of(motor, n, rows), ambient, cycle.duration, losses)
        for whole, values in zip(found, part, strict=True):
            whole[rows] = values
    return Bracket(*(np.where(known, x.T, np.nan).T for x in found))


class _Losses(NamedTuple):
    """Of each block and motor the mean, and how far it deviates above and below: (3, blocks, motors)."""

    I2: Array  # A^2, then A^2 s
    P_h: Array  # W, then J


def _losses(cycle: Blocks, c: Array, friction: Array, iron: Array) -> _Losses:
    entries = np.stack(cycle[1:4])
    speed = entries[:, :, DIRECTION, SPEED, None] * friction + entries[:, :, SPEED, SPEED, None] * iron
    square, form = np.empty_like(speed), entries[:, :, _ROW, _COLUMN] * _TIMES
    few = max(_MULTIPLIED // form.size, 1)
    for rows in (slice(k, k + few) for k in range(0, len(c), few)):
        square[:, :, rows] = form @ (c[rows, _ROW] * c[rows, _COLUMN]).T
    return _Losses(np.maximum(square, 0.0), speed)


def _bounds(motor: TwoBodies, ambient: float, duration: Array, losses: _Losses) -> Bracket:
    """Temperatures of known motors."""
    share = (duration / duration.sum())[:, None]
    I2, P_h = ((share * x[0]).sum(axis=0) for x in losses)
    lower = steady_winding_temperature(ambient, motor.R_25, motor.R_th1, motor.R_th2, np.sqrt(I2), P_h)
    offset = ambient + 1.0 / COPPER - DATA_TEMPERATURE
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # where a motor runs away
        found = periodic(motor, ambient, duration[:, None], losses.I2[0], losses.P_h[0])
        low, each_low, each_high = _around(motor, offset, found, losses)
    high = each_high.max(axis=0)
    finite = found.settles & (high < np.inf) & (offset > 0.0)
    warmest = np.where(finite, each_high + ambient, np.inf)
    coolest = ambient + np.where(finite, np.maximum(each_low, 0.0), 0.0)
    lower = np.fmax(lower, np.where(finite, low + ambient, -np.inf))
    return Bracket(lower, np.where(finite, high + ambient, np.inf), coolest.T, warmest.T)


def _around(motor: TwoBodies, offset: float, found: Periodic, losses: _Losses) -> tuple[Array, Array, Array]:
    """Lower bound of the winding's highest rise, and both bounds of it in each block; infinite where there is none."""
    above, below = losses.I2[1:] * (COPPER * motor.R_25 / motor.capacity_w)
    housing = losses.P_h[1:].max(axis=1).sum(axis=0) / motor.capacity_h
    peak, loss = highest(found, 1.0, 0.0).rise, losses.P_h[0].max(axis=0)
    tops = _tops(found, 0)
    most = (loss + peak / motor.R_th1) / (1.0 / motor.R_th1 + 1.0 / motor.R_th2)  # where the housing turns round
    warm = np.minimum(_tops(found, 1).max(axis=0), most)
    down, up = _moved(motor, offset, (peak, warm, loss), (above.max(axis=0), below.max(axis=0), housing))
    rounding = _ROUNDING * (offset + peak)
    high = (offset + np.minimum(tops, peak) + up) * np.exp(above) - offset
    low = (offset + _bottoms(found) - down) * np.exp(-below) - offset
    return found.rises[0].max(axis=0) - down - rounding, low - rounding, high + rounding


def _bottoms(found: Periodic) -> Array:
    """Lower bounds of the winding's rise in each block: at its ends, or the tangent before it turns round."""
    values, slopes = found.rises[0], found.slopes[0]
    turns = (slopes < 0.0) & (found.pulls[0] > 0.0)
    bottom: Array = np.minimum(np.where(turns, slopes * found.t, 0.0) + values[:-1], values[1:])
    return bottom


def _tops(found: Periodic, body: int) -> Array:
    """Upper bounds of the rise of a body in each block: at its ends, or the tangent before it turns round."""
    values, slopes = found.rises[body], found.slopes[body]
    turns = (slopes > 0.0) & (found.pulls[body] < 0.0)
    top: Array = np.maximum(np.where(turns, slopes * found.t, 0.0) + values[:-1], values[1:])
    return top


def _moved(
    motor: TwoBodies, offset: float, most: tuple[Array, Array, Array], deviations: tuple[Array, Array, Array]
) -> tuple[Array, Array]:
    """Bounds of U below and above U_0 [K]: from the highest rises and housing loss, and what deviates."""
    (peak, warm, loss), (above, below, housing) = most, deviations
    R_1, R_2, ratio = motor.R_th1, motor.R_th2, motor.capacity_w / motor.capacity_h
    u, v, more = offset + peak, offset + warm, 1.0 + R_1 / R_2
    m, m_h = R_2 * u / offset, R_2 * v / offset
    J = warm * (1.0 + ratio * more) / R_2 + loss * ratio / (1.0 + ratio) * (2.0 + ratio * more)  # per m
    both = above + below
    either = both * m * J + housing * m / R_2
    down, up = above * u + either, below * u + either
    cooled = both * (u * ratio / (1.0 + ratio) + m_h * J)
    cooled += housing * (1.0 + 2.0 * m_h * (1.0 / R_1 + 1.0 / R_2))
    phi = np.maximum(above, below)
    bend = phi * phi * np.exp(phi) / 2.0 / R_1
    first, second = np.maximum(up, down), bend * (more * v + u)
    rest = _largest((phi / R_1 + bend) * more * m, m_h / m, 1.0 / more, first + m * second, cooled + m_h * second)
    return down + rest - first, up + rest - first


def _largest(a: Array, share: Array, own: Value, on_w: Array, on_h: Array) -> Array:
    """Largest |E| where |E| <= on_w + a (own |E| + |G|) and |G| <= on_h + share a (own |E| + |G|); infinite if any."""
    left = 1.0 - a * (own + share)  # both together: own |E| + |G| <= (own on_w + on_h) / left
    return np.where(left > 0.0, on_w + a * (own * on_w + on_h) / left, np.inf)
