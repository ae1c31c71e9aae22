"""Connections of the page's server: who may request what, how much and how slowly; responses and their end.

A thread for each connection reads one request after another. This machine's own browser may make them, by the address
that the command printed, and nobody else: each has the server's own host, no other origin, and the token in its path.
Connections that have not shown the token yet are few; where more come, the oldest of them is closed.
"""

from __future__ import annotations

import io
import json
import select
import socket
import sys
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Generator, Iterable, Mapping
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from math import inf
from secrets import compare_digest
from typing import Any, NamedTuple

from drivesizer.errors import InputError, printable
from drivesizer.live.engine import Piece
from drivesizer.output.report.html.templates import digest

LARGEST = 4_000_000  # bytes of a request: a spec is at most 2 MB
CATALOGUE = "/catalogue"  # where a request brings a catalogue
_LARGEST_OF = {CATALOGUE: 22_000_000}  # 16 MB in base64
_PATIENCE = 10.0  # s in which the head of a request must have come, and then its body
_SILENT, _MOST = 64, 64  # connections that have not shown the token, and that have; more of these are refused
_LAST = 1.0  # s that answers under way have to end with the server
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src-elem 'self'{}; style-src-attr 'unsafe-inline'; "
    "img-src 'self' data: blob:; connect-src 'self'; font-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'"
)
_HEADERS = {
    "x-content-type-options": "nosniff", "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin", "cross-origin-resource-policy": "same-origin",
    "permissions-policy": "camera=(), microphone=(), geolocation=(), payment=(), usb=()", "x-frame-options": "DENY",
}  # fmt: skip
_ONCE = ("host", "origin", "sec-fetch-site", "content-type", "content-length")


class Refusal(Exception):  # noqa: N818
    """A request that is refused, with its status."""

    def __init__(self, status: int, reason: str) -> None:
        super().__init__(reason)
        self.status = status


class Response(NamedTuple):
    """An answer: the whole content, or lines as they come."""

    content: bytes | Generator[bytes]
    kind: str = "application/json"
    cache_control: str = "no-store"  # how long a browser may keep it


class PageRequest(NamedTuple):
    """A request that may pass."""

    path: str  # behind the token, as it came
    post: bool
    body: bytes
    awaited: Callable[[], bool]  # whether the browser still waits for the answer


App = Callable[[PageRequest], Response]


