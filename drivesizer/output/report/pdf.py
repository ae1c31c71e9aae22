"""PDF: the sections of a report, set by typst."""

from __future__ import annotations

import json
from importlib import resources
from pathlib import Path
from typing import Any

from drivesizer.errors import DrivesizerError, InputError, quoted
from drivesizer.output.document.axes import Reportable, document_of
from drivesizer.output.document.paper import paper_data, pictures_of

_LAST_OWN_LETTER = "\u2fff"  # what the fonts at hand cover ends here; beyond begin the scripts of East Asia and emoji


class ReportError(DrivesizerError):
    """The typesetter refused the report."""


PAPERS = ("a4", "us-letter")
_SOURCE = ("page", "fragments", "blocks", "report")  # files of one source, in order


def report_pdf(content: Reportable, *, paper: str = "a4", date: str | None = None) -> bytes:
    """The report as a PDF file."""
    if paper not in PAPERS:
        raise InputError(f"paper {quoted(paper)} is not known; expected {' or '.join(PAPERS)}")
    filled, pictures = paper_data(document_of(content), date), content.pictures
    drawings = {name: pictures[name].paper for name in pictures_of(filled["sections"]) if name in pictures}
    figures = {name: {"svg": draw("typeset").decode()} for name, draw in drawings.items() if draw}
    data = json.dumps(filled | {"sheet": paper, "figures": figures}, ensure_ascii=False, allow_nan=False)
    return _set(data)


def _set(data: str) -> bytes:
    """The template filled with the document's data, as PDF."""
    import typst

    folder = resources.files("drivesizer.output.report") / "typst"
    source = b"\n".join((folder / f"{name}.typ").read_bytes() for name in _SOURCE)
    try:
        pdf: bytes = typst.compile(source, sys_inputs={"data": data}, font_paths=fonts(data), format="pdf")
    except RuntimeError as error:
        raise ReportError(f"the report could not be set: {str(error).splitlines()[0]}") from error
    return pdf


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
