r"""Speed from an encoder's counts: its resolution, and the best number of periods to count over.

Counts of the last n periods over their time are a mean speed, late by n/2 periods, with a grain of one count:

.. math:: q = \frac{2\pi}{E\,n\,T}

A controller with the proportional gain k answers each grain with k q. The longer counts are taken, the finer and the
later the speed: of all n that one is best which leaves the loop fastest.

.. [1] R. C. Kavanagh, J. M. D. Murphy, "The effects of quantization noise and sensor nonideality on digital
   differentiator-based rate measurement", IEEE Trans. Instrum. Meas. 47 (1998) 1457-1463: counts over a fixed time.
.. [2] G. Ellis, *Control System Design Guide*, 4th ed., Elsevier 2012, ch. 14: encoder resolution and velocity noise.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drivesizer.physics.figures import Array

COUNT_SHARE = 0.1  # of voltage and peak current: a larger answer to one encoder count is heard (our convention)
HEAT_SHARE = 0.4  # of the nominal current: coming and going half the time, it adds (0.4/2)^2, 4 % of the nominal heat
MOST_PERIODS = 128  # over which counts are taken


class Counts(NamedTuple):
    """An encoder, and the permitted answer to one of its counts."""

    edges: int  # per turn of the motor [1]
    answer: float  # V or A, with which one count may be answered
    periods: int = 0  # over which counts are to be taken; 0: as is best

    @property
    def choice(self) -> Array:
        """Periods over which counts may be taken."""
        return np.array([float(self.periods)]) if self.periods else np.arange(1.0, MOST_PERIODS + 1.0)


def answer(volts: float, resistance: float, peak: float, nominal: float) -> float:
    """Current with which one count may be answered [A]: the least of its limits that are known.

    Parameters
    ----------
    volts, resistance
        Voltage that the motor can get [V], and its winding [ohm]: their quotient is the most that can flow.
    peak, nominal
        Peak current of the controller, nominal current of the motor [A].

    Returns
    -------
    float
        Current [A].
    """
    return float(np.nanmin([COUNT_SHARE * volts / resistance, COUNT_SHARE * peak, HEAT_SHARE * nominal]))


def speed_quantum(lines: float, period: float, periods: float = 1.0) -> float:
    """Smallest step of a speed that is counted over some periods: one of the four edges of an encoder's line [rad/s].

    Parameters
    ----------
    lines
        Of the encoder, per turn [1].
    period
        Of the controller, T [s].
    periods
        Over which counts are taken, n [1].

    Returns
    -------
    float
        Step of the speed, q [rad/s].
    """
    return 2.0 * math.pi / (4.0 * lines * period * periods)


def most_gain(counts: Counts, periods: Array, period: float) -> Array:
    """Largest permitted gain of a speed from counts [V or A per rad/s].

    Parameters
    ----------
    counts
        The encoder, and the permitted answer to one count.
    periods
        Over which counts are taken [1]: an array.
    period
        Of the controller [s].

    Returns
    -------
    array
        Gain for each number of periods [V or A per rad/s].
    """
    return np.asarray(counts.answer * counts.edges * periods * period / (2.0 * math.pi))


def lags(counts: Counts | None, period: float) -> tuple[Array, Array]:
    """Numbers of periods over which counts may be taken, and the lag of the speed then [s].

    Parameters
    ----------
    counts
        The encoder; None where the speed is exact.
    period
        Of the controller [s].

    Returns
    -------
    tuple of arrays
        Numbers of periods over which counts may be taken [1], and the lag of the speed with each [s]; 0 where it is
        exact.
    """
    if counts is None:
        return np.zeros(1), np.zeros(1)
    return counts.choice, counts.choice * period / 2.0


def shortest(bound: Array, time_constant: float) -> int:
    """The smallest number of periods that a time constant permits, by its place.

    Parameters
    ----------
    bound
        Least time constant with each number of periods [s].
    time_constant
        Time constant that is designed for [s].

    Returns
    -------
    int
        Place of the first bound that the time constant keeps.
    """
    return int(np.flatnonzero(bound <= time_constant * (1.0 + 1e-9))[0])
