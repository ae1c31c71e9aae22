"""A battery out of a catalogue and the spec, and its demands against its limits: autonomy, range, voltage, currents."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil, inf, isnan, nan
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer import catalog as parts
from drivesizer.catalog import Catalog
from drivesizer.errors import InputError, nearest, quoted
from drivesizer.physics.battery import (
    capacity_for,
    current_of_power,
    largest_power,
    peukert_time,
    table_draw,
    table_time,
    terminal_voltage,
)
from drivesizer.results.check import Check
from drivesizer.results.check_columns import CheckColumn, at_least, at_most
from drivesizer.spec.robot import RobotSpec

if TYPE_CHECKING:
    from drivesizer.spec.battery import Battery

__all__ = [
    "Load", "Pack", "accepted", "battery_checks", "capacity_needed", "charging", "drawn_columns", "lacking", "pack_of",
    "raised_voltage", "required_autonomy", "resting_voltage", "run_time", "strings_needed",
]  # fmt: skip


# -- A battery of several cells or blocks, out of a catalogue and the spec: its figures, and how long it lasts.


_ONE = (  # figures of one cell or block that spec and catalogue share
    "nominal_voltage", "charge_voltage", "cutoff_voltage", "capacity", "rated_time", "peukert_exponent", "resistance",
    "continuous_current", "peak_current", "max_charge_current",
)  # fmt: skip
_OWN = {"capacity", "rated_time", "peukert_exponent", "discharge"}  # with one of them the catalogue's table is not used
_NEARLY = 1e-9  # relative: the same end voltage


@dataclass(frozen=True, slots=True)
class Table:
    """Constant draws of a whole battery and how long they last."""

    held: str  # current or power
    draw: NDArray[np.float64]  # A or W
    time: NDArray[np.float64]  # s
    cutoff_voltage: float  # V of the battery, at which it ends; NaN where it is not said


@dataclass(frozen=True, slots=True, kw_only=True)
class Pack:
    """A whole battery; NaN is unknown. Where a battery is sampled, some figures are columns."""

    name: str
    chemistry: str
    series: int
    parallel: int
    nominal_voltage: float  # V
    charge_voltage: float
    cutoff_voltage: float
    rests: bool  # whether the voltage at rest is known; else it is taken as the nominal one
    emf_full: float  # V at rest
    emf_empty: float
    capacity: float  # A*s as rated
    health: float  # share of it that is there
    usable: float  # share of that which may be drawn of a full one
    start: float  # share of that which is there at the start
    rated_time: float  # s
    peukert_exponent: float
    resistance: float  # ohm
    polarisation: float  # ohm, 0 where none is given
    time_constant: float  # s, of the polarisation
    continuous_current: float  # A
    peak_current: float
    max_charge_current: float
    mass: float  # kg
    price: float
    table: Table | None

    @property
    def energy(self) -> float:
        """Rated charge times nominal voltage [J]."""
        return self.capacity * self.nominal_voltage

    @property
    def mean_voltage(self) -> float:
        """Voltage by which a power becomes the current of a run time [V].

        The nominal one; of lead-acid the mean of that and the end voltage: 2 V is a cell at rest, not in use. Held
        against the makers' tables of power and current in ``tests/machine/test_battery_pack.py``.
        """
        if self.chemistry != "lead-acid" or _unknown(self.cutoff_voltage):
            return self.nominal_voltage
        return 0.5 * (self.nominal_voltage + self.cutoff_voltage)

    @property
    def available(self) -> float:
        """Share of the charge that may be drawn from the start on [1]."""
        return self.usable - (1.0 - self.start)

    def emf(self, charge: Any) -> Any:
        """Voltage at rest with a share of the charge left [V]."""
        return self.emf_empty + (self.emf_full - self.emf_empty) * charge

    @property
    def rule(self) -> str:
        """Source of its run times, in words; empty where nothing says how they go with the load."""
        if self.table:
            return f"discharge table at constant {self.table.held}"
        if self.peukert:
            return f"Peukert's law, exponent {self.peukert_exponent:g}"
        return "rated charge at any current" if self.by_charge else ""

    @property
    def by_charge(self) -> bool:
        """Whether a run time follows from the rated charge: by Peukert's law, or at any current."""
        return self.peukert or self.chemistry in _LITHIUM

    @property
    def peukert(self) -> bool:
        """Whether Peukert's law can be computed."""
        return not _unknown(self.peukert_exponent) and not _unknown(self.rated_time)


_LITHIUM = ("Li-ion", "LiFePO4")  # whose charge hardly depends on the current, as long as that is permitted


def pack_of(section: Battery, catalog: Catalog) -> Pack:
    """The battery that a spec describes."""
    pack: Pack = catalog.once("battery", lambda: _pack_of(section, catalog), (section,))
    return pack


