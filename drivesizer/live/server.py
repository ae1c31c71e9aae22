"""The server of the page: it hands out files of its own, keeps the spec's file, and passes requests to the engine."""

from __future__ import annotations

import asyncio
import re
from collections.abc import AsyncGenerator, Awaitable, Callable, Mapping
from functools import cache
from importlib import resources
from pathlib import Path

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route
from starlette.types import Receive, Scope, Send

from drivesizer.errors import InputError
from drivesizer.live.guard import CATALOGUE, Guard
from drivesizer.live.own_catalogues import taken
from drivesizer.live.requests import REQUESTS, CatalogueRequest, SaveRequest, request_of
from drivesizer.live.schema import form_schema
from drivesizer.live.spec_file import content, fields, saved
from drivesizer.live.worker import Worker
from drivesizer.output.report.html.templates import own_file
from drivesizer.version import __version__

__all__ = ["application", "engines"]

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
        return await _job(request, workers)

    async def spec(_: Request) -> Response:
        found = await asyncio.to_thread(content, path)
        text = starting if found["text"] is None else found["text"]
        data = await asyncio.to_thread(fields, text)
        return JSONResponse({"name": path.name, "version": __version__, **found, "text": text, "data": data})

    async def save(request: Request) -> Response:
        try:
            wanted = request_of(SaveRequest, await request.body())
        except InputError as error:
            return _refused(400, str(error))
        return JSONResponse(saved(path, wanted))  # not in a thread: of two tabs one is first

    async def catalogue(request: Request) -> Response:
        try:
            wanted = request_of(CatalogueRequest, await request.body())
        except InputError as error:
            return _refused(400, str(error))
        return JSONResponse(await taken(wanted, own, workers["slow"]))

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
    app = Starlette(routes=routes)
    app.router.redirect_slashes = False  # an address is known as it is, or not
    return Guard(app, token, port, _styles_inside(_plotly_script()))


async def _job(request: Request, workers: Mapping[str, Worker]) -> Response:
    """A job of the engine: its pieces, a line of JSON each, as they come."""
    name = request.path_params["job"]
    if name not in REQUESTS:
        return _refused(404, "there is no such job")
    try:
        wanted = request_of(REQUESTS[name], await request.body())
    except InputError as error:
        return _refused(400, str(error))
    worker = workers["quick" if name in _AT_ONCE else "slow"]
    if worker.full:
        return _refused(503, "the server has too much to do; try again")
    tab = f"{name} {wanted['tab']} {wanted['slider']}" if name in _NEWEST else ""
    return _Stream(worker.answer(tab, name, wanted))


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


def _file_named(name: str) -> Callable[[Request], Awaitable[Response]]:
    async def found(_: Request) -> Response:
        return _response(name, (_PAGE / name).read_text(encoding="utf-8"))

    return found


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
    from drivesizer.commands.starting import KINDS, MACHINES, starter

    return JSONResponse({"kinds": {name: starter(name) for name in (*KINDS, *MACHINES)}})
