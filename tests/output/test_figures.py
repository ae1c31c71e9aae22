"""Figures: the same bytes each time, units on the axes, no peak lost in the thinning."""

import json
import warnings
from dataclasses import replace
from math import isnan, nan
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from conftest import ROOT
from specs import estimates_off
from synthetic_validation import labels, synthetic_validation

from drivesizer.catalog import Catalog
from drivesizer.files.yaml_source import YamlSource, read
from drivesizer.load_cases import load_cycle
from drivesizer.machine.operating_field import field
from drivesizer.machine.problem import problem
from drivesizer.output.report.figures import cycle
from drivesizer.output.report.figures.all_figures import Behaviour
from drivesizer.output.report.figures.choice import front
from drivesizer.output.report.figures.cycle import speed_profile
from drivesizer.output.report.figures.field import Panel, panels, paper_points, torque_speed
from drivesizer.output.report.figures.picture import on_paper, scatter
from drivesizer.output.report.figures.style import Window, house_style, named, thinned
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import SizingResult
from drivesizer.simulate import hardest_case, validate
from drivesizer.sizing import explain, size
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


# --- what is unknown

STARTER = (ROOT / "drivesizer" / "spec" / "starters" / "wheeled_vehicle.yaml").read_text(encoding="utf-8")
LOADED = """
cases:
  - {name: light, load: {mass: 20 kg}}
  - {name: loaded, load: {mass: 45 kg}}
  - {name: empty battery, supply: {min: 22 V}}
"""


@pytest.fixture(scope="module")
def chosen(spec: RobotSpec, catalog: Catalog) -> DriveSet:
    """The paper's set."""
    return size(spec, catalog=catalog, top=1).sets[0]


@pytest.fixture(scope="module")
def rubs_unknown(chosen: DriveSet) -> DriveSet:
    """The same with a motor whose no-load current nobody prints: its friction is unknown."""
    return replace(chosen, motor=replace(chosen.motor, no_load_current=nan, friction_torque=nan))


def test_an_unknown_rms_current_is_no_point_of_the_field(spec, rubs_unknown):
    found = field(spec, rubs_unknown)
    assert isnan(found.rms_torque) and not np.isnan(found.cycle_torque).any()
    said = labels(on_paper(torque_speed(Panel(cases=((0, "", found),)))))
    assert "load cycle" in said and not any("nan" in text or "RMS" in text for text in said)


def test_least_figures_are_unknown_in_every_table(spec, rubs_unknown, catalog):
    """What heat and energy a set takes at least is not what it takes: each table says unknown, none a figure."""
    motors = catalog.motors
    row = motors.rows["118752"]
    columns = {**motors.columns, "no_load_current": motors["no_load_current"].copy()}
    columns["no_load_current"][row] = nan
    poorer = replace(catalog, motors=replace(motors, columns=columns))
    (found,) = explain(estimates_off(spec.model_copy(update={"method": "physics"})), "118752", "406764", catalog=poorer)
    figures = {f.name: f.value for f in found.figures}
    for name in ("energy", "returned", "power", "joule_heat", "peak_current", "winding_temperature"):
        assert isnan(figures[name]), name
    does = Behaviour(problem(spec, catalog), rubs_unknown)
    assert does.cost == "unknown" and (does.heat[0].title, does.heat[0].text) == ("Copper loss, mean", "unknown")


@pytest.fixture(scope="module")
def several() -> tuple[RobotSpec, DriveSet]:
    slow = STARTER.replace("control:\n", "control:\n  rate: 1 kHz\n", 1)  # its loops are designed in no time
    spec = read_spec(YamlSource(slow + LOADED, "robot.yaml"))
    return spec, size(spec, top=1).sets[0]


def test_the_closed_loop_drives_the_hardest_case(several):
    """Of cases that differ in mass alone the heaviest takes most torque, by Newton's second law."""
    spec, best = several
    assert hardest_case(spec, best) == "loaded"
    proofs = {name: validate(spec, best, load_case=name) for name, _ in spec.load_cases[:3]}
    peaks = {name: np.abs(proof.series["current"]).max() for name, proof in proofs.items()}
    assert peaks["loaded"] > peaks["as specified"] > peaks["light"]
    assert [proof.case for proof in proofs.values()] == ["as specified", "light", "loaded"]
    assert "the load case loaded is simulated; 3 further cases are not simulated" in proofs["loaded"].assumptions


def test_a_set_that_no_loop_can_drive_is_reported_without(tmp_path, monkeypatch, run):
    """Pololu prints no rotor inertia: everything but the closed loop is reported, and why it is missing."""
    text = STARTER.replace("mass: 30 kg", "mass: 6 kg").replace("speed: 1 m/s", "speed: 0.3 m/s")
    text = text.replace("nominal: 24 V", "nominal: 12 V")
    text = text.replace("catalogs: [maxon]", "catalogs: [pololu]\n  estimates: off")
    (tmp_path / "robot.yaml").write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    status, _, err = run("report", "-o", "report.json", "-o", "report.html")
    assert status == 0 and "rotor inertia not in the catalogue" in err
    (axis,) = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))["axes"]
    assert axis["validation"] is None
    assert any(said.startswith("not simulated in closed loop: motor") for said in axis["result"]["warnings"])
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "not simulated in closed loop: motor" in page and "from from" not in page


LIFT = """
name: lift
load: {kind: belt_axis, mass: 18 kg, pulley_diameter: 50.93 mm, efficiency: 0.94, incline: 90 deg, friction_force: 25 N}
motion: {profile: s_curve, distance: 900 mm, speed: 0.9 m/s, acceleration: 3 m/s^2, jerk: 30 m/s^3, rest_time: 8 s,
  there_and_back: true, payload: 7 kg, payload_back: 0 kg}
supply: {nominal: 48 V, max: 50 V, kind: power_supply}
brake_resistor: {resistance: 8 ohm, power: 20 W, chopper_voltage: 54 V}
select: {catalogs: [maxon]}
"""


@pytest.fixture(scope="module")
def lift(catalog):
    return explain(read_spec(YamlSource(LIFT, "lift.yaml")), "614949", "223084", catalog=catalog)[0]


def test_a_load_that_its_weight_would_move_is_not_advised_to_be_without_power(lift):
    """Friction keeps the integral where lifting left it; only a brake may relieve the motor of a load that hangs."""
    friction = LIFT.replace("friction_force: 25 N", "friction_force: 90 N").replace(
        ", payload: 7 kg, payload_back: 0 kg", ""
    )
    (warning,) = (w for w in warned(friction, lift) if w.startswith("at rest the integral"))
    held = 18.0 * 9.80665 * 0.05093 / 2 / lift.gearhead.ratio / lift.motor.torque_constant
    assert f"where holding the load needs {held:.3g} A: a brake" in warning
    assert warning.endswith("a brake that holds at rest saves that heat; with the power stage off alone the load moves")


def test_what_a_payload_needs_at_rest_is_not_kept_by_the_integral(lift):
    """With 7 kg more above, 7.8 A hold the load there, not the 5.6 A of the empty one."""
    assert not [w for w in warned(LIFT, lift) if w.startswith("at rest the integral")]


def warned(text, drive):
    return validate(read_spec(YamlSource(text, "lift.yaml")), drive).warnings
