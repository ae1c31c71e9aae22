"""The search on columns against the rule of section 3.1.3 written again, one pair at a time, in plain Python."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest
from bought_parts import together
from small_catalogue import CATALOGUE
from starters import starter

from drivesizer.catalog import load
from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.results.check_columns import at_most, worst_case
from drivesizer.search import ranking
from drivesizer.search.columns.candidates import Candidates
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import read_spec

OPEN = """
name: open search
method: paper
load: {kind: wheeled_vehicle, mass: MASS, driven_wheels: 2, wheel_diameter: 180 mm, rolling_resistance: 0.017,
       slope: SLOPE, inertia: 30 kg*cm^2}
motion: {speed: SPEED, acceleration_time: 1.3 s, cruise_time: 17 s, rest_time: 4 s}
transmission: [{kind: gearhead}, {kind: belt, ratios: BELTS, efficiency: 0.93}]
paper_factors: {speed_reserve: 0.88, bearing: 0.93, robot_efficiency: 0.87, confidence: 0.9, oversize: 1.15}
supply: {nominal: 24 V, min: 21 V, max: 28 V}
select: {objective: OBJECTIVE}
"""


def spec_of(mass="30 kg", slope="2 deg", speed="1.1 m/s", belts="[1.3]", objective="mass"):
    text = OPEN
    for word, value in (("MASS", mass), ("SLOPE", slope), ("SPEED", speed), ("BELTS", belts), ("OBJECTIVE", objective)):
        text = text.replace(word, value)
    return read_spec(YamlSource(text, "open.yaml"))


@pytest.fixture(scope="module")
def many(catalog):
    """The first by mass."""
    return size(spec_of(), catalog=catalog, top=300, detail="drives")


def by_hand(spec, catalog):
    """Each pair's failed checks by the paper's rule, scalar by scalar; NaN compares false both ways."""
    load, motion, f = spec.load, spec.motion, spec.paper_factors
    g, d, N, th = 9.80665, load.wheel_diameter, load.driven_wheels, load.slope
    n = 2 * motion.speed / (d * f.speed_reserve)
    M_nom = d / 2 * (load.rolling_resistance * load.mass * g * math.cos(th) + load.mass * g * math.sin(th)) / f.bearing
    M_rest = d / 2 * load.mass * g * math.sin(th)  # what holds it on the slope
    t_acc, t_nom, t_rest = motion.acceleration_time, motion.cruise_time, motion.rest_time
    T = 2 * t_acc + t_nom + t_rest
    n_rms = n * math.sqrt((2 * t_acc / 3 + t_nom) / T)
    motors = [catalog.motors.record(i) for i in range(len(catalog.motors))]
    gears = [catalog.gearheads.record(i) for i in range(len(catalog.gearheads))]
    sets, largest, doubtful = {}, {}, {}
    belts, e_b = spec.belt_ratios, spec.belt_efficiency
    for m, gear in zip(catalog.motor_gearhead.left.tolist(), catalog.motor_gearhead.right.tolist(), strict=True):
        if catalog.motors.excluded[m] or catalog.gearheads.excluded[gear]:
            continue
        motor, head = motors[m], gears[gear]
        alpha = motion.speed / t_acc / (d / 2)
        M_acc = (
            (N * (load.inertia + motor.rotor_inertia) + load.mass / f.robot_efficiency * d**2 / 4) * alpha * f.oversize
        )
        squares = t_acc * (M_nom + M_acc) ** 2 + t_nom * M_nom**2 + t_acc * (M_nom - M_acc) ** 2 + t_rest * M_rest**2
        rms = math.sqrt(squares / T) / N
        ends = (M_nom + M_acc) / N, (M_nom - M_acc) / N  # at full speed, where acceleration ends and braking begins
        peak = max(map(abs, ends))
        for belt in belts:
            K = head.ratio * belt
            m_rms, m_peak = (x / (K * head.efficiency * e_b) for x in (rms, peak))
            per_torque = motor.speed_torque_gradient / (K * head.efficiency * e_b)
            V_0 = max(abs(n * K + per_torque * end) for end in ends)
            gear_fails = {
                "gearhead_continuous_torque": rms / (belt * e_b) > head.continuous_torque,
                "gearhead_intermittent_torque": peak / (belt * e_b) > head.intermittent_torque,
                "gearhead_input_speed": n * K > head.continuous_input_speed,
            }
            known = not any(
                map(math.isnan, (head.continuous_torque, head.intermittent_torque, head.continuous_input_speed))
            )
            if known and not any(gear_fails.values()):
                key = (m, head.family)
                largest[key] = max(largest.get(key, 0.0), K)
            if not any(gear_fails.values()):
                doubtful[m, head.family] = max(doubtful.get((m, head.family), 0.0), K)
            sets[m, gear, belt] = gear_fails | {
                "motor_speed": motor.no_load_speed < n * K,
                "motor_continuous_torque": m_rms > motor.nominal_torque,
                "motor_maximum_torque": m_peak > motor.stall_torque,
                "motor_power": rms * n_rms > motor.assigned_power,
                "speed_constant": motor.speed_constant < V_0 / motor.nominal_voltage,
            }
    largest = doubtful | largest
    for (m, gear, belt), fails in sets.items():
        head = gears[gear]
        fails["largest_reduction"] = head.ratio * belt < largest.get((m, head.family), 0.0)
    return sets


@pytest.mark.parametrize(
    "spec",
    [
        spec_of(),
        spec_of(mass="300 kg", slope="0 deg", speed="2.2 m/s", belts="[1.1, 1.7, 2.9]"),
        spec_of(mass="3 kg", slope="-4 deg", speed="0.4 m/s", belts="[0.8]"),
    ],
    ids=["robot", "heavy with three belts", "downhill"],
)
def test_every_pair_of_the_catalogue(spec, catalog):
    expected = by_hand(spec, catalog)
    result = size(spec, catalog=catalog, top=50, detail="drives")
    tally = Counter(name for fails in expected.values() for name, failed in fails.items() if failed)
    found = {k: v for k, v in result.counts.failed_by.items() if not k.startswith(("encoder", "controller"))}
    assert result.counts.considered == len(expected)
    assert found == dict(tally)
    for drive in result.sets:
        key = (catalog.motors.rows[drive.motor.part], catalog.gearheads.rows[drive.gearhead.part], drive.belt_ratio)
        assert not any(expected[key].values()), drive.label


@pytest.mark.parametrize("objective", ["mass", "price", "power", "length", "margin"])
def test_objectives_rank(objective, catalog, many):
    result = (
        many if objective == "mass" else size(spec_of(objective=objective), catalog=catalog, top=40, detail="drives")
    )
    rows = [(s.status != "pass", -len(s.objective_of), s.objective) for s in result.sets]
    if objective == "margin":
        rows = [(a, -1, -c) for a, _, c in rows]
    assert rows == sorted(rows)
    assert len(rows) > 20
    assert all(s.rank == k for k, s in enumerate(result.sets, 1))


def test_price_and_mass_are_sums_of_the_datasheets(catalog):
    best = size(spec_of(objective="price"), catalog=catalog, top=1, detail="drives").sets[0]
    assert best.objective == pytest.approx(best.motor.price + best.gearhead.price)
    assert best.mass == pytest.approx(together(best))


def test_one_reduction_remains_per_motor_and_family(many):
    seen = {}
    for s in many.sets:
        seen.setdefault((s.motor.part, s.gearhead.family), set()).add(round(s.total_ratio, 9))
    assert all(len(ratios) == 1 for ratios in seen.values())


def test_the_controller_is_the_smallest_that_suffices(catalog, many):
    for s in many.sets[:30]:
        need = {c.name: c.demand for c in s.checks}
        for row in range(len(catalog.controllers)):
            c = catalog.controllers.record(row)
            if c.continuous_current >= s.controller.continuous_current or c.drives not in ("both", s.motor.kind):
                continue
            fits = c.supply_min <= 21.0 and c.supply_max >= 28.0
            enough = (
                c.continuous_current >= need["controller_continuous_current"]
                and c.peak_current >= need["controller_peak_current"]
            )
            assert not (fits and enough), f"{c.family} would do for {s.label}"


def test_nothing_fits_says_what_to_relax(catalog, monkeypatch):
    spec = spec_of(mass="900 kg", speed="3 m/s", objective="mass, gearhead: {family: [GP 42 C, GP 52 C]}")
    result = size(spec, catalog=catalog)
    assert result.sets == ()
    assert result.misses[0].status == "fail"
    fields = {r.field: r for r in result.relaxations}
    assert "load.mass" in fields
    assert "motion.speed" in fields
    lighter = size(spec_of(mass=fields["load.mass"].needed, speed="3 m/s"), catalog=catalog)
    monkeypatch.setattr("drivesizer.sizing.relaxations", lambda *_: ())  # what would help this one, nobody asks
    still = size(
        spec_of(mass=f"{float(fields['load.mass'].needed.split()[0]) * 1.03} kg", speed="3 m/s"), catalog=catalog
    )
    assert lighter.sets
    assert not still.sets


def test_a_pair_that_no_source_lists_is_unknown_not_refused(catalog):
    found = explain(spec_of(), "148867", "110308", catalog=catalog)[0]
    assert {c.name: c for c in found.checks}["compatibility"].status == "unknown"


def test_rejecting_unknowns(tmp_path, catalog):
    """Of a hoist there are sets of which all is known; of the paper's motors some limits are printed nowhere."""
    keep = starter("hoist", tmp_path)
    reject = keep.model_copy(update={"select": keep.select.model_copy(update={"unknown": "reject"})})
    for spec in (keep, reject):
        result = size(spec, catalog=catalog, top=50, detail="drives")
        assert result.sets
        if spec is reject:
            assert all(s.status == "pass" for s in result.sets)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("family: RE 25}", "family: RE25}", "RE 25"),
        ("family: GP 26 A}", "part: 4067644}", "406764"),
        ("bus: CANopen", "bus: CANopn", "CANopen"),
        ("catalogs: [maxon]", "catalogs: [maxn]", "maxon"),
        ("catalogs: [maxon]", "catalogs: [nothing.yaml]", "cannot be read"),
    ],
)
def test_names_that_are_in_no_catalogue(example_text, old, new, words):
    with pytest.raises(InputError, match=words):
        size(read_spec(YamlSource(example_text.replace(old, new), "robot.yaml")))


