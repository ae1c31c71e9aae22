"""Axes on one bus over the same time: their courses, and rests until the cycle is over."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import isnan, nan
from typing import NamedTuple

import numpy as np

from drivesizer.errors import FieldError, InputError, quoted
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.of_machine import load_cases
from drivesizer.load_cases.platform import motion_of
from drivesizer.load_cases.profile import rest_left, static_torque, with_rest
from drivesizer.machine.problem import load_case, quickest_winding
from drivesizer.machine.supply_power import DrivePower, OnTheBus, drive_power, regenerated_of, together
from drivesizer.multi_axis.phases import (
    MOST_PIECES,
    AtAnyPhase,
    bus_power,
    common_period,
    exchanged,
    fitted,
    from_start,
    share_above,
    summed_up,
    worst_start,
)
from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.physics.power_stage import Feed
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.machine import Exceeded
from drivesizer.results.problem import LoadCase, Problem
from drivesizer.spec.machine_record import MachineSpec
from drivesizer.spec.robot import AS_SPECIFIED, RobotSpec
from drivesizer.units import show

# -- The cycle of a machine whose axes start together, and the axes that wait at rest until it is over.


_NO_TIME = 1e-9  # of the cycle
_STILL = 1e-9  # of the largest speed
Motions = dict[str, tuple[float, bool]]  # by load case: period [s], and whether it is at rest at both ends of it
Cycles = Mapping[str, Mapping[str, float | None]]  # s, by axis and load case: until when it waits, if it does
# by axis and load case, s: until when it waits; None where it does not


class Moving(NamedTuple):
    """The motion of an axis in a load case."""

    name: str
    start: float  # s, in the machine's cycle
    period: float  # s
    waits: bool  # for the others, when it is done


def cycle_of(axes: Sequence[Moving], cycle_time: float | None) -> float:
    """Length of the machine's cycle: as given, or until the last axis that waits for the others is done."""
    ones = [one for one in axes if one.waits]
    if not ones:
        return max(one.period for one in axes)
    if cycle_time is None:
        return max(one.start + one.period for one in ones)
    late = next((one for one in ones if one.period > cycle_time * (1.0 + _NO_TIME)), None)
    if late is not None:
        taken, given = (show(value, "s", "time") for value in (late.period, cycle_time))
        raise FieldError(("cycle_time",), f"axis {quoted(late.name)} moves for {taken}; expected no less, not {given}")
    return cycle_time


def waiting_times(machine: MachineSpec, spec_of: Callable[[str], RobotSpec]) -> Cycles:
    """Until when each axis waits at rest: for the others, or for the machine's ``cycle_time``."""
    if not machine.synchronised:
        return {}
    found = {axis.name: _motions(spec_of(axis.name)) for axis in machine.axes if not axis.own_supply}

    def moving(name: str, period: float, at_rest: bool) -> Moving:
        axis = machine.axis(name)
        return Moving(name, axis.start, period, at_rest if axis.repeats is None else not axis.repeats)

    def cycle_in(case: str) -> float:
        """The machine's cycle in a load case [s]; an axis without that case has its first."""
        every = []
        for name, own in found.items():
            period, at_rest = own.get(case) or own.get(AS_SPECIFIED) or next(iter(own.values()))
            every.append(moving(name, period, at_rest))
            if every[-1].waits and not at_rest:
                where = machine.where(("axes", name, "repeats"))
                raise InputError(f"{where}: its motion is not at rest at both ends; expected true, or a motion that is")
        try:
            return cycle_of(every, machine.cycle_time)
        except FieldError as error:
            raise InputError(f"{machine.where(error.field)}: {error}") from None

    more = list(dict.fromkeys(name for own in found.values() for name in own if name))
    cycles = {case: cycle_in(case) for case in more or [""]} if found else {}
    waiting: dict[str, dict[str, float | None]] = {name: {} for name in found}
    for name, own in found.items():
        for case, motion in own.items():
            cycle, one = cycles[case or next(iter(cycles))], moving(name, *motion)
            waiting[name][case] = cycle if one.waits and rest_left(one.period, cycle) else None
    return waiting


