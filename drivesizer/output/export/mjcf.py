"""MJCF: drives as MuJoCo's DC motors with their load and controllers, of one axis, a machine and a platform."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from math import cos, isnan, pi, sin, sqrt, tan
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from drivesizer.control.drive_train import DriveTrain
from drivesizer.errors import InputError
from drivesizer.joints.inverse_dynamics import Array
from drivesizer.output.export.common import (
    LEAST_INERTIA,
    Export,
    Link,
    TorqueLaw,
    Vector,
    brief,
    document,
    drive_count_text,
    far_above,
    lacking,
    link_of,
    number,
    remark,
    text,
    torque_law,
    vector,
)
from drivesizer.output.export.machine import Adding, JointDrive, MachineExport, RobotExport, free_name, head, of_drive
from drivesizer.output.export.platform import BASE, PlatformExport, of_wheel, rollers, wheel_name
from drivesizer.output.export.platform import head as platform_head
from drivesizer.physics.thermal import COPPER, DATA_TEMPERATURE
from drivesizer.spec.description_record import Joint
from drivesizer.spec.description_record import Link as RobotLink

__all__ = ["lossless", "render"]


# -- MJCF: the drive as MuJoCo's DC motor on a shaft with the load, and the designed controller.
#
# MuJoCo 3.12 or later, the first whose DC motor has controller inputs; 4.0 for a cycle of more than 500 points.
# Inputs of the file, set at every step: reference angle, reference speed and feedforward torque of the motor; torque
# of the load beyond friction, inertia and weight.
#
# MuJoCo has no gear efficiency: a load T requires T/e while it is driven, and e T while it drives the motor.
#
# - A weight W requires either, by the direction of motion, modelled as (1/e + e)/2 of it and a dry friction of (1/e
# - e)/2 of it. On a lever, where W depends on the angle, that friction is one of a plumb line (a tendon) from the
# mass to a point far above, whose arm about the axis is that of the weight. - Inertia and friction of the load, and
# ctrl[3], count with 1/e, as while driven. While they brake, the file takes more current than the drive, by up to
# 1/e^2; ``ctrl`` has an input for the correction, and the remarks its rule.
#
# Of the two thermal bodies MuJoCo has the winding, on a housing at its mean temperature in periodic steady state.
# That holds for cycles that are short compared with the housing's time constant.


SHAFT, MOTOR, DAMPING, LOAD, PLUMB = "shaft", "motor", "motor_damping", "load_torque", "plumb_line"
PER_PERIOD = 4  # steps in a period of the velocity loop: MuJoCo's is of first order in its step
_HARD = "0.9999 0.9999 0.001 0.5 2"  # its dry friction is a constraint, this is as hard as it gets
MOST_POINTS = 2000  # of the cycle in the file
_ROW_OF_3 = 500  # figures that MuJoCo 3 reads in a row
_ZERO_CELSIUS = 273.15
_SHOWN = {"mass": "0", "contype": "0", "conaffinity": "0"}  # of a shape that is for display only


def render(of: Export) -> bytes:
    """The file of a drive."""
    return document(tree(of))


def tree(of: Export) -> Element:
    """The model of a drive."""
    law = None if of.stepper else torque_law(of)
    root = Element("mujoco", model=text(of.name))
    said = _remarks(of, law) if law else _stepper_remarks(of)
    remark(root, f"{of.label}; {of.program}. SI: m, kg, s, N, N*m, rad, A, V.", *said)
    SubElement(root, "compiler", angle="radian", autolimits="true")
    option = SubElement(root, "option", timestep=number(of.period / PER_PERIOD), integrator="Euler",
                        gravity=vector((0.0, 0.0, -of.gravity)))  # fmt: skip
    SubElement(option, "flag", contact="disable")
    _world(root, of)
    actuator = SubElement(root, "actuator")
    if law:
        SubElement(actuator, "dcmotor", {"name": MOTOR, "joint": SHAFT, **motor_figures(of, law)})
    else:
        _stepper(actuator, of)
    _load(actuator, of)
    sensor = SubElement(root, "sensor")
    for kind, name in (("jointpos", "shaft_angle"), ("jointvel", "shaft_speed")):
        SubElement(sensor, kind, name=name, joint=SHAFT)
    SubElement(sensor, "actuatorfrc", name="motor_torque", actuator=MOTOR)
    _cycle(root, of)
    return root


def _remarks(of: Export, law: TorqueLaw) -> list[str]:
    said = [
        f"{drive_count_text(of)}The joint is the driven shaft; the load travels {of.travel}."
        if of.train.radius != 1.0 else f"{drive_count_text(of)}The joint is the load's.",
        "ctrl, at every step: reference [0] angle [rad] and [1] speed w [rad/s] of the motor, "
        f"{number(of.train.ratio)} times those of the shaft; [2] feedforward torque [N*m], {feedforward(law)}; "
        "[3] torque of the load [N*m] beyond inertia, friction and weight.",
        'On plain voltage: input="voltage" in place of input and controller; then ctrl is [0] voltage, [1] load.',
        *_gear_remarks(of),
        "Controller: the designed one is sampled, acts one period late, and stops its integral at a limit; this one "
        "is continuous without anti-windup.",
        *(f"Controller: {line}." for line in lacking(of)),
        "act: the current [A], the last; before it the winding's rise over the ambient [K], where its heat is known.",
        *_constants_remarks(of.train),
        "A current beyond its limit is cut as torque; the winding's own current goes on.",
        *(f"Assumed: {line}." for line in of.said),
    ]  # fmt: skip
    if of.elastic:
        said.append("The spec's elastic shaft is left out: motor and load are one body here.")
    said.append(_heat_remark(of))
    return said


def _stepper_remarks(of: Export) -> list[str]:
    """Remarks on a stepper."""
    one = of.stepper
    assert one is not None
    travel = f"the driven shaft; the load travels {of.travel}" if of.train.radius != 1.0 else "the load's"
    micro = number(one.model.microstep / of.train.ratio)
    slips = brief(pi / one.model.teeth / of.train.ratio)
    said = [
        f"{drive_count_text(of)}The joint is {travel}.",
        f"ctrl, at every step: [0] commanded angle [rad] of the shaft, in microsteps of {micro}, and [1] its speed "
        "[rad/s]; [2] torque of the load [N*m] beyond inertia, friction and weight.",
        "A stepper runs open-loop: here a position servo with the slope of its sinusoidal torque, cut at its pull-out "
        f"torque at rest, {brief(of.limits.peak_torque.value)} N*m, and the damping of its swings. At speed it has "
        f"less, and where the shaft is more than {slips} rad behind, it loses steps: neither is in this file.",
        *_gear_remarks(of),
        *(f"Assumed: {line}." for line in of.said),
    ]  # fmt: skip
    if of.elastic:
        said.append("The spec's elastic shaft is left out: motor and load are one body here.")
    return said


def _constants_remarks(train: DriveTrain) -> list[str]:
    """Remark on different torque and back-EMF constants."""
    s = current_scale(train)
    if s == 1.0:
        return []
    return [
        f"MuJoCo has one motor constant, and this motor {brief(train.torque_constant)} N*m/A and "
        f"{brief(train.back_emf_constant)} V*s/rad: current and voltage of this file are s = {number(s)} times the "
        "motor's, with its voltage limit, current limit and thermal figures. Speed and torque are the motor's own."
    ]


def _gear_remarks(of: Export) -> list[str]:
    """Remarks on the efficiency of the gears."""
    e = of.train.efficiency
    what = "torque" if of.stepper else "current"
    weight = f"{brief(of.moment)} cos({brief(of.lever.start)} + angle) + " if of.lever else ""
    return [
        f"MuJoCo has no efficiency of gears, here e = {brief(e)}: a load T requires T/e where the drive drives it and "
        "e T where it drives the motor. The weight W of the load has both, by the direction of motion, here as "
        "(1/e + e)/2 of it and a dry friction; inertia and friction of the load have 1/e. Where those two brake, the "
        f"{what} of this file is too large: by up to 1/e^2, {brief(1.0 / e**2)}, in the gears' part of it.",
        f"To correct this, add to ctrl[{_load_input(of)}] at every step e (x(T) - x(W)) - (T - W): x(T) is T/e where T "
        "and the speed have one sign, and e T where not; W is "
        f"{weight}{brief(of.constant_weight)} N*m; T is the torque of the gears at that instant, "
        f"W + {number(of.train.load_inertia)} qacc + {number(of.load_friction)} sign(qvel) + any further load, by the "
        "shaft's qacc and qvel of the step before.",
    ]


def _load_input(of: Export) -> int:
    """Place of the load's torque in ctrl."""
    return 2 if of.stepper else 3


