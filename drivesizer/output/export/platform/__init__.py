"""A platform as one file for a simulator or a robot's software: the base with all its wheels."""

from __future__ import annotations

from pathlib import Path

from drivesizer.output.export import accept, files, write
from drivesizer.output.export.platform.record import PlatformExport, platform_export

__all__ = ["PlatformExport", "platform_export", "platform_files", "write_platform"]


def platform_files(of: PlatformExport, form: str, path: Path) -> dict[Path, bytes]:
    """The files of a format: one, and for ros2_control also the controllers' parameters beside it.

    Parameters
    ----------
    of
        The platform.
    form
        A format of several joints.
    path
        The file.

    Returns
    -------
    dict of Path to bytes
        Content by path.

    Raises
    ------
    InputError
        When the format needs a figure that is unknown.
    """
    return files(of, form, path, "platform")


def write_platform(of: PlatformExport, form: str, path: Path) -> list[Path]:
    """Write a platform to a file of a format, whole or not at all.

    Parameters
    ----------
    of
        The platform.
    form
        A format of several joints.
    path
        The file.

    Returns
    -------
    list of Path
        The files written.
    """
    accept(form, path)
    return write(of, form, path, "platform")
