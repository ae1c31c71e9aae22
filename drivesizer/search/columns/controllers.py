"""A controller for every candidate at once, out of small tables.

Of those with the bus, the voltage and the kind of motor the one of which no check fails, then the fewest are unknown,
then the best by the objective, then the smallest by continuous current and part number. Where each of them fails
a motor has none, for others may still exist: unknown. One that is inside an actuator, or that the spec names, is all
that there is: the nearest is then named, so that its check can say by how much it falls short; so is the largest where
the motor takes more voltage than the supply has, which fails with any.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog, Table
from drivesizer.catalog.view import ASSUMED, amplifier_of
from drivesizer.machine.supply_power import Draw
from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.extremes import distinct
from drivesizer.physics.figures import Alike, Array, Mask, Whole, on, put
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.power_stage import STAGE_FIGURES
from drivesizer.physics.winding import Heat, Parts, stress
from drivesizer.results.check_columns import CheckColumn, fits
from drivesizer.results.problem import Problem
from drivesizer.results.ratings import COMMUTATED, controller_current
from drivesizer.search.columns import limits_over_time as over_time
from drivesizer.search.columns.brakes import line_frequency
from drivesizer.search.columns.candidates import FREE, LAST, Rows, figure_order, parts_share
from drivesizer.search.columns.limits import (
    electrical_limits,
    electrical_speed,
    worst_of_all,
)
from drivesizer.spec.drive import ASSUMABLE, ControllerChoice
from drivesizer.spec.mounting import controller_needed
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

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
    share: Array  # of the objective, without the margin's: (controllers, 1 or candidates)
    margin: Array  # the smallest of theirs
    unprinted: NDArray[np.int8]  # figures that checks assume: of equals one goes before that has them
    weight: float  # of the margin in the objective

    def on(self, rows: Whole) -> Ranks:
        """Of some of the candidates."""
        columns: dict[str, Alike] = {
            n: getattr(self, n) for n in ("lacking", "hanging", "share", "margin", "unprinted")
        }
        return self._replace(**{name: x[:, rows] for name, x in columns.items() if x.shape[1] > 1})

    def at(self, figure: NDArray[Any], place: Whole) -> NDArray[Any]:
        """A figure of one controller of each candidate."""
        return figure[place, 0 if figure.shape[1] == 1 else np.arange(len(place))]

    def before(self, reached: Array, most: Array | float) -> Mask:
        """Controllers that may go before what was reached, in the columns of :meth:`best`, infinite where it fails."""
        unknown, place = np.minimum(self.lacking + self.hanging, LOST), np.arange(len(self.lacking))[:, None]
        less = place < reached[3]
        for figure, limit in ((self.unprinted, reached[2]), (self.worth(most), reached[1]), (unknown, reached[0])):
            less = (figure < limit) | ((figure == limit) & less)
        return np.asarray(less & (unknown < LOST), bool)

    def worth(self, most: Array | float) -> Array:
        """Share of each controller in the objective, with the margin's; ``most``: margin of all other checks."""
        worth = self.share
        if self.weight:
            worth = worth + self.weight / (1.0 + np.maximum(np.minimum(self.margin, most), -0.999))
        return np.round(worth, 9)

    def best(self, most: Array | float = np.inf, barred: Mask | None = None) -> Array:
        """Of each candidate number of unknown checks, worth, unprinted figures and place of its best controller.

        The less of the first the better, then of the second: the share of the objective, in digits without rounding.
        ``most``: margin of all other checks.
        """
        unknown = np.minimum(self.lacking + self.hanging, LOST)
        if barred is not None:
            unknown[barred] = LOST
        rank: Alike = self.worth(most)
        worth, fewest, last = rank, unknown.min(axis=0), float("inf")
        if worth.shape[1] == 1:  # the same order for all
            rank = np.unique(worth, return_inverse=True)[1].reshape(-1, 1).astype(np.int16)
            last = len(worth)
        own = np.where(unknown == fewest, rank, last)
        place = np.where(own == own.min(axis=0), self.unprinted, LOST).argmin(axis=0)
        return np.array([fewest, self.at(worth, place), self.at(self.unprinted, place), place], float)


