"""The battery of a machine: what it can give, what drives and other consumers draw, autonomy, range, limits.

The drives' power is that of their load cycle, repeated without pause; other consumers count by their share of the time.
The run time is that of the mean power; currents and voltage are those of each moment, with every consumer at its peak
at once. Regenerated power charges the battery: its largest value with the charge of the start makes the highest
voltage, V = E + R I. That is held against the voltage at which a charge ends and against the supply's highest, at which
the drive was judged: where the battery keeps below that, so does the bus (``limits_over_time``).

Symbols: P power [W], E voltage at rest [V], I current [A], T time [s].
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import ceil, fsum, inf, isnan, nan
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from drivesizer import catalog as parts
from drivesizer.catalog import Catalog
from drivesizer.errors import FieldError, InputError, nearest, quoted
from drivesizer.load_cases.of_machine import distance_of
from drivesizer.machine.supply_power import AxisOnBus, Draw, DrivePower, Regenerated
from drivesizer.physics import battery as laws
from drivesizer.physics.figures import Alike, Array, Range
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.results.check import Check, Figure, figures_of, verdict
from drivesizer.results.check_columns import CheckColumn, at_least, at_most
from drivesizer.results.check_kinds import BATTERY_LASTING, BATTERY_SAMPLED, BATTERY_VOLTAGES
from drivesizer.results.drive_set import Consumption, EnergyBudget, loss_assumptions
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

if TYPE_CHECKING:
    from drivesizer.spec.sections import Battery, Leg

_CELL_FIGURES = (  # figures of one cell or block that spec and catalogue share
    "nominal_voltage", "charge_voltage", "cutoff_voltage", "capacity", "rated_time", "peukert_exponent", "resistance",
    "continuous_current", "peak_current", "max_charge_current", "mass",
)  # fmt: skip
_OWN = {"capacity", "rated_time", "peukert_exponent", "discharge"}  # with one of them the catalogue's table is not used
_LITHIUM = ("Li-ion", "LiFePO4")  # whose charge hardly depends on the current, as long as that is permitted
# Peukert exponents of a lead-acid battery of which only volts and ampere-hours are known: AGM 1.05 to 1.15, gel 1.1 to
# 1.25, flooded 1.14 to 1.28 (those of makers' 20 h ratings and reserve minutes: Xantrex, Link 2000, manual, page 27;
# of AGM BD Batteries, Peukert's law), and the time in which their ampere-hours are rated.
_OF_CLASS, _RATED_IN = (1.05, 1.3), 20 * 3600.0
_NEARLY = 1e-9  # relative: the same end voltage
_POINTS = 2000  # of the state of charge over a mission


# --- what a battery can give


class Table(NamedTuple):
    """Constant draws of a whole battery and how long they last."""

    kind: str  # current or power
    draw: Array  # A or W
    time: Array  # s


@dataclass(frozen=True, slots=True, kw_only=True)
class Pack:
    """A whole battery; NaN is unknown. Where a battery is sampled, some figures are columns."""

    section: Battery  # as the spec describes it
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
    def mean_voltage(self) -> float:
        """Voltage by which a power becomes the current of a run time [V].

        The nominal one; of lead-acid the mean of that and the end voltage: 2 V is a cell at rest, not in use. Held
        against the makers' tables of power and current in ``tests/machine/test_battery_pack.py``.
        """
        if self.chemistry != "lead-acid" or np.isnan(self.cutoff_voltage).all():
            return self.nominal_voltage
        return 0.5 * (self.nominal_voltage + self.cutoff_voltage)

    @property
    def available(self) -> float:
        """Share of the charge that may be drawn from the start on [1]."""
        return self.usable - (1.0 - self.start)

    def emf(self, charge: Alike) -> Alike:
        """Voltage at rest with a share of the charge left [V]."""
        return self.emf_empty + (self.emf_full - self.emf_empty) * charge

    @property
    def rule(self) -> str:
        """Source of its run times, in words; empty where nothing says how they go with the load."""
        if self.table:
            return f"discharge table at constant {self.table.kind}"
        if self.of_class:
            least, most = _OF_CLASS
            return f"Peukert's law, exponent {least:g} to {most:g} (assumed: AGM to flooded; give peukert_exponent)"
        if self.peukert:
            return f"Peukert's law, exponent {self.peukert_exponent:g}"
        return "rated charge at any current" if self.law else ""

    @property
    def of_class(self) -> bool:
        """Whether its exponent is one of its class: of lead-acid of which only volts and ampere-hours are known."""
        return self.chemistry == "lead-acid" and self.table is None and bool(np.isnan(self.peukert_exponent).all())

    @property
    def peukert(self) -> bool:
        """Whether Peukert's law can be computed."""
        return not np.isnan(self.peukert_exponent).all() and not np.isnan(self.rated_time).all()

    @property
    def law(self) -> tuple[float, float] | None:
        """Rated time [s] and exponent of the run time by the rated charge; None where it does not follow from that."""
        if self.of_class:
            return (_RATED_IN if np.isnan(self.rated_time).all() else self.rated_time), _OF_CLASS[1]
        if self.peukert:
            return self.rated_time, self.peukert_exponent
        return (3600.0, 1.0) if self.chemistry in _LITHIUM else None  # with an exponent of 1 no time matters


