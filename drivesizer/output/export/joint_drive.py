r"""The drive of a joint whose mass is described apart: of a robot's description, or a wheel.

With gears that drive, K total ratio, e efficiency, r travel of the joint per angle of the driven shaft:

.. math:: F = \frac{K e M}{r}, \quad J = \frac{K^2 e J_m + J_b}{r^2}, \quad b = \frac{K^2 e b_m}{r^2},
          \quad F_f = \frac{K e M_f + M_b}{r}

J_m, M_f, b_m inertia, dry and viscous friction of the motor; J_b, M_b inertia and friction of a belt's pulleys. A gear
of fixed ratio i between driven shaft and joint is one with the drive: r/i is the joint's travel per angle of the shaft,
e that of both. Of what turns with its input (p) and output shaft (w)

.. math:: J_b = e_g (J + J_p) + \frac{J_w}{i^2}, \qquad M_b = e_g (M + T_p) + \frac{T_w}{i}

J and M of the belt before it; those of a belt behind it are parts of J_w and T_w.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import nan

import numpy as np

from drivesizer.joints.inverse_dynamics import Attached
from drivesizer.output.export.common import Export, number, sentences

_NOWHERE = Attached("", np.zeros(3))  # of an axis, whose load has the masses


@dataclass(frozen=True, slots=True, kw_only=True)
class JointDrive:
    """The drive of a joint of a description, of a wheel, or of an axis that is a joint of its own."""

    joint: str
    of: Export
    motor: str  # name of its actuator
    travel: float = 1.0  # of the joint per angle of the driven shaft [1, or m/rad]
    turns_by: Mapping[str, float] = field(default_factory=dict)  # where its belt passes joints: theirs, and its own 1
    mass: float = nan  # kg, of what is known of it, without its controller
    beyond: float = nan  # kg of it that no link of the description holds
    lacking: tuple[str, ...] = ()  # parts of unknown mass
    place: Attached = _NOWHERE  # of the mass
    stage_inertia: float = 0.0  # kg*m^2 at the driven shaft, of a belt and a further gear that drives
    stage_friction: float = 0.0  # N*m
    gear_efficiency: float = 1.0  # of a further gear, driving
    back_efficiency: float = 1.0  # of it where the load drives
    slides: bool = False  # the joint

    @property
    def coupled(self) -> bool:
        """Whether its belt passes other joints."""
        return len(self.turns_by) > 1

    @property
    def ratio(self) -> float:
        """Motor angle per turn of the joint [1], or per travel [rad/m]."""
        return self.of.train.ratio / self.travel

    @property
    def efficiency(self) -> float:
        """Efficiency of all gears between motor and joint, driving."""
        return self.of.train.efficiency * self.gear_efficiency

    @property
    def armature(self) -> float:
        """Inertia of the drive at the joint [kg*m^2, or kg]; NaN where that of the rotor is unknown."""
        return (self.of.reflected_inertia * self.gear_efficiency + self.stage_inertia) / self.travel**2

    @property
    def damping(self) -> float:
        """Viscous friction of the drive at the joint [N*m*s/rad, or N*s/m]."""
        return self.of.damping * self.gear_efficiency / self.travel**2

    @property
    def friction(self) -> float:
        """Dry friction of the drive at the joint [N*m, or N]."""
        train = self.of.train
        return (train.friction * train.ratio * self.efficiency + self.stage_friction) / self.travel

    @property
    def limits(self) -> dict[str, str]:
        """Effort and velocity of the joint as text; what is unknown is left out."""
        peak, fastest = self.of.limits.peak_torque, self.of.limits.peak_speed
        named = {
            "effort": (peak, peak.value * self.gear_efficiency / self.travel),
            "velocity": (fastest, fastest.value * self.travel),
        }
        return {name: number(value) for name, (limit, value) in named.items() if limit.by}

    @property
    def remarks(self) -> list[str]:
        """Remarks on it, as sentences."""
        of, others = self.of, (share for share in self.turns_by.items() if share[0] != self.joint)
        return sentences(
            "drive of a joint", drive=self, of=of, train=of.train, limits=of.limits,
            lasting=of.limits.continuous_torque.value * self.gear_efficiency / self.travel,
            others=", ".join(f"{'' if share > 0 else '-'}{name}" for name, share in others),
        )  # fmt: skip
