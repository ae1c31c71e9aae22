"""Following a trajectory: against laws of what is misjudged, dead reckoning, orders of error, and by hand."""

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from following_paths import AHEAD, CURVED, LEVER, STIFF, STRAIGHT, cart, robot
from platforms import MASS, RADIUS, WHEEL, car, mecanum
from refusals import refusal
from routes import route

from drivesizer import explain, size
from drivesizer.control.path_following import (
    Contact,
    SpeedLoop,
    deviation,
    extremes,
    follow,
    pose_loop,
    sampled,
    speed_loop,
    wheel_drive,
)
from drivesizer.load_cases.platform import driving, platform_of, with_trajectory
from drivesizer.output.report.figures.machine import path_and_errors
from drivesizer.platform.dynamics import Ground, dynamics
from drivesizer.platform.kinematics import EXACT, Misjudged, actual, kinematics, without_motor
from drivesizer.platform.trajectory import Trajectory
from drivesizer.spec.robot import load_spec


def worst(found):
    return np.abs(found.posture - found.planned.posture).max(axis=1)


# --- no errors --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("p", "path"), [(robot(), CURVED), (cart(), AHEAD)], ids=["mecanum", "differential"])
def test_the_kinematic_model_s_error_is_of_second_order_in_the_period(p, path):
    """What the speed loops lag by is J a / k_i, and k_i goes with 1/T²."""
    errors = [
        worst(
            follow(path, p, model="kinematic", contact=STIFF, speeds=speed_loop(dynamics(p), period=T), tolerance=1e-7)
        )
        for T in (4e-3, 2e-3, 1e-3)
    ]
    assert errors[0][0] > 5e-3
    for coarse, fine in pairwise(errors):
        assert (coarse[[0, 2]] / fine[[0, 2]] > 3.4).all() and (coarse[[0, 2]] / fine[[0, 2]] < 4.6).all()


@pytest.mark.parametrize("p", [robot(), cart(), replace(robot(rolling_resistance=0.02), x=0.05, y=-0.02, height=0.2)])
def test_the_dynamic_model_without_errors_leaves_next_to_none(p):
    path = CURVED if len(p.wheels) == 4 else AHEAD
    found = follow(path, p, contact=replace(STIFF, turnround=1e-5), tolerance=1e-7)
    kinematic = follow(path, p, model="kinematic", contact=STIFF, tolerance=1e-7)
    assert worst(found).max() < 1e-4 < worst(kinematic).max()
    assert found.limited.max() == 0.0


def test_torque_is_fed_forward_for_the_time_in_which_it_acts():
    """Half a period early or late leaves some 25 times as much."""
    p = cart()
    slow = follow(AHEAD, p, contact=STIFF, speeds=speed_loop(dynamics(p), period=4e-3), tolerance=1e-7)
    assert worst(slow).max() < 3e-6


def test_torques_of_the_speed_loops_are_those_of_the_model_in_the_end():
    """Without feedforward the loops find them by themselves: at constant speed, what resists."""
    p = robot(rolling_resistance=0.03)
    found = follow(STRAIGHT, p, model="kinematic", contact=STIFF)
    cruise = int(3.5 / 1e-3)
    assert found.torque[:, cruise] == pytest.approx([0.03 * MASS * 9.80665 / 4.0 * RADIUS] * 4, rel=1e-3)


def test_gains_by_hand():
    d = dynamics(robot())
    found, own = speed_loop(d, limit=5.0), 0.01 + WHEEL
    most = MASS * RADIUS**2 / 4.0 + own
    assert most > INERTIA_OF_TURNING  # ahead it meets more than turning
    assert found.proportional == pytest.approx([own / 3e-3] * 4)  # J / (2 * 1.5 T)
    assert found.integral == pytest.approx([found.proportional[0] ** 2 / (4.0 * most)] * 4)
    assert np.roots([most, found.proportional[0], found.integral[0]]).imag == pytest.approx([0.0, 0.0], abs=1e-3)
    assert found.limit == (5.0,) * 4
    lag = most / found.proportional[0] + 1.5 * 0.04
    poses = pose_loop(d, found, period=0.04)
    assert (poses.proportional, poses.integral) == pytest.approx((1.0 / (3.0 * lag), 1.0 / (27.0 * lag**2)))
    assert speed_loop(d, integral=False).integral == (0.0,) * 4


