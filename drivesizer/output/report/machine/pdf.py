"""PDF of a machine. typst and matplotlib are imported when it is made."""

from __future__ import annotations

from pathlib import Path

from drivesizer.output.report.machine.content import MachineContent
from drivesizer.output.report.machine.document import document, shown
from drivesizer.output.report.pdf import typeset

__all__ = ["render_machine"]


def render_machine(
    content: MachineContent, path: Path, *, paper: str = "a4", date: str | None = None
) -> dict[Path, bytes]:
    """The file of a PDF report."""
    filled = document(content, date)
    drawings = content.drawings
    wanted = {name: drawings[name] for name in shown(filled["sections"]) if name in drawings}
    return {path: typeset(filled, wanted, paper)}
