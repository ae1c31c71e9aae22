"""Winding and housing over a cycle in periodic steady state, and bounds of it for many motors at once."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drivesizer.errors import InputError
from drivesizer.physics.extremes import first_largest
from drivesizer.physics.heat_step import Array, Course, Modes, Weights, drive, modes, turning_time, weights
from drivesizer.physics.thermal import TwoBodies

__all__ = ["HeatCycle", "periodic", "periodic_heat"]


# -- Temperatures of winding and housing over a cycle in periodic steady state.
#
# Within a segment of constant mean square current both move in closed form (see ``heat_step``); the cycle's map is
# the product of the segments', and the periodic state is its fixed point. The functions before ``periodic_heat``
# take segments along the first axis, of one motor or of columns over motors (see ``heat_cycle_columns``).
# Convention: temperatures in and out are absolute. Not here: a single overload (see ``overload``). Symbols: T
# temperature [K], R resistance [ohm], R_th thermal resistance [K/W], tau time constant [s], I current [A], P_h loss
# at the housing [W]; in private functions w winding and h housing, rises over ambient [K].


# K: a winding that is warmer after one cycle has run away; the digits of a lower temperature after it are lost
_BEYOND = 1e9
_KEPT = 8  # parts of a long cycle whose spans are kept; of more they are computed twice, for they take much room
_DIGITS = 9  # of rises [K] in which equal ones agree


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class HeatCycle:
    """Temperatures over a cycle in periodic steady state.

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


def _maps(span: Modes, weight: Weights, constant: tuple[Array, Array]) -> Array:
    """Increments of the rises over each segment: a matrix (exponential less one) times them, and a constant.

    Rows w and h, columns w, h and constant, then segments and motors. Of the matrix times a vector v the pull is
    (A - fast) A v = slow (A - fast) v, by Cayley and Hamilton.
    """
    own, mixed = weight.slope, weight.pull * span.slow
    both = own + mixed
    found = np.empty((2, 3, *own.shape))
    np.multiply(both, span.wh, out=found[0, 1])
    np.multiply(both, span.hw, out=found[1, 0])
    found[0, 0] = own * span.ww + mixed * span.ww_fast
    found[1, 1] = own * span.hh + mixed * span.hh_fast
    for row, start, pull in zip(found, constant, span.pulls(*constant), strict=True):
        row[2] = own * start + weight.pull * pull
    return found


class Periodic(NamedTuple):
    """A cycle's segments and its periodic state: segments along the first axis, then motors; pairs: w, h."""

    t: Array  # s, duration of each segment
    span: Modes
    constant: tuple[Array, Array]  # K/s
    weight: Weights  # at each segment's end
    rises: Array  # K, at the start and after each segment
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

    Returns
    -------
    Periodic
        Rises over ambient in periodic steady state; without meaning where ``settles`` is false.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        spans = _spans(motor, ambient, t, I2, P_h)
        whole = (*_matrix(spans.course), spans.course.rises(0.0, 0.0)[0].max(axis=0))
        start, settles = _fixed_point(*whole)
        return _from(spans, start, whole, settles)


class _Spans(NamedTuple):
    """Segments and what they do, whatever they start from: the first fields of ``Periodic``, and the course."""

    t: Array
    span: Modes
    constant: tuple[Array, Array]
    weight: Weights
    course: Course


def _spans(motor: TwoBodies, ambient: float, t: Array, I2: Array, P_h: Array) -> _Spans:
    span, constant = modes(motor, I2), drive(motor, ambient, I2, P_h)
    weight = weights(span.fast, span.slow, t)
    return _Spans(t, span, constant, weight, Course(_maps(span, weight, constant)))


def _matrix(course: Course) -> tuple[Array, ...]:
    """The map less one over all spans: matrix row by row, constant."""
    return *course.whole[:, :2].reshape(4, -1), *course.whole[:, 2]


def _starts(between: Course, start: Array) -> Array:
    """Rises at the start of each part [K]: shape (parts, 2, motors)."""
    found: Array = np.concatenate([start[:, None], between.rises(*start)[:, :-1]], axis=1).swapaxes(0, 1)
    return found


def _from(spans: _Spans, start: Array, whole: tuple[Any, ...], settles: NDArray[np.bool_]) -> Periodic:
    """Rises over spans from those at their start."""
    t, span, constant, weight, course = spans
    w, h = rises = np.concatenate([start[:, None], course.rises(*start)], axis=1)
    slope_w, slope_h = (x + b for x, b in zip(span.slopes(w[:-1], h[:-1]), constant, strict=True))
    pulls = span.pulls(slope_w, slope_h)
    return Periodic(t, span, constant, weight, rises, (slope_w, slope_h), pulls, whole, settles)


