"""How warm a motor gets over a cycle that repeats: winding and housing.

Within a segment of constant mean square current both move in closed form (see ``heat_modes``); the cycle's map is the
product of the segments', and the periodic state is its fixed point. The functions before ``periodic_heat`` take
segments along the first axis, of one motor or of columns over motors (see ``heat_columns``).
Convention: temperatures in and out are absolute. Not here: a single overload (see ``overload``).
Symbols: T temperature [K], R resistance [ohm], R_th thermal resistance [K/W], tau time constant [s], I current [A],
P_h loss at the housing [W]; in private functions w winding and h housing, rises over ambient [K].
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drivesizer.errors import InputError
from drivesizer.heat_modes import Array, Modes, Weights, drive, modes, turning_time, weights
from drivesizer.thermal import TwoBodies

__all__ = ["HeatCycle", "Periodic", "checked", "highest", "mean_rise", "periodic", "periodic_heat"]

_BEYOND = (
    1e9  # K: a winding that is warmer after one cycle has run away; what cools again from there has lost its digits
)


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


class _Maps(NamedTuple):
    """What each segment adds to the rises: a matrix (exponential less one) times them, and a constant."""

    ww: Array
    wh: Array
    hw: Array
    hh: Array
    w: Array
    h: Array

    def each(self) -> Iterator[tuple[Any, ...]]:
        """Segment by segment: floats of one motor, in which arithmetic is faster, or rows over motors."""
        return zip(*((column.tolist() if column.ndim == 1 else column) for column in self), strict=True)


def _maps(span: Modes, weight: Weights, constant: tuple[Array, Array]) -> _Maps:
    """Of the matrix times a vector v the pull is (A - fast) A v = slow (A - fast) v, by Cayley and Hamilton."""
    own, mixed = weight.slope, weight.pull * span.slow
    both = own + mixed
    pull_w, pull_h = span.pulls(*constant)
    return _Maps(
        own * span.ww + mixed * span.ww_fast,
        both * span.wh,
        both * span.hw,
        own * span.hh + mixed * span.hh_fast,
        own * constant[0] + weight.pull * pull_w,
        own * constant[1] + weight.pull * pull_h,
    )


def _whole(maps: _Maps) -> tuple[Any, ...]:
    """The map of the whole cycle, again less one, so that a short cycle loses no digits; highest rise from the cold."""
    a: Any = 0.0
    b = c = d = w = h = a
    warmth = []
    for p, q, r, s, e, f in maps.each():
        a, c = a + (p + p * a + q * c), c + (r + r * a + s * c)
        b, d = b + (q + p * b + q * d), d + (s + r * b + s * d)
        w, h = w + (e + p * w + q * h), h + (f + r * w + s * h)
        warmth.append(w)
    return a, b, c, d, w, h, np.max(warmth, axis=0)


def _rises(maps: _Maps, w: Any, h: Any) -> tuple[Array, Array]:
    """Rises at the start and after each segment."""
    found_w, found_h = [w], [h]
    for p, q, r, s, e, f in maps.each():
        w, h = w + (p * w + q * h + e), h + (r * w + s * h + f)
        found_w.append(w)
        found_h.append(h)
    return np.array(found_w), np.array(found_h)


class Periodic(NamedTuple):
    """A cycle's segments and what repeats in it: segments along the first axis, then motors; pairs: w, h."""

    t: Array  # s, duration of each segment
    span: Modes
    constant: tuple[Array, Array]  # K/s
    weight: Weights  # at each segment's end
    rises: tuple[Array, Array]  # K, at the start and after each segment
    slopes: tuple[Array, Array]  # K/s, at each segment's start
    pulls: tuple[Array, Array]  # K/s^2, there
    whole: tuple[Any, ...]  # the cycle's map less one: matrix row by row, constant; highest rise from the cold [K]
    settles: NDArray[np.bool_]  # whether there is a periodic state; where not, rises and what follows mean nothing


def periodic(motor: TwoBodies, ambient: float, t: Array, I2: Array, P_h: Array) -> Periodic:
    """The periodic state of known motors.

    Parameters
    ----------
    motor
        Winding and housing, all figures known.
    ambient
        Temperature around the motor [K].
    t
        Duration of each segment: along the first axis, and of as many axes as the others [s].
    I2
        Mean square current over each segment [A^2].
    P_h
        Mean loss at the housing over each segment [W].
    """
    with np.errstate(over="ignore", invalid="ignore"):
        span, constant = modes(motor, I2), drive(motor, ambient, I2, P_h)
        weight = weights(span.fast, span.slow, t)
        maps = _maps(span, weight, constant)
        whole = _whole(maps)
        start, settles = _fixed_point(*whole)
        w, h = rises = _rises(maps, *start)
        slope_w, slope_h = (x + b for x, b in zip(span.slopes(w[:-1], h[:-1]), constant, strict=True))
        pulls = span.pulls(slope_w, slope_h)
    return Periodic(t, span, constant, weight, rises, (slope_w, slope_h), pulls, whole, settles)


