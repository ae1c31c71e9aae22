"""Tolerances of catalogue figures: classes, their distributions, what makers state, factors of samples."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import CatalogError, InputError, quoted
from drivesizer.files.text import listed
from drivesizer.units import number

# -- Distributions of an uncertain figure, evaluated as columns.
#
# All distributions are bounded. A normal one is truncated 4 standard deviations from its mean, beyond which 6 of
# 100 000 values would lie: a tolerance does not include them, and a mass could be negative there.


Array = NDArray[np.float64]
CUT = 4.0  # standard deviations from the mean, at which a normal distribution ends
END = 1.6448536269514722  # standard deviations from the median to the 5th and to the 95th percentile
_TAIL = 3.167124183311986e-05  # of a standard normal distribution, below -CUT


def lognormal(low: Any, median: Any, high: Any, deviations: Array) -> Array:
    """Values of a log-normal figure whose sides have deviations of their own.

    Examples
    --------
    >>> lognormal(0.5, 1.0, 4.0, np.array([-1.6448536269514722, 0.0, 1.6448536269514722])).round(9)
    array([0.5, 1. , 4. ])
    >>> lognormal(0.5, 1.0, np.inf, np.array([1.6448536269514722])).round(9)
    array([2.])
    """
    up, down = np.divide(high, median), np.divide(median, low)
    up, down = np.where(np.isinf(high), down, up), np.where(np.isinf(low), up, down)
    return np.asarray(median * np.where(deviations > 0.0, up, down) ** (deviations / END))


def deviations_at(share: Array) -> Array:
    """Standard deviations from the mean below which given shares of a normal figure's values lie, cut at ``CUT``.

    Examples
    --------
    >>> deviations_at(np.array([0.0, 0.5, 1.0])).round(9) + 0.0
    array([-4.,  0.,  4.])
    """
    from scipy.special import ndtri

    return ndtri(np.clip(_TAIL + share * (1.0 - 2.0 * _TAIL), _TAIL, 1.0 - _TAIL))


class Distribution(NamedTuple):
    """A figure's values: uniform between ends, triangular with a peak, or normal with its mean and deviation.

    A log-normal one has its ends as 5th and 95th percentile and its peak as median; either side has its own deviation.
    """

    shape: Literal["uniform", "normal", "triangular", "lognormal"]
    low: float
    high: float
    peak: float  # of the density; the middle of a uniform one

    @property
    def by_deviations(self) -> bool:
        """Whether its values come of standard deviations."""
        return self.shape in ("normal", "lognormal")

    def at(self, share: Array, deviations: Array | None = None) -> Array:
        """The values below which given shares of all values lie: the inverse of the distribution function.

        Examples
        --------
        >>> Distribution("triangular", 0.0, 4.0, 1.0).at(np.array([0.0, 0.25, 1.0]))
        array([0., 1., 4.])
        """
        a, b, c = self.low, self.high, self.peak
        if self.shape == "uniform":
            return a + share * (b - a)
        if self.by_deviations:
            deviations = deviations_at(share) if deviations is None else deviations
            if self.shape == "lognormal":
                return lognormal(a, c, b, deviations)
            return np.clip(c + (b - a) / (2 * CUT) * deviations, a, b)
        rising = share * (b - a) * (c - a)
        falling = (1.0 - share) * (b - a) * (b - c)
        return np.where(share * (b - a) < c - a, a + np.sqrt(rising), b - np.sqrt(falling))


# -- Tolerances of catalogue figures, as shares of what is printed.


def share(text: str) -> Distribution | None:
    """A tolerance of a catalogue figure, as a factor: ``+- 7 %``, ``-10 %..30 %``, ``normal(5 %)``; None for ``none``.

    ``0.5..1.1 times`` are the 5th and 95th percentile of a log-normal factor whose median is 1, or stands between them.

    Examples
    --------
    >>> share("+- 7 %").high
    1.07
    >>> share("0.7..0.9..1.1 times").peak
    0.9
    """
    bare = text.strip()
    if bare == "none":
        return None
    hint = "expected +- 7 %, -10 %..30 %, 0.5..1.1 times, normal(5 %) or none"
    width = re.fullmatch(r"(?:\+\s?/?\s?[-−]|±)\s*(.+?)", bare)
    ends, normal = re.fullmatch(r"(.+?)\s*\.\.\s*(.+?)(\s+times)?", bare), re.fullmatch(r"normal\(\s*(.+?)\s*\)", bare)
    try:
        if width or normal:
            half = _per_cent((width or normal)[1])  # type: ignore[index]
            distribution = (
                Distribution("normal", 1.0 - CUT * half, 1.0 + CUT * half, 1.0) if normal
                else Distribution("uniform", 1.0 - half, 1.0 + half, 1.0)
            )  # fmt: skip
        elif ends and ends[3]:
            middle, _, last = ends[2].rpartition("..")
            (low, *units), (peak, unit), (high, other) = number(ends[1]), number(middle or "1"), number(last)
            if any((*units, unit, other)) or not low < peak < high:
                raise InputError(f"{quoted(text)}: the median, {peak:g}, must be between two plain numbers")
            distribution = Distribution("lognormal", low, high, peak)
        elif ends:
            low, high = 1.0 + _per_cent(ends[1]), 1.0 + _per_cent(ends[2])
            distribution = Distribution("uniform", low, high, (low + high) / 2.0)
        else:
            raise InputError(f"{quoted(text)} is no tolerance of a catalogue figure")
    except InputError as error:
        raise InputError(f"{error}; {hint}") from None
    if not distribution.low < distribution.high:
        raise InputError(f"{quoted(text)}: a width must be above 0; {hint}")
    if not distribution.low > 0.0:
        raise InputError(f"{quoted(text)} reaches 0 and below, which no such figure is; {hint}")
    return distribution


def _per_cent(text: str) -> float:
    value, unit = number(text)
    if unit not in ("%", ""):
        raise InputError(f"{quoted(unit)} is not per cent")
    return value / 100.0 if unit == "%" else value


# -- Tolerance classes of catalogue figures: the defaults, and those that a maker or a spec puts in their place.
#
# A class is a distribution of factors of the printed figure. Figures that belong together share one: the two thermal
# resistances of a motor with their time constants, so that heat capacities stay what they are; friction at any speed
# and with it, and the no-load current that includes both.


_PER_STAGE = 4.0  # ratio of a pair of spur gears, where the number of stages is unknown
_PER_PAIR, _PLASTIC = 0.9, 0.87  # efficiency, and the least of plastic ones
_PAIRS = 4.0  # of a spur gear whose ratio is unknown


class _Default(NamedTuple):
    """A line of ``tolerances.txt``."""

    part: str  # motor, gearhead or controller
    figure: str
    title: str
    of: str  # steppers, or others; empty: of all
    tolerance: str
    why: str
    help: str = ""  # in the section of a spec


_TABLE = [(head, _Default(*cells)) for head, cells in listed("drivesizer.catalog", "tolerances.txt")]
CLASSES = {(row.part, row.figure): row for head, row in _TABLE if head == "classes"}
OF_STEPPERS, NOT_OF_STEPPERS = ({key for key, row in CLASSES.items() if row.of == of} for of in ("steppers", "others"))


class Class(NamedTuple):
    """Tolerance of one kind of catalogue figure."""

    part: str  # motor, gearhead or controller
    figure: str
    title: str
    text: str  # as written
    factor: Distribution | None  # of the printed figure; None: taken as printed
    why: str
    whose: str = ""  # a maker, maybe with families: of its parts alone; else of all that have none of their own

    @property
    def name(self) -> str:
        """``motor.resistance``; with whose it is where it is of a maker."""
        return f"{self.part}.{self.figure}" + (f" ({self.whose})" if self.whose else "")


@cache
def class_of(part: str, figure: str, text: str, why: str, whose: str = "") -> Class:
    """The class of a figure."""
    title = CLASSES[part, figure].title + (f", {whose}" if whose else "")
    return Class(part, figure, title, text, share(text), why, whose)


def _instead(head: str, figure: str) -> _Default:
    return next(row for of, row in _TABLE if (of, row.figure) == (head, figure))


def resistance_from_stall() -> Class:
    """The class of a resistance that is nominal voltage over stall current."""
    default = _instead("from stall", "resistance")
    return class_of("motor", "resistance", default.tolerance, default.why, "from no load and stall")


def losses_identified() -> Class:
    """The class of a gear's losses where its efficiency is that of an identified friction."""
    default = _instead("identified", "efficiency")
    return class_of("gearhead", "efficiency", default.tolerance, default.why, "identified in motion")


