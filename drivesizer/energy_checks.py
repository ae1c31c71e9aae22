"""A battery's demands against its limits: autonomy, range, voltage, currents. Margins are made in ``checks``."""

from __future__ import annotations

from dataclasses import replace
from math import nan
from typing import Any, NamedTuple

import numpy as np

from drivesizer.battery import current_of_power, largest_power
from drivesizer.battery_pack import Pack
from drivesizer.battery_schema import Battery
from drivesizer.checked import Check
from drivesizer.checks import CheckColumn, at_least, at_most
from drivesizer.spec import RobotSpec

__all__ = ["Load", "battery_checks", "battery_columns", "required_autonomy"]

_AT_REST = ("battery_power", "battery_voltage", "battery_cutoff")


class Load(NamedTuple):
    """What a battery is asked for; NaN is unknown. Figures, or columns over samples."""

    mean: Any  # W
    peak: Any  # W
    rms: float  # W
    back: float  # W into the battery, at most
    way: Any  # m/s, mean
    full: Any = nan  # s, until all of its charge is drawn
    required: float = nan  # s that it must last; also where nothing is required
    charge: Any = nan  # share left at the end
    lowest: Any = nan  # V at the terminals


def required_autonomy(spec: RobotSpec, given: Battery) -> Any:
    """How long a battery must last [s]: as its section says, else the mission; NaN where neither is given."""
    mission = spec.mission.duration if spec.mission else nan
    return mission if given.autonomy is None else given.autonomy


def battery_checks(spec: RobotSpec, given: Battery, pack: Pack, load: Load) -> tuple[Check, ...]:
    """Every limit of a battery, in the order in which people read them.

    Parameters
    ----------
    spec
        The machine: its supply's voltages and its margins.
    given
        The spec's section: what is required, and the reserve.
    pack, load
        What there is, and what it is asked for.
    """
    return tuple(column.at((), "budget") for column in battery_columns(spec, given, pack, load))


def battery_columns(spec: Any, given: Battery, pack: Pack, load: Any) -> tuple[CheckColumn, ...]:
    """The same before they are records: single figures, or columns where the figures of spec and load are columns."""
    return (*_lasting(spec, given, pack, load), *_voltages(spec, pack, load), *_currents(spec, pack, load))


def _lasting(spec: RobotSpec, given: Battery, pack: Pack, load: Load) -> list[CheckColumn]:
    """Autonomy and range, where some is required."""
    lasts = load.full * pack.usable
    required, found = required_autonomy(spec, given), []
    if not np.isnan(required).all():
        found.append(at_least("battery_autonomy", required, lasts, "time", "h", needed=given.reserve))
    if given.range is not None:
        found.append(at_least("battery_range", given.range, load.way * lasts, "length", "km", needed=given.reserve))
    return found


def _voltages(spec: RobotSpec, pack: Pack, load: Load) -> list[CheckColumn]:
    """What the drive was sized for: the supply's lowest and highest voltage."""
    emf = pack.emf(load.charge)
    found = [
        at_most("battery_power", load.peak, largest_power(emf, pack.resistance), "power", "W"),
        at_least("battery_voltage", spec.supply.lowest, load.lowest, "voltage", "V"),
        at_least("battery_cutoff", pack.cutoff_voltage, load.lowest, "voltage", "V"),
        at_most("battery_charge_voltage", pack.charge_voltage, spec.supply.highest, "voltage", "V", by_choice=True),
    ]
    return found if pack.rests else [_doubted(check) if check.name in _AT_REST else check for check in found]


def _doubted(check: CheckColumn) -> CheckColumn:
    """The check with the nominal voltage for that at rest, which is less in the end: it may fail but not pass."""
    note = "voltage at rest unknown: give open_circuit"
    return replace(check, passed=check.passed & False, note="" if np.all(check.failed) else note)


def _currents(spec: RobotSpec, pack: Pack, load: Load) -> list[CheckColumn]:
    grip = spec.margins.torque
    emf = pack.emf(load.charge)
    peak = current_of_power(load.peak, emf, pack.resistance)
    back = -current_of_power(-load.back, emf, pack.resistance) if load.back else 0.0
    rows = (
        ("battery_continuous_current", load.rms / pack.mean_voltage, pack.continuous_current),
        ("battery_peak_current", peak, pack.peak_current),
        ("battery_charge_current", back, pack.max_charge_current),
    )
    return [at_most(name, demand, limit, "current", "A", needed=grip) for name, demand, limit in rows]
