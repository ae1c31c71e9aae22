"""The server of the page: it hands out files of its own, keeps the spec's file, and passes requests to the engine."""

from __future__ import annotations

import asyncio
import base64
import binascii
import json
import re
import signal
import socket
import stat
from collections.abc import AsyncGenerator, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from hashlib import blake2b
from importlib import resources
from pathlib import Path
from types import FrameType
from typing import Any

import h11
import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route
from starlette.types import Receive, Scope, Send
from uvicorn.protocols.http.h11_impl import H11Protocol

from drivesizer.errors import InputError, reason_of
from drivesizer.files.cache import digest_of, kept
from drivesizer.files.text import decoded
from drivesizer.files.writing import write_files
from drivesizer.files.yaml_source import YamlSource
from drivesizer.live.engine import Piece
from drivesizer.live.guard import CATALOGUE, LONGEST, REQUESTS, App, CatalogueRequest, Guard, SaveRequest, request_of
from drivesizer.live.worker import Worker
from drivesizer.output.report.html.templates import own_file
from drivesizer.version import __version__

# -- Connections of the server: patience with them, headers of every response, and their end.


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


# -- The schema of the form, kept between starts: to make it takes longer than all else of the first page.


def form_schema() -> str:
    """JSON with the schemas of spec and machine, along or about which axis a kind of load moves, and how one begins."""
    package = Path(__file__).resolve().parents[1]  # the program as it is: for those who change it, by its files' dates
    dates = sorted(f"{path.name} {path.stat().st_mtime_ns}" for path in package.rglob("*.py"))

    def made() -> bytes:
        from drivesizer.commands.setup import KINDS, starter
        from drivesizer.loads.kinds import AXES
        from drivesizer.spec.machine import machine_schema
        from drivesizer.spec.robot import RobotSpec

        axes = {**AXES, "recorded": None}  # which brings its own motion
        starts = {kind: YamlSource(starter(kind), kind).data for kind in AXES if kind in KINDS}
        begin = {kind: {name: data.get(name) for name in ("load", "motion")} for kind, data in starts.items()}
        found = {"spec": RobotSpec.model_json_schema(), "machine": machine_schema(), "axes": axes, "starts": begin}
        return json.dumps(found, ensure_ascii=False).encode()

    return kept(f"schema-{digest_of(__version__.encode(), *map(str.encode, dates))}.json", made).decode()


# -- The file of the page: read, and written where the user saves it, unless another program has changed it.


_MARK = "\ufeff"
_SHORT = 100_000  # characters of a text that is read at once


def content(path: Path) -> Piece:
    """Text of the file, with line feeds alone, and its mark."""
    try:
        raw = _raw(path)
        if raw is None:
            return {"text": None, "mark": None}
        return {"text": decoded(raw, path).replace("\r\n", "\n"), "mark": _mark(raw)}
    except InputError as error:
        return {"text": None, "mark": None, "wrong": str(error).removeprefix(f"{path}").lstrip(": ")}


def fields(text: str) -> Any:
    """Fields of a spec, for the form before an engine is ready."""
    try:
        return YamlSource(text, "spec").data if len(text) <= _SHORT else None
    except InputError:
        return None


def _raw(path: Path) -> bytes | None:
    """Bytes of the file; None where there is none. A device or a pipe may never end."""
    try:
        found = path.stat()
        if not stat.S_ISREG(found.st_mode):
            raise InputError(f"{path}: expected a file")
        if found.st_size > LONGEST:
            raise InputError(f"{path}: the file is larger than {LONGEST // 1_000_000} MB")
        return path.read_bytes()
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: {reason_of(error)}") from None


def _mark(raw: bytes) -> str:
    return blake2b(raw, digest_size=16).hexdigest()


