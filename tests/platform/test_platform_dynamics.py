"""Dynamics of platforms: against Newton's laws with contact forces, load cycles of a vehicle, and conservation laws."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from platform_vehicles import LOPSIDED
from platforms import INERTIA, MASS, RADIUS, acceleration, car, differential, mecanum
from refusals import refusal
from scipy.integrate import solve_ivp
from wheel_sets import wheel_sets

from drivesizer.platform.dynamics import (
    Ground,
    Moving,
    contact_loads,
    dynamics,
    energy,
    required_force,
    resistance,
    weight_along,
    wheel_space,
    wheel_torques,
)
from drivesizer.platform.kinematics import Caster, Platform, kinematics, to_world, velocity, wheel_speeds, without_motor

G = 9.80665
NULL = np.array([1.0, 1.0, -1.0, -1.0])
figure = st.floats(-2.0, 2.0)
velocities = st.tuples(figure, figure, figure)


@st.composite
def platforms(draw):
    """Any mass on any wheels that hold it, the centre of mass off the reference point."""
    wheels = tuple(
        replace(w, inertia=draw(st.floats(0.0, 0.1)), rotor_inertia=draw(st.floats(0.0, 0.1)))
        for w in draw(wheel_sets())
    )
    figures = {n: draw(st.floats(-0.4, 0.4)) for n in ("x", "y")}
    return Platform(wheels=wheels, mass=draw(st.floats(1.0, 200.0)), inertia=draw(st.floats(0.1, 20.0)), **figures)


# --- Newton's laws ----------------------------------------------------------------------------------------------------


def by_newton(p, eta, torques):
    """Rates of the velocity in the robot's axes: body and wheels cut free, a force at each contact; no Lagrange, no E.

    Unknown are the three rates, the wheels' accelerations, and at each contact the force along the roller's axis and,
    where the wheel is held, the one across it.
    """
    n, across = len(p.wheels), [i for i, w in enumerate(p.wheels) if w.held]
    size = 3 + 2 * n + len(across)
    A, b = np.zeros((size, size)), np.zeros(size)
    u, v, turn = eta
    A[0, [0, 2]], b[0] = (p.mass, -p.mass * p.y), p.mass * (turn * v + turn**2 * p.x)
    A[1, [1, 2]], b[1] = (p.mass, p.mass * p.x), p.mass * (-turn * u + turn**2 * p.y)
    A[2, 2] = p.inertia  # moments about the centre of mass
    pulls = [(3 + n + i, w, w.heading + w.roller_angle) for i, w in enumerate(p.wheels)]
    holds = [(3 + 2 * n + j, p.wheels[i], p.wheels[i].heading + math.pi / 2) for j, i in enumerate(across)]
    for column, w, angle in pulls + holds:
        along = np.array([math.cos(angle), math.sin(angle)])
        A[:2, column] = -along
        A[2, column] = -((w.x - p.x) * along[1] - (w.y - p.y) * along[0])
        A[column, :3] = *along, w.x * along[1] - w.y * along[0]  # how fast the contact point gains speed along it
    for i, w in enumerate(p.wheels):
        rolls = w.radius * math.cos(w.roller_angle)
        A[3 + n + i, 3 + i] = -rolls
        A[3 + i, [3 + i, 3 + n + i]], b[3 + i] = (w.inertia + w.rotor_inertia, rolls), torques[i]
    return np.linalg.lstsq(A, b, rcond=1e-12)[0][:3]  # two wheels on one axle share what holds them sideways


@given(platforms(), velocities, st.integers(0, 2**32 - 1))
def test_motion_under_torques_is_newtons(p, eta, seed):
    torques = np.random.default_rng(seed).normal(size=len(p.wheels))
    by_hand = by_newton(p, eta, torques)
    assert acceleration(dynamics(p), eta, torques) == pytest.approx(by_hand, abs=1e-7 * (1 + np.abs(by_hand).max()))


@given(st.floats(0.3, 1.0), st.floats(-0.5, 0.5), st.floats(-0.3, 0.3), figure, figure, figure, figure)
def test_a_differential_drive_is_newtons(track, x, y, v, turn, right, left):
    """Held sideways, the centre of mass anywhere; each wheel with an inertia of its own."""
    p = replace(differential(track), x=x, y=y)
    p = replace(p, wheels=tuple(replace(w, inertia=0.02 + 0.01 * i) for i, w in enumerate(p.wheels)))
    by_hand = by_newton(p, (v, 0.0, turn), (right, left))
    found = acceleration(dynamics(p), (v, 0.0, turn), (right, left))
    assert found == pytest.approx(by_hand, abs=1e-9 * (1 + np.abs(by_hand).max()))
    assert wheel_torques(dynamics(p), Moving((v, 0.0, turn), found)) == pytest.approx([right, left], abs=1e-9)


def test_a_car_is_newtons_with_its_torque_shared_alike():
    p = car(1.1, 0.6, 0.35)
    k = kinematics(p.wheels)
    eta, rate = 1.3 * k.motions[:, 0], 0.7 * k.motions[:, 0]
    torques = wheel_torques(dynamics(p), Moving(eta, rate))
    assert by_newton(p, eta, [*torques, 0.0]) == pytest.approx(rate)
    speeds = wheel_speeds(k, eta)[:2]
    assert torques[0] / torques[1] == pytest.approx(speeds[0] / speeds[1])  # least squares: the faster does more


# --- work and energy --------------------------------------------------------------------------------------------------


@given(platforms(), velocities, velocities)
def test_power_of_the_wheels_is_that_of_the_motion(p, eta, rate):
    d = dynamics(p)
    eta, rate = np.array(eta), np.array(rate)
    force = d.M @ rate + eta[2] * d.C @ eta
    torques = wheel_torques(d, Moving(eta, rate))
    power = torques @ wheel_speeds(d.kinematics, eta)
    size = np.abs(eta) @ np.abs(d.M) @ np.abs(rate) + np.abs(torques) @ np.abs(wheel_speeds(d.kinematics, eta)) + 1e-9
    assert eta @ force == pytest.approx(power, abs=1e-9 * size)
    assert eta @ d.C @ eta == pytest.approx(0.0, abs=1e-12 * p.mass)


def coasting(d, start, seconds, ground=None):
    """Posture and velocity over a run without torque."""
    rest = np.zeros(len(d.kinematics.driven))
    more = {} if ground is None else {"ground": ground}

    def rate(_t, state):
        theta, eta = state[2], state[3:]
        return [*to_world(theta, eta), *acceleration(d, eta, rest, theta=theta, **more)]

    return solve_ivp(rate, (0.0, seconds), [0.0, 0.0, 0.3, *start], method="DOP853", rtol=1e-12, atol=1e-13).y


@pytest.mark.parametrize(
    ("platform", "start"),
    [(LOPSIDED, (0.9, -0.4, 1.7)), (replace(differential(inertia=0.03), x=0.2, y=0.05), (0.9, 0.0, 1.7))],
    ids=["mecanum", "differential"],
)
def test_a_platform_that_coasts_keeps_its_energy(platform, start):
    d = dynamics(platform)
    state = coasting(d, start, 20.0)
    kept = energy(d, state[3:])
    assert kept == pytest.approx(kept[0], rel=1e-9)
    assert np.ptp(state[3]) > 0.05  # m/s: it does not merely go on as it was


def test_what_resists_takes_the_energy():
    """A run that comes down from speed: the energy that is gone is the work against each wheel, roller and caster."""
    p = replace(LOPSIDED, y=-0.02, casters=(Caster(x=0.3, y=0.2, rolling_resistance=0.015),))
    p = replace(p, wheels=tuple(
        replace(w, rolling_resistance=0.01 * (1 + i), roller_resistance=0.02, friction=0.03)
        for i, w in enumerate(p.wheels)))  # fmt: skip
    d, eta = dynamics(p), np.array([0.8, 0.3, 0.9])
    load = contact_loads(p)
    assert load.min() > 5.0
    speeds, rollers = wheel_speeds(d.kinematics, eta), d.kinematics.rollers @ eta
    lost = sum((0.01 * (1 + i) * load[i] * RADIUS + 0.03) * abs(speeds[i]) for i in range(4))
    lost += sum(0.02 * load[i] * abs(rollers[i]) for i in range(4))
    lost += 0.015 * load[4] * math.hypot(0.8 - 0.2 * 0.9, 0.3 + 0.3 * 0.9)
    assert eta @ resistance(d, eta) == pytest.approx(lost, rel=1e-12)
    assert eta @ d.M @ acceleration(d, eta, np.zeros(4)) == pytest.approx(-lost, rel=1e-12)


# --- against a vehicle's load cycle -----------------------------------------------------------------------------------


def test_a_wheel_that_stands_does_not_resist():
    """On a diagonal cos 45° and sin 45° differ by rounding; what is left of two wheels' speed is no motion."""
    d = dynamics(mecanum(rolling_resistance=0.02))
    eta = [math.cos(math.pi / 4), math.sin(math.pi / 4), 0.0]
    by_hand = 0.02 * MASS * G / 4 * RADIUS
    assert wheel_torques(d, Moving(eta, [0.0, 0.0, 0.0])) == pytest.approx(by_hand * np.array([1, 0, 1, 0]), abs=1e-12)


