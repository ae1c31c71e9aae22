"""Rows of a study's variants, as each process computes them: the columns of the table, and what was found for each.

The same number always gives the same rows. A figure of a drive becomes a column by one line in ``_DRIVE``, one of a
machine of several axes in ``_MACHINE``; by one more in ``maps.MAPS`` it is drawn as well.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cache, lru_cache
from itertools import chain, groupby, islice
from math import fsum, isnan, nan
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from drivesizer.catalog import Catalog
from drivesizer.errors import DrivesizerError
from drivesizer.files.arithmetic import names_in
from drivesizer.files.yaml_source import Path_, YamlSource, changed
from drivesizer.machine.budgets import machine_budget
from drivesizer.output.parts import unknown_of
from drivesizer.results.check import Check, worst
from drivesizer.results.drive_set import DriveSet, EnergyBudget
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Counts, objective_figure
from drivesizer.search.ranking import objective_of, title_of
from drivesizer.search.shortlist import load_parts, shortlist
from drivesizer.spec.drive import Ranking
from drivesizer.spec.machine import is_machine, read_any
from drivesizer.spec.robot import RobotSpec
from drivesizer.study.figures import NAMED, SpecFigures, row_figures
from drivesizer.study.plan import Job, Plan, Variant
from drivesizer.units import KINDS
from drivesizer.version import __version__

if TYPE_CHECKING:
    from drivesizer.joints.mass_columns import JointTorques
    from drivesizer.results.machine import MachineSizing
    from drivesizer.spec.robot_section import RobotSection


Form = Literal["whole", "number", "text"]
Row = list[Any]  # a figure that is not known is None
_DIGITS = 12  # of a figure, to hide rounding errors


class Column(NamedTuple):
    """A column of the table: its head, its type, and its unit for programs that read units separately."""

    head: str
    form: Form = "number"
    unit: str = ""

    def cell(self, value: Any) -> Any:
        """A value as a table has it."""
        if self.form != "number":
            return value
        return None if isnan(value) else float(f"{value:.{_DIGITS}g}")


class Part(NamedTuple):
    """The rows of some variants, and the inputs of the process that computed them."""

    rows: list[Row]
    variants: int
    made_of: dict[str, str]  # program and catalogues, by version and digest


# Columns of a drive, and of a machine of several axes.


def _text(head: str, of: Callable[[Any], Any]) -> tuple[Column, Callable[[Any], Any]]:
    return Column(head, "text"), of


def _number(head: str, unit: str, of: Callable[[Any], Any]) -> tuple[Column, Callable[[Any], Any]]:
    return Column(head, "number", unit), of


def _euros(drive: DriveSet) -> float:
    """The price of a drive; unknown where prices are compared in another currency."""
    return drive.price if drive.currency == "EUR" else nan


def _mass_lacks(drive: DriveSet) -> list[str]:
    return sorted(drive.unknown_parts("mass", drive.mass_of))


def _price_lacks(drive: DriveSet) -> Sequence[str]:
    return unknown_of(drive, drive.price_of)


def _part(part: Any, name: str = "part") -> str:
    return str(getattr(part, name)) if part is not None else ""


_DRIVE = (
    _text("set", lambda drive: drive.label),
    _text("motor_family", lambda drive: drive.motor.family),
    _text("motor_part", lambda drive: drive.motor.part),
    _text("gearhead_family", lambda drive: drive.gearhead.family),
    _text("gearhead_part", lambda drive: drive.gearhead.part),
    _number("gearhead_ratio", "1", lambda drive: drive.gearhead.ratio),
    _number("belt_ratio", "1", lambda drive: drive.belt_ratio),
    _text("belt_part", lambda drive: _part(drive.belt_drive and drive.belt_drive.belt)),
    _text("screw_part", lambda drive: _part(drive.chosen_screw and drive.chosen_screw.screw)),
    _text("brake_part", lambda drive: _part(drive.brake)),
    _text("encoder_family", lambda drive: _part(drive.encoder, "family")),
    _text("encoder_part", lambda drive: _part(drive.encoder)),
    _text("controller_family", lambda drive: _part(drive.controller, "family")),
    _text("controller_part", lambda drive: _part(drive.controller)),
    _number("total_ratio", "1", lambda drive: drive.total_ratio),
    _number("mass_kg", "kg", lambda drive: drive.mass),  # as the objective counts it
    _text("mass_lacks", lambda drive: " + ".join(_mass_lacks(drive))),
    _text("mass_estimated", lambda drive: " + ".join(drive.mass_estimated)),
    _number("price_EUR", "EUR", _euros),  # of all parts whose price is known
    _text("price_lacks", lambda drive: " + ".join(_price_lacks(drive))),
    _number("objective_si", "", lambda drive: drive.objective),
    _number("energy_J", "J", lambda drive: next((x.value for x in drive.figures if x.name == "energy"), nan)),
    _number("probability", "1", lambda drive: drive.reliability.passing if drive.reliability else nan),  # that all pass
    _number("none_fails", "1", lambda drive: drive.reliability.probability if drive.reliability else nan),
    _number("probability_error", "1", lambda drive: drive.reliability.error if drive.reliability else nan),  # 95 %
)
_TOTALS = Column("drives", "whole"), Column("machine_mass_kg", unit="kg"), Column("machine_price_EUR", unit="EUR")


def _known_price(sizing: MachineSizing) -> float:
    """Sum of the known prices of all parts [EUR]; NaN where none is known or an axis has no drive."""
    known = [axis.drives * _euros(axis.best) for axis in sizing.axes if axis.best and not isnan(_euros(axis.best))]
    return fsum(known) if known and sizing.complete else nan


def _lacking(sizing: MachineSizing, of: Callable[[DriveSet], Sequence[str]]) -> str:
    """Parts that a sum does not cover or estimates, by axis: ``lift: motor + encoder; slide: encoder``."""
    parts = [(axis.name, of(axis.best)) for axis in sizing.axes if axis.best] if sizing.complete else []
    return "; ".join(f"{name}: {' + '.join(names)}" for name, names in parts if names)


def _machine_cycle(sizing: MachineSizing) -> float:
    """Time of the cycle of all axes [s]."""
    figures = sizing.power.figures if sizing.power else ()
    return next((figure.value for figure in figures if figure.name == "machine_cycle"), nan)


_MACHINE = (
    (Column("drives", "whole"), lambda sizing: sum(axis.drives for axis in sizing.axes if axis.best)),
    (
        Column("kinds", "whole"),  # of motor and gearhead
        lambda sizing: len({(axis.best.motor.part, axis.best.gearhead.part) for axis in sizing.axes if axis.best}),
    ),
    _number(
        "machine_mass_kg", "kg",  # unknown where an axis has no drive
        lambda sizing: fsum(axis.drives * axis.best.mass if axis.best else nan for axis in sizing.axes),
    ),
    _text("mass_lacks", lambda sizing: _lacking(sizing, _mass_lacks)),
    _text("mass_estimated", lambda sizing: _lacking(sizing, lambda drive: drive.mass_estimated)),
    _number("machine_price_EUR", "EUR", _known_price),
    _text("price_lacks", lambda sizing: _lacking(sizing, _price_lacks)),
    _number("objective_si", "", lambda sizing: sizing.total),
    _number("energy_J", "J", lambda sizing: sizing.power.mean * _machine_cycle(sizing) if sizing.power else nan),
    _number("mean_W", "W", lambda sizing: sizing.power.mean if sizing.power else nan),
    _number("peak_W", "W", lambda sizing: sizing.power.peak if sizing.power else nan),
    _number(
        "supply_none_fails", "1",  # without tolerances unknown
        lambda sizing: sizing.power.reliability.probability if sizing.power and sizing.power.reliability else nan,
    ),
)  # fmt: skip


class Further(NamedTuple):
    """A figure of the machine with a drive in it: a column where a study or an expression names it."""

    of_drive: Callable[[Problem, DriveSet, EnergyBudget | None], Any]
    of_machine: Callable[[MachineSizing], Any] = lambda _: nan  # nothing of several axes


def _of_battery(of: Callable[[EnergyBudget], float]) -> Callable[[MachineSizing], float]:
    return lambda sizing: of(sizing.power.energy) if sizing.power and sizing.power.energy else nan


def _unknown(checks: Iterable[Check]) -> str:
    """Names of the checks that decide and are unknown."""
    return " + ".join(dict.fromkeys(check.name for check in checks if check.status == "unknown" and not check.advice))


FURTHER = {
    "time": Further(lambda problem, *_: float(problem.cases[0].cycle.duration.sum()), _machine_cycle),
    "autonomy": Further(lambda *of: of[-1].autonomy if of[-1] else nan, _of_battery(lambda energy: energy.autonomy)),
    "range": Further(lambda *of: of[-1].range if of[-1] else nan, _of_battery(lambda energy: energy.range)),
    "moved_mass": Further(lambda problem, *_: getattr(problem.machine.load, "mass", nan)),
    "joule_heat": Further(lambda _, drive, __: objective_figure(drive, "joule_heat").value),
    "peak_current": Further(lambda _, drive, __: objective_figure(drive, "peak_current").value),
    "unknown_checks": Further(
        lambda _, drive, __: _unknown(drive.deciding),
        lambda sizing: _unknown(chain(sizing.checks, *(axis.best.deciding for axis in sizing.axes if axis.best))),
    ),
}
"""Figures that a table has where they are wanted, by their names in expressions; and checks that are unknown."""


def _further_column(name: str) -> Column:
    return Column(NAMED[name].column, unit=KINDS[NAMED[name].kind].si) if name in NAMED else Column(name, "text")


MERIT = Column("merit")  # of a drive, by a function of a program's
_MARGIN = Column("smallest_margin", "number", "1"), Column("smallest_margin_check", "text")
_WHERE = Column("smallest_margin_axis", "text")
_HEAD = Column("objective", "text"), Column("rank", "whole"), Column("status", "text")
_COUNTS = Column("sets_examined", "whole"), Column("sets_that_stand", "whole")
_LAST = Column("nearest_miss", "text"), Column("error", "text")


def columns_of(plan: Plan) -> tuple[Column, ...]:
    """The columns of a study's table."""
    spec = (Column("spec", "text"),) if len(plan.names) > 1 else ()
    catalogs = (Column("catalogs", "text"),) if any(plan.catalogs) else ()
    varied = []
    for axis in plan.job.axes:
        whole = all(isinstance(axis.table_value(value), int) for value in axis.values)
        varied.append(Column(axis.head, "number" if axis.kind else "whole" if whole else "text", axis.unit))
    return (Column("variant", "whole"), *spec, *varied, *catalogs, *result_columns(plan.job))


