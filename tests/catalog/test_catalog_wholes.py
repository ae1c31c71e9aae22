"""The checker's laws of actuators, brakes, steppers, belts, pulleys, screws and batteries, on an invented catalogue."""

from __future__ import annotations

import numpy as np
import pytest
from broken_catalogs import about, alone, broken, held_to, laws_of, with_cells
from rows import hold

from drivesizer.catalog import PARTS, Catalog, load
from drivesizer.catalog.laws import LAWS, Law, check
from drivesizer.catalog.parts import printed

# Actuators: V = 24 V, R = 1.2 ohm, so I_A = 20 A; I_0 = 0.5 A, I_N = 5.5 A, I_peak = 15.5 A, k_m = 50 mN*m/A,
# J = 200 g*cm^2; with the ratio i and the efficiency e
#   k = i e k_m, M_H = 19.5 k, M_N = 5 k, M_peak = 15 k, w_0 = (24 - 0.6) / (i k_m), w_N = (24 - 6.6) / (i k_m)
#   A10: k = 0.40, M_H = 7.8,    M_N = 2.0,  M_peak = 6.0,   w_0 = 46.8, w_N = 34.8, i^2 J = 2e-3
#   A20: k = 0.75, M_H = 14.625, M_N = 3.75, M_peak = 11.25, w_0 = 23.4, w_N = 17.4, i^2 J = 8e-3
#   A30: k = 1.05, M_H = 20.475, M_N = 5.25, M_peak = 15.75, w_0 = 15.6, w_N = 11.6, i^2 J = 18e-3
# Friction: M_c + b w_0 = 0.1 + 0.0032 46.8 = 0.25 N*m = 10 0.05 0.5; 1 / 1.25 = 0.8.
# Output inertia: a tenth more. 0.5 kg in pi/4 60^2 50 mm^3: 3540 kg/m^3; 0.5 kg / (60 mm)^3: 2310 kg/m^3.
# Brakes: 8 to 11 N*m/kg, 0.12 to 0.29 N*m/W, 1.3e6 to 2e6 rad/s^2.
# Steppers: 2 I^2 R = 8, 14.4 and 7.2 W, 20 to 27 W/kg; 1.4 to 1.6 N*m/kg; 2 to 3.75 ms; J / m^(5/3) about 4e-5.
# Belts: 4 kg/m^2 of length x width. Pulleys: 2800 kg/m^3 of (p z)^2 w / 4 pi.
# Batteries: 18, 14.4 and 10.8 W h in 70, 68 and 46 g: 257, 212, 235 W h/kg; 9.6 W h in 85 g: 113; 120 in 3.6 kg: 33.
#   Peukert at 1 h: 5^(1/1.02 - 1) = 0.969 of 5, 4 and 3 A*h; 5^(1/1.01 - 1) = 0.984 of 3 A*h;
#   20^(1/1.2 - 1) = 0.607 of 10 A*h
INVENTED = """
catalog: 1
manufacturer: nobody
sources:
  s: {document: invented, confidence: recalled}
actuators:
- family: A
  source: s
  common: {kind: brushless, gearing: planetary, direction: 1, resistance: 1.2 ohm,
    inductance: 0.6 mH, no_load_current: 0.5 A, nominal_current: 5.5 A, peak_current: 15.5 A,
    motor_torque_constant: 50 mN*m/A, rotor_inertia: 200 g*cm^2, pole_pairs: 7, thermal_resistance_winding: 1.5 K/W,
    thermal_resistance_housing: 3 K/W, winding_time_constant: 10 s, motor_time_constant: 600 s,
    max_winding_temperature: 120 degC, ambient_min: -10 degC, ambient_max: 50 degC, backlash: 0.2 deg,
    data_temperature: 20 degC, rated_ambient: 25 degC, motor_back_emf_constant: 50 mV*s/rad,
    max_radial_load: 100 N, max_axial_load: 50 N, steps_per_turn: 4096, controller: integrated, supply_min: 12 V,
    supply_max: 48 V, standby_current: 30 mA, diameter: 60 mm, length: 50 mm, mass: 500 g}
  columns: [part, reduction, ratio, stages, efficiency (%), torque_constant (N*m/A), stall_torque (N*m),
    nominal_torque (N*m), peak_torque (N*m), no_load_speed (rad/s), nominal_speed (rad/s), max_speed (rad/s),
    output_inertia (kg*m^2), price (EUR), coulomb_friction (N*m), viscous_friction (N*m*s/rad), load_friction (%),
    nominal_voltage (V), stall_current (A), order_number]
  rows:
  - [A10, "10:1", 10, 2, 80, 0.40, 7.8, 2.0, 6.0, 46.8, 34.8, 52, 0.0022, 100, 0.1, 0.0032, 25, 24, 20, A10]
  - [A10 23 V, "10:1", 10, 2, 80, 0.40, 7.467, 2.0, 6.0, 44.8, 32.8, 52, 0.0022, 100, 0.1, 0.0032, 25, 23, 19.17, A10]
  - [A20, "20:1", 20, 2, 75, 0.75, 14.625, 3.75, 11.25, 23.4, 17.4, 26, 0.0088, 120, 0.2, 0.0128, 33.3, 24, 20, ~]
  - [A30, "30:1", 30, 3, 70, 1.05, 20.475, 5.25, 15.75, 15.6, 11.6, 17, 0.0198, 150, 0.3, 0.0288, 42.9, 24, 20, ~]
brakes:
- family: B
  source: s
  common: {holding_power: 3 W, release_time: 40 ms, engage_time: 20 ms, max_speed: 6000 rpm, emergency_stops: 2000,
    backlash: 1 deg, diameter: 60 mm, energy_per_hour: 900 J, total_energy: 20 kJ, energy_per_stop: 90 J,
    dynamic_torque: 0.9 N*m}
  columns: [part, static_torque (N*m), supply (V), power (W), inertia (g*cm^2), added_length (mm), mass (g),
    price (EUR)]
  rows:
  - [B1, 1, 24, 8, 5, 25, 120, 60]
  - [B2, 2, 24, 10, 10, 30, 200, 80]
  - [B4, 4, 24, 14, 30, 35, 350, 110]
steppers:
- family: S
  source: s
  common: {wiring: bipolar, max_radial_load: 50 N, max_axial_load: 15 N, supply_min: 12 V, supply_max: 48 V,
    ambient_min: -20 degC, ambient_max: 50 degC, start_speed: 300 rpm, detent_torque: 20 mN*m}
  columns: [part, full_steps, phase_current (A), holding_torque (N*m), resistance (ohm), inductance (mH),
    rotor_inertia (g*cm^2), diameter (mm), length (mm), shaft_diameter (mm), mass (g), price (EUR)]
  rows:
  - [S1, 200, 2, 0.45, 1.0, 2.0, 60, 42, 40, 5, 300, 20]
  - [S2, 200, 3, 1.1, 0.8, 3.0, 200, 56, 54, 6.35, 700, 30]
  - [S3, 400, 1.5, 0.44, 1.6, 3.2, 65, 42, 41, 5, 320, 25]
belts:
- family: T
  source: s
  common: {profile: HTD, pitch: 5 mm, width: 9 mm}
  columns: [part, teeth, mass (g), price (EUR)]
  rows: [[T60, 60, 10.8, 6], [T80, 80, 14.4, 7], [T100, 100, 18, 8]]
pulleys:
- family: P
  source: s
  common: {profile: HTD, pitch: 5 mm, width: 9 mm, bore: 8 mm}
  columns: [part, teeth, mass (g), price (EUR)]
  rows: [[P20, 20, 20, 10], [P24, 24, 29, 11], [P36, 36, 65, 14]]
screws:
- family: B
  source: s
  common: {kind: ball, starts: 1, efficiency: 90 %, back_efficiency: 80 %, dn_max: 70000, axial_play: 0.05 mm}
  columns: [part, diameter (mm), lead (mm), root_diameter (mm), ball_diameter (mm), pitch_diameter (mm),
    shaft_diameter (mm), dynamic_load (N), static_load (N), permissible_thrust (N), stiffness (N/um), nut_mass (kg),
    mass (kg), price (EUR)]
  rows:
  - [B16, 16, 10, 13, 16.5, 14.5, 15.8, 9000, 17000, 6500, 160, 0.2, 1.5, 90]
  - [B20, 20, 10, 17, 20.7, 18.5, 19.6, 12000, 26000, 9000, 240, 0.3, 2.5, 110]
  - [B25, 25, 10, 22, 25.9, 23, 24.6, 16000, 40000, 15000, 330, 0.4, 3.9, 140]
batteries:
- family: C
  source: s
  common: {chemistry: Li-ion, nominal_voltage: 3.6 V, charge_voltage: 4.2 V, cutoff_voltage: 2.5 V, rated_time: 5 h,
    peukert_exponent: 1.02, max_charge_current: 5 A}
  columns: [part, capacity (A*h), capacity_10h (A*h), capacity_5h (A*h), capacity_1h (A*h), continuous_current (A),
    peak_current (A), resistance (mohm), mass (g), price (EUR)]
  rows:
  - [C5, 5.0, 5.05, 5.0, 4.8, 10, 20, 15, 70, 5]
  - [C4, 4.0, 4.05, 4.0, 3.9, 30, 45, 10, 68, 6]
  - [C3, 3.0, 3.05, 3.0, 2.9, 15, 20, 13, 46, 4.5]
- family: F
  source: s
  common: {chemistry: LiFePO4, nominal_voltage: 3.2 V, charge_voltage: 3.6 V, cutoff_voltage: 2 V, rated_time: 5 h,
    peukert_exponent: 1.01, max_charge_current: 3 A}
  columns: [part, capacity (A*h), capacity_10h (A*h), capacity_5h (A*h), capacity_1h (A*h), continuous_current (A),
    peak_current (A), resistance (mohm), mass (g), price (EUR)]
  rows:
  - [F3, 3.0, 3.05, 3.0, 2.95, 20, 40, 8, 85, 7]
- family: L
  source: s
  common: {chemistry: lead-acid, nominal_voltage: 12 V, charge_voltage: 14.4 V, cutoff_voltage: 10.5 V,
    rated_time: 20 h, peukert_exponent: 1.2, max_charge_current: 3 A}
  columns: [part, capacity (A*h), capacity_10h (A*h), capacity_5h (A*h), capacity_1h (A*h), continuous_current (A),
    peak_current (A), resistance (mohm), mass (g), price (EUR)]
  rows:
  - [L10, 10, 9.4, 8.5, 6.2, 30, 150, 15, 3600, 30]
power_supplies:
- family: P
  source: s
  common: {kind: enclosed, nominal_voltage: 48 V, voltage_min: 46 V, voltage_max: 55 V, peak_time: 4 s, hold_up: 20 ms,
    overvoltage_min: 57 V, overvoltage_max: 65 V, return_voltage: 63 V, efficiency: 93 %}
  columns: [part, continuous_current (A), peak_current (A), mass (g), price (EUR)]
  rows: [[P5, 5, 7.5, 600, 60], [P10, 10, 15, 1100, 90], [P20, 20, 30, 1900, 150]]
brake_resistors:
- family: R
  source: s
  common: {kind: shunt regulator, resistance_min: 1 ohm, resistance_max: 1000 ohm, rated_ambient: 40 degC,
    zero_power_ambient: 90 degC, chopper_voltage_min: 54 V, chopper_voltage_max: 56 V, supply_min: 12 V,
    supply_max: 50 V, max_voltage: 160 V, capacitance: 1000 uF}
  columns: [part, resistance (ohm), min_resistance (ohm), power (W), peak_power (W), pulse_energy (J),
    chopper_current (A), mass (g), price (EUR)]
  rows: [[R25, 12, 10, 25, 260, 250, 5, 160, 60], [R50, 8, 7, 50, 390, 500, 8, 310, 80],
    [R100, 5, 4, 100, 620, 1100, 12, 600, 120]]
"""
WHOLES = (
    "actuators", "brakes", "steppers", "belts", "pulleys", "screws", "batteries", "power_supplies", "brake_resistors",
)  # fmt: skip


