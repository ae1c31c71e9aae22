"""Studies: what a study.yaml means, what it is refused for, and what a variant's row says."""

import math
import re
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from refusals import refusal
from studies import CHEAP, EXAMPLE, FEW, ROOT, laid

from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource, changed
from drivesizer.results.check import worst
from drivesizer.search.shortlist import load_parts
from drivesizer.sizing import size
from drivesizer.spec.robot import read_spec
from drivesizer.study.figures import path_of
from drivesizer.study.plan import MOST, MOST_IN_CHUNKS, read_study
from drivesizer.study.rows import best, columns_of, document_of, rows_of, spec_of
from drivesizer.study.run import carry_out, refuse_if_all_invalid
from drivesizer.units import to_si


def planned(folder, study, spec=CHEAP):
    return read_study(laid(folder, study, spec))


def table(plan, numbers=None):
    """Rows of some variants, or all, each by the heads of its columns."""
    variants = [plan.variant(n) for n in numbers or range(1, plan.total + 1)]
    heads = [column.head for column in columns_of(plan)]
    rows = rows_of(plan.job, variants).rows
    assert all(len(row) == len(heads) for row in rows)
    return [dict(zip(heads, row, strict=True)) for row in rows]


# --- the variants -----------------------------------------------------------------------------------------------------


def test_a_grid_is_every_combination_the_last_fastest(tmp_path):
    """Numbers and places against the standard library's product."""
    plan = planned(
        tmp_path,
        "spec: robot.yaml\nvary:\n  load.mass: {from: 30 kg, to: 60 kg, steps: 4}\n"
        "  motion.speed: [1 m/s, 9 km/h]\n  load.driven_wheels: [2, 4, 6]\n"
        "catalogs: [[maxon], [maxon, faulhaber]]\nobjectives: [mass, 'mass=2,price=1']\n",
    )
    masses, speeds = ["30.0 kg", "40.0 kg", "50.0 kg", "60.0 kg"], ["1 m/s", "9 km/h"]
    expected = list(product(masses, speeds, [2, 4, 6], range(2), range(2)))
    found = [plan.variant(n) for n in range(1, plan.total + 1)]
    assert [(*v.values, v.catalogs, v.objective) for v in found] == expected
    assert [v.number for v in found] == list(range(1, 97))
    assert [v for n in range(plan.points) for v in plan.point(n)] == found
    assert plan.variant(14).head == [14, 30.0, 2.5, 2, "maxon"]  # 9 km/h in the unit of the first


@given(count=st.integers(1, 300), seed=st.integers(0, 2**40))
def test_a_latin_hypercube_has_one_sample_in_every_part(tmp_path_factory, count, seed):
    """McKay, Beckman and Conover's definition: of n samples, one in each n-th of every field's range."""
    plan = planned(
        tmp_path_factory.mktemp("lhs"),
        "spec: robot.yaml\nvary:\n  load.mass: {from: 20 kg, to: 90 kg}\n  motion.speed: {from: 1 km/h, to: 2 m/s}\n"
        f"sampling: {{latin_hypercube: {count}, seed: {seed}}}\n",
    )
    values = [plan.variant(n).head[1:] for n in range(1, plan.total + 1)]
    assert plan.total == count
    for axis, (low, high) in enumerate([(20.0, 90.0), (1.0, 7.2)]):
        shares = (np.array(values)[:, axis] - low) / (high - low)
        assert sorted(np.floor(shares * count + 1e-7).astype(int).clip(0, count - 1)) == list(range(count))


def test_chance_is_the_seed_s_alone(tmp_path):
    """Another field beside it leaves the samples of a field where they are; another seed does not."""
    one = "  load.mass: {from: 20 kg, to: 90 kg}\n"
    two = one + "  motion.speed: {from: 1 m/s, to: 2 m/s}\n"

    def masses(vary, seed):
        plan = planned(tmp_path, f"spec: robot.yaml\nvary:\n{vary}sampling: {{latin_hypercube: 9, seed: {seed}}}\n")
        return [plan.variant(n).values[0] for n in range(1, 10)]

    assert masses(one, 1) == masses(two, 1) != masses(two, 2)


