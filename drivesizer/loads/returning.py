"""Whether a cyclic motion ends where it began, of loads whose way has an end or whose torque hangs on where they are.

A cycle repeats for ever. A vehicle, a conveyor, a fan, a flywheel and an indexing table may go on from wherever they
are; an arm, a hoist, a screw, a rack and a table that gravity pulls round may not: each further cycle would start
farther on, the arm of a crane over its own base, and what is sized for is the first cycle alone.
"""

from __future__ import annotations

import math

from drivesizer.loads.course import course
from drivesizer.loads.profile import profile_of
from drivesizer.spec.loads import Arm, RotaryTable
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

__all__ = ["not_returning", "starts_farther_on"]

_ROUNDING = 1e-6  # of the way: a recording is no more exact
_TURN = 2.0 * math.pi


def not_returning(spec: RobotSpec) -> tuple[str, ...]:
    """A warning for each load case that does not come back to where it started.

    Parameters
    ----------
    spec
        The machine with its load cases.
    """
    return tuple(line for name, case in spec.load_cases for line in starts_farther_on(name, case))


def starts_farther_on(name: str, spec: RobotSpec) -> tuple[str, ...]:
    """The same of one load case, with its name; empty where it comes back, or need not."""
    off = _off(spec)
    return (_told(name, off, spec),) if off else ()


def _told(name: str, off: float, spec: RobotSpec) -> str:
    way = show(abs(off), "deg", "angle", 3) if spec.load.axis == "rotary" else show(abs(off), "mm", "length", 3)
    of = f" of load case {name}" if name else ""
    side = "beyond" if off > 0.0 else "short of"
    return (
        f"the motion{of} ends {way} {side} where it starts, and the cycle repeats: bring it back "
        "(there_and_back: true), or every cycle starts farther on than the one that is sized for"
    )


def _off(spec: RobotSpec) -> float:
    """How far the end of a cycle is from its start [m or rad]; 0 where that does not matter."""
    load = spec.load
    pulled = isinstance(load, RotaryTable) and load.mass * load.eccentricity * math.sin(load.tilt) != 0.0
    if not load.has_end and not pulled:
        return 0.0
    moved = course(profile_of(spec))
    way = moved.duration * moved.speed.mean(axis=1)
    off = float(way.sum())
    if isinstance(load, Arm | RotaryTable):  # a whole turn brings them back
        off -= _TURN * round(off / _TURN)
    return off if abs(off) > _ROUNDING * float(abs(way).sum()) else 0.0
