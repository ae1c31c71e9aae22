"""The closed loop of a servo cascade, from the spec to the verdict."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from refusals import refusal

from drivesizer.control import closed_loop
from drivesizer.control.closed_loop.checks import checks
from drivesizer.control.drive_train import Regime, modes
from drivesizer.control.validation import Cascade, Validation
from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases.platform import motion_of
from drivesizer.results.drive_set import DriveSet
from drivesizer.simulate import validate
from drivesizer.sizing import explain
from drivesizer.spec.robot import RobotSpec, read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

SPEC = """
name: a cart uphill
load: {kind: wheeled_vehicle, mass: 60 kg, driven_wheels: 4, wheel_diameter: 160 mm, rolling_resistance: 0.02, slope: 2 deg, inertia: 0.004 kg*m^2}
motion: {speed: 1.2 m/s, acceleration_time: 0.8 s, cruise_time: 4 s, rest_time: 1 s}
supply: {nominal: 24 V, min: 22 V, current: 40 A, regeneration: 0.5}
control: CONTROL
PLANT
"""  # noqa: E501
SOFT = "{structure: cascade, position: {}, velocity: {bandwidth: 4 Hz}}"  # a faster loop is unstable on a soft shaft
MOTOR, GEARHEAD = "DCX26L01GBKL529", "GPX26AALN0021CPLW"


def spec_of(
    control: str = "{structure: cascade, position: {}, velocity: {bandwidth: 30 Hz}}", plant: str = ""
) -> RobotSpec:
    text = SPEC.replace("CONTROL", control).replace("PLANT", plant)
    return read_spec(YamlSource(text, "cart.yaml"))


def proof(spec: RobotSpec) -> Validation:
    return validate(spec, chosen(spec))


def chosen(spec: RobotSpec) -> DriveSet:
    """The pair's set; what would have to change where it falls is sixty searches, and nobody asks for it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("drivesizer.sizing.changes_for", lambda *_: ())
        return explain(spec, *parts())[0]


@cache
def parts() -> tuple[str, str]:
    """A 26 mm brushed motor with every thermal figure, and a gearhead that a source lists with it."""
    from drivesizer.catalog import load

    catalog = load()
    row = catalog.motors.rows[MOTOR]
    fits = catalog.motor_gearhead.right[catalog.motor_gearhead.left == row]
    ratio = catalog.gearheads["ratio"][fits]
    return MOTOR, str(catalog.gearheads["part"][fits[np.abs(ratio - 20.0).argmin()]])


@pytest.fixture(scope="module")
def rigid() -> Validation:
    return proof(spec_of())


def figures(found: Validation) -> dict[str, float]:
    return {figure.name: figure.value for figure in found.figures}


def test_the_drive_follows_and_every_loop_is_stable(rigid):
    assert isinstance(rigid.gains, Cascade) and "pole placement" in rigid.gains.rule
    named = {check.name: check for check in rigid.checks}
    assert named["stability"].status == named["tracking_error"].status == "pass"
    assert figures(rigid)["bandwidth"] == pytest.approx(30.0, rel=0.15)  # placed for a continuous loop without delay


def test_the_winding_in_periodic_steady_state(rigid):
    """Its mean follows from the mean losses in the long run; its highest lies above by the swing of one cycle."""
    found = rigid.drive_set.motor
    limit = next(check for check in rigid.checks if check.name == "winding_temperature")
    rms = figures(rigid)["rms_current"]
    R_th1, R_th2 = found.thermal_resistance_winding, found.thermal_resistance_housing
    mean_speed = float(
        np.trapezoid(np.abs(rigid.series["motor_speed"]), rigid.series["time"]) / rigid.series["time"][-1]
    )
    rubbing = found.torque_constant * found.no_load_current * mean_speed
    hot = 298.15
    for _ in range(50):  # T = T_a + (R_th1 + R_th2) I^2 R(T) + R_th2 P
        copper = rms**2 * found.resistance * (1 + 0.0039 * (hot - 298.15))
        hot = 298.15 + (R_th1 + R_th2) * copper + R_th2 * rubbing
    assert hot - 1.0 < limit.demand < hot + 12.0
    assert limit.demand > figures(rigid)["winding_end"] > 298.15


def test_two_masses_swing_at_their_resonance():
    """f = sqrt(c (1/(e K^2 J_M)... at the load: 1/J_L and the motor's own through K^2 with the gears' share) / 2 pi."""
    spec = spec_of(SOFT, "plant: {model: two_mass, stiffness: 3000 N*m/rad, damping_ratio: 0.1, backlash: 0.2 deg}")
    found = proof(spec)
    case = closed_loop.run(spec, found.drive_set, _profile(spec))
    train = case.train
    braking = train.efficiency / train.ratio  # the share of the shaft's torque that the motor feels
    own = 3000.0 * (1 / train.load_inertia + braking / (train.ratio * train.motor_inertia))
    assert figures(found)["resonance"] == pytest.approx(math.sqrt(own) / (2 * math.pi), rel=1e-9)
    assert "two masses" in " ".join(found.assumptions)


