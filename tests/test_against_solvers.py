"""The machine in motion against SciPy's DOP853, as it stands in a textbook, under the voltages that the march applied.

The machine here is written anew and has no modes. Torques at the motor shaft, with the gears' loss by the direction of
power (H. Giberti, S. Cinquemani, G. Legnani, *Effects of transmission mechanical characteristics on the choice of a
motor-reducer*, Mechatronics 20 (2010) 604-610), T the torque of the driven shaft, e the efficiency, K the reduction:

    L di/dt = u - R i - k w
    J_m dw/dt = k i - f sgn w - b w - T/(K e) where T w > 0, - T e/K where T w < 0
    rigid:       T = T_load(sgn w) + b_l w/K + J_l/K dw/dt
    two masses:  T = c (twist -+ gap/2) + d (w/K - v) while it presses,  J_l dv/dt = T - T_load(sgn v) - b_l v

``test_against_controllers`` closes the loop around it.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drivesizer.control_design import design
from drivesizer.engine import CurrentLimit, Drive, Encoder, Supply, Task, march
from drivesizer.linear_modes import machine_of
from drivesizer.plant import drive_train
from drivesizer.sizing import explain

PERIOD = 4e-4  # s, of the EPOS4's speed loop
SHAFT = {"stiffness": 300.0, "damping": 0.2}  # N*m/rad, N*m*s/rad: rings at 87 Hz


def on_slope(spec, catalog, degrees):
    """The SPS robot on a slope, and the machine of the paper's set: RE 25, GP 26 A 27:1, belt 1.1:1."""
    load = spec.load.model_copy(update={"slope": math.radians(degrees)})
    hilly = spec.model_copy(update={"load": load})
    train, _ = drive_train(hilly, explain(spec, "118752", "406764", catalog=catalog)[0], PERIOD)
    return hilly, train


def task_of(train, time, speed):
    """What is asked of the wheel, from speeds of the robot [m/s]."""
    return Task(time=time, speed=tuple(v / train.radius for v in speed))


# --- the machine


class Rigid:
    """The rigid machine, integrated to 1e-10. State: i, w, angle, charge, integral of i^2."""

    speeds = (1,)

    def __init__(self, m, i=0.0, w=0.0):
        self.m = m
        self.y = np.array([i, w, 0.0, 0.0, 0.0])

    i = property(lambda self: float(self.y[0]))
    w = property(lambda self: float(self.y[1]))
    angle, charge, square = (property(lambda self, n=n: float(self.y[n])) for n in (-3, -2, -1))

    def share(self, T, side):
        """Torque at the motor per torque of the driven shaft, moving in a direction."""
        return (1.0 / self.m.efficiency if T * side > 0.0 else self.m.efficiency) / self.m.ratio

    def load(self, side):
        return self.m.forward_torque if side > 0 else self.m.backward_torque

    def holds(self, T, side):
        """Torque at the motor that a start takes, against a torque of the driven shaft."""
        return side * max(self.m.friction, self.m.stiction) + T * self.share(T, side)

    def bands(self, y):
        """Of each mass: torque that pushes it, and between which two it stands."""
        return [(self.m.torque_constant * y[0], *(self.holds(self.load(s), s) for s in (1, -1)))]

    def turning(self, i, w, side):
        """Acceleration of the motor, and inertia: with the loss of either direction of power; one agrees."""
        m = self.m
        for T in (side, -side):
            s = self.share(T, side)
            net = m.torque_constant * i - side * m.friction - m.viscous * w
            resisting = self.load(side) + m.load_viscous * w / m.ratio
            inertia = m.motor_inertia + s * m.load_inertia / m.ratio
            dw = (net - s * resisting) / inertia
            if (resisting + m.load_inertia / m.ratio * dw) * T >= 0.0:
                break
        return dw, inertia

    def rate(self, y, u, sides):
        i, w = y[:2]
        dw = self.turning(i, w, sides[0])[0] if sides[0] else 0.0
        return *self.winding(i, w, u, dw), w, i, i * i

    def winding(self, i, w, u, dw):
        return (u - self.m.resistance * i - self.m.torque_constant * w) / self.m.inductance, dw

    def sides(self):
        """Direction of each mass: of its motion, or of its start from rest; 0 where friction holds."""
        return [self.side(self.y[place], *band) for place, band in zip(self.speeds, self.bands(self.y), strict=True)]

    def side(self, speed, push, up, down):
        return int(np.sign(speed)) or (1 if push > up else -1 if push < down else 0)

    def advance(self, u, duration):
        """March on under a voltage; whatever stops or starts on the way ends a stretch."""
        done, sides = 0.0, self.sides()
        while done < duration:
            ends = self.ends(sides)
            found = solve_ivp(
                lambda _, y, now=sides: self.rate(y, u, now), (done, duration), self.y, "DOP853",
                events=ends, rtol=1e-10, atol=1e-12,
            )  # fmt: skip
            done, self.y = found.t[-1], found.y[:, -1].copy()
            for event, times in zip(ends, found.t_events, strict=True):
                if len(times):
                    if not event.starts:
                        self.y[self.speeds[event.mass]] = 0.0
                    sides = self.sides()
                    sides[event.mass] = event.starts or sides[event.mass]

    def ends(self, sides):
        """Events: a mass stops, or leaves what friction holds."""
        found = []
        for mass, side in enumerate(sides):
            for starts in (0,) if side else (1, -1):
                event = self.event(mass, side, starts)
                event.mass, event.starts, event.terminal, event.direction = mass, starts, True, 1.0
                found.append(event)
        return found

    def event(self, mass, side, starts):
        if side:
            return lambda _, y: -side * y[self.speeds[mass]]
        return lambda _, y: starts * (self.bands(y)[mass][0] - self.bands(y)[mass][1 if starts > 0 else 2])


