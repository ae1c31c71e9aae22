"""The desired path, and the record of a platform's deviation from it."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from following_paths import AHEAD, CURVED, STIFF, robot
from routes import route

from drivesizer import explain, size
from drivesizer.control.path_following import deviation, extremes, follow, sampled, wheel_drive
from drivesizer.load_cases.platform import driving, platform_of, with_trajectory
from drivesizer.output.report.figures.machine import path_and_errors
from drivesizer.platform.trajectory import Trajectory
from drivesizer.spec.robot import load_spec

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
    assert drive.label == size(example.spec, top=1).shown.label  # what it selects
    assert wheel_drive(example.spec.platform.following, None) == (0.0, math.inf)


def test_the_figure():
    runs = {"kinematic": follow(CURVED, robot(), model="kinematic"), "dynamic": follow(CURVED, robot())}
    drawing = path_and_errors(runs)("typeset")
    assert drawing == path_and_errors(runs)("typeset")
    for word in ("desired", "kinematic", "dynamic", "heading (°)", "distance (m)", "way along the desired path (m)"):
        assert word in drawing.decode()
    assert path_and_errors(runs)("png")[:4] == b"\x89PNG"
