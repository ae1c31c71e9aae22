"""Axes of a study: a field of the spec and its values.

A value is written into the spec as text with its unit and read by the spec's own strict reader. So every variant can be
repeated by hand, and the spec alone decides which values a field accepts.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.files.yaml_source import Path_, YamlSource
from drivesizer.spec.several_axes.any_spec import is_machine
from drivesizer.spec.tolerance_text import has_tolerance, tolerance
from drivesizer.study.fields import kind_of, path_of, unknown_field
from drivesizer.units import number, scale, to_si

__all__ = ["Axis", "Place", "axes_of", "once"]

_RANGE = "e.g. {from: 30 kg, to: 60 kg, steps: 4}"
_DIGITS = 12  # of a value inside a range, to hide rounding errors


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """A field and its values: a list, or a range of which a Latin hypercube takes any."""

    name: str  # as in a message: load.mass, transmission[2].ratio
    path: Path_
    kind: str = ""  # of its quantity; empty where it is none
    unit: str = ""  # of its figures in tables, as the study spells it
    values: tuple[Any, ...] = ()  # as they go into the spec
    span: tuple[float, float] | None = None  # of a range, in that unit

    @property
    def head(self) -> str:
        """Name and unit, as the head of a column."""
        return f"{self.name} ({self.unit})" if self.unit else self.name

    def text(self, figure: float) -> str:
        """A figure as it goes into the spec."""
        return f"{figure!r} {self.unit}".rstrip()

    def table_value(self, value: Any) -> Any:
        """A value as tables show it: a number in the axis's unit, or text."""
        if not self.kind:
            return value if isinstance(value, int) and not isinstance(value, bool) else _text(value)
        return _figure(value, self.kind, self.unit)

    @property
    def stepped(self) -> bool:
        """Whether it is a range with steps."""
        return self.span is not None and bool(self.values)

    def at(self, place: int, parts: int) -> Any:
        """The value at a place, counted in parts of a step where it is a range with steps."""
        if not self.stepped:
            return self.values[place]
        whole, rest = divmod(place, parts)
        if not rest:
            return self.values[whole]
        low, high = self.span or (0.0, 0.0)
        return self.text(_between(low, high, place, (len(self.values) - 1) * parts))

    def sample(self, share: float) -> Any:
        """The value at a share of the range or the list, 0 to below 1."""
        if self.span is None:
            return self.values[min(int(share * len(self.values)), len(self.values) - 1)]
        low, high = self.span
        return self.text(float(f"{low + share * (high - low):.{_DIGITS}g}"))


def _between(low: float, high: float, place: int, places: int) -> float:
    """The figure of a step; to the same bits with twice as many steps, as twice is exact."""
    return float(f"{low + (high - low) * place / places:.{_DIGITS}g}")


def _text(value: Any) -> str:
    if isinstance(value, list) and not any(isinstance(one, dict | list) for one in value):
        return " + ".join(map(str, value))
    if value is None or isinstance(value, str):
        return value or ""
    return json.dumps(value, ensure_ascii=False)


def _figure(value: Any, kind: str, unit: str) -> float:
    """A quantity in one of its kind's units; exactly as written where it has that unit."""
    figure, own = number(str(value))
    if own == unit:
        return figure
    factor, offset = scale(unit, kind) if unit else (1.0, 0.0)
    return float(f"{float((to_si(value, kind) - offset) / factor):.{_DIGITS}g}")


def axes_of(source: YamlSource, spec: YamlSource, vary: dict[str, Any], grid: bool) -> tuple[Axis, ...]:
    """Axes of a study's section ``vary``."""
    return tuple(_axis(Place(source, ("vary", name)), spec, name, given, grid) for name, given in vary.items())


@dataclass(frozen=True, slots=True)
class Place:
    """Place in the study, for messages."""

    source: YamlSource
    path: Path_

    def error(self, text: object, *further: str | int) -> InputError:
        """Error at this place, to be raised."""
        return InputError(f"{self.source.where((*self.path, *further))}: {text}")


