"""The catalogues of motors without a gearhead: against the rows of their sources, and what follows from these.

Allied Motion and T-Motor come from MGDB, Pittman from the maker's sheets.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from drivesizer.catalog import DIRECT, Catalog, load
from drivesizer.catalog.tables import as_printed

TURN = 2 * math.pi
RPM = TURN / 60  # rad/s
GCM2 = 1e-7  # kg*m^2

MOTORS = {"allied_motion": 148, "tmotor": 10, "pittman": 4}


@pytest.fixture(scope="module", params=MOTORS)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def one(name: str) -> Catalog:
    return as_printed(load([name]))


@pytest.fixture(scope="module")
def allied() -> Catalog:
    return load(["allied_motion"])


@pytest.fixture(scope="module")
def tmotor() -> Catalog:
    return load(["tmotor"])


@pytest.fixture(scope="module")
def pittman() -> Catalog:
    return as_printed(load(["pittman"]))


# --- all three -----------------------------------------------------------------------------------------------------


def test_every_motor_drives_the_load_itself(name: str, one: Catalog) -> None:
    assert len(one.motors) == MOTORS[name]
    assert one.gearheads["part"].tolist() == [DIRECT]
    assert one.motor_gearhead.left.tolist() == list(range(MOTORS[name]))
    assert set(one.gearheads["part"][one.motor_gearhead.right].tolist()) == {DIRECT}


def test_no_figure_is_infinite(one: Catalog) -> None:
    """The source writes Inf for a limit that it does not know."""
    for field, column in one.motors.columns.items():
        if column.dtype.kind == "f":
            assert not np.isinf(column).any(), field


# --- Allied Motion -------------------------------------------------------------------------------------------------

ALLIED = {
    "MF0060032_300V": {
        "nominal_voltage": 300, "torque_constant": 0.5, "resistance": 9.42, "inductance": 3.56e-3, "mass": 0.41,
        "rotor_inertia": 6.4e-5, "no_load_speed": 560, "nominal_current": 1.58, "peak_torque": 10.5,
        "thermal_resistance_housing": 2.75,
    },
    "MF0127056_48V": {
        "nominal_voltage": 48, "torque_constant": 0.47, "resistance": 0.25, "inductance": 0.49e-3, "mass": 2.86,
        "rotor_inertia": 1.7e-3, "no_load_speed": 98, "nominal_current": 8.3 / 0.47, "peak_torque": 67,
        "thermal_resistance_housing": 0.82,
    },
    "MF0255100_150V": {
        "nominal_voltage": 150, "torque_constant": 2.508, "resistance": 0.15, "inductance": 1.016e-3, "mass": 20.49,
        "rotor_inertia": 0.038, "no_load_speed": 56, "nominal_current": 104.8 / 2.508, "peak_torque": 703,
        "thermal_resistance_housing": 0.235,
    },
    "HT00800-A00": {
        "nominal_voltage": 24, "torque_constant": 0.012, "resistance": 6.88, "inductance": 0.62e-3, "mass": 0.01,
        "rotor_inertia": 4.95e-8, "no_load_speed": 1916, "nominal_current": 0.008 / 0.012, "peak_torque": 0.033,
        "thermal_resistance_housing": 21.1,
    },
    "HT05005-A00": {
        "nominal_voltage": 100, "torque_constant": 2.18, "resistance": 4.83, "inductance": 27.56e-3, "mass": 3.36,
        "rotor_inertia": 6.3e-4, "no_load_speed": 44, "nominal_current": 9.02 / 2.18, "peak_torque": 28.2,
        "thermal_resistance_housing": 0.8,
    },
}  # fmt: skip


@pytest.mark.parametrize("part", ALLIED)
def test_allied_rows_as_in_the_source(allied: Catalog, part: str) -> None:
    motor = allied.motors.record(allied.motors.rows[part])
    for field, figure in ALLIED[part].items():  # speeds and currents are rounded to four digits
        rounding = 5e-4 if field in ("no_load_speed", "nominal_current") else 1e-9
        assert getattr(motor, field) == pytest.approx(figure, rel=rounding), field


# --- T-Motor -------------------------------------------------------------------------------------------------------

TMOTOR = {
    "G35 KV100": {
        "nominal_voltage": 16, "torque_constant": 0.1, "resistance": 3.33, "inductance": 2.1e-3, "mass": 0.159,
        "rotor_inertia": 6.1e-6, "no_load_speed": 1500 * RPM,
    },
    "G60 KV055": {
        "nominal_voltage": 24, "torque_constant": 0.188, "resistance": 1.1, "inductance": 0.9e-3, "mass": 0.364,
        "rotor_inertia": 3.55e-5, "no_load_speed": 1150 * RPM,
    },
    "U8 KV100": {
        "nominal_voltage": 36, "rotor_inertia": 1.2e-4, "peak_torque": 3.332, "friction_torque": 9.1e-3,
        "viscous_friction": 1.6e-4, "thermal_resistance_winding": 0.5, "thermal_resistance_housing": 4.2, "mass": 0.24,
    },
}  # fmt: skip


@pytest.mark.parametrize("part", TMOTOR)
def test_tmotor_rows_as_in_the_source(tmotor: Catalog, part: str) -> None:
    motor = tmotor.motors.record(tmotor.motors.rows[part])
    for field, figure in TMOTOR[part].items():
        assert getattr(motor, field) == pytest.approx(figure, rel=1e-9), field


def test_tmotor_constant_is_that_of_the_name(tmotor: Catalog) -> None:
    """k_t KV = 1 within 10 %: the constants are terminal to terminal. Per phase it would be 0.58 or 1.5."""
    name = np.array([float(part.partition("KV")[2]) * RPM for part in tmotor.motors["part"]])
    product = tmotor.motors["torque_constant"] * name
    assert ((product > 0.97) & (product < 1.11)).all()


def test_the_u8_is_converted_from_phase_to_terminals(tmotor: Catalog) -> None:
    """Torque and copper loss stay: 0.14 N*m/A at 7.6 A, and 1.5 x 0.186 ohm (7.6 A)^2 of a three-phase machine."""
    row = tmotor.motors.rows["U8 KV100"]
    motor = tmotor.motors.record(row)
    assert motor.torque_constant * motor.nominal_current == pytest.approx(0.14 * 7.6, rel=1e-3)
    assert motor.resistance * motor.nominal_current**2 == pytest.approx(1.5 * 0.186 * 7.6**2, rel=1e-3)
    assert motor.inductance / motor.resistance == pytest.approx(0.138e-3 / 0.186, rel=1e-3)
    confidence = tmotor.confidence("motors", row)
    derived = {"torque_constant", "resistance", "inductance", "nominal_current", "speed_constant"}
    assert {field for field, how in confidence.items() if how == "derived"} == derived


# --- Pittman -------------------------------------------------------------------------------------------------------


def test_a_pittman_row_as_printed(pittman: Catalog) -> None:
    motor = pittman.motors.record(pittman.motors.rows["9233S013"])
    printed = {
        "no_load_speed": 5993 * RPM, "nominal_torque": 33e-3, "stall_torque": 0.22, "torque_constant": 37.3e-3,
        "friction_torque": 4.2e-3, "viscous_friction": 2.3e-6, "rotor_inertia": 32 * GCM2,
        "max_winding_temperature": 155 + 273.15, "thermal_resistance_housing": 19.1, "mass": 0.252,
    }  # fmt: skip
    for field, figure in printed.items():
        assert getattr(motor, field) == pytest.approx(figure, rel=1e-9), field
    confidence = pittman.confidence("motors", pittman.motors.rows["9233S013"])
    derived = {"nominal_voltage", "resistance", "thermal_resistance_winding"}
    assert {field for field, how in confidence.items() if how == "derived"} == derived
    assert set(confidence.values()) == {"derived", "quoted"}


def test_pittman_resistance_is_that_of_the_motor_constant(pittman: Catalog) -> None:
    """K_M = k_t / sqrt(R), as the sheets print it in N*m/sqrt(W), three digits."""
    printed = {"9233S013": 1.88e-2, "14201S003": 3.14e-2, "14203S010": 5.56e-2, "14204S004": 6.09e-2}
    motors = pittman.motors
    for part, constant in printed.items():
        motor = motors.record(motors.rows[part])
        assert motor.torque_constant / math.sqrt(motor.resistance) == pytest.approx(constant, rel=3e-3)
