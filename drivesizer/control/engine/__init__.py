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

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.kernel import KERNEL
from drivesizer.control.engine.laps import PEAKS, all_cycles
from drivesizer.control.engine.layout import ROW, TALLY, Array
from drivesizer.control.engine.start import CurrentLimit, Drive, MotorHeat, Run, Supply, Task, line, ready
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
    found: dict[str, Array] = {}
    for name, place in FIGURES.items():
        n = TALLY.index(place)
        found[name] = g[:, n].copy()
        if n in PEAKS:
            found[f"{name}_time"] = g[:, n + 1].copy()
    warm = np.where(p[:, at.HEAT] != 0.0, p[:, at.AMBIENT], np.nan)
    found |= {"winding": s[:, at.T_W] + warm, "housing": s[:, at.T_H] + warm}
    found["winding_highest"] += warm
    found["housing_highest"] += warm
    time = np.array([run.time for run in runs])
    with np.errstate(all="ignore"):
        found |= {
            "rms_current": np.sqrt(g[:, at.G_SQUARE] / time),
            "rms_gear_torque_running": np.sqrt(g[:, at.G_G_SQUARE] / g[:, at.G_RUNNING]),
            "i2t_share": g[:, at.G_I2T] / p[:, at.BUDGET],
        }
    return found | {"copper_heat": s[:, at.Q].copy(), "angle": s[:, at.X].copy(), "load_angle": s[:, at.Y].copy(),
                    "time": time, "time_simulated": np.array([run.simulated for run in runs]),
                    "steps": s[:, at.STEPS].copy()}  # fmt: skip


_MOST_STEPS = 50_000_000  # of one drive: some ten seconds of computing
_BLOCK = 256  # drives whose matrices are held at a time
_PROBLEMS = ("", "the state leaves the range of numbers: the loop is unstable", "more steps than are permitted")


def is_compiled() -> bool:
    """Whether the simulation is at hand as machine code."""
    return KERNEL.kept


def simulate(
    drive: Drive | Sequence[Drive], task: Task, *, rows: int = 20_000, most_steps: int = _MOST_STEPS, threads: int = 2
) -> Simulation:
    """Simulate a drive along a task, with so many rows of its time series, or several drives side by side.

    The figures do not depend on the number of threads.
    """
    drives, loop = [drive] if isinstance(drive, Drive) else drive, machine_code(KERNEL)
    blocks = [drives[n : n + _BLOCK] for n in range(0, len(drives), _BLOCK)]
    series = np.zeros((rows + 2 if rows else 0, len(ROW))), np.zeros(rows + 2, np.int8), np.array([0, 1, rows // 2, 1])
    found: list[Run] = []
    with ThreadPoolExecutor(threads) as pool:  # which starts a thread with the first task
        each = pool.map if len(drives) > 1 and threads > 1 else map
        for block in blocks:  # made ready by one thread: two would wait for each other's interpreter
            runs = ready(block, task, most_steps)
            series[2][3] = max(series[0].shape[0] // (2 * len(runs[0].pieces)), 1)
            list(each(lambda part: [all_cycles(loop, one, task.cycles, series) for one in part],
                      [runs[n::threads] for n in range(threads)]))  # fmt: skip
            found += runs
    kept = {name: series[0][: series[2][0], n] + (task.time[0] if n == 0 else 0.0) for n, name in enumerate(ROW)}
    return Simulation(
        figures=figures_of(found), problems=tuple(_PROBLEMS[run.status] for run in found),
        slopes=tuple(run.slopes for run in found), series=kept if rows else None,
    )  # fmt: skip
