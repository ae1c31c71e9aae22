r"""Simulation of a platform that follows a trajectory: planner, robot model, wheel controllers, actual platform.

The robot model turns the trajectory into wheel speeds, (32), and when it is the dynamic one into torques as well,
(49)-(59), that are fed forward; the kinematic one leaves torque to the speed loops. Poses are fed back where a pose
loop is given; else the platform runs open-loop on its wheels' reference speeds. The plant is a rigid body with three
degrees of freedom on wheels that turn and slip (see ``slip``), with the figures that the model misjudges. Wheel loads
follow the forces at the floor at every instant.

Assumed: current loops are ideal, encoders and poses exact; a torque responds to the sample of one period before;
rollers have no inertia and no gaps; the floor is flat; wheels are equally stiff (see ``platform.contact_loads``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from drivesizer.control.path_following.kernel import at, compiled
from drivesizer.control.path_following.kernel_arrays import Arrays, arrays, first_state
from drivesizer.control.path_following.pose_control import PoseLoop, SpeedLoop, is_unicycle, speed_loop
from drivesizer.control.path_following.slip import Contact
from drivesizer.errors import InputError
from drivesizer.platform.contact_loads import LEVEL, Ground
from drivesizer.platform.dynamics import Dynamics, dynamics, wheel_torques
from drivesizer.platform.kinematics import check_allowed, columns, map_columns, to_robot
from drivesizer.platform.matrix_equation import Array
from drivesizer.platform.misjudged import EXACT, Misjudged, actual
from drivesizer.platform.trajectory import Trajectory
from drivesizer.platform.wheels import Platform

__all__ = ["Followed", "Model", "Planned", "drive", "follow", "sampled"]

Model = Literal["kinematic", "dynamic"]

_MOST = 1_000_000  # samples
_TOLERANCE = 1e-5  # m/s, of a step in time
_WITHIN = 0.3  # of the speeds in which friction reverses: a coarser step could oscillate across them
_FED = 1.5  # periods from a sample to the middle of the period in which its torque acts


@dataclass(frozen=True, slots=True, eq=False)
class Planned:
    """A trajectory at k instants."""

    time: Array  # (k,) s
    posture: Array  # (3, k): m, m, rad
    velocity: Array  # (3, k), in the world: m/s, m/s, rad/s
    acceleration: Array  # (3, k), in the world

    def in_robot(self) -> tuple[Array, Array]:
        """Velocity and its rate of change in the robot's frame, (3, k) both."""
        eta, seen = to_robot(self.posture[2], self.velocity), to_robot(self.posture[2], self.acceleration)
        seen[0] += self.velocity[2] * eta[1]
        seen[1] -= self.velocity[2] * eta[0]
        return eta, seen


@dataclass(frozen=True, slots=True, eq=False)
class Followed:
    """Motion of a platform at k instants, N wheels; torques and limits of wheels without a motor are 0."""

    planned: Planned
    posture: Array  # (3, k), in the world: m, m, rad
    velocity: Array  # (3, k), in the robot's frame: m/s, m/s, rad/s
    speeds: Array  # (N, k) rad/s, of the wheels
    torque: Array  # (N, k) N*m, of the motors at the wheels, from each instant to the next
    slip: Array  # (N, k) m/s
    load: Array  # (N, k) N
    traction: Array  # (N, k) N, size of the force on the floor
    limited: Array  # (N,): share of the samples at which the controller was at its limit
    work: Array  # (k,) J, done by motors and weight
    lost: Array  # (4, k) J: by slip, wheels' and rollers' resistance, casters
    kinetic: Array  # (k,) J
    friction: float  # μ

    @property
    def imbalance(self) -> float:
        """Largest error of the energy balance, over the largest of work and kinetic energy [1]."""
        rest = self.work - self.lost.sum(axis=0) - (self.kinetic - self.kinetic[0])
        return float(np.abs(rest).max() / max(np.abs(self.work).max(), self.kinetic.max(), 1e-300))


