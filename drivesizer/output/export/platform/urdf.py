"""URDF of a platform: its base on the floor, and a continuous joint for each wheel with the figures of its drive.

``base_footprint`` is the reference point on the floor, without mass; ``base_link`` is above it, at the height of the
axles, and has the mass of all but the wheels. A wheel's joint turns about its axle and rolls forwards where it is
positive. URDF has neither armature nor rollers: remarks have them.
"""

from __future__ import annotations

from math import pi
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from drivesizer.output.export.machine.urdf import add_inertial
from drivesizer.output.export.markup import document, identifier, number, remark, vector
from drivesizer.output.export.platform.record import BASE, PlatformExport, head, of_wheel, rollers, wheel_name
from drivesizer.output.export.urdf import required_limits, transmission

__all__ = ["FOOTPRINT", "render", "robot"]

FOOTPRINT = "base_footprint"
_WIDTH = 0.5  # of a wheel, over its radius: assumed, to be seen
_CASTER = 0.25  # radius of a caster over that of the wheels: assumed


def render(of: PlatformExport) -> bytes:
    """The file of a platform."""
    root = robot(of)
    for place, drive in of.drives.items():
        motor = f"{wheel_name(place)}_motor"
        transmission(root, drive.joint, drive.ratio, motor, steps=drive.of.stepper is not None)
    return document(root)


def robot(of: PlatformExport, direction: float = 1.0) -> Element:
    """Links and joints."""
    root = Element("robot", name=identifier(of.name))
    remark(root, *head(of), *_rolling(of))
    SubElement(root, "link", name=FOOTPRINT)
    _base(root, of)
    for place in range(len(of.platform.wheels)):
        _wheel(root, of, place, direction)
    for number_, caster in enumerate(of.platform.casters, 1):
        _caster(root, of, f"caster_{number_}", (caster.x, caster.y))
    return root


def _rolling(of: PlatformExport) -> list[str]:
    """Remarks on what the format has no place for."""
    said = [
        "Shapes are to be seen and to stand on: the width of wheels and the size of casters are assumed. A caster "
        "slides; give it no friction in your simulator."
    ]
    if any(wheel.roller_angle or not wheel.held for wheel in of.platform.wheels):
        angles = ", ".join(number(wheel.roller_angle) for wheel in of.platform.wheels)
        said.append(
            f"Wheels have rollers, at {angles} rad to their heading on the floor. URDF has none: let the floor's "
            "friction act along these directions alone; the format mjcf has it so."
        )
    return [*said, *rollers(of)]


def _base(root: Element, of: PlatformExport) -> None:
    """The base, above its footprint at the height of the axles."""
    link = SubElement(root, "link", name=BASE)
    up = np.array([0.0, 0.0, of.radius])
    add_inertial(link, of.base._replace(centre=of.base.centre - up))
    if of.size:
        size = of.size
        visual = SubElement(link, "visual")
        SubElement(visual, "origin", xyz=vector((size.x, size.y, size.height / 2.0 - of.radius)), rpy="0 0 0")
        SubElement(SubElement(visual, "geometry"), "box", size=vector((size.length, size.width, size.height)))
    _fixed(root, "base_joint", FOOTPRINT, BASE, (0.0, 0.0, of.radius))


def _wheel(root: Element, of: PlatformExport, place: int, direction: float) -> None:
    """A wheel with its joint."""
    name, at, drive = wheel_name(place), of.platform.wheels[place], of.drives.get(place)
    link = SubElement(root, "link", name=f"{name}_link")
    add_inertial(link, of.wheel)
    for shape in ("visual", "collision"):
        element = SubElement(link, shape)
        SubElement(element, "origin", xyz="0 0 0", rpy=vector((pi / 2.0, 0.0, 0.0)))
        round_ = {"radius": number(at.radius), "length": number(_WIDTH * at.radius)}
        SubElement(SubElement(element, "geometry"), "cylinder", round_)
    joint = SubElement(root, "joint", name=name, type="continuous")
    remark(joint, of_wheel(of, place))
    SubElement(joint, "parent", link=BASE)
    SubElement(joint, "child", link=f"{name}_link")
    SubElement(joint, "origin", xyz=vector((at.x, at.y, 0.0)), rpy=vector((0.0, 0.0, at.heading)))
    SubElement(joint, "axis", xyz=vector((0.0, direction, 0.0)))
    if drive:
        SubElement(joint, "limit", required_limits(drive.of.label, drive.limits))
    damping, friction = (drive.damping, drive.friction) if drive else (0.0, 0.0)
    SubElement(joint, "dynamics", damping=number(damping), friction=number(friction + of.rolling[place]))


def _caster(root: Element, of: PlatformExport, name: str, at: tuple[float, float]) -> None:
    """A ball on the floor that slides, in the place of a caster."""
    link = SubElement(root, "link", name=f"{name}_link")
    for shape in ("visual", "collision"):
        ball = SubElement(SubElement(SubElement(link, shape), "geometry"), "sphere")
        ball.set("radius", number(_CASTER * of.radius))
    _fixed(root, name, BASE, f"{name}_link", (*at, (_CASTER - 1.0) * of.radius))


def _fixed(root: Element, name: str, parent: str, child: str, at: tuple[float, float, float]) -> None:
    joint = SubElement(root, "joint", name=name, type="fixed")
    SubElement(joint, "parent", link=parent)
    SubElement(joint, "child", link=child)
    SubElement(joint, "origin", xyz=vector(at), rpy="0 0 0")
