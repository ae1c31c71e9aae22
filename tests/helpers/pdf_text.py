"""The text of a PDF by pypdf, whose parser of pages is passed by: it takes longer than the rest and half of a report.

Operators of text alone are kept, as the typesetter writes them.
"""

from __future__ import annotations

import io
import re
from functools import lru_cache
from typing import Any

import pypdf
from pypdf.generic import ArrayObject, ByteStringObject, ContentStream, FloatObject, NameObject

_NESTED = rb"(?:[^\\()]|\\.|\((?:[^\\()]|\\.|\([^\\()]*\))*\))*"
_TOKEN = re.compile(
    rb"\((?P<text>%s)\)|<(?P<hex>[0-9A-Fa-f]*)>|/(?P<name>[^\s/\[\]()<>]+)|(?P<number>[-+]?[\d.]+)|(?P<open>\[)"
    rb"|(?P<close>\])|<<(?:[^<>]|<<[^<>]*>>|<[^<>]*>)*>>|(?P<operator>[A-Za-z'\"][\w*]*)" % _NESTED,
    re.DOTALL,
)
_ESCAPED = re.compile(rb"\\([0-7]{1,3}|\r\n|.)", re.DOTALL)
_LETTERS = {b"n": b"\n", b"r": b"\r", b"t": b"\t", b"b": b"\b", b"f": b"\f", b"\n": b"", b"\r\n": b"", b"\r": b""}
_OF_TEXT = frozenset(b"q Q cm BT ET Tf Tm Td TD T* TJ Tj TL Tc Tw Tz Ts Do ' \"".split())


@lru_cache(maxsize=8)
def texts_of(content: bytes, most: int | None = None) -> tuple[str, ...]:
    """The text of each page, or of each of the first."""
    reader = pypdf.PdfReader(io.BytesIO(content))
    pages = reader.pages[:most]
    for page in pages:
        page[NameObject("/Contents")] = _of_text(page["/Contents"], reader)
        _forms(page["/Resources"], reader)
    return tuple(page.extract_text() for page in pages)


def _forms(resources: Any, reader: pypdf.PdfReader) -> None:
    """Drawings within a page have streams of their own."""
    drawings = resources.get("/XObject", {})
    for name, drawing in [(name, drawings[name]) for name in drawings]:
        if drawing["/Subtype"] == "/Form" and not isinstance(drawing, ContentStream):
            drawings[NameObject(name)] = _of_text(drawing, reader)
            _forms(drawing.get("/Resources", {}), reader)


def _of_text(stream: Any, reader: pypdf.PdfReader) -> ContentStream:
    found = ContentStream(None, reader, "bytes")
    found.operations = _operations(stream.get_data())
    found.update({key: value for key, value in stream.items() if key not in ("/Length", "/Filter")})
    return found


def _operations(data: bytes) -> list[tuple[Any, bytes]]:
    """Operators of text with their operands."""
    found: list[tuple[Any, bytes]] = []
    every: list[Any] = []
    now = every  # or the array that is open
    for token in _TOKEN.finditer(data):
        kind, value = token.lastgroup, token[token.lastgroup or 0]
        if kind == "number":
            now.append(FloatObject(value))
        elif kind == "operator":
            if value in _OF_TEXT:
                found.append((every, value))
            every = now = []
        elif kind == "text":
            now.append(ByteStringObject(_ESCAPED.sub(_letter, value) if b"\\" in value else value))
        elif kind == "hex":
            now.append(ByteStringObject(bytes.fromhex(value.decode())))
        elif kind == "name":
            now.append(NameObject(f"/{value.decode()}"))
        elif kind == "open":
            now = ArrayObject()
            every.append(now)
        elif kind == "close":
            now = every
    return found


def _letter(match: re.Match[bytes]) -> bytes:
    escaped = match[1]
    return bytes([int(escaped, 8) & 255]) if escaped[:1].isdigit() else _LETTERS.get(escaped, escaped)
