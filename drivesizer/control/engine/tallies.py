"""Records of a simulation: largest magnitudes with times, sums, rows of the time series; arrays as in ``layout``."""

from __future__ import annotations

from typing import Any

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.layout import Array
from drivesizer.control.engine.modes import gear_torque

__all__: list[str] = []  # compiled into ``kernel``


def keep_peak(g: Array, place: int, value: float, t: float) -> None:
    """Keep the largest magnitude and its time."""
    if abs(value) > g[place]:
        g[place], g[place + 1] = abs(value), t


def keep_demand(p: Array, g: Array, demand: float, i: float, t: float) -> None:
    """Keep the largest voltage demand, and that at the power stage with what resistances take of its voltage."""
    keep_peak(g, at.G_U_DEMAND, demand, t)
    keep_peak(g, at.G_U_STAGE, abs(demand) + p[at.LEADS] * max(0.0, i if demand >= 0.0 else -i), t)


def square_of(first: float, last: float, area: float, dt: float) -> float:
    """Integral of a square by the ends and the integral; exact for a parabola (its Legendre polynomials)."""
    mean, rise, bend = area / dt, last - first, (first + last) / 2.0 - area / dt
    return dt * (mean * mean + rise * rise / 12.0 + bend * bend / 5.0)


def add_energy(p: Array, g: Array, work: float, charge: float, square: float) -> None:
    """Add energy into the power stage, by that of the motor, and charge and square of the current over that time."""
    taken = work + p[at.LOSS] * abs(charge) + p[at.R_B] * square
    if taken > 0.0:
        g[at.G_IN] += taken
    else:
        g[at.G_RETURNED] -= taken


def add_square(p: Array, s: Array, g: Array, square: float, dt: float) -> None:
    """Add a step: square of the current, and its I2t integral."""
    s[at.SQUARE] += square
    s[at.I2T] = max(0.0, s[at.I2T] + square - p[at.CONT2] * dt)
    g[at.G_I2T] = max(g[at.G_I2T], s[at.I2T])
    g[at.G_SQUARE] += square


def record_gear_torque(p: Array, s: Array, g: Array, code: int, l: float, t: float, dt: float) -> None:
    """Record the torque of the gearhead; its square over its running time."""
    torque = gear_torque(p, code, s[at.I], s[at.W], s[at.F], s[at.V], l)
    keep_peak(g, at.G_G, torque, t)
    if code % 3 != 1:
        g[at.G_G_SQUARE] += torque * torque * dt
        g[at.G_RUNNING] += dt


def record_errors(p: Array, s: Array, g: Array, speed: float, angle: float, u: float, t: float, weight: float) -> None:
    """Record errors of motor and load, and voltage, at a sample."""
    error, lag = speed - s[at.W], angle - s[at.X]
    slow, behind = speed / p[at.RATIO] - s[at.V], angle / p[at.RATIO] - s[at.Y]
    keep_peak(g, at.G_E_W, error, t)
    keep_peak(g, at.G_E_X, lag, t)
    keep_peak(g, at.G_E_V, slow, t)
    keep_peak(g, at.G_E_Y, behind, t)
    keep_peak(g, at.G_U, u, t)
    add_error_squares(g, error, lag, slow, behind, weight)


def add_error_squares(g: Array, error: float, lag: float, slow: float, behind: float, time: float) -> None:
    """Add squares of errors: speed and angle of the motor, speed and angle of the load."""
    g[at.G_E2_W] += error * error * time
    g[at.G_E2_X] += lag * lag * time
    g[at.G_E2_V] += slow * slow * time
    g[at.G_E2_Y] += behind * behind * time


def add_steady_errors(p: Array, s: Array, g: Array, error: float, lag: float, behind: float, time: float) -> None:
    """Add a steady stretch: errors, and time at the limits; behind: error of the load's angle [rad]."""
    add_error_squares(g, error, lag, error / p[at.RATIO], behind, time)
    g[at.G_SATURATED] += time if s[at.U_CUT] != 0.0 else 0.0
    g[at.G_LIMITED] += time if s[at.I_CUT] != 0.0 else 0.0


def keep_row(rows: Array, kept: Any, size: Any, always: bool, k: int, row: Any) -> None:
    """Keep a row: all while few, else evenly thinned, those after a corner always.

    A row at the time of the last one replaces it: a stretch ends where the next begins.
    """
    if (not always or size[2] <= 0) and k % size[1] != 0:
        return
    n = size[0]
    if n > 0 and rows[n - 1, 0] == row[0]:
        n -= 1
    kept[n] = always and size[2] > 0
    size[2] -= kept[n]
    for c in range(len(row)):
        rows[n, c] = row[c]
    size[0] = n + 1
    if n + 1 < rows.shape[0] - 1:
        return
    m, odd = 0, False
    for n in range(size[0]):
        odd = odd if kept[n] != 0 else not odd
        if kept[n] != 0 or odd:
            for c in range(rows.shape[1]):
                rows[m, c] = rows[n, c]
            kept[m] = kept[n]
            m += 1
    size[0], size[1] = m, size[1] * 2
