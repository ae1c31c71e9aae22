"""HTML of a machine: one page, with the figures of every axis that can be moved."""

from __future__ import annotations

import re
from pathlib import Path

from drivesizer.output.report.html.page import STILL, filled_page, movable
from drivesizer.output.report.html.power_plot import power_plot
from drivesizer.output.report.machine.content import MachineContent
from drivesizer.output.report.machine.document import document, shown

__all__ = ["render_machine"]


def render_machine(content: MachineContent, path: Path, *, date: str | None = None) -> dict[Path, bytes]:
    """The file of an HTML report.

    Parameters
    ----------
    content
        What the report is about.
    path
        Where to.
    date
        Printed as it is given; without it there is none.

    Returns
    -------
    dict[Path, bytes]
    """
    filled = document(content, date)
    wanted, drawings = set(shown(filled["sections"])), content.drawings
    still = [*content.loads, *(f"{one.key}{name}" for one in content.axes for name in STILL)]
    pictures = {name: drawings[name] for name in still if name in wanted and name in drawings}
    power = content.sizing.power
    stacked = power_plot(power) if power else None
    figures = {"power": stacked} if stacked else {}
    figures |= {f"{one.key}{name}": plot for one in content.axes for name, plot in movable(one.content).items()}
    several = {name: re.sub(r"-\d+$", "", name) for name in figures}  # those of one kind are numbered
    return {path: filled_page(filled, {name: figures[name] for name in figures if several[name] in wanted}, pictures)}
