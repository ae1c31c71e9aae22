"""Tipping, lift-off and grip of platforms: against textbook laws, a polygon by brute force, and force balances."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from platforms import MASS, RADIUS, car, differential, mecanum, omni_three
from trajectories import joined, piece, straight, turning

from drivesizer.errors import InputError
from drivesizer.platform.dynamics import Ground, Moving, contact_loads, dynamics
from drivesizer.platform.kinematics import Caster, Platform, Wheel, kinematics, without_motor
from drivesizer.platform.stability import (
    edge_distances,
    floor_forces,
    grip_acceleration,
    grip_slope,
    least_load,
    least_margin,
    lift_off_acceleration,
    lift_off_slope,
    support_polygon,
    tipping_acceleration,
    tipping_edges,
    tipping_slope,
    translations,
    worst_friction,
    zero_moment_point,
)

G = 9.80665
coordinate = st.floats(-0.8, 0.8)


def cart(half_base=0.3, half_track=0.2, height=0.6, held=True, **more):
    """Four wheels in a rectangle, front right first; fixed wheels if held."""
    corners = ((half_base, -half_track), (half_base, half_track), (-half_base, half_track), (-half_base, -half_track))
    wheels = tuple(Wheel(x=x, y=y, radius=0.1, held=held) for x, y in corners)
    return Platform(**({"wheels": wheels, "mass": 50.0, "inertia": 3.0, "height": height} | more))


@st.composite
def standing(draw, least=3, most=7):
    """Any contacts, and a centre of mass that is a mean of theirs with weights."""
    places = draw(st.lists(st.tuples(coordinate, coordinate), min_size=least, max_size=most))
    assume(all(math.dist(a, b) > 0.05 for i, a in enumerate(places) for b in places[:i]))
    apart = np.array(places) - np.mean(places, axis=0)
    assume(np.linalg.svd(apart)[1][1] > 0.05)
    share = np.array(draw(st.lists(st.floats(0.2, 1.0), min_size=len(places), max_size=len(places))))
    x, y = (float(c) for c in share @ np.array(places) / share.sum())
    return Platform(
        wheels=tuple(Wheel(x=a, y=b, radius=0.1) for a, b in places), mass=draw(st.floats(5.0, 90.0)), inertia=1.7,
        x=x, y=y, height=draw(st.floats(0.1, 1.2)),
    )  # fmt: skip


# --- textbook laws ----------------------------------------------------------------------------------------------------


@given(st.floats(0.1, 0.9), st.floats(0.1, 0.9), st.floats(0.05, 1.5))
def test_a_box_tips_where_its_centre_stands_over_its_edge(half_base, half_track, height):
    """tan = b / h, and braking at g b / h, to each side; the nearest edge is the worst direction."""
    p = cart(half_base, half_track, height)
    for direction, half in ((0.0, half_base), (math.pi / 2, half_track), (math.pi, half_base)):
        assert tipping_slope(p, direction) == pytest.approx(math.atan(half / height))
        assert tipping_acceleration(p, direction) == pytest.approx(G * half / height)
        assert lift_off_acceleration(p, direction) == pytest.approx(G * half / height)  # both wheels of a side at once
    assert tipping_slope(p) == pytest.approx(math.atan(min(half_base, half_track) / height))
    edges = tipping_edges(p)
    assert edges[0].angle == pytest.approx(tipping_slope(p))
    assert sorted(e.distance for e in edges) == pytest.approx(sorted(2 * [half_base, half_track]))


def test_a_corner_lifts_before_the_box_tips():
    """Across the diagonal: load m g / 4 − m a h (cos / 2B + sin / 2T), by hand."""
    p, way = cart(), math.atan2(0.6, 0.35)
    per_unit = 50.0 * 0.6 * (math.cos(way) / (2 * 0.6) + math.sin(way) / (2 * 0.4))
    assert lift_off_acceleration(p, way) == pytest.approx(50.0 * G / 4 / per_unit)
    assert lift_off_acceleration(p, way) < tipping_acceleration(p, way)
    worst = 50.0 * G / 4 / (50.0 * 0.6 * math.hypot(1 / 1.2, 1 / 0.8))
    assert lift_off_acceleration(p) == pytest.approx(worst)
    assert lift_off_slope(p) == pytest.approx(math.atan(worst / G))


@given(standing(), st.floats(-math.pi, math.pi))
def test_at_the_limit_a_wheel_carries_nothing_and_the_point_is_on_the_edge(p, direction):
    limit = lift_off_acceleration(p, direction)
    assume(0.0 < limit < math.inf)
    unit = np.array([math.cos(direction), math.sin(direction)])
    loads = contact_loads(p, accelerated=limit * unit)
    assert loads.min() == pytest.approx(0.0, abs=1e-6 * p.mass * G)
    slope = math.atan(limit / G)
    assert contact_loads(p, ground=Ground(slope=slope, uphill=direction)).min() == pytest.approx(
        0.0, abs=1e-6 * p.mass * G
    )
    tips = tipping_acceleration(p, direction)
    point = zero_moment_point(p, accelerated=tips * unit)
    assert edge_distances(p, point).min() == pytest.approx(0.0, abs=1e-9)
    assert tips >= limit * (1 - 1e-9)


# --- support polygon by brute force -----------------------------------------------------------------------------------


@given(standing())
def test_the_polygon_is_the_least_over_all_pairs(p):
    """An edge is a pair of contacts with all others on one side: tried for every pair."""
    places = [complex(*c) for c in p.contacts]
    centre = complex(p.x, p.y)
    found = []
    for i, a in enumerate(places):
        for j, b in enumerate(places):
            along = (b - a) / abs(b - a) if i != j else 1.0
            beside = [((c - a) * along.conjugate()).imag for c in places if c not in (a, b)]
            if i != j and min(beside) >= -1e-9:
                found.append(((centre - a) * along.conjugate()).imag)
    assert min(e.distance for e in tipping_edges(p)) == pytest.approx(min(found), abs=2e-5)
    assert edge_distances(p, (p.x, p.y)).min() > 0.0  # a mean of the contacts is inside
    assert edge_distances(p, (9.0, 0.0)).min() < 0.0


def test_a_caster_widens_the_polygon():
    pair = differential(0.5)
    with pytest.raises(InputError, match=r"on one line.*give its casters"):
        support_polygon(pair)
    with pytest.raises(InputError, match="on one line"):
        lift_off_acceleration(pair, 0.0)
    with pytest.raises(InputError, match="on one line"):
        support_polygon(Platform(wheels=(Wheel(x=0.1, y=0.0, radius=0.1),), mass=9.0, inertia=1.2))
    tricycle = replace(pair, casters=(Caster(x=-0.4, y=0.0),), x=-0.1, height=0.3)
    assert tipping_acceleration(tricycle, math.pi) == pytest.approx(G * 0.1 / 0.3)  # braking, about the axle
    side = 0.3 * math.sin(math.atan2(0.25, 0.4))  # from the caster, 0.3 m away, to the line to a wheel
    assert tipping_edges(tricycle)[0].distance == pytest.approx(0.1)
    assert tipping_edges(tricycle)[1].distance == pytest.approx(side)


# --- along a trajectory -----------------------------------------------------------------------------------------------


def test_load_moves_to_the_front_by_m_a_h_over_the_wheelbase():
    """m a h / L for the axle, half of it for each wheel; braking is the second piece."""
    p = cart(0.3, 0.4, 0.25)
    way = joined(
        piece((0, 0, 0), (0, 0, 0), (0.8, 0, 0), 1.5), piece((0.9, 0, 0), (1.2, 0, 0), (-2.4, 0, 0), 0.5)
    )  # fmt: skip
    found = least_load(p, way)
    assert found.value == pytest.approx(50.0 * G / 4 - 50.0 * 2.4 * 0.25 / 0.6 / 2)
    assert found.contact in (3, 4) and 1.5 <= found.time <= 2.0
    assert least_load(p, way, share=True).value == pytest.approx(1.0 - 2.4 / lift_off_acceleration(p, math.pi))
    assert least_margin(p, way).value == pytest.approx(0.3 - 0.25 * 2.4 / G)
    assert least_margin(p, way, share=True).value == pytest.approx(1.0 - 0.25 * 2.4 / G / 0.3)


def test_on_a_slope_the_worst_heading_is_found_inside_a_piece():
    """Once round on the spot: the worst is where the corner points downhill, though both ends are alike."""
    p, slope = cart(height=0.4), Ground(slope=0.2)
    found = least_load(p, turning(0.0, 2 * math.pi, 8.0), slope)
    centrifugal = 0.0  # the centre of mass is on the axis
    by_hand = 50.0 * (G * math.cos(0.2) / 4 - G * math.sin(0.2) * 0.4 * math.hypot(1 / 1.2, 1 / 0.8) + centrifugal)
    assert found.value == pytest.approx(by_hand, rel=1e-3)
    assert least_margin(p, turning(0.0, 2 * math.pi, 8.0), slope).value == pytest.approx(
        0.2 - 0.4 * math.tan(0.2), rel=1e-3
    )


# --- grip: textbook laws ----------------------------------------------------------------------------------------------

friction = st.floats(0.05, 1.1)


@given(friction)
def test_all_fixed_wheels_driven_hold_a_slope_of_mu(mu):
    """Low on the floor, nothing is shifted: tan s = μ, and a = μ g."""
    d = dynamics(cart(height=0.0))
    assert math.tan(grip_slope(d, mu, 0.0)) == pytest.approx(mu)
    assert math.tan(grip_slope(d, mu, math.pi / 2)) == pytest.approx(mu)  # held sideways
    assert grip_acceleration(d, mu, 0.0) == pytest.approx(mu * G)


@given(st.floats(0.05, 0.4), st.floats(0.05, 0.3))
def test_alike_shared_torque_is_limited_by_the_lighter_axle(mu, height):
    """m g sin / 4 <= μ (m g cos / 4 − m g sin h / 2L): tan s = μ / (1 + 2 μ h / L)."""
    d = dynamics(cart(0.3, 0.2, height))
    assert math.tan(grip_slope(d, mu, 0.0)) == pytest.approx(mu / (1 + 2 * mu * height / 0.6))
    assert grip_acceleration(d, mu, math.pi) == pytest.approx(G * mu / (1 + 2 * mu * height / 0.6))


@given(st.floats(0.05, 0.6), st.floats(0.05, 0.4), st.floats(-0.15, 0.15))
def test_rear_and_front_wheel_drive(mu, height, x):
    """Wong, Theory of Ground Vehicles: a = μ g l / (L ∓ μ h), l to the other axle; casters carry, and do not pull."""
    for driven, sign in ((-1, -1.0), (1, 1.0)):
        wheels = tuple(Wheel(x=0.3 * driven, y=y, radius=0.1, held=True) for y in (-0.2, 0.2))
        casters = tuple(Caster(x=-0.3 * driven, y=y) for y in (-0.2, 0.2))
        p = Platform(wheels=wheels, casters=casters, mass=40.0, inertia=2.0, x=x, height=height)
        other = 0.3 + x * driven
        by_hand = mu * G * other / (0.6 + sign * mu * height)
        if by_hand < lift_off_acceleration(p, 0.0):
            assert grip_acceleration(dynamics(p), mu, 0.0) == pytest.approx(by_hand)


@given(friction, st.floats(0.2, 1.2))
def test_mecanum_wheels_pull_along_their_rollers(mu, gamma):
    """Forwards μ g cos γ and sideways μ g sin γ; the rest is taken up by the wheels of the other diagonal."""
    wheels = tuple(replace(w, roller_angle=math.copysign(gamma, w.roller_angle), inertia=0.0) for w in mecanum().wheels)
    d = dynamics(replace(mecanum(), wheels=wheels))
    assert grip_acceleration(d, mu, 0.0) == pytest.approx(mu * G * math.cos(gamma))
    assert math.tan(grip_slope(d, mu, math.pi)) == pytest.approx(mu * math.cos(gamma))
    assert grip_acceleration(d, mu, math.pi / 2) == pytest.approx(mu * G * math.sin(gamma))


def test_mecanum_across_the_diagonal_pulls_with_two_wheels():
    """At 45° two wheels roll free: m a = 2 μ m g / 4; that is the worst direction of all."""
    d = dynamics(replace(mecanum(inertia=0.0), height=0.0))
    assert grip_acceleration(d, 0.6, math.pi / 4) == pytest.approx(0.3 * G)
    assert grip_acceleration(d, 0.6) == pytest.approx(0.3 * G)
    assert math.tan(grip_slope(d, 0.6)) == pytest.approx(0.3)


def test_the_floor_sees_more_than_torque_over_radius():
    """F = τ / (r cos γ): 5 N·m at a mecanum wheel of 76.2 mm is 92.8 N, not 65.6 N."""
    d = dynamics(mecanum(inertia=0.0))
    rate = 4 * 5.0 / RADIUS / MASS
    along, across = floor_forces(d, Moving((0.0, 0.0, 0.0), (rate, 0.0, 0.0)))
    assert along == pytest.approx(4 * [5.0 / (RADIUS * math.cos(math.pi / 4))])
    assert along == pytest.approx(4 * [92.8], abs=0.05)
    assert across == pytest.approx(4 * [0.0])


# --- grip: force balances ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("p", [
    replace(mecanum(), height=0.12, x=0.03),
    replace(differential(0.5, inertia=0.02), casters=(Caster(x=-0.4, y=0.0),), x=-0.08, height=0.2),
    replace(car(1.1, 0.6, 0.0), x=0.4, height=0.3),
    Platform(wheels=tuple(omni_three(0.06, 0.25)), mass=20.0, inertia=0.6, height=0.15),
    without_motor(replace(mecanum(), height=0.1), 2),
    without_motor(replace(mecanum(), height=0.1), 3, blocked=True),
], ids=["mecanum", "differential", "car", "omni", "free wheel", "blocked wheel"])  # fmt: skip
def test_the_wheels_forces_make_the_motion(p):
    """Newton and Euler for the body alone: forces of the floor less what the wheels' own spin took is m a and J α."""
    k = kinematics(p.wheels)
    slope = Ground(slope=0.1, uphill=0.4)
    rate, eta = k.motions @ np.linspace(0.6, -0.4, k.mobility), k.motions @ np.linspace(-0.3, 0.7, k.mobility)
    along, across = floor_forces(dynamics(p), Moving(eta, rate, ground=slope))
    force = sum(
        f * np.exp(1j * (w.heading + w.roller_angle)) + s * np.exp(1j * (w.heading + math.pi / 2))
        for w, f, s in zip(p.wheels, along, across, strict=True)
    )
    moment = sum(
        ((w.x - p.x) - 1j * (w.y - p.y))
        * (f * np.exp(1j * (w.heading + w.roller_angle)) + s * np.exp(1j * (w.heading + math.pi / 2)))
        for w, f, s in zip(p.wheels, along, across, strict=True)
    ).imag
    u, v, spin = eta
    gained = complex(
        rate[0] - spin * v - rate[2] * p.y - spin**2 * p.x, rate[1] + spin * u + rate[2] * p.x - spin**2 * p.y
    )
    weight = -p.mass * G * math.sin(0.1) * np.exp(0.4j)
    assert force + weight == pytest.approx(p.mass * gained)
    assert moment == pytest.approx(p.inertia * rate[2])


