"""A platform driven along a trajectory: the requirements at each of its wheels."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError
from drivesizer.files.text import missing
from drivesizer.load_cases.platform_wheels import cycles_of, dynamics_of, ground_of, trajectory_of
from drivesizer.load_cases.requirements import requirements
from drivesizer.physics.load_cycle import LoadCycle, OwnLimit
from drivesizer.platform.dynamics import wheel_torques
from drivesizer.platform.kinematics import map_columns
from drivesizer.platform.motion import motion
from drivesizer.platform.trajectory import Trajectory
from drivesizer.results.requirement import Requirement
from drivesizer.spec.motions import Track, Waypoints
from drivesizer.spec.robot import RobotSpec

__all__ = ["Driving", "Wheel", "driving", "over_time", "with_trajectory"]

Array = NDArray[np.float64]


class Wheel(NamedTuple):
    """A driven wheel along the trajectory."""

    number: int
    cycle: LoadCycle
    requirements: tuple[Requirement, ...]

    @property
    def grip(self) -> OwnLimit | None:
        """Its force on the floor where that is largest beside the grip."""
        return next(iter(self.cycle.own), None)


@dataclass(frozen=True, slots=True)
class Driving:
    """A platform along its trajectory."""

    spec: RobotSpec  # whose motion the trajectory is
    trajectory: Trajectory
    wheels: tuple[Wheel, ...]


def with_trajectory(spec: RobotSpec, file: Path | None, failed: Sequence[int] = ()) -> RobotSpec:
    """The spec with a trajectory as its motion, in one load case.

    Parameters
    ----------
    spec
        With a platform.
    file
        The trajectory; that of the spec's own motion when not given.
    failed
        Wheels whose motor has failed, by number; those of the spec when none is given.

    Returns
    -------
    RobotSpec
        The machine with that motion, and no other load case.

    Raises
    ------
    InputError
        When the spec has no platform, or neither it nor a file names a trajectory.
    """
    if spec.platform is None:
        raise InputError(f"{spec.where(())}: no section platform; expected one, e.g. platform: {{layout: ...}}")
    if file is None and not isinstance(spec.motion, Track | Waypoints):
        raise InputError(
            "TRAJECTORY.CSV is missing and the spec's motion is none; expected e.g. drivesizer drive robot.yaml a.csv"
        )
    if file is not None and (reason := missing(file)):
        raise InputError(f"{file}: cannot be read ({reason})")
    motion = spec.motion if file is None else Track(profile="trajectory", trajectory=_relative_path(spec, file))
    platform = spec.platform
    if failed:
        wheels = len(platform.places)
        wrong = [number for number in failed if not 1 <= number <= wheels]
        if wrong:
            raise InputError(f"--failed: there is no wheel {wrong[0]}; expected 1 to {wheels}")
        platform = platform.model_copy(update={"failed": list(failed)})
    return spec.alone(motion=motion, platform=platform)


def _relative_path(spec: RobotSpec, file: Path) -> str:
    """A file's path from the folder of the spec, where it is in there."""
    folder = Path(spec.file).absolute().parent if spec.file else Path.cwd()
    whole = file.absolute()
    return str(whole.relative_to(folder) if whole.is_relative_to(folder) else whole)


def driving(spec: RobotSpec) -> Driving:
    """Load cycle and requirements of each wheel of a platform along its trajectory.

    Parameters
    ----------
    spec
        Of ``with_trajectory``.

    Raises
    ------
    InputError
        When the trajectory is wrong, or the wheels do not allow it.
    """
    d, trajectory = dynamics_of(spec), trajectory_of(spec)
    assert trajectory is not None
    wheels = (
        Wheel(place + 1, cycle, tuple(requirements([cycle])))
        for place, cycle in zip(d.kinematics.driven, cycles_of(spec, d, trajectory), strict=True)
    )
    return Driving(spec, trajectory, tuple(wheels))


def over_time(found: Driving) -> dict[str, tuple[Array, str, str]]:
    """Posture, velocity, speed and torque of each driven wheel: by name columns with their kind and unit of the trade.

    Torques are those of the load at the wheel's shaft; where one jumps there are two rows of one time.
    """
    d, trajectory = dynamics_of(found.spec), found.trajectory
    seen = motion(d, trajectory, ground_of(found.spec))
    ends = np.cumsum(seen.duration)
    time = np.stack([np.append(0.0, ends[:-1]), ends], axis=1)
    E = d.kinematics.E[list(d.kinematics.driven)]
    torque = wheel_torques(d, seen.eta, seen.eta_dot, theta=seen.facing, ground=seen.ground, towards=seen.towards,
                           rotors=False)  # fmt: skip
    columns = dict(_columns(time, trajectory.at(time.reshape(-1)), seen.eta, map_columns(E, seen.eta), torque, found))
    keep = _different(np.array([column for column, *_ in columns.values()]))
    return {name: (column[keep], kind, unit) for name, (column, kind, unit) in columns.items()}


def _columns(
    time: Array, posture: Array, eta: Array, speed: Array, torque: Array, found: Driving
) -> Iterator[tuple[str, tuple[Array, str, str]]]:
    yield "time", (time.reshape(-1), "time", "s")
    for name, row, kind, unit in zip(("x", "y", "heading"), posture, _PLACES, ("m", "m", "deg"), strict=True):
        yield name, (row, kind, unit)
    for name, row, (kind, unit) in zip(("forwards", "to_the_left", "turning"), eta, _VELOCITIES, strict=True):
        yield name, (row.reshape(-1), kind, unit)
    for wheel, one, other in zip(found.wheels, speed, torque, strict=True):
        yield f"speed_{wheel.number}", (one.reshape(-1), "rotary_speed", "rpm")
        yield f"torque_{wheel.number}", (other.reshape(-1), "torque", "N*m")


_PLACES = ("length", "length", "angle")
_VELOCITIES = (("speed", "m/s"), ("speed", "m/s"), ("rotary_speed", "rpm"))


def _different(rows: Array) -> NDArray[np.bool_]:
    """Columns of a table that differ from the one before."""
    return np.append(True, (np.diff(rows, axis=1) != 0.0).any(axis=0))
