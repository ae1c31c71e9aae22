"""A controller for every candidate at once, out of small tables.

Of those with the bus, the voltage and the kind of motor that suffice the smallest, by continuous current; one
of which all of that is known before one of which something is not. Ties go by part number. Where nothing suffices the
nearest is named, so that its check can say by how much it falls short.
"""

from __future__ import annotations

import fnmatch
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog, Table
from drivesizer.physics.extremes import distinct
from drivesizer.physics.power_stage import STAGE_FIGURES
from drivesizer.results.check_columns import CheckColumn, at_most, fits
from drivesizer.results.ratings import controller_current
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.select import Choice, ControllerChoice

__all__ = [
    "Chosen",
    "Speeds",
    "Usable",
    "controllers",
    "in_order",
    "matching",
    "offered_buses",
    "offers",
    "selected",
    "usable_controllers",
]


class Chosen(NamedTuple):
    """For each candidate the row of the chosen part (-1: none), and the checks that it brings."""

    row: NDArray[np.int64]
    checks: list[CheckColumn]


class Speeds(NamedTuple):
    """Demands on a controller beside current and voltage, by its figures' names; 0 where it has no part."""

    max_speed_sine: NDArray[np.float64]  # rad/s, speed times pole pairs
    max_encoder_frequency: NDArray[np.float64]  # Hz, of the encoder's lines


def selected(table: Table[Any], choice: Choice) -> NDArray[np.bool_]:
    """Rows that a choice of families and part numbers leaves.

    Parameters
    ----------
    table
        A section of the catalogue.
    choice
        Families and part numbers, or patterns of them; empty ones allow all.

    Returns
    -------
    array of bool
        Shape (rows,).
    """
    keep = ~table.excluded
    for key, names in choice.named.items():
        keep &= np.isin(table[key], [known for name in names for known in matching(name, table, key)])
    return keep


def matching(name: str, table: Table[Any], key: str) -> list[str]:
    """Families or part numbers of a catalogue that a name in the spec means.

    Parameters
    ----------
    name
        One of them, or a pattern in which ``*`` stands for any text and ``?`` for a character.
    table
        A section of the catalogue.
    key
        ``family`` or ``part``.

    Returns
    -------
    list of str
        Empty where the catalogue has none.
    """
    known = set(table[key].tolist())
    return [name] if name in known else sorted(fnmatch.filter(known, name)) if set(name) & set("*?") else []


def in_order(table: Table[Any], figure: NDArray[np.float64]) -> NDArray[np.int64]:
    """Rows by a figure, then by part number; unknown figures last.

    Parameters
    ----------
    table
        A section of the catalogue.
    figure
        Shape (rows,); NaN unknown.

    Returns
    -------
    array of int
        Row numbers, shape (rows,).
    """
    return np.lexsort((table["part"], figure))


def _last(mask: NDArray[np.bool_], order: NDArray[np.int64]) -> NDArray[np.int64]:
    """The last in order that a mask over it allows, -1 where it allows none."""
    if not len(order):
        return np.full(len(mask), -1)
    place = len(order) - 1 - np.argmax(mask[:, ::-1], 1)
    return np.where(mask.any(1), order[place], -1)


class Usable(NamedTuple):
    """Controllers for the spec's supply and bus, by rising current."""

    order: NDArray[np.int64]  # their rows
    allowed: NDArray[np.bool_]  # which of them may drive which motor: (motors, controllers)
    lowest: float  # V, of the supply
    ambient: float  # K, the hottest


def usable_controllers(
    spec: RobotSpec, catalog: Catalog, supply: tuple[float, float] | None = None, ambient: float | None = None
) -> Usable:
    """Controllers that fit each motor, whatever its load.

    Parameters
    ----------
    spec, catalog
        The requirements, and the parts to choose from.
    supply
        Lowest and highest voltage of the supply in all load cases [V]; the spec's own when not given.
    ambient
        Hottest of all load cases [K]; the spec's own when not given.

    Returns
    -------
    Usable
        Rows by rising current, and which of them each motor may have, shape (motors, controllers).
    """
    (lowest, highest), choice = supply or (spec.supply.lowest, spec.supply.highest), spec.select.controller
    key = "controllers", repr(choice), lowest, highest
    order, allowed = catalog.once(key, lambda: _allowed(choice, catalog, lowest, highest))
    return Usable(order, allowed, lowest, spec.environment.ambient if ambient is None else ambient)


