"""Actuators: one part to buy, motor and gearhead inside to compute with."""

from __future__ import annotations

from math import isnan, pi
from pathlib import Path

import numpy as np
import pytest

from drivesizer.catalog import load
from drivesizer.catalog.view import split_actuators
from drivesizer.results.drive_set import DriveSet
from drivesizer.simulate import validate
from drivesizer.sizing import explain
from drivesizer.spec.robot import load_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

RPM = 2 * pi / 60

# What the maker prints, and the same machine as motor and gearhead, by hand: i = 10, e = 0.9.
#   k_t 0.9 N*m/A / (10 x 0.9) = 0.1 N*m/A; 8.1 N*m / 9 = 0.9 N*m; J 0.0075 kg*m^2 / 100 = 750 g*cm^2; 228 rpm x 10,
#   which 24 V turn it to by the same k_t, for a speed limited by the controller inside has no relation to k_e.
WHOLE = """
catalog: 1
manufacturer: Example Actuators
sources: {sheet: {document: "sheet XA", confidence: quoted}}
actuators:
  - family: XA 70
    source: sheet
    common: {kind: brushless, gearing: planetary, pole_pairs: 14, thermal_resistance_winding: 1.2 K/W,
      thermal_resistance_housing: 3 K/W, max_winding_temperature: 120 degC, winding_time_constant: 30 s,
      motor_time_constant: 900 s, ambient_min: -20 degC, ambient_max: 60 degC, %s}
    columns: [part, reduction, ratio, efficiency (%%), nominal_voltage (V), no_load_speed (rpm), no_load_current (A),
      nominal_speed (rpm), nominal_torque (N*m), nominal_current (A), peak_torque (N*m), peak_current (A),
      torque_constant (N*m/A), resistance (ohm), output_inertia (kg*m^2), backlash (deg), mass (g), price (EUR)]
    rows:
      - [XA70-10, "10:1", 10, 90, 24, 228, 0.4, 190, 8.1, 9.4, 24, 28, 0.9, 0.3, 0.0075, 0.2, 520, 310]
"""
OWN_CONTROLLER = "controller: integrated, buses: CAN, supply_min: 18 V, supply_max: 52 V, steps_per_turn: 32768"
PIECES = Path(__file__).with_name("inside.yaml").read_text(encoding="utf-8")


@pytest.fixture
def shop(tmp_path, example_text):
    """The SPS robot by physics, without its choice of families, beside both catalogues."""
    text = example_text.replace("method: paper", "method: physics").replace("min: 22 V", "min: 23 V")
    text = text.partition("battery:")[0] + "environment:" + text.partition("environment:")[2]  # fed by the mains
    head, _, tail = text.partition("select:")
    rest = tail.partition("\n\n")[2]
    (tmp_path / "robot.yaml").write_text(
        f"{head}power_stage: {{voltage_drop: 0 V}}\n\nselect: {{catalogs: [whole.yaml, pieces.yaml, maxon]}}\n\n{rest}"
    )
    (tmp_path / "whole.yaml").write_text(WHOLE % OWN_CONTROLLER)
    (tmp_path / "pieces.yaml").write_text(PIECES)
    return tmp_path


def one(shop, motor: str, gearhead: str = "") -> DriveSet:
    return explain(load_spec(shop / "robot.yaml"), motor, gearhead)[0]


def test_the_motor_inside_has_the_figures_of_the_rotor(shop):
    split = split_actuators(load(["whole.yaml"], beside=shop))
    motor = split.motors.record(split.motors.rows["XA70-10"])
    assert motor.torque_constant == pytest.approx(0.1)
    assert motor.nominal_torque == pytest.approx(0.9)
    assert motor.rotor_inertia == pytest.approx(750e-7)
    assert motor.no_load_speed == pytest.approx(2280 * RPM)
    assert motor.nominal_speed == pytest.approx(1900 * RPM)
    assert (motor.resistance, motor.no_load_current, motor.nominal_current) == (0.3, 0.4, 9.4)
    assert motor.max_speed == motor.no_load_speed  # none is printed: where it runs without load, it may run
    assert (motor.mass, motor.price) == (0.52, 310.0)


