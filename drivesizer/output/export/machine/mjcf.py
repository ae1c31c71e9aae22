r"""MJCF of a machine: the description with its drives as MuJoCo's DC motors, controllers, the trajectory.

A drive is a body of its own at its place, a point mass; its gears' efficiency is that of ``joint_motor``.

The drive whose belt passes other joints acts on a fixed tendon, the sum of their angles.
"""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

import numpy as np

from drivesizer.errors import InputError
from drivesizer.joints.record import Array
from drivesizer.output.export.common import Export
from drivesizer.output.export.joint import LEAST_INERTIA
from drivesizer.output.export.machine.joint_motor import add_motor, armature, effort, motor_remark
from drivesizer.output.export.machine.record import (
    Adding,
    JointDrive,
    MachineExport,
    RobotExport,
    free_name,
    head,
    of_drive,
)
from drivesizer.output.export.markup import brief, document, number, remark, text, vector
from drivesizer.output.export.mjcf import MOST_POINTS, PER_PERIOD, add_rows, hard
from drivesizer.output.export.mjcf import tree as of_one
from drivesizer.spec.description.record import Joint, Link

__all__ = ["render"]

_LEAST_MASS = 1e-9  # kg: no simulator takes a moving body without any
_SHOWN = {"mass": "0", "contype": "0", "conaffinity": "0"}  # of a shape that is for display only
_SECTIONS = ("worldbody", "tendon", "equality", "actuator", "sensor", "custom", "keyframe")
_ONCE = ("compiler", "option")
_WORLD = "world"  # MuJoCo's own body


def render(of: MachineExport) -> bytes:
    """The file of a machine."""
    step = min(one.period for one in of.exports) / PER_PERIOD
    root = Element("mujoco", model=text(of.name))
    remark(root, *head(of), *(_remarks(of.robot) if of.robot else ()))
    SubElement(root, "compiler", angle="radian", autolimits="true")
    option = SubElement(root, "option", timestep=number(step), integrator="Euler",
                        gravity=vector((0.0, 0.0, -of.gravity)))  # fmt: skip
    SubElement(option, "flag", contact="disable")
    sections = {name: SubElement(root, name) for name in _SECTIONS}
    if of.robot:
        _bodies(sections["worldbody"], of.robot, step)
        for drive in of.robot.drives:
            _drive(sections, drive, step)
        _fixed_joints(sections["equality"], of.robot, step)
        _cycle(sections["custom"], of.robot)
    adding = Adding(root, ("body", "joint", "site", "numeric"))
    for name, one in of.axes:
        if one.gravity != of.gravity:
            raise InputError(f"axis {name}: its gravity is another; expected that of the machine, or --axis beside it")
        _other_axis(sections, name, one, adding)
    if of.robot:
        _start(sections, of.robot)
    for name in [name for name, section in sections.items() if not len(section)]:
        root.remove(sections[name])
    return document(root)


def _other_axis(sections: dict[str, Element], name: str, one: Export, adding: Adding) -> None:
    """An axis beside the robot, as its own file has it."""
    remark(sections["worldbody"], f"Axis {name}; in these remarks ctrl counts from its own first input, [0].")
    for section in of_one(one):
        if section.tag in sections:
            adding.add(name, section, sections[str(section.tag)])
        elif section.tag not in _ONCE:  # its remarks
            sections["worldbody"].append(section)


def _remarks(robot: RobotExport) -> list[str]:
    """Remarks on inputs, gears and controllers."""
    steppers = [drive for drive in robot.drives if drive.of.stepper]
    said = []
    if len(steppers) < len(robot.drives):
        said = [
            "ctrl of each motor, at every step: reference angle [rad] and speed w [rad/s] of the motor, its total "
            "ratio times those of the joint, or of the sum that its belt turns by; feedforward torque [N*m], as its "
            "remark says.",
            "MuJoCo has no efficiency of gears: torque constants, and all that the drives add to their joints, are "
            "those with gears that drive. Where the load drives the motor, its current is too large, by up to "
            "1/(e f), f the efficiency there, e where a joint's remark has no other. To correct this, add to "
            "qfrc_applied of the joint at every step (1 - e f) T where T and the reference speed have opposite signs, "
            "T the torque of the gears: qfrc_actuator + qfrc_applied + qfrc_constraint - armature qacc - damping qvel "
            "of the step before.",
            "act: by motor the winding's rise over the ambient [K], where its heat is known, and the current [A].",
            "Controllers: the designed ones are sampled, act one period late, and stop their integral at a limit; "
            "these are continuous without anti-windup.",
        ]
    if steppers:
        said.append(
            "Steppers run open-loop: here position servos with the slope of their sinusoidal torque, cut at the "
            "pull-out torque at rest, and the damping of their swings. At speed they have less, and where more is "
            "required they lose steps: neither is in this file."
        )
    return said


