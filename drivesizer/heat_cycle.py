"""How warm a motor gets over a cycle that repeats, and how long it bears an overload: winding, housing, ambient.

Two bodies: copper loss heats the winding, R_th1 leads to the housing, which a loss of its own heats too, R_th2 leads
to the ambient. The winding's resistance grows with its temperature, so that the square of the current stands in the
matrix: within a segment of constant mean square current the rises over ambient obey x' = A x + b, solved in closed
form. A couples two bodies, so its eigenvalues are real and distinct, and the lower one is negative also when the
winding runs away. All is written with divided differences of exp, exp[a, b] = (e^b - e^a) / (b - a) and so on,
which have no singular case (runaway limit, short segments) and add positive terms only.
Convention: temperatures in and out are absolute. Not here: magnets that weaken with heat.
Symbols: T temperature [K], R resistance [ohm], R_th thermal resistance [K/W], tau time constant [s], I current [A],
P_h loss at the housing [W]; in private functions w winding and h housing, rises over ambient [K].
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drivesizer.errors import InputError
from drivesizer.thermal import COPPER, DATA_TEMPERATURE, State, TwoBodies

__all__ = ["HeatCycle", "overload_time", "periodic_heat"]

Array = NDArray[np.float64]

_SERIES_GAP = 1.0  # divided differences over nodes closer than this come from the series
_SERIES_TERMS = 22  # of which the first one left out is below 1e-17 of the sum at that gap
_DOUBLINGS = 128  # of the fast time constant: 1e38 of them is for ever
_GRID, _ROUNDS = 65, 9  # a time is narrowed down by 64 each round: by 2^54 in all, the digits of a float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class HeatCycle:
    """Temperatures over a cycle that has repeated until nothing changes any more.

    All temperatures are infinite where the motor runs away, NaN where a figure is unknown.
    """

    winding_peak: float  # K, also within a segment
    winding_peak_time: float  # s from the cycle's start; NaN without a finite peak
    winding_mean: float  # K, over time
    housing_peak: float  # K
    housing_mean: float  # K
    spectral_radius: float  # share of a deviation that is left after one cycle; 1 and above is runaway [1]
    time: Array  # s, start of the cycle and end of each segment
    winding: Array  # K, at those times; the last is the first again
    housing: Array  # K


class _Modes(NamedTuple):
    """Per segment the matrix A, its eigenvalues fast < slow, and the diagonal of A - fast: all [1/s]."""

    fast: Array  # below zero
    slow: Array  # above zero where the current alone would let the motor run away
    ww: Array
    wh: float
    hw: float
    hh: float
    ww_fast: Array  # above zero, like wh and hw: what A - fast multiplies keeps its sign
    hh_fast: Array

    def slopes(self, w: Array, h: Array) -> tuple[Array, Array]:
        """A times a vector."""
        return self.ww * w + self.wh * h, self.hw * w + self.hh * h

    def pulls(self, w: Array, h: Array) -> tuple[Array, Array]:
        """(A - fast) times a vector."""
        return self.ww_fast * w + self.wh * h, self.hw * w + self.hh_fast * h


def _modes(motor: TwoBodies, I2: Array) -> _Modes:
    """Eigenvalues without cancellation: the determinant is known, and (A_ww - fast)(A_hh - fast) = A_wh A_hw."""
    ratio = motor.R_th2 / motor.R_th1
    feedback = COPPER * motor.R_25 * I2 * motor.R_th1
    ww, wh = (feedback - 1.0) / motor.tau_w, 1.0 / motor.tau_w
    hw, hh = ratio / motor.tau_h, -(1.0 + ratio) / motor.tau_h
    half = (ww - hh) / 2.0
    large = np.abs(half) + np.hypot(half, math.sqrt(wh * hw))
    small = wh * hw / large
    ww_fast, hh_fast = np.where(half > 0.0, large, small), np.where(half > 0.0, small, large)
    fast = hh - hh_fast
    determinant = (1.0 - feedback * (1.0 + ratio)) / (motor.tau_w * motor.tau_h)
    return _Modes(fast, determinant / fast, ww, wh, hw, hh, ww_fast, hh_fast)


def _divided_exp(*nodes: Array) -> Array:
    """Divided difference of exp over nodes in rising order, to rounding for any distance between them.

    References
    ----------
    .. [1] A. McCurdy, K. C. Ng, B. N. Parlett, *Accurate computation of divided differences of the exponential
       function*, Mathematics of Computation 43, 1984, pp. 501-528: recursion over the widest gap, series below it.
    """
    top = nodes[-1]
    gap = top - nodes[0]
    if len(nodes) == 2:
        share: Array = np.divide(-np.expm1(-gap), gap, out=np.ones_like(gap), where=gap > 0.0)
        return np.exp(top) * share
    close = gap < _SERIES_GAP
    wide = np.where(close, _SERIES_GAP, gap)
    recursion = (_divided_exp(*nodes[1:]) - _divided_exp(*nodes[:-1])) / wide
    if not close.any():
        return recursion
    near = [np.where(close, node - top, 0.0) for node in nodes[:-1]]
    return np.where(close, np.exp(top) * _series(near), recursion)


def _series(nodes: list[Array]) -> Array:
    """Divided difference of exp over 0 and other nodes: sum of h_k / (k + n)!, h_k complete symmetric polynomials."""
    order, zero = len(nodes), np.zeros_like(nodes[0])
    symmetric = [zero + 1.0] * order  # h_k of the first node, the first two, ... all
    total = symmetric[-1] / math.factorial(order)
    for k in range(1, _SERIES_TERMS):
        below = zero
        for n, node in enumerate(nodes):
            below = symmetric[n] = below + node * symmetric[n]
        total = total + below / math.factorial(k + order)
    return total


def _weights(modes: _Modes, t: Array) -> tuple[Array, Array]:
    """Weights of slope [s] and pull [s^2] at a segment's start in the change of temperature after t."""
    fast, slow, zero = modes.fast * t, modes.slow * t, np.zeros_like(t)
    between, top = np.minimum(slow, zero), np.maximum(slow, zero)
    return t * _divided_exp(fast, zero), t * t * _divided_exp(fast, between, top)


