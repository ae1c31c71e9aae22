"""From the spec to the load cycles of its load cases: motion profiles, load cycles, wheels of a platform.

May import: files, physics, equations, platform, loads, spec, results.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from drivesizer.errors import FieldError, InputError
from drivesizer.files.csv_columns import beside
from drivesizer.load_cases.profile import profile_of
from drivesizer.load_cases.wheel import WheelLoad
from drivesizer.loads.course import Course, Profile, course
from drivesizer.loads.kinds import LAWS
from drivesizer.loads.recorded import Recorded, recorded
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.spec.robot import RobotSpec

__all__ = ["load_cycle", "of_course"]


def load_cycle(spec: RobotSpec, profile: Profile | None = None) -> LoadCycle:
    """Load cycle at the driven shaft of one drive.

    Parameters
    ----------
    spec
        The machine.
    profile
        Its motion; the spec's own when not given.

    Returns
    -------
    LoadCycle
        Speed, acceleration and torque of the shaft over one cycle, the belt's inertia included.

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
    load = spec.load
    if isinstance(load, WheelLoad):
        return load.cycle
    if isinstance(load, Recorded):
        with _located(spec):
            return recorded(load, beside(spec.file, load.file, spec.where(("load", "file"))))
    return of_course(spec, course(profile or profile_of(spec)))


def of_course(spec: RobotSpec, course: Course) -> LoadCycle:
    """The load cycle at the driven shaft of one drive, of any load but a recording, without the belt's inertia.

    Parameters
    ----------
    spec
        The machine.
    course
        How its load moves.

    Returns
    -------
    LoadCycle
        Of the load alone.

    Raises
    ------
    InputError
        When the load cannot follow, or a figure leaves the range of numbers that can be computed with.
    """
    with _located(spec):
        cycle = LAWS[spec.load.kind](spec.load, spec.environment.gravity, course)
    return replace(cycle, own=()) if spec.platform else cycle  # a platform's own checks know more


@contextmanager
def _located(spec: RobotSpec) -> Iterator[None]:
    """Errors of a field with its file and line."""
    try:
        yield
    except FieldError as error:
        raise InputError(f"{spec.where(error.field)}: {error}") from None
