"""Many drives against the budgets of their machine at once: which of them certainly fail, and on which budget.

By the energies, the largest power and the masses of each, as columns. What needs each moment of the battery's current
is left to the drive's own record (``budgets``), which decides: nothing is rejected here that would pass there.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import nan

import numpy as np
from numpy.typing import NDArray

from drivesizer.load_cases.trip import distance_of
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.machine.battery_checks import Load, accepted, charging, raised_voltage
from drivesizer.machine.battery_pack import Pack, pack_of
from drivesizer.machine.mass_budget import BELT
from drivesizer.machine.price_budget import BY_PIECES
from drivesizer.results.check_columns import CheckColumn, at_most
from drivesizer.results.problem import Problem
from drivesizer.search.columns.bought import bought, chosen
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.columns.evaluation import Evaluation, figures_by_physics
from drivesizer.search.uncertainty.sampled_battery import Draw, Feeding, columns_of, feeding
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.select import BOUGHT

__all__ = ["certain_failures"]

Array = NDArray[np.float64]
_NEARLY = 1e-3  # of a limit: what misses it by less is judged by its record


def certain_failures(whole: Evaluation) -> dict[str, NDArray[np.bool_]]:
    """The drives that certainly fail on each budget of the machine."""
    sets, found = whole.candidates, dict[str, NDArray[np.bool_]]()
    for check in (*_masses(whole), *_prices(whole), *_batteries(whole)):
        with np.errstate(invalid="ignore"):
            missed = ~((1.0 + check.margin) >= (1.0 + check.needed) * (1.0 - _NEARLY))
        falls = check.failed & missed
        if whole.spec.select.unknown == "reject":
            falls = falls | ~(check.passed | check.failed)
        found[check.name] = found.get(check.name, False) | np.broadcast_to(falls, len(sets.motor))
    return found


# --- mass -------------------------------------------------------------------------------------------------------------


def _masses(whole: Evaluation) -> list[CheckColumn]:
    """The known mass of the machine with each drive, of what is estimated the least."""
    spec, sets = whole.spec, whole.candidates
    if spec.budget is None or not spec.budget.weighs:
        return []
    from drivesizer.machine.platform_checks import machine_mass, mass_columns

    catalog = whole.catalog.ends[0] if whole.catalog.ends else whole.catalog
    parts = chosen(whole.encoder, whole.controller, whole.brake, needs_encoder=spec.wants_encoder)
    of_drive = bought(catalog, sets, parts, "mass", BOUGHT, 1 if whole.catalog.ends else None)
    each = np.vstack([of_drive, _belts(whole.problem, sets)])
    battery = pack_of(spec.battery, catalog).mass if spec.battery else None
    rest = machine_mass(spec.budget, (), platform=spec.platform, battery=battery)
    known = spec.load.motors * np.nansum(each, axis=0) + rest.known
    lacking = np.isnan(each).any(axis=0) | bool(rest.unknown)
    load = whole.problem.machine.load
    return mass_columns(known, lacking, spec.budget.mass, load.mass if isinstance(load, WheeledVehicle) else None)


# --- price ------------------------------------------------------------------------------------------------------------


def _prices(whole: Evaluation) -> list[CheckColumn]:
    """The known price of all drives, without belt, screw and supply."""
    spec, sets = whole.spec, whole.candidates
    if spec.budget is None or spec.budget.price is None:
        return []
    parts = chosen(whole.encoder, whole.controller, whole.brake, needs_encoder=spec.wants_encoder)
    each = bought(whole.catalog, sets, parts, "price", BOUGHT)
    for name, least in reversed(BY_PIECES):
        if spec.load.motors >= least:
            of_several = bought(whole.catalog, sets, parts, name, BOUGHT[:2])
            each[:2] = np.where(np.isnan(of_several), each[:2], of_several)
    column = at_most("price", spec.load.motors * np.nansum(each, axis=0), spec.budget.price)
    return [replace(column, passed=column.passed & ~np.isnan(each).any(axis=0))]


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
        drawn = figures["energy"] + case.supply.regeneration * figures["returned"]
        draw = Draw(drawn, figures["returned"], figures["power"])
        idle = draw._replace(drawn=np.zeros_like(drawn), returned=np.zeros_like(drawn))
        feeds: Feeding = feeding(case, battery, problem.catalog)
        speed = np.full_like(drawn, distance_of(case, cycle) / cycle.total)
        yield from columns_of(case, feeds, cycle.total, speed, [draw, *([idle] * (len(numbers) - 1))])
        yield from _charging(case, feeds.pack, draw.returned / cycle.total)


def _charging(case: RobotSpec, pack: Pack, returned: Array) -> tuple[CheckColumn, ...]:
    """Checks of the least charge power: its peak is no less than its mean over the cycle [W]."""
    back, rest = accepted(case) * returned, pack.emf(pack.start)
    least = Load(mean=nan, peak=nan, rms=nan, back=back, speed=nan, charge=pack.start)
    return charging(case, pack, least._replace(highest=raised_voltage(pack, back, rest)))