def feedforward(law: TorqueLaw) -> str:
    """The law of the feedforward, in words."""
    terms = [(law.per_speed, "w"), (law.per_acceleration, "dw/dt"), (law.per_direction, "sign(w)")]
    return " + ".join(f"{number(gain)} {what}" for gain, what in terms if gain) or "0"


def _heat_remark(of: Export) -> str:
    if of.heat is None:
        return "Thermal: a figure of the motor is unknown; the winding stays at 25 degC."
    if isnan(of.housing):
        return "Thermal: the winding, on a housing that stays at the ambient temperature: its losses are unknown."
    return (
        "Thermal: MuJoCo has one body, the winding. It starts on, and its ambient is, a housing of "
        f"{brief(_celsius(of.housing))} degC, the mean in periodic steady state of this cycle, with losses of friction "
        f"and iron; from cold it is {brief(_celsius(of.ambient))} degC (thermal, last figure) and slowly rises."
    )


def _world(root: Element, of: Export) -> None:
    """A body that turns with the driven shaft."""
    train, (mean, half) = of.train, _gear_factors(of)
    lost = 1.0 / train.efficiency - 1.0
    world = SubElement(root, "worldbody")
    body = SubElement(world, "body", name="load")
    found = link_of(of, train.load_inertia)
    friction = of.load_friction * (1.0 + lost) + half * abs(of.constant_weight) + train.friction * train.ratio
    more = (mean - 1.0) * of.lever.mass if of.lever else 0.0  # kg, added to the weight by the gears
    rotor = train.motor_inertia * train.ratio**2 if of.stepper else 0.0  # else the motor's actuator has it
    armature = rotor + train.load_inertia * lost - (more * of.lever.length**2 if of.lever else 0.0)
    remark(body, "The body is the load's own: armature, and the mass of gears_loss, are what the gears add to it.")
    turns = {"name": SHAFT, "type": "hinge", "axis": vector(found.axis), "frictionloss": number(friction)}
    SubElement(body, "joint", turns | {"armature": number(armature)} | hard(of.period / PER_PERIOD))
    remark(body, found.said)
    about = vector([found.inertia] * 3)
    SubElement(body, "inertial", pos=vector(found.centre), mass=number(found.mass), diaginertia=about)
    if of.lever is None:
        size = number(0.1 if of.turns else train.radius)
        SubElement(body, "geom", {"type": "cylinder", "size": f"{size} 0.02"} | _SHOWN)
        return
    ends = {"size": number(0.05 * of.lever.length), "fromto": vector((0.0, 0.0, 0.0, *found.centre))}
    SubElement(body, "geom", {"type": "capsule"} | ends | _SHOWN)
    _extra(body, found, more)
    _plumb(root, {"above": (world, far_above(of)), "weight": (body, found.centre)}, half * abs(of.moment), of)


