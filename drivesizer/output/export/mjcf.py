r"""MJCF: axes, a described robot or a platform with MuJoCo's DC motors, their controllers and their motion.

MuJoCo 3.12 or later, the first whose DC motor has controller inputs; 4.0 for a cycle of more than 500 points. It has no
gear efficiency e. An axis has its own load: a load T requires T/e while driven, and e T while it drives the motor.

- A weight W requires either, by the direction of motion, modelled as (1/e + e)/2 of it and a dry friction of
  (1/e - e)/2 of it. On a lever, where W depends on the angle, that friction is one of a plumb line (a tendon) from the
  mass to a point far above, whose arm about the axis is that of the weight.
- Inertia and friction of the load, and ctrl[3], count with 1/e, as while driven. While they brake, the file takes more
  current than the drive, by up to 1/e^2; ``ctrl`` has an input for the correction, and the remarks its rule.

A joint of a robot, or a wheel, has no load of its own that could be scaled; so the motor is, with gears that drive: its
torque constant, inertia and friction by e,

.. math:: k_t' = e\, k_t, \quad J' = e\, J_m, \quad b' = e\, b_m, \quad M_f' = e\, M_f

Then the joint gets K e M, its current, voltage and heat are the motor's own. Where the load drives the motor, its
torque T counts in the motor as f T and not as T/e, f = e but for worms: ``qfrc_applied`` is the place to correct it, by
(1 - e f) T.

Of the two thermal bodies MuJoCo has the winding, on a housing at its mean temperature in periodic steady state. That
holds for cycles that are short compared with the housing's time constant.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from math import cos, isnan, pi, sin, sqrt, tan
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from scipy.spatial.transform import Rotation

from drivesizer.control.drive_train import DriveTrain
from drivesizer.errors import InputError
from drivesizer.joints.inverse_dynamics import Array
from drivesizer.output.export import common
from drivesizer.output.export.common import Export, brief, number, remark, sentences, torque_law, vector
from drivesizer.output.export.joint_drive import JointDrive
from drivesizer.output.export.machine import MachineExport, RobotExport, free_name, head
from drivesizer.output.export.platform import BASE, PlatformExport, wheel_name
from drivesizer.physics.thermal import COPPER, DATA_TEMPERATURE

PER_PERIOD = 4  # steps in a period of the velocity loop: MuJoCo's is of first order in its step
MOST_POINTS = 2000  # of the cycle in the file
_ROW_OF_3 = 500  # figures that MuJoCo 3 reads in a row
_ZERO_CELSIUS = 273.15
_LEAST_MASS = 1e-9  # kg: no simulator takes a moving body without any
_DISPLAY_ONLY = {"mass": "0", "contype": "0", "conaffinity": "0"}  # of a shape that is for display only
_SECTIONS = ("worldbody", "contact", "tendon", "equality", "actuator", "sensor", "custom", "keyframe")
_WORLD = "world"  # MuJoCo's own body
Sections = dict[str, Element]


def render(of: MachineExport) -> bytes:
    """The file of a machine."""
    root = Element("mujoco", model=common.text(of.name))
    alone, robot, platform = of.alone, of.robot, of.platform
    step = min(export.period for _, export in of.exports) / PER_PERIOD
    gravity = (0.0, 0.0, -of.gravity)
    if platform:
        remark(root, *platform.head, *_platform_remarks(platform), *platform.rollers)
        g, slope, uphill = platform.ground.gravity, float(platform.ground.slope), float(platform.ground.uphill)
        gravity = (-g * sin(slope) * cos(uphill), -g * sin(slope) * sin(uphill), -g * cos(slope))
    elif alone:
        remark(root, *_axis_remarks(alone))
    else:
        remark(root, *head(of))
        kinds = {"steppers" if drive.of.stepper else "motors" for drive in robot.drives} if robot else ()
        for kind in sorted(kinds):
            remark(root, *sentences(f"MuJoCo: {kind} of a robot"))
    SubElement(root, "compiler", angle="radian", autolimits="true")
    option = SubElement(root, "option", timestep=number(step), integrator="Euler", gravity=vector(gravity))
    if platform:
        option.attrib |= {"cone": "elliptic", "impratio": "100", "tolerance": "1e-12"}
    else:
        SubElement(option, "flag", contact="disable")
    sections = {name: SubElement(root, name) for name in _SECTIONS}
    if robot:
        _robot(sections, robot, step)
    if platform:
        _platform(sections, platform, step)
    for name, drive in of.axes:
        if drive.gravity != of.gravity:
            raise InputError(f"axis {name}: its gravity is another; expected that of the machine, or --axis beside it")
        _axis(sections, name, drive)
        common.refuse_doubles(root, ("body", "joint", "site", "numeric"), name)
    if robot:  # the positions at which the trajectory starts; axes beside the robot at 0
        start = zip(robot.motion.joints, robot.motion.position[0, 0].tolist(), strict=True)
        at, joints = dict(robot.fixed_joints) | dict(start), sections["worldbody"].iter("joint")
        qpos = vector(at.get(joint.attrib["name"], 0.0) for joint in joints)
        SubElement(sections["keyframe"], "key", name="start", qpos=qpos)
    for section in sections.values():
        if not len(section):
            root.remove(section)
    return common.document(root)


def _hard(step: float) -> dict[str, str]:
    """Attributes of a dry friction, which is a constraint, as hard as MuJoCo has it."""
    return {"solreffriction": f"{number(2 * step)} 1", "solimpfriction": "0.9999 0.9999 0.001 0.5 2"}


def _point_mass(body: Element, name: str, at: Iterable[float], mass: float) -> None:
    about = vector([common.LEAST_INERTIA] * 3)
    SubElement(SubElement(body, "body", name=name), "inertial", pos=vector(at), mass=number(mass), diaginertia=about)


def _rows(custom: Element, rows: Mapping[str, Iterable[float]], note: str, left_out: str) -> None:
    """Rows of figures under their names; a remark where they are too long, for some versions of MuJoCo or for all."""
    listed = {name: list(row) for name, row in rows.items()}
    longest = max(map(len, listed.values()))
    if longest > MOST_POINTS:
        remark(custom, left_out)
        return
    remark(custom, note)
    if longest > _ROW_OF_3:
        remark(custom, f"Rows of more than {_ROW_OF_3} figures: for MuJoCo 4.0 or later.")
    for name, row in listed.items():
        SubElement(custom, "numeric", name=name, data=vector(row))


# Motors.


def _current_scale(train: DriveTrain) -> float:
    """Current and voltage in MuJoCo over those of the motor, s = sqrt(k_t / k_e) [1].

    MuJoCo has one constant, sqrt(k_t k_e). Torque and speed are those of both: sqrt(k_t k_e) s I = k_t I,
    s V = R s I + sqrt(k_t k_e) w.
    """
    return sqrt(train.torque_constant / train.back_emf_constant)


def _motor_figures(of: Export, law: common.TorqueLaw) -> dict[str, str]:
    """Attributes of the motor with its winding and its controller."""
    train = of.train
    s = _current_scale(train)
    figures = {
        "gear": number(train.ratio), "resistance": number(train.resistance),
        "motorconst": f"{number(train.torque_constant)} {number(train.back_emf_constant)}",
        "armature": number(train.motor_inertia), "damping": number(train.viscous), "input": "pos vel ff",
        "controller": " ".join(number(x) for x in (law.kp, law.ki, law.kd, 0.0, 0.0, s * of.voltage)),
    }  # fmt: skip
    if of.inductance_known:
        figures["inductance"] = f"{number(train.inductance)} 0"
    if of.peak_current == of.peak_current:
        figures["saturation"] = f"0 {number(s * of.peak_current)} 0"
    if of.heat is not None:
        # resistance, capacity, time constant (of both), temperature coefficient, its reference, ambient: the housing's
        kelvin = DATA_TEMPERATURE, of.ambient if isnan(of.housing) else of.housing
        body = float(of.heat.R_th1) / s**2, float(of.heat.capacity_w) * s**2
        figures["thermal"] = vector((*body, 0.0, COPPER, *(_celsius(T) for T in kelvin)))
    return figures


def _celsius(kelvin: float) -> float:
    return round(kelvin - _ZERO_CELSIUS, 9)


def _feedforward(law: common.TorqueLaw) -> str:
    """The law of the feedforward, in words."""
    terms = [(law.per_speed, "w"), (law.per_acceleration, "dw/dt"), (law.per_direction, "sign(w)")]
    return " + ".join(f"{number(gain)} {what}" for gain, what in terms if gain) or "0"


# An axis: a body that turns with the driven shaft.
#
# Inputs, set at every step: reference angle, reference speed and feedforward torque of the motor; torque of the load
# beyond friction, inertia and weight.


def _axis(sections: Sections, name: str, of: Export) -> None:
    """An axis with its load, its motor and its cycle; of several, names begin with it."""
    before, world, actuator = f"{common.identifier(name)}_" if name else "", sections["worldbody"], sections["actuator"]
    tags = ["worldbody", *(["tendon"] if of.lever else []), "actuator", "sensor", "custom"]
    if name:
        remark(world, f"Axis {name}; in these remarks ctrl counts from its own first input, [0].", *_axis_remarks(of))
        for section in tags:
            remark(sections[section], f"Axis {common.identifier(name)}.")
    train, step, e, lever = of.train, of.period / PER_PERIOD, of.train.efficiency, of.lever
    mean, half = (1.0 / e + e) / 2.0, (1.0 / e - e) / 2.0  # of the factors of a load driven and driving
    body = SubElement(world, "body", name=f"{before}load")
    link = common.link_of(of, reflected=False)
    lost = 1.0 / e - 1.0
    friction = of.load_friction * (1.0 + lost) + half * abs(of.constant_weight) + train.friction * train.ratio
    more = (mean - 1.0) * lever.mass if lever else 0.0  # kg, added to the weight by the gears
    rotor = train.motor_inertia * train.ratio**2 if of.stepper else 0.0  # else the motor's actuator has it
    armature = rotor + train.load_inertia * lost - (more * lever.length**2 if lever else 0.0)
    remark(body, "The body is the load's own: armature, and the mass of gears_loss, are what the gears add to it.")
    joint = {"joint": f"{before}shaft"}
    turns = {"name": joint["joint"], "type": "hinge", "axis": vector(link.axis), "frictionloss": number(friction)}
    SubElement(body, "joint", turns | {"armature": number(armature)} | _hard(step))
    remark(body, link.remark)
    about = vector([link.inertia] * 3)
    SubElement(body, "inertial", pos=vector(link.centre), mass=number(link.mass), diaginertia=about)
    if lever is None:
        size = number(0.1 if of.turns else train.radius)
        SubElement(body, "geom", {"type": "cylinder", "size": f"{size} 0.02"} | _DISPLAY_ONLY)
    else:
        ends = {"size": number(0.05 * lever.length), "fromto": vector((0.0, 0.0, 0.0, *link.centre))}
        SubElement(body, "geom", {"type": "capsule"} | ends | _DISPLAY_ONLY)
        _point_mass(body, f"{before}gears_loss", link.centre, more)
        loss = {"frictionloss": number(half * abs(of.moment) / lever.length), "rgba": "0 0 0 0"}
        plumb = {"name": f"{before}plumb_line", "width": "1e-4"} | loss | _hard(step)
        line = SubElement(sections["tendon"], "spatial", plumb)
        sites = {"above": (world, common.far_above(lever)), "weight": (body, link.centre)}
        for site, (parent, place) in sites.items():
            unseen = {"name": before + site, "pos": vector(place), "size": "1e-3", "rgba": "0 0 0 0"}
            SubElement(parent, "site", unseen)
            SubElement(line, "site", site=before + site)
    motor = {"name": f"{before}motor"} | joint
    if of.stepper:
        _stepper(actuator, motor, of, 1.0, of.limits.peak_torque.value)
    else:
        SubElement(actuator, "dcmotor", motor | _motor_figures(of, torque_law(of)))
    load = f"ctrl[{2 if of.stepper else 3}]"
    against = "Torque of the load, positive against forward motion"
    remark(actuator, f"{against}: weight that is the same everywhere, and {load}.")
    SubElement(actuator, "general", {
        "name": f"{before}load_torque", **joint, "gaintype": "fixed", "gainprm": number(-1.0 / e), "biastype": "affine",
        "biasprm": f"{number(0.0 - of.constant_weight * mean)} 0 0",
    })  # fmt: skip
    for kind, what in (("jointpos", "shaft_angle"), ("jointvel", "shaft_speed")):
        SubElement(sections["sensor"], kind, {"name": before + what} | joint)
    SubElement(sections["sensor"], "actuatorfrc", name=f"{before}motor_torque", actuator=motor["name"])
    rows = {"time": of.cycle.time, "speed": of.cycle.speed}
    if of.cycle.load_time:
        rows |= {"load_time": of.cycle.load_time, "load_torque": of.cycle.load_torque}
    _rows(
        sections["custom"], {f"{before}cycle_{what}": row for what, row in rows.items()},
        "One cycle, straight lines between points: time [s], speed of the shaft [rad/s], load [N*m].",
        f"The cycle has more than {MOST_POINTS} points and is left out; --format json has it.",
    )  # fmt: skip


def _stepper(actuator: Element, named: dict[str, str], of: Export, square: float, most: float) -> None:
    """A stepper as a position servo as stiff as its torque about a held position, up to its pull-out torque."""
    assert of.stepper is not None
    limits = {"kp": number(of.stepper.stiffness / square), "forcerange": f"-{number(most)} {number(most)}"}
    SubElement(actuator, "position", named | limits)
    damping = {"name": f"{named['name']}_damping", "kv": number(of.stepper.damping / square)}
    SubElement(actuator, "velocity", named | damping)


def _axis_remarks(of: Export) -> list[str]:
    """Remarks on an axis."""
    train, first = of.train, f"{of.label}; {of.program}. SI: m, kg, s, N, N*m, rad, A, V."
    gears = sentences("MuJoCo: gears of an axis", of=of, train=train)
    elastic = sentences("MuJoCo: elastic shaft", of=of)
    if of.stepper:
        stepping = sentences("MuJoCo: stepper on an axis", of=of, train=train, stepper=of.stepper.model, pi=pi)
        return [first, *stepping, *gears, *common.assumed(of), *elastic]
    return [
        first,
        *sentences("MuJoCo: motor on an axis", of=of, train=train, ahead=_feedforward(torque_law(of))),
        *gears,
        *sentences("MuJoCo: controller of an axis"),
        *(f"Controller: {line}." for line in common.lacking(of)),
        *sentences("MuJoCo: figures of a motor", train=train, scale=_current_scale(train)),
        *common.assumed(of),
        *elastic,
        *sentences("MuJoCo: heat of a motor", of=of, housing=_celsius(of.housing), ambient=_celsius(of.ambient)),
    ]


# The drive of a joint.


def lossless(drive: JointDrive) -> Export:
    """The drive seen as one without gear losses, the motor's torque, inertia and friction by the efficiency."""
    train, e = drive.of.train, drive.efficiency
    equal = replace(
        train, torque_constant=e * train.torque_constant, motor_inertia=e * train.motor_inertia,
        friction=e * train.friction, viscous=e * train.viscous, gear_ratio=drive.ratio, belt_ratio=1.0,
        gear_efficiency=1.0, belt_efficiency=1.0,
    )  # fmt: skip
    return replace(drive.of, train=equal)


