"""PDF: the template filled with the document's data and set by typst.

typst and matplotlib are imported when a PDF is made. The same input gives the same bytes: fonts come with the two
libraries, and the file carries no date.
"""

from __future__ import annotations

import json
from importlib import resources
from pathlib import Path
from typing import Any

from drivesizer.control.validation import Validation
from drivesizer.errors import DrivesizerError, InputError, quoted
from drivesizer.output.report.all_figures import IN_TABLES, report_drawings
from drivesizer.output.report.content import document
from drivesizer.output.report.set_behaviour import Behaviour
from drivesizer.results.sizing import SizingResult

__all__ = ["PAPERS", "ReportError", "fonts", "render", "report_pdf"]

_LAST_OWN_LETTER = 0x2FFF  # what the fonts at hand cover ends here; beyond begin the scripts of East Asia and emoji


class ReportError(DrivesizerError):
    """The typesetter refused the report."""


PAPERS = ("a4", "us-letter")
_SOURCE = (
    "page",
    "summary",
    "asked",
    "candidates",
    "tolerances",
    "chosen",
    "machine",
    "loop",
    "closing",
)  # files of one source, in order


def render(
    result: SizingResult, validation: Validation | None, path: Path, *, paper: str = "a4", date: str | None = None
) -> dict[Path, bytes]:
    """The file of a PDF report; see :func:`report_pdf`."""
    return {path: report_pdf(result, validation, paper=paper, date=date)}


def report_pdf(
    result: SizingResult, validation: Validation | None, *, paper: str = "a4", date: str | None = None
) -> bytes:
    """The report as a PDF file.

    Parameters
    ----------
    result
        What the sizing found; without a set, the nearest misses are reported.
    validation
        The closed loop, where it was simulated.
    paper
        Format of the sheets: ``a4`` or ``us-letter``.
    date
        Printed on every page as it is given; without it there is none.

    Raises
    ------
    InputError
        When the format of the sheets is not known.
    ReportError
        When the typesetter refuses.
    """
    if paper not in PAPERS:
        raise InputError(f"paper {quoted(paper)} is not known; expected {' or '.join(PAPERS)}")
    shown = result.shown
    does = Behaviour(result.problem, shown) if shown else None
    content = document(result, validation, does, paper, date)
    drawings = report_drawings(result, validation, does)
    drawn = {name: draw("typeset") for name, draw in drawings.items() if name not in IN_TABLES}
    content["figures"] = {name: {"svg": svg.decode()} for name, svg in drawn.items()}
    return _set(json.dumps(content, ensure_ascii=False, allow_nan=False))


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
        include_system_fonts=any(ord(letter) > _LAST_OWN_LETTER for letter in text),
        font_paths=[str(Path(matplotlib.get_data_path()) / "fonts" / "ttf")],
    )
