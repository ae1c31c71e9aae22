r"""A cascade whose current loop runs at the velocity loop's rate, for the simulation of long motions.

A current loop runs ten times as often as the loop around it, and a simulation costs by its periods. The winding under
the gains of the magnitude optimum is a lag :math:`T = L / k_p`; what that is after a velocity period :math:`h`,
:math:`1 - b` with :math:`b = 1 - e^{-h/T}`, follows from the winding held over such a period,
:math:`i' = a i + (1 - a) u / R` with :math:`a = e^{-hR/L}`, by the PI that cancels its pole:

.. math:: k_p = \frac{a\,b\,R}{1 - a}, \quad k_i h = b R

It answers at once, as the lag includes the delay. All else is unchanged: the outer loops with their delays, counts,
friction, backlash, limits, heat. The current between two samples of the velocity loop is left out.
"""

from __future__ import annotations

import math
from dataclasses import replace

from drivesizer.control.cascade import Cascade
from drivesizer.control.engine import Drive

__all__ = ["slower"]


def slower(drive: Drive) -> Drive | None:
    """A drive with its current loop at the velocity loop's rate."""
    c, m = drive.controller, drive.train
    if not isinstance(c, Cascade) or c.current_steps == 1 or not c.current_kp > 0.0:
        return None
    h, R = c.velocity_period, m.resistance
    decay = math.exp(-h * R / m.inductance)
    share = -math.expm1(-h * c.current_kp / m.inductance)
    gains = replace(
        c, current_kp=decay * share * R / (1.0 - decay), current_ki=share * R / h, current_period=h
    )  # fmt: skip
    return replace(drive, controller=gains, prompt=True)
