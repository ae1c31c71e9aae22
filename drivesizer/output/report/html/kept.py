"""Parts that all pages share, kept in the cache folder once made: the compiled template, the library as packed."""

from __future__ import annotations

import zlib
from contextlib import suppress
from pathlib import Path

from jinja2 import BytecodeCache
from jinja2.bccache import Bucket

from drivesizer.files.cache import cached_bytes, digest_of, folder, keep

__all__ = ["Compiled", "packed"]


class Compiled(BytecodeCache):
    """Templates as Python compiles them; jinja2 holds them against their source and its own version."""

    def load_bytecode(self, bucket: Bucket) -> None:
        """Fill a bucket with what was kept, if it is whole."""
        found = cached_bytes(_place(bucket))
        if found is not None:
            bucket.bytecode_from_string(found)

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Keep what a bucket holds; where the folder cannot be written it is compiled again the next time."""
        with suppress(OSError):
            keep(_place(bucket), bucket.bytecode_to_string())


def _place(bucket: Bucket) -> Path:
    return folder() / f"template{bucket.key[:8]}-{bucket.checksum}.jinja"


def packed(script: str) -> bytes:
    """A script as zlib packs it best, which takes a quarter of a second for a plotting library."""
    path = folder() / f"script-{digest_of(zlib.ZLIB_RUNTIME_VERSION.encode(), script.encode())}.z"
    found = cached_bytes(path)
    if found is None:
        found = zlib.compress(script.encode(), 9)
        with suppress(OSError):
            keep(path, found)
    return found
