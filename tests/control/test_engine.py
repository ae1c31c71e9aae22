"""The engine of the closed loop: closed forms, an independent integrator, energy, batches, cycles."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from engine_tasks import FAR, MOTOR, PERIOD, SERVO, figure, gains, machine, open_drive
from scipy.integrate import solve_ivp

from drivesizer.control.drive_train import columns, discretised, generators
from drivesizer.control.engine import (
    CurrentLimit,
    Drive,
    MotorHeat,
    Supply,
    Task,
    simulate,
)
from drivesizer.physics.two_bodies import State, steady_state

# --- the modes and the machine


@pytest.mark.parametrize("more", [{}, {"stiffness": 900.0, "damping": 0.4, "gap": 1e-3, "viscous": 1e-6}])
def test_modes_are_the_matrix_exponential(more):
    from scipy.linalg import expm

    table = columns([machine(**more)])
    R, period = np.array([[2.32]]), np.array([PERIOD])
    G, found = generators(table, R), discretised(table, R, period)
    states = found.shape[-1] - 4
    for mode in range(G.shape[2]):
        for level, share in ((0, 1024), (5, 32), (10, 1)):
            exact = expm(G[0, 0, mode] * PERIOD / share)[: states + 2]
            exact = np.delete(exact, [states, states + 1], axis=1)
            assert found[0, 0, mode, level] == pytest.approx(exact, rel=1e-9, abs=1e-12 * np.abs(exact).max())


def test_speed_at_a_held_voltage_rises_like_first_order():
    m = machine(inductance=1e-9, load_inertia=8e-3)
    J = m.motor_inertia + m.load_inertia / (m.ratio**2 * m.efficiency)
    tau, k = m.resistance * J / (m.torque_constant * m.back_emf_constant), m.back_emf_constant
    run = simulate(open_drive(m, 10.0), replace(FAR, time=(0.0, 1e-3, 1.5)))
    t, w = run.series["time"], run.series["motor_speed"]
    late = (t > 0.01) & (run.series["voltage"] == 10.0)
    started = t[np.flatnonzero(run.series["voltage"] == 10.0)[0]]
    expected = 10.0 / k * -np.expm1(-(t[late] - started) / tau)
    assert w[late] == pytest.approx(expected, abs=1e-3)  # rad/s of 427
    assert 2.0 * tau < 1.5


def test_torsional_resonance():
    m = machine(stiffness=40.0, resistance=1e7, inductance=1.0, load_inertia=3e-4, forward_torque=0.5)
    drive = Drive(train=m, controller=gains(ki=1e-12, period=1e-4), supply=Supply(voltage=1e12))
    # behind such a resistance the current stays; the load's torque steps a little while
    # the shaft stays loaded in one direction: a free oscillation about the new load
    task = Task(time=(0.0, 0.05), speed=(900.0, 900.0), load_time=(0.0, 1e-4, 0.05), load_torque=(0.0, 0.05, 0.05))
    run = simulate(drive, task)
    relative = run.series["motor_speed"] / m.ratio - run.series["load_speed"]
    t = run.series["time"]
    up = np.flatnonzero((relative[:-1] < 0.0) & (relative[1:] >= 0.0))
    at = t[up] - relative[up] * (t[up + 1] - t[up]) / (relative[up + 1] - relative[up])
    seen = m.motor_inertia * m.ratio**2 * m.efficiency  # the motor's inertia behind the gears, power forward
    expected = math.sqrt(m.stiffness * (1.0 / seen + 1.0 / m.load_inertia)) / (2 * math.pi)
    assert len(at) > 3
    assert (len(at) - 1) / (at[-1] - at[0]) == pytest.approx(expected, rel=2e-4)


def test_coasting_stops_when_friction_has_taken_the_speed():
    m = machine(resistance=1e7, inductance=1.0, friction=5e-3, forward_torque=0.05, backward_torque=-0.05)
    run = simulate(
        Drive(train=m, controller=gains(), supply=Supply(voltage=1e-6)), Task(time=(0.0, 0.5), speed=(40.0, 40.0))
    )
    # braking throughout: the load's inertia pushes back through the gears
    share = m.efficiency / m.ratio
    J = m.motor_inertia + m.load_inertia * share / m.ratio
    when = 40.0 * m.ratio * J / (5e-3 + 0.05 * share)
    w, t = run.series["motor_speed"], run.series["time"]
    first = t[np.flatnonzero(w == 0.0)[0]]
    assert first - 1.01 * PERIOD <= when <= first
    assert not w[t >= first].any()
    assert figure(run, "angle") == pytest.approx(0.5 * 40.0 * m.ratio * when, rel=1e-4)


# --- heat


def test_heat_of_a_locked_rotor_against_an_integrator():
    m = machine(friction=1.0, inductance=1e-4)
    heat = MotorHeat(bodies=MOTOR, ambient=303.15, winding=320.0, housing=310.0)
    run = simulate(open_drive(m, 6.0, heat=heat), Task(time=(0.0, 1e-3, 30.0), speed=(0.0, 1e4, 1e4)))

    def rate(_, x):
        R = 2.32 * (1 + 0.0039 * (x[0] - 298.15))
        across = (x[0] - x[1]) / 3.1
        return (36.0 / R - across) / (12.4 / 3.1), (across - (x[1] - 303.15) / 14.0) / (612.0 / 14.0)

    exact = solve_ivp(rate, (0.0, 30.0), (320.0, 310.0), rtol=1e-11, atol=1e-9).y[:, -1]
    assert (figure(run, "winding"), figure(run, "housing")) == pytest.approx(tuple(exact), abs=5e-3)  # K


def test_a_day_at_one_speed_is_carried_to_the_steady_temperature():
    m = machine(friction=0.02)
    heat = MotorHeat(bodies=MOTOR, ambient=298.15, loss_torque=1e-3)
    drive = Drive(train=m, controller=gains(kp=0.02, ki=0.5), supply=Supply(voltage=24.0), heat=heat)
    run = simulate(drive, Task(time=(0.0, 86400.0), speed=(20.0, 20.0)))
    settled = steady_state(MOTOR, 298.15, 0.02 / 0.0234, 1e-3 * 20.0 * 9.1)
    assert State(figure(run, "winding"), figure(run, "housing")) == pytest.approx(settled, abs=1e-2)
    assert figure(run, "steps") < 2e6


# --- energy, periods, limits


def test_bus_sags_by_its_resistance():
    m = machine(friction=1.0, inductance=5e-3)
    supply = Supply(voltage=24.0, resistance=0.3, sets=4, max_duty=0.9, voltage_drop=1.0)
    run = simulate(replace(open_drive(m, 1.0), supply=supply), FAR)
    u, i = run.series["voltage"][-1], run.series["current"][-1]
    bus = u / 0.9 + 1.0
    assert i == pytest.approx(u / 2.32, rel=1e-6)  # the rotor is locked
    assert bus == pytest.approx(24.0 - 0.3 * 4 * u * i / bus, rel=1e-6)
    # meanwhile the current grows within a period, which the limit does not see
    assert figure(run, "bus_lowest") == pytest.approx(bus, rel=0.02)


def test_peak_current_for_its_time_then_the_continuous():
    m = machine(friction=1.0)
    limit = CurrentLimit(peak=4.0, continuous=1.5, peak_time=0.5)
    drive = Drive(train=m, controller=SERVO, supply=Supply(voltage=24.0), current=limit)
    run = simulate(drive, FAR)
    i, t = run.series["current"], run.series["time"]
    assert i[(t > 0.01) & (t < 0.49)] == pytest.approx(4.0, abs=1e-3)
    assert i[t > 0.53] == pytest.approx(1.5, abs=1e-3)
    assert figure(run, "i2t_share") == pytest.approx(1.0, abs=2e-3)


def test_cascade_follows_in_speed_and_angle():
    m = machine(friction=1e-3, forward_torque=0.1, backward_torque=-0.1)
    task = Task(time=(0.0, 0.4, 1.2, 1.6, 2.6), speed=(0.0, 40.0, 40.0, 0.0, 0.0))
    drive = Drive(train=m, controller=SERVO, supply=Supply(voltage=24.0), current=CurrentLimit(peak=6.0))
    run = simulate(drive, task)
    cruise = np.searchsorted(run.series["time"], 1.19)
    assert run.series["motor_speed"][cruise] == pytest.approx(40.0 * m.ratio, rel=1e-6)
    assert figure(run, "angle") == pytest.approx(48.0 * m.ratio, rel=1e-3)
    counted = simulate(replace(drive, edges=2000, controller=replace(SERVO, counted_over=4)), task)
    assert figure(counted, "rms_current") == pytest.approx(figure(run, "rms_current"), rel=0.05)
    assert np.abs(counted.series["position_error"][-1]) < 0.2  # rad at the motor; an edge is 3 mrad


# --- backlash


def test_a_gap_is_crossed_without_torque():
    m = machine(stiffness=200.0, damping=0.2, gap=0.02, friction=5e-4)
    run = simulate(Drive(train=m, controller=gains(kp=0.02), supply=Supply(voltage=24.0)),
                Task(time=(0.0, 0.2, 0.4), speed=(0.0, 20.0, -20.0)))  # fmt: skip
    free = run.series["gear_torque"] == 0.0
    assert free[1:].any() and not free.all()
    twist = figure(run, "angle") / m.ratio - figure(run, "load_angle")
    assert abs(twist) == pytest.approx(0.01, abs=2e-3)


# --- many, long, wrong


def test_unstable_gains_come_to_an_end():
    wild = Drive(train=machine(), controller=gains(kp=1e5, ki=1e7), supply=Supply(voltage=math.inf))
    run = simulate(wild, FAR)
    assert "unstable" in run.problems[0]
    few = simulate(open_drive(machine(), 12.0), FAR, most_steps=100)
    assert "steps" in few.problems[0] and figure(few, "steps") <= 101 + 2048
