"""A platform as one file for a simulator or a robot's software: the base with all its wheels."""

from __future__ import annotations

from pathlib import Path

from drivesizer.output.export import WHOLE, accept, export_of, write
from drivesizer.output.export.platform.record import PlatformExport, platform_export
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.robot import RobotSpec

__all__ = ["PlatformExport", "platform_export", "write_drive", "write_platform"]


def write_platform(of: PlatformExport, form: str, path: Path) -> list[Path]:
    """Write a platform to a file of a format, whole or not at all."""
    accept(form, path)
    return write(of, form, path, "platform")


def write_drive(
    spec: RobotSpec, found: DriveSet, form: str, path: Path, wheel: int | None = None
) -> tuple[tuple[str, ...], list[Path]]:
    """Write the drive of a spec; of a platform with all its wheels, in formats of several joints."""
    if wheel is None and spec.platform is not None and form in WHOLE:
        platform = platform_export(spec, found)
        return platform.said, write_platform(platform, form, path)
    drive = export_of(spec, found, wheel)
    return drive.said, write(drive, form, path)
