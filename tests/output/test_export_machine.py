"""Machines of several axes for simulators, held against the torques of the sizing, MuJoCo and other readers."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any, NamedTuple
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
import yaml
import yourdfpy
from exports import rendered
from small_arms import catalogue

from drivesizer.errors import InputError
from drivesizer.joints.inverse_dynamics import Array, torques_of
from drivesizer.load_cases import driven_shaft_cycle
from drivesizer.multi_axis import size_machine
from drivesizer.output.export import MachineExport, export_of, machine_export, write
from drivesizer.output.export import files as exported
from drivesizer.output.export.common import torque_law
from drivesizer.output.export.mjcf import lossless
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.results.machine import MachineSizing
from drivesizer.simulate import validate
from drivesizer.spec.description import read_description
from drivesizer.spec.machine import load_machine

pytestmark = pytest.mark.usefixtures("no_further_searches")
EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
PARTS = {  # the drives that the example gets, so that nothing is searched
    "waist": ("DC-MAX22S01GBKL598", "GPX26AAKLSL0231CPLW"), "shoulder": ("625855", "223094"),
    "elbow": ("309756", "326668"), "roll": ("DCX12S01EBKL556", "GPX12HPKLSL0103CPLW"),
    "pitch": ("DCX16S01EBKL512", "GPX19HPKLSL0243CPLW"), "turn": ("DCX06M01EBKL501", "GPX06AAKLSL03D9CPLW"),
}  # fmt: skip
DOWN = np.array([0.0, 0.0, -9.80665])


@pytest.fixture(scope="module")
def arm() -> MachineSizing:
    data = yaml.safe_load((EXAMPLES / "six_joint_arm.yaml").read_text(encoding="utf-8"))
    data["robot"]["description"] = str(EXAMPLES / "six_joint_arm.urdf")
    del data["select"]["objective"]
    data["axes"] = {
        name: {"select": {"motor": {"part": motor}, "gearhead": {"part": gear}}}
        for name, (motor, gear) in PARTS.items()
    }
    return size_machine(load_machine(data), top=1)


@pytest.fixture(scope="module")
def export(arm: MachineSizing) -> MachineExport:
    return machine_export(arm)


@pytest.fixture(scope="module")
def model(export: MachineExport) -> Any:
    return mujoco.MjModel.from_xml_string(rendered(export, "mjcf").decode())


def described(of: MachineExport, form: bytes, folder: Path) -> Any:
    """The record that our own reader makes of a file."""
    path = folder / "written.urdf"
    path.write_bytes(form)
    return read_description(path)


# --- the arm of six joints


def test_the_masses_are_those_of_links_drives_and_payload(arm, export, model):
    links = sum(link.mass for link in export.robot.robot.links.values())
    drives = sum(row.mass for row in arm.axis("waist").carried) + model.body("waist_drive").mass[0]
    parts = arm.axis("waist").best.parts
    waist = sum(parts[role].mass for role in ("motor", "gearhead"))
    assert model.body_mass.sum() == pytest.approx(links + drives + 1.0, rel=1e-9)
    assert model.body("waist_drive").mass[0] == pytest.approx(waist) and model.body("payload").mass[0] == 1.0


def test_rotors_are_the_armature_of_joints(export, model):
    for drive in export.robot.drives:
        train = drive.of.train
        expected = train.motor_inertia * train.ratio**2 * train.efficiency
        assert model.joint(drive.joint).armature[0] == pytest.approx(expected, rel=1e-9)
        assert model.actuator(f"{drive.joint}_motor").gear[0] == pytest.approx(train.ratio, rel=1e-9)
        assert model.jnt_actfrcrange[model.joint(drive.joint).id, 1] == pytest.approx(
            drive.of.limits.peak_torque.value, rel=1e-9
        )


def test_inverse_dynamics_of_the_file_needs_the_torques_of_the_sizing(arm, export, model):
    """Every eighth point of the trajectory, by ``mj_inverse`` of the file, rotors and friction taken off."""
    data, motion = mujoco.MjData(model), export.robot.motion
    loads = [arm.axis(name).spec.load.cycle for name in motion.joints]
    assert all(len(load.duration) >= len(motion.duration) for load in loads)  # cut where a sign changes
    ends = np.cumsum(motion.duration)
    for row in range(0, len(ends), 8):
        if not motion.speed[row].any():
            continue
        state = (c[row, 0] for c in (motion.position, motion.speed, motion.acceleration))
        data.qpos[:], data.qvel[:], data.qacc[:] = state
        mujoco.mj_inverse(model, data)
        found = data.qfrc_inverse + data.qfrc_passive + data.qfrc_constraint - model.dof_armature * data.qacc
        at = float(ends[row] - motion.duration[row])
        for column, load in enumerate(loads):
            starts = np.cumsum(load.duration) - load.duration
            segment = int(np.argmin(abs(starts - at)))
            assert found[column] == pytest.approx(load.torque[segment, 0], rel=1e-6, abs=1e-9)


class Run(NamedTuple):
    torque: Array  # N*m, of each joint's load, shape (steps, joints)
    current: Array  # A
    moving: Array


@pytest.fixture(scope="module")
def run(export, model) -> Run:
    """Along the trajectory, the gears corrected as the remark says."""
    drives = export.robot.drives
    names = [model.numeric(number).name for number in range(model.nnumeric)]
    numeric = {name: model.numeric(name).data for name in names}
    times = np.arange(0.0, numeric["cycle_time"][-1], model.opt.timestep)
    position, speed = (
        np.stack([np.interp(times, numeric["cycle_time"], numeric[f"{d.joint}_{what}"]) for d in drives], 1)
        for what in ("position", "speed")
    )
    ratio, efficiency = np.array([d.ratio for d in drives]), np.array([d.of.train.efficiency for d in drives])
    ctrl = np.zeros((len(times), model.nu))
    ctrl[:, 0::3], ctrl[:, 1::3] = ratio * position, ratio * speed
    ctrl[:, 2::3] = speed * ratio * [torque_law(lossless(d)).per_speed for d in drives]
    act = [
        int(np.sum(model.actuator(f"{d.joint}_motor").actadr + model.actuator(f"{d.joint}_motor").actnum)) - 1
        for d in drives
    ]
    constants = [d.of.train.efficiency * d.of.train.torque_constant / d.of.train.back_emf_constant for d in drives]
    data, torque, current = mujoco.MjData(model), np.zeros_like(speed), np.zeros_like(speed)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    need = np.zeros(len(drives))
    for step in range(len(times)):
        data.ctrl[:] = ctrl[step]
        data.qfrc_applied[:] = np.where(need * speed[step] < 0.0, (1.0 - efficiency**2) * need, 0.0)
        mujoco.mj_step(model, data)
        rotor = model.dof_armature * data.qacc + model.dof_damping * data.qvel
        need = data.qfrc_actuator + data.qfrc_applied + data.qfrc_constraint - rotor
        torque[step], current[step] = need, data.act[act]
    assert np.abs(data.qpos - position[-1]).max() < 0.01  # rad
    return Run(torque, current / np.sqrt(constants), speed != 0.0)


def rms(values: Array) -> Array:
    return np.sqrt(np.mean(values**2, axis=0))


def test_under_the_designed_loops_joints_need_the_torques_of_the_sizing(arm, export, run):
    """RMS within 1 %, or 1 % of the joint's effort where next to nothing is needed; peaks within 20 %.

    The peaks are those of the loops' overshoot where the acceleration steps.
    """
    for column, drive in enumerate(export.robot.drives):
        load, effort = arm.axis(drive.joint).spec.load.cycle, drive.of.limits.peak_torque.value
        squares = (load.torque**2).sum(axis=1) + load.torque[:, 0] * load.torque[:, 1]
        sized = np.sqrt((squares * load.duration).sum() / 3.0 / load.duration.sum())
        found = run.torque[:, column]
        assert rms(found) == pytest.approx(sized, rel=0.01, abs=0.01 * effort if drive.joint == "turn" else 0.0)
        slack = 0.2 * abs(load.torque).max() + (0.2 * effort if drive.joint == "turn" else 0.0)
        assert abs(abs(found).max() - abs(load.torque).max()) < slack


def test_currents_are_those_of_validate(arm, export, run):
    """Peaks within 8 % for all joints that lift; RMS of the waist, which weight does not load, within 1 %.

    Validation holds at rest by friction and takes each joint's largest inertia; the arm's varies with its pose.
    """
    for column, name in enumerate(("waist", "shoulder", "elbow", "roll", "pitch")):
        proof = validate(arm.axis(name).spec, arm.axis(name).best)
        figures = {figure.name: figure.value for figure in proof.figures}
        if name != "roll":  # it holds alone
            peak = abs(run.current[:, column][run.moving[:, column]]).max()
            assert peak == pytest.approx(figures["peak_current"], rel=0.08), name
        if name == "waist":
            assert rms(run.current[:, column]) == pytest.approx(figures["rms_current"], rel=0.01)


def test_urdf_is_read_by_another_s_reader_and_keeps_names_and_limits(export, tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_bytes(rendered(export, "urdf"))
    robot = yourdfpy.URDF.load(str(path), load_meshes=False, build_scene_graph=False)
    assert [*PARTS] == [name for name, joint in robot.joint_map.items() if joint.type == "revolute"]
    for drive in export.robot.drives:
        limit = robot.joint_map[drive.joint].limit
        assert limit.effort == pytest.approx(drive.of.limits.peak_torque.value)
        assert (limit.lower, limit.upper) == (
            export.robot.robot.joints[drive.joint].lower, export.robot.robot.joints[drive.joint].upper
        )  # fmt: skip


def test_one_controller_of_all_joints_at_one_rate(export):
    files = exported(export, "ros2_control", Path("arm.urdf"))
    assert [path.name for path in files] == ["arm.urdf", "arm_controllers.yaml"]
    parameters = yaml.safe_load(files[Path("arm_controllers.yaml")])
    manager, loops = (parameters[name]["ros__parameters"] for name in ("controller_manager", "velocity_controller"))
    assert loops["dof_names"] == [*PARTS] == [*loops["gains"]]
    assert manager["update_rate"] == loops["update_rate"] == 1000
    root = ElementTree.fromstring(files[Path("arm.urdf")])
    assert [joint.get("name") for joint in root.findall("ros2_control/joint")] == [*PARTS]
    drive, gains = export.robot.drives[1], loops["gains"]["shoulder"]
    law, train = torque_law(drive.of), drive.of.train
    assert gains["p"] == pytest.approx(law.kd * train.ratio**2 * train.efficiency)


def test_formats_without_links_have_the_joints_as_axes(arm, tmp_path):
    """Gazebo, FMUs and plain figures: each joint as its axis alone gives it, by its name."""
    of = machine_export(arm, bodies=False)
    joints = ElementTree.fromstring(rendered(of, "sdf")).findall("model/joint[@type='revolute']")
    assert [one.get("name") for one in joints] == [f"{axis.name}_shaft" for axis in arm.axes]
    for joint, (_, one) in zip(joints, of.axes, strict=True):
        assert float(joint.findtext("axis/dynamics/friction")) == pytest.approx(one.friction)
    figures = json.loads(rendered(of, "json"))["axes"]
    alone = [
        json.loads(rendered(replace(export_of(axis.spec, axis.best), name=axis.name), "json"))["axes"][0]
        for axis in arm.axes
    ]
    assert figures == alone
    paths = write(of, "fmu", tmp_path / "arm.fmu")
    assert [path.name for path in paths] == [f"arm_{axis.name}.fmu" for axis in arm.axes]


def test_a_belt_that_passes_a_joint_is_a_tendon(export):
    """Kinetic energy of a rotor that turns by the sum of two angles: in both joints and between them."""
    drives = tuple(
        replace(drive, turns_by={"shoulder": 1.0, "elbow": 1.0}) if drive.joint == "elbow" else drive
        for drive in export.robot.drives
    )
    coupled = replace(export, robot=replace(export.robot, drives=drives))
    model = mujoco.MjModel.from_xml_string(rendered(coupled, "mjcf").decode())
    rotor = next(drive.armature for drive in drives if drive.joint == "elbow")
    assert model.joint("elbow").armature[0] == 0.0 and model.tendon_armature[0] == pytest.approx(rotor)
    assert model.actuator("elbow_motor").trntype[0] == mujoco.mjtTrn.mjTRN_TENDON
    with pytest.raises(InputError, match="elbow: its belt passes other joints"):
        rendered(coupled, "ros2_control")


def test_a_name_that_is_there_already_is_refused(export):
    of = export.robot.drives[0].of
    twice = replace(export, axes=(("a b", of), ("a-b", of)))
    with pytest.raises(InputError, match='axis "a-b": a link "a_b_load" is there already; rename'):
        rendered(twice, "urdf")
    hostile = replace(export, name='--> <a & "b', axes=(("x", replace(of, name="-->", label="<--")),))
    for form, tag in (("urdf", "robot"), ("mjcf", "mujoco")):
        assert ElementTree.fromstring(rendered(hostile, form)).tag == tag


# --- further stages and steppers at joints

ROBOT = """<mujoco model="picker"><compiler angle="radian"/><worldbody><body name="column" pos="0 0 0.3">
  <joint name="first" axis="0 0 1" pos="0.02 0.01 0" range="-2 2" ref="0.3" damping="0.02"/>
  <inertial pos="0.1 0.01 0" mass="1.1" fullinertia="0.01 0.02 0.025 0.001 0 0"/>
  <body name="fore" pos="0.25 0 0" euler="0 0 0.4">
    <joint name="second" axis="0 0 -1" pos="0.01 0 0.02" range="-2 2"/>
    <inertial pos="0.1 0 0.01" mass="0.7" diaginertia="0.001 0.004 0.004"/>
    <body name="quill" pos="0.2 0 0" euler="0.1 0.2 0.3">
      <joint name="third" type="slide" axis="0 0 1" range="-0.2 0.2"/>
      <inertial pos="0 0 0.05" mass="0.4" diaginertia="0.001 0.001 0.0002"/>
      <body name="tip" pos="0 0.02 0.1"><joint name="fourth" axis="1 0 0" range="-1 1"/>
        <inertial pos="0.02 0 0" mass="0.1" diaginertia="0.0001 0.0001 0.0001"/></body>
    </body></body></body></worldbody></mujoco>"""

GEAR = {"kind": "gear", "ratio": 2.5, "efficiency": 0.9, "pinion_inertia": "3 kg*cm^2", "wheel_inertia": "20 kg*cm^2",
        "pinion_friction": "5 mN*m", "wheel_friction": "30 mN*m"}  # fmt: skip
BELT = {"kind": "belt", "ratio": 1.2, "efficiency": 0.92, "inertia": "2 kg*cm^2", "friction_torque": "4 mN*m"}
STAGES = {
    "first": [GEAR], "second": [GEAR, BELT], "third": [BELT, GEAR | {"kind": "worm", "ratio": 1.3, "efficiency": 0.7}],
}  # fmt: skip


SHORT = {"first": "20 deg", "second": "-15 deg", "third": "10 mm"}


def picked(folder: Path, axes: dict[str, Any], select: Any = None, end: Any = SHORT, **robot: Any) -> MachineSizing:
    """A picker with three joints that move, its sections changed."""
    (folder / "robot.xml").write_text(ROBOT, encoding="utf-8")
    (folder / "parts.yaml").write_text(catalogue(Random(3)), encoding="utf-8")
    select = select or {"catalogs": [str(folder / "parts.yaml")], "estimates": "off"}
    start = {"first": "0 deg", "second": "0 deg", "third": "0 mm"}
    limits = {"speed": "1 rad/s", "acceleration": "2 rad/s^2"}
    return size_machine(load_machine({
        "name": "picker", "supply": {"nominal": "24 V", "accepts": "all"}, "axes": axes, "select": select,
        "robot": {
            "description": str(folder / "robot.xml"), "held": {"fourth": "0.2 rad"}, "law": "poly5",
            "waypoints": [{"positions": one} for one in (start, end, start)],
            "limits": {"first": limits, "second": limits, "third": {"speed": "20 mm/s", "acceleration": "0.1 m/s^2"}},
            "drives": {"third": {"travel_per_turn": "20 mm"}}, **robot,
        },
    }), top=1)  # fmt: skip


def test_a_further_gear_is_one_with_the_drive(tmp_path):
    """The force at each joint by the motor's torque for the load cycle behind the gear, belt before or behind it."""
    axes = {name: {"transmission": [{"kind": "gearhead"}, *stages]} for name, stages in STAGES.items()}
    sizing = picked(tmp_path, axes)
    of = machine_export(sizing)
    for drive in of.robot.drives:
        spec, train = sizing.axis(drive.joint).spec, drive.of.train
        torque, rise, speed = (np.full((1, 2), value) for value in (3.0, 7.0, 11.0))  # of what the gear turns
        before = driven_shaft_cycle(spec, LoadCycle("driving", np.ones(1), speed, rise, torque, 0.0))
        i, e = before.speed[0, 0] / 11.0, train.efficiency
        motor = before.torque[0, 0] / (train.ratio * e) + train.friction
        motor += train.motor_inertia * train.ratio * i * 7.0 + train.viscous * train.ratio * i * 11.0
        r = 0.02 / (2 * np.pi) if drive.joint == "third" else 1.0
        force = 3.0 / r + drive.armature * 7.0 * r + drive.friction + drive.damping * 11.0 * r
        ratio = train.ratio * i / r
        efficiency = {"first": 0.8 * 0.9, "second": 0.8 * 0.92 * 0.9, "third": 0.8 * 0.92 * 0.7}[drive.joint]
        assert (drive.ratio, drive.efficiency) == (pytest.approx(ratio), pytest.approx(efficiency))
        assert force == pytest.approx(ratio * efficiency * motor, rel=1e-9)
        assert float(drive.limits["effort"]) == pytest.approx(
            ratio * efficiency * drive.of.limits.peak_torque.value / (train.ratio * e), rel=1e-9
        )
    text = rendered(of, "mjcf").decode()
    model = mujoco.MjModel.from_xml_string(text)
    assert model.joint("second").armature[0] == pytest.approx(of.robot.drives[1].armature)
    assert "Where the load drives the motor, the gears have an efficiency f of" in text and "input shaft" not in text
    loops = yaml.safe_load(rendered(of, "ros2_control", True))
    law, first = torque_law(of.robot.drives[0].of), loops["velocity_controller"]["ros__parameters"]["gains"]["first"]
    assert first["p"] == pytest.approx(law.kd * (43 * 2.5) ** 2 * 0.8 * 0.9)


