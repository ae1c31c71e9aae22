"""Output files, written whole or not at all.

Content goes to a temporary file in the target's folder, which then takes the target's place in one step: a
full disk, a missing permission or an interruption leaves what was there before. Of several files either none is
changed or, when the interruption comes while they take their places, all are. Only a regular file is ever replaced, and
never one that was read: a link is followed, and into a device, a pipe or the standard output is written as it stands.
"""

from __future__ import annotations

import errno
import os
import stat
import sys
from collections.abc import Iterable, Mapping
from itertools import count
from pathlib import Path
from typing import NamedTuple

from drivesizer.errors import InputError, reason_of
from drivesizer.files.text import was_read

_NO_LINKS = {errno.EPERM, errno.ENOSYS, errno.EOPNOTSUPP, errno.EMLINK}  # a FAT stick, some network drives


class _Waiting(NamedTuple):
    """Content in a temporary file until all files of an output are complete."""

    temporary: Path
    target: Path


def ready(path: Path) -> None:
    """Refuse a target that cannot be written, before its content is computed."""
    try:
        status = _status(path)
        folder = path.resolve().parent if path.is_symlink() else path.parent
        if status is None and not folder.is_dir():
            raise InputError(f"{path}: cannot be written, there is no folder {folder}")
    except (OSError, RuntimeError, ValueError) as error:  # RuntimeError: a loop of links; ValueError: a null character
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: cannot be written ({reason_of(error)})") from None
    if status is None:
        return
    if stat.S_ISDIR(status.st_mode):
        raise InputError(f"{path}: cannot be written, it is a folder")
    if stat.S_ISSOCK(status.st_mode) or stat.S_ISBLK(status.st_mode):
        raise InputError(
            f"{path}: cannot be written, it is no file; expected a file, a device such as /dev/null, a pipe"
        )
    if stat.S_ISREG(status.st_mode) and (name := was_read(path)):
        also = "" if name == path.absolute() else f" (as {name})"
        raise InputError(f"{path}: cannot be written, it is read in the same run{also}; expected another file")
    if not os.access(path, os.W_OK):
        raise InputError(f"{path}: cannot be written, it is protected against that")


def check_targets(paths: Iterable[Path]) -> None:
    """Refuse targets of which one cannot be written, or two are the same file; see :func:`ready`."""
    behind: dict[Path, Path] = {}
    for path in paths:
        ready(path)
        first = behind.setdefault(path.resolve(), path)
        if first is not path and not _is_stream(_status(path)):
            raise InputError(f"{path}: would be written twice{'' if first == path else f', as {first} too'}; "
                             "expected another name")  # fmt: skip


def remove_files(paths: Iterable[Path]) -> None:
    """Remove earlier outputs where they exist; none of them where one was read in this run."""
    paths = list(paths)
    for path in paths:
        if was_read(path):
            raise InputError(f"{path}: cannot be removed, it is read in the same run; expected another folder")
    for path in paths:
        try:
            path.unlink(missing_ok=True)
        except OSError as error:
            raise InputError(f"{path}: cannot be removed ({reason_of(error)})") from None


def write_files(files: Mapping[Path, bytes]) -> list[Path]:
    """Write files; no target is touched before the content of all of them is on the disk."""
    check_targets(files)
    waiting: list[_Waiting] = []
    complete, path = False, Path()
    try:
        streams = [path for path in files if _is_stream(_status(path))]
        for path, content in files.items():
            if path not in streams:
                _write_temporary(path.resolve(), content, waiting)  # a link stays a link, the file behind it changes
        for path in streams:
            _pour(path, files[path])
        complete = True
        _take_places(waiting)
    except OSError as error:
        path = waiting[0].target if complete else path
        raise InputError(f"{path}: cannot be written ({reason_of(error)})") from None
    except KeyboardInterrupt:
        if complete:
            _take_places(waiting)
        raise
    finally:
        for temporary, _ in waiting:
            temporary.unlink(missing_ok=True)
    return list(files)


def new(path: Path, content: bytes) -> None:
    """Write a file where none exists, whole or not at all."""
    waiting: list[_Waiting] = []
    try:
        if os.path.lexists(path):
            raise FileExistsError
        _write_temporary(path, content, waiting)
        _take_free_place(*waiting[0])
    except FileExistsError:
        raise InputError(f"{path}: the file exists and is left alone; name another with -o") from None
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be written ({reason_of(error)})") from None
    finally:
        for temporary, _ in waiting:
            temporary.unlink(missing_ok=True)


# --- what a target is ------------------------------------------------------------------------------------------------


def _status(path: Path) -> os.stat_result | None:
    """Status of a path's target; None where it does not exist."""
    try:
        return path.stat()
    except FileNotFoundError:
        return None


def _is_stream(status: os.stat_result | None) -> bool:
    """Whether a target is written directly: a device, a pipe, or this process's own output."""
    if status is None:
        return False
    return stat.S_ISCHR(status.st_mode) or stat.S_ISFIFO(status.st_mode) or _own_stream(status) is not None


def _own_stream(status: os.stat_result) -> int | None:
    """Number of the standard stream, output or error, that is redirected to a file; None where none is."""
    for number in (1, 2):
        try:
            if os.path.samestat(os.fstat(number), status):
                return number
        except OSError:  # closed
            continue
    return None


def _pour(path: Path, content: bytes) -> None:
    """Write into a device, a pipe with a reader, or a standard stream, after what was printed before."""
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    number = _own_stream(path.stat())
    if number is None:
        handle = os.open(path, os.O_WRONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0))
        os.set_blocking(handle, True)
    else:
        handle = os.dup(number)
    try:
        rest = memoryview(content)
        while rest:
            rest = rest[os.write(handle, rest) :]
    finally:
        os.close(handle)


# --- files -----------------------------------------------------------------------------------------------------------


def _write_temporary(target: Path, content: bytes, waiting: list[_Waiting]) -> None:
    """Write content to a temporary file in its target's folder; it is listed before it exists."""
    for number in count(len(waiting)):
        # Named by the process, so that two runs do not meet; a run that was killed may have left such a name.
        temporary = target.parent / f".drivesizer-{os.getpid()}-{number}.part"
        waiting.append(_Waiting(temporary, target))
        try:
            stream = temporary.open("xb")  # opened new, so that it has the usual permissions
        except FileExistsError:
            waiting.pop()
            continue
        with stream:
            stream.write(content)
        if (status := _status(target)) is not None:  # with the permissions of the file that it replaces
            temporary.chmod(stat.S_IMODE(status.st_mode))
        return


def _take_free_place(temporary: Path, target: Path) -> None:
    """Give a complete file its name where that is free, in one step; in two where a file system has no hard links."""
    try:
        target.hardlink_to(temporary)
    except OSError as error:
        if error.errno not in _NO_LINKS:
            raise
        target.open("xb").close()
        temporary.replace(target)


def _take_places(waiting: list[_Waiting]) -> None:
    """Rename complete files to their targets, and drop them from the list: another run may reuse their names."""
    while waiting:
        temporary, target = waiting[0]
        if temporary.exists():  # else an interruption came right after it took its place
            temporary.replace(target)
        waiting.pop(0)
