"""Screws out of the catalogues: the smallest of each lead, the best lead, the same drive as with the screw typed."""

import math

import pytest
from refusals import refusal

from drivesizer.catalog import load
from drivesizer.errors import InputError
from drivesizer.load_cases import load_cycle
from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.results.problem import with_screw
from drivesizer.search import screw_choice
from drivesizer.search.columns.limits import load_limits
from drivesizer.search.screw_choice import problem_with_screw
from drivesizer.search.shortlist import load_parts
from drivesizer.search.uncertainty.uncertain_figures import applied
from drivesizer.sizing import size
from drivesizer.spec.robot import load_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

LOAD = {
    "kind": "ball_screw", "mass": "20 kg", "incline": "90 deg", "friction_force": "20 N", "length": "420 mm",
    "screw_length": "520 mm", "ends": "fixed-supported",
}  # fmt: skip
MOTION = {
    "speed": "0.9 m/s", "acceleration_time": "0.1667 s", "cruise_time": "0.1667 s", "rest_time": "1 s",
    "there_and_back": True,
}  # fmt: skip


def spec_of(load, **sections):
    given = {
        "name": "x", "load": load, "motion": MOTION, "supply": {"nominal": "48 V", "accepts": "all"},
        "needs": {"life": "20000 h"}, "select": {"catalogs": ["maxon", "thk", "hiwin"]},
    }  # fmt: skip
    return load_spec(given | sections)


@pytest.fixture(scope="module")
def catalog():
    return load_parts(spec_of(LOAD | {"screw": {}}), load(["maxon", "thk", "hiwin"]))


def typed(screw, **changes):
    """The load with the figures of a screw of a catalogue as a user types them."""
    texts = {
        name: f"{getattr(screw, name)!r} {unit}"
        for names, unit in (
            (("lead", "diameter", "root_diameter", "ball_diameter"), "m"), (("dynamic_load", "static_load"), "N"),
        )
        for name in names
        if not math.isnan(getattr(screw, name))
    }  # fmt: skip
    across = screw.diameter if math.isnan(screw.shaft_diameter) else screw.shaft_diameter
    inertia = math.pi / 32 * 7850 * across**4 * 0.52
    back = {} if math.isnan(screw.back_efficiency) else {"back_efficiency": screw.back_efficiency}
    return LOAD | texts | back | {
        "dn_max": screw.dn_max, "efficiency": screw.efficiency, "inertia": f"{inertia!r} kg*m^2",
        "design": {"THK": "THK", "HIWIN": "HIWIN"}[screw.manufacturer],
    } | changes  # fmt: skip


def holds(screw):
    """Whether a typed screw passes all of its own checks, on the whole load cycle."""
    spec = spec_of(typed(screw))
    checks = load_limits(spec, CycleAtBelt(load_cycle(spec), 1.0).behind(1.0))
    assert len(checks) == 5
    return all(check.passed.all() for check in checks)


def test_the_screw_of_each_lead_is_the_smallest_that_holds(catalog):
    """Against all screws of a maker from 12 mm of lead, each typed into a spec and through the whole load cycle."""
    spec = spec_of(LOAD | {"screw": {"maker": "hiwin", "lead_min": "12 mm"}})
    screws, failed = screw_choice._smallest_by_lead(spec, catalog)
    found = {one.lead: one for one in screws} | dict.fromkeys(failed)
    table = catalog.screws
    rows = [row for row, maker in enumerate(table["manufacturer"]) if maker == "HIWIN" and table["lead"][row] > 0.011]
    every = [table.record(row) for row in rows]
    assert set(found) == {one.lead for one in every}
    for lead, screw in found.items():
        good = [one for one in every if one.lead == lead and holds(one)]
        assert (screw is None) == (not good)
        if screw is not None:
            assert screw.diameter == min(one.diameter for one in good)
            assert screw.part in {one.part for one in good}


@pytest.fixture(scope="module")
def wide():
    """Three leads that maxon's motors can drive, by mass of motor, gearhead and screw."""
    return spec_of(LOAD | {"screw": {"maker": ["THK", "HIWIN"], "lead_min": "30 mm", "lead_max": "50 mm"}})


@pytest.fixture(scope="module")
def found(wide, catalog):
    return size(wide, catalog=catalog)


