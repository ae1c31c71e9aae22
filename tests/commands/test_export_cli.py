"""``drivesizer export`` at the command line."""

from __future__ import annotations

import json
from pathlib import Path
from random import Random

import jsonschema
import pytest
from small_arms import catalogue

from drivesizer.output.export import FORMATS


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMATS)
def test_every_format_has_its_files(form, example, tmp_path, run):
    target = tmp_path / f"drive{FORMATS[form].suffixes[0]}"
    status, out, err = run("export", example, "--format", form, "-o", target)
    assert (status, out.split()[0]) == (0, str(target)) and "the inertia of the encoder" not in err  # 0.7 g*cm^2
    beside = [tmp_path / "drive_controllers.yaml"] if form == "ros2_control" else []
    assert sorted(tmp_path.iterdir()) == sorted([target, *beside]) and out.split() == [
        str(p) for p in (target, *beside)
    ]
    assert form in " ".join(run("export", "--help")[1].split())


def test_a_set_that_is_named(example, tmp_path, run):
    target = tmp_path / "drive.urdf"
    words = ("export", example, "--format", "urdf", "-o", target, "--set", "118752/406762")
    assert run(*words)[0] == 0
    assert "406762" in target.read_text()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--format", "step", "-o", "a.urdf"], "expected mjcf"),
        (["--format", "urdf", "-o", "no/a.urdf"], "there is no folder"),
        (["--format", "urdf", "-o", "a.stl"], "ends in .urdf or .xml"),
        (["--format", "urdf", "-o", "a.xml", "--set", "1/2/3"], "--set"),
        (["--format", "urdf"], "output"),
    ],
)
def test_what_cannot_be_is_one_line(words, said, example, tmp_path, run, monkeypatch):
    monkeypatch.chdir(tmp_path)
    status, out, err = run("export", example, *words)
    assert (status, out, err.count("\n")) == (2, "", 1) and said in err
    assert not list(tmp_path.iterdir())


def test_of_two_files_both_or_none(example, tmp_path, run):
    """The second target is a folder: the first is left as it was."""
    target = tmp_path / "drive.urdf"
    target.write_text("before")
    (tmp_path / "drive_controllers.yaml").mkdir()
    status, _, err = run("export", example, "--format", "ros2_control", "-o", target)
    assert status == 2 and "it is a folder" in err and target.read_text() == "before"


def test_no_set_is_exit_1(example_text, tmp_path, run):
    heavy = tmp_path / "heavy.yaml"
    heavy.write_text(example_text.replace("mass: 45 kg", "mass: 45000 kg"))
    status, _, err = run("export", heavy, "--format", "json", "-o", tmp_path / "a.json")
    assert status == 1 and "no drive meets all limits" in err and not (tmp_path / "a.json").exists()


def test_the_schema_is_printed(example, tmp_path, run):
    status, out, _ = run("schema", "export")
    run("export", example, "--format", "json", "-o", tmp_path / "a.json")
    jsonschema.Draft202012Validator(json.loads(out)).validate(json.loads((tmp_path / "a.json").read_text()))
    assert status == 0


CART = """
name: cart
load: {kind: wheeled_vehicle, mass: 30 kg, driven_wheels: 2, wheel_diameter: 160 mm, rolling_resistance: 0.02,
  inertia: 30 kg*cm^2}
platform: {layout: {kind: differential, track: 400 mm}, inertia: 1.5 kg*m^2}
motion: {speed: 0.8 m/s, acceleration_time: 1 s, cruise_time: 2 s}
supply: {nominal: 24 V, accepts: all}
select: {catalogs: [parts.yaml], estimates: off}
"""


def test_a_platform_is_whole_in_formats_of_several_joints_and_one_wheel_in_others(tmp_path, run):
    cart, parts = tmp_path / "cart.yaml", ("--set", "m1/g0")
    cart.write_text(CART)
    (tmp_path / "parts.yaml").write_text(catalogue(Random(3)))
    joints = {"base.urdf": ("urdf", []), "one.urdf": ("urdf", ["--wheel", "2"]), "one.sdf": ("sdf", [])}
    for name, (form, words) in joints.items():
        assert run("export", cart, "--format", form, "-o", tmp_path / name, *parts, *words)[0] == 0
        text = (tmp_path / name).read_text()
        found = [part for part in ('"wheel_1"', '"wheel_2"', '"shaft"') if f"joint name={part} type" in text]
        assert found == (['"wheel_1"', '"wheel_2"'] if name == "base.urdf" else ['"shaft"'])


@pytest.mark.parametrize(
    ("text", "wheel", "said"),
    [
        (CART, "3", "--wheel: 3 is no driven wheel; expected one of 1, 2"),
        (CART.replace("platform: {layout: {kind: differential, track: 400 mm}, inertia: 1.5 kg*m^2}\n", ""), "1",
         "--wheel: the spec has no section platform; leave it out"),
    ],
)  # fmt: skip
def test_a_wheel_that_is_not_there_is_one_line(text, wheel, said, tmp_path, run):
    (tmp_path / "cart.yaml").write_text(text)
    target = tmp_path / "a.sdf"
    status, out, err = run("export", tmp_path / "cart.yaml", "--format", "sdf", "-o", target, "--wheel", wheel)
    assert (status, out, err) == (2, "", f"drivesizer: {said}\n") and not target.exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--format", "urdf", "--wheel", "1"], "--wheel: it is of a single axis; expected --axis beside it"),
        (["--format", "urdf", "--set", "1/2"], '--set: "1/2" names no axis; expected AXIS=MOTOR/GEARHEAD'),
    ],
)
def test_of_a_machine_all_axes_or_one_line(words, said, tmp_path, run):
    machine = Path(__file__).resolve().parents[2] / "examples" / "six_joint_arm.yaml"
    status, out, err = run("export", machine, *words, "-o", tmp_path / "arm.urdf")
    assert (status, out, err.count("\n")) == (2, "", 1) and said in err and not list(tmp_path.iterdir())
