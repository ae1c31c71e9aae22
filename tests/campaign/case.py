"""One input of the campaign: files in an otherwise empty folder, and the commands that are run there one by one."""

from __future__ import annotations

import json
from pathlib import Path
from typing import NamedTuple

__all__ = ["Case", "kept", "laid", "read"]


class Case(NamedTuple):
    """Files by name, and commands; the first word of a command is drivesizer's, or one of ``program.INSIDE``."""

    files: dict[str, bytes]
    commands: list[list[str]]


def laid(case: Case, folder: Path) -> None:
    """Lay the files into an empty folder."""
    for name, content in case.files.items():
        (folder / name).write_bytes(content)


def kept(case: Case, folder: Path) -> None:
    """Keep an input as a folder of its own, to be read again or to be worked with at a terminal."""
    folder.mkdir(parents=True, exist_ok=True)
    laid(case, folder)
    (folder / "commands.json").write_text(json.dumps(case.commands, indent=1), encoding="utf-8")


def read(folder: Path) -> Case:
    """An input that was kept."""
    files = {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.name != "commands.json"}
    return Case(files, json.loads((folder / "commands.json").read_text(encoding="utf-8")))
