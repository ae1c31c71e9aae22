"""Drives by weights: the order is that of a plain computation with fractions, in any units, and says what it lacks."""

import random
from fractions import Fraction
from math import isnan, nan
from types import SimpleNamespace

import numpy as np
import pytest

from drivesizer.results.sizing import multiples, used_share, weighted_order
from drivesizer.search.ranking import objective_of, values

DRAW = random.Random(20260)


def plain_order(figures, weights):
    """The rule once more, drive by drive, with exact fractions."""
    count, keys = len(next(iter(figures.values()))), []
    for drive in range(count):
        lacking, total, share = 0, Fraction(0), Fraction(0)
        for name, column in figures.items():
            weight = Fraction(weights.get(name, 0))
            if weight == 0:
                continue
            if isnan(column[drive]):
                lacking += 1
                continue
            known = [Fraction(x) for x in column if not isnan(x)]
            own, best = Fraction(column[drive]), min(known)
            ratio = own / best if best > 0 else 1 + (own - best) / (max(map(abs, known)) or 1)
            total, share = total + weight * ratio, share + weight
        keys.append((lacking, total / share if share else Fraction(10**9), drive))
    return [drive for *_, drive in sorted(keys)]


def drawn(count):
    """Figures of drives, some unknown, one of them of drives that regenerate, some drives alike."""
    figures = {
        "mass": [DRAW.uniform(0.2, 2.0) for _ in range(count)],
        "price": [DRAW.choice([nan, DRAW.uniform(100.0, 900.0)]) for _ in range(count)],
        "energy": [DRAW.uniform(-30.0, 50.0) for _ in range(count)],
        "margin": [DRAW.choice([nan, *[DRAW.uniform(0.4, 1.0)] * 5]) for _ in range(count)],
    }
    for column in figures.values():
        column[5:8] = [column[5]] * 3
    return figures


@pytest.mark.parametrize("count", [1, 12, 60])
def test_the_order_is_that_of_a_plain_computation(count):
    for _ in range(15):
        figures = drawn(max(count, 8))
        weights = {name: DRAW.choice([0, DRAW.randint(1, 10), DRAW.uniform(0, 3)]) for name in figures}
        found = weighted_order({name: np.array(column) for name, column in figures.items()}, weights)
        assert found.order.tolist() == plain_order(figures, weights), weights


def test_by_hand():
    """Two thirds mass, a third price: 2/3 + 300/200/3 = 7/6, and 2/3 * 1.1 + 1/3 = 16/15; the third lacks a price."""
    figures = {"mass": np.array([200.0, 220.0, 180.0]) / 1e3, "price": np.array([300.0, 200.0, nan])}
    found = weighted_order({"mass": figures["mass"][:2], "price": figures["price"][:2]}, {"mass": 2.0, "price": 1.0})
    assert found.order.tolist() == [1, 0] and found.score == pytest.approx([7 / 6, 16 / 15])
    found = weighted_order(figures, {"mass": 2.0, "price": 1.0})  # the lightest has no price: not the cheapest
    assert found.order.tolist() == [1, 0, 2] and found.lacking.tolist() == [0, 0, 1]
    assert weighted_order(figures, {"mass": 2.0}).order.tolist() == [2, 0, 1]  # until a price does not count


def test_units_change_nothing():
    figures, weights = drawn(50), {"mass": 1.0, "price": 2.0, "energy": 3.0, "margin": 0.5}
    one, other = (
        weighted_order({name: factor * np.array(column) for name, column in figures.items()}, weights)
        for factor in (1.0, 1024.0)
    )
    assert one.order.tolist() == other.order.tolist()
    np.testing.assert_array_equal(one.score, other.score)


def test_the_best_by_one_weight_is_the_best_of_that_figure():
    figures = {name: np.array(column) for name, column in drawn(50).items()}
    for name, column in figures.items():
        assert weighted_order(figures, {name: 3.0}).order[0] == np.flatnonzero(column == np.nanmin(column))[0]


def test_edges():
    none = np.full(3, nan)
    for weights in ({}, {"mass": 0.0}, {"mass": 1.0}):
        found = weighted_order({"mass": none}, weights)
        assert found.order.tolist() == [0, 1, 2] and np.isnan(found.score).all()
        assert found.lacking.tolist() == [len([w for w in weights.values() if w])] * 3
    assert weighted_order({}, {"mass": 1.0}).order.tolist() == []
    assert multiples(np.zeros(2), np.array([True, True])).tolist() == [1.0, 1.0]
    assert used_share(np.array([0.25, 1.0, -1.0])) == pytest.approx([0.8, 0.5, 1e9])


def test_an_energy_below_zero_is_weighted_in_any_unit():
    """Drives that regenerate: joules were added to multiples as they are."""
    sets, objective = SimpleNamespace(motor=np.zeros(3)), objective_of("energy=1,peak_current=2")
    currents = np.array([2.0, 3.0, 4.0])
    for factor in (1.0, 1e-3):
        figures = {"energy": factor * np.array([-4.0, -2.0, 2.0]), "peak_current": currents}
        total, missing = values(None, sets, figures, objective)
        assert total == pytest.approx([1.0 + 2.0, 1.5 + 3.0, 2.5 + 4.0]) and not missing.any()
