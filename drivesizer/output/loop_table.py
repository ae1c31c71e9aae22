"""Gains of a controller and linear analysis of its loops, as the rows that terminal and reports print."""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan, nan
from typing import Any, NamedTuple

from drivesizer.control.validation import Cascade, Gains, LinearRun, Loop, Stepping, Validation
from drivesizer.output.derivation import margin
from drivesizer.results.check import Status, sentence_case
from drivesizer.results.sizing import Figure
from drivesizer.units import label, show

__all__ = [
    "BESIDE",
    "NONE",
    "NO_LINEAR",
    "GainRow",
    "cell",
    "gain",
    "gain_rows",
    "left_out",
    "linear",
    "linear_rows",
    "loop_figures",
    "loop_name",
    "remedies",
    "settled",
]  # fmt: skip

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


def linear_rows(run: LinearRun) -> list[tuple[str, str, str, str, str]]:
    """Rows of the linear simulation beside the engine: title, value and moment by either; a dash where one has none."""
    return [(row.linear.title, *_moment(row.linear), *_moment(row.engine)) for row in run.figures]


def left_out(run: LinearRun) -> str:
    """A sentence on what the linear model does without."""
    return f"python-control's model is linear: {'; '.join(run.left_out)}."


def _moment(figure: Figure | None) -> tuple[str, str]:
    if figure is None or isnan(figure.value):
        return NONE, ""
    return figure.text, "" if figure.at_time is None else f"{figure.at_time:.4g} s"


def settled(loop: Loop) -> int:
    """Samples of a step response to show: up to twice the settling time; all where it does not settle."""
    if isnan(loop.settling_time):
        return len(loop.step)
    return min(max(round(2.0 * loop.settling_time / loop.period), _LEAST) + 1, len(loop.step))


_LEAST = 10  # samples, of a loop that settles at once


def gain(row: GainRow) -> str:
    """A gain in SI; a period in ms."""
    return show(row.value, "ms", "time") if row.unit == "s" else f"{row.value:.4g} {label(row.unit)}"


def linear(loops: Sequence[Loop]) -> dict[str, Any]:
    """The linear analysis of the loops as a table, a row for each."""
    found = [loop_figures(loop) for loop in loops]
    return {
        "heads": [figure.title for figure in found[0]] if found else [],
        "rows": [
            {"name": loop_name(loop), "stable": loop.stable, "cells": [cell(figure) for figure in row]}
            for loop, row in zip(loops, found, strict=True)
        ],
        "directed": any(loop.direction for loop in loops),
        "unstable": any(not loop.stable for loop in loops),
    }


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


def remedies(proof: Validation) -> tuple[str, list[tuple[str, str, str, Status]]]:
    """Changes that help a drive that fails in its loop, and those that were tried in vain."""
    rows = []
    for one in sorted(proof.tried, key=lambda one: one.status == "fail"):
        tight = f"{sentence_case(one.tightest.title)} {margin(one.tightest.margin)}" if one.tightest else ""
        rows.append((one.what, one.entry, tight, one.status))
    helps = any(one.status != "fail" for one in proof.tried)
    return "What helps in the loop, each simulated by itself" if helps else "Nothing that was simulated helps", rows
