"""All candidates at once: which sets there are, how each stands, and in which order.

A candidate is motor x gearhead x belt ratio, one row of the columns; encoder and controller are chosen for each
row. No loop runs over candidates.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer import paper
from drivesizer.catalog import Catalog, Table
from drivesizer.checks import CheckColumn, fits, in_order
from drivesizer.choose import controllers, encoders, selected
from drivesizer.loads import load_cycle
from drivesizer.physics import at_gearhead, demands
from drivesizer.physics_limits import limits, stress
from drivesizer.results import Counts, DriveSet, Requirement
from drivesizer.spec import RobotSpec

__all__ = ["Candidates", "Evaluation", "Rows", "candidates", "counts", "drive_set", "evaluate", "ranking"]


class Candidates(NamedTuple):
    """Rows of motors and gearheads, the belt ratio, and whether a source lists the pair."""

    motor: NDArray[np.int64]
    gearhead: NDArray[np.int64]
    belt: NDArray[np.float64]
    listed: NDArray[np.bool_]


class Evaluation(NamedTuple):
    """Everything that was computed over the candidates."""

    spec: RobotSpec
    catalog: Catalog
    candidates: Candidates
    wheel: dict[str, Requirement]  # (1)-(16), columns where they depend on the motor
    shaft: dict[str, Requirement]  # (17)-(20)
    checks: list[CheckColumn]
    encoder: NDArray[np.int64]
    controller: NDArray[np.int64]
    failed: NDArray[np.bool_]
    unknown: NDArray[np.bool_]


class Rows:
    """The columns of a table at some rows, taken when asked for; at row -1 every figure is unknown."""

    def __init__(self, table: Table[Any], rows: NDArray[np.int64]) -> None:
        self.table, self.rows = table, rows

    def __getitem__(self, name: str) -> NDArray[Any]:
        column: NDArray[Any] = self.table[name]
        if (self.rows < 0).any():
            column = np.append(column, np.array([np.nan if column.dtype.kind == "f" else ""], column.dtype))
        return column[self.rows]


def candidates(spec: RobotSpec, catalog: Catalog, also: tuple[int, int] | None = None) -> Candidates:
    """Every listed pair of motor and gearhead that the spec allows, with every belt ratio.

    Parameters
    ----------
    spec, catalog
        What is asked for, and what there is.
    also
        Rows of a motor and a gearhead that are looked at even when no source lists the pair.
    """
    pairs = catalog.motor_gearhead
    keep = selected(catalog.motors, spec.select.motor)[pairs.left]
    keep &= selected(catalog.gearheads, spec.select.gearhead)[pairs.right]
    motor, gearhead = pairs.left[keep].astype(np.int64), pairs.right[keep].astype(np.int64)
    listed = np.ones(len(motor), bool)
    if also is not None and not np.any((motor == also[0]) & (gearhead == also[1])):
        motor, gearhead = np.append(motor, also[0]), np.append(gearhead, also[1])
        listed = np.append(listed, False)
    belts = np.array(spec.belt_ratios)
    return Candidates(
        np.repeat(motor, len(belts)), np.repeat(gearhead, len(belts)), np.tile(belts, len(motor)),
        np.repeat(listed, len(belts)),
    )  # fmt: skip


def evaluate(spec: RobotSpec, catalog: Catalog, given: Candidates) -> Evaluation:
    """The paper's requirements of every candidate, and its checks by the spec's method."""
    motor, gearhead = Rows(catalog.motors, given.motor), Rows(catalog.gearheads, given.gearhead)
    wheel = paper.vehicle(spec, motor["rotor_inertia"]).steps
    shaft = paper.at_the_motor(spec, wheel, motor, gearhead, given.belt).steps
    encoder = encoders(spec, catalog, given.motor)
    if spec.method == "paper":
        checks, controller = _by_the_paper(spec, catalog, given, wheel, shaft)
    else:
        checks, controller = _by_physics(spec, catalog, given, encoder.row)
    checks = [fits("compatibility", True, given.listed), *checks, *encoder.checks]
    failed = np.logical_or.reduce([check.failed for check in checks])
    passed = np.logical_and.reduce([check.passed for check in checks])
    return Evaluation(spec, catalog, given, wheel, shaft, checks, encoder.row, controller, failed, ~failed & ~passed)


def _by_the_paper(
    spec: RobotSpec, catalog: Catalog, given: Candidates, wheel: dict[str, Requirement], shaft: dict[str, Requirement]
) -> tuple[list[CheckColumn], NDArray[np.int64]]:
    """The rule of section 3.1.3, and the controller by the torques of (17) and (18)."""
    motor, gearhead = Rows(catalog.motors, given.motor), Rows(catalog.gearheads, given.gearhead)
    checks = paper.rule(spec, wheel, shaft, motor, gearhead, given.belt)
    gear = [check for check in checks if check.name.startswith("gearhead")]
    total = gearhead["ratio"] * given.belt
    checks.append(paper.largest_allowed(catalog, given.motor, given.gearhead, total, gear))
    currents = (
        shaft[f"{which}_torque_at_motor"].value / motor["torque_constant"] + motor["no_load_current"]
        for which in ("rms", "maximum")
    )
    controller = controllers(spec, catalog, given.motor, *currents)
    return [*checks, *controller.checks], controller.row


def _by_physics(
    spec: RobotSpec, catalog: Catalog, given: Candidates, encoder: NDArray[np.int64]
) -> tuple[list[CheckColumn], NDArray[np.int64]]:
    """Every limit against the whole load cycle, a belt at a time."""
    cycle = load_cycle(spec)
    controller = np.full(len(given.motor), -1, np.int64)
    found: list[tuple[NDArray[np.int64], list[CheckColumn]]] = []
    for belt in np.unique(given.belt):
        rows = np.flatnonzero(given.belt == belt)
        parts = [Rows(catalog.motors, given.motor[rows]), Rows(catalog.gearheads, given.gearhead[rows])]
        parts.append(Rows(catalog.encoders, encoder[rows]))
        at = at_gearhead(cycle, float(belt), spec.belt_efficiency)
        asked = demands(at, *parts)
        under = stress(spec, at, asked, parts[0], parts[1])
        currents = asked.rms_current, asked.peak_current
        chosen = controllers(spec, catalog, given.motor[rows], *currents, under.voltage)
        controller[rows] = chosen.row
        parts.append(Rows(catalog.controllers, chosen.row))
        found.append((rows, [chosen.checks[0], *limits(spec, at, asked, under, *parts)]))
    return in_order(found, len(given.motor)), controller


_OBJECTIVES: dict[str, tuple[str, tuple[str, ...]]] = {  # figure and the parts that it is summed over
    "mass": ("mass", ("motor", "gearhead")),
    "price": ("price", ("motor", "gearhead")),
    "length": ("length", ("motor", "gearhead")),
    "power": ("assigned_power", ("motor",)),
}


def _sum(evaluation: Evaluation, figure: str, parts: tuple[str, ...]) -> tuple[NDArray[Any], NDArray[Any]]:
    """The sum of what is known, and for how many parts it is unknown."""
    tables: dict[str, Table[Any]] = {"motor": evaluation.catalog.motors, "gearhead": evaluation.catalog.gearheads}
    rows = {"motor": evaluation.candidates.motor, "gearhead": evaluation.candidates.gearhead}
    figures = np.array([tables[part][figure][rows[part]] for part in parts])
    return np.nansum(figures, 0), np.isnan(figures).sum(0)


def _smallest_margin(evaluation: Evaluation) -> NDArray[np.float64]:
    """The smallest margin of each candidate that is known; what passes by choice is left out."""
    margins = np.array([np.where(c.by_choice & c.passed, np.nan, c.margin) for c in evaluation.checks])
    smallest: NDArray[np.float64] = np.where(np.isnan(margins), np.inf, margins).min(0)
    return smallest


def ranking(evaluation: Evaluation, objective: str) -> NDArray[np.int64]:
    """Candidates in order: those that pass, those with an unknown, those that fall.

    Within each, an objective that is known of all its parts goes before one that is not, then the better
    objective, then part numbers: the same input gives the same order. Those that fall are ordered by how far
    their worst check is off.
    """
    given, catalog = evaluation.candidates, evaluation.catalog
    if objective == "margin":
        value, missing = -_smallest_margin(evaluation), np.zeros(len(given.motor))
    else:
        value, missing = _sum(evaluation, *_OBJECTIVES[objective])
    misses = np.array([check.failed for check in evaluation.checks]).sum(0)
    order = np.lexsort((
        given.belt,
        _alphabetical(catalog.gearheads)[given.gearhead],
        _alphabetical(catalog.motors)[given.motor],
        value,
        missing,
        np.where(evaluation.failed, misses, 0),
        np.where(evaluation.failed, -_smallest_margin(evaluation), 0.0),
        np.where(evaluation.failed, 2, evaluation.unknown.astype(int)),
    ))  # fmt: skip
    return order.astype(np.int64)


def _alphabetical(table: Table[Any]) -> NDArray[np.int64]:
    """Place of each row by part number."""
    place = np.empty(len(table), np.int64)
    place[np.argsort(table["part"], kind="stable")] = np.arange(len(table))
    return place


def counts(evaluation: Evaluation) -> Counts:
    """How many candidates there were, how many stand, and how many each check fails."""
    stands = ~evaluation.failed
    if evaluation.spec.select.unknown == "reject":
        stands &= ~evaluation.unknown
    return Counts(
        considered=len(stands),
        feasible=int(stands.sum()),
        failed_by={check.name: int(check.failed.sum()) for check in evaluation.checks if check.failed.any()},
    )


def drive_set(evaluation: Evaluation, index: int, rank: int, objective: str) -> DriveSet:
    """One candidate as a record."""
    catalog, given = evaluation.catalog, evaluation.candidates
    motor = catalog.motors.record(int(given.motor[index]))
    gearhead = catalog.gearheads.record(int(given.gearhead[index]))
    parts = {"motor": motor, "gearhead": gearhead}
    encoder, controller = int(evaluation.encoder[index]), int(evaluation.controller[index])

    def summed(figure: str, over: tuple[str, ...]) -> tuple[float, tuple[str, ...]]:
        known = {p: getattr(parts[p], figure) for p in over if getattr(parts[p], figure) == getattr(parts[p], figure)}
        return (sum(known.values()) if known else float("nan")), tuple(known)

    mass, mass_of = summed("mass", ("motor", "gearhead"))
    if objective == "margin":
        value = float(_smallest_margin(evaluation)[index])
        value_of: tuple[str, ...] = ("smallest margin of all checks",)
    else:
        value, value_of = summed(*_OBJECTIVES[objective])
    return DriveSet(
        rank=rank,
        status="fail" if evaluation.failed[index] else "unknown" if evaluation.unknown[index] else "pass",
        motor=motor,
        gearhead=gearhead,
        encoder=catalog.encoders.record(encoder) if encoder >= 0 else None,
        controller=catalog.controllers.record(controller) if controller >= 0 else None,
        belt_ratio=float(given.belt[index]),
        belt_efficiency=evaluation.spec.belt_efficiency,
        total_ratio=float(gearhead.ratio * given.belt[index]),
        mass=mass,
        mass_of=mass_of,
        objective=value,
        objective_of=value_of,
        requirements=tuple(r.at(index) for r in evaluation.shaft.values()),
        checks=tuple(check.at(index, evaluation.spec.method) for check in evaluation.checks),
    )
