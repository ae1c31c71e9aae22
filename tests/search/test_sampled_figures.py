"""Percentiles of figures over samples: against the plain evaluation of single samples, and against ``predict``."""

from __future__ import annotations

from dataclasses import replace
from math import nan

import numpy as np
import pytest
from sampled_plainly import evaluated, machine_of

from drivesizer import size
from drivesizer.catalog import load
from drivesizer.catalog.query import PartRow
from drivesizer.files.yaml_source import read
from drivesizer.machine.problem import problem
from drivesizer.prediction.predict import predict
from drivesizer.results.prediction import Conditions
from drivesizer.search.uncertainty.probabilities import figure_spreads
from drivesizer.search.uncertainty.sampled_drive import SetRows, blocks, figure_columns, prepared
from drivesizer.search.uncertainty.sampling import sample
from drivesizer.search.uncertainty.uncertain_figures import assumptions, classes_in_use
from drivesizer.spec.robot import read_spec

PARTS = {"motors": "148877", "gearheads": "260551", "controllers": "409510"}  # RE 40, GP 42 C, ESCON 50/5
CART = """
name: cart
load: {kind: wheeled_vehicle, mass: 60 kg +- 8 kg, driven_wheels: 2, wheel_diameter: 150 mm,
       rolling_resistance: 0.02 in 0.015..0.03, inertia: 25 kg*cm^2}
motion: {speed: 1.2 m/s, acceleration_time: 1.5 s, cruise_time: 60 s, rest_time: 10 s}
supply: {nominal: 24 V, min: normal(22 V; 0.3 V), current: 20 A, regeneration: 0.5, accepts: all}
select: {catalogs: [maxon], motor: {part: '148877'}, gearhead: {part: '260551'}, controller: {part: '409510'}}
"""
ARM = """
name: gripper
load: {kind: arm, mass: 0.5 kg +- 0.05 kg, length: 300 mm}
motion: {profile: hold, time: 1 h}
supply: {nominal: 24 V}
select: {catalogs: [maxon], motor: {part: '148877'}, gearhead: {part: '260551'}, controller: {part: '409510'}}
"""


@pytest.fixture(scope="module")
def spec_of(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sampled")

    def of(text):
        (folder / "robot.yaml").write_text(text, encoding="utf-8")
        return read_spec(read(folder / "robot.yaml"))

    return of


@pytest.fixture(scope="module")
def sampled():
    """A spec with its samples, and the rows of the drive."""
    catalog = load(["maxon"])
    rows = [catalog.table(section).rows[part] for section, part in PARTS.items()]

    def of(spec, count, catalog=catalog):
        given = assumptions(spec, classes_in_use(catalog, spec.tolerances.classes, [tuple(rows)]))
        drawn = sample(given, count, 1, assumptions(spec))
        return (prepared(problem(spec, catalog), given, drawn), catalog, SetRows(rows[0], rows[1], -1, rows[2], 1.0))

    return of


@pytest.mark.parametrize("text", [CART, ARM], ids=["cart", "held"])
def test_single_samples_are_what_the_plain_evaluation_says(spec_of, sampled, text):
    spec = spec_of(text)
    ready, catalog, one = sampled(spec, 64)
    (block,) = blocks(ready, catalog, [1.0])
    found = figure_columns(catalog, one, block)
    for row in (0, 13, 40, 63):
        plainly, _ = evaluated(spec, catalog, one, ready.assumptions, ready.values[row])
        alone = {name: float(column[0]) for name, column in plainly.figures.items()}
        checks = {check.name: float(check.demand[0]) for check in plainly.checks}
        for name in ("peak_current", "power", "joule_heat"):
            assert found[name][row] == pytest.approx(alone[name], rel=2e-3), name
        assert found["winding_temperature"][row] == pytest.approx(alone["winding_temperature"], rel=1e-3)
        assert found["voltage"][row] == pytest.approx(checks["supply_voltage"], rel=1e-3)
        assert found["rms_current"][row] == pytest.approx(checks["motor_nominal_current"], rel=1e-5)
        assert machine_of(spec, ready.assumptions, ready.values[row]).supply.nominal == 24.0


def test_at_full_voltage_as_predicted_of_the_same_set(spec_of, sampled):
    """``predict`` draws other points of the same classes; its voltage drop is that of the same controller.

    The gearhead's torque without load is given, for ``predict`` assumes one where it is not printed.
    """
    catalog = load(["maxon"])
    heads = catalog.gearheads
    idle = np.where(np.arange(len(heads)) == heads.rows[PARTS["gearheads"]], 2e-3, heads["no_load_torque"])
    catalog = replace(catalog, gearheads=replace(heads, columns=heads.columns | {"no_load_torque": idle}))
    ready, catalog, one = sampled(spec_of(CART), 4096, catalog)
    found = {x.name: x for x in figure_spreads(ready, catalog, one)}
    hits = [PartRow("maxon", catalog, section, catalog.table(section).rows[part]) for section, part in PARTS.items()]
    given = Conditions(voltage=24.0, ambient=298.15, load=1.0, hold=1.0, inertia=0.0, duration=3600.0, warm=nan,
                       resistance=0.0)  # fmt: skip
    bench = predict(*hits, given)
    for name in ("free_speed", "stall_torque"):
        band = bench.figure(name).band
        for quantile, value in (("p5", found[name].low), ("p50", found[name].middle), ("p95", found[name].high)):
            assert value == pytest.approx(getattr(band, quantile), rel=0.01), (name, quantile)


def test_percentiles_are_reported_of_the_drives_that_are_shown(spec_of):
    best = size(spec_of(CART)).sets[0]
    found = {x.name: x for x in best.reliability.figures}
    assert list(found)[:2] == ["rms_current", "peak_current"]
    assert all(x.low < x.middle < x.high for x in found.values())
    nominal = {x.name: x.value for x in best.figures}
    for name in ("peak_current", "power", "joule_heat", "winding_temperature"):
        assert found[name].low < nominal[name] < found[name].high
