"""The bus by its energy balance: what the supply does not take raises its capacitor, by C/2 (U^2 - U_0^2)."""

from __future__ import annotations

import by_hand
import numpy as np
import pytest

from drivesizer.files.yaml_source import YamlSource
from drivesizer.physics.braking import most_stored
from drivesizer.sizing import explain
from drivesizer.spec.robot import read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

WHEEL = """
name: a wheel that is stopped
load: {kind: flywheel, inertia: %s, friction_torque: 1 mN*m}
motion: {speed: %s, acceleration_time: 1 s, cruise_time: 1 s, deceleration_time: %s, rest_time: 5 s}
supply: {nominal: 24 V, %s}
power_stage: {voltage_drop: 0 V}
select: {catalogs: [maxon], controller: {part: "541718"}}
"""


def bus(catalog, inertia="3e-4 kg*m^2", supply="regeneration: 0", speed="600 rpm", stops="100 ms"):
    spec = read_spec(YamlSource(WHEEL % (inertia, speed, stops, supply), "wheel.yaml"))
    (one,) = explain(spec, "110940", "406764", catalog=catalog)
    return next(check for check in one.checks if check.name == "bus_voltage"), one


def test_what_is_not_taken_stays_whatever_share_is_taken(catalog):
    """A share of 1 % takes 1 % off the energy, not all of it."""
    none, *some = (bus(catalog, supply=f"capacitance: 1 mF, regeneration: {r}")[0].demand for r in (0, 0.01, 0.5, 1))
    assert none > 24.01
    for demand, share in zip(some, (0.01, 0.5, 1), strict=True):
        assert demand**2 - 24**2 == pytest.approx((1 - share) * (none**2 - 24**2), rel=1e-9, abs=1e-9)


def test_the_capacitor_is_emptied_before_the_supply_delivers():
    """8 J back, 5 J drawn, 4 J back: of all 8 and then 7 J are held, of half 4 J and then 2 J."""
    steps = np.array([8.0, -5.0, 4.0, -9.0])
    assert [most_stored(np.where(steps > 0.0, k * steps, steps)) for k in (1.0, 0.5, 0.0)] == [8.0, 4.0, 0.0]


def test_without_a_capacitance_the_verdict_does_not_hang_on_a_share(catalog):
    """A share of 0.9 of 1.5 J leaves 0.15 J, which no 20 uF bear; what is lacking is told as at a share of 0."""
    for share in (0, 0.01, 0.5, 0.9):
        found, _ = bus(catalog, supply=f"regeneration: {share}")
        assert found.status == "unknown"
        assert "supply.capacitance" in found.note and "accepts: all" in found.note
    assert bus(catalog, supply="regeneration: 1")[0].status == "pass"


def test_a_battery_takes_all_and_loses_the_rest_inside(catalog):
    """Its voltage is the bus's, whatever share of the energy is had again."""
    pack = "}\nbattery: {nominal_voltage: 24 V, capacity: 10 A*h"
    for share in (0, 0.5):
        for supply in (f"regeneration: {share}, accepts: all", f"regeneration: {share}{pack}"):
            found, _ = bus(catalog, supply=supply)
            assert (found.status, found.demand) == ("pass", 24.0)
    diode = f"regeneration: 0, accepts: share{pack}"
    assert bus(catalog, supply=diode)[0].status == "unknown"


def test_a_trace_of_energy_does_not_make_the_bus_unknown(catalog):
    """5 A chopped at 100 kHz to a tenth of 24 V need 5.2 uF: 1.3 mJ raise them to 33 of 50 V; 0.3 J are too many.

    By hand: 60 rpm at the load stop within 20 ms, and friction has its part. The winding is 0.37 K above the ambient,
    by its own 5.6 mW in 16.4 K/W and by 20.7 mW of friction in 13.2 K/W.
    """
    trace, one = bus(catalog, "1e-6 kg*m^2", speed="60 rpm", stops="20 ms")
    back = next(figure.value for figure in one.figures if figure.name == "returned")
    motor, i, e = one.motor, one.gearhead.ratio, one.gearhead.efficiency
    speed = np.linspace(2 * np.pi * i, 0.0, 2001)
    dry, per_speed = by_hand.friction(motor)
    load = (1e-3 - 1e-6 * 2 * np.pi / 0.02) / (i * e)  # the load's friction is more than it takes to stop it
    slowing = (motor.rotor_inertia + one.gearhead.inertia + one.encoder.inertia) * speed[0] / 0.02
    current = (load + dry + per_speed * speed - slowing) / motor.torque_constant
    warm = motor.resistance * (1 + 0.0039 * 0.37)
    power = current * (warm * current + motor.torque_constant * speed)
    assert back == pytest.approx(0.02 * np.maximum(-power, 0.0).mean(), abs=1e-5)
    assert one.controller.continuous_current == 5.0
    assert trace.status == "pass"
    assert trace.demand == pytest.approx((24**2 + 2 * back / (5 / (4 * 100e3 * 2.4))) ** 0.5, rel=1e-6)
    assert bus(catalog, "1e-6 kg*m^2", speed="300 rpm", stops="100 ms")[0].status == "unknown"
