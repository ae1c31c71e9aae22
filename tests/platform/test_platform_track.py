"""Files of postures: splines against motions known in closed form, files there and back, every fault one line."""

from __future__ import annotations

import math

import numpy as np
import pytest
from platforms import differential, mecanum
from refusals import refusal

from drivesizer.errors import InputError
from drivesizer.platform.dynamics import dynamics
from drivesizer.platform.planner import Limits, Waypoint, plan, read_track
from drivesizer.platform.stability import wheel_cycles
from drivesizer.platform.trajectory import spline

LIMITS = Limits(speed=1.0, acceleration=0.8, jerk=2.0, turning_speed=1.5, turning_acceleration=2.0, turning_jerk=6.0)
ROUTE = [
    Waypoint(x=0.0, y=0.0, heading=0.0),
    Waypoint(x=2.0, y=0.5, heading=2.0, pause=1.5),
    Waypoint(x=2.0, y=0.5, heading=7.0),
    Waypoint(x=-1.0, y=1.0),
]


@pytest.fixture
def file(tmp_path):
    """Writes a file: text, or a header with units and columns."""

    def written(head, *columns):
        rows = "".join(",".join(repr(float(v)) for v in row) + "\n" for row in zip(*columns, strict=True))
        (tmp_path / "run.csv").write_text(f"{head}\n{rows}" if columns else head)
        return tmp_path / "run.csv"

    return written


def circle(time, radius=2.0, end=10.0, angle=12.0):
    """Round a circle from rest to rest, looking along it: angle, its speed and its acceleration in closed form."""
    u = np.clip(time / end, 0.0, 1.0)
    phi = angle * (u**3 * (10 - 15 * u + 6 * u**2))
    rate = angle / end * 30 * u**2 * (1 - u) ** 2
    gain = angle / end**2 * 60 * u * (1 - u) * (1 - 2 * u)
    return np.array([radius * np.sin(phi), radius * (1 - np.cos(phi)), phi]), rate, gain


# --- splines ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("step", [0.01, 0.02])
def test_on_a_circle_it_feels_the_centripetal_acceleration(step):
    time = np.arange(0.0, 10.0 + step / 2, step)
    posture, rate, gain = circle(time)
    t = spline(time, posture)
    eta, eta_dot = t.in_robot()
    _, rate, gain = circle(t.time)
    assert eta[0] == pytest.approx(2.0 * rate, abs=1e-5)
    assert eta[1] == pytest.approx(0.0, abs=1e-5)
    felt = eta_dot[1] + t.velocity[2] * eta[0]  # of the world's acceleration, to the left
    assert felt == pytest.approx(2.0 * rate**2, abs=30 * step**2)  # a cubic's second derivative is off by h²
    assert np.abs(felt).max() == pytest.approx(2.0 * (12.0 / 10 * 30 / 16) ** 2, rel=1e-3)
    assert t.acceleration[2] == pytest.approx(gain, abs=10 * step**2)


def test_where_it_rests_it_rests():
    """Two moves with a rest between, evenly accelerated: without a spline of its own each would shake the rest."""
    time = np.arange(0.0, 7.001, 0.05)
    ramp = np.where(time < 1, time**2 / 2, np.where(time < 2, 1 - (2 - time) ** 2 / 2, 1.0))
    later = np.interp(time - 5.0, time, ramp, left=0.0)
    t = spline(time, np.array([ramp + later, 0.0 * time, 0.0 * time]))
    rest = (t.time[:, 0] > 2.0 - 1e-9) & (t.time[:, 1] < 5.0 + 1e-9)
    assert (t.velocity[:, rest] == 0.0).all() and (t.acceleration[:, rest] == 0.0).all()
    assert t.duration[rest] == pytest.approx([3.0])
    assert np.abs(t.velocity[0]).max() == pytest.approx(1.0, abs=0.02)


