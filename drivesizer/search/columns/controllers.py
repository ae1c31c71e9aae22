"""A controller for every candidate at once, out of small tables.

Of those with the bus, the voltage and the kind of motor that suffice the smallest, by continuous current; one
of which all of that is known before one of which something is not. Ties go by part number. Where none of them suffices
a motor has none, for others may still exist: unknown. One that is inside an actuator, or that the spec names, is all
that there is: the nearest is then named, so that its check can say by how much it falls short; so is the largest where
the motor takes more voltage than the supply has, which fails with any.
"""

from __future__ import annotations

import fnmatch
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog, Table
from drivesizer.physics.extremes import distinct
from drivesizer.physics.power_stage import STAGE_FIGURES, least_capacitance
from drivesizer.results.check_columns import CheckColumn, at_most, fits
from drivesizer.results.ratings import controller_current, permitted_power
from drivesizer.spec.drive import Choice, ControllerChoice
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

__all__ = [
    "HANGING",
    "ChosenPart",
    "Speeds",
    "Usable",
    "controllers",
    "figure_order",
    "matching",
    "no_better_than",
    "none_suits",
    "offered_buses",
    "offers",
    "room_on_bus",
    "selected",
    "usable_controllers",
]


class ChosenPart(NamedTuple):
    """For each candidate the row of the chosen part (-1: none), and the checks that it brings."""

    row: NDArray[np.int64]
    checks: list[CheckColumn]


class Speeds(NamedTuple):
    """Demands on a controller beside current and voltage, by its figures' names; 0 where it has no part."""

    max_speed_sine: NDArray[np.float64]  # rad/s, speed times pole pairs
    max_encoder_frequency: NDArray[np.float64]  # Hz, of the encoder's lines


def selected(table: Table[Any], choice: Choice) -> NDArray[np.bool_]:
    """Rows that a choice of families and part numbers leaves."""
    keep = ~table.excluded
    for key, names in choice.named.items():
        keep &= np.isin(table[key], [known for name in names for known in matching(name, table, key)])
    return keep


def matching(name: str, table: Table[Any], key: str) -> list[str]:
    """Families or part numbers of a catalogue that a name in the spec means."""
    if key == "part" and (rows := table.called(name)):
        found: list[str] = table["part"][rows].tolist()
        return found
    known = set(table[key].tolist())
    return [name] if name in known else sorted(fnmatch.filter(known, name)) if set(name) & set("*?") else []


def figure_order(table: Table[Any], figure: NDArray[np.float64]) -> NDArray[np.int64]:
    """Rows by a figure, then by part number; unknown figures last."""
    return np.lexsort((table["part"], figure))


class Usable(NamedTuple):
    """Controllers for the spec's supply and bus, by rising current."""

    order: NDArray[np.int64]  # their rows
    allowed: NDArray[np.bool_]  # which of them may drive which motor: (motors, controllers)
    nearest: NDArray[np.int64]  # of each motor that may have no other; -1 where there is none, or others may exist
    largest: NDArray[np.int64]  # of those that each motor may have, by known figures; -1 where there is none
    partial: NDArray[np.bool_]  # which motors may have one that no catalogue lists
    unclear: NDArray[np.bool_]  # of which of all controllers the supply's range is not wholly known; of none it is
    lowest: float  # V, of the supply
    ambient: float  # K, the hottest

    def available(self, motor: NDArray[np.int64], row: NDArray[np.int64]) -> CheckColumn:
        """Whether there is a controller for each motor: unknown where catalogues list none, or its range is unknown."""
        clear = ~self.unclear[row]
        return fits("controller_available", (row >= 0) & clear, (row >= 0) & clear | (row < 0) & ~self.partial[motor])


def usable_controllers(
    spec: RobotSpec, catalog: Catalog, supply: tuple[float, float] | None = None, ambient: float | None = None
) -> Usable:
    """Controllers that fit each motor, whatever its load."""
    (lowest, highest), choice = supply or (spec.supply.lowest, spec.supply.highest), spec.select.controller
    key = "controllers", repr(choice), lowest, highest
    columns: Usable = catalog.once(key, lambda: _allowed(choice, catalog, lowest, highest))
    return columns._replace(ambient=spec.environment.ambient if ambient is None else ambient)


