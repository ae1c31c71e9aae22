"""From the spec to the load cycles of its load cases, and what these require of a drive.

May import: files, physics, equations, platform, loads, spec, results.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import reduce
from itertools import pairwise
from typing import Any

import numpy as np

from drivesizer.errors import FieldError, InputError, quoted
from drivesizer.files.sheets import path_from_spec
from drivesizer.loads import LAWS, MODULES, motions
from drivesizer.loads.course import Course, Profile, course
from drivesizer.loads.screw import screw_life
from drivesizer.loads.springs import Lever, spring_force, with_springs
from drivesizer.loads.stage_losses import force_along, through_gear
from drivesizer.physics.figures import Alike, Figure
from drivesizer.physics.load_cycle import LoadCycle, OwnLimit, end_times, mean_product, rms
from drivesizer.results.drive_set import Requirement
from drivesizer.spec.drive import BeltStage
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


def with_rest(cycle: LoadCycle, until: float | None, holding_torque: Figure) -> LoadCycle:
    """A load cycle with a rest at its end."""
    rest = rest_left(cycle.total, until)
    if not np.any(rest) or np.any(np.isnan(holding_torque)):
        return cycle
    still = np.zeros_like(cycle.speed[:1])
    return replace(
        cycle,
        duration=np.concatenate([cycle.duration, np.reshape(rest, cycle.duration[:1].shape)]),
        speed=np.concatenate([cycle.speed, still]),
        acceleration=np.concatenate([cycle.acceleration, np.zeros_like(cycle.acceleration[:1])]),
        torque=np.concatenate([cycle.torque, np.zeros_like(cycle.torque[:1]) + holding_torque]),
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
            path = path_from_spec(spec.file, motion.file, ("motion", "file"))
            if isinstance(motion, motions.Cam):
                profile = motions.cam(path, motion, motions.TRAVEL[spec.load.axis][0])
            else:
                profile = motions.from_csv(path, motions.SPEED[spec.load.axis][0])
            profile = replace(profile, name=motion.file)
        else:
            profile = motions.over_time(motion)
    return resting(profile, spec.waits_until)


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
    names = [kind.replace("_", "-") for kind in motions.PROFILES]
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


# -- Load cycles at the driven shaft: by the load's torque law, with springs, belt and gears.


_LATEST: dict[str, tuple[RobotSpec, LoadCycle]] = {}  # one, which budgets and battery need again


def load_cycle(spec: RobotSpec, profile: Profile | None = None, *, sampled: bool = False) -> LoadCycle:
    """Load cycle at the driven shaft of one drive.

    Parameters
    ----------
    spec
        The machine; figures of it may be columns over samples.
    profile
        Its motion; the spec's own when not given.
    sampled
        Whether any are: then the cycle has an axis of samples.

    Returns
    -------
    LoadCycle
        Speed, acceleration and torque of the shaft over one cycle, the belt's inertia included.

    Raises
    ------
    InputError
        When a figure leaves the range of numbers that can be computed with, or a recording is wrong.
    """
    if profile is not None or sampled:
        return _load_cycle(spec, profile, sampled)
    latest = _LATEST.get("spec")
    if latest is None or latest[0] is not spec:
        latest = _LATEST["spec"] = spec, _load_cycle(spec, None, False)
    return latest[1]


def _load_cycle(spec: RobotSpec, profile: Profile | None, sampled: bool) -> LoadCycle:
    load: Any = spec.load
    if load.kind == "recorded":
        cycle = getattr(load, "cycle", None)  # that of a machine's joint or wheel, which is computed
        if cycle is None:
            with located(spec):
                path = path_from_spec(spec.file, load.file, ("load", "file"))
                cycle = LAWS[load.kind](load, path)
        holding_torque = cycle.holding_torque
        if sampled and cycle.duration.ndim == 1:
            cycle = cycle.side_by_side()
        cycle = with_rest(_sprung_recording(spec, cycle), spec.waits_until, static_torque(cycle))
    else:
        motion, holding_torque = course(profile or profile_of(spec), sampled=sampled), math.nan
        cycle = cycle_of_course(spec, motion)
        if spec.wants_brake:
            still = heaviest_positions(load.lever, sprung(spec, motion), everywhere=bool(load_springs(spec)))
            holding_torque = np.abs(cycle_of_course(spec, still).torque).max(axis=(0, 1))
    if spec.wants_brake:
        cycle = replace(cycle, holding_torque=holding_torque)
    return driven_shaft_cycle(spec, cycle)


def cycle_of_course(spec: RobotSpec, course: Course) -> LoadCycle:
    """The load cycle at the driven shaft of one drive, of any load but a recording, without the belt's inertia."""
    with located(spec), np.errstate(over="ignore", invalid="ignore"):  # the load cycle refuses what is not finite
        cycle = LAWS[spec.load.kind](spec.load, spec.environment.gravity, sprung(spec, course))
    return replace(cycle, own=()) if spec.platform else cycle  # a platform's own checks know more


