"""Parts lists of a drive in its machine and of several axes: lines as they are ordered, totals of mass and price."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import isnan, nan
from typing import TYPE_CHECKING, Any, NamedTuple

from drivesizer.catalog import Belt, BrakeResistor, Catalog, Note, Pulley, Source, columns_of
from drivesizer.catalog.prices import price_of
from drivesizer.catalog.query import PartRow, origins
from drivesizer.files.text import listed
from drivesizer.machine.budgets import drive_rows
from drivesizer.output.words import LESS, confidences, figure, not_quoted
from drivesizer.results.drive_set import DriveSet, section_of
from drivesizer.results.problem import Problem
from drivesizer.spec.drive import GearStage
from drivesizer.units import show

if TYPE_CHECKING:
    from drivesizer.results.machine import AxisSizing, MachineSizing


# -- Sums over the parts of a drive, for several kinds of report.


def unknown_of(drive_set: DriveSet, known: tuple[str, ...]) -> tuple[str, ...]:
    """The parts of a drive that a sum does not cover."""
    return tuple(name for name in drive_set.parts if name not in known)


# -- Parts of a drive in a few words, for a parts list.


def _figures_of(*names: str) -> Callable[[Any], str]:
    def words(part: Any) -> str:
        columns = columns_of(section_of(part))
        return ", ".join(show(getattr(part, name), columns[name].unit, columns[name].kind) for name in names)

    return words


def _toothed(part: Belt | Pulley) -> str:
    return f"{part.profile} {show(part.pitch, 'mm', 'length')}, {part.teeth:.0f} teeth"


def _pulley(part: Pulley) -> str:
    return _toothed(part) + (f", bore {part.bore}" if part.bore else "")


_MOTOR = _figures_of("assigned_power", "nominal_voltage")
_STEPPER = _figures_of("holding_torque", "nominal_current")
DESCRIPTIONS: dict[str, Callable[[Any], str]] = {
    "motor": lambda part: (_STEPPER if part.kind == "stepper" else _MOTOR)(part),
    "gearhead": lambda part: f"{part.reduction}, exactly {part.ratio:.5g}".removeprefix(", "),
    "driving pulley": _pulley,
    "belt": lambda part: f"{_toothed(part)}, {show(part.width, 'mm', 'length')} wide",
    "driven pulley": _pulley,
    "screw": lambda part: f"{part.kind} screw",
    "brake": _figures_of("static_torque", "supply"),
    "encoder": lambda part: part.resolution,
    "controller": lambda part: part.buses.replace(";", ","),
    "actuator": _figures_of("nominal_voltage", "nominal_torque"),
    "power supply": _figures_of("nominal_voltage", "continuous_current"),
    "brake resistor": _figures_of("resistance", "power"),
}
"""Noun of a part, by its role."""


# -- A line of a parts list: one part of a catalogue, as it is ordered, with its mass and price.
#
# What no catalogue gives is left open: an order number, a price, a cable.


@dataclass(frozen=True, slots=True, kw_only=True)
class PartLine:
    """One line of a parts list; an empty text or NaN is unknown."""

    role: str  # motor, gearhead, driving pulley ...
    maker: str = ""
    family: str = ""
    part: str = ""  # its name in the catalogue
    order_number: str = ""  # as its maker sells it; mostly the same
    said: str = ""  # what it is, in words
    quantity: int  # of the whole machine
    mass: float = nan  # kg, of one
    mass_low: float = nan  # kg, 5th percentile where the mass is estimated; else NaN
    mass_high: float = nan  # kg, 95th percentile
    price: float = nan  # of one, in the currency
    currency: str = ""
    pieces: int | None = None  # from so many on that price holds
    price_date: str = ""
    seller: str = ""
    delivery: str = ""
    ordered_with: str = ""  # the role of the part that it is an option of
    price_source: str = ""  # the document
    price_confidence: str = ""
    document: str = ""  # where the part comes from
    date: str = ""
    confidence: str = ""  # of its number
    url: str = ""
    note: str = ""  # what the catalogue remarks on number, price, mass or the part as a whole

    @property
    def together(self) -> float:
        """The price of all of them."""
        return self.quantity * self.price


NO_NUMBER = "no order number known"  # so a catalogue marks a part whose name is not the maker's
_OF_BUYING = {"part", "mass", "price", "price_5", "price_20", "list_price", "foreign_price"}


def line_of(role: str, part: Any, catalog: Catalog, quantity: int, mass: dict[str, Any]) -> PartLine:
    """A part as a line."""
    if part is None:
        return PartLine(role=role, quantity=quantity, **mass)
    section = section_of(part)
    known = origins(PartRow("", catalog, section, catalog.table(section).rows[part.part]))
    notes, source = _remarks(catalog, part), known["part"]
    ordered = {"order_number": _number(catalog, part)} | price_for(part, quantity, catalog)
    remarks = []
    for note in notes:  # with the figures that it concerns, as far as they are for ordering
        on = ", ".join(name.replace("_", " ") for name in note.fields if name in _OF_BUYING)
        remarks.append(f"{on}: {note.text}" if on else note.text)
    if (price := price_of(catalog, section, part.part, quantity)) and price.note:
        remarks.append(f"price: {price.note}")
    return PartLine(
        role=role, maker=part.manufacturer, family=part.family, part=part.part,
        said=DESCRIPTIONS[role](part), quantity=quantity, **mass, **ordered,
        ordered_with="motor" if role == "brake" and not part.mounting and part.manufacturer else "",
        document=source.document, date=source.date, confidence=source.confidence, url=source.url,
        note="; ".join(dict.fromkeys(filter(None, remarks))),
    )  # fmt: skip


def price_for(part: Any, quantity: int, catalog: Catalog) -> dict[str, Any]:
    """The price of a part for a quantity, with the number by which its seller knows it."""
    section = section_of(part)
    price = price_of(catalog, section, part.part, quantity)
    if price is None:
        return {}
    if price.column:
        of = catalog.unpriced if catalog.unpriced and part.part in catalog.unpriced.table(section).rows else catalog
        known = origins(PartRow("", of, section, of.table(section).rows[part.part]))
        source = known.get(price.column, Source("", ""))
        price = price._replace(date=source.date, document=source.document, confidence=source.confidence)
    order = {"order_number": price.order_number} if price.order_number else {}
    return order | {"price": price.amount, "currency": price.currency or "of unknown currency", "pieces": price.pieces,
                    "price_date": price.date, "seller": price.seller, "delivery": price.delivery,
                    "price_source": price.document, "price_confidence": price.confidence}  # fmt: skip


def _number(catalog: Catalog, part: Any) -> str:
    """The order number of a part; empty where the name in the catalogue is the catalogue's own."""
    known = not any(NO_NUMBER in note.text for note in _remarks(catalog, part))
    return (getattr(part, "order_number", "") or str(part.part)) if known else ""


