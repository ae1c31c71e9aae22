"""The load cases of a machine as they are sized; its trip against what is required of it; warnings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from drivesizer.errors import InputError
from drivesizer.load_cases import load_cycle, load_springs, profile_of
from drivesizer.loads.course import course
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.physics.figures import Alike
from drivesizer.physics.load_cycle import CYCLE_COLUMNS, LoadCycle, OwnLimit, middle
from drivesizer.results.check import Check
from drivesizer.results.check_columns import CheckColumn, at_least, at_most
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

if TYPE_CHECKING:
    from drivesizer.spec.sections import Requirements


# -- Load cases that alternate, as one cycle: so many cycles of each as its share of the time says.
#
# A ramp of 10 % of a shift is not the whole shift: heat, energy and the battery follow from the cycle of all of
# them, and peaks are those of the worst. A case goes on for one cycle, or for as long as the spec says, before the
# others come.


_OFF = 0.01  # by which a share of the time may be off, of itself
_MOST = 20_000  # segments
_MOST_REPEATS = 200


def cycle_of_shift(spec: RobotSpec) -> LoadCycle:
    """The load cycle of a spec; where cases of it alternate, the cycle of all of them."""
    if not spec.shift:
        return load_cycle(spec)
    shares, lasting, specs = zip(*spec.shift, strict=True)
    cycles = [load_cycle(case) for case in specs]
    blocks = [max(1, round(time / cycle.total)) for time, cycle in zip(lasting, cycles, strict=True)]
    times = counts(shares, [n * cycle.total for n, cycle in zip(blocks, cycles, strict=True)])
    repeats = [n * block for n, block in zip(times, blocks, strict=True)]
    segments = sum(n * len(cycle.duration) for n, cycle in zip(repeats, cycles, strict=True))
    if segments > _MOST:
        raise InputError(
            f"{spec.where(('cases',))}: cases that alternate by their shares make {segments} segments; expected at "
            f"most {_MOST}, by shares nearer to one another, or a longer lasting"
        )
    worst: dict[str, OwnLimit] = {}  # of limits of one name that which is nearest to its demand, or past it most
    for limit in (limit for cycle in cycles for limit in cycle.own):
        other = worst.get(limit.name)
        if other is None or not limit.demand * other.limit <= other.demand * limit.limit:
            worst[limit.name] = limit
    in_turn = [cycle for n, cycle in zip(repeats, cycles, strict=True) for _ in range(n)]
    return replace(
        cycles[0],
        **{name: np.concatenate([getattr(c, name) for c in in_turn]) for name in CYCLE_COLUMNS},  # type: ignore[arg-type]
        inertia=float(np.max([cycle.inertia for cycle in cycles])),
        holding_torque=float(np.max([cycle.holding_torque for cycle in cycles])),
        own=tuple(worst.values()),
    )


def counts(shares: Sequence[float], times: Sequence[float]) -> list[int]:
    """Numbers of some blocks in the shortest whole in which their shares of the time are right to 1 %.

    Examples
    --------
    >>> counts([0.9, 0.1], [30.0, 30.0]), counts([0.75, 0.25], [10.0, 20.0])
    ([9, 1], [6, 1])
    """
    least = max(time / share for share, time in zip(shares, times, strict=True))
    candidates: list[tuple[float, list[int]]] = []
    for n in range(1, _MOST_REPEATS):
        numbers = [max(1, round(n * least * share / time)) for share, time in zip(shares, times, strict=True)]
        whole = sum(k * time for k, time in zip(numbers, times, strict=True))
        off = max(abs(k * t / whole / share - 1.0) for k, t, share in zip(numbers, times, shares, strict=True))
        if off <= _OFF:
            return numbers
        candidates.append((off, numbers))
    return min(candidates)[1]


def distance_of(spec: RobotSpec, cycle: LoadCycle) -> Alike:
    """Distance that a vehicle travels in a cycle, there and back [m], or in each of several; NaN of other loads."""
    load: Any = spec.load
    if load.is_wheel:
        return float(load.distance)
    if not isinstance(load, WheeledVehicle):
        return math.nan
    return cycle.radius * (middle(np.abs(cycle.speed)) * cycle.duration).sum(axis=0)


# -- Requirements on the machine against what its motion and its equipment come to, whatever drives it.


def requirement_checks(spec: RobotSpec, required: Requirements) -> tuple[Check, ...]:
    """Time over a distance, speed of the motion, devices; each where it is required."""
    columns = list[CheckColumn]()
    time, distance, fastest = _motion(spec)
    if required.travel is not None:
        columns.append(at_most("travel_time", required.travel.distance / distance * time, required.travel.within))
    if required.speed is not None:
        reached = required.speed if math.isclose(required.speed, fastest) else fastest  # but for rounding
        columns.append(at_least("motion_speed", required.speed, reached, by_choice=True))
    if required.devices:
        others = spec.budget.others if spec.budget else ()
        payloads = spec.platform.payloads if spec.platform else ()
        carried = {part.name for parts in (spec.equipment, others, payloads) for part in parts}
        missing = [name for name in required.devices if name not in carried]
        note = f"not among equipment, budget.others or payloads: {', '.join(missing)}" if missing else ""
        there = len(required.devices) - len(missing)
        columns.append(at_least("devices", len(required.devices), there, by_choice=True, note=note))
    return tuple(column.at((), "budget", rotary=spec.load.axis == "rotary") for column in columns)


def _motion(spec: RobotSpec) -> tuple[float, float, float]:
    """Time [s], distance there and back [m] and highest speed of a motion; of what does not travel no distance.

    With cases that share its time it is the motion of all of them.
    """
    if spec.platform is not None:
        from drivesizer.load_cases.platform import trajectory_of

        if trajectory := trajectory_of(spec):
            return trajectory.total, trajectory.length, float(np.hypot(*trajectory.velocity[:2]).max())
    cycle = cycle_of_shift(spec)
    return cycle.total, distance_of(spec, cycle), float(cycle.radius * np.abs(cycle.speed).max())


# -- Warnings of load cases: a motion that does not end where it started, driven wheels that cannot stand alone.
#
# A cycle repeats. A vehicle, a conveyor, a fan, a flywheel and an indexing table may go on from wherever they
# are; an arm, a hoist, a screw, a rack and a table that gravity pulls round may not: each further cycle would start
# farther on, the arm of a crane over its own base, and what is sized for is the first cycle alone.


_ROUNDING = 1e-6  # of the distance: a recording is no more exact
_TURN = 2.0 * math.pi
_STANDS = 3  # wheels at least


def starts_farther_on(name: str, spec: RobotSpec) -> tuple[str, ...]:
    """A warning where the cycle of a load case ends elsewhere than it starts; empty where it may, or does not."""
    lever, rotary = spec.load.lever, spec.load.axis == "rotary"
    pulled = lever is not None and lever.mass * lever.length * lever.share != 0.0
    if not spec.load.has_end and not pulled and not load_springs(spec):
        return ()
    motion = course(profile_of(spec))
    travel = motion.duration * motion.speed.mean(axis=1)
    off = float(travel.sum())
    if lever is not None and not load_springs(spec):  # a whole turn brings it back
        off -= _TURN * round(off / _TURN)
    if abs(off) <= _ROUNDING * float(abs(travel).sum()):
        return ()
    distance = show(abs(off), "deg", "angle", 3) if rotary else show(abs(off), "mm", "length", 3)
    of, side = f" of load case {name}" if name else "", "beyond" if off > 0.0 else "short of"
    return (
        f"the motion{of} ends {distance} {side} where it starts, and the cycle repeats: bring it back "
        "(there_and_back: true), or every cycle starts farther on than the one that is sized for",
    )


def grip_warning(spec: RobotSpec) -> tuple[str, ...]:
    """A warning where traction takes few driven wheels to carry all of the weight."""
    load = spec.load
    if not isinstance(load, WheeledVehicle) or spec.platform or load.friction_coefficient is None:
        return ()
    if load.driven_share is not None or load.driven_wheels >= _STANDS:
        return ()
    wheels = "1 driven wheel" if load.driven_wheels == 1 else f"{load.driven_wheels} driven wheels"
    return (
        f"traction: all of the weight is taken to be on {wheels}, which cannot stand alone; give load.driven_share, "
        "such as 60 %, where casters or other wheels carry the rest",
    )


# -- The load cases of a machine as they are sized; those of a platform are split into its wheels.


def load_cases(spec: RobotSpec) -> tuple[tuple[int, str, RobotSpec], ...]:
    """The load cases of a machine as they are sized: one for each driven wheel where its motion is a trajectory."""
    cases: list[tuple[int, str, RobotSpec]] = []
    for number, (name, case) in enumerate(spec.load_cases):
        if case.platform is None:
            cases.append((number, name, case))
        else:
            from drivesizer.load_cases.platform import wheels

            cases += [(number, *wheel) for wheel in wheels(name, case)]
    return tuple(cases)
