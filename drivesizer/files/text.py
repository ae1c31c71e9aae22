"""Reading a user's text file: bounded, UTF-8, and every failure one line.

What was read is remembered by its name for as long as the process lives: no output may take the place of an input.
"""

from __future__ import annotations

import os
import select
import stat
from pathlib import Path

from drivesizer.errors import InputError, reason_of

__all__ = ["decoded", "missing", "read_bytes", "read_text", "was_read"]

_PATIENCE = 2.0  # s that somebody has to begin to write into a named pipe
_PIECE = 1 << 20  # bytes read at once
_read: dict[Path, None] = {}  # absolute paths of what was read


def read_bytes(path: Path, largest: int = 64_000_000) -> bytes:
    """A file's bytes.

    Raises
    ------
    InputError
        When the file cannot be read, is larger than `largest` [bytes], or is a pipe that nobody writes into.
    """
    try:
        raw = _bytes(path, largest)
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: cannot be read ({reason_of(error)})") from None
    if len(raw) > largest:
        raise InputError(f"{path}: the file is larger than {largest // 1_000_000} MB")
    _read[path.absolute()] = None
    return raw


def _bytes(path: Path, largest: int) -> bytes:
    """No more than one byte beyond `largest`: a device tells no size."""
    found = path.stat()
    if stat.S_ISSOCK(found.st_mode) or stat.S_ISBLK(found.st_mode):
        raise InputError(f"{path}: cannot be read; expected a file")
    if found.st_size > largest:
        raise InputError(f"{path}: the file is larger than {largest // 1_000_000} MB")
    if stat.S_ISFIFO(found.st_mode):
        return _from_pipe(path, largest)
    with path.open("rb") as file:
        return file.read(largest + 1)


def _from_pipe(path: Path, largest: int) -> bytes:
    """What is written into a pipe, such as ``<(command)``; opened so that one without a writer holds nobody up."""
    pipe = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    try:
        if not select.select([pipe], [], [], _PATIENCE)[0]:
            raise InputError(f"{path}: is a pipe, and nobody writes into it; expected a file")
        os.set_blocking(pipe, True)
        found = bytearray()
        while len(found) <= largest and (piece := os.read(pipe, _PIECE)):
            found += piece
        return bytes(found[: largest + 1])
    finally:
        os.close(pipe)


def was_read(path: Path) -> Path | None:
    """The path under which a file was read in this process, through whatever link; None where it was not."""
    for name in _read:
        try:
            if name.samefile(path):
                return name
        except (OSError, ValueError):  # one of them is no longer there, or not yet
            continue
    return None


def missing(path: Path) -> str:
    """Why nothing can be read at a path, as ``no such file or directory``; empty where something lies there."""
    try:
        path.stat()
    except (OSError, ValueError) as error:
        return reason_of(error)
    return ""


def decoded(raw: bytes, path: Path) -> str:
    """Bytes as UTF-8 text, a byte-order mark left out.

    Raises
    ------
    InputError
        When the bytes are no UTF-8 text: names the line.
    """
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw[: error.start].count(b"\n") + 1
        raise InputError(f"{path}:{line}: the file is not UTF-8 text; save it as UTF-8") from None


def read_text(path: Path, largest: int = 64_000_000) -> str:
    """A file's text; both failures above apply."""
    return decoded(read_bytes(path, largest), path)
