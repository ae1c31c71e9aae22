"""Columns of a study's table and its cells, the best drives of a variant, the table as CSV and as Parquet."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec
from itertools import chain, islice
from math import fsum, isnan, nan
from pathlib import Path
from typing import Any, BinaryIO, Literal, NamedTuple

from drivesizer.catalog import Catalog
from drivesizer.errors import InputError, reason_of
from drivesizer.files.writing import ready
from drivesizer.output.parts import unknown_of
from drivesizer.output.words import csv_cell
from drivesizer.results.check import Check, worst
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.machine import AxisSizing, MachineSizing
from drivesizer.results.sizing import Counts, unknown_parts
from drivesizer.search.ranking import title_of
from drivesizer.search.shortlist import shortlist
from drivesizer.spec.drive import Ranking
from drivesizer.spec.robot import RobotSpec
from drivesizer.study.plan import Job, Plan

__all__ = [
    "Best", "Column", "Row", "best", "columns_of", "failed", "has_parquet", "machine_row", "variant_rows", "write_csv",
    "write_parquet",
]  # fmt: skip


# -- A column of a study's table, and its cells.


Form = Literal["whole", "number", "text"]
Row = list[Any]  # a figure that is not known is None
_DIGITS = 12  # of a figure, to hide rounding errors


class Column(NamedTuple):
    """A column: its head, its type, and its unit for programs that read units separately."""

    head: str
    form: Form
    unit: str = ""


def cell(column: Column, value: Any) -> Any:
    """A value as a table has it."""
    if column.form != "number":
        return value
    return None if isnan(value) else float(f"{value:.{_DIGITS}g}")


# -- The best drives of a variant.
#
# The result of ``drivesizer size`` without relaxations, the other method and the catalogue: these take many further
# searches where no drive passes, which is frequent in a study.


class Best(NamedTuple):
    """Short result of a search."""

    sets: tuple[DriveSet, ...]  # that pass or are unknown, best first
    nearest: DriveSet | None  # closest rejected, where none passes
    counts: Counts
    objective: str
    drives: int  # of this kind that the machine has


def best(
    spec: RobotSpec,
    catalog: Catalog,
    *,
    objective: Ranking | None = None,
    top: int = 1,
    made: dict[Hashable, Any] | None = None,
) -> Best:
    """The best drives of a spec."""
    ranked = catalog.once(("ranked by", repr(objective)), lambda: spec.select.ranked_by(objective), (spec.select,))
    spec = spec.with_select(ranked)
    found = shortlist(spec, catalog, top, misses=0, brief=True, checks_alone=True, made=made)
    first = found.best or [*islice(chain(found.unsure, found.short, found.rejected), 1)]
    shown = tuple(found.record(row, rank, reliability=found.reliability.get(row)) for rank, row in enumerate(first, 1))
    sets = shown if found.best else ()
    title, near = title_of(spec.select.objective), None if sets else next(iter(shown), None)
    return Best(sets, near, found.found.counts, title, spec.load.motors)


# -- Columns of a machine in a study's table: sums over its axes, what they draw together, the drive of each axis.
#
# A figure of the machine becomes a column by one line in ``_MACHINE``.


class _MachineColumn(NamedTuple):
    """A column with a figure of a machine."""

    column: Column
    of: Callable[[MachineSizing], Any]


def _sum(of: Callable[[DriveSet], float]) -> Callable[[MachineSizing], float]:
    """A figure of all drives; unknown where an axis has none."""
    return lambda sizing: fsum(one.drives * of(one.best) if one.best else nan for one in sizing.axes)


def _price(sizing: MachineSizing) -> float:
    """Sum of the known prices of all parts [EUR]; NaN where none is known or an axis has no drive."""
    known = [one.drives * one.best.price for one in sizing.axes if one.best and not isnan(one.best.price)]
    return fsum(known) if known and sizing.complete else nan


def _lacking(of: Callable[[DriveSet], Sequence[str]]) -> Callable[[MachineSizing], str]:
    """Parts that a sum does not cover, by axis: ``lift: motor + encoder; slide: encoder``."""

    def said(sizing: MachineSizing) -> str:
        parts = [(one.name, of(one.best)) for one in sizing.axes if one.best] if sizing.complete else []
        return "; ".join(f"{name}: {' + '.join(some)}" for name, some in parts if some)

    return said


def _unweighed(one: DriveSet) -> list[str]:
    return sorted(unknown_parts(one, "mass", one.mass_of))


def _power(name: str) -> Callable[[MachineSizing], float]:
    return lambda sizing: getattr(sizing.power, name) if sizing.power else nan


def _energy(sizing: MachineSizing) -> float:
    """Energy out of the supply over the machine's cycle [J]."""
    power = sizing.power
    cycle = next((one.value for one in power.figures if one.name == "machine_cycle"), nan) if power else nan
    return power.mean * cycle if power else nan


