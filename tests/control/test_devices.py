"""Gains in controllers' own units: figures worked by hand from the makers' sources, and back again."""

from __future__ import annotations

import json
import math
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml
from typer.testing import CliRunner

from drivesizer.cli import app
from drivesizer.control.devices import device_of, devices, gain_figures, written
from drivesizer.control.drive_train import DriveTrain
from drivesizer.control.validation import Cascade, Gains
from drivesizer.errors import InputError
from drivesizer.output.export import device_file

K_T, KV = 0.07, 60.0 / (2.0 * math.pi * 0.07)  # N·m/A of block commutation, rpm/V
TRAIN = DriveTrain(
    friction=2e-3, motor_inertia=2e-5, gear_ratio=9.0, gear_efficiency=1.0, belt_ratio=1.0, belt_efficiency=1.0,
    load_inertia=1e-3, radius=1.0, forward_torque=0.0, backward_torque=0.0, rest_torque=0.0, resistance=0.2,
    inductance=1e-4, torque_constant=K_T, back_emf_constant=K_T, viscous=1e-5,
)  # fmt: skip
CASCADE = Cascade(
    current_kp=0.4, current_ki=800.0, velocity_kp=0.5, velocity_ki=10.0, position_kp=15.0, current_period=5e-5,
    velocity_period=1e-3, position_period=1e-3, feedforward_acceleration=6e-4, feedforward_velocity=1e-4,
    feedforward_friction=0.03,
)  # fmt: skip
OTHERS = {"i": 9.0, "p": 7.0, "V": 24.0, "counts": 8192.0, "omega": 200.0, "alpha": 900.0, "I_max": 30.0,
          "I_cont": 10.0, "M_max": 2.0}  # fmt: skip


def values_of(name):
    device = devices()[name]
    gains = Gains(kp=0.1, ki=2.0, kd=0.0, filter_time=0.0, period=1e-3, rule="", source="") \
        if device.structure == "voltage" else CASCADE  # fmt: skip
    figures = gain_figures(gains, TRAIN, phase=device.phase) | OTHERS
    rows, left_out = written(device, figures)
    return {row.parameter.name: row.value for row in rows}, left_out


K_PH = 8.27 / KV  # as ODrive and moteus say it
BY_HAND = {  # from the sources that devices.yaml names
    "odrive-0.5": {
        "axis0.controller.config.pos_gain": 15.0, "axis0.controller.config.vel_gain": 2 * math.pi * 0.5 * K_T,
        "axis0.controller.config.vel_integrator_gain": 2 * math.pi * 10.0 * K_T,
        "axis0.controller.config.inertia": 2 * math.pi * 6e-4 * K_T, "axis0.motor.config.torque_constant": K_PH,
        "axis0.motor.config.current_control_bandwidth": 0.2 / 5e-5, "axis0.motor.config.pole_pairs": 7.0,
    },
    "moteus": {
        "servo.pid_position.kd": 2 * math.pi * 81.0 * 0.5 * K_T,
        "servo.pid_position.kp": 2 * math.pi * 81.0 * 0.5 * K_T * (15.0 + 20.0),
        "servo.pid_position.ki": 2 * math.pi * 81.0 * 0.5 * K_T * 15.0 * 20.0, "motor.Kv": KV, "motor.poles": 14.0,
        "servo.pid_dq_hz": 0.2 / (2 * math.pi * 5e-5), "motor_position.rotor_to_output_ratio": 1 / 9.0,
    },
    "vesc": {
        "foc_motor_flux_linkage": 60 / (2 * math.pi * math.sqrt(3) * KV * 7), "foc_current_kp": 0.2,
        "s_pid_kp": round(2.094 * (0.5 * K_T / K_PH) / (7 * 30.0), 5), "l_max_erpm": 1.2 * 200 * 60 / (2 * math.pi) * 7,
    },
    "simplefoc": {"MAP": 15.0, "MVP": 0.5 * K_T / K_PH, "MVI": 10.0 * K_T / K_PH, "MQP": 0.2},
    "phoenix-6": {"Slot0.kP": 2 * math.pi * 9 * 0.1, "Slot0.kI": 2 * math.pi * 9 * 2.0,
                  "Slot0.kS": 2e-3 * 0.2 / K_T},
    "spark": {"closedLoop.p": 0.1 * (2 * math.pi / 60) / 12, "closedLoop.i": 2.0 * (2 * math.pi / 60) / 12 * 1e-3,
              "feedForward.kV": 2 * math.pi / 60 * (K_T + 1e-5 * 0.2 / K_T)},
    "epos4": {"0x30A0:01": 400_000.0, "0x30A0:02": 800_000.0, "0x30A2:01": 500_000.0, "0x30A2:02": 10_000_000.0,
              "0x30A1:01": 17_500_000.0, "0x30A1:02": 150_000_000.0, "0x3001:05": 70_000.0},
    "ros2_control": {"joint_trajectory_controller.ros__parameters.gains.JOINT.d": 81.0 * 0.5 * K_T},
    "ax8000": {"30C0:01": 15.0, "3140:01": 0.5 * K_T, "3140:02": 0.05},
    "el72xx": {"8011:12": 4.0, "8011:11": 5.0, "8011:14": 500.0, "8011:13": 500.0, "8011:17": 15.0},
    "sinamics": {"p1460": 0.5 * K_T, "p1462": 50.0, "p1715": 0.4, "p1717": 0.5},
    "kinetix": {"PositionLoopBandwidth": 15.0 / (2 * math.pi), "VelocityLoopBandwidth": 0.5 / (2 * math.pi * 6e-4)},
}  # fmt: skip