INERTIA_OF_TURNING = 2.34 / 4.0 * (RADIUS / LEVER) ** 2 + 0.01 + WHEEL


# --- what is misjudged, open-loop -------------------------------------------------------------------------------------


@pytest.mark.parametrize("model", ["kinematic", "dynamic"])
@pytest.mark.parametrize("error", [0.01, -0.02])
@pytest.mark.parametrize("p", [robot(), cart()], ids=["mecanum", "differential"])
def test_all_radii_off_lengthen_the_path(p, error, model):
    found, without = (
        deviation(follow(STRAIGHT, p, model=model, misjudged=Misjudged(radius=e), contact=STIFF)) for e in (error, 0.0)
    )
    assert found.along[-1] - without.along[-1] == pytest.approx(error * 6.0, rel=2e-3)
    assert np.abs(found.across).max() < 1e-6 and np.abs(found.heading).max() < 1e-6


def dead_reckoned(plan, believed, true):
    """Posture by wheel speeds alone, on the platform as it is: no forces, no controllers."""
    E, K_plus = kinematics(believed.wheels).E, kinematics(true.wheels).K_plus
    eta = K_plus @ E @ plan.in_robot()[0]
    step = np.diff(plan.time)
    middle = (eta[:, 1:] + eta[:, :-1]) / 2.0 * step
    theta = plan.posture[2, 0] + np.concatenate([[0.0], np.cumsum(middle[2])])
    half = (theta[1:] + theta[:-1]) / 2.0
    path = np.cumsum((middle[0] + 1j * middle[1]) * np.exp(1j * half))
    return np.array([path[-1].real, path[-1].imag, theta[-1]])


@pytest.mark.parametrize(
    "off",
    [Misjudged(radius=(0.01, -0.005, 0.004, 0.0)), Misjudged(toe=(0.01, -0.02, 0.005, 0.0)),
     Misjudged(radius=0.02, lever=-0.02)],
)  # fmt: skip
def test_stiff_tyres_are_dead_reckoning(off):
    """Loads alike: of wheels that cannot all roll, least squares of what they slip by."""
    p = robot()
    found = follow(CURVED, p, misjudged=off, contact=Contact(slip_speed=1.0, friction=1000.0), tolerance=1e-6)
    by_wheels = dead_reckoned(found.planned, p, actual(p, off))
    missed = by_wheels - found.planned.posture[:, -1]
    assert np.abs(missed).max() > 0.01
    assert found.posture[:, -1] - found.planned.posture[:, -1] == pytest.approx(missed, abs=0.02 * np.abs(missed).max())


def test_a_motor_that_is_weak_is_made_up_for_by_its_integral():
    weak = Misjudged(motor=(0.0, -0.4, 0.0, 0.0))
    p = robot(rolling_resistance=0.03)
    d = dynamics(p)
    with_sum, without = (
        deviation(follow(STRAIGHT, p, misjudged=weak, contact=STIFF, speeds=speed_loop(d, integral=i))).position.max()
        for i in (True, False)
    )
    assert with_sum < 0.005 < 0.02 < without


def test_what_a_proportional_loop_is_slow_by():
    """At constant speed the wheel lags by torque over gain; fed forward, by what the model misjudges of it."""
    p = robot(rolling_resistance=0.03)
    speeds = speed_loop(dynamics(p), integral=False)
    torque = 0.03 * MASS * 9.80665 / 4.0 * RADIUS
    for model, off, share in (("kinematic", EXACT, 1.0), ("dynamic", Misjudged(rolling_resistance=0.006), 0.2)):
        found = follow(STRAIGHT, p, model=model, misjudged=off, contact=STIFF, speeds=speeds)
        lag = 1.0 / RADIUS - found.speeds[:, 3500]
        assert lag == pytest.approx([share * torque / speeds.proportional[0]] * 4, rel=5e-3)


# --- poses fed back ---------------------------------------------------------------------------------------------------


def test_poses_take_a_constant_bias_away():
    p, long = robot(), route([(12.0, 0.0)], speed=1.0, acceleration=1.0)
    d, off = dynamics(p), Misjudged(radius=0.02, rolling_resistance=0.01)
    speeds = speed_loop(d)
    open_loop = deviation(follow(long, p, misjudged=off, contact=STIFF, speeds=speeds))
    found = deviation(follow(long, p, misjudged=off, contact=STIFF, speeds=speeds, poses=pose_loop(d, speeds)))
    assert open_loop.along[9000] == pytest.approx(0.02 * found.travel[9000], rel=0.01)
    assert abs(found.along[11500]) < 1e-4  # at constant speed
    assert found.position.max() < 0.01