def test_a_rotor_constant_that_is_printed_goes_before_the_outputs(shop):
    text = (WHOLE % OWN_CONTROLLER).replace("torque_constant (N*m/A)", "motor_torque_constant (N*m/A)")
    (shop / "whole.yaml").write_text(text.replace("28, 0.9, 0.3", "28, 0.11, 0.3"))
    split = split_actuators(load(["whole.yaml"], beside=shop))
    assert split.motors["torque_constant"][split.motors.rows["XA70-10"]] == pytest.approx(0.11)


def test_the_whole_does_what_its_pieces_do(shop):
    """An actuator and the same motor and gearhead as two parts: every demand and limit of the physics agrees."""
    whole, pieces = one(shop, "XA70-10"), one(shop, "XM-1", "XG-10")
    beside = {c.name: c for c in pieces.checks}
    compared = [c for c in whole.checks if not c.name.startswith(("controller", "encoder", "supply_voltage", "bus"))]
    assert len(compared) > 8
    for check in compared:
        if check.name != "overcurrent_time":
            assert check.demand == pytest.approx(beside[check.name].demand, rel=1e-9, nan_ok=True), check.name
            assert check.limit == pytest.approx(beside[check.name].limit, rel=1e-9, nan_ok=True), check.name
    assert whole.mass == pytest.approx(0.52)
    assert pieces.mass == pytest.approx(0.52 + 0.020 + 0.045)  # with an encoder and a controller that are not listed


def test_it_is_one_part_in_the_set(shop):
    found = one(shop, "XA70-10")
    assert list(found.parts) == ["actuator"]  # its encoder and controller are inside
    assert found.label == "XA 70 XA70-10 (10:1 inside) + belt 1.1"
    assert found.mass_of == ("actuator",)
    assert found.encoder and found.encoder.counts_per_turn == 32768 / 4 / 10  # at the motor, in lines of four edges
    assert found.controller and found.controller.inside == "XA70-10"
    assert found.controller.continuous_current == 9.4


def test_one_without_a_controller_takes_one_from_the_shelf(shop):
    (shop / "whole.yaml").write_text(WHOLE % "direction: 1")
    found = one(shop, "XA70-10")
    assert found.controller and found.controller.manufacturer == "maxon" and not found.controller.inside
    assert list(found.parts) == ["actuator", "encoder", "controller"] and found.encoder is None


def test_a_controller_inside_that_lacks_the_bus_is_none(shop):
    spec = load_spec(shop / "robot.yaml")
    choice = spec.select.controller.model_copy(update={"bus": "EtherCAT"})
    narrowed = spec.model_copy(update={"select": spec.select.model_copy(update={"controller": choice})})
    found = explain(narrowed, "XA70-10")[0]
    assert found.controller is None
    assert {c.name: c.status for c in found.checks}["controller_available"] == "fail"


def test_absolute_encoders_count_as_lines_of_four_edges(shop):
    (shop / "own.yaml").write_text(
        "catalog: 1\nmanufacturer: Own\nsources: {s: {document: sheet, confidence: quoted}}\nencoders:\n"
        "  - {family: XE, source: s, columns: [part, steps_per_turn, max_speed (rpm)], rows: [[XE-1, 4096, 9000]]}\n"
        "motors:\n  - {family: XM, source: s, columns: [part], rows: [[XM-2]]}\n"
        "compatibility: {motor_encoder: [{source: s, motors: [XM-2], encoders: [XE]}]}\n"
    )
    catalog = load(["own.yaml"], beside=shop)
    encoder = catalog.encoders.record(0)
    assert encoder.lines == 1024 and encoder.resolution == "4096 steps per turn"
    assert np.isnan(catalog.encoders["counts_per_turn"][0])


