"""A platform on its trajectory as load cases: one for each driven wheel; and any load as inertia at its shaft."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError
from drivesizer.files.sheets import path_from_spec
from drivesizer.files.text import missing
from drivesizer.load_cases import cycle_of_course, driven_shaft_cycle, load_cycle, located, profile_of, requirements
from drivesizer.loads.course import Course, Profile
from drivesizer.loads.hoist import Hoist
from drivesizer.loads.motions import Track, Waypoints
from drivesizer.loads.recorded import ComputedLoad, Recorded
from drivesizer.loads.wheeled_vehicle import (
    WheeledVehicle,
    rolling_resistance,
    through_running_gear,
    turning_inertia,
    wheel_friction,
)
from drivesizer.physics.load_cycle import Ends, LoadCycle, OwnLimit, rms
from drivesizer.platform import kinematics as on_wheels
from drivesizer.platform.dynamics import Dynamics, Ground, contact_loads, dynamics, motion, own_rolling, wheel_torques
from drivesizer.platform.kinematics import map_columns
from drivesizer.platform.planner import Limits, Waypoint, plan, read_track
from drivesizer.platform.stability import wheel_cycles
from drivesizer.platform.trajectory import Trajectory
from drivesizer.results.drive_set import Requirement
from drivesizer.spec.platform import Platform
from drivesizer.spec.robot import AS_SPECIFIED, RobotSpec
from drivesizer.units import show

# -- The platform of a spec as the record that kinematics and dynamics take: section and load put together.


def platform_of(section: Platform, load: WheeledVehicle, rotor_inertia: float = 0.0) -> on_wheels.Platform:
    """The platform with its payloads, of the load's mass."""
    driven = sum(place.driven for place in section.places)
    if driven != load.driven_wheels:
        raise InputError(f"platform: {driven} of its wheels are driven, load.driven_wheels is {load.driven_wheels}")
    C_rr = rolling_resistance(load)
    common = {"inertia": turning_inertia(load), "rolling_resistance": C_rr}
    wheels = []
    for place in section.places:
        w = place.record(load.wheel_diameter / 2, **common)
        roller = 0.0 if w.held else (section.sliding_friction or 0.0) if w.slides else section.roller_resistance
        rotor = rotor_inertia if w.drive == "motor" else 0.0
        wheels.append(replace(w, rotor_inertia=rotor, roller_resistance=roller))
    centre, own = section.centre_of_mass, _own_mass(section, load)
    casters = [
        on_wheels.Caster(
            x=c.x, y=c.y, rolling_resistance=C_rr if c.rolling_resistance is None else c.rolling_resistance
        )
        for c in section.casters
    ]
    inertia = box_inertia(section, own) if section.inertia is None else section.inertia
    whole = on_wheels.Platform(
        wheels=tuple(wheels), mass=own, inertia=inertia, x=centre.x, y=centre.y, height=centre.height or 0.0,
        casters=tuple(casters),
    )  # fmt: skip
    for p in section.payloads:
        carried = on_wheels.Payload(mass=p.mass, x=p.x, y=p.y, height=p.height or 0.0, inertia=p.inertia)
        whole = on_wheels.loaded(whole, carried)
    for number in dict.fromkeys(section.failed):
        whole = on_wheels.without_motor(whole, number, blocked=section.blocked)
    return whole


def _own_mass(section: Platform, load: WheeledVehicle) -> float:
    """Mass of the robot without its payloads [kg]."""
    carried = sum(p.mass for p in section.payloads)
    if not carried < load.mass:
        payload, of_all = show(carried, "kg", "mass"), show(load.mass, "kg", "mass")
        raise InputError(f"platform: payloads of {payload} leave nothing of load.mass, {of_all}, which includes them")
    return load.mass - carried


def box_inertia(section: Platform, mass: float) -> float:
    """Inertia of a homogeneous box of the robot's size about its vertical axis, m (L² + W²) / 12 [kg*m^2]."""
    assert section.size is not None
    return mass * (section.size.length**2 + section.size.width**2) / 12.0


