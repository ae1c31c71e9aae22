"""A stepper simulated by ``validate``: lost steps, what it rests on, every output, and exports."""

from __future__ import annotations

import json
import math
import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import yaml
from exports import rendered
from refusals import refusal

from drivesizer import load_spec, size
from drivesizer.control.validation import Stepping, Validation
from drivesizer.errors import InputError, NoLoopError
from drivesizer.output.export import Export, export_of
from drivesizer.output.json.documents import as_text
from drivesizer.results.drive_set import DriveSet
from drivesizer.simulate import validate, validate_all, with_remedies
from drivesizer.sizing import explained

RPM = math.pi / 30.0
PARTS = Path(__file__).with_name("simulate_stepper.yaml").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    found = tmp_path_factory.mktemp("pulses") / "steps.yaml"
    found.write_text(PARTS, encoding="utf-8")
    return found


def spec_of(path: Path, **changes: Any) -> dict[str, Any]:
    given: dict[str, Any] = {
        "name": "table",
        "load": {"kind": "flywheel", "inertia": "4e-4 kg*m^2"},
        "motion": {"speed": "300 rpm", "acceleration_time": "0.15 s", "cruise_time": "0.1 s", "rest_time": "0.1 s"},
        "transmission": [{"kind": "direct"}],
        "supply": {"nominal": "24 V", "accepts": "all"},
        "select": {"catalogs": [str(path)], "motor": {"kind": "stepper", "part": "A2"}},
    }
    for name, value in changes.items():
        given[name] = {**given.get(name, {}), **value} if isinstance(value, dict) else value
    return given


@cache
def drive(path: Path) -> DriveSet:
    return explained(load_spec(spec_of(path)), "A2", "direct").sets[0]


def simulated(path: Path, **changes: Any) -> Validation:
    return validate(load_spec(spec_of(path, **changes)), drive(path))


def check(proof: Validation, name: str) -> Any:
    return next(one for one in proof.checks if one.name == name)


@pytest.fixture(scope="module")
def proof(path: Path) -> Validation:
    return simulated(path)


def test_a_drive_that_passes_loses_no_step(proof: Validation) -> None:
    """(4e-4 + 82e-7) kg*m^2 to 300 rpm in 0.15 s take 0.0855 N*m: 0.204 of 0.42; swings add up to as much again."""
    needed = (4e-4 + 82e-7) * 300 * RPM / 0.15 / 0.42
    assert proof.status == "pass"
    assert check(proof, "lost_steps").status == "pass"
    assert needed < check(proof, "pull_out_share").demand < 2.0 * needed
    assert math.asin(needed) < check(proof, "load_angle").demand < 2.2 * math.asin(needed)
    assert check(proof, "load_angle").advice
    swings = next(one.value for one in proof.figures if one.name == "natural_frequency")
    assert swings == pytest.approx(math.sqrt(50 * 0.42 / 4.082e-4) / (2 * math.pi), rel=1e-6)


def test_twice_the_share_is_the_margin(path: Path, proof: Validation) -> None:
    """With less time to accelerate steps are lost from where the torque is more than there is."""
    share = check(proof, "pull_out_share").demand
    quick = simulated(path, motion={"acceleration_time": f"{0.15 * share * 0.6} s"})
    assert quick.status == check(quick, "lost_steps").status == "fail"
    assert check(quick, "pull_out_share").demand > 1.0
    assert next(one.value for one in quick.figures if one.name == "lost_steps") >= 4
    assert any("steps are lost from" in one for one in quick.warnings)
    assert "gearhead_intermittent_torque" not in {one.name for one in quick.checks}


def test_the_start_without_a_ramp_is_simulated(path: Path) -> None:
    """Undamped by the balance of energy: w = 2 sqrt(T / (p J)) starts with all of the torque."""
    limit = 2.0 * math.sqrt(0.42 / (50 * 4.082e-4)) / RPM
    for part, status in ((0.8, "pass"), (1.2, "fail")):
        found = check(simulated(path, needs={"start_speed": f"{part * limit} rpm"}), "start_share")
        assert found.status == status
        assert found.demand == pytest.approx(part**2, rel=0.02)


def test_full_steps_shake_more_than_microsteps(path: Path, proof: Validation) -> None:
    full = simulated(path, control={"microsteps": 1})
    assert check(full, "load_angle").demand > 2.0 * check(proof, "load_angle").demand
    assert isinstance(full.gains, Stepping) and full.gains.microsteps == 1.0
    calm = simulated(path, control={"microsteps": 1, "damping_ratio": 0.4})
    assert check(calm, "load_angle").demand < check(full, "load_angle").demand


def test_finer_steps_are_the_cure_that_is_tried(path: Path) -> None:
    """Full steps at 43.3 a second meet the natural frequency of 36.1 Hz and shake the rotor out of step."""
    slow = {"speed": "13 rpm", "acceleration_time": "0.3 s", "cruise_time": "1 s"}
    full = simulated(path, motion=slow, control={"microsteps": 1})
    assert full.status == "fail"
    cured = with_remedies(full, load_spec(spec_of(path, motion=slow, control={"microsteps": 1})), [])
    assert cured.tried[0][:3] == ("finer steps", "control.microsteps: 16", "pass")
    assert simulated(path, motion=slow, control={"microsteps": 16}).status == "pass"
    quick = {"acceleration_time": "0.02 s"}
    failed = simulated(path, motion=quick)
    assert any("less acceleration" in one for one in failed.warnings)
    slower = [one for one in with_remedies(failed, load_spec(spec_of(path, motion=quick)), []).tried
              if one.what == "slower ramps" and one.status == "pass"]  # fmt: skip
    (time,) = [one.entry.partition(": ")[2] for one in slower]
    assert simulated(path, motion={"acceleration_time": time}).status == "pass"


