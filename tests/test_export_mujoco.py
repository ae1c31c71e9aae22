"""The exported MJCF in MuJoCo against the march of ``drivesizer validate``: speed and current over the load cycle.

MuJoCo gets the file as it is written, and at each step what the file says of its inputs: angle, speed, torque ahead.
The march is sampled every 0.4 ms and answers a period late; MuJoCo's controller is continuous. A PI loop that is late
by T_d = 1.5 periods is off, at a jump a of the acceleration asked for, by no more than what the motor gains in that
time, a T_d, which is 0.17 rad/s here, and its current by what the loop makes of it, k_p a T_d / R: 0.09 A; the friction
that lets go at the start, which the late loop meets later, is as much again.

What MuJoCo has not, a gear's efficiency by the direction of power, is seen where the drive brakes: there its current
must be larger by what 1/e in place of e makes.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest

from drivesizer.export import export_of
from drivesizer.export.gains import torque_law
from drivesizer.export.mjcf import render
from drivesizer.simulate import validate
from drivesizer.sizing import size
from drivesizer.spec import read_spec
from drivesizer.yaml_source import YamlSource

mujoco = pytest.importorskip("mujoco", "3.12", reason="MuJoCo with inputs of its dcmotor is not installed")
from mujoco import rollout  # noqa: E402

CASCADE = """control:
  structure: cascade
  velocity: {bandwidth: 20 Hz}
"""


@pytest.fixture(scope="module")
def sps(spec):
    return spec, size(spec, top=1).sets[0]


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
    model = model or mujoco.MjModel.from_xml_string(render(export).decode())
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
    model = mujoco.MjModel.from_xml_string(render(export).decode())
    model.opt.timestep = export.period
    run = driven(export, model)
    assert proof.series["motor_speed"].max() > 580.0 and proof.series["current"].max() > 1.8
    worst, rms = compared(proof, run, 0.0, 241.99)
    assert worst[0] < 0.17 and rms[0] < 0.02  # rad/s of 583
    assert worst[1] < 0.18 and rms[1] < 0.003  # A of 1.86
    assert run[1][-1] == pytest.approx(0.0, abs=0.4)  # rad/s: it stops


def test_the_file_s_own_step(sps, proof):
    """A quarter of the control period: closer in speed by the step, which is MuJoCo's own error."""
    spec, found = sps
    export = export_of(spec, found)
    worst, rms = compared(proof, driven(export, seconds=3.0), 0.0, 3.0)
    assert worst[0] < 0.12 and rms[0] < 0.016  # rad/s
    assert worst[1] < 0.11 and rms[1] < 0.006  # A
    model = mujoco.MjModel.from_xml_string(render(export).decode())
    model.opt.timestep *= 4
    assert compared(proof, driven(export, model, seconds=3.0), 0.0, 3.0)[1, 0] > 2.5 * rms[0]


def test_what_braking_takes_too_much(sps, proof):
    """Decelerating, inertia drives the wheels: by 1/e where the drive has e."""
    spec, found = sps
    export = export_of(spec, found)
    train, s = export.train, proof.series
    torque = train.load_inertia * 0.75 / train.radius - train.forward_torque  # N*m that comes back: 1.5 m/s in 2 s
    own = train.motor_inertia * train.ratio * 0.75 / train.radius - train.friction
    march = -(torque * train.efficiency / train.ratio + own) / train.torque_constant
    theirs = -(torque / train.efficiency / train.ratio + own) / train.torque_constant
    model = mujoco.MjModel.from_xml_string(render(export).decode())
    model.opt.timestep = export.period
    time, _, current = driven(export, model)
    assert np.interp(243.0, s["time"], s["current"]) == pytest.approx(march, abs=2e-3)
    assert np.interp(243.0, time, current) == pytest.approx(theirs, abs=2e-3)
    assert theirs - march == pytest.approx(-0.408, abs=0.01)  # A


def test_the_cascade(servo):
    """The on-board law with the gains of velocity loop and feedforward, without the sampled current loop.

    Where the acceleration asked for jumps, feedforward lets the current jump at once, by 1.3 A; the march's own comes a
    velocity period later, and its current loop takes some more: 5 ms are left out of the current's largest difference.
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
    model = mujoco.MjModel.from_xml_string(render(export_of(spec, found)).decode())
    motor = model.actuator("motor")
    assert motor.gear[0] == pytest.approx(3249 / 121 * 1.1, rel=1e-11)
    assert np.allclose(motor.forcerange, [-0.0234 * 15.0, 0.0234 * 15.0])
    assert [model.nu, model.na] == [4, 1]
    assert model.opt.timestep == 1e-4


def test_a_free_motor_runs_up_as_its_time_constant_says(sps):
    """The file on plain voltage, as its remark says: R J / k^2 with all inertia, and the no-load speed."""
    spec, found = sps
    root = ET.fromstring(render(export_of(spec, found)).decode())
    motor = root.find("actuator/dcmotor")
    motor.attrib.pop("controller")
    motor.set("input", "voltage")
    root.find("worldbody/body/joint").attrib.pop("frictionloss")
    model = mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))
    data = mujoco.MjData(model)
    data.ctrl[0] = 12.0
    K, e = 3249 / 121 * 1.1, 0.76
    J = 1.134e-6 + export_of(spec, found).train.load_inertia / (K * K * e)
    tau = 2.32 * J / 0.0234**2
    mujoco.mj_step(model, data, round(tau / model.opt.timestep))
    assert K * data.qvel[0] == pytest.approx(12.0 / 0.0234 * (1.0 - np.exp(-1.0)), rel=2e-3)


def test_a_weight_and_the_load_over_time_pull(sps):
    spec, found = sps
    export = export_of(spec, found)
    heavy = replace(export, train=replace(export.train, forward_torque=1.168, backward_torque=0.832, rest_torque=1.0))
    model = mujoco.MjModel.from_xml_string(render(heavy).decode())
    data = mujoco.MjData(model)
    for more in (0.0, 0.5):
        data.ctrl[3] = more
        mujoco.mj_forward(model, data)
        assert data.actuator("load_torque").force[0] == pytest.approx(-(1.0 + more) / 0.76)


def test_the_winding_warms(sps):
    """One body: resistances together, the winding's capacity; by MuJoCo's own state."""
    spec, found = sps
    warm = replace(found, motor=replace(found.motor, winding_time_constant=12.4, motor_time_constant=910.0))
    export = export_of(spec, warm)
    root = ET.fromstring(render(export).decode())
    thermal = [float(x) for x in root.find("actuator/dcmotor").get("thermal").split()]
    assert thermal == pytest.approx([3.1 + 14.0, 12.4 / 3.1, 0.0, 0.0039, 25.0, 25.0])
    model = mujoco.MjModel.from_xml_string(render(export).decode())
    data = mujoco.MjData(model)
    assert model.na == 2
    data.ctrl[0] = 1e3  # far ahead: the motor runs at its voltage limit
    mujoco.mj_step(model, data, 2000)
    assert (data.act > 0.0).all()
