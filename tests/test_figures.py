"""Figures: the same bytes each time, units on the axes, no peak lost in the thinning."""

import re
from dataclasses import replace
from math import nan
from xml.etree import ElementTree

import numpy as np
import pytest

from drivesizer.report import figures
from drivesizer.report.operating import operating_field
from drivesizer.report.panels import Window, thinned, windows
from drivesizer.results import Check, Figure, Gains, SizingResult, Validation
from drivesizer.sizing import size
from drivesizer.spec import RobotSpec

UNITS = {
    "time": ("time", "s"),
    "speed_reference": ("speed", "m/s"),
    "speed": ("speed", "m/s"),
    "error": ("speed", "m/s"),
    "motor_speed": ("rotary_speed", "rpm"),
    "current": ("current", "A"),
    "voltage": ("voltage", "V"),
    "motor_torque": ("torque", "mN*m"),
    "gearhead_torque": ("torque", "N*m"),
    "supply_power": ("power", "W"),
}


def synthetic_validation(result: SizingResult, *, step: float = 0.02) -> Validation:
    """A made-up closed loop with the shape of a real one: the speed lags its reference."""
    motion, drive_set = result.spec.motion, (result.sets or result.misses)[0]
    end = 2 * motion.acceleration_time + motion.cruise_time
    time = np.arange(0.0, end + step, step)
    rise, fall = time / motion.acceleration_time, (end - time) / motion.acceleration_time
    reference = motion.speed * np.clip(np.minimum(rise, fall), 0.0, 1.0)
    speed = np.interp(time - 0.05, time, reference)
    slope = np.gradient(speed, time)
    current = 0.4 + 1.5 * slope
    columns = (time, reference, speed, reference - speed, 393.7 * speed, current, 9.2 * speed + 2.3 * current,
               0.0234 * current, 0.5 * current, 9.2 * speed * current)  # fmt: skip
    check = Check(
        name="current", title="Motor current", method="closed loop", case="trapezoid", demand=1.93, limit=5.0,
        kind="current", unit="A", margin=1.59, status="pass", at_time=1.98,
    )  # fmt: skip
    heat = replace(check, name="winding", title="Winding temperature", kind="temperature", unit="degC", demand=330.0,
                   limit=nan, margin=nan, status="unknown", at_time=None, note="no limit in the catalogue")  # fmt: skip
    return Validation(
        spec=result.spec,
        drive_set=drive_set,
        profile="trapezoid",
        status="pass",
        checks=(check, heat),
        figures=(
            Figure(name="largest_error", title="Largest error", value=0.0375, kind="speed", unit="m/s", at_time=1.9),
            Figure(name="bandwidth", title="Bandwidth", value=12.5, kind="frequency", unit="Hz"),
        ),
        gains=Gains(
            kp=0.05, ki=0.4, kd=0.0, filter_time=0.001, period=0.0004, rule="magnitude optimum", source="Kessler 1955"
        ),
        series=dict(zip(UNITS, columns, strict=True)),
        series_units=dict(UNITS),
        assumptions=("the belt is stiff",),
        warnings=("heat is unknown",),
    )


@pytest.fixture(scope="module")
def result(spec: RobotSpec) -> SizingResult:
    return size(spec)


def drawn(result: SizingResult) -> dict[str, bytes]:
    return {
        "profile": figures.velocity_profile(result.spec.motion),
        "field": figures.torque_speed(operating_field(result.sets[0], result.requirements)),
        "loop": figures.closed_loop(synthetic_validation(result)),
    }


def test_every_figure_is_a_vector_drawing_with_the_same_bytes_each_time(result):
    first, second = drawn(result), drawn(result)
    for name, svg in first.items():
        assert ElementTree.fromstring(svg).tag == "{http://www.w3.org/2000/svg}svg", name
        assert svg == second[name], name
        assert b"<image" not in svg, name
        assert b"<dc:date>" not in svg, name


def test_every_axis_names_its_unit(result):
    # Letters are outlines, so the file carries no text: matplotlib keeps each label as a comment beside them.
    said = {name: re.findall(r"<!-- (.*?) -->", svg.decode()) for name, svg in drawn(result).items()}
    assert {"time (s), phases not to scale", "velocity (m/s)"} <= set(said["profile"])
    assert {"torque at the motor shaft (mN·m)", "motor speed (rpm)"} <= set(said["field"])
    assert {"speed (m/s)", "error (m/s)", "current (A)", "voltage (V)", "time (s)"} <= set(said["loop"])


def test_figures_do_not_follow_the_users_matplotlib(result):
    import matplotlib

    plain = figures.velocity_profile(result.spec.motion)
    with matplotlib.rc_context({"lines.linewidth": 9.0, "font.size": 30.0}):
        assert figures.velocity_profile(result.spec.motion) == plain
        assert matplotlib.rcParams["font.size"] == 30.0  # and leave it as it was


def test_operating_points_agree_with_the_requirements_of_the_set(result):
    field = operating_field(result.sets[0], result.requirements)
    of = {r.name: r.value for r in result.sets[0].requirements}
    points = {p.name: p for p in field.points}
    assert points["end of acceleration"].torque == pytest.approx(of["maximum_torque_at_motor"], rel=1e-12)
    assert points["RMS of the cycle"].torque == pytest.approx(of["rms_torque_at_motor"], rel=1e-12)
    # EQUATIONS.md: through the pulleys 27:1 needs 6169 rpm at the motor
    assert points["cruise"].speed * 60 / (2 * np.pi) == pytest.approx(6169, abs=0.5)
    assert points["start of deceleration"].torque < 0


def test_a_long_cruise_is_left_out_and_a_short_one_is_not():
    time = np.arange(0.0, 100.0, 0.1)
    long = np.clip(np.minimum(time / 2.0, (99.9 - time) / 2.0), 0, 1)
    first, last = windows({"time": time, "speed_reference": long})
    assert first.start == 0.0 and 2.0 < first.end < 4.0
    assert 95.0 < last.start < 97.9 and last.end == pytest.approx(99.9)
    short = np.clip(np.minimum(time / 40.0, (99.9 - time) / 40.0), 0, 1)
    assert [w.title for w in windows({"time": time, "speed_reference": short})] == ["whole cycle"]
    assert len(windows({"time": time, "speed_reference": np.ones_like(time)})) == 1


def test_thinning_keeps_the_highest_and_the_lowest_sample():
    time = np.linspace(0.0, 1.0, 200_001)
    values = np.sin(40.0 * time)
    values[123_457], values[77_777] = 9.0, -9.0
    rows = thinned(time, values, Window("", 0.0, 1.0))
    assert len(rows) < 2000
    assert {123_457, 77_777, 0, 200_000} <= set(rows.tolist())
    assert np.all(np.diff(rows) > 0)


def test_a_quiet_stretch_without_samples_is_still_drawn_to_the_edge():
    time = np.array([0.0, 1.0, 2.0, 90.0, 91.0])
    rows = thinned(time, np.ones(5), Window("", 0.0, 3.0))
    assert rows.tolist() == [0, 1, 2, 3]
