"""Forces on output shafts: printed cases, laws, every check in plain Python over random machines, refusals."""

import math
import random

import numpy as np
import pytest
from refusals import refusal

from drivesizer.catalog.parts import DIRECT
from drivesizer.errors import InputError
from drivesizer.load_cases import load_cycle
from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.physics.gear_life import bearing_life, dynamic_load, permissible_radial, pulley_load, static_load
from drivesizer.search.columns.limits import load_limits
from drivesizer.search.columns.shaft_limits import loads_on_gearheads, loads_on_motors, shaft_loads
from drivesizer.sizing import size
from drivesizer.spec.robot import load_spec

RACK = {"kind": "rack_pinion", "mass": "100 kg", "pinion_diameter": "50 mm"}
MOTION = {"speed": "0.5 m/s", "acceleration_time": "0.5 s", "cruise_time": "1 s", "rest_time": "0.7 s",
          "there_and_back": True}  # fmt: skip
TURNED = {"speed": "3 rad/s", "acceleration_time": "0.5 s", "cruise_time": "1 s", "rest_time": "0.7 s"}
FIGURES = ("max_radial_load", "radial_load_distance", "max_axial_load", "max_tilting_moment", "bearing_distance",
           "bearing_diameter", "bearing_dynamic_load", "bearing_static_load")  # fmt: skip


def spec_of(load=RACK, motion=MOTION, **sections):
    return load_spec({"name": "x", "load": load, "motion": motion, "supply": {"nominal": "48 V"}, **sections})


def at(spec, belt=1.0):
    return CycleAtBelt(load_cycle(spec), spec.belt_efficiency).behind(belt)


def loads_of(spec, belt=1.0):
    return shaft_loads(spec, at(spec, belt), None)


def gearheads(**figures):
    return {name: np.atleast_1d(figures.get(name, math.nan)) for name in FIGURES}


def checks(spec, belt=1.0, **figures):
    return {check.name: check for check in loads_on_gearheads(spec, at(spec, belt), None, gearheads(**figures))}


# --- as printed


def test_belt_as_printed():
    """ServoSoft help, belt forces: twice the preload of 700 N, or the force of acceleration where that is more."""
    assert pulley_load(500.0, 700.0) == pytest.approx(2 * 700.0)
    assert pulley_load(1500.0, 700.0) == pytest.approx(1500.0)
    tight, slack, wrap = 950.0, 450.0, math.radians(150.0)  # Machine Design: F² = T1² + T2² - 2 T1 T2 cos(wrap)
    expected = math.sqrt(tight**2 + slack**2 - 2 * tight * slack * math.cos(wrap))
    assert pulley_load(500.0, 700.0, math.pi - wrap) == pytest.approx(expected)


def test_rack_as_printed():
    """Atlanta Drive Systems: 300 kg upward at 4 m/s² are 4.1 kN at the toothing; on the shaft over cos 20°."""
    load = {"kind": "rack_pinion", "mass": "300 kg", "pinion_diameter": "63.66 mm", "incline": "90 deg"}
    motion = {"speed": "1.08 m/s", "acceleration_time": "0.27 s", "cruise_time": "1 s", "there_and_back": True}
    found = loads_of(spec_of(load, motion, shaft={"carries_load": True}))
    assert found.radial * math.cos(math.radians(20.0)) == pytest.approx(4.1e3, abs=50.0)
    assert found.axial == 0.0


def test_screw_as_printed():
    """THK A-739: 585 N of thrust."""
    load = {"kind": "ball_screw", "mass": "50 kg", "lead": "10 mm", "efficiency": 0.9, "incline": "90 deg",
            "friction_force": "20 N", "inertia": "1 kg*cm^2"}  # fmt: skip
    motion = {"speed": "0.3 m/s", "acceleration_time": "0.2 s", "cruise_time": "1.8 s", "there_and_back": True}
    spec = spec_of(load, motion, shaft={"carries_load": True})
    found = loads_of(spec)
    assert (float(found.axial), float(found.radial)) == (pytest.approx(585, abs=0.5), 0.0)
    assert "screw_axial_force" not in {check.name for check in load_limits(spec, at(spec))}


def test_bearing_of_iso_281():
    """C = P lasts a million turns, 500 h at 33 1/3 rpm; a tenth of the load 10^(10/3) times as long."""
    speed = 100.0 / 3.0 * math.pi / 30.0
    assert bearing_life(5290.0, 5290.0, speed) / 3600.0 == pytest.approx(500.0)
    assert bearing_life(5290.0, 529.0, speed) / 3600.0 == pytest.approx(500.0 * 10.0 ** (10.0 / 3.0))
    assert bearing_life(5290.0, 0.0, speed) == math.inf
    assert static_load(100.0, 50.0, 3.0, 0.06) == pytest.approx(100.0 + 100.0 + 22.0)
    assert dynamic_load(100.0, 50.0, 3.0, 0.06) == pytest.approx(200.0 + 0.45 * 50.0)
    assert dynamic_load(100.0, 301.0, 3.0, 0.06) == pytest.approx(0.67 * 501.0)


