"""Exports of a drive or a machine as text of a format."""

from __future__ import annotations

from pathlib import Path

from drivesizer.output.export import FORMATS, Export, MachineExport, PlatformExport, files, one_axis, platform_alone

__all__ = ["rendered"]


def rendered(of: Export | MachineExport | PlatformExport, form: str, beside: bool = False) -> bytes:
    """The file of a format, or the one beside it: the controllers of ros2_control."""
    machine = of
    if not isinstance(machine, MachineExport):
        machine = platform_alone(machine) if isinstance(machine, PlatformExport) else one_axis(machine)
    found = list(files(machine, form, Path(f"drive{FORMATS[form].suffixes[0]}")).values())
    return found[1 if beside else 0]
