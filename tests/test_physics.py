"""The drive model on columns against the same physics written again, one candidate and one moment at a time."""

import itertools
import math
import random
from dataclasses import replace

import numpy as np
import pytest

from drivesizer.loads import load_cycle
from drivesizer.paper import vehicle
from drivesizer.physics import at_gearhead, demands, peak_voltage
from drivesizer.profile import Profile, trapezoid
from drivesizer.search import Rows
from drivesizer.sizing import explain, size
from drivesizer.spec import read_spec
from drivesizer.yaml_source import YamlSource

SPEC = """
name: x
load: {{kind: wheeled_vehicle, mass: 35 kg, driven_wheels: 2, wheel_diameter: 190 mm, rolling_resistance: 0.018,
       slope: {slope} deg, inertia: 45 kg*cm^2}}
motion: {{speed: 1.4 m/s, acceleration_time: 0.8 s, cruise_time: 6 s, rest_time: 2 s}}
transmission: [{{kind: gearhead}}, {{kind: belt, ratio: 1.35, efficiency: 0.92}}]
supply: {{nominal: 36 V}}
"""
PROFILES = {
    "up": Profile("up", (0.0, 0.8, 6.8, 7.6, 9.6), (0.0, 1.4, 1.4, 0.0, 0.0)),
    "there and back": Profile("back", (0.0, 1.0, 3.0, 5.0, 8.0, 9.0), (0.0, 1.2, 1.2, -0.7, -0.7, 0.0)),
    "from speed to speed": Profile("s", (0.0, 2.0, 3.0, 5.0), (0.5, 1.5, -0.5, 0.5)),
}


def moments_by_hand(spec, profile, belt, e_b, motor, head, R):
    """Walk the profile sample by sample: Simpson's three points in every stretch of one direction of power."""
    load, r, g = spec.load, spec.load.wheel_diameter / 2, 9.80665
    J = load.inertia + load.mass * r * r / load.driven_wheels
    hill = load.mass * g * math.sin(load.slope) * r / load.driven_wheels
    roll = load.rolling_resistance * load.mass * g * math.cos(load.slope) * r / load.driven_wheels
    i, e, k = head.ratio, head.efficiency, motor.torque_constant
    square = peak = volts = gear_square = gear_peak = running = 0.0
    for t0, t1, v0, v1 in zip(profile.time, profile.time[1:], profile.speed, profile.speed[1:], strict=False):
        a = (v1 - v0) / (t1 - t0) / r
        cuts = [0.0, 1.0] if v0 * v1 >= 0 else [0.0, v0 / (v0 - v1), 1.0]
        for u0, u1 in itertools.pairwise(cuts):
            middle = v0 + (u0 + u1) / 2 * (v1 - v0)
            sign = (middle > 0) - (middle < 0)
            T = roll * sign + hill + J * a
            T_g = T / belt if sign == 0 else T / (belt * e_b) if T * sign > 0 else T * e_b / belt
            values = []
            for u in (u0, (u0 + u1) / 2, u1):
                w = (v0 + u * (v1 - v0)) / r * belt * i
                tau = T_g / i if sign == 0 else T_g / (i * e) if T_g * sign > 0 else T_g * e / i
                tau += (motor.rotor_inertia + head.inertia) * a * belt * i
                if motor.kind == "brushed":
                    tau += k * motor.no_load_current * sign
                else:
                    tau += k * motor.no_load_current * w / motor.no_load_speed
                current = tau / k
                values.append(current)
                peak = max(peak, abs(current))
                volts = max(volts, abs(R * current + k * w))
            dt = (u1 - u0) * (t1 - t0)
            square += dt / 6 * (values[0] ** 2 + 4 * values[1] ** 2 + values[2] ** 2)
            gear_peak = max(gear_peak, abs(T_g))
            if sign:
                gear_square += T_g**2 * dt
                running += dt
    total = profile.time[-1] - profile.time[0]
    return math.sqrt(square / total), peak, volts, math.sqrt(gear_square / running), gear_peak


