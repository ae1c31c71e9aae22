"""``drivesizer export`` at the command line."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest

from drivesizer.output.export import FORMATS


@pytest.mark.parametrize("form", FORMATS)
def test_every_format_has_its_files(form, example, tmp_path, run):
    target = tmp_path / f"drive{FORMATS[form].suffixes[0]}"
    status, out, err = run("export", example, "--format", form, "-o", target)
    assert (status, out.split()[0]) == (0, str(target)) and "note: the inertia of the encoder" in err
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


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--format", "urdf", "--set", "1/2"], "--set: it is of a single axis; expected --axis beside it"),
        (
            ["--format", "fmu"],
            "fmu is of a single axis; expected --axis beside it, or mjcf, urdf, ros2_control",
        ),
    ],
)
def test_of_a_machine_all_axes_or_one_line(words, said, tmp_path, run):
    machine = Path(__file__).resolve().parents[2] / "examples" / "six_joint_arm.yaml"
    status, out, err = run("export", machine, *words, "-o", tmp_path / f"arm.{'fmu' if 'fmu' in words else 'urdf'}")
    assert (status, out, err.count("\n")) == (2, "", 1) and said in err and not list(tmp_path.iterdir())