def pack_of(section: Battery, catalog: Catalog) -> Pack:
    """The battery that a spec describes."""
    return catalog.once("battery", lambda: _pack(section, catalog), (section,))


def mass_of(section: Battery | None, catalog: Catalog) -> float | None:
    """Mass of the battery that a spec describes [kg]; None without any."""
    return pack_of(section, catalog).mass if section else None


def row_of(catalog: Catalog, section: str, part: str, field: tuple[str, ...]) -> int:
    """Row of a part that a field of a spec names, which some catalogue must list."""
    rows = catalog.table(section).rows
    if part not in rows:
        hint = nearest(part, rows) or "; a catalogue of its maker belongs under select.catalogs"
        raise FieldError(field, f"{quoted(part)} is not in {', '.join(catalog.digests)}{hint}")
    return rows[part]


def _pack(section: Battery, catalog: Catalog) -> Pack:
    row = None if section.part is None else row_of(catalog, "batteries", section.part, ("battery", "part"))
    record = parts.Battery() if row is None else catalog.batteries.record(row)
    cell = {
        name: getattr(record, name) if getattr(section, name) is None else getattr(section, name)
        for name in _CELL_FIGURES
    }
    s, p, rest, more = section.series, section.parallel, section.open_circuit, section.polarisation
    at_rest = (rest.full, rest.empty) if rest else (cell["nominal_voltage"],) * 2
    cells = [*(cell[name] for name in ("nominal_voltage", "charge_voltage", "cutoff_voltage")), *at_rest]
    # without what rounding adds: seven cells of 4.2 V are charged at 29.4 V
    nominal_voltage, charge_voltage, cutoff_voltage, full, empty = (np.round(s * volts, 9) for volts in cells)
    return Pack(
        section=section,
        name=f"{s} x {p} " * (s * p > 1) + (section.part or f"{section.chemistry or chr(32)} battery".strip()),
        chemistry=section.chemistry or record.chemistry, series=s, parallel=p,
        nominal_voltage=nominal_voltage, charge_voltage=charge_voltage, cutoff_voltage=cutoff_voltage,
        rests=rest is not None, emf_full=full, emf_empty=empty,
        capacity=p * cell["capacity"], health=section.health, usable=section.usable, start=section.start,
        rated_time=cell["rated_time"], peukert_exponent=cell["peukert_exponent"],
        resistance=cell["resistance"] * s / p,
        polarisation=more.resistance * s / p if more else 0.0, time_constant=more.time_constant if more else nan,
        continuous_current=p * cell["continuous_current"], peak_current=p * cell["peak_current"],
        max_charge_current=p * cell["max_charge_current"], mass=s * p * cell["mass"], price=s * p * record.price,
        table=_table(section, catalog, row, cell["cutoff_voltage"]),
    )  # fmt: skip


