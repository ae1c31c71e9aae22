"""A drive in closed loop: gains designed, loops analysed, and the drive simulated along a profile, from cold and warm.

Gains are those of ``loop_design``, the simulation is that of ``engine``, the linear answer beside it python-control's;
``checks`` judges the result. Assumptions are kept with it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import control
import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import Controller, one_row
from drivesizer.control.drive_train import DriveTrain, Regime, modes, within_reach
from drivesizer.control.engine import CurrentLimit, Drive, MotorHeat, Simulation, Supply, Task, simulate
from drivesizer.control.loop_design import (
    OUTPUTS,
    analyse,
    closed,
    designed,
    edges_of,
    position_open_loop,
    velocity_open_loop,
    voltage_open_loop,
)
from drivesizer.control.validation import Cascade, Gains, LinearFigure, LinearRun, Loops
from drivesizer.errors import InputError
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.platform import remaining_torque
from drivesizer.loads.course import Profile
from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.physics.thermal import two_bodies
from drivesizer.physics.winding import housing_loss
from drivesizer.results.check import figure
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.ratings import controller_current
from drivesizer.spec.mounting import loss_at_flange
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

# -- Input of a simulation: drive train, designed controller, limits, heat and task of a drive.


FOLLOWS = 0.1  # of the top speed: a drive whose error exceeds it does not follow (our convention)
_DRAIN = 0.05  # s: slow for the current loop, short for a rest between two motions (our choice)
_WHOLE = 1e-9  # share of a cycle that is neglected


@dataclass(frozen=True, kw_only=True, eq=False)
class Prepared:
    """Input of a simulation, and the parts that it was made from."""

    spec: RobotSpec
    drive_set: DriveParts
    profile: Profile
    train: DriveTrain
    controller: Gains | Cascade
    usable_voltage: float  # V, NaN unknown
    drive: Drive  # as the engine takes it
    task: Task
    assumptions: tuple[str, ...]


def prepared(
    spec: RobotSpec, drive_set: DriveParts, profile: Profile, controller: Gains | Cascade | None = None
) -> Prepared:
    """A drive and its task as the engine takes them; an unknown limit is none there, and unknown in its check."""
    train, controller, assumptions = designed(spec, drive_set, controller)
    within_reach(train, profile)
    _sampled(controller.velocity_period, profile)
    feed, figures = spec.feed_of(drive_set.controller, drive_set.brake), drive_set.controller or Controller()
    usable, stage = float(feed.usable), feed.stage
    heat, lacks = motor_heat(spec, drive_set)

    def limit(value: float) -> float:
        return math.inf if math.isnan(value) else float(value)

    drive = Drive(
        train=train,
        controller=controller,
        supply=Supply(
            voltage=spec.supply.lowest, resistance=spec.supply.resistance or 0.0, sets=spec.load.motors,
            max_duty=1.0 if math.isnan(usable) else float(stage.max_duty),
            voltage_drop=0.0 if math.isnan(usable) else float(stage.drop),
            loss=float(stage.loss), stage_resistance=float(stage.resistance), standby=float(stage.standby),
            leads=float(feed.leads),
        ),
        current=CurrentLimit(
            peak=limit(figures["peak_current"]),
            continuous=limit(controller_current(figures, spec.environment.ambient)),
            peak_time=limit(figures["peak_time"]),
        ),
        edges=edges_of(spec, drive_set),
        heat=heat,
        drain_time=_DRAIN if spec.control.at_rest == "drain" else math.inf,
    )  # fmt: skip
    if not drive.supply.voltage > drive.supply.voltage_drop:
        raise InputError(
            f"supply: {show(drive.supply.voltage, 'V', 'voltage')} is no more than the controller's own drop, "
            f"{show(drive.supply.voltage_drop, 'V', 'voltage')}; expected more"
        )
    left = remaining_torque(spec, profile, train.load)
    lasts = spec.mission.duration / profile.duration if spec.mission else 1.0
    task = Task(
        time=profile.time,
        speed=tuple((np.array(profile.speed) / train.radius).tolist()),
        load_time=tuple(left[:, 0].tolist()),
        load_torque=tuple(left[:, 1].tolist()),
        cycles=max(1, math.ceil(lasts - _WHOLE)),
    )
    return Prepared(
        spec=spec, drive_set=drive_set, profile=profile, train=train, controller=controller, usable_voltage=usable,
        drive=drive, task=task, assumptions=(*assumptions, *lacks),
    )  # fmt: skip


def _sampled(period: float, profile: Profile) -> None:
    """Refuse a profile whose top speed lies between samples of the velocity loop, or that is too long to be counted."""
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


def motor_heat(spec: RobotSpec, drive_set: DriveParts) -> tuple[MotorHeat | None, list[str]]:
    """Winding and housing of a motor with their losses; that of the gearhead by the mean of the load cycle."""
    figures, bodies = drive_set.motor, two_bodies(drive_set.motor)
    if not (bodies.known and spec.plant.warming):
        return None, []
    coulomb, viscous = (float(x[0]) for x in housing_loss(figures, np.ones(1)))
    if spec.mounting and spec.mounting.gear_loss_share:
        cycle = CycleAtBelt(load_cycle(spec), drive_set.belt_efficiency).behind(drive_set.belt_ratio)
        gearhead = drive_set.gearhead
        coulomb += float(loss_at_flange(spec, cycle, one_row(gearhead))[0]) / gearhead.ratio
    lacks = math.isnan(coulomb) or math.isnan(viscous)
    of_torque, of_speed = (0.0 if math.isnan(loss) else loss for loss in (coulomb, viscous))
    heat = MotorHeat(bodies=bodies, ambient=spec.environment.ambient, loss_torque=of_torque, loss_viscous=of_speed)
    left_out = "the motor's losses other than copper loss are unknown and left out of its heating"
    return heat, [left_out] * lacks


# -- The simulation from cold, without limits, and in the periodic steady state.


_ROWS = 20_000  # most rows of a time series
LONGEST = 250_000_000  # steps of a simulation: some 40 s
_SHORTER = "expected a slower control.rate, one cycle of what repeats with a mission.duration, or a part with --profile"
_ROUNDS = 4  # of the search for the periodic temperatures
_NUDGE = 1.0  # K, difference of starts for a derivative
_LAST_STEP = 0.05  # K, last step of the search for the fixed point
_HOTTEST = 2000.0  # K: beyond it the winding runs away


@dataclass(frozen=True, kw_only=True, eq=False)
class ClosedLoop(Prepared):
    """A simulation in closed loop, with its inputs."""

    loops: Loops
    out: Simulation  # from ambient temperature
    unlimited: Simulation  # the same without limits; ``out`` where that one does not end
    periodic: dict[str, float]  # highest temperatures in the periodic steady state [K]; empty: unknown
    steady_cycle: tuple[Simulation, ...] = ()  # one cycle in the periodic steady state, with and without limits
    steady_start: tuple[float, float] | None = None  # K, winding and housing at the start of that cycle
    slow: bool = False  # whether the current loop is simulated at the velocity loop's rate

    def figure(self, name: str) -> float:
        """A figure of the simulation, SI."""
        return float(self.out.figures[name][0])

    def required(self, name: str) -> float:
        """A peak without limits, or its time, SI: the larger of the simulation and of the periodic steady state."""
        return _largest((self.unlimited, *self.steady_cycle[1:]), name)

    def peak(self, name: str) -> float:
        """A peak with limits, or its time, SI: the larger of the simulation and of the periodic steady state."""
        return _largest((self.out, *self.steady_cycle[:1]), name)


def _largest(runs: Sequence[Simulation], name: str) -> float:
    peak = name.removesuffix("_time")
    return float(max(runs, key=lambda out: out.figures[peak][0]).figures[name][0])


def run(spec: RobotSpec, drive_set: DriveParts, profile: Profile) -> ClosedLoop:
    """Design a controller for a drive, analyse its loops and simulate it along a profile for the mission's duration."""
    setup = prepared(spec, drive_set, profile)
    drive, task, slow = setup.drive, setup.task, None
    loops = analyse(setup.train, setup.controller)
    out = simulate(drive, task, rows=_ROWS, most_steps=LONGEST)
    if "steps" in out.problems[0] and (slow := slower(drive)):
        rates = [show(1.0 / machine.controller.current_period, "Hz", "frequency", 3) for machine in (drive, slow)]  # type: ignore[union-attr]
        drive, out = slow, simulate(slow, task, rows=_ROWS, most_steps=LONGEST)
        note = (f"the motion is too long for the current loop's {rates[0]}: it is simulated at the velocity loop's "
                f"{rates[1]}, and checks of the largest values allow for what lies between its samples")  # fmt: skip
        setup = replace(setup, assumptions=(*setup.assumptions, note))
    if out.problems[0]:
        cure = _SHORTER if "steps" in out.problems[0] else "expected other gains"
        raise InputError(f"profile {profile.name}: {out.problems[0]}; {cure}")
    (free,) = without_limits([(drive, task)], [out], loops)
    cycle = replace(task, cycles=1)
    rounds = 0 if spec.once else _ROUNDS  # from cold it is run once
    periodic, start, last = _periodic(drive, cycle, out if task.cycles == 1 else None, rounds)
    steady: tuple[Simulation, ...] = ()
    if last is not None and last is not out and not last.problems[0]:  # else it is the first one
        steady = last, *without_limits([(start, cycle)], [last], loops)
    begins = (start.heat.winding, start.heat.housing) if steady and start.heat else None
    return ClosedLoop(**vars(setup), loops=loops, out=out, unlimited=free, periodic=periodic, steady_cycle=steady,
                      steady_start=begins, slow=slow is not None)  # fmt: skip


