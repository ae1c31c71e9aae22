"""The machine of the closed loop against MuJoCo's DC motor: another program's motor, gear, friction and gravity.

MuJoCo (Google DeepMind, Apache 2.0; ``pip install mujoco``, 3.7 or later for ``dcmotor``) has in its actuator a winding
with resistance and inductance, a rotor inertia that goes by the square of the gear ratio, and a back-EMF; its joints
have dry friction. It gets the voltage that the march applied, held over each control period, and nothing else.

What it has not is a gear's efficiency. Two machines bring it in:

- *whole*: one sliding mass. Driving, a loss of gears is a load that is larger by 1/e: mass, inertia and resistance.
- *two masses*: rotor and vehicle with a stiff shaft between; the test takes from what the shaft transmits what the
  gears lose, by the direction of power at each step. Nothing of the modes of :mod:`drivesizer.plant` is in it.

MuJoCo's step h is of first order for a motor with inductance, whatever its integrator (measured against exp(At)): its
speed is off by about h dw/dt. That, and not a choice, sets the tolerances.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from drivesizer.control_design import design
from drivesizer.march import Limits, march
from drivesizer.motion import Motion
from drivesizer.plant import drive_train
from drivesizer.profile import Profile
from drivesizer.sizing import explain

mujoco = pytest.importorskip("mujoco", "3.7", reason="MuJoCo with its dcmotor actuator is not installed")

PERIOD = 4e-4  # s, of the EPOS4's speed loop
GRAVITY = 9.80665  # m/s^2
LIMITS = Limits(supply=22.0, voltage=18.9, peak_current=15.0, continuous_current=5.0)
WIDTH = 6  # columns of a march's rows: time, reference, motor speed, current, voltage, gearhead torque
# friction as hard as MuJoCo allows: its dry friction is a constraint that yields a little
HARD = 'solreffriction="0.0001 1" solimpfriction="0.9999 0.9999 0.001 0.5 2"'

HEAD = """<mujoco><compiler angle="radian"/>
  <option timestep="{step}" integrator="implicit" gravity="{along} 0 {down}" tolerance="1e-14" iterations="50">
    <flag contact="disable"/></option>"""
WHOLE = (
    HEAD
    + """
  <worldbody><body><joint name="way" type="slide" axis="1 0 0" armature="{wheel}" frictionloss="{friction}" {hard}/>
    <inertial pos="0 0 0" mass="{mass}" diaginertia="1 1 1"/></body></worldbody>
  <actuator><dcmotor joint="way" gear="{per_metre}" armature="{rotor}" resistance="{R}" motorconst="{k} {k}"
    inductance="{L} 0"/></actuator></mujoco>"""
)
TWO_MASSES = (
    HEAD
    + """
  <worldbody>
    <body><joint name="rotor" type="hinge" axis="0 0 1" frictionloss="{motor_friction}" {hard}/>
      <inertial pos="0 0 0" mass="1e-9" diaginertia="1e-14 1e-14 1e-14"/></body>
    <body><joint name="way" type="slide" axis="1 0 0" armature="{wheel}" frictionloss="{rolling}" {hard}/>
      <inertial pos="0 0 0" mass="{mass}" diaginertia="1 1 1"/></body></worldbody>
  <actuator><dcmotor joint="rotor" gear="1" armature="{rotor}" resistance="{R}" motorconst="{k} {k}"
    inductance="{L} 0"/></actuator></mujoco>"""
)
STIFFNESS, DAMPING = 4e4, 4.0  # N*m/rad and N*m*s/rad at the wheel: rings at 6400 rad/s, damped to a third


@pytest.fixture(scope="module")
def robot(spec, catalog):
    """The machine of the SPS robot on a slope in degrees, and its gains."""
    chosen = explain(spec, "118752", "406764", catalog=catalog)[0]

    def made(degrees):
        hilly = spec.model_copy(update={"load": spec.load.model_copy(update={"slope": math.radians(degrees)})})
        train, _ = drive_train(hilly, chosen, PERIOD)
        return train, design(hilly, train, PERIOD), math.radians(degrees)

    return made


def marched(train, gains, profile, limits=LIMITS):
    """Time, motor speed, current and voltage at the samples of a march."""
    rows = np.array(march(train, gains, limits, profile).recorder.rows).reshape(-1, WIDTH)
    time, _, speed, current, volts, _ = rows.T
    return time, speed, current, volts


def compiled(text, train, slope, step, loss=1.0):
    """A MuJoCo model of a drive train, its load larger by a factor."""
    rolling = (train.forward_torque - train.backward_torque) / 2.0 / train.radius * loss
    figures = {
        "step": step, "along": -GRAVITY * math.sin(slope), "down": -GRAVITY * math.cos(slope), "hard": HARD,
        "mass": train.mass * loss, "wheel": train.turning_inertia / train.radius**2 * loss, "rolling": rolling,
        "friction": rolling + train.friction * train.motor_per_speed, "motor_friction": train.friction,
        "per_metre": train.motor_per_speed, "rotor": train.motor_inertia,
        "R": train.resistance, "L": train.inductance, "k": train.torque_constant,
    }  # fmt: skip
    model = mujoco.MjModel.from_xml_string(text.format(**figures))
    data = mujoco.MjData(model)
    uneven = (train.forward_torque + train.backward_torque) / 2.0 - train.slope_torque
    data.qfrc_applied[-1] = -uneven / train.radius * loss  # the bearings lose more uphill than downhill, by (2)
    return model, data


def whole(train, slope, time, volts, start, steps, loss):
    """Motor speed [rad/s] and current [A] of the one sliding mass at times; so many steps to a period."""
    model, data = compiled(WHOLE, train, slope, PERIOD / steps, loss)
    per_speed = train.motor_per_speed
    data.qvel[0], data.act[0] = start[0] / per_speed, start[1]
    found = [start]
    for count, u in zip(np.rint(np.diff(time) / PERIOD).astype(int), volts, strict=False):
        data.ctrl[0] = u
        mujoco.mj_step(model, data, int(count) * steps)
        found.append((data.qvel[0] * per_speed, data.act[0]))
    return np.array(found).T


def two_masses(train, slope, time, volts, start, steps):
    """The same of rotor and vehicle with a stiff shaft between, and gears that lose by the direction of power."""
    model, data = compiled(TWO_MASSES, train, slope, PERIOD / steps)
    K, r, e = train.ratio, train.radius, train.efficiency
    held = train.slope_torque / STIFFNESS * K  # the shaft is twisted already where the weight hangs on it
    place, speed, force, uneven = data.qpos, data.qvel, data.qfrc_applied, data.qfrc_applied[-1]
    place[0], speed[:], data.act[0] = held, (start[0], start[0] / train.motor_per_speed), start[1]
    found = [start]
    for count, u in zip(np.rint(np.diff(time) / PERIOD).astype(int), volts, strict=False):
        data.ctrl[0] = u
        for _ in range(int(count) * steps):
            (a, x), (w, v) = place.tolist(), speed.tolist()
            torque = STIFFNESS * (a / K - x / r) + DAMPING * (w / K - v / r)
            force[:] = -torque / K * (1.0 / e if torque * v > 0.0 else e), torque / r + uneven
            mujoco.mj_step(model, data)
        found.append((speed[1] * train.motor_per_speed, data.act[0]))
    return np.array(found).T


def off(found, speed, current):
    """Largest differences of motor speed [rad/s] and current [A]."""
    return np.abs(found - np.array((speed, current))).max(axis=1)


# --- driving: the loss of the gears as a larger load


@pytest.mark.parametrize(
    ("degrees", "limits"),
    [
        pytest.param(3.0, LIMITS, id="uphill"),
        pytest.param(2.0, replace(LIMITS, voltage=10.0, peak_current=3.0), id="within tight limits"),
    ],
)
def test_driving(robot, degrees, limits):
    train, gains, slope = robot(degrees)
    asked = Profile("ramp", (0.0, 0.05, 0.55, 0.65), (0.4, 0.4, 1.2, 1.2))
    time, speed, current, volts = marched(train, gains, asked, limits)
    assert current.min() > 0.05  # A: more than what it takes to drive the wheel, 0.033 A
    runs = [whole(train, slope, time, volts, (speed[0], current[0]), n, 1.0 / train.efficiency) for n in (10, 20)]
    coarse, fine = (off(run, speed, current) for run in runs)
    h, acceleration = PERIOD / 20, np.diff(speed).max() / PERIOD  # 20 us, up to 700 rad/s^2
    assert fine[0] < h * acceleration < 1.5e-2  # rad/s of up to 470: MuJoCo's step
    assert fine[1] < 2e-5  # A of up to 4.4; what that speed induces, k w / R, would be 1.4e-4
    assert coarse[0] / fine[0] == pytest.approx(2.0, abs=0.15)  # half its step, half the difference: ours has no part


# --- driving and braking: two masses, and a loss by the direction of power


@pytest.mark.parametrize("degrees", [0.0, 3.0, -6.0])
def test_there_and_back(robot, degrees):
    """The current goes from driving to braking and back, the motion through rest.

    What is left is the shaft's twist and the march's own grain: it meets rest to 1/16 of a period, 25 us, and is still
    at 0 where MuJoCo already runs backward with up to 1500 rad/s^2: 0.04 rad/s.
    """
    train, gains, slope = robot(degrees)
    asked = Profile("there and back", (0.0, 0.3, 0.4, 0.9, 1.0), (0.0, 1.0, 1.0, -0.8, -0.8))
    time, speed, current, volts = marched(train, gains, asked)
    assert speed.max() > 380.0 and speed.min() < -300.0 and current.max() > 5.0 and current.min() < -5.0
    found = two_masses(train, slope, time, volts, (speed[0], current[0]), 20)
    assert off(found, speed, current) == pytest.approx([0.0, 0.0], abs=0.06)  # rad/s of 390, A of 7: at the reversal
    strayed = np.sqrt(np.square(found - np.array((speed, current))).mean(axis=1))
    assert strayed[0] < 0.02 and strayed[1] < 1e-3  # rad/s, A: RMS over the whole second


# --- rest and dry friction


def moved(train, volts, periods, speed=0.0):
    """Time, motor speed and current under a constant voltage."""
    motion = Motion(train, PERIOD, speed=speed)
    rows = [(0.0, motion.w, motion.i)]
    for n in range(1, periods + 1):
        motion.advance(volts, n * PERIOD)
        rows.append((n * PERIOD, motion.w, motion.i))
    return np.array(rows).T


@pytest.mark.parametrize("share", [-1.01, -0.99, 0.99, 1.01, 1.5])
def test_breakaway(robot, share):
    """Friction of motor and wheel holds up to 0.374 A, that is 0.867 V, in either direction."""
    train, _, slope = robot(0.0)
    breakaway = (train.friction + train.forward_torque / (train.ratio * train.efficiency)) / train.torque_constant
    volts = share * breakaway * train.resistance
    time, speed, current = moved(train, volts, 500)
    found = whole(train, slope, time, np.full(500, volts), (0.0, 0.0), 40, 1.0 / train.efficiency)
    assert current[-1] == pytest.approx(found[1, -1], abs=1e-6)
    if abs(share) < 1.0:
        assert not speed.any()
        assert np.abs(found[0]).max() < 1e-6  # rad/s: MuJoCo's friction yields a little
    else:
        assert np.sign(share) * speed[-1] > 0.1
        # the march starts up to 1/16 of a period late: 25 us of at most 40 rad/s^2
        assert off(found, speed, current) == pytest.approx([0.0, 0.0], abs=1e-3)


def test_a_shorted_motor_runs_out_and_stays(robot):
    train, _, slope = robot(0.0)
    time, speed, current = moved(train, 0.0, 1500, speed=50.0)
    found = two_masses(train, slope, time, np.zeros(1500), (speed[0], current[0]), 20)
    stops = [time[np.argmax(np.abs(w) < 1e-3)] for w in (speed, found[0])]
    assert 0.2 < stops[0] < 0.4 and stops[0] == pytest.approx(stops[1], abs=PERIOD)
    assert not speed[-100:].any() and np.abs(found[0, -100:]).max() < 1e-6  # rad/s
    # the short turns the power round within the first period: the shaft takes that longer than a rigid chain
    assert off(found, speed, current) == pytest.approx([0.0, 0.0], abs=0.03)  # rad/s of 50, A of 0.4
    assert off(found[:, 25:], speed[25:], current[25:]) == pytest.approx([0.0, 0.0], abs=2e-3)  # after 10 ms


@pytest.mark.parametrize("degrees", [20.0, -20.0])
def test_rolls_away_on_a_slope_that_friction_does_not_hold(robot, degrees):
    """From rest, where the motor held the weight, until it runs at the speed that the shorted motor brakes to."""
    train, _, slope = robot(degrees)
    time, speed, current = moved(train, 0.0, 1500)
    assert -np.sign(degrees) * speed[-1] == pytest.approx(250.0, abs=1.0)
    found = two_masses(train, slope, time, np.zeros(1500), (speed[0], current[0]), 20)
    # the shaft untwists in the first period
    assert off(found, speed, current) == pytest.approx([0.0, 0.0], abs=0.1)  # rad/s of 250, A of 4
    assert off(found[:, 25:], speed[25:], current[25:]) == pytest.approx([0.0, 0.0], abs=0.03)  # after 10 ms
