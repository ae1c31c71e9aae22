"""The page of a machine in a browser: power of all axes that can be moved, on a telephone with a dark screen."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from browser_pages import launched, opened, until
from printed import blank_figures
from two_axes import two_axes

from drivesizer.multi_axis.sizing import size_machine
from drivesizer.output.report import write_machine
from drivesizer.results.machine import MachineSizing

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("no_further_searches")]


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    yield from launched()


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> MachineSizing:
    return size_machine(two_axes(tmp_path_factory.mktemp("shelf")), top=1)


@pytest.fixture(scope="module")
def report(machine: MachineSizing, tmp_path_factory: pytest.TempPathFactory) -> Path:
    with blank_figures():
        (path,) = write_machine(machine, {}, [tmp_path_factory.mktemp("page") / "report.html"])
    return path


def upper_edges(page: Any) -> list[list[float]]:
    """The upper edge of each layer that is shown, as plotly stacked it."""
    return page.evaluate("""() => document.querySelector("[data-plot=power]").calcdata
        .filter((points) => points[0].trace.stackgroup === "drawn" && points[0].trace.visible === true)
        .map((points) => points.map((point) => point.y))""")  # type: ignore[no-any-return]


def test_power_is_stacked_and_a_hidden_axis_leaves_the_stack(browser, report, machine):
    page, heard = opened(browser, report, 390, color_scheme="dark")
    drawn = machine.power.course(1000).drawn
    assert heard.console == [] and page.evaluate("document.documentElement.scrollWidth") <= 390
    lower, upper = upper_edges(page)
    assert lower[:-1] == pytest.approx(drawn[0], rel=1e-4, abs=1e-3)
    assert upper[:-1] == pytest.approx(drawn.sum(axis=0), rel=1e-4, abs=1e-3)
    page.locator("#figure-power .legend button").first.click()
    until(page, lambda: len(upper_edges(page)) == 1)
    assert upper_edges(page)[0][:-1] == pytest.approx(drawn[1], rel=1e-4, abs=1e-3)
    drawing = page.locator("[data-plot=power]")
    drawing.focus()
    page.keyboard.press("ArrowRight")
    until(page, lambda: "table" in (drawing.locator(".hoverlayer").text_content() or ""))
    assert " W" in drawing.locator(".hoverlayer").text_content() and heard.console == []
    page.close()