def sampled(trajectory: Trajectory, time: Any) -> Planned:
    """A trajectory at instants; at rest before its start and after its end.

    Velocity and acceleration are linear within a piece, the posture a cubic by its ends and their velocities.
    """
    ends = np.concatenate([[0.0], np.cumsum(trajectory.duration)])
    t = np.clip(np.asarray(time, dtype=float), 0.0, ends[-1])
    n = np.clip(np.searchsorted(ends, t, side="right") - 1, 0, len(trajectory.duration) - 1)
    q = np.clip((t - ends[n]) / trajectory.duration[n], 0.0, 1.0)
    v, w = np.moveaxis(trajectory.velocity[:, n], -1, 0)
    inside = (np.asarray(time) <= ends[-1]) & (np.asarray(time) >= 0.0)
    rates = [v + q * (w - v), (1.0 - q) * trajectory.acceleration[:, n, 0] + q * trajectory.acceleration[:, n, 1]]
    velocity, acceleration = (np.asarray(np.where(inside, rate, 0.0), dtype=float) for rate in rates)
    instants: Array = np.asarray(time, dtype=np.float64)
    return Planned(instants, trajectory.at(instants), velocity, acceleration)


def follow(
    trajectory: Trajectory,
    platform: Platform,
    *,
    model: Model = "dynamic",
    misjudged: Misjudged = EXACT,
    contact: Contact | None = None,
    speeds: SpeedLoop | None = None,
    poses: PoseLoop | None = None,
    ground: Ground = LEVEL,
    tolerance: float = _TOLERANCE,
) -> Followed:
    """Simulate a platform along a trajectory.

    Parameters
    ----------
    trajectory
        Of the planner; the platform starts on it, at its velocity.
    platform
        As the robot model knows it.
    model
        Kinematic: wheel speeds. Dynamic: torques fed forward as well.
    misjudged
        Figures of the actual platform that differ.
    contact
        Floor and wheels.
    speeds, poses
        Controllers; by default speed loops of 1 ms without a limit, and no pose feedback.
    ground
        The floor; one slope for the whole path.
    tolerance
        Of a step in time [m/s].

    Returns
    -------
    Followed
        At the samples of the speed loops.

    Raises
    ------
    InputError
        When the wheels do not allow the trajectory, a figure cannot be computed with, or a loop is unstable.
    """
    d, contact = dynamics(platform), contact or Contact()
    if model not in ("kinematic", "dynamic"):
        raise InputError(f"following: model must be kinematic or dynamic, got {model!r}")
    for rates, what in zip(trajectory.in_robot(), ("velocity", "acceleration"), strict=True):
        check_allowed(d.kinematics, columns(rates, 3, f"{what} of the trajectory"), f"{what} of the trajectory")
    speeds = speeds or speed_loop(d)
    _fits(d, speeds, poses)
    a = arrays(actual(platform, misjudged), misjudged, contact, ground)
    count = _count(trajectory.total, speeds.period)
    plan = sampled(trajectory, np.arange(count) * speeds.period)
    fed = np.zeros((count + 1, len(platform.wheels)))
    if model == "dynamic":
        late = np.concatenate([plan.time[:1] - speeds.period, plan.time]) + _FED * speeds.period
        fed[:, d.kinematics.driven] = _torques(d, sampled(trajectory, late), ground).T
    start = first_state(a, plan.posture[:, 0], plan.in_robot()[0][:, 0])
    return _simulate(a, d, plan, speeds, poses, fed, start, tolerance)


def drive(
    platform: Platform,
    torques: Any,
    *,
    period: float,
    velocity: Any = (0.0, 0.0, 0.0),
    heading: float = 0.0,
    speeds: Any = None,
    contact: Contact | None = None,
    ground: Ground = LEVEL,
    tolerance: float = _TOLERANCE,
) -> Followed:
    """Simulate a platform under given torques, without controllers; with torques of 0 it coasts."""
    d = dynamics(platform)
    given = columns(torques, len(d.kinematics.driven), "torques of the driven wheels")
    if given.ndim != 2 or not given.shape[1]:
        raise InputError(f"torques: expected a column for each period, got an array of shape {given.shape}")
    idle = (0.0,) * len(given)
    held = SpeedLoop(period=period, proportional=idle, integral=idle, limit=(math.inf,) * len(given))
    count = _count(given.shape[1] * period, period)
    fed = np.zeros((count + 1, len(platform.wheels)))
    fed[: count - 1, d.kinematics.driven] = given.T
    a = arrays(platform, EXACT, contact or Contact(), ground)
    start = first_state(a, np.array([0.0, 0.0, heading]), columns(velocity, 3, "velocity of the platform"))
    if speeds is not None:
        start[at.POSE + 3 : at.POSE + 3 + len(platform.wheels)] = columns(speeds, len(platform.wheels), "wheel speeds")
    still = np.zeros((3, count))
    place = still + np.array([[0.0], [0.0], [heading]])
    plan = Planned(np.asarray(np.arange(count) * period, dtype=float), place, still, still)
    return _simulate(a, d, plan, held, None, fed, start, tolerance)


