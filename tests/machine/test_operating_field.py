"""The torque-speed field against laws: Ohm, power through the chain, the balance of heat, the catalogue as printed."""

from dataclasses import replace
from math import isnan, nan

import by_hand
import numpy as np
import pytest

from drivesizer.catalog import Catalog
from drivesizer.files.yaml_source import read
from drivesizer.load_cases import load_cycle
from drivesizer.machine.operating_field import OperatingField, field
from drivesizer.physics.load_cycle import rms
from drivesizer.physics.thermal import COPPER, nominal_current, steady_winding_temperature
from drivesizer.results.drive_set import DriveSet
from drivesizer.sizing import size
from drivesizer.spec.robot import RobotSpec, read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

ROOM = 298.15  # K


@pytest.fixture(scope="module")
def spec(example_text: str, tmp_path_factory: pytest.TempPathFactory) -> RobotSpec:
    """The SPS robot by physics, uphill and in another ambient, so that nothing is symmetric."""
    path = tmp_path_factory.mktemp("field") / "robot.yaml"
    text = example_text.replace("method: paper", "method: physics").replace("slope: 0 deg", "slope: 3 deg")
    path.write_text(text.replace("ambient: 25 degC", "ambient: 40 degC"), encoding="utf-8")
    return read_spec(read(path))


@pytest.fixture(scope="module")
def chosen(spec: RobotSpec, catalog: Catalog) -> DriveSet:
    """A set whose parts are all known."""
    result = size(spec, catalog=catalog, top=1)
    return (*result.sets, *result.misses)[0]


@pytest.fixture(scope="module")
def several(chosen: DriveSet, catalog: Catalog) -> list[DriveSet]:
    """The same with many motors of which the heat is known, brushed and brushless."""
    motors = [catalog.motors.record(row) for row in range(0, len(catalog.motors), 23)]
    known = [
        m for m in motors if not isnan(m.thermal_resistance_winding * m.max_winding_temperature * m.nominal_current)
    ]
    assert {m.kind for m in known} == {"brushed", "brushless"} and len(known) > 20
    return [replace(chosen, motor=motor) for motor in known]


def friction(found: OperatingField, one: DriveSet, ambient: float) -> np.ndarray:
    """What Ohm's law leaves over: torque by current less torque at the shaft, at every speed."""
    k_t = one.motor.torque_constant
    resistance = one.motor.resistance * (1 + COPPER * (ambient - ROOM))
    resistance = resistance + by_hand.commutation(one.motor) * found.speed
    return k_t * (found.voltage - k_t * found.speed) / resistance - found.voltage_cold


def test_voltage_lines_follow_ohms_law_cold_and_hot(spec, several):
    for one in several:
        found, motor = field(spec, one), one.motor
        k_t, stall = motor.torque_constant, found.voltage / motor.resistance
        lost, per_speed = by_hand.friction(motor)
        for line, temperature in ((found.voltage_cold, 313.15), (found.voltage_hot, motor.max_winding_temperature)):
            R = motor.resistance * (1 + 0.0039 * (temperature - ROOM))
            assert line[0] == pytest.approx(k_t * found.voltage / R - lost, rel=1e-9)
            assert np.all(np.diff(line) < 0)
        assert found.voltage_cold[0] < k_t * stall  # 40 degC is warmer than the catalogue's 25
        rest = friction(found, one, 313.15)
        assert rest == pytest.approx(lost + per_speed * found.speed, rel=1e-6, abs=1e-9 * k_t * stall)


def test_no_load_speed_and_stall_torque_as_the_catalogue_prints_them(spec, several):
    at_room = spec.environment.model_copy(update={"ambient": ROOM})
    for one in several:
        supply = spec.supply.model_copy(update={"nominal": one.motor.nominal_voltage, "min": None, "max": None})
        same = spec.model_copy(update={"supply": supply, "environment": at_room})
        found = field(same, replace(one, controller=None))  # nothing between supply and motor
        assert found.voltage == one.motor.nominal_voltage
        no_load = np.interp(0.0, found.voltage_cold[::-1], found.speed[::-1])
        assert no_load == pytest.approx(one.motor.no_load_speed, rel=0.06)  # printed figures are rounded, k_t as well
        if not isnan(one.motor.stall_torque):
            assert found.voltage_cold[0] == pytest.approx(one.motor.stall_torque, rel=0.12)