# --- bodies


def _bodies(world: Element, robot: RobotExport, step: float) -> None:
    """Links, each under the one that it hangs on, with drives and payload."""
    made: dict[str, Element] = {}
    for name in _outwards(robot):
        joint, link = robot.robot.above.get(name), robot.robot.links[name]
        parent = world if joint is None else made[joint.parent]
        place, turn = (np.zeros(3), robot.base) if joint is None else (joint.place, joint.turn)
        body = SubElement(parent, "body", {"name": _body_name(name, robot)} | _frame(place, turn))
        made[name] = body
        if joint is not None and joint.moves:
            _joint(body, joint, robot, step)
        _mass(body, link, moves=joint is not None and joint.moves)
        _shape(body, robot, name)
        for drive in robot.drives:
            if drive.place.link == name:
                _point(body, free_name(f"{drive.joint}_drive", robot.robot.links), drive.place.at, drive.mass)
        if robot.payload and robot.payload.link == name:
            _point(body, free_name("payload", robot.robot.links), robot.payload.at, robot.payload_mass)


def _outwards(robot: RobotExport) -> list[str]:
    """Links, each behind the one that it hangs on."""
    above = robot.robot.above
    found = [name for name in robot.robot.links if name not in above]
    beyond: dict[str, list[str]] = {}
    for joint in robot.robot.joints.values():
        beyond.setdefault(joint.parent, []).append(joint.child)
    for name in found:
        found += beyond.get(name, [])
    return found


def _body_name(link: str, robot: RobotExport) -> str:
    """Name of a link's body: its own, unless that is MuJoCo's."""
    return free_name(link, {_WORLD, *(name for name in robot.robot.links if name != link)}) if link == _WORLD else link


def _frame(place: Array, turn: Array) -> dict[str, str]:
    """Attributes of a frame; none where it is that of the parent."""
    found = {"pos": vector(place)} if place.any() else {}
    return found if (turn == np.eye(3)).all() else found | {"quat": vector(quaternion(turn))}


def quaternion(turn: Array) -> tuple[float, float, float, float]:
    """Unit quaternion of a rotation matrix, real part first.

    Examples
    --------
    >>> quaternion(np.diag([1.0, -1.0, -1.0]))
    (0.0, 1.0, 0.0, 0.0)
    """
    trace = float(np.trace(turn))
    squares = [1.0 + trace, *(1.0 - trace + 2.0 * turn[k, k] for k in range(3))]  # 4 times the squares of the parts
    largest = int(np.argmax(squares))
    products = np.empty((4, 4))  # 4 times the products of two parts
    x, y, z = turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]
    products[0] = squares[0], x, y, z
    products[1:, 0] = x, y, z
    products[1:, 1:] = turn + turn.T
    for k in range(3):
        products[k + 1, k + 1] = squares[k + 1]
    w, a, b, c = (products[largest] / (2.0 * np.sqrt(squares[largest]))).tolist()
    return w, a, b, c


def _mass(body: Element, link: Link, *, moves: bool) -> None:
    """Mass, centre and inertia of a link; of one that moves at least what MuJoCo requires."""
    if link.lacking:
        remark(body, f"In the description it {link.lacking}.")
    if not moves and not link.mass:
        return
    J, changed = _possible(link.inertia)
    if changed:
        remark(body, f"Its moments of inertia are of no body: one is above the sum of the others, by {brief(changed)}; "
                     "half of that is added to both.")  # fmt: skip
    rows = (J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2])
    mass = max(link.mass, _LEAST_MASS)
    SubElement(body, "inertial", pos=vector(link.centre), mass=number(mass), fullinertia=vector(rows))


def _possible(inertia: Array) -> tuple[Array, float]:
    """An inertia as MuJoCo takes it: moments above 0, none above the sum of the others; and by how much one was."""
    moments, axes = np.linalg.eigh(inertia)
    if moments[0] >= LEAST_INERTIA and moments[2] <= moments[0] + moments[1]:
        return inertia, 0.0
    moments = np.maximum(moments, LEAST_INERTIA)
    excess = float(max(moments[2] - moments[0] - moments[1], 0.0))
    moments[:2] += excess / 2.0 * (1.0 + 1e-9)
    return axes @ np.diag(moments) @ axes.T, excess


def _point(body: Element, name: str, at: Array, mass: float) -> None:
    """A point mass on a link."""
    about = vector([LEAST_INERTIA] * 3)
    SubElement(SubElement(body, "body", name=name), "inertial", pos=vector(at), mass=number(mass), diaginertia=about)


def _shape(body: Element, robot: RobotExport, link: str) -> None:
    """Capsules to the joints that a link carries, to be seen."""
    for joint in robot.robot.joints.values():
        length = float(np.linalg.norm(joint.place))
        if joint.parent == link and length > 0.0:
            ends = {"size": number(0.06 * length), "fromto": vector((0.0, 0.0, 0.0, *joint.place.tolist()))}
            SubElement(body, "geom", {"type": "capsule"} | ends | _SHOWN)


