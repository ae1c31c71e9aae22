"""A rotor inertia that no catalogue tells: what it has no part in is judged, what it adds to is a least demand."""

from dataclasses import replace

import numpy as np
import pytest

from drivesizer.machine.set_cycle import set_cycle
from drivesizer.machine.supply_power import energy_flow
from drivesizer.physics.winding import stress
from drivesizer.sizing import explain
from drivesizer.spec.robot import load_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

RPM = np.pi / 30
# brushed, k_t = k_e = 0.05 (speed constant 1/k_e = 190.99 rpm/V), R 1 ohm, I_0 0.2 A
MOTORS = """catalog: 1
manufacturer: Example
sources: {sheet: {document: "sheet", confidence: quoted}}
motors:
- family: M
  source: sheet
  common: {kind: brushed, nominal_voltage: 24 V, no_load_speed: 4546 rpm, no_load_current: 0.2 A, resistance: 1 ohm,
    torque_constant: 50 mN*m/A, speed_constant: 190.986 rpm/V, nominal_current: %s, nominal_speed: 3800 rpm,
    max_speed: 6000 rpm, thermal_resistance_winding: 2 K/W, thermal_resistance_housing: 6 K/W,
    winding_time_constant: 20 s, motor_time_constant: 900 s, max_winding_temperature: 125 degC}
  columns: [part, rotor_inertia (g*cm^2)]
  rows: [[M-known, 100], [M-unknown, ~]]
controllers:
- family: C
  source: sheet
  columns: [part, drives, supply_min (V), supply_max (V), continuous_current (A), peak_current (A), peak_time (s),
    max_duty (%%), voltage_drop (V)]
  rows: [[C, brushed, 6, 60, 10, 20, 2, 100, 0]]
compatibility:
  motor_gearhead: [{source: sheet, motors: [M], gearheads: [direct]}]
"""
LEVEL = "time,speed,torque\ns,rpm,N*m\n0,3000,0.1\n10,3000,0.1\n"
SHAPED = """load: {kind: fan, inertia: 2 kg*cm^2, rated_torque: 0.1 N*m, rated_speed: 3000 rpm, exponent: 2}
motion: {profile: trapezoid, speed: 3000 rpm, acceleration_time: 1 s, cruise_time: 10 s, rest_time: 5 s}
"""
REST = """transmission: [{kind: gearhead}]
supply: {nominal: 24 V, regeneration: 0, power: 200 W}
select: {catalogs: [motors.yaml]}
"""
CURRENT = {"motor_nominal_current", "winding_temperature", "supply_voltage", "controller_continuous_current",
           "controller_peak_current", "controller_peak_time", "supply_power", "bus_voltage"}  # fmt: skip


@pytest.fixture
def shop(tmp_path):
    (tmp_path / "motors.yaml").write_text(MOTORS % "3 A", encoding="utf-8")
    (tmp_path / "level.csv").write_text(LEVEL, encoding="utf-8")
    level = "load: {kind: recorded, file: level.csv, smoothing: 0 s}\n"
    (tmp_path / "level.yaml").write_text("name: level\n" + level + REST, encoding="utf-8")
    (tmp_path / "shaped.yaml").write_text("name: shaped\n" + SHAPED + REST, encoding="utf-8")
    return tmp_path


def checks_of(one):
    return {check.name: check for check in one.checks}


def test_at_constant_speed_an_inertia_has_no_part(shop):
    """By hand: 0.65 of the no-load current is dry, the rest grows with speed: I = 0.1/0.05 + 0.1762 = 2.176 A.

    The winding is hot by the rise of R I^2 (2 + 6) K and of the friction's loss 6 K; V = R I + k_e w.
    """
    spec = load_spec(shop / "level.yaml")
    (known,), (unknown,) = explain(spec, "M-known", "direct"), explain(spec, "M-unknown", "direct")
    assert repr(checks_of(known)) == repr(checks_of(unknown))
    found, w = checks_of(unknown), 3000 * RPM
    assert {found[name].status for name in CURRENT} == {"pass"}
    own = 0.2 * (0.65 + 0.35 * 3000 / 4546)
    current, rub = 2.0 + own, 0.05 * own * w
    assert found["motor_nominal_current"].demand == pytest.approx(current)
    rise = (8.0 * current**2 + 6.0 * rub) / (1.0 - 0.0039 * 8.0 * current**2)  # from 25 degC, where R is 1 ohm
    assert found["winding_temperature"].demand - 298.15 == pytest.approx(rise, rel=1e-4)
    hot = 1.0 + 0.0039 * rise
    assert found["supply_voltage"].demand == pytest.approx(hot * current + 0.05 * w, rel=1e-4)
    flow = energy_flow(set_cycle(spec, unknown))
    assert flow.known and flow.load == pytest.approx(0.1 * w * 10.0)


def test_what_accelerates_is_asked_for_at_least_what_is_known(shop):
    """A least demand fails what cannot be, and passes nothing: 2.2 A of cruise are above a nominal 1 A."""
    spec = load_spec(shop / "shaped.yaml")
    (known,), (unknown,) = explain(spec, "M-known", "direct"), explain(spec, "M-unknown", "direct")
    full, least = checks_of(known), checks_of(unknown)
    for name in CURRENT - {"controller_peak_time", "supply_power", "bus_voltage"}:
        assert full[name].status == "pass" and least[name].status == "unknown", name
        assert least[name].demand <= full[name].demand, name
    assert least["controller_peak_current"].demand > 2.2  # the fan's own inertia is known
    assert least["motor_speed"].status == least["controller_available"].status == "pass"
    (shop / "motors.yaml").write_text(MOTORS % "1 A", encoding="utf-8")
    (short,) = explain(spec, "M-unknown", "direct")
    assert checks_of(short)["motor_nominal_current"].status == "fail"


@pytest.mark.parametrize("inertia", [0.0, 1e-5, 1e-3])
@pytest.mark.parametrize("kind", ["hoist", "fan"])
def test_least_peaks_are_least_for_any_inertia(shop, inertia, kind):
    """Where a load is lowered a heavier rotor may ask for less current at a moment: no such moment is a bound."""
    text = SHAPED
    if kind == "hoist":
        text = """load: {kind: hoist, mass: 2 kg, drum_diameter: 40 mm}
motion: {profile: trapezoid, speed: 1.5 m/s, acceleration_time: 0.2 s, cruise_time: 1 s, rest_time: 1 s,
  there_and_back: true}
"""
    (shop / "any.yaml").write_text("name: any\n" + text + REST, encoding="utf-8")
    spec = load_spec(shop / "any.yaml")
    (unknown,) = explain(spec, "M-unknown", "direct")
    made = set_cycle(spec, replace(unknown, motor=replace(unknown.motor, rotor_inertia=inertia)))
    open_ = set_cycle(spec, unknown)
    most, known = (stress(spec.environment.ambient, x.cycle, x.demands, x.motor, x.feed.leads) for x in (open_, made))
    for ours, theirs in (
        (open_.demands.rms_current, made.demands.rms_current),
        (most.current.value, known.current.value),
        (most.cold_voltage.value, known.cold_voltage.value),
    ):
        assert (ours <= theirs * (1 + 1e-12)).all()
