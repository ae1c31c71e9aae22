"""Motor sets in closed loop along a reference: one with its course over time, or many at once.

Data in, data out: a ``Drive`` is a machine, a controller and what holds it back; a ``Task`` is what it is asked for. A
set starts in equilibrium at the first speed. Between samples the machine is exact (see ``linear_modes``); temperatures
move with the loss of each period, and the winding's resistance follows to 0.01 K.
Assumed: a reference or a load that has a corner between two samples takes it at the next one. A cycle that repeats is
marched until it ends as it began, to 1e-7 of full scale (1e-3 while the winding's resistance moves); the cycles after
that are added; a heated set's last is marched again at its temperatures, sums between to 5e-3. Where
the power turns round twice within one sample, that is not seen; the bus sags by the current at the sample.
Symbols: I current [A], U voltage [V], w motor speed [rad/s], T temperature [K].
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer import kernel as at
from drivesizer.cascade import Cascade
from drivesizer.errors import InputError
from drivesizer.kernel import PARAMETERS, ROW, STATE, TALLY, compiled
from drivesizer.linear_modes import Machine, columns, discretised
from drivesizer.results import Gains
from drivesizer.thermal import COPPER, DATA_TEMPERATURE, TwoBodies

__all__ = ["FIGURES", "CurrentLimit", "Drive", "Encoder", "Heat", "Marched", "Supply", "Task", "march", "march_many"]

Array = NDArray[np.float64]

_MOST_STEPS = 50_000_000  # of one set: some ten seconds of computing
_MOST_ROWS = 20_000
_STEADY, _STEADY_WARM = 1e-12, 1e-9  # change over a sample, of full scale, that is none; while the resistance moves
_PERIODIC, _PERIODIC_WARM = 1e-7, 1e-3  # difference of a cycle's end from its start, of full scale, that is none
_WHOLE = 1e-9  # a corner this near to a sample, in periods, is on it
_NODES, _NODE = 24, 20.0  # nodes of temperature, and K between them: the modes are met to 4e-6 of themselves
_BLOCK = 256  # sets whose matrices are held at a time
_PROBLEMS = ("", "the state leaves the range of numbers: the loop is unstable", "more steps than are permitted")


@dataclass(frozen=True, slots=True, kw_only=True)
class Supply:
    """The bus that feeds some motor sets alike, and what a controller passes on."""

    voltage: float  # V, without load
    resistance: float = 0.0  # ohm, of the source and its cables
    sets: int = 1
    max_duty: float = 1.0
    voltage_drop: float = 0.0  # V
    raises: bool = False  # whether energy that comes back raises the bus; else a brake chopper or a battery takes it


@dataclass(frozen=True, slots=True, kw_only=True)
class CurrentLimit:
    """Peak current for its time, then the continuous one (integral of I^2 - I_cont^2); infinite: none, or not known."""

    peak: float = math.inf  # A
    continuous: float = math.inf  # A
    peak_time: float = math.inf  # s, at the peak from rest


@dataclass(frozen=True, slots=True, kw_only=True)
class Encoder:
    """Counts of the motor's angle; 0 edges: speed and angle are measured exactly."""

    edges: int = 0  # per turn of the motor
    periods: int = 1  # of the velocity loop, over which counts are taken for a speed


@dataclass(frozen=True, slots=True, kw_only=True)
class Heat:
    """Winding and housing, and where they start."""

    bodies: TwoBodies
    ambient: float  # K
    winding: float = math.nan  # K at the start; NaN: ambient
    housing: float = math.nan  # K at the start; NaN: ambient
    loss: float = 0.0  # W at the housing, always
    loss_torque: float = 0.0  # N*m at the housing: times the speed


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """One motor set with its controller."""

    machine: Machine
    controller: Gains | Cascade
    supply: Supply
    current: CurrentLimit = CurrentLimit()
    encoder: Encoder = Encoder()
    heat: Heat | None = None  # None: the winding stays at 25 degC
    delay: bool = True  # cascade: the voltage answers the current sample before


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """What is asked of the driven shaft; straight lines between the corners."""

    time: tuple[float, ...]  # s, strictly rising
    speed: tuple[float, ...]  # rad/s of the driven shaft
    load_time: tuple[float, ...] = ()  # s, strictly rising
    load_torque: tuple[float, ...] = ()  # N*m, added to the machine's own; before and after the corners as at the ends
    cycles: int = 1  # how often it is done; its length is then rounded up to whole samples of the slowest loop


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Marched:
    """What came out: a column over sets per figure of ``FIGURES``; the course of a single set."""

    figures: dict[str, Array]
    problems: tuple[str, ...]  # of each set, empty where it ran to the end; else the figures are those until then
    series: dict[str, Array] | None = None  # by the names of ``kernel.ROW``; of the first cycle


