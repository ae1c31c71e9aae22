"""study.yaml as a plan: its schema, axes with their values, the number of variants, and the variant of each number."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import accumulate, pairwise
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Discriminator, Field, Tag, ValidationError

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.files.arithmetic import Expression, Limit, expression, limit, names_in
from drivesizer.files.fields import Names, Section, exactly_one
from drivesizer.files.text import missing
from drivesizer.files.yaml_source import Path_, YamlSource, read
from drivesizer.results.drive_set import DriveSet
from drivesizer.search.ranking import objective_of, title_of
from drivesizer.spec.machine import is_machine, read_machine
from drivesizer.spec.messages import explained
from drivesizer.spec.tolerances import has_tolerance, tolerance
from drivesizer.study.figures import (
    OF_BATTERY,
    Derived,
    SpecFigures,
    derived_fields,
    kind_of,
    kind_of_figure,
    path_of,
    unknown_field,
)
from drivesizer.units import number, scale, to_si

# -- The schema of study.yaml.
#
# ``axes`` reads the varied fields, because the spec defines a field's kind of quantity.


class Hypercube(Section):
    """A Latin hypercube: every field's range in as many equal parts as there are samples, one sample in each."""

    latin_hypercube: Annotated[int, Field(ge=1)] = Field(description="how many samples")
    seed: Annotated[int, Field(ge=0)] = Field(
        default=0, description="of the random numbers; the same seed gives the same samples"
    )


Sampling = Annotated[
    Annotated[Literal["grid"], Tag("grid")] | Annotated[Hypercube, Tag("latin_hypercube")],
    Discriminator(lambda value: "latin_hypercube" if isinstance(value, dict) else "grid"),
]


def _several(example: str) -> BeforeValidator:
    """A list with at least one entry; a single text is refused."""

    def checked(value: object) -> object:
        if not isinstance(value, list) or not value:
            raise ValueError(f"is no list with entries; expected e.g. {example}")
        return value

    return BeforeValidator(checked)


def _fields(value: object) -> object:
    if not isinstance(value, dict) or not value:
        raise ValueError("is no group of fields; expected e.g. load.mass: [30 kg, 45 kg]")
    return value


class Best(Section):
    """The best of the variants that differ in some fields alone."""

    over: Annotated[list[str], _several("[load.wheel_diameter]")] = Field(description="fields that are chosen")
    by: Annotated[str, Field(min_length=1)] = Field(description="what is made least: mass, price, or an expression")


FurtherName = Literal["time", "autonomy", "range", "joule_heat", "peak_current", "moved_mass", "unknown_checks"]


class StudyFile(Section):
    """A study.yaml: which variants of which spec are sized."""

    spec: str | None = Field(default=None, min_length=1, description="the robot.yaml or machine that is varied")
    specs: Annotated[list[str], _several("[light.yaml, heavy.yaml]")] | None = Field(
        default=None, description="several specs instead, unchanged"
    )
    axis: str | None = Field(
        default=None, min_length=1, description="of a machine the one that is tabled; the whole machine if not given"
    )
    vary: Annotated[dict[str, Any], BeforeValidator(_fields)] | None = Field(
        default=None, description="by field, such as load.mass: a range or a list"
    )
    sampling: Sampling = Field(default="grid", description="every combination, or a Latin hypercube")
    refine: Annotated[int, Field(ge=0, le=6)] = Field(
        default=0, description="how often the steps of ranges are halved where the best drive changes"
    )
    catalogs: Annotated[list[Names], _several("[[maxon], [maxon, faulhaber]]")] | None = Field(
        default=None, description="each entry in place of the spec's catalogues"
    )
    objectives: Annotated[list[str], _several("[mass, price]")] | None = Field(
        default=None, description="each in place of the spec's, such as mass=2,price=1"
    )
    top: Annotated[int, Field(ge=1, le=100)] = Field(default=1, description="how many drives of each variant")
    derive: dict[str, str] = Field(default_factory=dict, description="fields that follow from others, by expressions")
    columns: Annotated[list[FurtherName], _several("[autonomy, range]")] | None = Field(
        default=None, description="further figures of the machine"
    )
    require: Annotated[list[str], _several("[autonomy >= 3 h]")] | None = Field(
        default=None, description="limits beside all checks: a drive beyond one fails"
    )
    best: Best | None = Field(default=None, description="the best variant over some fields, for each value of the rest")
    front: Annotated[list[str], Field(min_length=2, max_length=4)] | None = Field(
        default=None, description="figures of which no variant of the front is worse in all"
    )
    influence: Annotated[list[str], _several("[mass, price]")] | None = Field(
        default=None, description="figures of which it is said what field decides them"
    )

    def _contradictions(self) -> Iterator[str]:
        yield from exactly_one(self, "spec", "specs")
        if self.specs and self.vary:
            yield "vary: expected spec, the one that is varied, not specs"
        if isinstance(self.sampling, Hypercube) and not self.vary:
            yield "sampling: expected fields under vary that the Latin hypercube samples"
        if isinstance(self.sampling, Hypercube) and self.refine:
            yield "refine: a Latin hypercube has no steps to halve; expected sampling: grid, or no refine"


