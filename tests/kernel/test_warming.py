"""Winding and housing: a span against SciPy's matrix exponential, a cycle and an overload against its integrator.

Resistances, time constants and durations differ everywhere: no ratio is 1.
"""

from __future__ import annotations

from dataclasses import fields
from math import inf, log, sqrt
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from kernel_cycles import warmed
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from drivesizer.kernel.warming import State, after, overload_time, steady_state
from drivesizer.physics.thermal import COPPER, DATA_TEMPERATURE, TwoBodies
from drivesizer.physics.winding import temperature_of_pulses

MOTOR = TwoBodies(R_25=2.32, R_th1=3.1, R_th2=14.0, tau_w=12.4, tau_h=612.0)  # an RE 25, near enough
ONE = TwoBodies(R_25=1.9, R_th1=4.0, R_th2=1e-9, tau_w=8.0, tau_h=0.5)  # its housing keeps the ambient's temperature
AMBIENT = 304.0  # K
COLD = State(AMBIENT, AMBIENT)
NAMES = [figure.name for figure in fields(TwoBodies)]


def slopes(motor, square, loss):
    """The law as it stands in the module's docstring, in absolute temperatures."""
    C_w, C_h = motor.tau_w / motor.R_th1, motor.tau_h / motor.R_th2

    def law(_, x):
        through = (x[0] - x[1]) / motor.R_th1
        copper = motor.R_25 * square * (1.0 + COPPER * (x[0] - DATA_TEMPERATURE))
        return [(copper - through) / C_w, (loss + through - (x[1] - AMBIENT) / motor.R_th2) / C_h]

    return law


def exact(motor, start, t, square, loss):
    """The state after a time, by SciPy's matrix exponential of law and constant together."""
    law = slopes(motor, square, loss)
    constant = np.array(law(0.0, [0.0, 0.0]))
    matrix = np.zeros((3, 3))
    matrix[:2, 0], matrix[:2, 1] = law(0.0, [1.0, 0.0]) - constant, law(0.0, [0.0, 1.0]) - constant
    matrix[:2, 2] = constant
    return (expm(matrix * t) @ [*start, 1.0])[:2]


@st.composite
def motors(draw):
    ranges = ((0.05, 90.0), (0.3, 30.0), (0.9, 60.0), (0.7, 70.0), (90.0, 2300.0))
    return TwoBodies(**{name: draw(st.floats(*ends)) for name, ends in zip(NAMES, ranges, strict=True)})


# --- over a span and in the long run


@given(motors(), st.floats(0.0, 60.0), st.floats(0.0, 60.0), st.floats(0.0, 3.0), st.floats(0.0, 40.0),
       st.floats(1e-4, 100.0))  # fmt: skip
def test_a_span_ends_where_the_matrix_exponential_says(motor, warm_w, warm_h, share, rise, t):
    start, square = (
        State(AMBIENT + warm_w, AMBIENT + warm_h),
        share / (COPPER * motor.R_25 * (motor.R_th1 + motor.R_th2)),
    )
    expected = exact(motor, start, t, square, rise / motor.R_th2)
    found = after(motor, AMBIENT, start, square, rise / motor.R_th2, t)
    if expected[0] < 1e4:
        assert tuple(found) == pytest.approx(tuple(expected), rel=1e-9)
    else:
        assert found.winding > 5e3


@given(motors(), st.floats(0.0, 0.95), st.floats(0.0, 40.0))
def test_what_is_steady_stays(motor, share, rise):
    current = sqrt(share / (COPPER * motor.R_25 * (motor.R_th1 + motor.R_th2)))
    steady = steady_state(motor, AMBIENT, current, rise / motor.R_th2)
    assert slopes(motor, current**2, rise / motor.R_th2)(0.0, steady) == pytest.approx((0.0, 0.0), abs=1e-6)
    assert tuple(after(motor, AMBIENT, steady, current**2, rise / motor.R_th2, 900.0)) == pytest.approx(
        steady, rel=1e-9
    )


def test_more_heat_than_can_be_carried_off_runs_away():
    limit = 1.0 / (COPPER * MOTOR.R_25 * (MOTOR.R_th1 + MOTOR.R_th2))
    assert steady_state(MOTOR, AMBIENT, sqrt(limit * 1.001)) == (inf, inf)
    assert after(MOTOR, AMBIENT, COLD, limit * 1.001, 0.0, 1e9).winding > 1e9
    assert np.isfinite(steady_state(MOTOR, AMBIENT, sqrt(limit * 0.999))).all()


# --- over a cycle


