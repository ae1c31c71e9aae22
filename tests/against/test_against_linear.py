"""The simulation against python-control: the linear loop where no limit is met, and the continuous loop in the limit.

Rigid and with a shaft, driving and braking, each in one mode of the machine throughout.
"""

from __future__ import annotations

import math
from dataclasses import replace

import control
import numpy as np
import pytest
from linear_machines import both_ways, machine, one_mode, servo, shafts
from textbook_machine import PERIOD, on_slope, slower, task_of

from drivesizer.control.drive_train import Regime, modes
from drivesizer.control.engine import Drive, Supply, Task, simulate
from drivesizer.control.gains import design
from drivesizer.control.loop_design import (
    dc_motor,
    from_error,
    position_open_loop,
    velocity_open_loop,
    voltage_open_loop,
)
from drivesizer.control.validation import Gains

FREE = Supply(voltage=math.inf)
BUMP = (0.0, 0.0204, 0.08, 0.14, 0.3), (1.0, 1.0, 1.02, 0.99, 0.99)  # s, m/s


# --- the voltage PID


def textbook(train, regime):
    """Voltage to current and motor speed of the rigid machine, from textbook and inertia."""
    share = (1.0 / train.efficiency if regime == Regime.FORWARD_DRIVING else train.efficiency) / train.ratio
    J, k = train.motor_inertia + train.load_inertia * share / train.ratio, train.torque_constant
    A = [[-train.resistance / train.inductance, -k / train.inductance], [k / J, -train.viscous / J]]
    return control.ss(A, [[1.0 / train.inductance], [0.0]], np.eye(2), np.zeros((2, 1)))


def pid_of(g):
    """The sampled controller, error to voltage of the sample after."""
    T, lag = g.period, g.filter_time + g.period
    late, whole = control.tf([1], [1, 0], T), control.tf([g.kp], [1], T)
    integral = control.tf([g.ki * T, 0], [1, -1], T)
    return late * (whole + integral + control.tf([g.kd, -g.kd], [lag, -g.filter_time], T))


@shafts
@both_ways
@pytest.mark.parametrize("kd", [0.0, 1e-3])
def test_the_voltage_pid_is_the_linear_loop(spec, catalog, shaft, degrees, regime, kd):
    hilly, train = on_slope(spec, catalog, degrees)
    g = design(hilly, train, PERIOD)
    g = replace(slower(g) if shaft else g, kd=kd / 20.0 if shaft else kd, filter_time=2e-3 if kd else 0.0)
    run = simulate(Drive(train=machine(train, shaft), controller=g, supply=FREE), task_of(train, *BUMP))
    assert one_mode(run, regime)
    when = np.arange(750) * PERIOD
    change = (np.interp(when, *BUMP) - 1.0) * train.motor_per_speed
    mode = modes(train)[regime]
    moved = (dc_motor(machine(train, shaft), mode) if shaft else textbook(train, regime))[1, 0].sample(PERIOD, "zoh")
    pid = control.ss(pid_of(g))
    speed, volts = (
        control.forced_response(system, when, change).outputs
        for system in (control.feedback(moved * pid, 1), control.feedback(pid, moved))
    )
    s = {name: column[:-1] for name, column in run.series.items()}  # the last row is the end, after all samples
    n = np.rint(s["time"] / PERIOD).astype(int)  # a steady stretch leaves samples out
    assert len(n) > 300
    assert s["motor_speed"] - s["motor_speed"][0] == pytest.approx(speed[n], abs=1e-8)  # rad/s of 8
    assert s["voltage"] - s["voltage"][0] == pytest.approx(volts[n], abs=1e-8)  # V
    if not shaft:
        opened = from_error(voltage_open_loop(train, mode, g))[1, 0]
        told = control.forced_response(control.feedback(opened, 1), when, change).outputs
        assert told == pytest.approx(speed, abs=1e-8)


# --- the cascade


def lifted(fast, steps):
    """A sampled system under an input that is held over some steps, at those steps."""
    power = [np.linalg.matrix_power(fast.A, n) for n in range(steps + 1)]
    return control.ss(power[-1], sum(power[:-1]) @ fast.B, fast.C, fast.D, fast.dt * steps)


def late(period):
    return control.ss(control.tf([1.0], [1.0, 0.0], period))


def sampled_pid(kp, ki, period, kd=0.0, filter_time=0.0):
    """Backward Euler: kp + ki h z/(z - 1) + kd (z - 1) / ((T_f + h) z - T_f)."""
    found = control.ss(control.tf([kp + ki * period, -kp], [1.0, -1.0], period))
    return found + control.ss(control.tf([kd, -kd], [filter_time + period, -filter_time], period)) if kd else found


