"""Simulation of drives along a task: one with its time series, or many in threads."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from drivesizer.control.engine.cycles import all_cycles
from drivesizer.control.engine.figures import Simulation, figures_of, series_of
from drivesizer.control.engine.kernel import compiled
from drivesizer.control.engine.layout import ROW
from drivesizer.control.engine.start import Run, ready
from drivesizer.control.engine.task import Drive, Task
from drivesizer.control.engine.task_checks import checked

__all__ = ["simulate", "simulate_many"]

_MOST_STEPS = 50_000_000  # of one drive: some ten seconds of computing
_MOST_ROWS = 20_000
_BLOCK = 256  # drives whose matrices are held at a time
_PROBLEMS = ("", "the state leaves the range of numbers: the loop is unstable", "more steps than are permitted")


def simulate(drive: Drive, task: Task, *, rows: int = _MOST_ROWS, most_steps: int = _MOST_STEPS) -> Simulation:
    """Simulate one drive along a task, with its time series."""
    return _simulate([drive], task, rows, most_steps, 1)


def simulate_many(
    drives: Sequence[Drive], task: Task, *, threads: int = 2, most_steps: int = _MOST_STEPS
) -> Simulation:
    """Simulate many drives along one task; the figures do not depend on the number of threads."""
    return _simulate(drives, task, 0, most_steps, threads)


def _simulate(drives: Sequence[Drive], task: Task, rows: int, most: int, threads: int) -> Simulation:
    checked(drives, task)
    loop = compiled()
    blocks = [drives[n : n + _BLOCK] for n in range(0, len(drives), _BLOCK)]
    series = np.zeros((rows + 2 if rows else 0, len(ROW))), np.zeros(rows + 2, np.int8), np.array([0, 1, rows // 2, 1])
    found: list[Run] = []
    with ThreadPoolExecutor(threads) as pool:  # which starts a thread with the first task
        each = pool.map if len(drives) > 1 and threads > 1 else map
        for block in blocks:  # made ready by one thread: two would wait for each other's interpreter
            runs = ready(block, task, most)
            series[2][3] = max(series[0].shape[0] // (2 * len(runs[0].pieces)), 1)
            list(each(lambda part: [all_cycles(loop, one, task.cycles, series) for one in part],
                      [runs[n::threads] for n in range(threads)]))  # fmt: skip
            found += runs
    return Simulation(
        figures=figures_of(found),
        problems=tuple(_PROBLEMS[run.status] for run in found),
        slopes=tuple(run.slopes for run in found),
        series=series_of(series, task.time[0]) if rows else None,
    )