def result_columns(job: Job) -> tuple[Column, ...]:
    """The columns behind what varies: of a drive, or of a machine."""
    more = (*(_further_column(name) for name in job.columns), *([MERIT] if job.merit else ()))
    if job.machine and job.axis is None:
        drives = (Column(f"{name}.set", "text") for name in job.members)
        return (*_HEAD, *(column for column, _ in _MACHINE), *_MARGIN, _WHERE, *drives, *more, *_COUNTS, *_LAST)
    return (*_HEAD, *(column for column, _ in _DRIVE), *_TOTALS, *_MARGIN, *more, *_COUNTS, *_LAST)


# The best drives of a variant: the result of ``drivesizer size`` without relaxations, the other method and the
# catalogue. These take many further searches where no drive passes, which is frequent in a study.


class Best(NamedTuple):
    """Short result of a search."""

    sets: tuple[DriveSet, ...]  # that pass or are unknown, best first
    nearest: DriveSet | None  # closest rejected, where none passes
    counts: Counts
    objective: str
    drives: int  # of this kind that the machine has
    problem: Problem | None = None


def best(
    spec: RobotSpec,
    catalog: Catalog,
    *,
    objective: Ranking | None = None,
    top: int = 1,
    pareto: tuple[str, ...] = (),
    alike: dict[Hashable, Any] | None = None,
) -> Best:
    """The best drives of a spec, and those of the Pareto front of some objectives."""
    ranked = catalog.once(("ranked by", repr(objective)), lambda: spec.select.ranked_by(objective), (spec.select,))
    spec = spec.with_select(ranked)
    result = shortlist(spec, catalog, top, misses=0, detail="checks", memo=alike, pareto=pareto)
    first = result.best or [*islice(chain(result.unsure, result.short, result.rejected), 1)]
    first = [*first, *(row for row in result.search.front if row not in first)] if result.best else first
    drives = tuple(
        result.record(row, rank, reliability=result.reliability.get(row)) for rank, row in enumerate(first, 1)
    )
    sets, nearest = (drives, None) if result.best else ((), next(iter(drives), None))
    return Best(sets, nearest, result.search.counts, title_of(spec.select.objective), spec.load.motors, result.problem)


