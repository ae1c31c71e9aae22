"""A closed loop of figures that stand for themselves, and the labels of a figure."""

from __future__ import annotations

import re
from dataclasses import replace
from math import nan
from typing import Any

import numpy as np

from drivesizer.control.validation import Gains, Validation
from drivesizer.results.check import Check, Figure
from drivesizer.results.sizing import SizingResult

UNITS = {
    "time": ("time", "s"),
    "speed_reference": ("speed", "m/s"),
    "speed": ("speed", "m/s"),
    "error": ("speed", "m/s"),
    "motor_speed": ("rotary_speed", "rpm"),
    "current": ("current", "A"),
    "voltage": ("voltage", "V"),
    "motor_torque": ("torque", "mN*m"),
    "gearhead_torque": ("torque", "N*m"),
    "supply_power": ("power", "W"),
}


def synthetic_validation(result: SizingResult, *, step: float = 0.02) -> Validation:
    """A made-up closed loop with the shape of a real one: the speed lags its reference."""
    motion, drive_set = result.problem.spec.motion, (result.sets or result.misses)[0]
    end = 2 * motion.acceleration_time + motion.cruise_time
    time = np.arange(0.0, end + step, step)
    rise, fall = time / motion.acceleration_time, (end - time) / motion.acceleration_time
    reference = motion.speed * np.clip(np.minimum(rise, fall), 0.0, 1.0)
    speed = np.interp(time - 0.05, time, reference)
    slope = np.gradient(speed, time)
    current = 0.4 + 1.5 * slope
    columns = (time, reference, speed, reference - speed, 393.7 * speed, current, 9.2 * speed + 2.3 * current,
               0.0234 * current, 0.5 * current, 9.2 * speed * current)  # fmt: skip
    check = Check(
        name="current", title="Motor current", method="closed loop", case="trapezoid", demand=1.93, limit=5.0,
        kind="current", unit="A", margin=1.59, status="pass", at_time=1.98,
    )  # fmt: skip
    heat = replace(check, name="winding", title="Winding temperature", kind="temperature", unit="degC", demand=330.0,
                   limit=nan, margin=nan, status="unknown", at_time=None, note="no limit in the catalogue")  # fmt: skip
    return Validation(
        spec=result.problem.spec,
        drive_set=drive_set,
        profile="trapezoid",
        status="pass",
        checks=(check, heat),
        figures=(
            Figure(name="largest_error", title="Largest error", value=0.0375, kind="speed", unit="m/s", at_time=1.9),
            Figure(name="bandwidth", title="Bandwidth", value=12.5, kind="frequency", unit="Hz"),
        ),
        gains=Gains(
            kp=0.05, ki=0.4, kd=0.0, filter_time=0.001, period=0.0004, rule="magnitude optimum", source="Kessler 1955"
        ),
        series=dict(zip(UNITS, columns, strict=True)),
        series_units=dict(UNITS),
        assumptions=("the belt is stiff",),
        warnings=("heat is unknown",),
    )


def labels(drawn: Any) -> set[str]:
    """What is written in a figure: letters are outlines, but matplotlib keeps each label as a comment beside them."""
    return {part for text in re.findall(r"<!-- (.*?) -->", drawn().decode(), re.DOTALL) for part in text.split("\n")}
