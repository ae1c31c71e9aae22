"""Checks of mass, room, footing and grip: the paper's robot by hand, what is unknown, and that each can fail."""

import math
from dataclasses import replace
from math import nan

import numpy as np
import pytest
from platform_specs import DOOR, section, vehicle
from platforms import MASS
from refusals import refusal
from trajectories import joined, piece, straight

from drivesizer import size
from drivesizer.errors import InputError
from drivesizer.load_cases.of_machine import requirement_checks
from drivesizer.load_cases.platform import platform_of
from drivesizer.machine.budgets import drive_rows, machine_mass
from drivesizer.machine.platform_budget import (
    PlatformOnFloor,
    envelope_checks,
    grip_checks,
    platform_checks,
    worst_case_budget,
)
from drivesizer.machine.platform_budget import stability_checks as footing
from drivesizer.platform.dynamics import dynamics
from drivesizer.results.drive_set import MassRow
from drivesizer.sizing import explain
from drivesizer.spec.platform import Budget
from drivesizer.spec.robot import load_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

G = 9.80665
LOW = {"height": "90 mm"}


@pytest.fixture(scope="module")
def drive(spec):
    found = size(spec).sets[0]
    return replace(
        found,
        encoder=replace(found.encoder, mass=0.010),
        controller=replace(found.controller, mass=0.080),
        belt_ratio=1.0,
    )


def of(checks):
    return {check.name: check for check in checks}


def standing(load=None, trajectory=None, needed=0.0, **given):
    found, moved = section(**({"centre_of_mass": LOW} | given)), vehicle(**(load or {}))
    return PlatformOnFloor(found, moved, dynamics(platform_of(found, moved)), G, needed, trajectory)


# --- mass -------------------------------------------------------------------------------------------------------------


def budget(**given):
    return Budget.model_validate({"mass": "45 kg", "structure": "20 kg"} | given)


def test_mass_against_its_limit(drive):
    """4 (130 + 77 + 10 + 80) g, 20 kg, 10.8 kg and 3 cameras of 120 g: 32.348 kg of 45 kg."""
    camera = {"name": "camera", "mass": "120 g", "number": 3}
    found = machine_mass(budget(others=[camera]), drive_rows(drive, 4), battery=10.8)
    check = of(found.checks(40.0))
    assert check["mass"].demand == pytest.approx(32.348)
    assert check["mass"].margin == pytest.approx(45.0 / 32.348 - 1.0)
    assert {c.status for c in check.values()} == {"pass"}
    assert "3 x camera" in [row.name for row in found.rows]
    assert of(found.checks(32.0))["mass_sized_for"].status == "fail"
    heavy = machine_mass(budget(structure="34 kg"), drive_rows(drive, 4), battery=10.8)
    assert of(heavy.checks())["mass"].status == "fail"


def test_an_unknown_mass_may_fail_but_not_pass(drive):
    unknown = machine_mass(budget(), drive_rows(replace(drive, encoder=None), 4), battery=nan)
    check = of(unknown.checks(45.0))["mass"]
    assert (check.status, check.note) == ("unknown", "unknown: encoder, battery")
    heavy = machine_mass(budget(structure="46 kg"), drive_rows(replace(drive, encoder=None), 4))
    check = of(heavy.checks())["mass"]
    assert (check.status, check.note) == ("fail", "")
    assert machine_mass(Budget(), drive_rows(drive, 4)).checks() == ()  # nothing is asked


