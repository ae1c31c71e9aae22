"""Candidates at both ends of the bands of estimated figures, examined in one go: as at each end by itself."""

from collections import Counter

import numpy as np
import pytest
from starters import starter

from drivesizer.catalog import load
from drivesizer.catalog.view.search_view import search_view
from drivesizer.machine.problem import problem
from drivesizer.search.columns.candidates import Crossed, joined, pairs
from drivesizer.search.columns.evaluation import at_ends, both_ends, estimated
from drivesizer.search.columns.stages import examine

BELTS = [1.0, 1.37, 2.2]
MAKERS = ["faulhaber", "maxon"]  # many of whose figures are estimated, among them those of brakes
CHOSEN = ("encoder", "controller", "unknown")


@pytest.fixture(scope="module", params=["hoist", "rotary_table"])
def given(request, tmp_path_factory):
    spec = starter(request.param, tmp_path_factory.mktemp(request.param))
    found = problem(spec, search_view(load(MAKERS)))
    assert found.spec.wants_brake is (request.param == "hoist")
    return found


def whole(found, name):
    return np.concatenate([getattr(one, name) for one in found])


def test_both_ends_in_one_go_are_what_each_is_by_itself(given):
    every = pairs(given)
    few = estimated(given, every)
    assert 100 < len(few) < len(every.motor)
    ends = both_ends(given, every.on(few))
    twice = Crossed(joined([every, ends.unfavourable(every.on(few))]), BELTS, len(every.motor))
    together = list(examine(ends.problem, twice, exact=False, offered=ends.offered))
    sides = [list(examine(end, Crossed(sets, BELTS), exact=False))
             for end, sets in zip(at_ends(given), (every, every.on(few)), strict=True)]  # fmt: skip
    row = whole(together, "rows") % len(twice.pairs.motor)
    of_side = row < len(every.motor), row >= len(every.motor)
    for side, rows in zip(sides, of_side, strict=True):
        assert np.count_nonzero(rows) > 100
        for name in CHOSEN:
            np.testing.assert_array_equal(whole(together, name)[rows], whole(side, name), name)
        np.testing.assert_array_equal(ends.brakes(whole(together, "brake")[rows]), whole(side, "brake"))
    easy, hard = sides
    belt = whole(together, "rows") // len(twice.pairs.motor)
    np.testing.assert_array_equal((belt * len(every.motor) + row)[of_side[0]], whole(easy, "rows"))
    np.testing.assert_array_equal((belt * len(few) + row - len(every.motor))[of_side[1]], whole(hard, "rows"))


def test_only_what_fails_at_the_favourable_end_counts_and_may_be_the_closest(given):
    every = pairs(given)
    few = estimated(given, every)
    ends = both_ends(given, every.on(few))
    twice = Crossed(joined([every, ends.unfavourable(every.on(few))]), BELTS, len(every.motor))
    together = list(examine(ends.problem, twice, exact=False, offered=ends.offered))
    easy = list(examine(at_ends(given)[0], Crossed(every, BELTS), exact=False))
    counted = [sum((one.failed_by for one in found), Counter()) for found in (together, easy)]
    assert counted[0] == counted[1] and counted[0].total() > 1000
    belt, row = np.divmod(whole(together, "rejected"), len(twice.pairs.motor))
    assert row.max() < len(every.motor)
    assert set((belt * len(every.motor) + row).tolist()) == set(whole(easy, "rejected").tolist())


def test_encoders_and_controllers_have_no_estimated_figure_that_a_check_rests_on():
    """They stand in the tables of both ends once, at the favourable one."""
    easy, hard = search_view(load(MAKERS)).ends
    for section in ("encoders", "controllers"):
        for name, column in easy.table(section).columns.items():
            if name != "mass":
                np.testing.assert_array_equal(column, hard.table(section)[name], f"{section} {name}")
