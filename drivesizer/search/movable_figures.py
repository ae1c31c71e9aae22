"""Figures of a spec that may move alone so that a drive passes, and which way helps.

Left out are figures of which more helps some drives and less others: diameters, leads, lengths, distances.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from drivesizer.results.problem import Problem
from drivesizer.spec.robot import RobotSpec

__all__ = ["FIGURES", "HOLDING", "MovableFigure", "movable"]


class MovableFigure(NamedTuple):
    """A figure that may move."""

    path: tuple[str, ...]
    kind: str
    unit: str
    direction: int  # +1 when more helps
    rotary: tuple[str, str] | None = None  # kind and unit where the load turns


HOLDING = ("needs", "holding_factor")
FIGURES = (
    MovableFigure(("motion", "speed"), "speed", "m/s", -1, ("rotary_speed", "rpm")),
    MovableFigure(("motion", "acceleration_time"), "time", "s", +1),
    MovableFigure(("motion", "acceleration"), "acceleration", "m/s^2", -1, ("angular_acceleration", "rad/s^2")),
    MovableFigure(("motion", "time"), "time", "s", +1),
    MovableFigure(("motion", "period"), "time", "s", +1),
    MovableFigure(("motion", "rest_time"), "time", "s", +1),
    MovableFigure(("load", "mass"), "mass", "kg", -1),
    MovableFigure(("load", "inertia"), "inertia", "kg*m^2", -1),
    MovableFigure(("load", "torque"), "torque", "N*m", -1),
    MovableFigure(("load", "force"), "force", "N", -1),
    MovableFigure(("load", "friction_torque"), "torque", "N*m", -1),
    MovableFigure(("load", "friction_force"), "force", "N", -1),
    MovableFigure(("load", "friction_coefficient"), "dimensionless", "1", -1),
    MovableFigure(("load", "rolling_resistance"), "dimensionless", "1", -1),
    MovableFigure(("load", "slope"), "angle", "deg", -1),
    MovableFigure(("load", "incline"), "angle", "deg", -1),
    MovableFigure(("supply", "nominal"), "voltage", "V", +1),
    MovableFigure(("supply", "current"), "current", "A", +1),
    MovableFigure(("supply", "power"), "power", "W", +1),
    MovableFigure(("supply", "capacitance"), "capacitance", "mF", +1),
    MovableFigure(("brake_resistor", "power"), "power", "W", +1),
    MovableFigure(("battery", "capacity"), "charge", "A*h", +1),
    MovableFigure(("battery", "autonomy"), "time", "h", -1),
    MovableFigure(("battery", "range"), "length", "km", -1),
    MovableFigure(("budget", "mass"), "mass", "kg", +1),
    MovableFigure(("needs", "backlash_at_load"), "angle", "deg", +1),
    MovableFigure(("needs", "resolution_at_load"), "angle", "deg", +1),
    MovableFigure(("needs", "inertia_ratio"), "dimensionless", "1", +1),
    MovableFigure(("needs", "resonance"), "frequency", "Hz", -1),
    MovableFigure(HOLDING, "dimensionless", "1", -1),
    MovableFigure(("needs", "life"), "time", "h", -1),
    MovableFigure(("needs", "shock_torque"), "torque", "N*m", -1),
    MovableFigure(("needs", "radial_load"), "force", "N", -1),
    MovableFigure(("needs", "axial_load"), "force", "N", -1),
    MovableFigure(("needs", "diameter"), "length", "mm", +1),
    MovableFigure(("needs", "length"), "length", "mm", +1),
    MovableFigure(("needs", "mass"), "mass", "g", +1),
    MovableFigure(("needs", "price"), "price", "EUR", +1),
    MovableFigure(("margins", "torque"), "dimensionless", "%", -1),
    MovableFigure(("margins", "speed"), "dimensionless", "%", -1),
    MovableFigure(("margins", "temperature"), "dimensionless", "%", -1),
)


def movable(problem: Problem) -> Iterator[tuple[MovableFigure, float]]:
    """The figures of a spec that may move, each with what it is now [SI]: in the first load case that has it.

    A friction coefficient of a vehicle is its grip, of which less does not help; a force that helps stays as it is.
    """
    spec = problem.spec
    for figure in FIGURES:
        now = next(
            filter(None, (_given(case, figure) for case in (spec, *(case.spec for case in problem.cases)))), None
        )
        if now is None or (figure.path == HOLDING and not _may_hold_less(spec)):
            continue
        if figure.path == ("load", "friction_coefficient") and spec.load.kind == "wheeled_vehicle":
            continue
        yield figure, now


def _may_hold_less(spec: RobotSpec) -> bool:
    """Whether a drive must hold without power, with a factor above 1: below that nothing is held."""
    return spec.needs.hold_unpowered and spec.needs.holding_factor > 1.0


def _given(spec: RobotSpec, figure: MovableFigure) -> float | None:
    """The figure where a spec has it, and of the sense that its direction means."""
    found: Any = spec
    for name in figure.path:
        found = getattr(found, name, None)
    return found if isinstance(found, float) and found > 0.0 else None
