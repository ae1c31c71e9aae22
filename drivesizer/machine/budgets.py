"""The machine with a drive in it, against its budgets: mass, price, room, footing, grip, battery.

These checks count whatever method ranked: a drive that the battery cannot feed for long enough is rejected. With load
cases the worst of them counts. A mass that no data sheet gives is estimated, with a band. One that has no estimate
either has a row of its own and no figure: the sum is that of what is known, and may break a limit but not keep it.
Where the drive's own mass counts, a heavier machine may need a heavier drive: ``settle`` goes round until a drive
carries itself.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import isnan, nan
from statistics import NormalDist
from typing import Any, NamedTuple

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.catalog.estimates import assumed_mass
from drivesizer.catalog.prices import price_of
from drivesizer.catalog.tolerances import END
from drivesizer.load_cases import located
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.machine.battery import energy_budget, mass_of
from drivesizer.machine.braking import bus_budget
from drivesizer.machine.common_bus import AxisPower, CommonBus, common_bus
from drivesizer.physics.figures import Alike, no_less
from drivesizer.physics.thermal import resistance_25, resistance_at
from drivesizer.results.check import Check, Figure, figures_of, worst_of_cases
from drivesizer.results.check_columns import CheckColumn, at_most, over_ends
from drivesizer.results.drive_set import BrakingBudget, DriveParts, EnergyBudget, MassRow, section_of
from drivesizer.results.problem import Problem
from drivesizer.spec.platform import Budget, Platform
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.sections import Battery, Supply
from drivesizer.units import show

Item = tuple[str, Any, int]  # role, part or None where none is known, and how many
Sized = Callable[[float], float | None]  # mass of the whole to that of the drive that carries it, None without [kg]
BELT = (0.15, (0.05, 0.45))  # kg, of belt and two pulleys of a ratio alone: assumed, a factor of 3 either way
_SECTIONS = {"motor": "motors", "gearhead": "gearheads", "encoder": "encoders", "controller": "controllers",
             "actuator": "actuators", "brake": "brakes"}  # fmt: skip


# --- price


def items_bought(
    drives: Iterable[tuple[Problem, DriveParts]], part: str | None, braking: BrakingBudget | None, catalog: Catalog
) -> Iterator[Item]:
    """Parts of all drives of a machine, power supply and brake resistor, as far as they are out of catalogues."""
    for problem, drive in drives:
        spec = problem.spec
        needless = "encoder" if drive.encoder is None and not spec.wants_encoder else ""
        parts = {role: known for role, known in drive.parts.items() if role != needless}
        unknown = ["brake"] * (spec.names_brake and drive.brake is None)
        unknown += ["belt and pulleys"] * (drive.belt_ratio != 1.0 and drive.belt_drive is None)
        unknown += [spec.gear.kind] if spec.gear else []
        for role, bought in (*parts.items(), *((role, None) for role in unknown)):
            yield role, bought, spec.load.motors
    if part is not None:
        yield "power supply", catalog.power_supplies.record(catalog.power_supplies.rows[part]), 1
    if braking is not None and braking.resistor is not None and braking.resistor.part:
        yield "brake resistor", braking.resistor, 1


def price_check(
    limit: float, drives: Sequence[tuple[Problem, DriveParts]], supply: Supply, braking: BrakingBudget | None,
    catalog: Catalog,
) -> Check:  # fmt: skip
    """The known prices of what is bought, each for as many pieces as there are, against what it may cost."""
    items = [*items_bought(drives, supply.part, braking, catalog)]
    pieces, prices = Counter[str](), list[float]()
    for _, part, number in items:
        if part is not None:
            pieces[part.part] += number
    for _, part, number in items:
        prices.append(nan if part is None else number * _price(catalog, part, pieces[part.part]))
    lacking = dict.fromkeys(role for (role, *_), price in zip(items, prices, strict=True) if isnan(price))
    code = getattr(limit, "currency", catalog.currency)
    if code not in catalog.rates:
        note = (
            f"unknown: prices are in {catalog.currency}; expected select.rates, e.g. {{{code}: ... {catalog.currency}}}"
        )
        return replace(at_most("price", nan, limit).at((), "budget"), unit=code, note=note)
    limit = limit * catalog.rates[code]
    column = at_most("price", sum(price for price in prices if not isnan(price)), limit)
    if not lacking:
        return replace(column.at((), "budget"), unit=catalog.currency)
    left = show(max(limit - float(column.demand), 0.0), catalog.currency, "price")
    note = f"at least: no price is known of {', '.join(lacking)}, for which {left} is left"
    unknown = column._replace(passed=column.passed & False)
    return replace(unknown.at((), "budget"), unit=catalog.currency, note="" if column.failed else note)


def _price(catalog: Catalog, part: Any, pieces: int) -> float:
    """The price of one of so many pieces in the currency of comparison; of a part of another axis as it was chosen."""
    section = section_of(part)
    if part.part not in catalog.table(section).rows:
        return float(part.price)
    price = price_of(catalog, section, part.part, pieces)
    return price.amount * catalog.rates.get(price.currency, nan) if price else nan


# --- mass


@dataclass(frozen=True, slots=True, kw_only=True)
class MassBudget:
    """Mass of a machine, part by part."""

    rows: tuple[MassRow, ...]
    limit: float = nan  # kg; NaN where there is none

    @property
    def known(self) -> float:
        """Sum of what is known [kg]."""
        return math.fsum(row.total for row in self.rows if not isnan(row.each))

    @property
    def guessed(self) -> float:
        """Sum of what is estimated [kg]; 0 where nothing is."""
        return math.fsum(row.total for row in self.rows if row.band)

    @property
    def estimated(self) -> tuple[str, ...]:
        """Parts of estimated mass."""
        return tuple(row.name for row in self.rows if row.band)

    @property
    def unknown(self) -> tuple[str, ...]:
        """Parts of unknown mass."""
        return tuple(row.name for row in self.rows if isnan(row.each))

    def probability(self, most: float) -> float:
        """Probability that the sum of what is known is at most so much [kg].

        Estimated masses are independent and log-normal; their sum is taken as log-normal with its mean and variance
        (L. Fenton, *The sum of log-normal probability distributions*, IRE Trans. Commun. Syst. 8, 1960).
        """
        left, mean, variance = most - (self.known - self.guessed), 0.0, 0.0
        for row in self.rows:
            if row.band:
                spread = (math.log(row.band[1] / row.band[0]) / (2.0 * END)) ** 2
                mean += row.total * math.exp(spread / 2.0)
                variance += row.total**2 * math.exp(spread) * math.expm1(spread)
        if left <= 0.0 or not variance:
            return float(left >= 0.0)
        spread = math.log1p(variance / mean**2)
        return NormalDist(math.log(mean) - spread / 2.0, math.sqrt(spread)).cdf(math.log(left))

    def checks(self, sized_for: float | None = None) -> tuple[Check, ...]:
        """The known mass against the limit, and against the mass that the drive is sized for."""
        low, high = (math.fsum(row.ends[k] for row in self.rows if not isnan(row.each)) for k in (0, 1))
        middle, *ends = (
            mass_columns(np.array([mass]), bool(self.unknown), self.limit, sized_for)
            for mass in (self.known, low, high)
        )
        if self.estimated:
            middle = [over_ends(mid, pair, np.array([0])) for mid, *pair in zip(middle, *ends, strict=True)]
        checks = []
        for check in (column.at(0, "budget") for column in middle):
            if check.status == "unknown":
                checks.append(replace(check, note=f"unknown: {', '.join(dict.fromkeys(self.unknown))}"))
            elif check.status == "open":  # from where on, and how probable it is that it holds
                room = check.limit / (1.0 + check.needed) - (self.known - self.guessed)
                note = f"passes where {', '.join(dict.fromkeys(self.estimated))}, which are estimated, have at most "
                note += f"{show(room, check.unit, 'mass', 2)} together"
                checks.append(replace(check, probability=self.probability(check.limit), note=note))
            else:
                checks.append(check)
        return tuple(checks)

    def figures(self) -> tuple[Figure, ...]:
        """The sum of what is known, and what the limit leaves beside it."""
        left = {} if isnan(self.limit) else {"mass_left": self.limit - self.known}
        words = "known or estimated" if self.estimated else "known"
        return figures_of("mass", {"mass_known": self.known} | left, known=words)


def mass_columns(known: Alike, lacking: Alike, limit: float | None, sized_for: float | None) -> list[CheckColumn]:
    """The known mass against the limits, as columns."""
    limits = {"mass": nan if limit is None else limit, "mass_sized_for": nan if sized_for is None else sized_for}
    mass = no_less(known, ~np.asarray(lacking, bool))
    return [at_most(name, mass, most) for name, most in limits.items() if not isnan(most)]


def drive_rows(
    drive_set: DriveParts, sets: int, catalog: Catalog | None = None, belt: float | None = None, encoder: bool = True
) -> tuple[MassRow, ...]:
    """Masses of the parts of several drives of one kind; estimates count where the catalogue has their bands."""
    rows, estimates = list[MassRow](), catalog is not None and bool(catalog.ends)
    for role, part in drive_set.parts.items():
        if part is None and role == "encoder" and not encoder:
            continue
        mass, band = (nan if part is None else part.mass), None
        if part is None and estimates and role in ("encoder", "controller"):  # that no catalogue lists
            mass, low, high = assumed_mass(_SECTIONS[role])
            band = low, high
        elif part is not None and catalog is not None and role in _SECTIONS:
            section = _SECTIONS[role]
            estimate = catalog.estimate_of(section, catalog.table(section).rows[part.part], "mass")
            band = estimate[1:3] if estimate else None
        rows.append(MassRow(name=role, number=sets, each=mass, band=band))
    if drive_set.belt_ratio != 1.0 and drive_set.belt_drive is None:
        mass, band = (belt, None) if belt is not None else BELT if estimates else (nan, None)
        rows.append(MassRow(name="belt and pulleys", each=mass, number=sets, band=band))
    return tuple(rows)


def machine_mass(
    budget: Budget, drive: Sequence[MassRow], *, platform: Platform | None = None, battery: float | None = None
) -> MassBudget:
    """The mass budget of a machine with given rows of its drives."""
    rows = [*drive, MassRow(name="structure", each=nan if budget.structure is None else budget.structure)]
    if battery is not None:
        rows.append(MassRow(name="battery", each=battery))
    for item in budget.others:
        name = item.name if item.number == 1 else f"{item.number} x {item.name}"
        rows.append(MassRow(name=name, each=item.mass * item.number))
    rows += [MassRow(name=payload.name, each=payload.mass) for payload in (platform.payloads if platform else ())]
    return MassBudget(rows=tuple(rows), limit=nan if budget.mass is None else budget.mass)


# --- where the drive's mass counts

_HEAVIEST = 1e6  # kg of a machine in the next round, beyond which no drive is looked for


class Settled(NamedTuple):
    """Result of the rounds."""

    total: float  # kg that the drive was sized for; where none carries itself, in the last round
    carries_itself: bool
    words: str  # how it ended, as a sentence


def settle(sized: Sized, base: float, *, tolerance: float = 1e-3, most: int = 40) -> Settled:
    """The mass at which a drive carries itself: m = base + drive(m), by going round.

    Examples
    --------
    A drive of 1 kg and 5 % of the machine, 20 kg without it: 21 / 0.95.

    >>> found = settle(lambda mass: 1.0 + 0.05 * mass, 20.0, tolerance=1e-9)
    >>> found.carries_itself, round(found.total, 6)
    (True, 22.105263)
    """
    rounds, total = list[tuple[float, float]](), base  # masses that were sized for, and of the drive

    def kg(mass: float) -> str:
        return show(mass, "kg", "mass")

    while len(rounds) < most:
        drive = sized(total)
        if drive is None:
            return Settled(total, False, f"No set carries itself: at {kg(total)} none is left.")
        if isnan(drive):
            return Settled(total, False, f"The mass of the set for {kg(total)} is unknown.")
        rounds.append((total, drive))
        last, total = total, base + drive
        if abs(total - last) <= tolerance:
            after = f"{len(rounds)} round{'s' if len(rounds) > 1 else ''}"
            return Settled(last, True, f"Settled after {after}: {kg(total)}, of it {kg(drive)} drive.")
        earlier = [n for n, (mass, _) in enumerate(rounds) if abs(total - mass) <= tolerance]
        if earlier:
            cycle = rounds[earlier[0] :]
            heaviest, own = max(
                cycle, key=lambda masses: masses[0]
            )  # what comes after it is lighter, or it would not be
            words = f"{len(cycle)} sets follow each other; taken is the one for the heaviest machine, "
            return Settled(heaviest, True, f"{words}{kg(heaviest)}, of which it leaves {kg(heaviest - base - own)}.")
        if total > _HEAVIEST:
            words = f"No set carries itself within {kg(_HEAVIEST)}: the next would make {kg(total)}."
            return Settled(last, False, words)
    words = f"Not settled in {most} rounds, though they draw near: {kg(total)} at the end."
    growth = [abs(after[1] - before[1]) for before, after in pairwise(rounds[-3:])]
    if len(growth) == 2 and growth[1] >= growth[0]:
        words = "No set carries itself: each round adds no less mass than the one before."
    return Settled(last, False, words)


# --- the machine with a drive in it


def mass_budget(
    budget: Budget, drives: Sequence[tuple[Problem, DriveParts]], battery: Battery | None, catalog: Catalog
) -> MassBudget:
    """The mass budget of a machine with its drives, of one axis or of several, and the payloads of its platform."""
    rows = [row for problem, drive in drives for row in rows_of_drive(problem, drive)]
    platform = next((problem.spec.platform for problem, _ in drives if problem.spec.platform), None)
    return machine_mass(budget, rows, platform=platform, battery=mass_of(battery, catalog))


class MachineBudget(NamedTuple):
    """A machine with a drive in it against its budgets; empty where the spec has none."""

    checks: tuple[Check, ...] = ()
    figures: tuple[Figure, ...] = ()
    masses: tuple[MassRow, ...] = ()
    energy: EnergyBudget | None = None  # of the load case in which the battery lasts least
    braking: BrakingBudget | None = None  # where the spec limits what is regenerated or what the supply delivers


def check_battery(spec: RobotSpec, catalog: Catalog) -> None:
    """Refuse a battery that no catalogue lists, before the search."""
    with located(spec):
        mass_of(spec.battery, catalog)


def machine_requirements(spec: RobotSpec, *, figures: bool = True) -> MachineBudget | None:
    """Requirements, and room, footing and grip of a platform, which are the same whatever drives it; None without."""
    if spec.platform is None and spec.requirements is None:
        return None
    from drivesizer.machine.platform_budget import worst_case_budget

    return MachineBudget(*worst_case_budget(spec, figures=figures))


def machine_budget(
    problem: Problem, drive: DriveParts, machine: MachineBudget | None = None, *, figures: bool = True
) -> MachineBudget:
    """The machine with a drive in it, against its budgets: with what is required of it whatever drives it."""
    spec, catalog = problem.spec, problem.catalog
    checks, own, masses = list[Check](), list[Figure](), tuple[MassRow, ...]()
    if spec.budget and spec.budget.weighs:
        load, mass = problem.machine.load, mass_budget(spec.budget, [(problem, drive)], spec.battery, catalog)
        checks += mass.checks(load.mass if isinstance(load, WheeledVehicle) else None)
        own += mass.figures()
        masses = mass.rows
    if machine:
        checks += machine.checks
        own += machine.figures
    fed = spec.battery or problem.machine.limits_the_bus
    feeds = on_its_supply(problem, drive, figures=figures) if fed else MachineBudget()
    checks += feeds.checks
    if spec.supply.stalled and not spec.on_common_bus:
        checks.append(stall_check(spec.supply, [(spec, drive)]))
    if spec.budget and spec.budget.price is not None:
        checks.append(price_check(spec.budget.price, [(problem, drive)], spec.supply, feeds.braking, catalog))
    return MachineBudget(tuple(checks), tuple(own), masses, feeds.energy, feeds.braking)


def feeds_of(
    spec: RobotSpec, catalog: Catalog, cases: Sequence[CommonBus], *, figures: bool = True
) -> MachineBudget:  # fmt: skip
    """Battery, brake resistor and power supply of a machine, of one axis or of several, in its load cases."""
    if spec.battery is None:
        volts = (axis.drive_set.controller.supply_max for axis in cases[0].axes if axis.drive_set.controller)
        withstood = min(
            (voltage for voltage in volts if not isnan(voltage)), default=nan
        )  # the least of any controller
        on_battery = spec.supply.kind == "battery"
        braking = None if on_battery else bus_budget(spec, catalog, [case.on_bus for case in cases], withstood)
        return MachineBudget(braking=braking, checks=braking.checks if braking else ())
    energies = [(case.on_bus.case, energy_budget(case.on_bus, case.axes, catalog, figures=figures)) for case in cases]
    least = min((energy for _, energy in energies), key=lambda energy: (not isnan(energy.autonomy), energy.autonomy))
    return MachineBudget(energy=least, checks=worst_of_cases([(name, energy.checks) for name, energy in energies]))


def on_its_supply(problem: Problem, drive: DriveParts, *, figures: bool = True) -> MachineBudget:
    """Supply, battery and brake resistor of a machine of one axis with a drive."""
    axis = AxisPower("", problem, drive)
    cases = [(problem.name_of(numbers), problem.cases[numbers[0]].spec) for numbers in problem.machine_cases]
    buses = [common_bus(name, spec, [axis], synchronised=True, cycle_time=None) for name, spec in cases]
    return feeds_of(problem.machine, problem.catalog, buses, figures=figures)


def stall_current(spec: RobotSpec, drive: DriveParts) -> float:
    """Current out of the supply for one drive that stalls with a cold winding, at the nominal voltage [A].

    The winding takes what the stage applies over its resistance, or what the controller lets through, or the printed
    stall current where that is less, as of motors with electronics inside; of it the supply gives R I² and what the
    stage loses.
    """
    motor, controller, volts = drive.motor, drive.controller, spec.supply.nominal
    feed = spec.feed_of(controller)._replace(voltage=volts)
    cold = float(resistance_at(resistance_25(motor), spec.environment.ambient))
    permitted = controller.peak_current if controller else nan
    limits = [feed.applied / cold, motor.stall_current * volts / motor.nominal_voltage, permitted]
    current = float(np.fmin.reduce(limits))
    lost = float(np.nan_to_num(feed.lost(current)) + np.nan_to_num(feed.stage.standby))
    return (current**2 * cold + lost) / volts


def stall_check(supply: Supply, drives: Iterable[tuple[RobotSpec, DriveParts]]) -> Check:
    """The current of all drives of some axes stalled at once against what the supply delivers."""
    current = math.fsum(spec.load.motors * stall_current(spec, drive) for spec, drive in drives)
    limit = nan if supply.most_current is None else supply.most_current
    return at_most("supply_stall", current, limit).at((), "budget")


def rows_of_drive(problem: Problem, drive: DriveParts) -> tuple[MassRow, ...]:
    """Masses of all drives of a machine, by part."""
    spec = problem.spec
    belt = spec.belt.mass if spec.belt else None
    rows = drive_rows(drive, spec.load.motors, problem.catalog, belt, spec.wants_encoder)
    if spec.gear is None:
        return rows
    mass = nan if spec.gear.mass is None else spec.gear.mass
    return *rows, MassRow(name=spec.gear.kind, each=mass, number=spec.load.motors)


def riding_rows(problem: Problem, drive: DriveParts) -> tuple[MassRow, ...]:
    """Masses of an axis' drives that ride on another, part by part: all but the controllers."""
    return tuple(row for row in rows_of_drive(problem, drive) if row.name != "controller")


def riding_unknown(problem: Problem, drive: DriveParts) -> tuple[str, ...]:
    """Parts of unknown mass among these."""
    return tuple(row.name for row in riding_rows(problem, drive) if isnan(row.each))


def riding_mass(problem: Problem, drive: DriveParts) -> float:
    """Mass of an axis' drives that ride on another [kg]: what is estimated at the upper end of its band."""
    return math.fsum(row.ends[1] for row in riding_rows(problem, drive) if not isnan(row.each))


def drive_mass(problem: Problem, drive: DriveParts) -> float:
    """Mass of all drives together that the machine must carry [kg]: what is estimated at the upper end of its band."""
    return math.fsum(row.ends[1] for row in rows_of_drive(problem, drive) if not isnan(row.each))


def mass_without_drive(spec: RobotSpec, catalog: Catalog) -> float:
    """Known mass of the machine beside its drive: structure, equipment, payloads, battery."""
    assert spec.budget is not None
    return machine_mass(spec.budget, (), platform=spec.platform, battery=mass_of(spec.battery, catalog)).known
