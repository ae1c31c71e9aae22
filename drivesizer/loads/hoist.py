r"""A hoist, seen from its rope drum.

.. math:: F = (m - m_c) g + (m + m_c) a + F_f \, \mathrm{sgn} v

lifts the load; upward is forward. With n falls the rope runs n times as fast and pulls with an n-th of F, so that the
load moves by r/n per angle of the drum. The counterweight hangs against the load with as many falls (as a lift is roped
2:1 on both sides), and both share one rope efficiency, which takes the unbalanced force: lifting divides by it, what
comes back when lowering is multiplied by it (``stage_losses``). At rest the unbalanced weight remains, for motor or
brake.
A rope cannot push: a motion that would let it go slack is refused.

Worked example: a cab of 1200 kg and a counterweight of 950 kg that rise 54 m in 3.0 min need
250 · 9.8 · 0.30 = 7.4 · 10² W (Halliday, Resnick, Walker: Fundamentals of Physics, kinetic energy and work, freight
elevator).
"""

from __future__ import annotations

import numpy as np

from drivesizer.errors import InputError
from drivesizer.loads.course import Course
from drivesizer.loads.stage_losses import through_stage
from drivesizer.physics.load_cycle import Ends, LoadCycle
from drivesizer.spec.loads import Hoist
from drivesizer.spec.robot import RobotSpec

__all__ = ["hoist"]


@np.errstate(over="ignore", invalid="ignore")  # the load cycle refuses what is not finite
def hoist(spec: RobotSpec, course: Course) -> LoadCycle:
    """The load cycle at the drum of one motor set.

    Parameters
    ----------
    spec
        The hoist.
    course
        How the load moves, upward positive.

    Raises
    ------
    InputError
        When the rope would go slack, or a figure leaves the range of numbers that can be computed with.
    """
    load, g = spec.load, spec.environment.gravity
    assert isinstance(load, Hoist)
    moved = load.mass + load.counterweight
    weight = (load.mass - load.counterweight) * g
    force = weight + moved * course.acceleration + load.friction_force * course.direction
    if _slack(load, g, course, force):
        raise InputError(
            f"{spec.where(('motion',))}: the rope goes slack, as it cannot push; expected less acceleration or friction"
        )
    losses = (load.rope_efficiency, load.rope_efficiency)
    radius = load.drum_diameter / 2 / load.falls
    return through_stage(course, force, radius, losses, mass=moved, turning=load.inertia, motors=load.motors)


_ROUNDING = 1e-9  # of gravity: a load that falls freely pulls with nothing, whatever its figures are rounded to


def _slack(load: Hoist, g: float, course: Course, force: Ends) -> bool:
    """Whether a rope would have to push: on the load, or on the counterweight where there is one."""
    if load.counterweight == 0.0:
        return bool((force < -_ROUNDING * load.mass * g).any())
    return bool((abs(course.acceleration) > g * (1.0 + _ROUNDING)).any())
