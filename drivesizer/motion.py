"""The machine of ``plant`` marched through time, exactly within each mode, with a tally of what it went through.

Each mode is discretised once for a voltage held over a control period (zero-order hold, python-control). A period
in which the mode changes - the motion stops or starts, the power turns round - is done again in short steps.
Symbols: i current [A], w motor speed [rad/s], u voltage [V], q charge [A*s], x angle of the motor [rad].
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import numpy as np

from drivesizer.plant import DriveTrain, Mode, Regime, modes

__all__ = ["Motion", "Tally", "matrices"]

_SHORT = 16  # steps of a period in which the mode changes: a stop is met to 1/16 of what a period does to the speed
_REGIMES = len(Regime)


class _Step(NamedTuple):
    """One step: each of i, w, q, x from i, w, u and a constant."""

    i: tuple[float, float, float, float]
    w: tuple[float, float, float, float]
    q: tuple[float, float, float, float]
    x: tuple[float, float, float, float]


class Tally:
    """What the motor went through, by regime: whatever is affine in the current follows from it afterwards."""

    def __init__(self, i: float) -> None:
        self.time = [0.0] * _REGIMES  # s
        self.charge = [0.0] * _REGIMES  # A*s, the integral of the current
        self.square = [0.0] * _REGIMES  # A^2*s, the integral of its square
        self.angle = [0.0] * _REGIMES  # rad
        self.high = [-inf] * _REGIMES  # A
        self.low = [inf] * _REGIMES  # A
        self.high_at = [0.0] * _REGIMES  # s
        self.low_at = [0.0] * _REGIMES  # s
        self.speed, self.speed_at = 0.0, 0.0  # rad/s at the motor, either direction
        self.power, self.power_at = 0.0, 0.0  # W into one motor
        self.energy_in, self.energy_back = 0.0, 0.0  # J at the terminals of one motor

    def take(self, regime: int, t: float, dt: float, u: float, ends: tuple[float, float], q: float, x: float) -> None:
        """Add a step that ends at a time, in which the current runs between two ends and carries a charge."""
        first, last = ends
        mean, rise = q / dt, last - first
        bend = (first + last) / 2 - mean
        self.time[regime] += dt
        self.charge[regime] += q
        # exact for a current that is a parabola in time (expansion in Legendre polynomials)
        self.square[regime] += dt * (mean * mean + rise * rise / 12 + bend * bend / 5)
        self.angle[regime] += x
        if last > self.high[regime]:
            self.high[regime], self.high_at[regime] = last, t
        if last < self.low[regime]:
            self.low[regime], self.low_at[regime] = last, t
        energy = u * q
        if energy > 0.0:
            self.energy_in += energy
        else:
            self.energy_back -= energy
        power = u * (first if (first > last) == (u > 0.0) else last)
        if power > self.power:
            self.power, self.power_at = power, t

    def faster(self, w: float, t: float) -> None:
        """Keep the highest speed."""
        if w > self.speed or -w > self.speed:
            self.speed, self.speed_at = abs(w), t


def matrices(train: DriveTrain, mode: Mode) -> tuple[np.ndarray, np.ndarray]:
    """State matrices of a mode: states i, w, q, x; inputs voltage and drag torque.

    Returns
    -------
    tuple
        A (4x4) and B (4x2) of dx/dt = A x + B (u, drag); Krause, Wasynczuk, Sudhoff, *Analysis of Electric Machinery*,
        the permanent-magnet DC machine, without viscous friction.
    """
    R, L, k = train.resistance, train.inductance, train.torque_constant
    A = np.array([[-R / L, -k / L, 0, 0], [k / mode.inertia, 0, 0, 0], [1, 0, 0, 0], [0, 1, 0, 0]], float)
    B = np.array([[1 / L, 0], [0, -1 / mode.inertia], [0, 0], [0, 0]], float)
    return A, B


def _step(train: DriveTrain, mode: Mode, period: float) -> _Step:
    import control

    A, B = matrices(train, mode)
    held = control.ss(A, B, np.eye(4), np.zeros((4, 2))).sample(period, "zoh")
    rows = [
        (float(a[0]), float(a[1]), float(b[0]), float(b[1]) * mode.drag) for a, b in zip(held.A, held.B, strict=True)
    ]
    return _Step(*rows)


class Motion:
    """The state of a machine, marched by control periods."""

    def __init__(self, train: DriveTrain, period: float, *, speed: float = 0.0) -> None:
        self.train, self.period = train, period
        self.modes = modes(train)
        self._whole = [_step(train, mode, period) for mode in self.modes]
        self._short = [_step(train, mode, period / _SHORT) for mode in self.modes]
        k = train.torque_constant
        # the current at which the wheel takes no torque: more drives, less brakes
        self._turn = {r: -self.modes[r].wheel_torque[0] / self.modes[r].wheel_torque[1] for r in list(Regime)[1:]}
        self._forward_turn, self._backward_turn = (
            self._turn[Regime.FORWARD_DRIVING],
            self._turn[Regime.BACKWARD_DRIVING],
        )
        # the currents between which friction holds the machine at rest
        up = Regime.FORWARD_DRIVING if train.forward_torque > 0.0 else Regime.FORWARD_BRAKING
        down = Regime.BACKWARD_DRIVING if train.backward_torque < 0.0 else Regime.BACKWARD_BRAKING
        self.breakaway = self.modes[down].drag / k, self.modes[up].drag / k
        self.w = speed
        self.i = self._equilibrium()
        self.x = 0.0
        self.regime = self._regime_at(self.i, self.w)
        self.tally = Tally(self.i)
        self.tally.faster(speed, 0.0)
        self.steps = 0

    def _equilibrium(self) -> float:
        """The current that keeps the speed; at rest none where friction holds, else what holds the weight."""
        low, high = self.breakaway
        if self.w:
            return high if self.w > 0.0 else low
        if low <= 0.0 <= high:
            return 0.0
        return self.train.slope_torque / (self.train.ratio * self.train.torque_constant)

    def _regime_at(self, i: float, w: float) -> int:
        if w > 0.0 or (w == 0.0 and i > self.breakaway[1]):
            return 1 if i > self._forward_turn else 2
        if w < 0.0 or i < self.breakaway[0]:
            return 3 if i < self._backward_turn else 4
        return 0

    def ahead(self) -> tuple[float, float]:
        """The current at the end of a period: without voltage, and per volt."""
        a = self._whole[self.regime].i
        return a[0] * self.i + a[1] * self.w + a[3], a[2]

    def advance(self, u: float, t: float) -> None:
        """March one period under a held voltage, from a time on."""
        i, w, step = self.i, self.w, self._whole[self.regime]
        a, b, c, d = step.i
        i1 = a * i + b * w + c * u + d
        a, b, c, d = step.w
        w1 = a * i + b * w + c * u + d
        if self._regime_at(i1, w1) == self.regime:
            self._take(step, u, t, self.period, i1, w1)
        else:
            dt = self.period / _SHORT
            for n in range(_SHORT):
                self._advance_shortly(u, t + n * dt, dt)

    def _advance_shortly(self, u: float, t: float, dt: float) -> None:
        i, w, step = self.i, self.w, self._short[self.regime]
        a, b, c, d = step.i
        i1 = a * i + b * w + c * u + d
        a, b, c, d = step.w
        w1 = a * i + b * w + c * u + d
        if w * w1 < 0.0:  # a reversal passes through rest, where friction may hold
            w1 = 0.0
        self._take(step, u, t, dt, i1, w1)
        self.regime = self._regime_at(i1, w1)

    def _take(self, step: _Step, u: float, t: float, dt: float, i1: float, w1: float) -> None:
        i, w = self.i, self.w
        a, b, c, d = step.q
        q = a * i + b * w + c * u + d
        a, b, c, d = step.x
        x = a * i + b * w + c * u + d
        self.tally.take(self.regime, t + dt, dt, u, (i, i1), q, x)
        self.tally.faster(w1, t + dt)
        self.i, self.w, self.x = i1, w1, self.x + x
        self.steps += 1

    def hold(self, u: float, t: float, duration: float) -> None:
        """Carry a steady state on for a while."""
        self.tally.take(self.regime, t, duration, u, (self.i, self.i), self.i * duration, self.w * duration)
        self.x += self.w * duration

    def gear_torque(self) -> float:
        """Torque at the gearhead's output now [N*m]."""
        fixed, per_ampere = self.modes[self.regime].gear_torque
        return fixed + per_ampere * self.i
