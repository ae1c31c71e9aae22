"""The shipped maxon catalogue: how much there is, what is left out and why, and rows against pages as printed."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from drivesizer.catalog import Catalog, Motor, Table

TURN = 2 * math.pi
RPM = TURN / 60  # rad/s


@pytest.fixture(scope="module")
def motors(catalog: Catalog) -> Table[Motor]:
    return catalog.motors


@pytest.fixture(scope="module")
def offered(motors: Table[Motor]) -> NDArray[np.bool_]:
    return ~motors.excluded


# --- identities ----------------------------------------------------------------------------------------------------


def test_no_motor_is_offered_without_the_figures_that_size_it(motors: Table[Motor], offered: NDArray[np.bool_]) -> None:
    """What they say of each other is proved for every catalogue in test_catalog_check.py."""
    for name in ("torque_constant", "resistance", "rotor_inertia", "no_load_speed", "no_load_current", "stall_torque"):
        assert not np.isnan(motors[name][offered]).any()


def test_the_excluded_motors_are_those_that_break_the_law_and_say_why(catalog: Catalog, motors: Table[Motor]) -> None:
    assert set(motors["part"][motors.excluded].tolist()) == {"350909", "370416", "370418", "370427"}
    for part in motors["part"][motors.excluded]:
        reasons = [note.text for note in catalog.notes_on("motors", str(part)) if note.exclude]
        assert len(reasons) == 1 and "integrated electronics" in reasons[0]
        motor = motors.record(motors.rows[str(part)])
        assert motor.torque_constant * motor.no_load_speed < 0.75 * motor.nominal_voltage  # the controller's limit
        assert motor.stall_current < 0.25 * motor.nominal_voltage / motor.resistance


def test_excluded_gearheads_are_those_without_figures(catalog: Catalog) -> None:
    gearheads = catalog.gearheads
    odd = (gearheads["family"] == "GPX 19 LN") & (gearheads["stages"] == 4)  # 90 % in four stages, torques swapped
    assert (gearheads.excluded & ~odd).sum() == 25 and odd.sum() == (gearheads.excluded & odd).sum() == 14
    assert np.isnan(gearheads["continuous_torque"][gearheads.excluded & ~odd]).all()
    assert not np.isnan(gearheads["ratio"][~gearheads.excluded]).any()
    for part in gearheads["part"][gearheads.excluded]:
        assert any(note.exclude and note.text for note in catalog.notes_on("gearheads", str(part)))


# --- rows as printed -----------------------------------------------------------------------------------------------

PRINTED = {
    # 24 V, 20 W, graphite; figures that drivesizer's sources quote
    "118752": {
        "nominal_voltage": 24, "assigned_power": 20, "no_load_speed": 9560 * RPM, "no_load_current": 36.9e-3,
        "nominal_current": 1.16, "stall_torque": 243e-3, "stall_current": 10.4, "max_efficiency": 0.85,
        "resistance": 2.32, "inductance": 0.238e-3, "torque_constant": 23.4e-3, "speed_constant": 408 * RPM,
        "rotor_inertia": 10.8e-7, "diameter": 0.025, "mass": 0.13, "nominal_speed": 8330 * RPM,
        "nominal_torque": 26.3e-3, "speed_torque_gradient": 40.3 * RPM / 1e-3, "mechanical_time_constant": 4.55e-3,
        "thermal_resistance_winding": 3.1, "thermal_resistance_housing": 14, "winding_time_constant": 12.5,
        "motor_time_constant": 612, "ambient_min": 243.15, "ambient_max": 373.15, "max_winding_temperature": 398.15,
        "max_speed": 14000 * RPM, "max_axial_load": 3.2, "max_radial_load": 16, "radial_load_distance": 5e-3,
        "commutator_segments": 11,
    },
    # RE 30, 24 V, 60 W
    "268214": {
        "nominal_voltage": 24, "assigned_power": 60, "no_load_speed": 8810 * RPM, "no_load_current": 165e-3,
        "nominal_speed": 8050 * RPM, "nominal_torque": 85.6e-3, "nominal_current": 3.47, "stall_torque": 1020e-3,
        "resistance": 0.611, "inductance": 0.119e-3, "torque_constant": 25.9e-3, "speed_constant": 369 * RPM,
        "rotor_inertia": 33.5e-7, "thermal_resistance_housing": 6, "winding_time_constant": 16.3,
        "motor_time_constant": 593, "max_winding_temperature": 398.15, "max_speed": 12000 * RPM, "mass": 0.26,
    },
    # 12 V, 10 W, precious metal
    "118743": {
        "nominal_voltage": 12, "assigned_power": 10, "no_load_speed": 4860 * RPM, "no_load_current": 26.3e-3,
        "nominal_speed": 3800 * RPM, "nominal_torque": 28.6e-3, "nominal_current": 1.24, "stall_torque": 129e-3,
        "stall_current": 5.5, "resistance": 2.18, "torque_constant": 23.4e-3, "speed_constant": 407 * RPM,
        "speed_torque_gradient": 37.7 * RPM / 1e-3, "mechanical_time_constant": 4.25e-3, "rotor_inertia": 10.3e-7,
        "winding_time_constant": 12, "motor_time_constant": 612, "max_winding_temperature": 373.15,
        "ambient_min": 253.15, "ambient_max": 358.15,
    },
    # A-max 32, and a brushless one
    "236662": {
        "nominal_voltage": 24, "no_load_speed": 6460 * RPM, "no_load_current": 42.8e-3, "nominal_speed": 5060 * RPM,
        "nominal_torque": 45.5e-3, "stall_torque": 212e-3, "resistance": 3.99, "torque_constant": 35.2e-3,
        "speed_torque_gradient": 30.8 * RPM / 1e-3, "rotor_inertia": 45.3e-7, "thermal_resistance_winding": 2.1,
        "thermal_resistance_housing": 7.5, "max_speed": 6000 * RPM, "mass": 0.24, "price": 158.64,
    },
    "283858": {
        "nominal_voltage": 24, "no_load_speed": 12900 * RPM, "nominal_torque": 22.7e-3, "resistance": 3.44,
        "torque_constant": 17.4e-3, "rotor_inertia": 4.45e-7, "pole_pairs": 1, "max_winding_temperature": 428.15,
    },
}  # fmt: skip


@pytest.mark.parametrize("part", PRINTED)
def test_motors_as_printed(motors: Table[Motor], part: str) -> None:
    motor = motors.record(motors.rows[part])
    for name, figure in PRINTED[part].items():
        assert getattr(motor, name) == pytest.approx(figure, rel=1e-12), name


def test_what_is_not_known_of_the_papers_motor_is_unknown_and_what_is_worked_out_says_so(catalog: Catalog) -> None:
    row = catalog.motors.rows["118752"]
    motor = catalog.motors.record(row)
    assert math.isnan(motor.price)
    confidence = catalog.confidence("motors", row)
    assert {name for name, how in confidence.items() if how == "derived"} == {"length"}
    assert set(confidence.values()) == {"derived", "secondary"}
    assert motor.nominal_torque == pytest.approx(23.4e-3 * (1.16 - 0.0369), rel=2e-3)  # k_t (I_N - I_0)
    assert motor.speed_torque_gradient == pytest.approx(2.32 / 23.4e-3**2, rel=5e-3)  # R / k_t^2


def test_the_papers_gearhead_as_printed(catalog: Catalog) -> None:
    gearhead = catalog.gearheads.record(catalog.gearheads.rows["406764"])
    assert (gearhead.family, gearhead.reduction, gearhead.kind) == ("GP 26 A", "27:1", "planetary")
    assert gearhead.ratio == 3249 / 121
    assert gearhead.continuous_input_speed == pytest.approx(8000 * RPM)
    assert (gearhead.continuous_torque, gearhead.intermittent_torque) == (2.25, 3.2)
    assert gearhead.efficiency == pytest.approx(0.80)
    assert gearhead.mass == pytest.approx(0.077)
    assert gearhead.backlash == pytest.approx(math.radians(0.7))
    assert gearhead.inertia == pytest.approx(0.54e-7)


def test_the_paper_is_the_source_of_its_own_set(catalog: Catalog) -> None:
    """RE 25, GP 26 A and the MR encoder go together because the paper says so."""
    motor = catalog.motors.rows["118752"]
    for relation, right, part in (("motor_gearhead", "gearheads", "406764"), ("motor_encoder", "encoders", "225778")):
        pairs, row = getattr(catalog, relation), catalog.table(right).rows[part]
        found = np.flatnonzero((pairs.left == motor) & (pairs.right == row))
        assert len(found) == 1
        source = catalog.sources[pairs.source[found[0]]]
        assert "10.3390/app11146631" in source.url, part
        assert source.confidence == "quoted"
    encoder = catalog.encoders.record(catalog.encoders.rows["225778"])
    assert (encoder.family, encoder.counts_per_turn) == ("MR type ML", 500)
    assert encoder.inertia == pytest.approx(0.7e-7)  # the code wheel of 225780, which has 1000 counts
