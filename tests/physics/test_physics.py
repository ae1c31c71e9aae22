"""The physics as a whole: load cases, margins at their limit, objectives, fronts, the same bytes."""

import math
from dataclasses import replace
from math import nan
from types import SimpleNamespace

import by_hand
import numpy as np
import pytest
from specs import estimates_off

from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases import load_cycle
from drivesizer.machine.problem import problem
from drivesizer.physics.drive_train import gear_loss
from drivesizer.results.ratings import supply_voltage_limit
from drivesizer.search.columns.candidates import candidates
from drivesizer.search.columns.evaluation import evaluate
from drivesizer.search.columns.limits import motor_limits
from drivesizer.search.ranking import objective_of
from drivesizer.search.search import search
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")


def spec_from(text):
    return read_spec(YamlSource(text, "x.yaml"))


def test_35_to_1_is_admitted_by_physics_for_its_speed_but_not_its_voltage(spec, catalog):
    """The transcription: physics knows no reserve, the wheel turns at 188.0 rpm, 35:1 at 7232 rpm."""
    found = explain(spec, "118752", "406767", catalog=catalog)[0]
    checks = {c.name: c for c in found.beside}
    rpm = 30 / math.pi
    assert checks["gearhead_continuous_speed"].demand * rpm == pytest.approx(7232, abs=0.5)
    assert checks["gearhead_continuous_speed"].status == "pass"
    assert checks["motor_speed"].status == "pass"  # of 14000 rpm
    assert checks["supply_voltage"].limit == pytest.approx(0.9 * (22 - 1))
    pair = next(p for p in found.comparison if p.paper.name == "gearhead_input_speed")
    assert (pair.paper.status, pair.physics.status) == ("fail", "pass")


@pytest.fixture(scope="module")
def by_physics(example_text):
    return estimates_off(read_spec(YamlSource(example_text.replace("method: paper", "method: physics"), "robot.yaml")))


def test_a_set_has_the_same_checks_whichever_method_ranked(spec, by_physics, catalog):
    """What stands beside a set that the paper ranked is what ranks it by physics, and the other way round."""
    one, other = (explain(s, "118752", "406764", catalog=catalog)[0] for s in (spec, by_physics))
    assert (one.checks[0].method, other.checks[0].method) == ("paper", "physics")
    for mine, theirs in ((one.beside, other.checks), (other.beside, one.checks)):
        assert [repr(c) for c in mine] == [repr(c) for c in theirs]
    assert [repr(c) for c in one.comparison] == [repr(c) for c in other.comparison]


# --- load cases ---

LIFT = """
name: lift
load: {kind: hoist, mass: 11 kg, drum_diameter: 52 mm, falls: 2, rope_efficiency: 0.93, friction_force: 5 N}
motion: {speed: 0.2 m/s, acceleration_time: 0.3 s, cruise_time: 2 s, rest_time: 1.5 s, there_and_back: true}
transmission: [{kind: gearhead}, {kind: belt, ratio: 1.4, efficiency: 0.95}]
supply: {nominal: 24 V, min: 22 V, max: 27 V, regeneration: 0.4, current: 7 A}
margins: {torque: 6 %, speed: 3 %, temperature: 9 %}
needs: {backlash_at_load: 2 deg}
"""
CASES = """cases:
  - {name: empty, load: {mass: 3 kg}}
  - {name: hot, environment: {ambient: 55 degC}, load: {mass: 9 kg}}
  - {name: quick, motion: {speed: 0.26 m/s, cruise_time: 1.4 s}, load: {mass: 6 kg}}
  - {name: weak, supply: {nominal: 23 V, min: 17.5 V}, load: {mass: 8 kg}}
"""
SOME = "select: {motor: {family: [RE 30, EC-max 30]}, controller: {part: CONTROLLER}}\n"
ONE = SOME.replace("CONTROLLER", "'520885'")


