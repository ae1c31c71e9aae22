"""A spec with free figures as a task: what is free, what follows from it, what is made least, within which limits."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import floor, inf, prod
from typing import Any

from pydantic import ValidationError

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.files.arithmetic import Expression, Limit, names_in
from drivesizer.files.yaml_source import Edit, Path_, YamlSource, changed, edited, field_name, value_at
from drivesizer.results.drive_set import DriveSet
from drivesizer.search.ranking import COUNTED
from drivesizer.spec.drive import OBJECTIVES, Select
from drivesizer.spec.machine import is_machine
from drivesizer.spec.messages import explained
from drivesizer.spec.sections import EXPRESSION, FREE, Design, open_figures
from drivesizer.study.figures import NAMED, OF_BATTERY, SpecFigures, derived_fields, kind_of
from drivesizer.study.plan import Axis, Expressions, Job, Place, Plan, StudyFile, axis_of, machine_job
from drivesizer.study.rows import columns_of, result_columns
from drivesizer.units import scale, to_si

_RANGE = re.compile(r"\s*(?P<low>.+?)\s*\.\.\s*(?P<high>.+?)\s*")
_EXAMPLE = "e.g. {free: 120 mm .. 250 mm, step: 10 mm}, or a choice, {free: [2, 4]}"
_MERIT = "merit"


@dataclass(frozen=True, kw_only=True)
class Task:
    """A spec with its free figures, read and checked."""

    source: YamlSource  # as it is written
    plan: Plan  # of the study that its machines are variants of
    free: tuple[Axis, ...]
    minimise: Expression
    pareto: tuple[Expression, ...]
    limits: tuple[Limit, ...]
    own_limits: tuple[Edit, ...]  # that the spec says for itself
    evaluations: int
    seed: int
    notes: tuple[str, ...] = ()

    @property
    def job(self) -> Job:
        """Data for the processes that size machines."""
        return self.plan.job

    @property
    def goals(self) -> tuple[Expression, ...]:
        """Goals: first the one that decides, then those of the front."""
        return (self.minimise, *(goal for goal in self.pareto if goal.text != self.minimise.text))

    @property
    def combinations(self) -> float:
        """Number of machines there are; infinite where a range has no steps."""
        return (
            inf if any(axis.continuous for axis in self.free) else prod(float(len(axis.values)) for axis in self.free)
        )

    @cached_property
    def figures(self) -> SpecFigures:
        """Figures of the spec by name."""
        name, text = self.job.specs[0]
        return SpecFigures(YamlSource(text, name))

    @cached_property
    def heads(self) -> list[str]:
        """Columns of a machine's row."""
        return [column.head for column in columns_of(self.plan)]

    def filled(self, values: Sequence[Any]) -> str:
        """The spec's text with its free figures filled in, and what follows from them."""
        data = self.figures.source.data
        for axis, value in zip(self.free, values, strict=True):
            data = changed(data, axis.path, value)
        for derived in self.job.derived:
            data = derived.entered(data, self.figures)
        places = [*(figure.path for figure in self.free), *(figure.path for figure in self.job.derived)]
        edits = [*(Edit(path, value_at(data, path)) for path in places), *self.own_limits]
        if self.job.objectives[0] is not None and not is_machine(self.source):
            edits.append(Edit(("select", "objective"), self.job.objectives[0]))
        return edited(self.source.text, edits, self.source.name)


