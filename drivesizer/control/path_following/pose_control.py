r"""Controllers of a platform: a speed loop for each driven wheel, and a pose loop.

Speed loops are PI on the wheel, with the torque (current) limit. Their gain is that of the symmetrical optimum [1]_ for
the least inertia of a wheel, its own and its rotor's, as when it slips or lifts off. Their integral is so slow that
with the largest inertia, with its share of the platform, both poles are real and equal [2]_: :math:`k_i = k_p^2 / 4 J`.

The pose is held at a slower period. Where the wheels allow all motions, each error in the robot's frame is an
integrator behind the lag :math:`T = J/k_p + 1.5\,T_{pose}` and gets a PI by the symmetrical optimum with a = 3, whose
damping is 1. A platform that only moves ahead and turns gets the law of [3]_, its natural frequency at the speed of
travel the same 1/(3 T), damping 1; its lateral error has no integral.

.. [1] C. Kessler, "Das symmetrische Optimum", Regelungstechnik 6 (1958) 395-400, 432-436.
.. [2] K. J. Åström, T. Hägglund, *PID Controllers: Theory, Design, and Tuning*, 2nd ed., ISA 1995: pole placement.
.. [3] Y. Kanayama, Y. Kimura, F. Miyazaki, T. Noguchi, "A stable tracking control method for an autonomous mobile
   robot", Proc. IEEE International Conference on Robotics and Automation (1990) 384-389.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drivesizer.control.cascade_rules import LATE, pole_placement, symmetrical_optimum
from drivesizer.errors import InputError
from drivesizer.platform.dynamics import Dynamics, wheel_space
from drivesizer.platform.kinematics import Kinematics
from drivesizer.platform.misjudged import per_wheel

__all__ = ["PoseLoop", "SpeedLoop", "inertias", "pose_loop", "speed_loop"]

_APERIODIC = 3.0  # a of the symmetrical optimum whose damping (a - 1) / 2 is 1
_PERIODS = (1e-5, 1.0)  # s, shortest and longest


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedLoop:
    """PI speed controllers of the driven wheels."""

    period: float  # s
    proportional: tuple[float, ...]  # N*m*s/rad
    integral: tuple[float, ...]  # N*m/rad; 0 of a plain proportional one
    limit: tuple[float, ...]  # N*m at the wheel; infinite: none

    def __post_init__(self) -> None:
        _checked_period("speed loop", self.period)
        for name in ("proportional", "integral", "limit"):
            if not all(value >= 0.0 for value in getattr(self, name)):
                raise InputError(f"speed loop: {name} must be 0 or more, got {getattr(self, name)!r}")
        if len({len(self.proportional), len(self.integral), len(self.limit)}) != 1:
            raise InputError("speed loop: proportional, integral and limit must have a figure for each driven wheel")


@dataclass(frozen=True, slots=True, kw_only=True)
class PoseLoop:
    """Pose feedback: of three degrees of freedom by k_p and k_i, of a unicycle by k_p, k_i (along) and a distance."""

    period: float  # s, between two poses
    proportional: float  # 1/s
    integral: float  # 1/s^2
    unicycle: bool = False
    distance: float = math.inf  # m, of a unicycle: a lateral error y decays with the distance s as (1 + s/d) exp(-s/d)

    def __post_init__(self) -> None:
        _checked_period("pose loop", self.period)
        for name in ("proportional", "integral", "distance"):
            if not getattr(self, name) >= 0.0:
                raise InputError(f"pose loop: {name} must be 0 or more, got {getattr(self, name)!r}")
        if self.unicycle and not 0.0 < self.distance < math.inf:
            raise InputError(f"pose loop: a unicycle needs a distance above 0, got {self.distance!r}")


def _checked_period(what: str, period: float) -> None:
    low, high = _PERIODS
    if not low <= period <= high:
        raise InputError(f"{what}: period must lie between {low:g} s and {high:g} s, got {period!r}")


def inertias(d: Dynamics) -> tuple[tuple[float, ...], float]:
    """Least inertia of each driven wheel, its own and its rotor's, and the largest of any [kg*m^2].

    The latter is the largest eigenvalue of (57): of four mecanum wheels r² m / 4 and its own, unless turning has more.
    """
    own = tuple(d.platform.wheels[i].inertia + d.platform.wheels[i].rotor_inertia for i in d.kinematics.driven)
    return own, float(np.linalg.eigvals(wheel_space(d)[0]).real.max())


def speed_loop(
    d: Dynamics, *, period: float = 1e-3, limit: float | Sequence[float] = math.inf, integral: bool = True
) -> SpeedLoop:
    """Speed controllers designed for the robot model."""
    own, most = inertias(d)
    if not min(own) > 0.0:
        raise InputError("speed loop: a driven wheel has no inertia; give inertia or rotor_inertia")
    gains = tuple(symmetrical_optimum(j, 1.0, LATE * period)[0] for j in own)
    sums = tuple(pole_placement(most, 1.0, k / (2.0 * most), 1.0)[1] if integral else 0.0 for k in gains)
    return SpeedLoop(period=period, proportional=gains, integral=sums, limit=per_wheel(limit, len(own), "torque limit"))


def pose_loop(d: Dynamics, inner: SpeedLoop, *, period: float = 0.05, speed: float = 1.0) -> PoseLoop:
    """Pose feedback around speed loops."""
    lag = inertias(d)[1] / min(inner.proportional) + LATE * period
    k_p, k_i = symmetrical_optimum(1.0, 1.0, lag, _APERIODIC)
    if d.kinematics.mobility == 3:
        return PoseLoop(period=period, proportional=k_p, integral=k_i)
    if not is_unicycle(d.kinematics):
        raise InputError("pose loop: expected a platform that allows all motions, or forwards and turning only")
    return PoseLoop(period=period, proportional=k_p, integral=k_i, unicycle=True, distance=abs(speed) / k_p)


def is_unicycle(k: Kinematics) -> bool:
    """Whether a set of wheels allows forwards and turning, and nothing else."""
    return k.mobility == 2 and not np.abs(k.motions[1]).max() > 0.0