def test_rollers_make_the_way_to_the_side_harder():
    d = dynamics(mecanum(rolling_resistance=0.02, roller_resistance=0.03))
    assert required_force(d, Moving([1.0, 0.0, 0.0], [0.0] * 3))[0] == pytest.approx(0.02 * MASS * G)
    aside = required_force(d, Moving([0.0, 1.0, 0.0], [0.0] * 3))[1]
    assert aside == pytest.approx((0.02 + 0.03 * math.sqrt(2)) * MASS * G)


HARD = {"rolling_resistance": 0.02, "roller_resistance": 0.03}
ROLLING = MASS * G / 4 * RADIUS  # N*m per unit of resistance, of one wheel
ROOT = math.sqrt(2.0)
BY_HAND = {  # torques of the four wheels: wheels that turn and rollers that do, (54) transposed of forces on the floor
    0.0: ROLLING * 0.02 * np.array([1.0, 1.0, 1.0, 1.0]),  # rollers stand
    180.0: ROLLING * 0.02 * np.array([-1.0, -1.0, -1.0, -1.0]),
    90.0: ROLLING * (0.02 + 0.03 * ROOT) * np.array([1.0, -1.0, 1.0, -1.0]),  # wheels at V/r, rollers at sqrt(2) V
    -90.0: ROLLING * (0.02 + 0.03 * ROOT) * np.array([-1.0, 1.0, -1.0, 1.0]),
    45.0: ROLLING * np.array([0.02 + 0.03 * ROOT, -0.03 * ROOT, 0.02 + 0.03 * ROOT, -0.03 * ROOT]),  # 2 and 4 stand
    -45.0: ROLLING * np.array([-0.03 * ROOT, 0.02 + 0.03 * ROOT, -0.03 * ROOT, 0.02 + 0.03 * ROOT]),
}


