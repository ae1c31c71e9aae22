"""The few extreme points: any combination without negative coefficients has its maximum and minimum among them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.physics.extremes import extremes, first_largest, undominated
from drivesizer.physics.load_cycle import LoadCycle

DRIVING, BRAKING, AT_REST, ACCELERATION, DIRECTION, SPEED = range(6)


def functions_of(speed, acceleration, torque):
    """The six functions as the drive model has them, from ends of segments; shape (segments, 2, 6)."""
    found = np.zeros((*speed.shape, 6))
    way = np.sign(speed.mean(axis=1))
    power = way * torque.mean(axis=1)
    for column, rows in ((DRIVING, power > 0), (BRAKING, (power <= 0) & (way != 0)), (AT_REST, way == 0)):
        found[rows, :, column] = torque[rows]
    found[:, :, ACCELERATION] = acceleration
    found[:, :, DIRECTION] = way[:, None]
    found[:, :, SPEED] = speed
    return found


def times_of(functions):
    return np.arange(2 * len(functions), dtype=float).reshape(-1, 2)


def coefficients(count, seed):
    """Of all sizes, some of them zero."""
    random = np.random.default_rng(seed)
    found = 10 ** random.uniform(-4, 3, (count, 6))
    found[random.random((count, 6)) < 0.25] = 0.0
    return found


def assert_carries(functions, seed, count=400):
    """Maximum and minimum over all points are those over the extreme ones, at the time that is told."""
    time = times_of(functions)
    points, when = functions.reshape(-1, 6), time.reshape(-1)
    kept = extremes(functions, time)
    c = coefficients(count, seed)
    scale = (c @ np.abs(points).T).max(axis=1) + 1e-300
    assert np.abs((c @ points.T).max(axis=1) - (c @ kept.high.T).max(axis=1)).max(initial=0, where=True) >= 0
    assert (np.abs((c @ points.T).max(axis=1) - (c @ kept.high.T).max(axis=1)) <= 1e-12 * scale).all()
    assert (np.abs((c @ points.T).min(axis=1) - (c @ kept.low.T).min(axis=1)) <= 1e-12 * scale).all()
    for few, theirs in ((kept.high, kept.high_time), (kept.low, kept.low_time)):
        assert (points[np.searchsorted(when, theirs)] == few).all()
    return kept


ends = st.lists(st.tuples(*[st.sampled_from([-3.0, -1.7, -0.4, 0.0, 0.6, 1.3, 2.9])] * 6), min_size=1, max_size=30)


@pytest.mark.parametrize("seed", range(6))
def test_random_cycles(seed):
    random = np.random.default_rng(seed)
    speed, acceleration, torque = random.normal(size=(3, 900, 2))
    speed[random.random(900) < 0.2] = 0.0
    assert_carries(functions_of(speed, acceleration, torque), seed)


def noisy(count):
    """A recording: three swings with noise on everything."""
    random = np.random.default_rng(5)
    t = np.linspace(0, 1, count + 1)
    speed = 30 * np.sin(6 * np.pi * t) + random.normal(0, 0.3, count + 1)
    torque = 2 + 3 * np.cos(6 * np.pi * t) + random.normal(0, 0.8, count + 1)
    ends = [np.stack([x[:-1], x[1:]], axis=1) for x in (speed, torque)]
    slope = np.repeat(np.diff(speed)[:, None] * count / 60, 2, axis=1)
    return LoadCycle("noisy", np.full(count, 60 / count), ends[0], slope, ends[1])


def test_the_peak_of_a_long_recording_is_that_of_every_moment():
    at = CycleAtBelt(noisy(9000).split(), 0.93).behind(1.7)
    c = coefficients(100, 3)
    values = at.functions.reshape(-1, 6) @ c.T
    found = at.peak(c)
    assert found.value == pytest.approx(np.abs(values).max(axis=0), rel=1e-12)
    worst = np.abs(values).argmax(axis=0)
    same = at.load_cycle.time.reshape(-1)[worst] == found.time
    shown = np.abs(values[np.searchsorted(at.load_cycle.time[:, 0], found.time).clip(max=len(values) - 1)])
    assert same.mean() > 0.5  # of equal ones another may be told
    assert len(shown) == len(c)


@pytest.mark.parametrize("seed", range(4))
def test_a_long_front_in_all_five_dimensions_and_in_a_plane(seed):
    random = np.random.default_rng(seed)
    raw = np.abs(random.normal(size=(1200, 3)))
    raw /= np.linalg.norm(raw, axis=1)[:, None]  # a shell: nobody exceeds anybody
    if seed % 2:
        raw[:, 2] = 2.2 - raw[:, 0] - raw[:, 1]  # a plane that falls both ways
    pair = raw.reshape(-1, 2, 3)
    speed = np.abs(pair[..., 0]) + 0.01
    assert_carries(functions_of(speed, pair[..., 1], pair[..., 2]), seed)


def by_pairs(points):
    """Rows that no other exceeds or equals everywhere: every row against every other; of equal ones the first."""
    found = []
    for i, a in enumerate(points):
        beaten = any((b >= a).all() and ((b > a).any() or j < i) for j, b in enumerate(points) if j != i)
        if not beaten:
            found.append(i)
    return found


@settings(max_examples=80)
@given(st.lists(st.tuples(*[st.integers(-4, 4)] * 3), min_size=1, max_size=60))
def test_undominated_by_every_pair(rows):
    points = np.array(rows) * 0.37
    found = undominated(points)
    assert {tuple(points[k]) for k in found} == {tuple(points[k]) for k in by_pairs(points)}
    assert len(found) == len(by_pairs(points))


def test_the_first_of_the_largest_but_for_rounding():
    inf, nan = np.inf, np.nan
    rows = [[1.0, 3.0, 3.0 + 4e-16], [-2.0, -1.0 - 2e-16, -1.0], [1.0, 1.0 + 1e-8, 0.0], [0.0, 0.0, 0.0],
            [1.0, inf, inf], [-inf, -inf, -inf], [-inf, -inf, 1.0], [5.0, nan, 7.0]]  # fmt: skip
    value, place = first_largest(np.array(rows))
    assert place.tolist() == [1, 1, 1, 0, 1, 0, 2, 0]
    assert value == pytest.approx(np.array(rows).max(axis=1), abs=0.0, rel=0.0, nan_ok=True)
    assert first_largest(np.array([0.0, 2.0, 2.0]))[1] == 1
