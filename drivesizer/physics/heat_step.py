"""Winding and housing, two bodies: temperatures over a span of constant load, and the permitted time of an overload."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.thermal import COPPER, DATA_TEMPERATURE, TwoBodies, Value, steady_winding_temperature

__all__ = [
    "Array", "Course", "Modes", "State", "Weights", "cold", "drive", "modes", "overload_time", "phi", "steady_state",
    "turning_time", "weights",
]  # fmt: skip


# -- Temperatures of winding and housing, two bodies, over a span of constant mean square current and constant losses.
#
# Copper loss heats the winding, R_th1 leads to the housing, which a loss of its own heats too, R_th2 leads to the
# ambient. The winding's resistance grows with its temperature, so that the square of the current stands in the
# matrix: the rises over ambient obey x' = A x + b, solved in closed form. A couples two bodies, so its eigenvalues
# are real and distinct, and the lower one is negative also when the winding runs away. All is written with divided
# differences of the exponential, which have no singular case (runaway limit, short spans). All functions are
# elementwise: a motor's figures are floats, or columns over motors that broadcast against the spans. Convention:
# rises over ambient inside. Not here: magnets that weaken with heat. Symbols: R resistance [ohm], R_th thermal
# resistance [K/W], tau time constant [s], I current [A], P_h loss at the housing [W], w winding and h housing: rises
# over ambient [K].


Array = NDArray[np.float64]

_NEGLIGIBLE = 1e-18  # the first term that a series leaves out: a thousandth of the rounding of its sum
_COEFFICIENTS = [1.0 / math.factorial(k + 2) for k in range(24)]  # of the series of phi_2
_CLOSE = 1e-5  # of two nodes, so near that the slope between stands for their divided difference
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
    Within 1 a series is summed, whose divided difference Horner's scheme carries along; beyond, the divided difference
    is the quotient that it stands for, or the slope between where both nodes are so near that their difference would
    lose digits.

    References
    ----------
    .. [1] N. J. Higham, *Functions of Matrices*, SIAM, 2008, section 10.7.4.
    """
    size = np.maximum(-f, s)
    near = size <= 1.0
    if near.all():
        return _from_second(f, s)
    found = tuple(np.empty_like(f) for _ in range(4))
    for rows, part in ((near, _from_second), (~near, _beyond)):
        for whole, some in zip(found, part(f[rows], s[rows]), strict=True):
            whole[rows] = some
    return found  # type: ignore[return-value]


def _from_second(f: Array, s: Array) -> tuple[Array, Array, Array, Array]:
    """The four functions of nodes within 1: the second by its series, the first as 1 + x phi_2(x)."""
    single_2, pair_2 = _series(f, s)
    return 1.0 + f * single_2, single_2 + s * pair_2, single_2, pair_2


def _beyond(f: Array, s: Array) -> tuple[Array, Array, Array, Array]:
    """The same of nodes of which one at least is beyond 1."""
    gap, middle = s - f, (s + f) / 2.0
    (f_1, f_2), (s_1, s_2) = _phi(f), _phi(s)
    close = gap < _CLOSE * -middle
    if not close.any():
        return f_1, (s_1 - f_1) / gap, f_2, (s_2 - f_2) / gap
    gap, middle = np.where(close, 1.0, gap), np.where(close, middle, 1.0)
    m_1, m_2 = _phi(middle)
    slope_1, slope_2 = ((a - n * b) / middle for n, a, b in ((1.0, np.exp(middle), m_1), (2.0, m_1, m_2)))
    return f_1, np.where(close, slope_1, (s_1 - f_1) / gap), f_2, np.where(close, slope_2, (s_2 - f_2) / gap)


def _phi(x: Array) -> tuple[Array, Array]:
    """The two functions at one node."""
    with np.errstate(divide="ignore", invalid="ignore"):
        single = np.expm1(x) / x
        second = (single - 1.0) / x
    if (small := np.abs(x) <= 1.0).any():
        single[small], _, second[small], _ = _from_second(x[small], x[small])
    return single, second


def _series(f: Array, s: Array) -> tuple[Array, Array]:
    """phi_2(f) and phi_2[f, s] by Horner's scheme: sum of x^k / (k + 2)!, as many terms as the largest node needs."""
    largest = float(np.maximum(-f, s).max(initial=0.0))
    count = next(k for k in range(2, len(_COEFFICIENTS)) if k * largest ** (k - 1) * _COEFFICIENTS[k] < _NEGLIGIBLE)
    single, pair = np.full_like(f, _COEFFICIENTS[count - 1]), np.zeros_like(f)
    for term in reversed(_COEFFICIENTS[: count - 1]):
        pair *= s
        pair += single
        single *= f
        single += term
    return single, pair


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


