"""Where the energy goes, for every kind of load; laws of scale; the same spec in other units; figures out of range."""

import itertools
import math
import re

import by_hand
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from starters import STARTERS

from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases import load_cycle
from drivesizer.loads import AXES
from drivesizer.machine.problem import problem
from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.physics.motor_demand import demands
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.columns.evaluation import evaluate
from drivesizer.sizing import size
from drivesizer.spec.robot import read_spec

KINDS = list(AXES)
RECORDING = """time,speed,torque
s,rpm,N*m
0,0,0.2
0.5,40,1.4
1.1,35,-0.9
2.5,40,0.9
2.8,-12,-0.8
3.3,-9,0.7
3.6,0,-0.3
5,0,0
"""
BELT = "- {kind: belt, ratio: 1.6, efficiency: 0.93}\n"
PAIRS = [("118752", "406764"), ("311536", "203119"), ("148867", "203119")]  # brushed, brushless, brushed


def starter(kind, folder, *changes):
    """The spec that ``drivesizer init`` writes, by physics, with a belt, and with further changes."""
    (folder / "cycle.csv").write_text(RECORDING, encoding="utf-8")
    text = (STARTERS / f"{kind}.yaml").read_text(encoding="utf-8")
    text = text.replace("method: paper", "method: physics")
    text = re.sub(r"(?m)^( +)- kind: gearhead.*$", r"\1- kind: gearhead\n\1" + BELT, text)
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return read_spec(YamlSource(text, str(folder / f"{kind}.yaml")))


def sets_of(catalog, belt, pairs=PAIRS):
    """Pairs by part number, behind a belt."""
    motor = np.array([catalog.motors.rows[m] for m, _ in pairs])
    gearhead = np.array([catalog.gearheads.rows[g] for _, g in pairs])
    return Candidates(motor, gearhead, np.full(len(pairs), belt), np.ones(len(pairs), bool))


def lines(segments):
    """Every quantity in pieces of one sign: time, speed, acceleration, torque at both ends."""
    for s in segments:
        cuts = sorted({0.0, *by_hand.crossing(s.speed), *by_hand.crossing(s.torque), 1.0})
        for a, b in itertools.pairwise(cuts):
            yield s.time * (b - a), *(by_hand.between(x, a, b) for x in s[1:])


@pytest.mark.parametrize("kind", KINDS)
def test_every_joule_is_accounted_for(kind, tmp_path, catalog):
    """Electrical = work at the load's shaft + what belt, gearhead, winding and friction keep + what the rotor gains.

    The power stage takes its loss per ampere of all current, whichever way it flows.
    """
    spec = starter(kind, tmp_path)
    spec = spec.model_copy(update={"needs": spec.needs.model_copy(update={"hold_unpowered": False})})
    cycle, belt, e_b = load_cycle(spec), 1.6, 0.93
    segments = by_hand.segments_of(cycle)
    found = evaluate(problem(spec, catalog), sets_of(catalog, belt))
    share, sets = spec.supply.regeneration, spec.load.motors
    for row, (m, g) in enumerate(PAIRS):
        motor = catalog.motors.record(catalog.motors.rows[m])
        head = catalog.gearheads.record(catalog.gearheads.rows[g])
        encoder = int(found.encoder[row])
        inertia = 0.0 if encoder < 0 else np.nan_to_num(catalog.encoders["inertia"][encoder])
        i, e = head.ratio, head.efficiency
        J = motor.rotor_inertia + head.inertia + inertia
        work = belt_loss = gear_loss = copper = friction = rotor = 0.0
        for time, w, a, T in lines(segments):
            flow = by_hand.product(time, T, w)
            work += flow
            beyond_belt = flow / e_b if flow > 0 else flow * e_b
            beyond_gear = beyond_belt / e if flow > 0 else beyond_belt * e
            belt_loss += beyond_belt - flow
            gear_loss += beyond_gear - beyond_belt
            way = (sum(w) > 0) - (sum(w) < 0)
            W = tuple(x * belt * i for x in w)
            acceleration = tuple(x * belt * i for x in a)
            dry, per_speed = by_hand.friction(motor)
            loss = tuple(dry * way + per_speed * x for x in W)
            friction += by_hand.product(time, loss, W)
            rotor += J * by_hand.product(time, acceleration, W)
        losses = by_hand.drive(motor, head, inertia, belt, e_b, segments)
        copper = by_hand.asked(losses, motor, head, spec.environment.ambient).copper * sum(p.time for p in losses)
        returned = found.figures["returned"][row] / sets
        drawn = found.figures["energy"][row] / sets + share * returned
        stage = by_hand.loss_per_ampere(catalog.controllers.record(int(found.controller[row]))) * by_hand.charge(losses)
        balance = work + belt_loss + gear_loss + copper + friction + rotor + stage
        assert min(belt_loss, gear_loss, friction, copper) > 0
        if np.isnan(balance):  # a motor that runs away, and how hot it may get is unknown
            assert np.isnan(drawn - returned)
            continue
        assert drawn - returned == pytest.approx(balance, rel=1e-9, abs=1e-9 * drawn)
        if kind != "recorded":  # all but a recording start and end at standstill
            assert abs(rotor) < (1e-6 if kind == "winder" else 1e-9) * drawn  # whose speed is no straight line
    assert {catalog.motors.record(catalog.motors.rows[m]).kind for m, _ in PAIRS} == {"brushed", "brushless"}


