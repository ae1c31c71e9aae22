"""Bounds of the winding's peak from blocks of a cycle: they hold for any cycle, and close in as blocks get finer."""

from __future__ import annotations

from dataclasses import replace
from math import nan

import numpy as np
import pytest

from drivesizer.physics import extremes, heat_bounds
from drivesizer.physics.cycle_at_gearhead import AT_REST, BRAKING, DIRECTION, DRIVING, SPEED
from drivesizer.physics.heat_bounds import Blocks, blocks, bracket, merged
from drivesizer.physics.thermal import COPPER, TwoBodies, steady_winding_temperature
from drivesizer.physics.winding_course import winding_course

AMBIENT = 304.0  # K


def random_motors(random, n, quick=False):
    ranges = {"R_25": (0.05, 90.0), "R_th1": (0.3, 30.0), "R_th2": (0.9, 60.0), "tau_w": (0.7, 70.0),
              "tau_h": (9.0, 2300.0)}  # fmt: skip
    motors = TwoBodies(**{name: np.exp(random.uniform(*np.log(both), n)) for name, both in ranges.items()})
    if not quick:
        return motors
    tau_h, R_th2 = motors.tau_w * random.uniform(0.1, 9.0, n), motors.R_th2 * 10.0 ** random.uniform(-3.0, 1.0, n)
    return replace(motors, tau_h=tau_h, R_th2=R_th2)


