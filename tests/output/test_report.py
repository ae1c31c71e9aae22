"""Reports: what they say is what was found, hostile text stays text, and a file is whole or untouched."""

import io
import json
import subprocess
import sys
from dataclasses import replace
from math import inf, isnan, nan
from pathlib import Path

import pypdf
import pytest
from bought_parts import together
from html_reports import figures_of, parsed
from printed import blank_figures, text_of
from report_texts import rows_of
from starters import STARTERS, starter
from synthetic_validation import synthetic_validation

import drivesizer
from drivesizer.errors import InputError
from drivesizer.files.writing import write_files
from drivesizer.output.derivation import evaluated_failures, step
from drivesizer.output.document.axes import content_of
from drivesizer.output.document.content import Content
from drivesizer.output.document.records import Equation, Words
from drivesizer.output.document.worked import with_numbers
from drivesizer.output.report import csv as csv_tables
from drivesizer.output.report import pdf, write, write_series, write_sets
from drivesizer.output.report.html.page import report_html
from drivesizer.results.drive_set import Relaxation
from drivesizer.results.sizing import SizingResult
from drivesizer.sizing import size
from drivesizer.spec.robot import load_spec

# -- CSV


def test_csv_shows_the_units_of_the_trade(result):
    rows = {r["name"]: r for r in rows_of(csv_tables.report_csv(content_of(result))) if r["set_rank"] in ("", "1")}
    # EQUATIONS.md: n_nom = 208.865 rpm; the set of the paper
    assert rows["nominal_speed"]["unit"] == "rpm"
    assert float(rows["nominal_speed"]["value"]) == pytest.approx(208.865, abs=0.0005)
    assert (rows["motor"]["value"], rows["gearhead"]["value"]) == ("118752", "406764")
    assert rows["price"]["note"] == "sum of gearhead"


def test_time_series_beside_the_table(result, tmp_path):
    validation = synthetic_validation(result)
    written = write(result, validation, [tmp_path / "report.csv"])
    assert [path.name for path in written] == ["report.csv", "report-parts.csv", "report-timeseries.csv"]
    raw = written[2].read_bytes()
    assert b"\r" not in raw
    rows = rows_of(raw)
    assert list(rows[0])[:2] == ["time (s)", "speed_reference (m/s)"]
    assert "motor_speed (rpm)" in rows[0]
    assert [float(r["current (A)"]) for r in rows] == validation.series["current"].tolist()
    table = [r for r in rows_of(written[0].read_bytes()) if r["section"] == "validation"]
    assert {r["name"]: r["status"] for r in table}["winding"] == "unknown"
    assert {r["name"]: r["si_limit"] for r in table}["winding"] == ""
    assert {r["name"]: r["at_time_s"] for r in table}["current"] == "1.98"
    alone = write_series(validation, tmp_path / "alone.csv")
    assert alone[0].read_bytes() == raw


# -- PDF


def test_pdf_says_what_was_found_and_has_the_same_bytes_each_time(result, tmp_path):
    validation = synthetic_validation(result)
    with blank_figures():  # whose own bytes are compared in test_figures and test_set_figures
        (path,) = write(result, validation, [tmp_path / "report.pdf"])
        content = path.read_bytes()
        assert content.startswith(b"%PDF")
        assert pdf.report_pdf(content_of(result, validation)) == content
    assert b"CreationDate" not in content
    text, best = text_of(content), result.sets[0]
    for part in (best.motor, best.gearhead, best.encoder, best.controller):
        assert part is not None and part.part in text
    for number in (*range(1, 4), *range(5, 21)):  # the spec gives C_rr: no (4)
        assert f"({number})" in text
    for said in (
        "A drive was found",
        "208.9",
        "336.9",
        "secondary",
        "derived",
        "recalled",
        "Kessler 1955",
        f"drivesizer {drivesizer.__version__}",
    ):
        assert said in text
    assert "fails the unit check" in text
    assert next(iter(result.catalog.digests.values())) in text
    attached = pypdf.PdfReader(io.BytesIO(content)).attachments
    assert b"# assumed: rubber on concrete" in attached["sps_robot.yaml"][0]  # the spec file, comments included


def test_letters_of_other_scripts_and_control_characters_do_no_harm(result):
    named = result.spec.model_copy(update={"name": "測試 робот 😀 \x00\x1b[31m \u202e"})
    with blank_figures():
        content = pdf.report_pdf(content_of(replace(result, problem=replace(result.problem, machine=named))))
    assert all(said in text_of(content, most=1) for said in ("робот", "\\x1b[31m"))


