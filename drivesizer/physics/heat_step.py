"""Temperatures of winding and housing, two bodies, over a span of constant mean square current and constant losses.

Copper loss heats the winding, R_th1 leads to the housing, which a loss of its own heats too, R_th2 leads to the
ambient. The winding's resistance grows with its temperature, so that the square of the current stands in the matrix:
the rises over ambient obey x' = A x + b, solved in closed form. A couples two bodies, so its eigenvalues are real and
distinct, and the lower one is negative also when the winding runs away. All is written with divided differences of
the exponential, which have no singular case (runaway limit, short spans).
All functions are elementwise: a motor's figures are floats, or columns over motors that broadcast against the spans.
Convention: rises over ambient inside. Not here: magnets that weaken with heat.
Symbols: R resistance [ohm], R_th thermal resistance [K/W], tau time constant [s], I current [A], P_h loss at the
housing [W], w winding and h housing: rises over ambient [K].
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.thermal import COPPER, DATA_TEMPERATURE, TwoBodies, Value

__all__ = ["Array", "Course", "Modes", "Weights", "drive", "modes", "phi", "turning_time", "weights"]

Array = NDArray[np.float64]

_NEGLIGIBLE = 1e-18  # the first term that a series leaves out: a thousandth of the rounding of its sum
_COEFFICIENTS = [1.0 / math.factorial(k + 2) for k in range(24)]  # of the series of phi_2
_FEW = 4  # nodes that are doubled one by one
_RUN = 16  # spans of a run
_WIDE = 256  # motors: their columns are long enough for the processor without runs


class Modes(NamedTuple):
    """The matrix A of each span, its eigenvalues fast < slow, and the diagonal of A - fast: all [1/s]."""

    fast: Array  # below zero
    slow: Array  # above zero where the current alone would let the motor run away
    ww: Array
    wh: Value
    hw: Value
    hh: Value
    ww_fast: Array  # above zero, like wh and hw: what A - fast multiplies keeps its sign
    hh_fast: Array

    def slopes(self, w: Array, h: Array) -> tuple[Array, Array]:
        """A times a vector."""
        return self.ww * w + self.wh * h, self.hw * w + self.hh * h

    def pulls(self, w: Array, h: Array) -> tuple[Array, Array]:
        """(A - fast) times a vector."""
        return self.ww_fast * w + self.wh * h, self.hw * w + self.hh_fast * h


def modes(motor: TwoBodies, I2: Array) -> Modes:
    """Matrix and eigenvalues of each span.

    Parameters
    ----------
    motor
        Winding and housing: of one motor, or columns that broadcast against the spans.
    I2
        Mean square current over each span [A^2].

    Returns
    -------
    Modes
        Matrix and eigenvalues [1/s], of each span and motor.

    Notes
    -----
    Without cancellation: the determinant is known, and (A_ww - fast)(A_hh - fast) = A_wh A_hw.
    """
    ratio = motor.R_th2 / motor.R_th1
    feedback = (COPPER * motor.R_25 * motor.R_th1) * I2
    wh, hw, hh = 1.0 / motor.tau_w, ratio / motor.tau_h, -(1.0 + ratio) / motor.tau_h
    ww = (feedback - 1.0) / motor.tau_w
    half = (ww - hh) / 2.0
    large = np.abs(half) + np.sqrt(half * half + wh * hw)
    small = wh * hw / large
    above = half > 0.0
    ww_fast, hh_fast = np.where(above, large, small), np.where(above, small, large)
    fast = hh - hh_fast
    slow = (1.0 - feedback * (1.0 + ratio)) / (motor.tau_w * motor.tau_h) / fast
    return Modes(fast, slow, ww, wh, hw, hh, ww_fast, hh_fast)


def drive(motor: TwoBodies, ambient: float, I2: Array, P_h: Array) -> tuple[Array, Array]:
    """The constant part b of the slopes [K/s], of winding and housing.

    Parameters
    ----------
    motor
        Winding and housing.
    ambient
        Temperature around the motor [K].
    I2
        Mean square current over each span [A^2].
    P_h
        Loss at the housing over each span [W].

    Returns
    -------
    tuple of arrays
        Of winding and housing [K/s].
    """
    at_ambient = motor.R_25 * (1.0 + COPPER * (ambient - DATA_TEMPERATURE))
    return at_ambient / motor.capacity_w * I2, P_h / motor.capacity_h


class Weights(NamedTuple):
    """Weights of slope and pull at a span's start in the change of temperature after a time, and in its integral."""

    slope: Array  # s
    pull: Array  # s^2
    slope_integral: Array  # s^2
    pull_integral: Array  # s^3


