"""One inertia at the motor's shaft, with gearhead, encoder and brake in it, wherever a drive is computed."""

from __future__ import annotations

from dataclasses import replace
from math import isnan, nan

import pytest

from drivesizer.control.drive_train import drive_train
from drivesizer.machine.set_cycle import turned
from drivesizer.physics.cycle_at_gearhead import ACCELERATION
from drivesizer.sizing import size
from drivesizer.spec.robot import load_spec

PARTS = """catalog: 1
manufacturer: Anymaker
sources: {sheet: {document: a sheet, confidence: quoted}}
motors:
  - family: M
    source: sheet
    common: {kind: brushed, nominal_voltage: 24 V, no_load_speed: 4000 rpm, no_load_current: 200 mA,
      nominal_speed: 3500 rpm, nominal_current: 6 A, resistance: 0.3 ohm, inductance: 0.1 mH,
      torque_constant: 57 mN*m/A, max_speed: 9000 rpm, max_winding_temperature: 155 degC,
      thermal_resistance_winding: 1 K/W, thermal_resistance_housing: 2 K/W, winding_time_constant: 30 s,
      motor_time_constant: 900 s, ambient_min: -20 degC, ambient_max: 100 degC}
    columns: [part, rotor_inertia (g*cm^2), mass (g)]
    rows: [[M1, 140, 500]]
gearheads:
  - family: G
    source: sheet
    common: {kind: planetary, stages: 2, direction: 1, continuous_input_speed: 8000 rpm, continuous_power: 500 W,
      intermittent_power: 900 W, intermittent_input_speed: 9000 rpm, inertia: 9 g*cm^2, backlash: 1 deg,
      temperature_min: -40 degC, temperature_max: 100 degC, mass: 400 g}
    columns: [part, reduction, ratio, efficiency (%), continuous_torque (N*m), intermittent_torque (N*m)]
    rows: [[G35, "35:1", 35, 75, 9, 14]]
encoders:
  - family: E
    source: sheet
    columns: [part, counts_per_turn, max_frequency (kHz), max_speed (rpm), inertia (g*cm^2), mass (g)]
    rows: [[E1, 500, 500, 20000, 7, 20]]
brakes:
  - family: B
    source: sheet
    common: {supply: 24 V, power: 8 W, max_speed: 9000 rpm, emergency_stops: 2000}
    columns: [part, static_torque (N*m), dynamic_torque (N*m), inertia (g*cm^2), mass (g), engage_time (ms)]
    rows: [[B1, 0.3, 0.2, 12, 120, 15]]
controllers:
  - family: C
    source: sheet
    common: {drives: both, supply_min: 10 V, supply_max: 50 V, continuous_current: 10 A, peak_current: 30 A,
      peak_time: 5 s, max_duty: 98 %, voltage_drop: 0.5 V}
    columns: [part]
    rows: [[C1]]
compatibility:
  motor_gearhead: [{source: sheet, motors: [M], gearheads: [G]}]
  motor_encoder: [{source: sheet, motors: [M], encoders: [E]}]
  motor_brake: [{source: sheet, motors: [M], brakes: [B]}]
"""
LIFT = """name: lift
load: {kind: hoist, mass: 20 kg, drum_diameter: 50 mm, inertia: 2 kg*cm^2}
motion: {speed: 0.2 m/s, acceleration_time: 0.3 s, cruise_time: 1 s, there_and_back: true, rest_time: 2 s}
supply: {nominal: 24 V, accepts: all}
needs: {hold_unpowered: true, inertia_ratio: 10}
select: {catalogs: [parts.yaml], estimates: off}
"""
OWN = (140 + 9 + 7 + 12) * 1e-7  # rotor, gearhead, encoder and brake, kg m^2


@pytest.fixture
def lift(tmp_path):
    (tmp_path / "parts.yaml").write_text(PARTS, encoding="utf-8")
    (tmp_path / "lift.yaml").write_text(LIFT, encoding="utf-8")
    return load_spec(tmp_path / "lift.yaml")


def test_all_that_turns_with_the_motor_counts_everywhere(lift):
    """20 kg at 25 mm and 2 kg cm^2 are 0.0127 kg m^2 at the drum, 35^2 * 168 g cm^2 = 0.02058 are the drive's."""
    found = size(lift)
    (one,) = (*found.sets, *found.misses)
    assert (one.encoder.part, one.brake.part) == ("E1", "B1")
    assert one.inertia() == pytest.approx(OWN) and one.rotors_at_load == pytest.approx(35**2 * OWN)
    (ratio,) = (check for check in one.checks if check.name == "inertia_ratio")
    assert ratio.demand == pytest.approx(0.0127 / (35**2 * OWN))
    assert turned(lift, one)[1].coefficients[0, ACCELERATION] == pytest.approx(35 * OWN)
    train, _ = drive_train(lift, one, 1e-3)
    assert train.motor_inertia == pytest.approx(OWN)


def test_an_unknown_inertia_is_unknown_or_left_out(lift):
    found = size(lift)
    (one,) = (*found.sets, *found.misses)
    bare = replace(one, gearhead=replace(one.gearhead, inertia=nan), encoder=replace(one.encoder, inertia=nan))
    assert isnan(bare.inertia()) and bare.inertia(unknown=0.0) == pytest.approx(152e-7)
    assert replace(one, encoder=replace(one.encoder, inertia=nan)).inertia() == pytest.approx(161e-7)
