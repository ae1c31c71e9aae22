"""One process at a time on a study's folder.

The operating system holds the lock for as long as the process lives, so one that was killed leaves none behind. The
file says who has it, for the message to the next.
"""

from __future__ import annotations

import errno
import os
import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from drivesizer.errors import InputError, reason_of

__all__ = ["locked"]

_NAME = "lock"
_TAKEN = (errno.EACCES, errno.EAGAIN, errno.EDEADLK)
_PLACE = 1 << 30  # of the byte that is locked on Windows: beyond what is read


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold a folder for this process.

    Raises
    ------
    InputError
        When another process holds it, or the folder is one where nothing can be held.
    """
    path = folder / _NAME
    try:
        file = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({reason_of(error)})") from None
    try:
        try:
            _take(file)
        except OSError as error:
            raise InputError(_refusal(folder, file, error)) from None
        try:
            os.ftruncate(file, 0)
            os.write(file, f"process {os.getpid()} on {socket.gethostname()}".encode())
        except OSError as error:
            raise InputError(f"{path}: cannot be written ({reason_of(error)})") from None
        yield
    finally:
        os.close(file)  # which lets go of it


def _take(file: int) -> None:
    if sys.platform == "win32":
        import msvcrt

        os.lseek(file, _PLACE, os.SEEK_SET)
        msvcrt.locking(file, msvcrt.LK_NBLCK, 1)
        os.lseek(file, 0, os.SEEK_SET)
    else:
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _refusal(folder: Path, file: int, error: OSError) -> str:
    if error.errno not in _TAKEN:
        return f"{folder}: cannot be held against a second process ({reason_of(error)})"
    who = os.read(file, 200).decode(errors="replace") or "another process"
    return f"{folder}: {who} is at work on this study; wait until it is done, or choose another folder with -o"
