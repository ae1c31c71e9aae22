"""A number of things in words: one of them is no several."""

from __future__ import annotations

from dataclasses import replace

from drivesizer.results.sizing import Counts, Status

__all__ = ["meeting", "number_of"]


def number_of(count: int, thing: str, several: str = "") -> str:
    """A number with what it counts.

    Examples
    --------
    >>> number_of(1, "part"), number_of(2345, "part"), number_of(0, "axis", "axes")
    ('1 part', '2,345 parts', '0 axes')
    """
    return f"{count:,} {thing if count == 1 else several or thing + 's'}"


def meeting(counts: Counts, best: Status | None, of: str = "") -> str:
    """Number of drives that meet all limits, and that fail none as far as figures are known, in words.

    Examples
    --------
    >>> counts = [Counts(considered=99, feasible=n, passing=k, failed_by={}) for n, k in ((1, 1), (7, 0), (113, 87))]
    >>> [meeting(count, "pass") for count in counts]
    ['1 meets all limits', '7 fail no check', '87 meet all limits, 26 more fail none, figures missing']
    >>> meeting(Counts(considered=99, feasible=7, passing=5, failed_by={}, left_out=8), "pass")
    '5 meet all limits, 10 more fail none, figures missing, 8 of them left out by select: {unknown: reject}'
    >>> meeting(Counts(considered=99, feasible=7, passing=7, failed_by={}, undecided=1646), "pass")
    'at least 7 meet all limits, 1,646 behind them not computed'
    """
    if counts.undecided:
        known = meeting(replace(counts, undecided=0), best, of)
        return f"at least {known}, {counts.undecided:,} behind them not computed"
    passing = counts.passing if best in ("pass", None) else 0
    more = counts.feasible - passing + counts.left_out
    those = "" if counts.left_out == more else f"{counts.left_out:,} of them "
    left = f", {those}left out by select: {{unknown: reject}}" if counts.left_out else ""
    if not passing and more:
        return f"{more:,} fail{'s' * (more == 1)} no check{of}{left}"
    meet = f"{passing:,} meet{'s' * (passing == 1)} all limits{of}"
    return f"{meet}, {more:,} more fail{'s' * (more == 1)} none, figures missing{left}" if more else meet
