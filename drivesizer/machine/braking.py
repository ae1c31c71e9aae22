"""The bus of a machine while its drives brake: brake resistors, chopper and power supply, each against its limit."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from math import inf, isnan, nan
from typing import TYPE_CHECKING

import numpy as np

from drivesizer.catalog import BrakeResistor, Catalog, PowerSupply
from drivesizer.errors import InputError, nearest, quoted
from drivesizer.load_cases import located
from drivesizer.machine.battery import row_of
from drivesizer.machine.supply_power import Burnt, Regenerated
from drivesizer.physics import braking as laws
from drivesizer.results.check import GRAVEST, Check, Figure, figures_of, verdict, worst_of_cases
from drivesizer.results.check_columns import CheckColumn, at_least, at_most, fits
from drivesizer.results.drive_set import BrakingBudget
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.sections import Supply
from drivesizer.units import resolved, show

if TYPE_CHECKING:
    from drivesizer.spec.sections import BrakeResistor as Section

# -- Brake resistors that a spec offers, and each against what a machine regenerates.
#
# Symbols: U_ch voltage of the chopper [V], R resistance [ohm], P power [W].


_SHUNT = "shunt regulator"
_INSIDE = "inside a drive"
_NO_CURRENT = "unknown: give brake_resistor.chopper_current"
_NO_PEAK = "unknown: no data sheet gives it; give brake_resistor with figures of its own"


def resistor_choices(spec: RobotSpec, catalog: Catalog) -> list[BrakeResistor]:
    """The brake resistors among which a spec leaves the choice, each with the chopper that switches it."""
    section, table = spec.brake_resistor, catalog.brake_resistors
    assert section is not None
    if section.resistance is not None:  # given by its figures
        names = ("resistance", "power", "peak_power", "pulse_energy")
        figures = {name: getattr(section, name) for name in names if getattr(section, name) is not None}
        volts = nan if section.chopper_voltage is None else section.chopper_voltage
        current = section.chopper_current or nan
        return [BrakeResistor(kind="resistor", chopper_voltage_min=volts, chopper_voltage_max=volts,
                              chopper_current=current, **figures)]  # fmt: skip
    named = set[int]()
    for field in ("family", "part"):
        for name in getattr(section, field) or ():
            pattern = re.compile(re.escape(name).replace(r"\*", ".*"), re.IGNORECASE)
            rows = [row for row, value in enumerate(table[field].tolist()) if pattern.fullmatch(value)]
            if not rows:
                hint, where = nearest(name, dict.fromkeys(table[field].tolist())), spec.where(("brake_resistor", field))
                raise InputError(f"{where}: {quoted(name)} is not in {', '.join(catalog.digests)}{hint}")
            named.update(rows)
    resistors = []
    for row in range(len(table)):
        if table.excluded[row] or (named and row not in named):
            continue
        resistor = table.record(row)
        if resistor.kind != _SHUNT and section.chopper_voltage is not None:  # by the chopper of the spec
            volts, current = section.chopper_voltage, section.chopper_current or resistor.chopper_current
            resistor = replace(resistor, chopper_voltage_min=volts, chopper_voltage_max=volts, chopper_current=current)
        resistors.append(resistor)
    if not section.part:  # a choice beside others: a resistor for the chopper that is given, else a shunt regulator
        kind = _SHUNT if section.chopper_voltage is None else "resistor"
        highest = max(case.supply.highest for _, case in spec.load_cases)
        resistors = [resistor for resistor in resistors if resistor.kind == kind
                 and not resistor.chopper_voltage_min < highest
                 and not (isnan(resistor.resistance) and isnan(resistor.resistance_max))]  # fmt: skip
    known = [resistor for resistor in resistors if not isnan(resistor.chopper_voltage_max)]
    if named and not known:
        raise InputError(
            f"{spec.where(('brake_resistor',))}: {resistors[0].part if resistors else 'it'} has no chopper of its own; "
            "expected chopper_voltage, at which that of the drives switches on"
        )
    return known


def suited(resistor: BrakeResistor, cases: Sequence[Regenerated]) -> BrakeResistor:
    """A size that is made in any resistance with the one to order."""
    if not isnan(resistor.resistance) or isnan(resistor.resistance_max):
        return resistor
    volts = resistor.chopper_voltage_min
    peaks = [case.burnt(_capacity(case, resistor, volts), 1.0).peak for case in cases]
    most = min((float(laws.largest_resistance(volts, peak)) for peak in peaks), default=inf)
    ends = resistor.resistance_min, resistor.resistance_max
    return replace(resistor, resistance=nan if isnan(most) else laws.preferred_resistance(most, ends))


def _capacity(case: Regenerated, resistor: BrakeResistor | None, volts: float) -> float:
    """Energy that the bus stores below a voltage [J]; 0 where its capacitance or the voltage is unknown."""
    own = 0.0 if resistor is None or isnan(resistor.capacitance) else resistor.capacitance
    capacitance = (case.spec.supply.capacitance or 0.0) + own
    return 0.0 if isnan(volts) else float(laws.storable_energy(capacitance, volts, case.spec.supply.highest))


def resistor_columns(
    section: Section, resistor: BrakeResistor, case: Regenerated, withstood: float
) -> list[CheckColumn]:
    """Limits of a brake resistor and its chopper in a load case.

    A shunt regulator is rated as a whole: it has no more current and power than it has to burn. A resistor withstands
    for a short time what is printed, no less than its continuous power where that is unknown.
    """
    spec, (low, high) = case.spec, (resistor.chopper_voltage_min, resistor.chopper_voltage_max)
    power = laws.derated_power(
        resistor.power, spec.environment.ambient, resistor.rated_ambient, resistor.zero_power_ambient
    )
    burnt = case.burnt(_capacity(case, resistor, low), section.averaging_time, power)
    on, current = float(laws.power_while_on(high, resistor.resistance)), float(high / resistor.resistance)
    short = resistor.peak_power if not isnan(resistor.peak_power) else power if power >= on else nan
    if resistor.kind == _SHUNT:
        by_current, by_resistance = low * resistor.chopper_current, laws.power_while_on(low, resistor.resistance)
        on, current = burnt.peak, min(current, burnt.peak / low)
        short = float(np.nanmin([resistor.peak_power, by_current, by_resistance]))
    if burnt.peak == 0.0:
        on = current = 0.0
    columns = [
        at_least("chopper_voltage", spec.supply.highest, low, by_choice=True),
        at_most("chopper_bus_voltage", high, float(np.fmin(withstood, resistor.max_voltage))),
        at_most("resistor_resistance", resistor.resistance, laws.largest_resistance(low, burnt.peak)),
        at_most(
            "chopper_current", current, resistor.chopper_current, needed=spec.margins.torque, undecided=_NO_CURRENT
        ),
        at_most("resistor_peak_power", on, short, undecided=_NO_PEAK),
        at_most("resistor_mean_power", burnt.mean, power),
        at_most("resistor_pulse_energy", burnt.pulse, resistor.pulse_energy, undecided=_NO_PEAK),
    ]
    if resistor.kind in (_SHUNT, _INSIDE) and isnan(resistor.chopper_current):  # one part, and its maker's concern
        columns = [check for check in columns if check.name != "chopper_current"]
    return columns


# -- Parts of a catalogue that a spec names for its supply: a power supply, and the chopper of a brake resistor.


def with_parts_of_supply(machine: RobotSpec, catalog: Catalog) -> RobotSpec:
    """A spec with the figures of its power supply, and of the chopper that its brake resistor brings."""
    part, section, supply = machine.supply.part, machine.brake_resistor, machine.supply
    if part is not None:
        with located(machine):
            unit = catalog.power_supplies.record(row_of(catalog, "power_supplies", part, ("supply", "part")))
        ends = (unit.voltage_min, unit.nominal_voltage, unit.voltage_max)
        least, most = float(np.nanmin(ends)), float(np.nanmax(ends))
        if not least <= supply.nominal <= most:
            gives = f"{least:g} V" if least == most else f"{least:g} V to {most:g} V"
            where = machine.where(("supply", "nominal"))
            raise InputError(f"{where}: {supply.nominal:g} V; power supply {unit.part} gives {gives}")
        machine = machine.changed(lambda spec: spec.model_copy(update={"supply": _filled(spec.supply, unit)}))
    if section is not None and section.chopper_voltage is None:
        resistors = resistor_choices(machine, catalog)
        if resistors:
            known = section.among(
                [resistor.part for resistor in resistors], min(resistor.chopper_voltage_max for resistor in resistors)
            )
            machine = machine.changed(lambda spec: spec.model_copy(update={"brake_resistor": known}))
    return machine


def _filled(supply: Supply, unit: PowerSupply) -> Supply:
    """A supply with the figures of its unit where it gives none itself; those of its current all or none."""
    listed = {"overvoltage_trip": float(np.fmin(unit.overvoltage_min, unit.return_voltage))}
    if supply.current is None:
        listed |= {"current": unit.continuous_current, "peak_current": unit.peak_current, "peak_time": unit.peak_time}
    known = {n: value for n, value in listed.items() if getattr(supply, n) is None and not isnan(value)}
    return supply.model_copy(update=known)


# -- The bus of a machine against its limits while its drives brake: brake resistor, chopper and power supply.
#
# The resistor is the machine's: it is chosen when the drive is, the smallest that holds in every load case.


_WINDOW = 60.0  # s
_NONE_LISTED = "unknown: these catalogues list none above the supply's voltage: name one that does in select.catalogs"
_STAYS = "unknown: how far regenerated energy raises the voltage: give brake_resistor or supply.capacitance"


def bus_budget(
    spec: RobotSpec, catalog: Catalog, cases: Sequence[Regenerated], withstood: float
) -> BrakingBudget | None:
    """Limits of a bus to which energies go and from which they come."""
    if not spec.limits_the_bus and not any(case.energy > 0.0 for case in cases):
        return None

    def most_voltage(spec: RobotSpec) -> float:
        """Voltage that the bus may have: what the drives withstand, and below the trip of the supply [V]."""
        trip = spec.supply.overvoltage_trip
        return float(np.fmin(withstood, nan if trip is None else trip))

    section, resistor, checks = spec.brake_resistor, None, tuple[Check, ...]()
    capacitors_do = all(case.highest_voltage() <= most_voltage(case.spec) for case in cases)
    if section is not None and not (section.may_be_none and capacitors_do):
        resistor, checks = _chosen_resistor(spec, section, catalog, cases, withstood)
    checks = (*checks, *_worst(cases, lambda case: _supply_limits(case, resistor)))
    volts = most_voltage(spec)  # at which a chopper switches on, or below which the bus has to stay
    if resistor is not None:
        volts = resistor.chopper_voltage_min
    elif spec.chopper_voltage is not None:
        volts = spec.chopper_voltage
    main = max(cases, key=lambda case: _most(case.burnt(_capacity(case, resistor, volts), _WINDOW).mean))
    return BrakingBudget(
        resistor=resistor,
        checks=checks,
        figures=_figures(main, resistor, volts, most_voltage(main.spec)),
        assumptions=tuple(_assumptions(main, section, resistor, volts)),
    )


def _worst(cases: Sequence[Regenerated], limits: Callable[[Regenerated], Iterable[CheckColumn]]) -> tuple[Check, ...]:
    """Limits of the bus in its worst load case."""
    return worst_of_cases([(case.case, [column.at((), "budget") for column in limits(case)]) for case in cases])


def _most(value: float) -> float:
    return inf if isnan(value) else value


def _chosen_resistor(
    spec: RobotSpec, section: Section, catalog: Catalog, cases: Sequence[Regenerated], withstood: float
) -> tuple[BrakeResistor | None, tuple[Check, ...]]:
    """The smallest resistor that holds, with its checks; else the one that comes closest.

    What passes comes first, then the smaller continuous power, mass and price.
    """
    choices = []
    for resistor in (suited(resistor, cases) for resistor in resistor_choices(spec, catalog)):
        own = _worst(cases, partial(resistor_columns, section, resistor, withstood=withstood))
        over = _worst(cases, partial(_over_voltage, resistor=resistor))
        bad = tuple(sum(check.status == status for check in own + over) for status in ("fail", "unknown"))
        order = (
            -GRAVEST.index(verdict(own + over)),
            *bad,
            *map(_most, (resistor.power, resistor.mass, resistor.price)),
            resistor.part,
        )
        choices.append((order, resistor, own))
    if not choices:
        return None, (fits("resistor_available", False, False)._replace(note=_NONE_LISTED).at((), "budget"),)
    return min(choices, key=lambda choice: choice[0])[1:]


def _supply_limits(case: Regenerated, resistor: BrakeResistor | None) -> Iterator[CheckColumn]:
    """Peak current and its time, continuous current, over-voltage protection; as far as they are limited."""
    yield from _over_voltage(case, resistor)
    supply, margin = case.spec.supply, case.spec.margins.torque
    if supply.peak_current is None or supply.current is None:
        return
    yield at_most("supply_continuous_current", case.mean_drawn / supply.lowest, supply.current, needed=margin)
    long = case.longest_above(supply.current * supply.lowest)
    yield at_most("supply_peak_time", long, nan if supply.peak_time is None else supply.peak_time)


def _over_voltage(case: Regenerated, resistor: BrakeResistor | None) -> list[CheckColumn]:
    """The highest voltage of the bus against the trip of the power supply."""
    supply = case.spec.supply
    if supply.overvoltage_trip is None:
        return []
    if resistor is None:
        highest = supply.highest if case.spec.accepts_all else case.highest_voltage()
    else:
        free = case.highest_voltage(0.0 if isnan(resistor.capacitance) else resistor.capacitance)
        chopped = resistor.chopper_voltage_max
        highest = chopped if isnan(free) and case.known else min(free, chopped)
    return [at_most("supply_overvoltage", highest, supply.overvoltage_trip, undecided=_STAYS)]


def _figures(case: Regenerated, resistor: BrakeResistor | None, volts: float, limit: float) -> tuple[Figure, ...]:
    """Figures that decide the choice of a resistor, or of capacitors in its place."""
    section, highest = case.spec.brake_resistor, case.spec.supply.highest
    window, current = (section.averaging_time, section.chopper_current) if section else (_WINDOW, None)
    stores = _capacity(case, resistor, volts)
    burnt: Burnt = case.burnt(stores, window)
    values = {
        "energy_regenerated": case.energy, "energy_burnt": burnt.energy, "braking_mean_power": burnt.mean,
        "braking_peak_power": burnt.peak, "braking_pulse": burnt.pulse,
        "capacitance_needed": laws.least_bus_capacitance(case.stored, limit, highest),
    }  # fmt: skip
    if stores > 0.0:
        values["energy_stored"] = stores
    if not isnan(most := float(laws.largest_resistance(volts, burnt.peak))):
        values["resistance_largest"] = most
    if current is not None:
        values["resistance_smallest"] = laws.smallest_resistance(volts, current)
    at, worst = f", at {show(volts, 'V', 'voltage')}", show(window, "s", "time")
    figures = figures_of("braking", values, at=at, window=worst)
    return tuple(replace(figure, value=resolved(figure.value, figure.kind)) for figure in figures)


def _assumptions(
    case: Regenerated, section: Section | None, resistor: BrakeResistor | None, volts: float
) -> Iterator[str]:
    if case.spec.supply.capacitance is None:
        yield "capacitance of the bus unknown: its capacitors store nothing"
    if section is not None and resistor is None:
        yield "no brake resistor is needed: the bus stays below every limit"
    if section is None and not isnan(volts):
        yield f"without a chopper: figures at {show(volts, 'V', 'voltage')}, the highest voltage that the bus may have"
    if resistor is not None and resistor.zero_power_ambient == resistor.zero_power_ambient:
        yield "the continuous power of the resistor falls in a straight line to its highest ambient"