def test_an_estimated_torque_leaves_it_open_between_the_ends_of_its_band(path: Path) -> None:
    """A1 has no curve: 67 to 150 % of the simulated torque; a share of 0.67 to 1.5 is decided by it."""
    spec = load_spec(spec_of(path, select={"motor": {"kind": "stepper", "part": "A1"}}))
    one = explained(spec, "A1", "direct").sets[0]
    seen = {}
    for time in ("0.15 s", "0.055 s"):
        quicker = load_spec(spec_of(path, motion={"acceleration_time": time}, select={"motor": {"part": "A1"}}))
        seen[time] = check(validate(quicker, one), "pull_out_share")
    assert [one.status for one in seen.values()] == ["pass", "open"]
    assert 0.67 < seen["0.055 s"].demand < 1.5
    assert "the torque is estimated, 67% to 150% of the simulated one" in seen["0.15 s"].note


def test_all_drives_of_a_search(path: Path) -> None:
    both = size(load_spec(spec_of(path, select={"motor": {"kind": "stepper"}, "catalogs": [str(path)]})))
    proofs, notes = validate_all(both)
    assert not notes
    assert {one.drive_set.motor.part for one in proofs} == {one.motor.part for one in both.sets}


# --- what is refused, and said


def test_beyond_the_printed_curve_nothing_is_simulated(path: Path) -> None:
    with pytest.raises(
        NoLoopError, match=r"motor A2: its pull-out torque is unknown above 1200 rpm; not simulated without"
    ):
        simulated(path, motion={"speed": "1300 rpm"})


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"control": {"microsteps": 32}}, "control.microsteps: 32 is more than 16, the most of controller D2"),
        ({"control": {"microsteps": 0}}, "microsteps"),
        (
            {"control": {"microsteps": 8}, "select": {"motor": {}}},
            "control.microsteps: it is of steppers; expected sel",
        ),
    ],
)
def test_refused_in_a_line(path: Path, changes: dict[str, Any], said: str) -> None:
    assert said in refusal(lambda: simulated(path, **changes))


# --- outputs


def test_json_has_pulses_in_the_place_of_gains(proof: Validation) -> None:
    document = json.loads(as_text(proof))
    assert document["gains"]["microsteps"] == 16
    assert document["controller_gains"] == document["loops"] == []
    assert {"lost_steps", "pull_out_share", "load_angle"} <= {one["name"] for one in document["checks"]}


# --- exports


@pytest.fixture(scope="module")
def export(path: Path) -> Export:
    return export_of(load_spec(spec_of(path, load=ARM)), drive(path))


ARM: dict[str, Any] = {"friction_torque": "0.02 N*m", "kind": "rotary_table", "inertia": "4e-4 kg*m^2"}


def test_limits_of_the_joint_are_the_pull_out_torque_and_the_speed(export: Export) -> None:
    """0.42 N*m up to 60 rpm; the motion's highest speed is 300 rpm."""
    joint = ET.fromstring(rendered(export, "urdf")).find("joint/limit")
    assert joint is not None
    assert float(joint.attrib["effort"]) == pytest.approx(0.42)
    assert float(joint.attrib["velocity"]) == pytest.approx(300 * RPM)
    assert b"PositionJointInterface" in rendered(export, "urdf")
    assert ET.fromstring(rendered(export, "sdf")).find(".//limit") is not None


def test_ros2_control_takes_positions(export: Export) -> None:
    block = ET.fromstring(rendered(export, "ros2_control")).find("ros2_control/joint")
    assert block is not None
    assert [one.attrib["name"] for one in block.findall("command_interface")] == ["position"]
    assert yaml.safe_load(rendered(export, "ros2_control", True))["joint_trajectory_controller"]["ros__parameters"] == {
        "joints": ["shaft"], "command_interfaces": ["position"], "state_interfaces": ["position", "velocity"],
    }  # fmt: skip


def test_no_fmu_of_a_stepper(export: Export) -> None:
    with pytest.raises(InputError, match="a stepper has no winding that a voltage drives in an FMU; expected --format"):
        rendered(export, "fmu")


def test_mujoco_follows_as_the_simulation_does(export: Export, path: Path) -> None:
    """Its servo is the sine's slope: at load angles of 25 deg 3 % stiffer than the sine."""
    own = simulated(path, load=ARM)
    model = mujoco.MjModel.from_xml_string(rendered(export, "mjcf").decode())
    data, dt, angle = mujoco.MjData(model), model.opt.timestep, 0.0
    reference, lag, swing = own.series["speed_reference"], [], own.series["time"]
    for k in range(int(0.5 / dt)):
        speed = float(np.interp(k * dt, swing, reference))
        data.ctrl[:] = angle, speed, 0.0
        mujoco.mj_step(model, data)
        angle += speed * dt
        lag.append(angle - data.qpos[0])
    at = np.interp(swing[swing < 0.49], np.arange(len(lag)) * dt, lag)
    peak = next(one.value for one in own.figures if one.name == "position_error_peak")
    assert np.abs(lag).max() == pytest.approx(peak, rel=0.08)
    assert np.abs(at - own.series["position_error"][swing < 0.49]).max() < 0.15 * peak
