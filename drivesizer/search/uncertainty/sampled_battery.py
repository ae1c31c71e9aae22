"""Load cycles and battery of a drive over samples: torque at the motor, autonomy, range, peak power and voltage."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from math import nan
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.machine.battery import Pack, drawn_columns, load_of, pack_of
from drivesizer.physics.cycle_at_gearhead import ROUNDING, SPEED, AtGearhead, CycleAtBelt, Peak, bounded
from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.check_kinds import BATTERY_LASTING, BATTERY_SAMPLED, BATTERY_VOLTAGES
from drivesizer.search.columns.steppers import Draw
from drivesizer.spec.robot import RobotSpec

if TYPE_CHECKING:
    from drivesizer.spec.battery import Battery


# -- Load cycles of samples at the gearhead's output: ``physics.motor_demand`` with samples along the last axis.
#
# Peaks are those of each sample's own cycle, so that every end of every segment counts, not a few extreme ones.
# Arrays have the samples last, so that each step of a computation runs through memory once; of a cycle that all
# samples share there is one.


Array = NDArray[np.float64]


class AtSamples(AtGearhead):
    """The load cycles of samples at the gearhead's output, behind one belt."""

    def __init__(self, base: CycleAtBelt, ratio: float) -> None:
        super().__init__(base, ratio)
        self.active = np.flatnonzero(base.acts).tolist()
        segments = {k: np.flatnonzero(base.functions[k].any(axis=(1, 2))) for k in self.active}
        self.where = {k: (int(rows[0]), int(rows[-1]) + 1) for k, rows in segments.items()}  # where each is not 0

    def slope(self, c: Array) -> Array:
        """Half of the gradient of the mean square of c f(t), by each coefficient: shape (samples, 6)."""
        columns = np.ascontiguousarray(c.T)
        found = np.zeros_like(columns)
        for b in self.active:
            for a in self.active:
                found[b] += columns[a] * self.moment(a, b)
        return found.T

    def mean_with(self, c: Array, function: int) -> Array:
        """Mean over each sample's cycle of c f(t) times one of the functions; c of shape (samples, 6)."""
        found = np.zeros(max(len(c), self.base.moments.shape[-1]))
        for k in self.active:
            found += c[:, k] * self.moment(k, function)
        return found

    def line(self, c: Array) -> Array:
        """The sum c f(t) at both ends of each segment, shape (segments, 2, samples); c of shape (samples, 6)."""
        functions = self.base.functions
        found = np.zeros((*functions.shape[1:3], max(len(c), functions.shape[-1])))
        term, columns = np.empty_like(found), np.ascontiguousarray(c.T)
        for k, (first, last) in self.where.items():
            found[first:last] += np.multiply(columns[k] * self.scale[k], functions[k, first:last], out=term[first:last])
        return found

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
    def travel(self) -> Array:
        """Travel of the load over each cycle, there and back [m]."""
        cycle = self.load_cycle
        found: Array = cycle.radius * (np.abs(cycle.speed).mean(axis=1) * cycle.duration).sum(axis=0)
        return found

    @cached_property
    def speeds(self) -> Array:
        """Speed at the gearhead's output, at both ends of each segment [rad/s]: shape (segments, 2, samples)."""
        scaled: Array = self.base.functions[SPEED] * self.belt
        return scaled


# -- Autonomy, range, peak power and voltage of the battery, sample by sample.
#
# As ``energy_budget`` has it for one set: the drive draws by its load cycle, the equipment by its share of the time,
# the run time is that of the mean power. Not here: continuous current, current and voltage of charging, and the
# voltage of polarisation.


class Feeding(NamedTuple):
    """A battery and the equipment that draws from it, of samples."""

    pack: Pack
    charge: Any  # of the battery over its nominal one
    mean: Any  # W, of the equipment
    peak: Any  # W
    travels: bool


def feeding(spec: RobotSpec, rated: Battery, catalog: Catalog) -> Feeding:
    """The battery of a machine, and what the equipment draws from it."""
    given = spec.battery
    assert given is not None
    charge: Any = 1.0
    for name in ("capacity", "health"):
        if name in given.model_fields_set:
            charge = charge * (getattr(given, name) / getattr(rated, name))
            given = given.model_copy(update={name: getattr(rated, name)})
    mission = spec.mission.duration if spec.mission else None
    drawn = [one.drawn(mission) for one in spec.equipment]
    mean, peak = (sum(powers) for powers in zip(*drawn, strict=True)) if drawn else (0.0, 0.0)
    on_wheels = spec.load.is_wheel or isinstance(spec.load, WheeledVehicle)
    return Feeding(pack_of(given, catalog), charge, mean, peak, on_wheels)


def battery_limits(spec: Any, feeds: Feeding, at: AtSamples, draws: Sequence[Draw]) -> list[CheckColumn]:
    """Autonomy, range, peak and voltage of the battery, as far as they are required."""
    total = at.load_cycle.total
    travel = spec.load.distance if spec.load.is_wheel else at.travel
    speed = travel / total if feeds.travels else np.full_like(total, nan)
    return columns_of(spec, feeds, total, speed, draws)


def columns_of(spec: Any, feeds: Feeding, total: Any, speed: Any, draws: Sequence[Draw]) -> list[CheckColumn]:
    """Autonomy, range, peak and voltage, from figures of the cycle."""
    share = spec.supply.regeneration
    drawn, returned = (sum(getattr(one, name) for one in draws) for name in ("drawn", "returned"))
    slip = spec.platform.slip if spec.platform else 0.0
    mean = (drawn / (1.0 - slip) - share * returned) / total + feeds.mean
    peak = np.maximum(draws[0].peak, 0.0) / (1.0 - slip) + feeds.peak
    load = load_of(spec, spec.battery, feeds.pack, mean, peak, speed, feeds.charge)  # of so many parallel strings
    checked = {*BATTERY_LASTING} if len(draws) > 1 else {*BATTERY_SAMPLED}
    checked -= {*BATTERY_VOLTAGES} if feeds.pack.polarisation else set()
    return [check for check in drawn_columns(spec, spec.battery, feeds.pack, load) if check.name in checked]
