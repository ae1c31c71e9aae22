"""The paper's robot: by hand, as the paper found it, and the same in any units."""

import math
import re

import pytest

from drivesizer.files.yaml_source import YamlSource
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import read_spec

RPM = 30 / math.pi


def checks(found):
    return {check.name: check for check in found.checks}


def test_the_papers_drive(result):
    best = result.sets[0]
    assert best.status == "pass"
    assert (best.motor.family, best.motor.part) == ("RE 25", "118752")
    assert (best.gearhead.family, best.gearhead.part, best.gearhead.reduction) == ("GP 26 A", "406764", "27:1")
    assert (best.encoder.family, best.encoder.part, best.encoder.counts_per_turn) == ("MR type ML", "225778", 500)
    assert (best.controller.family, best.controller.part) == ("EPOS4 Compact 50/5", "541718")
    assert best.belt_ratio == 1.1
    assert best.gearhead.ratio == pytest.approx(3249 / 121)


def test_by_hand(result):
    """Figures worked by hand from the printed equations with the example's numbers."""
    r = {q.name: q for q in result.requirements} | {q.name: q for q in result.sets[0].requirements}
    assert r["nominal_speed"].value * RPM == pytest.approx(60 * 1.5 / (math.pi * 0.1524 * 0.9), rel=1e-12)
    assert r["nominal_speed"].shown == pytest.approx(208.865, abs=5e-4)
    assert r["nominal_force"].value == pytest.approx(0.02 * 45 * 9.80665, rel=1e-12)
    assert r["nominal_torque"].value == pytest.approx(0.0762 * 8.825985 / 0.95, abs=1e-9)
    wheel = 0.847768 / 2 * (0.0762**2 + 0.03**2)
    shaft = 7850 * math.pi * 0.006**2 * 0.08 / 2 * 0.006**2
    acc = (4 * (wheel + shaft + 10.8e-7) + 45 / 0.9 * 0.1524**2 / 4) * (2 * 0.75 / 0.1524) * 1.2
    assert r["acceleration_torque"].value == pytest.approx(acc, rel=1e-6)
    nom = 0.0762 * 8.825985 / 0.95
    rms = math.sqrt((2 * (nom + acc) ** 2 + 240 * nom**2 + 2 * (nom - acc) ** 2) / 244) / 4
    assert r["rms_torque_per_motor"].value == pytest.approx(rms, rel=1e-6)
    assert r["rms_torque_per_motor"].value == pytest.approx(0.211, abs=5e-4)
    at_motor = rms / (3249 / 121 * 0.8 * 1.1 * 0.95)
    assert r["rms_torque_at_motor"].value == pytest.approx(at_motor, rel=1e-6)


def test_35_to_1_falls_by_input_speed(spec, catalog):
    found = checks(explain(spec, "118752", "406767", catalog=catalog)[0])["gearhead_input_speed"]
    assert found.status == "fail"
    assert found.demand * RPM == pytest.approx(8036, abs=0.5)
    assert found.limit * RPM == pytest.approx(8000)


@pytest.mark.parametrize(
    ("reserve", "reduction"),
    [(0.555, ""), (0.56, "19:1"), (0.69, "19:1"), (0.694, "19:1"), (0.695, ""), (0.70, ""), (0.705, ""),
     (0.706, "27:1"), (0.904, "27:1"), (0.905, "35:1"), (1.0, "35:1")],
)  # fmt: skip
def test_the_speed_reserve_decides_the_gearhead(example_text, catalog, reserve, reduction):
    """By hand: 5552.2 rpm / η against 8000 rpm at the input, with 1917 rpm more against 408 rpm/V · 24 V by (19)."""
    text = example_text.replace("speed_reserve: 0.9 ", f"speed_reserve: {reserve} ")
    found = size(read_spec(YamlSource(text, "robot.yaml")), catalog=catalog, top=1).sets
    assert [one.gearhead.reduction for one in found] == [reduction] * bool(reduction)


@pytest.mark.parametrize(
    ("factor", "stands", "falls"),
    [("bearing", 0.30, 0.28), ("robot_efficiency", 0.43, 0.42), ("oversize", 2.47, 2.49), ("confidence", 0.01, None)],
)
def test_the_other_factors_change_no_gearhead(example_text, catalog, factor, stands, falls):
    for value, reductions in ((stands, ["27:1"]), (falls, [])):
        if value is not None:
            text = re.sub(rf"  {factor}: [0-9.]+ ", f"  {factor}: {value} ", example_text)
            found = size(read_spec(YamlSource(text, "robot.yaml")), catalog=catalog, top=1).sets
            assert [one.gearhead.reduction for one in found] == reductions, value


