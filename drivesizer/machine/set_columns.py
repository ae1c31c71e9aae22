"""A part as columns of one row, for what is written for all candidates."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["OneRow"]


class OneRow:
    """A part's figures as columns of one; without a part every figure is unknown.

    >>> from drivesizer.catalog.parts import NO_GEARHEAD
    >>> OneRow(NO_GEARHEAD)["ratio"], OneRow(None)["inertia"]
    (array([1.]), array([nan]))
    """

    def __init__(self, part: Any) -> None:
        self.part = part

    def __getitem__(self, name: str) -> NDArray[Any]:
        return np.array([np.nan if self.part is None else getattr(self.part, name)])