def test_an_estimated_mass_leaves_a_check_open_where_its_band_meets_the_limit():
    """4 x 20 g and 4 x 90 g, log-normal; the probability against 100 000 samples."""
    parts = (MassRow(name="encoder", each=0.02, number=4, band=(0.005, 0.08)),
             MassRow(name="controller", each=0.09, number=4, band=(0.018, 0.45)))  # fmt: skip

    def weighed(limit):
        return of(machine_mass(budget(structure="20 kg", mass=limit), parts).checks())["mass"]

    assert [weighed(limit).status for limit in ("20.05 kg", "20.6 kg", "22.2 kg")] == ["fail", "open", "pass"]
    found = weighed("20.6 kg")
    assert found.band.low == pytest.approx(20.092) and found.band.high == pytest.approx(22.12)
    assert "encoder, controller, which are estimated, have at most 0.6 kg together" in found.note
    spread = np.array([math.log(4.0), math.log(5.0)]) / 1.6448536
    sampled = np.exp(np.log([0.08, 0.36]) + spread * np.random.default_rng(1).normal(size=(100_000, 2))).sum(axis=1)
    assert found.probability == pytest.approx(np.mean(sampled <= 0.6), abs=0.03)
    wide = weighed("21.5 kg")
    assert wide.probability == pytest.approx(np.mean(sampled <= 1.5), abs=0.03)


# --- room -------------------------------------------------------------------------------------------------------------


def test_the_papers_robot_through_the_papers_door():
    door = DOOR | {"height": "200 mm"}
    check = of(envelope_checks(section(passages=[door])))
    assert check["passage_width"].margin == pytest.approx(400.0 / 350.0 - 1.0)
    assert check["passage_height"].margin == pytest.approx(200.0 / 184.0 - 1.0)
    assert {c.case for c in check.values()} == {"door"}
    for changed, failing in (
        ({"heading_error": "4.2 deg"}, "passage_width"), ({"aside": "26 mm"}, "passage_width"),
        ({"width": "349 mm"}, "passage_width"), ({"height": "183 mm"}, "passage_height"),
    ):  # fmt: skip
        assert of(envelope_checks(section(passages=[door | changed])))[failing].status == "fail"
    fine = of(envelope_checks(section(passages=[door | {"heading_error": "4.1 deg"}])))
    assert fine["passage_width"].status == "pass"


def test_turning_and_corners():
    """The diagonal is 788.9 mm; two alike corridors of 510 mm leave 510 √2 − 707 / 2 = 367.7 mm at the corner."""
    for width, turning in (("800 mm", "pass"), ("780 mm", "fail")):
        check = of(envelope_checks(section(passages=[DOOR | {"width": width, "turns": True}])))
        assert check["passage_turning"].status == turning
        assert check["passage_turning"].demand == pytest.approx(0.7889, abs=5e-5)
    for corner, status in (("510 mm", "pass"), ("480 mm", "fail")):
        check = of(envelope_checks(section(passages=[DOOR | {"width": "510 mm", "corner": corner}])))
        assert check["passage_corner"].status == status
    wide = of(envelope_checks(section(passages=[DOOR | {"width": "510 mm", "corner": "510 mm"}])))
    assert wide["passage_corner"].limit == pytest.approx(0.3677, abs=5e-5)


def test_clearance_along_a_trajectory():
    placed = DOOR | {"x": "0 m", "y": "0 m", "depth": "100 mm"}
    away = DOOR | {"name": "far", "x": "0 m", "y": "9 m"}
    found = section(passages=[placed, away, DOOR | {"name": "anywhere"}])
    for aside, status in ((0.01, "pass"), (0.03, "fail")):
        checks = envelope_checks(found, straight((-2.0, aside), (2.0, aside), 0.0, 8.0))
        near, far = (c for c in checks if c.name == "passage_clearance")
        assert (near.case, near.status) == ("door", status)
        assert near.demand == pytest.approx(0.350 + 2 * aside)
        assert near.at_time is not None and "left jamb" in near.note
        assert (far.case, far.status, far.at_time) == ("far", "unknown", None)
    assert [c for c in envelope_checks(found) if c.name == "passage_clearance"] == []


# --- footing ----------------------------------------------------------------------------------------------------------


