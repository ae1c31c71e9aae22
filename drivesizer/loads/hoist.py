r"""A hoist, seen from its rope drum.

.. math:: F = (m - m_c) g + (m + m_c) a + F_f \, \mathrm{sgn} v

lifts the load; upward is forward. With n falls the rope runs n times as fast and pulls with an n-th of F, so that the
load moves by r/n per angle of the drum. The counterweight hangs against the load with as many falls (as a lift is roped
2:1 on both sides), and both share one rope efficiency, which takes the unbalanced force: lifting divides by it,
lowering multiplies by it (``stage_losses``); the friction of the drum's bearings comes on top. At rest the unbalanced
weight remains, for motor or brake.
A rope cannot push: a motion that would let it go slack is refused.

Worked example: a cab of 1200 kg and a counterweight of 950 kg that rise 54 m in 3.0 min need
250 · 9.8 · 0.30 = 7.4 · 10² W (Halliday, Resnick, Walker: Fundamentals of Physics, kinetic energy and work, freight
elevator).
"""

from typing import ClassVar, Literal

import numpy as np

from drivesizer.errors import FieldError
from drivesizer.files import fields
from drivesizer.loads.course import Course
from drivesizer.loads.model import Count, SharedLoad
from drivesizer.loads.stage_losses import through_stage
from drivesizer.physics.load_cycle import LoadCycle

_ROUNDING = 1e-9  # of gravity: a load that falls freely pulls with nothing, whatever its figures are rounded to


class Hoist(SharedLoad):
    """A rope drum that lifts a mass, with or without a counterweight."""

    axis: ClassVar[fields.Axis] = "linear"
    has_end: ClassVar[bool] = True
    takes_payload: ClassVar[bool] = True
    loads_shaft: ClassVar[bool] = True
    kind: Literal["hoist"]
    mass: fields.Mass = fields.required("of what is lifted, its carrier included")
    counterweight: fields.Counterweight = fields.default("0 kg", "hung against the mass, with as many falls")
    drum_diameter: fields.Length
    falls: Count = fields.default(1, "rope parts that carry the mass; the rope runs so many times faster")
    rope_efficiency: fields.Share = fields.default(1, "of rope and sheaves, in either direction of power")
    friction_force: fields.Force = fields.default("0 N", "of the guides, against the motion")
    friction_torque: fields.Torque = fields.default("0 N*m", "of the drum's bearings, against the motion")
    inertia: fields.Inertia = fields.default("0 kg*m^2", "of drum and sheaves, seen at the drum")


def hoist(load: Hoist, gravity: float, course: Course) -> LoadCycle:
    """Load cycle at the drum.

    Parameters
    ----------
    load
        The hoist.
    gravity
        Acceleration of free fall [m/s^2].
    course
        How the load moves, upward positive.

    Returns
    -------
    LoadCycle
        At the drum of one drive: speed [rad/s], torque [N*m], per segment its two ends.

    Raises
    ------
    FieldError
        When the rope would go slack.
    InputError
        When a figure leaves the range of numbers that can be computed with.
    """
    moving_mass = load.mass + load.counterweight
    weight = (load.mass + course.payload - load.counterweight) * gravity
    force = weight + (moving_mass + course.payload) * course.acceleration + load.friction_force * course.direction
    force = force + course.resisting
    falls_freely = np.abs(course.acceleration) > gravity * (1.0 + _ROUNDING)  # then the counterweight's rope is slack
    if np.where(load.counterweight == 0.0, force < -_ROUNDING * load.mass * gravity, falls_freely).any():
        raise FieldError(("motion",), "the rope goes slack, as it cannot push; expected less acceleration or friction")
    losses = (load.rope_efficiency, load.rope_efficiency)
    radius = load.drum_diameter / 2 / load.falls
    return through_stage(course, force, radius, losses, mass=moving_mass, turning=load.inertia, motors=load.motors,
                         drag=load.friction_torque)  # fmt: skip
