"""What is in the exported files: figures by hand from the data sheets, structure by the readers of others."""

from __future__ import annotations

import io
import json
import math
import xml.etree.ElementTree as ET
from dataclasses import replace

import jsonschema
import numpy as np
import pytest
import yaml
import yourdfpy
from exports import rendered
from specs import poorer

from drivesizer.control.validation import Cascade
from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.output.export import FORMATS, accept, export_of, files, one_axis, write
from drivesizer.output.export.common import torque_law
from drivesizer.output.export.machine import document, export_schema
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import load_spec, read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

# RE 25 118752, GP 26 A 406764, EPOS4 Compact 50/5, belt 1.1, of the data sheets and the spec
K_T, R, I_NOMINAL = 23.4e-3, 2.32, 1.16
RATIO, E_GEAR, E_BELT, BELT = 3249 / 121, 0.80, 0.95, 1.1
K, E = RATIO * BELT, E_GEAR * E_BELT
USABLE = 0.9 * (22.0 - 1.0)  # V: duty, lowest supply voltage, drop
ROTOR = (10.8 + 0.54) * 1e-7  # kg*m^2: rotor and gearhead input
FRICTION = 0.65 * K_T * 36.9e-3  # N*m: 65 % of what the no-load current overcomes
VISCOUS = 0.35 * K_T * 36.9e-3 / (9560 * math.pi / 30)  # N*m*s/rad: the rest of it, by the no-load speed
ROLLING = 0.02 * 45.0 / 4 * 9.80665 * 0.0762  # N*m


@pytest.fixture(scope="module")
def found(spec, catalog):
    return size(spec, catalog=poorer(catalog), top=1).sets[0]


@pytest.fixture(scope="module")
def export(spec, found):
    return export_of(spec, found)


def fitted(found, **parts):
    """The set with other figures of its parts: ``motor={"peak_torque": 1.0}``."""
    return replace(found, **{role: replace(getattr(found, role), **new) for role, new in parts.items()})


# --- limits at the driven shaft


def test_limits_by_hand(export):
    limits = export.limits
    assert limits.peak_torque.value == pytest.approx(3.2 * BELT * E_BELT)  # gearhead, intermittent
    assert limits.peak_torque.by == "gearhead, intermittent torque"
    assert limits.continuous_torque.value == pytest.approx(K_T * I_NOMINAL * K * E)
    assert limits.continuous_torque.by == "motor, nominal current"
    assert limits.peak_speed.value == pytest.approx((USABLE - R * FRICTION / K_T) / (K_T + R * VISCOUS / K_T) / K)
    assert limits.peak_speed.unknown == ("motor, permissible speed",)


def test_the_stall_torque_of_the_data_sheet(spec, found):
    """At 24 V at the terminals: stall torque 243 mN*m, no-load speed 9560 rpm, as printed, through the gears."""
    strong = fitted(found, gearhead={"intermittent_torque": 50.0}, controller={"max_duty": 1.0, "voltage_drop": 0.0})
    full = spec.model_copy(update={"supply": spec.supply.model_copy(update={"min": 24.0})})
    limits = export_of(full, strong).limits
    assert limits.peak_torque.by == "motor at stall"
    assert limits.peak_torque.value == pytest.approx(0.243 * K * E, rel=0.005)  # k_t U / R is 0.4 % below as printed
    assert limits.peak_speed.value == pytest.approx(9560 * math.pi / 30 / K, rel=0.025)  # of U / k_t: the tolerance
    weak = fitted(strong, controller={"peak_current": 3.0})
    assert export_of(full, weak).limits.peak_torque.value == pytest.approx(3.0 * K_T * K * E)
    told = fitted(strong, motor={"peak_torque": 0.05})
    assert export_of(full, told).limits.peak_torque == (pytest.approx(0.05 * K * E), "motor, peak torque", ())


def test_limits_follow_what_is_least(spec, found):
    slow = fitted(found, gearhead={"intermittent_input_speed": 100.0, "continuous_input_speed": 50.0})
    limits = export_of(spec, slow).limits
    speeds = limits.peak_speed.value, limits.continuous_speed.value
    assert speeds == (pytest.approx(100.0 / K), pytest.approx(50.0 / K))
    soft = fitted(found, gearhead={"continuous_torque": 0.1})
    assert export_of(spec, soft).limits.continuous_torque.value == pytest.approx(0.1 * BELT * E_BELT)
    hot = spec.model_copy(update={"environment": spec.environment.model_copy(update={"ambient": 273.15 + 62.5})})
    warm = fitted(found, motor={"max_winding_temperature": 273.15 + 100.0})
    assert export_of(hot, warm).limits.continuous_torque.value == pytest.approx(
        K_T * I_NOMINAL * math.sqrt(0.5) * K * E
    )  # half of the 75 K are left


