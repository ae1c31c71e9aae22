"""The shipped Faulhaber catalogue: against data sheets as printed; its laws are those of every catalogue."""

from __future__ import annotations

import math

import numpy as np
import pytest

from drivesizer.catalog import Catalog, Motor, Table, load
from drivesizer.catalog.tables import as_printed

RPM = math.pi / 30  # rad/s


@pytest.fixture(scope="module")
def faulhaber() -> Catalog:
    return as_printed(load(["faulhaber"]))


@pytest.fixture(scope="module")
def motors(faulhaber: Catalog) -> Table[Motor]:
    return faulhaber.motors


# --- how much there is ---------------------------------------------------------------------------------------------


def test_pairs(faulhaber: Catalog, motors: Table[Motor]) -> None:
    """Without the 470 gearheads of all sizes that the source lists for each 2214 BXT H and 1509 B."""
    pairs = faulhaber.motor_gearhead
    assert len(pairs.left) == 24646 - 5 * 470
    alone = set(motors["family"].tolist()) - set(motors["family"][pairs.left].tolist())
    assert alone == {"2214 BXT H", "1509 B", "1506 SR", "2607 SR", "2232 BX4S", "2250 BX4S"}
    assert len(set(pairs.right.tolist())) == 644
    sizes = [np.array([int(f[:2]) for f in names]) for names in (motors["family"], faulhaber.gearheads["family"])]
    apart = sizes[0][pairs.left] - sizes[1][pairs.right]  # motor and gearhead are about equally thick
    assert apart.min() >= -18
    assert apart.max() <= 6


# --- rows as printed -----------------------------------------------------------------------------------------------

PRINTED = {
    "1331T012SR": {
        "nominal_voltage": 12, "resistance": 13.7, "no_load_speed": 9900 * RPM, "no_load_current": 10.5e-3,
        "stall_torque": 9.9e-3, "friction_torque": 0.12e-3, "torque_constant": 11.4e-3, "inductance": 310e-6,
        "mechanical_time_constant": 7e-3, "rotor_inertia": 0.67e-7, "thermal_resistance_winding": 6,
        "thermal_resistance_housing": 25, "winding_time_constant": 5, "motor_time_constant": 190,
        "max_winding_temperature": 398.15, "max_speed": 12000 * RPM, "nominal_current": 0.37, "max_efficiency": 0.8,
        "max_radial_load": 1.2, "max_axial_load": 0.2, "diameter": 0.013, "length": 0.0312, "mass": 0.019,
    },
    "1524T006SR": {
        "nominal_voltage": 6, "resistance": 5.1, "no_load_speed": 9500 * RPM, "no_load_current": 13e-3,
        "stall_torque": 6.98e-3, "torque_constant": 6e-3, "rotor_inertia": 0.58e-7, "nominal_torque": 2.9e-3,
        "winding_time_constant": 5.6, "motor_time_constant": 220, "max_speed": 13000 * RPM, "mass": 0.018,
    },
    "0816K003SR": {
        "nominal_voltage": 3, "resistance": 5.4, "no_load_speed": 13250 * RPM, "no_load_current": 16e-3,
        "torque_constant": 2.11e-3, "inductance": 53e-6, "rotor_inertia": 0.051e-7, "nominal_torque": 0.7e-3,
        "nominal_current": 0.37, "nominal_speed": 2540 * RPM, "max_winding_temperature": 358.15, "mass": 0.0045,
    },
    "2250S024BX4S": {
        "nominal_voltage": 24, "resistance": 5.9, "no_load_speed": 10500 * RPM, "no_load_current": 0.105,
        "friction_torque": 0.75e-3, "viscous_friction": 1.4e-7 / RPM, "torque_constant": 21.1e-3,
        "stall_torque": 84.7e-3, "rotor_inertia": 5.3e-7, "motor_time_constant": 443, "pole_pairs": 2,
    },
    "3274G024BP4": {
        "nominal_voltage": 24, "resistance": 0.25, "no_load_speed": 8700 * RPM, "no_load_current": 0.384,
        "nominal_speed": 8260 * RPM, "nominal_current": 6.9, "friction_torque": 2.9e-3,
        "viscous_friction": 8.2e-7 / RPM, "torque_constant": 28.4e-3, "inductance": 60e-6, "rotor_inertia": 48e-7,
        "thermal_resistance_winding": 0.7, "thermal_resistance_housing": 8, "max_speed": 16000 * RPM, "mass": 0.32,
    },
}  # fmt: skip


@pytest.mark.parametrize("part", PRINTED)
def test_motors_as_printed(motors: Table[Motor], part: str) -> None:
    motor = motors.record(motors.rows[part])
    for name, figure in PRINTED[part].items():
        assert getattr(motor, name) == pytest.approx(figure, rel=1e-12), name


def test_a_gearhead_as_given(faulhaber: Catalog) -> None:
    gearhead = faulhaber.gearheads.record(faulhaber.gearheads.rows["32/3R 3.71:1"])
    assert (gearhead.family, gearhead.reduction, gearhead.kind) == ("32/3R", "3.71:1", "planetary")
    assert (gearhead.ratio, gearhead.stages, gearhead.direction) == (3.71, 1, 1)
    assert (gearhead.continuous_torque, gearhead.intermittent_torque, gearhead.efficiency) == (1.0, 1.2, 0.91)
    assert gearhead.mass == pytest.approx(0.16)
    assert math.isnan(gearhead.inertia)
    assert faulhaber.gearheads["inertia"][faulhaber.gearheads.rows["42GPT 11:1"]] == pytest.approx(20e-7)


def test_the_confidence_of_figures(faulhaber: Catalog, motors: Table[Motor]) -> None:
    """Of 1331T006SR the data sheet and MGDB print another current: the rated speed decides for MGDB's."""
    row = motors.rows["1331T006SR"]
    motor, confidence = motors.record(row), faulhaber.confidence("motors", row)
    assert {n for n, how in confidence.items() if how != "quoted"} == {"nominal_current", "nominal_speed"}
    at_rated_speed = (motor.nominal_voltage - motor.torque_constant * motor.nominal_speed) / motor.resistance
    assert motor.nominal_current == pytest.approx(at_rated_speed, rel=0.02)
    assert any("0.81 A" in note.text for note in faulhaber.notes_on("motors", "1331T006SR"))
    assert faulhaber.confidence("motors", motors.rows["3564K024B"])["max_radial_load"] == "quoted"
