"""The machine of the closed loop against MuJoCo's DC motor: another program's motor, gear, friction and gravity.

MuJoCo (Google DeepMind, Apache 2.0; ``pip install mujoco``, 3.7 or later for ``dcmotor``) has in its actuator a winding
with resistance and inductance, a rotor inertia that goes by the square of the gear ratio, and a back-EMF; its joints
have dry friction, and damping, which grows with speed. It gets the voltage that the simulation applied, held over each
control period, and nothing else: of the PID that acts on the voltage every 0.4 ms, and of the cascade every 40 us.
Mass, wheel, slope and rolling friction are those of the spec, the motor's friction is by its data sheet's no-load
current.

What it has not is a gear's efficiency. Two machines bring it in:

- *whole*: one sliding mass. Driving, a loss of gears is a load that is larger by 1/e: mass, inertia and resistance.
- *two masses*: rotor and vehicle with a shaft between, stiff where the simulation is rigid; the test takes from what
  the shaft transmits what the gears lose, by the direction of power at each step, without the simulation's modes.

MuJoCo's step h is of first order for a motor with inductance, whatever its integrator (measured against exp(At)): its
speed is off by about h dw/dt. That, and not a choice, sets the tolerances.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from linear_machines import cascade_control
from textbook_machine import PERIOD, SHAFT, on_slope, slower, task_of

from drivesizer.control.engine import CurrentLimit, Drive, Supply, Task, simulate
from drivesizer.control.gains import design, design_cascade
from drivesizer.control.validation import Cascade, Gains, Rates

mujoco = pytest.importorskip("mujoco", "3.7", reason="MuJoCo with its dcmotor actuator is not installed")

RATES = Rates(4e-5, 4e-4, 1.2e-3)  # s: current, velocity, position
SUPPLY, PEAK = Supply(voltage=22.0, max_duty=0.9, voltage_drop=1.0), CurrentLimit(peak=15.0)
# RE 25 118752 without load: 23.4 mN*m/A, 36.9 mA and 9560 rpm at 24 V; of a brushed motor's torque 65 % is dry
K_T, I_0, W_0 = 23.4e-3, 36.9e-3, 9560.0 * math.pi / 30.0
DRY, VISCOUS = 0.65 * K_T * I_0, 0.35 * K_T * I_0 / W_0  # N*m, N*m*s/rad
# friction as hard as MuJoCo allows: its dry friction is a constraint that yields a little
HARD = 'solreffriction="0.0001 1" solimpfriction="0.9999 0.9999 0.001 0.5 2"'

HEAD = """<mujoco><compiler angle="radian"/>
  <option timestep="{step}" integrator="implicit" gravity="{along} 0 {down}" tolerance="1e-14" iterations="50">
    <flag contact="disable"/></option>"""
WHOLE = (
    HEAD
    + """
  <worldbody><body><joint name="way" type="slide" axis="1 0 0" armature="{wheel}" {hard}
      frictionloss="{friction}" damping="{damping}"/>
    <inertial pos="0 0 0" mass="{mass}" diaginertia="1 1 1"/></body></worldbody>
  <actuator><dcmotor joint="way" gear="{per_metre}" armature="{rotor}" resistance="{R}" motorconst="{k} {k}"
    inductance="{L} 0"/></actuator></mujoco>"""
)
TWO_MASSES = (
    HEAD
    + """
  <worldbody>
    <body><joint name="rotor" type="hinge" axis="0 0 1" {hard}
      frictionloss="{motor_friction}" damping="{motor_damping}"/>
      <inertial pos="0 0 0" mass="1e-9" diaginertia="1e-14 1e-14 1e-14"/></body>
    <body><joint name="way" type="slide" axis="1 0 0" armature="{wheel}" frictionloss="{rolling}" {hard}/>
      <inertial pos="0 0 0" mass="{mass}" diaginertia="1 1 1"/></body></worldbody>
  <actuator><dcmotor joint="rotor" gear="1" armature="{rotor}" resistance="{R}" motorconst="{k} {k}"
    inductance="{L} 0"/></actuator></mujoco>"""
)
# at the wheel: rings at 6400 rad/s, and with the shorter steps of the cascade at 20 000, damped to a third
STIFF = {"stiffness": 4e4, "damping": 4.0, "gap": 0.0}
STIFFER = {"stiffness": 4e5, "damping": 13.0, "gap": 0.0}


@pytest.fixture(scope="module")
def robot(spec, catalog):
    """Of the SPS robot on a slope in degrees: the drive train, a voltage PID and a cascade, and the load."""

    def made(degrees):
        hilly, train = on_slope(spec, catalog, degrees)
        servo, _ = design_cascade(train, RATES, cascade_control(bandwidth=30.0, position=True))
        return train, {"voltage PID": design(hilly, train, PERIOD), "cascade": servo}, load_of(hilly)

    return made


def load_of(spec):
    """A wheel's share of the robot, and its wheel and shaft as cylinders, from the spec alone."""
    load, g = spec.load, spec.environment.gravity
    inertia = 0.0
    for c in (load.cylinders.wheel, load.cylinders.shaft):
        outer, inner = c.outer_diameter / 2.0, (c.inner_diameter or 0.0) / 2.0
        inertia += c.density * c.width * math.pi / 2.0 * (outer**4 - inner**4)
    mass, radius = load.mass / load.driven_wheels, load.wheel_diameter / 2.0
    return {
        "mass": mass, "wheel": inertia / radius**2,
        "along": -g * math.sin(load.slope), "down": -g * math.cos(load.slope),
        "rolling": load.rolling_resistance * mass * g * math.cos(load.slope),
    }  # fmt: skip


