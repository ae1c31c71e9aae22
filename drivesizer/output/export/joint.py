"""Shared by the formats with one joint and its limits: link, limits and their remarks."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from drivesizer.output.export.common import Export
from drivesizer.output.export.limits import Limit
from drivesizer.output.export.link import Link
from drivesizer.output.export.markup import brief, number, remark, vector

__all__ = ["BASE", "JOINT", "LINK", "inertial", "limited", "one_of", "remarks"]

BASE, LINK, JOINT = "base", "load", "shaft"


def remarks(of: Export) -> list[str]:
    """Remarks on the file, as sentences."""
    train, least = of.train, of.limits
    travel = f"; the load travels {of.travel}" if train.radius != 1.0 else ""
    said = [
        f"{of.label}; {of.program}. SI: kg, m, s, N, N*m, rad.",
        f"{one_of(of)}The joint is the driven shaft{travel}. Total ratio {brief(train.ratio)}.",
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


def one_of(of: Export) -> str:
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
    """Add mass, centre and inertia of a link.

    Parameters
    ----------
    parent
        Element of the link.
    found
        The link.
    nested
        Each figure in an element of its own, else as attributes.
    """
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
