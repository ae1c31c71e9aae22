r"""Limits of a drive at the driven shaft: peak and continuous torque and speed, with the limiting part.

.. math:: T = K e\, k_t I \;\text{(motor, controller)}, \qquad T = i_b e_b\, T_g \;\text{(gearhead)}, \qquad w = w_m / K

A torque is that of the motor's magnets behind gears that drive, without friction, since every simulator subtracts
the friction of a joint by itself. K total ratio, e efficiency of gearhead and belt, b of the belt alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import inf, isfinite, isnan, nan, sqrt
from typing import NamedTuple

from drivesizer.catalog import DIRECT
from drivesizer.control.drive_train import DriveTrain
from drivesizer.physics.at_voltage import Winding, operating_point
from drivesizer.physics.thermal import current_derating, rated_ambient
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.ratings import controller_current
from drivesizer.spec.altitude import rise_left
from drivesizer.spec.robot import RobotSpec

__all__ = ["Limit", "Limits", "behind_gearhead", "least", "limits", "speed_at"]


class Limit(NamedTuple):
    """The least of several limits."""

    value: float  # SI; NaN where none is known
    by: str  # the limiting part and figure
    unknown: tuple[str, ...]  # limits that are not in the catalogue


class Limits(NamedTuple):
    """Limits of one drive at its driven shaft."""

    peak_torque: Limit  # N*m
    continuous_torque: Limit  # N*m
    peak_speed: Limit  # rad/s
    continuous_speed: Limit  # rad/s


def limits(spec: RobotSpec, found: DriveSet, train: DriveTrain, voltage: float) -> Limits:
    """Peak and continuous torque and speed at the driven shaft.

    Parameters
    ----------
    spec, found, train
        The machine, the drive, and the drive train of both.
    voltage
        Available to the motor [V].

    Returns
    -------
    Limits
        SI.
    """
    per_ampere = train.torque_constant * train.ratio * train.efficiency
    currents = _peak_currents(found, train, voltage), _continuous_currents(spec, found)
    torques = ({name: current * per_ampere for name, current in of.items()} for of in currents)
    peak, continuous = (own | more for own, more in zip(torques, behind_gearhead(found, train), strict=True))
    fastest = _speeds(found, train, voltage)
    continuous_speeds = fastest | {"gearhead, continuous input speed": found.gearhead.continuous_input_speed}
    return Limits(
        least(peak),
        least(continuous),
        *(least({n: w / train.ratio for n, w in of.items()}) for of in (fastest, continuous_speeds)),
    )


def _peak_currents(found: DriveSet, train: DriveTrain, voltage: float) -> dict[str, float]:
    controller, motor = found.controller, found.motor
    named = {
        "motor at stall": voltage / train.resistance,
        "controller, peak current": controller.peak_current if controller else nan,
    }
    if isfinite(motor.peak_torque):  # most makers limit none
        named["motor, peak torque"] = motor.peak_torque / train.torque_constant
    return named


def _continuous_currents(spec: RobotSpec, found: DriveSet) -> dict[str, float]:
    controller, motor = found.controller, found.motor
    rated = rated_ambient(motor)
    derating = float(current_derating(spec.environment.ambient, motor.max_winding_temperature, rated))
    left = rise_left(spec.environment)
    derating *= sqrt(left)
    lasting = float(controller_current(controller, spec.environment.ambient)) if controller else nan
    return {
        "motor, nominal current": motor.nominal_current * derating,
        "controller, continuous current": lasting * left,
    }


def speed_at(train: DriveTrain, voltage: float, torque: float) -> float:
    """Steady speed of the motor at a voltage, winding at 25 degC, under a torque, friction included [rad/s].

    Parameters
    ----------
    train
        The drive train.
    voltage
        At the motor [V].
    torque
        At the motor, friction included [N*m].
    """
    winding = Winding(train.resistance, train.inductance, train.torque_constant, train.back_emf_constant)
    return float(operating_point(winding, voltage, torque, train.viscous)[0])


def _speeds(found: DriveSet, train: DriveTrain, voltage: float) -> dict[str, float]:
    """Highest speeds of the motor [rad/s]; that at no load includes the gears' idle friction."""
    motor, controller = found.motor, found.controller
    named = {
        "motor at no load": speed_at(train, voltage, train.friction),
        "motor, permissible speed": motor.max_speed,
        "gearhead, intermittent input speed": found.gearhead.intermittent_input_speed,
        "encoder, permissible speed": found.encoder.max_speed if found.encoder else nan,
    }
    if found.brake and not isnan(found.brake.max_speed):
        turns = found.total_ratio if found.brake.shaft == "load" else 1.0
        named["brake, permissible speed"] = found.brake.max_speed * turns
    if motor.kind == "brushless":
        named["controller, electrical speed"] = controller.max_speed_sine / motor.pole_pairs if controller else nan
    return named


def behind_gearhead(found: DriveSet, train: DriveTrain) -> tuple[dict[str, float], dict[str, float]]:
    """Torque of the gearhead at the driven shaft, for a short time and continuous [N*m]; none without one.

    Parameters
    ----------
    found, train
        The drive, and its drive train.

    Returns
    -------
    tuple of dict
        By name.
    """
    if found.gearhead.part == DIRECT:
        return {}, {}
    behind = train.belt_ratio * train.belt_efficiency
    return (
        {"gearhead, intermittent torque": found.gearhead.intermittent_torque * behind},
        {"gearhead, continuous torque": found.gearhead.continuous_torque * behind},
    )


def least(named: Mapping[str, float]) -> Limit:
    """The least of some limits, by name; NaN where none is known."""
    known = {name: value for name, value in named.items() if value == value and value < inf}
    unknown = tuple(name for name, value in named.items() if value != value)
    by = min(known, key=lambda name: known[name], default="")
    return Limit(known.get(by, nan), by, unknown)
