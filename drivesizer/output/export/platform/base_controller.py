r"""The controller of ros2_controllers that drives a platform by velocities, and its parameters as YAML.

Which one fits is not taken from a layout's name: its own speeds of the wheels have to be those of the platform's
kinematics, :math:`r E η`. With l and r for left and right, f and r for front and rear, they are

.. math::
    \text{diff\_drive:} \; v_{l,r} = v_x \mp \tfrac{s}{2} ω \qquad
    \text{omni\_wheel\_drive:} \; v_i = \sin θ_i\, v_x - \cos θ_i\, v_y - R ω \\
    \text{mecanum\_drive:} \; v_{fl} = v_x' - v_y' - p ω, \quad v_{fr} = v_x' + v_y' + p ω, \quad
    v_{rr} = v_x' - v_y' + p ω, \quad v_{rl} = v_x' + v_y' - p ω \\
    v_x' = v_x + y_o ω, \quad v_y' = v_y - x_o ω

s separation of the wheels, R distance of omni wheels from the middle, θ their directions from it, p half of wheelbase
and track together, x_o and y_o the base's place in the frame of the wheels' middle. Omni wheels turn the other way
round there.

Names of parameters as declared in diff_drive_controller_parameter.yaml, mecanum_drive_controller.yaml and
omni_wheel_drive_controller_parameters.yaml of ros2_controllers (tags 2.54.0, 4.42.1, 5.17.0, 6.9.0). A version passes
over those that it does not declare: wheels_per_side and has_velocity_limits, has_acceleration_limits, has_jerk_limits
are of 2.x, and max_deceleration is not; mecanum wheels are of 2.43 and 4.17 on, their limits of 4.41, 5.16 and 6.8 on,
omni wheels of 4.30 and 5.5 on.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import isnan, tau
from typing import Any, NamedTuple

import numpy as np

from drivesizer.joints.record import Array
from drivesizer.output.export.platform.record import PlatformExport, Reach, wheel_name
from drivesizer.output.export.platform.urdf import FOOTPRINT
from drivesizer.output.export.ros2_control import float_text

__all__ = ["NAME", "BaseController", "base_controller"]

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