class PageServer(ThreadingHTTPServer):
    """A server of one page to this machine alone."""

    daemon_threads = True
    request_queue_size = 128

    def __init__(self, listening: socket.socket, token: str, app: App, styles: Iterable[str] = ()) -> None:
        self.server_address = listening.getsockname()
        super().__init__(self.server_address, _Connection, bind_and_activate=False)
        self.socket.close()
        self.socket, self.token, self.app = listening, token, app
        digests = "".join(f" '{digest(style)}'" for style in styles)  # of styles that a library brings inside
        self.headers = {"content-security-policy": _POLICY.format(digests), **_HEADERS}  # of all responses
        port = self.server_address[1]
        self.hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}
        if port == 80:  # a browser leaves it out
            self.hosts |= {"127.0.0.1", "localhost"}
        self.lock = threading.Condition()
        self.silent: OrderedDict[socket.socket, None] = OrderedDict()  # the oldest first
        self.known: set[socket.socket] = set()  # of which a request had the token
        self.streams = 0  # answers under way

    def process_request(self, request: Any, client_address: Any) -> None:
        """Serve a connection in a thread of its own; the oldest that was silent gives its place to it."""
        with self.lock:
            self.silent[request] = None
            while len(self.silent) > _SILENT:
                with suppress(OSError):
                    self.silent.popitem(last=False)[0].shutdown(socket.SHUT_RDWR)
        super().process_request(request, client_address)

    def shutdown_request(self, request: Any) -> None:
        """End a connection."""
        with self.lock:
            self.silent.pop(request, None)
            self.known.discard(request)
        super().shutdown_request(request)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say in a line what failed; a browser that went away is no fault."""
        error = sys.exception()
        if not isinstance(error, OSError):
            report_fault(error, self.token)

    def end(self) -> None:
        """Give answers under way a moment to say that the server ends."""
        self.server_close()
        with self.lock:
            self.lock.wait_for(lambda: not self.streams, _LAST)


def report_fault(error: BaseException | None, token: str) -> None:
    """A line on the terminal about a fault of the program, without the token."""
    fault = printable(f"{type(error).__name__}: {error}"[:300]).replace(token, "...")
    print(f"drivesizer: a fault of drivesizer itself ({fault}); please report it", file=sys.stderr, flush=True)


class _Patient(io.RawIOBase):
    """Bytes of a connection until a moment at which they are to be there, however slowly they come."""

    def __init__(self, connection: socket.socket) -> None:
        self.connection, self.until = connection, inf

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        left = self.until - time.monotonic()
        if left <= 0.0:
            raise TimeoutError
        self.connection.settimeout(left)
        try:
            return self.connection.recv_into(buffer)
        finally:
            self.connection.settimeout(_PATIENCE)  # of a browser that does not read


class _Connection(BaseHTTPRequestHandler):
    """A connection with its requests."""

    server: PageServer
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True

    def setup(self) -> None:
        super().setup()
        self.patient = _Patient(self.connection)
        self.rfile = io.BufferedReader(self.patient)

    def handle_one_request(self) -> None:
        self.patient.until = time.monotonic() + _PATIENCE
        super().handle_one_request()  # which takes a time-out as the end, and calls the method of the request's name

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing is logged."""

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """Refuse what is no HTTP."""
        self.close_connection = True
        self._sent(code, b"", "application/json")

    def __getattr__(self, name: str) -> Any:
        """Whatever a request calls its method, it is refused or answered here."""
        if name.startswith("do_"):
            return self._answered
        raise AttributeError(name)

    def _answered(self) -> None:
        try:
            response = self.server.app(self._request())
        except Refusal as error:
            self._refused(error.status, str(error))
        except InputError as error:
            self._refused(400, str(error))
        except Exception as error:  # the page has its status 500; the terminal has a line
            report_fault(error, self.server.token)
            self._refused(500, "a fault of drivesizer itself")
        else:
            if isinstance(response.content, bytes):
                self._sent(200, response.content, response.kind, response.cache_control)
            else:
                self._streamed(response.content)

    def _request(self) -> PageRequest:
        """The request, or its refusal."""
        headers = {name.lower(): value for name, value in self.headers.items()}
        path = self.requestline.split()[1]
        if any(len(self.headers.get_all(name, ())) > 1 for name in _ONCE):
            raise Refusal(400, "a header is given twice")
        if "host" not in headers and self.request_version == "HTTP/1.1":
            raise Refusal(400, "expected the name of the host")
        if headers.get("host") not in self.server.hosts:  # another name that a rebound DNS leads here
            raise Refusal(421, "this page is served to its own machine alone")
        origin, site = headers.get("origin"), headers.get("sec-fetch-site", "none")
        opens = self.command == "GET" and headers.get("sec-fetch-mode") == "navigate"  # from a file, by its address
        foreign = site not in ("same-origin", "none") and not (opens and path == f"/{self.server.token}/")
        if foreign or (origin is not None and origin not in {f"http://{host}" for host in self.server.hosts}):
            raise Refusal(403, "expected a request of this page itself")
        start = f"/{self.server.token}/"
        if not compare_digest(path[: len(start)].encode(), start.encode()):
            raise Refusal(404, "nothing is here; open the address that drivesizer serve printed")
        with self.server.lock:
            self.server.silent.pop(self.connection, None)
            self.server.known.add(self.connection)
            if len(self.server.known) > _MOST:
                raise Refusal(503, "the server has too much to do; try again")
        path = path[len(start) - 1 :]
        if self.command in ("GET", "HEAD"):
            return PageRequest(path, False, b"", self._awaited)
        if self.command != "POST":
            raise Refusal(405, "expected GET or POST")
        if origin is None:  # every browser names it; without it a form of an old one might pass
            raise Refusal(403, "a request that changes something names its origin")
        if headers.get("content-type", "").split(";")[0].strip().lower() != "application/json":
            raise Refusal(415, "expected application/json")
        length, largest = headers.get("content-length", ""), _LARGEST_OF.get(path, LARGEST)
        if not length.isascii() or not length.isdigit() or len(length) > 12 or int(length) > largest:
            raise Refusal(413, f"expected at most {largest // 1_000_000} MB, and their number of bytes")
        self.patient.until = time.monotonic() + _PATIENCE
        try:
            body = self.rfile.read(int(length))
        except TimeoutError:
            raise Refusal(408, f"expected the whole request within {_PATIENCE:g} s") from None
        if len(body) < int(length):
            raise Refusal(400, "the request ended in the middle")
        return PageRequest(path, True, body, self._awaited)

    def _awaited(self) -> bool:
        """Whether the browser has not gone away."""
        if not select.select([self.connection], [], [], 0)[0]:
            return True
        try:
            return len(self.connection.recv(1, socket.MSG_PEEK)) > 0
        except OSError:
            return False

    def _refused(self, status: int, reason: str) -> None:
        self.close_connection = True
        self._sent(status, json.dumps({"kind": "refused", "lines": [reason]}).encode(), "application/json")

    def _sent(self, status: int, content: bytes, kind: str, cache_control: str = "no-store") -> None:
        self._head(status, {"content-type": kind, "cache-control": cache_control, "content-length": str(len(content))})
        if self.command != "HEAD":
            self.wfile.write(content)

    def _streamed(self, lines: Generator[bytes]) -> None:
        """Lines as they come; where the browser goes away, who makes them knows at once."""
        chunked = self.request_version == "HTTP/1.1"
        self.close_connection |= not chunked
        more = {"transfer-encoding": "chunked"} if chunked else {}
        self._head(200, {"content-type": "application/x-ndjson", "cache-control": "no-store", **more})
        self._count(1)
        try:
            for line in lines:
                self.wfile.write(b"%x\r\n%s\r\n" % (len(line), line) if chunked else line)
            if chunked:
                self.wfile.write(b"0\r\n\r\n")
        except OSError:
            self.close_connection = True
        finally:
            lines.close()
            self._count(-1)

    def _count(self, more: int) -> None:
        with self.server.lock:
            self.server.streams += more
            self.server.lock.notify_all()

    def _head(self, status: int, headers: Mapping[str, str]) -> None:
        self.send_response_only(status)
        allowed = {"allow": "GET, HEAD, POST"} if status == 405 else {}
        ends = {"connection": "close"} if self.close_connection else {}
        for name, value in {**self.server.headers, **headers, **allowed, **ends}.items():
            self.send_header(name, value)
        self.end_headers()


def reply(piece: Piece) -> Response:
    """A piece as the whole answer."""
    return Response(json.dumps(piece).encode())
