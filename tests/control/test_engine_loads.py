"""The engine under loads that change, returned energy, friction at the load, backlash, heat of the housing."""

from __future__ import annotations

import math

import numpy as np
import pytest
from engine_tasks import MOTOR, PERIOD, figure, gains, machine, saturated_by_solver

from drivesizer.control.engine import Drive, MotorHeat, Supply, Task, simulate
from drivesizer.kernel.warming import State, steady_state
from drivesizer.physics.thermal import TwoBodies

# --- regenerated energy


def pulled(supply, **more):
    """A set that its load pulls at a constant speed, and the current that holds it."""
    m = machine(friction=1e-3)
    drive = Drive(train=m, controller=gains(kp=0.02, ki=0.5), supply=supply)
    task = Task(**({"time": (0.0, 2.0), "speed": (40.0, 40.0)} | more), load_time=(0.0,), load_torque=(-0.6,))
    return simulate(drive, task), (1e-3 - 0.6 * 0.72 / 9.1) / 0.0234


def test_a_chopper_takes_returned_energy():
    run, i = pulled(Supply(voltage=24.0, resistance=0.3, sets=4))
    power = 4 * (2.32 * i + 0.026 * 40.0 * 9.1) * i  # the voltage rests on k_e, the current on k_t
    assert power < -25.0
    assert figure(run, "bus_lowest") == pytest.approx(24.0, rel=1e-9)
    assert figure(run, "energy_returned") == pytest.approx(-power / 4 * 2.0, rel=1e-9)
    assert figure(run, "energy_in") == figure(run, "bus_current") == 0.0


def test_a_bus_that_a_chopper_keeps_leaves_its_whole_voltage():
    supply = Supply(voltage=24.0, resistance=0.5, sets=4, max_duty=0.9, voltage_drop=1.0)
    run, i = pulled(supply, time=(0.0, 1e-3, 3.0), speed=(40.0, 1e4, 1e4))
    assert run.series["voltage"][-1] == pytest.approx(0.9 * (24.0 - 1.0), rel=1e-6)
    assert run.series["motor_speed"][-1] == pytest.approx((0.9 * (24.0 - 1.0) - 2.32 * i) / 0.026, rel=1e-6)


# --- loads


@pytest.mark.parametrize("more", [{}, {"stiffness": 30.0, "damping": 0.02}])
def test_a_load_with_corners_in_a_saturated_loop_against_an_integrator(more):
    m, g = machine(friction=1e-3, forward_torque=0.1, backward_torque=-0.1, **more), gains(kp=0.04, ki=0.6)
    corners = tuple(PERIOD * n for n in (250, 500, 625, 1125, 1375))  # at samples: the engine has no others
    task = Task(
        time=(0.0, 0.1, 0.4, 0.5, 0.6), speed=(10.0, 10.0, 60.0, 20.0, 20.0), load_time=corners,
        load_torque=(0.05, 0.25, -0.05, 0.1, 0.3),
    )  # fmt: skip
    run = simulate(Drive(train=m, controller=g, supply=Supply(voltage=11.0)), task)
    exact = saturated_by_solver(m, g, 11.0, task, 1500)
    n = np.rint(run.series["time"][:-1] / PERIOD).astype(int)
    assert figure(run, "time_at_voltage_limit") > 0.05
    assert run.series["motor_speed"][:-1] == pytest.approx(exact[n, 1], abs=2e-3)  # rad/s of 546
    assert run.series["current"][:-1] == pytest.approx(exact[n, 0], abs=2e-4)  # A of 4


