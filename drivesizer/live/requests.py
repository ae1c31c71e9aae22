"""Requests that the page may make: the fields of each job with their kinds and limits. Anything else is refused."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, create_model

from drivesizer.catalog import PARTS
from drivesizer.catalog.query import OPTIONS
from drivesizer.errors import InputError
from drivesizer.live.engine import Piece

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
    """A catalogue of the user, a table or data sheet that becomes one, or a log; or that a catalogue is given up."""

    model_config = ConfigDict(strict=True)
    text: Annotated[str, Field(max_length=LONGEST)] = ""  # of the spec
    name: str
    content: str | None = None  # base64
    anyway: bool = False
    given: dict[Literal["manufacturer", "family", "kind"], _Word] = {}  # of the parts of a table


_Names = Annotated[list[_Word], Field(max_length=500)]
_Section: Any = Literal[tuple(PARTS)]
_Option: Any = Literal[tuple(OPTIONS)]

# of each job, what its request has beside the spec: kind, and what stands for it where it is left out
_FIELDS: dict[str, dict[str, Any]] = {
    "answer": {},
    "sweep": {"path": (_Path, ...), "values": (Annotated[list[_Word | int | _Number], Field(max_length=64)], ...)},
    "rejected": {"motor": (_Word, ...), "gearhead": (_Word, ...)},
    "compare": {"sets": (Annotated[list[tuple[_Word, _Word]], Field(max_length=4)], ...)},
    "loop": {}, "design": {}, "document": {}, "catalogues": {},
    "report": {"form": (_Word, ...)}, "export": {"form": (_Word, ...)},
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
