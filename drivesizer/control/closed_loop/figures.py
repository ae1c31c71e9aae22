"""Figures and time series of a closed-loop simulation, seen from the load."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.closed_loop.run import ClosedLoop
from drivesizer.load_cases.profile import SPEED
from drivesizer.physics.counted_speed import speed_quantum
from drivesizer.physics.power_stage import of_the_source
from drivesizer.results.sizing import Figure

__all__ = ["figures", "quantum", "series", "series_units"]

_TRAVEL = {"linear": ("length", "mm"), "rotary": ("angle", "deg")}
_SHARE, _CURRENT, _VOLTAGE = ("dimensionless", "%"), ("current", "A"), ("voltage", "V")
_HERTZ, _HEAT, _ENERGY = ("frequency", "Hz"), ("temperature", "degC"), ("energy", "W*h")
_Row = tuple[str, str, float, tuple[str, str], float | None]


def figures(case: ClosedLoop) -> tuple[Figure, ...]:
    """Figures of a simulation, without limits of their own."""
    rows = [*_tracking(case), *_loop(case), *_electrical(case)]
    if case.task.cycles > 1:
        rows.append(("mission", "Simulated time", case.figure("time"), ("time", "min"), None))
    return tuple(Figure(name=n, title=t, value=v, kind=k, unit=u, at_time=at) for n, t, v, (k, u), at in rows)


def quantum(case: ClosedLoop) -> float:
    """Smallest step of the counted speed over its counting time [rad/s]; NaN unknown."""
    encoder, periods = case.drive_set.encoder, max(case.controller.counted_over, 1)
    return speed_quantum(encoder.lines, case.velocity_period, periods) if encoder else math.nan


def _tracking(case: ClosedLoop) -> list[_Row]:
    """Errors of the load against the reference; of two masses also those of the motor, as at the load."""
    radius, time, top = case.train.radius, case.figure("time"), case.profile.top_speed
    speed, travel, of_top = SPEED[case.spec.load.axis], _TRAVEL[case.spec.load.axis], 1.0 / top if top else math.nan
    peak, when = case.figure("load_speed_error") * radius, case.figure("load_speed_error_time")
    rms = math.sqrt(case.figure("load_speed_error_square") / time) * radius
    left = case.profile.distance * case.task.cycles - case.figure("load_angle") * radius
    rows: list[_Row] = [
        ("tracking_error_peak", "Tracking error, peak", peak, speed, when),
        ("tracking_error_peak_share", "Tracking error, peak, of top speed", peak * of_top, _SHARE, when),
        ("tracking_error_rms", "Tracking error, RMS", rms, speed, None),
        ("tracking_error_rms_share", "Tracking error, RMS, of top speed", rms * of_top, _SHARE, None),
        ("position_error_peak", "Position error at the load, peak", case.figure("load_angle_error") * radius, travel,
         case.figure("load_angle_error_time")),
        ("distance_error", "Final position error, load", left, travel, None),
        *(_motor_errors(case) if case.train.flexible else ()),
        ("voltage_saturation", "Time at the voltage limit", case.figure("time_at_voltage_limit") / time, _SHARE, None),
        ("current_limitation", "Time at the current limit", case.figure("time_at_current_limit") / time, _SHARE, None),
        ("speed_quantum", "One encoder count, at the load",
         quantum(case) / case.train.motor_per_speed, speed, None),
    ]  # fmt: skip
    return rows if top else [row for row in rows if not row[0].endswith("_share")]


def _motor_errors(case: ClosedLoop) -> list[_Row]:
    """The same errors of the motor's shaft, through the total ratio as if the shaft were stiff."""
    per_speed, time = case.train.motor_per_speed, case.figure("time")
    speed, travel = SPEED[case.spec.load.axis], _TRAVEL[case.spec.load.axis]
    left = case.profile.distance * case.task.cycles - case.figure("angle") / per_speed
    return [
        ("motor_tracking_error_peak", "Tracking error of the motor, as at the load, peak",
         case.figure("speed_error") / per_speed, speed, case.figure("speed_error_time")),
        ("motor_tracking_error_rms", "Tracking error of the motor, as at the load, RMS",
         math.sqrt(case.figure("speed_error_square") / time) / per_speed, speed, None),
        ("motor_position_error_peak", "Position error of the motor, as at the load, peak",
         case.figure("angle_error") / per_speed, travel, case.figure("angle_error_time")),
        ("motor_distance_error", "Final position error, motor, as at the load", left, travel, None),
    ]  # fmt: skip


