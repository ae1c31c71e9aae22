"""Drives with controllers and limits and the motion required of them, at their start by the names of ``layout``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import drivesizer.control.engine.layout as at
from drivesizer.control.drive_train import DriveTrain, Mechanics, columns, discretised
from drivesizer.control.engine.kernel import feedforward_current, holding_torque, mode_of
from drivesizer.control.engine.layout import PARAMETERS, STATE, TALLY, Array
from drivesizer.control.validation import Cascade, Gains
from drivesizer.errors import InputError
from drivesizer.physics.thermal import COPPER, DATA_TEMPERATURE, TwoBodies


@dataclass(frozen=True, slots=True, kw_only=True)
class Supply:
    """The bus that feeds a number of equal drives, and the controller's voltage range.

    What is regenerated a brake chopper or a battery takes: it does not raise the bus.
    """

    voltage: float  # V, without load
    resistance: float = 0.0  # ohm, of the source and its cables
    sets: int = 1
    max_duty: float = 1.0
    voltage_drop: float = 0.0  # V
    loss: float = 0.0  # W/A, of each power stage
    stage_resistance: float = 0.0  # ohm, of each power stage
    standby: float = 0.0  # W, of each controller
    leads: float = 0.0  # ohm, that take of the voltage at full duty (``physics.power_stage``); of its check


@dataclass(frozen=True, slots=True, kw_only=True)
class CurrentLimit:
    """Peak current for its time, then the continuous one (integral of I^2 - I_cont^2); infinite: none, or not known."""

    peak: float = math.inf  # A
    continuous: float = math.inf  # A
    peak_time: float = math.inf  # s, at the peak from rest


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorHeat:
    """Winding and housing, and where they start."""

    bodies: TwoBodies
    ambient: float  # K
    winding: float = math.nan  # K at the start; NaN: ambient
    housing: float = math.nan  # K at the start; NaN: ambient
    loss_torque: float = 0.0  # N*m at the housing: times the speed
    loss_viscous: float = 0.0  # N*m*s/rad at the housing: times the square of the speed


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """One drive: drive train, controller, supply, limits."""

    train: DriveTrain
    controller: Gains | Cascade
    supply: Supply
    current: CurrentLimit = CurrentLimit()
    edges: int = 0  # per turn of the motor, that are counted for its speed and angle; 0: both are measured exactly
    heat: MotorHeat | None = None  # None: the winding stays at 25 degC
    drain_time: float = math.inf  # s, in which the integral drains to 1/e at rest, where friction holds
    prompt: bool = False  # cascade: the current loop responds at once, not a period late (see ``slower``)


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """Required motion and load of the driven shaft; straight lines between the corners."""

    time: Sequence[float] | Array  # s, strictly rising
    speed: Sequence[float] | Array  # rad/s of the driven shaft
    load_time: Sequence[float] | Array = ()  # s, strictly rising
    load_torque: Sequence[float] | Array = ()  # N*m, added to the drive train's own; constant beyond the corners
    cycles: int = 1  # number of repetitions; the length is then rounded up to whole samples of the slowest loop


# -- A task as straight pieces between samples.
#
# A corner between two samples takes effect at the next one. A piece shorter than a sample is left out, or ends at
# the values of reference and load a sample later, so that a jump lasts a sample at most.


_WHOLE = 1e-9  # a corner this near to a sample, in periods, is on it
_ROUNDING = 8.0 * np.finfo(float).eps  # of a time, the same


def pieces_of(task: Task, p: Array) -> Array:
    """A task as pieces between samples, at the motor shaft."""
    h, K, origin = p[at.H], p[at.RATIO], task.time[0]
    time, speed = np.asarray(task.time, float) - origin, np.asarray(task.speed, float) * K
    if not time[-1] / h < 2.0**53:
        raise InputError(f"task: {time[-1]:g} s is too long to be sampled every {h:g} s")
    load = np.array([0.0]), np.array([0.0])
    if len(task.load_time):
        load = np.asarray(task.load_time, float) - origin, np.asarray(task.load_torque, float)
    starts = np.unique(np.concatenate((time, load[0][(load[0] > 0.0) & (load[0] < time[-1])])))
    # the sample at which each corner takes effect; corners closer than rounding share one
    slack = _WHOLE + _ROUNDING * starts / h
    apart = np.concatenate(([True], np.diff(starts) > 2.0 * h * slack[1:]))
    tick = np.ceil(starts / h - slack)[np.maximum.accumulate(np.where(apart, np.arange(len(starts)), 0))]
    if task.cycles > 1:
        whole = p[at.N_V] * max(p[at.N_P], 1.0)  # periods after which all loops are at the same sample again
        tick[-1] = np.ceil(tick[-1] / whole - _WHOLE) * whole
    places = np.flatnonzero(tick[1:] > tick[:-1])
    first, last, start = tick[places], tick[places + 1], starts[places]
    short = (starts[places + 1] - start < h) & (last - first == 1.0)
    corner = np.isin(start, time)
    start = np.where(short, np.maximum(start, first * h), start)
    later = np.where(short, (first + 1.0 - _WHOLE) * h, start)
    (v, slope), (l, dl) = line(start, time, speed), line(start, *load)
    slope = np.where(short, (line(later, time, speed)[0] - v) / h, slope)
    dl = np.where(short, (line(later, *load)[0] - l) / h, dl)
    n = np.clip(np.searchsorted(time, start, "right") - 1, 0, len(time) - 2)
    turned = np.concatenate(([0.0], np.cumsum(np.diff(time) * (speed[1:] + speed[:-1]) / 2.0)))[n]
    angle = turned + (start - time[n]) * (speed[n] + line(start, time, speed)[0]) / 2.0  # rad, of the reference
    return np.column_stack((first, last, start, v, slope, angle, l, dl, corner))


def line(x: Array, corners: Array, values: Array) -> tuple[Array, Array]:
    """Value and slope to the right of some points of straight lines between corners; constant beyond them."""
    n = np.searchsorted(corners, x, "right") - 1
    inside = (n >= 0) & (n < len(corners) - 1)
    a, b = np.where(inside, n, 0), np.where(inside, n + 1, 0)
    rise, run = values[b] - values[a], np.where(inside, corners[b] - corners[a], 1.0)
    slope = np.where(inside, rise / run, 0.0)
    beyond = np.where(n < 0, values[0], values[-1])
    return np.where(inside, values[a] + slope * (x - corners[a]), beyond), slope


# -- A drive by the names of ``layout``: drive train, controller, limits, heat.


STILL, STILL_WARM = 1e-12, 1e-9  # change over a sample that is neglected, of full scale; while the resistance changes
_RESTS = 1e-4  # of full speed, below which a motor counts as at rest: what is left is a loop settling
_HEAT_PERIODS, _SLOW = (
    16.0,
    1e4,
)  # periods after which derivatives of slow temperatures follow; periods in a time constant
_NODES, _NODE = 24, 20.0  # nodes of temperature, and K between them: the modes are met to 4e-6 of themselves


def mechanical(m: Mechanics) -> dict[str, float]:
    """Rotor, gears and load by the names of the parameters."""
    driving, braking = m.shares
    return {
        "J_M": m.motor_inertia, "F_M": m.friction, "RATIO": m.ratio, "DRIVE": driving, "BRAKE": braking,
        "J_L": m.load_inertia, "T_F": m.forward_torque, "T_B": m.backward_torque, "T_0": m.rest_torque,
    }  # fmt: skip


def table(drive: Drive, top: float, most: int) -> list[float]:
    """A drive as parameters of the simulation."""
    m, c, supply, limit = drive.train, drive.controller, drive.supply, drive.current
    volts = supply.voltage if supply.voltage < math.inf else 2.0 * m.back_emf_constant * m.ratio * max(top, 1.0)
    full_i, full_w = volts / m.resistance, volts / m.back_emf_constant
    tight = STILL if drive.heat is None else STILL_WARM
    square = limit.continuous**2
    budget = (limit.peak**2 - square) * limit.peak_time if math.isfinite(square) else math.inf
    named = mechanical(m) | {
        "R25": m.resistance, "K_T": m.torque_constant, "K_E": m.back_emf_constant, "B_M": m.viscous,
        "C": m.stiffness if m.flexible else 0.0, "DAMP": m.damping, "GAP": m.gap, "G_0": 1.0 / m.belt_ratio,
        "G_D": 1.0 / (m.belt_ratio * m.belt_efficiency), "G_B": m.belt_efficiency / m.belt_ratio,
        "TWO": float(m.flexible), "EDGES": drive.edges, "WINDOW": max(c.counted_over, 1),
        "V_0": supply.voltage, "R_S": supply.resistance, "SETS": supply.sets, "DUTY": supply.max_duty,
        "DROP": supply.voltage_drop, "LOSS": supply.loss, "R_B": supply.stage_resistance, "STANDBY": supply.standby,
        "LEADS": supply.leads, "X_C": m.commutation, "PEAK": limit.peak, "CONT2": square,
        "BUDGET": max(budget, 0.0) if not math.isnan(budget) else math.inf, "MOST": most,
        "TOL_I": tight * full_i, "TOL_W": tight * full_w, "TOL_U": tight * volts, "RESTS": _RESTS * full_w,
        "TOL_F": tight * m.ratio * m.torque_constant * full_i / m.stiffness if m.flexible else math.inf,
        "TOL_X": math.inf, "AMBIENT": DATA_TEMPERATURE, "HEAT_PERIODS": 1.0, "AHEAD": 1.0,
        "FFV": c.feedforward_velocity, "FFF": c.feedforward_friction, "FFA": c.feedforward_acceleration,
    }  # fmt: skip
    if isinstance(c, Gains):
        velocity, kp, ki, kd = c.period, c.kp, c.ki, c.kd
        named |= {"H": c.period, "N_V": 1.0}
    else:
        velocity, kp, ki, kd = c.velocity_period, c.velocity_kp, c.velocity_ki, c.velocity_kd
        named |= {
            "CASCADE": 1.0, "H": c.current_period, "N_V": c.current_steps, "N_P": c.velocity_steps,
            "CKP": c.current_kp, "CKI": c.current_ki * c.current_period,
            "PKP": c.position_kp if c.velocity_steps else 0.0,
            "AHEAD": float(c.planned_speed or not c.velocity_steps), "SOON": float(not c.computing),
            "PROMPT": float(drive.prompt),
            "TOL_X": named["TOL_W"] / c.position_kp if c.velocity_steps else math.inf,
        }  # fmt: skip
    filtered = c.filter_time + velocity
    named |= {"KP": kp, "KI": ki * velocity, "KD": kd / filtered, "KEEP": c.filter_time / filtered,
              "KEPT": math.exp(-velocity / drive.drain_time)}  # fmt: skip
    if (heat := drive.heat) is not None:
        b: Any = heat.bodies
        low = min(heat.ambient, *(x for x in (heat.winding, heat.housing) if not math.isnan(x)), heat.ambient)
        to_w, to_h = 1.0 / (b.R_th1 * b.capacity_w), 1.0 / (b.R_th1 * b.capacity_h)
        at_ambient = b.R_25 * (1.0 + COPPER * (heat.ambient - DATA_TEMPERATURE))
        named |= {
            "HEAT": 1.0, "R_A": at_ambient, "ALPHA": COPPER * b.R_25, "AMBIENT": heat.ambient,
            "FEEDBACK": COPPER * b.R_25 / b.capacity_w, "A_WW": -to_w, "A_WH": to_w, "A_HW": to_h,
            "A_HH": -to_h - 1.0 / (b.R_th2 * b.capacity_h), "BY_SQUARE": at_ambient / b.capacity_w,
            "BY_LOSS": 1.0 / b.capacity_h, "P_1": heat.loss_torque, "P_2": heat.loss_viscous,
            "NODE_0": low - heat.ambient - _NODE, "NODE_D": _NODE, "NODES": _NODES,
            "HEAT_PERIODS": _HEAT_PERIODS if b.tau_w > _SLOW * velocity else 1.0,
        }  # fmt: skip
    return [float(named.get(name, 0.0)) for name in PARAMETERS]


# -- Drives at their start: in equilibrium at the first speed, their matrices computed together.


def _start(p: Array, pieces: Array, drive: Drive, ki: tuple[bool, bool]) -> Array:
    """The state in equilibrium at the first speed; ki: whether the outer and the inner loop have an integral."""
    s, heat = np.zeros(len(STATE)), drive.heat
    w, l = float(pieces[0, 3]), float(pieces[0, 6])
    i, T = _equilibrium(drive.train, p, w, l)
    s[at.I], s[at.W], s[at.V] = i, w, w / p[at.RATIO]
    if p[at.TWO]:
        s[at.F] = T / p[at.C] + 0.5 * p[at.GAP] * np.sign(T)
    if heat is not None:
        s[at.T_W], s[at.T_H] = (0.0 if math.isnan(x) else x - heat.ambient for x in (heat.winding, heat.housing))
    s[at.RES] = p[at.R_A] + p[at.ALPHA] * s[at.T_W] if p[at.HEAT] else p[at.R25]
    s[at.CODE] = mode_of(p, i, w, s[at.F], s[at.V], l)
    volts = s[at.RES] * i + p[at.K_E] * w  # the integral holds the last demand
    known = feedforward_current(p, w, 0.0)
    if p[at.CASCADE]:
        s[at.OUTER], s[at.INNER] = (i - known) * ki[0], volts * ki[1]
        s[at.I_NEXT], s[at.PEND] = known + s[at.OUTER], s[at.INNER]
        if not p[at.AHEAD]:  # the position loop alone demands the speed
            s[at.W_ADD] = s[at.W_NEXT] = w
            s[at.X] = -w / p[at.PKP]
            s[at.Y] = s[at.X] / p[at.RATIO]
    else:
        s[at.OUTER] = (volts - known) * ki[0]
        s[at.PEND] = known + s[at.OUTER]
    return s


def _equilibrium(train: DriveTrain, p: Array, w: float, l: float) -> tuple[float, float]:
    """Current that keeps a speed, and the driven shaft's torque; none of either where friction holds."""
    T = float(train.load.along(np.sign(w))) + l
    if w:
        return float((train.at_motor(np.sign(w), l) + train.viscous * w) / train.torque_constant), T
    ends = (T, T) if p[at.TWO] else (p[at.T_F] + l, p[at.T_B] + l)
    if p[at.TWO] and p[at.T_B] <= -l <= p[at.T_F]:
        return 0.0, 0.0
    if holding_torque(p, ends[1], -1) <= 0.0 <= holding_torque(p, ends[0], 1):
        return 0.0, T
    return T / (train.ratio * train.torque_constant), T


