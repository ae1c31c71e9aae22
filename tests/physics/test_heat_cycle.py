"""Two-body heat over a periodic cycle and in overload: against scipy, closed forms and laws that need no formula.

Resistances, time constants and durations differ everywhere: no ratio is 1.
"""

from __future__ import annotations

from dataclasses import replace
from decimal import Decimal, localcontext
from itertools import pairwise
from math import exp, inf, isnan, log, nan, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from drivesizer.errors import InputError
from drivesizer.physics import heat_step
from drivesizer.physics.heat_cycle import periodic_heat
from drivesizer.physics.heat_step import State, cold, overload_time, steady_state
from drivesizer.physics.thermal import COPPER, DATA_TEMPERATURE, TwoBodies, steady_winding_temperature

CELSIUS = 273.15
MOTOR = TwoBodies(R_25=2.32, R_th1=3.1, R_th2=14.0, tau_w=12.4, tau_h=612.0)  # an RE 25, near enough
QUICK = TwoBodies(R_25=0.7, R_th1=2.3, R_th2=5.9, tau_w=4.1, tau_h=37.0)  # settles within a few periods
AMBIENT = 31.0 + CELSIUS
T = np.array([2.0, 5.5, 0.4, 9.0])  # s
I2 = np.array([16.0, 1.7, 30.0, 0.0])  # A^2
P_H = np.array([0.9, 2.1, 0.0, 0.3])  # W


def slopes(motor, ambient, square, loss):
    """The law as it stands in periodic_heat's docstring, in absolute temperatures."""
    C_w, C_h = motor.tau_w / motor.R_th1, motor.tau_h / motor.R_th2

    def law(_, x):
        through = (x[0] - x[1]) / motor.R_th1
        copper = motor.R_25 * square * (1.0 + COPPER * (x[0] - DATA_TEMPERATURE))
        return [(copper - through) / C_w, (loss + through - (x[1] - ambient) / motor.R_th2) / C_h]

    return law


def integrated(motor, ambient, start, dt, squares, losses, **options):
    """The state at the end, and the warmest winding on a dense grid, by scipy."""
    state, warmest = np.array(start), start[0]
    for t, square, loss in zip(dt, squares, losses, strict=True):
        law = slopes(motor, ambient, square, loss)
        found = solve_ivp(law, (0.0, t), state, method="DOP853", rtol=1e-12, atol=1e-10, **options)
        state, warmest = found.y[:, -1], max(warmest, found.y[0].max())
    return state, warmest


def exact(motor, ambient, start, t, square, loss):
    """The state after a time, by scipy's matrix exponential of law and constant together."""
    law = slopes(motor, ambient, square, loss)
    constant = np.array(law(0.0, [0.0, 0.0]))
    matrix = np.zeros((3, 3))
    matrix[:2, 0], matrix[:2, 1] = law(0.0, [1.0, 0.0]) - constant, law(0.0, [0.0, 1.0]) - constant
    matrix[:2, 2] = constant
    return (expm(matrix * t) @ [*start, 1.0])[:2]


@st.composite
def motors(draw):
    return TwoBodies(
        R_25=draw(st.floats(0.05, 90.0)),
        R_th1=draw(st.floats(0.3, 30.0)),
        R_th2=draw(st.floats(0.9, 60.0)),
        tau_w=draw(st.floats(0.7, 70.0)),
        tau_h=draw(st.floats(90.0, 2300.0)),
    )


@st.composite
def cycles(draw, hottest=0.8):
    """A motor and segments; the share of the heating at which it would run away stays below the hottest."""
    motor, n = draw(motors()), draw(st.integers(1, 6))
    column = {"min_size": n, "max_size": n}
    dt = np.array(draw(st.lists(st.floats(0.01, 300.0), **column)))
    share = np.array(draw(st.lists(st.floats(0.0, hottest), **column)))
    loss = np.array(draw(st.lists(st.floats(0.0, 40.0), **column))) / motor.R_th2
    return motor, dt, share / (COPPER * motor.R_25 * (motor.R_th1 + motor.R_th2)), loss


# --- the periodic state ----------------------------------------------------------------------------------------------


