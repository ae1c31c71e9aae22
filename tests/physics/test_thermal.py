"""Heat in the long run: closed forms against hand calculation, iteration and the shop's nominal currents."""

from __future__ import annotations

from math import inf, isnan, nan, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivesizer.kernel.warming import State, steady_state
from drivesizer.physics.thermal import (
    COPPER,
    DATA_TEMPERATURE,
    TwoBodies,
    continuous_current,
    continuous_torque,
    current_derating,
    nominal_current,
    steady_winding_temperature,
)

CELSIUS = 273.15


@pytest.mark.parametrize(("ambient", "rise"), [
    pytest.param(25.0, 20.0 / 0.922, id="at 25 degC: 20 W/K-watts over 1 - 0.0039*20"),
    pytest.param(40.0, 20.0 * 1.0585 / 0.922, id="at 40 degC the winding starts 5.85 % above its datasheet value"),
])  # fmt: skip
def test_by_hand(ambient, rise):
    # 2 ohm, 10 K/W, 1 A: 20 K were the resistance constant; it grows by 0.39 % per kelvin
    found = steady_winding_temperature(ambient + CELSIUS, 2.0, 3.0, 7.0, 1.0)
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
    assert steady_winding_temperature(ambient, R_25, 0.2 * R_th, 0.8 * R_th, current) == pytest.approx(
        temperature, abs=1e-6
    )


def test_more_heat_than_can_be_carried_off_runs_away():
    limit = sqrt(1.0 / (COPPER * 17.1 * 2.32))
    assert steady_winding_temperature(298.15, 2.32, 3.1, 14.0, limit * 0.999) < inf
    assert steady_winding_temperature(298.15, 2.32, 3.1, 14.0, limit * 1.001) == inf


def test_derating():
    assert current_derating(25.0 + CELSIUS, nan) == 1.0
    assert current_derating(50.0 + CELSIUS, 125.0 + CELSIUS) == pytest.approx(sqrt(75.0 / 100.0))
    assert current_derating(130.0 + CELSIUS, 125.0 + CELSIUS) == 0.0


# --- two bodies in the long run --------------------------------------------------------------------------------------


def test_two_bodies_by_hand():
    # 2 ohm, 1.5 A: 4.5 W, 13.5 K over R_th1, 31.5 K over R_th2; 0.6 W at the housing add 4.2 K; at 25 degC
    motor = TwoBodies(R_25=2.0, R_th1=3.0, R_th2=7.0, tau_w=11.0, tau_h=400.0)
    winding, housing = steady_state(motor, DATA_TEMPERATURE, 1.5, 0.6)
    copper = 4.5 * (1.0 + COPPER * (winding - DATA_TEMPERATURE))
    assert winding - DATA_TEMPERATURE == pytest.approx((45.0 + 4.2) / (1.0 - 0.0039 * 45.0), abs=1e-10)
    assert winding - housing == pytest.approx(3.0 * copper, abs=1e-10)
    assert housing - DATA_TEMPERATURE == pytest.approx(7.0 * (copper + 0.6), abs=1e-10)
    assert (motor.capacity_w, motor.capacity_h) == (11.0 / 3.0, 400.0 / 7.0)
    assert State(300.0, 300.0) == (300.0, 300.0) == pytest.approx(steady_state(motor, 300.0, 0.0))


@given(st.floats(250.0, 350.0), st.floats(0.05, 100.0), st.floats(0.5, 60.0), st.floats(0.0, 0.9))
def test_copper_alone_is_the_mean_formula(ambient, R_25, R_th, share):
    current = sqrt(share / (COPPER * R_th * R_25))
    motor = TwoBodies(R_25=R_25, R_th1=0.2 * R_th, R_th2=0.8 * R_th, tau_w=11.0, tau_h=400.0)
    mean = steady_winding_temperature(ambient, R_25, 0.2 * R_th, 0.8 * R_th, current)
    assert steady_state(motor, ambient, current).winding == pytest.approx(mean, rel=1e-11)


# --- the current that a winding bears --------------------------------------------------------------------------------


@given(
    st.floats(0.05, 100.0),
    st.floats(0.5, 60.0),
    st.floats(1.1, 9.0),
    st.floats(240.0, 340.0),
    st.floats(350.0, 430.0),
    st.floats(0.0, 0.99),
)
def test_the_continuous_current_brings_the_winding_to_its_limit(R_25, R_th1, ratio, ambient, T_max, share):
    R_th2 = ratio * R_th1
    loss = share * (T_max - ambient) / R_th2
    current = float(continuous_current(R_25, R_th1, R_th2, T_max, ambient, loss))
    motor = TwoBodies(R_25=R_25, R_th1=R_th1, R_th2=R_th2, tau_w=11.0, tau_h=400.0)
    assert steady_state(motor, ambient, current, loss).winding == pytest.approx(T_max, abs=1e-8)  # K


def test_continuous_current_over_speed():
    # (100 - 7 * 0.002 w) K left to copper over 1.39 * 2 ohm * 10 K/W; friction alone takes all from 100 / 0.014 rad/s
    w = np.array([0.0, 500.0, 100.0 / 0.014 + 1.0, nan])
    found = continuous_current(2.0, 3.0, 7.0, 125.0 + CELSIUS, DATA_TEMPERATURE, 0.02 * 0.1 * w)
    assert found[:3] == pytest.approx([sqrt(100.0 / 27.8), sqrt(93.0 / 27.8), 0.0])
    assert isnan(found[3])
    torque = continuous_torque(0.02, 0.1, found)
    assert torque[:3] == pytest.approx([0.02 * (sqrt(100.0 / 27.8) - 0.1), 0.02 * (sqrt(93.0 / 27.8) - 0.1), 0.0])
    assert isnan(torque[3])
    assert continuous_current(2.0, 3.0, 7.0, 350.0, 360.0) == 0.0  # hotter around than permitted


@pytest.mark.parametrize("unknown", range(6))
def test_unknown_figures_bear_no_current(unknown):
    figures = [2.0, 3.0, 7.0, 398.15, 298.15, 0.4]
    figures[unknown] = nan
    assert isnan(continuous_current(*figures))


def test_nominal_currents_of_the_shop(catalog):
    """Brushed motors: the printed nominal current follows from the printed thermal data."""
    motors = catalog.motors
    documents = [source.document for source in catalog.sources]
    shop = np.array([document.startswith("maxon online shop") for document in documents])[motors.source]
    brushed = shop & (motors["kind"] == "brushed")
    names = ("resistance", "thermal_resistance_winding", "thermal_resistance_housing", "max_winding_temperature")
    thermal = [motors[name] for name in names]
    k_t, I_0, w_N = (motors[name] for name in ("torque_constant", "no_load_current", "nominal_speed"))
    off = (nominal_current(*thermal, k_t, I_0, w_N) / motors["nominal_current"] - 1.0)[brushed]
    off = off[~np.isnan(off)]
    assert off.size == 302
    assert np.median(np.abs(off)) <= 0.01
    assert np.median(off) == pytest.approx(-0.006, abs=0.0005)
    copper_alone = (continuous_current(*thermal, DATA_TEMPERATURE) / motors["nominal_current"] - 1.0)[brushed]
    assert 0.015 < np.median(copper_alone) < 0.025  # without the friction the rating comes out too high
    again = continuous_current(*thermal, DATA_TEMPERATURE, k_t * I_0 * w_N)
    assert np.array_equal(again, nominal_current(*thermal, k_t, I_0, w_N), equal_nan=True)
