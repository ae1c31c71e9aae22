"""Figures: the same bytes each time, units on the axes, no peak lost in the thinning."""

import json
import warnings
from dataclasses import replace
from math import nan
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from synthetic_validation import labels, synthetic_validation

from drivesizer.files.yaml_source import read
from drivesizer.load_cases import load_cycle
from drivesizer.machine.problem import problem
from drivesizer.output.report.figures import cycle
from drivesizer.output.report.figures.choice import front
from drivesizer.output.report.figures.cycle import speed_profile
from drivesizer.output.report.figures.field import panels, paper_points, torque_speed
from drivesizer.output.report.figures.picture import on_paper, scatter
from drivesizer.output.report.figures.style import Window, house_style, named, thinned
from drivesizer.results.sizing import SizingResult
from drivesizer.sizing import size
from drivesizer.spec.robot import RobotSpec, load_spec, read_spec

FRONT = [(270.0, 328.3), (340.0, 400.0)], [("1  one", "1"), ("2",)], [("mass", "g"), ("price", "EUR")], "ab"


def drawn(result: SizingResult) -> dict[str, Any]:
    return {
        "profile": speed_profile(result.spec),
        "load": on_paper(cycle.load([("", load_cycle(result.spec))])),
        "field": on_paper(torque_speed(panels(result.problem, result.sets[0], result.requirements)[0])),
        "front": scatter(front(*FRONT)),
        "loop": on_paper(cycle.closed_loop(synthetic_validation(result))),
    }


def test_every_figure_is_a_vector_drawing_with_the_same_bytes_each_time(result):
    first, second = ({name: draw() for name, draw in drawn(result).items()} for _ in range(2))
    for name, svg in first.items():
        assert ElementTree.fromstring(svg).tag == "{http://www.w3.org/2000/svg}svg", name
        assert svg == second[name], name
        assert b"<image" not in svg, name
        assert b"<dc:date>" not in svg, name


def test_the_field_of_a_stepper_that_never_moves_has_an_axis_of_speed():
    found = size(
        load_spec({
            "name": "held", "supply": {"nominal": "48 V"}, "motion": {"profile": "hold", "time": "9 s"},
            "load": {"kind": "hoist", "mass": "1 kg", "drum_diameter": "20 mm"},
            "transmission": [{"kind": "direct"}],
            "select": {"catalogs": ["stepperonline"], "motor": {"kind": "stepper"}},
        }),
        top=1,
    )  # fmt: skip
    made = panels(found.problem, found.sets[0], found.requirements)
    assert made[0].cases[0][-1].speed[-1] == 0.0
    assert "motor speed (rpm)" in labels(on_paper(torque_speed(made[0])))  # a warning while drawing is an error


def test_every_axis_names_its_unit(result):
    said = {name: labels(svg) for name, svg in drawn(result).items()}
    assert {"time (s), phases not to scale", "speed (m/s)", "acceleration", "2 s"} <= said["profile"]
    assert {"torque (mN·m)", "speed (rpm)", "time (s)"} <= said["load"]
    assert {"torque at the motor's shaft (mN·m)", "motor speed (rpm)"} <= said["field"]
    assert {"load cycle", "intermittent", "18.9 V, winding 25 °C", "paper: cruise"} <= said["field"]
    assert {"mass (g)", "price (EUR)", "1  one", "2"} <= said["front"]
    assert {"speed", "speed error", "(m/s)", "current", "(A)", "voltage", "(V)", "time (s)"} <= said["loop"]


def test_operating_points_agree_with_the_requirements_of_the_set(result):
    of = {r.name: r.value for r in result.sets[0].requirements}
    points = {p.name: p for p in paper_points(result.sets[0], result.requirements)}
    assert points["end of acceleration"].torque == pytest.approx(of["maximum_torque_at_motor"], rel=1e-12)
    assert points["RMS"].torque == pytest.approx(of["rms_torque_at_motor"], rel=1e-12)
    # EQUATIONS.md: through the pulleys 27:1 needs 6169 rpm at the motor
    assert points["cruise"].speed * 60 / (2 * np.pi) == pytest.approx(6169, abs=0.5)
    assert points["start of deceleration"].torque < 0


