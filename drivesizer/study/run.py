"""A study carried out: from its plan to its files."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from drivesizer.errors import InputError, reason_of
from drivesizer.files.writing import remove_files
from drivesizer.study.column import Column, Row
from drivesizer.study.columns import columns_of
from drivesizer.study.local import compute_on_processes, cores, started
from drivesizer.study.lock import locked
from drivesizer.study.plan import Plan
from drivesizer.study.provenance import made_of, refuse_if_all_invalid
from drivesizer.study.refine import refined
from drivesizer.study.store import Store, opened
from drivesizer.study.table import has_parquet, write_csv, write_parquet
from drivesizer.study.variant import Part

if TYPE_CHECKING:
    from drivesizer.study.maps import MapAxes

__all__ = ["Outcome", "carry_out"]

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
    from drivesizer.study.cluster import compute_on_cluster, connected

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
    from drivesizer.output.report.figure_files import figures_into
    from drivesizer.study.maps import MOST_POINTS, drawings, points

    if plan.total > MOST_POINTS:
        outcome.notes.append(f"no maps: more than {MOST_POINTS} variants; the tables have all")
        return
    found, left_out = drawings(chosen, points(plan, chosen, store.every_row()))
    if found:
        outcome.written += figures_into(found, store.maps)
    outcome.notes += left_out
