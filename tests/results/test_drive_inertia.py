"""One inertia at the motor's shaft, with gearhead, encoder and brake in it, wherever a drive is computed."""

from __future__ import annotations

from dataclasses import replace
from math import isnan, nan
from pathlib import Path

import pytest

from drivesizer.control.drive_train import drive_train
from drivesizer.machine.set_cycle import turned
from drivesizer.physics.cycle_at_gearhead import ACCELERATION
from drivesizer.sizing import size
from drivesizer.spec.robot import load_spec

PARTS = Path(__file__).with_name("drive_inertia.yaml").read_text(encoding="utf-8")
LIFT = """name: lift
load: {kind: hoist, mass: 20 kg, drum_diameter: 50 mm, inertia: 2 kg*cm^2}
motion: {speed: 0.2 m/s, acceleration_time: 0.3 s, cruise_time: 1 s, there_and_back: true, rest_time: 2 s}
supply: {nominal: 24 V, accepts: all}
needs: {hold_unpowered: true, inertia_ratio: 10}
select: {catalogs: [parts.yaml], estimates: off}
"""
OWN = (140 + 9 + 7 + 12) * 1e-7  # rotor, gearhead, encoder and brake, kg m^2


@pytest.fixture
def lift(tmp_path):
    (tmp_path / "parts.yaml").write_text(PARTS, encoding="utf-8")
    (tmp_path / "lift.yaml").write_text(LIFT, encoding="utf-8")
    return load_spec(tmp_path / "lift.yaml")


def test_all_that_turns_with_the_motor_counts_everywhere(lift):
    """20 kg at 25 mm and 2 kg cm^2 are 0.0127 kg m^2 at the drum, 35^2 * 168 g cm^2 = 0.02058 are the drive's."""
    found = size(lift)
    (one,) = (*found.sets, *found.misses)
    assert (one.encoder.part, one.brake.part) == ("E1", "B1")
    assert one.inertia() == pytest.approx(OWN) and one.rotors_at_load == pytest.approx(35**2 * OWN)
    (ratio,) = (check for check in one.checks if check.name == "inertia_ratio")
    assert ratio.demand == pytest.approx(0.0127 / (35**2 * OWN))
    assert turned(lift, one)[1].coefficients[0, ACCELERATION] == pytest.approx(35 * OWN)
    train, _ = drive_train(lift, one, 1e-3)
    assert train.motor_inertia == pytest.approx(OWN)


def test_an_unknown_inertia_is_unknown_or_left_out(lift):
    found = size(lift)
    (one,) = (*found.sets, *found.misses)
    bare = replace(one, gearhead=replace(one.gearhead, inertia=nan), encoder=replace(one.encoder, inertia=nan))
    assert isnan(bare.inertia()) and bare.inertia(unknown=0.0) == pytest.approx(152e-7)
    assert replace(one, encoder=replace(one.encoder, inertia=nan)).inertia() == pytest.approx(161e-7)
