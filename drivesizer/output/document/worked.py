"""The method of physics with the numbers put in: from the load at its hardest moment to the current of the motor."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from math import isclose, isnan
from typing import Any, NamedTuple

import numpy as np

from drivesizer.files.text import listed
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


def _summed(parts: Iterable[str], terms: Terms, at: Moment | None = None) -> str:
    """A sum of parts, without what is 0 or not given; ± is against the motion, and nothing at rest."""
    sign, summands = at.sign if at else "", []
    for part in parts:
        of, text = part[0].replace("±", sign), part[2:]
        names = set(re.findall(r"[A-Za-z]\w*", text)) - {"sin", "cos"}
        if of and names <= terms.keys() and value_of(text, terms):
            summands.append(f"{of} {text}")
    return " ".join(summands).removeprefix("+ ") or "0"


# -- The force on what moves along a line, and the torque of what turns: formulas of ``loads``, each at a moment.


_FORCES, _TORQUES, _SYMBOLS, _DRAG = (
    {name: cells for head, (name, *cells) in listed(__package__, "worked.txt") if head == kind}
    for kind in ("force", "torque", "symbol", "drag")
)


def _terms_of(load: Any, at: Moment) -> Terms:
    """The figures of a load, as far as it has them, and those of a moment."""
    terms: Terms = {
        "g": (at.gravity, "m/s^2"), "a": (at.acceleration * at.radius, "m/s^2"), "alpha": (at.acceleration, "rad/s^2"),
        "omega": (abs(at.speed), "rad/s"), "r": (at.radius, "m"),
    }  # fmt: skip
    known = {symbol: getattr(load, field, None) for symbol, (field, _) in _SYMBOLS.items()}
    if load.kind == "belt_axis":
        terms["r_i"] = (load.idler_diameter or load.pulley_diameter) / 2.0, "m"
    if load.kind == "arm":
        known["J"] = load.mass * load.length**2 if load.inertia is None else load.inertia
        terms["phi"] = round(load.start_angle + at.angle, 9), "rad"
    return terms | {symbol: (value, _SYMBOLS[symbol][1]) for symbol, value in known.items()
                    if value is not None and (value or symbol != "omega_r")}  # fmt: skip


def _plain(parts: Sequence[str], terms: Terms) -> list[str]:
    """Parts of a formula without masses, idlers and a tilt that are 0."""
    formula = "|".join(parts)
    for symbol, texts in {"m_b": [" + m_b"], "m_c": [" - m_c", " + m_c"], "J_i": [" + J_i / r_i**2"],
                          "tau": [" * cos(tau)"]}.items():  # fmt: skip
        for text in texts if not terms.get(symbol, (0.0, ""))[0] else ():
            formula = formula.replace(text, "")
    return formula.replace("(m)", "m").split("|")


def _load_steps(load: Any, at: Moment) -> list[dict[str, Any]]:
    """The load's own formula at a moment; none where it does not give what the load cycle has there."""
    kind, steps, wheel = load.kind, list[dict[str, Any]](), load.kind == "wheeled_vehicle"
    if kind not in _FORCES and kind not in _TORQUES:
        return []
    try:
        terms = _terms_of(load, at)
        motors = load.driven_wheels if wheel else load.motors
        terms |= {"N": (motors, "1")}
        if kind in _TORQUES:
            inner = _summed(_plain(_TORQUES[kind], terms), terms, at)
        else:
            title, expression = "Force on what moves, at this moment", _summed(_plain(_FORCES[kind], terms), terms, at)
            first, force = worked("force", title, "F", expression, terms, "N", "force")
            steps, drives = [first], force * at.way
            loss = load.rope_efficiency if kind == "hoist" else getattr(load, "efficiency", 1.0)
            if loss is None:
                return []
            back = getattr(load, "back_efficiency", None)
            back = (2.0 - 1.0 / loss if back is None else back) if kind in ("ball_screw", "lead_screw") else loss
            through = "F * r" if drives == 0.0 or loss == 1.0 else "F * r / eta" if drives > 0.0 else "F * r * eta"
            terms |= {"F": (force, "N"), "eta": (loss if drives > 0.0 else back, "1"),
                      "T_d": (getattr(load, _DRAG.get(kind, [""])[0], 0.0), "N*m")}  # fmt: skip
            through = ("F * r / N" if motors > 1 else "F * r") if wheel else through
            inner = _summed([f"+ {through}", "+ J * alpha", *([] if wheel else ["± T_d"])], terms, at)
        if motors > 1 and not wheel:
            inner = f"({inner}) / N"
    except (TypeError, ArithmeticError):  # a figure that this kind of spec does not give
        return []
    title = "Torque of one drive at the driven shaft"
    last, torque = worked("shaft_torque", title, "T", inner, terms, "N*m", "torque")
    return [*steps, last] if isclose(torque, at.torque, rel_tol=1e-6, abs_tol=1e-9) else []


# -- From the driven shaft to the motor: the moment of its largest torque, and the mean over the cycle.


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
                "and then the whole cycle. The numbers put in are in SI units.")  # fmt: skip
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
    expression = _summed([f"+ {way}", f"+ {turning}", "+ tau_f"], terms)
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
        steps.append(worked("motor_voltage", "Its voltage", "U", _summed(["+ k_e * omega", "+ R * I"], volts),
                            volts, "V", "voltage", note)[0])  # fmt: skip
    steps += _over_the_cycle([piece for piece in drive.pieces if piece.case == case.name], k_t)
    yield from map(doc.Equation, steps)


_MOST_PIECES = 8  # under one root


def _over_the_cycle(pieces: list[Any], k_t: float) -> Iterator[dict[str, Any]]:
    """The RMS torque as the root of the squares of the pieces, and the RMS current."""
    parts = [piece for piece in pieces if piece.name != "cycle" and piece.rms_torque]
    if not parts or len(parts) > _MOST_PIECES:
        return
    terms: Terms = {f"tau_{n}": (piece.rms_torque, "N*m") for n, piece in enumerate(parts, 1)}
    terms |= {f"t_{n}": (piece.duration, "s") for n, piece in enumerate(parts, 1)}
    terms |= {"t": (pieces[-1].duration, "s")}
    squares = " + ".join(f"tau_{n}**2 * t_{n}" for n in range(1, len(parts) + 1))
    names = ", ".join(f"{n} {piece.name}" for n, piece in enumerate(parts, 1))
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
