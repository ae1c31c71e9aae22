"""Figures of one robot at one instant, by the names of equations (21)-(59), and the check of their printed forms."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from drivesizer.errors import InputError
from drivesizer.files.arithmetic import own_value
from drivesizer.physics.equation import Term
from drivesizer.platform import equations
from drivesizer.platform.dynamics import (
    LEVEL,
    Dynamics,
    Ground,
    Moving,
    dynamics,
    energy,
    required_force,
    resistance,
    weight_along,
)
from drivesizer.platform.equations import PLATFORM, Array, MatrixEquation, symbol
from drivesizer.platform.kinematics import Platform, table_wheel
from drivesizer.units import registry

# -- Figures of one robot at one instant, by the names of equations (21)-(59), and as labelled matrices with units.


_AXES = ("x", "y", "θ")
_POSTURE = ("R", "R_T_dot")  # of which both axes are those of the posture, though all entries have one unit
_OF_ITS = {  # an entry of a matrix: unit of its row over that of its column
    ("m/s", "m/s"): "1", ("m/s", "rad/s"): "m", ("rad/s", "m/s"): "1/m", ("rad/s", "rad/s"): "1",
    ("N", "m/s^2"): "kg", ("N", "rad/s^2"): "kg*m", ("N*m", "m/s^2"): "kg*m", ("N*m", "rad/s^2"): "kg*m^2",
    ("N", "m/s"): "kg/s", ("N", "rad/s"): "kg*m/s", ("N*m", "m/s"): "kg*m/s", ("N*m", "rad/s"): "kg*m^2/s",
    ("N*m", "N"): "m", ("N*m", "N*m"): "1",
}  # fmt: skip
_NOTHING = 1e-12  # of the largest entry: rounding
_NEAR = 1e-9  # of the largest entry: the same
_DERIVED = (28, 29, 31, 39, 43, 45, 47, 48, 50, 51, 49, 44, 58, 59)  # each builds on those before
OF_A_WHEEL = ("L", "alpha", "gamma", "phi", "delta", "varphi_i_dot", "O_Ri_dot")  # the last axis counts the wheels
_MATRICES = ("J_1", "J_2", "E", "K_plus", "M_R", "M_phi", "M_bar", "C_bar", "M_q", "C_q")


class Instant(NamedTuple):
    """One instant of a platform's motion."""

    posture: Array  # m, m, rad
    eta: Array  # m/s, m/s, rad/s in the robot's frame
    eta_dot: Array  # m/s^2, m/s^2, rad/s^2
    ground: Ground = LEVEL
    towards: Array | None = None  # velocity whose direction the resistances take, where it is not that of ``eta``


class Numbers(NamedTuple):
    """A scalar, vector or matrix with its labels; each entry has its own unit, angles are in degrees."""

    name: str
    symbol: str
    meaning: str
    rows: tuple[str, ...]
    columns: tuple[str, ...]
    values: Array  # (rows, columns)
    units: list[list[str]]
    equations: tuple[int, ...] = ()  # whose result it is