def slower(drive: Drive) -> Drive | None:
    r"""A drive with its current loop at the velocity loop's rate, for motions of hours.

    A current loop runs ten times as often as the loop around it, and a simulation costs by its periods. The winding
    under the gains of the magnitude optimum is a lag :math:`T = L / k_p`; what that is after a velocity period
    :math:`h`, :math:`1 - b` with :math:`b = 1 - e^{-h/T}`, follows from the winding held over such a period,
    :math:`i' = a i + (1 - a) u / R` with :math:`a = e^{-hR/L}`, by the PI that cancels its pole:

    .. math:: k_p = \frac{a\,b\,R}{1 - a}, \quad k_i h = b R

    It answers at once, as the lag includes the delay. All else is unchanged: the outer loops with their delays,
    counts, friction, backlash, limits, heat. The current between two samples of the velocity loop is left out.
    """
    c, m = drive.controller, drive.train
    if not isinstance(c, Cascade) or c.current_steps == 1 or not c.current_kp > 0.0:
        return None
    h, R = c.velocity_period, m.resistance
    decay, share = math.exp(-h * R / m.inductance), -math.expm1(-h * c.current_kp / m.inductance)
    kp, ki = decay * share * R / (1.0 - decay), share * R / h
    return replace(drive, controller=replace(c, current_kp=kp, current_ki=ki, current_period=h), prompt=True)