def _supply_none_fails(sizing: MachineSizing) -> float:
    """Probability that no limit of the common supply is exceeded; NaN without tolerances."""
    found = sizing.power.reliability if sizing.power else None
    return found.probability if found else nan


def _kinds(sizing: MachineSizing) -> int:
    return len({(one.best.motor.part, one.best.gearhead.part) for one in sizing.axes if one.best})


_MACHINE: tuple[_MachineColumn, ...] = (
    _MachineColumn(Column("drives", "whole"), lambda sizing: sum(one.drives for one in sizing.axes if one.best)),
    _MachineColumn(Column("kinds", "whole"), _kinds),  # of motor and gearhead
    _MachineColumn(Column("machine_mass_kg", "number", "kg"), _sum(lambda one: one.mass)),  # of motors and gearheads
    _MachineColumn(Column("mass_lacks", "text"), _lacking(_unweighed)),
    _MachineColumn(Column("machine_price_EUR", "number", "EUR"), _price),  # of all parts whose price is known
    _MachineColumn(Column("price_lacks", "text"), _lacking(lambda one: unknown_of(one, one.price_of))),
    _MachineColumn(Column("objective_si", "number"), lambda sizing: sizing.total),
    _MachineColumn(Column("energy_J", "number", "J"), _energy),
    _MachineColumn(Column("mean_W", "number", "W"), _power("mean")),
    _MachineColumn(Column("peak_W", "number", "W"), _power("peak")),
    _MachineColumn(Column("supply_none_fails", "number", "1"), _supply_none_fails),
)
_MARGIN = Column("smallest_margin", "number", "1"), Column("smallest_margin_check", "text")
_WHERE = Column("smallest_margin_axis", "text")
_ALL = "all"  # axes together


def machine_columns(members: Sequence[str]) -> tuple[Column, ...]:
    """Columns of a machine."""
    drives = (Column(f"{name}.set", "text") for name in members)
    return (*(one.column for one in _MACHINE), *_MARGIN, _WHERE, *drives)


def machine_row(head: Row, members: Sequence[str], sizing: MachineSizing) -> Row:
    """The row of a variant."""
    labels = {one.name: one.best.label for one in sizing.axes if one.best}
    counts = [one.result.counts for one in sizing.axes]
    return [
        *head, sizing.objective, 1 if sizing.status != "fail" else None, sizing.status,
        *(cell(column, of(sizing)) for column, of in _MACHINE), *_smallest_margin_of_axes(sizing),
        *(labels.get(name, "") for name in members),
        sum(one.considered for one in counts), sum(one.feasible for one in counts), _nearest(sizing), "",
    ]  # fmt: skip


def _smallest_margin_of_axes(sizing: MachineSizing) -> Row:
    """The smallest margin with its check and its axis; of an axis without a drive that of the closest rejected."""
    found = [(_worst_of(one), one.name) for one in sizing.axes]
    found.append((worst(tuple(check for check in sizing.checks if not check.advice)), _ALL))
    known = [(check.margin, check.name, name) for check, name in found if check]
    if not known:
        return [None, "", ""]
    margin, check, name = min(known, key=lambda one: one[0])
    return [cell(_MARGIN[0], margin), check, name]


def _worst_of(one: AxisSizing) -> Check | None:
    near = one.best or _closest(one)
    return worst(near.deciding) if near else None


def _closest(one: AxisSizing) -> DriveSet | None:
    """The closest rejected drive of an axis."""
    return next(iter((*one.result.unsure, *one.result.misses)), None)


def _nearest(sizing: MachineSizing) -> str:
    """The closest rejected drive of the first axis without one."""
    lost = next((one for one in sizing.axes if one.best is None), None)
    near = _closest(lost) if lost else None
    return f"{lost.name}: {near.label}" if lost and near else ""


