"""The catalogues on the live page: its lists, data sheets and comparisons are those of the commands."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from lxml import html
from own_catalogue import RIGHT

from drivesizer.files.text import hand_over
from drivesizer.files.yaml_source import Edit, YamlSource, edited
from drivesizer.live.engine import EngineMemory, done, take_over
from drivesizer.live.requests import REQUESTS, request_of

NAME = "dropped/mine.yaml"
SPEC = """\
name: hoist
load: {kind: hoist, mass: 1 kg, drum_diameter: 40 mm}
motion: {profile: trapezoid, speed: 0.2 m/s, acceleration_time: 0.2 s, cruise_time: 1 s, there_and_back: true}
transmission: [{kind: direct}]
supply: {nominal: 24 V}
select: {catalogs: [dropped/mine.yaml]}
"""


@pytest.fixture(scope="module")
def held(tmp_path_factory: pytest.TempPathFactory) -> Iterator[EngineMemory]:
    made = EngineMemory(str(tmp_path_factory.mktemp("live") / "robot.yaml"))
    take_over(made, {NAME: RIGHT.encode()})
    yield made
    hand_over({})


@pytest.fixture(scope="module")
def do(held: EngineMemory) -> Callable[..., Any]:
    """The one piece of a job, its request as the page sends it."""

    def of(job: str, text: str = "name: x", **body: Any) -> Any:
        request = request_of(REQUESTS[job], json.dumps({"text": text, **body}).encode())
        (piece,) = done(held, job, request)
        json.dumps(piece, allow_nan=False)
        return piece

    return of


def parts_of(piece: Any) -> list[str]:
    return [row["part"] for row in piece["rows"]]


# -- lists


def test_catalogues_are_the_shipped_ones_the_specs_and_the_users(do, held):
    text = "select: {catalogs: [pololu, there_is_none]}\naxes: {lift: {select: {catalogs: my/own.yaml}}}\n"
    found = {one["name"]: one for one in do("catalogues", text)["catalogues"]}
    assert [name for name, one in found.items() if one["chosen"]] == ["there_is_none", "my/own.yaml", "pololu"]
    assert "wrong" in found["my/own.yaml"] and "wrong" in found["there_is_none"] and "wrong" not in found["pololu"]
    assert found[NAME] == {"name": NAME, "chosen": False, "own": True, "makers": "Anymaker", "parts": {"motors": 2}}
    assert found["maxon"]["parts"]["motors"] == 647
    for odd in ("", "a: [", "- 5", "select: 5", "select: {catalogs: {}}", "axes: [1]"):
        chosen = [one["name"] for one in do("catalogues", odd)["catalogues"] if one["chosen"]]
        assert chosen == ["maxon"]
    every = [one for one in do("catalogues", "select: {catalogs: all}")["catalogues"] if one["chosen"]]
    assert len(every) > 100


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ({}, []),
        ({"options": {"voltage": "12 V"}, "sort": "-mass"}, ["--voltage", "12 V", "--sort", "-mass"]),
        ({"options": {"power": " ", "kind": "brushed"}, "where": ["no load speed > 5000 rpm", "stall_torque<=3 N*m"]},
         ["--kind", "brushed", "--where", "no load speed > 5000 rpm", "--where", "stall_torque<=3 N*m"]),
        ({"section": "gearheads", "catalogues": ["maxon"], "options": {"family": "GP 22*"}, "sort": "-ratio",
          "excluded": True}, ["--family", "GP 22*", "--sort", "-ratio", "--excluded"]),
    ],
)  # fmt: skip
def test_lists_are_those_of_the_command(do, run, body, words):
    body = {"section": "motors", "catalogues": ["pololu", "andymark"], **body}
    named = [word for name in body["catalogues"] for word in ("--catalog", name)]
    _, out, _ = run("catalog", "list", body["section"], *named, *words, "--json")
    printed = json.loads(out)
    found = do("parts", **body)
    assert parts_of(found) == [part["part"] for part in printed["parts"]][:200] and len(parts_of(found)) > 1
    assert (found["found"], found["undecided"]) == (printed["found"], printed["undecided"])


def test_what_cannot_be_read_is_said_at_its_field(do):
    found = do("parts", section="motors", catalogues=["maxon"], options={"voltage": "24", "power": ">=20 W"},
               where=["max_speed>=1 rpm", "max_sped>1 rpm", "kind>x"])  # fmt: skip
    assert [fault["field"] for fault in found["faults"]] == ["voltage", "where.1", "where.2"]
    assert all("--" not in fault["text"] for fault in found["faults"])
    assert 'no column "max_sped"' in found["faults"][1]["text"]
    assert "sort" in do("parts", section="motors", catalogues=["maxon"], sort="weight")["lines"][0]
    assert "no catalogue is called" in do("parts", section="motors", catalogues=["maxxon"])["lines"][0]


# -- one part, and several


@pytest.mark.parametrize(
    ("catalogue", "section", "part", "curves"),
    [
        ("maxon", "motors", "118752", ["speed-torque"]),
        ("maxon", "gearheads", "110313", ["torque-ratio"]),
        ("wittenstein", "gearheads", "", ["efficiency", "torque-ratio"]),
        ("yuasa", "batteries", "NP4-12", ["discharge-current"]),
        ("oukeda", "steppers", "", ["pull-out"]),
        ("mean_well", "power_supplies", "", []),
    ],
)
def test_a_part_is_that_of_the_command(do, run, monkeypatch, catalogue, section, part, curves):
    monkeypatch.setenv("COLUMNS", "400")
    part = part or parts_of(do("parts", section=section, catalogues=[catalogue]))[0]
    _, out, _ = run("catalog", "show", part, "--catalog", catalogue, "--source")
    printed = " ".join(out.split())
    found = do("part", catalogue=catalogue, section=section, part=part)
    assert list(found["figures"]) == [f"part-{name}" for name in curves]
    shown = html.fromstring(f"<div>{found['sheet']}{found['does']}</div>")
    for drawing in shown.xpath("//figure"):
        drawing.drop_tree()
    rows = [" ".join(" ".join(row.itertext()).split()) for row in shown.xpath("//tbody/tr | //p")]
    assert len(rows) > 5 and [row for row in rows if row not in printed] == []
    assert all(text in printed for document in found["documents"] for text in document)


# -- into the spec


def chosen(do: Callable[..., Any], text: str, **body: Any) -> Any:
    """The spec's data after a choice."""
    piece = do("choose", text, **body)
    assert piece["kind"] == "edits", piece
    edits = [Edit(tuple(path), value, text) for path, value, text in piece["edits"]]
    return YamlSource(edited(text, edits), "spec").data


