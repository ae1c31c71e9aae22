"""Load cases that alternate, as one cycle: so many cycles of each as its share of the time says.

A ramp of 10 % of a shift is not the whole shift: heat, energy and the battery follow from the cycle of all of them, and
peaks are those of the worst. A case goes on for one cycle, or for as long as the spec says, before the others come.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from drivesizer.errors import InputError
from drivesizer.load_cases import load_cycle
from drivesizer.physics.load_cycle import LoadCycle, OwnLimit
from drivesizer.spec.robot import RobotSpec

__all__ = ["counts", "cycle_of_shift"]

_OFF = 0.01  # by which a share of the time may be off, of itself
_MOST = 20_000  # segments
_TRIED = 200


def cycle_of_shift(spec: RobotSpec) -> LoadCycle:
    """The load cycle of a spec; where cases of it alternate, the cycle of all of them."""
    if not spec.shift:
        return load_cycle(spec)
    shares, lasting, specs = zip(*spec.shift, strict=True)
    cycles = [load_cycle(one) for one in specs]
    blocks = [max(1, round(time / cycle.total)) for time, cycle in zip(lasting, cycles, strict=True)]
    times = counts(shares, [n * cycle.total for n, cycle in zip(blocks, cycles, strict=True)])
    repeats = [n * block for n, block in zip(times, blocks, strict=True)]
    segments = sum(n * len(cycle.duration) for n, cycle in zip(repeats, cycles, strict=True))
    if segments > _MOST:
        raise InputError(
            f"{spec.where(('cases',))}: cases that alternate by their shares make {segments} segments; expected at "
            f"most {_MOST}, by shares nearer to one another, or a longer lasting"
        )
    in_turn = [cycle for n, cycle in zip(repeats, cycles, strict=True) for _ in range(n)]
    return replace(
        cycles[0],
        duration=np.concatenate([cycle.duration for cycle in in_turn]),
        speed=np.concatenate([cycle.speed for cycle in in_turn]),
        acceleration=np.concatenate([cycle.acceleration for cycle in in_turn]),
        torque=np.concatenate([cycle.torque for cycle in in_turn]),
        inertia=float(np.max([cycle.inertia for cycle in cycles])),
        held=float(np.max([cycle.held for cycle in cycles])),
        own=_worst([limit for cycle in cycles for limit in cycle.own]),
    )


def counts(shares: Sequence[float], times: Sequence[float]) -> list[int]:
    """Numbers of some blocks in the shortest whole in which their shares of the time are right to 1 %.

    Examples
    --------
    >>> counts([0.9, 0.1], [30.0, 30.0]), counts([0.75, 0.25], [10.0, 20.0])
    ([9, 1], [6, 1])
    """
    least = max(time / share for share, time in zip(shares, times, strict=True))
    found: list[tuple[float, list[int]]] = []
    for n in range(1, _TRIED):
        some = [max(1, round(n * least * share / time)) for share, time in zip(shares, times, strict=True)]
        whole = sum(k * time for k, time in zip(some, times, strict=True))
        off = max(abs(k * t / whole / share - 1.0) for k, t, share in zip(some, times, shares, strict=True))
        if off <= _OFF:
            return some
        found.append((off, some))
    return min(found)[1]


def _worst(limits: Sequence[OwnLimit]) -> tuple[OwnLimit, ...]:
    """Of limits of one name that which is nearest to its demand, or past it most."""
    worst: dict[str, OwnLimit] = {}
    for one in limits:
        other = worst.get(one.name)
        if other is None or not one.demand * other.limit <= other.demand * one.limit:
            worst[one.name] = one
    return tuple(worst.values())
