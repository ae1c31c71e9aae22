"""The choice by weights in a browser: the same order as in Python, keys and address, screens, paper, accessibility."""

from collections.abc import Iterator
from math import isnan, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser_pages import findings, kept, launched, until
from html_reports import with_choices

from drivesizer.output.document.axes import content_of, document_of
from drivesizer.output.document.content import Content
from drivesizer.output.document.paper import paper_data
from drivesizer.output.report.html.candidate_plots import weights_section
from drivesizer.output.report.html.page import filled_page
from drivesizer.results.sizing import weighted_order

pytestmark = pytest.mark.slow
COUNT = 45  # drives; 20 are seen at first


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    yield from launched()


@pytest.fixture(scope="module")
def weighed(result):
    return with_choices(result, COUNT)


@pytest.fixture(scope="module")
def path(weighed, tmp_path_factory) -> Path:
    """The section alone on a page without figures, which opens in a tenth of the time of a whole report."""
    made = tmp_path_factory.mktemp("weights") / "page.html"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("plotly.offline.get_plotlyjs", lambda: "")
        sections = {"sections": [weights_section(Content(weighed))]}
        made.write_bytes(filled_page(paper_data(document_of(content_of(weighed))) | sections, {}, {}))
    return made


@pytest.fixture(scope="module")
def page(browser, path):
    yield from kept(browser, path)


def names(page):
    return page.locator("#by-weights tbody tr:visible th").all_inner_texts()


def said(page):
    return page.locator("[role=status]").inner_text()


def weigh(page, **weights):
    for name, weight in weights.items():
        page.locator(f".weight[data-name={name}] [type=number]").fill(str(weight))


def test_the_rule_gives_the_same_order_in_the_browser_and_in_python(page):
    """Random figures, some unknown, below zero or alike, and random weights: order and scores to the last bit."""
    draw, tasks = np.random.default_rng(8), []
    for count in (1, 2, 30, 200):
        for _ in range(15):
            ends = {"mass": (0.1, 3.0), "price": (50.0, 900.0), "energy": (-20.0, 40.0)}
            figures = {name: draw.uniform(*both, count) for name, both in ends.items()}
            figures["margin"] = draw.choice([0.5, 0.8, 0.9], count)
            figures["price"][draw.random(count) < 0.2] = nan
            weights = {name: float(draw.choice([0.0, 1.0, 2.5, draw.uniform(0, 7)])) for name in figures}
            tasks.append((figures, weights))
    given = [[{k: [None if isnan(x) else x for x in c.tolist()] for k, c in f.items()}, w] for f, w in tasks]
    answers = page.evaluate("(tasks) => tasks.map(([figures, weights]) => byWeights(figures, weights))", given)
    for (figures, weights), answer in zip(tasks, answers, strict=True):
        found = weighted_order(figures, weights)
        assert answer["order"] == found.order.tolist() and answer["lacking"] == found.lacking.tolist()
        assert [nan if score is None else score for score in answer["score"]] == pytest.approx(
            found.score.tolist(), rel=0, abs=0, nan_ok=True
        )


def test_it_opens_in_silence_in_the_order_of_the_spec(page, weighed, path):
    masses = sorted((one.figures["mass"], one.parts.motor_name) for one in weighed.choices.drives)
    assert names(page) == [name for _, name in masses[:20]]
    until(page, lambda: "It is also the best by the spec's objective" in said(page))
    assert page.heard.console == [] and page.heard.requests == [path.as_uri()] and "#" not in page.url


def test_keys_move_a_weight_and_the_address_keeps_it(page, weighed, browser):
    page.locator("#weight-energy").focus()
    for _ in range(4):
        page.keyboard.press("ArrowRight")
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.getAttribute('aria-label')").startswith("energy per cycle, weight")
    assert page.evaluate("document.activeElement.value") == "2"
    drives = weighed.choices.drives
    columns = {name: np.array([one.figures[name] for one in drives]) for name in ("mass", "energy")}
    order = weighted_order(columns, {"mass": 1.0, "energy": 2.0}).order
    wanted = [drives[n].parts.motor_name for n in order]
    spec = wanted.index(drives[weighed.choices.first].parts.motor_name)
    assert spec >= 1 and names(page) == wanted[:20] + ([wanted[spec]] if spec >= 20 else [])
    until(page, lambda: page.url.endswith("#weights:mass=1,energy=2"))
    assert said(page).startswith(f"The best by mass 1, energy per cycle 2: {wanted[0]} + GP")
    assert f"is in place {spec + 1}." in said(page)
    assert page.locator(".command code").inner_text().endswith("--objective mass=1,energy=2")
    other = next(opened := kept(browser, Path(page.url.removeprefix("file://").partition("#")[0])))
    other.goto(page.url)  # sent to somebody else, whose page is open already
    until(other, lambda: names(other) == names(page))
    assert other.locator(".weight[data-name=energy] [type=number]").input_value() == "2"
    next(opened, None)


def test_what_is_unknown_goes_below_while_it_counts(page, weighed):
    drives = weighed.choices.drives
    lacking = {one.parts.motor_name for one in drives if isnan(one.figures["price"])}
    weigh(page, mass=1, price=0.5, energy=0, margin=0)
    page.get_by_role("button", name="Show all 45").press("Enter")
    assert {*names(page)[-len(lacking) :]} == lacking
    rows = page.locator("#by-weights tbody tr").all_inner_texts()
    assert all(row.count("unknown") == 2 for row in rows[-len(lacking) :]) and "unknown" not in "".join(rows[:30])
    weigh(page, price=0)
    assert {*names(page)[-len(lacking) :]} != lacking
    page.get_by_role("button", name="Show the first 20").click()
    assert len(names(page)) in (20, 21)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_section_has_no_serious_finding(page, scheme):
    page.emulate_media(color_scheme=scheme)
    assert findings(page) == []
