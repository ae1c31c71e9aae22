"""A vehicle downhill and parked on a slope, by both methods: by hand from the printed equations, and by Newton."""

from __future__ import annotations

import math

import pytest

from drivesizer.files.yaml_source import YamlSource
from drivesizer.machine.problem import problem
from drivesizer.search.set_record import other_checks
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

SLOPE = math.radians(-10.0)
WEIGHT = 45 * 9.80665
NOM = 0.0762 * WEIGHT * (0.02 * math.cos(SLOPE) + math.sin(SLOPE)) / 0.95  # (3), (2)
WHEEL, SHAFT = 0.847768 / 2 * (0.0762**2 + 0.03**2), 7850 * math.pi * 0.006**2 * 0.08 / 2 * 0.006**2  # (8), (9)
ACC = (4 * (WHEEL + SHAFT + 10.8e-7) + 45 / 0.9 * 0.1524**2 / 4) * (2 * 0.75 / 0.1524) * 1.2  # (10)
BRAKING = (ACC - NOM) / 4  # |(12)| at one wheel
CHAIN = 3249 / 121 * 0.8 * 1.1 * 0.95  # (18), the belt with it


@pytest.fixture(scope="module")
def downhill(example_text):
    text = example_text.replace("slope: 0 deg", "slope: -10 deg").replace("rest_time: 0 s", "rest_time: 60 s")
    return read_spec(YamlSource(text, "robot.yaml"))


@pytest.fixture(scope="module")
def found(downhill, catalog):
    (one,) = explain(downhill, "118752", "406764", catalog=catalog)
    return one


def test_the_paper_compares_the_torque_that_brakes(found):
    """M_max = M_nom + M_acc is -0.5 N·m here; a motor, a gearhead and a controller bear |M_dec| = 2.2 N·m."""
    checks = {check.name: check for check in found.checks if check.method == "paper"}
    assert -(NOM + ACC) / 4 < BRAKING / 3
    assert checks["gearhead_intermittent_torque"].demand == pytest.approx(BRAKING / 1.1 / 0.95, rel=1e-6)
    assert checks["motor_maximum_torque"].demand == pytest.approx(BRAKING / CHAIN, rel=1e-6)
    current = BRAKING / CHAIN / found.motor.torque_constant + found.motor.no_load_current
    assert checks["controller_peak_current"].demand == pytest.approx(current, rel=1e-6)
    assert all(check.demand >= 0.0 for check in checks.values() if not math.isnan(check.demand))


def test_the_paper_counts_the_torque_that_holds_at_rest(found):
    rest = WEIGHT * math.sin(SLOPE) * 0.0762
    squares = 2 * (NOM + ACC) ** 2 + 240 * NOM**2 + 2 * (NOM - ACC) ** 2 + 60 * rest**2
    rms = math.sqrt(squares / 304) / 4
    checks = {check.name: check for check in found.checks}
    assert checks["gearhead_continuous_torque"].demand == pytest.approx(rms / 1.1 / 0.95, rel=1e-6)
    assert checks["motor_continuous_torque"].demand == pytest.approx(rms / CHAIN, rel=1e-6)


def test_the_speed_constant_serves_the_end_of_acceleration_and_the_start_of_braking(found):
    n = 1.5 / 0.0762 / 0.9 * 3249 / 121 * 1.1
    tau = found.motor.speed_torque_gradient
    most = max(abs(n + tau * (NOM + ACC) / 4 / CHAIN), abs(n - tau * BRAKING / CHAIN))
    check = next(check for check in found.checks if check.name == "speed_constant")
    assert check.demand == pytest.approx(most / found.motor.nominal_voltage, rel=1e-6)


def test_requirements_are_those_of_the_method(downhill, catalog):
    """By physics: Newton's second law at one wheel, no factor of the paper, the larger magnitude."""
    spec = downhill.model_copy(update={"method": "physics"})
    result = size(spec, catalog=catalog, top=1)
    of = {r.name: r for r in result.requirements}
    inertia = WHEEL + SHAFT + 45 * 0.0762**2 / 4
    level = WEIGHT * (0.02 * math.cos(SLOPE) + math.sin(SLOPE)) * 0.0762 / 4
    start, brake = level + inertia * 0.75 / 0.0762, level - inertia * 0.75 / 0.0762
    assert of["maximum_torque_per_motor"].value == pytest.approx(abs(brake), rel=1e-5)
    rest = WEIGHT * math.sin(SLOPE) * 0.0762 / 4
    rms = math.sqrt((2 * start**2 + 240 * level**2 + 2 * brake**2 + 60 * rest**2) / 304)
    assert of["rms_torque_per_motor"].value == pytest.approx(rms, rel=1e-5)
    assert of["nominal_speed"].value == pytest.approx(1.5 / 0.0762)
    assert not any(r.equation for r in (*result.requirements, *result.reported.requirements))
    assert {check.method for check in other_checks(problem(spec, catalog), result.reported)} == {"paper"}
