"""A differential drive against MuJoCo: wheels that roll by friction on a floor, a body with six freedoms, a caster.

MuJoCo (Google DeepMind, Apache 2.0) gets speeds of the wheels and tells the torques that its velocity servos need. Its
wheels roll by contact forces at one point each, and creep by what its soft friction allows; nothing of constraints,
null spaces or E is in it. Its step h is of first order: half of it, and the difference halves.
"""

import math

import numpy as np
import pytest

from drivesizer.platform.dynamics import Moving, dynamics, wheel_torques
from drivesizer.platform.kinematics import Caster, Platform, Wheel

mujoco = pytest.importorskip("mujoco", "3.7", reason="MuJoCo is not installed")

R, HALF = 0.1, 0.25  # m: wheel radius, half the track
BODY, BODY_INERTIA, AHEAD, ASIDE = 26.0, 1.7, 0.08, -0.03  # kg, kg*m^2, m: its centre of mass off the axle's middle
WHEEL, AXLE, ACROSS = 2.0, 0.012, 0.006  # kg, kg*m^2 about the axle and about the vertical

ONE = f"""<body pos="0 %s 0"><joint name="%s" type="hinge" axis="0 1 0"/>
        <geom type="ellipsoid" size="{R} 0.02 {R}" mass="0" condim="3" friction="2 0 0"/>
        <inertial pos="0 0 0" mass="{WHEEL}" diaginertia="{ACROSS} {AXLE} {ACROSS}"/></body>"""
MODEL = f"""<mujoco>
  <option timestep="%s" integrator="implicitfast" gravity="0 0 -9.80665" cone="elliptic" impratio="100"
    tolerance="1e-14" iterations="100"/>
  <default><geom solref="0.01 1" solimp="0.95 0.99 0.001" condim="1" friction="0 0 0"/></default>
  <worldbody>
    <geom type="plane" size="50 50 1"/>
    <body pos="0 0 {R}"><freejoint/>
      <inertial pos="{AHEAD} {ASIDE} 0.02" mass="{BODY}" diaginertia="0.9 1.1 {BODY_INERTIA}"/>
      <geom name="caster" type="sphere" size="0.02" pos="0.3 0 {0.02 - R}"/>
      {ONE % (-HALF, "right")}
      {ONE % (HALF, "left")}
    </body>
  </worldbody>
  <actuator><velocity joint="right" kv="5"/><velocity joint="left" kv="5"/></actuator>
</mujoco>"""


def platform():
    """The same machine as one mass on two wheels, by the parallel axes."""
    mass = BODY + 2 * WHEEL
    x, y = BODY * AHEAD / mass, BODY * ASIDE / mass
    inertia = BODY_INERTIA + BODY * ((AHEAD - x) ** 2 + (ASIDE - y) ** 2)
    inertia += sum(ACROSS + WHEEL * (x**2 + (side - y) ** 2) for side in (-HALF, HALF))
    wheels = tuple(Wheel(x=0.0, y=side, radius=R, held=True, inertia=AXLE) for side in (-HALF, HALF))
    return Platform(wheels=wheels, mass=mass, inertia=inertia, x=x, y=y, casters=(Caster(x=0.3, y=0.0),))


def driven(step, seconds=2.0):
    """Torques of MuJoCo's servos [N*m], its motion before and after each step, on a curve with a change of hand."""
    model = mujoco.MjModel.from_xml_string(MODEL % step)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, round(0.3 / step))  # sinks into the floor
    t = np.arange(round(seconds / step)) * step
    v, turn = 0.6 * np.sin(math.pi * t / 2) ** 2, 1.2 * np.sin(math.pi * t / 2) ** 2 * np.cos(2 * t)
    speeds = np.stack([v + HALF * turn, v - HALF * turn], axis=1) / R
    torques, motion = [], [ahead_and_turning(data)]
    for asked in speeds:
        data.ctrl[:] = asked
        mujoco.mj_step(model, data)
        torques.append(data.actuator_force.copy())
        motion.append(ahead_and_turning(data))
    return np.array(torques).T, np.array(motion).T


def ahead_and_turning(data):
    along = data.xmat[1].reshape(3, 3).T @ data.qvel[:3]
    return along[0], 0.0, data.qvel[5]


def compared(step):
    """MuJoCo's torques and ours for MuJoCo's motion, over windows of 20 ms; and that motion."""
    torques, motion = driven(step)
    middle, rate = (motion[:, 1:] + motion[:, :-1]) / 2, np.diff(motion, axis=1) / step
    ours = wheel_torques(dynamics(platform()), Moving(middle, rate))
    window = round(0.02 / step)
    smooth = [np.array([np.convolve(c, np.ones(window) / window, "valid") for c in cs]) for cs in (torques, ours)]
    return *smooth, middle


def test_torques_of_a_differential_drive():
    theirs, ours, motion = compared(1e-4)
    assert np.ptp(motion[0]) > 0.55 and np.ptp(motion[2]) > 1.0  # m/s, rad/s
    assert 2.0 < np.abs(theirs).max() < 2.2  # N*m
    fine, coarse = np.abs(theirs - ours).max(), np.abs(np.subtract(*compared(2e-4)[:2])).max()
    assert fine < 0.006  # N*m, of 2.08: 0.3 %
    assert coarse / fine == pytest.approx(2.0, abs=0.3)  # half its step, half the difference: ours has no part
