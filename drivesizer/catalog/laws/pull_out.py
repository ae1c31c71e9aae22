"""Consistency of the printed pull-out curves of steppers with the holding torque and with themselves."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from drivesizer.catalog.laws.discharge import Odd
from drivesizer.catalog.pull_outs import PULL_OUTS, PullOuts
from drivesizer.catalog.tables import Table
from drivesizer.units import show

__all__ = ["odd_pull_outs"]

_RISE = 0.08  # of the torque at a lower speed: charts are read to about 5 %, and have dips where rotors resonate
_READ = 0.05


def odd_pull_outs(given: PullOuts, steppers: Table[Any]) -> Iterator[Odd]:
    """Points above the holding torque, and points above those at lower speeds."""
    for curve in np.unique(given.curve).tolist():
        own = given.on(given.curve == curve)
        row = int(own.stepper[0])
        least = np.minimum.accumulate(own.torque)
        holding = float(steppers["holding_torque"][row])
        yield from _first(own, row, "pull-out and holding torque", "not above the holding torque",
                          np.full(len(own.torque), holding), _READ, ("holding_torque",))  # fmt: skip
        yield from _first(own, row, "pull-out torque and speed", "not above that at a lower speed", least, _RISE)


def _first(
    own: PullOuts, row: int, identity: str, meaning: str, limit: Any, span: float, fields: tuple[str, ...] = ()
) -> Iterator[Odd]:
    """The first point that is above its limit by more than a share of it."""
    above = np.flatnonzero(own.torque > limit * (1.0 + span))
    if not len(above):
        return
    place = above[0]
    at = f"{show(float(own.voltage[place]), 'V', 'voltage')}, {show(float(own.speed[place]), 'rpm', 'rotary_speed')}"
    found, expected = float(own.torque[place]), float(limit[place])
    yield Odd(row, {
        "identity": identity, "meaning": f"{meaning}: {at}", "fields": (PULL_OUTS, *fields), "relation": "<=",
        "found": found, "expected": expected, "kind": "torque", "unit": "N*m",
        "deviation": found / expected - 1.0, "tolerance": span,
    })  # fmt: skip
