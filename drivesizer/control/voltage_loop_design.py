"""Gains of the velocity loop that acts on the voltage: those of the spec, or PI gains by the SIMC rule [1].

The rule works on the speed response of the motor with its reflected load, friction that grows with speed left out.
A counted speed is late by half its counting time, and one count may be answered with a tenth of the available voltage:
of all counting times the one with the fastest closed loop is taken.

.. [1] S. Skogestad, "Simple analytic rules for model reduction and PID controller tuning", J. Process Control 13
   (2003) 291-309: the half rule, the PI settings, and tau_c = theta for tight control.
.. [2] K. J. Åström, T. Hägglund, *PID Controllers: Theory, Design, and Tuning*, 2nd ed., ISA, 1995, ch. 3: filter of
   the derivative.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.drive_train import DriveTrain, Mode, Regime, modes
from drivesizer.control.validation import Gains
from drivesizer.errors import InputError
from drivesizer.physics.counted_speed import Counts, lags, most_gain, shortest
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

__all__ = ["COMPUTING", "design", "effective_delay"]

_Array = NDArray[np.float64]

RULE = "SIMC PI"
SOURCE = "S. Skogestad, J. Process Control 13 (2003) 291-309"
GIVEN = "given in the spec"
COMPUTING = 1.0  # control periods between a measurement and the voltage that answers it
_HOLDING = 0.5  # control periods by which a held voltage is late on average
_FILTER = 10.0  # derivative time over its filter's, 8 to 20 by [2]
_LARGEST_GAIN = 1e9  # V per unit: with it, rounding errors of the speed would be volts


def effective_delay(train: DriveTrain, mode: Mode, period: float) -> tuple[float, float]:
    r"""Lag and delay of the first-order model of the speed response.

    .. math:: \frac{w}{u} = \frac{1/k_e}{(T_1 s + 1)(T_2 s + 1)} \approx \frac{1/k_e}{\tau_1 s + 1} e^{-\theta s},
              \quad \tau_1 = T_1 + T_2 / 2, \quad \theta = T_2 / 2 + 1.5\,T_s

    Notes
    -----
    :math:`T_1 + T_2 = R J/(k_t k_e)` and :math:`T_1 T_2 = (T_1 + T_2) L/R`; where they are complex (a light rotor
    behind a large inductance) their real part is taken. Half rule: [1].
    """
    mechanical = train.resistance * mode.inertia / (train.torque_constant * train.back_emf_constant)
    electrical = train.inductance / train.resistance
    spread = math.sqrt(max(0.0, 1.0 - 4.0 * electrical / mechanical))
    slow = mechanical / 2 * (1.0 + spread)
    fast = mechanical - slow
    return slow + fast / 2, fast / 2 + (COMPUTING + _HOLDING) * period


def design(
    spec: RobotSpec, train: DriveTrain, period: float, counts: Counts | None = None, slower: float = 1.0
) -> Gains:
    """Gains of the voltage PI: given by the spec, or by the SIMC rule."""
    if spec.control.kp is not None:
        return _given_gains(spec, spec.control.kp, period, counts)
    tau_1, theta = effective_delay(train, modes(train)[Regime.FORWARD_DRIVING], period)
    periods, late = lags(counts, period)
    tight, quiet = _least(train, period, counts)
    least = np.maximum(tight, quiet)
    tau_c = slower * _time_constant(spec, float(tight.min()), float(least.min()))
    # at a bandwidth that is given, counts may be too noisy: then they are taken as long as the delay allows
    n = shortest(least, tau_c) if tau_c >= least.min() else int(np.flatnonzero(tight <= tau_c)[-1])
    theta += float(late[n])
    kp = train.back_emf_constant * tau_1 / (tau_c + theta)
    tau_i = min(tau_1, 4.0 * (tau_c + theta))
    rule = f"{RULE}, tau_c = {show(tau_c, 'ms', 'time', 3)}{' (tight)' if tau_c == least.min() else ''}"
    return Gains(
        kp=kp, ki=kp / tau_i, kd=0.0, filter_time=0.0, period=period, counted_over=int(periods[n]), rule=rule,
        source=SOURCE,
    )  # fmt: skip


def _least(train: DriveTrain, period: float, counts: Counts | None) -> tuple[_Array, _Array]:
    """Shortest time constants of the closed loop, by delay and by noise, for every time of counting [s]."""
    every = modes(train)
    tau_1, theta = effective_delay(train, every[Regime.FORWARD_DRIVING], period)
    lightest, _ = effective_delay(train, every[Regime.FORWARD_BRAKING], period)
    periods, late = lags(counts, period)
    delay = theta + late
    # braking, the gears' losses help and the loop is faster: even there tau_c is no shorter than the delay
    tight = tau_1 / lightest * 2.0 * delay - delay
    if counts is None:
        return tight, tight
    return tight, train.back_emf_constant * tau_1 / most_gain(counts, periods, period) - delay


def _time_constant(spec: RobotSpec, tight: float, least: float) -> float:
    """Time constant of the closed loop [s]: that of the required bandwidth, else the least by delay and noise."""
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
        return max(least, 1.0 / (2.0 * math.pi * spec.needs.bandwidth))
    return least


def _given_gains(spec: RobotSpec, kp: float, period: float, counts: Counts | None) -> Gains:
    ki, kd = spec.control.ki, spec.control.kd
    for name, gain in (("kp", kp), ("ki", ki), ("kd", kd)):
        if gain > _LARGEST_GAIN:
            where = spec.where(("control", name))
            raise InputError(f"{where}: {gain:g} is no gain of a real controller; expected at most {_LARGEST_GAIN:g}")
    filter_time = max(period, kd / kp / _FILTER) if kp and kd else period if kd else 0.0
    over = max(counts.periods, 1) if counts else 0
    return Gains(
        kp=kp, ki=ki, kd=kd, filter_time=filter_time, period=period, counted_over=over, rule=GIVEN, source=""
    )  # fmt: skip
