"""The velocity controller: its gains, the controller itself, and what linear theory says of the closed loop.

Gains are the spec's, or PI gains by the SIMC rule [1] on the speed response of the motor with its reflected load.
The loop is analysed as it runs: sampled, with the voltage held over a period (exact zero-order hold) and one period
for measuring and computing; no Padé approximation is needed. Both directions of power are looked at, and the worse
figure counts.

.. [1] S. Skogestad, "Simple analytic rules for model reduction and PID controller tuning", J. Process Control 13
   (2003) 291-309: the half rule, the PI settings, and tau_c = theta for tight control.
.. [2] K. J. Åström, T. Hägglund, *PID Controllers: Theory, Design, and Tuning*, 2nd ed., ISA, 1995, ch. 3: filter of
   the derivative, conditional integration against windup.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

from drivesizer.errors import InputError
from drivesizer.motion import matrices
from drivesizer.plant import DriveTrain, Mode, Regime, modes
from drivesizer.results import Gains
from drivesizer.spec import RobotSpec
from drivesizer.units import show

__all__ = ["LinearLoop", "Pid", "analyse", "design", "effective_delay", "open_loop", "sampled_pid"]

RULE = "SIMC PI"
SOURCE = "S. Skogestad, J. Process Control 13 (2003) 291-309"
GIVEN = "given in the spec"
COMPUTING = 1.0  # control periods between a measurement and the voltage that answers it
_HOLDING = 0.5  # control periods by which a held voltage is late on average
_FILTER = 10.0  # derivative time over its filter's, 8 to 20 by [2]
_LARGEST_GAIN = 1e9  # V per unit: with it, rounding errors of the speed would be volts


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearLoop:
    """The closed loop without its limits; NaN where a figure does not exist."""

    stable: bool
    pole_radius: float  # largest modulus of the closed loop's poles; below 1 is stable
    gain_margin: float  # factor
    phase_margin: float  # rad
    bandwidth: float  # Hz, -3 dB of the response to the reference
    poles: tuple[complex, ...]  # z plane


def effective_delay(train: DriveTrain, mode: Mode, period: float) -> tuple[float, float]:
    r"""Lag and delay of the first-order model of the speed response.

    .. math:: \frac{w}{u} = \frac{1/k_e}{(T_1 s + 1)(T_2 s + 1)} \approx \frac{1/k_e}{\tau_1 s + 1} e^{-\theta s},
              \quad \tau_1 = T_1 + T_2 / 2, \quad \theta = T_2 / 2 + 1.5\,T_s

    Parameters
    ----------
    train, mode
        The machine and the direction of power.
    period
        Control period :math:`T_s` [s].

    Returns
    -------
    tuple
        :math:`\tau_1` and :math:`\theta` [s].

    Notes
    -----
    :math:`T_1 + T_2 = R J/k^2` and :math:`T_1 T_2 = (R J/k^2)(L/R)`; where they are complex (a light rotor behind a
    large inductance) their real part is taken. Half rule: [1].
    """
    mechanical = train.resistance * mode.inertia / train.torque_constant**2
    electrical = train.inductance / train.resistance
    spread = math.sqrt(max(0.0, 1.0 - 4.0 * electrical / mechanical))
    slow = mechanical / 2 * (1.0 + spread)
    fast = mechanical - slow
    return slow + fast / 2, fast / 2 + (COMPUTING + _HOLDING) * period


def design(spec: RobotSpec, train: DriveTrain, period: float) -> Gains:
    """The gains that a spec gives, or those of the SIMC rule.

    Parameters
    ----------
    spec
        The robot; ``control`` has the gains or the bandwidth, ``needs`` may ask for a bandwidth.
    train
        The machine.
    period
        Control period [s].

    Raises
    ------
    InputError
        When ``control.bandwidth`` is faster than the delay of the loop allows, or a gain is no use.
    """
    if spec.control.kp is not None:
        return _given(spec, spec.control.kp, period)
    every = modes(train)
    tau_1, theta = effective_delay(train, every[Regime.FORWARD_DRIVING], period)
    lightest, _ = effective_delay(train, every[Regime.FORWARD_BRAKING], period)
    # braking, the gears' losses help and the loop is faster: even there tau_c is no shorter than the delay
    tight = tau_1 / lightest * 2.0 * theta - theta
    tau_c = _asked(spec, tight)
    kp = train.torque_constant * tau_1 / (tau_c + theta)
    tau_i = min(tau_1, 4.0 * (tau_c + theta))
    rule = f"{RULE}, tau_c = {show(tau_c, 'ms', 'time', 3)}{' (tight)' if tau_c == tight else ''}"
    return Gains(kp=kp, ki=kp / tau_i, kd=0.0, filter_time=0.0, period=period, rule=rule, source=SOURCE)


def _asked(spec: RobotSpec, tight: float) -> float:
    """Time constant of the closed loop: that of the bandwidth asked for, else the tight one [s]."""
    if spec.control.bandwidth is not None:
        tau_c = 1.0 / (2.0 * math.pi * spec.control.bandwidth)
        if tau_c < tight:
            most = show(1.0 / (2.0 * math.pi * tight), "Hz", "frequency", 3)
            raise InputError(
                f"{spec.where(('control', 'bandwidth'))}: {show(spec.control.bandwidth, 'Hz', 'frequency')} is faster "
                f"than the delay of the loop allows; expected at most {most}"
            )
        return tau_c
    if spec.needs.bandwidth is not None:  # a need that cannot be met fails its check
        return max(tight, 1.0 / (2.0 * math.pi * spec.needs.bandwidth))
    return tight


def _given(spec: RobotSpec, kp: float, period: float) -> Gains:
    ki, kd = spec.control.ki, spec.control.kd
    for name, gain in (("kp", kp), ("ki", ki), ("kd", kd)):
        if gain > _LARGEST_GAIN:
            where = spec.where(("control", name))
            raise InputError(f"{where}: {gain:g} is no gain of a real controller; expected at most {_LARGEST_GAIN:g}")
    filter_time = max(period, kd / kp / _FILTER) if kp and kd else period if kd else 0.0
    return Gains(kp=kp, ki=ki, kd=kd, filter_time=filter_time, period=period, rule=GIVEN, source="")


class Pid:
    """A sampled PID with a filtered derivative; its integral rests while it would only drive further into a limit."""

    def __init__(self, gains: Gains, integral: float = 0.0) -> None:
        period, filtered = gains.period, gains.filter_time + gains.period
        self.kp, self.integral_gain = gains.kp, gains.ki * period
        self.keep, self.derivative_gain = gains.filter_time / filtered, gains.kd / filtered
        self.integral = integral  # V
        self.derivative = 0.0  # V
        self.last: float | None = None  # error of the sample before

    def demand(self, error: float, saturation: float) -> float:
        """The voltage asked for [V].

        Parameters
        ----------
        error
            Reference minus speed at the motor [rad/s].
        saturation
            Demand minus what was applied [V]: not 0 while a limit holds.
        """
        if not saturation * error > 0.0:  # conditional integration [2]
            self.integral += self.integral_gain * error
        change = error - self.last if self.last is not None else 0.0
        self.last = error
        self.derivative = self.keep * self.derivative + self.derivative_gain * change
        return self.kp * error + self.integral + self.derivative


def open_loop(train: DriveTrain, mode: Mode, gains: Gains) -> Any:
    """The sampled loop, error to speed, as a python-control system."""
    import control

    A, B = matrices(train, mode)
    period = gains.period
    plant = control.ss(A[:2, :2], B[:2, :1], [[0, 1]], 0).sample(period, "zoh")
    late = control.ss(control.tf([1], [1, *[0] * round(COMPUTING)], period))
    return plant * late * sampled_pid(gains.kp, gains.ki, period, gains.kd, gains.filter_time)


def sampled_pid(kp: float, ki: float, period: float, kd: float = 0.0, filter_time: float = 0.0) -> Any:
    """What :class:`Pid` is without its limits, as a python-control system; it answers at once."""
    import control

    found: Any = control.ss([], [], [], [[kp]], period)
    if ki:
        found = found + control.ss(control.tf([ki * period, 0], [1, -1], period))
    if kd:
        filtered = filter_time + period
        found = found + control.ss(control.tf([kd, -kd], [filtered, -filter_time], period))
    return found


def analyse(train: DriveTrain, gains: Gains) -> LinearLoop:
    """Stability and bandwidth of the loop, the worse of driving and braking.

    Parameters
    ----------
    train
        The machine.
    gains
        The controller's gains and period.
    """
    every = modes(train)
    found = [
        _analysed(open_loop(train, every[r], gains), gains) for r in (Regime.FORWARD_DRIVING, Regime.FORWARD_BRAKING)
    ]
    radius = max(loop.pole_radius for loop in found)
    return LinearLoop(
        stable=all(loop.stable for loop in found),
        pole_radius=radius,
        gain_margin=_least(loop.gain_margin for loop in found),
        phase_margin=_least(loop.phase_margin for loop in found),
        bandwidth=_least(loop.bandwidth for loop in found),
        poles=next(loop.poles for loop in found if loop.pole_radius == radius),
    )


def _least(figures: Any) -> float:
    return min((f for f in figures if math.isfinite(f)), default=math.nan)


def _analysed(loop: Any, gains: Gains) -> LinearLoop:
    import control

    closed = control.feedback(loop, 1)
    poles = tuple(complex(p) for p in closed.poles())
    radius = max(abs(p) for p in poles)
    gain_margin, phase_margin = math.nan, math.nan
    if radius < 1.0 and (gains.kp or gains.ki or gains.kd):  # an unstable loop has no margins
        with warnings.catch_warnings():
            # slow loops: it says that it falls back from polynomials to the frequency response, which is accurate
            warnings.simplefilter("ignore", UserWarning)
            gain_margin, phase_margin, *_ = (float(m) for m in control.margin(loop))
    return LinearLoop(
        stable=radius < 1.0,
        pole_radius=radius,
        gain_margin=gain_margin,
        phase_margin=math.radians(phase_margin),
        bandwidth=_bandwidth(closed, gains.period),
        poles=poles,
    )


def _bandwidth(closed: Any, period: float) -> float:
    """Where the response first falls 3 dB below its value at rest; NaN where it does not below the Nyquist frequency.

    python-control's own ``bandwidth`` warns on sampled systems, for it looks beyond that frequency.
    """
    from scipy.optimize import brentq

    def above(log_w: float) -> float:
        return float(abs(closed(np.exp(1j * math.exp(log_w) * period)))) - level

    level = float(abs(closed(1.0 + 0j))) / math.sqrt(2.0)
    if not (math.isfinite(level) and level > 0.0):
        return math.nan
    nyquist = math.log(math.pi / period)
    grid = np.linspace(nyquist - math.log(1e6), nyquist, 2000)
    response = np.abs(closed(np.exp(1j * np.exp(grid) * period))) - level
    below = np.flatnonzero(response < 0.0)
    if not len(below) or below[0] == 0:
        return math.nan
    crossing = brentq(above, grid[below[0] - 1], grid[below[0]])
    return math.exp(crossing) / (2.0 * math.pi)
