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
from typing import Any

from drivesizer.errors import InputError
from drivesizer.study.column import Row
from drivesizer.study.plan import Job, Plan, Variant
from drivesizer.study.variant import Part, rows_of

__all__ = ["Task", "cores", "on_processes", "tasks"]

Task = tuple[int, list[Variant], list[Row]]  # chunk, its variants, and the first cells of their rows
_AHEAD = 2  # pending chunks for each process
_SINGLE = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


def tasks(plan: Plan, chunks: Iterable[int]) -> Iterator[Task]:
    """Tasks of some chunks, made one at a time.

    Parameters
    ----------
    plan
        The study.
    chunks
        Numbers of the chunks.

    Returns
    -------
    Iterator[Task]
        One for each chunk.
    """
    for chunk in chunks:
        variants = plan.variants(chunk)
        yield chunk, variants, [plan.head(variant) for variant in variants]


def cores() -> int:
    """Number of processor cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def on_processes(plan: Plan, chunks: Sequence[int], processes: int) -> Iterator[tuple[int, Part]]:
    """Compute chunks; they are yielded in the order of completion.

    Parameters
    ----------
    plan
        The study.
    chunks
        Numbers of the chunks to compute.
    processes
        Number of processes.

    Returns
    -------
    Iterator
        Pairs of chunk number and rows.

    Raises
    ------
    InputError
        When a process ended before its work was done.
    """
    pending, others = tasks(plan, chunks), multiprocessing.active_children()
    with _one_thread_each(), ProcessPoolExecutor(processes, _context(), _initialise) as pool:
        running = {_submit(pool, plan.job, task): task[0] for task in islice(pending, _AHEAD * processes)}
        try:
            while running:
                done, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in done:
                    running |= {_submit(pool, plan.job, task): task[0] for task in islice(pending, 1)}
                    yield running.pop(future), future.result()
        except BrokenProcessPool:
            raise InputError(
                "a process that computes variants was ended from outside, such as for want of memory; results so "
                "far are kept: the same command resumes, --processes sets their number"
            ) from None
        finally:
            for child in multiprocessing.active_children() if running else ():
                if child not in others:
                    child.terminate()  # interrupted: their results are not awaited


def _context() -> Any:
    """Start of processes: as copies of one that has the program loaded; where a system has no copies, each anew.

    A copy of this process would hold the study's lock, and its threads' locks as they are.
    """
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([rows_of.__module__])
    return context


def _submit(pool: ProcessPoolExecutor, job: Job, task: Task) -> Future[Part]:
    return pool.submit(rows_of, job, *task[1:])


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Let processes that start inside compute on one thread each: there is one process for each core."""
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
    if parent is not None:
        threading.Thread(target=_ended_with, args=(parent,), daemon=True).start()


def _ended_with(parent: Any) -> None:
    """Otherwise a process whose parent was killed would wait without limit."""
    parent.join()
    os._exit(1)