@pytest.mark.parametrize("kept", ["", "bearing", "robot_efficiency", "confidence", "oversize"])
def test_without_its_speed_reserve_the_answer_is_not_the_papers(example_text, catalog, kept):
    """At the defaults of 1 the gearhead turns at 7232 rpm behind 35:1, and 8000 are permitted."""
    factors = "speed_reserve|bearing|robot_efficiency|confidence|oversize"
    text = re.sub(rf"(?m)^  ({factors}): .*\n", lambda line: line[0] if line[1] == kept else "", example_text)
    text = text if kept else re.sub("paper_factors:.*\n.*\n", "", text)  # heading and its remark
    best = size(read_spec(YamlSource(text, "robot.yaml")), catalog=catalog, top=1).sets[0]
    speed = checks(best)["gearhead_input_speed"]
    assert (best.gearhead.reduction, speed.status) == ("35:1", "pass")
    assert speed.demand * RPM == pytest.approx(1539 / 44 * 1.1 * 60 * 1.5 / (math.pi * 0.1524), rel=1e-9)  # 7232


def test_the_10_w_winding_falls_by_speed(spec, catalog):
    found = checks(explain(spec, "118743", "406764", catalog=catalog)[0])["motor_speed"]
    assert found.status == "fail"
    assert found.demand * RPM == pytest.approx(6169, abs=0.5)
    assert found.limit * RPM == pytest.approx(4860)


def test_19_to_1_is_not_the_largest(spec, catalog):
    found = checks(explain(spec, "118752", "406762", catalog=catalog)[0])
    assert found["largest_reduction"].status == "fail"
    assert found["gearhead_input_speed"].status == "pass"


def test_required_speed_constant(result):
    """408 rpm/V against 317 as printed and 337 with the belt, says the transcription."""
    best = result.sets[0]
    C_v = {r.name: r for r in best.requirements}["speed_constant"]
    assert C_v.shown == pytest.approx(337, abs=0.5)
    assert best.motor.speed_constant * RPM == pytest.approx(408)


def test_the_unrestricted_search_is_told(result):
    other = result.unrestricted
    assert other is not None
    # by data sheets alone: of the paper's drive no mass of its controller is printed, of another all are
    assert {"encoder", "controller"} <= {*other.mass_of} and "controller" not in result.sets[0].mass_of
    assert other.encoder.counts_per_turn >= 500


def test_without_encoder_and_controller_families_others_suffice_too(example_text, catalog):
    text = example_text.replace("  encoder: {family: MR type ML}\n", "").replace("family: EPOS4 Compact 50/5, ", "")
    best = size(read_spec(YamlSource(text, "robot.yaml")), catalog=catalog).sets[0]
    assert best.motor.part == "118752"
    assert best.encoder.counts_per_turn >= 500 and best.encoder.mass < 0.035  # kg, of a HEDL 5540
    assert best.controller.continuous_current < 5.0
    fitting = catalog.motor_encoder.right[catalog.motor_encoder.left == catalog.motors.rows["118752"]]
    hedl = [catalog.encoders.record(int(row)) for row in fitting]
    assert sum(e.family == "HEDL 5540" and e.counts_per_turn == 500 for e in hedl) == 4


def test_both_methods_say_pass(result):
    """The paper concludes that the motor does not reach its limits: 14000 rpm and 125 degC, of its product page."""
    best = result.sets[0]
    assert {check.status for check in best.checks} == {"pass"}
    assert best.motor.max_speed * RPM == pytest.approx(14000)
    assert best.motor.max_winding_temperature == pytest.approx(125 + 273.15)
    assert not [one for one in best.estimated if one.part == "motor"]


def test_sinkage_gives_the_coefficient_by_equation_4(example_text, catalog, result):
    z = 0.02**2 * 0.1524
    text = example_text.replace("rolling_resistance: 0.02", f"sinkage: {z!r} m")
    other = size(read_spec(YamlSource(text, "robot.yaml")), catalog=catalog)
    mine = {r.name: r for r in other.requirements}
    assert mine["rolling_resistance_coefficient"].equation == 4
    assert mine["rolling_resistance_coefficient"].value == pytest.approx(0.02)
    assert mine["rms_torque"].value == pytest.approx({r.name: r for r in result.requirements}["rms_torque"].value)


def test_a_slope_adds_its_share(example_text, catalog, result):
    text = example_text.replace("slope: 0 deg", "slope: 3 deg")
    other = {
        r.name: r
        for r in size(read_spec(YamlSource(text, "robot.yaml")), catalog=catalog, detail="drives").requirements
    }
    force = 45 * 9.80665 * (0.02 * math.cos(math.radians(3)) + math.sin(math.radians(3)))
    assert other["nominal_force"].value == pytest.approx(force)
