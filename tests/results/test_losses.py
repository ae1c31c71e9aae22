"""Words on what is assumed of a controller: there where an unprinted figure decides, nowhere else."""

import math

import pytest

from drivesizer.catalog import Controller
from drivesizer.results.drive_set import voltage_assumption
from drivesizer.spec.robot import load_spec

DROP = "the controller's voltage drop is not printed: 0.5 V to 1.1 V assumed"
DUTY = "the controller's largest duty is not printed: the supply's voltage is the bound"


@pytest.mark.parametrize(
    ("duty", "drop", "given", "said"),
    [
        (0.9, math.nan, {}, DROP),
        (0.9, 1.0, {}, ""),
        (0.9, math.nan, {"voltage_drop": "1 V"}, ""),
        (math.nan, 1.0, {}, DUTY),
        (math.nan, math.nan, {}, DUTY),
    ],
)
def test_the_usable_voltage(duty, drop, given, said):
    spec = load_spec({
        "name": "x", "load": {"kind": "flywheel", "inertia": "1 kg*m^2"}, "supply": {"nominal": "24 V"},
        "motion": {"speed": "60 rpm", "acceleration_time": "1 s", "cruise_time": "1 s"}, "power_stage": given,
    })  # fmt: skip
    assert voltage_assumption(spec, Controller(max_duty=duty, voltage_drop=drop)) == said
