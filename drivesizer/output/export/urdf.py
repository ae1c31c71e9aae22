"""URDF: one joint with the limits, friction and inertia of the drive at the load, and its transmission.

URDF requires both effort and velocity: an unknown one is refused.
"""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from drivesizer.errors import InputError
from drivesizer.output.export.common import Export
from drivesizer.output.export.joint import BASE, JOINT, LINK, inertial, limited, remarks
from drivesizer.output.export.link import link_of
from drivesizer.output.export.markup import document, identifier, number, remark, vector

__all__ = ["render", "robot"]


def render(of: Export) -> bytes:
    """The file of a drive."""
    root = robot(of)
    _transmission(root, of)
    return document(root)


def robot(of: Export) -> Element:
    """Two links and the joint between them.

    Raises
    ------
    InputError
        When no limit of torque or of speed is known.
    """
    root = Element("robot", name=identifier(of.name))
    remark(root, *remarks(of))
    SubElement(root, "link", name=BASE)
    moved = link_of(of, of.known_inertia)
    inertial(SubElement(root, "link", name=LINK), moved, nested=False)
    joint = SubElement(root, "joint", name=JOINT, type="continuous")
    SubElement(joint, "parent", link=BASE)
    SubElement(joint, "child", link=LINK)
    SubElement(joint, "axis", xyz=vector(moved.axis))
    SubElement(joint, "limit", _both(of))
    SubElement(joint, "dynamics", damping=number(of.damping), friction=number(of.friction))
    return root


def _both(of: Export) -> dict[str, str]:
    known = limited(of)
    for name, of_what in (("effort", "torque"), ("velocity", "speed")):
        if name not in known:
            raise InputError(f"--format: no limit of {of_what} of {of.label} is known, and URDF needs one")
    return known


def _transmission(root: Element, of: Export) -> None:
    """Transmission as ROS 1 and MoveIt read it; ros2_control has its own."""
    transmission = SubElement(root, "transmission", name=f"{JOINT}_transmission")
    SubElement(transmission, "type").text = "transmission_interface/SimpleTransmission"
    joint = SubElement(transmission, "joint", name=JOINT)
    SubElement(
        joint, "hardwareInterface"
    ).text = f"hardware_interface/{'Position' if of.stepper else 'Effort'}JointInterface"
    actuator = SubElement(transmission, "actuator", name="motor")
    SubElement(actuator, "mechanicalReduction").text = number(of.train.ratio)