def test_braking_and_slope_against_the_tipping_laws():
    """Half track 134.95 mm, 90 mm high: the worst direction lifts a corner at g / (4 h √(1 / 2B² + 1 / 2T²))."""
    worst = G / 4 / (0.090 * math.hypot(1 / 0.95412, 1 / 0.5398))
    check = of(footing(standing(limits={"acceleration": "1.2 m/s^2"})))
    assert check["lift_off"].limit == pytest.approx(worst)
    assert check["lift_off"].demand == pytest.approx(1.2)
    assert check["tipping"].limit == pytest.approx(G * 0.13495 / 0.090)
    assert {c.status for c in check.values()} == {"pass"}
    tall = of(footing(standing(limits={"acceleration": "1.2 m/s^2"}, centre_of_mass={"height": "1.2 m"})))
    assert tall["lift_off"].status == "fail" and tall["tipping"].status == "fail"
    slope = of(footing(standing(load={"slope": "10 deg"}, limits={"acceleration": "1.2 m/s^2"})))["lift_off"]
    assert slope.demand == pytest.approx(1.2 / math.cos(math.radians(10.0)) + G * math.tan(math.radians(10.0)))
    assert slope.limit == pytest.approx(worst)  # both may point the same way
    assert of(footing(standing(load={"slope": "-10 deg"})))["lift_off"].demand == pytest.approx(G * 0.17633, rel=1e-4)


def test_a_differential_drive_gains_speed_along_itself_only():
    """Two wheels 0.5 m apart and a caster 0.4 m behind, the centre 0.1 m behind the axle: braking at g 0.1 / h."""
    given = {
        "layout": {"kind": "differential", "track": "500 mm"}, "casters": [{"x": "-0.4 m", "y": "0 m"}],
        "centre_of_mass": {"x": "-0.1 m", "height": "0.3 m"}, "limits": {"acceleration": "2.5 m/s^2"},
    }  # fmt: skip
    check = of(footing(standing(load={"driven_wheels": 2}, **given)))
    assert check["lift_off"].limit == pytest.approx(G * 0.1 / 0.3)
    assert check["tipping"].limit == pytest.approx(G * 0.1 / 0.3)


def test_along_a_trajectory():
    """Braking at 3 m/s² moves m a h / 2B to each front wheel of 45 kg / 4; the way to the edge is h a / g."""
    way = joined(
        piece((0, 0, 0), (0, 0, 0), (1.0, 0, 0), 1.5), piece((1.125, 0, 0), (1.5, 0, 0), (-3.0, 0, 0), 0.5)
    )  # fmt: skip
    check = of(footing(standing(trajectory=way)))
    assert check["wheel_unloading"].demand == pytest.approx(3.0 * 0.090 / (2 * 0.47706) / (G / 4))
    assert check["wheel_unloading"].note in ("wheel 3", "wheel 4") and check["wheel_unloading"].at_time >= 1.5
    assert check["tipping_motion"].demand == pytest.approx(3.0 * 0.090 / G / 0.23853)
    assert {c.status for c in check.values()} == {"pass"}
    tall = of(footing(standing(trajectory=way, centre_of_mass={"height": "0.9 m"})))
    assert tall["wheel_unloading"].status == "fail" and tall["tipping_motion"].status == "fail"


@pytest.mark.parametrize(("track", "axle"), [(0.5, 0.0), (0.613, 0.1), (0.7, -0.23), (0.331, 0.07), (0.9, 0.3)])
def test_a_centre_of_mass_over_the_axle_is_on_the_edge_whatever_rounding_says(track, axle):
    """The caster behind carries nothing: the robot stands on the line between its wheels, and that is not inside."""
    two = {"layout": {"kind": "differential", "track": f"{track} m", "x": f"{axle} m"}}
    caster = {"casters": [{"x": f"{axle - 0.317} m", "y": "0 m"}]}
    edge = standing({"driven_wheels": 2}, **two, **caster, centre_of_mass={"x": f"{axle} m", "height": "0.2 m"})
    assert of(footing(edge))["centre_of_mass"].status == "fail"
    inside = standing(
        {"driven_wheels": 2}, **two, **caster, centre_of_mass={"x": f"{axle - 0.01} m", "height": "0.2 m"}
    )
    assert of(footing(inside))["centre_of_mass"].status == "pass"


