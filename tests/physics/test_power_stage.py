"""Losses between supply and motor, against closed forms and the simulation of the closed loop."""

from __future__ import annotations

import math
from dataclasses import asdict
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import quad

from drivesizer.catalog import Controller
from drivesizer.control.engine.kernel import available_voltage
from drivesizer.control.engine.start import Drive, Supply, table
from drivesizer.kernel import records
from drivesizer.kernel.cycle import ENERGY
from drivesizer.kernel.evaluate import evaluate
from drivesizer.physics.power_stage import Feed, PowerStage, of_the_source, power_stage
from drivesizer.results.drive_set import voltage_assumption
from drivesizer.spec.robot import load_spec
from drivesizer.spec.sections import PowerStage as Given


def stage(**figures: float) -> PowerStage:
    return PowerStage(**{"max_duty": 1.0, "drop": 0.0, "loss": 0.0, "resistance": 0.0, "standby": 0.0,
                         "assumed": False} | figures)  # fmt: skip


def printed(**figures: object) -> PowerStage:
    given = figures.pop("given", None)
    found = asdict(Controller(**figures))  # type: ignore[arg-type]
    return power_stage(found, 24.0, given, assume=bool(figures.get("assume", True)))


# --- figures of a stage


def test_the_loss_is_the_larger_of_what_is_printed():
    """EPOS4 50/5: 1 V, and 98 % at 90 % of 50 V; EPOS2 70/10: 1 V, and 94 % at 90 % of 70 V."""
    small = printed(voltage_drop=1.0, max_efficiency=0.98, max_duty=0.9, supply_max=50.0)
    large = printed(voltage_drop=1.0, max_efficiency=0.94, max_duty=0.9, supply_max=70.0)
    assert small.loss == 1.0 and large.loss == pytest.approx((1 / 0.94 - 1) * 63.0)
    assert large.drop == 1.0 and not large.assumed


def test_what_is_not_printed_is_assumed_unless_estimates_are_off():
    bare, off = printed(), power_stage(asdict(Controller()), 24.0, assume=False)
    assert (float(bare.loss), bool(bare.assumed)) == (1.0, True) and math.isnan(bare.drop)
    assert (float(off.loss), bool(off.assumed)) == (0.0, False)
    assert (bare.resistance, bare.standby) == (0.0, 0.0)


def test_given_figures_replace_those_of_the_catalogue():
    given = Given(voltage_drop="0.3 V", resistance="50 mohm", standby="2 W")
    found = printed(voltage_drop=1.0, max_efficiency=0.94, max_duty=0.9, supply_max=70.0, given=given)
    assert (float(found.drop), float(found.loss)) == (0.3, 0.3)
    assert (float(found.resistance), float(found.standby)) == (0.05, 2.0)


# --- power and energy


def fed(stage, course, **source):
    """Figures of a motor with currents and voltages at the ends of segments, each of one sign of the voltage."""
    t, current, volts = (np.array(x) for x in zip(*course, strict=True))
    cycle = SimpleNamespace(duration=t, speed=volts, acceleration=0.0 * volts, torque=current)  # 1 V*s/rad, 1 A/(N*m)
    drive = records.Drive(**dict.fromkeys(records.Drive._fields, 0.0))._replace(
        driving=1.0, braking=1.0, resting=1.0, emf=1.0, R_th1=1.0, R_th2=1.0, C_w=1.0, C_h=1.0, finest=np.inf,
        bus_share=1.0,
        loss=stage.loss, least_loss=float(stage.least_loss), R_stage=stage.resistance, standby=stage.standby, V_0=24.0,
        **source,
    )  # fmt: skip
    return records.Figures(*(float(x) for x in evaluate(drive, cycle, ENERGY)))


def test_power_at_the_input_of_a_stage_by_hand():
    """12 V and 2 A: 24 W and 1 V 2 A + 0.1 ohm 4 A^2 = 2.4 W; returning 2 A leaves 24 - 2.4 W."""
    for current, drawn, returned in ((2.0, 26.4, 0.0), (-2.0, 0.0, 21.6)):
        sums = fed(stage(loss=1.0, resistance=0.1), [(1.0, (current, current), (12.0, 12.0))])
        assert (sums.drawn, sums.returned) == (pytest.approx(drawn), pytest.approx(returned))


def test_losses_of_a_current_that_changes_its_sign_are_exact():
    """I = 3 - 4 t over 1 s at 10 V: cut where no current flows and where braking pays for the losses."""
    sums = fed(stage(loss=1.5, resistance=0.4), [(1.0, (3.0, -1.0), (10.0, 10.0))])

    def power(t: float) -> float:
        i = 3.0 - 4.0 * t
        return 10.0 * i + 1.5 * abs(i) + 0.4 * i * i

    drawn, returned = (quad(lambda t, s=s: max(s * power(t), 0.0), 0, 1, points=[0.75])[0] for s in (1, -1))
    assert (sums.drawn, sums.returned) == (pytest.approx(drawn), pytest.approx(returned))
    assert sums.power == pytest.approx(power(0.0))


