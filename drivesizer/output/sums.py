"""Sums over the parts of a drive, for several kinds of report."""

from __future__ import annotations

from math import isnan

from drivesizer.catalog import Catalog
from drivesizer.machine.mass_budget import drive_rows
from drivesizer.results.drive_set import DriveSet

__all__ = ["not_in_mass", "unknown_of"]


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


def not_in_mass(drive_set: DriveSet, catalog: Catalog) -> tuple[str, ...]:
    """The parts that the mass of motor and gearhead excludes, with their masses where known or estimated.

    Parameters
    ----------
    drive_set
        The drive.
    catalog
        The catalogue of its parts, with its estimates.

    Returns
    -------
    tuple of str
        Role and mass of each; the band of one that is estimated.
    """
    rows = {row.name: row for row in drive_rows(drive_set, 1, catalog)}
    left = [rows[name] for name in unknown_of(drive_set, drive_set.mass_of)]
    return tuple(f"{row.name} {'not known' if isnan(row.each) else row.text(row.each, 'g')}" for row in left)