def _extra(body: Element, found: Link, mass: float) -> None:
    """Mass in the place of the load's."""
    own = SubElement(body, "body", name="gears_loss")
    about = vector([LEAST_INERTIA] * 3)
    SubElement(own, "inertial", pos=vector(found.centre), mass=number(mass), diaginertia=about)


def _plumb(root: Element, ends: dict[str, tuple[Element, Vector]], friction: float, of: Export) -> None:
    """The gears' friction under a weight on a lever: so much [N*m] where it lies level."""
    lever, unseen = of.lever, {"rgba": "0 0 0 0"}
    assert lever is not None
    force = {"name": PLUMB, "width": "1e-4", "frictionloss": number(friction / lever.length)}
    line = SubElement(SubElement(root, "tendon"), "spatial", force | unseen | hard(of.period / PER_PERIOD))
    for name, (parent, place) in ends.items():
        SubElement(parent, "site", {"name": name, "pos": vector(place), "size": "1e-3"} | unseen)
        SubElement(line, "site", site=name)


def _gear_factors(of: Export) -> tuple[float, float]:
    """Mean, and half the difference, of the factors of a load driven and driving: (1/e + e)/2 and (1/e - e)/2."""
    e = of.train.efficiency
    return (1.0 / e + e) / 2.0, (1.0 / e - e) / 2.0


