"""A study carried out: from its plan to its files, refined where the best drive changes.

A cell lies between neighbouring steps of all ranges, at one value of each other field. Where its corners differ in the
best drive or its status, it is halved along each range: the points in the middle of its edges, sides and inside are
sized, and its parts are cells of the next halving. Each round follows from the rows of those before, so a study that
was stopped goes on with the same points.
"""

from __future__ import annotations

import asyncio
import logging
import multiprocessing
import os
import signal
import sys
import threading
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from itertools import chain, islice, product
from math import isnan, nan
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, quoted
from drivesizer.files.yaml_source import source_of, written
from drivesizer.physics.extremes import undominated
from drivesizer.results.sizing import frame_of
from drivesizer.spec.robot import RobotSpec
from drivesizer.study import store as folders
from drivesizer.study.figures import row_figures
from drivesizer.study.plan import MOST, Job, Places, Plan, Variant, planned
from drivesizer.study.rows import Column, Part, Row, columns_of, forget_files, rows_of, spec_figures

if TYPE_CHECKING:
    from drivesizer.output.report.figures.style import Drawing

_GOOD = ("pass", "open", "unknown")
_PARTS = 10  # of a sampled range, for its influence
INFLUENCE = (
    Column("figure", "text"), Column("field", "text"), Column("share"),
    Column("least_mean"), Column("least_at", "text"), Column("most_mean"), Column("most_at", "text"),
)  # fmt: skip


Table = tuple[str, Sequence[Column], list[Row]]  # name of the file, columns, rows


def answers(plan: Plan, rows: Callable[[], Iterable[Row]]) -> list[Table]:
    """Tables that a study wants: their figures are made in one pass over all rows, and the rows picked in another."""
    goals, columns, axes = plan.answers, columns_of(plan), plan.job.axes
    figures = [*goals.front, *goals.influence, *([goals.by] if goals.by else [])]
    if not figures:
        return []
    heads = [column.head for column in columns]
    places = [heads.index(axis.head) for axis in axes]
    places += [heads.index(head) for head in ("spec", "catalogs", "objective") if head in heads]
    status, values, cells = heads.index("status"), list[list[float]](), list[list[Any]]()
    for row in rows():
        figure = row_figures(heads, row, spec_figures(plan.job, plan.variant(row[0])))
        values.append([goal.value(figure) if row[status] in _GOOD else nan for goal in figures])
        cells.append([row[place] for place in places])
    table, numbers = np.array(values).reshape(-1, len(figures)), dict[str, list[int]]()
    if goals.by:
        kept = [n for n in range(len(places)) if n >= len(axes) or axes[n].name not in goals.over]
        numbers["best.csv"] = _best(table[:, -1], [tuple(row[n] for n in kept) for row in cells])
    if goals.front:
        numbers["front.csv"] = _front(table[:, : len(goals.front)])
    of_tables = {n for few in numbers.values() for n in few}
    picked = {n: row for n, row in enumerate(rows()) if n in of_tables} if of_tables else {}
    tables: list[Table] = [(name, columns, [picked[n] for n in few]) for name, few in numbers.items()]
    if goals.influence:
        of = table[:, len(goals.front) :]
        lines = [_influence(plan, goal.text, of[:, n], cells) for n, goal in enumerate(goals.influence)]
        tables.append(("influence.csv", INFLUENCE, [*chain(*lines)]))
    return tables


def _best(values: NDArray[np.float64], keys: Sequence[tuple[Any, ...]]) -> list[int]:
    """Place of the least value of each key; of equal ones that of the first."""
    best: dict[tuple[Any, ...], int] = {}
    for n, key in enumerate(keys):
        if not isnan(values[n]) and (key not in best or values[n] < values[best[key]]):
            best[key] = n
    return [*best.values()]


def _front(values: NDArray[np.float64]) -> list[int]:
    """Places of rows that no other beats in all goals, in the order of the first."""
    known = np.flatnonzero(~np.isnan(values).any(axis=1))
    front = known[undominated(-values[known])] if len(known) else known
    return sorted(front.tolist(), key=lambda n: tuple(values[n]))


