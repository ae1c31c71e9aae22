"""Axes of a machine on one bus in one of its load cases: their courses over the same time, and the sum.

Axes that start together are one course over the machine's cycle, each at its offset; one that rests at both ends of its
motion waits where that ends, and any other goes on repeating. Others run at any phase: those of independent machines,
and those whose periods have no multiple in common.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan, nan
from typing import NamedTuple

from drivesizer.errors import FieldError
from drivesizer.machine.regenerated import OnTheBus, regenerated_of
from drivesizer.machine.supply_power import DrivePower, drive_power, together
from drivesizer.multi_axis.exchange import MOST_PIECES, common_period, exchanged, fitted, from_start, summed_up
from drivesizer.multi_axis.machine_cycle import Moving, cycle_of
from drivesizer.multi_axis.phases import AtAnyPhase, bus_power, share_above, worst_start
from drivesizer.multi_axis.waiting import starts_and_ends_at_rest, unknown_at_rest, waiting
from drivesizer.physics.power_stage import Feed
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.machine_power import Exceeded
from drivesizer.results.problem import LoadCase, Problem
from drivesizer.spec.robot import RobotSpec

__all__ = ["AxisPower", "CommonBus", "common_bus"]

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
        return starts_and_ends_at_rest(cases) if self.repeats is None else not self.repeats


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
    groups = _groups(axes, waits, powers)
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


def _groups(axes: Sequence[AxisPower], waits: Sequence[bool], powers: list[DrivePower]) -> list[list[int]]:
    """Axes that run together, and each that runs at any phase; those of the first begin at their offsets."""
    waiting_ones = [k for k, one in enumerate(waits) if one]
    for k in waiting_ones:
        powers[k] = from_start(powers[k], axes[k].start)
    return ([waiting_ones] if waiting_ones else []) + [[k] for k, one in enumerate(waits) if not one]


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
