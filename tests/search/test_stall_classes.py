"""Figures that are worked out from printed points at no load and at stall: which they are, and how far they may be off.

Measured: Rhoban/bam at a6f2671 (MX-64 and MX-106: free speed, locked rotor, lift) and at af22604 (XL330: static lift at
34, 51, 79 and 98 % of its supply).
"""

from __future__ import annotations

from math import nan

import numpy as np
import pytest

from drivesizer.catalog import load
from drivesizer.catalog.query import Hit
from drivesizer.catalog.view import search_view
from drivesizer.prediction.predict import completed, predict
from drivesizer.prediction.set_at_voltage import sampled_parts
from drivesizer.results.prediction import Conditions
from drivesizer.search.uncertainty.uncertain_figures import holding

GIVEN = Conditions(nan, 298.15, nan, nan, 0.0, 3600.0, nan, 0.0)
LIFTED = [(2.53, 0.175), (3.69, 0.239), (5.79, 0.368), (6.94, 0.371)]  # V, N*m
FREE = [(3.0, 1.70456), (12.0, 7.00109), (15.0, 8.77406)]  # MX-64: V, rad/s


def classes_of(catalogue, part, given=None):
    view = search_view(load([catalogue]))
    row = view.motors.rows[part]
    (gearhead,) = np.flatnonzero(view.gearheads["inside"] == part) if view.motors["inside"][row] else (-1,)
    held = holding(view, given or {}, "motor", row) + holding(view, given or {}, "gearhead", int(gearhead))
    return {f"{one.part}.{one.figure}": one.text for one in held}


def hit(catalogue, section, part):
    found = load((catalogue,))
    return Hit(", ".join(found.digests), found, section, found.table(section).rows[part])


def test_what_follows_from_stall_has_classes_of_its_own():
    found = classes_of("robotis", "MX-64 12 V")
    assert found["motor.resistance"] == "0.72..0.9..1.22 times"
    assert found["gearhead.peak_torque"] == "0.5..1.1 times"
    # 200:1 is four stages: 0.87^4 = 57 %, against what the sheet has without the friction
    view = search_view(load(["robotis"])).actuators
    sheet = view["efficiency"][view.rows["MX-64 12 V"]]
    low, high = (float(x) for x in found["gearhead.efficiency"].removesuffix(" times").split(".."))
    assert (low, high) == pytest.approx((0.35, (0.87**-4 - 1) / (1 / sheet - 1)), rel=0.1)


@pytest.mark.parametrize(("catalogue", "part"), [("maxon", "118752"), ("faulhaber", "2232S024BX4")])
def test_printed_figures_keep_the_class_of_printed_figures(catalogue, part):
    found = classes_of(catalogue, part)
    assert (found["motor.resistance"], found["motor.torque_constant"]) == ("+- 10 %", "+- 10 %")
    assert ("motor.dry_friction" in found) == (catalogue == "maxon") and "gearhead.peak_torque" not in found


def test_a_motor_of_a_printed_no_load_current_keeps_the_class_of_its_constant():
    found = classes_of("rev", "NEO V1.1")
    assert (found["motor.resistance"], found["motor.torque_constant"]) == ("0.72..0.9..1.22 times", "+- 10 %")
    assert found["motor.dry_friction"] == "-75 %..65 %"


def test_measured_servos_are_within_the_bands():
    def band_at(hit, volts, figure):
        at = completed(GIVEN._replace(voltage=volts), hit, None)
        return predict(hit, None, None, at, warming=False).figure(figure).band

    mx = hit("robotis", "actuators", "MX-64 12 V")
    for volts, speed in FREE:
        band = band_at(mx, volts, "free_speed")
        assert band.p5 < speed < band.p95
    xl = hit("robotis", "actuators", "XL330-M288-T 6 V")
    for volts, torque in LIFTED:
        band = band_at(xl, volts, "stall_torque")
        assert band.p5 < torque < band.p95
    R = sampled_parts(hit("robotis", "actuators", "MX-106 12 V"), None, None, 9).motor["resistance"][1:]
    assert np.quantile(R, 0.05) < 2.09 < 2.32 < np.quantile(R, 0.95) * 1.01  # ohm, locked and lifting
