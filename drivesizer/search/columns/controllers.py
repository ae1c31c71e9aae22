"""A controller for every candidate at once, out of small tables.

Of those with the bus, the voltage and the kind of motor the one of which no check fails, then the fewest are unknown,
then the best by the objective, then the smallest by continuous current and part number. Where each of them fails
a motor has none, for others may still exist: unknown. One that is inside an actuator, or that the spec names, is all
that there is: the nearest is then named, so that its check can say by how much it falls short; so is the largest where
the motor takes more voltage than the supply has, which fails with any.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog, Table
from drivesizer.catalog.view.search_view import ASSUMED, amplifier_of
from drivesizer.physics.braking import released_power
from drivesizer.physics.extremes import distinct
from drivesizer.physics.power_stage import STAGE_FIGURES
from drivesizer.results.check_columns import CheckColumn, fits
from drivesizer.results.ratings import controller_current
from drivesizer.spec.drive import ASSUMABLE, ControllerChoice
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

LAST = 1e9  # in place of a figure that is unknown: behind all that are known
LOST = np.int8(99)  # in place of the number of unknown checks: one fails, or it may not drive the motor
# checks of a drive that hang on its controller and on its cycle
HANGING = (
    "supply_voltage", "controller_peak_time", "controller_power", "bus_voltage", "common_bus_voltage", "supply_current",
    "supply_power",
)  # fmt: skip


class Ranks(NamedTuple):
    """Ranks of the usable controllers for candidates: columns of shape (controllers, candidates)."""

    lacking: NDArray[np.int8]  # how many of their checks are unknown; ``LOST`` where one fails
    hanging: NDArray[np.int8]  # of those that hang on the cycle too, as far as that is known
    share: NDArray[np.float64]  # of the objective, without the margin's: (controllers, 1 or candidates)
    margin: NDArray[np.float64]  # the smallest of theirs
    unprinted: NDArray[np.int8]  # figures that checks assume: of equals one goes before that has them
    weight: float  # of the margin in the objective

    def on(self, rows: NDArray[np.int64]) -> Ranks:
        """Of some of the candidates."""
        taken: dict[str, Any] = {n: getattr(self, n) for n in ("lacking", "hanging", "share", "margin", "unprinted")}
        return self._replace(**{name: x[:, rows] for name, x in taken.items() if x.shape[1] > 1})

    def at(self, figure: NDArray[Any], place: NDArray[np.int64]) -> NDArray[Any]:
        """A figure of one controller of each candidate."""
        found: NDArray[Any] = figure[place, 0 if figure.shape[1] == 1 else np.arange(len(place))]
        return found

    def before(self, reached: NDArray[np.float64], most: NDArray[np.float64] | float) -> NDArray[np.bool_]:
        """Which controllers may go before what was reached: in the columns of :meth:`best`, infinite where it fails."""
        unknown, place = np.minimum(self.lacking + self.hanging, LOST), np.arange(len(self.lacking))[:, None]
        less = place < reached[3]
        for figure, limit in ((self.unprinted, reached[2]), (self.worth(most), reached[1]), (unknown, reached[0])):
            less = (figure < limit) | ((figure == limit) & less)
        return np.asarray(less & (unknown < LOST), bool)

    def worth(self, most: NDArray[np.float64] | float) -> NDArray[np.float64]:
        """Share of each controller in the objective, with the margin's; ``most``: margin of all other checks."""
        worth = self.share
        if self.weight:
            worth = worth + self.weight / (1.0 + np.maximum(np.minimum(self.margin, most), -0.999))
        return np.round(worth, 9)

    def best(
        self, most: NDArray[np.float64] | float = np.inf, barred: NDArray[np.bool_] | None = None
    ) -> NDArray[np.float64]:
        """Of each candidate number of unknown checks, worth, unprinted figures and place of its best controller.

        The less of the first the better, then of the second: the share of the objective, in digits without rounding.
        ``most``: margin of all other checks.
        """
        unknown = np.minimum(self.lacking + self.hanging, LOST)
        if barred is not None:
            unknown[barred] = LOST
        rank: Any = self.worth(most)
        worth, fewest, last = rank, unknown.min(axis=0), float("inf")
        if worth.shape[1] == 1:  # the same order for all
            rank = np.unique(worth, return_inverse=True)[1].reshape(-1, 1).astype(np.int16)
            last = len(worth)
        own = np.where(unknown == fewest, rank, last)
        place = np.where(own == own.min(axis=0), self.unprinted, LOST).argmin(axis=0)
        return np.array([fewest, self.at(worth, place), self.at(self.unprinted, place), place], float)


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
    assumed, amplifiers = table["family"][order] == ASSUMED, amplifier_of(catalog.motors["part"])[:, None]
    apart = (place == "") & (own == "")[:, None] & (~assumed | (table["part"][order] == amplifiers))
    allowed &= np.where(has_own[:, None], place == box[:, None], apart)
    partial = ~has_own & ((own != "") | (not choice.named))
    unclear = np.append(np.isnan(table["supply_min"] + table["supply_max"]), False)
    last = _last(allowed, order)
    known = ~unclear[order] & ~np.isnan(table["continuous_current"] + table["peak_current"])[order]
    largest = np.where(has_own, last, _last(allowed & known, order))  # one inside is what it is
    return Usable(order, allowed, np.where(partial, -1, last), largest, partial, unclear, lowest, np.nan)


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
) -> tuple[NDArray[np.int64], Ranks]:
    """The controller of each candidate, as far as that is known before the limits that hang on the cycle are.

    -1 where there is none; and the ranks of all.
    """
    table, usable = catalog.controllers, usable or usable_controllers(spec, catalog)
    order, lowest, rms = usable.order, usable.lowest, required.rms
    lasting = controller_current(table, usable.ambient)
    # one controller a row, one candidate a column: few long rows are quicker than many short ones
    continuous, peak, peak_time = (x[order][:, None] for x in (lasting, table["peak_current"], table["peak_time"]))
    limits = [(rms, required.lasting, continuous), (required.peak, required.torque, peak)]
    for name in ("max_speed_sine", "max_encoder_frequency"):
        if (demand := getattr(required, name)) is not None:
            limits.append((demand, required.speed, table[name][order][:, None]))
    lacking = np.where(usable.allowed.T.take(motor, axis=1), np.int8(0), LOST)
    lacking += (usable.unclear[order][:, None] & (lacking < LOST)).astype(np.int8)
    hanging, unprinted = np.zeros((1, 1), np.int8), np.zeros((len(order), 1), np.int8)
    weights = spec.select.weights
    margin = np.full(lacking.shape if "margin" in weights else (1, 1), np.inf)
    for demand, needed, limit in limits:
        lacking[limit < demand * (1.0 + needed)] = LOST
        if (unknown := np.isnan(limit)).any():
            lacking += unknown & (demand != 0.0) & (lacking < LOST)
        if "margin" in weights:
            with np.errstate(divide="ignore", invalid="ignore"):
                margin = np.fmin(margin, np.where(demand == 0.0, np.inf, limit / demand - 1.0))
    otherwise = usable.nearest[motor]
    if required.voltage is not None:
        feed = spec.feed({name: table[name][order][:, None] for name in STAGE_FIGURES})._replace(voltage=lowest)
        volts = required.voltage * (1.0 + required.speed)
        given = feed.usable_range
        lacking[np.minimum(given.high, lowest) < volts] = LOST
        hanging = (~((volts <= given.low) | (volts > given.high)) & (volts != 0.0)).astype(np.int8)
        if not any("controller_peak_time" in ASSUMABLE[name] for name in spec.select.assume):
            hanging = hanging + (np.isnan(peak_time) & (continuous < required.peak))
        unprinted = np.isnan(feed.usable).astype(np.int8)
        unprinted = unprinted + (np.isnan(peak_time) & (continuous < required.peak * (1.0 + required.torque)))
        otherwise = np.where(volts > lowest, usable.largest[motor], otherwise)
    shares, weight = _shares(spec, catalog, order, rms), weights.get("margin", 0.0)
    ranks = Ranks(lacking, hanging, shares, margin, unprinted, weight)
    if not len(order):
        return otherwise, ranks
    unknown, _, _, place = ranks.best()
    return np.where(unknown < LOST, order[place.astype(np.int64)], otherwise), ranks