def _profile(spec: RobotSpec):
    from drivesizer.load_cases import profile_of

    return profile_of(spec)


def test_without_feedforward_the_error_at_the_ramps_start_is_that_of_a_second_order_loop():
    """To a ramp a and a drag D the error is (a + D/J) / (s^2 + 2 z w s + w^2): largest exp(-acos(z) z / sqrt(1-z^2)) of
    (a + D/J) / w. Friction holds the cart until the current has grown, so that it does not roll back first: less."""
    bare = (
        "{structure: cascade, velocity: {bandwidth: 30 Hz}, feedforward: {friction: 0, acceleration: 0, velocity: 0}}"
    )
    spec = spec_of(bare)
    found = proof(spec)
    train = closed_loop.run(spec, found.drive_set, _profile(spec)).train
    mode, z = modes(train)[Regime.FORWARD_DRIVING], math.sqrt(0.5)
    gains = found.gains
    assert isinstance(gains, Cascade)
    w = math.sqrt(train.torque_constant * gains.velocity_ki / mode.inertia)
    ramp, drag = 1.2 / 0.8 * train.motor_per_speed, mode.drag / mode.inertia
    largest = math.exp(-math.acos(z) * z / math.sqrt(1 - z * z)) / w / train.motor_per_speed
    assert ramp * largest < figures(found)["tracking_error_peak"] < (ramp + drag) * largest
    assert drag < ramp  # so that the bounds are near each other


def test_gains_that_are_given_are_taken():
    found = proof(spec_of("{structure: cascade, current: {kp: 0.4, ki: 900}, velocity: {kp: 1.5, ki: 60}}"))
    gains = found.gains
    assert isinstance(gains, Cascade)
    assert (gains.current_kp, gains.current_ki, gains.velocity_kp, gains.velocity_ki) == (0.4, 900.0, 1.5, 60.0)


@pytest.mark.parametrize(
    ("control", "plant", "said"),
    [
        ("{structure: cascade, velocity: {bandwidth: 5 kHz}}", "", "faster than the delay of the loop allows"),
        ("{structure: cascade, velocity: {kp: 5, bandwidth: 30 Hz}}", "", "expected one of them"),
        ("{structure: cascade, velocity: {kp: 1, ki: 1}}", "plant: {model: two_mass}", "needs plant.stiffness"),
    ],
)
def test_what_cannot_be_is_one_line(control, plant, said):
    assert "cart.yaml:" in refusal(lambda: proof(spec_of(control, plant)), match=said)


@pytest.mark.parametrize(
    "text",
    ["{structure: cascade, kp: 3}", "{velocity: {kp: 3}}", "{structure: cascade, velocity: {kp: -1}}",
     "{structure: cascad}", "{structure: cascade, velocity: {kq: 1}}"],
)  # fmt: skip
def test_a_wrong_control_section_is_refused(text):
    with pytest.raises(InputError, match="control"):
        spec_of(text)


def test_unstable_gains_are_told_and_do_not_pass():
    found = proof(spec_of("{structure: cascade, velocity: {kp: 3000, ki: 9000000}}"))
    assert found.status == "fail"
    assert any("unstable" in warning for warning in found.warnings)


def test_a_profile_beyond_any_machine_is_refused():
    from drivesizer.loads.course import Profile

    spec = spec_of()
    fast = Profile(name="fast", time=(0.0, 1.0, 2.0), speed=(0.0, 1e300, 0.0))
    with pytest.raises(InputError, match="no speed that a motor can be turned to"):
        validate(spec, chosen(spec), profile=fast)


def status(name, case):
    return next(check.status for check in checks(case) if check.name == name)


