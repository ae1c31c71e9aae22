"""Goals of the benchmarks; each result beside its goal, kept for the table of the documentation.

A benchmark prints ``line(NAME, value)``. Where ``BENCH_RESULTS`` names a file, the result is kept there too:
``table.py`` makes the table of ``docs/speed.md`` of them.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import NamedTuple

__all__ = ["GOALS", "Goal", "line", "shown"]


class Goal(NamedTuple):
    """What is measured, and how much of it is enough."""

    what: str
    beside: str  # what it is measured against in the same run; a rate or a time alone says how fast a machine is
    sense: str
    value: float
    unit: str = ""  # of a ratio: none


_CONTROL = "`import control`"
GOALS = {
    "size": Goal("`drivesizer size`, whole process", _CONTROL, "at most", 0.35),
    "help": Goal("`drivesizer --help`", _CONTROL, "at most", 0.15),
    "version": Goal("`drivesizer --version`", _CONTROL, "at most", 0.15),
    "completion": Goal("completion in a shell", _CONTROL, "at most", 0.15),
    "first validate": Goal("first `drivesizer validate` on a new machine", "", "at most", 3.0, "s"),
    "pdf": Goal("report as PDF", _CONTROL, "at most", 2.5),
    "html": Goal("report as HTML", _CONTROL, "at most", 2.2),
    "xlsx": Goal("report as XLSX", _CONTROL, "at most", 2.2),
    "all reports": Goal("PDF, HTML, XLSX and CSV in one run", _CONTROL, "at most", 3.2),
    "search": Goal("drives searched per second and core, every check on", "", "at least", 10.0, "million"),
    "search / loop": Goal("drives per second", "a loop over the drives", "at least", 200.0),
    "long / short": Goal("search over 36 000 noisy samples", "over 3 segments", "at most", 1.2),
    "day": Goal("10 million samples read and sized, carried on from fewer", "", "at most", 20.0, "s"),
    "day's memory": Goal("their largest memory, carried on alike", "", "at most", 1000.0, "MB"),
    "samples": Goal("10 000 samples of 100 drives", "`drivesizer size`", "at most", 1.0),
    "confidence": Goal("`size --confidence` over the whole catalogue", "`drivesizer size`", "at most", 10.0),
    "variants": Goal("variants of a study per second on one core", "", "at least", 250.0),
    "two processes": Goal("study of 2000 variants by two processes", "one process", "at least", 1.8),
    "loop": Goal("saturated closed loop, times as fast", "python-control with LSODA", "at least", 20.0),
    "machine": Goal("six-joint arm over the whole catalogue", "one of its joints", "at most", 8.0),
    "platform": Goal("an hour of a platform's path at 100 Hz", "", "at most", 1.0, "s"),
}


def line(name: str, value: float) -> str:
    """A result beside its goal, as a line; kept where ``BENCH_RESULTS`` says."""
    if kept := os.environ.get("BENCH_RESULTS"):
        with Path(kept).open("a", encoding="utf-8") as file:
            file.write(json.dumps([name, value]) + "\n")
    goal = GOALS[name]
    beside = f" / {goal.beside}" if goal.beside else ""
    return f"{(goal.what + beside).replace('`', ''):66}{shown(value, goal):>14}   goal: {goal.sense} {_goal(goal)}"


def shown(value: float, goal: Goal) -> str:
    """A figure with its unit, in three digits; a ratio with two places."""
    if not goal.unit:
        return f"{value:.2f}" if value < 100 else f"{value:,.0f}"
    return f"{value:.3g} {goal.unit}" if value < 1000 else f"{value:,.0f} {goal.unit}"


def _goal(goal: Goal) -> str:
    return f"{goal.value:g} {goal.unit}".rstrip()
