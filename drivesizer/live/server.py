"""The page of a spec's file: it hands out files of its own, keeps the spec's file, and passes requests to engines."""

from __future__ import annotations

import base64
import binascii
import json
import re
import signal
import socket
import stat
from collections.abc import Callable
from functools import cache
from hashlib import blake2b
from importlib import resources
from importlib.util import find_spec
from pathlib import Path
from types import FrameType
from typing import Any

from drivesizer.errors import InputError, reason_of
from drivesizer.files.cache import cached, digest_of
from drivesizer.files.text import decoded
from drivesizer.files.writing import write_files
from drivesizer.files.yaml_source import YamlSource
from drivesizer.live.engine import Piece, wrong
from drivesizer.live.http import CATALOGUE, PageRequest, PageServer, Refusal, Response, reply
from drivesizer.live.requests import LONGEST, REQUESTS, CatalogueRequest, SaveRequest, request_of
from drivesizer.live.worker import Engines, FullError
from drivesizer.output.report.html.templates import own_file
from drivesizer.version import __version__

_PAGE = resources.files("drivesizer.live") / "page"
_KINDS = {".html": "text/html; charset=utf-8", ".js": "text/javascript; charset=utf-8",
          ".css": "text/css; charset=utf-8", ".json": "application/json"}  # fmt: skip
_OF_THE_REPORT = ("style.css", "tables.js", "plots.js", "weights.js", "weights_view.js")
_AT_ONCE = {"answer", "catalogues", "parts", "part", "beside", "choose"}  # jobs that are short
_NEWEST = {"answer", "sweep", "compare", "loop", "design", "parts"}  # jobs of which a tab wants the newest alone


def serve(path: Path, token: str, listening: socket.socket, starting: str, opened: Callable[[], None]) -> bool:
    """Serve the page of a file until Ctrl-C, or until the process is to end, and whether it is; ``opened`` opens it."""
    engines = Engines(str(path), content(path)["text"])
    server = PageServer(listening, token, Page(path, starting, engines).answer, _styles_inside(_plotly_script()))
    ended: list[int] = []

    def end(sent: int, _: FrameType | None) -> None:
        ended.append(sent)
        raise SystemExit

    before = {signum: signal.signal(signum, end) for signum in (signal.SIGINT, signal.SIGTERM)}
    try:
        opened()
        server.serve_forever()
    except SystemExit:
        pass
    finally:
        for signum in before:
            signal.signal(signum, signal.SIG_IGN)
        engines.close()
        server.end()
        for signum, handler in before.items():
            signal.signal(signum, handler)
    return signal.SIGTERM in ended


class Page:
    """The page of one file."""

    def __init__(self, path: Path, starting: str, engines: Engines) -> None:
        self.path, self.starting, self.engines = path, starting, engines

    def answer(self, request: PageRequest) -> Response:
        """The response to a request; a refusal where nothing is there."""
        if not request.post:
            return self._file(request.path)
        if request.path == "/save":
            task = request_of(SaveRequest, request.body)
            dropped = [name for name in self.engines.own if name in task["text"]]  # that lie nowhere
            return reply(saved(self.path, task) | {"dropped": dropped})  # of two tabs one is first
        if request.path == CATALOGUE:
            return reply(file_answer(request_of(CatalogueRequest, request.body), self.engines))
        name = request.path.removeprefix("/do/")
        if not request.path.startswith("/do/") or name not in REQUESTS:
            raise Refusal(404, "there is no such job")
        task = request_of(REQUESTS[name], request.body)
        kind = f"{name} {task['slider']}" if name in _NEWEST else ""
        try:  # pieces of a job, a line of JSON each, as they come
            return Response(self.engines.answer(
                name, task, tab=task["tab"], kind=kind, slow=name not in _AT_ONCE, has_reader=request.awaited
            ))  # fmt: skip
        except FullError:
            raise Refusal(503, "the server has too much to do; try again") from None

    def _file(self, path: str) -> Response:
        """A script or style of the page, one that it shares with the HTML report, or data; no other name is known."""
        name = path.removeprefix("/page/")
        if path == "/":
            name, text = "index.html", (_PAGE / "index.html").read_text(encoding="utf-8")
        elif path == "/plotly.js":
            return Response(_plotly_script().encode(), _KINDS[".js"], "private, max-age=86400")
        elif path == "/schema.json":
            text = form_schema()
        elif path == "/starters.json":
            from drivesizer.commands.setup import KINDS, MACHINES, starter
            from drivesizer.output.export import FORMATS

            formats = FORMATS.items()
            there = {name: form.description for name, form in formats if name != "fmu" or find_spec("pythonfmu")}
            text = json.dumps({"kinds": {kind: starter(kind) for kind in (*KINDS, *MACHINES)}, "exports": there})
        elif path == "/spec":
            spec_file = content(self.path)
            text = self.starting if spec_file["text"] is None else spec_file["text"]
            return reply(
                {"name": self.path.name, "version": __version__, **spec_file, "text": text, "data": fields(text)}
            )
        elif path == "/page/colours.css":
            from drivesizer.output.report.figures.style import COLOURS

            text = f":root {{ {' '.join(f'--{key}:{value};' for key, value in COLOURS.items())} }}"
        elif path == f"/page/{name}" and name in _OF_THE_REPORT:
            text = own_file(name)
        elif path == f"/page/{name}" and name in {
            file.name for file in _PAGE.iterdir() if Path(file.name).suffix in _KINDS
        }:
            text = (_PAGE / name).read_text(encoding="utf-8")
        else:
            raise Refusal(404, "there is no such file")
        return Response(text.encode(), _KINDS[Path(name).suffix])


