"""Commands over machines of several axes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from refusals import refusal
from typer.testing import CliRunner

from drivesizer import cli
from drivesizer.commands.setup import starter
from drivesizer.multi_axis import size_machine
from drivesizer.output.terminal.sizing import machine_sizing
from drivesizer.spec.machine import load_machine

pytestmark = pytest.mark.usefixtures("no_further_searches")

runner = CliRunner()


@pytest.fixture(scope="module")
def leg(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("leg") / "leg.yaml"
    path.write_text(starter("leg"), encoding="utf-8")
    return path


def called(*words: object, columns: int = 80) -> tuple[int, str]:
    found = runner.invoke(cli.app, [str(word) for word in words], env={"COLUMNS": str(columns)})
    if found.exception and not isinstance(found.exception, SystemExit):
        raise found.exception
    return found.exit_code, found.output


def test_kind_machine_is_the_gantry() -> None:
    assert starter("machine") == starter("gantry")


def test_size_prints_every_axis_and_one_parts_list_within_80_columns(leg: Path) -> None:
    status, text = called("size", leg)
    assert status == 0
    assert all(word in text for word in ("hip", "knee", "total", "2 ×", "hip, knee", f"validate {leg}"))
    table = text.split("next:")[0]
    assert max(map(len, table.splitlines())) <= 80


def test_json_has_the_document_of_every_axis(leg: Path) -> None:
    status, text = called("size", leg, "--json", "--top", 1)
    document = json.loads(text)
    assert status == 0 and [axis["name"] for axis in document["axes"]] == ["hip", "knee"]
    (one,) = json.loads(called("size", leg, "--axis", "knee", "--json", "--top", 1)[1])["axes"]
    assert document["status"] == "pass" and document["axes"][1]["result"]["sets"] == one["result"]["sets"]


def test_the_closed_loop_of_one_axis_is_that_of_all(leg: Path) -> None:
    hip, knee = json.loads(called("validate", leg, "--json")[1])["axes"]
    assert (hip["name"], knee["name"]) == ("hip", "knee")
    assert json.loads(called("validate", leg, "--axis", "hip", "--json")[1])["axes"] == [hip]


def test_a_drive_is_explained_on_every_axis_as_on_each_alone(leg: Path) -> None:
    pair = ("--motor", "118752", "--gearhead", "406764")
    status, text = called("explain", leg, *pair)
    together = {axis["name"]: axis for axis in json.loads(called("explain", leg, *pair, "--json")[1])["axes"]}
    assert list(together) == ["hip", "knee"] and max(map(len, text.splitlines())) <= 80
    for axis, found in together.items():
        alone_status, alone = called("explain", leg, "--axis", axis, *pair, "--json")
        assert [found] == json.loads(alone)["axes"]
        assert (found["sets"][0]["status"] == "fail") == bool(alone_status)
        (row,) = (line for line in text.splitlines() if line.startswith(axis))
        assert ("FAIL" in row) == bool(alone_status)
    statuses = {found["sets"][0]["status"] for found in together.values()}
    assert len(statuses) == 2 and status == 0  # it stands on one of them


def test_no_drive_is_said_with_the_axis(leg: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = leg.read_text(encoding="utf-8").replace("mass: 6 kg", "mass: 6000 kg").replace("0.06 kg", "60 kg")
    path = leg.parent / "heavy.yaml"
    path.write_text(text, encoding="utf-8")
    found = size_machine(load_machine(path), top=1)
    machine_sizing(found, spec="heavy.yaml")
    said = capsys.readouterr().out
    assert "no drive for every axis" in said and "no drive meets all limits" in said and "--axis knee" in said
    assert "knee: no drive meets all limits" in said.replace("\n", " ")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("explain", "LEG", "--motor", "1"), 'hip: motor "1" is in no catalogue'),
        (("export", "LEG", "--format", "urdf", "-o", "x.urdf", "--set", "1/2"), '--set: "1/2" names no axis'),
        (("export", "LEG", "--format", "urdf", "-o", "x.urdf", "--wheel", "1"), "--wheel: it is of a single axis"),
        (("size", "LEG", "--axis", "ankle"), 'there is no axis "ankle"; expected hip'),
        (("size", "LEG", "--pareto", "mass"), "--pareto: "),
        (("validate", "LEG", "--case", "late"), '--case: "late" is not known'),
        (("validate", "LEG", "--set", "ankle=1/2"), 'there is no axis "ankle"; expected hip'),
        (("size", "examples/sps_robot.yaml", "--axis", "x"), "has no axes"),
    ],
)
def test_what_is_of_one_axis_is_refused_in_one_line(words: tuple[str, ...], said: str, leg: Path) -> None:
    assert said in refusal(lambda: called(*(leg if word == "LEG" else word for word in words)))


def test_options_of_one_axis_hold_for_several(leg: Path, tmp_path: Path) -> None:
    """Front, other method and derivation, named drives, all drives in closed loop, series and figures of each."""
    status, text = called("size", leg, "--pareto", "mass,price", "--checks", "--derivation")
    assert status == 0 and all(text.count(word) >= 2 for word in ("Pareto front", "hip", "knee"))
    knee = json.loads(called("size", leg, "--json", "--pareto", "mass,price")[1])["axes"][1]["result"]
    assert {"mass", "price"} <= {*knee["pareto"]} and knee["front"]
    every = json.loads(called("validate", leg, "--all", "--top", 2, "--json")[1])["axes"]
    assert [(axis["name"], len(axis["validations"])) for axis in every] == [("hip", 2), ("knee", 2)]
    other = every[1]["validations"][1]["drive_set"]
    named = f"knee={other['motor']['part']}/{other['gearhead']['part']}"
    words = "--set", named, "--json", "--csv", tmp_path / "loop.csv", "--figures", tmp_path / "figures"
    text = called("validate", leg, *words)[1]
    assert (
        json.loads(text[text.index("{") :])["axes"][1]["validations"][0]["drive_set"]["motor"]["part"]
        == other["motor"]["part"]
    )
    assert sorted(path.name for path in tmp_path.glob("*.csv")) == ["loop_hip.csv", "loop_knee.csv"]
    assert all(list((tmp_path / f"figures_{axis}").iterdir()) for axis in ("hip", "knee"))
