"""Variants on the workers of a Dask scheduler: the same tasks, elsewhere."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from itertools import islice
from typing import Any

from drivesizer.errors import DrivesizerError, InputError, quoted
from drivesizer.study.local import tasks
from drivesizer.study.plan import Plan
from drivesizer.study.variant import Part, rows_of

__all__ = ["connected", "on_cluster"]

_PATIENCE = 5.0  # s, for a scheduler to answer, and for a worker to be there
_AHEAD = 4  # chunks for each thread of a worker that wait for it
_GO_ON = "what is done is kept: the same command goes on"


@contextmanager
def connected(address: str) -> Iterator[Any]:
    """A client of a scheduler that has workers.

    Parameters
    ----------
    address
        Of the scheduler, such as ``tcp://10.0.0.5:8786``.

    Raises
    ------
    InputError
        When there is no such scheduler, or it has no worker within some seconds; in the block, when it is lost.
    """
    client = _client(address)
    try:
        yield client
    except DrivesizerError:
        raise
    except (ImportError, AttributeError) as error:
        raise InputError(
            f"{address}: its workers cannot compute this ({_brief(error)}); install the same drivesizer there"
        ) from None
    except Exception as error:
        if not _is_lost(error):
            raise
        raise InputError(f"{address}: scheduler or workers were lost ({_brief(error)}); {_GO_ON}") from None
    finally:
        client.close(timeout=_PATIENCE)


def _client(address: str) -> Any:
    """A client of the scheduler that has a worker."""
    if find_spec("distributed") is None:
        raise InputError("--scheduler needs Dask; install drivesizer[cluster]")
    from distributed import Client

    for name in ("distributed", "tornado"):  # the one line that we print says what they would say in many
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        client = Client(address, timeout=_PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise InputError(
            f"--scheduler: {quoted(address)} does not answer ({_brief(error)}); expected a Dask scheduler's address, "
            "e.g. tcp://10.0.0.5:8786"
        ) from None
    try:
        client.wait_for_workers(1, timeout=_PATIENCE)
    except (OSError, TimeoutError):
        client.close(timeout=_PATIENCE)
        raise InputError(f"{address}: has no worker; `dask worker {address}` starts one") from None
    return client


def on_cluster(client: Any, plan: Plan, chunks: Sequence[int]) -> Iterator[tuple[int, Part]]:
    """Compute chunks on the workers of a scheduler; they come as they are done.

    A worker that is lost is made up for by the others.

    Parameters
    ----------
    client
        Of :func:`connected`.
    plan
        The study.
    chunks
        Which of it.
    """
    from distributed import as_completed

    waiting = tasks(plan, chunks)

    def given(count: int) -> dict[Any, int]:
        return {
            client.submit(rows_of, plan.job, variants, heads, pure=False, retries=3): chunk
            for chunk, variants, heads in islice(waiting, count)
        }

    running = given(_AHEAD * max(sum(client.nthreads().values()), 1))
    done = as_completed(list(running))
    for future in done:
        more = given(1)
        running |= more
        for another in more:
            done.add(another)
        yield running.pop(future), future.result()


def _is_lost(error: Exception) -> bool:
    """Whether an error is that of a connection or a worker, and not of what was computed."""
    from concurrent.futures import CancelledError

    from distributed import CommClosedError, KilledWorker

    return isinstance(error, CancelledError | CommClosedError | KilledWorker | OSError)


def _brief(error: Exception) -> str:
    text = " ".join(str(error).split()) or type(error).__name__
    return text if len(text) <= 120 else text[:119] + "…"