def hard(step: float) -> dict[str, str]:
    """Attributes of a dry friction, as hard as MuJoCo has it."""
    return {"solreffriction": f"{number(2 * step)} 1", "solimpfriction": _HARD}


def motor_figures(of: Export, law: TorqueLaw) -> dict[str, str]:
    """Attributes of the motor with its winding and its controller."""
    train = of.train
    s = current_scale(train)
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
        figures["thermal"] = _thermal(of)
    return figures


def _stepper(actuator: Element, of: Export) -> None:
    """A stepper as a position servo as stiff as its torque about a held position, up to its pull-out torque."""
    one = of.stepper
    assert one is not None
    most = number(of.limits.peak_torque.value)
    SubElement(actuator, "position", name=MOTOR, joint=SHAFT, kp=number(one.stiffness), forcerange=f"-{most} {most}")
    SubElement(actuator, "velocity", name=DAMPING, joint=SHAFT, kv=number(one.damping))


def _load(actuator: Element, of: Export) -> None:
    """The load's torque as an input."""
    remark(
        actuator,
        "Torque of the load, positive against forward motion: weight that is the same everywhere, and "
        f"ctrl[{_load_input(of)}].",
    )
    grown = 1.0 / of.train.efficiency
    SubElement(actuator, "general", name=LOAD, joint=SHAFT, gaintype="fixed", gainprm=number(-grown),
               biastype="affine", biasprm=f"{number(0.0 - of.constant_weight * _gear_factors(of)[0])} 0 0")  # fmt: skip


def _thermal(of: Export) -> str:
    """Resistance, capacity, time constant (of both), temperature coefficient, its reference, ambient: the housing's."""
    bodies = of.heat
    assert bodies is not None
    celsius = [_celsius(T) for T in (DATA_TEMPERATURE, of.ambient if isnan(of.housing) else of.housing)]
    square = current_scale(of.train) ** 2
    return vector((float(bodies.R_th1) / square, float(bodies.capacity_w) * square, 0.0, COPPER, *celsius))


def current_scale(train: DriveTrain) -> float:
    """Current and voltage in MuJoCo over those of the motor, s = sqrt(k_t / k_e) [1].

    MuJoCo has one constant, sqrt(k_t k_e). Torque and speed are those of both: sqrt(k_t k_e) s I = k_t I,
    s V = R s I + sqrt(k_t k_e) w.
    """
    return sqrt(train.torque_constant / train.back_emf_constant)


def _celsius(kelvin: float) -> float:
    return round(kelvin - _ZERO_CELSIUS, 9)


def _cycle(root: Element, of: Export) -> None:
    """Add the required cycle, so that the file is complete."""
    cycle, custom = of.cycle, SubElement(root, "custom")
    columns = {"cycle_time": cycle.time, "cycle_speed": cycle.speed}
    if cycle.load_time:
        columns |= {"cycle_load_time": cycle.load_time, "cycle_load_torque": cycle.load_torque}
    if max(map(len, columns.values())) > MOST_POINTS:
        remark(custom, f"The cycle has more than {MOST_POINTS} points and is left out; --format json has it.")
        return
    remark(custom, "One cycle, straight lines between points: time [s], speed of the shaft [rad/s], load [N*m].")
    add_rows(custom, columns)