def test_scipy_settles_to_the_periodic_state():
    found = periodic_heat(QUICK, AMBIENT, T, I2, P_H)
    state = np.array(cold(AMBIENT))
    for _ in range(60):
        state, warmest = integrated(QUICK, AMBIENT, state, T, I2, P_H)
    assert found.spectral_radius**60 < 1e-6
    assert found.winding[0] == pytest.approx(state[0], abs=1e-6)  # K
    assert found.housing[0] == pytest.approx(state[1], abs=1e-6)
    assert found.winding_peak == pytest.approx(warmest, abs=1e-6)


def test_scipy_stays_in_the_periodic_state_of_a_slow_motor():
    found = periodic_heat(MOTOR, AMBIENT, T, I2 / 9.0, P_H)
    state = np.array([found.winding[0], found.housing[0]])
    for _ in range(5):
        state, _ = integrated(MOTOR, AMBIENT, state, T, I2 / 9.0, P_H)
    assert state == pytest.approx([found.winding[0], found.housing[0]], abs=1e-8)  # K
    for n in range(len(T)):
        state, _ = integrated(MOTOR, AMBIENT, state, T[n : n + 1], I2[n : n + 1] / 9.0, P_H[n : n + 1])
        assert state == pytest.approx([found.winding[n + 1], found.housing[n + 1]], abs=1e-8)


@given(cycles())
def test_each_segment_ends_where_the_matrix_exponential_says(case):
    motor, dt, squares, losses = case
    found = periodic_heat(motor, AMBIENT, dt, squares, losses)
    assert found.winding[-1] == pytest.approx(found.winding[0], rel=1e-11)
    for n in range(len(dt)):
        end = exact(motor, AMBIENT, (found.winding[n], found.housing[n]), dt[n], squares[n], losses[n])
        assert (found.winding[n + 1], found.housing[n + 1]) == pytest.approx(tuple(end), rel=1e-10)


@given(cycles())
@settings(max_examples=20)
def test_heat_in_is_heat_out(case):
    motor, dt, squares, losses = case
    found = periodic_heat(motor, AMBIENT, dt, squares, losses)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    copper = 0.0
    for n, t in enumerate(dt):
        pieces = np.concatenate(([0.0], t * 2.0 ** -np.arange(16.0)[::-1]))  # finer where the winding moves fast
        for a, b in pairwise(pieces):
            for x, weight in zip(nodes, weights, strict=True):
                start = (found.winding[n], found.housing[n])
                w = exact(motor, AMBIENT, start, a + (b - a) * (x + 1) / 2, squares[n], losses[n])[0]
                resistance = motor.R_25 * (1.0 + COPPER * (w - DATA_TEMPERATURE))
                copper += weight * (b - a) / 2 * resistance * squares[n]
    period = dt.sum()
    through = (found.winding_mean - found.housing_mean) / motor.R_th1 * period
    out = (found.housing_mean - AMBIENT) / motor.R_th2 * period
    least = 1e-11 * period * AMBIENT / motor.R_th1  # what rounding of absolute temperatures amounts to
    assert through == pytest.approx(copper, rel=1e-9, abs=least)
    assert out == pytest.approx(copper + float(losses @ dt), rel=1e-9, abs=least)


@given(cycles(), st.integers(1, 5))
def test_a_cycle_has_no_first_segment(case, shift):
    motor, *columns = case
    found = periodic_heat(motor, AMBIENT, *columns)
    turned = periodic_heat(motor, AMBIENT, *(np.roll(c, shift) for c in columns))
    for name in ("winding_peak", "winding_mean", "housing_peak", "housing_mean"):
        assert getattr(turned, name) == pytest.approx(getattr(found, name), rel=1e-11), name
    assert turned.spectral_radius == pytest.approx(found.spectral_radius, abs=1e-11)


@given(cycles(), st.floats(0.05, 0.95))
def test_splitting_segments_changes_nothing(case, share):
    motor, dt, squares, losses = case
    found = periodic_heat(motor, AMBIENT, dt, squares, losses)
    split = np.column_stack((dt * share, dt * (1.0 - share))).ravel()
    finer = periodic_heat(motor, AMBIENT, split, np.repeat(squares, 2), np.repeat(losses, 2))
    assert finer.winding[::2] == pytest.approx(found.winding, rel=1e-11)  # 4e-9 K; short segments lose a digit
    assert finer.housing[::2] == pytest.approx(found.housing, rel=1e-11)
    for name in ("winding_peak", "winding_mean", "housing_peak", "housing_mean"):
        assert getattr(finer, name) == pytest.approx(getattr(found, name), rel=1e-11), name


