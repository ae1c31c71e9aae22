"""A check and a figure as records, what several checks amount to, and how probable it is that they pass."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isnan, nan
from typing import Literal, NamedTuple

from drivesizer.files.text import listed
from drivesizer.physics.figures import Alike
from drivesizer.units import show

Status = Literal["pass", "fail", "open", "unknown"]  # open: estimated figures decide


GRAVEST: tuple[Status, ...] = ("fail", "unknown", "open", "pass")


Confidence = Literal["printed", "derived", "recalled", "estimated from peers", "assumed by class", "unbounded"]


class Origin(NamedTuple):
    """A figure that a check rests on and that no document prints, with whence it is."""

    part: str  # motor, gearhead, brake, encoder, controller
    figure: str  # column of the catalogue
    confidence: Confidence  # unbounded: nothing is known of it on the side that matters


class Band(NamedTuple):
    """A demand at the ends of the band of estimated figures that it rests on."""

    low: float  # SI
    high: float  # SI
    least_margin: float  # NaN where there is none


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One demand against one limit."""

    name: str  # stable
    title: str
    method: str  # paper, physics, budget or closed loop
    case: str = ""  # the load case in which it is worst; empty where there is one
    demand: float  # SI; for a required minimum, what is required
    limit: float  # SI; for a required minimum, what there is
    kind: str
    unit: str
    margin: float  # NaN where there is none
    needed: float = 0.0  # the margin that the spec requires
    status: Status
    at_time: float | None = None  # s, of the worst moment
    by_choice: bool = False  # the smallest sufficient part was taken: its margin says nothing of the load
    advice: bool = False  # informational: of a part that is not required; no drive fails on it
    note: str = ""  # what is compared with what
    band: Band | None = None  # where estimated figures change the demand
    probability: float = nan  # that it passes, where it is open
    turns_on: str = ""  # the estimated figure by which it passes or fails, where it is open; empty: several together
    origins: tuple[Origin, ...] = ()  # of the figures that it rests on, those that are not printed

    @property
    def is_comparable(self) -> bool:
        """Whether its margin depends on the load: not where it is unknown, of a selected part or informational."""
        return not (isnan(self.margin) or (self.by_choice and self.status == "pass") or self.advice)

    def with_unit(self, figure: float) -> str:
        """Demand or limit as it is printed."""
        return show(figure, self.unit, self.kind)


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """A figure that has no limit of its own."""

    name: str
    title: str
    value: float  # SI
    kind: str
    unit: str
    at_time: float | None = None  # s

    @property
    def text(self) -> str:
        """The value as it is printed."""
        return show(self.value, self.unit, self.kind)


_FIGURES: dict[str, dict[str, tuple[str, list[list[str]]]]] = {}  # by section
for _section, (_name, _title, _units) in listed("drivesizer.results", "figures.txt"):
    _FIGURES.setdefault(_section, {})[_name] = _title, [unit.split() for unit in _units.split(",")]


def declared_figure(name: str, *, rotary: bool = False, **words: str) -> tuple[str, str, str]:
    """Title, kind of quantity and unit of the first figure of a name, of a load along a line or one that turns."""
    title, units = next(section[name] for section in _FIGURES.values() if name in section)
    kind, unit = units[-1 if rotary else 0]
    return title.format_map(words), kind, unit


def figure(name: str, value: float, at_time: float | None = None, *, rotary: bool = False, **words: str) -> Figure:
    """A figure of ``figures.txt``, the first of that name."""
    title, kind, unit = declared_figure(name, rotary=rotary, **words)
    return Figure(name=name, title=title, value=value, kind=kind, unit=unit, at_time=at_time)


def figures_of(section: str | Sequence[str], values: Mapping[str, Alike], **words: str) -> tuple[Figure, ...]:
    """The figures of a section of ``figures.txt`` that have a value; of several sections as the last of them has it."""
    sections = [section] if isinstance(section, str) else section
    rows = {name: row for part in sections for name, row in _FIGURES[part].items()}
    return tuple(
        Figure(name=name, title=title.format_map(words), value=float(values[name]), kind=units[0][0], unit=units[0][1])
        for name, (title, units) in rows.items()
        if name in values
    )


def units_of(section: str, names: Iterable[str], *, rotary: bool) -> dict[str, tuple[str, str]]:
    """Kind of quantity and unit of some figures of a section, of a load along a line or one that turns."""
    kinds = {name: _FIGURES[section][name][1][-1 if rotary else 0] for name in names}
    return {name: (kind, unit) for name, (kind, unit) in kinds.items()}


def sentence_case(title: str) -> str:
    """A title within a sentence: its first letter small, abbreviations as they are.

    >>> sentence_case("Motor nominal current (RMS)"), sentence_case("RMS torque")
    ('motor nominal current (RMS)', 'RMS torque')
    """
    return title if title[1:2].isupper() else title[:1].lower() + title[1:]


def verdict(checks: tuple[Check, ...]) -> Status:
    """The status of all checks together, that of the gravest: fail, unknown, open; informational ones do not count."""
    return gravest([check.status for check in checks if not check.advice])


