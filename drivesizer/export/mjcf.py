"""MJCF: the set as MuJoCo's DC motor on a shaft that carries the load, and the designed controller on its board.

MuJoCo 3.12 or later: there the motor's controller got its inputs. Inputs of the file, set at every step: angle, speed
and torque ahead of the motor; torque of the load beyond friction, inertia and weight.

What MuJoCo has not is a gear's efficiency. Driving, a loss is a load that is larger by 1/e, which is what stands here;
braking, the loss helps, and the file takes more current than the drive by up to 1/e^2.
"""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from drivesizer.export.common import Export
from drivesizer.export.gains import TorqueLaw, lacking, torque_law
from drivesizer.export.markup import brief, document, number, remark, text
from drivesizer.thermal import COPPER, DATA_TEMPERATURE

__all__ = ["LOAD", "MOTOR", "SHAFT", "render"]

SHAFT, MOTOR, LOAD = "shaft", "motor", "load_torque"
_PER_PERIOD = 4  # steps in a period of the velocity loop: MuJoCo's is of first order in its step
_HARD = "0.9999 0.9999 0.001 0.5 2"  # its dry friction is a constraint, this is as hard as it gets
_MOST_POINTS = 2000  # of the cycle in the file
_LEAST_INERTIA = 1e-12  # kg*m^2: MuJoCo takes no body without any
_ZERO_CELSIUS = 273.15


def render(of: Export) -> bytes:
    """The file of a set."""
    law = torque_law(of)
    root = Element("mujoco", model=text(of.name))
    remark(root, f"{of.label}; {of.program}. SI: m, kg, s, N, N*m, rad, A, V.", *_remarks(of, law))
    SubElement(root, "compiler", angle="radian", autolimits="true")
    option = SubElement(root, "option", timestep=number(of.period / _PER_PERIOD), integrator="Euler")
    SubElement(option, "flag", contact="disable")
    _world(root, of)
    _actuators(root, of, law)
    sensor = SubElement(root, "sensor")
    for kind, name in (("jointpos", "shaft_angle"), ("jointvel", "shaft_speed")):
        SubElement(sensor, kind, name=name, joint=SHAFT)
    SubElement(sensor, "actuatorfrc", name="motor_torque", actuator=MOTOR)
    _cycle(root, of)
    return document(root)


def _remarks(of: Export, law: TorqueLaw) -> list[str]:
    said = [
        f"One of {of.motor_sets} motor sets. The joint is the driven shaft; the load goes {brief(of.train.radius)} m "
        "per rad of it." if of.train.radius != 1.0 else f"One of {of.motor_sets} motor sets. The joint is the load's.",
        f"ctrl, at every step: [0] angle [rad] and [1] speed w [rad/s] asked of the motor, {number(of.train.ratio)} "
        f"times those of the shaft; [2] torque ahead [N*m], {_ahead(law)}; [3] torque of the load [N*m] beyond the "
        "rest.",
        'On plain voltage: input="voltage" in place of input and controller; then ctrl is [0] voltage, [1] load.',
        f"MuJoCo has no efficiency of gears, here {brief(of.train.efficiency)}: inertia, friction and weight of the "
        "load are larger by 1/e, as a drive feels them that drives. One that brakes feels them less, by e: there the "
        "current of this file is too large, by up to 1/e^2.",
        "Controller: the designed one is sampled, answers a period late, and its integral rests at a limit; this one "
        "is continuous and its integral does not rest.",
        *(f"Controller: {line}." for line in lacking(of)),
        "act: the current [A], the last; before it the winding's rise over the ambient [K], where its heat is known.",
        "A current beyond its limit is cut as torque; the winding's own current goes on.",
        *(f"Taken for granted: {line}." for line in of.said),
    ]  # fmt: skip
    if of.elastic:
        said.append("The spec's elastic shaft is left out: motor and load are one body here.")
    said.append(_heat_told(of))
    return said


def _ahead(law: TorqueLaw) -> str:
    """The law of the feedforward, in words."""
    terms = [(law.per_speed, "w"), (law.per_acceleration, "dw/dt"), (law.per_direction, "sign(w)")]
    return " + ".join(f"{number(gain)} {what}" for gain, what in terms if gain) or "0"


