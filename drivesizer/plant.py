"""One motor set and its share of the vehicle as a machine in motion: what the closed loop drives.

A rigid chain from the rotor to the robot: DC motor, gearhead, belt, wheel. Between the reversals of speed and of
power it is linear, so it is a handful of linear modes: standing, and driving or braking in either direction.
Physical kinematics: the wheel turns at v/r; the paper's speed reserve and oversize factor are no physics.

Convention: forward is positive at the motor, the wheel and the robot; torque at the wheel is positive when the
load asks to be driven forward. Symbols: i current [A], w motor speed [rad/s], u voltage [V], K whole reduction [1].
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields, replace
from enum import IntEnum
from math import inf, isfinite, isnan
from typing import Any

import numpy as np

from drivesizer import equations as eq
from drivesizer.errors import InputError
from drivesizer.loads.wheeled_vehicle import rolling_resistance, turning_inertia
from drivesizer.machines import WheeledVehicle
from drivesizer.physics import gear_loss
from drivesizer.profile import Profile
from drivesizer.results import DriveSet
from drivesizer.spec import RobotSpec

__all__ = ["DriveTrain", "Mode", "Regime", "drive_train", "modes", "within_reach"]

_NO_INDUCTANCE = 1e-3  # electrical time constant in control periods, where the inductance is unknown: none to speak of
_FASTEST = 1e9  # rad/s at the motor: beyond any machine, and small enough that squares stay finite
_NEEDED = {
    "motor": ("resistance", "torque_constant", "rotor_inertia"),
    "gearhead": ("ratio", "efficiency"),
}


class Regime(IntEnum):
    """The linear modes, by what the motor set is doing."""

    STANDING = 0
    FORWARD_DRIVING = 1
    FORWARD_BRAKING = 2
    BACKWARD_DRIVING = 3
    BACKWARD_BRAKING = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveTrain:
    """A motor set and what hangs on it; SI."""

    resistance: float  # ohm
    inductance: float  # H
    torque_constant: float  # N*m/A, equal to V*s/rad
    friction: float  # N*m at the motor, against the motion: the motor's and the idle gearhead's
    motor_inertia: float  # kg*m^2 at the motor shaft: rotor, encoder, gearhead input
    gear_ratio: float
    gear_efficiency: float
    belt_ratio: float
    belt_efficiency: float
    turning_inertia: float  # kg*m^2 at the wheel: wheel and shaft
    mass: float  # kg, the vehicle's share
    radius: float  # m, of the wheel
    forward_torque: float  # N*m at the wheel, resistance when the robot moves forward
    backward_torque: float  # N*m at the wheel, the same when it moves backward
    slope_torque: float  # N*m at the wheel, weight alone

    @property
    def ratio(self) -> float:
        """Whole reduction K, motor turns per turn of the wheel."""
        return self.gear_ratio * self.belt_ratio

    @property
    def efficiency(self) -> float:
        """Efficiency of gearhead and belt together."""
        return self.gear_efficiency * self.belt_efficiency

    @property
    def load_inertia(self) -> float:
        """Inertia at the wheel, the vehicle's share of mass included [kg*m^2]."""
        return self.turning_inertia + self.mass * self.radius**2

    @property
    def motor_per_speed(self) -> float:
        """Motor speed per speed of the robot, K/r [rad/m]."""
        return self.ratio / self.radius


@dataclass(frozen=True, slots=True, kw_only=True)
class Mode:
    """A regime in numbers: J dw/dt = k_t i - drag, and what is affine in the current."""

    regime: Regime
    inertia: float  # kg*m^2 at the motor, infinite when standing
    drag: float  # N*m at the motor: friction and resistance
    wheel_torque: tuple[float, float]  # N*m, and N*m/A: at the wheel
    gear_torque: tuple[float, float]  # N*m, and N*m/A: at the gearhead's output
    acceleration: tuple[float, float]  # m/s^2, and m/s^2/A: of the robot
    resistance_force: float  # N, of the vehicle's share: rolling and weight


def modes(train: DriveTrain) -> tuple[Mode, ...]:
    """The five modes of a drive train, in the order of :class:`Regime`."""
    return (_standing(train), *(_moving(train, regime) for regime in list(Regime)[1:]))


def _standing(train: DriveTrain) -> Mode:
    """At rest friction takes up what the motor does not: the gear holds the weight, ideally."""
    return Mode(
        regime=Regime.STANDING,
        inertia=inf,
        drag=0.0,
        wheel_torque=(train.slope_torque, 0.0),
        gear_torque=(train.slope_torque / train.belt_ratio, 0.0),
        acceleration=(0.0, 0.0),
        resistance_force=train.slope_torque / train.radius,
    )