def test_poses_take_a_sideways_bias_away():
    p, long = robot(), route([(12.0, 0.0)], speed=1.0, acceleration=1.0)
    d, off = dynamics(p), Misjudged(toe=0.02)  # of all wheels
    speeds = speed_loop(d)
    free = deviation(follow(long, p, misjudged=off, contact=STIFF, speeds=speeds))
    assert free.across[-1] == pytest.approx(12.0 * math.sin(0.02), rel=1e-3)
    held = deviation(follow(long, p, misjudged=off, contact=STIFF, speeds=speeds, poses=pose_loop(d, speeds)))
    assert abs(held.across[11500]) < 1e-4 < held.position.max() < 0.01


def test_poses_take_an_error_of_direction_away():
    p = robot()
    d, off = dynamics(p), Misjudged(radius=(0.01, -0.01, -0.01, 0.01), toe=0.01)
    speeds = speed_loop(d)
    free = deviation(follow(CURVED, p, misjudged=off, speeds=speeds))
    held = deviation(follow(CURVED, p, misjudged=off, speeds=speeds, poses=pose_loop(d, speeds)))
    assert free.position.max() > 20.0 * held.position.max()
    assert np.abs(free.heading).max() > 20.0 * np.abs(held.heading).max()


def test_a_unicycle_s_lateral_error():
    """Radii apart bend the path by δ at speed v; the law holds it where v y / d² = δ, so y = -2 e d² / b."""
    p, long = cart(), route([(20.0, 0.0)], speed=1.0, acceleration=1.0)
    d = dynamics(p)
    speeds = speed_loop(d)
    poses = pose_loop(d, speeds, speed=1.0)
    off = Misjudged(radius=(0.01, -0.01))
    found = deviation(follow(long, p, misjudged=off, contact=STIFF, speeds=speeds, poses=poses))
    at = int(19.0 / 1e-3)
    assert found.across[at] == pytest.approx(2.0 * 0.01 / 0.5 * poses.distance**2, rel=0.03)
    assert abs(found.along[at]) < 1e-4
    assert abs(deviation(follow(long, p, misjudged=off, contact=STIFF, speeds=speeds)).across[at]) > 5.0


# --- limits -----------------------------------------------------------------------------------------------------------


def test_a_torque_limit_that_is_reached_is_reported():
    p = robot(rolling_resistance=0.02)
    d = dynamics(p)
    hard = route([(3.0, 0.0)], speed=1.5, acceleration=2.0)
    need = MASS * 2.0 / 4.0 * RADIUS
    found = follow(hard, p, contact=STIFF, speeds=speed_loop(d, limit=0.8 * need))
    assert np.abs(found.torque).max() == pytest.approx(0.8 * need)
    assert (found.limited > (1.5 / 1.6 + 0.75) / 2.75).all() and (found.limited < 0.8).all()  # both ramps, and longer
    free = follow(hard, p, contact=STIFF, speeds=speed_loop(d))
    assert free.limited.max() == 0.0 and np.abs(free.torque).max() > need
    assert free.slip.max() < 3.0 * STIFF.slip_speed  # a step that is too long would jump from side to side
    assert worst(found)[0] > 10.0 * worst(free)[0]


def test_on_ice_the_wheels_spin_and_the_floor_gives_no_more():
    ice = Contact(friction=0.05, slip_speed=0.01)
    found = follow(route([(3.0, 0.0)], speed=1.5, acceleration=2.0), robot(), contact=ice)
    assert (found.traction <= 0.05 * found.load * (1.0 + 1e-12)).all()
    by = {e.title: e for e in extremes(found)}
    assert by["use of the floor's grip"].value > 0.999
    assert by["slip"].value > 0.3 and by["position"].value > 0.5
    rate = np.diff(found.velocity[0]) / 1e-3
    assert rate.max() < 0.05 * 9.80665 / math.sqrt(2.0) * 1.0001


