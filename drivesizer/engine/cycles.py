"""A task done many times: cycles that repeat are not marched but added."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import drivesizer.engine.places as at
from drivesizer.engine.figures import PEAKS, SUMS
from drivesizer.engine.parameters import STILL, STILL_WARM
from drivesizer.engine.places import ROW, STATE, Array
from drivesizer.engine.start import Run, tally

__all__ = ["all_cycles"]

_PERIODIC, _PERIODIC_WARM = 1e-7, 1e-3  # difference of a cycle's end from its start, of full scale, that is none
_COMPARED = [STATE.index(n) for n in ("I", "W", "F", "V", "PEND", "OUTER", "INNER", "I_ASK")]


def all_cycles(loop: Any, run: Run, cycles: int, book: tuple[Any, ...]) -> Run:
    """March a cycle until it repeats, then add the rest; heated, the last one is marched again."""
    none = np.zeros((0, len(ROW)))
    while run.cycles < cycles and not run.status:
        before, g = run.s.copy(), tally()
        run.s[at.WW : at.HQ + 1] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)
        rows = book[0] if not run.cycles else none
        run.status = int(loop(run.p, run.s, g, run.M, *_scratch(run), run.pieces, run.ring, rows, *book[1:]))
        _merge(run, g)
        _settle(run, before, g)
        left = cycles - run.cycles
        if left > 0 and not run.status:
            run.pieces[:, 5] += _turned(run)
            again = _repeats(run, before, g, left - int(run.p[at.HEAT] != 0.0))
            if again > 0:
                _add(run, before, g, again)
    return run


def _scratch(run: Run) -> tuple[Array, Array, Array, Array]:
    """Where the march works: matrices in use, the temperatures that they are for, a step, what is steady."""
    work = run.M[0].copy() if run.p[at.HEAT] else run.M[0]
    return work, np.full(run.M.shape[1:3], math.nan), np.zeros(16), np.zeros(at.STEADY)


def _turned(run: Run) -> float:
    """Angle of the reference over a cycle [rad]."""
    last = run.pieces[-1]
    since = last[1] * run.p[at.H] - last[2]
    return float(last[5] + (last[3] + 0.5 * last[4] * since) * since - run.pieces[0, 5])


def _merge(run: Run, g: Array) -> None:
    """Add a cycle to what was watched."""
    for n in PEAKS:
        if g[n] > run.g[n]:
            run.g[n], run.g[n + 1] = g[n], g[n + 1] + run.time
    run.g[SUMS] += g[SUMS]
    for n in (at.G_I2T, at.G_WINDING, at.G_HOUSING, at.G_V_HIGH):
        run.g[n] = max(run.g[n], g[n])
    run.g[at.G_V_LOW] = min(run.g[at.G_V_LOW], g[at.G_V_LOW])
    run.cycles += 1
    run.time += run.pieces[-1, 1] * run.p[at.H]


def _compared(p: Array, s: Array) -> Array:
    """What has to repeat; voltages without the copper's drop, which goes with the temperature."""
    free = s.copy()
    free[_volts(p)] -= s[at.RES] * s[at.I]
    return free[_COMPARED]


def _volts(p: Array) -> list[int]:
    """Places of the controller's voltages."""
    return [int(at.PEND), int(at.INNER if p[at.CASCADE] else at.OUTER)]


def _repeats(run: Run, before: Array, g: Array, left: int) -> int:
    """How many more cycles are like the one before: it ended as it began, and no limit will come in between."""
    p, s = run.p, run.s
    share = _PERIODIC_WARM / STILL_WARM if p[at.HEAT] else _PERIODIC / STILL
    asked = p[at.TOL_I] if p[at.CASCADE] else p[at.TOL_U]
    limits = np.array([p[at.TOL_I], p[at.TOL_W], p[at.TOL_F], p[at.TOL_W] / p[at.RATIO], p[at.TOL_U], asked,
                       p[at.TOL_U], p[at.TOL_I]])  # fmt: skip
    if np.any(np.abs(_compared(p, s) - _compared(p, before)) > share * limits):
        return 0
    if p[at.PKP] and abs(s[at.X] - before[at.X] - _turned(run)) > share * p[at.TOL_X]:
        return 0
    grows, budget = s[at.I2T] - before[at.I2T], p[at.BUDGET]
    if budget == math.inf or abs(grows) <= _PERIODIC * budget:
        return left
    if g[at.G_LIMITED] > 0.0:
        return 0
    return left if grows < 0.0 else min(left, max(0, int((budget - g[at.G_I2T]) / grows) - 1))


def _add(run: Run, before: Array, g: Array, n: int) -> None:
    """Add cycles like the one before; of a heated set the temperatures go by the affine map of one."""
    s = run.s
    heat = s[at.Q] - before[at.Q]
    if run.p[at.HEAT]:
        many = np.linalg.matrix_power(_affine(s, before), n) @ np.array([s[at.T_W], s[at.T_H], 0.0, 1.0])
        s[at.T_W], s[at.T_H], whole = many[:3]
        s[_volts(run.p)] -= s[at.RES] * s[at.I]
        s[at.RES] = run.p[at.R_A] + run.p[at.ALPHA] * s[at.T_W]
        s[_volts(run.p)] += s[at.RES] * s[at.I]
        run.owed = n, g[SUMS].copy(), heat, whole
    else:
        whole = n * heat
        run.g[SUMS] += n * g[SUMS]
    s[at.Q] += whole
    s[at.I2T] = max(0.0, s[at.I2T] + n * (s[at.I2T] - before[at.I2T]))
    moved = s[at.X] - before[at.X], s[at.Y] - before[at.Y]
    s[at.X], s[at.Y] = s[at.X] + n * moved[0], s[at.Y] + n * moved[1]
    run.pieces[:, 5] += n * _turned(run)
    run.cycles += n
    run.time += n * run.pieces[-1, 1] * run.p[at.H]


def _settle(run: Run, before: Array, g: Array) -> None:
    """Add the cycles of a heated set between the ones marched: between those by the copper's heat, which is known."""
    if run.owed is None:
        return
    n, sums, heat, whole = run.owed
    more = float(run.s[at.Q] - before[at.Q]) - heat
    share = min(max((whole / n - heat) / more, 0.0), 1.0) if more else 0.0
    run.g[SUMS] += n * (sums + share * (g[SUMS] - sums))
    run.owed = None


def _affine(s: Array, before: Array) -> Array:
    """What a cycle makes of winding, housing and copper heat: with its current it is affine in the temperatures."""
    found = np.eye(4)
    found[:3, 0] = s[at.WW], s[at.WH], s[at.WQ]
    found[:3, 1] = s[at.HW], s[at.HH], s[at.HQ]
    start, end = before[[at.T_W, at.T_H]], np.array([s[at.T_W], s[at.T_H], s[at.Q] - before[at.Q]])
    found[:3, 3] = end - found[:3, :2] @ start
    return found
