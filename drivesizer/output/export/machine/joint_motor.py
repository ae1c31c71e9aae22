r"""The drive of a joint in MJCF: MuJoCo's DC motor, or a servo where it is a stepper.

MuJoCo has no gear efficiency e, and a joint of a robot no load of its own that could be scaled; so the motor is, with
gears that drive: its torque constant, inertia and friction by e,

.. math:: k_t' = e\, k_t, \quad J' = e\, J_m, \quad b' = e\, b_m, \quad M_f' = e\, M_f

Then the joint gets K e M, its current, voltage and heat are the motor's own. Where the load drives the motor, its
torque T counts in the motor as f T and not as T/e, f = e but for worms: ``qfrc_applied`` is the place to correct it, by
(1 - e f) T.
"""

from __future__ import annotations

from dataclasses import replace
from math import isnan
from xml.etree.ElementTree import Element, SubElement

from drivesizer.errors import InputError
from drivesizer.output.export.common import Export
from drivesizer.output.export.gains import lacking, torque_law
from drivesizer.output.export.machine.record import JointDrive
from drivesizer.output.export.markup import brief, number
from drivesizer.output.export.mjcf import current_scale, feedforward, motor_figures

__all__ = ["add_motor", "armature", "effort", "lossless", "motor_remark"]


def lossless(drive: JointDrive) -> Export:
    """The drive seen as one without gear losses, the motor's torque, inertia and friction by the efficiency."""
    train, e = drive.of.train, drive.efficiency
    equal = replace(
        train, torque_constant=e * train.torque_constant, motor_inertia=e * train.motor_inertia,
        friction=e * train.friction, viscous=e * train.viscous, gear_ratio=drive.ratio, belt_ratio=1.0,
        gear_efficiency=1.0, belt_efficiency=1.0,
    )  # fmt: skip
    return replace(drive.of, train=equal)


def effort(drive: JointDrive) -> dict[str, str]:
    """Limit of the force at a joint or a tendon, where one is known."""
    known = drive.limits.get("effort")
    return {"actuatorfrcrange": f"-{known} {known}"} if known else {}


def armature(drive: JointDrive) -> float:
    """Inertia of a drive at its joint [kg*m^2, or kg]."""
    if isnan(drive.armature):
        raise InputError(
            f"{drive.joint}: the rotor's inertia of {drive.of.label} is not in the catalogue; expected --format urdf, "
            "which does without"
        )
    return drive.armature


def add_motor(actuator: Element, drive: JointDrive, named: dict[str, str]) -> None:
    """Add the actuator of a drive; rotor and friction are those of the joint."""
    if drive.of.stepper:
        _stepper(actuator, drive, named)
        return
    of = lossless(drive)
    figures = motor_figures(of, torque_law(of))
    SubElement(actuator, "dcmotor", named | {key: one for key, one in figures.items() if key not in _OF_JOINT})


def motor_remark(drive: JointDrive) -> str:
    """Remark on a motor with a loop: ratio, efficiency, and what its feedforward is."""
    of = lossless(drive)
    left = "".join(f" Controller: {line}." for line in lacking(of))
    ratio, e, ahead = number(drive.ratio), brief(drive.efficiency), feedforward(torque_law(of))
    scale = f"; act has {number(current_scale(of.train))} times its current"  # s of its constants, k_t by e among them
    return f"{drive.joint}: total ratio {ratio}, e = {e}; feedforward torque {ahead}{scale}.{left}"


def _stepper(actuator: Element, drive: JointDrive, named: dict[str, str]) -> None:
    """A position servo as stiff as the stepper's torque about a held position, as of one axis."""
    one, most = drive.of.stepper, drive.of.limits.peak_torque.value * drive.gear_efficiency / drive.travel
    assert one is not None
    square = drive.travel**2 / drive.gear_efficiency
    limits = {"kp": number(one.stiffness / square), "forcerange": f"-{number(most)} {number(most)}"}
    SubElement(actuator, "position", named | limits)
    damping = {"name": f"{named['name']}_damping", "kv": number(one.damping / square)}
    SubElement(actuator, "velocity", named | damping)


_OF_JOINT = ("armature", "damping")
