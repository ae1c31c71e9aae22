"""Steppers, which run open-loop: pulses along a profile, the rotor behind them, lost steps, and the record of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from typing import NamedTuple

import numpy as np

from drivesizer.control.drive_train import Mechanics, mechanics, require, within_reach
from drivesizer.control.engine import Task, line
from drivesizer.control.engine.layout import PARAMETERS
from drivesizer.control.engine.start import mechanical
from drivesizer.control.open_loop import kernel as at
from drivesizer.control.open_loop.kernel import Array
from drivesizer.control.validation import Stepping, Validation
from drivesizer.errors import InputError, NoLoopError
from drivesizer.files.machine_code import machine_code
from drivesizer.files.text import sentences
from drivesizer.load_cases.platform import remaining_torque
from drivesizer.loads.course import Profile
from drivesizer.physics.figures import Range
from drivesizer.physics.stepper import natural_frequency
from drivesizer.results.check import Check, figure, units_of, verdict
from drivesizer.results.check_columns import CheckColumn, at_most, fits
from drivesizer.results.drive_set import DriveParts, DriveSet
from drivesizer.results.ratings import unless_printed
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

# -- Open-loop simulation of a stepper along a task, and the share of its pull-out torque that it needs.


# low: a single step of hybrid steppers is damped by 0.3 to 0.4 of the critical damping, of variable reluctance ones by
# 0.1 (A. Hughes, Electric Motors and Drives, chapter on stepping motors: step response)
DAMPING_RATIO = 0.1
_PER_SWING = 64  # steps of the integration in a period of the natural frequency
_PER_TURN = 16  # the same in an electrical turn at the highest speed
_RAMP = 256.0  # pulses in such a period, from which on they are a ramp
_FINE = math.pi / 32.0 + 1e-9  # of a microstep that may be a ramp, electrical [rad]
_MOST = 20_000_000  # steps of a simulation: some 5 s
_ROWS = 20_000
_WHOLE = 2.0 * math.pi
_DOWN, _LEAST = 0.85, 0.01  # shares of the torque that are tried: each of the last, and the smallest
_HALVINGS = 4  # between the last two: to 1 % of it


@dataclass(frozen=True, slots=True, kw_only=True)
class Stepper(Mechanics):
    """One stepper on its driver, its gears and its share of the load, SI."""

    teeth: float
    torque: Array  # N*m, pull-out torque at even steps of the speed from 0
    top_speed: float  # rad/s at the motor, that of the last of them
    microsteps: float  # to a full step, of which a rotor has four to a tooth
    damping_ratio: float
    idle: float = 1.0  # share of the current at rest

    @property
    def microstep(self) -> float:
        """A microstep at the motor [rad]."""
        return _WHOLE / (4.0 * self.teeth * self.microsteps)

    @property
    def inertia(self) -> float:
        """Inertia at the motor's shaft [kg*m^2]."""
        return self.motor_inertia + self.load_inertia / self.ratio**2

    @property
    def natural_frequency(self) -> float:
        """Frequency of small swings about a held position, by the pull-out torque at rest [Hz]."""
        return float(natural_frequency(self.teeth, self.torque[0], self.inertia))


@dataclass(frozen=True, slots=True, kw_only=True)
class Turned:
    """A simulated stepper."""

    figures: dict[str, float]  # by the names of ``kernel.TALLY``
    series: dict[str, Array]  # by the names of ``kernel.ROW``

    @property
    def lost(self) -> int:
        """Full steps that the rotor was behind or ahead of its pulses, at the most."""
        return 4 * math.floor(self.figures["lag"] / _WHOLE + 0.5)

    @property
    def lost_at_end(self) -> int:
        """Full steps lost at the end, negative ones too many."""
        return 4 * math.floor(self.figures["end_lag"] / _WHOLE + 0.5)


