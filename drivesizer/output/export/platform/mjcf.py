r"""MJCF of a platform: a free base on a floor, wheels that roll on it by contact, drives as MuJoCo's DC motors.

A wheel whose rollers on the floor are at γ to its heading pulls along their axis alone, and rolls across it. It is,
for the floor, a wheel without resistance sideways that rolls along that axis, at :math:`\dot ψ = \dot ϕ \cos γ`. That
is how it is here: the joint turns by ψ about the horizontal across the roller's axis, its drive by K / cos γ of it, and

.. math:: T_ψ = \frac{T}{\cos γ}, \qquad J_ψ = \frac{J}{\cos^2 γ}, \qquad b_ψ = \frac{b}{\cos^2 γ}

Its contact is a capsule about the axis of that joint, which MuJoCo turns the directions of friction by: μ along the
roller's axis, nothing across it. Without rollers (γ = 0) ψ is the wheel's own angle, and friction holds sideways.

Rolling resistance is the joints' dry friction, C_rr N r of the load at rest, as in the sizing; of a caster it is the
friction of a ball that slides. The floor is level and gravity is tilted, where the spec's floor slopes.
"""

from __future__ import annotations

from dataclasses import replace
from math import cos, sin, tan
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from drivesizer.joints.record import Array
from drivesizer.output.export.machine.joint_motor import add_motor, armature, effort, motor_remark
from drivesizer.output.export.machine.record import JointDrive
from drivesizer.output.export.markup import document, number, remark, text, vector
from drivesizer.output.export.mjcf import MOST_POINTS, PER_PERIOD, add_rows, hard
from drivesizer.output.export.platform.record import BASE, PlatformExport, head, of_wheel, rollers, wheel_name

__all__ = ["render"]

_FLOOR = "floor"
_NO_FRICTION = 1e-5  # the least that MuJoCo takes
_ASSUMED_FRICTION = 1.0  # between wheel and floor, where the spec has none
_SHORT = 1e-3  # half length of a contact over its radius: a point, with a direction
_WIDTH, _CASTER = 0.25, 0.25  # half width of a wheel, radius of a caster, over the radius of a wheel: to be seen
_CONTACT = {"solimp": "0.95 0.99 0.001", "condim": "3"}
_SLOWEST = 0.01  # s, time constant of contacts; 4 steps at least
_SHOWN = {"mass": "0", "contype": "0", "conaffinity": "0"}


def render(of: PlatformExport) -> bytes:
    """The file of a platform."""
    step = of.of.period / PER_PERIOD
    root = Element("mujoco", model=text(of.name))
    remark(root, *head(of), *_remarks(of), *rollers(of))
    SubElement(root, "compiler", angle="radian", autolimits="true")
    SubElement(root, "option", timestep=number(step), integrator="Euler", gravity=vector(_gravity(of)),
               cone="elliptic", impratio="100", tolerance="1e-12")  # fmt: skip
    world = SubElement(root, "worldbody")
    SubElement(world, "geom", {"name": _FLOOR, "type": "plane", "size": "0 0 1", **_SHOWN} | {"mass": "0"})
    base = SubElement(world, "body", name=BASE, pos=vector((0.0, 0.0, of.radius)))
    _base(base, of)
    sections = {name: SubElement(root, name) for name in ("contact", "actuator", "sensor", "custom")}
    for place in range(len(of.platform.wheels)):
        _wheel(base, of, place, step)
        _rolls(sections["contact"], of, place, step)
    for place, drive in of.drives.items():
        _drive(sections, of, place, drive)
    for number_, caster in enumerate(of.platform.casters, 1):
        _caster(base, sections["contact"], of, f"caster_{number_}", (caster.x, caster.y, caster.rolling_resistance))
    _cycle(sections["custom"], of)
    return document(root)