def add_rows(custom: Element, rows: Mapping[str, Iterable[float]]) -> None:
    """Add rows of figures under their names, with a remark where they are too long for some versions of MuJoCo."""
    held = {name: list(row) for name, row in rows.items()}
    if max(map(len, held.values())) > _ROW_OF_3:
        remark(custom, f"Rows of more than {_ROW_OF_3} figures: for MuJoCo 4.0 or later.")
    for name, row in held.items():
        SubElement(custom, "numeric", name=name, data=vector(row))


# -- The drive of a joint in MJCF: MuJoCo's DC motor, or a servo where it is a stepper.
#
# MuJoCo has no gear efficiency e, and a joint of a robot no load of its own that could be scaled; so the motor is,
# with gears that drive: its torque constant, inertia and friction by e,
#
# .. math:: k_t' = e\, k_t, \quad J' = e\, J_m, \quad b' = e\, b_m, \quad M_f' = e\, M_f
#
# Then the joint gets K e M, its current, voltage and heat are the motor's own. Where the load drives the motor, its
# torque T counts in the motor as f T and not as T/e, f = e but for worms: ``qfrc_applied`` is the place to correct
# it, by (1 - e f) T.


def lossless(drive: JointDrive) -> Export:
    """The drive seen as one without gear losses, the motor's torque, inertia and friction by the efficiency."""
    train, e = drive.of.train, drive.efficiency
    equal = replace(
        train, torque_constant=e * train.torque_constant, motor_inertia=e * train.motor_inertia,
        friction=e * train.friction, viscous=e * train.viscous, gear_ratio=drive.ratio, belt_ratio=1.0,
        gear_efficiency=1.0, belt_efficiency=1.0,
    )  # fmt: skip
    return replace(drive.of, train=equal)


def effort(drive: JointDrive) -> dict[str, str]:
    """Limit of the force at a joint or a tendon, where one is known."""
    known = drive.limits.get("effort")
    return {"actuatorfrcrange": f"-{known} {known}"} if known else {}


def armature(drive: JointDrive) -> float:
    """Inertia of a drive at its joint [kg*m^2, or kg]."""
    if isnan(drive.armature):
        raise InputError(
            f"{drive.joint}: the rotor's inertia of {drive.of.label} is not in the catalogue; expected --format urdf, "
            "which does without"
        )
    return drive.armature


def add_motor(actuator: Element, drive: JointDrive, named: dict[str, str]) -> None:
    """Add the actuator of a drive; rotor and friction are those of the joint."""
    if drive.of.stepper:
        _joint_stepper(actuator, drive, named)
        return
    of = lossless(drive)
    figures = motor_figures(of, torque_law(of))
    SubElement(actuator, "dcmotor", named | {key: one for key, one in figures.items() if key not in _OF_JOINT})


def motor_remark(drive: JointDrive) -> str:
    """Remark on a motor with a loop: ratio, efficiency, and what its feedforward is."""
    of = lossless(drive)
    left = "".join(f" Controller: {line}." for line in lacking(of))
    ratio, e, ahead = number(drive.ratio), brief(drive.efficiency), feedforward(torque_law(of))
    scale = f"; act has {number(current_scale(of.train))} times its current"  # s of its constants, k_t by e among them
    return f"{drive.joint}: total ratio {ratio}, e = {e}; feedforward torque {ahead}{scale}.{left}"