@pytest.mark.parametrize("blocked", [False, True])
def test_without_a_motor(blocked):
    left = without_motor(robot(), 3, blocked=blocked)
    S = kinematics(left.wheels).motions
    if not blocked:
        found = follow(CURVED, left, contact=STIFF, tolerance=1e-7)
        assert worst(found).max() < 1e-4 and np.abs(found.torque[2]).max() == 0.0
        return
    eta = 0.3 * S[:, 0] / np.abs(S[:, 0]).max()
    rest = np.zeros((3, 1, 2))
    moving = Trajectory(np.array([1.0]), rest.copy(), rest + eta[:, None, None], rest.copy())
    if eta[2] == 0.0:
        moving.posture[:, 0, 1] = eta
        found = follow(moving, left, contact=STIFF)
        assert worst(found).max() < 1e-4 and np.abs(found.speeds[2]).max() == 0.0


# --- what cannot be ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"platform": cart()}, "velocity of the trajectory: it slides wheel 1 by"),
        ({"platform": mecanum(inertia=0.0)},
         "speed loop: a driven wheel has no inertia; give inertia or rotor_inertia"),
        ({"misjudged": Misjudged(radius=(0.1, 0.2))}, "misjudged radius: expected one figure, or 4, got 2"),
        ({"misjudged": Misjudged(mass=-1.5)}, "platform: mass must be above 0, got -22.5"),
        ({"speeds": speed_loop(dynamics(cart()))}, "speed loop: expected gains of 4 driven wheels, got 2"),
        ({"poses": pose_loop(dynamics(cart()), speed_loop(dynamics(cart())))},
         "pose loop: it does not fit the motions that this platform allows"),
        ({"speeds": SpeedLoop(period=1e-3, proportional=(1e6,) * 4, integral=(0.0,) * 4, limit=(math.inf,) * 4)},
         "following: speeds diverge at"),
        ({"ground": Ground(slope=np.zeros(3))}, "following: expected one slope for the whole path"),
    ],
)  # fmt: skip
def test_what_cannot_be_followed(change, said):
    assert refusal(lambda: follow(**({"trajectory": CURVED, "platform": robot()} | change))).startswith(said)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Misjudged(lever=math.nan), "misjudged: lever must be a number below 10, got nan"),
        (lambda: Misjudged(motor=-1.2), "misjudged: motor must be -1 or more, got -1.2"),
        (lambda: speed_loop(dynamics(robot()), period=5.0),
         "speed loop: period must lie between 1e-05 s and 1 s, got 5.0"),
        (lambda: pose_loop(dynamics(steered()), speed_loop(dynamics(steered()))),
         "pose loop: expected a platform that allows all motions, or forwards and turning only"),
    ],
)  # fmt: skip
def test_one_line_of_what_is_wrong(make, said):
    assert refusal(lambda: make()) == said


def steered():
    p = car(1.1, 0.6, 0.3)
    return replace(p, wheels=tuple(replace(w, inertia=0.01) for w in p.wheels))


# --- deviation from a route

# --- the desired path ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", [CURVED, AHEAD], ids=["turning", "unicycle"])
def test_a_route_is_the_integral_of_its_velocity(path):
    step = path.duration * (path.velocity[..., 0] + path.velocity[..., 1]) / 2.0
    assert path.posture[..., 1] - path.posture[..., 0] == pytest.approx(step, abs=2e-6)
    assert path.posture[:, 1:, 0] == pytest.approx(path.posture[:, :-1, 1], abs=1e-9)
    assert path.velocity[:, 1:, 0] == pytest.approx(path.velocity[:, :-1, 1], abs=1e-9)
    change = path.duration * (path.acceleration[..., 0] + path.acceleration[..., 1]) / 2.0
    assert path.velocity[..., 1] - path.velocity[..., 0] == pytest.approx(change, abs=3e-5)
    assert path.velocity[:, [0, -1], [0, 1]] == pytest.approx(np.zeros((3, 2)), abs=1e-12)


def test_where_a_route_ends():
    quarter = route([(2.0, 0.0), (1.5 * math.pi, 1.0 / 3.0)], speed=1.2, acceleration=0.6, turns=[(1.0, 5.0, -0.7)])
    assert quarter.posture[:, -1, 1] == pytest.approx([5.0, 3.0, -0.7])
    assert np.hypot(*quarter.velocity[:2]).max() == pytest.approx(1.2)
    short = route([(0.5, 0.0)], speed=2.0, acceleration=0.5)  # never at full speed: 2 sqrt(s / a)
    assert short.total == pytest.approx(2.0)


