"""Input of a simulation: a drive with its controller and limits, and the motion and load required of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from drivesizer.control.cascade import Cascade
from drivesizer.control.drive_train import DriveTrain
from drivesizer.control.engine.layout import Array
from drivesizer.control.validation import Gains
from drivesizer.physics.thermal import TwoBodies

__all__ = ["CurrentLimit", "Drive", "MotorHeat", "Resolution", "Supply", "Task"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Supply:
    """The bus that feeds a number of equal drives, and the controller's voltage range."""

    voltage: float  # V, without load
    resistance: float = 0.0  # ohm, of the source and its cables
    sets: int = 1
    max_duty: float = 1.0
    voltage_drop: float = 0.0  # V
    loss: float = 0.0  # W/A, of each power stage
    stage_resistance: float = 0.0  # ohm, of each power stage
    standby: float = 0.0  # W, of each controller
    leads: float = 0.0  # ohm, that take of the voltage at full duty (``physics.power_stage``); of its check
    raises: bool = False  # whether regenerated energy raises the bus; else a brake chopper or a battery takes it


@dataclass(frozen=True, slots=True, kw_only=True)
class CurrentLimit:
    """Peak current for its time, then the continuous one (integral of I^2 - I_cont^2); infinite: none, or not known."""

    peak: float = math.inf  # A
    continuous: float = math.inf  # A
    peak_time: float = math.inf  # s, at the peak from rest


@dataclass(frozen=True, slots=True, kw_only=True)
class Resolution:
    """Counts of the motor's angle; 0 edges: speed and angle are measured exactly."""

    edges: int = 0  # per turn of the motor
    periods: int = 1  # of the velocity loop, over which counts are taken for a speed


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorHeat:
    """Winding and housing, and where they start."""

    bodies: TwoBodies
    ambient: float  # K
    winding: float = math.nan  # K at the start; NaN: ambient
    housing: float = math.nan  # K at the start; NaN: ambient
    loss: float = 0.0  # W at the housing, always
    loss_torque: float = 0.0  # N*m at the housing: times the speed
    loss_viscous: float = 0.0  # N*m*s/rad at the housing: times the square of the speed
    brief: bool = False  # whether a period's step is one of the second order, and its derivatives follow now and then


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """One drive: drive train, controller, supply, limits."""

    train: DriveTrain
    controller: Gains | Cascade
    supply: Supply
    current: CurrentLimit = CurrentLimit()
    encoder: Resolution = Resolution()
    heat: MotorHeat | None = None  # None: the winding stays at 25 degC
    delay: bool = True  # cascade: each loop responds one of its periods late
    drain_time: float = math.inf  # s, in which the integral drains to 1/e at rest, where friction holds
    prompt: bool = False  # cascade: except the current loop, which responds at once (see ``slower_loop``)


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """Required motion and load of the driven shaft; straight lines between the corners."""

    time: Sequence[float] | Array  # s, strictly rising
    speed: Sequence[float] | Array  # rad/s of the driven shaft
    load_time: Sequence[float] | Array = ()  # s, strictly rising
    load_torque: Sequence[float] | Array = ()  # N*m, added to the drive train's own; constant beyond the corners
    since: float | None = None  # s; what comes before is simulated and not recorded; of one cycle
    cycles: int = 1  # number of repetitions; the length is then rounded up to whole samples of the slowest loop