def _influence(plan: Plan, figure: str, values: NDArray[np.float64], cells: Sequence[Sequence[Any]]) -> list[Row]:
    """Share of the variance of a figure that each field alone explains, and its means at both extremes.

    The correlation ratio, which of a full grid is the first-order index of Sobol (Saltelli et al., *Global Sensitivity
    Analysis*, Wiley 2008, section 4.5); of samples without what chance explains (Kelley, *PNAS* 21 (1935), p. 554),
    a range in ten parts.
    """
    known = np.flatnonzero(~np.isnan(values)).tolist()
    lines = list[Row]()
    for n, axis in enumerate(plan.job.axes if known else ()):
        own = [cells[row][n] for row in known]
        group, names = _parts(own) if axis.continuous else _groups(own)
        count = np.bincount(group)
        means = np.bincount(group, values[known]) / count
        mean, least, most = values[known].mean(), int(means.argmin()), int(means.argmax())
        whole = float(((values[known] - mean) ** 2).sum())
        share = float((count * (means - mean) ** 2).sum()) / whole if whole > 0.0 else 0.0
        if plan.shares is not None and len(known) > len(count):
            share = max(1.0 - (1.0 - share) * (len(known) - 1) / (len(known) - len(count)), 0.0)
        ends = (float(f"{means[least]:.12g}"), names[least], float(f"{means[most]:.12g}"), names[most])
        lines.append([figure, axis.name, round(share, 6), *ends])
    return sorted(lines, key=lambda line: (-line[2], line[1]))


def _groups(cells: Sequence[Any]) -> tuple[NDArray[np.int64], list[str]]:
    """The group of each cell, those of equal values, and the value of each group."""
    numeric = all(isinstance(cell, int | float) for cell in cells)
    names = [*dict.fromkeys(sorted(cells) if numeric else cells)]
    place = {cell: n for n, cell in enumerate(names)}
    return np.array([place[cell] for cell in cells]), [f"{name:g}" if numeric else str(name) for name in names]


def _parts(cells: Sequence[float]) -> tuple[NDArray[np.int64], list[str]]:
    """The group of each figure, ten of as many each, and the mean of each group."""
    figures = np.array(cells, float)
    group = np.argsort(np.argsort(figures, kind="stable"), kind="stable") * _PARTS // len(cells)
    return group, [f"{figures[group == n].mean():.4g}" for n in range(int(group.max()) + 1)]


_TASKS = 128  # at least, where there are as many points
_TRIAL_VARIANTS = 200  # variants, to find a valid one


@dataclass
class Outcome:
    """Outcome of a study."""

    written: list[Path] = field(default_factory=list)
    variants: Counter[str] = field(default_factory=Counter)  # by the status of the best drive
    examined: int = 0  # drives
    notes: list[str] = field(default_factory=list)
    columns: Sequence[Column] = ()
    every_row: Callable[[], Iterator[Row]] = lambda: iter(())
    answers: list[Table] = field(default_factory=list)
    maps: dict[str, Drawing] = field(default_factory=dict)
    plan: Plan | None = None  # with what refinement added


def carry_out(
    plan: Plan,
    folder: Path,
    *,
    processes: int = 0,
    scheduler: str | None = None,
    fresh: bool = False,
    maps: Sequence[str] | None = (),
    chunks: bool = False,
    progress: Progress | None = None,
) -> Outcome:
    """Size every variant that is not sized yet, and write tables and maps; in chunks workers write the rows."""
    if chunks and not folders.has_parquet():
        raise InputError("--chunks needs pyarrow; install drivesizer[study]")
    if not chunks and plan.total > MOST:
        raise InputError(f"{plan.source.name}: makes {plan.total} variants; expected at most {MOST}, more by --chunks")
    forget_files()
    origin, outcome, over = folders.made_of(plan), Outcome(), None
    if maps is not None:
        from drivesizer.study.maps import map_axes

        over = map_axes(plan, maps)
    folders.usable(folder)
    if fresh or not (folder / "study.json").exists():
        note = refuse_if_all_invalid(plan)
        outcome.notes += [note] if note else []
    most = processes or cores()
    with workers(most if plan.depth else min(most, plan.points), scheduler) as on, folders.locked(folder):
        store = (folders.Chunks if chunks else folders.Store)(folder, plan, origin, fresh=fresh)
        _compute(plan, store, on, progress)
        while finer := refined(plan, store.every_row(plan.every_point)):
            plan = finer
            _compute(plan, store, on, progress)
        outcome.columns, outcome.every_row = columns_of(plan), partial(store.every_row, plan.every_point)
        outcome.written, notes = store.write(outcome.columns, _counted(outcome), outcome.every_row)
        outcome.notes += notes
        outcome.answers = answers(plan, outcome.every_row)
        for name, heads, rows in outcome.answers:
            folders.write_csv(folder / name, heads, rows)
            outcome.written.append(folder / name)
        if over is not None:
            from drivesizer.output.report.figures.all_figures import figures_into
            from drivesizer.study.maps import drawn_maps

            outcome.maps, notes = drawn_maps(plan, outcome.every_row(), over)
            outcome.written += figures_into(outcome.maps, folder / "maps") if outcome.maps else []
            outcome.notes += notes
        outcome.plan = plan
    return outcome