def _added(drive: JointDrive) -> dict[str, float]:
    """Damping, dry friction and armature of a drive, at its joint or its belt."""
    if isnan(drive.armature):
        raise InputError(
            f"{drive.joint}: the rotor's inertia of {drive.of.label} is not in the catalogue; expected --format urdf, "
            "which does without"
        )
    return {"damping": drive.damping, "frictionloss": drive.friction, "armature": drive.armature}


def _effort(drive: JointDrive) -> dict[str, str]:
    """Limit of the force at a joint or a tendon, where one is known."""
    known = drive.limits.get("effort")
    return {"actuatorfrcrange": f"-{known} {known}"} if known else {}


def _joint_motor(
    actuator: Element, drive: JointDrive, named: dict[str, str], stepper: str, at_joint: JointDrive | None = None
) -> None:
    """The actuator of a drive; rotor and friction are those of the joint, which may turn otherwise than the drive."""
    of, at_joint = lossless(drive), at_joint or drive
    if drive.of.stepper:
        remark(actuator, f"{drive.joint}: a stepper, open-loop; ctrl is the {stepper}.")
        most = drive.of.limits.peak_torque.value * drive.gear_efficiency / at_joint.travel
        _stepper(actuator, named, drive.of, at_joint.travel**2 / drive.gear_efficiency, most)
        return
    left = "".join(f" Controller: {line}." for line in common.lacking(of))
    ratio, e, ahead = number(drive.ratio), brief(drive.efficiency), _feedforward(torque_law(of))
    scale = f"; act has {number(_current_scale(of.train))} times its current"  # s of its constants, k_t by e among them
    remark(actuator, f"{drive.joint}: total ratio {ratio}, e = {e}; feedforward torque {ahead}{scale}.{left}")
    of = lossless(at_joint)
    figures = _motor_figures(of, torque_law(of))
    own = {key: figure for key, figure in figures.items() if key not in ("armature", "damping")}
    SubElement(actuator, "dcmotor", named | own)


