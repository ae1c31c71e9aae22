"""Whole platforms for simulators, held against the platform's own dynamics, MuJoCo and other readers."""

from __future__ import annotations

import math
from copy import deepcopy
from pathlib import Path
from random import Random
from typing import Any
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
import yaml
import yourdfpy
from exports import rendered
from platforms import acceleration
from small_arms import catalogue

from drivesizer.errors import InputError
from drivesizer.load_cases.platform import dynamics_of, ground_of, trajectory_of
from drivesizer.output.export import export_of, platform_alone
from drivesizer.output.export import files as exported
from drivesizer.output.export.common import torque_law
from drivesizer.output.export.mjcf import lossless
from drivesizer.output.export.platform import PlatformExport, platform_export
from drivesizer.platform.dynamics import Moving, motion, wheel_torques
from drivesizer.sizing import explain
from drivesizer.spec.description import read_description
from drivesizer.spec.robot import RobotSpec, load_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

CART: dict[str, Any] = {
    "name": "cart", "supply": {"nominal": "24 V", "accepts": "all"},
    "load": {"kind": "wheeled_vehicle", "mass": "30 kg", "driven_wheels": 2, "wheel_diameter": "160 mm",
             "rolling_resistance": 0.02, "inertia": "30 kg*cm^2", "friction_coefficient": 0.7},
    "platform": {"layout": {"kind": "differential", "track": "400 mm"}, "casters": [{"x": "300 mm", "y": "0 mm"}],
                 "inertia": "1.5 kg*m^2", "centre_of_mass": {"x": "80 mm", "y": "20 mm", "height": "150 mm"}},
    "motion": {"profile": "trapezoid", "speed": "0.8 m/s", "acceleration_time": "1 s", "cruise_time": "2 s"},
    "transmission": [{"kind": "gearhead"}, {"kind": "belt", "ratio": 1.2, "efficiency": 0.9, "inertia": "4 kg*cm^2"}],
    "control": {"rate": "1 kHz"}, "select": {"estimates": "off"},
}  # fmt: skip
LIMITS = {"speed": "1.2 m/s", "acceleration": "0.75 m/s^2", "jerk": "3 m/s^3", "turning_speed": "60 deg/s",
          "turning_acceleration": "40 deg/s^2"}  # fmt: skip
ALONG = [{"x": "0 m", "y": "0 m"}, {"x": "0.6 m", "y": "0.35 m", "heading": "25 deg"}, {"x": "0 m", "y": "0 m"}]
MECANUM = {
    "load": {"driven_wheels": 4, "mass": "45 kg"}, "motion": {"waypoints": [{"heading": "0 deg"} | p for p in ALONG]},
    "platform": {
        "layout": {"kind": "mecanum", "wheelbase": "477 mm", "track": "270 mm", "roller_angle": "45 deg"},
        "casters": [], "limits": LIMITS, "size": {"length": "700 mm", "width": "350 mm", "height": "180 mm"},
        "centre_of_mass": {"x": "20 mm", "y": "-10 mm", "height": "90 mm"},
        "payloads": [{"name": "box", "mass": "5 kg", "x": "100 mm", "height": "250 mm", "inertia": "0.05 kg*m^2"}],
    },
}  # fmt: skip
OMNI = {"load": {"driven_wheels": 3}, "platform": {"layout": {"kind": "omni", "radius": "250 mm"}, "casters": []}}
Made = tuple[RobotSpec, PlatformExport]


def changed(*changes: dict[str, Any]) -> dict[str, Any]:
    """The cart with fields of its sections changed, or a section where that is no mapping of fields."""
    data = deepcopy(CART)
    for change in changes:
        for name, section in change.items():
            whole = name == "motion" or not isinstance(section, dict)
            data[name] = section if whole else {**data.get(name, {}), **section}
    return data


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> Any:
    """A platform by its changes, with parts that are named, so that nothing is searched."""
    parts = tmp_path_factory.mktemp("platform") / "parts.yaml"
    parts.write_text(catalogue(Random(3)), encoding="utf-8")

    def make(*changes: dict[str, Any]) -> Made:
        spec = load_spec(changed({"select": {"catalogs": [str(parts)]}}, *changes))
        return spec, platform_export(spec, explain(spec, "m1", "g0")[0])

    return make