# -- Axes of a study: a field of the spec and its values.
#
# A value is written into the spec as text with its unit and read by the spec's own strict reader. So every variant
# can be repeated by hand, and the spec alone decides which values a field accepts.


_RANGE = "e.g. {from: 30 kg, to: 60 kg, steps: 4}"
_DIGITS = 12  # of a value inside a range, to hide rounding errors


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """A field and its values: a list, or a range of which a Latin hypercube takes any."""

    name: str  # as in a message: load.mass, transmission[2].ratio
    path: Path_  # of several fields that vary together that of the first
    also: tuple[Path_, ...] = ()  # of the others
    kind: str = ""  # of its quantity; empty where it is none
    unit: str = ""  # of its figures in tables, as the study spells it
    values: tuple[Any, ...] = ()  # as they go into the spec; of several fields together a list of each
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

    def changes(self, value: Any) -> Iterator[tuple[Path_, Any]]:
        """Fields with their values in a variant."""
        yield from zip((self.path, *self.also), value, strict=True) if self.also else [(self.path, value)]

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

    @property
    def continuous(self) -> bool:
        """Whether it may be any figure of its range."""
        return not self.values

    @property
    def bounds(self) -> tuple[float, float]:
        """Ends of its coordinate: of the figure itself, else of the place in its list."""
        return (self.span or (0.0, 0.0)) if self.continuous else (0.0, len(self.values) - 1.0)

    def value(self, coordinate: float) -> Any:
        """The value at a coordinate, as it goes into the spec; of a range to five digits."""
        if not self.continuous:
            return self.values[round(coordinate)]
        low, high = self.bounds
        return f"{min(max(float(f'{coordinate:.5g}'), low), high):.12g} {self.unit}".rstrip()

    def coordinate(self, value: Any) -> float:
        """The coordinate of a value."""
        return number(value)[0] if self.continuous else float(self.values.index(value))

    def between(self, low: Any, high: Any) -> Axis:
        """The field with a range between two quantities, in the unit of the first."""
        first, unit = number(str(low))
        return replace(self, unit=unit, span=(first, _figure(high, self.kind, unit)))


def _between(low: float, high: float, place: int, places: int) -> float:
    """The figure of a step; to the same bits with twice as many steps, as twice is exact."""
    return float(f"{low + (high - low) * place / places:.{_DIGITS}g}")


def _text(value: Any) -> str:
    if isinstance(value, tuple):  # of fields that vary together
        return ", ".join(map(_text, value))
    if isinstance(value, list) and not any(isinstance(entry, dict | list) for entry in value):
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


@dataclass(frozen=True, slots=True)
class Place:
    """Place in the study, for messages."""

    source: YamlSource
    path: Path_

    def error(self, text: object, *further: str | int) -> InputError:
        """Error at this place, to be raised."""
        return InputError(f"{self.source.where((*self.path, *further))}: {text}")


