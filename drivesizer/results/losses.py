"""Assumptions of the losses of a controller, as sentences."""

from __future__ import annotations

from collections.abc import Iterator
from math import isnan

from drivesizer.catalog import Controller
from drivesizer.physics.power_stage import ASSUMED_BAND, ASSUMED_LOSS
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

__all__ = ["loss_assumptions", "voltage_assumption"]


def loss_assumptions(spec: RobotSpec, controller: Controller | None) -> Iterator[str]:
    """Assumptions of the losses between supply and motor."""
    bought, stage = controller or Controller(), spec.feed_of(controller).stage
    if stage.assumed:
        loss = show(ASSUMED_LOSS, "V", "voltage")
        yield f"controllers lose {loss} times the motor's current, assumed: neither drop nor efficiency is printed"
    elif bought.inside and not stage.loss:
        yield "losses of the controller inside are in the printed figures of what it is inside of"
    elif not stage.loss and spec.power_stage.voltage_drop is None:
        yield "losses of the controllers not counted: neither drop nor efficiency is printed"
    if spec.power_stage.standby is None and isnan(bought.standby_current):
        yield "standby power of the controllers not counted: it is not printed"


def voltage_assumption(spec: RobotSpec, controller: Controller | None, limit: float) -> str:
    """Assumption behind the usable voltage of a controller that does not print what it takes of the supply's."""
    feed = spec.feed_of(controller)
    if isnan(limit) or not isnan(feed.usable):
        return ""
    if isnan(feed.stage.max_duty):
        return "the controller's largest duty is not printed: the supply's voltage is the bound"
    least, most = (show(drop, "V", "voltage") for drop in ASSUMED_BAND)
    return f"the controller's voltage drop is not printed: {least} to {most} assumed"
