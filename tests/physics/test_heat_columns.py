"""Heat of many motors at once: against the one-motor solution and scipy, and bounds that hold over random cycles."""

from __future__ import annotations

from dataclasses import fields
from math import inf, isfinite, nan

import numpy as np
import pytest
from kernel_cycles import warmed
from scipy.integrate import solve_ivp

from drivesizer.physics.heat_cycle import periodic_heat
from drivesizer.physics.thermal import COPPER, DATA_TEMPERATURE, TwoBodies, steady_winding_temperature

AMBIENT = 304.0  # K
NAMES = [figure.name for figure in fields(TwoBodies)]


def random_motors(random, n):
    ranges = {
        "R_25": (0.05, 90.0),
        "R_th1": (0.3, 30.0),
        "R_th2": (0.9, 60.0),
        "tau_w": (0.7, 70.0),
        "tau_h": (9.0, 2300.0),
    }
    return TwoBodies(**{name: np.exp(random.uniform(*np.log(ranges[name]), n)) for name in NAMES})


def random_cycle(random, motors, hottest=4.0):
    """Durations, mean square currents (some beyond what can be borne for long) and housing losses; with pauses."""
    n, S = len(motors.R_25), int(random.integers(2, 8))
    dt = random.exponential(1.0, S) * 10.0 ** random.uniform(-2.0, 3.5)
    limit = 1.0 / (COPPER * motors.R_25 * (motors.R_th1 + motors.R_th2))
    share = random.uniform(0.0, 1.0, (n, S)) ** random.uniform(0.3, 6.0, (n, 1)) * hottest ** random.uniform(
        -2.0, 1.0, (n, 1)
    )
    rise = random.uniform(0.0, 1.0, (n, S)) ** 3 * 10.0 ** random.uniform(-1.0, 3.0, (n, 1))
    pauses = random.random((2, n, S)) < 0.3
    return dt, np.where(pauses[0], 0.0, share * limit[:, None]), np.where(pauses[1], 0.0, rise / motors.R_th2[:, None])


def course(motors, dt, squares, losses=0.0):
    return warmed(motors, AMBIENT, dt, squares, losses)


def one(motors, n):
    return TwoBodies(**{name: float(getattr(motors, name)[n]) for name in NAMES})


# --- the exact peak --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(12))
def test_each_motor_is_as_warm_as_by_itself(seed):
    random = np.random.default_rng(seed)
    motors = random_motors(random, 60)
    dt, squares, losses = random_cycle(random, motors)
    for n, name in enumerate(NAMES):  # some unknown figures
        getattr(motors, name)[n] = (nan, 0.0, inf, -1.0)[(seed + n) % 4]
    squares[7, 0], losses[8, 1] = nan, nan
    found = course(motors, dt, squares, losses)
    for n in range(60):
        alone = periodic_heat(one(motors, n), AMBIENT, dt, squares[n], losses[n])
        expected = (alone.winding_peak, alone.winding_mean if isfinite(alone.winding_peak) else nan)
        rises = [T[n] - AMBIENT for T in (found.peak, found.mean)]
        assert rises == pytest.approx([T - AMBIENT for T in expected], rel=1e-9, abs=1e-11, nan_ok=True)
        assert found.peak_time[n] == pytest.approx(alone.winding_peak_time, rel=1e-9, nan_ok=True)
    assert np.isnan(found.peak[[0, 1, 2, 3, 4, 7, 8]]).all() and not np.isnan(found.peak[9:]).any()


def test_some_of_them_run_away_and_the_others_do_not_mind():
    random = np.random.default_rng(3)
    motors = random_motors(random, 400)
    dt, squares, losses = random_cycle(random, motors, hottest=9.0)
    found = course(motors, dt, squares, losses)
    away = np.isinf(found.peak)
    assert 20 < away.sum() < 380
    for column in (found.mean, found.peak_time):
        assert (np.isnan(column) == away).all()
    kept = TwoBodies(**{name: getattr(motors, name)[~away] for name in NAMES})
    again = course(kept, dt, squares[~away], losses[~away])
    assert again.peak == pytest.approx(found.peak[~away], rel=1e-12)


def test_scipy_settles_to_the_same_peaks():
    motors = TwoBodies(
        R_25=np.array([0.7, 2.9]), R_th1=np.array([2.3, 1.2]), R_th2=np.array([5.9, 3.3]), tau_w=np.array([4.1, 2.6]),
        tau_h=np.array([37.0, 21.0]),
    )  # fmt: skip
    dt, squares = np.array([2.0, 5.5, 9.0]), np.array([[30.0, 1.7, 0.0], [0.4, 21.0, 2.0]])
    losses = np.array([[0.9], [2.1]])
    found = course(motors, dt, squares, losses)
    for n in range(2):
        motor, state, warmest = one(motors, n), np.full(2, AMBIENT), np.zeros(2)
        for step in [99.0] * 70 + [0.05]:
            warmest = state
            for t, square in zip(dt, squares[n], strict=True):

                def law(_, x, motor=motor, square=square, loss=losses[n, 0]):
                    copper = motor.R_25 * square * (1.0 + COPPER * (x[0] - DATA_TEMPERATURE))
                    through = (x[0] - x[1]) / motor.R_th1
                    out = (x[1] - AMBIENT) / motor.R_th2
                    return [(copper - through) / motor.capacity_w, (loss + through - out) / motor.capacity_h]

                y = solve_ivp(law, (0.0, t), state, method="DOP853", rtol=1e-12, atol=1e-10, max_step=step).y
                state, warmest = y[:, -1], np.maximum(warmest, y.max(axis=1))
        assert found.peak[n] == pytest.approx(warmest[0], abs=1e-4)  # K: dense samples miss a rounded top by their step


def test_one_loss_for_all_and_figures_that_all_motors_share():
    motors = TwoBodies(R_25=np.array([2.0, 3.0, 5.0]), R_th1=3.1, R_th2=14.0, tau_w=12.4, tau_h=612.0)
    found = course(motors, [2.0, 7.0], [[3.0, 0.0]] * 3, 0.4)
    assert (np.diff(found.peak) > 1.0).all()
    constant = course(motors, [2.0, 7.0], [[0.5], [0.4], [0.3]], 0.4)
    steady = steady_winding_temperature(AMBIENT, motors.R_25, 3.1, 14.0, np.sqrt([0.5, 0.4, 0.3]), 0.4)
    assert constant.peak == pytest.approx(steady, rel=1e-11)
    assert constant.mean == pytest.approx(steady, rel=1e-11)