def _table(section: Battery, catalog: Catalog, row: int | None, cutoff: float) -> Table | None:
    """The discharge table of the whole battery, at its end voltage or the next above; powers before currents."""
    share = {"power": section.series * section.parallel, "current": section.parallel}
    if section.discharge:
        kind = "current" if section.discharge[0].power is None else "power"
        draw, time = (np.array([getattr(run, name) for run in section.discharge], float) for name in (kind, "time"))
        return Table(kind, draw * (share[kind] * section.health), time)
    if row is None or section.model_fields_set & _OWN:
        return None
    own = catalog.discharges.on(catalog.discharges.battery == row)
    for kind, parallel in share.items():
        draw = getattr(own, kind)
        ends = np.unique(own.cutoff_voltage[~np.isnan(draw)])
        above = ends[-1:] if isnan(cutoff) else ends[ends >= cutoff * (1.0 - _NEARLY)][:1]
        if len(above):
            there = (own.cutoff_voltage == above[0]) & ~np.isnan(draw)
            return Table(kind, draw[there] * parallel * section.health, own.time[there])
    return None


def lacking(pack: Pack) -> tuple[str, ...]:
    """Fields of a spec's section ``battery`` that would decide its checks."""
    names = ("resistance", "continuous_current", "peak_current", "charge_voltage", "max_charge_current")
    run_times = () if pack.rule else ("chemistry or discharge",)
    return (*run_times, *(name for name in names if np.isnan(getattr(pack, name)).all()))


def longest_run_time(pack: Pack, power: Alike) -> Alike:
    """Run time of a full battery at a constant power at most [s]: by the other end of the exponents of its class."""
    if not pack.of_class:
        return run_time(pack, power)
    assert pack.law is not None
    return run_time(replace(pack, peukert_exponent=_OF_CLASS[0], rated_time=pack.law[0]), power)


def run_time(pack: Pack, power: Alike) -> Alike:
    """Run time of a full battery at a constant power [s], all of its charge drawn; the least by a class of exponents.

    By its discharge table, inside of it; else by Peukert's law at the current P / V of its mean voltage; a lithium
    battery without an exponent gives its rated charge. Unknown otherwise; infinite where nothing is drawn.
    """
    current = np.asarray(power, float) / pack.mean_voltage
    time = np.full_like(current, nan)
    if pack.table:
        draw = power if pack.table.kind == "power" else current
        time = laws.table_time(np.maximum(draw, 0.0), pack.table.draw, pack.table.time)
    elif pack.law:
        time = laws.peukert_time(current, pack.health * pack.capacity, *pack.law)
    return np.where(np.asarray(power) <= 0.0, inf, time)[()]


def capacity_needed(pack: Pack, power: float, time: float) -> float:
    """Rated capacity of a battery of this kind that gives a power for a time, of the available share [A*s]."""
    whole, current = time / pack.available, power / pack.mean_voltage
    if power <= 0.0:
        return 0.0
    if pack.table:
        draw = power if pack.table.kind == "power" else current
        return float(pack.capacity * draw / laws.table_draw(whole, pack.table.draw, pack.table.time))
    return float(laws.capacity_for(whole, current, *pack.law) / pack.health) if pack.law else nan


def strings_needed(pack: Pack, needed: float) -> float:
    """Number of parallel strings for a capacity."""
    share = needed / pack.capacity * pack.parallel
    return nan if isnan(share) else float(max(1, ceil(share * (1.0 - _NEARLY))))


def accepted(spec: RobotSpec) -> Alike:
    """Share of regenerated power that goes into the battery; what of it is not stored is lost inside."""
    return 1.0 if spec.accepts_all else spec.supply.regeneration


def loaded_voltage(pack: Pack, power: Alike, emf: Any) -> Alike:
    """Voltage at the terminals while power is drawn, or regenerated below 0 [V]; unknown where no current gives it."""
    return laws.terminal_voltage(laws.current_of_power(power, emf, pack.resistance), emf, pack.resistance)


