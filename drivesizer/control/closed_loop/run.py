"""One drive in closed loop: its set-up, the simulation along a profile, and motions of hours."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import Controller, one_row
from drivesizer.control.drive_train import DriveTrain, within_reach
from drivesizer.control.engine import CurrentLimit, Drive, MotorHeat, Resolution, Simulation, Supply, Task, simulate
from drivesizer.control.loop_design import analyse, designed, edges_of, train_behind
from drivesizer.control.validation import Cascade, Gains, Loops
from drivesizer.errors import InputError
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.platform import remaining_torque
from drivesizer.loads.course import Profile
from drivesizer.physics.cycle_at_gearhead import at_gearhead
from drivesizer.physics.power_stage import Feed
from drivesizer.physics.thermal import TwoBodies, two_bodies
from drivesizer.physics.winding import housing_loss
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.ratings import controller_current
from drivesizer.spec.mounting import loss_at_flange
from drivesizer.spec.robot import RobotSpec

__all__ = [
    "FOLLOWS", "LONGEST", "ClosedLoop", "Prepared", "as_warm", "limited", "motor_heat", "prepared", "run",
    "simulate_long", "unlimited", "without_limits",
]  # fmt: skip


# -- A cascade whose current loop runs at the velocity loop's rate, for the simulation of long motions.
#
# A current loop runs ten times as often as the loop around it, and a simulation costs by its periods. The winding
# under the gains of the magnitude optimum is a lag :math:`T = L / k_p`; what that is after a velocity period
# :math:`h`, :math:`1 - b` with :math:`b = 1 - e^{-h/T}`, follows from the winding held over such a period, :math:`i'
# = a i + (1 - a) u / R` with :math:`a = e^{-hR/L}`, by the PI that cancels its pole:
#
# .. math:: k_p = \frac{a\,b\,R}{1 - a}, \quad k_i h = b R
#
# It answers at once, as the lag includes the delay. All else is unchanged: the outer loops with their delays,
# counts, friction, backlash, limits, heat. The current between two samples of the velocity loop is left out.


def slower(drive: Drive) -> Drive | None:
    """A drive with its current loop at the velocity loop's rate."""
    c, m = drive.controller, drive.train
    if not isinstance(c, Cascade) or c.current_steps == 1 or not c.current_kp > 0.0:
        return None
    h, R = c.velocity_period, m.resistance
    decay = math.exp(-h * R / m.inductance)
    share = -math.expm1(-h * c.current_kp / m.inductance)
    gains = replace(
        c, current_kp=decay * share * R / (1.0 - decay), current_ki=share * R / h, current_period=h
    )  # fmt: skip
    return replace(drive, controller=gains, prompt=True)


# -- Input of a simulation: drive train, designed controller, limits, heat and task of a drive.
#
# Gains are those of ``loop_design``. Assumptions are kept with the result.


FOLLOWS = 0.1  # of the top speed: a drive whose error exceeds it does not follow (our convention)
_DRAIN = 0.05  # s: slow for the current loop, short for a rest between two motions (our choice)
_WHOLE = 1e-9  # share of a cycle that is neglected


class Prepared(NamedTuple):
    """Input of a simulation, and the parts that it was made from."""

    train: DriveTrain
    controller: Gains | Cascade
    usable_voltage: float  # V, NaN unknown
    drive: Drive
    task: Task
    assumptions: tuple[str, ...]


def prepared(
    spec: RobotSpec, drive_set: DriveParts, profile: Profile, controller: Gains | Cascade | None = None
) -> Prepared:
    """A drive and its task as the engine takes them."""
    if controller is None:
        train, controller, said = designed(spec, drive_set)
    else:
        train, said = train_behind(spec, drive_set, controller)
    within_reach(train, profile)
    _sampled(controller, profile)
    feed = spec.feed_of(drive_set.controller, drive_set.brake)
    usable = float(feed.usable)
    heat, lacks = motor_heat(spec, drive_set)
    drive = _drive(spec, drive_set, train, controller, heat, feed)
    return Prepared(train, controller, usable, drive, _task(spec, profile, train), (*said, *lacks))


# --- the task


