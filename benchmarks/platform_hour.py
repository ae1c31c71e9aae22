"""An hour of a platform at 100 Hz: speeds and torques of four mecanum wheels, beside a loop over the samples.

Kinematics: world to robot, wheel speeds. Dynamics: torques with mass off centre, a slope, rolling resistance of wheels
and rollers. The loop does what one writes first, NumPy on the 3 × 3 and 4 × 3 matrices of one sample.
"""

from __future__ import annotations

import argparse
import math
import time

import numpy as np
from goals import line

from drivesizer.platform.dynamics import Dynamics, Ground, Moving, dynamics, wheel_torques
from drivesizer.platform.equations import Array
from drivesizer.platform.kinematics import Platform, table_wheel, to_robot, wheel_speeds

SLOPE, C_RR, C_ROLLER = 0.03, 0.02, 0.01


def platform() -> Platform:
    """The robot of Table 1 of Appl. Sci. 2021, 11, 6631, its centre of mass off the middle."""
    a = math.radians(29.5)
    wheels = tuple(
        table_wheel(0.27406, alpha, math.pi / 2 - alpha, gamma, 0.0762, inertia=3.2e-3, rolling_resistance=C_RR,
                    roller_resistance=C_ROLLER)
        for alpha, gamma in zip((-a, a, math.pi - a, math.pi + a), np.pi / 4 * np.array([1, -1, 1, -1]), strict=True)
    )  # fmt: skip
    return Platform(wheels=wheels, mass=45.0, inertia=2.34, x=0.05, y=-0.02, height=0.15)


def course(seconds: float, rate: float) -> tuple[Array, Array, Array]:
    """Heading, velocity and acceleration in the world."""
    t = np.arange(round(seconds * rate)) / rate
    velocity = np.array([1.2 * np.sin(0.31 * t), 0.8 * np.cos(0.17 * t), 0.5 * np.sin(0.23 * t)])
    change = np.array([0.372 * np.cos(0.31 * t), -0.136 * np.sin(0.17 * t), 0.115 * np.cos(0.23 * t)])
    return -0.5 / 0.23 * np.cos(0.23 * t), velocity, change


def in_columns(d: Dynamics, theta: Array, velocity: Array, change: Array) -> tuple[Array, Array]:
    eta, rate = to_robot(theta, velocity), to_robot(theta, change)
    rate += eta[2] * np.array([eta[1], -eta[0], np.zeros_like(theta)])  # the axes turn
    return wheel_speeds(d.kinematics, eta), wheel_torques(d, Moving(eta, rate, theta, Ground(slope=SLOPE)))


def in_a_loop(d: Dynamics, theta: Array, velocity: Array, change: Array) -> tuple[Array, Array]:
    """The same, a sample at a time."""
    p, E, rollers, D = d.platform, d.kinematics.E, d.kinematics.rollers, d.distribution
    pull, normal = 9.80665 * math.sin(SLOPE), p.mass * 9.80665 * math.cos(SLOPE)
    places = np.array(p.contacts)
    share, centre = places @ np.linalg.inv(places.T @ places), np.array([p.x, p.y])
    speeds, torques = [], []
    for angle, v, a in zip(theta.tolist(), velocity.T, change.T, strict=True):
        c, s = math.cos(angle), math.sin(angle)
        R = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        eta, rate = R @ v, R @ a
        rate = rate + eta[2] * np.array([eta[1], -eta[0], 0.0])
        x, y = -p.mass * pull * c, p.mass * pull * s
        load = normal / 4 + share @ (normal * centre + p.height * np.array([x, y]))
        force = d.M @ rate + eta[2] * (d.C @ eta) - np.array([x, y, p.x * y - p.y * x])
        force = force + E.T @ (C_RR * 0.0762 * load * np.sign(E @ eta))
        force = force + rollers.T @ (C_ROLLER * load * np.sign(rollers @ eta))
        speeds.append(E @ eta)
        torques.append(D @ force)
    return np.array(speeds).T, np.array(torques).T


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--loop", type=int, default=20_000, help="samples of the loop")
    options = parser.parse_args()
    d, given = dynamics(platform()), course(3600.0, 100.0)
    best = np.inf
    for _ in range(options.runs):
        start = time.perf_counter()
        speeds, torques = in_columns(d, *given)
        best = min(best, time.perf_counter() - start)
    some = [c[..., : options.loop] for c in given]
    start = time.perf_counter()
    slow = in_a_loop(d, *some)
    each = (time.perf_counter() - start) / options.loop
    off = max(
        np.abs(a[:, : options.loop] - b).max() / np.abs(b).max() for a, b in zip((speeds, torques), slow, strict=True)
    )
    print(line("platform", best))
    print(f"{'the same in a loop':34}{each * speeds.shape[1]:10.1f} s    from {options.loop:,} samples")
    print(f"{'loop / columns':34}{each * speeds.shape[1] / best:10.0f}      they differ by {off:.0e} of the largest")


if __name__ == "__main__":
    main()
