r"""A rack that a pinion moves, or a carriage that runs along a rack, seen from the pinion.

.. math:: F = m g \sin β + μ m g \cos β \, \mathrm{sgn} v + F_f \, \mathrm{sgn} v + F_0 + m a

at the pitch radius, through the efficiency of the toothing in either direction of power, and the inertia of pinion and
shaft (``stage_losses``). Friction is nothing at rest.

Worked examples: 820 kg on the level in 1 s to 2 m/s, μ 0.1: 820 · 9.81 · 0.1 + 820 · 2 = 2.44 kN at the toothing;
300 kg upward in 0.27 s to 1.08 m/s: 300 · 9.81 + 300 · 4 = 4.1 kN (Atlanta Drive Systems, rack and pinion drives,
calculation and selection).
"""

from typing import ClassVar, Literal

from drivesizer.files import fields
from drivesizer.loads.course import Course
from drivesizer.loads.model import SharedLoad
from drivesizer.loads.stage_losses import force_along, through_stage
from drivesizer.physics.load_cycle import LoadCycle


class RackPinion(SharedLoad):
    """A rack that a pinion moves, or a carriage that runs along a rack, level to upright."""

    axis: ClassVar[fields.Axis] = "linear"
    has_end: ClassVar[bool] = True
    takes_payload: ClassVar[bool] = True
    loads_shaft: ClassVar[bool] = True
    kind: Literal["rack_pinion"]
    mass: fields.Mass
    pinion_diameter: fields.Length = fields.required("of its pitch circle")
    efficiency: fields.Share = fields.default(1, "of the toothing, in either direction of power")
    incline: fields.Incline = fields.default("0 deg", "of the forward motion, upward positive")
    friction_coefficient: fields.Coefficient = fields.default(0, "of the guide")
    friction_force: fields.Force = fields.default("0 N", "of the guide's seals, against the motion")
    force: fields.Pull = fields.default("0 N", "further force against the forward motion, at rest too")
    inertia: fields.Inertia = fields.default("0 kg*m^2", "of pinion and shaft")


def rack_pinion(load: RackPinion, gravity: float, course: Course) -> LoadCycle:
    """Load cycle at the pinion.

    Parameters
    ----------
    load
        What is moved along or by the rack.
    gravity
        Acceleration of free fall [m/s^2].
    course
        How it moves.

    Returns
    -------
    LoadCycle
        At the pinion of one drive: speed [rad/s], torque [N*m], per segment its two ends.

    Raises
    ------
    InputError
        When a figure leaves the range of numbers that can be computed with.
    """
    force = force_along(course, load, gravity, load.mass)
    losses = (load.efficiency, load.efficiency)
    radius = load.pinion_diameter / 2
    return through_stage(course, force, radius, losses, mass=load.mass, turning=load.inertia, motors=load.motors)