def _shares(
    spec: RobotSpec, catalog: Catalog, order: NDArray[np.int64], rms: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Share of each controller in the objective of each candidate, less is better: shape (controllers, 1 or more).

    What no objective counts is 0 of all; the margin's share hangs on the candidate's other checks.
    """
    table, found = catalog.controllers, np.zeros((len(order), 1))
    for name, weight in spec.select.weights.items():
        if name == "energy":
            stage = spec.feed({name: table[name][order][:, None] for name in STAGE_FIGURES}).stage
            current = np.maximum(rms, 1e-9)
            lost = stage.loss + stage.resistance * current + stage.standby / current
            found = found + weight * np.nan_to_num(lost, nan=LAST) / spec.supply.nominal
        elif name != "margin":
            found = (
                found + weight * parts_share(name, table, catalog, alone=len(spec.select.weights) == 1)[order][:, None]
            )
    return found


def summed_share(spec: RobotSpec, table: Table[Any], catalog: Catalog) -> NDArray[np.float64]:
    """Share of parts in what the objective of a spec sums, less is better."""
    found = np.zeros(len(table))
    for name, weight in spec.select.weights.items():
        found += weight * parts_share(name, table, catalog, alone=len(spec.select.weights) == 1)
    return found


def parts_share(name: str, table: Table[Any], catalog: Catalog, *, alone: bool) -> NDArray[np.float64]:
    """Figure of parts that an objective sums, in that of a typical motor; unknown ones behind all others.

    Unknown ones go by mass where nothing else counts: beside other figures a mass would be one more of them. Of what
    turns with the motor the inertia, where the objective is a figure of the motor's current.
    """
    if name == "energy" and table.section == "brakes":
        return np.asarray(np.nan_to_num(released_power(table), nan=LAST), float)
    column = {"mass": "mass", "price": "price", "length": "added_length"}.get(name, "inertia")
    if column not in table.columns or name == "power" or (name == "length" and table.section != "brakes"):
        return np.zeros(len(table))
    figure, of_motors = table[column], catalog.motors["rotor_inertia" if column == "inertia" else name]
    typical = np.median(known) if len(known := of_motors[~np.isnan(of_motors)]) else 1.0
    unknown = LAST + np.nan_to_num(table["mass"]) if alone else LAST
    found: NDArray[np.float64] = np.where(np.isnan(figure), unknown, figure / typical)
    return found


def _usable(choice: ControllerChoice, table: Table[Any], lowest: float, highest: float) -> NDArray[np.bool_]:
    """Controllers that the spec allows, with the bus it names, for its supply voltages.

    As far as these are printed: of one that is sold apart at least the highest.
    """
    keep = table.named(choice.named)
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
    others = (table["family"] == ASSUMED) & (table["part"] != amplifier_of(str(catalog.motors["part"][motor])))
    rows = (table["inside"] == (box if inside else "")) & ~others & table.named(spec.select.controller.named)
    if not rows.any():
        return f"{own} is inside the motor; no figures of it are listed" if own else "the catalogues list no controller"
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
