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

import yaml

from drivesizer.catalog.tolerances.distributions import Distribution
from drivesizer.catalog.tolerances.factors import share

__all__ = ["CLASSES", "Class", "class_of", "classes"]

CLASSES = {
    ("motor", "resistance"): "Motor resistance",
    ("motor", "torque_constant"): "Motor torque constant",
    ("motor", "friction"): "Motor friction and iron loss",
    ("motor", "rotor_inertia"): "Rotor inertia",
    ("motor", "thermal_resistance"): "Motor thermal resistances",
    ("gearhead", "efficiency"): "Gearhead losses",
    ("gearhead", "inertia"): "Gearhead inertia",
}


class Class(NamedTuple):
    """Tolerance of one kind of catalogue figure."""

    part: str  # motor or gearhead
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
    """The class of a figure.

    Parameters
    ----------
    part, figure
        One of ``CLASSES``.
    text
        The tolerance, as ``factors.share`` reads it.
    why
        Where it comes from.
    whose
        Maker, of whose parts alone it is.

    Returns
    -------
    Class
        With the distribution that the text describes.
    """
    title = CLASSES[part, figure] + (f", {whose}" if whose else "")
    return Class(part, figure, title, text, share(text), why, whose)


def classes(given: Mapping[tuple[str, str], str] | None = None) -> tuple[Class, ...]:
    """The classes for parts whose maker states no tolerance, in a fixed order.

    Parameters
    ----------
    given
        Tolerances of a spec in place of the defaults, by part and figure.

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
