"""Gains of a controller and linear analysis of its loops, as the rows that terminal and reports print."""

from __future__ import annotations

from math import isnan, nan
from typing import NamedTuple

from drivesizer.control.validation import Cascade, Gains, LinearRun, Loop, Stepping
from drivesizer.results.check import Figure
from drivesizer.units import show

NONE = "–"  # of a figure that does not exist: no margins of an unstable loop, or an unbounded one

_COLUMNS = (  # attribute of a loop, title, kind, unit
    ("bandwidth", "bandwidth", "frequency", "Hz"),
    ("phase_margin", "phase margin", "angle", "deg"),
    ("gain_margin", "gain margin", "dimensionless", "1"),
    ("overshoot", "overshoot", "dimensionless", "%"),
    ("settling_time", "settling time", "time", "ms"),
    ("pole_radius", "largest pole", "dimensionless", "1"),
    ("crossover", "crossover", "frequency", "Hz"),
    ("rise_time", "rise time", "time", "ms"),
    ("sensitivity", "sensitivity", "dimensionless", "1"),
    ("period", "period", "time", "ms"),
)


def loop_figures(loop: Loop) -> tuple[Figure, ...]:
    """The figures of a loop, main ones first; NaN where one does not exist.

    The sensitivity of an unstable loop is left NaN: its distance to -1 is no measure of robustness.
    """
    found = {name: float(getattr(loop, name)) for name, *_ in _COLUMNS}
    if not loop.stable:
        found["sensitivity"] = nan
    return tuple(Figure(name=name, title=title, value=found[name], kind=k, unit=u) for name, title, k, u in _COLUMNS)


def loop_name(loop: Loop) -> str:
    """Name of a loop, with the direction of power where there is one.

    >>> from types import SimpleNamespace
    >>> loop_name(SimpleNamespace(name="velocity", direction="braking"))
    'velocity, braking'
    """
    return ", ".join(filter(None, (loop.name, loop.direction)))


def cell(figure: Figure) -> str:
    """A figure of a loop as text: three digits, the pole's modulus with four; a dash where it does not exist."""
    if isnan(figure.value):
        return NONE
    return show(figure.value, figure.unit, figure.kind, 4 if figure.name == "pole_radius" else 3)


NO_LINEAR = "python-control is not beside it: a stepper follows its pulses in open loop, and nothing is fed back."
BESIDE = "PID and DC motor by python-control, beside the engine"


def left_out(run: LinearRun) -> str:
    """A sentence on what the linear model does without."""
    return f"python-control's model is linear: {'; '.join(run.left_out)}."


def settled(loop: Loop) -> int:
    """Samples of a step response to show: up to twice the settling time; all where it does not settle."""
    if isnan(loop.settling_time):
        return len(loop.step)
    return min(max(round(2.0 * loop.settling_time / loop.period), _LEAST) + 1, len(loop.step))


_LEAST = 10  # samples, of a loop that settles at once


# --- gains


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
_STEPPING = (
    ("microsteps", "Microsteps of a full step", "1"),
    ("pulse_rate", "Rate of the pulses, largest", "Hz"),
    ("damping_ratio", "Damping ratio of the rotor's swings", "1"),
)
_TABLES = {Gains: _VOLTAGE, Cascade: _CASCADE, Stepping: _STEPPING}
_MAY_BE_OFF: dict[type, set[str]] = {  # 0: the controller has no such path
    Gains: {"counted_over"},
    Cascade: {"velocity_kd", "filter_time", "position_kp", "position_period", "counted_over"},
}


def gain_rows(gains: Gains | Cascade | Stepping) -> list[GainRow]:
    """Gains and periods of a controller, without the paths that it does not have; pulses of a stepper's driver."""
    rows = [GainRow(name, title, float(getattr(gains, name)), unit) for name, title, unit in _TABLES[type(gains)]]
    return [row for row in rows if row.value or row.name not in _MAY_BE_OFF.get(type(gains), ())]
