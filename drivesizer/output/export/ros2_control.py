r"""ros2_control: the URDF with its hardware block, and the YAML of the controllers of all joints.

The pid_controller of ros2_controllers takes reference and state of velocity and commands effort. The gains of
``gains``, from the motor to the driven shaft with gears that drive (torque by K e, speed by 1/K), are

.. math:: p = K^2 e\, k_d, \qquad i = K^2 e\, k_p

With feedforward its output is p (w_r - w) + i \int (w_r - w) + f w_r. Its clamps hold the first two terms alone, which
carry the effort and what feedforward takes away: they are the joint's effort and f times its velocity.

Names of parameters by version of ros2_controllers, as its pid_controller/src/pid_controller.yaml declares them (tags
2.54.0, 4.42.1, 5.17.0, 6.9.0); a version ignores those that it does not declare:

- u_clamp_max, u_clamp_min, antiwindup_strategy: from 4.27 (Jazzy) and 5.2 on. Before, as in all 2.x (Humble), only the
  integral is limited, by i_clamp_max and i_clamp_min, whose default there is 0.
- enable_feedforward: 4.x and 5.0, off by default. From 5.1 on feedforward is always on; in 2.x it takes a call of the
  service set_feedforward_control.

The controller manager's update_rate is a whole number of hertz, 100 where none is given: of several drives the slowest
of their own, for which all controllers are designed. Steppers take positions, from a controller of trajectories. The
wheels of a platform take velocities, with a controller of the base whose own speeds of the wheels are those of the
platform's kinematics.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import isnan, tau
from typing import Any, NamedTuple
from xml.etree.ElementTree import SubElement

import numpy as np

from drivesizer.errors import InputError, quoted
from drivesizer.output.export import common
from drivesizer.output.export.common import Export, identifier, number, remark, sentences, text, texts, torque_law
from drivesizer.output.export.joint_drive import JointDrive
from drivesizer.output.export.machine import MachineExport
from drivesizer.output.export.platform import PlatformExport, Reach, wheel_name
from drivesizer.output.export.urdf import FOOTPRINT, robot_of

CONTROLLER = "velocity_controller"
NAME = "base_controller"
_ALONG = "joint_trajectory_controller"
_MOCK = "mock_components/GenericSystem"
_TRAJECTORY = 100  # Hz, of the controller manager where there are steppers alone
_NEAR = 1e-6  # of a rate: what is no whole number
_SAME = 1e-9  # of a speed at a wheel of 1 m/s, or 1 rad/s
_PARAMETER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")  # name of a joint that is a parameter's name in ROS
_WORDS = frozenset({"y", "n", "yes", "no", "on", "off", "true", "false", "null"})  # other than text in YAML


def render(of: MachineExport) -> bytes:
    """The URDF of a machine with its ``ros2_control`` block."""
    joints = _joints(of)
    base = base_controller(of.platform) if of.platform else None
    direction = base.direction if base else 1.0
    root = robot_of(of, direction)
    block = SubElement(root, "ros2_control", name=f"{identifier(of.name)}_drive", type="system")
    plugin = SubElement(block, "hardware")
    remark(plugin, f"{_MOCK} to try it; put your drive's own plugin here.")
    texts(plugin, plugin=_MOCK)
    stepped = ("velocity",) if of.platform else ("position",)  # what commands a stepper
    for joint in joints:
        added = SubElement(block, "joint", name=joint.joint)
        takes = stepped if joint.of.stepper else ("velocity", "effort")
        for name in takes:
            command = SubElement(added, "command_interface", name=name)
            for side, sign in (("min", "-"), ("max", "")) if name in joint.limits else ():
                SubElement(command, "param", name=side).text = sign + joint.limits[name]
        for name in ("position", "velocity", "effort") if "effort" in takes else ("position", "velocity"):
            SubElement(added, "state_interface", name=name)
    for joint in joints:
        added = SubElement(block, "transmission", name=f"{joint.joint}_transmission")
        texts(added, plugin="transmission_interface/SimpleTransmission")
        SubElement(added, "actuator", name=joint.motor, role=joint.motor)
        of_joint = SubElement(added, "joint", name=joint.joint, role=joint.joint)
        texts(of_joint, mechanical_reduction=number(direction * joint.ratio))
    return common.document(root)


def _joints(of: MachineExport) -> tuple[JointDrive, ...]:
    """All joints with a drive, whose names ROS takes."""
    for joint in of.drives:
        if joint.coupled:
            raise InputError(
                f"{joint.joint}: its belt passes other joints, which ros2_control's simple transmission has no place "
                "for; expected --format mjcf or urdf"
            )
        if not _PARAMETER.fullmatch(joint.joint) or joint.joint.lower() in _WORDS:
            raise InputError(
                f"joint {quoted(joint.joint)}: ROS has no parameters of this name; expected letters, digits and "
                "underscores, a letter first"
            )
    return of.drives


def controllers(of: MachineExport) -> bytes:
    """The parameters of controller manager and controllers, as YAML with remarks at its head."""
    joints, platform = _joints(of), of.platform
    looped, steppers = ([joint for joint in joints if bool(joint.of.stepper) is steps] for steps in (False, True))
    slowest = max((joint.of for joint in looped), key=lambda joint: joint.period, default=None)
    base = base_controller(platform) if platform else None
    lines = [f"{joint.joint}: {joint.of.label}" for joint in joints]
    if platform:
        lines = [f"{', '.join(joint.joint for joint in joints)}: {platform.of.label}"]
    elif of.alone:
        lines = [of.alone.label]
    lines += [common.PROGRAM, *dict.fromkeys(line for joint in looped for line in common.lacking(joint.of))]
    if slowest:
        rate = 1.0 / slowest.period
        whole = abs(_rate(slowest) - rate) <= _NEAR * rate
        lines += sentences("ros2_control: velocity loops", rate=rate, update_rate=_rate(slowest), whole=whole)
    law = torque_law(of.alone) if of.alone and looped else None
    if law and (law.per_acceleration or law.per_direction):
        lines.append("feedforward of acceleration and friction is left out")
    if steppers:
        lines += sentences("ros2_control: steppers", platform=bool(platform), alone=bool(of.alone))
    if platform:
        lines += (
            [*sentences("ros2_control: base", of=platform), *base.remarks]
            if base
            else sentences("ros2_control: no base")
        )
    along = [] if platform else [joint.joint for joint in steppers]
    rate = _rate(slowest) if slowest else _TRAJECTORY
    state = "joint_state_broadcaster"
    manager: dict[str, Any] = {"update_rate": Noted(rate, "Hz"), state: {"type": f"{state}/JointStateBroadcaster"}}
    nodes: dict[str, Mapping[str, Any]] = {"controller_manager": manager}
    if looped:
        manager[CONTROLLER] = {"type": "pid_controller/PidController"}
        nodes[CONTROLLER] = {
            "update_rate": Noted(rate, "Hz, that of the controller manager"),
            "dof_names": [joint.joint for joint in looped], "command_interface": "effort",
            "reference_and_state_interfaces": ["velocity"], "enable_feedforward": True,
            "gains": {joint.joint: _gains(joint) for joint in looped},
        }  # fmt: skip
    if along:
        manager[_ALONG] = {"type": "joint_trajectory_controller/JointTrajectoryController"}
        nodes[_ALONG] = {"joints": along, "command_interfaces": ["position"],
                         "state_interfaces": ["position", "velocity"]}  # fmt: skip
    if base:
        manager[NAME], nodes[NAME] = {"type": base.kind}, base.parameters
    body = "\n".join(parameters_text({name: {"ros__parameters": own}}) for name, own in nodes.items())
    return ("".join(f"# {' '.join(text(line).split())}\n" for line in lines) + body).encode()


class Noted(NamedTuple):
    """A parameter with a remark behind it."""

    value: float
    remark: str


def _gains(joint: JointDrive) -> dict[str, Any]:
    """Gains and clamps of one joint's velocity loop."""
    of, travel, efficiency = joint.of, joint.travel, joint.gear_efficiency
    law, train = torque_law(of), of.train
    if law.ki:
        raise InputError("--format: ros2_control gets a velocity loop; leave control.position out of the spec")
    at_joint = train.ratio**2 * train.efficiency * efficiency / travel**2
    most, feedforward = of.limits.peak_torque.value * efficiency / travel, law.per_speed * at_joint
    clamp = most + abs(feedforward) * of.limits.peak_speed.value * travel
    force, angle = ("N", "/m") if joint.slides else ("N*m", "/rad")
    place = " at the driven shaft" if travel == 1.0 else " at the joint"
    return {
        "p": Noted(law.kd * at_joint, f"{force}*s{angle}{place}"), "i": Noted(law.kp * at_joint, f"{force}{angle}"),
        "d": 0.0, "feedforward_gain": Noted(feedforward, f"{force}*s{angle}"),
        "u_clamp_max": Noted(clamp, force), "u_clamp_min": -clamp, "i_clamp_max": Noted(clamp, force),
        "i_clamp_min": -clamp, "antiwindup_strategy": "conditional_integration",
    }  # fmt: skip


