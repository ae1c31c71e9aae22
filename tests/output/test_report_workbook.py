"""The workbook: numbers that a spreadsheet can reckon with, no text that it would, and what it cannot hold minded."""

import io
import os
import re
import subprocess
import sys
import zipfile
from dataclasses import replace
from datetime import datetime
from math import inf, isnan, nan

import numpy as np
import openpyxl
import pytest
from specs import HEAT, without
from synthetic_validation import synthetic_validation

from drivesizer.catalog import Catalog
from drivesizer.output.document.axes import content_of
from drivesizer.output.document.records import Column, Printed, Quantity, Row, Section, Series, Table
from drivesizer.output.report import write
from drivesizer.output.report.workbook import number_format, report_xlsx, written
from drivesizer.results.sizing import SizingResult
from drivesizer.sizing import size
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import digits_of, registry

FORMULAS = ("=1+1", "+1", "-1+1", "@SUM(A1)", '=HYPERLINK("http://x")', "http://example.org/a", "{=1}", "\t=1", "＝1")


@pytest.fixture(scope="module")
def result(spec: RobotSpec, catalog: Catalog) -> SizingResult:
    """Of a motor whose heat is unknown."""
    return size(spec, catalog=without(catalog, "motor", "118752", *HEAT), top=4)


@pytest.fixture(scope="module")
def content(result) -> bytes:
    return report_xlsx(content_of(result, loop(result)))


@pytest.fixture(scope="module")
def book(content):
    return openpyxl.load_workbook(io.BytesIO(content))


def loop(result, step=0.5):
    return synthetic_validation(result, step=step)


def rows_of(page) -> list[dict]:
    heads, *rows = page.iter_rows(values_only=True)
    return [dict(zip(heads, row, strict=True)) for row in rows]


def opened(*blocks):
    """A workbook of one section with these blocks."""
    section = Section(name="a", title="A", blocks=lambda _: blocks)
    return openpyxl.load_workbook(io.BytesIO(written([Printed(section, "A", [*blocks])])))


def cells(book):
    return [cell for page in book for row in page.iter_rows() for cell in row if cell.value is not None]


def test_sheets_have_a_head_that_stays_a_filter_and_widths(book):
    assert book.sheetnames[:2] == ["Summary", "Requirements on the machine"]
    assert {"Checks", "Closed loop", "Time series", "Candidates", "Derivation"} < {*book.sheetnames}
    for page in book:
        assert page.freeze_panes and page.freeze_panes.endswith("2"), page.title
        widths = [d.width for d in page.column_dimensions.values()]
        assert widths and all(8 <= width <= 120 for width in widths), page.title
    assert re.fullmatch(r"A1:[A-Z]+\d+", book["Checks"].auto_filter.ref)


def test_the_same_input_gives_the_same_bytes_and_no_date(result, content, tmp_path):
    (path,) = write(result, loop(result), [tmp_path / "report.xlsx"])
    assert path.read_bytes() == content
    with zipfile.ZipFile(path) as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        told = archive.read("docProps/core.xml").decode()
    assert set(re.findall(r"\d{4}-\d\d-\d\dT[\d:]+Z", told)) == {"2000-01-01T00:00:00Z"}
    assert str(datetime.now().year) not in told


@pytest.mark.slow
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


def test_si_stands_beside_the_unit_of_the_trade_and_is_the_same(book):
    """Held against pint, unit by unit as it is printed."""
    ureg, checked = registry(), set()
    spelled = {"°C": "degC", "°": "deg", "Ω": "ohm", "²": "^2", "³": "^3", "·": "*", "µ": "u", "%": "percent"}
    for row in (*rows_of(book["Checks"]), *rows_of(book["Selected drive"])):
        value = row.get("demand", row.get("value"))
        if isinstance(row["SI value"], int | float) and row["SI unit"] and isinstance(value, int | float):
            unit, si = row["unit"], row["SI unit"]
            for mark, word in spelled.items():
                unit, si = unit.replace(mark, word), si.replace(mark, word)
            if unit not in ("EUR", "CHF"):
                assert ureg.Quantity(value, unit).to(si).magnitude == pytest.approx(row["SI value"], rel=1e-12), row
                checked.add(unit)
    assert {"rpm", "mN*m", "g*cm^2", "degC", "kHz"} <= checked


def test_margins_are_formulas_of_the_cells_beside_them_or_numbers_in_per_cent(book, result):
    """As a spreadsheet computes them: limit over demand less 1, where that is the margin."""
    page = book["Checks"]
    heads = {cell.value: cell.column for cell in page[1]}
    expected = {(s.rank, c.title, c.method): c.margin for s in (*result.sets, *result.misses) for c in s.own_checks}
    seen = 0
    for row in page.iter_rows(min_row=2):
        value = {head: row[column - 1].value for head, column in heads.items()}
        margin = expected.get((value["drive"], value["check"], value["method"]), nan)
        if isnan(margin):
            continue
        found = value["margin"]
        assert "%" in row[heads["margin"] - 1].number_format
        if isinstance(found, str):
            top, bottom = re.fullmatch(r"=([A-Z]+\d+)/([A-Z]+\d+)-1", found).groups()
            found, seen = page[top].value / page[bottom].value - 1.0, seen + 1
        assert found == pytest.approx(margin, rel=1e-9, abs=1e-12)
    assert seen > 20


