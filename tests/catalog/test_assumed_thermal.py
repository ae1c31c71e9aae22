"""Thermal figures of actuators, of which no maker prints any: the assumed laws against what makers of motors print."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from drivesizer.catalog import Catalog, load, shipped
from drivesizer.catalog.estimates import ASSUMED, DENSITY, estimates, estimates_by_rated_current
from drivesizer.catalog.view import search_view
from drivesizer.physics.thermal import resistance_25

HOTTEST = 453.15  # K: thermal class 180 (H) of IEC 60085


@pytest.fixture(scope="module")
def everything() -> Catalog:
    return load(list(shipped()))


LAWS = [law for law in ASSUMED if law.law.section == "actuators" and law.law.figure != "output_inertia"]


@pytest.mark.parametrize("law", LAWS, ids=[f"{fit.law.figure} {fit.law.of}".strip() for fit in LAWS])
def test_nine_in_ten_printed_motors_lie_in_the_assumed_band(everything, law):
    """Housing: motors of the actuator's own mass; winding: the motor inside is 0.4 of it."""
    motors, figure = everything.motors, law.law.figure
    mass = motors["mass"] / (0.4 if "winding" in figure else 1.0)
    known = {**{name: motors[name] for name in law.law.terms if name != "mass"}, "mass": mass}
    with np.errstate(invalid="ignore", divide="ignore"):
        off = np.log(motors[figure]) - law.coefficients[0]
        for factor, name in zip(law.coefficients[1:], law.law.terms, strict=True):
            off -= factor * np.log(known[name])
    off = off[np.isfinite(off) & ((motors["kind"] == law.law.of) | (law.law.of == ""))]
    assert len(off) > 100
    assert np.mean((off > law.band[0]) & (off < law.band[1])) > 0.86


def test_nine_in_ten_brushed_actuators_start_as_fast_as_assumed(everything):
    """J R / (k_t k_e) is the same at rotor and output: of actuators whose ratio is known, all at their rotors."""
    (law,) = (law for law in ASSUMED if law.law.figure == "output_inertia")
    table = everything.actuators
    own = np.where(
        np.isnan(table["rotor_inertia"]), table["output_inertia"] / table["ratio"] ** 2, table["rotor_inertia"]
    )
    time = (own * table["resistance"] / table["motor_torque_constant"] ** 2)[table["kind"] == "brushed"]
    off = np.log(time[~np.isnan(time)]) - law.coefficients[0]
    assert len(off) > 30
    assert np.mean((off > law.band[0]) & (off < law.band[1])) > 0.86


@pytest.mark.parametrize("section", ["encoders", "controllers"])
def test_nine_in_ten_printed_masses_lie_in_the_assumed_band(everything, section):
    (law,) = (law for law in ASSUMED if law.law.section == section)
    printed = everything.table(section)["mass"]
    off = np.log(printed[printed > 0.0]) - law.coefficients[0]
    assert len(off) > 20
    assert np.mean((off > law.band[0]) & (off < law.band[1])) > 0.86


def test_the_area_of_a_servo_is_that_of_the_printed_case(everything):
    """Area of the printed box against that of a cube of the assumed density: within the law's factor of 2."""
    table, found = everything.actuators, []
    for text, mass in zip(table["dimensions"], table["mass"], strict=True):
        sides = [float(side) / 1e3 for side in re.findall(r"[\d.]+", str(text))]
        if len(sides) == 3 and mass == mass:
            a, b, c = sides
            found.append(2 * (a * b + b * c + c * a) / (6 * (mass / DENSITY) ** (2 / 3)))
    assert len(found) > 60
    assert np.quantile(found, 0.05) > 0.5 and np.quantile(found, 0.95) < 2.0


def test_no_estimate_contradicts_the_nominal_current(everything):
    """At the printed nominal current no winding is hotter than the best thermal class permits, at no end of a band."""
    table = everything.actuators
    found = estimates(table)
    names = ("thermal_resistance_winding", "thermal_resistance_housing")
    for end in ("value", "low", "high"):
        total = np.full(len(table), np.nan)
        winding, housing = (found[name] for name in names)
        total[winding.rows] = getattr(winding, end)
        total[housing.rows] += getattr(housing, end)
        hot = np.asarray(resistance_25(table)) * (1 + 0.0039 * (HOTTEST - 298.15))
        rise = total * hot * table["nominal_current"] ** 2  # in its ambient, 25 degC where none is stated
        assert np.nanmax(298.15 + rise) < HOTTEST + 0.1


def test_makers_that_print_no_inertia_have_one_now(everything):
    """ROBOTIS, Pololu and goBILDA: every motor inside has inertia, friction and heat where its winding is known."""
    motors = search_view(everything).motors
    rows = (motors["inside"] != "") & np.isin(motors["manufacturer"], ["ROBOTIS", "Pololu", "goBILDA"])
    rows &= ~np.isnan(motors["resistance"])
    assert rows.sum() == 141
    for name in ("rotor_inertia", "thermal_resistance_winding", "thermal_resistance_housing", "motor_time_constant"):
        assert not np.isnan(motors[name][rows]).any(), name
    own = everything.actuators
    printed = ~np.isnan(own["output_inertia"]) & np.isnan(own["rotor_inertia"])
    at_rotor = own["output_inertia"] / own["ratio"] ** 2
    places = [int(np.flatnonzero(motors["inside"] == part)[0]) for part in own["part"][printed]]
    assert motors["rotor_inertia"][places] == pytest.approx(at_rotor[printed])  # an identified figure wins


def test_the_temperature_at_the_nominal_current_is_the_permitted_one(everything):
    """Where maxon prints both, of 309 brushed motors: by copper alone 5 % less rise in the median, never 1 % more."""
    table = everything.motors
    columns = {**table.columns, "max_winding_temperature": np.full(len(table), np.nan)}
    found = estimates_by_rated_current(replace(table, columns=columns), {})["max_winding_temperature"]
    rows, printed = found.rows, table["max_winding_temperature"][found.rows]
    some = (table["manufacturer"][rows] == "maxon") & (table["kind"][rows] == "brushed") & ~np.isnan(printed)
    ratio = (found.low[some] - 298.15) / (printed[some] - 298.15)
    assert some.sum() == 309
    assert 0.93 < np.median(ratio) < 0.96 and ratio.max() < 1.01
    assert (printed[some] < found.high[some]).all()
