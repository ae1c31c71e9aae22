"""A stepper of a drive simulated along a profile: what it needs of its pull-out torque, and its record."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.drive_train import require
from drivesizer.control.open_loop import layout as at
from drivesizer.control.open_loop.kernel import compiled
from drivesizer.control.validation import Stepping, Validation
from drivesizer.errors import InputError, NoLoopError
from drivesizer.load_cases.platform import AtShaft, at_shaft, remaining_torque
from drivesizer.load_cases.profile import SPEED
from drivesizer.loads.course import Profile
from drivesizer.physics.stepper import natural_frequency
from drivesizer.results.check import Check, Figure, verdict
from drivesizer.results.check_columns import CheckColumn, at_most, between, fits
from drivesizer.results.drive_set import DriveParts, DriveSet
from drivesizer.results.ratings import unless_printed
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

__all__ = ["Motion", "Stepper", "least_share", "prepared", "record", "run", "simulate"]


# -- Open-loop simulation of a stepper along a motion, and the share of its pull-out torque that it needs.


Array = NDArray[np.float64]

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
class Stepper:
    """One stepper on its driver, its gears and its share of the load, SI."""

    teeth: float
    torque: Array  # N*m, pull-out torque at even steps of the speed from 0
    top_speed: float  # rad/s at the motor, that of the last of them
    microstep: float  # rad at the motor
    damping_ratio: float
    motor_inertia: float  # kg*m^2 at the motor's shaft
    load_inertia: float = 0.0  # kg*m^2 at the driven shaft
    ratio: float = 1.0
    efficiency: float = 1.0
    friction: float = 0.0  # N*m at the motor, of idle gears
    forward_torque: float = 0.0  # N*m at the driven shaft, resistance when the load moves forward
    backward_torque: float = 0.0
    rest_torque: float = 0.0  # N*m at the driven shaft, weight alone

    @property
    def inertia(self) -> float:
        """Inertia at the motor's shaft [kg*m^2]."""
        return self.motor_inertia + self.load_inertia / self.ratio**2

    @property
    def natural_frequency(self) -> float:
        """Frequency of small swings about a held position, by the pull-out torque at rest [Hz]."""
        return float(natural_frequency(self.teeth, self.torque[0], self.inertia))


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """Speed of the driven shaft over time, and its torque beyond inertia and direction: straight lines between."""

    time: Sequence[float]
    speed: Sequence[float]  # rad/s
    load_time: Sequence[float] = ()
    load_torque: Sequence[float] = ()  # N*m


@dataclass(frozen=True, slots=True, kw_only=True)
class Turned:
    """A simulated stepper."""

    figures: dict[str, float]  # by the names of ``layout.TALLY``
    series: dict[str, Array]  # by the names of ``layout.ROW``

    @property
    def lost(self) -> int:
        """Full steps that the rotor was behind or ahead of its pulses, at the most."""
        return 4 * math.floor(self.figures["lag"] / _WHOLE + 0.5)

    @property
    def lost_at_end(self) -> int:
        """Full steps lost at the end, negative ones too many."""
        return 4 * math.floor(self.figures["end_lag"] / _WHOLE + 0.5)


def simulate(
    stepper: Stepper,
    motion: Motion,
    *,
    share: float = 1.0,
    ends: float = math.inf,
    at_rest: bool = False,
    per_swing: int = _PER_SWING,
) -> Turned:
    """Simulate a stepper along a motion, from the balance with its load."""
    p = _parameters(stepper, share, ends, per_swing)
    pieces = _pieces(motion, stepper.ratio)
    p[at.EVERY] = max(pieces[:, 0].sum() / (_ROWS - 2), 0.25 * p[at.H])
    rows = np.zeros((_ROWS, len(at.ROW))) if math.isinf(ends) else np.zeros((0, len(at.ROW)))
    g = np.zeros(len(at.TALLY))
    g[at.G_SLIPPED] = -1.0
    w = 0.0 if at_rest else pieces[0, 1]
    x = -_balance(stepper, pieces[0], share)
    if compiled()(p, np.ascontiguousarray(stepper.torque), pieces, g, rows, x, w, float(_MOST)):
        raise InputError(
            f"the motion of {pieces[:, 0].sum():.4g} s takes more than {_MOST} steps of a stepper's simulation; "
            "expected a shorter one by --profile"
        )
    figures = dict(zip(at.TALLY, g.tolist(), strict=True))
    kept = rows[: int(g[at.G_ROWS])]
    series = {name: kept[:, n].copy() for n, name in enumerate(at.ROW)}
    series["time"] += motion.time[0]
    return Turned(figures=figures, series=series)


