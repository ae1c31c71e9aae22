"""What the pages of platform, battery and machine say, against the program and its tests."""

from __future__ import annotations

import math
import re

import pytest
from docs_pages import page, rows

from drivesizer.platform import robot_figures
from drivesizer.platform.equations import PLATFORM
from drivesizer.results.check_kinds import CHECKS

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