# --- laws of scale ---


def random_cycle(seed, count=12):
    """Straight pieces from standstill to standstill with torque that jumps and changes sign; some rest."""
    random = np.random.default_rng(seed)
    speed = np.concatenate([[0.0], np.round(random.normal(0, 6, count - 1), 3), [0.0]])
    speed[4:6] = 0.0
    duration = np.round(random.uniform(0.2, 2.0, count), 3)
    ends = np.stack([speed[:-1], speed[1:]], axis=1)
    slope = np.repeat(np.diff(ends, axis=1) / duration[:, None], 2, axis=1)
    return LoadCycle("random", duration, ends, slope, np.round(random.normal(0, 1.5, (count, 2)), 3))


def asked_of(cycle, catalog, belt=1.6):
    """RMS torque at the gearhead, its peaks, and the motors' RMS and peak current and speed."""
    from drivesizer.search.columns.candidates import Rows

    sets = sets_of(catalog, belt)
    motor, head = Rows(catalog.motors, sets.motor), Rows(catalog.gearheads, sets.gearhead)
    at = CycleAtBelt(cycle.split(), 0.93).behind(belt)
    found = demands(at, motor, head, Rows(catalog.encoders, np.full(3, -1)))
    highest = at.peak(found.coefficients)
    gear = [at.rms_torque, at.peak_torque, at.peak_speed, at.mean_speed, at.mean_power, at.peak_power]
    return np.array(gear), np.stack([found.rms_current, highest.value, found.peak_speed])


def changed(cycle, time=1.0, speed=1.0, acceleration=1.0, torque=1.0):
    return LoadCycle(
        "changed", cycle.duration * time, cycle.speed * speed, cycle.acceleration * acceleration, cycle.torque * torque
    )


@settings(max_examples=15)
@given(st.integers(0, 10_000), st.floats(1.1, 9))
def test_in_slow_motion(catalog, seed, s):
    """Time x s with speed / s, acceleration / s^2 and the same torque: the gearhead's torques stay, its powers fall."""
    cycle = random_cycle(seed)
    was, _ = asked_of(cycle, catalog)
    now, _ = asked_of(changed(cycle, s, 1 / s, 1 / s**2), catalog)
    assert now == pytest.approx(was * [1, 1, 1 / s, 1 / s, 1 / s, 1 / s], rel=1e-9)


@settings(max_examples=15)
@given(st.integers(0, 10_000), st.floats(1.1, 9))
def test_a_belt_takes_what_the_load_gives(catalog, seed, s):
    """Belt ratio x s before a load with speed / s and torque x s: nobody behind it sees a difference."""
    cycle = random_cycle(seed)
    slower = changed(cycle, 1.0, 1 / s, 1 / s, s)
    for was, now in zip(asked_of(cycle, catalog, 1.6), asked_of(slower, catalog, 1.6 * s), strict=True):
        assert now == pytest.approx(was, rel=1e-9)


@settings(max_examples=15)
@given(st.integers(0, 10_000))
def test_the_other_way_round(catalog, seed):
    cycle = random_cycle(seed)
    mirrored = changed(cycle, 1.0, -1.0, -1.0, -1.0)
    for was, now in zip(asked_of(cycle, catalog), asked_of(mirrored, catalog), strict=True):
        assert now == pytest.approx(was, rel=1e-12)


def checks_of(spec, catalog, belt=1.6):
    found = evaluate(problem(spec, catalog), sets_of(catalog, belt))
    return {c.name: (c.demand, c.passed, c.failed) for c in found.checks}, found.figures


def assert_same(one, other):
    (mine, figures), (theirs, others) = one, other
    assert list(mine) == list(theirs)
    for name, (demand, passed, failed) in mine.items():
        assert theirs[name][0] == pytest.approx(demand, rel=1e-9, nan_ok=True), name
        assert (theirs[name][1] == passed).all(), name
        assert (theirs[name][2] == failed).all(), name
    for name in figures:
        assert others[name] == pytest.approx(figures[name], rel=1e-8, nan_ok=True), name


