"""Limits of a screw itself: buckling, speed, static load and life, as far as its dimensions and ratings are given.

The axial force is that between nut and slide: weight, acceleration, friction of the guide, further force. It counts
against buckling in either direction, whichever end has the thrust bearing.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple, Protocol

import numpy as np

from drivesizer.errors import FieldError
from drivesizer.loads.course import Course
from drivesizer.physics.elements.screw import MeanLoad, buckling_load, core_load, critical_speed, life_turns, mean_load
from drivesizer.physics.load_cycle import Ends, OwnLimit, end_times
from drivesizer.units import show

__all__ = ["HasScrew", "ScrewLife", "own_limits", "screw_life"]

_ROUNDING = 1e-9  # of the stroke


class HasScrew(Protocol):
    """Dimensions and ratings of one screw; None where they are not known."""

    @property
    def travel_per_turn(self) -> float:
        """The lead [m]."""

    @property
    def root_diameter(self) -> float | None:
        """Of the core [m]."""

    @property
    def nut_diameter(self) -> float | None:
        """On which the balls run [m]."""

    @property
    def length(self) -> float | None:
        """Between the bearings [m]."""

    @property
    def ends(self) -> str | None:
        """Bearings of both ends."""

    @property
    def design(self) -> str | None:
        """Whose factors of buckling and critical speed; a beam's where not given."""

    @property
    def dynamic_load(self) -> float | None:
        """Rating C_a [N]."""

    @property
    def static_load(self) -> float | None:
        """Rating C_0a [N]."""

    @property
    def permissible_thrust(self) -> float | None:
        """Of a sliding nut [N]."""

    @property
    def load_factor(self) -> float:
        """Factor f_w of the life."""

    @property
    def static_safety(self) -> float:
        """Static rating over the largest load, at least."""

    @property
    def dn_max(self) -> float | None:
        """Permissible diameter times speed [mm rpm]."""

    @property
    def preload(self) -> float:
        """Of a ball nut [N]."""


class ScrewLife(NamedTuple):
    """Nominal life of a ball screw over one load cycle, repeated."""

    mean: MeanLoad  # N, of both flanks
    turns: float
    distance: float  # m
    time: float  # s of the cycle, its rests included


def own_limits(screw: HasScrew, course: Course, force: Ends) -> tuple[OwnLimit, ...]:
    """Limits of a screw that its dimensions and ratings give.

    Parameters
    ----------
    screw
        One of those that move the load.
    course
        How the slide moves.
    force
        Axial force on the nut of one screw at both ends of each segment [N], shape (segments, 2).

    Returns
    -------
    tuple
        Those whose figures are given; a life has no demand here, for needs have it.

    Raises
    ------
    FieldError
        When the screw is shorter than its stroke.
    """
    stroke = float(np.ptp(course.position))
    if screw.length is not None and screw.length < stroke * (1.0 - _ROUNDING):
        found, needed = (show(x, "mm", "length", 6) for x in (screw.length, stroke))
        raise FieldError(
            ("load", "length"), f"{found} is shorter than the stroke; expected {needed} and the nut at least"
        )
    return (*_load_limits(screw, course, force), *_speed_limits(screw, course), *_life_limits(screw, course, force))


def _worst(course: Course, ends: Ends) -> tuple[float, float]:
    """The largest amount of something, and when."""
    place = int(np.abs(ends).argmax())
    return float(np.abs(ends).reshape(-1)[place]), float(end_times(course.duration).reshape(-1)[place])


def _load_limits(screw: HasScrew, course: Course, force: Ends) -> Iterator[OwnLimit]:
    most, time = _worst(course, force)
    yield OwnLimit(
        "screw_axial_force", most, 0.0, time
    )  # of the shaft and its bearings, not of the screw: no check by itself
    if screw.ends is not None:
        core = math.nan if screw.root_diameter is None else screw.root_diameter
        held = float(np.minimum(buckling_load(core, screw.length, screw.ends, screw.design or "beam"), core_load(core)))
        yield OwnLimit("screw_buckling", most, held, time)
    if screw.static_load is not None:
        yield OwnLimit("screw_static_load", most * screw.static_safety, screw.static_load, time)
    if screw.permissible_thrust is not None:
        yield OwnLimit("screw_thrust", most, screw.permissible_thrust, time)


def _speed_limits(screw: HasScrew, course: Course) -> Iterator[OwnLimit]:
    travel, time = _worst(course, course.speed)
    speed = travel / screw.travel_per_turn * 2.0 * math.pi
    if screw.ends is not None:
        core = math.nan if screw.root_diameter is None else screw.root_diameter
        yield OwnLimit(
            "screw_critical_speed", speed, critical_speed(core, screw.length, screw.ends, screw.design or "beam"), time
        )
    if screw.dn_max is not None and screw.nut_diameter is not None:
        yield OwnLimit("screw_dn", screw.nut_diameter * 1e3 * speed * 30.0 / math.pi, screw.dn_max, time)


def _life_limits(screw: HasScrew, course: Course, force: Ends) -> Iterator[OwnLimit]:
    if screw.dynamic_load is not None:
        yield OwnLimit("screw_life", math.nan, screw_life(screw, course, force).time)


def screw_life(screw: HasScrew, course: Course, force: Ends) -> ScrewLife:
    """Nominal life of a ball screw whose dynamic rating is known.

    Parameters
    ----------
    screw, course, force
        As for ``own_limits``.

    Returns
    -------
    ScrewLife
        Infinite where nothing loads the nut while it moves, or nothing moves.
    """
    mean = mean_load(course.duration, course.speed, force, screw.preload)
    rating = math.nan if screw.dynamic_load is None else screw.dynamic_load
    turns = life_turns(rating, mean, screw.load_factor)
    distance = turns * screw.travel_per_turn
    moved = float(course.duration @ np.abs(course.speed.mean(axis=1)))
    time = distance / moved * float(course.duration.sum()) if moved > 0.0 else math.inf
    return ScrewLife(mean, turns, distance, time)
