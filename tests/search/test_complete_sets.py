"""Parts lists that are complete: nothing is *none listed* for want of a part that everybody buys."""

from __future__ import annotations

from typing import Any

import pytest

from drivesizer.catalog import load
from drivesizer.catalog.view import ASSUMED, search_view
from drivesizer.output.parts import parts_list
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import load_spec

AXES: dict[str, dict[str, Any]] = {
    "a robot of FRC with four wheels": {
        "load": {"kind": "wheeled_vehicle", "mass": "56 kg", "wheel_diameter": "101.6 mm", "driven_wheels": 4,
                 "rolling_resistance": 0.02, "inertia": "0.002 kg*m^2"},
        "motion": {"speed": "3 m/s", "acceleration_time": "1.2 s", "cruise_time": "1 s", "rest_time": "2 s"},
        "transmission": [{"kind": "direct"}, {"kind": "gear", "ratio": 6.75, "efficiency": "90 %"}],
        "supply": {"nominal": "12 V", "current": "160 A", "kind": "battery"},
        "select": {"catalogs": ["rev", "ctre"], "motor": {"part": ["NEO V1.1", "Kraken X60"]}},
    },
    "an axis of a printer with NEMA 17": {
        "load": {"kind": "belt_axis", "mass": "0.6 kg", "pulley_diameter": "12.73 mm", "friction_coefficient": 0.02},
        "motion": {"distance": "200 mm", "speed": "200 mm/s", "acceleration": "3 m/s^2", "rest_time": "0.2 s"},
        "transmission": [{"kind": "direct"}],
        "supply": {"nominal": "24 V", "current": "5 A"},
        "select": {"catalogs": ["stepperonline", "pololu"], "motor": {"kind": "stepper", "part": "17HS19-2004S1"}},
    },
    "a servo axis at 230 V": {
        "load": {"kind": "ball_screw", "mass": "80 kg", "lead": "10 mm", "efficiency": "90 %",
                 "friction_coefficient": 0.01, "inertia": "2 kg*cm^2"},
        "motion": {"distance": "300 mm", "speed": "300 mm/s", "acceleration": "3 m/s^2", "rest_time": "0.4 s"},
        "transmission": [{"kind": "direct"}],
        "supply": {"nominal": "325 V", "current": "10 A", "kind": "drive_bus"},
        "select": {"catalogs": ["yaskawa"]},
    },
}  # fmt: skip


@pytest.mark.parametrize("name", AXES)
def test_nothing_is_missing_in_the_parts_list(name: str):
    found = size(load_spec({"name": name, **AXES[name]}))
    lines = {line.role: line for line in parts_list(found.reported, found.problem.catalog, found.spec.load.motors)}
    assert all(line.part for role, line in lines.items() if role in ("motor", "encoder", "controller"))
    inside = found.reported.controller is not None and found.reported.controller.inside
    assert found.reported.controller is not None and ("controller" in lines or inside)


def servo(**select: Any) -> Any:
    return {"name": "servo", **AXES["a servo axis at 230 V"]} | {"select": {"catalogs": ["yaskawa"], **select}}


def test_the_amplifier_of_a_mains_servo_is_assumed_and_has_its_rating():
    """SGM7J-C2A, Yaskawa: 1.6 A effective continuous, its peak torque of 1.67 N*m; amplifiers for 200 to 240 V."""
    (one,) = explain(load_spec(servo()), "SGM7J-C2A", "direct")
    amplifier, motor = one.controller, one.motor
    assert (amplifier.family, amplifier.part) == (ASSUMED, "amplifier for SGM7J-C2A")
    assert amplifier.continuous_current == motor.nominal_current == pytest.approx(1.6 * 1.5**0.5, rel=1e-3)
    assert amplifier.peak_current == pytest.approx(motor.peak_torque / motor.torque_constant)
    assert amplifier.supply_min < 230 * 2**0.5 * 0.9 and amplifier.supply_max > 240 * 2**0.5 * 1.05
    checks = {check.name: check.status for check in one.checks}
    assert {checks[f"controller_{name}"] for name in ("available", "continuous_current", "peak_current")} == {"pass"}
    catalog = search_view(load(["yaskawa"]))
    rows = catalog.controllers["family"] == ASSUMED
    assert {catalog.sources[row].confidence for row in catalog.controllers.source[rows].tolist()} == {"derived"}


@pytest.mark.parametrize("part", ["SGM7A-15A", "SGM7A-20A"])
def test_a_servo_of_unknown_friction_has_its_amplifier(part: str):
    """Friction takes no more of the current than what the printed torque leaves: SGM7A-15A 4.9 of 0.4817*11.39 N*m."""
    (one,) = explain(load_spec(servo()), part, "direct")
    assert one.controller is not None and one.controller.part == f"amplifier for {part}"
    (idle,) = [each for each in one.estimated if each.figure == "no_load_current"]
    assert one.motor.torque_constant * (one.motor.nominal_current - idle.high) > one.motor.nominal_torque / 1.15


def test_an_assumed_amplifier_is_of_its_motor_alone_and_of_no_other_supply():
    (one,) = explain(load_spec(servo() | {"supply": {"nominal": "48 V", "current": "50 A"}}), "SGM7J-C2A", "direct")
    assert one.controller is None and "none is listed for 48 V" in one.without_controller
    with_name = servo(controller={"family": "ELM72xx"}, catalogs=["yaskawa", "beckhoff"])
    (one,) = explain(load_spec(with_name), "SGM7J-C2A", "direct")
    assert one.controller is None  # what the spec names is all that counts
    assert not (search_view(load(["maxon", "rev"])).controllers["family"] == ASSUMED).any()
