"""Parts typed in ``select``: the figures of a shop page, through the door of catalogue files."""

from __future__ import annotations

from math import pi
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator
from refusals import refusal

from drivesizer.errors import DrivesizerError
from drivesizer.files.yaml_source import written
from drivesizer.multi_axis import size_machine
from drivesizer.sizing import size
from drivesizer.spec.machine import read_any
from drivesizer.spec.robot import RobotSpec, load_spec

WINCH: dict[str, Any] = {
    "name": "winch",
    "load": {"kind": "hoist", "mass": "6 kg", "drum_diameter": "40 mm"},
    "motion": {"speed": "0.1 m/s", "acceleration_time": "0.3 s", "cruise_time": "2 s", "rest_time": "3 s"},
    "supply": {"nominal": "12 V", "current": "30 A", "kind": "battery"},
}
MOTOR = {"name": "775", "kind": "brushed", "voltage": "12 V", "no_load_speed": "15000 rpm", "no_load_current": "1.2 A",
         "stall_torque": "0.5 N m", "stall_current": "70 A"}  # fmt: skip
GEARHEAD = {"name": "P60 64:1", "ratio": 64, "efficiency": "75 %", "rated_torque": "6 N m", "max_torque": "9 N m",
            "inertia": "20 g*cm^2"}  # fmt: skip
ACTUATOR = {"name": "worm 12 V", "maker": "Shop", "kind": "brushed", "voltage": "12 V", "no_load_speed": "60 rpm",
            "no_load_current": "0.5 A", "stall_torque": "7 N m", "stall_current": "6 A"}  # fmt: skip


def sized(**select: Any) -> Any:
    return size(load_spec({**WINCH, "select": {"catalogs": ["basicmicro"], **select}}))


def test_motor_and_gearhead_of_five_figures_are_a_drive():
    found = sized(motor=MOTOR, gearhead=GEARHEAD)
    one = found.reported
    assert (one.motor.part, one.gearhead.part, one.motor.resistance) == ("775", "P60 64:1", pytest.approx(12 / 70))
    # by hand: m g d/2 on the drum, over ratio, efficiency and torque per ampere
    lifting = 6 * 9.80665 * 0.02 / (64 * 0.75) / (0.5 / 70)
    checks = {check.name: check for check in one.checks}
    # and its friction, 0.65 to 1 of the no-load current, and inertia
    assert lifting + 0.65 * 1.2 < checks["controller_peak_current"].demand < lifting + 1.2 + 0.5
    assert checks["motor_speed"].demand == pytest.approx(0.1 / 0.02 * 64)
    said = "\n".join(found.warnings)
    assert "motor 775 is typed in select.motor: its figures are secondary; max speed, resistance, torque" in said
    assert "gearhead P60 64:1 on motor 775: assumed to fit" in said


def test_a_typed_row_is_the_row_of_a_file(tmp_path: Path):
    columns = "nominal_voltage (V), no_load_speed (rpm), no_load_current (A), stall_torque (N*m), stall_current (A)"
    (tmp_path / "own.yaml").write_text(
        "catalog: 1\nmanufacturer: typed\nsources: {s: {document: d, confidence: secondary}}\nmotors:\n"
        f'- {{family: "775", source: s, common: {{kind: brushed}}, columns: [part, {columns}],\n'
        '   rows: [["775", 12, 15000, 1.2, 0.5, 70]]}\n'
    )
    catalogs = ["basicmicro", str(tmp_path / "own.yaml")]
    direct = {"transmission": [{"kind": "direct"}, {"kind": "gear", "ratio": 60, "efficiency": "80 %"}]}
    ours = size(load_spec({**WINCH, **direct, "select": {"catalogs": ["basicmicro"], "motor": MOTOR}}))
    theirs = size(load_spec({**WINCH, **direct, "select": {"catalogs": catalogs, "motor": {"part": "775"}}}))
    each = [[str((c.name, c.demand, c.limit, c.status)) for c in one.reported.checks] for one in (ours, theirs)]
    assert each[0] == each[1]


