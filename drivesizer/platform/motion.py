"""A trajectory as the robot itself sees it: what ``dynamics`` makes torques of.

Resistances turn round with each wheel and roller, so pieces are cut where one does, and within a piece their direction
is that of the motion in it. Where the wheels do not allow every motion, a trajectory that was sampled slides them a
little all the same; that little is left out: the platform goes as its driven wheels do on the trajectory.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from operator import itemgetter
from typing import Any

import numpy as np

from drivesizer.errors import InputError
from drivesizer.platform.contact_loads import LEVEL, Ground
from drivesizer.platform.dynamics import Dynamics
from drivesizer.platform.kinematics import Kinematics, check_allowed, map_columns, row_sizes
from drivesizer.platform.matrix_equation import Array
from drivesizer.platform.trajectory import Trajectory

__all__ = ["Motion", "allowed", "blocks", "largest", "motion", "seen"]

_ROUNDING = 1e-9  # of the largest speed: below it there is none
_SHORT = 1e-9  # of a piece: none is cut shorter
_TOWARDS = 1e-3  # how far a direction of rolling goes from that at an end of a piece to that of its middle
_BLOCK = 8192  # pieces


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """A trajectory as the robot sees it, cut where wheels and rollers that resist turn round; n pieces, two ends."""

    duration: Array  # (n,) s
    theta: Array  # (n, 2) rad
    eta: Array  # (3, n, 2) m/s, m/s, rad/s
    eta_dot: Array  # (3, n, 2) m/s^2, m/s^2, rad/s^2
    ground: Ground
    towards: Array  # (3, n, 2): velocity whose direction the resistances take

    @property
    def facing(self) -> Any:
        """The heading where it counts: 0 on a level floor."""
        return self.theta if np.any(self.ground.slope) else 0.0


def motion(d: Dynamics, trajectory: Trajectory, ground: Ground = LEVEL, sliding: float = 0.02) -> Motion:
    """Motion of a platform on a trajectory, for ``dynamics`` to make torques of.

    Parameters
    ----------
    d
        The platform.
    trajectory
        Its motion in the world.
    ground
        The floor; where its slope is a column, at both ends of each piece, shape (n, 2).
    sliding
        How far the trajectory may be off what the wheels allow, as a share of its largest speed; the platform goes as
        its driven wheels do on it.

    Returns
    -------
    Motion
        Velocity and acceleration in the robot's frame, piece by piece.

    Raises
    ------
    InputError
        When the wheels do not allow the motion.
    """
    allowed(d.kinematics, trajectory, sliding)
    return seen(d, trajectory, ground, largest(trajectory))


def largest(trajectory: Trajectory) -> Array:
    """The largest speed in each of the robot's axes [m/s, m/s, rad/s], whatever its heading."""
    x, y, turn = trajectory.velocity
    along = np.hypot(x, y).max()
    return np.array([along, along, np.abs(turn).max()])


def allowed(k: Kinematics, trajectory: Trajectory, sliding: float) -> None:
    """Refuse a trajectory that slides wheels by more than a share of its largest speed.

    Parameters
    ----------
    k
        The wheels.
    trajectory
        In the world.
    sliding
        Share of the largest speed.

    Raises
    ------
    InputError
        When it does, or the share is none.
    """
    if not 0.0 < sliding < 1.0:
        raise InputError(f"sliding: must lie between 0 and 1, got {sliding!r}")
    if not len(k.held):
        return
    along, _, turning = largest(trajectory)
    eta, _ = trajectory.in_robot()
    off = np.abs(map_columns(k.held, eta)).max(axis=0)
    if not off.max() <= sliding * (along + max(w.L for w in k.wheels) * turning):
        at = trajectory.time.reshape(-1)[int(off.argmax())]
        check_allowed(k, eta, f"trajectory at {at:.4g} s")
        raise InputError(f"trajectory at {at:.4g} s: it slides a wheel by {off.max():.3g} m/s, more than permitted")


