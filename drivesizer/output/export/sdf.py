"""SDFormat 1.7, for Gazebo: one joint with the limits, friction and inertia of the drive at the load."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from drivesizer.output.export.common import (
    BASE,
    JOINT,
    LINK,
    Export,
    Link,
    document,
    identifier,
    inertial,
    limited,
    link_of,
    number,
    remark,
    remarks,
    vector,
)

__all__ = ["VERSION", "render"]

VERSION = "1.7"  # the first with parent="world"; read by every Gazebo since


def render(of: Export) -> bytes:
    """The file of a drive."""
    root = Element("sdf", version=VERSION)
    remark(root, *remarks(of), "SDFormat has no transmission: the reduction is in the figures alone.")
    model = SubElement(root, "model", name=identifier(of.name))
    base = SubElement(model, "link", name=BASE)
    remark(base, "The base stands on the world; its own figures do not count.")
    fixed = SubElement(model, "joint", name="stand", type="fixed")
    SubElement(fixed, "parent").text = "world"
    SubElement(fixed, "child").text = BASE
    moved = link_of(of, of.known_inertia)
    inertial(SubElement(model, "link", name=LINK), moved, nested=True)
    joint = SubElement(model, "joint", name=JOINT, type="revolute")
    SubElement(joint, "parent").text = BASE
    SubElement(joint, "child").text = LINK
    _axis(joint, of, moved)
    return document(root)


def _axis(joint: Element, of: Export, moved: Link) -> None:
    axis = SubElement(joint, "axis")
    SubElement(axis, "xyz").text = vector(moved.axis)
    limit = SubElement(axis, "limit")
    for name, value in {"lower": "-1e16", "upper": "1e16", **limited(of)}.items():
        SubElement(limit, name).text = value
    dynamics = SubElement(axis, "dynamics")
    springs = {"spring_reference": 0.0, "spring_stiffness": 0.0}  # required by the format
    for name, figure in {"damping": of.damping, "friction": of.friction, **springs}.items():
        SubElement(dynamics, name).text = number(figure)
