"""Mass and price of a machine, part by part, against their limits; and the mass at which a drive carries itself."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import isnan, nan
from statistics import NormalDist
from typing import Any, Literal, NamedTuple

from drivesizer.catalog import Catalog
from drivesizer.catalog.estimates.estimate import assumed_mass
from drivesizer.catalog.tolerances import END
from drivesizer.errors import InputError
from drivesizer.results.check import Check
from drivesizer.results.check_columns import at_most
from drivesizer.results.drive_set import DriveParts, MassRow
from drivesizer.results.problem import Problem
from drivesizer.units import show

__all__ = [
    "BELT", "BY_PIECES", "MassBudget", "drive_rows", "mass_budget", "of_drives", "of_supply", "price_check", "settle",
]  # fmt: skip


# -- Price of all drives of a machine and of what feeds them, against its limit.


Item = tuple[str, Any, int]  # role, part or None where none is known, and how many
BY_PIECES = (("price_20", 20), ("price_5", 5))


def of_drives(problem: Problem, one: DriveParts) -> Iterator[Item]:
    """The parts of all drives of one kind that are to be bought."""
    spec = problem.spec
    needless = "encoder" if one.encoder is None and not spec.wants_encoder else ""
    parts = {role: part for role, part in one.parts.items() if role != needless}
    unknown = ["brake"] * (spec.names_brake and one.brake is None)
    unknown += ["belt and pulleys"] * (one.belt_ratio != 1.0 and one.belt_drive is None)
    unknown += [spec.gear.kind] if spec.gear else []
    for role, part in (*parts.items(), *((role, None) for role in unknown)):
        yield role, part, spec.load.motors


def of_supply(part: str | None, resistor: Any, catalog: Catalog) -> Iterator[Item]:
    """Power supply and brake resistor of a machine, as far as they are out of catalogues."""
    if part is not None:
        yield "power supply", catalog.power_supplies.record(catalog.power_supplies.rows[part]), 1
    if resistor is not None and resistor.part:
        yield "brake resistor", resistor, 1


def price_check(items: Sequence[Item], limit: float) -> Check:
    """The known prices of what is bought against what it may cost."""
    pieces, prices = Counter[str](), list[float]()
    for _, part, number in items:
        if part is not None:
            pieces[part.part] += number
    for _, part, number in items:
        columns = [name for name, least in BY_PIECES if part is not None and pieces[part.part] >= least]
        each = [getattr(part, name, nan) for name in (*columns, "price")]
        prices.append(number * next((price for price in each if not isnan(price)), nan))
    lacking = dict.fromkeys(role for (role, *_), price in zip(items, prices, strict=True) if isnan(price))
    column = at_most("price", sum(price for price in prices if not isnan(price)), limit)
    if not lacking:
        return column.at((), "budget")
    left = show(max(limit - float(column.demand), 0.0), "EUR", "price")
    note = f"at least: no price is known of {', '.join(lacking)}, for which {left} is left"
    unknown = replace(column, passed=column.passed & False)
    return replace(unknown.at((), "budget"), note="" if column.failed else note)


# -- Mass of a machine, part by part, against its limit; and the mass at which a drive carries itself.
#
# A mass that no data sheet gives is estimated, with a band. One that has no estimate either has a row of its own and
# no figure: the sum is that of what is known, and may break a limit but not keep it. Where the drive's own mass
# counts, a heavier machine may need a heavier drive: ``settle`` goes round until a drive carries itself.


Sized = Callable[[float], tuple[float, Hashable] | None]  # mass of the whole [kg] to mass of the drive and its name
_GRAM = 1e-3  # kg
_SECTIONS = {"motor": "motors", "gearhead": "gearheads", "encoder": "encoders", "controller": "controllers",
             "actuator": "actuators", "brake": "brakes"}  # fmt: skip
BELT = (0.15, (0.05, 0.45))  # kg, of belt and two pulleys of a ratio alone: assumed, a factor of 3 either way
_HEAVIEST = 1e6  # kg, beyond which masses run away


# --- rows -------------------------------------------------------------------------------------------------------------


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
    def ends(self) -> tuple[float, float]:
        """Sum of what is known, at both ends of all bands [kg]."""
        low, high = (math.fsum(row.ends[k] for row in self.rows if not isnan(row.each)) for k in (0, 1))
        return low, high

    @property
    def estimated(self) -> tuple[str, ...]:
        """Parts of estimated mass."""
        return tuple(row.name for row in self.rows if row.band)

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

    @property
    def unknown(self) -> tuple[str, ...]:
        """Parts of unknown mass."""
        return tuple(row.name for row in self.rows if isnan(row.each))

    @property
    def total(self) -> float:
        """Sum of all [kg]; NaN while something is unknown."""
        return nan if self.unknown else self.known

    @property
    def left(self) -> float:
        """Mass that the limit leaves beside the known masses [kg]; NaN without a limit."""
        return self.limit - self.known


def drive_rows(
    drive_set: DriveParts, sets: int, catalog: Catalog | None = None, belt: float | None = None, encoder: bool = True
) -> tuple[MassRow, ...]:
    """Masses of the parts of several drives of one kind; estimates count where the catalogue has their bands."""
    rows, estimates = list[MassRow](), catalog is not None and bool(catalog.ends)
    for role, part in drive_set.parts.items():
        if part is None and role == "encoder" and not encoder:
            continue
        each, band = (nan if part is None else part.mass), None
        if part is None and estimates and role in ("encoder", "controller"):  # that no catalogue lists
            each, low, high = assumed_mass(_SECTIONS[role])
            band = low, high
        elif part is not None and catalog is not None and role in _SECTIONS:
            section = _SECTIONS[role]
            found = catalog.estimate_of(section, catalog.table(section).rows[part.part], "mass")
            band = found[1:3] if found else None
        rows.append(MassRow(name=role, number=sets, each=each, band=band))
    if drive_set.belt_ratio != 1.0 and drive_set.belt_drive is None:
        each, band = (belt, None) if belt is not None else BELT if estimates else (nan, None)
        rows.append(MassRow(name="belt and pulleys", each=each, number=sets, band=band))
    return tuple(rows)


def mass_budget(
    drive: Sequence[MassRow],
    *,
    structure: float | None = None,
    battery: float | None = None,
    others: Sequence[tuple[str, float]] = (),
    limit: float | None = None,
) -> MassBudget:
    """The rows of a machine."""
    rows = [*drive, MassRow(name="structure", each=nan if structure is None else structure)]
    if battery is not None:
        rows.append(MassRow(name="battery", each=battery))
    rows += [MassRow(name=name, each=mass) for name, mass in others]
    for row in rows:
        if row.each < 0.0 or row.each == math.inf:
            raise InputError(f"budget: the mass of {row.name} must be 0 or more, got {row.each:g} kg")
    return MassBudget(rows=tuple(rows), limit=nan if limit is None else limit)


# --- where the drive's mass counts ------------------------------------------------------------------------------------


class Step(NamedTuple):
    """One round: a machine of this mass takes that drive."""

    total: float  # kg, that was sized for
    drive: float  # kg, of the drive that carries it; NaN where none does, or it is unknown
    key: Hashable  # which it is; None where none does


_NONE = Step(nan, nan, None)


@dataclass(frozen=True, slots=True, kw_only=True)
class Settled:
    """Result of the rounds."""

    status: Literal["settled", "cycle", "none", "unknown", "open"]
    total: float  # kg that the drive was sized for; NaN where none carries itself
    drive: float  # kg
    key: Hashable
    steps: tuple[Step, ...]
    words: str  # how it ended, as a sentence

    @property
    def carries_itself(self) -> bool:
        """Whether there is a drive that carries the machine and itself."""
        return self.status in ("settled", "cycle")


def settle(
    sized: Sized, base: float, *, first: float = 0.0, tolerance: float = _GRAM, limit: float = _HEAVIEST, most: int = 40
) -> Settled:
    """The mass at which a drive carries itself: m = base + drive(m), by going round.

    Examples
    --------
    A drive of 1 kg and 5 % of the machine, 20 kg without it: 21 / 0.95.

    >>> found = settle(lambda mass: (1.0 + 0.05 * mass, "a"), 20.0, tolerance=1e-9)
    >>> found.status, round(found.total, 6)
    ('settled', 22.105263)
    """
    for name, mass in (("base", base), ("first", first)):
        if not 0.0 <= mass < math.inf:
            raise InputError(f"{name}: expected a mass of 0 kg or more, got {mass!r}")
    steps, total = list[Step](), base + first

    def ended(status: Literal["settled", "cycle", "none", "unknown", "open"], words: str, at: Step = _NONE) -> Settled:
        return Settled(status=status, total=at.total, drive=at.drive, key=at.key, steps=tuple(steps), words=words)

    while len(steps) < most:
        found = sized(total)
        if found is not None and (found[0] < 0.0 or found[0] == math.inf):
            raise InputError(f"the mass of a drive must be 0 kg or more, got {found[0]!r}")
        steps.append(last := Step(total, *(found or (nan, None))))
        if last.key is None:
            return ended("none", f"No set carries itself: at {_kg(total)} none is left.")
        if isnan(last.drive):
            return ended("unknown", f"The mass of the set for {_kg(total)} is unknown.")
        total = base + last.drive
        if abs(total - last.total) <= tolerance:
            rounds = f"{len(steps)} round{'s' if len(steps) > 1 else ''}"
            return ended("settled", f"Settled after {rounds}: {_kg(total)}, of it {_kg(last.drive)} drive.", last)
        earlier = [i for i, step in enumerate(steps) if abs(total - step.total) <= tolerance]
        if earlier:
            cycle = steps[earlier[0] :]
            heaviest = max(cycle, key=lambda step: step.total)  # what comes after it is lighter, or it would not be
            words = f"{len(cycle)} sets follow each other; taken is the one for the heaviest machine, "
            words += f"{_kg(heaviest.total)}, of which it leaves {_kg(heaviest.total - base - heaviest.drive)}."
            return ended("cycle", words, heaviest)
        if total > limit:
            return ended("none", f"No set carries itself within {_kg(limit)}: the next would make {_kg(total)}.")
    growth = [abs(b.drive - a.drive) for a, b in zip(steps[-3:], steps[-2:], strict=False)]
    if len(growth) == 2 and growth[1] >= growth[0]:
        return ended("none", "No set carries itself: each round adds no less mass than the one before.")
    return ended("open", f"Not settled in {most} rounds, though they draw near: {_kg(total)} at the end.")


def _kg(mass: float) -> str:
    return show(mass, "kg", "mass")
