"""A load cycle behind several belts at once: candidates in the order of their belts, each with its own belt.

What hangs on the belt is computed belt by belt, from the same rows as for that belt alone, so that not a bit of it
differs; whatever else there is to compute is then done for all belts in one go. So are bounds, which may round
otherwise: behind a belt of ratio 1, the others' scales of the functions being in the coefficients.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import AtGearhead, Peak
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.stress import Heat, on

__all__ = [
    "AtGearheads", "at_a_time", "behind_each", "behind_one", "belts_of", "heat_behind_one", "put_together", "scales",
]  # fmt: skip

Array = NDArray[np.float64]
_FIGURES = ("belt", "rms_torque", "peak_torque", "held", "peak_speed", "mean_speed", "sustained_speed", "mean_power",
            "peak_power", "load_torque", "load_speed")  # fmt: skip


class AtGearheads(AtGearhead):
    """A load cycle at the gearheads' outputs, behind the belts of candidates."""

    def __init__(self, ats: Sequence[AtGearhead], which: NDArray[np.int64]) -> None:
        """``which``: the number of each candidate's belt, never falling."""
        self.ats, self.which, self.base = ats, which, ats[0].base

    def __getattr__(self, name: str) -> Any:
        """A figure of each candidate's belt, made a column on first use."""
        if name == "moments":
            return _Moments(self)
        if name not in _FIGURES:
            raise AttributeError(name)
        column = np.array([getattr(at, name) for at in self.ats])[self.which]
        setattr(self, name, column)
        return column

    def slope(self, c: Array) -> Array:
        """Half of the gradient of the mean square of c f(t), by each coefficient."""
        found: Array = behind_each(self, lambda at, some: at.slope(some), c)
        return found

    def turned(self, exponent: float) -> Array:
        """Mean over the cycle of the output torque to an exponent, times speed there, of each candidate."""
        found: Array = np.array([at.turned(exponent) for at in self.ats])[self.which]
        return found

    @cached_property
    def parts(self) -> list[tuple[AtGearhead, slice]]:
        """The belts that have candidates, and the rows of these."""
        ends = np.searchsorted(self.which, np.arange(len(self.ats) + 1)).tolist()
        return [(at, slice(a, b)) for at, a, b in zip(self.ats, ends[:-1], ends[1:], strict=True) if b > a]

    def on(self, rows: Any) -> AtGearhead:
        """Of some of the candidates, in their order."""
        which = self.which[rows]
        if len(which) and which[0] != which[-1]:
            return AtGearheads(self.ats, which)
        return self.ats[which[0] if len(which) else 0]

    def peak(self, coefficients: Array, left_out: NDArray[np.bool_] | None = None) -> Peak:
        """Largest absolute value of what is linear in the functions."""
        found: Peak = behind_each(self, lambda at, *columns: at.peak(*columns), coefficients, left_out)
        return found


class _Moments:
    """Means of products of two functions over the cycle, behind the belts of candidates: columns."""

    def __init__(self, cycle: AtGearheads) -> None:
        self.cycle = cycle

    def __getitem__(self, pair: tuple[int, int]) -> Array:
        found: Array = np.array([at.moments[pair] for at in self.cycle.ats])[self.cycle.which]
        return found


def behind_each(at: AtGearhead, compute: Callable[..., Any], *columns: Any) -> Any:
    """A function of candidates behind one belt, applied to those behind any number of them.

    Parameters
    ----------
    at
        The load cycle behind their belts.
    compute
        Function of the load cycle behind one belt and columns over its candidates: columns, or records of columns.
    columns
        Over all candidates: arrays, records of them, or parts.

    Returns
    -------
    array or record of arrays
        Columns over all candidates.
    """
    if not isinstance(at, AtGearheads):
        return compute(at, *columns)
    return put_together([compute(one, *(_some(column, rows) for column in columns)) for one, rows in at.parts])


def belts_of(at: AtGearhead, count: int) -> list[slice]:
    """Candidates, of so many, that are behind the same belt.

    Parameters
    ----------
    at
        The load cycle behind their belts.
    count
        Number of candidates.

    Returns
    -------
    list of slice
        One for each belt that has any; at least one.
    """
    return [rows for _, rows in at.parts] if isinstance(at, AtGearheads) else [slice(0, count)]


def scales(at: AtGearhead, count: int) -> Array:
    """Factors by which belts scale the functions of the cycle.

    Parameters
    ----------
    at
        The load cycle behind the candidates' belts.
    count
        Number of candidates.

    Returns
    -------
    array
        Shape (candidates, 6) [1].
    """
    if isinstance(at, AtGearheads):
        found: Array = np.stack([one.scale for one in at.ats])[at.which]
        return found
    return np.broadcast_to(at.scale, (count, len(at.scale)))


def behind_one(at: AtGearhead, demand: Demands) -> tuple[AtGearhead, Demands]:
    """Candidates behind any belts as such behind one of ratio 1: what is computed of them may round otherwise.

    Parameters
    ----------
    at
        The load cycle behind their belts.
    demand
        Columns over candidates, of ``demands``.

    Returns
    -------
    tuple
        The load cycle behind that belt, and the columns by its functions.
    """
    if _is_of_one(at):
        return at, demand
    scaled, ratio = demand.coefficients * scales(at, len(demand.total_ratio)), demand.total_ratio * at.belt
    return at.base.behind(1.0), demand._replace(coefficients=scaled, total_ratio=ratio)


def heat_behind_one(at: AtGearhead, heating: Heat) -> Heat:
    """Losses of candidates behind any belts as those behind one of ratio 1, see ``behind_one``.

    Parameters
    ----------
    at
        The load cycle behind their belts.
    heating
        Columns over candidates, of ``heat``.

    Returns
    -------
    Heat
        Friction and iron by the speed before the belt.
    """
    if _is_of_one(at):
        return heating
    return heating._replace(friction=heating.friction * at.belt, iron=heating.iron * at.belt**2)


def _is_of_one(at: AtGearhead) -> bool:
    return not isinstance(at, AtGearheads) and bool(at.belt == 1.0)


def at_a_time(count: int, size: int, compute: Callable[..., Any], *columns: Any) -> Any:
    """A function of candidates behind one belt, applied to so many of them at a time.

    Parameters
    ----------
    count
        Number of candidates.
    size
        Of which so many go together, 1 at least.
    compute
        Function of columns over candidates: columns, or records of columns.
    columns
        Over all candidates: arrays, records of them, or parts.

    Returns
    -------
    array or record of arrays
        Columns over all candidates.
    """
    rows = [slice(k, k + size) for k in range(0, count, size)]
    if len(rows) < 2:
        return compute(*columns)
    return put_together([compute(*(_some(column, some) for column in columns)) for some in rows])


def _some(column: Any, rows: slice) -> Any:
    """A column, record or parts of some candidates."""
    if column is None:
        return None
    if hasattr(column, "on"):
        return column.on(rows)
    return on(column, rows) if isinstance(column, tuple) else column[rows]


def put_together(found: Sequence[Any]) -> Any:
    """Columns, or records of columns, one after the other."""
    first = found[0]
    if len(found) == 1:
        return first
    if not isinstance(first, tuple):
        return np.concatenate(found)
    if all(one[0] is one[-1] for one in found) and not hasattr(first, "_fields"):
        return (put_together([one[0] for one in found]),) * len(first)  # a pair of bounds that are the same
    merged = [put_together(same) for same in zip(*found, strict=True)]
    return type(first)(*merged) if hasattr(first, "_fields") else tuple(merged)