def test_a_gear_that_locks_itself_is_refused(tmp_path):
    worm = {"kind": "worm", "ratio": 2, "efficiency": 0.45}
    sizing = picked(tmp_path, {"first": {"transmission": [{"kind": "gearhead"}, worm]}})
    with pytest.raises(InputError, match="first: its worm locks itself, and simulators have no gear that only one"):
        machine_export(sizing)


def test_steppers_at_joints_go_along_the_trajectory(tmp_path):
    """As positions of joints, half of a step behind at most; to ROS as one controller of trajectories."""
    belt = [{"kind": "direct"}, BELT | {"ratio": 4}]
    axes = {"first": {"transmission": belt}, "second": {"transmission": belt}, "third": {"transmission": belt[:1]}}
    select = {"catalogs": ["stepperonline"], "motor": {"kind": "stepper"}}
    of = machine_export(picked(tmp_path, axes, select), one_rate=True)
    model = mujoco.MjModel.from_xml_string(rendered(of, "mjcf").decode())
    data, drives = mujoco.MjData(model), of.robot.drives
    mujoco.mj_resetDataKeyframe(model, data, 0)
    columns = [model.numeric(f"{d.joint}_{what}").data for d in drives for what in ("position", "speed")]
    time, dofs = model.numeric("cycle_time").data, [model.joint(d.joint).dofadr[0] for d in drives]
    behind = np.zeros(3)
    for n in range(round(0.4 / model.opt.timestep)):
        data.ctrl[:] = [np.interp(n * model.opt.timestep, time, one) for one in columns]
        behind = np.maximum(behind, abs(data.qpos[dofs] - data.ctrl[0::2]))
        mujoco.mj_step(model, data)
    assert data.qpos[dofs[0]] > 0.05  # rad, on its way
    for drive, most in zip(drives, behind, strict=True):
        assert most < np.pi / 2 / drive.of.stepper.model.teeth / drive.ratio  # a full step: a quarter of a swing
        assert drive.of.limits.peak_torque.by == "stepper, pull-out torque at rest"
        train = drive.of.train
        expected = train.motor_inertia * train.ratio**2 * train.efficiency + drive.stage_inertia
        assert model.joint(drive.joint).armature[0] == pytest.approx(expected / drive.travel**2)
    files = exported(of, "ros2_control", Path("a.urdf"))
    loops = yaml.safe_load(files[Path("a_controllers.yaml")])
    assert [*loops] == ["controller_manager", "joint_trajectory_controller"]
    assert loops["joint_trajectory_controller"]["ros__parameters"]["joints"] == ["first", "second", "third"]
    taken = ElementTree.fromstring(files[Path("a.urdf")]).findall("ros2_control/joint/command_interface")
    assert {one.get("name") for one in taken} == {"position"}


