"""Reports for the tests of the page: a drive with every figure, and one whose texts try to be markup."""

from __future__ import annotations

import json
import math
import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from loops_by_hand import CASCADE, UNSTABLE
from lxml import html
from starters import STARTERS
from synthetic_validation import synthetic_validation

from drivesizer.control.validation import Validation
from drivesizer.files.yaml_source import read
from drivesizer.results.sizing import Choice, Choices, SizingResult
from drivesizer.spec.robot import RobotSpec, read_spec

HOSTILE = "</td></script><script>alert(3)</script>&amp; {{ 7*7 }} 測試"  # a family of motors
NAME = (
    """<script>alert(1)</script> "</script> <!-- ]]> & &lt; ${1} #eval("1") $x$ *b* `r` =1+1 \\\\ """
    "測試 робот \u202e %{x}"
)
CASE = "<img src=x onerror=alert(1)> %{y} <b>b</b> &amp; 'q'"


def parsed(content: bytes) -> Any:
    """A page as a tree."""
    return html.document_fromstring(content.decode(), parser=html.HTMLParser(encoding="utf-8"))


def figures_of(page: Any) -> dict[str, Any]:
    """The figures that a page draws, as plain data."""
    (block,) = page.xpath("//script[@id='figures']")
    found: dict[str, Any] = json.loads(block.text)
    return found


def hostile_spec(folder: Path) -> RobotSpec:
    """A hoist whose names are markup in every language near: HTML, JavaScript, plotly, typst, CSV."""
    text = (STARTERS / "hoist.yaml").read_text(encoding="utf-8")
    shown = NAME.replace("\u202e", "")  # refused at the door; a report spells it out nevertheless
    lines = ["name: " + json.dumps(shown) if line.startswith("name:") else line for line in text.splitlines()]
    cases = {
        "cases": [
            {"name": CASE, "load": {"mass": "18 kg"}},
            {"name": "weak", "supply": {"nominal": "20 V", "min": "18 V"}},
        ]
    }
    path = folder / "robot.yaml"
    path.write_text("\n".join([*lines, f"cases: {json.dumps(cases['cases'])}"]) + "\n", encoding="utf-8")
    return read_spec(read(path)).model_copy(update={"name": NAME})


def whole_validation(result: SizingResult) -> Validation:
    """A made-up cascade of the SPS robot: every loop, one of them unstable, a position error, a winding that warms."""
    plain = synthetic_validation(result)
    time = plain.series["time"]
    more = {"position_error": 0.002 * np.sin(time), "winding_temperature": 298.15 + 3.0 * time}
    units = {"position_error": ("length", "mm"), "winding_temperature": ("temperature", "degC")}
    loops = (*CASCADE, replace(UNSTABLE[1], name="shaft"))
    return replace(plain, loops=loops, series=plain.series | more, series_units=plain.series_units | units)


def with_choices(result: SizingResult, count: int = 30) -> SizingResult:
    """A sizing with made-up drives to choose from: some without a price, one with a family that tries to be markup."""
    draw, best = random.Random(count), result.sets[0]
    drives = []
    for n in range(count):
        motor = replace(best.motor, part=f"M{n}", family=HOSTILE if n == 3 else "F")
        figures = {"mass": draw.uniform(0.2, 2.0), "price": math.nan if n % 7 == 4 else draw.uniform(100.0, 900.0),
                   "energy": draw.uniform(20.0, 90.0), "margin": 1.5 - 0.04 * n}  # fmt: skip
        drives.append(Choice(parts=replace(best, motor=motor, belt_ratio=1.0), figures=figures))
    first = min(range(count), key=lambda n: drives[n].figures["mass"])
    choices = Choices(
        drives=tuple(drives), first=first, weights={"mass": 1.0}, passing=5 * count, judged=False, whole=True
    )
    return replace(result, choices=choices)