def least_share(stepper: Stepper, motion: Motion, *, at_rest: bool = False) -> float:
    """Smallest share of the pull-out torque down to which no step is lost.

    Less torque swings more slowly, and a ramp as long as a swing shakes less than a shorter one: so shares are tried
    from 1 down one after another until one loses steps, and then halved between the last two.
    """

    def keeps(share: float) -> bool:
        return not simulate(stepper, motion, share=share, ends=math.pi, at_rest=at_rest).lost

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


def _parameters(stepper: Stepper, share: float, ends: float, per_swing: int) -> Array:
    p, pulses = np.zeros(len(at.PARAMETERS)), stepper.natural_frequency
    fine = stepper.teeth * stepper.microstep <= _FINE
    turn = _WHOLE / (stepper.teeth * stepper.top_speed * _PER_TURN) if stepper.top_speed else math.inf
    rubs = stepper.friction or stepper.efficiency != 1.0 or stepper.forward_torque != stepper.backward_torque
    figures = {
        at.J_M: stepper.motor_inertia, at.J_L: stepper.load_inertia, at.RATIO: stepper.ratio,
        at.EFF: stepper.efficiency, at.FRICTION: stepper.friction, at.T_F: stepper.forward_torque,
        at.T_B: stepper.backward_torque, at.T_0: stepper.rest_torque, at.TEETH: stepper.teeth,
        at.DAMP: 2.0 * stepper.damping_ratio * math.sqrt(stepper.teeth * stepper.inertia),
        at.FADES: 2.0 / math.sqrt(stepper.teeth * stepper.inertia),
        at.MICRO: stepper.microstep, at.RAMP: _RAMP * pulses * stepper.microstep if fine else math.inf,
        at.H: min(1.0 / (per_swing * pulses), turn * _PER_SWING / per_swing),
        at.V_STEP: (stepper.top_speed or 1.0) / (len(stepper.torque) - 1), at.SHARE: share, at.RUBS: float(bool(rubs)),
        at.ENDS: ends,
    }  # fmt: skip
    for place, value in figures.items():
        p[place] = value
    return p


def _balance(stepper: Stepper, first: Array, share: float) -> float:
    """Angle of the rotor behind the field at the start [rad], where load and motor balance; most where they do not."""
    speed, load = first[1], first[3]
    rests = {1.0: stepper.forward_torque, -1.0: stepper.backward_torque, 0.0: stepper.rest_torque}
    drag = rests[float(np.sign(speed))] + load
    power = float(np.sign(drag * speed))
    needed = drag / stepper.ratio * stepper.efficiency**-power + np.sign(speed) * stepper.friction
    grid = np.linspace(0.0, stepper.top_speed or 1.0, len(stepper.torque))
    held = share * float(np.interp(abs(speed), grid, stepper.torque))
    return math.asin(min(max(needed / held, -1.0), 1.0)) / stepper.teeth if held > 0.0 else 0.0


def _pieces(motion: Motion, ratio: float) -> Array:
    """Pieces over which speed and load torque are straight lines, as ``layout`` has them."""
    time, speed = (np.asarray(x, float) for x in (motion.time, motion.speed))
    torque = np.array(motion.load_torque or (0.0, 0.0), float)
    when = np.array(motion.load_time, float) if len(motion.load_time) else time[[0, -1]]
    edges = np.unique(np.concatenate([time, when[(when > time[0]) & (when < time[-1])]]))
    lasts, middle = np.diff(edges), 0.5 * (edges[1:] + edges[:-1])
    columns = [lasts]
    for t, y, factor in ((time, speed, ratio), (when, torque, 1.0)):
        k = np.clip(np.searchsorted(t, middle) - 1, 0, len(t) - 2)
        gaps = np.where(t[k + 1] > t[k], t[k + 1] - t[k], 1.0)
        slope = np.where(t[k + 1] > t[k], (y[k + 1] - y[k]) / gaps, 0.0)
        columns += [factor * (y[k] + slope * (edges[:-1] - t[k])), factor * slope]
    return np.ascontiguousarray(np.column_stack(columns))


