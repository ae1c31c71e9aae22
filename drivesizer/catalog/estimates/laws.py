"""Log-linear laws by which figures follow from others, declared once.

A law ``y = exp(b_0 + b_1 ln x_1 + ...)`` holds within one class of parts. Inertia grows about as mass times diameter
squared, heat capacity as mass, thermal resistance against the surface, friction and loss with size and stages. Several
laws may give one figure: a part is served by the one with the narrowest band whose terms it has.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from functools import cache
from importlib import resources
from typing import Any, NamedTuple

import numpy as np
import yaml
from numpy.typing import NDArray

from drivesizer.catalog.tables import Table

__all__ = ["LAWS", "Law", "column", "constructions_of", "families_of", "given_column", "members_of"]


class Law(NamedTuple):
    """One figure of one class of parts, from terms in logarithms."""

    section: str
    of: str  # class of parts, "" for all
    figure: str
    terms: tuple[str, ...]  # columns, or names of ``_DERIVED``


# figure | terms of one law; terms of the next ...
_MOTOR = """
rotor_inertia | mass diameter; mass; mass motor_constant; mass diameter motor_constant; mass diameter length
friction | nominal_torque; mass; mass diameter; mass motor_constant; mass diameter motor_constant
thermal_resistance_winding | mass diameter; mass; mass motor_constant
thermal_resistance_housing | mass diameter; mass
winding_time_constant | thermal_resistance_winding mass; thermal_resistance_winding mass motor_constant
motor_time_constant | thermal_resistance_housing mass; thermal_resistance_housing mass diameter
inductance | resistance torque_constant mass; resistance mass; resistance
diameter | mass
length | mass diameter; diameter
mass | diameter length; diameter; nominal_torque
"""
_GEARHEAD = """
inertia | diameter ratio stages; mass ratio stages; continuous_torque ratio stages
loss_per_stage | diameter ratio_per_stage; ratio_per_stage; -
mass | diameter stages; continuous_torque stages
length | diameter stages
diameter | continuous_torque stages; continuous_torque
backlash | diameter stages; stages
"""
_ACTUATOR = """
mass | nominal_torque; motor_constant; stall_torque; diameter; torque_at_rotor
mass | nominal_torque motor_constant; stall_torque motor_constant
inertia_at_rotor | mass; mass ratio; mass diameter; motor_constant; mass motor_constant; mass torque_at_rotor
friction | motor_constant; torque_at_rotor
loss | ratio; -
"""
_ENCODER = """
inertia | diameter
mass | -
current_draw | -
"""
_CLASSES: dict[str, tuple[str, tuple[str, ...]]] = {
    "motors": (_MOTOR, ("brushed", "inrunner", "outrunner", "frameless", "brushless")),
    "gearheads": (_GEARHEAD, ("planetary", "spur")),
    "actuators": (_ACTUATOR, ("planetary", "spur", "strain wave", "brushed", "brushless", "")),
    "encoders": (_ENCODER, ("",)),
}


def _declared() -> Iterator[Law]:
    for section, (listed, classes) in _CLASSES.items():
        for line in listed.strip().splitlines():
            figure, choices = (cell.strip() for cell in line.split("|"))
            for terms in choices.split(";"):
                names = tuple(term for term in terms.split() if term != "-")
                yield from (Law(section, of, figure, names) for of in classes)


LAWS: tuple[Law, ...] = tuple(_declared())


# What is no column of its own: known where all that it is made of is.
_DERIVED: dict[str, Callable[[Table[Any]], NDArray[np.float64]]] = {
    "motor_constant": lambda table: _torque_constant(table) ** 2 / table["resistance"],  # k_m^2 [N^2*m^2/W]
    "torque_at_rotor": lambda table: table["nominal_torque"] / table["ratio"],
    "inertia_at_rotor": lambda table: _known(table["rotor_inertia"], table["output_inertia"] / table["ratio"] ** 2),
    "output_constant": lambda table: np.where(  # k_t k_e / R at the output, of actuators whose ratio is unknown
        np.isnan(table["ratio"]), table["torque_constant"] ** 2 / (table["efficiency"] * table["resistance"]), np.nan
    ),
    "ratio_per_stage": lambda table: table["ratio"] ** (1.0 / _stages(table)),
    "loss_per_stage": lambda table: 1.0 - table["efficiency"] ** (1.0 / _stages(table)),
    "loss": lambda table: 1.0 - _known(table["efficiency"], 1.0 / (1.0 + table["load_friction"])),
    "friction": lambda table: _known(_torque_constant(table) * table["no_load_current"], _identified(table)),  # [N*m]
}


def column(table: Table[Any], name: str) -> NDArray[np.float64]:
    """A column of a law, as the catalogue has it or derived from it; NaN where that is unknown or not above 0."""
    with np.errstate(invalid="ignore", divide="ignore"):
        values = _DERIVED[name](table) if name in _DERIVED else table[name]
        return np.where(values > 0.0, values, np.nan)


_MOST = 0.9  # of the power that a stage loses

# the column that such a figure gives, and how; those that no drive is sized by are left out
_GIVES: dict[str, tuple[str, Callable[[Table[Any], NDArray[np.float64]], NDArray[np.float64]]]] = {
    "inertia_at_rotor": ("rotor_inertia", lambda table, inertia: np.where(np.isnan(table["ratio"]), np.nan, inertia)),
    "friction": ("no_load_current", lambda table, torque: torque / _torque_constant(table)),
    "loss": ("efficiency", lambda table, loss: 1.0 - np.minimum(loss, _MOST)),
    "loss_per_stage": ("efficiency", lambda table, loss: (1.0 - np.minimum(loss, _MOST)) ** _stages(table)),
}


def given_column(table: Table[Any], figure: str, values: NDArray[np.float64]) -> tuple[str, NDArray[np.float64]]:
    """The column that a law's figure gives, with its values."""
    name, made = _GIVES.get(figure, (figure, lambda table, values: values))
    return name, made(table, values)


