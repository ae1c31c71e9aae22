"""Remarks at the head of a platform's file, as sentences."""

from __future__ import annotations

from collections.abc import Iterable

from drivesizer.output.export.machine.remarks import of_drive
from drivesizer.output.export.markup import brief
from drivesizer.output.export.platform.record import PlatformExport

__all__ = ["head", "of_wheel", "rollers"]


def head(of: PlatformExport) -> list[str]:
    """Remarks on the whole file.

    Parameters
    ----------
    of
        The platform.

    Returns
    -------
    list of str
        What it has, what is assumed.
    """
    whole, wheel = of.platform, of.wheel
    box = "slender as its box" if of.size else "that of a flat plate"
    said = [
        f"{of.of.program}. SI: kg, m, s, N, N*m, rad; x forwards, y to the left, the reference point is the origin.",
        f"All together {brief(whole.mass)} kg, drives and payloads among them, and {brief(whole.inertia)} kg*m^2 about "
        "the vertical through the centre of mass, as the spec has it.",
        f"Of a wheel the spec has the inertia alone: {brief(wheel.mass)} kg is assumed, as of a homogeneous disc of it "
        "within bounds, and the inertia is that about every axis. The base has the rest; its inertia about x and y is "
        f"{box}.",
    ]
    if not whole.height:
        said.append(
            "The height of the centre of mass is unknown: it is on the floor, where accelerating moves no load."
        )
    one = next(iter(of.drives.values()))
    said.append(f"{', '.join(drive.joint for drive in of.drives.values())}, each: {' '.join(of_drive(one))}")
    return said + [f"Assumed: {line}." for line in of.said]


def of_wheel(of: PlatformExport, place: int) -> str:
    """Remark on the joint of a wheel: what resists.

    Parameters
    ----------
    of
        The platform.
    place
        Of the wheel, from 0.

    Returns
    -------
    str
        A sentence.
    """
    no_drive = "" if place in of.drives else "It has no drive. "
    return f"{no_drive}Friction has the {brief(of.rolling[place])} N*m that it takes to roll under its load at rest."


def rollers(of: PlatformExport) -> Iterable[str]:
    """Remark on the rollers' resistance, which no file has, as sentences."""
    C = max(wheel.roller_resistance for wheel in of.platform.wheels)
    if C:
        yield f"Left out: the resistance of the rollers on their pins, {brief(C)} of a wheel's load where they turn."
