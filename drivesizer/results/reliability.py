"""Results of sampling, as plain records: probability, limiting checks and the assumptions that matter most."""

from __future__ import annotations

from dataclasses import dataclass

from drivesizer.units import show

__all__ = ["Driver", "FigureSpread", "LoopShare", "Reliability", "Spread", "Uncertain", "Uncertainty"]


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

    @property
    def texts(self) -> list[str]:
        """The three percentiles as they are printed."""
        return [show(value, self.unit, self.kind) for value in (self.low, self.middle, self.high)]


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
    middle: float
    high: float
    checks: tuple[Spread, ...]
    figures: tuple[FigureSpread, ...] = ()  # of drives that are shown
    drivers: tuple[Driver, ...] = ()  # all of them, the one that matters most first
    loop: LoopShare | None = None
    no_loop: str = ""  # why it was not put through the closed loop although that was wanted

    def reaches(self, confidence: float) -> bool:
        """Whether the probability is at least that."""
        return self.probability >= confidence

    @property
    def passing(self) -> float:
        """Share of samples in which every check passes; NaN unknown, where a missing figure leaves one open."""
        return float("nan") if self.unknown else self.probability

    @property
    def interplay(self) -> float:
        """Share of the variance that no assumption makes alone; NaN where nothing varies."""
        return 1.0 - sum(driver.share for driver in self.drivers) if self.drivers else float("nan")


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
