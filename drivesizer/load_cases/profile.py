"""The required motion of a spec's load over one cycle, and the rest in which it waits for other axes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import pairwise

import numpy as np

from drivesizer.errors import FieldError, InputError, quoted
from drivesizer.files.csv_columns import path_from_spec
from drivesizer.loads import motions
from drivesizer.loads.course import Profile
from drivesizer.physics.figures import Alike, Figure
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.spec.robot import RobotSpec

# -- An axis that waits at rest, its motion done, until the cycle of its machine is over: the rest at the end of its
# own.
#
# A load with a motion is held as its law says of a rest; a recording, or a load that comes with its cycle, by the
# torque of the rest that ends it, or by what its last moment leaves without the torque that decelerates it, friction
# included.


_NO_TIME = 1e-9  # of the cycle


def static_torque(cycle: LoadCycle) -> Alike:
    """Torque that holds a load at the end of its motion [N*m]; NaN where an inertia that decelerates is unknown."""
    torque, acceleration = cycle.torque[-1, 1], cycle.acceleration[-1, 1]
    slowing = np.where(acceleration == 0.0, 0.0, cycle.inertia * acceleration)
    return float(torque - slowing) if cycle.duration.ndim == 1 else torque - slowing


def with_rest(cycle: LoadCycle, until: float | None, held: Figure) -> LoadCycle:
    """A load cycle with a rest at its end."""
    rest = rest_left(cycle.total, until)
    if not np.any(rest) or np.any(np.isnan(held)):
        return cycle
    still = np.zeros_like(cycle.speed[:1])
    return replace(
        cycle,
        duration=np.concatenate([cycle.duration, np.reshape(rest, cycle.duration[:1].shape)]),
        speed=np.concatenate([cycle.speed, still]),
        acceleration=np.concatenate([cycle.acceleration, np.zeros_like(cycle.acceleration[:1])]),
        torque=np.concatenate([cycle.torque, np.zeros_like(cycle.torque[:1]) + held]),
    )


def resting(profile: Profile, until: float | None) -> Profile:
    """A motion with a rest at its end, the payload still that of its last piece.

    >>> resting(Profile("x", (0.0, 1.0, 3.0), (0.0, 2.0, 0.0)), 5.0)
    Profile(name='x', time=(0.0, 1.0, 3.0, 5.0), speed=(0.0, 2.0, 0.0, 0.0), acceleration=None, payload=None, ends=None)
    """
    rest = rest_left(profile.duration, until)
    if until is None or not np.any(rest):
        return profile
    end = profile.time[0] + until
    ends, slope = profile.ends, profile.acceleration
    if ends is None and slope is not None:
        ends = tuple(pairwise(slope))
    return replace(
        profile,
        time=(*profile.time, np.maximum(end, profile.time[-1]) if np.ndim(rest) else end),
        speed=(*profile.speed, 0.0),
        acceleration=None,
        ends=None if ends is None else (*ends, (0.0, 0.0)),
        payload=None if profile.payload is None else (*profile.payload, profile.payload[-1]),
    )


def rest_left(total: Figure, until: float | None) -> Alike:
    """Time that an axis waits."""
    if until is None:
        return 0.0
    rest = np.where(until - total <= _NO_TIME * until, 0.0, until - total)
    return rest if rest.ndim else float(rest)


def profile_of(spec: RobotSpec) -> Profile:
    """The spec's motion as a profile, with the rest in which it waits for other axes of its machine."""
    motion = spec.motion
    if motion is None:
        raise InputError(f"motion: a {spec.load.kind} load brings its own; there is no profile of it")
    with located(spec):
        if isinstance(motion, motions.Csv | motions.Cam):
            path = path_from_spec(spec.file, motion.file, spec.where(("motion", "file")))
            if isinstance(motion, motions.Csv):
                made = motions.from_csv(path, motions.SPEED[spec.load.axis][0])
            else:
                made = motions.cam(path, motion, "angle" if spec.load.axis == "rotary" else "length")
            made = replace(made, name=motion.file)
        else:
            made = motions.over_time(motion)
    return resting(made, spec.waits_until)


@contextmanager
def located(spec: RobotSpec, *path: str | int) -> Iterator[None]:
    """Say of what is wrong inside where the spec has it: the field that it names itself, else that of the path."""
    try:
        yield
    except InputError as error:
        field = error.field if isinstance(error, FieldError) else path
        if not field:
            raise
        raise InputError(f"{spec.where(field)}: {str(error).removeprefix(f'{field[-1]}: ')}") from None


def profile(spec: RobotSpec, name_or_file: str) -> Profile:
    """The profile that a name or a file stands for.

    Parameters
    ----------
    spec
        What is moved, and its motion.
    name_or_file
        The kind of the spec's motion, such as ``trapezoid``; ``s-curve`` also for a trapezoid, which then
        has rounded ramps; or a file that ends in ``.csv``.

    Returns
    -------
    Profile
        Speed of the load over one cycle.

    Raises
    ------
    InputError
        When it is none of them, or the file is wrong.
    """
    names = [kind.replace("_", "-") for kind in motions.MADE]
    own = (spec.motion.profile if spec.motion else spec.load.kind).replace("_", "-")
    if name_or_file.lower().endswith(".csv"):
        return motions.from_csv(name_or_file, motions.SPEED[spec.load.axis][0])
    if name_or_file not in names:
        raise InputError(
            f"profile {quoted(name_or_file)} is not known; expected {', '.join(names)} or a file that ends in .csv"
        )
    if name_or_file == own:
        return profile_of(spec)
    if name_or_file == "s-curve" and isinstance(spec.motion, motions.Trapezoid):
        with located(spec):
            return resting(motions.carrying(motions.rounded(spec.motion), spec.motion), spec.waits_until)
    raise InputError(f"profile {quoted(name_or_file)}: the spec's motion is {own}; expected that or a file (.csv)")
