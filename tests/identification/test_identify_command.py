"""``drivesizer identify`` at the command line: what it prints and writes, and one line on what is no log."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from motor_logs import motor_log


def log_of(path: Path) -> Path:
    """A log that was written there."""
    path.write_text(motor_log())
    return path


def test_it_prints_figures_draws_them_and_writes_a_part(run: Any, tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    log_of(Path("log.tsv"))
    status, out, err = run("identify", "log.tsv", "-o", "fit.svg", "-o", "own.yaml")
    assert status == 0
    assert "resistance" in out
    assert "50 mV·s/rad" in out
    assert "gear loss" in out
    assert err.count("written") == 2
    assert "<svg" in Path("fit.svg").read_text()
    status, out, _ = run("catalog", "show", "own", "--catalog", "own.yaml", "--json")
    part = json.loads(out)["parts"][0]
    assert (status, part["resistance"]) == (0, pytest.approx(2.0, rel=0.01))
    status, out, _ = run("predict", "own", "--catalog", "own.yaml", "--voltage", "12 V", "--json")
    free = next(one for one in json.loads(out)["figures"] if one["name"] == "free_speed")
    assert free["band"]["nominal"] == pytest.approx((12.0 - 2.0 * 0.004 / 0.05) / 0.05, rel=0.01)


def test_json_has_si_and_a_part_the_rest_of_the_data_sheet(run: Any, tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    status, out, _ = run("identify", log_of(Path("log.tsv")), "--motor", "118752", "--json", "-o", "own.yaml")
    found = json.loads(out)
    schema = json.loads(run("schema", "identification")[1])
    jsonschema.Draft202012Validator(schema).validate(found)
    figures = {one["name"]: one for one in found["figures"]}
    assert status == 0
    assert figures["J"]["value"] == pytest.approx(2e-5, rel=0.05)  # the sheet has an inductance, the log none
    assert figures["J"]["unit"] == "kg*m^2"
    assert figures["R"]["printed"] == pytest.approx(2.32)
    text = Path("own.yaml").read_text()
    assert "confidence: measured" in text
    assert "118752 measured" in text
    status, out, _ = run("catalog", "check", "--catalog", "own.yaml")
    assert status == 0, out


def test_an_identified_motor_is_sized_and_validated(run: Any, tmp_path: Path, monkeypatch: Any) -> None:
    """A flywheel of which it drives a few times its own inertia; the gains are designed for the measured R."""
    monkeypatch.chdir(tmp_path)
    run("identify", log_of(Path("log.tsv")), "-o", "own.yaml")
    Path("robot.yaml").write_text("""name: flywheel
load: {kind: rotary_table, inertia: 0.5 g*m^2}
motion: {profile: trapezoid, speed: 600 rpm, acceleration_time: 0.5 s, cruise_time: 1 s, rest_time: 2 s}
transmission: [{kind: direct}]
supply: {nominal: 12 V}
select: {catalogs: [own.yaml]}
""")
    status, out, err = run("size", "robot.yaml", "--json")
    best = json.loads(out)["axes"][0]["result"]["sets"][0]
    assert (status, best["motor"]["part"]) == (0, "own"), err
    assert best["motor"]["resistance"] == pytest.approx(2.0, rel=0.01)
    status, out, err = run("validate", "robot.yaml", "--json")
    checks = {one["name"]: one for one in json.loads(out)["axes"][0]["validations"][0]["checks"]}
    assert status == 0 and checks["tracking_error"]["status"] == "pass", err


HEAD = b"WPILOG\x00\x01"
HOSTILE = {
    "empty.csv": b"",
    "zeros.csv": bytes(1000),
    "words.csv": b"these are\nsome words\n",
    "constant.csv": ("time (s),voltage (V),speed (rpm)\n" + "".join(f"{n},5,7\n" for n in range(50))).encode(),
    "nan.csv": ("time (s),voltage (V),speed (rpm)\n" + "".join(f"{n},nan,inf\n" for n in range(50))).encode(),
    "back.csv": ("time (s),voltage (V),speed (rpm)\n" + "".join(f"{-n},{n},7\n" for n in range(50))).encode(),
    "unit.csv": ("time (s),voltage (V),speed (kg)\n" + "".join(f"{n},{n},7\n" for n in range(50))).encode(),
    "short.csv": b"time (s),voltage (V),speed (rpm)\n0,1,2\n1,2,3\n",
    "only.csv": ("time (s),torque (N*m)\n" + "".join(f"{n},{n}\n" for n in range(50))).encode(),
    "deep.json": b"[" * 100_000,
    "other.json": b'{"a": 1}',
    "sysid.json": b'{"slow-forward": [[1, 2], [3]], "fast-forward": "x"}',
    "rig.json": b'{"mass": 1e308, "length": 0, "entries": [{"position": "x"}, 3]}',
    "calibration.json": b'{"raw": {"x": [{}]}, "params": {"R": null}}',
    "version.wpilog": b"WPILOG\x09\x09",
    "cut.wpilog": HEAD + struct.pack("<I", 2**32 - 1),
    "huge.wpilog": HEAD + bytes(4) + bytes([0xFF]) + b"\xff" * 30,
    "names.wpilog": HEAD
    + bytes(4)
    + bytes([0x20, 0, 17])
    + bytes(3)
    + bytes([0])
    + struct.pack("<II", 1, 2**31)
    + bytes(8),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_no_log_is_one_line_and_nothing_is_written(run: Any, tmp_path: Path, monkeypatch: Any, name: str) -> None:
    monkeypatch.chdir(tmp_path)
    Path(name).write_bytes(HOSTILE[name])
    status, out, err = run("identify", name, "-o", "own.yaml", "-o", "fit.png")
    assert (status, out) == (2, "")
    assert len(err.strip().splitlines()) == 1, err
    assert err.startswith(f"drivesizer: {name}") or "speed" in err, err
    assert sorted(path.name for path in tmp_path.iterdir()) == [name]


@pytest.mark.parametrize(("words", "said"), [
    (("-o", "fit.gif"), "does not say what is to be written"),
    (("--scale", "speed"), "expected a column and its factor"),
    (("--scale", "sped=2"), "is no column of the log"),
    (("--inertia", "2 m"), "--inertia"),
    (("--column", "amps=current (A)"), "expected one of time"),
    (("--column", "current=amps"), "no row has the heads"),
    (("--motor", "no such"), "no such"),
])  # fmt: skip
def test_wrong_options_are_one_line(run: Any, tmp_path: Path, words: tuple[str, ...], said: str) -> None:
    status, _, err = run("identify", log_of(tmp_path / "log.tsv"), *words)
    assert status == 2
    assert said in err
    assert len(err.strip().splitlines()) == 1