# --- laws


def test_conversion_keeps_the_moment_and_never_grows_without_the_bearing():
    for a in (0.0, 0.02, 0.05):
        moment = permissible_radial(900.0, 0.015, 0.04, a) * (0.04 + a)
        assert moment == pytest.approx(900.0 * (0.015 + a))
    assert permissible_radial(900.0, 0.015, 0.04, math.nan) <= permissible_radial(900.0, 0.015, 0.04, 0.02)
    assert permissible_radial(900.0, 0.015, 0.005, math.nan) == 900.0
    assert math.isnan(permissible_radial(900.0, math.nan, 0.005, 0.02))
    assert permissible_radial(math.inf, math.nan, 0.005, math.nan) == math.inf


def test_where_the_load_drives_the_force_is_before_the_losses():
    """Lowered by a rack at 80 %: the tooth bears what the load weighs, and the pinion sees four fifths of it."""
    load = RACK | {"incline": "90 deg", "efficiency": 0.8}
    down = spec_of(load, {"profile": "segments", "segments": [{"time": "9 s", "to": "-0.01 m/s"},
                   {"time": "9 s", "to": "0 m/s"}]},
                   shaft={"carries_load": True, "pressure_angle": "0 deg"})  # fmt: skip
    assert loads_of(down).radial == pytest.approx(100 * 9.80665, rel=1e-3)


def test_without_pretension_a_belt_may_fail_but_not_pass():
    stage = {"kind": "belt", "ratio": 2, "efficiency": 0.9, "pulley_diameter": "80 mm"}
    spec = spec_of(transmission=[{"kind": "gearhead"}, stage], shaft={"distance": "10 mm"})
    for limit, failed in ((1e6, False), (1.0, True)):
        found = checks(spec, 2.0, max_radial_load=limit, radial_load_distance=0.01)["gearhead_radial_load"]
        assert (bool(found.passed[0]), bool(found.failed[0])) == (False, failed)
    assert found.at(0, "physics").status == "fail"
    open_ = checks(spec, 2.0, max_radial_load=1e6, radial_load_distance=0.01)["gearhead_radial_load"].at(0, "physics")
    assert (open_.status, open_.note) == ("unknown", "unknown: the belt's pretension")


def test_a_wheel_bears_its_part_of_the_weight():
    load = {"kind": "wheeled_vehicle", "mass": "80 kg", "driven_wheels": 2, "wheel_diameter": "200 mm",
            "rolling_resistance": 0.02, "inertia": "0 kg*m^2", "driven_share": 0.6}  # fmt: skip
    found = loads_of(spec_of(load, MOTION | {"there_and_back": False}, shaft={"carries_load": True}))
    along = 80 * 9.80665 * 0.02 / 2 + 40 * 1.0
    assert found.radial == pytest.approx(math.hypot(0.6 * 80 * 9.80665 / 2, along))


# --- every check in plain Python


def random_machine(rng):
    """A spec with something on its shaft, its belt ratio, and its forces by the torque there in plain Python."""
    diameter, other, e = rng.uniform(0.02, 0.2), rng.uniform(0.02, 0.2), rng.uniform(0.6, 1.0)
    pressure, helix, pretension = rng.uniform(0.0, 0.5), rng.choice([0.0, 0.3]), rng.uniform(0.0, 900.0)
    distance = rng.choice([None, rng.uniform(0.0, 0.08)])
    kind, belt, sections, load = rng.choice(["rack", "axis", "belt", "gear", "chain", "hoist"]), 1.0, {}, dict(RACK)
    load["mass"], shaft = f"{rng.uniform(5, 200)} kg", {"carries_load": kind in ("rack", "axis", "hoist")}
    shaft |= {"pressure_angle": f"{pressure} rad", "helix_angle": f"{helix} rad", "belt_pretension": f"{pretension} N"}
    shaft |= {} if distance is None else {"distance": f"{distance} m"}
    tooth = math.hypot(1.0, math.tan(pressure) / math.cos(helix)), math.tan(helix)

    def strands(x):
        return max(2.0 * pretension, x), 0.0

    if kind == "rack":
        load |= {"pinion_diameter": f"{diameter} m", "efficiency": e, "incline": "30 deg"}
        forces = lambda x: (tooth[0] * x, tooth[1] * x)  # noqa: E731
    elif kind == "axis":
        load = {"kind": "belt_axis", "mass": "20 kg", "pulley_diameter": f"{diameter} m", "efficiency": e}
        forces = strands
    elif kind == "hoist":
        load = {"kind": "hoist", "mass": "90 kg", "drum_diameter": f"{diameter} m", "rope_efficiency": e}
        forces = lambda x: (x, 0.0)  # noqa: E731
    else:
        belt = rng.uniform(0.5, 3.0) if kind == "belt" else 1.0
        stage = {"kind": kind, "ratio": belt if kind == "belt" else 2.5, "efficiency": e}
        stage["pulley_diameter" if kind == "belt" else "pinion_diameter"] = f"{diameter} m"
        diameter = diameter / belt if kind == "belt" else diameter
        sections["transmission"] = [{"kind": "gearhead"}, stage]
        load |= {"pinion_diameter": f"{other} m", "incline": "30 deg"}
        forces = {"belt": strands, "chain": lambda x: (x, 0.0), "gear": lambda x: (tooth[0] * x, tooth[1] * x)}[kind]
    more = [rng.choice([None, rng.uniform(1.0, 300.0)]) for _ in range(3)]
    units = {"radial_load": "N", "axial_load": "N", "tilting_moment": "N*m"}
    needs = {name: f"{x} {unit}" for (name, unit), x in zip(units.items(), more, strict=True) if x is not None}
    needs["life"] = f"{rng.uniform(10.0, 1e6)} h"
    spec = spec_of(load, shaft=shaft, needs=needs, **sections)
    return spec, belt, (diameter, e, forces, [x or 0.0 for x in more], distance)


