"""Power of all axes over time as columns of a table."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drivesizer.results.machine_power import MachinePower

__all__ = ["power_columns"]

_PIECES = 2000  # finer than a screen


def power_columns(power: MachinePower) -> dict[str, tuple[NDArray[np.float64], str, str]]:
    """Mean powers, each from its time to that of the next row; the last row repeats them at the end."""
    course = power.course(_PIECES)
    rows = {f"{name} drawn": values for name, values in zip(power.axes, course.drawn, strict=True)}
    rows |= {f"{name} returned": values for name, values in zip(power.axes, course.returned, strict=True)}
    rows |= {"out of the source": course.total, "left": course.left}
    held = {name: (np.append(values, values[-1:]), "power", "W") for name, values in rows.items()}
    return {"time": (course.time, "time", "s"), **held}
