"""A gear of fixed ratio between gearhead and load: a maker's example, the same by plain Python, laws, refusals."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from refusals import refusal

from drivesizer.errors import InputError
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.platform import at_shaft
from drivesizer.loads.stage_losses import FixedGear, through_gear
from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.physics.load_cycle import LoadCycle, integral
from drivesizer.search.columns.limits import load_limits, lost_at_load
from drivesizer.search.uncertainty.uncertain_figures import applied
from drivesizer.spec.robot import load_spec

SLIDE = {"kind": "ball_screw", "mass": "250 kg", "friction_coefficient": 0.2, "lead": "10 mm", "efficiency": 0.9,
         "inertia": {"diameter": "20 mm", "length": "1 m", "density": "7870 kg/m^3"}}  # fmt: skip
HOIST = {"kind": "hoist", "mass": "40 kg", "drum_diameter": "100 mm"}
MOTION = {"speed": "15 m/min", "acceleration_time": "0.1 s", "cruise_time": "1 s", "there_and_back": True}
BELT = {"kind": "belt", "ratio": 1.5, "efficiency": 0.95, "inertia": "3 kg*cm^2", "pulley_diameter": "60 mm",
        "max_tension": "2 kN", "max_speed": "3 m/s"}  # fmt: skip
WORM = {"kind": "worm", "ratio": 20, "efficiency": 0.45}


def spec_of(*stages, load=SLIDE, motion=MOTION, **more):
    return load_spec({
        "name": "axis", "load": load, "motion": motion, "transmission": [{"kind": "direct"}, *stages],
        "supply": {"nominal": "48 V"}, "environment": {"gravity": "9.8 m/s^2"}, **more,
    })  # fmt: skip


def test_screw_behind_a_gear_of_yaskawa():
    """Servomotor selection, selection calculations: 3000 rpm, 0.43 N·m, 135 W and 2.29 kg·cm² at the motor."""
    gear = {"kind": "gear", "ratio": 2, "efficiency": 1, "pinion_inertia": "0.40 kg*cm^2"}
    cycle = load_cycle(spec_of(gear))
    running = cycle.torque[1, 0]
    assert cycle.speed.max() * 30 / math.pi == pytest.approx(3000)
    assert running == pytest.approx(0.43, abs=0.005)
    assert cycle.inertia == pytest.approx(2.29e-4, abs=0.005e-4)
    assert 0.43 * 3000 * math.pi / 30 == pytest.approx(135, abs=0.5)  # printed from the rounded torque
    assert cycle.power[1, 0] == pytest.approx(135, rel=0.01)


figure, share = st.floats(-5.0, 5.0), st.floats(0.05, 1.0)
GEARS = st.builds(
    FixedGear, st.floats(0.2, 60.0), share, st.floats(-1.0, 1.0), *[st.floats(0.0, 0.1)] * 2, *[st.floats(0.0, 1.0)] * 2
)


@settings(max_examples=60)
@given(GEARS, st.lists(st.tuples(figure, figure, figure, figure), min_size=1, max_size=6))
def test_every_moment_by_plain_python(gear, ends):
    """Speed and torque at the input shaft at moments all over the cycle, one by one."""
    speed = np.array([[w, w + 2 * a] for w, a, _, _ in ends])
    cycle = LoadCycle("x", np.full(len(ends), 2.0), speed, np.array([[a, a] for _, a, _, _ in ends]),
                      np.array([[t, u] for _, _, t, u in ends])).split()  # fmt: skip
    found = through_gear(cycle, gear)
    assert found.total == pytest.approx(cycle.total)
    for moment in np.linspace(0.03, 0.97, 9) * cycle.total:
        w, a, torque = (at(cycle, name, moment) for name in ("speed", "acceleration", "torque"))
        edges = np.concatenate([np.cumsum(cycle.duration), np.cumsum(found.duration)])
        if abs(w) < 1e-6 or np.abs(edges - moment).min() < 1e-9:  # at an edge figures may jump
            continue
        sign = math.copysign(1.0, w)
        wheel = torque + gear.wheel_inertia * a + gear.wheel_friction * sign
        factor = 1 / gear.efficiency if wheel * w > 0 else gear.back_efficiency
        expected = wheel * factor / gear.ratio + gear.pinion_inertia * a * gear.ratio + gear.pinion_friction * sign
        assert at(found, "speed", moment) == pytest.approx(w * gear.ratio, abs=1e-9)
        assert at(found, "torque", moment) == pytest.approx(expected, abs=1e-7 + 1e-7 * abs(expected))


def at(cycle, name, moment):
    """A figure of a cycle at a moment between the ends of its segments."""
    row = int(np.searchsorted(np.cumsum(cycle.duration), moment))
    left, right = getattr(cycle, name)[row]
    share = (moment - cycle.time[row, 0]) / cycle.duration[row]
    return left + share * (right - left)


def test_a_self_locking_worm_holds_and_drives_down():
    """2 - 1/0.45 is below 0: nothing at rest, and a lowered load takes power."""
    motion = MOTION | {"rest_time": "1 s"}
    worm, open_worm = (load_cycle(spec_of(WORM | {"efficiency": e}, load=HOIST, motion=motion)) for e in (0.45, 0.8))
    at_rest = (worm.speed == 0.0).all(axis=1)
    assert not worm.torque[at_rest].any()
    assert open_worm.torque[(open_worm.speed == 0.0).all(axis=1)] == pytest.approx(40 * 9.8 * 0.05 / 20)
    down = worm.speed[:, 0] + worm.speed[:, 1] < 0
    assert (worm.power[down] >= 0).all()
    assert (worm.power[down] > 0).any()


def test_work_in_is_work_out_where_nothing_is_lost():
    one, other = (load_cycle(spec_of(*stages)) for stages in ((), ({"kind": "bevel", "ratio": 3.5, "efficiency": 1},)))
    assert integral(other.duration, other.torque, other.speed) == pytest.approx(
        integral(one.duration, one.torque, one.speed)
    )
    assert other.inertia == pytest.approx(one.inertia / 3.5**2)
    assert other.radius == pytest.approx(one.radius / 3.5)


def test_before_the_belt_as_behind_it():
    """Ratio and efficiency of a gear are the same on either side of a belt; the belt's limits are its own."""
    gear = {"kind": "chain", "ratio": 2.5, "efficiency": 0.93}
    bare = {k: v for k, v in BELT.items() if k != "inertia"}
    behind, before = (spec_of(*stages, load=HOIST) for stages in ((bare, gear), (gear, bare)))
    one, other = load_cycle(behind), load_cycle(before)
    assert (one.torque == other.torque).all()
    assert (one.speed == other.speed).all()
    at_load = load_cycle(spec_of(bare, load=HOIST))
    tension, speed = other.own
    assert tension.demand == pytest.approx(np.abs(at_load.torque).max() / 0.03)
    assert speed.demand == pytest.approx(np.abs(at_load.speed).max() * 0.03)
    for spec, torque in ((behind, one), (before, at_load)):  # at the belt's own driven pulley
        at_belt = CycleAtBelt(load_cycle(spec), spec.belt_efficiency).behind(1.5)
        found = {check.name: float(np.max(check.demand)) for check in load_limits(spec, at_belt)}
        assert found["belt_tension"] == pytest.approx(np.abs(torque.torque).max() / 0.03)


