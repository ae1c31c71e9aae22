"""How long the battery lasts, sample by sample, and what it is asked for at most: autonomy, range, peak power.

As ``energy_budget`` has it for one set: the drive draws by its load cycle, the equipment by its share of the time, the
run time is that of the mean power. Not here: voltages under load, which stay at nominal figures.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.battery_pack import Pack, pack_of, run_time
from drivesizer.catalog import Catalog
from drivesizer.checks import CheckColumn
from drivesizer.energy_checks import Load, battery_columns, required_autonomy
from drivesizer.machines import WheeledVehicle
from drivesizer.physics_limits import Parts
from drivesizer.spec import RobotSpec
from drivesizer.tolerances.behind import AtSamples
from drivesizer.wheel_load import WheelLoad
from drivesizer.yaml_source import Path_

__all__ = ["SAMPLED", "Draw", "Feeding", "battery_limits", "feeding"]

Array = NDArray[np.float64]
_LASTING = ("battery_autonomy", "battery_range")
SAMPLED = (*_LASTING, "battery_power", "battery_peak_current")


class Feeding(NamedTuple):
    """A battery and what else draws from it, of samples."""

    pack: Pack
    charge: Any  # of the battery over its nominal one
    mean: Any  # W, of the equipment
    peak: Any  # W
    travels: bool


class Draw(NamedTuple):
    """What the motor sets of a load case draw and give back over a cycle, together [J], and at most [W]."""

    drawn: Array
    returned: Array
    peak: Array


def feeding(spec: RobotSpec, catalog: Catalog, ratios: Mapping[Path_, Array]) -> Feeding | None:
    """The battery of a spec; None without one.

    Parameters
    ----------
    spec, catalog
        The machine, and where the battery's part is listed.
    ratios
        Sampled figures over their nominal ones, by their place in the spec.
    """
    if spec.battery is None:
        return None
    pack = pack_of(spec.battery, catalog)
    charge = ratios.get(("battery", "capacity"), 1.0) * ratios.get(("battery", "health"), 1.0)
    mission = spec.mission.duration if spec.mission else None
    mean: Any = 0.0
    peak: Any = 0.0
    for number, one in enumerate(spec.equipment):
        each = one.number / one.efficiency / ratios.get(("equipment", number, "efficiency"), 1.0)
        steady = one.power * ratios.get(("equipment", number, "power"), 1.0)
        mean = mean + each * steady * one.share(mission)
        most = one.peak_power * ratios.get(("equipment", number, "peak_power"), 1.0) if one.peak_power else steady
        peak = peak + each * most
    return Feeding(pack, charge, mean, peak, isinstance(spec.load, WheeledVehicle | WheelLoad))


def battery_limits(spec: Any, feeds: Feeding, at: AtSamples, draws: Sequence[Draw], parts: Parts) -> list[CheckColumn]:
    """Autonomy, range and peak of the battery, as far as they are required.

    Parameters
    ----------
    spec
        With columns.
    feeds
        The battery.
    at
        The load cycles.
    draws
        Of the load case; of a platform on its way of each wheel. Their peaks need not fall together, so those of
        several are not judged.
    parts
        The set's.
    """
    share, known = spec.supply.regeneration, parts.controller["max_efficiency"]
    loss = np.where(np.isnan(known), 1.0, known)
    total = at.sampled.duration.sum(axis=0)
    drawn, returned = (sum(getattr(one, name) for one in draws) for name in ("drawn", "returned"))
    mean = (drawn / loss - share * returned * loss) / total + feeds.mean
    full = np.asarray(run_time(feeds.pack, mean / feeds.charge))  # as so many strings side by side
    speed = _way(spec, at) / total if feeds.travels else np.full_like(total, nan)
    required, way = required_autonomy(spec, spec.battery), spec.battery.range
    drawn_share = np.fmax(required, nan if way is None else way / speed) / full
    left = 1.0 - np.minimum(np.where(np.isnan(drawn_share), feeds.pack.usable, drawn_share), feeds.pack.usable)
    peak = np.maximum(draws[0].peak, 0.0) / loss + feeds.peak
    load = Load(mean=mean, peak=peak, rms=nan, back=nan, way=speed, full=full, charge=left)
    judged = SAMPLED if len(draws) == 1 else _LASTING
    return [check for check in battery_columns(spec, spec.battery, feeds.pack, load) if check.name in judged]


def _way(spec: Any, at: AtSamples) -> Any:
    """How far the machine goes in a cycle [m]."""
    return spec.load.way if isinstance(spec.load, WheelLoad) else at.sampled.scalars["way"]
