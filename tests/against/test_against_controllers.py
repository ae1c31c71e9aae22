"""The whole loop against controllers written anew around the textbook's machine of ``test_against_solvers``.

A PID that acts on the voltage, and a servo cascade; limits, sag of the bus and windup are theirs. Both programs decide
for themselves what voltage comes next, sample by sample; what differs at one sample goes on from there.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from linear_machines import cascade_control
from scipy.linalg import expm
from textbook_machine import RUBS, SHAFT, STEEP, driven, on_slope, task_of, textbook

from drivesizer.control.engine import CurrentLimit, Drive, Supply, simulate
from drivesizer.control.gains import design_cascade
from drivesizer.control.validation import Cascade, Rates

RATES = Rates(4e-5, 4e-4, 1.2e-3)  # s: current, velocity, position

# --- the controllers


class Pid:
    """PI(D) with conditional integration and a filtered derivative (Åström, Hägglund, *PID Controllers*, 1995)."""

    def __init__(self, kp, ki, kd, lag, period, integral):
        self.kp, self.ki, self.kd, self.lag, self.period = kp, ki, kd, lag, period
        self.integral, self.fed, self.last = integral, 0.0, None

    def answer(self, error, rests):
        if not rests:
            self.integral += self.ki * self.period * error
        change = error - (error if self.last is None else self.last)
        self.fed = (self.lag * self.fed + self.kd * change) / (self.lag + self.period)
        self.last = error
        return self.kp * error + self.integral + self.fed


def within_bus(supply, i, u):
    """A voltage cut to what the bus leaves at full duty; it sags by the power it then gives, none comes back."""
    V = supply.voltage
    for _ in range(40):
        given = max(0.0, supply.sets * supply.max_duty * (V - supply.voltage_drop) * math.copysign(i, i * u) / V)
        V = supply.voltage - supply.resistance * given
    most = supply.max_duty * (V - supply.voltage_drop)
    return max(-most, min(most, u))


class VoltagePid:
    """The voltage of the sample before, cut to the bus and to the peak current at the end of the period."""

    def __init__(self, drive, machine):
        self.drive, g, m = drive, drive.controller, machine.m
        self.pending = m.resistance * machine.i + m.torque_constant * machine.w
        self.pid = Pid(g.kp, g.ki, g.kd, g.filter_time, g.period, self.pending)

    def voltage(self, n, machine, asked):
        wanted, error = self.pending, asked.speed(n) - machine.w
        u = self.within_current(machine, within_bus(self.drive.supply, machine.i, wanted))
        self.pending = self.pid.answer(error, (wanted - u) * error > 0.0)
        return u

    def within_current(self, machine, u):
        """The current a period ahead is affine in the voltage."""
        peak, period = self.drive.current.peak, self.drive.controller.period
        if peak == math.inf:
            return u
        idle, full = (ahead(machine, x, period) for x in (0.0, u))
        if abs(full) <= peak:
            return u
        return within_bus(self.drive.supply, machine.i, u * (math.copysign(peak, full) - idle) / (full - idle))


def ahead(machine, u, period):
    """The current after a period if the power keeps its direction [A]: rigid."""
    m, side = machine.m, machine.sides()[0]
    dw, inertia = machine.turning(machine.i, machine.w, side) if side else (0.0, math.inf)
    per_ampere = m.torque_constant / inertia
    rubs = m.viscous / inertia
    induced = m.torque_constant / m.inductance
    row = exponential(m.resistance / m.inductance, induced, per_ampere, rubs, m.inductance, period)
    return float(row @ (machine.i, machine.w, u, dw - per_ampere * machine.i + rubs * machine.w))


@cache
def exponential(damping, induced, per_ampere, rubs, inductance, period):
    """First row of exp(A t) for the current, the speed, a voltage and what accelerates beside the current."""
    A = [[-damping, -induced, 1.0 / inductance, 0.0], [per_ampere, -rubs, 0.0, 1.0], [0.0] * 4, [0.0] * 4]
    return expm(np.array(A) * period)[0]


class ServoCascade:
    """Position, velocity and current loops, each at its rate and a period of its own late.

    The current asked for is held to the peak for its time, then to what just fills the integral of I^2 - I_cont^2.
    """

    def __init__(self, drive, machine):
        self.drive, c, m = drive, drive.controller, machine.m
        volts = m.resistance * machine.i + m.torque_constant * machine.w
        self.more, self.next_more, self.asked, self.next, self.cut, self.beyond = 0.0, 0.0, 0.0, machine.i, 0.0, 0.0
        self.pending = volts
        fed = c.feedforward_velocity * machine.w + c.feedforward_friction * np.sign(machine.w)
        self.outer = Pid(c.velocity_kp, c.velocity_ki, c.velocity_kd, c.filter_time, c.velocity_period, machine.i - fed)
        self.inner = Pid(c.current_kp, c.current_ki, 0.0, 0.0, c.current_period, volts)
        self.filled, self.square = 0.0, 0.0

    def voltage(self, n, machine, asked):
        c = self.drive.controller
        self.fill(machine)
        if n % c.current_steps == 0:
            if c.position_kp and n % (c.current_steps * c.velocity_steps) == 0:
                found = c.position_kp * (asked.angle(n) - machine.angle)
                self.more, self.next_more = self.next_more, found
            self.ask(machine, asked, n)
        error = self.asked - machine.i
        wanted = self.inner.answer(error, self.beyond * error > 0.0)
        wanted, self.pending = self.pending, wanted
        u = within_bus(self.drive.supply, machine.i, wanted)
        self.beyond = wanted - u
        return u

    def ask(self, machine, asked, n):
        c, w = self.drive.controller, asked.speed(n)
        self.limit(self.next)
        error = w + self.more - machine.w
        fed = c.feedforward_velocity * w + c.feedforward_friction * np.sign(w)
        self.next = fed + c.feedforward_acceleration * asked.slope(n)
        self.next += self.outer.answer(error, self.cut * error > 0.0 or self.beyond * error > 0.0)

    def limit(self, wanted):
        most = self.most(self.drive.controller.velocity_period)
        self.asked = max(-most, min(most, wanted))
        self.cut = wanted - self.asked

    def fill(self, machine):
        more, self.square = machine.square - self.square, machine.square
        continuous = self.drive.current.continuous
        if continuous < math.inf:
            self.filled = max(0.0, self.filled + more - continuous**2 * self.drive.controller.current_period)

    def most(self, period):
        limit = self.drive.current
        if limit.peak_time == math.inf:
            return limit.peak
        left = (limit.peak**2 - limit.continuous**2) * limit.peak_time - self.filled
        return min(limit.peak, math.sqrt(limit.continuous**2 + max(0.0, left) / period))


class Asked:
    """A task at the motor shaft, by samples."""

    def __init__(self, task, ratio, period):
        self.time, self.w, self.period = np.array(task.time), np.array(task.speed) * ratio, period
        steps = np.diff(self.time) * (self.w[1:] + self.w[:-1]) / 2.0
        self.turned = np.concatenate(([0.0], np.cumsum(steps)))

    def speed(self, n):
        return float(np.interp(n * self.period, self.time, self.w))

    def slope(self, n):
        k = np.searchsorted(self.time, (n + 1e-6) * self.period) - 1
        return float(np.diff(self.w)[k] / np.diff(self.time)[k])

    def angle(self, n):
        k = np.searchsorted(self.time, (n + 1e-6) * self.period) - 1
        return float(self.turned[k] + (self.w[k] + self.speed(n)) / 2.0 * (n * self.period - self.time[k]))


def by_hand(drive, task, samples, i=0.0):
    """Rows of speed, current and voltage of the whole loop."""
    c = drive.controller
    period = c.current_period if isinstance(c, Cascade) else c.period
    machine = textbook(drive.train, i, task.speed[0] * drive.train.ratio)
    controller = (ServoCascade if isinstance(c, Cascade) else VoltagePid)(drive, machine)
    asked, rows = Asked(task, drive.train.ratio, period), []
    for n in range(samples):
        u = controller.voltage(n, machine, asked)
        rows.append((machine.w, machine.i, u))
        machine.advance(u, period)
    return np.array(rows)


def strayed(run, found, period):
    """Largest differences of speed [rad/s], current [A] and voltage [V], up to the reversal and after it."""
    s = {name: column[:-1] for name, column in run.series.items()}  # the last row is the end, after all samples
    n = np.rint(s["time"] / period).astype(int)
    off = np.abs(np.array((s["motor_speed"], s["current"], s["voltage"])).T - found[n])
    turn = int(np.argmax(s["motor_speed"] < 0.0))
    assert len(n) > 0.95 * len(found) and turn > 0
    return off[:turn].max(axis=0), off[turn:].max(axis=0)


# --- the voltage PID


@pytest.mark.parametrize(
    ("degrees", "more", "rate", "amps"),
    [(0.0, {}, 6e-4, 6e-6), (4.0, {}, 6e-4, 6e-6), (4.0, RUBS | SHAFT | {"gap": 0.01}, 0.01, 1e-3)],
    ids=["rigid, level", "rigid, uphill", "two masses, uphill"],
)
def test_the_voltage_pid(spec, catalog, degrees, more, rate, amps):
    """A thousand samples through the limits and the reversal.

    The simulation meets a change of mode up to 1/1024 of a period, 0.4 us, late. Rigid, that costs up to 6e-4 rad/s at
    the reversal, k_e/R times that in current, and nothing before; where a rotor alone in the backlash strikes, with
    some 1e4 rad/s^2, 0.01 rad/s.
    """
    train, drive = driven(spec, catalog, degrees, more)
    drive = replace(drive, controller=replace(drive.controller, kd=2e-5, filter_time=1e-3))
    task = task_of(train, *STEEP)
    run = simulate(drive, task)
    assert run.figures["time_at_voltage_limit"][0] > 0.02
    assert more or run.figures["time_at_current_limit"][0] > 0.05
    found = by_hand(drive, task, 1000, float(run.series["current"][0]))
    before, after = strayed(run, found, drive.controller.period)
    assert max(before[0], after[0]) < rate  # rad/s of 290
    assert max(before[1], after[1]) < amps  # A of 6 to 10
    assert max(before[2], after[2]) < 4.0 * amps  # V of 18
    assert more or before.max() < 3e-6


# --- the servo cascade

TURN = (0.0, 0.02, 0.08, 0.12, 0.2), (0.0, 0.8, 0.8, -0.8, -0.8)  # s, m/s
FOR_A_WHILE = CurrentLimit(peak=5.0, continuous=0.7, peak_time=0.06)


def servo(spec, catalog, degrees, more, **limits):
    """A servo drive with every path of the cascade in use, and its task."""
    _, train = on_slope(spec, catalog, degrees)
    bandwidth = 8.0 if more else 30.0  # Hz; the shaft rings at 87
    c, _ = design_cascade(train, RATES, cascade_control(bandwidth=bandwidth, position=True))
    c = replace(c, feedforward_velocity=1e-4, velocity_kd=1e-4, filter_time=1e-3)
    m = replace(train, **RUBS, **more)
    supply = Supply(voltage=17.0, resistance=0.05, sets=4, max_duty=0.9, voltage_drop=1.0)
    return Drive(train=m, controller=c, supply=supply, **limits), task_of(train, *TURN)


@pytest.mark.parametrize(
    ("degrees", "more", "limits", "rate", "amps"),
    [
        pytest.param(0.0, {}, {"current": CurrentLimit(peak=5.0)}, 5e-5, 1e-6, id="rigid"),
        pytest.param(4.0, {}, {"current": FOR_A_WHILE}, 5e-5, 5e-5, id="rigid, peak for a while"),
        pytest.param(4.0, SHAFT, {"current": CurrentLimit(peak=5.0)}, 7e-3, 2e-3, id="two masses"),
        pytest.param(4.0, SHAFT | {"gap": 0.01}, {"current": FOR_A_WHILE}, 6e-3, 5e-5, id="backlash"),
    ],
)
def test_the_cascade(spec, catalog, degrees, more, limits, rate, amps):
    """Five thousand current periods through the limits and a reversal.

    A change of mode is met up to 1/1024 of a period, 0.04 us, late: a rotor alone in the backlash has up to
    1.7e5 rad/s^2 then, 7e-3 rad/s. The integral of I^2 is that of a parabola in each period of the simulation: where
    the peak gives way to the continuous current, it does so by 5e-5 A apart.
    """
    drive, task = servo(spec, catalog, degrees, more, **limits)
    run = simulate(drive, task)
    assert run.figures["time_at_current_limit"][0] > 0.1
    assert run.figures["i2t_share"][0] > 1.0 or drive.current.peak_time == math.inf
    found = by_hand(drive, task, 5000, float(run.series["current"][0]))
    before, after = strayed(run, found, drive.controller.current_period)
    assert max(before[0], after[0]) < rate  # rad/s of 100
    assert max(before[1], after[1]) < amps  # A of 5
    assert max(before[2], after[2]) < 4.0 * amps  # V of 14: 2 V and more per ampere
