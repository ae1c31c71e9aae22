"""What a table keeps of a drive, its tightest check and its status, against all checks of its record."""

import numpy as np
import pytest
from starters import starter

from drivesizer.machine.problem import problem
from drivesizer.results.check import verdict, worst
from drivesizer.search.columns.candidates import candidates
from drivesizer.search.columns.evaluation import evaluate
from drivesizer.search.set_record import drive_in_brief


@pytest.fixture(scope="module", params=["paper", "physics"])
def found(request, spec, catalog, tmp_path_factory):
    """Drives that pass, fail and are unknown, by either method."""
    one = spec if request.param == "paper" else starter("hoist", tmp_path_factory.mktemp("hoist"))
    given = problem(one, catalog)
    every = candidates(given)
    return evaluate(given, every.on(np.arange(0, len(every.motor), max(len(every.motor) // 60, 1))))


def test_the_tightest_check_is_the_worst_of_all(found):
    for row in range(len(found.candidates.motor)):
        tightest = found.tightest_of(row)
        assert worst(tightest) == worst(tuple(check for check in found.checks_of(row) if not check.advice))
        assert len(tightest) <= 1


def test_the_status_of_one_is_that_of_its_checks(found):
    statuses = [found.status(row) for row in range(len(found.candidates.motor))]
    assert statuses == [verdict(found.checks_of(row)) for row in range(len(statuses))]
    assert [found.fails(row) for row in range(len(statuses))] == found.failed.tolist()
    assert [status == "unknown" for status in statuses] == found.unknown.tolist()
    assert len({*statuses}) > 1


def test_a_record_in_brief_has_the_status_of_all_checks(found):
    for row in range(len(found.candidates.motor)):
        brief = drive_in_brief(found, row, 1)
        assert (brief.status, brief.checks) == (found.status(row), found.tightest_of(row))
