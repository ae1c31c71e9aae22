"""Reports to hand on: what a sizing and its validation found, as PDF, page, workbook, CSV, JSON or figures.

The suffix of a path says which kind; each is made by a module of its own, from records to the bytes of files, which is
imported when it is used. Files are written whole or not at all.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drivesizer.errors import InputError, quoted
from drivesizer.files.writing import check_targets, write_files

if TYPE_CHECKING:
    from drivesizer.control.path_following import Followed
    from drivesizer.control.validation import Validation
    from drivesizer.load_cases.platform import Driving
    from drivesizer.output.document.axes import MachineContent
    from drivesizer.output.document.records import Document
    from drivesizer.results.machine import MachineSizing
    from drivesizer.results.sizing import SizingResult

__all__ = [
    "KNOWN", "MEDIA", "accept", "write", "write_document", "write_driving", "write_figures", "write_loop_figures",
    "write_path", "write_quote", "write_series", "write_sets",
]  # fmt: skip

KNOWN = (".pdf", ".html", ".xlsx", ".csv", ".json")
MEDIA = KNOWN[:3]  # of a document that is no sizing


def accept(
    paths: Sequence[Path], tables: Sequence[Path] = (), *, known: Sequence[str] = KNOWN, kind: str = "report"
) -> None:
    """Refuse what :func:`write` would refuse, before time is spent on what goes into it."""
    for path in paths:
        if path.suffix.lower() not in known:
            expected = f"{', '.join(known[:-1])} or {known[-1]}"
            raise InputError(f"{quoted(path.name)} does not say which kind of {kind}; expected {expected}")
    check_targets((*paths, *tables))


def write(
    result: SizingResult | MachineSizing,
    proof: Validation | Mapping[str, Validation] | None,
    paths: Sequence[Path],
    *,
    paper: str = "a4",
    date: str | None = None,
) -> list[Path]:
    """Write reports of one run; the suffix of a path says which kind.

    Parameters
    ----------
    result
        The sizing of an axis, or of a machine.
    proof
        The closed loop of the best drive, where it was simulated; of a machine by the name of the axis.
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
    from drivesizer.output.document.axes import content_of

    accept(paths)
    return _write(content_of(result, proof), paths, paper, date)


def write_document(document: Document, paths: Sequence[Path]) -> list[Path]:
    """Write a document that is no sizing, such as a data sheet, as PDF, page or workbook."""
    return _write(document, paths, "a4", None)


def _write(content: Any, paths: Sequence[Path], paper: str, date: str | None) -> list[Path]:
    files = dict[Path, bytes]()  # of one content, which keeps what takes time
    for path in paths:
        contents = _files(content, path, paper, date)
        twice = files.keys() & contents.keys()
        if twice:
            raise InputError(f"{min(twice)}: would be written twice; expected another name")
        files |= contents
    return write_files(files)


def _files(content: Any, path: Path, paper: str, date: str | None) -> dict[Path, bytes]:
    """The files of one report."""
    kind = path.suffix.lower()
    if kind == ".pdf":
        from drivesizer.output.report.pdf import report_pdf

        return {path: report_pdf(content, paper=paper, date=date)}
    if kind == ".html":
        from drivesizer.output.report.html.page import report_html

        return {path: report_html(content, date=date)}
    if kind == ".json":
        return {path: report_json(content)}
    if kind == ".csv":
        from drivesizer.output.report.csv import files_csv

        return files_csv(content, path)
    from drivesizer.output.report.workbook import report_xlsx

    return {path: report_xlsx(content)}


def report_json(content: MachineContent) -> bytes:
    """A sizing with the closed loop of every axis as one JSON document, as the bytes of a file."""
    from drivesizer.output.json.documents import as_text, on_path, report

    platforms = {name: axis for name, axis in content.contents.items() if axis.given.platform}
    paths = {name: on_path(axis.given, behaviour.permitted, behaviour.followed)
             for name, axis in platforms.items() if (behaviour := axis.behaviour)}  # fmt: skip
    document = report(content.sizing, content.proofs, paths)
    # a lone surrogate, which a spec may have, becomes \udxxx
    return f"{as_text(document)}\n".encode("utf-8", "backslashreplace")


def write_sets(result: SizingResult | MachineSizing, path: Path) -> list[Path]:
    """Write the drives as CSV, one row each.

    Parameters
    ----------
    result
        The sizing, or that of a machine of several axes.
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


def write_quote(result: SizingResult | MachineSizing, paths: Sequence[Path]) -> list[Path]:
    """Write what is to be ordered as CSV or XLSX: numbers, prices, sellers, totals, and what is missing."""
    from drivesizer.output.document.axes import content_of
    from drivesizer.output.document.quote import quote_lines, quote_sections

    content, files = content_of(result), dict[Path, bytes]()
    for path in paths:
        if path.suffix.lower() == ".xlsx":
            from drivesizer.output.report.workbook import written

            files[path] = written(quote_sections(content))
        else:
            from drivesizer.output.report.csv import table_csv

            files[path] = table_csv(quote_lines(content))
    return write_files(files)


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
    from drivesizer.output.report.csv import columns_csv

    columns = {name: (values, *validation.series_units[name]) for name, values in validation.series.items()}
    return write_files({path: columns_csv(columns)})


def write_driving(platform: Driving, path: Path) -> list[Path]:
    """Write a platform's path with speeds and torques of its wheels as CSV."""
    from drivesizer.load_cases.platform import over_time
    from drivesizer.output.report.csv import columns_csv

    return write_files({path: columns_csv(over_time(platform))})


def write_path(runs: Mapping[str, Followed], folder: Path) -> list[Path]:
    """Write the path of a platform and its errors along it as ``path.svg`` and ``path.png``."""
    from drivesizer.output.report.figures.all_figures import figures_into
    from drivesizer.output.report.figures.machine import path_and_errors

    return figures_into({"path": path_and_errors(runs)}, folder)


def write_loop_figures(validation: Validation, folder: Path) -> list[Path]:
    """Write the figures of the closed loop as SVG and as PNG of 200 dots per inch."""
    from drivesizer.output.report.figures.all_figures import figures_into, loop_pictures, on_sheets

    return figures_into(on_sheets(loop_pictures(validation)), folder)


def write_figures(
    result: SizingResult | MachineSizing, proof: Validation | Mapping[str, Validation] | None, folder: Path
) -> list[Path]:
    """Write every figure of a report as SVG and as PNG; see :func:`write_loop_figures`.

    Parameters
    ----------
    result, proof
        As of :func:`write`.
    folder
        Where to; it is made where it does not exist.

    Returns
    -------
    list[Path]
        The files that were written.
    """
    from drivesizer.output.document.axes import content_of
    from drivesizer.output.report.figures.all_figures import figures_into, on_sheets

    return figures_into(on_sheets(content_of(result, proof).pictures), folder)
