"""Files kept between runs: named by a digest, written whole or not at all, old ones tidied away."""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
import time
from pathlib import Path

__all__ = ["CacheWarning", "digest_of", "folder", "keep", "kept"]


_HALF = ".compiling-"  # begins the name of a file that is being written


_LONG_AGO = 600.0  # s, after which nobody writes it any more


_DIGEST = 32  # bytes of blake2b at the head of a compiled file


class CacheWarning(UserWarning):
    """The compiled catalogue could not be kept; the next start is slower."""


def folder() -> Path:
    """Where compiled catalogues are kept: ``$DRIVESIZER_CACHE``, or the user's cache folder."""
    given = os.environ.get("DRIVESIZER_CACHE")
    if given:
        return Path(given)
    from platformdirs import user_cache_path

    return user_cache_path("drivesizer", appauthor=False)


def digest_of(*parts: bytes) -> str:
    """Digest of some bytes, as text for a file name."""
    mixed = hashlib.blake2b(digest_size=16)
    for part in parts:
        mixed.update(len(part).to_bytes(8, "big") + part)
    return mixed.hexdigest()


def kept(path: Path) -> bytes | None:
    """What was kept under a path, or None when there is nothing or it is damaged."""
    try:
        raw = path.read_bytes()
    except OSError:
        return None
    body = raw[_DIGEST:]
    return body if hashlib.blake2b(body, digest_size=_DIGEST).digest() == raw[:_DIGEST] else None


def keep(path: Path, body: bytes) -> None:
    """Keep bytes under a path, whole or not at all; older ones of the same name before its digest are removed.

    Raises
    ------
    OSError
        When the folder cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=_HALF)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(hashlib.blake2b(body, digest_size=_DIGEST).digest() + body)
        Path(name).replace(path)
    except OSError:
        Path(name).unlink()
        raise
    _tidy(path)


def _tidy(path: Path) -> None:
    """Remove older compilations of the same catalogue, and what a killed process left half done."""
    for old in path.parent.iterdir():
        with contextlib.suppress(FileNotFoundError):  # of another process, which is done with it
            left_over = old.name.startswith(_HALF) and time.time() - old.stat().st_mtime > _LONG_AGO
            if left_over or (_catalogue(old) == _catalogue(path) and old != path):
                old.unlink()


def _catalogue(path: Path) -> tuple[str, str]:
    """The name of the catalogue that a compiled file holds (before the digest), and the file's ending."""
    return path.stem.rpartition("-")[0], path.suffix
