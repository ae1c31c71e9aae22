"""A sized drive as a file for a simulator or a robot's software: one module per format.

``common`` has the figures that all formats need, seen from the driven shaft.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from drivesizer.errors import InputError, quoted
from drivesizer.files.writing import ready, write_files
from drivesizer.output.export.common import Export, check_wheel, export_of

__all__ = ["FORMATS", "WHOLE", "Export", "Format", "accept", "check_wheel", "export_of", "files", "write"]


class Format(NamedTuple):
    """A format: its name, its module, and the suffixes of its file."""

    said: str
    module: str
    suffixes: tuple[str, ...]


FORMATS = {
    "mjcf": Format("MuJoCo", "mjcf", (".xml", ".mjcf")),
    "urdf": Format("URDF", "urdf", (".urdf", ".xml")),
    "sdf": Format("Gazebo", "sdf", (".sdf", ".xml")),
    "ros2_control": Format("ros2_control", "ros2_control", (".urdf", ".xacro", ".xml")),
    "fmu": Format("FMI 2.0 co-simulation", "fmu", (".fmu",)),
    "json": Format("JSON", "json_document", (".json",)),
}
WHOLE = ("mjcf", "urdf", "ros2_control")  # formats with several joints


def accept(form: str, path: Path) -> None:
    """Refuse an unknown format or an impossible target, before time is spent."""
    if form not in FORMATS:
        readers = {one.said.lower(): f"; {one.said} reads {name}" for name, one in FORMATS.items()}
        read_by = readers.get(form.lower(), "")
        raise InputError(f"--format: {quoted(form)} is not known{read_by}; expected {', '.join(FORMATS)}")
    if path.suffix.lower() not in FORMATS[form].suffixes:
        wanted = " or ".join(FORMATS[form].suffixes)
        raise InputError(f"--output: {quoted(path)} is no name for {form}; expected a file that ends in {wanted}")
    ready(path)


def files(of: Any, form: str, path: Path, room: str = "") -> dict[Path, bytes]:
    """The files of a format: one, and for ros2_control also the controllers' parameters beside it."""
    module = import_module(f"drivesizer.output.export.{FORMATS[form].module}")
    kind = f"_{room}" if room else ""
    render: Callable[[Any], bytes] = getattr(module, f"render{kind}")
    found = {path: render(of)}
    if form == "ros2_control":
        beside = path.with_name(f"{path.stem}_controllers.yaml")
        found[beside] = getattr(module, f"controllers{kind}")(of)
    return found


def write(of: Any, form: str, path: Path, room: str = "") -> list[Path]:
    """Write a drive to a file of a format, whole or not at all.

    Parameters
    ----------
    of, form, path, room
        As of :func:`files`.

    Returns
    -------
    list of Path
        The files written.
    """
    accept(form, path)
    return write_files(files(of, form, path, room))
