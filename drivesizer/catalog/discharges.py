"""Discharge tables of batteries in memory: at which current or power, to which end voltage, how long.

Every printed figure is one entry of columns that belong to a row of the batteries' table; tables of current leave the
power unknown, and the other way round.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["DISCHARGES", "HELD", "INTEGERS", "NO_DISCHARGES", "TABLE", "Discharges"]

DISCHARGES = "discharges"  # the section of a catalogue file, and the name for all of a battery's in a note
HELD = {"current": "A", "power": "W"}  # what is held while a battery empties
TABLE = ("battery", "source", "held", "cells", "columns", "rows")


class Discharges(NamedTuple):
    """Printed discharges of all batteries: columns, in the order of the file."""

    battery: NDArray[np.int32]  # row of the batteries' table
    source: NDArray[np.int32]  # index into Catalog.sources
    cutoff_voltage: NDArray[np.float64]  # V, at which it ends, of the part
    time: NDArray[np.float64]  # s
    current: NDArray[np.float64]  # A; NaN where power is held
    power: NDArray[np.float64]  # W of the part; NaN where current is held

    def on(self, rows: Any) -> Discharges:
        """Some of the entries."""
        return Discharges(*(column[rows] for column in self))


INTEGERS = ("battery", "source")
NO_DISCHARGES = Discharges(*(np.zeros(0, np.int32 if n in INTEGERS else float) for n in Discharges._fields))
