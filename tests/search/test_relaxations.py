"""The moves of single figures that would let a drive pass: which way, how far, and what they are reported as."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest
from specs import estimates_off

from drivesizer.files.yaml_source import YamlSource
from drivesizer.machine.problem import problem
from drivesizer.search import relaxations as module
from drivesizer.search import relaxations as movable_figures
from drivesizer.search.relaxations import movable_names, relaxations
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import read_spec
from drivesizer.units import registry

SPEC = """
name: a table
load: {kind: rotary_table, inertia: 2e-3 kg*m^2, friction_torque: 5 mN*m}
motion: MOTION
transmission: [{kind: gearhead}, {kind: belt, ratios: [1], efficiency: 0.9, stiffness: 50 N*m/rad}]
supply: {nominal: 24 V, current: 5 A, power: 100 W, capacitance: 1 mF, accepts: all}
needs: {backlash_at_load: 3 deg, resolution_at_load: 1 deg, inertia_ratio: 10, resonance: 5 Hz, diameter: 60 mm,
        length: 200 mm, mass: 1 kg, price: 900 EUR}
select: {catalogs: [maxon], motor: {family: DCX 22 S}, gearhead: {family: GPX 22 HP}}
"""
TRAPEZOID = "{profile: trapezoid, speed: 60 rpm, acceleration_time: 0.3 s, cruise_time: 1 s, rest_time: 1 s}"
FURTHEST = {  # times what is given, in the sense that helps
    "load.inertia": 1 / 20, "load.friction_torque": 1 / 20, "supply.nominal": 20, "supply.current": 20,
    "supply.power": 20, "supply.capacitance": 20,
    "needs.backlash_at_load": 20, "needs.resolution_at_load": 20, "needs.inertia_ratio": 20, "needs.resonance": 1 / 20,
    "needs.diameter": 20, "needs.length": 20, "needs.mass": 20, "needs.price": 20,
}  # fmt: skip


def spec_of(motion=TRAPEZOID):
    return estimates_off(read_spec(YamlSource(SPEC.replace("MOTION", motion), "table.yaml")))


def figures(spec):
    """Every figure of a spec that is a number, by its path."""
    sections = {name: getattr(spec, name).model_dump() for name in ("load", "motion", "supply", "needs", "environment")}
    return {f"{s}.{n}": v for s, fields in sections.items() for n, v in fields.items() if isinstance(v, float)}


def moves(given, monkeypatch, passes=lambda _: False):
    """The relaxations where a drive passes by a rule on the moved figures, and all factors that were tried."""
    now, tried = figures(given.spec), {}

    def ratios(moved):
        return {name: value / now[name] for name, value in figures(moved.spec).items() if value != now[name]}

    def found(moved):
        for name, factor in ratios(moved).items():
            tried.setdefault(name, set()).add(factor)
        return passes(ratios(moved))

    def best(moved):
        assert passes(ratios(moved)) and moved.spec.select.objective == "price"
        return SimpleNamespace(label="a drive", status="pass")

    monkeypatch.setattr(module, "any_in_machine", found)
    monkeypatch.setattr(module, "best_in_machine", best)
    return {r.field: r for r in relaxations(given.ranked_by("price"))}, tried


@pytest.mark.parametrize(("motion", "furthest"), [
    (TRAPEZOID, {"speed": 1 / 20, "acceleration_time": 20, "rest_time": 20}),
    ("{profile: triangle, distance: 60 deg, time: 1 s, rest_time: 1 s}", {"time": 20, "rest_time": 20}),
    ("{profile: s_curve, distance: 60 deg, speed: 60 rpm, acceleration: 20 rad/s^2, jerk: 200 rad/s^3, rest_time: 1 s}",
     {"speed": 1 / 20, "acceleration": 1 / 20, "rest_time": 20}),
    ("{profile: harmonic, amplitude: 60 deg, period: 2 s}", {"period": 20}),
])  # fmt: skip
def test_each_figure_is_moved_to_a_twentieth_or_twentyfold(motion, furthest, catalog, monkeypatch):
    found, tried = moves(problem(spec_of(motion), catalog), monkeypatch)
    assert not found
    expected = FURTHEST | {f"motion.{name}": factor for name, factor in furthest.items()}
    assert set(tried) - {"supply.min", "supply.max"} == set(expected)  # 25 degC is that of a room: no remedy
    for name, factor in expected.items():
        ends = (1.0, 20.0) if factor > 1 else (1 / 20, 1.0)
        assert (min(1.0, *tried[name]), max(1.0, *tried[name])) == pytest.approx(ends, rel=1e-9), name


@pytest.mark.parametrize(("field", "factor"), [("load.inertia", 1 / 7), ("motion.rest_time", 7), ("needs.mass", 19.9)])
def test_the_least_factor_is_found_to_one_per_cent(field, factor, catalog, monkeypatch):
    given = problem(spec_of(), catalog)

    def passes(ratios):
        moved = ratios.get(field, 1.0)
        return moved >= factor if factor > 1 else moved <= factor

    found, _ = moves(given, monkeypatch, passes)
    assert list(found) == [field]
    move = found[field]
    moved = move.after / move.before
    assert move.before == figures(given.spec)[field]
    assert moved == pytest.approx(factor, rel=0.0101)
    assert passes({field: moved})
    assert move.share == pytest.approx(abs(moved - 1.0))
    assert move.set_label == "a drive"
    needed, now = (registry().Quantity(text) for text in (move.needed, move.now))  # each in the unit that suits it
    assert float(needed / now) == pytest.approx(moved, rel=0.01)


def test_the_ambient_falls_by_kelvins(catalog, monkeypatch):
    """60 degC, and a drive that passes at 30 K less: found to 1 K, on the colder side."""
    hot = spec_of()
    given = problem(hot.model_copy(update={"environment": type(hot.environment)(ambient="60 degC")}), catalog)
    now = given.spec.environment.ambient
    found, _ = moves(given, monkeypatch, lambda ratios: ratios.get("environment.ambient", 1.0) * now <= now - 30.0)
    (move,) = found.values()
    assert move.field == "environment.ambient"
    assert move.before == now == pytest.approx(333.15)
    assert now - 31.0 <= move.after <= now - 30.0
    assert move.share == pytest.approx((now - move.after) / now)
    assert (move.now, move.needed) == ("60 °C", f"{move.after - 273.15:.3g} °C")


def test_the_nearest_other_reduction_of_the_family_is_named_with_its_distance(catalog):
    """At 60 rpm a DCX 22 S of 750 rad/s permits a ratio of 119: of the family's 20 the next below 231 is 111."""
    spec = spec_of()
    spec = spec.model_copy(update={"needs": type(spec.needs)()})
    (found,) = explain(spec, "DCX22S01EBKL529", "GPX22HPKLSL0231CPLW", catalog=catalog)
    move = next(change for change in found.changes if change.field == "gearhead")
    ratios = catalog.gearheads["ratio"][catalog.gearheads["family"] == "GPX 22 HP"]
    assert move.before == found.gearhead.ratio == pytest.approx(231.2, abs=0.1)
    assert move.after == max(r for r in ratios if r * 2 * math.pi < found.motor.max_speed)
    assert move.share == pytest.approx((move.before - move.after) / move.before)