# --- grip -------------------------------------------------------------------------------------------------------------


def test_mecanum_wheels_have_less_grip_than_their_weight_times_mu():
    """Low on the floor, without rolling resistance: across the diagonal two wheels pull, a = μ g / 2."""
    load = {"friction_coefficient": 0.6, "rolling_resistance": 0.0, "slope": "5 deg"}
    low = {"centre_of_mass": {"height": "0 mm"}}
    check = of(grip_checks(standing(load, limits={"acceleration": "1 m/s^2"}, **low)))
    assert check["grip_slope"].limit == pytest.approx(math.atan(0.3))
    up = G * (0.3 * math.cos(math.radians(5.0)) - math.sin(math.radians(5.0)))
    assert check["grip_acceleration"].limit == pytest.approx(up)
    faster = of(grip_checks(standing(load, limits={"acceleration": "2.2 m/s^2"}, **low)))
    assert faster["grip_acceleration"].status == "fail"  # four wheels of μ m g / 4 would have passed: 5.0 m/s²
    steep = of(grip_checks(standing(load | {"slope": "17 deg"}, **low)))
    assert steep["grip_slope"].status == "fail"
    careful = of(grip_checks(standing(load, needed=1.2, limits={"acceleration": "1 m/s^2"}, **low)))
    assert careful["grip_acceleration"].status == "fail" and careful["grip_acceleration"].needed == 1.2


def test_friction_along_a_trajectory():
    """2 m/s² forwards: F = m a / (4 cos 45°) at each wheel, on what is left behind it when the nose dips."""
    way = piece((0, 0, 0), (1.5, 0, 0), (-2.0, 0, 0), 0.7)
    load = {"friction_coefficient": 0.6, "rolling_resistance": 0.0, "inertia": "0 kg*m^2"}
    check = of(grip_checks(standing(load, trajectory=way)))["grip_motion"]
    weight = MASS * G / 4 - MASS * 2.0 * 0.090 / 0.47706 / 2
    assert check.demand == pytest.approx(MASS * 2.0 / 4 / math.cos(math.pi / 4) / weight)
    assert check.status == "pass" and check.note in ("wheel 3", "wheel 4")
    slick = of(grip_checks(standing(load | {"friction_coefficient": 0.25}, trajectory=way)))["grip_motion"]
    assert slick.status == "fail"


# --- all of it --------------------------------------------------------------------------------------------------------


AHEAD = straight((-2.0, 0.01), (2.0, 0.01), 0.0, 4.0)
ON_SLOPE = {"friction_coefficient": 0.6, "slope": "2 deg"}
PASSING = {"passages": [DOOR | {"height": "200 mm", "x": "0 m", "y": "0 m"}], "limits": {"acceleration": "1 m/s^2"}}


def in_all(load=ON_SLOPE, trajectory=AHEAD, **given):
    return standing(load, trajectory, **(PASSING | given))


def test_a_trajectory_that_the_wheels_do_not_allow_is_refused():
    given = {"layout": {"kind": "differential", "track": "500 mm"}, "casters": [{"x": "-0.4 m", "y": "0 m"}]}
    centre = {"x": "-0.1 m", "height": "0.1 m"}
    with pytest.raises(InputError, match="slides wheel"):
        platform_checks(
            in_all({"driven_wheels": 2}, straight((0.0, -1.0), (0.0, 1.0), 0.0, 2.0), centre_of_mass=centre, **given)
        )


# --- requirements -----------------------------------------------------------------------------------------------------


