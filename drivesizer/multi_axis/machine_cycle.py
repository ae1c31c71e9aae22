"""The cycle of a machine whose axes start together, and the axes that wait at rest until it is over."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

from drivesizer.errors import FieldError, InputError, quoted
from drivesizer.load_cases.at_shaft import motion_of
from drivesizer.load_cases.of_machine import load_cases
from drivesizer.load_cases.waiting import rest_left
from drivesizer.spec.robot import AS_SPECIFIED, RobotSpec
from drivesizer.spec.several_axes.machine import AxisSpec, MachineSpec
from drivesizer.units import show

__all__ = ["Cycles", "Moving", "cycle_of", "waiting_times"]

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
    if not machine.synchronised or not machine.is_several:
        return {}
    found = {axis.name: _motions(spec_of(axis.name)) for axis in machine.axes if not axis.own_supply}
    more = list(dict.fromkeys(name for own in found.values() for name in own if name))
    cycles = {case: _cycle_in_case(machine, found, case) for case in more or [""]} if found else {}
    return {axis: dict(_axis_waiting(machine.axis(axis), own, cycles)) for axis, own in found.items()}


def _cycle_in_case(machine: MachineSpec, found: Mapping[str, Motions], case: str) -> float:
    """The machine's cycle in a load case [s]; an axis without that case has its first."""
    moving = []
    for name, own in found.items():
        period, at_rest = own.get(case) or own.get(AS_SPECIFIED) or next(iter(own.values()))
        moving.append(_moving(machine.axis(name), period, at_rest))
        if moving[-1].waits and not at_rest:
            where = machine.where(("axes", name, "repeats"))
            raise InputError(f"{where}: its motion is not at rest at both ends; expected true, or a motion that is")
    try:
        return cycle_of(moving, machine.cycle_time)
    except FieldError as error:
        raise InputError(f"{machine.where(error.field)}: {error}") from None


def _moving(axis: AxisSpec, period: float, at_rest: bool) -> Moving:
    return Moving(axis.name, axis.start, period, at_rest if axis.repeats is None else not axis.repeats)


def _axis_waiting(axis: AxisSpec, own: Motions, cycles: Mapping[str, float]) -> Iterator[tuple[str, float | None]]:
    """Until when an axis waits in each of its load cases."""
    for case, found in own.items():
        cycle, moving = cycles[case or next(iter(cycles))], _moving(axis, *found)
        yield case, cycle if moving.waits and rest_left(moving.period, cycle) else None


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
