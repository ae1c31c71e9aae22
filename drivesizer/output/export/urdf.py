"""URDF: one joint with the limits, friction and inertia of the drive at the load, and its transmission.

URDF requires both effort and velocity: an unknown one is refused.
"""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from drivesizer.errors import InputError
from drivesizer.output.export.common import Export
from drivesizer.output.export.joint import BASE, JOINT, LINK, inertial, limited, link_of, remarks
from drivesizer.output.export.markup import document, identifier, number, remark, vector

__all__ = ["render", "required_limits", "robot", "transmission", "tree"]


def render(of: Export) -> bytes:
    """The file of a drive."""
    return document(tree(of))


def tree(of: Export) -> Element:
    """The robot with its transmission; as :func:`robot`."""
    root = robot(of)
    transmission(root, JOINT, of.train.ratio, "motor", steps=of.stepper is not None)
    return root


def robot(of: Export) -> Element:
    """Two links and the joint between them."""
    root = Element("robot", name=identifier(of.name))
    remark(root, *remarks(of))
    SubElement(root, "link", name=BASE)
    moved = link_of(of, of.known_inertia)
    inertial(SubElement(root, "link", name=LINK), moved, nested=False)
    joint = SubElement(root, "joint", name=JOINT, type="continuous")
    SubElement(joint, "parent", link=BASE)
    SubElement(joint, "child", link=LINK)
    SubElement(joint, "axis", xyz=vector(moved.axis))
    SubElement(joint, "limit", _required_limits(of))
    SubElement(joint, "dynamics", damping=number(of.damping), friction=number(of.friction))
    return root


def _required_limits(of: Export) -> dict[str, str]:
    return required_limits(of.label, limited(of))


def required_limits(label: str, known: dict[str, str]) -> dict[str, str]:
    """Effort and velocity, which URDF requires."""
    for name, of_what in (("effort", "torque"), ("velocity", "speed")):
        if name not in known:
            raise InputError(f"--format: no limit of {of_what} of {label} is known, and URDF needs one")
    return known


def transmission(root: Element, joint: str, ratio: float, actuator: str, *, steps: bool) -> None:
    """Add a transmission as ROS 1 and MoveIt read it; ros2_control has its own."""
    added = SubElement(root, "transmission", name=f"{joint}_transmission")
    SubElement(added, "type").text = "transmission_interface/SimpleTransmission"
    of_joint = SubElement(added, "joint", name=joint)
    interface = "Position" if steps else "Effort"
    SubElement(of_joint, "hardwareInterface").text = f"hardware_interface/{interface}JointInterface"
    of_motor = SubElement(added, "actuator", name=actuator)
    SubElement(of_motor, "mechanicalReduction").text = number(ratio)