@pytest.mark.parametrize("before", [False, True])
def test_in_closed_loop_the_shaft_has_the_same_torques(before):
    """The constants of the directions and the inertia are those of the cycle at steady speed."""
    gear = WORM | {"efficiency": 0.8, "pinion_friction": "5 mN*m", "wheel_friction": "0.4 N*m",
                   "pinion_inertia": "1 kg*cm^2", "wheel_inertia": "9 kg*cm^2"}  # fmt: skip
    belt = BELT | {"friction_torque": "0.2 N*m"}
    spec = spec_of(*((gear, belt) if before else (belt, gear)), load=HOIST)
    cycle, shaft = load_cycle(spec), at_shaft(spec)
    steady = [n for n in range(len(cycle.duration)) if not cycle.acceleration[n].any()]
    up, down = (next(n for n in steady if sign * cycle.speed[n, 0] > 0) for sign in (1, -1))
    assert shaft.forward_torque == pytest.approx(cycle.torque[up, 0])
    assert shaft.backward_torque == pytest.approx(cycle.torque[down, 0])
    assert (shaft.inertia, shaft.radius) == pytest.approx((cycle.inertia, cycle.radius))


def test_friction_of_a_belt_is_against_the_motion():
    one, other = (load_cycle(spec_of(BELT | {"friction_torque": f"{t} N*m"})) for t in (0, 0.3))
    assert other.torque - one.torque == pytest.approx(0.3 * np.sign(one.speed.mean(axis=1, keepdims=True)) * [[1, 1]])


