"""A URDF to a spec: figures of hand-written files, and everything that can be wrong with one, each in a line."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import yourdfpy
from refusals import refusal

from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases import load_cycle
from drivesizer.multi_axis.several import with_joints
from drivesizer.output.export import export_of, one_axis, write
from drivesizer.sizing import size
from drivesizer.spec.description import read_urdf
from drivesizer.spec.from_description import carried, machine_of, spec_of
from drivesizer.spec.machine import load_machine
from drivesizer.spec.robot import read_spec


def link(name, mass, inertia="0.01 0 0 0.01 0 0.01", shape="", origin=""):
    xx, xy, xz, yy, yz, zz = inertia.split()
    return (
        f'<link name="{name}"><inertial>{origin}<mass value="{mass}"/><inertia ixx="{xx}" ixy="{xy}" ixz="{xz}" '
        f'iyy="{yy}" iyz="{yz}" izz="{zz}"/></inertial>{shape}</link>\n'
    )


def joint(name, child, kind="continuous", limit='effort="4" velocity="12"', axis="0 1 0", more="", parent="body"):
    bound = f"<limit {limit}/>" if limit else ""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{more}'
        f'<axis xyz="{axis}"/>{bound}</joint>\n'
    )


TYRE = ('<collision><origin xyz="0 0 0" rpy="1.5707963267948966 0 0"/><geometry><cylinder radius="0.08" length="0.04"/>'
        "</geometry></collision>")  # fmt: skip
ROBOT = "<robot name='a cart'>\n%s</robot>\n"
CART = (
    link("body", 18.5)
    + link("l", 0.75, "0.002 0 0 0.0031 0 0.002", TYRE)
    + link("r", 0.75, "0.002 0 0 0.0031 0 0.002", TYRE)
    + link("caster", 0.2, shape=TYRE)
    + joint("left", "l", limit='effort="4" velocity="12.5"')
    + joint("right", "r", limit='effort="5" velocity="12.5"')
    + joint("behind", "caster", limit="")
)
ARM = (
    link("body", 9.0)
    + link("upper", 2.0, "0.02 0 0 0.03 0 0.04", origin='<origin xyz="0.2 0 0" rpy="0 0 0"/>')
    + link("hand", 1.0, "0.001 0 0 0.002 0 0.003", origin='<origin xyz="0.1 0 0" rpy="0 0 1.5707963267948966"/>')
    + joint("shoulder", "upper", "revolute", 'effort="30" velocity="2" lower="-1" upper="2"',
            more='<origin xyz="0 0 0.5" rpy="0 0 0.7"/>')
    + joint("wrist", "hand", "fixed", "", more='<origin xyz="0.4 0 0"/>', parent="upper")
)  # fmt: skip


@pytest.fixture
def at(tmp_path):
    def write(text):
        path = tmp_path / "robot.urdf"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


def spec_from(path, joint=None):
    return read_spec(YamlSource(spec_of(path, joint), "robot.yaml"))


def test_a_cart_by_its_wheels(at):
    load = (spec := spec_from(at(ROBOT % CART))).load
    assert (spec.name, load.kind, load.driven_wheels) == ("a cart", "wheeled_vehicle", 2)  # the caster has no limit
    assert load.mass == pytest.approx(18.5 + 2 * 0.75 + 0.2)
    assert load.wheel_diameter == pytest.approx(0.16)
    assert load.inertia == pytest.approx(0.0031)  # about the axle
    assert spec.motion.speed == pytest.approx(12.5 * 0.08)
    assert "effort limit is 4 N*m" in spec_of(at(ROBOT % CART))


def test_what_comes_out_can_be_sized(at):
    assert size(spec_from(at(ROBOT % CART)), top=1).sets
    assert size(spec_from(at(ROBOT % ARM)), top=1).counts.considered


def test_an_arm_by_its_joint(at):
    """Two links, the second turned by a right angle: parallel axes by hand."""
    spec = spec_from(at(ROBOT % ARM))
    mass, lever = 3.0, (2.0 * 0.2 + 1.0 * 0.5) / 3.0
    inertia = 0.03 + 2.0 * 0.2**2 + 0.001 + 1.0 * 0.5**2  # the hand's own x axis lies along the shoulder's y
    assert (spec.load.kind, spec.load.mass) == ("arm", mass)
    assert spec.load.length == pytest.approx(lever, rel=1e-5)
    assert spec.load.inertia == pytest.approx(inertia, rel=1e-5)
    assert spec.load.tilt == 0.0
    assert spec.motion.speed == 2.0
    assert spec.motion.speed * (spec.motion.acceleration_time + spec.motion.cruise_time) == pytest.approx(3.0)


def test_there_and_back(spec, tmp_path):
    """What export writes, read again: the inertia at the shaft and the speed at no load."""
    export = export_of(spec, size(spec, top=1).sets[0])
    (path,) = write(one_axis(export), "urdf", tmp_path / "drive.urdf")
    again = spec_from(path)
    assert again.load.inertia == pytest.approx(export.inertia, rel=1e-5)
    assert again.motion.speed == pytest.approx(export.limits.peak_speed.value, rel=1e-5)


def test_the_tilt_is_that_of_the_axis(at):
    tilted = (
        (ROBOT % ARM)
        .replace('rpy="0 0 0.7"', 'rpy="0.3 0 0"')
        .replace('<axis xyz="0 1 0"/><limit', '<axis xyz="0 2 0"/><limit')
    )
    assert spec_from(at(tilted)).load.tilt == pytest.approx(0.3)
    assert spec_from(at(tilted), "shoulder").load.tilt == pytest.approx(0.3)


@pytest.mark.parametrize("turned", ["0 0 0", "1.5708 0 0", "3.14159 0 0"])
def test_an_upright_joint_can_be_sized(at, turned):
    """A SCARA robot's: what comes out is read again, with no weight about an axis that files round to 1.5708 rad."""
    axis = "0 1 0" if turned.startswith("1.5") else "0 0 1"
    origin, limit = f'<origin xyz="0 0 0.3" rpy="{turned}"/>', 'effort="10" velocity="3"'
    arm = link("body", 5.0) + link("arm", 2.0, origin='<origin xyz="0.2 0 0"/>')
    path = at(ROBOT % (arm + joint("first", "arm", "revolute", limit, axis, origin)))
    spec = read_spec(YamlSource(spec_of(path, None), "x.yaml"))
    assert spec.load.kind == "arm" and spec.load.tilt == pytest.approx(math.pi / 2, abs=1e-5)
    assert len(load_cycle(spec).duration) < 10  # nothing that depends on the angle