FIGURES = {
    "current": "I", "voltage_asked": "U_ASKED", "voltage": "U", "speed": "W", "speed_error": "E_W",
    "angle_error": "E_X", "gear_torque": "G", "current_asked": "I_AHEAD", "power": "POWER", "bus_current": "BUS",
    "time_at_voltage_limit": "SATURATED", "time_at_current_limit": "LIMITED", "energy_in": "IN", "energy_back": "BACK",
    "speed_error_square": "E2_W", "angle_error_square": "E2_X", "i2t_highest": "I2T", "winding_highest": "WINDING",
    "housing_highest": "HOUSING", "bus_lowest": "V_LOW", "bus_highest": "V_HIGH",
}  # fmt: skip
_PEAKS = [n for n, name in enumerate(TALLY) if f"T_{name}" in TALLY]
_SUMS = slice(TALLY.index("SQUARE"), TALLY.index("I2T"))
_COMPARED = [STATE.index(n) for n in ("I", "W", "F", "V", "PEND", "OUTER", "INNER", "I_ASK")]


def march(drive: Drive, task: Task, *, rows: int = _MOST_ROWS, most_steps: int = _MOST_STEPS) -> Marched:
    """One set along a task, with its course over time.

    Parameters
    ----------
    drive, task
        The set, and what it is asked for.
    rows
        Most rows of the series: all after corners, evenly thinned elsewhere; 0 for none.
    most_steps
        At which the march is given up.

    Raises
    ------
    InputError
        When a figure cannot be computed with.
    """
    return _march([drive], task, rows, most_steps, 1)


def march_many(drives: Sequence[Drive], task: Task, *, threads: int = 2, most_steps: int = _MOST_STEPS) -> Marched:
    """Many sets along one task; the figures do not depend on the number of threads.

    Parameters
    ----------
    drives, task
        The sets, all rigid or all flexible, and what each is asked for.
    threads
        That march beside each other.
    most_steps
        At which a set's march is given up.

    Raises
    ------
    InputError
        When a figure cannot be computed with.
    """
    return _march(drives, task, 0, most_steps, threads)


