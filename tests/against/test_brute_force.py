"""The program against the same physics in plain Python (``by_hand``): every check, every verdict, the whole ranking."""

from __future__ import annotations

import itertools
import math
import random
from collections import Counter
from functools import cache
from pathlib import Path

import by_hand
import numpy as np
import pytest
import yaml

from drivesizer.catalog import load
from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases import load_cycle
from drivesizer.machine.problem import problem
from drivesizer.results.check_kinds import CHECKS
from drivesizer.search.columns.candidates import Candidates, candidates
from drivesizer.search.columns.evaluation import evaluate
from drivesizer.search.search import search
from drivesizer.sizing import size
from drivesizer.spec.robot import read_spec

PAIRS = 1000  # sets per load
COUNTS = {  # fewer of a cycle with hundreds of segments, more where one set in a hundred passes
    "arm swinging through": 120, "vehicle braking down a slope": 1600, "ball screw upright": 1600,
}  # fmt: skip

RECORDING = """time,speed,torque
s,rpm,N*m
0,0,0.2
0.5,40,1.4
1.1,35,-0.9
2.5,40,0.9
2.8,-12,-0.8
3.3,-9,0.7
3.6,0,-0.3
4.4,0,0.25
5,0,0
"""

TABLE = "rotary table, its rotor alone drives back"
LOADS = yaml.safe_load(Path(__file__).with_name("brute_force.yaml").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("brute")
    (found / "cycle.csv").write_text(RECORDING, encoding="utf-8")
    return found


def spec_of(name, folder, more=""):
    return read_spec(YamlSource(f"name: x\n{LOADS[name]}{more}", str(folder / "x.yaml")))


@cache
def records(section):
    table = load(["maxon"]).table(section)
    return [table.record(row) for row in range(len(table))]


@cache
def encoders_of():
    catalog, found = load(["maxon"]), {}
    for left, right in zip(catalog.motor_encoder.left.tolist(), catalog.motor_encoder.right.tolist(), strict=True):
        if not catalog.encoders.excluded[right]:
            found.setdefault(left, []).append(records("encoders")[right])
    return found


def some_pairs(catalog, count, seed):
    """Random pairs that the catalogue lists and that are on offer."""
    listing = catalog.motor_gearhead
    offered = ~catalog.motors.excluded[listing.left] & ~catalog.gearheads.excluded[listing.right]
    rows = random.Random(seed).sample(np.flatnonzero(offered).tolist(), count)
    left, right = listing.left[rows].astype(np.int64), listing.right[rows].astype(np.int64)
    return Candidates(left, right, np.ones(count), np.ones(count, bool))


def with_belts(pairs, belts):
    every = np.repeat(np.arange(len(pairs.motor)), len(belts))
    return pairs.on(every)._replace(belt=np.tile(np.array(belts), len(pairs.motor)))


def all_by_hand(spec, catalog, sets, drives=None):
    """Each set's checks, controller and demands; ``drives``: what of them is the same whatever the objective."""
    drives = {} if drives is None else drives
    cycle = load_cycle(spec)
    segments = by_hand.segments_of(cycle)
    offered = [c for c, out in zip(records("controllers"), catalog.controllers.excluded, strict=True) if not out]
    found = []
    for m, g, belt in zip(sets.motor.tolist(), sets.gearhead.tolist(), sets.belt.tolist(), strict=True):
        motor, head = records("motors")[m], records("gearheads")[g]
        speed = head.ratio * belt * max(abs(w) for segment in segments for w in segment.speed)
        for encoder in by_hand.encoders_for(spec, encoders_of().get(m, []), speed, head.ratio * belt):
            key = m, g, belt, getattr(encoder, "part", None)
            if key not in drives:
                drives[key] = drive_by_hand(spec, segments, (motor, head, encoder), belt)
            pieces, of = drives[key]
            one = *by_hand.chosen(spec, cycle, pieces, of, (motor, head, encoder), belt, offered), pieces
            if not fails_by_inertia(spec, one[0]):
                break
        found.append(one)
    return found


def fails_by_inertia(spec, checks):
    """Whether a set fails by what hangs on inertia alone, before its controller is looked at or with it."""
    idle = () if by_hand.encoder_required(spec) else ("encoder_speed", "encoder_frequency")
    failing = [n for n, one in checks.items() if one.status == "fail" and n not in idle]
    failing = [n for n in failing if n not in by_hand.ELECTRICAL] or failing
    return bool(failing) and all(CHECKS["physics"][n].on_inertia for n in failing)


def drive_by_hand(spec, segments, parts, belt):
    """The pieces of a set's cycle, and its demands with a controller."""
    motor, head, encoder = parts
    extra = by_hand.figure(encoder, "inertia")
    pieces = by_hand.drive(motor, head, 0.0 if math.isnan(extra) else extra, belt, spec.belt_efficiency, segments)
    kept = 1.0 - spec.supply.regeneration  # the rest of what comes back
    losing = by_hand.by_controller(pieces, motor, head, spec.environment.ambient, kept)

    def of(controller):
        assumed = 1.0 if spec.select.estimates == "on" else 0.0  # at least half of that
        return losing(*(by_hand.loss_per_ampere(controller, share * assumed) for share in (1.0, 0.5)))

    return pieces, of


@pytest.fixture(scope="module")
def worked(folder, catalog):
    """Random sets of each load, worked out both ways; once per load and objective."""
    drives = {name: {} for name in LOADS}

    @cache
    def of(name, objective="mass"):
        spec = spec_of(name, folder)
        spec = spec.with_select(spec.select.ranked_by(objective))
        count = COUNTS.get(name, PAIRS) // len(spec.belt_ratios)
        sets = with_belts(some_pairs(catalog, count, name), spec.belt_ratios)
        return spec, sets, all_by_hand(spec, catalog, sets, drives[name])

    return of


def same(a, b):
    return (math.isnan(a) and math.isnan(b)) or math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-15)


