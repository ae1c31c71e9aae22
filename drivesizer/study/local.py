"""Variants computed by processes of this machine."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from itertools import islice
from typing import Any, NamedTuple

from drivesizer.errors import InputError
from drivesizer.study.column import Row
from drivesizer.study.plan import Job, Plan, Variant
from drivesizer.study.threads import can_be_copied, one_thread_each
from drivesizer.study.variant import Part, rows_of

__all__ = ["Pool", "Task", "compute_on_processes", "cores", "started", "tasks"]

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
