"""A payload that changes within the cycle: loaded out, empty back."""

import numpy as np
import pytest
import yaml
from refusals import refusal

from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.platform import at_shaft, motion_of, remaining_torque
from drivesizer.search.uncertainty.uncertain_figures import applied
from drivesizer.spec.robot import load_spec

LOADS = {
    "conveyor": "mass: 8 kg, belt_mass: 1 kg, drum_diameter: 70 mm, friction_coefficient: 0.2, efficiency: 0.9, "
    "incline: 5 deg",
    "hoist": "mass: 14 kg, counterweight: 9 kg, drum_diameter: 60 mm, rope_efficiency: 0.9, friction_force: 5 N",
    "ball_screw": "mass: 8 kg, lead: 10 mm, efficiency: 0.9, incline: 90 deg, inertia: 0.2 kg*cm^2, force: 9 N",
    "rack_pinion": "mass: 8 kg, pinion_diameter: 40 mm, friction_coefficient: 0.1, incline: 20 deg",
    "belt_axis": "mass: 8 kg, pulley_diameter: 40 mm, belt_mass: 0.3 kg, friction_coefficient: 0.1, incline: 40 deg",
    "arm": "mass: 4 kg, length: 0.4 m, inertia: 0.9 kg*m^2, start_angle: -20 deg",
    "wheeled_vehicle": "mass: 30 kg, driven_wheels: 2, wheel_diameter: 150 mm, rolling_resistance: 2 %, "
    "inertia: 3 kg*cm^2, slope: 2 deg, friction_coefficient: 0.5",
}


def spec_of(kind, motion, load="", **more):
    fields = yaml.safe_load(f"{{kind: {kind}, {load or LOADS[kind]}}}")
    speed = "60 deg/s" if kind == "arm" else "0.4 m/s"
    moved = {"speed": speed, "acceleration_time": "0.2 s", "cruise_time": "0.5 s", "rest_time": "0.3 s"}
    motion = motion if "profile" in motion else moved | {"there_and_back": True} | motion
    return load_spec({"name": "axis", "load": fields, "motion": motion, "supply": {"nominal": "48 V"}, **more})


def heavier(kind, payload):
    """The same load with the payload in its own mass; an arm has it in its inertia too."""
    figures = dict(pair.split(": ") for pair in LOADS[kind].split(", "))
    figures["mass"] = f"{float(figures['mass'].split()[0]) + payload} kg"
    if kind == "arm":
        figures["inertia"] = f"{0.9 + payload * 0.16} kg*m^2"
    return ", ".join(f"{name}: {text}" for name, text in figures.items())


def torque_at(cycle, moments):
    time, torque = cycle.time.reshape(-1), cycle.torque.reshape(-1)
    return np.interp(moments, time, torque)


@pytest.mark.parametrize("kind", LOADS)
def test_each_way_is_that_of_a_load_of_its_mass(kind):
    """Out as the load with 5 kg in its own mass, back as the load without."""
    changing = load_cycle(spec_of(kind, {"payload": "5 kg", "payload_back": "0 kg"}))
    loaded, empty = load_cycle(spec_of(kind, {}, heavier(kind, 5.0))), load_cycle(spec_of(kind, {}))
    half = changing.total / 2
    moments = np.array([0.05, 0.11, 0.3, 0.5, 0.76, 0.85, 1.0, 1.1]) * half / 1.2
    assert torque_at(changing, moments) == pytest.approx(torque_at(loaded, moments), rel=1e-4, abs=1e-9)
    assert torque_at(changing, half + moments) == pytest.approx(torque_at(empty, half + moments), rel=1e-4, abs=1e-9)
    assert changing.inertia == pytest.approx(loaded.inertia)
    both = load_cycle(spec_of(kind, {"payload": "5 kg"}))
    assert both.torque == pytest.approx(loaded.torque, abs=1e-12)


HELD = {"hold_unpowered": True}


@pytest.mark.parametrize("kind", LOADS)
def test_a_brake_holds_the_heaviest(kind):
    """Loaded out and empty back: the brake holds what a load of that mass would need, the heavier of both."""
    changing, loaded, empty = (
        load_cycle(spec_of(kind, motion, load, needs=HELD)).holding_torque
        for motion, load in (({"payload": "5 kg", "payload_back": "0 kg"}, ""), ({}, heavier(kind, 5.0)), ({}, ""))
    )
    assert changing == pytest.approx(max(loaded, empty), rel=1e-9)
    assert loaded > 1.1 * empty