def test_backlash_at_the_load():
    """Of the gearhead over all ratios behind it, of the gear over those behind it; unknown where it is not given."""
    gear = {"kind": "gear", "ratio": 4, "efficiency": 0.97, "backlash": "0.2 deg"}
    own = math.radians(0.2)
    assert lost_at_load(spec_of(BELT, gear), np.array([0.012]), 1.5) == pytest.approx([0.012 / 6 + own])
    assert lost_at_load(spec_of(gear, BELT), np.array([0.012]), 1.5) == pytest.approx([0.012 / 6 + own / 1.5])
    assert np.isnan(lost_at_load(spec_of({"kind": "gear", "ratio": 4, "efficiency": 0.97}), np.array([0.01]), 1.0))


def test_a_tolerance_of_its_efficiency_moves_the_load_cycle():
    spec = spec_of(WORM | {"efficiency": "0.45 in 0.40..0.50"}, load=HOIST)
    (one,) = spec.toleranced
    moved = load_cycle(applied(spec, {one.path: 0.05}))
    assert moved.torque.max() == pytest.approx(load_cycle(spec).torque.max() * 0.45 / 0.50)


@pytest.mark.parametrize(
    ("stages", "line"),
    [
        ([BELT, BELT], "transmission must be a gearhead or direct, or one of them and then a belt, gears"),
        ([BELT, {"kind": "gearhead"}], "transmission must be a gearhead or direct"),
        ([{"kind": "gear", "ratio": 2}], r"transmission\[2\].efficiency: is missing; expected plain number"),
        ([WORM | {"pinion_inertia": "1 kg*cm^2"}, {"kind": "belt", "ratios": [1, 2], "efficiency": 0.95}],
         "inertia and friction of a worm before a belt need the one ratio of the belt"),
        ([WORM, {"kind": "belt", "efficiency": 0.95, "max_tension": "1 kN", "pulleys": {
            "profile": "HTD", "pitch": "5 mm", "width": "15 mm", "ratio_min": 1, "ratio_max": 2}}],
         "max_tension and max_speed of pulleys behind a worm are not checked"),
    ],
)  # fmt: skip
def test_refused_in_one_line(stages, line):
    refusal(lambda: spec_of(*stages), match=line)


def test_two_stages_in_series_by_hand():
    """Spur gears and a chain behind a gearhead: ratios and efficiencies multiply."""
    spur = {
        "kind": "gear",
        "ratio": 3,
        "efficiency": 0.9,
        "wheel_inertia": "2 kg*cm^2",
        "backlash": "6 arcmin",
        "mass": "1 kg",
    }
    chain = {"kind": "chain", "ratio": 2, "efficiency": 0.8, "pinion_friction": "0.1 N*m", "backlash": "4 arcmin"}
    spec = spec_of(spur, chain, load=HOIST)
    both, alone = load_cycle(spec), load_cycle(spec_of(load=HOIST))
    lifting = (both.speed > 0).all(axis=1) & (both.acceleration == 0).all(axis=1)
    assert both.speed.max() == pytest.approx(6 * alone.speed.max())
    weight = 40 * 9.8 * 0.05
    assert both.torque[lifting][0] == pytest.approx([(weight / (2 * 0.8) + 0.1) / (3 * 0.9)] * 2)
    assert both.inertia == pytest.approx((40 * 0.05**2 / 4 + 2e-4) / 9)
    backlash = lost_at_load(spec, np.zeros(1), np.ones(1))
    assert float(backlash[0]) == pytest.approx(math.radians((4 + 6 / 2) / 60))
    assert spec.gear is not None and spec.gear.mass is None  # of one of them it is not known
    assert (spec.gear.kind, spec.gear.ratio, spec.gear.back_efficiency) == ("gear and chain", 6.0, pytest.approx(0.72))
    before = spec_of(spur, chain, BELT, load=HOIST)
    assert load_cycle(before).speed.max() == pytest.approx(6 * alone.speed.max())  # the belt's ratio is the search's
    with pytest.raises(InputError, match="and then a belt, gears in a row, or both"):
        spec_of(spur, BELT, chain)