@pytest.mark.parametrize("slope", [-8.0, 0.0, 5.0])
@pytest.mark.parametrize("name", PROFILES)
def test_random_pairs_by_hand(catalog, slope, name):
    spec, profile = read_spec(YamlSource(SPEC.format(slope=slope), "x.yaml")), PROFILES[name]
    random.seed(f"{name} {slope}")
    rows = random.sample(range(len(catalog.motor_gearhead.left)), 400)
    m, g = catalog.motor_gearhead.left[rows], catalog.motor_gearhead.right[rows]
    motor, head = Rows(catalog.motors, m), Rows(catalog.gearheads, g)
    none = Rows(catalog.encoders, np.full(len(rows), -1))
    at = at_gearhead(load_cycle(spec, profile), 1.35, 0.92)
    asked = demands(at, motor, head, none)
    volts = peak_voltage(at, asked, motor, head, motor["resistance"])
    compared = 0
    for k in range(len(rows)):
        one, other = catalog.motors.record(int(m[k])), catalog.gearheads.record(int(g[k]))
        rms, peak, voltage, gear_rms, gear_peak = moments_by_hand(spec, profile, 1.35, 0.92, one, other, one.resistance)
        if math.isnan(rms):
            assert math.isnan(asked.rms_current[k])
            continue
        compared += 1
        assert asked.rms_current[k] == pytest.approx(rms, rel=1e-9)
        assert asked.peak_current[k] == pytest.approx(peak, rel=1e-9)
        assert volts[k] == pytest.approx(voltage, rel=1e-9)
        assert at.rms_torque == pytest.approx(gear_rms, rel=1e-9)
        assert at.peak_torque == pytest.approx(gear_peak, rel=1e-9)
    assert compared > 250


def test_power_balance_of_a_whole_cycle(catalog):
    """Work of the motor = work at the load + what belt and gearhead keep; rotors give back what they took."""
    spec = read_spec(YamlSource(SPEC.format(slope=-6.0), "x.yaml"))
    cycle = load_cycle(spec, PROFILES["there and back"])
    at = at_gearhead(cycle, 1.35, 0.92)
    motor = Rows(catalog.motors, np.array([catalog.motors.rows["148867"]]))
    head = Rows(catalog.gearheads, np.array([catalog.gearheads.rows["203119"]]))
    asked = demands(at, motor, head, Rows(catalog.encoders, np.array([-1])))
    i, e = head["ratio"][0], head["efficiency"][0]
    power = cycle.power
    kept = 0.0
    for dt, ends in zip(cycle.duration, power, strict=True):
        flow = ends.mean() * dt
        kept += flow * (1 / (0.92 * e) - 1) if flow > 0 else flow * (0.92 * e - 1)
    c = asked.coefficients[0].copy()
    friction, c[4] = c[4], 0.0
    tau = at.functions @ c
    worked = sum(
        dt * (2 * a[0] * b[0] + a[0] * b[1] + a[1] * b[0] + 2 * a[1] * b[1]) / 6
        for dt, a, b in zip(cycle.duration, tau, at.speed * i, strict=True)
    )
    load_work = float(np.sum(cycle.duration * power.mean(1) - cycle.duration * _bulge(cycle)))
    assert friction == pytest.approx(motor["torque_constant"][0] * motor["no_load_current"][0])
    assert worked == pytest.approx(load_work + kept, rel=1e-9)


def _bulge(cycle):
    """What the mean of the ends misses of a product of two straight lines; none where torque is constant."""
    return np.diff(cycle.torque, axis=1)[:, 0] * np.diff(cycle.speed, axis=1)[:, 0] / 6


