"""A limit of the motor's current that is set in the controllers: of those that could give more, and of unknown ones."""

from dataclasses import replace

import numpy as np
import pytest

from drivesizer.catalog import load
from drivesizer.sizing import explain
from drivesizer.spec.robot import load_spec

LIFT = {
    "name": "lift", "load": {"kind": "hoist", "mass": "15 kg", "drum_diameter": "50 mm"},
    "motion": {"speed": "0.2 m/s", "acceleration_time": "0.3 s", "cruise_time": "1 s", "rest_time": "4 s"},
    "supply": {"nominal": "24 V"},
}  # fmt: skip


def check(limit=None, catalog=None):
    spec = load_spec(LIFT if limit is None else {**LIFT, "power_stage": {"motor_current": limit}})
    (drive,) = explain(spec, "118752", "406767", catalog=catalog)
    return next(one for one in drive.checks if one.name == "controller_peak_current")


def test_the_controllers_peak_is_what_it_is_set_to():
    free = check()
    assert free.status == "pass" and free.limit > 9.0
    assert check("9 A").limit == pytest.approx(9.0) and check("9 A").status == "pass"
    assert check("1000 A").limit == free.limit
    tight = check("1 A")
    assert (tight.status, tight.limit) == ("fail", pytest.approx(1.0))


def test_of_a_controller_of_unknown_peak_it_is_the_most():
    whole = load(["maxon"])
    unknown = dict(whole.controllers.columns) | {"peak_current": np.full(len(whole.controllers), np.nan)}
    whole = replace(whole, controllers=replace(whole.controllers, columns=unknown))
    assert check("9 A", whole).status == "unknown"
    assert check("1 A", whole).status == "fail"
