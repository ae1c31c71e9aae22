"""A set at the bench against what its makers print, and against SciPy's integrator."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import inf, isnan, nan

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipk

from drivesizer.catalog import load
from drivesizer.catalog.query import PartRow
from drivesizer.errors import InputError
from drivesizer.kernel.warming import State, overload_time
from drivesizer.physics.thermal import TwoBodies
from drivesizer.prediction.bench import predict_set
from drivesizer.prediction.predict import completed, predict
from drivesizer.prediction.set_at_voltage import Heating, in_the_long_run, over_time, time_to_limit
from drivesizer.results.prediction import Conditions

ROOM = 298.15
NOTHING = Conditions(voltage=nan, ambient=ROOM, load=nan, hold=nan, inertia=0.0, duration=3600.0, warm=nan,
                     resistance=0.0)  # fmt: skip
DCX = "DCX22S01EBKL598"
listed = cache(lambda catalogue: load([catalogue]))


def hit(part, section="motors", catalogue="maxon"):
    catalog = listed(catalogue)
    return PartRow(catalogue, catalog, section, catalog.table(section).rows[part])


def of(motor, gearhead=None, controller=None, *, warming=False, **changes):
    given = completed(NOTHING._replace(**changes), motor, gearhead)
    return predict(motor, gearhead, controller, given, warming=warming)


def nominal(found, name):
    return found.figure(name).band.nominal


@pytest.fixture(scope="module")
def brushed():
    return of(hit(DCX), warming=True)


@pytest.mark.parametrize(
    ("part", "band"),
    # speed, current and torque in free running, stalled and at the nominal point: the largest errors
    [(DCX, 0.012), ("118743", 0.012), ("236662", 0.02), ("200142", 0.025)],
)
def test_data_sheet_is_met(part, band):
    """Figures at nominal voltage as maxon prints them; the stall torque of a data sheet is that without friction."""
    motor = hit(part)
    found = of(motor)
    printed = {
        "free_speed": "no_load_speed", "no_load_current": "no_load_current", "stall_current": "stall_current",
    }  # fmt: skip
    if motor["kind"] == "brushed":  # iron of brushless ones saturates
        printed |= {"load_current": "nominal_current", "load_speed": "nominal_speed"}
    for name, figure in printed.items():
        assert nominal(found, name) == pytest.approx(motor[figure], rel=band), name
    friction = motor["torque_constant"] * motor["no_load_current"] * (0.65 if motor["kind"] == "brushed" else 0.0)
    assert nominal(found, "stall_torque") == pytest.approx(motor["stall_torque"] - friction, rel=band)


def test_step_has_the_printed_time_constant(brushed):
    constant = hit(DCX)["mechanical_time_constant"]
    assert nominal(brushed, "step_time_63") == pytest.approx(constant, rel=0.01)
    assert nominal(brushed, "step_time_95") == pytest.approx(-np.log(0.05) * constant, rel=0.02)


def test_nominal_current_keeps_the_winding_at_its_limit(brushed):
    """In the long run at 25 °C; a shop's nominal current is rounded, and its nominal speed comes of a hot winding."""
    rise = nominal(brushed, "work_winding_settled") - ROOM
    assert rise == pytest.approx(75.0, rel=0.06)
    band = brushed.figure("work_winding_settled").band
    assert band.p5 < 373.15 < band.p95
    never = brushed.figure("work_time_cold").never
    assert 0.0 < never < 1.0


def test_percentiles_are_in_order_and_enclose_the_nominal(brushed):
    for one in brushed.figures:
        assert one.band.p5 <= one.band.p50 <= one.band.p95 and not one.missing
        assert one.band.p5 <= one.band.nominal <= one.band.p95
    assert (np.diff(brushed.speed.nominal) <= 0.0).all()


def test_supply_and_leads_take_of_the_voltage(brushed):
    motor = hit(DCX)
    found = of(motor, resistance=motor["resistance"])
    assert nominal(found, "stall_current") == pytest.approx(nominal(brushed, "stall_current") / 2, rel=0.01)
    assert nominal(found, "free_speed") < nominal(brushed, "free_speed")