def machine(required, **given):
    """A vehicle on one of the 19 sections of a ring of 7 km: 368.4 m at 1.5 m/s with ramps of 2 s."""
    cruise = 7000 / 19 / 1.5 - 2.0
    base = {
        "name": "survey",
        "load": vehicle_of(),
        "motion": {"speed": "1.5 m/s", "acceleration_time": "2 s", "cruise_time": f"{cruise} s"},
        "supply": {"nominal": "24 V", "current": "20 A"},
    }  # fmt: skip
    spec = load_spec(base | given | {"requirements": required})
    return of(requirement_checks(spec, spec.requirements))


def test_the_time_of_a_survey():
    """19 sections of 247.6 s are 78.4 min."""
    found = machine({"travel": {"distance": "7 km", "within": "80 min"}})["travel_time"]
    assert found.demand / 60 == pytest.approx(78.4, abs=0.05) and found.status == "pass"
    assert found.demand == pytest.approx(19 * 247.6, rel=1e-4)
    assert machine({"travel": {"distance": "7 km", "within": "75 min"}})["travel_time"].status == "fail"


def test_doors_and_station_take_time_of_a_survey():
    """19 sections, 19 doors of 1.2 m in 25 s, 84 s in the station for 8 m: 7 km at 7031 m in 5264 s take 87.3 min."""
    cases = [
        {"name": "door", "share": 475 / 5264,
         "motion": {"speed": "0.3 m/s", "acceleration_time": "1 s", "cruise_time": "3 s", "rest_time": "20 s"}},
        {"name": "station", "share": 84 / 5264,
         "motion": {"speed": "0.2 m/s", "acceleration_time": "1 s", "cruise_time": "9 s", "rest_time": "10 s",
                    "there_and_back": True}},
    ]  # fmt: skip
    required = {"travel": {"distance": "7 km", "within": "90 min"}, "speed": "1.5 m/s"}
    found = machine(required, cases=cases)
    by_hand = 7000 / (7000 + 19 * 1.2 + 8.0) * (19 * 247.614 + 475 + 84)
    assert found["travel_time"].demand == pytest.approx(by_hand, rel=1e-3)
    assert found["travel_time"].demand / 60 == pytest.approx(87.3, abs=0.1)
    assert found["motion_speed"].status == "pass"  # in the sections


def test_a_posture_has_a_door_of_its_own():
    """Raised it is 600 mm high, folded 184 mm; the door of 200 mm is that of the folded one, which tips less easily."""
    layout = {"kind": "mecanum", "wheelbase": "477 mm", "track": "270 mm"}
    size_of = {"length": "707 mm", "width": "350 mm"}
    raised = {"layout": layout, "size": size_of | {"height": "600 mm"}, "centre_of_mass": {"height": "150 mm"}}
    door = {"name": "door", "width": "400 mm", "height": "200 mm"}
    folded = {"size": size_of | {"height": "184 mm"}, "centre_of_mass": LOW, "passages": [door]}
    base = {
        "name": "survey", "load": vehicle_of(), "motion": {"speed": "1.5 m/s", "acceleration_time": "2 s",
                                                            "cruise_time": "240 s"},
        "supply": {"nominal": "24 V"}, "platform": raised,
        "cases": [{"name": "door", "share": 0.1, "motion": {"speed": "0.3 m/s", "cruise_time": "3 s"},
                   "platform": folded}],
    }  # fmt: skip
    found = of(worst_case_budget(load_spec(base))[0])
    assert (found["passage_height"].demand, found["passage_height"].status) == (0.184, "pass")
    assert found["lift_off"].case == "as specified"  # a wheel carries m g / 4 - m a h (cos / 2 L + sin / 2 W)
    assert found["lift_off"].limit == pytest.approx(G / 4 / (0.150 / 2 * math.hypot(1 / 0.477, 1 / 0.270)))


def vehicle_of():
    return {"kind": "wheeled_vehicle", "mass": "45 kg", "driven_wheels": 4, "wheel_diameter": "152.4 mm",
            "rolling_resistance": 0.02, "inertia": "40 kg*cm^2"}  # fmt: skip