# -- Columns of a study's table: the variant, and the drive found for it.
#
# A figure of a drive becomes a column by one line in ``_DRIVE``; by one more in ``maps.MAPS`` it is drawn as well.


class _DriveColumn(NamedTuple):
    """A column with a figure of a drive."""

    column: Column
    of: Callable[[DriveSet], Any]


def _number(head: str, of: Callable[[DriveSet], Any], unit: str = "") -> _DriveColumn:
    return _DriveColumn(Column(head, "number", unit), of)


def _text(head: str, of: Callable[[DriveSet], Any]) -> _DriveColumn:
    return _DriveColumn(Column(head, "text"), of)


def _name(part: Any, name: str) -> str:
    return str(getattr(part, name)) if part is not None else ""


def _mass_lacks(one: DriveSet) -> str:
    return " + ".join(sorted(unknown_parts(one, "mass", one.mass_of)))


def _price_lacks(one: DriveSet) -> str:
    return " + ".join(unknown_of(one, one.price_of))


def _figure(name: str) -> Callable[[DriveSet], float]:
    return lambda one: next((figure.value for figure in one.figures if figure.name == name), nan)


_DRIVE: tuple[_DriveColumn, ...] = (
    _text("set", lambda one: one.label),
    _text("motor_family", lambda one: one.motor.family),
    _text("motor_part", lambda one: one.motor.part),
    _text("gearhead_family", lambda one: one.gearhead.family),
    _text("gearhead_part", lambda one: one.gearhead.part),
    _number("gearhead_ratio", lambda one: one.gearhead.ratio, "1"),
    _number("belt_ratio", lambda one: one.belt_ratio, "1"),
    _text("belt_part", lambda one: _name(one.belt_drive.belt if one.belt_drive else None, "part")),
    _text("screw_part", lambda one: _name(one.chosen_screw.screw if one.chosen_screw else None, "part")),
    _text("brake_part", lambda one: _name(one.brake, "part")),
    _text("encoder_family", lambda one: _name(one.encoder, "family")),
    _text("encoder_part", lambda one: _name(one.encoder, "part")),
    _text("controller_family", lambda one: _name(one.controller, "family")),
    _text("controller_part", lambda one: _name(one.controller, "part")),
    _number("total_ratio", lambda one: one.total_ratio, "1"),
    _number("mass_kg", lambda one: one.mass, "kg"),  # as the objective counts it
    _text("mass_lacks", _mass_lacks),
    _number("price_EUR", lambda one: one.price, "EUR"),  # of all parts whose price is known
    _text("price_lacks", _price_lacks),
    _number("objective_si", lambda one: one.objective),
    _number("energy_J", _figure("energy"), "J"),
    _number("probability", lambda one: one.reliability.passing if one.reliability else nan, "1"),  # that all pass
    _number("none_fails", lambda one: one.reliability.probability if one.reliability else nan, "1"),
    _number(
        "probability_error", lambda one: one.reliability.error if one.reliability else nan, "1"
    ),  # of sampling, 95 %
)
_TOTALS = (
    Column("drives", "whole"),
    Column("machine_mass_kg", "number", "kg"),
    Column("machine_price_EUR", "number", "EUR"),
)
HEAD = Column("objective", "text"), Column("rank", "whole"), Column("status", "text")
_COUNTS = Column("sets_examined", "whole"), Column("sets_that_stand", "whole")
_LAST = Column("nearest_miss", "text"), Column("error", "text")


def columns_of(plan: Plan) -> tuple[Column, ...]:
    """The columns of a study's table."""
    spec = (Column("spec", "text"),) if len(plan.names) > 1 else ()
    catalogs = (Column("catalogs", "text"),) if any(plan.catalogs) else ()
    varied = tuple(Column(axis.head, _form(axis), axis.unit) for axis in plan.job.axes)
    return (Column("variant", "whole"), *spec, *varied, *catalogs, *_result(plan.job))


def _result(job: Job) -> tuple[Column, ...]:
    """The columns behind what varies: of a drive, or of a machine."""
    if job.machine and job.axis is None:
        own: tuple[Column, ...] = machine_columns(job.members)
    else:
        own = (*(one.column for one in _DRIVE), *_TOTALS, *_MARGIN)
    return (*HEAD, *own, *_COUNTS, *_LAST)


def _form(axis: Any) -> Form:
    if axis.kind:
        return "number"
    return "whole" if all(isinstance(axis.table_value(value), int) for value in axis.values) else "text"