class TwoMasses(Rigid):
    """Motor and load with a shaft between. State: i, w, twist, v, angle, charge, integral of i^2."""

    speeds = (1, 3)

    def __init__(self, m, i=0.0, w=0.0):
        super().__init__(m)
        standing = 0.0 if m.backward_torque <= 0.0 <= m.forward_torque else m.rest_torque
        T = self.load(w) + m.load_viscous * w / m.ratio if w else standing
        twist = T / m.stiffness + math.copysign(m.gap / 2.0, T) * (T != 0.0)
        self.y = np.array([i, w, twist, w / m.ratio, 0.0, 0.0, 0.0])

    def torque(self, y):
        """Of the shaft; in the backlash, and where it would pull, none."""
        m = self.m
        free = m.damping * (y[1] / m.ratio - y[3])
        if not m.gap:
            return m.stiffness * y[2] + free
        pressed = abs(y[2]) - m.gap / 2.0
        side = math.copysign(1.0, y[2])
        return side * max(m.stiffness * pressed + side * free, 0.0) if pressed > 0.0 else 0.0

    def bands(self, y):
        T = self.torque(y)
        motor = self.m.torque_constant * y[0], self.holds(T, 1), self.holds(T, -1)
        return [motor, (T, self.load(1), self.load(-1))]

    def rate(self, y, u, sides):
        m, (i, w, _, v), T = self.m, y[:4], self.torque(y)
        own = m.torque_constant * i - sides[0] * m.friction - m.viscous * w - self.share(T, sides[0]) * T
        dw = own / m.motor_inertia if sides[0] else 0.0
        dv = (T - self.load(sides[1]) - m.load_viscous * v) / m.load_inertia if sides[1] else 0.0
        return *self.winding(i, w, u, dw), w / m.ratio - v, dv, w, i, i * i


def textbook(m, i=0.0, w=0.0):
    return (TwoMasses if m.flexible else Rigid)(m, i, w)


# --- under the voltages that were applied

STEEP = (0.0, 0.05, 0.2, 0.3, 0.4), (0.0, 1.5, 1.5, -0.5, -0.5)  # s, m/s
RUBS = {"viscous": 2e-6, "load_viscous": 0.02}  # N*m*s/rad at the motor, at the wheel
SAGS = Supply(voltage=22.0, resistance=0.05, sets=4, max_duty=0.9, voltage_drop=1.0)


def slower(g, factor=5.0):
    """Gains that a shaft bears."""
    return replace(g, kp=g.kp / factor, ki=g.ki / factor / 2.0)


def driven(spec, catalog, degrees, more):
    """The robot's machine with a stiction and more, and the drive that goes with it: limits in voltage and current."""
    hilly, train = on_slope(spec, catalog, degrees)
    m = replace(machine_of(train), stiction=1.5 * train.friction, **more)
    g = design(hilly, train, PERIOD)
    peak = CurrentLimit() if m.flexible else CurrentLimit(peak=6.0)
    return train, Drive(machine=m, controller=slower(g) if m.flexible else g, supply=SAGS, current=peak)


def replayed(m, run, end):
    """Current and speed at the samples under a march's voltages; electrical energy and copper loss [J]."""
    s = run.series
    machine, rows, electrical = textbook(m, s["current"][0], s["motor_speed"][0]), [], 0.0
    for u, dt in zip(s["voltage"], np.diff(s["time"], append=end), strict=True):
        rows.append((machine.i, machine.w))
        before = machine.charge
        machine.advance(u, dt)
        electrical += u * (machine.charge - before)
    return np.array(rows).T, electrical, m.resistance * machine.square, machine


def net(run):
    return float(run.figures["energy_in"][0] - run.figures["energy_back"][0])


