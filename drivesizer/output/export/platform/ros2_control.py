"""ros2_control of a platform: its URDF with one hardware block, and the YAML of a controller of the base.

The controller of the base (``base_controller``) takes the platform's velocity and commands that of the wheels: the
references of one velocity controller of all wheels, on effort, with the designed gains as in ``export.ros2_control``.
A stepper has no loop: its joint takes velocities, from the controller of the base itself.
"""

from __future__ import annotations

from drivesizer.output.export.gains import lacking
from drivesizer.output.export.machine.record import JointDrive
from drivesizer.output.export.markup import document, identifier
from drivesizer.output.export.platform.base_controller import NAME, BaseController, base_controller, parameters_text
from drivesizer.output.export.platform.record import PlatformExport, wheel_name
from drivesizer.output.export.platform.urdf import robot
from drivesizer.output.export.ros2_control import (
    CONTROLLER,
    LOOP,
    REMARKS,
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

_VELOCITY = ("velocity",)


def render(of: PlatformExport) -> bytes:
    """The URDF of a platform with its ``ros2_control`` block."""
    found = _base(of)
    direction = found.direction if found else 1.0
    root = robot(of, direction)
    block = hardware(root, identifier(of.name))
    for drive in of.drives.values():
        interfaces(block, drive.joint, drive.limits, _VELOCITY if drive.of.stepper else LOOP)
    for place, drive in of.drives.items():
        transmission(block, drive.joint, direction * drive.ratio, f"{wheel_name(place)}_motor")
    return document(root)


def _base(of: PlatformExport) -> BaseController | None:
    """The controller of the base; of wheels with a loop it commands their velocity controller."""
    return base_controller(of, "" if of.of.stepper else f"{CONTROLLER}/")


def controllers(of: PlatformExport) -> bytes:
    """The parameters of controller manager and controllers, as YAML."""
    found = _base(of)
    gains = {} if of.of.stepper else {drive.joint: velocity_gains(of.of) for drive in of.drives.values()}
    rate = TRAJECTORY if of.of.stepper else rate_of(of.of)
    body = velocity_loops(gains, rate, more={NAME: found.kind} if found else None)
    if found:
        body += f"\n{NAME}:\n  ros__parameters:\n{parameters_text(found.parameters)}"
    return commented([*_drives(of), *([*_base_remarks(of), *found.said] if found else [_NO_BASE])], body)


def _drives(of: PlatformExport) -> list[str]:
    """Remarks on drives and their loops."""
    one: JointDrive = next(iter(of.drives.values()))
    said = [f"{', '.join(drive.joint for drive in of.drives.values())}: {one.of.label}", one.of.program]
    if of.of.stepper:
        return [*said, "steppers run open-loop: they go at the commanded velocities, or lose steps unseen"]
    return [*said, *lacking(of.of), *REMARKS, *rate_remarks(of.of)]


def _base_remarks(of: PlatformExport) -> list[str]:
    """Remarks on the controller of the base."""
    reached = "the highest speed of the motion" if of.of.stepper else "what the drives reach on the lowest voltage"
    said = [
        f"velocity limits are {reached}, or the spec's where that is less, one direction at a time: both together may "
        "need faster wheels; accelerations are the spec's limits, else the largest of its motion"
    ]
    if not of.of.stepper:
        said.append(
            f"{NAME} commands {CONTROLLER}: activate both together. Where a drive closes its velocity loop itself, and "
            f"for diff_drive_controller before 4.14, name the joints without {CONTROLLER}/ and leave that one out"
        )
    return said


_NO_BASE = "no controller of ros2_controllers drives these wheels: command their velocities by one of your own"