def test_an_electrical_speed_counts_pole_pairs(spec, found):
    turned = fitted(found, motor={"kind": "brushless", "pole_pairs": 7.0}, controller={"max_speed_sine": 700.0})
    assert export_of(spec, turned).limits.peak_speed.value == pytest.approx(100.0 / K)


def test_what_is_unknown_stays_unknown(spec, found):
    nan = math.nan
    bare = fitted(found, gearhead={"intermittent_torque": nan}, controller={"peak_current": nan})
    limit = export_of(spec, bare).limits.peak_torque
    assert limit.by == "motor at stall" and set(limit.unknown) == {
        "controller, peak current", "gearhead, intermittent torque",
    }  # fmt: skip
    lasting = fitted(
        found, motor={"nominal_current": nan}, controller={"continuous_current": nan},
        gearhead={"continuous_torque": nan},
    )  # fmt: skip
    assert math.isnan(export_of(spec, lasting).limits.continuous_torque.value)
    told = document(export_of(spec, lasting))["limits"]["continuous_torque"]
    assert (told["value"], told["by"], len(told["unknown"])) == (None, "", 3)


# --- what is reflected to the shaft


def test_inertia_and_friction_at_the_shaft(export):
    cylinders = sum(
        density * width * math.pi / 32 * (outer**4 - inner**4)
        for density, width, outer, inner in ((1100, 0.05, 0.1524, 0.06), (7850, 0.08, 0.012, 0.0))
    )
    load = 45.0 / 4 * 0.0762**2 + cylinders
    assert export.inertia == pytest.approx(load + ROTOR * K * K * E)
    assert export.friction == pytest.approx(ROLLING + FRICTION * K * E)
    assert export.damping == pytest.approx(VISCOUS * K * K * E)


def test_viscous_friction_goes_by_the_square(spec, found):
    loss = K_T * 36.9e-3  # N*m at no load
    smooth = export_of(spec, fitted(found, motor={"kind": "brushless"}))
    assert smooth.damping == pytest.approx(0.45 * loss / found.motor.no_load_speed * K * K * E)
    assert smooth.friction == pytest.approx(ROLLING + 0.55 * loss * K * E)


# --- URDF and SDF


def test_urdf_by_another_s_reader(export):
    robot = yourdfpy.URDF.load(io.BytesIO(rendered(export, "urdf")), build_scene_graph=False, load_meshes=False)
    assert robot.validate(), robot.errors
    joint, link = robot.robot.joints[0], robot.robot.links[1]
    assert (joint.name, joint.type, joint.parent, joint.child) == ("shaft", "continuous", "base", "load")
    assert joint.limit.effort == pytest.approx(3.344) and joint.limit.velocity == pytest.approx(
        export.limits.peak_speed.value
    )
    assert float(joint.dynamics.friction) == pytest.approx(export.friction)
    assert link.inertial.inertia[2, 2] == pytest.approx(export.inertia)
    reduction = ET.fromstring(rendered(export, "urdf")).find("transmission/actuator/mechanicalReduction").text
    assert float(reduction) == pytest.approx(K)  # yourdfpy leaves transmissions aside


def test_a_limit_that_is_unknown_has_no_place_in_urdf(spec, found):
    nan = math.nan
    slow = export_of(spec, found)
    none = replace(slow, limits=slow.limits._replace(peak_torque=slow.limits.peak_torque._replace(value=nan, by="")))
    for form in ("urdf", "ros2_control"):
        with pytest.raises(InputError, match="no limit of torque of RE 25 118752"):
            rendered(none, form)
    assert ET.fromstring(rendered(none, "sdf")).find(".//limit/effort") is None  # SDF may leave it out


SDF = {  # element: what stands below it, as sdformat 1.7 describes it
    "sdf": ("model",), "model": ("link", "joint"), "link": ("inertial",), "inertial": ("mass", "inertia"),
    "inertia": ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), "joint": ("parent", "child", "axis"),
    "axis": ("xyz", "limit", "dynamics"), "limit": ("lower", "upper", "effort", "velocity"),
    "dynamics": ("damping", "friction", "spring_reference", "spring_stiffness"),
}  # fmt: skip


