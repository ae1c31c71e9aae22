"""Warnings of load cases: a motion that does not end where it started, driven wheels that cannot stand alone.

A cycle repeats. A vehicle, a conveyor, a fan, a flywheel and an indexing table may go on from wherever they
are; an arm, a hoist, a screw, a rack and a table that gravity pulls round may not: each further cycle would start
farther on, the arm of a crane over its own base, and what is sized for is the first cycle alone.
"""

from __future__ import annotations

import math

from drivesizer.load_cases.profile import profile_of
from drivesizer.loads.course import course
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

__all__ = ["grip_warning", "starts_farther_on"]

_ROUNDING = 1e-6  # of the distance: a recording is no more exact
_TURN = 2.0 * math.pi
_STANDS = 3  # wheels at least


def starts_farther_on(name: str, spec: RobotSpec) -> tuple[str, ...]:
    """A warning where the cycle of a load case ends elsewhere than it starts; empty where it may, or does not."""
    off = _off(spec)
    return (_sentence(name, off, spec),) if off else ()


def _sentence(name: str, off: float, spec: RobotSpec) -> str:
    distance = show(abs(off), "deg", "angle", 3) if spec.load.axis == "rotary" else show(abs(off), "mm", "length", 3)
    of = f" of load case {name}" if name else ""
    side = "beyond" if off > 0.0 else "short of"
    return (
        f"the motion{of} ends {distance} {side} where it starts, and the cycle repeats: bring it back "
        "(there_and_back: true), or every cycle starts farther on than the one that is sized for"
    )


def _off(spec: RobotSpec) -> float:
    """Distance of the end of a cycle from its start [m or rad]; 0 where that does not matter."""
    load = spec.load
    lever = load.lever
    pulled = lever is not None and lever.mass * lever.length * lever.share != 0.0
    if not load.has_end and not pulled:
        return 0.0
    moved = course(profile_of(spec))
    travel = moved.duration * moved.speed.mean(axis=1)
    off = float(travel.sum())
    if lever is not None:  # a whole turn brings it back
        off -= _TURN * round(off / _TURN)
    return off if abs(off) > _ROUNDING * float(abs(travel).sum()) else 0.0


def grip_warning(spec: RobotSpec) -> tuple[str, ...]:
    """A warning where traction takes few driven wheels to carry all of the weight."""
    load = spec.load
    if not isinstance(load, WheeledVehicle) or spec.platform or load.friction_coefficient is None:
        return ()
    if load.driven_share is not None or load.driven_wheels >= _STANDS:
        return ()
    wheels = "1 driven wheel" if load.driven_wheels == 1 else f"{load.driven_wheels} driven wheels"
    return (
        f"traction: all of the weight is taken to be on {wheels}, which cannot stand alone; give load.driven_share, "
        "such as 60 %, where casters or other wheels carry the rest",
    )
