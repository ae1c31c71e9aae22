r"""A fan, pump or flywheel: torque that grows with a power of speed, against the motion, and inertia.

.. math:: T = \frac{1}{N} \left( \left( T_r |ω / ω_r|^n + T_f \right) \mathrm{sgn} ω + J α \right)

The affinity laws give n = 2: torque with the square of speed, power with its cube. Where torque is not linear in speed
a ramp from standstill to the cycle's top speed is cut into 128 pieces, others in proportion; the straight lines between
are off by n(n-1)/8/128² of the torque at top speed, 1.5e-5 of it for a fan and 2e-4 at most. No cycle is cut into more
than some 10 000 pieces (``torque_curved``).

Worked examples: a fan takes 6.3 hp at a flow of 15 800 and 12.778 hp at 20 000 cubic feet a minute, flow as speed
(Calculated Industries, Sheet Metal/HVAC Pro Calc, user's guide, fan law 3). A flywheel of 5.0 kg·m² at 60 rad/s comes
to rest in 5.0 minutes by a friction of 1.0 N·m: on that ramp its shaft takes no torque (H. C. Verma, Concepts of
Physics, rotational mechanics).
"""

from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from drivesizer.files.fields import Axis, Exponent, Inertia, Torque, Turning, default
from drivesizer.loads.course import Course
from drivesizer.loads.model import SharedLoad
from drivesizer.loads.torque_curved import capped
from drivesizer.physics.load_cycle import Ends, LoadCycle

__all__ = ["Fan", "fan"]

_PIECES = 128  # of a ramp from standstill to top speed


class Fan(SharedLoad):
    """A fan, pump or flywheel: torque that grows with a power of speed, and inertia."""

    axis: ClassVar[Axis] = "rotary"
    kind: Literal["fan", "flywheel"]
    inertia: Inertia
    rated_torque: Torque = default("0 N*m", description="at rated_speed")
    rated_speed: Turning | None = Field(default=None, description="where rated_torque is taken")
    exponent: Exponent = Field(default=2, description="2 for fans and pumps, 1 for an eddy current brake")
    friction_torque: Torque = default("0 N*m", description="at any speed, against the motion")

    @model_validator(mode="after")
    def _rated(self) -> Self:
        if self.rated_torque and self.rated_speed is None:
            raise ValueError("give rated_speed beside rated_torque")
        if self.exponent < 1.0:
            raise ValueError("exponent must be at least 1; torque that is the same at any speed is friction_torque")
        return self


@np.errstate(over="ignore", invalid="ignore")  # the load cycle refuses what is not finite
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
    top = float(np.abs(course.speed).max())
    if load.rated_torque > 0.0 and load.exponent > 1.0 and top > 0.0:
        course = course.finer(capped(_PIECES * np.ptp(course.speed, axis=1) / top))
    resistance = (_flow_torque(load, course) + load.friction_torque) * course.direction
    torque = resistance + load.inertia * course.acceleration
    return course.cycle(torque / load.motors, inertia=load.inertia / load.motors)


def _flow_torque(load: Fan, course: Course) -> Ends:
    """Torque that moves the air: T_r |w/w_r|^n, without its sign [N*m]."""
    if load.rated_speed is None:
        return np.zeros_like(course.speed)
    torque: Ends = load.rated_torque * np.abs(course.speed / load.rated_speed) ** load.exponent
    return torque
