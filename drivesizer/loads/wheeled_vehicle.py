r"""A vehicle on driven wheels, seen from the shaft of one of them.

.. math:: T = \frac{r}{N} \left( C_{rr} m g \cos θ \, \mathrm{sgn} v + m g \sin θ + \tfrac{1}{2} ρ A u |u| \right)
              + \left( J_w + J_s + \frac{m r^2}{N} \right) \frac{a}{r}, \quad u = v + v_{wind}

Rolling resistance is against the motion and nothing at rest; the slope pulls always, and so does the wind. All driven
wheels share alike. The paper's factors (speed reserve, bearing, oversize) are no physics and not in here. Grip: a wheel
transmits what is left of the torque after it has turned itself (and, with an efficiency, the running gear: T / e where
the drive drives, T e where the vehicle does), and each of the N driven ones carries an N-th of their
share s of the weight, :math:`F \le μ s m g \cos θ / N`; casters carry the rest.

Worked example: 45 kg on 4 wheels of 152.4 mm, C_rr 0.02, level, at 1.5 m/s: 0.02 · 45 · 9.80665 · 0.0762 / 4
= 0.168 N·m at 19.69 rad/s (equations (3), (5) of Appl. Sci. 2021, 11, 6631, with bearing factor 1).
"""

import math
from collections.abc import Iterator
from typing import ClassVar, Literal

import numpy as np

from drivesizer import equations as eq
from drivesizer.files import fields
from drivesizer.loads.course import Course, at_largest
from drivesizer.loads.model import Count, LoadModel
from drivesizer.loads.stage_losses import FixedGear, through_gear
from drivesizer.physics.figures import Alike, Figure
from drivesizer.physics.load_cycle import LoadCycle, OwnLimit

_PIECES = 64  # of a ramp in wind: the straight lines are off by 1/4 of 1/64² of the drag at its end, 6e-5 of it


class Cylinder(fields.Section):
    """A rotating hollow cylinder, (8) and (9)."""

    density: fields.Density
    outer_diameter: fields.Length
    inner_diameter: fields.Thickness = fields.default("0 mm", "0 when solid")
    width: fields.Length

    def _contradictions(self) -> Iterator[str]:
        if not self.inner_diameter < self.outer_diameter:
            yield "inner_diameter must be below outer_diameter"


class Cylinders(fields.Section):
    """The cylinders that turn with each driven wheel."""

    wheel: Cylinder
    shaft: Cylinder | None = None


class WheeledVehicle(LoadModel):
    """A vehicle on driven wheels, each with its own drive."""

    axis: ClassVar[fields.Axis] = "linear"
    takes_payload: ClassVar[bool] = True
    loads_shaft: ClassVar[bool] = True
    kind: Literal["wheeled_vehicle"]
    mass: fields.Mass = fields.required("whole vehicle, payload included")
    driven_wheels: Count = fields.required("wheels with a drive")
    wheel_diameter: fields.Length = fields.required(example="150 mm")
    rolling_resistance: fields.Part | None = fields.optional("C_rr; or give sinkage")
    sinkage: fields.Thickness | None = fields.optional(
        "sinking depth z of (4); or give rolling_resistance", example="2 mm"
    )
    friction_coefficient: fields.Coefficient | None = fields.optional("between wheel and floor, for traction")
    driven_share: fields.Share | None = fields.optional(
        "of the weight that the driven wheels carry, for traction; all of it where not given. Casters and "
        "other wheels carry the rest. A platform has it by the places of its wheels"
    )
    efficiency: fields.Share = fields.default(
        1,
        "of the running gear between the drive's shaft and the wheel (final drive, joints, track), either way",
    )
    slope: fields.Slope = fields.default("0 deg", "uphill positive")
    drag_area: fields.Area = fields.default("0 m^2", "drag coefficient times frontal area")
    headwind: fields.SignedSpeed = fields.default("0 m/s", "against the forward motion positive")
    air_density: fields.Density = fields.default("1.2 kg/m^3")
    cylinders: Cylinders | None = fields.optional("wheel and shaft; or give inertia")
    inertia: fields.Inertia | None = fields.optional("of one wheel with its shaft; or give cylinders")

    def _contradictions(self) -> Iterator[str]:
        yield from fields.exactly_one(self, "rolling_resistance", "sinkage")
        yield from fields.exactly_one(self, "cylinders", "inertia")
        if self.sinkage is not None and self.sinkage >= self.wheel_diameter:
            yield "sinkage must be below wheel_diameter"

    @property
    def motors(self) -> int:
        """Number of drives that share the load."""
        return self.driven_wheels

    @property
    def alike(self) -> int:
        """Number of drives that the load cycle applies to: all."""
        return self.driven_wheels


