"""From the spec to the load cycles of its load cases: motion profiles, load cycles, wheels of a platform.

May import: files, physics, equations, platform, loads, spec, results.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from math import nan
from typing import Any

import numpy as np

from drivesizer.files.csv_columns import path_from_spec
from drivesizer.load_cases.profile import located, profile_of, static_torque, with_rest
from drivesizer.loads.course import Course, Profile, course
from drivesizer.loads.kinds import LAWS
from drivesizer.loads.model import Lever
from drivesizer.loads.stage_losses import through_gear
from drivesizer.physics.load_cycle import Ends, LoadCycle, OwnLimit
from drivesizer.spec.drive import BeltStage
from drivesizer.spec.robot import RobotSpec

__all__ = ["cycle_of_course", "driven_shaft_cycle", "load_cycle"]


# -- Positions in which a load is held at rest: where its torque may be largest.


def heaviest_positions(lever: Lever | None, moved: Course) -> Course:
    """Course at rest in each position in which gravity may turn the load most, with the payload that it has there.

    Power may be lost at any time, so that is the worst of the whole path. The torque of a mass on a lever goes as the
    cosine of its angle: it is largest at an end of the path, or level wherever the path passes there. Of any other load
    no position is worse than another. A light load may pull harder than a heavy one: against a counterweight.
    """
    carried = np.broadcast_to(moved.payload, (len(moved.duration), 1))[:, 0]
    found = [
        (place, payload)
        for payload in np.unique(carried)
        for place in _worst(lever, moved.position[carried == payload])
    ]
    places, payloads = (np.array(column)[:, None] for column in zip(*found, strict=True))
    ends = np.repeat(places, 2, axis=1)
    still = np.zeros_like(ends)
    return Course("held", np.ones(len(places)), ends, still, still, payloads)


def _worst(lever: Lever | None, position: Ends) -> list[float]:
    """Ends of a path, and level wherever it passes there."""
    low, high = float(position.min()), float(position.max())
    if lever is None:
        return [low, high]
    first, last = (math.ceil((low + lever.start) / math.pi), math.floor((high + lever.start) / math.pi))
    return [low, high, *(number * math.pi - lever.start for number in range(first, min(last, first + 1) + 1))]


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
    cycle = _cycle_without_belt(spec, profile)
    if spec.wants_brake:
        cycle = replace(cycle, held=_static_torque(spec, profile))
    return driven_shaft_cycle(spec, cycle)


def driven_shaft_cycle(spec: RobotSpec, cycle: LoadCycle) -> LoadCycle:
    """A load cycle with what the stages at the load add: the belt's inertia and friction, a gear of fixed ratio."""
    gear, belt = spec.gear, spec.belt
    if gear is None:
        return _with_belt(cycle, belt)
    if belt is None or not spec.gear_before_belt:
        return _with_belt(through_gear(cycle, gear.fixed_gear()), belt)
    cycle = _with_belt(cycle, belt)
    limited = replace(cycle, own=(*cycle.own, *_belt_limits(belt, cycle)))
    return through_gear(limited, gear.fixed_gear(belt.ratio or 1.0))


def _with_belt(cycle: LoadCycle, belt: BeltStage | None) -> LoadCycle:
    """The cycle with inertia and friction of a belt at the same shaft."""
    added, friction = (belt.inertia, belt.friction_torque) if belt else (0.0, 0.0)
    if added == friction == 0.0:
        return cycle
    torque = cycle.torque + added * cycle.acceleration
    own = tuple(one._replace(turning=one.turning + added) for one in cycle.own)
    if friction:
        torque = torque + friction * np.sign(cycle.speed.mean(axis=1, keepdims=True))
        own = tuple(one._replace(turning=math.nan) for one in own)
    return replace(cycle, torque=torque, inertia=cycle.inertia + added, own=own).split()


def _belt_limits(belt: BeltStage, cycle: LoadCycle) -> Iterator[OwnLimit]:
    """Tension and speed of a belt at the load, of which a gear before it takes no part."""
    if belt.pulley_diameter is None:
        return
    if belt.max_tension is not None:
        pull = float(np.abs(cycle.torque).max()) / (belt.pulley_diameter / 2)
        yield OwnLimit("belt_tension", pull, belt.max_tension)
    if belt.max_speed is not None:
        yield OwnLimit("belt_speed", float(np.abs(cycle.speed).max()) * belt.pulley_diameter / 2, belt.max_speed)


def _static_torque(spec: RobotSpec, profile: Profile | None) -> float:
    """Largest torque that holds the load at rest anywhere on its path [N*m]; NaN of a recording."""
    if spec.load.kind == "recorded":
        computed = _computed(spec)
        return computed.held if computed else nan
    resting = heaviest_positions(spec.load.lever, course(profile or profile_of(spec)))
    return float(np.abs(cycle_of_course(spec, resting).torque).max())


def _cycle_without_belt(spec: RobotSpec, profile: Profile | None) -> LoadCycle:
    """The cycle without the belt's own inertia."""
    load: Any = spec.load
    if load.kind != "recorded":
        return cycle_of_course(spec, course(profile or profile_of(spec)))
    cycle = _computed(spec) or _recorded(spec, load)
    return with_rest(cycle, spec.waits_until, static_torque(cycle))


def _computed(spec: RobotSpec) -> LoadCycle | None:
    """The cycle that a load brings, one of a machine's joints or wheels (``computed``); None of a recording."""
    found: LoadCycle | None = getattr(spec.load, "cycle", None)
    return found


def _recorded(spec: RobotSpec, load: Any) -> LoadCycle:
    with located(spec):
        return LAWS[load.kind](load, path_from_spec(spec.file, load.file, spec.where(("load", "file"))))


def cycle_of_course(spec: RobotSpec, course: Course) -> LoadCycle:
    """The load cycle at the driven shaft of one drive, of any load but a recording, without the belt's inertia."""
    with located(spec):
        cycle = LAWS[spec.load.kind](spec.load, spec.environment.gravity, course)
    return replace(cycle, own=()) if spec.platform else cycle  # a platform's own checks know more
