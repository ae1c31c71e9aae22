r"""A fan, pump or flywheel: torque that grows with a power of speed, against the motion, and inertia.

.. math:: T = \frac{1}{N} \left( \left( T_r |ω / ω_r|^n + T_f \right) \mathrm{sgn} ω + J α \right)

The affinity laws give n = 2: torque with the square of speed, power with its cube. Where torque is not linear in speed
a ramp from standstill to the cycle's top speed is cut into 128 pieces, others in proportion; the straight lines between
are off by n(n-1)/8/128² of the torque at top speed, 1.5e-5 of it for a fan and 2e-4 at most. No cycle is cut into more
than some 10 000 pieces (``weight_on_lever``).

Worked examples: a fan takes 6.3 hp at a flow of 15 800 and 12.778 hp at 20 000 cubic feet a minute, flow as speed
(Calculated Industries, Sheet Metal/HVAC Pro Calc, user's guide, fan law 3). A flywheel of 5.0 kg·m² at 60 rad/s comes
to rest in 5.0 minutes by a friction of 1.0 N·m: on that ramp its shaft takes no torque (H. C. Verma, Concepts of
Physics, rotational mechanics).
"""

from collections.abc import Iterator
from typing import Any, ClassVar, Literal

import numpy as np

from drivesizer.files import fields
from drivesizer.loads.course import Course
from drivesizer.loads.model import SharedLoad
from drivesizer.loads.springs import capped
from drivesizer.physics.load_cycle import LoadCycle

_PIECES = 128  # of a ramp from standstill to top speed


class Fan(SharedLoad):
    """A fan, pump or flywheel: torque that grows with a power of speed, and inertia."""

    axis: ClassVar[fields.Axis] = "rotary"
    kind: Literal["fan", "flywheel"]
    inertia: fields.Inertia
    rated_torque: fields.Torque = fields.default("0 N*m", "at rated_speed")
    rated_speed: fields.Turning | None = fields.optional("where rated_torque is taken")
    exponent: fields.Exponent = fields.default(2, "2 for fans and pumps, 1 for an eddy current brake")
    friction_torque: fields.Torque = fields.default("0 N*m", "at any speed, against the motion")

    def _contradictions(self) -> Iterator[str]:
        yield from super()._contradictions()
        if self.rated_torque and self.rated_speed is None:
            yield "give rated_speed beside rated_torque"
        if self.exponent < 1.0:
            yield "exponent must be at least 1; torque that is the same at any speed is friction_torque"


def fan(load: Fan, gravity: float, course: Course) -> LoadCycle:
    """Load cycle at the shaft of a fan, pump or flywheel.

    Parameters
    ----------
    load
        The fan, pump or flywheel.
    gravity
        Acceleration of free fall [m/s^2].
    course
        How it turns.

    Returns
    -------
    LoadCycle
        At the shaft of one drive: speed [rad/s], torque [N*m], per segment its two ends.

    Raises
    ------
    InputError
        When a figure leaves the range of numbers that can be computed with.
    """
    top = np.abs(course.speed).max(axis=(0, 1))
    if np.any(load.rated_torque) and np.any(np.greater(load.exponent, 1.0)) and np.any(top):
        course = course.finer(capped(_PIECES * np.ptp(course.speed, axis=1) / np.where(top > 0.0, top, 1.0)))
    air_torque: Any = 0.0  # by the air, without its sign
    if load.rated_speed is not None:
        air_torque = load.rated_torque * np.abs(course.speed / load.rated_speed) ** load.exponent
    torque = (air_torque + load.friction_torque) * course.direction + load.inertia * course.acceleration
    return course.cycle((torque + course.resisting) / load.motors, inertia=load.inertia / load.motors)
