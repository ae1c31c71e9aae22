"""Drives that other people measured, against the program; and the page about them.

The figures here are a few of the records. Servos: Rhoban/bam at a6f2671b7f08524f6bb308ce3d2016a30faac61e,
atomic/data/velocity_mx64.json and velocity_mx106.json, atomic/stall.py, atomic/R_identification.py. RI50: karthikurs/
actuator-dynamometer at 1ab6e56f6f9dbedd90398ccdfc05a4728ed38e03, futek_data/futek_test_24_05_2021_16-20-14.csv and
futek_test_27_04_2021_17-39-20.csv: means over the second half of each step.
"""

import re
import sys
from pathlib import Path

import numpy as np
import pytest

from drivesizer.machine.part_curves import line, overload_times
from drivesizer.physics.drive_train import friction
from drivesizer.physics.thermal import resistance_at

DOCS = Path(__file__).resolve().parents[2] / "docs"
sys.path.insert(0, str(DOCS))

import measured_compared as compared  # noqa: E402
import measured_data as data  # noqa: E402
import measured_tables as tables  # noqa: E402

PAGE = (DOCS / "measured.md").read_text(encoding="utf-8")
TEXT, _, LINES = (DOCS / "measured.txt").read_text(encoding="utf-8").partition("\n---\n")
FREE = {"MX-64": {3.0: 1.70456, 12.0: 7.00109, 15.0: 8.77406}, "MX-106": {3.0: 1.10631, 12.0: 4.98268, 15.0: 6.28441}}
STALLED = np.array([  # amplitude A, winding degC, W of both drives, W of the other one
    (4.017, 54.15, 44.17, 19.93), (6.004, 64.69, 93.27, 41.05), (8.002, 75.01, 171.57, 76.55),
])  # fmt: skip
STANDBY = 3.930, 1.954  # W, likewise
IDLE = np.array([(15.725, 0.461), (47.119, 0.839), (78.442, 1.067), (125.680, 1.232)])  # rad/s, amplitude A


def servo(name="MX-106 12 V"):
    return compared.part("robotis", name)


def ri50():
    return compared.part("cubemars", "RI50 KV100")


# --- the program and a few of the records -----------------------------------------------------------------------------


@pytest.mark.parametrize("name", FREE)
def test_the_free_speed_of_the_sheet_is_within_7_percent(name):
    V, w = (np.array(list(x)) for x in (FREE[name], FREE[name].values()))
    error = line(servo(f"{name} 12 V")).speed * V / servo(f"{name} 12 V")["nominal_voltage"] / w - 1
    assert (np.abs(error) < 0.07).all()
    assert (error[1:] < -0.05).all()  # the units are faster than printed
    assert error[0] > error[1]  # friction takes its share of a low voltage


def test_the_lifted_torque_needs_the_gears_efficiency():
    (V, I, M), motor = data.lifted(), servo()
    amperes = V / motor["resistance"]
    torque = motor["ratio"] * motor["motor_torque_constant"] * motor["efficiency"] * amperes
    assert amperes == pytest.approx(I, rel=0.07)
    assert torque == pytest.approx(M, rel=0.085)
    assert (torque / motor["efficiency"] / M > 1.55).all()


def test_the_gears_efficiency_is_that_of_stall_over_free_speed():
    _, I, M = data.lifted()
    free = FREE["MX-106"]
    k_e = (15.0 - 3.0) / (free[15.0] - free[3.0])  # V*s/rad at the horn
    assert servo()["efficiency"] == pytest.approx((M / I).mean() / k_e, rel=0.03)


def test_the_resistance_is_within_what_two_measurements_differ():
    V, I, _ = data.lifted()
    found = [np.polyfit(data.LOCKED[:, 0], data.LOCKED[:, 1], 1)[0], np.polyfit(I, V, 1)[0]]
    assert min(found) * 0.99 < servo()["resistance"] < max(found) * 1.01
    assert max(found) / min(found) > 1.09


def test_each_drive_that_is_on_takes_its_standby_at_the_first_supply():
    both, one = STANDBY
    on, off = 2.322, 0.382  # W, futek_test_17_05_2021_17-17-56.csv at rest: the other drive is off
    assert both - one == pytest.approx(on - off, rel=0.03)
    assert both == pytest.approx(2 * one, rel=0.03)


def test_the_power_at_stall_is_that_of_the_hot_resistance():
    I, T, both, other = STALLED.T
    power = both - other - (STANDBY[0] - STANDBY[1])
    I, R = data.DC * I, ri50()["resistance"]
    hot = resistance_at(R, T + data.CELSIUS) * I**2
    assert (np.abs(hot / power - 1) < 0.15).all()
    assert R * I[-1] ** 2 / power[-1] < 0.75  # cold


def test_of_one_no_load_current_part_is_dry_and_part_grows_with_the_speed():
    """Neither all of it at any speed nor all of it by the speed; the dry share that is taken misses by less."""
    w, I = IDLE.T
    I = data.DC * I
    figures = {"torque_constant": 0.1, "no_load_current": I[-1], "no_load_speed": w[-1], "kind": "brushless",
               "inside": "", "winding": "", "friction_torque": np.nan, "viscous_friction": np.nan}  # fmt: skip
    coulomb, viscous = friction({name: np.array([value]) for name, value in figures.items()})
    parted, flat, proportional = (coulomb + viscous * w) / 0.1, np.full_like(w, I[-1]), I[-1] * w / w[-1]
    missed = [np.sqrt(np.mean((one / I - 1.0) ** 2)) for one in (parted, flat, proportional)]
    assert missed[0] < 0.5 * missed[1] and missed[0] < 0.85 * missed[2]


def test_without_thermal_figures_nothing_is_said_about_heat():
    for part in (ri50(), servo()):
        assert np.isnan(overload_times(part, 5.0)).all()


# --- the page ---------------------------------------------------------------------------------------------------------


def rows(heading):
    """Cells of the first table below a heading."""
    below = PAGE.split(f"\n## {heading}\n", 1)[1].split("\n## ")[0]
    return [line.split(" | ") for line in re.findall(r"^\| (.+) \|$", below, re.MULTILINE)[2:]]


def test_at_least_85_percent_of_the_points_are_inside():
    (counted,) = (row for row in rows("Points inside the band") if row[0] == "**all**")
    points, inside = map(int, counted[1:3])
    assert inside >= tables.GOAL * points
