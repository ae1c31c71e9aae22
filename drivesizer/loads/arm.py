r"""A joint that swings an arm against gravity.

.. math:: T = \frac{1}{N} \left( J α + m g l \cos τ \cos(φ_0 + φ) + T_f \, \mathrm{sgn} ω \right)

φ counts upward from the level line, φ₀ at the start of the cycle; a joint's axis tilted by τ from level feels the less
of gravity. J about the joint is given, or m l² as if all of the mass were in its centre, which is the least it can be.
How fine the weight's torque is followed: ``torque_curved``.

Worked example: a uniform arm of 70 cm and 4.0 kg with 3.0 kg in the hand, together 7.0 kg at 0.50 m, asks the shoulder
for 7.0 · 9.8 · 0.50 = 34 N·m level and 24 N·m at 45° below (Knight, Physics for Scientists and Engineers, rotation of a
rigid body, exercise on the athlete with a steel ball).
"""

from __future__ import annotations

import numpy as np

from drivesizer.loads.course import Course
from drivesizer.loads.torque_curved import weight_on_lever
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.spec.loads import Arm
from drivesizer.spec.robot import RobotSpec

__all__ = ["arm"]


@np.errstate(over="ignore", invalid="ignore")  # the load cycle refuses what is not finite
def arm(spec: RobotSpec, course: Course) -> LoadCycle:
    """The load cycle at the joint, for one motor set.

    Parameters
    ----------
    spec
        The arm.
    course
        How the joint turns, upward positive.

    Raises
    ------
    InputError
        When the arm turns round too often in one cycle, or a figure leaves the range of numbers that can be computed
        with.
    """
    load = spec.load
    assert isinstance(load, Arm)
    inertia = load.mass * load.length * load.length if load.inertia is None else load.inertia
    course, weight = weight_on_lever(spec, course)
    torque = inertia * course.acceleration + weight + load.friction_torque * course.direction
    return course.cycle(torque / load.motors, inertia=inertia / load.motors)
