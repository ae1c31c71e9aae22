"""Motions that repeat and do not come back: by the way that their trapezoid goes."""

from __future__ import annotations

import pytest

from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases.of_machine import starts_farther_on
from drivesizer.simulate import validate
from drivesizer.sizing import explained, size
from drivesizer.spec.robot import read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

ROTARY = "{speed: 90 deg/s, acceleration_time: 0.5 s, cruise_time: 0.5 s, rest_time: 1 s%s}"  # 22.5 + 45 + 22.5 deg
LINEAR = "{speed: 0.1 m/s, acceleration_time: 1 s, cruise_time: 2 s, rest_time: 1 s%s}"  # 50 + 200 + 50 mm
ARM = "{kind: arm, mass: 1 kg, length: 300 mm}"
HOIST = "{kind: hoist, mass: 10 kg, drum_diameter: 60 mm}"
TABLE = "{kind: rotary_table, inertia: 0.1 kg*m^2, mass: 2 kg, eccentricity: 30 mm, tilt: %s deg}"


def spec(load, motion, back=""):
    text = f"name: n\nload: {load}\nmotion: {motion % back}\nsupply: {{nominal: 24 V}}\nselect: {{catalogs: [maxon]}}\n"
    return read_spec(YamlSource(text, "robot.yaml"))


@pytest.mark.parametrize(("load", "motion", "way"), [
    pytest.param(ARM, ROTARY, "90", id="an arm that only rises"),
    pytest.param(HOIST, LINEAR, "300", id="a hoist that only lifts"),
    pytest.param(TABLE % 90, ROTARY, "90", id="a table that gravity pulls round"),
])  # fmt: skip
def test_a_motion_that_does_not_return_is_reported(load, motion, way):
    (said,) = starts_farther_on("", spec(load, motion))
    assert f" {way} " in said or f" {way}°" in said
    assert not starts_farther_on("", spec(load, motion, ", there_and_back: true"))


@pytest.mark.parametrize(("load", "motion"), [
    pytest.param(TABLE % 0, ROTARY, id="an indexing table"),
    pytest.param("{kind: flywheel, inertia: 0.1 kg*m^2}", ROTARY, id="a flywheel"),
    pytest.param(ARM, ROTARY.replace("cruise_time: 0.5 s", "cruise_time: 3.5 s"), id="an arm that turns once"),
])  # fmt: skip
def test_what_may_go_on_says_nothing(load, motion):
    assert not starts_farther_on("", spec(load, motion))


def test_it_is_among_the_warnings(catalog):
    result = size(spec(ARM, ROTARY), catalog=catalog, top=1)
    assert sum("ends 90" in said for said in result.warnings) == 1


def test_the_closed_loop_and_a_single_pair_are_warned_of_too(catalog):
    """What validates or explains one pair has the same motion; a profile that is asked for is somebody's test."""
    arm = spec(ARM, f"{ROTARY}\ncontrol: {{rate: 1 kHz}}")
    pair = explained(arm, "118752", "406764", catalog=catalog)
    proof, test = (validate(arm, pair.sets[0], profile=profile) for profile in (None, "trapezoid"))
    for found, times in ((pair, 1), (proof, 1), (test, 0)):
        assert sum("ends 90" in said for said in found.warnings) == times
