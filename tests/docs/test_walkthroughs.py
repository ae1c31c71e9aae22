"""The tutorials: a short spec, a first screen with the recommendation on it, and an AGV as its engineer wants it."""

from __future__ import annotations

import math
import re

import pytest
from docs_pages import DOCS, ROOT, blocks
from pdf_text import texts_of

from drivesizer import size
from drivesizer.files.yaml_source import YamlSource
from drivesizer.output.parts import machine_parts, totals
from drivesizer.output.report import write
from drivesizer.spec.robot import read_spec

PAGES = sorted((DOCS / "tutorials").glob("*.md"))
COLUMNS, LINES = 80, 45


def spec_of(page):
    return next(block.text for block in blocks(page.read_text(encoding="utf-8")) if block.title == "robot.yaml")


def first_screen(page):
    """Lines as a terminal of 80 columns shows them: a longer one goes on below."""
    printed = [block.text for block in blocks(page.read_text(encoding="utf-8")) if block.language == "text"]
    text = next(text for text in printed if "\nParts of " in text)
    return [line[at : at + COLUMNS] for line in text.splitlines() for at in range(0, max(len(line), 1), COLUMNS)]


def test_there_is_one_for_each_kind_of_user():
    assert [page.stem for page in PAGES] == ["agv", "arm", "conveyor", "own_parts", "paper", "recorded", "screw"]
    for page in PAGES:
        assert f"(docs/tutorials/{page.name})" in (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_tutorial_begins_with_a_short_spec_and_ends_with_the_next_step(page):
    text = page.read_text(encoding="utf-8")
    assert len(spec_of(page).splitlines()) <= 25
    assert re.findall(r"^## (.*)$", text, re.MULTILINE)[:2] == ["The spec", "What to read in it"]
    assert "\n## Next step\n" in text


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_first_screen_has_the_recommendation_at_its_top(page):
    """What it shows is held against the program by test_docs."""
    lines = first_screen(page)
    assert len(lines) <= LINES and "..." not in lines
    (drive,) = (n for n, line in enumerate(lines) if re.match(r"\d+ × +(?:motor|actuator) ", line))
    (total,) = (n for n, line in enumerate(lines) if re.match(r" *total\b", line))
    assert drive < 12 and drive < total < 20


def test_the_agv_gets_brushless_motors_with_controllers_and_totals_of_four_wheels():
    """Against prices and masses of the catalogue, added by hand."""
    (page,) = (page for page in PAGES if page.stem == "agv")
    result = size(read_spec(YamlSource(spec_of(page), "robot.yaml")), top=1)
    best = result.sets[0]
    assert best.status == "pass" and best.motor.kind == "brushless" and best.controller is not None
    lines = machine_parts(best, result.problem)
    assert {line.quantity for line in lines} == {4}
    mass, price = totals(lines)
    assert price.value == pytest.approx(4 * (best.motor.price + best.gearhead.price)) and not math.isnan(price.value)
    weights = [part.mass for part in (best.motor, best.gearhead)]
    assert mass.value == pytest.approx(4 * (sum(weights) + 0.020 + 0.045))
    assert mass.estimated == ("encoder", "controller")
    screen = "\n".join(first_screen(page))
    assert re.search(r"4 × +motor +maxon EC-i 40", screen) and f"{price.value:.2f} EUR" in screen


@pytest.mark.slow
def test_the_first_page_of_the_report_of_the_agv_has_nothing_unknown_in_its_box(tmp_path):
    """Mass and price are sums of what is known or estimated, and say what they lack; every other figure is there."""
    result = size(read_spec(YamlSource(spec_of(DOCS / "tutorials" / "agv.md"), "robot.yaml")), top=1)
    write(result, None, [tmp_path / "agv.pdf"])
    (page,) = texts_of((tmp_path / "agv.pdf").read_bytes(), 1)
    box = page.split("Smallest margin", 1)[1].split("Table 2", 1)[0]
    assert "3.66 kg" in box and "2000.36 EUR" in box and "2.993 kJ" in box
    assert "unknown" not in box


def test_the_robot_of_the_paper_is_the_example():
    """What its tutorial states is what the example states; a battery beside it takes back what braking returns."""
    stated = YamlSource(spec_of(DOCS / "tutorials" / "paper.md"), "robot.yaml").data
    whole = YamlSource((ROOT / "examples" / "sps_robot.yaml").read_text(encoding="utf-8"), "sps_robot.yaml").data
    assert stated["supply"].pop("accepts") == "all" and "battery" in whole
    assert not differing(stated, whole)


def differing(stated, whole):
    """Entries of a section that are not those of another."""
    if not isinstance(stated, dict):
        return [] if stated == whole else [(stated, whole)]
    return [found for key, value in stated.items() for found in differing(value, whole.get(key))]