def weights(fast: Array, slow: Array, t: Array) -> Weights:
    """Weights of slope and pull in the change after a time, and in the integral of that change up to it.

    Parameters
    ----------
    fast, slow
        The eigenvalues, fast < slow and fast < 0 [1/s].
    t
        Time from the span's start [s].

    Returns
    -------
    Weights
        Of each span and motor.
    """
    single, pair, single_2, pair_2 = phi(fast * t, slow * t)
    square = t * t
    single *= t
    pair *= square
    single_2 *= square
    pair_2 *= square * t
    return Weights(single, pair, single_2, pair_2)


def phi(f: Array, s: Array) -> tuple[Array, Array, Array, Array]:
    r"""phi_1(f), phi_1[f, s], phi_2(f), phi_2[f, s]: divided differences of exp over f, s and zeros, to rounding.

    .. math:: \varphi_1(x) = \frac{e^x - 1}{x}, \quad \varphi_2(x) = \frac{e^x - 1 - x}{x^2}, \quad
              \varphi[f, s] = \frac{\varphi(s) - \varphi(f)}{s - f}

    Parameters
    ----------
    f, s
        Nodes of the same shape, f <= s and f <= 0 [1].

    Returns
    -------
    tuple of arrays
        The four functions [1], each of the shape of the nodes.

    Notes
    -----
    Nodes beyond 1 are halved until they are not, the series is summed there (Horner's scheme carries the divided
    difference along), and the functions of the matrix (f 1, 0 s) are doubled back: sums of positive terms only.

    References
    ----------
    .. [1] N. J. Higham, *Functions of Matrices*, SIAM, 2008, section 10.7.4: phi functions by scaling and doubling.
    """
    size = np.maximum(-f, s)
    largest = float(size.max(initial=0.0))
    if largest <= 1.0:
        return _from_second(f, s, *_series(f, s, largest))
    rounds = np.maximum(np.frexp(size)[1], 0)
    f, s = np.ldexp(f, -rounds), np.ldexp(s, -rounds)
    found = _from_second(f, s, *_series(f, s, 1.0))
    wide = np.flatnonzero(rounds)
    order = wide[np.argsort(-rounds.ravel()[wide].astype(np.int16), kind="stable")]
    for values, doubled in zip(found, _doubled(rounds, f, s, found, order), strict=True):
        np.put(values, order, doubled)
    return found


def _series(f: Array, s: Array, largest: float) -> tuple[Array, Array]:
    """phi_2(f) and phi_2[f, s] by Horner's scheme: sum of x^k / (k + 2)!, as many terms as the largest node needs."""
    count = next(k for k in range(2, len(_COEFFICIENTS)) if k * largest ** (k - 1) * _COEFFICIENTS[k] < _NEGLIGIBLE)
    single, pair = np.full_like(f, _COEFFICIENTS[count - 1]), np.zeros_like(f)
    for term in reversed(_COEFFICIENTS[: count - 1]):
        pair *= s
        pair += single
        single *= f
        single += term
    return single, pair


def _from_second(f: Array, s: Array, single_2: Array, pair_2: Array) -> tuple[Array, Array, Array, Array]:
    """The first function from the second, phi_1(x) = 1 + x phi_2(x): for nodes within 1."""
    return 1.0 + f * single_2, single_2 + s * pair_2, single_2, pair_2


def _doubled(rounds: Array, f: Array, s: Array, found: tuple[Array, ...], order: NDArray[np.intp]) -> tuple[Array, ...]:
    """The functions at nodes that are doubled back, those that take most rounds first: a round is a slice."""
    rounds, f, s = (values.ravel()[order] for values in (rounds, f, s))
    p_f, p, q_f, q = (values.ravel()[order] for values in found)
    p_s = p_f + (s - f) * p
    table = (f * p_f, s * p_s, p_f + s * p, p_f, p_s, p, q_f, q)
    if len(rounds) <= _FEW:
        return _doubled_alone(rounds.tolist(), table)
    with np.errstate(over="ignore"):
        for n in range(1, int(rounds[0]) + 1):
            count = int(np.count_nonzero(rounds >= n))
            _double(*([values[:count] for values in table] if count < len(rounds) else table))
    return p_f, p, q_f, q


