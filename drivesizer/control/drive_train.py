"""The plant of the closed loop: motor, gearhead, belt and one motor's share of the load.

Rigid, it is linear between the reversals of speed and of power, with five linear modes: at rest, and driving or braking
in either direction. The paper's speed reserve, bearing and oversize factors are no physics and are not included.

Convention: forward is positive at the motor, the shaft and the load; torque at the shaft is positive when it resists
forward motion. Symbols: i current [A], w motor speed [rad/s], u voltage [V], K total ratio [1].
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from enum import IntEnum
from math import inf, isfinite, isnan

import numpy as np

from drivesizer.errors import InputError, NoLoopError
from drivesizer.load_cases.at_shaft import AtShaft, at_shaft
from drivesizer.loads.course import Profile
from drivesizer.physics.drive_train import through_gears
from drivesizer.physics.thermal import resistance_25
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.ratings import unstated_temperature
from drivesizer.spec.robot import RobotSpec

__all__ = ["DriveTrain", "Mode", "Regime", "drive_train", "elastic", "matrices", "modes", "require", "within_reach"]

_NO_INDUCTANCE = 1e-3  # electrical time constant in control periods, where the inductance is unknown: none to speak of
_FASTEST = 1e9  # rad/s at the motor: beyond any machine, and small enough that squares stay finite
_NEEDED = {"motor": ("resistance", "torque_constant", "rotor_inertia"), "gearhead": ("ratio", "efficiency")}


class Regime(IntEnum):
    """The linear modes of a rigid drive train, by direction of motion and of power."""

    AT_REST = 0
    FORWARD_DRIVING = 1
    FORWARD_BRAKING = 2
    BACKWARD_DRIVING = 3
    BACKWARD_BRAKING = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveTrain:
    """One motor, its gears and its share of the load, SI; rigid unless a stiffness is given.

    Stiffness, damping and backlash are those of the driven shaft, behind the gears; seen at the motor shaft a
    stiffness is smaller by K^2.
    """

    resistance: float  # ohm, winding at 25 degC
    inductance: float  # H
    torque_constant: float  # N*m/A
    back_emf_constant: float  # V*s/rad
    friction: float = 0.0  # N*m at the motor, Coulomb: the motor's and the idle gearhead's
    stiction: float = 0.0  # N*m at the motor, at rest; the Coulomb friction where that is larger
    viscous: float = 0.0  # N*m*s/rad at the motor
    motor_inertia: float  # kg*m^2 at the motor shaft: rotor, encoder, gearhead input
    gear_ratio: float
    gear_efficiency: float  # in either direction of power
    belt_ratio: float = 1.0
    belt_efficiency: float = 1.0
    load_inertia: float  # kg*m^2 at the driven shaft
    load_viscous: float = 0.0  # N*m*s/rad at the driven shaft
    radius: float = 1.0  # m, travel of the load per angle of the driven shaft; 1 where it turns with it
    forward_torque: float = 0.0  # N*m at the driven shaft, resistance when the load moves forward
    backward_torque: float = 0.0  # N*m at the driven shaft, the same when it moves backward
    rest_torque: float = 0.0  # N*m at the driven shaft, weight alone
    stiffness: float = inf  # N*m/rad of the driven shaft; infinite: rigid
    damping: float = 0.0  # N*m*s/rad of the driven shaft
    gap: float = 0.0  # rad of backlash at the driven shaft, from contact to contact

    @property
    def load(self) -> AtShaft:
        """The load at the driven shaft, as it was taken."""
        torques = self.forward_torque, self.backward_torque, self.rest_torque
        return AtShaft(self.load_inertia, self.radius, *torques)

    @property
    def ratio(self) -> float:
        """Total ratio K, motor turns per turn of the driven shaft."""
        return self.gear_ratio * self.belt_ratio

    @property
    def efficiency(self) -> float:
        """Efficiency of gearhead and belt together."""
        return self.gear_efficiency * self.belt_efficiency

    @property
    def motor_per_speed(self) -> float:
        """Motor speed per speed of the load, K/r [rad/m, or 1]."""
        return self.ratio / self.radius

    @property
    def flexible(self) -> bool:
        """Whether motor and load are two masses on an elastic shaft."""
        return self.stiffness < inf


@dataclass(frozen=True, slots=True, kw_only=True)
class Mode:
    """A regime in numbers: J dw/dt = k_t i - b w - drag."""

    regime: Regime
    inertia: float  # kg*m^2 at the motor, infinite at rest
    drag: float  # N*m at the motor: friction and resistance


def modes(train: DriveTrain) -> tuple[Mode, ...]:
    """The five modes of a rigid drive train in the order of :class:`Regime`; at rest, friction balances the motor."""
    at_rest = Mode(regime=Regime.AT_REST, inertia=inf, drag=0.0)
    return (at_rest, *(_moving(train, regime) for regime in list(Regime)[1:]))


def _moving(train: DriveTrain, regime: Regime) -> Mode:
    forward = regime in (Regime.FORWARD_DRIVING, Regime.FORWARD_BRAKING)
    driving = regime in (Regime.FORWARD_DRIVING, Regime.BACKWARD_DRIVING)
    resistance = train.forward_torque if forward else train.backward_torque
    to_load, back = through_gears(train.ratio, train.efficiency)
    share = to_load if driving else back
    inertia = train.motor_inertia + train.load_inertia * share / train.ratio
    drag = (train.friction if forward else -train.friction) + resistance * share
    return Mode(regime=regime, inertia=inertia, drag=drag)


def matrices(train: DriveTrain, mode: Mode) -> tuple[np.ndarray, np.ndarray]:
    """State matrices of a mode: states current and motor speed, input voltage."""
    R, L, J = train.resistance, train.inductance, mode.inertia
    A = [[-R / L, -train.back_emf_constant / L], [train.torque_constant / J, -train.viscous / J]]
    return np.array(A), np.array([[1 / L], [0.0]])


def drive_train(spec: RobotSpec, drive_set: DriveParts, period: float) -> tuple[DriveTrain, list[str]]:
    """The rigid drive train of a spec and a drive, with the assumptions made."""
    if drive_set.steps:
        part = drive_set.motor.part
        raise NoLoopError(f"motor {part} is a stepper, which runs open-loop: it has no closed loop")
    require(drive_set, _NEEDED, "no closed loop without")
    said = list(unstated_temperature([drive_set.motor.part] if isnan(drive_set.motor.data_temperature) else []))
    own, shaft = drive_set.at_motor, at_shaft(spec)
    said += [_taken_as_0(f"inertia of the {of}") for of in drive_set.unknown_inertias]
    train = DriveTrain(
        resistance=float(resistance_25(drive_set.motor)),
        inductance=drive_set.motor.inductance,
        torque_constant=own.k_t,
        back_emf_constant=own.k_e,
        friction=_figure_or_zero(own.coulomb, "friction of the motor", said) + own.idle,
        viscous=_figure_or_zero(own.viscous, "viscous friction of the motor", said),
        motor_inertia=drive_set.inertia(unknown=0.0),
        gear_ratio=own.ratio,
        gear_efficiency=own.efficiency,
        belt_ratio=drive_set.belt_ratio,
        belt_efficiency=drive_set.belt_efficiency,
        load_inertia=_figure_or_zero(shaft.inertia, "inertia of the load", said),
        radius=shaft.radius,
        forward_torque=shaft.forward_torque,
        backward_torque=shaft.backward_torque,
        rest_torque=shaft.rest_torque,
    )
    if not train.inductance > 0.0:  # NaN too
        said.append("the motor's inductance is unknown: the current follows the voltage at once")
        train = replace(train, inductance=_NO_INDUCTANCE * period * train.resistance)
    if not all(isfinite(getattr(train, f.name)) for f in fields(train) if f.name != "stiffness"):
        raise InputError("the load's figures leave the range of numbers that can be computed with")
    return train, said


def elastic(train: DriveTrain, stiffness: float, damping: float = 0.0, gap: float = 0.0) -> DriveTrain:
    """A drive train with an elastic shaft between motor and load."""
    if not 0.0 < stiffness < inf:
        raise InputError(f"stiffness: {stiffness:g} N*m/rad is no stiffness; expected a positive number")
    if not 0.0 <= damping < inf:
        raise InputError(f"damping of the shaft: {damping:g} N*m*s/rad is none; expected 0 or more")
    return replace(train, stiffness=stiffness, damping=damping, gap=gap)


def within_reach(train: DriveTrain, profile: Profile) -> None:
    """Refuse a profile that is faster than any machine."""
    if not profile.top_speed * train.motor_per_speed <= _FASTEST:
        at_motor = profile.top_speed * train.motor_per_speed
        raise InputError(f"profile {profile.name}: {at_motor:.3g} rad/s is no speed that a motor can be turned to")


def _figure_or_zero(value: float, what: str, said: list[str]) -> float:
    """A figure of small influence; 0, reported as an assumption, where the catalogue lacks it."""
    if isnan(value):
        said.append(_taken_as_0(what))
        return 0.0
    return value


def _taken_as_0(what: str) -> str:
    return f"the {what} is unknown and taken as 0"


def require(drive_set: DriveParts, needed: Mapping[str, Sequence[str]], consequence: str) -> None:
    """Refuse a drive without figures that nothing can be simulated without."""
    for name, figures in needed.items():
        part = getattr(drive_set, name)
        missing = [figure.replace("_", " ") for figure in figures if not part[figure] > 0.0]
        if missing:
            raise NoLoopError(f"{name} {part.part}: {', '.join(missing)} not in the catalogue; {consequence}")
