"""A drive in closed loop: gains designed, loops analysed, and the drive simulated along a profile.

Puts together ``voltage_loop_design`` or ``cascade_design`` (gains), ``loop_analysis`` (linear analysis) and ``engine``
(the sampled simulation with limits and heat); ``checks`` judges the result. Assumptions are kept with it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.cascade import Cascade
from drivesizer.control.closed_loop.long_motion import LONGEST, LongSimulation, simulate_long
from drivesizer.control.closed_loop.set_up import prepared
from drivesizer.control.drive_train import DriveTrain
from drivesizer.control.engine import CurrentLimit, Drive, Simulation, Task, simulate
from drivesizer.control.loop_analysis import analyse
from drivesizer.control.loop_records import Loops
from drivesizer.control.validation import Gains
from drivesizer.errors import InputError
from drivesizer.loads.course import Profile
from drivesizer.results.drive_set import DriveParts
from drivesizer.spec.robot import RobotSpec

__all__ = ["ClosedLoop", "as_warm", "limited", "run", "unlimited", "without_limits"]

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
