r"""An indexing or turning table, level or tilted, balanced or not.

.. math:: T = \frac{1}{N} \left( J α + T_f \, \mathrm{sgn} ω + T_0 + m g ε \sin τ \cos(φ_0 + φ) \right)

An axis tilted by τ from the vertical lets the centre of mass, ε off the axis, climb and fall; φ counts from the level
line through the axis, in the direction of the motion, and the angle at the start of the cycle is φ₀. J is of all that
turns, the mass off the axis included. How fine the weight's torque is followed: ``weight_on_lever``.

Worked example: a merry-go-round as a disc of 50.0 kg and 1.50 m radius (56.25 kg·m²) with a child of 18.0 kg at 1.25 m
(28.13 kg·m²) accelerates at 4.44 rad/s² under 250 N at the rim, 375 N·m (OpenStax, College Physics, dynamics of
rotational motion).
"""

from collections.abc import Iterator
from typing import ClassVar, Literal

import numpy as np

from drivesizer.files import fields
from drivesizer.loads.course import Course
from drivesizer.loads.model import SharedLoad
from drivesizer.loads.springs import Lever, too_light, weight_on_lever
from drivesizer.physics.load_cycle import LoadCycle


class RotaryTable(SharedLoad):
    """An indexing or turning table, level or tilted, balanced or not."""

    axis: ClassVar[fields.Axis] = "rotary"
    kind: Literal["rotary_table"]
    inertia: fields.Inertia = fields.required("of table and load about the axis")
    friction_torque: fields.Torque = fields.default("0 N*m", "of the bearing, against the motion")
    torque: fields.SignedTorque = fields.default("0 N*m", "further torque against the forward motion")
    mass: fields.Counterweight = fields.default("0 kg", "of what turns, where its centre is off the axis")
    eccentricity: fields.Thickness = fields.default("0 mm", "of that centre")
    tilt: fields.Incline = fields.default("0 deg", "of the axis from the vertical; 90 deg lies level")
    start_angle: fields.Bearing = fields.default("0 deg", "of the centre from the level line, when the cycle starts")

    def _contradictions(self) -> Iterator[str]:
        yield from super()._contradictions()
        yield from too_light(self.inertia, self.mass, self.eccentricity, "eccentricity")

    @property
    def lever(self) -> Lever:
        """Mass off the axis, about the table's axis."""
        return Lever(self.mass, self.eccentricity, np.sin(self.tilt), self.start_angle)


def rotary_table(load: RotaryTable, gravity: float, course: Course) -> LoadCycle:
    """Load cycle at the table's axis.

    Parameters
    ----------
    load
        The table.
    gravity
        Acceleration of free fall [m/s^2].
    course
        How it turns.

    Returns
    -------
    LoadCycle
        At the table's axis of one drive: speed [rad/s], torque [N*m], per segment its two ends.

    Raises
    ------
    FieldError
        When an unbalanced table turns round too often in one cycle.
    InputError
        When a figure leaves the range of numbers that can be computed with.
    """
    course, weight = weight_on_lever(load.lever, gravity, course)
    torque = load.inertia * course.acceleration + load.friction_torque * course.direction + load.torque + weight
    inertia = load.inertia + course.balance
    return course.cycle((torque + course.resisting) / load.motors, inertia=inertia / load.motors)