def refuse_if_all_invalid(plan: Plan) -> str:
    """Size variants until one is valid."""
    heads = [column.head for column in columns_of(plan)]
    few, first = range(1, plan.total + 1, -(-plan.total // _TRIAL_VARIANTS)), ""
    for number in few:
        row = dict(zip(heads, rows_of(plan.job, [plan.variant(number)]).rows[0], strict=True))
        if row["status"] != "error":
            return ""
        first = first or str(row["error"])
    if len(few) == plan.total:
        raise InputError(f"{plan.source.name}: all of its variants are invalid ({plan.total}); the first: {first}")
    return f"each of {len(few)} variants tried is invalid, the first: {first}"


def _compute(plan: Plan, store: folders.Store, on: Workers | None, progress: Progress | None) -> None:
    """Compute the points that are missing, several in a task, and store each task when it is complete."""
    stretches = store.missing(plan.every_point)
    several = min(max(plan.points * plan.of_each // _TASKS, 1), store.most_of_task)
    per_task = max(several // plan.of_each, 1)
    tasks = (
        [variant for point in stretch[n : n + per_task].tolist() for variant in plan.point(point)]
        for stretch in stretches
        for n in range(0, len(stretch), per_task)
    )
    missing = sum(map(len, stretches))
    done = plan.total - missing * plan.of_each
    if missing and progress:
        progress(done, plan.total)
    for part in computed(plan.job, tasks, on, store.computation(plan)):
        store.keep(part)
        done += part.variants
        if progress:
            progress(done, plan.total)


def refined(plan: Plan, rows: Iterable[Row]) -> Plan | None:
    """The plan with the points of one more halving."""
    level = len(plan.rounds)
    if level >= plan.depth:
        return None
    heads = [column.head for column in columns_of(plan)]
    number, rank = heads.index("variant"), heads.index("rank")
    drives = {"status", "set", *(f"{name}.set" for name in plan.job.members)}
    compared = [n for n, head in enumerate(heads) if head in drives]
    outcomes: dict[Places, tuple[Any, ...]] = {}  # status and best drives of the variants of each point
    for row in rows:
        if row[rank] in (None, 1):
            _, places = plan.places((row[number] - 1) // plan.of_each)
            outcomes[places] = (*outcomes.get(places, ()), *(row[n] for n in compared))

    def lattice(cell: Places, *offsets: int) -> Iterable[Places]:
        """Points at all combinations of some offsets from a cell's first corner, along the ranges."""
        axes = zip(plan.job.axes, cell, strict=True)
        return product(*([place + offset for offset in offsets] if axis.stepped else [place] for axis, place in axes))

    def halved(level: int) -> list[Places]:
        """Cells whose corners differ, each by its first corner, after so many halvings."""
        size = plan.parts >> level
        cells: Iterable[Places] = product(*(
            range(0, (len(axis.values) - 1) * plan.parts, plan.parts) if axis.stepped else range(len(axis.values))
            for axis in plan.job.axes
        ))  # fmt: skip
        if level:
            cells = (part for cell in halved(level - 1) for part in lattice(cell, 0, size))
        return [cell for cell in cells if len({outcomes[point] for point in lattice(cell, 0, size)}) > 1]

    half = plan.parts >> level + 1
    new = {point for cell in halved(level) for point in lattice(cell, 0, half, 2 * half)}
    points = tuple(sorted(new - outcomes.keys()))
    return replace(plan, rounds=(*plan.rounds, len(points)), added=(*plan.added, *points)) if points else None


def _counted(outcome: Outcome) -> Iterator[Row]:
    """All rows; variants are counted meanwhile."""
    heads = [column.head for column in outcome.columns]
    status, rank, examined = (heads.index(name) for name in ("status", "rank", "sets_examined"))
    for row in outcome.every_row():
        if row[rank] in (None, 1):
            outcome.variants[row[status]] += 1
            outcome.examined += row[examined] or 0
        yield row


# -- A study as a call.


@dataclass(frozen=True)
class Variants:
    """The rows of a study."""

    columns: tuple[str, ...]
    table: list[Row]
    answers: dict[str, list[dict[str, Any]]]  # best, front and influence, where they are wanted

    def rows(self) -> list[dict[str, Any]]:
        """Each row by its columns."""
        return [dict(zip(self.columns, row, strict=True)) for row in self.table]

    def to_frame(self) -> Any:
        """The rows as a data frame of pandas."""
        return frame_of(self.rows())

    def __str__(self) -> str:
        status, rank = (self.columns.index(name) for name in ("status", "rank"))
        count = Counter(row[status] for row in self.table if row[rank] in (None, 1))
        return f"{count.total()} variants: {', '.join(f'{n} {name}' for name, n in sorted(count.items()))}"


def size_variants(
    spec: str | Path | Mapping[str, Any] | RobotSpec,
    vary: Mapping[str, Any],
    *,
    processes: int = 1,
    folder: str | Path | None = None,
    **more: Any,
) -> Variants:
    """Size every variant of a spec: a study as a call.

    Parameters
    ----------
    spec
        A file, the same fields as a dict, or a spec that was read.
    vary
        By field, as in a study's file: a list, or a range with steps.
    processes
        That share the work; 0 is one for each core.
    folder
        Where the rows are kept, so that the same call goes on from there.
    more
        Further fields of a study: objectives, sampling, derive, require, best, front, influence.

    Returns
    -------
    Variants
        Its rows, also as a data frame.

    Raises
    ------
    InputError
        When a field or a value is wrong: one line.
    """
    source = spec.source if isinstance(spec, RobotSpec) else source_of(spec)
    plan = planned(written({"spec": "spec", "vary": dict(vary), **more}, "study"), Path(), {"spec": source})
    with TemporaryDirectory() if folder is None else nullcontext(str(folder)) as place:
        target = Path(place) / "study" if folder is None else Path(place)
        done = carry_out(plan, target, processes=processes, maps=None)
        tables = {
            name.removesuffix(".csv"): [dict(zip((column.head for column in heads), row, strict=True)) for row in rows]
            for name, heads, rows in done.answers
        }
        return Variants(tuple(column.head for column in done.columns), list(done.every_row()), tables)


# -- Workers that compute the variants of a study: this process, others of this machine, or those of a Dask scheduler.


Progress = Callable[[int, int], None]  # variants or machines that are done, and all there are to be
_SINGLE = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
_PATIENCE = 5.0  # s, for a scheduler to answer, and for a worker to be there


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Workers(NamedTuple):
    """An executor, and what its failures mean."""

    executor: Executor
    ahead: int  # tasks that wait for it
    refusal: Callable[[BaseException], str]  # nothing where the program is at fault


def computed(
    job: Job,
    tasks: Iterable[list[Variant]],
    on: Workers | None,
    compute: Callable[[Job, Sequence[Variant]], Part] = rows_of,
) -> Iterator[Part]:
    """Compute the variants of each task, here where there are no workers; rows come in the order of completion."""
    if on is None:
        yield from (compute(job, task) for task in tasks)
        return
    waiting, running = iter(tasks), set[Future[Part]]()
    try:
        while True:
            few = islice(waiting, on.ahead - len(running))
            running |= {on.executor.submit(compute, job.sent, task) for task in few}
            if not running:
                return
            done, running = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                yield future.result()
    except Exception as error:
        if reason := on.refusal(error):
            raise InputError(reason) from None
        raise


@contextmanager
def workers(processes: int, scheduler: str | None) -> Iterator[Workers | None]:
    """Workers by their number, or of a scheduler that has some; it is reached before anything is written."""
    if scheduler is not None:
        client = _client(scheduler)
        try:
            ahead = 4 * max(sum(client.nthreads().values()), 1)
            with client.get_executor(pure=False, retries=3) as executor:  # others take over the tasks of a lost worker
                yield Workers(executor, ahead, lambda error: _lost(error, scheduler))
        finally:
            client.close(timeout=_PATIENCE)
        return
    if processes == 1:
        yield None
        return
    # copies of this process are there at once; it is copied where none of its threads may hold a lock
    single = threading.active_count() == 1 and all(os.environ.get(name) == "1" for name in _SINGLE)
    copied, others = single and sys.platform == "linux", multiprocessing.active_children()
    context: Any = multiprocessing.get_context("fork" if copied else "spawn")
    with one_thread_each(), ProcessPoolExecutor(processes, context, _initialise) as pool:
        if copied:  # all of them now, before this one takes the study's lock; Ctrl-C is for the parent alone
            before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
            pool.submit(int)
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        try:
            yield Workers(pool, 2 * processes, _ended)
        except BaseException:
            for child in multiprocessing.active_children():
                if child not in others:
                    child.terminate()  # interrupted: their results are not awaited
            raise


@contextmanager
def one_thread_each() -> Iterator[None]:
    """Let processes that start inside compute on one thread each, and this one where it has not loaded NumPy yet."""
    before = {name: os.environ.get(name) for name in _SINGLE}
    os.environ.update(dict.fromkeys(_SINGLE, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})


def _initialise() -> None:
    """Initialise a process: ignore Ctrl-C, which its parent handles, and end with its parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is None:
        return

    def end() -> None:  # otherwise a process whose parent was killed would wait without limit
        parent.join()
        os._exit(1)

    threading.Thread(target=end, daemon=True).start()


def _ended(error: BaseException) -> str:
    """The refusal for a pool of processes that ended from outside."""
    return (
        "a process that computes variants was ended from outside, such as for want of memory; results so far are "
        "kept: the same command resumes, --processes sets their number"
    ) * isinstance(error, BrokenProcessPool)


def _lost(error: BaseException, address: str) -> str:
    """The refusal for a scheduler or a worker that is lost, or has another program."""
    if isinstance(error, ImportError | AttributeError | TypeError):
        return f"{address}: its workers cannot compute this ({_brief(error)}); install the same drivesizer there"
    if isinstance(error, (CancelledError, OSError, import_module("distributed").KilledWorker)):
        return (  # a closed connection is an OSError
            f"{address}: scheduler or workers were lost ({_brief(error)}); results so far are kept: the same command "
            "resumes"
        )
    return ""


def _client(address: str) -> Any:
    """A client of the scheduler that has a worker."""
    if find_spec("distributed") is None:
        raise InputError("--scheduler needs Dask; install drivesizer[cluster]")
    dask = import_module("distributed")  # first, for it sets log levels
    for name in ("distributed", "distributed.client", "tornado", "tornado.application"):  # replaced by a one-line error
        logging.getLogger(name).setLevel(logging.CRITICAL)

    async def identity() -> dict[str, Any]:
        comm = await import_module("distributed.comm").connect(address, timeout=_PATIENCE)
        try:
            await comm.write({"op": "identity", "reply": True})
            return dict(await comm.read())
        finally:
            comm.abort()

    expected = "expected a Dask scheduler's address, e.g. tcp://10.0.0.5:8786"
    try:
        reply = asyncio.run(asyncio.wait_for(identity(), _PATIENCE + 1.0))
    except Exception as error:  # an unknown server may answer anything
        raise InputError(f"--scheduler: {quoted(address)} does not answer ({_brief(error)}); {expected}") from None
    if reply.get("type") != "Scheduler":
        raise InputError(f"--scheduler: {quoted(address)} is a {reply.get('type', 'server')}; {expected}")
    client = dask.Client(address, timeout=_PATIENCE, set_as_default=False)
    try:
        client.wait_for_workers(1, timeout=_PATIENCE)
    except (OSError, TimeoutError):
        client.close(timeout=_PATIENCE)
        raise InputError(f"{address}: has no worker; `dask worker {address}` starts one") from None
    return client


def _brief(error: BaseException) -> str:
    text = " ".join(str(error).split()) or type(error).__name__
    return text if len(text) <= 120 else text[:119] + "…"