def figures(d: Dynamics, at: Instant) -> dict[str, Any]:
    """Figures of a robot by the names that equations (21)-(59) use; those of a wheel as an array over wheels."""
    k, p, driven = d.kinematics, d.platform, list(d.kinematics.driven)
    L, alpha, beta, gamma, r, inertia = np.array(
        [(w.L, w.alpha, w.beta, w.roller_angle, w.radius, w.inertia + w.rotor_inertia) for w in k.wheels]
    ).T
    K_plus, D, turn = np.zeros((3, len(r))), np.zeros((len(r), 3)), at.eta[2]
    K_plus[:, driven], D[driven] = k.K_plus, d.distribution
    R = equations.robot_velocity(at.posture[2], *np.eye(3))
    s: dict[str, Any] = {
        "x": at.posture[0], "y": at.posture[1], "theta": at.posture[2], "R": R, "eta": at.eta, "eta_dot": at.eta_dot,
        "R_T_dot": turn * R.T @ np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]),
        "x_R_dot": at.eta[0], "y_R_dot": at.eta[1], "theta_dot": turn,
        "L_i": L, "L": L, "alpha": alpha, "beta": beta, "gamma_i": gamma, "gamma": gamma, "r_i": r, "r": r[0],
        "phi_i": alpha + beta + gamma, "phi": alpha + beta + gamma, "delta_i": beta + gamma, "delta": beta + gamma,
        "l_1": abs(k.wheels[0].x), "l_2": abs(k.wheels[0].y), "E": k.E, "K": k.E, "K_plus": K_plus, "D": D,
        "varphi_dot": k.E @ at.eta, "q_dot": k.E @ at.eta, "varphi_i_dot": k.E @ at.eta,
        "m_R": p.mass, "x_C": p.x, "y_C": p.y, "I_Rz": p.inertia + p.mass * (p.x**2 + p.y**2), "I_phiy": inertia,
        "T": energy(d, at.eta), "g_q": -D @ weight_along(p, at.posture[2], at.ground),
    }  # fmt: skip
    for number in _DERIVED:
        e = PLATFORM[number]
        s[e.result.name] = e(**{t.name: s[t.name] for t in e.terms})
    s |= {"x_dot": s["xi_dot"][0], "y_dot": s["xi_dot"][1], "q_ddot": s["varphi_ddot"], "M": s["M_R"] / 2}
    s["O_Ri_dot"] = PLATFORM[23](*at.eta, L, alpha)
    s["T_xi"] = R.T @ (s["F"] - k.E.T @ s["T_phi"])  # (34)
    s["T_psi"] = np.array([0.0, 0.0, -p.mass * turn * (p.x * at.eta[0] + p.y * at.eta[1])])
    s["p_dot"] = s["T_xi"] + s["T_psi"]  # (35)
    if len(r) == 4:  # the paper has four wheels where it writes them one by one
        tau = PLATFORM[52](*(s[t.name] for t in PLATFORM[52].terms))
        for number, (speed, torque) in enumerate(zip(s["varphi_dot"], tau, strict=True), 1):
            s |= {f"varphi_{number}_dot": speed, f"tau_{number}": torque}
    return s


def result_of(e: MatrixEquation, known: Mapping[str, Any]) -> Array:
    """The result of an equation for a robot; of one that is written for a wheel the first axis counts the wheels."""
    terms = {t.name: known[t.name] for t in e.terms if t.name in known}
    one_by_one = [name for name in terms if name in OF_A_WHEEL]
    if len(terms) == len(e.terms):
        if one_by_one:
            wheels = range(len(known["L"]))
            return np.stack([e(**terms | {n: terms[n][..., i] for n in one_by_one}) for i in wheels])
        result, expected = np.asarray(e(**terms)), np.asarray(known.get(e.result.name, np.nan))
        if np.isnan(expected).all() or (
            result.shape == expected.shape
            and np.abs(result - expected).max() <= _NEAR * max(1.0, np.abs(expected).max())
        ):
            return result
    raise InputError(
        f"equation ({e.number}) is written for four driven wheels as in the paper's Table 1, with the centre of mass "
        "in the reference point; this platform is another, expected e.g. 32, 49, 50 or 58"
    )


def labelled(term: Term, value: Any, *, wheels_first: bool = False, equations: Iterable[int] = ()) -> Numbers:
    """A figure with labels and units by its declaration."""
    over, _, under = term.unit.partition(" per ")
    up, down = ([u.strip() for u in part.split(",")] for part in (over, under))
    array, posture = np.asarray(value, dtype=float), term.name in _POSTURE
    axes = [_labels(up, n, posture) for n in array.shape]
    if wheels_first:
        inner, wheels = [_AXES[:n] for n in array.shape[1:]], [f"wheel {i + 1}" for i in range(len(array))]
        if len(inner) == 2:
            wheels = [f"{wheel} {axis}" for wheel in wheels for axis in inner[0]]
            array = array.reshape(len(wheels), -1)
        axes = [tuple(wheels), *inner[-1:]]
    elif array.ndim == 2 and under:
        axes[1] = _labels(down, array.shape[1], posture)
    rows, columns = (*axes, ("",), ("",))[:2] if array.ndim else (("",), ("",))
    units = [[_unit(up, down if under else (), i, j) for j in range(len(columns))] for i in range(len(rows))]
    return _numbers(term.name, term.meaning, rows, columns, array.reshape(len(rows), len(columns)), units, equations)


