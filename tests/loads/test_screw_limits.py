"""A typed screw: its own checks against plain Python, the trap of lowering, and what is refused."""

import math
import random

import numpy as np
import pytest
from refusals import refusal

from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases import load_cycle, screw_requirements
from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.search.columns.limits import load_limits
from drivesizer.spec.robot import load_spec, read_spec

G = 9.80665
# THK General Catalogue, A-736 to A-746: vertical conveyance system with BLK1510-5.6
UPRIGHT = {
    "kind": "ball_screw", "mass": "50 kg", "lead": "10 mm", "efficiency": 0.9, "incline": "90 deg",
    "friction_force": "20 N", "diameter": "15 mm", "root_diameter": "12.5 mm", "ball_diameter": "15.75 mm",
    "length": "700 mm", "screw_length": "800 mm", "ends": "fixed-supported", "design": "THK",
    "dynamic_load": "9.8 kN", "static_load": "25.2 kN", "load_factor": 1.5, "dn_max": 70000,
}  # fmt: skip
MOTION = {
    "speed": "0.3 m/s", "acceleration_time": "0.2 s", "cruise_time": "1.8 s", "rest_time": "3.8 s",
    "there_and_back": True,
}  # fmt: skip


def spec_of(load=UPRIGHT, motion=MOTION, **sections):
    return load_spec({"name": "x", "load": load, "motion": motion, "supply": {"nominal": "48 V"}, **sections})


def checks_of(spec):
    return {check.name: check for check in load_limits(spec, CycleAtBelt(load_cycle(spec), 1.0).behind(1.0))}


def test_vertical_conveyance_of_thk():
    """A-739 to A-742: 585 N, 1800 rpm of 3852 rpm, 65 000 h, 23 400 km; of the buckling load of 9960 N half, for THK
    takes the nut as a fixed end, and the shaft's ends here are a fixed and a loose one."""
    spec = spec_of(needs={"life": "20000 h"})
    found = checks_of(spec)
    assert all(check.passed.all() for check in found.values())
    assert float(found["screw_buckling"].demand) == pytest.approx(585, abs=0.5)
    assert float(found["screw_buckling"].limit) == pytest.approx(9960 / 2, abs=5)
    assert float(found["screw_critical_speed"].demand) * 30 / math.pi == pytest.approx(1800)
    assert float(found["screw_critical_speed"].limit) * 30 / math.pi == pytest.approx(3852, abs=0.6)
    assert float(found["screw_dn"].demand) / 15.75 == pytest.approx(1800)
    assert float(found["screw_life"].limit) / 3600 == pytest.approx(65000, abs=500)
    figures = {one.name: one.value for one in screw_requirements([spec])}
    assert figures["screw_mean_load"] == pytest.approx(492, abs=0.5)
    assert figures["screw_life_distance"] == pytest.approx(23_400e3, abs=50e3)
    assert figures["screw_life_turns"] == pytest.approx(2.34e9, abs=0.005e9)


def test_lowering_is_not_divided_by_the_efficiency():
    """THK, A-743: 900 N·mm up is ours; down it divides 470 N by 0.9 too, 830 N·mm, though the load drives the screw."""
    torque, speed = load_cycle(spec_of()).torque, load_cycle(spec_of()).speed
    steady = np.flatnonzero(np.ptp(speed, axis=1) + (speed[:, 0] == 0.0) == 0.0)
    up, down = torque[steady, 0]
    ideal = 470.33 * 0.01 / (2 * math.pi)
    assert up == pytest.approx(0.900, abs=0.005)
    assert ideal / 0.9 == pytest.approx(0.830, abs=0.005)  # as printed
    assert down == pytest.approx(ideal * (2 - 1 / 0.9), rel=1e-3)