def once(place: Place, values: Sequence[Any]) -> None:
    """Refuse a list that has an entry twice."""
    seen: set[str] = set()
    for n, value in enumerate(values):
        if repr(value) in seen:
            raise place.error(f"{quoted(value)} is given twice", n)
        seen.add(repr(value))


def axis_of(place: Place, spec: YamlSource, name: str, values: Any, grid: bool) -> Axis:
    """A field of a spec with its values: those of a list, or a range of which a grid takes steps."""
    if "," in name:
        return _together(place, spec, [part.strip() for part in name.split(",")], values)
    axes = spec.data.get("axes") or {} if is_machine(spec) else {}
    path = path_of(name, axes)
    if path is None:
        raise place.error(f"is no field; expected one of {spec.name}, e.g. load.mass or transmission[2].ratio")
    if ("select", "catalogs") in pairwise(path):
        raise place.error("expected them in the study's own list, catalogs")
    if wrong := unknown_field(spec, path):
        raise place.error(wrong)
    first = (
        values.get("from") if isinstance(values, dict) else values[0] if isinstance(values, list) and values else values
    )
    kind = kind_of(spec, path, _nominal(first))
    if isinstance(values, list) and any(isinstance(value, dict | list) for value in values):  # bodies, not figures
        kind = ""
    if isinstance(values, dict):
        return _range(place, Axis(name=name, path=path, kind=kind), values, grid)
    if not isinstance(values, list) or not values:
        raise place.error(f"expected a list of values, e.g. [24 V, 48 V], or a range, {_RANGE}")
    for n, value in enumerate(values):
        if kind:
            _checked(place, value, kind, n)
    once(place, values)
    if not kind or any(has_tolerance(str(value)) for value in values):  # shown as written
        return Axis(name=name, path=path, values=tuple(values))
    return Axis(name=name, path=path, kind=kind, unit=number(str(values[0]))[1], values=tuple(values))


def _together(place: Place, spec: YamlSource, names: Sequence[str], values: Any) -> Axis:
    """Several fields that vary together: each value is a list with one for each of them."""
    if not isinstance(values, list) or not all(isinstance(row, list) and len(row) == len(names) for row in values):
        example = f"[{', '.join(f'value of {name}' for name in names)}]"
        raise place.error(f"expected a list of lists, each {example}")
    once(place, values)
    once_each = ([*{repr(row[n]): row[n] for row in values}.values()] for n in range(len(names)))
    axes = [axis_of(place, spec, name, column, True) for name, column in zip(names, once_each, strict=True)]
    return Axis(
        name=", ".join(names),
        path=axes[0].path,
        also=tuple(axis.path for axis in axes[1:]),
        values=tuple(map(tuple, values)),
    )


def _nominal(value: Any) -> Any:
    """A value without its tolerance; one that is refused at its place as it is."""
    try:
        return tolerance(value).nominal if isinstance(value, str) and has_tolerance(value) else value
    except InputError:
        return value


def _checked(place: Place, value: Any, kind: str, *further: str | int) -> float:
    """A quantity in SI, the nominal one where it has a tolerance; an error at its place where it is none."""
    try:
        return to_si(tolerance(value).nominal if isinstance(value, str) and has_tolerance(value) else value, kind)
    except InputError as error:
        raise place.error(error, *further) from None