def _motions(spec: RobotSpec) -> Motions:
    """The motion of an axis in its load cases."""
    names = [name for name, _ in spec.load_cases]
    found: Motions = {}
    for number, _, case in load_cases(spec):
        motion = motion_of(case)
        still = max(abs(motion.speed[0]), abs(motion.speed[-1])) <= _STILL * motion.top_speed
        _, before = found.get(names[number], (0.0, True))
        found[names[number]] = motion.duration, still and before
    return found


# -- An axis that waits at rest, its motion done, until the machine's cycle is over, as its power on the bus.
#
# Axes are sized with that rest; on the bus it is what the cycle of all leaves, which over tolerances is another one.


def moving_alone(problem: Problem) -> Problem:
    """An axis without the rest in which it waits."""
    if all(case.spec.waits_until is None for case in problem.cases):
        return problem
    quickest = quickest_winding(problem.catalog)
    cases = tuple(load_case(case.name, case.number, case.spec.waiting({}), quickest) for case in problem.cases)
    return replace(problem, machine=problem.machine.waiting({}), cases=cases)


def waiting(case: LoadCase, until: float) -> CycleAtBelt:
    """The load cycle of an axis with a rest at its end."""
    if not rest_left(case.cycle.total, until):
        return case.at_belt
    cycle = load_cycle(case.spec.waiting(dict.fromkeys([name for name, _ in case.spec.load_cases], until)))
    held = static_torque(cycle)
    cycle = with_rest(cycle, until, 0.0 if isnan(held) else held)
    return CycleAtBelt(cycle, case.spec.belt_efficiency, case.at_belt.quickest)


def unknown_at_rest(cases: Sequence[LoadCase]) -> str:
    """Reason for which the power at rest is unknown; empty where it is not."""
    lacking = any(isnan(static_torque(case.cycle)) for case in cases)
    return "what holds it at rest is unknown: end its motion with a rest" if lacking else ""


# -- Axes of a machine on one bus in one of its load cases: their courses over the same time, and the sum.
#
# Axes that start together are one course over the machine's cycle, each at its offset; one that rests at both ends
# of its motion waits where that ends, and any other goes on repeating. Others run at any phase: those of independent
# machines, and those whose periods have no multiple in common.


_SHOWN = 20  # of the longest period, where there is no common one
_MOST_SHOWN = 1_000_000  # pieces


class AxisPower(NamedTuple):
    """An axis on the supply."""

    name: str
    problem: Problem
    one: DriveParts
    start: float = 0.0  # s, of its motion in the machine's cycle
    repeats: bool | None = None  # goes on repeating; where not said, if it is not at rest at both ends of its motion

    def case(self, name: str) -> list[LoadCase]:
        """Its drives in the load case of a name; in the first one where it has none of that name."""
        numbers = {own: number for number, (own, _) in enumerate(self.problem.machine.load_cases)}
        return [self.problem.cases[k] for k in self.problem.machine_cases[numbers.get(name, 0)]]

    def waits(self, cases: Sequence[LoadCase]) -> bool:
        """Whether it waits for the others when it is done."""
        if self.repeats is not None:
            return not self.repeats
        cycles = [case.cycle for case in cases]  # unless it moves at an end of its motion
        ends = [max(abs(float(one.speed[0, 0])), abs(float(one.speed[-1, 1]))) for one in cycles]
        return all(end <= _STILL * float(np.abs(one.speed).max()) for end, one in zip(ends, cycles, strict=True))


class CommonBus(NamedTuple):
    """All axes in one load case."""

    spec: RobotSpec
    feed: Feed
    axes: list[DrivePower]  # over the same time
    total: DrivePower  # as the sum is judged
    on_bus: OnTheBus
    together: tuple[DrivePower, ...]  # those that run at any phase to one another, each over its own period
    cycle: float  # s, of the machine; of axes at random phases the longest
    phases: tuple[float, ...]
    synchronised: bool  # whether the axes start together, as far as their periods let them
    exceeded: tuple[Exceeded, ...]  # limits of the supply, at random phases


