"""Motors as they are mounted: figures that makers print, hand calculation, bands, and the loss of the gearhead."""

from dataclasses import asdict

import numpy as np
import pytest
from refusals import refusal

from drivesizer.catalog.view import rating_gain
from drivesizer.control.closed_loop import motor_heat
from drivesizer.errors import InputError
from drivesizer.machine.set_cycle import set_cycle
from drivesizer.physics.drive_train import friction
from drivesizer.physics.thermal import COPPER, continuous_current, with_plate
from drivesizer.sizing import explain, size
from drivesizer.spec.mounting import Mounting
from drivesizer.spec.robot import load_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

ZERO = 273.15
RPM = np.pi / 30
SPEC = {
    "name": "axis",
    "load": {"kind": "belt_axis", "mass": "6 kg", "pulley_diameter": "38.2 mm", "friction_force": "12 N"},
    "motion": {"profile": "triangle", "distance": "400 mm", "time": "0.8 s", "rest_time": "0.7 s",
               "there_and_back": True},
    "supply": {"nominal": "48 V", "accepts": "all"},
    "select": {"catalogs": ["maxon"], "motor": {"family": "DCX 22 L"}, "gearhead": {"family": "GPX 22 HP"}},
}  # fmt: skip
OFF = {"select": SPEC["select"] | {"estimates": "off"}}


# --- printed


@pytest.mark.parametrize(
    ("part", "ohm", "k_m", "torque", "ampere", "off"),
    [("012B", 0.6, 14.52e-3, 47.1, 3.68, 0.015), ("024B", 1.2, 20.12e-3, 44.0, 2.50, 0.055),
     ("036B", 2.8, 29.50e-3, 43.9, 1.71, 0.015), ("048B", 4.4, 37.02e-3, 44.0, 1.36, 0.015)],
)  # fmt: skip
def test_recommended_values_of_faulhaber(part, ohm, k_m, torque, ampere, off):
    """3564...B: R_th 2.5 and 6.3 K/W, 125 °C; current and torque up to, at 22 000 rpm with R_th2 by 55 % reduced.

    The 24 V winding's printed 2.50 A is 5 % below what its own figures permit; its resistance has two digits.
    """
    speed = 22000 * RPM
    friction = 1.10e-3 + 2.4e-7 * 22000  # N*m, static and dynamic
    assert k_m * ampere == pytest.approx(torque * 1e-3 + friction, rel=0.004)
    found = continuous_current(ohm, 2.5, 0.45 * 6.3, 125 + ZERO, 22 + ZERO, friction * speed)
    assert found == pytest.approx(ampere, rel=off)


@pytest.mark.parametrize(
    ("alone", "plate"), [(0.87, 0.61), (0.68, 0.52), (0.57, 0.46), (0.50, 0.41)], ids=["3804", "3806", "3808", "3810"]
)
def test_plates_of_copley(alone, plate):
    """ServoTube 38, installation guide p. 20: within the bands of a flange and of its lack, beside one plate."""
    flange, insulated = Mounting(kind="metal_flange").share, Mounting(kind="insulated").share
    assert flange.low <= plate / alone <= flange.high + 0.025
    assert insulated.low <= alone / plate <= insulated.high
    assert with_plate(alone, 2.2) == pytest.approx(plate, rel=0.04)  # the same plate under all four


MAXON = {  # R_th1, R_th2 [K/W], k_t [mN*m/A], I_0 [mA], continuous torque at rest and with half R_th2 [mN*m]
    "449464": (2.57, 9.66, 16.9, 285, 52.8, 68.0), "DCX14L01EBKL610": (8.63, 22.2, 14.6, 19.1, 6.01, 7.61),
    "DCX14L01GBSL541": (8.63, 22.2, 7.3, 37, 6.42, 7.68), "DCX22L01GBSL484": (4.57, 13.6, 9.73, 136, 29.2, 35.4),
    "DCX32L01GBKL511": (2.3, 7.28, 27.3, 164, 108.0, 142.0),
}  # fmt: skip
BY_BRUSHES = {"DCX22L01EBSL524": (4.57, 13.6, 14.6, 32.5, 20.9, 21.2),
              "DCX22L01GBKL450": (4.57, 13.6, 6.95, 118, 25.6, 26.5)}  # fmt: skip


