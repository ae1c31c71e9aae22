r"""An indexing or turning table, level or tilted, balanced or not.

.. math:: T = \frac{1}{N} \left( J α + T_f \, \mathrm{sgn} ω + T_0 + m g ε \sin τ \cos(φ_0 + φ) \right)

An axis tilted by τ from the vertical lets the centre of mass, ε off the axis, climb and fall; φ counts from the level
line through the axis, in the direction of the motion, and the angle at the start of the cycle is φ₀. J is of all that
turns, the mass off the axis included. How fine the weight's torque is followed: ``torque_curved``.

Worked example: a merry-go-round as a disc of 50.0 kg and 1.50 m radius (56.25 kg·m²) with a child of 18.0 kg at 1.25 m
(28.13 kg·m²) accelerates at 4.44 rad/s² under 250 N at the rim, 375 N·m (OpenStax, College Physics, dynamics of
rotational motion).
"""

from __future__ import annotations

import numpy as np

from drivesizer.loads.course import Course
from drivesizer.loads.torque_curved import weight_on_lever
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.spec.loads import RotaryTable
from drivesizer.spec.robot import RobotSpec

__all__ = ["rotary_table"]


@np.errstate(over="ignore", invalid="ignore")  # the load cycle refuses what is not finite
def rotary_table(spec: RobotSpec, course: Course) -> LoadCycle:
    """The load cycle at the table's axis, for one motor set.

    Parameters
    ----------
    spec
        The table.
    course
        How it turns.

    Raises
    ------
    InputError
        When an unbalanced table turns round too often in one cycle, or a figure leaves the range of numbers that can
        be computed with.
    """
    load = spec.load
    assert isinstance(load, RotaryTable)
    course, weight = weight_on_lever(spec, course)
    torque = load.inertia * course.acceleration + load.friction_torque * course.direction + load.torque + weight
    return course.cycle(torque / load.motors, inertia=load.inertia / load.motors)
