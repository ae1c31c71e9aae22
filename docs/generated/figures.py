"""Figures of the pages: those of a report, of a closed loop, of a set at the bench, of a robot on its path.

Letters stay letters and coordinates have one decimal [pt], so that a figure is small; the same input gives the same
bytes.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from math import nan
from pathlib import Path

from following_page import ran

from drivesizer import explain, load_spec, size, validate
from drivesizer.catalog import load
from drivesizer.catalog.query import PartRow
from drivesizer.control.path_following import FollowingRun
from drivesizer.control.path_following import runs_of_figure as drawn_runs
from drivesizer.files.yaml_source import YamlSource
from drivesizer.machine.platform_budget import permitted_speeds
from drivesizer.output.document.bench import bench_document
from drivesizer.output.report.figures.all_figures import report_drawings
from drivesizer.output.report.figures.machine import path_and_errors, speed_by_direction
from drivesizer.output.report.figures.style import Drawing
from drivesizer.prediction.predict import completed, predict
from drivesizer.results.prediction import Conditions
from drivesizer.search.uncertainty.options import sampling_of
from drivesizer.spec.robot import RobotSpec, read_spec

__all__ = ["FIGURES", "compact", "drawn", "write"]

ROOT = Path(__file__).resolve().parents[2]
_ATTRIBUTE = re.compile(r' (d|x|y|x1|x2|y1|y2)="([^"]*)"')
_NUMBER = re.compile(r"-?\d+\.\d+")
_AGAIN = re.compile(r"( L -?[\d.]+ -?[\d.]+)\1+(?![\d.])")  # points that fall on one another
_UNSEEN = re.compile(r"<metadata>.*?</metadata>|<!--.*?-->|<!DOCTYPE[^>]*>", re.DOTALL)
_FONT = "'DejaVu Sans'"


def compact(drawing: str) -> str:
    """A drawing of matplotlib without what nobody sees, and a font of the same width where DejaVu Sans is not."""
    short = _ATTRIBUTE.sub(lambda m: f' {m[1]}="{_NUMBER.sub(_rounded, " ".join(m[2].split()))}"', drawing)
    short = _AGAIN.sub(r"\1", _UNSEEN.sub("", short))
    return re.sub(r">\s+<", ">\n<", short).replace(_FONT, f"{_FONT}, Verdana, sans-serif")


def _rounded(number: re.Match[str]) -> str:
    return f"{round(float(number[0]), 1) + 0.0:g}"  # + 0.0: not -0


def _tutorial(name: str) -> RobotSpec:
    """The spec that a tutorial begins with."""
    from blocks import blocks

    page = (ROOT / "docs" / "tutorials" / f"{name}.md").read_text(encoding="utf-8")
    text = next(block.text for block in blocks(page) if block.title == "robot.yaml")
    return read_spec(YamlSource(text, "robot.yaml"))


@cache
def _robot() -> dict[str, Drawing]:
    """The robot of the paper, with its drive in closed loop."""
    spec = load_spec(ROOT / "examples" / "sps_robot.yaml")
    result = size(spec, top=1)
    return report_drawings(result, validate(spec, result.sets[0]))


@cache
def _platform() -> dict[str, Drawing]:
    return report_drawings(size(load_spec(ROOT / "examples" / "sps_platform.yaml"), top=1), None)


@cache
def _vehicle() -> dict[str, Drawing]:
    return report_drawings(size(_tutorial("agv"), top=1, pareto=("mass", "price", "energy")), None)


@cache
def _conveyor() -> dict[str, Drawing]:
    spec = _tutorial("conveyor")
    return report_drawings(size(spec, top=1, sampling=sampling_of(spec)), None)


def _permitted() -> Drawing:
    """Speeds by direction of the paper's drive, on its wheels."""
    spec = load_spec(ROOT / "examples" / "sps_platform.yaml")
    (drive,) = explain(spec, "118752", "406764")
    found = permitted_speeds(spec, drive)
    assert found is not None
    return speed_by_direction(found)


def _at_the_bench() -> Drawing:
    """The figure of ``drivesizer predict --figure`` for the set of its page."""
    maxon, parts = load(["maxon"]), {"motors": "DCX22S01EBKL598", "gearheads": "GPX22HPKLSL44D0CPLW"}
    motor, gearhead = (PartRow("maxon", maxon, name, maxon.table(name).rows[part]) for name, part in parts.items())
    given = Conditions(voltage=nan, ambient=298.15, load=0.4, hold=nan, inertia=0.0, duration=3600.0, warm=nan,
                       resistance=0.0)  # fmt: skip
    drawing = bench_document(predict(motor, gearhead, None, completed(given, motor, gearhead))).pictures["bench"].paper
    assert isinstance(drawing, Drawing)
    return drawing


def _followed() -> Drawing:
    """The simulated path with soft speed loops, and errors along the path."""
    runs = [FollowingRun(model, False, False, exact) for exact in (True, False) for model in ("kinematic", "dynamic")]
    return path_and_errors(drawn_runs({", ".join(run.words): ran(run) for run in runs}))


FIGURES: dict[str, Callable[[], Drawing]] = {
    **{name: lambda name=name: _robot()[name]
       for name in ("cycle", "field", "margins", "efficiency", "demand", "heat", "energy", "battery", "diagram", "bode",
                    "step")},
    "closed_loop": lambda: _robot()["loop"],
    "way": lambda: _platform()["way"],
    "wheels": lambda: _platform()["cycle"],
    "cases": lambda: _vehicle()["field"],
    "front": lambda: _vehicle()["front"],
    "tornado": lambda: _conveyor()["tornado"],
    "at_the_bench": _at_the_bench,
    "followed": _followed,
    "permitted": _permitted,
}  # fmt: skip


def drawn(name: str) -> str:
    """A figure of the pages as SVG."""
    return compact(FIGURES[name]()("typeset").decode())


def write(folder: Path) -> None:
    """Draw all of them."""
    for name in FIGURES:
        (folder / f"{name}.svg").write_text(drawn(name), encoding="utf-8")
