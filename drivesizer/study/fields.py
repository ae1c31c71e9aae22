"""Fields of a spec or a machine by name: their places, which there are, and their kinds of quantity."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Annotated, Any, get_args, get_origin

from pydantic import BaseModel

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.files.fields import Quantity
from drivesizer.files.yaml_source import Path_, YamlSource, field_name, overlay
from drivesizer.loads.kinds import AXES
from drivesizer.spec.machine import WHOLE, AxisFields, MachineFields, is_machine
from drivesizer.spec.messages import has_names, known_keys, models_at
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.robot_section import Either
from drivesizer.units import to_si

_STEP = re.compile(r"(\w+)((?:\[[1-9][0-9]{0,3}\])*)", re.ASCII)


def path_of(name: str, axes: Iterable[str] = ()) -> Path_ | None:
    """Path of a field's name, None where it is malformed: ``transmission[2].ratio`` counts from 1, as messages do."""
    longest_first, rest = sorted(axes, key=len, reverse=True), name
    path: list[str | int] = []
    while True:
        axis = next((one for one in longest_first if path and f"{rest}.".startswith(f"{one}.")), "")
        step = axis or rest.partition(".")[0]
        match = _STEP.fullmatch(step)
        if not axis and match is None:
            return None
        if axis or match is None:
            path.append(axis)
        else:  # a key and the indices behind it
            path += [match[1], *(int(index) - 1 for index in re.findall(r"[0-9]+", match[2]))]
        if step == rest:
            return tuple(path)
        rest = rest[len(step) + 1 :]


def unknown_field(spec: YamlSource, path: Path_) -> str:
    """Fault of a path: a field that a spec cannot have, or an entry of a list that this spec lacks."""
    data: Any = spec.data
    for n, step in enumerate(path):
        if isinstance(step, int):
            if not isinstance(data, list) or step >= len(data):
                found = len(data) if isinstance(data, list) else 0
                return f"entry {step + 1} does not exist, there are {found} in {spec.name}"
            data = data[step]
            continue
        known = _known_names(spec, path[:n])
        if known is not None and step not in known:
            hint = nearest(step, known) or (f"; expected one of {', '.join(known)}" if known else "")
            return f"{quoted(step)} is no {_place(path[:n], is_machine(spec))}{hint}"
        data = data.get(step) if isinstance(data, dict) else None
    return ""


def _place(path: Path_, machine: bool) -> str:
    """Kind of name that a place has.

    >>> _place((), False), _place(("load",), False), _place(("axes",), True)
    ('field of a spec', 'field of load', 'axis')
    """
    if machine and path == ("axes",):
        return "axis"
    return f"field of {field_name(path) or ('a machine' if machine else 'a spec')}"


def _known_names(spec: YamlSource, path: Path_) -> list[str] | None:
    """Names that a place may have; None where a user gives them."""
    if is_machine(spec):
        if not path:
            return list(dict.fromkeys((*MachineFields.model_fields, *RobotSpec.model_fields)))
        if path == ("axes",):  # joints need not be in the file
            return None if "robot" in spec.data else list(spec.data["axes"])
        if path[0] == "axes" and len(path) == 2:
            own = [name for name in RobotSpec.model_fields if name not in WHOLE]
            return list(dict.fromkeys((*AxisFields.model_fields, *own)))
    model, inner, data = _root(spec, path)
    return None if has_names(model, inner, data) else known_keys(model, inner, data)


def _root(spec: YamlSource, path: Path_) -> tuple[type[BaseModel], Path_, Any]:
    """The model that declares the fields at a path, the path in it, and the data that decide between its kinds."""
    data: Any = spec.data
    if is_machine(spec) and path[0] == "axes":
        own = (data.get("axes") or {}).get(path[1])
        path, data = path[2:], overlay(spec, path[:2], data, own if isinstance(own, dict) else {}).data
        if path and path[0] in AxisFields.model_fields:
            return AxisFields, path, data
    elif is_machine(spec) and path[0] in MachineFields.model_fields and path[0] not in RobotSpec.model_fields:
        return MachineFields, path, data
    of_case = path[:1] == ("cases",) and len(path) > 2  # which changes fields of the spec itself
    return RobotSpec, path[2:] if of_case else path, data


def kind_of(spec: YamlSource, path: Path_, value: Any) -> str:
    """The kind of quantity of a field."""
    model, path, data = _root(spec, path)
    named = bool(path) and has_names(model, path[:-1], data)  # of a group by names of the user's the values
    place = path[:-1] if named else path
    owners = models_at(model, place[:-1], data) if place else []
    fields = [m.model_fields[str(place[-1])] for m in owners if place[-1] in m.model_fields]
    marks = ((*get_args(f.annotation)[1:],) if named else (*f.metadata, f.annotation) for f in fields)
    found = [mark for some in marks for mark in _quantities(some)]
    if not found:
        return ""
    first = found[0]
    if isinstance(first, Either):
        return _either_kind(value, first.rotary, first.linear)
    if first.grade and str(value).rstrip().endswith("%"):
        return "dimensionless"
    if not first.rotary:
        return first.kind
    load = data.get("load") if isinstance(data, dict) else None
    kind = load.get("kind") if isinstance(load, dict) else None
    if kind is None and is_machine(spec):  # shared by axes of which each has its load
        return _either_kind(value, first.rotary, first.kind)
    return first.rotary if AXES.get(str(kind), "linear") == "rotary" else first.kind


def _either_kind(value: Any, rotary: str, linear: str) -> str:
    """Of two kinds the one that a value is of; the first where it is of neither."""
    for kind in (rotary, linear):
        try:
            to_si(value, kind)
        except InputError:
            continue
        return kind
    return rotary


def _quantities(marks: Sequence[Any]) -> list[Quantity | Either]:
    """Quantities in a field's metadata and type; lists of values are left out."""
    found: list[Quantity | Either] = [mark for mark in marks if isinstance(mark, Quantity | Either)]
    for mark in marks:
        if get_origin(mark) not in (None, list, dict, tuple) or get_origin(mark) is Annotated:
            inside = (*mark.__metadata__, mark.__origin__) if get_origin(mark) is Annotated else get_args(mark)
            found += _quantities(inside)
    return found