def _integral_weights(modes: _Modes, t: Array) -> tuple[Array, Array]:
    """The integrals of the weights from 0 to t [s^2, s^3]."""
    fast, slow, zero = modes.fast * t, modes.slow * t, np.zeros_like(t)
    between, top = np.minimum(slow, zero), np.maximum(slow, zero)
    return t**2 * _divided_exp(fast, zero, zero), t**3 * _divided_exp(fast, between, zero, top)


def _turning_time(modes: _Modes, slope: Array, pull: Array) -> Array:
    """Time after which a temperature turns round, the one zero of its slope; infinite where it never does.

    The slope is e^(fast t) [slope + pull (e^(gap t) - 1) / gap] with gap = slow - fast.
    """
    gap = modes.ww_fast + modes.hh_fast
    turns = slope * pull < 0.0
    with np.errstate(over="ignore"):
        ratio = np.divide(slope, pull, out=np.zeros_like(slope), where=turns)
        return np.where(turns, np.log1p(-gap * ratio) / gap, np.inf)


def _drive(motor: TwoBodies, ambient: float, I2: Array, P_h: Array) -> tuple[Array, Array]:
    """The constant part b of the slopes [K/s]."""
    at_ambient = motor.R_25 * (1.0 + COPPER * (ambient - DATA_TEMPERATURE))
    return at_ambient * I2 / motor.capacity_w, P_h / motor.capacity_h


class _Maps(NamedTuple):
    """What each segment adds to the rises: a matrix (exponential less one) times them, and a constant."""

    ww: Array
    wh: Array
    hw: Array
    hh: Array
    w: Array
    h: Array


def _maps(modes: _Modes, t: Array, drive: tuple[Array, Array]) -> _Maps:
    """Of the matrix times a vector v the pull is (A - fast) A v = slow (A - fast) v, by Cayley and Hamilton."""
    own, mixed = _weights(modes, t)
    both = own + mixed * modes.slow
    pulls = modes.pulls(*drive)
    return _Maps(
        own * modes.ww + mixed * modes.slow * modes.ww_fast,
        both * modes.wh,
        both * modes.hw,
        own * modes.hh + mixed * modes.slow * modes.hh_fast,
        own * drive[0] + mixed * pulls[0],
        own * drive[1] + mixed * pulls[1],
    )


