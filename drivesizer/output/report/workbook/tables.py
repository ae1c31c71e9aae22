"""The sheets of a workbook that are tables: requirements, candidates, checks, parts list, closed loop, time series."""

from __future__ import annotations

from collections.abc import Iterator
from math import isnan, nan
from typing import Any

from drivesizer.control.validation import Validation
from drivesizer.output.parts import PartLine
from drivesizer.output.report.lines.machine import driven_over
from drivesizer.output.report.table.reliability_rows import every_list
from drivesizer.output.report.table.rows import (
    Row,
    battery_rows,
    check_row,
    closed_loop_rows,
    machine_rows,
    requirement_row,
)
from drivesizer.output.report.workbook.sheet import Column, Sheet, headed
from drivesizer.output.sums import price_of
from drivesizer.output.thinning import on_curves
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.objectives import objective_figure
from drivesizer.results.sizing import SizingResult, worst
from drivesizer.units import from_si

__all__ = ["battery", "candidates", "checks", "closed_loop", "machine", "parts", "requirements", "time_series"]


_VALUES = (
    Column("value", "value"),
    Column("unit", "unit", "unit"),
    Column("SI value", "si_value"),
    Column("SI unit", "si_unit", "unit"),
)
_LIMITS = (
    Column("value or demand", "value"), Column("limit", "limit"), Column("unit", "unit", "unit"),
    Column("SI value", "si_value"), Column("SI limit", "si_limit"), Column("SI unit", "si_unit", "unit"),
    Column("margin (%)", "margin", "percent"), Column("needed margin (%)", "needed_margin", "needed"),
    Column("status", "status", "status"), Column("at (s)", "at_time_s"), Column("note", "note", "", 70),
)  # fmt: skip
_RANK = Column("set", "set_rank", "count")


def _ranked(result: SizingResult, rows: Any) -> Iterator[Row]:
    for _, one in every_list(result, front=False):
        yield from ({**row, "set_rank": one.rank} for row in rows(one))


def requirements(result: SizingResult) -> Sheet:
    """What the load asks for, and what that asks of the motor of each set."""
    motor = _ranked(result, lambda s: map(requirement_row, s.requirements))
    columns = (
        _RANK, Column("requirement", "title"), Column("symbol", "symbol"), Column("equation", "equation", "count"),
        *_VALUES, Column("note", "note", "", 70),
    )  # fmt: skip
    note = "without a set: what the load asks for; with one: at that set's motor"
    return Sheet(name="Requirements", columns=columns, note=note, still=2,
                 rows=[*map(requirement_row, result.requirements), *motor])  # fmt: skip


def checks(result: SizingResult) -> Sheet:
    """Every check of every set, by both methods."""
    columns = (_RANK, Column("check", "title"), Column("method", "method"), Column("load case", "case"), *_LIMITS)
    rows = _ranked(result, lambda s: (check_row("check", c) for c in s.every_check))
    return Sheet(name="Checks", columns=columns, rows=list(rows), still=2)


def machine(result: SizingResult) -> Sheet:
    """What the machine weighs with every set, and what room, footing and grip it has."""
    columns = (
        _RANK, Column("of", "section"), Column("what", "title"), Column("how many", "how_many", "count"),
        Column("mass of one (kg)", "each"), *_VALUES, Column("at (s)", "at_time_s"),
        Column("status", "status", "status"),
    )  # fmt: skip
    rows = list(_ranked(result, machine_rows))
    note = "masses of all pieces together, and figures without a limit; what has one is in Checks"
    return Sheet(name="Machine", columns=columns, rows=rows, still=3,
                 note=note if rows else "the spec has neither budget nor platform")  # fmt: skip


def battery(result: SizingResult) -> Sheet:
    """What draws from the battery and how long it lasts, of every set."""
    columns = (
        _RANK, Column("of", "section"), Column("what", "title"), Column("how many", "how_many", "count"),
        *_VALUES, Column("at most", "limit"), Column("status", "status", "status"), Column("note", "note", "", 40),
    )  # fmt: skip
    rows = list(_ranked(result, battery_rows))
    note = "consumers in the mean and at most, and the battery's figures" if rows else "the spec has no battery"
    return Sheet(name="Battery", columns=columns, rows=rows, note=note, still=3)


def closed_loop(validation: Validation | None) -> Sheet:
    """Checks, figures, gains and linear loops of the closed loop."""
    columns = (Column("of", "section"), Column("figure", "title"), Column("direction or case", "case"), *_LIMITS)
    if validation is None:
        return Sheet(name="Closed loop", columns=columns, rows=[], note="no set stands: nothing was simulated")
    rows = list(closed_loop_rows(validation))
    return Sheet(name="Closed loop", columns=columns, rows=rows, note=f"over {driven_over(validation)}", still=2)


_PARTS = (
    Column("role", "role"), Column("maker", "maker"), Column("family", "family"), Column("part", "part"),
    Column("order number", "order_number"), Column("status", "status", "status"), Column("is", "said"),
    Column("quantity", "quantity", "count"), Column("mass of one (g)", "mass_g"), Column("mass of all (g)", "masses_g"),
    Column("price of one", "price", "money"), Column("price of all", "prices", "money"), Column("currency", "currency"),
    Column("price from (pieces)", "pieces", "count"), Column("price date", "price_date"),
    Column("price confidence", "price_confidence", "sure"), Column("part confidence", "confidence", "sure"),
    Column("note", "note", "", 70), Column("price source", "price_source", "line"),
    Column("part source", "document", "line"), Column("source date", "date"), Column("page", "url", "line"),
)  # fmt: skip