def simulate(
    stepper: Stepper, task: Task, *, share: float = 1.0, ends: float = math.inf, at_rest: bool = False
) -> Turned:
    """Simulate a stepper along a task, from the balance with its load, up to a lag at which it ends."""
    pulses = stepper.natural_frequency
    fine = stepper.teeth * stepper.microstep <= _FINE
    turn = _WHOLE / (stepper.teeth * stepper.top_speed * _PER_TURN) if stepper.top_speed else math.inf
    rubs = stepper.friction or stepper.efficiency != 1.0 or stepper.forward_torque != stepper.backward_torque
    pieces, step = _pieces(task, stepper.ratio), min(1.0 / (_PER_SWING * pulses), turn)
    machine = mechanical(stepper) | {"K_T": 1.0}  # its torque in the place of a current
    figures = {
        "TEETH": stepper.teeth, "DAMP": 2.0 * stepper.damping_ratio * math.sqrt(stepper.teeth * stepper.inertia),
        "FADES": 2.0 / math.sqrt(stepper.teeth * stepper.inertia), "MICRO": stepper.microstep,
        "RAMP": _RAMP * pulses * stepper.microstep if fine else math.inf, "H": step,
        "V_STEP": (stepper.top_speed or 1.0) / (len(stepper.torque) - 1), "SHARE": share, "IDLE": stepper.idle,
        "RUBS": float(bool(rubs)), "ENDS": ends, "T_ROW": max(pieces[:, 0].sum() / (_ROWS - 2), 0.25 * step),
    }  # fmt: skip
    p = np.array([machine.get(name, 0.0) for name in PARAMETERS])
    q = np.array([figures.get(name, 0.0) for name in at.FIGURES])
    rows, g = np.zeros((_ROWS if math.isinf(ends) else 0, len(at.ROW))), np.zeros(len(at.TALLY))
    g[at.G_SLIPPED] = -1.0
    w, x = 0.0 if at_rest else pieces[0, 1], -_balance(stepper, pieces[0], share)
    if machine_code(at.KERNEL)(p, q, np.ascontiguousarray(stepper.torque), pieces, g, rows, x, w, float(_MOST)):
        raise InputError(
            f"the motion of {pieces[:, 0].sum():.4g} s takes more than {_MOST} steps of a stepper's simulation; "
            "expected a shorter one by --profile"
        )
    series = {name: rows[: int(g[at.G_ROWS]), n].copy() for n, name in enumerate(at.ROW)}
    series["time"] += task.time[0]
    return Turned(figures=dict(zip(at.TALLY, g.tolist(), strict=True)), series=series)


def least_share(stepper: Stepper, task: Task, *, at_rest: bool = False) -> float:
    """Smallest share of the pull-out torque down to which no step is lost.

    Less torque swings more slowly, and a ramp as long as a swing shakes less than a shorter one: so shares are tried
    from 1 down one after another until one loses steps, and then halved between the last two.
    """

    def keeps(share: float) -> bool:
        return not simulate(stepper, task, share=share, ends=math.pi, at_rest=at_rest).lost

    high = 1.0
    while not keeps(high):
        high /= _DOWN
        if high > 8.0:
            return math.inf
    low = _DOWN * high
    while low > _LEAST and keeps(low):
        low, high = _DOWN * low, low
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if keeps(middle) else (middle, high)
    return high


def _balance(stepper: Stepper, first: Array, share: float) -> float:
    """Angle of the rotor behind the field at the start [rad], where load and motor balance; most where they do not."""
    speed, turns = first[1], np.sign(first[1])
    needed = float(stepper.at_motor(turns, first[3]))
    grid = np.linspace(0.0, stepper.top_speed or 1.0, len(stepper.torque))
    if not speed and not first[2]:
        share *= stepper.idle
    torque = share * float(np.interp(abs(speed), grid, stepper.torque))
    return math.asin(min(max(needed / torque, -1.0), 1.0)) / stepper.teeth if torque > 0.0 else 0.0


