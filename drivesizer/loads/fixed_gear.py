r"""A gear of fixed ratio behind gearhead or belt: the load cycle at its input shaft.

.. math:: T_w = T + J_w α + T_{f,w} \, \mathrm{sgn} ω, \qquad
          T_1 = \frac{T_w}{i e} \; (T_w ω > 0), \quad \frac{T_w e_b}{i} \; (T_w ω < 0), \quad
          \frac{T_w}{i} \; (ω = 0), \\
          T_{in} = T_1 + J_p \, i α + T_{f,p} \, \mathrm{sgn} ω, \qquad ω_{in} = i ω, \quad
          J_{in} = J_p + \frac{J + J_w}{i^2}

Index w is of what turns with the output shaft, p of what turns with the input shaft; J inertia, T_f friction at any
load. Losses follow the direction of power. With e_b not above 0 the gear is self-locking: the motor drives even where
the load would, and at rest nothing reaches the motor.

Worked example: a slide of 250 kg, μ 0.2, on a screw of 10 mm lead and 20 mm by 1 m, efficiency 0.9, behind a gear of
2 : 1 with 0.40 kg·cm²: 0.43 N·m and 2.29 kg·cm² at the motor (Yaskawa, servomotor selection, selection calculations).
Source of the losses by direction: maxon Formulae Handbook (J. Braun), mechanical drives.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drivesizer.physics.load_cycle import LoadCycle

__all__ = ["FixedGear", "through_gear"]


class FixedGear(NamedTuple):
    """A gear between two shafts, SI."""

    ratio: float  # turns of the input shaft per turn of the output shaft
    efficiency: float  # when the input shaft drives
    back_efficiency: float  # when the output shaft drives; not above 0: self-locking
    pinion_inertia: float = 0.0  # kg*m^2, turns with the input shaft
    wheel_inertia: float = 0.0  # kg*m^2, turns with the output shaft
    pinion_friction: float = 0.0  # N*m, at the input shaft, at any load
    wheel_friction: float = 0.0  # N*m, at the output shaft


def through_gear(cycle: LoadCycle, gear: FixedGear) -> LoadCycle:
    """The load cycle at the input shaft of a gear.

    Parameters
    ----------
    cycle
        At its output shaft.
    gear
        The gear.

    Returns
    -------
    LoadCycle
        At its input shaft, cut where the direction of power changes.
    """
    i, friction = gear.ratio, gear.wheel_friction * _direction(cycle)
    at_wheel = replace(cycle, torque=cycle.torque + gear.wheel_inertia * cycle.acceleration + friction).split()
    direction = _direction(at_wheel)
    flow = direction * np.sign(at_wheel.torque.mean(axis=1, keepdims=True))
    at_rest = 1.0 if gear.back_efficiency > 0.0 else 0.0
    factor = np.where(flow > 0.0, 1.0 / gear.efficiency, np.where(flow < 0.0, gear.back_efficiency, at_rest))
    acceleration = at_wheel.acceleration * i
    torque = at_wheel.torque * factor / i + gear.pinion_inertia * acceleration + gear.pinion_friction * direction
    return replace(
        at_wheel, speed=at_wheel.speed * i, acceleration=acceleration, torque=torque, radius=cycle.radius / i,
        inertia=gear.pinion_inertia + (cycle.inertia + gear.wheel_inertia) / i**2,
        held=cycle.held * at_rest / i,
        own=tuple(one._replace(turning=np.nan) for one in cycle.own),  # its demand is no longer of this torque
    ).split()  # fmt: skip


def _direction(cycle: LoadCycle) -> np.typing.NDArray[np.float64]:
    """Sign of the speed within each segment, 0 at rest: shape (segments, 1)."""
    direction: np.typing.NDArray[np.float64] = np.sign(cycle.speed.mean(axis=1, keepdims=True))
    return direction