def platform_assumptions(section: Platform, load: WheeledVehicle) -> tuple[str, ...]:
    """Assumptions about the platform where the spec gives no figure, as sentences."""
    sentences = []
    if section.inertia is None:
        inertia = show(box_inertia(section, _own_mass(section, load)), "kg*m^2", "inertia")
        sentences.append(f"The robot's inertia is that of a homogeneous box of its size without payloads, {inertia}.")
    if not section.height_known:
        sentences.append(
            "The height of the centre of mass is not given: wheels are taken to carry what they do at rest."
        )
    if any(not place.driven for place in section.places):
        sentences.append("A wheel without a drive has the inertia of one with.")
    if any(c.rolling_resistance is None for c in section.casters):
        sentences.append("Casters roll as hard as the wheels.")
    return tuple(sentences)


# -- One driven wheel of a platform on its trajectory, as the load of a drive: computed, not recorded.


class WheelLoad(ComputedLoad):
    """The load cycle of a wheel, or of several with equal load cycles."""

    is_wheel: ClassVar[bool] = True

    numbers: tuple[int, ...]  # of these among the driven wheels, from 0
    distance: float  # m, that the platform travels in the cycle
    of: str  # the load case of the platform that it belongs to
    rolling_torque: float  # N*m, of rolling on a level floor, in either direction

    @property
    def alike(self) -> int:
        """Number of wheels with this load cycle."""
        return len(self.numbers)


# -- A platform on its trajectory as load cases: one for each driven wheel, wheels with equal load cycles as one.
#
# A drive is sized for all of them: for the worst wheel. What the supply and the battery give is shared by all
# wheels; the checks of the supply take every wheel as the one of the case, the battery's add up what each draws.


_SAME = 1e-9  # of the largest figure


def trajectory_of(spec: RobotSpec) -> Trajectory | None:
    """The trajectory of the platform; None where the spec's motion is none."""
    motion = spec.motion
    if isinstance(motion, Track):
        with located(spec):
            path = path_from_spec(spec.file, motion.trajectory, ("motion", "trajectory"))
        return read_track(path, limits_of(spec), motion.smoothing, spec.where(("motion", "smoothing")))
    if isinstance(motion, Waypoints):
        limits = limits_of(spec)
        if limits is None:
            where = spec.where(("platform", "limits"))
            raise InputError(f"{where}: expected speed and acceleration to plan the waypoints with, e.g. speed: 1 m/s")
        points = [Waypoint(**dict(point)) for point in motion.waypoints]
        with located(spec, "motion", "waypoints"):
            return plan(points, limits)
    return None


def limits_of(spec: RobotSpec) -> Limits | None:
    """Limits of the platform's motion; None where speed or acceleration is not given."""
    limits = spec.platform.limits if spec.platform else None
    if limits is None or limits.speed is None or limits.acceleration is None:
        return None
    with located(spec, "platform", "limits"):
        return Limits(**dict(limits))


def dynamics_of(spec: RobotSpec, rotor_inertia: float = 0.0) -> Dynamics:
    """Kinematics and dynamics of a spec's platform."""
    assert spec.platform is not None and isinstance(spec.load, WheeledVehicle)
    with located(spec, "platform"):
        return dynamics(platform_of(spec.platform, spec.load, rotor_inertia))


def ground_of(spec: RobotSpec) -> Ground:
    """The floor that a spec's platform stands on."""
    assert spec.platform is not None and isinstance(spec.load, WheeledVehicle)
    return Ground(slope=spec.load.slope, uphill=spec.platform.uphill, gravity=spec.environment.gravity)


