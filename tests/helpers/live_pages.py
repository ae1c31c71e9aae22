"""The live page as its user has it: a tab of the machine's Chromium, and what is typed and opened there."""

from __future__ import annotations

from typing import Any

from browser_pages import Heard

__all__ = ["SMALL", "answered", "field", "live", "opening"]

SMALL = """\
name: AGV  # of the test
load:
  kind: wheeled_vehicle
  mass: 45 kg  # with payload
  driven_wheels: 4
  wheel_diameter: 152 mm
  rolling_resistance: 0.02
  inertia: 40 kg*cm^2
motion: {speed: 1.5 m/s, acceleration_time: 2 s, cruise_time: 20 s, rest_time: 5 s}
transmission:
  - kind: gearhead
supply: {nominal: 24 V, current: 20 A}
select: {motor: {family: [RE 25, RE 30]}, gearhead: {family: [GP 26 A, GP 32 C]}}
"""
"""A vehicle of a few dozen drives: its ranking takes hundredths of a second."""


def live(browser: Any, address: str, width: int = 1400, height: int = 1000, **more: Any) -> Any:
    """A tab with the page, once its report is there; ``heard`` is what it said and requested."""
    page = browser.new_context(viewport={"width": width, "height": height}, **more).new_page()
    page.heard = Heard(page)
    page.goto(address)
    return answered(page)


def answered(page: Any, state: str = "whole") -> Any:
    """The page once it has answered: ``whole``, or ``wrong`` where the spec has a fault."""
    page.wait_for_selector(f'html[data-state="{state}"]', state="attached", timeout=60_000)
    return page


def opening(page: Any, text: str, name: str = "other.yaml", state: str = "whole") -> Any:
    """The page once it has taken a file of this machine."""
    before = page.locator("html").get_attribute("data-answers")
    page.locator("#opened").set_input_files({"name": name, "mimeType": "application/yaml", "buffer": text.encode()})
    page.wait_for_selector(f'html:not([data-answers="{before}"])', state="attached", timeout=60_000)
    return answered(page, state)


def field(page: Any, *path: str | int) -> Any:
    """A field of the form by its path in the spec."""
    return page.locator(f'#form [data-key="{chr(31).join(map(str, path))}"]')