def test_thread_with_friction_has_both_efficiencies():
    """A trapezoidal thread Tr 20 x 4 at μ 0.12 locks itself: both efficiencies by the angles of its mean diameter."""
    sliding = {"kind": "lead_screw", "mass": "50 kg", "lead": "4 mm", "thread_friction": 0.12, "incline": "90 deg",
               "diameter": "20 mm", "root_diameter": "15.5 mm", "length": "700 mm", "permissible_thrust": "600 N",
               "motors": 2}  # fmt: skip
    spec = spec_of(sliding)
    slope, friction = math.atan(4 / (math.pi * 17.75)), math.atan(0.12 / math.cos(math.radians(15)))
    forward = math.tan(slope) / math.tan(slope + friction)
    backward = math.tan(slope - friction) / math.tan(slope)
    assert spec.load.efficiencies == pytest.approx((forward, backward))
    assert backward < 0.0
    assert spec.load.turning == pytest.approx(2 * 7850 * math.pi / 32 * 0.02**4 * 0.7)
    thrust = checks_of(spec)["screw_thrust"]
    assert float(thrust.demand) == pytest.approx(50 * (G + 1.5) / 2)  # of each of two screws
    assert thrust.passed.all()


def by_hand(load, speed, ramp, cruise, rest):
    """Largest force and speed of one screw, its hours, walked phase by phase."""
    climb = load["mass"] * G * math.sin(load["incline"]) + load["force"]
    rubs = load["mu"] * load["mass"] * G * math.cos(load["incline"]) + load["friction"]
    pull = load["mass"] * speed / ramp
    phases = [(sign, way, climb + sign * (rubs + a * pull)) for sign in (1, -1)
              for way, a in ((speed * ramp / 2, 1), (speed * cruise, 0), (speed * ramp / 2, -1))]  # fmt: skip
    total = sum(way for _, way, _ in phases)
    flanks = [sum(max(side * f, 0.0) ** 3 * way for _, way, f in phases) / total for side in (1, -1)]
    lives = [(load["C"] / load["fw"]) ** 3 / one * 1e6 for one in flanks if one > 0]
    turns = sum(one ** (-10 / 9) for one in lives) ** -0.9
    period = 2 * (2 * ramp + cruise + rest)
    most = max(*(abs(f) for _, _, f in phases), abs(climb))
    return most, speed / load["lead"], turns * load["lead"] / total * period


def test_every_check_by_hand_over_random_screws():
    chance = random.Random(3)
    for _ in range(25):
        load = {
            "mass": chance.uniform(5, 200), "incline": math.radians(chance.uniform(-90, 90)),
            "mu": chance.uniform(0, 0.1),
            "friction": chance.uniform(0, 50), "force": chance.uniform(-300, 300), "lead": chance.uniform(2, 40) / 1e3,
            "C": chance.uniform(1e3, 5e4), "C0": chance.uniform(1e3, 9e4), "fw": chance.uniform(1, 3),
            "core": chance.uniform(6, 50) / 1e3, "fs": chance.uniform(1, 4),
        }  # fmt: skip
        speed, ramp, cruise, rest = (chance.uniform(*span) for span in ((0.01, 1), (0.05, 1), (0.1, 3), (0, 2)))
        length = speed * (ramp + cruise) * chance.uniform(1.0, 2.0)
        core, ball = load["core"], load["core"] * 1.2
        spec = spec_of(
            {"kind": "ball_screw", "mass": f"{load['mass']!r} kg", "incline": f"{load['incline']!r} rad",
             "friction_coefficient": load["mu"], "friction_force": f"{load['friction']!r} N", "efficiency": 0.9,
             "force": f"{load['force']!r} N", "lead": f"{load['lead']!r} m", "dynamic_load": f"{load['C']!r} N",
             "static_load": f"{load['C0']!r} N", "static_safety": load["fs"], "load_factor": load["fw"],
             "diameter": f"{ball!r} m", "root_diameter": f"{core!r} m", "length": f"{length!r} m",
             "ends": "supported-supported", "design": "Rexroth", "dn_max": 9e4},
            {"speed": f"{speed!r} m/s", "acceleration_time": f"{ramp!r} s", "cruise_time": f"{cruise!r} s",
             "rest_time": f"{rest!r} s", "there_and_back": True},
            needs={"life": "15000 h"},
        )  # fmt: skip
        most, per_second, hours = by_hand(load, speed, ramp, cruise, rest)
        d, span = core * 1e3, length * 1e3
        expected = {
            "screw_buckling": (most, min(10.2e4 * d**4 / span**2 / 2, 147 * math.pi / 4 * d * d)),
            "screw_static_load": (most * load["fs"], load["C0"]),
            "screw_critical_speed": (per_second * 2 * math.pi, 0.8 * 12.1e7 * d / span**2 * math.pi / 30),
            "screw_dn": (ball * 1e3 * per_second * 60, 9e4),
            "screw_life": (15000 * 3600, hours),
        }
        found = checks_of(spec)
        assert set(found) == set(expected)
        for name, (demand, limit) in expected.items():
            assert (float(found[name].demand), float(found[name].limit)) == pytest.approx((demand, limit), rel=1e-6), (
                name
            )
            assert bool(found[name].passed) == (demand <= limit), name