def floor_friction(spec: RobotSpec, force: float) -> float:
    """Force that friction transmits at a driven wheel of a vehicle straight on, of a platform at its worst [N]."""
    load, section, g = spec.load, spec.platform, spec.environment.gravity
    assert isinstance(load, WheeledVehicle)
    if section is None:
        return float(wheel_friction(load, g))
    if load.friction_coefficient is None or not section.height_known:
        return math.nan
    p = platform_of(section, load)
    gains = np.array([1.0, -1.0]) * load.driven_wheels * force / p.mass - g * math.sin(load.slope)
    ground = Ground(slope=load.slope, gravity=g)
    carried = contact_loads(p, 0.0, ground, (gains, 0.0 * gains))[: len(p.wheels)].min(axis=1)
    loads = [n * math.cos(w.roller_angle) for n, w in zip(carried, p.wheels, strict=True) if w.drive == "motor"]
    return load.friction_coefficient * max(float(min(loads)), 0.0)


def wheels(name: str, case: RobotSpec) -> Iterator[tuple[str, RobotSpec]]:
    """A load case of a platform as those of its wheels, the one of the largest RMS torque first."""
    if not isinstance(case.motion, Track | Waypoints):
        yield name, case
        return
    d, trajectory = dynamics_of(case), trajectory_of(case)
    assert trajectory is not None and isinstance(case.load, WheeledVehicle)
    cycles, driven = cycles_of(case, d, trajectory), d.kinematics.driven
    groups: list[list[int]] = []  # wheels with equal load cycles, in either direction of turning
    for i, cycle in enumerate(cycles):
        group = next((members for members in groups if _alike(cycles[members[0]], cycle)), None)
        if group is None:
            groups.append([i])
        else:
            group.append(i)
    rolling = own_rolling(d, contact_loads(d.platform, ground=Ground(gravity=case.environment.gravity)))
    for alike in sorted(groups, key=lambda group: -rms(cycles[group[0]].duration, cycles[group[0]].torque)):
        *others, last = (str(driven[i] + 1) for i in alike)
        which = f"wheels {', '.join(others)} and {last}" if others else f"wheel {last}"
        worst = [max(limits, key=_tightness) for limits in zip(*(cycles[i].own for i in alike), strict=True)]
        load = WheelLoad.with_cycle(
            replace(cycles[alike[0]], own=tuple(worst)), case.load.driven_wheels, numbers=tuple(alike),
            distance=trajectory.length, of=name, rolling_torque=float(rolling[driven[alike[0]]]),
        )  # fmt: skip
        yield (which if name in ("", AS_SPECIFIED) else f"{name}, {which}"), case.alone(load=load, motion=None)


def _alike(a: LoadCycle, b: LoadCycle) -> bool:
    """Whether two load cycles are the same but for the direction of turning."""
    if len(a.duration) != len(b.duration) or not np.allclose(a.duration, b.duration, rtol=_SAME, atol=0.0):
        return False

    def near(column: Ends, other: Ends) -> bool:
        return bool(np.abs(column - other).max() <= _SAME * max(np.abs(column).max(), np.abs(other).max()))

    return any(near(a.speed, sign * b.speed) and near(a.torque, sign * b.torque) for sign in (1.0, -1.0))


def _tightness(own: OwnLimit) -> float:
    return float(own.demand / own.limit if own.limit > 0.0 else np.inf if own.limit <= 0.0 else own.demand)


def cycles_of(case: RobotSpec, d: Dynamics, trajectory: Trajectory) -> tuple[LoadCycle, ...]:
    """The load cycle of each driven wheel of a platform on its trajectory, with the grip that it needs.

    What takes load off a wheel is a matter of the machine, whatever drives it: see ``budgets``.
    """
    load = case.load
    assert isinstance(load, WheeledVehicle)
    known = case.platform is not None and case.platform.height_known  # else nobody knows what a wheel carries
    friction = load.friction_coefficient if known else None
    with located(case, "motion"):
        cycles = wheel_cycles(d, trajectory, ground_of(case), friction=friction)
    return tuple(through_running_gear(load, cycle) for cycle in cycles)


