"""The machine in a report: what it is, its way in plan view, its wheels over time, what it weighs, why it falls."""

import csv
import io
import json
import math
import re
from collections.abc import Callable
from functools import cache
from math import cos, isnan, sin

import jsonschema
import numpy as np
import pytest
from conftest import ROOT
from matplotlib.colors import to_hex
from pdf_pages import SHEETS, assert_within_margins
from printed import Printed, blank_figures, printed, text_of

from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases.platform import trajectory_of
from drivesizer.output.document.axes import content_of
from drivesizer.output.document.content import Content, driven_over, machine_words
from drivesizer.output.document.machine import followed, mass_blocks, permitted
from drivesizer.output.document.records import Table
from drivesizer.output.json.documents import plain
from drivesizer.output.json.schema import report_schema
from drivesizer.output.report import report_json
from drivesizer.output.report.csv import report_csv
from drivesizer.output.report.figures import cycle as motion
from drivesizer.output.report.figures import cycle as wheels
from drivesizer.output.report.figures import machine
from drivesizer.output.report.figures.all_figures import Behaviour
from drivesizer.output.report.figures.style import COLOURS
from drivesizer.output.report.html.page import report_html
from drivesizer.output.report.pdf import report_pdf
from drivesizer.results.sizing import SizingResult
from drivesizer.simulate import validate
from drivesizer.sizing import size
from drivesizer.spec.robot import RobotSpec, load_spec, read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

EXAMPLE = ROOT / "examples" / "sps_platform.yaml"
TEXT = EXAMPLE.read_text(encoding="utf-8")


def changed(*pairs: tuple[str, str]) -> RobotSpec:
    text = TEXT
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    return read_spec(YamlSource(text, str(EXAMPLE)))


PLACED = ("heading_error: 2 deg}", "heading_error: 2 deg, x: 26 m, y: 11 m, direction: 90 deg}")


@pytest.fixture(scope="module")
def result() -> SizingResult:
    """The platform with a battery of unknown mass."""
    return size(changed((", mass: 2.65 kg", "")), top=2)


# -- what it is


def test_a_platform_is_told_by_mass_wheels_size_and_way(spec):
    way = trajectory_of(load_spec(EXAMPLE))
    assert machine_words(load_spec(EXAMPLE)) == (
        "Platform of 45 kg on 4 driven mecanum wheels, wheel diameter 152.4 mm; 707 × 350 × 184 mm; "
        f"path of {way.length:.4g} m in {way.total:.4g} s"
    )
    assert machine_words(spec) == (
        "Platform of 45 kg on 4 driven mecanum wheels, wheel diameter 152.4 mm; 707 × 350 × 184 mm"
    )


# -- the way


def test_the_way_is_drawn_to_scale_with_its_headings_and_ends(canvas):
    spec = changed(PLACED)
    (axes,) = canvas(machine.plan_view, spec).axes
    box, (left, right), (low, high) = axes.get_window_extent(), axes.get_xlim(), axes.get_ylim()
    assert (right - left) / box.width == pytest.approx((high - low) / box.height, rel=1e-3)
    way = trajectory_of(spec)
    (path,) = [line for line in axes.lines if to_hex(line.get_color()) == COLOURS["blue"].lower()]
    x, y, _ = way.at(np.linspace(0.0, way.total, len(path.get_xdata())))
    assert np.allclose(path.get_xdata(), x) and np.allclose(path.get_ydata(), y)
    assert left < x.min() and x.max() < right and low < y.min() and y.max() < high
    arrows = next(c for c in axes.collections if hasattr(c, "U"))
    assert 15 <= len(arrows.U) <= 30
    for px, py, u, v in zip(*arrows.XY.T, arrows.U, arrows.V, strict=True):
        near = int(np.hypot(x - px, y - py).argmin())
        heads = way.at(np.linspace(0.0, way.total, len(x)))[2]
        same = [h for h, a, b in zip(heads, x, y, strict=True) if np.hypot(a - x[near], b - y[near]) < 1e-9]
        assert any(abs(u * sin(h) - v * cos(h)) < 1e-9 and u * cos(h) + v * sin(h) > 0.0 for h in same)
    assert [text.get_text() for text in axes.texts] == ["door of a section", "start and end"]