UNITS = {
    "conveyor": [
        ("mass: 12 kg", f"mass: {12 / 0.45359237!r} lb"),
        ("drum_diameter: 60 mm", f"drum_diameter: {60 / 25.4!r} in"),
        ("inertia: 6 kg*cm^2", "inertia: 6000 g*cm^2"),
        ("speed: 0.3 m/s", f"speed: {0.3 / 0.3048!r} ft/s"),
        ("cruise_time: 4 s", f"cruise_time: {4 / 60!r} min"),
        ("nominal: 24 V", "nominal: 24000 mV"),
        ("incline: 8 deg", f"incline: {math.radians(8)!r} rad"),
        ("select:", "environment: {ambient: 104 degF}\nselect:"),
    ],
    "arm": [
        ("length: 300 mm", f"length: {300 / 304.8!r} ft"),
        ("friction_torque: 0.3 N*m", f"friction_torque: {0.3 / 0.0070615518333333!r} oz*in"),
        ("speed: 75 deg/s", "speed: 12.5 rpm"),
        ("acceleration_time: 0.4 s", "acceleration_time: 400 ms"),
        ("start_angle: -60 deg", f"start_angle: {-math.pi / 3!r} rad"),
        ("backlash_at_load: 1 deg", "backlash_at_load: 60 arcmin"),
        ("select:", "environment: {ambient: 104 degF}\nselect:"),
    ],
    "fan": [
        ("rated_torque: 0.25 N*m", "rated_torque: 250 mN*m"),
        ("rated_speed: 1800 rpm", f"rated_speed: {60 * math.pi!r} rad/s"),
        ("inertia: 30 kg*cm^2", "inertia: 0.003 kg*m^2"),
        ("speed: 1500 rpm", "speed: 9000 deg/s"),
        ("exponent: 2 ", "exponent: 200 % "),
        ("select:", "environment: {ambient: 104 degF}\nselect:"),
    ],
}


@pytest.mark.parametrize("kind", UNITS)
def test_the_same_spec_in_other_units(kind, tmp_path, catalog):
    metric = starter(kind, tmp_path, ("select:", "environment: {ambient: 40 degC}\nselect:"))
    other = starter(kind, tmp_path, *UNITS[kind])
    assert_same(checks_of(metric, catalog), checks_of(other, catalog))


# --- figures that cannot be ---

FIRST = {  # of each load a figure that must be above zero
    "wheeled_vehicle": "mass: 30 kg",
    "conveyor": "mass: 12 kg",
    "hoist": "mass: 15 kg",
    "lead_screw": "mass: 20 kg",
    "ball_screw": "lead: 10 mm",
    "rack_pinion": "pinion_diameter: 40 mm",
    "belt_axis": "mass: 6 kg",
    "arm": "length: 300 mm",
    "fan": "rated_speed: 1800 rpm",
    "flywheel": "rated_speed: 1200 rpm",
}


def one_line(kind, folder, *changes):
    """What a spec with these changes is refused with."""
    with pytest.raises(InputError) as refused:
        size(starter(kind, folder, *changes))
    assert "\n" not in str(refused.value)
    assert str(refused.value)
    return str(refused.value)


@pytest.mark.parametrize("figure", ["0", "-3", ".inf", "nan", "1e999"])
@pytest.mark.parametrize("kind", FIRST)
def test_figures_out_of_range(kind, figure, tmp_path):
    name, text = FIRST[kind].split(": ")
    told = one_line(kind, tmp_path, (FIRST[kind], f"{name}: {figure} {text.split()[1]}"))
    assert name in told


@pytest.mark.parametrize("kind", [k for k in KINDS if k not in ("recorded", "wheeled_vehicle")])
def test_motions_without_speed_or_time(kind, tmp_path):
    """A trapezoid needs both; what stands still is sized as any other load, and takes a drive or none in time."""
    old = re.search(r"(?ms)^motion:.*?(?=^\w|\Z)", (STARTERS / f"{kind}.yaml").read_text(encoding="utf-8")).group()
    unit = "m/s" if AXES[kind] == "linear" else "rpm"
    for motion in (
        f"{{speed: 0 {unit}, acceleration_time: 1 s, cruise_time: 2 s}}",
        f"{{speed: 3 {unit}, acceleration_time: 0 s, cruise_time: 2 s}}",
    ):
        one_line(kind, tmp_path, (old, f"motion: {motion}\n"))
    held = size(starter(kind, tmp_path, (old, "motion: {profile: hold, time: 1 min}\n")), detail="drives")
    assert held.sets and {one.status for one in held.sets} == {"pass"}
    for one in held.sets:
        assert all(np.isfinite(x.value) for x in one.figures if x.name in ("power", "energy", "winding_temperature"))