def load_springs(spec: RobotSpec) -> Sequence[Any]:
    """Springs and counterweights beside the drives of a load; wheels have none."""
    return getattr(spec.load, "springs", ())


def sprung(spec: RobotSpec, course: Course) -> Course:
    """A course with the force of the load's springs and counterweights."""
    load, gravity = spec.load, spec.environment.gravity
    return with_springs(load_springs(spec), load.lever, gravity, course, turns=load.axis == "rotary")


def _sprung_recording(spec: RobotSpec, cycle: LoadCycle) -> LoadCycle:
    """A recording with springs beside its shaft, as the angle that it has turned through says."""
    springs = load_springs(spec)
    if not springs:
        return cycle
    position = end_times(cycle.duration * cycle.speed.mean(axis=1))
    with located(spec):
        resisting = sum(spring_force(spring, position, cycle.direction) for spring in springs)
    return replace(cycle, torque=cycle.torque + resisting / spec.load.motors).split()


def heaviest_positions(lever: Lever | None, course: Course, *, everywhere: bool = False) -> Course:
    """Course at rest in each position in which gravity may turn the load most, with the payload that it has there.

    Power may be lost at any time, so that is the worst of the whole path. The torque of a mass on a lever goes as the
    cosine of its angle: it is largest at an end of the path, or level wherever the path passes there; with springs it
    may be so ``everywhere``. Of any other load no position is worse than another. A light load may pull harder than a
    heavy one: against a counterweight.
    """
    segments = len(course.duration)
    carried = np.broadcast_to(course.payload, (segments, 1, *np.shape(course.payload)[2:])).reshape(segments, -1)
    payloads, kind = np.unique(carried, axis=0, return_inverse=True)
    positions: list[Any] = []
    weights: list[Any] = []
    for number, payload in enumerate(payloads):
        path = course.position[kind.reshape(-1) == number]
        low, high = path.min(axis=(0, 1)), path.max(axis=(0, 1))
        places = list(path.reshape(-1, *path.shape[2:])) if everywhere else [low, high]
        if lever is not None:
            first, last = (np.ceil((low + lever.start) / math.pi), np.floor((high + lever.start) / math.pi))
            for turn in (first, first + 1.0):
                level = np.where(turn <= last, turn * math.pi - lever.start, low)
                places += [level] if np.any(turn <= last) else []
        positions += np.broadcast_arrays(*places)
        weights += [payload if path.ndim == 2 else payload[None]] * len(places)
    ends = np.repeat(np.stack(np.broadcast_arrays(*positions))[:, None], 2, axis=1)
    still = np.zeros_like(ends)
    lasting = np.ones((len(ends), *[1] * (ends.ndim - 2)))
    return Course("held", lasting, ends, still, still, np.stack(weights))


def driven_shaft_cycle(spec: RobotSpec, cycle: LoadCycle) -> LoadCycle:
    """A load cycle with what the stages at the load add: the belt's inertia and friction, gears of fixed ratio."""
    gears, belt = spec.gears[::-1], spec.belt  # from the load on
    before = belt is not None and spec.gear_before_belt
    if not before:
        return _with_belt(reduce(lambda cycle, gear: through_gear(cycle, gear.fixed_gear()), gears, cycle), belt)
    assert belt is not None
    cycle, limits = _with_belt(cycle, belt), []
    if belt.pulley_diameter is not None:  # of a belt at the load the gear before it takes no part
        radius = belt.pulley_diameter / 2
        if belt.max_tension is not None:
            limits.append(OwnLimit("belt_tension", np.abs(cycle.torque).max(axis=(0, 1)) / radius, belt.max_tension))
        if belt.max_speed is not None:
            limits.append(OwnLimit("belt_speed", np.abs(cycle.speed).max(axis=(0, 1)) * radius, belt.max_speed))
    ratio = 1.0 if belt.ratio is None else belt.ratio
    whole = replace(cycle, own=(*cycle.own, *limits))
    return reduce(lambda cycle, gear: through_gear(cycle, gear.fixed_gear(ratio)), gears, whole)


