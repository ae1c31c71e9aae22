"""Specs that have every figure of the schema, and one drive for them whose figures are all printed."""

from __future__ import annotations

from pathlib import Path

PARTS = Path(__file__).with_name("every_figure.yaml").read_text(encoding="utf-8")
_SOLID = "{diameter: 60 mm, inner_diameter: 10 mm, length: 30 mm, density: 7850 kg/m^3, offset: 2 mm}"
_GEAR = "{kind: gear, ratio: 2, efficiency: 0.95, back_efficiency: 0.9, pinion_inertia: 1 kg*cm^2, " \
    "wheel_inertia: 2 kg*cm^2, pinion_friction: 0.05 N*m, wheel_friction: 0.1 N*m, pinion_diameter: 40 mm, " \
    "backlash: 0.2 deg, mass: 1 kg}"  # fmt: skip
_SUPPLY = "supply: {nominal: 48 V, brakes: 24 V, min: 44 V, max: 52 V, resistance: 0.1 ohm, current: 20 A, " \
    "power: 900 W, regeneration: 0.3, capacitance: 1 mF}"  # fmt: skip
_BELT = "load: {kind: belt_axis, mass: 20 kg, pulley_diameter: 60 mm, belt_mass: 1 kg, efficiency: 0.95, " \
    "incline: 60 deg, friction_coefficient: 0.1, friction_force: 5 N, friction_torque: 0.1 N*m, force: 10 N, " \
    "inertia: 2 kg*cm^2, idler_inertia: 1 kg*cm^2, idler_diameter: 50 mm, max_tension: 2 kN}"  # fmt: skip
_RACK = "load: {kind: rack_pinion, mass: 30 kg, pinion_diameter: 50 mm, efficiency: 0.95, incline: 20 deg, " \
    "friction_coefficient: 0.1, friction_force: 5 N, force: 10 N, inertia: 1 kg*cm^2}"  # fmt: skip
_VEHICLE = "load: {kind: wheeled_vehicle, mass: 60 kg, driven_wheels: 4, wheel_diameter: 152 mm, " \
    "rolling_resistance: 0.02, friction_coefficient: 0.5, inertia: 40 kg*cm^2"  # fmt: skip
_ARM = "load: {kind: arm, mass: 5 kg, length: 300 mm, inertia: 0.6 kg*m^2, start_angle: 10 deg, tilt: 5 deg, " \
    "friction_torque: 0.2 N*m}"  # fmt: skip
_BALL = "load: {kind: ball_screw, mass: 50 kg, lead: 10 mm, efficiency: 0.9, back_efficiency: 0.85, incline: 80 deg, " \
    "friction_coefficient: 0.1, friction_force: 20 N, force: 10 N, preload_torque: 0.01 N*m, preload: 100 N, " \
    "diameter: 15 mm, root_diameter: 12.5 mm, shaft_diameter: 14.5 mm, ball_diameter: 15.75 mm, length: 1200 mm, " \
    "screw_length: 1300 mm, ends: fixed-supported, dynamic_load: 9.8 kN, static_load: 25 kN, load_factor: 1.5, " \
    "static_safety: 2, dn_max: 70000}"  # fmt: skip
_SLOW = "motion: {speed: 0.2 m/s, acceleration_time: 0.2 s, deceleration_time: 0.3 s, cruise_time: 1 s, " \
    "rest_time: 0.5 s, there_and_back: true, payload: 2 kg, payload_back: 1 kg}"  # fmt: skip
_TURN = "motion: {profile: move, distance: 90 deg, time: 1 s, acceleration_time: 0.3 s, deceleration_time: 0.4 s, " \
    "rest_time: 0.5 s, there_and_back: true}"  # fmt: skip