def _range(place: Place, axis: Axis, span: dict[str, Any], grid: bool) -> Axis:
    known = ("from", "to", "steps") if grid else ("from", "to")
    for key in span:
        if key == "steps" and not grid:
            raise place.error("a Latin hypercube divides the range itself; leave steps out", key)
        if key not in known:
            raise place.error(f"unknown key; expected {', '.join(known)}{nearest(key, known)}", key)
    for key in known:
        if key not in span:
            raise place.error(f"{key} is missing; expected a range, {_RANGE}")
    if not axis.kind:
        raise place.error("is no quantity; expected a list of values")
    for key in ("from", "to"):
        if has_tolerance(str(span[key])):
            raise place.error(f"{quoted(span[key])} has a tolerance; expected a plain quantity, {_RANGE}", key)
    low, high = (_checked(place, span[key], axis.kind, key) for key in ("from", "to"))
    if not low < high:
        raise place.error(f"{quoted(span['from'])} is not below {quoted(span['to'])}; expected from below to")
    axis = axis.between(span["from"], span["to"])
    if not grid or axis.span is None:
        return axis
    steps = span["steps"]  # both ends included
    if isinstance(steps, bool) or not isinstance(steps, int) or steps < 2:
        raise place.error(f"{quoted(steps)} is not a whole number from 2; both ends are steps", "steps")
    if steps > 100_000:
        raise place.error(f"{quoted(steps)} is too many; expected at most 100000", "steps")
    figures = [_between(*axis.span, n, steps - 1) for n in range(steps - 1)] + [axis.span[1]]
    return replace(axis, values=tuple(axis.text(figure) for figure in figures))


# -- Subject of a study of machines: one axis of them, or the whole machine with the names of its axes.


def machine_job(source: YamlSource, study: StudyFile, specs: Sequence[YamlSource]) -> dict[str, Any]:
    """Fields of a study's job that are of machines."""
    names = study.specs or [study.spec or ""]
    several = [  # or of a robot's joints; a machine of a single axis is that spec
        is_machine(spec) and ("robot" in spec.data or len(spec.data["axes"] or ()) != 1) for spec in specs
    ]
    if any(several) and not all(several):
        odd = several.index(not several[0])
        kinds = ["the spec of one axis", "a machine of several axes"]
        text = f"is {kinds[several[odd]]}, and the first is {kinds[several[0]]}; expected specs of one kind"
        raise Place(source, ("specs", odd)).error(f"{quoted(names[odd])} {text}")
    if study.axis is not None:
        place = Place(source, ("axis",))
        for name, spec in zip(names, specs, strict=True):
            if not is_machine(spec):
                raise place.error(f"{quoted(name)} is a spec of one axis; leave axis out")
            known = list(spec.data.get("axes") or ())
            if study.axis not in known and "robot" in spec.data:
                known = _axes(spec)
            if study.axis not in known:
                hint = nearest(study.axis, known) or f"; expected one of {', '.join(known)}"
                raise place.error(f"there is no axis {quoted(study.axis)}{hint}")
        return {"machine": several[0], "axis": study.axis}
    if not several[0]:
        return {}
    if study.top > 1:
        text = "a machine has one choice of drives; expected 1, or axis: NAME for the drives of one"
        raise Place(source, ("top",)).error(f"{quoted(study.top)}: {text}")
    members = dict.fromkeys(name for spec in specs for name in _axes(spec))
    return {"machine": True, "members": tuple(members)}


def _axes(spec: YamlSource) -> list[str]:
    """Names of the axes, with those of a robot's joints that move."""
    if "robot" not in spec.data:
        return list(spec.data["axes"] or ())
    from drivesizer.multi_axis.several import with_joints  # what computes joints is loaded where there are any

    machine, _ = with_joints(read_machine(spec))
    return [axis.name for axis in machine.axes]


# -- A study as a plan: the number of its variants, and the variant of each number.
#
# The last of sampled fields, catalogues and objectives changes fastest. No list of variants is ever made: a grid's
# variant follows from its number, a Latin hypercube's from its row of shares. Only the points that refinement adds
# (``refine``) are a list: each round of them follows the variants before it.


Places = tuple[int, ...]  # of a point on each axis; of ranges counted in the smallest parts of their steps
MOST, MOST_IN_CHUNKS = 10_000_000, 100_000_000  # variants of a study in one table, and in many


