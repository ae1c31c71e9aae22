"""Temperatures of winding and housing; arrays as in ``layout``."""

from __future__ import annotations

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.layout import Array

__all__: list[str] = []  # compiled into ``kernel``


def warm(p: Array, s: Array, place: int, I2: float, loss: float, R: float, dt: float) -> None:
    """Integrate both temperatures and the copper heat at a mean square current (Runge-Kutta, to 1e-8 of the rise)."""
    rate = (1.0 / p[at.R_1] + p[at.ALPHA] * I2) / p[at.C_W] + (1.0 / p[at.R_1] + 1.0 / p[at.R_2]) / p[at.C_H]
    n = int(min(max(20.0 * rate * dt, 1.0), p[at.MOST])) if rate * dt < 1e9 else 1
    h = dt / n
    a, b = 0.0, 0.0
    for _ in range(n):
        w, hot, copper = s[place], s[place + 1], 0.0
        sum_w, sum_h = 0.0, 0.0
        x, y = w, hot
        for stage in range(4):
            heat, across = (R + p[at.ALPHA] * x) * I2, (x - y) / p[at.R_1]
            a, b = (heat - across) / p[at.C_W], (across - y / p[at.R_2] + loss) / p[at.C_H]
            weight = h / 6.0 if stage == 0 or stage == 3 else h / 3.0
            sum_w, sum_h, copper = sum_w + weight * a, sum_h + weight * b, copper + weight * heat
            reach = h if stage == 2 else 0.5 * h
            x, y = w + reach * a, hot + reach * b
        s[place], s[place + 1], s[place + 2] = w + sum_w, hot + sum_h, s[place + 2] + copper


def warm_briefly(p: Array, s: Array, I2: float, loss: float, dt: float) -> None:
    """The same over a single period, far shorter than the winding's time constant: by the rates in its middle."""
    g_1, g_2, by_w, by_h = p[at.G_1], p[at.G_2], p[at.BY_W], p[at.BY_H]
    w, h, copper = s[at.T_W], s[at.T_H], 0.0
    x, y = w, h
    for reach in (0.5 * dt, dt):
        copper, across = (p[at.R_A] + p[at.ALPHA] * x) * I2, (x - y) * g_1
        x, y = w + reach * (copper - across) * by_w, h + reach * (across - y * g_2 + loss) * by_h
    s[at.T_W], s[at.T_H], s[at.Q] = x, y, s[at.Q] + dt * copper


def heat(p: Array, s: Array, g: Array, turned: float, swept: float, dt: float) -> None:
    """Temperatures after a period, or a long stretch at one speed; turned: angle [rad], swept: integral of w^2 dt."""
    I2 = s[at.SQUARE] / dt
    s[at.SQUARE] = 0.0
    if p[at.HEAT] == 0.0:
        s[at.Q] += p[at.R25] * I2 * dt
        return
    loss = p[at.P_0] + (p[at.P_1] * turned + p[at.P_2] * swept) / dt
    if p[at.EVERY] > 1.0 and dt < 1.5 * p[at.N_V] * p[at.H]:
        warm_briefly(p, s, I2, loss, dt)
    else:
        warm(p, s, at.T_W, I2, loss, p[at.R_A], dt)
    g[at.G_WINDING], g[at.G_HOUSING] = max(g[at.G_WINDING], s[at.T_W]), max(g[at.G_HOUSING], s[at.T_H])
    s[at.RES] = p[at.R_A] + p[at.ALPHA] * s[at.T_W]


def follow(p: Array, s: Array, square: float, dt: float) -> None:
    """Follow the derivatives of both temperatures by those at the start; square: integral of I^2 over the time dt."""
    if p[at.HEAT] != 0.0 and p[at.SENSE] != 0.0 and dt > 0.0:
        warm(p, s, at.WW, square / dt, 0.0, 0.0, dt)
        warm(p, s, at.HW, square / dt, 0.0, 0.0, dt)
