"""What helps a drive that fails in its loop: each remedy, entered into the spec as it is printed, passes."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest
import yaml
from typer.testing import CliRunner

from drivesizer.cli import app
from drivesizer.control.validation import Validation
from drivesizer.load_cases import profile_of
from drivesizer.output.document.content import Content
from drivesizer.output.document.records import text_of
from drivesizer.output.document.summary import outcome_texts
from drivesizer.simulate import rounded_ramps, validate, with_remedies
from drivesizer.sizing import size
from drivesizer.spec.robot import load_spec

# at the end of the ramp the loop overshoots, and draws more of the supply than the ideal motion: 7.7 A lie between
FIELDS = yaml.safe_load("""
name: shuttle
load: {kind: wheeled_vehicle, mass: 60 kg, driven_wheels: 2, wheel_diameter: 150 mm, rolling_resistance: 2 %,
  inertia: 25 kg*cm^2}
motion: {speed: 1.2 m/s, acceleration_time: 1.5 s, cruise_time: 60 s, rest_time: 10 s}
transmission: [{kind: gearhead}]
supply: {nominal: 24 V, current: 7.7 A, regeneration: 50 %, accepts: all}
select: {catalogs: [maxon], objective: price}
""")


@pytest.fixture(scope="module")
def sizing():
    return size(load_spec(FIELDS), top=3)


@pytest.fixture(scope="module")
def proof(sizing) -> Validation:
    found = validate(sizing.spec, sizing.sets[0])
    return with_remedies(found, sizing.spec, sizing.sets)


def entered(entry: str):
    """The spec with what a remedy says."""
    place, text = (yaml.safe_load(f"{entry}").popitem()) if ":" in entry else (entry, None)
    fields = {**FIELDS, "control": {}}
    if place.startswith("control."):
        fields["control"][place.removeprefix("control.")] = text
    else:
        fields[place] = text
    return load_spec(fields)


def test_what_helps_passes_as_entered(sizing, proof):
    assert sizing.sets[0].status == "pass"
    assert (proof.status, proof.failed) == ("fail", "supply current, all drives")
    assert len(proof.tried) <= 6
    assert any(one.status == "pass" for one in proof.tried)
    for one in proof.tried:
        if one.entry.startswith("--set"):
            drive = next(s for s in sizing.sets if one.entry.endswith(f"{s.motor.part}/{s.gearhead.part}"))
            assert validate(sizing.spec, drive).status == one.status
            continue
        again = validate(entered(one.entry), sizing.sets[0])
        tight = min(c.margin for c in again.checks if c.is_comparable)
        assert (again.status, tight) == (one.status, pytest.approx(one.tightest.margin, rel=1e-6))


@pytest.mark.parametrize(
    ("motion", "expected", "duration"),
    [
        # the slower ramp of 2 s: 0.6 m/s², and a quarter of it for the jerk. Each ramp then lasts 2.5 s, on 1.5 m: of
        # 1.2 m/s · (1.75 s + 60 s) 59.25 s of cruise are left
        (
            {"speed": "1.2 m/s", "acceleration_time": "1.5 s", "deceleration_time": "2 s", "cruise_time": "60 s",
             "rest_time": "10 s"},
            "distance: 74.1 m, speed: 1.2 m/s, acceleration: 0.6 m/s², jerk: 1.2 m/s³, rest_time: 10 s", 74.25,
        ),
        # 0.9 m in 3 s, of which ramps of 1 s: 0.45 m/s; ramps of 1.25 s on 0.28125 m each, 0.75 s of cruise
        (
            {"profile": "move", "distance": "0.9 m", "time": "3 s", "there_and_back": True},
            "distance: 0.9 m, speed: 0.45 m/s, acceleration: 0.45 m/s², jerk: 1.8 m/s³, there_and_back: true", 6.5,
        ),
    ],
)  # fmt: skip
def test_rounded_ramps_by_hand(motion, expected, duration):
    spec = load_spec({**FIELDS, "motion": motion})
    found = next(rounded_ramps(spec, SimpleNamespace(spec=spec)))
    assert found.entry == f"motion: {{profile: s_curve, {expected}}}"
    assert profile_of(found.spec).duration == pytest.approx(duration, rel=1e-6)


def test_one_verdict_names_the_loops(sizing, proof):
    content = Content(sizing, proof)
    said = text_of(tuple(outcome_texts(content)))
    assert content.status == "fail"
    assert said.startswith("fail A drive was found, which fails in closed loop.")
    assert said.endswith("trapezoid: fail supply current, all drives")


def test_a_drive_that_passes_is_left_alone(sizing):
    free = load_spec({**FIELDS, "supply": {**FIELDS["supply"], "current": "20 A"}})
    found = validate(free, sizing.sets[0])
    assert with_remedies(found, free, sizing.sets) is found
    assert not found.tried


def test_a_remedy_that_size_rejects_does_not_help(sizing, proof):
    """Of each change the checks of `size` come first: what they reject is shown with the check that fails."""
    worn = replace(sizing.sets[0].checks[0], status="fail", margin=-0.5)
    rejected = replace(sizing.sets[0], checks=(worn,), status="fail")
    found = with_remedies(proof, sizing.spec, sizing.sets, sized=lambda _, one: rejected)
    changes = [one for one in found.tried if not one.entry.startswith("--set")]
    assert changes and all((one.status, one.tightest) == ("fail", worn) for one in changes)
    assert [one for one in found.tried if one not in changes] == [one for one in proof.tried if "--set" in one.entry]


def test_another_drive_says_what_it_adds_to_the_axis_that_carries_it(sizing, proof):
    first = sizing.sets[0]
    heavy = replace(first, motor=replace(first.motor, family="heavier", mass=first.motor.mass + 0.25))
    worn = replace(first, checks=(replace(first.checks[0], status="fail"),), status="fail")
    found = with_remedies(proof, sizing.spec, [heavy], axis="slide", sized=lambda _, one: worn)
    assert found.tried[-1].what == "another drive, 250 g heavier"


def test_axis_by_axis_of_a_machine(tmp_path):
    """Entered under the axis, or with the option that names it: the same loop as that of a machine of one axis."""
    own = {name: FIELDS[name] for name in ("load", "motion", "transmission")}
    table = {"load": {"kind": "rotary_table", "inertia": "0.02 kg*m^2"}, "transmission": [{"kind": "gearhead"}],
             "motion": {"speed": "20 rpm", "acceleration_time": "0.5 s", "cruise_time": "1 s"}}  # fmt: skip
    shared = {name: FIELDS[name] for name in ("name", "supply", "select")}
    path = tmp_path / "machine.yaml"
    path.write_text(yaml.safe_dump({**shared, "axes": {"shuttle": own, "table": table}}))
    found = CliRunner().invoke(app, ["validate", str(path)], env={"COLUMNS": "200"})
    assert found.exit_code == 1 and "FAIL: shuttle" in found.stdout
    said = found.stdout.partition(": what helps in the loop")[2]
    assert "axes.shuttle.motion: {profile: s_curve, distance: 73.8 m" in said
    assert "axes.shuttle.control.bandwidth: " in said and "--axis shuttle --set " in said
    assert found.stdout.count("helps in the loop") == 1