def parts(bought: list[PartLine]) -> Sheet:
    """The parts list of the best set."""
    rows = [_bought(line) for line in bought]
    note = "mass and price are empty where no catalogue knows them" if rows else "no set stands: nothing to buy"
    return Sheet(name="Parts list", columns=_PARTS, rows=rows, note=note, still=1)


def _bought(line: PartLine) -> Row:
    grams = from_si(line.mass, "g", "mass")
    row = {name: getattr(line, name) for name in line.__slots__}
    return row | {
        "status": "" if line.order_number else "unknown",
        "mass_g": grams,
        "masses_g": line.quantity * grams,
        "prices": line.quantity * line.price,
    }


_CANDIDATE = (
    Column("list", "list"), _RANK, Column("status", "status", "status"), Column("motor or actuator", "motor"),
    Column("motor part", "motor_part"), Column("gearhead", "gearhead"), Column("gearhead part", "gearhead_part"),
    Column("belt", "belt"), Column("encoder", "encoder"), Column("controller", "controller"),
    Column("gearhead reduction", "gearhead_ratio"), Column("belt reduction", "belt_ratio"),
    Column("whole reduction", "total_ratio"), Column("mass (g)", "mass"), Column("mass of", "mass_of"),
    Column("price (EUR)", "price", "money"), Column("price of", "price_of"),
    Column("smallest margin (%)", "margin", "percent"), Column("of check", "tightest"),
    Column("failed checks", "failed"), Column("unknown checks", "unknown"),
)  # fmt: skip


def candidates(result: SizingResult) -> Sheet:
    """Sets, those less sure than asked for, nearest misses and the Pareto front, one in a row, with their margins."""
    sets = every_list(result)
    checks = {c.name: c.title for _, s in sets for c in s.own_checks}
    figures = {f.name: f for _, s in sets for f in s.figures}
    aims = tuple(Column(headed(f.title, f.unit), f"aim_{f.name}") for f in _aims(result, sets))
    does = tuple(Column(headed(f.title, f.unit), f"figure_{name}") for name, f in figures.items())
    margins = tuple(Column(f"margin: {title} (%)", f"margin_{name}", "percent") for name, title in checks.items())
    return Sheet(name="Candidates", columns=(*_CANDIDATE, *aims, *does, *margins), still=4,
                 note=f"ranked by {result.objective.replace('_', ' ')}",
                 rows=[{"list": name} | _candidate(one, result) for name, one in sets])  # fmt: skip


def _aims(result: SizingResult, sets: list[tuple[str, DriveSet]]) -> list[Any]:
    """The objectives of a front, by a set of it."""
    return [objective_figure(sets[0][1], name) for name in result.pareto] if sets else []


def _candidate(s: DriveSet, result: SizingResult) -> Row:
    tight, (price, priced) = worst(s.deciding), price_of(s)
    outside = {
        role: f"{p.family} {p.part}" if p else "" for role, p in s.parts.items() if role in ("encoder", "controller")
    }
    aims = (objective_figure(s, name) for name in result.pareto)
    return {
        "set_rank": s.rank, "status": s.status, "motor": s.motor_name, "motor_part": (s.actuator or s.motor).part,
        "gearhead": s.gearhead_name, "gearhead_part": s.gearhead.part if "gearhead" in s.parts else "",
        "belt": s.belt_name, "encoder": outside.get("encoder", "inside"),
        "controller": outside.get("controller", "inside"), "gearhead_ratio": s.gearhead.ratio,
        "belt_ratio": s.belt_ratio, "total_ratio": s.total_ratio, "mass": from_si(s.mass, "g", "mass"),
        "mass_of": " + ".join(s.mass_of), "price": price, "price_of": " + ".join(priced),
        "margin": tight.margin if tight else nan, "tightest": tight.title if tight else "",
        "failed": "; ".join(c.title for c in s.deciding if c.status == "fail"),
        "unknown": "; ".join(c.title for c in s.deciding if c.status == "unknown"),
        **{f"aim_{f.name}": from_si(f.value, f.unit, f.kind) for f in aims},
        **{f"figure_{f.name}": from_si(f.value, f.unit, f.kind) for f in s.figures},
        **{f"margin_{c.name}": c.margin for c in s.own_checks if not isnan(c.margin)},
    }  # fmt: skip


def time_series(validation: Validation | None, most: int) -> Sheet:
    """The closed loop over time.

    Parameters
    ----------
    validation
        The closed loop, where it was simulated.
    most
        Samples that are kept: of a longer record evenly, with the peaks of every column.
    """
    if validation is None:
        return Sheet(name="Time series", columns=(Column("time (s)", "time"),), rows=[], note="nothing was simulated")
    units = validation.series_units
    columns = {name: from_si(x, units[name][1], units[name][0]) for name, x in validation.series.items()}
    count = len(columns["time"])
    kept = on_curves(tuple(columns.values()), most)
    note = f"{len(kept)} of {count} samples, evenly and with the peaks of every column" if len(kept) < count else ""
    heads = tuple(Column(headed(name.replace("_", " "), units[name][1]), name, "sample") for name in columns)
    rows = zip(*(values[kept].tolist() for values in columns.values()), strict=True)
    return Sheet(name="Time series", columns=heads, note=note, still=1, filtered=False, drawn=_DRAWN,
                 rows=[dict(zip(columns, row, strict=True)) for row in rows])  # fmt: skip


_DRAWN = ("speed_reference", "speed", "current")
