"""Recordings as loads: columns read strictly, speed from position by local parabolas, laws of the load cycle."""

from __future__ import annotations

import math

import numpy as np
import pytest
from refusals import refusal

from drivesizer.errors import InputError
from drivesizer.load_cases import load_cycle
from drivesizer.physics.cycle_at_gearhead import AT_REST, CycleAtBelt
from drivesizer.physics.load_cycle import integral, rms
from drivesizer.physics.motion_curves import local_parabola
from drivesizer.spec.robot import load_spec


@pytest.fixture
def shaft(tmp_path):
    """Makes the load cycle of a recording: header and units, columns, further fields of the load."""

    def made(head, *columns, **more):
        rows = "".join(",".join(repr(float(x)) for x in row) + "\n" for row in zip(*columns, strict=True))
        (tmp_path / "run.csv").write_text(f"{head}\n{rows}")
        return load_cycle(spec_of(tmp_path, **more))

    return made


def spec_of(tmp_path, **more):
    fields = "".join(f"  {name}: {value}\n" for name, value in more.items())
    (tmp_path / "robot.yaml").write_text(
        f"name: test\nload:\n  kind: recorded\n  file: run.csv\n{fields}supply: {{nominal: 24 V}}\n"
    )
    return load_spec(tmp_path / "robot.yaml")


SPEED = "time,speed,torque\ns,rad/s,N*m"
POSITION = "time,position,torque\ns,rad,N*m"
CORNERS = np.array([0.0, 1.0, 2.0, 3.0])


def uneven(end, rows, seed=3, *, always=()):
    """Times from 0 to an end, uneven by a factor of up to 19."""
    time = np.cumsum(np.random.default_rng(seed).uniform(0.1, 1.9, rows))
    return np.unique(np.concatenate([(time - time[0]) * end / (time[-1] - time[0]), always]))


def test_a_trapezoid_has_its_rms_however_it_was_sampled(shaft):
    time = uneven(3.0, 80, always=CORNERS)
    trapezoid = np.interp(time, CORNERS, [0.0, 1.0, 1.0, 0.0])
    cycle = shaft(SPEED, time, 10 * trapezoid, 3 * trapezoid)
    assert len(cycle.duration) == len(time) - 1  # nothing is sampled anew
    assert cycle.total == pytest.approx(3.0)
    assert rms(cycle.duration, cycle.torque) == pytest.approx(math.sqrt((9 / 3 + 9 + 9 / 3) / 3), rel=1e-12)
    assert integral(cycle.duration, cycle.torque, cycle.speed) == pytest.approx(30 / 3 + 30 + 30 / 3, rel=1e-12)
    assert cycle.acceleration.max() == pytest.approx(10.0, rel=1e-9)
    assert math.isnan(cycle.inertia)


def test_inertia_and_motors(shaft):
    time = uneven(3.0, 40, always=CORNERS)
    speed = np.interp(time, CORNERS, [0.0, 10.0, 10.0, 0.0])
    cycle = shaft(SPEED, time, speed, np.full_like(time, 3.0), inertia="0.2 kg*m^2", motors=2)
    early, late = (cycle.time < 1.0 - 1e-9).all(axis=1), (cycle.time > 2.0 + 1e-9).all(axis=1)
    assert cycle.torque[early] == pytest.approx((3.0 + 0.2 * 10.0) / 2, rel=1e-9)
    assert cycle.torque[late] == pytest.approx((3.0 - 0.2 * 10.0) / 2, rel=1e-9)
    assert cycle.inertia == pytest.approx(0.1)


def test_columns_in_any_order_and_units_of_the_trade(shaft):
    time, speed, torque = np.array([0.0, 400.0, 1000.0]), np.array([0.0, 3000.0, -1500.0]), np.array([0.0, 20.0, -5.0])
    cycle = shaft("torque,time,speed\nmN*m,ms,rpm", torque, time, speed)
    assert cycle.total == pytest.approx(1.0)
    assert cycle.speed.max() == pytest.approx(3000 * 2 * math.pi / 60)
    assert (cycle.torque.max(), cycle.torque.min()) == pytest.approx((0.02, -0.005))
    assert len(cycle.duration) == 4  # cut where speed and torque change sign
    assert (cycle.speed.prod(axis=1) >= 0.0).all()
    assert (cycle.torque.prod(axis=1) >= 0.0).all()


