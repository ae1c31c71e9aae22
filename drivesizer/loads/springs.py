r"""Springs, gas springs and counterweights beside the drive: the force that they take off it, or put on it.

With x the change of a spring's length since the start of the cycle and P the force in the direction in which it grows,

.. math:: P = F_0 - c x, \qquad P = F_1 \left( 1 + (p - 1) \frac{x_0 - x}{h} \right), \qquad
          F = - P \frac{dx}{ds} + F_R \left| \frac{dx}{ds} \right| \mathrm{sgn} v

the first of a linear or torsion spring (without c: of a constant force), the second of a gas spring: F₁ where its rod
is out, p times that where it is in by all of the stroke h, x₀ in at the start, F_R the friction of its seal. F is what
resists the forward motion. Along a line, and of a torsion spring, x is the travel s. Beside an axis that turns a spring
has one end on the load, r off the axis, and one that is fixed, b off it; θ goes from the fixed end to the other:

.. math:: l^2 = r^2 + b^2 - 2 r b \cos θ, \qquad x = l - l_0, \qquad \frac{dx}{ds} = \frac{r b \sin θ}{l}

Springs have no mass here and push as they pull; one that would go slack needs preload. A counterweight has its mass:
along a line it hangs on a rope and pulls forward, F = m (a - g); about an axis it stands opposite the load's own lever
unless its angle is given. Efficiencies of the load's stage apply to what springs leave of its force.

Of all linear springs the one that leaves the least RMS torque of a torque M is the regression of M on the angle from
where the spring is at rest, :math:`c = \langle M θ \rangle / \langle θ^2 \rangle`.

Worked examples: against an upright load that swings 30° to either side at constant speed that is
3 (sin A - A cos A) / A³ = 0.973 of m g l. A gas spring of 400 N, p 1.33 and 100 mm of stroke presses with 466 N when it
is half in.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from drivesizer.errors import FieldError
from drivesizer.files import fields
from drivesizer.loads.course import Course
from drivesizer.physics.figures import Alike, Figure
from drivesizer.physics.load_cycle import Ends
from drivesizer.units import show

# -- Weights on levers.


_LEVEL = 1e-5  # of the weight: what gets through a smaller share of it is none; files round 90 degrees to 1.5708 rad
_MOST = 10_000  # pieces of a cycle
_STEP, _LONGEST_STEP = math.radians(0.5), math.radians(10.0)


class Lever(NamedTuple):
    r"""A mass on a lever about an axis that does not stand upright: its weight is no straight line over time.

    Weight on a lever: :math:`T = M \cos(φ_0 + φ)`. A chord over the time Δt is off by at most
    :math:`M (ω^2 + |α|) Δt^2 / 8`; pieces with :math:`\sqrt{ω^2 + |α|} \, Δt \le` half a degree keep that to 1e-5 of M.
    No cycle is cut into more than some 10 000 pieces: beyond 13 turns they grow longer and the error with their square,
    to 4e-3 of M at 10 degrees (some 270 turns); a cycle of more turns than that is refused. A lever that turns level to
    within 1e-5 rad, nearer than files that round 90 degrees to 1.5708 rad, feels no weight.
    """

    mass: Alike  # kg
    length: Alike  # m, from the axis to its centre
    share: Alike  # of its weight that the axis' tilt leaves across it: 1 for a level axis
    start: Alike  # rad, of the lever above the level line when the cycle starts

    def moment(self, gravity: Figure) -> Alike:
        """Torque of the weight when the lever lies level, M [N*m]; 0 where it turns level but for rounding."""
        return self.mass * gravity * self.length * np.where(np.abs(self.share) > _LEVEL, self.share, 0.0)


def too_light(inertia: float, mass: float, length: float, name: str) -> Iterator[str]:
    """Fault of an inertia below that of all the mass in its centre, 2 % apart for rounded figures.

    Parameters
    ----------
    inertia
        About the axis [kg*m^2].
    mass
        That turns about it [kg].
    length
        From the axis to its centre [m].
    name
        Of the field that gives the length.

    Returns
    -------
    iterator
        The fault in words; nothing where there is none.
    """
    least = mass * length * length
    if inertia < 0.98 * least:
        yield f"inertia must be at least mass times {name} squared, {least:.4g} kg·m²"


def capped(pieces: NDArray[np.float64]) -> NDArray[np.int64]:
    """Whole pieces per segment, at least one, of some 10 000 in all at most; of samples the most that one takes.

    >>> capped(np.array([0.0, 2.5])), capped(np.array([30_000.0, 10_000.0]))
    (array([1, 3]), array([7500, 2500]))
    """
    most = pieces.reshape(len(pieces), -1).max(axis=1)
    share = min(1.0, _MOST / max(float(most.sum()), 1.0))
    return np.asarray(np.maximum(np.ceil(most * share), 1.0), dtype=np.int64)


def pieces_of_turn(course: Course) -> NDArray[np.float64]:
    """Pieces of each segment of a course that turns in which a weight on a lever is a straight line to 1e-5 of it."""
    lasting = np.where(course.duration > 0.0, course.duration, 1.0)
    slope = np.abs(np.diff(course.speed, axis=1)[:, 0]) / lasting
    return np.hypot(np.abs(course.speed).max(axis=1), np.sqrt(slope)) * course.duration / _STEP


def weight_on_lever(lever: Lever, gravity: Figure, course: Course) -> tuple[Course, Ends]:
    """The course in pieces that are fine enough, and the torque of a weight about the axis.

    Parameters
    ----------
    lever
        The mass and where it is.
    gravity
        Acceleration of free fall [m/s^2].
    course
        How the lever turns.

    Returns
    -------
    tuple
        The course in finer segments, and the torque of the weight at both ends of each [N*m], shape (segments, 2, ...).

    Raises
    ------
    FieldError
        When the cycle has too many turns to follow.
    """
    moment = lever.moment(gravity)
    if not np.any(moment):
        return course, np.zeros_like(course.speed)
    pieces = pieces_of_turn(course)
    if not (pieces.sum(axis=0) <= _MOST * _LONGEST_STEP / _STEP).all():  # written so that NaN fails too
        raise FieldError(
            ("motion",),
            "the weight turns round more than 250 times in one cycle; expected a shorter cycle, or a balanced load",
        )
    course = course.finer(capped(pieces))
    return course, moment * np.cos(lever.start + course.position)


# -- Springs, gas springs and counterweights, as fields and as forces.


_BEND = 3e-5  # of the travel, by which a chord of a ramp may be off
_ROUNDING = 1e-9

Rate = Annotated[float, fields.Quantity("stiffness", above=0.0)]


class SpringEnds(fields.Section):
    """Ends of a spring beside an axis that turns."""

    radius: fields.Length = fields.required("from the axis to the end on the load", example="50 mm")
    anchor: fields.Length = fields.required("from the axis to the fixed end", example="200 mm")
    angle: fields.Bearing = fields.required(
        "from the fixed end to the other when the cycle starts, forward positive", example="30 deg"
    )


class ConstantSpring(fields.Section):
    """A force or torque that is the same everywhere, such as that of a constant-force spring."""

    kind: Literal["constant"]
    force: fields.Pull | None = fields.optional("along a line forward positive; with ends pushing them apart positive")
    torque: fields.SignedTorque | None = fields.optional("about an axis, forward positive", example="2 N*m")
    ends: SpringEnds | None = fields.optional("beside an axis that turns")


class LinearSpring(fields.Section):
    """A spring that is drawn or pressed."""

    kind: Literal["linear"]
    rate: Rate = fields.required("force per travel")
    force: fields.Pull = fields.default(
        "0 N", "when the cycle starts: forward positive; with ends pushing them apart, so that a pull is negative"
    )
    ends: SpringEnds | None = fields.optional("beside an axis that turns")


class TorsionSpring(fields.Section):
    """A spring that is twisted by the axis."""

    kind: Literal["torsion"]
    rate: fields.Stiffness = fields.required("torque per angle", example="2 N*m/rad")
    torque: fields.SignedTorque = fields.default("0 N*m", "when the cycle starts, forward positive")


class GasSpring(fields.Section):
    """A gas spring, which pushes its ends apart, with the friction of its seal."""

    kind: Literal["gas"]
    force: fields.ForceAbove = fields.required("F_1, where the rod is out", example="400 N")
    progression: fields.Factor = fields.default(1, "of the force over the stroke: in over out, such as 1.33")
    stroke: fields.Length = fields.required(example="100 mm")
    pressed: fields.Thickness = fields.default("0 mm", "by how much it is in when the cycle starts")
    friction: fields.Force = fields.default("0 N", "against its motion, in either direction")
    pushes: Literal["forward", "back"] = fields.default("forward", "along a line")
    ends: SpringEnds | None = fields.optional("beside an axis that turns")


class BalanceMass(fields.Section):
    """A counterweight, which is moved as well."""

    kind: Literal["counterweight"]
    mass: fields.Mass
    length: fields.Length | None = fields.optional("from the axis that turns to its centre of mass", example="150 mm")
    angle: fields.Bearing | None = fields.optional(
        "above the level line when the cycle starts; opposite the load where not given", example="180 deg"
    )


AnySpring = ConstantSpring | LinearSpring | TorsionSpring | GasSpring | BalanceMass
Spring = Annotated[AnySpring, Field(discriminator="kind")]
Springs = Annotated[list[Spring], Field(max_length=20)]


def unfit_springs(springs: Sequence[AnySpring], *, turns: bool, levels: bool) -> Iterator[str]:
    """Faults of springs that do not fit the axis that they act on, each with the nearest that does.

    Parameters
    ----------
    springs
        Beside one axis.
    turns
        Whether the load turns; else it moves along a line.
    levels
        Whether gravity's direction across the axis is known, for a counterweight.

    Returns
    -------
    iterator
        Faults in words.
    """
    for spring in springs:
        of_torque = isinstance(spring, TorsionSpring) or getattr(spring, "torque", None) is not None
        ends = getattr(spring, "ends", None)
        if isinstance(spring, ConstantSpring) and (spring.force is None) == (spring.torque is None):
            yield "springs: a constant one has one of force and torque"
        if isinstance(spring, GasSpring) and np.any(np.greater(spring.pressed, spring.stroke)):
            yield "springs: expected pressed of no more than stroke"
        if isinstance(spring, BalanceMass):
            if turns and not levels:
                yield "springs: nothing says how gravity acts on a counterweight here; expected kind: arm"
            if turns != (spring.length is not None) or (spring.angle is not None and not turns):
                words = "needs its length" if turns else "along a line hangs on its rope: leave length and angle out"
                yield f"springs: a counterweight {words}"
        elif not turns and (of_torque or ends):
            yield "springs: the load moves along a line; expected kind: linear, or a force without ends"
        elif turns and not of_torque and ends is None:
            yield (
                "springs: a force about an axis needs ends, e.g. {radius: 50 mm, anchor: 200 mm, angle: 30 deg}; "
                "or kind: torsion"
            )
        elif of_torque and ends is not None:
            yield "springs: a torque has no ends; leave them out"


def spring_force(spring: Any, travel: Figure, direction: Figure) -> Any:
    """Force or torque of a spring against the forward motion.

    Parameters
    ----------
    spring
        A spring; no counterweight.
    travel
        Of the load since the cycle started [m or rad].
    direction
        Of the motion: 1, -1, or 0 at rest.

    Returns
    -------
    array
        What resists, [N] along a line or [N*m] about an axis.

    Raises
    ------
    FieldError
        When a gas spring leaves its stroke.

    Examples
    --------
    >>> half_in = GasSpring(kind="gas", force="400 N", progression=1.33, stroke="100 mm", pressed="50 mm")
    >>> round(float(-spring_force(half_in, 0.0, 0.0)), 3)
    466.0
    """
    length: Any = travel
    slope: Any = 1.0
    if getattr(spring, "ends", None) is not None:
        r, b, start = spring.ends.radius, spring.ends.anchor, spring.ends.angle
        own, first = (np.sqrt(r * r + b * b - 2.0 * r * b * np.cos(start + x)) for x in (travel, 0.0))
        length, slope = own - first, r * b * np.sin(start + travel) / np.where(own > 0.0, own, math.inf)
    if not isinstance(spring, GasSpring):
        force = getattr(spring, "force", None)
        force = spring.torque if force is None else force
        return -(force - getattr(spring, "rate", 0.0) * length) * slope
    if spring.ends is None and spring.pushes == "back":
        length, slope = -length, -slope
    pressed = spring.pressed - length
    off = np.maximum(pressed - spring.stroke, -pressed)
    if np.any(off > _ROUNDING * spring.stroke):
        by = show(float(np.max(off)), "mm", "length", 3)
        raise FieldError(
            ("load", "springs"),
            f"the motion leads {by} beyond a gas spring's stroke; expected another stroke or pressed",
        )
    push = spring.force * (1.0 + (spring.progression - 1.0) * pressed / spring.stroke)
    return -push * slope + spring.friction * np.abs(slope) * direction


def with_springs(
    springs: Sequence[Any], lever: Lever | None, gravity: Figure, course: Course, *, turns: bool
) -> Course:
    """The course in pieces that are fine enough, with the force of springs and counterweights and what these weigh.

    Parameters
    ----------
    springs
        Beside the axis; none leave the course as it is.
    lever
        The load's own mass about the axis; None along a line.
    gravity
        Acceleration of free fall [m/s^2].
    course
        How the load moves.
    turns
        Whether it turns.

    Returns
    -------
    Course
        With ``resisting`` [N or N*m] and ``balance`` [kg or kg*m^2].
    """
    if not springs:
        return course
    if any(
        getattr(spring, "ends", None) is not None or (turns and isinstance(spring, BalanceMass)) for spring in springs
    ):
        course = course.finer(capped(pieces_of_turn(course)))
    elif not all(isinstance(spring, ConstantSpring | BalanceMass) for spring in springs):
        bend = np.abs(np.diff(course.speed, axis=1)[:, 0]) * course.duration / 8.0
        reach = np.ptp(course.position, axis=(0, 1))
        course = course.finer(capped(np.sqrt(bend / (_BEND * np.where(reach > 0.0, reach, math.inf)))))
    resisting: Ends = np.zeros_like(course.speed)
    balance: Alike = 0.0
    for spring in springs:
        if not isinstance(spring, BalanceMass):
            resisting = resisting + spring_force(spring, course.position, course.direction)
        elif turns:
            assert lever is not None and spring.length is not None  # refused
            own = Lever(
                spring.mass, spring.length, lever.share, lever.start + math.pi if spring.angle is None else spring.angle
            )
            balance = balance + own.mass * own.length**2
            resisting = resisting + own.moment(gravity) * np.cos(own.start + course.position)
        else:
            if np.any(course.acceleration > gravity * (1.0 + _ROUNDING)):
                raise FieldError(("motion",), "a counterweight's rope goes slack; expected less acceleration")
            balance = balance + spring.mass
            resisting = resisting - spring.mass * gravity
    return replace(course, resisting=resisting + balance * course.acceleration, balance=balance)