def _joint_stepper(actuator: Element, drive: JointDrive, named: dict[str, str]) -> None:
    """A position servo as stiff as the stepper's torque about a held position, as of one axis."""
    one, most = drive.of.stepper, drive.of.limits.peak_torque.value * drive.gear_efficiency / drive.travel
    assert one is not None
    square = drive.travel**2 / drive.gear_efficiency
    limits = {"kp": number(one.stiffness / square), "forcerange": f"-{number(most)} {number(most)}"}
    SubElement(actuator, "position", named | limits)
    damping = {"name": f"{named['name']}_damping", "kv": number(one.damping / square)}
    SubElement(actuator, "velocity", named | damping)


_OF_JOINT = ("armature", "damping")


# -- MJCF of a machine: the description with its drives as MuJoCo's DC motors, controllers, the trajectory.
#
# A drive is a body of its own at its place, a point mass; its gears' efficiency is that of ``joint_motor``.
#
# The drive whose belt passes other joints acts on a fixed tendon, the sum of their angles.


_LEAST_MASS = 1e-9  # kg: no simulator takes a moving body without any
_SHOWN_OF_MACHINE = {"mass": "0", "contype": "0", "conaffinity": "0"}  # of a shape that is for display only
_SECTIONS = ("worldbody", "tendon", "equality", "actuator", "sensor", "custom", "keyframe")
_ONCE = ("compiler", "option")
_WORLD = "world"  # MuJoCo's own body


def render_machine(of: MachineExport) -> bytes:
    """The file of a machine."""
    step = min(one.period for one in of.exports) / PER_PERIOD
    root = Element("mujoco", model=text(of.name))
    remark(root, *head(of), *(_machine_remarks(of.robot) if of.robot else ()))
    SubElement(root, "compiler", angle="radian", autolimits="true")
    option = SubElement(root, "option", timestep=number(step), integrator="Euler",
                        gravity=vector((0.0, 0.0, -of.gravity)))  # fmt: skip
    SubElement(option, "flag", contact="disable")
    sections = {name: SubElement(root, name) for name in _SECTIONS}
    if of.robot:
        _bodies(sections["worldbody"], of.robot, step)
        for drive in of.robot.drives:
            _joint_drive(sections, drive, step)
        _fixed_joints(sections["equality"], of.robot, step)
        _trajectory(sections["custom"], of.robot)
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
    for section in tree(one):
        if section.tag in sections:
            adding.add(name, section, sections[str(section.tag)])
        elif section.tag not in _ONCE:  # its remarks
            sections["worldbody"].append(section)


def _machine_remarks(robot: RobotExport) -> list[str]:
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


def _mass(body: Element, link: RobotLink, *, moves: bool) -> None:
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
            SubElement(body, "geom", {"type": "capsule"} | ends | _SHOWN_OF_MACHINE)


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


def _joint_drive(sections: dict[str, Element], drive: JointDrive, step: float) -> None:
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
    remark(actuator, _joint_inputs(drive))
    add_motor(actuator, drive, {"name": motor} | moved)
    sensor = sections["sensor"]
    for kind, name in (("jointpos", "position"), ("jointvel", "speed")):
        SubElement(sensor, kind, name=f"{drive.joint}_{name}", joint=drive.joint)
    SubElement(sensor, "actuatorfrc", name=f"{drive.joint}_torque", actuator=motor)


def _joint_inputs(drive: JointDrive) -> str:
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


def _trajectory(custom: Element, robot: RobotExport) -> None:
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


# -- MJCF of a platform: a free base on a floor, wheels that roll on it by contact, drives as MuJoCo's DC motors.
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
_CONTACT = {"solimp": "0.95 0.99 0.001", "condim": "3"}
_SLOWEST = 0.01  # s, time constant of contacts; 4 steps at least
_SHOWN_OF_PLATFORM = {"mass": "0", "contype": "0", "conaffinity": "0"}