# -- A stepper of a drive prepared and simulated along a profile, with what it needs of its pull-out torque.


PullOut = Callable[[Array], Array]  # torque at speeds of the motor

_POINTS = 513  # of the pull-out torque over the speed
_FASTEST = 1e9  # rad/s at the motor
_STARTS = 40.0  # periods of the natural frequency that a start without a ramp is watched
_CALM = 16  # microsteps with which swings are small
_SETTLES = 10.0  # the same, at rest after the motion
_NEEDED = {"motor": ("rotor_inertia", "pole_pairs", "holding_torque"), "gearhead": ("ratio", "efficiency")}


class OpenLoop(NamedTuple):
    """A stepper that was simulated, with its inputs."""

    spec: RobotSpec
    drive_set: DriveParts
    profile: Profile
    stepper: Stepper
    radius: float  # m, travel of the load per angle of the driven shaft; 1 where it turns with it
    microsteps: float  # per full step
    out: Turned
    share: float  # of the pull-out torque that keeps step along the motion
    start: float  # the same of a start without a ramp, to needs.start_speed; NaN where there is none
    finer: int  # microsteps with which no step is lost, where some are; 0 where these do not help
    assumptions: tuple[str, ...]

    @property
    def per_travel(self) -> float:
        """Travel of the load per angle of the motor [m/rad, or 1]."""
        return self.radius / self.stepper.ratio


class Prepared(NamedTuple):
    """Input of a simulation."""

    stepper: Stepper
    microsteps: float  # per full step
    assumptions: tuple[str, ...]


def run(spec: RobotSpec, drive_set: DriveParts, profile: Profile, pull_out: PullOut) -> OpenLoop:
    """Simulate a stepper along a profile, at rest for a while after one that ends at rest."""
    ready = prepared(spec, drive_set, profile, pull_out)
    stepper, shaft = ready.stepper, at_shaft(spec)
    motion = _motion(spec, profile, shaft, _SETTLES / stepper.natural_frequency)
    out = simulate(stepper, motion)
    finer = 0
    driver = math.nan if drive_set.controller is None else drive_set.controller.microsteps
    if out.lost and ready.microsteps < _CALM and not driver < _CALM:
        calm = replace(stepper, microstep=stepper.microstep * ready.microsteps / _CALM)
        finer = 0 if simulate(calm, motion).lost else _CALM
    return OpenLoop(spec, drive_set, profile, stepper, shaft.radius, ready.microsteps, out,
                    least_share(stepper, motion), _start(spec, stepper, motion), finer, ready.assumptions)  # fmt: skip


def prepared(spec: RobotSpec, drive_set: DriveParts, profile: Profile, pull_out: PullOut) -> Prepared:
    """A stepper as its simulation takes it."""
    said: list[str] = []
    shaft = at_shaft(spec)
    top = max(profile.top_speed / shaft.radius * drive_set.total_ratio, spec.needs.start_speed or 0.0)
    if not top <= _FASTEST:
        raise InputError(f"profile {profile.name}: {top:.3g} rad/s is no speed that a motor can be turned to")
    microsteps = _microsteps(spec, drive_set, said)
    stepper = _stepper(spec, drive_set, shaft, microsteps, said)
    stepper = replace(stepper, torque=_torques(drive_set, pull_out, top), top_speed=top)
    return Prepared(stepper, microsteps, tuple(said))


def _microsteps(spec: RobotSpec, drive_set: DriveParts, said: list[str]) -> float:
    """Microsteps of a full step: as the spec has them, else the driver's finest, else full steps."""
    driver, given = drive_set.controller, spec.control.microsteps
    finest = driver.microsteps if driver else math.nan
    if given is not None and given > finest:
        name = driver.part if driver else ""
        raise InputError(f"control.microsteps: {given} is more than {finest:g}, the most of controller {name}")
    if given is not None:
        return float(given)
    if finest >= 1.0:
        said.append(f"the driver runs its finest microsteps, {finest:g} to a full step; control.microsteps sets others")
        return finest
    said.append("the driver's microsteps are unknown: full steps, which shake the rotor most; see control.microsteps")
    return 1.0


