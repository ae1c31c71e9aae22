"""Tolerance classes of catalogue figures: the defaults, and those that a maker or a spec puts in their place.

A class is a distribution of factors of the printed figure. Figures that belong together share one: the two thermal
resistances of a motor with their time constants, so that heat capacities stay what they are; friction at any speed and
with it, and the no-load current that includes both.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import resources
from typing import NamedTuple

import numpy as np
import yaml

from drivesizer.catalog.tolerances.distributions import Distribution
from drivesizer.catalog.tolerances.factors import share

__all__ = [
    "CLASSES",
    "NOT_OF_STEPPERS",
    "OF_STEPPERS",
    "Class",
    "class_from_stall",
    "class_of",
    "classes",
    "losses_from_stall",
]

_PER_STAGE = 4.0  # ratio of a pair of spur gears, where the number of stages is unknown
_PAIRS = 4.0  # of a spur gear whose ratio is unknown

CLASSES = {
    ("motor", "resistance"): "Motor resistance",
    ("motor", "torque_constant"): "Motor torque constant",
    ("motor", "friction"): "Motor friction and iron loss",
    ("motor", "dry_friction"): "Dry share of motor friction",
    ("motor", "rotor_inertia"): "Rotor inertia",
    ("motor", "thermal_resistance"): "Motor thermal resistances",
    ("motor", "pull_out"): "Pull-out torque",
    ("motor", "holding_torque"): "Holding torque",
    ("motor", "inductance"): "Phase inductance",
    ("motor", "start_speed"): "Start speed without a ramp",
    ("gearhead", "peak_torque"): "Peak torque by stall",
    ("gearhead", "efficiency"): "Gearhead losses",
    ("gearhead", "inertia"): "Gearhead inertia",
    ("controller", "losses"): "Controller losses",
    ("controller", "phase_current"): "Phase current set",
}
OF_STEPPERS = {("motor", figure) for figure in ("pull_out", "holding_torque", "inductance", "start_speed")} | {
    ("controller", "phase_current")
}
NOT_OF_STEPPERS = {
    *(("motor", figure) for figure in ("torque_constant", "friction", "dry_friction", "thermal_resistance")),
    ("controller", "losses"),
}


class Class(NamedTuple):
    """Tolerance of one kind of catalogue figure."""

    part: str  # motor, gearhead or controller
    figure: str
    title: str
    text: str  # as written
    factor: Distribution | None  # of the printed figure; None: taken as printed
    why: str
    whose: str = ""  # a maker, maybe with families: of its parts alone; else of all that have none of their own

    @property
    def name(self) -> str:
        """``motor.resistance``; with whose it is where it is of a maker."""
        return f"{self.part}.{self.figure}" + (f" ({self.whose})" if self.whose else "")


@cache
def _default() -> dict[str, dict[str, dict[str, str]]]:
    text = (resources.files("drivesizer.catalog.tolerances") / "classes.yaml").read_text(encoding="utf-8")
    found: dict[str, dict[str, dict[str, str]]] = yaml.safe_load(text)
    return found


@cache
def class_of(part: str, figure: str, text: str, why: str, whose: str = "") -> Class:
    """The class of a figure."""
    title = CLASSES[part, figure] + (f", {whose}" if whose else "")
    return Class(part, figure, title, text, share(text), why, whose)


def class_from_stall(figure: str) -> Class:
    """The class of a resistance that is nominal voltage over stall current, or of a torque constant beside it."""
    one = _default()["from_stall"][figure]
    return class_of("motor", figure, one["tolerance"], one["why"], "from no load and stall")


def losses_from_stall(part: str, efficiency: float, ratio: float, stages: float) -> Class:
    """The class of a spur gear's losses where its efficiency follows from the stall torque."""
    one = _default()["from_stall"]["efficiency"]
    usual = share(one["tolerance"])
    assert usual is not None
    pairs = (
        stages if stages > 0.0 else _PAIRS if np.isnan(ratio) else max(1.0, round(np.log(ratio) / np.log(_PER_STAGE)))
    )
    plastic = (float(one["per_stage"]) ** -pairs - 1.0) / (1.0 / efficiency - 1.0)
    text = f"{usual.low - 1.0:.0%}..{max(usual.high, plastic) - 1.0:.0%}".replace("%", " %")
    return class_of("gearhead", "efficiency", text, one["why"], part)


def classes(given: Mapping[tuple[str, str], str] | None = None) -> tuple[Class, ...]:
    """The classes for parts whose maker states no tolerance, in a fixed order.

    Examples
    --------
    >>> found = classes({("motor", "resistance"): "+- 7 %", ("motor", "friction"): "none"})
    >>> [(one.text, one.why) for one in found if one.why == "given in the spec"]
    [('+- 7 %', 'given in the spec'), ('none', 'given in the spec')]
    """
    found = []
    for part, figure in CLASSES:
        own = (given or {}).get((part, figure))
        text = own or _default()[part][figure]["tolerance"]
        why = "given in the spec" if own else _default()[part][figure]["why"]
        found.append(class_of(part, figure, text, why))
    return tuple(found)