def _fixed_point(a: Any, b: Any, c: Any, d: Any, w: Any, h: Any, warmth: Any) -> tuple[list[Any], NDArray[np.bool_]]:
    """The rises that a cycle ends with as it started, and whether they are approached: a spectral radius below 1."""
    determinant = np.asarray(a * d - b * c)
    settles = (determinant > 0.0) & (np.asarray(a) < 0.0) & np.isfinite(determinant + h) & (warmth < _BEYOND)
    safe = np.where(settles, determinant, np.nan)
    start = (np.asarray((b * h - d * w) / safe), np.asarray((c * w - a * h) / safe))
    return [x.item() if x.ndim == 0 else x for x in start], settles


def mean_rise(found: Periodic, body: int) -> Array:
    """Mean over time of a body's rise [K].

    Parameters
    ----------
    found
        The periodic state.
    body
        0 the winding, 1 the housing.
    """
    change = found.weight.slope_integral * found.slopes[body] + found.weight.pull_integral * found.pulls[body]
    mean: Array = (found.t * found.rises[body][:-1] + change).sum(axis=0) / found.t.sum(axis=0)
    return mean


def highest(found: Periodic, body: int) -> tuple[Array, Array]:
    """Highest rise of a body in each segment [K], and how long after the segment's start [s].

    Parameters
    ----------
    found
        The periodic state.
    body
        0 the winding, 1 the housing.
    """
    starts, ends = found.rises[body][:-1], found.rises[body][1:]
    later = ends > starts
    reached, until = np.where(later, ends, starts), np.where(later, found.t, 0.0)
    inner = np.nonzero((found.slopes[body] > 0.0) & (found.pulls[body] < 0.0))
    columns = (found.span.fast, found.span.slow, found.t, starts, found.slopes[body], found.pulls[body])
    fast, slow, t, start, slope, pull = (np.broadcast_to(x, reached.shape)[inner] for x in columns)
    turn = turning_time(slow - fast, slope, pull)
    within = turn < t
    turn, slope, pull, inner = turn[within], slope[within], pull[within], tuple(x[within] for x in inner)
    weight = weights(fast[within], slow[within], turn)
    reached[inner], until[inner] = start[within] + weight.slope * slope + weight.pull * pull, turn
    return reached, until


def checked(dt: ArrayLike, I2: ArrayLike) -> tuple[Array, Array]:
    """Durations [s] and mean square currents [A^2] as arrays; an error where they form no cycle."""
    t, square = np.asarray(dt, dtype=np.float64), np.asarray(I2, dtype=np.float64)
    if t.ndim != 1 or t.size == 0:
        raise InputError(f"heat cycle: segments must form a list, got shape {t.shape}")
    if (t < 0.0).any() or (square < 0.0).any() or not t.any():
        raise InputError("heat cycle: durations and mean square currents must not be negative, nor all durations 0")
    return t, square


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
    t, square = checked(dt, I2)
    t, square, loss = np.broadcast_arrays(t, square, np.asarray(P_h, dtype=np.float64))
    time = np.concatenate(([0.0], np.cumsum(t)))
    if not motor.known or math.isnan(ambient + float(t.sum() + square.sum() + loss.sum())):
        return _nowhere(time, math.nan, math.nan)
    found = periodic(motor, ambient, t, square, loss)
    if not found.settles:
        return _nowhere(time, math.inf, _radius(*found.whole))
    winding, peak_time = _peak(found, 0, time)
    return HeatCycle(
        winding_peak=ambient + winding,
        winding_peak_time=peak_time,
        winding_mean=ambient + float(mean_rise(found, 0)),
        housing_peak=ambient + _peak(found, 1, time)[0],
        housing_mean=ambient + float(mean_rise(found, 1)),
        spectral_radius=_radius(*found.whole),
        time=time,
        winding=ambient + found.rises[0],
        housing=ambient + found.rises[1],
    )


def _peak(found: Periodic, body: int, time: Array) -> tuple[float, float]:
    """Highest rise of a body, and when."""
    reached, until = highest(found, body)
    n = int(reached.argmax())
    return float(reached[n]), float(time[n] + until[n])


def _radius(a: float, b: float, c: float, d: float, w: float, h: float, warmth: float) -> float:
    """Spectral radius of 1 + (a b, c d), a matrix without negative entries."""
    if not warmth < _BEYOND:
        return math.inf
    found = 1.0 + (a + d) / 2.0 + math.hypot((a - d) / 2.0, math.sqrt(max(b * c, 0.0)))
    return found if math.isfinite(found) else math.inf


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
