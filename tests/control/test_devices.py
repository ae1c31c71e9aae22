"""Gains in controllers' own units: figures worked by hand from the makers' sources, and back again."""

from __future__ import annotations

import json
import math
import re
from configparser import ConfigParser
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml
from typer.testing import CliRunner

from drivesizer.cli import app
from drivesizer.control.devices import device_of, devices, gain_figures, read_back, written
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
    velocity_period=1e-3, position_period=1e-3, counted_over=4, feedforward_acceleration=6e-4,
    feedforward_velocity=1e-4, feedforward_friction=0.03,
)  # fmt: skip
OTHERS = {"i": 9.0, "p": 7.0, "V": 24.0, "counts": 8192.0, "omega": 200.0, "alpha": 900.0, "I_max": 30.0,
          "I_cont": 10.0, "M_max": 2.0, "tau_w": 12.0}  # fmt: skip
STEPPER = {  # 40 mm a turn, 200 full steps, 16 microsteps, 0.3 m/s, 3 m/s², 1.4 A of which half at rest
    "turn": 0.04, "mm": 1e3, "full": 200.0, "microsteps": 16.0, "v": 0.3, "a": 3.0, "I_rms": 1.4, "I_hold": 0.7,
    "R_s": 0.075, "K_pos": 0.0, "omega": 0.3 / 0.04 * 2 * math.pi, "alpha": 3.0 / 0.04 * 2 * math.pi,
}  # fmt: skip
BOARD = {"A_per_count": 2e-3, "V_per_count": 1e-3}


def figures_of(device):
    if device.structure == "steps":
        return STEPPER
    gains = {
        "voltage": Gains(kp=0.1, ki=2.0, kd=0.0, filter_time=0.0, period=1e-3, counted_over=4, rule="", source=""),
        "servo": Gains(kp=0.0, ki=0.6, kd=0.0, filter_time=0.0, period=1e-3, counted_over=4, rule="", source=""),
    }.get(device.structure, CASCADE)  # fmt: skip
    # ten amperes at most where a servo counts milliamperes
    less = {"I_max": 3.0, "omega": 30.0, "alpha": 300.0} if device.structure == "servo" else {}
    return gain_figures(gains, TRAIN, phase=device.phase) | OTHERS | BOARD | less


