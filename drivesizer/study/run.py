"""A study carried out: from its plan to its files, refined where the best drive changes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drivesizer.errors import InputError, reason_of
from drivesizer.files.writing import remove_files
from drivesizer.study.columns import Column, Row, columns_of, has_parquet, write_csv, write_parquet
from drivesizer.study.local import compute_on_processes, cores, started
from drivesizer.study.plan import Places, Plan
from drivesizer.study.store import Store, locked, made_of, opened, refuse_if_all_invalid
from drivesizer.study.variant import Part

if TYPE_CHECKING:
    from drivesizer.study.maps import MapAxes

__all__ = ["carry_out", "refined"]


# -- Refinement of a study: its steps are halved where the best drive changes.
#
# A cell lies between neighbouring steps of all ranges, at one value of each other field. Where its corners differ in
# the best drive or its status, it is halved along each range: the points in the middle of its edges, sides and
# inside are sized, and its parts are cells of the next halving. Each round follows from the rows of those before, so
# a study that was stopped goes on with the same points.


_Found = dict[Places, tuple[Any, ...]]  # status and best drives of the variants of each point


def refined(plan: Plan, chunks: Iterable[list[Row]]) -> Plan | None:
    """The plan with the points of one more halving."""
    level = len(plan.rounds)
    if level >= plan.depth:
        return None
    found = _best_drives(plan, chunks)
    half = plan.parts >> level + 1
    new = {point for cell in _halved(plan, found, level) for point in _lattice(plan, cell, (0, half, 2 * half))}
    points = tuple(sorted(new - found.keys()))
    return replace(plan, rounds=(*plan.rounds, len(points)), added=(*plan.added, *points)) if points else None


def _best_drives(plan: Plan, chunks: Iterable[list[Row]]) -> _Found:
    heads = [column.head for column in columns_of(plan)]
    number, rank = heads.index("variant"), heads.index("rank")
    drives = {"set", *(f"{name}.set" for name in plan.job.members)}
    compared = [n for n, head in enumerate(heads) if head == "status" or head in drives]
    found: _Found = {}
    for rows in chunks:
        for row in rows:
            if row[rank] in (None, 1):
                _, places = plan.places((row[number] - 1) // plan.of_each)
                found[places] = (*found.get(places, ()), *(row[n] for n in compared))
    return found


def _halved(plan: Plan, found: _Found, level: int) -> list[Places]:
    """Cells whose corners differ, each by its first corner, after so many halvings."""
    size = plan.parts >> level
    cells: Iterable[Places] = _first_cells(plan)
    if level:
        cells = (part for cell in _halved(plan, found, level - 1) for part in _lattice(plan, cell, (0, size)))
    return [cell for cell in cells if len({found[point] for point in _lattice(plan, cell, (0, size))}) > 1]


def _first_cells(plan: Plan) -> Iterable[Places]:
    return product(*(
        range(0, (len(axis.values) - 1) * plan.parts, plan.parts) if axis.stepped else range(len(axis.values))
        for axis in plan.job.axes
    ))  # fmt: skip


def _lattice(plan: Plan, cell: Places, offsets: Sequence[int]) -> Iterable[Places]:
    """Points at all combinations of some offsets from a cell's first corner, along the ranges."""
    axes = zip(plan.job.axes, cell, strict=True)
    return product(*([place + one for one in offsets] if axis.stepped else [place] for axis, place in axes))


# -- A study carried out: from its plan to its files.


Progress = Callable[[int, int], None]  # variants that are done, variants in all
Compute = Callable[[Plan, Sequence[int]], Iterator[tuple[int, Part]]]
_OWN = {"lock", "lock.txt", "chunks", "maps", "results.csv", "results.parquet", "study.json"}


@dataclass
class Outcome:
    """Outcome of a study."""

    written: list[Path] = field(default_factory=list)
    variants: Counter[str] = field(default_factory=Counter)  # by the status of the best drive
    examined: int = 0  # drives
    notes: list[str] = field(default_factory=list)


def carry_out(
    plan: Plan,
    folder: Path,
    *,
    processes: int = 0,
    scheduler: str | None = None,
    fresh: bool = False,
    maps: Sequence[str] | None = (),
    progress: Progress | None = None,
) -> Outcome:
    """Size every variant that is not sized yet, and write tables and maps."""
    origin, outcome = made_of(plan), Outcome()
    over = None if maps is None else _over(plan, maps)
    _usable(folder)
    if fresh or not (folder / "study.json").exists():
        note = refuse_if_all_invalid(plan)
        outcome.notes += [note] if note else []
    most = processes or cores()
    with _workers(most if plan.depth else min(most, plan.chunks), scheduler) as compute:  # rounds may have more chunks
        _made(folder)
        with locked(folder):
            store = opened(folder, plan, origin, fresh=fresh)
            plan, store = _rounds(plan, store, compute, progress)
            _tables(plan, store, outcome)
            if over is not None:
                _maps(plan, store, over, outcome)
    return outcome


