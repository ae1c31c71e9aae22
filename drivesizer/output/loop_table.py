"""Gains of a controller and linear analysis of its loops, as the rows that terminal and reports print."""

from __future__ import annotations

from dataclasses import fields
from math import isnan, nan
from typing import TYPE_CHECKING, NamedTuple

from drivesizer.files.text import listed
from drivesizer.results.check import Figure, figures_of
from drivesizer.units import show

if TYPE_CHECKING:
    from drivesizer.control.validation import Cascade, Gains, LinearRun, Loop, Stepping

NONE = "–"  # of a figure that does not exist: no margins of an unstable loop, or an unbounded one


def loop_figures(loop: Loop) -> tuple[Figure, ...]:
    """The figures of a loop, main ones first; NaN where one does not exist.

    The sensitivity of an unstable loop is left NaN: its distance to -1 is no measure of robustness.
    """
    values = {field.name: getattr(loop, field.name) for field in fields(loop)}
    return figures_of("loop", values | ({} if loop.stable else {"sensitivity": nan}))


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
LINEAR_LOOP = "PID and DC motor by python-control, beside the engine"


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


_GAINS = (*listed("drivesizer.output", "gains.txt"),)


def gain_rows(gains: Gains | Cascade | Stepping) -> list[GainRow]:
    """Gains and periods of a controller, without the paths that it does not have; pulses of a stepper's driver."""
    rows = []
    for kind, (name, title, unit, *off) in _GAINS:
        if kind == type(gains).__name__ and (getattr(gains, name) or not off):
            rows.append(GainRow(name, title, float(getattr(gains, name)), unit))
    return rows