def values_of(name):
    found = written(devices()[name], figures_of(devices()[name]))
    return {row.parameter.name: row.value for row in found.rows}, found.left_out


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
    "spark": {"closedLoop.slot1.p": 2.0 * 2 * math.pi / 12, "closedLoop.slot1.d": 0.1 * 2 * math.pi / 12 / 1e-3,
              "closedLoop.p": 0.1 * (2 * math.pi / 60) / 12, "closedLoop.i": 2.0 * (2 * math.pi / 60) / 12 * 1e-3,
              "feedForward.kV": 2 * math.pi / 60 * (K_T + 1e-5 * 0.2 / K_T)},
    "epos4": {"0x30A0:01": 400_000.0, "0x30A0:02": 800_000.0, "0x30A2:01": 500_000.0, "0x30A2:02": 10_000_000.0,
              "0x30A1:01": 17_500_000.0, "0x30A1:02": 150_000_000.0, "0x3001:05": 70_000.0},
    "ros2_control": {"joint_trajectory_controller.ros__parameters.gains.JOINT.d": 81.0 * 0.5 * K_T},
    "ax8000": {"30C0:01": 15.0, "3140:01": 0.5 * K_T, "3140:02": 0.05},
    "el72xx": {"8011:12": 4.0, "8011:11": 5.0, "8011:14": 500.0, "8011:13": 500.0, "8011:17": 15.0},
    "sinamics": {"p1460": 0.5 * K_T, "p1462": 50.0, "p1715": 0.4, "p1717": 0.5},
    "klipper": {"stepper_x.rotation_distance": 40.0, "printer.max_velocity": 300.0, "printer.max_accel": 3000.0,
                "tmc5160 stepper_x.run_current": 1.4},
    "grbl": {"$100": 80.0, "$110": 18_000.0, "$120": 3000.0},
    "marlin": {"M92 X": 80.0, "M203 X": 300.0, "M201 X": 3000.0, "M906 X": 1400.0},
    # 24 000 microsteps a second and 240 000 a second squared, in 2^24/12 MHz and 2^41/(12 MHz)²; 1.4 A at 75 mΩ is
    # 117 of 256, and all of 32 steps of that
    "tmc5160": {"GLOBALSCALER": 117.0, "IHOLD_IRUN.IRUN": 31.0, "IHOLD_IRUN.IHOLD": 15.0, "CHOPCONF.MRES": 4.0,
                "VMAX": 33_554.0, "AMAX": 3_665.0},
    # 0.1 V·s/rad of 24 V at 240 rad/s is 1.0 of full scale
    "roboteq-1.8": {"KP": 10.0, "KI": 200.0, "MXRPM": 2292.0},
    "roboteq-2.0": {"KP": 1_000_000.0, "KI": 20_000_000.0, "ALIM": 300.0},
    "roboclaw": {"QPPS": 447_008.0, "P": round(65536 * 0.1 / K_T), "I": round(65536 * 2.0 / K_T)},
    "dynamixel-x": {"Position_P_Gain(84)": round(173.8 * 9 * 0.6 / 24.0), "Profile_Velocity(112)": 139.0,
                    "Current_Limit(38)": 1115.0},
    "dynamixel-xl330": {"Position_P_Gain(84)": round(347.5 * 9 * 0.6 / 24.0)},
    "dynamixel-mx": {"P_Gain(28)": round(9 * 0.6 / 24.0 / 0.158)},
    "feetech-sts": {"P(21)": round(9 * 0.6 / 24.0 / 0.166), "acceleration(41)": 217.0},
    "spark-25": {"closedLoop.velocityFF": 2 * math.pi / 60 * (K_T + 1e-5 * 0.2 / K_T) / 12},
    "escon": {"Speed_constant": KV, "Set_value_scaling_at_10_V": 2292.0},
    "epos2": {"Nominal_current": 10_000.0, "Thermal_time_constant_winding": 120.0},
    "tmc4671": {"PID_TORQUE_P_(0x56)": round(256 * 0.2 * 2.0), "velocity_P": 0.5 * K_T / K_PH},
    "kinetix": {"PositionLoopBandwidth": 15.0 / (2 * math.pi), "VelocityLoopBandwidth": 0.5 / (2 * math.pi * 6e-4)},
}  # fmt: skip


@pytest.mark.parametrize("name", BY_HAND)
def test_parameters_are_those_worked_by_hand(name):
    values, _ = values_of(name)
    assert {one: values[one] for one in BY_HAND[name]} == pytest.approx(BY_HAND[name], rel=2e-4)


def test_the_printed_example_of_a_vesc():
    """2.094 Kv/(p I_max): 4.99e-4 with 0.1 A·s/rad, 7 pole pairs and 60 A; the tool rounds to 5 decimals."""
    figures = gain_figures(CASCADE, TRAIN, phase=True) | OTHERS | {"A_p": 0.1, "I_max": 60.0}
    row = next(row for row in written(devices()["vesc"], figures).rows if row.parameter.name == "s_pid_kp")
    assert (row.exact, row.text) == (pytest.approx(4.99e-4, rel=1e-3), "0.00050")


def test_an_integral_too_large_for_microamperes_is_given_in_milliamperes():
    """0x30A1:02 has 32 bits, 4295 A/(rad·s); from firmware 0x0170 on 0x30A1:09 chooses the unit, and goes first."""
    figures = figures_of(devices()["epos4"]) | {"ki": 5000.0 * K_T}
    values = {row.parameter.name: row.value for row in written(devices()["epos4"], figures).rows}
    assert values["0x30A1:02"] == 5_000_000 and values["0x30A1:09"] == 0xFD040300
    assert [*values].index("0x30A1:09") < [*values].index("0x30A1:02") and "0x30A1:09" not in values_of("epos4")[0]