def _pack_of(section: Battery, catalog: Catalog) -> Pack:
    row = _row(section, catalog)
    record = catalog.batteries.record(row) if row is not None else parts.Battery()
    one = {name: _first(getattr(section, name), getattr(record, name)) for name in _ONE}
    s, p = section.series, section.parallel
    rest, more = section.open_circuit, section.polarisation
    return Pack(
        name=f"{s} x {p} " * (s * p > 1) + (section.part or f"{section.chemistry or chr(32)} battery".strip()),
        chemistry=section.chemistry or record.chemistry, series=s, parallel=p,
        nominal_voltage=_times(s, one["nominal_voltage"]), charge_voltage=_times(s, one["charge_voltage"]),
        cutoff_voltage=_times(s, one["cutoff_voltage"]),
        rests=rest is not None,
        emf_full=_times(s, rest.full if rest else one["nominal_voltage"]),
        emf_empty=_times(s, rest.empty if rest else one["nominal_voltage"]),
        capacity=p * one["capacity"], health=section.health, usable=section.usable, start=section.start,
        rated_time=one["rated_time"],
        peukert_exponent=one["peukert_exponent"], resistance=one["resistance"] * s / p,
        polarisation=more.resistance * s / p if more else 0.0, time_constant=more.time_constant if more else nan,
        continuous_current=p * one["continuous_current"], peak_current=p * one["peak_current"],
        max_charge_current=p * one["max_charge_current"], mass=s * p * _first(section.mass, record.mass),
        price=s * p * record.price,
        table=_table(section, catalog, row, one["cutoff_voltage"]),
    )  # fmt: skip


def lacking(pack: Pack) -> tuple[str, ...]:
    """Fields of a spec's section ``battery`` that would decide its checks."""
    names = ("resistance", "continuous_current", "peak_current", "charge_voltage", "max_charge_current")
    run_times = () if pack.rule else ("chemistry or discharge",)
    return (*run_times, *(name for name in names if _unknown(getattr(pack, name))))


def _times(cells: int, volts: Any) -> Any:
    """Of cells in series, without what rounding adds: seven cells of 4.2 V are charged at 29.4 V."""
    return np.round(cells * volts, 9)


def _first(own: Any, listed: float) -> Any:
    return listed if own is None else own


def _unknown(value: Any) -> bool:
    """Of a figure, or of a column over samples."""
    return bool(np.isnan(value).all())


def _row(section: Battery, catalog: Catalog) -> int | None:
    if section.part is None:
        return None
    rows = catalog.batteries.rows
    if section.part not in rows:
        names = ", ".join(catalog.digests)
        hint = nearest(section.part, rows) or "; a catalogue of its maker belongs under select.catalogs"
        raise InputError(f"battery.part: {quoted(section.part)} is not in {names}{hint}")
    return rows[section.part]


def _table(section: Battery, catalog: Catalog, row: int | None, cutoff: float) -> Table | None:
    """The discharge table of the whole battery, at its end voltage or the next above; powers before currents."""
    s, p, health = section.series, section.parallel, section.health
    if section.discharge:
        held = "current" if section.discharge[0].power is None else "power"
        draw, time = (np.array([getattr(run, name) for run in section.discharge], float) for name in (held, "time"))
        return Table(held, draw * (p * health if held == "current" else s * p * health), time, s * cutoff)
    if row is None or section.model_fields_set & _OWN:
        return None
    own = catalog.discharges.on(catalog.discharges.battery == row)
    for held, parts_of in (("power", s * p), ("current", p)):
        draw = getattr(own, held)
        ends = np.unique(own.cutoff_voltage[~np.isnan(draw)])
        above = ends[-1:] if isnan(cutoff) else ends[ends >= cutoff * (1.0 - _NEARLY)][:1]
        if len(above):
            there = (own.cutoff_voltage == above[0]) & ~np.isnan(draw)
            return Table(held, draw[there] * parts_of * health, own.time[there], s * float(above[0]))
    return None


def run_time(pack: Pack, power: Any) -> Any:
    """Run time of a full battery at a constant power [s], all of its charge drawn.

    By its discharge table, inside of it; else by Peukert's law at the current P / V of its mean voltage; a lithium
    battery without an exponent gives its rated charge. Unknown otherwise; infinite where nothing is drawn.
    """
    current = np.asarray(power, float) / pack.mean_voltage
    if pack.table:
        draw = power if pack.table.held == "power" else current
        found = table_time(np.maximum(draw, 0.0), pack.table.draw, pack.table.time)
    elif pack.by_charge:
        found = peukert_time(current, pack.health * pack.capacity, *_law(pack))
    else:
        found = np.full_like(current, nan)
    return np.where(np.asarray(power) <= 0.0, inf, found)[()]


def _law(pack: Pack) -> tuple[float, float]:
    """Rated time [s] and exponent; with an exponent of 1 the time does not matter."""
    return (pack.rated_time, pack.peukert_exponent) if pack.peukert else (3600.0, 1.0)