def test_from_rest_it_accelerates_at_once():
    """A parabola from rest is a cubic that is clamped; a natural spline would start without acceleration."""
    time = np.arange(0.0, 2.001, 0.05)
    way = np.where(time < 1, time**2 / 2, 1 - (2 - time) ** 2 / 2)
    t = spline(time, np.array([way, 0.0 * time, 0.5 * way]))
    assert t.acceleration[0, :4] == pytest.approx(np.ones((4, 2)), abs=1e-3)
    assert t.acceleration[2, -4:] == pytest.approx(np.full((4, 2), -0.5), abs=1e-3)


# --- files ------------------------------------------------------------------------------------------------------------


def test_a_planned_trajectory_comes_back_from_its_file(file):
    planned = plan(ROUTE, LIMITS)
    time = np.append(np.arange(0.0, planned.total, 0.01), planned.total)
    x, y, heading = planned.at(time)
    wrapped = np.degrees(np.arctan2(np.sin(heading), np.cos(heading)))
    back = read_track(file("heading,t,y,x\ndeg,ms,m,mm", wrapped, 1e3 * time, y, 1e3 * x), LIMITS)
    assert back.total == pytest.approx(planned.total)
    moment = np.linspace(0.0, planned.total, 5000)
    assert back.at(moment) == pytest.approx(planned.at(moment), abs=2e-6)
    d = dynamics(mecanum(rolling_resistance=0.02))
    for ours, theirs in zip(wheel_cycles(d, back), wheel_cycles(d, planned), strict=True):
        work = [float((c.duration * (c.torque * c.speed).mean(axis=1)).sum()) for c in (ours, theirs)]
        assert np.abs(ours.speed).max() == pytest.approx(np.abs(theirs.speed).max(), rel=1e-3)
        assert work[0] == pytest.approx(work[1], rel=5e-3)


def test_a_differential_drive_follows_a_sampled_curve(file):
    """Samples rounded to 10 µm and 0.001°: the spline slides its wheels by little, which is left out."""
    time = np.arange(0.0, 10.001, 0.05)
    x, y, phi = circle(time)[0]
    columns = (np.round(x, 5), np.round(y, 5), np.round(np.degrees(phi), 3))
    track = read_track(file("time,x,y,theta\ns,m,m,deg", time, *columns))
    right, left = wheel_cycles(dynamics(differential()), track)
    assert np.abs(right.speed).max() == pytest.approx((2.0 + 0.25) * 2.25 / 0.1, rel=1e-3)
    assert np.abs(left.speed).max() == pytest.approx((2.0 - 0.25) * 2.25 / 0.1, rel=1e-3)


@pytest.mark.parametrize(("row", "column", "value"), [(33, 1, 1e6), (500, 2, 1e5), (737, 1, 300.0)])
def test_a_sample_far_off_between_knots_is_a_jump(file, row, column, value):
    """In 0.4 s, the longest between two knots, nothing on wheels gets farther than 20 m: that is no motion."""
    time = np.arange(0.0, 10.001, 0.01)
    x, y, heading = circle(time, angle=3.0)[0]
    columns = [time, x, y, heading]
    columns[column][row] = value
    with pytest.raises(
        InputError, match=rf"run\.csv:{row + 3}: x, y: a jump, .* m off the path .*; expected 20 m at most"
    ):
        read_track(file("t,x,y,theta\ns,m,m,rad", *columns), smoothing=0.3)


# --- faults -----------------------------------------------------------------------------------------------------------

HEAD = "t,x,y,heading\ns,m,m,rad\n"


def rows(*, change=None, count=41, step=0.1):
    """A move of 1 m from rest to rest, as rows of text; change gets the columns and returns others."""
    time = np.arange(count) * step
    u = time / time[-1]
    columns = np.array([time, u**2 * (3 - 2 * u), 0 * u, 0 * u])
    columns = columns if change is None else change(columns)
    return HEAD + "".join(",".join(f"{v:.9g}" for v in row) + "\n" for row in columns.T)


def with_jump(columns):
    columns[1, 20:] += 20.0
    return columns


