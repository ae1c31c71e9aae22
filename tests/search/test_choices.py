"""Drives to choose from by weights: among them is the best of all that pass, whatever the weights.

The forty motors are worked out by hand: the lighter they are the more they lose (see ``test_drives_within_budgets``).
"""

import math

import numpy as np
import pytest
from forty_motors import MOTORS, catalogue
from starters import starter

from drivesizer.files.yaml_source import YamlSource
from drivesizer.results.sizing import used_share, weighted_order
from drivesizer.search import ranking
from drivesizer.search.choices import choices
from drivesizer.search.columns.evaluation import smallest_margin
from drivesizer.search.search import search
from drivesizer.search.shortlist import load_parts, problem_with_drive_mass
from drivesizer.sizing import size
from drivesizer.spec.robot import read_spec

NAMES = ("mass", "price", "energy", "margin")
SPEC = """
name: fan
motion: {speed: 1200 rpm, acceleration_time: 10 s, cruise_time: 100000 s}
supply: {nominal: 24 V, min: 22 V, max: 26 V}
select:
  catalogs: [parts.yaml]
  estimates: off
  objective: [{objective: mass, weight: 1}, {objective: energy, weight: 4}]
load: {kind: fan, inertia: 20 kg*cm^2, rated_torque: 0.3 N*m, rated_speed: 1500 rpm}
"""
BATTERY = """
battery: {chemistry: LiFePO4, nominal_voltage: 24 V, capacity: 20 A*h, autonomy: 9 h, charge_voltage: 26 V,
  cutoff_voltage: 20 V, resistance: 10 mohm, open_circuit: {full: 24.5 V, empty: 23 V}, continuous_current: 20 A,
  peak_current: 50 A, max_charge_current: 5 A}
"""


def power(n):
    """What a motor draws at 1200 rpm with a winding that stays at 25 degC [W]."""
    current = 0.3 * (1200 / 1500) ** 2 / 0.098 + 3.0 - 0.07 * n
    return (0.35 * current + 0.098 * 1200 * math.pi / 30) * current


def fan(folder, more=""):
    (folder / "parts.yaml").write_text(catalogue(lambda n: 3.0 - 0.07 * n, "0.001 K/W"), encoding="utf-8")
    return read_spec(YamlSource(SPEC + more, str(folder / "fan.yaml")))


def numbers(found):
    return [int(one.parts.motor.part[1:]) for one in found.drives]


def test_forty_motors_by_hand(tmp_path):
    found = size(fan(tmp_path), choices=100)
    chosen, every = found.choices, range(MOTORS)
    assert sorted(numbers(chosen)) == [*every] and chosen.passing == MOTORS and not chosen.judged
    assert chosen.weights == {"mass": 1.0, "energy": 4.0}
    assert [*chosen.drives[0].figures] == ["mass", "energy", "price", "margin"]
    energies = np.array([one.figures["energy"] for one in chosen.drives])
    assert energies == pytest.approx([power(n) * 100_010 for n in numbers(chosen)], rel=1e-3)
    for mass, energy in ((1.0, 4.0), (3.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)):
        scores = [mass * (300 + n) / 300 + energy * power(n) / power(MOTORS - 1) for n in every]
        columns = {name: np.array([one.figures[name] for one in chosen.drives]) for name in ("mass", "energy")}
        first = numbers(chosen)[weighted_order(columns, {"mass": mass, "energy": energy}).order[0]]
        assert first == min(every, key=scores.__getitem__)
        if (mass, energy) == (1.0, 4.0):  # the spec's own
            assert first == numbers(chosen)[chosen.first] == int(found.sets[0].motor.part[1:])


