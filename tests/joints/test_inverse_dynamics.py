"""Joint torques: against a Newton-Euler of a textbook over random chains, linearity in masses, power balance."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from newton_euler import Part, energy, random_chain, torques, urdf

from drivesizer.joints.inverse_dynamics import Attached, torques_of
from drivesizer.spec.description import read_description

GRAVITY = np.array([1.3, -2.4, -9.2])  # of a base that is tilted


def names(count: int) -> list[str]:
    return [f"j{number}" for number in range(1, count + 1)]


@pytest.mark.parametrize("seed", range(10))
def test_a_textbooks_newton_euler_gives_the_same_over_random_chains(seed: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 8))
    parts = random_chain(rng, count)
    robot = read_description(urdf(parts, tmp_path / "chain.urdf"))
    states = tuple(rng.normal(size=(3, count)) * scale for scale in (2.0, 3.0, 10.0))
    at = rng.normal(size=3)
    found = torques_of(robot, {}, [Attached("l1", at), Attached(f"l{count}", -at)], names(count), states, GRAVITY)
    rows = list(zip(*states, strict=True))
    plain = np.array([torques(parts, *row, GRAVITY) for row in rows])
    still = np.array([torques(parts, row[0], 0 * row[1], 0 * row[2], GRAVITY) for row in rows])
    assert found.torque[0] == pytest.approx(plain, rel=1e-9, abs=1e-9 * np.abs(plain).max())
    assert found.static[0] == pytest.approx(still, rel=1e-9, abs=1e-9 * np.abs(plain).max())
    for column in range(count):  # the joint alone, at rest and without weight
        unit = np.eye(count)[column]
        own = [torques(parts, row[0], 0 * unit, unit, np.zeros(3))[column] for row in rows]
        assert found.inertia[0, :, column] == pytest.approx(own, rel=1e-9)
    m1, m2 = 3.7, 0.9
    parts[0].points.append((m1, at))
    parts[-1].points.append((m2, -at))
    laden = np.array([torques(parts, *row, GRAVITY) for row in rows])
    summed = found.torque[0] + m1 * found.torque[1] + m2 * found.torque[2]
    assert summed == pytest.approx(laden, rel=1e-9, abs=1e-9 * np.abs(laden).max())


@pytest.mark.parametrize("seed", range(3))
def test_work_of_the_torques_is_the_change_of_energy(seed: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(100 + seed)
    parts = random_chain(rng, 4)
    robot = read_description(urdf(parts, tmp_path / "chain.urdf"))
    amplitude, rate, phase = rng.uniform(0.2, 1.0, 4), rng.uniform(0.5, 2.0, 4), rng.uniform(0, 6, 4)
    edges = np.linspace(0.0, 2.0, 101)
    nodes, weights = np.polynomial.legendre.leggauss(4)
    time = (edges[:-1, None] + np.diff(edges)[:, None] * (nodes + 1) / 2).ravel()
    angle = rate * time[:, None] + phase
    states = (amplitude * np.sin(angle), amplitude * rate * np.cos(angle), -amplitude * rate**2 * np.sin(angle))
    found = torques_of(robot, {}, [], names(4), states, GRAVITY).torque[0]
    work = float(((found * states[1]).sum(axis=1) * np.tile(weights / 2, 100)).sum() * (edges[1] - edges[0]))
    first, last = rate * 0.0 + phase, rate * 2.0 + phase
    ends = [energy(parts, amplitude * np.sin(p), amplitude * rate * np.cos(p), GRAVITY) for p in (first, last)]
    assert work == pytest.approx(ends[1] - ends[0], rel=1e-9)


def test_the_algorithm_is_that_of_mj_inverse(tmp_path: Path) -> None:
    import mujoco

    rng = np.random.default_rng(7)
    path = urdf(random_chain(rng, 5), tmp_path / "chain.urdf")
    model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.gravity[:] = GRAVITY
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    data = mujoco.MjData(model)
    q, v, a = rng.normal(size=(3, 5))
    data.qpos[:], data.qvel[:], data.qacc[:] = q, v, a
    mujoco.mj_inverse(model, data)
    found = torques_of(read_description(path), {}, [], names(5), (q[None], v[None], a[None]), GRAVITY)
    # MuJoCo before 3.14 differs by 3e-9, and only where it reads the file itself
    assert found.torque[0, 0] == pytest.approx(data.qfrc_inverse, rel=1e-8)


# --- published robots

RIGHT = math.pi / 2
# standard DH: a, d, alpha; mass, centre in the link's frame, principal inertia; inertia of the rotor and gear ratio,
# viscous friction and Coulomb friction in the positive direction, at the motor
PUMA = (
    (0.0, 0.67183, RIGHT, 0.0, (0.0, 0.0, 0.0), (0.0, 0.35, 0.0), 200e-6, -62.6111, 1.48e-3, 0.395),
    (0.4318, 0.0, 0.0, 17.4, (-0.3638, 0.006, 0.2275), (0.13, 0.524, 0.539), 200e-6, 107.815, 0.817e-3, 0.126),
    (0.0203, 0.15005, -RIGHT, 4.8, (-0.0203, -0.0141, 0.07), (0.066, 0.086, 0.0125), 200e-6, -53.7063, 1.38e-3, 0.132),
    (0.0, 0.4318, RIGHT, 0.82, (0.0, 0.019, 0.0), (1.8e-3, 1.3e-3, 1.8e-3), 33e-6, 76.0364, 71.2e-6, 11.2e-3),
    (0.0, 0.0, -RIGHT, 0.34, (0.0, 0.0, 0.0), (0.3e-3, 0.4e-3, 0.3e-3), 33e-6, 71.923, 82.6e-6, 9.26e-3),
    (0.0, 0.0, 0.0, 0.09, (0.0, 0.0, 0.032), (0.15e-3, 0.15e-3, 0.04e-3), 33e-6, 76.686, 36.7e-6, 3.96e-3),
)
ARMATURE = np.array([row[6] * row[7] ** 2 for row in PUMA])
READY = np.array([0.0, math.pi / 4, math.pi, 0.0, math.pi / 4, 0.0])  # the toolbox's nominal pose, qn
DOWN = np.array([0.0, 0.0, -9.81])


def puma(folder: Path) -> Any:
    """Links turn about the axis z of the frame before, which the figures' frames follow by d, a and alpha."""
    parts, before = [], (0.0, 0.0, 0.0)
    for a, d, alpha, mass, centre, inertia, *_ in PUMA:
        turn = np.array([
            [1, 0, 0], [0, math.cos(alpha), -math.sin(alpha)], [0, math.sin(alpha), math.cos(alpha)]
        ])  # fmt: skip
        place = (before[0], 0.0, before[1])
        centre_here, inertia_here = np.array([a, 0.0, d]) + turn @ np.array(centre), turn @ np.diag(inertia) @ turn.T
        parts.append(Part(False, place, (before[2], 0.0, 0.0), (0.0, 0.0, 1.0), mass, centre_here, inertia_here))
        before = (a, d, alpha)
    return read_description(urdf(parts, folder / "puma.urdf"))


