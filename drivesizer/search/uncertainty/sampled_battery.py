"""Autonomy, range, peak power and voltage of the battery, sample by sample.

As ``energy_budget`` has it for one set: the drive draws by its load cycle, the equipment by its share of the time, the
run time is that of the mean power. Not here: continuous current, current and voltage of charging, and
the voltage of polarisation.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import nan
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.machine.battery_checks import Load, drawn_columns, required_autonomy
from drivesizer.machine.battery_pack import Pack, pack_of, run_time
from drivesizer.physics.battery import current_of_power, terminal_voltage
from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.check_kinds import BATTERY_LASTING, BATTERY_SAMPLED, BATTERY_VOLTAGES
from drivesizer.search.uncertainty.sampled_cycle import AtSamples
from drivesizer.spec.robot import RobotSpec

if TYPE_CHECKING:
    from drivesizer.spec.battery import Battery

__all__ = ["Draw", "Feeding", "battery_limits", "columns_of", "feeding"]

Array = NDArray[np.float64]


class Feeding(NamedTuple):
    """A battery and the equipment that draws from it, of samples."""

    pack: Pack
    charge: Any  # of the battery over its nominal one
    mean: Any  # W, of the equipment
    peak: Any  # W
    travels: bool


class Draw(NamedTuple):
    """Energy out of the source and returned over a cycle by the drives of a load case together [J]; peak power [W]."""

    drawn: Array
    returned: Array
    peak: Array


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
    total = at.total
    speed = _travel(spec, at) / total if feeds.travels else np.full_like(total, nan)
    return columns_of(spec, feeds, total, speed, draws)


def columns_of(spec: Any, feeds: Feeding, total: Any, speed: Any, draws: Sequence[Draw]) -> list[CheckColumn]:
    """Autonomy, range, peak and voltage, from figures of the cycle."""
    share = spec.supply.regeneration
    drawn, returned = (sum(getattr(one, name) for one in draws) for name in ("drawn", "returned"))
    slip = spec.platform.slip if spec.platform else 0.0
    mean = (drawn / (1.0 - slip) - share * returned) / total + feeds.mean
    full = np.asarray(run_time(feeds.pack, mean / feeds.charge))  # of so many parallel strings
    required, distance = required_autonomy(spec, spec.battery), spec.battery.range
    required = np.fmax(required, nan if distance is None else distance / speed)
    drawn_share = np.where(np.isnan(required), feeds.pack.available, required / full)
    left = feeds.pack.start - np.minimum(drawn_share, feeds.pack.available)
    peak = np.maximum(draws[0].peak, 0.0) / (1.0 - slip) + feeds.peak
    emf, resistance = feeds.pack.emf(left), feeds.pack.resistance
    lowest = terminal_voltage(current_of_power(peak, emf, resistance), emf, resistance)
    load = Load(mean=mean, peak=peak, rms=nan, back=nan, speed=speed, full=full, charge=left, lowest=lowest)
    checked = {*BATTERY_LASTING} if len(draws) > 1 else {*BATTERY_SAMPLED}
    checked -= {*BATTERY_VOLTAGES} if feeds.pack.polarisation else set()
    return [check for check in drawn_columns(spec, spec.battery, feeds.pack, load) if check.name in checked]


def _travel(spec: Any, at: AtSamples) -> Any:
    """Distance that the machine travels in a cycle [m]."""
    return spec.load.distance if spec.load.is_wheel else at.travel
