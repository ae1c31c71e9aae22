"""Columns of a machine in a study's table: sums over its axes, what they draw together, the drive of each axis.

A figure of the machine becomes a column by one line in ``_MACHINE``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import fsum, isnan, nan
from typing import Any, NamedTuple

from drivesizer.output.sums import unknown_of
from drivesizer.results.check import Check, worst
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.machine import AxisSizing, MachineSizing
from drivesizer.results.objectives import unknown_parts
from drivesizer.study.column import Column, Row, cell

__all__ = ["machine_columns", "machine_row"]


class _MachineColumn(NamedTuple):
    """A column with a figure of a machine."""

    column: Column
    of: Callable[[MachineSizing], Any]


def _sum(of: Callable[[DriveSet], float]) -> Callable[[MachineSizing], float]:
    """A figure of all drives; unknown where an axis has none."""
    return lambda sizing: fsum(one.drives * of(one.best) if one.best else nan for one in sizing.axes)


def _price(sizing: MachineSizing) -> float:
    """Sum of the known prices of all parts [EUR]; NaN where none is known or an axis has no drive."""
    known = [one.drives * one.best.price for one in sizing.axes if one.best and not isnan(one.best.price)]
    return fsum(known) if known and sizing.complete else nan


def _lacking(of: Callable[[DriveSet], Sequence[str]]) -> Callable[[MachineSizing], str]:
    """Parts that a sum does not cover, by axis: ``lift: motor + encoder; slide: encoder``."""

    def said(sizing: MachineSizing) -> str:
        parts = [(one.name, of(one.best)) for one in sizing.axes if one.best] if sizing.complete else []
        return "; ".join(f"{name}: {' + '.join(some)}" for name, some in parts if some)

    return said


def _unweighed(one: DriveSet) -> list[str]:
    return sorted(unknown_parts(one, "mass", one.mass_of))


def _power(name: str) -> Callable[[MachineSizing], float]:
    return lambda sizing: getattr(sizing.power, name) if sizing.power else nan


def _energy(sizing: MachineSizing) -> float:
    """Energy out of the supply over the machine's cycle [J]."""
    power = sizing.power
    cycle = next((one.value for one in power.figures if one.name == "machine_cycle"), nan) if power else nan
    return power.mean * cycle if power else nan


def _supply_none_fails(sizing: MachineSizing) -> float:
    """Probability that no limit of the common supply is exceeded; NaN without tolerances."""
    found = sizing.power.reliability if sizing.power else None
    return found.probability if found else nan


def _kinds(sizing: MachineSizing) -> int:
    return len({(one.best.motor.part, one.best.gearhead.part) for one in sizing.axes if one.best})


_MACHINE: tuple[_MachineColumn, ...] = (
    _MachineColumn(Column("drives", "whole"), lambda sizing: sum(one.drives for one in sizing.axes if one.best)),
    _MachineColumn(Column("kinds", "whole"), _kinds),  # of motor and gearhead
    _MachineColumn(Column("machine_mass_kg", "number", "kg"), _sum(lambda one: one.mass)),  # of motors and gearheads
    _MachineColumn(Column("mass_lacks", "text"), _lacking(_unweighed)),
    _MachineColumn(Column("machine_price_EUR", "number", "EUR"), _price),  # of all parts whose price is known
    _MachineColumn(Column("price_lacks", "text"), _lacking(lambda one: unknown_of(one, one.price_of))),
    _MachineColumn(Column("objective_si", "number"), lambda sizing: sizing.total),
    _MachineColumn(Column("energy_J", "number", "J"), _energy),
    _MachineColumn(Column("mean_W", "number", "W"), _power("mean")),
    _MachineColumn(Column("peak_W", "number", "W"), _power("peak")),
    _MachineColumn(Column("supply_none_fails", "number", "1"), _supply_none_fails),
)
_MARGIN = Column("smallest_margin", "number", "1"), Column("smallest_margin_check", "text")
_WHERE = Column("smallest_margin_axis", "text")
_ALL = "all"  # axes together


def machine_columns(members: Sequence[str]) -> tuple[Column, ...]:
    """Columns of a machine."""
    drives = (Column(f"{name}.set", "text") for name in members)
    return (*(one.column for one in _MACHINE), *_MARGIN, _WHERE, *drives)


def machine_row(head: Row, members: Sequence[str], sizing: MachineSizing) -> Row:
    """The row of a variant."""
    labels = {one.name: one.best.label for one in sizing.axes if one.best}
    counts = [one.result.counts for one in sizing.axes]
    return [
        *head, sizing.objective, 1 if sizing.status != "fail" else None, sizing.status,
        *(cell(column, of(sizing)) for column, of in _MACHINE), *_smallest_margin(sizing),
        *(labels.get(name, "") for name in members),
        sum(one.considered for one in counts), sum(one.feasible for one in counts), _nearest(sizing), "",
    ]  # fmt: skip


def _smallest_margin(sizing: MachineSizing) -> Row:
    """The smallest margin with its check and its axis; of an axis without a drive that of the closest rejected."""
    found = [(_worst_of(one), one.name) for one in sizing.axes]
    found.append((worst(tuple(check for check in sizing.checks if not check.advice)), _ALL))
    known = [(check.margin, check.name, name) for check, name in found if check]
    if not known:
        return [None, "", ""]
    margin, check, name = min(known, key=lambda one: one[0])
    return [cell(_MARGIN[0], margin), check, name]


def _worst_of(one: AxisSizing) -> Check | None:
    near = one.best or _closest(one)
    return worst(near.deciding) if near else None


def _closest(one: AxisSizing) -> DriveSet | None:
    """The closest rejected drive of an axis."""
    return next(iter((*one.result.unsure, *one.result.misses)), None)


def _nearest(sizing: MachineSizing) -> str:
    """The closest rejected drive of the first axis without one."""
    lost = next((one for one in sizing.axes if one.best is None), None)
    near = _closest(lost) if lost else None
    return f"{lost.name}: {near.label}" if lost and near else ""