def _remarks(catalog: Catalog, part: Any) -> list[Note]:
    """Notes on the part as a whole, or on figures for ordering."""
    notes = catalog.notes_on(section_of(part), part.part)
    return [note for note in notes if not note.fields or _OF_BUYING & set(note.fields)]


# -- Totals of a parts list, mass and prices, and how they are printed.


@dataclass(frozen=True, slots=True, kw_only=True)
class Total:
    """A total of a parts list, as far as known."""

    name: str  # mass, price
    value: float  # kg, or in the currency
    unit: str  # kg or the currency
    over: tuple[str, ...]  # roles that it sums
    lacks: tuple[str, ...]  # roles that it leaves out, unknown
    low: float  # with estimated figures at their 5th percentile
    high: float  # and at their 95th
    estimated: tuple[str, ...] = ()  # roles whose figure is estimated


def totals(lines: Sequence[PartLine]) -> list[Total]:
    """Mass and price of the whole list; prices by currency, and no line for what no part has."""
    return named_totals(lines, [line.role for line in lines])


def named_totals(lines: Sequence[PartLine], names: Sequence[str]) -> list[Total]:
    """Mass and price of lines of which several may have a role."""
    masses = [(x.quantity * x.mass, x.quantity * x.mass_low, x.quantity * x.mass_high) for x in lines]
    figures: list[tuple[str, str, list[tuple[float, float, float]]]] = [("mass", "kg", masses)]
    for currency in dict.fromkeys(line.currency for line in lines if line.currency):
        prices = [(x.quantity * x.price if x.currency == currency else nan, nan, nan) for x in lines]
        figures.append(("price", currency, prices))
    roles = [(line.role, name) for line, name in zip(lines, names, strict=True)]
    sums = [_total(name, unit, [*zip(roles, values, strict=True)]) for name, unit, values in figures]
    return [total for total in sums if total.over]


