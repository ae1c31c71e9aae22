"""ros2_control: the URDF with its hardware block, and the YAML of controllers, of one axis and of several."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from math import isnan, tau
from typing import Any, NamedTuple
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from drivesizer.errors import InputError, quoted
from drivesizer.joints.inverse_dynamics import Array
from drivesizer.output.export.common import (
    JOINT,
    Export,
    document,
    identifier,
    lacking,
    limited,
    number,
    remark,
    text,
    torque_law,
)
from drivesizer.output.export.machine import JointDrive, MachineExport
from drivesizer.output.export.platform import PlatformExport, Reach, wheel_name
from drivesizer.output.export.urdf import FOOTPRINT, robot, robot_of_machine, robot_of_platform

__all__ = ["controllers", "render"]


# -- ros2_control: the URDF with its hardware block, and the YAML of a velocity controller with the designed gains.
#
# The pid_controller of ros2_controllers takes reference and state of velocity and commands effort. The gains of
# ``gains``, from the motor to the driven shaft with gears that drive (torque by K e, speed by 1/K), are
#
# .. math:: p = K^2 e\, k_d, \qquad i = K^2 e\, k_p
#
# With feedforward its output is p (w_r - w) + i \int (w_r - w) + f w_r. Its clamps hold the first two terms alone,
# which carry the effort and what feedforward takes away: they are the joint's effort and f times its velocity.
#
# Names of parameters by version of ros2_controllers, as its pid_controller/src/pid_controller.yaml declares them
# (tags 2.54.0, 4.42.1, 5.17.0, 6.9.0); a version ignores those that it does not declare:
#
# - u_clamp_max, u_clamp_min, antiwindup_strategy: from 4.27 (Jazzy) and 5.2 on. Before, as in all 2.x (Humble), only
# the integral is limited, by i_clamp_max and i_clamp_min, whose default there is 0. - enable_feedforward: 4.x and
# 5.0, off by default. From 5.1 on feedforward is always on; in 2.x it takes a call of the service
# set_feedforward_control.
#
# The controller manager's update_rate is a whole number of hertz, 100 where none is given.


CONTROLLER = "velocity_controller"
LOOP, STEPS = ("velocity", "effort"), ("position",)  # what commands a drive with a loop, and a stepper
_MOCK = "mock_components/GenericSystem"


def render(of: Export) -> bytes:
    """The URDF of a set with its ``ros2_control`` block."""
    root = robot(of)
    block = hardware(root, identifier(of.name))
    interfaces(block, JOINT, limited(of), STEPS if of.stepper else LOOP)
    transmission(block, JOINT, of.train.ratio, "motor")
    return document(root)


def hardware(root: Element, name: str) -> Element:
    """Add a ``ros2_control`` block with its hardware."""
    block = SubElement(root, "ros2_control", name=f"{name}_drive", type="system")
    plugin = SubElement(block, "hardware")
    remark(plugin, f"{_MOCK} to try it; put your drive's own plugin here.")
    SubElement(plugin, "plugin").text = _MOCK
    return block


def interfaces(block: Element, joint: str, known: dict[str, str], takes: Sequence[str]) -> None:
    """Add the interfaces of a joint."""
    of_joint = SubElement(block, "joint", name=joint)
    for name in takes:
        command = SubElement(of_joint, "command_interface", name=name)
        for side, sign in (("min", "-"), ("max", "")) if name in known else ():
            SubElement(command, "param", name=side).text = sign + known[name]
    for name in ("position", "velocity", "effort") if "effort" in takes else ("position", "velocity"):
        SubElement(of_joint, "state_interface", name=name)


def transmission(block: Element, joint: str, ratio: float, actuator: str) -> None:
    """Add a transmission."""
    added = SubElement(block, "transmission", name=f"{joint}_transmission")
    SubElement(added, "plugin").text = "transmission_interface/SimpleTransmission"
    SubElement(added, "actuator", name=actuator, role=actuator)
    of_joint = SubElement(added, "joint", name=joint, role=joint)
    SubElement(of_joint, "mechanical_reduction").text = number(ratio)


def controllers(of: Export) -> bytes:
    """The parameters of controller manager and velocity controller, as YAML."""
    if of.stepper:
        return _trajectory(of)
    law = torque_law(of)
    said = [of.label, of.program, *lacking(of), *REMARKS, *rate_remarks(of)]
    if law.per_acceleration or law.per_direction:
        said.append("feedforward of acceleration and friction is left out")
    return commented(said, velocity_loops({JOINT: velocity_gains(of)}, rate_of(of)))


def commented(said: Iterable[str], body: str) -> bytes:
    """A YAML file with remarks at its head."""
    return ("".join(f"# {_line(line)}\n" for line in said) + body).encode()


def velocity_gains(of: Export, travel: float = 1.0, efficiency: float = 1.0, *, slides: bool = False) -> str:
    """Gains and clamps of one joint's velocity loop, as lines of YAML."""
    law, train = torque_law(of), of.train
    if law.ki:
        raise InputError("--format: ros2_control gets a velocity loop; leave control.position out of the spec")
    at_joint = train.ratio**2 * train.efficiency * efficiency / travel**2
    most, feedforward = of.limits.peak_torque.value * efficiency / travel, law.per_speed * at_joint
    held = most + abs(feedforward) * of.limits.peak_speed.value * travel
    force, angle = ("N", "/m") if slides else ("N*m", "/rad")
    place = " at the driven shaft" if travel == 1.0 else " at the joint"
    return _GAINS.format(
        p=float_text(law.kd * at_joint), i=float_text(law.kp * at_joint), ff=float_text(feedforward),
        most=float_text(held), least=float_text(-held),
        force=force, per=f"{force}*s{angle}{place}", angle=angle, speed=f"{force}*s{angle}",
    )  # fmt: skip