def test_unknown_part_in_explain(spec, catalog):
    with pytest.raises(InputError, match=r"motor .* the nearest are"):
        explain(spec, "118755", "406764", catalog=catalog)


# --- ties

SPEC = """\
name: tied
load: {kind: flywheel, inertia: 80 kg*m^2}
motion: {speed: 600 rpm, acceleration_time: 0.5 s, cruise_time: 1 s, rest_time: 1 s}
supply: {nominal: 24 V}
"""
ROW, OTHER = (next(line for line in CATALOGUE.splitlines() if f"[{part}," in line) for part in ("m1", "m2"))


def test_the_order_of_rows_does_not_choose_the_closest_rejected(tmp_path, monkeypatch):
    """Fifty motors alike: more than the search keeps of those that are equally far from passing."""
    monkeypatch.setattr("drivesizer.sizing.relaxations", lambda *_: ())
    monkeypatch.setattr("drivesizer.sizing.changes_for", lambda *_: ())
    rows = [ROW.replace("m1", f"p{number}") for number in range(10, 60)]
    closest = []
    for name, some in {"there": rows, "back": rows[::-1]}.items():
        path = tmp_path / f"{name}.yaml"
        path.write_text(CATALOGUE.replace(OTHER + "\n", "").replace(ROW, "\n".join(some)), encoding="utf-8")
        spec = read_spec(YamlSource(f"{SPEC}select: {{catalogs: [{path}]}}\n", str(tmp_path / "robot.yaml")))
        result = size(spec, catalog=load([str(path)]), top=3)
        assert not result.sets
        closest.append([(one.motor.part, one.gearhead.part) for one in result.misses])
    assert closest[0] == closest[1]
    assert closest[0][0][0] == "p10"


