r"""Gains of the servo cascade by named rules, from the inside out.

The winding is a lag :math:`L/R`; the delay of a held voltage, computing included, is the small lag
:math:`T_{\sigma i} = 1.5\,T_i`. The magnitude optimum [1]_ makes of it a current loop with the lag
:math:`2\,T_{\sigma i}` and damping 0.707; the back-EMF is a disturbance. The velocity loop sees the inertia behind
:math:`T_{\sigma w} = R/k_{i,i} + 1.5\,T_w`, the position loop sees the velocity loop.
Symbols: J inertia at the motor [kg*m^2], k_t torque constant [N*m/A], T period [s].

.. [1] C. Kessler, "Über die Vorausberechnung optimal abgestimmter Regelkreise, Teil III", Regelungstechnik 3 (1955)
   40-49.
.. [2] C. Kessler, "Das symmetrische Optimum", Regelungstechnik 6 (1958) 395-400, 432-436.
.. [3] D. Schröder, *Elektrische Antriebe - Regelung von Antriebssystemen*, Springer: both optima, cascade control.
.. [4] W. Leonhard, *Control of Electrical Drives*, 3rd ed., Springer 2001: cascade, symmetrical optimum, position loop.
.. [5] K. J. Åström, T. Hägglund, *PID Controllers: Theory, Design, and Tuning*, 2nd ed., ISA 1995: pole placement,
   phase margins, filter of the derivative.
"""

from __future__ import annotations

import math

from drivesizer.control.cascade import LEAST_PHASE_MARGIN
from drivesizer.control.drive_train import DriveTrain, Regime, modes
from drivesizer.control.voltage_loop_design import COMPUTING

__all__ = [
    "FILTER", "LATE", "SOURCES", "SPREAD", "current_lag", "feedforward", "magnitude_optimum", "margin_of",
    "most_bandwidth", "natural_frequency", "pole_placement", "position_gain", "spread_of", "symmetrical_optimum",
]  # fmt: skip

LATE = COMPUTING + 0.5  # periods: computing, and the half by which a held value is late on average
SPREAD = 2.0  # a of the symmetrical optimum [2]: phase margin 36.9 deg
FILTER = 10.0  # derivative time over its filter's, 8 to 20 by [5]
SOURCES = {
    "magnitude optimum": "C. Kessler, Regelungstechnik 3 (1955) 40-49",
    "symmetrical optimum": "C. Kessler, Regelungstechnik 6 (1958) 395-400",
    "pole placement": "K. J. Åström, T. Hägglund, PID Controllers, ISA 1995",
    "aperiodic": "W. Leonhard, Control of Electrical Drives, Springer 2001",
}


def magnitude_optimum(resistance: float, inductance: float, lag: float) -> tuple[float, float]:
    r"""Current PI gains by the magnitude optimum [1]_ [3]_.

    .. math:: k_p = \frac{L}{2 T_\sigma}, \quad k_i = \frac{R}{2 T_\sigma}
              \quad\Rightarrow\quad \frac{i}{i^*} = \frac{1}{1 + 2 T_\sigma s + 2 T_\sigma^2 s^2}
    """
    return inductance / (2.0 * lag), resistance / (2.0 * lag)


def spread_of(phase_margin: float) -> float:
    r"""The spread a of the symmetrical optimum that has a phase margin [rad] [3]_.

    .. math:: \varphi = \arctan a - \arctan (1/a) \quad\Leftrightarrow\quad a = \frac{1 + \sin\varphi}{\cos\varphi}

    >>> round(spread_of(math.atan(0.75)), 12)
    2.0
    """
    return (1.0 + math.sin(phase_margin)) / math.cos(phase_margin)


def margin_of(a: float) -> float:
    """The phase margin [rad] that the symmetrical optimum has with a spread, the inverse of :func:`spread_of`."""
    return math.atan(a) - math.atan(1.0 / a)


def symmetrical_optimum(inertia: float, torque_constant: float, lag: float, a: float = SPREAD) -> tuple[float, float]:
    r"""Velocity PI gains by the symmetrical optimum [2]_ [3]_ [4]_.

    .. math:: k_p = \frac{J}{k_t\, a\, T_\sigma}, \quad k_i = \frac{k_p}{a^2 T_\sigma}
    """
    kp = inertia / (torque_constant * a * lag)
    return kp, kp / (a * a * lag)


def natural_frequency(bandwidth: float, damping: float) -> float:
    r"""Natural frequency [rad/s] of the poles of a PI loop around an inertia, for a -3 dB bandwidth [Hz].

    Of :math:`(2 D\omega_0 s + \omega_0^2)/(s^2 + 2 D\omega_0 s + \omega_0^2)`:

    .. math:: \omega_b = \omega_0 \sqrt{1 + 2D^2 + \sqrt{(1 + 2D^2)^2 + 1}}
    """
    b = 1.0 + 2.0 * damping**2
    return 2.0 * math.pi * bandwidth / math.sqrt(b + math.hypot(b, 1.0))


def pole_placement(
    inertia: float, torque_constant: float, natural_frequency: float, damping: float, viscous: float = 0.0
) -> tuple[float, float]:
    r"""Velocity PI gains by pole placement [5]_.

    .. math:: k_p = \frac{2 D \omega_0 J - b}{k_t}, \quad k_i = \frac{\omega_0^2 J}{k_t}
    """
    kp = (2.0 * damping * natural_frequency * inertia - viscous) / torque_constant
    return kp, natural_frequency**2 * inertia / torque_constant


def most_bandwidth(lag: float, damping: float, lightest: float = 1.0) -> float:
    r"""Largest -3 dB bandwidth [Hz] with a phase margin of 30 deg behind a dead time; NaN where there is none.

    With :math:`\rho` the share of the inertia that is left (driven by the load, the gears' losses help):

    .. math:: x = \left(\frac{\omega_c}{\omega_0}\right)^2 = \frac{2D^2 + \sqrt{4D^4 + \rho^2}}{\rho^2}, \quad
              \varphi = \arctan(2 D \sqrt{x}) - \omega_0 \sqrt{x}\, T_\sigma
    """
    x = math.sqrt(2.0 * damping**2 + math.hypot(2.0 * damping**2, lightest)) / lightest
    left = math.atan(2.0 * damping * x) - LEAST_PHASE_MARGIN
    return left / (x * lag) / natural_frequency(1.0, damping) if left > 0.0 else math.nan


def current_lag(train: DriveTrain, kp: float, ki: float, period: float) -> float:
    """Lag of the closed current loop [s]: R/k_i, twice the small lag for the magnitude optimum [3]_."""
    if ki > 0.0:
        return train.resistance / ki
    return train.inductance / (train.resistance + kp) + LATE * period


def position_gain(velocity_lag: float) -> float:
    """Gain of the position loop [1/s] around a velocity loop with a lag [s]: both poles real and equal [4]_."""
    return 1.0 / (4.0 * velocity_lag)


def feedforward(train: DriveTrain) -> tuple[float, float, float]:
    """Feedforward gains of the current, driving: acceleration, viscous friction, Coulomb friction."""
    every, k_t = modes(train), train.torque_constant
    forward, backward = every[Regime.FORWARD_DRIVING], every[Regime.BACKWARD_DRIVING]
    return forward.inertia / k_t, train.viscous / k_t, (forward.drag - backward.drag) / 2.0 / k_t
