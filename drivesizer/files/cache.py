"""Files kept between runs: named by a digest, written whole or not at all; outdated ones are removed."""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

_HALF = ".compiling-"  # begins the name of a file that is being written
_LONG_AGO = 600.0  # s, after which such a file is left over from a killed process
_DIGEST = 32  # bytes of blake2b at the head of a file: a damaged one is not used


class CacheWarning(UserWarning):
    """The compiled catalogue could not be kept; the next start is slower."""


def folder() -> Path:
    """The cache folder: ``$DRIVESIZER_CACHE``, or drivesizer's in the user's cache folder."""
    if path := os.environ.get("DRIVESIZER_CACHE"):
        return Path(path)
    from platformdirs import user_cache_path

    return user_cache_path("drivesizer", appauthor=False)


def digest_of(*parts: bytes) -> str:
    """Digest of some bytes, as text for a file name."""
    mixed = hashlib.blake2b(digest_size=16)
    for part in parts:
        mixed.update(len(part).to_bytes(8, "big") + part)
    return mixed.hexdigest()


def cached(name: str, make: Callable[[], bytes]) -> bytes:
    """Bytes out of the cache folder, by a name with their digest; made where it has none, and kept if it can be."""
    path = folder() / name
    content = cached_bytes(path)
    if content is None:
        content = make()
        with contextlib.suppress(OSError):  # a folder without write access was reported with the catalogue
            keep(path, content)
    return content


def cached_bytes(path: Path) -> bytes | None:
    """Bytes kept under a path; None where there are none or they are damaged."""
    try:
        raw = path.read_bytes()
    except OSError:
        return None
    body = raw[_DIGEST:]
    return body if hashlib.blake2b(body, digest_size=_DIGEST).digest() == raw[:_DIGEST] else None


def keep(path: Path, body: bytes) -> None:
    """Keep bytes under a path, whole or not at all; files of an older digest, and of killed processes, are removed."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=_HALF)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(hashlib.blake2b(body, digest_size=_DIGEST).digest() + body)
        Path(name).replace(path)
    except BaseException:  # Ctrl-C too leaves nothing behind
        Path(name).unlink(missing_ok=True)
        raise
    for old in path.parent.iterdir():
        with contextlib.suppress(FileNotFoundError):  # another process removed it first
            left_over = old.name.startswith(_HALF) and abs(time.time() - old.stat().st_mtime) > _LONG_AGO
            same = old.suffix == path.suffix and old.stem.rpartition("-")[0] == path.stem.rpartition("-")[0]
            if left_over or (same and old != path):
                old.unlink()
