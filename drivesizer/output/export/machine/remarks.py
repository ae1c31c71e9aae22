"""Remarks at the head of a machine's file, as sentences."""

from __future__ import annotations

from drivesizer.output.export.machine.record import JointDrive, MachineExport, RobotExport
from drivesizer.output.export.markup import brief

__all__ = ["head", "of_drive"]


def head(of: MachineExport) -> list[str]:
    """Remarks on the whole file.

    Parameters
    ----------
    of
        The machine.

    Returns
    -------
    list of str
        What it has, what is left out.
    """
    said = [f"{of.program}. SI: kg, m, s, N, N*m, rad."]
    if of.robot:
        said += _of_robot(of.robot)
    if of.axes:
        beside = "beside the robot " if of.robot else ""
        said.append(
            f"Axes {beside}({', '.join(name for name, _ in of.axes)}): each a joint of its own at the origin, its load "
            "with all drives that ride on it; names begin with the axis."
        )
    return [*said, *(f"Assumed: {line}." for line in (*of.said, *of.notes))]


def _of_robot(robot: RobotExport) -> list[str]:
    said = [
        "Links, joints and position limits are those of the description, without its shapes; effort, velocity and "
        "friction of a joint are those of its drive, whose mass is at its place."
    ]
    if any(drive.slides for drive in robot.drives):
        said.append("Joints that slide: N, N*s/m and kg in the place of N*m, N*m*s/rad and kg*m^2.")
    if robot.section.friction == "keep" and any(_bearings(robot, drive) for drive in robot.drives):
        said.append("The friction in the description is that of bearings, and is added to that of the drives.")
    if robot.held:
        places = ", ".join(f"{name} {brief(value)}" for name, value in robot.held.items())
        said.append(f"Joints without a drive, as they are held [rad or m]: {places}.")
    return [*said, *robot.robot.notes]


def _bearings(robot: RobotExport, drive: JointDrive) -> bool:
    joint = robot.robot.joints[drive.joint]
    return bool(joint.damping or joint.friction)


def of_drive(drive: JointDrive) -> list[str]:
    """Remarks on the drive of a joint.

    Parameters
    ----------
    drive
        With its limits.

    Returns
    -------
    list of str
        Its parts, what limits it, its inertia and efficiency.
    """
    limits, e = drive.of.limits, drive.efficiency
    lacking = f", without {', '.join(drive.lacking)}, of unknown mass" if drive.lacking else ""
    rotor = brief(drive.armature) if drive.armature == drive.armature else "UNKNOWN"
    lasting = limits.continuous_torque.value * drive.gear_efficiency / drive.travel
    effort, velocity = (one.by or "nothing known" for one in (limits.peak_torque, limits.peak_speed))
    said = [
        f"{drive.of.label}: {brief(drive.mass)} kg{lacking}; total ratio {brief(drive.ratio)}; effort by "
        f"{effort}, continuous {brief(lasting)}; velocity by {velocity}; "
        f"armature {rotor}, rotor and gearhead input by ratio squared, gears driving at an efficiency of {brief(e)}."
    ]
    if drive.back_efficiency != drive.gear_efficiency:
        back = drive.of.train.efficiency * drive.back_efficiency
        said.append(f"Where the load drives the motor, the gears have an efficiency f of {brief(back)}.")
    if drive.coupled:
        others = ", ".join(
            f"{'' if share > 0 else '-'}{name}" for name, share in drive.turns_by.items() if name != drive.joint
        )
        said.append(f"Its belt passes other joints: the drive turns by the sum of this joint and {others}.")
    return said