@pytest.mark.parametrize("seed", range(5))
def test_places_and_turns_against_yourdfpy(seed, at):
    """Chains with any turn: what a joint carries, by another's forward kinematics."""
    rng = np.random.default_rng(seed)
    parts = [link("body", 1.0)]
    for n in range(4):
        A = rng.normal(size=(3, 3))
        A = A @ A.T + 0.1 * np.eye(3)
        entries = " ".join(f"{A[i, j]:.9f}" for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)))
        origins = [f'<origin xyz="{_triple(rng)}" rpy="{_triple(rng)}"/>' for _ in range(2)]
        parts.append(link(f"l{n}", 1.0 + n, entries, origin=origins[0]))
        limit, above = 'effort="1" velocity="1" lower="-1" upper="1"', f"l{n - 1}" if n else "body"
        parts.append(joint(f"j{n}", f"l{n}", "revolute", limit, _triple(rng), origins[1], above))
    path = at(ROBOT % "".join(parts))
    ours, theirs = read_urdf(path), yourdfpy.URDF.load(str(path), load_meshes=False)
    for name in ("j0", "j2"):
        one = ours.joints[name]
        hangs = [f"l{n}" for n in range(int(name[1]), 4)]
        frame = theirs.get_transform(one.child, "body")
        axis, place = frame[:3, :3] @ one.axis, frame[:3, 3]
        total, moment, inertia = 0.0, np.zeros(3), 0.0
        for each in theirs.robot.links:
            if each.name not in hangs:
                continue
            own = theirs.get_transform(each.name, "body") @ each.inertial.origin
            arm, turn = own[:3, 3] - place, own[:3, :3]
            total, moment = total + each.inertial.mass, moment + each.inertial.mass * arm
            inertia += axis @ turn @ each.inertial.inertia @ turn.T @ axis
            inertia += each.inertial.mass * (arm @ arm - (arm @ axis) ** 2)
        found = carried(ours, one)
        assert found.mass == pytest.approx(total) and found.inertia == pytest.approx(inertia)
        off = moment / total - (moment / total @ axis) * axis
        assert found.lever == pytest.approx(np.linalg.norm(off)) and math.sin(found.tilt) == pytest.approx(abs(axis[2]))