def _stepper(
    spec: RobotSpec, drive_set: DriveParts, shaft: AtShaft, microsteps: float, said: list[str]
) -> Stepper:  # fmt: skip
    """The drive as its simulation takes it, still without its torque."""
    require(drive_set, _NEEDED, "not simulated without")
    motor, own, damping = drive_set.motor, drive_set.at_motor, spec.control.damping_ratio
    unknown = drive_set.unknown_inertias + ["load"] * math.isnan(shaft.inertia)
    said += [f"the inertia of the {name} is unknown and taken as 0" for name in unknown]
    return Stepper(
        teeth=motor.pole_pairs,
        torque=np.ones(2),
        top_speed=0.0,
        microstep=2.0 * math.pi / (4.0 * motor.pole_pairs * microsteps),
        damping_ratio=DAMPING_RATIO if damping is None else damping,
        motor_inertia=drive_set.inertia(unknown=0.0),
        load_inertia=0.0 if math.isnan(shaft.inertia) else shaft.inertia,
        ratio=drive_set.total_ratio,
        efficiency=own.efficiency * drive_set.belt_efficiency,
        friction=own.idle,
        forward_torque=shaft.forward_torque,
        backward_torque=shaft.backward_torque,
        rest_torque=shaft.rest_torque,
    )


def _torques(drive_set: DriveParts, pull_out: PullOut, top: float) -> Array:
    """Pull-out torque at even steps of the speed."""
    speed = np.linspace(0.0, top or 1.0, _POINTS)
    found = pull_out(speed)
    lacks = np.flatnonzero(np.isnan(found))
    if len(lacks):
        known = show(float(speed[lacks[0] - 1]), "rpm", "rotary_speed", 3)
        above = f" above {known}" if lacks[0] else ": no curve, and a figure of its model is unknown"
        raise NoLoopError(f"motor {drive_set.motor.part}: its pull-out torque is unknown{above}; not simulated without")
    if not found[0] > 0.0:
        raise NoLoopError(f"motor {drive_set.motor.part}: it has no pull-out torque at rest")
    return found


def _motion(spec: RobotSpec, profile: Profile, shaft: AtShaft, settles: float) -> Motion:
    """Motion and load of the driven shaft, and the rest after it."""
    left = remaining_torque(spec, profile, shaft)
    time, speed = list(profile.time), [v / shaft.radius for v in profile.speed]
    when, torque = left[:, 0].tolist(), left[:, 1].tolist()
    if speed[-1] == 0.0:
        end = time[-1] + settles
        time, speed = [*time, end], [*speed, 0.0]
        when, torque = ([*when, end], [*torque, torque[-1]]) if when else (when, torque)
    return Motion(time=time, speed=speed, load_time=when, load_torque=torque)


def _start(spec: RobotSpec, stepper: Stepper, motion: Motion) -> float:
    """Share of the pull-out torque of a start without a ramp, in the heavier direction at its largest load."""
    speed = spec.needs.start_speed
    if speed is None:
        return math.nan
    undamped = replace(stepper, damping_ratio=0.0)  # the safe side: damping helps a start
    lasts = _STARTS / stepper.natural_frequency
    high, low = max(motion.load_torque, default=0.0), min(motion.load_torque, default=0.0)
    forward = stepper.forward_torque + high >= -stepper.backward_torque - low
    speeds = ((speed if forward else -speed) / stepper.ratio,) * 2
    loads = (high if forward else low,) * 2
    start = Motion(time=(0.0, lasts), speed=speeds, load_time=(0.0, lasts), load_torque=loads)
    return least_share(undamped, start, at_rest=True)


# -- The record of a stepper's simulation: checks, figures and time series, seen from the load.


METHOD = "open loop"
_RULE = "pulses along the profile, open-loop"
_SOURCE = "P. Acarnley, Stepping Motors: a guide to theory and practice, 4th ed., IET, 2002, chapters 3 and 4"
_SLIP, _CREST = math.pi, math.pi / 2.0  # electrical: half a tooth pitch, and where the torque is largest
_TRAVEL = {"linear": ("length", "mm"), "rotary": ("angle", "deg")}
_CRESTS = "electrical: 90° is a full step, where the torque is largest; beyond 180° steps are lost: informational"
_OWN = {"microsteps", "damping_ratio"}  # fields of ``control`` that a stepper has


