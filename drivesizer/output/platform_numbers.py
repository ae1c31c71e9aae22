"""Kinematics and dynamics of a spec's platform in numbers, as every output prints them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drivesizer.errors import InputError
from drivesizer.load_cases.platform_instant import HardestInstant, hardest_instant
from drivesizer.platform.dynamics import Dynamics
from drivesizer.platform.matrix_equation import PLATFORM, MatrixEquation, computed, text
from drivesizer.platform.robot_figures import (
    Instant,
    Numbers,
    figures,
    matrices,
    mobility,
    numbers_of,
    robot_at_instant,
    wheel_table,
)
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import label

__all__ = [
    "EquationNumbers", "PlatformNumbers", "Printed", "cell", "equation_of", "formula", "platform_numbers", "printed",
]  # fmt: skip


class PlatformNumbers(NamedTuple):
    """The tables of a platform, and sentences on what they are of."""

    rotors: str
    moment: str
    wheels: Numbers
    mobility: Numbers
    matrices: list[Numbers]
    at_instant: tuple[Numbers, Numbers]  # course, forces

    @property
    def every(self) -> list[Numbers]:
        """All tables in their order."""
        return [self.wheels, self.mobility, *self.matrices, *self.at_instant]


def platform_numbers(spec: RobotSpec, drive: DriveSet | None) -> PlatformNumbers:
    """Tables of a platform."""
    at = hardest_instant(spec, drive.rotors_at_load if drive else 0.0)
    d = at.dynamics
    sentences = _rotors(drive), _moment(at)
    return PlatformNumbers(*sentences, wheel_table(d), mobility(d), matrices(d), robot_at_instant(d, at.instant))


class EquationNumbers(NamedTuple):
    """An equation with the numbers of a platform: its name, sentences on what they are of, then result and terms."""

    of: str
    remarks: list[str]
    tables: list[Numbers]


def equation_of(declared: MatrixEquation, spec: RobotSpec, drive: DriveSet | None, turning: bool) -> EquationNumbers:
    """An equation of the platform with the numbers of a spec."""
    at = hardest_instant(spec, drive.rotors_at_load if drive else 0.0)
    try:
        tables, others = (
            numbers_of(declared, figures(at.dynamics, one)) for one in (at.instant, _other_instant(at.dynamics))
        )
    except InputError as error:
        raise InputError(f"{spec.where(('platform',))}: {error}") from None
    moves = any((one.values != other.values).any() for one, other in zip(tables, others, strict=True))
    remarks = [_moment(at)] if moves else []
    return EquationNumbers(spec.name, [*remarks, *([_rotors(drive)] if turning else [])], tables)


def _other_instant(d: Dynamics) -> Instant:
    """A motion that the wheels allow, with something of each that they do."""
    eta = 0.3 * d.kinematics.motions.sum(axis=1)
    return Instant(np.array([1.0, 2.0, 0.5]), eta, 2.0 * eta)


def _rotors(drive: DriveSet | None) -> str:
    of = f"with motor and gearhead of {drive.label}" if drive else "without rotors, as there is no drive"
    return f"Inertias of the wheels are {of}."


def _moment(at: HardestInstant) -> str:
    when = f"{at.time:.4g} s{f' of load case {at.case}' if at.case else ''}"
    return f"What changes with the motion is that at {when}, where wheel {at.wheel} has its largest torque."


def formula(numbers: Numbers) -> str:
    """The equation that a table is the result of, as text; empty where it is of none."""
    if not numbers.equations:
        return ""
    declared = PLATFORM[numbers.equations[0]]
    return f"{declared.symbol} = {text(computed(declared))}"


class Printed(NamedTuple):
    """A table as text: the unit of all its entries where they share one, heads, and cells by row."""

    unit: str
    heads: tuple[str, ...]
    cells: list[tuple[str, ...]]


def printed(numbers: Numbers, *, above: bool = True) -> Printed:
    """A table with each unit once: above it, else at the head of its column, else in its cells."""
    columns = list(zip(*numbers.values.tolist(), strict=True)), list(zip(*numbers.units, strict=True))
    shared = [{u for v, u in zip(*column, strict=True) if v} for column in zip(*columns, strict=True)]
    of_all = set().union(*shared)
    if above and len(of_all) <= 1:
        unit, heads, apart = next(iter(of_all), ""), numbers.columns, [True] * len(shared)
    else:
        unit, apart = "", [len(one) <= 1 for one in shared]
        heads = tuple(f"{head} {f'({label(*one)})' if alike and label(*one or ('1',)) else ''}".strip()
                      for head, one, alike in zip(numbers.columns, shared, apart, strict=True))  # fmt: skip
    cells = [
        tuple(cell(v, "1" if alone else u) for v, u, alone in zip(values, units, apart, strict=True))
        for values, units in zip(numbers.values.tolist(), numbers.units, strict=True)
    ]
    return Printed(label(unit), heads, cells)


def cell(value: float, unit: str) -> str:
    """An entry with its unit, to four digits.

    Examples
    --------
    >>> cell(0.0, "kg*m"), cell(47.204, "kg")
    ('0', '47.2 kg')
    """
    return f"{value:.4g} {label(unit)}".rstrip() if value else "0"