@given(cycles(), st.floats(0.02, 50.0))
def test_slower_bodies_in_a_slower_cycle_are_as_warm(case, factor):
    motor, dt, squares, losses = case
    found = periodic_heat(motor, AMBIENT, dt, squares, losses)
    slower = replace(motor, tau_w=motor.tau_w * factor, tau_h=motor.tau_h * factor)
    again = periodic_heat(slower, AMBIENT, dt * factor, squares, losses)
    assert again.winding_peak == pytest.approx(found.winding_peak, rel=1e-11)
    assert again.winding_mean == pytest.approx(found.winding_mean, rel=1e-11)


@given(motors(), st.floats(0.0, 0.95), st.floats(0.0, 40.0), st.floats(250.0, 350.0))
def test_constant_current_gives_the_closed_steady_form(motor, share, rise, ambient):
    current = sqrt(share / (COPPER * motor.R_25 * (motor.R_th1 + motor.R_th2)))
    loss = rise / motor.R_th2
    found = periodic_heat(motor, ambient, [3.0, 7.0, 0.2], [current**2] * 3, loss)
    steady = steady_state(motor, ambient, current, loss)
    for name in ("winding_peak", "winding_mean"):
        assert getattr(found, name) == pytest.approx(steady.winding, rel=1e-9), name
    assert found.housing_mean == pytest.approx(steady.housing, rel=1e-9)
    alone = periodic_heat(motor, ambient, 3.0 * np.ones(1), current**2)
    mean = steady_winding_temperature(ambient, motor.R_25, motor.R_th1, motor.R_th2, current)
    assert alone.winding_mean == pytest.approx(mean, rel=1e-9)


def test_one_body_on_and_off_by_hand():
    # a housing that keeps the ambient's temperature: each half is one exponential
    motor = TwoBodies(R_25=1.9, R_th1=4.0, R_th2=1e-9, tau_w=8.0, tau_h=0.5)
    on, off, square = 3.0, 5.0, 6.0
    at_ambient = 1.0 + COPPER * (AMBIENT - DATA_TEMPERATURE)
    growth = 1.0 - COPPER * motor.R_th1 * motor.R_25 * square
    limit = motor.R_th1 * motor.R_25 * square * at_ambient / growth
    warming, cooling = exp(-on * growth / motor.tau_w), exp(-off / motor.tau_w)
    peak = limit * (1.0 - warming) / (1.0 - warming * cooling)
    found = periodic_heat(motor, AMBIENT, [on, off], [square, 0.0])
    assert found.winding_peak - AMBIENT == pytest.approx(peak, abs=1e-6)  # K
    assert found.winding[0] - AMBIENT == pytest.approx(peak * cooling, abs=1e-6)
    assert found.winding_peak_time == on
    assert found.spectral_radius == pytest.approx(warming * cooling, rel=1e-6)


def test_the_winding_peaks_within_a_segment():
    # the housing's loss has stopped, the winding still warms up towards it, and then cools with it
    motor = TwoBodies(R_25=1.9, R_th1=4.0, R_th2=7.0, tau_w=40.0, tau_h=90.0)
    dt, squares, losses = np.array([20.0, 75.0]), np.array([0.0, 0.0]), np.array([15.0, 0.0])
    found = periodic_heat(motor, AMBIENT, dt, squares, losses)
    assert found.winding_peak > max(found.winding) + 1.0
    assert 20.0 < found.winding_peak_time < 95.0
    split = [20.0, found.winding_peak_time - 20.0, 95.0 - found.winding_peak_time]
    finer = periodic_heat(motor, AMBIENT, split, 0.0, [15.0, 0.0, 0.0])
    assert finer.winding[2] == pytest.approx(found.winding_peak, abs=1e-10)
    start = (found.winding[0], found.housing[0])
    _, warmest = integrated(motor, AMBIENT, start, dt, squares, losses, max_step=0.01)
    assert 0.0 <= found.winding_peak - warmest < 1e-6  # K: dense samples miss the top by their step
    assert found.housing_peak == found.housing[1] < found.housing.max() + 1e-12


