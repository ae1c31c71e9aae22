"""Speed profiles: every motion that a spec may ask for, and recorded files, which are read strictly.

The s-curve is held against the closed form of the seven-phase profile (Biagiotti, Melchiorri, Trajectory Planning for
Automatic Machines and Robots, 2008, section 3.4), written out by hand for each case.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from pydantic import ValidationError
from refusals import refusal
from rows import hold

from drivesizer.errors import FieldError, InputError
from drivesizer.load_cases import profile, profile_of
from drivesizer.loads.course import course
from drivesizer.loads.motions import (
    Harmonic,
    SCurve,
    Segments,
    Trapezoid,
    Triangle,
    from_csv,
    harmonic,
    move,
    s_curve,
    segments,
    trapezoid,
)
from drivesizer.spec.robot import load_spec


def motion(**figures):
    return Trapezoid(**({"speed": "1.5 m/s", "acceleration_time": "2 s", "cruise_time": "3 s"} | figures))


def test_trapezoid_covers_speed_times_acceleration_and_cruise():
    found = trapezoid(motion(rest_time="4 s"))
    assert found.time == (0.0, 2.0, 5.0, 7.0, 11.0)
    assert found.speed == (0.0, 1.5, 1.5, 0.0, 0.0)
    assert found.distance == pytest.approx(1.5 * (2.0 + 3.0))
    assert found.top_speed == 1.5


def test_acceleration_lost_beside_the_cruise_is_refused():
    with pytest.raises(FieldError) as caught:
        trapezoid(motion(acceleration_time="0.002 us", cruise_time="1e9 s"))
    assert caught.value.field == ("motion", "acceleration_time")


def test_deceleration_has_a_time_of_its_own():
    found = trapezoid(motion(deceleration_time="1 s"))
    assert found.time == (0.0, 2.0, 5.0, 6.0)
    assert found.distance == pytest.approx(1.5 * (1.0 + 3.0 + 0.5), rel=1e-12)


@pytest.mark.parametrize(
    ("distance", "times", "top"),
    [("3 m", (0.0, 0.75, 2.0, 2.75), 1.5), ("0.5 m", (0.0, 0.5, 1.0), 1.0)],  # t = v/a and s/v; short of it t² = s/a
)
def test_a_trapezoid_by_distance_is_as_fast_as_its_limits_allow(distance, times, top):
    found = trapezoid(Trapezoid(distance=distance, speed="1.5 m/s", acceleration="2 m/s^2"))
    assert found.time == pytest.approx(times, rel=1e-12)
    assert max(found.speed) == pytest.approx(top, rel=1e-12)
    assert found.distance == pytest.approx(float(distance.split()[0]), rel=1e-12)


@pytest.mark.parametrize(
    ("given", "times", "top"),
    [
        ({"acceleration": "2 m/s^2", "cruise_time": "3 s"}, (0.0, 0.75, 3.75, 4.5), 1.5),  # t = v/a
        ({"acceleration_time": "1 s", "distance": "3 m"}, (0.0, 1.0, 2.0, 3.0), 1.5),  # s/v - t
        ({"acceleration_time": "1 s", "distance": "0.375 m"}, (0.0, 0.5, 1.0), 0.75),  # t² = s/a with a = v/t
        # ramps of 1.5 and 3 m/s²: v² = 2 s/(1/1.5 + 1/3), so that 0.5 m are done in t = 2 s/v
        ({"acceleration_time": "1 s", "deceleration_time": "0.5 s", "distance": "0.5 m"}, (0.0, 2 / 3, 1.0), 1.0),
    ],
)
def test_a_trapezoid_by_time_or_acceleration_and_by_time_or_distance(given, times, top):
    found = trapezoid(Trapezoid.model_validate(given | {"speed": "1.5 m/s"}))
    assert found.time == pytest.approx(times, rel=1e-12)
    assert max(found.speed) == pytest.approx(top, rel=1e-12)


def test_each_way_has_its_rest():
    found = trapezoid(motion(deceleration_time="1 s", rest_time="4 s", there_and_back=True))
    assert found.time == (0.0, 2.0, 5.0, 6.0, 10.0, 12.0, 15.0, 16.0, 20.0)
    assert found.speed == (0.0, 1.5, 1.5, 0.0, 0.0, -1.5, -1.5, 0.0, 0.0)
    assert found.distance == 0.0


def test_triangle_covers_its_distance_at_twice_the_mean_speed():
    found = move(Triangle(profile="triangle", distance="90 cm", time="1.2 s", rest_time="300 ms"))
    assert found.time == pytest.approx((0.0, 0.6, 1.2, 1.5))
    assert found.top_speed == pytest.approx(2 * 0.9 / 1.2)
    assert found.distance == pytest.approx(0.9, rel=1e-12)


def pieces(*legs):
    """Segments of time and speed; None keeps the speed."""
    listed = [{"time": time} | ({} if to is None else {"to": to}) for time, to in legs]
    return Segments(profile="segments", segments=listed)


def test_segments_remain_as_they_are_listed():
    found = segments(pieces(("1 s", None), ("2 s", "3 m/s"), ("1 s", None), ("4 s", "-1 m/s"), ("1 s", "0 m/s")))
    assert found.time == (0.0, 1.0, 3.0, 4.0, 8.0, 9.0)
    assert found.speed == (0.0, 0.0, 3.0, 3.0, -1.0, 0.0)
    assert found.distance == pytest.approx(3.0 + 3.0 + 4.0 - 0.5)


AT_THE_DOOR = {  # no figures of a machine: refused by the field itself
    "steep": (lambda: trapezoid(motion(speed="1e300 m/s", acceleration_time="1e-20 s")), "acceleration_time: 1e-20 s"),
    "far": (lambda: trapezoid(motion(speed="1e300 m/s", cruise_time="1e100 s")), "cruise_time: 1e+100 s"),
    "fast": (lambda: move(Triangle(profile="triangle", distance="1e300 m", time="1e-20 s")), "time: 5e-21 s"),
    "slow": (lambda: move(Triangle(profile="triangle", distance="1e-300 m", time="1e100 s")), "time: the speed"),
    "sine": (lambda: harmonic(Harmonic(profile="harmonic", amplitude="1 m", period="1e-200 s")), "period: "),
    "no jerk phase": (lambda: s_curve(asked(1.0, 1e-3, 1e3, 1e30)), "jerk: a part of the motion is too short"),
    "limits": (lambda: s_curve(asked(1.0, 1e200, 1e-200, 1e-200)), "jerk: "),
    "jerk": (lambda: s_curve(asked(1e-300, 1e300, 1e300, 1e300)), "jerk: "),
    "nothing": (lambda: s_curve(asked(1e-200, 1e-200, 1e200, 1e200)), "jerk: "),
}


@pytest.mark.parametrize(("made", "message"), AT_THE_DOOR.values(), ids=AT_THE_DOOR)
def test_figures_of_no_machine_are_refused_by_their_field(made, message):
    with pytest.raises(ValidationError, match=f"{message.partition(':')[0]}(.|\\n)*of a machine"):
        made()


def asked(distance, speed, acceleration, jerk, **more):
    figures = {"distance": distance, "speed": speed, "acceleration": acceleration, "jerk": jerk}
    units = {"distance": "m", "speed": "m/s", "acceleration": "m/s^2", "jerk": "m/s^3"}
    return SCurve(profile="s_curve", **{name: f"{value!r} {units[name]}" for name, value in figures.items()}, **more)


def seven_phases(D, v, a, j):
    """Times of a jerk phase, at the greatest acceleration, at the greatest speed, by the textbook."""
    T_j, hold = (a / j, v / a - a / j) if v * j >= a * a else (math.sqrt(v / j), 0.0)
    cruise = D / v - 2 * T_j - hold
    if cruise >= 0.0:
        return T_j, hold, cruise
    hold = (math.sqrt((a / j) ** 2 + 4 * D / a) - 3 * a / j) / 2  # D = a (T_j + hold) (2 T_j + hold)
    return (a / j, hold, 0.0) if hold >= 0.0 else (math.cbrt(D / (2 * j)), 0.0, 0.0)


CURVES = {  # duration, greatest speed, greatest acceleration
    "all limits": ((2.0, 1.0, 2.0, 10.0), (2 + 1 / 2 + 2 / 10, 1.0, 2.0)),
    "no cruise": (
        (0.3, 5.0, 2.0, 10.0),
        (0.2 + math.sqrt(0.2**2 + 4 * 0.3 / 2), 2 * (math.sqrt(0.2**2 + 0.6) - 0.2) / 2, 2.0),
    ),
    "no hold": ((2.0, 1.0, 7.0, 10.0), (2 + 2 * math.sqrt(0.1), 1.0, math.sqrt(10.0))),
    "jerk only": ((0.01, 1.0, 7.0, 10.0), (4 * 5e-4 ** (1 / 3), 10 * 5e-4 ** (2 / 3), 10 * 5e-4 ** (1 / 3))),
}


@pytest.mark.parametrize(("limits", "expected"), CURVES.values(), ids=CURVES)
def test_s_curve_is_as_fast_as_the_textbook(limits, expected):
    found = s_curve(asked(*limits))
    assert found.name == "s-curve"
    assert (found.duration, found.top_speed, max(found.acceleration)) == pytest.approx(expected, rel=1e-12)
    assert found.distance == pytest.approx(limits[0], rel=1e-12)


def test_s_curve_keeps_every_limit():
    hold(keeps_every_limit, {f"seed {seed}": (seed,) for seed in range(200)})


def keeps_every_limit(seed):
    limits = [float(10**x) for x in np.random.default_rng(seed).uniform(-4, 4, 4)]
    D, v, a, _ = limits
    T_j, hold, cruise = seven_phases(*limits)
    if T_j < 1e-12 * cruise:
        return  # jerk phases too short to be told apart
    found = s_curve(asked(*limits))
    time, speed, slope = (np.array(x) for x in (found.time, found.speed, found.acceleration))
    assert found.duration == pytest.approx(4 * T_j + 2 * hold + cruise, rel=1e-12)
    assert found.distance == pytest.approx(D, rel=1e-12)
    assert speed.max() <= v * (1 + 1e-12)
    assert np.abs(slope).max() <= a * (1 + 1e-12)
    assert speed[0] == speed[-1] == slope[0] == slope[-1] == 0.0
    ends = np.cumsum([T_j, hold, T_j, cruise, T_j, hold, T_j])
    assert np.abs(time[:, None] - ends).min(axis=0).max() <= 1e-12 * found.duration  # a breakpoint at each
    # with straight lines for the acceleration the speed at the breakpoints is exact
    rise = np.cumsum(np.diff(time) * (slope[1:] + slope[:-1]) / 2)
    rounding = len(time) * 1e-15 * found.duration * slope.max()  # of the times, which count from the start
    assert rise == pytest.approx(speed[1:], rel=1e-12, abs=rounding)


def test_jerk_is_constant_in_each_phase():
    found = s_curve(asked(2.0, 1.0, 2.0, 10.0))
    jerk = np.diff(found.acceleration) / np.diff(found.time)
    for value, phases in ((10.0, 2), (-10.0, 2), (0.0, 3)):
        assert np.isclose(jerk, value, atol=1e-9).sum() == phases * (32 if value else 1)


def test_straight_lines_keep_to_the_curve_as_said():
    found = s_curve(asked(2.0, 1.0, 2.0, 10.0))
    h = 0.2 / 32
    middle = np.interp(10.5 * h, found.time, found.speed)
    assert middle - 10.0 * (10.5 * h) ** 2 / 2 == pytest.approx(10.0 * h**2 / 8, rel=1e-9)


def test_s_curve_rests_and_comes_back():
    there, both = s_curve(asked(2.0, 1.0, 2.0, 10.0)), s_curve(
        asked(2.0, 1.0, 2.0, 10.0, rest_time="0.4 s", there_and_back=True)
    )  # fmt: skip
    n = len(there.time)
    assert both.duration == pytest.approx(2 * (there.duration + 0.4))
    assert both.time[: n + 1] == pytest.approx((*there.time, there.duration + 0.4))
    assert np.array(both.speed[n + 1 :]) == pytest.approx(-np.array((*there.speed[1:], 0.0)))
    assert np.array(both.acceleration[n + 1 :]) == pytest.approx(-np.array((*there.acceleration[1:], 0.0)))
    assert abs(both.distance) < 1e-12
    moved = course(both)
    assert moved.position[moved.speed[:, 1] == 0.0, 1][0] == pytest.approx(2.0, rel=1e-12)


def test_trapezoid_with_rounded_ramps(robot):
    spec = robot(
        motion={"speed": "1.5 m/s", "acceleration_time": "2 s", "deceleration_time": "1 s", "cruise_time": "3 s"}
    )
    straight, found = profile(spec, "trapezoid"), profile(spec, "s-curve")
    assert found.distance == pytest.approx(straight.distance, rel=1e-12)
    assert (found.duration, found.top_speed) == pytest.approx((straight.duration, 1.5), rel=1e-12)
    assert (max(found.acceleration), min(found.acceleration)) == pytest.approx((2 * 1.5 / 2, -2 * 1.5 / 1), rel=1e-12)
    jerk = np.diff(found.acceleration) / np.diff(found.time)
    assert (jerk.max(), jerk.min()) == pytest.approx((4 * 1.5 / 1, -4 * 1.5 / 1), rel=1e-9)
    assert jerk[0] == pytest.approx(4 * 1.5 / 2**2, rel=1e-9)


def test_harmonic_meets_its_peaks_and_comes_back():
    A, T = 0.07, 0.6
    found = harmonic(Harmonic(profile="harmonic", amplitude="70 mm", period="600 ms"))
    time, speed, slope = (np.array(x) for x in (found.time, found.speed, found.acceleration))
    w = 2 * math.pi / T
    assert len(time) == 257
    assert found.duration == pytest.approx(T)
    assert speed == pytest.approx(A * w * np.sin(w * time), abs=1e-12)
    assert slope == pytest.approx(A * w**2 * np.cos(w * time), abs=1e-10)
    assert found.top_speed == A * w
    assert slope.max() == -slope.min() == A * w * w
    assert speed[0] == speed[128] == speed[256] == 0.0
    assert abs(found.distance) < 1e-15
    position = course(found).position[:, 1]
    assert position.max() == pytest.approx(2 * A, rel=6e-5)


def write(tmp_path, text):
    path = tmp_path / "run.csv"
    path.write_bytes(text.encode("utf-8") if isinstance(text, str) else text)
    return path


def test_units_of_the_file_are_converted(tmp_path):
    found = from_csv(write(tmp_path, "\ufefftime,speed\r\nms,km/h\r\n0,0\r\n1500,-3.6\r\n2.5e3,7.2\r\n\r\n"))
    assert found.time == pytest.approx((0.0, 1.5, 2.5))
    assert found.speed == pytest.approx((0.0, -1.0, 2.0))
    assert found.distance == pytest.approx(1.5 * -0.5 + 1.0 * 0.5)


HEAD = "time,speed\ns,m/s\n"

WRONG = {
    "empty": ("", ":1: header: nothing; expected time,speed"),
    "header": ("a,b\ns,m/s\n0,0\n1,1\n", ':1: header: "a,b"; expected time,speed'),
    "no units": ("time,speed\n", ":2: units: "),
    "numbers for units": ("time,speed\n0,0\n1,1\n", ":2: time: "),
    "unit of another kind": ("time,speed\ns,rpm\n0,0\n1,1\n", ':2: speed: "rpm" is a unit of rotary speed'),
    "one row": (HEAD + "0,0\n", ": rows: 1 found; expected at least 2"),
    "order": (HEAD + "0,0\n2,1\n1,1\n", ':5: time: "1" is not after the row before'),
    "twice": (HEAD + "0,0\n0,1\n", ':4: time: "0" is not after the row before'),
    "nan": (HEAD + "0,0\n1,nan\n", ':4: speed: "nan" is not a finite number'),
    "inf": (HEAD + "0,0\ninf,1\n", ':4: time: "inf" is not a finite number'),
    "overflow": (HEAD + "0,0\n1,1e999\n", ':4: speed: "1e999" is not a finite number'),
    "underscore": (HEAD + "0,0\n1_0,1\n", ':4: time: "1_0" is not a finite number'),
    "missing cell": (HEAD + "0,0\n1\n", ':4: row: "1" has 1 of 2 columns'),
    "empty cell": (HEAD + "0,0\n1,\n", ':4: speed: "" is not a finite number'),
    "decimal comma": (HEAD + "0,0\n0,5,1,2\n", ':4: row: "0,5,1,2" has 4 columns; a decimal comma'),
    "semicolon": (HEAD + "0;0\n1;1\n", "a semicolon does not separate"),
    "gap": (HEAD + "0,0\n\n1,1\n", ":4: row: a blank line"),
    "quote": (HEAD + '0,0\n1,"1\n', "row: "),
    "text": (HEAD + "0,0\n1,fast\n", ':4: speed: "fast" is not a finite number'),
    "latin-1": (HEAD.encode() + b"0,0\n1,\xe9\n", ":4: speed: "),
}


@pytest.mark.parametrize(("text", "message"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_reported_in_a_line(tmp_path, text, message):
    line = refusal(lambda: from_csv(write(tmp_path, text)))
    assert message in line
    assert line.startswith(str(tmp_path / "run.csv"))


@pytest.fixture
def robot(tmp_path):
    """Makes a spec of a vehicle or a table, read from a file."""

    def made(*, motion, rotary=False):
        load = "kind: rotary_table, inertia: 2 kg*m^2" if rotary else (
            "kind: wheeled_vehicle, mass: 45 kg, driven_wheels: 4, wheel_diameter: 150 mm, "
            "rolling_resistance: 0.02, inertia: 1 kg*cm^2"
        )  # fmt: skip
        (tmp_path / "robot.yaml").write_text(
            f"name: test\nload: {{{load}}}\nmotion:\n"
            + "".join(f"  {name}: {value}\n" for name, value in motion.items())
            + "supply: {nominal: 24 V}\n"
        )
        return load_spec(tmp_path / "robot.yaml")

    return made


def test_a_load_that_turns_has_its_own_units(robot, tmp_path):
    spec = robot(motion={"profile": "triangle", "distance": "90 deg", "time": "2 s"}, rotary=True)
    assert profile_of(spec).top_speed == pytest.approx(math.pi / 2)
    path = write(tmp_path, "time,speed\ns,rpm\n0,0\n2,30\n3,0\n")
    assert profile(spec, str(path)).speed == pytest.approx((0.0, math.pi, 0.0))
    with pytest.raises(InputError, match=r"run\.csv:2: speed: .m/s. is a unit of speed, not of rotary speed"):
        profile(spec, str(write(tmp_path, HEAD + "0,0\n1,1\n")))


def test_name_or_file(spec, tmp_path):
    assert profile(spec, "trapezoid") == trapezoid(spec.motion)
    assert profile(spec, str(write(tmp_path, HEAD + "0,0\n1,1\n"))).speed == (0.0, 1.0)
    with pytest.raises(InputError, match='"zigzag" is not known; expected trapezoid, triangle, move, s-curve'):
        profile(spec, "zigzag")
    with pytest.raises(InputError, match=r'"harmonic": the spec.s motion is trapezoid; expected that or a file'):
        profile(spec, "harmonic")