@pytest.fixture(scope="module")
def cart(made) -> Made:
    return made()


@pytest.fixture(scope="module")
def mecanum(made) -> Made:
    return made(MECANUM)


@pytest.fixture(scope="module")
def omni(made) -> Made:
    return made(OMNI)


def model_of(of: PlatformExport) -> Any:
    return mujoco.MjModel.from_xml_string(rendered(of, "mjcf").decode())


def parameters(of: PlatformExport) -> dict[str, Any]:
    files = exported(platform_alone(of), "ros2_control", Path("base.urdf"))
    return {name: one["ros__parameters"] for name, one in yaml.safe_load(files[Path("base_controllers.yaml")]).items()}


# --- mass, inertia, limits


@pytest.mark.parametrize("kind", ["cart", "mecanum"])
def test_mass_centre_and_inertia_are_those_of_the_spec(kind, request, tmp_path):
    """By hand of the spec: payloads, the parallel axes; read from the URDF and from MuJoCo's composite inertia."""
    spec, of = request.getfixturevalue(kind)
    mass, x, inertia = (30.0, 0.08, 1.5)
    if kind == "mecanum":
        mass, x = 45.0, (40 * 0.02 + 5 * 0.1) / 45
        inertia = 1.5 + 0.05 + 40 * 5 / 45 * (0.08**2 + 0.01**2)
    height = 0.15 if kind == "cart" else (40 * 0.09 + 5 * 0.25) / 45
    path = tmp_path / "base.urdf"
    path.write_bytes(rendered(of, "urdf"))
    links = read_description(path).links
    assert sum(link.mass for link in links.values()) == pytest.approx(mass, rel=1e-9)
    model = model_of(of)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert model.body_subtreemass[1] == pytest.approx(mass, rel=1e-9)
    centre = data.subtree_com[1]
    assert (centre[0], centre[2]) == (pytest.approx(x), pytest.approx(height))
    about = model.body_inertia[:, 2].sum()
    levers = ((data.xipos[1:, :2] - centre[:2]) ** 2).sum(axis=1) @ model.body_mass[1:]
    assert about + levers == pytest.approx(inertia, rel=1e-9)
    assert of.platform.mass == spec.load.mass


def test_urdf_is_read_by_another_s_reader(mecanum, tmp_path):
    _, of = mecanum
    path = tmp_path / "base.urdf"
    path.write_bytes(rendered(of, "urdf"))
    robot = yourdfpy.URDF.load(str(path), load_meshes=False)
    assert robot.validate(), robot.errors
    assert [name for name, joint in robot.joint_map.items() if joint.type == "continuous"] == [
        "wheel_1", "wheel_2", "wheel_3", "wheel_4",
    ]  # fmt: skip
    first, train = robot.joint_map["wheel_1"], of.of.train
    assert float(first.limit.effort) == pytest.approx(of.of.limits.peak_torque.value)
    motor = train.friction * train.ratio * train.efficiency
    load = of.rolling[0]  # N*m: the wheel's share of the weight, of a centre of mass beside the middle
    assert sum(of.rolling) == pytest.approx(0.02 * 45 * 9.80665 * 0.08)
    assert load != of.rolling[2] and float(first.dynamics.friction) == pytest.approx(motor + load)
    assert robot.base_link == "base_footprint"
    place = robot.get_transform("wheel_1_link")
    assert place[:3, 3] == pytest.approx([0.2385, -0.135, 0.08])


# --- MuJoCo against the platform's own dynamics


