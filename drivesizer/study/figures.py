"""Fields of a spec by name with their kinds of quantity, and figures that expressions name, of a spec or its drives."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from graphlib import CycleError, TopologicalSorter
from math import nan
from typing import Annotated, Any, NamedTuple, get_args, get_origin

from pydantic import BaseModel

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.files.arithmetic import Expression, expression
from drivesizer.files.fields import Quantity
from drivesizer.files.yaml_source import Path_, YamlSource, changed, field_name, overlay, value_at
from drivesizer.loads import AXES
from drivesizer.spec.machine import WHOLE, AxisFields, MachineFields, is_machine
from drivesizer.spec.messages import has_names, known_keys, models_at
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.robot_section import Either
from drivesizer.spec.tolerances import has_tolerance, tolerance
from drivesizer.units import KINDS, to_si

# -- Fields of a spec or a machine by name: their places, which there are, and their kinds of quantity.

_STEP = re.compile(r"(\w+)((?:\[[1-9][0-9]{0,3}\])*)", re.ASCII)


def path_of(name: str, axes: Iterable[str] = ()) -> Path_ | None:
    """Path of a field's name, None where it is malformed: ``transmission[2].ratio`` counts from 1, as messages do."""
    longest_first, rest = sorted(axes, key=len, reverse=True), name
    path: list[str | int] = []
    while True:
        axis = next((axis_name for axis_name in longest_first if path and f"{rest}.".startswith(f"{axis_name}.")), "")
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
                count = len(data) if isinstance(data, list) else 0
                return f"entry {step + 1} does not exist, there are {count} in {spec.name}"
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
    quantities = [mark for field_marks in marks for mark in _quantities(field_marks)]
    if not quantities:
        return ""
    first = quantities[0]
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
    quantities: list[Quantity | Either] = [mark for mark in marks if isinstance(mark, Quantity | Either)]
    for mark in marks:
        if get_origin(mark) not in (None, list, dict, tuple) or get_origin(mark) is Annotated:
            inside = (*mark.__metadata__, mark.__origin__) if get_origin(mark) is Annotated else get_args(mark)
            quantities += _quantities(inside)
    return quantities


# -- Figures by name.


class Named(NamedTuple):
    """A figure that expressions may name beside those of the spec: of all drives of the machine, or of the machine."""

    column: str  # of the table
    kind: str
    unit: str  # of the trade
    title: str
    by: str = ""  # the objective that makes a drive good in it; empty where no choice of a drive does


NAMED = {
    "mass": Named("machine_mass_kg", "mass", "g", "mass of all drives", "mass"),
    "price": Named("machine_price_EUR", "price", "EUR", "price of all drives", "price"),
    "energy": Named("energy_J", "energy", "J", "energy per cycle", "energy"),
    "margin": Named("smallest_margin", "dimensionless", "%", "smallest margin", "margin"),
    "time": Named("cycle_time_s", "time", "s", "time of a cycle"),
    "autonomy": Named("autonomy_s", "time", "h", "autonomy", "energy"),
    "range": Named("range_m", "length", "km", "range", "energy"),
    "joule_heat": Named("joule_heat_W", "power", "W", "heat of a motor's winding", "joule_heat"),
    "peak_current": Named("peak_current_A", "current", "A", "peak current of a motor", "peak_current"),
    "moved_mass": Named("moved_mass_kg", "mass", "kg", "mass that is moved"),
}
"""By their names in expressions."""
OF_BATTERY = ("autonomy", "range")


@dataclass(frozen=True)
class SpecFigures:
    """The figures of a spec by name, in SI."""

    source: YamlSource

    @cached_property
    def _axes(self) -> tuple[str, ...]:
        axes = self.source.data.get("axes") if is_machine(self.source) else None
        return tuple(axes) if isinstance(axes, dict) else ()

    @cached_property
    def _known(self) -> dict[str, tuple[Path_, str]]:
        return {}

    def path(self, name: str) -> Path_:
        """Path of a field by its name; an InputError where no spec has one."""
        path = path_of(name, self._axes)
        if path is None or len(path) < 2:
            hint = nearest(name, NAMED) or f"; expected one of {', '.join(NAMED)}, or of the spec, e.g. load.mass"
            raise InputError(f"{quoted(name)} is no figure{hint}")
        if wrong := unknown_field(self.source, path):
            raise InputError(f"{quoted(name)}: {wrong}")
        return path

    def place(self, name: str, *, required: bool = True) -> tuple[Path_, str]:
        """Path and kind of quantity of a figure; an InputError where there is none of that name, or it is not given."""
        if name not in self._known:
            path = self.path(name)
            value = value_at(self.source.data, path)
            follows = isinstance(value, dict) and "expression" in value
            if (isinstance(value, list | dict) and not follows) or (value is None and required):
                raise InputError(f"{quoted(name)} is given as no figure in {self.source.name}; expected one that is")
            self._known[name] = path, kind_of(self.source, path, value)
        return self._known[name]

    def value(self, name: str, data: Any) -> float:
        """A figure of a variant, of its data; NaN where it has none."""
        path, kind = self.place(name)
        figure = value_at(data, path)
        if isinstance(figure, str) and has_tolerance(figure):
            figure = tolerance(figure).nominal
        try:
            return to_si(figure, kind or "dimensionless")
        except InputError:
            return nan


@dataclass(frozen=True, slots=True)
class Derived:
    """A field of the spec that follows from others."""

    name: str
    path: Path_
    kind: str
    text: str  # the expression

    def entered(self, data: Any, figures: SpecFigures) -> Any:
        """Data with the field in it, as text in the SI unit of its kind."""
        value = expression(self.text).value(lambda name: figures.value(name, data))
        if value != value:
            raise InputError(f"{self.name}: {self.text} has no value with these figures")
        return changed(data, self.path, f"{value:.12g} {KINDS[self.kind].si}".removesuffix(" 1"))


def derived_fields(
    figures: SpecFigures, texts: Mapping[str, str], error: Callable[[str, object], InputError]
) -> tuple[Derived, ...]:
    """Fields that follow from others by their expressions, in an order in which each has what it needs."""
    fields: dict[str, tuple[Derived, Expression]] = {}
    for name, text in texts.items():
        try:
            path, kind = figures.place(name, required=False)
            if not kind:
                raise InputError("is no quantity; expected a field that is one")
            fields[name] = Derived(name, path, kind, text), expression(text)
            for other in fields[name][1].names:
                figures.place(other)
        except InputError as fault:
            raise error(name, fault) from None
    needs = {name: [other for other in formula.names if other in fields] for name, (_, formula) in fields.items()}
    try:
        order = list(TopologicalSorter(needs).static_order())
    except CycleError as ring:
        raise error(ring.args[1][0], f"follows from itself, by way of {', '.join(ring.args[1][1:])}") from None
    return tuple(fields[name][0] for name in order)


def row_figures(heads: Sequence[str], row: Sequence[Any], of_spec: Callable[[str], float]) -> Callable[[str], float]:
    """The figures of a variant's row by their names in expressions; NaN unknown."""
    cells = dict(zip(heads, row, strict=True))

    def figure(name: str) -> float:
        column = NAMED[name].column if name in NAMED else name
        if column not in cells:
            return of_spec(name)
        value = cells[column]
        return nan if value is None or isinstance(value, str) else float(value)

    return figure


def kind_of_figure(name: str, figures: SpecFigures) -> str:
    """The kind of quantity of a figure."""
    return NAMED[name].kind if name in NAMED else figures.place(name)[1]