# --- joints and drives


def _joint(body: Element, joint: Joint, robot: RobotExport, step: float) -> None:
    """A joint with the figures of its drive; those of a drive that passes others are on its tendon."""
    drive = robot.drive(joint.name)
    attributes = {
        "name": joint.name, "type": "hinge" if joint.turns else "slide", "axis": vector(joint.axis),
        "pos": vector(joint.anchor), "ref": number(joint.reference),
    }  # fmt: skip
    if joint.kind != "continuous" and joint.lower <= joint.upper:
        attributes["range"] = f"{number(joint.lower)} {number(joint.upper)}"
    damping, friction = (joint.damping, joint.friction) if drive is None or robot.keeps_friction else (0.0, 0.0)
    figures = {"damping": damping, "frictionloss": friction, "armature": 0.0}
    if drive and not drive.coupled:
        attributes |= effort(drive)
        figures = {name: value + _added(drive)[name] for name, value in figures.items()}
    if drive:
        remark(body, *of_drive(drive))
    attributes |= {name: number(value) for name, value in figures.items() if value}
    SubElement(body, "joint", attributes | (hard(step) if figures["frictionloss"] else {}))


def _added(drive: JointDrive) -> dict[str, float]:
    """Damping, dry friction and armature of a drive, at its joint or its belt."""
    return {"damping": drive.damping, "frictionloss": drive.friction, "armature": armature(drive)}


def _drive(sections: dict[str, Element], drive: JointDrive, step: float) -> None:
    """Motor, sensors, and the tendon of a belt that passes joints."""
    motor, actuator = f"{drive.joint}_motor", sections["actuator"]
    moved = {"joint": drive.joint}
    if drive.coupled:
        moved = {"tendon": f"{drive.joint}_belt"}
        figures = {name: number(value) for name, value in _added(drive).items()}
        tendon = SubElement(
            sections["tendon"], "fixed", {"name": moved["tendon"]} | figures | effort(drive) | hard(step)
        )
        for name, share in drive.turns_by.items():
            SubElement(tendon, "joint", joint=name, coef=number(share))
    remark(actuator, _inputs(drive))
    add_motor(actuator, drive, {"name": motor} | moved)
    sensor = sections["sensor"]
    for kind, name in (("jointpos", "position"), ("jointvel", "speed")):
        SubElement(sensor, kind, name=f"{drive.joint}_{name}", joint=drive.joint)
    SubElement(sensor, "actuatorfrc", name=f"{drive.joint}_torque", actuator=motor)


def _inputs(drive: JointDrive) -> str:
    """Remark on the inputs of a drive."""
    if drive.of.stepper:
        moved = "sum that its belt turns by" if drive.coupled else "joint's position"
        return f"{drive.joint}: a stepper, open-loop; ctrl is the {moved}, and its speed."
    return motor_remark(drive)


# --- held joints, trajectory


def _fixed_joints(equality: Element, robot: RobotExport, step: float) -> None:
    """Joints without a drive, kept where they are held."""
    stiff = {"solref": f"{number(2.0 * step)} 1", "solimp": "0.9999 0.9999 0.001 0.5 2"}
    for name, position in robot.held.items():
        moved = number(position - robot.robot.joints[name].reference)
        SubElement(equality, "joint", {"name": f"{name}_held", "joint1": name, "polycoef": f"{moved} 0 0 0 0"} | stiff)


def _cycle(custom: Element, robot: RobotExport) -> None:
    """The trajectory: positions and speeds of joints over time, straight lines between points."""
    motion = robot.motion
    if len(motion.duration) >= MOST_POINTS:
        remark(custom, f"The trajectory has more than {MOST_POINTS} points and is left out.")
        return
    remark(custom, "The trajectory: time [s], positions and speeds of joints [rad, rad/s or m, m/s].")
    time = np.append(motion.time[:, 0], motion.time[-1, 1])
    columns = {"cycle_time": time}
    for column, name in enumerate(motion.joints):
        for what, values in (("position", motion.position), ("speed", motion.speed)):
            columns[f"{name}_{what}"] = np.append(values[:, 0, column], values[-1, 1, column])
    add_rows(custom, columns)


def _start(sections: dict[str, Element], robot: RobotExport) -> None:
    """Positions at which the trajectory starts; axes beside the robot at 0."""
    at = dict(robot.held) | dict(zip(robot.motion.joints, robot.motion.position[0, 0].tolist(), strict=True))
    joints = [one.attrib["name"] for one in sections["worldbody"].iter("joint")]
    SubElement(sections["keyframe"], "key", name="start", qpos=vector(at.get(name, 0.0) for name in joints))
