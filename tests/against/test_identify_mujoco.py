"""``identify`` on logs of MuJoCo's DC motor with noise, a quantised speed and a delay: figures within their bands.

MuJoCo's step is of first order for a motor with inductance; a hundred to a sample leave less than the bands.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drivesizer.identification.identify import identify

mujoco = pytest.importorskip("mujoco", "3.7", reason="MuJoCo with its dcmotor actuator is not installed")

FINE = 100  # steps in a sample
MODEL = """<mujoco><compiler angle="radian"/>
  <option timestep="{step}" integrator="implicit" gravity="0 0 0" tolerance="1e-14" iterations="50">
    <flag contact="disable"/></option>
  <worldbody><body><joint name="shaft" type="hinge" axis="0 0 1" frictionloss="{M_c}" damping="{b}"
      solreffriction="{stiff} 1" solimpfriction="0.9999 0.9999 0.001 0.5 2"/>
    <inertial pos="0 0 0" mass="1e-9" diaginertia="1e-14 1e-14 1e-14"/></body></worldbody>
  <actuator><dcmotor joint="shaft" gear="1" armature="{J}" resistance="{R}" motorconst="{k_e} {k_e}"
    inductance="{L} 0"/></actuator></mujoco>"""
NAMED = {"b": "viscous", "L": "inductance", "M_c": "dry"}  # what a log does not separate, in words


def drawn(seed: int) -> tuple[dict[str, float], float, float]:
    """A motor at 24 V with its delay, the log's interval [s], and the share of noise."""
    random = np.random.default_rng([seed, 77])
    R, k, J = 10 ** random.uniform(-1, 1), 10 ** random.uniform(-2, -0.7), 10 ** random.uniform(-6, -4.5)
    tau, stall = J * R / k**2, k * 24.0 / R
    h = tau / random.uniform(10, 40)
    L, M_c = R * tau * random.uniform(0.01, 0.1), stall * random.uniform(0.01, 0.06)
    one = {"R": R, "k_e": k, "J": J, "L": L, "M_c": M_c, "b": stall * random.uniform(0.004, 0.05) * k / 24.0}
    one["delay"] = random.integers(0, 41) / 20 * h
    return one, h, random.uniform(0.001, 0.01)


def logged(one: dict[str, float], h: float, noise: float, seed: int) -> bytes:
    """1200 samples of it under steps of voltage; the current is twice as noisy as the speed."""
    random, count = np.random.default_rng([seed, 78]), 1200
    u = np.repeat(random.uniform(-24.0, 24.0, count // 40), 40)
    text = MODEL.format(step=h / FINE, stiff=2.2 * h / FINE, **one)
    model = mujoco.MjModel.from_xml_string(text)
    data, found = mujoco.MjData(model), np.zeros((count, 2))
    whole, part = divmod(round(one["delay"] / h * FINE), FINE)
    for k in range(count):
        found[k] = data.act[0], data.qvel[0]
        for late, steps in ((whole + 1, part), (whole, FINE - part)):
            data.ctrl[0] = u[max(k - late, 0)]
            if steps:
                mujoco.mj_step(model, data, steps)
    top = np.abs(found).max(axis=0)
    found += noise * top * [2.0, 1.0] * random.standard_normal(found.shape)
    found[:, 1] = np.round(found[:, 1] / top[1] * 250.0) * top[1] / 250.0
    rows = np.column_stack([h * np.arange(count), u, found])
    return "\n".join(["time (s),voltage (V),current (A),speed (rad/s)",
                      *(",".join(f"{x:.9g}" for x in row) for row in rows)]).encode()  # fmt: skip


@pytest.mark.parametrize("seeds", [range(4), pytest.param(range(100, 140), marks=pytest.mark.slow)])
def test_random_drives_are_within_their_bands(seeds: range) -> None:
    inside = []
    for seed in seeds:
        one, h, noise = drawn(seed)
        found = identify(Path("log.csv"), content=logged(one, h, noise, seed))
        figures = {figure.name: figure for figure in found.figures}
        for name, true in one.items():
            if name in figures:
                inside.append(figures[name].low <= true <= figures[name].high)
            else:
                assert NAMED[name] in " ".join(tied.figures for tied in found.inseparable), (seed, name)
    assert np.mean(inside) >= 0.9
