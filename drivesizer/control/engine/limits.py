"""What voltage and current are left: the bus, the I2t integral."""

from __future__ import annotations

import math

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.layout import Array
from drivesizer.control.engine.tallies import see

__all__ = ["available", "bus", "permitted"]


def available(p: Array, i: float, wanted: float) -> float:
    """Voltage that the bus leaves at full duty under a current: V = V_0 - R_s n duty (V - drop) i / V."""
    r = p[at.R_S] * p[at.SETS] * p[at.DUTY] * (i if wanted >= 0.0 else -i)
    if r < 0.0 and p[at.RAISES] == 0.0:
        r = 0.0
    half = 0.5 * (p[at.V_0] - r)
    return float(max(0.0, float(p[at.DUTY]) * (half + math.sqrt(half * half + r * p[at.DROP]) - p[at.DROP])))


def bus(p: Array, g: Array, power: float, t: float) -> None:
    """Watch voltage and current of the bus under the power of all sets, V^2 - V_0 V + R_s P = 0."""
    P = p[at.SETS] * power
    if P < 0.0 and p[at.RAISES] == 0.0:
        P = 0.0
    V = p[at.V_0]
    if p[at.R_S] > 0.0:
        V = 0.5 * (p[at.V_0] + math.sqrt(max(0.0, p[at.V_0] * p[at.V_0] - 4.0 * p[at.R_S] * P)))
    g[at.G_V_LOW], g[at.G_V_HIGH] = min(g[at.G_V_LOW], V), max(g[at.G_V_HIGH], V)
    if P > 0.0:
        see(g, at.G_BUS, P / V, t)


def permitted(p: Array, s: Array, h: float) -> float:
    """Current that the I2t integral leaves: the peak, then what just fills it, at last the continuous one."""
    return float(min(p[at.PEAK], math.sqrt(p[at.CONT2] + max(0.0, p[at.BUDGET] - s[at.I2T]) / h)))