# A robot: its description with drives, held joints and trajectory.
#
# A drive is a body of its own at its place, a point mass. The drive whose belt passes other joints acts on a fixed
# tendon, the sum of their angles.


def _robot(sections: Sections, robot: RobotExport, step: float) -> None:
    """Links, each under the one that it hangs on, with drives and payload; actuators; held joints; the trajectory."""
    links, above = robot.robot.links, robot.robot.above
    outwards = [name for name in links if name not in above]
    for name in outwards:  # which grows: each behind the one that it hangs on
        outwards += [joint.child for joint in robot.robot.joints.values() if joint.parent == name]
    bodies: dict[str, Element] = {}
    for name in outwards:
        joint = above.get(name)
        parent = sections["worldbody"] if joint is None else bodies[joint.parent]
        place, turn = (np.zeros(3), robot.base) if joint is None else (joint.place, joint.turn)
        frame = {"name": free_name(name, links) if name == _WORLD else name}
        frame |= {"pos": vector(place)} if place.any() else {}
        if (turn != np.eye(3)).any():
            frame["quat"] = vector(Rotation.from_matrix(turn).as_quat(scalar_first=True))
        body = bodies[name] = SubElement(parent, "body", frame)
        moves = joint is not None and joint.moves
        if moves:
            _robot_joint(body, name, robot, step)
        _robot_link(body, name, robot, moves=moves)
    for drive in robot.drives:
        motor, target = f"{drive.joint}_motor", {"joint": drive.joint}
        if drive.coupled:
            target = {"tendon": f"{drive.joint}_belt"}
            figures = {name: number(value) for name, value in _added(drive).items()}
            belt = {"name": target["tendon"]} | figures | _effort(drive) | _hard(step)
            tendon = SubElement(sections["tendon"], "fixed", belt)
            for name, share in drive.turns_by.items():
                SubElement(tendon, "joint", joint=name, coef=number(share))
        stepped = "sum that its belt turns by" if drive.coupled else "joint's position"
        _joint_motor(sections["actuator"], drive, {"name": motor} | target, f"{stepped}, and its speed")
        for kind, name in (("jointpos", "position"), ("jointvel", "speed")):
            SubElement(sections["sensor"], kind, name=f"{drive.joint}_{name}", joint=drive.joint)
        SubElement(sections["sensor"], "actuatorfrc", name=f"{drive.joint}_torque", actuator=motor)
    stiff = {"solref": f"{number(2.0 * step)} 1", "solimp": "0.9999 0.9999 0.001 0.5 2"}
    for name, position in robot.fixed_joints.items():
        target = {"polycoef": f"{number(position - robot.robot.joints[name].reference)} 0 0 0 0"}
        SubElement(sections["equality"], "joint", {"name": f"{name}_held", "joint1": name} | target | stiff)
    motion = robot.motion
    columns = {"cycle_time": np.append(motion.time[:, 0], motion.time[-1, 1])}
    for column, name in enumerate(motion.joints):
        for what, values in (("position", motion.position), ("speed", motion.speed)):
            columns[f"{name}_{what}"] = np.append(values[:, 0, column], values[-1, 1, column])
    _rows(
        sections["custom"], columns,
        "The trajectory: time [s], positions and speeds of joints [rad, rad/s or m, m/s].",
        f"The trajectory has more than {MOST_POINTS} points and is left out.",
    )  # fmt: skip