def _sampled(controller: Gains | Cascade, profile: Profile) -> None:
    """Refuse a profile whose top speed lies between samples of the velocity loop, or that is too long to be counted."""
    period = controller.period if isinstance(controller, Gains) else controller.velocity_period
    if not profile.duration / period < 2.0**53:
        raise InputError(f"profile {profile.name}: {profile.duration:g} s is too long to be sampled every {period:g} s")
    time, speed = np.array(profile.time) - profile.time[0], np.array(profile.speed)
    near = np.unique(np.concatenate([np.floor(time / period + k) for k in (-1.0, 0.0, 1.0)])) * period
    seen = np.abs(np.interp(near[(near >= 0.0) & (near <= time[-1])], time, speed)).max(initial=0.0)
    if not seen >= (1.0 - FOLLOWS) * profile.top_speed:
        raise InputError(
            f"profile {profile.name}: its top speed lies between two samples of the controller, {period:g} s apart; "
            "expected a slower change"
        )


def _task(spec: RobotSpec, profile: Profile, train: DriveTrain) -> Task:
    """Motion and load of the driven shaft, repeated for the mission's duration."""
    left = remaining_torque(spec, profile, train.load)
    lasts = spec.mission.duration / profile.duration if spec.mission else 1.0
    return Task(
        time=profile.time,
        speed=tuple((np.array(profile.speed) / train.radius).tolist()),
        load_time=tuple(left[:, 0].tolist()),
        load_torque=tuple(left[:, 1].tolist()),
        cycles=max(1, math.ceil(lasts - _WHOLE)),
    )


# --- the machine


def _drive(
    spec: RobotSpec,
    drive_set: DriveParts,
    train: DriveTrain,
    own: Gains | Cascade,
    heat: MotorHeat | None,
    feed: Feed,
) -> Drive:
    """The drive as the engine takes it; an unknown limit is none there, and unknown in its check."""
    controller, known, stage = drive_set.controller, not math.isnan(feed.usable), feed.stage

    def limit(value: float) -> float:
        return math.inf if math.isnan(value) else float(value)

    figures = controller or Controller()

    return Drive(
        train=train,
        controller=own,
        supply=Supply(
            voltage=spec.supply.lowest, resistance=spec.supply.resistance or 0.0, sets=spec.load.motors,
            max_duty=float(stage.max_duty) if known else 1.0, voltage_drop=float(stage.drop) if known else 0.0,
            loss=float(stage.loss), stage_resistance=float(stage.resistance), standby=float(stage.standby),
            leads=float(feed.leads),
        ),
        current=CurrentLimit(
            peak=limit(figures["peak_current"]),
            continuous=limit(controller_current(figures, spec.environment.ambient)),
            peak_time=limit(figures["peak_time"]),
        ),
        encoder=Resolution(edges=edges_of(spec, drive_set), periods=max(own.counted_over, 1)),
        heat=heat,
        drain_time=_DRAIN if spec.control.at_rest == "drain" else math.inf,
    )  # fmt: skip


def _from_gearhead(spec: RobotSpec, drive_set: DriveParts) -> float:
    """Loss of the gearhead that heats the housing, per speed of the motor, by the mean of the load cycle [W*s/rad]."""
    if not (spec.mounting and spec.mounting.gear_loss_share):
        return 0.0
    cycle = at_gearhead(load_cycle(spec), drive_set.belt_efficiency, math.inf).behind(drive_set.belt_ratio)
    return float(loss_at_flange(spec, cycle, one_row(drive_set.gearhead))[0]) / drive_set.gearhead.ratio


def motor_heat(spec: RobotSpec, drive_set: DriveParts) -> tuple[MotorHeat | None, list[str]]:
    """Winding and housing of a motor with their losses."""
    figures = drive_set.motor
    bodies: TwoBodies = two_bodies(figures)
    if not (bodies.known and spec.plant.warming):
        return None, []
    coulomb, viscous = (float(x[0]) for x in housing_loss(figures, np.ones(1)))
    coulomb += _from_gearhead(spec, drive_set)
    losses = {"loss_torque": coulomb, "loss_viscous": viscous}
    known = {name: loss for name, loss in losses.items() if not math.isnan(loss)}
    said = (
        ["the motor's losses other than copper loss are unknown and left out of its heating"] if known != losses else []
    )
    of_torque, of_speed = (known.get(name, 0.0) for name in losses)
    found = MotorHeat(bodies=bodies, ambient=spec.environment.ambient, loss_torque=of_torque, loss_viscous=of_speed)
    return found, said


# -- Motions of hours in closed loop: a simulation with a slower current loop, held against the whole drive in windows.
#
# A motion with more periods of the current loop than can be simulated is simulated with that loop at the velocity
# loop's rate (``slower_loop``). The full drive is simulated in windows: around the largest value of every figure,
# and at even distances. There both are compared: the largest factor by which the full drive exceeds the slower one
# is the allowance of a figure outside the windows. A check that passes without that allowance and fails with it is
# unknown.