def test_each_check_is_that_of_its_worst_case(catalog):
    """The cases as specs of their own, one after the other, with a controller that leaves no choice."""
    spec = spec_from(LIFT + CASES + ONE)
    sets = candidates(problem(spec, catalog))
    whole = evaluate(problem(spec, catalog), sets)
    together, sets = {c.name: c for c in whole.checks}, sets._replace(encoder=whole.encoder)
    names, specs = zip(*spec.load_cases, strict=True)
    specs = (spec_from(LIFT + ONE), *specs[1:])  # the first one without the others
    alone = [{c.name: c for c in evaluate(problem(case, catalog), sets).checks} for case in specs]
    assert names[1:] == ("empty", "hot", "quick", "weak")
    told = set()
    for name, check in together.items():
        for row in range(0, len(sets.motor), 5):
            each = []
            for number, checks in enumerate(alone):
                c = checks[name]
                rank = 0 if c.failed[row] else 2 if c.passed[row] else 1
                margin = float(c.margin[row])
                unknown = math.isnan(margin)  # then where most is demanded
                order = (math.inf, -abs(np.nan_to_num(c.demand[row]))) if unknown else (margin, 0.0)
                each.append((rank, *order, number))
            worst = min(each)
            status = 0 if check.failed[row] else 2 if check.passed[row] else 1
            assert status == worst[0], name
            theirs = alone[worst[-1]][name]
            assert check.demand[row] == pytest.approx(theirs.demand[row], rel=1e-9, nan_ok=True), name
            assert check.limit[row] == pytest.approx(theirs.limit[row], rel=1e-9, nan_ok=True), name
            if check.case is not None and not math.isnan(check.demand[row]):
                assert each[int(check.case[row])][:3] == pytest.approx(worst[:3], rel=1e-9)
                told.add(names[int(check.case[row])])
    assert len(told) > 3
    fails = np.logical_or.reduce([c.failed for c in together.values()])
    in_any = np.logical_or.reduce([c.failed for checks in alone for c in checks.values()])
    assert (fails == in_any).all()
    assert 0 < fails.sum() < len(fails)


def test_the_margin_is_that_of_the_worst_case_too(catalog):
    """A rise counts from the ambient of its own case: 30 K of 100 K where it is hot, not 60 K of 130 K."""
    spec = spec_from(LIFT + "cases: [{name: hot, environment: {ambient: 55 degC}}]\n" + ONE)
    sets = candidates(problem(spec, catalog))
    both = next(c for c in evaluate(problem(spec, catalog), sets).checks if c.name == "winding_temperature")
    warm = problem(spec.load_cases[1][1], catalog)
    hot = next(c for c in evaluate(warm, sets).checks if c.name == "winding_temperature")
    in_heat = (both.case == 1) & np.isfinite(hot.demand)
    assert in_heat.sum() > 10
    assert both.margin[in_heat] == pytest.approx(hot.margin[in_heat], rel=1e-9)


def test_one_controller_for_all_cases(catalog):
    """It bears the most that any case asks, and a smaller one would not."""
    spec = spec_from(LIFT + CASES + SOME.replace(", controller: {part: CONTROLLER}", ""))
    specs = [case for _, case in spec.load_cases]
    offered = [catalog.controllers.record(k) for k in np.flatnonzero(~catalog.controllers.excluded)]
    lowest, highest = min(s.supply.lowest for s in specs), max(s.supply.highest for s in specs)
    found = size(spec, catalog=catalog, top=25).sets
    assert found and any(s.controller for s in found)
    for s in found:
        extra = 0.0 if s.encoder is None or math.isnan(s.encoder.inertia) else s.encoder.inertia
        asked = []
        for case in specs:
            segments = by_hand.segments_of(load_cycle(case))
            pieces = by_hand.drive(s.motor, s.gearhead, extra, 1.4, 0.95, segments)
            asked.append(by_hand.asked(pieces, s.motor, s.gearhead, case.environment.ambient))
        rms, top = (1.06 * max(getattr(a, n) for a in asked) for n in ("I_rms", "I_peak"))
        volts = 1.03 * max(a.V_peak[1] for a in asked)
        smaller = math.inf  # none suffices
        if s.controller:
            smaller = s.controller.continuous_current
            assert not smaller < rms
            assert not s.controller.peak_current < top
        for c in offered:
            if c.continuous_current >= smaller or c.drives not in ("both", s.motor.kind):
                continue
            if not (c.supply_min <= lowest and c.supply_max >= highest):
                continue
            usable = c.max_duty * (lowest - c.voltage_drop)
            assert not (c.continuous_current >= rms and c.peak_current >= top and usable >= volts), c.part


