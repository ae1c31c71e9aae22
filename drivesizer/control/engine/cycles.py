"""Repeated cycles, long constant stretches and repeated motions: laps that are alike are added, not simulated.

Laps are simulated 1, 1, 2, 4, 8 ... at a time until one ends as it began, or its sums are those of the one before.
With ``laps`` and ``repeats`` this makes missions of hours as cheap as some cycles: the rows of missions in
``benchmarks/closed_loop.py`` measure it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.laps import Lap, grown, joined, simulated
from drivesizer.control.engine.layout import ROW, Array
from drivesizer.control.engine.repeats import alike, voltages
from drivesizer.control.engine.start import Run
from drivesizer.control.engine.task_pieces import Part

__all__ = ["all_cycles"]

_COUNTS = 8  # counts of the encoder by which a lag varies without growing
_LAGS = 0.2  # of the lag, growth in a lap beyond which the position loop does not keep up
_NONE = np.zeros((0, len(ROW)))


def all_cycles(loop: Any, run: Run, cycles: int, series: tuple[Any, ...]) -> Run:
    """Simulate a drive through all cycles of its task."""
    if _least_steps(run) > run.p[at.MOST]:
        run.status = at.TOO_LONG
        return run
    if run.unseen:
        return _watched(loop, run, series)
    turned = _turned(run.pieces, run.p)
    length = float(run.pieces[-1, 1]) * run.p[at.H]

    def lap(done: int, many: int) -> Lap:
        found: Lap | None = None
        for n in range(done, done + many):
            run.s[at.TURN] = n * turned
            found = joined(found, _cycle(loop, run, series if n == 0 else (_NONE, *series[1:])), n * length)
            run.cycles = n + 1
            if run.status:
                break
        assert found is not None
        return found

    whole = _repeated(run, lap, cycles, turned)
    run.g[:] = whole.g
    if run.p[at.HEAT] and run.p[at.SENSE]:
        run.slopes = whole.A[:2, :2]
    run.time = (run.cycles if run.status else cycles) * length
    return run


def _least_steps(run: Run) -> float:
    """Steps that must be simulated: those of a changing speed that the task does not repeat."""
    once = [run.pieces[part.first : part.end] for part in run.parts if not part.rows]
    return sum(float((pieces[:, 1] - pieces[:, 0]) @ (pieces[:, 4] != 0.0)) for pieces in once)


def _watched(loop: Any, run: Run, series: tuple[Any, ...]) -> Run:
    """Simulate a drive up to where it is recorded, and on."""
    simulated(loop, run, run.pieces[: run.unseen], (_NONE, *series[1:]))
    if not run.status:
        found = simulated(loop, run, run.pieces[run.unseen :], series)
        run.g[:], run.time = found.g, found.time
    return run


def _turned(pieces: Array, p: Array) -> float:
    """Angle of the reference over some pieces [rad]."""
    last = pieces[-1]
    since = last[1] * p[at.H] - last[2]
    return float(last[5] + (last[3] + 0.5 * last[4] * since) * since - pieces[0, 5])


def _cycle(loop: Any, run: Run, series: tuple[Any, ...]) -> Lap:
    """One cycle, its repeated motions each by laps."""
    found: Lap | None = None
    for part in run.parts:
        if part.rows:
            found = joined(found, _block(loop, run, part, series))
        else:
            found = joined(found, _through(loop, run, part.first, part.end, series))
        if run.status:
            break
    assert found is not None
    return replace(found, count=1)


def _block(loop: Any, run: Run, part: Part, series: tuple[Any, ...]) -> Lap:
    """A motion that is written out repeatedly, lap by lap."""

    def lap(done: int, many: int) -> Lap:
        a = part.first + done * part.rows
        return replace(_through(loop, run, a, a + many * part.rows, series), count=many)

    turned = _turned(run.pieces[part.first : part.first + part.rows], run.p)
    return _repeated(run, lap, (part.end - part.first) // part.rows, turned)


def _through(loop: Any, run: Run, first: int, end: int, series: tuple[Any, ...]) -> Lap:
    """Pieces in their order, the long constant ones each by laps."""
    found: Lap | None = None
    cuts = {first, end}
    for n in (np.flatnonzero(run.long[first:end]) + first).tolist():
        cuts |= {n, n + 1}
    for a, b in pairwise(sorted(cuts)):
        part = run.pieces[a:b]
        found = joined(
            found, _stretch(loop, run, part[0], series) if run.long[a] else simulated(loop, run, part, series)
        )
        if run.status:
            break
    assert found is not None
    return found


def _stretch(loop: Any, run: Run, piece: Array, series: tuple[Any, ...]) -> Lap:
    """A long stretch at one speed and load, lap by lap."""
    first, end, length = int(piece[0]), int(piece[1]), run.lap
    laps = (end - first) // length

    def between(a: int, b: int) -> Lap:
        some = piece.copy()[None]
        some[0, 0], some[0, 1], some[0, 8] = a, b, piece[8] * (a == first)
        return simulated(loop, run, some, series)

    def lap(done: int, many: int) -> Lap:
        return replace(between(first + done * length, first + (done + many) * length), count=many)

    found = _repeated(run, lap, laps, float(piece[3]) * length * run.p[at.H], run.p[at.H])
    rest = first + laps * length
    return found if run.status or rest == end else joined(found, between(rest, end))


def _repeated(run: Run, simulate_laps: Callable[[int, int], Lap], laps: int, turned: float, period: float = 0.0) -> Lap:
    """Simulate laps until they are alike, and add the rest; heated, the last is simulated again at its temperatures."""
    total: Lap | None = None
    earlier: list[Lap] = []
    owed: Callable[[Lap | None], Lap] | None = None
    done, tried = 0, 0
    many = 1
    while done < laps and not run.status:
        before, many = run.s.copy(), min(many, laps - done)
        lap = simulate_laps(done, many)
        if owed:
            total, owed = joined(total, owed(lap)), None
        total, done, tried = joined(total, lap), done + many, tried + many
        if lap.steps * period < 0.5 * lap.time and period:
            many = laps - done
            continue
        times = alike(run, before, lap, earlier, many * turned, (laps - done - (run.p[at.HEAT] != 0.0)) // many,
                      not period)  # fmt: skip
        if times > 0:
            owed = _added(run, before, lap, times, many * turned)
            done += times * many
        else:
            many = tried
        earlier.append(lap)
        if owed and not run.p[at.HEAT]:
            total, owed = joined(total, owed(None)), None
    assert total is not None
    return joined(total, owed(None)) if owed else total


def _added(run: Run, before: Array, lap: Lap, times: int, turned: float) -> Callable[[Lap | None], Lap]:
    """Advance by laps like one; what they add is known with the lap after them."""
    s, budget, heat = run.s, float(run.p[at.BUDGET]), _warmed(run, lap, times)
    grows = float(s[at.I2T] - before[at.I2T])
    s[at.I2T] = min(max(0.0, s[at.I2T] + times * grows), budget)
    lags = _lags(run, before, lap, turned)
    s[at.Y] += _turn(run, times * (turned - lags)) / run.p[at.RATIO]  # a lap ends with the twist that it began with
    highest = min(lap.g[at.G_I2T] + times * max(grows, 0.0), budget)
    return lambda then: grown(lap, then, times, heat, highest, lags, float(run.p[at.RATIO]))


def _warmed(run: Run, lap: Lap, times: int) -> float:
    """Warm a drive by laps like one, the controller's voltages following the winding; heat of the copper [J]."""
    s, heat = run.s, times * lap.heat
    if run.p[at.HEAT]:
        s[at.T_W], s[at.T_H], heat, _ = np.linalg.matrix_power(lap.A, times) @ (s[at.T_W], s[at.T_H], 0.0, 1.0)
        places = voltages(run.p)
        s[places] -= s[at.RES] * s[at.I]
        s[at.RES] = run.p[at.R_A] + run.p[at.ALPHA] * s[at.T_W]
        s[places] += s[at.RES] * s[at.I]
    s[at.Q] += heat
    return float(heat)


def _lags(run: Run, before: Array, lap: Lap, turned: float) -> float:
    """Growth of the position error in a lap [rad]; 0 where a position loop keeps it within some counts."""
    found = float(turned - (run.s[at.X] - before[at.X]))
    counts = _COUNTS * 2.0 * math.pi / run.p[at.EDGES] if run.p[at.EDGES] else 0.0
    kept = max(counts, _LAGS * math.sqrt(lap.g[at.G_E2_X] / lap.time))
    return 0.0 if run.p[at.PKP] and abs(found) < kept else found


def _turn(run: Run, angle: float) -> float:
    """Turn the motor by an angle, with counts a whole number of them; the angle [rad]."""
    if run.p[at.EDGES]:
        counts = round(angle * run.p[at.EDGES] / (2.0 * math.pi))
        angle = counts * 2.0 * math.pi / run.p[at.EDGES]
        run.ring += counts
    run.s[at.X] += angle
    return angle
