"""PDF: the template filled with the document's data and set by typst.

typst and matplotlib are imported when a PDF is made. The same input gives the same bytes: fonts come with the two
libraries, and the file carries no date.
"""

from __future__ import annotations

import json
from importlib import resources
from pathlib import Path

from drivesizer.errors import DrivesizerError
from drivesizer.report.document import document
from drivesizer.report.drawings import IN_TABLES, report_drawings
from drivesizer.results import SizingResult, Validation

__all__ = ["ReportError", "render", "report_pdf"]

_LAST_OWN_LETTER = 0x2FFF  # what the fonts at hand cover ends here; beyond begin the scripts of East Asia and emoji


class ReportError(DrivesizerError):
    """The typesetter refused the report."""


def render(result: SizingResult, validation: Validation | None, path: Path) -> dict[Path, bytes]:
    """The file of a PDF report."""
    return {path: report_pdf(result, validation)}


def report_pdf(result: SizingResult, validation: Validation | None) -> bytes:
    """The report as a PDF file.

    Parameters
    ----------
    result
        What the sizing found; without a set, the nearest misses are reported.
    validation
        The closed loop, where it was simulated.

    Raises
    ------
    ReportError
        When the typesetter refuses.
    """
    import matplotlib
    import typst

    content = document(result, validation)
    drawings = report_drawings(result, validation)
    drawn = {name: draw("typeset") for name, draw in drawings.items() if name not in IN_TABLES}
    content["figures"] = {name: {"svg": svg.decode()} for name, svg in drawn.items()}
    data = json.dumps(content, ensure_ascii=False, allow_nan=False)
    # Fonts of the machine only where ours lack letters: they would make the file depend on the machine.
    fonts = typst.Fonts(
        include_system_fonts=any(ord(letter) > _LAST_OWN_LETTER for letter in data),
        font_paths=[str(Path(matplotlib.get_data_path()) / "fonts" / "ttf")],
    )
    try:
        made: bytes = typst.compile(
            resources.files("drivesizer.report").joinpath("template.typ").read_bytes(),
            sys_inputs={"data": data},
            font_paths=fonts,
            format="pdf",
        )
    except RuntimeError as error:
        raise ReportError(f"the report could not be set: {str(error).splitlines()[0]}") from error
    return made