def _robot_joint(body: Element, link: str, robot: RobotExport, step: float) -> None:
    """A joint with the figures of its drive; those of a drive that passes others are on its tendon."""
    joint = robot.robot.above[link]
    drive = robot.drive(joint.name)
    attributes = {
        "name": joint.name, "type": "hinge" if joint.turns else "slide", "axis": vector(joint.axis),
        "pos": vector(joint.anchor), "ref": number(joint.reference),
    }  # fmt: skip
    if joint.kind != "continuous" and joint.lower <= joint.upper:
        attributes["range"] = f"{number(joint.lower)} {number(joint.upper)}"
    damping, friction = robot.resistance(joint)
    if drive:
        remark(body, *drive.remarks)
    _joint(body, attributes, {"damping": damping, "frictionloss": friction, "armature": 0.0},
           None if drive and drive.coupled else drive, step)  # fmt: skip


def _joint(
    body: Element, attributes: dict[str, str], figures: dict[str, float], drive: JointDrive | None, step: float
) -> None:
    """A joint with its own resistance and inertia, and those of the drive that acts on it."""
    if drive:
        attributes |= _effort(drive)
        figures = {name: value + _added(drive)[name] for name, value in figures.items()}
    attributes |= {name: number(value) for name, value in figures.items() if value}
    SubElement(body, "joint", attributes | (_hard(step) if figures["frictionloss"] else {}))


