"""Reports to hand on: what a sizing and its validation found, as PDF, CSV or figures.

Every kind of report is a function from records to the bytes of files, and is imported when it is asked for;
``put`` writes those bytes, whole or not at all.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from drivesizer.errors import InputError, quoted

if TYPE_CHECKING:
    from drivesizer.results import SizingResult, Validation

__all__ = ["KNOWN", "write", "write_figures", "write_series", "write_sets"]

_RENDERERS = {".csv": "tables", ".pdf": "pdf"}  # suffix -> module with a function ``render``
KNOWN = tuple(_RENDERERS)


def write(result: SizingResult, validation: Validation | None, path: Path) -> list[Path]:
    """Write a report; the suffix of the path says which kind.

    Parameters
    ----------
    result
        What the sizing found.
    validation
        The closed loop of the best set, where it was simulated.
    path
        Where to, such as ``report.pdf`` or ``report.csv``.

    Returns
    -------
    list[Path]
        The files that were written.

    Raises
    ------
    InputError
        When the suffix is none of the known ones, or a file cannot be written. Nothing is written then, and what
        stood there before stands unchanged.
    """
    from drivesizer.report.files import put, ready

    module = _RENDERERS.get(path.suffix.lower())
    if module is None:
        raise InputError(f"{quoted(path.name)} does not say which kind of report; expected {' or '.join(KNOWN)}")
    ready(path)
    files: dict[Path, bytes] = import_module(f"drivesizer.report.{module}").render(result, validation, path)
    return put(files)


def write_sets(result: SizingResult, path: Path) -> list[Path]:
    """Write the drive sets as CSV, one row each.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    from drivesizer.report.files import put, ready
    from drivesizer.report.tables import sets_csv

    ready(path)
    return put({path: sets_csv(result)})


def write_series(validation: Validation, path: Path) -> list[Path]:
    """Write the closed loop over time as CSV.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    from drivesizer.report.files import put, ready
    from drivesizer.report.tables import timeseries_csv

    ready(path)
    return put({path: timeseries_csv(validation)})


def write_figures(validation: Validation, folder: Path) -> list[Path]:
    """Write the figures of the closed loop as SVG and as PNG of 200 dots per inch.

    Parameters
    ----------
    validation
        The closed loop; one without records of its loops has no ``bode`` and no ``step``.
    folder
        Where to; it is made where it does not exist, its parent must.

    Returns
    -------
    list[Path]
        ``closed_loop``, ``bode`` and ``step``, each as ``.svg`` and ``.png``.

    Raises
    ------
    InputError
        When the folder is a file or cannot be made, or a file cannot be written. No file is changed then.
    """
    from drivesizer.report.figure_files import figures_into

    return figures_into(validation, folder)
