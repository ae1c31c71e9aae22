"""Drives that rank alike go by part number, and moments that are alike by their order, not by last digits."""

from __future__ import annotations

import numpy as np
from small_catalogue import CATALOGUE

from drivesizer.catalog import load
from drivesizer.files.yaml_source import YamlSource
from drivesizer.results.check_columns import at_most, worst_case
from drivesizer.search import ranking
from drivesizer.search.columns.candidates import Candidates
from drivesizer.sizing import size
from drivesizer.spec.robot import read_spec

SPEC = """\
name: tied
load: {kind: flywheel, inertia: 80 kg*m^2}
motion: {speed: 600 rpm, acceleration_time: 0.5 s, cruise_time: 1 s, rest_time: 1 s}
supply: {nominal: 24 V}
"""
ROW, OTHER = (next(line for line in CATALOGUE.splitlines() if f"[{part}," in line) for part in ("m1", "m2"))


def test_the_order_of_rows_does_not_choose_the_closest_rejected(tmp_path, monkeypatch):
    """Fifty motors alike: more than the search keeps of those that are equally far from passing."""
    monkeypatch.setattr("drivesizer.sizing.relaxations", lambda *_: ())
    monkeypatch.setattr("drivesizer.sizing.changes_for", lambda *_: ())
    rows = [ROW.replace("m1", f"p{number}") for number in range(10, 60)]
    closest = []
    for name, some in {"there": rows, "back": rows[::-1]}.items():
        path = tmp_path / f"{name}.yaml"
        path.write_text(CATALOGUE.replace(OTHER + "\n", "").replace(ROW, "\n".join(some)), encoding="utf-8")
        spec = read_spec(YamlSource(f"{SPEC}select: {{catalogs: [{path}]}}\n", str(tmp_path / "robot.yaml")))
        result = size(spec, catalog=load([str(path)]), top=3)
        assert not result.sets
        closest.append([(one.motor.part, one.gearhead.part) for one in result.misses])
    assert closest[0] == closest[1]
    assert closest[0][0][0] == "p10"


# -- last digits, which another processor gives


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
