"""The exported MJCF in MuJoCo against the simulation of ``drivesizer validate``: speed and current over the load cycle.

MuJoCo gets the file as it is written, and at each step what the file says of its inputs: angle, speed, torque ahead.
The simulation is sampled every 0.4 ms and answers a period late; MuJoCo's controller is continuous. A PI loop that is
late by T_d = 1.5 periods is off, at a jump a of the required acceleration, by no more than what the motor gains in that
time, a T_d, which is 0.17 rad/s here, and its current by what the loop makes of it, k_p a T_d / R: 0.09 A; the friction
that lets go at the start, which the late loop meets later, is as much again.

What MuJoCo has not is a gear's efficiency by the direction of power. A weight has it all the same, by hand on an arm
that lifts and lowers; inertia has it by the rule that the file's remarks tell, and without it too much current where
the drive brakes: by what 1/e in place of e makes.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from exports import rendered
from specs import poorer

from drivesizer.files.yaml_source import YamlSource
from drivesizer.output.export import export_of
from drivesizer.output.export.common import torque_law
from drivesizer.simulate import validate
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import read_spec

mujoco = pytest.importorskip("mujoco", "3.12", reason="MuJoCo with inputs of its dcmotor is not installed")
from mujoco import rollout  # noqa: E402

pytestmark = pytest.mark.usefixtures("no_further_searches")

CASCADE = """control:
  structure: cascade
  speed_from: exact
  velocity: {bandwidth: 20 Hz}
"""


@pytest.fixture(scope="module")
def sps(spec, catalog):
    """Speed measured exactly, as MuJoCo's own sensors have it; the motor without its figures of heat."""
    exact = spec.control.model_copy(update={"speed_from": "exact"})
    return spec.model_copy(update={"control": exact}), size(spec, catalog=poorer(catalog), top=1).sets[0]


@pytest.fixture(scope="module")
def proof(sps):
    return validate(*sps)


@pytest.fixture(scope="module")
def servo(example_text, sps):
    """The same set with a cascade, and a shorter way."""
    text = example_text[: example_text.index("control:")] + CASCADE + example_text[example_text.index("select:") :]
    spec = read_spec(YamlSource(text.replace("cruise_time: 240 s", "cruise_time: 4 s"), "servo.yaml"))
    return spec, sps[1]


def asked(model, time):
    """Angle, speed and acceleration of the shaft that the file's own cycle asks for."""
    points, speeds = (model.numeric(name).data for name in ("cycle_time", "cycle_speed"))
    w = np.interp(time, points, speeds)
    way = np.concatenate([[0.0], np.cumsum(np.diff(points) * (speeds[1:] + speeds[:-1]) / 2)])
    at = np.clip(np.searchsorted(points, time, side="right") - 1, 0, len(points) - 2)
    slope = (np.diff(speeds) / np.diff(points))[at]
    since = np.clip(time - points[at], 0.0, None)
    return way[at] + speeds[at] * since + slope * since**2 / 2, w, slope


def driven(export, model=None, seconds=None, weight=0.0):
    """Time, motor speed and current in MuJoCo, by the inputs that the file's remarks tell."""
    model = model or mujoco.MjModel.from_xml_string(rendered(export, "mjcf").decode())
    data, K, law = mujoco.MjData(model), export.train.ratio, torque_law(export)
    end = seconds or model.numeric("cycle_time").data[-1]
    time = np.arange(round(end / model.opt.timestep)) * model.opt.timestep
    angle, w, slope = asked(model, time)
    ahead = K * (law.per_speed * w + law.per_acceleration * slope) + law.per_direction * np.sign(w)
    control = np.stack([K * angle, K * w, ahead, np.full_like(w, weight)], axis=1)
    full = mujoco.mjtState.mjSTATE_FULLPHYSICS
    start = np.empty(mujoco.mj_stateSize(model, full))
    mujoco.mj_getState(model, data, start, full)
    states, _ = rollout.rollout(model, data, start, control)
    _, _, speed, *rest = states[0].T  # time, angle, speed, activation
    return time + model.opt.timestep, K * speed, rest[0]