class Required(NamedTuple):
    """Demands of candidates on a controller in the worst of all load cases; None is not looked at."""

    rms: Array  # A
    peak: Array  # A
    voltage: Array | None = None  # V, with a cold winding
    max_speed_sine: Array | None = None  # rad/s, speed times pole pairs; 0 where it has no part
    max_encoder_frequency: Array | None = None  # Hz, of the encoder's lines
    lasting: float = 0.0  # margins that the spec requires: of the RMS current,
    torque: float = 0.0  # of the peak,
    speed: float = 0.0  # of the others


class Usable(NamedTuple):
    """Controllers for the spec's supply and bus, by rising current."""

    order: Whole  # their rows
    allowed: Mask  # which of them may drive which motor: (motors, controllers)
    nearest: Whole  # of each motor that may have no other; -1 where there is none, or others may exist
    largest: Whole  # of those that each motor may have, by known figures; -1 where there is none
    partial: Mask  # which motors may have one that no catalogue lists
    unclear: Mask  # of which of all controllers the supply's range is not wholly known; of none it is
    lowest: float  # V, of the supply
    ambient: float  # K, the hottest

    def available(self, motor: Whole, row: Whole) -> CheckColumn:
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


def _last(mask: Mask, order: Whole) -> Whole:
    """The last in order that a mask over it allows, -1 where it allows none."""
    if not len(order):
        return np.full(len(mask), -1)
    place = len(order) - 1 - np.argmax(mask[:, ::-1], 1)
    return np.where(mask.any(1), order[place], -1)


def controllers(
    spec: RobotSpec, catalog: Catalog, motor: Whole, required: Required, usable: Usable | None = None
) -> tuple[Whole, Ranks]:
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
            unknown = unknown & (demand != 0.0)
            if demand is required.max_speed_sine:
                beyond = unknown & (demand * (1.0 + needed) > COMMUTATED)
                unprinted, unknown = unprinted + (unknown ^ beyond), beyond
            lacking += unknown & (lacking < LOST)
        if "margin" in weights:
            with np.errstate(divide="ignore", invalid="ignore"):
                margin = np.fmin(margin, np.where(demand == 0.0, np.inf, limit / demand - 1.0))
    otherwise = usable.nearest[motor]
    if required.voltage is not None:
        feed = spec.feed({name: table[name][order][:, None] for name in STAGE_FIGURES})._replace(voltage=lowest)
        volts = required.voltage * (1.0 + required.speed)
        usable_voltage = feed.usable_range
        lacking[np.minimum(usable_voltage.high, lowest) < volts] = LOST
        hanging = (~((volts <= usable_voltage.low) | (volts > usable_voltage.high)) & (volts != 0.0)).astype(np.int8)
        if not any("controller_peak_time" in ASSUMABLE[name] for name in spec.select.assume):
            hanging = hanging + (np.isnan(peak_time) & (continuous < required.peak))
        unprinted = (
            unprinted
            + np.isnan(feed.usable)
            + (np.isnan(peak_time) & (continuous < required.peak * (1.0 + required.torque)))
        )
        otherwise = np.where(volts > lowest, usable.largest[motor], otherwise)
    shares, weight = _shares(spec, catalog, order, rms), weights.get("margin", 0.0)
    ranks = Ranks(lacking, hanging, shares, margin, unprinted, weight)
    if not len(order):
        return otherwise, ranks
    unknown, _, _, place = ranks.best()
    return np.where(unknown < LOST, order[place.astype(np.int64)], otherwise), ranks


def _shares(spec: RobotSpec, catalog: Catalog, order: Whole, rms: Array) -> Array:
    """Share of each controller in the objective of each candidate, less is better: shape (controllers, 1 or more).

    What no objective counts is 0 of all; the margin's share hangs on the candidate's other checks.
    """
    table, shares = catalog.controllers, np.zeros((len(order), 1))
    for name, weight in spec.select.weights.items():
        if name == "energy":
            stage = spec.feed({name: table[name][order][:, None] for name in STAGE_FIGURES}).stage
            current = np.maximum(rms, 1e-9)
            lost = stage.loss + stage.resistance * current + stage.standby / current
            shares = shares + weight * np.nan_to_num(lost, nan=LAST) / spec.supply.nominal
        elif name != "margin":
            shares = (
                shares + weight * parts_share(name, table, catalog, alone=len(spec.select.weights) == 1)[order][:, None]
            )
    return shares


