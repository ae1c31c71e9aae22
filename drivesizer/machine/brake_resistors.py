"""Brake resistors that a spec offers, and each against what a machine regenerates.

Symbols: U_ch voltage of the chopper [V], R resistance [ohm], P power [W].
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import inf, isnan, nan
from typing import TYPE_CHECKING

import numpy as np

from drivesizer.catalog import BrakeResistor, Catalog
from drivesizer.errors import InputError, nearest, quoted
from drivesizer.machine.regenerated import OnTheBus
from drivesizer.physics.elements.brake_resistor import (
    derated_power,
    largest_resistance,
    power_while_on,
    preferred_resistance,
    storable_energy,
)
from drivesizer.results.check_columns import CheckColumn, at_least, at_most
from drivesizer.spec.robot import RobotSpec

if TYPE_CHECKING:
    from drivesizer.spec.brake_resistor import BrakeResistor as Section

__all__ = ["resistor_choices", "resistor_columns", "suited"]

_SHUNT = "shunt regulator"
_INSIDE = "inside a drive"
_NO_CURRENT = "unknown: give brake_resistor.chopper_current"
_NO_PEAK = "unknown: no data sheet gives it; give brake_resistor with figures of its own"


def resistor_choices(spec: RobotSpec, catalog: Catalog) -> list[BrakeResistor]:
    """The brake resistors among which a spec leaves the choice, each with the chopper that switches it."""
    section = spec.brake_resistor
    assert section is not None
    if section.resistance is not None:
        return [_given_resistor(section)]
    table = catalog.brake_resistors
    named = _named(spec, section, catalog)
    rows = [row for row in range(len(table)) if not table.excluded[row] and (named is None or row in named)]
    found = [_switched(table.record(row), section) for row in rows]
    if not section.part:
        found = [one for one in found if _is_one_of(one, section, max(s.supply.highest for _, s in spec.load_cases))]
    known = [one for one in found if not isnan(one.chopper_voltage_max)]
    if named is not None and not known:
        raise InputError(
            f"{spec.where(('brake_resistor',))}: {found[0].part if found else 'it'} has no chopper of its own; "
            "expected chopper_voltage, at which that of the drives switches on"
        )
    return known


def _given_resistor(section: Section) -> BrakeResistor:
    """The resistor that a spec gives by its figures."""
    figures = {name: getattr(section, name) for name in ("resistance", "power", "peak_power", "pulse_energy")}
    volts = nan if section.chopper_voltage is None else section.chopper_voltage
    return BrakeResistor(
        kind="resistor",
        chopper_voltage_min=volts,
        chopper_voltage_max=volts,
        chopper_current=section.chopper_current or nan,
        **{name: value for name, value in figures.items() if value is not None},
    )


def _named(spec: RobotSpec, section: Section, catalog: Catalog) -> set[int] | None:
    """Rows of the families and parts that a spec names; None where it names none."""
    table, names = catalog.brake_resistors, [*(section.family or ()), *(section.part or ())]
    found = set[int]()
    for field in ("family", "part"):
        for name in getattr(section, field) or ():
            pattern = re.compile(re.escape(name).replace(r"\*", ".*"), re.IGNORECASE)
            rows = [row for row, value in enumerate(table[field].tolist()) if pattern.fullmatch(value)]
            if not rows:
                hint, where = nearest(name, dict.fromkeys(table[field].tolist())), spec.where(("brake_resistor", field))
                raise InputError(f"{where}: {quoted(name)} is not in {', '.join(catalog.digests)}{hint}")
            found.update(rows)
    return found if names else None


def _switched(one: BrakeResistor, section: Section) -> BrakeResistor:
    """A part of a catalogue with the chopper of the spec, where it has none of its own."""
    if one.kind == _SHUNT or section.chopper_voltage is None:
        return one
    volts, current = section.chopper_voltage, section.chopper_current or one.chopper_current
    return replace(one, chopper_voltage_min=volts, chopper_voltage_max=volts, chopper_current=current)


def _is_one_of(one: BrakeResistor, section: Section, highest: float) -> bool:
    """Whether it is a choice beside others: a resistor for the chopper that is given, else a shunt regulator."""
    kind = "resistor" if section.chopper_voltage is not None else _SHUNT
    known = not (isnan(one.resistance) and isnan(one.resistance_max))
    return one.kind == kind and known and not one.chopper_voltage_min < highest


def suited(one: BrakeResistor, cases: Sequence[OnTheBus]) -> BrakeResistor:
    """A size that is made in any resistance with the one to order."""
    if not isnan(one.resistance) or isnan(one.resistance_max):
        return one
    most = min((float(largest_resistance(one.chopper_voltage_min, _peak(one, case))) for case in cases), default=inf)
    ends = one.resistance_min, one.resistance_max
    return replace(one, resistance=nan if isnan(most) else preferred_resistance(most, ends))


def _capacity(one: BrakeResistor, case: OnTheBus) -> float:
    """Energy that the bus stores before the chopper switches on [J]."""
    own = 0.0 if isnan(one.capacitance) else one.capacitance
    capacitance = (case.spec.supply.capacitance or 0.0) + own
    return float(storable_energy(capacitance, one.chopper_voltage_min, case.spec.supply.highest))


def _peak(one: BrakeResistor, case: OnTheBus) -> float:
    return case.burnt(_capacity(one, case), 1.0).peak


def resistor_columns(section: Section, one: BrakeResistor, case: OnTheBus, withstood: float) -> list[CheckColumn]:
    """Limits of a brake resistor and its chopper in a load case."""
    spec, volts = case.spec, (one.chopper_voltage_min, one.chopper_voltage_max)
    power = derated_power(one.power, spec.environment.ambient, one.rated_ambient, one.zero_power_ambient)
    burnt = case.burnt(_capacity(one, case), section.averaging_time, power)
    bus = float(np.fmin(withstood, one.max_voltage))
    idle = burnt.peak == 0.0
    return [
        at_least("chopper_voltage", spec.supply.highest, volts[0], by_choice=True),
        at_most("chopper_bus_voltage", volts[1], bus),
        at_most("resistor_resistance", one.resistance, largest_resistance(volts[0], burnt.peak)),
        *_chopper_current(one, burnt.peak, spec.margins.torque),
        at_most("resistor_peak_power", 0.0 if idle else _while_on(one, burnt.peak), _short_time(one, power),
                undecided=_NO_PEAK),
        at_most("resistor_mean_power", burnt.mean, power),
        at_most("resistor_pulse_energy", burnt.pulse, one.pulse_energy, undecided=_NO_PEAK),
    ]  # fmt: skip


def _chopper_current(one: BrakeResistor, peak: float, needed: float) -> Iterator[CheckColumn]:
    """Its current: that of the resistor, or of a shunt regulator no more than it has to burn."""
    if one.kind in (_SHUNT, _INSIDE) and isnan(one.chopper_current):
        return  # chopper and resistor are one part, and its maker's concern
    whole = float(one.chopper_voltage_max / one.resistance)
    drawn = min(whole, peak / one.chopper_voltage_min) if one.kind == _SHUNT else whole
    yield at_most("chopper_current", 0.0 if peak == 0.0 else drawn, one.chopper_current, needed=needed,
                  undecided=_NO_CURRENT)  # fmt: skip


def _while_on(one: BrakeResistor, peak: float) -> float:
    """Power of the resistor while its chopper is on; of a shunt regulator, which is rated as a whole, what it burns."""
    return peak if one.kind == _SHUNT else float(power_while_on(one.chopper_voltage_max, one.resistance))


def _short_time(one: BrakeResistor, power: float) -> float:
    """Power that it withstands for a short time: as printed, no less than its continuous one where that is unknown.

    Of a shunt regulator without a print what its resistor and its current leave.
    """
    if one.kind != _SHUNT:
        on = float(power_while_on(one.chopper_voltage_max, one.resistance))
        return one.peak_power if not isnan(one.peak_power) else power if power >= on else nan
    by_current = one.chopper_voltage_min * one.chopper_current
    return float(np.nanmin([one.peak_power, by_current, power_while_on(one.chopper_voltage_min, one.resistance)]))