def common_bus(
    name: str, shared: RobotSpec, axes: Sequence[AxisPower], synchronised: bool, cycle_time: float | None
) -> CommonBus:
    """All axes of a machine on its bus in a load case."""
    feed = shared.feed_of(None)._replace(drives=1)
    cases = [axis.case(name) for axis in axes]
    waits = [synchronised and axis.waits(some) for axis, some in zip(axes, cases, strict=True)]
    rows = zip(axes, cases, waits, strict=True)
    moving = [Moving(axis.name, axis.start, own[0].cycle.total, one) for axis, own, one in rows]
    cycle = cycle_of(moving, cycle_time)
    powers = [_axis_power(*row, cycle) for row in zip(axes, cases, waits, strict=True)]
    window = common_period([power.total for power in powers], [len(power.duration) for power in powers])
    if synchronised and not isnan(window) and len(axes) > 1:
        powers = [from_start(fitted(p, window), axis.start) for axis, p in zip(axes, powers, strict=True)]
    if len(axes) == 1 or (synchronised and not isnan(window)):
        total = exchanged(powers, feed)
        on_bus = regenerated_of(name, shared, total)
        return CommonBus(shared, feed, powers, total, on_bus, (total,), cycle, (), synchronised, ())
    side_by_side = [k for k, one in enumerate(waits) if one]  # the others run each at any phase
    for k in side_by_side:
        powers[k] = from_start(powers[k], axes[k].start)
    groups = ([side_by_side] if side_by_side else []) + [[k] for k, one in enumerate(waits) if not one]
    apart = tuple(exchanged([powers[k] for k in group], feed) for group in groups)
    window = _shown(powers) if isnan(window) else window
    phases = {k: worst_start(fitted(whole, window)) for group, whole in zip(groups, apart, strict=True) for k in group}
    shown = [from_start(fitted(power, window), phases[k]) for k, power in enumerate(powers)]
    singles = tuple(regenerated_of(name, shared, power) for power in apart)
    at_any = AtAnyPhase(name, shared, apart, singles, feed)
    aligned = [from_start(fitted(p, window), phases[group[0]]) for group, p in zip(groups, apart, strict=True)]
    starts = tuple(phases[k] % power.total for k, power in enumerate(powers))
    total, exceeded = summed_up(aligned, feed), _exceeded(shared, apart, feed)
    return CommonBus(shared, feed, shown, total, at_any, apart, cycle, starts, synchronised, exceeded)


def _shown(powers: Sequence[DrivePower]) -> float:
    """Time over which courses without a common period are shown [s]: some of the longest, as pieces allow."""
    longest = max(power.total for power in powers)
    pieces = sum(len(power.duration) * longest / power.total for power in powers)
    if pieces > _MOST_SHOWN:
        shortest = min(power.total for power in powers)
        raise FieldError(
            ("axes",),
            f"cycles of the axes last from {shortest:.4g} s to {longest:.4g} s, too far apart to be taken together; "
            "expected e.g. shorter motions of the slow axis",
        )
    return longest * max(1, min(_SHOWN, int(MOST_PIECES / pieces)))


def _axis_power(axis: AxisPower, cases: Sequence[LoadCase], waits: bool, cycle: float) -> DrivePower:
    """Power of all drives of an axis over its own period, or waiting until the machine's cycle is over."""
    cycles = [waiting(case, cycle) if waits else case.at_belt for case in cases]
    found = together([drive_power(case.spec, axis.one, base) for case, base in zip(cases, cycles, strict=True)])
    return found.times(nan) if waits and cycle > cases[0].cycle.total and unknown_at_rest(cases) else found


def _exceeded(shared: RobotSpec, apart: Sequence[DrivePower], feed: Feed) -> tuple[Exceeded, ...]:
    """Share of the time in which random phases exceed a limit of the supply."""
    supply = shared.supply
    limits = [
        ("supply_continuous_current", None if supply.peak_current is None else supply.current, supply.lowest),
        ("supply_current", supply.most_current, supply.lowest),
        ("supply_power", supply.power, 1.0),
    ]
    found = []
    for name, limit, scale in limits:
        if limit is None:
            continue
        power = bus_power(limit * scale, feed)
        least, most = (
            share_above([(one.duration, getattr(one, end)) for one in apart], power, up=up)
            for end, up in (("least", False), ("most", True))
        )
        found.append(Exceeded(name, limit * scale, least, most))
    return tuple(found)