class Standing:
    """A platform in MuJoCo that has sunk into its floor, its motors off, torques at its wheels."""

    def __init__(self, of: PlatformExport) -> None:
        self.model = model_of(of)
        self.data = mujoco.MjData(self.model)
        self.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_ACTUATION
        wheels = of.kinematics.wheels
        self.turned = np.array([math.cos(wheel.roller_angle) for wheel in wheels])
        self.dof = [self.model.joint(f"wheel_{n + 1}").dofadr[0] for n in range(len(wheels))]
        self.go(0.3)
        self.data.qvel[:] = 0.0

    def go(self, seconds: float) -> None:
        mujoco.mj_step(self.model, self.data, round(seconds / self.model.opt.timestep))

    def set(self, of: PlatformExport, eta: Any, torque: Any) -> None:
        self.data.qvel[[0, 1, 5]] = eta
        self.data.qvel[self.dof] = of.kinematics.E @ eta * self.turned
        self.data.qfrc_applied[self.dof] = np.asarray(torque) / self.turned

    @property
    def eta(self) -> np.ndarray:
        ahead = self.data.xmat[1].reshape(3, 3).T @ self.data.qvel[:3]
        return np.array([ahead[0], ahead[1], self.data.qvel[5]])

    @property
    def wheels(self) -> np.ndarray:
        return self.data.qvel[self.dof] / self.turned


@pytest.mark.parametrize(
    ("kind", "eta", "torque", "within"),
    [
        ("mecanum", (0.3, 0.0, 0.0), (1.2, 1.2, 1.2, 1.2), 0.002),
        ("mecanum", (0.1, 0.3, -0.2), (1.0, -0.4, 0.9, -0.3), 0.01),
        ("mecanum", (0.05, 0.02, 0.4), (0.8, -0.2, 0.1, 0.9), 0.01),
        ("omni", (0.1, 0.2, 0.3), (0.2, 1.0, 0.5), 0.01),
        ("cart", (0.3, 0.0, -0.5), (1.2, 0.8), 0.015),
    ],
)
def test_torques_at_the_wheels_accelerate_as_the_dynamics_say(kind, eta, torque, within, request):
    """(49) with the drives' rotors, and wheels that turn as (32): contacts alone move the platform in MuJoCo."""
    spec, of = request.getfixturevalue(kind)
    drive, k = next(iter(of.drives.values())), of.kinematics
    one, seconds = Standing(of), 0.05
    one.set(of, eta, torque)
    one.go(0.02)
    before = one.eta
    one.go(seconds)
    found, middle = (one.eta - before) / seconds, (one.eta + before) / 2.0
    d = dynamics_of(spec, drive.armature)
    turning = k.E[list(k.driven)] @ middle
    lost = drive.friction * np.sign(turning) + drive.damping * turning
    expected = acceleration(d, middle, torque - lost, ground=ground_of(spec))
    assert np.abs(expected).max() > 0.2
    reach = np.array([1.0, 1.0, 0.25])  # m, of turning
    assert np.abs(reach * (found - expected)).max() < within * max(np.abs(reach * expected).max(), 0.5)
    assert one.wheels == pytest.approx(k.E @ one.eta, abs=0.01)  # rad/s of up to 7


def test_a_slope_is_a_tilted_gravity(made):
    _, of = made({"load": {"slope": "4 deg"}, "platform": {"uphill": "180 deg"}})
    one = Standing(of)
    one.set(of, (0.0, 0.0, 0.0), (0.0, 0.0))
    one.model.dof_frictionloss[:] = 0.0
    one.go(0.2)
    drive = of.drives[0]
    mass = 30.0 + 2 * (0.003 + drive.armature) / 0.08**2
    caster = 0.02 * one.data.contact[0].dist  # below 0: it is in the floor
    along = 30.0 * 9.80665 * math.sin(math.radians(4.0))
    assert caster < 0.0 < one.eta[0] < 0.2 * along / mass  # downhill, which is forwards here
    assert one.eta[0] == pytest.approx(0.2 * along / mass, rel=0.1)
    assert np.linalg.norm(one.model.opt.gravity) == pytest.approx(9.80665)