def at_rest(R_1, R_2, k_t, I_0, torque, _):
    """Torque with half R_th2 by the current that heat permits [mN*m]."""
    motor = {name: np.array([value]) for name, value in {
        "thermal_resistance_winding": R_1, "thermal_resistance_housing": R_2, "nominal_speed": 0.0, "kind": "brushed",
        "inside": "", "winding": "", "friction_torque": 0.0, "viscous_friction": 0.0, "max_winding_temperature": 398.15,
        "rated_ambient": 298.15, "data_temperature": 298.15, "resistance": 1.0, "nominal_current": 1.0,
        "torque_constant": k_t, "no_load_current": 0.0, "no_load_speed": 1.0}.items()}  # fmt: skip
    gain = float(rating_gain(motor, np.array([R_2 / 2]))[0])
    return k_t * (gain * (torque / k_t + I_0 / 1e3) - I_0 / 1e3)


def test_half_the_resistance_at_maxon():
    """Pages of the shop, 2019 to 2020; of two the brushes set the rating, and a cooler housing gains little."""
    for part, figures in MAXON.items():
        assert at_rest(*figures) == pytest.approx(figures[-1], rel=0.06), part
    for part, figures in BY_BRUSHES.items():
        assert at_rest(*figures) > 1.2 * figures[-2] > 1.15 * figures[-1], part


# --- as columns and by hand


@pytest.fixture(scope="module")
def printed():
    """The best drive as printed, and its parts alone."""
    return size(load_spec(SPEC | OFF))


def explained(printed, mounting, estimates="off"):
    one = printed.sets[0]
    spec = load_spec(SPEC | {"mounting": mounting, "select": SPEC["select"] | {"estimates": estimates}})
    return explain(spec, one.motor.part, one.gearhead.part)[0]


def winding(one):
    return next(check for check in one.checks if check.name == "winding_temperature")


def test_the_mounted_motor_by_hand(printed):
    """Housing and its time constant by the share, all else the printed motor; the winding follows."""
    was = printed.sets[0].motor
    found = explained(printed, {"housing_resistance": 0.6})
    now = found.motor
    assert now.thermal_resistance_housing == pytest.approx(0.6 * was.thermal_resistance_housing)
    assert now.motor_time_constant == pytest.approx(0.6 * was.motor_time_constant)
    (rating,) = (each for each in found.estimated if each.figure == "nominal_current")
    assert rating.low == was.nominal_current < rating.high == now.nominal_current  # brushes may set it
    changed = {name for name, value in asdict(now).items() if repr(value) != repr(getattr(was, name))}
    rated = {"nominal_current", "nominal_torque"}
    assert changed == {"thermal_resistance_housing", "motor_time_constant", *rated}
    assert winding(found).demand < winding(printed.sets[0]).demand
    plate = explained(printed, {"kind": "plate", "plate_resistance": "5 K/W"}).motor
    assert plate.thermal_resistance_housing == pytest.approx(1 / (1 / was.thermal_resistance_housing + 1 / 5))
    warmer = explained(printed, {"housing_resistance": 1.5})
    assert winding(warmer).demand > winding(printed.sets[0]).demand
    assert warmer.motor.nominal_current < was.nominal_current