@pytest.mark.parametrize(
    "more",
    [
        "cases: [{name: other hall, supply: {power: 300 W}}]",
        "cases: [{name: cart, load: {kind: wheeled_vehicle, mass: 9 kg, driven_wheels: 2, wheel_diameter: 90 mm, "
        "rolling_resistance: 0.02, inertia: 1 kg*cm^2, friction_coefficient: 0.6}}]",
    ],
    ids=["supply power", "traction"],
)
def test_a_limit_that_one_case_alone_has(more, catalog):
    """A check that only one case has counts for that case, and nothing crashes."""
    result = size(spec_from(LIFT + more + "\n" + ONE), catalog=catalog, top=1)
    names = {c.name for c in (*result.sets, *result.misses)[0].checks}
    assert "supply_power" in names or "traction" in names


def test_families_that_never_go_together(catalog):
    """Nothing to look at is an answer too, or a line that says so."""
    chosen = "select: {motor: {family: RE 25}, gearhead: {family: GP 81 A}}\n"
    try:
        assert size(spec_from(LIFT + chosen), catalog=catalog).counts.considered == 0
    except InputError as told:
        assert "\n" not in str(told)


# --- margins ---


@pytest.mark.parametrize(
    ("margin", "names"),
    [
        ("torque", ["gearhead_continuous_torque", "gearhead_intermittent_torque", "motor_nominal_current",
                    "controller_continuous_current", "controller_peak_current", "supply_current"]),
        ("speed", ["gearhead_continuous_speed", "motor_speed", "supply_voltage"]),
        ("temperature", ["winding_temperature"]),
    ],
)  # fmt: skip
def test_margins_move_the_status_exactly_at_the_limit(margin, names, catalog):
    """As much margin as there is passes, a thousand-millionth more does not; the figures stay as they are."""
    plain = LIFT.replace("margins: {torque: 6 %, speed: 3 %, temperature: 9 %}\n", "")
    chosen = "select: {motor: {part: 148867}, gearhead: {part: '203119'}, controller: {part: '520885'}}\n"
    spec = spec_from(plain + chosen)
    sets = candidates(problem(spec, catalog))
    assert len(sets.motor) == 1
    whole = evaluate(problem(spec, catalog), sets)
    was, sets = {c.name: c for c in whole.checks}, sets._replace(encoder=whole.encoder)
    seen = 0
    for name in names:
        room = float(was[name].margin[0])
        if not room > 0:
            continue
        seen += 1
        for share, passes in ((1 - 1e-9, True), (1 + 1e-9, False)):
            more = f"margins: {{{margin}: {room * share!r}}}\n"
            check = {c.name: c for c in evaluate(problem(spec_from(plain + more + chosen), catalog), sets).checks}[name]
            assert bool(check.passed[0]) == passes, (name, share)
            assert bool(check.failed[0]) != passes, (name, share)
            assert check.demand == pytest.approx(was[name].demand)
            assert check.margin == pytest.approx(room)
            assert check.needed == room * share
    assert seen >= min(len(names), 2)


# --- objectives ---

NARROW = "select: {motor: {family: [RE 30, RE 25, RE 40, EC-max 30, A-max 32]}, UNKNOWN objective: mass}\n"
BOTH = LIFT + NARROW.replace("UNKNOWN ", "")


def figures_of(found, catalog):
    """Mass, energy, peak current, temperature and margin of every set that stands; NaN where not wholly known."""
    e, rows = found.evaluation, np.arange(found.passing)
    m, g = e.candidates.motor[rows], e.candidates.gearhead[rows]
    margins = [np.nan_to_num(c.margin[rows], nan=np.inf) for c in e.checks if not c.by_choice]
    sums = {n: catalog.motors[n][m] + catalog.gearheads[n][g] for n in ("mass", "price", "length")}
    for name in ("mass", "price"):
        sums[name] += np.nan_to_num(controlling(found, catalog, name)).sum(axis=0)
    counted = {n: e.figures[n][rows] for n in ("energy", "peak_current", "winding_temperature")}
    return {**sums, **counted, "margin": -np.minimum.reduce(margins)}


def controlling(found, catalog, name):
    """A figure of encoder and controller of every set that stands; NaN where it is unknown, or none is listed."""
    tables = (catalog.encoders, found.evaluation.encoder), (catalog.controllers, found.evaluation.controller)
    return np.stack([np.append(table[name], np.nan)[rows[: found.passing]] for table, rows in tables])


