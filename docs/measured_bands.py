"""Whose figure a line of the table is, and how far the program's own tolerance classes let it be off.

A band has the ends that a prediction's error may have, predicted over measured less 1, where each figure behind it is
as far off as its class permits, all at once: what lies outside is no matter of scatter.
"""

from __future__ import annotations

import re
from itertools import product
from math import prod
from typing import NamedTuple

from measured_models import part

from drivesizer.catalog.tolerances.classes import classes

__all__ = ["Source", "source_of"]

SERVO = "robotis", "MX-106 12 V"  # whose gears the table has
CATALOGUE, PAGE = "the catalogue", "this page: "


class Source(NamedTuple):
    """Of a line of the table."""

    whose: str  # the program's or the catalogue's figure, or the page's own formula from the catalogue's
    powers: dict[str, int]  # of what the class says of a figure, in predicted over measured; none: no band


# What a line's quantity begins with, the first that fits. A class has factors of the printed figure: measured is
# predicted times them, so a resistance that is 10 % larger than printed makes an error of 1/1.1 - 1.
_SOURCES = {
    r"MX-\d+, free speed at": Source("the program's torque-speed line", {"torque_constant": 1}),
    r"MX-\d+, free speed over": Source(f"{PAGE}that line, by the voltage", {"torque_constant": 1}),
    r"MX-106, resistance": Source(CATALOGUE, {"resistance": -1}),
    r"MX-106, current while lifting": Source(f"{PAGE}V / R", {"resistance": 1}),
    r"MX-106, lifted torque": Source(
        f"{PAGE}i k_t e V / R", {"resistance": 1, "torque_constant": -1, "efficiency": -1}
    ),
    r"MX-106, torque per ampere": Source(f"{PAGE}i k_t e", {"torque_constant": -1, "efficiency": -1}),
    r"MX-106, the same without": Source(f"{PAGE}i k_t", {}),
    r"MX-106, gear efficiency": Source(CATALOGUE, {"efficiency": -1}),
    r"RI50, torque per ampere": Source(CATALOGUE, {"torque_constant": -1}),
    r"RI50, voltage per speed": Source("the program's back-EMF constant", {"torque_constant": -1}),
    r"RI50, (power at|both motors at) stall": Source(f"{PAGE}R I², R hot", {"resistance": -1}),
    r"RI50, the same with the cold": Source(f"{PAGE}R I², R at 25 °C", {}),
    r"RI50, no-load current": Source("the program", {}),
    r"RI50, the same, (flat|in proportion)": Source("the program's friction", {"friction": -1}),
    r"RI50, power without load": Source(f"{PAGE}R I² + k_t I w, R hot", {"resistance": -1, "torque_constant": -1}),
    r"RI50, winding temperature": Source("the program", {}),
    r"RI50, (the same, two bodies|carried)": Source("the program's two bodies, fitted", {}),
}


def source_of(quantity: str) -> tuple[str, tuple[float, float] | None]:
    """Whose figure a line has, and the ends of its band [1].

    Raises
    ------
    KeyError
        When a line is in no source's care.
    """
    for start, (whose, powers) in _SOURCES.items():
        if re.match(start, quantity):
            return whose, _band(powers)
    raise KeyError(quantity)


def _band(powers: dict[str, int]) -> tuple[float, float] | None:
    if not powers:
        return None
    together = "resistance" in powers and powers.get("torque_constant") == powers["resistance"]
    sides = [[end**power for end in _ends(figure)] for figure, power in powers.items()]
    if together:  # shares of one sum: it is off by no more than either is
        both = [end for side in sides for end in side]
        return min(both) - 1.0, max(both) - 1.0
    products = [prod(ends) for ends in product(*sides)]
    return min(products) - 1.0, max(products) - 1.0


def _ends(figure: str) -> tuple[float, float]:
    """Least and largest factor of a printed figure; of an efficiency by what it loses."""
    (factor,) = (one.factor for one in classes() if one.figure == figure)
    assert factor is not None
    if figure != "efficiency":
        return factor.low, factor.high
    e = part(*SERVO)["efficiency"]
    return (1.0 - (1.0 - e) * factor.high) / e, (1.0 - (1.0 - e) * factor.low) / e
