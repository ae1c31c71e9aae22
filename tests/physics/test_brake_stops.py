"""Stops by a brake: a handbook's and makers' printed figures, energy over a stop in small steps, the edges."""

import math

import numpy as np
import pytest

from drivesizer.physics.braking import SLIPPING, held_by_brake, released_power, stop

LB_FT2, LB_FT, RPM = 0.45359237 * 0.3048**2, 4.4482216152605 * 0.3048, math.pi / 30.0


def test_a_handbook_s_brake_for_a_known_load():
    """T. Hicks, Handbook of Mechanical Engineering Calculations, section 24: 200 lb ft^2 at 1800 rpm and 29.2 lb ft.

    It stops within 40 s. The book's 82.7 N m^2 is a weight times a square, no inertia, and its 39.7 N m are 39.6.
    """
    found = stop(200 * LB_FT2, 1800 * RPM, 29.2 * LB_FT, 0.0, 0.0)
    assert found.time == pytest.approx(40.0 * 308 / 307.2, abs=0.05 / 29.2 * 40.0)  # its constant is 307.2, rounded up
    assert found.angle / (2 * math.pi) == pytest.approx(1800 / 60 * found.time / 2)


def test_makers_print_the_same_energy_and_time():
    """mayr ROBA-stop-M, brake dimensioning (1 / 182.4), and Tsubaki, brake life (1 / 182.5, 9.55), of hanging loads."""
    draw = np.random.default_rng(5)
    for _ in range(50):
        J, n, M_2 = 10 ** draw.uniform(-5, 0), draw.uniform(100, 6000), draw.uniform(0.1, 50)
        M_L = draw.uniform(0.0, 0.9) * M_2
        found = stop(J, n * RPM, M_2, M_L, 0.0)
        assert found.energy == pytest.approx(J * n**2 / 182.4 * M_2 / (M_2 - M_L), rel=1e-3)
        assert found.time == pytest.approx(J * n / (9.55 * (M_2 - M_L)), rel=1e-3)


def test_the_brake_takes_what_moves_and_what_falls():
    """Integrated in steps: until the brake has its torque the load speeds up, then both act on the inertia."""
    J, w, M_B, M_L, t_e = 3e-4, 200.0, 1.2, 0.5, 0.03
    found, step, speed, angle, taken, time = stop(J, w, M_B, M_L, t_e), 1e-6, w, 0.0, 0.0, 0.0
    while speed > 0.0:
        brake = M_B if time >= t_e else 0.0
        change = (M_L - brake) / J * step
        mean = speed + change / 2
        taken, angle, speed, time = taken + brake * mean * step, angle + mean * step, speed + change, time + step
    assert found.time == pytest.approx(time, abs=2e-6)
    assert found.angle == pytest.approx(angle, rel=1e-4)
    assert found.energy == pytest.approx(taken, rel=1e-4)
    assert found.energy == pytest.approx(J * w**2 / 2 + M_L * found.angle)


def test_a_brake_no_stronger_than_the_load_never_stops_it():
    found = stop(1e-3, 100.0, np.array([2.0, 1.0, math.nan]), 2.0, 0.01)
    assert np.isinf(found.energy[:2]).all() and np.isinf(found.time[:2]).all() and math.isnan(found.energy[2])
    assert stop(1e-3, 0.0, 1.0, 0.0, 0.01) == (0.0, 0.0, 0.0)  # what stands needs no stop


def test_an_unknown_engaging_time_leaves_open_what_hangs_on_it():
    assert stop(1e-3, 100.0, 1.0, 0.0, math.nan).energy == 5.0
    assert math.isnan(stop(1e-3, 100.0, 1.0, 0.0, math.nan).time)
    assert math.isnan(stop(1e-3, 100.0, 1.0, 0.2, math.nan).energy)


def test_printed_shares_of_a_slipping_brake_lie_within_those_assumed():
    """Bosch Rexroth MS2E-10-E and MS2E-07-C, Siemens 1Fx2106 and 1Fx2x03: dynamic over static torque."""
    for slipping, static in ((33, 90), (12.5, 20), (9, 16), (1.3, 1.3)):
        assert SLIPPING[0] <= slipping / static <= SLIPPING[1]


def test_gears_help_to_hold_and_the_lowered_power_counts():
    assert held_by_brake(3.677, 26.0, 0.81) == pytest.approx(0.1146, abs=5e-5)
    assert released_power({"power": 8.0, "holding_power": math.nan}) == 8.0
    assert released_power({"power": math.nan, "holding_power": math.nan}) == 0.0
