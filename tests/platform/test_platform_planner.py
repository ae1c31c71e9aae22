"""Planned trajectories: times in closed form, ways that a ruler can check, limits that are never exceeded."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from platform_limits import BOTH, DRIVING, TURNING
from refusals import refusal

from drivesizer.errors import InputError
from drivesizer.platform.planner import Limits, Waypoint, plan

ORIGIN = Waypoint(x=0.0, y=0.0, heading=0.0)


def turned(degrees, **more):
    return Waypoint(**{"x": 0.0, "y": 0.0} | more, heading=math.radians(degrees))


# --- times in closed form ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("way", [0.1, 1.0, 1.79, 1.81, 40.0])
def test_a_straight_way_takes_the_time_of_a_trapezoid_or_triangle(way):
    t = plan([ORIGIN, Waypoint(x=0.0, y=way, heading=0.0)], Limits(**DRIVING))
    ramp_way = 1.2**2 / 0.8
    by_hand = way / 1.2 + 1.2 / 0.8 if way > ramp_way else 2 * math.sqrt(way / 0.8)
    assert t.total == pytest.approx(by_hand, rel=1e-12)
    assert len(t.duration) == (3 if way > ramp_way else 2)  # straight lines are exact: no piece more


@pytest.mark.parametrize("degrees", [30.0, -200.0, 540.0])
def test_turning_on_the_spot_takes_the_time_of_a_trapezoid(degrees):
    t = plan([ORIGIN, turned(degrees)], BOTH)
    angle = math.radians(abs(degrees))
    by_hand = angle / 1.5 + 1.5 / 2.0 if angle > 1.5**2 / 2.0 else 2 * math.sqrt(angle / 2.0)
    assert t.total == pytest.approx(by_hand, rel=1e-12)
    assert t.posture[2, -1, 1] == math.radians(degrees)
    assert (t.posture[:2] == 0.0).all()


def by_hand_s_curve(way, v, a, j):
    """Seven phases in closed form, as in any textbook: which of the limits are reached decides."""
    if v * j < a * a:  # the greatest acceleration is not reached before the greatest speed
        if way >= 2 * v * math.sqrt(v / j):
            return way / v + 2 * math.sqrt(v / j)
        return 4 * (way / (2 * j)) ** (1 / 3)
    if way >= v * (v / a + a / j):
        return way / v + v / a + a / j
    if way >= 2 * a**3 / j**2:
        top = (-(a**2) + math.sqrt(a**4 + 4 * j**2 * a * way)) / (2 * j)
        return 2 * (top / a + a / j)
    return 4 * (way / (2 * j)) ** (1 / 3)


@pytest.mark.parametrize("jerk", [0.3, 2.0, 50.0])
@pytest.mark.parametrize("way", [0.01, 0.5, 3.0, 90.0])
def test_with_jerk_it_takes_the_time_of_seven_phases(way, jerk):
    t = plan([ORIGIN, Waypoint(x=way, y=0.0)], Limits(**DRIVING, jerk=jerk))
    assert t.total == pytest.approx(by_hand_s_curve(way, 1.2, 0.8, jerk), rel=1e-8)
    assert t.posture[0, -1, 1] == way


def test_the_tighter_limit_counts_where_it_drives_and_turns():
    """2 m while turning by 90°: at 1.2 m/s it would turn at 0.94 rad/s; at most 0.5 rad/s leaves 0.64 m/s."""
    limits = Limits(**DRIVING, turning_speed=0.5, turning_acceleration=2.0)
    t = plan([ORIGIN, Waypoint(x=2.0, y=0.0, heading=math.pi / 2)], limits)
    assert np.abs(t.velocity[2]).max() == pytest.approx(0.5)
    assert np.abs(t.velocity[0]).max() == pytest.approx(0.5 * 2.0 / (math.pi / 2))
    assert np.abs(t.acceleration[0]).max() == pytest.approx(0.8)
    assert t.posture[0] == pytest.approx(t.posture[2] * 2.0 / (math.pi / 2), abs=1e-12)


# --- the path ---------------------------------------------------------------------------------------------------------


def test_without_a_heading_it_turns_towards_the_next_waypoint_then_drives():
    """A square: three quarter turns on the spot, and every metre driven forwards."""
    corners = [Waypoint(x=x, y=y) for x, y in ((0, 0), (2, 0), (2, 2), (0, 2), (0, 0))]
    t = plan(corners, BOTH)
    eta, _ = t.in_robot()
    driving = np.hypot(t.velocity[0], t.velocity[1]) > 1e-9
    assert np.abs(eta[1]).max() < 1e-9 and eta[0].min() > -1e-9
    assert (np.abs(t.velocity[2][driving]) < 1e-12).all()
    assert t.total == pytest.approx(4 * (2 / 1.2 + 1.2 / 0.8) + 3 * (math.pi / 2 / 1.5 + 1.5 / 2.0))
    assert t.posture[:, -1, 1] == pytest.approx([0.0, 0.0, 1.5 * math.pi])


# --- laws that hold for any way ---------------------------------------------------------------------------------------

place = st.integers(-40, 40).map(lambda k: k / 10)
angles = st.one_of(st.none(), st.integers(-12, 12).map(lambda k: k * math.pi / 6))
points = st.builds(Waypoint, x=place, y=place, heading=angles, pause=st.sampled_from([0.0, 0.7]))
jerks = st.one_of(st.none(), st.floats(0.2, 20.0))


def trajectory(ways, **more):
    try:
        return plan(ways, Limits(**DRIVING, **TURNING, **more))
    except InputError as error:
        assert "nothing moves" in str(error)
        return plan([ORIGIN, Waypoint(x=1.0, y=1.0)], Limits(**DRIVING, **TURNING, **more))


@settings(max_examples=60)
@given(st.lists(points, min_size=2, max_size=6), jerks, jerks)
def test_limits_are_never_exceeded(ways, jerk, turning_jerk):
    t = trajectory(ways, jerk=jerk, turning_jerk=turning_jerk)
    for column, v, a, j in ((slice(0, 2), 1.2, 0.8, jerk), (slice(2, 3), 1.5, 2.0, turning_jerk)):
        speed, gain = (np.hypot.reduce(c[column], axis=0) for c in (t.velocity, t.acceleration))
        assert speed.max() <= v * (1 + 1e-9) and gain.max() <= a * (1 + 1e-9)
        if j is not None:
            rate = np.hypot.reduce(np.diff(t.acceleration[column], axis=2)[..., 0], axis=0) / t.duration
            assert rate.max() <= j * (1 + 1e-6)
            jumps = np.abs(t.acceleration[column, 1:, 0] - t.acceleration[column, :-1, 1])
            assert jumps.max(initial=0.0) <= 1e-9


@settings(max_examples=60)
@given(st.lists(points, min_size=2, max_size=6), jerks)
def test_it_is_one_motion_from_rest_to_rest_through_all_waypoints(ways, jerk):
    t = trajectory(ways, jerk=jerk)
    assert (t.velocity[:, 0, 0] == 0.0).all() and (t.velocity[:, -1, 1] == 0.0).all()
    assert t.posture[:, 1:, 0] == pytest.approx(t.posture[:, :-1, 1], abs=1e-12)
    assert t.velocity[:, 1:, 0] == pytest.approx(t.velocity[:, :-1, 1], abs=1e-12)
    mean = t.acceleration.mean(axis=2) * t.duration  # accelerations are straight in a piece
    assert np.diff(t.velocity, axis=2)[..., 0] == pytest.approx(mean, abs=1e-9)
    h, (v_0, v_1), (a_0, a_1) = t.duration, np.moveaxis(t.velocity, 2, 0), np.moveaxis(t.acceleration, 2, 0)
    assert np.diff(t.posture, axis=2)[..., 0] == pytest.approx(h * v_0 + h**2 * (2 * a_0 + a_1) / 6, abs=1e-9)
    assert (v_1 - v_0) == pytest.approx(h * (a_0 + a_1) / 2, abs=1e-9)
    passed = t.at(np.linspace(0.0, t.total, 40_001))
    moved = np.ptp([(w.x, w.y) for w in ways], axis=0).any()
    for w in ways if moved else ():
        assert np.hypot(passed[0] - w.x, passed[1] - w.y).min() < 0.01


# --- refusals ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("make", "words"), [
    (lambda: plan([ORIGIN, ORIGIN], BOTH), "waypoints: 2 given and nothing moves"),
    (lambda: plan([ORIGIN], BOTH), "waypoints: 1 given and nothing moves"),
    (lambda: plan([], BOTH), "waypoints: 0 given and nothing moves"),
    (lambda: plan([ORIGIN, turned(90)], Limits(**DRIVING)), "waypoint 2: the leg to it turns by 90 deg; expected"),
    (lambda: plan([ORIGIN, Waypoint(x=1.0, y=1.0)], Limits(**DRIVING)), "waypoint 2: the leg to it turns by 45"),
    (lambda: plan([ORIGIN, turned(1e8)], BOTH), "waypoint 2: the leg to it takes"),
    (lambda: plan([ORIGIN, Waypoint(x=1.0, y=0.0)], Limits(speed=1e-12, acceleration=1.0)), "waypoint 2: the leg"),
    (lambda: plan([ORIGIN, *(turned(a) for _ in range(20) for a in (4e5, 0))], BOTH), "waypoints: the path turns"),
    (lambda: Waypoint(x=math.nan, y=0.0), "waypoint: x must be a number below 1e+09, got nan"),
    (lambda: Waypoint(x=0.0, y=0.0, pause=-1.0), "waypoint: pause must be 0 or more, got -1.0"),
    (lambda: Limits(**DRIVING, turning_speed=1.0), "limits: turning takes both"),
])  # fmt: skip
def test_bad_figures_are_refused_in_one_line(make, words):
    assert refusal(lambda: make()).startswith(words)