ROWS = [(0.0, 0.0, 1.25), (0.5, 5.0, 2.5), (1.5, 5.0, -0.75), (2.0, 0.0, 0.0)]
LOGS = {
    "german": ("Zeit [s];Drehzahl [rad/s];Drehmoment [Nm]", ";", ","),
    "names of the file's own order": ("torque [N*m],time [s],speed [rad/s]", ",", "."),
    "tabs": ("t [s]\tomega [rad/s]\ttau [N*m]", "\t", "."),
    "semicolons and a row of units": ("time;speed;torque\ns;rad/s;N*m", ";", ","),
    "milliseconds": ("time [ms];speed [rad/s];torque [mNm]", ";", "."),
    "lines above": ("Logger 4, channel 1\n\ntime (s),speed (rad/s),torque (N*m)", ",", "."),
    "names with units": ("time_s,speed_rad/s,torque_nm", ",", "."),
}


@pytest.mark.parametrize("name", LOGS)
@pytest.mark.parametrize("code", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_a_log_is_read_as_loggers_and_spreadsheets_write_it(tmp_path, shaft, name, code):
    expected = shaft(SPEED, *zip(*ROWS, strict=True))
    head, separator, sign = LOGS[name]
    thousand = 1000.0 if name == "milliseconds" else 1.0
    lines = [head]
    for time, speed, torque in ROWS:
        cells = [time * thousand, speed, torque * thousand]
        cells = [cells[2], cells[0], cells[1]] if head.startswith("torque") else cells
        lines.append(separator.join(f"{cell:.6f}".replace(".", sign) for cell in cells))
    (tmp_path / "run.csv").write_bytes("\n".join(lines).encode(code))
    found = load_cycle(spec_of(tmp_path))
    for one in ("duration", "speed", "torque"):
        np.testing.assert_allclose(getattr(found, one), getattr(expected, one), rtol=1e-12)


def test_columns_that_nobody_takes_are_named(tmp_path):
    rows = "\n".join(f"{t};{w};{m};{20 + t};x" for t, w, m in ROWS)
    (tmp_path / "run.csv").write_text(f"time [s];speed [rad/s];torque [N*m];temperature [degC];note\n{rows}\n")
    with pytest.warns(UserWarning, match=r"columns left out: temperature \[degC\], note"):
        assert load_cycle(spec_of(tmp_path)).total == pytest.approx(2.0)


def test_a_head_without_a_unit_is_refused_by_name(tmp_path):
    (tmp_path / "run.csv").write_text("time [s];speed [rad/s];torque\n0;0;1\n1;1;1\n")
    with pytest.raises(InputError, match=r"run.csv:1: torque: has no unit; expected e.g. torque \[N\*m\]"):
        load_cycle(spec_of(tmp_path))


@pytest.mark.parametrize("name", ["position", "angle"])
def test_a_parabola_is_met_exactly(shaft, name):
    time = uneven(2.0, 50)
    cycle = shaft(f"time,{name},torque\ns,deg,N*m", time, np.degrees(3.0 + 2 * time + 5 * time**2), time)
    assert cycle.speed[:, 1] == pytest.approx(2 + 10 * time[1:], rel=1e-9)
    assert cycle.acceleration == pytest.approx(np.full_like(cycle.acceleration, 10.0), rel=1e-6)


@pytest.mark.parametrize("window", [0.0, 0.1, 0.5, 5.0])
@pytest.mark.parametrize("sampled", [np.linspace(0.0, 5.0, 400), uneven(5.0, 400)], ids=["even", "uneven"])
def test_parabolas_are_met_in_any_window(sampled, window):
    value, slope = local_parabola(sampled, 7.0 - 2 * sampled + 3 * sampled**2, window)
    assert value == pytest.approx(7.0 - 2 * sampled + 3 * sampled**2, abs=1e-10)
    assert slope == pytest.approx(-2 + 6 * sampled, abs=1e-9)


@pytest.mark.parametrize("window", [0.02, 0.1, 0.8])
def test_windows_are_least_squares(window):
    """Against numpy's polyfit in each window, far from time 0 and value 0."""
    rng = np.random.default_rng(5)
    time = uneven(5.0, 700) + 30.0
    value = 1e3 + 4 * np.sin(3 * time) + rng.normal(0.0, 0.01, len(time))
    found = local_parabola(time, value, window)
    for i in rng.choice(len(time), 60):
        near = np.flatnonzero(np.abs(time - time[i]) <= window / 2)
        if len(near) < 4:
            near = np.clip(i, 1, len(time) - 2) + np.arange(-1, 2)
        fitted = np.polynomial.Polynomial.fit(time[near] - time[i], value[near], 2).convert().coef
        size = np.ptp(time[near])
        moments = np.linalg.cond(np.vander((time[near] - time[i]) / size, 3))
        if moments < 30.0:
            assert (found[0][i], found[1][i] * size) == pytest.approx((fitted[0], fitted[1] * size), abs=1e-8)


def test_two_bunches_of_samples_take_a_line():
    """Four samples in two bunches tell no bend: it would be made of noise."""
    time = np.array([0.0, 1e-9, 1.0, 1.0 + 1e-9, 2.0, 2.0 + 1e-9])
    noise = np.array([0.0, 1.0, -1.0, 1.0, 0.0, -1.0]) * 1e-3
    slope = local_parabola(time, time + noise, 2.2)[1]
    assert slope == pytest.approx(np.ones(6), abs=0.01)


A, W = 2.0, 3.0  # rad, rad/s


def sine(time):
    return A * np.sin(W * time)


def test_speed_and_acceleration_out_of_a_position(shaft):
    period = 2 * math.pi / W
    time = uneven(period, 2000)
    cycle = shaft(POSITION, time, sine(time), np.ones_like(time), smoothing="20 ms")
    middle = cycle.time.mean(axis=1)
    inside = (middle > 0.02) & (middle < period - 0.02)
    assert cycle.speed.mean(axis=1) == pytest.approx(A * W * np.cos(W * middle), abs=A * W**3 * 0.02**2)
    # uneven windows are lopsided by a sample: the acceleration is off by x''' W at most
    assert np.abs(cycle.acceleration[:, 0] + A * W**2 * np.sin(W * middle))[inside].max() < A * W**3 * 0.02
    assert integral(cycle.duration, cycle.speed, np.ones_like(cycle.speed)) == pytest.approx(0.0, abs=1e-3 * A)


SIGMA = 1e-4  # rad


@pytest.mark.parametrize("rate", [1000, 4000])
def test_noise_of_a_position_does_not_grow_with_the_rate(shaft, rate):
    window, time = 0.1, np.arange(8 * rate) / rate
    noise = np.random.default_rng(rate).normal(0.0, SIGMA, len(time))
    cycle = shaft(POSITION, time, 5 * time + noise, np.ones_like(time), smoothing="100 ms")
    inside = np.abs(cycle.time.mean(axis=1) - 4.0) < 3.9
    assert cycle.acceleration[inside].std() < 1.1 * 8.5 * SIGMA / window**2
    plain = np.diff(noise, 2) * rate**2  # what two differences of two samples would make of it
    assert plain.std() > 100 * cycle.acceleration[inside].std()


@pytest.mark.parametrize(("name", "window"), [("speed", 0.5), ("position", 0.05), ("position", 2.0)])
def test_rest_in_a_recording_remains_rest_when_it_is_smoothed(shaft, name, window):
    """Sums over windows leave 1e-12 rad/s: as a motion it would have a direction, friction and a gear's efficiency."""
    time = np.arange(0.0, 6.0, 0.002)
    place = 5.0 * np.where(time < 2.0, time / 2.0 - np.sin(math.pi * time) / (2.0 * math.pi), 1.0) + 1.234567
    column = np.where(time < 2.0, 2.5 * (1.0 - np.cos(math.pi * time)), 0.0) if name == "speed" else place
    held = np.full_like(time, 3.0)
    cycle = shaft(SPEED if name == "speed" else POSITION, time, column, held, smoothing=f"{window} s")
    stands = cycle.time[:, 0] > 2.0 + window / 2 + 0.002
    assert not cycle.speed[stands].any() and cycle.speed[~stands].any()
    at = CycleAtBelt(cycle, 0.8).behind(1.0)
    assert at.functions[stands][:, :, AT_REST] == pytest.approx(3.0)  # held, not driven through 80 %
    assert at.holding_torque == pytest.approx(0.8 * 3.0)  # of which a brake before the belt feels so much


def test_noise_through_three_points(shaft):
    time, h = np.arange(4000) / 1000, 1e-3
    noise = np.random.default_rng(1).normal(0.0, SIGMA, len(time))
    cycle = shaft(POSITION, time, 50 * time + noise, np.ones_like(time))
    whole = cycle.acceleration[1:-1]
    assert whole.std() == pytest.approx(SIGMA / h**2, rel=0.1)


def test_a_recorded_speed_is_smoothed_on_request(shaft):
    window, time = 0.2, np.arange(8000) / 1000
    noise = np.random.default_rng(2).normal(0.0, SIGMA, len(time))
    columns = (SPEED, time, 5.0 + np.sin(time) + noise, np.ones_like(time))
    plain, smooth = shaft(*columns), shaft(*columns, smoothing="200 ms")
    assert plain.speed[:, 1] == pytest.approx(columns[2][1:], rel=1e-15)
    middle = smooth.time.mean(axis=1)
    inside = np.abs(middle - 4.0) < 3.8
    error = smooth.acceleration[:, 0] - np.cos(middle)
    assert error[inside].std() < 1.2 * 2.1 * SIGMA / window
    assert (plain.acceleration[:, 0] - np.cos(middle)).std() > 50 * error[inside].std()
    assert smooth.torque == pytest.approx(np.ones_like(smooth.torque))  # as recorded


WRONG = {
    "no torque": ("time,speed\ns,rpm\n0,0\n1,1\n", 'run.csv:1: header: "time,speed"; expected time,speed,torque or'),
    "both": ("time,speed,position,torque\ns,rpm,deg,N*m\n", ":1: header: "),
    "twice": ("time,time,torque\ns,s,N*m\n", ":1: header: "),
    "unit": ("time,speed,torque\ns,m/s,N*m\n0,0,0\n", ':2: speed: "m/s" is a unit of speed, not of rotary speed'),
    "energy": ("time,speed,torque\ns,rpm,J\n0,0,0\n", ':2: torque: "J" is a unit of energy, not of torque'),
    "number": (SPEED + "\n0,0,0\n1,1,x\n", ':4: torque: "x" is not a finite number'),
    "underscore": (SPEED + "\n0,0,0\n1,1_0,1\n", ':4: speed: "1_0" is not a finite number'),
    "other digits": (SPEED + "\n0,0,0\n1,\u0661,1\n", ':4: speed: "\u0661" is not a finite number'),
    "beyond": ("time,speed,torque\nd,rpm,N*m\n0,0,0\n1e304,1,1\n", ':4: time: "1e304" is not a finite number'),
    "cells": (
        SPEED + "\n0,0,0\n1,1\n",
        ':4: row: "1,1" has 2 of 3 columns; expected time,speed,torque, e.g. 0.5,1.2,0.3',
    ),
    "back": ("speed,time,torque\nrpm,s,N*m\n0,1,0\n1,0.5,1\n", ':4: time: "0.5" is not after the row before'),
    "one row": (SPEED + "\n0,0,0\n", "run.csv: rows: 1 found; expected at least 2"),
    "two positions": (POSITION + "\n0,0,0\n1,1,0\n", "run.csv: rows: 2 found; expected at least 3"),
    "fast": (SPEED + "\n0,0,4\n1,1e300,4\n", ':4: speed: "1e+300" is no rotary speed of a machine'),
    "steep": (SPEED + "\n0,0,4\n1e-300,1,4\n", "load cycle run.csv: a figure leaves the range"),
}


@pytest.mark.parametrize(("text", "message"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_reported_in_a_line(tmp_path, text, message):
    (tmp_path / "run.csv").write_text(text, encoding="utf-8")
    assert message in refusal(lambda: load_cycle(spec_of(tmp_path)))


@pytest.mark.parametrize(("cell", "said"), [("", "the cell is empty"), ("x", '"x" does not start with a number')])
def test_a_cell_of_a_loggers_table_that_is_no_number_is_named_by_its_column(tmp_path, cell, said):
    (tmp_path / "run.csv").write_text(f"Zeit [s];Drehzahl [rpm];Drehmoment [Nm]\n0,0;1,0;0,2\n0,5;{cell};0,3\n")
    with pytest.raises(InputError) as caught:
        load_cycle(spec_of(tmp_path))
    assert f"run.csv:3: speed: {said}; expected a number in each row" in str(caught.value)


def test_a_window_longer_than_the_recording(shaft):
    with pytest.raises(InputError, match=r"robot\.yaml:5: load\.smoothing: 9 s is longer than the recording, 3 s"):
        shaft(POSITION, CORNERS, CORNERS, CORNERS, smoothing="9 s")