@given(cycles())
@settings(max_examples=50)
def test_no_sample_is_warmer_than_the_peak(case):
    motor, dt, squares, losses = case
    found = periodic_heat(motor, AMBIENT, dt, squares, losses)
    parts = 200
    fine = periodic_heat(
        motor, AMBIENT, np.repeat(dt / parts, parts), np.repeat(squares, parts), np.repeat(losses, parts)
    )
    assert fine.winding.max() <= found.winding_peak * (1.0 + 1e-12)
    assert fine.housing.max() <= found.housing_peak * (1.0 + 1e-12)
    assert fine.winding_peak == pytest.approx(found.winding_peak, rel=1e-12)


def test_resistance_that_grows_counts_and_so_does_the_ripple(monkeypatch):
    """Mean formula < peak with the resistance held at that mean < exact peak."""
    dt, squares = [12.0, 78.0], [9.0, 0.0]
    rms = sqrt(9.0 * 12.0 / 90.0)
    mean = steady_winding_temperature(AMBIENT, MOTOR.R_25, MOTOR.R_th1, MOTOR.R_th2, rms)
    peak = periodic_heat(MOTOR, AMBIENT, dt, squares).winding_peak
    monkeypatch.setattr(heat_step, "COPPER", 0.0)
    held = replace(MOTOR, R_25=MOTOR.R_25 * (1.0 + COPPER * (mean - DATA_TEMPERATURE)))
    frozen = periodic_heat(held, AMBIENT, dt, squares).winding_peak
    assert mean + 20.0 < frozen
    assert frozen + 2.0 < peak


def test_short_cycles_keep_their_digits():
    # 1 ms of a motor that takes 10 minutes: the mean, to which the ripple adds next to nothing
    found = periodic_heat(MOTOR, AMBIENT, [0.0004, 0.0006], [2.5, 0.0], [0.0, 0.5])
    steady = steady_state(MOTOR, AMBIENT, 1.0, 0.3)
    assert found.winding_mean == pytest.approx(steady.winding, abs=1e-8)  # K
    assert found.winding_peak == pytest.approx(steady.winding, abs=1e-3)


def test_a_recorded_cycle_of_36000_samples():
    random = np.random.default_rng(7)
    squares = random.exponential(0.9, 36_000)
    found = periodic_heat(MOTOR, AMBIENT, np.full(36_000, 0.01), squares, random.uniform(0.0, 0.6, 36_000))
    assert found.winding[-1] == pytest.approx(found.winding[0], abs=1e-9)
    halves = found.winding_mean, found.housing_mean
    copper = (halves[0] - halves[1]) / MOTOR.R_th1
    assert MOTOR.R_25 * squares.mean() < copper < 1.5 * MOTOR.R_25 * squares.mean()
    assert found.winding_peak == pytest.approx(found.winding.max(), abs=1e-6)


def divided(nodes):
    """Divided difference of exp to 120 digits; nodes that coincide are told apart by 1e-30."""
    with localcontext() as context:
        context.prec = 120
        distinct = [Decimal(node) + Decimal(n) * Decimal("1e-30") for n, node in enumerate(nodes)]
        table = [node.exp() for node in distinct]
        for width in range(1, len(nodes)):
            table = [(b - a) / (distinct[n + width] - distinct[n]) for n, (a, b) in enumerate(pairwise(table))]
    return float(table[0])


@pytest.mark.parametrize("fast", [1e-9, 1e-3, 0.3, 0.99, 1.01, 7.0, 90.0, 6e4])
@pytest.mark.parametrize("slow", [0.9999999, 0.999, 0.5, 1e-5, 0.0, -0.8, -5.0, -60.0])
def test_divided_differences_hold_at_any_spread(fast, slow):
    f, s = -fast, -slow * fast if slow > 0.0 else -slow  # between, or above zero: a winding that runs away
    expected = (divided([f, 0.0]), divided([f, s, 0.0]), divided([f, 0.0, 0.0]), divided([f, s, 0.0, 0.0]))
    others = np.array([-3e-4, -0.7, -900.0])  # whatever else there is to do at the same time
    for company in (others[:0], others[:2], others):
        found = heat_step.phi(np.append(f, company), np.append(s, 0.4 * company))
        assert [values[0] for values in found] == pytest.approx(expected, rel=1e-11)


