r"""The designed loops as one torque law on angle and speed of the motor: what simulators and ROS have a place for.

.. math:: \tau = k_p (\theta_r - \theta) + k_i \int (\theta_r - \theta)\,dt + k_d (w_r - w) + \tau_f

A PI on the speed is a PD on the angle whose reference is the integral of the speed's. Of the cascade, with speed loop
:math:`i = p\,(w_r + k_v \epsilon - w) + q \int (w_r + k_v \epsilon - w)`, :math:`\epsilon = \theta_r - \theta`, and its
current taken to be there at once,

.. math:: k_d = k_t p, \quad k_p = k_t (p\,k_v + q), \quad k_i = k_t q k_v, \quad
          \tau_f = k_t (f_w w_r + f_a \dot w_r + f_c\,\mathrm{sgn}\,w_r)

Of the voltage PI :math:`u = P (w_r - w) + Q \int (w_r - w)` behind a drive that compensates the back-EMF, so that its
voltage is :math:`R \tau / k_t + k_e w`,

.. math:: k_d = \frac{k_t}{R} (P + k_e), \quad k_p = \frac{k_t}{R} Q, \quad \tau_f = -\frac{k_t k_e}{R} w_r
"""

from __future__ import annotations

from typing import NamedTuple

from drivesizer.control.cascade import Cascade
from drivesizer.control.validation import Gains
from drivesizer.output.export.common import Export

__all__ = ["TorqueLaw", "lacking", "torque_law"]


class TorqueLaw(NamedTuple):
    """A torque at the motor shaft [N*m] by angle and speed of it; SI."""

    kp: float  # N*m/rad
    ki: float  # N*m/(rad*s)
    kd: float  # N*m*s/rad
    per_speed: float = 0.0  # N*m*s/rad, of the reference
    per_acceleration: float = 0.0  # kg*m^2
    per_direction: float = 0.0  # N*m


def torque_law(of: Export) -> TorqueLaw:
    """The controller of a drive as one law."""
    c, k, R = of.designed, of.train.torque_constant, of.train.resistance
    if isinstance(c, Cascade):
        p, q, v = c.velocity_kp, c.velocity_ki, c.position_kp
        return TorqueLaw(
            kp=k * (p * v + q), ki=k * q * v, kd=k * p, per_speed=k * c.feedforward_velocity,
            per_acceleration=k * c.feedforward_acceleration, per_direction=k * c.feedforward_friction,
        )  # fmt: skip
    k_e = of.train.back_emf_constant
    return TorqueLaw(kp=k / R * c.ki, ki=0.0, kd=k / R * (c.kp + k_e), per_speed=-k * k_e / R)


def lacking(of: Export) -> list[str]:
    """Parts of the designed controller that the law has no place for, as sentences; sampling is left to the format."""
    c = of.designed
    kd = c.kd if isinstance(c, Gains) else c.velocity_kd
    said = []
    if kd:
        said.append("the derivative of the speed is left out")
    if isinstance(c, Cascade):
        said.append("the current loop is left out: the winding alone makes the current late, by L/R")
    return said