@pytest.mark.parametrize("name", BY_HAND)
def test_parameters_are_those_worked_by_hand(name):
    values, _ = values_of(name)
    assert {one: values[one] for one in BY_HAND[name]} == pytest.approx(BY_HAND[name], rel=2e-4)


def test_the_printed_example_of_a_vesc():
    """2.094 Kv/(p I_max): 4.99e-4 with 0.1 A·s/rad, 7 pole pairs and 60 A; the tool rounds to 5 decimals."""
    figures = gain_figures(CASCADE, TRAIN, phase=True) | OTHERS | {"A_p": 0.1, "I_max": 60.0}
    row = next(row for row in written(devices()["vesc"], figures)[0] if row.parameter.name == "s_pid_kp")
    assert (row.exact, row.text) == (pytest.approx(4.99e-4, rel=1e-3), "0.00050")


def test_what_is_unknown_or_too_small_is_left_out_by_name():
    figures = gain_figures(CASCADE, TRAIN, phase=True) | OTHERS | {"p": math.nan, "A_i": 1e-9}
    rows, left_out = written(devices()["vesc"], figures)
    assert any("foc_motor_flux_linkage" in one and one.endswith(": unknown pole pairs") for one in left_out)
    assert not any(math.isnan(row.value) for row in rows)
    assert device_of(None, "EPOS4 Compact 50/5 541718").name == "epos4"
    with pytest.raises(InputError, match='--device: "odriv" is not known; the nearest are odrive'):
        device_of("odriv", "")


@pytest.mark.parametrize("name", devices())
def test_the_file_has_every_parameter(name, tmp_path):
    device = devices()[name]
    gains = Gains(kp=0.1, ki=2.0, kd=0.0, filter_time=0.0, period=1e-3, rule="", source="") \
        if device.structure == "voltage" else CASCADE  # fmt: skip
    rows, _ = written(device, gain_figures(gains, TRAIN, phase=device.phase) | OTHERS)
    path = tmp_path / f"drive{device_file.SUFFIXES[device.words['form']]}"
    device_file.accept(device, path)
    body = device_file.files(device, rows, ["read back"], path)[path].decode()
    if path.suffix == ".json":
        assert json.loads(body)["axis0"]["controller"]["config"]["pos_gain"] == 15.0
    elif path.suffix == ".xml":
        assert {one.tag for one in ElementTree.fromstring(body) if isinstance(one.tag, str)} == {
            row.parameter.name for row in rows}  # fmt: skip
    elif path.suffix == ".yaml":
        gains_of = yaml.safe_load(body)["joint_trajectory_controller"]["ros__parameters"]["gains"]
        assert gains_of["JOINT"]["d"] == pytest.approx(81.0 * 0.5 * K_T)
    else:
        assert all(row.text in body for row in rows) and "read back" in body


def test_a_drive_is_commissioned(tmp_path, monkeypatch):
    """The paper's robot with its EPOS4: what is written is simulated after rounding, and loses no margin."""
    spec = Path(__file__).resolve().parents[2] / "examples" / "sps_robot.yaml"
    monkeypatch.chdir(tmp_path)
    found = CliRunner().invoke(app, ["commission", str(spec), "-o", "drive.dcf"])
    assert found.exit_code == 0, found.output
    text = Path("drive.dcf").read_text(encoding="utf-8")
    assert "[30A0sub1]\nParameterName=current controller P gain\nParameterValue=" in text
    assert "with these gains: pass" in found.output and "0.00° lost by rounding" in found.output
    refused = CliRunner().invoke(app, ["commission", str(spec), "--device", "moteus"])
    assert "drives brushless motors; RE 25 118752 is brushed" in str(refused.exception)
    wrong = CliRunner().invoke(app, ["commission", str(spec), "-o", "drive.json"])
    assert "expected a file that ends in .dcf" in str(wrong.exception)
