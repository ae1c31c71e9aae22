"""Results of a sizing as plain records, and its drives in the order of objectives and weights."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from importlib.util import find_spec
from math import isnan, nan
from typing import Any, NamedTuple

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.errors import InputError
from drivesizer.physics.figures import Alike, Array, Mask, Whole
from drivesizer.results.check import Figure, Uncertainty, worst
from drivesizer.results.drive_set import DriveParts, DriveSet, Relaxation, Requirement, html_table
from drivesizer.results.problem import Problem
from drivesizer.spec.drive import OBJECTIVES
from drivesizer.spec.robot import RobotSpec

# -- Drives by weights: each figure as a multiple of the best one, and the weighted mean of these multiples.
#
# .. math:: s = \frac{\sum_k w_k \, x_k / x_{k,best}}{\sum_k w_k}
#
# Every :math:`x_k` is a figure of which less is better, :math:`x_{k,best}` the least of all drives; of a margin m it
# is the share of its limit that is used, :math:`1 / (1 + m)`. So the score is 1 for a drive that is the best in all
# that counts, 1.1 for one that is a tenth worse on the average, and the same in any units. An energy may be zero or
# negative, where a drive regenerates; then there is no multiple, and :math:`1 + (x - x_{best}) / \max |x|` is in its
# place. The page has the same rule in ``output/report/html/weights.js``.
#
# References ---------- .. [1] R. T. Marler, J. S. Arora, *Survey of multi-objective optimization methods for
# engineering*, Structural and Multidisciplinary Optimization 26 (2004), pp. 369-395: weighted sum, objectives made
# comparable by their best values. .. [2] C.-L. Hwang, K. Yoon, *Multiple Attribute Decision Making*, Springer 1981:
# simple additive weighting.


CRITERIA = ("mass", "price", "energy", "margin")  # objectives that drives are compared by, whatever ranks them
_EQUAL = 1e9  # scores are equal that agree in so many parts of 1
_LEAST = 1e-9  # limit over demand


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """A drive that passes, with the figures that it can be chosen by."""

    parts: DriveParts
    figures: dict[str, float]  # by the name of the objective, SI; NaN unknown


@dataclass(frozen=True, slots=True, kw_only=True)
class Choices:
    """Drives out of those that pass, among which are those that weights may make the best."""

    drives: tuple[Choice, ...]  # the larger smallest margin first
    first: int  # which of them is the best by the spec's objective
    weights: dict[str, float]  # of the spec's objective
    passing: int  # drives that they were picked from, as certain as the best; in a machine not all of them were checked
    judged: bool  # whether these were checked in their machine as well
    whole: bool  # whether the best of all of those by any weights is among these


class Scored(NamedTuple):
    """Drives in the order of their scores."""

    order: Whole  # rows, the best first
    score: Array  # of each row; over the figures that are known, NaN where none is
    lacking: Whole  # figures of each row that count and are unknown


def used_share(margin: Alike) -> Alike:
    """Share of its limit that a demand uses, by its margin.

    >>> float(used_share(0.25))
    0.8
    """
    return 1.0 / np.maximum(1.0 + margin, _LEAST)


def multiples(values: Array, known: Mask) -> Array:
    """A figure of several drives as multiples of the least one: 1 is the best, 1.1 a tenth worse.

    Examples
    --------
    >>> multiples(np.array([200.0, 250.0]), np.array([True, True]))
    array([1.  , 1.25])
    >>> multiples(np.array([-4.0, 1.0]), np.array([True, True]))
    array([1.  , 2.25])
    """
    if not known.any():
        return np.ones_like(values)
    least, most = values[known].min(), np.abs(values[known]).max()
    return values / least if least > 0.0 else 1.0 + (values - least) / (most or 1.0)


def weighted_order(figures: Mapping[str, Array], weights: Mapping[str, float]) -> Scored:
    """The order of drives by several figures with weights."""
    count = len(next(iter(figures.values()), ()))
    total, share, lacking = np.zeros(count), np.zeros(count), np.zeros(count, np.int64)
    for name, values in figures.items():
        weight, known = weights.get(name, 0.0), ~np.isnan(values)
        if weight > 0.0:
            total += np.where(known, weight * multiples(values, known), 0.0)
            share += np.where(known, weight, 0.0)
            lacking += ~known
    with np.errstate(invalid="ignore"):
        score = total / share  # NaN where nothing is known
    rank = np.floor(np.where(np.isnan(score), np.inf, score) * _EQUAL + 0.5)
    return Scored(np.lexsort((rank, lacking)).astype(np.int64), score, lacking)


# -- Results of a sizing: requirements, drives and their checks, as plain records.
#
# Terminal, JSON, CSV and reports all print these records and compute nothing of their own. Figures are SI
# floats; each carries its kind and the unit of the trade it is shown in. NaN is *unknown*.


@dataclass(frozen=True, slots=True, kw_only=True)
class Counts:
    """Numbers of drives that were considered, that fail no check, that meet all limits, and that failed on each."""

    considered: int
    feasible: int  # that fail no check
    passing: int  # of these, how many meet all limits: none of their checks is unknown or open
    failed_by: dict[str, int]
    left_out: int = 0  # that meet all limits that are known, and ``select: {unknown: reject}`` leaves out
    open: int = 0  # of the feasible, how many pass or fail by estimated figures
    judged: int = 0  # of those that fail no check of the drive, the best that were checked in the machine
    failed_by_budget: dict[str, int] = field(default_factory=dict)  # of these, how many failed on which budget
    undecided: int = 0  # of a long cycle, how many may pass and were not computed, behind enough that do


@dataclass(frozen=True, slots=True, kw_only=True)
class SizingResult:
    """Everything that a sizing found."""

    problem: Problem
    method: str
    objective: str
    requirements: tuple[Requirement, ...]
    sets: tuple[DriveSet, ...]  # that pass or are unknown, best first
    misses: tuple[DriveSet, ...]  # the closest rejected, where fewer meet all limits than were requested
    relaxations: tuple[Relaxation, ...]
    counts: Counts
    assumptions: tuple[str, ...]
    warnings: tuple[str, ...]
    unrestricted: DriveSet | None = None  # what the whole catalogue would give, where the spec restricts it
    front: tuple[DriveSet, ...] = ()  # the Pareto front, where one was requested
    pareto: tuple[str, ...] = ()  # its objectives
    unsure: tuple[DriveSet, ...] = ()  # that pass with less than the required confidence; the most probable first
    uncertainty: Uncertainty | None = None  # what was uncertain, where tolerances were sampled
    alternatives: tuple[DriveSet, ...] = ()  # the best of other motor families than the first one's, in order
    tried: tuple[str, ...] = ()  # figures of the spec that were moved for relaxations, by name
    choices: Choices | None = None  # drives that pass, to choose from by weights, where any were requested

    def __str__(self) -> str:
        """The drives, a line each."""
        rows = [drive.cells for drive in self.sets or self.misses]
        widths = [max(map(len, column), default=0) for column in zip(*rows, strict=True)]
        lines = ["  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]
        return "\n".join([f"{self.spec.name}: {len(self.sets)} drives, by {self.objective}", *lines])

    def rows(self) -> list[dict[str, Any]]:
        """Every drive that is in it, with figures and the margin of each check in SI; best first, then the rejected."""
        rows = []
        for drive in (*self.sets, *self.unsure, *self.misses):
            row: dict[str, Any] = {
                "rank": drive.rank, "status": drive.status, "motor": drive.motor.part, "gearhead": drive.gearhead.part,
                "belt_ratio": drive.belt_ratio, "total_ratio": drive.total_ratio, "mass": drive.mass,
                "price": drive.price,
            }  # fmt: skip
            row |= {figure.name: figure.value for figure in drive.figures}
            rows.append(row | {f"margin {check.name}": check.margin for check in drive.own_checks})
        return rows

    def to_frame(self) -> Any:
        """The same as a data frame of pandas."""
        return frame_of(self.rows())

    def _repr_html_(self) -> str:
        """The drives as a table of a notebook, best first."""
        heads = ("", "motor", "gearhead", "mass", "price", "smallest margin", "")
        return html_table(heads, (drive.cells for drive in self.sets or self.misses))

    @property
    def spec(self) -> RobotSpec:
        """The machine, of the mass that it was sized for."""
        return self.problem.machine

    @property
    def catalog(self) -> Catalog:
        """The parts that there were to choose from."""
        return self.problem.catalog

    @property
    def reported(self) -> DriveSet | None:
        """The drive that is reported in full: the best, else the most probable, else the closest rejected; or None."""
        return next(iter((*self.sets, *self.unsure, *self.misses)), None)


def frame_of(rows: list[dict[str, Any]]) -> Any:
    """Rows as a data frame of pandas, where that is installed."""
    if find_spec("pandas") is None:
        raise InputError("to_frame() needs pandas; rows() gives the same as a list of dicts")
    return import_module("pandas").DataFrame(rows)


class Explanation(NamedTuple):
    """Results of one combination of motor and gearhead."""

    sets: list[DriveSet]  # with every belt ratio
    uncertainty: Uncertainty | None  # what was uncertain, where tolerances were sampled
    warnings: tuple[str, ...] = ()  # of the motion


# -- Figures of a drive for each objective.


def ranked_by(objective: str, best: Sequence[DriveSet]) -> str:
    """Words on what ranked drives, by the best of each axis: of unknown price by mass; of which parts it is estimated.

    Unknown prices stand last: where that of the best is unknown, all are.
    """
    text = f"ranked by {objective.replace('_', ' ')}"
    unknown = objective == "price" and bool(best) and all(isnan(drive.objective) for drive in best)
    text += ", of which none is known: by mass" if unknown else ""
    by_mass = best if unknown or "mass" in objective.split() else ()
    guessed = dict.fromkeys(role for drive in by_mass for role in drive.mass_estimated)
    return text + (f", that of {', '.join(guessed)} estimated" if guessed else "")


def objective_figure(drive: DriveSet, objective: str) -> Figure:
    """The figure of a drive for an objective, ranked by it or not; of encoder and controller as far as it is known."""
    declared = OBJECTIVES[objective]
    if objective == "margin":
        tight = worst(drive.checks)
        value = tight.margin if tight else nan
    elif objective == "mass":
        value = nan if set(drive.unknown_parts(objective, drive.mass_of)) - _CONTROLLING else drive.mass
    elif declared.over:  # first: what is called power among the figures is that of the supply
        parts = {role: part for role in declared.over if (part := getattr(drive, role)) is not None}
        values = {role: getattr(part, declared.figure, 0.0) for role, part in parts.items()}
        value = float(sum(x for role, x in values.items() if role not in _CONTROLLING or not isnan(x)))
    else:
        value = {figure.name: figure.value for figure in drive.figures}.get(objective, nan)
    unit = drive.currency if declared.kind == "price" else declared.unit
    return Figure(name=objective, title=declared.title, value=value, kind=declared.kind, unit=unit)


_CONTROLLING = {"encoder", "controller"}
