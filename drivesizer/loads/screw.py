r"""A slide on a lead screw or a ball screw, seen from the screw, with the screw's own limits.

.. math:: F = m g \sin β + μ m g \cos β \, \mathrm{sgn} v + F_f \, \mathrm{sgn} v + F_0 + m a, \qquad r = \frac{L}{2 π}

With :math:`F r / e` where the screw drives the slide and :math:`F r e_b` where the slide drives the screw
(``stage_losses``),
and on top of either the drag of a preloaded nut and the inertia of the screw. e_b is 2 - 1/e where it is not given:
the same torque is lost in either direction. With e_b below 0 the screw is self-locking: the slide cannot turn it, and
to lower a load the motor has to drive too, with a torque of :math:`|F| r |e_b|`; e_b is taken as it stands, not as 0.
For a square thread e = tan λ / tan(λ + ρ) and e_b = tan(λ - ρ) / tan λ, lead angle λ and angle of friction ρ; there
2 - 1/e makes lowering on a self-locking screw a few per cent too heavy. At rest the screw holds F r, a
self-locking one nothing. Some catalogues divide by e on the way down as well (THK A-743: 470 N on 10 mm give
830 N·mm, where e_b = 8/9 gives 665 N·mm): that is on the safe side for the motor's torque, but the energy that the
load returns is then not seen.

A screw with its dimensions has limits of its own (``screw_limits``). Both efficiencies of a sliding thread follow from
its friction, the inertia of a steel screw from its dimensions, the drag of a nut from its preload
(``physics.elements.screw``).

Worked examples: 20 kN on a lead of 10 mm at 70 % efficiency: 20 000 · 0.010 / (2π · 0.7) = 45.5 N·m
(engineeringprep.com, problem 516). A slide of 40 kg, μ 0.05, lead 15 mm, e = 0.9, with a nut preloaded by a third of
19.6 N at a coefficient of 0.3: 19.6 · 0.015 / (2π · 0.9) + 0.3 · 6.53 · 0.015 / 2π = 0.0567 N·m (Oriental Motor,
technical reference, motor sizing: ball screw).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Annotated, ClassVar, Literal, NamedTuple, Protocol, Self

import numpy as np
from pydantic import Field, model_validator

from drivesizer.errors import FieldError
from drivesizer.files.fields import (
    Axis,
    BackEfficiency,
    Coefficient,
    Force,
    Incline,
    Inertia,
    Length,
    Mass,
    Names,
    Pull,
    Quantity,
    Ratio,
    Section,
    Share,
    Thickness,
    Torque,
    default,
    exactly_one,
)
from drivesizer.loads.course import Course
from drivesizer.loads.model import SharedLoad
from drivesizer.loads.stage_losses import force_along, through_stage
from drivesizer.physics.load_cycle import Ends, LoadCycle, OwnLimit, end_times
from drivesizer.physics.screw import (
    Design,
    Fixity,
    MeanLoad,
    back_driving_efficiency,
    buckling_load,
    core_load,
    critical_speed,
    life_turns,
    mean_load,
    preload_torque,
    shaft_inertia,
    thread_efficiency,
)
from drivesizer.units import show

__all__ = ["Screw", "ScrewChoice", "ScrewLife", "own_limits", "screw_life"]


# -- Limits of a screw itself: buckling, speed, static load and life, as far as its dimensions and ratings are given.
#
# The axial force is that between nut and slide: weight, acceleration, friction of the guide, further force. It
# counts against buckling in either direction, whichever end has the thrust bearing.


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


Rating = Annotated[float, Quantity("force", above=0.0)]


class ScrewChoice(Section):
    """Screws out of the catalogues: of each lead the smallest that holds, of all leads that of the best drive."""

    maker: Names | None = Field(default=None, description="such as THK or HIWIN; * stands for any text")
    family: Names | None = None
    part: Names | None = None
    diameter_min: Length | None = None
    diameter_max: Length | None = None
    lead_min: Length | None = None
    lead_max: Length | None = None
    play_max: Thickness | None = Field(default=None, description="axial; then a screw of unknown play is left out")

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        for name in ("diameter", "lead"):
            least, most = getattr(self, f"{name}_min"), getattr(self, f"{name}_max")
            if least is not None and most is not None and least > most:
                raise ValueError(f"expected {name}_min <= {name}_max")
        return self


_OF_CATALOGUE = ("lead", "diameter", "root_diameter", "ball_diameter", "pitch_diameter", "shaft_diameter",
                 "dynamic_load", "static_load", "permissible_thrust", "dn_max")  # fmt: skip


class Screw(SharedLoad):
    """A lead screw or ball screw that moves a slide, level to upright."""

    axis: ClassVar[Axis] = "linear"
    has_end: ClassVar[bool] = True
    takes_payload: ClassVar[bool] = True
    kind: Literal["lead_screw", "ball_screw"]
    mass: Mass = Field(description="of the slide and what is on it")
    screw: ScrewChoice | None = Field(
        default=None, description="out of the catalogues, with its lead and all that is printed of it; or give lead"
    )
    lead: Length | None = Field(default=None, description="travel per turn; or give screw")
    efficiency: Share | None = Field(
        default=None, description="of screw and nut when it drives the slide; or give thread_friction"
    )
    thread_friction: Coefficient | None = Field(
        default=None,
        description="of a trapezoidal thread, in place of both efficiencies, beside diameter and root_diameter",
    )
    back_efficiency: BackEfficiency | None = Field(
        default=None, description="when the slide drives it; 2 - 1/efficiency where not given, below 0 is self-locking"
    )
    incline: Incline = default("0 deg", description="of the forward motion, upward positive; 90 deg lifts")
    friction_coefficient: Coefficient = Field(default=0, description="of the guide")
    friction_force: Force = default("0 N", description="of the guide's seals, against the motion")
    force: Pull = default("0 N", description="further force against the forward motion, at rest too")
    preload_torque: Torque = default("0 N*m", description="drag of a preloaded nut and its bearings")
    preload: Force = default("0 N", description="of a ball nut: its drag, beside preload_torque, and its life")
    inertia: Inertia | None = Field(
        default=None,
        description="of screw and coupling; of a steel shaft of diameter and length where not given; of the coupling "
        "alone with screw",
    )
    diameter: Length | None = Field(default=None, description="nominal, of one screw as all that follows")
    root_diameter: Length | None = Field(default=None, description="of the thread's core")
    pitch_diameter: Length | None = Field(
        default=None, description="of a sliding thread; between diameter and root_diameter where not given"
    )
    shaft_diameter: Length | None = Field(
        default=None, description="outside, for the inertia; diameter where not given"
    )
    ball_diameter: Length | None = Field(default=None, description="of the ball centres; diameter where not given")
    length: Length | None = Field(default=None, description="free, between the bearings; no shorter than the stroke")
    screw_length: Length | None = Field(default=None, description="with its ends; length where not given")
    ends: Fixity | None = Field(default=None, description="bearings of both ends, for buckling and critical speed")
    design: Design | None = Field(
        default=None,
        description="whose factors for these; those of a beam where not given, of a screw out of the catalogues its "
        "maker's",
    )
    dynamic_load: Rating | None = Field(default=None, description="rating C_a, for the life")
    static_load: Rating | None = Field(default=None, description="rating C_0a")
    permissible_thrust: Rating | None = Field(default=None, description="of a sliding nut")
    load_factor: Ratio = Field(
        default=1.5, description="f_w of the life: 1 to 1.2 smooth, 1.5 up to 1 m/s, 2 to 3.5 with impacts"
    )
    static_safety: Ratio = Field(default=2, description="static_load over the largest axial load, at least")
    dn_max: Ratio | None = Field(default=None, description="ball_diameter times speed that the nut permits, in mm rpm")

    @model_validator(mode="after")
    def _complete(self) -> Self:
        exactly_one(self, "lead", "screw")
        if self.screw is not None:
            return self._left_open()
        exactly_one(self, "efficiency", "thread_friction")
        if self.thread_friction is not None and (self.diameter is None or self.root_diameter is None):
            raise ValueError("give diameter and root_diameter beside thread_friction")
        if self.thread_friction is not None and self.back_efficiency is not None:
            raise ValueError("back_efficiency follows from thread_friction; leave one of them out")
        if self.inertia is None and (self.diameter is None or self.overall is None):
            raise ValueError("give inertia, or diameter and length of a steel screw")
        return self

    def _left_open(self) -> Self:
        """Refuse figures of the screw beside a choice of it, and a choice without a length."""
        given = [name for name in _OF_CATALOGUE if getattr(self, name) is not None]
        if given:
            raise ValueError(f"expected screw without {given[0]}, which is that of the screw that is chosen")
        if self.length is None or self.ends is None:
            raise ValueError("give length and ends beside screw")
        if self.efficiency is not None and self.thread_friction is not None:
            raise ValueError("give efficiency or thread_friction, not both")
        return self

    @model_validator(mode="after")
    def _dimensions(self) -> Self:
        if self.diameter and self.root_diameter and not self.root_diameter < self.diameter:
            raise ValueError("root_diameter must be below diameter")
        if self.ends and self.length is None:
            raise ValueError("give length beside ends")
        if self.length and self.screw_length and self.screw_length < self.length:
            raise ValueError("screw_length must not be below length")
        if self.nut_diameter is None and self.screw is None and (self.dn_max or self.preload):
            raise ValueError("give diameter beside dn_max and preload")
        return self

    @property
    def travel_per_turn(self) -> float:
        """The lead [m].

        Raises
        ------
        FieldError
            Where the screw has yet to be chosen.
        """
        if self.lead is None:
            raise FieldError(
                ("load", "screw"), "a screw out of the catalogues is chosen by `drivesizer size`; give lead"
            )
        return self.lead

    @property
    def overall(self) -> float | None:
        """Length with the ends [m]; the free one where that is not given."""
        return self.length if self.screw_length is None else self.screw_length

    @property
    def nut_diameter(self) -> float | None:
        """Diameter on which the balls run, or the nominal one [m]."""
        return self.diameter if self.ball_diameter is None else self.ball_diameter

    @property
    def efficiencies(self) -> tuple[float, float]:
        """Of a screw that drives the slide, and of a slide that drives the screw: below 0 where it locks itself."""
        if self.thread_friction is not None:
            pitch = self.pitch_diameter or ((self.diameter or 0.0) + (self.root_diameter or 0.0)) / 2.0
            thread = self.travel_per_turn, pitch, self.thread_friction
            return float(thread_efficiency(*thread)), float(back_driving_efficiency(*thread))
        forward = float(self.efficiency or 0.0)
        return forward, 2.0 - 1.0 / forward if self.back_efficiency is None else self.back_efficiency

    @property
    def turning(self) -> float:
        """Inertia of all screws [kg*m^2]."""
        if self.inertia is not None and self.screw is None:
            return self.inertia
        shaft = self.motors * shaft_inertia(self.shaft_diameter or self.diameter, self.overall)
        return float((self.inertia or 0.0) + shaft)

    @property
    def drag(self) -> float:
        """Torque of all preloaded nuts and bearings [N*m]."""
        of_nuts = preload_torque(self.preload, self.travel_per_turn, self.nut_diameter) if self.preload else 0.0
        return self.preload_torque + self.motors * float(of_nuts)


@np.errstate(over="ignore", invalid="ignore")  # the load cycle refuses what is not finite
def screw(load: Screw, gravity: float, course: Course) -> LoadCycle:
    """Load cycle at the screw.

    Parameters
    ----------
    load
        The slide and its screw.
    gravity
        Acceleration of free fall [m/s^2].
    course
        How the slide moves.

    Returns
    -------
    LoadCycle
        At the screw of one drive: speed [rad/s], torque [N*m], per segment its two ends.

    Raises
    ------
    InputError
        When the screw is shorter than its stroke or has yet to be chosen, or a figure leaves the range of numbers that
        can be computed with.
    """
    force = force_along(course, load, gravity, load.mass)
    radius = load.travel_per_turn / (2 * math.pi)
    cycle = through_stage(course, force, radius, load.efficiencies, mass=load.mass, turning=load.turning,
                          motors=load.motors, drag=load.drag)  # fmt: skip
    return replace(cycle, own=own_limits(load, course, force / load.motors))
