"""Limits of voltage by the bus and of current by the I2t integral; arrays as in ``layout``."""

from __future__ import annotations

import math

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.layout import Array
from drivesizer.control.engine.tallies import keep_peak

__all__ = ["available_voltage"]


def available_voltage(p: Array, i: float, demand: float) -> float:
    """Largest voltage at full duty under a current, by the law of ``physics.power_stage``.

    V_s = V_0 - R_s n I_s with V_s I_s = (duty (V_s - drop) + loss) i; of that duty (V_s - drop) - R_b i is left.
    """
    along = i if demand >= 0.0 else -i
    r = p[at.R_S] * p[at.SETS] * along
    if r < 0.0 and p[at.RAISES] == 0.0:
        r = 0.0
    V = p[at.V_0]
    if r != 0.0:
        half = 0.5 * (p[at.V_0] - r * p[at.DUTY])
        V = half + math.sqrt(max(0.0, half * half - r * (p[at.LOSS] - p[at.DUTY] * p[at.DROP])))
    return float(max(0.0, float(p[at.DUTY]) * (V - p[at.DROP]) - p[at.R_B] * along))


def record_bus(p: Array, g: Array, power: float, t: float, dt: float) -> None:
    """Record voltage, current and heat of the bus under the power of all drives, V^2 - V_0 V + R_s P = 0.

    ``power``: into each power stage, over a time; standby power comes to it.
    """
    P = p[at.SETS] * power
    if P < 0.0 and p[at.RAISES] == 0.0:
        P = 0.0
    P += p[at.SETS] * p[at.STANDBY]
    V = p[at.V_0]
    if p[at.R_S] > 0.0:
        V = 0.5 * (p[at.V_0] + math.sqrt(max(0.0, p[at.V_0] * p[at.V_0] - 4.0 * p[at.R_S] * P)))
    g[at.G_V_LOW], g[at.G_V_HIGH] = min(g[at.G_V_LOW], V), max(g[at.G_V_HIGH], V)
    if P > 0.0:
        keep_peak(g, at.G_BUS, P / V, t)
        if p[at.R_S] > 0.0:
            g[at.G_RESISTED] += p[at.R_S] * P / V * P / V * dt


def permitted_current(p: Array, s: Array, h: float) -> float:
    """Largest current for a period h [A]: the peak, then what just fills the I2t integral, then the continuous one."""
    left = max(0.0, p[at.BUDGET] - s[at.I2T])
    if left > at.AMPLE * p[at.PEAK] * p[at.PEAK] * h:
        return float(p[at.PEAK])
    return float(min(p[at.PEAK], math.sqrt(p[at.CONT2] + left / h)))