def _fits(d: Dynamics, speeds: SpeedLoop, poses: PoseLoop | None) -> None:
    """Refuse controllers of another platform."""
    n = len(d.kinematics.driven)
    if len(speeds.proportional) != n:
        raise InputError(f"speed loop: expected gains of {n} driven wheels, got {len(speeds.proportional)}")
    if poses is None:
        return
    if poses.period < speeds.period:
        raise InputError(f"pose loop: period {poses.period:g} s is shorter than {speeds.period:g} s of the speed loops")
    if not (is_unicycle(d.kinematics) if poses.unicycle else d.kinematics.mobility == 3):
        raise InputError("pose loop: it does not fit the motions that this platform allows")


def _count(total: float, period: float) -> int:
    """Samples in a time."""
    found = math.floor(total / period + 1e-9) + 1
    if not 2 <= found <= _MOST:
        raise InputError(f"following: expected 2 to {_MOST} samples, got {found} of {period:g} s in {total:g} s")
    return found


def _torques(d: Dynamics, plan: Planned, ground: Ground) -> Array:
    """Feedforward of the dynamic model [N*m], shape (n, k)."""
    S = d.kinematics.motions
    allowed = S @ np.linalg.pinv(S)  # between the ends of a piece a held wheel would slide by rounding
    eta, rate = (map_columns(allowed, found) for found in plan.in_robot())
    return wheel_torques(d, eta, rate, theta=plan.posture[2], ground=ground)


def _simulate(a: Arrays, d: Dynamics, plan: Planned, speeds: SpeedLoop, poses: PoseLoop | None, fed: Array,
              start: Array, tolerance: float) -> Followed:  # fmt: skip
    """Run the machine code, and name its results."""
    if not 0.0 < tolerance < 1.0:
        raise InputError(f"following: tolerance must lie between 0 and 1 m/s, got {tolerance!r}")
    least = _WITHIN * min(a.B[at.SLIP_SPEED], a.B[at.TURNROUND])
    n, count, wheels = len(a.W), len(plan.time), list(d.kinematics.driven)
    gains, P = np.zeros((n, 3)), np.zeros(7)
    gains[wheels] = np.array([speeds.proportional, speeds.integral, speeds.limit]).T
    if poses is not None:
        P[:4] = 2.0 if poses.unicycle else 1.0, round(poses.period / speeds.period), poses.proportional, poses.integral
        P[at.K_X], P[at.K_Y], P[at.APERIODIC] = poses.proportional, poses.distance**-2, 2.0 / poses.distance
    rows, floor, applied = np.zeros((count, len(start))), np.zeros((count, 3, n)), np.zeros((count, n))
    limited, torque = np.zeros(n), np.clip(fed[0], -gains[:, 2], gains[:, 2])
    S = d.kinematics.motions
    eta = np.ascontiguousarray(map_columns(S @ np.linalg.pinv(S), plan.in_robot()[0]).T)
    done = compiled()(
        a.W, a.K, a.B, a.C, a.M, gains, d.kinematics.E, P, np.ascontiguousarray(plan.posture.T), eta, fed[1:], start,
        torque, speeds.period, a.lever, min(tolerance, least), np.zeros((n, at.WORK)), np.zeros((3, 3)),
        np.zeros((7, len(start))), np.zeros(9 + 2 * n), rows, floor, applied, limited,
    )  # fmt: skip
    if done < count:
        raise InputError(f"following: speeds diverge at {plan.time[done]:.6g} s; check torques, gains and periods")
    y = rows.T
    velocity, turned = y[3:6], y[6 : 6 + n]
    kinetic = (np.einsum("ik,ij,jk->k", velocity, a.M, velocity) + a.W[:, at.J] @ turned**2) / 2.0
    slip, load, traction = floor.transpose(1, 2, 0)
    return Followed(plan, y[:3], velocity, turned, applied.T, slip, load, traction, limited / (count - 1), y[6 + n],
                    y[7 + n :], kinetic, float(a.B[at.FRICTION]))  # fmt: skip
