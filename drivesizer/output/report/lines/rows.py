"""A sizing as rows of plain data, one figure in each, under the names in ``COLUMNS``.

CSV and workbook print the same rows. Figures are floats, NaN where unknown; each is in its customary unit and in SI
beside.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import isnan
from typing import Any

from drivesizer.control.validation import Validation
from drivesizer.output.loop_table import gain_rows, loop_figures
from drivesizer.output.part_line import PartLine
from drivesizer.output.part_totals import Total
from drivesizer.output.report.lines.machine import driven_over
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.drive_set import DriveSet, Relaxation
from drivesizer.results.objectives import objective_figure
from drivesizer.results.requirement import Requirement
from drivesizer.results.sizing import Check, Figure, SizingResult
from drivesizer.units import KINDS, from_si

__all__ = [
    "COLUMNS", "Row", "battery_rows", "braking_rows", "change_row", "check_row", "closed_loop_rows", "count_rows",
    "figure_row", "front_rows", "machine_rows", "part_rows", "plain_row", "requirement_row", "row", "set_rows",
    "total_rows",
]  # fmt: skip

Row = dict[str, Any]

COLUMNS = (
    "section", "set_rank", "name", "title", "symbol", "equation", "method", "case", "value", "limit", "unit",
    "si_value", "si_limit", "si_unit", "margin", "needed_margin", "status", "at_time_s", "note",
)  # fmt: skip


def row(section: str, name: str, title: str, **more: Any) -> Row:
    """A row of a section."""
    return {"section": section, "name": name, "title": title} | more


def _figure(section: str, name: str, title: str, value: float, kind: str, unit: str) -> Row:
    si = {"si_value": value, "si_unit": KINDS[kind].si}
    return row(section, name, title, value=from_si(value, unit, kind), unit=unit, **si)


def plain_row(section: str, name: str, title: str, value: float, unit: str) -> Row:
    """A figure whose unit is the same in SI."""
    return row(section, name, title, value=value, unit=unit, si_value=value, si_unit=unit)


def figure_row(section: str, f: Figure) -> Row:
    """A figure that has no limit of its own."""
    at_time = "" if f.at_time is None else f.at_time
    return _figure(section, f.name, f.title, f.value, f.kind, f.unit) | {"at_time_s": at_time}


def requirement_row(r: Requirement) -> Row:
    """A requirement of the load, with the paper's symbol and number."""
    found = _figure("requirement", r.name, r.title, float(r.value), r.kind, r.unit)
    return found | {"symbol": r.symbol, "equation": r.equation or "", "note": r.note}


def check_row(section: str, c: Check) -> Row:
    """A check: its demand as value, its limit, margin and status."""
    return _figure(section, c.name, c.title, c.demand, c.kind, c.unit) | {
        "method": c.method,
        "case": c.case,
        "limit": from_si(c.limit, c.unit, c.kind),
        "si_limit": c.limit,
        "margin": c.margin,
        "needed_margin": c.needed,
        "status": c.status,
        "at_time_s": "" if c.at_time is None else c.at_time,
        "note": c.note,
    }


def battery_rows(s: DriveSet) -> Iterator[Row]:
    """The consumers of the battery, mean power as value and highest as limit, and the figures of the battery."""
    if s.energy is None:
        return
    for one in s.energy.consumers:
        found = _figure("consumer", one.name, one.name, one.mean, "power", "W")
        said = f"{one.number} of them" + (", assumed" if one.assumed else "")
        status = "unknown" if isnan(one.mean) else ""
        yield found | {"limit": one.peak, "si_limit": one.peak, "note": said, "how_many": one.number, "status": status}
    yield from (figure_row("battery", figure) for figure in s.energy.figures)


def braking_rows(s: DriveSet) -> Iterator[Row]:
    """Figures of what is regenerated and of the brake resistor."""
    if s.braking is None:
        return
    resistor = s.braking.resistor
    if resistor is not None:
        title = f"{resistor.manufacturer} {resistor.family}".strip() or "as the spec gives it"
        yield row("braking", "brake_resistor", title, value=resistor.part)
    yield from (figure_row("braking", figure) for figure in s.braking.figures)


def machine_rows(s: DriveSet) -> Iterator[Row]:
    """The masses of the machine, all pieces of a part together, and its figures with the drive."""
    for one in s.masses:
        found = _figure("mass", one.name, one.name, one.total, "mass", "kg")
        each = one.text(one.each, "kg")
        said = f"{one.number} of {each}" if one.number > 1 else each if one.band else ""
        yield found | {"each": one.each, "how_many": one.number, "note": said,
                     "status": "unknown" if isnan(one.each) else ""}  # fmt: skip
    yield from (figure_row("machine", figure) for figure in s.machine)


def change_row(r: Relaxation) -> Row:
    """A change after which a drive passes: the figure now as value, the needed one as limit."""
    found = _figure("change", r.field, "Change of the spec", r.before, r.kind, r.unit)
    note = f"{r.now} to {r.needed}: then {r.set_label} passes"
    return found | {"limit": from_si(r.after, r.unit, r.kind), "si_limit": r.after, "note": note}


def count_rows(result: SizingResult) -> Iterator[Row]:
    """The number of combinations examined, of drives that meet all limits, and of those that fail on each check."""
    counts, declared = result.counts, CHECKS[result.method]
    yield row("count", "considered", "Combinations that were examined", value=counts.considered)
    yield row("count", "feasible", "Drives that fail no check", value=counts.feasible)
    yield row("count", "passing", "Drives that meet all limits", value=counts.passing)
    if counts.undecided:
        yield row("count", "undecided", "Drives behind them that may, not computed", value=counts.undecided)
    for name, count in counts.failed_by.items():
        yield row("count", f"failed_{name}", f"Fails on: {declared[name].title}", value=count)
    for name, count in counts.failed_by_budget.items():
        title = f"Fails on the machine's budget: {CHECKS['budget'][name].title}"
        yield row("count", f"failed_budget_{name}", title, value=count)


