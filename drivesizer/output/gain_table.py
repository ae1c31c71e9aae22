"""The gains of a controller as rows: what each is called, its value and unit."""

from __future__ import annotations

from typing import NamedTuple

from drivesizer.control.cascade import Cascade
from drivesizer.control.validation import Gains

__all__ = ["GainRow", "gain_rows"]


class GainRow(NamedTuple):
    """One gain or period, in SI."""

    name: str
    title: str
    value: float
    unit: str


_VOLTAGE = (
    ("kp", "Proportional gain, at the motor", "V*s/rad"),
    ("ki", "Integral gain", "V/rad"),
    ("kd", "Derivative gain", "V*s^2/rad"),
    ("filter_time", "Filter of the derivative", "s"),
    ("period", "Period of the controller", "s"),
    ("counted_over", "Periods over which counts are taken for a speed", "1"),
)
_CASCADE = (
    ("current_kp", "Current loop, proportional gain", "V/A"),
    ("current_ki", "Current loop, integral gain", "V/(A*s)"),
    ("velocity_kp", "Velocity loop, proportional gain, at the motor", "A*s/rad"),
    ("velocity_ki", "Velocity loop, integral gain", "A/rad"),
    ("velocity_kd", "Velocity loop, derivative gain", "A*s^2/rad"),
    ("filter_time", "Filter of the derivative", "s"),
    ("position_kp", "Position loop, proportional gain", "1/s"),
    ("feedforward_velocity", "Feedforward of the velocity", "A*s/rad"),
    ("feedforward_friction", "Feedforward of the friction", "A"),
    ("feedforward_acceleration", "Feedforward of the acceleration", "A*s^2/rad"),
    ("current_period", "Period of the current loop", "s"),
    ("velocity_period", "Period of the velocity loop", "s"),
    ("position_period", "Period of the position loop", "s"),
    ("counted_over", "Velocity periods over which counts are taken for a speed", "1"),
)
_MAY_BE_OFF: dict[type, set[str]] = {  # 0: there is no such path
    Gains: {"counted_over"},
    Cascade: {"velocity_kd", "filter_time", "position_kp", "position_period", "counted_over"},
}


def gain_rows(gains: Gains | Cascade) -> list[GainRow]:
    """All gains and periods of a controller, without the paths that it does not have."""
    table = _VOLTAGE if isinstance(gains, Gains) else _CASCADE
    rows = [GainRow(name, title, float(getattr(gains, name)), unit) for name, title, unit in table]
    return [row for row in rows if row.value or row.name not in _MAY_BE_OFF[type(gains)]]
