"""MJCF: the drive as MuJoCo's DC motor on a shaft with the load, and the designed controller.

MuJoCo 3.12 or later, the first whose DC motor has controller inputs; 4.0 for a cycle of more than 500 points. Inputs
of the file, set at every step: reference angle, reference speed and feedforward torque of the motor; torque of the load
beyond friction, inertia and weight.

MuJoCo has no gear efficiency: a load T requires T/e while it is driven, and e T while it drives the motor.

- A weight W requires either, by the direction of motion, modelled as (1/e + e)/2 of it and a dry friction of
  (1/e - e)/2 of it. On a lever, where W depends on the angle, that friction is one of a plumb line (a tendon)
  from the mass to a point far above, whose arm about the axis is that of the weight.
- Inertia and friction of the load, and ctrl[3], count with 1/e, as while driven. While they brake, the file takes more
  current than the drive, by up to 1/e^2; ``ctrl`` has an input for the correction, and the remarks its rule.

Of the two thermal bodies MuJoCo has the winding, on a housing at its mean temperature in periodic steady state. That
holds for cycles that are short compared with the housing's time constant.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import isnan, pi, sqrt
from xml.etree.ElementTree import Element, SubElement

from drivesizer.control.drive_train import DriveTrain
from drivesizer.output.export.common import Export
from drivesizer.output.export.gains import TorqueLaw, lacking, torque_law
from drivesizer.output.export.joint import LEAST_INERTIA, Link, Vector, drive_count_text, far_above, link_of
from drivesizer.output.export.markup import brief, document, number, remark, text, vector
from drivesizer.physics.thermal import COPPER, DATA_TEMPERATURE

__all__ = [
    "DAMPING", "LOAD", "MOST_POINTS", "MOTOR", "PER_PERIOD", "PLUMB", "SHAFT", "add_rows", "current_scale",
    "feedforward", "hard", "motor_figures", "render", "tree",
]  # fmt: skip

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
