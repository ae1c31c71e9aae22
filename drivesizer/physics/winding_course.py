"""Temperature of windings over a periodic cycle, for many motors at once, with the current that heats them.

The mathematics is that of ``heat_cycle``, with motors along the last axis, a block of them at a time;
``heat_cycle_columns`` has bounds of the peak.
Convention: temperatures are absolute; a motor with an unknown figure gives NaN, one that runs away an infinite peak and
else NaN.
Symbols: I current [A], P_h loss at the housing [W].
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import AtGearhead, CycleAtBelt, Pieces, Turning
from drivesizer.physics.extremes import first_largest
from drivesizer.physics.heat_cycle import Highest, Periodic, highest, mean_rise, periodic, periodic_in_parts, tops
from drivesizer.physics.heat_cycle_columns import some_of
from drivesizer.physics.heat_step import Array
from drivesizer.physics.load_cycle import Figure
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.several_belts import behind_each
from drivesizer.physics.stress import Heat, volts_of
from drivesizer.physics.thermal import TwoBodies, two_bodies
from drivesizer.physics.waveform import Wave, mean_square, wave

__all__ = ["Rises", "WindingCourse", "current_and_winding", "winding_course", "winding_rises"]

_CELLS = 1 << 14  # motors times pieces in a block: what stays in the processor's cache
_PART = 1 << 15  # pieces of a long cycle at a time


class WindingCourse(NamedTuple):
    """Temperatures of n windings over the P pieces of a periodic cycle."""

    peak: Array  # K, also within a piece: (n,)
    peak_time: Array  # s from the cycle's start
    mean: Array  # K, over time
    ends: Array  # K, at both ends of each piece; its highest, where nothing else changes in it: (n, P, 2)
    means: Array  # K, over each piece: (n, P)


class Rises(NamedTuple):
    """Rises of n windings over ambient in periodic steady state; without meaning where there is none."""

    found: Periodic
    peak: Highest  # also within a piece
    ends: Array  # K, at both ends of each piece; its highest, where nothing else changes in it: (P, 2, n)
    means: Array  # K, over each piece: (P, n)


def current_and_winding(
    ambient: float, cycle: AtGearhead, demands: Demands, heat: Heat, motor: Any
) -> tuple[Wave, WindingCourse]:
    """Current and induced voltage over the pieces of the cycle, and the winding's temperature.

    Parameters
    ----------
    ambient
        Temperature around the motors [K].
    cycle
        The load cycle behind the belts of the candidates.
    demands, heat
        Required torque and current, and losses of the candidates: columns.
    motor
        Figures of the motors by field name: columns.

    Returns
    -------
    tuple of Wave and WindingCourse
        The voltage without that of the resistance; a winding in thermal runaway at its permitted temperature, where it
        fails, one of unknown time constants at its mean in the long run, as a cycle makes it that is short against
        them.
    """
    base: CycleAtBelt = cycle.base
    short = base.census is None
    duration, steady = (base.warming.duration, cycle.turning.steady) if short else (base.lasting, base.steady)
    flowing, loss = behind_each(cycle, _flowing, demands, heat, motor["torque_constant"])
    flows = Wave(duration, *flowing)
    course = winding_course(two_bodies(motor), ambient, duration, mean_square(flows), loss, steady)
    mean = np.where(np.isfinite(heat.winding), heat.winding, np.nan)
    for rows, T in ((np.isinf(course.peak), motor["max_winding_temperature"]), (np.isnan(course.peak), mean)):
        for x in (course.mean, course.ends, course.means) if rows.any() else ():
            x[rows] = T[rows].reshape(-1, *[1] * (x.ndim - 1))
    return flows, course


def _flowing(at: AtGearhead, demands: Demands, heat: Heat, k_t: Array) -> tuple[tuple[Array, Array], Array]:
    """Current and voltage behind one belt, and the loss at the housing [W]."""
    induced = volts_of(demands, k_t, np.zeros_like(k_t))

    def of(pieces: Pieces, turning: Turning) -> tuple[Array, Array, Array]:
        flows = wave(*pieces, demands.coefficients, induced, k_t)
        loss = np.outer(heat.friction, turning.mean) + np.outer(heat.iron, turning.square)
        return flows.current, flows.voltage, loss

    current, voltage, loss = _joined(len(k_t), at.base, (of(*part) for part in at.warming_in_parts()))
    return (current, voltage), loss


def _joined(n: int, base: CycleAtBelt, parts: Iterator[tuple[Array, Array, Array]]) -> tuple[Array, Array, Array]:
    """Current, voltage and loss of n candidates over all pieces, from those over some at a time."""
    if base.census is None:
        return next(parts)
    count, end = len(base.lasting), 0
    found = np.empty((n, count, 2)), np.empty((n, count, 2)), np.empty((n, count))
    for part in parts:
        first, end = end, end + part[0].shape[1]
        for whole, some in zip(found, part, strict=True):
            whole[:, first:end] = some
    return found


def winding_course(
    motor: TwoBodies, ambient: float, duration: Array, I2: Array, P_h: Array, steady: NDArray[np.bool_]
) -> WindingCourse:
    """Temperatures of many windings over a cycle in periodic steady state.

    Parameters
    ----------
    motor
        Windings and housings: columns over n motors, or a figure that all have.
    ambient
        Temperature around the motors [K].
    duration
        Of each of P pieces [s].
    I2, P_h
        Mean square current [A^2] and mean loss at the housing [W] of each piece, shape (n, P).
    steady
        Pieces in which current and speed stay what they are: of these the warmer end stands for the warmest moment,
        which may be within, so that what is largest there is found at the ends.

    Returns
    -------
    WindingCourse
        Columns over motors; NaN where a figure is unknown, the peak infinite at thermal runaway.
    """
    n, count = I2.shape
    known = np.flatnonzero(np.broadcast_to(motor.known, n) & ~np.isnan(I2.sum(axis=1) + P_h.sum(axis=1) + ambient))
    size = max(_CELLS // count, 1)
    if len(known) == n == 1:  # of a long cycle a second copy would take much room
        return _block(motor, ambient, duration, I2, P_h, steady)
    peak, when, mean = np.full((3, n), np.nan)
    found = WindingCourse(peak, when, mean, np.full((n, count, 2), np.nan), np.full((n, count), np.nan))
    for rows in (known[first : first + size] for first in range(0, len(known), size)):
        part = _block(some_of(motor, n, rows), ambient, duration, I2[rows], P_h[rows], steady)
        for whole, values in zip(found, part, strict=True):
            whole[rows] = values
    return found


def _block(
    motor: TwoBodies, ambient: float, t: Array, I2: Array, P_h: Array, steady: NDArray[np.bool_]
) -> WindingCourse:
    """Of motors all of whose figures are known."""
    if len(t) > _PART:
        return _in_parts(motor, ambient, t, I2, P_h, steady)
    columns = np.ascontiguousarray(I2.T), np.ascontiguousarray(P_h.T)
    found, peak, ends, means = winding_rises(motor, ambient, t[:, None], *columns, steady[:, None])
    with np.errstate(over="ignore", invalid="ignore"):  # where a motor runs away
        mean = mean_rise(found, 0)
    good, time = found.settles, np.cumsum(t) - t
    return WindingCourse(
        np.where(good, peak.rise + ambient, np.inf),
        np.where(good, time[peak.segment] + peak.until, np.nan),
        np.where(good, mean + ambient, np.nan),
        np.where(good[:, None, None], np.moveaxis(ends, -1, 0) + ambient, np.nan),
        np.where(good[:, None], means.T + ambient, np.nan),
    )


def _in_parts(
    motor: TwoBodies, ambient: float, t: Array, I2: Array, P_h: Array, steady: NDArray[np.bool_]
) -> WindingCourse:
    """The same over a long cycle, part by part."""
    n, count = I2.shape
    ends, means, tops, time = np.empty((n, count, 2)), np.empty((n, count)), list[Highest](), np.cumsum(t) - t
    slices = [slice(first, min(first + _PART, count)) for first in range(0, count, _PART)]
    good = np.zeros(n, bool)
    with np.errstate(over="ignore", invalid="ignore"):  # where a motor runs away
        for k, found in zip(slices, periodic_in_parts(motor, ambient, t[:, None], I2.T, P_h.T, slices), strict=True):
            left, mean = _of_pieces(found, steady[k, None])
            ends[:, k], means[:, k], good = np.moveaxis(left, -1, 0), mean.T, found.settles
            tops.append(highest(found, 1.0, 0.0))
        rise, part = first_largest(np.array([top.rise for top in tops]).T)
        of_parts = [time[k][top.segment] + top.until for k, top in zip(slices, tops, strict=True)]
        when = np.array(of_parts)[part, np.arange(n)]
        mean = means @ t / t.sum()
    for column in (rise, mean, ends, means):
        column += ambient
    ends[~good] = means[~good] = np.nan
    return WindingCourse(
        np.where(good, rise, np.inf), np.where(good, when, np.nan), np.where(good, mean, np.nan), ends, means
    )


def winding_rises(
    motor: TwoBodies, ambient: Figure, t: Array, I2: Array, P_h: Array, steady: NDArray[np.bool_]
) -> Rises:
    """Rises of windings over ambient in periodic steady state, all figures known.

    Parameters
    ----------
    motor
        Windings and housings: columns over n motors.
    ambient
        Temperature around the motors [K].
    t
        Duration of each of P pieces [s], shape (P, 1), or (P, n) where each motor has a cycle of its own.
    I2, P_h
        Mean square current [A^2] and mean loss at the housing [W] of each piece, shape (P, n).
    steady
        As in ``winding_course``, shape (P, 1).

    Returns
    -------
    Rises
        Motors last; without meaning where ``found.settles`` is false.
    """
    with np.errstate(over="ignore", invalid="ignore"):  # where a motor runs away
        found = periodic(motor, ambient, t, I2, P_h)
        return Rises(found, highest(found, 1.0, 0.0), *_of_pieces(found, steady))


def _of_pieces(found: Periodic, steady: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Rises of the winding [K] at both ends of the pieces, (P, 2, n), and their means over each, (P, n)."""
    left, right = found.rises[0][:-1], found.rises[0][1:]
    top, later = tops(found, steady), right >= left
    ends = [np.where(steady & warmer, top, x) for x, warmer in ((left, ~later), (right, later))]
    change = found.weight.slope_integral * found.slopes[0] + found.weight.pull_integral * found.pulls[0]
    means = left + np.divide(change, found.t, out=np.zeros_like(change), where=found.t > 0.0)
    return np.stack(ends, axis=1), means