def test_nothing_to_look_at_at_all(result):
    empty = replace(result.counts, considered=0, feasible=0, failed_by={})
    bare = replace(result, sets=(), misses=(), counts=empty, unrestricted=None)
    with blank_figures():
        assert "no combination of motor and gearhead" in text_of(pdf.report_pdf(content_of(bare)), most=1)
    assert csv_tables.report_csv(content_of(bare))


def test_every_requirement_has_its_numbers_put_in(result):
    for r in (*result.requirements, *result.sets[0].requirements):
        if r.declared is not None:
            made = step(r)
            assert made["numbers"] and made["result"]
            assert bool(made["failure"]) == (r.equation in (10, 20))
    made = {r.name: step(r) for r in result.requirements}
    assert made["rms_torque"]["numbers"].count("(-2.855 thin") == 1  # a negative figure under a square has brackets
    assert made["wheel_mass"]["numbers"].count('(0.0762 thin "m")^(2)') == 1


def test_the_kept_failures_of_printed_forms_are_those_that_are_found():
    kept = json.loads(
        (Path(drivesizer.__file__).parent / "output" / "printed_failures.json").read_text(encoding="utf-8")
    )
    assert kept == evaluated_failures() and set(kept) == {"acceleration_torque", "no_load_speed"}


# -- every kind of load, load cases, margins, fronts


@pytest.mark.slow
@pytest.mark.parametrize("kind", sorted(path.stem for path in STARTERS.glob("*.yaml")))
def test_every_starter_has_its_reports(kind, tmp_path, catalog):
    found = size(starter(kind, tmp_path), catalog=catalog, top=2)
    best = found.sets[0]
    text = text_of(pdf.report_pdf(content_of(found)), most=12)  # the contents, and all that differs from load to load
    assert text.count(best.motor.part) >= 2 and "How to repeat this" in text
    wheels, platform = kind == "wheeled_vehicle", kind == "mecanum_platform"
    assert ("at the load's shaft" in text) is not (wheels or platform)
    assert (
        "Nominal force, torque and power" not in text
    )  # requirements are those of the method: no starter asks the paper's
    assert "paper's own method" not in text.replace("’", "'") and "by the method of the paper" not in text
    assert ("Each driven wheel is a load case" in text) is platform
    assert "Closed loop" not in text and "Current limit to set" in text
    rows = rows_of(csv_tables.report_csv(content_of(found)))
    figures = {r["name"]: r for r in rows if r["section"] == "figure" and r["set_rank"] == "1"}
    assert list(figures) == [f.name for f in best.figures]
    for figure in best.figures:
        assert figures[figure.name]["si_value"] == ("" if isnan(figure.value) else str(float(figure.value)))
    header, *sets = csv_tables.sets_csv(found).decode().splitlines()
    assert len(sets) == len(found.sets) + len(found.misses) and "figure_energy_J" in header
    with blank_figures():  # those of every starter stand in the PDF
        page = parsed(report_html(content_of(found)))
    assert best.motor.part in page.text_content() and {"profile", "cycle", "field"} <= set(figures_of(page))


@pytest.fixture(scope="module")
def cased(tmp_path_factory, catalog) -> SizingResult:
    """A hoist with margins, load cases of hostile names, a weighted objective, and a front."""
    more = """
margins: {torque: 20 %, temperature: 0.15}
cases:
  - {name: '#eval("1+1") $x$ `raw`', load: {mass: 18 kg}}
  - {name: weak battery, supply: {nominal: 20 V, min: 18 V}}
"""
    weighted = "objective: [{objective: mass, weight: 2}, {objective: price, weight: 1}]"
    spec = starter(
        "hoist",
        tmp_path_factory.mktemp("cases"),
        ("objective: mass", weighted),
        ("hold_unpowered: true", "hold_unpowered: false"),
        more=more,
    )
    return size(spec, catalog=catalog, top=2, pareto=("mass", "price", "energy"))


@pytest.fixture(scope="module")
def cased_pdf(cased) -> bytes:
    return pdf.report_pdf(content_of(cased))