def saved(path: Path, request: Piece) -> Piece:
    """Write the file, unless it is another one than the page has read: then the user decides.

    It keeps the byte-order mark and the line ends of the file that it replaces.
    """
    try:
        there = _raw(path)
        if there is not None and _mark(there) != request["mark"] and not request["anyway"]:
            return {"kind": "changed", "lines": [f"{path.name} has been changed by another program since it was read"]}
        before, plain = there or b"", request["text"].replace("\r\n", "\n")
        ends = b"\r\n" in before and before.count(b"\r\n") == before.count(b"\n")
        mark = _MARK if before.startswith(_MARK.encode()) else ""
        raw = (mark + (plain.replace("\n", "\r\n") if ends else plain)).encode()
        write_files({path: raw})
    except InputError as error:
        return {"kind": "wrong", "lines": list(error.lines)}
    return {"kind": "saved", "mark": _mark(raw)}


# -- The user's own catalogues: checked as ``drivesizer catalog check`` does, kept in memory alone.


FOLDER = "dropped"  # of the names by which a spec finds them
MOST = 4  # of them
_LARGEST = 16_000_000  # bytes of each, as of any catalogue
_UNUSUAL = re.compile(r"[^A-Za-z0-9._-]+")
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9._-]{0,79}[.]ya?ml")


async def taken(body: Any, own: dict[str, bytes], worker: Worker) -> Piece:
    """Keep a catalogue where it is right, or give one up."""
    name = _name(body.get("name")) if isinstance(body, dict) else ""
    if not name:
        return _wrong("expected the name of a file that ends in .yaml, and its content")
    if body.get("content") is None:
        own.pop(name, None)
        return {"kind": "given up", "name": name}
    try:
        content = base64.b64decode(str(body["content"]), validate=True)
    except (binascii.Error, ValueError):
        return _wrong(f"{name}: expected its content in base64")
    if len(content) > _LARGEST:
        return _wrong(f"{name}: the file is larger than {_LARGEST // 1_000_000} MB")
    if name not in own and len(own) >= MOST:
        return _wrong(f"{name}: {MOST} catalogues are here already ({', '.join(own)}); remove one of them first")
    found = await _checked(name, content, worker)
    if found["kind"] == "right" or (found["kind"] == "contradictory" and body.get("anyway")):
        own[name] = content
        return found | {"kind": "kept"}
    return found


def _name(given: Any) -> str:
    """A file's name as specs have it; empty where it is none."""
    plain = _UNUSUAL.sub("_", str(given)[-80:])
    return f"{FOLDER}/{plain}" if _NAME.fullmatch(plain) else ""


def _wrong(line: str) -> Piece:
    return {"kind": "wrong", "lines": [line]}


async def _checked(name: str, content: bytes, worker: Worker) -> Piece:
    found: Piece = _wrong(f"{name}: another one came before this was checked")
    async for line in worker.answer(f"check {name}", "check", {"name": name, "content": content}):
        found = json.loads(line)
    return found


# -- The page itself.