def pairs_of(ratio: Any, stages: Any) -> Array:
    """Pairs of a spur gear: its stages, or of 4:1 each; 4 where its ratio is unknown too."""
    of_ratio: Array = np.nan_to_num(np.maximum(1.0, np.round(np.log(ratio) / np.log(_PER_STAGE))), nan=_PAIRS)
    return np.where(np.asarray(stages) > 0.0, stages, of_ratio)


def usual_of_spur_gears(ratio: Any, stages: Any) -> Array:
    """Usual efficiency of spur gears: a tenth of the power is lost in each pair.

    References
    ----------
    .. [1] F. Faulhaber, A second look at gearbox efficiencies, Machine Design, 20 June 2002.
    .. [2] Citizen Micro, Gear motors, technical information: 90 % a stage of spur gears.
    """
    return np.asarray(_PER_PAIR ** pairs_of(ratio, stages))


def losses_from_stall(part: str, efficiency: float, ratio: float, stages: float) -> Class:
    """The class of a spur gear's losses where its efficiency follows from the stall torque."""
    default = _instead("from stall", "efficiency")
    usual = share(default.tolerance)
    assert usual is not None
    plastic = (float(_PLASTIC ** -pairs_of(ratio, stages)) - 1.0) / (1.0 / efficiency - 1.0)
    text = f"{usual.low:g}..{max(usual.high, plastic):.3g} times"
    return class_of("gearhead", "efficiency", text, default.why, part)