@pytest.mark.parametrize("residue", [0.0, 1e-13, -1e-13])
@pytest.mark.parametrize("heading", BY_HAND)
def test_rollers_that_stand_do_not_resist(heading, residue):
    """What is left of a sine of 180 deg, or of places of Table 1, has no direction: C_rr m g r / 4 straight ahead."""
    angle = math.radians(heading) + residue
    d = dynamics(mecanum(**HARD))
    found = wheel_torques(d, Moving([math.cos(angle), math.sin(angle), 0.0], [0.0] * 3))
    assert found == pytest.approx(BY_HAND[heading], rel=1e-9)
    assert wheel_torques(
        d, Moving([0.0] * 3, [0.0] * 3, towards=[math.cos(angle), math.sin(angle), 0.0])
    ) == pytest.approx(found)


def test_a_caster_in_the_centre_of_a_turn_does_not_roll():
    """On a circle of 3 · 0.1 m about a caster its contact point stands, whatever 3 · 0.1 - 0.3 is."""
    p = replace(mecanum(), casters=(Caster(x=0.0, y=0.3, rolling_resistance=0.5),))
    assert resistance(dynamics(p), np.array([3 * 0.1, 0.0, 1.0])) == pytest.approx([0.0] * 3, abs=1e-12)


# --- sharing the torque -----------------------------------------------------------------------------------------------