# --- any description: axes beside their links, joints that slide, belts that pass joints


@pytest.fixture(scope="module")
def picker(tmp_path_factory) -> MachineExport:
    belt = {
        "load": {"kind": "belt_axis", "mass": "3 kg", "pulley_diameter": "40 mm"},
        "motion": {"profile": "trapezoid", "speed": "0.2 m/s", "acceleration_time": "0.3 s", "cruise_time": "1 s"},
    }
    beside = {"on": "link", "link": "column", "at": ["30 mm", "10 mm", "0 mm"]}
    return machine_export(picked(
        tmp_path_factory.mktemp("picker"), {"belt": belt},
        end={"first": "60 deg", "second": "-40 deg", "third": "40 mm"},
        payload={"mass": "0.5 kg", "link": "tip", "at": ["10 mm", "0 mm", "20 mm"]},
        mounting={"roll": "10 deg"}, drives={"second": beside, "third": {"travel_per_turn": "20 mm"}},
    ))  # fmt: skip


def states(count: int) -> tuple[Array, Array, Array]:
    random = np.random.default_rng(7)
    return tuple(random.uniform(-0.15, 0.15, (count, 3)) for _ in range(3))  # type: ignore[return-value]


def torques(of: MachineExport, robot: Any, points: bool) -> Array:
    """Of the description with drives and payload as points, or of another with both in it."""
    one = of.robot
    at = [*(drive.place for drive in one.drives), one.payload] if points else []
    masses = [1.0, *(drive.mass for drive in one.drives), one.payload_mass] if points else [1.0]
    found = torques_of(robot, one.fixed_joints, at, list(one.motion.joints), states(5), one.base.T @ DOWN)
    return np.tensordot(masses, found.torque, 1)


