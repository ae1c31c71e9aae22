"""Workers that compute the variants of a study: processes of this machine, or those of a Dask scheduler."""

from __future__ import annotations

import asyncio
import logging
import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec
from itertools import islice
from typing import Any, NamedTuple

from drivesizer.errors import InputError, quoted
from drivesizer.study.plan import Plan
from drivesizer.study.rows import Part, rows_of

_SINGLE = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
_PATIENCE = 5.0  # s, for a scheduler to answer, and for a worker to be there
_RESUME = "results so far are kept: the same command resumes"


class Workers(NamedTuple):
    """An executor, and what its failures mean."""

    executor: Executor
    ahead: int  # chunks that wait for it
    refusal: Callable[[BaseException], InputError | None]


def computed(plan: Plan, chunks: Sequence[int], on: Workers) -> Iterator[tuple[int, Part]]:
    """Compute chunks; they are yielded in the order of completion."""
    pending, job, running = iter(chunks), plan.job.sent, dict[Future[Part], int]()

    def submit(count: int) -> None:
        for chunk in islice(pending, count):
            variants = plan.variants(chunk)
            running[on.executor.submit(rows_of, job, variants, [plan.head(one) for one in variants])] = chunk

    try:
        submit(on.ahead)
        while running:
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                submit(1)
                yield running.pop(future), future.result()
    except Exception as error:
        refusal = on.refusal(error)
        if refusal is None:
            raise
        raise refusal from None


@contextmanager
def workers(processes: int, scheduler: str | None) -> Iterator[Workers]:
    """Processes of this machine, or a scheduler that has workers; it is reached before anything is written.

    Processes are copies of this one where they can be: that is to be before it takes the study's lock, which its copies
    would hold as well.
    """
    if scheduler is not None:
        client = _client(scheduler)
        try:
            ahead = 4 * max(sum(client.nthreads().values()), 1)
            with client.get_executor(pure=False, retries=3) as executor:  # others take over the tasks of a lost worker
                yield Workers(executor, ahead, lambda error: _lost(error, scheduler))
        finally:
            client.close(timeout=_PATIENCE)
        return
    copied, others = _can_be_copied(), multiprocessing.active_children()
    context = multiprocessing.get_context("fork") if copied else _context()
    with one_thread_each(), ProcessPoolExecutor(processes, context, _initialise) as pool:
        if copied:  # the first task starts all of them, of which each leaves Ctrl-C to its parent from its first moment
            before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
            try:
                pool.submit(int)
            finally:
                signal.pthread_sigmask(signal.SIG_SETMASK, before)
        try:
            yield Workers(pool, 2 * processes, _ended)
        except BaseException:
            for child in multiprocessing.active_children():
                if child not in others:
                    child.terminate()  # interrupted: their results are not awaited
            raise


def cores() -> int:
    """Number of processor cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


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


def _can_be_copied() -> bool:
    """Whether this process can be copied: it has one thread, and its system copies what it has loaded.

    It is so inside of a ``one_thread_each`` that was there before NumPy.
    """
    single = all(os.environ.get(name) == "1" for name in _SINGLE)
    return sys.platform == "linux" and single and threading.active_count() == 1


def _context() -> Any:
    """Start of processes: as copies of one that has the program loaded; where a system has no copies, each anew.

    A copy of this process would have its threads' locks as they are.
    """
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([rows_of.__module__])
    return context


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


def _ended(error: BaseException) -> InputError | None:
    """The refusal for a pool of processes that ended from outside."""
    if not isinstance(error, BrokenProcessPool):
        return None
    return InputError(
        "a process that computes variants was ended from outside, such as for want of memory; results so far are "
        "kept: the same command resumes, --processes sets their number"
    )


def _lost(error: BaseException, address: str) -> InputError | None:
    """The refusal for a scheduler or a worker that is lost, or has another program."""
    if isinstance(error, ImportError | AttributeError | TypeError):
        text = f"its workers cannot compute this ({_brief(error)}); install the same drivesizer there"
    elif isinstance(error, (CancelledError, OSError, import_module("distributed").KilledWorker)):
        text = f"scheduler or workers were lost ({_brief(error)}); {_RESUME}"  # a closed connection is an OSError
    else:
        return None
    return InputError(f"{address}: {text}")


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
        found = asyncio.run(asyncio.wait_for(identity(), _PATIENCE + 1.0))
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


def _brief(error: BaseException) -> str:
    text = " ".join(str(error).split()) or type(error).__name__
    return text if len(text) <= 120 else text[:119] + "…"
