"""How long the battery lasts, sample by sample, and what it is asked for at most: autonomy, range, peak power.

As ``energy_budget`` has it for one set: the drive draws by its load cycle, the equipment by its share of the time, the
run time is that of the mean power. Not here: voltages under load, which stay at nominal figures.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import isnan, nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.battery import current_of_power, largest_power
from drivesizer.battery_pack import Pack, pack_of, run_time
from drivesizer.catalog import Catalog
from drivesizer.checks import CheckColumn, at_least, at_most
from drivesizer.energy_checks import required_autonomy
from drivesizer.machines import WheeledVehicle
from drivesizer.physics_limits import Parts
from drivesizer.spec import RobotSpec
from drivesizer.tolerances.behind import AtSamples
from drivesizer.wheel_load import WheelLoad
from drivesizer.yaml_source import Path_

__all__ = ["SAMPLED", "Draw", "Feeding", "battery_limits", "feeding"]

Array = NDArray[np.float64]
SAMPLED = ("battery_autonomy", "battery_range", "battery_power", "battery_peak_current")


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
    lasts = full * feeds.pack.usable
    speed = _way(spec, at) / total if feeds.travels else np.full_like(total, nan)
    found, battery = [], spec.battery
    required = required_autonomy(spec, battery)
    if not isnan(required):
        found.append(at_least("battery_autonomy", required, lasts, "time", "h", needed=battery.reserve))
    if battery.range is not None:
        found.append(at_least("battery_range", battery.range, speed * lasts, "length", "km", needed=battery.reserve))
    if len(draws) > 1:
        return found
    along = nan if battery.range is None else battery.range / speed
    drawn_share = np.fmax(required, along) / full
    left = 1.0 - np.minimum(np.where(np.isnan(drawn_share), feeds.pack.usable, drawn_share), feeds.pack.usable)
    return [*found, *_at_the_peak(spec, feeds, left, np.maximum(draws[0].peak, 0.0) / loss + feeds.peak)]


def _way(spec: Any, at: AtSamples) -> Any:
    """How far the machine goes in a cycle [m]."""
    return spec.load.way if isinstance(spec.load, WheelLoad) else at.sampled.scalars["way"]


def _at_the_peak(spec: Any, feeds: Feeding, left: Array, peak: Array) -> list[CheckColumn]:
    """Whether the battery gives the largest power at what is left of its charge."""
    pack = feeds.pack
    emf = pack.emf(left)  # type: ignore[arg-type]
    current = current_of_power(peak, emf, pack.resistance)
    power = at_most("battery_power", peak, largest_power(emf, pack.resistance), "power", "W")
    return [
        power if pack.rests else replace(power, passed=power.passed & False),
        at_most("battery_peak_current", current, pack.peak_current, "current", "A", needed=spec.margins.torque),
    ]