def test_the_drive_that_is_named_is_the_best_of_the_objective_once_the_figure_has_moved(catalog, monkeypatch):
    """Of several motors with the gearhead of the least backlash the lightest, or that of the least energy."""
    spec = spec_of()
    spec = spec.model_copy(update={"needs": type(spec.needs)(backlash_at_load="0.1 deg")})
    path, named = ("needs", "backlash_at_load"), {}
    only = [figure for figure in movable_figures.FIGURES if figure.path == path]
    monkeypatch.setattr(movable_figures, "FIGURES", only)
    for objective in ("mass", "energy"):
        (move,) = (
            one
            for one in relaxations(problem(spec, catalog).ranked_by(objective))
            if one.field == "needs.backlash_at_load"
        )
        needs = spec.needs.model_copy(update={"backlash_at_load": move.after})
        found = size(spec.model_copy(update={"needs": needs}), catalog=catalog, objective=objective, top=1)
        assert move.set_label == found.sets[0].label
        named[objective] = move
    assert named["mass"].needed == named["energy"].needed
    assert named["mass"].set_label != named["energy"].set_label


CART = """
name: cart
load: {kind: wheeled_vehicle, mass: 120 kg, driven_wheels: 2, wheel_diameter: 200 mm, rolling_resistance: 1.5 %,
       inertia: 60 kg*cm^2, friction_coefficient: 0.6}
motion: {speed: 1.4 m/s, acceleration_time: 2 s, cruise_time: 30 s, rest_time: 8 s}
supply: {nominal: 48 V, min: 42 V, max: 54 V, current: 20 A}
battery: {nominal_voltage: 12 V, series: 4, capacity: 20 A*h, rated_time: 20 h, chemistry: lead-acid,
          peukert_exponent: 1.2, autonomy: 6 h}
margins: {torque: 10 %}
select: {catalogs: [maxon], motor: {family: EC 60 flat}, gearhead: {family: GP 52 C}}
cases: [{name: ramp, load: {slope: 6 %}}]
"""