def record(case: OpenLoop, drive_set: DriveSet, name: str) -> Validation:
    """The simulation of a stepper as a record."""
    found = tuple(check for check in _checks(case, drive_set) if check.limit != math.inf)
    stepper = case.stepper
    rate = float(np.abs(case.out.series["reference"]).max()) / stepper.microstep
    return Validation(
        spec=case.spec,
        drive_set=drive_set,
        case=name,
        profile=case.profile.name,
        status=verdict(found),
        checks=found,
        figures=_figures(case),
        gains=Stepping(
            microsteps=case.microsteps, pulse_rate=rate, damping_ratio=stepper.damping_ratio, rule=_RULE, source=_SOURCE
        ),
        series=_series(case),
        series_units=_units(case),
        assumptions=(*case.assumptions, *_assumptions(case)),
        warnings=tuple(_warnings(case, found)),
    )


# --- checks


def _check(column: CheckColumn, at_time: float | None = None, note: str = "") -> Check:
    return column.at((), METHOD, at_time=at_time, note=note)


def _checks(case: OpenLoop, drive_set: DriveSet) -> Iterator[Check]:
    out, gearhead = case.out, case.drive_set.gearhead
    seen = out.figures
    when = seen["slipped"] if seen["slipped"] >= 0.0 else None
    kept = f"{out.lost} lost, {out.lost_at_end} at the end" if out.lost else "none is lost"
    yield _check(fits("lost_steps", not out.lost, True), when, kept)
    low, high, guessed = _band(drive_set)
    yield _check(_share("pull_out_share", case.share, low, high), note=_said(case.share, guessed))
    if not math.isnan(case.start):
        yield _check(_share("start_share", case.start, low, high), note=_said(case.start, guessed))
    yield _check(at_most("load_angle", seen["lag"], _CREST, advice=True), seen["lag_time"], _CRESTS)
    belt = case.drive_set.belt_ratio * case.drive_set.belt_efficiency
    if not out.lost:
        yield _check(
            unless_printed(
                at_most("gearhead_intermittent_torque", seen["gear"] / belt, gearhead.intermittent_torque),
                "peak_torque",
                drive_set,
            ),
            seen["gear_time"],
            "with the swings of the rotor",
        )
    yield _check(
        at_most("gearhead_intermittent_speed", seen["speed"], gearhead.intermittent_input_speed), seen["speed_time"]
    )


def _share(name: str, share: float, low: float, high: float) -> CheckColumn:
    """The share against all of the torque; of an estimated one against both ends of its band."""
    if low == high:
        return at_most(name, share, 1.0)
    return between(at_most(name, share, high), at_most(name, share, low))


def _said(share: float, guessed: str) -> str:
    return f"steps are lost below it, found by halving{guessed}" if math.isfinite(share) else "lost at any torque"


def _band(drive_set: DriveSet) -> tuple[float, float, str]:
    """Ends of the band of the pull-out torque over the simulated one, and words on it."""
    for one in drive_set.estimated:
        if (one.part, one.figure) == ("motor", "pull_out_share"):
            low, high = one.low / one.value, one.high / one.value
            return low, high, f"; the torque is estimated, {low:.0%} to {high:.0%} of the simulated one"
    return 1.0, 1.0, ""


# --- figures and series


def _figures(case: OpenLoop) -> tuple[Figure, ...]:
    seen, stepper = case.out.figures, case.stepper
    travel, per = _TRAVEL[case.spec.load.axis], case.per_travel
    peak = float(np.abs(case.out.series["motor_torque"]).max())
    rows: tuple[tuple[str, str, float, tuple[str, str], float | None], ...] = (
        ("lost_steps", "Full steps lost, largest", float(case.out.lost), ("dimensionless", "1"), None),
        ("lost_at_end", "Full steps lost at the end", float(case.out.lost_at_end), ("dimensionless", "1"), None),
        ("load_angle_to_slip", "Load angle left before a step is lost", max(_SLIP - seen["lag"], 0.0),
         ("angle", "deg"), None),
        ("position_error_peak", "Position error at the load, peak", seen["error"] * per, travel, seen["error_time"]),
        ("distance_error", "Final position error, load", seen["end_error"] * per, travel, None),
        ("microstep", "One microstep, at the load", stepper.microstep * per, travel, None),
        ("natural_frequency", "Natural frequency with the load, by the pull-out torque at rest",
         stepper.natural_frequency, ("frequency", "Hz"), None),
        ("motor_torque_peak", "Motor torque, peak", peak, ("torque", "N*m"), None),
    )  # fmt: skip
    return tuple(Figure(name=n, title=t, value=v, kind=k, unit=u, at_time=at) for n, t, v, (k, u), at in rows)


