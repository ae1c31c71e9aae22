"""From the spec to the load cycles of its load cases: motion profiles, load cycles, wheels of a platform.

May import: files, physics, equations, platform, loads, spec, results.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import reduce
from math import nan
from typing import Any

import numpy as np

from drivesizer.files.csv_columns import path_from_spec
from drivesizer.load_cases.profile import located, profile_of, static_torque, with_rest
from drivesizer.loads.course import Course, Profile, course
from drivesizer.loads.kinds import LAWS
from drivesizer.loads.lever import Lever
from drivesizer.loads.springs import spring_force, with_springs
from drivesizer.loads.stage_losses import through_gear
from drivesizer.physics.load_cycle import LoadCycle, OwnLimit
from drivesizer.spec.drive import BeltStage
from drivesizer.spec.robot import RobotSpec


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
    load: Any = spec.load
    if load.kind == "recorded":
        cycle = getattr(load, "cycle", None)  # that of a machine's joint or wheel, which is computed
        if cycle is None:
            with located(spec):
                path = path_from_spec(spec.file, load.file, spec.where(("load", "file")))
                cycle = LAWS[load.kind](load, path)
        held = cycle.held
        if sampled and cycle.duration.ndim == 1:
            cycle = cycle.side_by_side()
        cycle = with_rest(_sprung_recording(spec, cycle), spec.waits_until, static_torque(cycle))
    else:
        moved, held = course(profile or profile_of(spec), sampled=sampled), nan
        cycle = cycle_of_course(spec, moved)
        if spec.wants_brake:
            still = heaviest_positions(load.lever, sprung(spec, moved), everywhere=bool(load_springs(spec)))
            held = np.abs(cycle_of_course(spec, still).torque).max(axis=(0, 1))
    if spec.wants_brake:
        cycle = replace(cycle, held=held)
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
    travel = np.cumsum(cycle.duration * cycle.speed.mean(axis=1), axis=0)
    position = np.stack([travel - cycle.duration * cycle.speed.mean(axis=1), travel], axis=1)
    with located(spec):
        resisting = sum(spring_force(one, position, cycle.direction) for one in springs)
    return replace(cycle, torque=cycle.torque + resisting / spec.load.motors).split()


def heaviest_positions(lever: Lever | None, moved: Course, *, everywhere: bool = False) -> Course:
    """Course at rest in each position in which gravity may turn the load most, with the payload that it has there.

    Power may be lost at any time, so that is the worst of the whole path. The torque of a mass on a lever goes as the
    cosine of its angle: it is largest at an end of the path, or level wherever the path passes there; with springs it
    may be so ``everywhere``. Of any other load no position is worse than another. A light load may pull harder than a
    heavy one: against a counterweight.
    """
    segments = len(moved.duration)
    carried = np.broadcast_to(moved.payload, (segments, 1, *np.shape(moved.payload)[2:])).reshape(segments, -1)
    payloads, kind = np.unique(carried, axis=0, return_inverse=True)
    positions: list[Any] = []
    weights: list[Any] = []
    for number, payload in enumerate(payloads):
        path = moved.position[kind.reshape(-1) == number]
        low, high = path.min(axis=(0, 1)), path.max(axis=(0, 1))
        found = list(path.reshape(-1, *path.shape[2:])) if everywhere else [low, high]
        if lever is not None:
            first, last = (np.ceil((low + lever.start) / math.pi), np.floor((high + lever.start) / math.pi))
            for turn in (first, first + 1.0):
                level = np.where(turn <= last, turn * math.pi - lever.start, low)
                found += [level] if np.any(turn <= last) else []
        positions += np.broadcast_arrays(*found)
        weights += [payload if path.ndim == 2 else payload[None]] * len(found)
    ends = np.repeat(np.stack(np.broadcast_arrays(*positions))[:, None], 2, axis=1)
    still = np.zeros_like(ends)
    lasting = np.ones((len(ends), *[1] * (ends.ndim - 2)))
    return Course("held", lasting, ends, still, still, np.stack(weights))


def driven_shaft_cycle(spec: RobotSpec, cycle: LoadCycle) -> LoadCycle:
    """A load cycle with what the stages at the load add: the belt's inertia and friction, gears of fixed ratio."""
    gears, belt = spec.gears[::-1], spec.belt  # from the load on
    before = belt is not None and spec.gear_before_belt
    if not before:
        return _with_belt(reduce(lambda one, gear: through_gear(one, gear.fixed_gear()), gears, cycle), belt)
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
    return reduce(lambda one, gear: through_gear(one, gear.fixed_gear(ratio)), gears, whole)


def _with_belt(cycle: LoadCycle, belt: BeltStage | None) -> LoadCycle:
    """The cycle with inertia and friction of a belt at the same shaft."""
    if belt is None or not (np.any(belt.inertia) or np.any(belt.friction_torque)):
        return cycle
    torque = cycle.torque + belt.inertia * cycle.acceleration
    torque = torque + belt.friction_torque * cycle.direction
    return replace(cycle, torque=torque, inertia=cycle.inertia + belt.inertia).split()
