"""Who may request what: this machine's own browser, by the address that the command printed, and nobody else."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable, Iterable, Mapping, MutableMapping
from secrets import compare_digest
from typing import Any

from drivesizer.output.report.html.templates import digest

__all__ = ["CATALOGUE", "LARGEST", "Guard"]

Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
App = Callable[[Message, Receive, Send], Awaitable[None]]

LARGEST = 4_000_000  # bytes of a request: a spec is at most 2 MB
CATALOGUE = "/catalogue"  # where a request brings a catalogue
_LARGEST_OF = {CATALOGUE: 22_000_000}  # 16 MB in base64
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


class Guard:
    """Refuses requests of other hosts, origins and addresses, and those that are too large; adds the headers to all."""

    def __init__(self, app: App, token: str, port: int, styles: Iterable[str] = ()) -> None:
        self.app, self.token = app, token
        digests = "".join(f" '{digest(style)}'" for style in styles)  # of styles that a library brings inside
        self.headers = {"content-security-policy": _POLICY.format(digests), **_HEADERS}
        self.hosts = {f"127.0.0.1:{port}", f"localhost:{port}"}

    async def __call__(self, scope: Message, receive: Receive, send: Send) -> None:
        """Pass a request on, or refuse it."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        refused = self._refused(scope)
        if refused:
            await _refuse(_with_headers(send, self.headers), *refused)
            return
        path = self._path(scope)
        scope = {**scope, "path": path, "raw_path": None, "root_path": ""}
        await self.app(scope, _bounded(receive, _largest(path)), _with_headers(send, self.headers))

    def _path(self, scope: Message) -> str:
        """Path of a request behind the token."""
        return scope["path"][len(self.token) + 1 :] or "/"

    def _refused(self, scope: Message) -> tuple[int, str] | None:
        """Status and reason of a refusal; None where the request may pass."""
        headers = {name.decode("latin-1").lower(): value.decode("latin-1") for name, value in scope["headers"]}
        if headers.get("host") not in self.hosts:  # another name that a rebound DNS leads here
            return 421, "this page is served to its own machine alone"
        origin = headers.get("origin")
        if origin is not None and origin not in {f"http://{host}" for host in self.hosts}:
            return 403, "expected a request of this page itself"
        if headers.get("sec-fetch-site", "none") not in ("same-origin", "none"):
            return 403, "expected a request of this page itself"
        start = f"/{self.token}/"
        if not compare_digest(scope["path"][: len(start)].encode(), start.encode()):
            return 404, "nothing is here; open the address that drivesizer serve printed"
        return self._refused_content(scope["method"], headers, origin, _largest(self._path(scope)))

    @staticmethod
    def _refused_content(
        method: str, headers: dict[str, str], origin: str | None, largest: int
    ) -> tuple[int, str] | None:
        if method == "GET":
            return None
        if method != "POST":
            return 405, "expected GET or POST"
        if origin is None:  # every browser names it; without it a form of an old one might pass
            return 403, "a request that changes something names its origin"
        if headers.get("content-type", "").split(";")[0].strip() != "application/json":
            return 415, "expected application/json"
        length = headers.get("content-length", "0")
        if not length.isascii() or not length.isdigit() or int(length) > largest:
            return 413, f"expected at most {largest // 1_000_000} MB"
        return None


def _largest(path: str) -> int:
    """Bytes that the body of a request may have."""
    return _LARGEST_OF.get(path, LARGEST)


def _with_headers(send: Send, headers: Mapping[str, str]) -> Send:
    async def sent(message: Message) -> None:
        if message["type"] == "http.response.start":
            known = {name.lower() for name, _ in message["headers"]}
            more = [(name.encode(), value.encode()) for name, value in headers.items() if name.encode() not in known]
            message = {**message, "headers": [*message["headers"], *more]}
        await send(message)

    return sent


def _bounded(receive: Receive, largest: int) -> Receive:
    """Ends a body that is longer than it may be, whatever length it claimed."""
    taken = 0

    async def received() -> Message:
        nonlocal taken
        message = await receive()
        taken += len(message.get("body", b""))
        return message if taken <= largest else {"type": "http.disconnect"}

    return received


async def _refuse(send: Send, status: int, reason: str) -> None:
    body = json.dumps({"kind": "refused", "lines": [reason]}).encode()
    headers = [
        (b"content-type", b"application/json"),
        (b"content-length", str(len(body)).encode()),
        (b"connection", b"close"),
    ]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})