def _allowed(choice: ControllerChoice, catalog: Catalog, lowest: float, highest: float) -> Usable:
    """Controllers for each motor, at an ambient that is not known yet."""
    table, own = catalog.controllers, catalog.motors["controller"]
    box = _box(catalog.motors)
    order = figure_order(table, table["continuous_current"])
    order = order[_usable(choice, table, lowest, highest)[order]]  # few are left: what is made of them stays narrow
    texts, kind = table["drives"][order], catalog.motors["kind"]
    drives = np.array([[_can_drive(t, kind) for t in texts] for kind in ("brushed", "brushless")], bool)
    can = np.vstack([drives, drives.any(0), texts == "stepper"])  # rows: brushed, brushless, kind unknown, stepper
    allowed = can[np.select([kind == "brushed", kind == "brushless", kind == "stepper"], [0, 1, 3], 2)]
    has_own = np.isin(box, distinct(table["inside"][table["inside"] != ""]))
    place = table["inside"][order]
    # one inside is for its motor alone, and such a motor takes no other
    allowed &= np.where(has_own[:, None], place == box[:, None], (place == "") & (own == "")[:, None])
    partial = ~has_own & ((own != "") | (not choice.named))
    unclear = np.append(np.isnan(table["supply_min"] + table["supply_max"]), False)
    nearest = np.where(partial, -1, _last(allowed, order))
    known = ~unclear[order] & ~np.isnan(table["continuous_current"] + table["peak_current"])[order]
    return Usable(order, allowed, nearest, _last(allowed & known, order), partial, unclear, lowest, np.nan)


def _box(motors: Table[Any]) -> NDArray[Any]:
    """The unit that a motor shares with its controller: an actuator, or the motor itself; "" where it has none."""
    return np.where((motors["inside"] == "") & (motors["controller"] != ""), motors["part"], motors["inside"])


def _last(mask: NDArray[np.bool_], order: NDArray[np.int64]) -> NDArray[np.int64]:
    """The last in order that a mask over it allows, -1 where it allows none."""
    if not len(order):
        return np.full(len(mask), -1)
    place = len(order) - 1 - np.argmax(mask[:, ::-1], 1)
    return np.where(mask.any(1), order[place], -1)


def controllers(
    spec: RobotSpec,
    catalog: Catalog,
    motor: NDArray[Any],
    rms_current: NDArray[Any],
    peak_current: NDArray[Any],
    voltage: NDArray[Any] | None = None,
    speeds: Speeds | None = None,
    usable: Usable | None = None,
    barred: NDArray[np.bool_] | None = None,
    known: NDArray[np.bool_] | None = None,
) -> ChosenPart:
    """The controller of each candidate."""
    table = catalog.controllers
    usable = usable or usable_controllers(spec, catalog)
    order, lowest = usable.order, usable.lowest
    lasting = controller_current(table, usable.ambient)
    figure = {name: _beside(table[name], order) for name in ("peak_current", "peak_time")}  # shape (controllers, 1)
    continuous = _beside(lasting, order)
    enough = usable.allowed.T.take(motor, axis=1)  # (controllers, rows): few long rows are quicker than many short ones
    if barred is not None:
        enough &= ~barred
    enough &= ~(continuous < rms_current)
    enough &= ~(figure["peak_current"] < peak_current)
    lacking = np.isnan(continuous).astype(np.int8) + np.isnan(figure["peak_current"])
    lacking = lacking + _beside(usable.unclear, order)
    if voltage is not None:
        feed = spec.feed({name: _beside(table[name], order) for name in STAGE_FIGURES})._replace(voltage=lowest)
        enough &= ~(np.minimum(feed.usable_at_most, lowest) < voltage)
        lacking = lacking + np.isnan(feed.usable)
        if (untimed := np.isnan(figure["peak_time"])).any():
            lacking = lacking + (untimed & (continuous < peak_current))
    if speeds is not None:
        for name, demand in speeds._asdict().items():
            limit = _beside(table[name], order)
            enough &= ~(limit < demand)
            if (unknown := np.isnan(limit)).any():
                lacking = lacking + (unknown & (demand != 0.0))
    if known is not None:
        enough &= ~known | (lacking == 0)
    otherwise = usable.nearest[motor] if barred is None else np.full(len(motor), -1)
    if voltage is not None and barred is None:
        otherwise = np.where(voltage > lowest, usable.largest[motor], otherwise)
    row = _first(order, enough, lacking, otherwise)
    continuous, peak = (np.append(column, np.nan)[row] for column in (lasting, table["peak_current"]))
    return ChosenPart(row, [
        usable.available(motor, row),
        at_most("controller_continuous_current", rms_current, continuous),
        at_most("controller_peak_current", peak_current, peak),
    ])  # fmt: skip


HANGING = (  # checks of a drive that hang on its controller and on its cycle, beside what ``controllers`` looks at
    "supply_voltage", "controller_peak_time", "controller_power", "bus_voltage", "common_bus_voltage", "supply_current",
    "supply_power",
)  # fmt: skip


_RATED = (
    "continuous_current", "peak_time", "max_power", "max_power_voltage", "reduced_power", "reduced_power_voltage",
)  # fmt: skip


