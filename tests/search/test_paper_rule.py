"""The paper's rule over whole catalogues, with those that it rejects and without."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from drivesizer.catalog import Catalog
from drivesizer.search.columns.candidates import candidates
from drivesizer.search.columns.evaluation import Evaluation, evaluate
from drivesizer.search.shortlist import problem_with_drive_mass
from drivesizer.sizing import load_parts
from drivesizer.spec.drive import Select
from drivesizer.spec.robot import RobotSpec

MACHINES = [(0.4, 45.0, 0.2), (1.5, 12.0, -0.1), (1.5, 45.0, 0.0), (4.0, 300.0, 0.0)]


def _problem(spec: RobotSpec, catalog: Catalog, speed: float, mass: float, slope: float, unknown: str = "allow"):
    """The example as another machine, of the whole catalogue."""
    sections = {
        "motion": spec.motion.model_copy(update={"speed": speed}),
        "load": spec.load.model_copy(update={"mass": mass, "slope": slope}),
        "select": Select(unknown=unknown),
    }
    changed = spec.model_copy(update=sections)
    return problem_with_drive_mass(changed, load_parts(changed, catalog))[0]


def _alike(one: Evaluation, rows: np.ndarray, other: Evaluation) -> None:
    whole = one.on(rows)
    for name in ("controller", "encoder", "brake"):
        np.testing.assert_array_equal(getattr(whole, name), getattr(other, name))
    for mine, its in zip(whole.checks, other.checks, strict=True):
        for field in fields(mine):
            np.testing.assert_array_equal(getattr(mine, field.name), getattr(its, field.name))
    for steps in ("wheel", "shaft"):
        mine, its = getattr(whole, steps), getattr(other, steps)
        assert list(mine) == list(its)
        for name in mine:
            np.testing.assert_array_equal(mine[name].value, its[name].value)


@pytest.mark.parametrize(("speed", "mass", "slope"), MACHINES)
def test_without_the_rejected_the_others_are_the_same(spec, catalog, speed, mass, slope):
    """Every figure of those that pass or may pass, whoever is looked at beside them."""
    problem = _problem(spec, catalog, speed, mass, slope)
    every = candidates(problem)
    whole, few = evaluate(problem, every), evaluate(problem, every, rejected=False)
    left = np.flatnonzero(~whole.on(np.arange(len(every.motor))).failed)
    possible = np.flatnonzero(~np.logical_or.reduce([c.failed for c in whole.checks if c.name in _by_rule(few)]))
    assert set(left) <= set(possible)
    _alike(whole, possible, few)


def _by_rule(found: Evaluation) -> set[str]:
    """Names of the checks that come before those of controller and encoder."""
    names = [check.name for check in found.checks]
    return set(names[: names.index("largest_reduction") + 1])
