r"""Load cycle of one joint at the shaft that its drive turns, and the load that has it.

.. math:: T = r \, (\tau + d \dot q + f \, \mathrm{sgn} \, \dot q), \quad \omega = \dot q / r, \quad J = r^2 M_{jj}

d and f damping and Coulomb friction of the joint, M the mass matrix (``coupling``: of a drive whose belt passes other
joints). A joint that turns has r = 1; one that slides
r = p / 2π with p the travel per turn of the shaft.

The inertia is the largest over the trajectory of what resists this joint when it moves alone; the torque is that of
all joints moving together, so that the part of it which is inertia times acceleration varies with the pose.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from pydantic import PrivateAttr

from drivesizer.errors import FieldError, quoted
from drivesizer.joints.record import Array
from drivesizer.load_cases.computed import ComputedLoad
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.spec.description.record import Joint

__all__ = ["JointLoad", "cycle_of", "joint_load", "radius_of"]


class JointLoad(ComputedLoad):
    """The load cycle of a joint of a robot description."""

    _joint: str = PrivateAttr(default="")
    _case: str = PrivateAttr(default="")

    @property
    def joint(self) -> str:
        """Name of the joint."""
        return self._joint

    @property
    def case(self) -> str:
        """Load case of the robot that it belongs to: empty for the trajectory with its own payload."""
        return self._case


def joint_load(cycle: LoadCycle, joint: str, case: str = "") -> JointLoad:
    """The load of one joint."""
    made = JointLoad.model_construct(kind="recorded", file=cycle.name, motors=1, smoothing=0.0, inertia=0.0)
    made._cycle, made._joint, made._case = cycle, joint, case
    return made


def radius_of(joint: Joint, travel_per_turn: float | None) -> float:
    """Travel of a joint per angle of the shaft that its drive turns: 1, or m/rad of one that slides."""
    field = ("robot", "drives", joint.name)
    if joint.turns:
        if travel_per_turn is not None:
            raise FieldError((*field, "travel_per_turn"), f"joint {quoted(joint.name)} turns; leave it out")
        return 1.0
    if travel_per_turn is None:
        raise FieldError(
            field, f"joint {quoted(joint.name)} slides; expected travel_per_turn of its screw or pulley, e.g. 10 mm"
        )
    return travel_per_turn / (2.0 * math.pi)


def cycle_of(
    name: str, duration: Array, moving: tuple[Array, Array], torque: Array, static: Array, inertia: float, *,
    radius: float = 1.0, friction: float = 0.0,
) -> LoadCycle:  # fmt: skip
    """Load cycle at the shaft of one joint's drive."""
    speed, acceleration = moving
    held = float(np.abs(static).max()) * radius
    cycle = LoadCycle(
        f"joint {name}", duration, speed / radius, acceleration / radius, torque * radius,
        inertia * radius**2, radius=radius, held=held,
    ).split()  # fmt: skip
    if not friction:
        return cycle
    resisting = friction * radius * np.sign(cycle.speed.mean(axis=1, keepdims=True))
    return replace(cycle, torque=cycle.torque + resisting).split()
