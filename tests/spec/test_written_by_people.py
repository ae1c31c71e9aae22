"""Specs as people write them: grades, kinds of motor, patterns of families, dicts, a title block."""

import math

import pytest

from drivesizer import load_spec, size
from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.spec.drive import Select
from drivesizer.spec.robot import read_spec

CART = """
name: cart
load: {kind: wheeled_vehicle, mass: 30 kg, driven_wheels: 2, wheel_diameter: 150 mm, rolling_resistance: 2 %%,
  inertia: 0 kg*m^2, slope: %s}
motion: {speed: 0.5 m/s, acceleration_time: 1 s, cruise_time: 10 s}
supply: {nominal: 24 V, current: 20 A}
select: {catalogs: [maxon], gearhead: {family: GPX 22 HP}, %s}
"""


def cart(slope="0 deg", select="objective: mass"):
    return read_spec(YamlSource(CART % (slope, select), "robot.yaml"))


def test_a_slope_in_per_cent_is_rise_over_level_distance():
    """100 % is 45 degrees, 5 % 2.862 degrees (road signs: rise over horizontal distance)."""
    assert cart("100 %").load.slope == pytest.approx(math.pi / 4)
    assert math.degrees(cart("5 %").load.slope) == pytest.approx(2.8624, abs=1e-4)
    assert cart("-5 %").load.slope == -cart("5 %").load.slope
    with pytest.raises(InputError, match=r"robot.yaml:4: load.slope.*at most"):
        cart("200 %")  # 63 degrees, beyond 60
    with pytest.raises(InputError, match=r"load\.slope"):
        cart("5 %%x")


@pytest.fixture(scope="module")
def found():
    return {
        kind: size(cart(select=f"motor: {{kind: {kind}}}"), top=25).sets for kind in ("brushed", "brushless")
    }  # fmt: skip


def test_a_kind_of_motor_leaves_the_others_out(found):
    for kind, sets in found.items():
        assert sets and {one.motor.kind for one in sets} == {kind}
    with pytest.raises(InputError, match=r"select\.motor\.kind.*brushed"):
        cart(select="motor: {kind: brushles}")


def test_a_pattern_means_all_families_that_begin_so():
    sets = size(cart(select='motor: {family: "DCX 22*"}'), top=25).sets
    families = {one.motor.family for one in sets}
    assert len(families) > 1 and all(family.startswith("DCX 22") for family in families)
    with pytest.raises(InputError, match=r'robot.yaml:7: select.motor.family.*"XYZ\*" is in no catalogue'):
        size(cart(select='motor: {family: "XYZ*"}'))


def test_drives_of_unknown_price_come_last():
    """RE 25 has no price in any catalogue, A-max 26 have theirs of the shop."""
    families = {"motor": {"family": ["RE 25", "A-max 26"]}, "gearhead": {"family": ["GP 26 A", "GPX 26 HP"]}}
    sets = size(cart().model_copy(update={"select": Select(objective="price", **families)}), top=40).sets
    known = [one.price_of[:2] == ("motor", "gearhead") for one in sets]
    passes = [whole for one, whole in zip(sets, known, strict=True) if one.status == "pass"]
    assert passes == sorted(passes, reverse=True) and set(passes) == {True, False}
    assert {one.motor.family for one, whole in zip(sets, known, strict=True) if not whole} == {"RE 25"}
    prices = [one.price for one, whole in zip(sets, known, strict=True) if one.status == "pass" and whole]
    assert prices == sorted(prices)


def test_a_dict_is_the_same_spec_as_its_file(tmp_path):
    given = YamlSource(CART % ("2 deg", "objective: mass"), "robot.yaml").data
    shared = {**given, "cases": [{"name": "again", "load": given["load"]}]}  # an object at two places is no alias
    assert load_spec(given).model_dump() == cart("2 deg").model_dump()
    assert load_spec(shared).load_cases[1][1].load.slope == load_spec(given).load.slope
    with pytest.raises(InputError, match=r'^spec: load.mass: "30" has no unit'):
        load_spec({**given, "load": {**given["load"], "mass": 30}})
    with pytest.raises(InputError, match="expected text with a unit, a number, a list or a dict"):
        load_spec({**given, "load": {1, 2}} | {"name": tmp_path})


def test_a_title_block_is_text_of_one_line():
    text = (
        CART % ("0 deg", "objective: mass") + 'report: {customer: A & B, project: cart 7, author: me, revision: "2.1"}'
    )
    block = read_spec(YamlSource(text, "robot.yaml")).report
    assert (block.customer, block.project, block.author, block.revision) == ("A & B", "cart 7", "me", "2.1")
    assert cart().report.customer is None
