r"""A joint that swings an arm against gravity.

.. math:: T = \frac{1}{N} \left( J α + m g l \cos τ \cos(φ_0 + φ) + T_f \, \mathrm{sgn} ω \right)

φ counts upward from the level line, φ₀ at the start of the cycle; a joint's axis tilted by τ from level feels the less
of gravity. J about the joint is given, or m l² as if all of the mass were in its centre, which is the least it can be.
How fine the weight's torque is followed: ``weight_on_lever``.

Worked example: a uniform arm of 70 cm and 4.0 kg with 3.0 kg in the hand, together 7.0 kg at 0.50 m, loads the
shoulder with 7.0 · 9.8 · 0.50 = 34 N·m level and 24 N·m at 45° below (Knight, Physics for Scientists and Engineers,
rotation of a rigid body, exercise on the athlete with a steel ball).
"""

from collections.abc import Iterator
from typing import ClassVar, Literal

import numpy as np

from drivesizer.files import fields
from drivesizer.loads.course import Course
from drivesizer.loads.model import SharedLoad
from drivesizer.loads.springs import Lever, too_light, weight_on_lever
from drivesizer.physics.load_cycle import LoadCycle


class Arm(SharedLoad):
    """A joint that swings an arm against gravity."""

    axis: ClassVar[fields.Axis] = "rotary"
    has_end: ClassVar[bool] = True
    takes_payload: ClassVar[bool] = True
    kind: Literal["arm"]
    mass: fields.Mass = fields.required("of arm and payload")
    length: fields.Length = fields.required("from the joint to their centre of mass")
    inertia: fields.Inertia | None = fields.optional("about the joint; mass times length squared if not given")
    start_angle: fields.Bearing = fields.default("0 deg", "above the level line, when the cycle starts")
    tilt: fields.Incline = fields.default("0 deg", "of the joint's axis from level; 90 deg feels no gravity")
    friction_torque: fields.Torque = fields.default("0 N*m", "of the joint, against the motion")

    def _contradictions(self) -> Iterator[str]:
        yield from super()._contradictions()
        if self.inertia is not None:
            yield from too_light(self.inertia, self.mass, self.length, "length")

    @property
    def lever(self) -> Lever:
        """Arm and payload, about the joint's axis."""
        return Lever(self.mass, self.length, np.cos(self.tilt), self.start_angle)


def arm(load: Arm, gravity: float, course: Course) -> LoadCycle:
    """Load cycle at the joint.

    Parameters
    ----------
    load
        The arm.
    gravity
        Acceleration of free fall [m/s^2].
    course
        How the joint turns, upward positive.

    Returns
    -------
    LoadCycle
        At the joint of one drive: speed [rad/s], torque [N*m], per segment its two ends.

    Raises
    ------
    FieldError
        When the arm turns round too often in one cycle.
    InputError
        When a figure leaves the range of numbers that can be computed with.
    """
    inertia = load.mass * load.length * load.length if load.inertia is None else load.inertia
    course, weight = weight_on_lever(load.lever, gravity, course)
    torque = inertia * course.acceleration + weight + load.friction_torque * course.direction
    torque, inertia = torque + course.resisting, inertia + course.balance
    if np.any(course.payload):  # in the hand, where the centre of mass is
        level = load.lever._replace(mass=1.0).moment(gravity) * np.cos(load.start_angle + course.position)
        torque = torque + course.payload * (load.length**2 * course.acceleration + level)
        inertia = inertia + course.heaviest * load.length**2
    return course.cycle(torque / load.motors, inertia=inertia / load.motors)
