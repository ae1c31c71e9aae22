r"""A rack that a pinion moves, or a carriage that runs along a rack, seen from the pinion.

.. math:: F = m g \sin β + μ m g \cos β \, \mathrm{sgn} v + F_f \, \mathrm{sgn} v + F_0 + m a

at the pitch radius, through the efficiency of the toothing in either direction of power, and the inertia of pinion and
shaft (``stage_losses``). Friction is nothing at rest.

Worked examples: 820 kg along a level way in 1 s to 2 m/s, μ 0.1: 820 · 9.81 · 0.1 + 820 · 2 = 2.44 kN at the toothing;
300 kg upward in 0.27 s to 1.08 m/s: 300 · 9.81 + 300 · 4 = 4.1 kN (Atlanta Drive Systems, rack and pinion drives,
calculation and selection).
"""

from __future__ import annotations

import numpy as np

from drivesizer.loads.course import Course
from drivesizer.loads.stage_losses import force_along, through_stage
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.spec.loads import RackPinion
from drivesizer.spec.robot import RobotSpec

__all__ = ["rack_pinion"]


@np.errstate(over="ignore", invalid="ignore")  # the load cycle refuses what is not finite
def rack_pinion(spec: RobotSpec, course: Course) -> LoadCycle:
    """The load cycle at the pinion of one motor set.

    Parameters
    ----------
    spec
        What is moved along or by the rack.
    course
        How it moves.

    Raises
    ------
    InputError
        When a figure leaves the range of numbers that can be computed with.
    """
    load, g = spec.load, spec.environment.gravity
    assert isinstance(load, RackPinion)
    force = force_along(course, load, g, load.mass)
    losses = (load.efficiency, load.efficiency)
    radius = load.pinion_diameter / 2
    return through_stage(course, force, radius, losses, mass=load.mass, turning=load.inertia, motors=load.motors)
