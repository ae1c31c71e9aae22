"""Figures of a drive that every format needs, its limits, its loops as one torque law, its link; XML as a tree."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, fields, replace
from functools import partial
from math import cos, inf, isfinite, isnan, nan, sin, sqrt
from typing import NamedTuple
from xml.etree.ElementTree import Comment, Element, SubElement, indent, tostring

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import DIRECT
from drivesizer.control.drive_train import DriveTrain, Mechanics, drive_train, within_reach
from drivesizer.control.loop_design import designed
from drivesizer.control.open_loop import Stepper, prepared
from drivesizer.control.validation import Cascade, Gains
from drivesizer.errors import InputError, quoted
from drivesizer.files.text import sentences as remarks_on
from drivesizer.load_cases import load_springs
from drivesizer.load_cases.of_machine import load_cases
from drivesizer.load_cases.platform import WheelLoad, at_shaft, motion_of, remaining_torque
from drivesizer.loads.springs import Lever
from drivesizer.machine.part_curves import torque_of_drive
from drivesizer.machine.set_cycle import set_cycle
from drivesizer.output.words import whole_name
from drivesizer.physics.at_voltage import Winding, operating_point
from drivesizer.physics.thermal import TwoBodies, two_bodies
from drivesizer.physics.winding import housing_loss
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.problem import for_drive
from drivesizer.results.ratings import continuous_currents, controller_current
from drivesizer.spec.robot import RobotSpec
from drivesizer.version import __version__

PROGRAM = f"drivesizer {__version__}"
LEAST_INERTIA = 1e-12  # kg*m^2: no simulator takes a moving link without any
Vector = tuple[float, float, float]
_FAR = 1e3  # lengths of the lever
_NO_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")  # XML 1.0, production 2


# XML of the formats: a tree with remarks, figures to twelve digits, escaped names.


def number(value: float) -> str:
    """A figure to twelve digits, more than any data sheet has.

    >>> number(0.1 + 0.2), number(3.0)
    ('0.3', '3')
    """
    return f"{value:.12g}"


def vector(values: Iterable[float]) -> str:
    """Figures in a row."""
    return " ".join(number(value + 0.0) for value in values)  # + 0.0: no -0


def brief(value: float) -> str:
    """A figure in a sentence."""
    return f"{value:.5g}"


def text(string: str) -> str:
    r"""A text with characters that XML forbids as their codes.

    >>> text("a\x00b")
    'a\\x00b'
    """
    return _NO_XML.sub(lambda match: repr(match[0])[1:-1], string)


def identifier(label: str) -> str:
    """A text as a name that simulators accept: letters, digits and underscores.

    >>> identifier("SPS surveillance robot")
    'SPS_surveillance_robot'
    """
    name = re.sub(r"[^A-Za-z0-9]+", "_", label).strip("_")
    return (f"_{name}" if name[:1].isdigit() else name) or "drive"


def remark(parent: Element, *lines: str) -> None:
    """A comment under an element; two hyphens end a comment in XML and get a blank between them."""
    for line in lines:
        safe = re.sub("-(?=-)", "- ", text(line).replace("\n", " "))
        parent.append(Comment(f" {safe} "))


def texts(parent: Element, /, **of: str) -> None:
    """Elements that have a text each."""
    for tag, content in of.items():
        SubElement(parent, tag).text = content


def document(root: Element) -> bytes:
    """The file: declaration, tree with two blanks a level, UTF-8."""
    indent(root)
    return f'<?xml version="1.0" encoding="utf-8"?>\n{tostring(root, encoding="unicode")}\n'.encode()


def refuse_doubles(root: Element, tags: Collection[str], axis: str) -> None:
    """Refuse an axis that was added to a document with names that were there."""
    seen = set[tuple[str, str]]()
    for element in root.iter():
        key = str(element.tag), element.attrib.get("name", "")
        if key[0] in tags and key[1] and key in seen:
            raise InputError(f"axis {quoted(axis)}: a {key[0]} {quoted(key[1])} is there already; rename the axis")
        seen.add(key)


# Limits of a drive at its driven shaft: peak and continuous torque and speed, with the limiting part.
#
# .. math:: T = K e\, k_t I \;\text{(motor, controller)}, \qquad T = i_b e_b\, T_g \;\text{(gearhead)}, \qquad w =
# w_m / K
#
# A torque is that of the motor's magnets behind gears that drive, without friction, since every simulator subtracts
# the friction of a joint by itself. K total ratio, e efficiency of gearhead and belt, b of the belt alone.


class Limit(NamedTuple):
    """The least of several limits."""

    value: float  # SI; NaN where none is known
    by: str  # the limiting part and figure
    unknown: tuple[str, ...]  # limits that are not in the catalogue


class Limits(NamedTuple):
    """Limits of one drive at its driven shaft."""

    peak_torque: Limit  # N*m
    continuous_torque: Limit  # N*m
    peak_speed: Limit  # rad/s
    continuous_speed: Limit  # rad/s


class OpenLoopStepper(NamedTuple):
    """A stepper with its driver, as the simulation of ``validate`` has it."""

    model: Stepper
    speed: NDArray[np.float64]  # rad/s at the motor, of the points of its torque

    @property
    def stiffness(self) -> float:
        """Torque per angle about a held position, at the driven shaft with gears that drive [N*m/rad]."""
        motor = self.model
        return float(motor.teeth * motor.torque[0] * motor.ratio**2 * motor.efficiency)

    @property
    def damping(self) -> float:
        """Torque per speed of small swings about the field, at the driven shaft [N*m*s/rad]."""
        motor = self.model
        at_motor = 2.0 * motor.damping_ratio * float(np.sqrt(motor.teeth * motor.torque[0] * motor.inertia))
        return at_motor * motor.ratio**2 * motor.efficiency


def speed_at(train: DriveTrain, voltage: float, torque: float) -> float:
    """Steady speed of the motor at a voltage, winding at 25 degC, under a torque, friction included [rad/s]."""
    motor = train
    winding = Winding(
        motor.resistance, motor.inductance, motor.torque_constant, motor.back_emf_constant, motor.commutation
    )
    return float(operating_point(winding, voltage, torque, train.viscous)[0])


def _least(named: Mapping[str, float]) -> Limit:
    """The least of some limits, by name; NaN where none is known."""
    known = {name: value for name, value in named.items() if value == value and value < inf}
    by = min(known, key=lambda name: known[name], default="")
    return Limit(known.get(by, nan), by, tuple(name for name, value in named.items() if value != value))


def _limits(
    spec: RobotSpec, drive: DriveSet, train: DriveTrain, voltage: float, stepper: OpenLoopStepper | None
) -> Limits:
    """Peak and continuous torque and speed; of a stepper its pull-out torque at rest, and the speeds looked up."""
    motor, gearhead, controller = drive.motor, drive.gearhead, drive.controller
    short, lasting = dict[str, float](), dict[str, float]()
    if gearhead.part != DIRECT:
        behind = train.belt_ratio * train.belt_efficiency
        short = {"gearhead, intermittent torque": gearhead.intermittent_torque * behind}
        lasting = {"gearhead, continuous torque": gearhead.continuous_torque * behind}
    if stepper:
        pull_out = float(stepper.model.torque[0] * train.ratio * train.efficiency)
        at_rest = {"stepper, pull-out torque at rest": pull_out}
        fastest = _least({"stepper, highest speed of the motion": stepper.model.top_speed / train.ratio})
        return Limits(_least(at_rest | short), _least(at_rest | lasting), fastest, fastest)
    peak = {
        "motor at stall": voltage / train.resistance,
        "controller, peak current": controller.peak_current if controller else nan,
    }
    if isfinite(motor.peak_torque):  # most makers limit none
        peak["motor, peak torque"] = motor.peak_torque / train.torque_constant
    names = "motor, nominal current", "controller, continuous current"
    continuous = dict(zip(names, continuous_currents(motor, controller, spec.environment), strict=True))
    speeds = {
        "motor at no load": speed_at(train, voltage, train.friction),  # the gears' idle friction among it
        "motor, permissible speed": motor.max_speed,
        "gearhead, intermittent input speed": gearhead.intermittent_input_speed,
        "encoder, permissible speed": drive.encoder.max_speed if drive.encoder else nan,
    }
    if drive.brake and not isnan(drive.brake.max_speed):
        turns = drive.total_ratio if drive.brake.shaft == "load" else 1.0
        speeds["brake, permissible speed"] = drive.brake.max_speed * turns
    if motor.kind == "brushless":
        speeds["controller, electrical speed"] = controller.max_speed_sine / motor.pole_pairs if controller else nan
    slower = speeds | {"gearhead, continuous input speed": gearhead.continuous_input_speed}
    per_ampere = train.torque_constant * train.ratio * train.efficiency
    return Limits(
        _least({name: current * per_ampere for name, current in peak.items()} | short),
        _least({name: current * per_ampere for name, current in continuous.items()} | lasting),
        _least({name: speed / train.ratio for name, speed in speeds.items()}),
        _least({name: speed / train.ratio for name, speed in slower.items()}),
    )


# The figures of a drive that every format needs, as one record.
#
# It holds one drive and its share of the load, seen from the driven shaft: a joint that turns by its angle.
# Convention: as in ``plant``; a torque of the load is positive when it resists forward motion.
#
# A gear's efficiency is in no format. Seen at the driven shaft with gears that drive, a motor torque M is K e M, and
#
# .. math:: K e M = (J_l + K^2 e J_m)\, \dot w + (T_f + K e M_f)\, \mathrm{sgn}\, w + K^2 e b_m w + T_0
#
# J_l, T_f, T_0 inertia, friction and weight of the load; J_m, M_f, b_m inertia, dry and viscous friction of the
# motor.


@dataclass(frozen=True, slots=True, kw_only=True)
class Cycle:
    """Motion and load of the driven shaft over one cycle, piecewise linear."""

    time: tuple[float, ...]  # s
    speed: tuple[float, ...]  # rad/s
    load_time: tuple[float, ...]  # s
    load_torque: tuple[float, ...]  # N*m, of the load beyond inertia, friction and a weight on its lever


@dataclass(frozen=True, slots=True, kw_only=True)
class Export:
    """One drive, its controller and its share of the load; SI, NaN unknown."""

    name: str  # of the machine
    label: str  # of the drive
    program: str = PROGRAM
    parts: dict[str, str]  # by role: maker, family and part
    motor_sets: int  # of the machine
    train: DriveTrain
    inductance_known: bool
    controller: Gains | Cascade | None  # None: it cannot be designed, for the rotor's inertia is unknown
    voltage: float  # V, available to the motor at the lowest supply voltage
    voltage_known: bool  # else it is the lowest supply voltage
    peak_current: float  # A, of the controller
    continuous_current: float
    limits: Limits
    heat: TwoBodies | None  # None: a figure is unknown
    housing: float  # K, mean in periodic steady state; NaN unknown
    rotor_loss: tuple[float, float]  # N*m and N*m*s/rad, losses that heat the housing; 0 where unknown
    ambient: float  # K
    elastic: bool  # the spec has two masses
    turns: bool  # the load turns about an axis; else it moves along a line
    lever: Lever | None  # this drive's share of a load that gravity turns
    gravity: float  # m/s^2
    cycle: Cycle
    assumptions: tuple[str, ...]
    stepper: OpenLoopStepper | None = None  # in the place of the controller and the electrical figures of ``train``

    @property
    def travel(self) -> str:
        """Travel of the load per angle of the driven shaft, as a text."""
        return f"{self.train.radius:.5g} {'rad' if self.turns else 'm'} per rad of it"

    @property
    def load_friction(self) -> float:
        """Dry friction of the load [N*m]: half the difference of forward and backward."""
        return (self.train.forward_torque - self.train.backward_torque) / 2

    @property
    def friction(self) -> float:
        """Dry friction seen at the driven shaft, gears driving [N*m]."""
        return self.load_friction + self.train.friction * self.train.ratio * self.train.efficiency

    @property
    def weight(self) -> float:
        """Torque of the load without friction, at the start of the motion [N*m]."""
        return (self.train.forward_torque + self.train.backward_torque) / 2

    @property
    def moment(self) -> float:
        """Torque of the weight on its lever, lying level [N*m]; 0 without a lever."""
        return float(self.lever.moment(self.gravity)) if self.lever else 0.0

    @property
    def constant_weight(self) -> float:
        """Torque of the load without friction and lever: the same at every angle [N*m]."""
        return self.weight - (self.moment * cos(self.lever.start) if self.lever else 0.0)

    @property
    def damping(self) -> float:
        """Viscous friction seen at the driven shaft, gears driving [N*m*s/rad]."""
        return self.train.viscous * self.train.ratio**2 * self.train.efficiency

    @property
    def reflected_inertia(self) -> float:
        """Inertia of rotor, encoder and gearhead input seen at the driven shaft, gears driving [kg*m^2]."""
        return self.train.motor_inertia * self.train.ratio**2 * self.train.efficiency

    @property
    def inertia(self) -> float:
        """All inertia seen at the driven shaft, gears driving [kg*m^2]."""
        return self.train.load_inertia + self.reflected_inertia

    @property
    def period(self) -> float:
        """Period of the velocity loop; of a stepper the 16th part of a swing [s]."""
        if self.stepper:
            return 1.0 / (16.0 * self.stepper.model.natural_frequency)
        c = self.designed
        return c.period if isinstance(c, Gains) else c.velocity_period

    @property
    def designed(self) -> Gains | Cascade:
        """The controller."""
        if self.controller is None:
            raise InputError(
                f"{self.label}: the rotor's inertia is not in the catalogue, and a controller is designed for it; "
                "expected --format urdf, sdf or json, which do without"
            )
        return self.controller


def export_of(spec: RobotSpec, drive: DriveSet, wheel: int | None = None) -> Export:
    """The record of a drive that a sizing found; of a platform that of its first wheel, or of one by its number."""
    whole = for_drive(spec, drive.chosen_screw)
    cases = load_cases(whole)
    _, case, spec = cases[0]
    if wheel is not None:
        place = check_wheel(whole, wheel)
        in_order = [entry for entry in cases if not entry[0]]
        _, case, spec = next(
            entry for entry in in_order if not isinstance(entry[2].load, WheelLoad) or place in entry[2].load.numbers
        )
    stepper, controller = None, None
    if drive.steps:
        stepper, train, assumptions = _stepper_of(spec, drive)
    elif drive.motor.rotor_inertia > 0.0:
        train, controller, assumptions = designed(spec, drive)
    else:
        train, assumptions = drive_train(spec, replace(drive, motor=replace(drive.motor, rotor_inertia=1.0)), 1e-3)
        train = replace(train, motor_inertia=nan)
        assumptions = [*assumptions, "the rotor's inertia is unknown and left out; no controller is designed"]
    own, bodies, lever, ambient = drive.controller, two_bodies(drive.motor), spec.load.lever, spec.environment.ambient
    if spec.gear is not None or load_springs(spec) or lever is None or lever.moment(spec.environment.gravity) == 0.0:
        lever = None  # behind a gear of fixed ratio the shaft turns more often; springs are no weight
    else:
        lever = Lever(*map(float, lever._replace(mass=lever.mass / spec.load.motors)))
    feed = spec.feed_of(own)
    coulomb, viscous = (float(x[0]) for x in housing_loss(drive.motor, np.ones(1)))
    motion = motion_of(spec)
    within_reach(train, motion)
    left = np.empty((0, 2)) if lever else remaining_torque(spec, motion, at_shaft(spec))
    return Export(
        name=spec.name,
        label=drive.label,
        parts={role: whole_name(part) for role, part in drive.parts.items() if part},
        motor_sets=spec.load.motors,
        train=train,
        inductance_known=drive.motor.inductance > 0.0,
        controller=controller,
        voltage=feed.applied,
        voltage_known=not isnan(feed.usable),
        peak_current=own.peak_current if own else nan,
        continuous_current=float(controller_current(own, ambient)) if own else nan,
        limits=_limits(spec, drive, train, feed.applied, stepper),
        heat=bodies if bodies.known else None,
        housing=_housing(spec, drive, bodies),
        rotor_loss=(coulomb if isfinite(coulomb) else 0.0, viscous if isfinite(viscous) else 0.0),
        ambient=ambient,
        elastic=spec.plant.model != "rigid",
        turns=spec.load.shaft_axis == "rotary",
        lever=lever,
        gravity=spec.environment.gravity,
        cycle=Cycle(
            time=motion.time,
            speed=tuple((np.array(motion.speed) / train.radius).tolist()),
            load_time=tuple(left[:, 0].tolist()),
            load_torque=tuple(left[:, 1].tolist()),  # none of a lever, whose weight depends on its angle
        ),
        assumptions=(*assumptions, *whose(case, spec), *behind_gear(spec)),
        stepper=stepper,
    )


def check_wheel(spec: RobotSpec, wheel: int) -> int:
    """Place of a platform's wheel among its driven ones, from 0."""
    section = spec.platform
    if section is None:
        raise InputError("--wheel: the spec has no section platform; leave it out")
    driven = [n for n, place in enumerate(section.places, 1) if place.driven and n not in section.failed]
    if wheel not in driven:
        raise InputError(f"--wheel: {wheel} is no driven wheel; expected one of {', '.join(map(str, driven))}")
    return driven.index(wheel)


