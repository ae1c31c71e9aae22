"""Mass budgets: sums of what is known, and the mass at which a drive carries itself."""

import math
from dataclasses import replace
from math import nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivesizer import size
from drivesizer.machine.mass_budget import drive_rows, mass_budget, settle
from drivesizer.results.drive_set import MassRow

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
    found = mass_budget(drive, structure=18.4, battery=10.8, others=(("arm", 3.2), ("LIDARs", 0.52)), limit=45.0)
    assert found.known == pytest.approx(4 * 0.13 + 18.4 + 10.8 + 3.2 + 0.52)
    assert found.unknown == ("encoder",) and math.isnan(found.total)
    assert found.left == pytest.approx(45.0 - found.known)
    whole = mass_budget(drive[:1], structure=18.4, battery=10.8)
    assert whole.total == pytest.approx(29.72) and math.isnan(whole.left)


def test_a_structure_that_is_not_given_is_unknown_and_no_battery_is_none():
    assert mass_budget(()).unknown == ("structure",)
    assert mass_budget((), structure=3.0, battery=nan).unknown == ("battery",)
    assert [row.name for row in mass_budget((), structure=3.0).rows] == ["structure"]


# --- the drive's own mass ---------------------------------------------------------------------------------------------


@given(st.floats(1.0, 80.0), st.floats(0.0, 5.0), st.floats(0.0, 0.7))
def test_a_drive_that_grows_with_the_machine_settles_at_the_geometric_sum(base, fixed, share):
    found = settle(lambda mass: (fixed + share * mass, "a"), base, tolerance=1e-7, most=200)
    assert found.status == "settled" and found.carries_itself
    assert found.total == pytest.approx((base + fixed) / (1.0 - share), rel=1e-5)
    assert found.total == pytest.approx(base + found.drive, abs=1e-7)


LADDER = ((12.0, 0.8, "small"), (14.0, 1.6, "middle"), (17.0, 3.5, "large"))  # carries, weighs, is


def from_ladder(mass, ladder=LADDER):
    return next(((weighs, name) for carries, weighs, name in ladder if mass <= carries), None)


@pytest.mark.parametrize(
    ("base", "key", "total", "rounds"),
    [(11.0, "small", 11.8, 2), (11.5, "middle", 13.1, 3), (12.3, "middle", 13.9, 2), (13.0, "large", 16.5, 3)],
)
def test_sets_of_a_catalogue_settle_on_the_first_that_carries_itself(base, key, total, rounds):
    found = settle(from_ladder, base)
    assert (found.status, found.key, len(found.steps)) == ("settled", key, rounds)
    assert found.total == pytest.approx(total)
    assert key in {step.key for step in found.steps} and "Settled after" in found.words


@given(st.lists(st.tuples(st.floats(0.1, 4.0), st.floats(0.1, 4.0)), min_size=1, max_size=8), st.floats(1.0, 12.0))
def test_of_sets_that_weigh_more_the_more_they_carry_the_lightest_is_found(steps, base):
    """Second opinion by looking at each set: the lightest that carries base and itself, or none does."""
    carries, weighs, ladder = 0.0, 0.0, []
    for more, heavier in steps:
        carries, weighs = carries + more, weighs + heavier
        ladder.append((carries, weighs, len(ladder)))
    found = settle(lambda mass: from_ladder(mass, ladder), base)
    fitting = [name for can, own, name in ladder if base + own <= can]
    assert (found.key if found.carries_itself else None) == (fitting[0] if fitting else None)
    assert found.status == ("settled" if fitting else "none")


def test_two_sets_that_follow_each_other_leave_the_one_for_the_heavier_machine():
    """The cheapest for 20 kg weighs 3 kg, the cheapest for 23 kg weighs 2 kg: at 23 kg all is carried."""

    def cheapest(mass):
        return (3.0, "heavy and cheap") if mass <= 22.5 else (2.0, "light and strong")

    found = settle(cheapest, 20.0)
    assert (found.status, found.key, found.total) == ("cycle", "light and strong", 23.0)
    assert 20.0 + found.drive <= found.total  # it was sized for more than it makes
    assert "2 sets follow each other" in found.words and "1 kg" in found.words


@given(st.lists(st.floats(0.1, 6.0), min_size=2, max_size=9), st.integers(0, 2**32 - 1))
def test_whatever_is_taken_carries_itself(masses, seed):
    """Any table of masses, so any cycle: what is found was sized for no less than it makes."""

    def anything(mass):
        place = (seed + round(mass * 1000) * 7919) % len(masses)
        return masses[place], place

    found = settle(anything, 10.0, most=60)
    if found.carries_itself:
        assert 10.0 + found.drive <= found.total + GRAM
        assert anything(found.total) == (found.drive, found.key)


def test_no_set_that_carries_itself_is_said_plainly():
    nothing = settle(from_ladder, 14.0)
    assert nothing.status == "none" and not nothing.carries_itself and math.isnan(nothing.total)
    assert nothing.words == "No set carries itself: at 17.5 kg none is left."
    assert [step.key for step in nothing.steps] == ["middle", "large", None]
    runaway = settle(lambda mass: (1.3 * mass, "a"), 10.0, most=12)
    assert runaway.status == "none" and runaway.words.startswith("No set carries itself: each round adds")
    heavy = settle(lambda mass: (1.3 * mass, "a"), 10.0, limit=45.0)
    assert heavy.words == "No set carries itself within 45 kg: the next would make 61.87 kg."  # 10 (1.3^4 - 1) / 0.3
    assert settle(lambda mass: (1e9 * mass, "a"), 10.0).status == "none"
