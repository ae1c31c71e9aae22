"""The engine of the closed loop: closed forms, an independent integrator, energy, batches, cycles."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from engine_tasks import FAR, MOTOR, PERIOD, SERVO, figure, gains, machine, open_drive

from drivesizer.control.drive_train import columns, discretised, generators
from drivesizer.control.engine import CurrentLimit, Drive, MotorHeat, Supply, Task, simulate
from drivesizer.kernel.warming import State, steady_state

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


# --- heat


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
