"""Variants on processes of this machine."""

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
from drivesizer.study.columns import Row
from drivesizer.study.plan import Job, Plan, Variant
from drivesizer.study.variant import Part, rows_of

__all__ = ["Task", "cores", "on_processes", "tasks"]

Task = tuple[int, list[Variant], list[Row]]  # chunk, its variants, and what tells them
_AHEAD = 2  # chunks for each process that wait for it
_SINGLE = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


def tasks(plan: Plan, chunks: Iterable[int]) -> Iterator[Task]:
    """What is to be computed of some chunks, made as it is asked for."""
    for chunk in chunks:
        variants = plan.variants(chunk)
        yield chunk, variants, [plan.head(variant) for variant in variants]


def cores() -> int:
    """How many processes can work at the same time."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def on_processes(plan: Plan, chunks: Sequence[int], processes: int) -> Iterator[tuple[int, Part]]:
    """Compute chunks; they come as they are done.

    Parameters
    ----------
    plan
        The study.
    chunks
        Which of it.
    processes
        How many.

    Raises
    ------
    InputError
        When a process ended before its work was done.
    """
    waiting, others = tasks(plan, chunks), multiprocessing.active_children()
    context = multiprocessing.get_context("spawn")  # a fork would hold the study's lock for as long as it lives
    with _one_thread_each(), ProcessPoolExecutor(processes, context, _started) as pool:
        running = {_given(pool, plan.job, task): task[0] for task in islice(waiting, _AHEAD * processes)}
        try:
            while running:
                done, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in done:
                    running |= {_given(pool, plan.job, task): task[0] for task in islice(waiting, 1)}
                    yield running.pop(future), future.result()
        except BrokenProcessPool:
            raise InputError(
                "a process that computes variants was ended from outside, such as for want of memory; what is done is "
                "kept: the same command goes on, --processes sets how many there are"
            ) from None
        finally:
            for child in multiprocessing.active_children() if running else ():
                if child not in others:
                    child.terminate()  # stopped in the middle: what they compute is not waited for


def _given(pool: ProcessPoolExecutor, job: Job, task: Task) -> Future[Part]:
    return pool.submit(rows_of, job, *task[1:])


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Let processes that start meanwhile compute on one thread: there is one for each core."""
    before = {name: os.environ.get(name) for name in _SINGLE}
    os.environ.update(dict.fromkeys(_SINGLE, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})


def _started() -> None:
    """What each process does first: leave Ctrl-C to the one that started it, and end when that is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_ended_with, args=(parent,), daemon=True).start()


def _ended_with(parent: Any) -> None:
    """A process whose parent was killed would wait for work for ever."""
    parent.join()
    os._exit(1)
