"""A machine of several axes as one file for a simulator or a robot's software: the robot whole, other axes beside."""

from __future__ import annotations

from pathlib import Path

from drivesizer.errors import InputError
from drivesizer.output.export import FORMATS, WHOLE, accept, write
from drivesizer.output.export.machine.record import MachineExport, machine_export

__all__ = ["MachineExport", "accept_machine", "machine_export", "write_machine"]


def accept_machine(form: str, path: Path) -> None:
    """Refuse a format without several joints, or an impossible target, before time is spent."""
    if form in FORMATS and form not in WHOLE:
        raise InputError(f"--format: {form} is of a single axis; expected --axis beside it, or {', '.join(WHOLE)}")
    accept(form, path)


def write_machine(of: MachineExport, form: str, path: Path) -> list[Path]:
    """Write a machine to a file of a format, whole or not at all."""
    accept_machine(form, path)
    return write(of, form, path, "machine")