def _further(job: Job, problem: Problem | None, drive: DriveSet) -> Row:
    """Further figures of the machine with a drive in it, as far as the job wants some."""
    if problem is None or not (job.columns or job.merit):
        return []
    energy = machine_budget(problem, drive, figures=False).energy if {"autonomy", "range"} & {*job.columns} else None
    cells: Row = [_further_column(name).cell(FURTHER[name].of_drive(problem, drive, energy)) for name in job.columns]
    return [*cells, MERIT.cell(float(job.merit(drive)))] if job.merit else cells


def _drive_rows(job: Job, head: Row, result: Best) -> list[Row]:
    """Rows of a variant: one for each drive, or one with the check that the closest rejected drive fails most."""
    counts = [result.counts.considered, result.counts.feasible]
    rows = []
    for drive in result.sets:
        totals = [result.drives, *(result.drives * value for value in (drive.mass, _euros(drive)))]
        rows.append([
            *head, result.objective, drive.rank, drive.status, *(column.cell(of(drive)) for column, of in _DRIVE),
            *(column.cell(value) for column, value in zip(_TOTALS, totals, strict=True)), *_smallest_margin(drive),
            *_further(job, result.problem, drive), *counts, "", "",
        ])  # fmt: skip
    if rows:
        return rows
    near = result.nearest
    none = [None if column.form != "text" else "" for column in (*(column for column, _ in _DRIVE), *_TOTALS)]
    margin, label = (_smallest_margin(near), near.label) if near else ([None, ""], "")
    unknown = [None] * (len(job.columns) + bool(job.merit))
    return [[*head, result.objective, None, "fail", *none, *margin, *unknown, *counts, label, ""]]


