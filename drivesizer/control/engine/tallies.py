"""What is watched on the way: largest magnitudes with their times, sums, rows of the course."""

from __future__ import annotations

from typing import Any

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.layout import Array
from drivesizer.control.engine.modes import gear_torque

__all__ = ["count", "record", "remain", "see", "square_of", "strain", "strayed", "watch"]


def see(g: Array, place: int, value: float, t: float) -> None:
    """Keep the largest magnitude and its time."""
    if abs(value) > g[place]:
        g[place], g[place + 1] = abs(value), t


def square_of(first: float, last: float, area: float, dt: float) -> float:
    """Integral of a square by the ends and the integral; exact for a parabola (its Legendre polynomials)."""
    mean, rise, bend = area / dt, last - first, (first + last) / 2.0 - area / dt
    return dt * (mean * mean + rise * rise / 12.0 + bend * bend / 5.0)


def count(p: Array, s: Array, g: Array, square: float, u: float, q: float, dt: float) -> None:
    """Add what a step took: square of the current, charge, energy."""
    s[at.SQUARE] += square
    s[at.I2T] = max(0.0, s[at.I2T] + square - p[at.CONT2] * dt)
    g[at.G_I2T] = max(g[at.G_I2T], s[at.I2T])
    g[at.G_SQUARE] += square
    if u * q > 0.0:
        g[at.G_IN] += u * q
    else:
        g[at.G_RETURNED] -= u * q


def strain(p: Array, s: Array, g: Array, code: int, l: float, t: float, dt: float) -> None:
    """Watch the torque of the gearhead; its square over the time that it turns."""
    torque = gear_torque(p, code, s[at.I], s[at.W], s[at.F], s[at.V], l)
    see(g, at.G_G, torque, t)
    if code % 3 != 1:
        g[at.G_G_SQUARE] += torque * torque * dt
        g[at.G_RUNNING] += dt


def watch(p: Array, s: Array, g: Array, speed: float, angle: float, u: float, t: float, weight: float) -> None:
    """Errors of motor and load, and voltage, at a sample."""
    error, lag = speed - s[at.W], angle - s[at.X]
    slow, behind = speed / p[at.RATIO] - s[at.V], angle / p[at.RATIO] - s[at.Y]
    see(g, at.G_E_W, error, t)
    see(g, at.G_E_X, lag, t)
    see(g, at.G_E_V, slow, t)
    see(g, at.G_E_Y, behind, t)
    see(g, at.G_U, u, t)
    strayed(g, error, lag, slow, behind, weight)


def strayed(g: Array, error: float, lag: float, slow: float, behind: float, time: float) -> None:
    """Add squares of errors: the motor's speed and angle, the load's speed and angle."""
    g[at.G_E2_W] += error * error * time
    g[at.G_E2_X] += lag * lag * time
    g[at.G_E2_V] += slow * slow * time
    g[at.G_E2_Y] += behind * behind * time


def remain(p: Array, s: Array, g: Array, error: float, lag: float, behind: float, time: float) -> None:
    """Add what a steady stretch holds: errors, limits; behind: the load's angle."""
    strayed(g, error, lag, error / p[at.RATIO], behind, time)
    g[at.G_SATURATED] += time if s[at.U_CUT] != 0.0 else 0.0
    g[at.G_LIMITED] += time if s[at.I_CUT] != 0.0 else 0.0


def record(rows: Array, kept: Any, size: Any, always: bool, k: int, row: Any) -> None:
    """Keep a row: all while few, else evenly thinned, those after a corner always (size: rows, stride, spare,
    how many after a corner). One of the same time as the last takes its place: a stretch ends where the next begins."""
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
