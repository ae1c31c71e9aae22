"""Columns of checks: what one candidate has of them, and some candidates."""

from dataclasses import replace
from itertools import permutations
from math import inf, isnan, nan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivesizer.physics.figures import Range
from drivesizer.results.check import tightest, verdict, worst, worst_of_cases
from drivesizer.results.check_columns import at_least, at_most, fits, over_ends, worst_case


def test_where_nobody_prints_the_limit_the_load_case_that_demands_most_counts():
    """A buyer reads the demand to look for the part; a case without a demand says least."""
    demands = np.array([[2.0, 3.0, nan, -5.0], [4.0, 1.0, 1.0, 4.0], [3.0, 3.0, 0.0, 0.0]])
    unknown = [(n, at_most("controller_peak_current", demand, nan)) for n, demand in enumerate(demands)]
    found = worst_case(unknown)
    assert found.case is not None and found.case.tolist() == [1, 0, 1, 0]
    for row, most in enumerate((4.0, 3.0, 1.0, -5.0)):
        (one,) = worst_of_cases([(f"case {n}", [column.at(row, "physics")]) for n, column in unknown])
        assert one.demand == most


def test_of_unknown_checks_the_smallest_actual_figure_counts():
    actual = {"a": 47.7, "b": 46.1, "c": nan}
    known = {
        name: at_least("battery_voltage", 42.0, np.array(volts)).at((), "budget") for name, volts in actual.items()
    }
    (found,) = worst_of_cases([(name, [replace(one, status="unknown", margin=nan)]) for name, one in known.items()])
    assert (found.case, found.limit) == ("b", 46.1)
    door = replace(known["a"], case="door of a section")  # a passage is a case of its own
    assert [one.case for one in worst_of_cases([("a", [door, known["a"]]), ("b", [known["b"]])])] == [door.case, "b"]
    assert worst_of_cases([("", [known["a"]])]) == (known["a"],)


def test_a_condition_that_fails_is_worse_than_one_that_is_unknown_and_that_worse_than_one_that_passes():
    """The gravest of the load cases counts, in whatever order they are; a case alone keeps its number."""
    met, open_, not_met = (
        fits("compatibility", good, known) for good, known in ((True, True), (True, False), (False, True))
    )
    for order in permutations([(0, met), (1, open_), (2, not_met)]):
        assert worst_case(order).case.item() == 2
    assert worst_case([(0, met), (1, open_)]).case.item() == 1
    assert worst_case([(1, met)]).case.item() == 1


def test_the_tightest_are_conditions_that_fail_and_then_the_smallest_margins():
    """Not what was selected to be small and passes, nor advice, nor what is unknown."""
    made = {
        "condition": fits("compatibility", False, True), "met": fits("compatibility", True, True),
        "fails": at_most("motor_power", 30.0, 24.0), "passes": at_most("motor_power", 20.0, 24.0),
        "chosen": at_most("motor_power", 23.0, 24.0, by_choice=True), "unknown": at_most("motor_power", 9.0, nan),
        "chosen, fails": at_most("motor_power", 32.0, 24.0, by_choice=True),
        "advice": at_most("motor_power", 40.0, 24.0, advice=True),
    }  # fmt: skip
    checks = {name: replace(column.at((), "paper"), name=name) for name, column in made.items()}
    found = [one.name for one in tightest(tuple(checks.values()), 9)]
    assert found == ["condition", "chosen, fails", "fails", "passes"]
    assert worst(tuple(checks.values())).name == "chosen, fails"
    assert verdict(tuple(checks.values())) == "fail" and verdict((checks["met"], checks["unknown"])) == "unknown"
    assert verdict((checks["passes"], checks["advice"])) == "pass"


def test_a_margin_counts_from_where_nothing_is_demanded():
    """75 K of a winding that may have 100 K above the ambient leave a third; with 25 % needed 80 K are the most."""
    found = at_most("winding_temperature", 298.15 + np.array([75.0, 79.0, 81.0]), 398.15, zero=298.15, needed=0.25)
    assert found.margin == pytest.approx([1.0 / 3.0, 100.0 / 79.0 - 1.0, 100.0 / 81.0 - 1.0])
    assert found.passed.tolist() == [True, True, False] and found.failed.tolist() == [False, False, True]


@pytest.mark.parametrize(
    ("samples", "status"),
    [
        ([(20.0, 24.0), (18.0, 24.0), (23.0, 24.0)], "pass"),
        ([(26.0, 24.0), (25.0, 24.0), (30.0, 24.0)], "fail"),
        ([(20.0, 24.0), (18.0, 24.0), (25.0, 24.0)], "open"),
        ([(20.0, 24.0), (18.0, 24.0), (nan, 24.0)], "open"),  # such as of a winding that runs away
        ([(nan, 24.0), (nan, 24.0), (nan, 24.0)], "unknown"),
        ([(nan, 24.0), (nan, inf), (nan, inf)], "unknown"),  # no limit at an end decides nothing of an unknown demand
    ],
)
def test_a_check_at_estimated_figures_is_what_all_its_samples_are(samples, status):
    middle, *ends = (at_most("supply_voltage", demand, limit) for demand, limit in samples)
    found = over_ends(middle, ends).at((), "physics")
    assert found.status == status
    if status == "open" and not isnan(samples[2][0]):
        assert found.band == (18.0, 25.0, pytest.approx(24.0 / 25.0 - 1.0))


def test_what_would_decide_is_said_of_an_undecided_check_alone_and_a_moment_where_there_is_one():
    volts = at_most("bus_voltage", Range(np.array([30.0, 55.0, 70.0, 30.0]), np.array([31.0, 65.0, 80.0, nan])),
                    np.array([60.0, 60.0, 60.0, nan]), undecided="where it goes",
                    time=Range(np.array([0.5, nan, nan, nan]), np.array([0.5, nan, nan, nan])))  # fmt: skip
    found = [volts.at(row, "physics") for row in range(4)]
    assert [one.status for one in found] == ["pass", "open", "fail", "unknown"]
    assert [one.note for one in found] == ["", "where it goes", "", ""]
    assert [one.at_time for one in found] == [0.5, None, None, None]


ENDS = st.tuples(*[st.floats(-1e3, 1e3)] * 2).map(sorted)


@given(ENDS, ENDS, st.sampled_from([0.0, 20.0]), st.sampled_from([0.0, 0.25]))
def test_a_range_passes_or_fails_where_every_figure_within_it_does(demand, limit, zero, needed):
    """Nine demands against nine limits within the ends, each judged alone; without a high end nothing passes."""
    within = [np.linspace(*ends, 9) for ends in (demand, limit)]
    every = at_most("motor_power", within[0][:, None], within[1], zero=zero, needed=needed)
    whole = at_most("motor_power", Range(*demand), Range(*limit), zero=zero, needed=needed)
    assert not whole.passed or every.passed.all()
    assert not whole.failed or every.failed.all()
    if demand[0] > zero:  # what is at its zero passes by itself
        assert whole.passed == every.passed.all() and whole.failed == every.failed.all()
    assert not at_most("motor_power", Range(demand[0], nan), Range(*limit), zero=zero, needed=needed).passed
