"""Drives over a long cycle, by its kinds of segments, against the same of a short one: every figure and verdict."""

from __future__ import annotations

import numpy as np
import pytest
from specs import poorer

from drivesizer.files.yaml_source import YamlSource
from drivesizer.machine.problem import problem
from drivesizer.physics import cycle_at_gearhead
from drivesizer.search.columns.candidates import candidates
from drivesizer.search.columns.evaluation import evaluate
from drivesizer.spec.robot import read_spec

SUPPLIES = {
    "all is accepted": "{nominal: 24 V, min: 22 V, max: 26 V, current: 8 A}",
    "nothing is accepted": "{nominal: 24 V, min: 22 V, max: 26 V, regeneration: 0, power: 150 W}",
    "a part stays in a capacitance": "{nominal: 36 V, min: 30 V, max: 38 V, regeneration: 0.4, capacitance: 20 mF}",
    "with a resistance": "{nominal: 24 V, min: 22 V, max: 26 V, resistance: 0.3 ohm, current: 9 A, regeneration: 0}",
}
MORE = {
    "with a resistance": "power_stage: {resistance: 20 mohm}\n",
    "nothing is accepted": "select: {catalogs: [maxon], estimates: off}\n",
}


@pytest.fixture(scope="module")
def catalog(catalog):
    return poorer(catalog)


def recording(rng, count, torque):
    """Noise on a to and fro, with a rest at a constant torque, a long one, and speeds of either sign."""
    time = np.cumsum(rng.uniform(0.02, 0.6, count))
    time[count // 2 :] += 900.0
    speed = 9.0 * np.sin(time / 3.0) + rng.normal(size=count)
    load = torque * (np.cos(time / 3.0) + 0.6 * np.sign(speed)) + 0.2 * torque * rng.normal(size=count)
    rest = slice(count // 2 - 9, count // 2 + 2)
    speed[rest], load[rest] = 0.0, 0.3 * torque
    rows = "".join(f"{a!r},{b!r},{c!r}\n" for a, b, c in np.array([time, speed, load]).T.tolist())
    return f"time,speed,torque\ns,rad/s,N*m\n{rows}"


def problem_of(folder, catalog, supply, seed, torque):
    (folder / "x.csv").write_text(recording(np.random.default_rng(seed), 400, torque), encoding="utf-8")
    text = f"""
name: x
load: {{kind: recorded, file: x.csv, inertia: 3 kg*cm^2}}
transmission: [{{kind: gearhead}}, {{kind: belt, ratios: [0.8, 1.7], efficiency: 0.93}}]
supply: {SUPPLIES[supply]}
environment: {{ambient: 31 degC}}
{MORE.get(supply, "")}"""
    return problem(read_spec(YamlSource(text, str(folder / "x.yaml"))), catalog)


def some(given, count, seed):
    """Random candidates, a fifth of them with motors of which no thermal figures are known."""
    every, rng = candidates(given), np.random.default_rng(seed)
    unknown = np.flatnonzero(np.isnan(given.catalog.motors["winding_time_constant"][every.motor]))
    rows = rng.integers(0, len(every.motor), count)
    rows[: count // 5] = rng.choice(unknown, count // 5)
    return every.on(rows)


@pytest.mark.parametrize("supply", SUPPLIES)
@pytest.mark.parametrize(("seed", "torque"), [(1, 0.4), (2, 4.0)])
def test_a_long_cycle_has_the_figures_of_a_short_one(supply, seed, torque, catalog, tmp_path, monkeypatch):
    given = problem_of(tmp_path, catalog, supply, seed, torque)
    sets = some(given, 120, seed)
    whole = evaluate(given, sets)
    monkeypatch.setattr(cycle_at_gearhead, "_PART", 10)
    given = problem_of(tmp_path, catalog, supply, seed, torque)
    passed = evaluate(given, sets)
    known = 0
    for name, column in whole.figures.items():
        np.testing.assert_allclose(passed.figures[name], column, rtol=1e-9, atol=1e-12, err_msg=name)
        known += np.count_nonzero(np.isfinite(column))
    assert known > 200
    for one, other in zip(whole.checks, passed.checks, strict=True):
        assert one.name == other.name
        np.testing.assert_array_equal(one.passed, other.passed, err_msg=one.name)
        np.testing.assert_array_equal(one.failed, other.failed, err_msg=one.name)
        stores = one.name == "bus_voltage"  # a difference of sums over the cycle, that has less digits
        for field in ("demand", "limit", "time"):
            mine, its = (getattr(check, field) for check in (one, other))
            if mine is not None:
                close = 1e-6 if stores else 1e-9
                np.testing.assert_allclose(its, mine, rtol=close, atol=1e-9, err_msg=f"{one.name} {field}")


def test_threads_change_nothing(catalog, tmp_path, monkeypatch):
    """One drive after the other, or several at once: to the last bit."""
    found = []
    for threads in ("1", "3", ""):
        monkeypatch.setenv("OMP_NUM_THREADS", threads)
        given = problem_of(tmp_path, catalog, "nothing is accepted", 2, 4.0)
        found.append(evaluate(given, some(given, 40, 2)).figures)
    for other in found[1:]:
        for name, column in found[0].items():
            np.testing.assert_array_equal(other[name], column, err_msg=name)


def test_the_cases_meet_what_is_rare(catalog, tmp_path):
    """Thermal runaway, unknown heat and time above the continuous current are among them."""
    given = problem_of(tmp_path, catalog, "nothing is accepted", 2, 4.0)
    checks = {check.name: check for check in evaluate(given, some(given, 120, 2)).checks}
    winding, above = checks["winding_temperature"], checks["controller_peak_time"].demand
    assert np.isinf(winding.demand).any()
    assert (~winding.passed & ~winding.failed).any()
    assert ((above > 0.0) & (above < 100.0)).any()