def of(robot: Any, position: Any, speed: Any, acceleration: Any, gravity: Any = DOWN) -> Any:
    """Torques in one state, the description's masses alone."""
    states = tuple(np.atleast_2d(np.asarray(x, float)) for x in (position, speed, acceleration))
    names = [name for name, joint in robot.joints.items() if joint.moves]
    return torques_of(robot, {}, [], names, states, gravity)


def test_puma_560(tmp_path: Path) -> None:
    robot, still, one = puma(tmp_path), np.zeros(6), np.ones(6)
    printed = [0.0, 31.6399, 6.0351, 0.0, 0.0283, 0.0]
    at_rest = of(robot, READY, still, still)
    assert at_rest.torque[0, 0] == pytest.approx(printed, abs=5e-5)
    friction = np.array([row[8] * row[7] ** 2 + abs(row[7]) * row[9] for row in PUMA])  # at 1 rad/s each
    turning = of(robot, READY, one, still).torque[0, 0] + friction
    assert turning == pytest.approx([29.1421, 56.5044, 16.3528, 1.2645, 1.1239, 0.5196], abs=6e-5)
    faster = of(robot, READY, one, one).torque[0, 0] + friction + ARMATURE
    assert faster == pytest.approx([32.4952, 60.8670, 17.7436, 1.4545, 1.2991, 0.7138], abs=6e-5)
    diagonal = [3.6594, 4.4137, 0.9378, 0.1925, 0.1713, 0.1941]
    assert at_rest.inertia[0, 0] + ARMATURE == pytest.approx(diagonal, abs=5e-5)


def test_coriolis_torques_of_the_puma_560(tmp_path: Path) -> None:
    robot, still, speed = puma(tmp_path), np.zeros(6), np.array([1.0, 2.0, 3.0, 1.0, 2.0, 3.0])
    printed = np.array([
        [-0.1735, -2.0494, -0.1178, -0.0002, -0.0045, 0.0001], [0.6274, 1.1572, 1.9287, -0.0015, -0.0003, 0.0],
        [-0.3608, -0.7734, -0.0018, -0.0009, -0.0064, 0.0], [0.0011, 0.0005, -0.0001, 0.0002, 0.0002, -0.0001],
        [-0.0002, 0.0028, 0.0046, -0.0002, 0.0, 0.0], [0.0001, 0.0, 0.0, 0.0, 0.0, 0.0],
    ])  # fmt: skip
    found = of(robot, READY, speed, still)
    assert found.torque[0, 0] - found.static[0, 0] == pytest.approx(printed @ speed, abs=5e-5 * speed.sum())