def test_a_variant_is_the_spec_as_a_person_would_change_it(tmp_path):
    """88 lb are 88 * 0.45359237 kg by definition."""
    plan = planned(tmp_path, FEW.replace("vary:", "vary:\n  transmission[2].ratio: [1.5]\n  supply.max: [30 V]"))
    assert plan.variant(4).values == (1.5, "30 V", "39.91612856 kg", "5.4 km/h")
    by_hand = CHEAP.replace("ratio: 1.1", "ratio: 1.5").replace("max: 29 V", "max: 30 V")
    by_hand = by_hand.replace("mass: 45 kg", "mass: 39.91612856 kg").replace("speed: 1.5 m/s", "speed: 5.4 km/h")
    wanted, made = read_spec(YamlSource(by_hand, "by_hand.yaml")), spec_of(plan.job, plan.variant(4))
    assert made.model_dump() == wanted.model_dump() and made.entered == wanted.entered
    assert math.isclose(made.load.mass, to_si("88 lb", "mass"), rel_tol=1e-12)


@pytest.mark.parametrize(
    ("field", "values"),
    [
        pytest.param("load", '[{kind: flywheel, inertia: "0.02 kg*m^2"}]', id="another axis: a speed in m/s is none"),
        pytest.param("motion.speed", "[0 m/s]", id="a section that varies"),
        pytest.param("supply.nominal", "[30 V]", id="sections that do not go together"),
    ],
)
def test_a_variant_that_is_wrong_is_the_line_of_its_own_file(tmp_path, field, values):
    plan = planned(tmp_path, f"spec: robot.yaml\nvary:\n  {field}: {values}\n", CHEAP.replace("method: paper", ""))
    source = document_of(plan.job, plan.variant(1))
    with pytest.raises(InputError) as by_itself:
        read_spec(source)
    assert refusal(lambda: spec_of(plan.job, plan.variant(1))) == str(by_itself.value)


@given(data=st.recursive(st.integers(), lambda inner: st.dictionaries(st.sampled_from("abc"), inner, max_size=3)))
def test_what_is_beside_a_change_stays(data):
    found = changed(data, ("a", "b"), "new")
    assert found["a"]["b"] == "new"
    before = data if isinstance(data, dict) else {}
    assert {k: v for k, v in found.items() if k != "a"} == {k: v for k, v in before.items() if k != "a"}
    assert data != found


def test_paths():
    assert path_of("transmission[2].ratio") == ("transmission", 1, "ratio")
    assert path_of("equipment[12].power") == ("equipment", 11, "power")
    for name in (
        "load.",
        "",
        "load..mass",
        "load mass",
        "transmission[0].ratio",
        "transmission[-1].ratio",
        "load.mass\n",
    ):
        assert path_of(name) is None, name


# --- what is refused --------------------------------------------------------------------------------------------------

VARY = "spec: robot.yaml\nvary:\n  "
LARGE = (
    VARY
    + """load.mass: {from: 1 kg, to: 2 kg, steps: 4000}
  motion.speed: {from: 1 m/s, to: 2 m/s, steps: 2500}
"""
)


