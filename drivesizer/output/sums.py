"""Sums over the parts of a drive, for several kinds of report."""

from __future__ import annotations

from drivesizer.results.drive_set import DriveSet

__all__ = ["unknown_of"]


def unknown_of(drive_set: DriveSet, known: tuple[str, ...]) -> tuple[str, ...]:
    """The parts of a drive that a sum does not cover.

    Parameters
    ----------
    drive_set
        The drive.
    known
        Roles that the sum covers.

    Returns
    -------
    tuple of str
        The other roles.
    """
    return tuple(name for name in drive_set.parts if name not in known)
