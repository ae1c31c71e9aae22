"""Columns of checks: what one candidate has of them, and some candidates."""

from dataclasses import fields, replace
from math import inf, nan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivesizer.results.check import worst_of_cases
from drivesizer.results.check_columns import CheckColumn, at_least, at_most, over_band, worst_case

FIGURES = st.lists(
    st.tuples(*[st.one_of(st.floats(-1e6, 1e6), st.sampled_from([0.0, -0.0, 20.0, inf, -inf, nan]))] * 2),
    min_size=1, max_size=6,
)  # fmt: skip


@given(FIGURES, st.sampled_from([0.0, 20.0, nan]), st.sampled_from([0.0, 0.25]))
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_the_margin_of_one_is_that_of_the_column(figures, zero, needed):
    demand, limit = np.array(figures).T
    check = at_most("winding_temperature", demand, limit, zero=zero, needed=needed)
    for n, expected in enumerate(check.margin.tolist()):
        assert check.at(n, "physics").margin == pytest.approx(expected, rel=0.0, abs=0.0, nan_ok=True)


def test_the_margin_where_ends_of_a_band_decide():
    """Neither passed nor failed in the middle, but open: it has a margin, to the bit that of the column."""
    middle, low, high = (at_most("supply_voltage", np.array([x, 3.0]), 24.0) for x in (22.1, 20.3, 25.7))
    found = over_band(middle, [one.on(slice(0, 1)) for one in (low, high)], np.array([0]))
    assert [found.at(n, "physics").status for n in (0, 1)] == ["open", "pass"]
    assert [found.at(n, "physics").margin for n in (0, 1)] == found.margin.tolist() == [24.0 / 22.1 - 1.0, 7.0]


def test_some_candidates_have_every_field_of_the_column():
    check = at_least("motor_speed", np.array([1.0, 2.0, 5.0]), np.array([3.0, 1.0, nan]), note="n", by_choice=True,
                     time=np.array([0.5, 1.5, 2.5]))  # fmt: skip
    some = check.on(np.array([2, 0]))
    for field in fields(CheckColumn):
        whole, part = getattr(check, field.name), getattr(some, field.name)
        if isinstance(whole, np.ndarray):
            assert np.array_equal(part, whole[[2, 0]], equal_nan=whole.dtype == float), field.name
        else:
            assert part is whole, field.name
    assert some.at(1, "physics").margin == 2.0


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