def test_a_drive_that_the_machine_cannot_feed_is_none_to_choose(tmp_path):
    """A battery of 480 W h that is to last for 9 h: the sixteen lightest draw too much."""
    found = size(fan(tmp_path, BATTERY), choices=100, objective="mass")
    enough = [n for n in range(MOTORS) if 480 / power(n) >= 9]
    assert set(numbers(found.choices)) <= {*enough} and len(found.choices.drives) >= 10
    assert found.choices.judged and numbers(found.choices)[found.choices.first] == enough[0] == 16
    assert MOTORS - 1 in numbers(found.choices)  # the one that draws least


@pytest.fixture(scope="module")
def belt_axis(tmp_path_factory, catalog):
    """A belt axis, all drives that pass with all their figures, and those to choose from."""
    spec = starter("belt_axis", tmp_path_factory.mktemp("belt"))
    problem, _ = problem_with_drive_mass(spec, load_parts(spec, catalog))
    every = search(problem, top=5, margins=True)
    certainty = every.in_order.drives.certainty
    whole = every.in_order.at(np.flatnonzero(certainty == certainty[every.best[0]]))
    parts = ranking.part_rows(whole, needs_encoder=True)
    figures = {**whole.figures, "margin": smallest_margin(whole.checks), **parts}
    columns = {}
    for name in NAMES:
        value, lacking = ranking.single(whole.catalog, whole.candidates, figures, name)
        columns[name] = np.where(lacking > 0, np.nan, used_share(-value) if name == "margin" else value)
    return problem, every, whole, columns


def chosen(problem, every):
    return choices(problem, every, 60)


def key(parts):
    return parts.motor.part, parts.gearhead.part, parts.belt_ratio


def places(whole, found):
    """Which of all drives are among those to choose from, and the choice of each of these."""
    table, sets = whole.catalog, whole.candidates
    names = zip(table.motors["part"][sets.motor], table.gearheads["part"][sets.gearhead], sets.belt, strict=True)
    given = {key(one.parts): one for one in found.drives}
    return {place: given[name] for place, name in enumerate(names) if name in given}


def test_the_best_of_all_that_pass_is_among_them(belt_axis):
    problem, every, whole, columns = belt_axis
    found = chosen(problem, every)
    assert found.whole and found.passing == len(whole.controller) > 3 * len(found.drives)
    among = places(whole, found)
    assert len(among) == len(found.drives)
    for place, one in among.items():  # with the figures that they have among all
        figures = one.figures | {"margin": used_share(one.figures["margin"])}
        for name in NAMES:
            assert figures[name] == pytest.approx(columns[name][place], rel=1e-9, nan_ok=True)
    for weights in np.random.default_rng(5).dirichlet(np.full(4, 0.7), 300):
        assert weighted_order(columns, dict(zip(NAMES, weights, strict=True))).order[0] in among


@pytest.mark.parametrize("text", ["mass=2,price=1", "price=1,energy=3", "mass=1,price=1,energy=1,margin=4"])
def test_the_search_ranks_by_weights_as_the_page_does(belt_axis, text):
    """Controllers are chosen by the weights, too: no drive with the lightest of them is better."""
    problem, every, _, _ = belt_axis
    ranked = problem.ranked_by(ranking.objective_of(text))
    result = search(ranked, top=1, margins=True)
    found, by_mass = chosen(ranked, result), chosen(problem, every)
    drives = [*found.drives, *by_mass.drives]
    columns = {name: np.array([one.figures[name] for one in drives]) for name in NAMES}
    columns["margin"] = used_share(columns["margin"])
    scored = weighted_order(columns, found.weights)
    assert scored.score[found.first] == pytest.approx(scored.score[scored.order[0]], rel=1e-9)
    first = result.evaluation.candidates
    assert key(found.drives[found.first].parts) == (
        problem.catalog.motors["part"][first.motor[0]], problem.catalog.gearheads["part"][first.gearhead[0]],
        first.belt[0],
    )  # fmt: skip


def test_none_is_given_where_none_is_wanted_or_passes(result, tmp_path):
    assert result.choices is None
    found = size(fan(tmp_path, BATTERY.replace("9 h", "17 h")), choices=20)
    assert not found.sets and found.choices is None
