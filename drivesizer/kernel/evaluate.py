"""Drives over load cycles: ``evaluate`` figures of many, ``pieces`` one over time; as machine code, on all cores.

``drives_of`` makes columns for the kernel of those that the search, a record and samples have.
"""

from __future__ import annotations

import os
from functools import partial

import numpy as np

from drivesizer.kernel.cycle import ACCOUNT, Course
from drivesizer.kernel.kernel import compiled
from drivesizer.kernel.records import Drive, Figures, Piece
from drivesizer.physics.cycle_at_gearhead import ACCELERATION, AT_REST, BRAKING, DIRECTION, DRIVING, SPEED, AtGearhead
from drivesizer.physics.drive_train import COMMUTATION_BAND, commutation
from drivesizer.physics.figures import Alike, Array, Whole
from drivesizer.physics.figures import Figures as PartFigures
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.power_stage import Feed
from drivesizer.physics.thermal import COPPER, resistance_at, two_bodies
from drivesizer.physics.winding import Heat

_ERROR = 1e-3  # of what a change within a segment does to the winding at its end
_COUNT = -1  # level of a call that only counts pieces
_A_THREAD = 20_000  # drives times segments that are worth a thread


def drives_of(
    ambient: Alike,
    cycle: AtGearhead,
    demand: Demands,
    heating: Heat,
    motor: PartFigures,
    feed: Feed,
    *,
    leads: Alike = 0.0,
    bus_share: Alike = 0.0,
    limit: Alike = np.nan,
    error: float = _ERROR,
    band: tuple[float, float] = COMMUTATION_BAND,
    cold: bool = False,
) -> Drive:
    """Drives as columns; a winding whose course cannot be computed has to be held at a rise.

    Parameters
    ----------
    ambient
        Temperature around the motors [K].
    cycle
        The load cycle behind their belts; the kernel takes that at the load.
    demand, heating
        Required torque and current, and losses.
    motor
        Figures of the motors by field name.
    feed
        Their power stages and the supply.
    leads
        Resistance that takes of the voltage before the winding [ohm].
    bus_share
        Share of what is returned that stays on the bus [1].
    limit
        Current of which the time above counts [A].
    error
        Permitted at the end of a segment, as a share of what the change within it does to the winding [1]; a cycle of
        several samples is cut by the time constant of each, another by the shortest.
    band
        Of what commutation takes of the voltage, least and most of ``drive_train.commutation`` [1].
    cold
        Whether the cycle is run once, from the temperature around the motors; else it repeats.

    Returns
    -------
    Drive
        Columns.
    """
    bodies, k_t, belt, e = two_bodies(motor), motor["torque_constant"], np.asarray(cycle.belt), cycle.base.efficiency
    several = cycle.base.load_cycle.speed.shape[2:]
    c, stage = demand.coefficients / np.reshape(k_t, (-1, 1)), feed.stage
    X = commutation(motor) * demand.total_ratio * belt
    with np.errstate(divide="ignore", invalid="ignore"):  # of unknown figures
        C_w, C_h = bodies.capacity_w, bodies.capacity_h
    drive = Drive(
        driving=c[:, DRIVING] / e / belt,
        braking=c[:, BRAKING] * e / belt,
        resting=c[:, AT_REST] / belt,
        accelerating=c[:, ACCELERATION] * belt,
        direction=c[:, DIRECTION],
        turning=c[:, SPEED] * belt,
        emf=demand.back_emf * demand.total_ratio * belt,
        surplus=demand.surplus(k_t) * belt,
        R=resistance_at(bodies.R_25, ambient),
        R_rise=np.asarray(bodies.R_25) * COPPER,
        R_th1=bodies.R_th1,
        R_th2=bodies.R_th2,
        C_w=C_w,
        C_h=C_h,
        friction=heating.friction * belt,
        iron=heating.iron * belt**2,
        permitted=motor["max_winding_temperature"] - ambient,
        course=1.0,
        rise=np.nan,
        mean_rise=np.nan,
        finest=12.0 * error * np.asarray(bodies.tau_w if several else cycle.base.quickest),
        leads=leads,
        loss=stage.loss,
        least_loss=stage.least_loss,
        R_stage=stage.resistance,
        standby=stage.standby,
        V_0=feed.voltage,
        R_source=feed.resistance,
        drives=float(feed.drives),
        bus_share=bus_share,
        limit=limit,
        commutation=band[1] * X,
        least_commutation=band[0] * X,
    )
    if cold:
        drive = drive._replace(winding_start=0.0, housing_start=0.0)
    current = sum(drive[:6])
    known = bodies.known & ~np.isnan(current + heating.friction + heating.iron + ambient)
    shape = np.broadcast_shapes(np.shape(current), several)
    return drive._replace(course=np.broadcast_to(known, shape).astype(float))


def at_rise(drives: Drive, rise: Alike, mean: Alike) -> Drive:
    """Drives with windings at given rises."""
    return drives._replace(course=np.zeros_like(drives.course), rise=rise, mean_rise=mean)