def test_a_passage_stands_where_it_is_and_is_as_wide_as_it_is(canvas):
    (axes,) = canvas(machine.plan_view, changed(PLACED)).axes
    walls = [patch.get_xy()[:4] for patch in axes.patches]
    assert len(walls) == 2
    inner = sorted(min(abs(wall[:, 0] - 26.0)) for wall in walls)
    assert inner == pytest.approx([0.2, 0.2])  # half of 400 mm to either side, across a way that goes up
    assert all(np.ptp(wall[:, 1]) == pytest.approx(0.1) and wall[:, 1].mean() == pytest.approx(11.0) for wall in walls)
    (bare,) = canvas(machine.plan_view, load_spec(EXAMPLE)).axes
    assert not bare.patches  # without a place


def test_the_profile_of_a_platform_is_its_own_motion(canvas, result):
    straight, turning = canvas(motion.speed_profile, result.spec).axes
    forwards, left = (line for line in straight.lines if len(line.get_xdata()) > 2)
    assert max(forwards.get_ydata()) == pytest.approx(1.5) and min(left.get_ydata()) < -0.5
    assert (straight.get_ylabel(), turning.get_ylabel()) == ("speed (m/s)", "turning (°/s)")
    (turned,) = (line for line in turning.lines if len(line.get_xdata()) > 2)
    x, y = (np.asarray(column, float) for column in turned.get_data())
    assert np.trapezoid(y, x) == pytest.approx(360.0, rel=2e-3)  # from 0 to 360 degrees
    speed = np.hypot(*(np.interp(np.arange(0.0, 86.0, 0.01), *line.get_data()) for line in (forwards, left)))
    assert speed.sum() * 0.01 == pytest.approx(trajectory_of(load_spec(EXAMPLE)).length, rel=5e-3)


# -- wheels


def test_each_wheel_has_a_row_of_its_torque_and_its_speed(canvas, result):
    cycles = [(case.name, case.cycle) for case in result.problem.cases]
    axes = canvas(wheels.each_over_time, wheels.load(cycles)).axes
    assert [a.get_title(loc="left") for a in axes] == [
        f"{name}: {what}" for name, _ in cycles for what in ("torque (N·m)", "speed (rpm)")
    ]
    assert len({a.get_ylim() for a in axes[::2]}) == len({a.get_ylim() for a in axes[1::2]}) == 1
    for row, (_, cycle) in enumerate(cycles):
        torque, speed = (axes[2 * row + column].lines[0].get_ydata() for column in (0, 1))
        assert (torque.min(), torque.max()) == pytest.approx((cycle.torque.min(), cycle.torque.max()))
        rpm = cycle.speed * 30.0 / np.pi
        assert (speed.min(), speed.max()) == pytest.approx((rpm.min(), rpm.max()))


def test_the_energy_of_a_way_is_the_sum_over_its_wheels(result):
    best = result.sets[0]
    flow = Behaviour(result.problem, best).energy
    drawn = {one.name: one.mean for one in best.energy.consumers}
    total = trajectory_of(load_spec(EXAMPLE)).total
    of_the_drive = drawn["drive"] + drawn["regenerated energy"] + drawn["losses of the controllers"]
    assert flow.drawn - flow.stored == pytest.approx(of_the_drive * total, rel=1e-6)
    assert flow.drawn > drawn["drive"] * total and flow.stored < -drawn["regenerated energy"] * total
    parts = (
        flow.copper,
        flow.friction,
        flow.gearhead,
        flow.belt,
        flow.load,
        flow.rotor,
        flow.controller,
        flow.returned,
    )
    assert sum(parts) == pytest.approx(flow.drawn, rel=1e-6)


# -- masses and battery