def capacity_needed(pack: Pack, power: float, time: float) -> float:
    """Rated capacity of a battery of this kind that gives a power for a time, of the available share [A*s]."""
    whole = time / pack.available
    if power <= 0.0:
        return 0.0
    current = power / pack.mean_voltage
    if pack.table:
        draw = power if pack.table.held == "power" else current
        return float(pack.capacity * draw / table_draw(whole, pack.table.draw, pack.table.time))
    return float(capacity_for(whole, current, *_law(pack)) / pack.health) if pack.by_charge else nan


def strings_needed(pack: Pack, needed: float) -> float:
    """Number of parallel strings for a capacity."""
    share = needed / pack.capacity * pack.parallel
    return nan if isnan(share) else float(max(1, ceil(share * (1.0 - _NEARLY))))


# -- A battery's demands against its limits: autonomy, range, voltage, currents. Margins are made in ``checks``.
#
# Regenerated power charges the battery: its largest value with the charge of the start makes the highest voltage,
# V = E + R I. That is held against the voltage at which a charge ends and against the supply's highest, at which the
# drive was judged: where the battery keeps below that, so does the bus (``limits_over_time``).


_RESISTED = "unknown: how far regenerated power raises the voltage: give the resistance"


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
    *drawn, continuous, peak = drawn_columns(spec, section, pack, load)
    *raised, current = charging(spec, pack, load)
    room, charger = [], []
    if load.mean < 0.0:  # whether regenerated power beyond what is drawn finds room
        more = -load.mean * (inf if isnan(load.required) else load.required) / pack.mean_voltage
        room = [at_most("battery_room", more, (1.0 - pack.start) * pack.health * pack.capacity)]
    if section.charger is not None:
        charger = [at_most("battery_charger_current", section.charger.current, pack.max_charge_current)]
    columns = (*drawn, *raised, *room, continuous, peak, *charger, current)
    return tuple(column.at((), "budget") for column in columns)


def drawn_columns(spec: Any, section: Battery, pack: Pack, load: Any) -> list[CheckColumn]:
    """Limits of what is drawn alone: autonomy and range, voltages that the drive was sized for, currents.

    Single figures, or columns where the figures of spec and load are columns.
    """
    lasts, emf, grip = load.full * pack.available, pack.emf(load.charge), spec.margins.torque
    required, found = required_autonomy(spec, section), []
    if not np.isnan(required).all():
        found.append(at_least("battery_autonomy", required, lasts, needed=section.reserve))
    if section.range is not None:
        found.append(at_least("battery_range", section.range, load.speed * lasts, needed=section.reserve))
    at_rest = [
        at_most("battery_power", load.peak, largest_power(emf, pack.resistance)),
        at_least("battery_voltage", spec.supply.lowest, load.lowest),
        at_least("battery_cutoff", pack.cutoff_voltage, load.lowest),
    ]
    peak = current_of_power(load.peak, emf, pack.resistance)
    return [
        *found,
        *(_known_at_rest(pack, check) for check in at_rest),
        at_most("battery_charge_voltage", pack.charge_voltage, spec.supply.highest, by_choice=True),
        at_most("battery_continuous_current", load.rms / pack.mean_voltage, pack.continuous_current, needed=grip),
        at_most("battery_peak_current", peak, pack.peak_current, needed=grip),
    ]


def charging(spec: Any, pack: Pack, load: Load) -> tuple[CheckColumn, ...]:
    """Highest voltage and charge current, from the largest regenerated power; without any no limit applies.

    The margin to the voltage at which a charge ends counts from the voltage at rest: by so much the current may grow.
    """
    rest, lacking = resting_voltage(pack, load.mean), _RESISTED if np.isnan(pack.resistance).all() else ""
    zero = np.where((np.asarray(load.back) == 0.0) | (np.asarray(load.highest) > rest), rest, 0.0)[()]
    over = at_most("battery_overcharge", load.highest, pack.charge_voltage, zero=zero, undecided=lacking)
    bus = at_most("battery_return_voltage", load.highest, spec.supply.highest, undecided=lacking)
    current = _returned_current(pack, load.back, pack.emf(load.charge))
    into = at_most("battery_charge_current", current, pack.max_charge_current, needed=spec.margins.torque)
    return _known_at_rest(pack, over), _known_at_rest(pack, bus), into


def _known_at_rest(pack: Pack, check: CheckColumn) -> CheckColumn:
    """A check of voltages; where the nominal one stands for that at rest it may fail but not pass, unless idle.

    That at rest is less in the end and more at the start.
    """
    if pack.rests:
        return check
    note = "voltage at rest unknown: give open_circuit"
    idle = check.passed & (check.demand == check.zero)
    return replace(check, passed=idle, note="" if np.all(check.failed | idle) else note)


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