def test_a_winding_of_unknown_heat_leaves_voltage_and_supply_current_open_between_cold_and_as_warm_as_it_may_be():
    """By hand: U_hot = U + R_25 0.0039/K (T - 25 degC) I, T that of the largest current for ever, or what is permitted;
    P_hot likewise with I^2, over the voltage of a source without resistance."""
    spec = spec_of()
    one = chosen(spec)
    one = replace(one, motor=replace(one.motor, winding_time_constant=math.nan))
    case, motor = closed_loop.run(spec, one, motion_of(spec)), one.motor
    assert not case.periodic and spec.supply.resistance is None
    current, R = float(case.out.figures["current"][0]), case.train.resistance
    R_th, heat = motor.thermal_resistance_winding + motor.thermal_resistance_housing, R * current**2
    forever = 298.15 + R_th * heat / (1 - 0.0039 * R_th * heat) if 0.0039 * R_th * heat < 1 else math.inf
    more = R * 0.0039 * (min(forever, motor.max_winding_temperature) - 298.15)
    assert more > 0.1 * R

    def usable(volts):
        return status("supply_voltage", replace(case, usable_voltage=volts))

    cold, hot = case.required("voltage_demand"), case.required("voltage_demand") + more * current
    found = [usable(volts) for volts in (0.99 * cold, 1.01 * cold, 0.99 * hot, 1.01 * hot)]
    assert found == ["fail", "open", "open", "pass"]

    def supplied(amperes):
        supply = spec.supply.model_copy(update={"current": amperes})
        return status("supply_current", replace(case, spec=spec.model_copy(update={"supply": supply})))

    cold = case.figure("bus_current")
    hot = cold + spec.load.motors * more * current**2 / spec.supply.lowest
    found = [supplied(amperes) for amperes in (0.99 * cold, 1.01 * cold, 0.99 * hot, 1.01 * hot)]
    assert found == ["fail", "open", "open", "pass"]


def test_a_profile_with_more_samples_than_are_simulated_is_simulated_by_the_velocity_loop_s_or_refused(monkeypatch):
    """A motion that never repeats: 256 000 periods of the current loop, a tenth of the velocity loop.

    Its corners make the current loop ask for more than twice the voltage that is simulated between them.
    """
    from drivesizer.loads.course import Profile

    spec, corners = spec_of(), tuple(np.linspace(0.0, 16.0, 41).tolist())
    long = Profile(name="long", time=corners, speed=tuple(1.0 + 0.6 * math.sin(n * n) for n in range(41)))
    full = closed_loop.run(spec, chosen(spec), long)
    steps = full.figure("steps")
    monkeypatch.setattr(closed_loop, "LONGEST", int(0.5 * steps))
    found = closed_loop.run(spec, chosen(spec), long)
    assert found.figure("steps") < 0.5 * steps
    assert any(said.startswith("the motion is too long for the current loop's") for said in found.assumptions)
    assert found.figure("rms_current") == pytest.approx(full.figure("rms_current"), rel=0.02)
    allowed = {check.name: check for check in checks(found)}
    for name, figure in (("controller_peak_current", "current_demand"), ("supply_voltage", "stage_voltage")):
        check = allowed[name]
        assert check.band.low < full.required(figure) < check.band.high and "between two samples" in check.note
        assert check.demand < 0.5 * full.required(figure) or name == "controller_peak_current"
    peak = allowed["controller_peak_current"].demand
    for most, decided in ((0.8, "fail"), (0.95, "open"), (1.05, "open"), (1.2, "pass")):
        controller = replace(found.drive_set.controller, peak_current=most * peak)
        tight = replace(found, drive_set=replace(found.drive_set, controller=controller))
        assert status("controller_peak_current", tight) == decided
    monkeypatch.setattr(closed_loop, "LONGEST", 1000)
    with pytest.raises(InputError, match="profile long: more steps than are permitted; expected a slower control"):
        validate(spec, chosen(spec), profile=long)


def test_iron_warms_as_friction_brakes():
    """At its nominal point, by the datasheet, the winding of a brushless motor is as hot as it may be in 25 degC."""
    from drivesizer.catalog import load

    spec, catalog = spec_of(), load()
    motor = catalog.motors.record(catalog.motors.rows["309756"])  # EC-4pole 30
    heat, said = closed_loop.motor_heat(spec, replace(chosen(spec), motor=motor))
    assert heat and not said
    dry, per_speed = 0.37, 0.63 / motor.no_load_speed  # of a winding without slots
    assert heat.loss_viscous / heat.loss_torque == pytest.approx(per_speed / dry, rel=1e-9)
    rise = motor.max_winding_temperature - 298.15
    copper = motor.resistance * (1.0 + 0.00392 * rise) * motor.nominal_current**2
    iron = heat.loss_torque * motor.nominal_speed + heat.loss_viscous * motor.nominal_speed**2
    R_th1, R_th2 = motor.thermal_resistance_winding, motor.thermal_resistance_housing
    assert R_th1 * copper + R_th2 * (copper + iron) == pytest.approx(rise, rel=2e-3)
    assert iron > 0.1 * copper

    unknown = replace(motor, nominal_speed=float("nan"))
    heat, said = closed_loop.motor_heat(spec, replace(chosen(spec), motor=unknown))
    friction = motor.torque_constant * motor.no_load_current
    assert heat and heat.loss_torque == pytest.approx(0.37 * friction, rel=1e-9) and not said
    assert heat.loss_viscous == pytest.approx(0.63 * friction / motor.no_load_speed, rel=1e-9)