def velocity_loops(
    gains: dict[str, str], rate: int, steppers: Sequence[str] = (), more: Mapping[str, str] | None = None
) -> str:
    """Parameters of one velocity controller of several joints, as YAML."""
    named = {CONTROLLER: "pid_controller/PidController"} if gains else {}
    named |= {_ALONG: "joint_trajectory_controller/JointTrajectoryController"} if steppers else {}
    named |= more or {}
    found = _MANAGER.format(rate=rate) + "".join(f"    {name}:\n      type: {kind}\n" for name, kind in named.items())
    if gains:
        joints = "".join(f"      {joint}:\n{lines}" for joint, lines in gains.items())
        found += _VELOCITY.format(rate=rate, name=CONTROLLER, joints=", ".join(gains), gains=joints)
    return found + (_POSITIONS.format(name=_ALONG, joints=", ".join(steppers)) if steppers else "")


def _trajectory(of: Export) -> bytes:
    """A controller of positions along a trajectory: a stepper has no loop."""
    said = [
        of.label, of.program,
        "a stepper runs open-loop: it goes to the commanded positions, or loses steps unseen; keep accelerations to "
        "those that drivesizer validate has simulated",
    ]  # fmt: skip
    return commented(said, velocity_loops({}, TRAJECTORY, (JOINT,)))


def rate_of(of: Export) -> int:
    """Rate of the controller manager [Hz]."""
    return max(1, round(1.0 / of.period))


def rate_remarks(of: Export) -> list[str]:
    """Remarks on the rate for which gains hold, as sentences."""
    designed = 1.0 / of.period
    said = [
        f"p and i belong to a loop at {designed:.6g} Hz: where the controller manager does not run at update_rate they "
        "do not hold; for a loop at another rate give control: {rate: 1 kHz} in the spec and export anew"
    ]
    if abs(rate_of(of) - designed) > _NEAR * designed:
        said.append(f"update_rate is a whole number: {rate_of(of)} Hz for {designed:.6g} Hz")
    return said


def _line(said: str) -> str:
    return " ".join(text(said).split())


def float_text(value: float) -> str:
    """A figure that YAML and ROS read as a float: an integer is another type to them.

    >>> float_text(2.0), float_text(1e-9)
    ('2.0', '1e-09')
    """
    shown = number(value)
    return shown if set(shown) & {".", "e", "n"} else f"{shown}.0"


