"""A study carried out: from its plan to its files, refined where the best drive changes.

A cell lies between neighbouring steps of all ranges, at one value of each other field. Where its corners differ in the
best drive or its status, it is halved along each range: the points in the middle of its edges, sides and inside are
sized, and its parts are cells of the next halving. Each round follows from the rows of those before, so a study that
was stopped goes on with the same points.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from pathlib import Path
from typing import Any

from drivesizer.errors import InputError, reason_of
from drivesizer.files.writing import remove_files
from drivesizer.study.plan import Places, Plan
from drivesizer.study.rows import Column, Row, columns_of
from drivesizer.study.store import (
    Store,
    has_parquet,
    locked,
    made_of,
    opened,
    refuse_if_all_invalid,
    write_csv,
    write_parquet,
)  # fmt: skip
from drivesizer.study.workers import Workers, computed, cores, workers

Progress = Callable[[int, int], None]  # variants that are done, variants in all
_OWN = {"lock", "lock.txt", "chunks", "maps", "results.csv", "results.parquet", "study.json"}


def refined(plan: Plan, chunks: Iterable[list[Row]]) -> Plan | None:
    """The plan with the points of one more halving."""
    level = len(plan.rounds)
    if level >= plan.depth:
        return None
    heads = [column.head for column in columns_of(plan)]
    number, rank = heads.index("variant"), heads.index("rank")
    drives = {"status", "set", *(f"{name}.set" for name in plan.job.members)}
    compared = [n for n, head in enumerate(heads) if head in drives]
    found: dict[Places, tuple[Any, ...]] = {}  # status and best drives of the variants of each point
    for rows in chunks:
        for row in rows:
            if row[rank] in (None, 1):
                _, places = plan.places((row[number] - 1) // plan.of_each)
                found[places] = (*found.get(places, ()), *(row[n] for n in compared))

    def lattice(cell: Places, *offsets: int) -> Iterable[Places]:
        """Points at all combinations of some offsets from a cell's first corner, along the ranges."""
        axes = zip(plan.job.axes, cell, strict=True)
        return product(*([place + one for one in offsets] if axis.stepped else [place] for axis, place in axes))

    def halved(level: int) -> list[Places]:
        """Cells whose corners differ, each by its first corner, after so many halvings."""
        size = plan.parts >> level
        cells: Iterable[Places] = product(*(
            range(0, (len(axis.values) - 1) * plan.parts, plan.parts) if axis.stepped else range(len(axis.values))
            for axis in plan.job.axes
        ))  # fmt: skip
        if level:
            cells = (part for cell in halved(level - 1) for part in lattice(cell, 0, size))
        return [cell for cell in cells if len({found[point] for point in lattice(cell, 0, size)}) > 1]

    half = plan.parts >> level + 1
    new = {point for cell in halved(level) for point in lattice(cell, 0, half, 2 * half)}
    points = tuple(sorted(new - found.keys()))
    return replace(plan, rounds=(*plan.rounds, len(points)), added=(*plan.added, *points)) if points else None


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
    origin, outcome, over = made_of(plan), Outcome(), None
    if maps is not None:
        from drivesizer.study.maps import map_axes

        over = map_axes(plan, maps)
    _usable(folder)
    if fresh or not (folder / "study.json").exists():
        note = refuse_if_all_invalid(plan)
        outcome.notes += [note] if note else []
    most = processes or cores()
    with workers(most if plan.depth else min(most, plan.chunks), scheduler) as on:  # rounds may have more chunks
        try:
            folder.mkdir(exist_ok=True)
        except OSError as error:
            raise InputError(f"{folder}: cannot be made ({reason_of(error)})") from None
        with locked(folder):
            store = opened(folder, plan, origin, fresh=fresh)
            _compute(plan, store, on, progress)
            while finer := refined(plan, store.every_row()):
                plan, store = finer, replace(store, chunks=finer.chunks)
                _compute(plan, store, on, progress)
            columns, (as_csv, as_parquet) = columns_of(plan), store.results
            write_csv(as_csv, columns, _counted(columns, store, outcome))
            outcome.written.append(as_csv)
            if has_parquet():
                write_parquet(as_parquet, columns, store.every_row())
                outcome.written.append(as_parquet)
            else:
                remove_files([as_parquet])
                outcome.notes.append("no results.parquet, which needs pyarrow: install drivesizer[study]")
            if over is not None:
                from drivesizer.study.maps import draw_maps

                written, notes = draw_maps(plan, store.every_row(), over, store.maps)
                outcome.written += written
                outcome.notes += notes
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


def _compute(plan: Plan, store: Store, on: Workers, progress: Progress | None) -> None:
    """Compute the missing chunks, and store each when it is complete."""
    missing = store.missing()
    done = plan.total - sum(plan.size(chunk) for chunk in missing)
    if missing and progress:
        progress(done, plan.total)
    for chunk, part in computed(plan, missing, on) if missing else ():
        store.keep(chunk, part)
        done += plan.size(chunk)
        if progress:
            progress(done, plan.total)


def _counted(columns: Sequence[Column], store: Store, outcome: Outcome) -> Iterator[list[Row]]:
    """All rows; variants are counted meanwhile."""
    heads = [column.head for column in columns]
    status, rank, examined = (heads.index(name) for name in ("status", "rank", "sets_examined"))
    for rows in store.every_row():
        for row in rows:
            if row[rank] in (None, 1):
                outcome.variants[row[status]] += 1
                outcome.examined += row[examined] or 0
        yield rows