def seen(d: Dynamics, trajectory: Trajectory, ground: Ground, top: Array) -> Motion:
    """A trajectory in the robot's frame, cut; what the wheels do not allow of it is left out.

    Parameters
    ----------
    d, trajectory, ground
        As in ``motion``.
    top
        Its largest speeds, or those of the whole that it is a part of, see ``largest``.

    Returns
    -------
    Motion
        Velocity and acceleration in the robot's frame, piece by piece.
    """
    k, (eta, eta_dot) = d.kinematics, trajectory.in_robot()
    if len(k.held):
        made = k.K_plus @ k.E[list(k.driven)]  # the motion of wheels that turn as in one that slides
        eta, eta_dot = map_columns(made, eta), map_columns(made, eta_dot)
    still = _ROUNDING * (top[0] + k.reach * top[2])  # m/s
    eta = np.where(np.abs(eta) <= still / np.array([1.0, 1.0, k.reach])[:, None, None], 0.0, eta)
    rows = _resisting(k)
    turning = map_columns(rows, eta)
    turning[np.abs(turning) <= (still * row_sizes(rows, k.reach))[:, None, None]] = 0.0
    owner, start, end = _cuts(turning)
    if len(owner) == len(trajectory.duration):
        return Motion(trajectory.duration, trajectory.posture[2], eta, eta_dot, ground, _towards(eta))

    def cut(column: Array) -> Array:
        left, right = column[..., owner, 0], column[..., owner, 1]
        ends = [left + (right - left) * start, np.where(end < 1.0, left + (right - left) * end, right)]
        return np.stack(ends, axis=-1)

    duration = trajectory.duration[owner] * (end - start)
    eta, eta_dot = cut(eta), cut(eta_dot)
    return Motion(duration, cut(trajectory.posture[2]), eta, eta_dot, _over(ground, cut), _towards(eta))


def _towards(eta: Array) -> Array:
    """The velocity at each end, turned a little to that of the piece: at rest, it is where the piece goes."""
    return np.asarray(eta + _TOWARDS * (eta.mean(axis=2, keepdims=True) - eta))


def _resisting(k: Kinematics) -> Array:
    """Rows of what resists over velocity: wheels that roll hard or rub, and their rollers."""
    wheels = [i for i, w in enumerate(k.wheels) if w.rolling_resistance or w.friction]
    rollers = [i for i, w in enumerate(k.wheels) if w.roller_resistance]
    return np.concatenate([k.E[wheels], k.rollers[rollers]])


def _cuts(turning: Array) -> tuple[Any, Array, Array]:
    """Parts of pieces in which no row changes sign: the piece of each, and where in it the part starts and ends [1]."""
    pieces = turning.shape[1]
    left, right = turning[..., 0], turning[..., 1]
    row, owner = np.nonzero(left * right < 0.0)
    share = left[row, owner] / (left[row, owner] - right[row, owner])
    inside = (share > _SHORT) & (share < 1.0 - _SHORT)
    owner, share = owner[inside], share[inside]
    order = np.lexsort((share, owner))
    owner, share = owner[order], share[order]
    first = np.ones(len(owner), dtype=bool)
    first[1:] = (np.diff(owner) > 0) | (np.diff(share) > _SHORT)
    owner = np.concatenate([np.arange(pieces), owner[first]])
    start = np.concatenate([np.zeros(pieces), share[first]])
    order = np.lexsort((start, owner))
    owner, start = owner[order], start[order]
    end = np.append(np.where(np.diff(owner) > 0, 1.0, start[1:]), 1.0)
    return owner, start, end


def blocks(trajectory: Trajectory, ground: Ground) -> Iterator[tuple[Trajectory, Ground]]:
    """So many pieces at a time that their columns stay in the processor's cache.

    Parameters are those of ``motion``.

    Parameters
    ----------
    trajectory, ground
        As in ``motion``.

    Returns
    -------
    iterator
        Parts of the trajectory, each with its part of the floor.
    """
    for first in range(0, len(trajectory.duration), _BLOCK):
        here = slice(first, first + _BLOCK)
        t, floor = trajectory, _over(ground, itemgetter(here))
        yield Trajectory(t.duration[here], t.posture[:, here], t.velocity[:, here], t.acceleration[:, here]), floor


def _over(ground: Ground, change: Callable[[Array], Array]) -> Ground:
    """The floor with its columns changed, and its plain figures as they are."""
    slope, uphill = (change(np.asarray(c)) if np.ndim(c) else c for c in (ground.slope, ground.uphill))
    return replace(ground, slope=slope, uphill=uphill)
