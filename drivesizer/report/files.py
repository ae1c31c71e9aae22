"""Files written whole or not at all.

Content goes to a temporary file in the target's folder, which then takes the target's place in one step: a
full disk, a missing permission or an interruption leaves what was there before. Of several files either none is
changed or, when the interruption comes while they take their places, all are.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from itertools import count
from pathlib import Path

from drivesizer.errors import InputError

__all__ = ["put", "ready"]


def ready(path: Path) -> None:
    """Refuse a target that cannot work before time is spent on its content.

    Raises
    ------
    InputError
        When the folder does not exist, or the target is a folder.
    """
    if not path.parent.is_dir():
        raise InputError(f"{path}: cannot be written, there is no folder {path.parent}")
    if path.is_dir():
        raise InputError(f"{path}: cannot be written, it is a folder")


def put(files: Mapping[Path, bytes]) -> list[Path]:
    """Write files; no target is touched before the content of all of them is on the disk.

    Parameters
    ----------
    files
        Content by path.

    Returns
    -------
    list[Path]
        The paths, in order.

    Raises
    ------
    InputError
        When a file cannot be written.
    """
    for path in files:
        ready(path)
    waiting: list[tuple[Path, Path]] = []
    complete, path = False, Path()
    try:
        for path, content in files.items():
            _lay_by(path.resolve(), content, waiting)  # a link stays a link, the file behind it changes
        complete = True
        _take_places(waiting)
    except OSError as error:
        path = waiting[0][1] if complete else path
        raise InputError(f"{path}: cannot be written ({(error.strerror or str(error)).lower()})") from None
    except KeyboardInterrupt:
        if complete:
            _take_places(waiting)
        raise
    finally:
        for temporary, _ in waiting:
            temporary.unlink(missing_ok=True)
    return list(files)


def _lay_by(target: Path, content: bytes, waiting: list[tuple[Path, Path]]) -> None:
    """Write content to a temporary file beside its target, and remember it from before it is there."""
    for number in count(len(waiting)):
        # Named by the process, so that two runs do not meet; a run that was killed may have left such a name.
        temporary = target.parent / f".drivesizer-{os.getpid()}-{number}.part"
        waiting.append((temporary, target))
        try:
            stream = temporary.open("xb")  # opened new, so that it has the usual permissions
        except FileExistsError:
            waiting.pop()
            continue
        with stream:
            stream.write(content)
        return


def _take_places(waiting: list[tuple[Path, Path]]) -> None:
    """Let complete files take their targets' places, and forget them: their names may be another run's by then."""
    while waiting:
        temporary, target = waiting[0]
        if temporary.exists():  # else an interruption came right after it took its place
            temporary.replace(target)
        waiting.pop(0)