def test_sdf_has_the_structure_of_its_specification(export):
    root = ET.fromstring(rendered(export, "sdf"))
    for element in root.iter():
        below, without = [child.tag for child in element], element.get("name") in ("base", "stand")
        wanted = set(SDF.get(element.tag, ()))
        assert set(below) == wanted - {"axis", "inertial"} if without else set(below) == wanted, element.tag
        assert element.tag == "model" or len(below) == len(set(below))
        assert bool((element.text or "").strip()) != bool(wanted), element.tag
    links = {link.get("name") for link in root.iter("link")}
    for joint in root.iter("joint"):
        assert joint.find("child").text in links and joint.find("parent").text in links | {"world"}
    joint = root.find("model/joint[@name='shaft']")
    figures = {
        element.tag: float(element.text) for element in joint.iter() if element.tag in (*SDF["limit"], *SDF["dynamics"])
    }
    assert figures["effort"] == pytest.approx(3.344) and figures["friction"] == pytest.approx(export.friction)
    assert float(root.find(".//izz").text) == pytest.approx(export.inertia)


def remarks(raw):
    parser = ET.XMLParser(target=ET.TreeBuilder(insert_comments=True))
    return [e.text for e in ET.fromstring(raw, parser=parser).iter() if e.tag is ET.Comment]


@pytest.mark.parametrize("form", ["urdf", "sdf", "ros2_control"])
def test_a_file_says_which_limit_it_has_and_why(form, export):
    said = " ".join(remarks(rendered(export, form)))
    assert "effort is the peak torque, 3.344 N*m (gearhead, intermittent torque)" in said
    assert f"continuous torque, {export.limits.continuous_torque.value:.5g} N*m (motor, nominal current)" in said
    assert "unknown: motor, permissible speed" in said and "weight" not in said


# --- ros2_control


def test_gains_of_ros2_control_close_the_loop_that_was_designed(export):
    """By hand: the voltage PI and the motor's own back-EMF, as torque at the shaft per speed of it."""
    made = yaml.safe_load(rendered(export, "ros2_control", True))
    gains = made["velocity_controller"]["ros__parameters"]["gains"]["shaft"]
    c = export.controller
    for w_r, w, angle in ((3.0, 2.0, 0.1), (0.0, 1.0, -0.2)):  # rad/s and rad of the shaft, 'angle' the summed error
        volts = c.kp * K * (w_r - w) + c.ki * K * angle
        torque = K_T / R * (volts - K_T * K * w) * K * E
        ours = gains["p"] * (w_r - w) + gains["i"] * angle + gains["feedforward_gain"] * w_r
        assert ours == pytest.approx(torque)
    assert made["controller_manager"]["ros__parameters"]["update_rate"] == 2500
    feedforward = K_T**2 / R * K**2 * E  # N*m*s/rad, which what p and i make must carry beside the effort
    held = 3.344 + feedforward * export.limits.peak_speed.value
    assert gains["u_clamp_max"] == -gains["u_clamp_min"] == gains["i_clamp_max"] == pytest.approx(held)
    assert all(isinstance(gains[name], float) for name in ("p", "i", "d", "feedforward_gain", "u_clamp_max"))


# ros2_controllers, pid_controller/src/pid_controller.yaml at these tags: what a joint's gains are called
HUMBLE = {"p", "i", "d", "antiwindup", "i_clamp_max", "i_clamp_min", "feedforward_gain", "angle_wraparound"}
SINCE = HUMBLE - {"antiwindup"} | {
    "u_clamp_max", "u_clamp_min", "antiwindup_strategy", "tracking_time_constant", "error_deadband", "save_i_term",
}  # fmt: skip
DECLARED = {"2.54.0": HUMBLE, "4.42.1": SINCE | {"antiwindup"}, "5.17.0": SINCE, "6.9.0": SINCE}