def test_a_trajectory_between_its_ends():
    parabola = Trajectory(
        duration=np.array([2.0]),
        posture=np.array([[[0.0, 3.0]], [[1.0, 1.0]], [[0.0, 0.0]]]),
        velocity=np.array([[[0.5, 2.5]], [[0.0, 0.0]], [[0.0, 0.0]]]),
        acceleration=np.array([[[1.0, 1.0]], [[0.0, 0.0]], [[0.0, 0.0]]]),
    )
    found = sampled(parabola, np.array([-1.0, 0.0, 0.5, 1.5, 2.0, 3.0]))
    assert found.posture[0] == pytest.approx([0.0, 0.0, 0.375, 1.875, 3.0, 3.0])
    assert found.velocity[0] == pytest.approx([0.0, 0.5, 1.0, 2.0, 2.5, 0.0])
    assert found.acceleration[0] == pytest.approx([0.0, 1.0, 1.0, 1.0, 1.0, 0.0])


# --- the record -------------------------------------------------------------------------------------------------------


def test_along_and_across_by_hand():
    found = follow(route([(1.0, 0.0), (0.5 * math.pi, 1.0)], speed=0.5, acceleration=1.0), robot(), contact=STIFF)
    moved = replace(found, posture=found.posture + np.array([[0.3], [0.4], [0.01]]))
    d = deviation(moved)
    assert d.position == pytest.approx(np.full(len(d.time), 0.5), abs=1e-3)
    assert (d.along[0], d.across[0]) == pytest.approx((0.3, 0.4), abs=1e-3)  # heading along x
    assert (d.along[-1], d.across[-1]) == pytest.approx((0.4, -0.3), abs=1e-3)  # along y in the end
    assert d.travel[-1] == pytest.approx(1.0 + 0.5 * math.pi, rel=1e-5)
    by = {e.title: e for e in extremes(moved)}
    assert by["heading"].value == pytest.approx(0.01, rel=0.01)
    assert (by["heading"].unit, by["position"].unit, by["slip"].unit) == ("deg", "m", "mm/s")


EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "sps_following.yaml"


@pytest.fixture(scope="module")
def example():
    return driving(with_trajectory(load_spec(EXAMPLE), None))


def test_figure_13_of_the_paper_is_in_the_examples(example):
    """Mass, wheels, places and the errors that the paper measured are its own; its path is of about 90 m."""
    section = example.spec.platform
    assert [(one.position, one.heading) for one in section.following.measured] == [
        (2.78, pytest.approx(math.radians(5.1))), (0.89, pytest.approx(math.radians(0.45))),
    ]  # fmt: skip
    robot = platform_of(section, example.spec.load)
    assert (robot.mass, robot.wheels[0].radius, robot.wheels[0].L) == pytest.approx((45.0, 0.0762, 0.27406))
    assert max(w.alpha for w in robot.wheels) == pytest.approx(math.radians(150.5))
    assert example.trajectory.length == pytest.approx(34 + 18 + 21 + 6 * math.pi, rel=0.01)  # straights, arcs of 3 m
    assert example.trajectory.posture[2, -1, 1] == pytest.approx(1.5 - 2.0 + 1.0, abs=1e-6)


def test_the_papers_drive_at_its_wheel(example):
    """10.8 g*cm^2 of rotor, 0.5 of gearhead and 0.7 of encoder behind 29.54; its 3.2 N*m behind 1.1."""
    (drive,) = explain(example.spec, "118752", "406764")
    ratio = 1.1 * 3249 / 121
    found = wheel_drive(example.spec.platform.following, drive)
    assert found.inertia == pytest.approx(ratio**2 * 12.0e-7, rel=0.005)
    assert found.torque == pytest.approx(3.2 * 1.1 * 0.95)
    assert drive.label == size(example.spec, top=1).reported.label  # what it selects
    assert wheel_drive(example.spec.platform.following, None) == (0.0, math.inf)


def test_the_figure():
    runs = {"kinematic": follow(CURVED, robot(), model="kinematic"), "dynamic": follow(CURVED, robot())}
    drawing = path_and_errors(runs)("typeset")
    assert drawing == path_and_errors(runs)("typeset")
    for word in ("desired", "kinematic", "dynamic", "heading (°)", "distance (m)", "way along the desired path (m)"):
        assert word in drawing.decode()
    assert path_and_errors(runs)("png")[:4] == b"\x89PNG"
