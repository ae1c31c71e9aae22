"""Parts of a catalogue that a spec names for its supply: a power supply, and the chopper of a brake resistor."""

from __future__ import annotations

from math import isnan
from typing import Any

import numpy as np

from drivesizer.catalog import Catalog, PowerSupply
from drivesizer.errors import InputError, nearest, quoted
from drivesizer.machine.brake_resistors import resistor_choices
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.sections import Supply

__all__ = ["power_supply_of", "with_parts_of_supply"]


def power_supply_of(spec: RobotSpec, catalog: Catalog) -> PowerSupply | None:
    """The power supply that a spec names; None where it names none."""
    part = spec.supply.part
    if part is None:
        return None
    rows = catalog.power_supplies.rows
    if part not in rows:
        hint = nearest(part, rows) or "; a catalogue of its maker belongs under select.catalogs"
        raise InputError(
            f"{spec.where(('supply', 'part'))}: {quoted(part)} is not in {', '.join(catalog.digests)}{hint}"
        )
    return catalog.power_supplies.record(rows[part])


def with_parts_of_supply(machine: RobotSpec, catalog: Catalog) -> RobotSpec:
    """A spec with the figures of its power supply, and of the chopper that its brake resistor brings."""
    unit, section = power_supply_of(machine, catalog), machine.brake_resistor
    if unit is not None:
        _refuse_voltage(machine, unit)
        machine = machine.changed(lambda spec: spec.model_copy(update={"supply": _filled(spec.supply, unit)}))
    if section is not None and section.chopper_voltage is None:
        every = resistor_choices(machine, catalog)
        if every:
            known = section.among([one.part for one in every], min(one.chopper_voltage_max for one in every))
            machine = machine.changed(lambda spec: spec.model_copy(update={"brake_resistor": known}))
    return machine


def _refuse_voltage(machine: RobotSpec, unit: PowerSupply) -> None:
    """Refuse a power supply whose output cannot be set to the nominal voltage."""
    ends = (unit.voltage_min, unit.nominal_voltage, unit.voltage_max)
    least, most = float(np.nanmin(ends)), float(np.nanmax(ends))
    if not least <= machine.supply.nominal <= most:
        gives = f"{least:g} V" if least == most else f"{least:g} V to {most:g} V"
        where, nominal = machine.where(("supply", "nominal")), machine.supply.nominal
        raise InputError(f"{where}: {nominal:g} V; power supply {unit.part} gives {gives}")


def _filled(supply: Supply, unit: PowerSupply) -> Supply:
    """A supply with the figures of its unit where it gives none itself."""
    withstands = float(np.fmin(unit.overvoltage_min, unit.return_voltage))
    listed = {
        "current": unit.continuous_current,
        "peak_current": unit.peak_current,
        "peak_time": unit.peak_time,
        "overvoltage_trip": withstands,
    }
    own = {"current", "peak_current", "peak_time"} if supply.current is not None else set[str]()
    known: dict[str, Any] = {
        name: value
        for name, value in listed.items()
        if getattr(supply, name) is None and name not in own and not isnan(value)
    }
    return supply.model_copy(update=known)
