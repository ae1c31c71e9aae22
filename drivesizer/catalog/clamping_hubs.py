"""Gearheads with a clamping hub: they take any motor whose shaft the hub holds, of whatever maker."""

from __future__ import annotations

from typing import Any

import numpy as np

from drivesizer.catalog.tables import Catalog, unique_pairs

__all__ = ["HUB", "on_any_shaft"]

HUB = "clamping hub"  # the mounting of such a gearhead
_THINNEST = 0.5  # of the hub's bore: a bushing fills the rest


def on_any_shaft(catalog: Catalog) -> Catalog:
    """The catalogue with a pair for each motor whose shaft goes into a gearhead's clamping hub.

    A bushing makes up for a thinner shaft, an adapter plate joins the flanges; the pair's source is the gearhead's.
    A motor of which the shaft is unknown is not paired.
    """
    motors, gearheads = catalog.motors, catalog.gearheads
    hubs = np.flatnonzero(gearheads["mounting"] == HUB)
    free = np.flatnonzero((motors["inside"] == "") & ~np.isnan(motors["shaft_diameter"]))
    bore, shaft = gearheads["max_motor_shaft"][hubs], motors["shaft_diameter"][free, None]
    fits = np.nonzero((shaft <= bore) & (shaft >= _THINNEST * bore))
    if not len(fits[0]):
        return catalog
    left, right = free[fits[0]], hubs[fits[1]]
    sides: tuple[Any, ...] = (left, right, gearheads.source[right])
    both = (np.concatenate([a, b]) for a, b in zip(catalog.motor_gearhead, sides, strict=True))
    return catalog.with_tables({}, {"motor_gearhead": unique_pairs(*both)})