class Variant(NamedTuple):
    """One sizing of a study."""

    number: int  # from 1
    spec: int  # which of the specs
    values: tuple[Any, ...]  # of each axis, as they go into the spec
    catalogs: int  # which entry of the study's catalogues
    objective: int
    head: list[Any]  # first cells of its row: number, spec, values and catalogues


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """Data that every process needs to compute variants: a few kilobytes, plain types."""

    specs: tuple[tuple[str, str], ...]  # path and text of each
    axes: tuple[Axis, ...]
    catalogs: tuple[tuple[str, ...] | None, ...]  # None: the spec's own
    objectives: tuple[str | None, ...]
    top: int
    machine: bool = False  # whether the specs are machines of several axes
    axis: str | None = None  # of a machine that is tabled; None: the whole machine
    members: tuple[str, ...] = ()  # axes of a machine that is tabled as a whole
    derived: tuple[Derived, ...] = ()  # fields that follow from others
    columns: tuple[str, ...] = ()  # further figures of the machine
    require: tuple[Limit, ...] = ()  # beyond which a drive fails
    pareto: tuple[str, ...] = ()  # objectives of which each variant has the drives of the front too
    merit: Callable[[DriveSet], float] | None = None  # what a drive is judged by beside its figures, less is better

    @property
    def sent(self) -> Job:
        """The job for other processes: a variant brings its values, so that no axis need bring all of its own."""
        return replace(self, axes=tuple(replace(axis, values=()) for axis in self.axes))