def whose(case: str, spec: RobotSpec) -> list[str]:
    """The wheel whose motion and load these are, where wheels have their own."""
    wheel = isinstance(spec.load, WheelLoad)
    return [f"motion and load are those of {case}; the other wheels have their own"] if wheel else []


def behind_gear(spec: RobotSpec) -> list[str]:
    """The place of the driven shaft where a gear of fixed ratio belongs to the load."""
    if spec.gear is None:
        return []
    return [f"the driven shaft is the input shaft of the {spec.gear.kind}; weight is a torque over time of the motion"]


def _stepper_of(spec: RobotSpec, drive: DriveSet) -> tuple[OpenLoopStepper, DriveTrain, list[str]]:
    """The stepper of a drive, its drive train without electrical figures, and assumptions."""
    lowest = spec.supply.lowest
    motor, assumptions = prepared(spec, drive, motion_of(spec), lambda speed: torque_of_drive(drive, speed, lowest))
    gears = {f.name: getattr(motor, f.name) for f in fields(Mechanics)}
    train = DriveTrain(resistance=nan, inductance=nan, torque_constant=nan, back_emf_constant=nan, **gears)
    return OpenLoopStepper(motor, np.linspace(0.0, motor.top_speed, len(motor.torque))), train, assumptions


def _housing(spec: RobotSpec, drive: DriveSet, bodies: TwoBodies) -> float:
    """Mean temperature of the housing in periodic steady state [K]; NaN where unknown or with thermal runaway."""
    cycle = set_cycle(spec, drive) if bodies.known else None
    if cycle is None or not cycle.known:
        return nan
    mean = float(bodies.housing(spec.environment.ambient, cycle.winding, cycle.heat.mean[0]))
    return mean if isfinite(cycle.figures.winding[0]) else nan