def simulated(jobs: Sequence[tuple[Drive, Task]]) -> list[Simulation]:
    """Each drive on its task, without time series; those with the same task side by side."""
    simulations: dict[int, Simulation] = {}
    for n, (_, task) in enumerate(jobs):
        if n not in simulations:
            places = [k for k, (_, other) in enumerate(jobs) if other == task]
            together = simulate([jobs[k][0] for k in places], task, rows=0, most_steps=LONGEST)
            for place, k in enumerate(places):
                figures = {name: column[place : place + 1] for name, column in together.figures.items()}
                simulations[k] = Simulation(figures=figures, problems=(together.problems[place],), series=None)
    return [simulations[n] for n in range(len(jobs))]


def without_limits(
    jobs: Sequence[tuple[Drive, Task]], simulations: Sequence[Simulation], loops: Loops
) -> list[Simulation]:
    """Drives that met a limit of voltage or current without any, the winding warming; as they are where that fails."""
    stable, free = all(loop.stable for loop in loops.all), [*simulations]
    met = [out.figures["time_at_voltage_limit"][0] + out.figures["time_at_current_limit"][0] for out in simulations]
    places = [n for n, out in enumerate(simulations) if stable and met[n] and not out.problems[0]]
    unlimited = [
        (replace(drive, supply=replace(drive.supply, voltage=math.inf, resistance=0.0), current=CurrentLimit()), task)
        for drive, task in (jobs[n] for n in places)
    ]
    for n, out in zip(places, simulated(unlimited), strict=True):
        free[n] = simulations[n] if out.problems[0] else out
    return free


def as_warm(drive: Drive, start: Sequence[float] | NDArray[np.float64]) -> Drive:
    """A drive with other temperatures at the start."""
    if drive.heat is None:
        return drive
    return replace(drive, heat=replace(drive.heat, winding=float(start[0]), housing=float(start[1])))


