"""Thin air: makers' printed factors, the same margins written by hand, and nothing below 1000 m."""

import math

import pytest
from refusals import refusal

from drivesizer.sizing import size
from drivesizer.spec.mounting import altitude_words, controller_needed, motor_needed, rise_left, rise_needed
from drivesizer.spec.robot import load_spec
from drivesizer.spec.sections import Environment

SPEC = {
    "name": "axis",
    "load": {"kind": "belt_axis", "mass": "6 kg", "pulley_diameter": "38.2 mm", "friction_force": "12 N"},
    "motion": {
        "profile": "triangle",
        "distance": "400 mm",
        "time": "0.8 s",
        "rest_time": "0.7 s",
        "there_and_back": True,
    },
    "supply": {"nominal": "48 V", "current": "15 A", "accepts": "all"},
    "select": {
        "catalogs": ["maxon"],
        "motor": {"family": "DCX 22 L"},
        "gearhead": {"family": "GPX 22 HP"},
        "estimates": "off",
    },
}


@pytest.mark.parametrize(("metres", "printed"), [(1000, 1.0), (2000, 0.95), (3000, 0.89), (4000, 0.84)])
def test_factors_of_siemens(metres, printed):
    """SIMOTICS S-1FK2, configuration manual A5E46927724B: torque at 40 °C by altitude."""
    left = rise_left(Environment(altitude=f"{metres} m"))
    assert math.sqrt(left) == pytest.approx(printed, abs=0.005)


@pytest.mark.parametrize(("metres", "factor"), [(2000, 0.90), (2500, 0.85), (3000, 0.80)])
def test_factors_of_abb(metres, factor):
    """ACS880-14, altitude derating: 1 % for every 100 m above 1000 m."""
    spec = load_spec(SPEC | {"environment": {"altitude": f"{metres} m"}})
    assert 1.0 / (1.0 + controller_needed(spec)) == pytest.approx(factor)


def limits(found):
    return {check.name: check for check in found.sets[0].checks}


def test_a_sizing_requires_more_of_what_is_hot():
    """Demands and limits are the same, margins required are those of the altitude beside those of the spec."""
    margins = {"torque": "2 %", "temperature": "1 %"}
    low, high = (load_spec(SPEC | {"margins": margins, "environment": {"altitude": h}}) for h in ("900 m", "2000 m"))
    assert (rise_needed(low), motor_needed(low), controller_needed(low)) == (0.01, 0.02, 0.02)
    one = size(low)
    part = one.sets[0].motor.part, one.sets[0].gearhead.part
    select = SPEC["select"] | {"motor": {"part": part[0]}, "gearhead": {"part": part[1]}}
    pinned = load_spec(SPEC | {"margins": margins, "environment": {"altitude": "2000 m"}, "select": select})
    shown = size(pinned)
    other = (*shown.sets, *shown.misses)[0]
    before, after = limits(one), {check.name: check for check in other.checks}
    wanted = {"winding_temperature": 1.01 / 0.9, "motor_nominal_current": 1.02 / math.sqrt(0.9),
              "controller_continuous_current": 1.02 / 0.9}  # fmt: skip
    for name, check in before.items():
        if name in after and after[name].limit == check.limit:
            assert 1.0 + after[name].needed == pytest.approx(wanted.get(name, 1.0 + check.needed)), name
    assert after["motor_nominal_current"].demand == before["motor_nominal_current"].demand
    assert after["motor_nominal_current"].limit == before["motor_nominal_current"].limit
    assert [line for line in shown.assumptions if "2000 m" in line] == list(altitude_words(high))
    assert not altitude_words(low)


def test_thin_air_lets_drives_fail_and_nothing_else():
    counts = [size(load_spec(SPEC | {"environment": {"altitude": h}})).counts for h in ("1000 m", "4000 m")]
    assert 0 < counts[1].feasible < counts[0].feasible
    raised = {name for name, n in counts[1].failed_by.items() if n > counts[0].failed_by.get(name, 0)}
    assert raised and raised <= {"winding_temperature", "motor_nominal_current", "controller_continuous_current"}


@pytest.mark.parametrize("altitude", ["4100 m", "-600 m", "3"])
def test_refused_in_one_line(altitude):
    refusal(lambda: load_spec(SPEC | {"environment": {"altitude": altitude}}), match=r"environment\.altitude")
