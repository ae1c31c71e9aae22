"""The workbook: numbers that a spreadsheet can reckon with, no text that it would, and what it cannot hold minded."""

import csv
import io
import os
import re
import subprocess
import sys
import zipfile
from dataclasses import replace
from datetime import datetime
from math import inf, nan

import numpy as np
import openpyxl
import pytest
from specs import HEAT, without
from synthetic_validation import synthetic_validation

from drivesizer.catalog import Catalog
from drivesizer.files.yaml_source import YamlSource
from drivesizer.output.report import csv as csv_tables
from drivesizer.output.report import workbook, write
from drivesizer.output.report import workbook as writer
from drivesizer.output.report.sections import candidates
from drivesizer.output.report.sections import cycle as loop_section
from drivesizer.output.report.sections.section import Content, Sheet, SheetColumn
from drivesizer.output.report.workbook import shown, written
from drivesizer.results.sizing import SizingResult
from drivesizer.sizing import size
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import registry, show

REQUIRED, SPEEDS = "Requirements on the machine", "Speed by direction"
NAMES = ["Summary", REQUIRED, "Parts list", "Checks", "Machine", SPEEDS, "Battery", "Regenerated energy",
         "Closed loop", "Time series", "Candidates", "Requirements", "Pieces", "Platform", "Spec", "Selected drive",
         "About"]  # fmt: skip
FORMULAS = ("=1+1", "+1", "-1+1", "@SUM(A1)", '=HYPERLINK("http://x")', "http://example.org/a", "{=1}", "\t=1", "＝1")


@pytest.fixture(scope="module")
def result(spec: RobotSpec, catalog: Catalog) -> SizingResult:
    """Of a motor whose heat is unknown."""
    return size(spec, catalog=without(catalog, "motor", "118752", *HEAT), top=4)


@pytest.fixture(scope="module")
def content(result) -> bytes:
    return written(workbook.sheets(Content(result, loop(result))))


@pytest.fixture(scope="module")
def book(content):
    return openpyxl.load_workbook(io.BytesIO(content))


def loop(result, step=0.5):
    return synthetic_validation(result, step=step)


def rows_of(page) -> list[dict]:
    heads, *rows = page.iter_rows(values_only=True)
    return [dict(zip(heads, row, strict=True)) for row in rows]


def opened(sheets):
    return openpyxl.load_workbook(io.BytesIO(written(sheets)))


def cells(book):
    return [cell for page in book for row in page.iter_rows() for cell in row if cell.value is not None]


def test_the_sheets_in_their_order_with_head_filter_and_widths(book):
    assert book.sheetnames == NAMES
    for page in book:
        assert page.freeze_panes and page.freeze_panes.endswith("2"), page.title  # the head stays
        filtered = page.title not in ("Summary", REQUIRED, SPEEDS, "Time series", "Spec", "About")
        assert bool(page.auto_filter.ref) == filtered, page.title
        widths = [d.width for d in page.column_dimensions.values()]
        assert widths and all(8 <= width <= 120 for width in widths), page.title
        if filtered:
            assert re.fullmatch(rf"A1:[A-Z]+{max(page.max_row, 2)}", page.auto_filter.ref), page.title


def test_the_same_input_gives_the_same_bytes_and_no_date(result, content, tmp_path):
    (path,) = write(result, loop(result), [tmp_path / "report.xlsx"])
    assert path.read_bytes() == content
    with zipfile.ZipFile(path) as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        told = archive.read("docProps/core.xml").decode()
    assert set(re.findall(r"\d{4}-\d\d-\d\dT[\d:]+Z", told)) == {"2000-01-01T00:00:00Z"}
    assert str(datetime.now().year) not in told


def test_another_process_on_another_clock_writes_the_same_bytes(example, tmp_path):
    code = (
        "import sys; from pathlib import Path; from drivesizer import load_spec, size; "
        "from drivesizer.output.report import write; "
        "write(size(load_spec(sys.argv[1]), top=2), None, [Path(sys.argv[2])])"
    )
    for name, zone, seed in (("a", "UTC", "1"), ("b", "Asia/Tokyo", "2")):
        environment = os.environ | {"TZ": zone, "PYTHONHASHSEED": seed}
        subprocess.run(
            [sys.executable, "-c", code, str(example), str(tmp_path / f"{name}.xlsx")], check=True, env=environment
        )
    assert (tmp_path / "a.xlsx").read_bytes() == (tmp_path / "b.xlsx").read_bytes()