@pytest.mark.parametrize("name", devices())
def test_a_round_trip_from_the_controller_to_si_and_back(name):
    """What is written stands for figures from which the same is written; they are off by the rounding at most."""
    device, figures = devices()[name], figures_of(devices()[name])
    found = written(device, figures)
    assert found.rows and not found.refused
    back = read_back(found.rows)
    one_each = [row for row in found.rows if not math.isnan(row.si) and back[row.parameter.figure] == row.si]
    again = {row.parameter.name: row.text for row in written(device, figures | back).rows}
    assert {row.parameter.name: again[row.parameter.name] for row in one_each} == {
        row.parameter.name: row.text for row in one_each
    }
    known = figures | {row.parameter.name: row.value for row in found.rows}
    for row in one_each:
        half = 0.5 * 10.0**-row.parameter.decimals if row.parameter.rounding != "float" else 1e-7 * abs(row.exact)
        assert row.parameter.at(known | {row.parameter.figure: row.si}) == pytest.approx(row.value, abs=1.01 * half)


def test_what_is_unknown_is_left_out_and_what_a_controller_cannot_express_is_refused():
    known = gain_figures(CASCADE, TRAIN, phase=True) | OTHERS
    found = written(devices()["vesc"], known | {"p": math.nan})
    assert any("foc_motor_flux_linkage" in one and one.endswith(": unknown pole pairs") for one in found.left_out)
    assert not any(math.isnan(row.value) for row in found.rows)
    assert written(devices()["vesc"], known | {"A_i": 1e-9}).refused == [
        "s_pid_ki, speed loop, I, would be 9.973e-12 1/(20 ERPM·s), less than the controller can express"
    ]
    (one,) = written(devices()["feetech-sts"], figures_of(devices()["feetech-sts"]) | {"volt_i": 200.0}).refused
    assert one == "P(21), position, P, would be 451.8, and it takes 0 to 254"
    slow = written(devices()["moteus"], known | {"omega": 1e5}).left_out
    assert slow[0].startswith("servo.max_velocity") and slow[0].endswith("rev/s, and it takes 0 to 467")


def test_the_controller_is_found_by_name_part_and_firmware():
    assert device_of(None, "EPOS4 Compact 50/5 541718").name == "epos4"
    assert device_of("odrive", "", "0.5.6").name == "odrive-0.5"
    assert device_of(None, "moteus moteus r4.11", "0x0109").name == "moteus-old"
    assert device_of("roboteq", "", "1.8").name == "roboteq-1.8"
    assert device_of(None, "Dynamixel XM430 XM430-W350").name == "dynamixel-x"
    assert device_of(None, "ST ST-3215-C001").name == "feetech-sts"
    for (name, controller, firmware), said in {
        ("odriv", "", None): '--device: "odriv" is not known; the nearest are odrive',
        ("odrive", "", None): '--device: of "odrive" the firmware decides; expected --firmware, 0.5 to below 0.6',
        ("roboteq", "", "2.1"): '--firmware: "2.1" is not known of roboteq; expected 0 to below 2.0',
        ("roboteq", "", "new"): '--firmware: "new" is no version; expected e.g. 0.5.6 or 0x010e',
        ("vesc", "", "6.0"): "--firmware: it decides nothing of VESC",
        (None, "B15A B12A6", None): '--device: nothing is known of "B15A B12A6"; expected one of odrive-0.5',
    }.items():
        with pytest.raises(InputError, match=re.escape(said)):
            device_of(name, controller, firmware)


@pytest.mark.parametrize("name", devices())
def test_the_file_has_every_parameter(name, tmp_path):
    device = devices()[name]
    rows = written(device, figures_of(device)).rows
    path = tmp_path / f"drive{device_file.suffix_of(device)}"
    device_file.accept(device, path)
    made = device_file.files(device, rows, ["read back"], path)
    body = made[path].decode()
    if path.suffix == ".json":
        assert json.loads(body)["axis0"]["controller"]["config"]["pos_gain"] == 15.0
    elif path.suffix == ".xml":
        assert {one.tag for one in ElementTree.fromstring(body) if isinstance(one.tag, str)} == {
            row.parameter.name for row in rows}  # fmt: skip
    elif path.suffix == ".yaml":
        gains_of = yaml.safe_load(body)["joint_trajectory_controller"]["ros__parameters"]["gains"]
        assert gains_of["JOINT"]["d"] == pytest.approx(81.0 * 0.5 * K_T)
    else:
        assert all(row.text in body for row in rows) and any(b"read back" in text for text in made.values())
    if path.suffix == ".cfg":
        sections = ConfigParser()
        sections.read_string(body)
        assert sections["stepper_x"]["rotation_distance"] == "40" and sections["printer"]["max_accel"] == "3000"


