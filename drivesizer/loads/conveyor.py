r"""A belt conveyor, level or inclined, seen from its driven drum.

.. math:: F = μ (m + m_b) g \cos β \, \mathrm{sgn} v + F_f \, \mathrm{sgn} v + m g \sin β + F_0 + (m + m_b) a

through the efficiency of belt and drums, in either direction of power, and the drums' inertia (``stage_losses``). The
belt is
a loop: its weight pulls up as much as down, so that only the goods climb; but all of it is accelerated, and all of it
rubs, the return run on its rollers like the carrying run on the bed. Friction is nothing at rest.

Worked example: goods and belt 20 kg, μ 0.3, drum 90 mm, efficiency 0.9: 0.3 · 20 · 9.807 · 0.045 / 0.9 = 2.94 N·m
(Oriental Motor, technical reference, motor sizing: belt conveyor).
"""

from typing import ClassVar, Literal

from drivesizer.files import fields
from drivesizer.loads.course import Course
from drivesizer.loads.model import SharedLoad
from drivesizer.loads.stage_losses import force_along, through_stage
from drivesizer.physics.load_cycle import LoadCycle


class Conveyor(SharedLoad):
    """A belt conveyor, level or inclined, driven at a drum."""

    axis: ClassVar[fields.Axis] = "linear"
    takes_payload: ClassVar[bool] = True
    kind: Literal["conveyor"]
    mass: fields.Mass = fields.required("goods on the belt")
    belt_mass: fields.Counterweight = fields.default("0 kg", "of the belt itself")
    drum_diameter: fields.Length
    friction_coefficient: fields.Coefficient = fields.required("of belt and goods on the bed, or of the rollers")
    friction_force: fields.Force = fields.default("0 N", "of scrapers and seals, against the motion")
    efficiency: fields.Share = fields.default(1, "of belt and drums, in either direction of power")
    incline: fields.Incline = fields.default("0 deg", "upward positive")
    force: fields.Pull = fields.default("0 N", "further force against the forward motion, at rest too")
    inertia: fields.Inertia = fields.default("0 kg*m^2", "of all drums, seen at the driven one")


def conveyor(load: Conveyor, gravity: float, course: Course) -> LoadCycle:
    """Load cycle at the driven drum.

    Parameters
    ----------
    load
        The conveyor.
    gravity
        Acceleration of free fall [m/s^2].
    course
        How the belt moves.

    Returns
    -------
    LoadCycle
        At the driven drum of one drive: speed [rad/s], torque [N*m], per segment its two ends.

    Raises
    ------
    InputError
        When a figure leaves the range of numbers that can be computed with.
    """
    moving_mass = load.mass + load.belt_mass
    force = force_along(course, load, gravity, moving_mass)
    losses = (load.efficiency, load.efficiency)
    radius = load.drum_diameter / 2
    return through_stage(course, force, radius, losses, mass=moving_mass, turning=load.inertia, motors=load.motors)
