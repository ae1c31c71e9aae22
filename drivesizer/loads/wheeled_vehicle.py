r"""A vehicle on driven wheels, seen from the shaft of one of them.

.. math:: T = \frac{r}{N} \left( C_{rr} m g \cos θ \, \mathrm{sgn} v + m g \sin θ + \tfrac{1}{2} ρ A u |u| \right)
              + \left( J_w + J_s + \frac{m r^2}{N} \right) \frac{a}{r}, \quad u = v + v_{wind}

Rolling resistance is against the motion and nothing at rest; the slope pulls always, and so does the wind. All driven
wheels share alike. The paper's factors (speed reserve, bearing, oversize) are no physics and not in here. Grip: a wheel
transmits what is left of the torque after it has turned itself, and each of the N driven ones carries an N-th of their
share s of the weight, :math:`F \le μ s m g \cos θ / N`; casters carry the rest.

Worked example: 45 kg on 4 wheels of 152.4 mm, C_rr 0.02, level, at 1.5 m/s: 0.02 · 45 · 9.80665 · 0.0762 / 4
= 0.168 N·m at 19.69 rad/s (equations (3), (5) of Appl. Sci. 2021, 11, 6631, with bearing factor 1).
"""

from __future__ import annotations

import math

import numpy as np

from drivesizer import equations as eq
from drivesizer.loads.course import Course
from drivesizer.physics.load_cycle import Ends, LoadCycle, OwnLimit
from drivesizer.spec.loads import Cylinder, WheeledVehicle
from drivesizer.spec.robot import RobotSpec

__all__ = ["grip_warning", "held_by_a_wheel", "rolling_resistance", "turning_inertia", "wheeled_vehicle"]

_STANDS = 3  # wheels at least
_PIECES = 64  # of a ramp in wind: the straight lines are off by 1/4 of 1/64² of the drag at its end, 6e-5 of it


def wheeled_vehicle(spec: RobotSpec, course: Course) -> LoadCycle:
    """The load cycle at one driven wheel.

    Parameters
    ----------
    spec
        The vehicle.
    course
        How it moves.

    Raises
    ------
    InputError
        When a figure leaves the range of numbers that can be computed with.
    """
    load, g = spec.load, spec.environment.gravity
    assert isinstance(load, WheeledVehicle)
    r, N = load.wheel_diameter / 2, load.driven_wheels
    if load.drag_area > 0.0:
        course = course.finer(np.where(np.ptp(course.speed, axis=1) > 0.0, _PIECES, 1))
    turning = turning_inertia(load)
    weight = load.mass * g * math.sin(load.slope)
    rolling = eq.nominal_force(rolling_resistance(load), load.mass, g, load.slope) - weight
    wind = course.speed + load.headwind
    drag = load.air_density * load.drag_area * wind * np.abs(wind) / 2
    force = rolling * course.direction + weight + drag + load.mass * course.acceleration
    torque = force * r / N + turning * course.acceleration / r
    inertia = turning + load.mass * r**2 / N
    own = () if spec.platform else _grip(load, g, course, force / N, turning)  # a platform's own checks know more
    return course.cycle(torque, r, inertia=inertia, own=own)


def rolling_resistance(load: WheeledVehicle) -> float:
    """C_rr of a vehicle [1]: given, or by (4)."""
    if load.sinkage is None:
        return float(load.rolling_resistance or 0.0)
    return float(eq.rolling_resistance_coefficient(load.sinkage, load.wheel_diameter))


def turning_inertia(load: WheeledVehicle) -> float:
    """J_w + J_s: given, or from the cylinders by (8) and (9) [kg*m^2]."""
    if load.cylinders is None:
        return float(load.inertia or 0.0)
    return sum(_cylinder(c) for c in (load.cylinders.wheel, load.cylinders.shaft) if c is not None)


def _cylinder(c: Cylinder) -> float:
    r_a, r_i = c.outer_diameter / 2, c.inner_diameter / 2
    return float(eq.cylinder_inertia(eq.cylinder_mass(c.density, r_a, r_i, c.width), r_a, r_i))


def _grip(load: WheeledVehicle, g: float, course: Course, force: Ends, turning: float) -> tuple[OwnLimit, ...]:
    """The largest force of a wheel on the floor against what friction transmits."""
    if load.friction_coefficient is None:
        return ()
    worst = int(np.abs(force).argmax())
    end = np.cumsum(course.duration)
    time = np.stack([end - course.duration, end], axis=1).reshape(-1)[worst]
    limit = held_by_a_wheel(load, g)
    most = float(np.abs(force).reshape(-1)[worst])
    return (OwnLimit("traction", most, limit, float(time), turning),)


def held_by_a_wheel(load: WheeledVehicle, g: float) -> float:
    """Force that friction transmits at a driven wheel [N]; unknown without a coefficient.

    Parameters
    ----------
    load
        The vehicle; where its driven wheels stand is not known.
    g
        Gravity [m/s^2].
    """
    friction = math.nan if load.friction_coefficient is None else load.friction_coefficient
    share = 1.0 if load.driven_share is None else load.driven_share
    return friction * share * load.mass * g * math.cos(load.slope) / load.driven_wheels


def grip_warning(spec: RobotSpec) -> tuple[str, ...]:
    """That casters may carry, where traction takes the driven wheels to carry all; nothing where that is clear."""
    load = spec.load
    if not isinstance(load, WheeledVehicle) or spec.platform or load.friction_coefficient is None:
        return ()
    if load.driven_share is not None or load.driven_wheels >= _STANDS:
        return ()
    wheels = "1 driven wheel" if load.driven_wheels == 1 else f"{load.driven_wheels} driven wheels"
    return (
        f"traction: all of the weight is taken to be on {wheels}, which cannot stand alone; give load.driven_share, "
        "such as 60 %, where casters or other wheels carry the rest",
    )