def test_a_drive_is_commissioned(tmp_path, monkeypatch):
    """The paper's robot with its EPOS4: what is written is simulated after rounding, and loses no margin."""
    spec = Path(__file__).resolve().parents[2] / "examples" / "sps_robot.yaml"
    monkeypatch.chdir(tmp_path)
    slower = ["--set", "control.bandwidth=10 Hz"]
    found = CliRunner().invoke(app, ["commission", str(spec), *slower, "-o", "drive.dcf"])
    assert found.exit_code == 0, found.output
    text = Path("drive.dcf").read_text(encoding="utf-8")
    assert "[30A0sub1]\nParameterName=current controller P gain\nParameterValue=" in text
    assert "with these figures: pass" in found.output and "0.00° lost by rounding" in found.output
    # validate --device simulates what is written
    proof = CliRunner().invoke(app, ["validate", str(spec), *slower, "--device", "epos4", "--checks", "--json"])
    (axis,) = json.loads(proof.stdout)["axes"]
    gains = {row["place"]: row["value"] for row in axis["validations"][0]["controller_gains"]}
    assert f"[30A2sub1]\nParameterName=velocity controller P gain\nParameterValue={gains['0x30A2:01']}\n" in text


REFUSED = {  # options, and what is said of them
    ("--device", "moteus"): "drives brushless motors; RE 25 118752 is brushed",
    ("--device", "klipper"): "drives steppers; RE 25 118752 runs in a closed loop",
    ("--device", "el72xx"): "all that is known of Beckhoff EL72xx is from memory alone; expected --unconfirmed",
    ("--device", "epos4", "-o", "drive.json"): "expected a file that ends in .dcf",
    ("--device", "epos4", "--setting", "R_s=0.1"): '"R_s=0.1" is no setting of maxon EPOS4; expected NAME=VALUE',
    ("--device", "ax5000", "--set", "control.structure=cascade", "--set", "control.bandwidth=", "--set",
     "control.position={}"): "control.position: Beckhoff AX5000 cannot express it: it has no position loop here",
    ("--device", "epos4", "--set", "control.structure=cascade", "--set", "control.bandwidth=", "--set",
     "control.velocity={kd: 0.01}"): "control.velocity.kd: maxon EPOS4 cannot express it: it has no place for it",
    ("--device", "epos4", "--set", "control.kp=0.1", "--set", "control.bandwidth="):
        "control.kp: maxon EPOS4 cannot express it: it has current and velocity loops; expected structure: cascade",
    ("--device", "roboteq-1.8", "--set", "control.bandwidth=", "--set", "control.kp=5",
     "--unconfirmed"): "cannot express KP",
}  # fmt: skip


@pytest.mark.parametrize("options", REFUSED, ids=" ".join)
def test_what_a_controller_cannot_express_is_one_line_and_nothing_is_written(options, tmp_path, monkeypatch):
    spec = Path(__file__).resolve().parents[2] / "examples" / "sps_robot.yaml"
    monkeypatch.chdir(tmp_path)
    found = CliRunner().invoke(app, ["commission", str(spec), "--set", "118752/406764", "-o", "drive.dcf", *options])
    if "-o" not in options:
        found = CliRunner().invoke(app, ["commission", str(spec), "--set", "118752/406764", *options])
    said = str(found.exception)
    assert isinstance(found.exception, InputError) and REFUSED[options] in said and "\n" not in said
    assert not list(tmp_path.iterdir())