def with_knock(columns):
    columns[1, 20:] += 0.02
    return columns


def with_turn(columns):
    columns[3, 20:] += 3.0
    return columns


@pytest.mark.parametrize(("text", "words"), [
    (rows(change=with_jump), ":23: x, y: a jump, 200.4 m/s from row to row; expected 50 m/s at most"),
    (rows(change=lambda c: with_jump(c / [[10], [1], [1], [1]])), ":23: x, y: a jump, 2004 m/s from row to row"),
    (rows(change=with_turn, step=0.01), ":23: heading: a jump, 300 rad/s from row to row; expected 100 rad/s"),
    (rows(change=lambda c: c[:, 20:]), ":3: x, y: the track starts at 0.37"),
    (rows(change=lambda c: c[:, :20]), ":22: x, y: the track ends at 0.37"),
    (rows(change=lambda c: c[[0, 3, 2, 1], 10:]), ":3: heading: the track starts at 0.2"),
    (rows(change=lambda c: c[:, [0, 2, 1, *range(3, 41)]]), ":5: time:"),
    (rows(count=3), ": rows: 3 found; expected at least 4 below the units"),
    (rows(change=lambda c: c[:, :1]), ": rows: 1 found; expected at least 2 below the units"),
    (rows(change=lambda c: c * [[1], [0], [1], [1]]), ": rows: nothing moves"),
    (rows().replace("\n0.1,", "\nnan,"), ':4: time: "nan" is not a finite number'),
    (rows().replace("\n0.1,", "\n0.1,1,"), ":4: row:"),
    ("t,x,y\ns,m,m\n0,0,0\n", ':1: header: "t,x,y"; expected t,x,y,heading of a timed track, or x,y of waypoints'),
    ("t,x,y,heading,theta\n", ':1: header: "t,x,y,heading,theta"; expected'),
    ("x,y,x\n", ':1: header: "x,y,x"; expected'),
    ("", ":1: header: nothing; expected t,x,y,heading"),
    (HEAD.replace("m,m", "m,kg"), ":2: y:"),
    ("x,y\nm\n", ':2: units: "m"; expected a unit per column, e.g. m,m'),
    ("x,y\nm,m\n0,0\n1,\n", ':4: y: "" is not a finite number'),
    ("x,y\nm,m\n0,0\n1,0,3\n", ":4: row:"),
    ("x,y\nm,m\n0,0\n", ": waypoints: 1 given and nothing moves"),
    ("x,y,pause\nm,m,s\n0,0,-1\n", ":3: waypoint: pause must be 0 or more"),
])  # fmt: skip
def test_a_fault_is_one_line(file, text, words):
    path = file(text)
    assert refusal(lambda: read_track(path, None if "t," in text[:20] else LIMITS)).startswith(f"{path}{words}")


def test_limits_tell_jumps_that_a_wheel_could_make(file):
    path = file(rows(change=with_knock))
    read_track(path)
    with pytest.raises(InputError, match=r":22: x, y: a jump, 2\.\d+ m/s\^2 from row to row; expected 1\.6 m/s\^2 at"):
        read_track(path, LIMITS)
    with pytest.raises(InputError, match=r"waypoints have no times; expected limits to plan with, or a column t"):
        read_track(file("x,y\nm,m\n0,0\n1,0\n"))


def test_a_start_as_any_ramp_makes_it_is_rest(file):
    """Even acceleration, or one that grows from 0: none is mistaken for a track that is cut off."""
    for power in (2, 3, 4):
        for count in (6, 60, 600):
            u = np.linspace(0.0, 1.0, count)
            half = u**power
            way = np.concatenate([half, 2.0 - half[-2::-1]])
            time = np.linspace(0.0, 8.0, len(way))
            flat = np.zeros_like(time)
            read_track(file("t,x,y,heading\ns,m,m,rad", time, way, flat, flat))
            read_track(file("t,x,y,heading\ns,m,m,rad", time, flat, flat, math.pi * way / 4))
