"""Mass budgets: sums of what is known, and the mass at which a drive carries itself."""

import math
from dataclasses import replace
from math import nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivesizer import size
from drivesizer.machine.budgets import drive_rows, machine_mass, settle
from drivesizer.results.drive_set import MassRow
from drivesizer.spec.platform import Budget

pytestmark = pytest.mark.usefixtures("no_further_searches")

GRAM = 1e-3


@pytest.fixture(scope="module")
def drive(spec):
    """The paper's set: RE 25, 130 g, and GP 26 A, 77 g, as the catalogue has them; its encoder's mass is not known."""
    return size(spec).sets[0]


# --- rows -------------------------------------------------------------------------------------------------------------


def test_the_rows_of_four_sets(drive):
    rows = {row.name: row for row in drive_rows(drive, 4)}
    assert rows["motor"].total == pytest.approx(4 * 0.130) and rows["gearhead"].total == pytest.approx(4 * 0.077)
    assert math.isnan(rows["encoder"].each) and math.isnan(rows["controller"].each)
    assert math.isnan(rows["belt and pulleys"].each)  # a ratio without parts
    assert {row.number for row in rows.values()} == {4}
    known = replace(drive, encoder=replace(drive.encoder, mass=0.010), controller=None, belt_ratio=1.0)
    rows = {row.name: row for row in drive_rows(known, 2)}
    assert rows["encoder"].total == pytest.approx(0.020)
    assert math.isnan(rows["controller"].each)  # none is chosen: not that it weighs nothing
    assert "belt and pulleys" not in rows


def test_the_sum_is_of_what_is_known_and_what_is_not_is_named():
    drive = (MassRow(name="motor", each=0.13, number=4), MassRow(name="encoder", each=nan, number=4))
    others = [{"name": "arm", "mass": "3.2 kg"}, {"name": "LIDARs", "mass": "0.26 kg", "number": 2}]
    given = Budget.model_validate({"structure": "18.4 kg", "others": others, "mass": "45 kg"})
    found = machine_mass(given, drive, battery=10.8)
    assert found.known == pytest.approx(4 * 0.13 + 18.4 + 10.8 + 3.2 + 0.52)
    assert found.unknown == ("encoder",)
    assert [f.value for f in found.figures()] == pytest.approx([found.known, 45.0 - found.known])
    assert [f.name for f in machine_mass(Budget(), drive).figures()] == ["mass_known"]


def test_a_structure_that_is_not_given_is_unknown_and_no_battery_is_none():
    whole = Budget.model_validate({"structure": "3 kg"})
    assert machine_mass(Budget(), ()).unknown == ("structure",)
    assert machine_mass(whole, (), battery=nan).unknown == ("battery",)
    assert [row.name for row in machine_mass(whole, ()).rows] == ["structure"]


# --- the drive's own mass ---------------------------------------------------------------------------------------------


@given(st.floats(1.0, 80.0), st.floats(0.0, 5.0), st.floats(0.0, 0.7))
def test_a_drive_that_grows_with_the_machine_settles_at_the_geometric_sum(base, fixed, share):
    found = settle(lambda mass: fixed + share * mass, base, tolerance=1e-7, most=200)
    assert found.carries_itself and found.total == pytest.approx((base + fixed) / (1.0 - share), rel=1e-5)


LADDER = ((12.0, 0.8), (14.0, 1.6), (17.0, 3.5))  # carries, weighs


def from_ladder(mass, ladder=LADDER):
    return next((weighs for carries, weighs in ladder if mass <= carries), None)


@pytest.mark.parametrize(
    ("base", "total", "rounds"), [(11.0, 11.8, 2), (11.5, 13.1, 3), (12.3, 13.9, 2), (13, 16.5, 3)]
)
def test_sets_of_a_catalogue_settle_on_the_first_that_carries_itself(base, total, rounds):
    found = settle(from_ladder, base)
    assert found.carries_itself and found.total == pytest.approx(total)
    assert found.words.startswith(f"Settled after {rounds} rounds")


@given(st.lists(st.tuples(st.floats(0.1, 4.0), st.floats(0.1, 4.0)), min_size=1, max_size=8), st.floats(1.0, 12.0))
def test_of_sets_that_weigh_more_the_more_they_carry_the_lightest_is_found(steps, base):
    """Second opinion by looking at each set: the lightest that carries base and itself, or none does."""
    carries, weighs, ladder = 0.0, 0.0, []
    for more, heavier in steps:
        carries, weighs = carries + more, weighs + heavier
        ladder.append((carries, weighs))
    found = settle(lambda mass: from_ladder(mass, ladder), base)
    fitting = [base + own for can, own in ladder if base + own <= can]
    assert found.carries_itself == bool(fitting)
    assert not fitting or found.total == pytest.approx(fitting[0], abs=GRAM)


def test_two_sets_that_follow_each_other_leave_the_one_for_the_heavier_machine():
    """The cheapest for 20 kg weighs 3 kg, the cheapest for 23 kg weighs 2 kg: at 23 kg all is carried."""
    found = settle(lambda mass: 3.0 if mass <= 22.5 else 2.0, 20.0)
    assert found.carries_itself and found.total == 23.0
    assert "2 sets follow each other" in found.words and "1 kg" in found.words


@given(st.lists(st.floats(0.1, 6.0), min_size=2, max_size=9), st.integers(0, 2**32 - 1))
def test_whatever_is_taken_carries_itself(masses, seed):
    """Any table of masses, so any cycle: what is found was sized for no less than it makes."""

    def anything(mass):
        return masses[(seed + round(mass * 1000) * 7919) % len(masses)]

    found = settle(anything, 10.0, most=60)
    assert not found.carries_itself or 10.0 + anything(found.total) <= found.total + GRAM


@pytest.mark.parametrize(
    ("law", "limits", "total", "words"),
    [
        (from_ladder, {}, 17.5, "No set carries itself: at 17.5 kg none is left."),
        (lambda mass: 1.3 * mass, {"most": 12}, None, "No set carries itself: each round adds no less mass than"),
        (lambda mass: 1.3 * mass, {}, None,  # 14 (1.3^39 - 1) / 0.3
         "No set carries itself within 1e+06 kg: the next would make 1.297e+06 kg."),
        (lambda mass: 0.95 * mass, {"most": 20}, None, "Not settled in 20 rounds, though they draw near"),
        (lambda mass: nan, {}, 14.0, "The mass of the set for 14 kg is unknown."),
    ],
)  # fmt: skip
def test_no_set_that_carries_itself_is_said_plainly(law, limits, total, words):
    found = settle(law, 14.0, **limits)
    assert not found.carries_itself and found.words.startswith(words)
    assert total is None or found.total == pytest.approx(total)