def variant_rows(head: Row, best: Best) -> list[Row]:
    """Rows of a variant: one for each drive, or one with the check that the closest rejected drive fails most."""
    counts = [best.counts.considered, best.counts.feasible]
    if best.sets:
        return [
            [*head, best.objective, one.rank, one.status, *(cell(c, of(one)) for c, of in _DRIVE),
             *_machine_totals(one, best.drives), *_smallest_margin(one), *counts, "", ""]
            for one in best.sets
        ]  # fmt: skip
    near = best.nearest
    none = [None if column.form != "text" else "" for column in (*(one.column for one in _DRIVE), *_TOTALS)]
    margin = _smallest_margin(near) if near else [None, ""]
    return [[*head, best.objective, None, "fail", *none, *margin, *counts, near.label if near else "", ""]]


def failed(job: Job, head: Row, objective: str, message: str) -> list[Row]:
    """Row of a variant that is invalid or cannot be sized."""
    none = ["" if column.form == "text" else None for column in _result(job)[len(HEAD) : -1]]
    return [[*head, objective, None, "error", *none, message]]


def _machine_totals(one: DriveSet, drives: int) -> Row:
    """Number of drives of the machine, and mass and price of all of them."""
    return [drives, *(cell(c, drives * value) for c, value in zip(_TOTALS[1:], (one.mass, one.price), strict=True))]


def _smallest_margin(one: DriveSet) -> Row:
    """The smallest margin and its check."""
    check = worst(one.deciding)
    return [cell(_MARGIN[0], check.margin), check.name] if check else [None, ""]


# -- A study's table as CSV and as Parquet, written a chunk at a time and whole or not at all.
#
# CSV has units in its heads, as every table of this program. Parquet has the same heads, and each column's unit in
# its metadata; it needs pyarrow.


_GROUP = 50_000  # least number of rows that are written together to Parquet


def write_csv(path: Path, columns: Sequence[Column], chunks: Iterable[list[Row]]) -> None:
    """Write a table as CSV."""
    with _whole(path) as stream:
        text = io.TextIOWrapper(stream, "utf-8", newline="", write_through=True)
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow([csv_cell(column.head) for column in columns])
        for rows in chunks:
            writer.writerows([["" if cell is None else csv_cell(cell) for cell in row] for row in rows])
        text.detach()


def has_parquet() -> bool:
    """Whether pyarrow is installed."""
    return find_spec("pyarrow") is not None


def write_parquet(path: Path, columns: Sequence[Column], chunks: Iterable[list[Row]]) -> None:
    """Write a table as Parquet, with units in the metadata of its columns."""
    pyarrow: Any = import_module("pyarrow")
    parquet: Any = import_module("pyarrow.parquet")
    types = {"whole": pyarrow.int64(), "number": pyarrow.float64(), "text": pyarrow.string()}
    schema = pyarrow.schema([
        pyarrow.field(column.head, types[column.form], metadata={"unit": column.unit} if column.unit else None)
        for column in columns
    ])  # fmt: skip
    with _whole(path) as stream, parquet.ParquetWriter(stream, schema, compression="zstd") as writer:
        for rows in _grouped(chunks):
            arrays = [pyarrow.array([row[n] for row in rows], field.type) for n, field in enumerate(schema)]
            writer.write_table(pyarrow.table(arrays, schema=schema))


def _grouped(chunks: Iterable[list[Row]]) -> Iterator[list[Row]]:
    """Rows of several chunks together, so that a file has few row groups."""
    group: list[Row] = []
    for rows in chunks:
        group += rows
        if len(group) >= _GROUP:
            yield group
            group = []
    if group:
        yield group


@contextmanager
def _whole(path: Path) -> Iterator[BinaryIO]:
    """Stream to a temporary file that replaces the target when complete, for content larger than memory."""
    ready(path)
    if path.exists() and not path.is_file():  # a device or a pipe, which a file would take the place of
        raise InputError(f"{path}: cannot be written, it is no file; remove it, or choose another folder with -o")
    target = path.resolve()
    temporary = target.with_name(f"{target.name}.part")
    try:
        temporary.unlink(missing_ok=True)
        with temporary.open("xb") as stream:
            yield stream
        temporary.replace(target)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({reason_of(error)})") from None
    finally:
        temporary.unlink(missing_ok=True)
