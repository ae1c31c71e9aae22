"""Controllers whose maker limits the power too, less at a high supply voltage."""

from __future__ import annotations

import pytest
import yaml

from drivesizer.results.ratings import controller_power_limit
from drivesizer.sizing import explain
from drivesizer.spec.robot import load_spec

X1 = {
    "max_power": 1300.0,
    "max_power_voltage": 36.0,
    "reduced_power": float("nan"),
    "reduced_power_voltage": float("nan"),
}
CATALOG = """catalog: 1
manufacturer: Anymaker
sources: {sheet: {document: sheet, confidence: quoted}}
motors:
- family: M
  source: sheet
  common: {kind: brushless, nominal_voltage: 24 V, max_winding_temperature: 125 degC, pole_pairs: 7}
  columns: [part, no_load_speed (rpm), no_load_current (A), nominal_speed (rpm), nominal_torque (N*m),
    nominal_current (A), resistance (ohm), inductance (mH), torque_constant (mN*m/A), rotor_inertia (g*cm^2),
    max_speed (rpm), ambient_min (degC), ambient_max (degC), mass (g), thermal_resistance_winding (K/W),
    thermal_resistance_housing (K/W), winding_time_constant (s), motor_time_constant (s)]
  rows: [[M1, 4500, 0.5, 3500, 1.0, 20, 0.01, 0.1, 50, 400, 12000, -20, 100, 500, 0.5, 2, 30, 900]]
controllers:
- family: C
  source: sheet
  common: {drives: brushless, supply_min: 10 V, supply_max: 60 V, max_duty: 95 %, voltage_drop: 0.5 V,
    continuous_current: 40 A, peak_current: 100 A, peak_time: 10 s}
  columns: [part, max_power (W), max_power_voltage (V), reduced_power (W), reduced_power_voltage (V)]
  rows:
  - [free,      ~,  ~,   ~,  ~]
  - [limited, 900, 30, 400, 38]
compatibility:
  motor_gearhead: [{source: sheet, motors: [M], gearheads: [direct]}]
"""
SPEC = {
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
        spec = SPEC | {"supply": {"nominal": f"{volts} V"}}
        spec |= {"select": {"catalogs": ["own.yaml"], "controller": {"part": [part]}}}
        (tmp_path / "robot.yaml").write_text(yaml.safe_dump(spec), encoding="utf-8")
        (found,) = explain(load_spec(tmp_path / "robot.yaml"), "M1", "direct")
        checks[part] = {check.name: check for check in found.checks}
    assert checks["limited"]["controller_power"].status == status
    assert checks["limited"]["controller_power"].demand == pytest.approx(445.0, rel=0.03)  # the winding warms
    assert "controller_power" not in checks["free"]
