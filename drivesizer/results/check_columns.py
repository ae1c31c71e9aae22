"""Demand against limit, for all candidates at once: the one place where margins are made.

An upper limit has margin limit/demand - 1, a required minimum actual/required - 1, a temperature the same of its rise
over the ambient. Where a limit is known from one side only, it has two ends: a demand over the high end fails, one
within the low end passes, and between them, or where a figure is missing, the check is *unknown*. Where nothing is
demanded it passes, unless even that is over the limit, and has no margin. Title, kind of quantity and unit are those
that ``check_kinds`` declares.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, isclose, isnan, nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.results.check import Band, Check, Status
from drivesizer.results.check_kinds import CHECKS, refuse_undeclared

__all__ = ["PROPOSAL", "CheckColumn", "at_least", "at_most", "between", "fits", "over_band", "worst_case"]

# what a check has of each candidate
_COLUMNS = ("demand", "limit", "passed", "failed", "time", "case", "opened", "low", "high", "least_margin", "bounded")
_ALIKE = 1e-9  # by which margins differ through rounding alone
_MOST_DOUBLINGS = 10  # beyond which no drive is farther
_NO_MARGIN = 1e99  # above any margin; over the demand it orders checks that have none


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckColumn:
    """One check over all candidates; where it neither passed nor failed it is open or unknown."""

    name: str
    demand: NDArray[np.float64]
    limit: NDArray[np.float64]
    passed: NDArray[np.bool_]
    failed: NDArray[np.bool_]
    zero: float | NDArray[np.float64] = 0.0  # from where the margin counts; NaN where there is none
    needed: float = 0.0  # margin that the spec requires
    by_choice: bool = False
    advice: bool = False  # informational: of what is not required; no drive fails or ranks by it
    time: NDArray[np.float64] | None = None  # s, of the worst moment
    case: NDArray[np.int64] | None = None  # the load case that is worst, by number
    opened: NDArray[np.bool_] | None = None  # it passes at one end of the band of estimated figures, fails at the other
    low: NDArray[np.float64] | None = None  # demand at the ends of that band
    high: NDArray[np.float64] | None = None
    least_margin: NDArray[np.float64] | None = None  # of the two ends
    bounded: NDArray[np.bool_] | None = None  # it fails at the high end of a limit that is known from one side
    note: str = ""
    at_best: str = ""  # the note where it is so
    undecided: str = ""  # the note where the limit is known and the demand not: what would decide it

    def __post_init__(self) -> None:
        refuse_undeclared(self.name)

    @property
    def decided(self) -> NDArray[np.bool_]:
        """Mask of what passes, fails, or hangs on estimated figures alone; the rest is unknown."""
        found = self.passed | self.failed
        return found if self.opened is None else found | self.opened

    @property
    def margin(self) -> NDArray[np.float64]:
        """Share by which the limit exceeds the demand; NaN where unknown, without demand or infinite.

        What neither passes nor fails has none, whatever its figures: they may be least ones.
        """
        limit, demand = self.limit, self.demand
        if not isinstance(self.zero, float) or self.zero != 0.0:  # most count from 0
            limit, demand = limit - self.zero, demand - self.zero
        with np.errstate(all="ignore"):
            found = limit / demand - 1.0
        return np.where(self.decided & (self.demand != self.zero) & np.isfinite(found), found, nan)

    @property
    def doublings(self) -> NDArray[np.int64]:
        """Number of times that the known end of a limit doubles up to the demand of an undecided check.

        >>> at_most("motor_power", np.array([18.0, 22.0, 45.0, 90.0]), 20.0, most=99.0).doublings.tolist()
        [0, 0, 1, 2]
        """
        with np.errstate(all="ignore"):
            found = np.log2((self.demand - self.zero) / (self.limit - self.zero))
        undecided = ~(self.passed | self.failed) & (found > 0.0)  # written so that NaN is none
        return np.where(undecided, np.minimum(found, _MOST_DOUBLINGS), 0.0).astype(np.int64)

    @property
    def tightness(self) -> NDArray[np.float64]:
        """The margin where it depends on the load; infinite where unknown, idle, selected or informational.

        Of what hangs on estimated figures the smaller one of the two ends of their bands.
        """
        return self.tight(self.margin)

    def tight(self, margin: NDArray[np.float64]) -> NDArray[np.float64]:
        """The tightness where the margin is at hand."""
        margin = margin if self.least_margin is None else self.least_margin
        beside = np.isnan(margin) | self.passed if self.by_choice else np.isnan(margin)
        return np.where(self.advice | beside, inf, margin)

    def at(
        self,
        index: int | tuple[()],
        method: str,
        *,
        at_time: float | None = None,
        note: str = "",
        cases: Sequence[str] = ("",),
        rotary: bool = False,
    ) -> Check:
        """The check of one candidate; ``()`` for a column that is a single figure."""
        declared, one = CHECKS[method][self.name], self.on(index)
        kind, unit = declared.rotary if rotary and declared.rotary else (declared.kind, declared.unit)
        status: Status = "pass" if one.passed else "fail" if one.failed else "unknown"
        if one.opened is not None and one.opened:
            status = "open"
        margin, time = float(one.margin), at_time if one.time is None else float(one.time)
        lacking = self.undecided if status == "unknown" and not isnan(one.limit) else ""
        if one.bounded is not None and one.bounded:
            lacking = self.at_best
        band = None
        if one.low is not None and one.high is not None and one.least_margin is not None:
            low, high, least = float(one.low), float(one.high), float(one.least_margin)
            if any(x < y and not isclose(x, y) for x, y in ((low, high), (least, margin))):  # but for rounding
                band = Band(low, high, least)
        return Check(
            name=self.name,
            title=declared.title + (" (advice)" if self.advice else ""),
            method=method,
            case=cases[0 if one.case is None else int(one.case)],
            demand=float(one.demand),
            limit=float(one.limit),
            kind=kind,
            unit=unit,
            margin=margin,
            needed=self.needed,
            status=status,
            at_time=None if time is None or time != time else time,
            by_choice=self.by_choice,
            advice=self.advice,
            note=note or self.note or lacking,
            band=band,
        )

    def on(self, rows: NDArray[Any] | slice | int | tuple[()]) -> CheckColumn:
        """The same check of some of the candidates; of one as single figures."""
        columns: dict[str, Any] = {name: getattr(self, name) for name in (*_COLUMNS, "zero")}
        taken: dict[str, Any] = {n: x[rows] for n, x in columns.items() if isinstance(x, np.ndarray)}
        return replace(self, **taken)

    def with_rows(self, rows: NDArray[Any], some: CheckColumn) -> CheckColumn:
        """The same check with some of the candidates as another column has them."""
        changed: dict[str, Any] = {}
        for name in (*_COLUMNS, "zero"):
            old, new = getattr(self, name), getattr(some, name)
            if isinstance(old, np.ndarray):
                changed[name] = old.copy()
                changed[name][rows] = False if new is None else new  # all figures of these may be known
        return replace(self, **changed)


def _column(
    name: str, demand: Any, limit: Any, *, most: Any = None, zero: Any = 0.0, needed: float = 0.0, **more: Any
) -> CheckColumn:
    demand, limit = np.asarray(demand, float), np.asarray(limit, float)
    above = zero + (demand - zero) * (1.0 + needed) if needed else demand
    passed, failed = above <= limit, above > (limit if most is None else most)
    if most is not None:
        more["bounded"] = failed & ~(most == limit)
        limit = np.where(more["bounded"], most, limit)
    idle, unbounded, unlimited = (demand == zero) & ~failed, demand == np.inf, limit == np.inf
    if np.count_nonzero(idle | unbounded | unlimited):  # of most columns nothing is
        passed, failed = passed & ~unbounded, failed | unbounded  # it passes no limit, known or not
        idle = idle | (unlimited & ~unbounded)  # without a limit any demand will do
        passed, failed = passed | idle, failed & ~idle
    shape = passed.shape  # of all of them, if one is a figure that all candidates have
    demand, limit = (x if x.shape == shape else np.full(shape, x) for x in (demand, limit))
    passed, failed = np.asarray(passed), np.asarray(failed)
    return CheckColumn(
        name=name, demand=demand, limit=limit, passed=passed, failed=failed, zero=zero, needed=needed, **more
    )


def at_most(name: str, demand: Any, limit: Any, **more: Any) -> CheckColumn:
    """A demand that must not exceed a limit; margin = limit/demand - 1.

    Examples
    --------
    >>> at_most("motor_power", 10.0, 20.0).margin.item()
    1.0
    >>> [at_most("motor_power", watts, 20.0, most=24.0).at((), "paper").status for watts in (18.0, 22.0, 26.0)]
    ['pass', 'unknown', 'fail']
    """
    return _column(name, demand, limit, **more)


def at_least(name: str, required: Any, actual: Any, **more: Any) -> CheckColumn:
    """A minimum that must be reached; margin = actual/required - 1."""
    return _column(name, required, actual, **more)


def fits(name: str, good: Any, known: Any) -> CheckColumn:
    """A condition that is met or not, without figures."""
    good, known = np.asarray(good, bool), np.asarray(known, bool)
    passed, failed = good & known, ~good & known
    nothing = np.full(passed.shape, nan)
    return CheckColumn(name=name, demand=nothing, limit=nothing, passed=passed, failed=failed)


def between(low: CheckColumn, high: CheckColumn) -> CheckColumn:
    """A check of whose demand only bounds are known: it passes where the higher does and fails where the lower does.

    Shown is the bound that decides; where neither does, the lower demand.

    Examples
    --------
    >>> volts = [at_most("supply_voltage", np.array(bound), 5.2) for bound in (5.0, 6.1)]
    >>> found = between(*volts)
    >>> found.passed.item(), found.failed.item(), found.demand.item()
    (False, False, 5.0)
    """
    if low is high:
        return high
    failed = low.failed & ~high.passed
    demand, limit = (np.where(high.passed, b, a) for a, b in ((low.demand, high.demand), (low.limit, high.limit)))
    time = high.time if low.time is None or high.time is None else np.where(high.passed, high.time, low.time)
    return replace(high, demand=demand, limit=limit, failed=failed, time=time)


def over_band(middle: CheckColumn, ends: Sequence[CheckColumn], estimated: NDArray[np.int64]) -> CheckColumn:
    """A check at estimated figures: it passes where it passes at both ends of their band, and fails where at both.

    Examples
    --------
    >>> volts = [at_most("supply_voltage", np.array([demand]), 24.0) for demand in (22.0, 20.0, 25.0)]
    >>> found = over_band(volts[0], volts[1:], np.array([0])).at(0, "physics")
    >>> found.status, found.band
    ('open', Band(low=20.0, high=25.0, least_margin=-0.040000000000000036))
    """
    every = [middle.on(estimated), *ends]
    passed, failed = (np.logical_and.reduce([getattr(c, name) for c in every]) for name in ("passed", "failed"))
    # at an end a winding may run away; without a limit at an end an unknown demand decides nothing
    decided = np.logical_or.reduce([(c.passed | c.failed) & ~(np.isnan(c.demand) & (c.limit == np.inf)) for c in every])
    demands, margins = np.array([c.demand for c in every]), np.array([c.margin for c in every])
    columns = {
        "passed": passed, "failed": failed, "opened": decided & ~passed & ~failed,
        "low": demands.min(axis=0), "high": demands.max(axis=0), "least_margin": np.fmin.reduce(margins),
    }  # fmt: skip
    blank = replace(
        middle, opened=np.zeros(middle.passed.shape, bool), low=middle.demand, high=middle.demand,
        least_margin=middle.margin,
    )  # fmt: skip
    return blank.with_rows(estimated, replace(every[0], **columns))


def worst_case(found: Sequence[tuple[int, CheckColumn]]) -> CheckColumn:
    """The same check in several load cases as one: where it fails, is unknown, or is tightest; of equals the first.

    Of a check without a margin, as nobody prints the limit, that is where most is demanded.
    """
    numbers, checks = [number for number, _ in found], [check for _, check in found]
    if len(checks) == 1:
        return checks[0] if numbers[0] == 0 else replace(checks[0], case=np.full(checks[0].passed.shape, numbers[0]))
    shape = np.broadcast_shapes(*(c.passed.shape for c in checks))
    order, margin = _precedence(checks[0])
    worst = np.zeros(shape, np.int64)
    for number, check in enumerate(checks[1:], 1):
        its_order, its_margin = _precedence(check)
        less = its_margin + _ALIKE * (1.0 + np.abs(its_margin)) < margin
        worse = (its_order < order) | ((its_order == order) & less)
        if worse.any():
            worst = np.where(worse, number, worst)
            order, margin = np.where(worse, its_order, order), np.where(worse, its_margin, margin)
    others = [(number, rows) for number in range(1, len(checks)) if (rows := worst == number).any()]

    def picked(name: str) -> NDArray[Any] | None:
        columns = [getattr(c, name) for c in checks]
        if columns[0] is None:
            return None
        columns = [False if column is None else column for column in columns]
        taken = np.asarray(columns[0])
        taken = taken if taken.shape == shape else np.full(shape, taken)
        for number, rows in others:
            taken = np.where(rows, columns[number], taken)
        return taken

    columns = {name: picked(name) for name in (*_COLUMNS, "zero") if name != "case"}
    return replace(checks[0], **columns, case=np.array(numbers)[worst])  # type: ignore[arg-type]


def _precedence(check: CheckColumn) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Outcome, the worst first, and margin: what is smaller goes before."""
    margin = check.margin
    order = np.where(check.failed, 0, np.where(check.passed, 2, 1))
    unknown = np.isnan(margin)
    if unknown.any():
        with np.errstate(divide="ignore"):
            margin = np.where(unknown, _NO_MARGIN / np.nan_to_num(np.abs(check.demand)), margin)
    return order, margin


PROPOSAL: dict[str, Any] = {  # of an encoder that is a proposal
    "advice": True,
    "note": "no encoder is required: informational, no drive fails or ranks by it",
}
