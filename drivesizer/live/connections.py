"""Connections of the server: patience with them, headers of every response, and their end."""

from __future__ import annotations

import asyncio
import signal
import socket
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from types import FrameType

import h11
import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from drivesizer.live.guard import App
from drivesizer.live.worker import Worker

__all__ = ["serve"]

_MOST = 64  # connections at the same time; more are refused at once
_PATIENCE = 10.0  # s from the first byte of a request's head to its last


def serve(app: App, headers: Mapping[str, str], listening: socket.socket, workers: Iterable[Worker] = ()) -> None:
    """Serve until Ctrl-C, or until the process is to end."""
    config = uvicorn.Config(
        app, http=_Connection, ws="none", loop="asyncio", lifespan="off", interface="asgi3", proxy_headers=False,
        headers=list(headers.items()), server_header=False, date_header=False, access_log=False,
        log_level="critical", limit_concurrency=_MOST, timeout_keep_alive=5, timeout_graceful_shutdown=1,
    )  # fmt: skip
    server = _Server(config, workers)
    asyncio.run(server.serve(sockets=[listening]))
    if server.terminated:
        signal.raise_signal(signal.SIGTERM)  # the status is that of the system


class _Server(uvicorn.Server):
    """A server that does not wait at its end for answers that are being computed."""

    def __init__(self, config: uvicorn.Config, workers: Iterable[Worker]) -> None:
        super().__init__(config)
        self.workers = workers
        self.terminated = False

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Take Ctrl-C and a request to end as the way in which it ends, and raise neither again."""
        before = {one: signal.signal(one, self.handle_exit) for one in (signal.SIGINT, signal.SIGTERM)}
        try:
            yield
        finally:
            for one, handler in before.items():
                signal.signal(one, handler)

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        self.terminated = self.terminated or sig == signal.SIGTERM
        super().handle_exit(sig, frame)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        for worker in self.workers:
            worker.close()
        await super().shutdown(sockets)


class _Connection(H11Protocol):
    """A connection that is closed where the head of a request does not come, or only bit by bit."""

    late: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        self._await_head()

    def data_received(self, data: bytes) -> None:
        super().data_received(data)
        self._await_head()

    def connection_lost(self, exc: Exception | None) -> None:
        self._come()
        super().connection_lost(exc)

    def _await_head(self) -> None:
        if self.conn.their_state is not h11.IDLE:
            self._come()
        elif self.late is None:
            self.late = self.loop.call_later(_PATIENCE, self.transport.abort)

    def _come(self) -> None:
        if self.late is not None:
            self.late.cancel()
            self.late = None

    def send_400_response(self, msg: str) -> None:
        """Refuse what is no HTTP, in the middle of a response by its end."""
        if self.conn.our_state in (h11.IDLE, h11.SEND_RESPONSE):
            headers = [*self.server_state.default_headers, (b"content-length", b"0"), (b"connection", b"close")]
            response = h11.Response(status_code=400, headers=headers, reason=b"Bad Request")
            self.transport.write((self.conn.send(response) or b"") + (self.conn.send(h11.EndOfMessage()) or b""))
        self.transport.close()