def _allowed(
    choice: ControllerChoice, catalog: Catalog, lowest: float, highest: float
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Rows of controllers by rising current, and which of them each motor may have."""
    table = catalog.controllers
    order = in_order(table, table["continuous_current"])
    order = order[_usable(choice, table, lowest, highest)[order]]  # few are left: what is made of them stays narrow
    texts, kind = table["drives"][order], catalog.motors["kind"]
    drives = np.array([[_can_drive(t, kind) for t in texts] for kind in ("brushed", "brushless")], bool)
    can = np.vstack([drives, drives.any(0), texts == "stepper"])  # rows: brushed, brushless, kind unknown, stepper
    allowed = can[np.select([kind == "brushed", kind == "brushless", kind == "stepper"], [0, 1, 3], 2)]
    return order, allowed & _belongs(catalog, order).T


def controllers(
    spec: RobotSpec,
    catalog: Catalog,
    motor: NDArray[Any],
    rms_current: NDArray[Any],
    peak_current: NDArray[Any],
    voltage: NDArray[Any] | None = None,
    speeds: Speeds | None = None,
    usable: Usable | None = None,
) -> Chosen:
    """The controller of each candidate.

    Parameters
    ----------
    spec, catalog
        The requirements, and the parts to choose from.
    motor
        Row of each candidate's motor.
    rms_current, peak_current
        Motor currents of each candidate [A]; NaN unknown.
    voltage
        Motor voltage of each candidate [V], where the method looks at it.
    speeds
        What each candidate's controller has to keep up with, where the method looks at it.
    usable
        Which there are for each motor, where that is at hand; it knows the supply in all load cases.

    Returns
    -------
    Chosen
        Row of each candidate's controller, shape (rows,), -1 where there is none, and its checks.
    """
    table = catalog.controllers
    order, allowed, lowest, ambient = usable or usable_controllers(spec, catalog)
    lasting = controller_current(table, ambient)
    figure = {name: _beside(table[name], order) for name in ("peak_current", "peak_time")}  # shape (controllers, 1)
    continuous = _beside(lasting, order)
    enough = allowed.T.take(motor, axis=1)  # shape (controllers, rows): few long rows are quicker than many short ones
    enough &= ~(continuous < rms_current)
    enough &= ~(figure["peak_current"] < peak_current)
    lacking = np.isnan(continuous).astype(np.int8) + np.isnan(figure["peak_current"])
    if voltage is not None:
        delivered = spec.feed({name: _beside(table[name], order) for name in STAGE_FIGURES})
        usable_voltage = delivered._replace(voltage=lowest).usable
        enough &= ~(np.fmin(usable_voltage, lowest) < voltage)
        lacking = lacking + np.isnan(usable_voltage)
        if (untimed := np.isnan(figure["peak_time"])).any():
            lacking = lacking + (untimed & (continuous < peak_current))
    if speeds is not None:
        for name, demand in speeds._asdict().items():
            limit = _beside(table[name], order)
            enough &= ~(limit < demand)
            if (unknown := np.isnan(limit)).any():
                lacking = lacking + (unknown & (demand != 0.0))
    row = _first(order, enough, lacking, _last(allowed, order)[motor])
    continuous, peak = (np.append(column, np.nan)[row] for column in (lasting, table["peak_current"]))
    return Chosen(row, [
        fits("controller_available", row >= 0, len(table) > 0),  # unknown with catalogues that list no controllers
        at_most("controller_continuous_current", rms_current, continuous),
        at_most("controller_peak_current", peak_current, peak),
    ])  # fmt: skip


def _belongs(catalog: Catalog, order: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Controllers (rows) that may drive motors (columns): one inside an actuator is for its motor alone."""
    box, whose = catalog.motors["inside"], catalog.controllers["inside"]
    has_own = np.isin(box, distinct(whose[whose != ""]))
    place = whose[order][:, None]
    found: NDArray[np.bool_] = np.where(has_own, place == box, place == "")
    return found


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
    """Controllers that the spec allows, with the bus it names, at its supply voltages."""
    keep = selected(table, choice)
    keep &= (table["supply_min"] <= lowest) & (table["supply_max"] >= highest)
    bus = choice.bus
    if bus:
        keep &= np.array([any(offers(b, bus) for b in _split(text)) for text in table["buses"]], bool)
    return keep


def _split(buses: str) -> list[str]:
    return [bus.strip() for bus in str(buses).split(";") if bus.strip()]


def offers(offered: str, bus: str) -> bool:
    """Whether an entry such as ``EtherCAT option card`` is the required bus.

    Parameters
    ----------
    offered
        Entry of the catalogue.
    bus
        Name of the required bus.

    Returns
    -------
    bool
        Whether the entry begins with the name of the bus, in any case of letters.

    >>> offers("EtherCAT option card", "ethercat")
    True
    """
    return f"{offered.casefold()} ".startswith(f"{bus.casefold()} ")


def offered_buses(table: Table[Any]) -> set[str]:
    """All buses that the controllers of a table list."""
    return {bus for text in table["buses"] for bus in _split(text)}


def _can_drive(drives: str, kind: str) -> bool:
    """Whether a controller may drive a kind of motor; an unknown entry does not rule it out."""
    return drives in ("", "both", kind)