def raised_voltage(pack: Pack, back: Alike, emf: Any) -> Alike:
    """Voltage at the terminals while power is regenerated [V]: E + R I; E where none does, whatever the resistance."""
    return np.where(np.asarray(back) == 0.0, emf, loaded_voltage(pack, -np.asarray(back), emf))[()]


def _returned_current(pack: Pack, back: Alike, emf: Alike) -> Alike:
    """Current into the battery [A]: the root of R I^2 + E I = P that is not negative."""
    into = -laws.current_of_power(-np.asarray(back), emf, pack.resistance)
    return np.where(np.asarray(back) == 0.0, 0.0, into)[()]


# --- demands against limits


class Load(NamedTuple):
    """The load of a battery; NaN is unknown. Figures, or columns over samples."""

    mean: Alike  # W
    peak: Alike  # W
    rms: float  # W
    back: float  # W into the battery, at most
    speed: Alike  # m/s, mean
    full: Alike = nan  # s, until all of its charge is drawn, at least
    required: float = nan  # s that it must last; also where nothing is required
    charge: Alike = nan  # share left at the end
    lowest: Alike = nan  # V at the terminals
    highest: Alike = nan  # V there, at the largest return
    longest: Alike = nan  # s, until all of its charge is drawn, at most
    others: float = 0.0  # W of the mean that is not the drives'


def required_autonomy(spec: RobotSpec, pack: Pack) -> Alike:
    """Time that a battery must last: the autonomy of its section, else the mission."""
    if pack.section.autonomy is not None:
        return pack.section.autonomy
    return nan if spec.mission is None or spec.mission.legs else spec.mission.duration


def load_of(spec: RobotSpec, pack: Pack, mean: Alike, peak: Alike, speed: Alike, strings: Alike = 1.0) -> Load:
    """Load of a battery, of so many times its strings, by the powers that are drawn [W]: figures, or columns.

    Lowest is the voltage at the peak, at the end of the time; unknown where no current gives that power.
    """
    full = run_time(pack, mean / strings)
    along = nan if pack.section.range is None else pack.section.range / speed
    required = np.fmax(required_autonomy(spec, pack), along)
    depth = np.where(np.isnan(required), pack.available, required / full)
    charge = pack.start - np.minimum(depth, pack.available)
    emf = pack.emf(charge)
    lowest, longest = loaded_voltage(pack, peak, emf), longest_run_time(pack, mean / strings)
    return Load(mean, peak, nan, nan, speed, full, required, charge, lowest, longest=longest)


def battery_checks(spec: RobotSpec, pack: Pack, load: Load) -> tuple[Check, ...]:
    """Every limit of a battery, in the order in which people read them."""
    *autonomy, continuous, peak = drawn_columns(spec, pack, load)
    *raised, current = charging(spec, pack, load)
    room, charger, legs = [], [], []
    if spec.mission is not None and spec.mission.legs:
        along = charge_along(spec.mission.legs, pack, load)
        legs = [
            at_least("battery_on_the_way", 1.0 - pack.usable, along.min(), needed=pack.section.reserve),
            at_least("battery_recharged", pack.start, along[-1], advice=True),
        ]
    if load.mean < 0.0:  # whether regenerated power beyond what is drawn finds room
        more = -load.mean * (inf if isnan(load.required) else load.required) / pack.mean_voltage
        room = [at_most("battery_room", more, (1.0 - pack.start) * pack.health * pack.capacity)]
    if pack.section.charger is not None:
        charger = [at_most("battery_charger_current", pack.section.charger.current, pack.max_charge_current)]
    columns = (*legs, *autonomy, *raised, *room, continuous, peak, *charger, current)
    return tuple(column.at((), "budget") for column in columns)