def test_what_is_written_has_the_inertias_of_links_and_drives(picker, tmp_path):
    """Frames of MJCF, its anchors and references in those of URDF, drives by the parallel-axis theorem."""
    written = described(picker, rendered(picker, "urdf"), tmp_path)
    links = picker.robot.robot.links.values()
    assert sum(link.mass for link in written.links.values()) == pytest.approx(
        sum(link.mass for link in links) + sum(drive.mass for drive in picker.robot.drives) + 0.5 + 1.0  # of the belt
    )
    expected = torques(picker, picker.robot.robot, points=True)
    joints = {name: joint for name, joint in written.joints.items() if name != "belt_shaft"}
    alone = type(written)(written.file, written.name, written.links, joints)
    assert torques(picker, alone, points=False) == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_mujoco_reads_the_same_robot(picker):
    """Forces of the joint that slides in N, by its travel; the world upright and the base turned."""
    model = mujoco.MjModel.from_xml_string(rendered(picker, "mjcf").decode())
    data, joints = mujoco.MjData(model), [model.joint(name).dofadr[0] for name in picker.robot.motion.joints]
    expected = torques(picker, picker.robot.robot, points=True)
    for row, state in enumerate(zip(*states(5), strict=True)):
        mujoco.mj_resetDataKeyframe(model, data, 0)
        held = data.qpos[model.joint("fourth").qposadr[0]]
        for name, values in zip(("qpos", "qvel", "qacc"), state, strict=True):
            getattr(data, name)[joints] = values
        mujoco.mj_inverse(model, data)
        found = np.zeros(model.nv)
        mujoco.mj_rne(model, data, 1, found)
        assert held == pytest.approx(0.2) and found[joints] == pytest.approx(expected[row], rel=1e-9, abs=1e-9)
    slide, drive = model.joint("third"), picker.robot.drive("third")
    travel = 0.02 / (2 * np.pi)
    train = drive.of.train
    assert slide.armature[0] == pytest.approx(train.motor_inertia * train.ratio**2 * train.efficiency / travel**2)
    assert model.jnt_actfrcrange[slide.id, 1] == pytest.approx(drive.of.limits.peak_torque.value / travel)
    assert model.joint("belt_shaft").type[0] == mujoco.mjtJoint.mjJNT_HINGE and model.actuator("belt_motor").id > 0
