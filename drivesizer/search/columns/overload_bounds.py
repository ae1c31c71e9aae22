"""Bounds of the uninterrupted time above a controller's continuous current, from a cycle in pieces.

In a piece the current is no more and no less than what the functions reach there makes of it, so that a piece may be
above the limit, and may certainly be.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.extremes import Envelope
from drivesizer.physics.figures import product
from drivesizer.physics.load_cycle import places
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.several_belts import behind_one
from drivesizer.physics.stress import Heat, Parts, Stress
from drivesizer.results.ratings import controller_current
from drivesizer.search.columns.limits_over_time import Moments, Pair
from drivesizer.spec.robot import RobotSpec

__all__ = ["above_bounds", "closer_above"]

Array = NDArray[np.float64]
_PIECES = 256  # of a cycle, at first
_CELLS = 1 << 16  # candidates times pieces at a time: what stays in the processor's cache
_SOME = 1e-300  # more than nothing, of an amount that is not known yet


def above_bounds(
    spec: RobotSpec, cycle: AtGearhead, demand: Demands, stresses: Stress, parts: Parts, pieces: int = _PIECES
) -> tuple[Array, Array]:
    """Bounds of the uninterrupted time above the continuous current, from a cycle in so many pieces at most [s].

    That of the pieces that certainly are above, and of those that may be.

    Parameters
    ----------
    spec
        The machine, or one of its load cases.
    cycle
        The load cycle at the gearhead's output.
    demand, stresses
        Columns over candidates, of ``demands`` and ``stress``.
    parts
        The parts of each candidate, with its controller.
    pieces
        Into which the cycle is cut, at most.

    Returns
    -------
    tuple[Array, Array]
        Lower and upper bound [s], each of shape (rows,).
    """
    peak, limit = stresses.current.value, controller_current(parts.controller, spec.environment.ambient)
    cycle, demand = behind_one(cycle, demand)
    low = np.where(np.isnan(peak) | np.isnan(limit), np.nan, 0.0)
    high = low.copy()
    rows = np.flatnonzero(peak > limit)
    if len(rows):
        current = demand.coefficients.take(rows, axis=0) / parts.motor["torque_constant"][rows, None]
        low[rows], high[rows] = _times_above(cycle.envelope(pieces), current, limit[rows, None])
    return low, high


def closer_above(
    spec: RobotSpec,
    cycle: AtGearhead,
    demand: Demands,
    heating: Heat,
    stresses: Stress,
    parts: Parts,
    low: Moments,
    high: Moments,
    *,
    count: int,
) -> Pair:
    """Bounds with those of the time of overload from a cycle in so many pieces, see ``above_bounds``.

    Parameters
    ----------
    spec, cycle, demand, heating, stresses, parts
        As ``waveform_bounds.bounds`` takes them; how warm the windings are does not matter.
    low, high
        Its result.
    count
        Of pieces at most.

    Returns
    -------
    Pair
        Lower and upper bounds.
    """
    shortest, longest = above_bounds(spec, cycle, demand, stresses, parts, count)
    return low._replace(above=shortest), high._replace(above=longest)


def _times_above(found: Envelope, current: Array, limit: Array) -> tuple[Array, Array]:
    """Bounds of the time for which currents are above a limit, so many candidates at a time [s]."""
    low, high = np.empty((2, len(limit)))
    size = max(_CELLS // len(found.duration), 1)
    for some in (slice(first, first + size) for first in range(0, len(limit), size)):
        low[some], high[some] = _runs_above(found, current[some], limit[some])
    return low, high


def _runs_above(found: Envelope, current: Array, limit: Array) -> tuple[Array, Array]:
    """Longest uninterrupted time that currents are certainly and perhaps above a limit [s]."""
    top, bottom = product(current, found.high.T), product(current, found.low.T)
    least = _longest_runs(found.duration, (bottom > limit) | (top < -limit))
    return np.maximum(least, _SOME), _longest_runs(found.duration, (top > limit) | (bottom < -limit))


def _longest_runs(duration: Array, inside: NDArray[np.bool_]) -> Array:
    """``waveform.longest_run`` of whole pieces, from the ends of the few runs that there are: shape (candidates,)."""
    total, start = duration.sum(), np.cumsum(duration) - duration
    found = np.where(inside.all(axis=1), total, 0.0)
    before = np.concatenate([inside[:, -1:], inside[:, :-1]], axis=1)  # the cycle repeats
    row, first = np.divmod(np.flatnonzero(inside & ~before), len(duration))
    if not len(row):
        return found
    behind = np.flatnonzero(before & ~inside) % len(duration)
    begins = np.flatnonzero(np.append(True, row[1:] != row[:-1]))  # of the runs of each candidate
    count = np.diff(np.append(begins, len(row)))
    owner, place = places(count)
    over = (behind < first)[begins]  # the last run of a candidate goes over the end of the cycle
    behind = behind[begins[owner] + (place + over[owner]) % count[owner]]
    since = (start + duration)[first - 1] - np.where((first == 0) | (behind < first), total, 0.0)
    longest = np.maximum.reduceat(start[behind] - since, begins)
    found[row[begins]] = np.maximum(longest - 8 * np.spacing(total), 0.0)  # rounding of the times may have added this
    return found