def charge_along(legs: Sequence[Leg], pack: Pack, load: Load) -> Array:
    """Share of the charge that is left after each leg of a mission [1]; below 0 where it would be drawn out."""
    charges, charge, charger = [], pack.start, pack.section.charger
    for leg in legs:
        out = 1.0 / float(run_time(pack, leg.share * (load.mean - load.others) + load.others))
        into = 0.0
        if leg.charges and charger is not None:
            into = charger.current * charger.efficiency / (pack.health * pack.capacity)
        charge = min(1.0, charge + (into - out) * leg.time)
        charges.append(charge)
    return np.array(charges)


def drawn_columns(spec: RobotSpec, pack: Pack, load: Load) -> list[CheckColumn]:
    """Limits of what is drawn alone: autonomy and range, voltages that the drive was sized for, currents.

    Single figures, or columns where the figures of spec and load are columns.
    """
    emf, grip, reserve = pack.emf(load.charge), spec.margins.torque, pack.section.reserve
    lasts = load.full * pack.available
    reached = Range(lasts, load.longest * pack.available) if pack.of_class else lasts
    required, columns = required_autonomy(spec, pack), []
    if not np.isnan(required).all():
        columns.append(at_least("battery_autonomy", required, reached, needed=reserve))
    if pack.section.range is not None:
        far = Range(*(load.speed * time for time in reached)) if pack.of_class else load.speed * lasts
        columns.append(at_least("battery_range", pack.section.range, far, needed=reserve))
    peak = laws.current_of_power(load.peak, emf, pack.resistance)
    return [
        *columns,
        _known_at_rest(pack, at_most("battery_power", load.peak, laws.largest_power(emf, pack.resistance))),
        _known_at_rest(pack, at_least("battery_voltage", spec.supply.lowest, load.lowest)),
        _known_at_rest(pack, at_least("battery_cutoff", pack.cutoff_voltage, load.lowest)),
        at_most("battery_charge_voltage", pack.charge_voltage, spec.supply.highest, by_choice=True),
        at_most("battery_continuous_current", load.rms / pack.mean_voltage, pack.continuous_current, needed=grip),
        at_most("battery_peak_current", peak, pack.peak_current, needed=grip),
    ]


def charging(spec: RobotSpec, pack: Pack, load: Load) -> tuple[CheckColumn, ...]:
    """Highest voltage and charge current, from the largest regenerated power; without any no limit applies.

    The margin to the voltage at which a charge ends counts from the voltage at rest: by so much the current may grow.
    """
    give = "unknown: how far regenerated power raises the voltage: give the resistance"
    undecided = give if np.isnan(pack.resistance).all() else ""
    rest = _resting_voltage(pack, load.mean)
    zero = np.where((np.asarray(load.back) == 0.0) | (np.asarray(load.highest) > rest), rest, 0.0)[()]
    over = at_most("battery_overcharge", load.highest, pack.charge_voltage, zero=zero, undecided=undecided)
    bus = at_most("battery_return_voltage", load.highest, spec.supply.highest, undecided=undecided)
    current = _returned_current(pack, load.back, pack.emf(load.charge))
    into = at_most("battery_charge_current", current, pack.max_charge_current, needed=spec.margins.torque)
    return _known_at_rest(pack, over), _known_at_rest(pack, bus), into


def _resting_voltage(pack: Pack, mean: Alike) -> Alike:
    """Highest voltage at rest: that of the start, or of a full battery where more is regenerated than drawn."""
    return pack.emf(np.where(np.asarray(mean) < 0.0, 1.0, pack.start))[()]


def _known_at_rest(pack: Pack, check: CheckColumn) -> CheckColumn:
    """A check of voltages; where the nominal one stands for that at rest it may fail but not pass, unless idle.

    That at rest is less in the end and more at the start.
    """
    if pack.rests:
        return check
    idle = check.passed & (check.demand == check.zero)
    unknown = "" if np.all(check.failed | idle) else "voltage at rest unknown: give open_circuit"
    return check._replace(passed=idle, note=unknown)


# --- the same of columns, over drives or samples
#
# Not here: continuous current, current and voltage of charging, and the voltage of polarisation.


class Feeding(NamedTuple):
    """A battery and the equipment that draws from it, of samples."""

    pack: Pack
    charge: Alike  # of the battery over its nominal one
    mean: Alike  # W, of the equipment
    peak: Alike  # W