def outer_loops(train, mode, c, shaft):
    """The open loops of velocity and position around the current loop; each computes for one of its periods."""
    inner = late(c.current_period) * sampled_pid(c.current_kp, c.current_ki, c.current_period)
    forward = dc_motor(machine(train, shaft), mode, angle=True)[[0, 1, 4], 0].sample(c.current_period, "zoh") * inner
    current, speed = (control.ss([], [], [], [row], forward.dt) for row in ([1, 0, 0], [0, 1, 0]))
    closed = lifted(control.feedback(forward, current), c.current_steps)
    pid = sampled_pid(c.velocity_kp, c.velocity_ki, c.velocity_period, c.velocity_kd, c.filter_time)
    opened = closed * late(closed.dt) * pid
    speed.dt = opened.dt
    found = {"velocity": opened[1, 0]}
    if c.velocity_steps:
        closed = lifted(control.feedback(opened, speed), c.velocity_steps)[2, 0]
        found["position"] = closed * late(closed.dt) * c.position_kp
    return found


@shafts
@both_ways
def test_the_loops_of_the_design_compute_for_a_period_each(spec, catalog, shaft, degrees, regime):
    """What ``loop_plant`` analyses is the cascade put together here, each loop one of its own periods late."""
    _, train = on_slope(spec, catalog, degrees)
    mode, c = modes(train)[regime], servo(train, shaft)
    found = outer_loops(train, mode, c, shaft)
    for name, told in (("velocity", velocity_open_loop), ("position", position_open_loop)):
        L = from_error(told(machine(train, shaft), mode, c))[1, 0]
        z = np.exp(1j * np.geomspace(1.0, math.pi / L.dt, 50) * L.dt)
        assert found[name](z) == pytest.approx(L(z), rel=1e-6)


@shafts
@both_ways
def test_the_velocity_loop_of_the_cascade_is_the_linear_loop(spec, catalog, shaft, degrees, regime):
    _, train = on_slope(spec, catalog, degrees)
    c = servo(train, shaft, position_kp=0.0, position_period=0.0)
    run = simulate(Drive(train=machine(train, shaft), controller=c, supply=FREE), task_of(train, *BUMP))
    assert one_mode(run, regime)
    when = np.arange(750) * c.velocity_period
    change = (np.interp(when, *BUMP) - 1.0) * train.motor_per_speed
    closed = control.feedback(outer_loops(train, modes(train)[regime], c, shaft)["velocity"], 1)
    speed = control.forced_response(closed, when, change).outputs
    s = {name: column[:-1] for name, column in run.series.items()}  # the last row is the end, after all samples
    n = np.rint(s["time"] / c.current_period).astype(int)
    at = n % c.current_steps == 0
    assert at.sum() > 300
    assert s["motor_speed"][at] - s["motor_speed"][0] == pytest.approx(speed[n[at] // c.current_steps], abs=1e-8)


@shafts
@both_ways
def test_the_position_loop_of_the_cascade_is_the_linear_loop(spec, catalog, shaft, degrees, regime):
    """The reference leaps by 0.02 rad between two samples of the velocity loop, which does not see its speed."""
    _, train = on_slope(spec, catalog, degrees)
    c = servo(train, shaft)
    cruise, T = 400.0, c.position_period
    t = 10 * T + np.array([0.1, 0.5, 0.9]) * c.velocity_period
    leap, top = 0.02, cruise + 2.0 * 0.02 / (t[2] - t[0])
    task = Task(time=(0.0, *t, 0.24), speed=tuple(w / train.ratio for w in (cruise, cruise, top, cruise, cruise)))
    run = simulate(Drive(train=machine(train, shaft), controller=c, supply=FREE), task)
    assert one_mode(run, regime)
    closed = control.feedback(outer_loops(train, modes(train)[regime], c, shaft)["position"], 1)
    when = np.arange(200) * T
    expected = control.forced_response(closed, when, leap * (when > 10.5 * T)).outputs
    s = {name: column[:-1] for name, column in run.series.items()}  # the last row is the end, after all samples
    n = np.rint(s["time"] / c.current_period).astype(int)
    at = n % (c.current_steps * c.velocity_steps) == 0
    turned = leap * (s["time"] > 10.5 * T) - s["position_error"]
    assert at.sum() > 100 and expected[-1] > 0.4 * leap
    assert turned[at] == pytest.approx(expected[n[at] // (c.current_steps * c.velocity_steps)], abs=1e-10)  # rad


# --- ever shorter periods


def continuous(train, regime, c):
    """The speed's answer to its reference in continuous time; the reference's angle is its integral."""
    moved = textbook(train, regime)
    if isinstance(c, Gains):
        return control.feedback(moved[1, 0] * pi(c.kp, c.ki), 1)
    inner = control.feedback(moved * pi(c.current_kp, c.current_ki), control.ss([], [], [], [[1.0, 0.0]]))[1, 0]
    return control.feedback(inner * pi(c.velocity_kp, c.velocity_ki) * pi(1.0, c.position_kp), 1)


def pi(kp, ki):
    return control.ss([[0.0]], [[1.0]], [[ki]], [[kp]])
