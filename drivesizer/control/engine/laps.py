"""Repeated cycles, long constant stretches and repeated motions: laps that are alike are added, not simulated."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.layout import ROW, STATE, TALLY, Array
from drivesizer.control.engine.start import STILL, STILL_WARM, Run, tally
from drivesizer.control.engine.steps import available_voltage
from drivesizer.control.engine.task import Part

__all__ = ["PEAKS", "all_cycles"]


# -- Laps: a simulated stretch with its tallies and its map of the temperatures.


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


# -- Detection of repeating laps, by the state or, where that never repeats, by their sums; and how long they repeat.


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


# -- Repeated cycles, long constant stretches and repeated motions: laps that are alike are added, not simulated.
#
# Laps are simulated 1, 1, 2, 4, 8 ... at a time until one ends as it began, or its sums are those of the one before.
# With ``laps`` and ``repeats`` this makes missions of hours as cheap as some cycles: the rows of missions in
# ``benchmarks/closed_loop.py`` measure it.


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