def test_gearhead_and_mounted_inertia():
    motor, gearhead = hit(DCX), hit("GPX22HPKLSL44D0CPLW", "gearheads")
    bare, found = of(motor), of(motor, gearhead, inertia=3e-4)
    i, e = gearhead["ratio"], gearhead["efficiency"]
    assert 0.9 * nominal(bare, "free_speed") < nominal(found, "free_speed") * i < nominal(bare, "free_speed")  # it rubs
    assert nominal(found, "stall_torque") == pytest.approx(nominal(bare, "stall_torque") * i * e, rel=0.06)
    J = motor["rotor_inertia"] + gearhead["inertia"]
    loss = motor["torque_constant"] * motor["no_load_current"]
    J, w_0 = J + 3e-4 * e / i**2, nominal(bare, "free_speed")
    viscous = 0.35 * loss / w_0
    assert nominal(found, "coast_time") < J / viscous * np.log1p(0.35 / 0.65)
    idle = next(one for one in found.estimates if one.figure == "no_load_torque")
    usual = 0.02 * gearhead["stages"] * gearhead["continuous_torque"] / i
    assert (idle.low, idle.value, idle.high) == pytest.approx((usual / 3, usual, usual * 3), rel=0.1)


def test_a_held_torque_of_nothing_takes_no_current_at_the_least(brushed):
    found = of(hit(DCX), hold=0.0, warming=True)
    assert nominal(found, "hold_current") == 0.0 and nominal(found, "hold_winding_settled") == ROOM
    assert nominal(found, "hold_time_cold") == inf and found.figure("hold_time_cold").never == 1.0


def test_a_load_that_is_too_much_stalls_the_motor():
    found = of(hit(DCX), load=0.2, warming=True)
    assert nominal(found, "load_speed") == nominal(found, "load_power") == 0.0
    assert nominal(found, "load_current") == nominal(found, "stall_current")
    assert nominal(found, "work_time_cold") < 60.0


def test_what_is_unknown_is_named():
    """goBILDA prints no nominal current: what its winding is permitted is assumed, in a wide band."""
    found = of(hit("5203-2402-0139", "actuators", "gobilda"), load=1.0, warming=True)
    band = found.figure("stall_time_cold").band
    assert band.p5 < band.nominal < band.p95 and band.p95 > 10 * band.p5
    assert found.figure("stall_time_warm").missing == ("--warm",)
    assert not any(isnan(f.band.nominal) and not f.missing for f in found.figures)
    servo = of(hit("XL330-M288-T 5 V", "actuators", "robotis"), warming=True)
    assert nominal(servo, "stall_current") == pytest.approx(1.47, rel=0.01)  # as printed
    one = servo.figure("work_time_warm")  # no nominal speed, so that nobody knows how warm it gets at that point
    assert isnan(one.band.nominal) and one.missing == ("--warm",)
    band = servo.figure("stall_time_cold").band
    assert band.p5 < band.nominal < band.p95 and band.p95 > 10 * band.p5  # by estimates alone


def test_a_thermal_resistance_of_nothing_is_none():
    """Pittman prints one resistance of winding to ambient: two bodies are not known."""
    motor = hit("9233S013", catalogue="pittman")
    assert motor["thermal_resistance_winding"] == 0.0
    assert of(motor, warming=True).figure("hold_winding").missing == ("motor thermal resistance winding",)


def test_estimated_figures_are_listed_and_widen_the_band():
    """RE 25, 118752, as if the catalogue had no thermal time constants of this winding."""
    known = hit("118752")
    lacking = ("winding_time_constant", "motor_time_constant")
    columns = known.table.columns | {name: np.full_like(known.table[name], nan) for name in lacking}
    poorer = replace(known.catalog, motors=replace(known.table, columns=columns))
    found = of(replace(known, catalog=poorer))
    names = {one.figure for one in found.estimates}
    assert {"winding_time_constant", "motor_time_constant"} <= names
    assert all(one.low <= one.value <= one.high and one.law for one in found.estimates)
    assert all(one.low < one.high for one in found.estimates if one.figure.endswith("time_constant"))


def test_a_controller_that_prints_no_voltage_drop_takes_up_to_one_volt():
    motor, controller = hit(DCX), hit("438725", "controllers")
    assert isnan(controller["voltage_drop"])
    found = of(motor, None, controller)
    drop = next(one for one in found.estimates if one.part == "controller")
    assert (drop.low, drop.value, drop.high) == pytest.approx((0.05, 0.5, 0.95))
    least, most = (12.0 * controller["max_duty"] - x for x in (1.0, 0.0))
    stall = found.figure("stall_current").band.nominal * motor["resistance"]
    assert least < stall < most


