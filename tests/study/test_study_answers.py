"""What a study answers out of its rows: fields that follow, limits, the best of each case, the front, the influence."""

from __future__ import annotations

import csv

import openpyxl
import pytest
from refusals import refusal
from studies import CHEAP, laid

from drivesizer import size_variants
from drivesizer.files.yaml_source import YamlSource
from drivesizer.output.report import write_document
from drivesizer.study.document import document_of as document_of_study
from drivesizer.study.plan import read_study
from drivesizer.study.rows import document_of
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