@pytest.mark.parametrize("given", ["{slope: 3 %, ", "{"], ids=["of the spec", "of a case"])
def test_a_slope_that_is_entered_as_a_grade_is_printed_as_one(given, catalog, monkeypatch):
    """Half the angle of 3 % is 1.4997 %: tan(atan(0.03) / 2)."""
    text = CART.replace("load: {kind", f"load: {given}kind").replace("6 %", "3 %")

    def passes(moved):
        return max(case.spec.load.slope for case in moved.cases) <= math.atan(0.03) / 2

    monkeypatch.setattr(module, "any_in_machine", passes)
    monkeypatch.setattr(module, "best_in_machine", lambda *_: SimpleNamespace(label="a drive", status="pass"))
    found = {one.field: one for one in relaxations(problem(read_spec(YamlSource(text, "cart.yaml")), catalog))}
    slope = found["load.slope"]
    assert slope.now == "3 %" and slope.needed.endswith(" %")
    assert 1.48 < float(slope.needed.split()[0]) <= 1.4997


def test_where_only_the_machine_rejects_what_would_help_is_found_too(catalog, monkeypatch):
    """6 h out of 20 A*h fail; at the capacity that is named a drive passes, and at 1 % less none."""
    spec = read_spec(YamlSource(CART, "cart.yaml"))
    few = [figure for figure in movable_figures.FIGURES if figure.path[0] == "battery"]
    monkeypatch.setattr(movable_figures, "FIGURES", few)
    result = size(spec, catalog=catalog, top=1)
    assert not result.sets and set(result.counts.failed_by_budget) == {"battery_autonomy"}
    assert result.counts.judged > 5 and result.tried == ("battery.capacity", "battery.autonomy")
    moves = {r.field: r for r in result.relaxations}
    assert set(moves) == {"battery.capacity", "battery.autonomy"}
    enough = moves["battery.capacity"].after
    for charge, passes in ((enough, True), (enough / 1.011, False)):
        text = CART.replace("capacity: 20 A*h", f"capacity: {charge / 3600!r} A*h")
        found = size(read_spec(YamlSource(text, "cart.yaml")), catalog=catalog, top=1, detail="drives")
        assert bool(found.sets) == passes
    assert (moves["battery.capacity"].now, moves["battery.autonomy"].now) == ("20 A·h", "6 h")


def test_a_figure_of_one_load_case_moves_and_the_grip_does_not(catalog):
    names = movable_names(problem(read_spec(YamlSource(CART, "cart.yaml")), catalog))
    assert {"load.slope", "load.rolling_resistance", "margins.torque", "battery.capacity"} <= set(names)
    assert "load.friction_coefficient" not in names and "margins.speed" not in names