def front_rows(s: DriveSet, objectives: Iterable[str]) -> Iterator[Row]:
    """A drive of the Pareto front by its objectives."""
    yield from _names("front", {"motor": s.motor, "gearhead": s.gearhead})
    yield _figure("front", "total_ratio", "Total ratio", s.total_ratio, "dimensionless", "1")
    yield from (figure_row("front", objective_figure(s, name)) for name in objectives)


def _names(section: str, parts: dict[str, Any]) -> Iterator[Row]:
    for name, part in parts.items():
        title = f"{part.manufacturer} {part.family}" if part else ""
        yield row(section, name, title, value=part.part if part else "", status="" if part else "unknown")


def set_rows(s: DriveSet, objective: str) -> Iterator[Row]:
    """A drive: its parts, ratios, mass, price, objective and verdict."""
    yield from _names("set", {name: getattr(s, name) for name in ("motor", "gearhead", "encoder", "controller")})
    if s.brake:
        yield from _names("set", {"brake": s.brake})
    if s.belt_drive:
        yield from _names("set", {role.replace(" ", "_"): part for role, part in s.belt_drive.parts.items()})
        yield _figure("set", "centre_distance", "Centre distance", s.belt_drive.centre_distance, "length", "mm")
        yield _figure("set", "teeth_in_mesh", "Teeth in mesh", s.belt_drive.teeth_in_mesh, "dimensionless", "1")
    if s.chosen_screw:
        yield from _names("set", {"screw": s.chosen_screw.screw})
        yield _figure("set", "screw_length", "Length of the screw", s.chosen_screw.length, "length", "mm")
    yield _figure("set", "gearhead_ratio", "Ratio of the gearhead", s.gearhead.ratio, "dimensionless", "1")
    yield _figure("set", "belt_ratio", "Ratio of the belt", s.belt_ratio, "dimensionless", "1")
    yield _figure("set", "total_ratio", "Total ratio", s.total_ratio, "dimensionless", "1")
    yield _figure("set", "mass", "Mass", s.mass, "mass", "g") | _over("sum of", s.mass_of)
    yield _figure("set", "price", "Price", s.price, "price", "EUR") | _over("sum of", s.price_of)
    yield row("set", "objective", f"Objective: {objective}", si_value=s.objective) | _over("of", s.objective_of)
    yield row("set", "verdict", "All checks", status=s.status)


def _over(words: str, names: Iterable[str]) -> Row:
    said = ", ".join(names)
    return {"note": f"{words} {said}" if said else ""}


def part_rows(line: PartLine) -> Iterator[Row]:
    """A part as it is bought: its order number, then how many, mass and price of one, as far as they are known."""
    name, bare = line.role.replace(" ", "_"), "" if line.order_number else line.part
    title = " ".join(filter(None, (line.maker, line.family, bare)))
    yield row("part", name, title or line.role, value=line.order_number, status="" if line.order_number else "unknown",
              note="; ".join(filter(None, (line.said, line.note))))  # fmt: skip
    yield plain_row("part", f"{name}_quantity", f"{line.role}, pieces for the machine", line.quantity, "1")
    yield _figure("part", f"{name}_mass", f"{line.role}, mass of one", line.mass, "mass", "g")
    note = ", ".join(filter(None, (line.price_source, line.price_date)))
    yield plain_row("part", f"{name}_price", f"{line.role}, price of one", line.price, line.currency) | {"note": note}


def total_rows(totals: Iterable[Total]) -> Iterator[Row]:
    """The sums of a parts list, with the roles that they cover."""
    for total in totals:
        least = ", at least" if total.lacks else ""
        named = "part", f"total_{total.name}", f"All parts, {total.name}{least}", total.value
        lacks = f"; not known and not in the sum: {', '.join(total.lacks)}" if total.lacks else ""
        found = _figure(*named, "mass", "g") if total.name == "mass" else plain_row(*named, total.unit)
        guessed = f"; estimated: {', '.join(total.estimated)}" if total.estimated else ""
        yield found | {"note": f"sum of {', '.join(total.over)}{lacks}{guessed}"}


def closed_loop_rows(v: Validation) -> Iterator[Row]:
    """The closed loop: verdict, checks, figures, gains in SI and in the controller's units, and each linear loop."""
    rank = {"set_rank": v.drive_set.rank}
    yield row("validation", "verdict", f"{v.loop.capitalize()}, {driven_over(v)}", status=v.status) | rank
    yield from (check_row("validation", c) | rank for c in v.checks)
    yield from (figure_row("validation", f) | rank for f in v.figures)
    yield from (one | rank for one in _gains(v))
    for one in v.linear.figures if v.linear else ():
        yield figure_row("python_control", one.linear) | rank
        if one.engine:
            yield figure_row("engine", one.engine) | rank
    for loop in v.loops:
        said = {"case": loop.direction, "status": "pass" if loop.stable else "fail"} | rank
        for f in loop_figures(loop):
            title = f"{loop.name} loop, {f.title}"
            yield _figure("loop", f"{loop.name}_{f.name}", title, f.value, f.kind, f.unit) | said


def _gains(v: Validation) -> Iterator[Row]:
    rule = f"{v.gains.rule}; {v.gains.source}"
    for gain in gain_rows(v.gains):
        yield plain_row("validation", *gain) | {"note": rule}
    for own in v.controller_gains:
        title = f"{own.name}, as written into the controller"
        yield row("validation", own.place, title, value=own.value, unit=own.unit)
