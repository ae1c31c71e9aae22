"""Missions of hours: what is added of cycles and long stretches against all of it simulated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from engine_tasks import MOTOR, SERVO, figure, machine

from drivesizer.control import engine
from drivesizer.control.engine import CurrentLimit, Drive, MotorHeat, Supply, Task, simulate
from drivesizer.kernel.warming import State, steady_state

SET = machine(friction=1e-3, forward_torque=0.3, backward_torque=-0.3)
HEAT = MotorHeat(bodies=MOTOR, ambient=298.15, loss_torque=1e-3, loss_viscous=1e-6)
COUNTED = Drive(
    train=SET, controller=replace(SERVO, counted_over=4), supply=Supply(voltage=24.0), current=CurrentLimit(peak=6.0),
    edges=2000, heat=HEAT,
)  # fmt: skip
CYCLE = Task(time=(0.0, 0.1, 0.5, 0.6, 2.0), speed=(0.0, 30.0, 30.0, 0.0, 0.0), cycles=120)
MET = ("time", "rms_current", "energy_in", "copper_heat", "rms_gear_torque_running")


def all_simulated(monkeypatch, drive, task):
    """The same with nothing alike."""
    with monkeypatch.context() as patch:
        for name in ("_PERIODIC", "_PERIODIC_WARM", "_ALIKE"):
            patch.setattr(engine, name, -1.0)
        return simulate(drive, task, rows=0, most_steps=10**9)


@pytest.mark.parametrize("change", [
    {},
    {"heat": None},
    {"edges": 0},
    {"train": replace(SET, stiffness=60.0, damping=0.05, gap=4e-3)},
    {"edges": 256},
], ids=["counted and heated", "counted", "heated", "backlash", "few edges"])  # fmt: skip
def test_cycles_that_are_alike_are_added(change, monkeypatch):
    drive = replace(COUNTED, **change)
    added, simulated = simulate(drive, CYCLE), all_simulated(monkeypatch, drive, CYCLE)
    assert figure(added, "steps") < 0.4 * figure(simulated, "steps")
    for name in MET:
        assert figure(added, name) == pytest.approx(figure(simulated, name), rel=5e-3), name
    assert figure(added, "angle") == pytest.approx(figure(simulated, "angle"), abs=0.5)  # rad at the motor of 15 000
    if drive.heat:
        for name in ("winding", "winding_highest", "housing"):
            rise = figure(simulated, name) - 298.15
            assert rise > 10.0
            assert figure(added, name) - 298.15 == pytest.approx(rise, rel=5e-3)


@pytest.mark.parametrize("change", [{}, {"edges": 0, "heat": None}], ids=["counted", "cold"])
def test_the_current_s_integral_grows_through_cycles_that_are_added(change, monkeypatch):
    limit = CurrentLimit(peak=6.0, continuous=1.2, peak_time=30.0)
    drive = replace(COUNTED, current=limit, **change)
    added, simulated = simulate(drive, CYCLE), all_simulated(monkeypatch, drive, CYCLE)
    square = figure(simulated, "rms_current") ** 2
    assert figure(simulated, "time_at_current_limit") == 0.0
    rises = (square - 1.2**2) * figure(simulated, "time")  # it never comes to zero meanwhile
    assert rises > 300.0
    assert figure(simulated, "i2t_highest") > rises
    assert figure(added, "i2t_highest") == pytest.approx(figure(simulated, "i2t_highest"), rel=5e-3)
    assert figure(added, "steps") < 0.4 * figure(simulated, "steps")


@pytest.mark.parametrize("edges", [0, 2000], ids=["exact", "counted"])
def test_a_mission_with_long_stretches(edges):
    """80 min at cruise, four times: the current of each stretch is known, and the temperatures it settles at."""
    drive = replace(COUNTED, edges=edges, train=replace(SET, forward_torque=0.15, backward_torque=-0.15))
    run = simulate(drive, Task(time=(0.0, 1.0, 4801.0, 4802.0), speed=(0.0, 40.0, 40.0, 0.0), cycles=4))
    w = 40.0 * SET.ratio
    i = (1e-3 + 0.15 / (SET.ratio * SET.efficiency)) / SET.torque_constant
    assert figure(run, "time") == pytest.approx(4 * 4802.0, rel=1e-6)
    assert figure(run, "rms_current") == pytest.approx(i, rel=5e-3)
    assert figure(run, "angle") == pytest.approx(4 * 4801.0 * w, rel=1e-6)
    settled = steady_state(MOTOR, 298.15, i, 1e-3 * w + 1e-6 * w**2)
    reached = State(figure(run, "winding_highest"), figure(run, "housing_highest"))
    assert np.subtract(reached, 298.15) == pytest.approx(np.subtract(settled, 298.15), rel=5e-3)
    work = (SET.back_emf_constant * w * i + (figure(run, "copper_heat") / figure(run, "time"))) * figure(run, "time")
    assert figure(run, "energy_in") == pytest.approx(work, rel=5e-3)
    assert figure(run, "steps") < 0.01 * figure(run, "time") / SERVO.current_period


def test_a_counted_drive_at_rest_within_its_count_is_carried():
    run = simulate(COUNTED, Task(time=(0.0, 0.5, 1.0, 3601.0), speed=(0.0, 30.0, 0.0, 0.0)))
    assert figure(run, "steps") < 0.01 * 3601.0 / SERVO.current_period
    assert run.series["motor_speed"][-1] == 0.0