# --- identified friction


def rubbing(shop, *, efficiency: str = "90", idle: str = "0.4", stall: str = "") -> None:
    """The actuator with friction: 0.3 N*m and 0.02 N*m*s/rad at the output, and a quarter of the load."""
    columns = "price (EUR), coulomb_friction (N*m), viscous_friction (N*m*s/rad), load_friction (%)"
    columns += ", stall_torque (N*m)]" if stall else "]"
    text = (WHOLE % OWN_CONTROLLER).replace("price (EUR)]", columns)
    text = text.replace(", 10, 90, 24, 228, 0.4,", f", 10, {efficiency}, 24, 228, {idle},")
    text = text.replace("torque_constant (N*m/A)", "motor_torque_constant (N*m/A)").replace(
        "28, 0.9, 0.3", "28, 0.1, 0.3"
    )
    (shop / "whole.yaml").write_text(text.replace("520, 310]", f"520, 310, 0.3, 0.02, 25{stall and f', {stall}'}]"))


@pytest.mark.parametrize(
    ("given", "efficiency"),
    [
        pytest.param({}, 0.9, id="beside a no-load current"),
        pytest.param({"efficiency": "~"}, 1 / 1.25, id="none: by the share of the load"),
        pytest.param({"idle": "~"}, 1 / (1 / 0.9 - 0.3 / 8.1), id="of the nominal point"),
        pytest.param({"idle": "~", "stall": "60"}, 1 / (1 / 0.9 - 0.3 / 60), id="of stall"),
        pytest.param({"idle": "~", "efficiency": "99"}, 1.0, id="all of it"),
    ],
)
def test_each_loss_of_an_actuator_counts_once(shop, given, efficiency):
    rubbing(shop, **given)
    split = split_actuators(load(["whole.yaml"], beside=shop))
    motor, gearhead = (table.record(table.rows["XA70-10"]) for table in (split.motors, split.gearheads))
    assert motor.friction_torque == pytest.approx(0.03) and motor.viscous_friction == pytest.approx(0.0002)
    assert gearhead.efficiency == pytest.approx(efficiency) and isnan(gearhead.no_load_torque)
    assert motor.nominal_torque == pytest.approx(8.1 / (10 * efficiency))


WINCH = """
name: winch
load: {kind: hoist, mass: 40 kg, drum_diameter: 60 mm}
motion: {profile: trapezoid, speed: 0.2 m/s, acceleration_time: 0.2 s, cruise_time: 30 s}
transmission: [{kind: gearhead}]
supply: {nominal: 24 V, min: 24 V, max: 24 V}
select: {catalogs: [whole.yaml]}
"""


@pytest.mark.parametrize("efficiency", ["90", "~"])
def test_sizing_and_closed_loop_have_the_same_friction(shop, efficiency):
    """At constant speed, by hand: (m g r (1 + s) + M_c + b w) / (i k_t), s where there is no efficiency."""
    rubbing(shop, efficiency=efficiency)
    (shop / "winch.yaml").write_text(WINCH)
    spec = load_spec(shop / "winch.yaml")
    drive = explain(spec, "XA70-10")[0]
    found = validate(spec, drive)
    w = 0.2 / 0.03
    share = 1.25 if efficiency == "~" else 1 / 0.9
    current = (40 * 9.80665 * 0.03 * share + 0.3 + 0.02 * w) / (10 * 0.1)
    cruise = (found.series["time"] > 5.0) & (found.series["time"] < 30.0)
    assert found.series["current"][cruise].mean() == pytest.approx(current, rel=1e-3)  # its encoder's counts add ripple
    rms = {f.name: f.value for f in found.figures}["rms_current"]
    sized = {c.name: c.demand for c in drive.checks}["motor_nominal_current"]
    assert rms == pytest.approx(sized, rel=1e-2) and sized == pytest.approx(current, rel=1e-2)
