"""Tables and lists of the page on measured drives, and the texts that belong to a quantity."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from measured_compared import Array, Comparison

__all__ = [
    "GOAL",
    "LARGE",
    "About",
    "abouts",
    "by_quantity",
    "coverage",
    "drive_table",
    "misses",
    "quantities",
    "share",
]

GOAL = 0.85  # of points inside
LARGE = 90  # points, from which on a quantity is a large set
_ROUNDED = 0.005  # of an error as it is printed
_HALF = 0.5  # of the plain model's error
_DRIVE = ("quantity", "points", "inside", "error", "plain", "band", "computed by", "the plain model")
_QUANTITY = ("quantity", "error", "plain", "measurement", "at most half of plain, or within the measurement")


class About(NamedTuple):
    """What is told of a quantity."""

    name: str
    by: str  # program, or page
    accuracy: float  # of the measurement itself [1]; NaN where it is not known
    plain: str  # the plain model
    why: str  # of points outside


def abouts(lines: Iterable[str]) -> dict[str, About]:
    """Texts by key, from lines of ``key | name | by | accuracy in % | plain model | why``."""
    found = {}
    for line in lines:
        key, name, by, accuracy, plain, why = (cell.strip() for cell in line.split("|"))
        found[key] = About(name, by, float(accuracy or "nan") / 100.0, plain, why)
    return found


def share(part: int, whole: int) -> str:
    """A share in per cent."""
    return f"{100.0 * part / whole:.0f} %"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _percent(value: float, sign: str = "+") -> str:
    return "none" if np.isnan(value) else f"{100.0 * value:{sign}.0f} %".replace("-", "−")


def drive_table(comparisons: Sequence[Comparison], texts: Mapping[str, About]) -> str:
    """All quantities of one drive."""
    return _table(_DRIVE, (_drive_row(one, texts[one.key]) for one in comparisons))


def _drive_row(one: Comparison, about: About) -> tuple[str, ...]:
    errors = (_percent(float(np.median(one.errors(of)))) for of in (one.nominal, one.plain))
    return (
        about.name,
        str(len(one.y)),
        str(int(one.inside.sum())),
        *errors,
        _percent(one.width, ""),
        about.by,
        about.plain,
    )


def coverage(drives: Mapping[str, Sequence[Comparison]], texts: Mapping[str, About]) -> str:
    """Points inside per drive, in all, without the large sets, and by who computes."""
    every = [one for found in drives.values() for one in found]
    groups = dict(drives) | {
        "**all**": every,
        f"all but quantities of {LARGE} points and more": [one for one in every if len(one.y) < LARGE],
        "all that the program computes itself": [one for one in every if texts[one.key].by == "program"],
        "all that this page works out from the program's figures": [
            one for one in every if texts[one.key].by == "page"
        ],
    }
    return _table(
        ("drive", "points", "inside", "share"), (_coverage_row(name, found) for name, found in groups.items())
    )


def _coverage_row(name: str, found: Sequence[Comparison]) -> tuple[str, ...]:
    points, inside = sum(len(one.y) for one in found), sum(int(one.inside.sum()) for one in found)
    return name, str(points), str(inside), share(inside, points)


def by_quantity(comparisons: Sequence[Comparison]) -> dict[str, str]:
    """Counted by quantity, not by point: how many are mostly inside, how wide, and how near the nominal value is."""
    good = sum(bool(one.inside.mean() >= GOAL) for one in comparisons)
    known = [(_size(one.errors(one.nominal)), _size(one.errors(one.plain))) for one in comparisons]
    known = [(error, plain) for error, plain in known if not np.isnan(plain)]
    return {
        "mostly": str(good), "every": str(len(comparisons)), "mostly_share": share(good, len(comparisons)),
        "width": _percent(float(np.median([one.width for one in comparisons])), ""), "known": str(len(known)),
        "nearer": str(sum(error <= plain + _ROUNDED for error, plain in known)),
        "half": str(sum(error <= _HALF * plain for error, plain in known)),
    }  # fmt: skip


def quantities(comparisons: Sequence[Comparison], texts: Mapping[str, About]) -> tuple[str, list[bool]]:
    """Median sizes of errors beside the plain model's and the measurement's own.

    Returns
    -------
    tuple
        The table, and for each quantity with a plain model whether its error is small enough.
    """
    rows, verdicts = [], list[bool]()
    for one in comparisons:
        about, error, plain = texts[one.key], _size(one.errors(one.nominal)), _size(one.errors(one.plain))
        if np.isnan(plain):
            rows.append((about.name, _percent(error, ""), "none", _accuracy(about), "no sheet has the figure"))
            continue
        kinds = [
            name
            for name, holds in (("half", error <= _HALF * plain), ("measurement", error <= about.accuracy))
            if holds
        ]
        verdicts.append(bool(kinds))
        answer = f"yes ({', '.join(kinds)})" if kinds else "no"
        rows.append((about.name, _percent(error, ""), _percent(plain, ""), _accuracy(about), answer))
    return _table(_QUANTITY, rows), verdicts


def _accuracy(about: About) -> str:
    return "" if np.isnan(about.accuracy) else f"{100.0 * about.accuracy:g} %"


def _size(errors: Array) -> float:
    return float(np.median(np.abs(errors)))


def misses(comparisons: Sequence[Comparison], texts: Mapping[str, About]) -> str:
    """The quantities with points outside, the largest share first; each must say why."""
    outside = [one for one in comparisons if not one.inside.all()]
    lines = []
    for one in sorted(outside, key=lambda one: float(one.inside.mean())):
        about, missed = texts[one.key], ~one.inside
        if not about.why:
            raise SystemExit(f"measured.txt: {one.key} has points outside its band and says not why")
        way = {"above": int((one.y > one.high)[missed].sum()), "below": int((one.y < one.low)[missed].sum())}
        said = " and ".join(f"{count} {side} the band" for side, count in way.items() if count)
        lines.append(f"- **{about.name}**: {missed.sum()} of {len(one.y)} outside, {said}. {about.why}")
    return "\n".join(lines)
