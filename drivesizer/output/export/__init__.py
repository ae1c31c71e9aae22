"""A sized machine as a file for a simulator or a robot's software: one module per format, each of a list of axes."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import NamedTuple

from drivesizer.errors import InputError, quoted
from drivesizer.files.writing import ready, write_files
from drivesizer.output.export.common import Export, check_wheel, export_of, identifier
from drivesizer.output.export.machine import MachineExport, drive_export, machine_export, one_axis, platform_alone
from drivesizer.output.export.platform import PlatformExport, platform_export

__all__ = [
    "FORMATS", "Export", "Format", "MachineExport", "PlatformExport", "accept", "check_wheel", "drive_export",
    "export_of", "files", "machine_export", "one_axis", "platform_alone", "platform_export", "write",
]  # fmt: skip


class Format(NamedTuple):
    """A format: its reader, its module with the function that renders it, and the suffixes of its file."""

    description: str
    module: str
    suffixes: tuple[str, ...]
    render: str = "render"
    bodies: bool = False  # whether it has bodies: a robot's links, a platform's wheels


FORMATS = {
    "mjcf": Format("MuJoCo", "mjcf", (".xml", ".mjcf"), bodies=True),
    "urdf": Format("URDF", "urdf", (".urdf", ".xml"), bodies=True),
    "sdf": Format("Gazebo", "urdf", (".sdf", ".xml"), "render_sdf"),
    "ros2_control": Format("ros2_control", "ros2_control", (".urdf", ".xacro", ".xml"), bodies=True),
    "fmu": Format("FMI 2.0 co-simulation", "fmu", (".fmu",)),
    "json": Format("JSON", "machine", (".json",), "render_json"),
}


def accept(form: str, path: Path) -> None:
    """Refuse an unknown format or an impossible target, before time is spent."""
    if form not in FORMATS:
        readers = {entry.description.lower(): f"; {entry.description} reads {name}" for name, entry in FORMATS.items()}
        read_by = readers.get(form.lower(), "")
        raise InputError(f"--format: {quoted(form)} is not known{read_by}; expected {', '.join(FORMATS)}")
    if path.suffix.lower() not in FORMATS[form].suffixes:
        endings = " or ".join(FORMATS[form].suffixes)
        raise InputError(f"--output: {quoted(path)} is no name for {form}; expected a file that ends in {endings}")
    ready(path)


def files(of: MachineExport, form: str, path: Path) -> dict[Path, bytes]:
    """The files of a format: one; for ros2_control also the controllers' parameters beside it; an FMU for each axis."""
    module = import_module(f"drivesizer.output.export.{FORMATS[form].module}")
    render: Callable[[MachineExport], bytes] = getattr(module, FORMATS[form].render)
    if form == "fmu" and not of.alone:
        machines = {f"{path.stem}_{identifier(name)}{path.suffix}": one_axis(export) for name, export in of.exports}
        return {path.with_name(name): render(machine) for name, machine in machines.items()}
    contents = {path: render(of)}
    if form == "ros2_control":
        contents[path.with_name(f"{path.stem}_controllers.yaml")] = module.controllers(of)
    return contents


def write(of: MachineExport, form: str, path: Path) -> list[Path]:
    """Write a machine to the files of a format, whole or not at all."""
    accept(form, path)
    return write_files(files(of, form, path))
