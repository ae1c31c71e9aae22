"""A set at the bench, at the terminal: figures with bands, group by group, and what they rest on."""

from __future__ import annotations

from itertools import groupby
from math import isinf, isnan

from rich.console import Console
from rich.table import Table
from rich.text import Text

from drivesizer.output.terminal import tables
from drivesizer.output.words import likely
from drivesizer.results.prediction import Conditions, Predicted, Prediction
from drivesizer.units import show

__all__ = ["predicted"]

_DIGITS, _WIDTH = 3, 37
_HEADS = ("nominal", "5 %", "50 %", "95 %")


def predicted(found: Prediction) -> None:
    """Print a prediction."""
    out = tables.console()
    given = found.conditions
    around = [show(given.voltage, "V", "voltage"), show(given.ambient, "degC", "temperature")]
    mounted = [f"{show(given.inertia, 'kg*m^2', 'inertia')} at the output"] if given.inertia else []
    tables.heading(out, found.label, "")
    out.print(Text(", ".join(around + mounted) + "\n"))
    for group, some in groupby(found.figures, key=lambda one: one.group):
        listed = list(some)
        out.print(_group(_TITLES[group].format(**_named(given)), listed))
        missing = dict.fromkeys(name for one in listed for name in one.missing)
        out.print(Text(f"missing: {', '.join(missing)}\n" if missing else "", style="yellow"))
    _estimates(out, found)
    bands = "; ".join(f"{name[0].lower()}{name[1:]} {text}" for name, text, _ in found.tolerances)
    out.print(Text(f"5 to 95 % of {found.samples} samples: {bands}.", style="dim"))
    for text in found.assumptions:
        out.print(Text(text, style="dim"))


_TITLES = {
    "free": "Free running",
    "stall": "Stalled at full voltage",
    "load": "Running against {load}",
    "step": "Step to full voltage, no load",
    "coast": "Coasting, terminals open",
    "hold": "Holding {hold} at rest for {duration}",
    "work": "Running against {load} for {duration}",
}


def _named(given: Conditions) -> dict[str, str]:
    """Conditions as they stand in titles."""
    load, hold = (_torque(x) for x in (given.load, given.hold))
    return {"load": load, "hold": hold, "duration": _time(given.duration)}


def _torque(torque: float) -> str:
    return "an unknown torque" if isnan(torque) else show(torque, "N*m", "torque", _DIGITS)


def _time(seconds: float) -> str:
    """A time in the unit that suits its size."""
    if isinf(seconds):
        return "never"
    unit = "ms" if seconds < 1.0 else "s" if seconds < 600.0 else "min" if seconds < 36_000.0 else "h"
    return show(seconds, unit, "time", _DIGITS)


def _group(title: str, some: list[Predicted]) -> Table:
    """Figures of one group; what is missing in place of a figure that is unknown."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold")
    table.add_column(title, min_width=_WIDTH, max_width=_WIDTH)
    for name in _HEADS if some[0].group == "free" else [""] * len(_HEADS):
        table.add_column(name, justify="right", min_width=8)
    for one in some:
        if isnan(one.band.nominal):
            table.add_row(one.title, Text("unknown", style="yellow"))
            continue
        shown = [_time(x) if one.kind == "time" else show(x, one.unit, one.kind, _DIGITS) for x in one.band]
        table.add_row(one.title + (f"; never {likely(one.never)}" if 0.0 < one.never < 1.0 else ""), *shown)
    return table


def _estimates(out: Console, found: Prediction) -> None:
    """Figures that no data sheet gives, with their bands and laws."""
    if not found.estimates:
        return
    table = tables.bare(("not on the data sheet", "left"), ("5 to 95 %", "left"), ("from", "left"))
    for one in found.estimates:
        table.add_row(one.title, one.text, one.law)
    out.print(table)