def test_a_screw_without_figures_has_no_checks_and_unknown_ones_are_unknown():
    bare = {"kind": "ball_screw", "mass": "5 kg", "lead": "5 mm", "efficiency": 0.9, "inertia": "1 g*cm^2"}
    assert checks_of(spec_of(bare)) == {}
    assert screw_requirements([spec_of(bare)]) == []
    some = checks_of(spec_of(bare | {"ends": "fixed-free", "length": "900 mm"}))  # no core diameter
    assert set(some) == {"screw_buckling", "screw_critical_speed"}
    assert not any(check.passed.any() or check.failed.any() for check in some.values())


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"length": "500 mm"}, "load.length: 500 mm is shorter than the stroke; expected 600 mm and the nut at least"),
        ({"ends": "fixed-loose"}, '"fixed-loose" is not known'),
        ({"static_load": "-1 kN"}, "must be above 0 N"),
        ({"root_diameter": "18 mm"}, "root_diameter must be below diameter"),
        ({"screw_length": "600 mm"}, "screw_length must not be below length"),
        ({"length": None, "screw_length": None}, "give inertia, or diameter and length"),
        ({"length": None}, "give length beside ends"),
        ({"thread_friction": 0.1}, "both are given"),
        ({"thread_friction": 0.1, "efficiency": None, "back_efficiency": 0.2}, "leave one of them out"),
        ({"thread_friction": 0.1, "efficiency": None, "root_diameter": None}, "beside thread_friction"),
        ({"diameter": None, "ball_diameter": None, "inertia": "1 g*cm^2"}, "give diameter beside dn_max"),
    ],
)
def test_bad_figures_are_refused_in_a_line(change, words):
    fields = {name: value for name, value in (UPRIGHT | change).items() if value is not None}
    text = "\n".join(f"  {name}: {value}" for name, value in fields.items())
    moves = "\n".join(f"  {name}: {str(value).lower() if value is True else value}" for name, value in MOTION.items())
    source = YamlSource(f"name: x\nload:\n{text}\nmotion:\n{moves}\nsupply: {{nominal: 48 V}}\n", "x.yaml")
    line = refusal(lambda: load_cycle(read_spec(source)))
    assert words in line
    assert line.startswith("x.yaml:")


def test_driving_torque_of_thk_level():
    """THK, A-733: WTF2040 at 1 m/s takes 120 N·mm, 80 kg at μ 0.003 and 15 N of seals. In acceleration THK divides the
    friction by the efficiency and the mass's inertia not, 3680 N·mm at the screw; here all that passes the nut is."""
    level = {"kind": "ball_screw", "mass": "80 kg", "lead": "40 mm", "efficiency": 0.9, "friction_coefficient": 0.003,
             "friction_force": "15 N", "diameter": "20 mm", "length": "1200 mm"}  # fmt: skip
    moves = {"speed": "1 m/s", "acceleration_time": "0.15 s", "cruise_time": "0.85 s"}
    cycle = load_cycle(spec_of(level, moves))
    assert cycle.torque[1] == pytest.approx(0.120, abs=0.003)  # printed of 17 N, which is 17.35 N
    assert cycle.inertia == pytest.approx(3.39e-3, rel=0.01)  # 1.23e-3 kg·cm²/mm: 1.48e-4 kg·m² of the screw
    friction, angular = 17.35 * 0.04 / (2 * math.pi * 0.9), 1 / 0.15 * 2 * math.pi / 0.04
    assert friction + 3.39e-3 * angular == pytest.approx(3.68, abs=0.03)  # as printed, 4730 less 1e-3 of the rotor
    through_nut = (17.35 + 80 / 0.15) * 0.04 / (2 * math.pi * 0.9)
    assert cycle.torque[0, 0] == pytest.approx(through_nut + 1.48e-4 * angular, rel=0.005)
