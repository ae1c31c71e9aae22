"""Controllers that carry less where it is hot, whose maker limits the power too, or that are set to a lower current."""

from __future__ import annotations

from dataclasses import asdict, replace
from math import nan
from pathlib import Path

import numpy as np
import pytest
import yaml

from drivesizer.catalog import load
from drivesizer.results.ratings import controller_current, controller_power_limit
from drivesizer.search.shortlist import load_parts
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import load_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")


# -- in a hot ambient


ZERO = 273.15
AXIS = {
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
        found = size(load_spec(AXIS | {"environment": {"ambient": f"{celsius} degC"}}), catalog=maxon)
        one = (*found.sets, *found.misses)[0]
        (check,) = (c for c in one.checks if c.name == "controller_continuous_current")
        limits[celsius] = check.limit
    assert limits == {40: 5.0, 62: pytest.approx(5.0 - 7.0 * 0.179)}
    beyond = size(load_spec(AXIS | {"environment": {"ambient": "84 degC"}}), catalog=maxon)
    assert beyond.counts.feasible == 0


def test_a_controller_is_chosen_for_the_hottest_case(maxon):
    """Of two controllers alike but for the derating the larger is taken where one load case is hot."""
    two = maxon.controllers.at_rows(np.full(2, maxon.controllers.rows["367676"]))
    small = replace(two, columns={**two.columns, "part": np.array(["small", "large"]),
                                  "continuous_current": np.array([4.9, 5.0]),
                                  "derating_slope": np.array([0.5, nan]),
                                  "full_current_ambient": np.array([ZERO + 40, nan])})  # fmt: skip
    catalog = replace(maxon, controllers=small)
    free = AXIS | {"select": {k: v for k, v in AXIS["select"].items() if k != "controller"}}
    hot = {"cases": [{"name": "hot", "environment": {"ambient": "49 degC"}}]}
    parts = []
    for more in ({}, hot):
        spec = load_spec(free | more)
        found = size(spec, catalog=load_parts(spec, catalog))
        parts.append((*found.sets, *found.misses)[0].controller.part)
    assert parts == ["small", "large"]


# -- power, less at a high supply voltage


X1 = {
    "max_power": 1300.0,
    "max_power_voltage": 36.0,
    "reduced_power": float("nan"),
    "reduced_power_voltage": float("nan"),
}
CATALOG = Path(__file__).with_name("controllers.yaml").read_text(encoding="utf-8")
DISC = {
    "name": "disc", "load": {"kind": "rotary_table", "inertia": "0.01 kg*m^2", "torque": "0.9 N*m"},
    "transmission": [{"kind": "direct"}],
    "motion": {"speed": "1500 rpm", "acceleration_time": "1 s", "cruise_time": "4 s", "rest_time": "1 s"},
}  # fmt: skip


@pytest.mark.parametrize(
    ("volts", "watts"), [(24.0, 900.0), (30.0, 900.0), (34.0, 650.0), (38.0, 400.0), (44.0, 400.0)]
)
def test_the_power_falls_in_a_straight_line(volts, watts):
    """moteus r4.11 by its hardware reference; by hand halfway between 30 and 38 V."""
    r4 = {"max_power": 900.0, "max_power_voltage": 30.0, "reduced_power": 400.0, "reduced_power_voltage": 38.0}
    assert controller_power_limit(600.0, r4, volts).limit == pytest.approx(watts)


@pytest.mark.parametrize(("watts", "status"), [(1200.0, "unknown"), (1400.0, "fail")])
def test_what_is_printed_for_a_lower_voltage_is_the_most(watts, status):
    assert controller_power_limit(watts, X1, 48.0).at((), "physics").status == status
    assert controller_power_limit(watts, X1, 36.0).at((), "physics").status == ("pass" if watts < 1300 else "fail")


@pytest.mark.parametrize(("volts", "status"), [(28.0, "pass"), (44.0, "fail")])
def test_a_drive_is_judged_by_its_power(tmp_path, volts, status):
    """0.01 kg m^2 in 1 s to 1500 rpm against 0.9 N*m: 2.50 N*m, 50 A; 393 W, 25 W of cold copper, 25 W of the stage."""
    (tmp_path / "own.yaml").write_text(CATALOG, encoding="utf-8")
    checks = {}
    for part in ("limited", "free"):
        spec = DISC | {"supply": {"nominal": f"{volts} V"}}
        spec |= {"select": {"catalogs": ["own.yaml"], "controller": {"part": [part]}}}
        (tmp_path / "robot.yaml").write_text(yaml.safe_dump(spec), encoding="utf-8")
        (found,) = explain(load_spec(tmp_path / "robot.yaml"), "M1", "direct")
        checks[part] = {check.name: check for check in found.checks}
    assert checks["limited"]["controller_power"].status == status
    assert checks["limited"]["controller_power"].demand == pytest.approx(445.0, rel=0.03)  # the winding warms
    assert "controller_power" not in checks["free"]


# -- the motor's current as it is set in controllers that could give more, and in unknown ones


LIFT = {
    "name": "lift", "load": {"kind": "hoist", "mass": "15 kg", "drum_diameter": "50 mm"},
    "motion": {"speed": "0.2 m/s", "acceleration_time": "0.3 s", "cruise_time": "1 s", "rest_time": "4 s"},
    "supply": {"nominal": "24 V"},
}  # fmt: skip


def peak_current(limit=None, catalog=None):
    spec = load_spec(LIFT if limit is None else {**LIFT, "power_stage": {"motor_current": limit}})
    (drive,) = explain(spec, "118752", "406767", catalog=catalog)
    return next(one for one in drive.checks if one.name == "controller_peak_current")


def test_the_controllers_peak_is_what_it_is_set_to():
    free = peak_current()
    assert free.status == "pass" and free.limit > 9.0
    assert peak_current("9 A").limit == pytest.approx(9.0) and peak_current("9 A").status == "pass"
    assert peak_current("1000 A").limit == free.limit
    tight = peak_current("1 A")
    assert (tight.status, tight.limit) == ("fail", pytest.approx(1.0))


def test_of_a_controller_of_unknown_peak_it_is_the_most():
    whole = load(["maxon"])
    unknown = dict(whole.controllers.columns) | {"peak_current": np.full(len(whole.controllers), np.nan)}
    whole = replace(whole, controllers=replace(whole.controllers, columns=unknown))
    assert peak_current("9 A", whole).status == "unknown"
    assert peak_current("1 A", whole).status == "fail"