# -- Permitted time of an overload, and the states from which one starts: cold, or settled.
#
# Convention: temperatures are absolute; one constant current, one constant loss at the housing (see ``heat_step``).
# Not here: a current that varies (see ``heat_cycle``).
# Symbols: T temperature [K], P_h loss at the housing [W], w winding and h housing: rises over ambient [K].


_DOUBLINGS = 128  # of the fast time constant: 1e38 of them is taken as infinite
_ROUNDS, _PARTS = (
    10,
    64,
)  # of the search for a crossing, in each of which the span is so many times shorter: to rounding


class State(NamedTuple):
    """Temperatures of winding and housing [K]."""

    winding: float
    housing: float


def cold(ambient: float) -> State:
    """A motor at ambient temperature [K]."""
    return State(ambient, ambient)


def steady_state(motor: TwoBodies, ambient: float, I_rms: float, P_h: float = 0.0) -> State:
    """Temperatures of one motor in the long run at a constant RMS current.

    Parameters
    ----------
    motor
        Winding and housing.
    ambient
        Temperature around the motor [K].
    I_rms
        RMS current [A].
    P_h
        Loss at the housing [W].

    Returns
    -------
    State
        As ``steady_winding_temperature`` and ``TwoBodies.housing`` have them; NaN where a figure is unknown.

    Examples
    --------
    >>> motor = TwoBodies(R_25=2.32, R_th1=3.1, R_th2=14.0, tau_w=12.4, tau_h=612.0)
    >>> [round(T - 298.15, 2) for T in steady_state(motor, 298.15, 1.0)]
    [46.93, 38.43]
    """
    if not motor.known:
        return State(math.nan, math.nan)
    winding = float(steady_winding_temperature(ambient, motor.R_25, motor.R_th1, motor.R_th2, I_rms, P_h))
    return State(winding, float(motor.housing(ambient, winding, P_h)))


def overload_time(
    motor: TwoBodies, ambient: float, start: State, T_max: float, current: float, P_h: float = 0.0
) -> float:
    """Time until the winding reaches its permitted temperature at a constant current.

    Parameters
    ----------
    motor
        Winding and housing.
    ambient
        Temperature around the motor [K].
    start
        Temperatures at the start: ``cold(ambient)``, ``steady_state(...)`` or any other [K].
    T_max
        Permitted winding temperature [K].
    current
        Current, RMS [A].
    P_h
        Loss at the housing [W].

    Returns
    -------
    float
        Time [s]; 0 where the start is at the limit already, infinite where it is never reached, NaN where a figure is
        unknown.

    Notes
    -----
    At a constant current the winding's temperature turns round once at most, so that it rises over one span of time;
    the crossing is bracketed within it and narrowed down.

    Examples
    --------
    >>> motor = TwoBodies(R_25=2.32, R_th1=3.1, R_th2=14.0, tau_w=12.4, tau_h=612.0)
    >>> round(overload_time(motor, 298.15, State(298.15, 298.15), 373.15, 4.0), 1)
    9.9
    """
    if not motor.known or math.isnan(ambient + start.winding + start.housing + T_max + current + P_h):
        return math.nan
    if start.winding >= T_max:
        return 0.0
    square = np.array([current * current])
    span, constant = modes(motor, square), drive(motor, ambient, square, np.array([P_h]))
    w, h = np.array([start.winding - ambient]), np.array([start.housing - ambient])
    slope_w, slope_h = (s + b for s, b in zip(span.slopes(w, h), constant, strict=True))
    return _crossing(span, slope_w, span.pulls(slope_w, slope_h)[0], T_max - start.winding)


def _crossing(span: Modes, slope: Array, pull: Array, climb: float) -> float:
    """First time at which the winding is warmer than at the start by a climb."""

    def above(t: Array) -> Array:
        with np.errstate(over="ignore", invalid="ignore"):
            weight = weights(span.fast, span.slow, t)
            return np.asarray(weight.slope * slope + (weight.pull * pull if pull.any() else 0.0) - climb)

    turn = float(turning_time(span.slow - span.fast, slope, pull)[0])
    rises_first = slope[0] > 0.0 or (slope[0] == 0.0 and pull[0] > 0.0)
    first, last = (0.0, turn) if rises_first else (turn, math.inf)
    if math.isinf(first) or math.isinf(climb):
        return math.inf
    times = np.append(first, np.minimum(first + np.ldexp(-1.0 / span.fast[0], np.arange(_DOUBLINGS)), last))
    hits = np.flatnonzero(above(times) >= 0.0)
    if not hits.size:
        return math.inf
    low, high = times[max(hits[0] - 1, 0)], times[hits[0]]
    for _ in range(_ROUNDS):
        grid = np.linspace(low, high, _PARTS + 1)
        n = max(int((above(grid) >= 0.0).argmax()), 1)
        low, high = grid[n - 1], grid[n]
    return float(high)