SPECS: dict[str, str] = {
    "vehicle": f"""{_VEHICLE}, driven_share: 0.9, slope: 5 deg, drag_area: 0.3 m^2, headwind: 1 m/s,
  air_density: 1.2 kg/m^3, efficiency: 0.95}}
motion: {{speed: 1.5 m/s, acceleration_time: 2 s, deceleration_time: 1.5 s, cruise_time: 20 s, rest_time: 3 s}}
transmission: [{{kind: gearhead}}, {{kind: belt, ratio: 1.1, efficiency: 0.95, inertia: 1 kg*cm^2,
  friction_torque: 0.02 N*m,
  stiffness: 900 N*m/rad, mass: 1 kg, pulley_diameter: 60 mm, max_tension: 900 N, max_speed: 20 m/s}}]
supply: {{nominal: 24 V, min: 22 V, max: 29 V, resistance: 0.05 ohm, current: 60 A, power: 2 kW, regeneration: 0.7}}
battery: {{series: 2, parallel: 2, nominal_voltage: 12 V, capacity: 7 A*h, rated_time: 20 h, peukert_exponent: 1.22,
  cutoff_voltage: 10.5 V, charge_voltage: 14.4 V, resistance: 25 mohm, open_circuit: {{full: 12.9 V, empty: 11.7 V}},
  polarisation: {{resistance: 20 mohm, time_constant: 30 s}}, continuous_current: 21 A, peak_current: 100 A,
  max_charge_current: 2.1 A, mass: 2 kg, start: 0.95, usable: 0.8, health: 0.9, autonomy: 3 h, range: 5 km,
  reserve: 0.1}}
equipment: [{{name: a, power: 15 W, duty: 0.5, peak_power: 30 W, efficiency: 0.9}}, {{name: b, power: 9 W,
  time: 10 min}}]
mission: {{duration: 2 h}}
power_stage: {{voltage_drop: 0.5 V, resistance: 0.05 ohm, standby: 2 W, motor_current: 18 A}}
environment: {{ambient: 30 degC, altitude: 1500 m, gravity: 9.81 m/s^2}}
needs: {{resonance: 5 Hz, inertia_ratio: 9, resolution_at_load: 1 deg, backlash_at_load: 1 deg, bandwidth: 5 Hz,
  diameter: 90 mm, length: 300 mm, mass: 5 kg, price: 900 EUR, holding_factor: 2}}
margins: {{torque: 0.1, speed: 0.1, temperature: 0.1, pull_out: 2}}
paper_factors: {{speed_reserve: 0.9, bearing: 0.9, robot_efficiency: 0.9, confidence: 0.9, oversize: 1.2}}
budget: {{mass: 60 kg, structure: 30 kg, others: [{{name: box, mass: 6 kg}}]}}
control: {{bandwidth: 10 Hz, rate: 1 kHz}}
plant: {{model: two_mass, stiffness: 9000 N*m/rad, damping_ratio: 0.02, backlash: 0.1 deg}}
""",
    "sunk": f"""load: {{kind: wheeled_vehicle, mass: 60 kg, driven_wheels: 4, wheel_diameter: 152 mm, sinkage: 2 mm,
  cylinders: {{wheel: {{density: 1100 kg/m^3, outer_diameter: 152 mm, inner_diameter: 60 mm, width: 50 mm}}}}}}
motion: {{profile: triangle, distance: 5 m, time: 6 s, rest_time: 1 s, there_and_back: true, payload: 2 kg,
  payload_back: 1 kg}}
shaft: {{carries_load: true, distance: 25 mm, wheel_load: 140 N, load_factor: 1.5, static_safety: 1.5}}
{_SUPPLY}
needs: {{life: 20000 h, shock_torque: 40 N*m, radial_load: 20 N, axial_load: 9 N, tilting_moment: 1 N*m}}
""",
    "conveyor": f"""load: {{kind: conveyor, mass: 20 kg, belt_mass: 4 kg, drum_diameter: 90 mm,
  friction_coefficient: 0.3,
  friction_force: 5 N, efficiency: 0.9, incline: 10 deg, force: 9 N, inertia: {_SOLID}}}
motion: {{profile: s_curve, distance: 2 m, speed: 0.5 m/s, acceleration: 1 m/s^2, jerk: 4 m/s^3, rest_time: 1 s,
  there_and_back: true, payload: 2 kg, payload_back: 1 kg}}
transmission: [{{kind: gearhead}}, {_GEAR}]
shaft: {{distance: 25 mm, pressure_angle: 20 deg, helix_angle: 15 deg}}
supply: {{nominal: 48 V, current: 20 A, peak_current: 30 A, peak_time: 5 s, overvoltage_trip: 60 V,
  capacitance: 1 mF}}
needs: {{life: {{gearhead: 9000 h, output_bearing: 8000 h}}, backlash_at_load: 1 deg, shock_torque: 40 N*m,
  inertia_ratio: 9}}
""",
    "hoist": f"""load: {{kind: hoist, mass: 40 kg, counterweight: 15 kg, drum_diameter: 120 mm, falls: 2,
  rope_efficiency: 0.95,
  friction_force: 9 N, friction_torque: 0.2 N*m, inertia: 30 kg*cm^2}}
{_SLOW}
shaft: {{carries_load: true, distance: 25 mm}}
brake: {{torque: 2 N*m, dynamic_torque: 1.5 N*m, inertia: {_SOLID}, power: 12 W, holding_power: 5 W, voltage: 24 V,
  mass: 0.5 kg, length: 30 mm, price: 90 EUR, release_time: 50 ms, engage_time: 20 ms, max_speed: 6000 rpm,
  energy_per_stop: 300 J, total_energy: 90 kJ, emergency_stops: 1000}}
{_SUPPLY}
needs: {{hold_unpowered: true, emergency_stops: 100, holding_factor: 1.5}}
""",
    "ball_screw": f"""{_BALL}
{_SLOW}
shaft: {{carries_load: true}}
supply: {{nominal: 48 V, min: 44 V, max: 52 V, capacitance: 20 uF}}
brake_resistor: {{resistance: 10 ohm, power: 100 W, peak_power: 600 W, pulse_energy: 900 J, chopper_voltage: 60 V,
  chopper_current: 20 A, averaging_time: 30 s}}
needs: {{life: {{screw: 20000 h}}, axial_load: 10 N}}
""",
    "springs along a line": f"""{_RACK.removesuffix("}")}, springs: [{{kind: constant, force: 20 N}},
  {{kind: linear, rate: 90 N/m, force: 20 N}}, {{kind: counterweight, mass: 4 kg}},
  {{kind: gas, force: 50 N, progression: 1.3, stroke: 900 mm, pressed: 600 mm, friction: 8 N}}]}}
{_SLOW}
{_SUPPLY}
""",
    "springs about an axis": f"""{_ARM.removesuffix("}")}, springs: [{{kind: constant, torque: 1 N*m}},
  {{kind: torsion, rate: 2 N*m/rad, torque: 1 N*m}},
  {{kind: counterweight, mass: 2 kg, length: 200 mm, angle: 170 deg}},
  {{kind: linear, rate: 9 N/mm, force: -90 N, ends: {{radius: 50 mm, anchor: 150 mm, angle: -50 deg}}}}]}}
{_TURN}
{_SUPPLY}
""",
    "winder": f"""load: {{kind: winder, tension: 90 N, thickness: 0.5 mm, width: 300 mm, density: 900 kg/m^3,
  core_diameter: 80 mm, start_diameter: 100 mm, taper: 0.2, friction_torque: 0.3 N*m, inertia: 9 kg*cm^2}}
motion: {{speed: 1 m/s, acceleration_time: 1 s, cruise_time: 20 s}}
{_SUPPLY}
""",
    "lead_screw": f"""load: {{kind: lead_screw, mass: 9 kg, lead: 4 mm, thread_friction: 0.15, incline: 80 deg,
  diameter: 20 mm,
  root_diameter: 15.5 mm, pitch_diameter: 18 mm, length: 500 mm, permissible_thrust: 2 kN}}
motion: {{profile: segments, segments: [{{time: 0.3 s, to: 60 mm/s, payload: 2 kg}}, {{time: 1 s}}, {{time: 0.4 s,
  to: 0 m/s}},
  {{time: 0.5 s, payload: 1 kg}}, {{time: 0.3 s, to: -60 mm/s}}, {{time: 1 s}}, {{time: 0.4 s, to: 0 m/s}}]}}
{_SUPPLY}
""",
    "by_distance": f"""{_RACK}
motion: {{distance: 400 mm, speed: 0.5 m/s, acceleration: 2 m/s^2, rest_time: 1 s}}
{_SUPPLY}
""",
    "rack_pinion": f"""{_RACK}
motion: {{profile: move, distance: 400 mm, time: 1 s, acceleration_time: 0.3 s, deceleration_time: 0.4 s,
  rest_time: 0.5 s,
  there_and_back: true, payload: 2 kg, payload_back: 1 kg}}
shaft: {{carries_load: true, distance: 25 mm, pressure_angle: 20 deg, helix_angle: 15 deg, static_safety: 2,
  load_factor: 1.2}}
{_SUPPLY}
needs: {{life: {{output_bearing: 9000 h}}, radial_load: 10 N, tilting_moment: 2 N*m}}
""",
    "belt_axis": f"""{_BELT}
{_SLOW}
transmission: [{{kind: gearhead}}, {_GEAR}, {{kind: belt, ratio: 1.5, efficiency: 0.9, stiffness: 900 N*m/rad}}]
{_SUPPLY}
needs: {{resonance: 5 Hz, backlash_at_load: 1 deg}}
""",
    "pulley": f"""{_BELT}
motion: {{profile: harmonic, amplitude: 100 mm, period: 2 s}}
shaft: {{carries_load: true, distance: 25 mm, belt_pretension: 300 N}}
brake: {{torque: 20 N*m, at: load, power: 12 W, total_energy: 20 kJ, engage_time: 30 ms}}
{_SUPPLY}
needs: {{emergency_stops: 10}}
""",
    "rotary_table": f"""load: {{kind: rotary_table, inertia: 0.3 kg*m^2, friction_torque: 0.2 N*m, torque: 1 N*m,
  mass: 3 kg,
  eccentricity: 100 mm, tilt: 30 deg, start_angle: 20 deg}}
{_TURN}
transmission: [{{kind: gearhead}}, {{kind: worm, ratio: 10, efficiency: 0.7, back_efficiency: 0.3}}]
{_SUPPLY}
""",
    "arm": f"""{_ARM}
{_TURN}
{_SUPPLY}
""",
    "recorded": f"""load: {{kind: recorded, file: level.csv, smoothing: 2 s, inertia: 2 kg*cm^2}}
{_SUPPLY}
""",
    "cam": f"""load: {{kind: rack_pinion, mass: 30 kg, pinion_diameter: 50 mm}}
motion: {{profile: cam, file: cam.csv, master_speed: 30 rpm, smoothing: 0.5 s}}
{_SUPPLY}
""",
    "turned_screw": f"""load: {{kind: ball_screw, mass: 5 kg, lead: 5 mm, efficiency: 0.9, inertia: 1 kg*cm^2}}
{_SLOW}
{_SUPPLY}
""",
    "held": f"""load: {{kind: hoist, mass: 9 kg, drum_diameter: 90 mm}}
motion: {{profile: hold, time: 9 s}}
{_SUPPLY}
""",
    "flywheel": f"""load: {{kind: flywheel, inertia: [{_SOLID}, {{shape: block, length: 100 mm, width: 80 mm,
  thickness: 20 mm,
  density: 2700 kg/m^3}}, {{shape: point, mass: 1 kg, offset: 50 mm}}], rated_torque: 2 N*m, rated_speed: 100 rpm,
  exponent: 2, friction_torque: 0.1 N*m}}
motion: {{profile: segments, segments: [{{time: 1 s, to: 90 rpm}}, {{time: 1 s, to: 0 rpm}}]}}
{_SUPPLY}
""",
    "stepper": f"""load: {{kind: rotary_table, inertia: 1e-3 kg*m^2, friction_torque: 0.05 N*m}}
{_TURN}
supply: {{nominal: 24 V, min: 22 V, max: 26 V, current: 6 A, power: 90 W, regeneration: 0.3, capacitance: 1 mF}}
control: {{microsteps: 8, damping_ratio: 0.2}}
needs: {{start_speed: 9 rpm, resolution_at_load: 1 deg}}
""",
}


def text_of(name: str) -> str:
    """A whole spec."""
    kind = ", motor: {kind: stepper}" if name == "stepper" else ""
    return f"name: {name}\n{SPECS[name]}select: {{catalogs: [parts.yaml]{kind}}}\n"
