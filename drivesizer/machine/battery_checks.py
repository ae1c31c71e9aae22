"""A battery's demands against its limits: autonomy, range, voltage, currents. Margins are made in ``checks``.

Regenerated power charges the battery: its largest value with the charge of the start makes the highest voltage,
V = E + R I. That is held against the voltage at which a charge ends and against the supply's highest, at which the
drive was judged: where the battery keeps below that, so does the bus (``limits_over_time``).
"""

from __future__ import annotations

from dataclasses import replace
from math import inf, nan
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from drivesizer.machine.battery_pack import Pack
from drivesizer.physics.battery import current_of_power, largest_power, terminal_voltage
from drivesizer.results.check import Check
from drivesizer.results.check_columns import CheckColumn, at_least, at_most
from drivesizer.spec.robot import RobotSpec

if TYPE_CHECKING:
    from drivesizer.spec.battery import Battery

__all__ = [
    "Load",
    "accepted",
    "battery_checks",
    "battery_columns",
    "charging",
    "drawn_columns",
    "raised_voltage",
    "required_autonomy",
    "resting_voltage",
]  # fmt: skip

_RESISTED = "unknown: how far regenerated power raises the voltage: give the resistance"
_AT_REST = ("battery_power", "battery_voltage", "battery_cutoff", "battery_overcharge", "battery_return_voltage")


class Load(NamedTuple):
    """The load of a battery; NaN is unknown. Figures, or columns over samples."""

    mean: Any  # W
    peak: Any  # W
    rms: float  # W
    back: float  # W into the battery, at most
    speed: Any  # m/s, mean
    full: Any = nan  # s, until all of its charge is drawn
    required: float = nan  # s that it must last; also where nothing is required
    charge: Any = nan  # share left at the end
    lowest: Any = nan  # V at the terminals
    highest: Any = nan  # V there, at the largest return


def required_autonomy(spec: RobotSpec, section: Battery) -> Any:
    """Time that a battery must last: the autonomy of its section, else the mission."""
    mission = spec.mission.duration if spec.mission else nan
    return mission if section.autonomy is None else section.autonomy


def battery_checks(spec: RobotSpec, section: Battery, pack: Pack, load: Load) -> tuple[Check, ...]:
    """Every limit of a battery, in the order in which people read them."""
    return tuple(column.at((), "budget") for column in battery_columns(spec, section, pack, load))


def battery_columns(spec: Any, section: Battery, pack: Pack, load: Any) -> tuple[CheckColumn, ...]:
    """The same before they are records: single figures, or columns where the figures of spec and load are columns."""
    *raised, current = charging(spec, pack, load)
    checks = (*_lasting(spec, section, pack, load), *_voltages(spec, pack, load), *raised, *_room(pack, load))
    return (*checks, *_currents(spec, pack, load), *_charger(section, pack), current)


def drawn_columns(spec: Any, section: Battery, pack: Pack, load: Any) -> tuple[CheckColumn, ...]:
    """Those of what is drawn alone, whatever is regenerated."""
    return (*_lasting(spec, section, pack, load), *_voltages(spec, pack, load), *_currents(spec, pack, load))


def accepted(spec: Any) -> Any:
    """Share of regenerated power that goes into the battery; what of it is not stored is lost inside."""
    return 1.0 if spec.accepts_all else spec.supply.regeneration


def resting_voltage(pack: Pack, mean: Any) -> Any:
    """Highest voltage at rest: that of the start, or of a full battery where more is regenerated than drawn."""
    return pack.emf(np.where(np.asarray(mean) < 0.0, 1.0, pack.start))[()]


def raised_voltage(pack: Pack, back: Any, emf: Any) -> Any:
    """Voltage at the terminals while power is regenerated [V]: E + R I; E where none does, whatever the resistance."""
    raised = terminal_voltage(-_returned_current(pack, back, emf), emf, pack.resistance)
    return np.where(np.asarray(back) == 0.0, emf, raised)[()]


def _returned_current(pack: Pack, back: Any, emf: Any) -> Any:
    """Current into the battery [A]: the root of R I^2 + E I = P that is not negative."""
    return np.where(np.asarray(back) == 0.0, 0.0, -current_of_power(-np.asarray(back), emf, pack.resistance))[()]