def test_under_the_designed_loops_it_goes_its_way_with_the_torques_of_the_sizing(mecanum):
    """A diagonal with a turn, from rest to rest: posture at its end to a millimetre, forces on the way to 1 %."""
    spec, of = mecanum
    model, trajectory = model_of(of), trajectory_of(spec)
    data, step, K = mujoco.MjData(model), model.opt.timestep, of.drives[0].ratio
    ahead = torque_law(lossless(of.drives[0])).per_speed
    mujoco.mj_step(model, data, round(0.3 / step))
    data.qvel[:] = 0.0
    start, torques, times = data.actuator_length.copy(), [], np.arange(0.0, trajectory.total / 2.0, step)
    speeds = np.stack([np.interp(times, of.time, one) for one in of.kinematics.E @ of.eta], axis=1)
    angles = np.cumsum(speeds, axis=0) * step
    assert model.numeric("wheel_2_speed").data == pytest.approx(of.kinematics.E[1] @ of.eta, abs=1e-9)
    for speed, angle in zip(speeds, angles, strict=True):
        data.ctrl[0::3], data.ctrl[1::3], data.ctrl[2::3] = start + K * angle, K * speed, ahead * K * speed
        mujoco.mj_step(model, data)
        torques.append(data.actuator_force * K)
    assert data.qpos[:2] == pytest.approx([0.6, 0.35], abs=1e-3)
    assert 2.0 * math.atan2(data.qpos[6], data.qpos[3]) == pytest.approx(math.radians(25.0), abs=1e-3)
    d = dynamics_of(spec, of.drives[0].armature)
    seen = motion(d, trajectory, ground_of(spec))
    ends = np.cumsum(seen.duration)
    force = of.kinematics.E.T * [[1.0], [1.0], [4.0]]  # N, on the platform; turning it as at 0.25 m
    for share in (0.3, 0.75):  # in an acceleration and in a deceleration
        at = int(np.searchsorted(ends, share * times[-1]))
        eta, rise = seen.eta[:, at].mean(axis=1), seen.eta_dot[:, at].mean(axis=1)
        middle = round((ends[at] - seen.duration[at] / 2) / step)
        found = np.mean(torques[middle - 20 : middle + 20], axis=0)
        turning = of.kinematics.E @ eta
        lost = of.drives[0].friction * np.sign(turning) + of.drives[0].damping * turning
        expected = wheel_torques(d, Moving(eta, rise)) + lost
        assert np.abs(expected).max() > 0.9
        assert np.abs(force @ (found - expected)).max() < 0.01 * np.abs(force @ expected).max()
        assert np.abs(found - expected).max() < 0.08 * np.abs(expected).max()  # wheels push one another a little


# --- ros2_control

LIMITED = ("max_velocity", "min_velocity", "max_acceleration", "max_deceleration", "max_jerk", "min_jerk")
OLDER = ("has_velocity_limits", "has_acceleration_limits", "has_jerk_limits")
CORNERS = ("front_left", "front_right", "rear_right", "rear_left")
DECLARED = {  # github.com/ros-controls/ros2_controllers, tags 2.54.0, 4.42.1, 5.17.0 and 6.9.0: names in these files
    # diff_drive_controller/src/diff_drive_controller_parameter.yaml
    "diff_drive_controller/DiffDriveController": {
        "left_wheel_names", "right_wheel_names", "wheel_separation", "wheels_per_side", "wheel_radius",
        "position_feedback", "cmd_vel_timeout", "odom_frame_id", "base_frame_id",
        *(f"{axis}.{name}" for axis in ("linear.x", "angular.z") for name in (*LIMITED, *OLDER)),
    },
    # mecanum_drive_controller/src/mecanum_drive_controller.yaml
    "mecanum_drive_controller/MecanumDriveController": {
        "reference_timeout", *(f"{c}_wheel_{what}_joint_name" for c in CORNERS for what in ("command", "state")),
        *(f"kinematics.base_frame_offset.{name}" for name in ("x", "y", "theta")), "kinematics.wheels_radius",
        "kinematics.sum_of_robot_center_projection_on_X_Y_axis", "odom_frame_id", "base_frame_id",
        *(f"{axis}.{name}" for axis in ("linear.x", "linear.y", "angular.z") for name in LIMITED),
    },
    # omni_wheel_drive_controller/src/omni_wheel_drive_controller_parameters.yaml
    "omni_wheel_drive_controller/OmniWheelDriveController": {
        "wheel_offset", "wheel_names", "robot_radius", "wheel_radius", "position_feedback", "cmd_vel_timeout",
        "odom_frame_id", "base_frame_id",
    },
}  # fmt: skip


