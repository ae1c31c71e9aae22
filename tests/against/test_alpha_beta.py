"""The optimum ratio in closed form (Giberti, Cinquemani, Legnani, Mechatronics 20, 2010) against the search.

Its assumptions: power flows to the load only, so that an efficiency is a constant factor; no friction in the motor.
Then the mean square of the motor's torque is (T/e K)² + (J K a)² + 2 J T a / e, least at K² = T_rms / (e J a_rms).
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases import load_cycle
from drivesizer.machine.problem import problem
from drivesizer.search.search import search
from drivesizer.spec.robot import read_spec

FAN = """
name: a fan that always brakes by itself
load: {{kind: fan, inertia: 40 kg*cm^2, rated_torque: {torque}, rated_speed: 400 rpm, exponent: 1,
       friction_torque: 0.3 N*m}}
motion: {{speed: 100 rpm, acceleration_time: {ramp}, deceleration_time: 1 s, cruise_time: {cruise}}}
transmission: [{{kind: gearhead}}, {{kind: belt, ratios: [{ratios}], efficiency: 0.93}}]
supply: {{nominal: 48 V, regeneration: 0.5}}
select: {{motor: {{part: "{motor}"}}, gearhead: {{part: "{gearhead}"}}, objective: joule_heat}}
"""
PAIRS = [("148867", "203115"), ("148877", "203113")]


@pytest.fixture(scope="module")
def frictionless(catalog):
    """The catalogue, without friction of motors and inertia of encoders."""

    def without(table, figure):
        return replace(table, columns=dict(table.columns) | {figure: np.zeros(len(table))})

    motors, encoders = without(catalog.motors, "no_load_current"), without(catalog.encoders, "inertia")
    return replace(catalog, motors=motors, encoders=encoders)


def fan(motor, gearhead, torque, ramp, cruise, ratios):
    text = FAN.format(motor=motor, gearhead=gearhead, torque=torque, ramp=ramp, cruise=cruise, ratios=ratios)
    return read_spec(YamlSource(text, "fan.yaml"))


def samples(cycle):
    """Torque and acceleration at many moments, and how long each counts."""
    share = (np.arange(400) + 0.5) / 400
    parts = [c[:, :1] + (c[:, 1:] - c[:, :1]) * share for c in (cycle.torque, cycle.acceleration)]
    weight = np.repeat(cycle.duration / 400, 400) / cycle.total
    return parts[0].ravel(), parts[1].ravel(), weight


@pytest.mark.parametrize(("motor", "gearhead"), PAIRS)
@pytest.mark.parametrize(("torque", "ramp", "cruise"), [("0.9 N*m", "0.06 s", "0 s"), ("0.4 N*m", "0.04 s", "0.3 s")])
def test_the_best_belt_ratio_is_that_of_the_closed_form(frictionless, motor, gearhead, torque, ramp, cruise):
    m = frictionless.motors.record(frictionless.motors.rows[motor])
    g = frictionless.gearheads.record(frictionless.gearheads.rows[gearhead])
    T, a, weight = samples(load_cycle(fan(motor, gearhead, torque, ramp, cruise, "1.1")))
    assert (T > 0.0).all()  # power flows to the load only
    rms_T, rms_a = (math.sqrt(weight @ x**2) for x in (T, a))
    J = m.rotor_inertia + g.inertia
    best = math.sqrt(rms_T / (0.93 * g.efficiency * J * rms_a)) / g.ratio
    grid = [best * 1.02**k for k in range(-60, 61)]
    grid = [1.0003 * x for x in grid]  # the optimum itself lies between two of them
    spec = fan(motor, gearhead, torque, ramp, cruise, ", ".join(f"{x:.9f}" for x in grid))
    found = search(problem(spec, frictionless).ranked_by("joule_heat"), top=1)
    assert found.passing, found.counts
    assert found.evaluation.candidates.belt[0] == pytest.approx(best, rel=0.011)
    # and the least mean square is beta / 2 of the paper times the inertia: 2 J (T_rms a_rms + mean of T a) / e
    least = 2 * J * (rms_T * rms_a + weight @ (T * a)) / (0.93 * g.efficiency)
    current = math.sqrt(least) / m.torque_constant
    assert found.evaluation.figures["joule_heat"][0] > m.resistance * current**2  # hot, not at 25 degC
    rms = next(c for c in found.evaluation.checks if c.name == "motor_nominal_current").demand[0]
    assert rms == pytest.approx(current, rel=1e-4)
