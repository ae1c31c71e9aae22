"""Consistency of a battery's discharge tables: among each other, with its capacities and with its voltages.

Each figure is compared with a neighbour in its table, so that a misprint is located. Charge is a constant current times
its time, energy a constant power times its time; the tolerance is half of the last printed digit of both.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from drivesizer.catalog.discharges import DISCHARGES, HELD, Discharges
from drivesizer.catalog.laws.law import DEFINITION, SLACK, Numbers, decimal_places, half_last_digit
from drivesizer.catalog.tables import Table
from drivesizer.units import show

__all__ = ["Odd", "odd_discharges"]

_HOURS = {"capacity": np.nan, "capacity_10h": 10.0, "capacity_5h": 5.0, "capacity_1h": 1.0}  # the first: rated_time
_RESTING = {"lead-acid": 1.1}  # full and at rest, per nominal voltage: 2.15 to 2.2 V of 2 V
_MEAN = 0.02  # relative: power over current is the mean voltage of two discharges that are not quite the same


class Odd(NamedTuple):
    """A contradicting entry: the battery's row, and the fields of the finding on it."""

    row: int
    finding: dict[str, Any]


def odd_discharges(given: Discharges, batteries: Table[Any]) -> Iterator[Odd]:
    """Contradictions in discharge tables."""
    for row in np.unique(given.battery).tolist():
        own = given.on(given.battery == row)
        for held, unit in HELD.items():
            some = own.on(~np.isnan(getattr(own, held)))
            draw, digit = getattr(some, held), _digit(some, held)
            yield from _along_time(row, some, draw, digit, held, unit)
            yield from _along_voltage(row, some, draw, digit, held, unit)
        yield from _capacities(row, own, batteries)
        yield from _mean_voltage(row, own, batteries)


def _digit(some: Discharges, held: str) -> Numbers:
    """Half of the last printed digit, relative: three digits, and no decimal place that no figure of that time has."""
    draw = getattr(some, held)
    places = decimal_places(draw)
    column = np.array([10.0 ** -places[some.time == time].max() for time in some.time])
    return half_last_digit(draw, column) if len(draw) else draw


def _pairs(first: Numbers, then: Numbers) -> Iterator[tuple[int, int]]:
    """Neighbours along the second column where the first is the same."""
    order = np.lexsort((then, first))
    for a, b in zip(order[:-1].tolist(), order[1:].tolist(), strict=True):
        if first[a] == first[b]:
            yield a, b


def _along_time(row: int, some: Discharges, draw: Numbers, digit: Numbers, held: str, unit: str) -> Iterator[Odd]:
    """A longer discharge draws less, and gives no less charge or energy in total."""
    total = {"current": ("charge", "A*h"), "power": ("energy", "W*h")}[held]
    for quick, slow in _pairs(some.cutoff_voltage, some.time):
        where = f"{_at(some, slow)}, beside {_hours(some.time[quick])}"
        if not draw[slow] < draw[quick]:
            yield _odd(row, f"{held} falls with time", f"less than for a shorter time: {where}", "<",
                       draw[slow], draw[quick], held, unit, 0.0)  # fmt: skip
        amount = draw * some.time
        span = digit[slow] + digit[quick]
        if amount[slow] < amount[quick] * (1.0 - span - SLACK):
            yield _odd(row, f"{total[0]} and rate", f"not below that of a faster discharge: {where}", ">=",
                       amount[slow], amount[quick], *total, span)  # fmt: skip


def _along_voltage(row: int, some: Discharges, draw: Numbers, digit: Numbers, held: str, unit: str) -> Iterator[Odd]:
    """A discharge to a lower end voltage in the same time gives no less."""
    for deep, shallow in _pairs(some.time, some.cutoff_voltage):
        span = digit[deep] + digit[shallow]
        if draw[deep] < draw[shallow] * (1.0 - span - SLACK):
            where = f"{_at(some, deep)}, beside {_volts(some.cutoff_voltage[shallow])}"
            yield _odd(row, f"{held} and end voltage", f"not below that down to more volts: {where}", ">=",
                       draw[deep], draw[shallow], held, unit, span)  # fmt: skip


def _capacities(row: int, own: Discharges, batteries: Table[Any]) -> Iterator[Odd]:
    """A printed capacity is current times time of the table, down to the end voltage where they are nearest."""
    charge, digit = own.current * own.time, _digit(own, "current")
    for name, hours in _HOURS.items():
        capacity, time = batteries[name][row], 3600.0 * hours if hours == hours else batteries["rated_time"][row]
        there = np.flatnonzero((np.abs(own.time / time - 1.0) < SLACK) & ~np.isnan(charge))
        if not len(there) or np.isnan(capacity):
            continue
        near = there[np.abs(charge[there] - capacity).argmin()]
        span = digit[near] + 0.005  # a capacity has two digits or more
        if abs(charge[near] - capacity) > capacity * (span + SLACK):
            yield _odd(row, f"{name.replace('_', ' ')} in the table", f"current x time: {_at(own, near)}", "=",
                       charge[near], capacity, "charge", "A*h", span, name)  # fmt: skip


def _mean_voltage(row: int, own: Discharges, batteries: Table[Any]) -> Iterator[Odd]:
    """Power over current for the same time and end voltage is a voltage between that end and that of a full battery."""
    nominal, chemistry = batteries["nominal_voltage"][row], str(batteries["chemistry"][row])
    full = _RESTING[chemistry] * nominal if chemistry in _RESTING else batteries["charge_voltage"][row]
    current, power = ({(v, t): n for n, (v, t, x) in enumerate(zip(own.cutoff_voltage, own.time, column, strict=True))
                       if x == x} for column in (own.current, own.power))  # fmt: skip
    span = _digit(own, "current"), _digit(own, "power")
    for key, n in current.items():
        if key not in power:
            continue
        m = power[key]
        mean, allowed = own.power[m] / own.current[n], span[0][n] + span[1][m] + _MEAN
        for relation, bound in ((">=", key[0]), ("<=", full)):
            if (bound - mean if relation == ">=" else mean - bound) > allowed * bound:
                yield _odd(row, "mean voltage", f"power by current, between the end's and a full one's: {_at(own, n)}",
                           relation, mean, bound, "voltage", "V", allowed)  # fmt: skip


def _odd(
    row: int, identity: str, meaning: str, relation: str, found: float, expected: float, kind: str, unit: str,
    tolerance: float, *fields: str,
) -> Odd:  # fmt: skip
    numbers = {"found": float(found), "expected": float(expected), "deviation": float(found / expected - 1.0)}
    words = {"identity": identity, "meaning": meaning, "relation": relation, "kind": kind, "unit": unit}
    limits = {"tolerance": float(tolerance), "reason": "half of the last printed digits", "source": DEFINITION}
    return Odd(row, words | numbers | limits | {"fields": (DISCHARGES, *fields)})


def _at(own: Discharges, place: int) -> str:
    return f"{_hours(own.time[place])} to {_volts(own.cutoff_voltage[place])}"


def _hours(time: float) -> str:
    return show(time, "h" if time >= 3600.0 else "min", "time")


def _volts(voltage: float) -> str:
    return show(voltage, "V", "voltage")