def test_a_part_takes_the_place_of_what_was_chosen_of_its_kind(do):
    motor = ["maxon", "motors", "118752"]
    assert chosen(do, "name: x\n", part=motor) == {"name": "x", "select": {"motor": {"part": "118752"}}}
    text = "select:\n  motor: {family: EC*, kind: brushless}  # flat\n  catalogs: pololu\n"
    assert chosen(do, text, part=motor) == {"select": {"motor": {"part": "118752"}, "catalogs": ["pololu", "maxon"]}}
    assert chosen(do, "select: {catalogs: all}", part=motor, family=True) == {
        "select": {"catalogs": "all", "motor": {"family": "RE 25"}}
    }
    assert chosen(do, "select: {motor: {kind: brushed}}", part=motor)["select"]["motor"]["kind"] == "brushed"


def test_catalogues_are_added_or_chosen_alone(do):
    assert chosen(do, "name: x", catalogues=[NAME], add=True)["select"]["catalogs"] == ["maxon", NAME]
    assert chosen(do, "name: x", catalogues=[NAME])["select"]["catalogs"] == [NAME]
    assert chosen(do, "select: {catalogs: all}", catalogues=[NAME], add=True)["select"]["catalogs"] == ["all", NAME]


def test_the_answer_ranks_with_a_catalogue_that_was_dropped(held):
    pieces = {piece["kind"]: piece for piece in _until_ranked(done(held, "answer", {"text": SPEC, "edits": []}))}
    assert [one["motor"] for one in pieces["ranking"]["sets"]] == ["OWN-1", "OWN-2"]
    take_over(held, {NAME: RIGHT.replace("[OWN-1, 10]", "[OWN-1, 30]").encode()})
    pieces = {piece["kind"]: piece for piece in _until_ranked(done(held, "answer", {"text": SPEC, "edits": []}))}
    assert [one["motor"] for one in pieces["ranking"]["sets"]] == ["OWN-2", "OWN-1"]
    take_over(held, {})
    (*_, last) = _until_ranked(done(held, "answer", {"text": SPEC, "edits": []}))
    assert last["kind"] == "wrong" and str(Path("dropped") / "mine.yaml") in last["lines"][0]
    take_over(held, {NAME: RIGHT.encode()})


def _until_ranked(pieces: Iterator[Any]) -> Iterator[Any]:
    for piece in pieces:
        yield piece
        if piece["kind"] in ("ranking", "wrong"):
            return


def test_a_file_beside_the_spec_is_read_as_it_is_now(do, held):
    path = Path(held.name).parent / "beside.yaml"
    for part in ("FIRST", "SECOND"):
        path.write_text(RIGHT.replace("OWN-1", part), encoding="utf-8")
        assert parts_of(do("parts", section="motors", catalogues=["beside.yaml", "pololu"]))[:2] == [part, "OWN-2"]