def _fixed_point(
    a: Array, b: Array, c: Array, d: Array, w: Array, h: Array, warmth: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """The rises that a cycle ends with as it started, and whether they are approached: a spectral radius below 1."""
    determinant = a * d - b * c
    settles = (determinant > 0.0) & (a < 0.0) & np.isfinite(determinant + h) & (warmth < _BEYOND)
    return np.array([b * h - d * w, c * w - a * h]) / np.where(settles, determinant, np.nan), settles


def mean_rise(found: Periodic, body: int) -> Array:
    """Mean over time of a body's rise [K].

    Parameters
    ----------
    found
        The periodic state.
    body
        0 the winding, 1 the housing.

    Returns
    -------
    array
        Of each motor [K].
    """
    change = found.weight.slope_integral * found.slopes[body] + found.weight.pull_integral * found.pulls[body]
    mean: Array = (found.t * found.rises[body][:-1] + change).sum(axis=0) / found.t.sum(axis=0)
    return mean


class Highest(NamedTuple):
    """The highest that something gets, of each motor."""

    rise: Array  # K
    segment: NDArray[np.intp]  # in which
    until: Array  # s, from that segment's start


def highest(found: Periodic, *shares: float) -> Highest:
    """Highest sum of the rises over the cycle.

    Parameters
    ----------
    found
        The periodic state.
    shares
        What is summed: shares of the winding's rise and of the housing's [1].

    Returns
    -------
    Highest
        The sum, and when it is met, of each motor.

    Notes
    -----
    Such a sum turns round once in a segment at most, and up to there it is below its tangent at the segment's start:
    only where that reaches above all segments' ends is there a peak within a segment to be found.
    """
    w, h = shares
    values, slopes, pulls = (w * x[0] + h * x[1] for x in (found.rises, found.slopes, found.pulls))
    top, segment = first_largest(values[1:].T)  # the first start is the last end
    until = np.broadcast_to(found.t, slopes.shape)[segment, np.arange(len(segment))]
    inner, turn, reached = _turned(found, values, slopes, pulls, top)
    if not len(reached):  # mostly: the highest is at an end
        return Highest(top, segment, until)
    order = np.lexsort((-inner[0], np.round(reached, _DIGITS)))
    order = order[reached[order] > top[inner[1][order]]]
    motor = inner[1][order]  # the last one counts: the highest, of those alike the first
    top[motor], segment[motor], until[motor] = reached[order], inner[0][order], turn[order]
    return Highest(top, segment, until)


def _turned(found: Periodic, values: Array, slopes: Array, pulls: Array, top: Array) -> tuple[Any, Array, Array]:
    """Extremes of a sum of rises within segments that may be above ``top``: the places, when and how high."""
    t = np.broadcast_to(found.t, slopes.shape)
    inner = np.nonzero((slopes > 0.0) & (pulls < 0.0) & (values[:-1] + t * slopes > top))
    if not len(inner[0]):
        return inner, np.zeros(0), np.zeros(0)
    columns = (found.span.fast, found.span.slow, t, values[:-1], slopes, pulls)
    fast, slow, t, start, slope, pull = (
        (x if x.shape == slopes.shape else np.broadcast_to(x, slopes.shape))[inner] for x in columns
    )
    turn = np.minimum(turning_time(slow - fast, slope, pull), t)
    weight = weights(fast, slow, turn)
    return inner, turn, start + weight.slope * slope + weight.pull * pull


def checked(dt: ArrayLike, I2: ArrayLike) -> tuple[Array, Array]:
    """Durations [s] and mean square currents [A^2] as arrays; an error where they form no cycle.

    Parameters
    ----------
    dt
        Duration of each segment [s].
    I2
        Mean square current over each segment [A^2].

    Returns
    -------
    tuple of arrays
        Both as arrays of floats.
    """
    t, square = np.asarray(dt, dtype=np.float64), np.asarray(I2, dtype=np.float64)
    if t.ndim != 1 or t.size == 0:
        raise InputError(f"heat cycle: segments must form a list, got shape {t.shape}")
    if (t < 0.0).any() or (square < 0.0).any() or not t.any():
        raise InputError("heat cycle: durations and mean square currents must not be negative, nor all durations 0")
    return t, square


def periodic_heat(motor: TwoBodies, ambient: float, dt: ArrayLike, I2: ArrayLike, P_h: ArrayLike = 0.0) -> HeatCycle:
    r"""Temperatures of winding and housing over a cycle in periodic steady state.

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
    found = periodic(motor, ambient, *(x[:, None] for x in (t, square, loss)))
    radius = _radius(*(float(x[0]) for x in found.whole))
    if not found.settles[0]:
        return _nowhere(time, math.inf, radius)
    winding, housing = highest(found, 1.0, 0.0), highest(found, 0.0, 1.0)
    return HeatCycle(
        winding_peak=ambient + float(winding.rise[0]),
        winding_peak_time=float(time[winding.segment[0]] + winding.until[0]),
        winding_mean=ambient + float(mean_rise(found, 0)[0]),
        housing_peak=ambient + float(housing.rise[0]),
        housing_mean=ambient + float(mean_rise(found, 1)[0]),
        spectral_radius=radius,
        time=time,
        winding=ambient + found.rises[0, :, 0],
        housing=ambient + found.rises[1, :, 0],
    )


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
