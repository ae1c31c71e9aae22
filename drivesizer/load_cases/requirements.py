"""Requirements of loads that the paper does not treat: its quantities, by its names, from the load cycle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drivesizer.physics.load_cycle import LoadCycle, mean_product, rms
from drivesizer.results.requirement import Requirement

__all__ = ["requirements"]

_SPEED, _TORQUE, _POWER = ("rotary_speed", "rpm"), ("torque", "N*m"), ("power", "W")


def requirements(cycles: Sequence[LoadCycle]) -> list[Requirement]:
    """Figures of the load at the driven shaft of one drive, in the worst of its load cases' cycles."""
    found = [_figures(cycle) for cycle in cycles]
    rows = []
    for name, (title, symbol, (kind, unit)) in _NAMES.items():
        worst = max((one[name] for one in found), key=abs)
        note = "in the worst load case" if len(found) > 1 else ""
        rows.append(Requirement(name=name, title=title, symbol=symbol, value=worst, kind=kind, unit=unit, note=note))
    return rows


_NAMES = {
    "nominal_speed": ("Largest speed of the load's shaft", "n_nom", _SPEED),
    "rms_speed": ("RMS speed", "n_rms", _SPEED),
    "maximum_torque_per_motor": ("Largest torque", "M_max/m", _TORQUE),
    "rms_torque_per_motor": ("RMS torque", "M_rms/m", _TORQUE),
    "maximum_power_per_motor": ("Largest power to the load", "P_max/m", _POWER),
    "returned_power_per_motor": ("Largest power from the load", "P_ret/m", _POWER),
    "mean_power_per_motor": ("Mean power to the load", "P_mean/m", _POWER),
    "load_inertia_per_motor": ("Inertia of the load at its shaft", "J_load/m", ("inertia", "kg*m^2")),
    "cycle_time": ("Length of the cycle", "t_cycle", ("time", "s")),
}


_ROUNDING = 1e-12  # of the largest torque times the highest speed: a smaller power is none


def _above(power: float, least: float) -> float:
    return power if power > least else 0.0


def _figures(cycle: LoadCycle) -> dict[str, float]:
    power, duration = cycle.power, cycle.duration
    mean = float(duration @ mean_product(cycle.torque, cycle.speed)) / cycle.total
    least = _ROUNDING * float(np.abs(cycle.torque).max() * np.abs(cycle.speed).max())
    return {
        "nominal_speed": float(np.abs(cycle.speed).max()),
        "rms_speed": rms(duration, cycle.speed),
        "maximum_torque_per_motor": float(np.abs(cycle.torque).max()),
        "rms_torque_per_motor": rms(duration, cycle.torque),
        "maximum_power_per_motor": _above(float(power.max()), least),
        "returned_power_per_motor": _above(-float(power.min()), least),
        "mean_power_per_motor": mean if abs(mean) > least else 0.0,
        "load_inertia_per_motor": cycle.inertia,
        "cycle_time": cycle.total,
    }
