"""Controllers' own loops, as their public sources describe them, beside what `validate --device` simulates.

Each loop is written here from those descriptions, with the figures that stand in the controller's file and in its
units: turns, electrical revolutions a minute, shares of a current limit, amperes of a phase. Its motor is integrated
in small steps. ODrive: controller.cpp, encoder.cpp. moteus: fw/pid.h, docs on configuration. VESC: motor/foc_math.c.
SimpleFOC: common/pid.cpp, common/lowpass_filter.cpp, FOCMotor.cpp.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from drivesizer.control.devices import devices, read_back
from drivesizer.control.drive_train import drive_train
from drivesizer.control.loop_design import analyse
from drivesizer.files.yaml_source import YamlSource
from drivesizer.simulate import commissioned, validate
from drivesizer.sizing import size
from drivesizer.spec.drive import Control
from drivesizer.spec.robot import read_spec

SPEC = """
name: turned mass
load: {{kind: flywheel, inertia: 0.4 kg*cm^2, friction_torque: 5 mN*m}}
motion: {{profile: trapezoid, speed: 1500 rpm, acceleration_time: 80 ms, deceleration_time: 60 ms, cruise_time: 100 ms,
  rest_time: 60 ms}}
transmission: [{{kind: direct}}]
supply: {{nominal: 36 V, regeneration: 0, accepts: all}}
control: {{structure: cascade, {more}}}
plant: {{warming: false}}
needs: {{encoder_counts: 1000}}
select: {{catalogs: [maxon], motor: {{kind: brushless, family: "EC-i 40*"}}}}
"""
TURN = 2.0 * math.pi


class Motor:
    """A motor in amplitudes of a phase, with its load; friction holds it at rest."""

    def __init__(self, train, counts):
        self.R, self.L = train.resistance / 2.0, train.inductance / 2.0
        self.k, self.psi = train.torque_constant * math.sqrt(3.0) / 2.0, train.back_emf_constant / math.sqrt(3.0)
        self.J, self.b = train.motor_inertia + train.load_inertia, train.viscous
        self.drag = train.friction + train.forward_torque
        self.counts, self.i, self.w, self.x = counts, 0.0, 0.0, 0.0

    def run(self, volts, time, parts=4):
        h = time / parts
        for _ in range(parts):
            self.i += h / self.L * (volts - self.R * self.i - self.psi * self.w)
            push = self.k * self.i - self.b * self.w
            if self.w == 0.0 and abs(push) <= self.drag:
                continue
            turned = self.w + h / self.J * (push - self.drag * math.copysign(1.0, self.w or push))
            self.w = 0.0 if turned * self.w < 0.0 else turned
            self.x += h * self.w

    @property
    def count(self):
        return math.floor(self.x * self.counts / TURN)


def clamped(value, most):
    return min(max(value, -most), most)


def odrive(p, motor):
    """Position P, velocity PI and current PI at 8 kHz on the estimate of a phase-locked loop, in turns."""
    c, m, dt = p["axis0.controller.config"], p["axis0.motor.config"], 1.0 / 8000.0
    bandwidth = p["axis0.encoder.config"]["bandwidth"]
    pos = vel = torque_sum = volt_sum = volts = 0.0
    while True:
        speed, slope, angle = yield dt
        motor.run(volts, dt)
        pos += dt * vel
        off = motor.count + 0.5 - pos * motor.counts
        pos, vel = pos + dt * 2.0 * bandwidth * off / motor.counts, vel + dt * bandwidth**2 * off / motor.counts
        error = clamped(speed / TURN + c["pos_gain"] * (angle / TURN - pos), c["vel_limit"]) - vel
        torque = slope / TURN * c["inertia"] + c["vel_gain"] * error + torque_sum
        torque_sum += dt * c["vel_integrator_gain"] * error
        off = clamped(torque / m["torque_constant"], m["current_lim"]) - motor.i
        volts = m["current_control_bandwidth"] * motor.L * off + volt_sum
        volt_sum += dt * m["current_control_bandwidth"] * motor.R * off


def moteus(p, motor):
    """One PID on the position at the output, in revolutions; error is measured less desired, and the sign turns it."""
    pid, servo, dt = p["servo.pid_position"], p["servo"], 1.0 / 30000.0
    ratio, constant = p["motor_position"]["rotor_to_output_ratio"], 8.27 / p["motor"]["Kv"]
    summed = volt_sum = volts = 0.0
    while True:
        speed, slope, angle = yield dt
        motor.run(volts, dt)
        error, rate = (motor.x - angle) * ratio / TURN, (motor.w - speed) * ratio / TURN
        summed = clamped(summed + pid["ki"] * error * dt, pid["ilimit"])
        torque = -(pid["kp"] * error + pid["kd"] * rate + summed) + servo["inertia_feedforward"] * slope * ratio
        off = clamped(torque * ratio / constant, servo["max_current_A"]) - motor.i
        volt_sum += TURN * servo["pid_dq_hz"] * motor.R * off * dt
        volts = TURN * servo["pid_dq_hz"] * motor.L * off + volt_sum


def vesc(p, motor):
    """Speed PI at 1 kHz as a share of the current limit, in electrical rpm; below the least speed it lets go."""
    p, dt = p[""], 1.0 / 12500.0
    per, demand, summed, ramp, volt_sum, volts, k = 60.0 / TURN * p["si_motor_poles"] / 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0
    while True:
        speed, _, _ = yield dt
        motor.run(volts, dt)
        if k % 12 == 0:  # some millisecond
            step, wanted = p["s_pid_ramp_erpms_s"] * 12 * dt, speed * per
            ramp += clamped(wanted - ramp, 1.01 * step)
            error = ramp - motor.w * per
            if abs(ramp) < p["s_pid_min_erpm"]:
                summed = demand = 0.0
            else:
                share = clamped(error * p["s_pid_kp"] / 20.0 + summed, 1.0)
                summed = clamped(summed + error * p["s_pid_ki"] * 12 * dt / 20.0, 1.0)
                demand = share * p["l_current_max"]
        k += 1
        off = demand - motor.i
        volt_sum += p["foc_current_ki"] * off * dt
        volts = p["foc_current_kp"] * off + volt_sum


def vesc_position(p, motor):
    """A PID on the angle in degrees at 1 kHz straight to a share of the current limit; its I has what P leaves."""
    p, dt = p[""], 1.0 / 12500.0
    demand = summed = before = volt_sum = volts = 0.0
    k = 0
    while True:
        _, _, angle = yield dt
        motor.run(volts, dt)
        if k % 12 == 0:
            error = math.degrees(angle - motor.x) / p["p_pid_ang_div"]
            first, last = error * p["p_pid_kp"], (error - before) * p["p_pid_kd"] / (12 * dt)
            summed = clamped(summed + error * p["p_pid_ki"] * 12 * dt, 1.0 - abs(clamped(first, 1.0)))
            demand, before = clamped(first + summed + last, 1.0) * p["l_current_max"], error
        k += 1
        off = demand - motor.i
        volt_sum += p["foc_current_ki"] * off * dt
        volts = p["foc_current_kp"] * off + volt_sum


def simplefoc(p, motor):
    """Angle P alone demands the speed; velocity PI on a filtered speed at 1 kHz, current PI at 10 kHz; radians."""
    p, dt, every = p[""], 1e-4, 10
    before = filtered = summed = demand = volt_sum = volts = 0.0
    keep, k = p["MVF"] / (p["MVF"] + every * dt), 0
    while True:
        _, _, angle = yield dt
        motor.run(volts, dt)
        if k % every == 0:
            seen = (motor.count + 0.5) * TURN / motor.counts
            filtered = keep * filtered + (1.0 - keep) * (seen - before) / (every * dt)
            before, error = seen, clamped(p["MAP"] * (angle - seen), p["MLV"]) - filtered
            summed += p["MVI"] * every * dt * error
            demand = clamped(p["MVP"] * error + summed, p["MLC"])
        k += 1
        off = demand - motor.i
        volt_sum += p["MQI"] * dt * off
        volts = clamped(p["MQP"] * off + volt_sum, p["MLU"])


LOOPS = [  # with the section ``control`` beside its structure
    ("odrive-0.5", odrive, "position: {}"), ("moteus", moteus, "position: {}, speed_from: exact"),
    ("vesc", vesc, "speed_from: exact"), ("vesc", vesc_position, "position: {}, speed_from: exact"),
    ("simplefoc", simplefoc, "position: {}"),
]  # fmt: skip


def read(more):
    return read_spec(YamlSource(SPEC.format(more=more), "robot.yaml"))


@pytest.fixture(scope="module")
def drive():
    return size(read("speed_from: counts"), top=1).sets[0]


@pytest.mark.parametrize(("name", "loop", "more"), LOOPS)
def test_the_controller_s_own_loop_follows_what_is_simulated(name, loop, more, drive):
    """Within 2 % of the top speed all along the motion, with what stands in the file after rounding."""
    made = commissioned(read(more), drive, devices()[name])
    found: dict[str, dict[str, float]] = {}
    for row in made.rows:
        group, _, last = row.parameter.name.rpartition(".")
        found.setdefault(group, {})[last] = float(row.text)
    series = made.rounded.series
    motor = Motor(drive_train(made.rounded.spec, drive, 1e-4)[0], 4 * drive.encoder.lines)
    time, reference = series["time"], series["speed_reference"]
    turned = np.concatenate([[0.0], np.cumsum(np.diff(time) * (reference[1:] + reference[:-1]) / 2.0)])
    slopes = np.append(np.diff(reference) / np.maximum(np.diff(time), 1e-12), 0.0)
    running = loop(found, motor)
    period, seen = next(running), []
    for k in range(round((time[-1] - time[0]) / period)):
        at = time[0] + k * period
        n = int(np.searchsorted(time, at, "right")) - 1
        angle = turned[n] + (at - time[n]) * reference[n]
        running.send((float(np.interp(at, time, reference)), float(slopes[n]), float(angle)))
        seen.append(motor.w)
    ours = np.interp(time[0] + period * (1.0 + np.arange(len(seen))), time, series["speed"])
    top = np.abs(reference).max()
    assert np.abs(np.array(seen) - ours).max() < 0.02 * top
    assert np.sqrt(np.mean((np.array(seen) - ours) ** 2)) < 0.005 * top


def test_a_position_loop_alone_lags_by_the_speed_over_its_gain(drive):
    """Without the planned speed it demands all of it: w = K e once it has settled, here six time constants."""
    spec = read("speed_from: exact, position: {kp: 60, planned_speed: false}, rate: 5 kHz")
    proof = validate(spec, drive)
    cruise = int(np.searchsorted(proof.series["time"], proof.series["time"][0] + 0.179))
    speed, behind = proof.series["speed_reference"][cruise], proof.series["position_error"][cruise]
    assert behind == pytest.approx(speed / 60.0, rel=0.01)
    linear = {one.linear.name: one for one in proof.linear.figures}["tracking_error_peak"]
    assert linear.engine.value == pytest.approx(linear.linear.value, rel=0.02)


def test_a_loop_on_the_voltage_feeds_forward_what_the_motion_needs(drive):
    """By the linear model and the engine alike; the error is a fraction of what it is without."""
    spec = read("speed_from: exact").model_copy(
        update={"control": Control().model_copy(update={"speed_from": "exact"})}
    )
    ahead = commissioned(spec, drive, devices()["phoenix-6"]).rounded
    linear = {one.linear.name: one for one in ahead.linear.figures}
    assert linear["peak_voltage"].engine.value == pytest.approx(linear["peak_voltage"].linear.value, rel=0.02)
    alone = validate(spec.model_copy(update={"control": spec.control.model_copy(update={"rate": 1000.0})}), drive)
    error = {one.name: one.value for one in alone.figures}["tracking_error_peak"]
    assert {one.name: one.value for one in ahead.figures}["tracking_error_peak"] < 0.4 * error


def test_the_loops_are_designed_around_what_a_controller_can(drive):
    """A moteus has its current loop at a thirtieth of its rate at most; an ODrive's estimator lags by half a ms."""
    made = commissioned(read("position: {}"), drive, devices()["moteus"])
    assert read_back(made.rows)["K_i"] <= 2.0 * math.pi * 1000.0 * drive.motor.inductance / 2.0
    made = commissioned(read("position: {}"), drive, devices()["odrive-0.5"])
    assert made.exact.gains.counted_over * made.exact.gains.velocity_period >= 1e-3
    assert made.exact.gains.feedforward_friction == 0.0 < made.exact.gains.feedforward_acceleration
    made = commissioned(read("rate: 2 kHz, speed_from: exact"), drive, devices()["simplefoc"])
    assert made.rounded.gains.velocity_period == pytest.approx(5e-4)
    limit = next(row for row in made.rows if row.parameter.name == "MLC")
    assert made.rounded.drive_set.controller.peak_current == pytest.approx(limit.value * math.sqrt(3.0) / 2.0)


def test_a_loop_that_responds_within_its_sample_has_the_phase_of_a_period_more(drive):
    proof = commissioned(read("speed_from: exact"), drive, devices()["vesc"]).exact
    train = drive_train(proof.spec, drive, 1e-4)[0]
    slow = replace(proof.gains, velocity_kp=proof.gains.velocity_kp / 4.0, velocity_ki=proof.gains.velocity_ki / 16.0)
    soon, late = (analyse(train, replace(slow, computing=n)).velocity for n in (0, 1))
    assert proof.gains.computing == 0 and soon.crossover == pytest.approx(late.crossover, rel=1e-6)
    more = TURN * soon.crossover * proof.gains.velocity_period
    assert soon.phase_margin - late.phase_margin == pytest.approx(more, rel=1e-5)
