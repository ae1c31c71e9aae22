"""The method of physics with the numbers put in: from the load at its hardest moment to the current of the motor."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import isclose, isnan
from typing import Any, NamedTuple

import numpy as np

from drivesizer.machine.set_cycle import turned
from drivesizer.output.derivation import value_of, worked
from drivesizer.output.document import records as doc
from drivesizer.output.document.content import Content
from drivesizer.physics.cycle_at_gearhead import ACCELERATION, AT_REST, BRAKING, DIRECTION, DRIVING, SPEED
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.spec.robot import AS_SPECIFIED
from drivesizer.units import show

Terms = dict[str, tuple[float, str]]  # of a formula: value [SI] and its unit


class Moment(NamedTuple):
    """The load at one moment of its cycle."""

    time: float  # s
    way: float  # of the motion, forward 1, back -1, at rest 0
    speed: float  # rad/s, of the driven shaft
    acceleration: float  # rad/s^2
    torque: float  # N*m
    radius: float  # m, travel of the load per angle
    angle: float  # rad, turned since the start
    gravity: float  # m/s^2

    @property
    def sign(self) -> str:
        """Of what acts against the motion; empty at rest."""
        return "+" if self.way > 0.0 else "-" if self.way < 0.0 else ""


def _summed(parts: list[tuple[str, str]], terms: Terms) -> str:
    """A sum with its signs, without what is 0."""
    kept = [(sign, text) for sign, text in parts if sign and value_of(text, terms)]
    return "".join(f" {sign} {text}" for sign, text in kept).removeprefix(" +").strip() or "0"


# -- The force on what moves along a line, and the torque of what turns: formulas of ``loads``, each at a moment.


def _along(load: Any, at: Moment, rubs: str = "m", moved: str = "m", **more: tuple[float, str]) -> tuple[str, Terms]:
    """A load along its incline: weight, friction of what rubs, further force, inertia of all that is moved."""
    terms: Terms = {
        "m": (load.mass, "kg"), "g": (at.gravity, "m/s^2"), "beta": (load.incline, "rad"),
        "mu": (load.friction_coefficient, "1"), "F_f": (load.friction_force, "N"), "F_0": (load.force, "N"),
        "a": (at.acceleration * at.radius, "m/s^2"), **more,
    }  # fmt: skip
    parts = [("+", "m * g * sin(beta)"), (at.sign, f"mu * {rubs} * g * cos(beta)"), (at.sign, "F_f"),
             ("+", "F_0"), ("+", f"{moved} * a")]  # fmt: skip
    return _summed(parts, terms), terms


def _on_a_belt(load: Any, at: Moment) -> tuple[str, Terms]:
    """A carriage: the belt and its idlers are accelerated too, and do not rub."""
    radius = (load.idler_diameter or load.pulley_diameter) / 2.0
    belt, idlers = load.belt_mass, load.idler_inertia
    kept = ["m", *(["m_b"] if belt else []), *(["J_i / r_i**2"] if idlers else [])]
    moved = f"({' + '.join(kept)})" if len(kept) > 1 else "m"
    return _along(load, at, moved=moved, m_b=(belt, "kg"), J_i=(idlers, "kg*m^2"), r_i=(radius, "m"))


def _conveyed(load: Any, at: Moment) -> tuple[str, Terms]:
    both = "(m + m_b)" if load.belt_mass else "m"
    return _along(load, at, both, both, m_b=(load.belt_mass, "kg"))


def _hoisted(load: Any, at: Moment) -> tuple[str, Terms]:
    terms: Terms = {"m": (load.mass, "kg"), "m_c": (load.counterweight, "kg"), "g": (at.gravity, "m/s^2"),
                    "a": (at.acceleration * at.radius, "m/s^2"), "F_f": (load.friction_force, "N")}  # fmt: skip
    both = ("(m - m_c)", "(m + m_c)") if load.counterweight else ("m", "m")
    return _summed([("+", f"{both[0]} * g"), ("+", f"{both[1]} * a"), (at.sign, "F_f")], terms), terms


def _rolled(load: Any, at: Moment) -> tuple[str, Terms]:
    terms: Terms = {"C_rr": (load.rolling_resistance or 0.0, "1"), "m": (load.mass, "kg"), "g": (at.gravity, "m/s^2"),
                    "theta": (load.slope, "rad"), "a": (at.acceleration * at.radius, "m/s^2")}  # fmt: skip
    parts = [(at.sign, "C_rr * m * g * cos(theta)"), ("+", "m * g * sin(theta)"), ("+", "m * a")]
    return _summed(parts, terms), terms


_FORCES: dict[str, Callable[[Any, Moment], tuple[str, Terms]]] = {
    "belt_axis": _on_a_belt, "conveyor": _conveyed, "rack_pinion": _along, "ball_screw": _along,
    "lead_screw": _along, "hoist": _hoisted, "wheeled_vehicle": _rolled,
}  # fmt: skip
_DRAG = {"ball_screw": "preload_torque", "lead_screw": "preload_torque", "belt_axis": "friction_torque",
         "hoist": "friction_torque"}  # fmt: skip
_EFFICIENCY = {"hoist": "rope_efficiency"}


def _turned(load: Any, at: Moment) -> tuple[str, Terms]:
    """The torque of a load that turns with its shaft."""
    kind = load.kind
    terms: Terms = {"J": (load.inertia, "kg*m^2"), "alpha": (at.acceleration, "rad/s^2"),
                    "T_f": (load.friction_torque, "N*m")}  # fmt: skip
    parts = [("+", "J * alpha"), (at.sign, "T_f")]
    if kind in ("fan", "flywheel") and load.rated_speed:
        terms |= {"T_r": (load.rated_torque, "N*m"), "omega": (abs(at.speed), "rad/s"),
                  "omega_r": (load.rated_speed, "rad/s"), "n": (load.exponent, "1")}  # fmt: skip
        parts.append((at.sign, "T_r * (omega / omega_r)**n"))
    elif kind == "arm":
        inertia = load.mass * load.length**2 if load.inertia is None else load.inertia
        terms |= {"J": (inertia, "kg*m^2"), "m": (load.mass, "kg"), "g": (at.gravity, "m/s^2"),
                  "l": (load.length, "m"), "tau": (load.tilt, "rad"),
                  "phi": (round(load.start_angle + at.angle, 9), "rad")}  # fmt: skip
        parts.insert(0, ("+", "m * g * l * cos(tau) * cos(phi)" if load.tilt else "m * g * l * cos(phi)"))
    elif kind == "rotary_table":
        terms |= {"T_0": (load.torque, "N*m")}
        parts.append(("+", "T_0"))
    return _summed(parts, terms), terms


def _load_steps(load: Any, at: Moment) -> list[dict[str, Any]]:
    """The load's own formula at a moment; none where it does not give what the load cycle has there."""
    kind = load.kind
    try:
        if kind in _FORCES:
            expression, terms = _FORCES[kind](load, at)
            title = "Force on what moves, at this moment"
            first, force = worked("force", title, "F", expression, terms, "N", "force")
            found, shaft = [first], {"F": (force, "N"), "r": (at.radius, "m")}
            loss = getattr(load, _EFFICIENCY.get(kind, "efficiency"), 1.0)
            if loss is None:
                return []
            back = getattr(load, "back_efficiency", None)
            back = (2.0 - 1.0 / loss if back is None else back) if kind in ("ball_screw", "lead_screw") else loss
            drives = force * at.way
            through = "F * r" if drives == 0.0 else "F * r / eta" if drives > 0.0 else "F * r * eta"
            through = through if loss != 1.0 else "F * r"
            shaft |= {"eta": (loss if drives > 0.0 else back, "1"), "alpha": (at.acceleration, "rad/s^2")}
            wheel = kind == "wheeled_vehicle"
            motors = load.driven_wheels if wheel else load.motors
            shaft |= {"J": (load.inertia or 0.0, "kg*m^2"), "N": (motors, "1"),
                      "T_d": (getattr(load, _DRAG.get(kind, ""), 0.0), "N*m")}  # fmt: skip
            inner = _summed([("+", through), ("+", "J * alpha"), (at.sign, "T_d")], shaft)
            if wheel:
                inner = _summed([("+", "F * r / N" if motors > 1 else "F * r"), ("+", "J * alpha")], shaft)
            elif motors > 1:
                inner = f"({inner}) / N"
        elif kind in ("fan", "flywheel", "arm", "rotary_table"):
            found, (inner, shaft) = [], _turned(load, at)
            if load.motors > 1:
                inner, shaft = f"({inner}) / N", shaft | {"N": (load.motors, "1")}
        else:
            return []
    except (TypeError, ArithmeticError):  # a figure that this kind of spec does not give
        return []
    title = "Torque of one drive at the driven shaft"
    last, torque = worked("shaft_torque", title, "T", inner, shaft, "N*m", "torque")
    return [*found, last] if isclose(torque, at.torque, rel_tol=1e-6, abs_tol=1e-9) else []