@pytest.fixture(scope="module")
def invented(tmp_path_factory: pytest.TempPathFactory) -> Catalog:
    folder = tmp_path_factory.mktemp("catalogue")
    (folder / "invented.yaml").write_text(INVENTED, encoding="utf-8")
    return load(["invented.yaml"], beside=folder)


def test_every_section_is_here_or_in_the_test_of_the_shipped_parts() -> None:
    assert {*WHOLES, "motors", "gearheads", "encoders", "controllers"} == set(PARTS)


def test_consistent_parts_have_no_finding_and_no_unknown_figure(invented: Catalog) -> None:
    assert [f.text() for f in check(invented) if f.grade == "finding"] == []
    for section in WHOLES:
        table = invented.table(section)
        figures = [n for n, c in printed(section).items() if c.kind != "text" and n != "foreign_price"]
        assert [n for n in figures if np.isnan(table[n]).any()] == [], section


def test_every_law_finds_what_breaks_it(invented: Catalog) -> None:
    laws = [law for law in LAWS if law.section in WHOLES]
    hold(_finds_what_breaks_it, {f"{law.section}: {law.name} {n}": (invented, law) for n, law in enumerate(laws)})


def _finds_what_breaks_it(invented: Catalog, law: Law) -> None:
    few, table = alone(invented, law.section), invented.table(law.section)
    for row in range(len(table)):
        part = str(table["part"][row])
        after = held_to(with_cells(few, law.section, row, **broken(law, table, row)), [law])
        hits = [f for f in after if f.part == part and f.identity == law.name]
        if hits:
            assert hits[0].fields[0] == law.figure and hits[0].reason and hits[0].source
            return
    pytest.fail("no part could be made to break it")