def test_the_three_link_robot_of_modern_robotics(tmp_path: Path) -> None:
    """Its first axis is (1, 0, 1), not of length 1: angle and torque of it count by the root of 2."""
    scale = np.array([math.sqrt(2.0), 1.0, 1.0])
    axes = [(1.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0)]
    points = np.array([(-0.5, 0.0, 0.5), (0.0, 0.0, 0.089), (0.425, 0.0, 0.089)])  # of v = (0,1,0), (-0.089,0,0), ...
    centres = np.array([(0.0, 0.0, 0.089159), (0.28, 0.13585, 0.089159), (0.675, 0.01615, 0.089159)])
    turned = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    masses = [3.7, 8.393, 2.275]
    inertias = [
        np.diag([0.010267, 0.010267, 0.00666]), turned @ np.diag([0.22689, 0.22689, 0.0151074]) @ turned.T,
        turned @ np.diag([0.0494433, 0.0494433, 0.004095]) @ turned.T,
    ]  # fmt: skip
    before = np.vstack([np.zeros(3), points[:-1]])
    parts = [
        Part(False, points[i] - before[i], np.zeros(3), axes[i], masses[i], centres[i] - points[i], inertias[i])
        for i in range(3)
    ]
    robot = read_description(urdf(parts, tmp_path / "three.urdf"))
    q, v, a = (np.array(x) * scale for x in ([0.1, 0.1, 0.1], [0.1, 0.2, 0.3], [2.0, 1.5, 1.0]))
    found = of(robot, q, v, a, np.array([0.0, 0.0, -9.8]))
    assert found.static[0, 0] * scale == pytest.approx([28.40331262, -37.64094817, -5.4415892], abs=5e-9)
    assert found.inertia[0, 0] * scale**2 == pytest.approx([22.5433380, 1.96850717, 0.191630858], rel=5e-9)
    whole, tip = [74.69616155, -33.06766016, -3.23057314], [1.40954608, 1.85771497, 1.392409]  # with a force at the tip
    assert found.torque[0, 0] * scale == pytest.approx(np.array(whole) - tip, abs=1e-8)


@pytest.mark.parametrize("seed", range(3))
def test_a_two_link_arm_with_drives(seed: int, tmp_path: Path) -> None:
    """All terms of the book's equations but those of a rotor that turns about a moving axis, which are left out."""
    rng = np.random.default_rng(seed)
    a1, l1, l2, ml, il, kr, mm, im = 1.0, 0.5, 0.5, 50.0, 10.0, 100.0, 5.0, 0.01
    flat = np.diag([0.0, 0.0, il])
    parts = [
        Part(False, (0, 0, 0), (0, 0, 0), (0, 0, 1), ml, (l1, 0, 0), flat),
        Part(False, (a1, 0, 0), (0, 0, 0), (0, 0, 1), ml, (l2, 0, 0), flat),
    ]
    robot = read_description(urdf(parts, tmp_path / "two.urdf"))
    q, v, a = rng.normal(size=(3, 2))
    states = (q[None], v[None], a[None])
    found = torques_of(robot, {}, [Attached("l1", np.array([a1, 0, 0]))], ["j1", "j2"], states, np.array([0, -9.81, 0]))
    c2, s2, c1, c12 = math.cos(q[1]), math.sin(q[1]), math.cos(q[0]), math.cos(q[0] + q[1])
    b11 = il + ml * l1**2 + kr**2 * im + il + ml * (a1**2 + l2**2 + 2 * a1 * l2 * c2) + im + mm * a1**2
    b12 = il + ml * (l2**2 + a1 * l2 * c2) + kr * im
    b22 = il + ml * l2**2 + kr**2 * im
    h = -ml * a1 * l2 * s2
    t1 = b11 * a[0] + b12 * a[1] + 2 * h * v[0] * v[1] + h * v[1] ** 2
    t1 += (ml * l1 + mm * a1 + ml * a1) * 9.81 * c1 + ml * l2 * 9.81 * c12
    t2 = b12 * a[0] + b22 * a[1] - h * v[0] ** 2 + ml * l2 * 9.81 * c12
    rotors = np.array([kr**2 * im * a[0], kr**2 * im * a[1]])  # of each joint's own drive, added by its search
    left_out = np.array([im * a[0] + kr * im * a[1], kr * im * a[0]])
    ours = found.torque[0, 0] + mm * found.torque[1, 0] + rotors
    assert ours + left_out == pytest.approx([t1, t2], rel=1e-12)
