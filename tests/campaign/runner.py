"""Inputs run one after another in processes of their own, which are ended where they hang and renewed after many."""

from __future__ import annotations

import multiprocessing
import os
import resource
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from random import Random
from typing import Any, NamedTuple

from inputs import made
from judge import Find, finds
from program import ran

__all__ = ["WEIGHTS", "Outcome", "campaign", "found_by", "judged", "kind_of"]

# of a hundred inputs: cheap ones many, and those that are sized as many as the time takes
WEIGHTS = {"spec": 21, "figures": 4, "text": 16, "robot": 2, "whole": 1, "further": 4, "recording": 7, "catalogue": 13,
           "bench": 5, "table": 11, "description": 11, "study": 2, "cache": 1, "live": 2}  # fmt: skip
_RENEWED = 4000  # inputs of a process
_MEMORY = 6 << 30  # bytes
_GONE = 240.0  # s of the clock, after which a process that says nothing is ended
_SCHEMA = 8  # of so many documents one is held against its schema


class Outcome(NamedTuple):
    """One input as it ended."""

    kind: str
    seed: int
    status: int
    seconds: float
    finds: list[Find]


@dataclass(eq=False)
class _Worker:
    """A process with its share of the inputs."""

    seeds: range
    pipe: Connection
    process: BaseProcess
    heard: float  # s of the clock
    now: int = -1  # seed of the input that it is at


def kind_of(seed: int, kinds: list[str]) -> str:
    """The kind of an input by its seed alone, so that any number of processes does the same."""
    return Random(f"kind {seed}").choices(kinds, [WEIGHTS[kind] for kind in kinds])[0]


def found_by(kind: str, seed: int, folder: Path) -> Outcome:
    """An input made, run and judged."""
    status, seconds, found = judged(made(kind, seed), folder, schema=seed % _SCHEMA == 0)
    return Outcome(kind, seed, status, seconds, found)


def judged(case: Any, folder: Path, schema: bool = True) -> tuple[int, float, list[Find]]:
    """Status and processor seconds of an input's commands, and what is wrong with them."""
    done = ran(case, folder)
    return done[-1].status, sum(one.seconds for one in done), [f for one in done for f in finds(one, schema)]


def campaign(seeds: range, kinds: list[str], processes: int, minutes: float) -> Iterator[Outcome]:
    """Outcomes of all inputs, or of as many as the time allows.

    Parameters
    ----------
    seeds
        Of the inputs.
    kinds
        Of which they are.
    processes
        That share them: each takes every n-th.
    minutes
        After which no more are begun.

    Yields
    ------
    Outcome
        In the order in which they end.
    """
    end = time.monotonic() + 60 * minutes
    running = [_started(seeds[n::processes], kinds) for n in range(processes)]
    while running and time.monotonic() < end:
        wait([worker.pipe for worker in running], timeout=1.0)
        for worker in list(running):
            if worker.pipe.poll() and (outcome := _heard(worker)) is not None:
                yield outcome
            elif worker.process.exitcode is not None or time.monotonic() - worker.heard > _GONE:
                running.remove(worker)
                yield from _lost(worker, kinds)
                if rest := worker.seeds[worker.seeds.index(worker.now) + 1 :] if worker.now >= 0 else range(0):
                    running.append(_started(rest, kinds))
    for worker in running:
        worker.process.kill()


def _started(seeds: range, kinds: list[str]) -> _Worker:
    near, far = multiprocessing.Pipe(duplex=False)
    forked, share = multiprocessing.get_context("fork"), seeds[:_RENEWED]
    process = forked.Process(target=_work, args=(far, share, kinds), daemon=True)
    process.start()
    far.close()
    return _Worker(seeds, near, process, time.monotonic())


def _heard(worker: _Worker) -> Outcome | None:
    """The next outcome of a process; None where it has begun an input, or has ended."""
    try:
        said = worker.pipe.recv()
    except EOFError:
        worker.process.join(5.0)
        return None
    worker.heard = time.monotonic()
    if isinstance(said, Outcome):
        return said
    worker.now = said
    return None


def _lost(worker: _Worker, kinds: list[str]) -> Iterator[Outcome]:
    """The input at which a process ended without being at its end, or does not go on."""
    code = worker.process.exitcode
    worker.process.kill()
    worker.process.join()
    if code:
        kind = f"its process ended with {code}"
    elif code is None:
        kind = "hangs without computing"
    else:
        return
    yield Outcome(kind_of(worker.now, kinds), worker.now, -1, _GONE, [Find(kind, "")])


def _work(pipe: Connection, seeds: range, kinds: list[str]) -> None:
    resource.setrlimit(resource.RLIMIT_DATA, (_MEMORY, _MEMORY))
    with tempfile.TemporaryDirectory(prefix="campaign-") as folder, tempfile.TemporaryDirectory() as kept:
        os.environ["DRIVESIZER_CACHE"] = kept
        for seed in seeds:
            pipe.send(seed)
            pipe.send(found_by(kind_of(seed, kinds), seed, Path(folder)))
    pipe.close()
