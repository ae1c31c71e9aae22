"""The shipped Faulhaber catalogue: against data sheets as printed; its laws are those of every catalogue."""

from __future__ import annotations

import math

import numpy as np
import pytest

from drivesizer.catalog import Catalog, Motor, Table, load
from drivesizer.catalog.tables import as_printed

RPM = math.pi / 30  # rad/s


@pytest.fixture(scope="module")
def faulhaber() -> Catalog:
    return as_printed(load(["faulhaber"]))


@pytest.fixture(scope="module")
def motors(faulhaber: Catalog) -> Table[Motor]:
    return faulhaber.motors


# --- how much there is ---------------------------------------------------------------------------------------------


def test_pairs(faulhaber: Catalog, motors: Table[Motor]) -> None:
    """Without the 470 gearheads of all sizes that the source lists for each 2214 BXT H and 1509 B."""
    pairs = faulhaber.motor_gearhead
    assert len(pairs.left) == 24646 - 5 * 470
    alone = set(motors["family"].tolist()) - set(motors["family"][pairs.left].tolist())
    assert alone == {"2214 BXT H", "1509 B", "1506 SR", "2607 SR", "2232 BX4S", "2250 BX4S"}
    assert len(set(pairs.right.tolist())) == 644
    sizes = [np.array([int(f[:2]) for f in names]) for names in (motors["family"], faulhaber.gearheads["family"])]
    apart = sizes[0][pairs.left] - sizes[1][pairs.right]  # motor and gearhead are about equally thick
    assert apart.min() >= -18
    assert apart.max() <= 6


# --- rows as printed -----------------------------------------------------------------------------------------------


def test_a_gearhead_as_given(faulhaber: Catalog) -> None:
    gearhead = faulhaber.gearheads.record(faulhaber.gearheads.rows["32/3R 3.71:1"])
    assert (gearhead.family, gearhead.reduction, gearhead.kind) == ("32/3R", "3.71:1", "planetary")
    assert (gearhead.ratio, gearhead.stages, gearhead.direction) == (3.71, 1, 1)
    assert (gearhead.continuous_torque, gearhead.intermittent_torque, gearhead.efficiency) == (1.0, 1.2, 0.91)
    assert gearhead.mass == pytest.approx(0.16)
    assert math.isnan(gearhead.inertia)
    assert faulhaber.gearheads["inertia"][faulhaber.gearheads.rows["42GPT 11:1"]] == pytest.approx(20e-7)


def test_the_confidence_of_figures(faulhaber: Catalog, motors: Table[Motor]) -> None:
    """Of 1331T006SR the data sheet and MGDB print another current: the rated speed decides for MGDB's."""
    row = motors.rows["1331T006SR"]
    motor, confidence = motors.record(row), faulhaber.confidence("motors", row)
    assert {n for n, how in confidence.items() if how != "quoted"} == {"nominal_current", "nominal_speed"}
    at_rated_speed = (motor.nominal_voltage - motor.torque_constant * motor.nominal_speed) / motor.resistance
    assert motor.nominal_current == pytest.approx(at_rated_speed, rel=0.02)
    assert any("0.81 A" in note.text for note in faulhaber.notes_on("motors", "1331T006SR"))
    assert faulhaber.confidence("motors", motors.rows["3564K024B"])["max_radial_load"] == "quoted"
