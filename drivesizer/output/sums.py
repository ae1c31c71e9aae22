"""Sums over the parts of a drive, for several kinds of report."""

from __future__ import annotations

from drivesizer.results.drive_set import DriveSet

__all__ = ["unknown_of"]


def unknown_of(drive_set: DriveSet, known: tuple[str, ...]) -> tuple[str, ...]:
    """The parts of a drive that a sum does not cover."""
    return tuple(name for name in drive_set.parts if name not in known)
