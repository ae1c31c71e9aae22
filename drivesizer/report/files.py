"""Files written whole or not at all.

Content goes to a temporary file in the target's folder, which then takes the target's place in one step: a
full disk, a missing permission or an interruption leaves what was there before.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
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
    waiting: list[tuple[Path, Path]] = []
    path = Path()
    try:
        for number, (path, content) in enumerate(files.items()):
            target = path.resolve()  # a link stays a link, the file behind it changes
            # Named by the process, so that two runs do not meet; opened new, so that it has the usual permissions.
            temporary = target.parent / f".drivesizer-{os.getpid()}-{number}.part"
            with temporary.open("xb") as stream:
                waiting.append((temporary, target))
                stream.write(content)
        for temporary, target in waiting:
            path = target
            temporary.replace(target)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({(error.strerror or str(error)).lower()})") from None
    finally:
        for temporary, _ in waiting:
            temporary.unlink(missing_ok=True)
    return list(files)
