"""Operating points that makers print, against the prediction at the same voltage: without load, rated and stalled."""

from __future__ import annotations

from math import isnan, nan

import numpy as np
import pytest

from drivesizer.catalog import load, shipped
from drivesizer.catalog.query import PartRow
from drivesizer.prediction.predict import completed, predict
from drivesizer.results.prediction import Conditions

BENCH = Conditions(nan, 298.15, nan, nan, 0.0, 60.0, nan, 0.0)
POINTS = {
    "free_speed": "no_load_speed", "no_load_current": "no_load_current", "stall_torque": "stall_torque",
    "stall_current": "stall_current", "load_speed": "nominal_speed", "load_current": "nominal_current",
}  # fmt: skip
# printed stall torques that no gear gives, 1.02 to 1.28 times i k_t I, or twice what was measured (XL330-M288-T)
TOO_STRONG = ("XL330-M077-T", "XL330-M288-T", "XC330-M181-T 3.7 V", "XC330-T181-T 9 V", "XC430-W150-T")


@pytest.fixture(scope="module")
def every():
    return load(list(shipped()))


def points(catalog, section, row, figures=tuple(POINTS)):
    """Printed figures with their bands, as shares of what is printed: name, nominal, 5 %, 95 %."""
    hit = PartRow("", catalog, section, int(row))
    found = predict(hit, None, None, completed(BENCH, hit, None), warming=False)
    for name in figures:
        band, printed = found.figure(name).band, hit[POINTS[name]]
        if not isnan(printed) and not isnan(band.nominal):
            yield name, *(float(x) / printed for x in (band.nominal, band.p5, band.p95))


def test_printed_points_of_servos_come_out(every):
    """No load and stall of all servos whose figures are worked out of these two points."""
    missed, found = [], []
    for row in every.by_rule("resistance"):
        part = str(every.actuators["part"][row])
        for name, nominal, low, high in points(every, "actuators", row, (*POINTS,)[:4]):
            if name == "stall_torque" and part.startswith(TOO_STRONG):
                assert high < 1.0
                continue
            found.append(abs(nominal - 1.0))
            if not low <= 1.0 <= high:
                missed.append((part, name, low, high))
    assert len(found) > 230 and not missed
    assert np.quantile(found, 0.9) < 0.06


def test_printed_points_of_motors_are_within_the_bands(every):
    """One motor of each family: what lies outside is named with its reason."""
    motors = every.motors
    names = np.char.add(motors["manufacturer"].astype(str), motors["family"].astype(str))
    rows = np.unique(names, return_index=True)[1]
    inside, outside = dict.fromkeys(POINTS, 0), {name: list[str]() for name in POINTS}
    for row in rows[motors["inside"][rows] == ""][::3]:
        for name, _, low, high in points(every, "motors", row):
            if low <= 1.0 <= high:
                inside[name] += 1
            else:
                outside[name].append(str(motors["part"][row]))
    for name in ("free_speed", "no_load_current", "stall_current"):
        assert inside[name] >= 0.9 * (inside[name] + len(outside[name])), (name, outside[name])
    assert sum(inside.values()) >= 0.85 * (sum(inside.values()) + sum(map(len, outside.values()))), outside
