"""A platform under its controllers, period by period: poses, wheel speeds, torques and motion.

A torque responds to the sample of one period before, and is held for a period. Arrays as in ``kernel_layout``.
"""

from __future__ import annotations

import math

import drivesizer.control.path_following.kernel_layout as at
from drivesizer.control.path_following.kernel_forces import forces
from drivesizer.control.path_following.kernel_layout import Array
from drivesizer.control.path_following.kernel_step import advance

__all__ = ["follow_one"]


def take_pose(P: Array, y: Array, wanted: Array, z: Array, period: float) -> None:
    """Take a pose: errors in the robot's frame, then their integrals, in z."""
    x, v = wanted[0] - y[0], wanted[1] - y[1]
    c, s = math.cos(y[2]), math.sin(y[2])
    turned = wanted[2] - y[2]
    z[0], z[1], z[2] = c * x + s * v, c * v - s * x, math.atan2(math.sin(turned), math.cos(turned))
    for r in range(3):
        z[3 + r] += P[at.K_I] * z[r] * period


def velocity_command(P: Array, eta: Array, z: Array, c: Array) -> None:
    """Velocity command of the wheels, in c: the planned velocity and the correction by the last pose."""
    c[0], c[1], c[2] = eta[0], eta[1], eta[2]
    if P[at.LAW] == 1.0:
        a, b = math.cos(z[2]), math.sin(z[2])
        c[0] = a * eta[0] - b * eta[1] + P[at.K_P] * z[0] + z[3]
        c[1] = b * eta[0] + a * eta[1] + P[at.K_P] * z[1] + z[4]
        c[2] = eta[2] + P[at.K_P] * z[2] + z[5]
    elif P[at.LAW] == 2.0:
        c[0] = eta[0] * math.cos(z[2]) + P[at.K_X] * z[0] + z[3]
        c[2] = eta[2] + eta[0] * (P[at.K_Y] * z[1] + P[at.APERIODIC] * math.sin(z[2]))


def torque_command(G: Array, E: Array, c: Array, fed: Array, y: Array, i: int, sums: Array, period: float) -> float:
    """Torque command of a wheel's controller; its integral is frozen while the torque is at its limit."""
    error = E[i, 0] * c[0] + E[i, 1] * c[1] + E[i, 2] * c[2] - y[at.POSE + 3 + i]
    torque: float = fed[i] + G[i, 0] * error + sums[i]
    if abs(torque) > G[i, 2]:
        if torque * error < 0.0:
            sums[i] += G[i, 1] * error * period
        return math.copysign(G[i, 2], torque)
    sums[i] += G[i, 1] * error * period
    return torque


def record_state(W: Array, y: Array, torque: Array, w: Array, row: Array, floor: Array, applied: Array) -> None:
    """Record a state, its torques, and slip, load and traction of its wheels."""
    for r in range(y.shape[0]):
        row[r] = y[r]
    for i in range(W.shape[0]):
        across = w[i, at.RHO] if W[i, at.HELD] != 0.0 else 0.0
        floor[0, i] = math.sqrt(w[i, at.SLIP] * w[i, at.SLIP] + across * across)
        floor[1, i] = w[i, at.LOAD]
        floor[2, i] = w[i, at.LOAD] * math.sqrt(w[i, at.FA] * w[i, at.FA] + w[i, at.FB] * w[i, at.FB])
        applied[i] = W[i, at.STRENGTH] * torque[i] if W[i, at.KIND] == 0.0 else 0.0


def follow_one(W: Array, K: Array, B: Array, C: Array, M: Array, G: Array, E: Array, P: Array, wanted: Array,
               eta: Array, fed: Array, y: Array, torque: Array, period: float, lever: float, tolerance: float,
               w: Array, A: Array, s: Array, z: Array, rows: Array, floor: Array, applied: Array,
               limited: Array) -> int:  # fmt: skip
    """Simulate all samples."""
    n, reach = W.shape[0], period
    for k in range(wanted.shape[0]):
        forces(W, K, B, C, y, torque, w, s[0], s[2])
        record_state(W, y, torque, w, rows[k], floor[k], applied[k])
        if k == wanted.shape[0] - 1:
            break
        if P[at.LAW] != 0.0 and k % int(P[at.EVERY]) == 0:
            take_pose(P, y, wanted[k], z, period * P[at.EVERY])
        velocity_command(P, eta[k], z, z[6:9])
        for i in range(n):
            z[9 + n + i] = 0.0
            if W[i, at.KIND] == 0.0:
                z[9 + n + i] = torque_command(G, E, z[6:9], fed[k], y, i, z[9 : 9 + n], period)
                limited[i] += 1.0 if abs(z[9 + n + i]) >= G[i, 2] else 0.0
        reach = advance(W, K, B, C, M, y, torque, period, reach, lever, tolerance, w, A, s)
        if reach == 0.0:
            return k
        for i in range(n):
            torque[i] = z[9 + n + i]
    return int(wanted.shape[0])