def test_each_lead_has_its_screw_or_the_limit_that_it_fails(found):
    tried, chosen = found.problem.screw.tried, found.sets[0].chosen_screw.screw
    assert [one.lead for one in tried] == sorted({one.lead for one in tried}) and len(tried) >= 3
    assert all(bool(one.screw) != bool(one.failed) for one in tried)
    (own,) = (one for one in tried if one.lead == chosen.lead)
    assert own.screw == f"{chosen.manufacturer} {chosen.part}" and found.sets[0].motor.part in own.drive


def test_the_drives_are_those_of_the_same_screw_typed(catalog, found):
    chosen = found.sets[0].chosen_screw
    plain = size(spec_of(typed(chosen.screw)), catalog=catalog)
    assert [one.label for one in found.sets] == [one.label for one in plain.sets]
    for one, other in zip(found.sets, plain.sets, strict=True):
        for ours, theirs in zip(one.checks, other.checks, strict=True):
            assert ours.name == theirs.name
            assert (ours.demand, ours.limit) == pytest.approx((theirs.demand, theirs.limit), rel=1e-9, nan_ok=True)


def test_the_inertia_of_a_coupling_is_added_and_may_be_off(catalog):
    """A coupling by its dimensions beside a screw of a catalogue; one of them 2 mm larger, as a sample has it."""
    coupling = {"shape": "cylinder", "diameter": "40 mm +- 2 mm", "length": "50 mm", "material": "aluminium"}
    spec = spec_of(LOAD | {"screw": {"part": "WTF 2040-2"}, "inertia": coupling})
    screw = catalog.screws.record(catalog.screws.rows["WTF 2040-2"])
    chosen = with_screw(spec, screw)
    shaft = math.pi / 32 * 7850 * 0.02**4 * 0.52
    assert chosen.load.turning == pytest.approx(spec.load.inertia + shaft)
    (path,) = (one.path for one in spec.toleranced)
    larger = applied(chosen, {path: 2e-3})
    assert larger.load.turning == pytest.approx(spec.load.inertia * (42 / 40) ** 4 + shaft)


def test_a_sliding_screw_takes_the_friction_of_the_spec(catalog):
    slow = {"speed": "20 mm/s", "acceleration_time": "0.2 s", "cruise_time": "5 s", "there_and_back": True}
    load = LOAD | {"kind": "lead_screw", "thread_friction": 0.15, "screw": {"maker": "THK"}}
    problem, _ = problem_with_screw(spec_of(load, motion=slow), catalog)
    screw = problem.screw.screw
    assert screw.kind == "trapezoidal"
    slope, friction = math.atan(screw.lead / (math.pi * screw.pitch_diameter)), math.atan(0.15 / math.cos(math.pi / 12))
    assert problem.spec.load.efficiencies[0] == pytest.approx(math.tan(slope) / math.tan(slope + friction))
    checks = {check.name: check for check in load_limits(problem.spec, problem.cases[0].at_belt.behind(1.0))}
    assert checks["screw_thrust"].passed.all()
    life = checks["screw_life"]
    assert not life.passed.any() and not life.failed.any()  # nothing is printed of its wear


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            {"screw": {"maker": "Nobody"}},
            "load.screw: no such screw in the catalogues that the spec names; they list 752",
        ),
        ({"screw": {"diameter_max": "6 mm"}}, "load.screw: no screw holds: the leads 1 mm (critical speed)"),
        ({"screw": {"lead_min": "9 mm", "lead_max": "4 mm"}}, "expected lead_min <= lead_max"),
        ({"screw": {}, "lead": "5 mm"}, "give lead or screw, exactly one of them; both are given"),
        ({"screw": {}, "static_load": "5 kN"}, "expected screw without static_load"),
        ({"screw": {}, "ends": None}, "give length and ends beside screw"),
        ({"screw": {}, "length": "250 mm"}, "load.length: 250 mm is shorter than the stroke"),
        ({}, "give lead or screw, exactly one of them; neither is given"),
    ],
)
def test_what_cannot_be_chosen_is_said_in_a_line(change, words, catalog):
    fields = {name: value for name, value in (LOAD | change).items() if value is not None}
    assert words in refusal(lambda: size(spec_of(fields), catalog=catalog))


def test_no_catalogue_with_screws_and_no_screw_yet():
    open_ = LOAD | {"screw": {}}
    with pytest.raises(InputError, match=r"they list none: select\.catalogs needs some"):
        size(spec_of(open_, select={"catalogs": ["yuasa"]}))
    with pytest.raises(InputError, match=r"load\.screw: a screw out of the catalogues is chosen by"):
        load_cycle(spec_of(open_))
