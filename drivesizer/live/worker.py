"""Processes of the engine as the server sees them: one job at a time in each, of a tab only the newest, none endless.

The thread of a request takes a process that is free, sends it the job, hands its pieces on, and ends it when it takes
too long. Processes are as many as there are cores, and one; a tab has no more than two at once, and those that take
long leave one for what is short.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from math import inf
from tempfile import TemporaryDirectory
from typing import Any

from drivesizer.live.engine import OWN, Piece, line, run, wrong

_LOOK = 0.05  # s from one look to the next whether a job is still wanted
_GRACE = 5.0  # s after which a job of which nobody wants the answer ends with its process
_READING = 180.0  # s that the process may take for catalogues of the user: one of 16 MB takes 30
_QUICK, _SLOW = 60.0, 180.0  # s that a ranking may take, and a report
_WAITING = 32  # requests that wait
_OF_A_TAB = 2  # processes
_KEYS = 1000  # of which newest jobs are known
_AFRESH = "the engine ended in the middle of this and has been started afresh"
_SUPERSEDED: Piece = {"kind": "superseded"}
_STOPPED = "drivesizer serve has been stopped"


class FullError(Exception):
    """So many requests wait that another one is better refused."""


class _TooLongError(Exception):
    """A job that takes longer than it may, or does not stop."""


class Engine:
    """A process that computes: started, ended where a job takes too long, started afresh."""

    def __init__(self, file: str, spec: str | None, *, first: bool) -> None:
        self.file, self.spec = file, spec  # of the page, and its text when it was opened
        self.context = multiprocessing.get_context("spawn")
        self.unwanted: Any = self.context.Value("Q", 0, lock=False)  # job under way that is to be stopped
        self.tab, self.slow = "", False  # of its last job
        self.leaving, self.closed = inf, False  # when a job that is to stop is ended with its process
        self.start(first=first)

    def start(self, *, first: bool = False) -> None:
        """Start the process; ``first`` sizes the spec, which warms it up."""
        self.ready, self.has = False, dict[str, bytes]()  # catalogues of the user in it
        self.pipe, theirs = self.context.Pipe()
        with _interruptions_elsewhere():
            self.folder = TemporaryDirectory(prefix="drivesizer-", ignore_cleanup_errors=True)
            arguments = theirs, self.unwanted, self.file, self.spec, first, self.folder.name
            self.process = self.context.Process(target=run, args=arguments, daemon=True, name="drivesizer engine")
            self.process.start()
        theirs.close()

    def end(self) -> None:
        """End the process, whatever it does."""
        self.process.kill()
        self.process.join(2.0)
        self.pipe.close()
        self.folder.cleanup()

    def afresh(self) -> None:
        """Another process in place of this one."""
        self.end()
        if not self.closed:
            self.start()

    def pieces(
        self, job: tuple[int, str, Piece], own: dict[str, bytes], longest: float, useful: Callable[[], bool]
    ) -> Generator[bytes]:
        """Pieces of a job as lines of JSON; whatever becomes of it, the next one finds a process that is free."""
        until, free, self.leaving = time.monotonic() + longest, False, inf
        try:
            if not self.process.is_alive():  # it ended while nobody waited for it
                self.afresh()
            if not self.ready:
                self.ready = self._next(until, 0, lambda: True) == b""
            if self.has != own:
                start, self.has = time.monotonic(), dict(own)
                self.pipe.send((0, OWN, self.has))
                self._next(start + _READING, 0, lambda: True)
                until += time.monotonic() - start
            if not useful():  # any more
                free = True
                yield line(_SUPERSEDED)
                return
            self.pipe.send(job)
            while body := self._next(until, job[0], useful):
                yield body
            free = True
        except GeneratorExit:  # the browser has gone away
            free = self._stopped(job[0])
            raise
        except _TooLongError:
            late = wrong(f"it took longer than {longest:g} s and was stopped")
            yield line(late if useful() else _SUPERSEDED)
        except (OSError, EOFError):
            yield line(wrong(_STOPPED if self.closed else _AFRESH))
        finally:
            if not free:
                self.afresh()

    def _stopped(self, number: int) -> bool:
        """Stop the job under way; whether it does in time."""
        try:
            while self._next(inf, number, lambda: False):
                pass
        except (_TooLongError, OSError, EOFError):
            return False
        return True

    def _next(self, until: float, number: int, useful: Callable[[], bool]) -> bytes:
        """The next piece of the process."""
        while not self.pipe.poll(_LOOK):
            now = time.monotonic()
            if self.unwanted.value != number and not useful():
                self.unwanted.value, self.leaving = number, now + _GRACE
            if now > min(until, self.leaving):
                raise _TooLongError
        return self.pipe.recv_bytes()


class Engines:
    """The processes of one page, and who waits for them."""

    def __init__(self, file: str, spec: str | None) -> None:
        self.file, self.spec = file, spec
        self.own: dict[str, bytes] = {}  # catalogues of the user, in memory alone
        self.most = 1 + max(2, len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 2)
        self.changed, self.closed = threading.Condition(), False
        self.free = [Engine(file, spec, first=True) for _ in range(2)]
        self.busy: list[Engine] = []
        self.jobs = self.waiting = 0
        self.newest: dict[str, int] = {}  # by what a tab wants the newest of, the number of that job

    def answer(
        self, name: str, request: Piece, *, tab: str = "", kind: str = "", slow: bool = False,
        has_reader: Callable[[], bool] = lambda: True,
    ) -> Generator[bytes]:  # fmt: skip
        """Pieces of a job as JSON, a line each; one that says so where a newer request of the kind came first."""
        with self.changed:
            if self.waiting >= _WAITING:
                raise FullError
            self.jobs += 1
            number, key = self.jobs, f"{tab} {kind}"
            if kind:
                self.newest[key] = number
                if len(self.newest) > _KEYS:  # of tabs that are long gone
                    del self.newest[next(iter(self.newest))]
        return self._pieces((number, name, request), tab, key if kind else "", slow, has_reader)

    def _pieces(
        self, job: tuple[int, str, Piece], tab: str, key: str, slow: bool, has_reader: Callable[[], bool]
    ) -> Generator[bytes]:
        def useful() -> bool:
            return not self.closed and self.newest.get(key, job[0]) == job[0] and has_reader()

        if (engine := self._free_engine(tab, slow, useful)) is None:
            yield line(wrong(_STOPPED) if self.closed else _SUPERSEDED)
            return
        try:
            yield from engine.pieces(job, self.own, _SLOW if slow else _QUICK, useful)
        finally:
            with self.changed:
                self.busy.remove(engine)
                if self.closed:
                    engine.end()
                self.free.append(engine)
                self.changed.notify_all()

    def _free_engine(self, tab: str, slow: bool, useful: Callable[[], bool]) -> Engine | None:
        """A process that is free, at best one that knows the tab; None where nobody waits for the answer any more."""
        with self.changed:
            self.waiting += 1
            try:
                while useful():
                    of_tab = sum(engine.tab == tab for engine in self.busy) if tab else 0
                    long = sum(engine.slow for engine in self.busy) if slow else 0
                    there = len(self.busy) + len(self.free)
                    if of_tab < _OF_A_TAB and long < self.most - 1 and (self.free or there < self.most):
                        known = [engine for engine in self.free if engine.tab == tab and engine.slow == slow]
                        engine = (known or self.free or [Engine(self.file, self.spec, first=False)])[0]
                        self.free = [other for other in self.free if other is not engine]
                        engine.tab, engine.slow = tab, slow
                        self.busy.append(engine)
                        return engine
                    self.changed.wait(_LOOK)
            finally:
                self.waiting -= 1
        return None

    def close(self) -> None:
        """End all processes; who waits is given the reason."""
        with self.changed:
            self.closed = True
            for engine in (*self.busy, *self.free):
                engine.closed = True
                engine.process.kill()
            for engine in self.free:
                engine.end()
            self.changed.wait_for(lambda: not self.busy, 2.0)


@contextmanager
def _interruptions_elsewhere() -> Iterator[None]:
    """A process that is started meanwhile leaves Ctrl-C to the server, from its first moment on."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    from multiprocessing import resource_tracker  # of systems that have signals

    resource_tracker.ensure_running()  # else the first process starts it, and that ends the mask
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
