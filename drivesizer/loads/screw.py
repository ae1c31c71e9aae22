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

import math
from dataclasses import replace
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from drivesizer.errors import FieldError
from drivesizer.files.fields import (
    Axis,
    BackEfficiency,
    Coefficient,
    Force,
    Incline,
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
from drivesizer.files.inertia import Inertia
from drivesizer.loads.course import Course
from drivesizer.loads.model import SharedLoad
from drivesizer.loads.screw_limits import own_limits
from drivesizer.loads.stage_losses import force_along, through_stage
from drivesizer.physics.elements.screw import (
    Design,
    Fixity,
    back_driving_efficiency,
    preload_torque,
    shaft_inertia,
    thread_efficiency,
)
from drivesizer.physics.load_cycle import LoadCycle

__all__ = ["Screw", "ScrewChoice", "screw"]

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
