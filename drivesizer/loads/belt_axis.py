r"""A linear axis with a carriage on a toothed belt, level to upright, seen from its driving pulley.

.. math:: F = m g \sin β + μ m g \cos β \, \mathrm{sgn} v + F_f \, \mathrm{sgn} v + F_0
              + \left( m + m_b + J_i / r_i^2 \right) a

at the radius of the driving pulley, through the efficiency of belt and pulleys in either direction of power, and beside
it the inertia of that pulley and the friction torque of its bearings (``stage_losses``). The belt is a loop: all of it
is accelerated, none of it climbs. J_i is of the idlers, at their own radius. F is the effective tension, the difference
of the two strands; pretension has to keep the slack one tight. Where the motor rides along on the carriage it counts as
mass, and the belt is at rest: its mass is 0.

Worked example: a carriage of 4 kg, μ 0.2, on two pulleys of aluminium of 64 mm by 20 mm with 0.05 N·m of friction,
behind gears of 100 mm and 20 mm, 5 : 1 at 90 %: 745 rpm, 0.0669 N·m and 2.69 kg·cm² at the motor with its coupling
(Yaskawa, JUNMA series, selection of servomotor size).
"""

from dataclasses import replace
from typing import ClassVar, Literal

import numpy as np

from drivesizer.files import fields
from drivesizer.loads.course import Course, at_largest
from drivesizer.loads.model import SharedLoad
from drivesizer.loads.stage_losses import force_along, through_stage
from drivesizer.physics.load_cycle import LoadCycle, OwnLimit


class BeltAxis(SharedLoad):
    """A linear axis: a carriage on a toothed belt, level to upright."""

    axis: ClassVar[fields.Axis] = "linear"
    has_end: ClassVar[bool] = True
    takes_payload: ClassVar[bool] = True
    loads_shaft: ClassVar[bool] = True
    kind: Literal["belt_axis"]
    mass: fields.Mass = fields.required("of the carriage and what is on it")
    pulley_diameter: fields.Length = fields.required("of the driving pulley, on its pitch circle")
    belt_mass: fields.Counterweight = fields.default("0 kg", "of the whole loop; 0 where the motor rides along")
    efficiency: fields.Share = fields.default(1, "of belt and pulleys, in either direction of power")
    incline: fields.Incline = fields.default("0 deg", "of the forward motion, upward positive; 90 deg lifts")
    friction_coefficient: fields.Coefficient = fields.default(0, "of the guide")
    friction_force: fields.Force = fields.default("0 N", "of the guide's seals, against the motion")
    friction_torque: fields.Torque = fields.default("0 N*m", "of the pulleys' bearings, seen at the driving one")
    force: fields.Pull = fields.default("0 N", "further force against the forward motion, at rest too")
    inertia: fields.Inertia = fields.default("0 kg*m^2", "of driving pulley and shaft")
    idler_inertia: fields.Inertia = fields.default("0 kg*m^2", "of all idlers together, each about its own axis")
    idler_diameter: fields.Length | None = fields.optional("of the idlers; pulley_diameter where not given")
    max_tension: fields.Force | None = fields.optional("permitted effective tension of the belt")

    @property
    def belt_moves(self) -> float:
        """Mass that is accelerated beside the carriage: belt, and idlers as a mass at their rim [kg]."""
        radius = (self.pulley_diameter if self.idler_diameter is None else self.idler_diameter) / 2
        return self.belt_mass + self.idler_inertia / radius**2


def belt_axis(load: BeltAxis, gravity: float, course: Course) -> LoadCycle:
    """Load cycle at the driving pulley.

    Parameters
    ----------
    load
        The axis.
    gravity
        Acceleration of free fall [m/s^2].
    course
        How its carriage moves.

    Returns
    -------
    LoadCycle
        At the driving pulley of one drive: speed [rad/s], torque [N*m], per segment its two ends.

    Raises
    ------
    InputError
        When a figure leaves the range of numbers that can be computed with.
    """
    force = force_along(course, load, gravity, load.mass) + load.belt_moves * course.acceleration
    losses = (load.efficiency, load.efficiency)
    cycle = through_stage(course, force, load.pulley_diameter / 2, losses, mass=load.mass + load.belt_moves,
                          turning=load.inertia, motors=load.motors, drag=load.friction_torque)  # fmt: skip
    if load.max_tension is None:
        return cycle
    time, tension = at_largest(np.abs(force), course.duration, np.abs(force))
    return replace(cycle, own=(OwnLimit("belt_axis_tension", tension / load.motors, load.max_tension, time),))