def _robot_link(body: Element, name: str, robot: RobotExport, *, moves: bool) -> None:
    """Mass and shape of a link, capsules to the joints that it carries; point masses of drives and payload on it."""
    link = robot.robot.links[name]
    if link.lacking:
        remark(body, f"In the description it {link.lacking}.")
    if moves or link.mass:
        J, changed = _possible(link.inertia)
        if changed:
            remark(body, f"Its moments of inertia are of no body: one is above the sum of the others, by "
                         f"{brief(changed)}; half of that is added to both.")  # fmt: skip
        full = vector((J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]))
        mass = number(max(link.mass, _LEAST_MASS))
        SubElement(body, "inertial", pos=vector(link.centre), mass=mass, fullinertia=full)
    for joint in robot.robot.joints.values():
        length = float(np.linalg.norm(joint.place))
        if joint.parent == name and length > 0.0:
            ends = {"size": number(0.06 * length), "fromto": vector((0.0, 0.0, 0.0, *joint.place.tolist()))}
            SubElement(body, "geom", {"type": "capsule"} | ends | _DISPLAY_ONLY)
    for drive in robot.drives:
        if drive.place.link == name and drive.beyond:
            _point_mass(body, free_name(f"{drive.joint}_drive", robot.robot.links), drive.place.at, drive.beyond)
    if robot.payload and robot.payload.link == name:
        _point_mass(body, free_name("payload", robot.robot.links), robot.payload.at, robot.payload_mass)


