"""Two constants of a winding: the voltage by k_e, the torque by k_t.

Independent figures: REV's sheet of the NEO (12 V: 2.6 N*m at 105 A of stall, 5676 rpm at 1.8 A) and VEX's dyno, which
found one at 5821 rpm; the CIM's sheet (12 V: 343.4 oz in at 133 A, 5310 rpm at 2.7 A), which shows 21.2 mV s/rad.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drivesizer.catalog import load
from drivesizer.catalog.laws import check
from drivesizer.catalog.view import split_actuators
from drivesizer.machine.set_cycle import set_cycle
from drivesizer.machine.supply_power import energy_flow
from drivesizer.output.export.fmu_motor import FIGURES, Drive
from drivesizer.physics.drive_train import back_emf_constant
from drivesizer.sizing import explain, explained
from drivesizer.spec.robot import load_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

RPM = np.pi / 30
# No sheet tells how warm the NEO gets; that its winding may not exceed 125 degC is assumed. Of an inductance so small
# commutation takes nothing: what decides are the two constants.
NEO = Path(__file__).with_name("back_emf.yaml").read_text(encoding="utf-8")
FAN = """name: NEO at 12 V
load: {kind: fan, inertia: 2 kg*cm^2, rated_torque: 0.03 N*m, rated_speed: 5500 rpm, exponent: 2}
motion: {profile: trapezoid, speed: 5500 rpm, acceleration_time: 10 s, cruise_time: 60 s, rest_time: 10 s}
transmission: [{kind: gearhead}]
supply: {nominal: 12 V, min: 12 V, max: 12 V, regeneration: 1}
select: {catalogs: [neo.yaml]}
"""
LOWERING = """name: lowering
load: {kind: hoist, mass: 8 kg, drum_diameter: 80 mm, rope_efficiency: 0.9}
motion: {profile: trapezoid, speed: 1 m/s, acceleration_time: 0.5 s, cruise_time: 3 s, rest_time: 1 s,
  there_and_back: true}
transmission: [{kind: gearhead}, {kind: belt, ratio: 12, efficiency: 0.95}]
supply: {nominal: 12 V, regeneration: 1}
power_stage: {voltage_drop: 0 V}
select: {catalogs: [andymark]}
"""


# The CIM's heat is unknown too, and with it what its winding takes: assumed, as of a motor in a stream of air.
COOLED = {"thermal_resistance_winding": 0.3, "thermal_resistance_housing": 0.3, "winding_time_constant": 20.0,
          "motor_time_constant": 900.0, "max_winding_temperature": 398.15}  # fmt: skip


@pytest.fixture(scope="module")
def shop(tmp_path_factory):
    folder = tmp_path_factory.mktemp("neo")
    (folder / "neo.yaml").write_text(NEO, encoding="utf-8")
    (folder / "robot.yaml").write_text(FAN, encoding="utf-8")
    return folder


def motor_of(catalogue, part):
    motors = split_actuators(load([catalogue])).motors
    return motors.record(motors.rows[part])


def column_of(**figures):
    """A motor with nothing but these figures, as columns of one."""
    names = ("torque_constant", "nominal_voltage", "resistance", "no_load_speed", "no_load_current", "speed_constant",
             "back_emf_constant")  # fmt: skip
    given = {name: np.array([figures.get(name, np.nan)]) for name in names}
    return given | {"commutation": np.array([figures.get("commutation", "")])}


def check_of(one, name):
    return next(check for check in one.checks if check.name == name)


# --- which figure it is


def test_printed_first_then_from_no_load_then_the_torque_constant():
    own = {"torque_constant": 0.025, "nominal_voltage": 12.0, "resistance": 0.1, "no_load_speed": 600.0}
    idle = own | {"no_load_current": 2.0}
    for figures, expected in (
        (idle | {"back_emf_constant": 0.022, "speed_constant": 40.0}, 0.022),
        (idle | {"speed_constant": 50.0}, 0.02),
        (idle, 11.8 / 600.0),
        (own | {"no_load_speed": 400.0}, 0.025),  # the current is unknown: V/w_0 = 30 mV s/rad is a bound alone
        (own, 0.02),  # which k_t is above
        ({"torque_constant": 0.025}, 0.025),
    ):
        assert back_emf_constant(column_of(**figures)) == pytest.approx(expected, rel=1e-12), figures


def test_the_speed_limit_of_a_built_in_controller_is_no_figure_of_the_winding():
    """maxon 370416: 24 V, 6000 rpm, k_t 18.1 mN m/A, k_n 527 rpm/V; its no-load speed would make 37.8 mV s/rad."""
    figures = {"torque_constant": 0.0181, "nominal_voltage": 24.0, "resistance": 7.48, "no_load_speed": 6000 * RPM,
               "no_load_current": 0.0322}  # fmt: skip
    assert back_emf_constant(column_of(**figures)) == pytest.approx(0.0181)  # more than twice k_t
    slower = figures | {"no_load_speed": 9000 * RPM}
    assert back_emf_constant(column_of(**slower)) > 0.0181 * 1.3
    assert back_emf_constant(column_of(**slower, commutation="integrated electronics")) == pytest.approx(0.0181)
    assert back_emf_constant(column_of(**slower, speed_constant=527 * RPM)) == pytest.approx(0.0181)  # one constant
    motors = split_actuators(load(["robstride"])).motors
    assert (back_emf_constant(motors.columns) == motors["torque_constant"]).all()


def test_makers_that_print_one_constant_twice_have_one():
    motors = load(["maxon"]).motors
    assert (back_emf_constant(motors.columns) == motors["torque_constant"])[~motors.excluded].all()


@pytest.mark.parametrize(
    ("catalogue", "part", "volts", "rpm", "share"),
    [
        ("andymark", "CIM", 12.0, 5330, 0.16),  # dyno
        ("vex", "775pro", 12.0, 18730, 0.149),
        ("vex", "MiniCIM", 12.0, 5840, 0.197),
        ("andymark", "AM-9015", 12.0, 14270, 0.50),
        ("gobilda", "5203-2402-0001", 12.0, 6000, 0.186),
    ],
)
def test_a_motor_runs_up_to_the_speed_that_was_measured(catalogue, part, volts, rpm, share):
    """The FMU's model, which knows nothing of this module, on 12 V without a load."""
    motor = motor_of(catalogue, part)
    k_e = float(back_emf_constant({name: np.array([getattr(motor, name)]) for name in column_of()}).item())
    assert k_e / motor.torque_constant - 1.0 == pytest.approx(share, abs=0.003)
    figures = dict.fromkeys(FIGURES, 0.0) | {
        "resistance": motor.resistance, "torque_constant": motor.torque_constant, "back_emf_constant": k_e,
        "motor_inertia": 5e-5, "motor_friction": motor.torque_constant * motor.no_load_current, "ratio": 1.0,
        "efficiency": 1.0, "radius": 1.0,
    }  # fmt: skip
    drive = Drive(figures)
    drive.voltage = volts
    drive.advance(5.0)
    assert drive.motor_speed / RPM == pytest.approx(rpm, rel=0.006)


