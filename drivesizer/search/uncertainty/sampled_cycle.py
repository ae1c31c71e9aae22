"""Load cycles of samples at the gearhead's output: ``physics.motor_demand`` with samples along the last axis.

Peaks are those of each sample's own cycle, so that every end of every segment counts, not a few extreme ones. Arrays
have the samples last, so that each step of a computation runs through memory once; of a cycle that all samples share
there is one.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import ROUNDING, SPEED, AtGearhead, CycleAtBelt, Peak, bounded

__all__ = ["AtSamples"]

Array = NDArray[np.float64]


class AtSamples(AtGearhead):
    """The load cycles of samples at the gearhead's output, behind one belt."""

    def __init__(self, base: CycleAtBelt, ratio: float) -> None:
        super().__init__(base, ratio)
        self.active = np.flatnonzero(base.acts).tolist()
        segments = {k: np.flatnonzero(base.functions[k].any(axis=(1, 2))) for k in self.active}
        self.where = {k: (int(rows[0]), int(rows[-1]) + 1) for k, rows in segments.items()}  # where each is not 0
        self.kept: tuple[Array, Array] | None = None

    def slope(self, c: Array) -> Array:
        """Half of the gradient of the mean square of c f(t), by each coefficient: shape (samples, 6)."""
        columns = np.ascontiguousarray(c.T)
        found = np.zeros_like(columns)
        for b in self.active:
            for a in self.active:
                found[b] += columns[a] * self.moments[a, b]
        return found.T

    def mean_with(self, c: Array, function: int) -> Array:
        """Mean over each sample's cycle of c f(t) times one of the functions; c of shape (samples, 6)."""
        found = np.zeros(max(len(c), self.moments.shape[-1]))
        for k in self.active:
            found += c[:, k] * self.moments[k, function]
        return found

    def line(self, c: Array) -> Array:
        """The sum c f(t) at both ends of each segment, shape (segments, 2, samples); c of shape (samples, 6)."""
        if self.kept is not None and self.kept[0] is c:
            return self.kept[1]
        functions = self.base.functions
        found = np.zeros((*functions.shape[1:3], max(len(c), functions.shape[-1])))
        term, columns = np.empty_like(found), np.ascontiguousarray(c.T)
        for k, (first, last) in self.where.items():
            found[first:last] += np.multiply(columns[k] * self.scale[k], functions[k, first:last], out=term[first:last])
        return found

    def keep(self, c: Array) -> None:
        """Compute the line of coefficients that are used several times, and hold it ready."""
        self.kept = None
        self.kept = c, self.line(c)

    def peak(self, coefficients: Array, left_out: NDArray[np.bool_] | None = None) -> Peak:
        """Largest absolute value of c f(t) over each sample's cycle; the moments are not needed."""
        line = self.line(coefficients)
        found = np.abs(line)
        if left_out is not None:
            for k in np.flatnonzero(left_out.any(axis=0)):
                one = self.base.functions[k]
                against = left_out[:, k] & (line * one < 0.0) & (np.abs(one) > ROUNDING * np.abs(one).max())
                found = np.where(against, -np.inf, found)
        found = found.reshape(-1, len(coefficients))
        value = found.max(axis=0)
        return bounded(value, np.broadcast_to(np.nan, value.shape), left_out)

    @cached_property
    def total(self) -> Array:
        """Length of each cycle [s]."""
        found: Array = self.load_cycle.total
        return found

    @cached_property
    def travel(self) -> Array:
        """Travel of the load over each cycle, there and back [m]."""
        found: Array = self.load_cycle.travel
        return found

    @cached_property
    def level(self) -> NDArray[np.bool_]:
        """Segments over which no sample changes its speed: shape (segments,)."""
        found: NDArray[np.bool_] = (self.speeds[:, 0] == self.speeds[:, 1]).all(axis=-1)
        return found

    @cached_property
    def speeds(self) -> Array:
        """Speed at the gearhead's output, at both ends of each segment [rad/s]: shape (segments, 2, samples)."""
        scaled: Array = self.base.functions[SPEED] * self.belt
        return scaled
