"""One process at a time in a study's folder.

The operating system holds the lock for as long as the process lives, so a killed process leaves none behind. A file
system without such locks is refused: a lock file in their place would outlive the process.
"""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock, Timeout

from drivesizer.errors import InputError, reason_of
from drivesizer.files.writing import remove_files, write_files

__all__ = ["locked"]

_LOCK = "lock"
_HOLDER = "lock.txt"  # names the process that holds the lock: a locked file itself cannot be read on every system


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold a folder for this process."""
    lock = FileLock(folder / _LOCK, blocking=False, fallback_to_soft=False)
    try:
        lock.acquire()
    except Timeout:
        raise InputError(_refusal(folder)) from None
    except OSError as error:
        raise InputError(f"{folder / _LOCK}: cannot be written or locked ({reason_of(error)})") from None
    try:
        write_files({folder / _HOLDER: f"process {os.getpid()} on {socket.gethostname()}".encode()})
        yield
    finally:
        remove_files([folder / _HOLDER])
        lock.release()


def _refusal(folder: Path) -> str:
    try:
        holder = (folder / _HOLDER).read_text("utf-8", errors="replace")[:200]
    except OSError:  # the other process has the lock and has not written its name yet
        holder = "another process"
    return f"{folder}: {holder} is at work on this study; wait until it is done, or choose another folder with -o"
