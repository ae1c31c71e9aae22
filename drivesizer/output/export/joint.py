r"""Shared by the formats with one joint and its limits: link, limits and their remarks.

The link that a drive moves: axis, mass and centre of mass, in a world whose z points up.

A load that gravity turns is a mass on its lever, so that the simulator's own gravity makes the torque

.. math:: M \cos(\varphi_0 + \varphi), \qquad M = m g l s

s is the share of the weight that acts across the tilted axis. The lever's level line lies
along x; the axis is level but for its tilt, and turning forward raises the lever. Every other load turns about z, and
its mass does not count.
"""

from __future__ import annotations

from math import cos, sin, sqrt
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement

from drivesizer.output.export.common import Export, Limit
from drivesizer.output.export.markup import brief, number, remark, vector

__all__ = [
    "BASE",
    "JOINT",
    "LEAST_INERTIA",
    "LINK",
    "Link",
    "Vector",
    "drive_count_text",
    "far_above",
    "inertial",
    "limited",
    "link_of",
    "remarks",
]  # fmt: skip

Vector = tuple[float, float, float]
LEAST_INERTIA = 1e-12  # kg*m^2: no simulator takes a moving link without any
_FAR = 1e3  # lengths of the lever


class Link(NamedTuple):
    """One moving body."""

    axis: Vector  # unit vector; forward by the right-hand rule
    centre: Vector  # m, of mass, from the axis
    mass: float  # kg
    inertia: float  # kg*m^2 about its centre of mass, in every direction
    said: str  # remark


def link_of(of: Export, inertia: float) -> Link:
    """The link of a drive."""
    lever = of.lever
    if lever is None:
        said = "The mass does not count: the link turns about its own axis. All of the load is in its inertia."
        return Link((0.0, 0.0, 1.0), (0.0, 0.0, 0.0), 1.0, max(inertia, LEAST_INERTIA), said)
    axis, up = _across(lever.share)
    along, high = lever.length * cos(lever.start), lever.length * sin(lever.start)
    about_centre = inertia - lever.mass * lever.length**2
    said = "One drive's share of the mass, at its position at the start of the cycle: gravity makes its torque."
    centre = (along, high * up[1], high * up[2])
    return Link(axis, centre, lever.mass, max(about_centre, LEAST_INERTIA), said)


def far_above(of: Export) -> Vector:
    """A point so far up, across the axis, that every line from it to the lever is plumb to 1e-3 [m]."""
    assert of.lever is not None
    _, up = _across(of.lever.share)
    return (0.0, _FAR * of.lever.length * up[1], _FAR * of.lever.length * up[2])


def _across(share: float) -> tuple[Vector, Vector]:
    """An axis tilted so far, and the direction across it and the level line that leads up."""
    rest = sqrt(max(1.0 - share * share, 0.0))
    return (0.0, -share, rest), (0.0, rest, share)


BASE, LINK, JOINT = "base", "load", "shaft"


def remarks(of: Export) -> list[str]:
    """Remarks on the file, as sentences."""
    train, least = of.train, of.limits
    travel = f"; the load travels {of.travel}" if train.radius != 1.0 else ""
    said = [
        f"{of.label}; {of.program}. SI: kg, m, s, N, N*m, rad.",
        f"{drive_count_text(of)}The joint is the driven shaft{travel}. Total ratio {brief(train.ratio)}.",
        f"effort is the peak torque, {_shown(least.peak_torque, 'N*m')}: a simulator cuts at every instant, and the "
        "accelerations of the cycle need more than the continuous torque. Check the RMS of other cycles against the "
        f"continuous torque, {_shown(least.continuous_torque, 'N*m')}.",
        _velocity(of),
        f"Gears: effort counts behind them, driving at an efficiency of {brief(train.efficiency)}. Braking, they help.",
        f"inertia, all seen at the shaft: load {brief(train.load_inertia)}, and rotor with gearhead input "
        f"{_rotor(of)}.",
        *(f"Assumed: {line}." for line in of.said),
    ]  # fmt: skip
    if of.constant_weight:
        said.append(f"Left out: a torque of {brief(of.constant_weight)} N*m against forward motion, the load's weight.")
    if of.lever:
        said.append(
            f"The weight of the lever, up to {brief(abs(of.moment))} N*m, is that of the link: leave gravity on."
        )
    if of.cycle.load_time:
        said.append("Left out: torque of the load over time, such as wind or a changing weight.")
    if of.elastic:
        said.append("Left out: the elastic shaft between motor and load.")
    return said


def _velocity(of: Export) -> str:
    """Remark on the limit of speed."""
    fastest = _shown(of.limits.peak_speed, "rad/s")
    if of.stepper:
        there = float(of.stepper.model.torque[-1]) * of.train.ratio * of.train.efficiency
        return (
            f"velocity is {fastest}, up to which the pull-out torque is known; there it is {brief(there)} N*m. A "
            "stepper from which more is required loses steps, which no joint shows."
        )
    return (
        "velocity is that at no load and the lowest supply voltage or what the parts permit for a short time, "
        f"{fastest}; continuous {_shown(of.limits.continuous_speed, 'rad/s')}. At that speed the motor has no "
        "torque left: the corner of the two limits is not reached."
    )


def drive_count_text(of: Export) -> str:
    """The sentence that the file is one of several drives; empty for one."""
    return f"One of {of.motor_sets} drives. " if of.motor_sets > 1 else ""


def _rotor(of: Export) -> str:
    if of.reflected_inertia == of.reflected_inertia:
        return f"{brief(of.reflected_inertia)} kg*m^2, for which the format has no place of its own"
    return "UNKNOWN and left out: what accelerates here needs less torque than the drive does"


def _shown(limit: Limit, unit: str) -> str:
    if not limit.by:
        return "unknown"
    unknown = f"; unknown: {', '.join(limit.unknown)}" if limit.unknown else ""
    return f"{brief(limit.value)} {unit} ({limit.by}{unknown})"


def limited(of: Export) -> dict[str, str]:
    """Effort and velocity of the joint; what is unknown is left out."""
    named = {"effort": of.limits.peak_torque, "velocity": of.limits.peak_speed}
    return {name: number(limit.value) for name, limit in named.items() if limit.by}


def inertial(parent: Element, found: Link, *, nested: bool) -> None:
    """Add mass, centre and inertia of a link."""
    remark(parent, found.said)
    element, about = SubElement(parent, "inertial"), number(found.inertia)
    moments = {"ixx": about, "ixy": "0", "ixz": "0", "iyy": about, "iyz": "0", "izz": about}
    if nested:
        if any(found.centre):
            SubElement(element, "pose").text = f"{vector(found.centre)} 0 0 0"
        SubElement(element, "mass").text = number(found.mass)
        inertia = SubElement(element, "inertia")
        for name, value in moments.items():
            SubElement(inertia, name).text = value
        return
    if any(found.centre):
        SubElement(element, "origin", xyz=vector(found.centre), rpy="0 0 0")
    SubElement(element, "mass", value=number(found.mass))
    SubElement(element, "inertia", moments)