def feeding(spec: RobotSpec, rated: Battery, catalog: Catalog) -> Feeding:
    """The battery of a machine, and what the equipment draws from it."""
    section = spec.battery
    assert section is not None
    charge: Alike = 1.0
    for name in ("capacity", "health"):
        if name in section.model_fields_set:
            charge = charge * (getattr(section, name) / getattr(rated, name))
            section = section.model_copy(update={name: getattr(rated, name)})
    mission = spec.mission.duration if spec.mission else None
    draws = [device.power_drawn(mission) for device in spec.equipment]
    mean, peak = (sum(powers) for powers in zip(*draws, strict=True)) if draws else (0.0, 0.0)
    return Feeding(pack_of(section, catalog), charge, mean, peak)


def columns_of(spec: RobotSpec, feeds: Feeding, cycle: LoadCycle, draws: Sequence[Draw]) -> list[CheckColumn]:
    """Autonomy, range, peak and voltage, from what drives draw over a cycle, or samples each over its own."""
    share, total = spec.supply.regeneration, cycle.total
    drawn, returned = (sum(getattr(draw, name) for draw in draws) for name in ("drawn", "returned"))
    mean = (drawn / (1.0 - spec.slip) - share * returned) / total + feeds.mean
    peak = np.maximum(draws[0].peak, 0.0) / (1.0 - spec.slip) + feeds.peak
    speed = distance_of(spec, cycle) / total
    load = load_of(spec, feeds.pack, mean, peak, speed, feeds.charge)  # of so many parallel strings
    checked = {*BATTERY_LASTING} if len(draws) > 1 else {*BATTERY_SAMPLED}
    checked -= {*BATTERY_VOLTAGES} if feeds.pack.polarisation else set()
    return [check for check in drawn_columns(spec, feeds.pack, load) if check.name in checked]


# --- consumers, and the load that they make


def _drawing(bus: Regenerated, axes: Sequence[AxisOnBus]) -> tuple[list[Consumption], list[str]]:
    """Lines of all axes in the table of consumers, and what was assumed of their losses."""
    spec, total, lines, losses = bus.spec, bus.power, list[Consumption](), list[str]()
    for axis in axes:
        before = f"{axis.name}: " if axis.name else ""
        lines += [line._replace(name=before + line.name) for line in _of_axis(axis)]
        losses += [before + text for text in loss_assumptions(axis.spec, axis.drive_set.controller)]
    exchanged = fsum(axis.power.mean(axis.power.returned) for axis in axes) - total.mean(total.returned)
    if exchanged > 0.0:
        share = 1.0 - spec.supply.regeneration
        lines.append(Consumption("exchanged between axes", len(axes), -share * exchanged, 0.0, nan, False))
    if spec.supply.resistance is not None:
        lines.append(Consumption("resistance of the supply", 1, total.mean(total.resisted), 0.0, nan, False))
    return lines, list(dict.fromkeys(losses))


def _of_axis(axis: AxisOnBus) -> Iterator[Consumption]:
    """Lines of the drives of an axis in that table."""
    spec, drive_set, power = axis.spec, axis.drive_set, axis.power
    share, sets, slip = spec.supply.regeneration, spec.load.motors, spec.slip
    drawn, returned = power.mean(power.motor_drawn), share * power.mean(power.motor_returned)
    released = sets * drive_set.released_power * spec.brake_released
    lost = power.mean(power.bus_drawn) - drawn + returned - share * power.mean(power.returned) - released
    assumed = bool(spec.feed_of(drive_set.controller).stage.assumed)
    yield Consumption("drive", sets, drawn * (1.0 - slip), float(power.peak.max()), nan, False)
    yield Consumption("regenerated energy", sets, -returned, 0.0, nan, False)
    yield Consumption("losses of the controllers", sets, lost, 0.0, nan, assumed)
    if slip:
        yield Consumption("slip of the wheels", sets, drawn * slip, 0.0, nan, False)
    if released:
        yield Consumption("brakes, released", sets, released, 0.0, nan, False)