def _doubled_alone(rounds: list[int], table: tuple[Array, ...]) -> tuple[Array, ...]:
    """The same node by node: of few, figures are quicker than columns."""
    found = []
    for count, *node in zip(rounds, *(values.tolist() for values in table), strict=True):
        values = tuple(node)
        for _ in range(count):
            values = _double(*values)
        found.append(values)
    _, _, _, p_f, _, p, q_f, q = np.array(found).T
    return p_f, p, q_f, q


def _double(
    m_f: Value, m_s: Value, e: Value, p_f: Value, p_s: Value, p: Value, q_f: Value, q: Value
) -> tuple[Value, ...]:
    """exp less 1 at f and at s, exp over both, phi_1 and phi_2 likewise: now at 2 f and 2 s; columns in place.

    phi_2(2 x) = phi_1(x)^2 / 4 + phi_2(x) / 2, phi_1(2 x) = phi_1(x) (e^x + 1) / 2; over both nodes by the product
    rule, halved once more because their distance doubles. Less 1, for the digits of a node far below the other.
    """
    q *= 0.25
    q += p * (p_f + p_s) / 8.0
    q_f *= 0.5
    q_f += p_f * p_f / 4.0
    p *= m_s + 2.0
    p += p_f * e
    p *= 0.25
    p_f *= m_f / 2.0 + 1.0
    p_s *= m_s / 2.0 + 1.0
    e *= (m_f + m_s) / 2.0 + 1.0
    m_f *= m_f + 2.0
    m_s *= m_s + 2.0
    return m_f, m_s, e, p_f, p_s, p, q_f, q


def turning_time(gap: Array, slope: Array, pull: Array) -> Array:
    """Time after which a temperature turns round, the one zero of its slope [s]; infinite where it never does.

    Parameters
    ----------
    gap
        Distance of the eigenvalues, slow - fast [1/s].
    slope
        Slope of the temperature at the start [K/s].
    pull
        (A - fast) times the slopes, the row of this temperature [K/s^2].

    Returns
    -------
    array
        Time from the start [s].

    Notes
    -----
    The slope is e^(fast t) [slope + pull (e^(gap t) - 1) / gap].
    """
    turns = slope * pull < 0.0
    with np.errstate(over="ignore"):
        ratio = np.divide(slope, pull, out=np.zeros_like(slope), where=turns)
        return np.where(turns, np.log1p(-gap * ratio) / gap, np.inf)


class Course:
    """The rises over many spans: runs of spans side by side, then run after run, since a step costs the same for all.

    Parameters
    ----------
    maps
        What each span adds to the rises: rows w and h; columns w and h, what they are multiplied with, and a
        constant [K]; then spans, then motors.
    """

    def __init__(self, maps: Array) -> None:
        _, _, self.count, n = maps.shape
        length = self.count if n > _WIDE or self.count < _RUN else _RUN
        runs = -(-self.count // length)
        if runs * length > self.count:  # spans that do nothing
            maps = np.concatenate([maps, np.zeros((2, 3, runs * length - self.count, n))], axis=2)
        self.within = np.ascontiguousarray(np.moveaxis(maps.reshape(2, 3, runs, length, n), 3, 0))
        for k in range(1, length):
            _follow(self.within[k], self.within[k - 1])
        self.before = np.zeros((2, 3, runs, n))  # each run
        self.whole = self.within[-1, :, :, 0]
        if runs > 1:
            self._join(Course(self.within[-1]))

    def _join(self, runs: Course) -> None:
        up_to = runs.within
        for k in range(len(up_to)):
            _follow(up_to[k], runs.before)
        flat = np.moveaxis(up_to, 0, 3).reshape(2, 3, -1, up_to.shape[-1])
        self.before[:, :, 1:] = flat[:, :, : runs.count - 1]
        self.whole = runs.whole

    def rises(self, w: Value, h: Value) -> Array:
        """Rises of winding and housing after each span, from those at the start [K]."""
        start = [x + row[0] * w + row[1] * h + row[2] for x, row in zip((w, h), self.before, strict=True)]
        found = self.within[:, :, 0] * start[0]
        found += self.within[:, :, 1] * start[1]
        found += self.within[:, :, 2]
        found += np.array(start)
        in_order: Array = np.moveaxis(found, 0, 2).reshape(2, -1, found.shape[-1])
        return in_order[:, : self.count]


def _follow(maps: Array, so_far: Array) -> None:
    """In place: the maps after what came so far, all less one, so that short segments lose no digits."""
    added = maps[:, :1] * so_far[0]
    added += maps[:, 1:2] * so_far[1]
    added += so_far
    maps += added
