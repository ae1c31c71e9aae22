"""Pull-out curves of a stepper at the terminal: torque over speed at each supply voltage."""

from __future__ import annotations

from collections.abc import Iterator
from math import isnan

import numpy as np
from rich.table import Table

from drivesizer.catalog.pull_outs import PullOuts
from drivesizer.catalog.query import Hit
from drivesizer.output.terminal.tables import bare
from drivesizer.units import show

__all__ = ["pull_out_tables"]


def pull_out_tables(hit: Hit) -> Iterator[Table]:
    """The printed pull-out curves of a stepper, one after the other."""
    own = hit.catalog.pull_outs.on(hit.catalog.pull_outs.stepper == hit.row)
    for curve in np.unique(own.curve).tolist():
        yield _table(own.on(own.curve == curve))


def _table(own: PullOuts) -> Table:
    amps = float(own.current[0])
    with_ = [show(float(own.voltage[0]), "V", "voltage")]
    with_ += [] if isnan(amps) else [f"{show(amps, 'A', 'current')} amplitude"]
    with_ += [str(own.driver[0])] if own.driver[0] else []
    table = bare(("speed", "right"), ("pull-out torque", "right"), title=f"Pull-out torque: {', '.join(with_)}")
    for speed, torque in zip(own.speed.tolist(), own.torque.tolist(), strict=True):
        table.add_row(show(speed, "rpm", "rotary_speed", 4), show(torque, "N*m", "torque", 3))
    return table
