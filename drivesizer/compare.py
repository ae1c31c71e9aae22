"""The paper's method and the physics side by side, for sets that were found by one of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.loads import wheeled_vehicle
from drivesizer.physics import at_gearhead
from drivesizer.physics_limits import limits, record
from drivesizer.profile import trapezoid
from drivesizer.results import Comparison, DriveSet
from drivesizer.search import Rows
from drivesizer.spec import RobotSpec

__all__ = ["with_physics"]

# what the paper checks, what physics checks in its place, and why the two figures differ
_PAIRS = (
    ("gearhead_continuous_torque", "gearhead_continuous_torque",
     "no bearing, efficiency and oversize factors; RMS while running"),
    ("gearhead_intermittent_torque", "gearhead_intermittent_torque",
     "no oversize and efficiency factors; the rotor is not behind the gearhead"),
    ("gearhead_input_speed", "gearhead_continuous_speed",
     "the wheel turns at speed over radius, no reserve of (1)"),
    ("controller_continuous_current", "controller_continuous_current",
     "rotor inertia through the ratio squared, braking by its direction of power, no factors"),
    ("controller_peak_current", "controller_peak_current",
     "rotor inertia through the ratio squared, no oversize factor"),
)  # fmt: skip


def with_physics(spec: RobotSpec, catalog: Catalog, sets: Sequence[DriveSet]) -> tuple[DriveSet, ...]:
    """The same sets with the checks of the drive model and a comparison of both methods.

    Parameters
    ----------
    spec, catalog
        What is asked for, and what there is.
    sets
        Sets as the search found them.
    """
    cycle = wheeled_vehicle(spec, trapezoid(spec.motion))
    behind = {ratio: at_gearhead(cycle, ratio, spec.belt_efficiency) for ratio in {s.belt_ratio for s in sets}}
    found = []
    for one in sets:
        parts = [Rows(catalog.table(f"{n}s"), np.array([_row(catalog, one, n)])) for n in _PARTS]
        asked, columns = limits(spec, behind[one.belt_ratio], *parts)
        checks = tuple(record(column, 0, asked) for column in columns)
        found.append(replace(one, physics=checks, comparison=_compared(replace(one, physics=checks))))
    return tuple(found)


_PARTS = ("motor", "gearhead", "encoder", "controller")


def _row(catalog: Catalog, one: DriveSet, name: str) -> int:
    """Row of a set's part; -1, the row of unknowns, where it has none."""
    part = getattr(one, name)
    return catalog.table(f"{name}s").rows[part.part] if part else -1


def _compared(one: DriveSet) -> tuple[Comparison, ...]:
    paper, physics = ({c.name: c for c in checks} for checks in (one.checks, one.physics))
    return tuple(
        Comparison(paper=paper[a], physics=physics[b], why=why) for a, b, why in _PAIRS if a in paper and b in physics
    )
