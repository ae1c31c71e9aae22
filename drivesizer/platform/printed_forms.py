"""Units and values of the printed form of a platform equation, checked by evaluating it.

Units, by measuring anew: every figure of a sample robot is given in other base units (a length of 0.3 m, a mass of
1.7 kg, a time of 0.6 s). A form whose units agree gives the same result in them; one that adds lengths
to areas does not. This works for whatever can be computed, matrices with entries of several units among it.
Values, by comparing: what the printed form gives of the sample robot, beside what the computed form gives.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from drivesizer.physics.equation import Term
from drivesizer.platform import matrix_equation
from drivesizer.platform.dynamics import dynamics
from drivesizer.platform.matrix_equation import PLATFORM, Array, MatrixEquation
from drivesizer.platform.robot_figures import OF_A_WHEEL, Instant, figures
from drivesizer.platform.wheels import Platform, table_wheel
from drivesizer.units import registry

__all__ = ["SOURCE", "Finding", "find", "finding", "rows", "sample"]

_BASE = {"[length]": 0.3, "[mass]": 1.7, "[time]": 0.6}
_FUNCTIONS = {n: getattr(np, n) for n in ("array", "concatenate", "cos", "diag", "sin", "sum")} | {
    n: getattr(np.linalg, n) for n in ("inv", "pinv")
}
_NEAR = 1e-9
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
def _unit_of() -> dict[str, str]:
    return {t.name: t.unit for e in PLATFORM.values() for t in (*e.terms, e.result)}


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
    factors: Array = up[:, None] / np.array([_factor(u.strip()) for u in under.split(",")])
    return factors


def _value(expression: str, *, anew: bool = False) -> Any:
    unit, known = _unit_of(), sample()
    figures = {n: v * _factors(unit[n]) if anew else v for n, v in known.items() if n in unit}
    return eval(expression, {"__builtins__": {}}, _FUNCTIONS | figures)  # noqa: S307 - our own declarations


def _where(one: Any, other: Any) -> str | None:
    """The first entry in which two results differ by more than rounding."""
    one, other = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
    off = ~(np.abs(one - other) <= _NEAR * max(1e-3, float(np.abs(other).max())))  # written so that NaN fails too
    if not off.any():
        return None
    place = tuple(int(k) for k in np.argwhere(off)[0])
    entry = f"entry {', '.join(str(k + 1) for k in place)}" if place else "it"
    return f"{entry} is {one[place]:.4g}, not {other[place]:.4g}"


@cache
def finding(declared: MatrixEquation) -> Finding:
    """Findings on the printed form of an equation.

    >>> finding(PLATFORM[23]).values  # of the sample robot
    'entry 2 is 0.1592, not 0.5408'
    >>> finding(PLATFORM[24])
    Finding(units=None, values=None)
    """
    try:
        plain, again = _value(declared.printed), _value(declared.printed, anew=True)
    except np.linalg.LinAlgError:
        rows, columns = np.shape(sample()["E"].T)
        no_inverse = replace(declared, printed=declared.printed.replace("inv(", "pinv("))  # has the same units
        return Finding(finding(no_inverse).units, f"Eᵀ is {rows} × {columns}, and only a square matrix has an inverse")
    units = _where(again / _factors(declared.result.unit), plain)
    return Finding(
        f"in other base units {units}" if units else None, _where(plain, _value(matrix_equation.computed(declared)))
    )


def find(key: str) -> MatrixEquation | None:
    """The equation of the platform with a number (as text) or a function name, or None."""
    bare = key.strip().strip("()")
    if bare.isascii() and bare.isdigit():
        return PLATFORM.get(int(bare))
    return {e.name: e for e in PLATFORM.values()}.get(bare)


def rows(declared: MatrixEquation) -> list[tuple[str, str]]:
    """An equation as rows of a name and words: as printed, what was found, as computed, note, result, terms, source."""
    found, left = finding(declared), declared.symbol
    lines = [
        ("as printed", f"{declared.printed_symbol or left} = {matrix_equation.text(declared.printed)}"),
        ("unit check", f"fails: {found.units}" if found.units else "passes"),
        ("value check", f"fails: {found.values}" if found.values else "passes"),
        ("as computed", f"{left} = {matrix_equation.text(matrix_equation.computed(declared))}"),
    ]
    if declared.note:
        lines.append(("note", declared.note))
    lines.append(("result", _meaning(declared.result)))
    lines += [(matrix_equation.symbol(t.name), _meaning(t)) for t in declared.terms]
    return [*lines, ("source", SOURCE)]


def _meaning(term: Term) -> str:
    unit = term.unit.replace("*", "·").replace("^2", "²")
    return f"{term.meaning} [{unit}]"
