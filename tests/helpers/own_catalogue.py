"""A catalogue as a user drops it on the live page: a strong, light motor that drives its load without a gearhead."""

from __future__ import annotations

__all__ = ["CONTRADICTORY", "HOSTILE", "RIGHT"]

RIGHT = """\
catalog: 1
manufacturer: Anymaker
sources:
  sheet: {document: "data sheet, page 3", confidence: quoted, date: "2024-05", url: "https://example.org/a"}
motors:
- family: OWN 40
  source: sheet
  common: {kind: brushed, nominal_voltage: 24 V, resistance: 0.3 ohm, torque_constant: 80 mN*m/A,
    no_load_speed: 2860 rpm, no_load_current: 100 mA, nominal_torque: 800 mN*m, nominal_current: 10 A,
    rotor_inertia: 500 g*cm^2, max_speed: 4000 rpm}
  columns: [part, mass (g)]
  rows: [[OWN-1, 10], [OWN-2, 20]]
compatibility:
  motor_gearhead:
  - {motors: [OWN 40], gearheads: [direct], source: sheet}
"""
"""No-load speed (24 V - 0.3 ohm 0.1 A)/(80 mN*m/A) = 2861 rpm."""
CONTRADICTORY = RIGHT.replace("2860 rpm", "5000 rpm").replace("0.3 ohm", "0.3 ohm, stall_torque: 1 N*m")
HOSTILE = RIGHT.replace("OWN 40", '"<img src=x onerror=alert(1)>"').replace("Anymaker", '"<b>Any</b>"')
