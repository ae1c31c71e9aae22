"""A catalogue of forty motors that drive directly, alike but for their idle current and mass, and one controller."""

import math
from collections.abc import Callable

MOTORS = 40
_TEXT = """
catalog: 1
manufacturer: maker
sources: {sheet: {document: a sheet, confidence: quoted}}
motors:
  - family: D
    source: sheet
    common: {kind: brushed, nominal_voltage: 24 V, max_winding_temperature: 155 degC, ambient_min: -20 degC,
      ambient_max: 100 degC, max_speed: 6000 rpm, nominal_speed: 1500 rpm, nominal_current: 8 A, resistance: 0.35 ohm,
      torque_constant: 98 mN*m/A, rotor_inertia: 900 g*cm^2, winding_time_constant: 25 s,
      thermal_resistance_winding: THERMAL, thermal_resistance_housing: THERMAL, motor_time_constant: 700 s}
    columns: [part, no_load_current (A), no_load_speed (rpm), friction_torque (mN*m), mass (g)]
    rows:
ROWS
controllers:
  - family: C
    source: sheet
    common: {drives: both, supply_min: 10 V, supply_max: 50 V, max_duty: 95 %, voltage_drop: 0 V, peak_time: 10 s,
      buses: CANopenMORE}
    columns: [part, continuous_current (A), peak_current (A)]
    rows:
      - [only, 8, 20]
compatibility:
  motor_gearhead:
    - {source: sheet, motors: [D], gearheads: [direct]}
"""


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
    filled = _TEXT.replace("ROWS", "\n".join(rows)).replace("THERMAL", thermal)
    return filled.replace("MORE", f", {more}" if more else "")
