"""Refinement of a study: its steps are halved where the best drive changes.

A cell lies between neighbouring steps of all ranges, at one value of each other field. Where its corners differ in the
best drive or its status, it is halved along each range: the points in the middle of its edges, sides and inside are
sized, and its parts are cells of the next halving. Each round follows from the rows of those before, so a study that
was stopped goes on with the same points.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

from drivesizer.study.column import Row
from drivesizer.study.columns import columns_of
from drivesizer.study.plan import Places, Plan

__all__ = ["refined"]

_Found = dict[Places, tuple[Any, ...]]  # status and best drives of the variants of each point


def refined(plan: Plan, chunks: Iterable[list[Row]]) -> Plan | None:
    """The plan with the points of one more halving."""
    level = len(plan.rounds)
    if level >= plan.depth:
        return None
    found = _best_drives(plan, chunks)
    half = plan.parts >> level + 1
    new = {point for cell in _halved(plan, found, level) for point in _lattice(plan, cell, (0, half, 2 * half))}
    points = tuple(sorted(new - found.keys()))
    return replace(plan, rounds=(*plan.rounds, len(points)), added=(*plan.added, *points)) if points else None


def _best_drives(plan: Plan, chunks: Iterable[list[Row]]) -> _Found:
    heads = [column.head for column in columns_of(plan)]
    number, rank = heads.index("variant"), heads.index("rank")
    drives = {"set", *(f"{name}.set" for name in plan.job.members)}
    compared = [n for n, head in enumerate(heads) if head == "status" or head in drives]
    found: _Found = {}
    for rows in chunks:
        for row in rows:
            if row[rank] in (None, 1):
                _, places = plan.places((row[number] - 1) // plan.of_each)
                found[places] = (*found.get(places, ()), *(row[n] for n in compared))
    return found


def _halved(plan: Plan, found: _Found, level: int) -> list[Places]:
    """Cells whose corners differ, each by its first corner, after so many halvings."""
    size = plan.parts >> level
    cells: Iterable[Places] = _first_cells(plan)
    if level:
        cells = (part for cell in _halved(plan, found, level - 1) for part in _lattice(plan, cell, (0, size)))
    return [cell for cell in cells if len({found[point] for point in _lattice(plan, cell, (0, size))}) > 1]


def _first_cells(plan: Plan) -> Iterable[Places]:
    return product(*(
        range(0, (len(axis.values) - 1) * plan.parts, plan.parts) if axis.stepped else range(len(axis.values))
        for axis in plan.job.axes
    ))  # fmt: skip


def _lattice(plan: Plan, cell: Places, offsets: Sequence[int]) -> Iterable[Places]:
    """Points at all combinations of some offsets from a cell's first corner, along the ranges."""
    axes = zip(plan.job.axes, cell, strict=True)
    return product(*([place + one for one in offsets] if axis.stepped else [place] for axis, place in axes))