@pytest.mark.parametrize(
    ("study", "said"),
    [
        (VARY + "load.mas: [1 kg, 2 kg]\n", 'study.yaml:3: vary.load.mas: "mas" is no field of load; the nearest'),
        (VARY + "lod.mass: [1 kg]\n", '"lod" is no field of a spec; the nearest is load'),
        (VARY + "transmission[3].ratio: [1]\n", "entry 3 does not exist, there are 2 in"),
        (VARY + "cases[1].load.mass: [1 kg]\n", "entry 1 does not exist, there are 0 in"),
        (VARY + "load mass: [1 kg]\n", "is no field; expected one of"),
        (VARY + "select.catalogs: [maxon]\n", "expected them in the study's own list, catalogs"),
        (VARY + "load.mass: [30 kg, 3 m]\n", '[2]: "3 m": "m" is a unit of length, not of mass; expected mass'),
        (VARY + "load.mass: [30 kg, 30 kg]\n", '"30 kg" is given twice'),
        (VARY + "load.mass: 30 kg\n", "expected a list of values, e.g. [24 V, 48 V], or a range"),
        (VARY + "load.mass: {from: 30 kg, to: 60 kg}\n", "steps is missing; expected a range"),
        (VARY + "load.mass: {from: 30 kg, to: 60 kg, steps: 1}\n", '.steps: "1" is not a whole number from 2'),
        (VARY + "load.mass: {from: 30 kg, to: 60 kg, steps: 100001}\n", '"100001" is too many'),
        (VARY + "load.mass: {from: 60 kg, to: 30 kg, steps: 3}\n", '"60 kg" is not below "30 kg"'),
        (VARY + "load.driven_wheels: {from: 2, to: 4, steps: 3}\n", "is no quantity; expected a list of values"),
        (VARY + "load.mass: {from: 1 kg, to: 2 kg, steps: 2}\nsampling: {latin_hypercube: 5}\n", "leave steps out"),
        ("spec: robot.yaml\nsampling: {latin_hypercube: 5}\n", "expected fields under vary"),
        ("spec: robot.yaml\ncatalogs: maxon\n", "\"maxon\" is no list with entries; expected e.g. [[maxon]"),
        ("vary: {load.mass: [1 kg]}\n", "give spec or specs, exactly one of them; neither is given"),
        ("spec: robot.yaml\nspecs: [robot.yaml]\n", "give spec or specs, exactly one of them; both are given"),
        ("specs: [robot.yaml]\nvary: {load.mass: [1 kg]}\n", "expected spec, the one that is varied, not specs"),
        ("specs: [robot.yaml, robot.yaml]\n", '"robot.yaml" is given twice'),
        ("spec: nowhere.yaml\n", 'study.yaml:1: spec: "nowhere.yaml" cannot be read (no such file or directory)'),
        ("spec: robot.yaml\nobjectives: [mas]\n", 'objectives[1]: objective "mas" is not known; expected mass, price'),
        ("spec: robot.yaml\nobjectives: [mass, mass]\n", '"mass" is given twice'),
        (LARGE.replace("2500", "25001"),
         f"vary: makes 100004000 variants; expected at most {MOST_IN_CHUNKS}"),
        (VARY + "load.mass: [30 kg]\nsampling: {latin_hypercube: 10000001}\n", "makes 10000001 variants"),
    ],
)  # fmt: skip
def test_a_wrong_study_is_one_line(tmp_path, study, said):
    assert said in refusal(lambda: planned(tmp_path, study))


def test_ten_million_variants_are_a_plan_and_no_list(tmp_path):
    plan = planned(tmp_path, LARGE)
    assert plan.total == MOST
    assert plan.variant(MOST).values == ("2.0 kg", "2.0 m/s")
    more = planned(tmp_path, LARGE.replace("2500", "2501"))
    said = "makes 10004000 variants; expected at most 10000000, more by --chunks"
    assert said in refusal(lambda: carry_out(more, tmp_path / "study", processes=1))


# --- rows -------------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    "spec",
    [
        CHEAP,
        EXAMPLE,
        EXAMPLE.replace("method: paper", "method: physics"),
        CHEAP.replace("mass: 45 kg", "mass: 450 kg"),
        CHEAP.replace("method: paper", "method: physics").replace("mass: 45 kg", "mass: 450 kg"),
        EXAMPLE.replace("method: paper", "method: physics").replace("autonomy: 3 h", "autonomy: 30 h"),
        CHEAP.replace("method: paper", "method: physics")
        + "  unknown: reject\nbudget: {mass: 46 kg, structure: 20 kg, drive_counts: true}\n",
        CHEAP.replace("method: paper", "method: physics").replace("    ratio: 1.1 ", "    ratios: [1.1, 2] "),
    ],
    ids=["paper", "battery", "physics", "paper heavy", "physics heavy", "budget falls", "own mass", "ratios"],
)
@pytest.mark.parametrize("objective", [None, "price"])
def test_the_best_sets_are_those_of_size(spec, objective):
    """What a study leaves out of a sizing changes nothing in what it keeps."""
    robot = read_spec(YamlSource(spec, str(ROOT / "examples" / "sps_robot.yaml")))
    catalog = load_parts(robot)
    whole, short = (
        size(robot, catalog=catalog, top=2, objective=objective),
        best(robot, catalog, top=2, objective=objective),
    )
    assert _alike(short.sets, whole.sets)
    budgets = {"failed_by_budget": short.counts.failed_by_budget}  # which no table shows: few drives are not tallied
    assert (short.counts, short.objective) == (replace(whole.counts, **budgets), whole.objective)
    assert (short.nearest is None) == bool(whole.sets)
    if short.nearest:
        assert short.nearest.status == "fail" and _alike([short.nearest], whole.misses[:1])


