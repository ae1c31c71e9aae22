"""Steppers: pull-out torque against brute force and printed charts, starting against a simulation, energy by pieces."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

from drivesizer.catalog import Catalog, load
from drivesizer.physics.stepper import (
    PULL_OUT_SHARE,
    electrical_energy,
    natural_frequency,
    pull_out_torque,
    rescaled_torque,
    rotor_teeth,
    start_speed,
    start_speed_with,
)

RPM = math.pi / 30.0
SEED = random.Random(21)


@pytest.fixture(scope="module")
def catalog() -> Catalog:
    return load(["stepperonline", "leadshine"])


def figures_of(catalog: Catalog, part: str) -> dict[str, float]:
    row, table = catalog.steppers.rows[part], catalog.steppers
    names = ("holding_torque", "phase_current", "resistance", "inductance")
    return {name: float(table[name][row]) for name in names} | {"teeth": rotor_teeth(float(table["full_steps"][row]))}


def largest_by_trial(w: float, V: float, T_h: float, I: float, R: float, L: float, p: float) -> float:
    """The largest torque of all currents on a fine grid that driver and supply allow."""
    k, X, most, best = T_h / (math.sqrt(2.0) * I), p * w * L, math.sqrt(2.0) * I, 0.0
    for ring in range(1, 121):
        for step in range(360):
            i, angle = most * ring / 120, step * math.pi / 180
            x, y = i * math.cos(angle), i * math.sin(angle)
            if x > best and (R * x - X * y + k * w) ** 2 + (R * y + X * x) ** 2 <= V * V:
                best = x
    return k * best


def test_pull_out_is_the_best_of_all_currents() -> None:
    """Ten motors on both sides of the corner speed, 43,200 currents each; the grid is at most 1 % of I_m coarse."""
    for _ in range(10):
        T_h, I, V = SEED.uniform(0.1, 5.0), SEED.uniform(0.5, 6.0), SEED.uniform(12.0, 80.0)
        R, p = SEED.uniform(1.0, 8.0) / I**1.5, SEED.choice((50.0, 100.0))
        L = R * SEED.uniform(1e-3, 4e-3)
        w = SEED.uniform(0.0, 3.0) * V / (p * L * I * math.sqrt(2.0) + T_h / I)
        found = pull_out_torque(w, V, holding_torque=T_h, phase_current=I, resistance=R, inductance=L, teeth=p)
        trial = largest_by_trial(w, V, T_h, I, R, L, p)
        assert trial <= float(found) * (1.0 + 1e-9) + 1e-12
        assert float(found) - trial < 0.012 * T_h


def test_printed_charts_lie_in_the_band(catalog: Catalog) -> None:
    """All points of the 7 charts of motors of which R and L are known: 0.51 to 0.95 of the model."""
    shares = []
    for stepper in np.unique(catalog.pull_outs.stepper).tolist():
        own = catalog.pull_outs.on(catalog.pull_outs.stepper == stepper)
        model = pull_out_torque(own.speed, own.voltage, **figures_of(catalog, str(catalog.steppers["part"][stepper])))
        shares += [share for share in (own.torque / model).tolist() if not math.isnan(share)]
    middle, factor = PULL_OUT_SHARE
    assert len(shares) == 16 + 12 + 2 + 12 + 3 + 5 + 4
    assert (round(min(shares), 2), round(max(shares), 2)) == (0.51, 0.95)
    inside = [middle / factor <= share <= middle * factor for share in shares]
    assert sum(inside) == len(inside)
    assert abs(float(np.median(shares)) / middle - 1.0) < 0.05


@pytest.mark.parametrize(
    ("part", "low", "high"), [("34HE46-6004D-E1000", 48, 60), ("23HS30-2804S", 36, 48), ("57CM13", 24, 36)]
)
def test_a_chart_at_another_voltage(catalog: Catalog, part: str, low: float, high: float) -> None:
    """Charts at two voltages: the lower one is no more than the higher, and comes out of it to 11 %."""
    own = catalog.pull_outs.on(catalog.pull_outs.stepper == catalog.steppers.rows[part])
    one, other = (own.on(own.voltage == volts) for volts in (low, high))
    down = rescaled_torque(one.speed[None], low, other.speed[None], other.torque[None], np.array([float(high)]))[0]
    known = ~np.isnan(down)
    assert known.sum() >= 2
    assert np.abs(down / one.torque - 1.0)[known].max() < 0.11
    at = one.speed[None], one.torque[None], np.array([float(low)])
    assert (rescaled_torque(other.speed[None], high, *at)[0] <= 1.005 * other.torque).all()
    assert np.isnan(rescaled_torque(np.array([[1.01 * at[0][0, -1]]]), low, *at)).all()


def test_without_resistance_torque_is_a_function_of_voltage_over_speed() -> None:
    motor = {"holding_torque": 1.2, "phase_current": 3.0, "resistance": 0.0, "inductance": 3e-3, "teeth": 50.0}
    speeds = np.linspace(1.0, 200.0, 60)
    once = pull_out_torque(speeds, 24.0, **motor)
    assert pull_out_torque(1.7 * speeds, 1.7 * 24.0, **motor) == pytest.approx(once)
    assert (np.diff(once) <= 1e-12).all()


def test_a_dip_is_no_torque_to_rely_on() -> None:
    """0.406, 0.406, 0.422 N*m at 200, 300, 400 rpm: 0.406 at 400 rpm; flat below the first point."""
    curve = np.array([[200.0, 300.0, 400.0]]) * RPM, np.array([[0.406, 0.406, 0.422]]), np.array([24.0])
    found = rescaled_torque(np.array([[0.0, -350.0, 400.0, 401.0]]) * RPM, 24.0, *curve)[0]
    assert found[:3].tolist() == pytest.approx([0.406] * 3)
    assert math.isnan(found[3])


def starts(w: float, T: float, J: float, T_L: float, p: float) -> bool:
    """Whether a rotor at rest follows a field that jumps to a speed, by small steps of time."""
    lag, speed, dt = math.asin(T_L / T) / p, -w, 1e-3 / math.sqrt(p * T / J)
    for _ in range(40_000):  # seen from the field
        speed += dt * (T * math.sin(p * lag) - T_L) / J
        lag -= dt * speed
        if speed >= 0.0:
            return True
        if p * lag > math.pi:
            return False
    return True


def test_start_speed_is_where_a_simulated_rotor_begins_to_fall_behind() -> None:
    for _ in range(6):
        T, J, p = SEED.uniform(0.2, 3.0), SEED.uniform(5e-6, 5e-4), SEED.choice((50.0, 100.0))
        T_L = T * SEED.uniform(0.0, 0.7)
        limit = float(start_speed(p, T, J, T_L))
        assert starts(0.98 * limit, T, J, T_L, p)
        assert not starts(1.02 * limit, T, J, T_L, p)


def test_starting_with_a_load_goes_by_the_printed_rule() -> None:
    """f = f_0 / sqrt(1 + J_L/J_r): a load of three times the rotor halves it; a load of all the torque leaves none."""
    assert start_speed_with(120.0, 1e-5, 4e-5, 0.0, 0.5) == pytest.approx(60.0)
    assert start_speed_with(120.0, 1e-5, 4e-5, 0.5, 0.5) == pytest.approx(0.0, abs=1e-6)
    for held in (0.0, 0.2):  # the same as of the ideal rotor with all the inertia
        ideal = start_speed(50.0, 0.5, 1e-5)
        assert start_speed_with(ideal, 1e-5, 4e-5, held, 0.5) == pytest.approx(start_speed(50.0, 0.5, 4e-5, held))


def test_natural_frequency_is_that_of_small_swings() -> None:
    """A rotor let go at a tenth of a step, by small steps of time: four quarters of its swing."""
    p, T, J, dt = 50.0, 0.59, 82e-7, 1e-7
    angle, speed, time = math.radians(0.18), 0.0, 0.0
    while angle > 0.0:
        speed -= dt * T * math.sin(p * angle) / J
        angle, time = angle + dt * speed, time + dt
    assert 0.25 / time == pytest.approx(float(natural_frequency(p, T, J)), rel=0.01)


def test_energy_by_small_pieces() -> None:
    draw = np.random.default_rng(5)
    duration, torque, speed = draw.uniform(0.1, 2.0, 6), draw.normal(0, 1, (4, 6, 2)), draw.normal(0, 30, (4, 6, 2))
    torque[0, 1] = torque[0, 1, 0]  # steady pieces as well
    speed[0, 1] = speed[0, 1, 0]
    loss = draw.uniform(2.0, 20.0, 4)
    drawn, returned, most, least = electrical_energy(duration, torque, speed, loss)
    share = (np.arange(20_000) + 0.5) / 20_000
    power = loss[:, None, None] + np.multiply(
        *(x[..., :1] + share * (x[..., 1:] - x[..., :1]) for x in (torque, speed))
    )
    assert drawn == pytest.approx((np.maximum(power, 0.0).mean(axis=2) * duration).sum(axis=1), rel=1e-6)
    assert returned == pytest.approx((np.maximum(-power, 0.0).mean(axis=2) * duration).sum(axis=1), rel=1e-6)
    assert most == pytest.approx(power.max(axis=(1, 2)), rel=1e-3)
    assert least == pytest.approx(power.min(axis=(1, 2)), rel=1e-3)