def plain_loads(spec, belt, known):
    """Largest forces and moment, their means by speed and time, and the mean speed."""
    diameter, e, forces, more, _ = known
    cycle, most, sums, turned = load_cycle(spec), [0.0] * 3, [0.0] * 3, 0.0
    on_belt = spec.belt_efficiency
    for time, ts, ws in zip(cycle.duration, cycle.torque, cycle.speed, strict=True):
        power = sum(ts) * sum(ws)
        steps = 40
        for k in range(-1, steps + 1):
            x = 0.0 if k < 0 else 1.0 if k == steps else (k + 0.5) / steps
            t, w = abs(ts[0] + (ts[1] - ts[0]) * x), abs(ws[0] + (ws[1] - ws[0]) * x) * belt
            still = ws[0] == ws[1] == 0.0
            t = t / belt if still else t / belt / on_belt if power > 0.0 else t / belt * on_belt
            along = t / (1.0 if still or power > 0.0 else e) / (diameter / 2.0)
            radial, axial = forces(along)
            three = [radial + more[0], axial + more[1], axial * diameter / 2.0 + more[2]]
            most = [max(a, b) for a, b in zip(most, three, strict=True)]
            if 0 <= k < steps:
                turned += w * time / steps
                sums = [s + y ** (10.0 / 3.0) * w * time / steps for s, y in zip(sums, three, strict=True)]
    return most, [(s / turned) ** 0.3 for s in sums], turned / float(cycle.duration.sum())


def plain_verdicts(spec, known, loads, g):
    """True, False or None of each check of one gearhead."""
    (radial, axial, moment), means, speed = loads
    distance, unknown = known[4], math.isnan
    a = g["bearing_distance"]
    if unknown(a):
        a = g["max_tilting_moment"] / g["max_radial_load"] - g["radial_load_distance"]
        a = math.nan if a < 0.0 else a
    x = g["radial_load_distance"] if distance is None else distance
    limit = g["max_radial_load"]
    if distance is not None:
        if unknown(limit):
            limit = math.nan if unknown(g["max_tilting_moment"]) else math.inf
        elif unknown(g["radial_load_distance"]):
            limit = math.nan if unknown(g["max_tilting_moment"]) else limit
        elif unknown(a):
            limit *= min(1.0, g["radial_load_distance"] / x)
        else:
            limit *= (g["radial_load_distance"] + a) / (x + a)

    def compared(demand, most):
        return True if most == math.inf else None if unknown(demand) or unknown(most) else bool(demand <= most)

    found = {"gearhead_radial_load": compared(radial, limit)}
    if axial or spec.needs.axial_load is not None:
        found["gearhead_axial_load"] = compared(axial, g["max_axial_load"])
    rated = not (unknown(g["max_radial_load"]) and unknown(g["max_tilting_moment"]))
    if distance is not None or spec.needs.tilting_moment is not None:
        most = g["max_tilting_moment"]
        most = math.inf if unknown(most) and rated else most
        far = g["max_tilting_moment"] / g["max_radial_load"] if unknown(a) else a
        low, high = (radial * (x + end) + moment for end in (0.0 if unknown(a) else a, far))
        passed, failed = compared(high, most), compared(low, most)
        found["gearhead_tilting_moment"] = True if passed else False if failed is False else None
    d, safety, wear = g["bearing_diameter"], spec.shaft.static_safety, spec.shaft.load_factor
    static, rating = g["bearing_static_load"], g["bearing_dynamic_load"]
    still = (radial + 2.0 * (radial * (x + a) + moment) / d + 0.44 * axial) * safety
    found["gearhead_bearing_static"] = True if unknown(static) and rated else compared(still, static)
    rest = means[0] + 2.0 * (means[0] * (x + a) + means[2]) / d
    load = (0.67 * (rest + means[1]) if means[1] > 1.5 * rest else rest + 0.45 * means[1]) * wear
    life = 1e6 * 2.0 * math.pi / speed * (rating / load) ** (10.0 / 3.0)
    found["gearhead_bearing_life"] = True if unknown(rating) and rated else compared(spec.needs.life, life)
    return found