# -- A platform driven along a trajectory: the requirements at each of its wheels.


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
    motion = spec.motion
    if file is not None:  # by its path from the folder of the spec, where it is in there
        folder, whole = Path(spec.file).absolute().parent if spec.file else Path.cwd(), file.absolute()
        path = whole.relative_to(folder) if whole.is_relative_to(folder) else whole
        motion = Track(profile="trajectory", trajectory=str(path))
    platform = spec.platform
    if failed:
        wheels = len(platform.places)
        wrong = [number for number in failed if not 1 <= number <= wheels]
        if wrong:
            raise InputError(f"--failed: there is no wheel {wrong[0]}; expected 1 to {wheels}")
        platform = platform.model_copy(update={"failed": list(failed)})
    return spec.alone(motion=motion, platform=platform)


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
    cycles = zip(d.kinematics.driven, cycles_of(spec, d, trajectory), strict=True)
    return Driving(spec, trajectory, tuple(Wheel(n + 1, cycle, tuple(requirements([cycle]))) for n, cycle in cycles))


def over_time(driving: Driving) -> dict[str, tuple[Array, str, str]]:
    """Posture, velocity, speed and torque of each driven wheel: by name columns with their kind and unit of the trade.

    Torques are those of the load at the wheel's shaft; where one jumps there are two rows of one time.
    """
    d, trajectory = dynamics_of(driving.spec), driving.trajectory
    seen = motion(d, trajectory, ground_of(driving.spec))
    edges = np.append(0.0, np.cumsum(seen.duration))
    time = np.stack([edges[:-1], edges[1:]], axis=1)
    E = d.kinematics.E[list(d.kinematics.driven)]
    torques = wheel_torques(d, seen, rotors=False)
    x, y, heading = trajectory.at(time.reshape(-1))
    forwards, aside, turning = seen.eta
    columns: dict[str, tuple[Array, str, str]] = {
        "time": (time, "time", "s"),
        "x": (x, "length", "m"), "y": (y, "length", "m"), "heading": (heading, "angle", "deg"),
        "forwards": (forwards, "speed", "m/s"), "to_the_left": (aside, "speed", "m/s"),
        "turning": (turning, "rotary_speed", "rpm"),
    }  # fmt: skip
    for wheel, speed, torque in zip(driving.wheels, map_columns(E, seen.eta), torques, strict=True):
        columns[f"speed_{wheel.number}"] = (speed, "rotary_speed", "rpm")
        columns[f"torque_{wheel.number}"] = (torque, "torque", "N*m")
    rows = np.array([column.reshape(-1) for column, *_ in columns.values()])
    keep = np.append(True, (np.diff(rows, axis=1) != 0.0).any(axis=0))  # those that differ from the one before
    return {name: (row[keep], *unit) for row, (name, (_, *unit)) in zip(rows, columns.items(), strict=True)}


# -- The load as inertia and torques at the shaft, for the closed loop, where the motion is not known beforehand.
#
# A load cycle says what torque a motion takes; in closed loop the motion is the result. So the load is split into
# a part that depends on the shaft alone and a remainder over time:
#
# .. math:: T = J \dot w + T_{dir} + T_r(t)
#
# J is the inertia at the shaft. T_dir are three constants, at the start of the motion: creeping forward, creeping
# backward and at rest; between the latter two friction holds. They come from the load's own torque law, so that no
# formula is repeated here. T_r is the torque of the cycle beyond both, such as the changing weight of a swinging
# arm, wind, or losses of a screw's acceleration; it acts at its time, whatever the drive does. Convention: as in
# ``load_cycle``; torque is positive when it resists forward motion.


_CREEP = 1e-9  # m/s or rad/s: no drag to speak of, and a direction
_NOTHING = 1e-12  # of the largest torque: what rounding leaves