def _rate(of: Export) -> int:
    """Rate of the controller manager [Hz]."""
    return max(1, round(1.0 / of.period))


def _float(value: float) -> str:
    """A figure that YAML and ROS read as a float: an integer is another type to them.

    >>> _float(2.0), _float(1e-9)
    ('2.0', '1e-09')
    """
    digits = number(value)
    return digits if set(digits) & {".", "e", "n"} else f"{digits}.0"


# The controller of ros2_controllers that drives a platform by velocities, and its parameters as YAML.
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


class BaseController(NamedTuple):
    """A controller that drives a whole platform; of wheels with a loop it commands their velocity controller."""

    kind: str  # plugin
    parameters: Mapping[str, Any]
    direction: float = 1.0  # -1 where its wheels turn the other way round
    remarks: tuple[str, ...] = ()  # remarks


def _near(a: Any, b: Any) -> bool:
    return bool(np.allclose(a, b, rtol=0.0, atol=10.0 * _SAME))


def base_controller(of: PlatformExport) -> BaseController | None:
    """The controller whose wheels turn as those of a platform; None where none does."""
    ahead, aside, turning = (np.round(of.radius * of.kinematics.E[list(of.drives)] / _SAME) * _SAME).T
    names = [wheel_name(place) for place in of.drives]
    before = "" if of.of.stepper else f"{CONTROLLER}/"
    frames = {"odom_frame_id": "odom", "base_frame_id": FOOTPRINT}  # the root of the URDF is the one that moves
    open_loop = {"position_feedback": not before, "cmd_vel_timeout": 0.5, **frames}
    left, right = ([n for n, t in zip(names, turning, strict=True) if side * t > 0.0] for side in (-1.0, 1.0))
    even = _near(ahead, 1.0) and _near(aside, 0.0) and _near(np.abs(turning), abs(turning[0]))
    if even and left and len(left) == len(right):  # in pairs, left and right, that roll forwards
        parameters = {
            "left_wheel_names": [before + name for name in left],
            "right_wheel_names": [before + name for name in right], "wheels_per_side": len(left),
            "wheel_separation": 2.0 * float(abs(turning[0])), "wheel_radius": of.radius, **open_loop,
            **_limits(of.reach, ("x",), older=True),
        }  # fmt: skip
        ahead_of = of.platform.wheels[next(iter(of.drives))].x
        notes = (f"odometry is that of the axle's middle, {ahead_of:.4g} m ahead of {FOOTPRINT}",) if ahead_of else ()
        return BaseController("diff_drive_controller/DiffDriveController", parameters, remarks=notes)
    if len(names) == 4 and _near(ahead, 1.0) and _near(np.abs(aside), 1.0) and _near(aside.sum(), 0.0):
        return _mecanum(of, aside, turning, before, frames)
    angles = np.arctan2(-ahead, aside) % tau
    order = np.argsort(np.round(angles / _SAME) * _SAME % tau)
    first, count, radius = float(angles[order[0]]), len(names), float(turning[0])
    on_circle = count >= 3 and radius > 0.0 and _near(turning, radius) and _near(np.hypot(ahead, aside), 1.0)
    if not on_circle or not _near(angles[order], first + tau / count * np.arange(count)):
        return None
    parameters = {  # at equal angles on a circle, each rolling along it
        "wheel_offset": first, "wheel_names": [before + names[n] for n in order], "robot_radius": radius,
        "wheel_radius": of.radius, **open_loop,
    }  # fmt: skip
    return BaseController("omni_wheel_drive_controller/OmniWheelDriveController", parameters, direction=-1.0)