def _alike(ours, theirs):
    """The same sets; figures but for the last digits, which depend on how many drives are computed together."""
    for a, b in zip(ours, theirs, strict=True):
        assert (a.label, a.status) == (b.label, b.status)
        assert [part and part.part for part in a.parts.values()] == [part and part.part for part in b.parts.values()]
        tightest = [worst(one.deciding) for one in (a, b)]  # of the drive's own checks a study keeps no other
        every = {(check.name, check.case): check for check in b.deciding}
        checks = [(x, every[x.name, x.case]) for x in a.deciding]
        assert [x and (x.name, x.case) for x in tightest[:1]] == [y and (y.name, y.case) for y in tightest[1:]]
        assert all(x.status == y.status for x, y in checks)
        figure_pairs = [(x.demand, y.demand) for x, y in checks] + [(x.margin, y.margin) for x, y in checks]
        by_name = {y.name: y.value for y in b.figures}
        figure_pairs += [(x.value, by_name[x.name]) for x in a.figures]
        assert bool(a.figures) == bool(b.figures)
        figure_pairs += [(a.mass, b.mass), (a.objective, b.objective)]
        np.testing.assert_allclose(*zip(*figure_pairs, strict=True), rtol=1e-9)
    return True


@pytest.mark.parametrize(
    "spec", [EXAMPLE, EXAMPLE.replace("method: paper", "method: physics")], ids=["paper", "physics"]
)
def test_rows_by_several_objectives_are_those_by_each_alone(tmp_path, spec):
    """Of a light machine that has drives and a heavy one that has none."""
    study = "spec: robot.yaml\nvary: {load.mass: [30 kg, 900 kg]}\nobjectives: [%s]\n"
    names = ("mass", "price", "length")
    together = table(planned(tmp_path, study % ", ".join(names), spec))
    assert {row["status"] for row in together} >= {"pass", "fail"}
    for place, name in enumerate(names):
        alone = table(planned(tmp_path, study % name, spec))
        assert [row | {"variant": 0} for row in together[place :: len(names)]] == [r | {"variant": 0} for r in alone]


def test_a_row_is_what_size_finds(tmp_path):
    plan = planned(tmp_path, FEW + "objectives: [mass, price]\ntop: 2\n")
    rows = table(plan)
    for number in (1, 4, 8):
        variant = plan.variant(number)
        found = size(spec_of(plan.job, variant), top=2, objective=plan.job.objectives[variant.objective])
        ours = [row for row in rows if row["variant"] == number]
        assert [(row["set"], row["status"], row["mass_kg"]) for row in ours] == [
            (one.label, one.status, float(f"{one.mass:.12g}")) for one in found.sets
        ]
        for row, one in zip(ours, found.sets, strict=True):
            tight = worst(one.deciding)
            assert (row["smallest_margin"], row["smallest_margin_check"]) == (float(f"{tight.margin:.12g}"), tight.name)
            assert (row["motor_part"], row["gearhead_part"]) == (one.motor.part, one.gearhead.part)
            assert row["price_EUR"] == one.price
            assert row["sets_examined"] == found.counts.considered


def test_four_wheels_and_two_are_compared_by_the_machine(tmp_path):
    """Mass and price of one drive say that four wheels are lighter; those of all drives are carried and paid for."""
    cart = """\
name: cart
load: {kind: wheeled_vehicle, mass: 60 kg, driven_wheels: 2, wheel_diameter: 150 mm, rolling_resistance: 2 %,
       inertia: 25 kg*cm^2}
motion: {speed: 1.2 m/s, acceleration_time: 1.5 s, cruise_time: 60 s, rest_time: 10 s}
transmission: [{kind: gearhead}]
supply: {nominal: 24 V, accepts: all}
select: {catalogs: [maxon], objective: mass}
"""
    rows = table(planned(tmp_path, "spec: robot.yaml\nvary: {load.driven_wheels: [2, 4]}\n", cart))
    assert [row["drives"] for row in rows] == [2, 4]
    for row in rows:
        assert row["machine_mass_kg"] == pytest.approx(row["drives"] * row["mass_kg"], rel=1e-12)
        assert row["machine_price_EUR"] == pytest.approx(row["drives"] * row["price_EUR"], rel=1e-12)
    assert rows[1]["mass_kg"] <= rows[0]["mass_kg"] and rows[1]["machine_mass_kg"] > rows[0]["machine_mass_kg"]


