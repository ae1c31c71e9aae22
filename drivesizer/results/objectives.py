"""Figures of a drive for each objective."""

from __future__ import annotations

from collections.abc import Iterable
from math import isnan, nan

from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import Figure, worst
from drivesizer.spec.select import OBJECTIVES

__all__ = ["objective_figure", "ranked_by"]


def ranked_by(objective: str, drives: Iterable[DriveSet]) -> str:
    """Words on what ranked drives: those of which no price is known stand in the order of their masses.

    Parameters
    ----------
    objective
        Title of the objective.
    drives
        The first of them.

    Returns
    -------
    str
        Such as ``ranked by mass``.
    """
    unknown = objective == "price" and all(isnan(one.objective) for one in drives)
    return f"ranked by {objective.replace('_', ' ')}" + (", of which none is known: by mass" if unknown else "")


def objective_figure(drive_set: DriveSet, objective: str) -> Figure:
    """The figure of a drive for an objective, ranked by it or not.

    Parameters
    ----------
    drive_set
        The drive.
    objective
        One of ``OBJECTIVES``.

    Returns
    -------
    Figure
        In SI; NaN where it is unknown.
    """
    shown = OBJECTIVES[objective]
    value = _of(drive_set, objective)
    return Figure(name=objective, title=shown.title, value=value, kind=shown.kind, unit=shown.unit)


def _of(drive_set: DriveSet, objective: str) -> float:
    declared = OBJECTIVES[objective]
    if objective == "margin":
        tight = worst(drive_set.checks)
        return tight.margin if tight else nan
    if declared.over:  # first: what is called power among the figures is that of the supply
        return float(sum(getattr(getattr(drive_set, part), declared.figure) for part in declared.over))
    return {figure.name: figure.value for figure in drive_set.figures}.get(objective, nan)
