"""Pages in the machine's Chromium: opened once they are drawn, with what they said and asked for."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

__all__ = ["Heard", "findings", "kept", "launched", "opened", "until"]

NAMES = ("chromium", "chromium-browser", "google-chrome")


def launched() -> Iterator[Any]:
    """The machine's Chromium; where the project's checks run, it must be there."""
    found = next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        said = f"no browser: none of {', '.join(NAMES)} is installed"
        pytest.fail(said) if os.environ.get("CI") == "true" else pytest.skip(said)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        made = driver.chromium.launch(executable_path=found)
        yield made
        made.close()


class Heard:
    """What a page said, asked for and opened."""

    def __init__(self, page: Any) -> None:
        self.console: list[str] = []
        self.requests: list[str] = []
        page.on("console", lambda message: self.console.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: self.console.append(f"error: {error}"))
        page.on("request", lambda request: self.requests.append(request.url))
        page.on("dialog", lambda dialog: (self.console.append(f"dialog: {dialog.message}"), dialog.dismiss()))


def opened(browser: Any, path: Path, width: int = 1400, **more: Any) -> tuple[Any, Heard]:
    page = browser.new_page(viewport={"width": width, "height": 1000}, **more)
    heard = Heard(page)
    page.goto(path.as_uri())
    page.wait_for_selector("html[data-drawn]", timeout=60_000)
    return page, heard


def until(page: Any, happened: Callable[[], bool], patience: int = 400) -> None:
    """Wait for what a busy machine may take seconds to draw; the page's own policy forbids the browser's waiting."""
    for _ in range(patience):
        if happened():
            return
        page.wait_for_timeout(50)
    pytest.fail("did not happen within 20 s")


def kept(browser: Any, path: Path, width: int = 1400, **more: Any) -> Iterator[Any]:
    made, heard = opened(browser, path, width, **more)
    made.heard = heard
    yield made
    made.close()


def findings(page: Any) -> list[str]:
    """What axe-core finds, however grave; figures and formulas are drawn by others.

    It is run in the page and not loaded by it, so that the page's own policy does not matter.
    """
    import axe_playwright_python

    page.evaluate((Path(axe_playwright_python.__file__).parent / "axe.min.js").read_text(encoding="utf-8"))
    found = page.evaluate('axe.run({exclude: [".js-plotly-plot", "math"]}, {resultTypes: ["violations"]})')
    assert len(found["passes"]) > 15
    return [f"{one['id']}: {node['html']}" for one in found["violations"] for node in one["nodes"]]
