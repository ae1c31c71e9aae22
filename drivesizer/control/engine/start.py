"""Drives at their start: in equilibrium at the first speed, their matrices computed together."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

import drivesizer.control.engine.layout as at
from drivesizer.control.cascade import Cascade
from drivesizer.control.engine.controllers import feedforward_current
from drivesizer.control.engine.layout import STATE, TALLY, Array
from drivesizer.control.engine.modes import holding_torque, load_torque, mode_of
from drivesizer.control.engine.parameters import resistances, table
from drivesizer.control.engine.task import Drive, MotorHeat, Task
from drivesizer.control.engine.task_pieces import Flags, Part, pieces_of, stretches
from drivesizer.control.linear_modes import columns, discretised
from drivesizer.errors import InputError

__all__ = ["Run", "ready", "tally"]


def _start(p: Array, pieces: Array, heat: MotorHeat | None, ki: tuple[bool, bool]) -> Array:
    """The state in equilibrium at the first speed; ki: whether the outer and the inner loop have an integral."""
    s = np.zeros(len(STATE))
    w, l = pieces[0, 3], pieces[0, 6]
    i, T = _equilibrium(p, w, l)
    s[at.I], s[at.W], s[at.V] = i, w, w / p[at.RATIO]
    if p[at.TWO]:
        s[at.F] = T / p[at.C] + 0.5 * p[at.GAP] * np.sign(T)
    if heat is not None:
        s[at.T_W], s[at.T_H] = (0.0 if math.isnan(x) else x - heat.ambient for x in (heat.winding, heat.housing))
    s[at.RES] = p[at.R_A] + p[at.ALPHA] * s[at.T_W] if p[at.HEAT] else p[at.R25]
    s[at.CODE] = mode_of(p, i, w, s[at.F], s[at.V], l)
    volts = s[at.RES] * i + p[at.K_E] * w  # the integral holds the last demand
    if p[at.CASCADE]:
        known = feedforward_current(p, w, 0.0)
        s[at.OUTER], s[at.INNER] = (i - known) * ki[0], volts * ki[1]
        s[at.I_NEXT], s[at.PEND] = known + s[at.OUTER], s[at.INNER]
    else:
        s[at.PEND] = s[at.OUTER] = volts * ki[0]
    return s


def _equilibrium(p: Array, w: float, l: float) -> tuple[float, float]:
    """Current that keeps a speed, and the driven shaft's torque; none of either where friction holds."""
    k = p[at.K_T]
    if w:
        side = 1 if w > 0.0 else -1
        T = load_torque(p, side) + l + p[at.B_L] * w / p[at.RATIO]
        share = p[at.DRIVE] if T * side > 0.0 else p[at.BRAKE]
        return float((side * p[at.F_M] + p[at.B_M] * w + T * share) / k), float(T)
    T = p[at.T_0] + l
    ends = (T, T) if p[at.TWO] else (p[at.T_F] + l, p[at.T_B] + l)
    if p[at.TWO] and p[at.T_B] <= -l <= p[at.T_F]:
        return 0.0, 0.0
    if holding_torque(p, ends[1], -1) <= 0.0 <= holding_torque(p, ends[0], 1):
        return 0.0, float(T)
    return float(T / (p[at.RATIO] * k)), float(T)


def _ring(p: Array, w: float) -> Array:
    """Counts of the periods before the start."""
    window = int(p[at.WINDOW])
    back = p[at.H] * p[at.N_V] * np.arange(-window, 0)
    return np.asarray(np.floor(w * back * p[at.EDGES] / (2.0 * math.pi)))


@dataclass(slots=True)
class Run:
    """One drive during its simulation."""

    p: Array  # parameters
    s: Array  # state
    g: Array  # tallies, set at the end
    M: Array  # matrices
    scratch: tuple[Array, Array, Array, Array]  # matrices in use, their temperatures, a step, what is steady
    pieces: Array
    parts: list[Part]  # consecutive ranges of the pieces
    long: Flags  # which pieces are long and constant
    unseen: int  # pieces that are simulated and not recorded
    lap: int  # periods of a lap of these
    ring: Array  # counts
    status: int = 0
    cycles: int = 0
    time: float = 0.0  # s
    simulated: float = 0.0  # s of it that were simulated, not added
    slopes: Array | None = None  # of winding and housing at the end, by each at the start; None: not followed


def ready(drives: Sequence[Drive], task: Task, most: int) -> list[Run]:
    """Drives at their start; their matrices are computed together."""
    top = float(np.abs(task.speed).max())
    P = np.array([table(d, top, most) for d in drives], float)
    found: dict[int, Run] = {}
    known: dict[tuple[float, ...], Array] = {}
    for warm in (False, True):
        here = [n for n, p in enumerate(P) if (p[at.HEAT] != 0.0) == warm]
        if not here:
            continue
        resistance = np.array([resistances(P[n]) for n in here])
        with np.errstate(all="ignore"):
            M = discretised(columns([drives[n].train for n in here]), resistance, P[here, at.H])
        if not np.isfinite(M).all():
            raise InputError("the machine's figures leave the range of numbers that can be computed with")
        for m, n in enumerate(here):
            same = tuple(P[n, [at.H, at.RATIO, at.N_V, at.N_P]].tolist())
            if same not in known:
                known[same] = pieces_of(task, P[n])
            found[n] = _begun(P[n], M[m], drives[n], task, known[same], task.cycles > 1 or len(drives) == 1)
    return [found[n] for n in range(len(drives))]


def _begun(p: Array, M: Array, drive: Drive, task: Task, pieces: Array, followed: bool) -> Run:
    """One drive at its start; followed: whether derivatives by the starting temperatures are computed."""
    c = drive.controller
    ki = (c.velocity_ki != 0.0, c.current_ki != 0.0) if isinstance(c, Cascade) else (c.ki != 0.0, False)
    if not len(pieces):
        raise InputError("task: it lies between two samples of the controller")
    parts, long, lap = stretches(pieces, p)
    p[at.SENSE] = followed or bool(long.any()) or any(part.rows for part in parts)
    unseen = 0 if task.since is None else int(np.searchsorted(pieces[:, 2], task.since - task.time[0]))
    work = M[0].copy() if p[at.HEAT] else M[0]
    scratch = work, np.full(M.shape[1:3], math.nan), np.zeros(16), np.zeros(at.STEADY)
    ring = _ring(p, float(pieces[0, 3]))
    return Run(p, _start(p, pieces, drive.heat, ki), tally(), M, scratch, pieces, parts, long, unseen, lap, ring)


def tally() -> Array:
    """Tallies at the start."""
    g = np.zeros(len(TALLY))
    g[[at.G_WINDING, at.G_HOUSING]] = -math.inf
    g[at.G_V_LOW], g[at.G_V_HIGH] = math.inf, -math.inf
    return g
