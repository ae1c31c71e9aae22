"""The physics method with the numbers put in: what the formulas give is what the checks have."""

import pytest

from drivesizer.output.document.content import Content
from drivesizer.output.document.records import Equation, Words
from drivesizer.output.document.worked import with_numbers
from drivesizer.sizing import size
from drivesizer.spec.robot import load_spec

SUPPLY = {"nominal": "24 V", "min": "22 V", "max": "26 V", "regeneration": 0, "accepts": "all"}
MOVE = {
    "speed": "0.2 m/s",
    "acceleration_time": "0.3 s",
    "cruise_time": "2 s",
    "rest_time": "1 s",
    "there_and_back": True,
}
TURN = MOVE | {"speed": "60 deg/s"}
LOADS = {
    "ball_screw": {"mass": "30 kg", "lead": "10 mm", "efficiency": 0.9, "incline": "20 deg", "inertia": "0.5 kg*cm^2",
                   "friction_coefficient": 0.01, "force": "80 N", "preload_torque": "0.05 N*m"},
    "belt_axis": {"mass": "6 kg", "pulley_diameter": "38 mm", "belt_mass": "0.3 kg", "idler_inertia": "0.2 kg*cm^2",
                  "friction_torque": "0.02 N*m", "motors": 2},
    "conveyor": {"mass": "12 kg", "belt_mass": "1.5 kg", "drum_diameter": "60 mm", "friction_coefficient": 0.25,
                 "incline": "-8 deg"},
    "hoist": {"mass": "15 kg", "counterweight": "4 kg", "drum_diameter": "50 mm", "falls": 2, "rope_efficiency": 0.94},
    "arm": {"mass": "2.5 kg", "length": "300 mm", "start_angle": "-60 deg", "tilt": "20 deg"},
    "rotary_table": {"inertia": "0.12 kg*m^2", "friction_torque": "0.4 N*m", "torque": "0.1 N*m"},
    "fan": {"inertia": "30 kg*cm^2", "rated_torque": "0.25 N*m", "rated_speed": "1800 rpm",
            "friction_torque": "0.01 N*m"},
    "wheeled_vehicle": {"mass": "30 kg", "driven_wheels": 2, "wheel_diameter": "200 mm", "rolling_resistance": 0.015,
                        "inertia": "40 kg*cm^2", "slope": "3 %"},
}  # fmt: skip


@pytest.mark.parametrize("kind", LOADS)
def test_the_formulas_give_what_the_checks_have(kind, catalog):
    motion = TURN if kind in ("arm", "rotary_table", "fan") else MOVE
    stages = [{"kind": "gearhead"}, {"kind": "belt", "ratios": [2], "efficiency": "95 %"}]
    load = {"kind": kind, **LOADS[kind]}
    spec = load_spec({"name": "x", "load": load, "motion": motion, "supply": SUPPLY, "transmission": stages})
    result = size(spec, catalog=catalog, top=1)
    blocks = list(with_numbers(Content(result)))
    steps = {b.step["exact"]["name"]: b.step["exact"]["value"] for b in blocks if isinstance(b, Equation)}
    assert not [b for b in blocks[1:] if isinstance(b, Words)]  # the load's own formula holds
    drive, requirements = result.sets[0], {r.name: r.value for r in result.requirements}
    checks = {check.name: check.demand for check in drive.own_checks}
    assert abs(steps["shaft_torque"]) <= requirements["maximum_torque_per_motor"] * (1 + 1e-9)
    assert abs(steps["motor_current"]) == pytest.approx(checks["controller_peak_current"])
    assert steps["motor_rms_current"] == pytest.approx(checks["motor_nominal_current"])
    assert steps["motor_speed"] == pytest.approx(checks["motor_speed"])
