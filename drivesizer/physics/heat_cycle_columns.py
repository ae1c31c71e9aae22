"""Bounds of winding temperatures over a periodic cycle, in closed form, for many motors at once.

The exact temperatures are the kernel's.
Convention: temperatures in and out are absolute; a motor with an unknown figure gives NaN, one that runs away infinity.
Symbols: R resistance [ohm], R_th thermal resistance [K/W], tau time constant [s], I current [A], P_h loss at the
housing [W].
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drivesizer.physics.heat_step import Array, modes
from drivesizer.physics.thermal import TwoBodies, Value, resistance_at, settled, steady_winding_temperature

__all__ = ["WindingBounds", "coolest_winding", "winding_bounds"]


class WindingBounds(NamedTuple):
    """Two temperatures between which the winding's peak lies."""

    lower: Array  # K
    upper: Array  # K


def winding_bounds(
    motor: TwoBodies,
    ambient: float,
    I_rms: Value,
    I_peak: Value,
    total: float,
    P_h_mean: Value = 0.0,
    P_h_peak: Value = 0.0,
) -> WindingBounds:
    r"""Bounds of the winding's peak over any cycle of which no more is known than mean and peak of its losses.

    Parameters
    ----------
    motor
        Windings and housings: columns over motors.
    ambient
        Temperature around the motors [K].
    I_rms
        RMS current over the cycle [A].
    I_peak
        Largest current, or root of the largest mean square over a segment [A].
    total
        Duration of the cycle [s].
    P_h_mean, P_h_peak
        Mean and largest loss at the housing, which is nowhere below zero [W].

    Returns
    -------
    WindingBounds
        Columns over motors; both are exact for constant currents, the upper one also for a rectangular pulse whose
        resistance stays what it is at the peak.

    Notes
    -----
    **Lower**: the steady temperature at the RMS current and the mean housing loss. Let u be the resistance over that at
    the mean temperature, so that its mean is 1, v the housing's answer, q ~ u I^2 the copper loss and c a constant:

    .. math:: C_w \dot u = q + c - (u - v) / R_{th1}, \quad C_h \dot v = (u - v) / R_{th1} - v / R_{th2}

    Means over the cycle: the second over v gives that of u/v as 1 + R_th1/R_th2, hence that of v/u is at least its
    inverse; the first over u then gives that of (q + c)/u as at most 1/(R_th1 + R_th2), which is the mean of q + c; and
    that of 1/u is at least 1. So the mean of q is at least that of q/u: the copper loss is at least that of mean
    resistance and mean square current, and the mean temperature is above the bound. A housing loss that varies can take
    from that mean, but less than the peak is above it as long as the peak is not some 256 K below the bound; it cannot
    get there, for it is continuous in how far the loss varies.

    **Upper**: with the peak's resistance all the time the winding is nowhere cooler. It then answers to a unit pulse of
    loss with a sum of decaying exponentials, so that of all losses of the same mean and largest value the one
    in one piece, just before, heats it most. That resistance's temperature solves the steady state's equation, with
    another thermal resistance. A loss at the housing heats the winding no more than the housing, which answers alike.
    """
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        lower = steady_winding_temperature(ambient, motor.R_25, motor.R_th1, motor.R_th2, I_rms, P_h_mean)
        square, I2 = np.maximum(I_rms, I_peak) ** 2, np.square(I_rms)
        loss = np.maximum(P_h_mean, P_h_peak)
        winding, housing = _pulse_resistances(motor, total, _share(I2, square), _share(P_h_mean, loss))
        upper = settled(ambient, winding * motor.R_25 * square, housing * loss)
    return WindingBounds(*(np.where(motor.known & ~np.isnan(upper), x, np.nan) for x in (lower, upper)))


def coolest_winding(
    motor: TwoBodies, ambient: float, I_rms: Value, total: float, P_h_mean: Value, peak: Value
) -> Array:
    r"""A temperature below which a winding is at no moment of a cycle that repeats [K].

    Parameters
    ----------
    motor
        Windings and housings: columns over motors.
    ambient
        Temperature around the motors [K].
    I_rms
        RMS current over the cycle [A].
    total
        Duration of the cycle [s].
    P_h_mean
        Mean loss at the housing [W].
    peak
        A lower bound of the winding's peak, ``winding_bounds`` has one [K].

    Returns
    -------
    array
        The temperature, of each motor [K].

    Notes
    -----
    At some moment the housing's rise is at least its mean, :math:`R_{th2}` times the mean losses, and the winding's is
    at least that of ``peak``; from there on they decrease no faster than without any loss:

    .. math:: C_h \dot v \ge -(1/R_{th1} + 1/R_{th2}) v, \quad C_w \dot u \ge -(u - v)/R_{th1}

    All of the cycle follows within its duration.
    """
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        copper = resistance_at(motor.R_25, ambient) * np.square(I_rms)
        left = np.exp(-total * (1.0 + motor.R_th2 / motor.R_th1) / motor.tau_h)
        housing = motor.R_th2 * (copper + P_h_mean) * left
        above = np.maximum(peak - ambient - housing, 0.0) * np.exp(-total / motor.tau_w)
        rise = np.minimum(housing, peak - ambient) + above
    return ambient + np.where(motor.known & np.isfinite(rise), np.maximum(rise, 0.0), 0.0)


def _share(mean: Value, largest: Value) -> Array:
    """Shortest share of the cycle in which all of a loss can come."""
    whole = np.asarray(largest == 0.0)
    return np.where(whole, 1.0, mean / np.where(whole, 1.0, largest))


def _pulse_resistances(motor: TwoBodies, total: float, share_w: Array, share_h: Array) -> tuple[Array, Array]:
    """Highest rise per loss of winding and of housing, each heated for a share of every cycle [K/W].

    Both answer to a unit pulse with a sum of exponentials; for the share 1 the whole thermal resistance remains.
    """
    span = modes(motor, np.zeros(1))
    found = []
    for share, capacity, to_slow in (
        (share_w, motor.capacity_w, span.ww_fast),
        (share_h, motor.capacity_h, span.hh_fast),
    ):
        to_fast = span.ww_fast + span.hh_fast - to_slow
        kept = [
            c / -x * np.expm1(x * share * total) / np.expm1(x * total)
            for c, x in ((to_fast, span.fast), (to_slow, span.slow))
        ]
        found.append((kept[0] + kept[1]) / (span.slow - span.fast) / capacity)
    return found[0], found[1]
