"""Machines, gains and tasks for the engine."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from drivesizer.control.drive_train import DriveTrain
from drivesizer.control.engine import Drive, Supply, Task
from drivesizer.control.validation import Cascade, Gains
from drivesizer.physics.thermal import TwoBodies

PERIOD = 4e-4

MOTOR = TwoBodies(R_25=2.32, R_th1=3.1, R_th2=14.0, tau_w=12.4, tau_h=612.0)


def machine(**figures):
    """A set with ratio and efficiencies far from 1."""
    given = {
        "resistance": 2.32, "inductance": 0.24e-3, "torque_constant": 0.0234, "back_emf_constant": 0.026,
        "motor_inertia": 1.2e-6, "gear_ratio": 7.0, "gear_efficiency": 0.72 / 0.9, "belt_ratio": 1.3,
        "belt_efficiency": 0.9, "load_inertia": 4e-4,
    }  # fmt: skip
    return DriveTrain(**(given | figures))


def gains(kp=0.0, ki=0.0, kd=0.0, filter_time=0.0, period=PERIOD):
    return Gains(kp=kp, ki=ki, kd=kd, filter_time=filter_time, period=period, rule="test", source="")


def open_drive(m, volts, **more):
    """A voltage that is held: with a gain beyond measure the PID stays at the limit."""
    return Drive(train=m, controller=gains(kp=1e6), supply=Supply(voltage=volts), **more)


FAR = Task(time=(0.0, 1e-3, 2.0), speed=(0.0, 1e4, 1e4))


def figure(simulated, name):
    return float(simulated.figures[name][0])


def saturated_by_solver(m, g, volts, task, n):
    """The sampled loop with each period integrated; current, speed (and twist, speed of the load) at the samples."""
    K, two = m.ratio, m.flexible
    w = task.speed[0] * K
    share = 1 / (K * m.efficiency)
    corners = (task.load_time, task.load_torque) if task.load_time else ((0.0,), (0.0,))

    def resists(t):
        return m.forward_torque + np.interp(t, *corners)

    i = (m.friction + resists(0.0) * share) / m.torque_constant
    x = np.array([i, w, resists(0.0) / m.stiffness, w / K] if two else [i, w])
    pending = integral = m.resistance * i + m.back_emf_constant * w

    def rigid(t, x, u):
        net = m.torque_constant * x[0] - m.friction
        drives = resists(t) * K * m.motor_inertia + m.load_inertia * net > 0.0
        s = 1 / (K * m.efficiency) if drives else m.efficiency / K
        dw = (net - resists(t) * s) / (m.motor_inertia + m.load_inertia * s / K)
        return (u - m.resistance * x[0] - m.back_emf_constant * x[1]) / m.inductance, dw

    def flexible(t, x, u):
        T = m.stiffness * x[2] + m.damping * (x[1] / K - x[3])
        s = 1 / (K * m.efficiency) if T > 0.0 else m.efficiency / K
        return (
            (u - m.resistance * x[0] - m.back_emf_constant * x[1]) / m.inductance,
            (m.torque_constant * x[0] - m.friction - s * T) / m.motor_inertia,
            x[1] / K - x[3],
            (T - resists(t)) / m.load_inertia,
        )

    found = []
    for k in range(n):
        error = K * np.interp(k * g.period, task.time, task.speed) - x[1]
        found.append(x.copy())
        u = min(max(pending, -volts), volts)
        if not (pending - u) * error > 0.0:
            integral += g.ki * g.period * error
        pending = g.kp * error + integral
        span = k * g.period, (k + 1) * g.period
        x = solve_ivp(flexible if two else rigid, span, x, "DOP853", args=(u,), rtol=1e-10, atol=1e-10).y[:, -1]
    return np.array(found)


SERVO = Cascade(
    current_kp=0.5, current_ki=3e3, velocity_kp=0.02, velocity_ki=0.8, position_kp=20.0, feedforward_friction=0.04,
    feedforward_acceleration=8e-6 / 0.0234, current_period=4e-5, velocity_period=4e-4, position_period=8e-4,
)  # fmt: skip
