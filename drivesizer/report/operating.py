"""The operating points of the paper's cycle in the motor's torque-speed field."""

from __future__ import annotations

from dataclasses import dataclass

from drivesizer import equations as eq
from drivesizer.results import DriveSet, Requirement

__all__ = ["OperatingField", "OperatingPoint", "operating_field"]


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingPoint:
    """A moment of the cycle at the motor shaft."""

    name: str
    torque: float  # N*m
    speed: float  # rad/s


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingField:
    """What the motor can do at its nominal voltage, and what the cycle asks of it."""

    voltage: float  # V
    no_load_speed: float  # rad/s
    stall_torque: float  # N*m
    nominal_torque: float  # N*m, NaN when unknown
    points: tuple[OperatingPoint, ...]


def operating_field(drive_set: DriveSet, requirements: tuple[Requirement, ...]) -> OperatingField:
    """The field of a set's motor with the paper's operating points, every torque brought to the motor as in (18).

    Parameters
    ----------
    drive_set
        The set.
    requirements
        The paper's (1)-(16).
    """
    of = {r.name: float(r.value) for r in requirements}
    wheels = of["maximum_torque"] / of["maximum_torque_per_motor"]
    torques = {
        "end of acceleration": (of["maximum_torque_per_motor"], of["nominal_speed"]),
        "cruise": (of["nominal_torque_per_motor"], of["nominal_speed"]),
        "start of deceleration": (of["deceleration_torque"] / wheels, of["nominal_speed"]),
        "RMS of the cycle": (of["rms_torque_per_motor"], of["rms_speed"]),
    }
    chain = {"K_g": drive_set.gearhead.ratio, "eta_gear": drive_set.gearhead.efficiency,
             "i_b": drive_set.belt_ratio, "eta_b": drive_set.belt_efficiency}  # fmt: skip
    motor = drive_set.motor
    return OperatingField(
        voltage=motor.nominal_voltage,
        no_load_speed=motor.no_load_speed,
        stall_torque=motor.stall_torque,
        nominal_torque=motor.nominal_torque,
        points=tuple(
            OperatingPoint(
                name=name,
                torque=float(eq.maximum_torque_at_motor(torque, **chain)),
                speed=speed * drive_set.total_ratio,
            )
            for name, (torque, speed) in torques.items()
        ),
    )
