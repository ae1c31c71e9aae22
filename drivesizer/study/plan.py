"""A study as a plan: the number of its variants, and the variant of each number.

The last of sampled fields, catalogues and objectives changes fastest. No list of variants is ever made: a grid's
variant follows from its number, a Latin hypercube's from its row of shares. Only the points that refinement adds
(``refine``) are a list: each round of them follows the variants before it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, quoted
from drivesizer.files.text import missing
from drivesizer.files.yaml_source import Path_, YamlSource, read
from drivesizer.search.order.ranking import objective_of, title_of
from drivesizer.spec.several_axes.any_spec import is_machine
from drivesizer.spec.several_axes.machine_file import read_machine
from drivesizer.study.axes import Axis, Place, axes_of, once
from drivesizer.study.machine_job import machine_job
from drivesizer.study.schema import Hypercube, StudyFile, schema_of

__all__ = ["MOST", "Job", "Places", "Plan", "Variant", "read_study"]

Places = tuple[int, ...]  # of a point on each axis; of ranges counted in the smallest parts of their steps
MOST = 10_000_000  # variants of a study
_CHUNKS = 128  # at least, where there are as many variants
_LARGEST = 100  # variants of a chunk: at most so many are lost by each killed process


class Variant(NamedTuple):
    """One sizing of a study."""

    number: int  # from 1
    spec: int  # which of the specs
    values: tuple[Any, ...]  # of each axis, as they go into the spec
    catalogs: int  # which entry of the study's catalogues
    objective: int


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

    @property
    def sent(self) -> Job:
        """The job for other processes: a variant brings its values, so that no axis need bring all of its own."""
        return replace(self, axes=tuple(replace(axis, values=()) for axis in self.axes))


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """A study, read and checked."""

    source: YamlSource
    names: tuple[str, ...]  # of the specs, as the study has them
    job: Job
    catalogs: tuple[str, ...]  # as in tables; empty: the spec's own
    shares: NDArray[np.float64] | None  # (points, axes) of a Latin hypercube, 0 up to 1; None: a grid
    depth: int = 0  # how often steps are halved where the best drive changes
    rounds: tuple[int, ...] = ()  # number of points that each halving added
    added: tuple[Places, ...] = ()  # these points, in turn

    @property
    def titles(self) -> tuple[str, ...]:
        """The objectives as in tables; empty: the spec's own."""
        return tuple(title_of(objective_of(one)) if one else "" for one in self.job.objectives)

    @property
    def points(self) -> int:
        """Number of combinations of the varied fields, or of specs, before refinement."""
        if self.shares is not None:
            return len(self.shares)
        return len(self.job.specs) * math.prod(len(axis.values) for axis in self.job.axes)

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
        return (self.points + len(self.added)) * self.of_each

    @property
    def chunk(self) -> int:
        """Number of variants that are computed and stored together; independent of processes and refinement."""
        return min(max(self.points * self.of_each // _CHUNKS, 1), _LARGEST)

    @property
    def chunks(self) -> int:
        """Number of chunks; each round of refinement begins with one of its own."""
        return sum(-(-points * self.of_each // self.chunk) for points in (self.points, *self.rounds))

    def head(self, variant: Variant) -> list[Any]:
        """First cells of a variant's row: its number, spec, values and catalogues."""
        spec = [self.names[variant.spec]] if len(self.names) > 1 else []
        values = [axis.table_value(value) for axis, value in zip(self.job.axes, variant.values, strict=True)]
        catalogs = [self.catalogs[variant.catalogs]] if any(self.catalogs) else []
        return [variant.number, *spec, *values, *catalogs]

    def size(self, chunk: int) -> int:
        """Number of variants of a chunk."""
        return len(self._numbers(chunk))

    def variants(self, chunk: int) -> list[Variant]:
        """The variants of a chunk; chunks count from 0."""
        return [self.variant(n) for n in self._numbers(chunk)]

    def _numbers(self, chunk: int) -> range:
        first = 1
        for points in (self.points, *self.rounds):
            end = first + points * self.of_each
            if first + chunk * self.chunk < end:
                return range(first + chunk * self.chunk, min(first + (chunk + 1) * self.chunk, end))
            chunk -= -(-(end - first) // self.chunk)
            first = end
        return range(0)

    def variant(self, number: int) -> Variant:
        """The variant of a number; numbers count from 1."""
        point, rest = divmod(number - 1, self.of_each)
        catalogs, objective = divmod(rest, len(self.job.objectives))
        if self.shares is not None:
            values = tuple(a.sample(share) for a, share in zip(self.job.axes, self.shares[point].tolist(), strict=True))
            return Variant(number, 0, values, catalogs, objective)
        spec, places = self.places(point)
        values = tuple(axis.at(place, self.parts) for axis, place in zip(self.job.axes, places, strict=True))
        return Variant(number, spec, values, catalogs, objective)

    def places(self, point: int) -> tuple[int, Places]:
        """Spec and places of a point of a grid; points count from 0, those that refinement added come last."""
        if point >= self.points:
            return 0, self.added[point - self.points]
        spec, *places = _digits(point, [len(self.job.specs), *(len(axis.values) for axis in self.job.axes)])
        steps = zip(self.job.axes, places, strict=True)
        return spec, tuple(place * self.parts if axis.stepped else place for axis, place in steps)

    def round_of(self, number: int) -> int:
        """The halving that added a variant; 0 before any."""
        ends = accumulate((self.points, *self.rounds))
        return sum((number - 1) // self.of_each >= end for end in ends)


def _digits(number: int, sizes: Sequence[int]) -> list[int]:
    """A number as places in lists of some sizes, the last of which changes fastest.

    >>> _digits(5, (2, 3))
    [1, 2]
    """
    found = []
    for size in reversed(sizes):
        number, place = divmod(number, size)
        found.append(place)
    return found[::-1]


def read_study(path: str | Path) -> Plan:
    """Read a study.yaml and the specs that it names, relative to its folder."""
    source = read(Path(path))
    study = schema_of(source)
    names = tuple(study.specs or [study.spec or ""])
    if study.specs:
        once(Place(source, ("specs",)), names)
    places: list[Path_] = [("specs", n) for n in range(len(names))] if study.specs else [("spec",)]
    specs = [_spec(Place(source, place), name, Path(path).parent) for place, name in zip(places, names, strict=True)]
    hypercube = study.sampling if isinstance(study.sampling, Hypercube) else None
    axes = axes_of(source, specs[0], study.vary or {}, hypercube is None)
    of_machine = machine_job(source, study, specs)
    catalogs = _catalogs(source, study, Path(path).parent)
    _objectives(source, study)
    plan = Plan(
        source=source,
        names=names,
        job=Job(
            specs=tuple((spec.name, spec.text) for spec in specs),
            axes=axes,
            catalogs=catalogs,
            objectives=tuple(study.objectives or (None,)),
            top=study.top,
            **of_machine,
        ),
        catalogs=tuple(" + ".join(names) for names in study.catalogs or [[]]),
        shares=None,
        depth=study.refine,
    )
    return _sampled(plan, hypercube) if hypercube else _refinable(_few_enough(plan, plan.total))


def _spec(place: Place, name: str, folder: Path) -> YamlSource:
    if reason := missing(folder / name):
        raise place.error(
            f"{quoted(name)} cannot be read ({reason}); expected a spec, its path from the study's folder"
        )
    found = read(folder / name)
    if not isinstance(found.data, dict):
        raise InputError(f"{found.name}: expected fields such as name, load, motion; see `drivesizer init`")
    if is_machine(found) and not isinstance(found.data.get("axes") or {}, dict):
        read_machine(found)  # says what is wrong with it
    return found


def _catalogs(source: YamlSource, study: StudyFile, folder: Path) -> tuple[tuple[str, ...] | None, ...]:
    """Catalogues by name or path; files relative to the study's folder."""
    if study.catalogs is None:
        return (None,)
    once(Place(source, ("catalogs",)), study.catalogs)
    return tuple(
        tuple(str((folder / name).absolute()) if name.endswith((".yaml", ".yml")) else name for name in names)
        for names in study.catalogs
    )


def _objectives(source: YamlSource, study: StudyFile) -> None:
    titles = []
    for n, objective in enumerate(study.objectives or ()):
        try:
            titles.append(title_of(objective_of(objective)))
        except InputError as error:
            raise Place(source, ("objectives", n)).error(error) from None
    once(Place(source, ("objectives",)), titles)


def _few_enough(plan: Plan, total: int) -> Plan:
    if total > MOST:
        where = plan.source.where(("vary",)) if plan.job.axes else plan.source.name
        raise InputError(
            f"{where}: makes {total} variants; expected at most {MOST}, by fewer steps or as several studies"
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
    _few_enough(plan, count * len(plan.job.catalogs) * len(plan.job.objectives))
    shares = np.empty((count, len(plan.job.axes)))
    for n in range(shares.shape[1]):  # each field has its own generator: further fields change nothing
        generator = np.random.default_rng([hypercube.seed, n])
        shares[:, n] = (generator.permutation(count) + generator.random(count)) / count
    return Plan(source=plan.source, names=plan.names, job=plan.job, catalogs=plan.catalogs, shares=shares)
