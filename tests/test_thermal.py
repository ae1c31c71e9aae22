"""Steady winding temperature: the closed form against hand calculation and fixed-point iteration."""

from __future__ import annotations

from math import inf, isnan, nan, sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivesizer.thermal import COPPER, DATA_TEMPERATURE, current_derating, steady_winding_temperature

CELSIUS = 273.15


@pytest.mark.parametrize(
    ("ambient", "rise"),
    [
        pytest.param(25.0, 20.0 / 0.922, id="at 25 degC: 20 W/K-watts over 1 - 0.0039*20"),
        pytest.param(40.0, 20.0 * 1.0585 / 0.922, id="at 40 degC the winding starts 5.85 % above its datasheet value"),
    ],
)
def test_by_hand(ambient, rise):
    # 2 ohm, 10 K/W, 1 A: 20 K were the resistance constant; it grows by 0.39 % per kelvin
    found = steady_winding_temperature(ambient + CELSIUS, 2.0, 10.0, 1.0)
    assert found - CELSIUS - ambient == pytest.approx(rise, abs=1e-9)


@given(
    st.floats(250.0, 350.0),
    st.floats(0.05, 100.0),
    st.floats(0.5, 60.0),
    st.floats(0.0, 0.7),  # of the heating at which the winding runs away
)
def test_iteration_ends_there(ambient, R_25, R_th, share):
    current = sqrt(share / (COPPER * R_th * R_25))
    temperature = ambient
    for _ in range(300):
        resistance = R_25 * (1.0 + COPPER * (temperature - DATA_TEMPERATURE))
        temperature = ambient + R_th * resistance * current**2
    assert steady_winding_temperature(ambient, R_25, R_th, current) == pytest.approx(temperature, abs=1e-6)


def test_more_heat_than_can_be_carried_off_runs_away():
    limit = sqrt(1.0 / (COPPER * 17.1 * 2.32))
    assert steady_winding_temperature(298.15, 2.32, 17.1, limit * 0.999) < inf
    assert steady_winding_temperature(298.15, 2.32, 17.1, limit * 1.001) == inf


def test_unknown_stays_unknown():
    assert isnan(steady_winding_temperature(298.15, 2.32, nan, 1.0))
    assert isnan(current_derating(313.15, nan))


def test_derating():
    assert current_derating(25.0 + CELSIUS, nan) == 1.0
    assert current_derating(50.0 + CELSIUS, 125.0 + CELSIUS) == pytest.approx(sqrt(75.0 / 100.0))
    assert current_derating(130.0 + CELSIUS, 125.0 + CELSIUS) == 0.0
