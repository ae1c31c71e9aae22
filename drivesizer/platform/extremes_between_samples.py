"""A trajectory between the ends of its pieces: cubics through both ends, with the velocities there.

Where an acceleration is straight over a piece the cubic is the motion itself. In Bézier's form a piece stays inside the
hull of its four control points, so that it can be said where it does not come.
"""

from __future__ import annotations

import numpy as np

from drivesizer.physics.load_cycle import places
from drivesizer.platform.matrix_equation import Array
from drivesizer.platform.trajectory import Trajectory

__all__ = ["control_points", "finer", "halves"]


def control_points(trajectory: Trajectory) -> Array:
    """Bézier points of the posture over each piece, shape (3, n, 4) [m, m, rad]."""
    left, right = trajectory.posture[..., 0], trajectory.posture[..., 1]
    third = trajectory.duration / 3.0
    return np.stack(
        [left, left + third * trajectory.velocity[..., 0], right - third * trajectory.velocity[..., 1], right], axis=-1
    )


def halves(points: Array) -> tuple[Array, Array]:
    """Both halves of pieces in Bézier's form, by de Casteljau; the shape is that of ``points``."""
    first = (points[..., 1:] + points[..., :-1]) / 2.0
    second = (first[..., 1:] + first[..., :-1]) / 2.0
    middle = (second[..., 1] + second[..., 0]) / 2.0
    left = np.stack([points[..., 0], first[..., 0], second[..., 0], middle], axis=-1)
    right = np.stack([middle, second[..., 1], first[..., 2], points[..., 3]], axis=-1)
    return left, right


def finer(trajectory: Trajectory, turning: float = 0.05) -> Trajectory:
    """The same trajectory in pieces that turn by less than an angle.

    Parameters
    ----------
    trajectory
        Any.
    turning
        Largest change of heading in a piece [rad]; what depends on the heading is then straight over a piece to
        within an eighth of its square.

    Returns
    -------
    Trajectory
        The same motion; itself where no piece turns by more.
    """
    turned = np.ptp(control_points(trajectory)[2], axis=-1)
    parts = np.maximum(np.ceil(turned / turning), 1.0).astype(int)
    if parts.max(initial=1) == 1:
        return trajectory
    piece, step = places(parts)
    share = (step[:, None] + np.array([0.0, 1.0])) / parts[piece, None]  # (pieces, 2)
    points = control_points(trajectory)[:, piece, None, :]
    weights = np.stack([(1 - share) ** 3, 3 * share * (1 - share) ** 2, 3 * share**2 * (1 - share), share**3], axis=-1)

    def straight(values: Array) -> Array:
        left, right = values[:, piece, :1], values[:, piece, 1:]
        return np.asarray(left + share * (right - left))

    return Trajectory(
        duration=trajectory.duration[piece] / parts[piece],
        posture=np.asarray((points * weights).sum(axis=-1)),
        velocity=straight(trajectory.velocity),
        acceleration=straight(trajectory.acceleration),
    )
