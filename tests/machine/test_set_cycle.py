"""A set over its cycle: efficiency, energy and warming, held against closed forms, other accounts and SciPy."""

from dataclasses import replace
from math import nan, sqrt

import by_hand
import numpy as np
import pytest
from specs import poorer
from starters import starter

from drivesizer.catalog.parts import NO_GEARHEAD
from drivesizer.machine.operating_field import operation
from drivesizer.machine.set_cycle import set_cycle, warm_up
from drivesizer.machine.supply_power import energy_flow
from drivesizer.physics.thermal import resistance_25, resistance_at
from drivesizer.results.drive_set import DriveSet
from drivesizer.sizing import size
from drivesizer.spec.robot import RobotSpec

pytestmark = pytest.mark.usefixtures("no_further_searches")

KINDS = ("hoist", "arm", "wheeled_vehicle")


@pytest.fixture(scope="module")
def best(spec: RobotSpec) -> DriveSet:
    return size(spec, top=1).sets[0]


def _hot(found) -> float:
    """Resistance of the winding at its mean temperature; cold, where that is unknown."""
    T = found.winding if np.isfinite(found.winding) else found.spec.environment.ambient
    return float(resistance_at(resistance_25(found.motor), T)[0])


# --- efficiency


@pytest.mark.parametrize("voltage", [9.0, 17.0, 24.0])
def test_the_best_efficiency_of_a_dc_motor_is_that_of_the_handbook(spec, best, voltage):
    """maxon's formulae handbook: at a voltage the best is (1 - sqrt(I_0 / I_s))^2, here without a gearhead."""
    dry = best.motor.torque_constant * best.motor.no_load_current
    motor = replace(best.motor, rotor_inertia=1e-6, friction_torque=dry, viscous_friction=0.0)
    found = set_cycle(spec, replace(best, motor=motor, gearhead=NO_GEARHEAD, belt_ratio=1.0, encoder=None))
    R, k, I_0 = _hot(found), motor.torque_constant, motor.no_load_current
    I = np.linspace(1.001 * I_0, 0.999 * voltage / R, 200_001)
    speed = (voltage - R * I) / k
    does = operation(found, k * (I - I_0), speed)
    np.testing.assert_allclose(does.current, I, rtol=1e-12)
    np.testing.assert_allclose(does.voltage, voltage, rtol=1e-12)
    expected = (1.0 - sqrt(I_0 / (voltage / R))) ** 2
    assert np.nanmax(does.efficiency) == pytest.approx(expected, rel=1e-6)
    assert expected == pytest.approx(0.80, abs=0.1)  # the catalogue says 85 % at 24 V, winding cold


def test_a_gearhead_loses_on_the_side_the_power_comes_from(spec, best):
    found, i, e = set_cycle(spec, best), best.gearhead.ratio, best.gearhead.efficiency
    R, k, (dry, per_speed) = _hot(found), best.motor.torque_constant, by_hand.friction(best.motor)
    torque, speed = np.array([0.8, -0.8, 0.0, 0.8]), np.array([20.0, 20.0, 20.0, 0.0])
    does = operation(found, torque, speed)
    for n, at_motor in enumerate((0.8 / (i * e), -0.8 * e / i)):
        I = (at_motor + dry + per_speed * i * 20.0) / k
        power = (R * I + k * i * 20.0) * I
        share = 0.8 * 20.0 / power if n == 0 else -power / (0.8 * 20.0)
        assert 0.0 < share < 1.0
        assert does.efficiency[n] == pytest.approx(share, rel=1e-12)
    assert np.isnan(does.efficiency[2:]).all()  # neither without torque nor at rest is there one
    crawling = operation(found, np.array([-0.8]), np.array([0.05]))
    assert crawling.efficiency[0] == 0.0  # copper takes all that comes back, and more


# --- energy