def read_task(
    source: YamlSource,
    *,
    free: Mapping[str, Any] | None = None,
    merit: Callable[[DriveSet], float] | None = None,
    **options: Any,
) -> Task:
    """The task of a spec."""
    if not isinstance(source.data, dict):
        raise InputError(f"{source.name}: expected fields such as name, load, motion; see `drivesizer init`")
    section = _section(source, {name: value for name, value in options.items() if value is not None})
    spaces, texts, data = _spaces(source, free or {})
    plain = source.with_data(data)
    axes = tuple(_free(Place(source, path), plain, path, space) for path, space in spaces.items())
    if not axes:
        raise InputError(f"{source.name}: no figure is free; expected one or more, {_EXAMPLE}")
    figures = SpecFigures(plain)
    derived = derived_fields(
        figures, {field_name(path): text for path, text in texts.items()},
        lambda name, error: InputError(f"{source.where(figures.place(name)[0])}: {error}"),
    )  # fmt: skip
    for figure in derived:
        data = figure.entered(data, figures)
    edits = [Edit(path, value_at(data, path)) for path in (*spaces, *texts)]
    minimise, pareto, limits = _goals(source, section, figures, merit is not None)
    own, limits = _own_limits(data, limits)
    base = YamlSource(edited(source.text, [*edits, *own], source.name), source.name)
    of_machine = machine_job(source, StudyFile(spec=source.name), [base])
    objective, front, notes = _inside(
        data, [minimise, *pareto], limits, bool(of_machine.get("members")), merit is not None
    )
    job = Job(
        specs=((source.name, base.text),), axes=axes, catalogs=(None,),
        objectives=(objective,), top=10 if merit else 1, derived=derived, pareto=front, merit=merit,
        **of_machine,
    )  # fmt: skip
    names = [*names_in((minimise, *pareto, *limits)), "time", "autonomy", "range"]
    heads = [column.head for column in result_columns(job)]  # other figures are further columns
    columns = dict.fromkeys(name for name in names if name in NAMED and NAMED[name].column not in heads)
    job = replace(job, columns=(*columns, "unknown_checks"))
    plan = Plan(source=source, names=(source.name,), job=job, catalogs=("",), shares=None)
    return Task(
        source=source, plan=plan, free=axes, minimise=minimise, pareto=pareto, limits=limits, own_limits=own,
        evaluations=section.evaluations, seed=section.seed, notes=notes,
    )  # fmt: skip


def _section(source: YamlSource, options: dict[str, Any]) -> Design:
    written = source.data.get("design") or {}
    try:
        return Design.model_validate({**written, **options} if isinstance(written, dict) else written)
    except ValidationError as error:
        below = source.with_data(written)
        raise explained(error, below, Design, at=()) from None


def _spaces(source: YamlSource, free: Mapping[str, Any]) -> tuple[dict[Path_, Any], dict[Path_, str], Any]:
    """Ranges and expressions by their paths; and the data with one value of each in its place."""
    figures, data = SpecFigures(source), source.data
    spaces: dict[Path_, Any] = {}
    texts: dict[Path_, str] = {}
    for path, fields in open_figures(data):
        if EXPRESSION in fields:
            if len(fields) > 1 or not isinstance(fields[EXPRESSION], str):
                raise InputError(f'{source.where(path)}: expected {{expression: "2 * load.wheel_diameter"}} alone')
            texts[path] = fields[EXPRESSION]
            continue
        if unknown := [key for key in fields if key not in (FREE, "step")]:
            raise InputError(f"{source.where((*path, unknown[0]))}: unknown key; expected free, step"
                             f"{nearest(unknown[0], (FREE, 'step'))}")  # fmt: skip
        spaces[path] = fields
    for name, fields in free.items():
        spaces[figures.path(name)] = fields if isinstance(fields, dict) else {FREE: fields}
    for path, fields in spaces.items():
        data = changed(data, path, _first(fields[FREE]))
    return spaces, texts, data


def _first(space: Any) -> Any:
    if isinstance(space, list):
        return space[0] if space else None
    match = _RANGE.fullmatch(str(space))
    return match["low"] if match else space


