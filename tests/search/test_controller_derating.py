"""Controllers in a hot ambient: lines that maxon prints, what is not known, and drives that lose their controller."""

from dataclasses import asdict, replace
from math import nan

import numpy as np
import pytest

from drivesizer.catalog import load
from drivesizer.results.ratings import controller_current
from drivesizer.search.shortlist import load_parts
from drivesizer.sizing import size
from drivesizer.spec.robot import load_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

ZERO = 273.15
SPEC = {
    "name": "axis",
    "load": {"kind": "belt_axis", "mass": "6 kg", "pulley_diameter": "38.2 mm", "friction_force": "12 N"},
    "motion": {"profile": "triangle", "distance": "400 mm", "time": "0.8 s", "rest_time": "0.7 s",
               "there_and_back": True},
    "supply": {"nominal": "24 V", "accepts": "all"},
    "select": {"catalogs": ["maxon"], "motor": {"family": "DCX 22 L"}, "gearhead": {"family": "GPX 22 HP"},
               "controller": {"part": "367676"}, "estimates": "off"},
}  # fmt: skip


@pytest.fixture(scope="module")
def maxon():
    return load(("maxon",))


@pytest.mark.parametrize(
    ("part", "celsius", "ampere"),
    [
        ("367676", 25.0, 5.0), ("367676", 55.0, 5.0), ("367676", 69.0, 5.0 - 14.0 * 0.179), ("367676", 83.5, 0.0),
        ("347717", 45.0, 5.0), ("347717", 80.0, 0.0), ("375711", 65.0, 5.0), ("375711", 85.1, 0.0),
        ("546047", 65.0, 5.0),  # EPOS4 50/5, of which no line is known: as printed
    ],
)  # fmt: skip
def test_lines_that_maxon_prints(maxon, part, celsius, ampere):
    """EPOS2 24/5, 50/5 and 70/10: full current up to 55, 45 and 45 °C, then 0.179, 0.143 and 0.250 A/K less."""
    row = asdict(maxon.controllers.record(maxon.controllers.rows[part]))
    assert float(controller_current(row, ZERO + celsius)) == pytest.approx(ampere, abs=0.01)  # slopes have 3 digits


def test_a_hot_case_takes_what_the_controller_may_carry(maxon):
    """The demand against the derated current; too hot for the controller, nothing passes."""
    limits = {}
    for celsius in (40, 62):
        found = size(load_spec(SPEC | {"environment": {"ambient": f"{celsius} degC"}}), catalog=maxon)
        one = (*found.sets, *found.misses)[0]
        (check,) = (c for c in one.checks if c.name == "controller_continuous_current")
        limits[celsius] = check.limit
    assert limits == {40: 5.0, 62: pytest.approx(5.0 - 7.0 * 0.179)}
    beyond = size(load_spec(SPEC | {"environment": {"ambient": "84 degC"}}), catalog=maxon)
    assert beyond.counts.feasible == 0


def test_a_controller_is_chosen_for_the_hottest_case(maxon):
    """Of two controllers alike but for the derating the larger is taken where one load case is hot."""
    two = maxon.controllers.taken(np.full(2, maxon.controllers.rows["367676"]))
    small = replace(two, columns={**two.columns, "part": np.array(["small", "large"]),
                                  "continuous_current": np.array([4.9, 5.0]),
                                  "derating_slope": np.array([0.5, nan]),
                                  "full_current_ambient": np.array([ZERO + 40, nan])})  # fmt: skip
    catalog = replace(maxon, controllers=small)
    free = SPEC | {"select": {k: v for k, v in SPEC["select"].items() if k != "controller"}}
    hot = {"cases": [{"name": "hot", "environment": {"ambient": "49 degC"}}]}
    parts = []
    for more in ({}, hot):
        spec = load_spec(free | more)
        found = size(spec, catalog=load_parts(spec, catalog))
        parts.append((*found.sets, *found.misses)[0].controller.part)
    assert parts == ["small", "large"]