# --- edges -----------------------------------------------------------------------------------------------------------


def test_more_heat_than_can_be_carried_off_runs_away():
    limit = 1.0 / (COPPER * MOTOR.R_25 * (MOTOR.R_th1 + MOTOR.R_th2))
    below = periodic_heat(MOTOR, AMBIENT, [2.0, 3.0], limit * 0.999)
    above = periodic_heat(MOTOR, AMBIENT, [2.0, 3.0], limit * 1.001)
    at = periodic_heat(MOTOR, AMBIENT, [2.0, 3.0], limit)
    assert below.spectral_radius < 1.0 < above.spectral_radius
    assert at.spectral_radius == pytest.approx(1.0, abs=1e-15)
    assert below.winding_peak < inf == above.winding_peak == above.winding_mean == above.housing_peak
    assert (above.winding == inf).all()
    assert isnan(above.winding_peak_time)
    assert steady_state(MOTOR, AMBIENT, sqrt(limit * 1.001)) == (inf, inf)


def test_a_pulse_beyond_the_limit_is_borne_with_a_pause_and_not_without():
    square = 3.0 / (COPPER * MOTOR.R_25 * (MOTOR.R_th1 + MOTOR.R_th2))
    borne = periodic_heat(MOTOR, AMBIENT, [1.5, 14.0], [square, 0.0])
    assert borne.winding_peak < inf
    start = (borne.winding[0], borne.housing[0])
    end, warmest = integrated(MOTOR, AMBIENT, start, [1.5, 14.0], [square, 0.0], [0.0, 0.0])
    assert end == pytest.approx(start, abs=1e-7)  # K
    assert warmest == pytest.approx(borne.winding_peak, abs=1e-7)
    assert periodic_heat(MOTOR, AMBIENT, [9.0, 14.0], [square, 0.0]).winding_peak == inf
    for seconds in (1e4, 1e8):  # beyond what a float holds
        assert periodic_heat(MOTOR, AMBIENT, [seconds, 14.0], [square * 9.0, 0.0]).winding_peak == inf


def test_without_current_the_motor_is_as_warm_as_the_air():
    found = periodic_heat(MOTOR, AMBIENT, [2.0, 3.0], 0.0)
    assert found.winding.tolist() == found.housing.tolist() == [AMBIENT] * 3
    assert found.winding_peak == found.winding_mean == found.housing_peak == found.housing_mean == AMBIENT
    only_friction = periodic_heat(MOTOR, AMBIENT, [2.0, 3.0], 0.0, 1.5)
    assert only_friction.winding_mean == pytest.approx(AMBIENT + 1.5 * MOTOR.R_th2, abs=1e-9)


@pytest.mark.parametrize("name", ["R_25", "R_th1", "R_th2", "tau_w", "tau_h"])
@pytest.mark.parametrize("figure", [nan, 0.0, inf])
def test_a_missing_figure_gives_nothing(name, figure):
    motor = replace(MOTOR, **{name: figure})
    found = periodic_heat(motor, AMBIENT, T, I2, P_H)
    assert isnan(found.winding_peak) and isnan(found.housing_mean) and isnan(found.spectral_radius)
    assert np.isnan(found.winding).all()
    assert isnan(steady_state(motor, AMBIENT, 1.0).winding)
    assert isnan(overload_time(motor, AMBIENT, cold(AMBIENT), 398.15, 4.0))


