"""Estimates of what data sheets leave out: the laws that ship are what the catalogues give, and their bands hold."""

from __future__ import annotations

import json
from dataclasses import replace
from importlib import resources
from math import exp, log
from pathlib import Path

import numpy as np
import pytest

from drivesizer.catalog import Catalog, Table, load, shipped
from drivesizer.catalog.estimates import (
    Law,
    column,
    estimates,
    estimates_of,
    fit,
    fits,
    left_out,
    members_of,
    shipped_laws,
    widening,
    written,
)
from drivesizer.catalog.tables import as_printed
from drivesizer.sizing import explain
from drivesizer.spec.robot import load_spec


@pytest.fixture(scope="module")
def everything() -> Catalog:
    return as_printed(load(list(shipped())))


def test_the_kept_laws_are_what_the_catalogues_give(everything):
    """Made by `python -m drivesizer.catalog.estimates`; six digits are kept, and the last may differ elsewhere."""
    text = resources.files("drivesizer.catalog").joinpath("estimates.json").read_text(encoding="utf-8")
    now, then = json.loads(written(fits(everything))), json.loads(text)
    assert [(r["section"], r["of"], r["figure"], r["terms"]) for r in now] == [
        (r["section"], r["of"], r["figure"], r["terms"]) for r in then
    ]
    for ours, found in zip(now, then, strict=True):
        assert ours["coefficients"] == pytest.approx(found["coefficients"], rel=1e-4, abs=1e-4)
        assert ours["band"] == pytest.approx(found["band"], rel=1e-4, abs=1e-4)
        assert ours["width"] == pytest.approx(found["width"], rel=1e-4)
        assert ours["width"] > np.exp(np.diff(ours["band"]).item())
        assert ours["centre"] == pytest.approx(found["centre"], rel=1e-4, abs=1e-4)
        assert np.array(ours["precision"]) == pytest.approx(np.array(found["precision"]), rel=1e-4, abs=1e-4)
        for name in ("parts", "families", "makers", "constructions"):
            assert ours[name] == found[name]


def test_nine_in_ten_parts_of_families_never_seen_lie_in_the_band(everything):
    """Each family is estimated by a fit without it (numpy's own lstsq here, not the program's), law by law.

    The interval is that of prediction, x' (X' W X)^-1 x, with the column of ones in X and 1 / parts of the family in W.
    """
    for law in (law for law in shipped_laws() if not law.source):
        table = everything.table(law.law.section)
        terms = [np.log(column(table, name)) for name in law.law.terms]
        y = np.log(column(table, law.law.figure))
        rows = members_of(table, law.law.of) & np.isfinite(y) & np.all([np.isfinite(t) for t in [y, *terms]], axis=0)
        seen: set[object] = set()  # variants of one family that are alike in all this count once
        for row in np.flatnonzero(rows):
            alike = (str(table["family"][row]), *(round(float(t[row]), 7) for t in (y, *terms)))
            rows[row] = alike not in seen and not table.excluded[row]
            seen.add(alike)
        x, y = np.column_stack([np.ones(rows.sum()), *(t[rows] for t in terms)]), y[rows]
        family = [f"{m} {f}" for m, f in zip(table["manufacturer"][rows], table["family"][rows], strict=True)]
        inside, weight = 0.0, np.array([1.0 / family.count(name) for name in family])
        for name in dict.fromkeys(family):
            own = np.array([one == name for one in family])
            found = np.linalg.lstsq(x[~own], y[~own], rcond=None)[0]
            seen = x[~own] * np.sqrt(weight[~own])[:, None]
            wide = np.sqrt(1.0 + (np.linalg.lstsq(seen.T, x[own].T, rcond=None)[0] ** 2).sum(axis=0))
            left = (y[own] - x[own] @ found) / wide
            for edge in (-1e-5, 1e-5):  # those that lie on an end, as variants of one winding do together, count half
                inside += np.count_nonzero((left >= law.band[0] - edge) & (left <= law.band[1] + edge)) / 2
        assert 0.86 <= inside / len(y) <= 0.94, law.law


def made(count: int, spread: float = 0.0, makers: int = 1) -> Table:
    """Brushed motors that obey J = 3e-3 m^1.5 d^0.5 but for a scatter that alternates, five to a family."""
    rng = np.random.default_rng(1)
    mass, diameter = np.exp(rng.uniform(-3, 1, count)), np.exp(rng.uniform(-4.5, -2.5, count))
    inertia = 3e-3 * mass**1.5 * diameter**0.5 * np.exp(spread * (-1.0) ** np.arange(count))
    empty = load(["maxon"]).motors
    columns = {
        name: np.full(count, np.nan) if v.dtype.kind == "f" else np.full(count, "") for name, v in empty.columns.items()
    }
    columns |= {
        "part": np.array([f"p{i}" for i in range(count)]),
        "manufacturer": np.array([f"maker {i // 5 % makers}" for i in range(count)]),
        "family": np.array([f"family {i // 5}" for i in range(count)]),
        "kind": np.full(count, "brushed"),
        "mass": mass, "diameter": diameter, "rotor_inertia": inertia,
    }  # fmt: skip
    return Table("motors", columns, np.zeros(count, np.int32), np.zeros(count, bool))


LAW = Law("motors", "brushed", "rotor_inertia", ("mass", "diameter"))


def test_a_law_that_holds_is_found():
    found = fit(LAW, made(40))
    assert found is not None
    assert found.coefficients == pytest.approx((log(3e-3), 1.5, 0.5), rel=1e-9)
    assert found.band == pytest.approx((0.0, 0.0), abs=1e-9)
    assert (found.parts, found.families, found.makers, found.other_makers) == (40, 8, ("maker 0",), None)


