"""Drives that pass the budgets of their machine: by lower bounds of their power, as columns, then one by one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterable, Iterator
from dataclasses import replace
from itertools import islice
from math import nan
from typing import Any

import numpy as np

from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.machine.battery import Load, accepted, charging, columns_of, feeding, mass_of, raised_voltage
from drivesizer.machine.budgets import (
    BELT,
    MachineBudget,
    machine_budget,
    machine_mass,
    machine_requirements,
    mass_columns,
)
from drivesizer.machine.supply_power import Draw
from drivesizer.physics.cycle_at_gearhead import SPEED
from drivesizer.physics.figures import Array, Mask, Whole, no_less
from drivesizer.physics.thermal import resistance_25, resistance_at
from drivesizer.results.check import Check, sentence_case, verdict
from drivesizer.results.check_columns import CheckColumn, at_most
from drivesizer.results.check_kinds import BATTERY_LASTING
from drivesizer.results.drive_set import Detail, DriveParts, DriveSet
from drivesizer.results.problem import Problem
from drivesizer.search.columns.candidates import Candidates, Rows
from drivesizer.search.columns.evaluation import Evaluation, figures_by_physics
from drivesizer.search.columns.stages import in_motion, offers, parts_of
from drivesizer.search.ranking import bought, part_rows
from drivesizer.search.search import BudgetFilter, Evaluated, Judge, any_drive, search
from drivesizer.search.set_record import drive_parts, drive_set
from drivesizer.spec.drive import BOUGHT

# -- Drives that a battery certainly cannot feed for long enough, by a lower bound of their power without a waveform.
#
# A motor's mean power is no less than with its winding at the ambient's temperature all the time,
#
# .. math:: P \ge R_{cold} I_{rms}^2 + \overline{\tau w}
#
# for a winding in use is warmer, and what the makers' two constants differ by is lost (``waveform.balanced``). A
# controller draws no less than it passes on and gives back no more than it is given, of which no more than all is
# kept. So whatever the controller is, the battery gives that power in the mean. Both terms follow from the moments
# of the load cycle, over as many drives as there are.


_ROUNDING = 1e-9  # of a figure


def battery_failures(problem: Problem, sets: Candidates) -> dict[str, Mask]:
    """The drives that certainly fail on autonomy or range of the battery; empty where neither is required."""
    failures = dict[str, Mask]()
    battery = problem.spec.battery
    if battery is None:
        return failures
    for numbers in problem.machine_cases:
        case, cycle = problem.cases[numbers[0]].spec, problem.cases[numbers[0]].cycle
        least = np.sum([problem.cases[n].spec.load.alike * least_power(problem, n, sets) for n in numbers], axis=0)
        energy = cycle.total * (least - _ROUNDING * np.abs(least))
        draw = Draw(energy, np.zeros_like(energy), np.full_like(energy, np.nan))
        for check in columns_of(case, feeding(case, battery, problem.catalog), cycle, [draw]):
            if check.name in BATTERY_LASTING:
                failures[check.name] = failures.get(check.name, False) | check.failed
    return failures


def least_power(problem: Problem, number: int, sets: Candidates) -> Array:
    """Lower bound of a motor's mean power over a load case [W]; NaN where the waveform's power is unknown."""
    catalog, case = problem.catalog, problem.cases[number]
    cycles = [load_case.at_belt.behind(sets.belt) for load_case in problem.cases]
    motor, gearhead = Rows(catalog.motors, sets.motor), Rows(catalog.gearheads, sets.gearhead)
    parts, _ = parts_of(problem, offers(problem), cycles, sets, motor, gearhead)
    demand, heating = in_motion(case, cycles[number], parts)
    cold = np.asarray(resistance_at(resistance_25(motor), case.spec.environment.ambient))
    turning = demand.total_ratio * cycles[number].mean_with(demand.coefficients, SPEED)
    known = demand.complete & np.isfinite(heating.winding) & np.isfinite(motor["max_winding_temperature"])
    return np.where(known, cold * demand.rms_current**2 + turning, np.nan)


# -- Many drives against the budgets of their machine at once: which of them certainly fail, and on which budget.
#
# By the energies, the largest power and the masses of each, as columns. What needs each moment of the battery's
# current is left to the drive's own record (``budgets``), which decides: nothing is rejected here that would pass
# there.


_NEARLY = 1e-3  # of a limit: what misses it by less is judged by its record


def certain_failures(whole: Evaluation) -> dict[str, Mask]:
    """The drives that certainly fail on each budget of the machine."""
    sets, failures = whole.candidates, dict[str, Mask]()
    for check in (*_masses(whole), *_prices(whole), *_batteries(whole)):
        with np.errstate(invalid="ignore"):
            missed = ~((1.0 + check.margin) >= (1.0 + check.needed) * (1.0 - _NEARLY))
        falls = check.failed & missed
        if whole.spec.select.unknown == "reject":
            falls = falls | ~(check.passed | check.failed | check.opened)
        failures[check.name] = failures.get(check.name, False) | np.broadcast_to(falls, len(sets.motor))
    return failures


# --- mass -------------------------------------------------------------------------------------------------------------


def _masses(whole: Evaluation) -> list[CheckColumn]:
    """The known mass of the machine with each drive, of what is estimated the least."""
    spec, sets = whole.spec, whole.candidates
    if spec.budget is None or not spec.budget.weighs:
        return []
    catalog = whole.catalog.ends[0] if whole.catalog.ends else whole.catalog
    parts = part_rows(whole, needs_encoder=spec.wants_encoder)
    of_drive = bought(catalog, sets, parts, "mass", BOUGHT, 1 if whole.catalog.ends else None)
    masses = np.vstack([of_drive, _belts(whole.problem, sets)])
    rest = machine_mass(spec.budget, (), platform=spec.platform, battery=mass_of(spec.battery, catalog))
    known = spec.load.motors * np.nansum(masses, axis=0) + rest.known
    lacking = np.isnan(masses).any(axis=0) | bool(rest.unknown)
    load = whole.problem.machine.load
    return mass_columns(known, lacking, spec.budget.mass, load.mass if isinstance(load, WheeledVehicle) else None)


# --- price ------------------------------------------------------------------------------------------------------------


def _prices(whole: Evaluation) -> list[CheckColumn]:
    """The known price of all drives, without belt, screw and supply."""
    spec, sets = whole.spec, whole.candidates
    if spec.budget is None or spec.budget.price is None:
        return []
    parts = part_rows(whole, needs_encoder=spec.wants_encoder)
    prices = bought(whole.catalog, sets, parts, "price", BOUGHT)
    price = no_less(spec.load.motors * np.nansum(prices, axis=0), ~np.isnan(prices).any(axis=0))
    return [at_most("price", price, spec.budget.price)]


def _belts(problem: Problem, sets: Candidates) -> Array:
    """Mass of belt, pulleys and gear of each ratio; the least where they are not out of the catalogues."""
    mass, belt = np.zeros(len(sets.motor)), problem.spec.belt
    least = nan if not problem.catalog.ends else BELT[1][0]
    own = least if belt is None or belt.mass is None else belt.mass
    for ratio in np.unique(sets.belt).tolist():
        drive = problem.belt_drive(ratio)
        bought = [part.mass for part in drive.parts.values()] if drive else [own if ratio != 1.0 else 0.0]
        mass[sets.belt == ratio] = np.sum(bought)
    gear = problem.spec.gear
    if gear is not None:
        mass += nan if gear.mass is None else gear.mass
    return mass


# --- battery ----------------------------------------------------------------------------------------------------------


def _batteries(whole: Evaluation) -> Iterator[CheckColumn]:
    """Autonomy and peaks of the battery in each load case of the machine."""
    problem, battery = whole.problem, whole.spec.battery
    if battery is None:
        return
    machines = problem.machine_cases
    for numbers in machines:
        part = replace(problem, cases=tuple(problem.cases[n] for n in numbers))
        at_hand = len(machines) == 1 and bool(whole.figures)  # the paper's method has none
        figures = whole.figures if at_hand else figures_by_physics(part, whole.candidates)
        case, cycle = part.spec, part.cases[0].cycle
        consumption = figures["energy"] + case.supply.regeneration * figures["returned"]
        draw = Draw(consumption, figures["returned"], figures["power"])
        idle = draw._replace(drawn=np.zeros_like(consumption), returned=np.zeros_like(consumption))
        feeds = feeding(case, battery, problem.catalog)
        yield from columns_of(case, feeds, cycle, [draw, *([idle] * (len(numbers) - 1))])
        # the peak of the charge power is no less than its mean over the cycle
        pack, rest = feeds.pack, accepted(case) * draw.returned / cycle.total
        least = Load(mean=nan, peak=nan, rms=nan, back=rest, speed=nan, charge=pack.start)
        yield from charging(case, pack, least._replace(highest=raised_voltage(pack, rest, pack.emf(pack.start))))


# -- Drives that pass the budgets of their machine.


_FIRST = 4  # times as many drives as are wanted are computed in full at first
_FEWEST, _MORE, _MOST = 8, 8, 1 << 16  # at first at least, times as many each time, at most
_FEW = 4  # whose records cost less than columns of what the paper's method does not compute
_CELLS = 400_000  # drives times pieces of the load cycle at a time: over a long one each row costs


class InMachine:
    """A machine against its budgets with drives in it, of each drive once.

    For checks alone without figures that have no limit, and without counts of the budgets that each drive fails on.
    ``memo``: what was computed of the same machine before, whatever its drives are ranked by.
    """

    def __init__(
        self,
        problem: Problem,
        aside: frozenset[str] = frozenset(),
        *,
        detail: Detail = "full",
        memo: dict[Hashable, Any] | None = None,
    ) -> None:
        self.problem, self.aside, self.has_counts = problem, aside, detail != "checks"
        self._memo: dict[Hashable, Any] = {} if memo is None else memo
        if "requirements" not in self._memo:
            self._memo["requirements"] = machine_requirements(problem.machine, figures=self.has_counts)
        self.requirements: MachineBudget | None = self._memo["requirements"]

    def budget(self, whole: Evaluation, row: int) -> MachineBudget:
        """The budgets of the machine with the drive in a row of an evaluation."""
        sets = whole.candidates
        columns = sets.motor, sets.gearhead, sets.belt, whole.controller, whole.encoder, whole.brake
        drive = tuple(column[row].item() for column in columns)
        if drive not in self._memo:
            parts, figures = drive_parts(whole, row), self.has_counts
            self._memo[drive] = machine_budget(self.problem, parts, self.requirements, figures=figures)
        budget: MachineBudget = self._memo[drive]
        return budget

    def rejects(self, checks: Iterable[Check]) -> bool:
        """Whether a machine's checks reject its drive: one fails, or is unknown where the spec rejects that."""
        status = verdict(tuple(checks))
        return status == "fail" or (status == "unknown" and self.problem.spec.select.unknown != "allow")

    def divided(self, whole: Evaluation, top: int, rows: Iterable[int], *, short: bool = False) -> list[int]:
        """Of some rows the best drives that pass the machine's budgets, or the first ones that fail on those."""
        failing = ((row, whole.fails(row) or self.rejects(self.budget(whole, row).checks)) for row in rows)
        return list(islice((row for row, fails in failing if fails == short), top))

    @property
    def judge(self) -> Judge | None:
        """A function that separates drives that pass the budgets from those that fail; None without budgets."""
        spec = self.problem.spec
        limited = spec.battery or spec.budget or self.requirements or spec.limits_the_bus or spec.supply.stalled
        return self._judge if limited else None

    def _judge(self, sets: Candidates, evaluated: Evaluated, number: int) -> BudgetFilter:
        problem, machine, counted = self.problem, self.requirements, self.has_counts

        def known(failures: dict[str, Mask]) -> dict[str, Mask]:
            return {name: rows for name, rows in failures.items() if name not in self.aside}

        count, best, by = len(sets.motor), list[int](), Counter[str]()
        if machine and self.rejects(machine.checks):
            of_machine = {check.name for check in machine.checks if check.status == "fail"}
            return BudgetFilter(np.arange(0), np.arange(count), count, Counter(dict.fromkeys(of_machine, count)))
        early = known(battery_failures(problem, sets)) if problem.spec.method == "physics" else {}
        rejected = np.logical_or.reduce([np.zeros(count, bool), *early.values()])
        most = min(max(_FEWEST, _CELLS // problem.segments), _MOST)
        alone = 0 if counted else number  # these first: they are at hand, and mostly pass
        for rows in _pieces(np.flatnonzero(~rejected), alone, _FIRST * number, most):
            whole = evaluated(rows)
            certain: dict[str, Mask] | None = None
            few = not counted and not whole.figures and len(rows) <= _FEW  # columns cost more than so many records
            for n, row in enumerate(rows.tolist()):
                own = {name for name, column in (certain or {}).items() if column[n]}
                fails = bool(own)
                if not fails:
                    checks = [check for check in self.budget(whole, n).checks if check.name not in self.aside]
                    fails, own = self.rejects(checks), {check.name for check in checks if check.status == "fail"}
                if fails and certain is None and not few:  # in most machines there is no need of the columns
                    certain = known(certain_failures(whole))
                    own = {name for name, column in certain.items() if column[n]} or own
                rejected[row] = fails
                if fails:
                    by.update(own)
                else:
                    best.append(row)
                if len(best) == number:
                    break
            if len(best) == number:
                break
        judged = best[-1] + 1 if len(best) == number else count
        by.update({name: int(np.count_nonzero(rows[:judged])) for name, rows in early.items()})
        return BudgetFilter(np.array(best, np.int64), np.flatnonzero(rejected[:judged]), judged, by)


def _pieces(rows: Whole, alone: int, first: int, most: int) -> Iterator[Whole]:
    """Some rows alone, then a piece at a time, each larger than the one before: a piece costs much more than a row."""
    if alone and len(rows):
        yield rows[:alone]
        rows = rows[alone:]
    size = min(max(first, _FEWEST), most)
    while len(rows):
        yield rows[:size]
        rows, size = rows[size:], min(_MORE * size, most)


def any_in_machine(problem: Problem) -> bool:
    """Whether any drive passes by itself and in its machine."""
    return any_drive(problem, InMachine(problem, detail="checks").judge)


def best_in_machine(problem: Problem, aside: frozenset[str] = frozenset()) -> DriveSet | None:
    """The best drive that passes the machine's budgets too; None where none does."""
    result = search(problem, top=1, misses=None, judge=InMachine(problem, aside, detail="checks").judge)
    return drive_set(result.evaluation, 0, 1) if result.passing else None


def passes_budgets(problem: Problem, drive: DriveParts) -> bool:
    """Whether a drive passes the budgets of its machine, which need not have been computed."""
    machine = InMachine(problem, detail="checks")
    if machine.requirements and machine.rejects(machine.requirements.checks):
        return False
    return not machine.rejects(machine_budget(problem, drive, machine.requirements, figures=False).checks)


def shortfall(short: Iterable[MachineBudget], better: int, *, any_passes: bool) -> list[str]:
    """A warning that better drives fail on a budget: how many, and which budgets."""
    names = sorted(
        {sentence_case(check.title) for budget in short for check in budget.checks if check.status == "fail"}
    )
    if not better or not names:
        return []
    if any_passes:
        drives = "1 better drive is" if better == 1 else f"{better} better drives are"
    else:
        drives = (
            "1 drive meets its own limits and is" if better == 1 else f"{better} drives meet their own limits and are"
        )
    return [f"{drives} not enough for the machine ({', '.join(names)})"]
