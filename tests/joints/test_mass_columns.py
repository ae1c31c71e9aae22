"""Loads of joints from a section: masses of drives and payload as columns, friction, load cases, notes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drivesizer.errors import InputError
from drivesizer.joints.mass_columns import joint_torques
from drivesizer.physics.load_cycle import mean_product
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


def loads_of(found, masses):
    """Loads of all joints along the trajectory."""
    return {joint: found.load(joint, masses) for joint in found.joints}


def test_weight_of_links_drives_and_payload_by_hand(tmp_path: Path) -> None:
    made, file = section(tmp_path, payload={"mass": "1.5 kg", "at": ["400 mm", "0 mm", "0 mm"]}, friction="leave")
    found = joint_torques(made, file)
    loads = loads_of(found, {"shoulder": 5.0, "elbow": 3.0})
    shoulder = (2 * 0.3 + 1 * 0.8 + 3.0 * 0.6 + 1.5 * 1.0) * G  # the elbow's drive on the upper arm, at its end
    assert loads["shoulder"].cycle.torque[0] == pytest.approx(shoulder, rel=1e-12)
    assert loads["elbow"].cycle.torque[0] == pytest.approx((1 * 0.2 + 1.5 * 0.4) * G, rel=1e-12)
    assert loads["shoulder"].cycle.holding_torque == pytest.approx(shoulder, rel=1e-12)  # level is its worst pose
    inertia = 0.02 + 2 * 0.09 + 0.01 + 1 * 0.64 + 3.0 * 0.36 + 1.5 * 1.0
    assert loads["shoulder"].shaft_inertia == pytest.approx(inertia, rel=1e-12)
    assert found.carried == {"shoulder": ("elbow",), "elbow": ()}
    assert found.order == ("elbow", "shoulder")


def test_masses_that_hold_the_drives_are_not_counted_twice(tmp_path: Path) -> None:
    """By hand: the links alone, and of the elbow's 3 kg 1 kg beyond the 2 kg of its link; else the note says so."""
    made, file = section(tmp_path, masses="with_drives", friction="leave")
    found = joint_torques(made, file)
    loads = loads_of(found, {"shoulder": 5.0, "elbow": 3.0})
    assert loads["shoulder"].cycle.torque[0] == pytest.approx((2 * 0.3 + 1 * 0.8 + 1 * 0.6) * G, rel=1e-12)
    light = found.load("shoulder", {"shoulder": 5.0, "elbow": 1.9}).cycle
    assert light.torque[0] == pytest.approx((2 * 0.3 + 1 * 0.8) * G, rel=1e-12)
    assert found.carried == {"shoulder": (), "elbow": ()}
    assert any("hold their drives" in note for note in found.notes)
    silent = joint_torques(section(tmp_path)[0], file)
    assert any("robot: {masses: with_drives}" in note for note in silent.notes)
    plain = joint_torques(section(tmp_path, masses="without")[0], file)
    assert plain.carried == silent.carried and not any("masses" in note for note in plain.notes)


def test_a_drive_elsewhere_on_its_link(tmp_path: Path) -> None:
    near = {"on": "link", "link": "upper", "at": ["100 mm", "0 mm", "0 mm"]}
    made, file = section(tmp_path, drives={"elbow": near}, friction="leave")
    found = joint_torques(made, file)
    alone, laden = (found.load("shoulder", {"elbow": mass}).cycle.torque[0, 0] for mass in (0.0, 4.0))
    assert laden - alone == pytest.approx(4.0 * 0.1 * G, rel=1e-12)


def test_a_drive_on_the_link_that_it_moves_loads_its_own_joint(tmp_path: Path) -> None:
    """By hand: level and at rest 3 kg 150 mm before the elbow, 750 mm before the shoulder."""
    rides = {"on": "link", "link": "fore", "at": ["150 mm", "0 mm", "0 mm"]}
    made, file = section(tmp_path, drives={"elbow": rides}, friction="leave")
    found = joint_torques(made, file)
    loads = loads_of(found, {"elbow": 3.0})
    assert loads["elbow"].cycle.torque[0] == pytest.approx((1 * 0.2 + 3.0 * 0.15) * G, rel=1e-12)
    assert loads["shoulder"].cycle.torque[0] == pytest.approx((2 * 0.3 + 1 * 0.8 + 3.0 * 0.75) * G, rel=1e-12)
    assert found.carried == {"shoulder": ("elbow",), "elbow": ("elbow",)} and found.order == ("elbow", "shoulder")


def test_friction_of_bearings_resists_either_way(tmp_path: Path) -> None:
    sections = (section(tmp_path, friction=word) for word in ("keep", "leave"))
    kept, left = (joint_torques(*one).load("shoulder", {}).cycle for one in sections)
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


