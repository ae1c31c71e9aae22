"""A process of the engine as the server sees it: one job after another, of a tab only the newest, none without an end.

A thread does the jobs in their order: it starts the process, sends a job, waits for its pieces and ends the process
when they take too long. The server's loop never waits for a process, and a browser that does not read holds up nobody.
"""

from __future__ import annotations

import asyncio
import json
import multiprocessing
import queue
import signal
import threading
import time
from collections.abc import AsyncGenerator, Iterator, Mapping
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from tempfile import TemporaryDirectory
from typing import Any

from drivesizer.live.engine import OWN, Piece, run

_LOOK = 0.2  # s from one look to the next whether a job is still wanted
_GRACE = 5.0  # s after which a job of which nobody wants the answer ends with its process
_READING = 180.0  # s that the process may take for catalogues of the user: one of 16 MB takes 30
_MOST = 32  # requests that wait
_AFRESH = "the engine ended in the middle of this and has been started afresh"
_STOPPED = "drivesizer serve has been stopped"


class _TooLongError(Exception):
    """A job that takes longer than it may, or does not stop."""


class _Job:
    """A request under way: what it is, whether someone waits for it, and where its pieces go."""

    def __init__(self, number: int, name: str, request: Piece) -> None:
        self.number, self.name, self.request = number, name, request
        self.left = 0.0  # time at which its answer became of no use; 0 while it is of use
        self.pieces: asyncio.Queue[bytes | None] = asyncio.Queue()
        self.loop = asyncio.get_running_loop()

    def say(self, piece: bytes | None) -> None:
        """Hand on a piece from the thread that does the job; None is the end."""
        with suppress(RuntimeError):  # the server has ended
            self.loop.call_soon_threadsafe(self.pieces.put_nowait, piece)


class Worker:
    """A process that computes, and who waits for it.

    A class, for it has a life: it is started, killed when a job takes too long, started afresh, and closed.
    """

    process: SpawnProcess
    pipe: Connection
    folder: TemporaryDirectory[str]  # of the process
    ready: bool  # whether the process has read the spec
    has: dict[str, bytes]  # catalogues of the user in it

    def __init__(self, file: str, spec: str | None, longest: float, own: Mapping[str, bytes]) -> None:
        self.file, self.spec = file, spec  # of the page, and its text when it was opened
        self.own = own  # catalogues of the user, which change while it lives
        self.longest = longest  # s that a job may take
        self.jobs = 0
        self.newest: dict[str, _Job] = {}  # by tab, the job whose answer it waits for
        self.waiting: queue.SimpleQueue[_Job | None] = queue.SimpleQueue()
        self.serving: _Job | None = None
        self.closed = False
        self.context = multiprocessing.get_context("spawn")
        self.unwanted: Any = self.context.Value("Q", 0, lock=False)  # job under way that is to be stopped
        self._start(first=True)
        self.thread = threading.Thread(target=self._work, daemon=True, name="drivesizer worker")
        with _interruptions_elsewhere():  # nor in the thread, else one would come through while it starts a process
            self.thread.start()

    @property
    def full(self) -> bool:
        """Whether so many requests wait that another one is better refused."""
        return self.waiting.qsize() >= _MOST

    async def answer(self, tab: str, name: str, request: Piece) -> AsyncGenerator[bytes]:
        """Pieces of a job as JSON, a line each; one that says so where a newer request of the tab came first."""
        if self.closed:
            yield _wrong(_STOPPED)
            return
        self.jobs += 1
        mine = _Job(self.jobs, name, request)
        if tab:
            self._leave(self.newest.get(tab))
            self.newest[tab] = mine
        self.waiting.put(mine)
        try:
            while (piece := await mine.pieces.get()) is not None:
                yield piece
        finally:  # also when the browser has gone away
            self._leave(mine)
            if self.newest.get(tab) is mine:
                del self.newest[tab]

    def _leave(self, job: _Job | None) -> None:
        """Mark a job as of no use. The thread reads the mark after it has said what it serves: none is missed."""
        if job is not None and not job.left:
            job.left = time.monotonic()
            if self.serving is job:
                self.unwanted.value = job.number

    def close(self) -> None:
        """End the process, whatever it does; who waits is given the reason."""
        self.closed = True
        self.waiting.put(None)
        self.process.kill()
        self.thread.join(5.0)

    # -- of the thread

    def _work(self) -> None:
        while (job := self.waiting.get()) is not None:
            self.serving = job
            if self.closed:
                job.say(_wrong(_STOPPED))
            elif job.left:
                job.say(_line({"kind": "superseded"}))
            else:
                self._serve(job)
            self.serving = None
            job.say(None)
        self._end()

    def _serve(self, job: _Job) -> None:
        """Do a job; whatever becomes of the process, the next one finds one that is ready or being started."""
        until = time.monotonic() + self.longest
        try:
            if not self.process.is_alive():  # it ended while nobody waited for it
                self._end()
                self._start()
            if not self.ready:
                self.ready = self._received(job, until) == b""
            if self.has != self.own:
                until += self._hand_over()
            self.pipe.send((job.number, job.name, job.request))
            while body := self._received(job, until):
                job.say(body)
        except _TooLongError:
            self._afresh(job, f"it took longer than {self.longest:g} s and was stopped")
        except (OSError, EOFError):
            self._afresh(job, _AFRESH)

    def _hand_over(self) -> float:
        """Give the process the user's catalogues, which it reads; the time that it took [s]."""
        start, self.has = time.monotonic(), dict(self.own)
        self.pipe.send((0, OWN, self.has))
        self._received(None, start + _READING)
        return time.monotonic() - start

    def _received(self, job: _Job | None, until: float) -> bytes:
        """The next piece of the process."""
        while not self.pipe.poll(_LOOK):
            now = time.monotonic()
            if now > until or (job and job.left and now > job.left + _GRACE):
                raise _TooLongError
        return self.pipe.recv_bytes()

    # -- the process

    def _start(self, *, first: bool = False) -> None:
        self.ready, self.has = False, {}
        self.pipe, theirs = self.context.Pipe()
        with _interruptions_elsewhere():
            self.folder = TemporaryDirectory(prefix="drivesizer-", ignore_cleanup_errors=True)
            arguments = theirs, self.unwanted, self.file, self.spec, first, self.folder.name
            self.process = self.context.Process(target=run, args=arguments, daemon=True, name="drivesizer engine")
            self.process.start()
        theirs.close()
        if self.closed:  # in the meantime
            self.process.kill()

    def _afresh(self, job: _Job, reason: str) -> None:
        job.say(_wrong(_STOPPED if self.closed else reason))
        if not self.closed:
            self._end()
            self._start()

    def _end(self) -> None:
        self.process.kill()
        self.process.join(2.0)
        self.pipe.close()
        self.folder.cleanup()


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


def _wrong(reason: str) -> bytes:
    return _line({"kind": "wrong", "lines": [reason]})


def _line(piece: Piece) -> bytes:
    return json.dumps(piece).encode() + b"\n"