def _labels(units: Sequence[str], length: int, posture: bool) -> tuple[str, ...]:
    """Labels of an axis: of posture or force where its entries have units of their own, else one for each wheel."""
    head = _AXES[:length] if posture or len(units) > 1 else ()
    return (*head, *(f"wheel {i + 1}" for i in range(length - len(head))))


def _unit(up: Sequence[str], down: Sequence[str], row: int, column: int) -> str:
    """Unit of an entry: that of its row, over that of its column where there is one."""
    unit, below = up[min(row, len(up) - 1)], down[min(column, len(down) - 1)] if down else "1"
    return unit if not down else "1" if unit == below else _OF_ITS[unit, below]


def _numbers(
    name: str, meaning: str, rows: Sequence[str], columns: Sequence[str], values: Array, units: list[list[str]],
    equations: Iterable[int] = (),
) -> Numbers:  # fmt: skip
    """Numbers without what rounding leaves where there is nothing, and with angles in degrees."""
    clean = np.where(np.abs(values) <= _NOTHING * max(1.0, np.abs(values).max()), 0.0, values)
    turned = np.where(np.array(units) == "rad", np.degrees(clean), clean)
    degrees = [["deg" if unit == "rad" else unit for unit in row] for row in units]
    return Numbers(name, symbol(name), meaning, tuple(rows), tuple(columns), turned, degrees, tuple(equations))


def numbers_of(e: MatrixEquation, known: Mapping[str, Any]) -> list[Numbers]:
    """Result of an equation for a robot, then its terms."""
    numbers = [labelled(e.result, result_of(e, known), wheels_first=any(t.name in OF_A_WHEEL for t in e.terms))]
    for t in e.terms:
        one_by_one = t.name in OF_A_WHEEL
        value = np.moveaxis(known[t.name], -1, 0) if one_by_one else known[t.name]
        numbers.append(labelled(t, value, wheels_first=one_by_one))
    return [numbers[0]._replace(symbol=e.symbol), *numbers[1:]]


def matrices(d: Dynamics) -> list[Numbers]:
    """The matrices of a robot with the equations that they are results of; those of Coriolis at 1 rad/s."""
    known = figures(d, Instant(np.zeros(3), np.array([0.0, 0.0, 1.0]), np.zeros(3)))
    rows, laws = [], [PLATFORM[number] for number in sorted(PLATFORM)]
    for name in _MATRICES:
        results = [e for e in laws if e.result.name == name and _holds(e, known)]
        users = [e for e in laws if any(t.name == name for t in e.terms)]
        term = next(t for t in (*(e.result for e in results), *users[0].terms) if t.name == name)
        title = results[0].title if results else term.meaning
        numbers = [e.number for e in results or users[:1]]
        rows.append(labelled(term._replace(meaning=title), known[name], equations=numbers))
    return rows


def _holds(e: MatrixEquation, known: Mapping[str, Any]) -> bool:
    try:
        result_of(e, known)
    except InputError:
        return False
    return True


def wheel_table(d: Dynamics) -> Numbers:
    """The paper's Table 1 of a robot, with what its equations make of the angles: a row for each wheel."""
    known = figures(d, Instant(np.zeros(3), np.zeros(3), np.zeros(3)))
    columns = {"L": "mm", "alpha": "rad", "beta": "rad", "gamma": "rad", "phi": "rad", "delta": "rad", "r": "mm",
               "I_phiy": "kg*m^2"}  # fmt: skip
    known["r"] = known["r_i"]
    values = np.array([known[name] * (1000.0 if unit == "mm" else 1.0) for name, unit in columns.items()]).T
    turns = [unit == "rad" for unit in columns.values()]
    values[:, turns] = np.pi - (np.pi - values[:, turns]) % (2.0 * np.pi)
    rows = [f"wheel {i + 1}" for i in range(len(values))]
    meaning, units = "Wheels as in the paper's Table 1, with radii and inertias", [[*columns.values()]] * len(rows)
    return _numbers("wheels", meaning, rows, [*map(symbol, columns)], values, units)


