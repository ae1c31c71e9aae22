"""Trajectories of the tests, by the laws of steady acceleration."""

import numpy as np

from drivesizer.platform.trajectory import Trajectory


def piece(posture, velocity, acceleration, duration):
    """One piece from its start: posture, velocity and a steady acceleration, in the world."""
    p, v, a = (np.array(c, dtype=float) for c in (posture, velocity, acceleration))
    ends = p + v * duration + a * duration**2 / 2, v + a * duration
    shape = (3, 1, 2)
    return Trajectory(
        duration=np.array([duration]),
        posture=np.stack([p, ends[0]], axis=-1).reshape(shape),
        velocity=np.stack([v, ends[1]], axis=-1).reshape(shape),
        acceleration=np.stack([a, a], axis=-1).reshape(shape),
    )


def straight(start, end, heading, duration):
    """Steady from one place to another."""
    velocity = (np.array(end) - np.array(start)) / duration
    return piece((*start, heading), (*velocity, 0.0), (0.0, 0.0, 0.0), duration)


def turning(heading, end, duration, *, at=(0.0, 0.0), speed=None, gain=0.0):
    """On the spot; at a steady speed where none is given."""
    speed = (end - heading) / duration if speed is None else speed
    return piece((*at, heading), (0.0, 0.0, speed), (0.0, 0.0, gain), duration)


def joined(*pieces):
    """One after the other."""
    fields = ("posture", "velocity", "acceleration")
    return Trajectory(
        duration=np.concatenate([p.duration for p in pieces]),
        **{f: np.concatenate([getattr(p, f) for p in pieces], axis=1) for f in fields},
    )
