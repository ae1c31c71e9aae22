r"""Efficiency of motor and gearhead over torque and speed at the gearhead's output.

The drive model of ``physics`` at points that no cycle need come by: motor torque and voltage are the same sums of its
six functions, at constant speed. Power to the load counts the gearhead's loss on the motor's side, power from it on the
load's.

.. math:: \eta = \frac{T w}{V I} \; (T w > 0), \qquad \eta = \frac{V I}{T w} \; (T w < 0),

the second where the supply gets something back, and 0 where it does not. For a brushed motor without gearhead the best
that a voltage allows is :math:`(1 - \sqrt{I_0 / I_s})^2` with the stall current I_s [1].

References
----------
.. [1] maxon academy, *Formulae Handbook*, 2nd ed., 2012, section "Motor data": efficiency.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.machine.set_cycle import SetCycle
from drivesizer.physics.cycle_at_gearhead import BRAKING, DIRECTION, DRIVING, SPEED
from drivesizer.physics.waveform import balanced, wave

__all__ = ["Operation", "operation"]

Array = NDArray[np.float64]


class Operation(NamedTuple):
    """Operating points of a drive over torque and speed: arrays of their shape."""

    current: Array  # A
    voltage: Array  # V
    efficiency: Array  # of the direction in which power flows [1]; NaN at rest and without torque


def operation(found: SetCycle, torque: Array, speed: Array) -> Operation:
    """A drive at constant speeds."""
    torque, speed = np.broadcast_arrays(torque, speed)
    functions = np.zeros((torque.size, 1, 6))
    functions[:, 0, DRIVING] = np.maximum(torque, 0.0).ravel()
    functions[:, 0, BRAKING] = np.minimum(torque, 0.0).ravel()
    functions[:, 0, DIRECTION] = np.sign(speed).ravel()
    functions[:, 0, SPEED] = speed.ravel()
    k_t = found.motor["torque_constant"]
    ends = wave(
        np.ones(torque.size), np.repeat(functions, 2, axis=1), found.demands.coefficients, found.volts, k_t
    )  # fmt: skip
    current, voltage = (x[0, :, 0].reshape(torque.shape) for x in (ends.current, ends.voltage))
    taken = balanced(ends, found.demands.surplus(k_t), speed.reshape(-1, 1))
    every = taken.current.shape[1] // torque.size
    electrical = (taken.current * taken.voltage)[0, ::every, 0].reshape(torque.shape)
    mechanical = torque * speed
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(mechanical > 0.0, mechanical / electrical, np.maximum(electrical / mechanical, 0.0))
    return Operation(current, voltage, np.where(mechanical == 0.0, np.nan, share))
