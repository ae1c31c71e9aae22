"""``drivesizer catalog``: what each command shows, its exit status, and that parts survive export and import."""

from __future__ import annotations

import csv
import json
import re
from functools import cache, partial
from pathlib import Path

import numpy as np
import openpyxl
import pytest
from catalog_texts import MAP, SHEET
from printed import text_of

from drivesizer.catalog import PARTS, columns_of, load, query, shipped
from drivesizer.catalog.query import find, open_catalogs, select, side_by_side, where

SMALL = Path(__file__).with_name("small.yaml").read_text(encoding="utf-8")


@pytest.fixture
def small(tmp_path: Path) -> Path:
    path = tmp_path / "small.yaml"
    path.write_text(SMALL, encoding="utf-8")
    return path


@pytest.fixture
def run(run, monkeypatch, tmp_path):
    """Run a catalogue command in an empty folder; its status, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    return partial(run, "catalog")


SHIPPED = shipped()
KEPT = cache(lambda name: load([name]))


@pytest.fixture(autouse=True)
def _shipped_are_opened_once(monkeypatch):
    """A hundred files per command otherwise; those of a test are read each time."""
    monkeypatch.setattr(query, "load", lambda names: KEPT(*names) if names[0] in SHIPPED else load(names))


def words(text: str) -> str:
    return " ".join(text.split())


def refused(run, said: str, *args) -> None:
    """A wrong input is one line on stderr and status 2, and no file comes or goes."""
    before = sorted(Path().iterdir())
    status, out, err = run(*args)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert said in err
    assert sorted(Path().iterdir()) == before


def parts_of(out: str) -> list[str]:
    return [part["part"] for part in json.loads(out, parse_constant=pytest.fail)["parts"]]


# --- list ------------------------------------------------------------------------------------------------------------


def test_without_conditions_the_families_are_listed(run, small):
    status, out, err = run("list", "--catalog", small)
    assert (status, err) == (0, "")
    assert "4 parts in 1 family" in words(out)
    assert "M 20 (4)" in out
    assert "C 1 (2)" in out


@pytest.mark.parametrize(
    ("args", "parts"),
    [
        (["motors"], ["M1", "M2", "007"]),
        (["motors", "--excluded"], ["M1", "M2", "007", "M4"]),
        (["motors", "--voltage", "24 V"], ["M1", "007"]),
        (["motors", "--voltage", "24000 mV"], ["M1", "007"]),
        (["motors", "--voltage", "<24 V"], ["M2"]),
        (["motors", "--power", ">=20 W"], ["M1", "007"]),
        (["motors", "--power", ">20W"], ["007"]),
        (["motors", "--diameter", "<=20 mm", "--voltage", "!=24 V"], ["M2"]),
        (["motors", "--diameter", "<=0.79 in"], ["M1", "M2", "007"]),
        (["motors", "--kind", "BRUSHED", "--sort", "-no load speed"], ["M1", "M2", "007"]),
        (["motors", "--sort", "-nominal_torque"], ["M2", "M1", "007"]),
        (["motors", "--sort", "nominal_torque"], ["M1", "M2", "007"]),
        (["motors", "--where", "ambient_min<=-30 degC", "--where", "mass = 54 g"], ["M1"]),
        (["motors", "--where", "bearing==*BALL"], ["M1"]),
        (["motors", "--where", "bearing!=x*"], ["M1"]),
        (["gearheads", "--family", "g*", "--where", "ratio<10"], ["G5"]),
        (["controllers", "--voltage", "48 V"], ["C50"]),
        (["controllers", "--voltage", "24 V", "--kind", "brushless"], ["C50", "C24"]),
        (["controllers", "--voltage", ">24 V"], ["C50"]),
        (["controllers", "--voltage", "<10 V"], ["C24"]),
        (["controllers", "--kind", "brushed"], ["C50"]),
        (["--power", ">=30 W"], ["007", "G27"]),
        (["--where", "counts_per_turn>=500"], ["E500"]),
    ],
    ids=" ".join,
)
def test_conditions(run, small, args, parts):
    status, out, _ = run("list", *args, "--catalog", small, "--json")
    assert status == 0
    assert parts_of(out) == parts


def test_an_unknown_figure_meets_nothing_and_is_counted(run, small):
    status, out, _ = run("list", "motors", "--power", ">=1 W", "--catalog", small)
    assert status == 0
    assert "M2" not in out
    assert "1 more may fit: a required figure is unknown" in words(out)
    assert "1 more are excluded from sizing" in words(out)
    document = json.loads(run("list", "motors", "--power", ">=1 W", "--catalog", small, "--json")[1])
    assert (document["found"], document["undecided"]) == (2, 1)
    assert document["parts"][1]["mass"] is None
    assert document["units"]["motors"]["mass"] == "kg"
    assert document["parts"][0]["mass"] == pytest.approx(0.054)
    unknown = select(open_catalogs([str(small)]), "motors", [where("motors", "assigned_power!=3 W")])
    assert [hit.part for hit in unknown.hits] == ["M1", "007"]


def test_nothing_found_is_status_1(run, small):
    status, out, err = run("list", "motors", "--voltage", "48 V", "--catalog", small)
    assert (status, out.strip(), err) == (1, "0 motors", "")
    status, out, _ = run("list", "motors", "--voltage", "48 V", "--catalog", small, "--json")
    assert (status, parts_of(out)) == (1, [])
    status, _, _ = run("list", "motors", "--voltage", "48 V", "--catalog", small, "--csv", "none.csv")
    assert status == 1
    assert not Path("none.csv").exists()


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (["list", "motor"], "expected motors"),
        (["list", "motors", "--voltage", "24"], "e.g. 24 V"),
        (["list", "motors", "--voltage", ">="], "voltage"),
        (["list", "motors", "--voltage", "24 mm"], "a unit of length, not of voltage"),
        (["list", "motors", "--diameter", "26,5 mm"], "decimal point"),
        (["list", "motors", "--where", "max_sped>=1 rpm"], "max_speed"),
        (["list", "motors", "--where", "max_speed"], "max_speed>=8000 rpm"),
        (["list", "motors", "--where", "kind>=brushed"], "kind is text"),
        (["list", "motors", "--sort", "weight"], '--sort: motors have no column "weight"; expected e.g. mass'),
        (["list", "encoders", "--power", ">1 W"], "--power: encoders has no such figure"),
        (["list", "motors", "--limit", "0"], "--limit"),
        (["list", "--catalog", "qqqqq"], 'no catalogue is called "qqqqq"; expected'),
        (["list", "--catalog", "nix.yaml"], "cannot be read"),
        (["list", "--sort", "mass", "--csv", "all.csv"], "one section"),
        (["show", "11875"], "the nearest"),
        (["show", "M 20", "--catalog", "SMALL"], "a family of motors"),
        (["compare", "M1", "--catalog", "SMALL"], "two or more"),
        (["compare", "M1", "G27", "--catalog", "SMALL"], "parts of one kind"),
        (["compare", "M1", "nix", "--catalog", "SMALL"], "in no catalogue"),
        (["export", "-o", "parts.csv"], "one section"),
        (["export", "motors", "-o", "parts.xlsx"], ".csv or .json"),
        (["export", "motors", "-o", "no/such/parts.csv"], "no folder"),
        (["export", "motor", "-o", "parts.csv"], "expected motors"),
        (["export"], "--output"),
        (["searhc", "x"], "searhc"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_a_wrong_input_is_one_line(run, small, args, said):
    refused(run, said, *(small if arg == "SMALL" else arg for arg in args))


def test_two_catalogues_of_one_name_are_refused(run, small, tmp_path):
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "small.yaml").write_text(SMALL)
    status, _, err = run("list", "--catalog", small, "--catalog", "other/small.yaml")
    assert status == 2
    assert "two catalogues are called" in err


# --- one part, several parts, a text ---------------------------------------------------------------------------------


def test_a_parts_page(run, small):
    status, out, err = run("show", "M1", "--catalog", small)
    assert (status, err) == (0, "")
    said = words(out)
    assert "Anymaker M 20" in said
    assert "M1 · motor in small" in said
    assert "nominal torque 26.3 mN·m" in said
    assert "price 99.50 EUR" in said
    assert "mass 54 g recalled" in said
    assert "no load 9560 rpm 0 unknown nominal unknown 26.3 mN·m unknown stall 0 243 mN·m unknown" in said
    assert "gearheads: 1 in 1 family: G 26 (1)" in said
    assert "encoders: 1 in 1 family: E 1 (1)" in said
    assert "note: mass: weighed; recalled" in said
    assert "source: data sheet, page 3, 2024-05 (quoted)" in said
    assert "shaft diameter" not in said  # unknown: not on the page


def test_where_each_figure_is_from(run, small):
    _, out, _ = run("show", "M1", "--source", "--catalog", small)
    said = words(out)
    assert "nominal torque 26.3 mN·m quoted [1]" in said
    assert "mass 54 g recalled [2]" in said
    assert "[1] data sheet, page 3, 2024-05, https://example.org" in said
    assert "[2] a forum" in said
    document = json.loads(run("show", "M1", "--catalog", small, "--json")[1])
    (part,) = document["parts"]
    assert part["sources"]["mass"] == {"document": "a forum", "confidence": "recalled", "date": "", "url": ""}
    assert part["goes_with"] == {"gearheads": {"G 26": 1}, "encoders": {"E 1": 1}}
    assert part["shaft_diameter"] is None
    assert "shaft_diameter" not in part["sources"]


def test_parts_side_by_side(run, small):
    status, out, _ = run("compare", "M1", "M2", "--catalog", small)
    assert status == 0
    lines = {words(line) for line in out.splitlines()}
    assert "≠ nominal voltage 24 V 12 V" in lines
    assert "diameter 20 mm 20 mm" in lines
    assert "? assigned power 20 W unknown" in lines
    _, out, _ = run("compare", "M1", "M2", "--differing", "--catalog", small)
    assert "diameter" not in out
    document = json.loads(run("compare", "M1", "M2", "--catalog", small, "--json")[1])
    assert document["differs"]["nominal_voltage"] is True
    assert document["differs"]["diameter"] is False
    assert document["differs"]["assigned_power"] is None
    hits = find(open_catalogs([str(small)]), "M1") + find(open_catalogs([str(small)]), "007")
    assert next(row for row in side_by_side(hits) if row.column.name == "mass").differs is None


def every_medium(run, *args) -> tuple[str, dict[str, list]]:
    """The words of terminal, PDF and page as one text; the rows of the workbook by their names."""
    status, out, err = run(*args, *(word for kind in ("pdf", "html", "xlsx") for word in ("--report", f"r.{kind}")))
    assert status == 0 and err.count("written") == 3
    book = openpyxl.load_workbook("r.xlsx")
    rows = {str(row[1] if row[0] in (None, "≠", "?") else row[0]): row
            for page in book for row in page.iter_rows(values_only=True)}  # fmt: skip
    page = re.sub(r"<[^>]+>", " ", Path("r.html").read_text(encoding="utf-8").partition("<script")[0])
    return " ".join(map(words, (out, text_of(Path("r.pdf").read_bytes()), page))), rows


def test_a_document_says_the_same_in_every_medium(run, small):
    said, rows = every_medium(run, "compare", "M1", "M2", "--catalog", small)
    assert said.count("no load speed 9560 rpm") == said.count("28.6 mN·m") == said.count("differs (") == 3
    assert rows["nominal torque"][2:4] == (26.3, "mN·m") and rows["assigned power"][4] in ("", None, "unknown")
    said, rows = every_medium(run, "show", "M1", "--catalog", small)
    assert said.count("nominal torque 26.3 mN·m") == 3 and said.count("G 26 (1)") == 3 and "Speed over torque" in said
    said, rows = every_medium(run, "list", "motors", "--catalog", small, "--voltage", "24 V")
    assert said.count("M1") == 3 and rows["M1"][1:3] == ("M 20", 20)
    assert every_medium(run, "stats", "--catalog", small)[0].count("motors: figures known") >= 2
    refused(run, 'r.csv" does not say which kind of report; expected .pdf, .html or .xlsx',
            "compare", "M1", "M2", "--catalog", small, "--report", "r.csv")  # fmt: skip


def test_search(run, small):
    status, out, _ = run("search", "g2", "--catalog", small)
    assert status == 0
    assert "G27" in out
    status, out, _ = run("search", "BRUSHLESS", "--catalog", small)
    assert (status, "C 1" in out) == (0, True)
    document = json.loads(run("search", "m 2", "--catalog", small, "--json")[1])
    assert document["families"]["motors"] == {"M 20": 4}
    status, out, err = run("search", "RE 52")
    assert (status, out, err.count("\n")) == (1, "", 1)
    assert "RE 25" in err
    assert run("search", "zzz", "--catalog", small, "--json")[0] == 1


# --- how complete, how right -----------------------------------------------------------------------------------------


FAST = """\
catalog: 1
manufacturer: Anymaker
sources: {sheet: {document: a sheet, confidence: quoted}}
motors:
- family: M 20
  source: sheet
  columns: [part, nominal_speed (rpm), max_speed (rpm)]
  rows: [[FAST, 9999, 9000], [KNOWN, 9998, 9000], [SLOW, 8000, 9000], [OPEN, ~, 9000]]
  notes: [{parts: [KNOWN], fields: [nominal_speed], text: as printed, accepted: true}]
