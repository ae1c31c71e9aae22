"""A user's own catalogue on the live page: checked, kept in memory alone, known to every process of the engine."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from motor_logs import motor_log
from own_catalogue import CONTRADICTORY, RIGHT

from drivesizer.catalog import load
from drivesizer.errors import InputError
from drivesizer.files.text import hand_over
from drivesizer.live.engine import EngineMemory, done, take_over
from drivesizer.live.server import file_answer

NAME = "dropped/mine.yaml"


@pytest.fixture
def held(tmp_path: Path) -> Iterator[EngineMemory]:
    yield EngineMemory(str(tmp_path / "robot.yaml"))
    hand_over({})


class Checking:
    """A process of the engine that is here."""

    def __init__(self, held: EngineMemory) -> None:
        self.held = held
        self.own: dict[str, bytes] = {}

    def answer(self, job: str, request: dict[str, Any], **_: Any) -> Iterator[bytes]:
        for piece in done(self.held, job, request):
            yield json.dumps(piece).encode()


@pytest.fixture
def drop(held):
    """Drop a text on the page; what is kept is in ``own``."""

    def of(text: str | bytes | None, name: str = "mine.yaml", /, **more: Any) -> dict[str, Any]:
        raw = text.encode() if isinstance(text, str) else text
        body = {"name": name, "content": None if raw is None else base64.b64encode(raw).decode(), **more}
        return file_answer({"anyway": False, "text": "", **body}, engine)

    engine = Checking(held)
    of.own = engine.own
    return of


def test_what_is_right_is_kept_by_its_name(drop):
    found = drop(RIGHT)
    assert (found["kind"], found["name"], found["parts"]) == ("kept", NAME, {"motors": 2})
    assert drop.own == {NAME: RIGHT.encode()}
    assert drop(None)["kind"] == "given up" and drop.own == {}


def test_findings_are_those_of_the_command_and_keep_it_out_until_the_user_wants_it(drop, run, tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(CONTRADICTORY, encoding="utf-8")
    found, (status, out, _) = drop(CONTRADICTORY), run("catalog", "check", "--catalog", path, "--json")
    printed = json.loads(out)["findings"]
    assert status == 1 and found["kind"] == "contradictory" and drop.own == {}
    assert len(found["lines"]) == len(printed) > 0
    assert all(one["identity"] in line for one, line in zip(printed, found["lines"], strict=True))
    assert drop(CONTRADICTORY, anyway=True)["kind"] == "kept" and NAME in drop.own


def test_what_is_wrong_is_said_with_its_line_and_the_one_before_stays(drop):
    drop(RIGHT)
    found = drop(RIGHT.replace("rotor_inertia", "rotor_weight"))
    assert found["kind"] == "wrong" and found["lines"][0].startswith("dropped/mine.yaml:10: ")
    assert "rotor_inertia" in found["lines"][0]
    assert drop.own == {NAME: RIGHT.encode()}
    assert "not UTF-8" in drop(b"catalog: 1\n\xff")["lines"][0]


ROWS = """\
part;voltage (V);no load speed (rpm);stall torque (mNm);mass (g)
K-7;12;9000;310;52
K-9;24;8200;350;57
"""


@pytest.mark.parametrize(("rows", "name"), [(ROWS, "k.csv"), (ROWS.replace(";", "\t"), "pasted.csv")])
def test_a_table_or_a_pasted_row_becomes_a_part_that_a_spec_finds(drop, held, tmp_path, rows, name):
    """The figures are those of the row; the engine's own catalogue is the text that the page can save."""
    found = drop(rows, name, text="name: x\nselect: {catalogs: [pololu]}\n")
    assert (found["kind"], found["name"]) == ("kept", f"dropped/{Path(name).stem}.yaml"), found
    assert drop.own == {found["name"]: found["text"].encode()}
    assert any("nominal_voltage, first 12" in line for line in found["read"])
    take_over(held, drop.own)
    (motor, *_) = load([found["name"], "pololu"], beside=tmp_path).motors.rows
    assert motor == "K-7" and load([found["name"]], beside=tmp_path).motors["mass"][0] == pytest.approx(0.052)
    assert drop("weather; rain\nyesterday; much\n", name)["kind"] == "wrong"


def test_a_log_gives_the_figures_of_identify_and_is_not_kept(drop, run, tmp_path):
    found = drop(motor_log(), "log.tsv")
    (tmp_path / "log.tsv").write_text(motor_log())
    figures = json.loads(run("identify", tmp_path / "log.tsv", "--json")[1])["figures"]
    assert (found["kind"], found["name"], drop.own) == ("fit", "log.tsv", {})
    for one in figures:
        assert one["title"] in found["html"]
    assert f'value="{figures[0]["value"]!r}"' in found["html"]
    said = drop("time;weather\n0;rain\n1;much\n", "log.csv")
    assert said["kind"] == "wrong" and said["lines"][-1].startswith("as a log: dropped/log.csv")


def test_names_and_amounts_are_bounded(drop, monkeypatch):
    for name in ("", "mine.exe", "..", ".yaml", "a" * 200):
        assert drop(RIGHT, name)["kind"] == "wrong"
    assert drop(RIGHT, "../../my parts (1).yaml")["kind"] == "wrong"
    assert drop(RIGHT, "my parts (1).yml")["name"] == "dropped/my_parts_1_.yml"
    assert file_answer({"name": "a.yaml", "content": "%"}, Checking(EngineMemory("")))["kind"] == "wrong"
    for n in range(3):
        assert drop(RIGHT, f"{n}.yaml")["kind"] == "kept"
    assert "4 catalogues are here already" in drop(RIGHT, "one_more.yaml")["lines"][0]
    assert drop(RIGHT, "2.yaml")["kind"] == "kept"
    monkeypatch.setattr("drivesizer.live.server._LARGEST", 10)
    assert "larger than" in drop(RIGHT, "2.yaml")["lines"][0]


def test_a_spec_finds_it_by_its_name_and_the_disk_keeps_nothing_of_it(held, tmp_path, monkeypatch):
    monkeypatch.setenv("DRIVESIZER_CACHE", str(tmp_path / "cache"))
    take_over(held, {NAME: RIGHT.encode()})
    alone = load([NAME], beside=tmp_path)
    assert alone.motors["part"].tolist() == ["OWN-1", "OWN-2"] and load([NAME], beside=tmp_path) is alone
    both = load(["pololu", NAME], beside=tmp_path)
    assert {"pololu", "mine"} == set(both.digests) and load(["pololu", NAME], beside=tmp_path) is both
    kept = [path.name for path in (tmp_path / "cache").iterdir()]
    assert [name.split("-")[0] for name in kept] == ["pololu"]
    take_over(held, {NAME: RIGHT.replace("OWN-1", "OWN-9").encode()})
    assert load([NAME], beside=tmp_path).motors["part"].tolist() == ["OWN-9", "OWN-2"]
    take_over(held, {})
    with pytest.raises(InputError, match=r"dropped/mine\.yaml"):
        load([NAME], beside=tmp_path)