def _usable(folder: Path) -> None:
    """Refuse a folder that cannot be created, is a file, or holds other files."""
    try:
        folder.stat()  # is_dir gives False for a name that is too long, in Python 3.14
        if not folder.is_dir():
            raise InputError(f"{folder}: is a file; expected a folder for the results, -o names another")
        names = {path.name for path in folder.iterdir()}
    except (FileNotFoundError, NotADirectoryError):
        names = set()
    except OSError as error:
        raise InputError(f"{folder}: cannot be read ({reason_of(error)})") from None
    if not folder.parent.is_dir():
        raise InputError(f"{folder}: cannot be made, there is no folder {folder.parent}")
    foreign = sorted(names - _OWN)
    if foreign and "study.json" not in names:
        raise InputError(
            f"{folder}: holds other files, such as {foreign[0]}; expected a new or empty folder, -o names one"
        )


def _made(folder: Path) -> None:
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be made ({reason_of(error)})") from None


@contextmanager
def _workers(processes: int, scheduler: str | None) -> Iterator[Compute]:
    """Function that computes chunks; a scheduler is reached before anything is written."""
    if scheduler is None:
        with started(processes) as pool:
            yield lambda plan, chunks: compute_on_processes(plan, chunks, pool)
        return
    from drivesizer.study.local import compute_on_cluster, connected

    with connected(scheduler) as client:
        yield lambda plan, chunks: compute_on_cluster(client, plan, chunks)


def _rounds(plan: Plan, store: Store, compute: Compute, progress: Progress | None) -> tuple[Plan, Store]:
    """Compute the study and its refinement; both with all points."""
    _compute(plan, store, compute, progress)
    while finer := refined(plan, store.every_row()):
        plan, store = finer, replace(store, chunks=finer.chunks)
        _compute(plan, store, compute, progress)
    return plan, store


def _compute(plan: Plan, store: Store, compute: Compute, progress: Progress | None) -> None:
    """Compute the missing chunks, and store each when it is complete."""
    missing = store.missing()
    done = plan.total - sum(plan.size(chunk) for chunk in missing)
    if not missing:
        return
    if progress:
        progress(done, plan.total)
    for chunk, part in compute(plan, missing):
        store.keep(chunk, part)
        done += plan.size(chunk)
        if progress:
            progress(done, plan.total)


def _tables(plan: Plan, store: Store, outcome: Outcome) -> None:
    columns, (as_csv, as_parquet) = columns_of(plan), store.results
    write_csv(as_csv, columns, _row_count(columns, store, outcome))
    outcome.written.append(as_csv)
    if has_parquet():
        write_parquet(as_parquet, columns, store.every_row())
        outcome.written.append(as_parquet)
    else:
        remove_files([as_parquet])
        outcome.notes.append("no results.parquet, which needs pyarrow: install drivesizer[study]")


def _row_count(columns: Sequence[Column], store: Store, outcome: Outcome) -> Iterator[list[Row]]:
    """All rows; variants are counted meanwhile."""
    heads = [column.head for column in columns]
    status, rank, examined = (heads.index(name) for name in ("status", "rank", "sets_examined"))
    for rows in store.every_row():
        for row in rows:
            if row[rank] in (None, 1):
                outcome.variants[row[status]] += 1
                outcome.examined += row[examined] or 0
        yield rows


def _over(plan: Plan, names: Sequence[str]) -> MapAxes | None:
    """The fields that maps are over; drawing is loaded where there are any."""
    from drivesizer.study.maps import map_axes

    return map_axes(plan, names)


def _maps(plan: Plan, store: Store, chosen: MapAxes, outcome: Outcome) -> None:
    from drivesizer.output.report.figures.all_figures import figures_into
    from drivesizer.study.maps import MOST_POINTS, drawings, points

    if plan.total > MOST_POINTS:
        outcome.notes.append(f"no maps: more than {MOST_POINTS} variants; the tables have all")
        return
    found, left_out = drawings(chosen, points(plan, chosen, store.every_row()))
    if found:
        outcome.written += figures_into(found, store.maps)
    outcome.notes += left_out
