r"""A belt conveyor, level or inclined, seen from its driven drum.

.. math:: F = μ (m + m_b) g \cos β \, \mathrm{sgn} v + F_f \, \mathrm{sgn} v + m g \sin β + F_0 + (m + m_b) a

through the efficiency of belt and drums, in either direction of power, and the drums' inertia (``stage_losses``). The
belt is
a loop: its weight pulls up as much as down, so that only the goods climb; but all of it is accelerated, and all of it
rubs, the return run on its rollers like the carrying run on the bed. Friction is nothing at rest.

Worked example: goods and belt 20 kg, μ 0.3, drum 90 mm, efficiency 0.9: 0.3 · 20 · 9.807 · 0.045 / 0.9 = 2.94 N·m
(Oriental Motor, technical reference, motor sizing: belt conveyor).
"""

from __future__ import annotations

import numpy as np

from drivesizer.loads.course import Course
from drivesizer.loads.stage_losses import force_along, through_stage
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.spec.loads import Conveyor
from drivesizer.spec.robot import RobotSpec

__all__ = ["conveyor"]


@np.errstate(over="ignore", invalid="ignore")  # the load cycle refuses what is not finite
def conveyor(spec: RobotSpec, course: Course) -> LoadCycle:
    """The load cycle at the driven drum of one motor set.

    Parameters
    ----------
    spec
        The conveyor.
    course
        How the belt moves.

    Raises
    ------
    InputError
        When a figure leaves the range of numbers that can be computed with.
    """
    load, g = spec.load, spec.environment.gravity
    assert isinstance(load, Conveyor)
    moved = load.mass + load.belt_mass
    force = force_along(course, load, g, moved)
    losses = (load.efficiency, load.efficiency)
    radius = load.drum_diameter / 2
    return through_stage(course, force, radius, losses, mass=moved, turning=load.inertia, motors=load.motors)
