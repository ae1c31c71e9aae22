r"""A roll that winds a web up or off, seen from its shaft: radius and inertia grow or shrink along the way.

With s the length of web that has run since the start, h its thickness, b its width and ρ its density, at tension F,

.. math:: r^2 = r_0^2 \pm \frac{h s}{π}, \quad ω = \frac{v}{r}, \quad α = \frac{a}{r} \mp \frac{h v^2}{2 π r^3},

.. math:: J = J_0 + \frac{π}{2} ρ b (r^4 - r_c^4), \quad
          T = \frac{1}{N} \left( \pm F r + J α + T_f \, \mathrm{sgn} ω \right)

the upper signs where it winds up. The web brings its momentum along, at the roll's own rim speed: what the layer that
joins takes up of it is what the roll's inertia gains, so that J α alone remains. The tension holds at rest too, and is
the same on all of the way, or tapers as the roll grows, :math:`F = F_0 (1 - t (1 - r_c / r))`. An unwinding drive holds
back, and takes up power. Segments are divided so that the radius changes by 1/256 in a piece; speed and inertia then
are off by 2e-5. A cycle that repeats starts with the first roll again.

Worked example: paper of 1 mm onto a core of 140 mm at 100 m/min: 227 rpm, and 224 rpm after a turn, at 142 mm
(Industrial Monitor Direct, variable speed motor RPM calculation for paper winding).
"""

import math
from collections.abc import Iterator
from typing import Any, ClassVar, Literal

import numpy as np

from drivesizer.errors import FieldError
from drivesizer.files import fields
from drivesizer.loads.course import Course
from drivesizer.loads.model import SharedLoad
from drivesizer.loads.springs import capped
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.units import show

_PIECES = 256  # of a change of the radius by its own size
_ROUNDING = 1e-9


class Winder(SharedLoad):
    """A roll that winds a web up or off."""

    axis: ClassVar[fields.Axis] = "linear"
    of_shaft: ClassVar[bool] = True
    kind: Literal["winder"]
    direction: Literal["up", "off"] = fields.default("up", "whether the web is wound up or off")
    tension: fields.Force = fields.required("of the web, at the core where it tapers")
    thickness: fields.Length = fields.required("of the web", example="0.1 mm")
    width: fields.Length = fields.required("of the web", example="300 mm")
    density: fields.Density = fields.required("of the wound web", example="900 kg/m^3")
    core_diameter: fields.Length = fields.required(example="76 mm")
    start_diameter: fields.Length | None = fields.optional("of the roll; core_diameter where not given")
    taper: fields.Part = fields.default(0, "t, share of the tension that a very large roll would have lost")
    friction_torque: fields.Torque = fields.default("0 N*m", "of the roll's bearings, against the motion")
    inertia: fields.Inertia = fields.default("0 kg*m^2", "of the core and its shaft")

    def _contradictions(self) -> Iterator[str]:
        yield from super()._contradictions()
        if self.start_diameter is not None and self.start_diameter < self.core_diameter:
            yield "expected start_diameter of no less than core_diameter"
        if self.springs:
            yield "springs: a web is pulled by its tension; leave them out"

    def radius(self, travel: Any) -> Any:
        """Radius of the roll after a length of web [m].

        Raises
        ------
        FieldError
            When the web is at its end.
        """
        first = (self.core_diameter if self.start_diameter is None else self.start_diameter) / 2
        square = first**2 + (1.0 if self.direction == "up" else -1.0) * self.thickness * travel / math.pi
        core = self.core_diameter / 2
        if np.any(square < core**2 * (1.0 - _ROUNDING)):
            on_it = show(float(np.max((first**2 - core**2) * math.pi / self.thickness)), "m", "length", 4)
            raise FieldError(("motion",), f"the web ends before the motion does; expected no more than its {on_it}")
        return np.sqrt(square)


def winder(load: Winder, gravity: float, course: Course) -> LoadCycle:
    """Load cycle at the roll's shaft.

    Parameters
    ----------
    load
        The roll.
    gravity
        Acceleration of free fall, which a roll in balance does not feel [m/s^2].
    course
        How the web runs.

    Returns
    -------
    LoadCycle
        At the shaft of one drive: speed [rad/s], torque [N*m], per segment its two ends.

    Raises
    ------
    FieldError
        When the web ends before the motion does.
    InputError
        When a figure leaves the range of numbers that can be computed with.
    """
    way, h = (1.0 if load.direction == "up" else -1.0), load.thickness
    smallest = load.radius(course.position).min(axis=1)
    travel = np.abs(np.diff(course.position, axis=1)[:, 0])
    course = course.finer(capped(_PIECES * h * travel / (2.0 * math.pi * smallest**2)))
    r = load.radius(course.position)
    core = load.core_diameter / 2
    inertia = load.inertia + math.pi / 2 * load.density * load.width * (r**4 - core**4)  # of the roll with its core
    speed = course.speed / r
    acceleration = course.acceleration / r - way * h * course.speed**2 / (2.0 * math.pi * r**3)
    tension = load.tension * (1.0 - load.taper * (1.0 - core / r))
    torque = way * tension * r + inertia * acceleration + load.friction_torque * course.direction
    largest = inertia.max(axis=(0, 1)) / load.motors
    return LoadCycle(course.name, course.duration, speed, acceleration, torque / load.motors, largest).split()
