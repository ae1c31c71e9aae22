"""MJCF files: the same masses and torques as MuJoCo reads of them, and one line about what is not read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from refusals import refusal

from drivesizer.errors import InputError
from drivesizer.joints.inverse_dynamics import torques_of
from drivesizer.spec.description import read_description

ARM = """<mujoco model="arm">
  <compiler angle="degree" eulerseq="XYz" meshdir="meshes"/>
  <default>
    <geom density="700"/>
    <default class="heavy"><geom density="2700" type="cylinder"/><joint damping="0.3" frictionloss="0.2"/></default>
  </default>
  <worldbody>
    <geom type="plane" size="1 1 0.1"/>
    <body name="column" pos="0 0 0.5" euler="10 20 30">
      <geom type="box" size="0.05 0.06 0.2"/>
      <body name="upper" pos="0.1 0 0.2" childclass="heavy" axisangle="1 1 0 40">
        <joint name="turn" axis="0 0.2 1" pos="0.02 0.03 0" range="-100 90"/>
        <joint name="swing" axis="1 0 0" pos="0 0.05 0.01" range="-60 60" armature="0.5" ref="15"/>
        <geom fromto="0 0 0 0.1 0.2 0.4" size="0.03"/>
        <geom type="sphere" size="0.06" pos="0.1 0.2 0.4" mass="0.4"/>
        <geom type="mesh" mesh="cover" mass="0"/>
        <site name="grip"/>
        <body name="slider" pos="0.1 0.2 0.4" quat="0.9 0.1 0.3 0.2">
          <joint name="push" type="slide" axis="0 0 1" range="-0.2 0.3" ref="0.05"/>
          <geom type="capsule" size="0.02 0.1" class="main"/>
          <geom type="ellipsoid" size="0.02 0.03 0.05" pos="0 0 0.2" xyaxes="1 1 0 0 1 1"/>
          <body name="hand" zaxis="1 0 1">
            <inertial pos="0 0.01 0.1" mass="0.7" fullinertia="0.004 0.005 0.003 0.001 0.0005 0"/>
            <joint name="wrist" axis="0 1 0"/>
            <geom type="mesh" mesh="hand"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator><motor joint="turn" gear="50"/></actuator>
