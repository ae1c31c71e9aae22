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
from typing import ClassVar, Literal, NamedTuple

import numpy as np

from drivesizer.errors import FieldError
from drivesizer.files import fields
from drivesizer.loads.course import Course, at_largest
from drivesizer.loads.model import SharedLoad
from drivesizer.loads.stage_losses import force_along, through_stage
from drivesizer.physics import screw as physics
from drivesizer.physics.figures import Alike
from drivesizer.physics.load_cycle import Ends, LoadCycle, OwnLimit
from drivesizer.units import show

_ROUNDING = 1e-9  # of the stroke


class ScrewChoice(fields.Section):
    """Screws out of the catalogues: of each lead the smallest that holds, of all leads that of the best drive."""

    maker: fields.Names | None = fields.optional("such as THK or HIWIN; * stands for any text")
    family: fields.Names | None = None
    part: fields.Names | None = None
    diameter_min: fields.Length | None = fields.optional(example="8 mm")
    diameter_max: fields.Length | None = fields.optional(example="32 mm")
    lead_min: fields.Length | None = fields.optional(example="5 mm")
    lead_max: fields.Length | None = fields.optional(example="20 mm")
    play_max: fields.Thickness | None = fields.optional("axial; then a screw of unknown play is left out", "0.1 mm")

    def _contradictions(self) -> Iterator[str]:
        for name in ("diameter", "lead"):
            least, most = getattr(self, f"{name}_min"), getattr(self, f"{name}_max")
            if least is not None and most is not None and least > most:
                yield f"expected {name}_min <= {name}_max"


_OF_CATALOGUE = ("lead", "diameter", "root_diameter", "ball_diameter", "pitch_diameter", "shaft_diameter",
                 "dynamic_load", "static_load", "permissible_thrust", "dn_max")  # fmt: skip


