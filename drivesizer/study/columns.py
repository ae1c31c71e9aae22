"""Columns of a study's table: the variant, and the drive found for it.

A figure of a drive becomes a column by one line in ``_DRIVE``; by one more in ``maps.MAPS`` it is drawn as well.
"""

from __future__ import annotations

from collections.abc import Callable
from math import nan
from typing import Any, NamedTuple

from drivesizer.output.sums import unknown_of
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.objectives import unknown_parts
from drivesizer.results.sizing import worst
from drivesizer.study.best import Best
from drivesizer.study.column import Column, Form, Row, cell
from drivesizer.study.machine_columns import machine_columns
from drivesizer.study.plan import Job, Plan

__all__ = ["HEAD", "columns_of", "failed", "variant_rows"]


class _DriveColumn(NamedTuple):
    """A column with a figure of a drive."""

    column: Column
    of: Callable[[DriveSet], Any]


def _number(head: str, of: Callable[[DriveSet], Any], unit: str = "") -> _DriveColumn:
    return _DriveColumn(Column(head, "number", unit), of)


def _text(head: str, of: Callable[[DriveSet], Any]) -> _DriveColumn:
    return _DriveColumn(Column(head, "text"), of)


def _name(part: Any, name: str) -> str:
    return str(getattr(part, name)) if part is not None else ""


def _mass_lacks(one: DriveSet) -> str:
    return " + ".join(sorted(unknown_parts(one, "mass", one.mass_of)))


def _price_lacks(one: DriveSet) -> str:
    return " + ".join(unknown_of(one, one.price_of))


def _figure(name: str) -> Callable[[DriveSet], float]:
    return lambda one: next((figure.value for figure in one.figures if figure.name == name), nan)


_DRIVE: tuple[_DriveColumn, ...] = (
    _text("set", lambda one: one.label),
    _text("motor_family", lambda one: one.motor.family),
    _text("motor_part", lambda one: one.motor.part),
    _text("gearhead_family", lambda one: one.gearhead.family),
    _text("gearhead_part", lambda one: one.gearhead.part),
    _number("gearhead_ratio", lambda one: one.gearhead.ratio, "1"),
    _number("belt_ratio", lambda one: one.belt_ratio, "1"),
    _text("belt_part", lambda one: _name(one.belt_drive.belt if one.belt_drive else None, "part")),
    _text("screw_part", lambda one: _name(one.chosen_screw.screw if one.chosen_screw else None, "part")),
    _text("brake_part", lambda one: _name(one.brake, "part")),
    _text("encoder_family", lambda one: _name(one.encoder, "family")),
    _text("encoder_part", lambda one: _name(one.encoder, "part")),
    _text("controller_family", lambda one: _name(one.controller, "family")),
    _text("controller_part", lambda one: _name(one.controller, "part")),
    _number("total_ratio", lambda one: one.total_ratio, "1"),
    _number("mass_kg", lambda one: one.mass, "kg"),  # as the objective counts it
    _text("mass_lacks", _mass_lacks),
    _number("price_EUR", lambda one: one.price, "EUR"),  # of all parts whose price is known
    _text("price_lacks", _price_lacks),
    _number("objective_si", lambda one: one.objective),
    _number("energy_J", _figure("energy"), "J"),
    _number("probability", lambda one: one.reliability.passing if one.reliability else nan, "1"),  # that all pass
    _number("none_fails", lambda one: one.reliability.probability if one.reliability else nan, "1"),
    _number(
        "probability_error", lambda one: one.reliability.error if one.reliability else nan, "1"
    ),  # of sampling, 95 %
)
_TOTALS = (
    Column("drives", "whole"),
    Column("machine_mass_kg", "number", "kg"),
    Column("machine_price_EUR", "number", "EUR"),
)
HEAD = Column("objective", "text"), Column("rank", "whole"), Column("status", "text")
_MARGIN = Column("smallest_margin", "number", "1"), Column("smallest_margin_check", "text")
_COUNTS = Column("sets_examined", "whole"), Column("sets_that_stand", "whole")
_LAST = Column("nearest_miss", "text"), Column("error", "text")


def columns_of(plan: Plan) -> tuple[Column, ...]:
    """The columns of a study's table."""
    spec = (Column("spec", "text"),) if len(plan.names) > 1 else ()
    catalogs = (Column("catalogs", "text"),) if any(plan.catalogs) else ()
    varied = tuple(Column(axis.head, _form(axis), axis.unit) for axis in plan.job.axes)
    return (Column("variant", "whole"), *spec, *varied, *catalogs, *_result(plan.job))


def _result(job: Job) -> tuple[Column, ...]:
    """The columns behind what varies: of a drive, or of a machine."""
    if job.machine and job.axis is None:
        own: tuple[Column, ...] = machine_columns(job.members)
    else:
        own = (*(one.column for one in _DRIVE), *_TOTALS, *_MARGIN)
    return (*HEAD, *own, *_COUNTS, *_LAST)


def _form(axis: Any) -> Form:
    if axis.kind:
        return "number"
    return "whole" if all(isinstance(axis.table_value(value), int) for value in axis.values) else "text"


def variant_rows(head: Row, best: Best) -> list[Row]:
    """Rows of a variant: one for each drive, or one with the check that the closest rejected drive fails most."""
    counts = [best.counts.considered, best.counts.feasible]
    if best.sets:
        return [
            [*head, best.objective, one.rank, one.status, *(cell(c, of(one)) for c, of in _DRIVE),
             *_machine_totals(one, best.drives), *_smallest_margin(one), *counts, "", ""]
            for one in best.sets
        ]  # fmt: skip
    near = best.nearest
    none = [None if column.form != "text" else "" for column in (*(one.column for one in _DRIVE), *_TOTALS)]
    margin = _smallest_margin(near) if near else [None, ""]
    return [[*head, best.objective, None, "fail", *none, *margin, *counts, near.label if near else "", ""]]


def failed(job: Job, head: Row, objective: str, message: str) -> list[Row]:
    """Row of a variant that is invalid or cannot be sized."""
    none = ["" if column.form == "text" else None for column in _result(job)[len(HEAD) : -1]]
    return [[*head, objective, None, "error", *none, message]]


def _machine_totals(one: DriveSet, drives: int) -> Row:
    """Number of drives of the machine, and mass and price of all of them."""
    return [drives, *(cell(c, drives * value) for c, value in zip(_TOTALS[1:], (one.mass, one.price), strict=True))]


def _smallest_margin(one: DriveSet) -> Row:
    """The smallest margin and its check."""
    check = worst(one.deciding)
    return [cell(_MARGIN[0], check.margin), check.name] if check else [None, ""]
