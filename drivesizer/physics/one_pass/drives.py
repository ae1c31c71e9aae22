"""Drives over a long cycle, one after the other: their figures for the pass, and what it finds of each."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import drivesizer.physics.one_pass.layout as at
from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.elements.quadrature import SIX
from drivesizer.physics.groups.census import SHORT, columns_of
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.one_pass.kernel import compiled
from drivesizer.physics.power_stage import Feed
from drivesizer.physics.stress import Heat
from drivesizer.physics.thermal import COPPER, TwoBodies, resistance_25, resistance_at, two_bodies

__all__ = ["Figures", "Found", "Kept", "figures", "is_long", "piece_by_piece", "through"]

Array = NDArray[np.float64]
_PASSED = ("passed", 0.0)  # what was found of drives, by their figures: some are looked at several times
_KEPT = 5  # columns of pieces
_LEAST, _ORDER = -np.inf, SIX  # as many nodes as ``at.POINTS``


class Found(NamedTuple):
    """Peaks, heat and energy over a cycle: columns over drives; NaN unknown."""

    winding: Array  # K, peak over the periodic cycle; infinite at thermal runaway
    winding_time: Array  # s
    voltage: Array  # V, of the winding as warm as it then is
    voltage_time: Array  # s
    copper: Array  # W, mean heat of the winding
    power: Array  # W, largest into the power stage, without standby power
    power_time: Array  # s
    above: Array  # s, longest uninterrupted time above the limit
    drawn: Array  # J per cycle, at the stage and in the supply's resistance, without standby power
    returned: Array  # J per cycle
    stored: Array  # J, the most that is back and not drawn again


class Kept(NamedTuple):
    """Consecutive pieces of a cycle, at the input of the stage, without standby power."""

    duration: Array  # s
    drawn: Array  # J
    returned: Array  # J
    back: Array  # W, largest power out of the stage; 0 where there is none
    out: Array  # W, largest power into it; 0 where there is none
    resisted: float  # J over the cycle, in the supply's resistance


class Figures(NamedTuple):
    """Drives as the pass takes them, and what else they need."""

    table: Array  # a row of each, places as in ``layout``
    ambient: float  # K
    known: NDArray[np.bool_]  # whose course of temperatures can be computed

    def held(self, rows: Any, ends: Array, means: Array) -> Figures:
        """Some of them with windings at given temperatures [K] at the ends of pieces and over them."""
        table = self.table[rows].copy()
        table[:, at.FIXED], table[:, at.AT_ENDS], table[:, at.MEANS] = 1.0, ends - self.ambient, means - self.ambient
        return Figures(table, self.ambient, np.ones(len(table), bool))


def is_long(cycle: AtGearhead) -> bool:
    """Whether a cycle is so long that drives go through it in one pass, where that is at hand as machine code."""
    return len(cycle.load_cycle.duration) > SHORT and compiled() is not None


def figures(
    ambient: float, cycle: AtGearhead, demand: Demands, heat: Heat, motor: Any, feed: Feed, **more: Any
) -> Figures:
    """Drives as the pass takes them.

    Parameters
    ----------
    ambient
        Temperature around the motors [K].
    cycle
        The load cycle behind the belts of the drives.
    demand, heat
        Required torque and current, and losses of the drives: columns.
    motor
        Figures of the motors by field name: columns.
    feed
        Their power stages and the supply.
    more
        ``leads`` that take of the voltage [ohm], ``limit`` of the current [A], share ``kept`` on the bus [1], and what
        is ``wanted``: -1 only the time above the limit, 0 of the winding alone, 1 power and that time too, 2 energy
        too.

    Returns
    -------
    Figures
        In the order of the drives.
    """
    bodies, k_t, stage = two_bodies(motor), motor["torque_constant"], feed.stage
    table = np.zeros((len(k_t), at.FIGURES))
    belt, R_25 = np.asarray(cycle.belt), np.asarray(resistance_25(motor))
    table[:, : at.SPEED + 1] = _currents(cycle, demand.coefficients / k_t[:, None], belt)
    _put_heat(table, bodies, np.asarray(resistance_at(R_25, ambient)), heat, belt)
    columns = {
        at.EMF: demand.back_emf * demand.total_ratio * belt, at.SURPLUS: demand.surplus(k_t) * belt,
        at.R_AMBIENT: resistance_at(R_25, ambient), at.R_RISE: R_25 * COPPER, at.LEADS: more["leads"],
        at.LOSS: stage.loss, at.LEAST_LOSS: stage.least_loss, at.OHM: stage.resistance, at.STANDBY: stage.standby,
        at.SOURCE: feed.voltage, at.RESISTANCE: feed.resistance, at.DRIVES: feed.drives, at.KEPT: more["kept"],
        at.LIMIT: more["limit"], at.WANTED: more["wanted"], at.QUICKEST: cycle.base.quickest,
    }  # fmt: skip
    for place, column in columns.items():
        table[:, place] = column
    table[:, at.INVERSE + 1 : at.INVERSE + at.MOST + 1] = 1.0 / np.arange(1.0, at.MOST + 1.0)
    table[:, at.NODES : at.NODES + at.POINTS] = (_ORDER[0] + 1.0) / 2.0
    table[:, at.NODES + at.POINTS : at.FACTORS] = _ORDER[1] / 2.0
    table[:, at.FACTORS :] = 1.0 / np.cumprod(np.maximum(np.arange(at.TERMS + 1.0), 1.0))
    known = bodies.known & ~np.isnan(table[:, : at.SPEED + 1].sum(axis=1) + heat.friction + heat.iron + ambient)
    return Figures(table, ambient, np.broadcast_to(known, len(table)))


def _currents(cycle: AtGearhead, c: Array, belt: Array) -> Array:
    """Current from what the load cycle has before the belt: shape (drives, 6)."""
    through, e = np.empty_like(c), cycle.base.efficiency
    for place, scale in enumerate((1.0 / e / belt, e / belt, 1.0 / belt, belt, np.ones_like(belt), belt)):
        through[:, place] = c[:, place] * scale
    return through


def _put_heat(table: Array, motor: TwoBodies, cold: Array, heat: Heat, belt: Array) -> None:
    """The constants of ``heat_step``."""
    with np.errstate(divide="ignore", invalid="ignore"):  # of unknown figures
        ratio = motor.R_th2 / motor.R_th1
        columns = {
            at.FEEDBACK: COPPER * motor.R_25 * motor.R_th1 / motor.tau_w, at.W_W: -1.0 / motor.tau_w,
            at.W_H: 1.0 / motor.tau_w, at.H_W: ratio / motor.tau_h, at.H_H: -(1.0 + ratio) / motor.tau_h,
            at.HEAT_W: cold / motor.capacity_w, at.HEAT_H: 1.0 / motor.capacity_h,
            at.FRICTION: heat.friction * belt, at.IRON: heat.iron * belt**2,
        }  # fmt: skip
    for place, column in columns.items():
        table[:, place] = column


def through(cycle: AtGearhead, drives: Figures) -> Found:
    """Drives through a long cycle; those whose winding runs away have an infinite peak and nothing else.

    Parameters
    ----------
    cycle
        The load cycle behind the belts of the drives; the belts are in their figures.
    drives
        What ``figures`` makes of them, all known.

    Returns
    -------
    Found
        Columns over drives.
    """
    pass_over, load = compiled(), cycle.load_cycle
    assert pass_over is not None  # ``is_long`` said so
    columns, strides = columns_of(load)
    known: dict[bytes, tuple[float, ...]] = cycle.base.coarse.setdefault(_PASSED, {})
    new = {row.tobytes(): row.copy() for row in drives.table if row.tobytes() not in known}
    one, threads = partial(_one, pass_over, columns, strides, load.total), min(_threads(), len(new))
    if threads > 1:
        from concurrent.futures import ThreadPoolExecutor  # only a long recording needs it

        with ThreadPoolExecutor(threads) as pool:  # none waits for another: machine code runs without the lock
            known.update(zip(new, pool.map(one, new.values()), strict=True))
    else:
        known.update(zip(new, map(one, new.values()), strict=True))
    rows = [known[row.tobytes()] for row in drives.table]
    found = Found(*np.array(rows).reshape(-1, len(Found._fields)).T)
    return found._replace(winding=found.winding + drives.ambient)


def _threads() -> int:
    """Threads that may compute at once: as many as there are cores, or as the environment has for linear algebra."""
    given = os.environ.get("OMP_NUM_THREADS", "")
    return int(given) if given.isdecimal() else os.cpu_count() or 1


def _one(
    pass_over: Callable[..., int], columns: list[Array], strides: NDArray[np.int64], total: float, d: Array
) -> tuple[float, ...]:
    """One drive."""
    g = _nothing_found()
    if pass_over(d, g, np.zeros(at.CELLS), np.zeros((_KEPT, 1)), *columns, strides):
        return (np.inf, *[np.nan] * (len(Found._fields) - 1))
    winding = (np.nan, np.nan) if d[at.FIXED] else (g[at.WINDING], g[at.WINDING + 2])
    voltage = _peak(g, at.VOLTAGE) if d[at.WANTED] >= 0.0 else (np.nan, np.nan)
    copper = g[at.COPPER] / total
    power = _peak(g, at.POWER) if d[at.WANTED] >= 1.0 else (np.nan, np.nan)
    above = _above(g, d[at.LIMIT]) if d[at.WANTED] != 0.0 else np.nan
    energy = (g[at.DRAWN], g[at.RETURNED], _stored(g)) if d[at.WANTED] >= 2.0 else (np.nan,) * 3
    return (*winding, *voltage, copper, *power, above, *energy)


def _nothing_found() -> Array:
    g = np.zeros(at.FOUND)
    for place in (at.WINDING, at.VOLTAGE, at.POWER):
        g[place : place + 2] = _LEAST
    g[at.BEGIN] = -1.0
    return g


def piece_by_piece(cycle: AtGearhead, drive: Figures, *, each: bool) -> Kept | None:
    """Energy that one drive draws and returns, in the pieces of which its winding feels the mean.

    Parameters
    ----------
    cycle
        The load cycle behind its belt.
    drive
        Its figures.
    each
        Keep each piece, and not those in a row that return nothing as one.

    Returns
    -------
    Kept or None
        None where its winding runs away or its course of temperatures is not known.
    """
    pass_over = compiled()
    assert pass_over is not None  # ``is_long`` said so
    if not drive.known.all():
        return None
    columns, strides = columns_of(cycle.load_cycle)
    d, g, kept = drive.table[0].copy(), _nothing_found(), np.empty((_KEPT, cycle.base.pieces))  # unused takes no memory
    d[at.WANTED] = 4.0 if each else 3.0
    if pass_over(d, g, np.zeros(at.CELLS), kept, *columns, strides):
        return None
    duration, drawn, returned, back, out = kept[:, : int(g[at.KEPT_PIECES])]
    resisted = float(g[at.DRAWN] - drawn.sum()) if d[at.RESISTANCE] > 0.0 else 0.0
    return Kept(duration, drawn, returned, back, out, resisted)


def _peak(g: Array, place: int) -> tuple[float, float]:
    """Value and time; of an unknown value the cycle's start."""
    return g[place], 0.0 if np.isnan(g[place]) else g[place + 2]


def _above(g: Array, limit: float) -> float:
    """The longest time above the limit, in a cycle that repeats; as ``waveform.longest_run`` has it."""
    total, first, begin = (float(g[place]) for place in (at.TIME, at.FIRST, at.BEGIN))
    if np.isnan(limit):
        return np.nan
    if begin < 0.0:
        return total
    return max(max(float(g[at.RUN]), total - begin + first) - 8 * float(np.spacing(total)), 0.0)


def _stored(g: Array) -> float:
    """Largest rise of the store over a cycle that repeats; infinite where more comes than goes."""
    end, low, high, rise, came = (float(g[place]) for place in (at.SUM, at.LOWEST, at.HIGHEST, at.RISEN, at.CAME))
    if np.isnan(end):
        return np.nan
    if end > 0.0:
        return np.inf
    return min(max(rise, end + high - low), came)
