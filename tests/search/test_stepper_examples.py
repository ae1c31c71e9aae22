"""Printed selection examples of steppers, with what differs by design."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from drivesizer import load_spec, size
from drivesizer.results.drive_set import DriveSet

LB, INCH, FOOT = 0.45359237, 0.0254, 0.3048  # kg, m, m
TEXT = """\
catalog: 1
manufacturer: Examples
sources:
  sheet: {document: "printed examples", confidence: quoted}
steppers:
- family: five-phase, 0.72 degrees
  source: sheet
  columns: [part, full_steps, phase_current (A), holding_torque (N*m), resistance (ohm), inductance (mH),
    rotor_inertia (kg*m^2)]
  rows:
  - [AR66, 500, 1.4, 1.2, 1.0, 1.0, 380.0e-7]
  - [TECHNO, 200, 6, 9, 0.4, 2.0, 7.3161e-4]
"""


def drive(folder: Path, part: str, **given: Any) -> DriveSet:
    (folder / "examples.yaml").write_text(TEXT, encoding="utf-8")
    select = {"catalogs": [str(folder / "examples.yaml")], "motor": {"kind": "stepper", "part": part}}
    spec = {"name": "a", "transmission": [{"kind": "direct"}], "supply": {"nominal": "75 V"}, "select": select}
    result = size(load_spec(spec | given))
    return (*result.sets, *result.misses)[0]


def test_oriental_motor_ball_screw(tmp_path: Path) -> None:
    """Oriental Motor, Motor Sizing Calculations, ball screw with a stepper: 0.48 N*m are required of an AR66.

    40 kg, friction 0.05, efficiency 0.9, lead 15 mm, nut preload a third of the force with 0.3, screw 0.236e-4 kg*m^2;
    180 mm in 0.8 s of which 0.2 s each way: 1200 rpm, 10 kHz of 0.72 degrees. Printed T_L = 0.0567 N*m,
    T_a = 628 J_0 + 0.158 N*m, with J_0 = 380e-7 kg*m^2 and a factor of 2 0.48 N*m. Trap: the maker divides the
    friction of the table by the efficiency of the screw, and not the force that accelerates it.
    """
    friction = 40 * 9.807 * 0.05
    load = {
        "kind": "ball_screw", "mass": "40 kg", "lead": "15 mm", "efficiency": 0.9, "friction_coefficient": 0.05,
        "inertia": "0.236e-4 kg*m^2", "preload_torque": f"{0.3 * friction / 3 * 0.015 / (2 * math.pi)} N*m",
    }  # fmt: skip
    motion = {"speed": "0.3 m/s", "acceleration_time": "0.2 s", "cruise_time": "0.4 s"}
    found = drive(tmp_path, "AR66", load=load, motion=motion)
    figures = {figure.name: figure.value for figure in found.figures}
    assert figures["step_rate"] == pytest.approx(10_000, rel=1e-6)
    torque = next(check for check in found.checks if check.name == "pull_out_torque").demand
    alpha = 1200 * math.pi / 30 / 0.2
    table = 40 * (0.015 / (2 * math.pi)) ** 2
    as_printed = torque - (1 / 0.9 - 1) * table * alpha
    assert as_printed == pytest.approx(0.0567 + 0.158 + 628 * 380e-7, abs=5e-4)
    assert 2 * as_printed == pytest.approx(0.48, abs=5e-3)


def test_techno_rack_and_pinion(tmp_path: Path) -> None:
    """Techno-Isel, catalogue H834, technical information, page 31, example C: 18.25 lb*in^2 and 3820 steps a second.

    5 lb on a pinion of 3 in with 4.5 lb*in^2, to 15 ft/s in 0.5 s, rotor 2.5 lb*in^2, 1.8 degrees a step. Printed
    w r^2 = 11.25 lb*in^2 and 19.1 rev/s.
    """
    load = {
        "kind": "rack_pinion", "mass": f"{5 * LB} kg", "pinion_diameter": f"{3 * INCH} m",
        "inertia": f"{4.5 * LB * INCH**2} kg*m^2",
    }  # fmt: skip
    motion = {"speed": f"{15 * FOOT} m/s", "acceleration_time": "0.5 s", "cruise_time": "0.1 s"}
    found = drive(tmp_path, "TECHNO", load=load, motion=motion)
    figures = {figure.name: figure.value for figure in found.figures}
    assert figures["step_rate"] == pytest.approx(3820, rel=5e-4)
    torque = next(check for check in found.checks if check.name == "pull_out_torque").demand
    alpha = 19.1 * 2 * math.pi / 0.5
    assert torque / alpha == pytest.approx(18.25 * LB * INCH**2, rel=5e-4)
