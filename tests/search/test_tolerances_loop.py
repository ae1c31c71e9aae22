"""Samples in closed loop: the batch is what each machine does alone, and at nominal figures what validation says."""

from __future__ import annotations

import numpy as np
import pytest

from drivesizer.control.closed_loop import run
from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases.platform import motion_of
from drivesizer.results.drive_set import DriveSet
from drivesizer.search.uncertainty import sampled_closed_loop
from drivesizer.search.uncertainty.options import Sampling
from drivesizer.search.uncertainty.sampling import sample
from drivesizer.search.uncertainty.uncertain_figures import assumptions
from drivesizer.sizing import size
from drivesizer.spec.robot import RobotSpec, read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

ARM = """
name: arm
load: {kind: arm, mass: 1.5 kg +- 0.2 kg, length: 200 mm}
motion: {profile: triangle, distance: 60 deg, time: 1.2 s, rest_time: 2 s, there_and_back: true}
supply: {nominal: 24 V, regeneration: 50 %}
margins: {torque: 80 %, speed: 20 %, temperature: 80 %}
select: {motor: {part: DCX22L01EBKL570}, controller: {part: "409510"}}
"""


@pytest.fixture(scope="module")
def arm() -> tuple[RobotSpec, DriveSet]:
    """An arm whose weight goes round with it: each mass is a task of its own."""
    spec = read_spec(YamlSource(ARM, "arm.yaml"))
    result = size(spec, top=1, sampling=Sampling(64, 1, None))
    return result.spec, result.sets[0]


@pytest.mark.slow
def test_the_share_is_that_of_what_fails(arm: tuple[RobotSpec, DriveSet]) -> None:
    """A supply that is far too low in half of all machines: the voltage fails there, and nowhere else."""
    spec, one = arm
    given = assumptions(spec)
    whole = sampled_closed_loop.loop_share(spec, one, given, sample(given, 64, 1), 8)
    assert whole and whole.probability == 1.0 and whole.samples == 8
    text = ARM.replace("nominal: 24 V", "nominal: 24 V, min: uniform(1 V; 24 V)")
    low = read_spec(YamlSource(text, "arm.yaml"))
    uncertain = assumptions(low)
    asked = run(spec, one, motion_of(spec)).required("voltage_demand")
    assert one.controller
    needed = asked / one.controller.max_duty + one.controller.voltage_drop
    values = sample(uncertain, 32, 1)
    found = sampled_closed_loop.loop_share(low, one, uncertain, values, 32)
    supply = values[:, [a.name for a in uncertain].index("supply.min")]
    assert found and found.weakest in ("Motor voltage", "Tracking error")  # what does not suffice is not followed
    assert found.probability == pytest.approx(np.mean(supply > needed), abs=0.15)


def test_factors_reach_the_parts(arm: tuple[RobotSpec, DriveSet]) -> None:
    spec, one = arm
    given = assumptions(spec)
    values = np.array([a.nominal for a in given])
    names = [a.name for a in given]
    values[names.index("motor.torque_constant")], values[names.index("gearhead.efficiency")] = 1.1, 1.5
    _, other = sampled_closed_loop.deviating(spec, one, given, values)
    assert other.motor.torque_constant == pytest.approx(1.1 * one.motor.torque_constant)
    assert other.motor.no_load_current * other.motor.torque_constant == pytest.approx(
        one.motor.no_load_current * one.motor.torque_constant
    )
    e = one.gearhead.efficiency
    assert 1 / other.gearhead.efficiency - 1 == pytest.approx(1.5 * (1 / e - 1))