def render_platform(of: PlatformExport) -> bytes:
    """The file of a platform."""
    step = of.of.period / PER_PERIOD
    root = Element("mujoco", model=text(of.name))
    remark(root, *platform_head(of), *_platform_remarks(of), *rollers(of))
    SubElement(root, "compiler", angle="radian", autolimits="true")
    SubElement(root, "option", timestep=number(step), integrator="Euler", gravity=vector(_gravity(of)),
               cone="elliptic", impratio="100", tolerance="1e-12")  # fmt: skip
    world = SubElement(root, "worldbody")
    SubElement(world, "geom", {"name": _FLOOR, "type": "plane", "size": "0 0 1", **_SHOWN_OF_PLATFORM} | {"mass": "0"})
    base = SubElement(world, "body", name=BASE, pos=vector((0.0, 0.0, of.radius)))
    _base(base, of)
    sections = {name: SubElement(root, name) for name in ("contact", "actuator", "sensor", "custom")}
    for place in range(len(of.platform.wheels)):
        _wheel(base, of, place, step)
        _rolls(sections["contact"], of, place, step)
    for place, drive in of.drives.items():
        _wheel_drive(sections, of, place, drive)
    for number_, caster in enumerate(of.platform.casters, 1):
        _caster(base, sections["contact"], of, f"caster_{number_}", (caster.x, caster.y, caster.rolling_resistance))
    _wheel_speeds(sections["custom"], of)
    return document(root)


def _platform_remarks(of: PlatformExport) -> list[str]:
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
        SubElement(body, "geom", {"type": "box", "pos": at} | box | _SHOWN_OF_PLATFORM)


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
    SubElement(body, "geom", rolls | {"fromto": vector((*-half, *half))} | _SHOWN_OF_PLATFORM)
    _seen(body if not wheel.roller_angle else base, of, place)


def _seen(body: Element, of: PlatformExport, place: int) -> None:
    """A wheel as it is seen: on its joint, or on the base where that turns about another axis."""
    wheel = of.platform.wheels[place]
    axle = _WIDTH * of.radius * np.array([-sin(wheel.heading), cos(wheel.heading), 0.0])
    at = np.array([wheel.x, wheel.y, 0.0]) if wheel.roller_angle else np.zeros(3)
    ends = {"type": "cylinder", "size": number(of.radius), "fromto": vector((*(at - axle), *(at + axle)))}
    SubElement(body, "geom", ends | _SHOWN_OF_PLATFORM)


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
    SubElement(base, "geom", ball | {"pos": vector((x, y, (_CASTER - 1.0) * of.radius))} | _SHOWN_OF_PLATFORM)
    _pair(contact, name, (resistance, resistance), of.of.period / PER_PERIOD)


# --- drives and motion


def _wheel_drive(sections: dict[str, Element], of: PlatformExport, place: int, drive: JointDrive) -> None:
    """Motor and sensors of a wheel."""
    name, motor, at_joint = wheel_name(place), f"{wheel_name(place)}_motor", _drive_at_joint(of, place)
    assert at_joint is not None
    remark(sections["actuator"], _wheel_inputs(drive, at_joint))
    add_motor(sections["actuator"], at_joint, {"name": motor, "joint": name})
    for kind, what in (("actuatorpos", "angle"), ("actuatorvel", "speed"), ("actuatorfrc", "torque")):
        SubElement(sections["sensor"], kind, name=f"{motor}_{what}", actuator=motor)


def _wheel_inputs(drive: JointDrive, at_joint: JointDrive) -> str:
    """Remark on the inputs of a drive."""
    if drive.of.stepper:
        return (
            f"{drive.joint}: a stepper, open-loop; ctrl is the angle of its joint, and its speed: "
            f"{number(at_joint.travel)} of the wheel's."
        )
    return motor_remark(drive)


def _wheel_speeds(custom: Element, of: PlatformExport) -> None:
    """The motion: speeds of wheels over time, straight lines between points."""
    if len(of.time) > MOST_POINTS:
        remark(custom, f"The motion has more than {MOST_POINTS} points and is left out; drive --csv has it.")
        return
    remark(custom, "The motion: time [s], speeds of the driven wheels [rad/s].")
    columns = {"cycle_time": of.time}
    columns |= {f"{wheel_name(place)}_speed": of.kinematics.E[place] @ of.eta for place in of.drives}
    add_rows(custom, columns)