# The designed loops as one torque law on angle and speed of the motor: what simulators and ROS have a place for.
#
# .. math:: \tau = k_p (\theta_r - \theta) + k_i \int (\theta_r - \theta)\,dt + k_d (w_r - w) + \tau_f
#
# A PI on the speed is a PD on the angle whose reference is the integral of the speed's. Of the cascade, with speed
# loop :math:`i = p\,(w_r + k_v \epsilon - w) + q \int (w_r + k_v \epsilon - w)`, :math:`\epsilon = \theta_r -
# \theta`, and its current taken to be there at once,
#
# .. math:: k_d = k_t p, \quad k_p = k_t (p\,k_v + q), \quad k_i = k_t q k_v, \quad
#           \tau_f = k_t (f_w w_r + f_a \dot w_r + f_c\,\mathrm{sgn}\,w_r)
#
# Of the voltage PI :math:`u = P (w_r - w) + Q \int (w_r - w)` behind a drive that compensates the back-EMF, so that
# its voltage is :math:`R \tau / k_t + k_e w`,
#
# .. math:: k_d = \frac{k_t}{R} (P + k_e), \quad k_p = \frac{k_t}{R} Q, \quad \tau_f = -\frac{k_t k_e}{R} w_r


class TorqueLaw(NamedTuple):
    """A torque at the motor shaft [N*m] by angle and speed of it; SI."""

    kp: float  # N*m/rad
    ki: float  # N*m/(rad*s)
    kd: float  # N*m*s/rad
    per_speed: float = 0.0  # N*m*s/rad, of the reference
    per_acceleration: float = 0.0  # kg*m^2
    per_direction: float = 0.0  # N*m


