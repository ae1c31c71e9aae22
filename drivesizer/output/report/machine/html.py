"""HTML of a machine: one page, with the figures of every axis that can be moved."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from drivesizer.output.report.figures.all_figures import STILL, Drawing
from drivesizer.output.report.html.curves import Plot
from drivesizer.output.report.html.page import filled_page, movable
from drivesizer.output.report.html.power_plot import power_plot
from drivesizer.output.report.machine.content import MachineContent
from drivesizer.output.report.machine.document import document, shown

__all__ = ["machine_parts", "render_machine"]


def render_machine(content: MachineContent, path: Path, *, date: str | None = None) -> dict[Path, bytes]:
    """The file of an HTML report."""
    return {path: filled_page(*machine_parts(content, date))}


def machine_parts(
    content: MachineContent, date: str | None = None
) -> tuple[dict[str, Any], dict[str, Plot], dict[str, Drawing]]:
    """The document of a machine's report, its figures that can be moved, and those that cannot, by name."""
    filled = document(content, date)
    wanted, drawings = set(shown(filled["sections"])), content.drawings
    still = [*content.loads, *(f"{one.key}{name}" for one in content.axes for name in STILL)]
    pictures = {name: drawings[name] for name in still if name in wanted and name in drawings}
    power = content.sizing.power
    stacked = power_plot(power) if power else None
    figures = {"power": stacked} if stacked else {}
    figures |= {f"{one.key}{name}": plot for one in content.axes for name, plot in movable(one.content).items()}
    several = {name: re.sub(r"-\d+$", "", name) for name in figures}  # those of one kind are numbered
    return filled, {name: figures[name] for name in figures if several[name] in wanted}, pictures