def _triple(rng):
    return " ".join(f"{x:.9f}" for x in rng.normal(size=3))


def test_a_sphere_is_a_wheel_and_a_disc_across_is_none(at):
    ball = TYRE.replace('<cylinder radius="0.08" length="0.04"/>', '<sphere radius="0.05"/>')
    assert spec_from(at((ROBOT % CART).replace(TYRE, ball))).load.wheel_diameter == pytest.approx(0.1)
    across = (ROBOT % CART).replace('rpy="1.5707963267948966 0 0"', 'rpy="0 0 0"')
    with pytest.raises(InputError, match="name one with --joint: left, right"):
        spec_of(at(across))


# --- what is wrong, in one line

BROKEN = {
    "empty": ("", ":1: this is no XML"),
    "cut": (ROBOT[:20], "this is no XML"),
    "bytes": (b"\xff\xfe\x00<", "this is no XML"),
    "encoding": ("<?xml version='1.0' encoding='nonsense'?><robot/>", "this is no XML"),
    "another": ("<sdf/>", "<sdf> is no URDF"),
    "entities": ('<!DOCTYPE r [<!ENTITY a "b">]><robot>&a;</robot>', "a document type is not taken"),
    "outside": ('<!DOCTYPE r SYSTEM "file:///etc/hostname"><robot/>', "a document type is not taken"),
    "deep": ("<robot>" + "<a>" * 100 + "</a>" * 100 + "</robot>", "60 deep"),
    "many": ("<robot>" + "<a/>" * 20_001 + "</robot>", "at most 20000 elements"),
    "nothing": ("<robot/>", "no joint turns"),
    "negative": (ROBOT % CART.replace('value="18.5"', 'value="-18.5"'), ':2: link "body": a mass of -18.5 kg is none'),
    "no mass": (ROBOT % CART.replace('<mass value="18.5"/>', ""), "has no <mass>"),
    "no value": (ROBOT % CART.replace('<mass value="18.5"/>', "<mass/>"), "<mass> has no value"),
    "words": (ROBOT % CART.replace("18.5", "heavy"), '"heavy" is no number'),
    "infinite": (ROBOT % CART.replace("18.5", "inf"), '"inf" is no number'),
    "no inertia": (ROBOT % CART.replace("<inertia ", "<inertias "), "has no <inertia>"),
    "negative inertia": (ROBOT % CART.replace('iyy="0.0031"', 'iyy="-0.0031"'), "an inertia below 0"),
    "flat": (ROBOT % CART.replace('iyy="0.0031"', 'iyy="0"'), "the inertia of a wheel is 0"),
    "no velocity": (ROBOT % CART.replace(' velocity="12.5"', ""), 'joint "left" has no limit of velocity'),
    "no effort": (ROBOT % CART.replace('effort="4" ', ""), 'joint "left" has no limit of effort'),
    "no limits": (ROBOT % ARM.replace('<limit effort="30"', '<stop effort="30"'), "has no limit of effort"),
    "effort of 0": (ROBOT % CART.replace('effort="4"', 'effort="0"'), "has 0 as limit of effort"),
    "radius": (ROBOT % CART.replace('radius="0.08"', 'radius="0"'), "a radius of 0 m is none"),
    "two sizes": (ROBOT % CART.replace('radius="0.08"', 'radius="0.09"', 1), "wheels of one size"),
    "vector": (ROBOT % CART.replace('axis xyz="0 1 0"', 'axis xyz="0 1"'), "expected 3 numbers"),
    "axis": (ROBOT % CART.replace('axis xyz="0 1 0"', 'axis xyz="0 0 0"'), "no direction"),
    "nameless": (ROBOT % CART.replace('link name="body"', "link"), "<link> has no name"),
    "twice": (ROBOT % CART.replace('link name="l"', 'link name="r"'), "is there twice"),
    "no such link": (ROBOT % CART.replace('child link="l"', 'child link="x"'), 'there is no link "x"'),
    "two parents": (ROBOT % CART.replace('child link="r"', 'child link="l"'), "hangs on two joints"),
    "ring": (ROBOT % CART.replace('parent link="body"/><child link="l"', 'parent link="l"/><child link="l"'), "ring"),
    "weightless": (ROBOT % ARM.replace('"2.0"/>', '"0"/>').replace('"1.0"/>', '"0"/>'), "carries no mass"),
    "slides": (ROBOT % ARM.replace("revolute", "prismatic"), "no joint turns"),
}  # fmt: skip


