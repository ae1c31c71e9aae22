"""Variants computed by the workers of a Dask scheduler."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec
from itertools import islice
from typing import Any

from drivesizer.errors import InputError, quoted
from drivesizer.study.local import tasks
from drivesizer.study.plan import Plan
from drivesizer.study.variant import Part, rows_of

__all__ = ["compute_on_cluster", "connected"]

_PATIENCE = 5.0  # s, for a scheduler to answer, and for a worker to be there
_AHEAD = 4  # chunks for each thread of a worker that wait for it
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

    running = submit(_AHEAD * max(sum(client.nthreads().values()), 1))
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