@pytest.mark.parametrize("when", [250 * PERIOD, 250.3 * PERIOD, 0.1, 7 * PERIOD])
def test_a_jump_of_the_load_takes_effect_at_the_next_sample(when):
    m = machine(resistance=1e7, inductance=1.0)  # no current: it coasts
    task = Task(
        time=(0.0, 0.2), speed=(40.0, 40.0), load_time=(when, math.nextafter(when, 1.0)), load_torque=(0.0, 0.1)
    )
    run = simulate(Drive(train=m, controller=gains(), supply=Supply(voltage=1e-6)), task)
    share = 1.0 / (m.ratio * m.efficiency)
    slows = 0.1 * share / (m.motor_inertia + m.load_inertia * share / m.ratio)
    sample = math.ceil(when / PERIOD - 1e-6) * PERIOD
    expected = 364.0 - slows * np.maximum(run.series["time"] - sample, 0.0)
    turning = expected > 10.0
    assert run.series["motor_speed"][turning] == pytest.approx(expected[turning], abs=1e-3)  # a sample is 0.8 rad/s
    assert expected.min() < 200.0


def test_a_load_of_many_corners_within_a_sample_keeps_its_size():
    """Pieces that are short beside a sample run to where the load is at the next one, never beyond."""
    m = machine(resistance=1e7, inductance=1.0)
    # a ramp within a hundredth of a period, with a sample in its middle
    mid = 100 * PERIOD
    task = Task(time=(0.0, 0.2), speed=(40.0, 40.0), load_time=(mid - 2e-6, mid + 2e-6), load_torque=(0.0, 0.1))
    run = simulate(Drive(train=m, controller=gains(), supply=Supply(voltage=1e-6)), task)
    share = 1.0 / (m.ratio * m.efficiency)
    slows = 0.1 * share / (m.motor_inertia + m.load_inertia * share / m.ratio)
    late = run.series["time"] > mid + PERIOD
    # half of it at the sample, all of it at the next: three quarters of it over that period
    expected = 364.0 - slows * (run.series["time"][late] - mid - PERIOD / 4)
    assert run.series["motor_speed"][late] == pytest.approx(expected, abs=1e-3)


# --- what the housing loses


def test_a_loss_that_grows_with_the_square_of_speed_settles_as_computed():
    m = machine(friction=0.02)
    heat = MotorHeat(bodies=MOTOR, ambient=298.15, loss_torque=1e-3, loss_viscous=5e-5)
    drive = Drive(train=m, controller=gains(kp=0.02, ki=0.5), supply=Supply(voltage=24.0), heat=heat)
    run = simulate(drive, Task(time=(0.0, 86400.0), speed=(20.0, 20.0)))
    w = 20.0 * m.ratio
    settled = steady_state(MOTOR, 298.15, 0.02 / 0.0234, 1e-3 * w + 5e-5 * w**2)
    assert 5e-5 * w**2 > 1.0
    assert State(figure(run, "winding"), figure(run, "housing")) == pytest.approx(settled, abs=1e-2)


def test_a_loss_by_the_square_of_speed_over_ramps():
    """All of the heat stays where nothing leads it away: copper's, and the integral of the speed's square."""
    kept = TwoBodies(R_25=2.32, R_th1=3.1, R_th2=1e9, tau_w=12.4, tau_h=612e8)
    heat = MotorHeat(bodies=kept, ambient=298.15, loss_viscous=5e-5)
    m = machine(friction=1e-3)
    drive = Drive(train=m, controller=gains(kp=0.02, ki=0.5), supply=Supply(voltage=24.0), heat=heat)
    run = simulate(drive, Task(time=(0.0, 0.5, 1.0, 1.5), speed=(0.0, 40.0, 40.0, -10.0)))
    w = run.series["motor_speed"]
    swept = PERIOD / 3.0 * np.sum(w[:-1] ** 2 + w[:-1] * w[1:] + w[1:] ** 2)
    stored = 12.4 / 3.1 * (figure(run, "winding") - 298.15) + 61.2 * (figure(run, "housing") - 298.15)
    assert stored == pytest.approx(figure(run, "copper_heat") + 5e-5 * swept, rel=2e-4)
    assert 5e-5 * swept > 0.1 * figure(run, "copper_heat")