def test_numbers_are_numbers_beside_their_units(book):
    for name in ("Requirements", "Checks", "Closed loop", "Selected drive"):
        for row in rows_of(book[name]):
            for head in ("SI value", "SI limit", "margin (%)", "at (s)"):
                assert not isinstance(row.get(head), str), (name, row)
    for row in rows_of(book["Candidates"]):
        for head in ("drive", "mass (g)", "price (EUR)", "total ratio"):
            assert isinstance(row[head], int | float)
    for row in rows_of(book["Time series"]):
        assert all(isinstance(value, int | float) for value in row.values())


def test_si_stands_beside_the_unit_of_the_trade_and_is_the_same(book):
    """Held against pint, unit by unit as it is printed."""
    ureg, checked = registry(), set()
    spelled = {"°C": "degC", "°": "deg", "Ω": "ohm", "²": "^2", "³": "^3", "·": "*", "µ": "u", "%": "percent"}
    for name in ("Requirements", "Checks", "Closed loop", "Selected drive"):
        for row in rows_of(book[name]):
            value = row.get("value", row.get("value or demand"))
            if isinstance(row["SI value"], int | float) and row["SI unit"] and isinstance(value, int | float):
                unit, si = row["unit"], row["SI unit"]
                for mark, word in spelled.items():
                    unit, si = unit.replace(mark, word), si.replace(mark, word)
                if unit not in ("EUR", "CHF"):
                    assert ureg.Quantity(value, unit).to(si).magnitude == pytest.approx(row["SI value"], rel=1e-12), row
                    checked.add(unit)
    assert {"rpm", "mN*m", "g*cm^2", "degC", "kHz", "m/s"} <= checked


def test_unknown_is_an_empty_cell_and_a_word_in_the_status(book, result):
    rows = [r for r in rows_of(book["Checks"]) if r["status"] == "unknown"]
    assert rows and all(r["margin (%)"] is None for r in rows)
    limits = {r["check"]: r["limit"] for r in rows if r["limit"] is not None}
    assert limits == {
        "Motor voltage, cold and hot": pytest.approx(18.9)
    }  # 0.9 · (22 V - 1 V); its demand is a least one
    words = [cell for cell in cells(book) if cell.value == "unknown"]
    heads = {book[c.parent.title].cell(1, c.column).value for c in words}
    assert heads <= {"status", "About this file"}
    line = next(r for r in rows_of(book["Parts list"]) if r["role"] == "motor")
    assert line["price of one"] is line["price of all"] is line["currency"] is line["price date"] is None


def test_a_status_is_a_word_and_a_colour(book):
    looks = {}
    for page in (book["Checks"], book["Candidates"], book["Closed loop"]):
        for row in page.iter_rows():
            for cell in row:
                if cell.value in ("pass", "fail", "unknown"):
                    looks.setdefault(cell.value, set()).add((cell.fill.fgColor.rgb, cell.font.color.rgb))
    assert set(looks) == {"pass", "fail", "unknown"}
    assert all(len(look) == 1 for look in looks.values())
    assert len(set.union(*looks.values())) == 3


def test_a_cell_without_a_value_is_no_cell(content):
    """A spreadsheet counts an empty text as a value."""
    page = openpyxl.load_workbook(io.BytesIO(content))
    assert not [cell for sheet in page for row in sheet.iter_rows() for cell in row if cell.value == ""]


def test_the_summary_names_set_and_parts_once(book, result):
    told = {row[0]: row[4] for row in book["Summary"].iter_rows(values_only=True)}
    assert told["Motor"] == "maxon RE 25 118752: 20 W, 24 V"
    assert told["Verdict"] == f"a drive was found: {result.sets[0].label}"
    table = result.catalog.controllers
    named = table.record(table.rows["EPOS4 Module 60/20"])  # a part that is called as its family
    page = opened(workbook.sheets(Content(replace(result, sets=(replace(result.sets[0], controller=named),)))))[
        "Summary"
    ]
    told = {row[0]: row[4] for row in page.iter_rows(values_only=True)}
    assert told["Controller"].startswith("maxon EPOS4 Module 60/20: ")


def test_margins_are_percent_numbers(book, result):
    page = book["Checks"]
    heads = {cell.value: cell.column for cell in page[1]}
    margins = [row[heads["margin (%)"] - 1] for row in page.iter_rows(min_row=2)]
    known = [cell for cell in margins if cell.value is not None]
    assert known and all("%" in cell.number_format for cell in known)
    sets = (*result.sets, *result.misses)
    expected = [c.margin for s in sets for c in s.every_check]
    assert [cell.value for cell in margins] == [pytest.approx(m, rel=1e-15) if m == m else None for m in expected]
    assert any(cell.value < 0 for cell in known)


@pytest.mark.parametrize("value", [26.304, 5.0, 0.0, -0.07375, 208.8654, 6169.2, 0.002843, 1.0, 999.96, -2.855, 0.4175])
def test_a_figure_is_shown_with_the_digits_that_are_printed_elsewhere(value):
    decimals = len(shown(value).partition(".")[2])
    assert float(f"{value:.{decimals}f}") == float(show(value, "N", "force").removesuffix(" N"))


