"""PDF: the sections of a report, set by typst."""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Any

from drivesizer.errors import DrivesizerError, InputError, quoted
from drivesizer.output.report.figures.all_figures import IN_TABLES
from drivesizer.output.report.figures.style import Drawing
from drivesizer.output.report.machine import MachineContent, shown
from drivesizer.output.report.machine import document as machine_document
from drivesizer.output.report.sections import document
from drivesizer.output.report.sections.section import Content

__all__ = ["ReportError", "fonts", "report_pdf"]


_LAST_OWN_LETTER = "\u2fff"  # what the fonts at hand cover ends here; beyond begin the scripts of East Asia and emoji


class ReportError(DrivesizerError):
    """The typesetter refused the report."""


PAPERS = ("a4", "us-letter")
_SOURCE = ("page", "fragments", "blocks", "report")  # files of one source, in order


def render(content: Content, path: Path, *, paper: str = "a4", date: str | None = None) -> dict[Path, bytes]:
    """The file of a PDF report; see :func:`report_pdf`."""
    return {path: report_pdf(content, paper=paper, date=date)}


def report_pdf(content: Content, *, paper: str = "a4", date: str | None = None) -> bytes:
    """The report as a PDF file."""
    _refuse(paper)
    drawings = {name: draw for name, draw in content.drawings.items() if name not in IN_TABLES}
    return typeset(document(content, date), drawings, paper)


def _refuse(paper: str) -> None:
    if paper not in PAPERS:
        raise InputError(f"paper {quoted(paper)} is not known; expected {' or '.join(PAPERS)}")


def typeset(filled: dict[str, Any], drawings: Mapping[str, Drawing], paper: str) -> bytes:
    """A document with its figures as a PDF file."""
    _refuse(paper)
    figures = {name: {"svg": draw("typeset").decode()} for name, draw in drawings.items()}
    return _set(json.dumps(filled | {"sheet": paper, "figures": figures}, ensure_ascii=False, allow_nan=False))


def _set(data: str) -> bytes:
    """The template filled with the document's data, as PDF."""
    import typst

    folder = resources.files("drivesizer.output.report") / "typst"
    source = b"\n".join((folder / f"{name}.typ").read_bytes() for name in _SOURCE)
    try:
        made: bytes = typst.compile(source, sys_inputs={"data": data}, font_paths=fonts(data), format="pdf")
    except RuntimeError as error:
        raise ReportError(f"the report could not be set: {str(error).splitlines()[0]}") from error
    return made


def fonts(text: str = "") -> Any:
    """The fonts that come with the libraries; those of the machine too where a text has letters that ours lack.

    They would make the file depend on the machine.
    """
    import matplotlib
    import typst

    return typst.Fonts(
        include_system_fonts=max(text, default="") > _LAST_OWN_LETTER,
        font_paths=[str(Path(matplotlib.get_data_path()) / "fonts" / "ttf")],
    )


# -- PDF of a machine. typst and matplotlib are imported when it is made.


def render_machine(
    content: MachineContent, path: Path, *, paper: str = "a4", date: str | None = None
) -> dict[Path, bytes]:
    """The file of a PDF report."""
    filled = machine_document(content, date)
    drawings = content.drawings
    wanted = {name: drawings[name] for name in shown(filled["sections"]) if name in drawings}
    return {path: typeset(filled, wanted, paper)}