# --- temperatures

BODIES = TwoBodies(R_25=np.array([2.32]), R_th1=np.array([3.1]), R_th2=np.array([14.0]), tau_w=np.array([12.4]),
                   tau_h=np.array([612.0]))  # fmt: skip


def test_temperatures_at_a_constant_voltage_are_those_of_an_integrator():
    """Current falls as the winding warms: no closed form."""
    volts = 7.0

    def resistance(winding):
        return 2.32 * (1.0 + 0.0039 * (winding - 298.15)) + 0.4

    heating = Heating(BODIES, ROOM, lambda w: (volts / resistance(w), 0.3 + 0.0 * w))

    def slopes(_, x):
        copper = (resistance(x[0]) - 0.4) * (volts / resistance(x[0])) ** 2
        flow = (x[0] - x[1]) / 3.1
        return [(copper - flow) / (12.4 / 3.1), (flow + 0.3 - (x[1] - ROOM) / 14.0) / (612.0 / 14.0)]

    times = np.linspace(0.0, 1800.0, 241)
    exact = solve_ivp(slopes, (0, 1800), [ROOM, ROOM], rtol=1e-9, atol=1e-9, t_eval=times, method="LSODA").y
    winding, housing = over_time(heating, State(ROOM, ROOM), times)
    assert np.abs(winding[:, 0] - exact[0]).max() < 0.3 and np.abs(housing[:, 0] - exact[1]).max() < 0.1  # K
    settled = in_the_long_run(heating)
    assert np.allclose(np.ravel(settled), solve_ivp(slopes, (0, 5e4), [ROOM, ROOM], rtol=1e-9, method="LSODA").y[:, -1],
                       rtol=1e-5)  # fmt: skip
    crossed = solve_ivp(slopes, (0, 1800), [ROOM, ROOM], rtol=1e-10, atol=1e-10, method="LSODA",
                        events=lambda _, x: x[0] - 398.15).t_events[0][0]  # fmt: skip
    assert time_to_limit(heating, State(ROOM, ROOM), 398.15)[0] == pytest.approx(crossed, rel=5e-3)


@pytest.mark.parametrize("current", [1.1, 2.0, 6.0])
def test_time_to_the_limit_at_a_constant_current_is_that_of_one_motor(current):
    heating = Heating(BODIES, ROOM, lambda w: (current + 0.0 * w, 0.0 * w))
    for start in (State(ROOM, ROOM), State(350.0, 350.0), State(420.0, 400.0)):
        one = TwoBodies(R_25=2.32, R_th1=3.1, R_th2=14.0, tau_w=12.4, tau_h=612.0)
        expected = overload_time(one, ROOM, start, 398.15, current)
        assert time_to_limit(heating, start, 398.15)[0] == pytest.approx(expected, rel=1e-9)


def test_a_stalled_brushless_motor_is_hottest_in_one_phase():
    """It reaches the limit before the mean of the phases does."""
    motor = hit("200142")
    mean = TwoBodies(R_25=motor["resistance"], R_th1=motor["thermal_resistance_winding"],
                     R_th2=motor["thermal_resistance_housing"], tau_w=motor["winding_time_constant"],
                     tau_h=motor["motor_time_constant"])  # fmt: skip
    torque = 1.7 * motor["nominal_torque"]
    found = of(motor, hold=torque, warming=True)
    alone = overload_time(
        mean, ROOM, State(ROOM, ROOM), motor["max_winding_temperature"], nominal(found, "hold_current")
    )
    assert 0.0 < nominal(found, "hold_time_cold") < alone


def test_an_order_number_of_digits_is_a_part_and_a_ratio_is_none():
    assert predict_set("148877", gearhead="260551", catalogs=["maxon"]).figures
    for ratio in ("27:1", "27"):
        with pytest.raises(InputError, match=rf'"{ratio}" is a ratio and no part'):
            predict_set("148877", gearhead=ratio, catalogs=["maxon"])