def _mecanum(
    of: PlatformExport, aside: Any, turning: Any, before: str, frames: dict[str, str]
) -> BaseController | None:
    """Four wheels of which each pulls along a diagonal."""
    names, by_turning = [wheel_name(place) for place in of.drives], np.argsort(turning)
    front_left, rear_right = (int(n) for n in by_turning if aside[n] < 0.0)
    rear_left, front_right = (int(n) for n in by_turning if aside[n] > 0.0)
    reach = (turning[rear_right] - turning[front_left]) / 2.0
    if not (reach > 0.0 and _near(reach, (turning[front_right] - turning[rear_left]) / 2.0)):
        return None
    falling, other = (
        (turning[front_left] + turning[rear_right]) / 2.0,
        (turning[front_right] + turning[rear_left]) / 2.0,
    )
    corners = {"front_left": front_left, "front_right": front_right, "rear_right": rear_right, "rear_left": rear_left}
    parameters: dict[str, Any] = {"reference_timeout": 0.5}
    parameters |= {f"{corner}_wheel_command_joint_name": before + names[n] for corner, n in corners.items()}
    parameters |= {f"{corner}_wheel_state_joint_name": names[n] for corner, n in corners.items() if before}
    parameters["kinematics"] = {
        "base_frame_offset": {"x": float(falling - other) / 2.0, "y": float(falling + other) / 2.0, "theta": 0.0},
        "wheels_radius": of.radius, "sum_of_robot_center_projection_on_X_Y_axis": float(reach),
    }  # fmt: skip
    parameters |= {**frames, **_limits(of.reach, ("x", "y"), older=False)}
    return BaseController("mecanum_drive_controller/MecanumDriveController", parameters)


