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
    """The map of the whole cycle, again less one, so that a short cycle loses no digits."""
    a: Any = 0.0
    b = c = d = w = h = a
    for p, q, r, s, e, f in maps.each():
        a, c = a + (p + p * a + q * c), c + (r + r * a + s * c)
        b, d = b + (q + p * b + q * d), d + (s + r * b + s * d)
        w, h = w + (e + p * w + q * h), h + (f + r * w + s * h)
    return a, b, c, d, w, h


def _rises(maps: _Maps, w: Any, h: Any) -> tuple[Array, Array]:
    """Rises at the start and after each segment."""
    found_w, found_h = [w], [h]
    for p, q, r, s, e, f in maps.each():
        w, h = w + (p * w + q * h + e), h + (r * w + s * h + f)
        found_w.append(w)
        found_h.append(h)
    return np.array(found_w), np.array(found_h)


class Periodic(NamedTuple):
    """A cycle's segments and the rises that repeat in it: segments along the first axis, then motors."""

    t: Array  # s, duration of each segment
    span: Modes
    constant: tuple[Array, Array]  # K/s
    weight: Weights  # at each segment's end
    rises: tuple[Array, Array]  # K, winding and housing at the start and after each segment; 0 where it runs away
    whole: tuple[Any, ...]  # the cycle's map less one: matrix row by row, constant
    settles: NDArray[np.bool_]  # whether there is a periodic state


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
        a, b, c, d, w, h = whole = _whole(maps)
        determinant = np.asarray(a * d - b * c)
        settles = (determinant > 0.0) & (np.asarray(a) < 0.0) & np.isfinite(determinant + w + h)
        safe = np.where(settles, determinant, np.inf)
        start = (np.where(settles, x, 0.0) / safe for x in (b * h - d * w, c * w - a * h))
        rises = _rises(maps, *(x.item() if x.ndim == 0 else x for x in start))
    return Periodic(t, span, constant, weight, rises, whole, settles)


def _starts(found: Periodic, body: int) -> tuple[Array, Array]:
    """Slope [K/s] and pull [K/s^2] of one body at each segment's start."""
    slopes = found.span.slopes(found.rises[0][:-1], found.rises[1][:-1])
    slope_w, slope_h = slopes[0] + found.constant[0], slopes[1] + found.constant[1]
    return (slope_w, slope_h)[body], found.span.pulls(slope_w, slope_h)[body]


def mean_rise(found: Periodic, body: int) -> Array:
    """Mean over time of a body's rise [K].

    Parameters
    ----------
    found
        The periodic state.
    body
        0 the winding, 1 the housing.
    """
    slope, pull = _starts(found, body)
    change = found.weight.slope_integral * slope + found.weight.pull_integral * pull
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
    slope, pull = _starts(found, body)
    rising = slope > 0.0
    ends = found.rises[0][1:], found.rises[1][1:]
    falls_then = found.span.slopes(*ends)[body] + found.constant[body] < 0.0
    reached = np.where(rising, ends[body], found.rises[body][:-1])
    until = np.where(rising, found.t, 0.0)
    inner = np.nonzero(rising & falls_then)
    if inner[0].size:
        start, slope, pull, t = (
            np.broadcast_to(x, reached.shape)[inner] for x in (found.rises[body][:-1], slope, pull, found.t)
        )
        fast, slow = found.span.fast[inner], found.span.slow[inner]
        turn = np.minimum(turning_time(found.span.gap[inner], slope, pull), t)
        weight = weights(fast, slow, turn)
        reached[inner] = start + weight.slope * slope + weight.pull * pull
        until[inner] = turn
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
        return _nowhere(time, math.inf, _radius(*found.whole[:4]))
    winding, peak_time = _peak(found, 0, time)
    return HeatCycle(
        winding_peak=ambient + winding,
        winding_peak_time=peak_time,
        winding_mean=ambient + float(mean_rise(found, 0)),
        housing_peak=ambient + _peak(found, 1, time)[0],
        housing_mean=ambient + float(mean_rise(found, 1)),
        spectral_radius=_radius(*found.whole[:4]),
        time=time,
        winding=ambient + found.rises[0],
        housing=ambient + found.rises[1],
    )


def _peak(found: Periodic, body: int, time: Array) -> tuple[float, float]:
    """Highest rise of a body, and when."""
    reached, until = highest(found, body)
    n = int(reached.argmax())
    return float(reached[n]), float(time[n] + until[n])


def _radius(a: float, b: float, c: float, d: float) -> float:
    """Spectral radius of 1 + (a b, c d), a matrix without negative entries."""
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
