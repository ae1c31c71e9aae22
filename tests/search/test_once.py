"""A motion that is run once from cold: its heat by integration, ratings that do not apply, cases beside a cycle."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drivesizer.catalog import load
from drivesizer.errors import InputError
from drivesizer.simulate import validate
from drivesizer.sizing import explain
from drivesizer.spec.robot import load_spec

AMBIENT = 298.15  # K
CLIMB = {
    "name": "climber", "load": {"kind": "hoist", "mass": "6 kg", "drum_diameter": "50 mm"},
    "motion": {"speed": "60 mm/s", "acceleration_time": "0.2 s", "cruise_time": "60 s"},
    "supply": {"nominal": "24 V"}, "once": True,
}  # fmt: skip
RE_25, GP_26 = "118752", "406767"


def checks(spec, catalog=None):
    (drive,) = explain(load_spec(spec), RE_25, GP_26, catalog=catalog)
    return {one.name: one for one in drive.checks}


def test_the_winding_warms_from_cold_as_its_two_bodies_do():
    """Held for 90 s at constant current: R(T) I² into the winding, over R_th1 into the housing, over R_th2 away."""
    held = {**CLIMB, "motion": {"profile": "hold", "time": "90 s"}}
    (drive,) = explain(load_spec(held), RE_25, GP_26)
    m = drive.motor
    current = 6 * 9.80665 * 0.025 / 35 / m.torque_constant  # without friction at rest
    found = {one.name: one for one in drive.checks}
    C_w = m.winding_time_constant / m.thermal_resistance_winding
    C_h = m.motor_time_constant / m.thermal_resistance_housing

    def warming(_, T):
        out = (T[0] - T[1]) / m.thermal_resistance_winding
        heat = m.resistance * (1 + 0.0039 * (T[0] - AMBIENT)) * current**2
        return [(heat - out) / C_w, (out - (T[1] - AMBIENT) / m.thermal_resistance_housing) / C_h]

    exact = solve_ivp(warming, (0, 90), [AMBIENT, AMBIENT], rtol=1e-10, atol=1e-10).y[0, -1]
    winding = found["winding_temperature"]
    assert winding.demand - AMBIENT == pytest.approx(exact - AMBIENT, rel=2e-3)  # the search's pieces: to 0.1 %
    assert winding.demand - AMBIENT > 20.0
    repeated = checks({**held, "once": False})["winding_temperature"]
    assert repeated.demand > 1.5 * (exact - AMBIENT) + AMBIENT or np.isinf(repeated.demand)


def test_continuous_ratings_are_of_what_repeats():
    once, repeated = checks(CLIMB), checks({**CLIMB, "once": False})
    assert repeated["motor_nominal_current"].status == "fail"
    lasting = {"motor_nominal_current", "gearhead_continuous_torque", "gearhead_continuous_speed"}
    assert lasting <= repeated.keys() and not lasting & once.keys()
    assert once["gearhead_intermittent_torque"].demand == repeated["gearhead_intermittent_torque"].demand
    both = [one["controller_continuous_current"] for one in (once, repeated)]  # of encoders that turn differently hard
    assert both[0].demand == pytest.approx(both[1].demand, rel=1e-6) and both[0].limit == both[1].limit


def test_without_thermal_figures_a_rating_is_enough_and_not_needed():
    whole = load(["maxon"])
    names = ("thermal_resistance_winding", "thermal_resistance_housing")
    columns = dict(whole.motors.columns) | {n: np.full(len(whole.motors), np.nan) for n in names}
    whole = replace(whole, motors=replace(whole.motors, columns=columns))
    plain = {**CLIMB, "select": {"estimates": "off"}}
    assert checks(plain, whole)["motor_nominal_current"].status == "unknown"
    light = {**plain, "load": {**CLIMB["load"], "mass": "2 kg"}}
    assert checks(light, whole)["motor_nominal_current"].status == "pass"


def test_a_case_that_is_run_once_beside_the_cycle():
    """The cycle has its limits, the climb its own: the hottest of both counts, and which of them is named."""
    spec = {**CLIMB, "once": False, "load": {**CLIMB["load"], "mass": "2 kg"}}
    spec["cases"] = [{"name": "climb", "once": True, "load": {"mass": "6 kg"}}]
    both = checks(spec)
    assert both["motor_nominal_current"].status == "pass"
    assert both["winding_temperature"].demand == pytest.approx(max(
        checks(CLIMB)["winding_temperature"].demand, checks({**spec, "cases": []})["winding_temperature"].demand
    ))  # fmt: skip
    assert both["gearhead_continuous_torque"].demand < both["gearhead_intermittent_torque"].demand / 2
    with pytest.raises(InputError, match="a case that alternates with others repeats; expected once without share"):
        load_spec({**spec, "cases": [{"name": "climb", "once": True, "share": 0.1}]})


def test_the_closed_loop_runs_it_once_too():
    spec = load_spec(CLIMB)
    (drive,) = explain(spec, RE_25, GP_26)
    found = {one.name: one for one in validate(spec, drive).checks}
    sized = {one.name: one for one in drive.checks}["winding_temperature"].demand
    assert found["winding_temperature"].demand == pytest.approx(sized, abs=1.0)
    assert found["winding_temperature"].note == "highest run once from cold"
    assert "motor_nominal_current" not in found