def _moving(train: DriveTrain, regime: Regime) -> Mode:
    forward = regime in (Regime.FORWARD_DRIVING, Regime.FORWARD_BRAKING)
    driving = regime in (Regime.FORWARD_DRIVING, Regime.BACKWARD_DRIVING)
    resistance = train.forward_torque if forward else train.backward_torque
    # T_in = T_out/(i e) where power goes to the load, T_out e/i where it comes back (Giberti et al. 2010)
    share = (1.0 / train.efficiency if driving else train.efficiency) / train.ratio
    at_gearhead = (1.0 / train.belt_efficiency if driving else train.belt_efficiency) / train.belt_ratio
    inertia = train.motor_inertia + train.load_inertia * share / train.ratio
    drag = (train.friction if forward else -train.friction) + resistance * share
    turn = -drag / inertia, train.torque_constant / inertia  # rad/s^2 at the motor, and per ampere
    wheel = (
        resistance + train.load_inertia / train.ratio * turn[0],
        train.load_inertia / train.ratio * turn[1],
    )
    return Mode(
        regime=regime,
        inertia=inertia,
        drag=drag,
        wheel_torque=wheel,
        gear_torque=(wheel[0] * at_gearhead, wheel[1] * at_gearhead),
        acceleration=(turn[0] / train.motor_per_speed, turn[1] / train.motor_per_speed),
        resistance_force=resistance / train.radius,
    )


def drive_train(spec: RobotSpec, drive_set: DriveSet, period: float) -> tuple[DriveTrain, list[str]]:
    """The machine that a spec and a drive set make, and what had to be assumed.

    Parameters
    ----------
    spec, drive_set
        The robot, and the parts that drive each of its wheels.
    period
        Control period [s].

    Raises
    ------
    InputError
        When the catalogue lacks a figure without which nothing moves.
    """
    for name, needed in _NEEDED.items():
        part = getattr(drive_set, name)
        missing = [figure.replace("_", " ") for figure in needed if not getattr(part, figure) > 0.0]
        if missing:
            raise InputError(
                f"{name} {part.part}: {', '.join(missing)} not in the catalogue; the validation needs them"
            )
    said: list[str] = []
    assert isinstance(spec.load, WheeledVehicle)  # nothing else is validated
    motor, gearhead, load = drive_set.motor, drive_set.gearhead, spec.load
    encoder = drive_set.encoder.inertia if drive_set.encoder else 0.0
    gear_efficiency, idle = gear_loss(asdict(gearhead))
    train = DriveTrain(
        resistance=motor.resistance,
        inductance=motor.inductance,
        torque_constant=motor.torque_constant,
        friction=motor.torque_constant * _known(motor.no_load_current, "no-load current of the motor", said)
        + float(idle),
        motor_inertia=motor.rotor_inertia
        + _known(gearhead.inertia, "inertia of the gearhead", said)
        + _known(encoder, "inertia of the encoder", said),
        gear_ratio=gearhead.ratio,
        gear_efficiency=float(gear_efficiency),
        belt_ratio=drive_set.belt_ratio,
        belt_efficiency=drive_set.belt_efficiency,
        mass=load.mass / load.driven_wheels,
        radius=load.wheel_diameter / 2,
        **_at_the_wheel(spec),
    )
    if not train.inductance > 0.0:  # NaN too
        said.append("the motor's inductance is unknown: the current follows the voltage at once")
        train = replace(train, inductance=_NO_INDUCTANCE * period * train.resistance)
    if not all(isfinite(getattr(train, f.name)) for f in fields(train)):
        raise InputError("the load's figures leave the range of numbers that can be computed with")
    return train, said


def within_reach(train: DriveTrain, profile: Profile) -> None:
    """Refuse a profile that is faster than any machine.

    Raises
    ------
    InputError
        When its top speed is beyond 1e9 rad/s at the motor.
    """
    if not profile.top_speed * train.motor_per_speed <= _FASTEST:
        raise InputError(f"profile {profile.name}: {profile.top_speed:g} m/s is no speed that a motor can be turned to")


def _known(value: float, what: str, said: list[str]) -> float:
    """A figure of small weight, 0 where the catalogue lacks it; that is told."""
    if isnan(value):
        said.append(f"the {what} is unknown and taken as 0")
        return 0.0
    return value


@np.errstate(all="ignore")  # what is out of range is refused by the caller
def _at_the_wheel(spec: RobotSpec) -> dict[str, Any]:
    """Resistances and turning inertia at one wheel, by the paper's equations (2)-(5), (8), (9)."""
    load = spec.load
    assert isinstance(load, WheeledVehicle)
    C_rr = rolling_resistance(load)
    terms = {"m_R": load.mass, "g": spec.environment.gravity, "theta": load.slope}
    weight = eq.nominal_force(C_rr=0.0, **terms)
    rolling = eq.nominal_force(C_rr=C_rr, **terms) - weight

    def torque(force: float, direction: float) -> float:
        """(2), with its bearing loss always against the motion: as printed it would push downhill."""
        bare, full = (eq.nominal_torque(load.wheel_diameter, force, d) for d in (1.0, spec.paper_factors.bearing))
        return float(eq.nominal_torque_per_motor(bare + direction * abs(full - bare), load.driven_wheels))

    return {
        "turning_inertia": turning_inertia(load),
        "forward_torque": torque(weight + rolling, +1.0),
        "backward_torque": torque(weight - rolling, -1.0),
        "slope_torque": torque(weight, 0.0),
    }