def _loop(case: ClosedLoop) -> list[_Row]:
    loops, velocity = case.loops, case.loops.velocity
    rows: list[_Row] = [
        ("bandwidth", "Velocity loop, bandwidth (-3 dB)", velocity.bandwidth, _HERTZ, None),
        ("phase_margin", "Velocity loop, phase margin", velocity.phase_margin, ("angle", "deg"), None),
        ("gain_margin", "Velocity loop, gain margin (factor)", velocity.gain_margin, ("dimensionless", "1"), None),
        ("overshoot", "Velocity loop, overshoot of a step", velocity.overshoot, _SHARE, None),
    ]
    if loops.current:
        rows.insert(0, ("current_bandwidth", "Current loop, bandwidth (-3 dB)", loops.current.bandwidth, _HERTZ, None))
    if case.train.flexible:
        rows.append(("resonance", "Resonance of motor and load", loops.resonance, _HERTZ, None))
    return rows


def _electrical(case: ClosedLoop) -> list[_Row]:
    motors, seen, feed = (
        case.spec.load.motors,
        case.figure,
        case.spec.feed_of(case.drive_set.controller, case.drive_set.brake),
    )
    standby = float(feed.stage.standby)
    peak = float(of_the_source(seen("power") + standby, feed)) * motors
    taken = (seen("energy_in") + standby * seen("time")) * motors + seen("energy_resisted")
    rows: list[_Row] = [
        ("rms_current", "Motor current, RMS", seen("rms_current"), _CURRENT, None),
        ("peak_current", "Motor current, peak", seen("current"), _CURRENT, seen("current_time")),
        ("bus_lowest", "Supply voltage, lowest", seen("bus_lowest"), _VOLTAGE, None),
        (
            "peak_power",
            "Electrical power, peak, all drives",
            peak,
            ("power", "W"),
            seen("power_time"),
        ),
        ("energy_in", "Electrical energy taken, all drives", taken, _ENERGY, None),
        ("energy_returned", "Electrical energy returned, all drives", seen("energy_returned") * motors, _ENERGY, None),
    ]
    if case.periodic:
        rows.insert(2, ("winding_end", "Winding at the end, from ambient", seen("winding"), _HEAT, None))
    return rows


def series_units(case: ClosedLoop) -> dict[str, tuple[str, str]]:
    """Kind and unit of the trade of each column of the series."""
    speed, travel = SPEED[case.spec.load.axis], _TRAVEL[case.spec.load.axis]
    units = {
        "time": ("time", "s"),
        "speed_reference": speed,
        "speed": speed,
        "error": speed,
        "motor_error": speed,
        "position_error": travel,
        "motor_position_error": travel,
        "motor_speed": ("rotary_speed", "rpm"),
        "current": _CURRENT,
        "voltage": _VOLTAGE,
        "motor_torque": ("torque", "mN*m"),
        "gearhead_torque": ("torque", "N*m"),
        "winding_temperature": _HEAT,
        "supply_power": ("power", "W"),
    }
    return {name: unit for name, unit in units.items() if name in series(case)}


def _supply_power(case: ClosedLoop, voltage: Any, current: Any) -> Any:
    """Power out of the source, of all drives [W]: losses of power stages and of the supply's resistance included."""
    feed = case.spec.feed_of(case.drive_set.controller, case.drive_set.brake)
    at_stage = voltage * current + feed.lost(current) + feed.stage.standby
    return of_the_source(at_stage, feed) * case.spec.load.motors


def series(case: ClosedLoop) -> dict[str, NDArray[np.float64]]:
    """Recorded rows of the first cycle as columns, seen from the load and from the supply."""
    rows: Any = case.out.series
    per_speed = case.train.motor_per_speed
    reference, speed = rows["reference"] / per_speed, rows["load_speed"] * case.train.radius
    found = {
        "time": rows["time"],
        "speed_reference": reference,
        "speed": speed,
        "error": reference - speed,
        "motor_error": reference - rows["motor_speed"] / per_speed,
        "position_error": rows["load_position_error"] * case.train.radius,
        "motor_position_error": rows["position_error"] / per_speed,
        "motor_speed": rows["motor_speed"],
        "current": rows["current"],
        "voltage": rows["voltage"],
        "motor_torque": case.train.torque_constant * rows["current"],
        "gearhead_torque": rows["gear_torque"],
        "winding_temperature": rows["winding"],
        "supply_power": _supply_power(case, rows["voltage"], rows["current"]),
    }
    if not case.periodic:
        del found["winding_temperature"]  # it is held at 25 degC
    if not case.train.flexible:  # rigid, the motor's errors are the load's
        del found["motor_error"], found["motor_position_error"]
    return found