@pytest.mark.parametrize("name", LOADS)
def test_every_check_of_random_sets(name, worked, catalog):
    spec, sets, mine = worked(name)
    found = evaluate(problem(spec, catalog), sets)
    theirs = {check.name: check for check in found.checks}
    assert set(theirs) == set(mine[0][0])
    wrong = []
    for row, (checks, controller, asked, _) in enumerate(mine):
        others = set(by_hand.ELECTRICAL) - set(by_hand.OF_CONTROLLER)
        doomed = any(checks[n].status == "fail" for n in others if n in checks and not n.startswith("encoder"))
        for name_, verdict in checks.items():
            check = theirs[name_]
            if doomed and name_ in by_hand.OF_CONTROLLER:
                continue  # whatever its controller
            neither = "open" if np.broadcast_to(check.opened, check.passed.shape)[row] else "unknown"
            status = "pass" if check.passed[row] else "fail" if check.failed[row] else neither
            demand, limit = float(check.demand[row]), float(check.limit[row])
            if name_ == "bus_voltage" and 0.0 < asked.stored[1] < 1e-9 * asked.drawn:
                continue  # nothing or next to nothing: as rounding has it
            ok = status == verdict.status and (math.isnan(verdict.demand) or same(demand, verdict.demand))
            if not math.isnan(verdict.limit):
                ok &= same(limit, verdict.limit)
            if not ok:
                wrong.append((row, name_, status, demand, limit, verdict))
        chosen = int(found.controller[row])
        assert doomed or (chosen < 0) == (controller is None)
        if controller is not None and not doomed:
            assert records("controllers")[chosen].part == controller.part
    assert not wrong, (len(wrong), Counter(w[1] for w in wrong), wrong[:3])


def ranked(spec, sets, mine, objective, *, whole=True, controlling=None):
    """Rows of the sets that pass or may pass, those that lack least of what others have first, then what is known of
    all parts, then the better one, then the larger smallest margin.

    A set that lacks nothing but what all lack goes first, then one of which checks are open, then one with further
    unknown ones; of either that with the fewest such checks and doublings of limits up to their demands.

    ``whole``: the sets are all there are; ``controlling``: masses of each set's encoder and controller, NaN unknown.
    """
    rows, idle = [], () if by_hand.encoder_required(spec) else ("encoder_speed", "encoder_frequency")
    for row, (every, _, asked, _) in enumerate(mine):
        checks = {name: verdict for name, verdict in every.items() if name not in idle}
        if any(v.status == "fail" for v in checks.values()):
            continue
        motor, head = records("motors")[int(sets.motor[row])], records("gearheads")[int(sets.gearhead[row])]
        margin = min((v.margin for v in checks.values() if not math.isnan(v.margin)), default=math.inf)
        if objective == "mass":
            figures = [motor.mass, head.mass, *controlling[row]]
        elif objective == "energy":
            figures = [(asked.drawn - spec.supply.regeneration * asked.returned) * spec.load.motors]
        elif objective == "peak_current":
            figures = [asked.I_peak]
        else:
            figures = [-margin]
        known = [x for x in figures if not math.isnan(x)]
        lacks = {name for name, verdict in checks.items() if verdict.status == "unknown"}
        turning = [x for x in figures[:2] if math.isnan(x)]
        missing = 2 * len(turning) + len(figures) - len(known)  # before what is unknown of encoder and controller
        undecided = [v for v in checks.values() if v.status == "open"]
        key = (lacks, undecided, missing, sum(known), -margin)
        rows.append((key, motor.part, head.part, float(sets.belt[row])))
    alike = set.intersection(*(row[0][0] for row in rows)) if whole else set()
    return sorted(((standing(lacks - alike, opened), *more), *names) for (lacks, opened, *more), *names in rows)


