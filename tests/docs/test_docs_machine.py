"""What the pages of platform, battery and machine say, against the program and its tests."""

from __future__ import annotations

import json
import math
import re

import pytest
from docs_pages import blocks, held_against_the_page, page, rows

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