def mobility(d: Dynamics) -> Numbers:
    """Rank of E, the motions that the wheels allow, and the torques that these leave open."""
    k = d.kinematics
    values = [float(np.linalg.matrix_rank(k.E)), k.mobility, len(k.driven) - k.mobility]
    rows = ("rank of E", "degree of mobility: motions that the wheels allow", "torques that a motion leaves open")
    return _numbers("mobility", "Rank and mobility", rows, ("",), np.array([values]).T, [["1"]] * len(rows))


def robot_at_instant(d: Dynamics, at: Instant) -> tuple[Numbers, Numbers]:
    """A robot at an instant: its course, and force and torques by their causes."""
    known, theta = figures(d, at), at.posture[2]
    terms = [PLATFORM[21].result, PLATFORM[22].result, next(t for t in PLATFORM[47].terms if t.name == "eta_dot")]
    parts = [labelled(t, value) for t, value in zip(terms, (at.posture, known["eta"], known["eta_dot"]), strict=True)]
    units = [[row for (row,) in part.units] for part in parts]
    course = Numbers("course", "course", "Posture in the world, velocity and its rate of change in the robot's frame",
                     _AXES, tuple(part.symbol for part in parts), np.hstack([part.values for part in parts]),
                     [list(row) for row in zip(*units, strict=True)], (21, 22))  # fmt: skip
    towards = at.eta if at.towards is None else at.towards
    causes = {
        "inertia, M̄ η̇": d.M @ at.eta_dot,
        "Coriolis, C̄ η": known["C_bar"] @ at.eta,
        "weight on a slope": -weight_along(d.platform, theta, at.ground),
        "rolling resistance": resistance(d, towards, theta, at.ground),
        "together": required_force(d, Moving(at.eta, at.eta_dot, theta, at.ground, at.towards)),
    }
    force = np.array([*causes.values()])
    columns = (*_AXES, *(f"wheel {i + 1}" for i in range(len(d.kinematics.wheels))))
    rows = [["N", "N", *["N*m"] * (len(columns) - 2)]] * len(causes)
    forces = _numbers("forces", "Force and moment in the robot's axes, and the torques of the wheels for them",
                      [*causes], columns, np.hstack([force, force @ known["D"].T]), rows, (49, 52, 57))  # fmt: skip
    return course, forces


# -- Units and values of the printed form of a platform equation, checked by evaluating it.
#
# Units, by measuring anew: every figure of a sample robot is given in other base units (a length of 0.3 m, a mass of
# 1.7 kg, a time of 0.6 s). A form whose units agree gives the same result in them; one that adds lengths
# to areas does not. This works for whatever can be computed, matrices with entries of several units among it.
# Values, by comparing: what the printed form gives of the sample robot, beside what the computed form gives.


_BASE = {"[length]": 0.3, "[mass]": 1.7, "[time]": 0.6}
_FUNCTIONS = {n: getattr(np, n) for n in ("array", "concatenate", "cos", "diag", "sin", "sum")} | {
    n: getattr(np.linalg, n) for n in ("inv", "pinv")
}
SOURCE = "Prados Sesmero et al., Appl. Sci. 2021, 11, 6631, doi:10.3390/app11146631"


class Finding(NamedTuple):
    """Findings of the evaluation of a printed form; None where nothing is wrong."""

    units: str | None  # why the units fail
    values: str | None  # where it gives something else than the computed form


@cache
def sample() -> dict[str, Any]:
    """Figures of the paper's robot on a curve, by the names that equations use; those of a wheel are of the second."""
    places = [(-1.0, 45.0), (1.0, -45.0), (1.0, 45.0), (-1.0, -45.0)]
    alpha, wheels = np.radians(29.5), []
    for number, (side, gamma) in enumerate(places):
        direction = side * (alpha if number < 2 else np.pi - alpha)
        wheels.append(table_wheel(0.27406, direction, np.pi / 2 - direction, np.radians(gamma), 0.0762, inertia=3.1e-3))
    d = dynamics(Platform(wheels=tuple(wheels), mass=45.0, inertia=2.3))
    known = figures(d, Instant(np.array([1.2, -0.7, 0.4]), np.array([0.9, 0.35, 0.8]), np.array([0.5, -0.3, 0.6])))
    of_a_wheel = {name: known[name][..., 1] for name in OF_A_WHEEL}
    nothing_is_zero = {"p_dot": known["T_xi"] + 1.0, "T_psi": np.ones(3), "g_q": np.full(4, 0.2)}
    return known | of_a_wheel | nothing_is_zero