def compared(proof, found, begin, end):
    """Largest and RMS difference of motor speed [rad/s] and current [A] within a stretch of time."""
    time, speed, current = found
    within = (time > begin) & (time < end)
    s = proof.series
    off = [
        x[within] - np.interp(time[within], s["time"], s[name])
        for x, name in ((speed, "motor_speed"), (current, "current"))
    ]
    return np.array([(np.abs(x).max(), np.sqrt(np.square(x).mean())) for x in off]).T


def test_the_whole_cycle_of_the_robot(sps, proof):
    """244 s, in steps of a control period: speeding up, cruising, and what is late."""
    spec, found = sps
    export = export_of(spec, found)
    model = mujoco.MjModel.from_xml_string(rendered(export, "mjcf").decode())
    model.opt.timestep = export.period
    run = driven(export, model)
    assert proof.series["motor_speed"].max() > 580.0 and proof.series["current"].max() > 1.8
    worst, rms = compared(proof, run, 0.0, 241.99)
    assert worst[0] < 0.17 and rms[0] < 0.02  # rad/s of 583
    assert worst[1] < 0.18 and rms[1] < 0.003  # A of 1.86
    assert run[1][-1] == pytest.approx(0.0, abs=0.4)  # rad/s: it stops


ARM = """name: arm
load: {kind: arm, mass: 2 kg, length: 200 mm, start_angle: -40 deg, tilt: 30 deg}
motion: {speed: 60 deg/s, acceleration_time: 0.4 s, cruise_time: 1 s}
supply: {nominal: 24 V}
select: {catalogs: [maxon]}
"""


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_an_arm_under_gravity_lifted_and_lowered(way):
    """At constant speed through 2.1 rad, where its lever lies level and beyond: torque and current by hand.

    W = m g l cos(tilt) cos(angle); of the motor W/(K e) lifting and W e/K lowering, plus its friction: of k_t I_0 65 %
    at any speed, the rest by its part of the no-load speed.
    A-max 26 110940: 25.5 mN*m/A, 31.7 mA and 8890 rpm at no load; GP 32 A 295:1 166175: efficiency 0.6,
    inertia 0.7 g*cm^2.
    """
    spec = read_spec(YamlSource(ARM, "arm.yaml"))
    (found, *_) = explain(spec, "110940", "166175")
    export = export_of(spec, found)
    model = mujoco.MjModel.from_xml_string(rendered(export, "mjcf").decode())
    data, law, K, e, k = mujoco.MjData(model), torque_law(export), export.train.ratio, 0.6, 25.5e-3
    data.qpos[0], speed = (0.0 if way > 0 else 2.1), 0.6 * way
    at, current = [], []
    for n in range(round(3.5 / model.opt.timestep)):
        angle = (0.0 if way > 0 else 2.1) + speed * n * model.opt.timestep
        data.ctrl[:] = K * angle, K * speed, law.per_speed * K * speed, 0.0
        mujoco.mj_step(model, data)
        at.append(data.qpos[0])
        current.append(data.act[-1])
    lost = way * k * 31.7e-3 * (0.65 + 0.35 * K * 0.6 / (8890.0 * np.pi / 30.0))
    settled = slice(round(0.5 / model.opt.timestep), None)
    weight = 2.0 * 9.80665 * 0.2 * np.cos(np.radians(30.0)) * np.cos(np.radians(-40.0) + np.array(at))
    torque = np.where(weight * way > 0.0, weight / e, weight * e)
    by_hand = (torque / K + lost) / k
    assert abs(weight).max() > 3.3 and np.abs(by_hand[settled]).max() > (0.7 if way > 0 else 0.2)  # A
    assert np.abs(np.array(current) - by_hand)[settled].max() < 1e-3  # A; what grows with speed is 2.1 mA


def test_the_cascade(servo):
    """The on-board law with the gains of velocity loop and feedforward, without the sampled current loop.

    Where the acceleration asked for jumps, feedforward lets the current jump at once, by 1.3 A; the simulation's own
    comes a velocity period later, and its current loop takes some more: 5 ms are left out of the current's largest
    difference.
    """
    spec, found = servo
    proof, export = validate(spec, found), export_of(spec, found)
    run = driven(export, seconds=2.5)
    worst, rms = compared(proof, run, 0.0, 2.5)
    assert worst[0] < 0.2 and rms[0] < 0.02  # rad/s of 583
    assert rms[1] < 0.03  # A of 1.7
    for begin, end in ((0.005, 1.999), (2.005, 2.5)):
        assert compared(proof, run, begin, end)[0, 1] < 0.06  # A


