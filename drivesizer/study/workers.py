"""Workers that compute the variants of a study: this process, others of this machine, or those of a Dask scheduler."""

from __future__ import annotations

import asyncio
import logging
import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec
from itertools import islice
from typing import Any, NamedTuple

from drivesizer.errors import InputError, quoted
from drivesizer.study.plan import Job, Variant
from drivesizer.study.rows import Part, rows_of

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
