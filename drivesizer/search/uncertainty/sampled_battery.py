"""Battery of a drive over samples: autonomy, range, peak power and voltage.

As ``energy_budget`` has it for one set: the drive draws by its load cycle, the equipment by its share of the time,
the run time is that of the mean power. Not here: continuous current, current and voltage of charging, and the
voltage of polarisation.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.machine.battery import Pack, drawn_columns, load_of, pack_of
from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.check_kinds import BATTERY_LASTING, BATTERY_SAMPLED, BATTERY_VOLTAGES
from drivesizer.search.columns.limits_over_time import Draw
from drivesizer.spec.robot import RobotSpec

if TYPE_CHECKING:
    from drivesizer.spec.battery import Battery


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
