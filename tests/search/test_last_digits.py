"""What ranks alike and moments that are alike go by their order, not by last digits, which another processor gives."""

from __future__ import annotations

import numpy as np

from drivesizer.results.check_columns import at_most, worst_case
from drivesizer.search import ranking
from drivesizer.search.columns.candidates import Candidates


def test_margins_and_objectives_that_differ_by_rounding_are_equal(catalog):
    sets = Candidates(np.array([7, 3, 5]), np.zeros(3, np.int64), np.ones(3), np.ones(3, bool))
    parts = [str(catalog.motors["part"][row]) for row in sets.motor]
    by_part = sorted(range(3), key=lambda n: parts[n])
    margin = np.full(3, 0.3)
    margin[by_part[2]] = 0.1 + 0.2
    mass, none = 2.0 * margin, np.zeros(3, np.int64)
    assert ranking.order(catalog, sets, mass, none, margin=margin).tolist() == by_part
    margin[by_part[2]] = 0.3001
    assert ranking.order(catalog, sets, np.ones(3), none, margin=margin)[0] == by_part[2]
    energy = {"energy": mass, "winding_temperature": -margin}
    assert len(ranking.front(catalog, sets, energy, ["energy"])) == 1


def test_of_load_cases_that_are_equal_but_for_rounding_the_first_counts():
    """0.6 A of 1 A, then a last digit more, then a thousandth more."""
    demands = np.array([[0.6, 0.6, 0.0], [0.6 + 2e-16, 0.6 + 2e-16, 0.6], [0.6, 0.601, 0.6 - 1e-16]])
    found = worst_case([(n, at_most("controller_peak_current", demand, 1.0)) for n, demand in enumerate(demands)])
    assert found.case is not None and found.case.tolist() == [0, 2, 1]