class Screw(SharedLoad):
    """A lead screw or ball screw that moves a slide, level to upright."""

    axis: ClassVar[fields.Axis] = "linear"
    has_end: ClassVar[bool] = True
    takes_payload: ClassVar[bool] = True
    loads_shaft: ClassVar[bool] = True
    kind: Literal["lead_screw", "ball_screw"]
    mass: fields.Mass = fields.required("of the slide and what is on it")
    screw: ScrewChoice | None = fields.optional(
        "out of the catalogues, with its lead and all that is printed of it; or give lead"
    )
    lead: fields.Length | None = fields.optional("travel per turn; or give screw", example="10 mm")
    efficiency: fields.Share | None = fields.optional(
        "of screw and nut when it drives the slide; or give thread_friction"
    )
    thread_friction: fields.Coefficient | None = fields.optional(
        "of a trapezoidal thread, in place of both efficiencies, beside diameter and root_diameter"
    )
    back_efficiency: fields.BackEfficiency | None = fields.optional(
        "when the slide drives it; 2 - 1/efficiency where not given, below 0 is self-locking"
    )
    incline: fields.Incline = fields.default("0 deg", "of the forward motion, upward positive; 90 deg lifts")
    friction_coefficient: fields.Coefficient = fields.default(0, "of the guide")
    friction_force: fields.Force = fields.default("0 N", "of the guide's seals, against the motion")
    force: fields.Pull = fields.default("0 N", "further force against the forward motion, at rest too")
    preload_torque: fields.Torque = fields.default("0 N*m", "drag of a preloaded nut and its bearings")
    preload: fields.Force = fields.default(
        "0 N", "of a ball nut: its drag, beside preload_torque, and its life", example="500 N"
    )
    inertia: fields.Inertia | None = fields.optional(
        "of screw and coupling; of a steel shaft of diameter and length where not given; of the coupling "
        "alone with screw"
    )
    diameter: fields.Length | None = fields.optional("nominal, of one screw as all that follows", example="20 mm")
    root_diameter: fields.Length | None = fields.optional("of the thread's core", example="17 mm")
    pitch_diameter: fields.Length | None = fields.optional(
        "of a sliding thread; between diameter and root_diameter where not given", example="18 mm"
    )
    shaft_diameter: fields.Length | None = fields.optional(
        "outside, for the inertia; diameter where not given", example="20 mm"
    )
    ball_diameter: fields.Length | None = fields.optional(
        "of the ball centres; diameter where not given", example="21 mm"
    )
    length: fields.Length | None = fields.optional(
        "free, between the bearings; no shorter than the stroke", example="600 mm"
    )
    screw_length: fields.Length | None = fields.optional("with its ends; length where not given", example="700 mm")
    ends: physics.Fixity | None = fields.optional("bearings of both ends, for buckling and critical speed")
    design: physics.Design | None = fields.optional(
        "whose factors for these; those of a beam where not given, of a screw out of the catalogues its maker's"
    )
    dynamic_load: fields.ForceAbove | None = fields.optional("rating C_a, for the life", example="15 kN")
    static_load: fields.ForceAbove | None = fields.optional("rating C_0a", example="25 kN")
    permissible_thrust: fields.ForceAbove | None = fields.optional("of a sliding nut", example="2 kN")
    load_factor: fields.Ratio = fields.default(
        1.5, "f_w of the life: 1 to 1.2 smooth, 1.5 up to 1 m/s, 2 to 3.5 with impacts"
    )
    static_safety: fields.Ratio = fields.default(2, "static_load over the largest axial load, at least")
    dn_max: fields.Ratio | None = fields.optional("ball_diameter times speed that the nut permits, in mm rpm")

    def _contradictions(self) -> Iterator[str]:
        yield from super()._contradictions()
        yield from fields.exactly_one(self, "lead", "screw")
        names = [name for name in _OF_CATALOGUE if getattr(self, name) is not None]
        if self.screw is not None and names:
            yield f"expected screw without {names[0]}, which is that of the screw that is chosen"
        if self.screw is not None and (self.length is None or self.ends is None):
            yield "give length and ends beside screw"
        if self.screw is not None and self.efficiency is not None and self.thread_friction is not None:
            yield "give efficiency or thread_friction, not both"
        if self.screw is None:
            yield from fields.exactly_one(self, "efficiency", "thread_friction")
        if self.thread_friction is not None and self.screw is None and None in (self.diameter, self.root_diameter):
            yield "give diameter and root_diameter beside thread_friction"
        if self.thread_friction is not None and self.screw is None and self.back_efficiency is not None:
            yield "back_efficiency follows from thread_friction; leave one of them out"
        if self.inertia is None and self.screw is None and None in (self.diameter, self.overall):
            yield "give inertia, or diameter and length of a steel screw"
        if self.diameter and self.root_diameter and not self.root_diameter < self.diameter:
            yield "root_diameter must be below diameter"
        if self.ends and self.length is None:
            yield "give length beside ends"
        if self.length and self.screw_length and self.screw_length < self.length:
            yield "screw_length must not be below length"
        if self.nut_diameter is None and self.screw is None and (self.dn_max or self.preload):
            yield "give diameter beside dn_max and preload"

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
    def efficiencies(self) -> tuple[Alike, Alike]:
        """Of a screw that drives the slide, and of a slide that drives the screw: below 0 where it locks itself."""
        if self.thread_friction is not None:
            assert self.diameter is not None and self.root_diameter is not None
            pitch = (self.diameter + self.root_diameter) / 2.0 if self.pitch_diameter is None else self.pitch_diameter
            thread = self.travel_per_turn, pitch, self.thread_friction
            return physics.thread_efficiency(*thread), physics.back_driving_efficiency(*thread)
        assert self.efficiency is not None
        return self.efficiency, 2.0 - 1.0 / self.efficiency if self.back_efficiency is None else self.back_efficiency

    @property
    def turning(self) -> Alike:
        """Inertia of all screws [kg*m^2]."""
        if self.inertia is not None and self.screw is None:
            return self.inertia
        thick = self.diameter if self.shaft_diameter is None else self.shaft_diameter
        assert thick is not None and self.overall is not None  # refused above
        shaft = self.motors * physics.shaft_inertia(thick, self.overall)
        return shaft if self.inertia is None else self.inertia + shaft

    @property
    def drag(self) -> Alike:
        """Torque of all preloaded nuts and bearings [N*m]."""
        if not np.any(self.preload):
            return self.preload_torque
        assert self.nut_diameter is not None  # refused above
        of_nut = physics.preload_torque(self.preload, self.travel_per_turn, self.nut_diameter)
        return self.preload_torque + self.motors * of_nut


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