def torque_law(of: Export) -> TorqueLaw:
    """The controller of a drive as one law."""
    c, k, R = of.designed, of.train.torque_constant, of.train.resistance
    if isinstance(c, Cascade):
        p, q, v = c.velocity_kp, c.velocity_ki, c.position_kp
        return TorqueLaw(
            kp=k * (p * v + q), ki=k * q * v, kd=k * p, per_speed=k * c.feedforward_velocity,
            per_acceleration=k * c.feedforward_acceleration, per_direction=k * c.feedforward_friction,
        )  # fmt: skip
    k_e = of.train.back_emf_constant
    return TorqueLaw(kp=k / R * c.ki, ki=0.0, kd=k / R * (c.kp + k_e), per_speed=-k * k_e / R)


def lacking(of: Export) -> list[str]:
    """Parts of the designed controller that the law has no place for, as sentences; sampling is left to the format."""
    c = of.designed
    kd = c.kd if isinstance(c, Gains) else c.velocity_kd
    notes = ["the derivative of the speed is left out"] if kd else []
    if isinstance(c, Cascade):
        notes.append("the current loop is left out: the winding alone makes the current late, by L/R")
    return notes


# The link that a drive moves: axis, mass and centre of mass, in a world whose z points up.
#
# A load that gravity turns is a mass on its lever, so that the simulator's own gravity makes the torque
#
# .. math:: M \cos(\varphi_0 + \varphi), \qquad M = m g l s
#
# s is the share of the weight that acts across the tilted axis. The lever's level line lies along x; the axis is
# level but for its tilt, and turning forward raises the lever. Every other load turns about z, and its mass does not
# count.