def driven(train, controller, time, speed, /, **more):
    """A simulation along speeds of the robot [m/s]; nothing is left out of its series."""
    drive = Drive(**{"train": train, "controller": controller, "supply": SUPPLY, "current": PEAK} | more)
    return simulate(drive, task_of(train, time, speed), rows=60_000).series


def compiled(text, train, load, step, loss=1.0):
    """A MuJoCo model of a drive train, its load larger by a factor."""
    figures = {name: load[name] * loss for name in ("mass", "wheel", "rolling")} | {
        "step": step, "along": load["along"], "down": load["down"], "hard": HARD,
        "friction": load["rolling"] * loss + DRY * train.motor_per_speed, "motor_friction": DRY,
        "damping": VISCOUS * train.motor_per_speed**2, "motor_damping": VISCOUS,
        "per_metre": train.motor_per_speed, "rotor": train.motor_inertia,
        "R": train.resistance, "L": train.inductance, "k": train.torque_constant,
    }  # fmt: skip
    model = mujoco.MjModel.from_xml_string(text.format(**figures))
    return model, mujoco.MjData(model)


def held(s, period):
    """Voltages of a series, each with the periods that it is held for."""
    return zip(np.rint(np.diff(s["time"]) / period).astype(int).tolist(), s["voltage"].tolist(), strict=False)


def whole(train, load, s, steps, period=PERIOD):
    """Motor speed [rad/s] and current [A] of the one sliding mass under a series; so many steps to a period."""
    model, data = compiled(WHOLE, train, load, period / steps, 1.0 / train.efficiency)
    per_speed = train.motor_per_speed
    data.qvel[0], data.act[0] = s["motor_speed"][0] / per_speed, s["current"][0]
    found = [(s["motor_speed"][0], s["current"][0])]
    for count, data.ctrl[0] in held(s, period):
        mujoco.mj_step(model, data, count * steps)
        found.append((data.qvel[0] * per_speed, data.act[0]))
    return np.array(found).T


