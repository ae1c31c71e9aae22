"""Joint torques: against a Newton-Euler of a textbook over random chains, linearity in masses, power balance."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from newton_euler import energy, random_chain, torques, urdf

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