def test_a_slope_is_varied_as_a_grade(tmp_path):
    """Rise over run, as the field itself takes it: by hand atan(0.04) is 0.0399787 rad."""
    plan = planned(tmp_path, "spec: robot.yaml\nvary: {load.slope: [0 %, 4 %, 8 %]}\n")
    assert [spec_of(plan.job, plan.variant(n)).load.slope for n in (1, 2, 3)] == pytest.approx(
        [0.0, 0.0399787, 0.0798300], abs=5e-8
    )
    assert [row["load.slope (%)"] for row in table(plan)] == [0.0, 4.0, 8.0]
    plan = planned(tmp_path, "spec: robot.yaml\nvary: {load.slope: {from: 0 %, to: 8 %, steps: 3}}\n")
    assert spec_of(plan.job, plan.variant(2)).load.slope == pytest.approx(0.0399787, abs=5e-8)


def test_what_is_not_known_is_empty_and_named(tmp_path):
    """The catalogue prints no price of RE 25 118752, its encoder and its controller."""
    (row,) = table(planned(tmp_path, "spec: robot.yaml\n"))
    assert (row["status"], row["motor_part"], row["gearhead_part"]) == ("pass", "118752", "406764")  # the paper's
    assert row["energy_J"] is None  # the paper's method has none
    assert set(row["price_lacks"].split(" + ")) >= {"motor"}
    assert math.isclose(row["mass_kg"], 0.130 + 0.077 + 0.020 + 0.045) and row["mass_lacks"] == ""


def test_without_a_passing_drive_the_closest_is_named_and_the_drive_is_empty(tmp_path):
    (row,) = table(planned(tmp_path, "spec: robot.yaml\nvary: {load.mass: [450 kg]}\n"))
    assert (row["status"], row["set"], row["mass_kg"], row["rank"]) == ("fail", "", None, None)
    assert row["smallest_margin"] < 0.0 and row["smallest_margin_check"]
    assert row["nearest_miss"].startswith("RE 25")
    assert row["sets_that_stand"] == 0 < row["sets_examined"]


def test_a_variant_that_is_no_machine_is_a_row_and_the_others_go_on(tmp_path):
    study = VARY + "load.mass: [45 kg, -5 kg]\n  select.motor.family: [RE 25, RE 2500]\n"
    rows = table(planned(tmp_path, study))
    assert [row["status"] for row in rows] == ["pass", "error", "error", "error"]
    assert 'select.motor.family: "RE 2500" is in no catalogue that the spec names' in rows[1]["error"]
    assert 'robot.yaml:10: load.mass: "-5 kg" must be above 0 kg' in rows[2]["error"]
    assert rows[2]["sets_examined"] is None and rows[2]["load.mass (kg)"] == -5.0


def test_a_study_of_which_every_variant_is_wrong_does_not_begin(tmp_path):
    with pytest.raises(InputError, match=r"all of its variants are invalid \(2\); the first: .*must be above 0 kg"):
        refuse_if_all_invalid(planned(tmp_path, VARY + "load.mass: [-5 kg, -6 kg]\n"))
    assert refuse_if_all_invalid(planned(tmp_path, VARY + "load.mass: [-5 kg, 6 kg]\n")) == ""
    many = ", ".join(f"-{n + 1} kg" for n in range(500)) + ", 30 kg"
    assert "variants tried is invalid, the first" in refuse_if_all_invalid(
        planned(tmp_path, VARY + f"load.mass: [{many}]\n")
    )


# --- what the results follow from -------------------------------------------------------------------------------------


def test_the_columns_on_the_page_are_those_of_the_table(tmp_path):
    """Each column of the table is named on the page, alone or as one of those that follow ``set``."""
    page = (ROOT / "docs" / "studies.md").read_text(encoding="utf-8")
    listed = set(re.findall(r"`(\w+)`", page[page.index("## Results") : page.index("## Interruption")]))
    plan = planned(tmp_path, "specs: [robot.yaml, study.yaml]\ncatalogs: [[maxon], [faulhaber]]\n")
    heads = [column.head for column in columns_of(plan)]
    parts = heads[heads.index("set") + 1 : heads.index("mass_kg")]
    assert all(re.match("motor|gearhead|belt|screw|brake|encoder|controller|total_ratio", head) for head in parts)
    assert set(heads) - set(parts) <= listed
