"""Variants computed by processes of this machine, one thread each, or by the workers of a Dask scheduler."""

from __future__ import annotations

import asyncio
import logging
import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec
from itertools import islice
from typing import Any, NamedTuple

from drivesizer.errors import InputError, quoted
from drivesizer.study.columns import Row
from drivesizer.study.plan import Job, Plan, Variant
from drivesizer.study.variant import Part, rows_of

__all__ = ["compute_on_cluster", "compute_on_processes", "connected", "cores", "one_thread_each", "started", "tasks"]


# -- Threads of a study's processes: one each, for there is one process for each core.
#
# Loaded before NumPy, whose linear algebra takes as many threads as the environment says when it is loaded.


_SINGLE = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


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


def can_be_copied() -> bool:
    """Whether this process can be copied: it has one thread, and its system copies what it has loaded.

    It is so inside of a ``one_thread_each`` that was there before NumPy.
    """
    single = all(os.environ.get(name) == "1" for name in _SINGLE)
    return sys.platform == "linux" and single and threading.active_count() == 1


# -- Variants computed by processes of this machine.


Task = tuple[int, list[Variant], list[Row]]  # chunk, its variants, and the first cells of their rows
_AHEAD = 2  # pending chunks for each process


def tasks(plan: Plan, chunks: Iterable[int]) -> Iterator[Task]:
    """Tasks of some chunks, made one at a time."""
    for chunk in chunks:
        variants = plan.variants(chunk)
        yield chunk, variants, [plan.head(variant) for variant in variants]


def cores() -> int:
    """Number of processor cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Pool(NamedTuple):
    """Processes that compute variants."""

    executor: ProcessPoolExecutor
    processes: int


@contextmanager
def started(processes: int) -> Iterator[Pool]:
    """Processes to compute on, where they can be copies of this one started at once.

    That is to be before this process takes the study's lock, which its copies would hold as well.
    """
    copied, others = can_be_copied(), multiprocessing.active_children()
    context = multiprocessing.get_context("fork") if copied else _context()
    with one_thread_each(), ProcessPoolExecutor(processes, context, _initialise) as pool:
        if copied:
            with _uninterrupted():
                pool.submit(int)  # the first task starts all of them
        try:
            yield Pool(pool, processes)
        except BaseException:
            for child in multiprocessing.active_children():
                if child not in others:
                    child.terminate()  # interrupted: their results are not awaited
            raise


def compute_on_processes(plan: Plan, chunks: Sequence[int], pool: Pool) -> Iterator[tuple[int, Part]]:
    """Compute chunks; they are yielded in the order of completion."""
    pending, job = tasks(plan, chunks), plan.job.sent
    try:
        running = {_submit(pool, job, task): task[0] for task in islice(pending, _AHEAD * pool.processes)}
        while running:
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                running |= {_submit(pool, job, task): task[0] for task in islice(pending, 1)}
                yield running.pop(future), future.result()
    except BrokenProcessPool:
        raise InputError(
            "a process that computes variants was ended from outside, such as for want of memory; results so "
            "far are kept: the same command resumes, --processes sets their number"
        ) from None


def _context() -> Any:
    """Start of processes: as copies of one that has the program loaded; where a system has no copies, each anew.

    A copy of this process would have its threads' locks as they are.
    """
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([rows_of.__module__])
    return context


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Keep Ctrl-C until processes have started, of which each leaves it to its parent from its first moment."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _submit(pool: Pool, job: Job, task: Task) -> Future[Part]:
    return pool.executor.submit(rows_of, job, *task[1:])


def _initialise() -> None:
    """Initialise a process: ignore Ctrl-C, which its parent handles, and end with its parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_ended_with, args=(parent,), daemon=True).start()


def _ended_with(parent: Any) -> None:
    """Otherwise a process whose parent was killed would wait without limit."""
    parent.join()
    os._exit(1)


# -- Variants computed by the workers of a Dask scheduler.


_PATIENCE = 5.0  # s, for a scheduler to answer, and for a worker to be there
_AHEAD_OF_WORKERS = 4  # chunks for each thread of a worker that wait for it
_RESUME = "results so far are kept: the same command resumes"


@contextmanager
def connected(address: str) -> Iterator[Any]:
    """A client of a scheduler that has workers."""
    client = _client(address)
    try:
        yield client
    finally:
        client.close(timeout=_PATIENCE)


def _client(address: str) -> Any:
    """A client of the scheduler that has a worker."""
    if find_spec("distributed") is None:
        raise InputError("--scheduler needs Dask; install drivesizer[cluster]")
    dask = import_module("distributed")  # first, for it sets log levels
    for name in ("distributed", "distributed.client", "tornado", "tornado.application"):  # replaced by a one-line error
        logging.getLogger(name).setLevel(logging.CRITICAL)
    expected = "expected a Dask scheduler's address, e.g. tcp://10.0.0.5:8786"
    try:
        found = asyncio.run(asyncio.wait_for(_identity(address), _PATIENCE + 1.0))
    except Exception as error:  # an unknown server may answer anything
        raise InputError(f"--scheduler: {quoted(address)} does not answer ({_brief(error)}); {expected}") from None
    if found.get("type") != "Scheduler":
        raise InputError(f"--scheduler: {quoted(address)} is a {found.get('type', 'server')}; {expected}")
    client = dask.Client(address, timeout=_PATIENCE, set_as_default=False)
    try:
        client.wait_for_workers(1, timeout=_PATIENCE)
    except (OSError, TimeoutError):
        client.close(timeout=_PATIENCE)
        raise InputError(f"{address}: has no worker; `dask worker {address}` starts one") from None
    return client


async def _identity(address: str) -> dict[str, Any]:
    """Identity of the server at an address."""
    comm = await import_module("distributed.comm").connect(address, timeout=_PATIENCE)
    try:
        await comm.write({"op": "identity", "reply": True})
        return dict(await comm.read())
    finally:
        comm.abort()


def compute_on_cluster(client: Any, plan: Plan, chunks: Sequence[int]) -> Iterator[tuple[int, Part]]:
    """Compute chunks on the workers of a scheduler; they are yielded in the order of completion.

    Other workers take over the tasks of a lost one.
    """
    pending, job = tasks(plan, chunks), plan.job.sent

    def submit(count: int) -> dict[Any, int]:
        return {
            client.submit(rows_of, job, variants, heads, pure=False, retries=3): chunk
            for chunk, variants, heads in islice(pending, count)
        }

    running = submit(_AHEAD_OF_WORKERS * max(sum(client.nthreads().values()), 1))
    done = import_module("distributed").as_completed(list(running), loop=client.loop, with_results=True)
    while running:
        future, part = _next(done, client.scheduler.address)
        more = submit(1)
        running |= more
        for another in more:
            done.add(another)
        yield running.pop(future), part


def _next(done: Any, address: str) -> tuple[Any, Part]:
    """The next chunk that is done."""
    lost: Any = CancelledError, OSError, import_module("distributed").KilledWorker  # a closed connection is an OSError
    try:
        future, part = next(done)
        if isinstance(part, BaseException):  # of a cancelled task Dask hands the error over as its result
            raise part
    except (ImportError, AttributeError, TypeError) as error:
        raise InputError(
            f"{address}: its workers cannot compute this ({_brief(error)}); install the same drivesizer there"
        ) from None
    except lost as error:
        raise InputError(f"{address}: scheduler or workers were lost ({_brief(error)}); {_RESUME}") from None
    return future, part


def _brief(error: Exception) -> str:
    text = " ".join(str(error).split()) or type(error).__name__
    return text if len(text) <= 120 else text[:119] + "…"