# --- what it decides


def test_the_neo_reaches_5500_rpm_at_12_v(shop):
    """By hand: k_e = (12 - 1.8 x 0.1143)/594.4 = 19.84 mV s/rad, that of a dyno's 5821 rpm 19.35; I = tau/k_t.

    Its heat is unknown: what passes has to pass at the permitted 125 degC, R (1 + 0.0039 x 100 K).
    """
    spec = load_spec(shop / "robot.yaml")
    (one,), (printed,) = explain(spec, "NEO", "direct"), explain(spec, "NEO-K", "direct")
    w = 5500 * RPM
    k_e = (12.0 - 1.8 * 0.1143) / (5676 * RPM)
    inertia, rub = 397e-7 + 2e-4, 0.02476 * 1.8 * (0.55 + 0.45 * 5500 / 5676)
    current = (0.03 + inertia * w / 10.0 + rub) / 0.02476
    hot = 0.1143 * (1.0 + 0.0039 * 100.0)
    voltage = check_of(one, "supply_voltage")
    assert voltage.status == "pass"
    assert voltage.demand == pytest.approx(k_e * w + hot * current, rel=1e-6)
    assert check_of(printed, "supply_voltage").demand == pytest.approx(
        2.075e-3 * 30 / np.pi * w + hot * current, rel=1e-6
    )
    assert 12.0 / 0.02476 / RPM < 4700  # what k_t would have had it do


def test_tolerances_move_both_constants_with_the_magnets(shop):
    """V(k) = R tau/(k k_t) + k k_e w with the flux k of 0.8 to 1.2, any alike: 12 V do up to the k that solves it."""
    none = "resistance: none, friction: none, rotor_inertia: none, thermal_resistance: none"
    text = FAN + f"tolerances: {{motor: {{torque_constant: -20 %..20 %, {none}}}, gearhead: {{efficiency: none}}}}\n"
    (shop / "uncertain.yaml").write_text(text, encoding="utf-8")
    found = explained(load_spec(shop / "uncertain.yaml"), "NEO", "direct")
    w, emf, torque = 5500 * RPM, 0.019837, 0.03 + 2.397e-4 * 5500 * RPM / 10.0 + 0.02476 * 1.8 * 5500 / 5676
    most = max(np.roots([emf * w, -12.0, 0.1143 * torque / 0.02476]).real)
    assert found.sets[0].reliability.probability == pytest.approx((most - 0.8) / 0.4, abs=0.01)


def test_the_catalogue_check_finds_constants_that_differ(shop):
    (shop / "apart.yaml").write_text(NEO, encoding="utf-8")
    found = {(f.part, f.identity): f for f in check(load(["apart.yaml"], beside=shop))}
    assert found["NEO", "no-load speed"].deviation == pytest.approx(0.248, abs=0.002)  # 24.76 / 19.84 - 1
    assert found["NEO-K", "back-EMF constant"].deviation == pytest.approx(19.815 / 24.76 - 1, abs=1e-3)
    assert ("NEO-K", "no-load speed") not in found


# --- where the difference goes


def test_a_load_that_is_lowered_gives_no_more_than_its_weight(shop):
    """The CIM's back-EMF is 16 % above its k_t: V I alone would return more than the weight does."""
    (shop / "lower.yaml").write_text(LOWERING, encoding="utf-8")
    spec = load_spec(shop / "lower.yaml")
    (one,) = explain(spec, "CIM", "direct")
    one = replace(one, motor=replace(one.motor, rotor_inertia=8e-5, **COOLED))
    flow = energy_flow(set_cycle(spec, one))
    assert flow.known and flow.returned > 0.0
    used = flow.load + flow.belt + flow.gearhead + flow.friction + flow.copper + flow.rotor + flow.returned
    assert flow.controller == pytest.approx(0.0, abs=1e-9)
    assert flow.drawn == pytest.approx(used, rel=1e-9)
    given = 8.0 * 9.80665 * 3.5 * 0.9  # J, of the weight behind its rope on the way down
    assert 0.4 * given < flow.returned < given