def test_the_current_s_limit_holds(servo):
    """A third of what the motion takes: MuJoCo cuts torque, and the drive falls behind at k_t I - drag over inertia."""
    spec, found = servo
    export = replace(export_of(spec, found), peak_current=1.0)
    _, speed, _ = driven(export, seconds=0.5)
    train = export.train
    drag = train.friction + train.forward_torque / train.ratio / train.efficiency
    inertia = train.motor_inertia + train.load_inertia / train.ratio**2 / train.efficiency
    rate = (train.torque_constant * 1.0 - drag) / inertia
    assert speed[-1] == pytest.approx(rate * 0.5, rel=5e-3)


def test_every_figure_of_the_motor_arrives(sps):
    """MuJoCo's own parameters, against the data sheet of RE 25 118752."""
    spec, found = sps
    model = mujoco.MjModel.from_xml_string(rendered(export_of(spec, found), "mjcf").decode())
    motor = model.actuator("motor")
    assert motor.gear[0] == pytest.approx(3249 / 121 * 1.1, rel=1e-11)
    assert np.allclose(motor.forcerange, [-0.0234 * 15.0, 0.0234 * 15.0])
    assert [model.nu, model.na] == [4, 1]
    assert model.opt.timestep == 1e-4


def test_torque_by_current_and_voltage_by_speed_may_differ(sps):
    """NEO, by its maker: 19.8 mN*m/A and 25 mV*s. Unloaded it runs at V / k_e; held it pulls with k_t V / R."""
    spec, found = sps
    export = export_of(spec, found)
    k_t, k_e = 19.8e-3, 25e-3
    train = replace(export.train, torque_constant=k_t, back_emf_constant=k_e, friction=0.0, viscous=0.0,
                    load_inertia=1e-3, forward_torque=0.0, backward_torque=0.0, rest_torque=0.0)  # fmt: skip
    root = ET.fromstring(rendered(replace(export, train=train), "mjcf").decode())
    motor = root.find("actuator/dcmotor")
    limit = float(motor.get("controller").split()[-1]) / export.voltage
    motor.attrib.pop("controller")
    motor.set("input", "voltage")
    model = mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))
    data = mujoco.MjData(model)
    data.ctrl[0] = 12.0 * limit  # the file's volts, by its own limit
    mujoco.mj_step(model, data, 5000)
    assert train.ratio * data.qvel[0] == pytest.approx(12.0 / k_e, rel=1e-3)
    data.qvel[0] = 0.0
    data.ctrl[0], data.act[-1] = limit * 2.32 * 3.0, limit * 3.0  # V, A: held, they stay what they are
    mujoco.mj_forward(model, data)
    assert data.actuator("motor").force[0] == pytest.approx(3.0 * k_t)
    assert model.actuator("motor").forcerange[1] == pytest.approx(15.0 * k_t)


def test_a_weight_and_the_load_over_time_pull(sps):
    spec, found = sps
    export = export_of(spec, found)
    heavy = replace(export, train=replace(export.train, forward_torque=1.168, backward_torque=0.832, rest_torque=1.0))
    model = mujoco.MjModel.from_xml_string(rendered(heavy, "mjcf").decode())
    data = mujoco.MjData(model)
    for more in (0.0, 0.5):
        data.ctrl[3] = more
        mujoco.mj_forward(model, data)
        weight = (1 / 0.76 + 0.76) / 2  # and the rest of what it takes lifted, 1/0.76, is dry friction
        assert data.actuator("load_torque").force[0] == pytest.approx(-weight - more / 0.76)
    friction = (1 / 0.76 - 0.76) / 2 + 0.168 / 0.76 + export.train.friction * export.train.ratio
    assert model.dof_frictionloss[0] == pytest.approx(friction)
