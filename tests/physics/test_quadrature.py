"""Rules of quadrature that are written down, against those that numpy computes."""

from __future__ import annotations

import numpy as np
import pytest

from drivesizer.physics.gear_life import FIVE, SIX


@pytest.mark.parametrize("rule", [FIVE, SIX], ids=["five", "six"])
def test_a_rule_is_that_of_numpy_and_exact_for_polynomials(rule):
    nodes, weights = rule
    for own, theirs in zip(rule, np.polynomial.legendre.leggauss(len(nodes)), strict=True):
        assert own == pytest.approx(theirs, abs=1e-15)
    for power in range(2 * len(nodes)):
        exact = 0.0 if power % 2 else 2.0 / (power + 1)
        assert weights @ nodes**power == pytest.approx(exact, abs=1e-14)