def charging(spec: Any, pack: Pack, load: Load) -> tuple[CheckColumn, ...]:
    """Highest voltage and charge current, from the largest regenerated power; without any no limit applies.

    The margin to the voltage at which a charge ends counts from the voltage at rest: by so much the current may grow.
    """
    rest, lacking = resting_voltage(pack, load.mean), _RESISTED if np.isnan(pack.resistance).all() else ""
    zero = np.where((np.asarray(load.back) == 0.0) | (np.asarray(load.highest) > rest), rest, 0.0)[()]
    over = at_most("battery_overcharge", load.highest, pack.charge_voltage, zero=zero, undecided=lacking)
    bus = at_most("battery_return_voltage", load.highest, spec.supply.highest, undecided=lacking)
    current = _returned_current(pack, load.back, pack.emf(load.charge))
    grip = spec.margins.torque
    into = at_most("battery_charge_current", current, pack.max_charge_current, needed=grip)
    return _known_at_rest(pack, over), _known_at_rest(pack, bus), into


def _room(pack: Pack, load: Load) -> list[CheckColumn]:
    """Whether regenerated power beyond what is drawn finds room, where the load gives more than it takes."""
    if not np.any(np.asarray(load.mean) < 0.0):
        return []
    time = np.where(np.isnan(load.required), inf, load.required)
    more = np.where(np.asarray(load.mean) < 0.0, -np.asarray(load.mean) * time / pack.mean_voltage, 0.0)
    room = (1.0 - pack.start) * pack.health * pack.capacity
    return [at_most("battery_room", more, room)]


def _lasting(spec: RobotSpec, section: Battery, pack: Pack, load: Load) -> list[CheckColumn]:
    """Autonomy and range, where some is required."""
    lasts = load.full * pack.available
    required, found = required_autonomy(spec, section), []
    if not np.isnan(required).all():
        found.append(at_least("battery_autonomy", required, lasts, needed=section.reserve))
    if section.range is not None:
        found.append(at_least("battery_range", section.range, load.speed * lasts, needed=section.reserve))
    return found


def _voltages(spec: RobotSpec, pack: Pack, load: Load) -> list[CheckColumn]:
    """Limits of the supply that the drive was sized for: its lowest and highest voltage."""
    emf = pack.emf(load.charge)
    found = [
        at_most("battery_power", load.peak, largest_power(emf, pack.resistance)),
        at_least("battery_voltage", spec.supply.lowest, load.lowest),
        at_least("battery_cutoff", pack.cutoff_voltage, load.lowest),
        at_most("battery_charge_voltage", pack.charge_voltage, spec.supply.highest, by_choice=True),
    ]
    return [_known_at_rest(pack, check) for check in found]


def _known_at_rest(pack: Pack, check: CheckColumn) -> CheckColumn:
    return check if pack.rests or check.name not in _AT_REST else _doubted(check)


def _doubted(check: CheckColumn) -> CheckColumn:
    """The check with the nominal voltage for that at rest, which is less in the end and more at the start.

    It may fail but not pass, but for a demand of nothing.
    """
    note = "voltage at rest unknown: give open_circuit"
    idle = check.passed & (check.demand == check.zero)
    return replace(check, passed=idle, note="" if np.all(check.failed | idle) else note)


def _charger(section: Battery, pack: Pack) -> list[CheckColumn]:
    """Current of the charger, where there is one."""
    if section.charger is None:
        return []
    return [at_most("battery_charger_current", section.charger.current, pack.max_charge_current)]


def _currents(spec: RobotSpec, pack: Pack, load: Load) -> list[CheckColumn]:
    grip = spec.margins.torque
    emf = pack.emf(load.charge)
    peak = current_of_power(load.peak, emf, pack.resistance)
    rows = (
        ("battery_continuous_current", load.rms / pack.mean_voltage, pack.continuous_current),
        ("battery_peak_current", peak, pack.peak_current),
    )
    return [at_most(name, demand, limit, needed=grip) for name, demand, limit in rows]