def no_better_than(spec: RobotSpec, table: Table[Any], usable: Usable) -> dict[str, NDArray[np.bool_]]:
    """For each of ``HANGING`` which of the usable controllers meets it no better than which other one."""
    of = {name: table[name][usable.order] for name in (*STAGE_FIGURES, *_RATED)}
    stage = spec.feed(of).stage
    kept: tuple[NDArray[Any], ...] = (of["supply_max"], stage.least_loss)
    if spec.supply.capacitance is None and spec.chopper_voltage is None:  # then each has at least its own
        kept = (*kept, of["continuous_current"])
    drawn = -stage.loss, -np.broadcast_to(stage.standby, stage.loss.shape)
    more = {
        "supply_voltage": (spec.feed(of)._replace(voltage=usable.lowest).usable, -stage.loss, -stage.max_duty),
        "controller_peak_time": (of["continuous_current"], of["peak_time"]),
        "controller_power": (permitted_power(of, spec.supply.highest), *drawn),
        "bus_voltage": kept,
        "common_bus_voltage": (of["supply_max"],),
        "supply_current": drawn,
        "supply_power": drawn,
    }
    return {
        name: np.logical_and.reduce([column[:, None] <= column for column in columns]) for name, columns in more.items()
    }


def room_on_bus(spec: RobotSpec, table: Table[Any], usable: Usable) -> NDArray[np.float64]:
    """Energy that each usable controller stores at least; no end of it where the spec says how the bus is held."""
    if spec.supply.capacitance is not None or spec.chopper_voltage is not None:
        return np.full(len(usable.order), np.inf)
    current, most = (table[name][usable.order] for name in ("continuous_current", "supply_max"))
    highest = spec.supply.highest
    room: NDArray[np.float64] = 0.5 * least_capacitance(current, highest) * (most**2 - highest**2)
    return room


def _beside(column: NDArray[Any], order: NDArray[np.int64]) -> NDArray[Any]:
    """A figure of controllers in order, one in each row: for columns of candidates beside it."""
    return column[order][:, None]


def _first(
    order: NDArray[np.int64], mask: NDArray[np.bool_], lacking: NDArray[np.int8], otherwise: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Of those that a mask allows one of which the fewest figures are lacking: of them the first in order."""
    found, fewest = otherwise.copy(), np.full(len(otherwise), 99, np.int8)
    lacks = np.broadcast_to(lacking, mask.shape)
    for place in reversed(range(len(order))):  # one that lacks no more goes before those behind it
        better = mask[place] & (lacks[place] <= fewest)
        np.copyto(found, order[place], where=better)
        np.copyto(fewest, lacks[place], where=better)
    return found


def _usable(choice: ControllerChoice, table: Table[Any], lowest: float, highest: float) -> NDArray[np.bool_]:
    """Controllers that the spec allows, with the bus it names, for its supply voltages.

    As far as these are printed: of one that is sold apart at least the highest.
    """
    keep = selected(table, choice)
    keep &= ~(table["supply_min"] > lowest) & ~(table["supply_max"] < highest)
    keep &= (table["inside"] != "") | ~np.isnan(table["supply_max"])
    bus = choice.bus
    if bus:
        keep &= np.array([any(offers(b, bus) for b in _split(text)) for text in table["buses"]], bool)
    return keep


def none_suits(
    spec: RobotSpec, supply: tuple[float, float], catalog: Catalog, motor: int, currents: tuple[float, float]
) -> str:
    """Reason why no controller is taken: what the catalogues list none for."""
    table, (low, high), (rms, peak) = catalog.controllers, supply, currents
    kind, own = (str(catalog.motors[name][motor]) for name in ("kind", "controller"))
    box = str(_box(catalog.motors)[motor])
    inside = box != "" and bool((table["inside"] == box).any())
    rows = (table["inside"] == (box if inside else "")) & selected(table, spec.select.controller)
    if not rows.any():
        return f"{own} is inside the motor; no figures of it are listed" if own else ""
    bus = spec.select.controller.bus or ""
    volts = show(high, "V", "voltage") if low == high else f"{low:.4g} to {show(high, 'V', 'voltage')}"
    able = {
        f"a {kind} motor": np.array([_can_drive(text, kind) for text in table["drives"]], bool),
        f"the bus {bus}": np.array([not bus or any(offers(b, bus) for b in _split(t)) for t in table["buses"]], bool),
        volts: (table["supply_min"] <= low) & (table["supply_max"] >= high),  # as far as it is printed
        f"{show(rms, 'A', 'current')} RMS": ~(table["continuous_current"] < rms),
        f"{show(peak, 'A', 'current')} at the peak": ~(table["peak_current"] < peak),
    }
    who = "the one inside is not" if inside else "none is listed"
    for what, good in able.items():
        rows &= good
        if not rows.any():
            return f"{who} for {what}"
    return f"{who} that meets all limits" if not inside else ""


def _split(buses: str) -> list[str]:
    return [bus.strip() for bus in str(buses).split(";") if bus.strip()]


def offers(offered: str, bus: str) -> bool:
    """Whether an entry such as ``EtherCAT option card`` is the required bus."""
    return f"{offered.casefold()} ".startswith(f"{bus.casefold()} ")


def offered_buses(table: Table[Any]) -> set[str]:
    """All buses that the controllers of a table list."""
    return {bus for text in table["buses"] for bus in _split(text)}


def _can_drive(drives: str, kind: str) -> bool:
    """Whether a controller may drive a kind of motor; an unknown entry does not rule it out."""
    return drives in ("", "both", kind)
