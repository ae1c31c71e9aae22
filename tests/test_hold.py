"""A motion of rest: a load that is held sizes as any other, against closed forms and against ``predict``."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
import yaml

from drivesizer import explain, size, validate
from drivesizer.catalog.query import find, open_catalogs
from drivesizer.files.yaml_source import read
from drivesizer.kernel.warming import State
from drivesizer.prediction.set_at_voltage import (
    Heating,
    hold_current,
    hottest_phase,
    in_the_long_run,
    over_time,
    sampled_parts,
    set_at_voltage,
)
from drivesizer.results.prediction import Conditions
from drivesizer.spec.robot import read_spec

HOLD = {"profile": "hold", "time": "60 min"}
ARM = {
    "name": "gripper", "load": {"kind": "arm", "mass": "2.5 kg", "length": "300 mm", "friction_torque": "0.3 N*m"},
    "motion": HOLD, "supply": {"nominal": "24 V"}, "select": {"catalogs": ["maxon"], "objective": "mass"},
}  # fmt: skip
TORQUE = 2.5 * 9.80665 * 0.3


@pytest.fixture(scope="module")
def spec(tmp_path_factory):
    folder = tmp_path_factory.mktemp("held")
    (folder / "still.csv").write_text("time,speed\ns,deg/s\n0,0\n3600,0\n", encoding="utf-8")

    def of(**changes):
        (folder / "robot.yaml").write_text(yaml.safe_dump(ARM | changes), encoding="utf-8")
        return read_spec(read(folder / "robot.yaml"))

    return of


@pytest.fixture(scope="module")
def sizing(spec):
    return size(spec())


def figure(one, name):
    return next(x.value for x in one.figures if x.name == name)


def check(one, name):
    return next(x for x in one.checks if x.name == name)


def test_torque_current_and_temperature_by_closed_forms(sizing):
    """I = T/(i k_t); in the long run the winding carries off R(T) I^2 through both resistances."""
    best = sizing.sets[0]
    motor, gearhead = best.motor, best.gearhead
    current = TORQUE / (gearhead.ratio * motor.torque_constant)
    assert check(best, "motor_nominal_current").demand == pytest.approx(current, rel=1e-12)
    assert check(best, "controller_peak_current").demand == pytest.approx(current, rel=1e-12)
    assert check(best, "gearhead_continuous_torque").demand == pytest.approx(TORQUE, rel=1e-12)
    assert check(best, "gearhead_continuous_speed").demand == 0.0
    kelvin = 0.0
    for _ in range(200):
        loss = motor.resistance * (1.0 + 0.0039 * kelvin) * current**2
        kelvin = (motor.thermal_resistance_winding + motor.thermal_resistance_housing) * loss
    assert check(best, "winding_temperature").demand == pytest.approx(298.15 + kelvin, rel=1e-4)
    assert figure(best, "joule_heat") == pytest.approx(loss, rel=2e-3)
    assert figure(best, "energy") == pytest.approx(3600.0 * figure(best, "power"), rel=0.02)


@pytest.mark.parametrize("kind", ["brushed", "brushless"])
def test_as_at_the_bench(spec, run, kind):
    """From cold, and in the long run, as the two solvers of ``predict --hold`` have it where friction carries nothing.

    At the bench friction and gear loss carry any part of the torque: what is printed is within its percentiles.
    """
    best = size(spec(select={"catalogs": ["maxon"], "objective": "mass", "motor": {"kind": kind}})).sets[0]
    status, out, _ = run(
        "predict", best.motor.part, "--gearhead", best.gearhead.part, "--catalog", "maxon", "--hold",
        f"{TORQUE!r} N*m", "--load", "0.1 N*m", "--json",
    )  # fmt: skip
    assert status == 0
    bands = {x["name"]: x["band"] for x in json.loads(out)["figures"]}
    assert bands["hold_current"]["p5"] < figure(best, "peak_current") < bands["hold_current"]["p95"]

    shelf = open_catalogs(["maxon"])
    motor, gearhead = (find(shelf, part)[0] for part in (best.motor.part, best.gearhead.part))
    parts = sampled_parts(motor, gearhead, None, 2)
    given = Conditions(
        voltage=24.0, ambient=298.15, load=0.1, hold=TORQUE, inertia=0.0, duration=3600.0, warm=math.nan, resistance=0.0
    )
    bench = set_at_voltage(parts, given)
    held = hold_current(bench, parts, TORQUE)
    assert figure(best, "peak_current") == pytest.approx(held[0], rel=1e-6)  # figures as printed are the first
    heating = Heating(hottest_phase(bench, parts), 298.15, lambda _: (held, np.zeros_like(held)))
    cold = float(over_time(heating, State(298.15, 298.15), np.linspace(0.0, 3600.0, 121))[0][-1][0])
    settled = float(in_the_long_run(heating)[0][0])
    assert best.motor.kind == kind
    if kind == "brushed":
        assert figure(best, "hold_winding_cold") == pytest.approx(cold, abs=0.1)
        assert check(best, "winding_temperature").demand == pytest.approx(settled, abs=0.1)
    else:  # there the hottest phase at the middle of its band: between the mean and twice the heat
        low, high = (check(best, name).demand for name in ("winding_temperature", "hottest_phase"))
        assert low < settled < high
    assert 25.0 < figure(best, "hold_housing_cold") - 273.15 < figure(best, "hold_housing") - 273.15


@pytest.mark.parametrize(("family", "kind"), [("RE 40", "brushed"), ("EC-4pole 30", "brushless")])
def test_the_hottest_phase_of_brushless_motors_is_advice(spec, family, kind):
    found = size(spec(select={"catalogs": ["maxon"], "motor": {"family": family}, "objective": "mass"}))
    assert found.sets
    for one in found.sets:
        hottest = [x for x in one.checks if x.name == "hottest_phase" and math.isfinite(x.limit)]
        assert one.motor.kind == kind and bool(hottest) == (kind == "brushless")
        assert all(x.advice and x.demand > check(one, "winding_temperature").demand for x in hottest)


@pytest.mark.parametrize("column", ["speed", "position"])
def test_a_recording_of_rest(tmp_path, run, column):
    """A press whose force changes while it stands."""
    unit = {"speed": "rpm", "position": "deg"}[column]
    rows = "".join(f"{t},{0 if column == 'speed' else 5},{T}\n" for t, T in ((0, 4), (1, 4), (2, 6), (3, 4)))
    (tmp_path / "run.csv").write_text(f"time,{column},torque\ns,{unit},N*m\n{rows}", encoding="utf-8")
    data = {"name": "press", "load": {"kind": "recorded", "file": "run.csv"}, "supply": {"nominal": "24 V"},
            "select": {"catalogs": ["maxon"], "objective": "margin", "motor": {"family": "RE 40"}}}  # fmt: skip
    (tmp_path / "robot.yaml").write_text(yaml.safe_dump(data), encoding="utf-8")
    status, out, _ = run("size", tmp_path / "robot.yaml", "--json")
    best = json.loads(out)["axes"][0]["result"]["sets"][0]
    checks = {x["name"]: x for x in best["checks"]}
    rms = math.sqrt((16.0 + 2.0 * (16.0 + 24.0 + 36.0) / 3.0) / 3.0)  # N*m
    assert status == 0 and checks["gearhead_continuous_torque"]["demand"] == pytest.approx(rms)
    assert checks["gearhead_intermittent_torque"]["demand"] == pytest.approx(6.0)


def test_one_load_case_stands_still_while_others_move(spec):
    swing = {"speed": "30 deg/s", "acceleration_time": "1 s", "cruise_time": "1 s", "there_and_back": True}
    found = size(spec(motion=swing, cases=[{"name": "held", "motion": HOLD}]))
    best = found.sets[0]
    alone = {"held": spec(), "as specified": spec(motion=swing)}
    alone = {name: explain(one, best.motor.part, best.gearhead.part)[0] for name, one in alone.items()}
    demand, case = max((check(one, "winding_temperature").demand, name) for name, one in alone.items())
    assert check(best, "winding_temperature").case == case
    assert check(best, "winding_temperature").demand == pytest.approx(demand, rel=1e-12)
    assert check(best, "motor_speed").case != "held"
    assert check(best, "gearhead_continuous_torque").demand >= TORQUE * (1.0 - 1e-12)
    assert math.isfinite(figure(best, "hold_winding_cold"))


def test_a_load_that_stands_without_torque_takes_any_drive(spec):
    """A cart on the level: every demand is 0, and nothing is unknown for it."""
    cart = {"kind": "wheeled_vehicle", "mass": "60 kg", "driven_wheels": 2, "wheel_diameter": "150 mm",
            "rolling_resistance": 0.02, "inertia": "25 kg*cm^2"}  # fmt: skip
    best = size(spec(load=cart)).sets[0]
    assert best.status == "pass"
    assert figure(best, "energy") == figure(best, "peak_current") == 0.0
    assert figure(best, "winding_temperature") == 298.15


def test_in_closed_loop_it_stays_where_it_is(spec, sizing):
    """Friction holds with the motor: no error, no more current than by size, and no share of a top speed of 0."""
    proof = validate(spec(motion=HOLD | {"time": "2 s"}), sizing.sets[0])
    assert proof.status == "pass"
    figures = {x.name: x.value for x in proof.figures}
    assert figures["tracking_error_peak"] == figures["position_error_peak"] == 0.0
    assert not [name for name in figures if name.endswith("_share")]
    checks = {x.name: x for x in proof.checks}
    assert "tracking_error" not in checks
    assert checks["gearhead_continuous_torque"].demand == pytest.approx(TORQUE)
    assert checks["motor_nominal_current"].demand <= figure(sizing.sets[0], "peak_current") * (1.0 + 1e-9)
    assert any(text.startswith("nothing moves") for text in proof.assumptions)