@dataclass(slots=True)
class Run:
    """One drive during its simulation."""

    p: Array  # parameters
    s: Array  # state
    g: Array  # tallies, set at the end
    M: Array  # matrices
    scratch: tuple[Array, Array, Array, Array]  # matrices in use, their temperatures, a step, what is steady
    pieces: Array
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
    runs: dict[int, Run] = {}
    known: dict[tuple[float, ...], Array] = {}
    for warm in (False, True):
        here = [n for n, p in enumerate(P) if (p[at.HEAT] != 0.0) == warm]
        if not here:
            continue
        resistance = P[here, at.R25][:, None]  # at each node of temperature
        if warm:
            nodes = P[here, at.NODE_0][:, None] + _NODE * np.arange(_NODES)
            resistance = P[here, at.R_A][:, None] + P[here, at.ALPHA][:, None] * nodes
        with np.errstate(all="ignore"):
            M = discretised(columns([drives[n].train for n in here]), resistance, P[here, at.H])
        if not np.isfinite(M).all():
            raise InputError("the machine's figures leave the range of numbers that can be computed with")
        for m, n in enumerate(here):
            same = tuple(P[n, [at.H, at.RATIO, at.N_V, at.N_P]].tolist())
            if same not in known:
                known[same] = pieces_of(task, P[n])
            runs[n] = _begun(P[n], M[m], drives[n], known[same])
    return [runs[n] for n in range(len(drives))]


def _begun(p: Array, M: Array, drive: Drive, pieces: Array) -> Run:
    """One drive at its start."""
    c = drive.controller
    ki = (c.velocity_ki != 0.0, c.current_ki != 0.0) if isinstance(c, Cascade) else (c.ki != 0.0, False)
    if not len(pieces):
        raise InputError("task: it lies between two samples of the controller")
    scratch = M[0].copy() if p[at.HEAT] else M[0], np.full(M.shape[1:3], math.nan), np.zeros(16), np.zeros(at.STEADY)
    before = p[at.H] * p[at.N_V] * np.arange(-int(p[at.WINDOW]), 0)  # counts of the periods before the start
    ring = np.floor(float(pieces[0, 3]) * before * p[at.EDGES] / (2.0 * math.pi))
    return Run(p, _start(p, pieces, drive, ki), tally(), M, scratch, pieces, np.asarray(ring))


def tally() -> Array:
    """Tallies at the start."""
    g = np.zeros(len(TALLY))
    g[[at.G_WINDING, at.G_HOUSING]] = -math.inf
    g[at.G_V_LOW] = math.inf
    return g
