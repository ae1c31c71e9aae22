"""Life of gears: printed means and lives, laws, and every gearhead's life counted in plain Python."""

import math
import random
from itertools import pairwise

import numpy as np
import pytest

from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.physics.gear_life import gear_life, mean_load, turned_load
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.search.columns.shaft_limits import life_of_gearheads

RPM = math.pi / 30.0


def steady(rows: list[tuple[float, float, float]]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Durations, torques and speeds of steps of time [s], torque [N*m] and speed [rpm]."""
    time, torque, speed = np.array(rows).T
    return time, np.stack([torque] * 2, axis=1), np.stack([speed * RPM] * 2, axis=1)


def test_mean_torque_as_printed():
    """Honpine, selection of harmonic reduction gears: 89 N·m; its step at rest counts in the mean speed only."""
    rows = [(0.2, 150.0, 10.0), (3.0, 82.0, 20.0), (0.3, 130.0, 10.0), (0.2, 0.0, 0.0)]
    time, torque, speed = steady(rows)
    mean = float(time @ np.abs(speed[:, 0]) / time.sum())
    assert mean_load(turned_load(time, torque, speed, 3.0), mean, 3.0) == pytest.approx(89.0, abs=0.5)
    assert mean / RPM == pytest.approx((2.0 + 60.0 + 3.0) / 3.7)


def test_rated_life_as_printed():
    """At rated torque and speed 7000 and 35 000 h (Harmonic Drive, CSF), as much again at half the speed."""
    for hours in (7000.0, 35000.0):
        turned = turned_load(*steady([(2.0, 54.0, 2000.0)]), 3.0)
        assert gear_life(hours, 54.0, 2000.0 * RPM, turned, 3.0) == pytest.approx(hours)
        halved = turned_load(*steady([(1.0, 54.0, 2000.0), (1.0, 54.0, 0.0)]), 3.0)
        assert gear_life(hours, 54.0, 2000.0 * RPM, halved, 3.0) == pytest.approx(2.0 * hours)


@pytest.mark.parametrize("exponent", [3.0, 10.0 / 3.0])
def test_ramps_are_integrated(exponent):
    """T and n from 0 to their ends: the integral of x^(p+1) is 1/(p+2)."""
    ramp = np.array([[0.0, 2.0]])
    found = turned_load(np.array([3.0]), ramp, ramp, exponent)
    assert found == pytest.approx(2.0 ** (exponent + 1.0) / (exponent + 2.0), rel=1e-6)


def random_cycle(rng: random.Random) -> LoadCycle:
    count = rng.randint(1, 5)
    corners = [rng.choice([0.0, rng.uniform(-3.0, 3.0)]) for _ in range(count + 1)]
    duration = np.array([rng.uniform(0.1, 4.0) for _ in range(count)])
    speed = np.array([[a, b] for a, b in pairwise(corners)])
    torque = np.array([[rng.uniform(-9.0, 9.0), rng.uniform(-9.0, 9.0)] for _ in range(count)])
    return LoadCycle("random", duration, speed, np.zeros((count, 2)), torque).split()


def plainly(cycle: LoadCycle, efficiency: float, belt: float, gear: dict[str, float]) -> float:
    """Life of one gearhead, the cycle in small steps."""
    steps, worn = 400, 0.0
    for time, (t0, t1), (w0, w1) in zip(cycle.duration, cycle.torque, cycle.speed, strict=True):
        drives = (t0 + t1) * (w0 + w1) > 0.0
        for k in range(steps):
            x = (k + 0.5) / steps
            torque, speed = t0 + (t1 - t0) * x, w0 + (w1 - w0) * x
            at_output = abs(torque) / belt * (1.0 / efficiency if drives else efficiency)
            worn += time / steps * at_output ** gear["life_exponent"] * abs(speed) * belt * gear["ratio"]
    if math.isinf(gear["rated_life"]):
        return math.inf
    rated = gear["rated_speed"] if not math.isnan(gear["rated_speed"]) else gear["continuous_input_speed"]
    if any(math.isnan(x) for x in (gear["rated_life"], gear["continuous_torque"], rated, gear["life_exponent"])):
        return math.nan
    revolved = gear["rated_life"] * gear["continuous_torque"] ** gear["life_exponent"] * rated
    return revolved * float(cycle.duration.sum()) / worn if worn else math.inf


def test_lives_of_random_gearheads_over_random_cycles():
    rng = random.Random(7)

    def some(low: float, high: float) -> float:
        return rng.choice([math.nan, rng.uniform(low, high), rng.uniform(low, high)])

    for _ in range(40):
        cycle, efficiency, belt = random_cycle(rng), rng.uniform(0.6, 1.0), rng.uniform(0.4, 3.0)
        gears = [
            {
                "rated_life": rng.choice([math.inf, some(1e6, 1e8), some(1e6, 1e8)]),
                "continuous_torque": some(1.0, 60.0), "rated_speed": some(100.0, 300.0),
                "continuous_input_speed": some(100.0, 300.0), "ratio": rng.uniform(3.0, 120.0),
                "life_exponent": rng.choice([3.0, 10.0 / 3.0, math.nan]),
            }
            for _ in range(12)
        ]  # fmt: skip
        columns = {name: np.array([gear[name] for gear in gears]) for name in gears[0]}
        found = life_of_gearheads(CycleAtBelt(cycle, efficiency).behind(belt), columns)
        expected = [plainly(cycle, efficiency, belt, gear) for gear in gears]
        assert found == pytest.approx(expected, rel=2e-3, nan_ok=True)