MOTIONS = {  # motion in the spec, and what stands at its axes
    "{profile: triangle, distance: 2 rad, time: 3 s, rest_time: 1 s}": {"time (s)", "speed (rpm)"},
    "{profile: harmonic, amplitude: 30 deg, period: 3 s}": {"time (s)", "speed (rpm)"},
    "{profile: s_curve, distance: 2 rad, speed: 2 rad/s, acceleration: 5 rad/s^2, jerk: 40 rad/s^3}": {"speed (rpm)"},
    "{profile: segments, segments: [{time: 1 s, to: 5 rpm}, {time: 2 s, to: -5 rpm}, {time: 1 s, to: 0 rpm}]}": {
        "time (s)"
    },
    "{profile: csv, file: speed.csv}": {"time (s)", "speed (rpm)"},
    "{speed: 20 rpm, acceleration_time: 0.5 s, deceleration_time: 0.7 s, cruise_time: 1 s, there_and_back: true}": {
        "0.7 s",
        "acceleration",
        "speed (rpm)",
    },
}


def table(folder: Path, motion: str, more: str = "") -> RobotSpec:
    """A turning table with a motion."""
    (folder / "speed.csv").write_text("time,speed\ns,rpm\n3,0\n4,20\n6,-8\n7,0\n")
    path = folder / "table.yaml"
    load = "load: {kind: rotary_table, inertia: 0.05 kg*m^2, friction_torque: 0.2 N*m}"
    path.write_text(f"name: table\n{load}\nmotion: {motion}\nsupply: {{nominal: 24 V}}\n{more}", encoding="utf-8")
    return read_spec(read(path))


@pytest.mark.parametrize("motion", MOTIONS)
def test_every_motion_has_its_curve(motion, tmp_path):
    spec = table(tmp_path, motion)
    assert MOTIONS[motion] <= labels(speed_profile(spec))
    assert {"torque (mN·m)", "speed (rpm)"} <= labels(on_paper(cycle.load([("", load_cycle(spec))])))


def test_load_cases_have_names_of_their_own_and_plain_text(result, tmp_path):
    names = ["$a_1$ <b> & c", "_under", "測試 робот", "x" * 60]  # what turns the writing, a spec refuses
    cases = "".join(
        f"  - {{name: {json.dumps(name)}, load: {{inertia: {n}.5 kg*m^2}}}}\n" for n, name in enumerate(names)
    )
    spec = table(tmp_path, next(iter(MOTIONS)), f"cases:\n{cases}")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cycles = on_paper(cycle.load([(name, load_cycle(case)) for name, case in spec.load_cases]))
        field = on_paper(torque_speed(panels(problem(spec, result.catalog), result.sets[0], ())[0]))
        for draw in (cycles, field):
            ElementTree.fromstring(draw())
    assert {"as specified", "$a_1$ &lt;b> &amp; c", " _under"} <= {said.replace("&gt;", ">") for said in labels(cycles)}
    assert named("x" * 60) == "x" * 26 + "…" and named("short") == "short"
    assert house_style()["text.parse_math"] is False


def test_an_unknown_figure_leaves_its_line_out_and_the_rest_stands(result):
    best = result.sets[0]
    bare = replace(best, motor=replace(best.motor, nominal_torque=nan, max_winding_temperature=nan), controller=None,
                   gearhead=replace(best.gearhead, inertia=nan, intermittent_torque=nan))  # fmt: skip
    said = labels(on_paper(torque_speed(panels(result.problem, bare, result.requirements)[0])))
    assert "22 V, winding 25 °C" in said
    assert not said & {"continuous", "continuous, nominal torque", "intermittent", "load cycle"}


def test_thinning_keeps_the_highest_and_the_lowest_sample():
    time = np.linspace(0.0, 1.0, 200_001)
    values = np.sin(40.0 * time)
    values[123_457], values[77_777] = 9.0, -9.0
    rows = thinned(time, values, Window("", 0.0, 1.0))
    assert len(rows) < 2000
    assert {123_457, 77_777, 0, 200_000} <= set(rows.tolist())
    assert np.all(np.diff(rows) > 0)