LONGEST = 250_000_000  # steps of a simulation: some 40 s
_LEAD, _WATCHED = 1.0, 2.0  # s of a window before it is recorded, and recorded
_EVEN = 8  # windows at even distances
_NEAR = 0.5  # of a figure's largest value: windows that reach it are compared
_PEAKS = (
    "voltage_demand", "stage_voltage", "voltage", "current", "current_demand", "speed", "speed_error", "angle_error",
    "load_speed_error", "load_angle_error", "gear_torque", "power", "bus_current",
)  # fmt: skip
_MEANS = ("rms_current", "rms_gear_torque_running")
_EXCESS = 10.0  # error of the I2t integral, a difference of squares, over that of the current's square


class LongSimulation(NamedTuple):
    """Simulation of a long motion."""

    out: Simulation  # with the largest peaks of motion and windows
    drive: Drive  # simulated from end to end
    allowed: dict[str, float]  # factor of 1 and more by which a figure may exceed its reported value
    windows: tuple[tuple[float, float], ...]  # s, in which the full drive was simulated


def simulate_long(drive: Drive, task: Task, rows: int) -> LongSimulation:
    """Simulate a drive along a motion of hours."""
    slow = slower(drive) if isinstance(drive.controller, Cascade) else None
    out = simulate(slow or drive, task, rows=max(rows, 2), most_steps=LONGEST)
    if slow is None or out.problems[0]:
        return LongSimulation(out, slow or drive, {}, ())
    windows = _windows(task, out)  # of the first cycle
    pairs = [tuple(_seen(one, task, out, *window) for one in (drive, slow)) for window in windows]
    whole = [pair for pair in pairs if not pair[0].problems[0] and not pair[1].problems[0]]
    figures = dict(out.figures)
    for name in _PEAKS:
        for seen, _ in whole:
            if seen.figures[name][0] > figures[name][0]:
                figures[name], figures[f"{name}_time"] = seen.figures[name], seen.figures[f"{name}_time"]
    allowed = {name: _allowed(name, out, figures, whole) for name in (*_PEAKS, *_MEANS)}
    allowed["i2t_share"] = 1.0 + _EXCESS * (allowed["rms_current"] ** 2 - 1.0)
    return LongSimulation(replace(out, figures=figures), slow, allowed, tuple(windows))


def _windows(task: Task, out: Simulation) -> list[tuple[float, float]]:
    """Windows of the full drive [s]: around the largest values and at even distances, without overlap."""
    first, last = task.time[0], task.time[-1]
    about = [first + float(out.figures[f"{name}_time"][0]) % (last - first) for name in _PEAKS]
    about += np.linspace(first, last, _EVEN, endpoint=False).tolist()
    starts = sorted(min(max(t - 0.5 * _WATCHED, first), last - _WATCHED) for t in about)
    kept = starts[:1] + [b for a, b in pairwise(starts) if b > a]
    found: list[tuple[float, float]] = []
    for start in kept:
        if found and start < found[-1][1]:
            found[-1] = found[-1][0], start + _WATCHED
        else:
            found.append((start, start + _WATCHED))
    return found


def _seen(drive: Drive, task: Task, out: Simulation, start: float, end: float) -> Simulation:
    """Simulation of a drive in a window, from its temperature there; times are those of the whole motion."""
    begin = max(start - _LEAD, task.time[0])
    heat = drive.heat
    if heat is not None and out.series is not None:
        warm = float(np.interp(begin, out.series["time"], out.series["winding"]))
        heat = replace(heat, winding=warm, housing=warm)
    found = simulate(replace(drive, heat=heat), _cut(task, begin, start, end), rows=0)
    later = begin - task.time[0]
    return replace(
        found, figures={name: x + later * name.endswith("_time") for name, x in found.figures.items()}
    )  # fmt: skip


def _cut(task: Task, begin: float, start: float, end: float) -> Task:
    """A part of a task, recorded from a time on."""

    def part(times: Sequence[float] | Any, values: Sequence[float] | Any) -> tuple[Any, Any]:
        t = np.asarray(times, float)
        if not len(t):
            return (), ()
        some = np.concatenate(([begin], t[(t > begin) & (t < end)], [end]))
        return some, np.interp(some, t, np.asarray(values, float))

    time, speed = part(task.time, task.speed)
    load_time, load_torque = part(task.load_time, task.load_torque)
    return Task(
        time=time, speed=speed, load_time=load_time, load_torque=load_torque, since=start if start > begin else None
    )