def test_unknown_operation_gives_nothing():
    assert isnan(periodic_heat(MOTOR, nan, T, I2, P_H).winding_peak)
    assert isnan(periodic_heat(MOTOR, AMBIENT, T, [*I2[:3], nan], P_H).winding_peak)
    assert isnan(periodic_heat(MOTOR, AMBIENT, T, I2, nan).winding_peak)
    assert isnan(periodic_heat(MOTOR, AMBIENT, [*T[:3], nan], I2, P_H).winding_peak)
    assert isnan(steady_state(MOTOR, AMBIENT, 1.0, nan).housing)
    for arguments in [(nan, 4.0, 0.1), (398.15, nan, 0.1), (398.15, 4.0, nan)]:
        assert isnan(overload_time(MOTOR, AMBIENT, cold(AMBIENT), *arguments))


@pytest.mark.parametrize("dt", [[], [[1.0, 2.0]], [-1.0, 2.0], [0.0, 0.0]])
def test_no_cycle_is_an_error(dt):
    with pytest.raises(InputError, match="heat cycle"):
        periodic_heat(MOTOR, AMBIENT, dt, 1.0)
    with pytest.raises(InputError, match="heat cycle"):
        periodic_heat(MOTOR, AMBIENT, [1.0, 2.0], [1.0, -1.0])


def test_segments_so_long_that_all_settles_within_them():
    # the housing's loss alone: up to R_th2 P and down to the ambient again, in each case long before the segment ends
    found = periodic_heat(QUICK, AMBIENT, [9e3, 7e3, 8e3], 0.0, [0.0, 3.0, 0.0])
    assert found.winding_peak - AMBIENT == pytest.approx(3.0 * QUICK.R_th2, rel=1e-12)
    assert found.housing_peak - AMBIENT == pytest.approx(3.0 * QUICK.R_th2, rel=1e-12)
    # a pulse, then friction: the winding cools towards the housing, overtakes nothing, and peaks where the pulse ends
    pulse = periodic_heat(QUICK, AMBIENT, [3.0, 7e3, 8e3], [60.0, 0.0, 0.0], [0.0, 2.0, 0.0])
    end, _ = integrated(QUICK, AMBIENT, cold(AMBIENT), [3.0], [60.0], [0.0])
    assert pulse.winding_peak == pytest.approx(end[0], abs=1e-8)
    assert pulse.winding_peak_time == 3.0
    # after it the housing goes on warming up for a while, and is back at the ambient in the end
    assert pulse.housing[1] + 0.5 < pulse.housing_peak
    times = np.linspace(0.0, 200.0, 2001)
    sampled = max(exact(QUICK, AMBIENT, end, t, 0.0, 2.0)[1] for t in times)
    assert pulse.housing_peak == pytest.approx(sampled, abs=1e-3) and pulse.housing_peak >= sampled - 1e-9


def test_a_winding_that_has_run_away_does_not_come_back_in_a_long_pause():
    limit = 1.0 / (COPPER * QUICK.R_25 * (QUICK.R_th1 + QUICK.R_th2))
    for pause in (50.0, 900.0, 4e4):
        found = periodic_heat(QUICK, AMBIENT, [300.0, pause], [4.0 * limit, 0.0])
        assert found.winding_peak == inf
        assert found.spectral_radius > 1.0


def test_a_segment_without_duration_counts_for_nothing():
    with_it = periodic_heat(MOTOR, AMBIENT, [2.0, 0.0, 3.0], [2.0, 900.0, 0.0])
    assert with_it.winding_peak == pytest.approx(periodic_heat(MOTOR, AMBIENT, [2.0, 3.0], [2.0, 0.0]).winding_peak)


# --- overload --------------------------------------------------------------------------------------------------------


def test_overload_of_one_body_by_hand():
    motor = TwoBodies(R_25=1.9, R_th1=4.0, R_th2=1e-9, tau_w=8.0, tau_h=0.5)
    growth = 1.0 - COPPER * motor.R_th1 * motor.R_25 * 5.0**2
    limit = motor.R_th1 * motor.R_25 * 5.0**2 * (1.0 + COPPER * (AMBIENT - DATA_TEMPERATURE)) / growth
    time = -motor.tau_w / growth * log(1.0 - 60.0 / limit)
    assert overload_time(motor, AMBIENT, cold(AMBIENT), AMBIENT + 60.0, 5.0) == pytest.approx(time, rel=1e-7)