def test_very_small_and_large_figures_are_shown_with_an_exponent():
    assert shown(1.278e-6) == shown(-2.5e9) == "0.000E+00"
    assert shown(12345.6) == "0" and shown(9999.96) == "0"


def test_what_has_no_end_is_a_word(result):
    figures = Sheet(
        name="A", columns=(SheetColumn("value", "value"),), rows=[{"value": x} for x in (inf, -inf, nan, None, 2)]
    )
    values = [row[0] for row in opened([figures])["A"].iter_rows(min_row=2, values_only=True)]
    assert values == ["unbounded", "unbounded below", None, None, 2]


@pytest.mark.parametrize("text", FORMULAS)
def test_no_text_is_computed_or_made_a_link(text, result):
    best = result.sets[0]
    named = replace(
        result,
        problem=replace(result.problem, machine=result.spec.model_copy(update={"name": text})),
        warnings=(text,),
        sets=(replace(best, checks=(replace(best.checks[0], note=text, case=text), *best.checks[1:])),),
    )
    content = written(workbook.sheets(Content(named, replace(loop(result), profile=text, warnings=(text,)))))
    book = openpyxl.load_workbook(io.BytesIO(content))
    assert sum(cell.value == text for cell in cells(book)) >= 4
    assert {cell.data_type for cell in cells(book)} <= {"s", "n"}
    assert not any(page._hyperlinks for page in book)
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        pages = [archive.read(name) for name in archive.namelist() if name.startswith("xl/worksheets/")]
        assert not any(b"<f>" in page or b"<hyperlink" in page for page in pages)


def test_what_a_cell_cannot_hold_is_spelled_out_or_cut(result):
    hostile = "a\x00b\x1b[31m\ud800c\ufffed\u202e 測試 робот 😀 _x0041_ <&>\"'"
    rows = [{"text": hostile}, {"text": "x" * 40_000}, {"text": "line\r\nline"}]
    page = opened([Sheet(name="A", columns=(SheetColumn("text", "text"),), rows=rows)])["A"]
    first, second, third = (row[0] for row in page.iter_rows(min_row=2, values_only=True))
    assert "\\x00" in first and "\\x1b[31m" in first and "\\ud800" in first and "\\u202e" in first
    assert "測試 робот 😀" in first and first.endswith("<&>\"'")
    assert len(second) == 32767 and second.endswith("…")
    assert third == "line\nline"


def test_hostile_names_of_a_spec_come_through(result, tmp_path):
    machine = result.spec.model_copy(update={"name": '測試 \x00 &P &"Arial" ' + "n" * 300})
    named = replace(result, problem=replace(result.problem, machine=machine))
    named.spec._source = YamlSource(result.spec.text, "folder/=\udcff\x01.yaml")  # a name that is no text
    (path,) = write(named, replace(loop(result), profile="\udcff.csv"), [tmp_path / "report.xlsx"])
    assert any("測試" in str(cell.value) for cell in cells(openpyxl.load_workbook(path)))


def test_more_rows_than_a_sheet_has_are_left_out_and_that_is_told(monkeypatch):
    monkeypatch.setattr(writer, "MOST_ROWS", 10)
    rows = [{"n": n} for n in range(25)]
    page = opened([Sheet(name="A", columns=(SheetColumn("n", "n"),), rows=rows)])["A"]
    assert page.max_row == 11 and page["A11"].value == 9
    assert page["B1"].value == "the first 10 of 25 rows"
    assert 1 + writer.MOST_ROWS <= 1_048_576


def test_the_row_limit_is_that_of_the_format():
    from openpyxl.utils import get_column_letter
    from xlsxwriter.worksheet import Worksheet

    assert Worksheet().xls_rowmax == 1 + writer.MOST_ROWS == 1_048_576
    assert get_column_letter(len(candidates._COLUMNS)) < "Z"


def test_a_long_record_is_thinned_with_its_peaks_and_a_note(result, monkeypatch):
    proof = loop(result, 0.01)
    peaks = {name: (values.min(), values.max()) for name, values in proof.series.items()}
    monkeypatch.setattr(loop_section, "MOST_SAMPLES", 1000)
    found = {sheet.name: sheet for sheet in workbook.sheets(Content(result, proof))}
    series = found["Time series"]
    assert len(series.rows) <= 1000 < len(proof.series["time"])
    assert (
        series.note
        == f"{len(series.rows)} of {len(proof.series['time'])} samples, evenly and with the peaks of every column"
    )
    assert {"across": f"Time series: {series.note}"} in found["About"].rows
    for name in ("time", "speed", "error", "current"):
        column = [row[name] for row in series.rows]
        assert (min(column), max(column)) == pytest.approx(peaks[name], rel=1e-12)
    page = opened([series])["Time series"]
    assert page.cell(1, len(series.columns) + 1).value == series.note