def classes(tolerances: Mapping[tuple[str, str], str] | None = None) -> tuple[Class, ...]:
    """The classes for parts whose maker states no tolerance, in a fixed order.

    Examples
    --------
    >>> rows = classes({("motor", "resistance"): "+- 7 %", ("motor", "friction"): "none"})
    >>> [(row.text, row.why) for row in rows if row.why == "given in the spec"]
    [('+- 7 %', 'given in the spec'), ('none', 'given in the spec')]
    """
    own = {key: (text, "given in the spec") for key, text in (tolerances or {}).items()}
    return tuple(class_of(*key, *own.get(key, (row.tolerance, row.why))) for key, row in CLASSES.items())


# -- Tolerances that makers state for their figures, by maker and family.
#
# A statement holds for the maker's parts in every catalogue file. One that names families holds for these alone and
# takes precedence over one that names none.


TOLERANCES = "tolerances"  # the section of a catalogue file


class MakerTolerance(NamedTuple):
    """Tolerance of a catalogue figure as its maker states it."""

    part: str  # motor or gearhead
    figure: str
    tolerance: str  # of the printed figure, as written
    maker: str
    families: tuple[str, ...]  # empty: all of the maker's
    text: str  # a remark
    source: int  # index into Catalog.sources


def maker_tolerances_of(
    stated: Sequence[MakerTolerance], part: str, maker: str, family: str
) -> dict[str, MakerTolerance]:
    """Tolerances that a maker states for a part, by figure."""
    mine = [tolerance for tolerance in stated if (tolerance.part, tolerance.maker) == (part, maker)]
    general = {tolerance.figure: tolerance for tolerance in mine if not tolerance.families}
    return general | {tolerance.figure: tolerance for tolerance in mine if family in tolerance.families}


def owner_of(stated: Sequence[MakerTolerance], tolerance: MakerTolerance) -> str:
    """Maker, and families where that maker states another tolerance for others."""
    key = tolerance.part, tolerance.figure, tolerance.maker
    several = sum((other.part, other.figure, other.maker) == key for other in stated) > 1
    return f"{tolerance.maker} {', '.join(tolerance.families)}".strip() if several else tolerance.maker


def join_maker_tolerances(
    by_catalog: Sequence[tuple[str, Sequence[MakerTolerance], bool]], first_source: Sequence[int]
) -> tuple[tuple[MakerTolerance, ...], tuple[str, ...]]:
    """Tolerances of several catalogues as one, and a message for each that was replaced."""
    tolerances: list[tuple[str, MakerTolerance]] = []
    messages: list[str] = []
    for (name, stated, overrides), first in zip(by_catalog, first_source, strict=True):
        before, tolerances = tolerances, []
        for other, theirs in before:
            mine = next((tolerance for tolerance in stated if _same_figure(theirs, tolerance, overrides)), None)
            if mine and not overrides:
                raise CatalogError(
                    f"the tolerance of {_named(mine)} is in two catalogues: {other} and {name}; "
                    "`overrides: true` in the second makes its own count"
                )
            if mine:
                messages.append(f"tolerance of {_named(mine)}: {name} in place of {other}")
            tolerances += [(other, tolerance) for tolerance in _remaining(theirs, stated, overrides)]
        tolerances += [(name, tolerance._replace(source=tolerance.source + first)) for tolerance in stated]
    return tuple(tolerance for _, tolerance in tolerances), tuple(messages)


def _named(tolerance: MakerTolerance) -> str:
    return f"{tolerance.maker} {tolerance.part} {tolerance.figure.replace('_', ' ')}"


def _same_figure(tolerance: MakerTolerance, later: MakerTolerance, overrides: bool) -> bool:
    """Whether a later tolerance is of the same figure and parts; one of all families overrides those of some."""
    if tolerance[:2] != later[:2] or tolerance.maker != later.maker:
        return False
    if tolerance.families and later.families:
        return bool(set(tolerance.families) & set(later.families))
    return not later.families and (overrides or not tolerance.families)


def _remaining(tolerance: MakerTolerance, stated: Sequence[MakerTolerance], overrides: bool) -> list[MakerTolerance]:
    """The part of a tolerance that later ones leave: all of it, or that of the families that they do not name."""
    later = [other for other in stated if _same_figure(tolerance, other, overrides)]
    if not later:
        return [tolerance]
    named = {family for other in later for family in other.families}
    left = tuple(family for family in tolerance.families if family not in named)
    return [tolerance._replace(families=left)] if left and all(other.families for other in later) else []
