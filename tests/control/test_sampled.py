"""Sampled linear systems, held against python-control, SciPy and closed forms."""

from __future__ import annotations

import math

import control
import numpy as np
import pytest
from scipy.linalg import expm

from drivesizer.control.sampled import (
    System,
    beside,
    delayed,
    fed_back,
    first_order,
    frequency_response,
    gain,
    in_series,
    poles,
    sampled,
    step_response,
    value_at,
)

T = 4e-4
W = np.geomspace(1.0, 0.999 * math.pi / T, 60)
LOOP = in_series(
    delayed(2, T), beside(beside(gain(0.3, T), first_order(0.02, 0.0, 1.0, T)), first_order(0.4, -0.4, 0.6, T))
)
THEIRS = (
    control.tf([1], [1, 0, 0], T)
    * (0.3 + control.tf([0.02, 0], [1, -1], T) + control.tf([0.4, -0.4], [1, -0.6], T))
)  # fmt: skip


def test_pieces_in_series_and_beside_each_other_are_python_control_s():
    z = np.exp(1j * W * T)
    assert frequency_response(LOOP)(W) == pytest.approx(THEIRS(z), rel=1e-9)
    assert [value_at(LOOP, one) for one in z] == pytest.approx(THEIRS(z), rel=1e-9)
    assert sorted(abs(poles(LOOP))) == pytest.approx([0.0, 0.0, 0.6, 1.0], abs=1e-12)


def test_a_step_of_the_closed_loop_is_python_control_s():
    closed = fed_back(LOOP, [1.0])
    time = np.arange(300) * T
    theirs = control.step_response(control.feedback(THEIRS, 1), time).outputs
    assert step_response(closed, 300) == pytest.approx(theirs, abs=1e-12)
    assert step_response(closed, 1).tolist() == [0.0]
    assert value_at(closed, 1.0).real == pytest.approx(1.0, rel=1e-12)  # an integral leaves no error


@pytest.mark.parametrize("stiffness", [3.0, 3e8])
def test_a_held_input_is_the_matrix_exponential(stiffness):
    """Motor and load on a shaft from soft to stiff: entries over 14 powers of ten."""
    A = np.array([[-900.0, -40.0, 0, 0], [2e4, -0.5, 0.2, -stiffness], [0, 0.1, -0.1, stiffness / 9], [0, 1, -1, 0]])
    B, n = np.array([[1.7e3], [0.0], [0.0], [0.0]]), 4
    found = sampled(System(A, B, np.eye(4), np.zeros((4, 1)), 0.0), 4e-5)
    expected = expm(4e-5 * np.block([[A, B], [np.zeros((1, 5))]]))
    both = np.hstack([found.A, found.B])
    assert np.abs(both - expected[:n]).max() < 1e-12 * np.abs(expected).max()


def test_the_response_of_many_states_needs_no_distinct_poles():
    """A mean over 40 periods: all poles at 0, where eigenvectors are of no use; its closed form is a geometric sum."""
    mean = System(np.eye(40, k=-1), np.eye(40, 1), np.full((1, 40), 1 / 40), np.zeros((1, 1)), T)
    turned = in_series(delayed(1, T), mean)
    z = np.exp(1j * W * T)
    expected = (1.0 - z**-40) / (40.0 * (z - 1.0)) / z
    assert frequency_response(turned)(W) == pytest.approx(expected, abs=1e-12)
    assert frequency_response(gain(-2.5, T))(W).tolist() == [-2.5] * len(W)


def test_at_a_pole_there_is_no_value():
    assert math.isnan(value_at(first_order(1.0, 0.0, 1.0, T), 1.0).real)
    response = frequency_response(beside(first_order(1.0, 0.0, 1.0, T), first_order(1.0, 0.0, -1.0, T)))
    assert np.isnan(response(np.array([0.0, 0.1 / T]))).tolist() == [True, False]


@pytest.mark.parametrize("row", [None, [1.0]])
def test_a_loop_with_a_long_delay_is_python_control_s(row):
    """Sixty states that only repeat others: of the closed loop too, where what they end in is fed back."""
    loop = in_series(delayed(60, T), first_order(0.01, 0.002, 0.9, T))
    loop = fed_back(loop, row) if row else loop
    theirs = control.frequency_response(control.ss(*loop), W, squeeze=True).complex
    assert frequency_response(loop)(W) == pytest.approx(theirs, rel=1e-9, abs=1e-12)


def test_states_that_repeat_each_other_in_a_circle_are_solved_as_others():
    round_and_round = System(np.roll(np.eye(3), 1, axis=0), np.zeros((3, 1)), np.ones((1, 3)), np.ones((1, 1)), T)
    assert frequency_response(round_and_round)(W) == pytest.approx(np.ones(len(W)), abs=1e-12)