def _usable(choice: ControllerChoice, table: Table[Any], lowest: float, highest: float) -> Mask:
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


# -- Candidates with the best controller that does in all load cases, against what is electrical and temperature.
#
# What a controller must give depends on how warm the winding is, and on the controller: for how long the current is
# above its own, what it loses, what its capacitance takes. So all controllers of a candidate are ordered by what
# moments and extremes say of them at least, and computed in that order until none that is left could be better.


UNDECIDED = "undecided"  # figure of a candidate: above 0 where bounds leave open whether the waveform meets its limits
_COLUMNS = 1 << 10  # candidates whose controllers are ranked together, within the processor's cache
_AT_ONCE = 1 << 13  # controllers of candidates times segments of a cycle that are computed at once
OVER_WAVEFORM = ("winding_temperature", *HANGING)  # checks that bounds may leave open
_OF_CONTROLLER = (
    "controller_continuous_current", "controller_peak_current", "controller_speed", "encoder_frequency", *HANGING,
)  # fmt: skip


class Moving(NamedTuple):
    """Demands of candidates in a load case, and their heat: columns."""

    demand: Demands
    heating: Heat


class Powered(NamedTuple):
    """Candidates with their controllers."""

    controller: Whole  # row of each
    checks: list[CheckColumn]
    figures: dict[str, Array]


def powered(
    problem: Problem,
    usable: Usable,
    cycles: Sequence[AtGearhead],
    moving: Sequence[Moving],
    parts: Parts,
    *,
    waveform: over_time.Waveform,
    exact_checks: Collection[str] = (),
) -> Powered:
    """Controllers, and every check that hangs on current, voltage and heat."""
    cases = [
        over_time.InCase(
            case.spec, cycle, *motion, stress(case.spec.environment.ambient, cycle, motion.demand, parts.motor)
        )
        for case, cycle, motion in zip(problem.cases, cycles, moving, strict=True)
    ]
    preset, candidates = parts.controller, _Candidates(problem, usable, cases, parts, waveform, exact_checks)
    row, ranks = candidates.controllers()
    free = np.ones(len(row), bool) if preset is None else preset.rows == FREE
    row = row if preset is None else np.where(free, row, preset.rows)
    if len(usable.order):
        row = candidates.by_lower_bounds(row, ranks, free)
    verdict = candidates.judge(row)
    if len(usable.order):
        row, verdict = _best_of_all(candidates, ranks, row, verdict, free & ~(verdict.undecided > 0.0))
    agreed = [low.agreed(high) for low, high in verdict.pairs]
    figures = over_time.cycle_figures(
        problem, [Draw(moments.drawn, moments.returned, moments.power) for moments in agreed],
        joule_heat=agreed[0].copper, peak_current=np.maximum.reduce([case.stresses.current.value for case in cases]),
        winding_temperature=np.maximum.reduce([moments.winding for moments in agreed]),
    )  # fmt: skip
    # a lower bound may fail a check, but is no figure
    figures = {name: np.where(candidates.complete, column, np.nan) for name, column in figures.items()}
    available = usable.available(parts.motor.rows, row)
    return Powered(row, [available, *verdict.checks], figures | {UNDECIDED: verdict.undecided})


class _Verdict(NamedTuple):
    """Candidates with some controllers."""

    checks: list[CheckColumn]
    pairs: list[over_time.Bounds]  # bounds over the waveform of each load case
    # 1 of what fails nothing by bounds, which are all that is wanted, and what the waveform may fail; 2 of those of
    # which a check is unknown whatever the waveform says
    undecided: Array

    def failed(self, but: Collection[str] = ()) -> Mask:
        """Whether a check fails, but for some."""
        return np.logical_or.reduce([c.failed for c in self.checks if not c.advice and c.name not in but])

    def margin(self, of_controller: bool) -> Array:
        """The smallest margin of the checks that hang on the controller, or of the others."""
        return np.minimum.reduce([c.tightness for c in self.checks if (c.name in _OF_CONTROLLER) == of_controller])


