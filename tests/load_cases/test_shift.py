"""Load cases that alternate: shares of the time by hand, and what they do to heat, energy and the battery."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from refusals import refusal

from drivesizer.errors import InputError
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.of_machine import counts, cycle_of_shift
from drivesizer.machine.problem import problem
from drivesizer.physics.load_cycle import rms
from drivesizer.search.shortlist import load_parts
from drivesizer.simulate import hardest_case, validate
from drivesizer.sizing import explain
from drivesizer.spec.robot import RobotSpec, load_spec

RAMP: dict[str, Any] = {"name": "up the ramp", "load": {"slope": "5 %"}}


def robot(*cases: dict[str, Any], **sections: Any) -> RobotSpec:
    given = {
        "name": "robot",
        "load": {"kind": "wheeled_vehicle", "mass": "200 kg", "driven_wheels": 2, "wheel_diameter": "150 mm",
                 "rolling_resistance": "2 %", "inertia": "25 kg*cm^2"},
        "motion": {"speed": "1.2 m/s", "acceleration_time": "1.5 s", "cruise_time": "20 s", "rest_time": "10 s"},
        "supply": {"nominal": "24 V", "min": "21 V", "max": "29 V", "accepts": "all"},
        "select": {"motor": {"part": "305013"}, "gearhead": {"part": "326664"}},
        "cases": list(cases),
    }  # fmt: skip
    return load_spec({**given, **sections})


def test_blocks_come_as_often_as_their_shares_say() -> None:
    assert counts([0.9, 0.1], [30.0, 30.0]) == [9, 1]
    assert counts([0.75, 0.25], [10.0, 20.0]) == [6, 1]
    times, shares = [33.0, 33.0, 7.0], [0.83, 0.12, 0.05]
    found = np.array(counts(shares, times)) * times
    assert found / found.sum() == pytest.approx(shares, rel=0.01)


@pytest.mark.parametrize(("share", "lasting"), [("10 %", None), ("25 %", "5 min")])
def test_the_mean_square_of_a_shift_is_that_of_its_shares(share: str, lasting: str | None) -> None:
    """By hand: T_rms^2 = (1 - s) T_flat^2 + s T_ramp^2, the largest torque that of the ramp."""
    case = RAMP | {"share": share} | ({"lasting": lasting} if lasting else {})
    spec = robot(case)
    flat, ramp = load_cycle(robot()), load_cycle(robot(RAMP).load_cases[1][1])
    whole, s = cycle_of_shift(spec), float(share.split()[0]) / 100.0
    squares = [rms(cycle.duration, cycle.torque) ** 2 for cycle in (flat, ramp)]
    assert rms(whole.duration, whole.torque) ** 2 == pytest.approx((1 - s) * squares[0] + s * squares[1], rel=0.01)
    assert np.abs(whole.torque).max() == np.abs(ramp.torque).max()
    if lasting:
        assert whole.total >= 5 * 60 / s * 0.95


def test_heat_and_battery_count_a_ramp_by_its_share() -> None:
    """The mean power from the battery lies between flat and ramp by the share; as a whole shift it fails to last."""
    battery = {"series": 2, "parallel": 2, "chemistry": "lead-acid", "nominal_voltage": "12 V", "capacity": "40 A*h",
               "rated_time": "20 h", "peukert_exponent": 1.2, "autonomy": "4 h", "resistance": "10 mohm",
               "cutoff_voltage": "10.5 V", "charge_voltage": "14.4 V",
               "open_circuit": {"full": "12.9 V", "empty": "11.7 V"}}  # fmt: skip

    def mean(*cases: dict[str, Any], ramp: bool = False) -> float:
        load = {"slope": "5 %"} if ramp else {}
        spec = robot(*cases, battery=battery)
        given = spec.model_copy(update={"load": robot(RAMP).load_cases[1][1].load}) if load else spec
        (one,) = explain(given, "305013", "326664")
        assert one.energy is not None
        return one.energy.mean_power

    flat, ramp, shift = mean(), mean(ramp=True), mean(RAMP | {"share": "10 %"})
    assert shift == pytest.approx(0.9 * flat + 0.1 * ramp, rel=0.01)
    assert flat < shift < ramp


def test_a_case_with_a_share_is_simulated_for_its_peaks() -> None:
    """The ramp alone has too much continuous current; by its share the whole shift has not, and its peaks count."""
    spec = robot(RAMP | {"share": "10 %"}, control={"rate": "1 kHz"})
    (drive,) = explain(spec, "305013", "326664")
    assert hardest_case(spec, drive) == "up the ramp"  # the largest torque of the shift
    alone, shared = (
        {check.name: check for check in validate(one, drive, load_case="up the ramp").checks}
        for one in (robot(RAMP, control={"rate": "1 kHz"}), spec)
    )
    lasting = {"motor_nominal_current", "winding_temperature", "gearhead_continuous_torque"}
    assert {name for name in lasting if alone[name].advice} == set()
    assert {name for name in lasting if shared[name].advice} == lasting
    assert not shared["gearhead_intermittent_torque"].advice
    for name, check in shared.items():  # as much as alone, judged otherwise
        assert check.demand == pytest.approx(alone[name].demand, nan_ok=True)


@pytest.mark.parametrize(
    ("cases", "said"),
    [
        ([RAMP | {"lasting": "5 min"}], "it is of a case with a share of the time"),
        ([RAMP | {"share": "60 %"}, RAMP | {"name": "b", "share": "50 %"}], "their shares are 110 % together"),
        ([RAMP | {"share": "120 %"}], "at most 0.99"),
        ([{"name": "cold", "share": "10 %", "environment": {"ambient": "-10 degC"}}], "keeps supply and environment"),
    ],
)
def test_shares_that_cannot_be_are_one_line(cases: list[dict[str, Any]], said: str) -> None:
    assert said in refusal(lambda: robot(*cases))


def test_what_alternates_takes_no_tolerance() -> None:
    with pytest.raises(InputError, match="cases that alternate by their shares are at nominal figures"):
        robot(RAMP | {"share": "10 % +- 1 %"})


# --- a brake that closes at rest --------------------------------------------------------------------------------------

LIFT: dict[str, Any] = {
    "name": "lift",
    "load": {"kind": "hoist", "mass": "20 kg", "drum_diameter": "60 mm"},
    "motion": {"speed": "0.2 m/s", "acceleration_time": "0.3 s", "cruise_time": "2 s", "rest_time": "10 s",
               "there_and_back": True},
    "supply": {"nominal": "24 V", "accepts": "all"},
    "needs": {"hold_unpowered": True},
    "select": {"motor": {"part": "309756"}, "gearhead": {"part": "326668"}},
}  # fmt: skip


def test_a_brake_that_closes_at_rest_takes_the_load_and_its_own_power_there() -> None:
    """By hand: of a cycle of 25.2 s the motor turns for 5.2 s; it holds m g d/2 / (i) through the rests, or nothing."""
    held, braked = (
        explain(load_spec(LIFT | more), "309756", "326668")[0] for more in ({}, {"control": {"at_rest": "brake"}})
    )
    current = [next(c.demand for c in one.checks if c.name == "motor_nominal_current") for one in (held, braked)]
    at_rest = 20 * 9.80665 * 0.03 / held.gearhead.ratio / held.motor.torque_constant
    assert current[0] ** 2 - current[1] ** 2 == pytest.approx(at_rest**2 * 20.0 / 25.2, rel=1e-3)
    holding = [next(c.demand for c in one.checks if c.name == "holding") for one in (held, braked)]
    assert holding[0] == holding[1] > 0.0
    released = problem(load_spec(LIFT | {"control": {"at_rest": "brake"}}), load_parts(load_spec(LIFT))).spec
    assert released.brake_released == pytest.approx(5.2 / 25.2)
