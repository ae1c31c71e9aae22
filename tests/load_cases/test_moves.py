"""Moves by laws of motion, held against the coefficients of VDI 2143 and against their own closed form; cam tables."""

import math

import numpy as np
import pytest
from refusals import refusal

from drivesizer.errors import InputError
from drivesizer.load_cases import load_cycle, profile_of
from drivesizer.load_cases.of_machine import starts_farther_on
from drivesizer.loads.course import course
from drivesizer.loads.motions import LAWS
from drivesizer.physics.load_cycle import rms
from drivesizer.spec.robot import load_spec

DISTANCE, TIME = 0.3, 0.5
SMOOTH = ("poly5", "cycloidal", "modified_sine", "modified_trapezoid")  # without a jump of acceleration


def spec_of(motion, load=None, file=""):
    load = load or {"kind": "rack_pinion", "mass": "3 kg", "pinion_diameter": "40 mm"}
    return load_spec({"name": "axis", "load": load, "motion": motion, "supply": {"nominal": "48 V"}})


def moved(law, **more):
    return course(profile_of(spec_of({"profile": "move", "distance": "300 mm", "time": "0.5 s", "law": law} | more)))


@pytest.mark.parametrize(
    ("law", "speed", "acceleration", "rms_acceleration"),
    [  # C_v and C_a as VDI 2143-1 has them, with their digits; the RMS integrals by hand
        ("triangle", 2.0, 4.0, 4.0),
        ("trapezoid", 1.5, 4.5, math.sqrt(13.5)),
        ("parabola", 1.5, 6.0, math.sqrt(12.0)),
        ("sine", math.pi / 2, math.pi**2 / 2, math.pi**2 / math.sqrt(8.0)),
        ("poly5", 1.875, 5.7735, math.sqrt(120.0 / 7.0)),
        ("cycloidal", 2.0, 6.2832, 2 * math.pi / math.sqrt(2.0)),
        ("modified_sine", 1.7596, 5.5280, 4 * math.pi**2 / (4 + math.pi) / math.sqrt(2.0)),
        ("modified_trapezoid", 2.0, 4.8881, 8 * math.pi / (2 + math.pi) * math.sqrt(0.75)),
    ],
)
def test_coefficients(law, speed, acceleration, rms_acceleration):
    found = moved(law)
    assert found.position[-1, 1] == pytest.approx(DISTANCE, rel=6.2e-5)
    assert np.abs(found.speed).max() * TIME / DISTANCE == pytest.approx(speed, abs=5e-5)
    assert np.abs(found.acceleration).max() * TIME**2 / DISTANCE == pytest.approx(acceleration, abs=5e-5)
    assert rms(found.duration, found.acceleration) * TIME**2 / DISTANCE == pytest.approx(rms_acceleration, rel=6e-4)


def test_least_of_all():
    """Of all laws the triangle takes the least peak acceleration, and the parabola the least RMS."""
    laws = ("triangle", "trapezoid", *LAWS)
    found = {law: moved(law) for law in laws}
    assert min(laws, key=lambda law: np.abs(found[law].acceleration).max()) == "triangle"
    assert min(laws, key=lambda law: rms(found[law].duration, found[law].acceleration)) == "parabola"


@pytest.mark.parametrize("law", LAWS)
def test_acceleration_is_the_slope_of_speed_and_speed_that_of_position(law):
    """By finite differences of the transfer function itself, at shares that are no breakpoints."""
    step = 1e-5
    for x in np.linspace(0.013, 0.987, 41):
        speed, acceleration = LAWS[law].at(x)
        (before, _), (after, _) = (LAWS[law].at(x + side * step) for side in (-1, 1))
        assert (after - before) / (2 * step) == pytest.approx(acceleration, abs=2e-3)
        assert speed == pytest.approx(LAWS[law].at(1 - x)[0], abs=1e-12)  # alike from both ends
    ends = [LAWS[law].at(x)[1] for x in (0.0, 1.0)]
    assert np.allclose(ends, 0.0, atol=1e-12) == (law in SMOOTH)


def test_there_and_back_with_rests():
    found = moved("poly5", rest_time="0.2 s", there_and_back=True)
    assert found.duration.sum() == pytest.approx(2 * (TIME + 0.2))
    assert abs(found.position[-1, 1]) < 1e-12
    resting = (found.speed == 0).all(axis=1)
    assert found.duration[resting].sum() == pytest.approx(0.4)
    assert not found.acceleration[resting].any()


def test_the_jump_of_a_parabola_is_in_the_torque():
    """At the start m C_a s / T² at once, and none before."""
    cycle = load_cycle(spec_of({"profile": "move", "distance": "300 mm", "time": "0.5 s", "law": "parabola",
                                "rest_time": "0.1 s"}))  # fmt: skip
    assert cycle.torque[0, 0] == pytest.approx(3 * 6 * DISTANCE / TIME**2 * 0.02)
    assert cycle.torque[-2, 1] == pytest.approx(-3 * 6 * DISTANCE / TIME**2 * 0.02)
    assert not cycle.torque[-1].any()


