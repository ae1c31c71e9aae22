"""The file of the page: read, and written where the user saves it, unless another program has changed it."""

from __future__ import annotations

import stat
from hashlib import blake2b
from pathlib import Path
from typing import Any

from drivesizer.errors import InputError, reason_of
from drivesizer.files.text import decoded
from drivesizer.files.writing import write_files
from drivesizer.files.yaml_source import YamlSource
from drivesizer.live.held import Piece
from drivesizer.live.requests import LONGEST

__all__ = ["content", "fields", "saved"]

_MARK = "\ufeff"
_SHORT = 100_000  # characters of a text that is read at once


def content(path: Path) -> Piece:
    """Text of the file, with line feeds alone, and its mark."""
    try:
        raw = _raw(path)
        text = None if raw is None else decoded(raw, path).replace("\r\n", "\n")
    except InputError as error:
        return {"text": None, "mark": None, "wrong": str(error).removeprefix(f"{path}").lstrip(": ")}
    return {"text": text, "mark": None if raw is None else _mark(raw)}


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
    """Write the file, unless it is another one than the page has read: then the user decides."""
    try:
        there = _raw(path)
        if there is not None and _mark(there) != request["mark"] and not request["anyway"]:
            return {"kind": "changed", "lines": [f"{path.name} has been changed by another program since it was read"]}
        raw = _written(request["text"], there or b"")
        write_files({path: raw})
    except InputError as error:
        return {"kind": "wrong", "lines": list(error.lines)}
    return {"kind": "saved", "mark": _mark(raw)}


def _written(text: str, before: bytes) -> bytes:
    """The text with the byte-order mark and the line ends of the file that it replaces."""
    plain = text.replace("\r\n", "\n")
    ends = b"\r\n" in before and before.count(b"\r\n") == before.count(b"\n")
    mark = _MARK if before.startswith(_MARK.encode()) else ""
    return (mark + (plain.replace("\n", "\r\n") if ends else plain)).encode()