def test_a_band_is_shown_and_leaves_checks_open(printed):
    """Between the ends of the band a check is open with a probability; figures, band and source are listed."""
    demands = [winding(explained(printed, {"housing_resistance": x})) for x in (0.3, 0.9)]
    rise = [check.demand - 298.15 for check in demands]
    allowed = demands[0].limit - 298.15
    warm = {"temperature": f"{100 * (allowed / (sum(rise) / 2) - 1):.3f} %"}  # the limit in the middle of both
    spec = SPEC | {"margins": warm, "mounting": {"housing_resistance": 0.6, "low": 0.3, "high": 0.9}}
    one = printed.sets[0]
    found = explain(load_spec(spec), one.motor.part, one.gearhead.part)[0]
    check = winding(found)
    assert check.status == "open" or check.status == "unknown"
    assert 0.05 < check.probability < 0.95
    (figure,) = (each for each in found.estimated if each.figure == "thermal_resistance_housing")
    R = one.motor.thermal_resistance_housing
    assert (figure.low, figure.value, figure.high) == pytest.approx((0.3 * R, 0.6 * R, 0.9 * R))
    assert "mounting" in figure.law


# --- the gearhead at the flange


def lost_in_gears(found):
    """What the motor gives at its shaft less what friction and the load take, mean over a cycle [W]."""
    c, i = found.demands.coefficients[0], float(found.demands.total_ratio[0])
    by_speed = [found.cycle.moment(k, 5) for k in range(6)]
    (own,), (viscous,) = friction(found.motor)
    given, rubbed = i * float(c @ by_speed), own * i * by_speed[4] + viscous * i * i * by_speed[5]
    return given - rubbed - i * c[3] * by_speed[3] - by_speed[0] - by_speed[1]


def test_it_warms_housing_and_winding(printed):
    """All of it at the flange: the housing's mean loss rises by it, the winding by R_th2 times it and some resistance.

    In the search and the closed loop alike.
    """
    one = printed.sets[0]
    without, whole = (explained(printed, {"gear_loss_share": x}) for x in (0, 1))
    specs = [load_spec(SPEC | OFF | {"mounting": {"gear_loss_share": x}}) for x in (0, 1)]
    cool, warm = (set_cycle(spec, one) for spec in specs)
    loss = lost_in_gears(cool)
    assert loss > 0.05
    assert float((warm.heat.mean - cool.heat.mean)[0]) == pytest.approx(loss)
    rise = float((warm.heat.winding - cool.heat.winding)[0])
    alone = one.motor.thermal_resistance_housing * loss
    motor = one.motor
    heating = (motor.thermal_resistance_winding + motor.thermal_resistance_housing) * motor.resistance
    assert rise == pytest.approx(alone / (1 - COPPER * heating * float(cool.demands.rms_current[0]) ** 2), rel=1e-6)
    assert winding(whole).demand - winding(without).demand == pytest.approx(rise, rel=0.1)
    ran = [motor_heat(spec, one)[0] for spec in specs]
    turned = cool.cycle.moment(4, 5) * one.gearhead.ratio
    assert (ran[1].loss_torque - ran[0].loss_torque) * turned == pytest.approx(loss)


# --- refused


@pytest.mark.parametrize(
    ("mounting", "said"),
    [({"kind": "wood"}, "as_printed"), ({"kind": "plate"}, "plate_resistance"),
     ({"plate_resistance": "2 K/W"}, "kind: plate"), ({"kind": "plate", "plate_resistance": "2 K"}, "K/W"),
     ({"kind": "insulated", "housing_resistance": 0.5}, "not both"), ({"low": 0.5}, "housing_resistance"),
     ({"housing_resistance": 0.5, "low": 0.6}, "low <="), ({"housing_resistance": -1}, "housing_resistance"),
     ({"gear_loss_share": 1.2}, "gear_loss_share"), ({"gear_loss_share": -0.1}, "gear_loss_share")],
)  # fmt: skip
def test_refused_in_one_line(mounting, said):
    assert said in refusal(lambda: load_spec(SPEC | {"mounting": mounting}), match="mounting")


def test_refused_where_heat_is_not_computed():
    for more in ({"method": "paper"}, {"select": SPEC["select"] | {"motor": {"kind": "stepper"}}}):
        with pytest.raises(InputError, match="mounting"):
            load_spec(SPEC | more | {"mounting": {"kind": "metal_flange"}})
