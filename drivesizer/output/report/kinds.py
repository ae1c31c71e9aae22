"""Kinds of files that a report can be, by the suffix of their path; each is made by a module of its own.

Every kind is a function from records to the bytes of files, and is imported when it is used.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from drivesizer.errors import InputError, quoted
from drivesizer.files.writing import check_targets, write_files

__all__ = ["KNOWN", "OF_MACHINES", "OF_ONE", "Renderers", "accept", "written"]

Renderers = Mapping[str, tuple[str, tuple[str, ...]]]

# suffix -> module with a function ``render``, and what it takes beside the records
OF_ONE: Renderers = {
    ".pdf": ("report.pdf", ("paper", "date")),
    ".html": ("report.html.page", ("date",)),
    ".xlsx": ("report.workbook", ()),
    ".csv": ("report.csv", ()),
    ".json": ("report.json", ()),
}
KNOWN = tuple(OF_ONE)
# the same of machines, each a function ``render_machine``
OF_MACHINES: Renderers = {
    ".pdf": ("report.pdf", ("paper", "date")),
    ".html": ("report.html.page", ("date",)),
    ".xlsx": ("report.workbook", ()),
    ".csv": ("report.machine_csv", ()),
    ".json": ("report.json", ()),
}


def written(
    renderers: Renderers, function: str, records: tuple[Any, ...], paths: Sequence[Path], given: Mapping[str, Any]
) -> list[Path]:
    """Write files of several kinds together."""
    accept(paths)
    files: dict[Path, bytes] = {}
    for path in paths:
        module, takes = renderers[path.suffix.lower()]
        render = getattr(import_module(f"drivesizer.output.{module}"), function)
        made: dict[Path, bytes] = render(*records, path, **{name: given[name] for name in takes})
        twice = files.keys() & made.keys()
        if twice:
            raise InputError(f"{min(twice)}: would be written twice; expected another name")
        files |= made
    return write_files(files)


def accept(paths: Sequence[Path], tables: Sequence[Path] = ()) -> None:
    """Refuse what :func:`drivesizer.output.report.write` would refuse, before time is spent on what goes into it."""
    for path in paths:
        if path.suffix.lower() not in OF_ONE:
            known = f"{', '.join(KNOWN[:-1])} or {KNOWN[-1]}"
            raise InputError(f"{quoted(path.name)} does not say which kind of report; expected {known}")
    check_targets((*paths, *tables))