@cache
def _plotly_script() -> str:
    """The plotting library as installed; its Python part, which takes long to load, is not needed."""
    return (resources.files("plotly") / "package_data" / "plotly.min.js").read_text(encoding="utf-8")


def _styles_inside(script: str) -> list[str]:
    """Styles that a script would add to the page, of its maps: all others it adds as rules."""
    return [re.sub(r"\\(.)", r"\1", style) for style in re.findall(r"\.textContent='((?:[^'\\]|\\.)+)'", script)]


# -- The schema of the form, kept between starts: to make it takes longer than all else of the first page.


def form_schema() -> str:
    """JSON with the schemas of spec and machine, and of each kind of load its axis, how it begins, and its symbols."""
    package = Path(__file__).resolve().parents[1]  # the program as it is: for those who change it, by its files' dates
    dates = sorted(f"{path.name} {path.stat().st_mtime_ns}" for path in package.rglob("*.py"))

    def page_data() -> bytes:
        from drivesizer.commands.setup import KINDS, starter
        from drivesizer.loads import AXES
        from drivesizer.output.sketch import SKETCHES, symbols
        from drivesizer.spec.machine import machine_schema
        from drivesizer.spec.robot import RobotSpec

        axes = {**AXES, "recorded": None}  # which brings its own motion
        starts = {kind: YamlSource(starter(kind), kind).data for kind in AXES if kind in KINDS}
        begin = {kind: {name: data.get(name) for name in ("load", "motion")} for kind, data in starts.items()}
        schemas = {"spec": RobotSpec.model_json_schema(), "machine": machine_schema(), "axes": axes, "starts": begin,
                 "symbols": {kind: symbols(kind) for kind in SKETCHES}}  # fmt: skip
        return json.dumps(schemas, ensure_ascii=False).encode()

    return cached(f"schema-{digest_of(__version__.encode(), *map(str.encode, dates))}.json", page_data).decode()


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
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            raise InputError(f"{path}: expected a file")
        if status.st_size > LONGEST:
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
        return wrong(*error.lines)
    return {"kind": "saved", "mark": _mark(raw)}


# -- The user's own catalogues: checked as ``drivesizer catalog check`` does, kept in memory alone.


FOLDER = "dropped"  # of the names by which a spec finds them
MOST = 4  # of them
_LARGEST = 16_000_000  # bytes of each, as of any catalogue
_UNUSUAL = re.compile(r"[^A-Za-z0-9._-]+")
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9._-]{0,79}[.](ya?ml|csv|tsv|txt|xlsx|pdf|json|cfg|xml|mjcf|log|wpilog)")


def file_answer(request: Piece, engines: Engines) -> Piece:
    """Keep a catalogue where it is right, or give one up; a log is answered with its fit."""
    own, plain = engines.own, _UNUSUAL.sub("_", request["name"][-80:])  # a file's name as specs have it
    if not _NAME.fullmatch(plain):
        return wrong("expected a catalogue, a file that ends in .yaml, a table, data sheet or log, e.g. .csv or .pdf")
    file_name = f"{FOLDER}/{plain}"
    name = file_name if plain.endswith((".yaml", ".yml")) else f"{FOLDER}/{Path(plain).stem}.yaml"
    if request["content"] is None:
        own.pop(name, None)
        return {"kind": "given up", "name": name}
    try:
        content = base64.b64decode(request["content"], validate=True)
    except (binascii.Error, ValueError):
        return wrong(f"{file_name}: expected its content in base64")
    if len(content) > _LARGEST:
        return wrong(f"{file_name}: the file is larger than {_LARGEST // 1_000_000} MB")
    verdict = wrong(f"{name}: another one came before this was checked")
    task = {"name": file_name, "content": content, "text": request["text"], "given": request.get("given")}
    for line in engines.answer("check", task, kind=f"check {name}", slow=True):
        verdict = json.loads(line)
    if verdict["kind"] == "right" and name not in own and len(own) >= MOST:
        return wrong(f"{name}: {MOST} catalogues are here already ({', '.join(own)}); remove one of them first")
    if verdict["kind"] == "right" or (verdict["kind"] == "contradictory" and request["anyway"]):
        own[name] = verdict.get("text", "").encode() or content
        return verdict | {"kind": "kept"}
    return verdict
