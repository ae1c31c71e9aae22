"""The jobs behind the page: answers are those of the command line, byte for byte, and say where something is wrong."""

from __future__ import annotations

import base64
import json
import random
import zipfile
from io import BytesIO
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from drivesizer.commands.common import proven
from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.live.answer import ranking
from drivesizer.live.engine import EngineMemory, StoppedError, done
from drivesizer.multi_axis import size_machine
from drivesizer.output.json.documents import as_text
from drivesizer.output.report import write
from drivesizer.results.machine import of_one_axis
from drivesizer.sizing import size
from drivesizer.spec.machine import read_any
from drivesizer.spec.robot import load_spec, read_spec

SPEC = """\
name: AGV   # of the test
supply: {nominal: 24 V, current: 20 A}
load: {kind: wheeled_vehicle, mass: 45 kg, driven_wheels: 4, wheel_diameter: 152 mm, rolling_resistance: 0.02,
       inertia: 0.004 kg*m^2}
motion: {speed: 1.5 m/s, acceleration_time: 2 s, cruise_time: 20 s, rest_time: 5 s}
select: {motor: {family: [RE 25, RE 30]}, gearhead: {family: [GP 26 A, GP 32 C]}}
"""
PROVEN = f"{SPEC}control: {{rate: 1 kHz}}\n"  # a slow loop, whose design takes a tenth of the time
FRONT = ("mass", "price", "energy")


def pieces_of(job: str, text: str, **more: Any) -> list[dict[str, Any]]:
    """All pieces of a job, as they cross the pipe."""
    return [
        json.loads(json.dumps(piece, allow_nan=False))
        for piece in done(EngineMemory("robot.yaml"), job, {"text": text, **more})
    ]


def one(job: str, text: str, **more: Any) -> dict[str, Any]:
    (piece,) = pieces_of(job, text, **more)
    return piece


def document(text: str, edits: list[Any]) -> str:
    return base64.b64decode(one("document", text, edits=edits)["content"]).decode()


def random_edits(draw: random.Random) -> dict[tuple[str, ...], str]:
    return {
        ("load", "mass"): f"{draw.uniform(20, 60):.2f} kg",
        ("motion", "speed"): f"{draw.uniform(0.5, 2):.3f} m/s",
        ("load", "slope"): draw.choice(["0 deg", "2 deg", "3 %"]),
        ("environment", "ambient"): f"{draw.randint(0, 50)} degC",
        ("select", "objective"): draw.choice(["mass", "price", "energy"]),
    }


@pytest.mark.parametrize("seed", range(3))
def test_random_states_answer_what_the_command_line_does(seed: int, tmp_path: Path) -> None:
    """The edited text is read as a file, and the answer to it is the document of that file."""
    edits = random_edits(random.Random(seed))
    sent = [[list(path), value, False] for path, value in edits.items()]
    pieces = pieces_of("answer", SPEC, edits=sent)
    (spec,) = (piece for piece in pieces if piece["kind"] == "spec")
    assert spec["text"].startswith("name: AGV   # of the test\n")
    (ranked,) = (piece for piece in pieces if piece["kind"] == "ranking")
    path = tmp_path / "robot.yaml"
    path.write_text(spec["text"], encoding="utf-8")
    result = size(load_spec(path), top=10, pareto=FRONT)
    found = as_text(of_one_axis(result))
    assert document(SPEC, sent) == f"{found}\n"
    listed = json.loads(found)["axes"][0]["result"]["sets" if result.sets else "misses"]
    assert [one["motor"] for one in ranked["sets"]] == [(one["actuator"] or one["motor"])["part"] for one in listed]
    assert [one["mass"] for one in ranked["sets"]] == [one["mass"] for one in listed]
    assert (ranked["considered"], ranked["feasible"]) == (result.counts.considered, result.counts.feasible)


@pytest.mark.parametrize(
    ("edit", "line", "path", "said"),
    [
        ([["load", "mass"], "45 V", False], 3, ["load", "mass"], "45 V"),
        ([["load", "incline"], "3 deg", False], 4, ["load", "incline"], "unknown key"),
        ([["select", "motor", "family"], "XX", False], None, [], "XX"),
        ([["motion", "speed"], None, False], 5, ["motion", "speed"], "missing"),
        ([["transmission", 0, "ratio"], "2 mm", False], None, [], ""),
    ],
)
def test_what_is_wrong_names_line_and_field(edit: Any, line: Any, path: Any, said: str, tmp_path: Path) -> None:
    """As the command line prints it, but for the name of the file."""
    wrong = pieces_of("answer", SPEC, edits=[edit])[-1]
    assert wrong["kind"] == "wrong" and said in wrong["faults"][0]["text"]
    if line:
        assert (wrong["faults"][0]["line"], wrong["faults"][0]["path"]) == (line, path)
    place = tmp_path / "robot.yaml"
    place.write_text(wrong["text"], encoding="utf-8")
    with pytest.raises(InputError) as error:
        size(load_spec(place))
    assert [text.replace(str(place), "robot.yaml") for text in error.value.lines] == wrong["lines"]


