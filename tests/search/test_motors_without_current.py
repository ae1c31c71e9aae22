"""Servo motors of which torque is printed and no current: the torque decides what it can."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from drivesizer.catalog import load
from drivesizer.results.ratings import nominal_torque_limit
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import load_spec

TEXT = Path(__file__).with_name("motors_without_current.yaml").read_text(encoding="utf-8")
SPEC = {
    "name": "table", "load": {"kind": "flywheel", "inertia": "0.012 kg*m^2"}, "transmission": [{"kind": "direct"}],
    "motion": {"speed": "600 rpm", "acceleration_time": "0.5 s", "cruise_time": "0.5 s", "rest_time": "0.1 s"},
    "supply": {"nominal": "300 V", "accepts": "all"}, "environment": {"ambient": "40 degC"},
}  # fmt: skip


@pytest.fixture(scope="module")
def catalog(tmp_path_factory):
    folder = tmp_path_factory.mktemp("servo")
    (folder / "servo.yaml").write_text(TEXT, encoding="utf-8")
    return load(["servo.yaml"], beside=folder)


def by_hand(inertia, friction=0.02, viscous=1e-6):
    """RMS and peak torque of three stretches and a rest."""
    w = 600 * 2 * math.pi / 60
    total = 0.012 + inertia
    t = np.linspace(0.0, 0.5, 20001)
    drag = friction + viscous * w * t / 0.5
    up, down, along = total * w / 0.5 + drag, -total * w / 0.5 + drag, friction + viscous * w
    square = (np.trapezoid(up**2, t) + np.trapezoid(down**2, t) + along**2 * 0.5) / 1.6
    return math.sqrt(square), total * w / 0.5 + friction + viscous * w


@pytest.mark.parametrize(("part", "inertia"), [("S-1", 0.3e-4), ("S-2", 0.5e-4), ("S-4", 1.6e-4)])
def test_rms_and_peak_torque_are_held_against_the_printed_ones(part, inertia, catalog):
    (found,) = explain(load_spec(SPEC), part, "direct", catalog=catalog)
    checks = {check.name: check for check in found.checks}
    rms, peak = by_hand(inertia)
    assert checks["motor_nominal_torque"].demand == pytest.approx(rms, rel=1e-6)
    assert checks["motor_peak_torque"].demand == pytest.approx(peak, rel=1e-9)
    nominal = {"S-1": 0.64, "S-2": 1.27, "S-4": 2.39}[part]
    assert checks["motor_nominal_torque"].limit == pytest.approx(nominal)
    assert checks["motor_nominal_torque"].status == ("pass" if rms <= nominal else "fail")
    assert "motor_nominal_current" not in checks  # the torque is the rating


def test_a_motor_with_too_little_torque_is_not_among_the_unknown_ones(catalog):
    found = size(load_spec(SPEC), catalog=catalog)
    assert [one.motor.part for one in found.sets] == [
        part for part, inertia, torque in (("S-1", 0.3e-4, 0.64), ("S-2", 0.5e-4, 1.27), ("S-4", 1.6e-4, 2.39))
        if by_hand(inertia)[0] <= torque
    ]  # fmt: skip
    assert 0 < len(found.sets) < 3
    assert {one.status for one in found.sets} == {"unknown"}


def test_between_standstill_and_nominal_speed_the_torque_is_between():
    """7 N*m at rest, 5.73 at 2000 rpm (1200 W): at half of it sqrt(49 - (49 - 32.83)/2) = 6.397 N*m."""
    motor = {"torque_constant": math.nan, "nominal_current": math.nan, "nominal_torque": 5.73, "nominal_speed": 209.44,
             "standstill_torque": np.array([7.0, 7.0, 7.0, math.nan]), "max_winding_temperature": 428.15,
             "rated_ambient": 313.15, "data_temperature": math.nan, "mounted_gain": math.nan}  # fmt: skip
    speed = np.array([0.0, 104.72, 209.44, 104.72])
    (found,) = nominal_torque_limit(np.full(4, 6.0), speed, motor, 313.15)
    assert found.limit == pytest.approx([7.0, 6.397, 5.73, 5.73], rel=1e-3)
    assert found.passed.tolist() == [True, True, False, False]
