"""Detection of repeating laps, by the state or, where that never repeats, by their sums; and how long they repeat."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.laps import Lap
from drivesizer.control.engine.layout import STATE, Array
from drivesizer.control.engine.limits import available_voltage
from drivesizer.control.engine.parameters import STILL, STILL_WARM
from drivesizer.control.engine.start import Run

__all__ = ["alike", "voltages"]

_PERIODIC, _PERIODIC_WARM = 1e-7, 1e-3  # difference of a lap's end from its start that is neglected, of full scale
_ALIKE = 2e-3  # relative difference of the sums of laps that is neglected
_LEAST, _LEAST_EXACT = 4, 16  # laps that are compared by their sums: with counts, and where speeds are measured exactly
_FULL = 1e-2  # of the I2t budget, by which its integral may move over laps that are alike by their sums
_DRIFT = 1.3, 3.0  # ratio of one change to that before, about 2, that a drift has
_CLOSE = 2.0  # K by which a winding may warm in laps that are added, where its resistance changes the current
_COMPARED = [
    STATE.index(n) for n in ("I", "W", "F", "V", "PEND", "OUTER", "INNER", "I_DEMAND", "I_NEXT", "W_ADD", "W_NEXT")
]


def alike(run: Run, before: Array, lap: Lap, earlier: Sequence[Lap], turned: float, left: int, by_state: bool) -> int:
    """Number of further laps that are like one."""
    if left < 1 or run.status:
        return 0
    exact = by_state and not run.p[at.EDGES] and _repeats(run, before, turned)
    if not exact and not (_same_sums(run.p, lap, earlier) and not _drifts(lap, earlier, left)):
        return 0
    until = _until_full(run, before, lap, _PERIODIC if exact else _FULL), _until_warm(run, before, lap, left)
    return int(min(left, *until))


def voltages(p: Array) -> list[int]:
    """Places of the controller's voltages."""
    return [int(at.PEND), int(at.INNER if p[at.CASCADE] else at.OUTER)]


def _repeats(run: Run, before: Array, turned: float) -> bool:
    """Whether a lap ended as it began."""
    p, s = run.p, run.s
    share = _PERIODIC_WARM / STILL_WARM if p[at.HEAT] else _PERIODIC / STILL
    demand = p[at.TOL_I] if p[at.CASCADE] else p[at.TOL_U]
    limits = np.array([p[at.TOL_I], p[at.TOL_W], p[at.TOL_F], p[at.TOL_W] / p[at.RATIO], p[at.TOL_U], demand,
                       p[at.TOL_U], p[at.TOL_I], p[at.TOL_I], p[at.TOL_W], p[at.TOL_W]])  # fmt: skip
    if np.any(np.abs(_compared(p, s) - _compared(p, before)) > share * limits):
        return False
    return not p[at.PKP] or bool(abs(s[at.X] - before[at.X] - turned) <= share * p[at.TOL_X])


def _compared(p: Array, s: Array) -> Array:
    """State that has to repeat; voltages without the copper's drop, which varies with the temperature."""
    free = s.copy()
    free[voltages(p)] -= s[at.RES] * s[at.I]
    return free[_COMPARED]


def _same_sums(p: Array, lap: Lap, earlier: Sequence[Lap]) -> bool:
    """Whether laps have the same sums: squares of current and torque, and the work done, without the copper's heat."""
    if not earlier or lap.count < (_LEAST if p[at.EDGES] else _LEAST_EXACT):
        return False
    (a, scale), (b, _) = _means(lap), _means(earlier[-1])
    return bool(np.all(np.abs(a - b) <= _ALIKE * scale))


def _drifts(lap: Lap, earlier: Sequence[Lap], left: int) -> bool:
    """Whether the sums change as in a slow drift, twice as much in laps twice as long, and would not stay the same."""
    counts = [x.count for x in (*earlier[-2:], lap)]
    if len(counts) < 3 or counts != [counts[0], 2 * counts[0], 4 * counts[0]]:
        return False
    (a, _), (b, _), (c, scale) = (_means(x) for x in (*earlier[-2:], lap))
    along = ((c - b) * (b - a) > 0.0) & (np.abs(c - b) > _DRIFT[0] * np.abs(b - a))
    along &= np.abs(c - b) < _DRIFT[1] * np.abs(b - a)
    ahead = np.abs(c - b) * (left / 2) / 0.75  # to the middle of the rest, in laps; the two are 3/4 of a lap apart
    return bool(np.any(along & (ahead > _ALIKE * scale)))


def _means(lap: Lap) -> tuple[Array, Array]:
    """Sums of a lap over its time, and what they are measured by."""
    g = lap.g
    square, torque, work = g[at.G_SQUARE], g[at.G_G_SQUARE], g[at.G_IN] - g[at.G_RETURNED] - lap.heat
    scale = square, torque, g[at.G_IN] + g[at.G_RETURNED] + lap.heat
    return np.array([square, torque, work]) / lap.time, np.array(scale) / lap.time


def _until_full(run: Run, before: Array, lap: Lap, share: float) -> float:
    """Laps until the I2t integral limits the current; infinite where it is full already, or never will be."""
    p, highest, budget = run.p, lap.g[at.G_I2T], run.p[at.BUDGET]
    if budget == math.inf:
        return math.inf
    grows = run.s[at.I2T] - before[at.I2T]
    if budget - highest <= 2.0 * (p[at.PEAK] ** 2 - p[at.CONT2]) * p[at.H] * p[at.N_V]:
        return math.inf if abs(grows) <= share * budget else 0
    free = lap.g[at.G_SQUARE] - p[at.CONT2] * lap.time
    if free <= 0.0:
        return math.inf if grows <= share * budget else 0
    if grows > free + _PERIODIC * budget:
        return 0  # it was empty meanwhile: the next one rises from higher
    return max(0, int((budget - highest) / grows) - 1)


def _until_warm(run: Run, before: Array, lap: Lap, left: int) -> float:
    """Laps until the winding's resistance has changed the current."""
    p = run.p
    integral = p[at.CKI] if p[at.CASCADE] else p[at.KI]
    if not p[at.HEAT]:
        return math.inf
    near = float(_CLOSE / max(abs(run.s[at.T_W] - before[at.T_W]), 1e-300))
    return max(_until_cut(run, lap, left), near) if integral and lap.g[at.G_SATURATED] == 0.0 else near


def _until_cut(run: Run, lap: Lap, left: int) -> int:
    """Laps like one until the warmer winding needs more voltage than the bus has, found by halving.

    The voltage rises by the resistance times the largest current; the bus has least under that current.
    """
    p, s, current = run.p, run.s, float(lap.g[at.G_I])
    room = available_voltage(p, current, 1.0) - lap.g[at.G_U_DEMAND]

    def kept(laps: int) -> bool:
        winding = (np.linalg.matrix_power(lap.A, laps) @ (s[at.T_W], s[at.T_H], 0.0, 1.0))[0]
        return bool(p[at.ALPHA] * (winding - s[at.T_W]) * current <= room)

    n = left
    while n and not kept(n):
        n //= 2
    return n
