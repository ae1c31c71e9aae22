"""Figures that expressions name: those of a variant's spec, and those of the drives that were found for it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from graphlib import CycleError, TopologicalSorter
from math import nan
from typing import Any, NamedTuple

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.files.arithmetic import Expression, expression
from drivesizer.files.yaml_source import Path_, YamlSource, changed, value_at
from drivesizer.spec.machine import is_machine
from drivesizer.spec.tolerances import has_tolerance, tolerance
from drivesizer.study.fields import kind_of, path_of, unknown_field
from drivesizer.units import KINDS, to_si


class Named(NamedTuple):
    """A figure that expressions may name beside those of the spec: of all drives of the machine, or of the machine."""

    column: str  # of the table
    kind: str
    unit: str  # of the trade
    title: str
    by: str = ""  # the objective that makes a drive good in it; empty where no choice of a drive does


NAMED = {
    "mass": Named("machine_mass_kg", "mass", "kg", "mass of all drives", "mass"),
    "price": Named("machine_price_EUR", "price", "EUR", "price of all drives", "price"),
    "energy": Named("energy_J", "energy", "kJ", "energy per cycle", "energy"),
    "margin": Named("smallest_margin", "dimensionless", "%", "smallest margin", "margin"),
    "time": Named("cycle_time_s", "time", "s", "time of a cycle"),
    "autonomy": Named("autonomy_s", "time", "h", "autonomy", "energy"),
    "range": Named("range_m", "length", "km", "range", "energy"),
    "joule_heat": Named("joule_heat_W", "power", "W", "heat of a motor's winding", "joule_heat"),
    "peak_current": Named("peak_current_A", "current", "A", "peak current of a motor", "peak_current"),
    "moved_mass": Named("moved_mass_kg", "mass", "kg", "mass that is moved"),
}
"""By their names in expressions."""


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

    def place(self, name: str, *, given: bool = True) -> tuple[Path_, str]:
        """Path and kind of quantity of a figure; an InputError where there is none of that name, or it is not given."""
        if name not in self._known:
            path = self.path(name)
            found = value_at(self.source.data, path)
            follows = isinstance(found, dict) and "expression" in found
            if (isinstance(found, list | dict) and not follows) or (found is None and given):
                raise InputError(f"{quoted(name)} is given as no figure in {self.source.name}; expected one that is")
            self._known[name] = path, kind_of(self.source, path, found)
        return self._known[name]

    def value(self, name: str, data: Any) -> float:
        """A figure of a variant, of its data; NaN where it has none."""
        path, kind = self.place(name)
        given = value_at(data, path)
        if isinstance(given, str) and has_tolerance(given):
            given = tolerance(given).nominal
        try:
            return to_si(given, kind or "dimensionless")
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
    figures: SpecFigures, given: Mapping[str, str], error: Callable[[str, object], InputError]
) -> tuple[Derived, ...]:
    """Fields that follow from others by their expressions, in an order in which each has what it needs."""
    found: dict[str, tuple[Derived, Expression]] = {}
    for name, text in given.items():
        try:
            path, kind = figures.place(name, given=False)
            if not kind:
                raise InputError("is no quantity; expected a field that is one")
            found[name] = Derived(name, path, kind, text), expression(text)
            for other in found[name][1].names:
                figures.place(other)
        except InputError as one:
            raise error(name, one) from None
    needs = {name: [other for other in one.names if other in found] for name, (_, one) in found.items()}
    try:
        order = list(TopologicalSorter(needs).static_order())
    except CycleError as ring:
        raise error(ring.args[1][0], f"follows from itself, by way of {', '.join(ring.args[1][1:])}") from None
    return tuple(found[name][0] for name in order)


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


def columns_for(names: Iterable[str], heads: Sequence[str]) -> tuple[str, ...]:
    """Further columns of a table that some names of expressions need."""
    return tuple(dict.fromkeys(name for name in names if name in NAMED and NAMED[name].column not in heads))


def kind_of_figure(name: str, figures: SpecFigures) -> str:
    """The kind of quantity of a figure."""
    return NAMED[name].kind if name in NAMED else figures.place(name)[1]