def _equipment(spec: RobotSpec) -> list[Consumption]:
    """Lines of other consumers in that table."""
    mission = spec.mission.duration if spec.mission else None
    try:
        return [
            Consumption(c.name, c.number, *c.power_drawn(mission), c.share(mission), c.assumed) for c in spec.equipment
        ]
    except ValueError as error:
        raise InputError(f"equipment: {error}") from None


def _battery_load(spec: RobotSpec, pack: Pack, others: Sequence[Consumption], drive: DrivePower) -> tuple[Load, Array]:
    """Load of a battery, and mean power from it in each piece [W].

    Highest is the voltage at the largest return, with the charge of the start and all else switched off. A polarised
    battery is at rest at first, and then comes to what the cycle makes of it: the higher of both counts.
    """
    power = np.asarray(drive.drawn - spec.supply.regeneration * drive.returned + sum(c.mean for c in others))
    mean, peak = drive.mean(power), float(drive.peak.max()) + sum(c.peak for c in others)
    mean_load = load_of(spec, pack, mean, peak, drive.distance / drive.total)
    back, R = accepted(spec) * float(drive.returned_peak.max()), pack.resistance
    load = Load(*map(float, mean_load))._replace(rms=float(np.sqrt(drive.mean(power**2))), back=back,
                                            others=sum(c.mean for c in others))  # fmt: skip
    raised = float(_resting_voltage(pack, mean))
    if pack.polarisation > 0.0:  # the cycle charges the pair, peak and return come on top
        pair, off = (pack.polarisation, pack.time_constant), np.asarray(drive.drawn - accepted(spec) * drive.returned)
        emf = pack.emf(load.charge)
        current = laws.current_of_power(power, emf, R)
        emf = float(np.minimum(*laws.polarised_voltage(drive.duration, current, emf, 0.0, *pair)).min())
        load = load._replace(lowest=float(loaded_voltage(pack, peak, emf)))
        current, start = laws.current_of_power(off, raised, R), raised
        for rested in (True, False):
            ends = laws.polarised_voltage(drive.duration, current, start, 0.0, *pair, rested=rested)
            raised = max(raised, float(np.maximum(*ends).max()))
    load = load._replace(highest=float(raised_voltage(pack, back, raised)))
    return load, power


# --- the budget


def energy_budget(
    bus: Regenerated, axes: Sequence[AxisOnBus], catalog: Catalog, *, figures: bool = True
) -> EnergyBudget:
    """Consumers, autonomy and checks of a machine in a load case, with what has no limit where that is wanted."""
    spec, drive = bus.spec, bus.power
    assert spec.battery is not None
    pack, others = pack_of(spec.battery, catalog), _equipment(spec)
    load, power = _battery_load(spec, pack, others, drive)
    checks, (lines, assumed) = battery_checks(spec, pack, load), _drawing(bus, axes) if figures else ([], [])
    return EnergyBudget(
        battery=pack.name,
        start=pack.start,
        usable=pack.usable,
        consumers=(*lines, *others),
        duration=drive.duration,
        power=power,
        mean_power=load.mean,
        peak_power=load.peak,
        full_time=load.full,
        autonomy=load.full * pack.available,
        range=load.speed * load.full * pack.available,
        required=load.required,
        status=verdict(checks),
        checks=checks,
        figures=_figures(spec, pack, load, drive, power) if figures else (),
        assumptions=_assumptions(spec, pack, assumed) if figures else (),
    )