def test_continuous_torque_warms_the_winding_to_what_it_may_have(spec, several):
    for one in several:
        found, motor = field(spec, one), one.motor
        assert found.thermal
        lost = friction(found, one, 313.15)
        dry, per_speed = by_hand.friction(motor)
        loss = (dry + per_speed * found.speed) * found.speed  # brushed: at the housing
        if motor.kind == "brushless":
            R_th = motor.thermal_resistance_winding + motor.thermal_resistance_housing
            hot = motor.resistance * (1 + COPPER * (motor.max_winding_temperature - ROOM))
            left = motor.max_winding_temperature - ROOM - R_th * hot * motor.nominal_current**2
            there = (dry + per_speed * motor.nominal_speed) * motor.nominal_speed
            loss *= max(left, 0) / motor.thermal_resistance_housing / there
        rows = found.continuous > 0
        current = (found.continuous + lost)[rows] / motor.torque_constant
        reached = steady_winding_temperature(
            313.15,
            motor.resistance,
            motor.thermal_resistance_winding,
            motor.thermal_resistance_housing,
            current,
            loss[rows],
        )
        assert reached == pytest.approx(np.full(reached.shape, motor.max_winding_temperature), rel=1e-6)


def test_continuous_torque_at_nominal_speed_is_that_of_the_nominal_current(spec, several):
    at_room = spec.model_copy(update={"environment": spec.environment.model_copy(update={"ambient": ROOM})})
    off = []
    for one in several:
        found, m = field(at_room, one), one.motor
        if m.nominal_speed > found.speed[-1]:
            continue
        torque = np.interp(m.nominal_speed, found.speed, found.continuous)
        if m.kind == "brushed":
            R_th = m.thermal_resistance_winding, m.thermal_resistance_housing
            dry, per_speed = by_hand.friction(m)
            own = (dry + per_speed * m.nominal_speed) / m.torque_constant  # A, of friction at this speed
            by_law = nominal_current(
                m.resistance, *R_th, m.max_winding_temperature, m.torque_constant, own, m.nominal_speed
            )
            assert torque == pytest.approx(m.torque_constant * max(by_law - own, 0), rel=1e-3)
        off.append(torque / m.nominal_torque - 1)
    assert len(off) > 5 and abs(np.median(off)) < 0.03  # against the printed nominal torque


def test_the_cycle_carries_the_loads_power_through_the_chain(spec, chosen):
    """Cruising: the motor gives the load's power divided by both efficiencies; braking it takes it times both."""
    found, cycle = field(spec, chosen), load_cycle(spec)
    assert found.cycle_speed == pytest.approx(cycle.speed * chosen.total_ratio)
    through = chosen.gearhead.efficiency * chosen.belt_efficiency
    rotor = chosen.motor.rotor_inertia + chosen.gearhead.inertia + chosen.encoder.inertia
    if isnan(rotor):
        rotor = chosen.motor.rotor_inertia + chosen.gearhead.inertia
    accelerating = rotor * cycle.acceleration * chosen.total_ratio * found.cycle_speed
    mean = (cycle.power / through).mean(1)
    expected = np.where(mean > 0, mean, (cycle.power * through).mean(1)) + accelerating.mean(1)
    assert (found.cycle_torque * found.cycle_speed).mean(1) == pytest.approx(expected)
    assert (mean < 0).any() and (mean > 0).any()


def test_the_rms_point_is_the_rms_of_the_cycle_where_nothing_rubs(spec, chosen):
    smooth = replace(chosen, motor=replace(chosen.motor, no_load_current=0.0))
    found, cycle = field(spec, smooth), load_cycle(spec)
    assert found.rms_torque == pytest.approx(rms(cycle.duration, found.cycle_torque))
    assert found.rms_speed == pytest.approx(rms(cycle.duration, found.cycle_speed))
    assert found.rms_torque > field(spec, chosen).rms_torque > 0.0  # friction helps to brake, and is taken off


def test_the_intermittent_line_is_the_lesser_of_gearhead_and_controller(spec, chosen):
    strong = replace(chosen, controller=replace(chosen.controller, peak_current=1e3))
    torque = field(spec, strong).intermittent[0]
    gear = chosen.gearhead
    assert torque * gear.ratio * gear.efficiency == pytest.approx(gear.intermittent_torque)
    weak = replace(chosen, controller=replace(chosen.controller, peak_current=1.7))
    dry, _ = by_hand.friction(chosen.motor)  # at rest nothing else rubs
    assert field(spec, weak).intermittent[0] == pytest.approx(chosen.motor.torque_constant * 1.7 - dry)
    one_known = replace(strong, gearhead=replace(gear, intermittent_torque=nan))
    assert field(spec, one_known).intermittent[0] == pytest.approx(chosen.motor.torque_constant * 1e3 - dry)
