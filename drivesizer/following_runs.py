"""A spec's platform with its motor sets, driven along its way by each robot model."""

from __future__ import annotations

from math import inf
from typing import Any

from drivesizer.driving import Driving
from drivesizer.machines import WheeledVehicle
from drivesizer.platform.following import Followed, follow
from drivesizer.platform.following_control import is_unicycle, pose_loop, speed_loop
from drivesizer.platform.slip import Contact
from drivesizer.platform_cases import dynamics_of, ground_of
from drivesizer.results import DriveSet

__all__ = ["ASSUMED", "follow_all"]


def follow_all(found: Driving, chosen: DriveSet | None) -> dict[str, Followed]:
    """The runs by name: kinematic and dynamic model, open-loop, and the dynamic one with poses fed back where it can.

    Parameters
    ----------
    found
        The platform on its way.
    chosen
        Whose rotors turn with the wheels and whose torque is the limit; without a set there are neither.

    Raises
    ------
    InputError
        When the wheels have no inertia, or a figure cannot be computed with.
    """
    d = dynamics_of(found.spec, _rotor(chosen))
    load, section = found.spec.load, found.spec.platform
    assert isinstance(load, WheeledVehicle) and section is not None
    floor = Contact() if load.friction_coefficient is None else Contact(friction=load.friction_coefficient)
    speeds = speed_loop(d, limit=_strongest(chosen))
    more: dict[str, Any] = {
        "misjudged": section.misjudged.record,
        "contact": floor,
        "speeds": speeds,
        "ground": ground_of(found.spec),
    }
    way, platform = found.trajectory, d.platform
    runs = {
        "kinematic model": follow(way, platform, model="kinematic", **more),
        "dynamic model": follow(way, platform, model="dynamic", **more),
    }
    if d.kinematics.mobility == 3 or is_unicycle(d.kinematics):
        poses = pose_loop(d, speeds, speed=_fastest(found))
        runs["poses fed back"] = follow(way, platform, model="dynamic", poses=poses, **more)
    return runs


def _rotor(chosen: DriveSet | None) -> float:
    """Inertia of a motor set at its wheel [kg*m^2], as far as it is known."""
    if chosen is None:
        return 0.0
    parts = (chosen.motor.rotor_inertia, chosen.gearhead.inertia)
    return chosen.total_ratio**2 * sum(one for one in parts if one == one)


def _strongest(chosen: DriveSet | None) -> float:
    """Largest torque of a motor set at its wheel [N*m]: at the controller's peak current, by gearhead and belt."""
    if chosen is None or chosen.controller is None:
        return inf
    at_motor = chosen.controller.peak_current * chosen.motor.torque_constant
    at_wheel = at_motor * chosen.total_ratio * chosen.gearhead.efficiency * chosen.belt_efficiency
    return at_wheel if at_wheel == at_wheel else inf


def _fastest(found: Driving) -> float:
    x, y, _ = found.trajectory.velocity
    return float((x**2 + y**2).max() ** 0.5)


ASSUMED = (
    "slip, resistances and the controllers of the wheels are simulated; stiction, roller gaps, noise of encoders and "
    "poses, the voltage limit and the lag of the current loops are not",
    "speed loops of 1 ms by the symmetrical optimum, poses every 50 ms; slip meets the grip at 10 mm/s",
    "the platform differs from its model as platform.misjudged says, and by slip and resistance",
)
