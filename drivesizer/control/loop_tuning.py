"""Designed gains held against the sampled loop: made slower until every stated margin holds, or refused.

The rules of ``voltage_loop_design`` and ``cascade_design`` place a bandwidth by lags and delays. What is left then
of it is seen on the loop itself, sampled, delayed, its speed counted as it is, in both directions of power: the phase
margin, and with an elastic shaft the distance to the resonance [1]. With backlash the motor turns alone at times, a
shaft of no stiffness; any stiffness between none and that in contact may describe it [2], and both ends must hold.

.. [1] G. Ellis, *Control System Design Guide*, 4th ed., Elsevier 2012, ch. 16: resonance and the loop's bandwidth.
.. [2] M. Nordin, P.-O. Gutman, "Controlling mechanical systems with backlash - a survey", Automatica 38 (2002)
   1633-1649: describing functions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple, TypeVar

from drivesizer.control.cascade import Cascade
from drivesizer.control.drive_train import DriveTrain, Mode, Regime, modes
from drivesizer.control.loop_analysis import margin_and_bandwidth
from drivesizer.control.loop_models import Shaft, position_open_loop, resonance, velocity_open_loop, voltage_open_loop
from drivesizer.control.loop_warnings import RESONANCE_SHARE
from drivesizer.control.validation import Gains
from drivesizer.errors import InputError
from drivesizer.units import show

__all__ = ["Held", "Tuned", "flaw", "tuned"]

Controller = TypeVar("Controller", Gains, Cascade)

_SLOWEST = 2.0**12  # beyond which no slower loop is tried
_CLOSE = 1.01  # to which factor the slower loop is sought


class Held(NamedTuple):
    """What designed gains must hold around a machine."""

    train: DriveTrain
    shaft: Shaft | None
    gap: float  # rad of backlash at the driven shaft
    margin: float  # rad, of phase, at least


class Tuned(NamedTuple):
    """How much slower a loop had to be than its rule, and why."""

    slower: float
    why: str


def tuned(make: Callable[[float], Controller], held: Held) -> tuple[Controller, Tuned]:
    """The fastest controller whose margins hold.

    Parameters
    ----------
    make
        From a factor by which the loop is to be slower than its rule to the controller.
    held
        The machine and what is to hold.

    Raises
    ------
    InputError
        When none does, however slow.
    """
    found = make(1.0)
    why = flaw(found, held)
    if not why:
        return found, Tuned(1.0, "")
    low = high = 1.0
    while flaw(make(high), held):
        low, high = high, 2.0 * high
        if high > _SLOWEST:
            raise InputError(f"control: gains designed by rule do not hold, however slow: {why}")
    while high / low > _CLOSE:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if flaw(make(middle), held) else (low, middle)
    return make(high), Tuned(high, why)


def flaw(controller: Gains | Cascade, held: Held) -> str:
    """What does not hold in a loop; empty where everything does."""
    for name, opened in _opened(controller, held):
        margin, bandwidth = margin_and_bandwidth(opened)
        if math.isnan(margin):
            return f"the {name} is unstable"
        if margin < held.margin:
            return f"the {name} has {math.degrees(margin):.3g}° of phase margin, less than {_degrees(held.margin)}"
        if "stiff" in name and bandwidth > (most := RESONANCE_SHARE * _resonance(held)):
            hertz, share = (show(f, "Hz", "frequency", 3) for f in (bandwidth, most))
            return f"the {name} has a bandwidth of {hertz}, above {share}, a fifth of the resonance"
    return ""


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.3g}°"


def _resonance(held: Held) -> float:
    assert held.shaft is not None
    return resonance(held.train, modes(held.train)[Regime.FORWARD_BRAKING], held.shaft)[1]


def _opened(controller: Gains | Cascade, held: Held) -> Iterator[tuple[str, object]]:
    """The loops that are to hold, with their names."""
    every = modes(held.train)
    directions = {"driving": every[Regime.FORWARD_DRIVING], "braking": every[Regime.FORWARD_BRAKING]}
    for direction, mode in directions.items():
        if held.shaft is not None:
            yield f"velocity loop with a stiff shaft, {direction},", _velocity(controller, held.train, mode, None)
        yield f"velocity loop, {direction},", _velocity(controller, held.train, mode, held.shaft)
        if isinstance(controller, Cascade) and controller.position_kp and controller.position_period:
            opened = position_open_loop(held.train, mode, controller, held.shaft)
            yield f"position loop, {direction},", opened
    if held.shaft is not None and held.gap:
        alone = Mode(regime=Regime.FORWARD_DRIVING, inertia=held.train.motor_inertia, drag=held.train.friction)
        yield "velocity loop of the motor alone, in the backlash,", _velocity(controller, held.train, alone, None)


def _velocity(controller: Gains | Cascade, train: DriveTrain, mode: Mode, shaft: Shaft | None) -> object:
    if isinstance(controller, Gains):
        return voltage_open_loop(train, mode, controller, shaft)
    return velocity_open_loop(train, mode, controller, shaft)