def evaluate(drives: Drive, cycle: LoadCycle | Course, level: int, rows: Whole | None = None) -> Figures:
    """Figures of drives over a load cycle that repeats.

    Parameters
    ----------
    drives
        Columns that broadcast to (drives,) or (drives, samples).
    cycle
        ``duration``, ``speed``, ``acceleration`` and ``torque`` of the load, with a last axis of samples or none.
    level
        ``HEAT``: current, winding and voltage; ``POWER`` too; ``ENERGY`` too; ``ACCOUNT``: what motors take too.
    rows
        Of drives or samples along one axis those that are computed; all, where there are none.

    Returns
    -------
    Figures
        Columns of that shape, or of these rows.
    """
    whole = np.broadcast_shapes(*map(np.shape, drives))
    shape = whole if rows is None else rows.shape
    columns = np.empty((*shape, len(drives)))
    for k, column in enumerate(drives):
        columns[..., k] = column if rows is None or not np.ndim(column) else np.broadcast_to(column, whole)[rows]
    table = columns.reshape(-1, len(drives))
    figures = np.empty((len(table), len(Figures._fields)))
    (arrays, steps, segments, cycles), samples = _laid_out(cycle), np.arange(len(table)) if rows is None else rows
    size = max(-(-len(table) // _threads()), _A_THREAD // segments, 1)
    run = partial(_rows, table, figures, arrays, steps, samples % cycles, (segments, level), size)
    if len(table) > size:
        from concurrent.futures import ThreadPoolExecutor  # only many drives need it

        with ThreadPoolExecutor(_threads()) as pool:  # none waits for another: machine code runs without the lock
            list(pool.map(run, range(0, len(table), size)))
    elif len(table):
        run(0)
    return Figures(*(figures[:, k].reshape(shape) for k in range(figures.shape[1])))


def pieces(
    drive: Drive, cycle: LoadCycle | Course, cuts: int = 1, most: int = 0, *, merged: bool = False
) -> tuple[Figures, Piece]:
    """One drive over a load cycle that repeats: its figures, and its course over time.

    Each piece is cut into ``cuts`` parts, or fewer, so that there are at most ``most`` where that is given; 0: pieces
    in a row that return nothing are one, as they are with ``merged`` where there are more than ``most``.
    """
    table, columns = np.array([float(np.squeeze(x)) for x in drive])[None], _laid_out(cycle)
    count = _of_one(table, columns, _COUNT, 1, np.empty((0, len(Piece._fields))))[1]
    if most:
        cuts = 0 if merged and count > most else max(1, min(cuts, most // count))
    rows = np.empty((count * max(cuts, 1), len(Piece._fields)))  # unused it takes no memory
    figures = _of_one(table, columns, ACCOUNT, cuts, rows)[0]
    return figures, Piece(*rows[: int(figures.pieces[0])].T)


def _of_one(table: Array, columns: Laid, level: int, cuts: int, rows: Array) -> tuple[Figures, int]:
    """One drive, and a number that is given back."""
    figures, (arrays, steps, segments, _) = np.empty((1, len(Figures._fields))), columns
    sizes = np.array([segments, level, cuts])
    number = compiled()(table, figures, *arrays, steps, np.zeros(1, np.int64), sizes, rows)
    return Figures(*figures.T), number


def _rows(
    table: Array, figures: Array, arrays: list[Array], steps: Whole, samples: Whole, sizes: tuple[int, int], size: int,
    first: int,
) -> None:  # fmt: skip
    """Some drives in one thread."""
    rows, nothing = slice(first, first + size), np.empty((0, len(Piece._fields)))
    compiled()(table[rows], figures[rows], *arrays, steps, samples[rows], np.array([*sizes, 1]), nothing)


Laid = tuple[list[Array], Whole, int, int]


def _laid_out(cycle: LoadCycle | Course) -> Laid:
    """Columns as they lie in memory, steps from segment to segment, end to end and cycle to cycle, and both numbers."""
    columns = [cycle.duration, cycle.speed, cycle.acceleration, cycle.torque]
    several = max(x.shape[-1] for x in columns) if cycle.speed.ndim == 3 else 1
    laid = [_flat(x, n == 0) for n, x in enumerate(columns)]
    return [x for x, _ in laid], np.array([steps for _, steps in laid]), len(cycle.duration), several


def _flat(x: Array, single: bool) -> tuple[Array, list[int]]:
    """A column as it lies in memory: ends that neighbours share, or that are there once, are not written out."""
    x = x[:, None] if single else x
    x = x[..., None] if x.ndim == 2 else x
    steps = [0 if n == 1 else step // x.itemsize for n, step in zip(x.shape, x.strides, strict=True)]
    if min(steps) < 0 or any(step % x.itemsize for step in x.strides):
        return _flat(np.ascontiguousarray(x), False)
    count = sum((n - 1) * step for n, step in zip(x.shape, steps, strict=True)) + 1
    return np.lib.stride_tricks.as_strided(x, (count,), (x.itemsize,)), steps


def _threads() -> int:
    """Threads that may compute at once: as many as there are cores, or as the environment has for linear algebra."""
    threads = os.environ.get("OMP_NUM_THREADS", "")
    return int(threads) if threads.isdecimal() else os.cpu_count() or 1