def _periodic(
    drive: Drive, task: Task, out: Simulation | None, rounds: int
) -> tuple[dict[str, float], Drive, Simulation | None]:
    """Highest temperatures in the periodic steady state [K], the drive at the start of its cycle, its simulation.

    The two temperatures at the end of a cycle are nearly affine in those at its start: the fixed point is found by
    Newton's method, with the slopes of the simulation, which hold while the winding's resistance changes no current,
    else with differences of 1 K.
    """
    if drive.heat is None:
        return {}, drive, None

    def after(begin: Any) -> tuple[Simulation, Any]:
        simulation = simulate(as_warm(drive, begin), task, rows=0, most_steps=LONGEST)
        return simulation, np.array([simulation.figures["winding"][0], simulation.figures["housing"][0]])

    start = np.array([drive.heat.ambient, drive.heat.ambient])
    last, end = after(start) if out is None else (out, np.array([out.figures[n][0] for n in ("winding", "housing")]))
    for _ in range(rounds):
        slopes = last.slopes[0]
        if slopes is None or last.figures["time_at_voltage_limit"][0]:
            slopes = np.column_stack([(after(start + _NUDGE * unit)[1] - end) / _NUDGE for unit in np.eye(2)])
        step = np.linalg.solve(np.eye(2) - slopes, end - start)
        if np.abs(step).max() < _LAST_STEP:
            break
        start = start + step
        if not np.isfinite(start).all() or start.max() > _HOTTEST or np.abs(np.linalg.eigvals(slopes)).max() >= 1.0:
            return {"winding": math.inf, "housing": math.inf}, drive, None  # it runs away
        last, end = after(start)
    highest = {name: float(last.figures[f"{name}_highest"][0]) for name in ("winding", "housing")}
    return highest, as_warm(drive, start), last


# -- PID and DC motor in python-control along the profile: the textbook's answer beside the engine's.
#
# The model is that of ``loop_design``: a DC motor with the load's inertia where the motor drives it, a sampled
# controller that computes for a period, the speed fed back. Its inputs are the reference speed and the load torque that
# the load cycle has at that moment: friction and weight with the gears' efficiency by the direction of power. It starts
# in equilibrium. Of a long stretch in which nothing changes as much is simulated as the loop takes to settle, of a
# motion of many samples stretches around the engine's peaks.


Array = NDArray[np.float64]

LOOP_FIGURES = ("bandwidth", "phase_margin", "gain_margin", "overshoot")  # of the velocity loop
_PEAKS = {  # column of the series, figure of the engine
    "peak_current": ("current", "current"),
    "tracking_error_peak": ("error", "load_speed_error"),
    "peak_voltage": ("voltage", "voltage"),
}
_SETTLED = 1e-6  # of a transient, after which nothing more of a constant stretch is simulated
_MOST, _MOST_VALUES = 100_000, 5_000_000  # samples of the velocity loop, and values of all outputs in them


def linear_run(case: ClosedLoop) -> LinearRun:
    """Simulate the linear loop along the profile of a simulation, and put the figures of both beside each other."""
    series: dict[str, Array] = {}
    left_out = [
        "without limits of voltage and current, the winding at 25 °C",
        "dry friction and the gears' losses act by the reference's direction; the load's inertia is that of driving",
    ]
    if case.controller.counted_over:
        left_out.append("a counted speed is the mean over its periods, without the steps of whole counts")
    if case.train.gap:
        left_out.append("no backlash")
    if all(loop.stable for loop in case.loops.all):
        courses, shortened = _courses(case)
        series = _joined([_linear_response(case, course) for course in courses])
        left_out += shortened
    else:
        left_out.append("an unstable loop has no response")
    return LinearRun(train=case.train, figures=_engine_figures(case, series), series=series, left_out=tuple(left_out))


# --- the course: reference and load torque at the samples


class _Course(NamedTuple):
    """Reference and load at the samples of the velocity loop."""

    time: Array  # s of the profile
    speed: Array  # rad/s of the motor, one more than there are periods
    slope: Array  # rad/s^2 over each period
    load: Array  # N*m at the motor, over each period
    before: float  # N*m, before it begins


