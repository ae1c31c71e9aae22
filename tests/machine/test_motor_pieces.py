"""The motor's own torque piece by piece: a maker's example, laws of the whole, and every output that prints it."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from drivesizer.catalog import Motor
from drivesizer.catalog.parts import NO_GEARHEAD, OneRow
from drivesizer.load_cases import load_cycle
from drivesizer.machine.set_cycle import motor_pieces
from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.physics.motor_demand import demands
from drivesizer.sizing import size
from drivesizer.spec.robot import load_spec

MOTOR = Motor(rotor_inertia=0.00629e-4, torque_constant=0.05, no_load_current=0.0, no_load_speed=400.0, kind="brushed",
              back_emf_constant=0.05)  # fmt: skip


def pieces_of(load, motion, motor=MOTOR, ratio=1.0):
    spec = load_spec({"name": "x", "load": load, "motion": motion, "supply": {"nominal": "48 V"}})
    cycle = CycleAtBelt(load_cycle(spec), 1.0).behind(1.0)
    gearhead = replace(NO_GEARHEAD, ratio=ratio, efficiency=0.8 if ratio != 1.0 else 1.0)
    demand = demands(cycle, OneRow(motor), OneRow(gearhead), OneRow(None))
    return motor_pieces(cycle, demand, motor.torque_constant), demand, cycle


WHEEL = {"kind": "flywheel", "inertia": "0.474 kg*cm^2", "friction_torque": "0.035 N*m"}
MOVE = {"speed": "3000 rpm", "acceleration_time": "0.1 s", "cruise_time": "0.9 s", "rest_time": "0.4 s"}


def test_verification_of_a_servomotor_of_yaskawa():
    """E-S series, product manual, 2.4.1: T_P 0.186 N·m of (J_M + J_L) and T_L, T_S that without both T_L."""
    found, _, _ = pieces_of(WHEEL, MOVE)
    up, run, down, rest, whole = found
    assert [one.name for one in found] == ["accelerate", "run", "brake", "rest", "cycle"]
    assert up.motor_torque == pytest.approx(0.186, abs=0.0005)
    assert down.motor_torque == pytest.approx(-(0.186 - 2 * 0.035), abs=0.0005)
    assert (run.motor_torque, rest.motor_torque) == pytest.approx((0.035, 0.0))
    assert [one.duration for one in found] == pytest.approx([0.1, 0.9, 0.1, 0.4, 1.5])
    assert [one.start for one in found] == pytest.approx([0.0, 0.1, 1.0, 1.1, 0.0])
    squares = up.motor_torque**2 * 0.1 + 0.035**2 * 0.9 + down.motor_torque**2 * 0.1
    assert whole.rms_torque == pytest.approx(math.sqrt(squares / 1.5))
    assert whole.rms_current == pytest.approx(whole.rms_torque / 0.05)
    assert up.speed == pytest.approx(3000 * math.pi / 30)


ARM = {"kind": "arm", "mass": "2 kg", "length": "300 mm", "start_angle": "-60 deg", "friction_torque": "0.3 N*m"}
BACK = {"speed": "60 deg/s", "acceleration_time": "0.3 s", "cruise_time": "1 s", "rest_time": "0.2 s",
        "there_and_back": True}  # fmt: skip
POLY = {"profile": "move", "distance": "120 deg", "time": "1 s", "law": "poly5", "there_and_back": True}


@pytest.mark.parametrize(("load", "motion"), [(WHEEL, MOVE), (ARM, BACK), (ARM, POLY)])
def test_pieces_make_the_whole(load, motion):
    """Times add up, squares add up by time, extremes are the largest of any; and the whole is what limits compare."""
    found, demand, cycle = pieces_of(load, motion, ratio=20.0)
    *parts, whole = found
    assert sum(one.duration for one in parts) == pytest.approx(whole.duration) == pytest.approx(cycle.load_cycle.total)
    squares = sum(one.rms_torque**2 * one.duration for one in parts)
    assert whole.rms_torque == pytest.approx(math.sqrt(squares / whole.duration))
    assert whole.rms_torque == pytest.approx(float(demand.rms_torque[0]))
    assert whole.current == pytest.approx(max(one.current for one in parts))
    assert whole.speed == pytest.approx(float(demand.peak_speed[0]))
    for one, after in pairwise(parts):
        assert after.start == pytest.approx(one.start + one.duration)


def test_a_moment_by_plain_python():
    """An arm behind a gear of 20 at 80 %: torque at the start of the way up, rotor included."""
    found, _, _ = pieces_of(ARM, BACK, ratio=20.0)
    slope = math.radians(60.0) / 0.3
    load = 2 * 0.3**2 * slope + 2 * 9.80665 * 0.3 * math.cos(math.radians(-60.0)) + 0.3
    up = found[0]
    assert up.load_torque >= load
    rising = load + 2 * 9.80665 * 0.3 * (math.cos(math.radians(-51.0)) - math.cos(math.radians(-60.0)))
    assert up.load_torque == pytest.approx(rising, rel=1e-4)
    assert up.motor_torque == pytest.approx(rising / (20 * 0.8) + 0.00629e-4 * 20 * slope, rel=1e-4)
    assert [one.name for one in found] == [
        "accelerate", "run", "brake", "rest", "accelerate back", "run back", "brake back", "rest", "cycle"
    ]  # fmt: skip


def test_what_is_not_known_is_unknown():
    found, _, _ = pieces_of(WHEEL, MOVE, replace(MOTOR, rotor_inertia=math.nan))
    assert all(math.isnan(one.motor_torque) and math.isnan(one.rms_current) for one in found)
    assert found[0].load_torque == pytest.approx(0.474e-4 * 100 * math.pi / 0.1 + 0.035)


def test_a_noisy_recording_has_the_pieces_that_were_driven(tmp_path):
    """Ramps of known times, 1 % of noise on the speed, and one sample of the torque that stands alone."""
    rng, times, speeds = np.random.default_rng(3), [0, 1, 6, 14, 19, 22, 24, 27, 32, 38, 40], [0, 0, 60, 60, 0, 0, 0]
    time = np.arange(0.0, 40.0, 0.01)
    speed = np.interp(time, times, [*speeds, -40, -40, 0, 0]) + rng.normal(0.0, 0.6, len(time))
    torque = 2.0 * np.sign(speed) + rng.normal(0.0, 0.1, len(time))
    torque[1650] = 14.0
    speed[0] = speed[-1] = 0.0
    rows = "\n".join(f"{t:.2f},{w:.4f},{T:.4f}" for t, w, T in zip(time, speed, torque, strict=True))
    (tmp_path / "log.csv").write_text(f"time,speed,torque\ns,rpm,N*m\n{rows}\n", encoding="utf-8")
    text = "name: x\nload: {kind: recorded, file: log.csv, smoothing: 20 ms}\nsupply: {nominal: 24 V}\n"
    (tmp_path / "robot.yaml").write_text(f"{text}select: {{catalogs: [maxon]}}\n", encoding="utf-8")
    found = size(load_spec(tmp_path / "robot.yaml"))
    *parts, _ = found.sets[0].pieces
    assert [one.name for one in parts] == [
        "rest", "accelerate", "run", "brake", "rest", "accelerate back", "run back", "brake back", "rest"
    ]  # fmt: skip
    assert [one.duration for one in parts] == pytest.approx([1, 5, 8, 5, 5, 3, 5, 6, 2], abs=0.4)
    (said,) = (text for text in found.warnings if "single sample" in text)
    assert said.startswith("the largest torque of log.csv, 14 N·m, is a single sample at 16.5 s; without it 2.")