def _pieces(task: Task, ratio: float) -> Array:
    """Pieces over which speed and load torque are straight lines, as the kernel has them."""
    time, speed = np.asarray(task.time, float), np.asarray(task.speed, float)
    when, torque = np.asarray(task.load_time, float), np.asarray(task.load_torque, float)
    if not len(when):
        when, torque = time[:1], np.zeros(1)
    edges = np.unique(np.concatenate([time, when[(when > time[0]) & (when < time[-1])]]))
    (v, dv), (l, dl) = line(edges[:-1], time, speed), line(edges[:-1], when, torque)
    return np.ascontiguousarray(np.column_stack([np.diff(edges), ratio * v, ratio * dv, l, dl]))


# -- A stepper of a drive prepared and simulated along a profile, with what it needs of its pull-out torque.


PullOut = Callable[[Array], Array]  # torque at speeds of the motor

_POINTS = 513  # of the pull-out torque over the speed
_STARTS = 40.0  # periods of the natural frequency that a start without a ramp is watched
_SETTLES = 10.0  # the same, at rest after the motion
_NEEDED = {"motor": ("rotor_inertia", "pole_pairs", "holding_torque"), "gearhead": ("ratio", "efficiency")}


class OpenLoop(NamedTuple):
    """A stepper that was simulated, with its inputs."""

    spec: RobotSpec
    drive_set: DriveParts
    profile: Profile
    stepper: Stepper
    out: Turned
    share: float  # of the pull-out torque that keeps step along the motion
    start: float  # the same of a start without a ramp, to needs.start_speed; NaN where there is none
    assumptions: tuple[str, ...]


def run(spec: RobotSpec, drive_set: DriveParts, profile: Profile, pull_out: PullOut) -> OpenLoop:
    """Simulate a stepper along a profile, at rest for a while after one that ends at rest."""
    stepper, assumptions = prepared(spec, drive_set, profile, pull_out)
    left = remaining_torque(spec, profile, stepper.load)
    time, speed = list(profile.time), [v / stepper.radius for v in profile.speed]
    when, torque = left[:, 0].tolist(), left[:, 1].tolist()
    if speed[-1] == 0.0:
        end = time[-1] + _SETTLES / stepper.natural_frequency
        time, speed = [*time, end], [*speed, 0.0]
        when, torque = ([*when, end], [*torque, torque[-1]]) if when else (when, torque)
    task, start = Task(time=time, speed=speed, load_time=when, load_torque=torque), math.nan
    if spec.needs.start_speed is not None:  # in the heavier direction at its largest load
        undamped = replace(stepper, damping_ratio=0.0)  # the safe side: damping helps a start
        lasts = (0.0, _STARTS / stepper.natural_frequency)
        high, low = max(torque, default=0.0), min(torque, default=0.0)
        forward = stepper.forward_torque + high >= -stepper.backward_torque - low
        at_once = (spec.needs.start_speed if forward else -spec.needs.start_speed) / stepper.ratio
        loads = (high if forward else low,) * 2
        begun = Task(time=lasts, speed=(at_once, at_once), load_time=lasts, load_torque=loads)
        start = least_share(undamped, begun, at_rest=True)
    share, out = least_share(stepper, task), simulate(stepper, task)
    return OpenLoop(spec, drive_set, profile, stepper, out, share, start, tuple(assumptions))