_NEAR = 1e-6  # of a rate: what is no whole number
REMARKS = (
    "u_clamp_max, u_clamp_min and antiwindup_strategy are of ros2_controllers 4.27 and 5.2 or later; older ones, "
    "such as Humble's 2.x, ignore them and limit the integral by i_clamp_max and i_clamp_min",
    "enable_feedforward is of 4.x and 5.0; later feedforward is always on; 2.x: the service set_feedforward_control",
    "the clamps limit p and i: the joint's effort, and the feedforward at the joint's velocity",
)
_ALONG = "joint_trajectory_controller"
TRAJECTORY = 100  # Hz, of the controller manager where there are steppers alone
_MANAGER = """controller_manager:
  ros__parameters:
    update_rate: {rate}  # Hz
    joint_state_broadcaster:
      type: joint_state_broadcaster/JointStateBroadcaster
"""
_POSITIONS = """
{name}:
  ros__parameters:
    joints: [{joints}]
    command_interfaces: [position]
    state_interfaces: [position, velocity]
"""
_VELOCITY = """
{name}:
  ros__parameters:
    update_rate: {rate}  # Hz, that of the controller manager
    dof_names: [{joints}]
    command_interface: effort
    reference_and_state_interfaces: [velocity]
    enable_feedforward: true
    gains:
{gains}"""
_GAINS = """        p: {p}  # {per}
        i: {i}  # {force}{angle}
        d: 0.0
        feedforward_gain: {ff}  # {speed}
        u_clamp_max: {most}  # {force}
        u_clamp_min: {least}
        i_clamp_max: {most}  # {force}
        i_clamp_min: {least}
        antiwindup_strategy: conditional_integration
"""


# -- ros2_control of a machine: its URDF with one hardware block, and the YAML of a velocity controller of all joints.
#
# Formulas and names of parameters as in ``export.ros2_control``. All controllers are designed for one rate, that of
# the controller manager: the slowest of the drives' own. Steppers take positions, from a controller of trajectories.


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


def render_machine(of: MachineExport) -> bytes:
    """The URDF of a machine with its ``ros2_control`` block."""
    joints = _joints(of)
    root = robot_of_machine(of)
    block = hardware(root, identifier(of.name))
    for joint in joints:
        interfaces(block, joint.name, joint.limits, STEPS if joint.of.stepper else LOOP)
    for joint in joints:
        transmission(block, joint.name, joint.ratio, joint.motor)
    return document(root)


def controllers_machine(of: MachineExport) -> bytes:
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


# -- The controller of ros2_controllers that drives a platform by velocities, and its parameters as YAML.
#
# Which one fits is not taken from a layout's name: its own speeds of the wheels have to be those of the platform's
# kinematics, :math:`r E η`. With l and r for left and right, f and r for front and rear, they are
#
# .. math::
#     \text{diff\_drive:} \; v_{l,r} = v_x \mp \tfrac{s}{2} ω \qquad
#     \text{omni\_wheel\_drive:} \; v_i = \sin θ_i\, v_x - \cos θ_i\, v_y - R ω \\
#     \text{mecanum\_drive:} \; v_{fl} = v_x' - v_y' - p ω, \quad v_{fr} = v_x' + v_y' + p ω, \quad
#     v_{rr} = v_x' - v_y' + p ω, \quad v_{rl} = v_x' + v_y' - p ω \\
#     v_x' = v_x + y_o ω, \quad v_y' = v_y - x_o ω
#
# s separation of the wheels, R distance of omni wheels from the middle, θ their directions from it, p half of
# wheelbase and track together, x_o and y_o the base's place in the frame of the wheels' middle. Omni wheels turn the
# other way round there.
#
# Names of parameters as declared in diff_drive_controller_parameter.yaml, mecanum_drive_controller.yaml and
# omni_wheel_drive_controller_parameters.yaml of ros2_controllers (tags 2.54.0, 4.42.1, 5.17.0, 6.9.0). A version
# passes over those that it does not declare: wheels_per_side and has_velocity_limits, has_acceleration_limits,
# has_jerk_limits are of 2.x, and max_deceleration is not; mecanum wheels are of 2.43 and 4.17 on, their limits of
# 4.41, 5.16 and 6.8 on, omni wheels of 4.30 and 5.5 on.


