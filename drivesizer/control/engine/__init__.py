"""Simulation of drives in closed loop along a reference: one with its time series, or many at once.

Data in, data out: a ``Drive`` is a drive train with its controller and limits; a ``Task`` is the required motion and
load. A drive starts in equilibrium at the first speed. Between samples the drive train is exact (see ``drive_train``);
temperatures move with the loss of each period, and the winding's resistance follows to 0.01 K.
Assumed: a corner of reference or load between two samples takes effect at the next one. Two reversals of power within
one sample are not seen; the bus sags by the current at the sample.

A repeated cycle is simulated until it ends as it began, to 1e-7 of full scale (1e-3 while the winding warms), and the
cycles after it are added; with heat, the last one is simulated again at its temperatures. With counts, or where
friction keeps a loop hunting, no cycle ends as it began: then until the sums of at least 4 cycles equal those before,
to 2e-3. So the current's mean square, energies and heat are met to 5e-3, the temperatures at the end to 5e-3 of their
rise, and the largest values are those of the simulated cycles. A position error that grows from cycle to cycle is
extrapolated. A stretch of some 260 000 samples and more at one speed and load is treated likewise, or carried exactly
where it settles.
Symbols: I current [A], U voltage [V], w motor speed [rad/s], T temperature [K].
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.kernel import KERNEL, available_voltage
from drivesizer.control.engine.layout import ROW, STATE, TALLY, Array
from drivesizer.control.engine.start import (
    STILL,
    STILL_WARM,
    CurrentLimit,
    Drive,
    MotorHeat,
    Run,
    Supply,
    Task,
    line,
    ready,
    tally,
)
from drivesizer.files.machine_code import machine_code

__all__ = [
    "FIGURES", "CurrentLimit", "Drive", "MotorHeat", "Simulation", "Supply", "Task", "is_compiled",
    "line", "simulate",
]  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Simulation:
    """Results: a column over drives per figure of ``FIGURES``; the time series of a single drive."""

    figures: dict[str, Array]
    problems: tuple[str, ...]  # of each drive, empty where it ran to the end; else the figures are those until then
    slopes: tuple[Array | None, ...] = ()  # of each drive simulated alone: d(temperatures at the end)/d(start)
    series: dict[str, Array] | None = None  # by the names of ``layout.ROW``; of the first cycle


FIGURES = {
    "current": "I", "voltage_demand": "U_DEMAND", "stage_voltage": "U_STAGE", "voltage": "U",
    "speed": "W", "speed_error": "E_W", "angle_error": "E_X", "load_speed_error": "E_V",
    "load_angle_error": "E_Y", "gear_torque": "G", "current_demand": "I_AHEAD", "power": "POWER", "bus_current": "BUS",
    "time_at_voltage_limit": "SATURATED", "time_at_current_limit": "LIMITED",
    "energy_in": "IN", "energy_returned": "RETURNED", "energy_resisted": "RESISTED",
    "speed_error_square": "E2_W", "angle_error_square": "E2_X", "load_speed_error_square": "E2_V",
    "load_angle_error_square": "E2_Y", "i2t_highest": "I2T", "winding_highest": "WINDING",
    "housing_highest": "HOUSING", "bus_lowest": "V_LOW",
}  # fmt: skip


def figures_of(runs: Sequence[Run]) -> dict[str, Array]:
    """Figures as columns over drives."""
    g, s, p = (np.array([getattr(run, name) for run in runs]) for name in "gsp")
    figures: dict[str, Array] = {}
    for name, place in FIGURES.items():
        n = TALLY.index(place)
        figures[name] = g[:, n].copy()
        if n in PEAKS:
            figures[f"{name}_time"] = g[:, n + 1].copy()
    warm = np.where(p[:, at.HEAT] != 0.0, p[:, at.AMBIENT], np.nan)
    figures |= {"winding": s[:, at.T_W] + warm, "housing": s[:, at.T_H] + warm}
    figures["winding_highest"] += warm
    figures["housing_highest"] += warm
    time = np.array([run.time for run in runs])
    with np.errstate(all="ignore"):
        figures |= {
            "rms_current": np.sqrt(g[:, at.G_SQUARE] / time),
            "rms_gear_torque_running": np.sqrt(g[:, at.G_G_SQUARE] / g[:, at.G_RUNNING]),
            "i2t_share": g[:, at.G_I2T] / p[:, at.BUDGET],
        }
    return figures | {"copper_heat": s[:, at.Q].copy(), "angle": s[:, at.X].copy(), "load_angle": s[:, at.Y].copy(),
                    "time": time, "time_simulated": np.array([run.simulated for run in runs]),
                    "steps": s[:, at.STEPS].copy()}  # fmt: skip


_MOST_STEPS = 50_000_000  # of one drive: some ten seconds of computing
_BLOCK = 256  # drives whose matrices are held at a time
_PROBLEMS = ("", "the state leaves the range of numbers: the loop is unstable", "more steps than are permitted")


def is_compiled() -> bool:
    """Whether the simulation is at hand as machine code."""
    return KERNEL.translated


def simulate(
    drive: Drive | Sequence[Drive], task: Task, *, rows: int = 20_000, most_steps: int = _MOST_STEPS, threads: int = 2
) -> Simulation:
    """Simulate a drive along a task, with so many rows of its time series, or several drives side by side.

    The figures do not depend on the number of threads.
    """
    drives, loop = [drive] if isinstance(drive, Drive) else drive, machine_code(KERNEL)
    blocks = [drives[n : n + _BLOCK] for n in range(0, len(drives), _BLOCK)]
    series = np.zeros((rows + 2 if rows else 0, len(ROW))), np.zeros(rows + 2, np.int8), np.array([0, 1, rows // 2, 1])
    all_runs: list[Run] = []
    with ThreadPoolExecutor(threads) as pool:  # which starts a thread with the first task
        apply = pool.map if len(drives) > 1 and threads > 1 else map
        for block in blocks:  # made ready by one thread: two would wait for each other's interpreter
            runs = ready(block, task, most_steps)
            series[2][3] = max(series[0].shape[0] // (2 * len(runs[0].pieces)), 1)
            list(apply(lambda part: [all_cycles(loop, run, task.cycles, series) for run in part],
                      [runs[n::threads] for n in range(threads)]))  # fmt: skip
            all_runs += runs
    columns = {name: series[0][: series[2][0], n] + (task.time[0] if n == 0 else 0.0) for n, name in enumerate(ROW)}
    return Simulation(
        figures=figures_of(all_runs), problems=tuple(_PROBLEMS[run.status] for run in all_runs),
        slopes=tuple(run.slopes for run in all_runs), series=columns if rows else None,
    )  # fmt: skip


# -- Laps: a simulated stretch with its tallies and its map of the temperatures.


PEAKS = [n for n, name in enumerate(TALLY) if f"T_{name}" in TALLY]
SUMS = slice(TALLY.index("SQUARE"), TALLY.index("I2T"))
_HIGHEST = [int(n) for n in (at.G_I2T, at.G_WINDING, at.G_HOUSING)]
_NONE = np.zeros((0, len(ROW)))


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
    """Simulate a drive along some pieces; for its current the temperatures are affine in those at the start."""
    s, g, A = run.s, tally(), np.eye(4)
    before = s.copy()
    s[at.WW : at.HQ + 1] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)
    run.status = int(loop(run.p, s, g, run.M, *run.scratch, pieces, run.ring, *series))
    time, copper = float(pieces[-1, 1] - pieces[0, 0]) * run.p[at.H], float(s[at.Q] - before[at.Q])
    run.simulated += time
    A[:3, 0], A[:3, 1] = s[at.WW : at.WQ + 1], s[at.HW : at.HQ + 1]
    A[:3, 3] = (s[at.T_W], s[at.T_H], copper) - A[:3, :2] @ before[[at.T_W, at.T_H]]
    return Lap(g, A, copper, time, float(s[at.STEPS] - before[at.STEPS]))


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
    if not exact:  # the same squares of current and torque, and the same work without the copper's heat
        if not earlier or lap.count < (_LEAST if run.p[at.EDGES] else _LEAST_EXACT):
            return 0
        (a, scale), (b, _) = _means(lap), _means(earlier[-1])
        if not np.all(np.abs(a - b) <= _ALIKE * scale) or _drifts(lap, earlier, left):
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

    states = np.array([s, before])  # voltages without the copper's drop, which varies with the temperature
    states[:, voltages(p)] -= (states[:, at.RES] * states[:, at.I])[:, None]
    limits = np.array([p[at.TOL_I], p[at.TOL_W], p[at.TOL_F], p[at.TOL_W] / p[at.RATIO], p[at.TOL_U], demand,
                       p[at.TOL_U], p[at.TOL_I], p[at.TOL_I], p[at.TOL_W], p[at.TOL_W]])  # fmt: skip
    compared = states[:, _COMPARED]
    if np.any(np.abs(compared[0] - compared[1]) > share * limits):
        return False
    return not p[at.PKP] or bool(abs(s[at.X] - before[at.X] - turned) <= share * p[at.TOL_X])


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
    """Laps until the winding's resistance has changed the current, found by halving.

    With an integral the current stays until the warmer winding needs more voltage than the bus has: that rises by the
    resistance times the largest current, under which the bus has least.
    """
    p, s, current = run.p, run.s, float(lap.g[at.G_I])
    if not p[at.HEAT]:
        return math.inf
    near = float(_CLOSE / max(abs(s[at.T_W] - before[at.T_W]), 1e-300))
    if not (p[at.CKI] if p[at.CASCADE] else p[at.KI]) or lap.g[at.G_SATURATED] != 0.0:
        return near
    room = available_voltage(p, current, float(lap.g[at.G_W]), 1.0) - lap.g[at.G_U_DEMAND]
    start, n = (s[at.T_W], s[at.T_H], 0.0, 1.0), left
    while n and p[at.ALPHA] * ((np.linalg.matrix_power(lap.A, n) @ start)[0] - s[at.T_W]) * current > room:
        n //= 2
    return max(n, near)


# -- Cycles and stretches by laps.


_COUNTS = 8  # counts of the encoder by which a lag varies without growing
_LAGS = 0.2  # of the lag, growth in a lap beyond which the position loop does not keep up
_LAP, _LAPS = 4096, 64  # periods of a lap of a stretch at one speed and load, at least, and laps of which it is long


def all_cycles(loop: Any, run: Run, cycles: int, series: tuple[Any, ...]) -> Run:
    """Simulate a drive through all cycles of its task."""
    p, pieces, unrecorded = run.p, run.pieces, (_NONE, *series[1:])
    if float((pieces[:, 1] - pieces[:, 0]) @ (pieces[:, 4] != 0.0)) > p[at.MOST]:  # at a changing speed nothing repeats
        run.status = at.TOO_LONG
        return run
    last, length = pieces[-1], float(pieces[-1, 1]) * p[at.H]
    since = last[1] * p[at.H] - last[2]
    turned = float(last[5] + (last[3] + 0.5 * last[4] * since) * since - pieces[0, 5])  # rad of the reference

    def lap(done: int, many: int) -> Lap:
        total: Lap | None = None
        for n in range(done, done + many):
            run.s[at.TURN] = n * turned
            total = joined(total, _cycle(loop, run, unrecorded if n else series), n * length)
            run.cycles = n + 1
            if run.status:
                break
        assert total is not None
        return total

    whole = _repeated(run, lap, cycles, turned)
    run.g[:] = whole.g
    if p[at.HEAT]:
        run.slopes = whole.A[:2, :2]
    run.time = (run.cycles if run.status else cycles) * length
    return run


def _cycle(loop: Any, run: Run, series: tuple[Any, ...]) -> Lap:
    """One cycle, its long stretches at one speed and load each by laps."""
    pieces, p = run.pieces, run.p
    whole = float(p[at.N_V] * max(p[at.N_P], 1.0))  # periods after which all loops are at the same sample again
    length = int(math.ceil(_LAP / whole) * whole)
    long = (pieces[:, 4] == 0.0) & (pieces[:, 7] == 0.0) & (pieces[:, 1] - pieces[:, 0] >= _LAPS * length)
    total: Lap | None = None
    for a, b in pairwise(
        sorted({0, len(pieces), *np.flatnonzero(long).tolist(), *(np.flatnonzero(long) + 1).tolist()})
    ):
        part = pieces[a:b]
        total = joined(
            total, _stretch(loop, run, part[0], length, series) if long[a] else simulated(loop, run, part, series)
        )
        if run.status:
            break
    assert total is not None
    return replace(total, count=1)


def _stretch(loop: Any, run: Run, piece: Array, length: int, series: tuple[Any, ...]) -> Lap:
    """A long stretch at one speed and load, lap by lap."""
    first, end = int(piece[0]), int(piece[1])
    laps = (end - first) // length

    def between(a: int, b: int) -> Lap:
        part = piece.copy()[None]
        part[0, 0], part[0, 1], part[0, 8] = a, b, piece[8] * (a == first)
        return simulated(loop, run, part, series)

    def lap(done: int, many: int) -> Lap:
        return replace(between(first + done * length, first + (done + many) * length), count=many)

    total = _repeated(run, lap, laps, float(piece[3]) * length * run.p[at.H], run.p[at.H])
    rest = first + laps * length
    return total if run.status or rest == end else joined(total, between(rest, end))


def _repeated(run: Run, simulate_laps: Callable[[int, int], Lap], laps: int, turned: float, period: float = 0.0) -> Lap:
    """Simulate laps until they are alike, and add the rest; heated, the last is simulated again at its temperatures."""
    total: Lap | None = None
    earlier: list[Lap] = []
    owed: Callable[[Lap | None], Lap] | None = None
    done, laps_run = 0, 0
    many = 1
    while done < laps and not run.status:
        before, many = run.s.copy(), min(many, laps - done)
        lap = simulate_laps(done, many)
        if owed:
            total, owed = joined(total, owed(lap)), None
        total, done, laps_run = joined(total, lap), done + many, laps_run + many
        if lap.steps * period < 0.5 * lap.time and period:
            many = laps - done
            continue
        times = alike(run, before, lap, earlier, many * turned, (laps - done - (run.p[at.HEAT] != 0.0)) // many,
                      not period)  # fmt: skip
        if times > 0:
            owed = _added(run, before, lap, times, many * turned)
            done += times * many
        else:
            many = laps_run
        earlier.append(lap)
        if owed and not run.p[at.HEAT]:
            total, owed = joined(total, owed(None)), None
    assert total is not None
    return joined(total, owed(None)) if owed else total


def _added(run: Run, before: Array, lap: Lap, times: int, turned: float) -> Callable[[Lap | None], Lap]:
    """Advance by laps like one; what they add is known with the lap after them.

    The winding warms, the controller's voltages following it; the position error grows where no position loop keeps it
    within some counts.
    """
    p, s, budget, heat = run.p, run.s, float(run.p[at.BUDGET]), times * lap.heat
    if p[at.HEAT]:
        places = voltages(p)
        s[at.T_W], s[at.T_H], heat, _ = np.linalg.matrix_power(lap.A, times) @ (s[at.T_W], s[at.T_H], 0.0, 1.0)
        s[places] -= s[at.RES] * s[at.I]
        s[at.RES] = p[at.R_A] + p[at.ALPHA] * s[at.T_W]
        s[places] += s[at.RES] * s[at.I]
    s[at.Q] += heat
    grows = float(s[at.I2T] - before[at.I2T])
    s[at.I2T] = min(max(0.0, s[at.I2T] + times * grows), budget)
    count = 2.0 * math.pi / p[at.EDGES] if p[at.EDGES] else 0.0
    lags = float(turned - (s[at.X] - before[at.X]))
    if p[at.PKP] and abs(lags) < max(_COUNTS * count, _LAGS * math.sqrt(lap.g[at.G_E2_X] / lap.time)):
        lags = 0.0
    angle = times * (turned - lags)
    if count:  # a whole number of them
        counts = round(angle / count)
        angle = counts * count
        run.ring += counts
    s[at.X] += angle
    s[at.Y] += angle / p[at.RATIO]  # a lap ends with the twist that it began with
    highest = min(lap.g[at.G_I2T] + times * max(grows, 0.0), budget)
    return lambda then: grown(lap, then, times, float(heat), highest, lags, float(p[at.RATIO]))
