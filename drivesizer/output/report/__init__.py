"""Reports to hand on: what a sizing and its validation found, as PDF, CSV or figures.

Every kind of report is a function from records to the bytes of files, of ``kinds``; ``put`` writes those bytes,
whole or not at all.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from drivesizer.files.writing import write_files
from drivesizer.output.report.kinds import KNOWN, OF_MACHINES, OF_ONE, accept, written

if TYPE_CHECKING:
    from drivesizer.control.path_following.following import Followed
    from drivesizer.control.validation import Validation
    from drivesizer.load_cases.platform import Driving
    from drivesizer.results.machine import MachineSizing
    from drivesizer.results.sizing import SizingResult

__all__ = [
    "KNOWN", "accept", "write", "write_driving", "write_figures", "write_loop_figures", "write_machine",
    "write_machine_figures", "write_path", "write_series", "write_sets",
]  # fmt: skip


def write(
    result: SizingResult,
    validation: Validation | None,
    paths: Sequence[Path],
    *,
    paper: str = "a4",
    date: str | None = None,
) -> list[Path]:
    """Write reports of one run; the suffix of a path says which kind.

    Parameters
    ----------
    result
        The sizing.
    validation
        The closed loop of the best drive, where it was simulated.
    paths
        Where to, such as ``report.pdf`` or ``report.xlsx``.
    paper
        Sheets of the PDF: ``a4`` or ``us-letter``.
    date
        Printed as it is given; without it a report has no date.

    Returns
    -------
    list[Path]
        The files that were written.

    Raises
    ------
    InputError
        When a suffix is none of the known ones, two paths are one, or a file cannot be written. Nothing is written
        then, and older files stay unchanged.
    """
    from drivesizer.output.report.sections.section import Content

    content = Content(result, validation)  # one for all kinds: what takes time is computed once
    return written(OF_ONE, "render", (content,), paths, {"paper": paper, "date": date})


def write_machine(
    sizing: MachineSizing,
    proofs: Mapping[str, Validation],
    paths: Sequence[Path],
    *,
    paper: str = "a4",
    date: str | None = None,
) -> list[Path]:
    """Write reports of a machine of several axes; see :func:`write`."""
    from drivesizer.output.report.machine import MachineContent

    content = MachineContent(sizing, proofs)
    return written(OF_MACHINES, "render_machine", (content,), paths, {"paper": paper, "date": date})


def write_sets(result: SizingResult, path: Path) -> list[Path]:
    """Write the drives as CSV, one row each.

    Parameters
    ----------
    result
        The sizing.
    path
        Where to.

    Returns
    -------
    list[Path]
        The files that were written.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    from drivesizer.output.report.csv import sets_csv

    return write_files({path: sets_csv(result)})


def write_series(validation: Validation, path: Path) -> list[Path]:
    """Write the closed loop over time as CSV.

    Parameters
    ----------
    validation
        The closed loop.
    path
        Where to.

    Returns
    -------
    list[Path]
        The files that were written.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    from drivesizer.output.report.csv import timeseries_csv

    return write_files({path: timeseries_csv(validation)})


def write_driving(found: Driving, path: Path) -> list[Path]:
    """Write a platform's path with speeds and torques of its wheels as CSV."""
    from drivesizer.load_cases.platform import over_time
    from drivesizer.output.report.csv import columns_csv

    return write_files({path: columns_csv(over_time(found))})


def write_path(runs: Mapping[str, Followed], folder: Path) -> list[Path]:
    """Write the path of a platform and its errors along it as ``path.svg`` and ``path.png``."""
    from drivesizer.output.report.figures.all_figures import figures_into
    from drivesizer.output.report.figures.machine import path_and_errors

    return figures_into({"path": path_and_errors(runs)}, folder)


def write_loop_figures(validation: Validation, folder: Path) -> list[Path]:
    """Write the figures of the closed loop as SVG and as PNG of 200 dots per inch."""
    from drivesizer.output.report.figures.all_figures import figures_into, loop_drawings

    return figures_into(loop_drawings(validation), folder)


def write_figures(result: SizingResult, validation: Validation | None, folder: Path) -> list[Path]:
    """Write every figure of a report as SVG and as PNG; see :func:`write_loop_figures`.

    Parameters
    ----------
    result, validation
        The sizing, and the closed loop where it was simulated.
    folder
        Where to; it is made where it does not exist.

    Returns
    -------
    list[Path]
        The files that were written.
    """
    from drivesizer.output.report.figures.all_figures import figures_into, report_drawings

    return figures_into(report_drawings(result, validation), folder)


def write_machine_figures(sizing: MachineSizing, proofs: Mapping[str, Validation], folder: Path) -> list[Path]:
    """Write every figure of a machine's report as SVG and as PNG; see :func:`write_loop_figures`."""
    from drivesizer.output.report.figures.all_figures import figures_into
    from drivesizer.output.report.machine import MachineContent

    return figures_into(MachineContent(sizing, proofs).drawings, folder)
