"""Voltage, power and energy of windings whose resistance hangs on how warm they are at each moment.

Of a short cycle over all segments at once, of a long one part by part (``long_waveform``).
Symbols: R resistance [ohm], I current [A], T temperature [K].
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import Peak
from drivesizer.physics.extremes import first_largest
from drivesizer.physics.power_stage import Feed, of_the_source, source_energy, source_power
from drivesizer.physics.thermal import resistance_at
from drivesizer.physics.waveform import Energy, Wave, balanced, mean_square
from drivesizer.search.columns.long_waveform import energy_of_source, first_of, in_parts, near_power, near_values

__all__ = ["Resisted", "energy_over_time", "largest_voltage", "most_power"]

Array = NDArray[np.float64]
_Balancing = tuple[Wave, Array, Array]  # what ``waveform.balanced`` takes


class Resisted:
    """A waveform without the voltage of the resistance, and the temperatures of its windings."""

    def __init__(self, flows: Wave, R_25: Array, ends: Array, means: Array, surplus: Array, speed: Array) -> None:
        """Temperatures at the ends of the pieces and over each [K], one or of each piece; see ``waveform.balanced``."""
        self.flows, self.R_25, self.ends, self.means = flows, R_25, ends, means
        self.surplus, self.speed = surplus, speed
        self.parts = in_parts(len(flows.duration))
        self.one = self.parts[0] if len(self.parts) == 1 else None

    def at_ends(self, k: slice) -> _Balancing:
        """Some pieces with the resistance at their ends."""
        return self._with(k, resistance_at(self.R_25[:, None, None], _some(self.ends, k, -2)))

    def mean(self, k: slice) -> _Balancing:
        """Some pieces with the mean resistance of each."""
        return self._with(k, np.asarray(self._means(k))[:, :, None])

    @cached_property
    def lost(self) -> Array:
        """Heat of the winding over each piece [W]."""
        found = [self._means(k) * mean_square(self._flowing(k)) for k in self.parts]
        return found[0] if self.one else np.concatenate(found, axis=1)

    def _means(self, k: slice) -> Any:
        return resistance_at(self.R_25[:, None], _some(self.means, k, -1))

    def _flowing(self, k: slice) -> Wave:
        return Wave(self.flows.duration[k], self.flows.current[:, k], self.flows.voltage[:, k])

    def _with(self, k: slice, R: Any) -> _Balancing:
        some = self._flowing(k)
        return some._replace(voltage=some.voltage + R * some.current), self.surplus, self.speed[..., k, :]


def _some(T: Array, k: slice, axis: int) -> Array:
    """Temperatures of some pieces, or the one that all have."""
    return T if T.shape[axis] == 1 else T[:, k]


def largest_voltage(at: Resisted, cold: Peak, leads: Array | None) -> Peak:
    """Largest absolute voltage and when: warm, or cold at the start; with that over ``leads`` where it is more.

    Parameters
    ----------
    at
        Waveform and windings of the candidates.
    cold
        Largest voltage of a cold winding [V].
    leads
        Resistances before the windings [ohm]; None: none.

    Returns
    -------
    Peak
        Of each candidate [V].
    """
    ends, duration = np.cumsum(at.flows.duration), at.flows.duration

    def moments(k: slice) -> tuple[Array, Array]:
        some = at.at_ends(k)[0]
        volts = np.abs(some.voltage)
        if leads is not None:
            volts = np.maximum(volts, np.abs(some.voltage + np.reshape(leads, (-1, 1, 1)) * some.current))
        time = np.stack([ends[k] - duration[k], ends[k]], axis=1).ravel()
        return volts.reshape(len(volts), len(time)), time

    if at.one:
        volts, times = moments(at.one)
        value, worst = first_largest(volts)
        time = times[worst]
    else:
        value, time = first_of([near_values(*moments(k)) for k in at.parts], len(at.R_25))
    colder = cold.value > value
    return Peak(np.where(colder, cold.value, value), np.where(colder, cold.time, time))


def most_power(at: Resisted, feed: Feed) -> tuple[Array, Array]:
    """Largest power out of the source, and when.

    Parameters
    ----------
    at
        Waveform and windings of the candidates.
    feed
        Their stages and supply.

    Returns
    -------
    tuple of arrays
        Power [W] and time [s], of each candidate.
    """
    if at.one:
        return source_power(balanced(*at.at_ends(at.one)), feed)
    start = np.cumsum(at.flows.duration) - at.flows.duration
    near = [near_power(balanced(*at.at_ends(k)), feed.stage, float(start[k.start])) for k in at.parts]
    power, when = first_of(near, len(at.R_25))
    return of_the_source(power + feed.stage.standby, feed), when


def energy_over_time(at: Resisted, feed: Feed, kept: Any, *, storing: bool) -> Energy:
    """Energy out of the source and what is returned, over one cycle.

    Parameters
    ----------
    at
        Waveform and windings of the candidates.
    feed, kept, storing
        As ``power_stage.source_energy`` takes them.

    Returns
    -------
    Energy
        Of each candidate [J].
    """
    if at.one:
        return source_energy(balanced(*at.mean(at.one)), feed, kept, storing=storing)
    return energy_of_source((balanced(*at.mean(k)) for k in at.parts), feed, kept, storing=storing)
