"""Reports for people, as tests read them: the text of a PDF, its pages as pictures, reports whose figures are blank."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np
import pytest
import typst
from matplotlib.image import imread
from pdf_text import texts_of

from drivesizer.output.document.axes import content_of
from drivesizer.output.report import pdf
from drivesizer.output.report.figures import all_figures

DOTS = 40  # per inch, of a page as a picture
_BLANK = b'<svg xmlns="http://www.w3.org/2000/svg" width="468pt" height="72pt" viewBox="0 0 468 72"></svg>'


class Printed(NamedTuple):
    """A report as its file and as its pages in grey, where 1 is white."""

    content: bytes
    pictures: list[np.ndarray]


def text_of(content: bytes, most: int | None = None) -> str:
    """The text of a PDF or of its first pages, runs of white space as one blank."""
    return re.sub(r"\s+", " ", " ".join(texts_of(content, most))).replace("\u200b", "")


def printed(*given: Any, **more: Any) -> Printed:
    """A report whose figures are drawn once for both its file and its pictures."""
    seen: list[Any] = []
    compile_it = typst.compile

    def both(source: bytes, **how: Any) -> bytes:
        seen.append(compile_it(source, **(how | {"format": "png", "ppi": DOTS})))
        made: bytes = compile_it(source, **how)
        return made

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(typst, "compile", both)
        content = pdf.report_pdf(content_of(*given), **more)
    (pages,) = seen
    pages = pages if isinstance(pages, list) else [pages]
    return Printed(content, [imread(io.BytesIO(page))[..., :3].min(axis=2) for page in pages])


@contextmanager
def blank_figures() -> Iterator[None]:
    """Reports whose figures are blank, where a test reads words and tables: the figures take longest."""
    with pytest.MonkeyPatch.context() as patch:
        pictures = all_figures.report_pictures

        def blank(*given: Any) -> dict[str, Any]:
            return {
                name: one._replace(paper=lambda form: _BLANK) for name, one in pictures(*given).items() if one.paper
            }

        patch.setattr(all_figures, "report_pictures", blank)
        yield
