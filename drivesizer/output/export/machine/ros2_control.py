"""ros2_control of a machine: its URDF with one hardware block, and the YAML of a velocity controller of all joints.

Formulas and names of parameters as in ``export.ros2_control``. All controllers are designed for one rate, that of the
controller manager: the slowest of the drives' own. Steppers take positions, from a controller of trajectories.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from drivesizer.errors import InputError, quoted
from drivesizer.output.export.common import Export
from drivesizer.output.export.gains import lacking
from drivesizer.output.export.joint import limited
from drivesizer.output.export.machine.record import MachineExport
from drivesizer.output.export.machine.urdf import robot
from drivesizer.output.export.markup import document, identifier
from drivesizer.output.export.ros2_control import (
    LOOP,
    REMARKS,
    STEPS,
    TRAJECTORY,
    commented,
    hardware,
    interfaces,
    rate_of,
    rate_remarks,
    transmission,
    velocity_gains,
    velocity_loops,
)

__all__ = ["controllers", "render"]

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")  # of a joint that is a parameter's name in ROS
_WORDS = frozenset({"y", "n", "yes", "no", "on", "off", "true", "false", "null"})  # other than text in YAML


class _Joint(NamedTuple):
    """A joint as controllers see it."""

    name: str
    of: Export
    travel: float
    gear_efficiency: float
    slides: bool
    limits: dict[str, str]
    ratio: float
    motor: str


def _joints(of: MachineExport) -> list[_Joint]:
    """All joints with a drive."""
    found = []
    for drive in of.robot.drives if of.robot else ():
        if drive.coupled:
            raise InputError(
                f"{drive.joint}: its belt passes other joints, which ros2_control's simple transmission has no place "
                "for; expected --format mjcf or urdf"
            )
        figures = (drive.travel, drive.gear_efficiency, drive.slides, drive.limits, drive.ratio)
        found.append(_Joint(drive.joint, drive.of, *figures, f"{drive.joint}_motor"))
    for name, one in of.axes:
        before = identifier(name)
        found.append(_Joint(f"{before}_shaft", one, 1.0, 1.0, False, limited(one), one.train.ratio, f"{before}_motor"))
    for joint in found:
        if not _NAME.fullmatch(joint.name) or joint.name.lower() in _WORDS:
            raise InputError(
                f"joint {quoted(joint.name)}: ROS has no parameters of this name; expected letters, digits and "
                "underscores, a letter first"
            )
    return found


def render(of: MachineExport) -> bytes:
    """The URDF of a machine with its ``ros2_control`` block."""
    joints = _joints(of)
    root = robot(of)
    block = hardware(root, identifier(of.name))
    for joint in joints:
        interfaces(block, joint.name, joint.limits, STEPS if joint.of.stepper else LOOP)
    for joint in joints:
        transmission(block, joint.name, joint.ratio, joint.motor)
    return document(root)


def controllers(of: MachineExport) -> bytes:
    """The parameters of controller manager and controllers, as YAML."""
    joints = _joints(of)
    looped, steppers = [one for one in joints if not one.of.stepper], [one.name for one in joints if one.of.stepper]
    slowest = max((one.of for one in looped), key=lambda export: export.period, default=None)
    said = [f"{joint.name}: {joint.of.label}" for joint in joints]
    said += [of.program, *dict.fromkeys(line for one in looped for line in lacking(one.of))]
    if slowest:
        said += [*REMARKS, *rate_remarks(slowest)]
    if steppers:
        said.append("steppers run open-loop: they go to the commanded positions, or lose steps unseen")
    gains = {one.name: velocity_gains(one.of, one.travel, one.gear_efficiency, slides=one.slides) for one in looped}
    rate = rate_of(slowest) if slowest else TRAJECTORY
    return commented(said, velocity_loops(gains, rate, steppers))
