"""Pages of a PDF, and whether all of them keep their margins."""

from __future__ import annotations

import numpy as np
import pytest
from printed import DOTS

SHEETS = {"a4": (210.0, 297.0), "us-letter": (215.9, 279.4)}  # mm

_CLEAR = 17.0  # mm at the left and the right of every page

_NARROW = 5.0  # mm above and below


def assert_within_margins(pages: list[np.ndarray], paper: str) -> None:
    """Nothing is printed beyond the text at either side, nor at the very top or bottom."""
    side, ends = (round(room / 25.4 * DOTS) for room in (_CLEAR, _NARROW))
    for number, page in enumerate(pages, 1):
        assert page.shape[1] == pytest.approx(SHEETS[paper][0] / 25.4 * DOTS, abs=1.5)
        blank = (page[:, :side], page[:, -side:], page[:ends], page[-ends:])
        assert all(part.min() > 0.98 for part in blank), f"page {number}"
        assert page[:, side:-side].min() < 0.8, f"page {number} is empty"  # small print is grey