@pytest.mark.parametrize(("start", "current", "loss"), [
    pytest.param(cold(AMBIENT), 4.0, 0.0, id="cold"),
    pytest.param(steady_state(MOTOR, AMBIENT, 0.9, 0.2), 4.0, 0.2, id="warm"),
    pytest.param(State(AMBIENT + 60.0, AMBIENT), 1.4, 0.7, id="winding falls towards a cold housing first"),
    pytest.param(cold(AMBIENT), 12.0, 0.0, id="runs away"),
    pytest.param(cold(AMBIENT), 0.0, 9.0, id="friction alone"),
])  # fmt: skip
def test_overload_against_scipy(start, current, loss):
    T_max = AMBIENT + 80.0

    def limit(_, x):
        return x[0] - T_max

    limit.terminal = True
    law = slopes(MOTOR, AMBIENT, current**2, loss)
    found = solve_ivp(law, (0.0, 4000.0), start, method="DOP853", rtol=1e-12, atol=1e-10, events=limit, max_step=20.0)
    assert found.t_events[0].size == 1
    time = overload_time(MOTOR, AMBIENT, start, T_max, current, loss)
    assert time == pytest.approx(found.t_events[0][0], rel=1e-7)


@given(motors(), st.floats(0.0, 60.0), st.floats(0.0, 60.0), st.floats(0.01, 30.0), st.floats(0.0, 40.0))
def test_the_winding_is_at_its_limit_when_the_time_is_over(motor, warm_w, warm_h, share, rise):
    start, T_max = State(AMBIENT + warm_w, AMBIENT + warm_h), AMBIENT + 70.0
    square = share / (COPPER * motor.R_25 * (motor.R_th1 + motor.R_th2))
    loss = rise / motor.R_th2
    time = overload_time(motor, AMBIENT, start, T_max, sqrt(square), loss)
    if time < inf:
        assert exact(motor, AMBIENT, start, time, square, loss)[0] == pytest.approx(T_max, abs=1e-7)
        before = [exact(motor, AMBIENT, start, time * s, square, loss)[0] for s in (0.01, 0.2, 0.5, 0.9, 0.999)]
        assert max(before) <= T_max + 1e-9
    else:
        assert steady_state(motor, AMBIENT, sqrt(square), loss).winding <= T_max + 1e-6
        times = np.linspace(0.0, 20.0 * motor.tau_h, 300)
        assert max(exact(motor, AMBIENT, start, t, square, loss)[0] for t in times) < T_max + 1e-6


def test_overload_that_never_ends_or_never_begins():
    assert overload_time(MOTOR, AMBIENT, cold(AMBIENT), 373.15, 1.0) == inf  # settles below
    assert overload_time(MOTOR, AMBIENT, cold(AMBIENT), 373.15, 0.0) == inf
    assert overload_time(MOTOR, AMBIENT, State(AMBIENT + 30.0, AMBIENT), 373.15, 0.0) == inf  # only cools
    assert overload_time(MOTOR, AMBIENT, cold(AMBIENT), inf, 4.0) == inf
    for start in (State(373.15, AMBIENT), State(380.0, AMBIENT), steady_state(MOTOR, AMBIENT, 12.0)):
        assert overload_time(MOTOR, AMBIENT, start, 373.15, 4.0) == 0.0


def test_a_hot_housing_lifts_the_winding_over_its_limit_for_a_while():
    start, settled = State(AMBIENT, AMBIENT + 110.0), steady_state(MOTOR, AMBIENT, 0.5)
    assert settled.winding < AMBIENT + 80.0
    time = overload_time(MOTOR, AMBIENT, start, AMBIENT + 80.0, 0.5)
    assert exact(MOTOR, AMBIENT, start, time, 0.25, 0.0)[0] == pytest.approx(AMBIENT + 80.0, abs=1e-8)
    assert overload_time(MOTOR, AMBIENT, start, AMBIENT + 108.0, 0.5) == inf  # its top is lower than that


def test_a_warm_motor_withstands_less():
    times = [
        overload_time(MOTOR, AMBIENT, steady_state(MOTOR, AMBIENT, rms), 398.15, 4.0) for rms in (0.0, 0.4, 0.8, 1.2)
    ]
    assert times == sorted(times, reverse=True) and len(set(times)) == 4