def _limits(reach: Reach, axes: tuple[str, ...], *, older: bool) -> dict[str, Any]:
    """Limits of velocity, acceleration and jerk; what is unknown is left out."""

    def limits(speed: float, acceleration: float, jerk: float) -> dict[str, Any]:
        entries: dict[str, Any] = {}
        for name, value in (("velocity", speed), ("acceleration", acceleration), ("jerk", jerk)):
            if isnan(value):
                continue
            if older:
                entries[f"has_{name}_limits"] = True
            entries[f"max_{name}"] = value
            entries["max_deceleration" if name == "acceleration" else f"min_{name}"] = -value
        return entries

    speeds = {"x": reach.forwards, "y": reach.sideways}
    about = limits(reach.turning, reach.turning_acceleration, reach.turning_jerk)
    linear = {axis: limits(speeds[axis], reach.acceleration, reach.jerk) for axis in axes}
    return {"linear": linear, "angular": {"z": about}}


def parameters_text(parameters: Mapping[str, Any], indent: int = 0) -> str:
    """Parameters as lines of YAML.

    >>> print(parameters_text({"linear": {"x": {"max_velocity": 2.0}}, "names": ["a", "b"]}), end="")
    linear:
      x:
        max_velocity: 2.0
    names: [a, b]
    """
    lines = ""
    for name, parameter in parameters.items():
        value, remark = parameter if isinstance(parameter, Noted) else (parameter, "")
        lines += f"{' ' * indent}{name}:"
        if isinstance(value, Mapping):
            lines += f"\n{parameters_text(value, indent + 2)}"
            continue
        written = f"[{', '.join(value)}]" if isinstance(value, list) else str(value)
        if isinstance(value, float | bool):
            written = str(value).lower() if isinstance(value, bool) else _float(value)
        lines += f" {written}{remark and f'  # {remark}'}\n"
    return lines
