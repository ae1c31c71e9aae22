"""A check and a figure as records, and what several checks amount to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, isnan, nan
from typing import Literal, NamedTuple

from drivesizer.units import show

__all__ = [
    "GRAVEST",
    "Band",
    "Check",
    "Figure",
    "Status",
    "gravest",
    "sentence_case",
    "tightest",
    "verdict",
    "worst",
    "worst_of_cases",
]

Status = Literal["pass", "fail", "open", "unknown"]  # open: estimated figures decide


GRAVEST: tuple[Status, ...] = ("fail", "unknown", "open", "pass")


class Band(NamedTuple):
    """A demand at the ends of the band of estimated figures that it rests on."""

    low: float  # SI
    high: float
    least_margin: float  # NaN where there is none


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One demand against one limit."""

    name: str
    title: str
    method: str
    case: str = ""
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
    note: str = ""
    band: Band | None = None  # where estimated figures change the demand
    probability: float = nan  # that it passes, where it is open

    @property
    def is_comparable(self) -> bool:
        """Whether its margin depends on the load: not where it is unknown, of a selected part or informational."""
        return not (isnan(self.margin) or (self.by_choice and self.status == "pass") or self.advice)

    def shown(self, figure: float) -> str:
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


def sentence_case(title: str) -> str:
    """A title within a sentence: its first letter small, abbreviations as they are.

    >>> in_a_sentence("Motor nominal current (RMS)"), in_a_sentence("RMS torque")
    ('motor nominal current (RMS)', 'RMS torque')
    """
    return title if title[1:2].isupper() else title[:1].lower() + title[1:]


def verdict(checks: tuple[Check, ...]) -> Status:
    """The status of all checks together, that of the gravest: fail, unknown, open; informational ones do not count."""
    return gravest([check.status for check in checks if not check.advice])


def gravest(found: Sequence[Status]) -> Status:
    """The gravest of some outcomes; ``pass`` of none.

    >>> gravest(["pass", "open", "fail"])
    'fail'
    """
    return next((status for status in GRAVEST if status in found), "pass")


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
            one = check if check.case or not name else replace(check, case=name)
            alike.setdefault((check.name, check.case), []).append(one)
    return tuple(min(several, key=_severity) for several in alike.values())


def _severity(check: Check) -> tuple[float, ...]:
    """Status, then margin; where there is none, the larger demand and the smaller figure that is to meet it."""
    if not isnan(check.margin):
        return GRAVEST.index(check.status), check.margin
    demand, limit = (
        nan_as if isnan(figure) else figure for figure, nan_as in ((check.demand, 0.0), (check.limit, inf))
    )
    return GRAVEST.index(check.status), 1e99, -abs(demand), limit