def flat(values: dict[str, Any], before: str = "") -> dict[str, Any]:
    found = {}
    for name, value in values.items():
        found |= flat(value, f"{before}{name}.") if isinstance(value, dict) else {before + name: value}
    return found


@pytest.mark.parametrize("kind", ["cart", "mecanum", "omni"])
def test_parameters_are_those_that_the_controllers_declare(kind, request):
    _, of = request.getfixturevalue(kind)
    found = parameters(of)
    plugin = found["controller_manager"]["base_controller"]["type"]
    given = flat(found["base_controller"])
    assert plugin.startswith({"cart": "diff", "mecanum": "mecanum", "omni": "omni"}[kind])
    assert set(given) <= DECLARED[plugin]
    whole = {"wheels_per_side"}  # declared as integers; the others are floats, and YAML must say so
    assert all(isinstance(v, float) for k, v in given.items() if type(v) in (int, float) and k not in whole)
    loops = found["velocity_controller"]
    assert [*loops["gains"]] == loops["dof_names"] == [drive.joint for drive in of.drives.values()]
    assert found["controller_manager"]["update_rate"] == 1000


def commanded(plugin: str, p: dict[str, Any], eta: Any) -> dict[str, float]:
    """Speeds that the controllers' own sources command: update_and_write_commands, or compute_and_set_... of omni."""
    x, y, w = eta
    if plugin.startswith("diff"):
        half, r = p["wheel_separation"] / 2, p["wheel_radius"]
        left, right = (x - w * half) / r, (x + w * half) / r
        return dict.fromkeys(p["left_wheel_names"], left) | dict.fromkeys(p["right_wheel_names"], right)
    if plugin.startswith("mecanum"):
        k, base = p["kinematics"], p["kinematics"]["base_frame_offset"]
        x, y = x + base["y"] * w, y - base["x"] * w
        turning = k["sum_of_robot_center_projection_on_X_Y_axis"] * w
        speeds = (x - y - turning, x + y + turning, x - y + turning, x + y - turning)
        return {
            p[f"{c}_wheel_command_joint_name"]: v / k["wheels_radius"] for c, v in zip(CORNERS, speeds, strict=True)
        }
    between = 2 * math.pi / len(p["wheel_names"])
    angles = [between * n + p["wheel_offset"] for n in range(len(p["wheel_names"]))]
    return {
        name: (math.sin(a) * x - math.cos(a) * y - w * p["robot_radius"]) / p["wheel_radius"]
        for name, a in zip(p["wheel_names"], angles, strict=True)
    }


SHIFTED = [  # a rectangle off the reference point, numbered from the rear
    {"kind": "mecanum", "x": f"{x} mm", "y": f"{y} mm", "roller_angle": f"{g} deg"}
    for x, y, g in ((-150, 160, 45), (250, -120, 45), (250, 160, -45), (-150, -120, -45))
]


@pytest.mark.parametrize("kind", ["cart", "mecanum", "omni", "shifted"])
def test_the_controller_turns_the_wheels_as_the_kinematics_do(kind, request, made):
    if kind == "shifted":
        _, of = made(MECANUM, {"platform": {"wheels": SHIFTED, "layout": None}})
    else:
        _, of = request.getfixturevalue(kind)
    found = parameters(of)
    eta = np.array([0.7, 0.0 if kind == "cart" else -0.4, 0.9])
    speeds = commanded(found["controller_manager"]["base_controller"]["type"], found["base_controller"], eta)
    root = ElementTree.fromstring(rendered(of, "ros2_control"))
    for place, expected in enumerate(of.kinematics.E @ eta):
        name = f"wheel_{place + 1}"
        axis = root.find(f"joint[@name='{name}']/axis").get("xyz")  # type: ignore[union-attr]
        forwards = {"0 1 0": 1.0, "0 -1 0": -1.0}[axis]
        assert speeds[f"velocity_controller/{name}"] == pytest.approx(forwards * expected, abs=1e-9)
        reduction = root.find(f".//joint[@name='{name}']/mechanical_reduction").text  # type: ignore[union-attr]
        assert float(reduction) == pytest.approx(forwards * 43 * 1.2)