</mujoco>
"""
NAMES = ("turn", "swing", "push", "wrist")


def written(folder: Path, text: str) -> Path:
    path = folder / "arm.xml"
    path.write_text(text, encoding="utf-8")
    return path


def test_torques_are_those_of_mujocos_own_reading(tmp_path: Path) -> None:
    import mujoco

    robot = read_description(written(tmp_path, ARM))
    no_mesh = ARM.replace('<geom type="mesh" mesh="cover" mass="0"/>', "").replace(
        '<geom type="mesh" mesh="hand"/>', ""
    )
    model = mujoco.MjModel.from_xml_string(no_mesh)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    model.dof_damping[:] = model.dof_armature[:] = 0.0
    data, rng = mujoco.MjData(model), np.random.default_rng(5)
    states = tuple(rng.normal(size=(4, 4)) for _ in range(3))
    found = torques_of(robot, {}, [], NAMES, states, model.opt.gravity.copy())
    for row in range(4):
        data.qpos[:], data.qvel[:], data.qacc[:] = (state[row] for state in states)
        mujoco.mj_inverse(model, data)
        assert found.torque[0, row] == pytest.approx(data.qfrc_inverse, rel=1e-8, abs=1e-8)


def test_limits_and_losses_of_joints(tmp_path: Path) -> None:
    joints = read_description(written(tmp_path, ARM)).joints
    turn, swing, push, wrist = (joints[name] for name in NAMES)
    assert (turn.kind, push.kind, wrist.kind) == ("revolute", "prismatic", "continuous")
    assert (turn.lower, turn.upper) == pytest.approx((np.radians(-100), np.radians(90)))
    assert (push.lower, push.upper, push.reference) == (-0.2, 0.3, 0.05)
    assert (swing.armature, swing.damping, swing.friction) == (0.5, 0.3, 0.2)
    assert not wrist.limited and np.isnan(wrist.upper)


def test_a_free_base_is_held(tmp_path: Path) -> None:
    text = '<mujoco><worldbody><body name="trunk"><freejoint/><geom size="0.1"/></body></worldbody></mujoco>'
    robot = read_description(written(tmp_path, text))
    assert robot.joints["trunk (fixed)"].kind == "fixed"
    assert robot.notes == ('body "trunk" is free in the description; held here',)


def body(inside: str, before: str = "") -> str:
    return f'<mujoco>{before}<worldbody>\n<body name="a">\n{inside}\n</body></worldbody></mujoco>'


HINGE = '<joint name="j"/>'


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (body(HINGE, '<include file="x.xml"/>'), "1: <include> is not read; expected a description without it"),
        (body(HINGE, '<equality><joint joint1="j"/></equality>'), "1: <equality> is not read"),
        (body(HINGE, '<tendon><fixed name="t"/></tendon>'), "1: <tendon> is not read"),
        (body("<frame/>"), "3: <frame> is not read; expected bodies with joints, geoms and inertials"),
        (body("<flexcomp/>"), "3: <flexcomp> is not read"),
        (body('<joint name="j" type="ball"/>'), '3: joint "j" is "ball"; expected hinge or slide'),
        (body('<joint name="j" springdamper="1 1"/>'), '3: joint "j": springdamper is not read; expected stiffness'),
        (body('<joint name="j" damping="3 1"/>'), '3: <joint> damping: "3 1" is not read; expected one number'),
        (body('<joint name="j" axis="0 0 0"/>'), '3: joint "j": an axis of length 0 has no direction'),
        (body('<joint name="j" range="3 1"/>'), '3: <joint> range: "3 1"; expected its two ends, the lower first'),
        (body('<joint name="j" class="hevy"/>'), '3: there is no default class "hevy"'),
        (body("<joint/>"), "3: <joint> has no name"),
        (body(HINGE + HINGE), '3: joint "j" is there twice'),
        (body('<geom type="box" size="1 2"/>'), '3: <geom> size: "1 2"; expected 3 numbers above 0 of a box'),
        (body('<geom size="1" quat="0 0 0 0"/>'), '3: <geom> quat: "0 0 0 0" has no direction'),
        (body('<geom size="1" quat="1 0 0 0" euler="0 0 0"/>'), "3: <geom> has quat and euler; expected one"),
        (body('<inertial pos="0 0 0" mass="-1" diaginertia="1 1 1"/>'), "3: <inertial>: a mass of -1 kg is none"),
        (body('<inertial pos="0 0 0" mass="1"/>'), "3: <inertial>: expected diaginertia of 3 numbers, or fullinertia"),
        (body('<inertial pos="0 0 0" mass="1e999" diaginertia="1 1 1"/>'), '3: <inertial> mass: "1e999" is no number'),
        (body(HINGE, '<compiler settotalmass="3"/>'), '1: <compiler> settotalmass="3" is not read'),
        (body(HINGE, '<compiler coordinate="global"/>'), '1: <compiler> coordinate: "global"; expected local'),
        (body(HINGE, '<option density="1.2"/>'), "1: <option> density: a fluid is not read; expected 0"),
        (body("<freejoint/>").replace('"a"', '"a" mocap="true"'), "2: <body> mocap is not read"),
        ("<mujoco/>", "1: <mujoco> has no bodies; expected <worldbody> with <body>"),
        ("<sdf/>", "1: <sdf> is no robot; expected <robot> of URDF or <mujoco> of MJCF"),
        ('<!DOCTYPE a [<!ENTITY b "c">]><mujoco/>', "1: a document type is not taken; expected plain XML"),
        ("<mujoco>", "1: this is no XML (no element found)"),
        ("<mujoco>" + "<body>" * 100 + "</body>" * 100 + "</mujoco>", "expected at most 20000 elements, 60 deep"),
    ],
)
def test_what_is_not_read_is_one_line(text: str, said: str, tmp_path: Path) -> None:
    path = written(tmp_path, text)
    line = refusal(lambda: read_description(path))
    assert line.startswith(f"{path}:")
    assert said in line


def test_a_body_of_a_mesh_alone_has_no_known_mass_where_it_moves(tmp_path: Path) -> None:
    path = written(tmp_path, body(HINGE + '\n<geom type="mesh" mesh="m"/>'))
    state = (np.zeros((1, 1)),) * 3
    with pytest.raises(InputError, match='xml:2: link "a" has a mesh of unknown mass on line 4; expected <inertial>'):
        torques_of(read_description(path), {}, [], ["j"], state, np.zeros(3))
    torques_of(read_description(path), {"j": 0.0}, [], [], (np.zeros((1, 0)),) * 3, np.zeros(3))


def test_a_huge_file_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    with path.open("wb") as file:
        file.truncate(1_000_000_000)
    with pytest.raises(InputError, match="the file is larger than 16 MB"):
        read_description(path)
