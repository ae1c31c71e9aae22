"""A machine of several axes, for several kinds of output: its axes as a tree, and how its drives were chosen."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from drivesizer.output.words import likely
from drivesizer.results.check import Reliability, sentence_case
from drivesizer.results.machine import MachinePower, MachineSizing
from drivesizer.spec.machine import MachineSpec
from drivesizer.units import show


class Branch(NamedTuple):
    """An axis in the tree of a machine: below the one that its drives ride on."""

    name: str
    depth: int  # 0 for one that rides on none
    on: str  # the axis that carries it; empty for one that rides on none


def mass_tree(machine: MachineSpec) -> list[Branch]:
    """The axes of a machine from those that carry all others to the outermost."""
    riding = {axis.name: list(machine.carried(axis.name)) for axis in machine.axes}
    carried = {name for names in riding.values() for name in names}

    def below(name: str, depth: int, on: str) -> Iterator[Branch]:
        yield Branch(name, depth, on)
        further = {other for one in riding[name] for other in riding[one]}
        for other in riding[name]:
            if other not in further:
                yield from below(other, depth + 1, name)

    return [branch for axis in machine.axes if axis.name not in carried for branch in below(axis.name, 0, "")]


def choice_text(result: MachineSizing) -> str:
    """Whether another choice of the drives that ride on others can be better."""
    if not result.complete or not any(axis.carried for axis in result.axes):
        return ""
    said = "no other choice of the carried drives gives"
    said = said if result.certain else "another choice of the carried drives may give"
    return f"{said} less {result.objective.replace('_', ' ')} in all"


def supply_texts(power: MachinePower) -> Iterator[str]:
    """Power of all axes in a sentence each: peak, mean, what is regenerated and what burns it."""
    if power.unknown:
        yield f"power of all axes unknown: {'; '.join(power.unknown)}"
        return
    peak, mean = (show(value, "W", "power") for value in (power.peak, power.mean))
    moment = f"at {show(power.peak_time, 's', 'time')}" if power.synchronised else "at the worst phase"
    yield f"supply: {peak} at most, {moment}, most of it {power.peak_axis}; {mean} in the mean"
    if power.energy_left > 0.0:
        left, shared = (show(value, "J", "energy") for value in (power.energy_left, power.exchanged))
        resistor = power.braking.name if power.braking else ""
        burnt = f", brake resistor {resistor}" if resistor else ""
        drawn = f"{left} that no axis draws, {shared} from axis to axis" if power.synchronised else f"{left} at most"
        yield f"regenerated per cycle: {drawn}{burnt}"
    if power.reliability:
        yield sampled_text(power.reliability)
    if power.energy:
        yield f"battery: {show(power.energy.autonomy, 'h', 'time')} with all axes"


def sampled_text(found: Reliability) -> str:
    """The probability that no limit of the supply is exceeded, as a sentence without its point."""
    said = f"over tolerances no limit of the supply is exceeded with {likely(found.probability)}"
    error = f"{said} ± {100.0 * found.error:.2g} %, weakest: {sentence_case(found.weakest)}"
    return f"{error}; unknown: {', '.join(found.unknown)}" if found.unknown else error
