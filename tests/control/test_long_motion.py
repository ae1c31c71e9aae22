"""Motions of hours that never repeat: a slower current loop against a full simulation, and SciPy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from engine_tasks import MOTOR, SERVO, figure, machine
from scipy.integrate import solve_ivp

from drivesizer.control.closed_loop import slower
from drivesizer.control.engine import CurrentLimit, Drive, MotorHeat, Supply, Task, simulate

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
@pytest.mark.parametrize("edges", [0, 2000], ids=["exact", "counted"])
def test_a_slower_current_loop_is_near_the_full_simulation(edges):
    drive = replace(DRIVE, edges=edges, controller=replace(SERVO, counted_over=4))
    full, found = simulate(drive, TASK, rows=0), simulate(slower(drive), TASK, rows=0)
    assert figure(found, "steps") < 0.15 * figure(full, "steps")
    for name in (*PEAKS, "rms_current", "rms_gear_torque_running"):
        near = 0.2 if edges and name in PEAKS else 0.05
        assert figure(found, name) == pytest.approx(figure(full, name), rel=near), name
    for name in ("winding", "housing"):
        assert figure(found, name) - 298.15 == pytest.approx(figure(full, name) - 298.15, rel=0.01)


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
    out = simulate(slower(DRIVE), TASK, rows=0)
    assert np.array([figure(out, "winding"), figure(out, "housing")]) - 298.15 == pytest.approx(rises, rel=0.01)
    assert rises.min() > 3.0