@pytest.mark.parametrize("version", DECLARED)
def test_every_version_of_ros2_controllers_finds_its_names(export, version):
    """What a version does not declare it passes over; what it needs for the integral to work and be held is there."""
    made = yaml.safe_load(rendered(export, "ros2_control", True))
    own = made["velocity_controller"]["ros__parameters"]
    gains = set(own["gains"]["shaft"])
    assert gains <= set().union(*DECLARED.values())
    held = {"i_clamp_max", "i_clamp_min"} if version.startswith("2.") else {"u_clamp_max", "antiwindup_strategy"}
    assert {"p", "i", "feedforward_gain"} | held <= gains & DECLARED[version]
    assert own["enable_feedforward"] is True  # 4.x: off by default
    assert own["gains"]["shaft"]["antiwindup_strategy"] == "conditional_integration"
    manager = made["controller_manager"]["ros__parameters"]
    assert own["update_rate"] == manager["update_rate"] == round(1 / export.period)


def test_a_position_loop_has_no_place_in_a_velocity_controller(export):
    with pytest.raises(InputError, match=r"leave control\.position out"):
        rendered(replace(export, controller=CASCADE), "ros2_control", True)


# --- the torque law


CASCADE = Cascade(
    current_kp=1.0, current_ki=1e4, velocity_kp=0.5, velocity_ki=30.0, position_kp=15.0, feedforward_velocity=1e-4,
    feedforward_friction=0.3, feedforward_acceleration=0.007, current_period=4e-5, velocity_period=4e-4,
    position_period=4e-4,
)  # fmt: skip


def test_the_law_of_a_cascade_is_its_two_loops(export):
    """Loop by loop, with integrals as sums, against the one law."""
    law = torque_law(replace(export, controller=CASCADE))
    c, h, inner, summed = CASCADE, 1e-3, 0.0, 0.0
    errors = [(0.2 * math.sin(3 * t * h), 0.6 * math.cos(3 * t * h)) for t in range(500)]  # rad, rad/s
    for angle, speed in errors:
        wanted = c.position_kp * angle
        current = c.velocity_kp * (wanted + speed) + c.velocity_ki * inner + 1e-4 * 8.0 + 0.3 + 0.007 * 2.0
        one = law.kp * angle + law.kd * speed + law.ki * summed
        one += law.per_speed * 8.0 + law.per_direction + law.per_acceleration * 2.0
        assert one == pytest.approx(K_T * current, abs=2e-4)  # the angle itself is a sum in one and not in the other
        inner += h * (wanted + speed)
        summed += h * angle


# --- JSON


def test_the_document_obeys_its_schema(export, spec, found):
    for one in (
        export,
        replace(export, controller=CASCADE),
        export_of(spec, fitted(found, controller={"peak_current": math.nan})),
    ):
        made = json.loads(rendered(one, "json"))
        jsonschema.Draft202012Validator(export_schema()).validate(made)
    assert made["axes"][0]["peak_current"] is None
    made["axes"][0]["train"].pop("gear_ratio")
    assert not jsonschema.Draft202012Validator(export_schema()).is_valid(made)


# --- names, bytes, targets


@pytest.mark.parametrize(
    "name", ['a<b>&"c"', "--><x/>", "a\x00\x1b\ufffe", "- - --", "\ud800", "123", "äöü", "]]>", "%s{0}"]
)
def test_no_name_is_markup(name, export):
    """A user's name, whatever it is: well-formed XML with nothing in it that was not there, and YAML that is read."""
    odd = replace(export, name=name, label=f"{name}{name}", assumptions=(name,))
    for form in ("mjcf", "urdf", "sdf", "ros2_control"):
        plain, made = ET.fromstring(rendered(export, form)), ET.fromstring(rendered(odd, form))
        assert [e.tag for e in made.iter()] == [e.tag for e in plain.iter()]
    assert yaml.safe_load(rendered(odd, "ros2_control", True)) == yaml.safe_load(rendered(export, "ros2_control", True))
    assert "\\x00" in ET.fromstring(rendered(replace(export, name="a\x00"), "mjcf")).get("model")
    json.loads(rendered(odd, "json"))


@pytest.mark.parametrize("form", FORMATS)
def test_the_same_set_gives_the_same_bytes(form, spec, found, tmp_path):
    path = tmp_path / f"drive{FORMATS[form].suffixes[0]}"
    one, other = (files(one_axis(export_of(spec, found)), form, path) for _ in range(2))
    assert one == other and set(one) >= {path}
    assert write(one_axis(export_of(spec, found)), form, path) == list(one)
    assert all(p.read_bytes() == content for p, content in one.items())