def gravest(statuses: Sequence[Status]) -> Status:
    """The gravest of some outcomes; ``pass`` of none.

    >>> gravest(["pass", "open", "fail"])
    'fail'
    """
    return next((status for status in GRAVEST if status in statuses), "pass")


def worst(checks: tuple[Check, ...]) -> Check | None:
    """The check with the smallest margin, None when no check has one.

    Those whose margin does not depend on the load are left out.
    """
    return min((c for c in checks if c.is_comparable), default=None, key=lambda check: check.margin)


def tightest(checks: tuple[Check, ...], count: int) -> list[Check]:
    """The checks that a reader wants first: conditions that fail, then the smallest margins."""
    failed = [c for c in checks if c.status == "fail" and isnan(c.margin)]
    return [*failed, *sorted((c for c in checks if c.is_comparable), key=lambda c: c.margin)][:count]


def worst_of_cases(by_case: Sequence[tuple[str, Sequence[Check]]]) -> tuple[Check, ...]:
    """Of checks in several load cases each where it is worst; those of a passage, which is their case, each alone."""
    alike: dict[tuple[str, str], list[Check]] = {}
    for name, checks in by_case:
        for check in checks:
            own = check if check.case or not name else replace(check, case=name)
            alike.setdefault((check.name, check.case), []).append(own)
    return tuple(min(several, key=_severity) for several in alike.values())


def _severity(check: Check) -> tuple[float, ...]:
    """Status, then margin; where there is none, the larger demand and the smaller figure that is to meet it."""
    if not isnan(check.margin):
        return GRAVEST.index(check.status), check.margin
    demand, limit = 0.0 if isnan(check.demand) else abs(check.demand), inf if isnan(check.limit) else check.limit
    return GRAVEST.index(check.status), 1e99, -demand, limit


# -- Results of sampling, as plain records: probability, limiting checks and the assumptions that matter most.


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """One check over all samples."""

    name: str
    title: str
    passes: float  # share of samples that pass
    fails: float  # and that fail; what is left is unknown
    weakest: float  # share of samples in which no other check has a smaller margin
    low: float  # margin that 95 % of samples exceed; NaN where there is none
    middle: float  # the median
    high: float  # margin that 5 % exceed


@dataclass(frozen=True, slots=True, kw_only=True)
class FigureSpread:
    """One figure over all samples."""

    name: str
    title: str
    kind: str
    unit: str  # of the trade
    low: float  # SI, that 5 % of samples are below; NaN unknown
    middle: float  # the median
    high: float  # that 95 % are below


@dataclass(frozen=True, slots=True, kw_only=True)
class Driver:
    """One assumption, and what it does to the smallest margin of a drive."""

    name: str
    title: str
    share: float  # of the variance of the smallest margin, this alone: the first-order Sobol index [1]
    rank_correlation: float  # Spearman's, with its sign
    low_margin: float  # smallest margin with this at its 5 % quantile and all others nominal
    high_margin: float  # and at its 95 % quantile
    low: str  # those values, as they are printed
    high: str


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopShare:
    """The same drive in closed loop."""

    samples: int
    probability: float  # share of samples in which no check of the loop fails
    error: float  # 95 %, to both sides
    weakest: str  # the check that fails most often, else the tightest in the mean
    unknown: tuple[str, ...] = ()  # titles of checks that some sample leaves open

    @property
    def passing(self) -> float:
        """Share of samples in which every check passes; NaN unknown, where a missing figure leaves one open."""
        return float("nan") if self.unknown else self.probability


@dataclass(frozen=True, slots=True, kw_only=True)
class Reliability:
    """Probability that a drive passes, with its spread."""

    probability: float  # share of samples in which no check fails
    error: float  # of sampling, 95 % to both sides
    unknown: tuple[str, ...]  # titles of checks that no sample decides
    weakest: str  # title of the check that fails most often, else of the tightest one
    low: float  # smallest margin that 95 % of samples exceed
    middle: float  # the median of it
    high: float  # that 5 % exceed
    checks: tuple[Spread, ...]
    figures: tuple[FigureSpread, ...] = ()  # of drives that are shown
    drivers: tuple[Driver, ...] = ()  # all of them, the one that matters most first
    loop: LoopShare | None = None
    no_loop: str = ""  # why it was not put through the closed loop although that was wanted

    @property
    def passing(self) -> float:
        """Share of samples in which every check passes; NaN unknown, where a missing figure leaves one open."""
        return float("nan") if self.unknown else self.probability


@dataclass(frozen=True, slots=True, kw_only=True)
class Uncertain:
    """One figure that is uncertain."""

    name: str
    title: str
    text: str  # as it is written
    source: str  # "spec", or why the class of a catalogue figure is what it is


@dataclass(frozen=True, slots=True, kw_only=True)
class Uncertainty:
    """Assumptions and samples that all drives of a sizing have in common."""

    assumptions: tuple[Uncertain, ...]
    samples: int
    seed: int
    confidence: float | None  # required
    examined: int  # drives that were sampled
    reached: int  # of them with the required confidence
    notes: tuple[str, ...]