def test_limits_are_what_the_drives_reach_or_the_spec_allows(cart, mecanum):
    """By hand of the data sheet: 36.6 mN*m/A, 0.8 ohm, 6000 rpm and 20 mA at no load; 43:1, 80 %; belt 1.2, 90 %."""
    _, of = cart
    k, K, e = 36.6e-3, 43 * 1.2, 0.8 * 0.9
    back_emf = (24.0 - 0.8 * 0.02) / (6000 * math.pi / 30)  # V*s/rad
    torque = max(of.rolling) / (K * e) + k * 0.02
    speed = (0.95 * 24.0 - 0.8 * torque / k) / back_emf / K * 0.08  # m/s
    given = flat(parameters(of)["base_controller"])
    assert given["linear.x.max_velocity"] == pytest.approx(speed, rel=1e-3) == -given["linear.x.min_velocity"]
    assert given["angular.z.max_velocity"] == pytest.approx(speed / 0.2, rel=1e-3)
    assert (given["linear.x.max_acceleration"], given["linear.x.max_deceleration"]) == (0.8, -0.8)  # of its motion
    assert "angular.z.max_acceleration" not in given  # which does not turn
    _, of = mecanum
    given = flat(parameters(of)["base_controller"])
    assert [given[f"linear.y.max_{what}"] for what in ("acceleration", "jerk")] == [0.75, 3.0]
    assert given["angular.z.max_velocity"] == pytest.approx(math.radians(60))  # of the spec, below the drives' 2.5
    assert given["linear.x.max_velocity"] < 1.2  # of the drives, below the spec's


def test_wheels_that_no_controller_fits_have_none_and_say_so(made):
    skewed = [{"kind": "omni", "x": f"{x} mm", "y": f"{y} mm", "heading": f"{h} deg"}
              for x, y, h in ((300, 0, 90), (-200, 200, 200), (-150, -200, -30))]  # fmt: skip
    _, of = made(OMNI, {"platform": {"wheels": skewed, "layout": None}})
    text = rendered(of, "ros2_control", True).decode()
    assert "no controller of ros2_controllers drives these wheels" in text and "base_controller" not in text
    assert model_of(of).nu == 9


# --- what else may be


def test_the_mass_is_the_one_that_it_was_sized_for(made):
    budget = {"structure": "20 kg", "drive_counts": True, "others": [{"name": "equipment", "mass": "3 kg"}]}
    spec, of = made({"budget": budget})
    parts = explain(spec, "m1", "g0")[0].parts
    drives = 2 * sum(parts[role].mass for role in ("motor", "gearhead", "controller"))
    assert spec.load.mass == 30.0 and model_of(of).body_mass.sum() == pytest.approx(23.0 + drives)


def test_one_wheel_has_its_own_motion(mecanum):
    spec, of = mecanum
    found = explain(spec, "m1", "g0")[0]
    own = [export_of(spec, found, wheel) for wheel in (1, 2)]
    for number, one in enumerate(own, 1):
        top = np.abs(of.kinematics.E[number - 1] @ of.eta).max()
        assert np.abs(one.cycle.speed).max() == pytest.approx(top, rel=1e-6)
        assert any(f"those of wheel {number}" in line or f"{number} and" in line for line in one.assumptions)
    assert np.abs(own[0].cycle.speed).max() != pytest.approx(np.abs(own[1].cycle.speed).max(), rel=0.1)
    with pytest.raises(InputError, match="--wheel: 5 is no driven wheel; expected one of 1, 2, 3, 4"):
        export_of(spec, found, 5)
