"""The parts list of a machine of several axes: equal parts of several axes are one line, at their common price."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from drivesizer.catalog.lookup import origins
from drivesizer.catalog.query import Hit
from drivesizer.output.part_line import PartLine, line_of, price_for, resistor_line
from drivesizer.output.part_totals import Total, named_totals
from drivesizer.output.part_words import SAID
from drivesizer.output.parts import machine_parts
from drivesizer.results.drive_set import section_of

if TYPE_CHECKING:
    from drivesizer.results.machine import AxisSizing, MachineSizing

__all__ = ["SharedLine", "machine_parts_of_axes", "parts_by_axis", "totals_of_axes"]


class SharedLine(NamedTuple):
    """A line of the parts list of a machine of several axes."""

    line: PartLine  # its quantity and its price are those of all axes
    axes: tuple[str, ...]  # names of those that need the part


def machine_parts_of_axes(sizing: MachineSizing) -> list[SharedLine]:
    """The parts list of a machine of several axes: equal parts of several axes are one line."""
    found: dict[str, list[tuple[str, PartLine]]] = {}
    for name, lines in parts_by_axis(sizing).items():
        for line in lines:  # NaN is not equal to itself, its text is
            found.setdefault(repr(replace(line, quantity=0)), []).append((name, line))
    shared = map(_together, found.values())
    return sorted([*shared, *_common_supply(sizing)], key=lambda one: _place(one.line.role))


def _together(equal: Sequence[tuple[str, PartLine]]) -> SharedLine:
    """Equal lines of several axes as one."""
    count = sum(line.quantity for _, line in equal)
    return SharedLine(replace(equal[0][1], quantity=count), tuple(name for name, _ in equal))


def _common_supply(sizing: MachineSizing) -> Iterator[SharedLine]:
    """Power supply and brake resistor of all axes; those of a single one are in its own list."""
    part = sizing.machine.supply.part
    on_it = tuple(axis.name for axis in sizing.machine.axes if not axis.own_supply)
    catalogs = (axis.result.problem.catalog for axis in sizing.axes)
    listed = next((one for one in catalogs if part in one.power_supplies.rows), None) if len(sizing.axes) > 1 else None
    if part is not None and listed is not None:
        unit = listed.power_supplies.record(listed.power_supplies.rows[part])
        yield SharedLine(line_of("power supply", unit, listed, 1, {"mass": unit.mass}), on_it)
    resistor = sizing.power.braking.resistor if sizing.power and sizing.power.braking else None
    if resistor is not None:
        every = [axis.result.problem.catalog for axis in sizing.axes]
        catalog = next((one for one in every if resistor.part in one.brake_resistors.rows), every[0])
        yield SharedLine(resistor_line(resistor, catalog), on_it)


def _place(role: str) -> int:
    """Place of a role in the list; a gear of fixed ratio, which is named by its kind, stands with the gearheads."""
    return list(SAID).index(role if role in SAID else "gearhead")


def parts_by_axis(sizing: MachineSizing) -> dict[str, list[PartLine]]:
    """The parts lists of all axes of a machine, at the prices of the quantity of all of them."""
    found = {one.name: machine_parts(one.best, one.result.problem) if one.best else [] for one in sizing.axes}
    count = Counter[tuple[str, str, str]]()
    for line in (line for lines in found.values() for line in lines):
        count[line.role, line.maker, line.part] += line.quantity
    return {
        one.name: [_quantity_price(line, one, count[line.role, line.maker, line.part]) for line in found[one.name]]
        for one in sizing.axes
    }


def _quantity_price(line: PartLine, axis: AxisSizing, pieces: int) -> PartLine:
    """A line with the price for so many pieces."""
    if not line.part or axis.best is None or pieces == line.quantity:
        return line
    catalog = axis.result.problem.catalog
    section = _SUPPLY_SECTIONS.get(line.role) or section_of(axis.best.parts[line.role])
    row = catalog.table(section).rows[line.part]
    known = origins(Hit("", catalog, section, row))
    return replace(line, **price_for(catalog.table(section).record(row), pieces, known))


_SUPPLY_SECTIONS = {"power supply": "power_supplies", "brake resistor": "brake_resistors"}


def totals_of_axes(lines: Sequence[SharedLine]) -> list[Total]:
    """Mass and price of a machine of several axes."""
    return named_totals([one.line for one in lines], [f"{one.line.role} of {', '.join(one.axes)}" for one in lines])
