"""A process of the engine as the server sees it: one job at a time, the newest of a tab first, none without an end."""

from __future__ import annotations

import asyncio
import json
import multiprocessing
import threading
from collections.abc import AsyncIterator, Mapping
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Any

from drivesizer.live.engine import OWN, run
from drivesizer.live.held import Piece

__all__ = ["Worker"]

_TABS = 1000  # that are remembered
_AFRESH = "the engine ended in the middle of this and has been started afresh"


class Worker:
    """A process that computes, and who waits for it.

    A class, for it has a life: it is started, killed when a job takes too long, started afresh, and closed.
    """

    def __init__(self, name: str, longest: float, own: Mapping[str, bytes]) -> None:
        self.name = name  # of the file of the page
        self.own = own  # catalogues of the user, which change while it lives
        self.longest = longest  # s that a job may take from one piece to the next
        self.jobs = 0
        self.newest: dict[str, int] = {}  # by tab, the job whose answer it waits for
        self.serving = ""  # tab of the job that is done now
        self.turn = asyncio.Lock()
        self.sending = threading.Lock()
        context = multiprocessing.get_context("spawn")
        self.wanted: Any = context.Value("Q", 0, lock=False)  # job that is not to be stopped
        self.starts = 0
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        arguments = theirs, self.wanted, self.name, self.starts > 0
        self.process = context.Process(target=run, args=arguments, daemon=True, name="drivesizer engine")
        self.process.start()
        theirs.close()
        self.starts += 1
        self.has: dict[str, bytes] = {}  # of those catalogues
        self.pieces: asyncio.Queue[bytes | None] = asyncio.Queue()
        listening = self.pipe, self.pieces, asyncio.get_running_loop()
        threading.Thread(target=_listen, args=listening, daemon=True).start()

    async def answer(self, tab: str, job: str, request: Piece) -> AsyncIterator[bytes]:
        """Pieces of a job as JSON, a line each; one that says so where a newer request of the tab came first.

        Parameters
        ----------
        tab
            Whose request it is: its newest one counts, and stops one that is under way.
        job, request
            As of ``engine.done``.

        Yields
        ------
        bytes
        """
        self.jobs += 1
        mine = self.newest[tab] = self.jobs
        if self.serving == tab:
            self.wanted.value = 0
        async with self.turn:
            if self.newest.get(tab) != mine:
                yield _line({"kind": "superseded"})
                return
            self.serving, self.wanted.value = tab, mine
            try:
                await self._hand_over()
                await asyncio.to_thread(self._send, (mine, job, request))
                async for body in self._pieces_of(mine):
                    yield body
            except (OSError, EOFError):
                self._afresh()
                yield _line({"kind": "wrong", "lines": [_AFRESH]})
            finally:
                self.serving, self.wanted.value = "", 0  # what is left of it is of no use to anyone
                if len(self.newest) > _TABS:
                    self.newest.clear()

    async def _hand_over(self) -> None:
        """The user's catalogues, where the process does not have them as they are now."""
        if self.has != self.own:
            self.has = dict(self.own)
            await asyncio.to_thread(self._send, (0, OWN, self.has))

    def _send(self, message: tuple[int, str, Any]) -> None:
        """Send what may be more than a pipe holds: in a thread, and one after another, whoever still waits for it."""
        with self.sending:
            self.pipe.send(message)

    async def _pieces_of(self, job: int) -> AsyncIterator[bytes]:
        """Pieces of a job until it ends; one that takes too long is the end of its process."""
        while True:
            try:
                found = await asyncio.wait_for(self.pieces.get(), self.longest)
            except TimeoutError:
                self._afresh()
                yield _line({"kind": "wrong", "lines": [f"it took longer than {self.longest:g} s and was stopped"]})
                return
            if found is None:
                raise EOFError
            if int.from_bytes(found[:8], "big") != job:
                continue  # of a job that was stopped
            if len(found) == 8:
                return
            yield found[8:] + b"\n"

    def _afresh(self) -> None:
        self.close()
        self._start()

    def close(self) -> None:
        """End the process, whatever it does."""
        with suppress(OSError):
            self.pipe.close()
        self.process.kill()
        self.process.join(2.0)


def _line(piece: Piece) -> bytes:
    return json.dumps(piece).encode() + b"\n"


def _listen(pipe: Connection, pieces: asyncio.Queue[bytes | None], loop: asyncio.AbstractEventLoop) -> None:
    """Hand on what a process sends, until it ends: a thread of its own, so that the server never waits."""
    while True:
        try:
            found: bytes | None = pipe.recv_bytes()
        except (EOFError, OSError):
            found = None
        with suppress(RuntimeError):  # the server has ended
            loop.call_soon_threadsafe(pieces.put_nowait, found)
        if found is None:
            return
