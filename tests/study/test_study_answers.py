"""What a study answers out of its rows: fields that follow, limits, the best of each case, the front, the influence."""

from __future__ import annotations

import csv

import numpy as np
import openpyxl
import pytest
from lxml import etree
from refusals import refusal
from studies import CHEAP, laid

from drivesizer import size_variants
from drivesizer.files.yaml_source import YamlSource
from drivesizer.output.report import write_document
from drivesizer.sizing import size
from drivesizer.study.document import document_of as document_of_study
from drivesizer.study.maps import drawings, look_of, map_axes, points
from drivesizer.study.plan import read_study
from drivesizer.study.rows import document_of, rows_of, spec_of
from drivesizer.study.run import carry_out

STUDY = """\
spec: robot.yaml
vary:
  load.mass: [30 kg, 45 kg, 60 kg]
  motion.speed: [1 m/s, 1.5 m/s]
derive: {load.wheel_diameter: 0.1 + 0.001 * load.mass}
columns: [time]
best: {over: [load.mass], by: mass - 0.001 * load.mass}
front: [mass, -load.mass]
influence: [load.mass + 10 * motion.speed, time]
"""


def table(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    return carry_out(read_study(laid(folder, STUDY)), folder / "study", processes=1)


@pytest.fixture
def done(outcome):
    return outcome.plan, {path.name: table(path) for path in outcome.written if path.suffix == ".csv"}


def test_the_report_has_the_rows_the_answers_and_the_maps(outcome, done, tmp_path):
    page, book = write_document(document_of_study(outcome), [tmp_path / "s.html", tmp_path / "s.xlsx"])
    sheets = openpyxl.load_workbook(book)
    assert sheets.sheetnames == ["Outcome", "Best", "Front", "Influence", "Variants"]
    heads, *rows = sheets["Variants"].iter_rows(values_only=True)
    of, (_, tables) = heads.index("load.mass (kg)"), done
    assert [row[of] for row in rows] == [float(row["load.mass (kg)"]) for row in tables["results.csv"]]
    assert sheets["Outcome"]["B2"].value == outcome.variants["pass"] > 0
    text = page.read_text(encoding="utf-8")
    assert all(f'alt="{title}"' in text for title in ("Best drive", "Smallest margin (%)"))
    assert "The front: no variant beats these in all goals" in text


def test_a_field_follows_from_another(done):
    plan, _ = done
    data = document_of(plan.job, plan.variant(6)).data
    assert (data["load"]["mass"], data["load"]["wheel_diameter"]) == ("60 kg", "0.16 m")


def test_the_best_of_each_case_and_the_front_are_those_of_the_rows(done):
    _, tables = done
    rows = [row for row in tables["results.csv"] if row["status"] in ("pass", "unknown")]
    assert {float(row["cycle_time_s"]) for row in rows} == {244.0}

    def goals(row):
        return float(row["machine_mass_kg"]), -float(row["load.mass (kg)"])

    for row in tables["best.csv"]:
        same = [one for one in rows if one["motion.speed (m/s)"] == row["motion.speed (m/s)"]]
        assert min(a + 0.001 * b for a, b in map(goals, same)) == pytest.approx(goals(row)[0] + 0.001 * goals(row)[1])
    assert len(tables["best.csv"]) == 2
    front = {goals(row) for row in tables["front.csv"]}
    every = {goals(row) for row in rows}
    assert front == {a for a in every if not any(b != a and b[0] <= a[0] and b[1] <= a[1] for b in every)}


def test_the_influence_of_a_sum_is_the_share_of_its_variance(done):
    """Of m + 10 v over a full grid: the variances are 150 and 6.25, no interaction, and the time never changes."""
    _, tables = done
    share = {(row["figure"], row["field"]): float(row["share"]) for row in tables["influence.csv"]}
    of = "load.mass + 10 * motion.speed"
    assert share[of, "load.mass"] == pytest.approx(150 / 156.25)
    assert share[of, "motion.speed"] == pytest.approx(6.25 / 156.25)
    assert share["time", "load.mass"] == 0.0


def test_the_influence_of_a_list_is_that_of_its_entries_in_a_sample_too():
    """A figure that is a field: all of its variance is between the entries of that field, next to none of another."""
    found = size_variants(
        YamlSource(CHEAP, "robot").data,
        {"load.driven_wheels": [2, 4], "load.mass": {"from": "20 kg", "to": "30 kg"}},
        sampling={"latin_hypercube": 40, "seed": 1}, influence=["load.driven_wheels"],
    )  # fmt: skip
    wheels, mass = found.answers["influence"]
    assert [wheels[name] for name in ("field", "share", "least_at", "most_at")] == ["load.driven_wheels", 1.0, "2", "4"]
    assert mass["share"] < 0.1


def test_a_drive_beyond_a_limit_fails_with_it(tmp_path):
    study = "spec: robot.yaml\nvary: {load.mass: [30 kg, 60 kg]}\nrequire: [load.mass <= 45 kg, price <= 9000 EUR]\n"
    plan = read_study(laid(tmp_path, study))
    carry_out(plan, tmp_path / "study", processes=1, maps=None)
    light, heavy = table(tmp_path / "study" / "results.csv")
    assert light["price_lacks"]
    assert light["status"] == "unknown"  # the sum is that of the known prices
    assert (heavy["status"], heavy["smallest_margin_check"]) == ("fail", "load.mass <= 45 kg")
    assert float(heavy["smallest_margin"]) == pytest.approx(-1 / 3)
    assert heavy["set"] == ""
    assert heavy["nearest_miss"]


def test_fields_vary_together(tmp_path):
    study = "spec: robot.yaml\nvary: {'load.mass, motion.speed': [[30 kg, 1 m/s], [60 kg, 1.5 m/s], [60 kg, 1 m/s]]}\n"
    plan = read_study(laid(tmp_path, study))
    assert plan.total == 3
    data = document_of(plan.job, plan.variant(2)).data
    assert (data["load"]["mass"], data["motion"]["speed"]) == ("60 kg", "1.5 m/s")
    assert plan.variant(2).head == [2, "60 kg, 1.5 m/s"]


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("derive: {load.width: 2 * load.mass}", 'derive.load.width: "load.width": "width" is no field of load'),
        ("derive: {load.mass: 2 * load.mass}", "follows from itself"),
        ("require: [mass < 3 kg]", "study.yaml:3: require[1]"),
        ("best: {over: [load.slope], by: mass}", 'study.yaml:3: best.over[1]: "load.slope" does not vary'),
        ("front: [mass, weight]", 'study.yaml:3: front[2]: "weight" is no figure'),
        ("columns: [autonomie]", "study.yaml:3: columns[1]"),
    ],
)
def test_what_is_wrong_is_one_line(tmp_path, line, said):
    assert said in refusal(
        lambda: read_study(laid(tmp_path, f"spec: robot.yaml\nvary: {{motion.speed: [1 m/s, 2 m/s]}}\n{line}\n"))
    )


