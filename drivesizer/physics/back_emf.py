r"""The voltage that a winding makes by turning: the back-EMF constant k_e, where catalogues distinguish it from k_t.

In an ideal machine k_e and k_t are one figure, since power is conserved. Makers' figures differ: the torque per ampere
is mostly that of stall, where iron saturates and brushes lose some (brushed motors 13 to 33 % below k_e), or rests
on a stall current that a controller cut (k_t above k_e). The no-load speed at a voltage gives k_e itself:

.. math:: k_e = \frac{V - R I_0}{w_0}

Symbols: V nominal voltage [V], R resistance [ohm], I_0 no-load current [A], w_0 no-load speed [rad/s].
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.figures import once_per_part

__all__ = ["ELECTRONICS", "back_emf_constant"]

Array = NDArray[np.float64]

ELECTRONICS = "integrated electronics"  # the commutation of a motor that has its controller inside
_SAME = 0.0101  # two figures of three digits each, each off by half of its last one: 0.5 %, and 1 % between them
_OTHER = 2.0  # times k_t or a part of it: then w_0 and V are not of one winding


@once_per_part
def back_emf_constant(motor: Any) -> Array:
    """Voltage per speed of motors [V*s/rad]; the first of these that is known.

    1. The maker's ``back_emf_constant``, or 1 over its ``speed_constant``.
    2. (V - R I_0)/w_0. Not of a motor with its controller inside, which limits the no-load speed;
       and not beyond half to twice k_t, where the two figures are of different windings or voltages. An unknown I_0
       leaves the bound V/w_0: k_e is k_t then, and no more than that.
    3. k_t.

    A result within the rounding of three digits of k_t is k_t: one constant, printed twice.

    Parameters
    ----------
    motor
        Figures of motors by field name: columns.
    """
    k_t, own = np.asarray(motor["torque_constant"]), np.asarray(motor["back_emf_constant"])
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.where(np.isnan(own), np.divide(1.0, motor["speed_constant"]), own)
        if (unprinted := np.isnan(found)).any():
            found = np.where(unprinted, _by_no_load_speed(motor, k_t), found)
        return np.where(np.abs(found / k_t - 1.0) < _SAME, k_t, found)


def _by_no_load_speed(motor: Any, k_t: Array) -> Array:
    """The constant by (V - R I_0)/w_0 where that is likely, else k_t."""
    voltage, no_load = np.asarray(motor["nominal_voltage"]), np.asarray(motor["no_load_speed"])
    lost = np.asarray(motor["resistance"] * motor["no_load_current"])
    idle = np.where(np.isnan(lost), np.fmin(k_t, voltage / no_load), (voltage - lost) / no_load)
    likely = (idle > k_t / _OTHER) & (idle < k_t * _OTHER) & (np.asarray(motor["commutation"]) != ELECTRONICS)
    return np.where(likely, idle, k_t)
