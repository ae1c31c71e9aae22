"""Reader of a user's text file: bounded size, UTF-8, every error one line; folders of data that ship."""

from __future__ import annotations

import math
import os
import re
import select
import stat
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from drivesizer.errors import InputError, reason_of
from drivesizer.units import show

# -- Folders of data that come with drivesizer.


def shipped_folder(name: str) -> Path:
    """A folder of the distribution: in an installed package it is inside, in a checkout beside it."""
    package = Path(__file__).resolve().parents[1]
    inside = package / name
    return inside if inside.is_dir() else package.parent / name


# -- Reader of a user's text file: bounded size, UTF-8, every error one line.
#
# Files that were read are remembered by name for as long as the process lives: no output may replace an input.


_PATIENCE = 2.0  # s to wait for a writer on a named pipe
_PIECE = 1 << 20  # bytes read at once
_read: dict[Path, None] = {}  # absolute paths of the files that were read
_permitted: tuple[frozenset[str], tuple[str, ...]] | None = None  # files and folders of which alone may be read
_handed: dict[Path, bytes] = {}  # by absolute path: contents that count in place of files
_ELSEWHERE = (
    "is not read here; expected a shipped catalogue, or what the spec named when drivesizer serve was started: "
    "save the spec and start it again"
)


def read_bytes(path: Path, largest: int = 64_000_000) -> bytes:
    """A file's bytes."""
    if (content := _handed.get(path.absolute())) is not None:
        return content
    if not _may_be_read(path):
        raise InputError(f"{path}: {_ELSEWHERE}")
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
    """At most one byte more than `largest`: a device has no size."""
    status = path.stat()
    if stat.S_ISSOCK(status.st_mode) or stat.S_ISBLK(status.st_mode):
        raise InputError(f"{path}: cannot be read; expected a file")
    if status.st_size > largest:
        raise InputError(f"{path}: the file is larger than {largest // 1_000_000} MB")
    if stat.S_ISFIFO(status.st_mode):
        return _from_pipe(path, largest)
    with path.open("rb") as file:
        return file.read(largest + 1)


def _from_pipe(path: Path, largest: int) -> bytes:
    """Content of a pipe, such as ``<(command)``; one without a writer is refused after a time."""
    pipe = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    try:
        if not select.select([pipe], [], [], _PATIENCE)[0]:
            raise InputError(f"{path}: is a pipe, and nobody writes into it; expected a file")
        os.set_blocking(pipe, True)
        content = bytearray()
        while len(content) <= largest and (piece := os.read(pipe, _PIECE)):
            content += piece
        return bytes(content[: largest + 1])
    finally:
        os.close(pipe)


def restrict_reading(files: Iterable[Path], folders: Iterable[Path]) -> None:
    """Refuse, for as long as the process lives, every file but some, and those in some folders.

    For a process that takes specs of someone who may not see all files of this machine.
    """
    global _permitted
    _permitted = frozenset(map(os.path.abspath, files)), tuple(os.path.realpath(folder) for folder in folders)


def _may_be_read(path: Path) -> bool:
    """Whether a name is among those that may be read; the name decides, for to follow one may reach another machine."""
    if _permitted is None:
        return True
    files, folders = _permitted
    name = os.path.abspath(path)  # noqa: PTH100  to resolve a name would follow it
    below = "\0" not in name and any(name.startswith(f"{folder}{os.sep}") for folder in folders)
    return name in files or (below and os.path.realpath(name) == name)


def hand_over(contents: Mapping[Path, bytes]) -> None:
    """Let contents count as files until others are handed over: of someone who has no file on this machine."""
    _handed.clear()
    _handed.update({path.absolute(): content for path, content in contents.items()})


def is_handed(path: Path) -> bool:
    """Whether the content of a path was handed over, so that the disk is to keep nothing of it."""
    return path.absolute() in _handed


def was_read(path: Path) -> Path | None:
    """Path under which a file was read in this process, links followed; None where it was not."""
    for name in _read:
        try:
            if name.samefile(path):
                return name
        except (OSError, ValueError):  # one of them is no longer there, or not yet
            continue
    return None


def states() -> dict[Path, tuple[int, int]]:
    """Time of the last change [ns] and size [bytes] of all files that were read: whether one is still the same."""
    return {name: state_of(name) for name in _read}


def state_of(path: Path) -> tuple[int, int]:
    """Time of a file's last change [ns] and its size [bytes]; zeros where there is none."""
    try:
        status = path.stat()
    except OSError:
        return 0, 0
    return status.st_mtime_ns, status.st_size


def missing(path: Path) -> str:
    """Reason why no file can be read at a path, such as ``no such file or directory``; empty where there is one."""
    if not _may_be_read(path):
        return _ELSEWHERE.partition(";")[0]
    try:
        mode = path.stat().st_mode
    except (OSError, ValueError) as error:
        return reason_of(error)
    return "is a directory" if stat.S_ISDIR(mode) else ""


def decoded(raw: bytes, path: Path) -> str:
    """Bytes as UTF-8 text, a byte-order mark left out."""
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw[: error.start].count(b"\n") + 1
        raise InputError(f"{path}:{line}: the file is not UTF-8 text; save it as UTF-8") from None


def read_text(path: Path, largest: int = 64_000_000) -> str:
    """A file's text."""
    return decoded(read_bytes(path, largest), path)


def plain_number(text: str) -> float:
    """The number of a text; NaN where it is none: float() would take underscores and digits of other scripts too."""
    try:
        return float(text) if text.isascii() and "_" not in text else math.nan
    except ValueError:
        return math.nan


def listed(package: str, name: str) -> Iterator[tuple[str, list[str]]]:
    """Rows of a table of text that ships with the program: cells between bars, each row with the head of its section.

    A section begins with its head in brackets; a line that begins with spaces goes on with the one before.
    """
    text, head = (resources.files(package) / name).read_text(encoding="utf-8"), ""
    for line in re.sub(r"(?m)^#.*\n", "", text).replace("\n  ", " ").splitlines():
        if line.startswith("["):
            head = line.strip("[]")
        elif line:
            yield head, [cell.strip() for cell in line.split("|")]


# -- Sentences with figures in them, out of a text that ships with the program.


Filters = tuple[tuple[str, Callable[..., str]], ...]


@cache
def _templates(package: str, subject: str, filters: Filters) -> list[Any]:
    from jinja2 import Environment, StrictUndefined

    environment = Environment(undefined=StrictUndefined, autoescape=False)  # noqa: S701 - what writes a file escapes it
    environment.filters |= {"show": show, **dict(filters)}
    remarks = resources.files(package).joinpath("remarks.txt").read_text(encoding="utf-8")
    _, text = remarks.split(f"\n## {subject}\n")
    paragraphs = text.split("\n## ")[0].split("\n\n")
    return [environment.from_string(" ".join(paragraph.split())) for paragraph in paragraphs if paragraph.strip()]


def sentences(package: str, subject: str, filters: Filters = (), **figures: object) -> list[str]:
    """The paragraphs on a subject in ``remarks.txt`` of a package; without those that come out empty."""
    return [line for line in (template.render(figures) for template in _templates(package, subject, filters)) if line]
