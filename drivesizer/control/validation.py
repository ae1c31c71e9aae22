"""The record of a simulation, in closed loop or of a stepper: gains, checks, figures, loops."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.cascade import Cascade, ControllerGain
from drivesizer.control.drive_train import DriveTrain
from drivesizer.control.loop_records import Loop
from drivesizer.results.check import Check, Figure, Status, sentence_case
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.robot import RobotSpec

__all__ = ["Gains", "LinearFigure", "LinearRun", "Remedy", "Stepping", "Validation"]


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
class Stepping:
    """Pulses of a stepper's driver, in the place of a controller's gains."""

    microsteps: float  # per full step
    pulse_rate: float  # Hz, largest
    damping_ratio: float  # of the rotor's swings
    rule: str
    source: str


class LinearFigure(NamedTuple):
    """A figure of the linear model beside that of the simulation with limits, where that one has it too."""

    linear: Figure
    engine: Figure | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearRun:
    """PID and DC motor in python-control along the same profile, beside the engine."""

    train: DriveTrain  # of the model
    figures: tuple[LinearFigure, ...]
    series: dict[str, NDArray[np.float64]]  # SI columns over time, as those of the validation; none of an unstable loop
    left_out: tuple[str, ...]  # what the linear model does without, as sentences


class Remedy(NamedTuple):
    """A change that was tried on a drive that fails in its loop, and how the loop is with it."""

    what: str
    entry: str  # of the spec, or the option, as one writes it
    status: Status
    tightest: Check | None  # the check of the smallest margin


@dataclass(frozen=True, slots=True, kw_only=True)
class Validation:
    """A drive simulated along a profile: in closed loop, or a stepper in open loop."""

    spec: RobotSpec
    drive_set: DriveSet
    case: str = ""  # the load case that was simulated, where there are several
    profile: str
    status: Status  # verdict of the checks
    checks: tuple[Check, ...]  # with the time of the worst moment
    figures: tuple[Figure, ...]  # tracking error, bandwidth, margins of stability ...
    gains: Gains | Cascade | Stepping
    series: dict[str, NDArray[np.float64]]  # SI columns over time, "time" first
    series_units: dict[str, tuple[str, str]]  # per column: kind and unit of the trade
    assumptions: tuple[str, ...]
    warnings: tuple[str, ...]
    controller_gains: tuple[ControllerGain, ...] = ()  # the same in the controller's own units, where known
    loops: tuple[Loop, ...] = ()  # linear analysis of each, from the inside out
    linear: LinearRun | None = None  # None of a stepper
    tried: tuple[Remedy, ...] = ()  # of a drive that fails

    @property
    def loop(self) -> str:
        """The kind of control in words."""
        return "open loop" if isinstance(self.gains, Stepping) else "closed loop"

    @property
    def set_up(self) -> str:
        """Settings of the controller in a word."""
        return "Pulses" if isinstance(self.gains, Stepping) else "Gains"

    @property
    def failed(self) -> str:
        """Titles of the checks that fail; empty where none does."""
        return ", ".join(sentence_case(c.title) for c in self.checks if c.status == "fail" and not c.advice)

    @property
    def over(self) -> str:
        """Name of the profile, with the load case where there are several and the profile does not name it."""
        return f"{self.profile}, {self.case}" if self.case and self.case not in self.profile else self.profile