@pytest.mark.parametrize("name", BROKEN)
def test_what_is_wrong_is_one_line(name, at):
    text, said = BROKEN[name]
    line = refusal(lambda: spec_of(at(text)))
    assert said in line
    assert "robot.urdf" in line


def test_what_is_no_file(tmp_path):
    for path in (tmp_path / "none.urdf", tmp_path):
        with pytest.raises(InputError, match="cannot be read"):
            spec_of(path)
    large = tmp_path / "large.urdf"
    large.write_bytes(b" " * 16_000_001)
    with pytest.raises(InputError, match="larger than 16 MB"):
        spec_of(large)


@pytest.mark.parametrize(
    ("joint", "said"),
    [("elbow", "is not in .*; expected .*shoulder"), ("sholder", "the nearest is shoulder"), ("wrist", '"fixed"')],
)
def test_a_joint_that_cannot_be(joint, said, at):
    with pytest.raises(InputError, match=f"--joint: .*{said}"):
        spec_of(at(ROBOT % ARM), joint)


@pytest.mark.parametrize(
    "name", ['x"y', "a: b # c", "{}", "tab\there", "\u2028", "\u202eb", "back\\slash", "%s", "- a", "'"]
)
def test_a_name_is_text_in_the_spec(name, at):
    """Quotes, braces, comments: the spec is read, and has the name on one line."""
    from xml.sax.saxutils import quoteattr

    named = (ROBOT % CART).replace("'a cart'", quoteattr(name)).replace('name="left"', f"name={quoteattr(name)}")
    spec = spec_from(at(named))
    assert spec.load.mass == pytest.approx(20.2) and spec.name and spec.name.isprintable()


# --- at the command line


def test_init_from_a_urdf(at, tmp_path, run):
    path, target = at(ROBOT % CART), tmp_path / "robot.yaml"
    status, out, _ = run("init", "--from-urdf", path, "-o", target)
    assert (status, target.read_text()) == (0, spec_of(path)) and "now: drivesizer size" in out
    status, _, err = run("init", "--from-urdf", path, "-o", target)
    assert status == 2 and "exists" in err
    status, out, _ = run("init", "--from-urdf", at(ROBOT % ARM), "--joint", "shoulder", "-o", "-")
    assert status == 0 and "kind: arm" in out
    status, _, err = run("init", "--joint", "shoulder")
    assert (status, err.count("\n")) == (2, 1)
    broken = tmp_path / "new.yaml"
    status, _, err = run("init", "--from-urdf", at("<robot>"), "-o", broken)
    assert (status, err.count("\n"), broken.exists()) == (2, 1, False)


# --- several joints: a machine ----------------------------------------------------------------------------------------

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "six_joint_arm.urdf"


def test_every_joint_of_a_description_is_an_axis(tmp_path):
    text = machine_of(EXAMPLE, tmp_path)
    (tmp_path / "robot.yaml").write_text(text, encoding="utf-8")
    found, _ = with_joints(load_machine(tmp_path / "robot.yaml"))
    assert [axis.name for axis in found.axes] == ["waist", "shoulder", "elbow", "roll", "pitch", "turn"]
    positions = load_machine(tmp_path / "robot.yaml").robot.waypoints[0].positions
    assert positions["shoulder"].value == pytest.approx(-0.7 - 0.75, rel=1e-3)  # a quarter of 3 rad from the middle


@pytest.mark.parametrize(("name", "made"), [("arm.urdf.xacro", "arm.urdf"), ("arm.urdf", "plain_arm.urdf")])
def test_xacro_is_refused_with_the_command_that_makes_urdf_of_it(tmp_path, name, made):
    path = tmp_path / name
    path.write_text('<robot name="a" xmlns:xacro="http://ros.org/wiki/xacro"><xacro:include filename="b"/></robot>')
    with pytest.raises(InputError, match=rf"is xacro.*expected URDF: ros2 run xacro xacro {name} > {made}$"):
        spec_of(path)