def _smallest_margin(drive: DriveSet) -> Row:
    """The smallest margin and its check."""
    check = worst(drive.deciding)
    return [_MARGIN[0].cell(check.margin), check.name] if check else [None, ""]


def _machine_row(job: Job, head: Row, sizing: MachineSizing) -> Row:
    """The row of a variant; of an axis without a drive the margin is that of the closest rejected."""
    labels = {axis.name: axis.best.label for axis in sizing.axes if axis.best}
    counts = [axis.result.counts for axis in sizing.axes]
    least = sizing.tightest(rejected=True)
    margin, check, axis = (least[0].margin, least[0].name, least[1] or "all") if least else (nan, "", "")
    lost = next((axis for axis in sizing.axes if axis.best is None), None)
    near = lost.closest if lost else None
    return [
        *head, sizing.objective, 1 if sizing.status != "fail" else None, sizing.status,
        *(column.cell(of(sizing)) for column, of in _MACHINE), _MARGIN[0].cell(margin), check, axis,
        *(labels.get(name, "") for name in job.members),
        *(_further_column(name).cell(FURTHER[name].of_machine(sizing)) for name in job.columns),
        sum(count.considered for count in counts), sum(count.feasible for count in counts),
        f"{lost.name}: {near.label}" if lost and near else "", "",
    ]  # fmt: skip


# Variants, with what a process loads once.


@lru_cache(maxsize=8)
def _source(name: str, text: str) -> YamlSource:
    return YamlSource(text, name)


@lru_cache(maxsize=8)
def _figures(name: str, text: str) -> SpecFigures:
    """Figures of a spec by name."""
    return SpecFigures(_source(name, text))


@dataclass(frozen=True, slots=True)
class _By:
    """Something that is known by a key: a spec by what its parts hang on, a robot's section by its text."""

    key: Hashable
    of: Any = field(compare=False, repr=False)


@lru_cache(maxsize=8)
def _catalog(spec: _By) -> Catalog:
    return load_parts(spec.of)


@lru_cache(maxsize=4)
def _torques(robot: _By, file: str, gravity: float) -> JointTorques:
    from drivesizer.joints.mass_columns import joint_torques

    return joint_torques(robot.of, file, gravity)


def forget_files() -> None:
    """Read catalogues and descriptions again: another study of the same process may find others in their files."""
    _catalog.cache_clear()
    _torques.cache_clear()


def document_of(job: Job, variant: Variant) -> YamlSource:
    """The file of a variant: the spec's with other values in some fields, and other catalogues where it names some."""
    source = _source(*job.specs[variant.spec])
    data = source.data
    for axis, value in zip(job.axes, variant.values, strict=True):
        for path, field_value in axis.changes(value):
            data = changed(data, path, field_value)
    for figure in job.derived:
        data = figure.entered(data, _figures(*job.specs[variant.spec]))
    document, names = source.with_data(data), job.catalogs[variant.catalogs]
    axes = (document.data.get("axes") or {}) if is_machine(document) else {}
    own = [name for name, section in axes.items() if "catalogs" in ((section or {}).get("select") or ())]
    places: list[Path_] = [(), *(("axes", name) for name in own)]
    for path in places if names else ():
        document.data = changed(document.data, (*path, "select", "catalogs"), list(names or ()))
    return document


def spec_of(job: Job, variant: Variant) -> RobotSpec:
    """The spec of a variant of a single axis."""
    return read_any(document_of(job, variant)).axes[0].spec