def _series(case: OpenLoop) -> dict[str, NDArray[np.float64]]:
    rows, per = case.out.series, case.per_travel
    belt = case.drive_set.belt_ratio * case.drive_set.belt_efficiency
    reference, speed = rows["reference"] * per, rows["motor_speed"] * per
    return {
        "time": rows["time"],
        "speed_reference": reference,
        "speed": speed,
        "error": reference - speed,
        "position_error": rows["position_error"] * per,
        "load_angle": rows["load_angle"],
        "motor_speed": rows["motor_speed"],
        "motor_torque": rows["motor_torque"],
        "gearhead_torque": rows["gear_torque"] / belt,
    }


def _units(case: OpenLoop) -> dict[str, tuple[str, str]]:
    speed, travel = SPEED[case.spec.load.axis], _TRAVEL[case.spec.load.axis]
    return {
        "time": ("time", "s"), "speed_reference": speed, "speed": speed, "error": speed, "position_error": travel,
        "load_angle": ("angle", "deg"), "motor_speed": ("rotary_speed", "rpm"), "motor_torque": ("torque", "mN*m"),
        "gearhead_torque": ("torque", "N*m"),
    }  # fmt: skip


# --- words


def _assumptions(case: OpenLoop) -> list[str]:
    ratio, given = case.stepper.damping_ratio, case.spec.control.damping_ratio is not None
    damped = "as given" if given else "low, for hybrid steppers are damped by 0.3 to 0.4; control.damping_ratio sets it"
    return [
        "all drives share the load equally; one is simulated",
        "the motor's torque is its pull-out torque at the speed of the pulses times the sine of the load angle; its "
        "own friction is in it, detent torque and electrical transients are not: no instability at mid speed",
        f"swings are damped by {ratio:.3g} of the critical damping, {damped}",
        "rotor and load turn as one body, and the driver gives its rated current at rest too",
        "a gear's efficiency is the catalogue's maximum, at any torque and in either direction of power",
        "pulses follow the profile to the nearest microstep, and start in equilibrium; one cycle is simulated, held "
        "for some swings after its end where that is at rest",
    ]


def _warnings(case: OpenLoop, found: tuple[Check, ...]) -> Iterator[str]:
    seen, swings = case.out.figures, case.stepper.natural_frequency
    if case.out.lost:
        cure = (
            f"with control: {{microsteps: {case.finer}}} none is, in a driver that has them"
            if case.finer
            else "less acceleration, speed or inertia, a higher supply voltage, or a larger motor"
        )
        yield f"steps are lost from {seen['slipped']:.4g} s on: {cure}"
    ignored = sorted(case.spec.control.model_fields_set - _OWN)
    if ignored:
        yield f"control.{ignored[0]}: a stepper runs open-loop; of control only microsteps and damping_ratio are used"
    if case.spec.plant.model != "rigid":
        yield "plant.model two_mass: a stepper is simulated with a rigid shaft"
    rates = abs(np.log(_steady_rates(case) / swings))
    if len(rates) and rates.min() < math.log(2.0) / 2.0:
        near = show(swings, "Hz", "frequency", 3)
        yield f"pulses at a steady speed come close to the natural frequency of {near}: other microsteps, or speed"
    unknown = [check.title for check in found if check.status == "unknown" and not check.advice]
    if unknown:
        yield f"unknown: {', '.join(unknown)}"


def _steady_rates(case: OpenLoop) -> NDArray[np.float64]:
    """Rates of pulses [Hz] where the speed is constant and not 0."""
    speed = np.abs(np.array(case.profile.speed)) / case.per_travel
    steady = speed[1:][(speed[1:] == speed[:-1]) & (speed[1:] > 0.0)]
    found: NDArray[np.float64] = np.unique(steady) / case.stepper.microstep
    return found
