"""Kinematics of platforms: as printed, laws over random sets of wheels, singular sets, the declared equations."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from platforms import ALPHA, INERTIA, LENGTH, MASS, RADIUS, car, differential, mecanum, omni_three
from refusals import refusal
from wheel_sets import contact_row, figure, turn, wheel_sets

from drivesizer.errors import InputError
from drivesizer.platform import equations, robot_figures
from drivesizer.platform.dynamics import dynamics
from drivesizer.platform.equations import PLATFORM, MatrixEquation
from drivesizer.platform.kinematics import (
    Caster,
    Wheel,
    kinematics,
    table_wheel,
    to_robot,
    to_world,
    velocity,
    wheel_speeds,
    without_motor,
)

LEVER = 0.3735  # m, l1 + l2 of the paper's robot, by hand: 274.06 mm (cos 29.5° + sin 29.5°)


# --- as printed -------------------------------------------------------------------------------------------------------


def test_the_papers_robot_is_33_and_55():
    k = kinematics(mecanum().wheels)
    r, l = RADIUS, LENGTH * (math.cos(ALPHA) + math.sin(ALPHA))
    assert l == pytest.approx(LEVER, abs=5e-5)
    by_hand = np.array([[1, 1, l], [1, -1, -l], [1, 1, -l], [1, -1, l]]) / r
    assert pytest.approx(by_hand, rel=1e-12) == k.E
    inverse = r / 4 * np.array([[1, 1, 1, 1], [1, -1, 1, -1], [1 / l, -1 / l, -1 / l, 1 / l]])
    assert pytest.approx(inverse, rel=1e-12) == k.K_plus
    assert pytest.approx(by_hand, rel=1e-12) == equations.paper_wheel_map(l / 3, 2 * l / 3, r)
    assert pytest.approx(inverse, rel=1e-12) == equations.paper_velocity_map(r, l / 3, 2 * l / 3)
    assert k.E[0] == pytest.approx([13.123, 13.123, 4.9016], abs=5e-4)  # 1 / 76.2 mm, 373.5 / 76.2


def test_56_the_turning_speed_of_the_papers_robot():
    speeds = np.array([[3.0, 1.0], [-2.0, 0.5], [0.4, 0.2], [5.0, -1.0]])
    l = LENGTH * (math.cos(ALPHA) + math.sin(ALPHA))
    by_hand = RADIUS / (4 * l) * (speeds[0] - speeds[1] - speeds[2] + speeds[3])
    assert velocity(kinematics(mecanum().wheels), speeds)[2] == pytest.approx(by_hand, rel=1e-12)
    assert equations.turning_speed(RADIUS, l / 4, 3 * l / 4, *speeds) == pytest.approx(by_hand, rel=1e-12)


def test_the_papers_robot_at_its_speed():
    """1.5 m/s is 188.0 rpm at a wheel of 152.4 mm; √2 of it at two wheels on a diagonal."""
    k = kinematics(mecanum().wheels)
    rpm = 30 / math.pi
    assert wheel_speeds(k, [1.5, 0.0, 0.0]) * rpm == pytest.approx([187.98] * 4, abs=5e-3)
    assert wheel_speeds(k, [0.0, 1.5, 0.0]) * rpm == pytest.approx(187.98 * np.array([1, -1, 1, -1]), abs=5e-3)
    diagonal = wheel_speeds(k, [1.5 / math.sqrt(2), 1.5 / math.sqrt(2), 0.0]) * rpm
    assert diagonal == pytest.approx([265.84, 0.0, 265.84, 0.0], abs=5e-3)


def test_textbook_sets():
    """Three omni wheels and a differential drive, as Siegwart and Nourbakhsh have them (2004, 3.2.4-3.2.5)."""
    r, l = 0.05, 0.2
    k = kinematics(omni_three(r, l))
    by_hand = np.array([[0, 1, l], [-math.sin(math.pi / 3), -0.5, l], [math.sin(math.pi / 3), -0.5, l]]) / r
    assert pytest.approx(by_hand, abs=1e-12) == k.E
    k = kinematics(differential(track=0.5, radius=0.1).wheels)
    assert k.motions.T.tolist() == [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    assert wheel_speeds(k, [0.7, 0.0, 0.4]) == pytest.approx([(0.7 + 0.1) / 0.1, (0.7 - 0.1) / 0.1])  # right, left
    assert velocity(k, [3.0, 1.0]) == pytest.approx([0.2, 0.0, 0.4])


def test_a_car_turns_about_the_point_where_its_axles_meet():
    wheelbase, track, steering = 1.1, 0.6, 0.35
    k = kinematics(car(wheelbase, track, steering).wheels)
    assert k.mobility == 1
    radius = wheelbase / math.tan(steering)  # of the middle of the rear axle
    assert k.motions[:, 0] == pytest.approx([1.0, 0.0, 1.0 / radius])
    outer, inner = wheel_speeds(k, k.motions[:, 0])[:2]
    assert outer / inner == pytest.approx((radius + track / 2) / (radius - track / 2))


# --- laws -------------------------------------------------------------------------------------------------------------


@given(wheel_sets())
def test_there_and_back_from_the_general_constraint(wheels):
    k = kinematics(wheels)
    assert k.mobility == 3 and k.motions.tolist() == np.eye(3).tolist()
    rows = np.array([contact_row(w) / (w.radius * math.cos(w.roller_angle)) for w in wheels])
    assert pytest.approx(rows, rel=1e-9, abs=1e-9) == k.E
    assert k.K_plus @ k.E == pytest.approx(np.eye(3), abs=1e-9)
    assert pytest.approx(0.0, abs=1e-9) == k.J1 + k.J2 @ k.E  # (27)


@given(wheel_sets(), st.tuples(figure, figure, figure))
def test_no_contact_point_slips(wheels, eta):
    """The material point on the floor: platform, wheel and roller together leave it at rest."""
    k = kinematics(wheels)
    speeds, rollers = wheel_speeds(k, eta), k.rollers @ eta
    for w, speed, roller in zip(wheels, speeds, rollers, strict=True):
        ahead = w.heading
        axis = w.heading + w.roller_angle
        moved = np.array([eta[0] - w.y * eta[2], eta[1] + w.x * eta[2]])
        rolled = w.radius * speed * np.array([math.cos(ahead), math.sin(ahead)])
        across = roller * np.array([-math.sin(axis), math.cos(axis)])
        assert moved == pytest.approx(rolled + across, abs=1e-7 * (1 + np.abs(speeds).max()))


def test_rollers_stand_still_on_a_straight_way():
    """What the sign on the left of (25) is held against; to the left they turn at √2 of the speed."""
    k = kinematics(mecanum().wheels)
    assert k.rollers @ [1.5, 0.0, 0.0] == pytest.approx(0.0, abs=1e-12)
    assert np.abs(k.rollers @ [0.0, 1.5, 0.0]) == pytest.approx([1.5 * math.sqrt(2)] * 4)


@given(wheel_sets(), st.tuples(figure, figure, figure), turn, figure, figure)
def test_wheel_speeds_do_not_ask_where_the_reference_point_is(wheels, eta, angle, x, y):
    """The same platform told from another point and in turned axes."""
    moved = [
        replace(
            w,
            x=math.cos(angle) * (w.x - x) + math.sin(angle) * (w.y - y),
            y=-math.sin(angle) * (w.x - x) + math.cos(angle) * (w.y - y),
            heading=w.heading - angle,
        )
        for w in wheels
    ]
    there = to_robot(angle, [eta[0] - y * eta[2], eta[1] + x * eta[2], eta[2]])
    speeds = wheel_speeds(kinematics(wheels), eta)
    assert wheel_speeds(kinematics(moved), there) == pytest.approx(speeds, abs=1e-8 * (1 + np.abs(speeds).max()))


@given(wheel_sets(), st.integers(0, 2**32 - 1))
def test_what_no_motion_explains_is_perpendicular_to_all_that_does(wheels, seed):
    k, speeds = kinematics(wheels), np.random.default_rng(seed).normal(size=(len(wheels), 5))
    left = speeds - wheel_speeds(k, velocity(k, speeds))
    assert k.E.T @ left == pytest.approx(0.0, abs=1e-8 * np.abs(k.E).max())


def test_speeds_of_four_mecanum_wheels_that_no_motion_explains():
    k = kinematics(mecanum().wheels)
    assert velocity(k, [1.0, 1.0, -1.0, -1.0]) == pytest.approx(0.0, abs=1e-15)


@given(st.floats(0.1, 1.0), st.floats(-1.5, 1.5), st.floats(-1.5, 1.5), st.floats(-0.7, 0.7), st.floats(0.05, 0.2))
def test_table_1_and_coordinates_say_the_same(L, alpha, beta, gamma, r):
    w = table_wheel(L, alpha, beta, gamma, r)
    assert (w.L, w.alpha) == pytest.approx((L, alpha))
    assert w.beta == pytest.approx(beta)
    phi, delta = alpha + beta + gamma, beta + gamma
    row = -np.array([-math.sin(phi), math.cos(phi), L * math.cos(delta)])  # (26)
    assert row == pytest.approx(contact_row(w), abs=1e-12)


@given(turn, st.tuples(figure, figure, figure))
def test_world_and_robot_and_back(theta, rates):
    assert to_world(theta, to_robot(theta, rates)) == pytest.approx(rates, abs=1e-12)
    assert np.hypot(*to_robot(theta, rates)[:2]) == pytest.approx(math.hypot(*rates[:2]), abs=1e-12)


# --- a motor that failed ----------------------------------------------------------------------------------------------


def after_failure(platform, wheel, *, blocked=False):
    """Dynamics without a motor, and the largest torque to gain speed along each motion over that with all motors."""
    left = dynamics(without_motor(platform, wheel, blocked=blocked))
    motions = left.kinematics.motions
    before, after = (np.abs(d.distribution @ d.M @ motions).max(axis=0) for d in (dynamics(platform), left))
    return left, after / before


@pytest.mark.parametrize("wheel", [1, 2, 3, 4])
def test_three_of_four_mecanum_wheels_still_make_every_motion(wheel):
    """The paper, section 2: the structure is redundant and a failed motor leaves the task possible."""
    left, torque_ratio = after_failure(mecanum(), wheel)
    assert left.kinematics.motions.tolist() == np.eye(3).tolist()
    assert torque_ratio == pytest.approx([2.0, 2.0, 2.0])  # two of the three work, each for two
    k = kinematics(left.platform.wheels)
    assert velocity(k, np.delete(kinematics(mecanum().wheels).E @ [0.5, -0.2, 0.7], wheel - 1)) == pytest.approx(
        [0.5, -0.2, 0.7]
    )


def test_a_blocked_wheel_leaves_two_motions():
    left, torque_ratio = after_failure(mecanum(inertia=0.0), 1, blocked=True)
    motions = left.kinematics.motions
    assert motions.shape == (3, 2)
    assert kinematics(mecanum().wheels).E[0] @ motions == pytest.approx(0.0, abs=1e-12)
    l = LENGTH * (math.cos(ALPHA) + math.sin(ALPHA))
    assert pytest.approx(np.array([[1.0, 0.0, -1 / l], [0.0, 1.0, -1 / l]])) == motions.T
    m, i = MASS, INERTIA / l**2  # by hand, from A τ = f with three wheels and two motions
    assert torque_ratio[0] == pytest.approx(2 / 3 * (2 * m + i) / (m + i))
    with pytest.raises(
        InputError, match=r"^velocity of the platform: it turns the blocked wheel 1 by 1 m/s, at sample 0"
    ):
        wheel_speeds(kinematics(left.platform.wheels), [1.0, 0.0, 0.0])


def test_a_differential_drive_with_one_motor_is_lost():
    with pytest.raises(InputError, match="with its driven wheels at rest"):
        after_failure(differential(), 1)
    left, _ = after_failure(differential(), 1, blocked=True)
    assert left.kinematics.motions.shape == (3, 1)  # round the wheel that stands


# --- refused ----------------------------------------------------------------------------------------------------------

AT = {"radius": 0.1}
SINGULAR = {
    "omni wheels with parallel axles": (
        [Wheel(x=0.3 * i, y=0.2 * i * i, **AT) for i in range(4)], r"at rest \(1 m/s to the left\)"),
    "omni wheels that point to one place": (
        [Wheel(x=0.3 * math.cos(a), y=0.3 * math.sin(a), heading=a, **AT) for a in (0, 1, 2.5)], r"1 rad/s turning"),
    "mecanum rollers that all lie alike": (
        [Wheel(x=x, y=y, roller_angle=math.pi / 4, **AT) for x in (-0.3, 0.3) for y in (-0.2, 0.2)], "at rest"),
    "square of mecanum wheels, mounted crosswise": (
        [Wheel(x=x, y=y, roller_angle=math.copysign(math.pi / 4, x * y), **AT)
         for x in (-0.3, 0.3) for y in (-0.3, 0.3)], r"\(1 rad/s turning\)"),
    "two omni wheels": ([Wheel(x=0.0, y=y, **AT) for y in (-0.3, 0.3)], "to the left"),
    "one fixed wheel": ([Wheel(x=0.2, y=0.3, held=True, **AT)], "turning"),
    "fixed wheels that hold one another": (
        [Wheel(x=x, y=y, heading=h, held=True, **AT) for x, y, h in ((0, 0, 0), (1, 0, 1), (0, 1, 2))], "no motion"),
}  # fmt: skip


@pytest.mark.parametrize("name", SINGULAR)
def test_singular_sets_are_refused_in_one_line(name):
    wheels, words = SINGULAR[name]
    assert len(refusal(lambda: kinematics(wheels), match=words)) < 140


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: replace(mecanum(), mass=-45.0), "platform: mass must be above 0, got -45.0"),
        (lambda: replace(mecanum(), inertia=0.0), "platform: inertia must be above 0, got 0.0"),
        (lambda: replace(mecanum(), mass=math.nan), "platform: mass must be above 0, got nan"),
        (lambda: replace(mecanum(), wheels=()), "platform: no wheel is driven; expected one with a motor at least"),
        (lambda: replace(mecanum(), wheels=mecanum().wheels * 2), "platform: wheels 1 and 5 stand in one place"),
        (lambda: replace(differential(), casters=(Caster(x=0.0, y=0.25),)), "platform: wheels 2 and 3 stand in one"),
        (lambda: without_motor(mecanum(), 5), "platform: there is no wheel 5; expected 1 to 4"),
        (lambda: wheel_speeds(kinematics(mecanum().wheels), [[1.0, 2.0], [0.0, math.nan], [0.0, 0.0]]),
         "velocity of the platform: row 2 at sample 1 is not a finite number"),
        (lambda: wheel_speeds(kinematics(mecanum().wheels), [1.0, 2.0]),
         "velocity of the platform: expected 3 rows, got an array of shape (2,)"),
        (lambda: velocity(kinematics(mecanum().wheels), [1.0, 2.0]), "speeds of the driven wheels: expected 4 rows"),
    ],
)  # fmt: skip
def test_bad_figures_are_refused_in_one_line(make, words):
    assert refusal(lambda: make()).startswith(words)


# --- the declarations -------------------------------------------------------------------------------------------------


def test_21_to_59_are_declared():
    assert sorted(PLATFORM) == list(range(21, 60))
    assert {e for e in vars(equations).values() if isinstance(e, MatrixEquation)} == set(PLATFORM.values())


def test_what_the_paper_prints_wrong_is_found():
    found = {n: robot_figures.finding(e) for n, e in PLATFORM.items()}
    assert {n for n, f in found.items() if f.values} == {23, 25, 37, 58, 59}
    assert not any(f.units for f in found.values())
    assert all(PLATFORM[n].note for n in (23, 25, 37, 58, 59))
    assert "3 × 4" in str(found[58].values)


@pytest.mark.parametrize("number", sorted(PLATFORM))
def test_a_declaration_says_what_its_function_does(number):
    e = PLATFORM[number]
    names = list(e.formula.__annotations__)
    assert [t.name for t in e.terms] == names[:-1] and all(t.meaning for t in e.terms)
    figures = {t.name: robot_figures.sample()[t.name] for t in e.terms}
    again = robot_figures.finding(replace(e, printed=e.computed))  # the function's own form, in other units
    assert again.units is None and again.values is None
    assert np.asarray(e(**figures)) == pytest.approx(np.asarray(robot_figures._value(e.computed)), abs=1e-12)
    told = dict(robot_figures.rows(e))
    assert told["as computed"].startswith(f"{e.symbol} = ") and "None" not in told["as printed"]
