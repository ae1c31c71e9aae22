"""Machines without limits, for which linear theory has the answer."""

from __future__ import annotations

from dataclasses import fields, replace

import pytest
from textbook_machine import SHAFT

from drivesizer.control.drive_train import Regime
from drivesizer.control.gains import design_cascade
from drivesizer.control.validation import Rates
from drivesizer.spec.drive import Control, CurrentLoop, Feedforward, PositionLoop, VelocityLoop

ENDS = ((3.0, Regime.FORWARD_DRIVING), (-6.0, Regime.FORWARD_BRAKING))  # slope in degrees, mode

RATES = Rates(4e-5, 4e-4, 1.2e-3)  # s: current, velocity, position

shafts = pytest.mark.parametrize("shaft", [False, True], ids=["rigid", "two masses"])

both_ways = pytest.mark.parametrize(("degrees", "regime"), ENDS, ids=["driving", "braking"])


def machine(train, shaft):
    return replace(train, **(SHAFT if shaft else {}))


def one_mode(run, regime):
    """All the way forward, the load driven or driving."""
    sign = 1 if regime == Regime.FORWARD_DRIVING else -1
    return run.series["motor_speed"].min() > 0.0 and (sign * run.series["gear_torque"]).min() > 0.0


def cascade_control(*, position=False, **figures):
    """The section of a cascade by figures in SI as ``current_ki``; without a loop's name it is the velocity's."""
    loops = {"current": CurrentLoop(), "velocity": VelocityLoop(), "feedforward": Feedforward()}
    if position or "position_kp" in figures:
        loops["position"] = PositionLoop()
    for figure, value in figures.items():
        loop, _, name = figure.partition("_")
        loop, name = (loop, name) if loop in loops else ("velocity", figure)
        loops[loop] = loops[loop].model_copy(update={name: value})
    return Control().model_copy(update={"structure": "cascade", **loops})


def servo(train, shaft, **more):
    """A cascade without feedforward, that a shaft bears."""
    c, _ = design_cascade(train, RATES, cascade_control(bandwidth=5.0 if shaft else 30.0, position=True))
    fed = {f"feedforward_{name}": 0.0 for name in ("velocity", "friction", "acceleration")}
    return replace(c, velocity_kd=2e-5 if shaft else 1e-3, filter_time=1e-3, **fed, **more)


def shorter(controller, n):
    """The same gains, all loops n times as often."""
    names = [f.name for f in fields(controller) if f.name.endswith("period")]
    return replace(controller, **{name: getattr(controller, name) / n for name in names})
