"""``drivesizer serve`` as a process, and requests to it as bytes: those that no client sends on its own."""

from __future__ import annotations

import json
import re
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

__all__ = ["LONG", "Reply", "Serving", "serving", "within"]


LONG = """\
name: long
supply: {nominal: 24 V, current: 20 A}
load: {kind: wheeled_vehicle, mass: 45 kg, driven_wheels: 4, wheel_diameter: 152 mm, rolling_resistance: 0.02,
  inertia: 0.004 kg*m^2}
motion: {speed: 1.5 m/s, acceleration_time: 2 s, cruise_time: 20 s, rest_time: 5 s}
select: {motor: {family: [RE 25, RE 30]}, gearhead: {family: [GP 26 A, GP 32 C]}}
tolerances: {confidence: 95 %, samples: 1000000}
"""  # minutes


def within(seconds: float, holds: Callable[[], Any]) -> bool:
    """Whether something holds, as soon as it does or after some time."""
    until = time.monotonic() + seconds
    while not holds() and time.monotonic() < until:
        time.sleep(0.02)
    return bool(holds())


class Reply(NamedTuple):
    """A response; status 0 where the connection ended without one."""

    status: int
    headers: Mapping[str, str]
    body: bytes

    @property
    def pieces(self) -> list[dict[str, Any]]:
        return [json.loads(line) for line in self.body.splitlines()]


class Serving(NamedTuple):
    """A server that runs."""

    process: subprocess.Popen[str]
    port: int
    token: str
    printed: str  # what it said when it started

    @property
    def host(self) -> str:
        return f"127.0.0.1:{self.port}"

    def connect(self, timeout: float = 30.0) -> socket.socket:
        return socket.create_connection(("127.0.0.1", self.port), timeout)

    def raw(self, sent: bytes, timeout: float = 30.0) -> Reply:
        """The response to bytes as they are."""
        with self.connect(timeout) as connection:
            with suppress(OSError):  # it was refused before all of it was sent
                connection.sendall(sent)
            return reply(connection)

    def head(
        self, method: str, path: str, headers: Mapping[str, str | None] = {}, *, token: str | None = None
    ) -> bytes:
        """Start line and headers as the page's own browser sends them, some of them others; None leaves one out."""
        usual = {"Host": self.host, "Connection": "close"}
        if method == "POST":
            usual |= {
                "Origin": f"http://{self.host}",
                "Content-Type": "application/json",
                "Sec-Fetch-Site": "same-origin",
            }
        lines = [f"{name}: {value}" for name, value in {**usual, **headers}.items() if value is not None]
        start = f"{method} /{self.token if token is None else token}{path} HTTP/1.1"
        return "\r\n".join([start, *lines, "", ""]).encode("latin-1")

    def get(self, path: str, method: str = "GET", token: str | None = None, **headers: str | None) -> Reply:
        return self.raw(self.head(method, path, _named(headers), token=token))

    def post(self, path: str, body: Any, **headers: str | None) -> Reply:
        raw = body if isinstance(body, bytes) else json.dumps(body).encode()
        return self.raw(self.head("POST", path, {"Content-Length": str(len(raw)), **_named(headers)}) + raw)

    def do(self, job: str, text: str, **more: Any) -> list[dict[str, Any]]:
        """Pieces of a job."""
        return self.post(f"/do/{job}", {"text": text, **more}).pieces

    def processes(self) -> list[int]:
        """Its engines."""
        found = Path(f"/proc/{self.process.pid}/task")
        below = {int(child) for task in found.iterdir() for child in (task / "children").read_text().split()}
        return sorted(one for one in below if b"spawn_main" in Path(f"/proc/{one}/cmdline").read_bytes())


def _named(headers: Mapping[str, str | None]) -> dict[str, str | None]:
    return {name.replace("_", "-"): value for name, value in headers.items()}


def reply(connection: socket.socket) -> Reply:
    """What a server answers until it closes the connection."""
    found = bytearray()
    with suppress(OSError):
        while piece := connection.recv(1 << 16):
            found += piece
    head, _, body = bytes(found).partition(b"\r\n\r\n")
    start, *lines = head.decode("latin-1").split("\r\n")
    named = {name.lower(): value.strip() for name, _, value in (line.partition(":") for line in lines)}
    if named.get("transfer-encoding") == "chunked":
        body = _joined(body)
    return Reply(int(start.split()[1]) if start else 0, named, body)


def _joined(body: bytes) -> bytes:
    """A body without the lengths of its chunks."""
    found = b""
    while (length := int(body.partition(b"\r\n")[0] or b"0", 16)) > 0:
        body = body.partition(b"\r\n")[2]
        found, body = found + body[:length], body[length + 2 :]
    return found


@contextmanager
def serving(spec: Path, *options: str, **settings: Any) -> Iterator[Serving]:
    """A server of a spec; ended by force where it has not ended."""
    command = [sys.executable, "-m", "drivesizer", "serve", str(spec), "--no-browser", *options]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **settings)
    try:
        line = process.stdout.readline() if process.stdout else ""
        found = re.search(r"http://127\.0\.0\.1:(\d+)/([\w-]+)/", line)
        assert found, (line, process.communicate()[1])
        yield Serving(process, int(found[1]), found[2], line)
    finally:
        process.kill()
        process.communicate()
