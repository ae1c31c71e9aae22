"""Heat of a motor or actuator as tables: continuous current by ambient temperature, and overload times."""

from __future__ import annotations

from math import isnan
from typing import NamedTuple

from drivesizer.catalog.query import Hit
from drivesizer.machine.part_curves import HEAT, overload_times, permitted_current
from drivesizer.output.part.tables import PartTable
from drivesizer.physics.thermal import DATA_TEMPERATURE
from drivesizer.units import show

__all__ = ["Heat", "heat"]

_AMBIENTS = (DATA_TEMPERATURE, 313.15, 333.15, 353.15, 373.15)  # K
_OVERLOADS = (1.5, 2.0, 3.0, 5.0)  # times the continuous current
_SLOW = ("winding_time_constant", "motor_time_constant")


class Heat(NamedTuple):
    """Tables of a part's heat, and what is missing for more."""

    tables: list[PartTable]
    notes: list[str]  # on the overload times
    missing: str  # what is unknown, and for want of which figures; empty where all is known


def heat(hit: Hit) -> Heat:
    """Continuous current over ambient temperature and overload times at 25 degC, or what is missing for them."""
    ambients, overloads = _ambients(hit), _overloads(hit)
    found = [table for table in (ambients, overloads) if table]
    needed = [*(() if found else HEAT[:1]), *(() if overloads else (*HEAT[1:], *_SLOW))]
    missing = ", ".join(name.replace("_", " ") for name in needed if isnan(hit[name]))
    what = f"{'overload' if found else 'heat'}: unknown without {missing}" if missing else ""
    return Heat(found, _bounds(hit) if overloads else [], what)


def _ambients(hit: Hit) -> PartTable | None:
    """Continuous current; None where it is known at 25 degC only, which is among the figures."""
    currents = [permitted_current(hit, ambient) for ambient in _AMBIENTS]
    if all(map(isnan, currents[1:])):
        return None
    heads = (("", "left"), *((show(ambient, "degC", "temperature"), "right") for ambient in _AMBIENTS))
    all_permitted = _AMBIENTS[-1] <= hit["ambient_max"] or isnan(hit["ambient_max"])
    title = f"continuous current by ambient{'' if all_permitted else ' (– not permitted)'}"
    name = "at standstill" if isnan(hit["nominal_current"]) else "nominal"
    return PartTable(heads, [(name, *map(_amperes, currents))], title)


def _overloads(hit: Hit) -> PartTable | None:
    """Overload times at a few currents; None where unknown."""
    currents = [permitted_current(hit, DATA_TEMPERATURE) * times for times in _OVERLOADS]
    times = [overload_times(hit, current) for current in currents]
    if isnan(currents[0] + times[0][0]):
        return None
    heads = (("", "left"), *((f"{times:g} ×", "right") for times in _OVERLOADS))
    rows = [("current", *map(_amperes, currents))]
    for name, row in zip(("from cold", "from warm"), zip(*times, strict=True), strict=True):
        if not isnan(row[0]):
            rows.append((name, *map(_duration, row)))
    limit = show(hit["max_winding_temperature"], "degC", "temperature")
    return PartTable(heads, rows, f"overload at standstill, 25 °C, to {limit}")


def _bounds(hit: Hit) -> list[str]:
    """Notes on overload times: the warm start, and limits other than heat."""
    most, current = (
        _OVERLOADS[-1] * permitted_current(hit, DATA_TEMPERATURE),
        hit["nominal_voltage"] / hit["resistance"],
    )
    peak = hit["peak_torque"] / hit["torque_constant"]
    notes = ["warm: winding and housing at the housing's temperature at the nominal point"]
    if current < most:
        notes.append(f"more than {_amperes(current)} does not flow at nominal voltage")
    if peak < most:
        notes.append(f"more than {_amperes(peak)} exceeds the permitted peak torque")
    return notes


def _amperes(current: float) -> str:
    return "–" if isnan(current) else show(current, "A", "current", 3)


def _duration(time: float) -> str:
    """A time in its customary unit."""
    unit = "h" if time > 7200.0 else "min" if time > 120.0 else "s"
    return show(time, unit, "time", 3)
