"""A motor with its gearhead at the bench: figures with bands, group by group, and what they rest on."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby
from math import isinf, isnan

from drivesizer.output.document import records as doc
from drivesizer.output.words import likely
from drivesizer.results.prediction import HOTTEST, Predicted, Prediction
from drivesizer.units import show

_DIGITS = 3
_TITLES = {
    "free": "Free running",
    "stall": "Stalled at full voltage",
    "load": "Running against {load}",
    "step": "Step to full voltage, no load",
    "coast": "Coasting, terminals open",
    "hold": "Holding {hold} at rest for {duration}",
    "work": "Running against {load} for {duration}",
}


def prediction_blocks(found: Prediction) -> Iterator[doc.Block]:
    """A prediction as tables and sentences."""
    given = found.conditions
    load, hold = (
        "an unknown torque" if isnan(x) else show(x, "N*m", "torque", _DIGITS) for x in (given.load, given.hold)
    )
    words = {"load": load, "hold": hold, "duration": _time(given.duration).text}
    around = [show(given.voltage, "V", "voltage"), show(given.ambient, "degC", "temperature")]
    around += [f"{show(given.inertia, 'kg*m^2', 'inertia')} at the output"] if given.inertia else []
    yield doc.Words(", ".join(around))
    for group, some in groupby(found.figures, key=lambda one: one.group):
        listed = list(some)
        yield doc.table("predicted", _TITLES[group].format(**words), map(_row, listed), record=group)
        missing = dict.fromkeys(name for one in listed for name in one.missing)
        if missing:
            yield doc.Words(f"missing: {', '.join(missing)}", "note")
    if found.estimates:
        yield doc.table("not_printed", "", [doc.row("not_printed", one, name="") for one in found.estimates])
    bands = "; ".join(f"{name[0].lower()}{name[1:]} {text}" for name, text, _ in found.tolerances)
    yield doc.Bullets((doc.Note(f"5 to 95 % of {found.samples} samples: {bands}."),), list(found.assumptions))


def _row(one: Predicted) -> doc.Row:
    """A figure with its band; what is unknown has none."""
    never = f"; never {likely(one.never)}" if 0.0 < one.never < 1.0 else ""
    over = f"; over its limit with {likely(one.over)}" if one.over > 0.0 else ""
    cells: dict[str, doc.Cell] = {"title": one.title + never + over}
    ends = {} if isnan(one.band.nominal) else {"p5": one.band.p5, "p95": one.band.p95}
    for key, x in {"value": one.band.nominal, **ends}.items():
        beyond = f"over {show(HOTTEST, 'degC', 'temperature', _DIGITS)}" if one.unit == "degC" and x >= HOTTEST else ""
        quantity = doc.Quantity(x, one.unit, one.kind, _DIGITS, own=beyond)
        cells[key] = _time(x) if one.kind == "time" else quantity
    return doc.Row(cells, name=one.name)


def _time(seconds: float) -> doc.Quantity:
    """A time in the unit that suits its size."""
    unit = "ms" if seconds < 1.0 else "s" if seconds < 600.0 else "min" if seconds < 36_000.0 else "h"
    return doc.Quantity(seconds, unit, "time", _DIGITS, own="never" if isinf(seconds) else "")
