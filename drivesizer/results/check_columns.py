"""Demand against limit, for all candidates at once or for one: the one place where verdicts and margins are made.

Taken are a demand and a limit. Each is a figure, or a ``Range`` where less is known of it: between two ends, of which
one may be unknown (NaN); a limit of which nothing is known at all is NaN. Given is a verdict:

- *fail*: the low end of the demand is over the high end of the limit;
- *pass*: the high end of the demand is within the low end of the limit. Where nothing is demanded it passes, unless
  even that is over the limit; without a limit, which is infinite, whatever is demanded;
- *open*: the ranges of demand and limit overlap, of which all ends are known; or estimated figures decide: samples of
  them, the middle and both ends of their bands, do not agree (``over_ends``);
- *unknown*: else, that is where an end that matters is unbounded.

Shown are the figures that decide: of what passes the high demand and the low limit, of what fails the low demand and
the high limit, of all else the low ends. An upper limit has margin limit/demand - 1, a required minimum
actual/required - 1, a temperature the same of its rise over the ambient. Title, kind of quantity and unit are those
that ``checks.txt`` declares.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isclose, isnan, nan
from typing import NamedTuple, TypedDict, Unpack

import numpy as np

from drivesizer.physics.figures import Alike, Array, Mask, Range, Whole
from drivesizer.results.check import Band, Check, Status
from drivesizer.results.check_kinds import CHECKS

_DECLARED = frozenset(name for declared in CHECKS.values() for name in declared)
_IDLE: dict[str, Alike] = {  # what a check has of each candidate, and what of one that it does not concern
    "demand": 0.0, "limit": inf, "passed": True, "failed": False, "time": nan, "case": 0, "on_basis": False,
    "zero": 0.0, "opened": False, "low": 0.0, "high": 0.0, "least": nan,
}  # fmt: skip
_ALIKE = 1e-9  # by which margins differ through rounding alone
_MOST_DOUBLINGS = 10  # beyond which no drive is farther
_NO_MARGIN = 1e99  # above any margin; over the demand it orders checks that have none


class CheckColumn(NamedTuple):
    """One check over all candidates; where it neither passed nor failed it is open or unknown."""

    name: str
    demand: Array
    limit: Array
    passed: Mask
    failed: Mask
    zero: float | Array = 0.0  # from where the margin counts; NaN where there is none
    needed: float = 0.0  # margin that the spec requires
    by_choice: bool = False
    advice: bool = False  # informational: of what is not required; no drive fails or ranks by it
    time: Array | None = None  # s, of the worst moment
    case: Whole | None = None  # the load case that is worst, by number
    opened: Mask | bool = False  # ranges overlap, or samples of estimated figures pass and fail
    low: Array | None = None  # the demand over these samples; None where no candidate has an estimated figure
    high: Array | None = None
    least: Array | None = None  # the smallest margin of them
    on_basis: Mask | None = None  # it fails at the high end of a limit, or passes by an assumption
    basis: str = ""  # the note where it is so
    note: str = ""
    undecided: str = ""  # the note where the limit is known and the demand not: what would decide it

    @property
    def margin(self) -> Array:
        """Share by which the limit exceeds the demand; NaN where unknown, without demand or infinite.

        What neither passes nor fails has none, whatever its figures: they may be least ones.
        """
        limit, demand = self.limit, self.demand
        if not isinstance(self.zero, float) or self.zero != 0.0:  # most count from 0
            limit, demand = limit - self.zero, demand - self.zero
        decided = self.passed | self.failed
        if self.least is not None:
            decided = decided | (self.opened & ~np.isnan(self.least))
        with np.errstate(all="ignore"):
            margin = limit / demand - 1.0
        return np.where(decided & (self.demand != self.zero) & np.isfinite(margin), margin, nan)

    @property
    def doublings(self) -> Whole:
        """Number of times that the known end of a limit doubles up to the demand of an undecided check.

        >>> at_most("motor_power", np.array([18.0, 22.0, 45.0, 90.0]), Range(20.0, 99.0)).doublings.tolist()
        [0, 0, 1, 2]
        """
        with np.errstate(all="ignore"):
            doublings = np.log2((self.demand - self.zero) / (self.limit - self.zero))
        undecided = ~(self.passed | self.failed) & (doublings > 0.0)  # written so that NaN is none
        return np.where(undecided, np.minimum(doublings, _MOST_DOUBLINGS), 0.0).astype(np.int64)

    @property
    def tightness(self) -> Array:
        """The margin where it depends on the load; infinite where unknown, idle, selected or informational.

        Of what hangs on estimated figures the smaller one of the two ends of their bands.
        """
        return self.tight(self.margin)

    def tight(self, margin: Array) -> Array:
        """The tightness where the margin is at hand."""
        margin = margin if self.least is None else self.least
        exempt = np.isnan(margin) | self.passed if self.by_choice else np.isnan(margin)
        return np.where(self.advice | exempt, inf, margin)

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
        declared, column = CHECKS[method][self.name], self.on(index)
        kind, unit = declared.rotary if rotary else (declared.kind, declared.unit)
        status: Status = (
            "pass" if column.passed else "fail" if column.failed else "open" if column.opened else "unknown"
        )
        margin, time, band = float(column.margin), at_time if column.time is None else float(column.time), None
        if column.low is not None and column.high is not None and column.least is not None:
            low, high, least = float(column.low), float(column.high), float(column.least)
            if any(x < y and not isclose(x, y) for x, y in ((low, high), (least, margin))):  # but for rounding
                band = Band(low, high, least)
        by_range = status == "open" and isnan(margin)
        lacking = self.undecided if (status == "unknown" or by_range) and not isnan(column.limit) else ""
        if column.on_basis is not None and column.on_basis:
            lacking = self.basis
        return Check(
            name=self.name,
            title=declared.title + (" (advice)" if self.advice else ""),
            method=method,
            case=cases[0 if column.case is None else int(column.case)],
            demand=float(column.demand),
            limit=float(column.limit),
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

    def on(self, rows: Whole | Mask | slice | int | tuple[()]) -> CheckColumn:
        """The same check of some of the candidates; of one as single figures."""
        columns: list[Alike] = [x[rows] if isinstance(x, np.ndarray) else x for x in self]
        return CheckColumn(*columns)

    def with_rows(self, rows: Whole | Mask | tuple[()], part: CheckColumn) -> CheckColumn:
        """The same check with some of the candidates as another column has them."""
        changed: dict[str, Alike] = {}
        for name in _IDLE:
            old, new = getattr(self, name), getattr(part, name)
            if isinstance(old, np.ndarray) or (name == "opened" and isinstance(new, np.ndarray)):
                changed[name] = np.array(np.broadcast_to(old, self.passed.shape))
                changed[name][rows] = False if new is None else new  # all figures of these may be known
        return self._replace(**changed)

    def where_known(self, known: Mask | bool) -> CheckColumn:
        """The same check where the demand is known; where it may be more it passes no limit."""
        passed = self.passed & (known | np.isposinf(self.limit))
        return self._replace(passed=passed, opened=self.opened & np.asarray(known))

    def assuming(self, rows: Mask, basis: str) -> CheckColumn:
        """The same check, which passes for some of the candidates by an assumption."""
        return self._replace(passed=self.passed | rows, opened=self.opened & ~rows, on_basis=rows, basis=basis)


class Notes(TypedDict, total=False):
    """Words of a check beside its verdict."""

    by_choice: bool
    advice: bool
    basis: str
    note: str
    undecided: str


class Options(Notes, total=False):
    """The same, what the spec requires of it, and when it is met."""

    needed: float
    time: Alike
    zero: Alike


def at_most(
    name: str,
    demand: Alike,
    limit: Alike,
    *,
    time: Alike = None,
    zero: Alike = 0.0,
    needed: float = 0.0,
    **more: Unpack[Notes],
) -> CheckColumn:
    """A demand that must not exceed a limit; margin = limit/demand - 1. Each a figure or a ``Range``, as a time is.

    Examples
    --------
    >>> at_most("motor_power", 10.0, 20.0).margin.item()
    1.0
    >>> [at_most("motor_power", watts, Range(20.0, 24.0)).at((), "paper").status for watts in (18.0, 22.0, 26.0)]
    ['pass', 'open', 'fail']
    >>> found = at_most("supply_voltage", Range(5.0, 6.1), 5.2)
    >>> found.passed.item(), found.failed.item(), found.demand.item()
    (False, False, 5.0)
    """
    _refuse_undeclared(name)
    low, high = _ends(demand)
    least, most = _ends(limit)
    over = [zero + (end - zero) * (1.0 + needed) if needed else end for end in ((low,) if low is high else (low, high))]
    passed, failed = over[-1] <= least, over[0] > most
    at_high_end = None if least is most else failed & ~(most == least)
    limit = least if at_high_end is None else np.where(at_high_end, most, least)
    endless = high == np.inf
    if not (passed | failed).all() or endless.any():  # most columns are finite and known
        unlimited = limit == np.inf
        passed, failed = passed & ~endless, failed | (low == np.inf)  # it passes no limit, known or not
        # nothing is demanded, or without a limit any demand will do
        idle = (high == zero) & ~(over[-1] > limit) | (unlimited & ~endless)
        passed, failed = passed | idle, failed & ~idle
    failed = failed & ~passed
    demand = low if low is high else np.where(passed, high, low)
    opened: Mask | bool = False
    if low is not high or least is not most:
        opened = ~(passed | failed) & ~np.isnan(low + least) & np.isfinite(high) & np.isfinite(most)
    if isinstance(time, Range):
        time = np.where(passed, time.high, time.low)
    shape = passed.shape  # of all of them, if one is a figure that all candidates have
    demand, limit = (x if x.shape == shape else np.full(shape, x) for x in (demand, limit))
    return CheckColumn(
        name=name, demand=demand, limit=limit, passed=np.asarray(passed), failed=np.asarray(failed), zero=zero,
        needed=needed, time=time, opened=opened, on_basis=at_high_end, **more,
    )  # fmt: skip


def _refuse_undeclared(name: str) -> None:
    if name not in _DECLARED:
        raise LookupError(f"check {name!r} is not declared in results/checks.txt")


def _ends(figure: Alike) -> tuple[Array, Array]:
    if not isinstance(figure, Range) or figure.low is figure.high:
        values = np.asarray(figure.low if isinstance(figure, Range) else figure, float)
        return values, values
    return np.asarray(figure.low, float), np.asarray(figure.high, float)


def at_least(name: str, required: Alike, actual: Alike, **more: Unpack[Options]) -> CheckColumn:
    """A minimum that must be reached; margin = actual/required - 1."""
    return at_most(name, required, actual, **more)


def fits(name: str, good: Alike, known: Alike) -> CheckColumn:
    """A condition that is met or not, without figures."""
    _refuse_undeclared(name)
    good, known = np.asarray(good, bool), np.asarray(known, bool)
    passed, failed = good & known, ~good & known
    nothing = np.full(passed.shape, nan)
    return CheckColumn(name=name, demand=nothing, limit=nothing, passed=passed, failed=failed)


def over_ends(middle: CheckColumn, ends: Sequence[CheckColumn], rows: Whole | tuple[()] = ()) -> CheckColumn:
    """A check over samples of estimated figures, which some rows have: it passes where all pass, fails where all fail.

    Examples
    --------
    >>> volts = [at_most("supply_voltage", demand, 24.0) for demand in (22.0, 20.0, 25.0)]
    >>> found = over_ends(volts[0], volts[1:]).at((), "physics")
    >>> found.status, found.band
    ('open', Band(low=20.0, high=25.0, least_margin=-0.040000000000000036))
    """
    columns = [middle.on(rows), *ends]
    passed, failed = (np.logical_and.reduce([getattr(c, name) for c in columns]) for name in ("passed", "failed"))
    # at an end a winding may run away; without a limit at an end an unknown demand decides nothing
    decided = np.logical_or.reduce(
        [(c.passed | c.failed) & ~(np.isnan(c.demand) & (c.limit == np.inf)) for c in columns]
    )
    decided |= np.logical_or.reduce([np.broadcast_to(c.opened, c.passed.shape) for c in columns])
    demands, least = np.array([c.demand for c in columns]), np.fmin.reduce([c.margin for c in columns])
    low, high = demands.min(axis=0), demands.max(axis=0)
    opened = decided & ~passed & ~failed
    sampled = columns[0]._replace(passed=passed, failed=failed, opened=opened, low=low, high=high, least=least)
    # an open check is shown by the low end of its limit, a failed one by the high end: the least margin is by the low
    by_high_end = False if columns[-1].on_basis is None else columns[-1].on_basis & columns[-1].failed
    margin = sampled._replace(demand=np.where(by_high_end, high, columns[0].demand)).margin
    sampled = sampled._replace(least=np.fmin(least, margin))
    opened = np.array(np.broadcast_to(middle.opened, middle.passed.shape))
    whole = middle._replace(opened=opened, low=middle.demand, high=middle.demand, least=middle.margin)
    return whole.with_rows(rows, sampled)


def worst_case(by_case: Sequence[tuple[int, CheckColumn]]) -> CheckColumn:
    """The same check in several load cases as one: where it fails, is unknown, or is tightest; of equals the first.

    Of a check without a margin, as nobody prints the limit, that is where most is demanded.
    """
    numbers, checks = [number for number, _ in by_case], [check for _, check in by_case]
    if len(checks) == 1:
        return checks[0] if numbers[0] == 0 else checks[0]._replace(case=np.full(checks[0].passed.shape, numbers[0]))
    shape = np.broadcast_shapes(*(c.passed.shape for c in checks))
    worst, order, margin = np.zeros(shape, np.int64), np.zeros(0), np.zeros(0)
    for number, check in enumerate(checks):
        its_order = np.where(check.failed, 0, np.where(check.passed, 3, np.where(check.opened, 2, 1)))
        its_margin = check.margin
        unknown = np.isnan(its_margin)
        if unknown.any():
            with np.errstate(divide="ignore"):
                its_margin = np.where(unknown, _NO_MARGIN / np.nan_to_num(np.abs(check.demand)), its_margin)
        if number == 0:
            order, margin = its_order, its_margin
            continue
        less = its_margin + _ALIKE * (1.0 + np.abs(its_margin)) < margin
        worse = (its_order < order) | ((its_order == order) & less)
        if worse.any():
            worst = np.where(worse, number, worst)
            order, margin = np.where(worse, its_order, order), np.where(worse, its_margin, margin)
    others = [(number, rows) for number in range(1, len(checks)) if (rows := worst == number).any()]
    columns: dict[str, Alike] = {}
    for name in _IDLE:
        of_each = [getattr(c, name) for c in checks]
        if name != "case" and of_each[0] is not None:
            column = np.asarray(of_each[0])
            columns[name] = column if column.shape == shape else np.full(shape, column)
            for number, rows in others:
                other = False if of_each[number] is None else of_each[number]
                columns[name] = np.where(rows, other, columns[name])
    return checks[0]._replace(**columns, case=np.array(numbers)[worst])


def together(by_rows: Sequence[tuple[Whole | Mask | slice, Sequence[CheckColumn]]], count: int) -> list[CheckColumn]:
    """Checks of some candidates at a time put together; some there are only for some of them."""
    by_name: dict[str, list[tuple[Whole | Mask | slice, CheckColumn]]] = {}
    for rows, checks in by_rows:
        for check in checks:
            by_name.setdefault(check.name, []).append((rows, check))
    whole = []
    for parts in by_name.values():
        columns: dict[str, Alike] = {}
        for name, idle in _IDLE.items():
            rows_columns = [(rows, getattr(check, name)) for rows, check in parts]
            if any(isinstance(column, np.ndarray) for _, column in rows_columns):
                columns[name] = np.full(count, idle)
                for rows, column in rows_columns:
                    columns[name][rows] = idle if column is None else column
        whole.append(parts[0][1]._replace(**columns))
    return whole


PROPOSAL: Options = {  # of an encoder that is a proposal
    "advice": True,
    "note": "no encoder is required: informational, no drive fails or ranks by it",
}