def test_a_spec_gives_what_a_bench_has_to_know(tmp_path):
    """From 60 deg below the level line to 45 deg above it: m g l + M_f lifts, m g l cos 45 deg holds."""
    path = tmp_path / "robot.yaml"
    path.write_text("""name: arm
load: {kind: arm, mass: 2.5 kg, length: 300 mm, inertia: 0.28 kg*m^2, start_angle: -60 deg, friction_torque: 0.3 N*m}
motion: {profile: trapezoid, speed: 75 deg/s, acceleration_time: 0.4 s, cruise_time: 1 s, rest_time: 1 s,
  there_and_back: true}
transmission: [{kind: gearhead}, {kind: belt, ratios: [2], efficiency: 0.9}]
supply: {nominal: 24 V, resistance: 0.1 ohm}
environment: {ambient: 40 degC}
select: {catalogs: [maxon]}
""", encoding="utf-8")  # fmt: skip
    given = predict_set(DCX, catalogs=["maxon"], spec=path, hold="1 N*m").conditions
    assert (given.voltage, given.resistance, given.ambient) == (24.0, 0.1, 313.15)
    assert given.load == pytest.approx((2.5 * 9.80665 * 0.3 + 0.3) / 1.8, rel=1e-4)
    assert given.inertia == pytest.approx(0.28 / 3.6) and given.hold == 1.0
    held = predict_set(DCX, catalogs=["maxon"], spec=path).conditions.hold
    assert held == pytest.approx(2.5 * 9.80665 * 0.3 * np.cos(np.pi / 4) / 2)
    path.write_text(path.read_text(encoding="utf-8").replace("[2]", "[2, 3]"), encoding="utf-8")
    with pytest.raises(InputError, match="belt of several ratios"):
        predict_set(DCX, catalogs=["maxon"], spec=path)


MACHINE = """name: machine
load: {load}
motion: {{profile: trapezoid, speed: {speed}, acceleration_time: 0.3 s, cruise_time: 0.5 s, rest_time: 1 s}}
transmission: [{{kind: gearhead}}]
supply: {{nominal: 24 V, resistance: 0.2 ohm}}
select: {{catalogs: [maxon]}}
"""


def with_machine(tmp_path, load, speed, *parts):
    (tmp_path / "robot.yaml").write_text(MACHINE.format(load=load, speed=speed), encoding="utf-8")
    return predict_set(*parts, catalogs=["maxon"], spec=tmp_path / "robot.yaml")


def test_a_pendulum_swings_as_it_does_without_a_motor_but_for_friction(tmp_path):
    """From level, 90 deg from hanging: 4 K(sin 45 deg) of (J/m g l)^0.5; dry friction takes M_f pi of its energy."""
    load = "{kind: arm, mass: 0.5 kg, length: 150 mm, start_angle: -90 deg}"
    found = with_machine(tmp_path, load, "138.461538 deg/s", "118752")  # up to the level line: 0.65 s at that speed
    motor, moment = hit("118752"), 0.5 * 9.80665 * 0.15
    small = np.sqrt((0.5 * 0.15**2 + motor["rotor_inertia"]) / moment)
    assert nominal(found, "swing_period") == pytest.approx(4.0 * small * ellipk(0.5), rel=3e-3)
    assert nominal(found, "swing_half") == pytest.approx(nominal(found, "swing_period") / 2.0, rel=3e-3)
    lost = 0.65 * motor["torque_constant"] * motor["no_load_current"] * np.pi / moment
    assert nominal(found, "swing_reach") == pytest.approx(np.pi - lost, rel=2e-3)
    swing = next(one for one in found.movements if one.name == "swing")  # from level down through hanging to that side
    angle = np.interp([0.0, small * ellipk(0.5), 2.0 * small * ellipk(0.5)], swing.time, swing.position.nominal)
    assert angle == pytest.approx([np.pi / 2.0, 0.0, np.pi / 2.0 - (np.pi - lost)], abs=0.01)
    assert not np.any(swing.current.p95)


