r"""PID and DC motor in python-control along the profile: the textbook's answer beside the engine's.

The model is that of ``loop_design``: a DC motor with the load's inertia where the motor drives it, a sampled controller
that computes for a period, the speed fed back. Its inputs are the reference speed and the load torque that the load
cycle has at that moment: friction and weight with the gears' efficiency by the direction of power. It starts in
equilibrium. Of a long stretch in which nothing changes as much is simulated as the loop takes to settle, of a motion of
many samples stretches around the engine's peaks.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import control
import numpy as np
from numpy.typing import NDArray

from drivesizer.control.closed_loop import ClosedLoop
from drivesizer.control.closed_loop.checks import LOOP_FIGURES
from drivesizer.control.drive_train import Regime, modes
from drivesizer.control.loop_design import (
    OUTPUTS,
    closed,
    position_open_loop,
    velocity_open_loop,
    voltage_open_loop,
)
from drivesizer.control.validation import Cascade, Gains, LinearFigure, LinearRun
from drivesizer.results.check import figure

Array = NDArray[np.float64]

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
    said = [
        "without limits of voltage and current, the winding at 25 °C",
        "dry friction and the gears' losses act by the reference's direction; the load's inertia is that of driving",
    ]
    if case.controller.counted_over:
        said.append("a counted speed is the mean over its periods, without the steps of whole counts")
    if case.train.gap:
        said.append("no backlash")
    if all(loop.stable for loop in case.loops.all):
        courses, shortened = _courses(case)
        series = _joined([_simulated(case, course) for course in courses])
        said += shortened
    else:
        said.append("an unstable loop has no response")
    return LinearRun(train=case.train, figures=_engine_figures(case, series), series=series, left_out=tuple(said))


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
    kept = corners - gone
    most = min(_MOST, _MOST_VALUES // (len(OUTPUTS) * c.current_steps))
    count = max(math.ceil((kept[-1] - kept[0]) / slow - 1e-9), 1) * round(slow / h)
    stretches = [(0, count)]
    if count > most:
        peaks = [case.figure(f"{own}_time") for _, own in _PEAKS.values()]
        places = [(peak - np.interp(peak, corners, gone) - kept[0]) / slow for peak in peaks]
        stretches = _stretches_around(places, count, most // len(peaks), round(slow / h))

    def course(first: int, end: int) -> _Course:
        t = kept[0] + h * np.arange(first, end + 1)
        w = np.interp(t, kept, speed) * case.train.ratio
        middle = t[:-1] + 0.5 * h
        slope = np.diff(w) / h
        load = _load_torque(case, 0.5 * (w[1:] + w[:-1]), slope, np.interp(middle, kept, more))
        before = _load_torque(case, w[:1], np.zeros(1), np.interp(t[:1], kept, more))[0]
        at = np.searchsorted(kept, t, side="right").clip(1, len(kept)) - 1
        return _Course(t + gone[at], w, slope, load, before)

    lasts, simulated = corners[-1] - corners[0], h * sum(end - first for first, end in stretches)
    said = []
    if simulated <= 0.999 * lasts:
        of = "of a constant stretch as much as it takes to settle"
        if count > most:
            of = "those around the engine's largest current, speed error and voltage, each from equilibrium"
        said = [f"{simulated:.4g} s of {lasts:.6g} s are simulated: {of}"]
    return [course(*stretch) for stretch in stretches], said


def _stretches_around(places: list[float], count: int, most: int, step: int) -> list[tuple[int, int]]:
    """Stretches of so many samples at most around places in steps, without overlap; each of whole steps."""
    length, found = max(most // step, 1), list[tuple[int, int]]()
    for place in sorted(places):
        first = round(max(min(place - length / 2, count // step - length), 0.0))
        begin = found.pop()[0] if found and first <= found[-1][1] else first
        found.append((begin, first + length))
    return [(first * step, end * step) for first, end in found]


def _load_torque(case: ClosedLoop, speed: Array, slope: Array, more: Array) -> Array:
    """Torque that resists the motor along the reference beyond the inertia of driving [N*m]."""
    train, turns = case.train, np.sign(speed)
    driving = train.load_inertia / (train.ratio**2 * train.efficiency)
    return np.asarray(train.at_motor(turns, more, slope) - driving * slope)


# --- the closed loop along it


def _simulated(case: ClosedLoop, course: _Course) -> dict[str, Array]:
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
    found = control.forced_response(
        loop, period * np.arange(inputs.shape[1] + 1), np.hstack([inputs, inputs[:, -1:]]), begins, squeeze=False
    ).outputs[:, :-1]
    columns = _over_time(found, c, steps)
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
    found: Array = (
        c.feedforward_velocity * speed + c.feedforward_friction * np.sign(speed) + c.feedforward_acceleration * slope
    )
    return found


def _over_time(outputs: Array, c: Gains | Cascade, steps: int) -> dict[str, Array]:
    """Outputs at every period of the innermost loop, out of those that a slower sample has one after another."""
    names = OUTPUTS[:-1] if isinstance(c, Gains) else OUTPUTS
    rows = outputs[:-1].reshape(max(steps, 1), -1, outputs.shape[1])
    rows = rows[:, :-1] if steps else rows  # the counted speed of each period of the velocity loop
    each = rows.reshape(max(steps, 1), c.current_steps, len(names), -1)
    return {name: each[:, :, k].transpose(2, 0, 1).ravel() for k, name in enumerate(names)}


# --- beside the engine


def _engine_figures(case: ClosedLoop, series: dict[str, Array]) -> tuple[LinearFigure, ...]:
    rotary, found = case.spec.load.shaft_axis == "rotary", list[LinearFigure]()
    for name, (column, figure_of_engine) in _PEAKS.items():
        value, at = math.nan, None
        if series:
            size = np.abs(series[column])
            peak = int(np.nanargmax(size))
            value, at = float(size[peak]), float(series["time"][peak])
        own = case.figure(figure_of_engine) * (case.train.radius if column == "error" else 1.0)
        ends = (value, at), (own, case.figure(f"{figure_of_engine}_time"))
        found.append(LinearFigure(*(figure(name, *one, rotary=rotary) for one in ends)))
    return *found, *(LinearFigure(figure(name, getattr(case.loops.velocity, name))) for name in LOOP_FIGURES)
