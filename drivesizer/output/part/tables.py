"""Tables of one part as texts: torque and speed, discharges, pull-out torque, estimates, limits of its family."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from drivesizer.catalog import columns_of
from drivesizer.catalog.discharges import HELD, Discharges
from drivesizer.catalog.estimates import estimates_of
from drivesizer.catalog.estimates.estimate import law_text
from drivesizer.catalog.estimates.family_limits import SAME_FAMILY, family_limits
from drivesizer.catalog.pull_outs import PullOuts
from drivesizer.catalog.query import Hit
from drivesizer.output.part.figures import figure
from drivesizer.units import show

__all__ = [
    "PartTable", "discharges", "estimates", "limits_of_family", "pull_out_conditions", "pull_outs", "torque_and_speed",
]  # fmt: skip

_POINTS = (
    ("no load", "no_load_speed", "", "no_load_current"),
    ("nominal", "nominal_speed", "nominal_torque", "nominal_current"),
    ("stall", "", "stall_torque", "stall_current"),
)


class PartTable(NamedTuple):
    """A table without a format."""

    heads: tuple[tuple[str, str], ...]  # text and side of each column: left or right
    rows: Sequence[tuple[str, ...]]
    title: str = ""
    closing: str = ""  # a line below


def torque_and_speed(hit: Hit) -> PartTable:
    """Three points of the line at nominal voltage, as the maker gives them; of a motor or an actuator."""
    schema = columns_of(hit.section)
    rows = [(name, *(figure(hit[c], schema[c]) if c else "0" for c in columns)) for name, *columns in _POINTS]
    heads = (("", "left"), ("speed", "right"), ("torque", "right"), ("current", "right"))
    return PartTable(heads, rows, "torque and speed")


def discharges(hit: Hit) -> Iterator[PartTable]:
    """The printed discharges of a battery, constant currents and constant powers apart; times down, voltages across."""
    own = hit.catalog.discharges.on(hit.catalog.discharges.battery == hit.row)
    for held, unit in HELD.items():
        some = own.on(~np.isnan(getattr(own, held)))
        if len(some.time):
            yield _discharges(some, held, unit)


def _discharges(own: Discharges, held: str, unit: str) -> PartTable:
    ends = np.unique(own.cutoff_voltage)
    draw, rows = getattr(own, held), []
    for time in np.unique(own.time):
        cells = [draw[(own.time == time) & (own.cutoff_voltage == end)] for end in ends]
        lasts = show(float(time), "min" if float(time) < 3600.0 else "h", "time")
        rows.append((lasts, *(f"{c[0]:g}" if len(c) else "–" for c in cells)))
    heads = (("lasts", "right"), *((show(float(end), "V", "voltage"), "right") for end in ends))
    return PartTable(heads, rows, f"Constant {held} ({unit}), down to")


def pull_outs(hit: Hit) -> Iterator[PartTable]:
    """The printed pull-out curves of a stepper, one after the other."""
    own = hit.catalog.pull_outs.on(hit.catalog.pull_outs.stepper == hit.row)
    for curve in np.unique(own.curve).tolist():
        one = own.on(own.curve == curve)
        rows = [
            (show(speed, "rpm", "rotary_speed", 4), show(torque, "N*m", "torque", 3))
            for speed, torque in zip(one.speed.tolist(), one.torque.tolist(), strict=True)
        ]
        heads = (("speed", "right"), ("pull-out torque", "right"))
        yield PartTable(heads, rows, f"Pull-out torque: {pull_out_conditions(one)}")


def pull_out_conditions(curve: PullOuts) -> str:
    """Supply voltage, current and driver with which a curve was measured."""
    amps = float(curve.current[0])
    with_ = [show(float(curve.voltage[0]), "V", "voltage")]
    with_ += [] if np.isnan(amps) else [f"{show(amps, 'A', 'current')} amplitude"]
    with_ += [str(curve.driver[0])] if curve.driver[0] else []
    return ", ".join(with_)


def estimates(hit: Hit) -> PartTable | None:
    """Figures that a part's data sheet leaves out, as its peers have them; None where there are none."""
    rows = []
    for one in estimates_of(hit.table, hit.row):
        value, low, high = (_shown(hit, one.figure, figure, 2) for figure in (one.value, one.low, one.high))
        rows.append((one.figure.replace("_", " "), value, f"{low} to {high}", law_text(one.fit)))
    heads = (("estimated from peers", "left"), ("", "right"), ("5 to 95 %", "right"), ("from", "left"))
    closing = "Sizing takes these unless the spec has select: {estimates: off}."
    return PartTable(heads, rows, closing=closing) if rows else None


def _all_print(count: int) -> str:
    return "the one other part prints it" if count == 1 else f"{count} parts print it, all alike"


def limits_of_family(hit: Hit) -> PartTable | None:
    """Permitted limits that all others of a part's family have; None where there are none."""
    rows = [
        (one.figure.replace("_", " "), _shown(hit, one.figure, one.value, 3),
         f"{SAME_FAMILY}; {_all_print(one.members)}")
        for one in family_limits(hit.table, hit.row)
    ]  # fmt: skip
    heads = (("limits of the family", "left"), ("", "right"), ("from", "left"))
    return PartTable(heads, rows, closing="Sizing does not use them.") if rows else None


def _shown(hit: Hit, figure: str, value: float, digits: int) -> str:
    column = columns_of(hit.section)[figure]
    return show(value, column.unit, column.kind, digits)