def _possible(inertia: Array) -> tuple[Array, float]:
    """An inertia as MuJoCo takes it: moments above 0, none above the sum of the others; and by how much one was."""
    moments, axes = np.linalg.eigh(inertia)
    if moments[0] >= common.LEAST_INERTIA and moments[2] <= moments[0] + moments[1]:
        return inertia, 0.0
    moments = np.maximum(moments, common.LEAST_INERTIA)
    excess = float(max(moments[2] - moments[0] - moments[1], 0.0))
    moments[:2] += excess / 2.0 * (1.0 + 1e-9)
    return axes @ np.diag(moments) @ axes.T, excess


# A platform: a free base on a floor, wheels that roll on it by contact.
#
# A wheel whose rollers on the floor are at γ to its heading pulls along their axis alone, and rolls across it. It
# is, for the floor, a wheel without resistance sideways that rolls along that axis, at :math:`\dot ψ = \dot ϕ \cos
# γ`. That is how it is here: the joint turns by ψ about the horizontal across the roller's axis, its drive by K /
# cos γ of it, and
#
# .. math:: T_ψ = \frac{T}{\cos γ}, \qquad J_ψ = \frac{J}{\cos^2 γ}, \qquad b_ψ = \frac{b}{\cos^2 γ}
#
# Its contact is a capsule about the axis of that joint, which MuJoCo turns the directions of friction by: μ along
# the roller's axis, nothing across it. Without rollers (γ = 0) ψ is the wheel's own angle, and friction holds
# sideways.
#
# Rolling resistance is the joints' dry friction, C_rr N r of the load at rest, as in the sizing; of a caster it is
# the friction of a ball that slides. The floor is level and gravity is tilted, where the spec's floor slopes.


