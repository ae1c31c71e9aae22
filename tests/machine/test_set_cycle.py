"""A set over its cycle: efficiency, energy and warming, held against closed forms, other accounts and SciPy."""

from dataclasses import asdict, replace
from math import inf, nan, sqrt

import by_hand
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from specs import poorer
from starters import BODIES, starter

from drivesizer.catalog import Catalog
from drivesizer.catalog.parts import NO_GEARHEAD
from drivesizer.machine.operating_field import operation
from drivesizer.machine.set_cycle import Warming, finer, set_cycle, warm_up, warming, waveform
from drivesizer.machine.supply_power import energy_flow
from drivesizer.physics.thermal import COPPER, DATA_TEMPERATURE, two_bodies
from drivesizer.results.drive_set import DriveSet
from drivesizer.sizing import size
from drivesizer.spec.robot import RobotSpec

pytestmark = pytest.mark.usefixtures("no_further_searches")

KINDS = ("hoist", "arm", "ball_screw", "wheeled_vehicle", "fan")


@pytest.fixture(scope="module")
def best(spec: RobotSpec) -> DriveSet:
    return size(spec, top=1).sets[0]


# --- efficiency


@pytest.mark.parametrize("voltage", [9.0, 17.0, 24.0])
def test_the_best_efficiency_of_a_dc_motor_is_that_of_the_handbook(spec, best, voltage):
    """maxon's formulae handbook: at a voltage the best is (1 - sqrt(I_0 / I_s))^2, here without a gearhead."""
    motor = replace(best.motor, rotor_inertia=1e-6)
    found = set_cycle(spec, replace(best, motor=motor, gearhead=NO_GEARHEAD, belt_ratio=1.0, encoder=None))
    R, k, I_0 = float(found.hot[0]), motor.torque_constant, motor.no_load_current
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
    R, k, I_0 = float(found.hot[0]), best.motor.torque_constant, best.motor.no_load_current
    torque, speed = np.array([0.8, -0.8, 0.0, 0.8]), np.array([20.0, 20.0, 20.0, 0.0])
    does = operation(found, torque, speed)
    for n, at_motor in enumerate((0.8 / (i * e), -0.8 * e / i)):
        I = at_motor / k + I_0
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
        drawn, returned, _ = by_hand.energy(fine, one.motor, [T.mean for T in warm], loss=loss)
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


def test_what_hangs_on_an_unknown_inertia_is_unknown_and_the_rest_is_not(spec, best):
    bare = replace(best, gearhead=replace(best.gearhead, inertia=nan))
    flow, whole = energy_flow(set_cycle(spec, bare)), energy_flow(set_cycle(spec, best))
    assert np.isnan([flow.drawn, flow.copper, flow.returned, flow.net]).all() and not flow.known
    assert (flow.load, flow.gearhead, flow.belt) == (whole.load, whole.gearhead, whole.belt)


# --- current and voltage


def test_current_and_voltage_of_the_robot_are_those_of_the_checks(spec, catalog):
    best = size(spec, catalog=poorer(catalog), top=1).sets[0]
    ends = waveform(set_cycle(spec, best))
    beside = {check.name: check for check in best.beside}
    assert np.abs(ends.current).max() == pytest.approx(beside["controller_peak_current"].demand)
    found, cold = set_cycle(spec, best), beside["supply_voltage"]
    assert cold.status == "unknown"  # without time constants: with a cold winding at least this
    d, p = found.drive, found.pieces
    volts = d.emf * np.array([p.w_0, p.w_1]) + best.motor.resistance * np.array([p.I_0, p.I_1])  # in 25 degC
    assert np.abs(volts).max() == pytest.approx(cold.demand)
    assert np.abs(ends.voltage).max() > cold.demand


# --- warming


def test_finer_pieces_last_as_long_and_show_the_quick_start():
    found = Warming(np.array([2.0, 240.0, 0.5]), np.array([9.0, 0.0, 1.0]), np.array([0.1, 0.2, 0.3]))
    some = finer(found, 12.4)
    assert some.duration.sum() == pytest.approx(242.5) and (some.duration > 0.0).all()
    for value, time in zip(found.square, found.duration, strict=True):
        assert some.duration[some.square == value].sum() == pytest.approx(time)
    longest = some.duration[some.square == 0.0]
    assert longest[0] <= 12.4 / 4 * 1.001 and (np.diff(longest) >= -1e-9).all() and len(longest) == 24
    assert len(some.duration[some.square == 9.0]) == 1