def test_the_time_series_is_that_of_the_csv(book, result):
    text = csv_tables.timeseries_csv(loop(result)).decode()
    heads, *lines = csv.reader(io.StringIO(text))
    rows = [list(row) for row in book["Time series"].iter_rows(min_row=2, max_col=len(heads), values_only=True)]
    assert len(rows) == len(lines)
    for row, line in zip(rows[:: len(rows) // 50], lines[:: len(rows) // 50], strict=True):
        assert row == [pytest.approx(float(cell), rel=1e-15, abs=0.0) for cell in line]
    assert [h.partition(" (")[0] for h in heads] == [
        str(c.value).partition(" (")[0].replace(" ", "_") for c in book["Time series"][1]
    ]


def test_the_spec_stands_line_by_line_and_the_file_tells_what_made_it(book, result):
    lines = [row["sps_robot.yaml"] for row in rows_of(book["Spec"])]
    assert "\n".join(line or "" for line in lines) == result.spec.text.rstrip("\n")
    told = dict(book["About"].iter_rows(max_col=2, values_only=True))
    assert told["catalogue maxon, digest"] == result.catalog.digests["maxon"]
    assert re.fullmatch(r"\d+\.\d+\.\d+", told["drivesizer"])


def test_figures_of_the_data_sheets_carry_their_confidence(book, result):
    rows = [r for r in rows_of(book["Selected drive"]) if r["part"] == "motor"]
    sure = {r["figure"]: r["confidence"] for r in rows}
    # as the catalogue file has it: length derived, all else from a copy
    assert (sure["length"], sure["rotor inertia"]) == ("derived", "secondary")
    value = {r["figure"]: (r["value"], r["unit"], r["SI value"]) for r in rows}
    assert value["nominal torque"] == (pytest.approx(26.3), "mN·m", pytest.approx(0.0263))
    assert "max winding temperature" not in value  # unknown: not listed
    assert all(r["source"] for r in rows)


def test_without_a_set_all_sheets_are_there_and_say_so(result):
    bare = replace(result, sets=(), misses=(), counts=replace(result.counts, considered=0, feasible=0, failed_by={}))
    book = opened(workbook.sheets(Content(bare)))
    assert book.sheetnames == [name for name in NAMES if name not in (REQUIRED, SPEEDS)]
    assert [row[0].value for row in book["Parts list"].iter_rows(min_row=2)] == []
    told = [cell.value for cell in book["About"]["A"]]
    assert "Parts list: no drive meets all limits: nothing to buy" in told
    miss = opened(workbook.sheets(Content(replace(result, sets=(), misses=result.misses))))
    assert "The closest rejected drive: it fails" in [cell.value for cell in miss["Summary"]["A"]]
    assert miss["Parts list"].max_row == 1


def test_a_workbook_loads_neither_matplotlib_nor_typst(example):
    code = (
        "import sys; from drivesizer import load_spec, size; from drivesizer.output.report import workbook; "
        "from drivesizer.output.report.sections.section import Content; "
        "from drivesizer.output.json import documents as file; "
        "workbook.render(Content(size(load_spec(sys.argv[1]), top=1)), 'x'); "
        "print({'matplotlib', 'typst'} & set(sys.modules), 'xlsxwriter' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code, str(example)], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set() True"


def test_rows_of_numbers_are_those_that_were_given():
    """Written a whole row at a time: places behind column Z, 16 digits, and gaps where a figure is unknown."""
    columns = tuple(SheetColumn(f"c{n}", f"c{n}", "sample") for n in range(30))
    values = np.random.default_rng(3).normal(size=(40, 30)) * 10.0 ** np.arange(-15, 15)
    values[5, 3], values[7, 29], values[39] = np.nan, np.inf, [1.0, *[np.nan] * 29]
    rows = [dict(zip((c.key for c in columns), row, strict=True)) for row in values.tolist()]
    file = written([Sheet(name=name, columns=columns, rows=rows) for name in ("a", "b")])
    for page in openpyxl.load_workbook(io.BytesIO(file)):
        assert page.dimensions == "A1:AD41"
        found = np.array([[cell.value for cell in row] for row in page.iter_rows(min_row=2)], float)
        assert found == pytest.approx(np.where(np.isfinite(values), values, np.nan), rel=1e-15, nan_ok=True)
        assert {cell.number_format for row in page.iter_rows(min_row=2) for cell in row} == {"General"}
