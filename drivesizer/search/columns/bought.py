"""Figures of the parts that are bought with each candidate: motor or actuator, gearhead, brake, encoder, controller.

What is inside an actuator has the figure 0 by itself. Of an encoder or controller that no catalogue lists the mass is
assumed where estimates count, and unknown otherwise, as its price is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import nan

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.estimates.assumed import assumed_mass
from drivesizer.search.columns.candidates import Candidates

__all__ = ["BRAKE_FIGURES", "CONTROLLING", "bought", "chosen"]

Array = NDArray[np.float64]
BRAKE_FIGURES = {"length": "added_length"}  # that objectives sum under another name
CONTROLLING = ("encoder", "controller")
_UNLISTED, _NEEDLESS = -1, -2  # in place of the row of a part
_TABLES = {"motor": "motors", "gearhead": "gearheads", "brake": "brakes", "encoder": "encoders",
           "controller": "controllers"}  # fmt: skip


def chosen(
    encoder: NDArray[np.int64], controller: NDArray[np.int64], brake: NDArray[np.int64], *, needs_encoder: bool
) -> dict[str, Array]:
    """The parts that go with candidates, among the figures that objectives count."""
    unlisted = _UNLISTED if needs_encoder else _NEEDLESS
    return {
        "encoder": np.where(encoder < 0, unlisted, encoder).astype(float),
        "controller": controller.astype(float),
        "brake": np.where(brake < 0, _NEEDLESS, brake).astype(float),
    }


def bought(
    catalog: Catalog,
    sets: Candidates,
    parts: Mapping[str, Array],
    figure: str,
    over: Sequence[str],
    end: int | None = None,
) -> Array:
    """A figure of the parts of each candidate."""
    found = np.zeros((len(over), len(sets.motor)))
    for row, role in zip(found, over, strict=True):
        table = catalog.table(_TABLES[role])
        if role in parts:
            assumed = end is not None and figure == "mass" and role in CONTROLLING
            unlisted = assumed_mass(_TABLES[role])[end or 0] if assumed else nan
            column = table[BRAKE_FIGURES.get(figure, figure) if role == "brake" else figure]
            row[:] = np.concatenate([column, [0.0, unlisted]])[parts[role].astype(np.int64)]
        else:
            row[:] = table[figure][getattr(sets, role)]
    return found