def _allowed(name: str, out: Simulation, reported: dict[str, Any], pairs: Sequence[Any]) -> float:
    """Factor by which a figure may exceed its reported value: the largest of full over slower drive in the windows."""
    most = float(out.figures[name][0])
    found = [
        float(seen.figures[name][0] / slow.figures[name][0])
        for seen, slow in pairs
        if slow.figures[name][0] >= _NEAR * most > 0.0
    ]
    return max([1.0, *(x * most / float(reported[name][0]) for x in found)])


# -- A drive in closed loop: gains designed, loops analysed, and the drive simulated along a profile.
#
# Puts together ``voltage_loop_design`` or ``cascade_design`` (gains), ``loop_analysis`` (linear analysis) and
# ``engine`` (the sampled simulation with limits and heat); ``checks`` judges the result. Assumptions are kept with
# it.


_ROWS = 20_000  # most rows of a time series
_SHORTER = "expected a slower control.rate, one cycle of what repeats with a mission.duration, or a part with --profile"
_ROUNDS = 4  # of the search for the periodic temperatures
_NUDGE = 1.0  # K, difference of starts for a derivative
_FOUND = 0.05  # K, last step of the search for the fixed point
_HOTTEST = 2000.0  # K: beyond it the winding runs away


class ClosedLoop(NamedTuple):
    """A simulation in closed loop, with its inputs."""

    spec: RobotSpec
    drive_set: DriveParts
    profile: Profile
    train: DriveTrain
    controller: Gains | Cascade
    loops: Loops
    usable_voltage: float  # V, NaN unknown
    task: Task
    out: Simulation  # from ambient temperature
    unlimited: Simulation  # the same without limits; ``out`` where that one does not end
    periodic: dict[str, float]  # highest temperatures in the periodic steady state [K]; empty: unknown
    assumptions: tuple[str, ...]
    allowed: tuple[Mapping[str, float], Mapping[str, float]] = ({}, {})  # see ``long_motion``: with, without limits
    windows: tuple[tuple[float, float], ...] = ()  # s, the same
    steady_cycle: tuple[Simulation, ...] = ()  # one cycle in the periodic steady state, with and without limits
    steady_start: tuple[float, float] | None = None  # K, winding and housing at the start of that cycle

    def usable_for(self, required: float) -> float:
        """The usable voltage as it judges a required one [V]; NaN where a figure that decides is unknown."""
        if not math.isnan(self.usable_voltage):
            return self.usable_voltage
        return float(self.spec.feed_of(self.drive_set.controller).usable_for(required))

    def figure(self, name: str) -> float:
        """A figure of the simulation, SI."""
        return float(self.out.figures[name][0])

    def required(self, name: str) -> float:
        """A figure without limits, SI: the larger of the simulation and of the periodic steady state."""
        return _largest((self.unlimited, *self.steady_cycle[1:]), name)

    def drawn(self, name: str) -> float:
        """A figure with limits, SI: the larger of the simulation and of the periodic steady state."""
        return _largest((self.out, *self.steady_cycle[:1]), name)

    def allowance(self, name: str, *, required: bool = False) -> float:
        """Factor by which a figure may exceed its reported value; 1 where the whole motion was simulated in full."""
        return self.allowed[required].get(name, 1.0)

    @property
    def velocity_period(self) -> float:
        """Period of the velocity loop [s]."""
        return self.controller.period if isinstance(self.controller, Gains) else self.controller.velocity_period


def _largest(runs: Sequence[Simulation], name: str) -> float:
    """A peak, or its time, of the simulation with the largest one."""
    peak = name.removesuffix("_time")
    return float(max(runs, key=lambda one: one.figures[peak][0]).figures[name][0])


def run(spec: RobotSpec, drive_set: DriveParts, profile: Profile) -> ClosedLoop:
    """Design a controller for a drive, analyse its loops and simulate it along a profile for the mission's duration."""
    made = prepared(spec, drive_set, profile)
    loops = analyse(made.train, made.controller)
    drive, task = made.drive, made.task
    whole = _whole(drive, task)
    out = whole.out
    if out.problems[0]:
        cure = _SHORTER if "steps" in out.problems[0] else "expected other gains"
        raise InputError(f"profile {profile.name}: {out.problems[0]}; {cure}")
    free = _freed(drive, task, whole, loops)
    cycle = replace(task, cycles=1)
    found, start, last = _periodic(whole.drive, cycle, out if task.cycles == 1 else None)
    warm = () if last is out else _warm(start, last, cycle, loops)  # else it is the first one
    begins = (start.heat.winding, start.heat.housing) if warm and start.heat else None
    return ClosedLoop(
        spec, drive_set, profile, made.train, made.controller, loops, made.usable_voltage, task, out,
        free.out, found, made.assumptions, (whole.allowed, free.allowed), whole.windows, warm, begins,
    )  # fmt: skip