def once(place: Place, given: Sequence[Any]) -> None:
    """Refuse a list that has an entry twice."""
    seen: set[str] = set()
    for n, value in enumerate(given):
        if repr(value) in seen:
            raise place.error(f"{quoted(value)} is given twice", n)
        seen.add(repr(value))


def _axis(place: Place, spec: YamlSource, name: str, given: Any, grid: bool) -> Axis:
    axes = spec.data.get("axes") or {} if is_machine(spec) else {}
    path = path_of(name, axes)
    if path is None:
        raise place.error(f"is no field; expected one of {spec.name}, e.g. load.mass or transmission[2].ratio")
    if ("select", "catalogs") in pairwise(path):
        raise place.error("expected them in the study's own list, catalogs")
    if wrong := unknown_field(spec, path):
        raise place.error(wrong)
    kind = kind_of(spec, path, _first(given))
    if isinstance(given, dict):
        return _range(place, Axis(name=name, path=path, kind=kind), given, grid)
    if not isinstance(given, list) or not given:
        raise place.error(f"expected a list of values, e.g. [24 V, 48 V], or a range, {_RANGE}")
    for n, value in enumerate(given):
        if kind:
            _checked(place, value, kind, n)
    once(place, given)
    if not kind or any(has_tolerance(str(value)) for value in given):  # shown as written
        return Axis(name=name, path=path, values=tuple(given))
    return Axis(name=name, path=path, kind=kind, unit=number(str(given[0]))[1], values=tuple(given))


def _first(given: Any) -> Any:
    """The first value of a list or range, without its tolerance."""
    value = given.get("from") if isinstance(given, dict) else given[0] if isinstance(given, list) and given else given
    try:
        return tolerance(value).nominal if isinstance(value, str) and has_tolerance(value) else value
    except InputError:  # refused at its place
        return value


def _checked(place: Place, value: Any, kind: str, *further: str | int) -> float:
    """A quantity in SI, the nominal one where it has a tolerance; an error at its place where it is none."""
    try:
        return to_si(tolerance(value).nominal if isinstance(value, str) and has_tolerance(value) else value, kind)
    except InputError as error:
        raise place.error(error, *further) from None


def _range(place: Place, axis: Axis, given: dict[str, Any], grid: bool) -> Axis:
    known = ("from", "to", "steps") if grid else ("from", "to")
    for key in given:
        if key == "steps" and not grid:
            raise place.error("a Latin hypercube divides the range itself; leave steps out", key)
        if key not in known:
            raise place.error(f"unknown key; expected {', '.join(known)}{nearest(key, known)}", key)
    for key in known:
        if key not in given:
            raise place.error(f"{key} is missing; expected a range, {_RANGE}")
    if not axis.kind:
        raise place.error("is no quantity; expected a list of values")
    for key in ("from", "to"):
        if has_tolerance(str(given[key])):
            raise place.error(f"{quoted(given[key])} has a tolerance; expected a plain quantity, {_RANGE}", key)
    low, high = (_checked(place, given[key], axis.kind, key) for key in ("from", "to"))
    if not low < high:
        raise place.error(f"{quoted(given['from'])} is not below {quoted(given['to'])}; expected from below to")
    unit = number(str(given["from"]))[1]
    span = number(str(given["from"]))[0], _figure(given["to"], axis.kind, unit)
    found = Axis(name=axis.name, path=axis.path, kind=axis.kind, unit=unit, span=span)
    return _stepped(place, found, given["steps"]) if grid else found


def _stepped(place: Place, axis: Axis, steps: Any) -> Axis:
    """The axis with the values of its steps, both ends included."""
    if isinstance(steps, bool) or not isinstance(steps, int) or steps < 2:
        raise place.error(f"{quoted(steps)} is not a whole number from 2; both ends are steps", "steps")
    if steps > 100_000:
        raise place.error(f"{quoted(steps)} is too many; expected at most 100000", "steps")
    low, high = axis.span or (0.0, 0.0)
    figures = [_between(low, high, n, steps - 1) for n in range(steps - 1)] + [high]
    return replace(axis, values=tuple(axis.text(figure) for figure in figures))