# -- last digits, which another processor gives


def test_margins_and_objectives_that_differ_by_rounding_are_equal(catalog):
    sets = Candidates(np.array([7, 3, 5]), np.zeros(3, np.int64), np.ones(3), np.ones(3, bool))
    parts = [str(catalog.motors["part"][row]) for row in sets.motor]
    by_part = sorted(range(3), key=lambda n: parts[n])
    margin = np.full(3, 0.3)
    margin[by_part[2]] = 0.1 + 0.2
    mass, none = 2.0 * margin, np.zeros(3, np.int64)
    assert ranking.order(catalog, sets, mass, none, margin=margin).tolist() == by_part
    margin[by_part[2]] = 0.3001
    assert ranking.order(catalog, sets, np.ones(3), none, margin=margin)[0] == by_part[2]
    energy = {"energy": mass, "winding_temperature": -margin}
    assert len(ranking.front(catalog, sets, energy, ["energy"])) == 1


def test_of_load_cases_that_are_equal_but_for_rounding_the_first_counts():
    """0.6 A of 1 A, then a last digit more, then a thousandth more."""
    demands = np.array([[0.6, 0.6, 0.0], [0.6 + 2e-16, 0.6 + 2e-16, 0.6], [0.6, 0.601, 0.6 - 1e-16]])
    found = worst_case([(n, at_most("controller_peak_current", demand, 1.0)) for n, demand in enumerate(demands)])
    assert found.case is not None and found.case.tolist() == [0, 2, 1]
