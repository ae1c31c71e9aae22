"""A long load cycle looked through once against the same as columns over all segments."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from drivesizer.machine.set_cycle import motor_pieces
from drivesizer.physics.cycle_at_gearhead import at_gearhead
from drivesizer.physics.groups import census
from drivesizer.physics.groups.kernel import compiled
from drivesizer.physics.load_cycle import LoadCycle, lasting_speeds
from drivesizer.physics.torque_above import torque_above

pytestmark = pytest.mark.skipif(compiled() is None, reason="not at hand as machine code")


def cycle_of(rng, count, *, rests=True, steady=True, moving=True):
    """Speeds and torques of either sign, with stretches at rest and at steady speeds, of torques that jump."""
    speed = rng.normal(size=count + 1) * moving
    if steady:
        speed[: count // 4] = np.repeat(speed[: count // 4 : 8], 8)[: count // 4]
    if rests:
        speed[count // 2 : count // 2 + count // 5] = 0.0
    ends = np.stack([speed[:-1], speed[1:]], axis=1)
    duration = rng.uniform(0.05, 0.8, count)
    slope = np.repeat(np.diff(ends, axis=1) / duration[:, None], 2, axis=1)
    torque = 0.3 * slope + rng.normal(size=(count, 2)) + np.sign(ends.mean(axis=1))[:, None]
    return LoadCycle("x", duration, ends, slope, torque).split()


def test_a_cycle_of_shared_ends_is_that_of_all_ends_written_out():
    """As a recording has it: neighbours share speed and torque, an acceleration is there once."""
    rng = np.random.default_rng(2)
    (speed, torque), slope = rng.normal(size=(2, 301)), rng.normal(size=300)
    shared = [np.lib.stride_tricks.sliding_window_view(column, 2) for column in (speed, torque)]
    shared.insert(1, np.broadcast_to(slope[:, None], (300, 2)))
    duration = rng.uniform(0.1, 1.0, 300)
    recorded, written = (LoadCycle("x", duration, *some) for some in (shared, [column.copy() for column in shared]))
    columns, strides = census.columns_of(recorded)
    assert strides.tolist() == [1, 1, 1, 0, 1, 1]
    assert [len(column) for column in columns] == [300, 301, 300, 301]
    of_written = census.columns_of(written)[1]
    assert of_written.tolist() == [2, 1] * 3


@pytest.fixture(params=range(6))
def both(request, monkeypatch):
    """A cycle through a belt by columns, and by a census."""
    rng, kind = np.random.default_rng(request.param), request.param
    cycle = cycle_of(rng, 500, rests=kind % 2 == 0, steady=kind < 4, moving=kind != 4)
    plain = at_gearhead(cycle, 0.93, 2.0)
    monkeypatch.setattr(census, "SHORT", 10)
    looked = at_gearhead(cycle, 0.93, 2.0)
    assert plain.census is None
    assert looked.census
    return plain, looked


def test_sums_and_figures_are_those_of_all_segments(both):
    plain, looked = both
    np.testing.assert_array_equal(looked.acts, plain.acts)
    np.testing.assert_allclose(looked.moments, plain.moments, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(looked.braked, plain.braked, rtol=1e-12, atol=1e-12)
    for name, value in plain.scalars._asdict().items():
        assert getattr(looked.scalars, name) == pytest.approx(value, rel=1e-12, nan_ok=True), name


def test_what_is_linear_in_the_functions_has_the_same_peaks(both):
    plain, looked = both
    rng = np.random.default_rng(9)
    coefficients = rng.uniform(size=(300, 6)) * 10.0 ** rng.uniform(-3, 3, (300, 6))
    coefficients[150:] *= rng.uniform(size=(150, 6)) > 0.3  # then some moments may be alike
    for one in ("high", "low"):
        found = []
        for base in both:
            points = getattr(base.extremes, one)
            times = getattr(base.extremes, f"{one}_time")
            values = coefficients @ points.T * (1.0 if one == "high" else -1.0)
            found.append((values.max(axis=1), times[values.argmax(axis=1)]))
        np.testing.assert_allclose(found[0][0], found[1][0], rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(found[0][1][:150], found[1][1][:150], rtol=1e-9)
    highest = np.maximum(plain.functions[:, 0], plain.functions[:, 1])
    lowest = np.minimum(plain.functions[:, 0], plain.functions[:, 1])
    above, below = looked.extremes.above, looked.extremes.below
    assert all((above >= one).all(axis=1).any() for one in highest)
    assert all((below <= one).all(axis=1).any() for one in lowest)


def test_pieces_of_a_motor_s_cycle_are_the_same(both):
    coefficients = np.array([[0.1, 0.08, 0.09, 1e-3, 0.01, 2e-3]])
    demand = SimpleNamespace(coefficients=coefficients, complete=np.array([True]), total_ratio=np.array([12.0]))
    plain, looked = (motor_pieces(base.behind(1.3), demand, 0.05) for base in both)
    assert [one.name for one in plain] == [one.name for one in looked]
    for one, other in zip(plain, looked, strict=True):
        for name in ("start", "duration", "speed", "load_torque", "motor_torque", "rms_torque", "rms_current"):
            assert getattr(other, name) == pytest.approx(getattr(one, name), rel=1e-11, abs=1e-12), (one.name, name)


def test_times_above_a_torque_are_the_same(both):
    plain, looked = both
    for limit in (0.0, 0.4, 1.0, 2.0, 100.0, np.nan):
        mine, its = (torque_above(base.behind(1.7), limit) for base in both)
        assert its == pytest.approx(mine, rel=1e-9, abs=1e-12, nan_ok=True), limit
    assert looked.pieces == plain.pieces


@pytest.mark.parametrize("longest", [30.0, 3000.0])
def test_lasting_speeds_of_plateaus_and_ramps(longest, monkeypatch):
    """Speeds that stay what they are for seconds and for hours, so that times above a speed jump with it."""
    rng = np.random.default_rng(4)
    monkeypatch.setattr(census, "SHORT", 10)
    for _ in range(6):
        levels = rng.integers(0, 5, 40) * 2.0
        speed = np.repeat(levels, 2)
        duration = rng.uniform(0.1, longest, len(speed) - 1)
        ends = np.stack([speed[:-1], speed[1:]], axis=1)
        zero = np.zeros_like(ends)
        cycle = LoadCycle("x", duration, ends, zero, zero + 1.0)
        found = at_gearhead(cycle, 1.0).scalars
        for name, value in lasting_speeds(duration, ends).items():
            assert getattr(found, name) == pytest.approx(float(value), rel=1e-9), name


def test_a_cycle_with_too_many_extreme_points_is_left_to_columns(monkeypatch):
    cycle = cycle_of(np.random.default_rng(1), 300)
    monkeypatch.setattr(census, "SHORT", 10)
    monkeypatch.setattr(census, "_ROOM", 3)
    assert at_gearhead(cycle, 1.0).census is None