# --- the simulation without limits, and the periodic steady state


def _whole(drive: Drive, task: Task, rows: int = _ROWS) -> LongSimulation:
    """A simulation from end to end, by ``long_motion`` where it has more periods than are simulated in full."""
    out = simulate(drive, task, rows=rows)
    return simulate_long(drive, task, rows) if "steps" in out.problems[0] else LongSimulation(out, drive, {}, ())


def without_limits(drive: Drive, task: Task, out: Simulation, loops: Loops) -> Simulation:
    """Simulate without limits of voltage and current, the winding warming."""
    return _freed(drive, task, LongSimulation(out, drive, {}, ()), loops).out


def limited(out: Simulation, loops: Loops) -> bool:
    """Whether a simulation met limits without which it can be simulated."""
    met = out.figures["time_at_voltage_limit"][0] + out.figures["time_at_current_limit"][0]
    return bool(met) and all(loop.stable for loop in loops.all)


def unlimited(drive: Drive) -> Drive:
    """A drive without limits of voltage and current."""
    supply = replace(drive.supply, voltage=math.inf, resistance=0.0)
    return replace(drive, supply=supply, current=CurrentLimit())


def _freed(drive: Drive, task: Task, whole: LongSimulation, loops: Loops) -> LongSimulation:
    if not limited(whole.out, loops):
        return whole
    free = _whole(unlimited(drive), task, rows=0)
    return whole if free.out.problems[0] else free


def _warm(start: Drive, last: Simulation | None, task: Task, loops: Loops) -> tuple[Simulation, ...]:
    """The cycle of the periodic steady state, with and without limits; none where it is unknown or runs away."""
    if last is None or last.problems[0]:
        return ()
    return last, _freed(start, task, LongSimulation(last, start, {}, ()), loops).out


def _periodic(drive: Drive, task: Task, out: Simulation | None) -> tuple[dict[str, float], Drive, Simulation | None]:
    """Highest temperatures in the periodic steady state [K], the drive at the start of its cycle, its simulation.

    The two temperatures at the end of a cycle are nearly affine in those at its start: the fixed point is found by
    Newton's method, with the slopes of the simulation, which hold while the winding's resistance changes no current,
    else with differences of 1 K.
    """
    if drive.heat is None:
        return {}, drive, None
    last = out or simulate(drive, task, rows=0, most_steps=LONGEST)
    start, end = np.array([drive.heat.ambient, drive.heat.ambient]), _ends(last)
    for _ in range(_ROUNDS):
        slopes = last.slopes[0]
        if slopes is None or last.figures["time_at_voltage_limit"][0]:
            slopes = _slopes(drive, task, start, end)
        step = np.linalg.solve(np.eye(2) - slopes, end - start)
        if np.abs(step).max() < _FOUND:
            break
        start = start + step
        if not np.isfinite(start).all() or start.max() > _HOTTEST or np.abs(np.linalg.eigvals(slopes)).max() >= 1.0:
            return {"winding": math.inf, "housing": math.inf}, drive, None  # it runs away
        last = simulate(as_warm(drive, start), task, rows=0, most_steps=LONGEST)
        end = _ends(last)
    highest = {name: float(last.figures[f"{name}_highest"][0]) for name in ("winding", "housing")}
    return highest, as_warm(drive, start), last


def _slopes(drive: Drive, task: Task, start: Any, end: Any) -> Any:
    """Derivatives of winding and housing temperature at the end by those at the start, by simulation."""
    starts = [as_warm(drive, start + _NUDGE * unit) for unit in np.eye(2)]
    ends = [_ends(simulate(one, task, rows=0, most_steps=LONGEST)) for one in starts]
    return np.column_stack([(found - end) / _NUDGE for found in ends])


def as_warm(drive: Drive, start: Sequence[float] | NDArray[np.float64]) -> Drive:
    """A drive with other temperatures at the start."""
    if drive.heat is None:
        return drive
    return replace(drive, heat=replace(drive.heat, winding=float(start[0]), housing=float(start[1])))


def _ends(out: Simulation) -> Any:
    return np.array([out.figures["winding"][0], out.figures["housing"][0]])
