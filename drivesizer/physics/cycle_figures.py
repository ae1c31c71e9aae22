"""Figures of a load cycle behind a belt of ratio 1: the six functions, means of their products, single figures.

``cycle_at_gearhead`` says what they are for, and has them scaled by a belt's ratio.
Symbols: T torque [N*m], w speed [rad/s].
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.groups import layout as at
from drivesizer.physics.groups.census import SHORT, Census, times_above
from drivesizer.physics.lasting_speed import lasting_speeds, lasting_speeds_by
from drivesizer.physics.load_cycle import Figure, integral, mean_product, middle, rms

__all__ = [
    "Scalars", "belt_factors", "directed_torque", "moments", "piece_counts", "scalars", "scalars_by_census",
    "six_functions",
]  # fmt: skip

_FINEST = 200  # pieces of a segment at most
_SHORT = 512  # segments of a cycle all of whose products fit beside one another
Array = NDArray[np.float64]


class Scalars(NamedTuple):
    """Single figures of a load cycle at the gearhead's output; of several cycles columns."""

    rms_torque: Figure  # N*m, while running; of a cycle that never runs over all of it
    peak_torque: Figure  # N*m
    held: Figure  # N*m, largest that holds the load at rest; of a recording while it rests, NaN where it never does
    load_torque: Figure  # N*m, largest at the load
    mean_speed: Figure  # rad/s, while running; where more, what it exceeds for long
    sustained_speed: Figure  # rad/s, what it exceeds for longer than shortly
    mean_power: Figure  # W, transmitted in either direction while running
    peak_power: Figure  # W


def six_functions(cycle: Any, efficiency: Figure) -> list[Array]:
    """The six functions behind a belt of ratio 1, at both ends of each segment.

    Parameters
    ----------
    cycle
        At the load: a LoadCycle, or several with the same fields as columns.
    efficiency
        Of the belt [1].

    Returns
    -------
    list of arrays
        Driving torque, braking torque, torque at rest, acceleration, direction and speed, shape (segments, 2, ...).
    """
    torque, running, power = directed_torque(cycle, efficiency)
    direction = np.sign(middle(cycle.speed))[:, None]
    return [
        np.where(running & (power > 0.0), torque, 0.0),
        np.where(running & (power <= 0.0), torque, 0.0),
        np.where(~running, torque, 0.0),
        *(np.broadcast_to(x, torque.shape) for x in (cycle.acceleration, direction, cycle.speed)),
    ]


def directed_torque(cycle: Any, efficiency: Figure) -> tuple[Array, NDArray[np.bool_], Array]:
    """Torque behind a belt of ratio 1, which way it acts included.

    Parameters
    ----------
    cycle
        At the load: a LoadCycle, or several with the same fields as columns.
    efficiency
        Of the belt [1].

    Returns
    -------
    tuple of arrays
        Torque at both ends of each segment [N*m], shape (segments, 2, ...); whether the segment runs; its power at the
        load [W], by whose sign it drives or brakes.
    """
    power = (middle(cycle.torque) * middle(cycle.speed))[:, None]
    running = np.any(cycle.speed != 0.0, axis=1)[:, None]
    torque = cycle.torque * np.where(~running, 1.0, np.where(power > 0.0, 1.0 / efficiency, efficiency))
    return torque, running, power


def belt_factors(efficiency: Figure) -> Array:
    """Factors by which a belt changes torques that drive, brake and hold [1]."""
    return np.array([1.0 / efficiency, efficiency, 1.0])


def moments(duration: Array, total: float, six: Sequence[Array], acts: NDArray[np.bool_]) -> Array:
    """Means of products of the functions over the cycle.

    Parameters
    ----------
    duration, total
        Of each segment and of the cycle [s]; of several cycles shares of their time and 1, a division less each.
    six
        As of ``six_functions``.
    acts
        Which of them are ever not 0, shape (6,).

    Returns
    -------
    array
        Shape (6, 6), or (6, 6, cycles).
    """
    found, active = np.zeros((6, 6, *six[0].shape[2:])), np.flatnonzero(acts).tolist()
    pairs = [(a, b) for place, a in enumerate(active) for b in active[: place + 1]]
    short = duration.ndim == 1 and len(duration) <= _SHORT
    each = _integrals(duration, six, pairs) if short else (integral(duration, six[a], six[b]) for a, b in pairs)
    for (a, b), one in zip(pairs, each, strict=True):
        found[a, b] = found[b, a] = one / total
    return found


