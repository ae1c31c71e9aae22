r"""The motor's own torque piece by piece: accelerate, run, brake, rest, and the whole cycle.

Torque of the motor is :math:`c f(t)`, its coefficients times the six functions of the load cycle (``physics``), rotor
and friction included; its current that over :math:`k_t`. Segments of one kind that follow one another are one piece:
speed and its change decide the kind. The RMS over the whole is that of all pieces,
:math:`\tau_{rms} = \sqrt{\sum \tau_k^2 t_k / \sum t_k}`.

Worked example: a load of 0.474 kg·cm² and 0.035 N·m at a motor of 0.00629 kg·cm² takes 0.186 N·m to reach 3000 rpm in
0.1 s (Yaskawa, E-S series product manual, 2.4.1, verification of the servomotor).
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from math import nan

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.extremes import first_largest
from drivesizer.physics.groups import layout as at
from drivesizer.physics.groups.census import LEVEL, Census, Group
from drivesizer.physics.load_cycle import rms
from drivesizer.physics.motor_demand import Demands
from drivesizer.results.pieces import MotorPiece

__all__ = ["motor_pieces"]

_MOST = 24  # pieces; where there are more, those of one kind are put together
_KINDS = {(0, 0): "rest", (1, 0): "run", (1, 1): "accelerate", (1, -1): "brake"}
_MOTIONS = ("rest", "brake", "run", "accelerate", "brake back", "run back", "accelerate back")  # as in ``groups``
Array = NDArray[np.float64]


def motor_pieces(cycle: AtGearhead, demand: Demands, torque_constant: float, case: str = "") -> tuple[MotorPiece, ...]:
    """The pieces of a drive's cycle in the order of time, and last the whole of it."""
    load, looked = cycle.load_cycle, cycle.base.census
    if looked is not None and looked.runs > _MOST:
        return _of_kinds(cycle, looked, demand, torque_constant, case)
    torque = cycle.functions @ demand.coefficients[0] if demand.complete[0] else np.full_like(load.torque, nan)
    speed = np.abs(load.speed) * cycle.belt * float(demand.total_ratio[0])
    start = np.cumsum(load.duration) - load.duration

    def piece(name: str, rows: NDArray[np.int64]) -> MotorPiece:
        mean = rms(load.duration[rows], torque[rows])
        most = _largest(torque[rows])
        return MotorPiece(
            case=case, name=name, start=float(start[rows[0]]), duration=float(load.duration[rows].sum()),
            speed=float(speed[rows].max()), load_torque=_largest(load.torque[rows]), motor_torque=most,
            rms_torque=mean, current=abs(most) / torque_constant, rms_current=mean / torque_constant,
        )  # fmt: skip

    whole = np.arange(len(load.duration))
    return *(piece(name, rows) for name, rows in _grouped(_names(load.speed, load.acceleration))), piece("cycle", whole)


def _names(speed: Array, acceleration: Array) -> list[str]:
    """The kind of each segment."""
    mean, slope = speed.mean(axis=1), acceleration.mean(axis=1)
    level = np.abs(slope) <= LEVEL * np.abs(acceleration).max()
    going = np.sign(mean).astype(int)
    gaining = np.where(level, 0, np.sign(slope * going)).astype(int)
    return [
        _KINDS[abs(g), s if g else 0] + (" back" if g < 0 else "")
        for g, s in zip(going.tolist(), gaining.tolist(), strict=True)
    ]


def _grouped(names: list[str]) -> Iterator[tuple[str, NDArray[np.int64]]]:
    """Rows of each piece: segments of one kind that follow one another, or all of a kind where pieces are many."""
    edges = [0, *(n for n in range(1, len(names)) if names[n] != names[n - 1]), len(names)]
    if len(edges) - 1 <= _MOST:
        yield from ((names[a], np.arange(a, b)) for a, b in pairwise(edges))
        return
    for name in dict.fromkeys(names):
        yield name, np.flatnonzero([one == name for one in names])


def _of_kinds(
    cycle: AtGearhead, looked: Census, demand: Demands, torque_constant: float, case: str
) -> tuple[MotorPiece, ...]:
    """The same of a long cycle, all segments of a kind together, from what it is made of."""
    c, total_ratio = demand.coefficients[0] * cycle.scale, float(demand.total_ratio[0])
    c = c if demand.complete[0] else np.full(6, nan)
    factors = cycle.base.factors

    def piece(name: str, groups: list[Group]) -> MotorPiece:
        duration = sum(float(one.sums[at.LASTS]) for one in groups)
        square = sum(float(c @ one.moments(factors[one.torque]) @ c) for one in groups)
        mean = float(np.sqrt(max(square, 0.0) / duration)) if demand.complete[0] else nan
        most = _farthest([one.functions(k, factors[one.torque]) @ c for k in range(2) for one in groups])
        load = _farthest([one.functions(k, 1.0)[:, one.torque] for k in range(2) for one in groups])
        return MotorPiece(
            case=case, name=name, start=min(float(one.sums[at.STARTS]) for one in groups), duration=duration,
            speed=max(float(one.sums[at.MOST_W]) for one in groups) * cycle.belt * total_ratio, load_torque=load,
            motor_torque=most, rms_torque=mean, current=abs(most) / torque_constant,
            rms_current=mean / torque_constant,
        )  # fmt: skip

    kinds = sorted({one.motion for one in looked.groups}, key=lambda k: min(looked.starts(k)))
    of = {k: [one for one in looked.groups if one.motion == k] for k in kinds}
    return *(piece(_MOTIONS[k], of[k]) for k in kinds), piece("cycle", looked.groups)


def _farthest(values: list[Array]) -> float:
    """The value of the largest amount, with its sign."""
    return _largest(np.concatenate(values))


def _largest(values: Array) -> float:
    """The value of the largest amount, with its sign."""
    flat = values.ravel()
    return float(flat[first_largest(np.abs(flat))[1]])