def test_the_band_is_the_scatter():
    found = fit(LAW, made(400, spread=0.2, makers=4))
    assert found is not None and found.other_makers is not None
    assert found.band == pytest.approx((-0.2, 0.2), abs=0.04)
    assert found.other_makers == pytest.approx((-0.2, 0.2), abs=0.04)


def test_few_parts_or_families_make_no_law():
    assert fit(LAW, made(29)) is None
    table = made(40)
    assert fit(LAW, replace(table, columns={**table.columns, "family": np.full(40, "one")})) is None


def test_what_is_left_out_does_not_shape_its_own_estimate():
    """One family is ten times off: its residual is ln 10 whole, since the rest lies on the law."""
    table = made(40)
    y, x = (
        np.log(table["rotor_inertia"]),
        np.column_stack([np.ones(40), np.log(table["mass"]), np.log(table["diameter"])]),
    )
    y[:5] += log(10.0)
    assert left_out(x, y, table["family"])[:5] == pytest.approx(np.full(5, log(10.0)), rel=1e-9)


def test_a_printed_figure_wins_and_an_unknown_one_is_estimated(everything):
    """RE 25 118752 prints its inertia; without it, the estimate is what the kept law says of 130 g and 25 mm."""
    motors = everything.motors
    row = motors.rows["118752"]
    assert "rotor_inertia" not in [e.figure for e in estimates_of(motors, row)]
    columns = {name: values[row : row + 1].copy() for name, values in motors.columns.items()}
    columns["rotor_inertia"][0] = np.nan
    found = estimates(Table("motors", columns, motors.source[:1], motors.excluded[:1]))["rotor_inertia"]
    by = shipped_laws()[found.fit[0]]
    known = {"mass": 0.13, "diameter": 0.025, "motor_constant": 0.0234**2 / 2.32, "length": 0.0545}
    terms = sum(b * log(known[name]) for b, name in zip(by.coefficients[1:], by.law.terms, strict=True))
    assert found.value[0] == pytest.approx(exp(by.coefficients[0] + terms), rel=2e-3)
    assert by.peers is not None
    wide = widening(by.peers, np.array([[log(known[name]) for name in by.law.terms]])).item()
    assert 1.0 < wide < 1.1  # in the midst of its peers
    assert found.low[0] / found.value[0] == pytest.approx(exp(wide * by.band[0]), rel=1e-3)


def test_distance_from_the_peers_widens_the_band():
    """Ordinary regression y = a + b x: the interval of prediction grows by 1 + 1/n + (x - mean)^2 / sum of squares."""
    law, table = Law("motors", "brushed", "rotor_inertia", ("mass",)), made(40, spread=0.2)
    table = replace(table, columns={**table.columns, "family": np.array([f"family {i}" for i in range(40)])})
    found = fit(law, table)
    assert found is not None and found.peers is not None
    x = np.log(table["mass"])
    for away in (0.0, 3.0):
        expected = 1.0 + 1.0 / 40 + away**2 / np.square(x - x.mean()).sum()
        assert widening(found.peers, np.array([[x.mean() + away]])) ** 2 == pytest.approx(expected, rel=1e-9)


def test_inertia_of_a_motor_wide_for_its_mass_goes_with_its_diameter():
    """A Jameco motor of 54 g, 30 mm wide where coreless motors of that mass have 22: J as mass times diameter squared.

    Its authors state 5.7 and 8.5 g*cm^2 of two; without its diameter it would have that of its slimmer peers.
    """
    catalog = load(["docs/measured_parts.yaml"], beside=Path(__file__).parents[2])
    row = catalog.motors.rows["Jameco sheet"]
    wide = {one.figure: one for one in estimates_of(catalog.motors, row)}["rotor_inertia"]
    slim = catalog.motors.changed({"diameter": np.full(len(catalog.motors), np.nan)})
    slim = {one.figure: one for one in estimates_of(slim, row)}["rotor_inertia"]
    assert "diameter" in wide.fit.law.terms and "diameter" not in slim.fit.law.terms
    assert wide.low < 5.7e-7 and wide.high > 8.5e-7 and slim.high < 5.7e-7
    assert wide.value / slim.value == pytest.approx((30.0 / 22.0) ** 2, rel=0.15)


def test_a_part_far_from_all_that_were_fitted_is_not_estimated():
    """A motor of 3 t is no peer of motors up to 20 kg."""
    table = made(1)
    heavy = {**table.columns, "mass": np.array([3000.0]), "rotor_inertia": np.array([np.nan])}
    assert "rotor_inertia" not in estimates(replace(table, columns=heavy))


def test_a_servo_whose_winding_is_not_printed_needs_the_voltage_of_its_constant():
    """SGM7J-C2A, 0.262 N*m/A: 558 rad/s make 146 V in it whatever its resistance, more than a battery of 12 V."""
    spec = {
        "name": "wheels of a robot",
        "load": {"kind": "flywheel", "inertia": "1 kg*cm^2"},
        "motion": {"profile": "trapezoid", "speed": "5329 rpm", "acceleration_time": "0.6 s", "cruise_time": "1 s"},
        "transmission": [{"kind": "direct"}],
        "supply": {"nominal": "12 V", "accepts": "all"},
        "select": {"catalogs": ["yaskawa"], "motor": {"part": "SGM7J-C2A"}},
    }
    (drive,) = explain(load_spec(spec), "SGM7J-C2A", "direct")
    (volts,) = (check for check in drive.own_checks if check.name == "supply_voltage")
    assert volts.status == "fail" and volts.demand > 0.262 * 558.0
