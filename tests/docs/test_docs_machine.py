"""What the pages of platform, battery and machine say, against the program and its tests."""

from __future__ import annotations

import json
import math
import re

import pytest
from docs_pages import ROOT, blocks, held_against_the_page, page, rows

from drivesizer.control.path_following.runs import follow_runs
from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases.platform import driving
from drivesizer.output.json import behaviour as json_driving
from drivesizer.output.json import documents as json_documents
from drivesizer.platform import robot_figures
from drivesizer.platform.matrix_equation import PLATFORM
from drivesizer.results.check_kinds import CHECKS
from drivesizer.spec.robot import read_spec

pytest.importorskip("mathematics", reason="the documentation's own packages are not installed")

MATRICES = [PLATFORM[number] for number in sorted(PLATFORM)]


def test_the_page_of_the_paper_names_what_fails_of_the_platform():
    told = rows(page("paper"), "### The platform's printed form")
    numbers = [int(n) for row in told for n in re.findall(r"\(#?(\d+)\)\]", row[0])]
    assert numbers == [e.number for e in MATRICES if any(robot_figures.finding(e))]
    assert not any(robot_figures.finding(e).units for e in MATRICES)


def test_every_budget_check_is_on_its_page():
    told = {row[0] for name in ("battery", "budgets") for row in rows(page(name), "## Checks")}
    assert told == {declared.title for declared in CHECKS["budget"].values()}


def test_what_a_radius_comes_to_straight_ahead():
    lever = 0.27406 * (math.cos(math.radians(29.5)) + math.sin(math.radians(29.5)))
    assert f"{math.degrees(0.001 / (4 * lever) * 90):.1f}°" == "3.5°"
    assert "90 m straight ahead would make it 3.5°" in page("platform")


FURTHER = {  # of other pages
    ("platform", "0.3 %, and half of that at half the step"): (
        "platform_mujoco",
        "assert fine < 0.006  # N*m, of 2.08: 0.3 %",
    ),
    ("platform", "the paper's robot, to 1e-12"): ("platform_kinematics", "pytest.approx(by_hand, rel=1e-12) == k.E"),
    ("platform", "on a slope: to 1e-12"): (
        "platform_dynamics",
        "np.broadcast_to(cycle.torque, torques.shape), rel=1e-12",
    ),
    ("platform", "a platform that coasts: 1e-9"): ("platform_dynamics", "pytest.approx(kept[0], rel=1e-9)"),
    ("platform", "while it slips: 1e-5"): ("platform_slip", "found.imbalance < 1e-5"),
    ("platform", "arc by unequal radii: 0.3 % and better"): (
        "platform_following",
        "-0.03 / 1.03 * 2.0, rel=3e-3)",
    ),
    ("platform", "times of planned paths: 1e-8"): (
        "platform_planner",
        "by_hand_s_curve(way, 1.2, 0.8, jerk), rel=1e-8)",
    ),
    ("battery", "-15 to +4 %, half of them within 3 %"): ("battery_pack", "assert mean.min() > -0.15"),
    ("battery", "of one battery 24 %"): ("battery_pack", '("SW12140E", -0.24, -0.16)'),
    ("battery", "0.1 µV"): ("battery", "right, abs=1e-7"),
    ("battery", "74 W for 3 h 15 min"): (
        "battery_budget",
        "printed = 24 * 3.55 * (3 / 3.25) ** (1 / slope) * 7.0 / 7.58",
    ),
}


@pytest.mark.parametrize("said", FURTHER, ids=lambda said: f"{said[0]}: {said[1]}")
def test_amounts_of_other_pages_are_those_of_the_tests(said):
    name, line = FURTHER[said]
    assert said[1] in page(said[0])
    assert line in next((ROOT / "tests").rglob(f"test_{name}.py")).read_text(encoding="utf-8")


DRIVEN = {
    "Drive": lambda driven: [driven],
    "Wheel": lambda driven: driven["wheels"],
    "Run": lambda driven: [*driven["following"].values()],
}


@pytest.fixture(scope="module")
def driven():
    """Of the platform of the page on the first metres of a way, followed and not."""
    (text,) = (b.text for b in blocks(page("platform")) if b.title == "robot.yaml")
    motion = "motion: {waypoints: [{x: 0 m, y: 0 m, heading: 0 deg}, {x: 1 m, y: 1 m, heading: 30 deg}]}"
    spec = read_spec(YamlSource(re.sub(r"(?m)^motion:.*$", motion, text), "x.yaml"))
    found = driving(spec)
    return [
        json.loads(json_documents.as_text(json_driving.driving(found, None, runs)))
        for runs in ({}, follow_runs(found, None))
    ]


@pytest.mark.parametrize("heading", DRIVEN)
def test_the_tables_of_a_driven_platform_are_the_document(driven, heading):
    held_against_the_page(heading, [record for document in driven for record in DRIVEN[heading](document)])
