"""Who may request what: this machine's own browser alone, and of each job only known fields of known kinds."""

from __future__ import annotations

import asyncio
import math
import sys
from collections.abc import Awaitable, Callable, Iterable, MutableMapping
from secrets import compare_digest
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, create_model
from starlette.datastructures import MutableHeaders
from starlette.responses import JSONResponse, Response

from drivesizer.catalog import PARTS
from drivesizer.catalog.conditions import OPTIONS
from drivesizer.errors import InputError, printable
from drivesizer.live.engine import Piece
from drivesizer.output.report.html.templates import digest

# -- Requests that the page may make: the fields of each job with their kinds and limits. Anything else is refused.


LONGEST = 2_000_000  # characters of a spec, as of a file
_DEEPEST = 20  # steps of a path, as of a file, and groups in a value


def _plain(value: Any, deep: int = 0) -> Any:
    """A value that YAML has: of bounded depth, without numbers that are none."""
    if deep > _DEEPEST or (isinstance(value, float) and not math.isfinite(value)):
        raise ValueError("expected a text, a finite number, a list or a dict")
    if isinstance(value, dict | list):
        for below in value.values() if isinstance(value, dict) else value:
            _plain(below, deep + 1)
    return value


_Word = Annotated[str, Field(max_length=1000)]
_Step = _Word | Annotated[int, Field(ge=0, le=9999)]
_Path = Annotated[list[_Step], Field(min_length=1, max_length=_DEEPEST)]
_Value = Annotated[Any, AfterValidator(_plain)]
_Number = Annotated[float, Field(allow_inf_nan=False)]


class SpecRequest(BaseModel):
    """A spec with edits of its fields."""

    model_config = ConfigDict(strict=True)
    text: Annotated[str, Field(max_length=LONGEST)]
    edits: Annotated[list[tuple[_Path, _Value, bool | None]], Field(max_length=100)] = []
    tab: _Word = ""  # of the browser
    slider: _Word = ""  # in the tab


class SaveRequest(BaseModel):
    """A text for the file of the page, which is replaced where it is the one that the page has read."""

    model_config = ConfigDict(strict=True)
    text: Annotated[str, Field(max_length=LONGEST)]
    mark: _Word | None = None
    anyway: bool = False


class CatalogueRequest(BaseModel):
    """A catalogue of the user, or that one is given up."""

    model_config = ConfigDict(strict=True)
    name: str
    content: str | None = None  # base64
    anyway: bool = False


_Names = Annotated[list[_Word], Field(max_length=500)]
_Section: Any = Literal[tuple(PARTS)]
_Option: Any = Literal[tuple(OPTIONS)]

# of each job, what its request has beside the spec: kind, and what stands for it where it is left out
_FIELDS: dict[str, dict[str, Any]] = {
    "answer": {},
    "sweep": {"path": (_Path, ...), "values": (Annotated[list[_Word | int | _Number], Field(max_length=64)], ...)},
    "rejected": {"motor": (_Word, ...), "gearhead": (_Word, ...)},
    "compare": {"sets": (Annotated[list[tuple[_Word, _Word]], Field(max_length=4)], ...)},
    "loop": {}, "report": {"form": (_Word, ...)}, "export": {"form": (_Word, ...)}, "document": {}, "catalogues": {},
    "parts": {
        "section": (_Section, ...), "catalogues": (_Names, ...), "options": (dict[_Option, _Word], {}),
        "where": (Annotated[list[_Word], Field(max_length=20)], []), "piece": (_Word, ""), "sort": (_Word, ""),
        "excluded": (bool, False), "start": (Annotated[int, Field(ge=0)], 0),
    },
    "part": {"catalogue": (_Word, ...), "section": (_Section, ...), "part": (_Word, ...)},
    "beside": {
        "section": (_Section, ...),
        "parts": (Annotated[list[tuple[_Word, _Word]], Field(min_length=2, max_length=4)], ...),
    },
    "choose": {  # a part by catalogue, section and number, or catalogues
        "part": (tuple[_Word, _Section, _Word] | None, None), "family": (bool, False), "catalogues": (_Names, []),
        "add": (bool, False), "axis": (_Word, ""),
    },
}  # fmt: skip
REQUESTS: dict[str, type[SpecRequest]] = {
    job: create_model(job, __base__=SpecRequest, **fields) for job, fields in _FIELDS.items()
}


def request_of(model: type[BaseModel], body: bytes) -> Piece:
    """Fields of a request."""
    try:
        return model.model_validate_json(body).model_dump()
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False, include_input=False)[0]
        place = ".".join(map(str, first["loc"]))
        raise InputError(
            f"a request of the page is malformed{f' at {place}' if place else ''}: {first['msg']}"
        ) from None


# -- Who may request what: this machine's own browser, by the address that the command printed, and nobody else.


Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
App = Callable[[Message, Receive, Send], Awaitable[None]]
Refusal = tuple[int, str]  # status and reason