def _remarks(of: PlatformExport) -> list[str]:
    """Remarks on wheels, inputs, gears and controllers."""
    said = [
        "Contacts are pairs of a wheel or a caster with the floor: another shape is to be paired with what it may "
        "meet. Stand it for 0.3 s before you drive it: it sinks into the floor by some hundredths of a millimetre."
    ]
    if any(wheel.roller_angle for wheel in of.platform.wheels):
        said.append(
            "A wheel with rollers at an angle is here one that rolls along the axis of its roller on the floor, and "
            "freely across it: its joint turns by the cosine of that angle as much as the wheel, with figures "
            "accordingly. Its motor, and ctrl, are those of the wheel."
        )
    if of.friction is None:
        said.append(f"The friction between wheel and floor is unknown; {_ASSUMED_FRICTION:g} is assumed.")
    if np.any(of.ground.slope):
        said.append("The floor slopes: here it is level, and gravity is tilted by as much.")
    if not of.of.stepper:
        said += [
            "ctrl of each motor, at every step: reference angle [rad] and speed w [rad/s] of the motor, its total "
            "ratio times those of the wheel; feedforward torque [N*m], as its remark says.",
            "MuJoCo has no efficiency of gears: torque constants, and all that the drives add to their joints, are "
            "those with gears that drive. Where the load drives the motor, its current is too large, by up to 1/e^2.",
            "Controllers: the designed ones are sampled, act one period late, and stop their integral at a limit; "
            "these are continuous without anti-windup.",
        ]
    return said


def _gravity(of: PlatformExport) -> tuple[float, float, float]:
    """Of a level floor, and of one that rises towards a direction [m/s^2]."""
    g, slope, uphill = of.ground.gravity, float(of.ground.slope), float(of.ground.uphill)
    return -g * sin(slope) * cos(uphill), -g * sin(slope) * sin(uphill), -g * cos(slope)


# --- bodies


def _base(body: Element, of: PlatformExport) -> None:
    """The base, its frame at the height of the axles."""
    SubElement(body, "freejoint", name="base")
    base, up = of.base, np.array([0.0, 0.0, of.radius])
    moments = vector(np.diag(base.inertia).tolist())
    SubElement(body, "inertial", pos=vector(base.centre - up), mass=number(base.mass), diaginertia=moments)
    if of.size:
        size = of.size
        box = {"size": vector((size.length / 2, size.width / 2, size.height / 2)), "rgba": "0.6 0.6 0.6 0.3"}
        at = vector((size.x, size.y, size.height / 2 - of.radius))
        SubElement(body, "geom", {"type": "box", "pos": at} | box | _SHOWN)


def _axle(of: PlatformExport, place: int) -> Array:
    """Axis of a wheel's joint: across the axis of its roller on the floor, so that forwards is positive."""
    wheel = of.platform.wheels[place]
    along = wheel.heading + wheel.roller_angle
    return np.array([-sin(along), cos(along), 0.0])


def _wheel(base: Element, of: PlatformExport, place: int, step: float) -> None:
    """A wheel with its joint and the capsule that it rolls on."""
    name, wheel = wheel_name(place), of.platform.wheels[place]
    body = SubElement(base, "body", name=f"{name}_link", pos=vector((wheel.x, wheel.y, 0.0)))
    remark(body, of_wheel(of, place))
    drive, axis = _drive_at_joint(of, place), _axle(of, place)
    turned, J = cos(wheel.roller_angle), of.wheel.inertia[0, 0]
    figures = {"frictionloss": of.rolling[place] / turned, "armature": J * tan(wheel.roller_angle) ** 2, "damping": 0.0}
    joint = {"name": name, "type": "hinge", "axis": vector(axis)}
    if drive:
        own = {"frictionloss": drive.friction, "armature": armature(drive), "damping": drive.damping}
        figures = {key: value + own[key] for key, value in figures.items()}
        joint |= effort(drive)
    joint |= {key: number(value) for key, value in figures.items() if value}
    SubElement(body, "joint", joint | (hard(step) if figures["frictionloss"] else {}))
    moments = vector(np.diag(of.wheel.inertia).tolist())
    SubElement(body, "inertial", pos="0 0 0", mass=number(of.wheel.mass), diaginertia=moments)
    half = _SHORT * of.radius * axis
    rolls = {"name": f"{name}_contact", "type": "capsule", "size": number(of.radius), "rgba": "0 0 0 0"}
    SubElement(body, "geom", rolls | {"fromto": vector((*-half, *half))} | _SHOWN)
    _seen(body if not wheel.roller_angle else base, of, place)


