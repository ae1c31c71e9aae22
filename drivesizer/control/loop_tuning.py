"""Designed gains checked on the sampled loop: made slower until every required margin is met, or refused.

The rules of ``voltage_loop_design`` and ``cascade_design`` place a bandwidth by lags and delays. The result is checked
on the loop itself, sampled, delayed, with its counted speed, in both directions of power: the phase margin, and with an
elastic shaft the distance to the resonance [1]. In the backlash the motor turns alone, as on a shaft of no stiffness;
any stiffness between none and that in contact may describe it [2], and both ends must hold.

.. [1] G. Ellis, *Control System Design Guide*, 4th ed., Elsevier 2012, ch. 16: resonance and the loop's bandwidth.
.. [2] M. Nordin, P.-O. Gutman, "Controlling mechanical systems with backlash - a survey", Automatica 38 (2002)
   1633-1649: describing functions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple, TypeVar

from drivesizer.control.cascade import Cascade
from drivesizer.control.drive_train import DriveTrain, Mode, Regime, modes
from drivesizer.control.loop_analysis import margin_and_bandwidth
from drivesizer.control.loop_models import (
    System,
    from_error,
    position_open_loop,
    resonance,
    velocity_open_loop,
    voltage_open_loop,
)
from drivesizer.control.loop_warnings import RESONANCE_SHARE
from drivesizer.control.validation import Gains
from drivesizer.errors import InputError
from drivesizer.units import show

__all__ = ["Required", "Tuned", "flaw", "tuned"]

Controller = TypeVar("Controller", Gains, Cascade)

_SLOWEST = 2.0**12  # factor beyond which no slower loop is tried
_CLOSE = 1.01  # to which factor the slower loop is sought


class Required(NamedTuple):
    """A drive train, and the margins that designed gains must meet around it."""

    train: DriveTrain
    margin: float  # rad, of phase, at least


class Tuned(NamedTuple):
    """Factor by which a loop is slower than its design rule, and why."""

    slower: float
    why: str


def tuned(make: Callable[[float], Controller], required: Required) -> tuple[Controller, Tuned]:
    """The fastest controller that meets the required margins."""
    found = make(1.0)
    why = flaw(found, required)
    if not why:
        return found, Tuned(1.0, "")
    low = high = 1.0
    while flaw(make(high), required):
        low, high = high, 2.0 * high
        if high > _SLOWEST:
            raise InputError(f"control: gains designed by rule miss their margins, however slow: {why}")
    while high / low > _CLOSE:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if flaw(make(middle), required) else (low, middle)
    return make(high), Tuned(high, why)


def flaw(controller: Gains | Cascade, required: Required) -> str:
    """The first margin that a loop misses, in words."""
    for name, opened in _opened(controller, required):
        margin, bandwidth = margin_and_bandwidth(opened)
        if math.isnan(margin):
            return f"the {name} is unstable"
        if margin < required.margin:
            return f"the {name} has {math.degrees(margin):.3g}° of phase margin, less than {_degrees(required.margin)}"
        if "stiff" in name and bandwidth > (most := RESONANCE_SHARE * _resonance(required)):
            hertz, share = (show(f, "Hz", "frequency", 3) for f in (bandwidth, most))
            return f"the {name} has a bandwidth of {hertz}, above {share}, a fifth of the resonance"
    return ""


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.3g}°"


def _resonance(required: Required) -> float:
    return resonance(required.train, modes(required.train)[Regime.FORWARD_BRAKING])[1]


def _opened(controller: Gains | Cascade, required: Required) -> Iterator[tuple[str, System]]:
    """The loops to be checked, with their names."""
    train = required.train
    every, rigid = modes(train), replace(train, stiffness=math.inf)
    directions = {"driving": every[Regime.FORWARD_DRIVING], "braking": every[Regime.FORWARD_BRAKING]}
    for direction, mode in directions.items():
        if train.flexible:
            yield f"velocity loop with a stiff shaft, {direction},", _velocity(controller, rigid, mode)
        yield f"velocity loop, {direction},", _velocity(controller, train, mode)
        if isinstance(controller, Cascade) and controller.position_kp and controller.position_period:
            yield f"position loop, {direction},", from_error(position_open_loop(train, mode, controller), "angle")
    if train.flexible and train.gap:
        alone = Mode(regime=Regime.FORWARD_DRIVING, inertia=train.motor_inertia, drag=train.friction)
        yield "velocity loop of the motor alone, in the backlash,", _velocity(controller, rigid, alone)


def _velocity(controller: Gains | Cascade, train: DriveTrain, mode: Mode) -> System:
    if isinstance(controller, Gains):
        return from_error(voltage_open_loop(train, mode, controller))
    return from_error(velocity_open_loop(train, mode, controller))
