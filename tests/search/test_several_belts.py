"""Belts that are looked at together, against each of them looked at alone: not a figure may differ."""

from collections import Counter

import numpy as np
import pytest
from starters import starter

from drivesizer.machine.problem import problem
from drivesizer.physics.drive_train import back_emf_constant, gear_loss, nominal_friction
from drivesizer.physics.thermal import rated_ambient, resistance_25
from drivesizer.search import ranking
from drivesizer.search.columns import stages
from drivesizer.search.columns.candidates import Crossed, Rows, joined, pairs
from drivesizer.search.columns.stages import examine

BELTS = [1.0, 1.37, 2.2]
COLUMNS = ("unknown", "encoder", "controller", "brake")


@pytest.fixture(scope="module")
def given(tmp_path_factory, catalog):
    return problem(starter("hoist", tmp_path_factory.mktemp("hoist")), catalog)


def whole(found, name):
    return np.concatenate([getattr(one, name) for one in found])


def counted(found):
    return sum((one.failed_by for one in found), Counter())


def assert_same(together, alone):
    """What was examined together and belt by belt; numbers count behind the belt."""
    assert len(whole(alone, "rows")) > len(BELTS)
    for name in COLUMNS:
        np.testing.assert_array_equal(whole(together, name), whole(alone, name), name)
    np.testing.assert_allclose(whole(together, "margin"), whole(alone, "margin"), rtol=1e-9)  # some by bounds
    for name in alone[0].figures:
        columns = (np.concatenate([one.figures[name] for one in found]) for found in (together, alone))
        np.testing.assert_array_equal(*columns, name)


def test_pairs_behind_several_belts_are_what_they_are_behind_each(given):
    every = pairs(given)
    together = list(examine(given, Crossed(every, BELTS), exact=False, margins=True))
    alone = [one for belt in BELTS for one in examine(given, Crossed(every, [belt]), exact=False, margins=True)]
    assert_same(together, alone)
    assert counted(together) == counted(alone)
    behind = [one._replace(rows=one.rows + n * len(every.motor), rejected=one.rejected + n * len(every.motor))
              for n, one in enumerate(alone)]  # fmt: skip
    np.testing.assert_array_equal(whole(together, "rows"), whole(behind, "rows"))
    bounds = [dict(zip(whole(f, "rejected"), whole(f, "bound"), strict=True)) for f in (together, behind)]
    assert bounds[0].keys() == bounds[1].keys()
    for side in bounds:
        assert [side[key] for key in sorted(side)] == pytest.approx([bounds[0][key] for key in sorted(side)], rel=1e-9)


def test_what_the_segments_of_a_short_cycle_pass_the_waveform_passes(tmp_path, catalog):
    """And nothing else: bounds leave to the waveform whatever they do not show to pass."""
    given = problem(starter("wheeled_vehicle", tmp_path), catalog)
    crossed = Crossed(pairs(given), BELTS)
    by_bounds, by_waveform = (list(examine(given, crossed, exact=exact)) for exact in (False, True))
    for name in ("rows", "unknown", "controller"):
        np.testing.assert_array_equal(whole(by_bounds, name), whole(by_waveform, name), name)


def test_a_list_behind_several_belts_is_what_it_is_behind_each(given):
    few = pairs(given).on(slice(0, None, 4001))
    behind = [few._replace(belt=np.full(len(few.motor), belt)) for belt in BELTS]
    together, alone = list(examine(given, joined(behind))), [one for some in behind for one in examine(given, some)]
    assert_same(together, alone)
    assert [check.name for check in together[0].checks] == [check.name for check in alone[0].checks]
    for place, check in enumerate(together[0].checks):
        for name in ("demand", "limit", "passed", "failed", "time"):
            if getattr(check, name) is not None:
                each = np.concatenate([getattr(one.checks[place], name) for one in alone])
                np.testing.assert_array_equal(getattr(check, name), each, check.name)


@pytest.mark.parametrize(
    ("section", "compute"),
    [("motors", nominal_friction), ("motors", back_emf_constant), ("motors", resistance_25), ("motors", rated_ambient),
     ("gearheads", gear_loss)],
)  # fmt: skip
def test_what_hangs_on_one_part_is_the_same_however_many_candidates_have_it(catalog, section, compute):
    """Of many it is computed once for each part of the table; where some have none, that is unknown."""
    table = catalog.table(section)
    rows = np.append(np.tile(np.arange(len(table)), 2), -1)
    each = {name: np.append(column[rows[:-1]], "" if column.dtype.kind == "U" else np.nan)
            for name, column in table.columns.items()}  # fmt: skip
    np.testing.assert_array_equal(compute(Rows(table, rows)), compute(each))


def test_the_stage_of_a_controller_is_that_of_each_candidate_that_has_it(given):
    table, spec = given.catalog.controllers, given.spec
    rows = np.append(np.tile(np.arange(len(table)), 2), -1)
    one_by_one = [spec.feed(Rows(table, rows[[place]])).stage for place in range(len(rows))]
    for name, column in spec.feed(Rows(table, rows)).stage._asdict().items():
        np.testing.assert_array_equal(column, np.concatenate([getattr(one, name) for one in one_by_one]), name)


def test_chunks_of_candidates_are_what_they_are_together(given, monkeypatch):
    kept, closest, counts = ranking.sifted(given)
    monkeypatch.setattr(ranking, "_CHUNK", 3001)
    monkeypatch.setattr(stages, "_ROWS", 500)
    monkeypatch.setattr(stages, "_MOST_BEHIND_ONE_BELT", 700)
    others, same, tally = ranking.sifted(given)
    assert tally == counts
    for one, other in ((kept.sets, others.sets), (closest, same)):
        for name in ("motor", "gearhead", "belt"):
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
