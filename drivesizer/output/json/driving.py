"""The JSON document of a platform on its path."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from drivesizer.control.path_following.deviation import extremes
from drivesizer.control.path_following.following import Followed
from drivesizer.load_cases.platform_drive import Driving, Wheel
from drivesizer.machine.permitted_speed import PermittedSpeeds
from drivesizer.output.json.documents import SCHEMA_VERSION, drive_set, requirement
from drivesizer.output.json.loops import number
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import KINDS
from drivesizer.version import __version__

if TYPE_CHECKING:
    from drivesizer.output.json import schema

__all__ = ["driving", "path_document"]


def driving(
    found: Driving, chosen: DriveSet | None, runs: Mapping[str, Followed], speeds: PermittedSpeeds | None = None
) -> dict[str, Any]:
    """The document of ``drivesizer drive --json``.

    Parameters
    ----------
    found
        The platform on its path.
    chosen
        The drive; None without one.
    runs
        Simulated path following, by name.
    speeds
        That the drive permits; None without one.

    Returns
    -------
    dict
        Plain data.
    """
    return {
        "schema_version": SCHEMA_VERSION,
        "drivesizer": __version__,
        "spec": found.spec.entered,
        "trajectory": getattr(found.spec.motion, "trajectory", None),
        "length_m": found.trajectory.length,
        "time_s": found.trajectory.total,
        "wheels": [_wheel(wheel) for wheel in found.wheels],
        "set": drive_set(chosen) if chosen else None,
        **path_document(found.spec, speeds, runs),
    }


def path_document(spec: RobotSpec, speeds: PermittedSpeeds | None, runs: Mapping[str, Followed]) -> schema.OnPath:
    """Speeds that a platform's drives permit, and simulated path following beside measured errors."""
    return {
        "permitted_speeds": _permitted(speeds) if speeds else None,
        "measured": _measured(spec),
        "following": {name: _run(run) for name, run in runs.items()},
    }


def _permitted(speeds: PermittedSpeeds) -> schema.Permitted:
    """Highest steady speeds by failed wheel and direction."""
    every: list[schema.PermittedSpeed] = [
        {"failed_wheel": failed or None, "direction_deg": degrees, "speed_m_per_s": number(speed), "limited_by": limit}
        for failed in speeds.speed
        for degrees in speeds.direction.tolist()
        for speed, limit in [speeds.at(degrees)[failed]]
    ]
    return {"speeds": every, "unknown": [*speeds.unknown], "estimated": [*speeds.estimated]}


def _measured(spec: RobotSpec) -> list[schema.Measured]:
    """Measured errors that the spec states."""
    section = spec.platform
    measured = section.following.measured if section else []
    return [{"name": one.name, "position_m": one.position, "heading_rad": one.heading} for one in measured]


def _run(run: Followed) -> schema.Run:
    """Largest deviations of a run."""
    largest: list[schema.Deviation] = [
        {
            "title": e.title,
            "si": number(e.value),
            "si_unit": KINDS[e.kind].si,
            "at_time_s": e.time,
            "at_way_m": e.travel,
        }
        for e in extremes(run)
    ]
    return {"largest": largest, "time_at_torque_limit": number(float(run.limited.max()))}


def _wheel(wheel: Wheel) -> dict[str, Any]:
    grip = wheel.grip
    return {
        "number": wheel.number,
        "requirements": {r.name: requirement(r) for r in wheel.requirements},
        "force_on_the_floor_N": number(grip.demand) if grip else None,
        "grip_N": number(grip.limit) if grip else None,
        "at_time_s": number(grip.time) if grip else None,
    }
