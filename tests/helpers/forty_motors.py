"""A catalogue of forty motors that drive directly, alike but for their idle current and mass, and one controller."""

import math
from collections.abc import Callable
from pathlib import Path
from string import Template

MOTORS = 40
_TEXT = Template(Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8"))


def catalogue(idle_current: Callable[[int], float], thermal: str, more: str = "") -> str:
    """Its text: m00 to m39, each a gram heavier than the one before.

    Parameters
    ----------
    idle_current
        Of a motor by its number [A], dry; its no-load speed follows from it, so that torque and speed constant are one.
    thermal
        Both thermal resistances, with their unit.
    more
        Further figures of the controller.
    """
    rows = []
    for n in range(MOTORS):
        rpm = (24 - 0.35 * idle_current(n)) / 0.098 * 30 / math.pi
        rows.append(f"      - [m{n:02}, {idle_current(n):.2f}, {rpm:.6f}, {98 * idle_current(n):.6f}, {300 + n}]")
    return _TEXT.substitute(rows="\n".join(rows), thermal=thermal, more=f", {more}" if more else "")