def random_functions(random, S, kind):
    """Six functions of a moving load: noise upon a slow course, rare spikes, or steps; signs as a load cycle's are."""
    course = np.repeat(random.standard_normal((4, -(-S // 9) + 1)), 9, axis=1)[:, : S + 1]
    if kind == "noisy":
        course = course + 0.3 * random.standard_normal((4, S + 1))
    elif kind == "spiky":
        course = np.where(random.random((4, S + 1)) < 3.0 / S, 30.0, 0.05) * random.standard_normal((4, S + 1))
    left, right = course[:, :-1], course[:, 1:]
    if kind == "steps":
        right = left
    found = np.zeros((S, 2, 6))
    where = random.integers(0, 3, S)
    for end, values in enumerate((left, right)):
        for place in (DRIVING, BRAKING, AT_REST):
            found[:, end, place] = np.where(where == place, values[0], 0.0)
        found[:, end, 3] = values[1]
        found[:, end, DIRECTION] = np.sign(left[2])
        found[:, end, SPEED] = np.sign(left[2]) * np.abs(values[2])
    return random.exponential(1.0, S) * 10.0 ** random.uniform(-3.0, 2.0), found


def mean_of(a, b):
    return (a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a.sum(-1) * b.sum(-1)) / 6.0


def waves(functions, coefficients, friction, iron):
    """Mean square current and housing loss of each segment."""
    current, speed = np.einsum("sef,nf->nse", functions, coefficients), functions[:, :, SPEED]
    loss = np.outer(friction, np.abs(speed).mean(1)) + np.outer(iron, mean_of(speed, speed))
    return mean_of(current, current), loss


def random_case(random, n, S, kind, hottest=0.9):
    """Motors with coefficients whose mean heat is a share of what they bear: some close to running away."""
    motors = random_motors(random, n, quick=random.random() < 0.3)
    dt, functions = random_functions(random, S, kind)
    coefficients = random.uniform(0.0, 1.0, (n, 6)) ** random.uniform(0.5, 4.0, (n, 1))
    limit = 1.0 / (COPPER * motors.R_25 * (motors.R_th1 + motors.R_th2))
    warmth = hottest * random.uniform(0.0, 1.0, n) ** 2
    square, speed = waves(functions, coefficients, np.ones(n), np.zeros(n))
    coefficients *= np.sqrt(warmth * limit * dt.sum() / (square @ dt))[:, None]
    friction = random.uniform(0.0, 90.0, n) ** random.uniform(0.0, 1.0, n) * dt.sum() / (speed @ dt) / motors.R_th2
    return motors, dt, functions, coefficients, friction, friction * random.uniform(0.0, 0.5, n)


def peak_of(motors, dt, square, loss):
    return winding_course(motors, AMBIENT, dt, square, loss, np.zeros(len(dt), bool)).peak


def exact(motors, dt, functions, coefficients, friction, iron):
    return peak_of(motors, dt, *waves(functions, coefficients, friction, iron))


def halved(dt, functions):
    """The same straight lines in twice as many segments."""
    middle = functions.mean(axis=1, keepdims=True)
    pieces = np.stack([np.concatenate([functions[:, :1], middle], 1), np.concatenate([middle, functions[:, 1:]], 1)], 1)
    return np.repeat(dt / 2.0, 2), pieces.reshape(-1, 2, functions.shape[2])


def within(peak, found):
    """Below and above: whether each holds to rounding."""
    slack = 1.0 + 1e-9
    return bool((found.lower <= peak * slack).all() and (peak <= found.upper * slack).all())


# --- the laws --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["noisy", "spiky", "steps"])
@pytest.mark.parametrize("seed", range(16))
def test_the_peak_lies_in_the_bracket(kind, seed):
    """Over 14,000 random motors and cycles: short against the time constants and long, warm, and close to runaway."""
    random = np.random.default_rng([seed, len(kind)])
    S = int(random.integers(2, 300))
    case = random_case(random, 300, S, kind)
    motors, dt, functions, *columns = case
    peak, finite = exact(*case), 0
    for count in {1, 5, 40, S}:
        found = bracket(motors, AMBIENT, blocks(dt, functions, count), *columns)
        assert within(peak, found)
        assert (found.lower <= found.upper).all()
        finite += int(np.isfinite(found.upper).sum())
    assert finite > 0


@pytest.mark.parametrize("seed", range(8))
def test_it_holds_for_the_current_as_it_is_within_segments(seed):
    random = np.random.default_rng(40 + seed)
    motors, dt, functions, *columns = random_case(random, 100, 24, "noisy")
    cycles = [blocks(dt, functions, count) for count in (3, 24)]
    for _ in range(4):
        for cycle in cycles:
            assert within(exact(motors, dt, functions, *columns), bracket(motors, AMBIENT, cycle, *columns))
        dt, functions = halved(dt, functions)


def test_more_blocks_close_in():
    random = np.random.default_rng(2)
    motors, dt, functions, *columns = random_case(random, 40, 6000, "noisy", hottest=0.4)
    dt *= 100.0 / dt.sum()
    widths = []
    for count in (8, 64, 512, 6000):
        found = bracket(motors, AMBIENT, blocks(dt, functions, count), *columns)
        widths.append(np.median((found.upper - found.lower) / (exact(motors, dt, functions, *columns) - AMBIENT)))
    assert (np.diff(widths) < 0.0).all()
    assert widths[2] < widths[0] / 5.0 and widths[3] < widths[0] / 20.0


def test_constant_segments_are_blocks_that_leave_nothing_open():
    motors, dt, functions, *columns = random_case(np.random.default_rng(5), 100, 30, "steps", hottest=0.5)
    found = bracket(motors, AMBIENT, blocks(dt, functions, 30), *columns)
    peak = exact(motors, dt, functions, *columns)
    assert found.upper == pytest.approx(peak, rel=1e-7)
    assert found.lower.max() < np.inf and (found.lower <= peak).all()
    assert np.isfinite(peak).sum() > 50


def test_a_long_noisy_trapezoid_is_known_to_a_per_cent():
    random = np.random.default_rng(9)
    t = np.linspace(0.0, 4.0, 36001)
    speed = np.interp(t % 1.0, [0.0, 0.2, 0.4, 0.6, 1.0], [0.0, 1.0, 1.0, 0.0, 0.0])
    push = np.select([t % 1.0 < end for end in (0.2, 0.4, 0.6)], [1.3, 0.3, -0.7], 0.0)
    torque, one = push * (1.0 + 0.1 * random.standard_normal(t.size)), np.ones(t.size)
    points = np.stack([np.maximum(torque, 0.0), np.minimum(torque, 0.0), 0 * one, push, np.sign(speed), speed], axis=1)
    functions, dt = np.stack([points[:-1], points[1:]], axis=1), np.full(36000, 1e-3)
    motors = replace(random_motors(random, 6), tau_w=np.array([2.0, 4.0, 8.0, 16.0, 32.0, 64.0]))
    columns = (np.tile([1.0, 0.7, 1.0, 0.2, 0.01, 0.01], (6, 1)), np.zeros(6), np.zeros(6))
    limit = 1.0 / (COPPER * motors.R_25 * (motors.R_th1 + motors.R_th2))
    columns[0][:] *= np.sqrt(0.25 * limit / (waves(functions, *columns)[0].mean(1)))[:, None]
    peak = exact(motors, dt, functions, *columns)
    for count, most in ((64, 0.02), (1024, 0.004)):
        found = bracket(motors, AMBIENT, blocks(dt, functions, count), *columns)
        assert within(peak, found)
        assert ((found.upper - found.lower) / (peak - AMBIENT)).max() < most


EARLY = (2.0, 1.0, 1.0, 0.0)  # mean squares within a block; its last quarter is short


def heat_within_blocks(earlier, recent):
    """Motor, exact peak and bracket where 2000 short blocks have their heat early or late, and a pulse comes last."""
    shapes = [earlier] * 1800 + [recent] * 200  # the winding forgets within the last 200
    times = np.array([0.001, 0.024, 0.024, 0.001])
    of = {shape: blocks(times, driven(shape), 1) for shape in set(shapes)}
    parts = [*(of[shape] for shape in shapes), blocks(np.array([0.1]), driven([4.0]), 1)]
    cycle = Blocks(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))
    motor = TwoBodies(R_25=2.0, R_th1=3.0, R_th2=14.0, tau_w=2.0, tau_h=900.0)
    coefficients = np.array([[1.9, 0.0, 0.0, 0.0, 0.0, 0.0]])
    square = 1.9**2 * np.concatenate([*shapes, [4.0]])[None]
    peak = peak_of(motor, np.array([*times] * 2000 + [0.1]), square, np.zeros_like(square))
    found = bracket(motor, AMBIENT, cycle, coefficients, np.zeros(1), np.zeros(1))
    assert within(peak, found)
    return float(found.upper[0] - peak[0]), float(peak[0] - found.lower[0])


def driven(squares):
    """Functions of a driving torque alone."""
    functions = np.zeros((len(squares), 2, 6))
    functions[:, :, DRIVING] = np.sqrt(squares)[:, None]
    return functions


def test_heat_early_or_late_in_blocks_is_known_closely():
    """Heat that comes late warms, early heat cools; what it did to the housing before makes either worse."""
    late = EARLY[::-1]
    assert heat_within_blocks(EARLY, late)[0] < 0.05  # K, of a rise of 250 K
    assert heat_within_blocks(late, EARLY)[1] < 0.05


@pytest.mark.parametrize(("R_th1", "seconds", "most"), [(0.3, 200.0, 0.19), (5.0, 20.0, 0.063)])  # K, of 70 K
def test_a_housing_is_no_warmer_than_where_it_turns_round(R_th1, seconds, most):
    """Blocks longer than the housing's time constant: its tangent leads far beyond what the highest loss holds."""
    motor = TwoBodies(R_25=2.0, R_th1=R_th1, R_th2=20.0, tau_w=2.0, tau_h=9.0)
    squares = np.concatenate([np.tile([1.9, 0.1], 2000), np.tile([0.38, 0.02], 2000)])
    dt, functions = np.full(8000, seconds / 8000), driven(squares)
    limit = 1.0 / (COPPER * motor.R_25 * (R_th1 + motor.R_th2))
    columns = np.array([[np.sqrt(0.3 * limit), 0.0, 0.0, 0.0, 0.0, 0.0]]), np.zeros(1), np.zeros(1)
    peak = exact(motor, dt, functions, *columns)
    found = bracket(motor, AMBIENT, blocks(dt, functions, 2), *columns)
    assert within(peak, found) and 60.0 < peak[0] - AMBIENT < 80.0
    assert found.upper[0] - peak[0] < most


# --- blocks ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 7, 60, 400])
def test_blocks_keep_means_and_no_integral_strays_further(count):
    dt, functions = random_functions(np.random.default_rng(count), 130, "noisy")
    assert_blocks(blocks(dt, functions, count), dt, functions, count)


@pytest.mark.parametrize("count", [1, 7, 60])
def test_so_do_blocks_that_are_put_together(count):
    dt, functions = random_functions(np.random.default_rng(count), 130, "noisy")
    fine = blocks(dt, functions, 60)
    found = merged(fine, count)
    assert len(found.duration) == count
    assert_blocks(found, dt, functions, count)
    motors, _, _, *columns = random_case(np.random.default_rng(count), 9, 130, "noisy", 0.2)
    wide, close = bracket(motors, AMBIENT, found, *columns), bracket(motors, AMBIENT, fine, *columns)
    assert (wide.upper >= close.upper * (1.0 - 1e-9)).all()


def assert_blocks(found, dt, functions, count):
    """Means and how far integrals go, of blocks of a cycle, held against the same of its finer segments."""
    assert len(found.duration) <= count
    assert found.duration.sum() == pytest.approx(dt.sum())
    fine_dt, fine = dt, functions
    for _ in range(4):
        fine_dt, fine = halved(fine_dt, fine)
    products = mean_of(fine.transpose(0, 2, 1)[:, :, None], fine.transpose(0, 2, 1)[:, None])
    time, ends = np.cumsum(fine_dt), np.cumsum(found.duration)
    which = np.minimum(np.searchsorted(ends, time * (1.0 - 1e-12)), len(ends) - 1)
    for k, mean in enumerate(found.mean):
        mine = which == k
        walk = np.cumsum(fine_dt[mine, None, None] * (products[mine] - mean), axis=0)
        scale = 1e-9 * (fine_dt[:, None, None] * np.abs(products)).sum(axis=0)
        assert (np.abs(walk[-1]) <= scale).all()
        assert (walk.max(axis=0) <= found.above[k] + scale).all()
        assert (-walk.min(axis=0) <= found.below[k] + scale).all()
        assert (fine[mine].max(axis=(0, 1)) <= found.most[k]).all()
        assert (fine[mine].min(axis=(0, 1)) >= found.least[k]).all()


def test_a_belt_scales_coefficients_as_it_scales_functions():
    """So candidates behind several belts are bounded in one go, by the blocks of the cycle before them."""
    motors, dt, functions, coefficients, friction, iron = random_case(np.random.default_rng(1), 9, 400, "noisy", 0.2)
    scale = np.array([0.4, 0.4, 0.4, 2.5, 1.0, 2.5])
    expected = bracket(motors, AMBIENT, blocks(dt, functions * scale, 400), coefficients, friction, iron)
    fast = scale[SPEED]
    found = bracket(motors, AMBIENT, blocks(dt, functions, 400), coefficients * scale, friction * fast, iron * fast**2)
    for one, other in zip(found, expected, strict=True):
        assert one == pytest.approx(other, rel=1e-9)


def test_blocks_end_where_a_current_jumps():
    functions = np.zeros((3000, 2, 6))
    functions[:, :, DRIVING] = np.repeat([1.0, 0.0, 3.0, 2.0], [300, 1111, 89, 1500])[:, None]
    found = blocks(np.ones(3000), functions, 4)
    assert found.duration.tolist() == [300.0, 1111.0, 89.0, 1500.0]


# --- what is not known, and what runs away ---------------------------------------------------------------------------


def test_unknown_figures_and_runaway(monkeypatch):
    motors, dt, functions, coefficients, friction, iron = random_case(np.random.default_rng(3), 9, 50, "noisy", 0.2)
    motors.R_th1[0], coefficients[1, 2], friction[2], motors.tau_h[3] = nan, nan, nan, 0.0
    coefficients[4] *= 1e3
    cycle = blocks(dt, functions, 20)
    found = bracket(motors, AMBIENT, cycle, coefficients, friction, iron)
    assert np.isnan(found.lower[:4]).all() and np.isnan(found.upper[:4]).all()
    assert np.isinf([found.lower[4], found.upper[4]]).all()
    assert np.isfinite(found.lower[5:]).all()
    for name in ("_CELLS", "_MULTIPLIED"):
        monkeypatch.setattr(heat_bounds, name, 40)
    for column, again in zip(found, bracket(motors, AMBIENT, cycle, coefficients, friction, iron), strict=True):
        assert again == pytest.approx(column, rel=1e-12, nan_ok=True)


def test_nothing_flows():
    motors, dt, functions, *_ = random_case(np.random.default_rng(4), 5, 50, "noisy")
    found = bracket(motors, AMBIENT, blocks(dt, functions, 10), np.zeros((5, 6)), np.zeros(5), np.zeros(5))
    assert found.lower == pytest.approx(np.full(5, AMBIENT), abs=1e-6)
    assert found.upper == pytest.approx(np.full(5, AMBIENT), abs=1e-6)


def test_never_below_the_steady_temperature_of_the_means():
    motors, dt, functions, *columns = random_case(np.random.default_rng(6), 200, 100, "spiky")
    square, loss = waves(functions, *columns)
    steady = steady_winding_temperature(
        AMBIENT, motors.R_25, motors.R_th1, motors.R_th2, np.sqrt(square @ dt / dt.sum()), loss @ dt / dt.sum()
    )
    assert (bracket(motors, AMBIENT, blocks(dt, functions, 2), *columns).lower >= steady - 1e-6).all()


@pytest.mark.parametrize("count", [7, 60])
def test_blocks_of_a_long_cycle_are_made_part_by_part(count, monkeypatch):
    """Of parts of some blocks each the same blocks, and no integral that strays further."""
    dt, functions = random_functions(np.random.default_rng(count), 700, "noisy")
    whole = blocks(dt, functions, count)
    monkeypatch.setattr(extremes, "_PART", 100)
    for found, expected in zip(blocks(dt, functions, count), whole, strict=True):
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)