def front_by_hand(columns):
    """Every set against every other."""
    rows = list(zip(*columns, strict=True))
    known = [k for k, row in enumerate(rows) if not any(map(math.isnan, row))]
    found = set()
    for k in known:
        beaten = any(
            all(a <= b for a, b in zip(rows[j], rows[k], strict=True)) and rows[j] != rows[k] for j in known if j != k
        )
        if not beaten:
            found.add(rows[k])
    return found


@pytest.mark.parametrize(
    "names",
    [("mass", "energy"), ("mass", "energy", "peak_current"), ("energy", "winding_temperature", "margin", "length"),
     ("price", "mass")],
)  # fmt: skip
def test_the_front_is_what_nobody_beats(names, catalog):
    found = search(problem(spec_from(BOTH), catalog), top=10**6, misses=0, pareto=names)
    figures = figures_of(found, catalog)
    columns = [figures[name].tolist() for name in names]
    expected = front_by_hand(columns)
    theirs = [tuple(c[row] for c in columns) for row in found.front]
    assert set(theirs) == expected
    assert len(theirs) == len(set(theirs))
    assert [t[0] for t in theirs] == sorted(t[0] for t in theirs)
    assert 0 < len(theirs) < found.passing


@pytest.mark.parametrize(
    "text", ["mass=2,energy=1", "peak_current=0.3,mass=1,winding_temperature=4", "margin=1,mass=0.2"]
)
def test_weighted_objectives(text, catalog):
    """Shares of the smallest value that any set has, times their weights; of a margin, the share that is used."""
    spec, parts = spec_from(BOTH), [part.split("=") for part in text.split(",")]
    found = search(problem(spec, catalog).ranked_by(objective_of(text)), top=10**6, misses=0)
    figures = figures_of(found, catalog)
    total, missing = np.zeros(found.passing), np.zeros(found.passing)
    for name, weight in parts:
        column = figures[name] if name != "margin" else 1 / (1 - figures[name])
        total += np.nan_to_num(float(weight) * column / np.nanmin(column))
        missing += np.isnan(column)
    keys = list(zip(lacking(found).tolist(), missing.tolist(), total.round(9).tolist(), strict=True))
    assert keys == sorted(keys)
    assert len(set(keys)) > 10


def lacking(found):
    """Number of a drive's unknown checks that others do not have."""
    checks = [check for check in found.evaluation.checks if not check.advice]
    unknown = np.array([~(check.passed | check.failed) for check in checks])[:, : found.passing]
    return (unknown & ~unknown.all(axis=1, keepdims=True)).sum(axis=0)


@pytest.mark.parametrize("objective", ["mass", "energy", "peak_current", "winding_temperature", "margin", "length"])
def test_single_objectives(objective, catalog):
    found = search(problem(spec_from(BOTH), catalog).ranked_by(objective), top=10**6, misses=0)
    column = figures_of(found, catalog)[objective]
    missing = 3 * np.isnan(column)
    if objective == "mass":  # what is unknown of motor and gearhead goes before
        missing = missing + np.isnan(controlling(found, catalog, "mass")).sum(axis=0)
    keys = list(zip(lacking(found).tolist(), missing.tolist(), column.tolist(), strict=True))
    known = [k for k in keys if k[1] < 3]
    assert [k[:2] for k in keys] == sorted(k[:2] for k in keys)
    assert known == sorted(known)


def test_what_is_unknown_of_gearhead_and_friction_may_fail_a_set_but_not_pass_it(spec, catalog):
    """Left out, an inertia or a friction that could only ask for more gives least demands."""
    physics = spec.model_copy(update={"method": "physics"})
    rows = candidates(problem(physics, catalog))
    plain = {c.name: c for c in evaluate(problem(physics, catalog), rows).checks}
    for table, figure in (("gearheads", "inertia"), ("motors", "no_load_current")):
        parts = getattr(catalog, table)
        columns = dict(parts.columns) | {figure: np.full(len(parts), np.nan)}
        blind = replace(catalog, **{table: replace(parts, columns=columns)})
        found = {c.name: c for c in evaluate(problem(physics, blind), rows).checks}
        for name in ("motor_nominal_current", "controller_peak_current"):
            assert (found[name].demand <= plain[name].demand * (1 + 1e-12)).all()
            assert (found[name].demand > 0.3 * plain[name].demand).all()
        for name in ("motor_nominal_current", "controller_peak_current", "supply_voltage"):  # the last told by bounds
            assert not found[name].passed.any()
            assert (plain[name].failed | ~found[name].failed).all()  # what fails with less fails with all of it
        assert found["motor_speed"].demand == pytest.approx(plain["motor_speed"].demand)


