r"""Traction of a wheel by its slip speed.

Traction grows in proportion to slip speed s and runs smoothly into the friction coefficient,

.. math:: F = -μ N \tanh\frac{|s|}{s_0 + c\,|v|} \frac{s}{|s|},

the hyperbolic tangent of [1]_ for dry friction. A wheel with rollers grips along the roller's axis only, as in [2]_,
who model an omnidirectional robot with slip; one without rollers grips along and across, within one friction circle.
:math:`s_0` is where the straight line through 0 would meet μN. c is that of a tyre that rolls at v: its slip at a
force is then a share of the travelled distance, not of the time, and μN/c is its slip stiffness [3]_.
There is no stiction: a platform at rest on a slope creeps by force over stiffness.

.. [1] S. Andersson, A. Söderberg, S. Björklund, "Friction models for sliding dry, boundary and mixed lubricated
   contacts", Tribology International 40 (2007) 580-587.
.. [2] R. L. Williams II, B. E. Carter, P. Gallina, G. Rosati, "Dynamic model with slip for wheeled omnidirectional
   robots", IEEE Transactions on Robotics and Automation 18 (2002) 285-293.
.. [3] H. B. Pacejka, *Tire and Vehicle Dynamics*, 3rd ed., Butterworth-Heinemann 2012.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from drivesizer.errors import InputError

__all__ = ["Contact", "grip", "grip_slope"]

_LARGEST = 1e9  # of any figure, in SI


@dataclass(frozen=True, slots=True, kw_only=True)
class Contact:
    """Contact of wheels and floor; defaults are those of rubber or polyurethane on a smooth hard floor."""

    friction: float = 0.6  # μ [1]
    slip_speed: float = 0.01  # m/s, s_0
    creep: float = 0.0  # c [1]: slip over rolling speed at which the straight line meets μN
    turnround: float = 1e-3  # m/s, in which dry friction of axles, rollers and casters reverses

    def __post_init__(self) -> None:
        for f in fields(self):
            value = getattr(self, f.name)
            least = 0.0 if f.name == "creep" else 1e-12
            if not least <= value < _LARGEST:  # written so that NaN fails too
                bound = "0 or more" if f.name == "creep" else "above 0"
                raise InputError(f"contact: {f.name} must be {bound} and below {_LARGEST:g}, got {value!r}")


def grip(x: float) -> float:
    """Share of μN over slip, x = 1 where the straight line meets it."""
    return math.tanh(x)


def grip_slope(share: float) -> float:
    """Rate of change of ``grip`` where it has a value."""
    return 1.0 - share * share
