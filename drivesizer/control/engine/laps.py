"""Laps: a simulated stretch with its tallies and its map of the temperatures."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.layout import TALLY, Array
from drivesizer.control.engine.start import Run, tally

__all__ = ["PEAKS", "SUMS", "Lap", "grown", "joined", "simulated"]

PEAKS = [n for n, name in enumerate(TALLY) if f"T_{name}" in TALLY]
SUMS = slice(TALLY.index("SQUARE"), TALLY.index("I2T"))
_HIGHEST = [int(n) for n in (at.G_I2T, at.G_WINDING, at.G_HOUSING, at.G_V_HIGH)]


@dataclass(frozen=True, slots=True, eq=False)
class Lap:
    """Sums over a stretch; with heat also the temperatures at its end, affine in those at its start."""

    g: Array  # tallies
    A: Array  # of winding, housing, copper heat and 1
    heat: float  # J in the copper
    time: float  # s
    steps: float
    count: int = 1  # of laps of one length


def simulated(loop: Any, run: Run, pieces: Array, series: tuple[Any, ...]) -> Lap:
    """Simulate a drive along some pieces."""
    s, g = run.s, tally()
    before = s.copy()
    s[at.WW : at.HQ + 1] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)
    run.status = int(loop(run.p, s, g, run.M, *run.scratch, pieces, run.ring, *series))
    time = float(pieces[-1, 1] - pieces[0, 0]) * run.p[at.H]
    run.simulated += time
    return Lap(g, _affine(s, before), float(s[at.Q] - before[at.Q]), time, float(s[at.STEPS] - before[at.STEPS]))


def _affine(s: Array, before: Array) -> Array:
    """Map of winding, housing and copper heat over a lap: for its current affine in the temperatures."""
    found = np.eye(4)
    found[:3, 0] = s[at.WW], s[at.WH], s[at.WQ]
    found[:3, 1] = s[at.HW], s[at.HH], s[at.HQ]
    start, end = before[[at.T_W, at.T_H]], np.array([s[at.T_W], s[at.T_H], s[at.Q] - before[at.Q]])
    found[:3, 3] = end - found[:3, :2] @ start
    return found


def joined(first: Lap | None, then: Lap, later: float = 0.0) -> Lap:
    """Two laps as one."""
    g = then.g.copy()
    for n in PEAKS:
        g[n + 1] += later
    if first is None:
        return Lap(g, then.A, then.heat, then.time, then.steps, then.count)
    for n in PEAKS:
        if not g[n] > first.g[n]:
            g[n : n + 2] = first.g[n : n + 2]
    g[SUMS] += first.g[SUMS]
    g[_HIGHEST] = np.maximum(g[_HIGHEST], first.g[_HIGHEST])
    g[at.G_V_LOW] = min(g[at.G_V_LOW], first.g[at.G_V_LOW])
    return Lap(
        g, then.A @ first.A, first.heat + then.heat, first.time + then.time, first.steps + then.steps,
        first.count + then.count,
    )  # fmt: skip


def grown(lap: Lap, then: Lap | None, times: int, heat: float, highest: float, lags: float, ratio: float) -> Lap:
    """A lap many times over, its heat known; the sums go with the heat from it to a lap after those."""
    g, time = lap.g.copy(), times * lap.time
    mean = lap.g[SUMS] / lap.time
    if then is not None:
        more = then.heat / then.time - lap.heat / lap.time
        share = min(max((heat / time - lap.heat / lap.time) / more, 0.0), 1.0) if more else 0.0
        mean = mean + share * (then.g[SUMS] / then.time - mean)
    g[SUMS] = time * mean
    if lap.g[at.G_SATURATED] == 0.0:
        g[at.G_SATURATED] = 0.0  # laps are added until the bus has too little, not beyond
    for square, peak, by in ((at.G_E2_X, at.G_E_X, abs(lags)), (at.G_E2_Y, at.G_E_Y, abs(lags) / ratio)):
        if by:
            lag = math.sqrt(lap.g[square] / lap.time)
            more = times * (times + 1) * by * (lag + by * (2 * times + 1) / 6.0)
            g[square] = times * lap.g[square] + lap.time * more
            g[peak], g[peak + 1] = g[peak] + times * by, g[peak + 1] + times * lap.time
    g[at.G_I2T] = max(g[at.G_I2T], highest)
    return Lap(g, np.linalg.matrix_power(lap.A, times), heat, time, 0.0, times * lap.count)
