"""Records of controllers and of simulations: the servo cascade, loops by linear analysis, gains, checks, figures."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Controller
from drivesizer.control.drive_train import DriveTrain
from drivesizer.results.check import Check, Figure, Status, sentence_case
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

# -- The cascade of a servo controller: current PI inside, velocity PI(D) around it, position P around that.
#
# The structure of the EPOS4 class: each loop is sampled at its own rate, the faster one inside; feedforward of
# velocity and acceleration goes to the current demand. Angles and speeds are those of the motor shaft.
#
# .. [1] maxon, *EPOS4 Firmware Specification*, objects 0x30A0 to 0x30A2 (6.2.61 to 6.2.63): gains and their units.
# The document itself was not at hand: the units are those that two independent users of the controller give for it,
# and an auto-tuned controller's own figures confirm them (its acceleration feedforward is its inertia over its
# torque constant).


LEAST_PHASE_MARGIN = math.radians(30.0)  # below it a loop rings: Åström, Hägglund, PID Controllers, 1995: 30 to 60 deg
_PERIODS = 1e-4, 1e-3, 1e-3  # s: current, velocity and position loop, where the controller's are unknown
_PER_VELOCITY = 10.0  # current periods in a velocity period, where only the latter is known


@dataclass(frozen=True, slots=True, kw_only=True)
class Cascade:
    """Gains and rates of a cascade; a gain of 0 switches its path off."""

    current_kp: float  # V/A
    current_ki: float  # V/(A*s)
    velocity_kp: float  # A/(rad/s)
    velocity_ki: float  # A/rad
    velocity_kd: float = 0.0  # A/(rad/s^2)
    filter_time: float = 0.0  # s, of the derivative
    position_kp: float = 0.0  # 1/s: speed demand per position error
    feedforward_velocity: float = 0.0  # A/(rad/s): viscous friction and iron
    feedforward_friction: float = 0.0  # A, in the direction of the demand
    feedforward_acceleration: float = 0.0  # A/(rad/s^2): the inertia
    computing: int = 1  # velocity and position periods between a sample and what responds to it
    planned_speed: bool = True  # goes to the velocity loop beside the position loop's demand
    current_period: float  # s
    velocity_period: float  # s, a whole multiple of the current loop's
    position_period: float = 0.0  # s, a whole multiple of the velocity loop's; 0: no position loop
    counted_over: int = 0  # velocity periods, over which counts are taken for a speed; 0: it is measured exactly
    rule: str = ""  # how the gains came about
    source: str = ""

    @property
    def current_steps(self) -> int:
        """Periods of the current loop in one of the velocity loop."""
        return round(self.velocity_period / self.current_period)

    @property
    def velocity_steps(self) -> int:
        """Periods of the velocity loop in one of the position loop; 0 without a position loop."""
        return round(self.position_period / self.velocity_period) if self.position_kp else 0


class Rates(NamedTuple):
    """Periods of the three loops [s], each a whole multiple of the one before."""

    current: float
    velocity: float
    position: float


def rates(controller: Controller | None, velocity_rate: float | None = None) -> tuple[Rates, list[str]]:
    """The periods of a controller's loops, and the assumptions where the catalogue has none.

    Velocity and position periods are rounded to whole multiples of the loop inside; a period that this changes is
    reported.
    """
    named = {"current": "current_loop", "velocity": "speed_loop", "position": "position_loop"}
    rate = {name: getattr(controller, figure) if controller else math.nan for name, figure in named.items()}
    if velocity_rate:
        position = min(rate["position"], velocity_rate) if rate["position"] > 0.0 else velocity_rate
        rate |= {"velocity": velocity_rate, "position": position}
    known = {name: 1.0 / f if f > 0.0 else math.nan for name, f in rate.items()}
    inner, middle, outer = known.values()
    if not inner > 0.0:
        inner = middle / _PER_VELOCITY if middle > 0.0 else _PERIODS[0]
    if not middle > 0.0:
        middle = max(_PERIODS[1], inner)
    if not outer > 0.0:
        outer = max(_PERIODS[2], middle)
    velocity = inner * max(1, round(middle / inner))
    periods = Rates(inner, velocity, velocity * max(1, round(outer / velocity)))
    assumptions = []
    for name, period in periods._asdict().items():
        runs = f"runs every {show(period, 'us', 'time', 4)}"
        if math.isnan(known[name]):
            assumptions.append(f"the rate of the controller's {name} loop is unknown: it {runs}")
        elif not math.isclose(period, known[name], rel_tol=1e-9):
            assumptions.append(f"the {name} loop {runs}, a whole multiple of the loop inside")
    return periods, assumptions


@dataclass(frozen=True, slots=True, kw_only=True)
class ControllerGain:
    """A gain as it is written into the controller."""

    place: str  # index and subindex of the object
    name: str
    value: float  # a whole number where the controller takes no other
    unit: str


# -- Records of the linear analysis of a closed loop; NaN where a figure does not exist.


@dataclass(frozen=True, slots=True, kw_only=True)
class Bode:
    """Frequency response of a loop."""

    frequency: NDArray[np.float64]  # Hz
    open_magnitude: NDArray[np.float64]
    open_phase: NDArray[np.float64]  # rad
    closed_magnitude: NDArray[np.float64]
    closed_phase: NDArray[np.float64]  # rad


@dataclass(frozen=True, slots=True, kw_only=True)
class Loop:
    """A linear, sampled loop without its limits; an unstable one has no margins."""

    name: str
    direction: str  # of power: the one nearer to instability; "" where it has no influence
    period: float  # s
    stable: bool
    pole_radius: float  # largest modulus of the closed loop's poles; below 1 is stable
    poles: tuple[complex, ...]  # z plane
    gain_margin: float = math.nan  # factor
    gain_reduction: float = math.nan  # factor below 1 down to which the gain may be reduced; NaN: to any
    phase_margin: float = math.nan  # rad
    crossover: float = math.nan  # Hz, where the phase margin of this direction is
    sensitivity: float  # largest |1/(1 + L)|, the reciprocal of the distance to -1 [1]
    bandwidth: float = math.nan  # Hz, -3 dB of the response to the reference
    rise_time: float = math.nan  # s, 10-90 %
    overshoot: float = math.nan  # share of the step
    settling_time: float = math.nan  # s, to 2 %
    step: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))  # sampled; empty where it is unstable
    bode: Bode


@dataclass(frozen=True, slots=True, kw_only=True)
class Loops:
    """The loops of a controller, and the frequencies of an elastic shaft."""

    current: Loop | None = None  # None: the velocity loop acts on the voltage
    velocity: Loop
    position: Loop | None = None
    resonance: float = math.nan  # Hz
    anti_resonance: float = math.nan  # Hz
    rigid_bandwidth: float = math.nan  # Hz, that the velocity loop would have with a stiff shaft

    @property
    def all(self) -> tuple[Loop, ...]:
        """The loops that exist, from the inside out."""
        return tuple(loop for loop in (self.current, self.velocity, self.position) if loop is not None)


# -- The record of a simulation, in closed loop or of a stepper: gains, checks, figures, loops.


@dataclass(frozen=True, slots=True, kw_only=True)
class Gains:
    """A velocity controller's gains and where they come from."""

    kp: float  # V per rad/s at the motor
    ki: float  # V per rad
    kd: float  # V per rad/s^2
    filter_time: float  # s, of the derivative
    period: float  # s, at which the controller runs
    counted_over: int = 0  # periods, over which counts are taken for a speed; 0: it is measured exactly
    feedforward_velocity: float = 0.0  # V/(rad/s): back-EMF and viscous friction
    feedforward_friction: float = 0.0  # V, in the direction of the demand
    feedforward_acceleration: float = 0.0  # V/(rad/s^2): the inertia
    rule: str  # "given in the spec", or the design rule's name
    source: str  # the rule's citation

    # by the names of a cascade's: it is the one loop, with none inside and none around it
    current_steps, velocity_steps = 1, 0

    @property
    def velocity_period(self) -> float:
        """Its period [s]."""
        return self.period


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
