r"""A vehicle on driven wheels, seen from the shaft of one of them.

.. math:: T = \frac{r}{N} \left( C_{rr} m g \cos θ \, \mathrm{sgn} v + m g \sin θ \right)
              + \left( J_w + J_s + \frac{m r^2}{N} \right) \frac{a}{r}

Rolling resistance is against the motion and nothing at rest; the slope pulls always. All driven wheels share alike.
The paper's factors (speed reserve, bearing, oversize) are no physics and not in here.

Worked example: 45 kg on 4 wheels of 152.4 mm, C_rr 0.02, level, at 1.5 m/s: 0.02 · 45 · 9.80665 · 0.0762 / 4
= 0.168 N·m at 19.69 rad/s (equations (3), (5) of Appl. Sci. 2021, 11, 6631, with bearing factor 1).
"""

from __future__ import annotations

import math

import numpy as np

from drivesizer import equations as eq
from drivesizer.loadcycle import LoadCycle
from drivesizer.paper import vehicle
from drivesizer.profile import Profile
from drivesizer.spec import RobotSpec

__all__ = ["wheeled_vehicle"]


def wheeled_vehicle(spec: RobotSpec, profile: Profile) -> LoadCycle:
    """The load cycle at one driven wheel, cut where the power changes direction.

    Parameters
    ----------
    spec
        The robot.
    profile
        Speed of the vehicle over one cycle.

    Raises
    ------
    InputError
        When a figure leaves the range of numbers that can be computed with.
    """
    load, g, r = spec.load, spec.environment.gravity, spec.load.wheel_diameter / 2
    steps = vehicle(spec, 0.0).steps
    turning = sum(steps[name].value for name in ("wheel_inertia", "shaft_inertia") if name in steps)
    inertia = turning + load.mass * r**2 / load.driven_wheels
    pieces = np.array(list(profile.pieces()))
    duration, speed = pieces[:, 1] - pieces[:, 0], pieces[:, 2:]
    acceleration = np.repeat(np.diff(speed, axis=1) / duration[:, None], 2, axis=1)
    weight = load.mass * g * math.sin(load.slope)
    rolling = eq.nominal_force(steps["rolling_resistance_coefficient"].value, load.mass, g, load.slope) - weight
    cycle = LoadCycle(profile.name, duration, speed / r, acceleration / r, np.zeros_like(speed)).split()
    direction = np.sign(cycle.speed.mean(axis=1, keepdims=True))
    torque = (rolling * direction + weight) * r / load.driven_wheels + inertia * cycle.acceleration
    return LoadCycle(cycle.name, cycle.duration, cycle.speed, cycle.acceleration, torque).split()