# -- From the driven shaft to the motor: the moment of its largest torque, and the mean over the cycle.


@doc.section("worked", "With the numbers put in", level=2, media="paper")
def with_numbers(content: Content) -> Iterator[doc.Block]:
    """The steps at the hardest moment, then over the cycle."""
    drive, result = content.drive, content.result
    if drive is None or result.method != "physics" or drive.steps or content.wheel:
        return
    case = result.problem.cases[0]
    cycle, demand = turned(case.spec, drive, case.at_belt)
    if not bool(demand.complete[0]):
        return
    c, k_t, motor = demand.coefficients[0], drive.motor.torque_constant, drive.motor
    line = np.abs(cycle.line(c))
    row, end = (int(n) for n in np.unravel_index(int(line.argmax()), line.shape))
    at, f = _moment(cycle.load_cycle, row, end, case.spec.environment.gravity), cycle.functions[row, end]
    named = f" of load case {case.name}" if case.name not in ("", AS_SPECIFIED) else ""
    yield doc.Words(f"The moment{named} at which the motor's torque is largest, {show(at.time, 's', 'time')}, "
                "and then the whole cycle. Numbers are put in in SI units.")  # fmt: skip
    steps = _load_steps(case.spec.load, at)
    if not steps:
        yield doc.Words(f"The load cycle has {show(at.torque, 'N*m', 'torque')} at the driven shaft there.")
    belt, ratio = float(cycle.belt), float(drive.gearhead.ratio)
    belted = belt != 1.0 or drive.belt_efficiency != 1.0
    T, alpha, i = ("T_g", "alpha_g", "i_g") if belted else ("T", "alpha", "i")
    if belted:
        through = "T / (b * eta_b)" if f[DRIVING] else "T * eta_b / b" if f[BRAKING] else "T / b"
        belts: Terms = {"T": (at.torque, "N*m"), "b": (belt, "1"), "eta_b": (drive.belt_efficiency, "1")}
        steps.append(worked("gearhead_torque", "Torque behind the belt", "T_g", through, belts, "N*m", "torque")[0])
    top = float(np.abs(cycle.load_cycle.speed).max())
    spins: Terms = {"i": (belt * ratio, "1"), "omega_max": (top, "rad/s")}
    title = "Largest speed of the motor: total ratio times that of the load"
    steps.append(worked("motor_speed", title, "omega_m", "i * omega_max", spins, "rpm", "rotary_speed")[0])
    place = DRIVING if f[DRIVING] else BRAKING if f[BRAKING] else AT_REST
    lost = float(c[place]) * ratio
    terms: Terms = {T: (float(f[place]), "N*m"), i: (ratio, "1"), "eta_g": (1.0 / lost if f[DRIVING] else lost, "1"),
                    "J_m": (float(c[ACCELERATION]) / ratio, "kg*m^2"), alpha: (float(f[ACCELERATION]), "rad/s^2"),
                    "tau_f": (float(c[DIRECTION] * f[DIRECTION] + c[SPEED] * f[SPEED]), "N*m")}  # fmt: skip
    way = f"{T} / ({i} * eta_g)" if f[DRIVING] else f"{T} * eta_g / {i}" if f[BRAKING] else f"{T} / {i}"
    way, turning = (T, f"J_m * {alpha}") if ratio == lost == 1.0 else (way, f"J_m * {i} * {alpha}")
    expression = _summed([("+", way), ("+", turning), ("+", "tau_f")], terms)
    note = "J_m of rotor and gearhead at the motor, τ_f of its friction and iron"
    step, tau = worked("motor_torque", "Torque of the motor", "tau", expression, terms, "mN*m", "torque", note)
    steps.append(step)
    step, current = worked("motor_current", "Its current", "I", "tau / k_t",
                           {"tau": (tau, "N*m"), "k_t": (k_t, "N*m/A")}, "A", "current")  # fmt: skip
    steps.append(step)
    volts: Terms = {"k_e": (float(demand.back_emf[0]), "V*s/rad"), "omega": (at.speed * belt * ratio, "rad/s"),
                    "R": (motor.resistance, "ohm"), "I": (current, "A")}  # fmt: skip
    if not any(isnan(value) for value, _ in volts.values()):
        note = "At the temperature of the data sheet; the check has the winding as warm as it then is."
        steps.append(worked("motor_voltage", "Its voltage", "U", _summed([("+", "k_e * omega"), ("+", "R * I")], volts),
                            volts, "V", "voltage", note)[0])  # fmt: skip
    steps += _over_the_cycle([one for one in drive.pieces if one.case == case.name], k_t)
    yield from map(doc.Equation, steps)


