"""The user's own catalogues on the page: checked as ``drivesizer catalog check`` does, kept in memory alone."""

from __future__ import annotations

import base64
import binascii
import json
import re
from typing import TYPE_CHECKING, Any

from drivesizer.live.held import Piece

if TYPE_CHECKING:
    from drivesizer.live.worker import Worker

__all__ = ["FOLDER", "MOST", "taken"]

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