def standing(lacks, opened):
    """Whether a set passes, is open or unknown, as 0, 1, 2, and of how much."""
    doubled = sum(max(int(math.log2(v.demand / v.limit)), 0) for v in opened)
    return (2 if lacks else 1 if opened else 0), len(lacks) + len(opened) + doubled


OBJECTIVES = ("mass", "energy", "peak_current", "margin")


def controlling(spec, catalog, sets):
    """Masses of encoder and controller of each set, NaN where none is listed."""
    found = evaluate(problem(spec, catalog), sets)
    tables = (catalog.encoders["mass"], found.encoder), (catalog.controllers["mass"], found.controller)
    return list(zip(*(np.append(mass, np.nan)[rows].tolist() for mass, rows in tables), strict=True))


@pytest.mark.parametrize(("name", "objective"), [*zip(LOADS, itertools.cycle(OBJECTIVES), strict=False)])
def test_the_ranking(name, objective, worked, catalog, monkeypatch):
    """The whole order of the same sets, as the search gives it."""
    spec, sets, mine = worked(name, objective)
    one_each = sets.on(np.flatnonzero(sets.belt == spec.belt_ratios[0]))
    monkeypatch.setattr("drivesizer.search.passing.pairs", lambda *_, **__: one_each)
    found = search(problem(spec, catalog), top=10**6, misses=0)
    expected = ranked(spec, sets, mine, objective, controlling=controlling(spec, catalog, sets))
    assert found.counts.considered == len(mine)
    assert found.counts.feasible == found.passing == len(expected) > 10
    order = []
    for row in range(found.passing):
        s = found.evaluation.candidates
        motor, head = records("motors")[int(s.motor[row])], records("gearheads")[int(s.gearhead[row])]
        order.append((motor.part, head.part, float(s.belt[row])))
    keys = {tuple(row[1:]): row[0] for row in expected}
    assert set(order) == set(keys)
    for one, other in itertools.pairwise(order):
        a, b = keys[one], keys[other]
        if a[:2] != b[:2] or not same(a[2], b[2]):
            assert a < b, (one, other)
        elif not same(a[3], b[3]):
            assert a[3] < b[3], (one, other)
        elif a[2:] == b[2:]:
            assert one < other  # of equals by part number


def test_resolution_at_the_load_counts_the_belt(catalog):
    """An edge of 4 x counts per motor turn is, at the load, that over the whole reduction; the belt turns it too."""
    text = LOADS["vehicle braking down a slope"] + "select: {motor: {part: 118752}, gearhead: {family: GP 26 A}}\n"
    spec = read_spec(
        YamlSource(f"name: x\n{text.replace('needs: {', 'needs: {resolution_at_load: 3 deg, ')}", "x.yaml")
    )
    found = evaluate(problem(spec, catalog), candidates(problem(spec, catalog)))
    check = next(c for c in found.checks if c.name == "encoder_resolution")
    counts = catalog.encoders["counts_per_turn"][found.encoder]
    whole = catalog.gearheads["ratio"][found.candidates.gearhead] * found.candidates.belt
    assert check.demand == pytest.approx(2 * math.pi / (4 * counts * whole), rel=1e-12)


def test_size_takes_the_same_best_set(worked, catalog):
    """From the outside: the first set of the whole catalogue is no worse than the first of the random ones."""
    spec, sets, mine = worked("hoist lowering past its counterweight")
    ((certainty, _), _, mass, _), *_ = ranked(
        spec, sets, mine, "mass", whole=False, controlling=controlling(spec, catalog, sets)
    )[0]
    first = size(spec, catalog=catalog, top=1).sets[0]
    assert (("pass", "open", "unknown").index(first.status), first.objective) <= (certainty, mass)


def test_the_winding_follows_a_torque_that_rises_slowly(tmp_path, catalog):
    """A recording of few samples: torque from nothing to 2 N·m in 20 s, ten winding time constants, at one speed."""
    (tmp_path / "cycle.csv").write_text("time,speed,torque\ns,rpm,N*m\n0,25,0\n20,25,2\n20.1,25,0\n40,25,0\n", "utf-8")
    spec = spec_of("recorded", tmp_path)
    sets = some_pairs(catalog, 60, "slow")._replace(belt=np.full(60, 0.7))
    found = evaluate(problem(spec, catalog), sets)
    check = next(c for c in found.checks if c.name == "winding_temperature")
    ambient, seen = spec.environment.ambient, 0
    for row, (_, _, asked, pieces) in enumerate(all_by_hand(spec, catalog, sets)):
        motor = records("motors")[int(sets.motor[row])]
        if seen < 4 and 2.0 < asked.winding[0] - ambient < 200.0 and motor.winding_time_constant < 4.0:
            seen += 1
            rise = by_hand.simulated_peak(pieces, motor, ambient, 200) - ambient
            assert check.demand[row] - ambient == pytest.approx(rise, rel=2e-3)
    assert seen
