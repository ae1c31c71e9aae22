r"""The catalogue with its motors as a spec mounts them: another thermal resistance from housing to ambient.

Data sheets give the thermal resistance from housing to ambient, R_th2, of one mounting: on a plastic plate (maxon),
alone in air, on a plate of aluminium (servo motors). In another it is R', and the housing's time constant changes
with it, for its heat capacity stays. The continuous current that heat permits at the nominal speed, with the loss P of
friction and iron at the housing, is

.. math:: I' = I_N \sqrt{\frac{T_{max} - T_a - R' P}{T_{max} - T_a - R_{th2} P} \cdot
          \frac{R_{th1} + R_{th2}}{R_{th1} + R'}}

Checked by data sheets that print both: of 150 of 184 maxon DCX and EC-i motors the torque at rest with half R_th2
(operating ranges of their pages) is that by the square root within 8 %, median 1 % more; 34 brushed ones gain less
than 5 %, as their brushes set the rating. Faulhaber 3564 B (data sheet): 3.68, 2.50, 1.71 and 1.36 A at 22 000 rpm
with R_th2 reduced by 55 %; three of the four windings within 1.5 % of what their own figures permit, one within 6 %.
Symbols: R_th thermal resistance [K/W], I current [A], P loss [W], T temperature [K].
Its band makes two catalogues, as that of an estimate does: the favourable and the unfavourable end.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.estimates.assumed import MOUNTED
from drivesizer.catalog.tables import Catalog, Estimates, Table
from drivesizer.physics.figures import Figures
from drivesizer.physics.stress import housing_loss
from drivesizer.physics.thermal import rated_ambient

__all__ = ["Housing", "rating_gain", "with_mounting"]

Array = NDArray[np.float64]
Housing = Callable[[Array], Any]  # thermal resistance as mounted, of that as printed
_CHANGED = ("thermal_resistance_housing", "motor_time_constant", "nominal_current", "nominal_torque")


def with_mounting(catalog: Catalog, housings: tuple[Housing, Housing, Housing]) -> Catalog:
    """The catalogue with the thermal figures and ratings of its motors as they are mounted."""
    nominal, easy, hard = housings
    ends = catalog.ends or (catalog, catalog)
    middle = _with_housing(catalog, nominal, brushes=False)
    found = replace(
        middle, ends=(_with_housing(ends[0], easy, brushes=False), _with_housing(ends[1], hard, brushes=True))
    )
    return replace(found, estimates=_estimates(found))


def _with_housing(catalog: Catalog, housing: Housing, *, brushes: bool) -> Catalog:
    motors: Table[Any] = catalog.motors
    printed = motors["thermal_resistance_housing"]
    mounted = housing(printed)
    gain, of_one = rating_gain(motors, mounted), float(housing(np.ones(1))[0])
    unknown, gain = np.isnan(gain), np.where(np.isnan(gain), 1.0, gain)
    at_most = np.where(np.isnan(printed), np.inf, printed / mounted) if of_one < 1.0 else np.ones(len(motors))
    at_most = np.where(unknown & (of_one != 1.0), at_most, np.nan)
    if brushes:  # may set the rating, where heat would permit more
        gain = np.where(motors["kind"] == "brushed", np.minimum(gain, 1.0), gain)
    factors = {"motor_time_constant": mounted / printed, "nominal_current": gain, "nominal_torque": gain}
    columns = dict(motors.columns) | {name: motors[name] * factor for name, factor in factors.items()}
    columns |= {"thermal_resistance_housing": mounted, "mounted_gain": at_most}
    return replace(catalog, motors=replace(motors, columns=columns), mounted=True)


def rating_gain(motor: Figures, mounted: Array) -> Array:
    """Continuous current of motors in another mounting, over their nominal one, as heat sets it."""
    one, two = motor["thermal_resistance_winding"], motor["thermal_resistance_housing"]
    speed = motor["nominal_speed"]
    dry, growing = housing_loss(motor, np.ones(len(speed)))
    loss = np.nan_to_num(dry * speed + growing * speed**2)
    rise = motor["max_winding_temperature"] - rated_ambient(motor)
    with np.errstate(invalid="ignore", divide="ignore"):
        left = np.maximum(rise - mounted * loss, 0.0) / (rise - two * loss)
        left = np.where((rise > two * loss), left, 1.0)  # else friction alone is more than what the figures permit
        gain: Array = np.sqrt(left * (one + two) / (one + mounted))
    return gain


def _estimates(catalog: Catalog) -> dict[str, dict[str, Estimates]]:
    """The catalogue's estimates, those of the changed figures as they are mounted, where they have a band."""
    found = {section: dict(figures) for section, figures in catalog.estimates.items()}
    inside = catalog.motors["inside"]
    for name in _CHANGED:
        value, *ends = (each.motors[name] for each in (catalog, *catalog.ends))
        banded = ~np.isnan(value) & (ends[0] != ends[1])
        for section, rows in (("motors", np.flatnonzero(banded & (inside == ""))),
                              ("actuators", np.flatnonzero(banded & (inside != "")))):  # fmt: skip
            known = found.setdefault(section, {})
            known.pop(name, None)
            if len(rows):
                own = rows if section == "motors" else [catalog.actuators.rows[part] for part in inside[rows].tolist()]
                low, high = np.sort([end[rows] for end in ends], axis=0)
                known[name] = Estimates(np.array(own), value[rows], low, high, np.full(len(rows), MOUNTED))
    return found
