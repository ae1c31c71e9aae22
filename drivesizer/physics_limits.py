"""What the load cycle asks of candidates, against every limit that their catalogue figures set, as columns.

Limits are those of the catalogues; no factor of the paper enters. A figure that is missing makes its check
*unknown*. Steady winding temperature: copper loss alone, resistance growing with it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.checks import CheckColumn, at_most
from drivesizer.choose import usable_voltage
from drivesizer.physics import AtGearhead, Demands, peak_voltage
from drivesizer.spec import RobotSpec
from drivesizer.thermal import COPPER, DATA_TEMPERATURE, current_derating, steady_winding_temperature

__all__ = ["Stress", "limits", "stress"]


class Stress(NamedTuple):
    """What the currents do to each candidate's motor."""

    winding: NDArray[np.float64]  # K, steady mean; infinite when it runs away
    voltage: NDArray[np.float64]  # V, the largest, with the winding cold and hot


def stress(spec: RobotSpec, at: AtGearhead, asked: Demands, motor: Any, gearhead: Any) -> Stress:
    """Winding temperature and voltage of candidates.

    Parameters
    ----------
    spec
        The robot.
    at, asked
        The load cycle, and what it asks of the candidates' motors.
    motor, gearhead
        Figures of the candidates' parts by field name: columns.
    """
    ambient, R = spec.environment.ambient, motor["resistance"]
    R_th = motor["thermal_resistance_winding"] + motor["thermal_resistance_housing"]
    winding = np.vectorize(steady_winding_temperature, otypes=[float])(ambient, R, R_th, asked.rms_current)
    known = np.where(np.isfinite(winding), winding, ambient)  # where heat is unknown the voltage is that of the cold
    at_ambient, hot = (R * (1.0 + COPPER * (T - DATA_TEMPERATURE)) for T in (ambient, known))
    volts = np.maximum(*(peak_voltage(at, asked, motor, gearhead, r) for r in (at_ambient, hot)))
    return Stress(winding, volts)


def limits(
    spec: RobotSpec,
    at: AtGearhead,
    asked: Demands,
    under: Stress,
    motor: Any,
    gearhead: Any,
    encoder: Any,
    controller: Any,
) -> list[CheckColumn]:
    """The checks of candidates behind one belt.

    Parameters
    ----------
    spec
        The robot.
    at
        The load cycle at the gearhead's output.
    asked
        What it asks of the candidates' motors.
    under
        Temperature and voltage that follow.
    motor, gearhead, encoder, controller
        Figures of the candidates' parts by field name: columns, NaN where there is no such part.
    """
    rms, rotary = asked.rms_current, ("rotary_speed", "rpm")
    usable = usable_voltage(spec.supply.lowest, controller["max_duty"], controller["voltage_drop"])
    peak = at_most("controller_peak_current", asked.peak_current, controller["peak_current"], "current", "A")
    return [
        *_gearhead(at, gearhead),
        at_most("motor_speed", asked.peak_speed, motor["max_speed"], *rotary),
        *_heat(spec, motor, rms, under.winding),
        at_most("supply_voltage", under.voltage, usable, "voltage", "V"),
        at_most("controller_continuous_current", rms, controller["continuous_current"], "current", "A"),
        replace(peak, time=asked.peak_time),
        at_most("encoder_speed", asked.peak_speed, encoder["max_speed"], *rotary),
        *_lost_motion(spec, at, gearhead),
    ]


def _lost_motion(spec: RobotSpec, at: AtGearhead, gearhead: Any) -> list[CheckColumn]:
    if spec.needs.backlash_at_load is None:
        return []
    return [at_most("backlash_at_load", gearhead["backlash"] / at.belt, spec.needs.backlash_at_load, "angle", "deg")]


def _gearhead(at: AtGearhead, gearhead: Any) -> list[CheckColumn]:
    torque, rotary, i = ("torque", "N*m"), ("rotary_speed", "rpm"), gearhead["ratio"]
    return [
        at_most("gearhead_continuous_torque", at.rms_torque, gearhead["continuous_torque"], *torque),
        at_most("gearhead_intermittent_torque", at.peak_torque, gearhead["intermittent_torque"], *torque),
        at_most("gearhead_continuous_speed", at.sustained_speed * i, gearhead["continuous_input_speed"], *rotary),
        at_most("gearhead_intermittent_speed", at.peak_speed * i, gearhead["intermittent_input_speed"], *rotary),
        at_most("gearhead_continuous_power", at.mean_power, gearhead["continuous_power"], "power", "W"),
        at_most("gearhead_intermittent_power", at.peak_power, gearhead["intermittent_power"], "power", "W"),
    ]


def _heat(spec: RobotSpec, motor: Any, rms: NDArray[Any], winding: NDArray[Any]) -> list[CheckColumn]:
    """Winding temperature, its margin one of rises over the ambient, and nominal current."""
    ambient, limit = spec.environment.ambient, motor["max_winding_temperature"]
    rise = at_most("winding_temperature", winding - ambient, limit - ambient, "temperature", "degC")
    rise = replace(rise, demand=winding, limit=limit, failed=rise.failed | np.isinf(winding))
    derating = np.vectorize(current_derating, otypes=[float])(ambient, limit)
    return [rise, at_most("motor_nominal_current", rms, motor["nominal_current"] * derating, "current", "A")]