def _heat_told(of: Export) -> str:
    if of.heat is None:
        return "Thermal: a figure of the motor is unknown; the winding stays at 25 degC."
    return (
        "Thermal: MuJoCo has one body, warmed by copper alone. Its resistance is that of winding and housing together, "
        "its capacity that of the winding: what copper makes of it in the end is right, the way there too fast."
    )


def _world(root: Element, of: Export) -> None:
    """A body that turns with the driven shaft."""
    grown = 1.0 / of.train.efficiency
    world = SubElement(root, "worldbody")
    body = SubElement(world, "body", name="load")
    step = of.period / _PER_PERIOD
    friction = of.load_friction * grown + of.train.friction * of.train.ratio
    SubElement(body, "joint", name=SHAFT, type="hinge", axis="0 0 1", frictionloss=number(friction),
               solreffriction=f"{number(2 * step)} 1", solimpfriction=_HARD)  # fmt: skip
    inertia = number(max(of.train.load_inertia * grown, _LEAST_INERTIA))
    remark(body, "The mass does not count: the body turns about its own axis. All of the load is in its inertia.")
    SubElement(body, "inertial", pos="0 0 0", mass="1", diaginertia=" ".join([inertia] * 3))
    size = number(of.train.radius if of.train.radius != 1.0 else 0.1)
    SubElement(body, "geom", type="cylinder", size=f"{size} 0.02", mass="0", contype="0", conaffinity="0")


def _actuators(root: Element, of: Export, law: TorqueLaw) -> None:
    train = of.train
    actuator = SubElement(root, "actuator")
    figures = {
        "name": MOTOR, "joint": SHAFT, "gear": number(train.ratio), "resistance": number(train.resistance),
        "motorconst": f"{number(train.torque_constant)} {number(train.back_emf_constant)}",
        "armature": number(train.motor_inertia), "damping": number(train.viscous), "input": "pos vel ff",
        "controller": " ".join(number(x) for x in (law.kp, law.ki, law.kd, 0.0, 0.0, of.voltage)),
    }  # fmt: skip
    if of.inductance_known:
        figures["inductance"] = f"{number(train.inductance)} 0"
    if of.peak_current == of.peak_current:
        figures["saturation"] = f"0 {number(of.peak_current)} 0"
    if of.heat is not None:
        figures["thermal"] = _thermal(of)
    SubElement(actuator, "dcmotor", figures)
    remark(actuator, "What the load asks for, positive against forward motion: its weight, and ctrl[3] over time.")
    grown = 1.0 / train.efficiency
    SubElement(actuator, "general", name=LOAD, joint=SHAFT, gaintype="fixed", gainprm=number(-grown),
               biastype="affine", biasprm=f"{number(0.0 - of.weight * grown)} 0 0")  # fmt: skip


def _thermal(of: Export) -> str:
    """Resistance, capacity, time constant (of both), temperature coefficient, its reference, ambient."""
    bodies = of.heat
    assert bodies is not None
    resistance, capacity = float(bodies.R_th1 + bodies.R_th2), float(bodies.capacity_w)
    celsius = [round(T - _ZERO_CELSIUS, 9) for T in (DATA_TEMPERATURE, of.ambient)]
    return " ".join(number(x) for x in (resistance, capacity, 0.0, COPPER, *celsius))


def _cycle(root: Element, of: Export) -> None:
    """The cycle that is asked for, so that the file is all that it takes to drive it."""
    cycle, custom = of.cycle, SubElement(root, "custom")
    columns = {"cycle_time": cycle.time, "cycle_speed": cycle.speed}
    if cycle.load_time:
        columns |= {"cycle_load_time": cycle.load_time, "cycle_load_torque": cycle.load_torque}
    if max(map(len, columns.values())) > _MOST_POINTS:
        remark(custom, f"The cycle has more than {_MOST_POINTS} points and is left out; --format json has it.")
        return
    remark(custom, "One cycle, straight lines between points: time [s], speed of the shaft [rad/s], load [N*m].")
    for name, column in columns.items():
        SubElement(custom, "numeric", name=name, data=" ".join(number(x) for x in column))