def test_an_assumed_loss_takes_least_of_what_the_bus_stores():
    """A motor that brakes at 2 A and 10 V for 1 s: 16 W s are left of 20 by 2 V per ampere, 18 by the least of that."""
    course = [(1.0, (-2.0, -2.0), (10.0, 10.0)), (1.0, (3.0, 3.0), (10.0, 10.0))]
    for assumed, stored in ((False, 16.0), (True, 18.0)):
        sums = fed(stage(loss=2.0, assumed=assumed), course)
        assert (sums.returned, sums.stored) == (pytest.approx(16.0), pytest.approx(stored))


def test_the_source_of_a_resistance_by_hand():
    """24 V behind 0.2 ohm, four drives: 4 x 55 W are 10 A at 22 V, and 240 W out of the source, 60 W for each."""
    feed = Feed(stage(), 24.0, 0.2, 4)
    assert of_the_source(55.0, feed) == pytest.approx(60.0)
    assert of_the_source(np.array([-5.0, 0.0, 181.0]), feed).tolist() == [-5.0, 0.0, np.inf]  # at most V^2 / 4 R
    assert of_the_source(55.0, feed._replace(resistance=0.0)) == 55.0


def test_heat_of_the_source_against_another_integrator():
    """Power is a parabola between its changes of sign: quadrature where it has one sign."""
    sums = fed(stage(loss=0.8, standby=2.0), [(2.0, (4.0, -3.0), (18.0, 6.0))], R_source=0.2, drives=2.0)

    def heat(t: float) -> float:
        i, v = 4.0 - 3.5 * t, 18.0 - 6.0 * t
        power = max(i * v + 0.8 * abs(i), 0.0) + 2.0
        current = (24.0 - math.sqrt(24.0**2 - 4 * 0.2 * 2 * power)) / (2 * 0.2)  # of both drives
        return 0.2 * current**2 / 2

    by_quad = quad(heat, 0.0, 2.0, points=[8 / 7], epsabs=1e-12, limit=200)[0]
    assert sums.source_heat == pytest.approx(by_quad, rel=1e-7)


# --- voltage


@pytest.mark.parametrize("current", [0.0, 2.0, 8.0])
def test_the_voltage_of_the_search_is_that_of_the_closed_loop(current):
    """Straight in the current here, by the power of all drives there: apart by the losses' share of the sag."""
    one = stage(max_duty=0.9, drop=1.0, loss=1.0, resistance=0.05)
    feed = Feed(one, 24.0, 0.03, 4)
    supply = Supply(voltage=24.0, resistance=0.03, sets=4, max_duty=0.9, voltage_drop=1.0, loss=1.0,
                    stage_resistance=0.05)  # fmt: skip
    p = of_the_engine(supply)
    left = feed.usable - feed.leads * current
    assert available_voltage(p, current, 0.0, 1.0) == pytest.approx(left, abs=2e-3)
    assert available_voltage(p, -current, 0.0, -1.0) == available_voltage(p, current, 0.0, 1.0)


def of_the_engine(supply: Supply) -> np.ndarray:
    from engine_tasks import gains, machine

    return np.array(table(Drive(train=machine(), controller=gains(), supply=supply), 1.0, 1))


@pytest.mark.parametrize(
    ("duty", "drop", "required", "usable"),
    [
        (0.9, 1.0, 20.0, 20.7), (0.9, 1.0, 22.0, 20.7),  # printed: 0.9 (24 V - 1 V), whatever is required
        (0.9, math.nan, 20.6, 0.9 * (24.0 - 1.1)), (0.9, math.nan, 21.0, math.nan), (0.9, math.nan, 21.2, 0.9 * 23.5),
        (math.nan, math.nan, 23.9, math.nan), (math.nan, 1.0, 24.1, 24.0),  # no stage gives more than its supply
    ],
)  # fmt: skip
def test_a_drop_that_is_not_printed_decides_where_both_its_ends_agree(duty, drop, required, usable):
    feed = Feed(stage(max_duty=duty, drop=drop), 24.0, 0.0, 1)
    least, most = map(float, feed.usable_range)
    found = least if required <= least else most if required > most else math.nan
    assert found == pytest.approx(usable, nan_ok=True) or least == most == pytest.approx(usable)


# --- what is left of the supply

DROP = "the controller's voltage drop is not printed: 0.5 V to 1.1 V assumed"
DUTY = "the controller's largest duty is not printed: the supply's voltage is the bound"


@pytest.mark.parametrize(
    ("duty", "drop", "given", "said"),
    [
        (0.9, math.nan, {}, DROP),
        (0.9, 1.0, {}, ""),
        (0.9, math.nan, {"voltage_drop": "1 V"}, ""),
        (math.nan, 1.0, {}, DUTY),
        (math.nan, math.nan, {}, DUTY),
    ],
)
def test_the_usable_voltage(duty, drop, given, said):
    spec = load_spec({
        "name": "x", "load": {"kind": "flywheel", "inertia": "1 kg*m^2"}, "supply": {"nominal": "24 V"},
        "motion": {"speed": "60 rpm", "acceleration_time": "1 s", "cruise_time": "1 s"}, "power_stage": given,
    })  # fmt: skip
    assert voltage_assumption(spec, Controller(max_duty=duty, voltage_drop=drop)) == said
