"""Motions of hours that never repeat: slower current loop with windows against a full simulation, and SciPy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from engine_tasks import MOTOR, SERVO, figure, machine
from scipy.integrate import solve_ivp

from drivesizer.control.closed_loop.run import simulate_long
from drivesizer.control.engine import CurrentLimit, Drive, MotorHeat, Resolution, Supply, Task, simulate

SET = machine(friction=1e-3, forward_torque=0.15, backward_torque=-0.15, load_inertia=1e-5)
DRIVE = Drive(
    train=SET, controller=SERVO, supply=Supply(voltage=24.0), current=CurrentLimit(peak=6.0),
    heat=MotorHeat(bodies=MOTOR, ambient=298.15),
)  # fmt: skip
TIME = np.arange(601.0)  # s: ten minutes at 1 Hz, never at rest
SPEED = 25.0 + 10.0 * np.sin(np.cumsum(np.random.default_rng(3).uniform(0.0, 2.0, 601)))
TASK = Task(time=TIME, speed=SPEED)
PEAKS = (
    "current", "voltage_demand", "current_demand", "speed", "speed_error", "load_angle_error", "gear_torque", "power"
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("encoder", [Resolution(), Resolution(edges=2000, periods=4)], ids=["exact", "counted"])
def test_a_slower_current_loop_and_its_windows_bound_the_full_simulation(encoder):
    drive = replace(DRIVE, encoder=encoder)
    full, found = simulate(drive, TASK, rows=0), simulate_long(drive, TASK, 2000)
    assert figure(found.out, "steps") < 0.15 * figure(full, "steps")
    watched = sum(b - a for a, b in found.windows)
    assert len(found.windows) > 5 and watched < 60.0
    for name in (*PEAKS, "rms_current", "rms_gear_torque_running"):
        reported, whole = figure(found.out, name), figure(full, name)
        assert reported == pytest.approx(whole, rel=0.08 if encoder.edges else 0.02), name
        assert reported * found.allowed[name] >= whole * (1 - 1e-3), name
        assert 1.0 <= found.allowed[name] < 1.25, name
    for name in ("winding", "housing"):
        assert figure(found.out, name) - 298.15 == pytest.approx(figure(full, name) - 298.15, rel=0.01)


def test_the_winding_of_a_long_motion_is_as_warm_as_a_solver_has_it():
    """Currents by hand: i = (J_M a + F + (T + J_L a/K)/(K e))/k, the gears driving all the time."""
    slopes = np.diff(SPEED) * SET.ratio
    torque = 0.15 + SET.load_inertia * slopes / SET.ratio
    assert torque.min() > 0.0 and SPEED.min() > 10.0
    i = (SET.motor_inertia * slopes + 1e-3 + torque / (SET.ratio * SET.efficiency)) / SET.torque_constant

    def rate(t, x):
        across, now = (x[0] - x[1]) / MOTOR.R_th1, i[min(int(t), 599)]
        copper = MOTOR.R_25 * (1 + 0.0039 * x[0]) * now * now
        return (copper - across) / MOTOR.capacity_w, (across - x[1] / MOTOR.R_th2) / MOTOR.capacity_h

    rises = solve_ivp(rate, (0.0, 600.0), (0.0, 0.0), "RK45", max_step=0.5, rtol=1e-6).y[:, -1]
    out = simulate_long(DRIVE, TASK, 2000).out
    assert np.array([figure(out, "winding"), figure(out, "housing")]) - 298.15 == pytest.approx(rises, rel=0.01)
    assert rises.min() > 3.0


def test_cycles_of_a_long_motion_have_their_windows_in_the_first():
    task = replace(TASK, time=TIME[:31], speed=(*SPEED[:30], SPEED[0]), cycles=3)
    full, found = simulate(DRIVE, task, rows=0), simulate_long(DRIVE, task, 2000)
    assert found.windows[-1][1] <= 30.0 and len(found.windows) > 2
    for name in PEAKS:
        assert figure(found.out, name) * found.allowed[name] >= figure(full, name) * (1 - 1e-3), name


def test_what_comes_before_a_part_is_watched_is_not_seen():
    """A jump at the start demands much; from a second later on the drive is steady."""
    task = Task(time=(0.0, 0.02, 3.0), speed=(0.0, 30.0, 30.0))
    whole, later = simulate(DRIVE, task), simulate(DRIVE, replace(task, since=1.0))
    assert figure(whole, "speed_error") > 10.0
    assert figure(later, "speed_error") < 1e-3
    assert figure(later, "time") == pytest.approx(2.0)
    steady = (1e-3 + 0.15 / (SET.ratio * SET.efficiency)) / SET.torque_constant
    assert figure(later, "current") == pytest.approx(steady, rel=1e-3)