def test_load_cases_margins_and_objectives_are_told(cased, cased_pdf):
    text = text_of(cased_pdf)
    assert 'case #eval("1+1") $x$ `raw`' in text  # the load case in which a check is worst
    assert "needs +20 %" in text and "needs +15 %" in text
    assert "ranked by 2 mass + 1 price" in text and "in the worst load case" in text
    rows = [
        r for r in rows_of(csv_tables.report_csv(content_of(cased))) if r["section"] == "check" and r["set_rank"] == "1"
    ]
    found = {row["name"]: (row["case"], float(row["needed_margin"])) for row in rows if row["needed_margin"]}
    assert found == {check.name: (check.case, check.needed) for check in cased.sets[0].checks}
    assert {0.0, 0.2, 0.15} == {needed for _, needed in found.values()}
    (head,) = [name for name in rows_of(csv_tables.sets_csv(cased))[0] if name.startswith("objective")]
    assert head == "objective_2_mass_1_price_si"


def test_a_front_is_printed_drawn_and_in_the_tables(cased, cased_pdf):
    assert len(cased.front) > 1
    text = text_of(cased_pdf)
    assert "The Pareto front" in text and "energy per cycle" in text
    for one in cased.front[:5]:
        assert one.motor.part in text
    rows = [r for r in rows_of(csv_tables.report_csv(content_of(cased))) if r["section"] == "front"]
    for one in cased.front:
        mine = {r["name"]: r for r in rows if r["set_rank"] == str(one.rank)}
        assert mine["mass"]["title"].startswith(one.label)
        assert float(mine["mass"]["si_value"]) == pytest.approx(together(one), rel=1e-12)
        assert mine["energy"]["unit"] == "J"
    listed = [r["list"] for r in rows_of(csv_tables.sets_csv(cased))]
    assert listed == ["set"] * len(cased.sets) + ["miss"] * len(cased.misses) + ["front"] * len(cased.front)


def test_changes_are_told_with_numbers(cased):
    moves = (
        Relaxation(field="load.inertia", now="3 kg·m²", needed="2.5 kg·m²", set_label="that set", share=0.17,
                   kind="inertia", unit="kg*m^2", before=3.0, after=2.5),
        Relaxation(field="environment.ambient", now="40 °C", needed="25.5 °C", set_label="that set", share=0.05,
                   kind="temperature", unit="degC", before=313.15, after=298.65),
        Relaxation(field="gearhead", now="27:1", needed="35:1", set_label="another", share=0.3,
                   kind="dimensionless", unit="1", before=26.85, after=34.97),
    )  # fmt: skip
    miss = replace(cased.sets[0], status="fail", changes=moves)
    nothing = replace(cased, sets=(), misses=(miss,), relaxations=moves[:1])
    rows = [r for r in rows_of(csv_tables.report_csv(content_of(nothing))) if r["section"] == "change"]
    assert [(r["name"], r["value"], r["limit"], r["unit"]) for r in rows] == [
        ("load.inertia", "3.0", "2.5", "kg*m^2"),
        ("load.inertia", "3.0", "2.5", "kg*m^2"),
        ("environment.ambient", "40.0", "25.5", "degC"),
        ("gearhead", "26.85", "34.97", "1"),
    ]
    with blank_figures():
        text = text_of(pdf.report_pdf(content_of(nothing)))
        in_vain = replace(nothing, relaxations=(), tried=("load.mass", "load.slope"))
        without = text_of(pdf.report_pdf(content_of(in_vain)))
    for said in (
        "Changes after which the closest rejected drive passes",
        "Changes after which a drive passes",
        "load › inertia",
    ):
        assert said in text
    assert "None of these figures" in without and "None of these figures" not in text


def test_what_has_no_end_is_told_from_what_is_unknown(cased):
    best = cased.sets[0]
    figures = (replace(best.figures[0], value=inf), replace(best.figures[1], value=nan))
    rows = rows_of(csv_tables.report_csv(content_of(replace(cased, sets=(replace(best, figures=figures),), misses=()))))
    assert [r["si_value"] for r in rows if r["section"] == "figure"] == ["inf", ""]


# -- files


def test_an_unknown_kind_is_named_with_the_known_ones(result, tmp_path):
    with pytest.raises(InputError, match=r'"report\.docx".*\.pdf, \.html, \.xlsx, \.csv or \.json'):
        write(result, None, [tmp_path / "report.docx"])
    assert not list(tmp_path.iterdir())


def test_a_failing_render_leaves_the_older_file_alone(result, tmp_path, monkeypatch):
    path = tmp_path / "report.pdf"
    path.write_bytes(b"older")
    monkeypatch.setattr(pdf, "paper_data", lambda *_: {"name": "no template can set this", "sections": []})
    with pytest.raises(pdf.ReportError, match="could not be set"):
        write(result, None, [path])
    assert path.read_bytes() == b"older"
    assert [p.name for p in tmp_path.iterdir()] == ["report.pdf"]