def test_a_brake_holds_an_arm_where_it_has_its_payload():
    """It takes 3 kg only above, where it swings on from 60 to 90 degrees: level it is empty."""
    pieces = [{"time": "1 s", "to": "60 deg/s"}, {"time": "1 s", "to": "0 deg/s"},
              {"time": "0.5 s", "to": "60 deg/s", "payload": "3 kg"}, {"time": "0.5 s", "to": "0 deg/s"},
              {"time": "1.5 s", "to": "-60 deg/s", "payload": "0 kg"}, {"time": "1.5 s", "to": "0 deg/s"}]  # fmt: skip
    spec = spec_of("arm", {"profile": "segments", "segments": pieces}, "mass: 4 kg, length: 0.4 m", needs=HELD)
    assert load_cycle(spec).holding_torque == pytest.approx(4 * 9.80665 * 0.4)
    low = spec_of("arm", {"profile": "segments", "segments": pieces},
                  "mass: 4 kg, length: 0.4 m, start_angle: -60 deg", needs=HELD)  # fmt: skip
    assert load_cycle(low).holding_torque == pytest.approx(7 * 9.80665 * 0.4)  # taken up where it is level


def test_traction_is_worst_where_the_wheel_is_light():
    """Grip goes with the mass, wind does not: the way back without payload decides."""
    load = LOADS["wheeled_vehicle"] + ", headwind: 20 m/s, drag_area: 0.5 m^2"
    changing, empty, loaded = (
        load_cycle(spec_of("wheeled_vehicle", motion, load)).own[0]
        for motion in ({"payload": "30 kg", "payload_back": "0 kg"}, {}, {"payload": "30 kg"})
    )
    assert loaded.limit == pytest.approx(2 * empty.limit)
    assert changing.limit == pytest.approx(empty.limit)
    assert changing.time > 1.2  # on the way back
    assert loaded.demand / loaded.limit < changing.demand / changing.limit <= empty.demand / empty.limit


def test_segments_take_and_leave_it():
    pieces = [
        {"time": "0.2 s", "to": "0.5 m/s"}, {"time": "0.2 s", "to": "0 m/s"}, {"time": "0.5 s", "payload": "3 kg"},
        {"time": "0.2 s", "to": "-0.5 m/s"}, {"time": "0.2 s", "to": "0 m/s"}, {"time": "0.5 s", "payload": "0 kg"},
    ]  # fmt: skip
    cycle = load_cycle(spec_of("rack_pinion", {"profile": "segments", "segments": pieces}, "mass: 8 kg, "
                               "pinion_diameter: 40 mm, incline: 90 deg"))  # fmt: skip
    resting = cycle.torque[(cycle.speed == 0).all(axis=1)][:, 0]
    assert resting == pytest.approx([11 * 9.80665 * 0.02, 8 * 9.80665 * 0.02])
    assert cycle.torque[0, 0] == pytest.approx(8 * (9.80665 + 2.5) * 0.02)
    assert pytest.approx(cycle.torque[(cycle.speed < 0).any(axis=1)][0, 0]) == 11 * (9.80665 - 2.5) * 0.02


@pytest.mark.parametrize("kind", LOADS)
def test_in_closed_loop_it_is_torque_over_time(kind):
    """Constants and inertia of the empty load, and the rest over time, together are the load cycle."""
    spec = spec_of(kind, {"payload": "5 kg", "payload_back": "1 kg"})
    shaft, profile, cycle = at_shaft(spec), motion_of(spec), load_cycle(spec)
    left = remaining_torque(spec, profile, shaft)
    speed, torque, slope = (getattr(cycle, name).mean(axis=1) for name in ("speed", "torque", "acceleration"))
    constant = np.select([speed > 0.0, speed < 0.0], [shaft.forward_torque, shaft.backward_torque], shaft.rest_torque)
    whole = shaft.inertia * slope + constant + np.interp(cycle.time.mean(axis=1), *left.T)
    assert whole == pytest.approx(torque, abs=1e-9 * np.abs(torque).max())


def test_a_tolerance_of_the_payload():
    spec = spec_of("rack_pinion", {"payload": "5 kg +- 1 kg"})
    (one,) = spec.toleranced
    moved = load_cycle(applied(spec, {one.path: 1.0}))
    assert moved.torque == pytest.approx(load_cycle(spec_of("rack_pinion", {"payload": "6 kg"})).torque)


@pytest.mark.parametrize(
    ("load", "motion", "line"),
    [
        ("kind: flywheel, inertia: 1 kg*cm^2", "speed: 1 rpm", "motion: a flywheel takes no payload that changes"),
        ("kind: rack_pinion, mass: 1 kg, pinion_diameter: 9 mm", "speed: 1 m/s, payload_back: 1 kg",
         "motion: give there_and_back: true beside payload_back"),
        ("kind: rack_pinion, mass: 1 kg, pinion_diameter: 9 mm", "speed: 1 m/s, payload: -1 kg",
         "motion.payload: .*must be at least 0"),
    ],
)  # fmt: skip
def test_refused_in_one_line(load, motion, line):
    fields = {"payload": "2 kg", "acceleration_time": "1 s", "cruise_time": "1 s"}
    refusal(
        lambda: load_spec(
            {
                "name": "x",
                "load": yaml.safe_load(f"{{{load}}}"),
                "supply": {"nominal": "24 V"},
                "motion": fields | yaml.safe_load(f"{{{motion}}}"),
            }
        ),
        match=line,
    )