def _free(place: Place, plain: YamlSource, path: Path_, fields: dict[str, Any]) -> Axis:
    """A free figure with its range, with steps or without, or its choice."""
    name, space = field_name(path), fields[FREE]
    if isinstance(space, list):
        if "step" in fields:
            raise place.error("a choice has no steps; expected a range with it", "step")
        return axis_of(place, plain, name, space, True)
    match = _RANGE.fullmatch(space) if isinstance(space, str) else None
    if match is None:
        raise place.error(f"{quoted(space)} is no range; expected {_EXAMPLE}", FREE)
    kind = kind_of(plain, path, match["low"])
    if not kind:
        raise place.error(f"is no quantity; expected a choice, e.g. {{free: [{_first(space)}]}}")
    try:
        low, high = (to_si(match[end], kind) for end in ("low", "high"))
    except InputError as error:
        raise place.error(error, FREE) from None
    if not low < high:
        raise place.error(f"{quoted(space)}: the first is not below the second; expected {_EXAMPLE}", FREE)
    axis = Axis(name=name, path=path, kind=kind).between(match["low"], match["high"])
    if "step" not in fields:
        return axis
    try:
        step = to_si(fields["step"], kind) / (scale(axis.unit, kind)[0] if axis.unit else 1.0)
    except InputError as error:
        raise place.error(error, "step") from None
    first, last = axis.bounds
    if not 0.0 < step <= last - first or (last - first) / step > 100_000:
        raise place.error(f"{quoted(fields['step'])} is no step of it; expected up to the range, {_EXAMPLE}", "step")
    count = floor((last - first) / step + 1e-9) + 1
    return replace(axis, values=tuple(f"{first + n * step:.12g} {axis.unit}".rstrip() for n in range(count)))


def _goals(
    source: YamlSource, section: Design, figures: SpecFigures, judged: bool
) -> tuple[Expression, tuple[Expression, ...], tuple[Limit, ...]]:
    """Goals, those of the front, and limits; every name in them is known."""
    read = Expressions(Place(source, ("design",)), figures, (_MERIT,) if judged else ())
    select = source.data.get("select")
    ranked = select.get("objective") if isinstance(select, dict) else None
    own = ranked if ranked in NAMED else Select.model_fields["objective"].default
    pareto = tuple(read.expression(text, "pareto", n) for n, text in enumerate(section.pareto))
    text = _MERIT if judged else section.minimise or (pareto[0].text if pareto else str(own))
    limits = tuple(read.limit(text, "subject_to", n) for n, text in enumerate(section.subject_to))
    return read.expression(text, "minimise"), pareto, limits


def _own_limits(data: Any, limits: Iterable[Limit]) -> tuple[tuple[Edit, ...], tuple[Limit, ...]]:
    """Limits that the battery's section can say: the search holds every drive to them."""
    battery, own, rest = data.get("battery"), list[Edit](), list[Limit]()
    for limit in limits:
        name = limit.of.text
        if name in OF_BATTERY and limit.sign == ">=" and isinstance(battery, dict):
            bound = battery.get(name)
            if bound is None or to_si(bound, NAMED[name].kind) < limit.bound:
                own.append(Edit(("battery", name), limit.text.partition(limit.sign)[2].strip()))
            continue
        rest.append(limit)
    return tuple(own), tuple(rest)


def _inside(
    data: Any, goals: Iterable[Expression], limits: Iterable[Limit], several: bool, judged: bool
) -> tuple[str | None, tuple[str, ...], tuple[str, ...]]:
    """The objective of the search for a drive, objectives of which it gives the front, and notes."""
    if judged:
        return None, ("mass", "price"), ()
    objectives = list(dict.fromkeys(NAMED[n].by for n in names_in((*goals, *limits)) if n in NAMED and NAMED[n].by))
    notes: tuple[str, ...] = ()
    if data.get("method") == "paper" and (left := [objective for objective in objectives if objective in COUNTED]):
        objectives = [objective for objective in objectives if objective not in left]
        notes = (f"the paper's method ranks no drives by {' and '.join(left)}: drives are chosen by what it does",)
    if several and len(objectives) > 1:
        notes = (*notes, f"drives of each axis are chosen by {objectives[0]} alone")
        objectives = objectives[:1]
    assert all(objective in OBJECTIVES for objective in objectives)
    return (objectives[0] if objectives else None), tuple(objectives) if len(objectives) > 1 else (), notes
