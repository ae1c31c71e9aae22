"""Sections of a machine that its own checks take: supply, battery and the like, margins, surroundings and mission.

Of margins, surroundings and mission a field at the top of the file counts; one that only axes have is that of the axis
where it is strictest. What load cases change of surroundings and supply counts in these.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.several_axes.machine import MachineSpec

__all__ = ["shared_sections"]

_STATED = ("margins", "environment", "mission")  # of each field the largest is the strictest: hot, high, long
_CHANGED: dict[str, dict[str, Callable[..., float]]] = {  # by load cases: which of several values is the strictest
    "environment": {"ambient": max, "altitude": max},
    "supply": {
        "nominal": min, "min": min, "max": max, "resistance": max, "current": min, "power": min, "peak_current": min,
        "peak_time": min, "regeneration": min, "capacitance": min,
    },
}  # fmt: skip


def shared_sections(machine: MachineSpec, axes: Sequence[RobotSpec]) -> RobotSpec:
    """Sections that all axes share, as a spec with the load cases of the axes."""
    shared = axes[0].alone(
        supply=machine.supply,
        battery=machine.battery,
        equipment=list(machine.equipment),
        brake_resistor=machine.brake_resistor,
        budget=None,
        **{name: _stated(getattr(machine, name), [getattr(axis, name) for axis in axes]) for name in _STATED},
    )
    names = dict.fromkeys(name for axis in axes for name, _ in axis.load_cases[1:])
    return shared.with_cases((name, _sections_in_case(shared, name, axes)) for name in names)


def _stated(own: Any, of_axes: Sequence[Any]) -> Any:
    """A section with the fields of the machine, and of those that it does not have the strictest of the axes."""
    given = [section for section in of_axes if section is not None]
    if own is None and not given:
        return None
    whole = given[0] if own is None else own
    names = {name for section in given for name in section.model_fields_set}
    lacking = names - (own.model_fields_set if own is not None else set())
    found = {name: [getattr(one, name) for one in given if name in one.model_fields_set] for name in sorted(lacking)}
    return whole.model_copy(update={name: max(values) for name, values in found.items()})


def _sections_in_case(shared: RobotSpec, name: str, axes: Sequence[RobotSpec]) -> RobotSpec:
    """The shared sections in a load case, with what that changes of those of any axis."""
    pairs = [(axis, case) for axis in axes for own, case in axis.load_cases[1:] if own == name]
    sections = {}
    for section, strictest in _CHANGED.items():
        both = [(getattr(axis, section), getattr(case, section)) for axis, case in pairs]
        moved = {field: [getattr(b, field) for a, b in both if getattr(a, field) != getattr(b, field)]
                 for field in strictest}  # fmt: skip
        update = {field: strictest[field](values) for field, values in moved.items() if values}
        sections[section] = getattr(shared, section).model_copy(update=update)
    return shared.alone(**sections)
