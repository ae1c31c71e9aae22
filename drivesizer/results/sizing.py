"""Results of a sizing: requirements, drives and their checks, as plain records.

Terminal, JSON, CSV and reports all print these records and compute nothing of their own. Figures are SI
floats; each carries its kind and the unit of the trade it is shown in. NaN is *unknown*.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

from drivesizer.catalog import Catalog
from drivesizer.results.check import Check, Figure, Status, verdict, worst
from drivesizer.results.drive_set import DriveSet, Relaxation
from drivesizer.results.notebook import html_table, share
from drivesizer.results.problem import Problem
from drivesizer.results.reliability import Uncertainty
from drivesizer.results.requirement import Requirement
from drivesizer.results.weights import Choices
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

__all__ = ["Check", "Counts", "Explanation", "Figure", "SizingResult", "Status", "verdict", "worst"]


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

    def _repr_html_(self) -> str:
        """The drives as a table of a notebook, best first."""
        heads = ("", "motor", "gearhead", "mass", "price", "smallest margin", "")
        return html_table(heads, map(_row, self.sets or self.misses))

    @property
    def spec(self) -> RobotSpec:
        """The machine, of the mass that it was sized for."""
        return self.problem.machine

    @property
    def catalog(self) -> Catalog:
        """The parts that there were to choose from."""
        return self.problem.catalog

    @property
    def shown(self) -> DriveSet | None:
        """The drive that is reported in full: the best, else the most probable, else the closest rejected; or None."""
        return next(iter((*self.sets, *self.unsure, *self.misses)), None)


def _row(one: DriveSet) -> tuple[str, ...]:
    """A drive of a table; a price that lacks a part is at least that."""
    tight = worst(one.deciding)
    margin = f"{share(tight.margin)} {tight.title}" if tight else ""
    return (
        str(one.rank),
        one.motor_name,
        one.gearhead_name,
        show(one.mass, "g", "mass"),
        one.price_text,
        margin,
        one.status,
    )


class Explanation(NamedTuple):
    """Results of one combination of motor and gearhead."""

    sets: list[DriveSet]  # with every belt ratio
    uncertainty: Uncertainty | None  # what was uncertain, where tolerances were sampled
    warnings: tuple[str, ...] = ()  # of the motion