# section, part, field, factor, the identity that must notice, as slips happen
SLIPS: list[tuple[str, str, str, float, str]] = [
    ("actuators", "A10", "motor_torque_constant", 3**0.5 / 2**0.5, "stall torque"),  # of effective amperes
    ("actuators", "A10", "stall_torque", 1.1, "stall torque"),  # though 0.5 A may be 0.45 A
    ("actuators", "A10", "torque_constant", 10.0, "torque constant beside i eta k_m, at most"),  # the ratio twice
    ("actuators", "A20", "no_load_speed", 20.0, "no-load speed without friction"),  # the motor's
    ("actuators", "A20", "no_load_speed", 60 / (2 * np.pi), "energy at stall and no load"),  # rpm for rad/s
    ("actuators", "A30", "viscous_friction", 30.0, "no-load current beside (M_c + b w_0) / (i k_m), at least"),  # rpm
    ("actuators", "A30", "load_friction", 10.0, "efficiency beside 1 / (1 + s), at most"),
    ("actuators", "A30", "output_inertia", 1 / 900, "output inertia beside i^2 J, at least"),  # the motor's
    ("actuators", "A30", "stall_torque", 9.80665 / 100, "stall torque"),  # N*m for kgf*cm
    ("actuators", "A30", "nominal_torque", 1.5, "nominal torque without friction"),
    ("actuators", "A30", "mass", 0.01, "mass beside volume, at least"),
    ("brakes", "B2", "static_torque", 1000.0, "torque by mass, at most"),  # mN*m for N*m
    ("brakes", "B2", "inertia", 1e-3, "torque by inertia, at most"),  # g*cm^2 for kg*cm^2
    ("brakes", "B2", "total_energy", 1e-3, "energy per stop and total energy"),  # J for kJ
    ("steppers", "S1", "inductance", 1000.0, "inductance by resistance, at most"),  # uH for mH
    ("steppers", "S1", "rotor_inertia", 100.0, "rotor inertia by mass, at most"),
    ("steppers", "S2", "full_steps", 1.8, "full steps in use"),  # 360
    ("belts", "T80", "pitch", 1.2, "pitch of the profile"),
    ("belts", "T80", "mass", 1000.0, "mass by area, at most"),  # g for kg
    ("pulleys", "P20", "width", 0.1, "width beside pitch, at least"),  # cm for mm
    ("pulleys", "P20", "teeth", 0.25, "teeth, at least"),
    ("batteries", "C4", "capacity", 1000.0, "energy by mass, Li-ion, at most"),  # mA*h for A*h
    ("batteries", "C4", "resistance", 1000.0, "peak current beside V / R, at most"),  # ohm for mohm
    ("batteries", "L10", "capacity_1h", 0.7, "Peukert's law at 1 h, at least"),
    ("batteries", "L10", "capacity_10h", 1.1, "capacity 10 h and capacity"),
]


