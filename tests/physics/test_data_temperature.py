"""Figures hold at the temperature that a catalogue states: Faulhaber's at 22 degC, Beckhoff's at 20, maxon's at 25."""

from dataclasses import asdict
from math import isnan, nan, sqrt

import numpy as np
import pytest

from drivesizer.catalog import load
from drivesizer.catalog.catalog_file import parse
from drivesizer.catalog.parts import Motor
from drivesizer.errors import CatalogError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.physics.thermal import (
    continuous_current,
    current_derating,
    rated_ambient,
    resistance_25,
    resistance_at,
    steady_winding_temperature,
    two_bodies,
)
from drivesizer.results.ratings import nominal_current_limit

ALPHA, CELSIUS = 0.0039, 273.15

OWN = """
catalog: 1
manufacturer: M
data_temperature: 22 degC
sources: {s: {document: invented, confidence: recalled}}
motors:
- {family: F, source: s, columns: [part, resistance (ohm)], rows: [[A, 1]]}
- {family: G, source: s, common: {data_temperature: 20 degC}, columns: [part, resistance (ohm)], rows: [[B, 1]]}
actuators:
- {family: H, source: s, columns: [part, resistance (ohm)], rows: [[C, 1]]}
"""


@pytest.fixture(scope="module")
def motors():
    return {name: load([name]).motors for name in ("faulhaber", "maxon", "beckhoff")}


def of(table, part):
    return table.record(table.rows[part])


def test_the_copper_law_starts_from_the_temperature_of_the_data(motors):
    """By hand: 2.83 ohm at 22 degC; alpha is of 25 degC, so 2.83/(1 - 0.0117) there and 1.0585 times that at 40."""
    figures = asdict(of(motors["faulhaber"], "1331T006SR"))
    R_25 = resistance_25(figures)
    assert resistance_at(R_25, 22 + CELSIUS) == pytest.approx(2.83, rel=1e-14)
    assert resistance_at(R_25, 40 + CELSIUS) == pytest.approx(2.83 / 0.9883 * 1.0585, rel=1e-14)
    assert two_bodies(figures).R_25 == R_25
    # the winding at 0.4 A in 22 degC: rise x = R_th R_d I^2 (1 + b x), with b that of 22 degC
    rise = 31.0 * 2.83 * 0.4**2
    found = steady_winding_temperature(22 + CELSIUS, R_25, 6.0, 25.0, 0.4)
    assert found - 22 - CELSIUS == pytest.approx(rise / (1.0 - ALPHA / 0.9883 * rise), rel=1e-12)


def test_a_maxon_motor_is_as_it_was(motors):
    motor = of(motors["maxon"], "118752")
    assert motor.data_temperature == 25 + CELSIUS and resistance_25(asdict(motor)) == motor.resistance == 2.32


@pytest.mark.parametrize("part", ["0816K003SR", "0816K006SR", "0816K009SR"])
def test_faulhabers_rated_currents_are_those_of_22_degc(motors, part):
    """The data sheet of the 0816 SR prints 0.37, 0.19 and 0.13 A; its heat in 25 degC would make 0.36, 0.18, 0.12."""
    motor = of(motors["faulhaber"], part)
    figures, R_th = asdict(motor), (motor.thermal_resistance_winding, motor.thermal_resistance_housing)
    limit = motor.max_winding_temperature
    at_22 = continuous_current(resistance_25(figures), *R_th, limit, rated_ambient(figures))
    at_25 = continuous_current(motor.resistance, *R_th, limit, 25 + CELSIUS)
    assert round(float(at_22), 2) == motor.nominal_current == pytest.approx(round(float(at_25), 2) + 0.01)


def test_beckhoffs_windings_are_those_of_20_degc_and_its_rating_that_of_40(motors):
    figures = asdict(of(motors["beckhoff"], "AM8122-wFyz"))
    assert resistance_25(figures) == pytest.approx(1.5 / (1.0 - 5.0 * ALPHA), rel=1e-14)
    assert rated_ambient(figures) == 40 + CELSIUS  # 100 K above it are the permitted 140 degC
    share = current_derating(np.array([20.0, 40.0]) + CELSIUS, 140 + CELSIUS, rated_ambient(figures))
    assert share == pytest.approx([sqrt(1.2), 1.0])


@pytest.mark.parametrize("data", [22.0, nan])
@pytest.mark.parametrize("around", [20.0, 22.0, 25.0, 40.0])
@pytest.mark.parametrize("rms", [0.9, 1.01, 1.3])
def test_colder_than_the_rating_is_not_worse_where_the_permitted_temperature_is_unknown(data, around, rms):
    """At the rating 1 A is the limit; below, from 1 A to that of a winding of 80 degC; above, 1 A at most.

    From 25 degC to 20 the latter is sqrt(60/55) = 1.044 A: 1.01 A is unknown there, 1.3 A too much anywhere.
    """
    figures = {
        "nominal_current": 1.0, "max_winding_temperature": nan, "data_temperature": data + CELSIUS,
        "rated_ambient": nan, "mounted_gain": nan,
    }  # fmt: skip
    rated = 25.0 if isnan(data) else data
    found = nominal_current_limit(rms, figures, around + CELSIUS)
    assert bool(found.passed) == (rms < 1.0 and around <= rated)
    assert bool(found.failed) == (rms > 1.0 and (around >= rated or rms == 1.3))


def test_the_head_of_a_file_speaks_for_motors_and_actuators_without_a_temperature_of_their_own():
    found = parse(YamlSource(OWN, "own.yaml"), "own", "")
    assert found.motors["data_temperature"] == pytest.approx([295.15, 293.15])
    assert found.actuators["data_temperature"] == pytest.approx([295.15])
    bare = parse(YamlSource(OWN.replace("data_temperature: 22 degC\n", ""), "own.yaml"), "own", "")
    assert isnan(bare.motors["data_temperature"][0])
    with pytest.raises(CatalogError, match=r"own\.yaml:4: data_temperature.*temperature"):
        parse(YamlSource(OWN.replace("22 degC", "22 K/W"), "own.yaml"), "own", "")
    assert isnan(resistance_25(asdict(Motor())))