@pytest.mark.parametrize(
    ("degrees", "more", "grain"),
    [(0.0, {}, 6e-4), (4.0, RUBS | SHAFT | {"gap": 0.01}, 0.06)],
    ids=["rigid, level", "two masses, uphill"],
)
def test_the_machine_under_the_voltage_that_was_applied(spec, catalog, degrees, more, grain):
    """Exact but for the grain: a change of mode is met up to 1/1024 of a period, 0.4 us, late.

    Rigid, that shows at the reversal: it is still at 0 where the machine runs backward with up to 1270 rad/s^2 (6 A,
    driving), 5e-4 rad/s. A rotor that is alone in the backlash has k i/J_M, up to 1.5e5 rad/s^2: 0.06 rad/s.
    """
    train, drive = driven(spec, catalog, degrees, more)
    run = march(drive, task_of(train, *STEEP))
    assert run.figures["time_at_voltage_limit"][0] > 0.02
    speed, current = run.series["motor_speed"], run.series["current"]
    assert speed.max() > 240.0 and speed.min() < -50.0
    found, electrical, copper, end = replayed(drive.machine, run, STEEP[0][-1])
    off = np.abs(found[::-1] - (speed, current))
    turn = np.argmax(speed < 0.0)
    assert off[1].max() < 1e-4 and off[0].max() < grain  # A of 10, rad/s of 290
    if not more:
        assert off[:, :turn].max() < 3e-6
    assert run.figures["angle"][0] == pytest.approx(end.angle, abs=1e-4)  # rad, of 30 and more
    assert net(run) == pytest.approx(electrical, rel=1e-5)  # 35 J
    # the march takes the current within a period for a parabola; it settles in 0.1 ms, a quarter of that
    assert run.figures["copper_heat"][0] == pytest.approx(copper, rel=1e-4)


def test_copper_loss_under_a_voltage_that_leaps_every_few_periods(spec, catalog):
    """An encoder of few edges: at 300 rad/s a count more or less makes the voltage leap by 2 V, the current by 0.8 A.

    The march takes the current within a period for a parabola, of which it settles in a quarter: the loss of the ripple
    comes out too large, by 0.6 % of all at 0.4 ms, by 0.02 % at 0.1 ms. State and electrical energy are exact.
    """
    hilly, train = on_slope(spec, catalog, 3.0)
    m = machine_of(train)
    for n, share in ((1, 8e-3), (4, 2.5e-4)):
        g = replace(design(hilly, train, PERIOD / n), kp=8e-3, ki=0.02)
        task = Task(time=(0.0, 0.08), speed=(300.0 / m.ratio,) * 2)
        run = march(Drive(machine=m, controller=g, supply=SAGS, encoder=Encoder(edges=64 * n)), task)
        found, electrical, copper, _ = replayed(m, run, 0.08)
        assert np.ptp(run.series["voltage"]) > 1.9 and np.ptp(found[0]) > 0.55  # V, A of 1.0
        assert found == pytest.approx(np.array((run.series["current"], run.series["motor_speed"])), abs=1e-9)
        assert net(run) == pytest.approx(electrical, rel=1e-9)  # 0.95 J
        assert 0.0 < run.figures["copper_heat"][0] / copper - 1.0 < share


def test_errors_of_the_load_are_not_those_of_the_motor(spec, catalog):
    """Speed and angle of either mass against what is asked for: the load's angle is the motor's through the gears, less
    the twist of the shaft since the start."""
    train, drive = driven(spec, catalog, 4.0, RUBS | SHAFT | {"gap": 0.01})
    task = task_of(train, *STEEP)
    run, m = march(drive, task), drive.machine
    s, asked, samples = run.series, np.array(task.speed), round(STEEP[0][-1] / PERIOD)
    assert len(s["time"]) == samples + 1
    own, rows = textbook(m, s["current"][0], s["motor_speed"][0]), []
    start = own.y[2]
    for u in s["voltage"][:-1]:
        rows.append((own.angle / m.ratio, own.angle / m.ratio - (own.y[2] - start), own.y[1] / m.ratio, own.y[3]))
        own.advance(u, PERIOD)
    time = np.arange(samples) * PERIOD
    speed = np.interp(time, task.time, asked)
    turned = np.concatenate(([0.0], np.cumsum(np.diff(task.time) * (asked[1:] + asked[:-1]) / 2.0)))
    piece = np.clip(np.searchsorted(task.time, time + 1e-9) - 1, 0, None)
    angle = turned[piece] + (asked[piece] + speed) / 2.0 * (time - np.array(task.time)[piece])
    motor_way, way, motor, load = np.array(rows).T
    told = {name: float(column[0]) for name, column in run.figures.items()}
    assert told["angle_error"] / m.ratio == pytest.approx(np.abs(angle - motor_way).max(), rel=1e-3)
    assert told["load_angle_error"] == pytest.approx(np.abs(angle - way).max(), rel=1e-3)
    assert told["speed_error"] / m.ratio == pytest.approx(np.abs(speed - motor).max(), rel=1e-3)
    assert told["load_speed_error"] == pytest.approx(np.abs(speed - load).max(), rel=1e-3)
    squares = (np.square(angle - way).sum() * PERIOD, np.square(speed - load).sum() * PERIOD)
    assert (told["load_angle_error_square"], told["load_speed_error_square"]) == pytest.approx(squares, rel=2e-3)
    assert s["load_position_error"][:-1] == pytest.approx(angle - way, abs=2e-4)  # rad
    assert np.abs(way - motor_way).max() > 5e-3  # rad: beyond the tolerances above