def _stages(table: Table[Any]) -> NDArray[np.float64]:
    return np.where(table["stages"] > 0.0, table["stages"], np.nan)


def _torque_constant(table: Table[Any]) -> NDArray[np.float64]:
    """k_t at the rotor: an actuator's own is printed as ``motor_torque_constant``."""
    return table["motor_torque_constant" if table.section == "actuators" else "torque_constant"]


def _known(printed: NDArray[np.float64], otherwise: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where(np.isnan(printed), otherwise, printed)


def _identified(table: Table[Any]) -> NDArray[np.float64]:
    """Friction at the rotor and the no-load speed of actuators whose friction was identified."""
    if table.section != "actuators":
        return np.full(len(table), np.nan)
    output = table["coulomb_friction"] + table["viscous_friction"] * table["no_load_speed"]
    return np.asarray(output / table["ratio"])


def members_of(table: Table[Any], of: str) -> NDArray[np.bool_]:
    """Mask of the parts of a class."""
    if not of:
        return np.ones(len(table), bool)
    if table.section == "motors" and of not in ("brushed", "brushless"):
        return np.asarray(_motor_constructions(table) == of, np.bool_)
    by_gearing = table.section == "actuators" and of not in ("brushed", "brushless")
    rows: NDArray[np.bool_] = table["gearing" if by_gearing else "kind"] == of
    if table.section == "gearheads":
        rows &= table["ratio"] > 1.0  # none is a gearhead of its own in the table
    return rows


def families_of(table: Table[Any]) -> NDArray[np.str_]:
    """Maker and family of each part, with a line's end between: families of two makers may have one name."""
    return np.char.add(np.char.add(table["manufacturer"].astype(str), "\n"), table["family"].astype(str))


def constructions_of(table: Table[Any]) -> NDArray[np.str_]:
    """Construction of each part, finer than most classes of laws."""
    names = {"gearheads": ("kind",), "actuators": ("kind", "gearing")}.get(table.section, ())
    columns = [table[name].astype(str) for name in names]
    if table.section == "motors":
        columns = [_motor_constructions(table)]
    return np.array(columns, np.str_).reshape(len(columns), len(table))


def _motor_constructions(table: Table[Any]) -> NDArray[np.str_]:
    kind = table["kind"].astype(str)
    names, back = np.unique(families_of(table), return_inverse=True)
    return np.where(kind == "brushless", np.array([_construction(n) for n in names.tolist()])[back], kind)


@cache
def _patterns() -> list[dict[str, str]]:
    text = (resources.files(__package__) / "constructions.yaml").read_text(encoding="utf-8")
    found: list[dict[str, str]] = yaml.safe_load(text)
    return found


def _construction(name: str) -> str:
    maker, family = name.split("\n", 1)
    fits = (p["construction"] for p in _patterns() if p["maker"] == maker and re.match(p["family"], family))
    return next(fits, "")