_MOST_PIECES = 8  # under one root


def _over_the_cycle(pieces: list[Any], k_t: float) -> Iterator[dict[str, Any]]:
    """The RMS torque as the root of the squares of the pieces, and the RMS current."""
    parts = [one for one in pieces if one.name != "cycle" and one.rms_torque]
    if not parts or len(parts) > _MOST_PIECES:
        return
    terms: Terms = {f"tau_{n}": (one.rms_torque, "N*m") for n, one in enumerate(parts, 1)}
    terms |= {f"t_{n}": (one.duration, "s") for n, one in enumerate(parts, 1)}
    terms |= {"t": (pieces[-1].duration, "s")}
    squares = " + ".join(f"tau_{n}**2 * t_{n}" for n in range(1, len(parts) + 1))
    names = ", ".join(f"{n} {one.name}" for n, one in enumerate(parts, 1))
    step, rms = worked(
        "motor_rms_torque", "RMS torque of the motor over the cycle", "tau_rms", f"sqrt(({squares}) / t)", terms,
        "mN*m", "torque", f"RMS torque and time of each piece of the motion: {names}", bare=True,
    )  # fmt: skip
    yield step
    terms = {"tau_rms": (rms, "N*m"), "k_t": (k_t, "N*m/A")}
    yield worked("motor_rms_current", "RMS current", "I_rms", "tau_rms / k_t", terms, "A", "current")[0]


def _moment(cycle: LoadCycle, row: int, end: int, gravity: float) -> Moment:
    turned_by = float((cycle.duration[:row] * cycle.speed[:row].mean(axis=1)).sum())
    turned_by += end * float(cycle.duration[row] * cycle.speed[row].mean())
    way = float(np.sign(cycle.speed[row].mean()))
    return Moment(float(cycle.time[row, end]), way, float(cycle.speed[row, end]), float(cycle.acceleration[row, end]),
                  float(cycle.torque[row, end]), float(cycle.radius), round(turned_by, 12), gravity)  # fmt: skip