NAME = "base_controller"
_SAME = 1e-9  # of a speed at a wheel of 1 m/s, or 1 rad/s


class BaseController(NamedTuple):
    """A controller that drives a whole platform."""

    kind: str  # plugin
    parameters: Mapping[str, Any]
    direction: float = 1.0  # -1 where its wheels turn the other way round
    said: tuple[str, ...] = ()  # remarks


def base_controller(of: PlatformExport, before: str) -> BaseController | None:
    """The controller whose wheels turn as those of a platform; None where none does."""
    places = list(of.drives)
    rows = np.round(of.radius * of.kinematics.E[places] / _SAME) * _SAME
    names = [wheel_name(place) for place in places]
    for fitting in (_differential, _mecanum, _omni):
        found = fitting(of, rows, names, before)
        if found:
            return found
    return None


def _near(a: Any, b: Any) -> bool:
    return bool(np.allclose(a, b, rtol=0.0, atol=10.0 * _SAME))


def _differential(of: PlatformExport, rows: Array, names: list[str], before: str) -> BaseController | None:
    """Wheels in pairs, left and right, that roll forwards."""
    ahead, aside, turning = rows.T
    left, right = ([n for n, t in zip(names, turning, strict=True) if side * t > 0.0] for side in (-1.0, 1.0))
    if not (_near(ahead, 1.0) and _near(aside, 0.0) and _near(np.abs(turning), abs(turning[0]))) or not left:
        return None
    if len(left) != len(right):
        return None
    parameters = {
        "left_wheel_names": [before + name for name in left], "right_wheel_names": [before + name for name in right],
        "wheels_per_side": len(left), "wheel_separation": 2.0 * float(abs(turning[0])), "wheel_radius": of.radius,
        "position_feedback": not before, "cmd_vel_timeout": 0.5, **_frames(), **_limits(of.reach, ("x",), older=True),
    }  # fmt: skip
    ahead_of = of.platform.wheels[next(iter(of.drives))].x
    said = f"odometry is that of the axle's middle, {ahead_of:.4g} m ahead of {FOOTPRINT}"
    return BaseController("diff_drive_controller/DiffDriveController", parameters, said=(said,) if ahead_of else ())


def _mecanum(of: PlatformExport, rows: Array, names: list[str], before: str) -> BaseController | None:
    """Four wheels of which each pulls along a diagonal."""
    ahead, aside, turning = rows.T
    if len(names) != 4 or not (_near(ahead, 1.0) and _near(np.abs(aside), 1.0) and _near(aside.sum(), 0.0)):
        return None
    by_turning = np.argsort(turning)
    front_left, rear_right = (int(n) for n in by_turning if aside[n] < 0.0)
    rear_left, front_right = (int(n) for n in by_turning if aside[n] > 0.0)
    reach = (turning[rear_right] - turning[front_left]) / 2.0
    if not (reach > 0.0 and _near(reach, (turning[front_right] - turning[rear_left]) / 2.0)):
        return None
    one, other = (turning[front_left] + turning[rear_right]) / 2.0, (turning[front_right] + turning[rear_left]) / 2.0
    corners = {"front_left": front_left, "front_right": front_right, "rear_right": rear_right, "rear_left": rear_left}
    parameters: dict[str, Any] = {"reference_timeout": 0.5}
    for corner, n in corners.items():
        parameters[f"{corner}_wheel_command_joint_name"] = before + names[n]
    for corner, n in corners.items() if before else ():
        parameters[f"{corner}_wheel_state_joint_name"] = names[n]
    parameters["kinematics"] = {
        "base_frame_offset": {"x": float(one - other) / 2.0, "y": float(one + other) / 2.0, "theta": 0.0},
        "wheels_radius": of.radius, "sum_of_robot_center_projection_on_X_Y_axis": float(reach),
    }  # fmt: skip
    parameters |= {**_frames(), **_limits(of.reach, ("x", "y"), older=False)}
    return BaseController("mecanum_drive_controller/MecanumDriveController", parameters)