class AtShaft(NamedTuple):
    """A load as seen from the driven shaft of one drive."""

    inertia: float  # kg*m^2
    radius: float  # m, travel of the load per angle of the shaft; 1 where it turns with it
    forward_torque: float  # N*m that resists when it creeps forward
    backward_torque: float  # N*m, the same backward: below the forward one by friction
    rest_torque: float  # N*m without friction: weight

    def along(self, direction: Any) -> Any:
        """Torque that resists in a direction of motion [N*m]: 1, -1, or 0 at rest."""
        moving = np.where(direction > 0.0, self.forward_torque, self.backward_torque)
        return np.where(direction == 0.0, self.rest_torque, moving)


@np.errstate(all="ignore")  # what leaves the range of numbers is refused with the drive train
def at_shaft(spec: RobotSpec, position: float = 0.0) -> AtShaft:
    """Inertia and torques of a spec's load at the shaft, in a position of its path [m or rad]."""

    def creeping(speed: float) -> LoadCycle:
        """A second at a speed; of a recording without its torque."""
        ends, still, load = np.full((1, 2), speed), np.zeros((1, 2)), spec.load
        if isinstance(load, Recorded):
            rolling = load.rolling_torque if isinstance(load, WheelLoad) else 0.0
            torque = np.full((1, 2), math.copysign(rolling, speed) if speed else 0.0)
            alone = LoadCycle("creeping", np.ones(1), ends, still, torque, load.shaft_inertia)
        else:
            alone = cycle_of_course(
                spec, Course("creeping", np.ones(1), position + np.array([[0.0, speed]]), ends, still)
            )
        return driven_shaft_cycle(spec, alone)

    forward = creeping(_CREEP)
    try:
        backward = float(creeping(-_CREEP).torque[0, 0])
    except InputError:
        if not isinstance(spec.load, Hoist):
            raise
        backward = 0.0  # friction outweighs the load: its rope hangs slack and pulls with nothing
    first, rest = (float(cycle.torque[0, 0]) for cycle in (forward, creeping(0.0)))
    return AtShaft(float(forward.inertia), float(forward.radius), first, backward, rest)


def motion_of(spec: RobotSpec) -> Profile:
    """The motion profile of a spec; that of the shaft where the load is of no fixed radius, or a recording."""
    if not spec.load.of_shaft:
        return profile_of(spec)
    cycle = load_cycle(spec)
    time = np.append(cycle.time[:, 0], cycle.total)
    speed = np.append(cycle.speed[:, 0], cycle.speed[-1, 1])
    return Profile(cycle.name, tuple(time.tolist()), tuple(speed.tolist()))


def remaining_torque(spec: RobotSpec, profile: Profile, shaft: AtShaft) -> NDArray[np.float64]:
    """Torque of a motion beyond inertia and the constants of its direction: rows of rising time and torque."""
    cycle = load_cycle(spec, None if spec.load.of_shaft else profile)
    known = shaft.along(cycle.direction) + shaft.inertia * cycle.acceleration
    largest = float(np.abs(cycle.torque).max() + np.abs(known).max())
    left = cycle.torque - known
    left[np.abs(left) <= _NOTHING * largest] = 0.0
    if not left.any():
        return np.empty((0, 2))
    level = np.abs(left[:, 1] - left[:, 0]) <= _NOTHING * largest
    left[level, 1] = left[level, 0]
    small = _NOTHING * largest
    edges = profile.time[0] + np.concatenate([[0.0], np.cumsum(cycle.duration)])
    time = np.stack([edges[:-1], edges[1:]], axis=1)
    meets = np.append(np.abs(left[1:, 0] - left[:-1, 1]) <= small, False)  # one row is enough for two ends
    time[:-1, 1] = np.maximum(np.nextafter(time[:-1, 1], -math.inf), time[:-1, 0])
    distinct = np.stack([np.ones(len(meets), bool), ~meets], axis=1).ravel()
    rows: NDArray[np.float64] = np.stack([time, left], axis=2).reshape(-1, 2)[distinct]
    return rows[np.append(np.diff(rows[:, 0]) > 0.0, True)]