def _march(drives: Sequence[Drive], task: Task, rows: int, most: int, threads: int) -> Marched:
    _checked(drives, task)
    loop = compiled()
    blocks = [drives[n : n + _BLOCK] for n in range(0, len(drives), _BLOCK)]
    book = np.zeros((rows + 2 if rows else 0, len(ROW))), np.zeros(rows + 2, np.int8), np.array([0, 1, rows // 2])
    found: list[_Run] = []
    with ThreadPoolExecutor(threads) as pool:
        for block in blocks:  # made ready by one thread: two would wait for each other's interpreter
            ready = _ready(block, task, most)
            list(pool.map(lambda part: [_all_cycles(loop, run, task.cycles, book) for run in part],
                          [ready[n::threads] for n in range(threads)]))  # fmt: skip
            found += ready
    return Marched(
        figures=_figures(found),
        problems=tuple(_PROBLEMS[run.status] for run in found),
        series=_series(book, task.time[0]) if rows else None,
    )


# --- what comes in


def _checked(drives: Sequence[Drive], task: Task) -> None:
    """Refuse what cannot be computed with."""
    for name, times, values in (("time", task.time, task.speed), ("load_time", task.load_time, task.load_torque)):
        rising = all(a < b for a, b in pairwise(times))
        if len(times) != len(values) or not rising or not all(map(math.isfinite, (*times, *values))):
            raise InputError(f"task: {name} and its values are to be finite, as many, and the times rising")
    if len(task.time) < 2 or task.cycles < 1:
        raise InputError("task: expected at least two corners, and at least one cycle")
    if len({drive.machine.flexible for drive in drives}) != 1:
        raise InputError("expected at least one set, and all of them rigid or all flexible")
    for drive in drives:
        _checked_drive(drive)


def _checked_drive(drive: Drive) -> None:
    m = drive.machine
    above = ("resistance", "inductance", "torque_constant", "motor_inertia", "ratio", "efficiency", "belt_ratio")
    above += ("belt_efficiency", *(("stiffness", "load_inertia") if m.flexible else ()))
    for f in fields(Machine):
        value = getattr(m, f.name)
        signed = f.name in ("forward_torque", "backward_torque", "rest_torque")
        if not (value > 0.0 if f.name in above else value >= 0.0 or signed):
            raise InputError(f"machine: {f.name.replace('_', ' ')} {value:g} is no figure of a machine")
        if not math.isfinite(value) and f.name != "stiffness":
            raise InputError(f"machine: {f.name.replace('_', ' ')} is not finite")
    c, supply = drive.controller, drive.supply
    if isinstance(c, Cascade):
        _multiples(c)
    elif not c.period > 0.0:
        raise InputError(f"controller: period {c.period:g} s: expected a time above 0")
    if not supply.voltage > supply.voltage_drop >= 0.0 or not supply.resistance >= 0.0 or not 0 < supply.max_duty <= 1:
        raise InputError("supply: expected a voltage above the drop, a resistance of 0 or more, a duty up to 1")
    if drive.heat is not None and not drive.heat.bodies.known:
        raise InputError("heat: a thermal figure is unknown; expected all of them, or no heat")


def _multiples(c: Cascade) -> tuple[int, int]:
    """Current periods per velocity period, and velocity periods per position period."""
    found = []
    for name, slow, fast in (("velocity", c.velocity_period, c.current_period),
                             ("position", c.position_period, c.velocity_period)):  # fmt: skip
        n = round(slow / fast) if fast > 0.0 and math.isfinite(slow / fast) else -1
        if n < (name == "velocity") or abs(slow / fast - n) > 1e-6 * max(n, 1):
            raise InputError(f"controller: {name} period {slow:g} s: expected a whole multiple of {fast:g} s")
        found.append(n)
    return found[0], found[1]


def _parameters(drive: Drive, top: float, most: int, sense: bool) -> dict[str, float]:
    """A set in the kernel's names, its thermal figures and controller apart."""
    m, supply, limit = drive.machine, drive.supply, drive.current
    volts = supply.voltage if supply.voltage < math.inf else 2.0 * m.torque_constant * m.ratio * max(top, 1.0)
    full_i, full_w = volts / m.resistance, volts / m.torque_constant
    tight = _STEADY if drive.heat is None else _STEADY_WARM
    square = limit.continuous**2
    budget = (limit.peak**2 - square) * limit.peak_time if math.isfinite(square) else math.inf
    return {
        "R25": m.resistance, "K_T": m.torque_constant, "J_M": m.motor_inertia, "F_M": m.friction,
        "F_S": max(m.friction, m.stiction), "B_M": m.viscous, "RATIO": m.ratio,
        "DRIVE": 1.0 / (m.ratio * m.efficiency), "BRAKE": m.efficiency / m.ratio, "J_L": m.load_inertia,
        "B_L": m.load_viscous, "T_F": m.forward_torque, "T_B": m.backward_torque, "T_0": m.rest_torque,
        "C": m.stiffness if m.flexible else 0.0, "DAMP": m.damping, "GAP": m.gap, "G_0": 1.0 / m.belt_ratio,
        "G_D": 1.0 / (m.belt_ratio * m.belt_efficiency), "G_B": m.belt_efficiency / m.belt_ratio,
        "TWO": float(m.flexible), "EDGES": drive.encoder.edges, "WINDOW": max(drive.encoder.periods, 1),
        "V_0": supply.voltage, "R_S": supply.resistance, "SETS": supply.sets, "DUTY": supply.max_duty,
        "DROP": supply.voltage_drop, "RAISES": float(supply.raises), "PEAK": limit.peak, "CONT2": square,
        "BUDGET": max(budget, 0.0) if not math.isnan(budget) else math.inf, "MOST": most, "SENSE": float(sense),
        "TOL_I": tight * full_i, "TOL_W": tight * full_w, "TOL_U": tight * volts,
        "TOL_F": tight * m.ratio * m.torque_constant * full_i / m.stiffness if m.flexible else math.inf,
    }  # fmt: skip


def _controller(drive: Drive) -> dict[str, float]:
    """A controller in the kernel's names: gains per sample."""
    c = drive.controller
    if isinstance(c, Gains):
        filtered = c.filter_time + c.period
        return {"H": c.period, "N_V": 1.0, "KP": c.kp, "KI": c.ki * c.period, "KD": c.kd / filtered,
                "KEEP": c.filter_time / filtered}  # fmt: skip
    n_v, n_p = _multiples(c)
    filtered = c.filter_time + c.velocity_period
    return {
        "CASCADE": 1.0, "H": c.current_period, "N_V": n_v, "N_P": n_p, "KP": c.velocity_kp,
        "KI": c.velocity_ki * c.velocity_period, "KD": c.velocity_kd / filtered, "KEEP": c.filter_time / filtered,
        "CKP": c.current_kp, "CKI": c.current_ki * c.current_period, "PKP": c.position_kp if n_p else 0.0,
        "FFV": c.feedforward_velocity, "FFF": c.feedforward_friction, "FFA": c.feedforward_acceleration,
        "DELAY": float(drive.delay),
    }  # fmt: skip


def _thermal(heat: Heat | None) -> dict[str, float]:
    """Winding and housing in the kernel's names."""
    if heat is None:
        return {"AMBIENT": DATA_TEMPERATURE}
    b: Any = heat.bodies
    low = min(heat.ambient, *(x for x in (heat.winding, heat.housing) if not math.isnan(x)), heat.ambient)
    return {
        "HEAT": 1.0, "R_1": b.R_th1, "R_2": b.R_th2, "C_W": b.capacity_w, "C_H": b.capacity_h,
        "R_A": b.R_25 * (1.0 + COPPER * (heat.ambient - DATA_TEMPERATURE)), "ALPHA": COPPER * b.R_25,
        "AMBIENT": heat.ambient, "P_0": heat.loss, "P_1": heat.loss_torque,
        "NODE_0": low - heat.ambient - _NODE, "NODE_D": _NODE, "NODES": _NODES,
    }  # fmt: skip


def _resistances(p: Array) -> Array:
    """The winding at the nodes of temperature [ohm]; a single one where it does not warm."""
    if not p[at.HEAT]:
        return np.array([p[at.R25]])
    return np.asarray(p[at.R_A] + p[at.ALPHA] * (p[at.NODE_0] + p[at.NODE_D] * np.arange(_NODES)))


def _pieces(task: Task, p: Array) -> Array:
    """The task as the kernel's pieces, at the motor shaft; corners between two samples leave none."""
    h, K = p[at.H], p[at.RATIO]
    time, speed = np.array(task.time) - task.time[0], np.array(task.speed) * K
    if not time[-1] / h < 2.0**53:
        raise InputError(f"task: {time[-1]:g} s is too long to be sampled every {h:g} s")
    load_time, load = np.array(task.load_time or (0.0,)) - task.time[0], np.array(task.load_torque or (0.0,))
    starts = np.unique(np.concatenate((time, load_time[(load_time > 0.0) & (load_time < time[-1])])))
    n = np.searchsorted(time, starts[:-1], "right") - 1
    slope = (np.diff(speed) / np.diff(time))[n]
    angle = np.concatenate(([0.0], np.cumsum(np.diff(time) * (speed[1:] + speed[:-1]) / 2.0)))[n]
    since = starts[:-1] - time[n]
    forces = np.interp(starts, load_time, load)
    tick = np.ceil(starts / h - _WHOLE)
    if task.cycles > 1:
        whole = p[at.N_V] * max(p[at.N_P], 1.0)
        tick[-1] = np.ceil(tick[-1] / whole - _WHOLE) * whole
    found = np.column_stack((
        tick[:-1], tick[1:], starts[:-1], speed[n] + slope * since, slope,
        angle + (speed[n] + 0.5 * slope * since) * since, forces[:-1], np.diff(forces) / np.diff(starts), since == 0.0,
    ))  # fmt: skip
    return np.ascontiguousarray(found[found[:, 1] > found[:, 0]])


# --- the start


def _start(p: Array, pieces: Array, heat: Heat | None, ki: tuple[bool, bool]) -> Array:
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
    s[at.CODE] = at.mode_of(p, i, w, s[at.F], s[at.V], l)
    volts = s[at.RES] * i + p[at.K_T] * w  # what the integral holds is what was asked for last
    if p[at.CASCADE]:
        ahead = p[at.FFV] * w + p[at.FFF] * np.sign(w)
        s[at.OUTER], s[at.I_ASK], s[at.INNER] = (i - ahead) * ki[0], i * ki[0], volts * ki[1]
        s[at.PEND] = s[at.INNER]
    else:
        s[at.PEND] = s[at.OUTER] = volts * ki[0]
    return s


def _equilibrium(p: Array, w: float, l: float) -> tuple[float, float]:
    """Current that keeps a speed, and the driven shaft's torque; none of either where friction holds."""
    k = p[at.K_T]
    if w:
        side = 1 if w > 0.0 else -1
        T = at.resisting(p, side) + l + p[at.B_L] * w / p[at.RATIO]
        share = p[at.DRIVE] if T * side > 0.0 else p[at.BRAKE]
        return float((side * p[at.F_M] + p[at.B_M] * w + T * share) / k), float(T)
    T = p[at.T_0] + l
    ends = (T, T) if p[at.TWO] else (p[at.T_F] + l, p[at.T_B] + l)
    if p[at.TWO] and p[at.T_B] <= -l <= p[at.T_F]:
        return 0.0, 0.0
    if at.held(p, ends[1], -1) <= 0.0 <= at.held(p, ends[0], 1):
        return 0.0, float(T)
    return float(T / (p[at.RATIO] * k)), float(T)


def _ring(p: Array, w: float) -> Array:
    """Counts of the periods before the start."""
    window = int(p[at.WINDOW])
    back = p[at.H] * p[at.N_V] * np.arange(-window, 0)
    return np.asarray(np.floor(w * back * p[at.EDGES] / (2.0 * math.pi)))


# --- the march, cycle by cycle


@dataclass(slots=True)
class _Run:
    """One set on its way."""

    p: Array
    s: Array
    g: Array
    M: Array
    pieces: Array
    ring: Array
    status: int = 0
    cycles: int = 0
    time: float = 0.0  # s
    owed: tuple[int, Array, float, float] | None = None  # cycles not yet added, sums and heat of the one before, heat


def _ready(drives: Sequence[Drive], task: Task, most: int) -> list[_Run]:
    """Some sets at their start; their matrices are made together."""
    top = max(map(abs, task.speed))
    tables = []
    for d in drives:
        named = _parameters(d, top, most, task.cycles > 1) | _controller(d) | _thermal(d.heat)
        scale = named.get("PKP", 0.0)
        named["TOL_X"] = named["TOL_W"] / scale if scale else math.inf
        tables.append([named.get(name, 0.0) for name in PARAMETERS])
    P = np.array(tables, float)
    found: dict[int, _Run] = {}
    known: dict[tuple[float, ...], Array] = {}
    for warm in (False, True):
        here = [n for n, p in enumerate(P) if (p[at.HEAT] != 0.0) == warm]
        if not here:
            continue
        resistance = np.array([_resistances(P[n]) for n in here])
        with np.errstate(all="ignore"):
            M = discretised(columns([drives[n].machine for n in here]), resistance, P[here, at.H])
        if not np.isfinite(M).all():
            raise InputError("the machine's figures leave the range of numbers that can be computed with")
        for m, n in enumerate(here):
            same = tuple(P[n, [at.H, at.RATIO, at.N_V, at.N_P]].tolist())
            if same not in known:
                known[same] = _pieces(task, P[n])
            found[n] = _begun(P[n], M[m], drives[n], known[same].copy())
    return [found[n] for n in range(len(drives))]


def _begun(p: Array, M: Array, drive: Drive, pieces: Array) -> _Run:
    c = drive.controller
    ki = (c.velocity_ki != 0.0, c.current_ki != 0.0) if isinstance(c, Cascade) else (c.ki != 0.0, False)
    if not len(pieces):
        raise InputError("task: it lies between two samples of the controller")
    return _Run(p, _start(p, pieces, drive.heat, ki), _tally(p), M, pieces, _ring(p, float(pieces[0, 3])))


def _tally(p: Array) -> Array:
    g = np.zeros(len(TALLY))
    g[[at.G_WINDING, at.G_HOUSING]] = -math.inf
    g[at.G_V_LOW], g[at.G_V_HIGH] = math.inf, -math.inf
    return g


def _all_cycles(loop: Any, run: _Run, cycles: int, book: tuple[Any, ...]) -> _Run:
    """March a cycle until it repeats, then add the rest; heated, the last one is marched again."""
    none = np.zeros((0, len(ROW)))
    while run.cycles < cycles and not run.status:
        before, g = run.s.copy(), _tally(run.p)
        run.s[at.WW : at.HQ + 1] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)
        rows = book[0] if not run.cycles else none
        run.status = int(loop(run.p, run.s, g, run.M, *_scratch(run), run.pieces, run.ring, rows, *book[1:]))
        _merge(run, g)
        _settle(run, before, g)
        left = cycles - run.cycles
        if left > 0 and not run.status:
            run.pieces[:, 5] += _turned(run)
            again = _repeats(run, before, g, left - int(run.p[at.HEAT] != 0.0))
            if again > 0:
                _add(run, before, g, again)
    return run


def _scratch(run: _Run) -> tuple[Array, Array, Array, Array]:
    """Where the kernel works: matrices in use, the temperatures that they are for, a step, what is steady."""
    work = run.M[0].copy() if run.p[at.HEAT] else run.M[0]
    return work, np.full(run.M.shape[1:3], math.nan), np.zeros(16), np.zeros(at.STEADY)


def _turned(run: _Run) -> float:
    """Angle of the reference over a cycle [rad]."""
    last = run.pieces[-1]
    since = last[1] * run.p[at.H] - last[2]
    return float(last[5] + (last[3] + 0.5 * last[4] * since) * since - run.pieces[0, 5])


def _merge(run: _Run, g: Array) -> None:
    """Add a cycle to what was watched."""
    for n in _PEAKS:
        if g[n] > run.g[n]:
            run.g[n], run.g[n + 1] = g[n], g[n + 1] + run.time
    run.g[_SUMS] += g[_SUMS]
    for n in (at.G_I2T, at.G_WINDING, at.G_HOUSING, at.G_V_HIGH):
        run.g[n] = max(run.g[n], g[n])
    run.g[at.G_V_LOW] = min(run.g[at.G_V_LOW], g[at.G_V_LOW])
    run.cycles += 1
    run.time += run.pieces[-1, 1] * run.p[at.H]


def _compared(p: Array, s: Array) -> Array:
    """What has to repeat; voltages without the copper's drop, which goes with the temperature."""
    free = s.copy()
    free[_volts(p)] -= s[at.RES] * s[at.I]
    return free[_COMPARED]


def _volts(p: Array) -> list[int]:
    """Places of the controller's voltages."""
    return [int(at.PEND), int(at.INNER if p[at.CASCADE] else at.OUTER)]


def _repeats(run: _Run, before: Array, g: Array, left: int) -> int:
    """How many more cycles are like the one before: it ended as it began, and no limit will come in between."""
    p, s = run.p, run.s
    share = _PERIODIC_WARM / _STEADY_WARM if p[at.HEAT] else _PERIODIC / _STEADY
    asked = p[at.TOL_I] if p[at.CASCADE] else p[at.TOL_U]
    limits = np.array([p[at.TOL_I], p[at.TOL_W], p[at.TOL_F], p[at.TOL_W] / p[at.RATIO], p[at.TOL_U], asked,
                       p[at.TOL_U], p[at.TOL_I]])  # fmt: skip
    if np.any(np.abs(_compared(p, s) - _compared(p, before)) > share * limits):
        return 0
    if p[at.PKP] and abs(s[at.X] - before[at.X] - _turned(run)) > share * p[at.TOL_X]:
        return 0
    grows, budget = s[at.I2T] - before[at.I2T], p[at.BUDGET]
    if budget == math.inf or abs(grows) <= _PERIODIC * budget:
        return left
    if g[at.G_LIMITED] > 0.0:
        return 0
    return left if grows < 0.0 else min(left, max(0, int((budget - g[at.G_I2T]) / grows) - 1))


def _add(run: _Run, before: Array, g: Array, n: int) -> None:
    """Add cycles like the one before; of a heated set the temperatures go by the affine map of one."""
    s = run.s
    heat = s[at.Q] - before[at.Q]
    if run.p[at.HEAT]:
        many = np.linalg.matrix_power(_affine(s, before), n) @ np.array([s[at.T_W], s[at.T_H], 0.0, 1.0])
        s[at.T_W], s[at.T_H], whole = many[:3]
        s[_volts(run.p)] -= s[at.RES] * s[at.I]
        s[at.RES] = run.p[at.R_A] + run.p[at.ALPHA] * s[at.T_W]
        s[_volts(run.p)] += s[at.RES] * s[at.I]
        run.owed = n, g[_SUMS].copy(), heat, whole
    else:
        whole = n * heat
        run.g[_SUMS] += n * g[_SUMS]
    s[at.Q] += whole
    s[at.I2T] = max(0.0, s[at.I2T] + n * (s[at.I2T] - before[at.I2T]))
    moved = s[at.X] - before[at.X], s[at.Y] - before[at.Y]
    s[at.X], s[at.Y] = s[at.X] + n * moved[0], s[at.Y] + n * moved[1]
    run.pieces[:, 5] += n * _turned(run)
    run.cycles += n
    run.time += n * run.pieces[-1, 1] * run.p[at.H]


def _settle(run: _Run, before: Array, g: Array) -> None:
    """Add the cycles of a heated set between the ones marched: between those by the copper's heat, which is known."""
    if run.owed is None:
        return
    n, sums, heat, whole = run.owed
    more = float(run.s[at.Q] - before[at.Q]) - heat
    share = min(max((whole / n - heat) / more, 0.0), 1.0) if more else 0.0
    run.g[_SUMS] += n * (sums + share * (g[_SUMS] - sums))
    run.owed = None


def _affine(s: Array, before: Array) -> Array:
    """What a cycle makes of winding, housing and copper heat: with its current it is affine in the temperatures."""
    found = np.eye(4)
    found[:3, 0] = s[at.WW], s[at.WH], s[at.WQ]
    found[:3, 1] = s[at.HW], s[at.HH], s[at.HQ]
    start, end = before[[at.T_W, at.T_H]], np.array([s[at.T_W], s[at.T_H], s[at.Q] - before[at.Q]])
    found[:3, 3] = end - found[:3, :2] @ start
    return found


# --- what comes out


def _figures(runs: Sequence[_Run]) -> dict[str, Array]:
    """Columns over sets."""
    g, s, p = (np.array([getattr(run, name) for run in runs]) for name in "gsp")
    found: dict[str, Array] = {}
    for name, place in FIGURES.items():
        n = TALLY.index(place)
        found[name] = g[:, n].copy()
        if n in _PEAKS:
            found[f"{name}_time"] = g[:, n + 1].copy()
    warm = np.where(p[:, at.HEAT] != 0.0, p[:, at.AMBIENT], np.nan)
    found |= {"winding": s[:, at.T_W] + warm, "housing": s[:, at.T_H] + warm}
    found["winding_highest"] += warm
    found["housing_highest"] += warm
    time = np.array([run.time for run in runs])
    with np.errstate(all="ignore"):
        found |= {
            "rms_current": np.sqrt(g[:, at.G_SQUARE] / time),
            "rms_gear_torque_running": np.sqrt(g[:, at.G_G_SQUARE] / g[:, at.G_RUNNING]),
            "i2t_share": g[:, at.G_I2T] / p[:, at.BUDGET],
        }
    return found | {"copper_heat": s[:, at.Q].copy(), "angle": s[:, at.X].copy(), "load_angle": s[:, at.Y].copy(),
                    "time": time, "steps": s[:, at.STEPS].copy()}  # fmt: skip


def _series(book: tuple[Any, ...], origin: float) -> dict[str, Array]:
    rows = book[0][: book[2][0]]
    found = {name: rows[:, n].copy() for n, name in enumerate(ROW)}
    found["time"] += origin
    return found
