"""What a battery surely cannot feed falls before its waveform is computed, and nothing else changes by that."""

import math
from collections import Counter
from importlib import resources

import numpy as np
import pytest

from drivesizer.files.yaml_source import YamlSource
from drivesizer.loads.platform_wheels import on_wheels
from drivesizer.loads.wheel import machine_cases
from drivesizer.machine.budgets import with_budget
from drivesizer.search import machine_filter, search
from drivesizer.search.columns.candidates import pairs
from drivesizer.search.columns.evaluation import by_physics
from drivesizer.search.columns.stages import problem
from drivesizer.search.least_drawn import least_power
from drivesizer.search.set_record import drive_set
from drivesizer.sizing import load_parts, size
from drivesizer.spec.robot import read_spec

PARTS = """
catalog: 1
manufacturer: maker
sources: {sheet: {document: a sheet, confidence: quoted}}
motors:
  - family: D
    source: sheet
    common: {kind: brushed, nominal_voltage: 24 V, max_winding_temperature: 155 degC, ambient_min: -20 degC,
      ambient_max: 100 degC, max_speed: 6000 rpm, nominal_speed: 1500 rpm, nominal_current: 8 A, resistance: 0.35 ohm,
      torque_constant: 98 mN*m/A, rotor_inertia: 900 g*cm^2, winding_time_constant: 25 s,
      thermal_resistance_winding: 0.5 K/W, thermal_resistance_housing: 0.5 K/W, motor_time_constant: 700 s}
    columns: [part, no_load_current (A), no_load_speed (rpm), mass (g)]
    rows:
ROWS
controllers:
  - family: C
    source: sheet
    common: {drives: both, supply_min: 10 V, supply_max: 50 V, max_duty: 95 %, voltage_drop: 0 V, peak_time: 10 s,
      buses: CANopen, max_efficiency: 95 %}
    columns: [part, continuous_current (A), peak_current (A)]
    rows:
      - [only, 8, 20]
compatibility:
  motor_gearhead:
    - {source: sheet, motors: [D], gearheads: [direct]}
"""
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
MOTORS = 40


def idle_current(n):
    """Of a motor [A]: in no order of its mass."""
    return 0.3 + 0.07 * (n * 7 % MOTORS)


@pytest.fixture
def machine(tmp_path):
    rows = []
    for n in range(MOTORS):
        idle = (24 - 0.35 * idle_current(n)) / 0.098 * 30 / math.pi
        rows.append(f"      - [m{n:02}, {idle_current(n):.2f}, {idle:.6f}, {300 + n}]")
    (tmp_path / "parts.yaml").write_text(PARTS.replace("ROWS", "\n".join(rows)), encoding="utf-8")

    def of(hours, peak):
        text = SPEC.replace("HOURS", str(hours)).replace("PEAK", str(peak))
        return read_spec(YamlSource(text, str(tmp_path / "fan.yaml")))

    return of


def every_record(spec):
    """Each set in full with its own budget, one by one, in the order of their mass."""
    catalog = load_parts(spec)
    found = by_physics(problem(spec, catalog), pairs(spec, catalog), True)
    return [with_budget(spec, catalog, drive_set(found, row, 0, "mass")) for row in range(len(found.controller))]


@pytest.mark.parametrize(("hours", "peak"), [(10, 50), (14, 50), (12, 9.5), (30, 50)])
def test_sets_and_counts_are_those_of_every_set_judged_by_itself(machine, monkeypatch, hours, peak):
    """Pieces of 4, 8, 16, ... sets in blocks of 8, 128, ...: as by one set at a time until three stand."""
    for module, name, value in ((search, "_FIRST", 8), (machine_filter, "_FEWEST", 1), (machine_filter, "_FIRST", 1)):
        monkeypatch.setattr(module, name, value)
    monkeypatch.setattr(machine_filter, "_MORE", 2)
    spec = machine(hours, peak)
    catalog, stand, fell, by = load_parts(spec), [], [], Counter()
    least = least_power(problem(spec, catalog), 0, pairs(spec, catalog))
    for one, power in zip(every_record(spec), least, strict=True):
        if len(stand) == 3:
            break
        failed = {check.name for check in one.budget if check.status == "fail"}
        (fell if failed else stand).append(one.motor.part)
        assert 20 * 24 / power >= hours or "battery_autonomy" in failed  # of 20 A*h and 24 V
        by.update(failed if 20 * 24 / power >= hours else {"battery_autonomy"})  # the rest is then not looked at
    found = size(spec, top=3)
    assert [one.motor.part for one in found.sets] == stand
    assert (found.counts.judged, found.counts.feasible) == (len(stand) + len(fell), MOTORS - len(fell))
    assert found.counts.failed_by_budget == dict(by)
    assert {one.motor.part for one in found.misses} >= set(fell[:3])


def test_least_power_by_hand(machine):
    """Fan at constant speed w most of the time; the friction k_t I_0 |w| and R I^2 at 25 degC, over the cycle's 27 s.

    While it speeds up the load takes w^3 of its rated power, the inertia gives back all that it took:
    P = (2 * 2 s/4 + 20 s) M w + k_t I_0 (2 * 2 s/2 + 20 s) w + R * integral of I^2, all over 27 s, I = tau/k_t.
    """
    spec = machine(10, 50)
    catalog = load_parts(spec)
    sets = pairs(spec, catalog)
    found = least_power(problem(spec, catalog), 0, sets)
    w, load, J = 1200 * math.pi / 30, 0.3 * (1200 / 1500) ** 2, 200e-4 + 900e-7
    for row in (0, 5, 39):
        rub = 0.098 * idle_current(int(catalog.motors["part"][sets.motor[row]][1:]))
        share = np.linspace(0, 1, 200_001)
        ramps = [np.mean((load * share**2 + rub + sign * J * w / 2) ** 2) * 2 for sign in (1, -1)]
        square = (sum(ramps) + 20 * (load + rub) ** 2) / 27 / 0.098**2
        by_hand = (21 * load + 22 * rub) * w / 27 + 0.35 * square
        assert found[row] == pytest.approx(by_hand, rel=2e-3)  # the fan's parabola is a line of few pieces


@pytest.mark.parametrize("name", ["hoist", "arm", "mecanum_platform"])
def test_no_set_draws_less_than_its_least_power(name):
    """Drawn less returned by the waveform, of all wheels of a platform; some sets give back, some run away."""
    text = (resources.files("drivesizer.spec") / "starters" / f"{name}.yaml").read_text(encoding="utf-8")
    spec = on_wheels(read_spec(YamlSource(text, f"{name}.yaml")))
    catalog = load_parts(spec)
    given, every = problem(spec, catalog), pairs(spec, catalog)
    some = every.on(np.random.default_rng(4).permutation(len(every.motor))[:300])
    figures = by_physics(given, some, True).figures
    wheels = machine_cases((n, case.load) for n, case in zip(given.names, given.specs, strict=True))[0][1]
    least = sum(given.specs[n].load.alike * least_power(given, n, some) for n in wheels) * given.bases[0].cycle.total
    drawn = figures["energy"] - (1 - spec.supply.regeneration) * figures["returned"]
    known = ~np.isnan(least)
    assert known.sum() > 50
    assert not np.isnan(drawn[known]).any()  # who is told by the one is told by the other
    assert (least[known] <= drawn[known] + 1e-9 * np.abs(drawn[known])).all()
    assert np.median(least[known] / drawn[known]) > 0.5