@pytest.mark.parametrize("opposite", [False, True])
def test_a_remotely_driven_link_as_in_a_textbook(opposite: bool, tmp_path: Path) -> None:
    """Spong, Hutchinson, Vidyasagar, section 7.4: in the angles of the drives; m2 swings about the elbow's axis alone.

    D = [[m1 lc1^2 + m2 l1^2 + I1, m2 l1 lc2 cos(p2 - p1)], [the same, m2 lc2^2 + I2]], C221 = -m2 l1 lc2 sin(p2 - p1),
    C112 = +m2 l1 lc2 sin(p2 - p1), weight (m1 lc1 + m2 l1) g cos p1 and m2 lc2 g cos p2.
    """
    text = ARM.replace('<axis xyz="0 -1 0"/><limit lower="-2" upper="2" velocity="5" effort="1"/></joint>',
                       '<axis xyz="0 1 0"/><limit lower="-2" upper="2" velocity="5" effort="1"/></joint>')  # fmt: skip
    made, file = section(tmp_path, drives={"elbow": {"on": "base", "belt_passes": True}}, friction="leave")
    if opposite:
        (tmp_path / "arm.urdf").write_text(text, encoding="utf-8")
    found = joint_torques(made, file)
    motion, s = found.cases[0].motion, -1.0 if opposite else 1.0
    q, v, a = (c.reshape(-1, 2) * [1.0, s] for c in (motion.position, motion.speed, motion.acceleration))
    p1, p2 = q[:, 0], q[:, 0] + q[:, 1]
    w1, w2, b1, b2 = v[:, 0], v[:, 0] + v[:, 1], a[:, 0], a[:, 0] + a[:, 1]
    both = 1.0 * 0.6 * 0.2
    d11, d12, d22 = 0.02 + 2 * 0.09 + 1 * 0.36, both * np.cos(p2 - p1), 0.01 + 1 * 0.04
    t1 = d11 * b1 + d12 * b2 - both * np.sin(p2 - p1) * w2**2 + (2 * 0.3 + 0.6) * G * np.cos(p1)
    t2 = d12 * b1 + d22 * b2 + both * np.sin(p2 - p1) * w1**2 + 0.2 * G * np.cos(p2)
    first, second = (column.torque[0] for column in [found.cases[0].torques] * 2)
    assert first[:, 0] == pytest.approx(t1, rel=1e-9, abs=1e-9)
    assert second[:, 1] * s == pytest.approx(t2, rel=1e-9, abs=1e-9)
    loads = loads_of(found, {})
    assert loads["shoulder"].shaft_inertia == pytest.approx(d11) and loads["elbow"].shaft_inertia == pytest.approx(d22)
    assert np.abs(loads["elbow"].cycle.speed).max() == pytest.approx(np.abs(w2).max())


def test_coupled_drives_do_the_work_of_the_joints(tmp_path: Path) -> None:
    """Friction of both bearings is in the sum, whichever drive it loads."""
    drives = {"elbow": {"on": "base", "belt_passes": True}}
    works = []
    for given in (drives, {"elbow": {"on": "base"}}):
        loads = loads_of(joint_torques(*section(tmp_path, drives=given)), {})
        works.append(sum(float((c.cycle.duration * c.cycle.power.mean(axis=1)).sum()) for c in loads.values()))
    assert works[0] == pytest.approx(works[1], rel=1e-4)


@pytest.mark.parametrize(
    ("drives", "said"),
    [
        ({"shoulder": {"on": "base", "belt_passes": True}}, 'no joint moves between the drive of "shoulder" and its'),
        ({"elbow": {"on": "link", "link": "upper", "belt_passes": True}}, 'joint moves between the drive of "elbow"'),
    ],
)
def test_belts_that_pass_no_joint(drives: dict[str, Any], said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        joint_torques(*section(tmp_path, drives=drives))


def test_a_belt_passes_parallel_axes_alone(tmp_path: Path) -> None:
    made, file = section(tmp_path, drives={"elbow": {"on": "base", "belt_passes": True}})
    (tmp_path / "arm.urdf").write_text(ARM.replace('"0 -1 0"', '"0 -1 0.01"', 1), encoding="utf-8")
    with pytest.raises(InputError, match='belt of "elbow" passes joint "shoulder"; expected one about a parallel axis'):
        joint_torques(made, file)


def test_drives_give_back_what_they_take_of_a_closed_path_without_friction(tmp_path: Path) -> None:
    """Kinetic and potential energy are the same at both ends; straight lines between 128 pieces of a move."""
    loads = loads_of(joint_torques(*section(tmp_path, friction="leave")), {"elbow": 3.0, "shoulder": 4.0})
    work = {
        name: load.cycle.duration * mean_product(load.cycle.torque, load.cycle.speed) for name, load in loads.items()
    }
    total, turned = sum(one.sum() for one in work.values()), sum(np.abs(one).sum() for one in work.values())
    assert turned > 50.0 and abs(total) < 1e-4 * turned