def _whole(maps: _Maps) -> tuple[float, float, float, float, float, float]:
    """The map of the whole cycle, again less one, so that a short cycle loses no digits."""
    a = b = c = d = w = h = 0.0
    for p, q, r, s, e, f in zip(*(column.tolist() for column in maps), strict=True):
        a, c = a + (p + p * a + q * c), c + (r + r * a + s * c)
        b, d = b + (q + p * b + q * d), d + (s + r * b + s * d)
        w, h = w + (e + p * w + q * h), h + (f + r * w + s * h)
    return a, b, c, d, w, h


def _rises(maps: _Maps, w: float, h: float) -> tuple[Array, Array]:
    """Rises at the start and after each segment."""
    found_w, found_h = [w], [h]
    for p, q, r, s, e, f in zip(*(column.tolist() for column in maps), strict=True):
        w, h = w + (p * w + q * h + e), h + (r * w + s * h + f)
        found_w.append(w)
        found_h.append(h)
    return np.array(found_w), np.array(found_h)


def _nowhere(time: Array, temperature: float, radius: float) -> HeatCycle:
    everywhere = np.full_like(time, temperature)
    return HeatCycle(
        winding_peak=temperature,
        winding_peak_time=math.nan,
        winding_mean=temperature,
        housing_peak=temperature,
        housing_mean=temperature,
        spectral_radius=radius,
        time=time,
        winding=everywhere,
        housing=everywhere,
    )


def _columns(dt: ArrayLike, I2: ArrayLike, P_h: ArrayLike) -> list[Array]:
    columns = [np.array(c) for c in np.broadcast_arrays(*(np.asarray(x, dtype=np.float64) for x in (dt, I2, P_h)))]
    if columns[0].ndim != 1 or columns[0].size == 0:
        raise InputError(f"heat cycle: segments must form a list, got shape {columns[0].shape}")
    if (columns[0] < 0.0).any() or (columns[1] < 0.0).any() or not columns[0].any():
        raise InputError("heat cycle: durations and mean square currents must not be negative, nor all durations 0")
    return columns


def periodic_heat(motor: TwoBodies, ambient: float, dt: ArrayLike, I2: ArrayLike, P_h: ArrayLike = 0.0) -> HeatCycle:
    r"""Temperatures of winding and housing over a cycle that repeats for ever.

    .. math:: C_w \dot T_w &= R_{25} I^2 (1 + \alpha (T_w - T_{25})) - (T_w - T_h) / R_{th1} \\
              C_h \dot T_h &= P_h + (T_w - T_h) / R_{th1} - (T_h - T_a) / R_{th2}

    Parameters
    ----------
    motor
        Winding and housing.
    ambient
        Temperature around the motor, :math:`T_a` [K].
    dt
        Duration of each segment [s].
    I2
        Mean square current over each segment [A^2].
    P_h
        Mean loss at the housing over each segment, a brushed motor's k_t I_0 w [W].

    Returns
    -------
    HeatCycle
        The periodic state: infinite temperatures at runaway, NaN where a figure is unknown.

    Notes
    -----
    Exact for currents and losses that are constant in each segment: the segments' exponentials in closed form, their
    product over the cycle :math:`\Phi`, and the state that solves :math:`(1 - \Phi) x = g`; its spectral radius must
    be below 1. The peak within a segment is exact too: the winding's slope is zero at one time at most, in closed form.

    Examples
    --------
    >>> motor = TwoBodies(R_25=2.32, R_th1=3.1, R_th2=14.0, tau_w=12.4, tau_h=612.0)
    >>> cycle = periodic_heat(motor, 298.15, [2.0, 18.0], [9.0, 0.0])
    >>> round(cycle.winding_peak - 273.15, 1), round(cycle.winding_mean - 273.15, 1)
    (73.2, 66.7)
    """
    t, square, loss = _columns(dt, I2, P_h)
    time = np.concatenate(([0.0], np.cumsum(t)))
    if not motor.known or math.isnan(ambient + float(t.sum() + square.sum() + loss.sum())):
        return _nowhere(time, math.nan, math.nan)
    modes, drive = _modes(motor, square), _drive(motor, ambient, square, loss)
    with np.errstate(over="ignore", invalid="ignore"):
        maps = _maps(modes, t, drive)
    a, b, c, d, w, h = _whole(maps)
    determinant = a * d - b * c
    if not (determinant > 0.0 and a < 0.0 and math.isfinite(determinant + w + h)):
        return _nowhere(time, math.inf, _radius(a, b, c, d))
    rises = _rises(maps, (b * h - d * w) / determinant, (c * w - a * h) / determinant)
    return _cycle(modes, drive, t, time, rises, ambient, _radius(a, b, c, d))


