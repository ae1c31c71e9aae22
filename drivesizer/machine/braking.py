"""The bus of a machine against its limits while its drives brake: brake resistor, chopper and power supply.

The resistor is the machine's: it is chosen when the drive is, the smallest that holds in every load case.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from math import inf, isnan, nan
from typing import TYPE_CHECKING, Any

import numpy as np

from drivesizer.catalog import BrakeResistor, Catalog
from drivesizer.machine.brake_resistors import resistor_choices, resistor_columns, suited
from drivesizer.machine.regenerated import Burnt, OnTheBus, regenerated
from drivesizer.physics.elements.brake_resistor import (
    largest_resistance,
    least_bus_capacitance,
    smallest_resistance,
    storable_energy,
)
from drivesizer.results.braking import BrakingBudget
from drivesizer.results.check import GRAVEST, Check, Figure, verdict
from drivesizer.results.check_columns import CheckColumn, at_most, fits
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.problem import Problem
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

if TYPE_CHECKING:
    from drivesizer.spec.brake_resistor import BrakeResistor as Section

__all__ = ["braking_budget", "bus_budget"]

Worst = Callable[[Sequence[tuple[str, Sequence[Check]]]], tuple[Check, ...]]
_WINDOW = 60.0  # s
_NONE_LISTED = "unknown: these catalogues list none above the supply's voltage: name one that does in select.catalogs"
_STAYS = "unknown: how far regenerated energy raises the voltage: give brake_resistor or supply.capacitance"


def braking_budget(problem: Problem, one: DriveParts, worst: Worst) -> BrakingBudget | None:
    """Regenerated energy of a machine with a drive, its ways from the bus, and their limits."""
    spec = problem.machine
    if spec.battery is not None or spec.supply.kind == "battery":
        return None
    withstood = one.controller.supply_max if one.controller else nan
    return bus_budget(spec, problem.catalog, regenerated(problem, one), withstood, worst)


def bus_budget(
    spec: RobotSpec, catalog: Catalog, cases: Sequence[OnTheBus], withstood: float, worst: Worst
) -> BrakingBudget | None:
    """Limits of a bus to which energies go and from which they come."""
    if not spec.limits_the_bus and not any(case.energy > 0.0 for case in cases):
        return None
    section, resistor, checks = spec.brake_resistor, None, tuple[Check, ...]()
    if section is not None and not _needless(section, cases, withstood):
        resistor, checks = _chosen_resistor(spec, catalog, cases, withstood, worst)
    checks = (*checks, *worst([(case.case, _records(_supply_limits(case, resistor))) for case in cases]))
    volts = _threshold(spec, resistor, withstood)
    main = max(cases, key=lambda case: _most(case.burnt(_capacity(case, resistor, volts), _WINDOW).mean))
    return BrakingBudget(
        resistor=resistor,
        checks=checks,
        figures=tuple(_figures(main, resistor, volts, withstood)),
        assumptions=tuple(_assumptions(main, section, resistor, volts)),
    )


def _most(value: float) -> float:
    return inf if isnan(value) else value


def _records(columns: Iterable[CheckColumn]) -> tuple[Check, ...]:
    return tuple(column.at((), "budget") for column in columns)


# --- the resistor -----------------------------------------------------------------------------------------------------


def _needless(section: Section, cases: Sequence[OnTheBus], withstood: float) -> bool:
    """Whether none need be chosen: the capacitors keep all below every limit."""
    if not section.may_be_none:
        return False
    return all(case.highest_voltage() <= np.fmin(withstood, _trip(case.spec)) for case in cases)


def _trip(spec: RobotSpec) -> float:
    return nan if spec.supply.overvoltage_trip is None else spec.supply.overvoltage_trip


def _chosen_resistor(
    spec: RobotSpec, catalog: Catalog, cases: Sequence[OnTheBus], withstood: float, worst: Worst
) -> tuple[BrakeResistor | None, tuple[Check, ...]]:
    """The smallest resistor that holds, with its checks; else the one that comes closest."""
    section = spec.brake_resistor
    assert section is not None
    every = [suited(one, cases) for one in resistor_choices(spec, catalog)]
    if not every:
        return None, _records([replace(fits("resistor_available", False, False), note=_NONE_LISTED)])

    def judged(one: BrakeResistor) -> tuple[Check, ...]:
        found = [(case.case, _records(resistor_columns(section, one, case, withstood))) for case in cases]
        tripped = [(case.case, _records(_over_voltage(case, one))) for case in cases]
        return (*worst(found), *worst(tripped))

    checks = [judged(one) for one in every]
    order = [_rank(one, some) for one, some in zip(every, checks, strict=True)]
    best = min(range(len(every)), key=lambda n: order[n])
    shown = tuple(check for check in checks[best] if check.name != "supply_overvoltage")
    return every[best], shown


def _rank(one: BrakeResistor, checks: tuple[Check, ...]) -> tuple[Any, ...]:
    """Order of choice: what passes first, then the smaller continuous power, mass and price."""
    gravest = len(GRAVEST) - GRAVEST.index(verdict(checks))
    bad = sum(check.status == "fail" for check in checks), sum(check.status == "unknown" for check in checks)
    return (gravest, *bad, _most(one.power), _most(one.mass), _most(one.price), one.part)


# --- the power supply -------------------------------------------------------------------------------------------------


def _supply_limits(case: OnTheBus, resistor: BrakeResistor | None) -> Iterator[CheckColumn]:
    """Peak current and its time, continuous current, over-voltage protection; as far as they are limited."""
    yield from _over_voltage(case, resistor)
    supply, margin = case.spec.supply, case.spec.margins.torque
    if supply.peak_current is None or supply.current is None:
        return
    yield at_most("supply_continuous_current", case.mean_drawn / supply.lowest, supply.current, needed=margin)
    long = case.longest_above(supply.current * supply.lowest)
    yield at_most("supply_peak_time", long, nan if supply.peak_time is None else supply.peak_time)


def _over_voltage(case: OnTheBus, resistor: BrakeResistor | None) -> list[CheckColumn]:
    """The highest voltage of the bus against the trip of the power supply."""
    trip = case.spec.supply.overvoltage_trip
    if trip is None:
        return []
    if resistor is not None:
        more = 0.0 if isnan(resistor.capacitance) else resistor.capacitance
        free = case.highest_voltage(more)
        held = resistor.chopper_voltage_max
        highest = held if isnan(free) and case.known else min(free, held)
    else:
        highest = case.spec.supply.highest if case.spec.accepts_all else case.highest_voltage()
    return [at_most("supply_overvoltage", highest, trip, undecided=_STAYS)]


# --- figures ----------------------------------------------------------------------------------------------------------


def _threshold(spec: RobotSpec, resistor: BrakeResistor | None, withstood: float) -> float:
    """Voltage at which a chopper switches on, or below which the bus has to stay [V]."""
    if resistor is not None:
        return resistor.chopper_voltage_min
    if spec.chopper_voltage is not None:
        return spec.chopper_voltage
    return float(np.fmin(withstood, _trip(spec)))


def _capacity(case: OnTheBus, resistor: BrakeResistor | None, volts: float) -> float:
    """Energy that the bus stores below a voltage [J]; 0 where its capacitance or the voltage is unknown."""
    own = 0.0 if resistor is None or isnan(resistor.capacitance) else resistor.capacitance
    capacitance = (case.spec.supply.capacitance or 0.0) + own
    return 0.0 if isnan(volts) else float(storable_energy(capacitance, volts, case.spec.supply.highest))


def _figures(case: OnTheBus, resistor: BrakeResistor | None, volts: float, withstood: float) -> Iterator[Figure]:
    """Figures that decide the choice of a resistor, or of capacitors in its place."""
    section, highest = case.spec.brake_resistor, case.spec.supply.highest
    window = section.averaging_time if section else _WINDOW
    worst = f"Braking power, mean of the worst {show(window, 's', 'time')}"
    stores = _capacity(case, resistor, volts)
    burnt: Burnt = case.burnt(stores, window)
    limit = float(np.fmin(withstood, _trip(case.spec)))
    at = f", at {show(volts, 'V', 'voltage')}"
    rows = [
        ("energy_regenerated", "Regenerated energy per cycle, not stored by the supply", case.energy, "energy", "J"),
        ("energy_stored", f"Energy that the bus stores{at}", stores or nan, "energy", "J"),
        ("energy_burnt", "Energy to burn per cycle", burnt.energy, "energy", "J"),
        ("braking_mean_power", worst, burnt.mean, "power", "W"),
        ("braking_peak_power", "Braking power, largest", burnt.peak, "power", "W"),
        ("braking_pulse", "Energy of the largest single braking", burnt.pulse, "energy", "J"),
        ("capacitance_needed", "Bus capacitance that needs no resistor",
         float(least_bus_capacitance(case.stored, limit, highest)), "capacitance", "mF"),
        ("resistance_largest", f"Largest resistance{at}", float(largest_resistance(volts, burnt.peak)),
         "resistance", "ohm"),
    ]  # fmt: skip
    current = section.chopper_current if section else None
    if current is not None:
        least = float(smallest_resistance(volts, current))
        rows.append(("resistance_smallest", f"Smallest resistance that the chopper can switch{at}", least,
                     "resistance", "ohm"))  # fmt: skip
    yield from (
        Figure(name=n, title=t, value=v, kind=k, unit=u)
        for n, t, v, k, u in rows
        if not (isnan(v) and n in ("energy_stored", "resistance_largest"))
    )


def _assumptions(
    case: OnTheBus, section: Section | None, resistor: BrakeResistor | None, volts: float
) -> Iterator[str]:
    if case.spec.supply.capacitance is None:
        yield "capacitance of the bus unknown: its capacitors store nothing"
    if section is not None and resistor is None:
        yield "no brake resistor is needed: the bus stays below every limit"
    if section is None and not isnan(volts):
        yield f"without a chopper: figures at {show(volts, 'V', 'voltage')}, the highest voltage that the bus may have"
    if resistor is not None and resistor.zero_power_ambient == resistor.zero_power_ambient:
        yield "the continuous power of the resistor falls in a straight line to its highest ambient"