def prepared(spec: RobotSpec, drive_set: DriveParts, profile: Profile, pull_out: PullOut) -> tuple[Stepper, list[str]]:
    """A stepper as its simulation takes it, and the assumptions made.

    Microsteps are as the spec has them, else the driver's finest, else full steps; the pull-out torque is taken at even
    steps of the speed.
    """
    require(drive_set, _NEEDED, "not simulated without")
    motor, control, (gears, unknown) = drive_set.motor, spec.control, mechanics(spec, drive_set)
    within_reach(gears, profile)
    top = max(profile.top_speed * gears.motor_per_speed, spec.needs.start_speed or 0.0)
    assumptions = []
    finest = drive_set.controller.microsteps if drive_set.controller else math.nan
    microsteps = 1.0 if control.microsteps is None else float(control.microsteps)
    if microsteps > finest:
        name = drive_set.controller.part if drive_set.controller else ""
        raise InputError(f"control.microsteps: {microsteps:g} is more than {finest:g}, the most of controller {name}")
    if control.microsteps is None and finest >= 1.0:
        microsteps = finest
        assumptions.append(
            f"the driver runs its finest microsteps, {finest:g} to a full step; control.microsteps sets others"
        )
    elif control.microsteps is None:
        assumptions.append("the driver's microsteps are unknown: full steps, which shake the rotor most; see "
                    "control.microsteps")  # fmt: skip
    speed = np.linspace(0.0, top or 1.0, _POINTS)
    torque = pull_out(speed)
    lacks = np.flatnonzero(np.isnan(torque))
    if len(lacks):
        known = show(float(speed[lacks[0] - 1]), "rpm", "rotary_speed", 3)
        above = f" above {known}" if lacks[0] else ": no curve, and a figure of its model is unknown"
        raise NoLoopError(f"motor {motor.part}: its pull-out torque is unknown{above}; not simulated without")
    if not torque[0] > 0.0:
        raise NoLoopError(f"motor {motor.part}: it has no pull-out torque at rest")
    stepper = Stepper(
        **{f.name: getattr(gears, f.name) for f in fields(gears)},
        teeth=motor.pole_pairs,
        torque=torque,
        top_speed=top,
        microsteps=microsteps,
        damping_ratio=DAMPING_RATIO if control.damping_ratio is None else control.damping_ratio,
        idle=1.0 if control.idle_current is None else control.idle_current,
    )
    return stepper, [*assumptions, *unknown]


# -- The record of a stepper's simulation: checks, figures and time series, seen from the load.


METHOD = "open loop"
_RULE = "pulses along the profile, open-loop"
_SOURCE = "P. Acarnley, Stepping Motors: a guide to theory and practice, 4th ed., IET, 2002, chapters 3 and 4"
_SLIP, _CREST = math.pi, math.pi / 2.0  # electrical: half a tooth pitch, and where the torque is largest
_CRESTS = "electrical: 90° is a full step, where the torque is largest; beyond 180° steps are lost: informational"
_OWN = {"microsteps", "phase_current", "idle_current", "damping_ratio"}  # fields of ``control`` that a stepper has


def record(case: OpenLoop, drive_set: DriveSet, name: str) -> Validation:
    """The simulation of a stepper as a record."""
    checks = tuple(check for check in _checks(case, drive_set) if check.limit != math.inf)
    stepper, seen, rows = case.stepper, case.out.figures, case.out.series
    per = 1.0 / stepper.motor_per_speed  # m/rad, or 1: travel of the load per angle of the motor
    figures: dict[str, tuple[float, float | None]] = {
        "lost_steps": (float(case.out.lost), None),
        "lost_at_end": (float(case.out.lost_at_end), None),
        "load_angle_to_slip": (max(_SLIP - seen["lag"], 0.0), None),
        "position_error_peak": (seen["error"] * per, seen["error_time"]),
        "distance_error": (seen["end_error"] * per, None),
        "microstep": (stepper.microstep * per, None),
        "natural_frequency": (stepper.natural_frequency, None),
        "motor_torque_peak": (float(np.abs(rows["motor_torque"]).max()), None),
    }
    rotary = case.spec.load.shaft_axis == "rotary"
    reference, speed = rows["reference"] * per, rows["motor_speed"] * per
    series = {
        "time": rows["time"],
        "speed_reference": reference,
        "speed": speed,
        "error": reference - speed,
        "position_error": rows["position_error"] * per,
        "load_angle": rows["load_angle"],
        "motor_speed": rows["motor_speed"],
        "motor_torque": rows["motor_torque"],
        "gearhead_torque": rows["gear_torque"] / (drive_set.belt_ratio * drive_set.belt_efficiency),
    }
    rate = float(np.abs(rows["reference"]).max()) / stepper.microstep
    return Validation(
        spec=case.spec,
        drive_set=drive_set,
        case=name,
        profile=case.profile.name,
        status=verdict(checks),
        checks=checks,
        figures=tuple(figure(name, *value, rotary=rotary) for name, value in figures.items()),
        gains=Stepping(
            microsteps=stepper.microsteps,
            pulse_rate=rate,
            damping_ratio=stepper.damping_ratio,
            rule=_RULE,
            source=_SOURCE,
        ),
        series=series,
        series_units=units_of("series", series, rotary=rotary),
        assumptions=(
            *case.assumptions,
            *sentences("drivesizer.control", "stepper", control=case.spec.control, damping=stepper.damping_ratio),
        ),
        warnings=tuple(_warnings(case, checks)),
    )