_PAGE = resources.files("drivesizer.live") / "page"
_KINDS = {".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".json": "application/json"}
_OF_THE_REPORT = ("style.css", "tables.js", "plots.js", "weights.js", "weights_view.js")
_QUICK, _SLOW = 60.0, 180.0  # s that a ranking may take, and a report
_AT_ONCE = {"answer", "catalogues", "parts", "part", "beside", "choose"}  # jobs of the process for what is short
_NEWEST = {"answer", "sweep", "compare", "loop", "parts"}  # jobs of which a tab wants the newest alone


def engines(path: Path, own: Mapping[str, bytes]) -> dict[str, Worker]:
    """Processes of the engine: a quick one for the ranking, and one for what takes longer."""
    spec = content(path)["text"]
    return {"quick": Worker(str(path), spec, _QUICK, own), "slow": Worker(str(path), spec, _SLOW, own)}


def application(
    path: Path, token: str, port: int, starting: str, workers: Mapping[str, Worker], own: dict[str, bytes]
) -> Guard:
    """The page of one file."""

    async def job(request: Request) -> Response:
        """A job of the engine: its pieces, a line of JSON each, as they come."""
        name = request.path_params["job"]
        if name not in REQUESTS:
            return _refused(404, "there is no such job")
        wanted = request_of(REQUESTS[name], await request.body())
        worker = workers["quick" if name in _AT_ONCE else "slow"]
        if worker.full:
            return _refused(503, "the server has too much to do; try again")
        tab = f"{name} {wanted['tab']} {wanted['slider']}" if name in _NEWEST else ""
        return _Stream(worker.answer(tab, name, wanted))

    async def spec(_: Request) -> Response:
        found = await asyncio.to_thread(content, path)
        text = starting if found["text"] is None else found["text"]
        data = await asyncio.to_thread(fields, text)
        return JSONResponse({"name": path.name, "version": __version__, **found, "text": text, "data": data})

    async def save(request: Request) -> Response:
        return JSONResponse(saved(path, request_of(SaveRequest, await request.body())))  # of two tabs one is first

    async def catalogue(request: Request) -> Response:
        return JSONResponse(await taken(request_of(CatalogueRequest, await request.body()), own, workers["slow"]))

    async def malformed(_: Request, error: Exception) -> Response:
        return _refused(400, str(error))

    routes = [
        Route("/", _index),
        Route("/page/{name}", _page_file),
        Route("/plotly.js", _plotly),
        Route("/schema.json", _schema),
        Route("/starters.json", _starters),
        Route("/spec", spec),
        Route("/save", save, methods=["POST"]),
        Route("/do/{job}", job, methods=["POST"]),
        Route(CATALOGUE, catalogue, methods=["POST"]),
    ]
    app = Starlette(routes=routes, exception_handlers={InputError: malformed})
    app.router.redirect_slashes = False  # an address is known as it is, or not
    return Guard(app, token, port, _styles_inside(_plotly_script()))


class _Stream(StreamingResponse):
    """Pieces as they come; where the browser goes away, the worker knows at once."""

    media_type = "application/x-ndjson"

    def __init__(self, pieces: AsyncGenerator[bytes]) -> None:
        super().__init__(pieces)
        self.pieces = pieces

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        try:
            await super().__call__(scope, receive, send)
        finally:
            await self.pieces.aclose()


def _refused(status: int, reason: str) -> Response:
    return JSONResponse({"kind": "refused", "lines": [reason]}, status)


# -- files of the page


async def _index(_: Request) -> Response:
    return _response("index.html", (_PAGE / "index.html").read_text(encoding="utf-8"))


def _response(name: str, text: str) -> Response:
    return Response(text, media_type=_KINDS[Path(name).suffix])


async def _page_file(request: Request) -> Response:
    """A script or style of the page, or one that it shares with the HTML report; no other name is looked for."""
    name = request.path_params["name"]
    if name in _OF_THE_REPORT:
        return _response(name, own_file(name))
    if name in {entry.name for entry in _PAGE.iterdir() if Path(entry.name).suffix in _KINDS}:
        return _response(name, (_PAGE / name).read_text(encoding="utf-8"))
    if name == "colours.css":
        from drivesizer.output.report.figures.style import COLOURS

        return _response(name, f":root {{ {' '.join(f'--{key}:{value};' for key, value in COLOURS.items())} }}")
    return _refused(404, "there is no such file")


@cache
def _plotly_script() -> str:
    """The plotting library as installed; its Python part, which takes long to load, is not needed."""
    return (resources.files("plotly") / "package_data" / "plotly.min.js").read_text(encoding="utf-8")


def _styles_inside(script: str) -> list[str]:
    """Styles that a script would add to the page, of its maps: all others it adds as rules."""
    return [re.sub(r"\\(.)", r"\1", style) for style in re.findall(r"\.textContent='((?:[^'\\]|\\.)+)'", script)]


async def _plotly(_: Request) -> Response:
    headers = {"cache-control": "private, max-age=86400"}
    return Response(_plotly_script(), media_type="text/javascript", headers=headers)


async def _schema(_: Request) -> Response:
    return _response("schema.json", await asyncio.to_thread(form_schema))


async def _starters(_: Request) -> Response:
    from drivesizer.commands.setup import KINDS, MACHINES, starter

    return JSONResponse({"kinds": {name: starter(name) for name in (*KINDS, *MACHINES)}})