def two_masses(train, load, s, steps, period=PERIOD, shaft=STIFF):
    """The same of rotor and vehicle with a shaft between, and gears that lose by the direction of power."""
    model, data = compiled(TWO_MASSES, train, load, period / steps)
    K, r, e = train.ratio, train.radius, train.efficiency
    stiffness, damping, half = shaft["stiffness"], shaft["damping"], shaft["gap"] / 2.0
    soft = stiffness < STIFF["stiffness"]  # a stiff one rings, which a rigid chain does not: the vehicle is looked at
    place, speed, force = data.qpos, data.qvel, data.qfrc_applied
    speed[:], data.act[0] = (s["motor_speed"][0], s["motor_speed"][0] / train.motor_per_speed), s["current"][0]
    twist = hanging(load, speed[1]) * r / stiffness  # the shaft is twisted already where the weight hangs on it
    place[0] = K * (twist + math.copysign(half, twist) * (twist != 0.0))
    found = [(s["motor_speed"][0], s["current"][0])]
    for count, data.ctrl[0] in held(s, period):
        for _ in range(count * steps):
            (a, x), (w, v) = place.tolist(), speed.tolist()
            twist = a / K - x / r
            pressed = twist - math.copysign(min(half, abs(twist)), twist)
            torque = stiffness * pressed + damping * (w / K - v / r)
            if half and torque * pressed <= 0.0:
                torque = 0.0
            force[:] = -torque / K * (1.0 / e if torque * (w if soft else v) > 0.0 else e), torque / r
            mujoco.mj_step(model, data)
        found.append((speed[0] if soft else speed[1] * train.motor_per_speed, data.act[0]))
    return np.array(found).T


def hanging(load, v):
    """Force along the way at the start: weight and rolling; none at rest where friction holds."""
    weight = -load["mass"] * load["along"]
    if v:
        return weight + math.copysign(load["rolling"], v)
    return weight if abs(weight) > load["rolling"] else 0.0


def off(found, s):
    """Largest differences of motor speed [rad/s] and current [A]."""
    return np.abs(found - (s["motor_speed"], s["current"])).max(axis=1)


def rms_off(found, s):
    """The same, root mean square."""
    return np.sqrt(np.square(found - (s["motor_speed"], s["current"])).mean(axis=1))


# --- driving: the loss of the gears as a larger load


