"""The shipped maxon catalogue: how much there is, what is left out and why, and rows against pages as printed."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from drivesizer.catalog import Catalog, Motor, Table, load
from drivesizer.catalog.laws import identities, solved

TURN = 2 * math.pi
RPM = TURN / 60  # rad/s


@pytest.fixture(scope="module")
def motors(catalog: Catalog) -> Table[Motor]:
    return catalog.motors


@pytest.fixture(scope="module")
def offered(motors: Table[Motor]) -> NDArray[np.bool_]:
    return ~motors.excluded


# --- identities ----------------------------------------------------------------------------------------------------


def test_no_motor_is_offered_without_the_figures_that_size_it(motors: Table[Motor], offered: NDArray[np.bool_]) -> None:
    """What they say of each other is proved for every catalogue in test_catalog_check.py."""
    for name in ("torque_constant", "resistance", "rotor_inertia", "no_load_speed", "no_load_current", "stall_torque"):
        assert not np.isnan(motors[name][offered]).any()


def test_the_excluded_motors_are_those_that_break_the_law_and_say_why(catalog: Catalog, motors: Table[Motor]) -> None:
    assert set(motors["part"][motors.excluded].tolist()) == {"350909", "370416", "370418", "370427"}
    for part in motors["part"][motors.excluded]:
        reasons = [note.text for note in catalog.notes_on("motors", str(part)) if note.exclude]
        assert len(reasons) == 1 and "integrated electronics" in reasons[0]
        motor = motors.record(motors.rows[str(part)])
        assert motor.torque_constant * motor.no_load_speed < 0.75 * motor.nominal_voltage  # the controller's limit
        assert motor.stall_current < 0.25 * motor.nominal_voltage / motor.resistance


def test_excluded_gearheads_are_those_without_figures(catalog: Catalog) -> None:
    gearheads = catalog.gearheads
    odd = (gearheads["family"] == "GPX 19 LN") & (gearheads["stages"] == 4)  # 90 % in four stages, torques swapped
    assert (gearheads.excluded & ~odd).sum() == 25 and odd.sum() == (gearheads.excluded & odd).sum() == 14
    assert np.isnan(gearheads["continuous_torque"][gearheads.excluded & ~odd]).all()
    assert not np.isnan(gearheads["ratio"][~gearheads.excluded]).any()
    for part in gearheads["part"][gearheads.excluded]:
        assert any(note.exclude and note.text for note in catalog.notes_on("gearheads", str(part)))


@pytest.mark.parametrize(
    ("identity", "figure", "low", "high"),
    [("stall torque and no-load speed", "resistance", 0.99, 1.05),
     ("no-load speed alone", "torque_constant", 0.98, 1.14),
     ("stall torque and no-load speed alone", "resistance", 0.99, 1.14)],
)  # fmt: skip
def test_what_a_shop_prints_of_a_brushed_motor_gives_its_winding(
    identity: str, figure: str, low: float, high: float
) -> None:
    """Out of voltage, no-load speed and stall torque as printed, against resistance and k_t as printed."""
    for maker in ("maxon", "faulhaber"):
        motors = load([maker]).motors
        brushed = (motors["kind"] == "brushed") & ~motors.excluded
        ratio = (solved(identities()["motors"][identity], motors, figure) / motors[figure])[brushed]
        assert np.isfinite(ratio).sum() > 10 and low < np.nanmin(ratio) and np.nanmax(ratio) < high


# --- rows as printed -----------------------------------------------------------------------------------------------


def test_what_is_not_known_of_the_papers_motor_is_unknown_and_what_is_worked_out_says_so(catalog: Catalog) -> None:
    row = catalog.motors.rows["118752"]
    motor = catalog.motors.record(row)
    assert math.isnan(motor.price)
    confidence = catalog.confidence("motors", row)
    assert {name for name, how in confidence.items() if how == "derived"} == {"length"}
    assert set(confidence.values()) == {"derived", "secondary"}
    assert motor.nominal_torque == pytest.approx(23.4e-3 * (1.16 - 0.0369), rel=2e-3)  # k_t (I_N - I_0)
    assert motor.speed_torque_gradient == pytest.approx(2.32 / 23.4e-3**2, rel=5e-3)  # R / k_t^2


def test_the_papers_gearhead_as_printed(catalog: Catalog) -> None:
    gearhead = catalog.gearheads.record(catalog.gearheads.rows["406764"])
    assert (gearhead.family, gearhead.reduction, gearhead.kind) == ("GP 26 A", "27:1", "planetary")
    assert gearhead.ratio == 3249 / 121
    assert gearhead.continuous_input_speed == pytest.approx(8000 * RPM)
    assert (gearhead.continuous_torque, gearhead.intermittent_torque) == (2.25, 3.2)
    assert gearhead.efficiency == pytest.approx(0.80)
    assert gearhead.mass == pytest.approx(0.077)
    assert gearhead.backlash == pytest.approx(math.radians(0.7))
    assert gearhead.inertia == pytest.approx(0.54e-7)


def test_the_paper_is_the_source_of_its_own_set(catalog: Catalog) -> None:
    """RE 25, GP 26 A and the MR encoder go together because the paper says so."""
    motor = catalog.motors.rows["118752"]
    for relation, right, part in (("motor_gearhead", "gearheads", "406764"), ("motor_encoder", "encoders", "225778")):
        pairs, row = getattr(catalog, relation), catalog.table(right).rows[part]
        found = np.flatnonzero((pairs.left == motor) & (pairs.right == row))
        assert len(found) == 1
        source = catalog.sources[pairs.source[found[0]]]
        assert "10.3390/app11146631" in source.url, part
        assert source.confidence == "quoted"
    encoder = catalog.encoders.record(catalog.encoders.rows["225778"])
    assert (encoder.family, encoder.counts_per_turn) == ("MR type ML", 500)
    assert encoder.inertia == pytest.approx(0.7e-7)  # the code wheel of 225780, which has 1000 counts