def _with_belt(cycle: LoadCycle, belt: BeltStage | None) -> LoadCycle:
    """The cycle with inertia and friction of a belt at the same shaft."""
    if belt is None or not (np.any(belt.inertia) or np.any(belt.friction_torque)):
        return cycle
    torque = cycle.torque + belt.inertia * cycle.acceleration
    torque = torque + belt.friction_torque * cycle.direction
    return replace(cycle, torque=torque, inertia=cycle.inertia + belt.inertia).split()


# -- Requirements of loads that the paper does not treat: its quantities, by its names, from the load cycle.


_SPEED, _TORQUE, _POWER = ("rotary_speed", "rpm"), ("torque", "N*m"), ("power", "W")


def requirements(cycles: Sequence[LoadCycle]) -> list[Requirement]:
    """Figures of the load at the driven shaft of one drive, in the worst of its load cases' cycles."""
    by_cycle = []
    for cycle in cycles:
        power, duration = cycle.power, cycle.duration
        torque, speed = (float(np.abs(column).max()) for column in (cycle.torque, cycle.speed))
        mean = float(duration @ mean_product(cycle.torque, cycle.speed)) / cycle.total
        powers = {"maximum": float(power.max()), "returned": -float(power.min()), "mean": mean}
        least = _ROUNDING * torque * speed
        seen = {name: x if (abs(x) if name == "mean" else x) > least else 0.0 for name, x in powers.items()}
        by_cycle.append({
            "nominal_speed": speed, "rms_speed": rms(duration, cycle.speed),
            "maximum_torque_per_motor": torque, "rms_torque_per_motor": rms(duration, cycle.torque),
            **{f"{name}_power_per_motor": x for name, x in seen.items()},
            "load_inertia_per_motor": cycle.inertia, "cycle_time": cycle.total,
        })  # fmt: skip
    rows = [
        (name, title, symbol, max((figures[name] for figures in by_cycle), key=abs), of)
        for name, title, symbol, of in _FIGURES
    ]
    return _required(rows, len(by_cycle))


def _required(rows: Iterable[tuple[str, str, str, Any, tuple[str, str]]], cases: int) -> list[Requirement]:
    note = "in the worst load case" if cases > 1 else ""
    return [
        Requirement(name=name, title=title, symbol=symbol, value=float(x), kind=kind, unit=unit, note=note)
        for name, title, symbol, x, (kind, unit) in rows
    ]


_ROUNDING = 1e-12  # of the largest torque times the highest speed: a smaller power is none
_FIGURES = (
    ("nominal_speed", "Largest speed of the load's shaft", "n_nom", _SPEED),
    ("rms_speed", "RMS speed", "n_rms", _SPEED),
    ("maximum_torque_per_motor", "Largest torque", "M_max/m", _TORQUE),
    ("rms_torque_per_motor", "RMS torque", "M_rms/m", _TORQUE),
    ("maximum_power_per_motor", "Largest power to the load", "P_max/m", _POWER),
    ("returned_power_per_motor", "Largest power from the load", "P_ret/m", _POWER),
    ("mean_power_per_motor", "Mean power to the load", "P_mean/m", _POWER),
    ("load_inertia_per_motor", "Inertia of the load at its shaft", "J_load/m", ("inertia", "kg*m^2")),
    ("cycle_time", "Length of the cycle", "t_cycle", ("time", "s")),
)


# -- Mean load and nominal life of a ball screw over its load cases, as figures: whether a life is required or not.


def screw_requirements(cases: Sequence[RobotSpec]) -> list[Requirement]:
    """Figures of the life of a ball screw in the load case in which it is shortest; none without a dynamic rating."""
    lives = []
    for spec in cases:
        load: Any = spec.load
        if MODULES[load.kind] == "screw" and load.dynamic_load is not None:
            motion = sprung(spec, course(profile_of(spec)))
            force = force_along(motion, load, spec.environment.gravity, load.mass) / load.motors
            lives.append(screw_life(load, motion, force))
    if not lives:
        return []
    worst = min(lives, key=lambda life: life.time)
    figures = (
        ("screw_mean_load", "Mean axial load of the screw", "F_m", max(worst.mean), ("force", "N")),
        ("screw_life_turns", "Nominal life of the screw in turns", "L_10", worst.turns, ("dimensionless", "1")),
        ("screw_life_distance", "Nominal life of the screw in distance", "L_s", worst.distance, ("length", "km")),
        ("screw_life_time", "Nominal life of the screw, rests included", "L_h", worst.time, ("time", "h")),
    )
    return _required(figures, len(lives))
