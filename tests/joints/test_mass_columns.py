"""Loads of joints from a section: masses of drives and payload as columns, friction, load cases, notes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drivesizer.joints.mass_columns import joint_loads, joint_torques
from drivesizer.spec.robot_section import RobotSection

G = 9.80665
ARM = """<robot name="arm">
<link name="base"/>
<link name="upper"><inertial><origin xyz="0.3 0 0"/><mass value="2"/>
  <inertia ixx="0.001" iyy="0.02" izz="0.02"/></inertial></link>
<link name="fore"><inertial><origin xyz="0.2 0 0"/><mass value="1"/>
  <inertia ixx="0.001" iyy="0.01" izz="0.01"/></inertial></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 1"/>
  <axis xyz="0 -1 0"/><limit lower="-2" upper="2" velocity="5" effort="1"/>
  <dynamics damping="0.5" friction="0.7"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0.6 0 0"/>
  <axis xyz="0 -1 0"/><limit lower="-2" upper="2" velocity="5" effort="1"/></joint>
</robot>
"""


def section(folder: Path, **fields: Any) -> tuple[RobotSection, str]:
    """A section of the arm beside a spec in a folder."""
    (folder / "arm.urdf").write_text(ARM, encoding="utf-8")
    moves = [{"positions": {"shoulder": "0 deg", "elbow": "0 deg"}, "pause": "1 s"},
             {"positions": {"shoulder": "60 deg", "elbow": "-80 deg"}},
             {"positions": {"shoulder": "0 deg", "elbow": "0 deg"}}]  # fmt: skip
    given = {"description": "arm.urdf", "limits": {"all": {"acceleration": "10 rad/s^2"}}}
    if "trajectory" not in fields:
        given["waypoints"] = moves
    return RobotSection.model_validate({**given, **fields}), str(folder / "machine.yaml")


def test_weight_of_links_drives_and_payload_by_hand(tmp_path: Path) -> None:
    made, file = section(tmp_path, payload={"mass": "1.5 kg", "at": ["400 mm", "0 mm", "0 mm"]}, friction="leave")
    found = joint_torques(made, file)
    loads = found.loads({"shoulder": 5.0, "elbow": 3.0})
    shoulder = (2 * 0.3 + 1 * 0.8 + 3.0 * 0.6 + 1.5 * 1.0) * G  # the elbow's drive on the upper arm, at its end
    assert loads["shoulder"].cycle.torque[0] == pytest.approx(shoulder, rel=1e-12)
    assert loads["elbow"].cycle.torque[0] == pytest.approx((1 * 0.2 + 1.5 * 0.4) * G, rel=1e-12)
    assert loads["shoulder"].cycle.held == pytest.approx(shoulder, rel=1e-12)  # level is its worst pose
    inertia = 0.02 + 2 * 0.09 + 0.01 + 1 * 0.64 + 3.0 * 0.36 + 1.5 * 1.0
    assert loads["shoulder"].shaft_inertia == pytest.approx(inertia, rel=1e-12)
    assert found.carried == {"shoulder": ("elbow",), "elbow": ()}
    assert found.order == ("elbow", "shoulder")


def test_a_drive_in_the_base_is_carried_by_none(tmp_path: Path) -> None:
    made, file = section(tmp_path, drives={"elbow": {"on": "base"}})
    found = joint_torques(made, file)
    assert found.carried == {"shoulder": (), "elbow": ()}
    light, heavy = (found.load("shoulder", {"elbow": mass}).cycle for mass in (0.0, 9.0))
    assert (light.torque == heavy.torque).all() and light.inertia == heavy.inertia


def test_a_drive_elsewhere_on_its_link(tmp_path: Path) -> None:
    near = {"on": "link", "link": "upper", "at": ["100 mm", "0 mm", "0 mm"]}
    made, file = section(tmp_path, drives={"elbow": near}, friction="leave")
    alone, laden = (joint_loads(made, file, {"elbow": mass})["shoulder"].cycle.torque[0, 0] for mass in (0.0, 4.0))
    assert laden - alone == pytest.approx(4.0 * 0.1 * G, rel=1e-12)


def test_friction_of_bearings_resists_either_way(tmp_path: Path) -> None:
    kept, left = (joint_loads(*section(tmp_path, friction=word), {})["shoulder"].cycle for word in ("keep", "leave"))
    assert {"keep": kept.total, "leave": left.total}["keep"] == pytest.approx(left.total)
    work = [float((c.duration[:, None] * c.power).mean(axis=1).sum()) for c in (kept, left)]
    travel = 2 * np.radians(60)
    speed = left.speed
    viscous = float((left.duration * (speed[:, 0] ** 2 + speed[:, 0] * speed[:, 1] + speed[:, 1] ** 2) / 3).sum()) * 0.5
    assert work[0] - work[1] == pytest.approx(0.7 * travel + viscous, rel=1e-3)


def test_load_cases_of_payloads_and_poses(tmp_path: Path) -> None:
    made, file = section(
        tmp_path, payload={"mass": "1 kg", "link": "fore"}, payloads=[{"name": "empty", "mass": "0 kg"}],
        holds=[{"name": "stretched", "positions": {"shoulder": "0 deg"}, "payload": "2 kg", "time": "5 s"}],
        friction="leave",
    )  # fmt: skip
    found = joint_torques(made, file)
    assert [case.name for case in found.cases] == ["", "empty", "stretched"]
    own, empty, held = (found.load("shoulder", {}, case).cycle for case in range(3))
    assert own.torque[0, 0] - empty.torque[0, 0] == pytest.approx(0.6 * G, rel=1e-12)
    assert held.total == 5.0 and not held.speed.any()
    assert held.torque == pytest.approx((2 * 0.3 + 0.8 + 2 * 0.6) * G, rel=1e-12)