@pytest.mark.parametrize(
    ("load", "speed", "inertia", "torque", "end"),
    [  # at the shaft: J, torque by angle, and how far the motion goes
        ("{kind: wheeled_vehicle, mass: 30 kg, driven_wheels: 2, wheel_diameter: 200 mm, rolling_resistance: 0.02, "
         "inertia: 0 kg*m^2}", "1 m/s", 15.0 * 0.1**2, lambda _: 15.0 * 9.80665 * 0.02 * 0.1, 0.8 / 0.1),
        ("{kind: arm, mass: 0.6 kg, length: 200 mm, start_angle: -80 deg, friction_torque: 0.05 N*m}", "100 deg/s",
         0.6 * 0.2**2, lambda x: 0.6 * 9.80665 * 0.2 * np.cos(x - np.radians(80.0)) + 0.05, np.radians(80.0)),
    ],
)  # fmt: skip
def test_a_machine_at_full_voltage_starts_as_an_integrator_has_it(tmp_path, load, speed, inertia, torque, end):
    found = with_machine(tmp_path, load, speed, DCX, "GPX22HPKLSL44D0CPLW")
    motor, gear = hit(DCX), hit("GPX22HPKLSL44D0CPLW", "gearheads")
    k, R, i, e = motor["torque_constant"], motor["resistance"] + 0.2, gear["ratio"], gear["efficiency"]
    rubs, w_0 = k * motor["no_load_current"], motor["no_load_speed"]
    idle = next(one for one in found.estimates if one.figure == "no_load_torque").value
    J = motor["rotor_inertia"] + gear["inertia"] + inertia / (i**2 * e)

    def slopes(_, x):
        w = x[1] * i
        M = k * (24.0 - k * w) / R - 0.65 * rubs - 0.35 * rubs * w / w_0 - idle - torque(x[0]) / (i * e)
        return [x[1], M / J / i]

    arrives = lambda _, x: x[0] - end  # noqa: E731
    run = solve_ivp(slopes, (0, 60.0), [0.0, 0.0], events=arrives, rtol=1e-8, atol=1e-9, dense_output=True)
    t = run.t_events[0][0]
    top = run.sol(np.linspace(0.0, t, 2001))[1].max()
    assert nominal(found, "start_time") == pytest.approx(t, rel=0.015)  # the median of samples beside a nominal drive
    assert nominal(found, "start_speed") == pytest.approx(top, rel=0.015)
    fast = solve_ivp(slopes, (0, t), [0.0, 0.0], events=lambda _, x: x[1] - (1 - np.exp(-1)) * top, rtol=1e-8)
    assert nominal(found, "start_time_63") == pytest.approx(fast.t_events[0][0], rel=0.03)
    assert found.figure("start_time").never == 0.0
    course = next(one for one in found.movements if one.name == "start")
    radius = 0.1 if course.axis == "linear" else 1.0
    at = np.linspace(0.1, 0.9, 5) * t
    angle, speed = run.sol(at)
    assert np.interp(at, course.time, course.position.nominal) == pytest.approx(angle * radius, rel=0.03)
    assert np.interp(at, course.time, course.speed.nominal) == pytest.approx(speed * radius, rel=0.02)
    drawn = (24.0 - k * speed * i) / R
    assert np.interp(at, course.time, course.current.nominal) == pytest.approx(drawn, rel=0.04)
    assert np.all(course.current.p5 <= course.current.p95) and course.time[-1] >= found.figure("start_time").band.p95


def test_a_machine_that_is_too_heavy_never_arrives_and_a_gear_that_holds_does_not_swing(tmp_path):
    found = with_machine(tmp_path, "{kind: arm, mass: 6 kg, length: 400 mm}", "60 deg/s", DCX, "GPX22HPKLSL44D0CPLW")
    assert found.figure("start_time").never == 1.0 and nominal(found, "start_speed") == 0.0
    held = with_machine(tmp_path, "{kind: arm, mass: 10 g, length: 50 mm}", "60 deg/s", DCX, "GPX22HPKLSL44D0CPLW")
    assert held.figure("swing_period").never == 1.0 and nominal(held, "swing_reach") == 0.0


def test_leads_that_nobody_names_have_a_band():
    """0.1 V at the nominal current in the median, 0.03 to 0.35 V; none beside a resistance by a printed stall."""
    strong = hit("305015")
    found, bare = of(strong, resistance=nan), of(strong)
    leads = next(one for one in found.estimates if one.figure == "leads")
    volts = [x * strong["nominal_current"] for x in (leads.low, leads.value, leads.high)]
    assert volts == pytest.approx([0.03, 0.1, 0.35], rel=0.05)
    share = strong["resistance"] / (strong["resistance"] + leads.value)
    assert nominal(found, "stall_current") == pytest.approx(share * nominal(bare, "stall_current"), rel=0.03)
    assert found.figure("stall_current").band.p5 < bare.figure("stall_current").band.p5
    servo = hit("ST-3215-C018", "actuators", "feetech")
    assert not any(one.figure == "leads" for one in of(servo, resistance=nan).estimates)