@pytest.mark.parametrize(("section", "part", "field", "factor", "identity"), SLIPS)
def test_a_slip_is_found(invented: Catalog, section: str, part: str, field: str, factor: float, identity: str) -> None:
    table = invented.table(section)
    row = table.rows[part]
    changed = with_cells(alone(invented, section), section, row, **{field: table[field][row] * factor})
    assert identity in about(held_to(changed, laws_of(section)), part)


def test_a_direct_actuator_may_lose_nothing(invented: Catalog) -> None:
    """No gear: ratio 1 and efficiency 1 are no finding, an efficiency of 1 behind a gear is."""
    for ratio, wrong in ((1.0, False), (10.0, True)):
        changed = with_cells(invented, "actuators", 0, ratio=ratio, efficiency=1.0)
        assert ("efficiency is a share" in about(check(changed), "A10")) == wrong


def test_a_profile_that_is_not_known_has_any_pitch(invented: Catalog) -> None:
    changed = with_cells(invented, "belts", 0, pitch=5.3e-3)
    assert "pitch of the profile" in about(check(changed), "T60")
    assert "pitch of the profile" not in about(check(with_cells(changed, "belts", 0, profile="XYZ")), "T60")


def test_a_capacity_drawn_faster_is_not_held_against_a_slower_one(invented: Catalog) -> None:
    """5 A*h in 5 h, 5.05 A*h in 10 h: no finding; the same with 20 h as the rated time is one."""
    row = invented.batteries.rows["C5"]
    slow = with_cells(invented, "batteries", row, rated_time=20 * 3600.0)
    assert "capacity 10 h and capacity" in about(check(slow), "C5")
