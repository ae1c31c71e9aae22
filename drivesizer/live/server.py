"""The server of the page: it hands out files of its own, keeps the spec's file, and passes requests to the engine."""

from __future__ import annotations

import asyncio
import re
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from hashlib import blake2b
from importlib import resources
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route

from drivesizer.errors import InputError
from drivesizer.files.writing import put
from drivesizer.live.engine import JOBS
from drivesizer.live.guard import CATALOGUE, App, Guard
from drivesizer.live.own_catalogues import taken
from drivesizer.live.schema import form_schema
from drivesizer.live.worker import Worker
from drivesizer.output.report.html.templates import own_file
from drivesizer.version import __version__

__all__ = ["application"]

_PAGE = resources.files("drivesizer.live") / "page"
_KINDS = {".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".json": "application/json"}
_OF_THE_REPORT = ("style.css", "tables.js", "plots.js")
_QUICK, _SLOW = 30.0, 180.0  # s that a ranking may take, and a report
_AT_ONCE = {"answer"}  # jobs of the process that has nothing else to do


def application(path: Path, token: str, port: int, starting: str) -> App:
    """The page of one file.

    Parameters
    ----------
    path
        The spec: read, and written where the user saves it.
    token
        Head of every address.
    port
        Under which it is served.
    starting
        What the page shows where there is no file yet.

    Returns
    -------
    ASGI application
    """
    state: dict[str, Worker] = {}
    own: dict[str, bytes] = {}  # catalogues of the user, by name

    @asynccontextmanager
    async def running(_: Starlette) -> AsyncIterator[None]:
        state["quick"] = Worker(str(path), _QUICK, own)
        state["slow"] = Worker(str(path), _SLOW, own)
        yield
        for worker in state.values():
            worker.close()

    async def job(request: Request) -> Response:
        return await _job(request, state)

    async def catalogue(request: Request) -> Response:
        try:
            body = await request.json()
        except (ValueError, RecursionError):
            body = None
        return JSONResponse(await taken(body, own, state["slow"]))

    async def spec(_: Request) -> Response:
        return JSONResponse(_content(path, starting))

    async def save(request: Request) -> Response:
        return JSONResponse(_saved(path, await request.json()))

    routes = [
        Route("/", _file_named("index.html")),
        Route("/page/{name}", _page_file),
        Route("/plotly.js", _plotly),
        Route("/schema.json", _schema),
        Route("/starters.json", _starters),
        Route("/spec", spec),
        Route("/save", save, methods=["POST"]),
        Route("/do/{job}", job, methods=["POST"]),
        Route(CATALOGUE, catalogue, methods=["POST"]),
    ]
    return Guard(Starlette(routes=routes, lifespan=running), token, port, _styles_inside(_plotly_script()))


async def _job(request: Request, workers: dict[str, Worker]) -> Response:
    """A job of the engine: its pieces, a line of JSON each, as they come."""
    name = request.path_params["job"]
    try:
        body = await request.json()
    except (ValueError, RecursionError):
        body = None
    if name not in JOBS or not isinstance(body, dict) or not isinstance(body.get("text"), str):
        return JSONResponse({"kind": "refused", "lines": ["expected a spec as text"]}, 400)
    worker = workers["quick" if name in _AT_ONCE else "slow"]
    tab = f"{str(body.get('tab'))[:40]} {name}"
    return StreamingResponse(worker.answer(tab, name, body), media_type="application/x-ndjson",
                             headers={"cache-control": "no-store"})  # fmt: skip


# -- the file of the spec


def _content(path: Path, starting: str) -> dict[str, Any]:
    """Text of the file and its mark; what the page starts with where there is no file."""
    try:
        raw = path.read_bytes()
    except FileNotFoundError:
        return {"name": path.name, "text": starting, "mark": None, "version": __version__}
    except OSError as error:
        return {"name": path.name, "text": starting, "mark": None, "version": __version__, "wrong": str(error.strerror)}
    return {"name": path.name, "text": raw.decode("utf-8-sig", "replace"), "mark": _mark(raw), "version": __version__}


def _mark(raw: bytes) -> str:
    return blake2b(raw, digest_size=16).hexdigest()


def _saved(path: Path, body: Any) -> dict[str, Any]:
    """Write the file, unless it is another one than the page has read: then the user decides."""
    if not isinstance(body, dict) or not isinstance(body.get("text"), str):
        return {"kind": "refused", "lines": ["expected a spec as text"]}
    try:
        there = _mark(path.read_bytes())
    except OSError:
        there = None
    if there is not None and there != body.get("mark") and not body.get("anyway"):
        return {"kind": "changed", "lines": [f"{path.name} has been changed by another program since it was read"]}
    raw = body["text"].encode("utf-8", "replace")
    try:
        put({path: raw})
    except InputError as error:
        return {"kind": "wrong", "lines": list(error.lines)}
    return {"kind": "saved", "mark": _mark(raw)}


# -- files of the page


def _file_named(name: str) -> Callable[[Request], Awaitable[Response]]:
    async def found(_: Request) -> Response:
        return _response(name, (_PAGE / name).read_text(encoding="utf-8"))

    return found


def _response(name: str, text: str) -> Response:
    kind = _KINDS[name[name.rindex(".") :]]
    return Response(text, media_type=kind, headers={"cache-control": "no-store"})


async def _page_file(request: Request) -> Response:
    """A script or style of the page, or one that it shares with the HTML report; no other name is looked for."""
    name = request.path_params["name"]
    if name in _OF_THE_REPORT:
        return _response(name, own_file(name))
    if name in {entry.name for entry in _PAGE.iterdir()}:
        return _response(name, (_PAGE / name).read_text(encoding="utf-8"))
    if name == "colours.css":
        from drivesizer.output.report.figures.style import COLOURS

        return _response(name, f":root {{ {' '.join(f'--{key}:{value};' for key, value in COLOURS.items())} }}")
    return Response(status_code=404)


def _plotly_script() -> str:
    """The plotting library as installed; its Python part, which takes long to load, is not needed."""
    return (resources.files("plotly") / "package_data" / "plotly.min.js").read_text(encoding="utf-8")


def _styles_inside(script: str) -> list[str]:
    """Styles that a script would add to the page, of its maps: all others it adds as rules."""
    return [re.sub(r"\\(.)", r"\1", style) for style in re.findall(r"\.textContent='((?:[^'\\]|\\.)+)'", script)]


async def _plotly(_: Request) -> Response:
    return Response(
        await asyncio.to_thread(_plotly_script),
        media_type="text/javascript",
        headers={"cache-control": "private, max-age=86400"},
    )


async def _schema(_: Request) -> Response:
    return _response("schema.json", await asyncio.to_thread(form_schema))


async def _starters(_: Request) -> Response:
    from drivesizer.commands.starting import KINDS, MACHINES, starter

    return JSONResponse({"kinds": {name: starter(name) for name in (*KINDS, *MACHINES)}})