class Answers(NamedTuple):
    """Tables that a study makes of all its rows, each where it is wanted."""

    over: tuple[str, ...] = ()  # fields over which the best is taken
    by: Expression | None = None  # what it is the best by
    front: tuple[Expression, ...] = ()
    influence: tuple[Expression, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the figures in their expressions."""
        return tuple(names_in((*((self.by,) if self.by else ()), *self.front, *self.influence)))


NO_ANSWERS = Answers()


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """A study, read and checked."""

    source: YamlSource
    names: tuple[str, ...]  # of the specs, as the study has them
    job: Job
    catalogs: tuple[str, ...]  # as in tables; empty: the spec's own
    shares: NDArray[np.float64] | None  # (points, axes) of a Latin hypercube, 0 up to 1; None: a grid
    depth: int = 0  # how often steps are halved where the best drive changes
    answers: Answers = NO_ANSWERS  # tables that are made of all rows
    rounds: tuple[int, ...] = ()  # number of points that each halving added
    added: tuple[Places, ...] = ()  # these points, in turn

    @property
    def titles(self) -> tuple[str, ...]:
        """The objectives as in tables; empty: the spec's own."""
        return tuple(title_of(objective_of(objective)) if objective else "" for objective in self.job.objectives)

    @property
    def points(self) -> int:
        """Number of combinations of the varied fields, or of specs, before refinement."""
        if self.shares is not None:
            return len(self.shares)
        return len(self.job.specs) * math.prod(len(axis.values) for axis in self.job.axes)

    @property
    def every_point(self) -> int:
        """Number of points with those that refinement added."""
        return self.points + len(self.added)

    @property
    def parts(self) -> int:
        """Number of parts that refinement makes of a step at most."""
        return 1 << self.depth

    @property
    def of_each(self) -> int:
        """Number of variants of each point."""
        return len(self.job.catalogs) * len(self.job.objectives)

    @property
    def total(self) -> int:
        """Number of variants."""
        return self.every_point * self.of_each

    def point(self, point: int) -> list[Variant]:
        """The variants of a point; points count from 0, those that refinement added come last."""
        return [self.variant(point * self.of_each + n) for n in range(1, self.of_each + 1)]

    def variant(self, number: int) -> Variant:
        """The variant of a number; numbers count from 1."""
        point, rest = divmod(number - 1, self.of_each)
        catalogs, objective = divmod(rest, len(self.job.objectives))
        axes = self.job.axes
        if self.shares is not None:
            spec, values = 0, [a.sample(share) for a, share in zip(axes, self.shares[point].tolist(), strict=True)]
        else:
            spec, places = self.places(point)
            values = [axis.at(place, self.parts) for axis, place in zip(axes, places, strict=True)]
        head = [number, *([self.names[spec]] if len(self.names) > 1 else [])]
        head += [axis.table_value(value) for axis, value in zip(axes, values, strict=True)]
        head += [self.catalogs[catalogs]] if any(self.catalogs) else []
        return Variant(number, spec, tuple(values), catalogs, objective, head)

    def places(self, point: int) -> tuple[int, Places]:
        """Spec and places of a point of a grid; points count from 0, those that refinement added come last."""
        if point >= self.points:
            return 0, self.added[point - self.points]
        sizes = len(self.job.specs), *(len(axis.values) for axis in self.job.axes)
        spec, *places = (int(place) for place in np.unravel_index(point, sizes))
        steps = zip(self.job.axes, places, strict=True)
        return spec, tuple(place * self.parts if axis.stepped else place for axis, place in steps)

    def round_of(self, number: int) -> int:
        """The halving that added a variant; 0 before any."""
        ends = accumulate((self.points, *self.rounds))
        return sum((number - 1) // self.of_each >= end for end in ends)


def read_study(path: str | Path) -> Plan:
    """Read a study.yaml and the specs that it names, relative to its folder."""
    return planned(read(Path(path)), Path(path).parent)


def planned(source: YamlSource, folder: Path, known: Mapping[str, YamlSource] | None = None) -> Plan:
    """The plan of a study, with the specs that it names: those that are known, else files from a folder."""
    if not isinstance(source.data, dict):
        raise InputError(f"{source.name}: expected fields such as spec, vary, sampling, objectives")
    try:
        study = StudyFile.model_validate(source.data)
    except ValidationError as error:
        raise explained(error, source, StudyFile) from None
    names = tuple(study.specs or [study.spec or ""])
    if study.specs:
        once(Place(source, ("specs",)), names)
    places: list[Path_] = [("specs", n) for n in range(len(names))] if study.specs else [("spec",)]
    specs = [
        (known or {}).get(name) or _spec(Place(source, place), name, folder)
        for place, name in zip(places, names, strict=True)
    ]
    hypercube = study.sampling if isinstance(study.sampling, Hypercube) else None
    axes = tuple(
        axis_of(Place(source, ("vary", name)), specs[0], name, values, hypercube is None)
        for name, values in (study.vary or {}).items()
    )
    of_machine = machine_job(source, study, specs)
    catalogs = _catalogs(source, study, folder)
    titles = []
    for n, objective in enumerate(study.objectives or ()):
        try:
            titles.append(title_of(objective_of(objective)))
        except InputError as error:
            raise Place(source, ("objectives", n)).error(error) from None
    once(Place(source, ("objectives",)), titles)
    figures = SpecFigures(specs[0])
    derived = derived_fields(figures, study.derive, lambda name, error: Place(source, ("derive", name)).error(error))
    expressions = Expressions(Place(source, ()), figures)
    require = tuple(expressions.limit(text, "require", n) for n, text in enumerate(study.require or ()))
    answers = _answers(source, study, expressions, axes)
    named = [*names_in(require), *answers.names]
    columns = [*(study.columns or ()), *(name for name in named if name in get_args(FurtherName))]
    plan = Plan(
        source=source,
        names=names,
        job=Job(
            specs=tuple((spec.name, spec.text) for spec in specs),
            axes=axes,
            catalogs=catalogs,
            objectives=tuple(study.objectives or (None,)),
            top=study.top,
            derived=derived,
            columns=tuple(dict.fromkeys(columns)),
            require=require,
            **of_machine,
        ),
        answers=answers,
        catalogs=tuple(" + ".join(names) for names in study.catalogs or [[]]),
        shares=None,
        depth=study.refine,
    )
    return _sampled(plan, hypercube) if hypercube else _refinable(_few_enough(plan, plan.total))


@dataclass(frozen=True, slots=True)
class Expressions:
    """Reader of a file's expressions and limits, of which every figure is known; errors name their place."""

    place: Place
    figures: SpecFigures
    further: tuple[str, ...] = ()  # names beside those of figures

    def expression(self, text: str, *path: str | int) -> Expression:
        """An expression."""
        return self._known(expression, text, *path)

    def limit(self, text: str, *path: str | int) -> Limit:
        """A limit on one."""
        kind_of = partial(kind_of_figure, figures=self.figures)
        return self._known(partial(limit, kind_of=kind_of), text, *path)

    def _known(self, read: Callable[[str], Any], text: str, *path: str | int) -> Any:
        try:
            formula = read(text)
            for name in formula.names:
                if name not in self.further:
                    kind_of_figure(name, self.figures)
                if name in OF_BATTERY and "battery" not in self.figures.source.data:
                    raise InputError(f"{quoted(text)}: {name} is by a battery; expected a section battery in the spec")
        except InputError as error:
            raise self.place.error(error, *path) from None
        return formula


def _answers(source: YamlSource, study: StudyFile, read: Expressions, axes: Sequence[Axis]) -> Answers:
    """Expressions of the tables that are made of all rows."""
    varied = [axis.name for axis in axes]
    for n, name in enumerate(study.best.over if study.best else ()):
        if name not in varied:
            hint = nearest(name, varied) or f"; expected one of {', '.join(varied) or 'several'}"
            raise Place(source, ("best", "over", n)).error(f"{quoted(name)} does not vary{hint}")
    return Answers(
        over=tuple(study.best.over) if study.best else (),
        by=read.expression(study.best.by, "best", "by") if study.best else None,
        front=tuple(read.expression(text, "front", n) for n, text in enumerate(study.front or ())),
        influence=tuple(read.expression(text, "influence", n) for n, text in enumerate(study.influence or ())),
    )


def _spec(place: Place, name: str, folder: Path) -> YamlSource:
    if reason := missing(folder / name):
        raise place.error(
            f"{quoted(name)} cannot be read ({reason}); expected a spec, its path from the study's folder"
        )
    spec = read(folder / name)
    if not isinstance(spec.data, dict):
        raise InputError(f"{spec.name}: expected fields such as name, load, motion; see `drivesizer init`")
    if is_machine(spec) and not isinstance(spec.data.get("axes") or {}, dict):
        read_machine(spec)  # says what is wrong with it
    return spec


def _catalogs(source: YamlSource, study: StudyFile, folder: Path) -> tuple[tuple[str, ...] | None, ...]:
    """Catalogues by name or path; files relative to the study's folder."""
    if study.catalogs is None:
        return (None,)
    once(Place(source, ("catalogs",)), study.catalogs)
    return tuple(
        tuple(str((folder / name).absolute()) if name.endswith((".yaml", ".yml")) else name for name in names)
        for names in study.catalogs
    )


def _few_enough(plan: Plan, total: int, most: int = MOST_IN_CHUNKS) -> Plan:
    if total > most:
        where = plan.source.where(("vary",)) if plan.job.axes else plan.source.name
        raise InputError(
            f"{where}: makes {total} variants; expected at most {most}, by fewer steps or as several studies"
        )
    return plan


def _refinable(plan: Plan) -> Plan:
    """Refuse a refinement without a range, or one that may need too many variants."""
    if not plan.depth:
        return plan
    place, axes = Place(plan.source, ("refine",)), plan.job.axes
    if not any(axis.stepped for axis in axes):
        raise place.error(
            "halves the steps of ranges, and no field under vary is one; expected "
            "e.g. load.mass: {from: 30 kg, to: 60 kg, steps: 4}"
        )
    sizes = [(len(axis.values) - 1) * plan.parts + 1 if axis.stepped else len(axis.values) for axis in axes]
    finest = math.prod(sizes) * plan.of_each
    if finest > MOST:
        raise place.error(f"{plan.depth} makes up to {finest} variants; expected at most {MOST}, by fewer halvings")
    return plan


def _sampled(plan: Plan, hypercube: Hypercube) -> Plan:
    """The plan with its samples: the range of each field in as many equal parts as samples, one sample in each."""
    count = hypercube.latin_hypercube
    _few_enough(plan, count * len(plan.job.catalogs) * len(plan.job.objectives), MOST)
    shares = np.empty((count, len(plan.job.axes)))
    for n in range(shares.shape[1]):  # each field has its own generator: further fields change nothing
        generator = np.random.default_rng([hypercube.seed, n])
        shares[:, n] = (generator.permutation(count) + generator.random(count)) / count
    return replace(plan, shares=shares)