"""


def test_check_lists_unexplained_findings(run, tmp_path):
    (tmp_path / "fast.yaml").write_text(FAST)
    status, out, _ = run("check", "--catalog", "fast.yaml")
    said = words(out)
    assert status == 1
    assert "fast, motors: " in said
    assert "FAST M 20 9999 rpm <= 9000 rpm 11.1 % 0.0 %" in said
    assert "KNOWN" not in said
    assert "1 unexplained, 1 accepted" in said
    _, out, _ = run("check", "--catalog", "fast.yaml", "--all")
    assert "accepted: as printed" in words(out)
    assert "KNOWN M 20 9998 rpm" in words(out)
    (found,) = json.loads(run("check", "--catalog", "fast.yaml", "--json")[1])["findings"]
    assert (found["part"], found["unexplained"], found["accepted"]) == ("FAST", True, None)
    assert found["found"] == pytest.approx(9999 * np.pi / 30)
    everything = json.loads(run("check", "--catalog", "fast.yaml", "--json", "--all")[1])["findings"]
    assert {"FAST", "KNOWN"} <= {one["part"] for one in everything}
    (tmp_path / "fast.yaml").write_text(FAST.replace("9999", "8999"))
    status, out, _ = run("check", "--catalog", "fast.yaml")
    assert status == 0
    assert "0 unexplained" in out


def test_text_is_not_taken_for_markup(run, tmp_path):
    (tmp_path / "odd.yaml").write_text(FAST.replace("[[FAST", '[["[red]A"').replace("M 20", '"[b]M"'))
    for args in (
        ["list"],
        ["list", "motors"],
        ["show", "[red]A"],
        ["compare", "[red]A", "SLOW"],
        ["check"],
        ["search", "[red]"],
    ):
        status, out, _ = run(*args, "--catalog", "odd.yaml")
        assert status in (0, 1)
        assert ("[b]M" if args == ["list"] else "[red]A") in out


# --- out and in ------------------------------------------------------------------------------------------------------


def same(one, other, section: str) -> None:
    """Two tables have the same parts with the same figures, unknown ones included."""
    for name in columns_of(section):
        rows = [other.rows[part] for part in one["part"]]
        np.testing.assert_array_equal(one[name], other[name][rows], err_msg=name)


FULL = dict.fromkeys(PARTS, "maxon") | {
    "actuators": "robotis", "steppers": "beckhoff", "belts": "andymark", "pulleys": "andymark", "batteries": "samsung",
    "screws": "rexroth", "power_supplies": "mean_well", "brake_resistors": "omron",
}  # fmt: skip


@pytest.mark.parametrize(("section", "name"), FULL.items())
def test_what_is_exported_and_imported_is_the_same(run, section, name):
    catalog = load([name])
    assert len(catalog.table(section)) > 3
    status, out, _ = run("export", section, "--catalog", name, "-o", "parts.csv")
    assert (status, out) == (0, f"parts.csv: {len(catalog.table(section)):,} parts\n")
    given = ("--document", "the export", "--confidence", "secondary")
    status, out, err = run("import", "parts.csv", "--section", section, "-o", "mine.yaml", *given)
    assert (status, err) == (0, "")
    assert "left out: catalog; document; confidence; excluded" in words(out)
    again = load(["mine.yaml"])
    same(catalog.table(section), again.table(section), section)
    assert again.sources[0].confidence == "secondary"
    assert again.sources[0].document == "the export"


def test_the_csv_has_units_and_empty_cells(run, small):
    run("export", "motors", "--catalog", small, "-o", "motors.csv")
    header, units, *rows = list(csv.reader(Path("motors.csv").read_text(encoding="utf-8").splitlines()))
    first, second = (dict(zip(header, row, strict=True)) for row in rows[:2])
    assert dict(zip(header, units, strict=True))["nominal_torque"] == "mN*m"
    assert (first["nominal_torque"], first["ambient_min"], first["price"]) == ("26.3", "-30", "99.5")
    assert (second["assigned_power"], second["ambient_min"], second["price"]) == ("", "", "1000")
    assert first["bearing"] == "'=ball"
    assert (first["catalog"], first["confidence"], rows[3][header.index("excluded")]) == ("small", "quoted", "true")


def test_the_formula_comes_back_as_it_was(run, small):
    run("list", "motors", "--catalog", small, "--csv", "motors.csv")
    given = ("--document", "x", "--confidence", "recalled")
    assert run("import", "motors.csv", "--section", "motors", "-o", "mine.yaml", *given)[0] == 0
    again = load(["mine.yaml"]).motors
    assert again["bearing"][again.rows["M1"]] == "=ball"
    assert "007" in again.rows
    assert "M4" not in again.rows


def test_export_to_json(run, small):
    assert run("export", "--catalog", small, "-o", "parts.json")[0] == 0
    document = json.loads(Path("parts.json").read_text(encoding="utf-8"), parse_constant=pytest.fail)
    assert document["schema"] == 2
    assert list(document["catalogs"]) == ["small"]
    assert [part["part"] for part in document["parts"]] == ["M1", "M2", "007", "M4", "G27", "G5", "E500", "C50", "C24"]
    assert document["parts"][4]["ratio"] == pytest.approx(3249 / 121)
    assert document["parts"][3]["excluded"] is True


# --- import ----------------------------------------------------------------------------------------------------------


@pytest.fixture
def sheet(tmp_path: Path) -> Path:
    (tmp_path / "sheet.csv").write_text(SHEET, encoding="utf-8")
    (tmp_path / "map.yaml").write_text(MAP, encoding="utf-8")
    return tmp_path


ARGS = ("import", "sheet.csv", "--section", "motors", "--map", "map.yaml")


def test_another_programs_table(run, sheet):
    status, out, err = run(*ARGS, "-o", "other.yaml")
    assert (status, err) == (0, "")
    said = words(out)
    assert "3 motors in 2 families: X 10 (2), Y: 2 (1)" in said
    assert "Order no. part" in said
    assert "left out: Remark; Colour" in said
    assert "other.yaml written" in said
    motors = load(["other.yaml"]).motors
    assert list(motors.rows) == ["A1", "A2", "A:3"]
    assert motors["nominal_torque"][0] == pytest.approx(3.72 * 0.3048 / 12 * 0.45359237 / 16 * 9.80665, rel=1e-12)
    assert motors["no_load_speed"][0] == pytest.approx(9560 * np.pi / 30)
    assert np.isnan(motors["no_load_speed"][1:]).all()  # unknown stays unknown
    assert np.isnan(motors["mass"][1])
    assert set(motors["diameter"]) == {0.01}
    assert set(motors["manufacturer"]) == {"Other & Sons"}
    source = load(["other.yaml"]).sources[0]
    assert source == ("price list: 2024", "secondary", "2024-05", "https://example.org/a#b")
    assert "3.72" in Path("other.yaml").read_text(encoding="utf-8")  # as printed
    assert run("show", "A1", "--catalog", "other.yaml")[0] == 0


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("A1,X 10,24", "A1,X 10,24 m", "sheet.csv:3: Nominal voltage"),
        ("A1,X 10,24", 'A1,X 10,"24,5"', 'decimals have "." here'),
        ("A1,X 10,24", "A1,X 10,abc", "does not start with a number"),
        ("A1,X 10,24", "A1,X 10,-24", "below 0"),
        ("A1,X 10,24", "A1,X 10,1e999", "outside the range"),
        ("A1,X 10,24", "A2,X 10,24", "is in line 3 too"),
        ("A1,X 10,24", "A1,,24", "sheet.csv:3: family: unknown"),
        ("A1,X 10,24,9560", "A1,X 10,24", "7 cells; the header has 8"),
        (",,V,", ",,mm,", "a unit of length, not of voltage"),
        (",,V,", ",,,", "without a unit; write e.g. [V]"),
        (",,V,", "x,,V,", "without a unit"),
        ("Weight", "Wheight", "the nearest is Wheight"),
        ("Colour", "nominal_voltage", "are both nominal_voltage"),
        ("Colour", "diameter", "in common too"),
        ("A1,", '"A1,', "row"),
    ],
)
def test_a_wrong_table_is_one_line_and_writes_nothing(run, sheet, old, new, said):
    (sheet / "sheet.csv").write_text(SHEET.replace(old, new, 1))
    refused(run, said, *ARGS, "-o", "other.yaml")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("columns:", "colums:", "unknown key"),
        ("Weight: mass", "Weight: mas", "the nearest"),
        ("confidence: secondary", "confidence: certain", "expected one of measured"),
        ('document: "price list: 2024", ', "", "--document"),
        ("manufacturer: Other & Sons\n", "", "--manufacturer"),
        ('["-"]', "none", "expected a list"),
        ("kind: brushed", "colour: red", "have in common"),
        ("diameter: 10 mm", "diameter: 10 V", "nothing was written"),
        ("Order no.: part", "Order no.: ~", "part number"),
    ],
)
def test_a_wrong_map_is_one_line_and_writes_nothing(run, sheet, old, new, said):
    assert old in MAP
    (sheet / "map.yaml").write_text(MAP.replace(old, new, 1))
    refused(run, said, *ARGS, "-o", "other.yaml")


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (
            ("import", "no.csv", "--section", "motors", "-o", "o.yaml", "--document", "x", "--confidence", "quoted"),
            "read",
        ),
        ((*ARGS,), "--output"),
        ((*ARGS, "-o", "o.csv"), "expected .yaml"),
        ((*ARGS, "-o", "no/such/o.yaml"), "no folder"),
        (("import", "sheet.csv", "--section", "motor", "-o", "o.yaml"), "--section"),
        ((*ARGS[:-1], "no.yaml", "-o", "o.yaml"), "no.yaml: cannot be read"),
    ],
)
def test_a_wrong_import_is_one_line(run, sheet, args, said):
    refused(run, said, *args)


def test_hostile_cells_stay_text(run, tmp_path):
    cells = ['x"], [y', "a\\b", "null", "1e5", "0x10", "é ü 漢", "a #b", "- a", "{a: b}", "*a", "tab\there",
             "line\nbreak"]  # fmt: skip
    with (tmp_path / "t.csv").open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerows([["part", "bearing"], ["", ""], *([f"P{n}", cell] for n, cell in enumerate(cells))])
    given = ("--manufacturer", "true", "--family", "~x: [", "--document", "d", "--confidence", "quoted")
    assert run("import", "t.csv", "--section", "motors", "-o", "t.yaml", *given)[0] == 0
    motors = load(["t.yaml"]).motors
    assert motors["bearing"].tolist() == cells
    assert set(motors["manufacturer"]) == {"true"}
    assert set(motors["family"]) == {"~x: ["}