def test_trapezoid_by_distance_and_times():
    found = profile_of(spec_of({"profile": "move", "distance": "300 mm", "time": "0.5 s", "acceleration_time": "0.1 s",
                                "deceleration_time": "0.2 s"}))  # fmt: skip
    assert found.time == pytest.approx((0.0, 0.1, 0.3, 0.5))
    assert found.speed == pytest.approx((0.0, 0.3 / 0.35, 0.3 / 0.35, 0.0))
    filled = profile_of(spec_of({"profile": "move", "distance": "300 mm", "time": "0.3 s", "acceleration_time": "0.1 s",
                                 "deceleration_time": "0.2 s"}))  # fmt: skip
    assert len(filled.time) == 3
    assert filled.distance == pytest.approx(0.3)


def test_an_axis_that_turns():
    found = profile_of(spec_of({"profile": "move", "distance": "90 deg", "time": "1 s", "law": "cycloidal"},
                               {"kind": "flywheel", "inertia": "1 kg*cm^2"}))  # fmt: skip
    assert found.top_speed == pytest.approx(math.pi)


@pytest.mark.parametrize(
    ("motion", "line"),
    [
        ({"law": "poly6"}, r"motion.law: \"poly6\" is not known; the nearest is poly5; expected 'trapezoid'"),
        ({"law": "poly5", "acceleration_time": "0.1 s"}, "motion: .*with law: trapezoid only"),
        ({"acceleration_time": "0.3 s"}, "motion: .*of no more than time together"),
        ({"distance": "0 mm"}, "motion.distance: .*must be above 0"),
    ],
)
def test_refused_in_one_line(motion, line):
    refusal(lambda: spec_of({"profile": "move", "distance": "300 mm", "time": "0.5 s"} | motion), match=line)


# --- cam tables -------------------------------------------------------------------------------------------------------


def table(path, angles, positions, units="deg,mm"):
    rows = "\n".join(f"{a!r},{s!r}" for a, s in zip(angles, positions, strict=True))
    path.write_text(f"angle,position\n{units}\n{rows}\n", encoding="utf-8")
    return {"profile": "cam", "file": str(path), "master_speed": "120 rpm"}


def test_a_cam_of_a_sine(tmp_path):
    """Position A (1 - cos φ): speed A Ω sin φ, of the same slope at both ends; off by h²/6 of three points."""
    angles = np.linspace(0.0, 360.0, 361)
    motion = table(tmp_path / "cam.csv", angles.tolist(), (20.0 * (1 - np.cos(np.radians(angles)))).tolist())
    found, turn = profile_of(spec_of(motion)), 4 * math.pi
    assert found.duration == pytest.approx(0.5)
    assert np.array(found.speed) == pytest.approx(0.02 * turn * np.sin(np.radians(angles)), abs=6e-5 * 0.02 * turn)
    assert found.speed[0] == pytest.approx(found.speed[-1], abs=1e-12)
    assert not starts_farther_on("", spec_of(motion))


def test_a_dwell_of_a_cam_stands_still(tmp_path):
    angles = [0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0, 360.0]
    found = profile_of(spec_of(table(tmp_path / "cam.csv", angles, [0.0, 0.0, 0.0, 4.0, 8.0, 8.0, 8.0, 4.0, 0.0])))
    assert found.speed[1] == 0.0
    assert found.speed[5] == 0.0
    assert found.speed[3] == pytest.approx(8.0e-3 / (90 / 360 * 0.5))


@pytest.mark.parametrize(
    ("rows", "line"),
    [
        ("angle,position\ndeg,mm\n0,0\n10,1\n10,2\n20,3\n", r"cam.csv:5: angle: \"10\" is not after the row before"),
        ("angle,position\ndeg,mm\n0,0\n10,1\n20,2\n", "cam.csv: rows: 3 found; expected at least 4"),
        ("angle,speed\ndeg,mm\n0,0\n10,1\n20,2\n", "cam.csv:1: header: .*expected angle,position"),
        ("angle,position\ns,mm\n0,0\n10,1\n20,2\n", "cam.csv:2: angle: .*unit of time, not of angle"),
    ],
)
def test_tables_that_are_none(rows, line, tmp_path):
    (tmp_path / "cam.csv").write_text(rows, encoding="utf-8")
    motion = {"profile": "cam", "file": str(tmp_path / "cam.csv"), "master_speed": "120 rpm"}
    refusal(lambda: profile_of(spec_of(motion)), match=line)


def test_a_smoothing_longer_than_the_table_is_refused(tmp_path):
    motion = table(tmp_path / "cam.csv", [0.0, 90.0, 180.0, 270.0, 360.0], [0.0, 1.0, 2.0, 1.0, 0.0])
    with pytest.raises(InputError, match=r"motion\.smoothing: 2 s is longer than the table of 0.5 s"):
        profile_of(spec_of(motion | {"smoothing": "2 s"}))