class Link(NamedTuple):
    """One moving body."""

    axis: Vector  # unit vector; forward by the right-hand rule
    centre: Vector  # m, of mass, from the axis
    mass: float  # kg
    inertia: float  # kg*m^2 about its centre of mass, in every direction
    remark: str  # remark


def link_of(of: Export, *, reflected: bool) -> Link:
    """The link of a drive, with what turns with the motor as far as it is known, or the load alone."""
    lever, inertia = of.lever, of.train.load_inertia
    if reflected and not isnan(of.inertia):
        inertia = of.inertia
    if lever is None:
        note = "The mass does not count: the link turns about its own axis. All of the load is in its inertia."
        return Link((0.0, 0.0, 1.0), (0.0, 0.0, 0.0), 1.0, max(inertia, LEAST_INERTIA), note)
    rest = sqrt(max(1.0 - lever.share * lever.share, 0.0))
    along, high = lever.length * cos(lever.start), lever.length * sin(lever.start)
    note = "One drive's share of the mass, at its position at the start of the cycle: gravity makes its torque."
    about = max(inertia - lever.mass * lever.length**2, LEAST_INERTIA)
    return Link((0.0, -lever.share, rest), (along, high * rest, high * lever.share), lever.mass, about, note)


def far_above(lever: Lever) -> Vector:
    """A point so far up, across the axis, that every line from it to the lever is plumb to 1e-3 [m]."""
    rest = sqrt(max(1.0 - lever.share * lever.share, 0.0))
    return (0.0, _FAR * lever.length * rest, _FAR * lever.length * lever.share)


def remarks(of: Export) -> list[str]:
    """Remarks on a joint with its limits, as sentences."""
    train, stepper = of.train, of.stepper
    there = float(stepper.model.torque[-1]) * train.ratio * train.efficiency if stepper else nan  # at its highest speed
    left_out = sentences("left out of a joint", of=of)
    return [*sentences("joint", of=of, train=train, limits=of.limits, there=there), *assumed(of), *left_out]


def assumed(of: Export) -> list[str]:
    """The assumptions of a drive as remarks."""
    return [f"Assumed: {line}." for line in of.assumptions]


# Remarks: their texts are in remarks.txt, where figures and names are put in.


def _limit_text(limit: Limit, unit: str) -> str:
    unknown = f"; unknown: {', '.join(limit.unknown)}" if limit.unknown else ""
    return f"{brief(limit.value)} {unit} ({limit.by}{unknown})" if limit.by else "unknown"


sentences = partial(remarks_on, __package__, filters=(("brief", brief), ("number", number), ("shown", _limit_text)))
