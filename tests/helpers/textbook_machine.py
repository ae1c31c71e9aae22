"""A motor and its load as a textbook has them, simulated by SciPy."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp
from specs import poorer

from drivesizer.control.drive_train import drive_train
from drivesizer.control.engine import CurrentLimit, Drive, Supply, Task
from drivesizer.control.gains import design
from drivesizer.sizing import explain

PERIOD = 4e-4  # s, of the EPOS4's speed loop

SHAFT = {"stiffness": 300.0, "damping": 0.2}  # N*m/rad, N*m*s/rad: rings at 87 Hz


def on_slope(spec, catalog, degrees):
    """The SPS robot on a slope, and the machine of the paper's set: RE 25, GP 26 A 27:1, belt 1.1:1."""
    load = spec.load.model_copy(update={"slope": math.radians(degrees)})
    hilly = spec.model_copy(update={"load": load})
    train, _ = drive_train(hilly, explain(spec, "118752", "406764", catalog=poorer(catalog))[0], PERIOD)
    return hilly, train


def task_of(train, time, speed):
    """What is asked of the wheel, from speeds of the robot [m/s]."""
    return Task(time=time, speed=tuple(v / train.radius for v in speed))


class Rigid:
    """The rigid machine, integrated to 1e-10. State: i, w, angle, charge, integral of i^2."""

    speeds = (1,)

    def __init__(self, m, i=0.0, w=0.0):
        self.m, self.ratio = m, m.ratio
        self.y = np.array([i, w, 0.0, 0.0, 0.0])

    i = property(lambda self: float(self.y[0]))
    w = property(lambda self: float(self.y[1]))
    angle, charge, square = (property(lambda self, n=n: float(self.y[n])) for n in (-3, -2, -1))

    def share(self, T, side):
        """Torque at the motor per torque of the driven shaft, moving in a direction."""
        return (1.0 / self.m.efficiency if T * side > 0.0 else self.m.efficiency) / self.ratio

    def load(self, side):
        return self.m.forward_torque if side > 0 else self.m.backward_torque

    def holds(self, T, side):
        """Torque at the motor that a start takes, against a torque of the driven shaft."""
        return side * self.m.friction + T * self.share(T, side)

    def bands(self, y):
        """Of each mass: torque that pushes it, and between which two it stands."""
        return [(self.m.torque_constant * y[0], *(self.holds(self.load(s), s) for s in (1, -1)))]

    def turning(self, i, w, side):
        """Acceleration of the motor, and inertia: with the loss of either direction of power; one agrees."""
        m = self.m
        for T in (side, -side):
            s = self.share(T, side)
            net = m.torque_constant * i - side * m.friction - m.viscous * w
            resisting = self.load(side)
            inertia = m.motor_inertia + s * m.load_inertia / self.ratio
            dw = (net - s * resisting) / inertia
            if (resisting + m.load_inertia / self.ratio * dw) * T >= 0.0:
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
        """Simulate on under a voltage; whatever stops or starts on its way ends a stretch."""
        done, sides = 0.0, self.sides()
        while done < duration:
            ends = self.ends(sides)
            found = solve_ivp(
                lambda _, y, now=sides: self.rate(y, u, now), (done, duration), self.y, "DOP853",
                events=ends, rtol=1e-10, atol=1e-12, first_step=duration - done,
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
        T = self.load(w) if w else standing
        twist = T / m.stiffness + math.copysign(m.gap / 2.0, T) * (T != 0.0)
        self.y = np.array([i, w, twist, w / self.ratio, 0.0, 0.0, 0.0])

    def torque(self, y):
        """Of the shaft; in the backlash, and where it would pull, none."""
        m = self.m
        free = m.damping * (y[1] / self.ratio - y[3])
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
        dv = (T - self.load(sides[1])) / m.load_inertia if sides[1] else 0.0
        return *self.winding(i, w, u, dw), w / self.ratio - v, dv, w, i, i * i


def textbook(m, i=0.0, w=0.0):
    return (TwoMasses if m.flexible else Rigid)(m, i, w)


STEEP = (0.0, 0.05, 0.2, 0.3, 0.4), (0.0, 1.5, 1.5, -0.5, -0.5)  # s, m/s

RUBS = {"viscous": 2e-6}  # N*m*s/rad at the motor

SAGS = Supply(voltage=22.0, resistance=0.05, sets=4, max_duty=0.9, voltage_drop=1.0)


def slower(g, factor=5.0):
    """Gains that a shaft bears."""
    return replace(g, kp=g.kp / factor, ki=g.ki / factor / 2.0)


def driven(spec, catalog, degrees, more):
    """The robot's machine with more, and the drive that goes with it: limits in voltage and current."""
    hilly, train = on_slope(spec, catalog, degrees)
    m = replace(train, **more)
    g = design(hilly, train, PERIOD)
    peak = CurrentLimit() if m.flexible else CurrentLimit(peak=6.0)
    return train, Drive(train=m, controller=slower(g) if m.flexible else g, supply=SAGS, current=peak)


def net(run):
    return float(run.figures["energy_in"][0] - run.figures["energy_returned"][0])
