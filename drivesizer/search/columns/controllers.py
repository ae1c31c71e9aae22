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
from drivesizer.physics.braking import released_power
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
    "Required",
    "Usable",
    "controllers",
    "figure_order",
    "matching",
    "no_better_than",
    "none_suits",
    "offered_buses",
    "offers",
    "parts_share",
    "room_on_bus",
    "selected",
    "usable_controllers",
]


class ChosenPart(NamedTuple):
    """For each candidate the row of the chosen part (-1: none), and the checks that it brings."""

    row: NDArray[np.int64]
    checks: list[CheckColumn]
    better: NDArray[np.bool_]  # whether one of which more is unknown adds less to the objective


class Required(NamedTuple):
    """Demands of candidates on a controller in the worst of all load cases; None is not looked at."""

    rms: NDArray[np.float64]  # A
    peak: NDArray[np.float64]  # A
    voltage: NDArray[np.float64] | None = None  # V, with a cold winding
    max_speed_sine: NDArray[np.float64] | None = None  # rad/s, speed times pole pairs; 0 where it has no part
    max_encoder_frequency: NDArray[np.float64] | None = None  # Hz, of the encoder's lines
    lasting: float = 0.0  # margins that the spec requires: of the RMS current,
    torque: float = 0.0  # of the peak,
    speed: float = 0.0  # of the others


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
    required: Required,
    usable: Usable | None = None,
    barred: NDArray[np.bool_] | None = None,
    known: NDArray[np.bool_] | None = None,
    present: tuple[NDArray[np.int64], NDArray[np.float64]] | None = None,
) -> ChosenPart:
    """The controller of each candidate.

    ``barred``: which are not to be taken, shape (controllers, candidates); ``known``: candidates whose controller must
    have all figures; ``present``: controllers with which candidates pass, -1 of the others, and what margin they leave:
    another one has to be better.
    """
    table, usable = catalog.controllers, usable or usable_controllers(spec, catalog)
    order, lowest, rms = usable.order, usable.lowest, required.rms
    lasting = controller_current(table, usable.ambient)
    # one controller a row, one candidate a column: few long rows are quicker than many short ones
    continuous, peak, peak_time = (x[order][:, None] for x in (lasting, table["peak_current"], table["peak_time"]))
    limits = [
        (rms, required.lasting, continuous, continuous),
        (required.peak, required.torque, peak, peak),
    ]
    for name in ("max_speed_sine", "max_encoder_frequency"):
        if (demand := getattr(required, name)) is not None:
            limits.append((demand, required.speed, *2 * (table[name][order][:, None],)))
    if required.voltage is not None:
        feed = spec.feed({name: table[name][order][:, None] for name in STAGE_FIGURES})._replace(voltage=lowest)
        limits.append((required.voltage, required.speed, np.minimum(feed.usable_at_most, lowest), feed.usable))
    enough = usable.allowed.T.take(motor, axis=1)
    lacking = np.zeros(enough.shape, np.int8) + usable.unclear[order][:, None]
    by_margin = "margin" in spec.select.weights
    margin = np.full(enough.shape if by_margin else (1, 1), np.inf)
    for demand, needed, limit, printed in limits:
        enough &= ~(limit < demand * (1.0 + needed))
        if (unknown := np.isnan(printed)).any():
            lacking += unknown & (demand != 0.0)
        if by_margin:
            with np.errstate(divide="ignore", invalid="ignore"):
                margin = np.fmin(margin, np.where(demand == 0.0, np.inf, limit / demand - 1.0))
    if required.voltage is not None and (untimed := np.isnan(peak_time)).any():
        lacking += untimed & (continuous < required.peak * (1.0 + required.torque))
    if barred is not None:
        enough &= ~barred
    if known is not None:
        enough &= ~known | (lacking == 0)
    worth = _worth(spec, catalog, order, required, margin)
    if present is not None:
        row, left = present
        place = np.zeros(len(table) + 1, np.int64)
        place[order] = np.arange(len(order))
        own = 1.0 / (1.0 + np.maximum(left, -0.999))
        if spec.select.objective != "margin":
            own = np.broadcast_to(worth, enough.shape)[place[row], np.arange(len(row))]
        enough &= (row < 0) | (worth < own - 1e-9 * np.minimum(own, 1.0))  # an unknown price is a huge share
    otherwise = usable.nearest[motor] if barred is None else np.full(len(motor), -1)
    if required.voltage is not None and barred is None:
        otherwise = np.where(required.voltage * (1.0 + required.speed) > lowest, usable.largest[motor], otherwise)
    row, better = _best(order, enough, lacking, worth, otherwise)
    continuous, peak = (np.append(column, np.nan)[row] for column in (lasting, table["peak_current"]))
    return ChosenPart(row, [
        usable.available(motor, row),
        at_most("controller_continuous_current", rms, continuous),
        at_most("controller_peak_current", required.peak, peak),
    ], better)  # fmt: skip