def test_slip_draws_more_of_the_battery():
    """For a travel the wheels turn by 1 / (1 - 0.2) more: a quarter more is drawn, and the line of slip has a fifth."""
    battery = {"nominal_voltage": "24 V", "capacity": "14 A*h", "rated_time": "20 h", "peukert_exponent": 1.2}
    platform = {"layout": {"kind": "mecanum", "wheelbase": "477 mm", "track": "270 mm"}, "inertia": "2 kg*m^2"}
    found = []
    for slip in ({}, {"slip": "20 %"}):
        spec = load_spec({
            "name": "survey", "load": vehicle_of(), "supply": {"nominal": "24 V", "current": "20 A"},
            "motion": {"speed": "1.5 m/s", "acceleration_time": "2 s", "cruise_time": "240 s"},
            "battery": battery, "platform": platform | slip, "select": {"catalogs": ["maxon"]},
            "transmission": [{"kind": "gearhead"}, {"kind": "belt", "ratio": 1.1, "efficiency": 0.95}],
        })  # fmt: skip
        found.append(explain(spec, "118752", "406764")[0].energy)
    without, slipping = ({one.name: one.mean for one in budget.consumers} for budget in found)
    assert slipping["drive"] == pytest.approx(without["drive"])
    assert slipping["slip of the wheels"] == pytest.approx(without["drive"] / 4)
    drawn = without["drive"] + without["losses of the controllers"]
    assert found[1].mean_power - found[0].mean_power == pytest.approx(drawn / 4, rel=0.01)
    said = "slip of the rollers on the floor is not counted: platform.slip"
    assert said in found[0].assumptions and said not in found[1].assumptions


def test_the_speed_of_the_motion_is_held_against_the_required_one():
    assert machine({"speed": "5.4 km/h"})["motion_speed"].status == "pass"  # 1.5 m/s, but for rounding
    assert machine({"speed": "1.6 m/s"})["motion_speed"].margin == pytest.approx(1.5 / 1.6 - 1)


def test_a_device_that_nothing_carries_is_named():
    battery = {"nominal_voltage": "24 V", "capacity": "14 A*h"}
    carried = {"equipment": [{"name": "3D LIDAR", "power": "8 W"}], "battery": battery}
    found = machine({"devices": ["3D LIDAR", "SONAR"]}, **carried)["devices"]
    assert (found.status, found.demand, found.limit) == ("fail", 2.0, 1.0)
    assert found.note.endswith(": SONAR")
    others = {"budget": {"others": [{"name": "SONAR", "mass": "50 g"}]}}
    assert machine({"devices": ["3D LIDAR", "SONAR"]}, **carried, **others)["devices"].status == "pass"


@pytest.mark.parametrize(
    ("required", "said"),
    [
        ({}, "give travel, speed or devices"),
        ({"travel": {"distance": "7 km"}}, "requirements.travel.within: is missing"),
        ({"devices": ["IMU", "IMU"]}, "expected devices with names of their own"),
        ({"speed": "3000 rpm"}, "requirements.speed"),
    ],
)
def test_a_wrong_requirement_is_one_line(required, said):
    assert said in refusal(lambda: machine(required))


def test_what_turns_in_place_travels_no_distance():
    turning = {"load": {"kind": "flywheel", "inertia": "0.2 kg*m^2"}}
    turning["motion"] = {"speed": "60 rpm", "acceleration_time": "1 s", "cruise_time": "5 s"}
    with pytest.raises(InputError, match=r"requirements\.travel: a flywheel does not travel"):
        machine({"travel": {"distance": "1 km", "within": "1 h"}}, **turning)
    found = machine({"speed": "50 rpm"}, **turning)["motion_speed"]
    assert (found.unit, found.margin) == ("rpm", pytest.approx(0.2))