@given(velocities, velocities, st.floats(-1.0, 1.0).filter(lambda c: abs(c) > 1e-3))
def test_of_all_torques_that_make_a_motion_those_are_the_least(eta, rate, c):
    d = dynamics(LOPSIDED)
    torques = wheel_torques(d, Moving(eta, rate))
    assert acceleration(d, eta, torques) == pytest.approx(rate, abs=1e-9)
    assert acceleration(d, eta, torques + c * NULL) == pytest.approx(rate, abs=1e-9)
    assert np.linalg.norm(torques + c * NULL) > np.linalg.norm(torques)


@given(velocities, velocities)
def test_wheel_space_is_57_to_59(eta, rate):
    p = mecanum(inertia=0.02)
    d, k = dynamics(p), kinematics(p.wheels)
    M, C = wheel_space(d)
    speeds, gains = wheel_speeds(k, eta), wheel_speeds(k, rate)
    torques = M @ gains + velocity(k, speeds)[2] * C @ speeds
    assert torques == pytest.approx(wheel_torques(d, Moving(eta, rate)), abs=1e-9)
    M_R = np.diag([MASS, MASS, INERTIA])
    printed = np.linalg.pinv(k.E.T) @ M_R @ k.K_plus + 0.02 * np.eye(4) @ k.E @ k.K_plus
    assert pytest.approx(printed, abs=1e-12) == M
    assert np.linalg.matrix_rank(M, tol=1e-9) == 3
    assert np.abs(M @ NULL).max() < 1e-12


def test_torques_of_a_load_cycle_leave_the_rotor_to_the_drive():
    d, own = dynamics(mecanum(rotor_inertia=0.05)), dynamics(mecanum())
    eta, rate = [0.5, -0.2, 0.9], [0.4, 0.3, -1.1]
    without = wheel_torques(d, Moving(eta, rate), rotors=False)
    assert without == pytest.approx(wheel_torques(own, Moving(eta, rate)))
    gains = wheel_speeds(d.kinematics, rate)
    assert without + 0.05 * gains == pytest.approx(wheel_torques(d, Moving(eta, rate)))


def test_three_of_four_motors():
    """Straight on with wheel 4 dead: wheels 1 and 2 do it all, the third has nothing to do; its rotor is turned too."""
    whole, left = dynamics(mecanum()), dynamics(without_motor(mecanum(rotor_inertia=0.01), 4))
    assert left.kinematics.driven == (0, 1, 2)
    ahead = wheel_torques(dynamics(without_motor(mecanum(), 4)), Moving([1.0, 0.0, 0.0], [0.8, 0.0, 0.0]))
    before = wheel_torques(whole, Moving([1.0, 0.0, 0.0], [0.8, 0.0, 0.0]))[0]
    assert ahead == pytest.approx([2 * before, 2 * before, 0.0], abs=1e-12)
    eta, rate = (0.4, -0.3, 0.8), (0.3, 0.5, -0.7)
    torques = wheel_torques(left, Moving(eta, rate))
    assert by_newton(left.platform, eta, [*torques, 0.0]) == pytest.approx(rate)


# --- payload, slope, loads --------------------------------------------------------------------------------------------


@given(st.floats(-0.3, 0.3), st.floats(-math.pi, math.pi), st.floats(-math.pi, math.pi))
def test_the_weight_along_a_slope_points_downhill(slope, uphill, theta):
    force = weight_along(LOPSIDED, theta, Ground(slope=slope, uphill=uphill))
    in_world = to_world(theta, [force[0], force[1], 0.0])[:2]
    assert in_world == pytest.approx(-MASS * G * math.sin(slope) * np.array([math.cos(uphill), math.sin(uphill)]))
    assert force[2] == pytest.approx(LOPSIDED.x * force[1] - LOPSIDED.y * force[0])


# --- columns and refusals ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda _: Moving([0.0, 0.0, math.nan], [0.0] * 3), "velocity of the platform: row 3 is not a"),
        (lambda _: Moving([0.0] * 3, [0.0, math.inf, 0.0]), "acceleration of the platform: row 2 is not"),
        (lambda _: wheel_torques(dynamics(differential()), Moving([1.0, 0.0, 0.0], [0.0, 0.5, 0.0])),
         "acceleration of the platform: it slides wheel 1 by 0.5 m/s^2, at sample 0"),
    ],
)  # fmt: skip
def test_bad_figures_are_refused_in_one_line(make, words):
    assert refusal(lambda: make(dynamics(mecanum()))).startswith(words)