LAST = 1e9  # in place of a figure that is unknown: behind all that are known


def _worth(
    spec: RobotSpec, catalog: Catalog, order: NDArray[np.int64], required: Required, margin: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Share of each controller in the objective of each candidate, less is better: shape (controllers, 1 or more).

    What no objective counts is 0 of all. A margin is the largest that a controller leaves.
    """
    table, found = catalog.controllers, np.zeros((len(order), 1))
    for name, weight in spec.select.weights.items():
        if name == "energy":
            stage = spec.feed({name: table[name][order][:, None] for name in STAGE_FIGURES}).stage
            current = np.maximum(required.rms, 1e-9)
            lost = stage.loss + stage.resistance * current + stage.standby / current
            found = found + weight * np.nan_to_num(lost, nan=LAST) / spec.supply.nominal
        elif name == "margin":
            found = found + weight / (1.0 + np.maximum(margin, -0.999))
        else:
            found = found + weight * parts_share(name, table, catalog)[order][:, None]
    return found


def parts_share(name: str, table: Table[Any], catalog: Catalog) -> NDArray[np.float64]:
    """Figure of parts that an objective sums, in that of a typical motor; unknown ones behind all others, by mass.

    Of what turns with the motor the inertia, where the objective is a figure of the motor's current.
    """
    if name == "energy" and table.section == "brakes":
        return np.asarray(np.nan_to_num(released_power(table), nan=LAST), float)
    column = {"mass": "mass", "price": "price", "length": "added_length"}.get(name, "inertia")
    if column not in table.columns or name == "power" or (name == "length" and table.section != "brakes"):
        return np.zeros(len(table))
    figure, of_motors = table[column], catalog.motors["rotor_inertia" if column == "inertia" else name]
    typical = np.median(known) if len(known := of_motors[~np.isnan(of_motors)]) else 1.0
    found: NDArray[np.float64] = np.where(np.isnan(figure), LAST + np.nan_to_num(table["mass"]), figure / typical)
    return found


def _best(
    order: NDArray[np.int64],
    enough: NDArray[np.bool_],
    lacking: NDArray[np.int8],
    worth: NDArray[np.float64],
    otherwise: NDArray[np.int64],
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Of those that are enough one of which the fewest figures are lacking: of them the best, then the first.

    And whether one of the others is better.
    """
    if not len(order):
        return otherwise, np.zeros(len(otherwise), bool)
    fewest = np.where(enough, lacking, np.int8(99)).min(axis=0)
    if worth.shape[1] == 1:  # the same order for all
        worth = np.unique(worth, return_inverse=True)[1].reshape(-1, 1).astype(np.int16)
        last: Any = np.int16(len(order))
    else:
        last = np.inf
    own = np.where(enough & (lacking == fewest), worth, last)
    place = own.argmin(axis=0)
    better = np.where(enough, worth, last).min(axis=0) < own[place, np.arange(len(place))]
    return np.where(fewest < 99, order[place], otherwise), better


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