class _Candidates(NamedTuple):
    """The load cases and their candidates."""

    problem: Problem
    usable: Usable
    cases: Sequence[over_time.InCase]
    parts: Parts
    waveform: over_time.Waveform
    exact_checks: Collection[str]

    @property
    def complete(self) -> Mask:
        """Whether all that is demanded of each candidate is known."""
        return np.asarray(np.logical_and.reduce([case.demand.complete for case in self.cases]), bool)

    def subset(self, rows: Whole) -> _Candidates:
        """Some of the candidates."""
        cases, parts = on((self.cases, self.parts), rows)
        return self._replace(cases=cases, parts=parts)

    def with_controllers(self, row: Whole) -> Parts:
        """The parts of candidates with some controllers."""
        return self.parts._replace(controller=Rows(self.problem.catalog.controllers, row))

    def controllers(self) -> tuple[Whole, Ranks]:
        """The best that suffices in the worst of all cases, as far as that is known before its own limits are."""
        spec, motor = self.problem.spec, self.parts.motor

        def worst(figure: Callable[[over_time.InCase], Array]) -> Array:
            return np.maximum.reduce([figure(case) for case in self.cases])

        required = Required(
            worst(lambda case: case.demand.rms_current),
            worst(lambda case: case.stresses.current.value),
            worst(lambda case: case.stresses.cold_voltage.value),
            worst(lambda case: electrical_speed(case.demand, motor)),
            worst(lambda case: line_frequency(case.demand, self.parts.encoder)) if spec.wants_encoder else None,
            max(controller_needed(case.spec, spec.margins.torque) for case in self.cases),
            spec.margins.torque,
            spec.margins.speed,
        )
        return controllers(spec, self.problem.catalog, motor.rows, required, self.usable)

    def by_lower_bounds(self, row: Whole, ranks: Ranks, free: Mask) -> Whole:
        """Controllers that are the best by lower bounds over the waveform, where their margins count."""
        rows = np.flatnonzero(free & (row >= 0) & self.complete)
        if not ranks.weight or not len(rows):
            return row
        unknown, _, _, place = self.subset(rows).ranks(ranks.on(rows)).best()
        able = np.flatnonzero(unknown < LOST)  # where each fails the first one says on what
        return put(row, rows[able], self.usable.order[place[able].astype(np.int64)])

    def ranks(self, ranks: Ranks, row: Whole | None = None, verdict: _Verdict | None = None) -> Ranks:
        """Ranks of all controllers by lower bounds over the waveform, and by what was computed with one of them.

        So many candidates at a time, with the controllers that are not lost to all of these.
        """
        lacking, hanging, margin = ranks.lacking.copy(), np.zeros_like(ranks.lacking), ranks.margin
        if ranks.weight:
            margin = np.array(np.broadcast_to(margin, lacking.shape))
        for start in range(0, lacking.shape[1], _COLUMNS):
            columns = np.arange(start, min(start + _COLUMNS, lacking.shape[1]))
            left = np.flatnonzero((lacking[:, columns] < LOST).any(axis=1))
            of, place = self.subset(columns), np.ix_(left, columns)
            trial = None if verdict is None or row is None else (row[columns], on(verdict, columns))
            shape, passed = (len(left), len(columns)), dict[str, Mask]()
            lost = np.zeros(shape, bool)
            for check in of.hanging(self.usable.order[left], trial):
                lost |= check.failed
                passed[check.name] = passed.get(check.name, np.True_) & check.passed
                if ranks.weight:
                    margin[place] = np.minimum(margin[place], check.tightness)
            lacking[place] = np.where(lost, LOST, lacking[place])
            hanging[place] = np.sum([~np.broadcast_to(mask, shape) for mask in passed.values()], axis=0, dtype=np.int8)
        return ranks._replace(lacking=lacking, hanging=hanging, margin=margin)

    def hanging(self, controllers: Whole, trial: tuple[Whole, _Verdict] | None) -> Iterator[CheckColumn]:
        """Limits of each of some controllers that hang on the cycle too, by lower bounds and by what was computed.

        What loses more than the one of the trial draws no less, and returns no more.
        """
        parts = self.with_controllers(controllers[:, None])
        for k, case in enumerate(self.cases):
            spec, low = case.spec, over_time.lowest(case, parts)
            high = low
            if trial is not None:
                row, verdict = trial
                computed, stage = verdict.pairs[k].low, spec.feed(parts.controller).stage
                its = spec.feed(Rows(self.problem.catalog.controllers, row)).stage
                more = (stage.loss >= its.loss) & (stage.standby >= its.standby)
                less = stage.least_loss <= its.least_loss
                low = low._replace(
                    voltage=low.voltage if spec.resists else np.fmax(low.voltage, computed.voltage),
                    stored=np.where(less, np.fmax(low.stored, computed.stored), low.stored),
                    power=np.where(more, np.fmax(low.power, computed.power), low.power),
                )
                ranged = self.ranges_of_voltage(k, row, verdict)
                high = low._replace(voltage=np.where(ranged, verdict.pairs[k].high.voltage, low.voltage))
            yield from (check for check in over_time.waveform_limits(spec, low, high, parts) if check.name in HANGING)

    def ranges_of_voltage(self, k: int, row: Whole, verdict: _Verdict) -> Mask:
        """Whose voltage in a load case lies within computed ends, by which the limit of a controller is undecided."""
        case = self.cases[k]
        if self.waveform == "bounds" or case.spec.resists:
            return np.zeros(len(row), bool)
        volts = over_time.voltage_limit(case.spec, *verdict.pairs[k], self.with_controllers(row).controller)
        return np.asarray(case.demand.complete & ~(volts.passed | volts.failed) & ~verdict.failed(), bool)

    def judge(self, row: Whole) -> _Verdict:
        """The electrical limits with some controllers, and those of the waveform by bounds or exactly."""
        parts, cases = self.with_controllers(row), list(self.cases)
        for k, (spec, cycle, demand, *_) in enumerate(cases):
            if spec.resists:  # before the winding, of the voltage
                leads = spec.feed(parts.controller).leads
                stresses = stress(spec.environment.ambient, cycle, demand, parts.motor, leads)
                cases[k] = cases[k]._replace(stresses=stresses)

        first = worst_of_all(
            electrical_limits(spec, cycle, demand, stresses, parts) for spec, cycle, demand, _, stresses in cases
        )
        alive: Mask = ~np.logical_or.reduce([check.failed for check in first if not check.advice])
        pairs = [over_time.over_waveform(case, parts, self.waveform, alive, self.exact_checks) for case in cases]
        last = worst_of_all(over_time.known_limits(case, pair, parts) for case, pair in zip(cases, pairs, strict=True))
        verdict = _Verdict([*first, *last], pairs, np.zeros(len(row)))
        if self.waveform != "bounds":
            return verdict
        left, lacks = np.zeros(len(row), bool), np.zeros(len(row), bool)
        for case, pair in zip(cases, pairs, strict=True):
            left |= over_time.left_open(case.spec, pair, parts) & case.demand.complete
            for check in over_time.waveform_limits(case.spec, pair.low, pair.low, parts):
                lacks |= ~(check.passed | check.failed)
        return verdict._replace(undecided=np.where(left & ~verdict.failed(), 1.0 + lacks, 0.0))

    def reached(self, ranks: Ranks, row: Whole, verdict: _Verdict) -> Array:
        """Columns as ``Ranks.best`` gives them, as computed with a controller each; infinite where a check fails."""
        checks = [c for c in verdict.checks if c.name in _OF_CONTROLLER and not c.advice]
        unknown = np.sum([~(c.passed | c.failed) for c in checks], axis=0) + (self.usable.unclear[row] | (row < 0))
        unknown = np.where(verdict.undecided > 0.0, 0, unknown)  # by bounds it may pass
        place = np.zeros(len(self.problem.catalog.controllers) + 1, np.int64)
        place[self.usable.order] = np.arange(len(self.usable.order))
        place = place[row]
        share, unprinted = ranks.at(ranks.share, place), ranks.at(ranks.unprinted, place)
        if ranks.weight:
            least = np.minimum(verdict.margin(True), verdict.margin(False))
            share = share + ranks.weight / (1.0 + np.maximum(least, -0.999))
        return np.where(verdict.failed(), np.inf, np.array([unknown, np.round(share, 9), unprinted, place], float))


