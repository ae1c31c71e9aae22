"""Records of the linear analysis of a closed loop; NaN where a figure does not exist."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan

import numpy as np
from numpy.typing import NDArray

__all__ = ["Bode", "Loop", "Loops"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Bode:
    """Frequency response of a loop."""

    frequency: NDArray[np.float64]  # Hz
    open_magnitude: NDArray[np.float64]
    open_phase: NDArray[np.float64]  # rad
    closed_magnitude: NDArray[np.float64]
    closed_phase: NDArray[np.float64]  # rad


@dataclass(frozen=True, slots=True, kw_only=True)
class Loop:
    """A linear, sampled loop without its limits; an unstable one has no margins."""

    name: str
    direction: str  # of power: the one nearer to instability; "" where it has no influence
    period: float  # s
    stable: bool
    pole_radius: float  # largest modulus of the closed loop's poles; below 1 is stable
    poles: tuple[complex, ...]  # z plane
    gain_margin: float  # factor
    gain_reduction: float  # factor below 1 down to which the gain may be reduced; NaN: to any
    phase_margin: float  # rad
    crossover: float  # Hz, where the phase margin of this direction is
    sensitivity: float  # largest |1/(1 + L)|, the reciprocal of the distance to -1 [1]
    bandwidth: float  # Hz, -3 dB of the response to the reference
    rise_time: float  # s, 10-90 %
    overshoot: float  # share of the step
    settling_time: float  # s, to 2 %
    step: NDArray[np.float64]  # the response to a step, sampled; empty where the loop is unstable
    bode: Bode


@dataclass(frozen=True, slots=True, kw_only=True)
class Loops:
    """The loops of a controller, and the frequencies of an elastic shaft."""

    current: Loop | None = None  # None: the velocity loop acts on the voltage
    velocity: Loop
    position: Loop | None = None
    resonance: float = nan  # Hz
    anti_resonance: float = nan  # Hz
    rigid_bandwidth: float = nan  # Hz, that the velocity loop would have with a stiff shaft

    @property
    def all(self) -> tuple[Loop, ...]:
        """The loops that exist, from the inside out."""
        return tuple(loop for loop in (self.current, self.velocity, self.position) if loop is not None)
