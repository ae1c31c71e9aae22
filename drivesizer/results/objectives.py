"""Figures of a drive for each objective."""

from __future__ import annotations

from collections.abc import Iterable
from math import isnan, nan

from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import Figure, worst
from drivesizer.spec.select import OBJECTIVES

__all__ = ["objective_figure", "ranked_by", "unknown_parts"]


def ranked_by(objective: str, drives: Iterable[DriveSet]) -> str:
    """Words on what ranked drives: those of which no price is known stand in the order of their masses."""
    unknown = objective == "price" and all(isnan(one.objective) for one in drives)
    return f"ranked by {objective.replace('_', ' ')}" + (", of which none is known: by mass" if unknown else "")


def objective_figure(drive_set: DriveSet, objective: str) -> Figure:
    """The figure of a drive for an objective, ranked by it or not."""
    shown = OBJECTIVES[objective]
    value = _objective_value(drive_set, objective)
    return Figure(name=objective, title=shown.title, value=value, kind=shown.kind, unit=shown.unit)


def _objective_value(drive_set: DriveSet, objective: str) -> float:
    declared = OBJECTIVES[objective]
    if objective == "margin":
        tight = worst(drive_set.checks)
        return tight.margin if tight else nan
    if declared.over:  # first: what is called power among the figures is that of the supply
        return _summed(drive_set, objective)
    return {figure.name: figure.value for figure in drive_set.figures}.get(objective, nan)


def _summed(one: DriveSet, objective: str) -> float:
    """A sum over the parts of a drive; of encoder and controller as far as it is known."""
    if objective == "mass":
        return nan if set(unknown_parts(one, objective, one.mass_of)) - _CONTROLLING else one.mass
    declared = OBJECTIVES[objective]
    parts = {role: part for role in declared.over if (part := getattr(one, role)) is not None}
    values = {role: getattr(part, declared.figure, 0.0) for role, part in parts.items()}
    return float(sum(value for role, value in values.items() if role not in _CONTROLLING or not isnan(value)))


_CONTROLLING = {"encoder", "controller"}


def unknown_parts(one: DriveSet, objective: str, known: Iterable[str]) -> tuple[str, ...]:
    """Roles of the parts of a drive that an objective is summed over, and that are not among those known."""
    counted = {"actuator", *OBJECTIVES[objective].over}
    return tuple(role for role in one.parts if role in counted and role not in known)