def test_masses_one_by_one_with_their_sum_and_what_it_lacks(result):
    best = result.sets[0]
    table, note = mass_blocks(best)
    rows = {row.cells["title"]: row.cells for row in table.rows}
    motor, encoder = rows["motor"], rows["encoder"]
    assert (motor["number"].text, motor["value"].value) == ("4 ×", pytest.approx(4 * best.motor.mass))
    assert encoder["each"].text == "0.02 kg (0.008 to 0.05 kg)" and rows["battery"]["value"].text == "unknown"
    known = sum(row.number * row.each for row in best.masses if not isnan(row.each))
    sums = [row.cells["value"].text for row in table.rows if row.total]
    assert sums[0] == f"{known:.4g} kg" and len(sums) == 2
    lacks = ", ".join(row.name for row in best.masses if isnan(row.each))
    assert note.text == f"Not known and not in the sum: {lacks}."


# -- what falls


LIGHTER = ("  mass: 45 kg                      # paper: about 45 kg\n  structure", "  mass: 35 kg\n  structure")


@pytest.mark.parametrize(
    ("change", "title"), [(("autonomy: 3 h", "autonomy: 30 h"), "Battery autonomy"), (LIGHTER, "Mass of the machine")]
)
def test_a_drive_that_fails_on_the_machines_budget_says_so_first(change, title):
    result = size(changed(change, ("select: {", "select: {motor: {family: [DCX 22 L, RE 25]}, ")), top=2)
    assert not result.sets and result.misses
    with blank_figures():
        summary, found, _ = text_of(report_pdf(content_of(result)), most=2).partition("CONTENTS")
        page = re.sub(r"\s+", " ", report_html(content_of(result)).decode())
    assert found and re.search(rf"fails on:[^.]*{title}", summary)
    assert re.search(rf"it fails on: [^<]*{title}", page)


# -- the whole report


@pytest.fixture(scope="module")
def sheets(result) -> Callable[[str], Printed]:
    """The report on a paper, once each."""
    proof = validate(result.spec, result.sets[0])
    assert driven_over(proof) == "the cycle of wheel 1"
    return cache(lambda paper: printed(result, proof, paper=paper))


@pytest.mark.slow
@pytest.mark.parametrize("paper", SHEETS)
def test_the_platforms_report_stays_on_its_pages(paper, sheets):
    pages = sheets(paper).pictures
    assert_within_margins(pages, paper)
    for page in pages[:-1]:  # a figure that found no room does not leave a page to itself
        inked = np.flatnonzero((page < 0.7).any(axis=1))
        within = (inked > 0.08 * len(page)) & (inked < 0.94 * len(page))
        assert len(inked[within]) > 0.15 * len(page) and inked[within].min() < 0.2 * len(page)


@pytest.mark.slow
def test_the_platforms_report_speaks_of_wheels(sheets):
    text = " ".join(text_of(sheets("a4").content).split())
    assert "Kinematics and dynamics of the platform" in text and "Wheel speeds over velocity (32), (33)" in text
    assert "Closed loop over the cycle of wheel 1" in text and "Masses of the machine" in text
    assert (
        "each at its worst wheel" in text
        and "as specified" not in text
        and not re.search(r"(?<!load )case wheel", text)
    )


