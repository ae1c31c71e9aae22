"""The JSON document of a platform on its way."""

from __future__ import annotations

from typing import Any

from drivesizer import __version__
from drivesizer.contract import SCHEMA_VERSION, drive_set, requirement
from drivesizer.contract_loops import number
from drivesizer.driving import Driving, Wheel
from drivesizer.results import DriveSet

__all__ = ["driving"]


def driving(found: Driving, chosen: DriveSet | None) -> dict[str, Any]:
    """The document of ``drivesizer drive --json``."""
    return {
        "schema_version": SCHEMA_VERSION,
        "drivesizer": __version__,
        "spec": found.spec.entered,
        "length_m": found.trajectory.length,
        "time_s": found.trajectory.total,
        "wheels": [_wheel(wheel) for wheel in found.wheels],
        "set": drive_set(chosen) if chosen else None,
    }


def _wheel(wheel: Wheel) -> dict[str, Any]:
    grip = wheel.grip
    return {
        "number": wheel.number,
        "requirements": {r.name: requirement(r) for r in wheel.asked},
        "force_on_the_floor_N": number(grip.demand) if grip else None,
        "grip_N": number(grip.limit) if grip else None,
        "at_time_s": number(grip.time) if grip else None,
    }