def test_a_study_is_a_call():
    spec = YamlSource(CHEAP, "robot").data
    found = size_variants(spec, {"load.mass": ["30 kg", "60 kg"]}, objectives=["mass"], front=["mass", "-load.mass"])
    assert [row["load.mass (kg)"] for row in found.rows()] == [30.0, 60.0]
    assert found.answers["front"]
    assert str(found).startswith("2 variants: ")


# --- maps

GRID = """\
spec: robot.yaml
vary:
  load.mass: [30 kg, 60 kg, 90 kg, -5 kg]
  motion.speed: [1.2 m/s, 1.9 m/s]
"""


def mapped(folder, study, names=(), spec=CHEAP):
    plan = read_study(laid(folder, study, spec))
    variants = [plan.variant(n) for n in range(1, plan.total + 1)]
    rows = rows_of(plan.job, variants).rows
    over = map_axes(plan, names)
    return over, points(plan, over, rows), plan


def texts(svg):
    """The texts of a drawing for a typesetter, where letters are letters."""
    return [" ".join(t.itertext()).strip() for t in etree.fromstring(svg).iter("{http://www.w3.org/2000/svg}text")]


def test_a_map_of_drives_numbers_and_names_them(tmp_path):
    over, found, _ = mapped(tmp_path, GRID)
    made, said = drawings(over, found)
    assert said == [] and list(made) == ["best_set", "mass", "price", "smallest_margin"]
    seen = texts(made["best_set"]("typeset"))
    sets = {row["set"] for row in found[()] if row["set"]}
    assert len(sets) >= 2
    for number, name in enumerate(sorted(sets, key=lambda s: (-sum(r["set"] == s for r in found[()]), s)), 1):
        assert f"{number}  {name}" in seen
        assert seen.count(str(number)) == sum(row["set"] == name for row in found[()])
    assert seen.count("×") == 2  # of -5 kg at both speeds
    assert "load.mass (kg)" in seen and "motion.speed (m/s)" in seen
    assert any("hatched: no drive passes" in text and "×: an invalid variant" in text for text in seen)