def _omni(of: PlatformExport, rows: Array, names: list[str], before: str) -> BaseController | None:
    """Wheels at equal angles on a circle, each rolling along it."""
    count, radius = len(names), float(rows[0, 2])
    angles = np.arctan2(-rows[:, 0], rows[:, 1]) % tau
    order = np.argsort(np.round(angles / _SAME) * _SAME % tau)
    first = float(angles[order[0]])
    if not (count >= 3 and radius > 0.0 and _near(rows[:, 2], radius) and _near(np.hypot(*rows[:, :2].T), 1.0)):
        return None
    if not _near(angles[order], first + tau / count * np.arange(count)):
        return None
    parameters = {
        "wheel_offset": first, "wheel_names": [before + names[n] for n in order], "robot_radius": radius,
        "wheel_radius": of.radius, "position_feedback": not before, "cmd_vel_timeout": 0.5, **_frames(),
    }  # fmt: skip
    return BaseController("omni_wheel_drive_controller/OmniWheelDriveController", parameters, direction=-1.0)


def _frames() -> dict[str, Any]:
    """Frames of the odometry: the root of the URDF is the one that moves."""
    return {"odom_frame_id": "odom", "base_frame_id": FOOTPRINT}


def _limits(reach: Reach, axes: tuple[str, ...], *, older: bool) -> dict[str, Any]:
    """Limits of velocity, acceleration and jerk; what is unknown is left out."""
    speeds = {"x": reach.forwards, "y": reach.sideways}
    linear = {axis: _axis_limits(speeds[axis], reach.acceleration, reach.jerk, older) for axis in axes}
    about = _axis_limits(reach.turning, reach.turning_acceleration, reach.turning_jerk, older)
    return {"linear": linear, "angular": {"z": about}}


def _axis_limits(speed: float, acceleration: float, jerk: float, older: bool) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in (("velocity", speed), ("acceleration", acceleration), ("jerk", jerk)):
        if isnan(value):
            continue
        if older:
            found[f"has_{name}_limits"] = True
        found[f"max_{name}"] = value
        found["max_deceleration" if name == "acceleration" else f"min_{name}"] = -value
    return found


def parameters_text(parameters: Mapping[str, Any], indent: int = 4) -> str:
    """Parameters as lines of YAML.

    Examples
    --------
    >>> print(parameters_text({"linear": {"x": {"max_velocity": 2.0}}, "names": ["a", "b"]}, 0), end="")
    linear:
      x:
        max_velocity: 2.0
    names: [a, b]
    """
    lines = []
    for name, value in parameters.items():
        if isinstance(value, Mapping):
            lines.append(f"{' ' * indent}{name}:\n{parameters_text(value, indent + 2)}")
        else:
            lines.append(f"{' ' * indent}{name}: {_written(value)}\n")
    return "".join(lines)


def _written(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return float_text(value)
    return f"[{', '.join(value)}]" if isinstance(value, list) else str(value)


# -- ros2_control of a platform: its URDF with one hardware block, and the YAML of a controller of the base.
#
# The controller of the base (``base_controller``) takes the platform's velocity and commands that of the wheels: the
# references of one velocity controller of all wheels, on effort, with the designed gains as in
# ``export.ros2_control``. A stepper has no loop: its joint takes velocities, from the controller of the base itself.


_VELOCITY_ALONE = ("velocity",)


def render_platform(of: PlatformExport) -> bytes:
    """The URDF of a platform with its ``ros2_control`` block."""
    found = _base(of)
    direction = found.direction if found else 1.0
    root = robot_of_platform(of, direction)
    block = hardware(root, identifier(of.name))
    for drive in of.drives.values():
        interfaces(block, drive.joint, drive.limits, _VELOCITY_ALONE if drive.of.stepper else LOOP)
    for place, drive in of.drives.items():
        transmission(block, drive.joint, direction * drive.ratio, f"{wheel_name(place)}_motor")
    return document(root)


def _base(of: PlatformExport) -> BaseController | None:
    """The controller of the base; of wheels with a loop it commands their velocity controller."""
    return base_controller(of, "" if of.of.stepper else f"{CONTROLLER}/")


def controllers_platform(of: PlatformExport) -> bytes:
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