def _checks(case: OpenLoop, drive_set: DriveSet) -> Iterator[Check]:
    """Steps, share of the pull-out torque, load angle, gearhead; an estimated torque at both ends of its band."""

    def check(column: CheckColumn, at_time: float | None = None, note: str = "") -> Check:
        return column.at((), METHOD, at_time=at_time, note=note)

    out, seen, gearhead = case.out, case.out.figures, case.drive_set.gearhead
    when = seen["slipped"] if seen["slipped"] >= 0.0 else None
    words = f"{out.lost} lost, {out.lost_at_end} at the end" if out.lost else "none is lost"
    yield check(fits("lost_steps", not out.lost, True), when, words)
    low, high, guessed = 1.0, 1.0, ""
    for estimate in drive_set.estimated:
        if (estimate.part, estimate.figure) == ("motor", "pull_out_share"):
            low, high = estimate.low / estimate.value, estimate.high / estimate.value
            guessed = f"; the torque is estimated, {low:.0%} to {high:.0%} of the simulated one"
    for name, share in (("pull_out_share", case.share), ("start_share", case.start)):
        if name == "start_share" and math.isnan(share):
            continue
        column = at_most(name, share, Range(low, high))
        below = f"steps are lost below it, found by halving{guessed}"
        yield check(column, note=below if math.isfinite(share) else "lost at any torque")
    yield check(at_most("load_angle", seen["lag"], _CREST, advice=True), seen["lag_time"], _CRESTS)
    if not out.lost:
        torque = seen["gear"] / (case.drive_set.belt_ratio * case.drive_set.belt_efficiency)
        column = at_most("gearhead_intermittent_torque", torque, gearhead.intermittent_torque)
        column = unless_printed(column, "peak_torque", drive_set)
        yield check(column, seen["gear_time"], "with the swings of the rotor")
    column = at_most("gearhead_intermittent_speed", seen["speed"], gearhead.intermittent_input_speed)
    yield check(column, seen["speed_time"])


def _warnings(case: OpenLoop, checks: tuple[Check, ...]) -> Iterator[str]:
    seen, swings = case.out.figures, case.stepper.natural_frequency
    if case.out.lost:
        cure = "finer microsteps, less acceleration, speed or inertia, a higher supply voltage, or a larger motor"
        yield f"steps are lost from {seen['slipped']:.4g} s on: {cure}"
    ignored = sorted(case.spec.control.model_fields_set - _OWN)
    if ignored:
        yield f"control.{ignored[0]}: a stepper runs open-loop; of control only {', '.join(sorted(_OWN))} are used"
    if case.spec.plant.model != "rigid":
        yield "plant.model two_mass: a stepper is simulated with a rigid shaft"
    speed = np.abs(np.array(case.profile.speed)) * case.stepper.motor_per_speed
    steady = np.unique(speed[1:][(speed[1:] == speed[:-1]) & (speed[1:] > 0.0)]) / case.stepper.microstep  # Hz
    rates = abs(np.log(steady / swings))
    if len(rates) and rates.min() < math.log(2.0) / 2.0:
        near = show(swings, "Hz", "frequency", 3)
        yield f"pulses at a steady speed come close to the natural frequency of {near}: other microsteps, or speed"
    unknown = [check.title for check in checks if check.status == "unknown" and not check.advice]
    if unknown:
        yield f"unknown: {', '.join(unknown)}"