def test_every_report_has_the_platforms_matrices(result):
    """By hand: (238.53 + 134.95) / 76.2 of E, 76.2 mm · cos 45° of J₂; the inertia with the drive's rotors."""
    content = content_of(result)
    rows = {row["name"]: row for row in csv.DictReader(io.StringIO(report_csv(content).decode()))
            if row["section"] == "platform"}  # fmt: skip
    assert float(rows["E_wheel_1_theta"]["value"]) == pytest.approx(4.9013, abs=1e-4)
    assert (float(rows["J_2_wheel_4_wheel_4"]["si_value"]), rows["J_2_wheel_4_wheel_4"]["si_unit"]) == (
        pytest.approx(0.053881, abs=1e-6), "m",
    )  # fmt: skip
    assert float(rows["wheels_wheel_2_α"]["si_value"]) == pytest.approx(math.radians(29.5))
    wheel = 40e-4 + result.sets[0].rotors_at_load
    assert float(rows["M_bar_x_x"]["value"]) == pytest.approx(45 + 4 * wheel / 0.0762**2, rel=1e-9)
    assert {"28", "29", "32", "43", "45", "50", "51", "55", "58", "59"} <= {row["equation"] for row in rows.values()}
    document = plain(result)["platform_numbers"]
    (matrix,) = (one for one in document["matrices"] if one["name"] == "E")
    assert matrix["values"][0][2] == pytest.approx(4.9013, abs=1e-4)
    schema = report_schema()
    jsonschema.validate(document, schema["$defs"]["PlatformNumbers"] | {"$defs": schema["$defs"]})


def test_the_speeds_by_direction_are_in_the_report(result, canvas):
    """A diagonal of the drive is slower than straight on; a circle shows what the spec asks for."""
    report = content_of(result)
    content = report.alone
    found = content.behaviour.permitted
    table = next(block for block in permitted(content) if isinstance(block, Table))
    assert [column.head for column in table.columns[1:-1]] == ["all motors", *(f"without {n}" for n in range(1, 5))]
    assert [row.cells["all_motors"].value for row in table.rows] == [
        found.at(degrees)[0][0] for degrees in range(0, 91, 15)
    ]
    rows = {row["name"]: row for row in csv.DictReader(io.StringIO(report_csv(report).decode()))}
    assert float(rows["45_all_motors"]["si_value"]) == found.at(45)[0][0] < found.at(0)[0][0]
    panels = canvas(machine.speed_by_direction, found).axes
    assert [axes.get_title("left") for axes in panels] == [f"without wheel {n}" for n in range(1, 5)]
    whole, without, asked = (np.hypot(*line.get_data()) for line in panels[0].lines)
    assert whole == pytest.approx(found.speed[0][[*range(72), 0]]) and asked == pytest.approx(np.full(73, 1.5))
    assert (without <= whole + 1e-9).all()


SHORT = (
    "{trajectory: sps_way.csv}",
    "{waypoints: [{x: 0 m, y: 0 m, heading: 0 deg}, {x: 1 m, y: 1 m, heading: 30 deg}]}",
)
MEASURED = "{measured: [{name: a robot, position: 2 m, heading: 3 deg}]}"


def test_path_following_is_in_the_report_of_a_spec_that_has_it(result):
    assert [*followed(Content(result, None))] == []
    found = size(changed(SHORT, ("  misjudged:", f"  following: {MEASURED}\n  misjudged:")), top=1)
    report = content_of(found)
    content = report.alone
    table = next(block for block in followed(content) if isinstance(block, Table))
    names = ["a robot, measured", "kinematic model", "dynamic model", "poses fed back"]
    assert [row.cells["title"] for row in table.rows] == names
    rows = csv.DictReader(io.StringIO(report_csv(report).decode()))
    by = {row["name"]: float(row["si_value"]) for row in rows if row["section"] == "followed"}
    assert by["a_robot_measured_position"] == 2.0
    wanted = content.behaviour.followed["dynamic model"]
    assert by["dynamic_model_position"] == pytest.approx(np.hypot(*(wanted.posture - wanted.planned.posture)[:2]).max())
    assert content.pictures["followed"].paper("svg") == content.pictures["followed"].paper("svg")
    assert list(json.loads(report_json(report))["axes"][0]["path"]["following"]) == names[1:]


def test_a_platform_that_tips_over_is_not_followed_and_its_report_says_so():
    tall = ("centre_of_mass: {height: 90 mm}", f"centre_of_mass: {{height: 3.5 m}}\n  following: {MEASURED}")
    report = content_of(size(changed(SHORT, tall), top=1))
    content = report.alone
    (words,) = followed(content)
    assert "the platform tips over" in words.text
    assert "followed" not in content.pictures and report_json(report)
