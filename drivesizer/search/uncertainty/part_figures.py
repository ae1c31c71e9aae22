"""Figures of one part over samples: a column where it is sampled, else a single one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.tables import Table

__all__ = ["WHOLE", "PartFigures"]

Array = NDArray[np.float64]
WHOLE = ("ratio", "inertia", "no_load_current", "friction_torque", "viscous_friction")  # never as a single figure


class PartFigures:
    """The figures of a part over samples: a column where it is sampled, else a single one."""

    def __init__(self, table: Table[Any], row: int, count: int, changed: Mapping[str, NDArray[Any]]) -> None:
        self.table, self.row, self.count = table, row, count
        self.taken: dict[str, NDArray[Any]] = dict(changed)

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self.taken:
            self.taken[name] = self.nominal(name, self.count if name in WHOLE else 1)
        return self.taken[name]

    def nominal(self, name: str, count: int = 1) -> NDArray[Any]:
        """Figure as the catalogue prints it."""
        column: NDArray[Any] = self.table[name]
        if self.row < 0:
            return np.full(count, np.nan if column.dtype.kind == "f" else "")
        return np.full(count, column[self.row])
