"""What a battery surely cannot feed falls before its waveform is computed, and nothing else changes by that."""

import math
from importlib import resources

import numpy as np
import pytest
from forty_motors import MOTORS, catalogue

from drivesizer.files.yaml_source import YamlSource
from drivesizer.machine.problem import problem
from drivesizer.search.columns.candidates import pairs
from drivesizer.search.columns.evaluation import by_physics
from drivesizer.search.machine_filter import least_power
from drivesizer.sizing import load_parts
from drivesizer.spec.robot import read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

SPEC = """
name: something on the shaft
load: {kind: fan, inertia: 200 kg*cm^2, rated_torque: 0.3 N*m, rated_speed: 1500 rpm}
motion: {speed: 1200 rpm, acceleration_time: 2 s, cruise_time: 20 s, rest_time: 3 s}
supply: {nominal: 24 V, min: 22 V, max: 26 V, regeneration: 0.5}
select: {catalogs: [parts.yaml], objective: mass}
battery: {chemistry: LiFePO4, nominal_voltage: 24 V, capacity: 20 A*h, autonomy: HOURS h, charge_voltage: 26 V,
  cutoff_voltage: 20 V, resistance: 10 mohm, open_circuit: {full: 24.5 V, empty: 23 V}, continuous_current: 20 A,
  peak_current: PEAK A, max_charge_current: 5 A}
"""


def idle_current(n):
    """Of a motor [A]: in no order of its mass."""
    return 0.3 + 0.07 * (n * 7 % MOTORS)


@pytest.fixture
def machine(tmp_path):
    parts = catalogue(idle_current, "0.5 K/W", "max_efficiency: 95 %")
    (tmp_path / "parts.yaml").write_text(parts, encoding="utf-8")

    def of(hours, peak):
        text = SPEC.replace("HOURS", str(hours)).replace("PEAK", str(peak))
        return read_spec(YamlSource(text, str(tmp_path / "fan.yaml")))

    return of


def test_least_power_by_hand(machine):
    """Fan at constant speed w most of the time; the friction k_t I_0 |w| and R I^2 at 25 degC, over the cycle's 27 s.

    While it speeds up the load takes w^3 of its rated power, the inertia gives back all that it took:
    P = (2 * 2 s/4 + 20 s) M w + k_t I_0 (2 * 2 s/2 + 20 s) w + R * integral of I^2, all over 27 s, I = tau/k_t.
    """
    spec = machine(10, 50)
    catalog = load_parts(spec)
    given = problem(spec, catalog)
    sets = pairs(given)
    found = least_power(given, 0, sets)
    w, load, J = 1200 * math.pi / 30, 0.3 * (1200 / 1500) ** 2, 200e-4 + 900e-7
    for row in (0, 5, 39):
        rub = 0.098 * idle_current(int(catalog.motors["part"][sets.motor[row]][1:]))
        share = np.linspace(0, 1, 200_001)
        ramps = [np.mean((load * share**2 + rub + sign * J * w / 2) ** 2) * 2 for sign in (1, -1)]
        square = (sum(ramps) + 20 * (load + rub) ** 2) / 27 / 0.098**2
        by_hand = (21 * load + 22 * rub) * w / 27 + 0.35 * square
        assert found[row] == pytest.approx(by_hand, rel=2e-3)  # the fan's parabola is a line of few pieces


@pytest.mark.slow
@pytest.mark.parametrize("name", ["hoist", "arm", "mecanum_platform"])
def test_no_set_draws_less_than_its_least_power(name):
    """Drawn less returned by the waveform, of all wheels of a platform; some sets give back, some run away."""
    text = (resources.files("drivesizer.spec") / "starters" / f"{name}.yaml").read_text(encoding="utf-8")
    spec = read_spec(YamlSource(text, f"{name}.yaml"))
    given = problem(spec, load_parts(spec))
    every = pairs(given)
    some = every.on(np.random.default_rng(4).permutation(len(every.motor))[:300])
    figures = by_physics(given, some, True).figures
    cases = given.cases
    least = sum(cases[n].spec.load.alike * least_power(given, n, some) for n in given.machine_cases[0])
    least = least * cases[0].cycle.total
    drawn = figures["energy"] - (1 - spec.supply.regeneration) * figures["returned"]
    known = ~np.isnan(least)
    assert known.sum() > 50
    assert not np.isnan(drawn[known]).any()  # who is told by the one is told by the other
    assert (least[known] <= drawn[known] + 1e-9 * np.abs(drawn[known])).all()
    assert np.median(least[known] / drawn[known]) > 0.5
