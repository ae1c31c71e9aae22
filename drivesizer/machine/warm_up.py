"""Warm-up of a motor from cold to the periodic steady state: for figures.

Within pieces of constant losses both bodies move in closed form (see ``heat_step``); a cycle maps the rises at its
start to those at its end, so that any later cycle is reached by powers of that map and none has to be gone through.
Symbols: w winding and h housing: rises over ambient [K].
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.machine.set_cycle import Warming
from drivesizer.physics.heat_cycle import HeatCycle, periodic, periodic_heat
from drivesizer.physics.heat_step import Course
from drivesizer.physics.thermal import TwoBodies

__all__ = ["WarmUp", "finer", "warm_up"]

Array = NDArray[np.float64]
_NEAR = 0.01  # of the rise from cold: no visible change any more
_SHOWN = 60  # cycles of which temperatures are reported
_MOST = 1e7  # cycles: longer nobody waits
_STEP = 0.25  # of the winding's time constant, the first piece of a span
_PIECES = 24  # of a span, each longer than the one before


class WarmUp(NamedTuple):
    """Temperatures from cold to the periodic steady state [K]."""

    time: Array  # s, at the end of each of these cycles; 0 first
    lowest: Array  # K, of the winding in each of these cycles
    highest: Array
    housing: Array  # K, at these times
    periodic: HeatCycle


def finer(found: Warming, constant: float) -> Warming:
    """The same pieces, cut so that a curve through their ends shows how the winding follows."""
    first = np.minimum(_STEP * constant / found.duration, 1.0)
    count = np.where(first < 1.0 / _PIECES, _PIECES, np.ceil(1.0 / first)).astype(np.int64)
    owner = np.repeat(np.arange(len(count)), count)
    place = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
    even, power = place / count[owner], np.maximum(1.0, np.log(first) / -np.log(np.maximum(count, 2)))[owner]
    start, end = even**power, ((place + 1) / count[owner]) ** power
    return Warming(found.duration[owner] * (end - start), found.square[owner], found.loss[owner])


def warm_up(motor: TwoBodies, ambient: float, found: Warming) -> WarmUp | None:
    """Temperatures from cold to the periodic steady state; None where a figure is unknown or the motor runs away."""
    if not motor.known:
        return None
    some = finer(found, float(motor.tau_w))
    cycle = periodic_heat(motor, ambient, some.duration, some.square, some.loss)
    if not math.isfinite(cycle.winding_peak):
        return None
    course, settled = _approach(motor, ambient, some), np.array([cycle.winding[0], cycle.housing[0]]) - ambient
    one_more = np.stack([course.rises(*unit)[:, -1, 0] for unit in np.eye(2)], axis=1)
    numbers = _numbers(cycle.spectral_radius)
    starts = [-(np.linalg.matrix_power(one_more, n) @ settled) for n in numbers]  # K, from the cycle that repeats
    away = [np.column_stack([start, course.rises(*start)[:, :, 0]]) for start in starts]
    winding = [cycle.winding + x[0] for x in away]
    return WarmUp(
        time=np.append(0.0, (np.array(numbers) + 1) * float(found.duration.sum())),
        lowest=np.array([x.min() for x in winding]),
        highest=np.array([x.max() for x in winding]),
        housing=np.append(ambient, [cycle.housing[-1] + x[1, -1] for x in away]),
        periodic=cycle,
    )


def _approach(motor: TwoBodies, ambient: float, found: Warming) -> Course:
    """Decay of the difference to the periodic steady state, piece by piece: the same equations without a source."""
    some = periodic(motor, ambient, *(x[:, None] for x in found))
    maps = np.zeros((2, 3, len(found.duration), 1))
    for column, unit in enumerate(np.eye(2)):
        slopes = some.span.slopes(*unit)
        for row, (slope, pull) in enumerate(zip(slopes, some.span.pulls(*slopes), strict=True)):
            maps[row, column] = some.weight.slope * slope + some.weight.pull * pull
    return Course(maps)


def _numbers(radius: float) -> list[int]:
    """Cycles of which temperatures are reported: all, or some, until a share of the rise is left."""
    last = math.log(_NEAR) / math.log(radius) if radius > 0.0 else 0.0
    count = int(min(max(math.ceil(last), 3), _MOST))
    return sorted({round(n) for n in np.linspace(0, count - 1, min(count, _SHOWN))})
