"""Chopper, capacitors and brake resistor: makers' printed figures, a store walked in plain Python, and laws."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

from drivesizer.physics.braking import (
    burning,
    burnt_energy,
    derated_power,
    largest_mean,
    largest_pulse,
    largest_resistance,
    power_while_on,
    smallest_resistance,
    storable_energy,
)

# --- as printed -----------------------------------------------------------------------------------------------------

_SINAMICS = 774.0  # V, upper threshold: SINAMICS Engineering Manual, November 2015, page 376


@pytest.mark.parametrize(("ohm", "printed"), [(20.0, 30e3), (8.0, 75e3)], ids=["20 kW", "40 kW"])
def test_siemens_prints_the_largest_braking_power_of_a_resistance(ohm, printed):
    """Siemens catalogue D 21.4, 2017, 7/60, Basic Line Modules with external braking resistor."""
    assert power_while_on(_SINAMICS, ohm) == pytest.approx(printed, abs=500.0)
    assert largest_resistance(_SINAMICS, printed) == pytest.approx(ohm, abs=0.05)


def test_siemens_prints_duty_cycles_that_keep_mean_power_and_energy():
    """SINAMICS S120 Combi, 07/2012, table 8-14, 6SL3100-1BE31: 1.5 kW, 100 kW, 200 kWs; 1 s in 68 s, 2 s in 460 s.

    Of the smaller resistor beside it (0.3 kW, 25 kW, 7.5 kWs) the long cycle, 0.4 s, is printed with 25 kW as well:
    that would be 10 kWs. It is left out here.
    """
    short = largest_mean(np.array([1.0, 67.0]), np.array([100e3, 0.0]), 68.0)
    assert short == pytest.approx(1.5e3, abs=50.0)
    long = np.array([2.0, 458.0]), np.array([200e3, 0.0])
    assert largest_pulse(*long) == 200e3
    assert largest_mean(*long, 460.0) < 1.5e3


def test_the_effective_value_of_a_power_is_no_heat():
    """Lust CDA3000 Engineering Guide, page 3-87, figure 3.41: 1580 W and 998 W falling to 0 in 0.2 s each, in 8.4 s.

    It takes the root of the mean square of the power, 288 W. What warms a resistor is the mean of the power.
    """
    duration = np.array([0.2, 3.2, 0.2, 4.8])
    energy = np.array([1580.0 * 0.2 / 2, 0.0, 998.0 * 0.2 / 2, 0.0])
    effective = math.sqrt((1580.0**2 * 0.2 + 998.0**2 * 0.2) / 8.4)
    assert effective == pytest.approx(288.4, abs=0.1)
    assert largest_mean(duration, energy, 84.0) == pytest.approx((158.0 + 99.8) / 8.4)
    assert largest_pulse(duration, energy) == 158.0


def test_beckhoff_prints_peak_and_continuous_power_of_a_linear_axis():
    """Beckhoff AL2000, calculation of the brake resistor: P_max = 0.9 m v^2 / (2 t_b), P_rated = P_max t_b / t_z."""
    mass, speed, braking, cycle = 20.0, 2.0, 0.25, 3.0
    peak = 0.9 * mass * speed**2 / (2 * braking)
    found = largest_mean(np.array([braking, cycle - braking]), np.array([0.9 * 0.5 * mass * speed**2, 0.0]), 30.0)
    assert found == pytest.approx(peak * braking / cycle)


def test_maxon_limits_the_current_of_its_shunt_regulator():
    """DSR 50/5: at 56 V its 5.5 ohm would take 10.2 A; its 5 A and its 300 W need 11.2 ohm and 10.5 ohm."""
    assert smallest_resistance(56.0, 5.0) == pytest.approx(11.2)
    assert largest_resistance(56.0, 300.0) == pytest.approx(10.45, abs=0.005)


# --- a store, walked in plain Python --------------------------------------------------------------------------------


def _walked(drawn: list[float], returned: list[float], capacity: float) -> list[float]:
    """Cycle after cycle until the store ends each as it begins it."""
    held, burnt = 0.0, [0.0] * len(drawn)
    for _ in range(400):
        start = held
        for k, (out, into) in enumerate(zip(drawn, returned, strict=True)):
            held = held - out if out < held else 0.0
            room = capacity - held
            burnt[k] = into - room if into > room else 0.0
            held += into - burnt[k]
        if held == start:
            break
    return burnt


@pytest.mark.parametrize("seed", range(40))
def test_the_course_of_the_store_is_that_of_many_cycles(seed):
    of = random.Random(seed)
    count = of.randint(1, 12)
    drawn = [of.choice([0.0, of.uniform(0.0, 5.0)]) for _ in range(count)]
    returned = [of.choice([0.0, of.uniform(0.0, 5.0)]) for _ in range(count)]
    capacity = of.choice([0.0, of.uniform(0.1, 8.0), 30.0])
    found = burnt_energy(np.array(drawn), np.array(returned), capacity)
    assert found.tolist() == pytest.approx(_walked(drawn, returned, capacity), abs=1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_the_worst_window_is_that_of_all_windows(seed):
    of = random.Random(1000 + seed)
    duration = np.array([of.uniform(0.1, 2.0) for _ in range(of.randint(1, 8))])
    energy = np.array([of.choice([0.0, of.uniform(0.0, 9.0)]) for _ in duration])
    window = of.uniform(0.2, 3.0) * float(duration.sum())
    rate, total = energy / duration, float(duration.sum())
    step = total / 3000.0

    def power(time: float) -> float:
        at = time % total
        for lasts, value in zip(duration, rate, strict=True):
            if at < lasts:
                return float(value)
            at -= lasts
        return float(rate[-1])

    count = round(window / step)
    at = [power((k + 0.5) * step) for k in range(3000)] * (2 + math.ceil(window / total))
    sums = np.concatenate([[0.0], np.cumsum(at)])
    brute = max(sums[count : count + 3000] - sums[:3000]) / count
    found = largest_mean(duration, energy, window)
    assert found == pytest.approx(max(brute, float(energy.sum()) / total), abs=0.01 * max(rate.max(), 1.0))


@pytest.mark.parametrize("pieces", [1, 3, 16, 100])
def test_a_falling_power_is_burnt_as_its_closed_form_says(pieces):
    """A load braked from 3000 rpm in 0.1 s: 218.6 W fall to 0. The bus of 331 uF from 310 to 380 V takes 7.996 J.

    By hand: then 113.3 W are left, which 1274 ohm burn at 380 V; above the resistor's 80 W they are
    (113.3^2 - 80^2) / (2 * 2186 W/s) = 1.472 J.
    """
    slope, whole = 218.64 / 0.1, 0.1
    ends = np.linspace(0.0, whole, pieces + 1)
    power = 218.64 - slope * ends
    duration = np.append(np.diff(ends), 0.4)  # and a rest in which the drive draws the store empty
    returned = np.append((power[1:] + power[:-1]) / 2 * np.diff(ends), 0.0)
    highest, drawn = np.append(power[:-1], 0.0), np.append(np.zeros(pieces), 20.0)
    capacity = float(storable_energy(331e-6, 380.0, 310.0))
    assert capacity == pytest.approx(7.994, rel=1e-3)
    burnt = burnt_energy(drawn, returned, capacity)
    found = burning(duration, returned, highest, burnt, 80.0)
    assert found.peak == pytest.approx(113.3, rel=1e-3)
    assert float(largest_resistance(380.0, found.peak)) == pytest.approx(1274.0, rel=1e-3)
    assert largest_pulse(found.duration, found.energy, 80.0) == pytest.approx(1.472, rel=2e-3)
    assert found.duration.sum() == pytest.approx(0.5) and found.energy.sum() == pytest.approx(burnt.sum())


# --- laws and edges -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(10))
def test_what_is_burnt_falls_with_the_capacitance_and_is_never_more_than_what_is_regenerated(seed):
    of = np.random.default_rng(seed)
    drawn, returned = of.uniform(0.0, 4.0, (2, 9))
    sums = [burnt_energy(drawn, returned, capacity).sum() for capacity in (0.0, 1.0, 3.0, 1e3)]
    assert sums[0] == pytest.approx(returned.sum())
    assert sums == sorted(sums, reverse=True)
    assert sums[-1] == pytest.approx(max(returned.sum() - drawn.sum(), 0.0))


def test_derating_needs_both_ends_of_its_line():
    assert math.isnan(derated_power(450.0, 318.15, 313.15, math.nan))
    assert derated_power(450.0, 318.15, math.nan, math.nan) == 450.0
    assert derated_power(10.0, 400.0, 298.15, 348.15) == 0.0