@pytest.mark.parametrize("value", [26.304, 5.0, 0.0, -0.07375, 208.8654, 6169.2, 0.002843, 1.0, 999.96, -2.855, 0.4175])
def test_a_figure_is_shown_with_the_digits_that_are_printed_elsewhere(value):
    decimals = len(number_format(value).partition(".")[2])
    assert float(f"{value:.{decimals}f}") == float(digits_of(value))


def test_what_has_no_end_is_a_word():
    rows = [Row({"value": Quantity(x, "N", "force")}) for x in (inf, -inf, nan, 2.0)]
    page = opened(Table("", [Column("value", "value", "number")], rows))["A"]
    assert [row[0] for row in page.iter_rows(min_row=2, values_only=True)][:2] == ["unbounded", "unbounded below"]
    assert page["A4"].value is None and page["A5"].value == 2


def test_no_text_is_computed_or_made_a_link(result):
    best = result.sets[0]
    checks = [replace(check, note=text, case=text) for check, text in zip(best.checks, FORMULAS, strict=False)]
    named = replace(
        result,
        problem=replace(result.problem, machine=result.spec.model_copy(update={"name": FORMULAS[0]})),
        warnings=FORMULAS,
        sets=(replace(best, checks=(*checks, *best.checks[len(checks) :])),),
    )
    content = report_xlsx(content_of(named, replace(loop(result), profile=FORMULAS[0], warnings=FORMULAS)))
    book = openpyxl.load_workbook(io.BytesIO(content))
    written = [cell.value for cell in cells(book)]
    assert len(checks) == len(FORMULAS) and all(written.count(text) >= 3 for text in FORMULAS)
    own = re.compile(r"=(SUM\([A-Z]+\d+:[A-Z]+\d+\)|[A-Z]+\d+[*/][A-Z]+\d+(-1)?)")
    assert all(own.fullmatch(cell.value) for cell in cells(book) if cell.data_type == "f")
    assert not any(page._hyperlinks for page in book)


def test_what_a_cell_cannot_hold_is_spelled_out_or_cut():
    hostile = "a\x00b\x1b[31m\ud800c\ufffed\u202e 測試 робот 😀 _x0041_ <&>\"'"
    rows = [Row({"text": text}) for text in (hostile, "x" * 40_000, "line\r\nline")]
    page = opened(Table("", [Column("text", "text")], rows))["A"]
    first, second, third = (row[0] for row in page.iter_rows(min_row=2, values_only=True))
    assert "\\x00" in first and "\\x1b[31m" in first and "\\ud800" in first and "\\u202e" in first
    assert "測試 робот 😀" in first and first.endswith("<&>\"'")
    assert len(second) == 32767 and second.endswith("…")
    assert third == "line\nline"


def test_figures_of_the_data_sheets_carry_their_confidence(book, result):
    rows = [r for r in rows_of(book["Selected drive"]) if r["part"] == "motor"]
    sure = {r["figure"]: r["confidence"] for r in rows}
    # as the catalogue file has it: length derived, all else from a copy
    assert (sure["length"], sure["rotor inertia"]) == ("derived", "secondary")
    value = {r["figure"]: (r["value"], r["unit"], r["SI value"]) for r in rows}
    assert value["nominal torque"] == (pytest.approx(26.3), "mN·m", pytest.approx(0.0263))
    assert "max winding temperature" not in value  # unknown: not listed
    assert all(r["source"] for r in rows)


def test_without_a_set_nothing_is_bought(result):
    bare = replace(result, sets=(), misses=(), counts=replace(result.counts, considered=0, feasible=0, failed_by={}))
    assert report_xlsx(content_of(bare))
    miss = openpyxl.load_workbook(io.BytesIO(report_xlsx(content_of(replace(result, sets=(), misses=result.misses)))))
    assert not any(cell.value == "order number" for cell in cells(miss))


def test_rows_of_series_are_those_that_were_given():
    """Written a whole row at a time: places behind column Z, 16 digits, and gaps where a figure is unknown."""
    values = np.random.default_rng(3).normal(size=(40, 30)) * 10.0 ** np.arange(-15, 15)
    values[5, 3], values[7, 29], values[39] = np.nan, np.inf, [1.0, *[np.nan] * 29]
    columns = {f"c{n}": (values[:, n], "dimensionless", "1") for n in range(30)}
    for page in opened(Series("a", "a", columns), Series("b", "b", columns)):
        assert page.dimensions == "A1:AD41"
        found = np.array([[cell.value for cell in row] for row in page.iter_rows(min_row=2)], float)
        assert found == pytest.approx(np.where(np.isfinite(values), values, np.nan), rel=1e-15, nan_ok=True)