def test_35_to_1_is_admitted_by_physics_for_its_speed_but_not_its_voltage(spec, catalog):
    """The transcription: physics knows no reserve, the wheel turns at 188.0 rpm, 35:1 at 7232 rpm."""
    found = explain(spec, "118752", "406767", catalog=catalog)[0]
    checks = {c.name: c for c in found.beside}
    rpm = 30 / math.pi
    assert checks["gearhead_continuous_speed"].demand * rpm == pytest.approx(7232, abs=0.5)
    assert checks["gearhead_continuous_speed"].status == "pass"
    assert checks["motor_speed"].status == "unknown"
    assert checks["supply_voltage"].limit == pytest.approx(0.9 * (22 - 1))
    pair = next(p for p in found.comparison if p.paper.name == "gearhead_input_speed")
    assert (pair.paper.status, pair.physics.status) == ("fail", "pass")


def test_wheel_speed_by_hand(spec):
    cycle = load_cycle(spec, trapezoid(spec.motion))
    assert cycle.speed.max() * 30 / math.pi == pytest.approx(188.0, abs=0.05)


@pytest.fixture(scope="module")
def by_physics(example_text):
    return read_spec(YamlSource(example_text.replace("method: paper", "method: physics"), "robot.yaml"))


def test_a_set_has_the_same_checks_whichever_method_ranked(spec, by_physics, catalog):
    """What stands beside a set that the paper ranked is what ranks it by physics, and the other way round."""
    one, other = (explain(s, "118752", "406764", catalog=catalog)[0] for s in (spec, by_physics))
    assert (one.checks[0].method, other.checks[0].method) == ("paper", "physics")
    for mine, theirs in ((one.beside, other.checks), (other.beside, one.checks)):
        assert [repr(c) for c in mine] == [repr(c) for c in theirs]
    assert [repr(c) for c in one.comparison] == [repr(c) for c in other.comparison]


def test_physics_ranks_the_whole_catalogue(example_text, catalog):
    """Every set that stands obeys its limits, worked out again from the records; several belts at once."""
    text = example_text[: example_text.index("select:")] + "select: {objective: price}\n"
    text = text.replace("method: paper", "method: physics").replace("ratio: 1.1 ", "ratios: [0.9, 1.1, 1.6]")
    spec = read_spec(YamlSource(text, "robot.yaml"))
    result = size(spec, catalog=catalog, top=300)
    assert result.method == "physics"
    assert len(result.sets) == 300
    assert len({s.belt_ratio for s in result.sets}) == 3
    usable = 22.0
    for s in result.sets:
        checks = {c.name: c for c in s.checks}
        rms, peak, volts, gear_rms, gear_peak = moments_of_example(spec, s)
        assert checks["controller_peak_current"].demand == pytest.approx(peak, rel=1e-9)
        assert checks["motor_nominal_current"].demand == pytest.approx(rms, rel=1e-9)
        assert checks["gearhead_continuous_torque"].demand == pytest.approx(gear_rms, rel=1e-9)
        assert gear_peak <= s.gearhead.intermittent_torque
        assert not volts > s.controller.max_duty * (usable - s.controller.voltage_drop)
        assert not rms > s.controller.continuous_current
        assert not peak > s.controller.peak_current
    prices = [s.objective for s in result.sets if s.status == "pass" and len(s.objective_of) == 2]
    assert prices == sorted(prices)


def moments_of_example(spec, s):
    """The same walk for the SPS robot, whose wheel's inertia comes from its cylinders."""
    wheel = 1100 * math.pi * (0.0762**2 - 0.03**2) * 0.05 / 2 * (0.0762**2 + 0.03**2)
    turning = next(r for r in vehicle(spec, 0.0).steps.values() if r.name == "wheel_inertia").value
    assert turning == pytest.approx(wheel, rel=1e-12)
    turning += next(r for r in vehicle(spec, 0.0).steps.values() if r.name == "shaft_inertia").value
    load = spec.load.model_copy(update={"inertia": turning})
    encoder = 0.0 if s.encoder is None or math.isnan(s.encoder.inertia) else s.encoder.inertia
    motor = replace(s.motor, rotor_inertia=s.motor.rotor_inertia + encoder)
    plain = spec.model_copy(update={"load": load})
    profile = trapezoid(spec.motion)
    return moments_by_hand(plain, profile, s.belt_ratio, spec.belt_efficiency, motor, s.gearhead, motor.resistance)