LARGEST = 4_000_000  # bytes of a request: a spec is at most 2 MB
CATALOGUE = "/catalogue"  # where a request brings a catalogue
_LARGEST_OF = {CATALOGUE: 22_000_000}  # 16 MB in base64
_PATIENCE = 10.0  # s in which a request must have come
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
_ELSEWHERE = 403, "expected a request of this page itself"


class Guard:
    """Refuses requests of other hosts, origins and addresses, those too large or too slow, and hides what fails."""

    def __init__(self, app: App, token: str, port: int, styles: Iterable[str] = ()) -> None:
        self.app, self.token = app, token
        digests = "".join(f" '{digest(style)}'" for style in styles)  # of styles that a library brings inside
        self.headers = {"content-security-policy": _POLICY.format(digests), **_HEADERS}  # of all responses
        self.once = ""  # address that leads to the page, once
        self.hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}
        if port == 80:  # a browser leaves it out
            self.hosts |= {"127.0.0.1", "localhost"}

    async def __call__(self, scope: Message, receive: Receive, send: Send) -> None:
        """Pass a request on, or refuse it; no response is kept, but for one that says how long."""
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
        if scope["type"] != "http":
            return

        async def sent(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).setdefault("cache-control", "no-store")
            await send(message)

        path, body = scope["path"][len(self.token) + 1 :], b""
        largest = _LARGEST_OF.get(path, LARGEST)
        refused = self._refused(scope, largest)
        if refused and refused[0] == 404 and self.once and compare_digest(scope["path"].encode(), self.once.encode()):
            self.once = ""  # others may see the address that a browser was started with
            await Response(status_code=303, headers={"location": f"/{self.token}/"})(scope, receive, sent)
            return
        if not refused and scope["method"] == "POST":
            refused, body = await _body(receive, largest)
        if refused:
            status, reason = refused
            headers = {"connection": "close"} | ({"allow": "GET, HEAD, POST"} if status == 405 else {})
            response = JSONResponse({"kind": "refused", "lines": [reason]}, status, headers)
            await response(scope, receive, sent)
            return
        rest = [body]

        async def received() -> Message:
            """The body that was received, and after it what else there is: that the browser has gone away."""
            return {"type": "http.request", "body": rest.pop(), "more_body": False} if rest else await receive()

        try:
            await self.app({**scope, "path": path, "raw_path": path.encode(), "root_path": ""}, received, sent)
        except Exception as error:  # the page has its status 500; the terminal has a line
            found = printable(f"{type(error).__name__}: {error}"[:300]).replace(self.token, "...")
            print(f"drivesizer: a fault of drivesizer itself ({found}); please report it", file=sys.stderr, flush=True)

    def _refused(self, scope: Message, largest: int) -> Refusal | None:
        """Status and reason of a refusal; None where the request may pass."""
        names = [name.decode("latin-1").lower() for name, _ in scope["headers"]]
        headers = dict(zip(names, (value.decode("latin-1") for _, value in scope["headers"]), strict=True))
        if any(names.count(name) > 1 for name in _ONCE):
            return 400, "a header is given twice"
        if headers.get("host") not in self.hosts:  # another name that a rebound DNS leads here
            return 421, "this page is served to its own machine alone"
        origin = headers.get("origin")
        if origin is not None and origin not in {f"http://{host}" for host in self.hosts}:
            return _ELSEWHERE
        if headers.get("sec-fetch-site", "none") not in ("same-origin", "none"):
            return _ELSEWHERE
        start = f"/{self.token}/"
        if not compare_digest(scope["path"][: len(start)].encode(), start.encode()):
            return 404, "nothing is here; open the address that drivesizer serve printed"
        if scope["method"] in ("GET", "HEAD"):
            return None
        if scope["method"] != "POST":
            return 405, "expected GET or POST"
        if origin is None:  # every browser names it; without it a form of an old one might pass
            return 403, "a request that changes something names its origin"
        if headers.get("content-type", "").split(";")[0].strip().lower() != "application/json":
            return 415, "expected application/json"
        length = headers.get("content-length", "0")
        if not length.isascii() or not length.isdigit() or len(length) > 12 or int(length) > largest:
            return _too_large(largest)
        return None


def _too_large(largest: int) -> Refusal:
    return 413, f"expected at most {largest // 1_000_000} MB"


async def _body(receive: Receive, largest: int) -> tuple[Refusal | None, bytes]:
    """The whole body, whatever length it claimed."""
    found = bytearray()
    try:
        async with asyncio.timeout(_PATIENCE):
            while True:
                message = await receive()
                found += message.get("body", b"")
                if len(found) > largest:
                    return _too_large(largest), b""
                if message["type"] != "http.request":
                    return (400, "the request ended in the middle"), b""
                if not message.get("more_body", False):
                    return None, bytes(found)
    except TimeoutError:
        return (408, f"expected the whole request within {_PATIENCE:g} s"), b""
