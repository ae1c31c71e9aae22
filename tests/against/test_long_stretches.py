"""Hours at one speed: the winding warms, asks for more voltage, and meets the bus on the way.

Held against SciPy's ``solve_ivp`` of winding and housing (two thermal resistances, two capacities) under the current
that the load asks for, i = T/(K e k), with copper loss R(T) i^2 and 0.39 %/K; voltage R(T) i + k w. What the bus does
not have of it is missing in speed, (R(T) i + k w - U)/k.
"""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from scipy.integrate import solve_ivp

from drivesizer.control.closed_loop.run import without_limits
from drivesizer.control.drive_train import DriveTrain
from drivesizer.control.engine import Drive, MotorHeat, Resolution, Supply, Task, simulate
from drivesizer.control.validation import Cascade, Gains
from drivesizer.physics.thermal import TwoBodies

R, K_T, RATIO, E, LOAD, SPEED = 2.32, 0.0234, 9.1, 0.72, 0.17, 30.0  # ohm, N*m/A, 1, 1, N*m, rad/s at the shaft
HOURS, BUS = 10 * 3600.0, 9.3  # s, V: enough for the cold winding, not for the warm one
MACHINE = DriveTrain(
    resistance=R, inductance=0.24e-3, torque_constant=K_T, back_emf_constant=K_T, motor_inertia=1.2e-6,
    gear_ratio=RATIO, gear_efficiency=E, load_inertia=4e-4, forward_torque=LOAD, backward_torque=-LOAD,
)  # fmt: skip
BODIES = TwoBodies(R_25=R, R_th1=3.1, R_th2=14.0, tau_w=12.4, tau_h=612.0)
PI = Gains(kp=0.01, ki=0.3, kd=0.0, filter_time=0.0, period=4e-4, rule="test", source="")
SERVO = Cascade(  # at the rates of an EPOS4
    current_kp=0.4, current_ki=4000.0, velocity_kp=0.02, velocity_ki=0.6, current_period=4e-5, velocity_period=4e-4
)


@pytest.fixture(scope="module")
def hot():
    """Rise of the winding at the end [K], and when it asks for more than the bus has [s]."""
    i, w = LOAD / (RATIO * E * K_T), SPEED * RATIO

    def rate(_, x):
        across = (x[0] - x[1]) / 3.1
        copper = R * (1 + 0.0039 * x[0]) * i * i
        return (copper - across) / BODIES.capacity_w, (across - x[1] / 14.0) / BODIES.capacity_h

    def cut(_, x):
        return R * (1 + 0.0039 * x[0]) * i + K_T * w - BUS

    found = solve_ivp(rate, (0.0, HOURS), (0.0, 0.0), "LSODA", events=cut, rtol=1e-9, atol=1e-9)
    rise = float(found.y[0, -1])
    return SimpleNamespace(rise=rise, since=float(found.t_events[0][0]), volts=R * (1 + 0.0039 * rise) * i + K_T * w)


@pytest.mark.parametrize("edges", [0, 2000], ids=["exact", "counted"])
@pytest.mark.parametrize("controller", [PI, SERVO], ids=["PI", "cascade"])
def test_ten_hours_at_one_speed(hot, controller, edges):
    drive = Drive(
        train=MACHINE, controller=controller, supply=Supply(voltage=BUS), encoder=Resolution(edges=edges, periods=5),
        heat=MotorHeat(bodies=BODIES, ambient=298.15),
    )  # fmt: skip
    task = Task(time=(0.0, 0.5, HOURS), speed=(SPEED,) * 3)
    run = simulate(drive, task, rows=0)
    told = {name: float(column[0]) for name, column in run.figures.items()}
    assert not run.problems[0] and told["steps"] < 20_000_000
    assert told["winding"] - 298.15 == pytest.approx(hot.rise, abs=0.05)
    # counts take up to the grain of their voltage, 10 mV of 600 mV, off the limit
    assert HOURS - told["time_at_voltage_limit"] == pytest.approx(hot.since, abs=60.0 if edges else 10.0)
    assert told["voltage"] <= BUS * (1 + 1e-5)
    assert told["speed_error"] == pytest.approx((hot.volts - BUS) / K_T, abs=0.02)  # rad/s, of 273
    takes = without_limits(drive, task, run, SimpleNamespace(all=()))
    assert takes.figures["voltage_demand"][0] == pytest.approx(hot.volts, abs=0.06 if edges else 1e-3)
    assert hot.volts - BUS > 0.25
