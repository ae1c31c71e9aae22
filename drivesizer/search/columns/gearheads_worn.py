"""Life and shocks of gearheads over a load cycle, as columns over them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.elements.gear_life import gear_life
from drivesizer.physics.extremes import distinct
from drivesizer.results.check_columns import CheckColumn, at_most
from drivesizer.spec.robot import RobotSpec

__all__ = ["life_of_gearheads", "shock_limits"]

STRAIN_WAVE = "strain wave"  # kind of the gears whose teeth can jump


def life_of_gearheads(cycle: AtGearhead, gearhead: Any, rated: str = "rated_life") -> NDArray[np.float64]:
    """Nominal life of gearheads by their rated life, at rated torque and speed.

    Parameters
    ----------
    cycle
        The load cycle at the gearhead's output.
    gearhead
        Columns over candidates by field name.
    rated
        Which of the rated lives: ``rated_life`` or ``median_life``.

    Returns
    -------
    array
        Life [s], rests of the cycle included; NaN unknown, infinite without a gearhead.
    """
    life, exponent = gearhead[rated], gearhead["life_exponent"]
    speed = np.where(np.isnan(gearhead["rated_speed"]), gearhead["continuous_input_speed"], gearhead["rated_speed"])
    found = np.full(np.shape(life), np.nan)
    for p in distinct(exponent[~np.isnan(exponent)]).tolist():
        turned = cycle.turned(p) * gearhead["ratio"]
        found = np.where(exponent == p, gear_life(life, gearhead["continuous_torque"], speed, turned, p), found)
    return np.where(np.isposinf(life), np.inf, found)


def shock_limits(spec: RobotSpec, torque: float, cycle: AtGearhead, gearhead: Any) -> list[CheckColumn]:
    """Torque of an emergency stop or a collision against what gearheads withstand a few times in their life.

    Parameters
    ----------
    spec
        The machine, or one of its load cases.
    torque
        At the load's shaft [N*m].
    cycle
        The load cycle at the gearhead's output.
    gearhead
        Columns over candidates by field name.

    Returns
    -------
    list[CheckColumn]
        Emergency stop torque, and that at which the teeth of strain wave gears jump.
    """
    at_output = torque / (cycle.belt * (spec.gear.ratio if spec.gear else 1.0))
    jumps = np.where(gearhead["kind"] == STRAIN_WAVE, gearhead["ratcheting_torque"], np.inf)
    needed = spec.margins.torque
    return [
        at_most("gearhead_emergency_torque", at_output, gearhead["emergency_torque"], needed=needed),
        at_most("gearhead_ratcheting", at_output, jumps, needed=needed),
    ]