def _best_of_all(
    candidates: _Candidates, ranks: Ranks, row: Whole, verdict: _Verdict, free: Mask
) -> tuple[Whole, _Verdict]:
    """Candidates with the best of all controllers, as computed from the waveform.

    They are tried in the order of what bounds say of them at least, until none that is left could be better. Where all
    that are listed fail others may exist: none. Where the motor takes more voltage than the supply has none helps.
    """
    usable, more = candidates.usable, 1.0 + candidates.problem.spec.margins.speed
    unmet = ~np.logical_and.reduce([c.passed for c in verdict.checks if c.name in HANGING])
    if ranks.weight:
        unmet |= verdict.margin(True) < verdict.margin(False)
    for case, (low, _) in zip(candidates.cases, verdict.pairs, strict=True):
        free = free & ~(more * low.voltage > case.spec.supply.lowest)
    wanting = unmet & free & (row >= 0) & ~verdict.failed(HANGING)
    rows = np.flatnonzero(wanting & (candidates.complete | verdict.failed()))
    if not len(rows):
        return row, verdict
    candidates, ranks, best_verdict, best_row = candidates.subset(rows), ranks.on(rows), on(verdict, rows), row[rows]
    best, trials = candidates.reached(ranks, best_row, best_verdict), usable.order[:, None] == best_row
    few = _AT_ONCE // candidates.problem.segments
    left, here, new, trial = np.arange(len(rows)), candidates, best_verdict, best_row
    while len(left):
        ranks, others = here.ranks(ranks, trial, new), new.margin(False) if ranks.weight else np.inf
        could = ranks.before(best[:, left], others) & ~trials[:, left] & (here.complete | np.isinf(best[0, left]))
        place, at = np.nonzero(could)
        if len(at) > few:
            at = np.flatnonzero(could.any(axis=0))
            place = ranks.best(others, ~could)[3, at].astype(np.int64)
        if not len(at):
            break
        left, here, ranks, trial = left[at], here.subset(at), ranks.on(at), usable.order[place]
        new, trials[place, left] = here.judge(trial), True
        reached = here.reached(ranks, trial, new)
        in_order = np.lexsort((*reached[::-1], left))
        of_each = in_order[np.unique(left[in_order], return_index=True)[1]]
        better = of_each[_before(reached[:, of_each], best[:, left[of_each]])]
        best[:, left[better]] = reached[:, better]
        best_row, best_verdict = (
            put(best_row, left[better], trial[better]),
            put(best_verdict, left[better], on(new, better)),
        )
        retry = ~new.failed(HANGING) & (here.complete | np.isinf(best[0, left]))
        going = np.flatnonzero(retry) if len(left) == len(of_each) else left[:0]
        left, here, ranks, new, trial = left[going], here.subset(going), ranks.on(going), on(new, going), trial[going]
    none = np.flatnonzero(np.isinf(best[0]) & usable.partial[candidates.parts.motor.rows])
    if len(none):
        new = candidates.subset(none).judge(np.full(len(none), -1))
        better = np.flatnonzero(~new.failed())
        best_row, best_verdict = (
            put(best_row, none[better], np.full(len(better), -1)),
            put(best_verdict, none[better], on(new, better)),
        )
    return put(row, rows, best_row), put(verdict, rows, best_verdict)


def _before(columns: Array, other: Array) -> Mask:
    """Whether some columns go before others, by the first row in which they differ."""
    before = np.zeros(columns.shape[1], bool)
    for a, b in zip(columns[::-1], other[::-1], strict=True):
        before = (a < b) | ((a == b) & before)
    return before
