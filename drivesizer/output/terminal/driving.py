"""A platform on its path, at the terminal."""

from __future__ import annotations

from collections.abc import Mapping

from drivesizer.control.path_following.following import Followed
from drivesizer.load_cases.platform import Driving
from drivesizer.machine.platform_budget import PermittedSpeeds
from drivesizer.output.document.machine import driving_blocks
from drivesizer.output.terminal import render
from drivesizer.output.terminal.tables import MARK, STYLE, console, heading
from drivesizer.results.drive_set import DriveSet
from drivesizer.units import show

__all__ = ["driven"]


def driven(
    found: Driving, chosen: DriveSet | None, runs: Mapping[str, Followed], speeds: PermittedSpeeds | None = None
) -> None:
    """Print the requirements at each wheel, the checks of a drive on the path, its speeds."""
    out, path = console(), found.trajectory
    status = (MARK[chosen.status], STYLE[chosen.status]) if chosen else ("no drive", "")
    heading(out, f"{found.spec.name}: {show(path.length, 'm', 'length')} in {show(path.total, 's', 'time')}", *status)
    render.blocks(out, driving_blocks(found, chosen, runs, speeds))