# -- Limits of a screw itself: buckling, speed, static load and life, as far as its dimensions and ratings are given.
#
# The axial force is that between nut and slide: weight, acceleration, friction of the guide, further force. It
# counts against buckling in either direction, whichever end has the thrust bearing.


def own_limits(screw: Screw, course: Course, force: Ends) -> tuple[OwnLimit, ...]:
    """Limits of a screw that its dimensions and ratings give.

    Parameters
    ----------
    screw
        One of those that move the load.
    course
        How the slide moves.
    force
        Axial force on the nut of one screw at both ends of each segment [N], shape (segments, 2, ...).

    Returns
    -------
    tuple
        Those whose figures are given; a life has no demand here, for needs have it.

    Raises
    ------
    FieldError
        When the screw is shorter than its stroke.
    """
    stroke = np.ptp(course.position, axis=(0, 1))
    if screw.length is not None and np.any(screw.length < stroke * (1.0 - _ROUNDING)):
        length, needed = (show(float(np.max(x)), "mm", "length", 6) for x in (screw.length, stroke))
        raise FieldError(
            ("load", "length"), f"{length} is shorter than the stroke; expected {needed} and the nut at least"
        )
    time, most = at_largest(np.abs(force), course.duration, np.abs(force))
    fast, travel = at_largest(np.abs(course.speed), course.duration, np.abs(course.speed))
    speed = travel / screw.travel_per_turn * 2.0 * math.pi
    core = math.nan if screw.root_diameter is None else screw.root_diameter
    limits = [
        OwnLimit("screw_axial_force", most, 0.0, time)
    ]  # of the shaft's bearings: no check of the screw by itself
    if screw.ends is not None:
        assert screw.length is not None  # refused above
        geometry = screw.length, screw.ends, screw.design or "beam"
        limit = np.minimum(physics.buckling_load(core, *geometry), physics.core_load(core))
        limits.append(OwnLimit("screw_buckling", most, limit, time))
        limits.append(OwnLimit("screw_critical_speed", speed, physics.critical_speed(core, *geometry), fast))
    if screw.static_load is not None:
        limits.append(OwnLimit("screw_static_load", most * screw.static_safety, screw.static_load, time))
    if screw.permissible_thrust is not None:
        limits.append(OwnLimit("screw_thrust", most, screw.permissible_thrust, time))
    if screw.dn_max is not None and screw.nut_diameter is not None:
        limits.append(OwnLimit("screw_dn", screw.nut_diameter * 1e3 * speed * 30.0 / math.pi, screw.dn_max, fast))
    if screw.dynamic_load is not None:
        limits.append(OwnLimit("screw_life", math.nan, screw_life(screw, course, force).time))
    return tuple(limits)


class ScrewLife(NamedTuple):
    """Nominal life of a ball screw over one load cycle, repeated."""

    mean: physics.MeanLoad  # N, of both flanks
    turns: Alike
    distance: Alike  # m
    time: Alike  # s of the cycle, its rests included


def screw_life(screw: Screw, course: Course, force: Ends) -> ScrewLife:
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
    mean = physics.mean_load(course.duration, course.speed, force, screw.preload)
    rating = math.nan if screw.dynamic_load is None else screw.dynamic_load
    turns = physics.life_turns(rating, mean, screw.load_factor)
    distance = turns * screw.travel_per_turn
    travel = (course.duration * np.abs(course.speed.mean(axis=1))).sum(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        time = np.where(travel > 0.0, distance / travel * course.duration.sum(axis=0), math.inf)
    return ScrewLife(mean, turns, distance, time if course.duration.ndim > 1 else float(time))