_FLOOR = "floor"
_NO_FRICTION = 1e-5  # the least that MuJoCo takes
_ASSUMED_FRICTION = 1.0  # between wheel and floor, where the spec has none
_SHORT = 1e-3  # half length of a contact over its radius: a point, with a direction
_WIDTH, _CASTER = 0.25, 0.25  # half width of a wheel, radius of a caster, over the radius of a wheel: to be seen
_SLOWEST = 0.01  # s, time constant of contacts; 4 steps at least


def _platform_remarks(of: PlatformExport) -> list[str]:
    """Remarks on wheels, inputs, gears and controllers."""
    rollers = any(wheel.roller_angle for wheel in of.platform.wheels)
    slopes, friction = bool(np.any(of.ground.slope)), f"{_ASSUMED_FRICTION:g}"
    notes = sentences("MuJoCo: platform", of=of, rollers=rollers, slopes=slopes, friction=friction)
    return [*notes, *([] if of.of.stepper else sentences("MuJoCo: motors of a platform"))]


def _platform(sections: Sections, of: PlatformExport, step: float) -> None:
    """Floor, base, wheels with their drives, casters, and the motion."""
    world, contact, r = sections["worldbody"], sections["contact"], of.radius
    SubElement(world, "geom", {"name": _FLOOR, "type": "plane", "size": "0 0 1"} | _DISPLAY_ONLY)
    base = SubElement(world, "body", name=BASE, pos=vector((0.0, 0.0, r)))
    SubElement(base, "freejoint", name="base")
    moments, centre = vector(np.diag(of.base.inertia).tolist()), of.base.centre - np.array([0.0, 0.0, r])
    SubElement(base, "inertial", pos=vector(centre), mass=number(of.base.mass), diaginertia=moments)
    if of.size:
        size = of.size
        box = {"size": vector((size.length / 2, size.width / 2, size.height / 2)), "rgba": "0.6 0.6 0.6 0.3"}
        at = vector((size.x, size.y, size.height / 2 - r))
        SubElement(base, "geom", {"type": "box", "pos": at} | box | _DISPLAY_ONLY)

    def pair(name: str, friction: Sequence[float]) -> None:
        """A contact with the floor; of a capsule the first friction is along its axis."""
        coefficients = vector((*(max(coefficient, _NO_FRICTION) for coefficient in friction), 0.0, 0.0, 0.0))
        soft = {"solref": f"{number(max(_SLOWEST, 4.0 * step))} 1", "solimp": "0.95 0.99 0.001", "condim": "3"}
        SubElement(contact, "pair", {"geom1": _FLOOR, "geom2": name, "friction": coefficients} | soft)

    for place, wheel in enumerate(of.platform.wheels):
        _wheel(base, of, place, step)
        along = _ASSUMED_FRICTION if of.friction is None else of.friction
        pair(f"{wheel_name(place)}_contact", (along if wheel.held else _NO_FRICTION, along))
    for place, drive in of.drives.items():
        motor, at_joint = f"{wheel_name(place)}_motor", _at_joint(of, place)
        assert at_joint is not None
        stepped = f"angle of its joint, and its speed: {number(at_joint.travel)} of the wheel's"
        named = {"name": motor, "joint": wheel_name(place)}
        _joint_motor(sections["actuator"], drive, named, stepped, at_joint)
        for kind, what in (("actuatorpos", "angle"), ("actuatorvel", "speed"), ("actuatorfrc", "torque")):
            SubElement(sections["sensor"], kind, name=f"{motor}_{what}", actuator=motor)
    for n, caster in enumerate(of.platform.casters, 1):
        ball = {"name": f"caster_{n}", "type": "sphere", "size": number(_CASTER * r)}
        ball["pos"] = vector((caster.x, caster.y, (_CASTER - 1.0) * r))
        SubElement(base, "geom", ball | _DISPLAY_ONLY)
        pair(f"caster_{n}", [caster.rolling_resistance] * 2)
    columns = {"cycle_time": of.time}
    columns |= {f"{wheel_name(place)}_speed": of.kinematics.E[place] @ of.eta for place in of.drives}
    _rows(
        sections["custom"], columns, "The motion: time [s], speeds of the driven wheels [rad/s].",
        f"The motion has more than {MOST_POINTS} points and is left out; drive --csv has it.",
    )  # fmt: skip


