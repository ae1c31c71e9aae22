"""What the load cycle asks of candidates, against every limit that their catalogue figures set, as columns.

Limits are those of the catalogues; no factor of the paper enters. A figure that is missing makes its check
*unknown*. Steady winding temperature: copper loss alone, resistance growing with it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.checks import CheckColumn, at_most
from drivesizer.physics import AtGearhead, Demands, demands, peak_voltage
from drivesizer.results import Check
from drivesizer.spec import RobotSpec
from drivesizer.thermal import COPPER, DATA_TEMPERATURE, current_derating, steady_winding_temperature

__all__ = ["METHOD", "TITLES", "limits", "record"]

METHOD = "physics"
TITLES = {
    "gearhead_continuous_torque": "Gearhead continuous torque (RMS)",
    "gearhead_intermittent_torque": "Gearhead intermittent torque",
    "gearhead_continuous_speed": "Gearhead continuous input speed",
    "gearhead_intermittent_speed": "Gearhead intermittent input speed",
    "gearhead_continuous_power": "Gearhead continuous power",
    "gearhead_intermittent_power": "Gearhead intermittent power",
    "motor_speed": "Motor permissible speed",
    "winding_temperature": "Winding temperature, steady",
    "motor_nominal_current": "Motor nominal current (RMS)",
    "supply_voltage": "Motor voltage, cold and hot",
    "controller_continuous_current": "Controller continuous current",
    "controller_peak_current": "Controller peak current",
    "encoder_speed": "Encoder speed",
}


def limits(
    spec: RobotSpec, at: AtGearhead, motor: Any, gearhead: Any, encoder: Any, controller: Any
) -> tuple[Demands, list[CheckColumn]]:
    """Demands of candidates behind one belt, and their checks.

    Parameters
    ----------
    spec
        The robot.
    at
        The load cycle at the gearhead's output.
    motor, gearhead, encoder, controller
        Figures of the candidates' parts by field name: columns, NaN where there is no such part.
    """
    asked = demands(at, motor, gearhead, encoder)
    rms, rotary = asked.rms_current, ("rotary_speed", "rpm")
    heat, hot = _heat(spec, motor, rms)
    cold = motor["resistance"] * (1.0 + COPPER * (spec.environment.ambient - DATA_TEMPERATURE))
    volts = np.maximum(*(peak_voltage(at, asked, motor, gearhead, r) for r in (cold, hot)))
    usable = np.maximum(controller["max_duty"] * (spec.supply.lowest - controller["voltage_drop"]), 0.0)
    return asked, [
        *_gearhead(at, gearhead),
        at_most("motor_speed", asked.peak_speed, motor["max_speed"], *rotary),
        *heat,
        at_most("supply_voltage", volts, usable, "voltage", "V"),
        at_most("controller_continuous_current", rms, controller["continuous_current"], "current", "A"),
        at_most("controller_peak_current", asked.peak_current, controller["peak_current"], "current", "A"),
        at_most("encoder_speed", asked.peak_speed, encoder["max_speed"], *rotary),
    ]


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


def _heat(spec: RobotSpec, motor: Any, rms: NDArray[Any]) -> tuple[list[CheckColumn], NDArray[Any]]:
    """Winding temperature and nominal current; also the resistance of the hot winding [ohm]."""
    ambient, limit = spec.environment.ambient, motor["max_winding_temperature"]
    R_th = motor["thermal_resistance_winding"] + motor["thermal_resistance_housing"]
    winding = np.vectorize(steady_winding_temperature, otypes=[float])(ambient, motor["resistance"], R_th, rms)
    rise = at_most("winding_temperature", winding - ambient, limit - ambient, "temperature", "degC")
    rise = replace(rise, demand=winding, limit=limit, failed=rise.failed | np.isinf(winding))
    derating = np.vectorize(current_derating, otypes=[float])(ambient, limit)
    current = at_most("motor_nominal_current", rms, motor["nominal_current"] * derating, "current", "A")
    hot = motor["resistance"] * (1.0 + COPPER * (np.where(np.isfinite(winding), winding, ambient) - DATA_TEMPERATURE))
    return [rise, current], hot


def record(column: CheckColumn, index: int, asked: Demands) -> Check:
    """The check of one candidate, the peaks of current and voltage with their time."""
    at_time = float(asked.peak_time[index]) if column.name == "controller_peak_current" else None
    return column.at(index, METHOD, title=TITLES[column.name], at_time=at_time)
