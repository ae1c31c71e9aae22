"""Reading a user's text file: bounded, UTF-8, and every failure one line."""

from __future__ import annotations

from pathlib import Path

from drivesizer.errors import InputError

__all__ = ["decoded", "missing", "read_bytes", "read_text"]


def read_bytes(path: Path, largest: int = 64_000_000) -> bytes:
    """A file's bytes.

    Raises
    ------
    InputError
        When the file cannot be read, or is larger than `largest` [bytes].
    """
    try:
        size = path.stat().st_size
        with path.open("rb") as file:
            raw = file.read(largest + 1) if size <= largest else b""  # a device tells no size: no more than this
        if max(size, len(raw)) > largest:
            raise InputError(f"{path}: the file is larger than {largest // 1_000_000} MB")
        return raw
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: cannot be read ({_reason(error)})") from None


def _reason(error: OSError | ValueError) -> str:
    return (getattr(error, "strerror", "") or str(error)).lower()


def missing(path: Path) -> str:
    """Why nothing can be read at a path, as ``no such file or directory``; empty where something lies there."""
    try:
        path.stat()
    except (OSError, ValueError) as error:
        return _reason(error)
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