def test_a_pulse_beyond_the_limit_is_borne_with_a_pause_and_not_without():
    one = TwoBodies(**{name: np.array([getattr(MOTOR, name)]) for name in NAMES})
    square = 3.0 / (COPPER * MOTOR.R_25 * (MOTOR.R_th1 + MOTOR.R_th2))
    assert warmed(one, AMBIENT, [1.5, 14.0], [[square, 0.0]], 0.0).peak[0] < inf
    for seconds, factor in ((9.0, 1.0), (1e4, 9.0), (1e8, 9.0)):  # beyond what a float holds
        assert warmed(one, AMBIENT, [seconds, 14.0], [[square * factor, 0.0]], 0.0).peak[0] == inf


PIECES = st.lists(st.tuples(st.floats(0.05, 90.0), st.floats(0.0, 1.4), st.floats(0.0, 3.0)), min_size=1, max_size=5)


@given(motors(), PIECES)
def test_all_heat_of_a_cycle_as_one_pulse_warms_a_winding_no_less_and_a_quick_cycle_as_its_mean(motor, pieces):
    one = TwoBodies(**{name: np.array([getattr(motor, name)]) for name in NAMES})
    t, share, losses = np.array(pieces).T
    squares = share / (COPPER * motor.R_25 * (motor.R_th1 + motor.R_th2))
    figures = {"resistance": one.R_25, "data_temperature": np.array([DATA_TEMPERATURE])}
    names = ("thermal_resistance_winding", "thermal_resistance_housing", "winding_time_constant", "motor_time_constant")
    figures |= zip(names, (one.R_th1, one.R_th2, one.tau_w, one.tau_h), strict=True)
    square, loss = (np.average(x, weights=t) for x in (squares, losses))

    def bound(total):
        cycle = SimpleNamespace(load_cycle=SimpleNamespace(total=total))
        demands, heat = SimpleNamespace(rms_current=np.sqrt([square])), SimpleNamespace(mean=np.array([loss]))
        return temperature_of_pulses(AMBIENT, cycle, demands, heat, figures)[0]

    assert warmed(one, AMBIENT, t, [squares], [losses]).peak[0] <= bound(t.sum()) * (1.0 + 1e-9)
    assert bound(0.0) == pytest.approx(steady_state(motor, AMBIENT, sqrt(square), loss).winding, rel=1e-9)


# --- overload


def test_overload_of_one_body_by_hand():
    growth = 1.0 - COPPER * ONE.R_th1 * ONE.R_25 * 5.0**2
    limit = ONE.R_th1 * ONE.R_25 * 5.0**2 * (1.0 + COPPER * (AMBIENT - DATA_TEMPERATURE)) / growth
    time = -ONE.tau_w / growth * log(1.0 - 60.0 / limit)
    assert overload_time(ONE, AMBIENT, COLD, AMBIENT + 60.0, 5.0) == pytest.approx(time, rel=1e-7)


@pytest.mark.parametrize(("start", "current", "loss"), [
    pytest.param(COLD, 4.0, 0.0, id="cold"),
    pytest.param(steady_state(MOTOR, AMBIENT, 0.9, 0.2), 4.0, 0.2, id="warm"),
    pytest.param(State(AMBIENT + 60.0, AMBIENT), 1.4, 0.7, id="winding falls towards a cold housing first"),
    pytest.param(COLD, 12.0, 0.0, id="runs away"),
    pytest.param(COLD, 0.0, 9.0, id="friction alone"),
])  # fmt: skip
def test_overload_against_scipy(start, current, loss):
    T_max = AMBIENT + 80.0

    def limit(_, x):
        return x[0] - T_max

    limit.terminal = True
    found = solve_ivp(slopes(MOTOR, current**2, loss), (0.0, 4000.0), start, method="DOP853", rtol=1e-12, atol=1e-10,
                      events=limit, max_step=20.0)  # fmt: skip
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
        assert exact(motor, start, time, square, loss)[0] == pytest.approx(T_max, abs=1e-7)
        assert max(exact(motor, start, time * s, square, loss)[0] for s in (0.01, 0.2, 0.5, 0.9, 0.999)) <= T_max + 1e-9
    else:
        assert steady_state(motor, AMBIENT, sqrt(square), loss).winding <= T_max + 1e-6
        times = np.linspace(0.0, 20.0 * motor.tau_h, 300)
        assert max(exact(motor, start, t, square, loss)[0] for t in times) < T_max + 1e-6


def test_overload_that_never_ends_or_never_begins():
    for start, T_max, current in (
        (COLD, 373.15, 1.0),  # settles below
        (COLD, 373.15, 0.0),
        (State(AMBIENT + 30.0, AMBIENT), 373.15, 0.0),  # only cools
        (COLD, inf, 4.0),
    ):
        assert overload_time(MOTOR, AMBIENT, start, T_max, current) == inf
    for start in (State(373.15, AMBIENT), State(380.0, AMBIENT), steady_state(MOTOR, AMBIENT, 12.0)):
        assert overload_time(MOTOR, AMBIENT, start, 373.15, 4.0) == 0.0