def test_a_target_that_cannot_be_written(result, tmp_path):
    with pytest.raises(InputError, match="there is no folder"):
        write(result, None, [tmp_path / "missing" / "report.csv"])
    (tmp_path / "taken.csv").mkdir()
    with pytest.raises(InputError, match="it is a folder"):
        write_sets(result, tmp_path / "taken.csv")
    assert [p.name for p in tmp_path.iterdir()] == ["taken.csv"]


def test_a_link_stays_a_link(tmp_path):
    (tmp_path / "real.csv").write_bytes(b"older")
    link = tmp_path / "link.csv"
    try:
        link.symlink_to(tmp_path / "real.csv")
    except OSError:
        pytest.skip("no links here")
    write_files({link: b"new"})
    assert link.is_symlink() and (tmp_path / "real.csv").read_bytes() == b"new"


def test_csv_and_the_package_load_neither_matplotlib_nor_typst():
    code = "import sys, drivesizer.output.report.csv; print({'matplotlib', 'typst'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


# --- formulas with numbers

SUPPLY = {"nominal": "24 V", "min": "22 V", "max": "26 V", "regeneration": 0, "accepts": "all"}
MOVE = {
    "speed": "0.2 m/s",
    "acceleration_time": "0.3 s",
    "cruise_time": "2 s",
    "rest_time": "1 s",
    "there_and_back": True,
}
TURN = MOVE | {"speed": "60 deg/s"}
LOADS = {
    "ball_screw": {"mass": "30 kg", "lead": "10 mm", "efficiency": 0.9, "incline": "20 deg", "inertia": "0.5 kg*cm^2",
                   "friction_coefficient": 0.01, "force": "80 N", "preload_torque": "0.05 N*m"},
    "belt_axis": {"mass": "6 kg", "pulley_diameter": "38 mm", "belt_mass": "0.3 kg", "idler_inertia": "0.2 kg*cm^2",
                  "friction_torque": "0.02 N*m", "motors": 2},
    "conveyor": {"mass": "12 kg", "belt_mass": "1.5 kg", "drum_diameter": "60 mm", "friction_coefficient": 0.25,
                 "incline": "-8 deg"},
    "hoist": {"mass": "15 kg", "counterweight": "4 kg", "drum_diameter": "50 mm", "falls": 2, "rope_efficiency": 0.94},
    "arm": {"mass": "2.5 kg", "length": "300 mm", "start_angle": "-60 deg", "tilt": "20 deg"},
    "rotary_table": {"inertia": "0.12 kg*m^2", "friction_torque": "0.4 N*m", "torque": "0.1 N*m"},
    "fan": {"inertia": "30 kg*cm^2", "rated_torque": "0.25 N*m", "rated_speed": "1800 rpm",
            "friction_torque": "0.01 N*m"},
    "wheeled_vehicle": {"mass": "30 kg", "driven_wheels": 2, "wheel_diameter": "200 mm", "rolling_resistance": 0.015,
                        "inertia": "40 kg*cm^2", "slope": "3 %"},
}  # fmt: skip


@pytest.mark.parametrize("kind", LOADS)
def test_the_formulas_give_what_the_checks_have(kind, catalog):
    motion = TURN if kind in ("arm", "rotary_table", "fan") else MOVE
    stages = [{"kind": "gearhead"}, {"kind": "belt", "ratios": [2], "efficiency": "95 %"}]
    load = {"kind": kind, **LOADS[kind]}
    spec = load_spec({"name": "x", "load": load, "motion": motion, "supply": SUPPLY, "transmission": stages})
    result = size(spec, catalog=catalog, top=1)
    blocks = list(with_numbers(Content(result)))
    steps = {b.step["exact"]["name"]: b.step["exact"]["value"] for b in blocks if isinstance(b, Equation)}
    assert not [b for b in blocks[1:] if isinstance(b, Words)]  # the load's own formula holds
    drive, requirements = result.sets[0], {r.name: r.value for r in result.requirements}
    checks = {check.name: check.demand for check in drive.own_checks}
    assert abs(steps["shaft_torque"]) <= requirements["maximum_torque_per_motor"] * (1 + 1e-9)
    assert abs(steps["motor_current"]) == pytest.approx(checks["controller_peak_current"])
    assert steps["motor_rms_current"] == pytest.approx(checks["motor_nominal_current"])
    assert steps["motor_speed"] == pytest.approx(checks["motor_speed"])