@pytest.mark.parametrize("kind", KINDS)
def test_the_account_sums_to_what_is_drawn_and_agrees_with_the_result(kind, tmp_path, catalog):
    result = size(starter(kind, tmp_path), catalog=catalog, top=3)
    for one in result.sets:
        found = set_cycle(result.spec, one)
        flow = energy_flow(found)
        told = {figure.name: figure.value for figure in (*one.figures,)}
        if not found.known:
            assert np.isnan(flow.drawn) and not flow.known
            continue
        parts = flow.copper + flow.friction + flow.gearhead + flow.belt + flow.load + flow.rotor
        parts += flow.controller + flow.brake
        assert parts + flow.supply + flow.returned == pytest.approx(flow.drawn, rel=1e-9)
        assert flow.net == pytest.approx(told["energy"], rel=1e-9)
        assert flow.returned == pytest.approx(told["returned"], abs=1e-9 * flow.drawn)
        heat = told["joule_heat"] * found.cycle.load_cycle.total * result.spec.load.motors
        assert flow.copper == pytest.approx(heat, rel=1e-9)
        assert flow.stored == pytest.approx(result.spec.supply.regeneration * flow.returned)
        pieces = by_hand.drive(one.motor, one.gearhead, _inertia(one), one.belt_ratio, one.belt_efficiency,
                               by_hand.segments_of(found.cycle.load_cycle))  # fmt: skip
        steady = by_hand.asked(pieces, one.motor, one.gearhead, result.spec.environment.ambient).settled
        fine, warm, _ = by_hand.periodic(pieces, one.motor, result.spec.environment.ambient, steady)
        loss = by_hand.loss_per_ampere(one.controller)
        volts = [by_hand.volts(p, one.motor, T.mean) for p, T in zip(fine, warm, strict=True)]
        drawn, returned, _ = by_hand.energy(by_hand.flow(fine, volts), loss=loss)
        assert flow.drawn - flow.brake == pytest.approx(drawn * result.spec.load.motors, rel=1e-6)
        assert flow.returned == pytest.approx(returned * result.spec.load.motors, abs=1e-6 * flow.drawn)


def _inertia(one: DriveSet) -> float:
    return one.brake_inertia + (float(np.nan_to_num(one.encoder.inertia)) if one.encoder else 0.0)


def test_a_hoist_that_only_lets_down_gives_more_than_it_takes(tmp_path, catalog):
    spec = starter("hoist", tmp_path)
    down = spec.motion.model_copy(update={"speed": -spec.motion.speed, "there_and_back": False})
    found = set_cycle(spec.model_copy(update={"motion": down}), size(spec, catalog=catalog, top=1).sets[0])
    flow = energy_flow(found)
    weight = 15.0 * 9.80665 * 0.2 * (0.3 + 5.0)  # J: the way down of what hangs there
    assert -weight < flow.load < -0.7 * weight  # less what guides and rope take
    parts = flow.copper + flow.friction + flow.gearhead + flow.belt + flow.rotor + flow.controller + flow.brake
    assert flow.known and flow.drawn + -flow.load == pytest.approx(parts + flow.returned)


# --- current and voltage


def test_current_and_voltage_of_the_robot_are_those_of_the_checks(spec, catalog):
    best = size(spec, catalog=poorer(catalog), top=1).sets[0]
    beside = {check.name: check for check in best.beside}
    found, cold = set_cycle(spec, best), beside["supply_voltage"]
    assert found.figures.I_peak[0] == pytest.approx(beside["controller_peak_current"].demand)
    assert cold.status == "open"  # without time constants: with a cold winding at least this, with a hot one too much
    d, p = found.drive, found.pieces
    volts = d.emf * np.array([p.w_0, p.w_1]) + best.motor.resistance * np.array([p.I_0, p.I_1])  # in 25 degC
    assert np.abs(volts).max() == pytest.approx(cold.demand)
    assert found.figures.voltage[0] > cold.demand
    hottest = best.motor.resistance * (1 + 0.0039 * (413 - 298))  # as its peers bear
    assert cold.demand < cold.limit < np.abs(volts + (hottest - best.motor.resistance) * np.array([p.I_0, p.I_1])).max()


# --- warming


def _on_and_off(tmp_path, catalog, **motion):
    """A hoist's first drive of a motor whose two bodies are known, over its cycle."""
    spec = starter("hoist", tmp_path)
    one = size(spec, catalog=catalog, top=1).sets[0]
    heat = {"thermal_resistance_winding": 3.1, "thermal_resistance_housing": 14.0, "winding_time_constant": 12.4,
            "motor_time_constant": 612.0}  # fmt: skip
    spec = spec.model_copy(update={"motion": spec.motion.model_copy(update=motion)})
    return set_cycle(spec, replace(one, motor=replace(one.motor, **heat)))


def test_a_runaway_and_an_unknown_figure_have_no_way(tmp_path, catalog):
    found = _on_and_off(tmp_path, catalog)
    for name, value in (("thermal_resistance_housing", 1e4), ("winding_time_constant", nan)):
        motor = replace(found.motor.part, **{name: value})
        one = size(found.spec, catalog=catalog, top=1).sets[0]
        assert warm_up(set_cycle(found.spec, replace(one, motor=motor))) is None