def _radius(a: float, b: float, c: float, d: float) -> float:
    """Spectral radius of 1 + (a b, c d), a matrix without negative entries."""
    found = 1.0 + (a + d) / 2.0 + math.hypot((a - d) / 2.0, math.sqrt(max(b * c, 0.0)))
    return found if math.isfinite(found) else math.inf


def _cycle(
    modes: _Modes,
    drive: tuple[Array, Array],
    t: Array,
    time: Array,
    rises: tuple[Array, Array],
    ambient: float,
    radius: float,
) -> HeatCycle:
    starts = rises[0][:-1], rises[1][:-1]
    slopes = tuple(s + b for s, b in zip(modes.slopes(*starts), drive, strict=True))
    pulls = modes.pulls(slopes[0], slopes[1])
    own, mixed = _integral_weights(modes, t)
    found = []
    for start, slope, pull in zip(starts, slopes, pulls, strict=True):
        mean = float((t * start + own * slope + mixed * pull).sum() / time[-1]) + ambient
        found.append((mean, *_peak(modes, start + ambient, slope, pull, t, time)))
    (winding_mean, winding_peak, peak_time), (housing_mean, housing_peak, _) = found
    return HeatCycle(
        winding_peak=winding_peak,
        winding_peak_time=peak_time,
        winding_mean=winding_mean,
        housing_peak=housing_peak,
        housing_mean=housing_mean,
        spectral_radius=radius,
        time=time,
        winding=rises[0] + ambient,
        housing=rises[1] + ambient,
    )


def _peak(modes: _Modes, start: Array, slope: Array, pull: Array, t: Array, time: Array) -> tuple[float, float]:
    """Highest temperature and when: each segment's start, or where it stops rising (at the end of it at the latest)."""
    until = np.where(slope > 0.0, np.minimum(_turning_time(modes, slope, pull), t), 0.0)
    own, mixed = _weights(modes, until)
    reached = start + own * slope + mixed * pull
    n = int(reached.argmax())
    return float(reached[n]), float(time[n] + until[n])


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
    the crossing is bracketed within it and narrowed down to rounding.

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
    modes, drive = _modes(motor, square), _drive(motor, ambient, square, np.array([P_h]))
    w, h = np.array([start.winding - ambient]), np.array([start.housing - ambient])
    slopes = tuple(s + b for s, b in zip(modes.slopes(w, h), drive, strict=True))
    return _crossing(modes, slopes[0], modes.pulls(slopes[0], slopes[1])[0], T_max - start.winding)


def _crossing(modes: _Modes, slope: Array, pull: Array, climb: float) -> float:
    """First time at which the winding is warmer than at the start by a climb."""

    def reached(t: Array) -> NDArray[np.bool_]:
        with np.errstate(over="ignore"):
            own, mixed = _weights(modes, t)
            return np.asarray(own * slope + (mixed * pull if pull.any() else 0.0) >= climb)

    turn = float(_turning_time(modes, slope, pull)[0])
    rises_first = slope[0] > 0.0 or (slope[0] == 0.0 and pull[0] > 0.0)
    first, last = (0.0, turn) if rises_first else (turn, math.inf)
    if math.isinf(first) or math.isinf(climb):
        return math.inf
    times = np.minimum(first + np.ldexp(-1.0 / modes.fast[0], np.arange(_DOUBLINGS)), last)
    times = np.concatenate(([first], times))
    hits = np.flatnonzero(reached(times))
    if hits.size == 0:
        return math.inf
    low, high = float(times[max(int(hits[0]) - 1, 0)]), float(times[hits[0]])
    for _ in range(_ROUNDS):
        grid = np.linspace(low, high, _GRID)
        n = int(np.append(reached(grid[:-1]), True).argmax())
        low, high = float(grid[max(n - 1, 0)]), float(grid[n])
    return high