def _total(name: str, unit: str, values: Sequence[tuple[tuple[str, str], tuple[float, float, float]]]) -> Total:
    """Sum of value, low and high end of each line; what has no band counts at its value at both ends."""
    known = [(role, value) for (role, _), value in values if not isnan(value[0])]
    low, high = (sum(v[0] if isnan(v[end]) else v[end] for _, v in known) for end in (1, 2))
    over = _once(role for role, _ in known)
    return Total(
        name=name, value=sum(value[0] for _, value in known), unit=unit, over=over,
        lacks=_once(named if role in over else role for (role, named), value in values if isnan(value[0])),
        low=low, high=high, estimated=_once(role for role, value in known if not isnan(value[1])),
    )  # fmt: skip


def _once(names: Iterable[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(names))


# -- The parts of a drive in its machine, as the report shows them and as a list for ordering.


OWN_SUPPLY = "of its own supply"  # behind the voltage of a brake that is not that of the machine


def parts_list(drive: DriveSet, catalog: Catalog, drives: int, belt: float | None = None) -> list[PartLine]:
    """The parts list of a machine: a line for each part of a drive."""
    masses: dict[str, dict[str, Any]] = {}
    for row in drive_rows(drive, drives, catalog, belt):  # with a band where it is estimated
        low, high = row.band or (nan, nan)
        masses[row.name] = {"mass": row.each, "mass_low": low, "mass_high": high}
    lines = [line_of(role, part, catalog, drives, masses[role]) for role, part in drive.parts.items()]
    lines = [replace(x, said=", ".join((x.said, *drive.belt_running))) if x.role == "belt" else x for x in lines]
    if drive.encoder and drive.encoder.manufacturer == drive.motor.manufacturer:  # its maker mounts it
        lines = [replace(x, ordered_with="motor") if x.role == "encoder" else x for x in lines]
    if drive.without_controller:
        lines = [replace(x, said=drive.without_controller) if x.role == "controller" else x for x in lines]
    if drive.motor.controller:
        lines = [replace(x, said=f"{drive.motor.controller} inside") if x.role == "motor" else x for x in lines]
    if drive.chosen_screw:
        lines = [replace(x, said=drive.chosen_screw.running) if x.role == "screw" else x for x in lines]
    if not drive.belt_drive and (drive.belt_ratio != 1.0 or drive.belt_efficiency != 1.0):  # a belt of no known parts
        place = 1 + next((n for n, role in enumerate(drive.parts) if role == "gearhead"), 0)
        words = f"{drive.belt_ratio:g} : 1, efficiency {100 * drive.belt_efficiency:.4g} %"
        lines.insert(place, PartLine(role="belt", said=words, quantity=drives, **masses.get("belt and pulleys", {})))
    if brake := _unlisted_brake(drive):
        place = next((n for n, line in enumerate(lines) if line.role in ("encoder", "controller")), len(lines))
        lines.insert(place, PartLine(role="brake", said=brake, quantity=drives))
    return lines


def machine_parts(drive: DriveSet, problem: Problem) -> list[PartLine]:
    """The parts list of the machine of a sizing."""
    spec = problem.machine
    lines = parts_list(drive, problem.catalog, spec.load.motors, spec.belt.mass if spec.belt else None)
    apart = any(check.name == "brake_voltage" and check.note for check in drive.every_check)
    own = apart if spec.supply.brakes is None else spec.supply.brakes != spec.supply.nominal
    if drive.brake and not isnan(drive.brake.supply) and own:
        lines = [replace(x, said=f"{x.said} {OWN_SUPPLY}") if x.role == "brake" else x for x in lines]
    if spec.gear is not None:
        behind = ["gearhead"] if spec.gear_before_belt else ["gearhead", "belt", "driven pulley"]
        place = 1 + max((n for n, line in enumerate(lines) if line.role in behind), default=0)
        lines.insert(place, _gear_line(spec.gear, spec.load.motors))
    resistor = drive.braking.resistor if drive.braking else None
    return [*lines, *_supply_lines(problem.machine.supply.part, resistor, [problem.catalog])]


def _supply_lines(
    supply: str | None, resistor: BrakeResistor | None, catalogs: Sequence[Catalog]
) -> Iterator[PartLine]:
    """Power supply and brake resistor, one each for the machine; a resistor may be described by the spec alone."""
    for catalog in [catalog for catalog in catalogs if supply in catalog.power_supplies.rows][:1]:
        unit = catalog.power_supplies.record(catalog.power_supplies.rows[str(supply)])
        yield line_of("power supply", unit, catalog, 1, {"mass": unit.mass})
    if resistor is not None and resistor.part:
        catalog = next((catalog for catalog in catalogs if resistor.part in catalog.brake_resistors.rows), catalogs[0])
        yield line_of("brake resistor", resistor, catalog, 1, {"mass": resistor.mass})
    elif resistor is not None:
        yield PartLine(role="brake resistor", said=DESCRIPTIONS["brake resistor"](resistor), quantity=1)


def _gear_line(gear: GearStage, drives: int) -> PartLine:
    """The line of a gear of fixed ratio, which the spec gives."""
    back = gear.fixed_gear().back_efficiency
    behind = ", self-locking" if back <= 0.0 else f", {100 * back:.4g} % driven back" if back != gear.efficiency else ""
    words = f"{gear.ratio:g} : 1, efficiency {100 * gear.efficiency:.4g} %{behind}"
    return PartLine(role=gear.kind, said=words, quantity=drives, mass=nan if gear.mass is None else gear.mass)


def _unlisted_brake(drive: DriveSet) -> str:
    """The brake that a drive must have to hold its load and that no catalogue lists, in words; else nothing."""
    checks = {check.name: check for check in drive.own_checks}
    fits, holding = checks.get("brake_fits"), checks.get("holding")
    if drive.brake is not None or fits is None or fits.status != "unknown" or holding is None:
        return ""
    torque = holding.demand * (1.0 + holding.needed)
    least = "" if isnan(torque) else f"; to hold {show(torque, 'mN*m', 'torque')} at the motor"
    return f"none is listed{least}"


# -- The parts list of a machine of several axes: equal parts of several axes are one line, at their common price.


class SharedLine(NamedTuple):
    """A line of the parts list of a machine of several axes."""

    line: PartLine  # its quantity and its price are those of all axes
    axes: tuple[str, ...]  # names of those that need the part


def machine_parts_of_axes(sizing: MachineSizing) -> list[SharedLine]:
    """The parts list of a machine of several axes: equal parts of several axes are one line."""
    equal_lines: dict[str, list[tuple[str, PartLine]]] = {}
    for name, lines in parts_by_axis(sizing).items():
        for line in lines:  # NaN is not equal to itself, its text is
            equal_lines.setdefault(repr(replace(line, quantity=0)), []).append((name, line))
    shared = [
        SharedLine(replace(equal[0][1], quantity=sum(line.quantity for _, line in equal)), tuple(n for n, _ in equal))
        for equal in equal_lines.values()
    ]
    supply = sizing.machine.supply.part if len(sizing.axes) > 1 else None  # that of a single axis is in its own list
    resistor = sizing.power.braking.resistor if sizing.power and sizing.power.braking else None
    on_it = tuple(axis.name for axis in sizing.machine.axes if not axis.own_supply)
    common = _supply_lines(supply, resistor, [axis.result.problem.catalog for axis in sizing.axes])
    return sorted(
        [*shared, *(SharedLine(line, on_it) for line in common)], key=lambda shared_line: _place(shared_line.line.role)
    )


def _place(role: str) -> int:
    """Place of a role in the list; a gear of fixed ratio, which is named by its kind, stands with the gearheads."""
    return list(DESCRIPTIONS).index(role if role in DESCRIPTIONS else "gearhead")


def parts_by_axis(sizing: MachineSizing) -> dict[str, list[PartLine]]:
    """The parts lists of all axes of a machine, at the prices of the quantity of all of them."""
    lists = {axis.name: machine_parts(axis.best, axis.result.problem) if axis.best else [] for axis in sizing.axes}
    count = Counter[tuple[str, str, str]]()
    for line in (line for lines in lists.values() for line in lines):
        count[line.role, line.maker, line.part] += line.quantity
    return {
        axis.name: [_quantity_price(line, axis, count[line.role, line.maker, line.part]) for line in lists[axis.name]]
        for axis in sizing.axes
    }


def _quantity_price(line: PartLine, axis: AxisSizing, pieces: int) -> PartLine:
    """A line with the price for so many pieces."""
    if not line.part or axis.best is None or pieces == line.quantity:
        return line
    catalog = axis.result.problem.catalog
    section = _SUPPLY_SECTIONS.get(line.role) or section_of(axis.best.parts[line.role])
    row = catalog.table(section).rows[line.part]
    return replace(line, **price_for(catalog.table(section).record(row), pieces, catalog))


_SUPPLY_SECTIONS = {"power supply": "power_supplies", "brake resistor": "brake_resistors"}


def totals_of_axes(lines: Sequence[SharedLine]) -> list[Total]:
    """Mass and price of a machine of several axes."""
    return named_totals(
        [shared.line for shared in lines], [f"{shared.line.role} of {', '.join(shared.axes)}" for shared in lines]
    )


# -- A part in a few figures, with those of them that are not from the maker's own document.


_BRIEF = {role: cells for head, (role, *cells) in listed("drivesizer.output", "parts.txt") if head == "brief"}


def part_figures(role: str, part: Any, catalog: Catalog, drive: DriveSet) -> tuple[str, str, str, str]:
    """Name and number of a part; its main figures and their confidence."""
    columns, texts = columns_of(section_of(part)), []
    for name, _, word in (cell.partition(" ") for cell in _BRIEF[role]):
        column = columns[name]._replace(kind="price", unit=catalog.currency) if name == "price" else columns[name]
        if not isnan(value := getattr(part, name)):
            texts.append(f"{figure(value, column, digits=4)} {word}".strip())
    if role == "encoder":
        texts = [part.resolution]
    if role == "motor" and part.controller:
        texts.append(f"{part.controller} inside")
    if role == "belt":
        texts += drive.belt_running
    if role == "screw" and drive.chosen_screw:
        texts = [drive.chosen_screw.running, *texts]
    if section_of(part) == "pulleys" and part.bore:
        texts.append(f"bore {part.bore}")
    figures, doubts = not_quoted(part, role, drive, catalog), []
    for level in LESS:
        names = [name.replace("_", " ") for name, value in figures.items() if value == level]
        if names and level == "secondary":
            doubts.append(f"{len(names)} of {len(confidences(part, role, drive, catalog))} figures secondary")
        elif names:
            more = f" and {len(names) - 4} more" if len(names) > 5 else ""
            doubts.append(f"{level}: {', '.join(names[: 4 if more else 5])}{more}")
    name = part.family  # the maker is obvious with one catalogue, or where the family names it
    if len(catalog.digests) > 1 and part.manufacturer not in part.family:
        name = f"{part.manufacturer} {part.family}"
    reduction = f" {part.reduction}" if role in ("gearhead", "actuator") else ""
    return f"{name}{reduction}", part.part, " · ".join(texts), "; ".join(doubts)