def _seen(body: Element, of: PlatformExport, place: int) -> None:
    """A wheel as it is seen: on its joint, or on the base where that turns about another axis."""
    wheel = of.platform.wheels[place]
    axle = _WIDTH * of.radius * np.array([-sin(wheel.heading), cos(wheel.heading), 0.0])
    at = np.array([wheel.x, wheel.y, 0.0]) if wheel.roller_angle else np.zeros(3)
    ends = {"type": "cylinder", "size": number(of.radius), "fromto": vector((*(at - axle), *(at + axle)))}
    SubElement(body, "geom", ends | _SHOWN)


def _drive_at_joint(of: PlatformExport, place: int) -> JointDrive | None:
    """The drive of a wheel as its joint has it, which turns by the cosine of the roller's angle as much."""
    drive = of.drives.get(place)
    return drive and replace(drive, travel=cos(of.platform.wheels[place].roller_angle))


# --- contacts


def _rolls(contact: Element, of: PlatformExport, place: int, step: float) -> None:
    """A wheel on the floor: friction along its heading or the roller's axis, and sideways where it is held."""
    along = _ASSUMED_FRICTION if of.friction is None else of.friction
    across = along if of.platform.wheels[place].held else _NO_FRICTION
    _pair(contact, f"{wheel_name(place)}_contact", (across, along), step)


def _pair(contact: Element, name: str, friction: tuple[float, float], step: float) -> None:
    """A contact with the floor; of a capsule the first friction is along its axis."""
    both = vector((max(friction[0], _NO_FRICTION), max(friction[1], _NO_FRICTION), 0.0, 0.0, 0.0))
    soft = f"{number(max(_SLOWEST, 4.0 * step))} 1"
    SubElement(contact, "pair", {"geom1": _FLOOR, "geom2": name, "friction": both, "solref": soft} | _CONTACT)


def _caster(base: Element, contact: Element, of: PlatformExport, name: str, caster: tuple[float, float, float]) -> None:
    """A ball that slides with the resistance of a caster."""
    x, y, resistance = caster
    ball = {"name": name, "type": "sphere", "size": number(_CASTER * of.radius)}
    SubElement(base, "geom", ball | {"pos": vector((x, y, (_CASTER - 1.0) * of.radius))} | _SHOWN)
    _pair(contact, name, (resistance, resistance), of.of.period / PER_PERIOD)


# --- drives and motion


def _drive(sections: dict[str, Element], of: PlatformExport, place: int, drive: JointDrive) -> None:
    """Motor and sensors of a wheel."""
    name, motor, at_joint = wheel_name(place), f"{wheel_name(place)}_motor", _drive_at_joint(of, place)
    assert at_joint is not None
    remark(sections["actuator"], _inputs(drive, at_joint))
    add_motor(sections["actuator"], at_joint, {"name": motor, "joint": name})
    for kind, what in (("actuatorpos", "angle"), ("actuatorvel", "speed"), ("actuatorfrc", "torque")):
        SubElement(sections["sensor"], kind, name=f"{motor}_{what}", actuator=motor)


def _inputs(drive: JointDrive, at_joint: JointDrive) -> str:
    """Remark on the inputs of a drive."""
    if drive.of.stepper:
        return (
            f"{drive.joint}: a stepper, open-loop; ctrl is the angle of its joint, and its speed: "
            f"{number(at_joint.travel)} of the wheel's."
        )
    return motor_remark(drive)


def _cycle(custom: Element, of: PlatformExport) -> None:
    """The motion: speeds of wheels over time, straight lines between points."""
    if len(of.time) > MOST_POINTS:
        remark(custom, f"The motion has more than {MOST_POINTS} points and is left out; drive --csv has it.")
        return
    remark(custom, "The motion: time [s], speeds of the driven wheels [rad/s].")
    columns = {"cycle_time": of.time}
    columns |= {f"{wheel_name(place)}_speed": of.kinematics.E[place] @ of.eta for place in of.drives}
    add_rows(custom, columns)