def test_friction_needed_over_a_trajectory_is_that_of_its_worst_moment():
    d = dynamics(cart(0.3, 0.2, 0.25))
    way = joined(piece((0, 0, 0), (0, 0, 0), (0.8, 0, 0), 1.5), piece((0.9, 0, 0), (1.2, 0, 0), (-2.4, 0, 0), 0.5))
    worst = worst_friction(d, way)
    assert worst.value == pytest.approx((2.4 / 4) / (G / 4 - 2.4 * 0.25 / 0.6 / 2))
    assert worst.contact in (3, 4) and worst.time >= 1.5
    assert grip_acceleration(d, worst.value, math.pi) == pytest.approx(2.4)  # the other way round
    assert worst_friction(d, straight((0, 0), (1, 0), 0.0, 2.0)).value == 0.0


def test_ways_and_refusals():
    assert translations(dynamics(differential())) == pytest.approx([0.0, math.pi]) or translations(
        dynamics(differential())
    ) == pytest.approx([math.pi, 2 * math.pi])
    assert len(translations(dynamics(mecanum()))) == 360
    with pytest.raises(InputError, match="without turning"):
        translations(dynamics(car(1.1, 0.6, 0.35)))
    standing_on_three = replace(differential(), casters=(Caster(x=-0.4, y=0.0),), x=-0.1)
    with pytest.raises(InputError, match="slides wheel"):
        grip_acceleration(dynamics(standing_on_three), 0.5, math.pi / 2)


def test_what_rolls_hard_uphill_slips_sooner():
    """The floor transmits what rolls the wheels without a motor, and not what the driven ones take to roll themselves.

    Two of four driven, each with a quarter of the weight: tan s = (μ − C_rr) / 2. All four: tan s = μ.
    """
    p = cart(height=0.0)
    hard = tuple(replace(w, rolling_resistance=0.04) for w in p.wheels)
    assert math.tan(grip_slope(dynamics(replace(p, wheels=hard)), 0.5, 0.0)) == pytest.approx(0.5)
    two = dynamics(replace(p, wheels=(*hard[:2], *(replace(w, drive="free") for w in hard[2:]))))
    assert math.tan(grip_slope(two, 0.5, 0.0)) == pytest.approx(0.23)
    faster = grip_acceleration(two, 0.5, 0.0, slope=0.1)
    assert faster == pytest.approx(G * (0.23 * math.cos(0.1) - math.sin(0.1)))