def _at_joint(of: PlatformExport, place: int) -> JointDrive | None:
    """The drive of a wheel as its joint has it, which turns by the cosine of the roller's angle as much."""
    drive = of.drives.get(place)
    return drive and replace(drive, travel=cos(of.platform.wheels[place].roller_angle))


def _wheel(base: Element, of: PlatformExport, place: int, step: float) -> None:
    """A wheel with its joint and the capsule that it rolls on; seen there, or on the base where its joint turns so."""
    name, wheel, drive = wheel_name(place), of.platform.wheels[place], _at_joint(of, place)
    body = SubElement(base, "body", name=f"{name}_link", pos=vector((wheel.x, wheel.y, 0.0)))
    remark(body, of.of_wheel(place))
    along, turned = wheel.heading + wheel.roller_angle, cos(wheel.roller_angle)
    axis = np.array([-sin(along), cos(along), 0.0])  # across the axis of its roller on the floor: forwards is positive
    armature = of.wheel.inertia[0, 0] * tan(wheel.roller_angle) ** 2
    figures = {"frictionloss": of.rolling[place] / turned, "armature": armature, "damping": 0.0}
    _joint(body, {"name": name, "type": "hinge", "axis": vector(axis)}, figures, drive, step)
    moments = vector(np.diag(of.wheel.inertia).tolist())
    SubElement(body, "inertial", pos="0 0 0", mass=number(of.wheel.mass), diaginertia=moments)
    half = _SHORT * of.radius * axis
    rolls = {"name": f"{name}_contact", "type": "capsule", "size": number(of.radius), "rgba": "0 0 0 0"}
    SubElement(body, "geom", rolls | {"fromto": vector((*-half, *half))} | _DISPLAY_ONLY)
    axle = _WIDTH * of.radius * np.array([-sin(wheel.heading), cos(wheel.heading), 0.0])
    seen, at = (base, np.array([wheel.x, wheel.y, 0.0])) if wheel.roller_angle else (body, np.zeros(3))
    ends = {"type": "cylinder", "size": number(of.radius), "fromto": vector((*(at - axle), *(at + axle)))}
    SubElement(seen, "geom", ends | _DISPLAY_ONLY)