def _simulated(ambient: float, found: Warming, cycles: int):
    """The two bodies by SciPy's integrator, piece by piece from cold: time, winding, housing."""
    C_w, C_h = BODIES.tau_w / BODIES.R_th1, BODIES.tau_h / BODIES.R_th2
    state, now, rows = np.array([ambient, ambient]), 0.0, []
    for _ in range(cycles):
        for duration, square, loss in zip(*found, strict=True):

            def slope(_, T, square=square, loss=loss):
                copper = BODIES.R_25 * (1.0 + COPPER * (T[0] - DATA_TEMPERATURE)) * square
                through = (T[0] - T[1]) / BODIES.R_th1
                return [(copper - through) / C_w, (loss + through - (T[1] - ambient) / BODIES.R_th2) / C_h]

            done = solve_ivp(slope, (0.0, duration), state, rtol=1e-10, atol=1e-10, max_step=duration / 20)
            rows += list(zip(now + done.t[1:], *done.y[:, 1:], strict=True))
            state, now = done.y[:, -1], now + duration
    return np.array(rows)


def test_the_way_from_cold_is_that_of_an_integrator():
    ambient = 313.15
    found = Warming(np.array([3.0, 20.0, 7.0]), np.array([16.0, 0.5, 4.0]), np.array([0.4, 0.1, 0.2]))
    way = warm_up(BODIES, ambient, found)
    assert way is not None and len(way.time) == 61 and way.time[0] == 0.0
    rows = np.vstack([[0.0, ambient, ambient], _simulated(ambient, found, 12)])
    numbers = np.round(way.time[1:] / 30.0).astype(int) - 1
    assert len([n for n in numbers if n < 12]) >= 4
    for number in (n for n in numbers if n < 12):
        place = np.flatnonzero(numbers == number)
        cycle = rows[(rows[:, 0] >= 30.0 * number - 1e-9) & (rows[:, 0] <= 30.0 * (number + 1) + 1e-9)]
        assert way.housing[1:][place[0]] == pytest.approx(cycle[-1, 2], abs=1e-4)
        assert way.highest[place[0]] == pytest.approx(cycle[:, 1].max(), abs=0.05)
        assert way.lowest[place[0]] == pytest.approx(cycle[:, 1].min(), abs=0.05)
    assert way.housing[0] == ambient
    assert (np.diff(way.housing) > 0.0).all() and way.housing[-1] < way.periodic.housing_peak
    left = (way.periodic.housing[-1] - way.housing[-1]) / (way.periodic.housing[-1] - ambient)
    assert 0.0 < left < 0.011


def test_a_constant_current_settles_where_the_handbook_says():
    """T = T_a + (R_1 + R_2) R I^2 (1 + a (T_a - 25)) / (1 - a (R_1 + R_2) R I^2): the handbook's formula."""
    found = Warming(np.array([5.0]), np.array([1.0]), np.array([0.0]))
    way = warm_up(BODIES, 298.15, found)
    assert way is not None
    heating = (3.1 + 14.0) * 2.32
    settled = 298.15 + heating / (1.0 - 0.0039 * heating)
    np.testing.assert_allclose(way.periodic.winding, settled, rtol=1e-9)
    assert way.highest[-1] == pytest.approx(settled, abs=0.012 * (settled - 298.15))


def test_a_runaway_and_an_unknown_figure_have_no_way():
    found = Warming(np.array([5.0]), np.array([100.0]), np.array([0.0]))
    assert warm_up(BODIES, 298.15, found) is None
    assert warm_up(replace(BODIES, tau_w=nan), 298.15, found) is None


def test_a_quick_cycle_of_many_repetitions_is_told_by_some_of_them():
    found = Warming(np.array([0.02, 0.03]), np.array([8.0, 0.0]), np.array([0.0, 0.0]))
    way = warm_up(BODIES, 298.15, found)
    assert way is not None and len(way.time) <= 61 and way.time[-1] > 2 * 612.0
    mean = Warming(np.array([0.05]), np.array([3.2]), np.array([0.0]))
    slow = warm_up(BODIES, 298.15, mean)
    assert slow is not None and way.periodic.winding_mean == pytest.approx(slow.periodic.winding_mean, abs=0.01)


def test_the_warming_of_a_set_peaks_where_its_result_says(tmp_path, catalog: Catalog):
    result = size(starter("hoist", tmp_path), catalog=catalog, top=1)
    one = result.sets[0]
    found = set_cycle(result.spec, one)
    bodies = two_bodies(asdict(found.motor.part))
    way = warm_up(bodies, result.spec.environment.ambient, warming(found))
    told = {figure.name: figure.value for figure in one.figures}
    assert way is not None and way.periodic.winding_peak == pytest.approx(told["winding_temperature"], abs=1e-3)
    assert way.highest.max() < told["winding_temperature"] < inf
