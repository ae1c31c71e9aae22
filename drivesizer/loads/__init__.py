"""Machines as load cycles: one file per kind of load, each a function that returns a ``LoadCycle``.

May import: files, physics, equations, platform, spec, results.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module

from drivesizer.loads.course import Course, course
from drivesizer.loads.profile import Profile, profile_of
from drivesizer.loads.wheel import WheelLoad
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.spec.loads import MODULES
from drivesizer.spec.robot import RobotSpec

__all__ = ["load_cycle", "of_course"]


def load_cycle(spec: RobotSpec, profile: Profile | None = None) -> LoadCycle:
    """What the driven shaft of one motor set is asked for.

    Parameters
    ----------
    spec
        The machine.
    profile
        Its motion; the spec's own when not given.

    Raises
    ------
    InputError
        When a figure leaves the range of numbers that can be computed with, or a recording is wrong.
    """
    cycle = _of_the_load(spec, profile)
    added = spec.belt.inertia if spec.belt else 0.0
    if added == 0.0:
        return cycle
    torque = cycle.torque + added * cycle.acceleration
    own = tuple(one._replace(turning=one.turning + added) for one in cycle.own)
    return replace(cycle, torque=torque, inertia=cycle.inertia + added, own=own).split()


def _of_the_load(spec: RobotSpec, profile: Profile | None) -> LoadCycle:
    """The cycle without the belt's own inertia."""
    if isinstance(spec.load, WheelLoad):
        return spec.load.cycle
    if spec.load.kind == "recorded":
        from drivesizer.loads.recorded import recorded

        return recorded(spec)
    return of_course(spec, course(profile or profile_of(spec)))


def of_course(spec: RobotSpec, course: Course) -> LoadCycle:
    """What a load that is not a recording asks of the driven shaft of one motor set, the belt's own inertia apart.

    Raises
    ------
    InputError
        When a figure leaves the range of numbers that can be computed with.
    """
    name = MODULES[spec.load.kind]
    function: Callable[[RobotSpec, Course], LoadCycle] = getattr(import_module(f"drivesizer.loads.{name}"), name)
    return function(spec, course)