@cache
def _factor(unit: str) -> float:
    """Factor of a figure in this SI unit when the base units are ours."""
    dimension: Any = registry().Quantity(1.0, "" if unit == "1" else unit).dimensionality
    return float(math.prod(_BASE[base] ** -power for base, power in dimension.items()))


def _factors(unit: str) -> Array:
    """The same of a vector or a matrix, entry by entry; what all entries share stands once."""
    over, _, under = unit.partition(" per ")
    up = np.array([_factor(u.strip()) for u in over.split(",")])
    if not under:
        return up if len(up) > 1 else up.reshape(())
    return up[:, None] / np.array([_factor(u.strip()) for u in under.split(",")])


def _value(expression: str, *, anew: bool = False) -> Any:
    unit = {t.name: t.unit for e in PLATFORM.values() for t in (*e.terms, e.result)}
    known = sample()
    figures = {n: v * _factors(unit[n]) if anew else v for n, v in known.items() if n in unit}
    return own_value(expression, _FUNCTIONS | figures)


def _where(result: Any, other: Any) -> str | None:
    """The first entry in which two results differ by more than rounding."""
    result, other = np.asarray(result, dtype=float), np.asarray(other, dtype=float)
    off = ~(np.abs(result - other) <= _NEAR * max(1e-3, float(np.abs(other).max())))  # written so that NaN fails too
    if not off.any():
        return None
    place = tuple(int(k) for k in np.argwhere(off)[0])
    entry = f"entry {', '.join(str(k + 1) for k in place)}" if place else "it"
    return f"{entry} is {result[place]:.4g}, not {other[place]:.4g}"


@cache
def finding(declared: MatrixEquation) -> Finding:
    """Findings on the printed form of an equation.

    >>> finding(PLATFORM[23]).values  # of the sample robot
    'entry 2 is 0.1592, not 0.5408'
    >>> finding(PLATFORM[24])
    Finding(units=None, values=None)
    """
    try:
        plain, rescaled = _value(declared.printed), _value(declared.printed, anew=True)
    except np.linalg.LinAlgError:
        rows, columns = np.shape(sample()["E"].T)
        no_inverse = replace(declared, printed=declared.printed.replace("inv(", "pinv("))  # has the same units
        return Finding(finding(no_inverse).units, f"Eᵀ is {rows} × {columns}, and only a square matrix has an inverse")
    units = _where(rescaled / _factors(declared.result.unit), plain)
    return Finding(f"in other base units {units}" if units else None, _where(plain, _value(declared.computed)))


def find(key: str) -> MatrixEquation | None:
    """The equation of the platform with a number (as text) or a function name, or None."""
    bare = key.strip().strip("()")
    if bare.isascii() and bare.isdigit():
        return PLATFORM.get(int(bare))
    return {e.name: e for e in PLATFORM.values()}.get(bare)


def rows(declared: MatrixEquation) -> list[tuple[str, str]]:
    """An equation as rows of a name and words: as printed, what was found, as computed, note, result, terms, source."""

    def meaning(term: Term) -> str:
        return f"{term.meaning} [{term.unit.replace('*', '·').replace('^2', '²')}]"

    faults, left = finding(declared), declared.symbol
    note = [("note", declared.note)] if declared.note else []
    return [
        ("as printed", f"{declared.printed_symbol or left} = {equations.text(declared.printed)}"),
        ("unit check", f"fails: {faults.units}" if faults.units else "passes"),
        ("value check", f"fails: {faults.values}" if faults.values else "passes"),
        ("as computed", f"{left} = {equations.text(declared.computed)}"),
        *note, ("result", meaning(declared.result)),
        *((symbol(t.name), meaning(t)) for t in declared.terms), ("source", SOURCE),
    ]  # fmt: skip