def wheeled_vehicle(load: WheeledVehicle, gravity: float, course: Course) -> LoadCycle:
    """Load cycle at one driven wheel.

    Parameters
    ----------
    load
        The vehicle.
    gravity
        Acceleration of free fall [m/s^2].
    course
        How it moves.

    Returns
    -------
    LoadCycle
        At the driven wheel of one drive: speed [rad/s], torque [N*m], per segment its two ends.

    Raises
    ------
    InputError
        When a figure leaves the range of numbers that can be computed with.
    """
    r, N = load.wheel_diameter / 2, load.driven_wheels
    if np.any(load.drag_area):
        ramps = np.ptp(course.speed, axis=1).reshape(len(course.duration), -1).any(axis=1)
        course = course.finer(np.where(ramps, _PIECES, 1))
    turning = turning_inertia(load)
    mass = load.mass + course.payload
    weight = mass * gravity * np.sin(load.slope)
    rolling = eq.nominal_force(rolling_resistance(load), mass, gravity, load.slope) - weight
    wind = course.speed + load.headwind
    drag = load.air_density * load.drag_area * wind * np.abs(wind) / 2
    force = rolling * course.direction + weight + drag + mass * course.acceleration
    torque = force * r / N + turning * course.acceleration / r
    inertia = turning + (load.mass + course.heaviest) * r**2 / N
    if load.friction_coefficient is None:
        return through_running_gear(load, course.cycle(torque, r, inertia=inertia))
    size, grip = np.abs(force / N), wheel_friction(load, gravity) * (1.0 + course.payload / load.mass)
    time, demand, limit = at_largest(size / grip, course.duration, size, grip)
    own = (OwnLimit("traction", demand, limit, time),)
    return through_running_gear(load, course.cycle(torque, r, inertia=inertia, own=own))


def through_running_gear(load: WheeledVehicle, cycle: LoadCycle) -> LoadCycle:
    """The load cycle of a wheel at the shaft of its drive, with what the running gear between them loses.

    Parameters
    ----------
    load
        The vehicle.
    cycle
        At one of its driven wheels.

    Returns
    -------
    LoadCycle
        At the shaft; the same where nothing is lost.
    """
    lossless = np.all(np.equal(load.efficiency, 1.0))
    return cycle if lossless else through_gear(cycle, FixedGear(1.0, load.efficiency, load.efficiency))


def rolling_resistance(load: WheeledVehicle) -> Alike:
    """C_rr of a vehicle [1]: given, or by (4)."""
    if load.sinkage is None:
        return load.rolling_resistance
    return eq.rolling_resistance_coefficient(load.sinkage, load.wheel_diameter)


def turning_inertia(load: WheeledVehicle) -> Alike:
    """J_w + J_s: given, or from the cylinders by (8) and (9) [kg*m^2]."""
    if load.cylinders is None:
        return load.inertia
    inertia: Alike = 0.0
    for c in (load.cylinders.wheel, load.cylinders.shaft):
        if c is not None:
            r_a, r_i = c.outer_diameter / 2, c.inner_diameter / 2
            inertia = inertia + eq.cylinder_inertia(eq.cylinder_mass(c.density, r_a, r_i, c.width), r_a, r_i)
    return inertia


def wheel_friction(load: WheeledVehicle, gravity: Figure) -> Alike:
    """Force that friction transmits at a driven wheel [N]; unknown without a coefficient.

    Parameters
    ----------
    load
        The vehicle; where its driven wheels stand is not known.
    gravity
        Acceleration of free fall [m/s^2].

    Returns
    -------
    float or array
        Largest force along the floor [N]; NaN without a coefficient of friction.
    """
    friction = math.nan if load.friction_coefficient is None else load.friction_coefficient
    share = 1.0 if load.driven_share is None else load.driven_share
    return friction * share * load.mass * gravity * np.cos(load.slope) / load.driven_wheels