def test_a_typed_motor_goes_with_gearheads_that_are_named_and_a_typed_gearhead_with_any_motor():
    with_family = sized(catalogs=["maxon"], motor={**MOTOR, "shaft_diameter": "5 mm"}, gearhead={"family": "GP 32 C"})
    assert {one.gearhead.family for one in (with_family.reported, *with_family.misses)} == {"GP 32 C"}
    assert "gearhead GP 32 C on motor 775: assumed to fit" in with_family.warnings
    any_motor = sized(catalogs=["andymark", "rev"], gearhead=GEARHEAD)
    assert any_motor.reported.gearhead.part == "P60 64:1" and any_motor.counts.considered > 5
    assert "gearhead P60 64:1 on motor any: assumed to fit" in any_motor.warnings


def test_an_actuator_with_figures_at_its_output():
    found = sized(actuator=ACTUATOR)
    assert found.reported.actuator.part == "worm 12 V"
    assert next(c for c in found.reported.checks if c.name == "motor_speed").limit == pytest.approx(60 * pi / 30)


def test_of_an_axis_of_a_machine():
    axes = {"up": {"load": WINCH["load"]}, "down": {"load": WINCH["load"], "select": {"motor": MOTOR}}}
    shared = {key: value for key, value in WINCH.items() if key != "load"}
    select = {"catalogs": ["basicmicro", "andymark"], "gearhead": GEARHEAD}
    found = size_machine(read_any(written({**shared, "select": select, "axes": axes})))
    assert [one.best.motor.part == "775" for one in found.axes] == [False, True]


@pytest.mark.parametrize(
    ("select", "said"),
    [
        ({"motor": {**MOTOR, "stall_current": "70 V"}}, 'select.motor.stall_current: "70 V": "V" is a unit of voltage'),
        ({"motor": {**MOTOR, "voltage": "12"}}, 'select.motor.voltage: "12" has no unit; expected voltage, e.g. 24 V'),
        ({"motor": {**MOTOR, "no_lod": "1 A"}}, 'select.motor.no_lod: unknown key "no_lod"; did you mean'),
        ({"motor": {**MOTOR, "nominal_voltage": "9 V"}}, "nominal_voltage is given twice, as voltage too"),
        ({"motor": {**MOTOR, "name": ""}}, 'select.motor.name: "" is no name of a part; expected e.g. "775"'),
        ({"motor": {**MOTOR, "mass": "-3 g"}}, 'select.motor.mass: "-3 g" is below 0'),
        ({"motor": {**MOTOR, "confidence": "sure"}}, 'confidence "sure" is not one of measured, quoted, secondary'),
        ({"motor": {"part": "775", "mass": "3 g"}}, "select.motor.mass: a part with figures of its own needs its name"),
        ({"motor": MOTOR, "actuator": ACTUATOR}, "give select.motor or select.actuator, not both"),
        ({"actuator": "775"}, '"775" is no part with figures of its own, {name: ..., ...}; expected one, or '),
        ({"gearhead": {**GEARHEAD, "ratio": "64 rpm"}}, 'ratio: "64 rpm" is not a number'),
    ],
)
def test_wrong_figures_are_one_line_with_the_field(select: dict[str, Any], said: str):
    assert said in refusal(lambda: load_spec({**WINCH, "select": select}), DrivesizerError, match=r"^spec: ")


def test_figures_that_contradict_each_other_are_said():
    wrong = sized(motor={**MOTOR, "stall_torque": "8 N m"}, gearhead=GEARHEAD)
    assert any("stall torque beside V I_A / w_0" in one for one in wrong.warnings)


def test_the_schema_takes_typed_parts():
    schema = Draft202012Validator(RobotSpec.model_json_schema())
    schema.validate({**WINCH, "select": {"motor": {**MOTOR, "nominal_torque": "70 mN*m"}, "gearhead": {"part": "x"}}})
    schema.validate({**WINCH, "select": {"actuator": ACTUATOR}})