def _courses(case: ClosedLoop) -> tuple[list[_Course], list[str]]:
    """The whole motion or stretches of it, and what is left out, as a sentence."""
    task, h, c = case.task, case.controller.velocity_period, case.controller
    settling = max(  # time in which the slowest transient of all loops fades [s]
        loop.period * math.log(_SETTLED) / math.log(min(max(loop.pole_radius, 0.1), 1.0 - 1e-12))
        for loop in case.loops.all
    )
    start = task.time[0]
    corners = np.unique(np.concatenate([task.time, [t for t in task.load_time if start < t < task.time[-1]]]))
    speed = np.interp(corners, task.time, task.speed)
    more = np.interp(corners, task.load_time, task.load_torque) if len(task.load_time) else np.zeros(len(corners))
    slow = h * max(c.velocity_steps, 1)
    steady = (np.diff(speed) == 0.0) & (np.diff(more) == 0.0)
    spare = np.where(steady, np.floor((np.diff(corners) - settling) / slow).clip(0.0) * slow, 0.0)
    gone = np.concatenate([[0.0], np.cumsum(spare)])  # s left out until a corner
    moments = corners - gone
    most = min(_MOST, _MOST_VALUES // (len(OUTPUTS) * c.current_steps))
    count = max(math.ceil((moments[-1] - moments[0]) / slow - 1e-9), 1) * round(slow / h)
    stretches = [(0, count)]
    if count > most:
        peaks = [case.figure(f"{own}_time") for _, own in _PEAKS.values()]
        places = [(peak - np.interp(peak, corners, gone) - moments[0]) / slow for peak in peaks]
        stretches = _stretches_around(places, count, most // len(peaks), round(slow / h))

    def course(first: int, end: int) -> _Course:
        t = moments[0] + h * np.arange(first, end + 1)
        w = np.interp(t, moments, speed) * case.train.ratio
        middle = t[:-1] + 0.5 * h
        slope = np.diff(w) / h
        load = _load_torque(case, 0.5 * (w[1:] + w[:-1]), slope, np.interp(middle, moments, more))
        before = _load_torque(case, w[:1], np.zeros(1), np.interp(t[:1], moments, more))[0]
        at = np.searchsorted(moments, t, side="right").clip(1, len(moments)) - 1
        return _Course(t + gone[at], w, slope, load, before)

    lasts, simulated = corners[-1] - corners[0], h * sum(end - first for first, end in stretches)
    left_out = []
    if simulated <= 0.999 * lasts:
        of = "of a constant stretch as much as it takes to settle"
        if count > most:
            of = "those around the engine's largest current, speed error and voltage, each from equilibrium"
        left_out = [f"{simulated:.4g} s of {lasts:.6g} s are simulated: {of}"]
    return [course(*stretch) for stretch in stretches], left_out


def _stretches_around(places: list[float], count: int, most: int, step: int) -> list[tuple[int, int]]:
    """Stretches of so many samples at most around places in steps, without overlap; each of whole steps."""
    length, stretches = max(most // step, 1), list[tuple[int, int]]()
    for place in sorted(places):
        first = round(max(min(place - length / 2, count // step - length), 0.0))
        begin = stretches.pop()[0] if stretches and first <= stretches[-1][1] else first
        stretches.append((begin, first + length))
    return [(first * step, end * step) for first, end in stretches]


def _load_torque(case: ClosedLoop, speed: Array, slope: Array, more: Array) -> Array:
    """Torque that resists the motor along the reference beyond the inertia of driving [N*m]."""
    train, turns = case.train, np.sign(speed)
    driving = train.load_inertia / (train.ratio**2 * train.efficiency)
    return np.asarray(train.at_motor(turns, more, slope) - driving * slope)


# --- the closed loop along it


def _linear_response(case: ClosedLoop, course: _Course) -> dict[str, Array]:
    """The linear loop over time: reference, speed and error of the load, current, voltage."""
    c, mode = case.controller, modes(case.train)[Regime.FORWARD_DRIVING]
    speed, load = course.speed[:-1], course.load
    fed = _feedforward(c, speed, course.slope)
    steps = c.velocity_steps
    if isinstance(c, Gains):
        opened = voltage_open_loop(case.train, mode, c)
    else:
        opened = (position_open_loop if steps else velocity_open_loop)(case.train, mode, c, fine=True)
    loop = closed(opened, [*[0.0] * (opened.noutputs - 1), 1.0])  # with all its inputs; the last output is fed back
    period = c.velocity_period * max(steps, 1)
    ahead = float(not steps or not isinstance(c, Cascade) or c.planned_speed)
    inputs = np.stack([ahead * speed, fed, load])
    if steps:
        angle = np.concatenate([[0.0], np.cumsum(0.5 * (course.speed[1:] + course.speed[:-1]))[:-1]])
        inputs = np.vstack([
            angle[::steps] * case.controller.velocity_period,
            inputs.T.reshape(-1, 3 * steps).T,
        ])  # fmt: skip
    rising = np.zeros(len(inputs))
    rising[0] = speed[0] * period if steps else 0.0  # the reference angle, while the speed is that of the start
    still = np.eye(loop.nstates) - loop.A
    moves = np.linalg.solve(still, loop.B @ rising)
    first = inputs[:, 0].copy()
    first[-1 if steps == 0 else 3 :: 3] = course.before
    first[1 if steps == 0 else 2 :: 3] = _feedforward(c, speed[:1], np.zeros(1))[0]
    begins = np.linalg.solve(still, loop.B @ first - moves)
    # one sample more: python-control wants two at least
    outputs = control.forced_response(
        loop, period * np.arange(inputs.shape[1] + 1), np.hstack([inputs, inputs[:, -1:]]), begins, squeeze=False
    ).outputs[:, :-1]
    columns = _over_time(outputs, c, steps)
    n, fine = c.current_steps, case.controller.velocity_period / c.current_steps
    time = (course.time[:-1, None] + fine * np.arange(n)).ravel()
    share = np.arange(n) / n
    reference = (speed[:, None] + share * np.diff(course.speed)[:, None]).ravel() / case.train.motor_per_speed
    seen = columns["load_speed"] / case.train.motor_per_speed
    return {
        "time": time,
        "speed_reference": reference,
        "speed": seen,
        "error": reference - seen,
        "current": columns["current"],
        "voltage": columns["voltage"],
    }


def _joined(runs: list[dict[str, Array]]) -> dict[str, Array]:
    """Stretches one behind the other; where one ends but the last, a sample without figures."""
    ends = [{name: x[-1:] if name == "time" else np.full(1, math.nan) for name, x in run.items()} for run in runs]
    parts = [part for pair in zip(runs, ends, strict=True) for part in pair][:-1]
    return {name: np.concatenate([part[name] for part in parts]) for name in runs[0]}


def _feedforward(c: Gains | Cascade, speed: Array, slope: Array) -> Array:
    """Feed-forward: what a controller adds to its demand by the reference, current [A] or voltage [V]."""
    return c.feedforward_velocity * speed + c.feedforward_friction * np.sign(speed) + c.feedforward_acceleration * slope


def _over_time(outputs: Array, c: Gains | Cascade, steps: int) -> dict[str, Array]:
    """Outputs at every period of the innermost loop, out of those that a slower sample has one after another."""
    names = OUTPUTS[:-1] if isinstance(c, Gains) else OUTPUTS
    rows = outputs[:-1].reshape(max(steps, 1), -1, outputs.shape[1])
    rows = rows[:, :-1] if steps else rows  # the counted speed of each period of the velocity loop
    by_step = rows.reshape(max(steps, 1), c.current_steps, len(names), -1)
    return {name: by_step[:, :, k].transpose(2, 0, 1).ravel() for k, name in enumerate(names)}


# --- beside the engine


def _engine_figures(case: ClosedLoop, series: dict[str, Array]) -> tuple[LinearFigure, ...]:
    rotary, rows = case.spec.load.shaft_axis == "rotary", list[LinearFigure]()
    for name, (column, figure_of_engine) in _PEAKS.items():
        value, at = math.nan, None
        if series:
            size = np.abs(series[column])
            peak = int(np.nanargmax(size))
            value, at = float(size[peak]), float(series["time"][peak])
        own = case.figure(figure_of_engine) * (case.train.radius if column == "error" else 1.0)
        ends = (value, at), (own, case.figure(f"{figure_of_engine}_time"))
        rows.append(LinearFigure(*(figure(name, *end, rotary=rotary) for end in ends)))
    return *rows, *(LinearFigure(figure(name, getattr(case.loops.velocity, name))) for name in LOOP_FIGURES)
