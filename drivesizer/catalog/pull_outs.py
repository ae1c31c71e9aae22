"""Printed pull-out torque of steppers over speed, in memory: each curve at a supply voltage, with a driver.

Every printed point is one entry of columns that belong to a row of the steppers' table.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["NO_PULL_OUTS", "PULL_OUTS", "PullOuts", "point_columns"]

PULL_OUTS = "pull_outs"  # the section of a catalogue file, and the name for all of a stepper's in a note


class PullOuts(NamedTuple):
    """Printed points of all curves: columns, in the order of the file."""

    stepper: NDArray[np.int32]  # row of the steppers' table
    source: NDArray[np.int32]  # index into Catalog.sources
    curve: NDArray[np.int32]  # number of the curve
    voltage: NDArray[np.float64]  # V, of the driver's supply
    current: NDArray[np.float64]  # A, amplitude of a phase's current that the driver was set to; NaN unknown
    speed: NDArray[np.float64]  # rad/s, rising along a curve
    torque: NDArray[np.float64]  # N*m
    driver: NDArray[np.str_]  # as printed; empty where it is not

    def on(self, rows: Any) -> PullOuts:
        """Some of the entries."""
        return PullOuts(*(column[rows] for column in self))


_TYPES = {"stepper": np.int32, "source": np.int32, "curve": np.int32, "driver": np.str_}
NO_PULL_OUTS = PullOuts(*(np.zeros(0, _TYPES.get(name, np.float64)) for name in PullOuts._fields))


def point_columns(points: Sequence[tuple[Any, ...]]) -> PullOuts:
    """Columns of points, each with the fields of ``PullOuts`` in their order."""
    columns = zip(PullOuts._fields, zip(*points, strict=True), strict=True)
    return PullOuts(*(np.array(values, _TYPES.get(name, np.float64)) for name, values in columns))