def _figures(spec: RobotSpec, pack: Pack, load: Load, drive: DrivePower, power: Array) -> tuple[Figure, ...]:
    battery = pack.section
    wear = float(drive.duration @ (1.0 / run_time(pack, power))) / drive.total  # as in a steady load, moment by moment
    worn = 1.0 / wear if wear > 0.0 else (inf if wear == 0.0 else nan)
    mission = spec.mission.duration if spec.mission else nan
    needed = capacity_needed(pack, load.mean, load.required * (1.0 + battery.reserve))
    charge_drawn = nan if load.full == inf else load.mean / pack.mean_voltage * load.full
    lacking = {"mission_energy": isnan(mission), "range": isnan(load.speed)}
    less, charging = load.full - float(run_time(pack, load.mean + 1.0)), nan
    if battery.charger is not None:  # the constant voltage at the end of a charge takes longer
        lasts = load.full * pack.available if isnan(load.required) else load.required
        charged = max(load.mean, 0.0) / pack.mean_voltage * lasts
        charging = float(charged / (battery.charger.current * battery.charger.efficiency))
    lacking |= {"autonomy_per_watt": isnan(less), "charging_time": battery.charger is None}
    lacking |= dict.fromkeys(("charge_left", "capacity_needed", "strings_needed"), isnan(load.required))
    values = {
        "mean_power": load.mean,
        "peak_power": load.peak,
        "mission_energy": load.mean * mission,
        "rated_energy": pack.capacity * pack.nominal_voltage,
        "mean_current": load.mean / pack.mean_voltage,
        "charge_drawn": charge_drawn,
        "autonomy": load.full * pack.available,
        "autonomy_per_watt": less * pack.available,
        "autonomy_worn": worn * pack.available,
        "range": load.speed * load.full * pack.available,
        "charge_left": load.charge,
        "charging_time": charging,
        "capacity_needed": needed,
        "strings_needed": strings_needed(pack, needed),
        "battery_mass": pack.mass,
    }
    return figures_of("battery", {name: value for name, value in values.items() if not lacking.get(name)})


def charge_over_mission(budget: EnergyBudget, mission: float, most: int = _POINTS) -> tuple[Array, Array]:
    """Charge left over a mission, from that of the start: times [s] and shares [1].

    Drawn and returned charge count alike, against what the battery gives at the mean load: a full one is empty when
    ``full_time`` has passed, and below 0 after that. Of a mission of very many cycles the mean is reported.
    """
    all_of_it = budget.mean_power * budget.full_time
    cycle = float(budget.duration.sum())
    count = int(np.ceil(mission / cycle * (1.0 - 1e-9)))
    if count * len(budget.duration) >= most:
        time = np.linspace(0.0, mission, most)
        return time, laws.state_of_charge(np.diff(time), budget.mean_power, all_of_it, budget.start)
    duration = np.tile(budget.duration, count)
    time = np.concatenate([[0.0], np.cumsum(duration)])
    charge = laws.state_of_charge(duration, np.tile(budget.power, count), all_of_it, budget.start)
    end = np.interp(mission, time, charge)
    inside = time < mission
    return np.append(time[inside], mission), np.append(charge[inside], end)


def _assumptions(spec: RobotSpec, pack: Pack, assumed: Sequence[str]) -> tuple[str, ...]:
    unknown = "run time unknown: neither a discharge table nor a Peukert exponent with its rated time is known"
    assumptions = [
        f"run time by {pack.rule}, at the mean power" if pack.rule else unknown,
        f"current of the run time at {show(pack.mean_voltage, 'V', 'voltage')}",
        "the cycle repeats without pause",
    ]
    if pack.section.rated_time and pack.table is None:
        assumptions.insert(1, f"capacity as rated over {show(pack.section.rated_time, 'h', 'time')}, as the spec says")
    guessed = [device.name for device in spec.equipment if device.assumed]
    if guessed:
        assumptions.append(f"power of {', '.join(guessed)} assumed")
    assumptions += assumed
    if spec.platform and not spec.platform.slip and any(w.kind == "mecanum" for w in spec.platform.places):
        assumptions.append("slip of the rollers on the floor is not counted: platform.slip")
    if pack.section.charger:
        assumptions.append(
            "charging at a constant current to the end: with a constant voltage at the end it takes longer"
        )
    if not pack.rests:
        assumptions.append("voltage at rest taken as the nominal one: towards the end of the charge it is less")
    if spec.supply.regeneration == 0.0:
        assumptions.append("no regenerated energy is stored")
    return tuple(assumptions)