def rows_of(job: Job, variants: Sequence[Variant]) -> Part:
    """The rows of some variants."""
    versions, rows = {"drivesizer": __version__}, list[Row]()

    def parts(spec: RobotSpec) -> Catalog:
        catalog = _catalog(_By(spec.parts_key, spec))
        versions.update({f"catalogue {name}": digest for name, digest in catalog.digests.items()})
        return catalog

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # figures that overflow are unknown in the table
        for _, of_point in groupby(variants, lambda variant: (variant.number - 1) // len(job.objectives)):
            alike: dict[Hashable, Any] = {}  # by all objectives of a point
            for variant in of_point:
                objective = objective_of(text) if (text := job.objectives[variant.objective]) else None
                try:
                    rows += _required(job, variant, _rows(job, variant, objective, parts, alike))
                    continue
                except DrivesizerError as error:
                    message = " ".join(str(error).split())
                except (ArithmeticError, AssertionError, LookupError, TypeError, ValueError) as error:
                    # of the program, not of the variant: its row says so, and the following variants are still computed
                    message = f"a fault of drivesizer, please report it: {type(error).__name__}: {error}"[:400]
                none = ["" if column.form == "text" else None for column in result_columns(job)[len(_HEAD) : -1]]
                title = title_of(objective) if objective else ""
                rows.append([*variant.head, title, None, "error", *none, message])
    return Part(rows, len(variants), versions)


def spec_figures(job: Job, variant: Variant) -> Callable[[str], float]:
    """Figures of a variant's spec by name; the spec is made when the first is wanted."""
    document = cache(lambda: document_of(job, variant).data)
    return lambda name: _figures(*job.specs[variant.spec]).value(name, document())


def _required(job: Job, variant: Variant, rows: list[Row]) -> list[Row]:
    """Rows of the drives within the study's limits; where none is, one that says which limit the closest is beyond.

    Of a sum that lacks parts nobody knows whether it is within one.
    """
    if not job.require:
        return rows
    columns, of_spec = result_columns(job), spec_figures(job, variant)
    heads, lacks = [column.head for column in columns], [f"{name}_lacks" for name in names_in(job.require)]
    within, closest = list[Row](), None
    for row in rows:
        cells = dict(zip(heads, row[len(variant.head) :], strict=True))
        if cells["status"] in ("fail", "error"):
            return rows
        figure = row_figures(heads, [*cells.values()], of_spec)
        excesses = [(limit.excess(figure), limit.text) for limit in job.require]
        unknown = next((text for by, text in excesses if isnan(by)), "")
        by, text = (nan, unknown) if unknown else max(excesses)
        if by <= 1e-9:
            status = "unknown" if any(cells.get(name) for name in lacks) else cells["status"]
            within.append([*variant.head, *(cells | {"status": status}).values()])
        elif closest is None:
            none = {column.head: "" if column.form == "text" else None for column in columns}
            none |= {name: cells[name] for name in ("objective", "sets_examined", "sets_that_stand")}
            none |= {"status": "fail", "smallest_margin": _MARGIN[0].cell(-by), "smallest_margin_check": text}
            closest = [*variant.head, *(none | {"nearest_miss": cells.get("set", "")}).values()]
    return within or ([closest] if closest else rows)


def _rows(
    job: Job,
    variant: Variant,
    objective: Ranking | None,
    parts: Callable[[RobotSpec], Catalog],
    alike: dict[Hashable, Any],
) -> list[Row]:
    """The rows of a variant."""
    head = variant.head
    if not job.machine:
        if "spec" not in alike:
            alike["spec"] = spec_of(job, variant)
        spec = alike["spec"]
        drives = best(spec, parts(spec), objective=objective, top=job.top, pareto=job.pareto, alike=alike)
        return _drive_rows(job, head, drives)
    from drivesizer.multi_axis import size_machine  # a spec of one axis needs nothing of machines

    source = document_of(job, variant)
    robot = json.dumps(source.data.get("robot"), ensure_ascii=False)

    def torques(section: RobotSection, file: str, gravity: float) -> JointTorques:
        """Of variants with the same section they are computed once in a process."""
        return _torques(_By(robot, section), file, gravity)

    sizing = size_machine(
        read_any(source), top=job.top, objective=objective, detail="drives", parts=parts, torques=torques
    )
    if job.axis is None:
        return [_machine_row(job, head, sizing)]
    axis = sizing.axis(job.axis)
    sets, result = axis.result.sets[: job.top], axis.result
    near = None if sets else axis.closest
    return _drive_rows(job, head, Best(sets, near, result.counts, result.objective, axis.drives, result.problem))