@pytest.mark.parametrize(
    ("degrees", "structure", "limits"),
    [
        pytest.param(3.0, "voltage PID", {}, id="uphill"),
        pytest.param(
            2.0, "voltage PID", {"supply": Supply(voltage=10.0), "current": CurrentLimit(peak=3.0)},
            id="within tight limits",
        ),
        pytest.param(3.0, "cascade", {}, id="cascade"),
        pytest.param(
            2.0, "cascade", {"supply": Supply(voltage=12.0), "current": CurrentLimit(peak=3.0)},
            id="cascade within tight limits",
        ),
    ],
)  # fmt: skip
def test_driving(robot, degrees, structure, limits):
    train, controllers, load = robot(degrees)
    c = controllers[structure]
    period = c.current_period if isinstance(c, Cascade) else c.period
    s = driven(train, c, (0.0, 0.048, 0.548, 0.648), (0.4, 0.4, 1.2, 1.2), **limits)
    assert s["current"].min() > 0.05  # A: more than what it takes to drive the wheel, 0.033 A
    n = 4 if isinstance(c, Cascade) else 40  # steps of 10 us
    coarse, fine = (off(whole(train, load, s, steps, period), s) for steps in (n // 2, n))
    h, acceleration = period / n, np.abs(np.diff(s["motor_speed"])).max() / period  # up to 700 rad/s^2
    assert fine[0] < h * acceleration < 8e-3  # rad/s of up to 470: MuJoCo's step
    assert fine[1] < 1e-5  # A of up to 4.3; what that speed induces, k w / R, would be 7e-5
    assert coarse[0] / fine[0] == pytest.approx(2.0, abs=0.1)  # half its step, half the difference: ours has no part


# --- driving and braking: two masses, and a loss by the direction of power


@pytest.mark.parametrize(
    ("structure", "degrees"),
    [("voltage PID", 0.0), ("voltage PID", 3.0), ("voltage PID", -6.0), ("cascade", 0.0), ("cascade", -6.0)],
)
def test_there_and_back(robot, degrees, structure):
    """The current goes from driving to braking and back, the motion through rest.

    What is left is the twist of MuJoCo's shaft: where the current leaps, its vehicle comes a moment later.
    """
    train, controllers, load = robot(degrees)
    c = controllers[structure]
    period, steps, shaft = (PERIOD, 20, STIFF) if structure == "voltage PID" else (RATES.current, 10, STIFFER)
    s = driven(train, c, (0.0, 0.3, 0.4, 0.9, 1.0), (0.0, 1.0, 1.0, -0.8, -0.8))
    assert s["motor_speed"].max() > 380.0 and s["motor_speed"].min() < -300.0
    assert s["current"].max() > 4.8 and s["current"].min() < -4.8
    found = two_masses(train, load, s, steps, period, shaft)
    assert off(found, s) == pytest.approx([0.0, 0.0], abs=0.08)  # rad/s of 390, A of 7: at the reversal
    strayed = rms_off(found, s)
    assert strayed[0] < 0.012 and strayed[1] < 1e-3  # rad/s, A: RMS over the whole second


@pytest.mark.parametrize(("structure", "gap"), [("voltage PID", 0.0), ("voltage PID", 0.01), ("cascade", 0.01)])
def test_a_soft_shaft_there_and_back(robot, gap, structure):
    """The simulation's two masses with a shaft that rings at 87 Hz, without and with backlash; the rotor's speed.

    The rotor alone has up to 1.2e5 rad/s^2: a step of MuJoCo, 7 us and 4 us of that, is 0.8 and 0.5 rad/s.
    """
    train, controllers, load = robot(3.0)
    soft, _ = design_cascade(train, RATES, cascade_control(bandwidth=5.0, position=True))
    c, period, steps = (soft, RATES.current, 5) if structure == "cascade" else (
        slower(controllers[structure]), PERIOD, 30)  # fmt: skip
    s = driven(train, c, (0.0, 0.3, 0.4, 0.9, 1.0), (0.0, 1.0, 1.0, -0.8, -0.8),
               train=replace(train, **SHAFT, gap=gap))  # fmt: skip
    assert s["motor_speed"].max() > 375.0 and s["motor_speed"].min() < -300.0
    assert (s["gear_torque"] == 0.0).any() == (gap > 0.0)  # the backlash is crossed
    coarse, fine = (two_masses(train, load, s, n, period, SHAFT | {"gap": gap}) for n in (steps, 2 * steps))
    assert off(fine, s)[0] < 0.45 and off(fine, s)[1] < 2e-3  # rad/s of 380, A of 7.5
    strayed = rms_off(fine, s)
    assert strayed[0] < 0.02 and strayed[1] < 2e-4  # rad/s, A: RMS over the whole second
    assert rms_off(coarse, s)[0] / strayed[0] > 1.5  # half its step, about half the difference: ours has little part


# --- rest and dry friction


def under(train, volts, seconds, speed=0.0):
    """The series of a voltage that is held: with a gain beyond measure the PID stays at its limit, without it at 0."""
    c = Gains(kp=1e6 if volts else 0.0, ki=0.0, kd=0.0, filter_time=0.0, period=PERIOD, rule="test", source="")
    aim = math.copysign(1e4, volts) if volts else speed / train.ratio
    task = Task(time=(0.0, PERIOD, seconds), speed=(speed / train.ratio, aim, aim))
    return simulate(Drive(train=train, controller=c, supply=Supply(voltage=abs(volts) or 1.0)), task).series


@pytest.mark.parametrize("share", [-1.01, -0.99, 0.99, 1.01, 1.5])
def test_breakaway(robot, share):
    """Friction of motor and wheel holds up to 0.344 A, that is 0.798 V, in either direction.

    The wheel 0.320 A and the motor 65 % of 36.9 mA: what grows with speed holds nothing.
    """
    train, _, load = robot(0.0)
    wheel = load["rolling"] * train.radius / (train.ratio * train.efficiency)
    holds = DRY + wheel
    volts = share * holds / train.torque_constant * train.resistance
    s = under(train, volts, 0.2)
    assert np.all(s["voltage"][2:] == volts)
    assert [wheel / K_T, holds / K_T] == pytest.approx([0.320, 0.344], abs=1e-3)
    found = whole(train, load, s, 40)
    assert s["current"][-1] == pytest.approx(found[1, -1], abs=2e-7)
    if abs(share) < 1.0:
        assert not s["motor_speed"].any()
        assert np.abs(found[0]).max() < 1e-6  # rad/s: MuJoCo's friction yields a little
    else:
        assert np.sign(share) * s["motor_speed"][-1] > 0.1
        # the simulation starts up to 1/1024 of a period late, 0.4 us of at most 40 rad/s^2; MuJoCo's step is
        # 10 us of that
        assert off(found, s) == pytest.approx([0.0, 0.0], abs=4e-4)


def test_a_shorted_motor_runs_out_and_stays(robot):
    train, _, load = robot(0.0)
    s = under(train, 0.0, 0.6, speed=50.0)
    found = two_masses(train, load, s, 20)
    stops = [s["time"][np.argmax(np.abs(w) < 1e-3)] for w in (s["motor_speed"], found[0])]
    assert 0.2 < stops[0] < 0.4 and stops[0] == pytest.approx(stops[1], abs=PERIOD)
    assert not s["motor_speed"][-5:].any() and np.abs(found[0, -5:]).max() < 1e-6  # rad/s
    # the short turns the power round within the first period: the shaft takes that longer than a rigid chain
    assert off(found, s) == pytest.approx([0.0, 0.0], abs=0.03)  # rad/s of 50, A of 0.4
    assert after_10_ms(found, s) == pytest.approx([0.0, 0.0], abs=6e-3)


def after_10_ms(found, s):
    late = s["time"] > 0.0099
    return off(found[:, late], {name: s[name][late] for name in ("motor_speed", "current")})


@pytest.mark.parametrize("degrees", [20.0, -20.0])
def test_rolls_away_on_a_slope_that_friction_does_not_hold(robot, degrees):
    """From rest, where the motor held the weight, towards the speed that the shorted motor brakes to, 293 rad/s."""
    train, _, load = robot(degrees)
    s = under(train, 0.0, 0.6)
    coarse, fine = (two_masses(train, load, s, n, shaft=STIFFER) for n in (40, 80))
    found = 2.0 * fine - coarse  # without MuJoCo's step, in first order
    pulls = (abs(load["along"]) * load["mass"] - load["rolling"]) * train.radius / train.ratio * train.efficiency
    brakes = K_T**2 / train.resistance + VISCOUS  # N*m*s/rad: winding and friction
    mass = (load["mass"] + load["wheel"]) * train.efficiency
    inertia = train.motor_inertia + mass * (train.radius / train.ratio) ** 2
    by_hand = (pulls - DRY) / brakes * -math.expm1(-0.6 * brakes / inertia)  # rad/s
    assert -np.sign(degrees) * s["motor_speed"][-1] == pytest.approx(by_hand, abs=1.0)
    # the shaft untwists in the first period
    assert off(found, s) == pytest.approx([0.0, 0.0], abs=0.01)  # rad/s of 264, A of 4
    assert after_10_ms(found, s) == pytest.approx([0.0, 0.0], abs=1e-3)
