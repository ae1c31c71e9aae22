"""Drives that robots really have are said to pass, or to be open, and stand among the first of their makers."""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

from drivesizer.catalog import load
from drivesizer.catalog.view import search_view
from drivesizer.files.yaml_source import YamlSource
from drivesizer.results.ratings import nominal_current_limit
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import read_spec

ROBOTS = yaml.safe_load(Path(__file__).with_name("real_drives.yaml").read_text(encoding="utf-8"))


def read(name):
    maker, part, gearhead = ROBOTS[name]["drive"]
    spec = {"name": name, **ROBOTS[name], "select": {"catalogs": [maker], "objective": "mass"}}
    del spec["drive"]
    return read_spec(YamlSource(json.dumps(spec), "robot.yaml")), part, gearhead


@pytest.mark.parametrize("name", ROBOTS)
def test_the_drive_that_the_robot_has_is_among_its_makers_first(name):
    spec, part, gearhead = read(name)
    (one,) = explain(spec, part, gearhead)
    assert one.status in ("pass", "open"), [(c.name, c.status) for c in one.own_checks if c.status != "pass"]
    assert part in [drive.motor.part for drive in size(spec, top=10, detail="drives").sets]


def test_lighter_drives_that_missing_figures_hold_back_are_named():
    """An elbow of 1.5 N*m that the robot turns with an XM430-W350; its maker prints no continuous torque of it."""
    spec = read_spec(YamlSource("""name: elbow
load: {kind: arm, mass: 450 g, length: 350 mm}
motion: {profile: segments, segments: [{time: 1 s, to: 60 deg/s}, {time: 0.5 s}, {time: 1 s, to: 0 deg/s}, {time: 2 s}]}
transmission: [{kind: gearhead}]
supply: {nominal: 12 V, current: 10 A, accepts: all}
select: {catalogs: [robotis], objective: mass}
""", "robot.yaml"))  # fmt: skip
    found = size(spec, top=3)
    (note,) = [line for line in found.warnings if "would be the first" in line]
    better, others = note.split("; so would ")
    assert all(drive.status == "pass" and drive.mass > 0.082 for drive in found.sets)
    assert better.count("against") == 1 and "XM430-W350 12 V (353.5:1 inside) with 82 g" in others


def test_an_estimated_no_load_current_leaves_the_printed_points():
    """An XL430 at 12 V: 61 rpm without load, 1.5 N*m at 1.4 A of stall, behind 258.5:1."""
    view = search_view(load(["robotis"]))
    for catalog in (view, *view.ends):
        row = catalog.motors.rows["XL430-W250-T 12 V"]
        motor = {name: column[row] for name, column in catalog.motors.columns.items()}
        gear = catalog.gearheads.record(catalog.gearheads.rows["XL430-W250-T 12 V"])
        free = (12.0 - motor["no_load_current"] * motor["resistance"]) / motor["torque_constant"]
        assert free / 258.5 * 60 / (2 * np.pi) == pytest.approx(61.0, rel=0.02)
        dry = 0.45 * motor["no_load_current"]
        stall = 258.5 * gear.efficiency * motor["torque_constant"] * (1.4 - dry)
        assert 1.47 < stall < (1.65 if catalog is view else 2.3)  # a spur gear loses a tenth in each of four pairs
    currents = [catalog.motors["no_load_current"][catalog.motors.rows["XL430-W250-T 12 V"]] for catalog in view.ends]
    assert currents[0] < currents[1]


def test_a_rating_counts_once():
    """Without a nominal current the nominal torque is the rating, else the permitted winding temperature."""
    nan = np.nan
    motor = {"nominal_current": np.array([2.0, nan, nan, nan]), "nominal_torque": np.array([nan, 0.3, nan, nan]),
             "max_winding_temperature": np.array([400.0, nan, 400.0, nan]), "rated_ambient": np.full(4, nan),
             "data_temperature": np.full(4, nan), "mounted_gain": np.full(4, nan)}  # fmt: skip
    found = nominal_current_limit(np.full(4, 1.7), motor, 298.15)
    assert found.limit == pytest.approx([2.0, np.inf, np.inf, nan], nan_ok=True)
    assert found.passed.tolist() == [True, True, True, False]
