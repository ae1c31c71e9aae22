"""The load cycle: exact integrals, cuts at changes of direction, and the wheeled vehicle against its own mechanics."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases import load_cycle
from drivesizer.loads.course import Profile
from drivesizer.loads.motions import trapezoid
from drivesizer.physics.load_cycle import LoadCycle, integral, rms
from drivesizer.spec.robot import read_spec

ends = st.tuples(st.floats(-9, 9), st.floats(-9, 9))
segments = st.lists(st.tuples(st.floats(0.1, 5), ends, ends), min_size=1, max_size=6)


def cycle_of(rows):
    duration = np.array([row[0] for row in rows])
    speed, torque = (np.array([row[k] for row in rows]) for k in (1, 2))
    with np.errstate(all="ignore"):
        acceleration = np.diff(speed, axis=1) / duration[:, None] * np.ones((1, 2))
    return LoadCycle("test", duration, speed, acceleration, torque)


@given(segments)
def test_integrals_of_products_against_simpson(rows):
    """Simpson's rule is exact for the quadratics that products of straight lines are."""
    c = cycle_of(rows)
    by_hand = 0.0
    for dt, (w0, w1), (t0, t1) in rows:
        by_hand += dt / 6 * (w0 * t0 + 4 * (w0 + w1) / 2 * (t0 + t1) / 2 + w1 * t1)
    assert integral(c.duration, c.speed, c.torque) == pytest.approx(by_hand, rel=1e-12, abs=1e-9)


@given(segments)
@example([(0.5, (0.0, 0.0), (5e-324, -1.0))])
def test_cutting_changes_no_integral_and_leaves_one_sign(rows):
    c = cycle_of(rows)
    cut = c.split()
    assert cut.total == pytest.approx(c.total)
    for a, b in (("speed", "speed"), ("speed", "torque"), ("torque", "torque"), ("acceleration", "torque")):
        whole = integral(c.duration, getattr(c, a), getattr(c, b))
        assert integral(cut.duration, getattr(cut, a), getattr(cut, b)) == pytest.approx(whole, rel=1e-9, abs=1e-6)
    for column in (cut.speed, cut.torque):
        assert (column[:, 0] * column[:, 1] >= 0).all()


def test_four_points_would_get_the_trapezoid_wrong(spec):
    """The torque of the SPS robot jumps at the corners; the mean square is that of the three levels."""
    c = load_cycle(spec, trapezoid(spec.motion))
    r, m, g = 0.0762, 45.0, 9.80665
    inertia = 0.847768 / 2 * (0.0762**2 + 0.03**2) + 0.071026 / 2 * 0.006**2 + m * r**2 / 4
    roll, jolt = 0.02 * m * g * r / 4, inertia * 0.75 / r
    levels = [(2, roll + jolt), (240, roll), (2, roll - jolt)]
    expected = math.sqrt(sum(t * T**2 for t, T in levels) / 244)
    assert rms(c.duration, c.torque) == pytest.approx(expected, rel=1e-6)
    assert c.total == 244.0


@given(st.lists(st.floats(-2, 2), min_size=2, max_size=8), st.floats(-20, 20).map(lambda slope: round(slope, 6)))  # °
def test_work_at_the_wheels_is_what_the_ground_and_the_hill_take(speeds, degrees):
    """Over a closed cycle: energy in = rolling resistance times way + weight times height; kinetic energy cancels."""
    text = f"""
name: x
load: {{kind: wheeled_vehicle, mass: 20 kg, driven_wheels: 3, wheel_diameter: 300 mm, rolling_resistance: 0.03,
       slope: {degrees!r} deg, inertia: 50 kg*cm^2}}
motion: {{speed: 1 m/s, acceleration_time: 1 s, cruise_time: 1 s}}
supply: {{nominal: 24 V}}
"""
    spec = read_spec(YamlSource(text, "x.yaml"))
    v = [0.0, *speeds, 0.0]
    profile = Profile("x", tuple(1.3 * k for k in range(len(v))), tuple(v))
    c = load_cycle(spec, profile)
    work = 3 * integral(c.duration, c.torque, c.speed)
    way = sum(
        abs(a + b) / 2 * 1.3 if a * b >= 0 else (a * a + b * b) / abs(a - b) / 2 * 1.3 for a, b in itertools.pairwise(v)
    )
    angle = math.radians(degrees)
    ground = 0.03 * 20 * 9.80665 * math.cos(angle) * way
    hill = 20 * 9.80665 * math.sin(angle) * profile.distance
    assert work == pytest.approx(ground + hill, rel=1e-9, abs=1e-7)


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf])
def test_segments_that_are_none(bad):
    with pytest.raises(InputError, match="load cycle test"):
        cycle_of([(bad, (1.0, 2.0), (1.0, 1.0))])


def test_figures_beyond_numbers_are_refused():
    with pytest.raises(InputError, match="range of numbers"):
        cycle_of([(1.0, (1.0, 2.0), (math.inf, 1.0))])