def test_several_motor_families_are_a_map_of_their_own(tmp_path):
    over, found, _ = mapped(tmp_path, GRID)
    passing = [row for row in found[()] if row["set"]]
    for row in passing:
        row["motor_family"] = "RE 30"
    passing[0]["motor_family"] = "EC-max 40"
    seen = texts(drawings(over, found)[0]["motor_family"]("typeset"))
    assert {"1  RE 30", "2  EC-max 40", "Motor family of the best drive"} <= set(seen)


def test_the_colour_blind_distinguish_the_colours_of_drives():
    """As seen without red or green cones (Viénot, Brettel, Mollon 1999): CIE 1976 differences above 10 throughout."""
    short = {
        "protan": [[0.11238, 0.88762, 0.0], [0.11238, 0.88762, 0.0], [0.00401, -0.00401, 1.0]],
        "deutan": [[0.29275, 0.70725, 0.0], [0.29275, 0.70725, 0.0], [-0.02234, 0.02234, 1.0]],
    }
    to_xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    rgb = np.array(
        [[int(face[n : n + 2], 16) / 255 for n in (1, 3, 5)] for face in {look_of(n).face for n in range(1, 9)}]
    )
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    for seen in (np.eye(3), *map(np.array, short.values())):
        xyz = np.cbrt(np.clip(linear @ seen.T, 0.0, 1.0) @ to_xyz.T / to_xyz.sum(axis=1))
        lab = np.stack([116 * xyz[:, 1] - 16, 500 * (xyz[:, 0] - xyz[:, 1]), 200 * (xyz[:, 1] - xyz[:, 2])], axis=1)
        apart = np.linalg.norm(lab[:, None] - lab, axis=2) + 1e3 * np.eye(8)
        assert apart.min() > 10.0


def test_the_same_drawing_has_the_same_bytes(tmp_path):
    made, _ = drawings(*mapped(tmp_path, GRID)[:2])
    again, _ = drawings(*mapped(tmp_path, GRID)[:2])
    for form in ("svg", "png"):
        assert made["mass"](form) == again["mass"](form)
    assert b"<text" not in made["mass"]("svg") and made["mass"]("png").startswith(b"\x89PNG")


@pytest.mark.slow
def test_probabilities_are_drawn_where_the_spec_has_tolerances(tmp_path):
    """Each variant has the probabilities that `size` reports for the same machine."""
    spec = CHEAP.replace("mass: 45 kg", "mass: 45 kg +- 3 kg") + "tolerances: {samples: 256}\n"
    study = "spec: robot.yaml\nvary:\n  motion.speed: [1.2 m/s, 1.5 m/s]\n  supply.current: [5 A, 8 A]\n"
    over, found, plan = mapped(tmp_path, study, spec=spec)
    probabilities = [row["none_fails"] for row in found[()]]
    assert 0.0 < min(probabilities) < 0.95 < max(probabilities)
    seen = texts(drawings(over, found)[0]["none_fails"]("typeset"))
    assert all(f"{100 * share:.3g}" in seen for share in probabilities)
    for number, share in enumerate(probabilities, 1):
        alone = size(spec_of(plan.job, plan.variant(number))).sets[0].reliability
        assert alone and alone.probability == share


def test_an_unknown_figure_is_no_colour_of_the_scale(tmp_path):
    """A set of which the mass is not known has an empty cell without a text, not a zero."""
    over, found, _ = mapped(tmp_path, GRID)
    known, *others = [row for row in found[()] if row["set"]]
    rows = [known, *(row | {"machine_mass_kg": None} for row in others)]
    seen = texts(drawings(over, {(): rows})[0]["mass"]("typeset"))
    mass = f"{known['machine_mass_kg']:.3g}"
    assert [text for text in seen if text.lstrip("≥") in (mass, "0")] == [
        text for text in seen if mass == text.lstrip("≥")
    ]
    assert any(text.endswith("wherever it is known: one value, so no colour scale") for text in seen)
