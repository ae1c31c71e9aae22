"""Figures as files: a drawing and a picture of each."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from drivesizer.errors import InputError, reason_of
from drivesizer.files.writing import ready, write_files
from drivesizer.output.report.figures.all_figures import Drawing
from drivesizer.output.report.figures.style import FILES

__all__ = ["figures_into"]


def figures_into(made: Mapping[str, Drawing], folder: Path) -> list[Path]:
    """Draw into a folder; see :func:`drivesizer.output.report.write_figures`."""
    paths = {(name, form): folder / f"{name}.{form}" for name in made for form in FILES}
    _ready(folder, list(paths.values()))
    files = {path: made[name](form) for (name, form), path in paths.items()}
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be made ({reason_of(error)})") from None
    return write_files(files)


def _ready(folder: Path, paths: list[Path]) -> None:
    """Refuse a folder that cannot be one, and what stands in the way in it, before time is spent on the content."""
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: is a file; expected a folder for the figures")
    if folder.is_dir():
        for path in paths:
            ready(path)
    elif not folder.parent.is_dir():
        raise InputError(f"{folder}: cannot be made, there is no folder {folder.parent}")
