"""A catalogue of a few made-up parts, a maker's table and the map that reads it, as texts to be changed."""

__all__ = ["CATALOGUE", "MAP", "TABLE"]

CATALOGUE = """\
catalog: 1
manufacturer: Anymaker
sources: {s: {document: data sheet, confidence: quoted, url: "https://example.org", date: "2024-05"}}
motors:
- family: M 25
  source: s
  common: {kind: brushed, diameter: 25 mm}
  columns: [part, nominal_voltage (V), no_load_speed (rpm), no_load_current (mA), nominal_speed (rpm), nominal_torque (mN*m), nominal_current (A), stall_torque (mN*m), stall_current (A), resistance (ohm), inductance (mH), torque_constant (mN*m/A), speed_constant (rpm/V), rotor_inertia (g*cm^2), thermal_resistance_housing (K/W), thermal_resistance_winding (K/W), winding_time_constant (s), motor_time_constant (s), max_winding_temperature (degC), max_speed (rpm), mass (g), price (EUR)]
  rows:
  - [m1, 24, 9500, 37, 8400, 28, 1.2, 240, 10, 2.4, 0.24, 24, 398, 11, 14, 3, 12, 610, 155, 14000, 130, 100]
  - [m2, 24, 5000, 120, 4600, 400, 9, 6000, 130, 0.18, 0.08, 45, 212, 900, 3, 1, 30, 1500, 155, 9000, 1100, 400]
gearheads:
- family: G 26
  source: s
  common: {kind: planetary}
  columns: [part, reduction, ratio, stages, continuous_torque (N*m), intermittent_torque (N*m), efficiency (%), mass (g), inertia (g*cm^2), continuous_input_speed (rpm), intermittent_input_speed (rpm), backlash (deg)]
  rows:
  - [g1, "5:1", 5, 1, 8, 12, 90, 60, 0.5, 8000, 9000, 0.7]
  - [g2, "27:1", 3249/121, 2, 30, 50, 80, 77, 0.5, 8000, 12000, 0.9]
encoders:
- family: E 1
  source: s
  columns: [part, counts_per_turn, channels, max_frequency (kHz), max_speed (rpm), mass (g)]
  rows: [[e1, 500, 3, 200, 20000, 20]]
controllers:
- family: C 1
  source: s
  common: {drives: brushed, buses: CANopen}
  columns: [part, supply_min (V), supply_max (V), continuous_current (A), peak_current (A), peak_time (s), pwm_frequency (kHz), max_duty (%)]
  rows: [[c1, 10, 50, 5, 15, 10, 50, 90], [c2, 10, 60, 50, 100, 3, 50, 90]]
compatibility:
  motor_gearhead: [{motors: [M 25], gearheads: [G 26, direct], source: s}]
  motor_encoder: [{motors: [M 25], encoders: [E 1], source: s}]
"""  # noqa: E501

TABLE = """\
Order no.,Name,Voltage,Speed,Current,R,Mass
,,V,rpm,mA,ohm,g
1001,M 16,12,8000,20,5.5,40
1002,M 16,24,8100,10,22,40
"""
MAP = """\
manufacturer: Anymaker
source: {name: sheet, document: data sheet, confidence: quoted, date: "2024-05"}
unknown: ["-", n/a]
common: {kind: brushed, diameter: 16 mm}
columns: {Order no.: part, Name: family, Voltage: nominal_voltage, Speed: no_load_speed, Current: no_load_current,
          R: resistance, Mass: mass}
"""