def _integrals(duration: Array, six: Sequence[Array], pairs: Sequence[tuple[int, int]]) -> list[float]:
    """Integrals of products of two functions over one cycle, side by side: of a short one each alone takes as long."""
    every = np.stack(six, axis=2)
    a, b = (every[:, :, [pair[k] for pair in pairs]] for k in (0, 1))
    return [float(duration @ mean) for mean in np.ascontiguousarray(mean_product(a, b).T)]


def scalars(cycle: Any, torque: Array, efficiency: Figure) -> Scalars:
    """Single figures of cycles; of one from the segments in which it runs, of several with the others as of no time.

    Parameters
    ----------
    cycle
        At the load: a LoadCycle, or several with the same fields as columns.
    torque
        Behind the belt, as of ``directed_torque`` [N*m].
    efficiency
        Of the belt [1].

    Returns
    -------
    Scalars
        Behind a belt of ratio 1.
    """
    duration, speed = cycle.duration, cycle.speed
    running = np.any(speed != 0.0, axis=1)
    alone = running.ndim == 1
    held = running | ~running.any(axis=0)  # a cycle that never runs loads gears at rest
    time, some = (duration[held], held) if alone else (np.where(held, duration, 0.0), slice(None))
    total = time.sum(axis=0)
    power = np.abs(mean_product(torque, speed)[some])
    rests = ~running & (duration > 0.0)
    at_rest = np.where(rests[:, None], np.abs(torque), -1.0).max(axis=(0, 1))
    found = Scalars(
        rms_torque=rms(time, torque[some]),
        peak_torque=np.abs(torque).max(axis=(0, 1)),
        held=efficiency * np.where(np.isnan(cycle.held), np.where(at_rest >= 0.0, at_rest, np.nan), cycle.held),
        load_torque=np.abs(cycle.torque).max(axis=(0, 1)),
        **lasting_speeds(duration, speed),
        mean_power=(time * power).sum(axis=0) / np.where(total > 0.0, total, 1.0),
        peak_power=np.abs(torque * speed).max(axis=(0, 1)),
    )
    return Scalars(*map(float, found)) if alone else found


def scalars_by_census(cycle: Any, looked: Census, efficiency: float, peak_speed: float) -> Scalars:
    """Single figures of a long cycle, by its groups of segments.

    Parameters
    ----------
    cycle, looked
        A LoadCycle, and what it is made of.
    efficiency
        Of the belt [1].
    peak_speed
        Its highest speed [rad/s].

    Returns
    -------
    Scalars
        Behind a belt of ratio 1.
    """
    ends = np.array([_slowest(cycle.speed), peak_speed])
    faster = times_above(cycle.duration, cycle.speed)
    one = looked.figures(belt_factors(efficiency))
    held = cycle.held if not np.isnan(cycle.held) else one.at_rest
    return Scalars(
        rms_torque=one.rms_torque, peak_torque=one.peak_torque, held=float(efficiency * held),
        load_torque=float(looked.of(at.MOST_LOAD).max()),
        **lasting_speeds_by(faster, ends, cycle.total, looked.mean_running()),
        mean_power=one.mean_power, peak_power=one.peak_power,
    )  # fmt: skip


def _slowest(speed: Array) -> float:
    """Its least amount at ends of segments, part by part, for a long recording's amounts take room."""
    return min(float(np.abs(speed[k : k + SHORT]).min()) for k in range(0, len(speed), SHORT))


def piece_counts(duration: Array, time_constant: Array, error: float) -> NDArray[np.int64]:
    """In how many pieces segments are cut, so that a winding follows the mean of each.

    Parameters
    ----------
    duration
        Of each segment [s].
    time_constant
        Of what follows a change within each segment [s]; infinite where nothing changes.
    error
        Permitted at the end of a segment, as a share of what the change within it does [1].

    Returns
    -------
    array
        Pieces of each segment, 1 to 200.

    Notes
    -----
    The mean of a changing square of the current heats the end of a segment of length x time constants by x/12 of the
    change too little; in n pieces by x/12n².
    """
    count = np.ceil(np.sqrt(duration / time_constant / (12.0 * error)))
    return np.clip(count, 1, _FINEST).astype(np.int64)
