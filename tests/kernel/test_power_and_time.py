"""Power, energy, what is stored and time above a current of the kernel: closed forms, and the same by fine sampling."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivesizer.kernel.cycle import ACCOUNT
from drivesizer.kernel.evaluate import evaluate
from drivesizer.kernel.records import Drive

FINE = 4000  # samples of a segment
PLAIN = Drive(*[0.0] * len(Drive._fields))._replace(
    driving=1.0, braking=1.0, resting=1.0, emf=1.0, mean_rise=0.0, finest=math.inf, V_0=1.0, bus_share=1.0
)  # 1 A per N*m, 1 V s/rad, and no resistance: torque is current, speed is voltage


def over(*segments, limit=math.nan, **figures):
    """Figures over segments of time, current at both ends and voltage at both ends."""
    time, current, voltage = zip(*segments, strict=True)
    columns = {"torque": np.array(current, float), "speed": np.array(voltage, float)}
    cycle = SimpleNamespace(duration=np.array(time, float), acceleration=np.zeros((len(time), 2)), **columns)
    return evaluate(PLAIN._replace(limit=limit, **figures), cycle, ACCOUNT)


def sampled(segments):
    """Current, power in the middle of many short steps, and their length."""
    share = (np.arange(FINE) + 0.5) / FINE
    current, voltage = (np.concatenate([a + share * (b - a) for a, b in (s[n] for s in segments)]) for n in (1, 2))
    return current, current * voltage, np.repeat([s[0] / FINE for s in segments], FINE)


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
@given(segments, st.integers(1, 500).map(lambda n: n / 100 + 0.005))
def test_everything_against_fine_sampling(rows, limit):
    found = over(*rows, limit=limit)
    i, power, step = sampled(rows)
    flow = power * step
    size = 5e-5 * np.abs(flow).sum() + 1e-8
    assert float(found.drawn) == pytest.approx(flow[flow > 0].sum(), abs=size)
    assert float(found.returned) == pytest.approx(-flow[flow < 0].sum(), abs=size)
    total = sum(t / 6 * (a * c + (a + b) * (c + d) + b * d) for t, (a, b), (c, d) in rows)
    assert float(found.drawn - found.returned) == pytest.approx(total, abs=1e-11 * float(found.drawn) + 1e-12)
    highest = max(power.max(), *(c * v for _, *ends in rows for c, v in zip(*ends, strict=True)))
    assert float(found.power) == pytest.approx(highest, abs=1e-5)
    assert float(found.power) >= highest - 1e-12 * abs(highest)
    if found.returned <= found.drawn:
        held = most = 0.0
        for x in np.tile(flow, 2):
            held = max(held - x, 0.0)
            most = max(most, held)
        assert float(found.stored) == pytest.approx(most, abs=2 * size)
    assert float(found.above) == pytest.approx(run_of(np.abs(i) > limit, step), abs=2.1 * step.max())
    lasts = step[np.abs(i) > limit].sum()
    assert float(found.above_in_all) == pytest.approx(lasts, abs=2.1 * len(rows) * step.max())


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        ([(4.0, (3.0, 3.0), (7.0, 7.0))], {"drawn": 84.0, "returned": 0.0, "power": 21.0, "above": 4.0, "I_rms": 3.0}),
        # I = t, V = 2 t over 3 s: P = 2 t^2
        ([(3.0, (0.0, 3.0), (0.0, 6.0))], {"drawn": 18.0, "power": 18.0, "power_time": 3.0, "I_rms": math.sqrt(3.0)}),
        # I = 1 - t, V = 2: 1 J drawn, 4 J returned
        ([(3.0, (1.0, -2.0), (2.0, 2.0))], {"drawn": 1.0, "returned": 4.0, "stored": math.inf}),
        # and V = 2 - t: returned between 1 s and 2 s
        ([(3.0, (1.0, -2.0), (2.0, -1.0))], {"drawn": 5 / 3, "returned": 1 / 6, "stored": 1 / 6}),
        # I = t, V = 3 - t: nothing at both ends, 2.25 W in the middle
        ([(3.0, (0.0, 3.0), (3.0, 0.0))], {"power": 2.25, "power_time": 1.5}),
        # over the end of the cycle, and through a jump of the sign
        ([(2.0, (4.0, 3.0), (1.0, 1.0)), (5.0, (-3.0, -6.0), (1.0, 1.0))], {"above": 7.0, "above_in_all": 7.0}),
        ([(2.0, (3.0, 3.0), (1, 1)), (3.0, (0.0, 0.0), (1, 1)), (1.0, (3.0, 3.0), (1, 1))],
         {"above": 3.0, "above_in_all": 3.0}),
        ([(2.0, (2.0, -2.0), (1.0, 1.0))], {"above": 0.0}),
    ],
)  # fmt: skip
def test_by_hand(rows, expected):
    found = over(*rows, limit=2.0)
    for name, value in expected.items():
        assert float(getattr(found, name)) == pytest.approx(value, rel=1e-13), name


def test_an_unknown_limit_and_one_that_is_only_met():
    assert np.isnan(over((2.0, (1.0, -1.0), (1.0, 1.0))).above)
    assert over((4.0, (3.0, 3.0), (7.0, 7.0)), limit=3.0).above == 0.0
    for before in (n / 10 for n in range(1, 40)):  # a second is a second wherever in the cycle it lies
        rows = ((before, (0.0, 0.0), (1.0, 1.0)), (1.0, (5.0, 5.0), (1.0, 1.0)), (0.6, (0.0, 0.0), (1.0, 1.0)))
        assert over(*rows, limit=2.0).above <= 1.0


def test_what_comes_back_in_several_pieces_adds_up_unless_drawn_between():
    """-3 J, -2 J, +1 J, -4 J, +20 J: 5, then 4, then 8 J at most; however the cycle is turned."""
    joules = [-3.0, -2.0, 1.0, -4.0, 20.0]
    for turn in range(5):
        rows = [(1.0, (j / 2, j / 2), (2.0, 2.0)) for j in joules[turn:] + joules[:turn]]
        assert float(over(*rows).stored) == pytest.approx(8.0, rel=1e-14)


def test_power_of_two_constants_by_hand():
    """R 1 ohm, k_t 0.1, k_e 0.12, w 100 rad/s, I from +10 to -10 A in 2 s.

    Driving, 1 s: the integral of R I^2 is 33.33 J, of k_e w I 60 J; drawn 93.33 J.
    Braking, 1 s: R I^2 33.33 J, k_t w |I| 50 J of mechanical work, of which 10 J are lost: 40 J come out of the
    magnets. P(t) = 100 t^2 - 80 t with I = 10 t: below 0 until t = 0.8, there -8.533 J, then 1.867 J.
    """
    found = over((2.0, (10.0, -10.0), (100.0, 100.0)), emf=0.12, surplus=0.02, R=1.0)
    assert float(found.drawn) == pytest.approx(93.3333 + 1.8667, rel=1e-5)
    assert float(found.returned) == pytest.approx(8.5333, rel=1e-5)
    assert float(found.unlike) == pytest.approx(20.0)
    assert float(found.power) == pytest.approx(220.0)
