"""Power, energy and time above a current: closed forms, and the same by fine sampling."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivesizer.physics import waveform
from drivesizer.physics.waveform import (
    Wave,
    energy,
    largest_power,
    longest_above,
    mean_square,
    most_stored,
    wave,
)

FINE = 4000  # samples of a segment


def one(*segments):
    """A wave of one candidate from (time, current at both ends, voltage at both ends)."""
    time, current, voltage = zip(*segments, strict=True)
    return Wave(np.array(time, float), np.array([current], float), np.array([voltage], float))


def sampled(found):
    """Time, current and voltage in the middle of many short steps, and their length."""
    share = (np.arange(FINE) + 0.5) / FINE
    i, v = (x[0, :, :1] + share * (x[0, :, 1:] - x[0, :, :1]) for x in (found.current, found.voltage))
    step = np.repeat(found.duration / FINE, FINE)
    return i.ravel(), v.ravel(), step


def run_of(above, step):
    """Longest time on end in which something holds, the cycle repeating."""
    if above.all():
        return float(step.sum())
    longest = now = 0.0
    for holds, time in zip(np.tile(above, 2), np.tile(step, 2), strict=True):
        now = now + time if holds else 0.0
        longest = max(longest, now)
    return longest


amps, spans = st.floats(-6, 6).map(lambda x: round(x, 2)), st.floats(0.05, 3).map(lambda x: round(x, 3))
segments = st.lists(st.tuples(spans, st.tuples(amps, amps), st.tuples(amps, amps)), min_size=1, max_size=6)


@settings(max_examples=60)
@given(segments)
def test_energy_against_fine_sampling(rows):
    found = one(*rows)
    i, v, step = sampled(found)
    flow = i * v * step
    sums = energy(found)
    size = 1e-6 * np.abs(flow).sum() + 1e-9
    assert sums.drawn[0] == pytest.approx(flow[flow > 0].sum(), abs=50 * size)
    assert sums.returned[0] == pytest.approx(-flow[flow < 0].sum(), abs=50 * size)
    total = sum(t / 6 * (a * c + (a + b) * (c + d) + b * d) for t, (a, b), (c, d) in rows)
    assert sums.drawn[0] - sums.returned[0] == pytest.approx(total, rel=1e-12, abs=1e-12 * sums.drawn[0] + 1e-12)
    if sums.returned[0] <= sums.drawn[0]:
        held = most = 0.0
        for x in np.tile(flow, 2):
            held = max(held - x, 0.0)
            most = max(most, held)
        assert sums.stored[0] == pytest.approx(most, abs=100 * size)


@settings(max_examples=60)
@given(segments)
def test_largest_power_against_fine_sampling(rows):
    found = one(*rows)
    i, v, _ = sampled(found)
    ends = (found.current * found.voltage).ravel()
    power, when = largest_power(found)
    highest = max((i * v).max(), ends.max())
    assert power[0] >= highest - 1e-12 * abs(highest)
    assert power[0] == pytest.approx(highest, abs=1e-5)
    at_that_time = []
    for k, end in enumerate(np.cumsum(found.duration)):
        place = 1.0 + (when[0] - end) / found.duration[k]
        if -1e-9 < place < 1 + 1e-9:
            a, b = (x[0, k, 0] + place * (x[0, k, 1] - x[0, k, 0]) for x in (found.current, found.voltage))
            at_that_time.append(a * b)
    assert max(at_that_time) == pytest.approx(power[0], rel=1e-9, abs=1e-9)


@settings(max_examples=60)
@given(segments, st.integers(1, 500).map(lambda n: n / 100 + 0.005))
def test_longest_above_against_fine_sampling(rows, limit):
    found = one(*rows)
    i, _, step = sampled(found)
    expected = run_of(np.abs(i) > limit, step)
    assert longest_above(found, np.array([limit]))[0] == pytest.approx(expected, abs=2.1 * step.max())


def test_constant():
    found = one((4.0, (3.0, 3.0), (7.0, 7.0)))
    assert [x[0] for x in energy(found)] == [84.0, 0.0, 0.0]
    assert largest_power(found)[0][0] == 21.0
    assert longest_above(found, np.array([2.9]))[0] == 4.0
    assert longest_above(found, np.array([3.0]))[0] == 0.0  # above, not at
    assert mean_square(found)[0, 0] == 9.0


def test_ramp():
    """I = t, V = 2 t over 3 s: P = 2 t^2, E = 18, and above 1 for 2 s."""
    found = one((3.0, (0.0, 3.0), (0.0, 6.0)))
    assert energy(found).drawn[0] == pytest.approx(18.0, rel=1e-14)
    assert [x[0] for x in largest_power(found)] == [18.0, 3.0]
    assert longest_above(found, np.array([1.0]))[0] == pytest.approx(2.0, rel=1e-14)
    assert mean_square(found)[0, 0] == pytest.approx(3.0, rel=1e-14)


def test_sign_changes_inside_one_segment():
    """I = 1 - t, V = 2 over 3 s: 1 J drawn, 4 J returned. I = 1 - t, V = 2 - t: returned between 1 s and 2 s, 1/6 J."""
    first, second = one((3.0, (1.0, -2.0), (2.0, 2.0))), one((3.0, (1.0, -2.0), (2.0, -1.0)))
    assert (energy(first).drawn[0], energy(first).returned[0]) == pytest.approx((1.0, 4.0), rel=1e-14)
    assert (energy(second).drawn[0], energy(second).returned[0]) == pytest.approx((5 / 6 + 5 / 6, 1 / 6), rel=1e-13)
    assert energy(second).stored[0] == pytest.approx(1 / 6, rel=1e-13)


def test_the_vertex_of_power_between_the_ends():
    """I = t, V = 3 - t over 3 s: nothing at both ends, 2.25 W in the middle."""
    power, when = largest_power(one((3.0, (0.0, 3.0), (3.0, 0.0))))
    assert (power[0], when[0]) == pytest.approx((2.25, 1.5), rel=1e-14)


def test_time_above_goes_on_over_the_end_of_the_cycle():
    found = one((2.0, (4.0, 4.0), (1.0, 1.0)), (5.0, (1.0, 1.0), (1.0, 1.0)), (3.0, (4.0, -4.0), (1.0, 1.0)))
    assert longest_above(found, np.array([2.0]))[0] == pytest.approx(0.75 + 2.0)  # the last quarter, then the first 2 s
    assert longest_above(found, np.array([0.5]))[0] == pytest.approx(3 * 7 / 16 + 2.0 + 5.0 + 3 * 7 / 16)


def test_the_whole_cycle_above():
    """A change of sign in a jump is no break; what never ends is as long as the cycle is told to be."""
    found = one((2.0, (4.0, 3.0), (1.0, 1.0)), (5.0, (-3.0, -6.0), (1.0, 1.0)))
    assert longest_above(found, np.array([2.0]))[0] == pytest.approx(7.0)


def test_never_above_and_unknown_limits():
    found = one((2.0, (1.0, -1.0), (1.0, 1.0)))
    assert longest_above(found, np.array([1.5]))[0] == 0.0
    assert math.isnan(longest_above(found, np.array([math.nan]))[0])


def test_what_comes_back_in_several_pieces_adds_up_unless_drawn_between():
    """-3 J, -2 J, +1 J, -4 J, +20 J: 5, then 4, then 8 J at most; however the cycle is turned."""
    joules = [-3.0, -2.0, 1.0, -4.0, 20.0]
    for turn in range(5):
        rows = [(1.0, (j / 2, j / 2), (2.0, 2.0)) for j in joules[turn:] + joules[:turn]]
        assert energy(one(*rows)).stored[0] == pytest.approx(8.0, rel=1e-14)


def test_a_cycle_that_returns_more_than_it_draws_fills_any_store():
    """5 J come back and 1 J is drawn, every time: after ten cycles there are 40 J in the store, and so on."""
    found = one((1.0, (-2.5, -2.5), (2.0, 2.0)), (1.0, (0.5, 0.5), (2.0, 2.0)))
    assert energy(found).stored[0] == math.inf


def test_current_and_voltage_are_linear_in_the_functions():
    random = np.random.default_rng(2)
    functions, torque, volts = random.normal(size=(4, 2, 6)), random.random((3, 6)), random.random((3, 6))
    k_t = np.array([0.02, 0.3, 1.7])
    found = wave(np.arange(1.0, 5.0), functions, torque, volts, k_t)
    for c in range(3):
        for s in range(4):
            for end in (0, 1):
                i = sum(torque[c, n] * functions[s, end, n] for n in range(6)) / k_t[c]
                v = sum(volts[c, n] * functions[s, end, n] for n in range(6))
                assert found.current[c, s, end] == pytest.approx(i, rel=1e-12)
                assert found.voltage[c, s, end] == pytest.approx(v, rel=1e-12)


def test_a_second_is_a_second_wherever_in_the_cycle_it_lies():
    """Held for 1 s with a permitted peak time of 1 s: no more than that, whatever came before."""
    for before in (n / 10 for n in range(1, 40)):
        found = one((before, (0.0, 0.0), (1.0, 1.0)), (1.0, (5.0, 5.0), (1.0, 1.0)), (0.6, (0.0, 0.0), (1.0, 1.0)))
        assert longest_above(found, np.array([2.0]))[0] <= 1.0


@settings(max_examples=40)
@given(st.lists(segments.filter(lambda rows: len(rows) > 2).map(lambda rows: rows[:3]), min_size=2, max_size=5))
def test_of_samples_that_lie_side_by_side_everything_is_as_of_candidates(machines):
    """Whether the sign of a current or a voltage changes in one of them, or in none: then nothing is cut."""
    for positive in (False, True):
        each = [one(*((t, *(np.abs(x) if positive else x for x in ends)) for t, *ends in rows)) for rows in machines]
        rows = Wave(*(np.concatenate([np.atleast_2d(x) for x in same]) for same in zip(*each, strict=True)))
        lying = Wave(*(np.asfortranarray(x) for x in rows))
        whole, same = ((*energy(laid), largest_power(laid)[0]) for laid in (rows, lying))
        np.testing.assert_allclose(same, whole, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_what_is_stored_over_a_long_cycle_is_found_part_by_part(seed, monkeypatch):
    """To the bit the same; one more than the steps of a part, and NaN stays."""
    steps = np.random.default_rng(seed).normal(-0.1, 1.0, (1, 501))
    whole = most_stored(steps)
    monkeypatch.setattr(waveform, "_PART", (7, 100, 500, 499)[seed])
    np.testing.assert_array_equal(most_stored(steps), whole)
    assert whole[0] > 0.0
    steps[0, 300] = math.nan
    assert np.isnan(most_stored(steps)).all()