def test_every_check_of_random_shafts_and_gearheads():
    rng = random.Random(11)

    def some(low, high):
        return rng.choice([math.nan, rng.uniform(low, high), rng.uniform(low, high)])

    ends, seen = (
        ((1.0, 5e3), (0.0, 0.05), (1.0, 900.0), (1.0, 300.0), (0.0, 0.05), (0.02, 0.2), (1e2, 2e4), (1e2, 2e4)),
        set(),
    )
    for _ in range(40):
        spec, belt, known = random_machine(rng)
        loads = plain_loads(spec, belt, known)
        of_each = [{name: some(*end) for name, end in zip(FIGURES, ends, strict=True)} for _ in range(15)]
        found = checks(spec, belt, **{name: [g[name] for g in of_each] for name in FIGURES})
        for row, g in enumerate(of_each):
            expected = plain_verdicts(spec, known, loads, g)
            got = {n: True if c.passed[row] else False if c.failed[row] else None for n, c in found.items()}
            assert got == expected, (spec.load.kind, g)
            seen |= set(got.items())
    assert len(seen) == 15  # each of five checks passes, fails and is unknown


def test_motors_bear_the_load_where_there_is_no_gearhead():
    spec = spec_of(shaft={"carries_load": True, "distance": "20 mm", "helix_angle": "0.3 rad"})
    motor = {"max_radial_load": np.array([500.0, 500.0]), "radial_load_distance": np.array([0.01, 0.01]),
             "max_axial_load": np.array([1.0, 1.0])}  # fmt: skip
    found = loads_on_motors(spec, at(spec), None, motor, {"kind": np.array([DIRECT, "planetary"])})
    radial, axial = found
    assert (radial.name, axial.name) == ("motor_radial_load", "motor_axial_load")
    assert radial.limit.tolist() == [250.0, math.inf]
    assert axial.failed.tolist() == [True, False]


def test_a_toleranced_distance_gives_the_share_that_its_range_says(no_further_searches):
    """A radial limit of 420 N at 12 mm holds the load up to a distance x: of 20 to 30 mm the share below x passes."""
    spec = spec_of(
        RACK | {"mass": "40 kg"}, shaft={"carries_load": True, "distance": "25 +- 5 mm", "pressure_angle": "0 deg"},
        needs={"radial_load": "140 N"},
        select={"catalogs": ["maxon"], "gearhead": {"part": "223081"}, "motor": {"part": "148867"}},
    )  # fmt: skip
    result = size(spec, top=1)
    best = (*result.sets, *result.unsure, *result.misses)[0]
    load = next(check for check in best.checks if check.name == "gearhead_radial_load")
    share = next(one for one in best.reliability.checks if one.name == "gearhead_radial_load")
    assert load.demand == pytest.approx(140.0 + 40.0)
    limit = best.gearhead.max_radial_load * best.gearhead.radial_load_distance
    assert share.passes == pytest.approx((limit / load.demand - 0.020) / 0.010, abs=0.01)


# --- what is refused


@pytest.mark.parametrize(
    ("sections", "said"),
    [
        ({"shaft": {"distance": "-1 mm"}}, "must be at least 0 m"),
        ({"shaft": {"distance": "9 mm"}}, "nothing acts on it"),
        ({"shaft": {"carries_load": True}, "transmission": [{"kind": "gearhead"}, {"kind": "chain", "ratio": 2,
          "efficiency": 0.9}]}, "the chain is on this shaft"),
        ({"transmission": [{"kind": "gearhead"}, {"kind": "worm", "ratio": 20, "efficiency": 0.6,
          "pinion_diameter": "20 mm"}]}, "forces of a worm are not computed"),
    ],
)  # fmt: skip
def test_wrong_figures_are_refused_in_one_line(sections, said):
    assert said in refusal(lambda: spec_of(**sections))


def test_loads_that_tell_no_force_are_refused_on_the_shaft():
    table = {"kind": "rotary_table", "inertia": "1 kg*m^2"}
    with pytest.raises(InputError, match="a rotary_table has no known force"):
        spec_of(table, TURNED, shaft={"carries_load": True})