@pytest.mark.parametrize(
    ("form", "name", "said"),
    [("step", "a.step", "expected mjcf, urdf"), ("mjcf", "a.fmu", "ends in .xml or .mjcf"),
     ("json", "none/a.json", "there is no folder"), ("fmu", "a", "ends in .fmu")],
)  # fmt: skip
def test_a_target_that_cannot_work_is_refused_at_once(form, name, said, tmp_path):
    with pytest.raises(InputError, match=said):
        accept(form, tmp_path / name)


LOADS = {
    "hoist": "load: {kind: hoist, mass: 20 kg, drum_diameter: 60 mm}\nmotion: {speed: 0.2 m/s",
    "arm": "load: {kind: arm, mass: 2 kg, length: 200 mm}\nmotion: {speed: 60 deg/s",
}  # fmt: skip


@pytest.mark.parametrize("kind", LOADS)
def test_every_format_takes_loads_that_hang(kind):
    motion = "acceleration_time: 0.4 s, cruise_time: 1 s}\nsupply: {nominal: 24 V}\nselect: {catalogs: [maxon]}\n"
    spec = read_spec(YamlSource(f"name: {kind}\n{LOADS[kind]}, {motion}", "x.yaml"))
    export = export_of(spec, size(spec, top=1).sets[0])
    assert export.weight > 0.5  # N*m
    for form in ("mjcf", "urdf", "sdf", "ros2_control"):
        ET.fromstring(rendered(export, form))
    assert not export.cycle.load_time and (export.lever is not None) == (kind == "arm")
    if kind == "hoist":
        assert export.weight == pytest.approx(20.0 * 9.80665 * 0.03)


def test_a_figure_without_which_nothing_moves_is_named(spec):
    (one, *_) = explain(spec, "118752", "406764")
    with pytest.raises(InputError, match="resistance not in the catalogue"):
        export_of(spec, fitted(one, motor={"resistance": math.nan}))


def test_a_platform_s_joint_has_the_friction_of_its_wheel(example):
    """C_rr m g / 4 r of a wheel that carries a quarter of 45 kg, and the motor's; the rest of the way is over time."""
    spec = load_spec(example.with_name("sps_platform.yaml"))
    export = export_of(spec, size(spec, top=1).sets[0])
    assert export.load_friction == pytest.approx(ROLLING)
    dynamics = ET.fromstring(rendered(export, "urdf")).find("joint/dynamics")
    train = export.train
    assert float(dynamics.get("friction")) == pytest.approx(ROLLING + train.friction * train.ratio * train.efficiency)


TABLE = """name: table
load: {kind: rotary_table, inertia: 0.4 kg*m^2, mass: 6 kg, eccentricity: 150 mm, tilt: 20 deg, start_angle: 50 deg,
       motors: 2, friction_torque: 0.3 N*m}
motion: {speed: 40 deg/s, acceleration_time: 0.5 s, cruise_time: 3 s}
supply: {nominal: 24 V}
select: {catalogs: [maxon]}
"""


def test_a_lever_hangs_in_urdf_and_sdf_as_it_does_in_the_machine():
    """MuJoCo reads the URDF and makes the torque: half of 6 kg at 150 mm, on an axis 20 degrees off the vertical."""
    mujoco = pytest.importorskip("mujoco")
    spec = read_spec(YamlSource(TABLE, "x.yaml"))
    export = export_of(spec, size(spec, top=1).sets[0])
    model = mujoco.MjModel.from_xml_string(rendered(export, "urdf").decode())
    model.opt.gravity[2] = -9.80665  # its own has two digits after the point
    data = mujoco.MjData(model)
    for angle in (0.0, 0.7, 2.0, -1.2):
        data.qpos[0] = angle
        mujoco.mj_forward(model, data)
        weight = 3.0 * 9.80665 * 0.15 * math.sin(math.radians(20.0)) * math.cos(math.radians(50.0) + angle)
        assert data.qfrc_bias[0] == pytest.approx(weight)
    about = np.empty((1, 1))
    mujoco.mj_fullM(model, data, about)
    assert about[0, 0] == pytest.approx(0.2 + export.reflected_inertia)
    link = ET.fromstring(rendered(export, "sdf")).find("model/link[@name='load']/inertial")
    high = 0.15 * math.sin(math.radians(50.0))
    centre = (
        0.15 * math.cos(math.radians(50.0)),
        high * math.cos(math.radians(20.0)),
        high * math.sin(math.radians(20.0)),
    )
    assert [float(x) for x in link.find("pose").text.split()] == pytest.approx([*centre, 0.0, 0.0, 0.0])
    assert float(link.find("mass").text) == 3.0
