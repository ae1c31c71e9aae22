"""Of drives that rank alike few are looked at in full, and those that are shown are the same as if all were."""

from pathlib import Path

import numpy as np
import pytest
from starters import STARTERS

from drivesizer.machine.problem import problem
from drivesizer.search import in_order, ranking
from drivesizer.search.columns.candidates import joined, pairs
from drivesizer.search.columns.evaluation import by_physics
from drivesizer.search.ranking import equals_of_the_last, ranked
from drivesizer.search.search import search
from drivesizer.spec.robot import load_spec

EXAMPLES = Path(__file__).parents[2] / "examples"
BELTS = [1.0, 1.06, 1.12, 1.18, 1.24]


@pytest.fixture(scope="module", params=["conveyor", "sps"])
def given(request, tmp_path_factory, catalog):
    path = tmp_path_factory.mktemp(request.param) / "robot.yaml"
    if request.param == "sps":
        text, belt = (EXAMPLES / "sps_robot.yaml").read_text(encoding="utf-8"), "    ratio: 1.1  "
        text = text[: text.index("select:")].replace("method: paper", "method: physics")
        changed = f"    ratios: {BELTS}  "
    else:
        text, belt = (STARTERS / "conveyor.yaml").read_text(encoding="utf-8"), "  # - {kind: belt, ratio: 1.5, "
        changed = f"  - {{kind: belt, ratios: {BELTS}, "
    assert belt in text
    path.write_text(text.replace(belt, changed), encoding="utf-8")
    found = problem(load_spec(path), catalog)
    assert found.belt_ratios == BELTS
    return found


def labels(found):
    sets = found.evaluation.candidates
    return list(zip(sets.motor.tolist(), sets.gearhead.tolist(), sets.belt.tolist(), strict=True))


@pytest.mark.parametrize("top", [1, 2, 5])
def test_the_first_of_many_equals_are_those_of_the_largest_margins(given, monkeypatch, top):
    """Gearheads limit those of the robot, so that few decide; motors those of the conveyor."""
    looked, own = [], in_order.by_physics
    monkeypatch.setattr(
        in_order, "by_physics", lambda p, sets, exact: looked.append(np.count_nonzero(exact)) or own(p, sets, exact)
    )
    found = {}
    for few in (1, 10_000):
        monkeypatch.setattr(in_order, "_FEW", few)
        looked.clear()
        found[few] = labels(search(given, top=top)), looked.copy()
    assert found[1][0] == found[10_000][0]
    assert len(found[10_000][1]) == 1
    if given.spec.load.kind == "wheeled_vehicle":
        assert len(found[1][1]) == 1 and found[1][1][0] < found[10_000][1][0] - 50


def test_no_margin_is_larger_than_what_the_search_knows_it_to_be_at_most(given):
    kept, _, _ = ranking.sifted(given)
    rank = ranked(given, kept, 5)
    order = rank.order(given.catalog, kept.sets)
    tied = order[: equals_of_the_last(given, rank, order, 5)]
    assert len(tied) > 20
    margin = in_order.smallest_margin(by_physics(given, kept.sets.on(tied), True).checks)
    assert (margin <= kept.most[tied]).all() and np.isfinite(kept.most[tied]).all()


def test_some_in_full_and_others_by_bounds_are_what_they_are_by_themselves(given):
    some = pairs(given).on(slice(0, None, 997))
    every = joined([some._replace(belt=np.full(len(some.motor), belt)) for belt in BELTS[:2]])
    in_full = np.random.default_rng(1).uniform(size=len(every.motor)) < 0.5
    both = by_physics(given, every, in_full)
    for side in (True, False):
        rows = np.flatnonzero(in_full == side)
        alone, those = by_physics(given, every.on(rows), side), both.on(rows)
        np.testing.assert_array_equal(those.controller, alone.controller)
        for check, same in zip(those.checks, alone.checks, strict=True):
            assert check.name == same.name
            np.testing.assert_array_equal(check.passed, same.passed, check.name)
            np.testing.assert_array_equal(check.failed, same.failed, check.name)
            np.testing.assert_allclose(check.demand, same.demand, rtol=1e-12, err_msg=check.name)
        for name, column in those.figures.items():
            np.testing.assert_allclose(column, alone.figures[name], rtol=1e-12, err_msg=name)