def test_free_figures_are_said_and_the_best_machine_is_that_of_the_command(tmp_path: Path) -> None:
    """All of eight carts are sized, so that the answer is the least mass of eight sizings."""
    free = [["load", "wheel_diameter"], {"free": "120 mm .. 240 mm", "step": "40 mm"}, False]
    edits = [free, [["load", "driven_wheels"], {"free": [2, 4]}, False]]
    spec, found = pieces_of("answer", SPEC, edits=edits)
    figures = [["load.driven_wheels", {"free": [2, 4]}], ["load.wheel_diameter", free[1]]]
    assert found == {"kind": "free", "figures": figures}
    designed = one("design", spec["text"])
    assert "All of 8 machines looked at." in designed["html"]
    filled = designed["fills"][0][1]
    best = load_spec(dict(YamlSource(filled, "best").data))
    masses = [
        best.load.motors * size(best, top=1, detail="drives").sets[0].mass,
        *(wheels * one.mass for wheels in (2, 4) for diameter in (120, 160, 200, 240)
          for one in size(load_spec(_data() | {"load": _data()["load"] | {
              "driven_wheels": wheels, "wheel_diameter": f"{diameter} mm"}}), top=1, detail="drives").sets),
    ]  # fmt: skip
    assert masses[0] == pytest.approx(min(masses[1:]))
    assert "free" not in filled and filled.startswith("name: AGV   # of the test\n")
    assert pieces_of("loop", spec["text"])[-1]["kind"] == "wrong"


@pytest.mark.parametrize("speed", ["0.8 m/s", "1.5 m/s", "9 m/s"])
def test_the_first_answer_says_what_the_whole_one_does(speed: str) -> None:
    """Of drives that pass, that are open by estimates, and that are rejected."""
    text = SPEC.replace("1.5 m/s", speed).partition("select:")[0] + "select: {catalogs: [myactuator, robstride]}\n"
    at_first = next(piece for piece in pieces_of("answer", text) if piece["kind"] == "ranking")
    whole = ranking(of_one_axis(size(read_spec(YamlSource(text, "robot.yaml")), top=10)))
    assert at_first.pop("kind") == "ranking"
    shown = slice(None) if whole["found"] else slice(0)  # the closest rejected are of the whole sizing
    assert at_first["sets"][shown] == json.loads(json.dumps(whole))["sets"][shown]
    assert whole.keys() == at_first.keys() and at_first["margins"][shown] == whole["margins"][shown]


def test_a_sweep_finds_where_the_best_drive_changes() -> None:
    values = [f"{mass} kg" for mass in (20, 45, 90, 400)]
    points = pieces_of("sweep", SPEC, path=["load", "mass"], values=[*values, "9 V"])
    assert [point["value"] for point in points] == [*values, "9 V"]
    for point, value in zip(points[:4], values, strict=True):
        result = size(load_spec({**_data(), "load": {**_data()["load"], "mass": value}}), top=1, detail="drives")
        assert point["label"] == (result.reported.label if result.reported else "")
        assert (point["status"] == "fail") == (not result.sets)
    assert points[0]["label"] != points[2]["label"] and points[3]["status"] == "fail"
    assert points[4]["status"] == "wrong" and "9 V" in points[4]["said"]
    edit = [["load", "mass"], "90 kg", False]
    found = one("rejected", SPEC, edits=[edit], motor=points[0]["parts"][0], gearhead=points[0]["parts"][1])
    assert found["status"] == "fail" and found["tight"] and found["said"].startswith("−")


def _data() -> dict[str, Any]:
    from drivesizer.files.yaml_source import YamlSource

    return dict(YamlSource(SPEC, "robot.yaml").data)


def test_files_are_those_of_the_command_line(tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text(PROVEN, encoding="utf-8")
    found, proofs = proven(of_one_axis(size(load_spec(tmp_path / "robot.yaml"), top=10, pareto=FRONT)))
    write(found.alone, *proofs.values(), [tmp_path / "report.csv"])
    made = base64.b64decode(one("report", PROVEN, form="csv")["content"])
    assert made == (tmp_path / "report.csv").read_bytes()
    assert one("report", PROVEN, form="exe")["kind"] == "wrong"
    mjcf = one("export", PROVEN, form="mjcf")
    assert mjcf["name"] == "drive.xml" and b"<mujoco" in base64.b64decode(mjcf["content"])
    several = one("export", PROVEN, form="ros2_control")
    if several["name"].endswith(".zip"):
        assert zipfile.ZipFile(BytesIO(base64.b64decode(several["content"]))).namelist()


def test_a_job_that_nobody_waits_for_stops() -> None:
    held = EngineMemory("robot.yaml", stopped=lambda: True)
    pieces = done(held, "answer", {"text": SPEC})
    assert next(pieces)["kind"] == "spec"
    with pytest.raises(StoppedError):
        next(pieces)


def test_a_drive_that_fails_in_closed_loop_is_no_pass() -> None:
    """One verdict, with the check that fails: the headline said pass above a closed loop that failed."""
    sizing = size_machine(read_any(YamlSource(SPEC, "robot.yaml")))
    proof = SimpleNamespace(loop="velocity loop", status="fail", failed="Motor voltage")
    shown = ranking(sizing, {"": proof})  # type: ignore[dict-item]
    assert ranking(sizing)["status"] == "pass"
    assert (shown["status"], shown["loops"]) == ("fail", [["velocity loop", "fail: Motor voltage"]])
