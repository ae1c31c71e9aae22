r"""The speed of a cycle that a gearhead's continuous input speed limits.

A gearhead may be driven faster than its continuous input speed for a while. How long is the maker's rule:

- maxon limits the input speed for continuous and for intermittent operation apart, out of concern for life and warmth
  (maxon programme 2024/25, terminology of gears, pages 372 and 454, online.flippingbook.com/view/623537/454). That
  intermittent is at most 1 s uninterrupted and 10 % of the time is *assumed*: the footnote was not available.
- Makers of servo gearboxes limit the mean: Wittenstein alpha's n1N is the mean input speed (Beckhoff Information
  System, AG3210, infosys.beckhoff.com/content/1033/ag3210_ba/6298081419.html), Harmonic Drive's the average over the
  cycle (manual 1021387, 12/2018, glossary, manualshive.com/ru/manual/harmonic-drive/shg-series/3993247?page=61), Apex
  Dynamics' that of continuous operation S1, beside n1B of cyclic operation S5 (glossary of its catalogue,
  wmhapexcatalogues.co.uk/book-1/inc/html/79.html). More than 20 min uninterrupted is S1 (planetary gearboxes RG,
  interactivepdf.uniflip.com/2/69963/302245/pub/html/7.html).
- Of other makers no rule is known: maxon's is *assumed*, the stricter one.

``results.ratings`` has the makers by name. With any of them the mean while running must not exceed the limit. All is
exact for speeds that are straight lines, and the cycle repeats: a run over its end continues at its start.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

__all__ = ["exceeded", "lasting_speeds", "lasting_speeds_by", "mean_running"]

Array = NDArray[np.float64]
_SHORT = (1.0, 0.1)  # s uninterrupted, share of the time: so long maxon's limit may be exceeded
_LONG = (1200.0, 1.0)  # and those of the mean
_STEPS, _CLOSE = 200, 1e-13  # at most, and share of a speed that is left open: its last digits
_ROUNDING = 1e-9  # of a time: by so much sums of times may be off


def lasting_speeds(duration: Array, speed: Array) -> dict[str, Array]:
    """The two speeds that makers limit [rad/s]: the mean while running, and what is exceeded for longer than shortly.

    Parameters
    ----------
    duration, speed
        As :func:`mean_running` takes them.

    Returns
    -------
    dict
        ``mean_speed``: the mean while running, or what is exceeded for 20 min uninterrupted where that is more;
        ``sustained_speed``: what is exceeded for more than 1 s uninterrupted or 10 % of the time, or the mean.
    """
    mean = mean_running(duration, speed)
    long, short = (exceeded(duration, speed, permitted) for permitted in (_LONG, _SHORT))
    return {"mean_speed": np.maximum(mean, long), "sustained_speed": np.maximum(mean, short)}


def lasting_speeds_by(
    times: Callable[[float], tuple[float, float]], ends: Array, total: float, mean: float
) -> dict[str, float]:
    """The same two speeds of a long cycle, by a function of how long it is faster than a speed.

    Parameters
    ----------
    times
        Longest time without a break above a speed, and all such time [s].
    ends
        Slowest and fastest speed of the cycle [rad/s].
    total
        Length of the cycle [s].
    mean
        Of the speed while running [rad/s].

    Returns
    -------
    dict
        As ``lasting_speeds`` gives them.
    """
    long, short = (_exceeded_by(times, ends, total, permitted) for permitted in (_LONG, _SHORT))
    return {"mean_speed": max(mean, long), "sustained_speed": max(mean, short)}


def _exceeded_by(
    times: Callable[[float], tuple[float, float]], ends: Array, total: float, permitted: tuple[float, float]
) -> float:
    """The highest speed that is exceeded for longer than permitted, between two by straight lines and in halves."""
    longest_run, in_all = permitted[0] * (1.0 + _ROUNDING), permitted[1] * total * (1.0 + _ROUNDING)

    def over(speed: float) -> float:
        run, every = times(speed)
        return max(run / longest_run, every / in_all) - 1.0

    low, high = (float(end) for end in ends)
    if permitted[1] >= 1.0 and total <= permitted[0]:
        return low
    above, below = over(low), -1.0
    for n in range(_STEPS):
        if not above > 0.0 or high - low <= _CLOSE * high:
            break
        share = 0.5 if n % 3 == 2 else above / (above - below)
        middle = low + min(max(share, 0.001), 0.999) * (high - low)
        found = over(middle)
        if found > 0.0:
            low, above = middle, found
        else:
            high, below = middle, found
    return high if above > 0.0 else low


def mean_running(duration: Array, speed: Array) -> Array:
    """Mean of the speed while it is not 0; of one cycle, or of several as columns.

    Parameters
    ----------
    duration
        Of each segment [s]: (segments,) or (segments, cycles).
    speed
        At both ends of each segment, without change of sign within [rad/s]: (segments, 2), or with cycles behind.

    Returns
    -------
    float or array
        Mean speed [rad/s]; 0 of a cycle at rest.
    """
    running = np.where((speed != 0.0).any(axis=1), duration, 0.0)
    total = running.sum(axis=0)
    found: Array = (running * np.abs(speed).mean(axis=1)).sum(axis=0) / np.where(total > 0.0, total, 1.0)
    return found


def exceeded(duration: Array, speed: Array, permitted: tuple[float, float]) -> Array:
    """The highest speed that is exceeded for longer than permitted [rad/s]: below it the limit must not lie.

    Parameters
    ----------
    duration, speed
        As :func:`mean_running` takes them.
    permitted
        Uninterrupted time [s], and share of the cycle [1].

    Returns
    -------
    array
        Speed [rad/s], of each cycle.

    Examples
    --------
    Up to 10 rad/s and down again in 20 s: above 9 rad/s for 2 s in all, above 9.5 rad/s for 1 s uninterrupted.

    >>> exceeded(np.array([10.0, 10.0]), np.array([[0.0, 10.0], [10.0, 0.0]]), (1.0, 0.1)).round(6).item()
    9.5
    """
    shape = np.broadcast_shapes(duration.shape[1:], speed.shape[2:])
    count = int(np.prod(shape))
    time = np.broadcast_to(duration.reshape(len(duration), -1), (len(duration), count))
    ends = np.broadcast_to(np.abs(speed).reshape(len(speed), 2, -1), (len(speed), 2, count))
    slowest, total = ends.min(axis=(0, 1)), time.sum(axis=0)
    if permitted[1] >= 1.0 and (total <= permitted[0]).all():  # exceeded always or not long enough
        lasts: Array = slowest.reshape(shape)
        return lasts
    longest_run, in_all = permitted[0] * (1.0 + _ROUNDING), permitted[1] * total * (1.0 + _ROUNDING)
    time, ends = _from_the_slowest(time, ends)
    levels = np.sort(np.concatenate([np.zeros((1, count)), ends[:, 0], ends[:, 1]]), axis=0)
    known, beyond = np.full(count, -1), np.full(count, len(levels) - 1)  # of levels: too long exceeded, and not
    while (beyond - known > 1).any():
        middle = (known + beyond) // 2
        runs, sums = next(_times(time, ends, levels, middle))
        too_long = (runs.max(axis=0) > longest_run) | (sums[0] > in_all)
        known, beyond = np.where(too_long, middle, known), np.where(too_long, beyond, middle)
    place = np.maximum(known, 0)
    (runs, sums), (runs_then, sums_then) = _times(time, ends, levels, place)
    share = np.maximum(_share(runs, runs_then, np.float64(longest_run)), _share(sums, sums_then, in_all))
    low, high = (levels[place + step, np.arange(count)] for step in (0, 1))
    found: Array = np.maximum(np.where(known < 0, 0.0, low + share * (high - low)), slowest).reshape(shape)
    return found


def _from_the_slowest(time: Array, ends: Array) -> tuple[Array, Array]:
    """The same cycles from where they are slowest, so that no run above that goes over their end."""
    flat = ends.reshape(-1, ends.shape[-1]).argmin(axis=0)
    rows = (np.arange(len(time))[:, None] + (flat + 1) // 2) % len(time)
    return np.take_along_axis(time, rows, axis=0), np.take_along_axis(ends, rows[:, None, :], axis=0)


def _times(time: Array, ends: Array, levels: Array, place: NDArray[np.int64]) -> Iterator[tuple[Array, Array]]:
    """Times above a level and above the next one: uninterrupted up to the end of each segment, and in all.

    Between two neighbours of all speeds at ends of segments, times above a speed are straight lines over it.
    """
    low, high = (levels[place + step, np.arange(levels.shape[1])] for step in (0, 1))
    above = ends > (low + high) / 2
    whole = above.all(axis=1)
    part = above.any(axis=1) & ~whole
    slope = np.where(part, time, 0.0) / np.where(part, np.abs(ends[:, 0] - ends[:, 1]), 1.0)
    joined = above[1:, 0] & above[:-1, 1]  # to the segment before
    most, certain = ends.max(axis=1), np.where(whole, time, 0.0)
    for v in (low, high):
        each = certain + slope * (most - v)
        end = np.cumsum(each, axis=0)
        starts = np.concatenate([np.zeros((1, end.shape[1])), np.where(joined, 0.0, end[:-1])])
        yield end - np.maximum.accumulate(starts, axis=0), end[-1:]


def _share(first: Array, last: Array, permitted: Array | np.float64) -> Array:
    """Share of the step from one level to the next with times longer than permitted; 0 where they never are."""
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(last >= permitted, 1.0, (first - permitted) / (first - last))
    found: Array = np.where(first > permitted, share, 0.0).max(axis=0)
    return found
