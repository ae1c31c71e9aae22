"""Requirements of loads out of their cycles: the paper's quantities, mean load and life of a ball screw."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from drivesizer.load_cases import sprung
from drivesizer.load_cases.profile import profile_of
from drivesizer.loads.course import course
from drivesizer.loads.kinds import MODULES
from drivesizer.physics.load_cycle import LoadCycle, mean_product, rms
from drivesizer.results.drive_set import Requirement
from drivesizer.spec.robot import RobotSpec

# -- Requirements of loads that the paper does not treat: its quantities, by its names, from the load cycle.


_SPEED, _TORQUE, _POWER = ("rotary_speed", "rpm"), ("torque", "N*m"), ("power", "W")


def requirements(cycles: Sequence[LoadCycle]) -> list[Requirement]:
    """Figures of the load at the driven shaft of one drive, in the worst of its load cases' cycles."""
    found = []
    for cycle in cycles:
        power, duration = cycle.power, cycle.duration
        torque, speed = (float(np.abs(column).max()) for column in (cycle.torque, cycle.speed))
        mean = float(duration @ mean_product(cycle.torque, cycle.speed)) / cycle.total
        powers = {"maximum": float(power.max()), "returned": -float(power.min()), "mean": mean}
        least = _ROUNDING * torque * speed
        seen = {name: x if (abs(x) if name == "mean" else x) > least else 0.0 for name, x in powers.items()}
        found.append({
            "nominal_speed": speed, "rms_speed": rms(duration, cycle.speed),
            "maximum_torque_per_motor": torque, "rms_torque_per_motor": rms(duration, cycle.torque),
            **{f"{name}_power_per_motor": x for name, x in seen.items()},
            "load_inertia_per_motor": cycle.inertia, "cycle_time": cycle.total,
        })  # fmt: skip
    note = "in the worst load case" if len(found) > 1 else ""
    return [
        Requirement(
            name=name,
            title=title,
            symbol=symbol,
            value=max((one[name] for one in found), key=abs),
            kind=kind,
            unit=unit,
            note=note,
        )
        for name, title, symbol, (kind, unit) in _FIGURES
    ]


_ROUNDING = 1e-12  # of the largest torque times the highest speed: a smaller power is none
_FIGURES = (
    ("nominal_speed", "Largest speed of the load's shaft", "n_nom", _SPEED),
    ("rms_speed", "RMS speed", "n_rms", _SPEED),
    ("maximum_torque_per_motor", "Largest torque", "M_max/m", _TORQUE),
    ("rms_torque_per_motor", "RMS torque", "M_rms/m", _TORQUE),
    ("maximum_power_per_motor", "Largest power to the load", "P_max/m", _POWER),
    ("returned_power_per_motor", "Largest power from the load", "P_ret/m", _POWER),
    ("mean_power_per_motor", "Mean power to the load", "P_mean/m", _POWER),
    ("load_inertia_per_motor", "Inertia of the load at its shaft", "J_load/m", ("inertia", "kg*m^2")),
    ("cycle_time", "Length of the cycle", "t_cycle", ("time", "s")),
)


# -- Mean load and nominal life of a ball screw over its load cases, as figures: whether a life is required or not.


def screw_requirements(cases: Sequence[RobotSpec]) -> list[Requirement]:
    """Figures of the life of a ball screw in the load case in which it is shortest; none without a dynamic rating."""
    lives = []
    for spec in cases:
        load: Any = spec.load
        if MODULES[load.kind] == "screw" and load.dynamic_load is not None:
            from drivesizer.loads.screw import screw_life
            from drivesizer.loads.stage_losses import force_along

            moved = sprung(spec, course(profile_of(spec)))
            force = force_along(moved, load, spec.environment.gravity, load.mass) / load.motors
            lives.append(screw_life(load, moved, force))
    if not lives:
        return []
    worst = min(lives, key=lambda one: one.time)
    figures = (
        ("screw_mean_load", "Mean axial load of the screw", "F_m", max(worst.mean), ("force", "N")),
        ("screw_life_turns", "Nominal life of the screw in turns", "L_10", worst.turns, ("dimensionless", "1")),
        ("screw_life_distance", "Nominal life of the screw in distance", "L_s", worst.distance, ("length", "km")),
        ("screw_life_time", "Nominal life of the screw, rests included", "L_h", worst.time, ("time", "h")),
    )
    note = "in the worst load case" if len(lives) > 1 else ""
    return [
        Requirement(name=name, title=title, symbol=symbol, value=float(x), kind=kind, unit=unit, note=note)
        for name, title, symbol, x, (kind, unit) in figures
    ]
