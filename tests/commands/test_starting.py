"""`drivesizer init` and `size` without a spec: questions at a terminal, examples, and never a question elsewhere."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from drivesizer.cli import app
from drivesizer.commands import common, setup
from drivesizer.commands import setup as starting
from drivesizer.commands.setup import KINDS
from drivesizer.spec.machine import load_any
from drivesizer.spec.robot import load_spec


@pytest.fixture
def told(tmp_path, monkeypatch):
    """Run the program in an empty folder at a terminal, with answers, a line each."""
    monkeypatch.chdir(tmp_path)
    for module in (setup, common):  # which `size` has it of
        monkeypatch.setattr(module, "at_a_terminal", lambda: True)

    def run(*arguments, answers=""):
        return CliRunner().invoke(app, list(arguments), input=answers)

    return run


def test_enter_at_every_question_gives_the_starter(told):
    found = told("init", answers="\n" * 30)
    assert found.exit_code == 0 and "What moves" in found.output
    asked = load_spec("robot.yaml").model_dump()
    Path("robot.yaml").unlink()
    assert told("init", "--kind", "wheeled_vehicle").exit_code == 0
    assert asked == load_spec("robot.yaml").model_dump()


def test_the_list_of_loads_has_whole_sentences_in_eighty_columns(told):
    listed = told("init", answers="\n" * 30).output.partition("What moves")[0]
    assert max(map(len, listed.splitlines())) <= 80
    assert "point to point, sideways and in turns as well" in " ".join(listed.split())
    assert " ".join(listed.split()).count("each drive is") == 0  # of the sentence behind it


def test_answers_are_read_as_strictly_as_a_file_and_asked_again(told):
    answers = "hoist\nmetric\n40\n40 kg\n" + "\n" * 20
    found = told("init", answers=answers)
    assert found.exit_code == 0 and 'load.mass: "40" has no unit; expected mass' in found.output
    spec = load_spec("robot.yaml")
    assert (spec.load.kind, spec.load.mass) == ("hoist", 40.0)
    assert "# what is lifted, its carrier included" in Path("robot.yaml").read_text(encoding="utf-8")


def test_american_units_are_offered_and_mean_the_same(told):
    """30 kg are 66.1 lb, to three digits."""
    number = KINDS.index("wheeled_vehicle") + 1
    assert told("init", answers=f"{number}\nUS\n" + "\n" * 20).exit_code == 0
    text = Path("robot.yaml").read_text(encoding="utf-8")
    assert "mass: 66.1 lb" in text and "wheel_diameter: 7.87 in" in text
    assert load_spec("robot.yaml").load.mass == pytest.approx(30.0, rel=1e-3)


def test_an_existing_file_is_told_before_anything_is_asked(told):
    Path("robot.yaml").write_text("name: mine\n", encoding="utf-8")
    found = told("init", answers="\n" * 30)
    assert found.exit_code and "What moves" not in found.output
    assert Path("robot.yaml").read_text(encoding="utf-8") == "name: mine\n"


def test_size_without_a_spec_asks_and_goes_on(told, monkeypatch):
    seen = []
    monkeypatch.setattr(common, "load", lambda path, *_: seen.append(path.read_text(encoding="utf-8")) or 1 / 0)
    with pytest.raises(ZeroDivisionError):
        CliRunner().invoke(app, ["size"], input="fan\n" + "\n" * 20, catch_exceptions=False)
    assert "kind: fan" in seen[0]


@pytest.mark.parametrize("command", ["init", "size"])
def test_nothing_is_asked_where_nobody_can_answer(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = CliRunner().invoke(app, [command], input="hoist\n")
    assert "What moves" not in found.output


def test_every_kind_has_a_line_in_the_list(told):
    out = told("init", answers="none\nfan\n" + "\n" * 20).output
    assert all(re.search(rf"^ +\d+  {kind} +\S", out, re.MULTILINE) for kind in starting.KINDS)
    assert '"none" is not in the list' in out


@pytest.mark.parametrize("name", sorted(starting.examples()))
def test_an_example_comes_with_the_files_that_it_names(name, told):
    assert told("init", "--example", name).exit_code == 0
    machine = load_any("robot.yaml")
    motion = machine.axes[0].spec.motion if machine.axes else None
    trajectory = machine.robot.description if machine.robot else getattr(motion, "trajectory", None)
    assert trajectory is None or Path(trajectory).name in {path.name for path in Path().glob("*.*")}
    again = told("init", "--example", name, "-o", "other.yaml") if trajectory else told("init", "--example", name)
    assert "exists" in str(again.exception) and not Path("other.yaml").exists()


def test_an_unknown_example_and_two_sources_are_refused(told):
    assert "sps_robot" in str(told("init", "--example", "sps_robo").exception)
    assert "expected one of them" in str(told("init", "--example", "sps_robot", "--kind", "fan").exception)


@pytest.mark.parametrize(("name", "said"), [("hoist.yaml", "hoist.yaml"), ("two\nlines.yaml", "robot.yaml")])
def test_the_comment_on_the_next_command_names_the_file_that_was_written(name, said, told):
    assert told("init", "--kind", "hoist", "-o", name).exit_code == 0
    lines = Path(name).read_text(encoding="utf-8").splitlines()
    assert lines[2] == f"# Then: drivesizer size {said}"
    assert load_spec(name).load.kind == "hoist"
