"""Results of a simulation: figures as columns over drives, the time series of one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.laps import PEAKS
from drivesizer.control.engine.layout import ROW, TALLY, Array
from drivesizer.control.engine.start import Run

__all__ = ["FIGURES", "Simulation", "figures_of", "series_of"]


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
    "housing_highest": "HOUSING", "bus_lowest": "V_LOW", "bus_highest": "V_HIGH",
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


def series_of(recorded: tuple[Any, ...], origin: float) -> dict[str, Array]:
    """The recorded rows by their names."""
    rows = recorded[0][: recorded[2][0]]
    found = {name: rows[:, n].copy() for n, name in enumerate(ROW)}
    found["time"] += origin
    return found