@pytest.mark.parametrize(
    ("i", "e", "T_N", "T_0", "share", "idle"),
    [
        (4.0, 0.94, 5.1, 0.05, 1 / (1 / 0.94 - 4.0 * 0.05 / 5.1), 0.05),  # at rated torque both make what is printed
        (100.0, 0.92, 15.0, 0.05, 1.0, 0.05),  # Wittenstein NPS 015: its no-load torque is more than all of the loss
        (27.0, 0.8, 1.2, nan, 0.8, 0.0),
    ],
)
def test_a_gearhead_loses_torque_without_load_and_the_rest_in_proportion(i, e, T_N, T_0, share, idle):
    given = {"ratio": i, "efficiency": e, "continuous_torque": T_N, "no_load_torque": T_0}
    found = gear_loss({name: np.array([value]) for name, value in given.items()})
    assert [x.item() for x in found] == pytest.approx([share, idle], rel=1e-12)


@pytest.mark.parametrize(("ambient", "open_end"), [(25.0, "pass"), (47.0, "unknown")])
def test_an_unknown_end_of_a_range_is_that_of_the_standard(ambient, open_end):
    """Between 0 and 40 degC, which IEC 60034-1 has for motors; what is beyond an end that nobody states is open."""
    cold, hot = np.array([-20, 60, -20, nan, nan, nan]), np.array([55, 70, 10, 55, 10, nan])
    spec = SimpleNamespace(environment=SimpleNamespace(ambient=ambient + 273.15), select=SimpleNamespace(assume=()),
                           supply=SimpleNamespace(highest=24.0))  # fmt: skip
    motor = {"ambient_min": cold + 273.15, "ambient_max": hot + 273.15, "max_voltage": np.full(6, nan)}
    (found,) = motor_limits(spec, motor)
    status = np.where(found.passed, "pass", np.where(found.failed, "fail", "unknown")).tolist()
    assert status == ["pass", "fail", "fail", "pass", "fail", open_end]
    assert found.limit[:3] - 273.15 == pytest.approx([55, 60, 10])


@pytest.mark.parametrize(
    ("volts", "status"),
    [
        # printed 60 V, printed 450 V; of 24, 48 and 283 V; of 50 V at its highest speed, of 250 V; nothing; no speed
        (48.0, ["pass"] * 9),
        (70.0, ["fail"] + ["pass"] * 8),
        (78.0, ["fail", "pass", "unknown", "unknown", "pass", "unknown", "pass", "pass", "unknown"]),
        (325.0, ["fail", "pass", "unknown", "unknown", "pass", "unknown", "pass", "pass", "unknown"]),
        (565.0, ["fail", "fail", "unknown", "unknown", "unknown", "unknown", "pass", "pass", "unknown"]),
    ],
)
def test_a_winding_withstands_the_printed_voltage_else_by_a_rule(volts, status):
    """75 V are extra-low voltage; mains of 240 V + 10 % are 373 V, 1.32 times the 283 V of mains of 200 V."""
    constants = np.array([0.5] * 7 + [nan, 0.5])
    motor = {
        "max_voltage": np.array([60, 450, *[nan] * 7]),
        "nominal_voltage": np.array([24, 24, 24, 48, 283, nan, nan, nan, nan]),
        "back_emf_constant": constants, "torque_constant": constants, "kind": np.full(9, "brushless"),
        "max_speed": np.array([90, 90, 90, 90, 90, 99, nan, nan, nan]), "commutation": np.full(9, ""),
        "nominal_speed": np.array([90, 90, 90, 90, 90, 90, 500, nan, nan]),
    }  # fmt: skip
    motor |= {name: np.full(9, nan) for name in ("speed_constant", "no_load_speed", "resistance", "no_load_current")}
    (found,) = supply_voltage_limit(motor, volts)
    assert [found.at(row, "physics").status for row in range(9)] == status
    assert not supply_voltage_limit(motor | {"max_voltage": np.full(9, nan)}, 75.0)
    steppers = motor | {"kind": np.full(9, "stepper"), "max_voltage": np.full(9, nan)}
    assert not supply_voltage_limit(steppers, volts if volts > 75.0 else 325.0)[0].failed.any()
