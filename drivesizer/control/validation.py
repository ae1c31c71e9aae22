"""The record of a closed-loop simulation: gains, checks, figures, loops."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.cascade import Cascade, ControllerGain
from drivesizer.control.loop_records import Loop
from drivesizer.results.check import Check, Figure, Status
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.robot import RobotSpec

__all__ = ["Gains", "Validation"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Gains:
    """A velocity controller's gains and where they come from."""

    kp: float  # V per rad/s at the motor
    ki: float  # V per rad
    kd: float  # V per rad/s^2
    filter_time: float  # s, of the derivative
    period: float  # s, at which the controller runs
    counted_over: int = 0  # periods, over which counts are taken for a speed; 0: it is measured exactly
    rule: str  # "given in the spec", or the design rule's name
    source: str  # the rule's citation


@dataclass(frozen=True, slots=True, kw_only=True)
class Validation:
    """A drive simulated along a profile in closed loop."""

    spec: RobotSpec
    drive_set: DriveSet
    case: str = ""  # the load case that was simulated, where there are several
    profile: str
    status: Status  # verdict of the checks
    checks: tuple[Check, ...]  # with the time of the worst moment
    figures: tuple[Figure, ...]  # tracking error, bandwidth, margins of stability ...
    gains: Gains | Cascade
    series: dict[str, NDArray[np.float64]]  # SI columns over time, "time" first
    series_units: dict[str, tuple[str, str]]  # per column: kind and unit of the trade
    assumptions: tuple[str, ...]
    warnings: tuple[str, ...]
    controller_gains: tuple[ControllerGain, ...] = ()  # the same in the controller's own units, where known
    loops: tuple[Loop, ...] = ()  # linear analysis of each, from the inside out

    @property
    def over(self) -> str:
        """Name of the profile, with the load case where there are several and the profile does not name it."""
        return f"{self.profile}, {self.case}" if self.case and self.case not in self.profile else self.profile
